/* Tangents of whole models: against differences of the energy, the forces of the other loops, threads, allocation. */
#include "failing_malloc.h"
#include "force/body_force.h"
#include "force/pressure.h"
#include "force/shell_body.h"
#include "force/shell_force.h"
#include "force/tangent.h"
#include "force/tangent_body.h"
#include "law_forms.h"
#include "pellicle/shape.h"
#include "refined/refined_model.h"
#include "tangent_fixture.h"

/* differences between the tested bodies */
typedef struct variant {
    const char *name;
    pel_bending_model bending;
    pel_pressure_kind pressure;
    bool springs, fibres, open;
} variant;

static const variant variants[] = {
    {"springs", PEL_BENDING_NONE, PEL_PRESSURE_NONE, true, false, false},
    {"hinges", PEL_BENDING_HINGE, PEL_PRESSURE_GIVEN, false, true, false},
    {"isometric", PEL_BENDING_ISOMETRIC_REST, PEL_PRESSURE_VOLUME, true, false, false},
    {"midedge", PEL_BENDING_MIDEDGE, PEL_PRESSURE_GAS, false, true, false},
    {"sheet", PEL_BENDING_MIDEDGE, PEL_PRESSURE_NONE, false, false, true},
};
enum { VARIANT_COUNT = sizeof variants / sizeof *variants };

static const pel_anisotropy_def *fibre_regions(void)
{
    static pel_anisotropy_def regions[3];
    regions[0] = regions[1] = regions[2] = pel_anisotropy_def_default();
    regions[0].mode = PEL_FIBRE_ACTIVE;
    regions[0].direction = PEL_FIBRE_ALONG;
    regions[0].stiffness = 300;
    regions[0].rest_length.value = 0.8;
    regions[1].mode = PEL_FIBRE_STRAIN;
    regions[1].kind = PEL_FIBRE_STVK;
    regions[1].stiffness = 200;
    regions[1].center[0] = 3;
    regions[2].mode = PEL_FIBRE_MUSCLE;
    regions[2].tension = 250;
    regions[2].activation.value = 0.6;
    regions[2].optimum = 1.1;
    regions[2].center[1] = 3;
    return regions;
}

static pel_body_def body_of(const variant *v, const pel_mesh *mesh)
{
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_NEO_HOOKEAN);
    body.shell.membrane.thickness.value = 0.05;
    body.shell.membrane.on = v->bending != PEL_BENDING_NONE;
    body.shell.bending.model = v->bending;
    body.shell.pressure.kind = v->pressure;
    body.shell.pressure.value = 2000;
    body.shell.pressure.outside.value = -500;
    body.shell.pressure.target.value = 1.1;
    body.shell.pressure.bulk = 3000;
    if (v->springs) {
        body.spring_stiffness.value = 40;
        body.volumetric_stiffness.value = 3;
    }
    if (v->fibres) {
        body.shell.anisotropies = fibre_regions();
        body.shell.anisotropy_count = 3;
    }
    return body;
}

static pel_mesh *mesh_of(const variant *v, random_state *random)
{
    return v->open ? make_irregular_patch(4, random) : make_irregular_ball(2, random);
}

/* moves positions and rotations of edges about */
static void shake_unknowns(tangents *on, double size, random_state *random)
{
    double *step = calloc((size_t)on->count, sizeof *step);
    for (int32_t i = 0; i < on->count; i++)
        if (i >= 3 * on->pattern->vertex_count || on->model->mass[i / 3] > 0)
            step[i] = random_between(random, -size, size);
    pel_tangent_advance(on->tangent, on->unknowns, step, 1, NULL);
    free(step);
}

