#include "comma_locale.h"
#include "failing_malloc.h"
#include "mesh/sample.h"

#include "pellicle/mesh_check.h"
#include "pellicle/shape.h"
#include "primitive/lens.h"

static const double pi = 3.14159265358979323846;

static pel_mesh *create(const pel_shape_def *def)
{
    pel_mesh *mesh;
    pel_error error;
    pel_status status = pel_shape_create(def, &mesh, &error);
    if (status != PEL_OK)
        print_error("%s\n", error.what);
    assert_int_equal(status, PEL_OK);
    return mesh;
}

/* the report of a shape that must be sound: nothing but a boundary where one is expected */
static pel_mesh_report *check(const pel_shape_def *def, int32_t loops, int32_t genus)
{
    pel_mesh *mesh = create(def);
    pel_mesh_report *report;
    assert_int_equal(pel_mesh_check(mesh, &report, NULL), PEL_OK);
    assert_int_equal(report->error_count, 0);
    assert_int_equal(report->warning_count, 0);
    assert_int_equal(report->boundary_loop_count, loops);
    assert_int_equal(report->closed, loops == 0);
    assert_int_equal(report->component_count, 1);
    assert_int_equal(report->genus, genus);
    assert_true(loops > 0 || report->volume > 0);
    pel_mesh_destroy(mesh);
    return report;
}

static void test_geodesic_sphere_counts(void **unused)
{
    (void)unused;
    for (int32_t f = 1; f <= 24; f++) {
        pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
        def.frequency = f;
        def.radius = 0.25;
        pel_mesh_report *report = check(&def, 0, 0);
        assert_int_equal(report->vertex_count, 10 * f * f + 2);
        assert_int_equal(report->triangle_count, 20 * f * f);
        assert_true(report->quality_min > 0.95);
        assert_int_equal(report->valence_min, 5);
        assert_int_equal(report->valence_max, f > 1 ? 6 : 5);
        pel_mesh_report_destroy(report);
        pel_mesh *mesh = create(&def);
        for (int32_t v = 0; v < mesh->vertex_count; v++) {
            const double *p = mesh->positions[v];
            assert_near(sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]), 0.25, 1e-15);
        }
        pel_mesh_destroy(mesh);
    }
}

/* the shared sphere has the same vertices, in another order */
static void test_geodesic_sphere_is_the_shared_one(void **unused)
{
    (void)unused;
    pel_mesh *shared = sample_shared("sphere-252.obj"), *sphere = sample_sphere(5);
    for (int32_t v = 0; shared != NULL && v < shared->vertex_count; v++) {
        double least = 1;
        for (int32_t w = 0; w < sphere->vertex_count; w++) {
            double d = 0;
            for (int i = 0; i < 3; i++)
                d += pow(shared->positions[v][i] - sphere->positions[w][i], 2);
            least = fmin(least, sqrt(d));
        }
        assert_near(least, 0, 1e-7);
    }
    pel_mesh_destroy(shared);
    pel_mesh_destroy(sphere);
}

