/* Two rigid boxes and loose vertices, in the middle of a substep. */
#ifndef PEL_TESTS_RIGID_PAIR_FIXTURE_H
#define PEL_TESTS_RIGID_PAIR_FIXTURE_H

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
static inline void make_pair(pair *p)
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

static inline void end_pair(pair *p)
{
    pel_mesh_destroy(p->meshes[0]);
    pel_mesh_destroy(p->meshes[1]);
}

static inline void value_of(const pair *p, const int32_t vertices[4], const double weights[4], double value[3])
{
    pel_vec3_set(value, 0, 0, 0);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            value[k] += weights[i] * (double)p->places[vertices[i]][k];
}

static inline void find_momenta(const pair *p, double momentum[2][3])
{
    memset(momentum, 0, 2 * sizeof *momentum);
    for (int b = 0; b < 2; b++) {
        const pel_rigid_state *state = &p->items[b].state;
        double turn[3];
        pel_vec3_add(momentum[0], state->momentum, momentum[0]);
        pel_vec3_cross(state->pivot, state->momentum, turn);
        pel_vec3_add(momentum[1], turn, momentum[1]);
        pel_vec3_add(momentum[1], state->angular_momentum, momentum[1]);
    }
}

/* a drift that was not that of a substep of this rate is one; momenta: of the start */
static inline void drift_pair(pair *p, double momentum[2][3])
{
    for (int b = 0; b < 2; b++)
        p->items[b].state = p->items[b].started;
    find_momenta(p, momentum);
    for (int b = 0; b < 2; b++) {
        const pel_rigid_state *start = &p->items[b].started;
        pel_vec3_along(start->pivot, 1 / (p->rigids.rate * p->shapes[b].mass), start->momentum,
                       p->items[b].state.pivot);
    }
}

#endif
