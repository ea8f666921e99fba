/* Surfaces that touch while an energy is minimised: collapsing shells stay free of intersections and come to rest,
   friction sticks and slips. */
#include "constraint/constraint.h"
#include "math/vec3.h"
#include "minimise/rounds.h"
#include "random.h"
#include "sim/contact_scene.h"
#include "stage/stage.h"

/* a thin shell with hinges */
static void scene_shell(contact_scene *scene, int32_t frequency)
{
    scene_begin(scene, PEL_METHOD_DESCENT);
    scene_body(scene, make_sphere(frequency));
    pel_body_def *body = &scene->bodies[0];
    *body = pel_body_def_sheet(body->name, body->mesh, 1e5, 0.01, 1000);
    body->shell.membrane.kind = PEL_MEMBRANE_STVK;
    body->shell.bending.model = PEL_BENDING_HINGE;
    scene->def.solver.dt = 0.025;
    scene->def.solver.iterations = 100;
}

static pel_solver_reading solver_of(const pel_sim *sim)
{
    pel_solver_reading reading;
    pel_sim_get_solver(sim, &reading);
    return reading;
}

/* A shell that the pressure of the air collapses to less than a quarter touches itself all over. The guard, which had
   to step back some ten thousand vertices before contacts took part in the minimisation, is hardly needed: 14 to 341
   times with pressures of 39 to 41 Pa at the end, as the shell buckles one way or another. */
static void test_collapse(void **unused)
{
    (void)unused;
    static const pel_key keys[2] = {{0, 0}, {1, 40}};
    contact_scene scene;
    scene_shell(&scene, LONG(8, ROUNDS(5, 4)));
    scene.bodies[0].shell.pressure.kind = PEL_PRESSURE_GIVEN;
    scene.bodies[0].shell.pressure.outside.value = 1;
    scene.bodies[0].shell.pressure.outside.keys = keys;
    scene.bodies[0].shell.pressure.outside.key_count = 2;
    pel_sim *sim = scene_create(&scene);
    int64_t most = run_free(sim, ROUNDS(40, 20));
    pel_sim_measures measures;
    pel_sim_measure(sim, &measures);
    if (!is_slow()) {
        assert_true(most > 100 && measures.volume_ratio < 0.25);
        assert_true(statistics_of(sim).fall_backs < 1000);
    }
    scene_end(&scene, sim);
}

/* between two plates, both feel the same, and nothing is stepped back */
static void test_plates(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_shell(&scene, ROUNDS(6, 4));
    scene.def.solver.iterations = ROUNDS(400, 50);
    for (int i = 0; i < 2; i++) {
        pel_tool_def *tool = scene_tool(&scene, PEL_TOOL_BOX);
        tool->half_extents[0] = tool->half_extents[1] = 2;
        tool->half_extents[2] = 0.1;
        double side = i == 0 ? 1 : -1;
        scene_move(&scene, i, 0, 0, 1.12 * side, 0.7 * side, 1);
    }
    pel_sim *sim = scene_create(&scene);
    int touching = 0;
    for (int n = 0; n < ROUNDS(40, 8); n++) {
        assert_true(run_free(sim, 1) >= 0);
        pel_tool_reading upper, lower;
        pel_sim_get_tool(sim, 0, &upper);
        pel_sim_get_tool(sim, 1, &lower);
        assert_true(upper.force[2] >= 0 && lower.force[2] <= 0);
        if (!solver_of(sim).converged)
            continue;
        touching += upper.force[2] > 0;
        /* limit of the sum of the residual forces on all vertices */
        double left = sqrt(scene.meshes[0]->vertex_count) * solver_of(sim).residual;
        assert_near(upper.force[2], -lower.force[2], left + 1e-6 * upper.force[2]);
    }
    if (!is_slow())
        assert_true(touching >= 5);
    assert_true(statistics_of(sim).fall_backs <= (is_slow() ? 50 : 0));
    assert_int_equal(statistics_of(sim).tools_held, 0);
    scene_end(&scene, sim);
}

/* A ball on the ground is pressed by a plate that then goes sideways: it sticks at first, with less than Coulomb's
   force, then slips, with just that. Returns the force across over that along. */