static void test_counts(void **unused)
{
    (void)unused;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_UV_SPHERE);
    for (int32_t slices = 3; slices < 40; slices += 6) {
        for (int32_t rings = 2; rings < 20; rings += 5) {
            def.slices = slices;
            def.rings = rings;
            pel_mesh_report *report = check(&def, 0, 0);
            assert_int_equal(report->vertex_count, slices * (rings - 1) + 2);
            assert_int_equal(report->triangle_count, 2 * slices * (rings - 1));
            pel_mesh_report_destroy(report);
        }
    }
    def = pel_shape_def_default(PEL_SHAPE_TORUS);
    for (int32_t slices = 3; slices < 30; slices += 4) {
        def.slices = slices;
        def.rings = 3 + slices % 5;
        pel_mesh_report *report = check(&def, 0, 1);
        assert_int_equal(report->vertex_count, slices * def.rings);
        assert_int_equal(report->triangle_count, 2 * slices * def.rings);
        pel_mesh_report_destroy(report);
    }
    def = pel_shape_def_default(PEL_SHAPE_DISK);
    for (def.rings = 1; def.rings < 20; def.rings += 3) {
        pel_mesh_report *report = check(&def, 1, 0);
        assert_int_equal(report->vertex_count, 3 * def.rings * (def.rings + 1) + 1);
        assert_int_equal(report->triangle_count, 6 * def.rings * def.rings);
        assert_true(report->quality_min > 0.8);
        /* of a regular polygon */
        assert_near(report->area, 3 * def.rings * sin(2 * pi / (6 * def.rings)), 1e-12);
        pel_mesh_report_destroy(report);
    }
    def = pel_shape_def_default(PEL_SHAPE_BOX);
    def.size_x = 2;
    def.size_z = 0.5;
    for (int32_t n = 0; n < 27; n++) {
        def.nx = 1 + n % 3;
        def.ny = 1 + n / 3 % 3;
        def.nz = 1 + n / 9;
        const int32_t faces = def.nx * def.ny + def.ny * def.nz + def.nz * def.nx;
        pel_mesh_report *report = check(&def, 0, 0);
        assert_int_equal(report->vertex_count, 2 * faces + 2);
        assert_int_equal(report->triangle_count, 4 * faces);
        assert_near(report->volume, 2 * 1 * 0.5, 1e-14);
        assert_near(report->area, 2 * (2 * 1 + 1 * 0.5 + 0.5 * 2), 1e-13);
        assert_near(report->bounds_high[0], 1, 0);
        assert_near(report->bounds_low[2], -0.25, 0);
        pel_mesh_report_destroy(report);
    }
    /* every number of slices: discs of all sizes */
    def = pel_shape_def_default(PEL_SHAPE_CYLINDER);
    for (int32_t slices = 3; slices < 200; slices += 1 + slices / 20) {
        def.slices = slices;
        def.segments = 1 + slices % 4;
        def.capped = true;
        pel_mesh_report_destroy(check(&def, 0, 0));
        def.capped = false;
        pel_mesh_report *report = check(&def, 2, 0);
        assert_int_equal(report->vertex_count, slices * (def.segments + 1));
        pel_mesh_report_destroy(report);
    }
    def = pel_shape_def_default(PEL_SHAPE_CAPSULE);
    for (int32_t slices = 3; slices < 30; slices += 4) {
        def.slices = slices;
        def.rings = 1 + slices % 6;
        def.height = slices % 3;
        pel_mesh_report_destroy(check(&def, 0, 0));
    }
}

/* closed, without self-intersections, even edges, and the size that was asked for; volumes as they were when the bodies
   were looked at */
static void test_blends(void **unused)
{
    (void)unused;
    static const double volumes[3][2] = {
        {0.869613816, 0.857095761}, {0.523456661, 0.523465331}, {1.06637442, 1.06795317}};
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_BLEND);
    for (int body = 0; body < 3; body++)
        for (int finer = 0; finer < LONG(2, 1); finer++) {
            def.body = (pel_blend_body)body;
            def.size = 2;
            def.edge = finer ? 0.035 : 0.06;
            pel_mesh_report *report = check(&def, 0, 0);
            double longest = 0;
            for (int i = 0; i < 3; i++) {
                double side = report->bounds_high[i] - report->bounds_low[i];
                longest = fmax(longest, side);
                assert_near(report->bounds_high[i], -report->bounds_low[i], 1e-12);
            }
            assert_near(longest, 2, 1e-12);
            assert_near(report->volume, volumes[body][finer], 1e-6);
            assert_true(report->edge_length_min > 0.6 * def.edge && report->edge_length_max < 2 * def.edge);
            assert_near(report->edge_length_median, def.edge, 0.05 * def.edge);
            assert_true(report->quality_min > 0.7);
            assert_true(report->valence_min >= 4 && report->valence_max <= 8);
            pel_mesh_report_destroy(report);
        }
    /* the same bits each time */
    pel_mesh *first = create(&def), *second = create(&def);
    assert_int_equal(first->vertex_count, second->vertex_count);
    assert_memory_equal(first->positions, second->positions, 24 * (size_t)first->vertex_count);
    pel_mesh_destroy(first);
    pel_mesh_destroy(second);
    /* an edge too long for the legs, or too short for anyone */
    pel_error error;
    pel_mesh *none;
    for (int i = 0; i < 2; i++) {
        def.body = PEL_BLEND_ANIMAL;
        def.edge = i == 0 ? 0.08 : 1e-4;
        assert_int_equal(pel_shape_create(&def, &none, &error), PEL_BAD_ARGUMENT);
        assert_null(none);
        assert_non_null(strstr(error.remedy, "from 0.001 to 0.06 m"));
    }
}

