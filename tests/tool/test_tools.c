/* Tools: no penetration, forces that balance, grasping, refusals. */
#include "geom/solid.h"
#include "math/pose.h"
#include "pellicle/sim_ledger.h"
#include "sim/fixture.h"
#include "sim/snapshot.h"
#include "tool/tool.h"

static stage make_stage_with(int32_t frequency, const pel_tool_def *tools, int32_t count, pel_method method,
                             const pel_load_def *load)
{
    stage s;
    s.mesh = make_sphere(frequency);
    pel_body_def body = ball_body(s.mesh);
    body.volumetric_by_area = true;
    s.model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = s.model;
    def.solver.method = method;
    def.tools = tools;
    def.tool_count = count;
    def.loads = load;
    def.load_count = load != NULL;
    s.sim = make_sim(&def);
    return s;
}

static stage make_stage(int32_t frequency, const pel_tool_def *tools, int32_t count, pel_method method)
{
    return make_stage_with(frequency, tools, count, method, NULL);
}

/* deepest point of any triangle in the tool, from the public positions */
static double penetration(const stage *s, const pel_solid *solid, int32_t tool)
{
    pel_tool_reading reading;
    pel_sim_get_tool(s->sim, tool, &reading);
    double *x = malloc(3 * sizeof *x * (size_t)s->mesh->vertex_count), deepest = 0;
    pel_sim_get_positions(s->sim, 0, x);
    for (int32_t t = 0; t < s->mesh->triangle_count; t++) {
        double corner[3][3], weights[3], normal[3];
        for (int c = 0; c < 3; c++) {
            pel_vec3_subtract(x + 3 * s->mesh->triangles[t][c], reading.position, corner[c]);
            pel_rotate_back(reading.rotation, corner[c], corner[c]);
        }
        deepest = fmax(deepest, pel_solid_depth(solid, corner[0], corner[1], corner[2], weights, normal));
    }
    free(x);
    return deepest;
}

#define DOWN_UP(start, low)                                                                                            \
    {                                                                                                                  \
        {0, {0, 0, start}, {0, 0, 0, 1}, {0}}, {1, {0, 0, low}, {0, 0, 0, 1}, {0}},                                    \
            {2, {0, 0, low}, {0, 0, 0, 1}, {0}}, {3, {0, 0, start}, {0, 0, 0, 1}, {0}},                                \
    }

/* a tool pressed 0.3 into the sphere, held, and withdrawn; coarse and fine meshes, both methods */
static void check_press(pel_tool_def tool, double half_height, int32_t frequency, pel_method method)
{
    const pel_pose_key keys[4] = DOWN_UP(1.05 + half_height, 0.7 + half_height);
    const pel_solid solid = pel_solid_of(&tool);
    tool.name = "probe";
    tool.keys = keys;
    tool.key_count = 4;
    stage s = make_stage(frequency, &tool, 1, method);
    double size = tool.radius + tool.half_extents[0], most = 0, pressing = 0, last = 0;
    for (int n = 1; n <= 400; n++) {
        run_steps(s.sim, 1);
        most = fmax(most, penetration(&s, &solid, 0));
        pel_tool_reading reading;
        pel_sim_get_tool(s.sim, 0, &reading);
        last = reading.force[2];
        pressing += last / 400;
        if (n == 5)
            assert_int_equal(reading.contact_count, 0);
        /* with inertia the body may be thrown clear of the tool */
        if (n == 200 && method == PEL_METHOD_QUASI_STATIC)
            assert_true(reading.contact_count >= 1);
    }
    /* never deeper than a thousandth of the tool; pushed back up while pressing; nothing when gone */
    assert_true(most < 1e-3 * size);
    assert_true(pressing > 0);
    assert_true(last == 0);
    end_stage(&s);
}

