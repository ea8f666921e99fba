/* Laws and measures in lanes against the public functions in double, which are made of the same source: the same bits
   where pel_real is double. That the plain kernels have the bits of the wide ones is tested by solve/project_kernel. */
#include "law_forms.h"
#include "stencil.h"

#include "law/fibre.h"
#include "measure/element.h"
#include "measure/fibre.h"
#include "measure/hinge.h"
#include "measure/membrane.h"
#include "measure/volume.h"
#include "pellicle/bending.h"

enum { TRIALS = 300 };

/* float has 24 bits, and terms that cancel */
static void assert_same(pel_lane lanes, int lane, double exact, double scale)
{
#ifdef PEL_SINGLE
    assert_near((double)lanes[lane] / scale, exact / scale, 3e-5);
#else
    (void)scale;
    assert_near(lanes[lane], exact, 0);
#endif
}

/* a number of each lane, and the lane's result in double */
static pel_lane load(double values[PEL_BLOCK])
{
    pel_lane lanes = pel_lane_splat(0);
    for (int i = 0; i < PEL_BLOCK; i++) {
        lanes[i] = (pel_real)values[i];
        values[i] = (double)lanes[i];
    }
    return lanes;
}

static pel_lane3 load_point(double points[PEL_BLOCK][3])
{
    double parts[3][PEL_BLOCK];
    pel_lane part[3];
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < PEL_BLOCK; i++)
            parts[c][i] = points[i][c];
        part[c] = load(parts[c]);
        for (int i = 0; i < PEL_BLOCK; i++)
            points[i][c] = parts[c][i];
    }
    return (pel_lane3){part[0], part[1], part[2]};
}

/* the law with the numbers that lanes have */
static pel_membrane_law law_of(int kind, pel_lane numbers[PEL_LAW_NUMBERS])
{
    pel_membrane_material material = law_material(kind, 1, 0.25, 1);
    pel_membrane_law law = pel_membrane_law_of(&material);
    law.modulus = 1;
    for (int i = 0; i < PEL_LAW_NUMBERS; i++) {
        numbers[i] = pel_lane_splat((pel_real)law.numbers[i]);
        law.numbers[i] = (double)(pel_real)law.numbers[i];
    }
    return law;
}

static void random_columns(random_state *random, double columns[2][PEL_BLOCK][3])
{
    for (int i = 0; i < PEL_BLOCK; i++)
        for (int c = 0; c < 3; c++)
            for (int j = 0; j < 2; j++)
                columns[j][i][c] = (c == j ? 1.1 : 0) + 0.2 * random_normal(random);
}

static void check_stress(int kind, random_state *random)
{
    double columns[2][PEL_BLOCK][3];
    random_columns(random, columns);
    pel_lane numbers[PEL_LAW_NUMBERS];
    pel_membrane_law law = law_of(kind, numbers);
    const pel_gradient gradient = {load_point(columns[0]), load_point(columns[1])};
    pel_lane3 stress[2];
    pel_lane energy = pel_membrane_stress((pel_membrane_kind)kind, numbers, &gradient, stress);
    for (int i = 0; i < PEL_BLOCK; i++) {
        double f[6], p[6], scale = 1;
        for (int c = 0; c < 3; c++)
            for (int j = 0; j < 2; j++)
                f[2 * c + j] = columns[j][i][c];
        double expected = pel_membrane_law_density(&law, f, p);
        for (int c = 0; c < 6; c++)
            scale = fmax(scale, fabs(p[c]));
        assert_same(energy, i, expected, scale);
        for (int j = 0; j < 2; j++) {
            assert_same(stress[j].x, i, p[j], scale);
            assert_same(stress[j].y, i, p[2 + j], scale);
            assert_same(stress[j].z, i, p[4 + j], scale);
        }
    }
}

/* the inverse of the tangent, scale (C x C - part C (x) C), of a strain vector */
static void check_compliance(const pel_response *r, const pel_symmetric2 *c)
{
    const pel_symmetric3 *m = &r->tangent;
    const pel_lane rows[3][3] = {{m->a11, m->a12, m->a13}, {m->a12, m->a22, m->a23}, {m->a13, m->a23, m->a33}};
    for (int i = 0; i < 3; i++) {
        const pel_lane t11 = rows[i][0], t22 = rows[i][1], t12 = rows[i][2], two = pel_lane_splat(2);
        pel_lane shared = r->compliance.part * (c->a * t11 + c->b * t22 + two * c->c * t12);
        const pel_lane strain[3] = {
            c->a * c->a * t11 + c->c * c->c * t22 + two * c->a * c->c * t12 - shared * c->a,
            c->c * c->c * t11 + c->b * c->b * t22 + two * c->b * c->c * t12 - shared * c->b,
            two * (c->a * c->c * t11 + c->b * c->c * t22 + (c->a * c->b + c->c * c->c) * t12 - shared * c->c)};
        for (int j = 0; j < 3; j++)
            for (int lane = 0; lane < PEL_BLOCK; lane++)
                assert_near((double)(r->compliance.scale * strain[j])[lane], i == j,
                            sizeof(pel_real) == 8 ? 1e-13 : 1e-4);
    }
}