static void test_grids(void **unused)
{
    (void)unused;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    def.size_x = 3;
    def.size_y = 2;
    for (int32_t diagonals = 0; diagonals < 3; diagonals++) {
        for (int32_t n = 1; n < 8; n++) {
            def.diagonals = (pel_grid_diagonals)diagonals;
            def.nx = n;
            def.ny = 8 - n;
            pel_mesh_report *report = check(&def, 1, 0);
            bool shifted = def.diagonals == PEL_GRID_EQUILATERAL;
            assert_int_equal(report->vertex_count, (n + 1) * (def.ny + 1) + (shifted ? (def.ny + 1) / 2 : 0));
            assert_int_equal(report->triangle_count, shifted ? def.ny * (2 * n + 1) : 2 * n * def.ny);
            assert_near(report->area, 6, 1e-12);
            assert_true(report->bounds_low[0] == -1.5 && report->bounds_high[0] == 1.5);
            assert_true(report->bounds_low[1] == -1 && report->bounds_high[1] == 1);
            pel_mesh_report_destroy(report);
            /* normal +z */
            pel_mesh *mesh = create(&def);
            for (int32_t t = 0; t < mesh->triangle_count; t++) {
                const int32_t *v = mesh->triangles[t];
                const double *a = mesh->positions[v[0]], *b = mesh->positions[v[1]], *c = mesh->positions[v[2]];
                assert_true((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0);
            }
            pel_mesh_destroy(mesh);
        }
    }
    def.nx = 20;
    def.ny = 16;
    def.size_x = 20;
    def.size_y = 16 * sqrt(0.75);
    pel_mesh_report *report = check(&def, 1, 0);
    assert_near(report->edge_length_median, 1, 1e-12);
    assert_true(report->quality_min > 0.74 && report->quality_mean > 0.98);
    pel_mesh_report_destroy(report);
}

/* edges at a vertex, the rim included */
static int32_t count_edges(const pel_mesh *mesh, int32_t v)
{
    int32_t triangles = 0, before = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int32_t i = 0; i < 3; i++) {
            triangles += mesh->triangles[t][i] == v;
            /* an edge towards v that no triangle runs the other way */
            bool rim = mesh->triangles[t][(i + 1) % 3] == v;
            for (int32_t u = 0; rim && u < mesh->triangle_count; u++)
                for (int32_t k = 0; k < 3; k++)
                    rim &= mesh->triangles[u][k] != v || mesh->triangles[u][(k + 1) % 3] != mesh->triangles[t][i];
            before += rim;
        }
    return triangles + before;
}

/* diagonals meet at every second vertex: inside, eight edges there and four at the others */
static void test_union_jack(void **unused)
{
    (void)unused;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    def.diagonals = PEL_GRID_UNION_JACK;
    for (int32_t n = 2; n < 7; n++) {
        def.nx = n;
        def.ny = 9 - n;
        pel_mesh *mesh = create(&def);
        for (int32_t j = 1; j < def.ny; j++)
            for (int32_t i = 1; i < def.nx; i++)
                assert_int_equal(count_edges(mesh, j * (def.nx + 1) + i), (i + j) % 2 == 0 ? 8 : 4);
        pel_mesh_destroy(mesh);
    }
}

