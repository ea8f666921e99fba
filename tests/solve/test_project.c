/* Position-based dynamics as a whole: layout, momentum, what the answer depends on, determinism, snapshots. */
#include "failing_malloc.h"
#include "shell_fixture.h"

#include "model/state.h"
#include "pellicle/sim_ledger.h"
#include "solve/project.h"

#include <stdlib.h>

static pel_body_def stiff_body(const pel_mesh *mesh)
{
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.membrane.young.value = 1e6;
    body.shell.bending.model = PEL_BENDING_HINGE;
    return body;
}

static pel_sim_def projected(const pel_model *model, pel_method method)
{
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver = (pel_solver_def){.method = method, .dt = 1.0 / 60};
    def.thread_count = 1;
    return def;
}

static const pel_method methods[3] = {PEL_METHOD_PBD, PEL_METHOD_PBD_DISTANCE, PEL_METHOD_XPBD};

/* ---- layout ---- */

/* places of the used lanes of a block; returns how many */
static int32_t places_of(const pel_batch *batch, int32_t block, int32_t *places)
{
    int32_t count = 0;
    for (int32_t lane = 0; lane < batch->lane_counts[block]; lane++)
        for (int k = 0; k < batch->arity; k++)
            places[count++] = batch->steps[(block * batch->arity + k) * PEL_BLOCK + lane] / PEL_STEP;
    return count;
}

/* the blocks that are computed together share no vertex, and the groups of a bundle are those of its blocks */
static void check_groups(const pel_batch *batch, int32_t begin, int32_t end)
{
    int32_t block = begin;
    while (block < end) {
        int32_t places[PEL_BATCH_GROUP * 4 * PEL_BLOCK], count = 0, last = block + batch->followers[block];
        assert_true(last - block < PEL_BATCH_GROUP);
        for (; block <= last; block++)
            count += places_of(batch, block, places + count);
        for (int32_t a = 0; a < count; a++)
            for (int32_t b = 0; b < a; b++)
                assert_int_not_equal(places[a], places[b]);
    }
    assert_int_equal(block, end);
}

/* every constraint stands in one used lane, lanes of a group of blocks share no vertex, bundles of a phase neither */
static void check_layout(const pel_projector *projector, int32_t expected[3])
{
    const pel_body_batches *body = &projector->batches->bodies[0];
    int32_t *owner = calloc((size_t)projector->model->vertex_count, sizeof *owner);
    for (int32_t i = 0; i < body->batch_count; i++) {
        const pel_batch *batch = &body->batches[i];
        int32_t count = 0;
        for (int32_t block = 0; block < batch->block_count; block++)
            count += batch->lane_counts[block];
        for (int32_t n = 0; n < 2 * body->pieces.piece_count; n++)
            check_groups(batch, batch->bundle_begin[n], batch->bundle_begin[n + 1]);
        assert_int_equal(count, expected[batch->arity - 2]);
    }
    for (int phase = 0; phase < PEL_PHASE_COUNT; phase++) {
        memset(owner, 0, (size_t)projector->model->vertex_count * sizeof *owner);
        for (int32_t n = projector->batches->phase_begin[phase]; n < projector->batches->phase_begin[phase + 1]; n++)
            for (int32_t i = 0; i < body->batch_count; i++) {
                const pel_batch *batch = &body->batches[i];
                int32_t number = projector->batches->bundles[n].number, width = batch->arity * PEL_BLOCK;
                for (int32_t at = batch->bundle_begin[number] * width; at < batch->bundle_begin[number + 1] * width;
                     at++) {
                    int32_t v = batch->steps[at] / PEL_STEP;
                    assert_true(owner[v] == 0 || owner[v] == n + 1);
                    owner[v] = n + 1;
                }
            }
    }
    free(owner);
}