static void test_press(void **unused)
{
    (void)unused;
    pel_tool_def sphere = pel_tool_def_default(), capsule = sphere, box = sphere;
    sphere.radius = 0.3;
    capsule.shape = PEL_TOOL_CAPSULE;
    capsule.radius = 0.1;
    capsule.half_length = 0.4;
    box.shape = PEL_TOOL_BOX;
    box.half_extents[0] = box.half_extents[1] = box.half_extents[2] = 0.2;
    check_press(sphere, 0.3, 5, PEL_METHOD_QUASI_STATIC);
    check_press(sphere, 0.3, 20, PEL_METHOD_QUASI_STATIC);
    check_press(capsule, 0.5, 12, PEL_METHOD_QUASI_STATIC);
    check_press(box, 0.2, 12, PEL_METHOD_QUASI_STATIC);
    check_press(sphere, 0.3, 8, PEL_METHOD_EXPLICIT);
    /* far smaller than a triangle: meets faces, not vertices */
    sphere.radius = 0.03;
    check_press(sphere, 0.03, 3, PEL_METHOD_QUASI_STATIC);
}

/* after settling, the tool's force balances the forces of the volumetric springs on the whole body, and the load on it:
   the structural springs only pass forces on */
static void check_balance(const pel_load_def *load)
{
    const pel_pose_key keys[2] = {{0, {0, 0, 1.4}, {0, 0, 0, 1}, {0}}, {1, {0, 0, 1.1}, {0, 0, 0, 1}, {0}}};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "probe";
    tool.radius = 0.3;
    tool.keys = keys;
    tool.key_count = 2;
    stage s = make_stage_with(10, &tool, 1, PEL_METHOD_QUASI_STATIC, load);
    run_steps(s.sim, 6000);
    pel_tool_reading reading;
    pel_sim_get_tool(s.sim, 0, &reading);
    const pel_body *body = &s.model->bodies[0];
    double sum[3] = {0, 0, 0}, *x = malloc(3 * sizeof *x * (size_t)s.mesh->vertex_count);
    pel_sim_get_positions(s.sim, 0, x);
    for (int32_t v = 0; v < s.mesh->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            sum[c] += (double)s.model->rest[body->model_index[v]][3] * (s.mesh->positions[v][c] - x[3 * v + c]);
    free(x);
    assert_true(reading.force[2] > 0.01);
    for (int c = 0; c < 3; c++)
        assert_near(reading.force[c], sum[c] + (load != NULL ? load->force[c] : 0), 0.01 * reading.force[2]);
    end_stage(&s);
}

static void test_force_balances_at_rest(void **unused)
{
    (void)unused;
    /* all of the load is on the vertices that the tool touches */
    pel_load_def load = pel_load_def_default();
    load.force[2] = 0.4;
    load.vertex_count = 1;
    check_balance(NULL);
    pel_mesh *mesh = make_sphere(10);
    const int32_t top = nearest_vertex(mesh, 0, 0, 1);
    load.vertices = &top;
    check_balance(&load);
    pel_mesh_destroy(mesh);
}

/* what a tool takes from a free body, step by step, is the momentum that the body gains: pressed from the side, so that
   points within triangles and all three axes take part; a grasping tool likewise */
static void test_momentum(void **unused)
{
    (void)unused;
    for (int grasp = 0; grasp < 2; grasp++) {
        const pel_pose_key keys[2] = {{0, {0.75, 0.6, 0.9}, {0, 0, 0, 1}, {0}},
                                      {1, {0.25, 0.2, 0.3}, {0, 0, 0, 1}, {0}}};
        pel_tool_def tool = pel_tool_def_default();
        tool.name = "probe";
        tool.radius = 0.25;
        tool.keys = keys;
        tool.key_count = 2;
        tool.press = grasp == 0;
        tool.grasp = grasp == 1;
        tool.reach = 0.2;
        pel_mesh *mesh = make_sphere(4);
        pel_body_def body = pel_body_def_default();
        body.name = "ball";
        body.mesh = mesh;
        body.mass = 0.3;
        body.volumetric_stiffness.value = body.volumetric_damping.value = body.spring_damping.value = 0;
        pel_model *model = make_model(&body);
        pel_sim_def def = pel_sim_def_default();
        def.model = model;
        def.solver.method = PEL_METHOD_EXPLICIT;
        def.solver.dt = 0.01;
        def.tools = &tool;
        def.tool_count = 1;
        pel_sim *sim = make_sim(&def);
        double *velocities = malloc(3 * sizeof *velocities * (size_t)mesh->vertex_count), taken[3] = {0, 0, 0};
        assert_non_null(velocities);
        for (int n = 0; n < 80; n++) {
            pel_tool_reading reading;
            run_steps(sim, 1);
            pel_sim_get_tool(sim, 0, &reading);
            pel_vec3_along(taken, def.solver.dt, reading.force, taken);
        }
        pel_sim_get_velocities(sim, 0, velocities);
        double momentum[3] = {0, 0, 0};
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            pel_vec3_along(momentum, body.mass, velocities + 3 * v, momentum);
        assert_true(pel_vec3_length(momentum) > 0.5);
        for (int c = 0; c < 3; c++)
            assert_near(momentum[c], -taken[c], sizeof(pel_real) == 8 ? 1e-10 : 1e-3);
        free(velocities);
        pel_sim_destroy(sim);
        pel_model_destroy(model);
        pel_mesh_destroy(mesh);
    }
}

/* a tool held still comes to rest for good, also where the press was lopsided: no contact flips */
static void test_settles(void **unused)
{
    (void)unused;
    const pel_pose_key press_keys[2] = {{0, {0, 0, 1.35}, {0, 0, 0, 1}, {0}}, {0.3, {0, 0, 1.1}, {0, 0, 0, 1}, {0}}};
    const pel_pose_key pull_keys[2] = {{0, {0, -1.2, 0}, {0, 0, 0, 1}, {0}}, {0.6, {0, -1.4, 0}, {0, 0, 0, 1}, {0}}};
    pel_tool_def tools[2] = {pel_tool_def_default(), pel_tool_def_default()};
    tools[0].name = "probe";
    tools[0].radius = 0.3;
    tools[0].keys = press_keys;
    tools[0].key_count = 2;
    tools[1].name = "clamp";
    tools[1].radius = 0.2;
    tools[1].press = false;
    tools[1].grasp = true;
    tools[1].grasp_from = 0.1;
    tools[1].grasp_until = 0.5;
    tools[1].reach = 0.2;
    tools[1].keys = pull_keys;
    tools[1].key_count = 2;
    stage s = make_stage(4, tools, 2, PEL_METHOD_QUASI_STATIC);
    run_steps(s.sim, 1500);
    double still = sizeof(pel_real) == 8 ? 1e-20 : 1e-5;
    for (int n = 0; n < 3000; n++) {
        run_steps(s.sim, 1);
        pel_sim_measures measures;
        pel_sim_measure(s.sim, &measures);
        assert_true(measures.kinetic_energy < still);
        assert_true(measures.contact_count >= 3);
    }
    end_stage(&s);
}

/* grasp at the top, pull up by 0.2, let go: the held vertices follow exactly, the force points down while pulling, and
   the body comes back */
static void check_grasp(pel_method method)
{
    const double turned[4] = {0, 0, sqrt(0.5), sqrt(0.5)};
    pel_pose_key keys[4] = DOWN_UP(1.0, 1.2);
    memcpy(keys[1].rotation, turned, sizeof turned);
    memcpy(keys[2].rotation, turned, sizeof turned);
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "forceps";
    tool.radius = 0.15;
    tool.press = false;
    tool.grasp = true;
    tool.grasp_from = 0.1;
    tool.grasp_until = 2;
    tool.reach = 0.05;
    tool.keys = keys;
    tool.key_count = 4;
    stage s = make_stage(10, &tool, 1, method);
    int32_t pole = nearest_vertex(s.mesh, 0, 0, 1);
    run_steps(s.sim, 150);
    pel_tool_reading reading;
    pel_sim_get_tool(s.sim, 0, &reading);
    assert_true(reading.contact_count > 3);
    assert_true(reading.force[2] < -0.01);
    /* taken at t = 0.1 s, when the tool had risen by 0.02 and turned by 9 degrees */
    double *x = malloc(3 * sizeof *x * (size_t)s.mesh->vertex_count);
    pel_sim_get_positions(s.sim, 0, x);
    const double *p = s.mesh->positions[pole];
    double angle = 0.9 * 1.5707963267948966, tolerance = sizeof(pel_real) == 8 ? 1e-6 : 1e-4;
    assert_near(x[3 * pole + 2] - p[2], 0.18, tolerance);
    assert_near(x[3 * pole], cos(angle) * p[0] - sin(angle) * p[1], tolerance);
    run_steps(s.sim, 1500);
    pel_sim_get_positions(s.sim, 0, x);
    assert_near(x[3 * pole + 2], p[2], 0.02);
    pel_sim_get_tool(s.sim, 0, &reading);
    assert_int_equal(reading.contact_count, 0);
    assert_true(reading.force[2] == 0);
    free(x);
    end_stage(&s);
}

static void test_grasp(void **unused)
{
    (void)unused;
    check_grasp(PEL_METHOD_QUASI_STATIC);
    check_grasp(PEL_METHOD_EXPLICIT);
}

static double depth_told;

static void check_refused(const pel_tool_def *tool, const char *word)
{
    stage s;
    s.mesh = make_sphere(3);
    pel_body_def body = ball_body(s.mesh);
    s.model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = s.model;
    def.tools = tool;
    def.tool_count = 1;
    pel_error error;
    assert_int_equal(pel_sim_create(&def, &s.sim, &error), PEL_BAD_ARGUMENT);
    assert_null(s.sim);
    if (strstr(error.what, word) == NULL)
        print_error("'%s' lacks '%s'\n", error.what, word);
    assert_non_null(strstr(error.what, word));
    assert_true(error.remedy[0] != '\0');
    const char *by = strstr(error.what, "(by ");
    depth_told = by != NULL ? strtod(by + 4, NULL) : -1;
    end_stage(&s);
}

/* a ball that is held as a whole and pulled at a steady speed: the hand feels the damping of all its vertices, by the
   velocity (springs) and by that along the way from rest (volumetric), and the drag of the solver */
static void test_grip_feels_damping(void **unused)
{
    (void)unused;
    const pel_method methods[] = {PEL_METHOD_EXPLICIT, PEL_METHOD_XPBD, PEL_METHOD_PBD};
    const pel_pose_key keys[2] = {{0, {0, 0, 0}, {0, 0, 0, 1}, {0}}, {1, {0.5, 0, 0}, {0, 0, 0, 1}, {0}}};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        pel_mesh *mesh = make_sphere(3);
        pel_body_def body = pel_body_def_default();
        body.name = "ball";
        body.mesh = mesh;
        body.spring_damping.value = 0.4;
        body.volumetric_stiffness.value = 0;
        body.volumetric_damping.value = 0.3;
        pel_model *model = make_model(&body);
        pel_tool_def tool = pel_tool_def_default();
        tool.name = "hand";
        tool.radius = 2;
        tool.press = false;
        tool.grasp = true;
        tool.keys = keys;
        tool.key_count = 2;
        pel_sim_def def = pel_sim_def_default();
        def.model = model;
        def.solver.method = methods[m];
        def.solver.drag = 0.01;
        def.tools = &tool;
        def.tool_count = 1;
        pel_sim *sim = make_sim(&def);
        run_steps(sim, 50);
        pel_tool_reading reading;
        pel_sim_get_tool(sim, 0, &reading);
        double truth = (0.4 + 0.3 + 0.01) * 0.5 * mesh->vertex_count;
        assert_near(reading.force[0], -truth, (sizeof(pel_real) == 8 ? 1e-3 : 1e-2) * truth);
        pel_sim_destroy(sim);
        pel_model_destroy(model);
        pel_mesh_destroy(mesh);
    }
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_pose_key keys[2] = {{0, {0, 0, 0.8}, {0, 0, 0, 1}, {0}}, {1, {0, 0, 2}, {0, 0, 0, 1}, {0}}};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "probe";
    tool.radius = 0.3;
    tool.keys = keys;
    tool.key_count = 2;
    /* the ball's radius is 1, its triangles lie up to 0.1 within: what the tool has to go so that it is out */
    check_refused(&tool, "starts inside");
    assert_near(depth_told, 0.3 + 0.2, 0.12);
    keys[0].position[2] = 0.1;
    check_refused(&tool, "starts inside");
    assert_near(depth_told, 0.3 + 0.9, 0.12);
    tool.shape = PEL_TOOL_BOX;
    pel_vec3_set(tool.half_extents, 0.05, 0.05, 0.2);
    keys[0].position[2] = 0.6;
    check_refused(&tool, "starts inside");
    assert_near(depth_told, 0.2 + 0.4, 0.12);
    tool.shape = PEL_TOOL_SPHERE;
    /* its centre is outside */
    keys[0].position[2] = 1.2;
    check_refused(&tool, "starts inside");
    assert_near(depth_told, 0.1, 0.1);
    keys[0].position[2] = 2;
    tool.radius = 0;
    check_refused(&tool, "radius");
    tool.radius = 0.1;
    keys[1].time = 0;
    check_refused(&tool, "order");
    keys[1].time = 1;
    keys[1].rotation[0] = 2;
    check_refused(&tool, "quaternion");
    keys[1].rotation[0] = 0;
    tool.body = 4;
    check_refused(&tool, "body");
}

