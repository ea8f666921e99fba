/* Sums of vertices of rigid bodies and loose ones: values, mobility and momenta against what they do. */
#include "random.h"
#include "rigid/sum.h"
#include "rigid_scene.h"

enum { SIZE = 32 };

typedef struct pair {
    pel_rigid_shape shapes[2];
    pel_rigid items[2];
    pel_rigids rigids;
    pel_record rest[SIZE], places[SIZE];
    pel_real inverse[SIZE];
    int32_t of_slice[SIZE];
    pel_mesh *meshes[2];
} pair;

/* boxes at the vertices 0 and 8, loose vertices from 16 on */
static void make_pair(pair *p)
{
    static const double centers[2][3] = {{0, 0, 0}, {0.05, 0.02, 0.4}}, velocity[3] = {0.2, 0.5, 0},
                        spin[3] = {1, 2, 3};
    memset(p, 0, sizeof *p);
    p->rigids = (pel_rigids){.count = 2,
                             .items = p->items,
                             .of_slice = p->of_slice,
                             .rest = p->rest,
                             .inverse_mass = p->inverse,
                             .rate = 50};
    for (int s = 0; s < SIZE; s++)
        p->of_slice[s] = s * PEL_WIDTH < 8 ? 0 : s * PEL_WIDTH < 16 ? 1 : -1;
    for (int v = 0; v < SIZE; v++) {
        p->inverse[v] = 1;
        p->rest[v] = p->places[v] = (pel_record){0, 0, (pel_real)0.1 * (pel_real)v, 1};
    }
    for (int b = 0; b < 2; b++) {
        pel_inertia inertia;
        pel_rigid_state start;
        p->meshes[b] = make_box(0.1, 0.2, 0.3, centers[b]);
        pel_inertia_of_solid(p->meshes[b], b == 0 ? 1000 : 300, &inertia);
        pel_rigid_shape_set(&p->shapes[b], &inertia, p->meshes[b], NULL, 0);
        for (int v = 0; v < 8; v++)
            for (int k = 0; k < 3; k++)
                p->rest[8 * b + v][k] = (pel_real)p->meshes[b]->positions[v][k];
        pel_rigid_state_start(&p->shapes[b], velocity, spin, &start);
        p->items[b] = (pel_rigid){.shape = &p->shapes[b], .begin = 8 * b, .end = 8 * b + 8};
        pel_rigid_begin(&p->items[b], &start);
        pel_rigid_drift(&p->items[b], 0.01 * (b + 1));
    }
    pel_rigids_place(&p->rigids, p->places);
}

static void end_pair(pair *p)
{
    pel_mesh_destroy(p->meshes[0]);
    pel_mesh_destroy(p->meshes[1]);
}

static void value_of(const pair *p, const int32_t vertices[4], const double weights[4], double value[3])
{
    pel_vec3_set(value, 0, 0, 0);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            value[k] += weights[i] * (double)p->places[vertices[i]][k];
}

/* a body and loose vertices, or within one body: the value, and the way by a small push */
static void test_mobility(void **state)
{
    (void)state;
    static const int32_t cases[3][4] = {{1, 16, 17, 18}, {1, 2, 16, 17}, {9, 10, 11, 20}};
    static const double weights[4] = {1, -0.2, -0.3, -0.5};
    for (int c = 0; c < 3; c++) {
        pair p;
        pel_rigid_sum sum;
        double before[3], after[3], direction[3] = {0.36, 0.48, 0.8}, push[3];
        make_pair(&p);
        assert_true(pel_rigid_sum_is_asked(&p.rigids, cases[c], weights, 4));
        pel_rigid_sum_set(&sum, &p.rigids, cases[c], weights, 4, p.places);
        value_of(&p, cases[c], weights, before);
        for (int k = 0; k < 3; k++)
            assert_near(sum.value[k], before[k], sizeof(pel_real) == sizeof(double) ? 1e-14 : 1e-6);
        double mobility = pel_rigid_sum_mobility(&sum, direction), d = 1e-6 / mobility;
        pel_vec3_scale(direction, d, push);
        pel_rigid_sum_push(&sum, &p.rigids, p.places, push);
        pel_rigids_place(&p.rigids, p.places);
        value_of(&p, cases[c], weights, after);
        pel_vec3_subtract(after, before, after);
        assert_near(pel_vec3_dot(after, direction) / (mobility * d), 1,
                    sizeof(pel_real) == sizeof(double) ? 1e-4 : 0.5);
        end_pair(&p);
    }
    static const int32_t loose[4] = {16, 17, 18, 1};
    static const double unused[4] = {1, -0.5, -0.5, 0};
    pair p;
    make_pair(&p);
    assert_false(pel_rigid_sum_is_asked(&p.rigids, loose, unused, 4));
    assert_false(pel_rigid_sum_is_asked(NULL, loose, unused, 4));
    end_pair(&p);
}