static void test_layout(void **unused)
{
    (void)unused;
    for (int32_t frequency = 1; frequency <= 32; frequency *= 2) {
        pel_mesh *mesh = make_sphere(frequency);
        pel_body_def def = stiff_body(mesh);
        def.spring_stiffness.value = 1;
        pel_model *model = make_model(&def);
        const pel_solver_def solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .iterations = 1, .substeps = 1};
        pel_batches *batches;
        pel_projector *projector;
        assert_int_equal(pel_batches_create(model, solver.method, &batches, NULL), PEL_OK);
        assert_int_equal(pel_projector_create(batches, &solver, &projector, NULL), PEL_OK);
        int32_t edges = mesh->triangle_count * 3 / 2, expected[3] = {edges, mesh->triangle_count, edges};
        check_layout(projector, expected);
        assert_true(frequency < 32 || projector->batches->bodies[0].pieces.piece_count > 2);
        pel_projector_destroy(projector);
        pel_batches_destroy(batches);
        pel_model_destroy(model);
        pel_mesh_destroy(mesh);
    }
}

/* a vertex of very high valence needs more than 64 colours */
static void test_fan_of_many_triangles(void **unused)
{
    (void)unused;
    enum { SPOKES = 150 };
    static double positions[SPOKES + 1][3];
    static int32_t triangles[SPOKES][3];
    for (int i = 0; i < SPOKES; i++) {
        double angle = 6.283185307179586 * i / SPOKES;
        positions[i + 1][0] = cos(angle);
        positions[i + 1][1] = sin(angle);
        triangles[i][1] = i + 1;
        triangles[i][2] = (i + 1) % SPOKES + 1;
    }
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions[0], SPOKES + 1, triangles[0], SPOKES, &mesh, NULL), PEL_OK);
    pel_body_def def = stiff_body(mesh);
    pel_model *model = make_model(&def);
    const pel_solver_def solver = {.method = PEL_METHOD_PBD, .dt = 0.01, .iterations = 1, .substeps = 1};
    pel_batches *batches;
    pel_projector *projector;
    assert_int_equal(pel_batches_create(model, solver.method, &batches, NULL), PEL_OK);
    assert_int_equal(pel_projector_create(batches, &solver, &projector, NULL), PEL_OK);
    int32_t expected[3] = {2 * SPOKES, SPOKES, SPOKES};
    check_layout(projector, expected);
    pel_projector_destroy(projector);
    pel_batches_destroy(batches);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* ---- sweeps ---- */

static void disturb(const pel_model *model, pel_state *state, double size)
{
    uint32_t seed = 7;
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            seed = seed * 1664525u + 1013904223u;
            state->position_next[v][i] += (pel_real)(size * (seed / 4294967296.0 - 0.5));
        }
}

/* wide and plain sweeps, one thread and several: the same bits */
static void test_wide_is_plain(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(ROUNDS(24, 9));
    double *weights = calloc((size_t)mesh->vertex_count, sizeof *weights);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        weights[v] = fmax(0, mesh->positions[v][2]);
    pel_anisotropy_def regions[2] = {pel_anisotropy_def_default(), pel_anisotropy_def_default()};
    regions[0].mode = PEL_FIBRE_ACTIVE;
    regions[0].rest_length.value = 0.8;
    regions[0].weights = weights;
    regions[1].mode = PEL_FIBRE_STRAIN;
    regions[1].kind = PEL_FIBRE_STVK;
    regions[1].direction = PEL_FIBRE_PRINCIPAL;
    pel_pool *pool;
    assert_int_equal(pel_pool_create(3, &pool, NULL), PEL_OK);
    for (int m = 0; m < 3; m++)
        for (int material = 0; material < PEL_MEMBRANE_COUNT; material++)
            for (int bending = PEL_BENDING_ISOMETRIC; bending <= PEL_BENDING_HINGE; bending++) {
                pel_body_def def = stiff_body(mesh);
                def.spring_stiffness.value = 10;
                shell_set_kind(&def, (pel_membrane_kind)material);
                def.shell.bending.model = (pel_bending_model)bending;
                def.shell.anisotropies = regions;
                def.shell.anisotropy_count = 2;
                pel_model *model = make_model(&def);
                const pel_solver_def solver = {.method = methods[m], .dt = 0.01, .iterations = 2, .substeps = 1};
                pel_record *results[3];
                for (int run = 0; run < 3; run++) {
                    pel_batches *batches;
                    pel_projector *projector;
                    pel_state *state;
                    assert_int_equal(pel_batches_create(model, solver.method, &batches, NULL), PEL_OK);
                    assert_int_equal(pel_projector_create(batches, &solver, &projector, NULL), PEL_OK);
                    assert_int_equal(pel_state_create(model, true, &state, NULL), PEL_OK);
                    state->bending[0].weight = 0.4;
                    projector->is_plain = run == 0;
                    projector->pool = run == 2 ? pool : NULL;
                    disturb(model, state, 0.01);
                    pel_projector_begin(projector, state, 0);
                    const pel_project_time steady = {projector->substep, 1, 1, 5, projector->substep, NULL};
                    pel_project_body_set_time(&projector->model->bodies[0], &projector->batches->bodies[0],
                                              state->factors[0], &steady);
                    for (int i = 0; i < 3; i++)
                        pel_project_sweep(projector, state->position_next);
                    size_t size = (size_t)model->vertex_count * sizeof(pel_record);
                    results[run] = aligned_alloc(64, (size + 63) / 64 * 64);
                    memcpy(results[run], state->position_next, size);
                    if (run > 0)
                        assert_memory_equal(results[0], results[run], size);
                    pel_state_destroy(state);
                    pel_projector_destroy(projector);
                    pel_batches_destroy(batches);
                }
                for (int run = 0; run < 3; run++)
                    free(results[run]);
                pel_model_destroy(model);
            }
    pel_pool_destroy(pool);
    free(weights);
    pel_mesh_destroy(mesh);
}

