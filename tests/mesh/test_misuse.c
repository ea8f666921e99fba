#include "misuse.h"

#include <pellicle/bending.h>
#include <pellicle/collide.h>
#include <pellicle/element.h>
#include <pellicle/intersect.h>
#include <pellicle/json.h>
#include <pellicle/measure.h>
#include <pellicle/mesh_check.h>
#include <pellicle/mesh_io.h>
#include <pellicle/parallel.h>
#include <pellicle/preset.h>
#include <pellicle/region.h>
#include <pellicle/results.h>
#include <pellicle/shape.h>
#include <pellicle/shell.h>
#include <pellicle/subdivide.h>
#include <pellicle/topology.h>
#include <pellicle/volume.h>

#include <math.h>

static const double nan_value = (double)NAN, zero3[3], zero43[4][3], zero33[3][3];

static pel_mesh *mesh;
static pel_topology *topology;

static int set_up(void **unused)
{
    (void)unused;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    shape.frequency = 2;
    bool made = pel_shape_create(&shape, &mesh, NULL) == PEL_OK && pel_topology_create(mesh, &topology, NULL) == PEL_OK;
    return made ? 0 : -1;
}

static int tear_down(void **unused)
{
    (void)unused;
    pel_topology_destroy(topology);
    pel_mesh_destroy(mesh);
    return 0;
}

/* all cases of this test were refused; the next one counts anew */
static void finish(void)
{
    int failures = misuse_failures;
    misuse_failures = 0;
    assert_int_equal(failures, 0);
}

/* ---- pure functions: numbers out of range, enums that do not exist ---- */