/* what the caller sets between steps wins over the keys, and a snapshot keeps it */
static void test_driven_tool(void **unused)
{
    (void)unused;
    const pel_pose_key key = {0, {0, 0, 3}, {0, 0, 0, 1}, {0}};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "stylus";
    tool.radius = 0.2;
    tool.keys = &key;
    tool.key_count = 1;
    stage s = make_stage(6, &tool, 1, PEL_METHOD_QUASI_STATIC);
    const double rotation[4] = {0, 0, 0, 1};
    for (int n = 0; n < 100; n++) {
        const double position[3] = {0, 0, 1.2 - 0.002 * n};
        assert_int_equal(pel_sim_set_tool_pose(s.sim, 0, position, rotation, NULL), PEL_OK);
        run_steps(s.sim, 1);
    }
    pel_tool_reading reading;
    pel_sim_get_tool(s.sim, 0, &reading);
    assert_true(reading.force[2] > 0);
    assert_near(reading.position[2], 1.2 - 0.198, 1e-12);
    const double bad[4] = {1, 1, 0, 0};
    assert_int_equal(pel_sim_set_tool_pose(s.sim, 0, reading.position, bad, NULL), PEL_BAD_ARGUMENT);
    end_stage(&s);
}

/* a snapshot with any word of it overwritten is loaded or refused; nothing outside the arrays is touched afterwards */
static void test_damaged_snapshot(void **unused)
{
    (void)unused;
    const pel_pose_key keys[2] = {{0, {0, 0, 1.4}, {0, 0, 0, 1}, {0}}, {0.5, {0, 0, 1.1}, {0, 0, 0, 1}, {0}}};
    pel_tool_def tools[2] = {pel_tool_def_default(), pel_tool_def_default()};
    for (int t = 0; t < 2; t++) {
        tools[t].name = t == 0 ? "probe" : "clamp";
        tools[t].radius = 0.2;
        tools[t].keys = keys;
        tools[t].key_count = 2;
        tools[t].press = t == 0;
        tools[t].grasp = t == 1;
        tools[t].reach = 0.3;
    }
    stage s = make_stage(3, tools, 2, PEL_METHOD_QUASI_STATIC);
    run_steps(s.sim, 60);
    size_t size = pel_sim_save_size(s.sim);
    unsigned char *good = malloc(size), *bad = malloc(size);
    assert_true(good != NULL && bad != NULL);
    pel_sim_save(s.sim, good);
    uint64_t hash = pel_sim_hash(s.sim);
    int refused = 0;
    const uint32_t words[4] = {UINT32_MAX, INT32_MAX, 0x01010101, 100000};
    for (size_t at = 0; at + 4 <= size; at += ROUNDS(12, 36))
        for (int w = 0; w < 4; w++) {
            pel_error error;
            memcpy(bad, good, size);
            memcpy(bad + at, &words[w], 4);
            pel_snapshot_seal(bad, size);
            pel_status status = pel_sim_load(s.sim, bad, size, &error);
            if (status == PEL_OK)
                continue;
            refused++;
            assert_int_equal(status, PEL_BAD_FORMAT);
            assert_true(error.what[0] != '\0' && error.remedy[0] != '\0');
            /* it may be stepped all the same, if to no good end */
            (void)pel_sim_step(s.sim, NULL);
        }
    assert_true(refused > ROUNDS(30, 5));
    assert_int_equal(pel_sim_load(s.sim, good, size, NULL), PEL_OK);
    assert_true(pel_sim_hash(s.sim) == hash);
    run_steps(s.sim, 20);
    free(good);
    free(bad);
    end_stage(&s);
}

