/* Shells that refine, under position-based and explicit methods: rest data on the subdivided surface, hinges across
   transition triangles, the same bits whatever the threads and however a run was cut. */
#include "failing_malloc.h"
#include "pellicle/sim_forces.h"
#include "pellicle/sim_ledger.h"
#include "shell_fixture.h"

#include <stdlib.h>

static const bool is_double = sizeof(pel_real) == 8;

static pel_body_def refined_body(const pel_mesh *mesh, int32_t levels)
{
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.refine.levels = levels;
    return body;
}

static pel_sim_def sim_of(const pel_model *model, pel_method method)
{
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver = (pel_solver_def){.method = method, .dt = 1.0 / 120, .symplectic = true, .drag = 2};
    if (method == PEL_METHOD_EXPLICIT)
        def.solver.dt = 1e-4;
    def.thread_count = 1;
    return def;
}

static const pel_method methods[4] = {PEL_METHOD_PBD, PEL_METHOD_PBD_DISTANCE, PEL_METHOD_XPBD, PEL_METHOD_EXPLICIT};

static void refine_at(pel_sim *sim, int32_t vertex, int32_t level)
{
    pel_error error;
    char text[800];
    pel_status status = pel_sim_refine(sim, 0, vertex, level, &error);
    if (status != PEL_OK)
        print_error("%s\n", pel_error_text(&error, text, sizeof text));
    assert_int_equal(status, PEL_OK);
}

/* largest displacement from the rest surface */
static double largest_displacement(const pel_sim *sim)
{
    int32_t count = pel_sim_vertex_count(sim, 0);
    double *x = malloc(3 * (size_t)count * sizeof *x), *rest = malloc(3 * (size_t)count * sizeof *rest), most = 0;
    pel_sim_get_positions(sim, 0, x);
    pel_sim_get_rest_positions(sim, 0, rest);
    for (int32_t i = 0; i < 3 * count; i++)
        most = fmax(most, fabs(x[i] - rest[i]));
    free(x);
    free(rest);
    return most;
}

