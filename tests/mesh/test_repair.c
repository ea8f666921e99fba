#include "failing_malloc.h"
#include "sample.h"

#include "pellicle/mesh_check.h"

#include <math.h>

static pel_mesh *repair(const pel_mesh *mesh, const pel_repair_options *options, pel_repair_summary *summary)
{
    pel_mesh *repaired;
    pel_error error;
    pel_status status = pel_mesh_repair(mesh, options, &repaired, summary, &error);
    if (status != PEL_OK)
        print_error("%s\n", error.what);
    assert_int_equal(status, PEL_OK);
    return repaired;
}

static void assert_same_mesh(const pel_mesh *a, const pel_mesh *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_memory_equal(a->positions, b->positions, (size_t)a->vertex_count * sizeof *a->positions);
    assert_memory_equal(a->triangles, b->triangles, (size_t)a->triangle_count * sizeof *a->triangles);
    assert_int_equal(a->field_count, b->field_count);
    for (int32_t f = 0; f < a->field_count; f++)
        assert_memory_equal(a->fields[f].values, b->fields[f].values,
                            (size_t)(a->vertex_count * a->fields[f].component_count) * sizeof(double));
}

/* counts of the findings that no repair should leave; cuts leave vertices at one place */
static void assert_repaired(const pel_mesh *mesh, bool cut)
{
    pel_mesh_report *report;
    assert_int_equal(pel_mesh_check(mesh, &report, NULL), PEL_OK);
    for (int32_t kind = 0; kind < PEL_ISSUE_COUNT; kind++) {
        bool one_sided = report->issues[PEL_ISSUE_NON_ORIENTABLE].count > 0 && kind == PEL_ISSUE_INCONSISTENT_WINDING;
        bool at_a_cut = cut && kind == PEL_ISSUE_DUPLICATE_VERTEX;
        if (pel_issue_info_of((pel_issue_kind)kind)->repairable && !one_sided && !at_a_cut)
            assert_int_equal(report->issues[kind].count, 0);
    }
    pel_mesh_report_destroy(report);
}

static void test_sound_mesh_stays(void **unused)
{
    (void)unused;
    pel_mesh *sphere = sample_sphere(3);
    assert_int_equal(pel_mesh_add_field(sphere, "place", 3, sphere->positions[0], NULL), PEL_OK);
    pel_repair_summary summary;
    pel_mesh *repaired = repair(sphere, NULL, &summary);
    assert_same_mesh(sphere, repaired);
    assert_false(summary.changed);
    pel_mesh_destroy(repaired);
    pel_mesh_destroy(sphere);
}

/* three separate vertices for each triangle, as in an STL file */
static pel_mesh *soup_of(const pel_mesh *mesh)
{
    int32_t count = 3 * mesh->triangle_count;
    double(*positions)[3] = malloc((size_t)count * sizeof *positions);
    int32_t *corners = malloc((size_t)count * sizeof *corners);
    assert_true(positions != NULL && corners != NULL);
    for (int32_t k = 0; k < count; k++) {
        memcpy(positions[k], mesh->positions[mesh->triangles[k / 3][k % 3]], sizeof *positions);
        corners[k] = k;
    }
    pel_mesh *soup;
    assert_int_equal(pel_mesh_create(positions[0], count, corners, count / 3, &soup, NULL), PEL_OK);
    free(positions);
    free(corners);
    return soup;
}

static void test_weld_soup(void **unused)
{
    (void)unused;
    pel_mesh *sphere = sample_sphere(5), *soup = soup_of(sphere);
    int32_t map[1500];
    pel_repair_options options = pel_repair_options_default();
    pel_repair_summary summary;
    options.vertex_map = map;
    assert_int_equal(pel_mesh_add_field(soup, "place", 3, soup->positions[0], NULL), PEL_OK);
    pel_mesh *welded = repair(soup, &options, &summary);
    assert_int_equal(welded->vertex_count, 252);
    assert_int_equal(welded->triangle_count, 500);
    assert_int_equal(summary.welded_vertices, 1500 - 252);
    assert_true(summary.changed);
    assert_memory_equal(welded->fields[0].values, welded->positions, 252 * sizeof *welded->positions);
    /* the map leads to the same place, and new vertices come in order of first appearance */
    int32_t seen = 0;
    for (int32_t v = 0; v < 1500; v++) {
        assert_memory_equal(welded->positions[map[v]], soup->positions[v], sizeof *soup->positions);
        assert_true(map[v] <= seen);
        seen += map[v] == seen;
    }
    pel_mesh_destroy(welded);
    options.weld = false;
    welded = repair(soup, &options, &summary);
    assert_int_equal(welded->vertex_count, 1500);
    pel_mesh_destroy(welded);
    pel_mesh_destroy(soup);
    pel_mesh_destroy(sphere);
}

