/* Paper A's body against the numbers of the reference computation (figures 6 and 7) and against closed forms. */
#include "pellicle/measure.h"
#include "pellicle/shape.h"
#include "pellicle/sim_forces.h"
#include "pellicle/sim_ledger.h"
#include "pellicle/sim_surface.h"
#include "sim/fixture.h"
#include "stage/stage.h"

/* tolerance of the figures' numbers: the reference gives them to three digits */
#define FIGURE 0.0015

typedef struct press_case {
    double volumetric; /* k' and d' as in the paper, or 0 */
    pel_solver_def solver;
    double depth, residual;
} press_case;

/* unit force on the pole for 5 s, then 5 s free */
static pel_sim *press_sphere(pel_mesh *mesh, pel_model **model, const press_case *press, int thread_count)
{
    pel_body_def body = ball_body(mesh);
    body.volumetric_stiffness.value *= press->volumetric;
    body.volumetric_damping.value *= press->volumetric;
    *model = make_model(&body);
    const int32_t pole = nearest_vertex(mesh, 0, 0, 1);
    pel_load_def load = pel_load_def_default();
    load.force[2] = -1;
    load.vertices = &pole;
    load.vertex_count = 1;
    load.until = 5;
    pel_sim_def def = pel_sim_def_default();
    def.model = *model;
    def.solver = press->solver;
    def.loads = &load;
    def.load_count = 1;
    def.thread_count = thread_count;
    return make_sim(&def);
}

static const pel_solver_def quasi_static_50 = {.method = PEL_METHOD_QUASI_STATIC, .dt = 0.01, .alpha = 50};
static const pel_solver_def forward_euler = {.method = PEL_METHOD_EXPLICIT, .dt = 0.01};

static void check_press(const press_case *press)
{
    pel_mesh *mesh = make_sphere(5);
    assert_int_equal(mesh->vertex_count, 252);
    const int32_t pole = nearest_vertex(mesh, 0, 0, 1);
    pel_model *model;
    pel_sim *sim = press_sphere(mesh, &model, press, 1);
    run_steps(sim, 500);
    assert_near(mesh->positions[pole][2] - height_of(sim, pole), press->depth, FIGURE);
    run_steps(sim, 500);
    assert_near(mesh->positions[pole][2] - height_of(sim, pole), press->residual, FIGURE);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void test_figures_6_and_7(void **unused)
{
    (void)unused;
    check_press(&(press_case){1, quasi_static_50, .283, .005});
    check_press(&(press_case){0, quasi_static_50, .518, .336});
    check_press(&(press_case){0, forward_euler, .750, .505});
}

static int sign_changes(const press_case *press)
{
    pel_mesh *mesh = make_sphere(5);
    pel_model *model;
    pel_sim *sim = press_sphere(mesh, &model, press, 1);
    int changes = 0;
    double before = 0, last = 1;
    for (int n = 0; n < 1000; n++) {
        run_steps(sim, 1);
        double height = height_of(sim, nearest_vertex(mesh, 0, 0, 1)), speed = height - last;
        /* rises and falls of less than a millionth of the radius do not count */
        if (fabs(speed) > 1e-6) {
            changes += before * speed < 0;
            before = speed;
        }
        last = height;
    }
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
    return changes;
}

static void test_quasi_static_does_not_oscillate(void **unused)
{
    (void)unused;
    /* one change only: at the release */
    assert_int_equal(sign_changes(&(press_case){1, quasi_static_50, 0, 0}), 1);
    assert_true(sign_changes(&(press_case){1, forward_euler, 0, 0}) >= 4);
}

static void check_uniform_load(pel_shape_kind kind, double stiffness)
{
    pel_shape_def shape = pel_shape_def_default(kind);
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&shape, &mesh, NULL), PEL_OK);
    pel_body_def body = pel_body_def_default();
    body.name = "body";
    body.mesh = mesh;
    body.spring_stiffness.value = stiffness;
    pel_model *model = make_model(&body);
    pel_load_def load = pel_load_def_default();
    load.kind = PEL_LOAD_PER_VERTEX;
    load.force[0] = 0.02;
    load.force[2] = -0.03;
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.loads = &load;
    def.load_count = 1;
    pel_sim *sim = make_sim(&def);
    run_steps(sim, 3000);
    double *positions = calloc((size_t)mesh->vertex_count, 3 * sizeof *positions);
    pel_sim_get_positions(sim, 0, positions);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            assert_near(positions[3 * v + c] - mesh->positions[v][c], load.force[c] / body.volumetric_stiffness.value,
                        sizeof(pel_real) == 8 ? 1e-9 : 1e-5);
    free(positions);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void test_uniform_load_moves_by_force_over_stiffness(void **unused)
{
    (void)unused;
    check_uniform_load(PEL_SHAPE_GEODESIC_SPHERE, 3);
    check_uniform_load(PEL_SHAPE_TORUS, 0.3);
    check_uniform_load(PEL_SHAPE_GRID, 11);
}

