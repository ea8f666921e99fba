#include "../subdivide/sample.h"
#include "closed_form.h"
#include "failing_malloc.h"
#include "gradient.h"

#include "pellicle/mesh_check.h"
#include "pellicle/mesh_io.h"
#include "source_dir.h"

static pel_vertex_measure measure_of(const curved_mesh *curved, int32_t v)
{
    pel_vertex_measure measure;
    pel_vertex_measure_fill(curved->topology, curved->mesh->positions[0], v, &measure);
    return measure;
}

static curved_mesh make_triangles(const double *positions, int32_t vertex_count, const int32_t *triangles,
                                  int32_t triangle_count)
{
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions, vertex_count, triangles, triangle_count, &mesh, NULL), PEL_OK);
    return finish_mesh(mesh);
}

static double surface_area(const curved_mesh *curved)
{
    return pel_surface_area(curved->mesh->positions[0], curved->mesh->triangles[0], curved->mesh->triangle_count);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ---- areas ---- */

/* the part of a triangle in the plane that is nearer to corner 0 than to the others, by counting points */
static double nearest_part(double x[3][3])
{
    enum { CELLS = 400 };
    int64_t nearest = 0, all = 0;
    for (int i = 0; i < CELLS; i++)
        for (int j = 0; i + j < CELLS; j++, all++) {
            double s = (i + 1.0 / 3) / CELLS, t = (j + 1.0 / 3) / CELLS, square[3] = {0, 0, 0};
            for (int corner = 0; corner < 3; corner++)
                for (int c = 0; c < 2; c++) {
                    double p = x[0][c] + s * (x[1][c] - x[0][c]) + t * (x[2][c] - x[0][c]);
                    square[corner] += (p - x[corner][c]) * (p - x[corner][c]);
                }
            nearest += square[0] <= square[1] && square[0] <= square[2];
        }
    return (double)nearest / (double)all;
}

static void test_areas_are_those_of_nearest_points(void **unused)
{
    (void)unused;
    const int32_t triangle[3] = {0, 1, 2};
    random_state random = {11};
    for (int round = 0, seen = 0; seen < 20; round++) {
        double x[3][3] = {{0}};
        for (int i = 0; i < 3; i++)
            for (int c = 0; c < 2; c++)
                x[i][c] = random_between(&random, -1, 1);
        double turn = (x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) - (x[2][0] - x[0][0]) * (x[1][1] - x[0][1]);
        double least = 1;
        for (int i = 0; i < 3; i++) {
            double u[3], w[3];
            for (int c = 0; c < 3; c++) {
                u[c] = x[(i + 1) % 3][c] - x[i][c];
                w[c] = x[(i + 2) % 3][c] - x[i][c];
            }
            least = fmin(least, dot(u, w));
        }
        if (least < 0 || turn < 0.05)
            continue;
        seen++;
        curved_mesh curved = make_triangles(x[0], 3, triangle, 1);
        assert_near(measure_of(&curved, 0).area / surface_area(&curved), nearest_part(x), 0.01);
        destroy_mesh(&curved);
    }
}

static void test_areas_of_obtuse_triangle(void **unused)
{
    (void)unused;
    const double x[9] = {0, 0, 0, 4, 0, 0, -1, 1, 0};
    const int32_t triangle[3] = {0, 1, 2};
    curved_mesh curved = make_triangles(x, 3, triangle, 1);
    assert_near(measure_of(&curved, 0).area, 1, 1e-15);
    assert_near(measure_of(&curved, 1).area, 0.5, 1e-15);
    assert_near(measure_of(&curved, 2).area, 0.5, 1e-15);
    destroy_mesh(&curved);
}

/* no area is lost or counted twice, for triangles of any shape */
static void test_areas_sum_up(void **unused)
{
    (void)unused;
    random_state random = {3};
    for (int round = 0; round < 50; round++) {
        curved_mesh curved = finish_mesh(sample_random(&random));
        double *areas = malloc(sizeof *areas * (size_t)curved.mesh->vertex_count), sum = 0;
        pel_surface_vertex_areas(curved.topology, curved.positions, areas);
        for (int32_t v = 0; v < curved.mesh->vertex_count; v++) {
            assert_true(areas[v] == measure_of(&curved, v).area);
            assert_true(areas[v] >= 0);
            sum += areas[v];
        }
        assert_near(sum / surface_area(&curved), 1, 1e-13);
        free(areas);
        destroy_mesh(&curved);
    }
}

/* ---- mean curvature ---- */

/* the sum of cotangents as in the paper, over half-edges */
static void cotangent_sum(const curved_mesh *curved, int32_t v, double sum[3])
{
    sum[0] = sum[1] = sum[2] = 0;
    for (int32_t h = 0; h < 3 * curved->mesh->triangle_count; h++) {
        const int32_t *t = curved->mesh->triangles[h / 3];
        int32_t a = t[h % 3], b = t[(h + 1) % 3], c = t[(h + 2) % 3];
        if (a != v && b != v)
            continue;
        double u[3], w[3], n[3];
        for (int i = 0; i < 3; i++) {
            u[i] = curved->mesh->positions[a][i] - curved->mesh->positions[c][i];
            w[i] = curved->mesh->positions[b][i] - curved->mesh->positions[c][i];
        }
        for (int i = 0; i < 3; i++)
            n[i] = u[(i + 1) % 3] * w[(i + 2) % 3] - u[(i + 2) % 3] * w[(i + 1) % 3];
        double cotangent = dot(u, w) / sqrt(dot(n, n));
        for (int i = 0; i < 3; i++)
            sum[i] += 0.5 * cotangent * (a == v ? u[i] - w[i] : w[i] - u[i]);
    }
}

static double area_of(const void *context, const double *x)
{
    const pel_mesh *mesh = context;
    return pel_surface_area(x, mesh->triangles[0], mesh->triangle_count);
}

static void test_mean_curvature_normal(void **unused)
{
    (void)unused;
    curved_mesh curved = make_irregular(6);
    for (int32_t v = 0; v < curved.mesh->vertex_count; v++) {
        pel_vertex_measure measure = measure_of(&curved, v);
        double sum[3];
        cotangent_sum(&curved, v, sum);
        for (int c = 0; c < 3; c++)
            assert_near(measure.mean_curvature_normal[c] * measure.area, sum[c], 1e-13);
    }
    for (int v = 0; v < curved.mesh->vertex_count; v += 9) {
        pel_vertex_measure measure = measure_of(&curved, v);
        for (int c = 0; c < 3; c++)
            assert_near(numeric_derivative(area_of, curved.mesh, curved.mesh->positions[0], 3 * v + c, 1e-3) /
                            measure.area,
                        measure.mean_curvature_normal[c], 1e-7);
    }
    destroy_mesh(&curved);
}

/* For points on a sphere (x_i - x_j) . n is |x_i - x_j|^2 / 2r, and the sum of cotangents times squared edges is 8
   times the Voronoi area: without obtuse triangles the normal part is exact on any mesh. */
static void test_sphere_is_exact_along_the_normal(void **unused)
{
    (void)unused;
    random_state random = {29};
    curved_mesh curved = make_sphere(12, 1);
    for (int32_t v = 0; v < curved.mesh->vertex_count; v++) {
        double *x = curved.mesh->positions[v], length;
        for (int c = 0; c < 3; c++)
            x[c] += random_between(&random, -0.005, 0.005);
        length = sqrt(dot(x, x));
        for (int c = 0; c < 3; c++)
            x[c] *= 3 / length;
    }
    for (int32_t v = 0; v < curved.mesh->vertex_count; v++) {
        pel_vertex_measure measure = measure_of(&curved, v);
        assert_near(dot(measure.mean_curvature_normal, curved.mesh->positions[v]) / 3, 2.0 / 3, 1e-12);
    }
    destroy_mesh(&curved);
}

/* turning all triangles around turns the sign; a saddle of a torus has both signs of Gaussian curvature */
static void test_sign(void **unused)
{
    (void)unused;
    curved_mesh out = make_sphere(4, 1), in = make_sphere(4, 1);
    for (int32_t t = 0; t < in.mesh->triangle_count; t++) {
        int32_t *triangle = in.mesh->triangles[t], kept = triangle[1];
        triangle[1] = triangle[2];
        triangle[2] = kept;
    }
    pel_topology_destroy(in.topology);
    in = finish_mesh(in.mesh);
    for (int32_t v = 0; v < out.mesh->vertex_count; v++) {
        assert_true(measure_of(&out, v).mean_curvature > 0.9);
        assert_near(measure_of(&in, v).mean_curvature, -measure_of(&out, v).mean_curvature, 1e-12);
        assert_near(measure_of(&in, v).gaussian_curvature, measure_of(&out, v).gaussian_curvature, 1e-12);
    }
    destroy_mesh(&out);
    destroy_mesh(&in);
}

/* ---- Gaussian curvature ---- */

static void check_defect_of_all(curved_mesh curved, double defect)
{
    for (int32_t v = 0; v < curved.mesh->vertex_count; v++)
        assert_near(measure_of(&curved, v).angle_defect, defect, 1e-14);
    destroy_mesh(&curved);
}

static void test_regular_solids(void **unused)
{
    (void)unused;
    const double tetrahedron[12] = {1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1};
    const int32_t tetrahedron_triangles[12] = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
    const double octahedron[18] = {1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0, 0, -1, 0, 0, 0, -1};
    const int32_t octahedron_triangles[24] = {0, 1, 2, 1, 3, 2, 3, 4, 2, 4, 0, 2, 1, 0, 5, 3, 1, 5, 4, 3, 5, 0, 4, 5};
    check_defect_of_all(make_triangles(tetrahedron, 4, tetrahedron_triangles, 4), pi);
    check_defect_of_all(make_triangles(octahedron, 6, octahedron_triangles, 8), 2 * pi / 3);
    check_defect_of_all(make_sphere(1, 1), pi / 3);
}

static void check_gauss_bonnet(const curved_mesh *curved)
{
    pel_mesh_report *report;
    pel_curvature_summary summary;
    size_t count = (size_t)curved->mesh->vertex_count;
    double *gaussian = malloc(sizeof *gaussian * count), *defects = malloc(sizeof *defects * count), sum = 0;
    assert_int_equal(pel_mesh_check(curved->mesh, &report, NULL), PEL_OK);
    double total = pel_surface_gaussian_curvature(curved->topology, curved->positions, gaussian, defects);
    pel_surface_curvature_summary(curved->topology, curved->positions, &summary);
    /* 1e-12 is the error of the sum over 100,000 vertices; pi in one double would give 2e-11 */
    assert_near(total, 2 * pi * report->euler_characteristic, 1e-11);
    assert_true(total == summary.total_curvature);
    for (int32_t v = 0; v < curved->mesh->vertex_count; v++) {
        double area = measure_of(curved, v).area;
        assert_true(area > 0 || gaussian[v] == 0);
        sum += area > 0 ? gaussian[v] * area : defects[v];
    }
    assert_near(sum, total, 1e-10);
    pel_mesh_report_destroy(report);
    free(defects);
    free(gaussian);
}

static void test_gauss_bonnet(void **unused)
{
    (void)unused;
    random_state random = {8};
    pel_shape_def cylinder = pel_shape_def_default(PEL_SHAPE_CYLINDER);
    cylinder.capped = false;
    curved_mesh curved[] = {make_sphere(100, 1), make_torus(100), make_irregular(40), make_shape(&cylinder)};
    for (int i = 0; i < 4; i++) {
        check_gauss_bonnet(&curved[i]);
        destroy_mesh(&curved[i]);
    }
    /* with holes, several pieces and vertices in no triangle */
    for (int round = 0; round < 100; round++) {
        curved_mesh sample = finish_mesh(sample_random(&random));
        check_gauss_bonnet(&sample);
        destroy_mesh(&sample);
    }
}

static void test_real_meshes(void **unused)
{
    (void)unused;
    static const char *const names[] = {"tests/data/bean.obj", "tests/data/sac.obj", "../shared/data/liver.obj",
                                        "../shared/data/nefertiti-head.obj", "../shared/data/spot.obj"};
    int found = 0;
    for (int i = 0; i < 5; i++) {
        char path[512];
        pel_mesh *mesh;
        snprintf(path, sizeof path, "%s/%s", PEL_SOURCE_DIR, names[i]);
        if (pel_mesh_read(path, PEL_FORMAT_AUTO, NULL, &mesh, NULL) != PEL_OK)
            continue;
        curved_mesh curved = finish_mesh(mesh);
        check_gauss_bonnet(&curved);
        destroy_mesh(&curved);
        found++;
    }
    assert_true(found >= 2);
}

static void test_boundary(void **unused)
{
    (void)unused;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    def.nx = def.ny = 4;
    def.size_x = def.size_y = 4;
    curved_mesh curved = make_shape(&def);
    for (int32_t v = 0; v < 25; v++) {
        pel_vertex_measure measure = measure_of(&curved, v);
        const double *x = curved.mesh->positions[v];
        int sides = (fabs(x[0]) > 1.5) + (fabs(x[1]) > 1.5);
        assert_int_equal(measure.boundary, sides > 0);
        assert_near(measure.angle_defect, sides == 2 ? pi / 2 : 0, 1e-15);
        assert_near(measure.area, 1.0 / (1 << sides), 1e-15);
        assert_near(measure.mean_curvature, 0, 1e-15);
        assert_near(measure.normal[2], 1, 1e-15);
    }
    destroy_mesh(&curved);
}

/* ---- normals ---- */

/* a cube, whose corners see one or two triangles of each side: weighted by angle this does not matter */
static void test_normals_of_cube(void **unused)
{
    (void)unused;
    const double cube[24] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
    const int32_t triangles[36] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                   1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
    curved_mesh curved = make_triangles(cube, 8, triangles, 12);
    double by_angle[24], by_area[24], largest = 0;
    pel_surface_normals(curved.topology, curved.positions, PEL_NORMAL_ANGLE, by_angle);
    pel_surface_normals(curved.topology, curved.positions, PEL_NORMAL_AREA, by_area);
    for (int i = 0; i < 24; i++) {
        assert_near(by_angle[i], (cube[i] > 0 ? 1 : -1) / sqrt(3), 1e-15);
        largest = fmax(largest, fabs(by_area[i] - by_angle[i]));
    }
    assert_true(largest > 0.1);
    for (int v = 0; v < 8; v++)
        assert_near(dot(by_area + 3 * v, by_area + 3 * v), 1, 1e-15);
    check_defect_of_all(curved, pi / 2);
}

/* ---- invariance, degenerate input ---- */

static void test_moves_with_the_body(void **unused)
{
    (void)unused;
    random_state random = {77};
    double r[9];
    random_rotation(&random, r);
    curved_mesh still = make_irregular(5), moved = make_irregular(5);
    for (int32_t v = 0; v < still.mesh->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            moved.mesh->positions[v][i] = 2 * dot(r + 3 * i, still.mesh->positions[v]) + 1e6 * (i + 1);
    for (int32_t v = 0; v < still.mesh->vertex_count; v++) {
        pel_vertex_measure a = measure_of(&still, v), b = measure_of(&moved, v);
        /* coordinates of 3e6 m hold 5e-10 m, in edges of 0.3 m */
        assert_near(b.area, 4 * a.area, 1e-8);
        assert_near(b.mean_curvature, a.mean_curvature / 2, 1e-7);
        assert_near(b.gaussian_curvature, a.gaussian_curvature / 4, 1e-7);
        for (int i = 0; i < 3; i++)
            assert_near(b.normal[i], dot(r + 3 * i, a.normal), 1e-8);
    }
    destroy_mesh(&still);
    destroy_mesh(&moved);
}

/* vertices moved onto their neighbours and onto edges: triangles of no area, in every form */
static void test_degenerate_triangles(void **unused)
{
    (void)unused;
    random_state random = {21};
    for (int round = 0; round < 100; round++) {
        curved_mesh curved = round % 2 == 0 ? make_sphere(3, 1) : finish_mesh(sample_random(&random));
        for (int64_t i = random_integer(&random, 1, 40); i > 0; i--) {
            int32_t *t = curved.mesh->triangles[random_integer(&random, 0, curved.mesh->triangle_count - 1)];
            double *x = curved.mesh->positions[t[0]], part = 0.5 * (double)random_integer(&random, 0, 2);
            for (int c = 0; c < 3; c++)
                x[c] = part * curved.mesh->positions[t[1]][c] + (1 - part) * curved.mesh->positions[t[2]][c];
        }
        for (int32_t v = 0; v < curved.mesh->vertex_count; v++) {
            pel_vertex_measure m = measure_of(&curved, v);
            assert_true(isfinite(m.area) && isfinite(m.mean_curvature) && isfinite(m.gaussian_curvature));
            assert_true(isfinite(dot(m.normal, m.area_vector) + dot(m.mean_curvature_normal, m.normal)));
        }
        pel_mesh_report *report;
        assert_int_equal(pel_mesh_check(curved.mesh, &report, NULL), PEL_OK);
        assert_near(pel_surface_gaussian_curvature(curved.topology, curved.positions, NULL, NULL),
                    2 * pi * report->euler_characteristic, 1e-10);
        pel_mesh_report_destroy(report);
        destroy_mesh(&curved);
    }
}

/* a triangle that is too flat for the parts nearest to its corners is shared out evenly */
static void test_area_of_sliver(void **unused)
{
    (void)unused;
    const int32_t triangle[3] = {0, 1, 2};
    const double height = 0.5 * PEL_FLAT_TRIANGLE, x[9] = {0, 0, 0, 1, 0, 0, 0.3, height, 0};
    double areas[3];
    curved_mesh curved = make_triangles(x, 3, triangle, 1);
    pel_surface_vertex_areas(curved.topology, curved.mesh->positions[0], areas);
    for (int v = 0; v < 3; v++)
        assert_near(areas[v] / height, 1.0 / 6, 1e-12);
    destroy_mesh(&curved);
}

/* a vertex that the mesh does not have changes nothing, nor does a null measure */
static void test_no_vertex(void **unused)
{
    (void)unused;
    curved_mesh curved = make_sphere(1, 1);
    pel_vertex_measure measure = {.area = -7};
    pel_vertex_measure_fill(curved.topology, curved.positions, -1, &measure);
    pel_vertex_measure_fill(curved.topology, curved.positions, curved.mesh->vertex_count, &measure);
    pel_vertex_measure_fill(curved.topology, curved.positions, 0, NULL);
    assert_true(measure.area == -7);
    destroy_mesh(&curved);
}

static void test_arrays_and_summary(void **unused)
{
    (void)unused;
    random_state random = {5};
    curved_mesh curved = finish_mesh(sample_random(&random));
    size_t count = (size_t)curved.mesh->vertex_count;
    double *mean = malloc(sizeof *mean * count), *normals = malloc(3 * sizeof *normals * count);
    double *angle = malloc(3 * sizeof *angle * count), least = (double)HUGE_VAL, greatest = -least;
    pel_curvature_summary summary;
    failing_malloc_begin(0);
    pel_surface_mean_curvature(curved.topology, curved.positions, mean, NULL);
    pel_surface_mean_curvature(curved.topology, curved.positions, NULL, normals);
    pel_surface_normals(curved.topology, curved.positions, PEL_NORMAL_ANGLE, angle);
    pel_surface_curvature_summary(curved.topology, curved.positions, &summary);
    assert_int_equal(failing_malloc_end().calls, 0);
    int32_t inner = 0;
    for (int32_t v = 0; v < curved.mesh->vertex_count; v++) {
        pel_vertex_measure m = measure_of(&curved, v);
        assert_true(mean[v] == m.mean_curvature);
        assert_memory_equal(normals + 3 * v, m.mean_curvature_normal, sizeof m.mean_curvature_normal);
        if (m.boundary) {
            assert_true(mean[v] == 0);
            continue;
        }
        inner++;
        least = fmin(least, mean[v]);
        greatest = fmax(greatest, mean[v]);
    }
    assert_int_equal(summary.inner_vertex_count, inner);
    assert_true(summary.mean_curvature_min == least && summary.mean_curvature_max == greatest);
    assert_near(summary.area / surface_area(&curved), 1, 1e-13);
    free(angle);
    free(normals);
    free(mean);
    destroy_mesh(&curved);
}

/* ---- pressure ---- */

static void add_moment(const double x[3], const double f[3], double moment[3])
{
    for (int i = 0; i < 3; i++)
        moment[i] += x[(i + 1) % 3] * f[(i + 2) % 3] - x[(i + 2) % 3] * f[(i + 1) % 3];
}

static void test_pressure(void **unused)
{
    (void)unused;
    curved_mesh curved = make_irregular(6);
    size_t count = (size_t)curved.mesh->vertex_count;
    double *force = malloc(3 * sizeof *force * count), *paper = malloc(3 * sizeof *paper * count);
    double *size = malloc(sizeof *size * count), *cosine = malloc(sizeof *cosine * count);
    double net[3] = {0}, moment[3] = {0}, paper_net[3] = {0}, sum = 0;
    pel_surface_pressure(curved.topology, curved.positions, 100, PEL_PRESSURE_CONSISTENT, force, NULL, NULL);
    pel_surface_pressure(curved.topology, curved.positions, 100, PEL_PRESSURE_VERTEX_NORMAL, paper, size, cosine);
    for (int32_t v = 0; v < curved.mesh->vertex_count; v++) {
        const double *f = force + 3 * v, *p = paper + 3 * v;
        pel_vertex_measure measure = measure_of(&curved, v);
        for (int c = 0; c < 3; c++) {
            assert_near(f[c], -100 * measure.area_vector[c], 1e-13);
            net[c] += f[c];
            paper_net[c] += p[c];
        }
        add_moment(curved.mesh->positions[v], f, moment);
        /* one direction, inward; the paper's is the longer one */
        assert_near(dot(f, p), sqrt(dot(f, f)) * sqrt(dot(p, p)), 1e-12);
        assert_true(dot(f, measure.normal) < 0 && sqrt(dot(p, p)) > sqrt(dot(f, f)));
        assert_near(size[v], sqrt(dot(p, p)), 1e-13);
        assert_near(cosine[v], p[1] / size[v], 1e-15);
        sum += size[v];
    }
    for (int c = 0; c < 3; c++) {
        assert_near(net[c], 0, 1e-12);
        assert_near(moment[c], 0, 1e-12);
    }
    assert_true(dot(paper_net, paper_net) > 1e-4);
    assert_near(sum, 100 * surface_area(&curved), 1e-10);

    /* no pressure, no direction; suction turns everything around */
    pel_surface_pressure(curved.topology, curved.positions, 0, PEL_PRESSURE_CONSISTENT, NULL, size, cosine);
    assert_true(size[0] == 0 && cosine[0] == 0);
    pel_surface_pressure(curved.topology, curved.positions, -100, PEL_PRESSURE_CONSISTENT, paper, NULL, NULL);
    assert_true(paper[0] == -force[0]);
    free(cosine);
    free(size);
    free(paper);
    free(force);
    destroy_mesh(&curved);
}

/* on a sphere the colour of paper B's figure 2 is -y / r, but for the square of the edge length */
static void test_pressure_direction_on_sphere(void **unused)
{
    (void)unused;
    curved_mesh curved = make_sphere(10, 1);
    double *cosine = malloc(sizeof *cosine * (size_t)curved.mesh->vertex_count);
    pel_surface_pressure(curved.topology, curved.positions, 100, PEL_PRESSURE_CONSISTENT, NULL, NULL, cosine);
    for (int32_t v = 0; v < curved.mesh->vertex_count; v++)
        assert_near(cosine[v], -curved.mesh->positions[v][1], 1e-2);
    free(cosine);
    destroy_mesh(&curved);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_vertex),
        cmocka_unit_test(test_area_of_sliver),
        cmocka_unit_test(test_areas_are_those_of_nearest_points),
        cmocka_unit_test(test_areas_of_obtuse_triangle),
        cmocka_unit_test(test_areas_sum_up),
        cmocka_unit_test(test_mean_curvature_normal),
        cmocka_unit_test(test_sphere_is_exact_along_the_normal),
        cmocka_unit_test(test_sign),
        cmocka_unit_test(test_regular_solids),
        cmocka_unit_test(test_gauss_bonnet),
        cmocka_unit_test(test_real_meshes),
        cmocka_unit_test(test_boundary),
        cmocka_unit_test(test_normals_of_cube),
        cmocka_unit_test(test_moves_with_the_body),
        cmocka_unit_test(test_degenerate_triangles),
        cmocka_unit_test(test_arrays_and_summary),
        cmocka_unit_test(test_pressure),
        cmocka_unit_test(test_pressure_direction_on_sphere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
