/* Smoothed tetrahedra: what their elements share out, uniform strains, derivatives by finite differences, and that only
   rigid motions are free of energy. */
#include "check.h"
#include "failing_malloc.h"
#include "gradient.h"
#include "random.h"

#include "math/vec3.h"
#include "measure/star.h"

enum { SIDE = 3, CORNERS = SIDE * SIDE * SIDE, TETRAS = 6 * (SIDE - 1) * (SIDE - 1) * (SIDE - 1) };

/* a cube of cells with six tetrahedra around a diagonal each */
typedef struct block {
    double positions[CORNERS][3], young[TETRAS];
    int32_t tetrahedra[TETRAS][4];
    double volume, energy; /* sum of volumes, and of Young's modulus times volume */
    pel_stars *stars;
} block;

static void make_block(block *b, bool varies)
{
    static const int paths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    random_state random = {5};
    int32_t count = 0;
    b->volume = b->energy = 0;
    for (int v = 0; v < CORNERS; v++)
        for (int c = 0; c < 3; c++) {
            const int at = c == 0 ? v % SIDE : c == 1 ? v / SIDE % SIDE : v / SIDE / SIDE;
            b->positions[v][c] = at + random_between(&random, -0.15, 0.15);
        }
    for (int cell = 0; cell < TETRAS / 6; cell++)
        for (int p = 0; p < 6; p++) {
            int at[3] = {cell % 2, cell / 2 % 2, cell / 4};
            int32_t *tetra = b->tetrahedra[count];
            double x[4][3];
            for (int k = 0; k < 4; k++) {
                if (k > 0)
                    at[paths[p][k - 1]]++;
                tetra[k] = at[0] + SIDE * (at[1] + SIDE * at[2]);
            }
            /* half of the paths go around the diagonal the other way */
            if (p > 2) {
                const int32_t kept = tetra[0];
                tetra[0] = tetra[1];
                tetra[1] = kept;
            }
            for (int k = 0; k < 4; k++)
                pel_vec3_copy(b->positions[tetra[k]], x[k]);
            pel_rest_tetra rest;
            assert_true(pel_rest_tetra_setup((const double(*)[3])x, &rest));
            b->young[count] = varies ? random_between(&random, 0.5, 2) : 1;
            b->volume += rest.volume;
            b->energy += b->young[count++] * rest.volume;
        }
    assert_int_equal(count, TETRAS);
    assert_int_equal(pel_stars_create((const double(*)[3])b->positions, CORNERS, (const int32_t(*)[4])b->tetrahedra,
                                      TETRAS, b->young, &b->stars, NULL),
                     PEL_OK);
}

static int node_count(const pel_stars *stars, int32_t e)
{
    return stars->begin[e + 1] - stars->begin[e];
}

static void elements_share_all_volume(void **state)
{
    (void)state;
    block b;
    make_block(&b, true);
    double shape = 0, size = 0;
    for (int32_t e = 0; e < b.stars->count; e++) {
        assert_true(node_count(b.stars, e) >= 4 && node_count(b.stars, e) <= PEL_STAR_NODES);
        assert_true(e == 0 || node_count(b.stars, e) >= node_count(b.stars, e - 1));
        shape += b.stars->scales[e][0];
        size += b.stars->scales[e][1];
        double sum[3] = {0};
        for (int32_t i = b.stars->begin[e]; i < b.stars->begin[e + 1]; i++)
            pel_vec3_add(sum, b.stars->gradients[i], sum);
        assert_near(pel_vec3_length(sum), 0, 1e-14);
    }
    assert_near(shape, b.energy, 1e-12);
    assert_near(size, b.energy, 1e-12);
    pel_stars_destroy(b.stars);
}

static void load(const block *b, int32_t e, const double (*positions)[3], double *x)
{
    for (int k = 0; k < node_count(b->stars, e); k++)
        pel_vec3_copy(positions[b->stars->nodes[b->stars->begin[e] + k]], x + 3 * k);
}

static double energy_of(const block *b, const pel_solid_law *law, const double (*positions)[3])
{
    const pel_tangent_sum none = {0};
    double sum = 0, x[3 * PEL_STAR_NODES];
    for (int32_t e = 0; e < b->stars->count; e++) {
        load(b, e, positions, x);
        sum += pel_star_tangent(b->stars, e, law, x, PEL_TANGENT_EXACT, &none);
    }
    return sum;
}