static double rub(pel_tool_shape shape, double friction, double sideways, double *way)
{
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_DESCENT);
    scene_body(&scene, make_sphere(4));
    pel_body_def *body = &scene.bodies[0];
    body->volumetric_stiffness.value = 10;
    pel_tool_def *tool = scene_tool(&scene, shape);
    tool->half_extents[0] = tool->half_extents[1] = 2;
    tool->half_extents[2] = 0.1;
    tool->radius = 1;
    double touching = shape == PEL_TOOL_BOX ? 1.1 : 2;
    pel_pose_key *keys = scene.keys[0];
    keys[0] = (pel_pose_key){0, {0, 0, touching + 1e-3}, {0, 0, 0, 1}, {0}};
    keys[1] = (pel_pose_key){1, {0, 0, touching - 0.05}, {0, 0, 0, 1}, {0}};
    keys[2] = (pel_pose_key){2, {sideways, 0, touching - 0.05}, {0, 0, 0, 1}, {0}};
    scene.tools[0].key_count = 3;
    scene.def.contact.friction = friction;
    scene.def.solver.dt = 0.1;
    scene.def.solver.iterations = 400;
    pel_sim *sim = scene_create(&scene);
    int32_t top = nearest_vertex(scene.meshes[0], 0, 0, 1);
    double *x = malloc(3 * (size_t)scene.meshes[0]->vertex_count * sizeof *x), before;
    run_steps(sim, 10);
    pel_sim_get_positions(sim, 0, x);
    before = x[3 * top];
    run_steps(sim, 10);
    pel_sim_get_positions(sim, 0, x);
    *way = x[3 * top] - before;
    pel_tool_reading reading;
    pel_sim_get_tool(sim, 0, &reading);
    assert_true(reading.force[2] > 0 && solver_of(sim).converged);
    free(x);
    scene_end(&scene, sim);
    return reading.force[0] / reading.force[2];
}

static void test_friction(void **unused)
{
    (void)unused;
    double way;
    /* nothing but the facets of the ball holds a smooth plate */
    assert_near(rub(PEL_TOOL_BOX, 0, 0.02, &way), 0, sizeof(pel_real) == 4 ? 1e-2 : 1e-4);
    /* sticks: touching vertices move along, with less than the friction limit */
    double held = rub(PEL_TOOL_BOX, 2, 0.002, &way);
    assert_near(way, 0.002, sizeof(pel_real) == 4 ? 3e-4 : 2e-5);
    assert_true(held < -0.01 && held > -2);
    /* slips: Coulomb's force, against the way */
    double slipping = rub(PEL_TOOL_BOX, 0.1, 0.3, &way);
    assert_near(slipping, -0.1, 2e-3);
    assert_true(way > 0 && way < 0.15);
    /* round tools too */
    held = rub(PEL_TOOL_SPHERE, 0.5, 0.005, &way);
    assert_near(way, 0.005, 5e-4);
    assert_true(held < 0);
}

/* a pressed body does not move while nothing else moves: no creep under friction, and steps without iterations */
static void test_standstill(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_DESCENT);
    scene_body(&scene, make_sphere(4));
    scene.bodies[0].volumetric_stiffness.value = 10;
    pel_tool_def *tool = scene_tool(&scene, PEL_TOOL_SPHERE);
    tool->radius = 0.5;
    scene_move(&scene, 0, 0.3, 0.1, 1.6, 1.3, 0.05);
    scene.def.contact.friction = 0.3;
    scene.def.solver.iterations = 400;
    pel_sim *sim = scene_create(&scene);
    size_t size = 3 * (size_t)scene.meshes[0]->vertex_count * sizeof(double);
    double *x = malloc(size), *y = malloc(size);
    run_steps(sim, 10);
    pel_sim_get_positions(sim, 0, x);
    run_steps(sim, 20);
    pel_sim_get_positions(sim, 0, y);
    for (size_t i = 0; i < size / sizeof *x; i++)
        assert_near(y[i], x[i], 1e-4);
    assert_true(solver_of(sim).converged);
    free(x);
    free(y);
    scene_end(&scene, sim);
}