/* ---- steps ---- */

typedef struct body_motion {
    double mass, linear[3], angular[3];
} body_motion;

static body_motion motion_of(pel_sim *sim)
{
    int32_t count = pel_sim_vertex_count(sim, 0);
    double *x = malloc(3 * (size_t)count * sizeof *x), *v = malloc(3 * (size_t)count * sizeof *v);
    double *mass = malloc((size_t)count * sizeof *mass);
    pel_sim_get_positions(sim, 0, x);
    pel_sim_get_velocities(sim, 0, v);
    pel_sim_get_masses(sim, 0, mass);
    body_motion motion = {0};
    for (int32_t n = 0; n < count; n++) {
        motion.mass += mass[n];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            motion.linear[i] += mass[n] * v[3 * n + i];
            motion.angular[i] += mass[n] * (x[3 * n + j] * v[3 * n + k] - x[3 * n + k] * v[3 * n + j]);
        }
    }
    free(x);
    free(v);
    free(mass);
    return motion;
}

/* A turning, stretched body without load keeps its momentum. Angular momentum is kept by each projection about the
   predicted places (test_project_kernel.c); with the velocities of first order, which are ways over dt, it drifts with
   dt. */
static void test_momentum(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(6);
    double *velocities = calloc(3 * (size_t)mesh->vertex_count, sizeof *velocities);
    double *positions = calloc(3 * (size_t)mesh->vertex_count, sizeof *positions);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *x = mesh->positions[v];
        velocities[3 * v] = 1 - 0.5 * x[1];
        velocities[3 * v + 1] = 0.5 * x[0] + 0.3 * x[2];
        for (int i = 0; i < 3; i++)
            positions[3 * v + i] = x[i] * (i == 0 ? 1.1 : 1);
    }
    for (int m = 0; m < 3; m++) {
        pel_body_def def = stiff_body(mesh);
        pel_model *model = make_model(&def);
        pel_sim_def sim_def = projected(model, methods[m]);
        pel_sim *sim = make_sim(&sim_def);
        assert_int_equal(pel_sim_set_positions(sim, 0, positions, NULL), PEL_OK);
        assert_int_equal(pel_sim_set_velocities(sim, 0, velocities, NULL), PEL_OK);
        body_motion before = motion_of(sim);
        run_steps(sim, 20);
        body_motion after = motion_of(sim);
        double limit = sizeof(pel_real) == 8 ? 1e-12 : 3e-4;
        for (int i = 0; i < 3; i++) {
            assert_near(after.linear[i] / after.mass, before.linear[i] / before.mass, limit);
            assert_near(after.angular[i] / after.mass, before.angular[i] / before.mass, 1e-2);
        }
        pel_sim_destroy(sim);
        pel_model_destroy(model);
    }
    free(positions);
    free(velocities);
    pel_mesh_destroy(mesh);
}