static void test_weld_tolerance(void **unused)
{
    (void)unused;
    pel_mesh *sphere = sample_sphere(4), *soup = soup_of(sphere);
    random_state random = {8};
    for (int32_t k = 0; k < soup->vertex_count; k++)
        for (int i = 0; i < 3; i++)
            soup->positions[k][i] += random_between(&random, -1e-6, 1e-6);
    pel_repair_options options = pel_repair_options_default();
    options.weld_tolerance = 4e-6;
    pel_repair_summary summary;
    pel_mesh *welded = repair(soup, &options, &summary);
    assert_int_equal(welded->vertex_count, sphere->vertex_count);
    assert_int_equal(welded->triangle_count, sphere->triangle_count);
    assert_repaired(welded, false);
    pel_mesh *again = repair(welded, &options, &summary);
    assert_same_mesh(welded, again);
    pel_error error;
    pel_mesh *none;
    const double refused[3] = {-1, 0.5, (double)NAN};
    for (int i = 0; i < 3; i++) {
        options.weld_tolerance = refused[i];
        assert_int_equal(pel_mesh_repair(soup, &options, &none, NULL, &error), PEL_BAD_ARGUMENT);
        assert_null(none);
        assert_true(strlen(error.remedy) > 0);
    }
    pel_mesh_destroy(again);
    pel_mesh_destroy(welded);
    pel_mesh_destroy(soup);
    pel_mesh_destroy(sphere);
}

static void test_winding(void **unused)
{
    (void)unused;
    random_state random = {9};
    pel_mesh *sphere = sample_sphere(4), *broken = sample_sphere(4);
    for (int round = 0; round < 3; round++) {
        /* some triangles turned, then most (the rest must follow), then all */
        int32_t turned = 0;
        memcpy(broken->triangles, sphere->triangles, (size_t)sphere->triangle_count * sizeof *sphere->triangles);
        for (int32_t t = 0; t < broken->triangle_count; t++) {
            if (random_below(&random, 4) > round && round < 2)
                continue;
            int32_t second = broken->triangles[t][1];
            broken->triangles[t][1] = broken->triangles[t][2];
            broken->triangles[t][2] = second;
            turned++;
        }
        pel_repair_summary summary;
        pel_mesh *repaired = repair(broken, NULL, &summary);
        assert_memory_equal(repaired->triangles, sphere->triangles,
                            (size_t)sphere->triangle_count * sizeof *sphere->triangles);
        assert_int_equal(summary.turned_triangles, turned);
        assert_int_equal(summary.outward_components, round == 2);
        pel_mesh_destroy(repaired);
    }
    pel_repair_options options = pel_repair_options_default();
    options.outward = false;
    pel_repair_summary summary;
    pel_mesh *kept = repair(broken, &options, &summary);
    assert_false(summary.changed);
    pel_mesh_destroy(kept);
    /* `outward` alone turns consistent components */
    options.outward = true;
    options.orient = false;
    kept = repair(broken, &options, &summary);
    assert_int_equal(summary.turned_triangles, broken->triangle_count);
    pel_mesh_destroy(kept);
    pel_mesh_destroy(broken);
    pel_mesh_destroy(sphere);
}

static void test_moebius_strip_stays(void **unused)
{
    (void)unused;
    static const int32_t strip[15] = {0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 0, 4, 4, 0, 1};
    pel_mesh *mesh = sample_mesh(5, strip, 5);
    pel_repair_summary summary;
    pel_mesh *repaired = repair(mesh, NULL, &summary);
    assert_same_mesh(mesh, repaired);
    assert_int_equal(summary.non_orientable, 1);
    assert_false(summary.changed);
    pel_mesh_destroy(repaired);
    pel_mesh_destroy(mesh);
}