/* What an update tells is the largest change of a load, as a gap, and of friction, over the tolerance of each. */
static void test_update(void **unused)
{
    (void)unused;
    contact_scene scene;
    random_state random = {5};
    scene_begin(&scene, PEL_METHOD_DESCENT);
    scene_body(&scene, make_sphere(4));
    scene.bodies[0].volumetric_stiffness.value = 10;
    pel_tool_def *tool = scene_tool(&scene, PEL_TOOL_BOX);
    tool->half_extents[0] = tool->half_extents[1] = 2;
    tool->half_extents[2] = 0.1;
    scene_move(&scene, 0, 0, 0, 1.11, 1.05, 0.05);
    scene.def.contact.friction = 0.3;
    scene.def.solver.iterations = 400;
    pel_sim *sim = scene_create(&scene);
    run_steps(sim, 10);
    pel_minimise *minimise = sim->minimise;
    const size_t count = (size_t)minimise->count;
    pel_minimise_contact *before = malloc(count * sizeof *before);
    int changed = 0;
    for (int round = 0; round < 20; round++) {
        /* along the plate alone, then all ways */
        for (int32_t v = 0; v < sim->model->vertex_count; v++)
            for (int k = 0; k < (round < 10 ? 2 : 3); k++)
                minimise->position[3 * v + k] += random_between(&random, -1e-5, 1e-5);
        memcpy(before, minimise->constraints, count * sizeof *before);
        pel_contact_change change = pel_minimise_contacts_update(sim);
        double gap = 0, slip = 0;
        for (size_t c = 0; c < count; c++) {
            const pel_minimise_contact *now = &minimise->constraints[c];
            double way = pel_vec3_distance(now->drag, before[c].drag);
            slip = fmax(slip, way / (now->across * now->tolerance));
            gap = fmax(gap, fabs(now->load - before[c].load) / (now->share * now->stiffness * now->tolerance));
        }
        assert_near(change.slip, slip, 1e-12 * slip);
        assert_near(change.gap, gap, 1e-12 * gap + 1e-12);
        changed += slip > 0 && (round < 10 || gap > 0);
    }
    assert_true(changed > 15);
    free(before);
    scene_end(&scene, sim);
}

/* one correction after the step, as in paper B: contacts take no part in the minimisation, and the end is free */
static void test_after(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_shell(&scene, 4);
    scene.def.contact.response = PEL_CONTACT_AFTER;
    for (int i = 0; i < 2; i++) {
        pel_tool_def *tool = scene_tool(&scene, PEL_TOOL_BOX);
        tool->half_extents[0] = tool->half_extents[1] = 2;
        tool->half_extents[2] = 0.1;
        double side = i == 0 ? 1 : -1;
        scene_move(&scene, i, 0, 0, 1.12 * side, 0.9 * side, 1);
    }
    pel_sim *sim = scene_create(&scene);
    run_free(sim, 10);
    scene_end(&scene, sim);
}

/* what is near goes by the edges of the level that the surface is on: there is room for all of it */
static void test_refined(void **unused)
{
    (void)unused;
    enum { REGION = 4 };
    static const int32_t region[REGION] = {0, 1, 2, 3};
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_DESCENT);
    scene_body(&scene, make_sphere(4));
    scene.bodies[0].refine.levels = 3;
    scene.bodies[0].refine.region = region;
    scene.bodies[0].refine.region_count = REGION;
    scene.bodies[0].refine.rings = 3;
    pel_sim *sim = scene_create(&scene);
    assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
    assert_int_equal(statistics_of(sim).dropped, 0);
    assert_true(statistics_of(sim).passed_hull < pel_sim_vertex_count(sim, 0));
    scene_end(&scene, sim);
}

/* the correction keeps a mesh out too, which then receives the contact force of the body */
static void test_mesh_after(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_DESCENT);
    scene_body(&scene, make_sphere(4));
    scene.def.contact.response = PEL_CONTACT_AFTER;
    pel_mesh *ball = make_sphere(2);
    scene_tool(&scene, PEL_TOOL_MESH)->mesh = ball;
    scene_move(&scene, 0, 0, 0, 2.05, 1.9, 1);
    pel_sim *sim = scene_create(&scene);
    pel_tool_reading reading;
    run_free(sim, 100);
    pel_sim_get_tool(sim, 0, &reading);
    assert_true(reading.contact_count > 0);
    assert_true(reading.force[2] > 0);
    scene_end(&scene, sim);
    pel_mesh_destroy(ball);
}

/* N, force of a plate on a sheet that it and a table leave a share of the two layers: at once, and how much it changes
   while nothing moves */
