/* Tools under a minimisation: equilibrium under the tool, whose force is that of its contacts. */
#include "constraint/constraint.h"
#include "constraint/frame.h"
#include "failing_malloc.h"
#include "pellicle/geometry.h"
#include "pellicle/shape.h"
#include "pellicle/sim_ledger.h"
#include "random.h"
#include "sim/descent_fixture.h"
#include "tool/tool.h"

/* of the tool's radius: the largest gap where something touches */
#define GAP_SHARE 1.2e-4

/* least distance of a triangle at a vertex from a point */
static double fan_distance(const pel_mesh *mesh, const rest_state *rest, int32_t v, const double point[3])
{
    double least = HUGE_VAL, weights[3];
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *c = mesh->triangles[t];
        if (c[0] == v || c[1] == v || c[2] == v)
            least =
                fmin(least, pel_closest_point_triangle(point, rest->x[c[0]], rest->x[c[1]], rest->x[c[2]], weights));
    }
    return sqrt(least);
}

/* under a sphere: forces point away from it, only at contacts, and nothing penetrates it */
static void assert_pressed_by_sphere(const press_scene *scene, pel_sim *sim)
{
    rest_state rest = find_rest(sim);
    pel_tool_reading reading = reading_of(sim, 0);
    double radius = scene->tool.radius, scale = pel_vec3_length(reading.force);
    for (int32_t v = 0; v < scene->mesh->vertex_count; v++) {
        double out[3], length = pel_vec3_length(rest.force[v]);
        double gap = fan_distance(scene->mesh, &rest, v, reading.position) - radius;
        assert_true(gap > -1e-9 * radius - (sizeof(pel_real) == 4 ? 1e-6 : 0));
        if (is_pinned(scene, v) || length < 10 * LEFT_SHARE * scale)
            continue;
        assert_true(rest.contact[v] > 0);
        assert_true(gap < GAP_SHARE * radius);
        /* the body presses into the tool, along the normal but for the width of a triangle */
        pel_vec3_subtract(rest.x[v], reading.position, out);
        pel_vec3_normalize(out);
        assert_true(pel_vec3_dot(rest.force[v], out) < -0.9 * length);
    }
    free_rest(&rest);
}

static void check_sphere(double young, bool gradient_only)
{
    press_scene scene;
    press_begin(&scene, 6, young);
    press_move(&scene, 1.5, 0.08);
    scene.def.solver.gradient_only = gradient_only;
    scene.def.solver.iterations = gradient_only ? 2000 : 400;
    pel_sim *sim = press_create(&scene);
    for (int n = 1; n <= ROUNDS(10, 3); n++) {
        run_steps(sim, 1);
        double force = assert_balanced(&scene, sim);
        assert_true(force > 0);
        assert_pressed_by_sphere(&scene, sim);
        assert_true(solver_of(sim).converged);
    }
    press_end(&scene, sim);
}

static void test_sphere_on_shell(void **unused)
{
    (void)unused;
    check_sphere(1e5, false);
}

static void test_sphere_on_springs(void **unused)
{
    (void)unused;
    check_sphere(0, false);
}

/* paper B's plain descent reaches the same state */
static void test_gradient_descent(void **unused)
{
    (void)unused;
    check_sphere(0, true);
}

/* a plate touches vertices alone, and its normal is known: the force on each of them is straight up */
static void test_plate(void **unused)
{
    (void)unused;
    press_scene scene;
    press_begin(&scene, 6, 1e5);
    scene.tool.shape = PEL_TOOL_BOX;
    pel_vec3_set(scene.tool.half_extents, 1.5, 1.5, 0.1);
    press_move(&scene, 1.1, 0.1);
    pel_sim *sim = press_create(&scene);
    for (int n = 1; n <= ROUNDS(10, 3); n++) {
        run_steps(sim, 1);
        double force = assert_balanced(&scene, sim), bottom = reading_of(sim, 0).position[2] - 0.1;
        rest_state rest = find_rest(sim);
        assert_true(solver_of(sim).converged);
        for (int32_t v = 0; v < scene.mesh->vertex_count; v++) {
            const double *f = rest.force[v];
            assert_true(rest.x[v][2] <= bottom + (sizeof(pel_real) == 4 ? 1e-6 : 1e-12));
            if (is_pinned(&scene, v))
                continue;
            assert_near(hypot(f[0], f[1]), 0, LEFT_SHARE * force);
            assert_true(f[2] > -LEFT_SHARE * force);
            if (f[2] > 10 * LEFT_SHARE * force)
                assert_near(rest.x[v][2], bottom, 1e-4);
        }
        free_rest(&rest);
    }
    press_end(&scene, sim);
}

