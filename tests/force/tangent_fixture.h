/* A model with its tangent, unknowns and dense Hessian. */
#ifndef PEL_TESTS_TANGENT_FIXTURE_H
#define PEL_TESTS_TANGENT_FIXTURE_H

#include "dense.h"
#include "shell_fixture.h"

#include "force/tangent.h"

typedef struct tangents {
    pel_model *model;
    pel_tangent *tangent;
    const pel_tangent_pattern *pattern;
    int32_t count;    /* unknowns */
    double *unknowns; /* (count) */
    double *gradient; /* (count) */
    double *stresses; /* (stress_count) */
    double *hessian;  /* (count x count) */
    pel_tangent_energy energy;
} tangents;

/* positions of the mesh, for any precision of the model */
static inline void set_rest_unknowns(tangents *on)
{
    for (int32_t b = 0; b < on->model->body_count; b++) {
        const pel_body *body = &on->model->bodies[b];
        for (int32_t v = 0; v < body->mesh->vertex_count; v++)
            pel_vec3_copy(body->mesh->positions[v], on->unknowns + 3 * (size_t)body->model_index[v]);
    }
}

static inline tangents make_tangents_of(pel_model *model)
{
    tangents made = {.model = model};
    assert_int_equal(pel_tangent_create(made.model, &made.tangent, NULL), PEL_OK);
    made.pattern = pel_tangent_pattern_of(made.tangent);
    made.count = made.pattern->unknown_count;
    size_t count = (size_t)made.count;
    made.unknowns = calloc(count, sizeof(double));
    made.gradient = calloc(count, sizeof(double));
    made.hessian = calloc(count * count, sizeof(double));
    made.stresses = calloc((size_t)made.pattern->stress_count + 1, sizeof(double));
    set_rest_unknowns(&made);
    return made;
}

static inline tangents make_tangents(const pel_body_def *body)
{
    return make_tangents_of(make_model(body));
}

static inline void free_tangents(tangents *made)
{
    pel_tangent_destroy(made->tangent);
    free(made->unknowns);
    free(made->gradient);
    free(made->hessian);
    free(made->stresses);
    pel_model_destroy(made->model);
}

/* first unknown of a node, and how many it has */
static inline int32_t first_unknown(const pel_tangent_pattern *pattern, int32_t node, int *size)
{
    *size = node < pattern->vertex_count ? 3 : 1;
    return node < pattern->vertex_count ? 3 * node : 2 * pattern->vertex_count + node;
}

/* adds an element's matrix to the dense Hessian */
static inline void add_element(tangents *on, int32_t element, const double *matrix)
{
    const int32_t *nodes = on->pattern->nodes + on->pattern->node_begin[element];
    int32_t node_count = on->pattern->node_begin[element + 1] - on->pattern->node_begin[element];
    int32_t unknowns[24], n = 0;
    for (int32_t k = 0; k < node_count; k++) {
        int size;
        int32_t first = first_unknown(on->pattern, nodes[k], &size);
        for (int c = 0; c < size; c++)
            unknowns[n++] = first + c;
    }
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j < n; j++)
            on->hessian[(size_t)unknowns[i] * (size_t)on->count + (size_t)unknowns[j]] += matrix[i * n + j];
}

static inline void add_rank_ones(tangents *on)
{
    for (int32_t r = 0; r < on->pattern->rank_one_count; r++) {
        const pel_rank_one *rank = &on->pattern->rank_ones[r];
        int32_t first = 3 * rank->first_vertex, count = 3 * rank->vertex_count;
        for (int32_t i = 0; i < count; i++)
            for (int32_t j = 0; j < count; j++)
                on->hessian[(size_t)(first + i) * (size_t)on->count + (size_t)(first + j)] +=
                    rank->coefficient * rank->gradient[i] * rank->gradient[j];
    }
}

/* energy, gradient and Hessian at the unknowns */
static inline void evaluate_tangents(tangents *on, pel_tangent_input input)
{
    input.unknowns = on->unknowns;
    memset(on->hessian, 0, (size_t)on->count * (size_t)on->count * sizeof(double));
    on->energy = pel_tangent_evaluate(on->tangent, &input, NULL, on->gradient);
    for (int32_t element = 0; element < on->pattern->element_count; element++) {
        double matrix[144];
        pel_tangent_matrices(on->tangent, &element, 1, matrix);
        add_element(on, element, matrix);
    }
    add_rank_ones(on);
}

static inline double energy_after(tangents *on, pel_tangent_input input, const double *step, double scale)
{
    double *moved = malloc((size_t)on->count * sizeof *moved);
    memcpy(moved, on->unknowns, (size_t)on->count * sizeof *moved);
    pel_tangent_advance(on->tangent, moved, step, scale, NULL);
    input.unknowns = moved;
    pel_tangent_energy energy = pel_tangent_evaluate(on->tangent, &input, NULL, NULL);
    free(moved);
    return pel_tangent_energy_sum(&energy);
}

/* one step of Newton's method by mixed integration points on the unknowns that are free, under a constant load (count);
   returns the largest move of a vertex. The first call of a solve has to start with mixed = false */
static inline double newton_step(tangents *on, const double *load, const uint8_t *is_fixed, double largest_step,
                                 bool mixed)
{
    int32_t *free_unknowns = malloc((size_t)on->count * sizeof *free_unknowns), n = 0;
    for (int32_t i = 0; i < on->count; i++)
        if (!is_fixed[i])
            free_unknowns[n++] = i;
    double *matrix = malloc((size_t)n * (size_t)n * sizeof *matrix), *x = malloc((size_t)n * sizeof *x);
    double *step = calloc((size_t)on->count, sizeof *step), largest = 0;
    bool definite = false;
    for (int attempt = 0; attempt < 2 && !definite; attempt++) {
        pel_tangent_input input = {.stresses = mixed ? on->stresses : NULL};
        input.kind = attempt == 0 ? PEL_TANGENT_EXACT : PEL_TANGENT_POSITIVE;
        evaluate_tangents(on, input);
        for (int32_t i = 0; i < n; i++) {
            x[i] = load[free_unknowns[i]] - on->gradient[free_unknowns[i]];
            for (int32_t j = 0; j < n; j++)
                matrix[(size_t)i * (size_t)n + (size_t)j] =
                    on->hessian[(size_t)free_unknowns[i] * (size_t)on->count + (size_t)free_unknowns[j]];
        }
        definite = dense_factor(matrix, n);
    }
    assert_true(definite);
    dense_solve(matrix, n, x);
    for (int32_t i = 0; i < n; i++) {
        step[free_unknowns[i]] = x[i];
        if (free_unknowns[i] < 3 * on->pattern->vertex_count)
            largest = fmax(largest, fabs(x[i]));
    }
    double scale = largest > largest_step ? largest_step / largest : 1;
    for (int32_t i = 0; i < on->count; i++)
        step[i] *= scale;
    const pel_tangent_input here = {.unknowns = on->unknowns};
    pel_tangent_extrapolate(on->tangent, &here, step, NULL, on->stresses);
    pel_tangent_advance(on->tangent, on->unknowns, step, 1, NULL);
    free(free_unknowns);
    free(matrix);
    free(x);
    free(step);
    return scale * largest;
}

/* solves to 1e-9 of `size`; returns the iterations, or -1 after `most` */
static inline int solve_static(tangents *on, const double *load, const uint8_t *is_fixed, double size, int most)
{
    for (int i = 0; i < most; i++)
        if (newton_step(on, load, is_fixed, 0.5 * size, i > 0) < 1e-9 * size)
            return i + 1;
    return -1;
}

#endif