/* first and second derivative of the energy along random steps, finite in the rotations of edges */
static void energies_have_these_derivatives(void **unused)
{
    (void)unused;
    random_state random = {1};
    for (int k = 0; k < VARIANT_COUNT; k++) {
        pel_mesh *mesh = mesh_of(&variants[k], &random);
        pel_body_def body = body_of(&variants[k], mesh);
        tangents on = make_tangents(&body);
        double *step = calloc((size_t)on.count, sizeof *step);
        shake_unknowns(&on, 0.05, &random);
        const pel_tangent_input input = {.span = pel_instant(0.5)};
        evaluate_tangents(&on, input);
        for (int round = 0; round < 40; round++) {
            double expected = 0, curvature = 0, size = 0, first[3], second[3];
            /* all unknowns, or the unknowns of one element */
            int32_t element = (int32_t)random_integer(&random, 0, on.pattern->element_count - 1);
            memset(step, 0, (size_t)on.count * sizeof *step);
            for (int32_t i = on.pattern->node_begin[element]; i < on.pattern->node_begin[element + 1]; i++) {
                int count;
                int32_t at = first_unknown(on.pattern, on.pattern->nodes[i], &count);
                for (int c = 0; c < count; c++)
                    step[at + c] = random_between(&random, -1, 1);
            }
            for (int32_t i = 0; round % 2 == 0 && i < on.count; i++)
                step[i] = random_between(&random, -1, 1);
            for (int32_t i = 0; i < on.count; i++) {
                expected += on.gradient[i] * step[i];
                size += fabs(on.gradient[i] * step[i]);
                for (int32_t j = 0; step[i] != 0 && j < on.count; j++)
                    curvature += step[i] * on.hessian[(size_t)i * (size_t)on.count + (size_t)j] * step[j];
            }
            double here = energy_after(&on, input, step, 0), scale = 0;
            for (int h = 0; h < 3; h++) {
                double length = 4e-3 / (1 << h);
                double above = energy_after(&on, input, step, length), below = energy_after(&on, input, step, -length);
                first[h] = (above - below) / (2 * length);
                second[h] = (above - 2 * here + below) / (length * length);
                scale = fmax(scale, fabs(second[h]));
            }
            for (int h = 0; h < 2; h++) {
                first[h] = (4 * first[h + 1] - first[h]) / 3;
                second[h] = (4 * second[h + 1] - second[h]) / 3;
            }
            double slope = (16 * first[1] - first[0]) / 15, curved = (16 * second[1] - second[0]) / 15;
            if (!(fabs(slope - expected) <= 1e-7 * size + 1e-9) || !(fabs(curved - curvature) <= 1e-5 * scale))
                print_error("%s, round %d\n", variants[k].name, round);
            assert_near(slope, expected, 1e-7 * size + 1e-9);
            assert_near(curved, curvature, 1e-5 * scale);
        }
        free(step);
        free_tangents(&on);
        pel_mesh_destroy(mesh);
    }
}

/* gradient and energies equal those of the loops of explicit methods */
static void gradients_are_the_forces(void **unused)
{
    (void)unused;
    random_state random = {2};
    const double tolerance = sizeof(pel_real) == 8 ? 1e-9 : 1e-3;
    for (int k = 0; k < VARIANT_COUNT; k++)
        for (int form = 0; form < 2; form++) {
            if (variants[k].bending == PEL_BENDING_MIDEDGE)
                continue;
            pel_mesh *mesh = mesh_of(&variants[k], &random);
            pel_body_def body = body_of(&variants[k], mesh);
            body.shell.pressure.form = (pel_pressure_form)form;
            tangents on = make_tangents(&body);
            pel_state *state = make_state(on.model);
            pel_shell_forces *shells;
            pel_batches *batches;
            pel_record *force = make_records(on.model);
            assert_int_equal(pel_batches_create(on.model, PEL_METHOD_EXPLICIT, &batches, NULL), PEL_OK);
            assert_int_equal(pel_shell_forces_create(batches, &shells, NULL), PEL_OK);
            shake(on.model, state->position, 0.05, &random);
            for (int32_t v = 0; v < on.model->vertex_count; v++)
                pel_vertex_position(state->position, v, on.unknowns + 3 * v);
            pel_body_forces(on.model, state, NULL, NULL, force);
            pel_shell_energy energy =
                pel_shell_forces_add(shells, state->position, pel_instant(0.5), PEL_SHELL_ALL, NULL, force);
            const pel_tangent_input input = {.span = pel_instant(0.5), .state = state};
            evaluate_tangents(&on, input);
            double size = 0;
            for (int32_t i = 0; i < 3 * on.model->vertex_count; i++)
                size = fmax(size, fabs(on.gradient[i]));
            for (int32_t i = 0; i < 3 * on.model->vertex_count; i++)
                assert_near(on.gradient[i], -(double)force[i / 3][i % 3], tolerance * size);
            double total = pel_tangent_energy_sum(&on.energy);
            assert_near(on.energy.membrane, energy.membrane, tolerance * total);
            assert_near(on.energy.bending, energy.bending, tolerance * total);
            assert_near(on.energy.fibres, energy.fibres, tolerance * total);
            assert_near(on.energy.pressure, energy.pressure, tolerance * total);
            free(force);
            pel_shell_forces_destroy(shells);
            pel_batches_destroy(batches);
            pel_state_destroy(state);
            free_tangents(&on);
            pel_mesh_destroy(mesh);
        }
}