static void test_numbers(void **unused)
{
    (void)unused;
    char text[64];
    double out[16], gradient4[4][3], gradient3[3][3], nan43[4][3], nan33[3][3], flat[6] = {0};
    for (int i = 0; i < 12; i++)
        nan43[i / 3][i % 3] = nan33[(i / 3) % 3][i % 3] = nan_value;
    const double(*bad4)[3] = (const double(*)[3])nan43, (*bad3)[3] = (const double(*)[3])nan33;
    const double *nan3 = nan43[0];
    GIVES(strlen(pel_status_text((pel_status)-1)) > 0 && strlen(pel_status_text((pel_status)1000)) > 0);
    SURVIVES(pel_error_text(&(pel_error){.what = "x"}, NULL, 0));
    SURVIVES(pel_error_text(&(pel_error){.what = "x"}, text, 1));
    GIVES(pel_nearest_name(NULL, NULL, 3) == NULL);
    GIVES(pel_nearest_name("x", NULL, 3) == NULL);
    SURVIVES(pel_bending_stiffness(nan_value, 1, -1));
    pel_bending_isometric stencil;
    pel_hinge hinge;
    GIVES(!pel_bending_isometric_setup(zero43, &stencil));
    SURVIVES(pel_bending_isometric_setup(bad4, &stencil));
    memset(&stencil, 0, sizeof stencil);
    SURVIVES(pel_bending_isometric_energy(&stencil, (pel_bending_form)77, bad4, gradient4));
    SURVIVES(pel_dihedral_angle(bad4, NULL));
    GIVES(!pel_hinge_setup(zero43, &hinge));
    memset(&hinge, 0, sizeof hinge);
    SURVIVES(pel_hinge_energy(&hinge, bad4, gradient4));
    pel_rest_triangle triangle = {.area = 0};
    GIVES(!pel_rest_triangle_setup(zero33, &triangle));
    GIVES(!pel_rest_triangle_direction(zero33, zero3, out));
    SURVIVES(pel_deformation_gradient(&triangle, bad3, out));
    SURVIVES(pel_stress_gradient(&triangle, flat, gradient3));
    const pel_membrane_material odd = {.kind = (pel_membrane_kind)99, .young = nan_value};
    SURVIVES(pel_membrane_energy(&triangle, &odd, bad3, gradient3));
    SURVIVES(pel_fibre_energy(&triangle, (pel_fibre_kind)-7, nan_value, flat, bad3, gradient3));
    SURVIVES(pel_fibre_active_energy(&triangle, nan_value, -1, flat, bad3, gradient3));
    SURVIVES(pel_triangle_volume(bad3, NULL));
    SURVIVES(pel_triangle_pressure_force(bad3, nan_value, out));
    GIVES(pel_membrane_kind_name((pel_membrane_kind)-1) == NULL ||
          strlen(pel_membrane_kind_name((pel_membrane_kind)-1)));
    SURVIVES(pel_membrane_kind_name((pel_membrane_kind)1000));
    REFUSED("material", pel_membrane_material_check(NULL, &error));
    FAILS(pel_membrane_material_check(&odd, &error));
    SURVIVES(pel_plane_stress_lame(nan_value, 1, 0, &out[0], &out[1]));
    SURVIVES(pel_membrane_density(&odd, flat, out));
    SURVIVES(pel_fibre_density((pel_fibre_kind)55, 1, flat, flat, out));
    SURVIVES(pel_fibre_active_density(1, nan_value, flat, flat, out));
    SURVIVES(pel_closest_point_segment(nan3, zero3, zero3, out));
    SURVIVES(pel_closest_point_triangle(nan3, zero3, zero3, zero3, out));
    SURVIVES(pel_closest_segment_segment(zero3, zero3, zero3, nan3, out));
    SURVIVES(pel_closest_segment_triangle(zero3, zero3, zero3, zero3, nan3, out));
    pel_ccd_hit hit;
    SURVIVES(pel_ccd_vertex_face(bad4, bad4, nan_value, nan_value, &hit));
    SURVIVES(pel_ccd_vertex_face(zero43, zero43, 0, 0, NULL));
    SURVIVES(pel_ccd_edge_edge(bad4, zero43, -1, -1, &hit));
    SURVIVES(pel_ccd_filter(bad4, bad4, true, nan_value));
    SURVIVES(pel_ccd_bridson(bad4, bad4, false, nan_value, nan_value, &hit));
    const pel_ccd_batch nothing = {.query_count = 0}, negative = {.query_count = -5};
    GIVES(pel_ccd_filter_batch(&nothing, NULL) == 0);
    GIVES(pel_ccd_filter_batch(&negative, NULL) == 0);
    GIVES(pel_ccd_solve_batch(&nothing, NULL, NULL, NULL) == 0);
    GIVES(pel_ccd_solve_batch(&negative, NULL, NULL, NULL) == 0);
    SURVIVES(pel_orient2d(nan3, zero3, zero3));
    SURVIVES(pel_orient3d(nan3, zero3, zero3, zero3));
    SURVIVES(pel_triangles_intersect(bad3, zero33));
    SURVIVES(pel_triangles_intersect_beyond(bad3, zero33, 99));
    SURVIVES(pel_triangles_intersect_beyond(zero33, zero33, -99));
    GIVES(pel_thread_limit() >= 1);
    finish();
}

/* ---- errors and logs ---- */

static void test_errors(void **unused)
{
    (void)unused;
    pel_error error;
    GIVES(pel_fail(NULL, PEL_BAD_ARGUMENT, "x") == PEL_BAD_ARGUMENT);
    GIVES(pel_fail_memory(NULL) == PEL_OUT_OF_MEMORY);
    GIVES(pel_refuse(NULL, PEL_BAD_MESH, "", "%d", 1) == PEL_BAD_MESH);
    GIVES(pel_refuse_element(NULL, PEL_BAD_MESH, "load", -1, "", "%d", 1) == PEL_BAD_MESH);
    GIVES(pel_seconds() <= pel_seconds() && pel_thread_seconds() >= 0);
    SURVIVES(pel_fail_remedy(NULL, "x"));
    SURVIVES(pel_fail_element(NULL, "vertex", 1));
    SURVIVES(pel_fail_element(&error, NULL, -1));
    SURVIVES(pel_fail_place(NULL, "x", 1, 1));
    SURVIVES(pel_fail_place(&error, NULL, -1, -1));
    SURVIVES(pel_fail_offset(NULL, "x", -1));
    SURVIVES(pel_fail_offset(&error, NULL, -1));
    SURVIVES(pel_log_line(NULL, "x"));
    SURVIVES(pel_log_line(&(pel_log){.write = NULL}, "x"));
    finish();
}

