#include "check.h"
#include "failing_malloc.h"

#include "view/triangle_list.h"

#include "pellicle/shape.h"

/* looks along -y from the front, at the origin */
static view_camera make_camera(void)
{
    view_camera camera;
    pel_camera_angle angle = {0, 0, 1};
    view_camera_begin(&camera, &angle, 2, 100, 100);
    for (int i = 0; i < 8; ++i)
        view_camera_see(&camera, (double[]){i & 1 ? 2 : -2, i & 2 ? 2 : -2, i & 4 ? 2 : -2}, 0);
    view_camera_fit(&camera, 1);
    return camera;
}

static pel_mesh *make_tetrahedron(void)
{
    static const double positions[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    static const int32_t triangles[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions[0], 4, triangles[0], 4, &mesh, NULL), PEL_OK);
    return mesh;
}

/* the normal from the corners of a triangle, along the axes of the camera */
static void cross_corners(const view_corner *c, double normal[3])
{
    double u[3], w[3];
    for (int i = 0; i < 3; ++i) {
        u[i] = (double)c[1].position[i] - (double)c[0].position[i];
        w[i] = (double)c[2].position[i] - (double)c[0].position[i];
    }
    for (int i = 0; i < 3; ++i)
        normal[i] = u[(i + 1) % 3] * w[(i + 2) % 3] - u[(i + 2) % 3] * w[(i + 1) % 3];
}

static double dot(const double a[3], const float b[3])
{
    return a[0] * (double)b[0] + a[1] * (double)b[1] + a[2] * (double)b[2];
}

static void test_mesh(void **unused)
{
    (void)unused;
    view_camera camera = make_camera();
    pel_mesh *mesh = make_tetrahedron();
    const double values[4] = {0, 0.25, 0.5, 1};
    for (int flat = 0; flat < 2; ++flat) {
        view_triangle_list soup = {0};
        double sum = 0;
        int seen = 0;
        assert_int_equal(view_triangle_list_add_mesh(&soup, &camera, mesh, values, flat, NULL), PEL_OK);
        assert_int_equal(soup.count, 12);
        for (size_t i = 0; i < soup.count; i += 3) {
            double normal[3];
            cross_corners(&soup.corners[i], normal);
            for (int k = 0; k < 3; ++k) {
                /* outward on both, and along the triangle's own normal when flat */
                double along = dot(normal, soup.corners[i + (size_t)k].normal) /
                               sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
                assert_true(flat ? along > 0.999999 : along > 0.3);
                sum += (double)soup.corners[i + (size_t)k].value;
            }
            /* towards the camera first */
            bool front = dot(normal, (float[]){-soup.corners[i].position[0], -soup.corners[i].position[1],
                                               (float)camera.distance - soup.corners[i].position[2]}) > 0;
            assert_true(!front || (int)i == 3 * seen);
            seen += front;
        }
        assert_true(seen > 0 && seen < 4);
        assert_near(sum, 3 * 1.75, 1e-6);
        view_triangle_list_destroy(&soup);
    }
    pel_mesh_destroy(mesh);
}

/* all corners of a ball lie on it, and its triangles face outward */
static void test_tools(void **unused)
{
    (void)unused;
    view_camera camera = make_camera();
    const double position[3] = {0.1, 0.2, 0.3}, half = sqrt(0.5), rotation[4] = {0, half, 0, half};
    pel_tool_def tools[3] = {pel_tool_def_default(), pel_tool_def_default(), pel_tool_def_default()};
    tools[0].shape = PEL_TOOL_SPHERE;
    tools[1].shape = PEL_TOOL_CAPSULE;
    tools[2].shape = PEL_TOOL_BOX;
    for (int t = 0; t < 3; ++t) {
        tools[t].radius = 0.5;
        tools[t].half_length = 0.7;
        for (int i = 0; i < 3; ++i)
            tools[t].half_extents[i] = 0.2 + 0.1 * i;
        view_triangle_list soup = {0};
        double turned[3], high[3] = {0};
        view_camera_turn(&camera, position, turned);
        assert_int_equal(view_triangle_list_add_tool(&soup, &camera, &tools[t], position, rotation, NULL), PEL_OK);
        for (size_t i = 0; i < soup.count; i += 3) {
            double normal[3], size = 0;
            cross_corners(&soup.corners[i], normal);
            for (int k = 0; k < 3; ++k) {
                size += normal[k] * normal[k];
                high[k] = fmax(high[k], fabs((double)soup.corners[i].position[k] - turned[k]));
            }
            /* triangles at the poles have no area */
            if (size > 1e-16)
                assert_true(dot(normal, soup.corners[i].normal) > 0);
        }
        /* z of the tool is turned to x; from the front x is across, z is up */
        const double across[3] = {0.5, 1.2, 0.4}, up[3] = {0.5, 0.5, 0.2}, deep[3] = {0.5, 0.5, 0.3};
        assert_near(high[0], across[t], 0.003);
        assert_near(high[1], up[t], 0.003);
        assert_near(high[2], deep[t], 0.003);
        view_triangle_list_destroy(&soup);
    }
}

static void test_arrow(void **unused)
{
    (void)unused;
    view_camera camera = make_camera();
    view_triangle_list soup = {0};
    const double tail[3] = {0, 0, 0}, head[3] = {0.6, 0, 0.8};
    assert_int_equal(view_triangle_list_add_arrow(&soup, &camera, tail, tail, 0.02, NULL), PEL_OK);
    assert_int_equal(soup.count, 0);
    assert_int_equal(view_triangle_list_add_arrow(&soup, &camera, tail, head, 0.02, NULL), PEL_OK);
    double longest = 0, widest = 0, turned[3];
    view_camera_turn(&camera, tail, turned);
    for (size_t i = 0; i < soup.count; ++i) {
        double d[3], along;
        for (int k = 0; k < 3; ++k)
            d[k] = (double)soup.corners[i].position[k] - turned[k];
        along = 0.6 * d[0] + 0.8 * d[1];
        longest = fmax(longest, along);
        widest = fmax(widest, sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - along * along));
        assert_true(along > -1e-6);
    }
    assert_near(longest, 1, 1e-6);
    assert_near(widest, 0.0252, 1e-4);
    view_triangle_list_destroy(&soup);
}

static pel_status soup_case(const void *data, pel_error *error)
{
    view_camera camera = make_camera();
    view_triangle_list soup = {0};
    pel_tool_def tool = pel_tool_def_default();
    tool.radius = 1;
    pel_status status = view_triangle_list_add_mesh(&soup, &camera, data, NULL, false, error);
    if (status == PEL_OK)
        status = view_triangle_list_add_tool(&soup, &camera, &tool, (double[3]){0}, (double[]){0, 0, 0, 1}, error);
    view_triangle_list_destroy(&soup);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_tetrahedron();
    assert_true(for_every_allocation_failure(soup_case, mesh) >= 4);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_mesh), cmocka_unit_test(test_tools),
                                       cmocka_unit_test(test_arrow), cmocka_unit_test(test_out_of_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