/* theory: recovery of a displaced body by k' alone is (1 - alpha dt^2 k'/m)^n exactly */
static void test_recovery_factor(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(3);
    pel_body_def body = ball_body(mesh);
    pel_model *model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver = quasi_static_50;
    pel_sim *sim = make_sim(&def);
    double positions[3 * 92];
    assert_int_equal(mesh->vertex_count, 92);
    for (int32_t v = 0; v < 92; v++)
        for (int c = 0; c < 3; c++)
            positions[3 * v + c] = mesh->positions[v][c] + (c == 1 ? 0.25 : 0);
    assert_int_equal(pel_sim_set_positions(sim, 0, positions, NULL), PEL_OK);
    run_steps(sim, 200);
    pel_sim_get_positions(sim, 0, positions);
    double expected = 0.25 * pow(1 - 50 * 1e-4 * 1.5, 200);
    for (int32_t v = 0; v < 92; v++)
        assert_near(positions[3 * v + 1] - mesh->positions[v][1], expected, sizeof(pel_real) == 8 ? 1e-12 : 1e-5);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void test_rest_is_exact(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(7);
    pel_body_def body = ball_body(mesh);
    pel_model *model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    pel_sim *sim = make_sim(&def);
    run_steps(sim, 20);
    pel_sim_measures measures;
    pel_sim_measure(sim, &measures);
    assert_true(measures.max_displacement == 0);
    assert_true(measures.max_force == 0);
    assert_true(measures.elastic_energy == 0);
    assert_near(measures.volume_ratio, 1, 1e-6);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* force = - gradient of the energy, by central differences on every coordinate of some vertices */
static void test_force_is_energy_gradient(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) != 8)
        skip();
    pel_mesh *mesh = make_sphere(2);
    double stiffness[42], positions[3 * 42], forces[3 * 42];
    for (int v = 0; v < 42; v++)
        stiffness[v] = 1 + 0.1 * v;
    pel_body_def body = ball_body(mesh);
    body.spring_stiffness.field = stiffness;
    pel_model *model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    pel_sim *sim = make_sim(&def);
    for (int v = 0; v < 42; v++)
        for (int c = 0; c < 3; c++)
            positions[3 * v + c] = mesh->positions[v][c] * 1.1 + 0.05 * sin(7.0 * v + 3.0 * c);
    assert_int_equal(pel_sim_set_positions(sim, 0, positions, NULL), PEL_OK);
    pel_sim_get_forces(sim, 0, forces);
    const double h = 1e-5;
    for (int i = 0; i < 3 * 42; i++) {
        double energy[2];
        for (int side = 0; side < 2; side++) {
            double moved[3 * 42];
            memcpy(moved, positions, sizeof moved);
            moved[i] += side ? h : -h;
            assert_int_equal(pel_sim_set_positions(sim, 0, moved, NULL), PEL_OK);
            pel_sim_measures measures;
            pel_sim_measure(sim, &measures);
            energy[side] = measures.elastic_energy;
        }
        assert_near(forces[i], -(energy[1] - energy[0]) / (2 * h), 1e-7);
    }
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* a vertex exactly at its rest place with velocity, and two vertices at one place: no NaN */
static void test_zero_lengths(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(1);
    pel_body_def body = ball_body(mesh);
    pel_model *model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver = forward_euler;
    pel_sim *sim = make_sim(&def);
    double positions[36], velocities[36];
    for (int v = 0; v < 12; v++)
        for (int c = 0; c < 3; c++) {
            positions[3 * v + c] = mesh->positions[v == 1 ? 0 : v][c];
            velocities[3 * v + c] = 0.1 * c;
        }
    assert_int_equal(pel_sim_set_positions(sim, 0, positions, NULL), PEL_OK);
    assert_int_equal(pel_sim_set_velocities(sim, 0, velocities, NULL), PEL_OK);
    run_steps(sim, 3);
    pel_sim_get_positions(sim, 0, positions);
    for (int i = 0; i < 36; i++)
        assert_true(isfinite(positions[i]));
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void test_pins_gravity_and_keys(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(2);
    const int32_t pinned[2] = {0, 5};
    const pel_key keys[2] = {{0, 1.5}, {1, 3}};
    pel_body_def body = ball_body(mesh);
    body.pinned = pinned;
    body.pinned_count = 2;
    body.volumetric_stiffness = (pel_quantity){.keys = keys, .key_count = 2};
    body.spring_stiffness.value = 0;
    pel_model_def model_def = pel_model_def_default();
    model_def.bodies = &body;
    model_def.body_count = 1;
    model_def.gravity[2] = -0.3;
    pel_model *model;
    assert_int_equal(pel_model_create(&model_def, &model, NULL), PEL_OK);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    pel_sim *sim = make_sim(&def);
    run_steps(sim, 2000);
    double positions[3 * 42];
    pel_sim_get_positions(sim, 0, positions);
    double single = sizeof(pel_real) == 8 ? 1e-12 : 1e-5;
    for (int v = 0; v < 42; v++)
        /* m g / k' with the last key's stiffness */
        assert_near(positions[3 * v + 2] - mesh->positions[v][2], v == 0 || v == 5 ? 0 : -0.1, single);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* m g on each vertex at rest, along each axis; and one step of free fall, under both methods */
static void test_gravity(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(1);
    for (int axis = 0; axis < 3; axis++)
        for (int method = 0; method < 2; method++) {
            pel_body_def body = pel_body_def_default();
            body.name = "ball";
            body.mesh = mesh;
            body.mass = 0.5;
            body.volumetric_stiffness.value = body.volumetric_damping.value = 0;
            pel_model_def model_def = pel_model_def_default();
            model_def.bodies = &body;
            model_def.body_count = 1;
            model_def.gravity[axis] = -0.3;
            pel_model *model;
            assert_int_equal(pel_model_create(&model_def, &model, NULL), PEL_OK);
            pel_sim_def def = pel_sim_def_default();
            def.model = model;
            def.solver.method = method == 0 ? PEL_METHOD_QUASI_STATIC : PEL_METHOD_EXPLICIT;
            def.solver.dt = 0.01;
            def.solver.alpha = 7;
            pel_sim *sim = make_sim(&def);
            double forces[36], positions[36], step = method == 0 ? 7 * 1e-4 : 1e-4;
            pel_sim_get_forces(sim, 0, forces);
            run_steps(sim, 1);
            pel_sim_get_positions(sim, 0, positions);
            for (int i = 0; i < 36; i++) {
                double single = sizeof(pel_real) == 8 ? 1e-15 : 3e-7;
                assert_near(forces[i], i % 3 == axis ? -0.15 : 0, single);
                assert_near(positions[i] - mesh->positions[i / 3][i % 3], i % 3 == axis ? -0.3 * step : 0, single);
            }
            pel_sim_destroy(sim);
            pel_model_destroy(model);
        }
    pel_mesh_destroy(mesh);
}

/* the centre goes on with the velocity, a corner turns about it; a pinned vertex stays */
static void check_start(pel_method method, bool refines)
{
    pel_mesh *mesh = make_sphere(3);
    int32_t pin = 7;
    pel_body_def body = pel_body_def_default();
    body.name = "ball";
    body.mesh = mesh;
    body.mass = 0.5;
    body.spring_damping.value = body.volumetric_damping.value = body.volumetric_stiffness.value = 0;
    body.shell.membrane.on = method != PEL_METHOD_EXPLICIT;
    body.shell.membrane.young.value = 1e3;
    body.shell.membrane.thickness.value = 0.01;
    if (body.shell.membrane.on)
        body.spring_stiffness.value = 0;
    body.refine.levels = refines ? 1 : 0;
    body.refine.everywhere = refines;
    const double velocity[3] = {1, -2, 0.5}, spin[3] = {0, 0, 0.1};
    memcpy(body.velocity, velocity, sizeof velocity);
    memcpy(body.angular_velocity, spin, sizeof spin);
    pel_model *model = make_model(&body);
    pel_sim_def def = lone_sim(model, method, 0.001);
    pel_sim *sim = make_sim(&def);
    run_steps(sim, 100);
    int32_t count = pel_sim_vertex_count(sim, 0);
    double *x = malloc(3 * (size_t)count * sizeof *x), most = 0;
    pel_sim_get_positions(sim, 0, x);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            const double *rest = mesh->positions[v];
            double turned[3] = {rest[0] * cos(0.01) - rest[1] * sin(0.01), rest[0] * sin(0.01) + rest[1] * cos(0.01),
                                rest[2]};
            most = fmax(most, fabs(x[3 * v + k] - turned[k] - 0.1 * velocity[k]));
        }
    assert_near(most, 0, IN_FLOAT(2e-4, 3e-4));
    free(x);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    body.pinned = &pin;
    body.pinned_count = 1;
    model = make_model(&body);
    def.model = model;
    sim = make_sim(&def);
    double v[3 * 1000];
    pel_sim_get_velocities(sim, 0, v);
    for (int k = 0; k < 3; k++)
        assert_true(v[3 * pin + k] == 0 && v[3 * 8 + k] != 0);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void test_velocity_at_the_start(void **unused)
{
    (void)unused;
    const pel_method methods[] = {PEL_METHOD_EXPLICIT, PEL_METHOD_XPBD, PEL_METHOD_IMPLICIT};
    for (int i = 0; i < 3; i++)
        for (int refines = 0; refines < 2; refines++)
            check_start(methods[i], refines == 1);
    /* nothing to keep it in */
    pel_mesh *mesh = make_sphere(1);
    pel_body_def body = ball_body(mesh);
    body.angular_velocity[1] = 3;
    pel_model *model = make_model(&body);
    const pel_method still[] = {PEL_METHOD_QUASI_STATIC, PEL_METHOD_STATIC, PEL_METHOD_DESCENT};
    for (int i = 0; i < 3; i++) {
        pel_sim_def def = lone_sim(model, still[i], 0.01);
        pel_sim *sim;
        pel_error error;
        assert_int_equal(pel_sim_create(&def, &sim, &error), PEL_BAD_ARGUMENT);
        assert_non_null(strstr(error.what, "velocity at the start"));
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void test_same_bits_for_any_threads_and_after_resume(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(20);
    uint64_t hash[3];
    for (int n = 0; n < 3; n++) {
        press_case press = {1, quasi_static_50, 0, 0};
        press.solver.keep_velocity = true;
        press.solver.alpha = 20;
        pel_model *model;
        pel_sim *sim = press_sphere(mesh, &model, &press, 1 << n);
        run_steps(sim, 300);
        hash[n] = pel_sim_hash(sim);
        if (n == 0) {
            /* a second sim continued from a snapshot at step 300 stays equal */
            void *bytes = malloc(pel_sim_save_size(sim));
            pel_sim_save(sim, bytes);
            pel_model *other_model;
            pel_sim *other = press_sphere(mesh, &other_model, &press, 1);
            assert_int_equal(pel_sim_load(other, bytes, pel_sim_save_size(sim), NULL), PEL_OK);
            assert_true(pel_sim_hash(other) == hash[0]);
            run_steps(other, 100);
            run_steps(sim, 100);
            assert_true(pel_sim_hash(other) == pel_sim_hash(sim));
            assert_int_equal(pel_sim_load(other, bytes, 10, NULL), PEL_BAD_FORMAT);
            ((char *)bytes)[0] = 'X';
            assert_int_equal(pel_sim_load(other, bytes, pel_sim_save_size(sim), NULL), PEL_BAD_FORMAT);
            free(bytes);
            pel_sim_destroy(other);
            pel_model_destroy(other_model);
        }
        pel_sim_destroy(sim);
        pel_model_destroy(model);
    }
    assert_true(hash[0] == hash[1]);
    assert_true(hash[0] == hash[2]);
    pel_mesh_destroy(mesh);
}

static void test_divergence_is_reported_and_undone(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(5);
    pel_model *model;
    pel_sim *sim = press_sphere(mesh, &model, &(press_case){1, quasi_static_50, 0, 0}, 1);
    const double huge[3] = {0, 0, -1e30};
    run_steps(sim, 3);
    uint64_t before = pel_sim_hash(sim);
    assert_int_equal(pel_sim_set_load_force(sim, 0, huge, NULL), PEL_OK);
    pel_error error;
    assert_int_equal(pel_sim_step(sim, &error), PEL_DIVERGED);
    assert_int_equal(error.element, nearest_vertex(mesh, 0, 0, 1));
    assert_non_null(strstr(error.what, "step 4"));
    assert_true(pel_sim_hash(sim) == before);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* area and volume are those of all bodies together, each over its own triangles */
static void test_measures_of_two_bodies(void **unused)
{
    (void)unused;
    const double scale = 1.5;
    pel_mesh *meshes[2] = {make_sphere(2), make_sphere(3)};
    pel_body_def bodies[2] = {pel_body_def_default(), pel_body_def_default()};
    pel_model_def model_def = pel_model_def_default();
    double area[2], volume[2];
    for (int b = 0; b < 2; b++) {
        bodies[b].name = b == 0 ? "first" : "second";
        bodies[b].mesh = meshes[b];
        const pel_mesh *mesh = meshes[b];
        area[b] = pel_surface_area(mesh->positions[0], mesh->triangles[0], mesh->triangle_count);
        volume[b] = pel_surface_volume(mesh->positions[0], mesh->triangles[0], mesh->triangle_count, NULL);
    }
    model_def.bodies = bodies;
    model_def.body_count = 2;
    pel_model *model;
    assert_int_equal(pel_model_create(&model_def, &model, NULL), PEL_OK);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    pel_sim *sim = make_sim(&def);
    double x[3 * 92];
    const double *rest = meshes[1]->positions[0];
    for (int i = 0; i < 3 * meshes[1]->vertex_count; i++)
        x[i] = scale * rest[i];
    assert_int_equal(pel_sim_set_positions(sim, 1, x, NULL), PEL_OK);
    pel_sim_measures measures;
    pel_sim_measure(sim, &measures);
    const double rounding = sizeof(pel_real) == 8 ? 1e-12 : 1e-5;
    assert_near(measures.area_ratio, (area[0] + pow(scale, 2) * area[1]) / (area[0] + area[1]), rounding);
    assert_near(measures.volume_ratio, (volume[0] + pow(scale, 3) * volume[1]) / (volume[0] + volume[1]), rounding);
    assert_near(pel_sim_volume_ratio(sim), measures.volume_ratio, rounding);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(meshes[0]);
    pel_mesh_destroy(meshes[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_figures_6_and_7),
        cmocka_unit_test(test_measures_of_two_bodies),
        cmocka_unit_test(test_quasi_static_does_not_oscillate),
        cmocka_unit_test(test_uniform_load_moves_by_force_over_stiffness),
        cmocka_unit_test(test_recovery_factor),
        cmocka_unit_test(test_rest_is_exact),
        cmocka_unit_test(test_force_is_energy_gradient),
        cmocka_unit_test(test_zero_lengths),
        cmocka_unit_test(test_pins_gravity_and_keys),
        cmocka_unit_test(test_gravity),
        cmocka_unit_test(test_velocity_at_the_start),
        cmocka_unit_test(test_same_bits_for_any_threads_and_after_resume),
        cmocka_unit_test(test_divergence_is_reported_and_undone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