/* ---- JSON ---- */

static void test_json(void **unused)
{
    (void)unused;
    pel_json json = {.style = (pel_json_style)77};
    SURVIVES(pel_json_close(&json, '}'));
    SURVIVES(pel_json_open(&json, "\xff", 'x'));
    SURVIVES(pel_json_text(&json, NULL, "\xff"));
    SURVIVES(pel_json_number(&json, NULL, nan_value));
    SURVIVES(pel_json_integer(&json, NULL, INT64_MIN));
    SURVIVES(pel_json_bool(&json, "", true));
    SURVIVES(pel_json_null(&json, NULL));
    SURVIVES(pel_json_numbers(&json, NULL, NULL, -3));
    SURVIVES(pel_json_free(NULL));
    finish();
}

/* ---- meshes and their files ---- */

static void test_meshes(void **unused)
{
    (void)unused;
    pel_mesh *made;
    double positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, bad[9] = {nan_value};
    int32_t triangle[3] = {0, 1, 2}, beyond[3] = {0, 1, 3};
    REFUSED("positions", pel_mesh_create(NULL, 3, triangle, 1, &made, &error));
    REFUSED("triangles", pel_mesh_create(positions, 3, NULL, 1, &made, &error));
    REFUSED("mesh", pel_mesh_create(positions, 3, triangle, 1, NULL, &error));
    REFUSED("vertices", pel_mesh_create(positions, -3, triangle, 1, &made, &error));
    REFUSED("triangles", pel_mesh_create(positions, 3, triangle, -1, &made, &error));
    REFUSED("index", pel_mesh_create(positions, 3, beyond, 1, &made, &error));
    REFUSED("position", pel_mesh_create(bad, 3, triangle, 1, &made, &error));
    SURVIVES(pel_mesh_destroy(NULL));
    REFUSED("mesh", pel_mesh_add_field(NULL, "x", 1, NULL, &error));
    REFUSED("name", pel_mesh_add_field(mesh, NULL, 1, NULL, &error));
    FAILS(pel_mesh_add_field(mesh, "", 1, NULL, &error));
    FAILS(pel_mesh_add_field(mesh, "x", 0, NULL, &error));
    FAILS(pel_mesh_add_field(mesh, "x", -3, NULL, &error));
    FAILS(pel_mesh_add_field(mesh, "x", INT32_MAX, NULL, &error));
    REFUSED("longer than 63 characters",
            pel_mesh_add_field(mesh, "a-name-of-64-characters-----------------------------------------", 1,
                               mesh->positions[0], &error));
    /* triangles beyond 32-bit corners: refused before they are read */
    const pel_mesh many = {.vertex_count = 3,
                           .triangle_count = INT32_MAX / 3 + 1,
                           .positions = mesh->positions,
                           .triangles = mesh->triangles};
    pel_topology *corners;
    pel_mesh_report *huge;
    REFUSED("715827883 triangles", pel_topology_create(&many, &corners, &error));
    REFUSED("715827883 triangles", pel_mesh_check(&many, &huge, &error));
    REFUSED("715827883 triangles", pel_mesh_repair(&many, NULL, &made, NULL, &error));
    GIVES(pel_mesh_field(NULL, "x") == NULL);
    GIVES(pel_mesh_field(mesh, NULL) == NULL);
    double low[3], high[3];
    SURVIVES(pel_mesh_box(NULL, low, high));
    GIVES((pel_mesh_box(mesh, low, high), low[0] <= high[0]));
    pel_transform transform = pel_transform_default();
    REFUSED("mesh", pel_mesh_transform(NULL, &transform, &error));
    REFUSED("transform", pel_mesh_transform(mesh, NULL, &error));
    transform.scale[1] = nan_value;
    REFUSED("scale", pel_mesh_transform(mesh, &transform, &error));
    GIVES(pel_issue_info_of((pel_issue_kind)-1) == NULL && pel_issue_info_of((pel_issue_kind)99) == NULL);
    pel_mesh_report *report;
    REFUSED("mesh", pel_mesh_check(NULL, &report, &error));
    REFUSED("report", pel_mesh_check(mesh, NULL, &error));
    SURVIVES(pel_mesh_report_destroy(NULL));
    pel_repair_options options = pel_repair_options_default();
    REFUSED("mesh", pel_mesh_repair(NULL, &options, &made, NULL, &error));
    REFUSED("repaired", pel_mesh_repair(mesh, NULL, NULL, NULL, &error));
    options.weld_tolerance = nan_value;
    REFUSED("tolerance", pel_mesh_repair(mesh, &options, &made, NULL, &error));
    options = pel_repair_options_default();
    options.drop_parts = -1;
    REFUSED("drop_parts", pel_mesh_repair(mesh, &options, &made, NULL, &error));
    const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, one_point[4][3] = {{0}};
    double density;
    REFUSED("kind", pel_volume_density((pel_volume_kind)99, 1, 0.3, 0, identity, &density, NULL, &error));
    REFUSED("poisson", pel_volume_density(PEL_VOLUME_STVK, 1, 0.5, 0, identity, &density, NULL, &error));
    REFUSED("deformation_gradient", pel_volume_density(PEL_VOLUME_STVK, 1, 0.3, 0, NULL, &density, NULL, &error));
    GIVES(pel_tetrahedron_volume(one_point) == 0);
    REFUSED("mesh", pel_mesh_fill_holes(NULL, 10, &made, NULL, &error));
    REFUSED("filled", pel_mesh_fill_holes(mesh, 10, NULL, NULL, &error));
    REFUSED("edge_limit", pel_mesh_fill_holes(mesh, -1, &made, NULL, &error));
    int64_t count;
    pel_pair pairs[1];
    REFUSED("mesh", pel_mesh_self_intersections(NULL, NULL, 0, &count, &error));
    REFUSED("count", pel_mesh_self_intersections(mesh, NULL, 0, NULL, &error));
    REFUSED("count", pel_mesh_self_intersections(mesh, pairs, -1, &count, &error));
    REFUSED("pairs", pel_mesh_self_intersections(mesh, NULL, 7, &count, &error));
    pel_topology *table;
    REFUSED("mesh", pel_topology_create(NULL, &table, &error));
    REFUSED("topology", pel_topology_create(mesh, NULL, &error));
    SURVIVES(pel_topology_destroy(NULL));
    pel_subdivide_def finer = pel_subdivide_def_default();
    REFUSED("mesh", pel_mesh_subdivide(NULL, 1, &made, &error));
    REFUSED("fine", pel_mesh_subdivide(mesh, 1, NULL, &error));
    REFUSED("subdivide", pel_mesh_subdivide(mesh, -1, &made, &error));
    FAILS(pel_mesh_subdivide(mesh, INT32_MAX, &made, &error));
    REFUSED("def", pel_mesh_subdivide_with(mesh, NULL, &made, &error));
    REFUSED("fine", pel_mesh_subdivide_with(mesh, &finer, NULL, &error));
    finer.levels = INT32_MIN;
    REFUSED("subdivide", pel_mesh_subdivide_with(mesh, &finer, &made, &error));
    FAILS(pel_mesh_subdivide_with(mesh, &(pel_subdivide_def){.levels = 1}, &made, &error));
    finish();
}