/* volume ratio of a sphere under an outside pressure after some steps; load: pressure / (density thickness) [m/s2] */
static double squeezed_volume(int32_t frequency, pel_method method, double young, double load, double weight,
                              pel_bending_model bending, int steps, int *rises)
{
    pel_mesh *mesh = make_sphere(frequency);
    pel_body_def def = stiff_body(mesh);
    def.shell.membrane.young.value = young;
    def.shell.bending.model = bending;
    def.shell.bending.weight = weight;
    def.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    def.shell.pressure.outside.value = load * 10;
    pel_model *model = make_model(&def);
    pel_sim_def sim_def = projected(model, method);
    pel_sim *sim = make_sim(&sim_def);
    double volume = 1;
    for (int n = 0; n < steps; n++) {
        run_steps(sim, 1);
        double now = pel_sim_volume_ratio(sim);
        if (rises != NULL)
            *rises += now > volume;
        volume = now;
    }
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
    return volume;
}

/* theory page, finding 1: pbd ends in the same shape whatever young is; xpbd does not */
static void test_stiffness(void **unused)
{
    (void)unused;
    double volumes[2][3];
    for (int i = 0; i < 3; i++) {
        double young = i == 0 ? 1e4 : i == 1 ? 1e6 : 1e8;
        volumes[0][i] = squeezed_volume(8, PEL_METHOD_PBD, young, 2.4, 0.01, PEL_BENDING_HINGE, 10, NULL);
        volumes[1][i] = squeezed_volume(8, PEL_METHOD_XPBD, young, 2.4, 0.01, PEL_BENDING_HINGE, 10, NULL);
    }
    double limit = sizeof(pel_real) == 8 ? 1e-9 : 1e-3;
    assert_near(volumes[0][1], volumes[0][0], limit);
    assert_near(volumes[0][2], volumes[0][0], limit);
    assert_true(volumes[1][0] < 0.97 && volumes[1][0] < volumes[1][1] - 0.02);
    assert_true(volumes[1][1] < volumes[1][2] + 0.001 && volumes[1][2] > 0.99);
}

/* paper B, figures 16 to 18, in the setting of the theory page (finding 2): a larger weight holds the volume */
static void test_weight_order(void **unused)
{
    (void)unused;
    const double weights[5] = {1, 0.1, 0.01, 0.001, 0};
    double volumes[5];
    int rises[5] = {0};
    for (int i = 0; i < 5; i++) {
        volumes[i] = squeezed_volume(8, PEL_METHOD_PBD, 1e6, 2.4, weights[i], PEL_BENDING_ISOMETRIC, 100, &rises[i]);
        print_message("k_B %g: V/V0 %.3f, %d rises\n", weights[i], volumes[i], rises[i]);
    }
    assert_true(volumes[0] > 0.95 && volumes[1] > 0.9);
    assert_true(volumes[1] > volumes[2] + 0.05 && volumes[2] > volumes[3] + 0.1);
    /* the two smallest differ by little: less than float can tell */
    assert_true(volumes[3] > volumes[4] - (sizeof(pel_real) == 8 ? 0 : 0.02));
    assert_true(rises[0] > rises[4] + 10);
}

/* ---- bits ---- */

static uint64_t run_hash(const pel_model *model, pel_method method, bool second_order, int threads, bool resume)
{
    pel_sim_def def = projected(model, method);
    def.solver.second_order = second_order;
    def.solver.substeps = method == PEL_METHOD_XPBD ? 4 : 1;
    def.thread_count = threads;
    pel_sim *sim = make_sim(&def);
    run_steps(sim, 6);
    if (resume)
        sim = resume_sim(sim, &def);
    run_steps(sim, 6);
    uint64_t hash = pel_sim_hash(sim);
    pel_sim_destroy(sim);
    return hash;
}