static void uniform_strain_has_the_energy_of_the_law(void **state)
{
    (void)state;
    const double f[9] = {1.2, 0.1, -0.05, 0.07, 0.9, 0.2, 0, -0.1, 1.1};
    block b;
    make_block(&b, false);
    for (int kind = 0; kind < PEL_VOLUME_COUNT; kind++) {
        const pel_solid_law law = pel_solid_law_of((pel_volume_kind)kind, 0.35, 0.2);
        double moved[CORNERS][3];
        for (int v = 0; v < CORNERS; v++)
            for (int i = 0; i < 3; i++)
                moved[v][i] = pel_vec3_dot(f + 3 * i, b.positions[v]) + 0.3;
        const double expected = b.volume * pel_solid_density(&law, f, NULL);
        assert_near(energy_of(&b, &law, (const double(*)[3])moved), expected, 1e-12 * expected);
    }
    pel_stars_destroy(b.stars);
}

/* Around one edge stand more and more tetrahedra, each with a modulus of its own: their star is one element and the
   only patch as long as its corners are few enough; beyond that they stand for themselves there, and pairs at the
   spokes are the patches. */
static void large_stars_are_divided(void **state)
{
    (void)state;
    enum { MOST = 30 };
    const double f[9] = {1.2, 0.1, -0.05, 0.07, 0.9, 0.2, 0, -0.1, 1.1};
    const pel_solid_law law = pel_solid_law_of(PEL_VOLUME_NEO_HOOKEAN, 0.35, 0.2);
    for (int n = 3; n <= MOST; n++) {
        double positions[MOST + 2][3] = {{0, 0, -0.5}, {0, 0, 0.5}}, moved[MOST + 2][3], young[MOST];
        int32_t tetrahedra[MOST][4], patches = 0, most = 0;
        double energy = 0, shape = 0, size = 0;
        for (int k = 0; k < n; k++) {
            const double angle = 2 * acos(-1) * k / n;
            positions[k + 2][0] = cos(angle);
            positions[k + 2][1] = sin(angle);
            memcpy(tetrahedra[k], (int32_t[]){0, k + 2, (k + 1) % n + 2, 1}, sizeof tetrahedra[k]);
            young[k] = 1 + 0.1 * k;
            energy += young[k] * sin(2 * acos(-1) / n) / 6;
        }
        for (int v = 0; v < n + 2; v++)
            for (int i = 0; i < 3; i++)
                moved[v][i] = pel_vec3_dot(f + 3 * i, positions[v]);
        block b;
        assert_int_equal(pel_stars_create((const double(*)[3])positions, n + 2, (const int32_t(*)[4])tetrahedra, n,
                                          young, &b.stars, NULL),
                         PEL_OK);
        for (int32_t e = 0; e < b.stars->count; e++) {
            shape += b.stars->scales[e][0];
            size += b.stars->scales[e][1];
            patches += b.stars->scales[e][1] > 0;
            most = node_count(b.stars, e);
        }
        const bool is_one = n + 2 <= PEL_STAR_NODES;
        assert_near(shape, energy, 1e-12);
        assert_near(size, energy, 1e-12);
        assert_int_equal(most, is_one ? n + 2 : 5);
        assert_int_equal(patches, is_one ? 1 : (n + 1) / 2);
        /* an element for each edge, one for each tetrahedron of a divided star, and the patch of an odd one */
        assert_int_equal(b.stars->count, is_one ? 3 * n + 1 : 4 * n + n % 2);
        const double expected = energy * pel_solid_density(&law, f, NULL);
        assert_near(energy_of(&b, &law, (const double(*)[3])moved), expected, 1e-12 * expected);
        pel_stars_destroy(b.stars);
    }
}

typedef struct element {
    const block *block;
    pel_solid_law law;
    int32_t e;
    int component; /* of the gradient; -1 = energy */
} element;