static void test_filled(void **unused)
{
    (void)unused;
    pel_mesh *made;
    static const int32_t corners_of_one[4] = {0, 1, 2, 9};
    REFUSED("surface", pel_mesh_fill(NULL, 0, &made, &error));
    REFUSED("filled", pel_mesh_fill(mesh, 0, NULL, &error));
    REFUSED("edge", pel_mesh_fill(mesh, -1, &made, &error));
    REFUSED("edge", pel_mesh_fill(mesh, nan_value, &made, &error));
    REFUSED("edge", pel_mesh_fill(mesh, 1e-300, &made, &error));
    REFUSED("path", pel_mesh_read_filled(NULL, NULL, &made, &error));
    REFUSED("mesh", pel_mesh_read_filled("a.msh", NULL, NULL, &error));
    REFUSED("name", pel_mesh_parse_filled(NULL, "", 0, NULL, &made, &error));
    REFUSED("bytes", pel_mesh_parse_filled("a.msh", NULL, 0, NULL, &made, &error));
    REFUSED("mesh", pel_mesh_parse_filled("a.msh", "", 0, NULL, NULL, &error));
    REFUSED("points", pel_mesh_create_filled(NULL, 3, corners_of_one, 1, &made, &error));
    REFUSED("tetrahedra", pel_mesh_create_filled(mesh->positions[0], 3, NULL, 1, &made, &error));
    REFUSED("mesh", pel_mesh_create_filled(mesh->positions[0], 3, corners_of_one, 1, NULL, &error));
    REFUSED("0 tetrahedra", pel_mesh_create_filled(mesh->positions[0], 3, corners_of_one, 0, &made, &error));
    REFUSED("vertex 9", pel_mesh_create_filled(mesh->positions[0], 3, corners_of_one, 1, &made, &error));
    finish();
}

