#include "solve/stability.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "measure/spring.h"

#include <math.h>

enum { ITERATION_LIMIT = 2000 };

typedef struct body_factors {
    double spring, damping, volumetric, volumetric_damping;
} body_factors;

static body_factors factors_of(const pel_model *model, int32_t slice)
{
    const pel_body *body = &model->bodies[model->body_of_slice[slice]];
    double spring = pel_curve_largest(&body->curves[PEL_SPRING_STIFFNESS]);
    return (body_factors){
        .spring = body->uniform_spring >= 0 ? spring * body->uniform_spring : spring,
        .damping = pel_curve_largest(&body->curves[PEL_SPRING_DAMPING]),
        .volumetric = pel_curve_largest(&body->curves[PEL_VOLUMETRIC_STIFFNESS]),
        .volumetric_damping = pel_curve_largest(&body->curves[PEL_VOLUMETRIC_DAMPING]),
    };
}

static bool is_uniform(const pel_model *model, int32_t slice)
{
    return model->bodies[model->body_of_slice[slice]].uniform_spring >= 0;
}

/* stiffness of the spring in one lane of a slot; 0 where the lane is a filler */
static double spring_stiffness(const pel_model *model, int32_t slot, int32_t lane, int32_t vertex,
                               const body_factors *factors, bool uniform)
{
    if (model->neighbours[slot][lane] == vertex)
        return 0;
    return uniform ? factors->spring : factors->spring * (double)model->stiffnesses[slot][lane];
}

/* stiffness of all springs of each vertex of a slice */
static void sum_springs(const pel_model *model, int32_t slice, const body_factors *factors, double sums[PEL_WIDTH])
{
    bool uniform = is_uniform(model, slice);
    for (int32_t lane = 0; lane < PEL_WIDTH; lane++)
        sums[lane] = 0;
    for (int32_t slot = model->slot_begin[slice]; slot < model->slot_end[slice]; slot++)
        for (int32_t lane = 0; lane < PEL_WIDTH; lane++)
            sums[lane] += spring_stiffness(model, slot, lane, slice * PEL_WIDTH + lane, factors, uniform);
}

void pel_stability_bound(const pel_model *model, pel_stability *stability)
{
    *stability = (pel_stability){0};
    for (int32_t slice = 0; slice < model->slice_count; slice++) {
        body_factors factors = factors_of(model, slice);
        double sums[PEL_WIDTH];
        sum_springs(model, slice, &factors, sums);
        for (int32_t lane = 0; lane < PEL_WIDTH; lane++) {
            int32_t v = slice * PEL_WIDTH + lane;
            double inverse_mass = (double)model->inverse_mass[v];
            double stiffness = 2 * sums[lane] + factors.volumetric * (double)model->rest[v][3];
            double drag = factors.damping * (double)model->damping[v];
            double radial = drag + factors.volumetric_damping * (double)model->volumetric_damping[v];
            stability->stiffness_bound = pel_max(stability->stiffness_bound, inverse_mass * stiffness);
            stability->drag = pel_max(stability->drag, inverse_mass * drag);
            stability->radial_drag = pel_max(stability->radial_drag, inverse_mass * radial);
        }
    }
    stability->stiffness = stability->stiffness_bound;
}

/* K u at the rest shape on one vertex: sum of k n (n . (u - u_j)) + k' u */
static void stiffness_product(const pel_model *model, int32_t v, const double (*u)[3], const body_factors *factors,
                              bool uniform, double product[3])
{
    int32_t slice = v / PEL_WIDTH, lane = v % PEL_WIDTH;
    double volumetric = factors->volumetric * (double)model->rest[v][3];
    for (int i = 0; i < 3; i++)
        product[i] = volumetric * u[v][i];
    for (int32_t slot = model->slot_begin[slice]; slot < model->slot_end[slice]; slot++) {
        int32_t j = model->neighbours[slot][lane];
        double k = spring_stiffness(model, slot, lane, v, factors, uniform), along = 0, n[3];
        for (int i = 0; i < 3; i++) {
            n[i] = (double)(model->rest[j][i] - model->rest[v][i]) / (double)pel_model_rest_length(model, slot, v);
            along += n[i] * (u[v][i] - u[j][i]);
        }
        for (int i = 0; i < 3 && k > 0; i++)
            product[i] += k * along * n[i];
    }
}

/* next = M^-1 K u; returns the Rayleigh quotient (u.K u) / (u.M u) */
static double power_step(const pel_model *model, const double (*u)[3], double (*next)[3])
{
    double work = 0, mass = 0, square = 0;
    for (int32_t v = 0; v < model->vertex_count; v++) {
        double inverse_mass = (double)model->inverse_mass[v];
        body_factors factors = factors_of(model, v / PEL_WIDTH);
        if (inverse_mass > 0)
            stiffness_product(model, v, u, &factors, is_uniform(model, v / PEL_WIDTH), next[v]);
        for (int i = 0; i < 3; i++) {
            next[v][i] = inverse_mass > 0 ? next[v][i] : 0;
            work += u[v][i] * next[v][i];
            mass += inverse_mass > 0 ? u[v][i] * u[v][i] / inverse_mass : 0;
            next[v][i] *= inverse_mass;
            square += next[v][i] * next[v][i];
        }
    }
    double scale = square > 0 ? 1 / sqrt(square) : 0;
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            next[v][i] *= scale;
    return mass > 0 ? work / mass : 0;
}

/* deterministic noise, nothing at pinned vertices */
static void start_vector(const pel_model *model, double (*u)[3])
{
    uint32_t seed = 1;
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            seed = seed * 1664525u + 1013904223u;
            u[v][i] = model->inverse_mass[v] > 0 ? (double)seed / 4294967296.0 - 0.5 : 0;
        }
}

pel_status pel_stability_refine(const pel_model *model, pel_stability *stability, pel_error *error)
{
    double(*u)[3] = pel_allocate((size_t)model->vertex_count, sizeof *u);
    double(*next)[3] = pel_allocate((size_t)model->vertex_count, sizeof *next);
    if (u == NULL || next == NULL) {
        pel_free(u);
        pel_free(next);
        return pel_fail_memory(error);
    }
    start_vector(model, u);
    double value = 0, before = -1;
    for (int32_t n = 0; n < ITERATION_LIMIT && (n < 50 || fabs(value - before) > 1e-7 * value); n++) {
        before = value;
        value = power_step(model, (const double(*)[3])u, next);
        double(*swap)[3] = u;
        u = next;
        next = swap;
    }
    pel_free(u);
    pel_free(next);
    /* the quotient converges from below: keep a margin for the remaining error */
    stability->stiffness = pel_min(1.001 * value, stability->stiffness_bound);
    return PEL_OK;
}

double pel_stability_alpha(const pel_stability *stability, double stiffness, double dt, bool keep_velocity)
{
    if (!keep_velocity)
        return 2 / (dt * dt * stiffness);
    double drag = dt * stability->radial_drag;
    return pel_min(1 / drag, 2 / (dt * dt * stiffness + 2 * drag));
}

double pel_stability_dt(const pel_stability *stability, double stiffness, bool symplectic)
{
    double drag = stability->radial_drag;
    if (symplectic)
        return 4 / (sqrt(drag * drag + 4 * stiffness) + drag);
    double oscillating = stability->drag / stiffness;
    double creeping = HUGE_VAL;
    if (drag * drag > 4 * stiffness)
        creeping = 4 / (drag + sqrt(drag * drag - 4 * stiffness));
    return pel_min(oscillating, creeping);
}