/* counts that fit a number and are too many triangles all the same are refused before memory is asked for */
static void test_too_large(void **unused)
{
    (void)unused;
    pel_mesh *mesh;
    pel_error error;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    const int32_t sizes[3] = {18919, 30000, 1000000};
    for (int32_t i = 0; i < 3; i++) {
        def.nx = def.ny = sizes[i];
        failing_malloc_begin(0);
        assert_int_equal(pel_shape_create(&def, &mesh, &error), PEL_BAD_ARGUMENT);
        assert_int_equal(failing_malloc_end().calls, 0);
        assert_null(mesh);
        assert_string_equal(error.remedy, "ask for at most 715827882 triangles");
    }
}

/* error of area and volume falls by four from one def to one twice as fine */
static void check_convergence(const pel_shape_def *coarse, const pel_shape_def *fine, double area, double volume)
{
    pel_mesh_report *reports[2];
    int32_t genus = coarse->kind == PEL_SHAPE_TORUS;
    reports[0] = check(coarse, 0, genus);
    reports[1] = check(fine, 0, genus);
    assert_near(reports[1]->area / area, 1, 1e-2);
    assert_near(reports[1]->volume / volume, 1, 1e-2);
    assert_near((area - reports[0]->area) / (area - reports[1]->area), 4, 0.12);
    assert_near((volume - reports[0]->volume) / (volume - reports[1]->volume), 4, 0.12);
    pel_mesh_report_destroy(reports[0]);
    pel_mesh_report_destroy(reports[1]);
}

static void test_areas_and_volumes(void **unused)
{
    (void)unused;
    skip_if_slow();
    pel_shape_def coarse = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE), fine = coarse;
    coarse.radius = fine.radius = 0.3;
    coarse.frequency = 16;
    fine.frequency = 32;
    check_convergence(&coarse, &fine, 4 * pi * 0.09, 4 * pi * 0.027 / 3);
    coarse = fine = pel_shape_def_default(PEL_SHAPE_UV_SPHERE);
    coarse.slices = coarse.rings = 40;
    fine.slices = fine.rings = 80;
    check_convergence(&coarse, &fine, 4 * pi, 4 * pi / 3);
    coarse = fine = pel_shape_def_default(PEL_SHAPE_CYLINDER);
    coarse.slices = 48;
    fine.slices = 96;
    check_convergence(&coarse, &fine, 2 * pi * 2 + 2 * pi, 2 * pi);
    coarse = fine = pel_shape_def_default(PEL_SHAPE_TORUS);
    coarse.slices = 64;
    coarse.rings = 40;
    fine.slices = 128;
    fine.rings = 80;
    check_convergence(&coarse, &fine, pi * pi, 2 * pi * pi / 16);
    coarse = fine = pel_shape_def_default(PEL_SHAPE_CAPSULE);
    coarse.slices = 40;
    coarse.rings = 12;
    fine.slices = 80;
    fine.rings = 24;
    check_convergence(&coarse, &fine, 2 * pi * 0.5 + pi, pi / 4 + pi / 6);
}

static void test_quality_of_cylinder_discs(void **unused)
{
    (void)unused;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_CYLINDER);
    for (int32_t slices = 24; slices < 300; slices += 17) {
        def.slices = slices;
        def.segments = slices / 3;
        pel_mesh_report *report = check(&def, 0, 0);
        assert_true(report->quality_min > 0.5);
        pel_mesh_report_destroy(report);
    }
}

/* area and volume of the outline turned about the axis, by the midpoint rule */
static void integrate_lens(int32_t age, double *area, double *volume)
{
    enum { COUNT = 20000 };
    pel_lens_outline outline;
    assert_true(pel_lens_outline_of_age(age, &outline));
    double r0 = 0, z0, r, z, step = outline.length / COUNT;
    *area = *volume = 0;
    pel_lens_outline_point(&outline, 0, &r0, &z0);
    for (int i = 1; i <= COUNT; i++) {
        pel_lens_outline_point(&outline, fmin(step * i, outline.length), &r, &z);
        *area += pi * (r + r0) * step * 1e-6;
        *volume += pi * (r * r + r * r0 + r0 * r0) / 3 * (z0 - z) * 1e-9;
        r0 = r;
        z0 = z;
    }
}