static void test_drops(void **unused)
{
    (void)unused;
    /* vertices: 0..3 a tetrahedron, 4 not finite, 5 alone, 6 between 0 and 1, 7 alone and not finite */
    double positions[8][3] = {{0, 0, 0},           {1, 0, 0}, {0, 1, 0},   {0, 0, 1},
                              {(double)NAN, 0, 0}, {5, 5, 5}, {0.5, 0, 0}, {0, 0, (double)HUGE_VAL}};
    int32_t triangles[9][3] = {{0, 2, 1}, {0, 1, 4}, {0, 1, 3}, {1, 2, 3}, {0, 1, 8},
                               {2, 2, 3}, {2, 0, 3}, {0, 1, 6}, {3, 2, 1}};
    pel_mesh mesh = {.vertex_count = 8, .triangle_count = 9, .positions = positions, .triangles = triangles};
    int32_t map[8];
    const int32_t expected_map[8] = {0, 1, 2, 3, -1, -1, -1, -1};
    const int32_t expected[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    pel_repair_options options = pel_repair_options_default();
    pel_repair_summary summary;
    options.vertex_map = map;
    pel_mesh *repaired = repair(&mesh, &options, &summary);
    assert_int_equal(repaired->vertex_count, 4);
    assert_int_equal(repaired->triangle_count, 4);
    assert_memory_equal(repaired->triangles, expected, sizeof expected);
    assert_memory_equal(map, expected_map, sizeof map);
    assert_int_equal(summary.bad_triangles, 2);
    assert_int_equal(summary.degenerate_triangles, 2);
    assert_int_equal(summary.duplicate_triangles, 1);
    assert_int_equal(summary.isolated_vertices, 4);
    assert_int_equal(summary.turned_triangles, 0);
    assert_repaired(repaired, false);
    pel_mesh_destroy(repaired);
    /* without options only vertices that are not finite are dropped */
    options = (pel_repair_options){.vertex_map = map};
    const int32_t kept_map[8] = {0, 1, 2, 3, -1, 4, 5, -1};
    repaired = repair(&mesh, &options, &summary);
    assert_int_equal(repaired->vertex_count, 6);
    assert_int_equal(repaired->triangle_count, 7);
    assert_memory_equal(map, kept_map, sizeof map);
    pel_mesh_destroy(repaired);
}

/* ---- cutting and closing ---- */

static pel_mesh literal(double (*positions)[3], int32_t vertex_count, int32_t (*triangles)[3], int32_t triangle_count)
{
    return (pel_mesh){
        .vertex_count = vertex_count, .triangle_count = triangle_count, .positions = positions, .triangles = triangles};
}

static pel_mesh_report *check(const pel_mesh *mesh)
{
    pel_mesh_report *report;
    assert_int_equal(pel_mesh_check(mesh, &report, NULL), PEL_OK);
    return report;
}

/* a tetrahedron whose edge from 0 to 1 has vertices between on one side only; flat triangles fill the slit */
static void test_slit_is_closed(void **unused)
{
    (void)unused;
    double positions[7][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0, 0}, {0.25, 0, 0}, {0.75, 0, 0}};
    int32_t triangles[10][3] = {{0, 2, 1}, {1, 2, 3}, {2, 0, 3}, {0, 5, 3}, {5, 4, 3},
                                {4, 6, 3}, {6, 1, 3}, {0, 1, 4}, {0, 4, 5}, {4, 1, 6}};
    pel_mesh mesh = literal(positions, 7, triangles, 10);
    pel_repair_summary summary;
    pel_mesh *repaired = repair(&mesh, NULL, &summary);
    pel_mesh_report *report = check(repaired);
    assert_int_equal(summary.closed_slits, 3);
    assert_int_equal(summary.degenerate_triangles, 0);
    assert_int_equal(summary.turned_triangles, 0);
    assert_true(summary.changed);
    assert_int_equal(report->error_count, 0);
    assert_true(report->closed && report->manifold && report->oriented);
    assert_near(report->volume, 1.0 / 6, 1e-15);
    assert_near(report->area, 1.5 + sqrt(3.0) / 2, 1e-14);
    assert_int_equal(repaired->triangle_count, 10);
    pel_mesh_report_destroy(report);
    pel_mesh_destroy(repaired);
    /* without the option the flat ones are dropped and the slit stays */
    pel_repair_options options = pel_repair_options_default();
    options.close_slits = false;
    repaired = repair(&mesh, &options, &summary);
    report = check(repaired);
    assert_int_equal(summary.degenerate_triangles, 3);
    assert_false(report->closed);
    pel_mesh_report_destroy(report);
    pel_mesh_destroy(repaired);
}