/* down and up: the force grows and falls with the depth, without jumps, on the same curve, and its work is the energy
 */
static void test_press_and_release(void **unused)
{
    (void)unused;
    skip_if_slow();
    press_scene scene;
    press_begin(&scene, 6, 0);
    press_move(&scene, 1.5, 0.12);
    scene.def.solver.dt = 0.05;
    pel_sim *sim = press_create(&scene);
    double force[41] = {0}, energy[41] = {0}, largest = 0;
    for (int n = 1; n <= 40; n++) {
        run_steps(sim, 1);
        pel_sim_measures measures;
        pel_sim_measure(sim, &measures);
        force[n] = reading_of(sim, 0).force[2];
        energy[n] = measures.elastic_energy;
        largest = fmax(largest, force[n]);
    }
    for (int n = 1; n <= 20; n++) {
        assert_true(force[n] > force[n - 1] - 1e-3 * largest);
        assert_near(force[40 - n], force[n], 2e-3 * largest);
        double work = 0.5 * (force[n] + force[n - 1]) * 0.12 / 20;
        if (n > 1)
            assert_near(energy[n] - energy[n - 1], work, 0.02 * largest * 0.12 / 20);
        if (n > 1 && n < 20)
            assert_near(force[n + 1] - 2 * force[n] + force[n - 1], 0, 0.05 * largest);
    }
    assert_near(force[40], 0, 1e-6 * largest);
    assert_near(energy[40], 0, 1e-6 * energy[20]);
    press_end(&scene, sim);
}

/* the edges of a small box press into triangles: their forces lean, but all in all it is pushed straight up, the more
 * so the deeper it goes */
static void test_edges_of_box(void **unused)
{
    (void)unused;
    press_scene scene;
    press_begin(&scene, 8, 0);
    scene.tool.shape = PEL_TOOL_BOX;
    pel_vec3_set(scene.tool.half_extents, 0.4, 0.4, 0.2);
    press_move(&scene, 1.2, 0.2);
    scene.def.solver.dt = 0.05;
    pel_sim *sim = press_create(&scene);
    double before = 0;
    /* deeper, float does not converge, and says so */
    const int steps = sizeof(pel_real) == 8 ? LONG(20, 14) : 14;
    for (int n = 1; n <= steps; n++) {
        run_steps(sim, 1);
        if (sizeof(pel_real) == 4 && n > 8 && !solver_of(sim).converged)
            break;
        pel_tool_reading reading = reading_of(sim, 0);
        assert_true(reading.force[2] > before);
        assert_true(hypot(reading.force[0], reading.force[1]) < 0.1 * reading.force[2]);
        before = reading.force[2];
    }
    press_end(&scene, sim);
}

/* ---- capsules ---- */

static double distance_from_segment(const double x[3], const double ends[2][3])
{
    double along[3], way[3];
    pel_vec3_subtract(ends[1], ends[0], along);
    pel_vec3_subtract(x, ends[0], way);
    double share = fmin(fmax(pel_vec3_dot(way, along) / pel_vec3_squared_length(along), 0), 1);
    pel_vec3_along(way, -share, along, way);
    return pel_vec3_length(way);
}

/* of an edge: convex along it, so the least one is between thirds */
static double distance_of_edge(double x[2][3], const double ends[2][3])
{
    double low = 0, high = 1, values[2];
    for (int round = 0; round < 100; round++) {
        for (int i = 0; i < 2; i++) {
            const double at = (i == 0 ? 2 * low + high : low + 2 * high) / 3;
            double point[3];
            for (int k = 0; k < 3; k++)
                point[k] = (1 - at) * x[0][k] + at * x[1][k];
            values[i] = distance_from_segment(point, ends);
        }
        *(values[0] < values[1] ? &high : &low) = values[0] < values[1] ? (low + 2 * high) / 3 : (2 * low + high) / 3;
    }
    return fmin(values[0], values[1]);
}

/* Gaps of features to a turned capsule: distances from its axis, of triangles from one end of it, less its radius and
   the slack. They grow as weights and normal say. */
