#include "solve/shell_stability.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "force/body_force.h"
#include "math/extremes.h"

#include <math.h>

enum { LEAST_ITERATIONS = 40, MOST_ITERATIONS = 400 };

/* possible increase of the quotient at the end of the iteration, and displacement of the vertices relative to an edge
 */
#ifdef PEL_SINGLE
#define SLOW_RISE 3e-4
#define MARGIN 1.03
#define DISTURBANCE 1e-3
#else
#define SLOW_RISE 1e-5
#define MARGIN 1.01
#define DISTURBANCE 1e-6
#endif

typedef struct power_iteration {
    const pel_model *model;
    const pel_record *base; /* (vertex_count) positions about which the forces are taken */
    pel_state state;        /* a copy whose position is `moved` */
    pel_shell_forces *forces;
    pel_pool *pool;
    pel_record *moved, *force, *mode; /* (vertex_count) */
    double size;                      /* m */
} power_iteration;

void pel_shell_stability_bound(const pel_shell_forces *forces, pel_stability *stability)
{
    stability->stiffness_bound += pel_shell_stiffness_bound(forces);
    stability->stiffness = stability->stiffness_bound;
}

static void start_mode(const pel_model *model, pel_record *mode)
{
    uint32_t seed = 1;
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int c = 0; c < 3; c++) {
            seed = seed * 1664525u + 1013904223u;
            mode[v][c] = model->inverse_mass[v] > 0 ? (pel_real)((double)seed / 4294967296.0 - 0.5) : 0;
        }
}

/* adds sign times the forces at base + sign size mode to force */
static void add_forces(power_iteration *at, pel_record *force, double sign)
{
    const pel_model *model = at->model;
    pel_real step = (pel_real)(sign * at->size);
    for (int32_t v = 0; v < model->vertex_count; v++)
        at->moved[v] = at->base[v] + step * at->mode[v];
    pel_body_forces(model, &at->state, NULL, at->pool, at->force);
    pel_shell_forces_add(at->forces, at->moved, pel_instant(0), PEL_SHELL_ALL, at->pool, at->force);
    for (int32_t v = 0; v < model->vertex_count; v++)
        force[v] += (pel_real)sign * at->force[v];
}

/* mode := M^-1 K mode, scaled to largest part 1; returns the Rayleigh quotient */
static double power_step(power_iteration *at, pel_record *product)
{
    const pel_model *model = at->model;
    for (int32_t v = 0; v < model->vertex_count; v++)
        product[v] = (pel_record){0, 0, 0, 0};
    add_forces(at, product, 1);
    add_forces(at, product, -1);
    double work = 0, mass = 0, largest = 0, scale = -1 / (2 * at->size);
    for (int32_t v = 0; v < model->vertex_count; v++) {
        double inverse_mass = (double)model->inverse_mass[v];
        for (int c = 0; c < 3; c++) {
            double u = (double)at->mode[v][c], k = inverse_mass > 0 ? scale * (double)product[v][c] : 0;
            work += u * k;
            mass += inverse_mass > 0 ? u * u / inverse_mass : 0;
            product[v][c] = (pel_real)(inverse_mass * k);
            largest = pel_max(largest, fabs(inverse_mass * k));
        }
    }
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            at->mode[v][c] = (pel_real)((double)product[v][c] / (largest > 0 ? largest : 1));
    return mass > 0 ? work / mass : 0;
}

static double smallest_edge(const pel_model *model)
{
    double edge = HUGE_VAL;
    for (int32_t b = 0; b < model->body_count; b++)
        if (model->bodies[b].shell != NULL)
            edge = pel_min(edge, model->bodies[b].shell->mean_edge);
    return edge;
}

/* about `base` */
static pel_status iterate(const pel_record *base, const pel_model *model, const pel_state *state,
                          pel_shell_forces *forces, pel_pool *pool, double *stiffness)
{
    size_t count = (size_t)model->vertex_count;
    power_iteration at = {.model = model,
                          .base = base,
                          .state = *state,
                          .forces = forces,
                          .pool = pool,
                          .size = DISTURBANCE * smallest_edge(model)};
    at.moved = pel_allocate_aligned(count, sizeof *at.moved);
    at.force = pel_allocate_aligned(count, sizeof *at.force);
    at.mode = pel_allocate_aligned(count, sizeof *at.mode);
    pel_record *product = pel_allocate_aligned(count, sizeof *product);
    const bool done = at.moved != NULL && at.force != NULL && at.mode != NULL && product != NULL;
    if (done) {
        at.state.position = at.moved;
        start_mode(model, at.mode);
        double value = 0, before = -1;
        for (int n = 0; n < MOST_ITERATIONS && (n < LEAST_ITERATIONS || fabs(value - before) > SLOW_RISE * value);
             n++) {
            before = value;
            value = power_step(&at, product);
        }
        /* the quotient comes from below */
        *stiffness = MARGIN * value;
    }
    PEL_FREE_ALL(product, at.mode, at.force, at.moved);
    return done ? PEL_OK : PEL_OUT_OF_MEMORY;
}

pel_status pel_shell_stability_refine(const pel_model *model, const pel_state *state, pel_shell_forces *forces,
                                      pel_pool *pool, pel_stability *stability, pel_error *error)
{
    double stiffness;
    if (iterate(model->rest, model, state, forces, pool, &stiffness) != PEL_OK)
        return pel_fail_memory(error);
    stability->stiffness = pel_min(stiffness, stability->stiffness_bound);
    return PEL_OK;
}

pel_status pel_shell_stability_now(const pel_model *model, const pel_state *state, pel_shell_forces *forces,
                                   pel_pool *pool, double *stiffness)
{
    *stiffness = 0;
    return iterate(state->position, model, state, forces, pool, stiffness);
}