static void springs_to_points_pull(void **unused)
{
    (void)unused;
    random_state random = {3};
    pel_mesh *mesh = make_irregular_patch(3, &random);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    tangents on = make_tangents(&body);
    size_t count = (size_t)on.model->vertex_count;
    double *stiffness = calloc(count, sizeof *stiffness), (*points)[3] = calloc(count, sizeof *points);
    int32_t v = on.model->bodies[0].model_index[5];
    evaluate_tangents(&on, (pel_tangent_input){0});
    double before = on.hessian[(size_t)(3 * v + 1) * (size_t)on.count + (size_t)(3 * v + 1)];
    stiffness[v] = 7;
    pel_vec3_copy(on.unknowns + 3 * v, points[v]);
    points[v][1] += 0.25;
    const pel_tangent_input input = {.point_stiffness = stiffness, .points = (const double(*)[3])points};
    evaluate_tangents(&on, input);
    assert_near(on.energy.points, 0.5 * 7 * 0.0625, 1e-15);
    assert_near(on.gradient[3 * v + 1], -7 * 0.25, 1e-11); /* beside forces of stiffness 1e3 times rounding */
    assert_near(on.hessian[(size_t)(3 * v + 1) * (size_t)on.count + (size_t)(3 * v + 1)], before + 7, 1e-9 * before);
    free(stiffness);
    free(points);
    free_tangents(&on);
    pel_mesh_destroy(mesh);
}

/* the stresses of a state, given to its own matrices, change nothing; those of another one do */
static void stresses_stand_by_element(void **unused)
{
    (void)unused;
    random_state random = {9};
    for (int k = 0; k < VARIANT_COUNT; k++) {
        pel_mesh *mesh = mesh_of(&variants[k], &random);
        pel_body_def body = body_of(&variants[k], mesh);
        tangents on = make_tangents(&body);
        size_t count = (size_t)on.count;
        double *step = calloc(count, sizeof *step), *own = calloc(count * count, sizeof *own), difference[2] = {0, 0};
        double size = 0;
        shake_unknowns(&on, 0.05, &random);
        evaluate_tangents(&on, (pel_tangent_input){0});
        memcpy(own, on.hessian, count * count * sizeof *own);
        for (int pass = 0; pass < 2; pass++) {
            const pel_tangent_input here = {.unknowns = on.unknowns};
            pel_tangent_extrapolate(on.tangent, &here, step, NULL, on.stresses);
            evaluate_tangents(&on, (pel_tangent_input){.stresses = on.stresses});
            for (size_t i = 0; i < count * count; i++) {
                difference[pass] = fmax(difference[pass], fabs(on.hessian[i] - own[i]));
                size = fmax(size, fabs(own[i]));
            }
            for (size_t i = 0; i < count; i++)
                step[i] = random_between(&random, -0.1, 0.1);
        }
        assert_true(difference[0] <= 1e-13 * size);
        assert_true(difference[1] > 1e-3 * size);
        free(step);
        free(own);
        free_tangents(&on);
        pel_mesh_destroy(mesh);
    }
}

/* stresses from another state leave the matrices of the last evaluation as they are: pressure, angles of edges */
static void extrapolation_keeps_the_evaluation(void **unused)
{
    (void)unused;
    random_state random = {14};
    for (int k = 0; k < VARIANT_COUNT; k++) {
        pel_mesh *mesh = mesh_of(&variants[k], &random);
        pel_body_def body = body_of(&variants[k], mesh);
        tangents on = make_tangents(&body);
        size_t count = (size_t)on.count, numbers = 144 * (size_t)on.pattern->element_count;
        double *before = calloc(count, sizeof *before), *matrices[2];
        memcpy(before, on.unknowns, count * sizeof *before);
        shake_unknowns(&on, 0.05, &random);
        evaluate_tangents(&on, (pel_tangent_input){0});
        for (int pass = 0; pass < 2; pass++) {
            matrices[pass] = calloc(numbers, sizeof *matrices[pass]);
            for (int32_t e = 0; e < on.pattern->element_count; e++)
                pel_tangent_matrices(on.tangent, &e, 1, matrices[pass] + 144 * (size_t)e);
            const pel_tangent_input there = {.unknowns = before};
            pel_tangent_extrapolate(on.tangent, &there, on.gradient, NULL, on.stresses);
        }
        assert_memory_equal(matrices[0], matrices[1], numbers * sizeof(double));
        for (int pass = 0; pass < 2; pass++)
            free(matrices[pass]);
        free(before);
        free_tangents(&on);
        pel_mesh_destroy(mesh);
    }
}