static void test_lens_capsule(void **unused)
{
    (void)unused;
    skip_if_slow();
    const int32_t ages[3] = {11, 29, 45};
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_LENS_CAPSULE);
    for (int k = 0; k < 3; k++) {
        double area, volume, errors[2][2];
        def.age = ages[k];
        integrate_lens(def.age, &area, &volume);
        for (int level = 0; level < 2; level++) {
            def.frequency = level == 0 ? 32 : 64;
            pel_mesh_report *report = check(&def, 0, 0);
            errors[level][0] = (area - report->area) / area;
            errors[level][1] = (volume - report->volume) / volume;
            assert_true(report->quality_min > 0.85);
            assert_true(report->edge_length_max / report->edge_length_min < 2.5);
            pel_mesh_report_destroy(report);
        }
        for (int i = 0; i < 2; i++) {
            assert_in_range((int)(1e6 * errors[1][i]), 1, 1000);
            assert_near(errors[0][i] / errors[1][i], 4, 0.3);
        }
    }
}

static void test_lens_capsule_mesh(void **unused)
{
    (void)unused;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_LENS_CAPSULE);
    pel_mesh *mesh = create(&def);
    assert_int_equal(mesh->vertex_count, 2562);
    assert_true(mesh->positions[0][0] == 0 && mesh->positions[0][1] == 0);
    assert_near(mesh->positions[0][2], 2.18e-3, 1e-18);
    const pel_field *thickness = pel_mesh_field(mesh, "thickness");
    assert_int_equal(thickness->component_count, 1);
    assert_near(thickness->values[0], 13e-6, 1e-18);
    int32_t lowest = 0, thickest = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        assert_true(thickness->values[v] >= 3e-6 && thickness->values[v] <= 25e-6);
        if (mesh->positions[v][2] < mesh->positions[lowest][2])
            lowest = v;
        if (thickness->values[v] > thickness->values[thickest])
            thickest = v;
    }
    assert_near(mesh->positions[lowest][2], -2.13e-3, 1e-18);
    assert_near(thickness->values[lowest], 3e-6, 1e-18);
    assert_near(hypot(mesh->positions[thickest][0], mesh->positions[thickest][1]), 3e-3, 2e-4);
    assert_true(mesh->positions[thickest][2] > 0);
    pel_mesh_destroy(mesh);
    pel_error error;
    def.age = 30;
    assert_int_equal(pel_shape_create(&def, &mesh, &error), PEL_BAD_ARGUMENT);
    assert_null(mesh);
    assert_non_null(strstr(error.remedy, "11, 29 or 45"));
}

static void test_table(void **unused)
{
    (void)unused;
    for (int32_t kind = 0; kind < PEL_SHAPE_COUNT; kind++) {
        const pel_shape_info *info = pel_shape_info_of((pel_shape_kind)kind);
        pel_shape_def def, by_name;
        pel_error error;
        assert_int_equal(info->kind, kind);
        def = pel_shape_def_default(info->kind);
        assert_int_equal(pel_shape_def_of_name(info->name, &by_name, &error), PEL_OK);
        assert_memory_equal(&def, &by_name, sizeof def);
        for (int32_t i = 0; i < info->parameter_count; i++) {
            const pel_shape_parameter *parameter = &info->parameters[i];
            char text[32];
            /* written values are read back, and the default is in range */
            pel_shape_get(&def, parameter, text, sizeof text);
            assert_int_equal(pel_shape_set(&def, parameter->name, text, &error), PEL_OK);
            assert_memory_equal(&def, &by_name, sizeof def);
            assert_int_equal(pel_shape_set_number(&def, parameter->name, parameter->default_value, NULL), PEL_OK);
            assert_int_equal(pel_shape_set_number(&def, parameter->name, parameter->maximum, NULL), PEL_OK);
            assert_int_equal(pel_shape_set_number(&def, parameter->name, parameter->minimum, NULL),
                             parameter->exclusive_minimum ? PEL_BAD_ARGUMENT : PEL_OK);
            assert_int_equal(pel_shape_set_number(&def, parameter->name, parameter->maximum * 1.5 + 1, &error),
                             PEL_BAD_ARGUMENT);
            assert_true(strlen(error.remedy) > 0);
            assert_int_equal(pel_shape_set_number(&def, parameter->name, (double)NAN, NULL), PEL_BAD_ARGUMENT);
            def = by_name;
        }
        pel_mesh *mesh = create(&def);
        pel_mesh_destroy(mesh);
    }
    assert_null(pel_shape_info_of(PEL_SHAPE_COUNT));
}