static void test_files(void **unused)
{
    (void)unused;
    pel_mesh *made;
    GIVES(pel_mesh_format_of_path(NULL) == PEL_FORMAT_AUTO);
    GIVES(!pel_mesh_is_filled_file(NULL));
    REFUSED("path", pel_mesh_read(NULL, PEL_FORMAT_AUTO, NULL, &made, &error));
    REFUSED("mesh", pel_mesh_read("a.obj", PEL_FORMAT_AUTO, NULL, NULL, &error));
    REFUSED("name", pel_mesh_parse(NULL, "x", 1, PEL_FORMAT_AUTO, NULL, &made, &error));
    REFUSED("bytes", pel_mesh_parse("a.obj", NULL, 1, PEL_FORMAT_AUTO, NULL, &made, &error));
    REFUSED("mesh", pel_mesh_parse("a.obj", "x", 1, PEL_FORMAT_AUTO, NULL, NULL, &error));
    FAILS(pel_mesh_parse("a.obj", "v 0 0 0", 7, (pel_mesh_format)99, NULL, &made, &error));
    REFUSED("path", pel_mesh_write(NULL, PEL_FORMAT_OBJ, mesh, NULL, &error));
    REFUSED("mesh", pel_mesh_write("misuse.obj", PEL_FORMAT_OBJ, NULL, NULL, &error));
    REFUSED("format", pel_mesh_write("misuse.obj", (pel_mesh_format)-1, mesh, NULL, &error));
    REFUSED("format", pel_mesh_write("misuse.obj", (pel_mesh_format)99, mesh, NULL, &error));
    pel_vtp vtp = {.vertex_count = mesh->vertex_count,
                   .triangle_count = mesh->triangle_count,
                   .positions = mesh->positions[0],
                   .triangles = mesh->triangles[0]};
    pel_vtp_field field = {"x", 1, mesh->positions[0]};
    REFUSED("path", pel_vtp_write(NULL, &vtp, &error));
    REFUSED("vtp", pel_vtp_write("misuse.vtp", NULL, &error));
    pel_vtp wrong = vtp;
    wrong.positions = NULL;
    REFUSED("positions", pel_vtp_write("misuse.vtp", &wrong, &error));
    wrong = vtp, wrong.triangles = NULL;
    REFUSED("triangles", pel_vtp_write("misuse.vtp", &wrong, &error));
    wrong = vtp, wrong.field_count = 1;
    REFUSED("fields", pel_vtp_write("misuse.vtp", &wrong, &error));
    wrong.fields = &field, wrong.field_count = -1;
    REFUSED("fields", pel_vtp_write("misuse.vtp", &wrong, &error));
    wrong.field_count = 1, field.values = NULL;
    REFUSED("values", pel_vtp_write("misuse.vtp", &wrong, &error));
    field = (pel_vtp_field){NULL, 1, mesh->positions[0]};
    REFUSED("name", pel_vtp_write("misuse.vtp", &wrong, &error));
    wrong = vtp, wrong.cell_field_count = 2;
    REFUSED("cell_fields", pel_vtp_write("misuse.vtp", &wrong, &error));
    int32_t beyond[3] = {0, 1, mesh->vertex_count};
    wrong = vtp, wrong.triangles = beyond, wrong.triangle_count = 1;
    REFUSED("index", pel_vtp_write("misuse.vtp", &wrong, &error));
    pel_vtp_writer *writer;
    REFUSED("writer", pel_vtp_writer_create(NULL, &error));
    SURVIVES(pel_vtp_writer_destroy(NULL));
    REFUSED("writer", pel_vtp_writer_write(NULL, "misuse.vtp", &vtp, &error));
    assert_int_equal(pel_vtp_writer_create(&writer, NULL), PEL_OK);
    REFUSED("path", pel_vtp_writer_write(writer, NULL, &vtp, &error));
    REFUSED("vtp", pel_vtp_writer_write(writer, "misuse.vtp", NULL, &error));
    pel_vtp_writer_destroy(writer);
    REFUSED("path", pel_vtp_read(NULL, &made, NULL, &error));
    REFUSED("mesh", pel_vtp_read("a.vtp", NULL, NULL, &error));
    REFUSED("name", pel_vtp_parse(NULL, "x", 1, &made, NULL, &error));
    REFUSED("bytes", pel_vtp_parse("a.vtp", NULL, 1, &made, NULL, &error));
    REFUSED("mesh", pel_vtp_parse("a.vtp", "x", 1, NULL, NULL, &error));
    const char *names[1] = {NULL};
    REFUSED("path", pel_pvd_write(NULL, names, zero3, 1, &error));
    REFUSED("file_names", pel_pvd_write("misuse.pvd", NULL, zero3, 1, &error));
    REFUSED("file_names", pel_pvd_write("misuse.pvd", names, zero3, 1, &error));
    REFUSED("times", pel_pvd_write("misuse.pvd", names, NULL, 1, &error));
    REFUSED("frame_count", pel_pvd_write("misuse.pvd", names, zero3, -1, &error));
    finish();
}