static void test_gaps_of_capsule(void **unused)
{
    (void)unused;
    press_scene scene;
    random_state random = {31};
    press_begin(&scene, 2, 0);
    scene.tool.shape = PEL_TOOL_CAPSULE;
    scene.tool.radius = 0.1;
    scene.tool.half_length = 0.3;
    press_move(&scene, 2, 0);
    pel_sim *sim = press_create(&scene);
    pel_pose *pose = &sim->tools->items[0].pose;
    double *position = sim->minimise->position;
    for (int n = 0; n < 400; n++) {
        const double half = scene.tool.half_length, low[3] = {0, 0, -half}, high[3] = {0, 0, half};
        double ends[2][3], x[3][3], size = 0, weights[3];
        for (int k = 0; k < 4; k++)
            size += pow(pose->rotation[k] = random_normal(&random), 2);
        for (int k = 0; k < 4; k++)
            pose->rotation[k] /= sqrt(size);
        for (int k = 0; k < 3; k++)
            pose->position[k] = random_between(&random, -0.2, 0.2);
        for (int i = 0; i < 2; i++) {
            pel_rotate(pose->rotation, i == 0 ? low : high, ends[i]);
            pel_vec3_add(ends[i], pose->position, ends[i]);
        }
        for (int i = 0; i < 9; i++)
            position[i] = x[i / 3][i % 3] = random_between(&random, -0.8, 0.8);
        const pel_minimise_contact constraint = {
            .vertices = {0, 1, 2, 2}, .offset = 0.01, .points = 1 + n % 3, .end = n % 2 == 0 ? -1 : 1};
        double expected = constraint.points == 1 ? distance_from_segment(x[0], (const double(*)[3])ends)
                          : constraint.points == 2
                              ? distance_of_edge(x, (const double(*)[3])ends)
                              : sqrt(pel_closest_point_triangle(ends[constraint.end > 0], x[0], x[1], x[2], weights));
        pel_gap_sample meeting, moved;
        pel_minimise_contact_meet(sim, &constraint, position, &meeting);
        assert_near(meeting.gap, expected - 0.1 - 0.01, 1e-9);
        if (expected < 0.05)
            continue;
        for (int i = 0; i < 3 * constraint.points; i++) {
            position[i] += 1e-6;
            pel_minimise_contact_meet(sim, &constraint, position, &moved);
            assert_near((moved.gap - meeting.gap) / 1e-6, meeting.weights[i / 3] * meeting.normal[i % 3], 1e-4);
            position[i] = x[i / 3][i % 3];
        }
    }
    press_end(&scene, sim);
}

/* Under a turned capsule that is shorter than an edge along its axis, the edge has no gap of its own, since it would
   jump from end to end. */
static void test_edges_along_capsule(void **unused)
{
    (void)unused;
    press_scene scene;
    press_begin(&scene, 2, 0);
    pel_mesh_destroy(scene.mesh);
    pel_shape_def grid = pel_shape_def_default(PEL_SHAPE_GRID);
    grid.nx = grid.ny = 4;
    assert_int_equal(pel_shape_create(&grid, &scene.mesh, NULL), PEL_OK);
    scene.body.mesh = scene.mesh;
    scene.body.volumetric_stiffness.value = scene.body.volumetric_damping.value = 0;
    scene.body.pinned_count = 0;
    for (int32_t v = 0; v < scene.mesh->vertex_count; v++)
        if (fmax(fabs(scene.mesh->positions[v][0]), fabs(scene.mesh->positions[v][1])) > 0.49)
            scene.pinned[scene.body.pinned_count++] = v;
    scene.tool.shape = PEL_TOOL_CAPSULE;
    scene.tool.radius = 0.1;
    scene.tool.half_length = 0.05;
    press_move(&scene, 0.1, 0.02);
    for (int k = 0; k < PRESS_KEYS; k++) {
        scene.keys[k].position[0] = 0.125;
        scene.keys[k].rotation[1] = scene.keys[k].rotation[3] = sqrt(0.5);
    }
    pel_sim *sim = press_create(&scene);
    run_steps(sim, 1);
    const pel_minimise *descent = sim->minimise;
    int32_t counts[4] = {0};
    for (int32_t c = 0; c < descent->count; c++) {
        const pel_minimise_contact *constraint = &descent->constraints[c];
        const double *from = descent->position + 3 * (size_t)constraint->vertices[0];
        const double *to = descent->position + 3 * (size_t)constraint->vertices[1];
        counts[constraint->points]++;
        if (constraint->points == 2)
            assert_true(fabs(to[1] - from[1]) + fabs(to[2] - from[2]) > 1e-3 * fabs(to[0] - from[0]));
    }
    assert_true(counts[3] > 0);
    assert_true(reading_of(sim, 0).force[2] > 0);
    press_end(&scene, sim);
}

