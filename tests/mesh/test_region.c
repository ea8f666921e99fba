#include "failing_malloc.h"
#include "sample.h"

#include "pellicle/region.h"

/* the mesh of all these tests: a plate of 11 x 11 vertices, 0.1 m apart, about the origin */
static pel_mesh *plate(void)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    pel_mesh *mesh;
    double values[121];
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    for (int32_t v = 0; v < 121; v++)
        values[v] = mesh->positions[v][0];
    assert_int_equal(pel_mesh_add_field(mesh, "weight", 1, values, NULL), PEL_OK);
    assert_int_equal(pel_mesh_add_field(mesh, "direction", 3, NULL, NULL), PEL_OK);
    return mesh;
}

static pel_selection *select_from(const pel_mesh *mesh, const pel_region *region)
{
    pel_selection *selection;
    pel_error error;
    assert_int_equal(pel_mesh_select(mesh, region, &selection, &error), PEL_OK);
    for (int32_t i = 0; i < selection->count; i++) {
        assert_true(selection->weights[i] > 0 && selection->weights[i] <= 1);
        assert_true(i == 0 || selection->vertices[i] > selection->vertices[i - 1]);
    }
    return selection;
}

static void test_kinds(void **unused)
{
    (void)unused;
    pel_mesh *mesh = plate();
    const int32_t listed[4] = {120, 3, 7, 3};
    pel_region all = pel_region_default(), nearest = all, sphere = all, box = all, vertices = all, field = all,
               boundary = all;
    nearest.kind = PEL_REGION_NEAREST;
    nearest.point[0] = nearest.point[1] = nearest.point[2] = 9;
    sphere.kind = PEL_REGION_SPHERE;
    sphere.radius = 0.101;
    box.kind = PEL_REGION_BOX;
    for (int i = 0; i < 3; i++)
        box.low[i] = -1;
    box.high[1] = -0.35; /* two rows */
    box.high[0] = 1;
    vertices.kind = PEL_REGION_VERTICES;
    vertices.vertices = listed;
    vertices.vertex_count = 4;
    field.kind = PEL_REGION_FIELD;
    field.field = "weight";
    field.above = 0.35;
    boundary.kind = PEL_REGION_BOUNDARY;
    const struct {
        const pel_region *region;
        int32_t count, first, last;
    } cases[] = {{&all, 121, 0, 120},    {&nearest, 1, 120, 120}, {&sphere, 5, 49, 71},   {&box, 22, 0, 21},
                 {&vertices, 3, 3, 120}, {&field, 22, 9, 120},    {&boundary, 40, 0, 120}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pel_selection *selection = select_from(mesh, cases[i].region);
        assert_int_equal(selection->count, cases[i].count);
        assert_int_equal(selection->vertices[0], cases[i].first);
        assert_int_equal(selection->vertices[selection->count - 1], cases[i].last);
        for (int32_t k = 0; k < selection->count; k++)
            assert_true(selection->weights[k] == 1);
        pel_selection_destroy(selection);
    }
    pel_mesh_destroy(mesh);
}

/* the side that the normal points to, with the plane; one of two rings of an open tube */
static void test_planes_and_loops(void **unused)
{
    (void)unused;
    pel_mesh *mesh = plate();
    pel_region plane = pel_region_default(), loop = plane;
    plane.kind = PEL_REGION_PLANE;
    plane.point[0] = mesh->positions[64][0];
    plane.normal[0] = 5;
    pel_selection *selection = select_from(mesh, &plane);
    for (int32_t i = 0; i < selection->count; i++)
        assert_true(mesh->positions[selection->vertices[i]][0] >= plane.point[0]);
    assert_int_equal(selection->count, 22);
    pel_selection_destroy(selection);
    pel_mesh_destroy(mesh);
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    /* without its middle vertex the plate has an inner loop of 8 vertices or fewer */
    int32_t kept = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        if (v[0] != 60 && v[1] != 60 && v[2] != 60)
            memmove(mesh->triangles[kept++], v, sizeof *mesh->triangles);
    }
    mesh->triangle_count = kept;
    loop.kind = PEL_REGION_BOUNDARY;
    loop.loop = 0;
    selection = select_from(mesh, &loop);
    assert_int_equal(selection->count, 40);
    pel_selection_destroy(selection);
    loop.loop = 1;
    selection = select_from(mesh, &loop);
    assert_true(selection->count >= 6 && selection->count <= 8);
    for (int32_t i = 0; i < selection->count; i++)
        assert_true(hypot(mesh->positions[selection->vertices[i]][0], mesh->positions[selection->vertices[i]][1]) <
                    0.15);
    pel_selection_destroy(selection);
    pel_error error;
    loop.loop = 2;
    assert_int_equal(pel_mesh_select(mesh, &loop, &selection, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "no loop 2"));
    pel_mesh_destroy(mesh);
}