/* theory page, section 11 f: refining an unloaded body moves nothing, and its energy stays 0 */
static void test_unloaded_body_stays(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(5);
    pel_body_def body = refined_body(mesh, 2);
    body.spring_stiffness.value = 5;
    pel_model *model = make_model(&body);
    for (int m = 0; m < 4; m++) {
        pel_sim_def def = sim_of(model, methods[m]);
        pel_sim *sim = make_sim(&def);
        refine_at(sim, nearest_vertex(mesh, 0, 0, 1), 2);
        refine_at(sim, nearest_vertex(mesh, 1, 0, 0), 1);
        run_steps(sim, 20);
        assert_true(pel_sim_triangle_count(sim, 0) > mesh->triangle_count + 50);
        assert_true(largest_displacement(sim) < (is_double ? 1e-10 : 2e-4));
        pel_sim_measures measures;
        pel_sim_measure(sim, &measures);
        assert_near(measures.membrane_energy, 0, is_double ? 1e-16 : 1e-5);
        assert_near(measures.bending_energy, 0, is_double ? 1e-16 : 1e-5);
        pel_sim_destroy(sim);
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* a body that may refine and has not gives the bits of one that may not */
static void test_unrefined_is_plain(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(6);
    double *weights = calloc((size_t)mesh->vertex_count, sizeof *weights);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        weights[v] = fmax(0, mesh->positions[v][2]);
    pel_anisotropy_def regions[2] = {pel_anisotropy_def_default(), pel_anisotropy_def_default()};
    regions[0].mode = PEL_FIBRE_ACTIVE;
    regions[0].stiffness = 100;
    regions[0].rest_length.value = 0.9;
    regions[0].weights = weights;
    regions[1].mode = PEL_FIBRE_CURL;
    regions[1].weights = weights;
    for (int m = 0; m < 4; m++) {
        uint64_t hashes[2];
        for (int refines = 0; refines < 2; refines++) {
            pel_body_def body = refined_body(mesh, refines);
            body.spring_stiffness.value = 1;
            body.shell.anisotropies = regions;
            body.shell.anisotropy_count = 2;
            body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
            body.shell.pressure.outside.value = 20;
            body.shell.pressure.weights = weights;
            pel_model *model = make_model(&body);
            pel_sim_def def = sim_of(model, methods[m]);
            pel_sim *sim = make_sim(&def);
            run_steps(sim, 10);
            hashes[refines] = pel_sim_hash(sim);
            pel_sim_destroy(sim);
            pel_model_destroy(model);
        }
        assert_true(hashes[0] == hashes[1]);
    }
    free(weights);
    pel_mesh_destroy(mesh);
}

/* an event in free fall, in second order: what came and what was there fall on alike */
static void test_event_in_free_fall(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(4);
    pel_body_def body = refined_body(mesh, 2);
    pel_model_def model_def = pel_model_def_default();
    model_def.bodies = &body;
    model_def.body_count = 1;
    model_def.gravity[2] = -10;
    pel_model *model;
    assert_int_equal(pel_model_create(&model_def, &model, NULL), PEL_OK);
    pel_sim_def def = sim_of(model, PEL_METHOD_XPBD);
    def.solver.second_order = true;
    def.solver.drag = 0;
    pel_sim *sim = make_sim(&def);
    run_steps(sim, 5);
    refine_at(sim, nearest_vertex(mesh, 0, 0, 1), 2);
    run_steps(sim, 5);
    int32_t count = pel_sim_vertex_count(sim, 0);
    assert_true(count > mesh->vertex_count);
    double *x = malloc(3 * (size_t)count * sizeof *x), *rest = malloc(3 * (size_t)count * sizeof *rest);
    pel_sim_get_positions(sim, 0, x);
    pel_sim_get_rest_positions(sim, 0, rest);
    double time = 10.0 / 120, way = x[2] - rest[2], tolerance = is_double ? 1e-9 : 2e-3;
    /* the first substep and the one after the event are of first order */
    assert_near(way, -5 * time * time, 0.02 * 5 * time * time);
    for (int32_t v = 0; v < count; v++) {
        assert_near(x[3 * v] - rest[3 * v], 0, tolerance);
        assert_near(x[3 * v + 1] - rest[3 * v + 1], 0, tolerance);
        assert_near(x[3 * v + 2] - rest[3 * v + 2], way, tolerance);
    }
    free(x);
    free(rest);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* mean displacement of a sphere under a small pressure within, at rest */
static double mean_growth(int32_t frequency, int32_t levels, bool everywhere)
{
    pel_mesh *mesh = make_sphere(frequency);
    pel_body_def body = refined_body(mesh, levels);
    body.refine.everywhere = everywhere;
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body.shell.pressure.outside.value = -1;
    pel_model *model = make_model(&body);
    pel_sim_def def = sim_of(model, PEL_METHOD_XPBD);
    def.solver.drag = 20;
    pel_sim *sim = make_sim(&def);
    if (levels > 0 && !everywhere)
        refine_at(sim, nearest_vertex(mesh, 0, 0, 1), levels);
    run_steps(sim, 100);
    int32_t count = pel_sim_vertex_count(sim, 0);
    double *x = malloc(3 * (size_t)count * sizeof *x), *rest = malloc(3 * (size_t)count * sizeof *rest), sum = 0;
    pel_sim_get_positions(sim, 0, x);
    pel_sim_get_rest_positions(sim, 0, rest);
    for (int32_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            sum += (x[3 * i + c] - rest[3 * i + c]) * rest[3 * i + c] / count;
    free(x);
    free(rest);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
    return sum;
}

/* refined everywhere it is the finer mesh; refined in a part it lies between */
static void test_refined_is_finer_mesh(void **unused)
{
    (void)unused;
    if (!is_double)
        skip(); /* a substep moves a vertex by less than float can tell */
    double coarse = mean_growth(5, 0, false), fine = mean_growth(10, 0, false);
    double everywhere = mean_growth(5, 1, true), local = mean_growth(5, 1, false);
    print_message("growth: coarse %.4g, fine mesh %.4g, refined everywhere %.4g, in a part %.4g\n", coarse, fine,
                  everywhere, local);
    assert_true(fabs(coarse / fine - 1) > 0.005);
    assert_near(everywhere / fine, 1, 2e-3);
    assert_true(local > 0.98 * coarse && local < 1.02 * fine);
}

/* refine, coarsen and refine elsewhere while it moves */
static void stir(pel_sim *sim, const pel_mesh *mesh, int phase)
{
    static const double places[4][3] = {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}, {0.5, 0.5, 0.5}};
    for (int i = 0; i < 4; i++) {
        int32_t v = nearest_vertex(mesh, places[i][0], places[i][1], places[i][2]);
        refine_at(sim, v, (phase + i) % 3);
    }
}

static uint64_t stirred_hash(const pel_model *model, const pel_mesh *mesh, pel_method method, int threads, bool resume)
{
    pel_sim_def def = sim_of(model, method);
    def.solver.second_order = method == PEL_METHOD_XPBD;
    def.thread_count = threads;
    pel_sim *sim = make_sim(&def);
    for (int phase = 0; phase < 4; phase++) {
        stir(sim, mesh, phase);
        run_steps(sim, 3);
        if (resume)
            sim = resume_sim(sim, &def);
    }
    uint64_t hash = pel_sim_hash(sim);
    pel_sim_destroy(sim);
    return hash;
}

static void test_bits(void **unused)
{
    (void)unused;
    skip_if_slow();
    pel_mesh *mesh = make_sphere(16);
    pel_body_def body = refined_body(mesh, 2);
    body.spring_stiffness.value = 1;
    body.shell.pressure.kind = PEL_PRESSURE_GAS;
    body.shell.pressure.value = 200;
    body.refine.budget = 20000;
    pel_model *model = make_model(&body);
    int wrong = 0;
    for (int m = 0; m < 4; m++) {
        uint64_t hash = stirred_hash(model, mesh, methods[m], 1, false);
        assert_true(hash == stirred_hash(model, mesh, methods[m], 3, false));
        uint64_t resumed = stirred_hash(model, mesh, methods[m], 2, true);
        if (hash != resumed)
            print_error("method %d differs after resuming\n", m);
        wrong += hash != resumed;
    }
    assert_int_equal(wrong, 0);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* events and steps allocate nothing; a body without load keeps its momentum over events */
static void test_events_do_not_allocate(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(6);
    pel_body_def body = refined_body(mesh, 2);
    body.spring_stiffness.value = 1;
    pel_anisotropy_def region = pel_anisotropy_def_default();
    region.mode = PEL_FIBRE_ACTIVE;
    region.stiffness = 100;
    region.direction = PEL_FIBRE_PRINCIPAL;
    body.shell.anisotropies = &region;
    body.shell.anisotropy_count = 1;
    pel_model *model = make_model(&body);
    double *velocities = malloc(3 * (size_t)mesh->vertex_count * sizeof *velocities);
    for (int32_t i = 0; i < 3 * mesh->vertex_count; i++)
        velocities[i] = i % 3 == 0 ? 1 : 0;
    for (int m = 0; m < 4; m++) {
        pel_sim_def def = sim_of(model, methods[m]);
        def.solver.drag = 0;
        pel_sim *sim = make_sim(&def);
        assert_int_equal(pel_sim_set_velocities(sim, 0, velocities, NULL), PEL_OK);
        failing_malloc_begin(0);
        for (int phase = 0; phase < 6; phase++) {
            stir(sim, mesh, phase);
            run_steps(sim, 3);
        }
        assert_int_equal(failing_malloc_end().calls, 0);
        int32_t count = pel_sim_vertex_count(sim, 0);
        double *v = malloc(3 * (size_t)count * sizeof *v), *mass = malloc((size_t)count * sizeof *mass);
        double momentum = 0, sum = 0;
        pel_sim_get_velocities(sim, 0, v);
        pel_sim_get_masses(sim, 0, mass);
        for (int32_t i = 0; i < count; i++) {
            momentum += mass[i] * v[3 * i];
            sum += mass[i];
        }
        assert_near(momentum / sum, 1, is_double ? 1e-10 : 1e-3);
        free(v);
        free(mass);
        pel_sim_destroy(sim);
    }
    free(velocities);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* the criterion feels the shell: a push refines around itself, and the rest stays coarse */
static void test_criterion_feels_the_shell(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(6);
    pel_body_def body = refined_body(mesh, 2);
    body.refine.above = 2;
    body.refine.below = 0.5;
    pel_model *model = make_model(&body);
    int32_t pole[1] = {nearest_vertex(mesh, 0, 0, 1)};
    pel_load_def load = pel_load_def_default();
    load.force[2] = -0.2;
    load.vertices = pole;
    load.vertex_count = 1;
    for (int m = 2; m < 4; m++) {
        pel_sim_def def = sim_of(model, methods[m]);
        def.loads = &load;
        def.load_count = 1;
        pel_sim *sim = make_sim(&def);
        run_steps(sim, methods[m] == PEL_METHOD_EXPLICIT ? 2000 : 40);
        int32_t count = pel_sim_vertex_count(sim, 0), fine_near = 0, fine_far = 0;
        int32_t *levels = malloc((size_t)count * sizeof *levels);
        double *rest = malloc(3 * (size_t)count * sizeof *rest);
        pel_sim_get_levels(sim, 0, levels);
        pel_sim_get_rest_positions(sim, 0, rest);
        for (int32_t i = 0; i < count; i++)
            *(rest[3 * i + 2] > 0 ? &fine_near : &fine_far) += levels[i] > 0;
        print_message("finer vertices: %d near the push, %d far away\n", (int)fine_near, (int)fine_far);
        assert_true(fine_near > 20);
        assert_true(fine_far < fine_near / 4);
        free(levels);
        free(rest);
        pel_sim_destroy(sim);
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* energies on vertices add up, and a shell behind a body that refines is found at its shifted places */
static void test_rows_and_shifted_places(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(4);
    double sums[2];
    for (int with = 0; with < 2; with++) {
        pel_body_def bodies[2] = {refined_body(mesh, 1), refined_body(mesh, 0)};
        bodies[0].name = "first";
        bodies[1].shell.pressure.kind = PEL_PRESSURE_GIVEN;
        bodies[1].shell.pressure.outside.value = 10;
        pel_model_def model_def = pel_model_def_default();
        model_def.bodies = with ? bodies : bodies + 1;
        model_def.body_count = with ? 2 : 1;
        pel_model *model;
        assert_int_equal(pel_model_create(&model_def, &model, NULL), PEL_OK);
        pel_sim_def def = sim_of(model, PEL_METHOD_XPBD);
        pel_sim *sim = make_sim(&def);
        if (with)
            refine_at(sim, 3, 1);
        run_steps(sim, 5);
        int32_t body = with ? 1 : 0, count = pel_sim_vertex_count(sim, body);
        double *parts = calloc(3 * (size_t)count, sizeof *parts);
        pel_sim_get_shell_energies(sim, body, parts, parts + count, parts + 2 * count);
        sums[with] = 0;
        for (int32_t i = 0; i < 3 * count; i++)
            sums[with] += parts[i];
        pel_sim_measures measures;
        pel_sim_measure(sim, &measures);
        assert_near(sums[with] / measures.elastic_energy, 1, is_double ? 1e-12 : 1e-3);
        free(parts);
        pel_sim_destroy(sim);
        pel_model_destroy(model);
    }
    assert_true(sums[0] > 0);
    assert_near(sums[1] / sums[0], 1, is_double ? 1e-12 : 1e-3);
    pel_mesh_destroy(mesh);
}

/* a mesh without an inner edge bends at the edges of its finer levels */
static void test_single_triangle(void **unused)
{
    (void)unused;
    const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const int32_t triangle[] = {0, 1, 2};
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(corners, 3, triangle, 1, &mesh, NULL), PEL_OK);
    pel_body_def body = refined_body(mesh, 2);
    body.refine.everywhere = true;
    pel_model *model = make_model(&body);
    pel_sim_def def = sim_of(model, PEL_METHOD_XPBD);
    pel_sim *sim = make_sim(&def);
    double x[3 * 15];
    pel_sim_measures measures;
    assert_int_equal(pel_sim_vertex_count(sim, 0), 15);
    pel_sim_get_positions(sim, 0, x);
    for (int i = 0; i < 15; i++)
        x[3 * i + 2] = 0.1 * x[3 * i] * x[3 * i];
    assert_int_equal(pel_sim_set_positions(sim, 0, x, NULL), PEL_OK);
    pel_sim_measure(sim, &measures);
    assert_true(measures.bending_energy > 0);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void test_every_allocation(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(2);
    pel_body_def body = refined_body(mesh, 1);
    pel_anisotropy_def region = pel_anisotropy_def_default();
    region.mode = PEL_FIBRE_STRAIN;
    body.shell.anisotropies = &region;
    body.shell.anisotropy_count = 1;
    pel_model *model = make_model(&body);
    pel_sim_def def = sim_of(model, PEL_METHOD_XPBD);
    assert_true(for_every_allocation_failure(create_sim, &def) > 60);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_unloaded_body_stays),
        cmocka_unit_test(test_unrefined_is_plain),
        cmocka_unit_test(test_event_in_free_fall),
        cmocka_unit_test(test_refined_is_finer_mesh),
        cmocka_unit_test(test_bits),
        cmocka_unit_test(test_events_do_not_allocate),
        cmocka_unit_test(test_criterion_feels_the_shell),
        cmocka_unit_test(test_rows_and_shifted_places),
        cmocka_unit_test(test_single_triangle),
        cmocka_unit_test(test_every_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