/* stress, tangent and its positive part of a strain */
static void check_response(int kind, random_state *random)
{
    double strain[3][PEL_BLOCK];
    for (int i = 0; i < PEL_BLOCK; i++) {
        strain[0][i] = random_between(random, -0.2, 0.5);
        strain[1][i] = random_between(random, -0.2, 0.5);
        strain[2][i] = random_between(random, -0.3, 0.3);
    }
    pel_lane numbers[PEL_LAW_NUMBERS];
    pel_membrane_law law = law_of(kind, numbers);
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2);
    pel_strain s = {.strain = {load(strain[0]), load(strain[1]), load(strain[2])}};
    s.cauchy = (pel_symmetric2){one + two * s.strain.a, one + two * s.strain.b, s.strain.c};
    s.area_square = s.cauchy.a * s.cauchy.b - s.cauchy.c * s.cauchy.c;
    s.area_ratio = pel_lane_sqrt(s.area_square);
    pel_response r;
    pel_respond((pel_membrane_kind)kind, numbers, &s, &r);
    if ((pel_membrane_law_traits((pel_membrane_kind)kind) & PEL_LAW_COMPLIANT) != 0)
        check_compliance(&r, &s.cauchy);
    const pel_symmetric3 *m[2] = {&r.tangent, &r.positive};
    for (int i = 0; i < PEL_BLOCK; i++) {
        const double at[3] = {strain[0][i], strain[1][i], strain[2][i]};
        double stress[3], tangents[2][6];
        assert_same(r.energy, i, pel_membrane_law_response(&law, at, stress, tangents[0], tangents[1]), 1);
        assert_same(r.stress.a, i, stress[0], 1);
        assert_same(r.stress.b, i, stress[1], 1);
        assert_same(r.stress.c, i, stress[2], 1);
        for (int k = 0; k < 2; k++) {
            const pel_lane parts[6] = {m[k]->a11, m[k]->a12, m[k]->a13, m[k]->a22, m[k]->a23, m[k]->a33};
            for (int j = 0; j < 6; j++)
                assert_same(parts[j], i, tangents[k][j], 10);
        }
    }
}

static void test_laws(void **unused)
{
    (void)unused;
    random_state random = {31};
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++)
        for (int trial = 0; trial < TRIALS; trial++) {
            check_stress(kind, &random);
            check_response(kind, &random);
        }
}

static void test_fibres(void **unused)
{
    (void)unused;
    random_state random = {32};
    for (int trial = 0; trial < TRIALS; trial++)
        for (int squared = 0; squared < 2; squared++) {
            double columns[2][PEL_BLOCK][3], length = squared ? 1 : 0.75, direction[2] = {0.6, 0.8};
            random_columns(&random, columns);
            pel_lane3 f1 = load_point(columns[0]), f2 = load_point(columns[1]);
            pel_lane a[2];
            for (int j = 0; j < 2; j++) {
                a[j] = pel_lane_splat((pel_real)direction[j]);
                direction[j] = (double)(pel_real)direction[j];
            }
            pel_fibre_image image = pel_fibre_image_of(f1, f2, a[0], a[1]);
            pel_lane energy =
                pel_law_fibre_energy(pel_law_fibre(image.square, pel_lane_splat((pel_real)length), squared != 0));
            for (int i = 0; i < PEL_BLOCK; i++) {
                const double *u = columns[0][i], *v = columns[1][i], f[6] = {u[0], v[0], u[1], v[1], u[2], v[2]};
                double expected = squared ? pel_fibre_density(PEL_FIBRE_STVK, 1, direction, f, NULL)
                                          : pel_fibre_active_density(1, length, direction, f, NULL);
                assert_same(energy, i, expected, 1);
            }
        }
}

/* angle and K x of hinges, volume and pressure of their first triangle */
static void test_hinges_and_volumes(void **unused)
{
    (void)unused;
    random_state random = {33};
    for (int trial = 0; trial < TRIALS; trial++) {
        double points[4][PEL_BLOCK][3];
        static const double corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0.5, 0.9, 0}, {0.5, -0.9, 0}};
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < PEL_BLOCK; i++)
                for (int c = 0; c < 3; c++)
                    points[k][i][c] = corner[k][c] + 0.3 * random_between(&random, -1, 1);
        pel_particle p[4];
        for (int k = 0; k < 4; k++)
            p[k].at = load_point(points[k]);
        const pel_lane one = pel_lane_splat(1), zero = pel_lane_splat(0), weight[4] = {one, one, -one, -one};
        pel_hinge_lanes h = pel_hinge_of(p, one, zero);
        pel_lane3 g[4], sum = pel_isometric_of(p, weight);
        pel_hinge_gradients(&h, -h.length, g);
        pel_lane square = pel_lane3_dot(sum, sum), volume = pel_volume_of(p[0].at, p[1].at, p[2].at);
        pel_lane3 area = pel_area_vector(p[0].at, p[1].at, p[2].at);
        const pel_bending_isometric stencil = {.weight = {1, 1, -1, -1}, .factor = 2};
        for (int i = 0; i < PEL_BLOCK; i++) {
            double x[4][3], gradient[4][3], force[3];
            for (int k = 0; k < 4; k++)
                memcpy(x[k], points[k][i], sizeof x[k]);
            const double(*at)[3] = (const double(*)[3])x;
            assert_same(h.difference, i, pel_dihedral_angle(at, gradient), 1);
            for (int k = 0; k < 4; k++)
                assert_same(g[k].z, i, gradient[k][2], 10);
            assert_same(square, i, pel_bending_isometric_energy(&stencil, PEL_BENDING_LITERAL, at, NULL), 10);
            assert_same(volume / pel_lane_splat(6), i, pel_triangle_volume(at, NULL), 1);
            pel_triangle_pressure_force(at, 6, force);
            assert_same(area.y, i, force[1], 1);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_laws),
        cmocka_unit_test(test_fibres),
        cmocka_unit_test(test_hinges_and_volumes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