/* held vertices go before the others are minimised: the body is at rest around them */
static void test_grasp(void **unused)
{
    (void)unused;
    press_scene scene;
    press_begin(&scene, 6, 0);
    press_move(&scene, 1.5, -0.2);
    scene.tool.press = false;
    scene.tool.grasp = true;
    scene.tool.reach = 0.05;
    pel_sim *sim = press_create(&scene);
    for (int n = 0; n < ROUNDS(5, 2); n++) {
        run_steps(sim, 1);
        assert_true(assert_balanced(&scene, sim) < 0);
        assert_true(solver_of(sim).converged);
    }
    press_end(&scene, sim);
}

/* a tool that moves far in a step does not pass through the body */
static void test_fast_tool(void **unused)
{
    (void)unused;
    press_scene scene;
    press_begin(&scene, 6, 0);
    scene.tool.radius = 0.2;
    press_move(&scene, 1.2, 0.6);
    scene.def.solver.dt = 1;
    scene.def.solver.iterations = 2000;
    pel_sim *sim = press_create(&scene);
    run_steps(sim, 1);
    assert_balanced(&scene, sim);
    assert_true(height_of(sim, nearest_vertex(scene.mesh, 0, 0, 1)) < reading_of(sim, 0).position[2]);
    press_end(&scene, sim);
}

/* as long as a tool touches nothing it changes nothing */
static void test_far_tool(void **unused)
{
    (void)unused;
    static const double pull[3] = {0, 0, 0.5};
    press_scene scene;
    pel_load_def load = pel_load_def_default();
    memcpy(load.force, pull, sizeof pull);
    double *x[2];
    for (int with_tool = 0; with_tool < 2; with_tool++) {
        press_begin(&scene, 4, 0);
        press_move(&scene, 5, 0.1);
        scene.def.tool_count = with_tool;
        scene.def.loads = &load;
        scene.def.load_count = 1;
        pel_sim *sim = press_create(&scene);
        run_steps(sim, 5);
        x[with_tool] = malloc(3 * (size_t)scene.mesh->vertex_count * sizeof **x);
        pel_sim_get_positions(sim, 0, x[with_tool]);
        if (with_tool == 1)
            assert_memory_equal(x[0], x[1], 3 * (size_t)scene.mesh->vertex_count * sizeof **x);
        press_end(&scene, sim);
    }
    free(x[0]);
    free(x[1]);
}

/* a run that is saved and resumed, and one with more threads, give the same bits */
static void test_bits(void **unused)
{
    (void)unused;
    enum { CASES = 3 };
    press_scene scene;
    double *x[CASES], force[CASES];
    for (int i = 0; i < CASES; i++) {
        press_begin(&scene, 14, 0);
        press_move(&scene, 1.5, 0.05);
        scene.def.solver.iterations = 20;
        scene.def.thread_count = i == 1 ? 2 : 1;
        pel_sim *sim = press_create(&scene);
        run_steps(sim, 3);
        if (i == 2)
            sim = resume_sim(sim, &scene.def);
        run_steps(sim, 3);
        x[i] = malloc(3 * (size_t)scene.mesh->vertex_count * sizeof **x);
        pel_sim_get_positions(sim, 0, x[i]);
        force[i] = reading_of(sim, 0).force[2];
        assert_memory_equal(x[0], x[i], 3 * (size_t)scene.mesh->vertex_count * sizeof **x);
        assert_true(force[0] > 0 && force[0] == force[i]);
        press_end(&scene, sim);
    }
    for (int i = 0; i < CASES; i++)
        free(x[i]);
}

/* constraints are as stiff as the surface: with the stiffness of the base, 16 times lower than that of level 2, rounds
   ended before the gaps were closed */
static void test_refined(void **unused)
{
    (void)unused;
    press_scene scene;
    press_begin(&scene, 5, 0);
    scene.body.mass_kind = PEL_MASS_DENSITY;
    scene.body.mass = 1000;
    scene.body.thickness.value = 1.0 / 3;
    scene.body.spring_stiffness.value = scene.body.volumetric_stiffness.value = 5000;
    scene.body.spring_thickness = 0.1;
    scene.body.volumetric_depth = 1;
    scene.body.refine.levels = 2;
    scene.body.refine.everywhere = true;
    scene.def.solver.method = PEL_METHOD_STATIC;
    scene.def.solver.iterations = 0;
    press_move(&scene, 1.5, 0.2);
    pel_sim *sim = press_create(&scene);
    for (int n = 0; n < LONG(10, 3); n++) {
        run_steps(sim, 1);
        assert_true(solver_of(sim).converged);
    }
    press_end(&scene, sim);
}

