/* Tools that start inside a body: the way out that the error tells, for every shape. */
#include "math/extremes.h"
#include "math/vec3.h"
#include "pellicle/shape.h"
#include "sim/contact_scene.h"
#include "stage/stage.h"

/* the way that the error tells; -1 when the tool may start */
static double way_told(contact_scene *scene)
{
    pel_sim *sim;
    pel_error error;
    if (pel_sim_create(&scene->def, &sim, &error) == PEL_OK) {
        pel_sim_destroy(sim);
        return -1;
    }
    assert_non_null(strstr(error.what, "starts inside body 'first' (by "));
    assert_non_null(strstr(error.remedy, "by at least that much"));
    return strtod(strstr(error.what, "(by ") + 4, NULL);
}

static pel_mesh *make_box_mesh(double half)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_CYLINDER);
    def.radius = half;
    def.height = 2 * half;
    def.capped = true;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

/* a tenth less than that way is too little, a little more is enough */
static void check_way(contact_scene *scene, double x, double y, double z, double expected, const double direction[3])
{
    scene_move(scene, 0, x, y, z, z, 1);
    double way = way_told(scene), share = 0.9;
    assert_near(way, expected, 6e-3 * expected + 1e-4);
    for (int k = 0; k < 2; k++, share += 0.15) {
        scene_move(scene, 0, x + share * way * direction[0], y + share * way * direction[1],
                   z + share * way * direction[2], z + share * way * direction[2], 1);
        assert_true((way_told(scene) < 0) == (k == 1));
    }
}

/* the top of a large block is at z = 1 */
static void test_block(void **unused)
{
    (void)unused;
    static const double up[3] = {0, 0, 1};
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_QUASI_STATIC);
    scene_body(&scene, make_box_mesh(1));
    pel_tool_def *tool = scene_tool(&scene, PEL_TOOL_CAPSULE);
    tool->radius = 0.05;
    tool->half_length = 0.3;
    scene_move(&scene, 0, 0, 0, 3, 3, 1);
    pel_sim *sim = scene_create(&scene);
    /* upright: the tip, the axis, and all of it */
    check_way(&scene, 0, 0, 1.33, 0.02, up);
    check_way(&scene, 0, 0, 1.15, 0.2, up);
    check_way(&scene, 0, 0, 0.9, 0.45, up);
    tool->shape = PEL_TOOL_SPHERE;
    tool->radius = 0.3;
    check_way(&scene, 0, 0, 1.2, 0.1, up);
    check_way(&scene, 0, 0, 0.8, 0.5, up);
    tool->shape = PEL_TOOL_BOX;
    pel_vec3_set(tool->half_extents, 0.1, 0.1, 0.2);
    check_way(&scene, 0, 0, 1.1, 0.1, up);
    check_way(&scene, 0, 0, 0.7, 0.5, up);
    tool->shape = PEL_TOOL_MESH;
    tool->mesh = scene.tool_mesh = make_box_mesh(0.2);
    check_way(&scene, 0, 0, 1.1, 0.1, up);
    check_way(&scene, 0, 0, 0.7, 0.5, up);
    scene_end(&scene, sim);
}

/* the way out goes along the nearest face, also where that is along no axis */
static void test_tilted_block(void **unused)
{
    (void)unused;
    const double angle = 0.6, out[3] = {0, -sin(angle), cos(angle)};
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_QUASI_STATIC);
    pel_mesh *block = make_box_mesh(1);
    pel_transform transform = pel_transform_default();
    transform.rotation[0] = sin(0.5 * angle);
    transform.rotation[3] = cos(0.5 * angle);
    assert_int_equal(pel_mesh_transform(block, &transform, NULL), PEL_OK);
    scene_body(&scene, block);
    pel_tool_def *tool = scene_tool(&scene, PEL_TOOL_SPHERE);
    tool->radius = 0.3;
    scene_move(&scene, 0, 0, 0, 3, 3, 1);
    pel_sim *sim = scene_create(&scene);
    /* the middle outside and inside */
    check_way(&scene, 0, 1.2 * out[1], 1.2 * out[2], 0.1, out);
    check_way(&scene, 0, 0.8 * out[1], 0.8 * out[2], 0.5, out);
    scene_end(&scene, sim);
}

/* a capsule through a sheet goes out the shorter way along its axis */
static void test_sheet(void **unused)
{
    (void)unused;
    static const double up[3] = {0, 0, 1};
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_QUASI_STATIC);
    scene_body(&scene, make_shape(PEL_SHAPE_GRID));
    pel_tool_def *tool = scene_tool(&scene, PEL_TOOL_CAPSULE);
    tool->radius = 0.02;
    tool->half_length = 0.1;
    scene_move(&scene, 0, 0, 0, 3, 3, 1);
    pel_sim *sim = scene_create(&scene);
    check_way(&scene, 0.03, 0.01, 0.05, 0.07, up);
    scene_end(&scene, sim);
}

static void begin_bag(contact_scene *scene, bool is_filled, bool is_mesh)
{
    scene_begin(scene, PEL_METHOD_XPBD);
    scene_body(scene, make_sphere(6));
    pel_body_def *body = &scene->bodies[0];
    body->shell.membrane.on = true;
    body->shell.membrane.young.value = 1e4;
    body->shell.membrane.thickness.value = 0.01;
    body->spring_stiffness.value = 0;
    body->volumetric_stiffness.value = is_filled;
    pel_tool_def *tool = scene_tool(scene, is_mesh ? PEL_TOOL_MESH : PEL_TOOL_SPHERE);
    tool->radius = 0.3;
    tool->mesh = is_mesh ? (scene->tool_mesh = make_box_mesh(0.2)) : NULL;
    scene->def.contact.enabled = is_mesh;
    scene_move(scene, 0, 0, 0, 3, 3, 1);
}

/* a tool in a bag is its content and carries it along; one that cuts the wall, or is in a filled body, is refused */
static void test_content(void **unused)
{
    (void)unused;
    static const double right[3] = {1, 0, 0};
    for (int i = 0; i < 4; i++) {
        bool is_filled = i % 2 == 1, is_mesh = i / 2 == 1;
        contact_scene scene;
        begin_bag(&scene, is_filled, is_mesh);
        pel_sim *sim = scene_create(&scene);
        if (!is_filled && !is_mesh)
            check_way(&scene, 0.9, 0, 0, 0.4, right);
        scene_move(&scene, 0, 0, 0, 0, 1.5, 0.5);
        assert_true((way_told(&scene) < 0) == !is_filled);
        pel_sim_destroy(sim);
        if (is_filled) {
            scene_end(&scene, NULL);
            continue;
        }
        sim = make_sim(&scene.def);
        run_steps(sim, 60);
        double x[362][3], top = 0;
        int32_t count = pel_sim_vertex_count(sim, 0);
        assert_int_equal(count, 362);
        pel_sim_get_positions(sim, 0, x[0]);
        for (int32_t v = 0; v < count; v++)
            top = pel_max(top, x[v][2]);
        /* the top of the tool is at 1.8, or at 1.7 */
        assert_true(top > 1.65);
        scene_end(&scene, sim);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_block), cmocka_unit_test(test_tilted_block),
                                       cmocka_unit_test(test_sheet), cmocka_unit_test(test_content)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
