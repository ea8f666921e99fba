/* Motion of tools on their keys: angles as written, poses in between, velocities, catching up; what meshes grasp. */
#include "sim/fixture.h"
#include "tool/pose.h"

static const double pi = 3.14159265358979323846;

/* a key without quaternion: axis (need not be a unit vector) and degrees */
static pel_pose_key key_of(double time, double x, double y, double z, double degrees)
{
    pel_pose_key key = {time, {0}, {0, 0, 0, 1}, {x, y, z}};
    double length = pel_vec3_length(key.rotation_vector);
    pel_vec3_scale(key.rotation_vector, length > 0 ? degrees * pi / 180 / length : 0, key.rotation_vector);
    return key;
}

/* where the keys take the point (1, 2, 3) of a tool */
static void point_at(const pel_pose_key *keys, int32_t count, double time, double point[3])
{
    pel_tool_def def = pel_tool_def_default();
    double position[3], rotation[4];
    def.keys = keys;
    def.key_count = count;
    pel_tool_def_pose(&def, time, position, rotation);
    pel_rotate(rotation, (double[3]){1, 2, 3}, point);
    pel_vec3_add(point, position, point);
}

static void expect_turn(const double point[3], const double axis[3], double degrees)
{
    double vector[3], q[4], expected[3];
    pel_vec3_scale(axis, degrees * pi / 180 / pel_vec3_length(axis), vector);
    pel_rotation_exp(vector, q);
    pel_rotate(q, (double[3]){1, 2, 3}, expected);
    assert_near(pel_vec3_distance(point, expected), 0, 1e-12);
}

/* about one axis, written in either sense, the angle goes linearly from one number to the next */
static void test_angles_as_written(void **unused)
{
    (void)unused;
    static const double pairs[][2] = {{0, 360},    {0, 720},     {0, 190},  {-90, 270}, {300, 420}, {350, 10},
                                      {179, -179}, {-720, 3600}, {90, 450}, {360, 360}, {0, -360},  {10, 10 + 1e-9}};
    static const double axes[][3] = {{0, 0, 1}, {1, -2, 0.5}};
    for (size_t p = 0; p < sizeof pairs / sizeof *pairs; p++)
        for (size_t a = 0; a < 2; a++)
            for (int i = 0; i <= 20; i++) {
                const double *axis = axes[a], *angle = pairs[p], s = i / 20.0;
                double point[3];
                const pel_pose_key keys[2] = {key_of(1, axis[0], axis[1], axis[2], angle[0]),
                                              key_of(3, -axis[0], -axis[1], -axis[2], -angle[1])};
                point_at(keys, 2, 1 + 2 * s, point);
                expect_turn(point, axis, angle[0] + s * (angle[1] - angle[0]));
            }
}

/* quaternions take the shorter arc; so do rotation vectors about different axes, whose whole turns are made as well */
static void test_different_axes(void **unused)
{
    (void)unused;
    double point[3];
    pel_pose_key arc[2] = {key_of(0, 0, 0, 1, 0), key_of(1, 0, 0, 1, 0)};
    arc[1].rotation[2] = sin(100 * pi / 180), arc[1].rotation[3] = cos(100 * pi / 180);
    point_at(arc, 2, 0.25, point);
    expect_turn(point, (double[3]){0, 0, 1}, -40);
    const pel_pose_key quarter[2] = {key_of(0, 1, 0, 0, 90), key_of(1, 0, 1, 0, 90)};
    const pel_pose_key more[2] = {key_of(0, 1, 0, 0, 90), key_of(1, 0, 1, 0, 450)};
    double last[3], path[2] = {0, 0};
    for (int k = 0; k < 2; k++)
        for (int i = 0; i <= 1000; i++) {
            pel_vec3_copy(point, last);
            point_at(k == 0 ? quarter : more, 2, i / 1000.0, point);
            path[k] += i > 0 ? pel_vec3_distance(point, last) : 0;
        }
    /* the great arc is one of 120 degrees about (-1, 1, 1) */
    double axis[3] = {-1, 1, 1}, arm[3];
    pel_vec3_scale(axis, 1 / sqrt(3.0), axis);
    double start[3];
    point_at(quarter, 2, 0, start);
    pel_vec3_along(start, -pel_vec3_dot(start, axis), axis, arm);
    assert_near(path[0], 2 * pi / 3 * pel_vec3_length(arm), 1e-5);
    assert_true(path[1] > path[0] + 6);
    point_at(more, 2, 1, point);
    expect_turn(point, (double[3]){0, 1, 0}, 90);
    point_at(more, 2, 0, point);
    expect_turn(point, (double[3]){1, 0, 0}, 90);
}