/* ---- shapes, regions, presets ---- */

static void test_shapes(void **unused)
{
    (void)unused;
    pel_mesh *made;
    char text[32];
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    const pel_shape_parameter *parameter = pel_shape_info_of(PEL_SHAPE_GRID)->parameters;
    GIVES(pel_shape_info_of((pel_shape_kind)-1) == NULL && pel_shape_info_of(PEL_SHAPE_COUNT) == NULL);
    SURVIVES(pel_shape_def_default((pel_shape_kind)-1));
    SURVIVES(pel_shape_def_default((pel_shape_kind)999));
    REFUSED("name", pel_shape_def_of_name(NULL, &def, &error));
    REFUSED("def", pel_shape_def_of_name("grid", NULL, &error));
    REFUSED("blob", pel_shape_def_of_name("blob", &def, &error));
    REFUSED("def", pel_shape_set(NULL, "nx", "3", &error));
    REFUSED("key", pel_shape_set(&def, NULL, "3", &error));
    REFUSED("text", pel_shape_set(&def, "nx", NULL, &error));
    REFUSED("nx", pel_shape_set(&def, "nx", "nan", &error));
    REFUSED("def", pel_shape_set_number(NULL, "nx", 3, &error));
    REFUSED("key", pel_shape_set_number(&def, NULL, 3, &error));
    REFUSED("nx", pel_shape_set_number(&def, "nx", nan_value, &error));
    REFUSED("diagonals", pel_shape_set_number(&def, "diagonals", 77, &error));
    SURVIVES(pel_shape_get(NULL, parameter, text, sizeof text));
    SURVIVES(pel_shape_get(&def, NULL, text, sizeof text));
    SURVIVES(pel_shape_get(&def, parameter, NULL, 0));
    REFUSED("def", pel_shape_create(NULL, &made, &error));
    REFUSED("mesh", pel_shape_create(&def, NULL, &error));
    pel_shape_def wrong = def;
    wrong.kind = (pel_shape_kind)50;
    FAILS(pel_shape_create(&wrong, &made, &error));
    wrong = def, wrong.diagonals = (pel_grid_diagonals)-4;
    REFUSED("diagonals", pel_shape_create(&wrong, &made, &error));
    wrong = def, wrong.nx = INT32_MIN;
    REFUSED("nx", pel_shape_create(&wrong, &made, &error));
    wrong = def, wrong.nx = wrong.ny = INT32_MAX;
    FAILS(pel_shape_create(&wrong, &made, &error));
    wrong = def, wrong.size_x = nan_value;
    REFUSED("size_x", pel_shape_create(&wrong, &made, &error));
    pel_region region = pel_region_default();
    pel_selection *selection;
    REFUSED("mesh", pel_mesh_select(NULL, &region, &selection, &error));
    REFUSED("region", pel_mesh_select(mesh, NULL, &selection, &error));
    REFUSED("selection", pel_mesh_select(mesh, &region, NULL, &error));
    region.kind = (pel_region_kind)42;
    FAILS(pel_mesh_select(mesh, &region, &selection, &error));
    region.kind = PEL_REGION_VERTICES, region.vertex_count = 3;
    REFUSED("vertices", pel_mesh_select(mesh, &region, &selection, &error));
    region.vertex_count = -3;
    FAILS(pel_mesh_select(mesh, &region, &selection, &error));
    region.kind = PEL_REGION_FIELD;
    REFUSED("field", pel_mesh_select(mesh, &region, &selection, &error));
    region.kind = PEL_REGION_SPHERE, region.radius = nan_value;
    REFUSED("radius", pel_mesh_select(mesh, &region, &selection, &error));
    region = pel_region_default(), region.kind = PEL_REGION_BOX, region.falloff = nan_value;
    REFUSED("falloff", pel_mesh_select(mesh, &region, &selection, &error));
    SURVIVES(pel_selection_destroy(NULL));
    SURVIVES(pel_material_presets(NULL));
    GIVES(pel_material_preset_find(NULL) == NULL);
    SURVIVES(pel_shell_def_default());
    SURVIVES(pel_anisotropy_def_default());
    finish();
}