static double jam_force(double dt, int32_t cells, double height, double *drift)
{
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_IMPLICIT);
    scene_body(&scene, make_sheet(cells, 0));
    scene.bodies[0].spring_stiffness.value = scene.bodies[0].spring_damping.value = 0;
    scene.bodies[0].shell.membrane.on = true;
    scene.bodies[0].shell.membrane.young.value = 1e5;
    scene.bodies[0].shell.membrane.thickness.value = 0.1;
    scene.def.solver.dt = dt;
    scene.def.contact.thickness = 0.1;
    for (int t = 0; t < 2; t++)
        pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 2, 2, 0.1);
    scene_move(&scene, 0, 0.5, 0.5, 0.21, 0.1 + height, 0.2);
    scene_move(&scene, 1, 0.5, 0.5, -0.2, -0.2, 1);
    pel_sim *sim = scene_create(&scene);
    double least = HUGE_VAL, most = 0;
    int count = (int)(0.1 / dt + 0.5);
    run_free(sim, 3 * count);
    for (int n = 0; n < count; n++) {
        pel_tool_reading reading;
        run_steps(sim, 1);
        pel_sim_get_tool(sim, 0, &reading);
        assert_true(reading.force_known);
        least = fmin(least, reading.force[2]);
        most = fmax(most, reading.force[2]);
    }
    assert_true(solver_of(sim).converged);
    scene_end(&scene, sim);
    *drift = most / least - 1;
    return most;
}

/* No load closes the gaps of a sheet in too narrow a room: its layers give way by their law, whatever the steps and the
   mesh, although a vertex is pressed by its own pair and by those of its edges. The sheet of area 1 and modulus 1e5 N/m
   has the load (d / h) / (1 - d / h) E A with the depth d and the slack of gaps, 5 % of the thickness. Gaps may be
   wrong by 3.75 % of it, so that forces are not exact. Rigid gaps have none: multipliers grow from round to round,
   until the step diverges. */
static void test_jam(void **unused)
{
    (void)unused;
    for (int i = 0; i < 2; i++) {
        double height = i == 0 ? 0.05 : 0.02, drift, strain = (0.1 - height) / 0.2 + 0.05;
        double expected = 1e5 * strain / (1 - strain);
        for (int k = 0; k < ROUNDS(4, 1); k++) {
            double force = jam_force((const double[4]){0.02, 0.01, 0.005, 0.002}[k], k == 1 ? 4 : 6, height, &drift);
            print_message("height %g: force %g N, law %g N, drift %g\n", height, force, expected, drift);
            assert_true(drift < 0.05);
            assert_near(force, expected, 0.1 * expected);
        }
    }
}

/* A finger presses a cloth on a table too far, where steps find no balance: the systems of each are bounded, no surface
   is crossed, no energy appears, and forces of steps that do not converge are not known. The worst of these steps takes
   172 systems: those of the bound, and few for each part of the rest. */
static void test_bound(void **unused)
{
    (void)unused;
    skip_if_slow();
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_IMPLICIT);
    scene_body(&scene, make_sheet(16, 0));
    scene.bodies[0].spring_stiffness.value = scene.bodies[0].spring_damping.value = 0;
    scene.bodies[0].mass_kind = PEL_MASS_DENSITY;
    scene.bodies[0].mass = 1000;
    scene.bodies[0].shell.membrane.on = true;
    scene.bodies[0].shell.membrane.young.value = 1e6;
    scene.bodies[0].thickness.value = scene.bodies[0].shell.membrane.thickness.value = 0.005;
    scene.def.solver.dt = 0.01;
    scene.def.contact.thickness = 0.005;
    scene.def.contact.friction = 0.3;
    scene.gravity = -9.81;
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 0.125, 0.125, 0.05);
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 2, 2, 0.1);
    scene_move(&scene, 0, 0.5, 0.5, 0.0645, 0.047, 0.1);
    scene_move(&scene, 1, 0.5, 0.5, -0.1055, -0.1055, 1);
    pel_sim *sim = scene_create(&scene);
    int32_t most = 0, unknown = 0;
    int64_t work = 0;
    for (int n = 0; n < 45; n++) {
        int64_t before = pel_newton_work(sim->newton);
        assert_true(run_free(sim, 1) >= 0);
        most = sim->part.systems > most ? sim->part.systems : most;
        work = pel_newton_work(sim->newton) - before > work ? pel_newton_work(sim->newton) - before : work;
        pel_tool_reading reading;
        pel_sim_get_tool(sim, 0, &reading);
        assert_true(solver_of(sim).converged || !reading.force_known);
        unknown += !reading.force_known;
    }
    pel_sim_ledger ledger;
    pel_sim_get_ledger(sim, &ledger);
    assert_true(most < PEL_STEP_SYSTEMS + 60);
    assert_true(work < (PEL_STEP_SYSTEMS + 60) * PEL_SYSTEM_WORK);
    assert_in_range(unknown, 1, 10);
    assert_true(ledger.energy_error < 0.01 * ledger.supplied);
    scene_end(&scene, sim);
}