/* a flat triangle on the rim of a sheet leaves no slit and goes */
static void test_flat_triangle_at_a_rim(void **unused)
{
    (void)unused;
    double positions[4][3] = {{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 0, 0}};
    int32_t triangles[3][3] = {{0, 3, 2}, {3, 1, 2}, {0, 1, 3}};
    pel_mesh mesh = literal(positions, 4, triangles, 3);
    pel_repair_summary summary;
    pel_mesh *repaired = repair(&mesh, NULL, &summary);
    assert_int_equal(summary.closed_slits, 0);
    assert_int_equal(summary.degenerate_triangles, 1);
    assert_int_equal(repaired->triangle_count, 2);
    assert_repaired(repaired, false);
    pel_mesh_destroy(repaired);
}

/* count tetrahedra around the z axis that share the edge on it; every second one is inside out */
static pel_mesh *tetrahedra_at_an_edge(int32_t count)
{
    double(*positions)[3] = calloc(2 * (size_t)count + 2, sizeof *positions);
    int32_t(*triangles)[3] = calloc(4 * (size_t)count, sizeof *triangles);
    assert_true(positions != NULL && triangles != NULL);
    positions[1][2] = 1;
    for (int32_t i = 0; i < count; i++) {
        int32_t a = 2 * i + 2, b = a + 1;
        const int32_t faces[4][3] = {{0, a, b}, {1, b, a}, {0, 1, a}, {0, b, 1}};
        for (int32_t k = 0; k < 2; k++) {
            double angle = 6.283185307179586 * (i + 0.5 * k) / count;
            positions[a + k][0] = cos(angle);
            positions[a + k][1] = sin(angle);
        }
        for (int32_t f = 0; f < 4; f++)
            for (int32_t k = 0; k < 3; k++)
                triangles[4 * i + f][k] = faces[f][i % 2 == 0 ? k : 2 - k];
    }
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions[0], 2 * count + 2, triangles[0], 4 * count, &mesh, NULL), PEL_OK);
    free(positions);
    free(triangles);
    return mesh;
}

static void test_bodies_at_an_edge_come_apart(void **unused)
{
    (void)unused;
    for (int32_t count = 2; count < 6; count++) {
        pel_mesh *mesh = tetrahedra_at_an_edge(count);
        double expected = count * sin(3.141592653589793 / count) / 6;
        assert_int_equal(pel_mesh_add_field(mesh, "place", 3, mesh->positions[0], NULL), PEL_OK);
        pel_repair_summary summary;
        pel_mesh *repaired = repair(mesh, NULL, &summary);
        pel_mesh_report *report = check(repaired);
        assert_int_equal(report->error_count, 0);
        assert_true(report->closed && report->manifold && report->oriented);
        assert_int_equal(report->component_count, count);
        assert_int_equal(summary.cut_vertices, 2 * (count - 1));
        assert_int_equal(repaired->vertex_count, 4 * count);
        assert_near(report->volume, expected, 1e-14);
        /* copies stand where their vertices are, with their fields */
        assert_memory_equal(repaired->fields[0].values, repaired->positions,
                            (size_t)repaired->vertex_count * sizeof *repaired->positions);
        pel_mesh *again = repair(repaired, NULL, &summary);
        assert_same_mesh(repaired, again);
        assert_false(summary.changed);
        pel_mesh_destroy(again);
        pel_mesh_report_destroy(report);
        pel_mesh_destroy(repaired);
        pel_mesh_destroy(mesh);
    }
}