/* numbers out of their ranges in a snapshot with the right checksum are refused, one by one */
static void test_ranges_of_snapshots(void **unused)
{
    (void)unused;
    const pel_pose_key keys[2] = {{.position = {0, 0, 1.5}, .rotation = {0, 0, 0, 1}},
                                  {.time = 0.5, .position = {0, 0, 1.1}, .rotation = {0, 0, 0, 1}}};
    pel_tool_def def = pel_tool_def_default();
    def.shape = PEL_TOOL_SPHERE;
    def.name = "probe";
    def.radius = 0.3;
    def.keys = keys;
    def.key_count = 2;
    stage s = make_stage(3, &def, 1, PEL_METHOD_QUASI_STATIC);
    run_steps(s.sim, 60);
    pel_tool *tool = &s.sim->tools->items[0], kept = *tool;
    size_t size = pel_sim_save_size(s.sim);
    unsigned char *bytes = malloc(size);
    assert_non_null(bytes);
    assert_true(tool->plane_count > 0);
    for (int i = 0; i < 8; i++) {
        pel_contact_plane plane = tool->planes[0];
        tool->plane_count = i == 0 ? PEL_PLANE_LIMIT + 1 : i == 1 ? -1 : kept.plane_count;
        tool->phase = i == 2 ? PEL_GRASP_DONE + 1 : kept.phase;
        tool->stride = i == 3 ? 0 : i == 4 ? 2 : kept.stride;
        tool->held_count = i == 5 ? 1 : kept.held_count;
        tool->planes[0].triangle = i == 6 ? -1 : i == 7 ? s.mesh->triangle_count : plane.triangle;
        pel_sim_save(s.sim, bytes);
        *tool = kept;
        tool->planes[0] = plane;
        if (pel_sim_load(s.sim, bytes, size, NULL) != PEL_BAD_FORMAT)
            fail_msg("number %d is taken", i);
        *tool = kept;
        tool->planes[0] = plane;
    }
    pel_sim_save(s.sim, bytes);
    assert_int_equal(pel_sim_load(s.sim, bytes, size, NULL), PEL_OK);
    free(bytes);
    end_stage(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ranges_of_snapshots),
        cmocka_unit_test(test_press),
        cmocka_unit_test(test_force_balances_at_rest),
        cmocka_unit_test(test_grasp),
        cmocka_unit_test(test_grip_feels_damping),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_driven_tool),
        cmocka_unit_test(test_settles),
        cmocka_unit_test(test_damaged_snapshot),
        cmocka_unit_test(test_momentum),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