/* bodies of the two sides */
static void read_sides(const pel_sim *sim, const pel_minimise_contact *constraint, int32_t bodies[2])
{
    bodies[0] = bodies[1] = -1;
    for (int i = 0; i < 4; i++)
        if (constraint->weights[i] != 0)
            bodies[constraint->weights[i] < 0] = sim->model->body_of_slice[constraint->vertices[i] / PEL_WIDTH];
}

/* whether two constraints have the same points, by brute force: the sums of their weights for each vertex */
static bool are_same(const pel_sim *sim, const pel_minimise_contact *a, const pel_minimise_contact *b, double *sum)
{
    double most[2] = {0, 0};
    for (int side = 0; side < 2; side++) {
        memset(sum, 0, (size_t)sim->model->vertex_count * sizeof *sum);
        for (int i = 0; i < 4; i++) {
            sum[a->vertices[i]] += a->weights[i];
            sum[b->vertices[i]] += (side == 0 ? -1 : 1) * b->weights[i];
        }
        for (int32_t v = 0; v < sim->model->vertex_count; v++)
            most[side] = fabs(sum[v]) > most[side] ? fabs(sum[v]) : most[side];
    }
    double along = pel_vec3_dot(a->normal, b->normal);
    return (most[0] < 1e-4 && along > 1 - 1e-7) || (most[1] < 1e-4 && along < -1 + 1e-7);
}

/* Three sheets whose vertices lie above each other, on a floor: each pair of points is one constraint, although some
   thirty pairs of triangles and edges meet there; at rest the first and the third sheet have none, and the floor bears
   the weight of all. */
static void test_stack(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_IMPLICIT);
    for (int b = 0; b < 3; b++) {
        pel_mesh *mesh = make_sheet(4, 0);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            mesh->positions[v][2] = 0.004 + 0.006 * b;
        scene_body(&scene, mesh);
        pel_body_def *body = &scene.bodies[b];
        *body = pel_body_def_sheet(body->name, body->mesh, 1e6, 0.002, 1000);
    }
    scene.gravity = -9.81;
    scene.def.solver.dt = 0.01;
    scene.def.contact.thickness = 0.002;
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 2, 2, 0.1);
    scene_move(&scene, 0, 0, 0, -0.1, -0.1, 1);
    pel_sim *sim = scene_create(&scene);
    assert_true(run_free(sim, 60) >= 0);
    const pel_minimise *minimise = sim->minimise;
    double *sum = malloc((size_t)sim->model->vertex_count * sizeof *sum), mass = 0;
    int32_t between = 0;
    for (int32_t c = minimise->tool_count; c < minimise->count; c++) {
        int32_t bodies[2];
        read_sides(sim, &minimise->constraints[c], bodies);
        assert_int_equal(abs(bodies[0] - bodies[1]), 1);
        between++;
        for (int32_t d = minimise->tool_count; d < c; d++)
            assert_false(are_same(sim, &minimise->constraints[c], &minimise->constraints[d], sum));
    }
    assert_in_range(between, 2 * scene.meshes[0]->vertex_count, 16 * scene.meshes[0]->vertex_count);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        mass += (double)sim->model->mass[v];
    /* the mean of steps, each of which is balanced to 0.1 % of all forces */
    double force = 0;
    enum { MEAN_STEPS = 40 };
    for (int n = 0; n < MEAN_STEPS; n++) {
        pel_tool_reading reading;
        run_steps(sim, 1);
        pel_sim_get_tool(sim, 0, &reading);
        force -= reading.force[2] / MEAN_STEPS;
    }
    assert_near(force, 9.81 * mass, 0.01 * mass);
    free(sum);
    scene_end(&scene, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_collapse),   cmocka_unit_test(test_plates), cmocka_unit_test(test_friction),
        cmocka_unit_test(test_standstill), cmocka_unit_test(test_after),  cmocka_unit_test(test_refined),
        cmocka_unit_test(test_mesh_after), cmocka_unit_test(test_jam),    cmocka_unit_test(test_bound),
        cmocka_unit_test(test_stack),      cmocka_unit_test(test_update),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