static void test_set(void **unused)
{
    (void)unused;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    pel_error error;
    char text[32];
    assert_int_equal(pel_shape_set(&def, "nx", "7", NULL), PEL_OK);
    assert_int_equal(pel_shape_set(&def, "size_x", "0.1", NULL), PEL_OK);
    assert_int_equal(pel_shape_set(&def, "diagonals", "union-jack", NULL), PEL_OK);
    assert_int_equal(def.nx, 7);
    assert_true(def.size_x == 0.1);
    assert_int_equal(def.diagonals, PEL_GRID_UNION_JACK);
    assert_string_equal(pel_shape_get(&def, &pel_shape_info_of(def.kind)->parameters[2], text, sizeof text), "0.1");
    static const struct {
        const char *key, *text, *what, *remedy;
    } wrong[] = {
        {"sizex", "1", "grid has no parameter 'sizex'", "did you mean 'size_x'?"},
        {"colour", "1", "grid has no parameter 'colour'", "use one of: nx, ny, size_x, size_y, diagonals"},
        {"nx", "many", "grid: nx cannot be 'many'", "give a number"},
        {"nx", "1.5", "grid: nx is 1.5", "give a whole number from 1 to 1e+06"},
        {"nx", "", "grid: nx cannot be ''", "give a number"},
        {"size_x", "-1", "grid: size_x is -1", "give a number greater than 0, at most 1e+09"},
        {"size_x", "1 m", "grid: size_x cannot be '1 m'", "give a number in m"},
        {"size_x", "nan", "grid: size_x cannot be 'nan'", "give a number in m"},
        {"size_x", "inf", "grid: size_x is inf", "give a number greater than 0, at most 1e+09"},
        {"diagonals", "onion-jack", "grid: diagonals cannot be 'onion-jack'", "did you mean 'union-jack'?"},
        {"diagonals", "equilaterals", "grid: diagonals cannot be 'equilaterals'", "did you mean 'equilateral'?"},
    };
    pel_shape_def before = def;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(pel_shape_set(&def, wrong[i].key, wrong[i].text, &error), PEL_BAD_ARGUMENT);
        assert_string_equal(error.what, wrong[i].what);
        assert_string_equal(error.remedy, wrong[i].remedy);
        assert_memory_equal(&def, &before, sizeof def);
    }
    def = pel_shape_def_default(PEL_SHAPE_CYLINDER);
    assert_int_equal(pel_shape_set(&def, "capped", "false", NULL), PEL_OK);
    assert_false(def.capped);
    assert_int_equal(pel_shape_set(&def, "capped", "yes", &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.remedy, "give true or false");
    assert_int_equal(pel_shape_def_of_name("torrus", &def, &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.remedy, "did you mean 'torus'?");
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_shape_def zero = {0}, def = pel_shape_def_default(PEL_SHAPE_TORUS);
    pel_mesh *mesh;
    pel_error error;
    assert_int_equal(pel_shape_create(&zero, &mesh, &error), PEL_BAD_ARGUMENT);
    def.minor_radius = 1;
    assert_int_equal(pel_shape_create(&def, &mesh, &error), PEL_BAD_ARGUMENT);
    def = pel_shape_def_default((pel_shape_kind)99);
    assert_int_equal(pel_shape_create(&def, &mesh, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_shape_set(&def, "radius", "1", &error), PEL_BAD_ARGUMENT);
    def = pel_shape_def_default(PEL_SHAPE_UV_SPHERE);
    def.radius = (double)NAN;
    assert_int_equal(pel_shape_create(&def, &mesh, &error), PEL_BAD_ARGUMENT);
    /* two million million triangles: refused before anything is allocated */
    def = pel_shape_def_default(PEL_SHAPE_UV_SPHERE);
    def.slices = def.rings = 1000000;
    assert_int_equal(pel_shape_create(&def, &mesh, &error), PEL_BAD_ARGUMENT);
    def = pel_shape_def_default(PEL_SHAPE_GRID);
    def.nx = def.ny = 1000000;
    assert_int_equal(pel_shape_create(&def, &mesh, &error), PEL_BAD_ARGUMENT);
    assert_null(mesh);
}

static pel_status create_case(const void *def, pel_error *error)
{
    pel_mesh *mesh;
    pel_status status = pel_shape_create(def, &mesh, error);
    if (status != PEL_OK)
        assert_null(mesh);
    pel_mesh_destroy(mesh);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    for (int32_t kind = 0; kind < PEL_SHAPE_BLEND; kind++) {
        pel_shape_def def = pel_shape_def_default((pel_shape_kind)kind);
        assert_in_range(for_every_allocation_failure(create_case, &def), 3, 7);
    }
    pel_shape_def box = pel_shape_def_default(PEL_SHAPE_BOX);
    assert_in_range(for_every_allocation_failure(create_case, &box), 3, 7);
}

/* a blend allocates in each of its many passes: all of the first ones, then some */
static void test_allocation_failures_of_blends(void **unused)
{
    (void)unused;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_BLEND);
    def.edge = 0.06 * def.size;
    allocation_count count = {.failed = 1};
    for (long n = 1; count.failed > 0; n += n < LONG(40, 10) ? 1 : LONG(127, ROUNDS(509, 1009))) {
        pel_error error = {0};
        failing_malloc_begin(n);
        pel_status status = create_case(&def, &error);
        count = failing_malloc_end();
        assert_int_equal(count.live, 0);
        assert_int_equal(status, count.failed > 0 && !count.failed_shrink ? PEL_OUT_OF_MEMORY : PEL_OK);
        assert_true(status == PEL_OK || error.status == PEL_OUT_OF_MEMORY);
    }
}

/* a decimal comma of the locale changes nothing */
static void test_locale(void **unused)
{
    (void)unused;
    if (!set_comma_locale())
        skip();
    char text[64];
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_TORUS);
    const pel_shape_parameter *minor = &pel_shape_info_of(PEL_SHAPE_TORUS)->parameters[1];
    assert_string_equal(pel_shape_get(&def, minor, text, sizeof text), "0.25");
    assert_int_equal(pel_shape_set(&def, "minor_radius", "0.375", NULL), PEL_OK);
    assert_int_equal(pel_shape_set(&def, "minor_radius", "0,5", NULL), PEL_BAD_ARGUMENT);
    setlocale(LC_NUMERIC, "C");
    assert_near(def.minor_radius, 0.375, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_geodesic_sphere_counts),
        cmocka_unit_test(test_geodesic_sphere_is_the_shared_one),
        cmocka_unit_test(test_counts),
        cmocka_unit_test(test_blends),
        cmocka_unit_test(test_grids),
        cmocka_unit_test(test_areas_and_volumes),
        cmocka_unit_test(test_quality_of_cylinder_discs),
        cmocka_unit_test(test_lens_capsule),
        cmocka_unit_test(test_lens_capsule_mesh),
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_set),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_allocation_failures),
        cmocka_unit_test(test_allocation_failures_of_blends),
        cmocka_unit_test(test_union_jack),
        cmocka_unit_test(test_too_large),
        cmocka_unit_test(test_locale),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