/* ---- measures: no array, no work ---- */

static void test_measures(void **unused)
{
    (void)unused;
    const double *x = mesh->positions[0];
    const int32_t *t = mesh->triangles[0];
    double out[3];
    pel_vertex_measure measure;
    pel_curvature_summary summary;
    SURVIVES(pel_vertex_measure_fill(NULL, x, 0, &measure));
    SURVIVES(pel_vertex_measure_fill(topology, x, -1, &measure));
    SURVIVES(pel_vertex_measure_fill(topology, x, INT32_MAX, &measure));
    SURVIVES(pel_surface_vertex_areas(topology, NULL, out));
    SURVIVES(pel_surface_vertex_areas(topology, x, NULL));
    SURVIVES(pel_surface_normals(NULL, x, PEL_NORMAL_ANGLE, out));
    SURVIVES(pel_surface_normals(topology, x, PEL_NORMAL_ANGLE, NULL));
    SURVIVES(pel_surface_mean_curvature(topology, NULL, NULL, NULL));
    SURVIVES(pel_surface_mean_curvature(topology, x, NULL, NULL));
    SURVIVES(pel_surface_gaussian_curvature(NULL, x, NULL, NULL));
    SURVIVES(pel_surface_curvature_summary(topology, x, NULL));
    SURVIVES(pel_surface_curvature_summary(NULL, x, &summary));
    GIVES(pel_surface_area(NULL, t, 4) == 0 && pel_surface_area(x, t, -4) == 0);
    GIVES(pel_surface_volume(x, NULL, 4, NULL) == 0 && pel_surface_volume(x, t, -4, NULL) == 0);
    GIVES(pel_surface_volume_gradient(x, 3, NULL, 1, NULL, out) == 0);
    SURVIVES(pel_surface_volume_gradient(x, -3, t, -1, NULL, out));
    SURVIVES(pel_surface_pressure(NULL, x, 1, PEL_PRESSURE_CONSISTENT, out, NULL, NULL));
    SURVIVES(pel_surface_pressure(topology, x, nan_value, PEL_PRESSURE_CONSISTENT, NULL, NULL, NULL));
    finish();
}