/* two tetrahedra that share a vertex, one of them with a fin at an edge */
static void test_vertex_and_fin_are_cut(void **unused)
{
    (void)unused;
    double positions[8][3] = {{0, 0, 0},  {1, 0, 0},  {0, 1, 0},  {0, 0, 1},
                              {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {1, 1, -1}};
    int32_t triangles[9][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 5, 4},
                               {0, 4, 6}, {4, 5, 6}, {5, 0, 6}, {1, 2, 7}};
    pel_mesh mesh = literal(positions, 8, triangles, 9);
    pel_repair_summary summary;
    pel_mesh *repaired = repair(&mesh, NULL, &summary);
    pel_mesh_report *report = check(repaired);
    assert_int_equal(report->error_count, 0);
    assert_true(report->manifold && report->oriented);
    assert_int_equal(report->component_count, 3);
    assert_true(report->components[0].closed && report->components[1].closed);
    assert_int_equal(report->components[2].triangle_count, 1);
    assert_int_equal(summary.cut_vertices, 3);
    assert_near(report->volume, 1.0 / 3, 1e-14);
    pel_mesh_report_destroy(report);
    pel_mesh_destroy(repaired);
    pel_repair_options options = pel_repair_options_default();
    options.cut = false;
    repaired = repair(&mesh, &options, &summary);
    report = check(repaired);
    assert_false(report->manifold);
    assert_int_equal(summary.cut_vertices, 0);
    pel_mesh_report_destroy(report);
    pel_mesh_destroy(repaired);
}

static void test_nothing_left(void **unused)
{
    (void)unused;
    double positions[3][3] = {{0}};
    int32_t triangles[1][3] = {{0, 1, 2}};
    pel_mesh mesh = {.vertex_count = 3, .triangle_count = 1, .positions = positions, .triangles = triangles};
    pel_mesh *repaired;
    pel_error error;
    assert_int_equal(pel_mesh_repair(&mesh, NULL, &repaired, NULL, &error), PEL_BAD_MESH);
    assert_null(repaired);
    mesh.triangle_count = 0;
    assert_int_equal(pel_mesh_repair(&mesh, NULL, &repaired, NULL, &error), PEL_BAD_ARGUMENT);
}

/* any defects: the result is valid except for unrepairable ones, and a second repair changes nothing */
static void test_random_messes(void **unused)
{
    (void)unused;
    random_state random = {10};
    int repaired_count = 0, uncut_count = 0;
    for (int round = 0; round < 2000; round++) {
        double positions[12][3];
        int32_t triangles[16][3];
        pel_mesh mesh = {.vertex_count = 4 + random_below(&random, 9),
                         .triangle_count = 1 + random_below(&random, 16),
                         .positions = positions,
                         .triangles = triangles};
        for (int32_t v = 0; v < mesh.vertex_count; v++) {
            for (int i = 0; i < 3; i++)
                positions[v][i] = random_below(&random, 3) + 1e-4 * random_below(&random, 2);
            if (random_below(&random, 40) == 0)
                positions[v][0] = (double)NAN;
        }
        for (int32_t t = 0; t < mesh.triangle_count; t++)
            for (int i = 0; i < 3; i++)
                triangles[t][i] = random_below(&random, 200) == 0 ? 99 : random_below(&random, mesh.vertex_count);
        pel_repair_options options = pel_repair_options_default();
        options.weld_tolerance = round % 2 == 0 ? 0 : 1.5e-4;
        pel_mesh *repaired, *again;
        pel_repair_summary summary;
        pel_status status = pel_mesh_repair(&mesh, &options, &repaired, &summary, NULL);
        if (status != PEL_OK)
            continue;
        repaired_count++;
        assert_repaired(repaired, summary.cut_vertices > 0);
        again = repair(repaired, &options, &summary);
        assert_repaired(again, summary.cut_vertices > 0);
        /* pieces at an edge may be turned since, and then others face each other through a body */
        if (summary.cut_vertices == 0) {
            assert_same_mesh(repaired, again);
            assert_false(summary.changed);
        }
        uncut_count += summary.cut_vertices == 0;
        pel_mesh_destroy(again);
        pel_mesh_destroy(repaired);
    }
    assert_in_range(repaired_count, 1000, 2000);
    assert_in_range(uncut_count, 200, repaired_count - 200);
}

static pel_status repair_case(const void *mesh, pel_error *error)
{
    pel_mesh *repaired;
    pel_status status = pel_mesh_repair(mesh, NULL, &repaired, NULL, error);
    if (status != PEL_OK)
        assert_null(repaired);
    pel_mesh_destroy(repaired);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    pel_mesh *sphere = sample_sphere(2), *soup = soup_of(sphere);
    assert_int_equal(pel_mesh_add_field(soup, "place", 3, soup->positions[0], NULL), PEL_OK);
    assert_true(for_every_allocation_failure(repair_case, soup) > 15);
    pel_mesh_destroy(soup);
    pel_mesh_destroy(sphere);
    pel_mesh *touching = tetrahedra_at_an_edge(3);
    assert_true(for_every_allocation_failure(repair_case, touching) > 25);
    pel_mesh_destroy(touching);
}