static stage make_stage(const pel_tool_def *tool, double dt)
{
    stage s = {.mesh = make_sphere(2)};
    pel_body_def body = ball_body(s.mesh);
    s.model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = s.model;
    def.tools = tool;
    def.tool_count = 1;
    def.solver.method = PEL_METHOD_EXPLICIT;
    def.solver.dt = dt;
    def.contact.enabled = tool->shape == PEL_TOOL_MESH;
    pel_error error;
    if (pel_sim_create(&def, &s.sim, &error) != PEL_OK)
        print_error("%s\n", error.what);
    assert_non_null(s.sim);
    return s;
}

/* a tool that holds the ball: velocities of what it holds are w x r, at half a turn a step as well */
static void test_velocity(void **unused)
{
    (void)unused;
    const pel_pose_key keys[2] = {key_of(0, 0, 0, 1, 0), key_of(1, 0, 0, 1, 36000)};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "grip";
    tool.radius = 1;
    tool.press = false;
    tool.grasp = true;
    tool.reach = 0.1;
    tool.keys = keys;
    tool.key_count = 2;
    stage s = make_stage(&tool, 0.005);
    run_steps(s.sim, 3);
    const double omega[3] = {0, 0, 200 * pi};
    for (int32_t i = 0; i < s.sim->tools->items[0].held_count; i++) {
        double x[3], v[3], expected[3];
        pel_vertex_position(s.sim->state->position, s.sim->tools->items[0].held[i], x);
        pel_vertex_position(s.sim->state->velocity, s.sim->tools->items[0].held[i], v);
        pel_vec3_cross(omega, x, expected);
        assert_near(pel_vec3_distance(v, expected), 0, sizeof(pel_real) == 4 ? 1e-2 : 1e-8);
    }
    assert_int_equal(s.sim->tools->items[0].held_count, s.mesh->vertex_count);
    end_stage(&s);
}

/* poses between two of a tool go by the turns it has made, and the way counts them; one that was held back comes after
   in the same sense */
static void test_held_back(void **unused)
{
    (void)unused;
    const pel_pose_key keys[3] = {key_of(0, 0, 0, 1, 0), key_of(1, 0, 0, 1, 360), key_of(2, 0, 0, 1, 900)};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "rotor";
    tool.radius = 0.5;
    tool.press = false;
    tool.keys = keys;
    tool.key_count = 3;
    stage s = make_stage(&tool, 0.001);
    pel_tool *own = &s.sim->tools->items[0];
    pel_pose from = pel_tool_pose_at(own, 0.25), to = pel_tool_pose_at(own, 1.5), middle;
    assert_near(pel_tool_way(own, &from, &to), 540 * pi / 180 * 1.5, 1e-9);
    pel_pose_between(&from, &to, 0.5, &middle);
    double x[3];
    pel_rotate(middle.rotation, (double[3]){1, 2, 3}, x);
    expect_turn(x, (double[3]){0, 0, 1}, 360);
    pel_pose_between(&middle, &to, 0.25, &middle);
    pel_rotate(middle.rotation, (double[3]){1, 2, 3}, x);
    expect_turn(x, (double[3]){0, 0, 1}, 360 + 270.0 / 4);
    /* at 1.5 s it lags 230 degrees behind: it follows forwards, by an eighth a step */
    own->blocked = true;
    own->pose = pel_tool_pose_at(own, 1.5 - 230 / 540.0);
    middle = pel_tool_next_pose(s.sim, own, 1.5);
    pel_rotate(middle.rotation, (double[3]){1, 2, 3}, x);
    expect_turn(x, (double[3]){0, 0, 1}, 630 - 230 * 7 / 8.0);
    end_stage(&s);
}

/* a pose that the caller sets is reached by the shorter arc, whatever turns the keys made before */
static void test_set_pose(void **unused)
{
    (void)unused;
    const pel_pose_key keys[2] = {key_of(0, 0, 0, 1, 0), key_of(0.1, 0, 0, 1, 3600)};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "stylus";
    tool.radius = 0.5;
    tool.press = false;
    tool.keys = keys;
    tool.key_count = 2;
    stage s = make_stage(&tool, 0.001);
    run_steps(s.sim, 100);
    const double rotation[4] = {0, 0, sin(pi / 6), cos(pi / 6)};
    assert_int_equal(pel_sim_set_tool_pose(s.sim, 0, (double[3]){0}, rotation, NULL), PEL_OK);
    pel_pose wanted = pel_tool_pose_at(&s.sim->tools->items[0], 1), half;
    assert_near(pel_tool_way(&s.sim->tools->items[0], &s.sim->tools->items[0].pose, &wanted), pi / 3 * 1.5, 1e-9);
    pel_pose_between(&s.sim->tools->items[0].pose, &wanted, 0.5, &half);
    double x[3];
    pel_rotate(half.rotation, (double[3]){1, 2, 3}, x);
    expect_turn(x, (double[3]){0, 0, 1}, 30);
    end_stage(&s);
}