/* ---- collider ---- */

static void test_collider(void **unused)
{
    (void)unused;
    pel_collider_def def = pel_collider_def_default();
    pel_collider *made, *collider;
    REFUSED("def", pel_collider_create(NULL, &made, &error));
    REFUSED("collider", pel_collider_create(&def, NULL, &error));
    REFUSED("mesh", pel_collider_create(&def, &made, &error));
    def.mesh = mesh;
    pel_collider_def wrong = def;
    wrong.margin = nan_value;
    REFUSED("margin", pel_collider_create(&wrong, &made, &error));
    wrong = def, wrong.memory_limit = -1;
    FAILS(pel_collider_create(&wrong, &made, &error));
    wrong = def, wrong.thread_count = -1;
    FAILS(pel_collider_create(&wrong, &made, &error));
    wrong = def, wrong.thread_count = INT32_MAX;
    REFUSED("thread", pel_collider_create(&wrong, &made, &error));
    SURVIVES(pel_collider_destroy(NULL));
    assert_int_equal(pel_collider_create(&def, &collider, NULL), PEL_OK);
    pel_collision_query query = pel_collision_query_default();
    pel_collision_candidates candidates;
    pel_collision_result result;
    REFUSED("start", pel_collider_candidates(collider, &query, &candidates, &error));
    REFUSED("start", pel_collider_detect(collider, &query, &result, &error));
    query.start = mesh->positions[0];
    REFUSED("end", pel_collider_detect(collider, &query, &result, &error));
    query.end = query.start;
    REFUSED("collider", pel_collider_candidates(NULL, &query, &candidates, &error));
    REFUSED("query", pel_collider_candidates(collider, NULL, &candidates, &error));
    REFUSED("candidates", pel_collider_candidates(collider, &query, NULL, &error));
    REFUSED("collider", pel_collider_detect(NULL, &query, &result, &error));
    REFUSED("query", pel_collider_detect(collider, NULL, &result, &error));
    REFUSED("result", pel_collider_detect(collider, &query, NULL, &error));
    query.min_separation = nan_value;
    FAILS(pel_collider_detect(collider, &query, &result, &error));
    query.min_separation = 0, query.method = (pel_ccd_method)9;
    REFUSED("method", pel_collider_detect(collider, &query, &result, &error));
    pel_collider_destroy(collider);
    finish();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers), cmocka_unit_test(test_errors),   cmocka_unit_test(test_json),
        cmocka_unit_test(test_meshes),  cmocka_unit_test(test_filled),   cmocka_unit_test(test_files),
        cmocka_unit_test(test_shapes),  cmocka_unit_test(test_measures), cmocka_unit_test(test_collider),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