static pel_model *squeezed_model(const pel_mesh *mesh, pel_bending_model bending)
{
    static const int32_t pinned[2] = {0, 40};
    pel_body_def body = stiff_body(mesh);
    body.spring_stiffness.value = 20;
    body.spring_damping.value = 0.01;
    body.volumetric_stiffness.value = 0.5;
    body.volumetric_damping.value = 0.01;
    body.shell.bending.model = bending;
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body.shell.pressure.outside.value = 20;
    body.pinned = pinned;
    body.pinned_count = 2;
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    def.gravity[2] = -1;
    pel_model *model;
    assert_int_equal(pel_model_create(&def, &model, NULL), PEL_OK);
    return model;
}

/* The same bits for any number of threads, for a run that was saved and resumed, and for every machine and compiler
   (constants of the double preset; a change of arithmetic on purpose changes them). */
static void test_hashes(void **unused)
{
    (void)unused;
    static const uint64_t golden[4] = {UINT64_C(0xd42be4387f75aa37), UINT64_C(0x9e8054c5c9d8edee),
                                       UINT64_C(0x670767d3c4ad86c4), UINT64_C(0x9091b030157eb433)};
    pel_mesh *mesh = make_sphere(24);
    pel_model *model = squeezed_model(mesh, PEL_BENDING_ISOMETRIC);
    int wrong = 0;
    for (int c = 0; c < 4; c++) {
        pel_method method = methods[c < 3 ? c : 2];
        uint64_t hash = run_hash(model, method, c == 3, 1, false);
        assert_true(hash == run_hash(model, method, c == 3, 2, true));
        assert_true(hash == run_hash(model, method, c == 3, 3, false));
        if (sizeof(pel_real) == 8 && hash != golden[c]) {
            print_error("case %d: hash 0x%016llx\n", c, (unsigned long long)hash);
            wrong++;
        }
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
    assert_int_equal(wrong, 0);
}

static void test_steps_do_not_allocate(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(5);
    pel_model *model = squeezed_model(mesh, PEL_BENDING_ISOMETRIC_REST);
    for (int m = 0; m < 3; m++) {
        pel_sim_def def = projected(model, methods[m]);
        def.solver.second_order = m == 2;
        pel_sim *sim = make_sim(&def);
        failing_malloc_begin(0);
        for (int n = 0; n < 20; n++)
            assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
        assert_int_equal(failing_malloc_end().calls, 0);
        pel_sim_destroy(sim);
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void test_every_allocation(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(3);
    pel_model *model = squeezed_model(mesh, PEL_BENDING_HINGE);
    pel_sim_def def = projected(model, PEL_METHOD_XPBD);
    def.solver.second_order = true;
    def.solver.iterations = 2;
    assert_true(for_every_allocation_failure(create_sim, &def) > 20);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* a load beyond measure is reported, and the state stays */
static void test_divergence(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(4);
    pel_body_def body = stiff_body(mesh);
    pel_model *model = make_model(&body);
    pel_load_def load = pel_load_def_default();
    load.force[2] = 1e12;
    load.from = 0.1;
    for (int m = 0; m < 3; m++) {
        pel_sim_def def = projected(model, methods[m]);
        def.loads = &load;
        def.load_count = 1;
        pel_sim *sim = make_sim(&def);
        pel_status status = PEL_OK;
        uint64_t hash = 0;
        pel_error error;
        for (int n = 0; n < 60 && status == PEL_OK; n++) {
            hash = pel_sim_hash(sim);
            status = pel_sim_step(sim, &error);
        }
        assert_int_equal(status, PEL_DIVERGED);
        assert_string_equal(error.element_kind, "vertex");
        assert_true(pel_sim_hash(sim) == hash);
        pel_sim_destroy(sim);
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_layout),           cmocka_unit_test(test_fan_of_many_triangles),
        cmocka_unit_test(test_wide_is_plain),    cmocka_unit_test(test_momentum),
        cmocka_unit_test(test_stiffness),        cmocka_unit_test(test_weight_order),
        cmocka_unit_test(test_hashes),           cmocka_unit_test(test_steps_do_not_allocate),
        cmocka_unit_test(test_every_allocation), cmocka_unit_test(test_divergence),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