/* a box of 12 triangles */
static pel_mesh *make_box(const double half[3])
{
    static const int32_t triangles[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                             {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    double positions[8][3];
    for (int v = 0; v < 8; v++)
        for (int k = 0; k < 3; k++)
            positions[v][k] = (v >> k & 1) != 0 ? half[k] : -half[k];
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions[0], 8, triangles[0], 12, &mesh, NULL), PEL_OK);
    return mesh;
}

/* which vertices a tool holds after a step, into flags; returns how many */
static int32_t hold(const pel_tool_def *def, uint8_t *flags)
{
    stage s = make_stage(def, 0.01);
    run_steps(s.sim, 1);
    const pel_tool *tool = &s.sim->tools->items[0];
    memset(flags, 0, 64);
    for (int32_t i = 0; i < tool->held_count; i++)
        flags[s.sim->model->mesh_vertex[tool->held[i]]] = 1;
    int32_t count = tool->held_count;
    assert_true(s.mesh->vertex_count <= 64);
    end_stage(&s);
    return count;
}

/* a mesh holds what the same solid holds: what is inside it, and what is within reach */
static void test_mesh_grasps_as_solid(void **unused)
{
    (void)unused;
    uint8_t of_solid[64], of_mesh[64];
    const pel_pose_key key = {0, {0.3, 0.1, 0.4}, {0, 0, 0, 1}, {0.3, 0.2, 0.1}};
    for (int kind = 0; kind < 2; kind++)
        for (int r = 0; r < 3; r++) {
            pel_tool_def tool = pel_tool_def_default();
            tool.name = "grip";
            tool.shape = kind == 0 ? PEL_TOOL_SPHERE : PEL_TOOL_BOX;
            tool.radius = 0.9;
            pel_vec3_set(tool.half_extents, 0.8, 0.7, 0.9);
            tool.press = false;
            tool.grasp = true;
            tool.reach = 0.15 * r;
            tool.keys = &key;
            tool.key_count = 1;
            int32_t count = hold(&tool, of_solid);
            assert_in_range(count, 5, 40);
            pel_mesh *mesh = kind == 0 ? make_sphere(24) : make_box(tool.half_extents);
            for (int32_t v = 0; kind == 0 && v < mesh->vertex_count; v++)
                pel_vec3_scale(mesh->positions[v], tool.radius, mesh->positions[v]);
            tool.shape = PEL_TOOL_MESH;
            tool.mesh = mesh;
            assert_int_equal(hold(&tool, of_mesh), count);
            assert_memory_equal(of_mesh, of_solid, sizeof of_mesh);
            pel_mesh_destroy(mesh);
        }
}

/* what lags a little behind goes at twice the speed of its keys, what lags far behind by an eighth of that */
static void test_speed_of_catching_up(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(2);
    pel_body_def body = ball_body(mesh);
    const pel_pose_key keys[2] = {key_of(0, 0, 0, 1, 0), key_of(10, 0, 0, 1, 0)};
    pel_pose_key moved[2] = {keys[0], keys[1]};
    pel_tool_def def = pel_tool_def_default();
    moved[0].position[0] = 5;
    moved[1].position[0] = 15;
    def.name = "late";
    def.radius = 0.1;
    def.keys = moved;
    def.key_count = 2;
    pel_sim_def sim_def = pel_sim_def_default();
    sim_def.model = make_model(&body);
    sim_def.solver.dt = 0.01;
    sim_def.tools = &def;
    sim_def.tool_count = 1;
    pel_sim *sim = make_sim(&sim_def);
    pel_tool *tool = &sim->tools->items[0];
    const double lags[3] = {0.05, 0.005, 1}, strides[3] = {0.02, 0.005, 0.125};
    for (int i = 0; i < 3; i++) {
        tool->blocked = true;
        tool->pose = pel_tool_pose_at(tool, 2);
        tool->pose.position[0] -= lags[i];
        pel_pose next = pel_tool_next_pose(sim, tool, 2);
        assert_near(next.position[0] - tool->pose.position[0], strides[i], 1e-9);
    }
    pel_sim_destroy(sim);
    pel_model_destroy((pel_model *)(uintptr_t)sim_def.model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_angles_as_written),
        cmocka_unit_test(test_different_axes),
        cmocka_unit_test(test_velocity),
        cmocka_unit_test(test_held_back),
        cmocka_unit_test(test_set_pose),
        cmocka_unit_test(test_mesh_grasps_as_solid),
        cmocka_unit_test(test_speed_of_catching_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