/* a loop over elements in groups of one kind, as an assembly has it */
typedef struct kept_matrices {
    double *matrices; /* (elements x 144) */
    pel_tangent *tangent;
} kept_matrices;

static void keep_matrices(void *context, int32_t chunk)
{
    kept_matrices *kept = context;
    const pel_tangent_pattern *pattern = pel_tangent_pattern_of(kept->tangent);
    const int32_t elements[2] = {2 * chunk, 2 * chunk + 1};
    bool pair = elements[1] < pattern->element_count &&
                pattern->element_kind[elements[0]] == pattern->element_kind[elements[1]];
    double blocks[288] = {0};
    pel_tangent_matrices(kept->tangent, elements, pair ? 2 : 1, blocks);
    memcpy(kept->matrices + 288 * (size_t)chunk, blocks, sizeof blocks);
    if (!pair && elements[1] < pattern->element_count)
        pel_tangent_matrices(kept->tangent, elements + 1, 1, kept->matrices + 288 * (size_t)chunk + 144);
}

static void threads_give_the_same_bits(void **unused)
{
    (void)unused;
    random_state random = {4};
    pel_mesh *mesh = make_sphere(8);
    pel_body_def body = body_of(&variants[3], mesh);
    pel_model *model = make_model(&body);
    pel_tangent *tangent;
    assert_int_equal(pel_tangent_create(model, &tangent, NULL), PEL_OK);
    const pel_tangent_pattern *pattern = pel_tangent_pattern_of(tangent);
    size_t count = (size_t)pattern->unknown_count, numbers = 144 * ((size_t)pattern->element_count + 1);
    double *unknowns[3], *gradient[3], *stresses[3], *step = calloc(count, sizeof *step);
    kept_matrices kept[3];
    for (size_t i = 0; i < count; i++)
        step[i] = random_between(&random, -0.02, 0.02);
    for (int k = 0; k < 3; k++) {
        pel_pool *pool;
        assert_int_equal(pel_pool_create(1 << k, &pool, NULL), PEL_OK);
        unknowns[k] = calloc(count, sizeof(double));
        gradient[k] = calloc(count, sizeof(double));
        stresses[k] = calloc((size_t)pattern->stress_count, sizeof(double));
        kept[k] = (kept_matrices){calloc(numbers, sizeof(double)), tangent};
        for (int32_t v = 0; v < model->vertex_count; v++)
            pel_vertex_position(model->rest, v, unknowns[k] + 3 * v);
        const pel_tangent_input input = {.unknowns = unknowns[k]};
        pel_tangent_extrapolate(tangent, &input, step, pool, stresses[k]);
        pel_tangent_advance(tangent, unknowns[k], step, 1, pool);
        const pel_tangent_input mixed = {.unknowns = unknowns[k], .stresses = stresses[k]};
        pel_tangent_energy energy = pel_tangent_evaluate(tangent, &mixed, pool, gradient[k]);
        pel_pool_run(pool, (pattern->element_count + 1) / 2, keep_matrices, &kept[k]);
        gradient[k][0] += pel_tangent_energy_sum(&energy);
        pel_pool_destroy(pool);
        assert_memory_equal(unknowns[k], unknowns[0], count * sizeof(double));
        assert_memory_equal(gradient[k], gradient[0], count * sizeof(double));
        assert_memory_equal(stresses[k], stresses[0], (size_t)pattern->stress_count * sizeof(double));
        assert_memory_equal(kept[k].matrices, kept[0].matrices, numbers * sizeof(double));
    }
    for (int k = 0; k < 3; k++) {
        free(unknowns[k]);
        free(gradient[k]);
        free(stresses[k]);
        free(kept[k].matrices);
    }
    free(step);
    pel_tangent_destroy(tangent);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static pel_status create_tangent(const void *model, pel_error *error)
{
    pel_tangent *tangent;
    pel_status status = pel_tangent_create(model, &tangent, error);
    assert_true((tangent == NULL) == (status != PEL_OK));
    pel_tangent_destroy(tangent);
    return status;
}

static void allocations_may_fail(void **unused)
{
    (void)unused;
    random_state random = {5};
    pel_mesh *mesh = make_irregular_ball(1, &random);
    pel_body_def body = body_of(&variants[3], mesh);
    body.shell.pressure.form = PEL_PRESSURE_VERTEX_NORMAL;
    pel_model *model = make_model(&body);
    assert_true(for_every_allocation_failure(create_tangent, model) > 20);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void steps_allocate_nothing(void **unused)
{
    (void)unused;
    random_state random = {6};
    pel_mesh *mesh = make_irregular_ball(2, &random);
    pel_body_def body = body_of(&variants[3], mesh);
    tangents on = make_tangents(&body);
    const pel_tangent_input input = {.unknowns = on.unknowns};
    failing_malloc_begin(0);
    pel_tangent_evaluate(on.tangent, &input, NULL, on.gradient);
    pel_tangent_matrices(on.tangent, &(int32_t){3}, 1, on.hessian);
    pel_tangent_extrapolate(on.tangent, &input, on.gradient, NULL, on.stresses);
    pel_tangent_settle_edges(on.tangent, on.unknowns, NULL);
    pel_tangent_rebuild(on.tangent);
    assert_int_equal(failing_malloc_end().calls, 0);
    free_tangents(&on);
    pel_mesh_destroy(mesh);
}

static void bending_needs_a_stiffness(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(2, 2, 1, 1, PEL_GRID_ONE_DIAGONAL);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.membrane.on = false;
    body.shell.bending.model = PEL_BENDING_MIDEDGE;
    pel_model *model = make_model(&body);
    pel_tangent *tangent;
    pel_error error;
    assert_int_equal(pel_tangent_create(model, &tangent, &error), PEL_BAD_ARGUMENT);
    assert_null(tangent);
    assert_non_null(strstr(error.what, "no stiffness"));
    assert_true(error.remedy[0] != '\0');
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* edges settle where no rotation has a gradient, and fixed ones stay */
static void edges_settle(void **unused)
{
    (void)unused;
    random_state random = {7};
    pel_mesh *mesh = make_irregular_patch(6, &random);
    pel_body_def body = body_of(&variants[4], mesh);
    tangents on = make_tangents(&body);
    int32_t edges = on.pattern->edge_count, first = 3 * on.pattern->vertex_count;
    uint8_t *is_fixed = calloc((size_t)edges, 1);
    shake_unknowns(&on, 0.05, &random);
    evaluate_tangents(&on, (pel_tangent_input){0});
    double before = on.energy.edges, kept[2] = {on.unknowns[first], on.unknowns[first + 7]}, size = 0;
    is_fixed[0] = is_fixed[7] = 1;
    for (int32_t e = 0; e < edges; e++)
        size = fmax(size, fabs(on.gradient[first + e]));
    int iterations = pel_tangent_settle_edges(on.tangent, on.unknowns, is_fixed);
    assert_in_range(iterations, 5, 60);
    evaluate_tangents(&on, (pel_tangent_input){0});
    for (int32_t e = 0; e < edges; e++)
        if (!is_fixed[e])
            assert_near(on.gradient[first + e], 0, 1e-10 * size);
    assert_true(fabs(on.gradient[first]) > 1e-3 * size);
    assert_true(on.energy.edges < 0.9 * before);
    assert_true(on.unknowns[first] == kept[0] && on.unknowns[first + 7] == kept[1]);
    free(is_fixed);
    free_tangents(&on);
    pel_mesh_destroy(mesh);
}

/* after an event the lists equal those of a new tangent of the same surface */
static void surfaces_may_refine(void **unused)
{
    (void)unused;
    random_state random = {8};
    pel_mesh *mesh = make_irregular_ball(2, &random);
    pel_body_def body = body_of(&variants[3], mesh);
    body.refine.levels = 2;
    pel_model *model = make_model(&body);
    pel_refined_model *active;
    pel_state *state;
    assert_int_equal(pel_refined_create(model, &active, NULL), PEL_OK);
    assert_int_equal(pel_state_create(&active->model, false, &state, NULL), PEL_OK);
    pel_tangent *tangent, *fresh;
    assert_int_equal(pel_tangent_create(&active->model, &tangent, NULL), PEL_OK);
    const pel_tangent_pattern *pattern = pel_tangent_pattern_of(tangent);
    int32_t edges = pattern->edge_count;
    assert_int_equal(edges, 120);
    pel_front *front = active->bodies[0].front;
    pel_front_mark(front, 3, true);
    pel_front_close(front);
    pel_refined_commit(active, 0, state);
    failing_malloc_begin(0);
    pel_tangent_rebuild(tangent);
    assert_int_equal(failing_malloc_end().calls, 0);
    assert_true(pattern->edge_count > edges);
    assert_int_equal(pel_tangent_create(&active->model, &fresh, NULL), PEL_OK);
    const pel_tangent_pattern *expected = pel_tangent_pattern_of(fresh);
    assert_int_equal(pattern->element_count, expected->element_count);
    assert_int_equal(pattern->stress_count, expected->stress_count);
    assert_memory_equal(pattern->node_begin, expected->node_begin,
                        ((size_t)pattern->element_count + 1) * sizeof(int32_t));
    assert_memory_equal(pattern->nodes, expected->nodes,
                        (size_t)pattern->node_begin[pattern->element_count] * sizeof(int32_t));
    /* the surface at rest has no bending energy: rest angles come from the refined rest shape */
    double *unknowns = calloc((size_t)pattern->unknown_count, sizeof *unknowns);
    for (int32_t v = 0; v < active->model.vertex_count; v++)
        pel_vertex_position(active->model.rest, v, unknowns + 3 * v);
    const pel_tangent_input input = {.unknowns = unknowns};
    pel_tangent_energy rest = pel_tangent_evaluate(tangent, &input, NULL, NULL);
    unknowns[3 * pattern->nodes[0]] += 0.01;
    pel_tangent_energy moved = pel_tangent_evaluate(tangent, &input, NULL, NULL);
    assert_near(rest.edges, 0, (sizeof(pel_real) == 8 ? 1e-12 : 1e-5) * moved.edges);
    free(unknowns);
    pel_tangent_destroy(tangent);
    pel_tangent_destroy(fresh);
    pel_state_destroy(state);
    pel_refined_destroy(active);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* the free part of c g (g . x), of each body at its vertices, and nothing where c is 0 */
static void rank_ones_are_outer_products(void **unused)
{
    (void)unused;
    enum { VERTICES = 7, COUNT = 3 * VERTICES };
    random_state random = {31};
    double gradients[3][COUNT], x[COUNT], y[COUNT], expected[COUNT];
    uint8_t fixed[COUNT];
    for (int i = 0; i < COUNT; i++) {
        for (int r = 0; r < 3; r++)
            gradients[r][i] = random_normal(&random);
        x[i] = random_normal(&random);
        expected[i] = y[i] = random_normal(&random);
        fixed[i] = i % 4 == 1;
    }
    const pel_rank_one ones[3] = {{2.5, 0, 3, gradients[0]}, {0, 1, 4, gradients[1]}, {0.75, 3, 4, gradients[2]}};
    for (int r = 0; r < 3; r++)
        for (int32_t i = 0; i < 3 * ones[r].vertex_count; i++)
            for (int32_t j = 0; j < 3 * ones[r].vertex_count; j++) {
                int32_t row = 3 * ones[r].first_vertex + i, column = 3 * ones[r].first_vertex + j;
                if (!fixed[row] && !fixed[column])
                    expected[row] += ones[r].coefficient * ones[r].gradient[i] * ones[r].gradient[j] * x[column];
            }
    const pel_tangent_pattern pattern = {.vertex_count = VERTICES, .rank_one_count = 3, .rank_ones = ones};
    pel_tangent_add_rank_ones(&pattern, fixed, x, y);
    for (int i = 0; i < COUNT; i++)
        assert_near(y[i], expected[i], 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(energies_have_these_derivatives),
        cmocka_unit_test(gradients_are_the_forces),
        cmocka_unit_test(springs_to_points_pull),
        cmocka_unit_test(stresses_stand_by_element),
        cmocka_unit_test(extrapolation_keeps_the_evaluation),
        cmocka_unit_test(threads_give_the_same_bits),
        cmocka_unit_test(allocations_may_fail),
        cmocka_unit_test(steps_allocate_nothing),
        cmocka_unit_test(bending_needs_a_stiffness),
        cmocka_unit_test(edges_settle),
        cmocka_unit_test(surfaces_may_refine),
        cmocka_unit_test(rank_ones_are_outer_products),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