/* weight 1 inside, 0.5 in the middle of the falloff, level at both ends */
static void test_falloff(void **unused)
{
    (void)unused;
    pel_mesh *mesh = plate();
    pel_region sphere = pel_region_default(), box = sphere, nearest = sphere;
    sphere.kind = PEL_REGION_SPHERE;
    sphere.radius = 0.1;
    sphere.falloff = 0.4;
    box.kind = PEL_REGION_BOX;
    for (int i = 0; i < 3; i++) {
        box.low[i] = -0.1;
        box.high[i] = 0.1;
    }
    box.falloff = 0.4;
    nearest.kind = PEL_REGION_NEAREST;
    nearest.falloff = 0.4;
    const pel_region *regions[3] = {&sphere, &box, &nearest};
    for (int k = 0; k < 3; k++) {
        pel_selection *selection = select_from(mesh, regions[k]);
        for (int32_t i = 0; i < selection->count; i++) {
            const double *p = mesh->positions[selection->vertices[i]];
            double beyond = k == 0   ? hypot(p[0], p[1]) - 0.1
                            : k == 1 ? hypot(fmax(fabs(p[0]) - 0.1, 0), fmax(fabs(p[1]) - 0.1, 0))
                                     : hypot(p[0], p[1]);
            double s = fmax(beyond, 0) / 0.4;
            assert_near(selection->weights[i], 1 - s * s * (3 - 2 * s), 1e-12);
        }
        pel_selection_destroy(selection);
    }
    /* the middle row: x = 0, 0.1, 0.2, 0.3, 0.4, 0.5 */
    const double expected[6] = {1, 1, 0.84375, 0.5, 0.15625, 0};
    pel_selection *selection = select_from(mesh, &sphere);
    for (int32_t i = 0; i < selection->count; i++) {
        int32_t column = selection->vertices[i] - 60;
        if (column >= 0 && column < 6)
            assert_near(selection->weights[i], expected[column], 1e-12);
        assert_int_not_equal(selection->vertices[i], 65);
    }
    pel_selection_destroy(selection);
    pel_mesh_destroy(mesh);
}

static void test_empty_regions(void **unused)
{
    (void)unused;
    pel_mesh *mesh = plate();
    pel_selection *selection;
    pel_error error;
    pel_region region = pel_region_default();
    region.kind = PEL_REGION_SPHERE;
    region.center[2] = 2;
    region.radius = 0.5;
    assert_int_equal(pel_mesh_select(mesh, &region, &selection, &error), PEL_BAD_ARGUMENT);
    assert_null(selection);
    assert_int_equal(error.element, 60);
    assert_non_null(strstr(error.what, "1.5 m"));
    region.kind = PEL_REGION_BOX;
    for (int i = 0; i < 3; i++) {
        region.low[i] = 0.75;
        region.high[i] = 1;
    }
    region.low[2] = -1;
    assert_int_equal(pel_mesh_select(mesh, &region, &selection, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(error.element, 120);
    assert_non_null(strstr(error.what, "0.353553 m"));
    region.kind = PEL_REGION_FIELD;
    region.field = "weight";
    assert_int_equal(pel_mesh_select(mesh, &region, &selection, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.remedy, "0.5"));
    region.kind = PEL_REGION_VERTICES;
    assert_int_equal(pel_mesh_select(mesh, &region, &selection, &error), PEL_BAD_ARGUMENT);
    pel_mesh_destroy(mesh);
    /* a closed mesh */
    pel_shape_def ball = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    assert_int_equal(pel_shape_create(&ball, &mesh, NULL), PEL_OK);
    region = pel_region_default();
    region.kind = PEL_REGION_BOUNDARY;
    assert_int_equal(pel_mesh_select(mesh, &region, &selection, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "no boundary"));
    mesh->triangles[3][1] = 999;
    assert_int_equal(pel_mesh_select(mesh, &region, &selection, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(error.element, 3);
    pel_mesh_destroy(mesh);
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_mesh *mesh = plate();
    const int32_t beyond = 121;
    const double nan = (double)NAN;
    const pel_region fine = pel_region_default();
    pel_region wrong[15];
    for (int i = 0; i < 15; i++)
        wrong[i] = fine;
    wrong[13].kind = wrong[14].kind = PEL_REGION_PLANE;
    wrong[14].normal[2] = 1;
    wrong[14].point[2] = nan;
    wrong[0].cookie = 0;
    wrong[1].kind = (pel_region_kind)99;
    wrong[2].falloff = 1;
    wrong[3].falloff = nan;
    wrong[4].kind = PEL_REGION_NEAREST;
    wrong[4].point[1] = nan;
    wrong[5].kind = wrong[6].kind = PEL_REGION_SPHERE;
    wrong[5].radius = -1;
    wrong[6].center[0] = nan;
    wrong[7].kind = PEL_REGION_BOX;
    wrong[7].low[2] = 1;
    wrong[8].kind = PEL_REGION_VERTICES;
    wrong[8].vertices = &beyond;
    wrong[8].vertex_count = 1;
    for (int i = 9; i < 13; i++)
        wrong[i].kind = PEL_REGION_FIELD;
    wrong[10].field = "wieght";
    wrong[11].field = "direction";
    wrong[12].field = "weight";
    wrong[12].above = nan;
    for (int i = 0; i < 15; i++) {
        pel_selection *selection;
        pel_error error;
        assert_int_equal(pel_mesh_select(mesh, &wrong[i], &selection, &error), PEL_BAD_ARGUMENT);
        assert_null(selection);
        assert_true(strlen(error.what) > 0 && strlen(error.remedy) > 0);
        if (i == 10)
            assert_string_equal(error.remedy, "did you mean 'weight'?");
    }
    pel_mesh_destroy(mesh);
    pel_selection_destroy(NULL);
}

static pel_status select_case(const void *mesh, pel_error *error)
{
    pel_region region = pel_region_default();
    region.kind = PEL_REGION_BOUNDARY;
    region.loop = 0;
    pel_selection *selection;
    pel_status status = pel_mesh_select(mesh, &region, &selection, error);
    if (status != PEL_OK)
        assert_null(selection);
    pel_selection_destroy(selection);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    pel_mesh *mesh = plate();
    assert_true(for_every_allocation_failure(select_case, mesh) >= 6);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kinds),    cmocka_unit_test(test_planes_and_loops),
        cmocka_unit_test(test_falloff),  cmocka_unit_test(test_empty_regions),
        cmocka_unit_test(test_refusals), cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