/* parts of 80, 4 and 2 triangles: by their size, with their vertices but not other ones */
static void test_drop_parts(void **unused)
{
    (void)unused;
    static const double far_off[8][3] = {{3, 0, 0}, {4, 0, 0}, {3, 1, 0}, {3, 0, 1},
                                         {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {7, 7, 7}};
    static const int32_t corners[6][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {4, 5, 6}, {6, 5, 3}};
    enum { SPHERE = 42 };
    pel_mesh *sphere = sample_sphere(2), *messy;
    double positions[SPHERE + 9][3];
    int32_t triangles[86][3];
    assert_int_equal(sphere->vertex_count, SPHERE);
    assert_int_equal(sphere->triangle_count, 80);
    memcpy(positions, sphere->positions, SPHERE * sizeof *positions);
    memcpy(positions + SPHERE, far_off, sizeof far_off);
    memcpy(triangles, sphere->triangles, 80 * sizeof *triangles);
    for (int t = 0; t < 6; t++)
        for (int i = 0; i < 3; i++)
            triangles[80 + t][i] = SPHERE + corners[t][i];
    /* the two triangles have a corner at one of the tetrahedron, but no edge in common with it */
    memcpy(positions[SPHERE + 8], far_off[3], sizeof *positions);
    triangles[85][2] = SPHERE + 8;
    assert_int_equal(pel_mesh_create(positions[0], SPHERE + 9, triangles[0], 86, &messy, NULL), PEL_OK);
    static const int32_t limits[] = {1, 2, 3, 4, 79, 1000}, parts[] = {0, 1, 1, 2, 2, 2};
    static const int32_t triangle_counts[] = {86, 84, 80}, vertex_counts[] = {SPHERE + 7, SPHERE + 4, SPHERE};
    for (int i = 0; i < 6; i++) {
        pel_repair_options options = pel_repair_options_default();
        options.drop_parts = limits[i];
        options.cut = false;
        pel_repair_summary summary;
        pel_mesh *repaired = repair(messy, &options, &summary);
        assert_int_equal(summary.dropped_parts, parts[i]);
        assert_int_equal(summary.isolated_vertices, 1);
        assert_int_equal(repaired->triangle_count, triangle_counts[parts[i]]);
        assert_int_equal(repaired->vertex_count, vertex_counts[parts[i]]);
        pel_mesh *again = repair(repaired, &options, &summary);
        assert_same_mesh(repaired, again);
        pel_mesh_destroy(again);
        pel_mesh_destroy(repaired);
    }
    pel_mesh_destroy(messy);
    pel_mesh_destroy(sphere);
}

static pel_status drop_parts_case(const void *mesh, pel_error *error)
{
    pel_mesh *repaired;
    pel_repair_options options = pel_repair_options_default();
    options.drop_parts = 4;
    pel_status status = pel_mesh_repair(mesh, &options, &repaired, NULL, error);
    if (status != PEL_OK)
        assert_null(repaired);
    pel_mesh_destroy(repaired);
    return status;
}

static void test_drop_parts_without_memory(void **unused)
{
    (void)unused;
    pel_mesh *sphere = sample_sphere(2);
    assert_true(for_every_allocation_failure(drop_parts_case, sphere) > 15);
    pel_mesh_destroy(sphere);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sound_mesh_stays),
        cmocka_unit_test(test_weld_soup),
        cmocka_unit_test(test_weld_tolerance),
        cmocka_unit_test(test_winding),
        cmocka_unit_test(test_moebius_strip_stays),
        cmocka_unit_test(test_drops),
        cmocka_unit_test(test_slit_is_closed),
        cmocka_unit_test(test_flat_triangle_at_a_rim),
        cmocka_unit_test(test_bodies_at_an_edge_come_apart),
        cmocka_unit_test(test_vertex_and_fin_are_cut),
        cmocka_unit_test(test_nothing_left),
        cmocka_unit_test(test_random_messes),
        cmocka_unit_test(test_allocation_failures),
        cmocka_unit_test(test_drop_parts),
        cmocka_unit_test(test_drop_parts_without_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