/* ---- memory ---- */

/* allocates where more is touched than ever before, and no more on the way back */
static void test_allocation(void **unused)
{
    (void)unused;
    press_scene scene;
    press_begin(&scene, 4, 0);
    press_move(&scene, 1.5, 0.1);
    pel_sim *sim = press_create(&scene);
    run_steps(sim, 10);
    failing_malloc_begin(0);
    for (int n = 0; n < 10; n++)
        assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
    assert_int_equal(failing_malloc_end().calls, 0);
    press_end(&scene, sim);
}

static void save(const pel_sim *sim, unsigned char **bytes, size_t *size)
{
    *size = pel_sim_save_size(sim);
    *bytes = calloc(1, *size);
    pel_sim_save(sim, *bytes);
}

/* a step for which there was no memory leaves everything as it was, and done again gives the same bits */
static void check_step_again(pel_tool_shape shape)
{
    long failed = 1;
    unsigned char *wanted = NULL;
    for (long n = 0; failed > 0 || n == 1; n++) {
        press_scene scene;
        press_begin(&scene, 4, 0);
        scene.tool.shape = shape;
        pel_vec3_set(scene.tool.half_extents, 1.5, 1.5, 0.5);
        press_move(&scene, 1.5, 0.2);
        scene.def.solver.iterations = 5;
        pel_sim *sim = press_create(&scene);
        unsigned char *before, *after;
        size_t size;
        /* the list that the first step made is too short for the next one */
        run_steps(sim, 1);
        save(sim, &before, &size);
        failing_malloc_begin(n);
        pel_status status = pel_sim_step(sim, NULL);
        failed = failing_malloc_end().failed;
        assert_int_equal(status, failed > 0 ? PEL_OUT_OF_MEMORY : PEL_OK);
        save(sim, &after, &size);
        if (failed > 0) {
            assert_memory_equal(before, after, size);
            assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
        }
        run_steps(sim, 2);
        free(after);
        save(sim, &after, &size);
        if (n == 0)
            wanted = calloc(1, size), memcpy(wanted, after, size);
        else
            assert_memory_equal(wanted, after, size);
        free(before);
        free(after);
        press_end(&scene, sim);
    }
    free(wanted);
}

static void test_step_again(void **unused)
{
    (void)unused;
    check_step_again(PEL_TOOL_BOX);
    check_step_again(PEL_TOOL_SPHERE);
}

static pel_status press_once(const void *def, pel_error *error)
{
    pel_sim *sim;
    pel_status status = pel_sim_create(def, &sim, error);
    for (int n = 0; status == PEL_OK && n < 2; n++) {
        pel_tool_reading before = reading_of(sim, 0);
        int64_t step = pel_sim_step_count(sim);
        status = pel_sim_step(sim, error);
        pel_tool_reading after = reading_of(sim, 0);
        if (status != PEL_OK) {
            assert_memory_equal(before.position, after.position, sizeof before.position);
            assert_int_equal(pel_sim_step_count(sim), step);
        }
    }
    pel_sim_destroy(sim);
    return status;
}

static void test_every_allocation(void **unused)
{
    (void)unused;
    for (int contact = 0; contact < 2; contact++) {
        press_scene scene;
        press_begin(&scene, 3, 0);
        scene.tool.shape = PEL_TOOL_BOX;
        pel_vec3_set(scene.tool.half_extents, 1.5, 1.5, 0.1);
        press_move(&scene, 1.11, 0.1);
        scene.def.contact.enabled = contact == 1;
        scene.def.solver.iterations = 5;
        scene.model = make_model(&scene.body);
        scene.def.model = scene.model;
        assert_true(for_every_allocation_failure(press_once, &scene.def) > 20);
        press_end(&scene, NULL);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere_on_shell),
        cmocka_unit_test(test_sphere_on_springs),
        cmocka_unit_test(test_gradient_descent),
        cmocka_unit_test(test_plate),
        cmocka_unit_test(test_press_and_release),
        cmocka_unit_test(test_edges_of_box),
        cmocka_unit_test(test_gaps_of_capsule),
        cmocka_unit_test(test_edges_along_capsule),
        cmocka_unit_test(test_grasp),
        cmocka_unit_test(test_fast_tool),
        cmocka_unit_test(test_far_tool),
        cmocka_unit_test(test_bits),
        cmocka_unit_test(test_refined),
        cmocka_unit_test(test_allocation),
        cmocka_unit_test(test_step_again),
        cmocka_unit_test(test_every_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