/* Two free bodies over a substep: however they push each other, momentum and angular momentum stay, for pushes at
   places that have moved since its start. */
static void test_momenta(void **state)
{
    (void)state;
    static const int32_t vertices[4] = {6, 8, 9, 10};
    static const double weights[4] = {1, -0.2, -0.5, -0.3};
    random_state random = {7};
    for (int trial = 0; trial < 50; trial++) {
        pair p;
        double before[2][3] = {{0}}, after[2][3] = {{0}}, turn[3], push[3];
        make_pair(&p);
        for (int b = 0; b < 2; b++) {
            const pel_rigid_state *start = &p.items[b].started;
            pel_vec3_add(before[0], start->momentum, before[0]);
            pel_vec3_cross(start->pivot, start->momentum, turn);
            pel_vec3_add(before[1], turn, before[1]);
            pel_vec3_add(before[1], start->angular_momentum, before[1]);
            /* a drift that was not that of a substep of this rate is one */
            pel_vec3_along(start->pivot, 1 / (p.rigids.rate * p.shapes[b].mass), start->momentum,
                           p.items[b].state.pivot);
        }
        for (int i = 0; i < 3; i++) {
            pel_rigid_sum sum;
            for (int k = 0; k < 3; k++)
                push[k] = random_between(&random, -5e-4, 5e-4);
            pel_rigid_sum_set(&sum, &p.rigids, vertices, weights, 4, p.places);
            pel_rigid_sum_push(&sum, &p.rigids, p.places, push);
        }
        for (int b = 0; b < 2; b++) {
            const pel_rigid_state *end = &p.items[b].state;
            pel_vec3_add(after[0], end->momentum, after[0]);
            pel_vec3_cross(end->pivot, end->momentum, turn);
            pel_vec3_add(after[1], turn, after[1]);
            pel_vec3_add(after[1], end->angular_momentum, after[1]);
        }
        for (int i = 0; i < 2; i++)
            for (int k = 0; k < 3; k++)
                assert_near(after[i][k], before[i][k], 1e-13);
        end_pair(&p);
    }
}

/* impulses change velocities alone */
static void test_hit(void **state)
{
    (void)state;
    static const int32_t vertices[4] = {1, 16, 17, 18};
    static const double weights[4] = {1, -0.2, -0.3, -0.5}, impulse[3] = {0.1, 0.2, -0.3};
    pel_record velocities[SIZE] = {{0}};
    pair p;
    pel_rigid_sum sum;
    double before[3], after[3], length = pel_vec3_length(impulse), direction[3];
    make_pair(&p);
    pel_rigid_state start = p.items[0].state;
    pel_rigid_sum_set(&sum, &p.rigids, vertices, weights, 4, p.places);
    pel_rigid_sum_velocity(&sum, &p.rigids, velocities, before);
    pel_rigid_sum_hit(&sum, &p.rigids, p.places, velocities, impulse);
    pel_rigid_sum_velocity(&sum, &p.rigids, velocities, after);
    pel_vec3_subtract(after, before, after);
    pel_vec3_scale(impulse, 1 / length, direction);
    assert_near(pel_vec3_dot(after, direction), length * pel_rigid_sum_mobility(&sum, direction), 1e-6);
    assert_memory_equal(p.items[0].state.pivot, start.pivot, sizeof start.pivot);
    assert_near((double)velocities[16][0], -0.2 * 0.1, 1e-7);
    end_pair(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mobility),
        cmocka_unit_test(test_momenta),
        cmocka_unit_test(test_hit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