static double value_of(const void *context, const double *x)
{
    const element *of = context;
    double gradient[3 * PEL_STAR_NODES] = {0};
    const pel_tangent_sum sum = {.gradient = gradient};
    const double energy = pel_star_tangent(of->block->stars, of->e, &of->law, x, PEL_TANGENT_EXACT, &sum);
    return of->component < 0 ? energy : gradient[of->component];
}

static void derivatives_are_those_of_the_energy(void **state)
{
    (void)state;
    enum { MOST = 3 * PEL_STAR_NODES };
    random_state random = {8};
    block b;
    make_block(&b, true);
    for (int kind = 0; kind < PEL_VOLUME_COUNT; kind++)
        for (int32_t e = 0; e < b.stars->count; e += 17) {
            const pel_solid_law law = pel_solid_law_of((pel_volume_kind)kind, 0.4, 0.2);
            const int n = 3 * node_count(b.stars, e);
            element of = {&b, law, e, -1};
            double x[MOST], gradient[MOST] = {0}, hessian[MOST * MOST] = {0};
            load(&b, e, (const double(*)[3])b.positions, x);
            for (int i = 0; i < n; i++)
                x[i] += random_between(&random, -0.2, 0.2);
            const pel_tangent_sum sum = {gradient, hessian, n};
            pel_star_tangent(b.stars, e, &law, x, PEL_TANGENT_EXACT, &sum);
            for (int i = 0; i < n; i++) {
                of.component = -1;
                assert_near(gradient[i], central_difference(value_of, &of, x, i, 1e-5), 1e-7);
                of.component = i;
                for (int j = 0; j < n; j++)
                    assert_near(hessian[i * n + j], central_difference(value_of, &of, x, j, 1e-5), 1e-7);
            }
        }
    pel_stars_destroy(b.stars);
}

/* the mean of a convex energy is above the energy of the mean, and no strain is free */
static void energies_are_between_nothing_and_those_of_tetrahedra(void **state)
{
    (void)state;
    random_state random = {9};
    const pel_solid_law law = pel_solid_law_of(PEL_VOLUME_NEO_HOOKEAN, 0.3, 0);
    block b;
    make_block(&b, false);
    for (int round = 0; round < 200; round++) {
        double moved[CORNERS][3], linear = 0;
        const int lone = round < CORNERS ? round : -1;
        for (int v = 0; v < CORNERS; v++)
            for (int c = 0; c < 3; c++)
                moved[v][c] = b.positions[v][c] + (lone < 0 || lone == v ? random_between(&random, -1e-3, 1e-3) : 0);
        for (int32_t t = 0; t < TETRAS; t++) {
            double rest[4][3], x[4][3], f[9];
            pel_rest_tetra shape;
            for (int k = 0; k < 4; k++) {
                pel_vec3_copy(b.positions[b.tetrahedra[t][k]], rest[k]);
                pel_vec3_copy(moved[b.tetrahedra[t][k]], x[k]);
            }
            assert_true(pel_rest_tetra_setup((const double(*)[3])rest, &shape));
            pel_tetra_deformation(&shape, (const double(*)[3])x, f);
            linear += shape.volume * pel_solid_density(&law, f, NULL);
        }
        const double energy = energy_of(&b, &law, (const double(*)[3])moved);
        assert_true(energy < 1.01 * linear);
        assert_true(energy > 0.05 * linear);
    }
    pel_stars_destroy(b.stars);
}

static pel_status create(const void *data, pel_error *error)
{
    const block *b = data;
    pel_stars *stars;
    const pel_status status = pel_stars_create((const double(*)[3])b->positions, CORNERS,
                                               (const int32_t(*)[4])b->tetrahedra, TETRAS, b->young, &stars, error);
    assert_true((status == PEL_OK) == (stars != NULL));
    pel_stars_destroy(stars);
    return status;
}

static void memory_may_run_out(void **state)
{
    (void)state;
    block b;
    make_block(&b, true);
    pel_stars_destroy(b.stars);
    assert_true(for_every_allocation_failure(create, &b) > 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(elements_share_all_volume),
        cmocka_unit_test(uniform_strain_has_the_energy_of_the_law),
        cmocka_unit_test(large_stars_are_divided),
        cmocka_unit_test(derivatives_are_those_of_the_energy),
        cmocka_unit_test(energies_are_between_nothing_and_those_of_tetrahedra),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
