#include "failing_malloc.h"
#include "sample.h"

#include "math/vec3.h"
#include "pellicle/mesh_check.h"
#include "pellicle/topology.h"

static pel_mesh_report *check(const pel_mesh *mesh)
{
    pel_mesh_report *report;
    pel_error error;
    assert_int_equal(pel_mesh_check(mesh, &report, &error), PEL_OK);
    return report;
}

static void assert_no_issues_but(const pel_mesh_report *report, pel_issue_kind but)
{
    for (int32_t kind = 0; kind < PEL_ISSUE_COUNT; kind++) {
        if (kind != (int32_t)but && report->issues[kind].count > 0)
            print_error("unexpected %s\n", pel_issue_info_of((pel_issue_kind)kind)->name);
        assert_true(kind == (int32_t)but || report->issues[kind].count == 0);
    }
}

static void test_table(void **unused)
{
    (void)unused;
    for (int32_t kind = 0; kind < PEL_ISSUE_COUNT; kind++) {
        const pel_issue_info *info = pel_issue_info_of((pel_issue_kind)kind);
        assert_int_equal(info->kind, kind);
        assert_true(strlen(info->name) > 0 && strlen(info->doc) > 0 && strlen(info->remedy) > 0);
        assert_true(strchr("vtec", info->element_kind[0]) != NULL);
        /* repairable issues have a remedy, and no others; holes are closed only on request */
        bool advised = strstr(info->remedy, "--fix") != NULL && strstr(info->remedy, "--fill-holes") == NULL;
        assert_int_equal(info->repairable, advised);
    }
    assert_null(pel_issue_info_of(PEL_ISSUE_COUNT));
    assert_int_equal(pel_issue_info_of(PEL_ISSUE_BOUNDARY_EDGE)->severity, PEL_SEVERITY_NOTE);
    assert_int_equal(pel_issue_info_of(PEL_ISSUE_NON_MANIFOLD_EDGE)->severity, PEL_SEVERITY_ERROR);
    pel_mesh_report_destroy(NULL);
}

static void test_sphere_figures(void **unused)
{
    (void)unused;
    pel_mesh *mesh = sample_sphere(5);
    pel_mesh_report *report = check(mesh);
    assert_no_issues_but(report, PEL_ISSUE_COUNT);
    assert_int_equal(report->error_count + report->warning_count, 0);
    assert_int_equal(report->vertex_count, 252);
    assert_int_equal(report->triangle_count, 500);
    assert_int_equal(report->edge_count, 750);
    assert_int_equal(report->euler_characteristic, 2);
    assert_int_equal(report->genus, 0);
    assert_int_equal(report->component_count, 1);
    assert_int_equal(report->boundary_loop_count, 0);
    assert_true(report->closed && report->manifold && report->oriented);
    /* as measured for the sphere of paper A */
    assert_near(report->volume, 4.0972, 5e-5);
    assert_near(report->edge_length_min, 0.198, 5e-4);
    assert_near(report->edge_length_median, 0.245, 5e-4);
    assert_near(report->edge_length_max, 0.262, 5e-4);
    assert_near(report->quality_min, 0.976, 5e-4);
    assert_true(report->quality_mean > report->quality_min && report->quality_mean < 1);
    assert_true(report->edge_length_mean > 0.198 && report->edge_length_mean < 0.262);
    assert_int_equal(report->valence_min, 5);
    assert_int_equal(report->valence_max, 6);
    assert_near(report->valence_mean, 1500.0 / 252, 1e-12);
    for (int i = 0; i < 3; i++) {
        assert_in_range((int)(1000 * report->bounds_high[i]), 960, 1000);
        assert_in_range((int)(-1000 * report->bounds_low[i]), 960, 1000);
    }
    pel_mesh_report_destroy(report);
    pel_mesh_destroy(mesh);
}

/* two triangles apart with edges 3, 4, 5 and 6, 8, 10: an even number of edges has two in the middle */
static int compare_numbers(const void *a, const void *b)
{
    double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

/* the figures of edges against all edges in order: fans of triangles with odd and even numbers of edges */
static void test_edge_figures(void **unused)
{
    (void)unused;
    enum { MOST = 12 };
    for (int32_t count = 1; count < MOST; count++) {
        int32_t triangles[MOST][3], edge_count = 2 * count + 1;
        double lengths[2 * MOST + 1], sum = 0;
        for (int32_t t = 0; t < count; t++) {
            const int32_t corners[3] = {0, t + 1, t + 2};
            memcpy(triangles[t], corners, sizeof corners);
        }
        /* one triangle more, in its own place, makes the number of edges even */
        bool even = count % 2 == 0;
        int32_t triangle_count = count + even, vertex_count = count + 2 + 3 * even;
        if (even) {
            const int32_t corners[3] = {count + 2, count + 3, count + 4};
            memcpy(triangles[count], corners, sizeof corners);
            edge_count += 3;
        }
        pel_mesh *mesh = sample_mesh(vertex_count, triangles[0], triangle_count);
        for (int32_t i = 0, v = 1; i < 2 * count + 1; i++) {
            bool spoke = i <= count;
            v = spoke ? i + 1 : i - count;
            lengths[i] = pel_vec3_distance(mesh->positions[spoke ? 0 : v + 1], mesh->positions[v]);
        }
        for (int32_t i = 0; even && i < 3; i++)
            lengths[2 * count + 1 + i] =
                pel_vec3_distance(mesh->positions[count + 2 + i], mesh->positions[count + 2 + (i + 1) % 3]);
        qsort(lengths, (size_t)edge_count, sizeof *lengths, compare_numbers);
        for (int32_t i = 0; i < edge_count; i++)
            sum += lengths[i];
        pel_mesh_report *report = check(mesh);
        assert_int_equal(report->edge_count, edge_count);
        assert_near(report->edge_length_min, lengths[0], 0);
        assert_near(report->edge_length_max, lengths[edge_count - 1], 0);
        assert_near(report->edge_length_median, (lengths[(edge_count - 1) / 2] + lengths[edge_count / 2]) / 2, 0);
        assert_near(report->edge_length_mean, sum / edge_count, 1e-15);
        pel_mesh_report_destroy(report);
        pel_mesh_destroy(mesh);
    }
}

static void test_even_median(void **unused)
{
    (void)unused;
    const double positions[18] = {0, 0, 0, 3, 0, 0, 0, 4, 0, 0, 0, 1, 6, 0, 1, 0, 8, 1};
    const int32_t triangles[6] = {0, 1, 2, 3, 4, 5};
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions, 6, triangles, 2, &mesh, NULL), PEL_OK);
    pel_mesh_report *report = check(mesh);
    assert_near(report->edge_length_median, 5.5, 1e-15);
    assert_near(report->edge_length_mean, 6, 1e-15);
    assert_near(report->area, 6 + 24, 1e-14);
    pel_mesh_report_destroy(report);
    pel_mesh_destroy(mesh);
}

/* far from the origin the volume keeps its digits */
static void test_volume_far_away(void **unused)
{
    (void)unused;
    pel_mesh *mesh = sample_sphere(3);
    pel_mesh_report *near = check(mesh);
    pel_transform transform = pel_transform_default();
    for (int i = 0; i < 3; i++)
        transform.translation[i] = 1e6;
    assert_int_equal(pel_mesh_transform(mesh, &transform, NULL), PEL_OK);
    pel_mesh_report *far = check(mesh);
    /* the coordinates themselves are rounded by 1e-10 */
    assert_near(far->volume, near->volume, 1e-8);
    pel_mesh_report_destroy(near);
    pel_mesh_report_destroy(far);
    pel_mesh_destroy(mesh);
}

static void test_single_issues(void **unused)
{
    (void)unused;
    static const struct {
        pel_issue_kind kind;
        int32_t count, element, related[2];
        int32_t vertex_count, triangle_count;
        int32_t triangles[24];
    } cases[] = {
        {PEL_ISSUE_BAD_INDEX, 2, 1, {2, 4}, 4, 3, {0, 1, 2, 0, 1, 4, -1, 2, 3}},
        {PEL_ISSUE_REPEATED_VERTEX, 1, 1, {2, -1}, 4, 3, {0, 1, 2, 2, 3, 2, 1, 0, 3}},
        {PEL_ISSUE_DUPLICATE_TRIANGLE, 1, 2, {0, -1}, 5, 3, {0, 1, 2, 2, 3, 4, 1, 2, 0}},
        {PEL_ISSUE_NON_MANIFOLD_EDGE, 1, 0, {0, 1}, 5, 3, {0, 1, 2, 1, 0, 3, 0, 1, 4}},
        {PEL_ISSUE_NON_MANIFOLD_VERTEX, 1, 2, {-1, -1}, 5, 2, {0, 1, 2, 2, 3, 4}},
        {PEL_ISSUE_INCONSISTENT_WINDING, 1, 1, {1, 2}, 4, 2, {0, 1, 2, 1, 2, 3}},
        {PEL_ISSUE_NON_ORIENTABLE, 1, 0, {0, -1}, 5, 5, {0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 0, 4, 4, 0, 1}},
        {PEL_ISSUE_ISOLATED_VERTEX, 1, 3, {-1, -1}, 4, 1, {0, 1, 2}},
        {PEL_ISSUE_BOUNDARY_EDGE, 3, 0, {0, 1}, 3, 1, {0, 1, 2}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int32_t triangles[8][3];
        memcpy(triangles, cases[i].triangles, sizeof triangles);
        pel_mesh *points = sample_mesh(cases[i].vertex_count, (const int32_t[]){0, 0, 0}, 1);
        pel_mesh mesh = {.vertex_count = cases[i].vertex_count,
                         .triangle_count = cases[i].triangle_count,
                         .positions = points->positions,
                         .triangles = triangles};
        pel_mesh_report *report = check(&mesh);
        const pel_issue *issue = &report->issues[cases[i].kind];
        assert_int_equal(issue->count, cases[i].count);
        assert_int_equal(issue->listed_count, cases[i].count);
        assert_int_equal(issue->elements[0], cases[i].element);
        assert_memory_equal(issue->related[0], cases[i].related, sizeof cases[i].related);
        pel_mesh_report_destroy(report);
        pel_mesh_destroy(points);
    }
}

static const int32_t moebius_strip[15] = {0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 0, 4, 4, 0, 1};

static void test_moebius_strip(void **unused)
{
    (void)unused;
    pel_mesh *mesh = sample_mesh(5, moebius_strip, 5);
    pel_mesh_report *report = check(mesh);
    assert_int_equal(report->boundary_loop_count, 1);
    assert_int_equal(report->euler_characteristic, 0);
    assert_int_equal(report->genus, -1);
    assert_int_equal(report->issues[PEL_ISSUE_NON_ORIENTABLE].count, 1);
    assert_true(report->manifold && !report->oriented && !report->closed);
    pel_mesh_report_destroy(report);
    pel_mesh_destroy(mesh);
}

/* a sphere inside out, a torus, an open cylinder: three components of one mesh */
static void test_components(void **unused)
{
    (void)unused;
    const pel_shape_kind kinds[3] = {PEL_SHAPE_GEODESIC_SPHERE, PEL_SHAPE_TORUS, PEL_SHAPE_CYLINDER};
    double(*positions)[3] = malloc(3000 * sizeof *positions);
    int32_t(*triangles)[3] = malloc(6000 * sizeof *triangles), vertex_count = 0, triangle_count = 0, first[3];
    assert_true(positions != NULL && triangles != NULL);
    for (int k = 0; k < 3; k++) {
        pel_shape_def def = pel_shape_def_default(kinds[k]);
        pel_mesh *part;
        def.capped = false;
        assert_int_equal(pel_shape_create(&def, &part, NULL), PEL_OK);
        memcpy(positions + vertex_count, part->positions, (size_t)part->vertex_count * sizeof *positions);
        first[k] = triangle_count;
        for (int32_t t = 0; t < part->triangle_count; t++)
            for (int i = 0; i < 3; i++)
                triangles[triangle_count + t][k == 0 ? 2 - i : i] = part->triangles[t][i] + vertex_count;
        vertex_count += part->vertex_count;
        triangle_count += part->triangle_count;
        pel_mesh_destroy(part);
    }
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions[0], vertex_count, triangles[0], triangle_count, &mesh, NULL), PEL_OK);
    pel_mesh_report *report = check(mesh);
    const pel_mesh_component *components = report->components;
    assert_int_equal(report->component_count, 3);
    assert_int_equal(report->genus, 1);
    assert_int_equal(report->boundary_loop_count, 2);
    const int32_t genus[3] = {0, 1, 0}, euler[3] = {2, 0, 0}, loops[3] = {0, 0, 2};
    for (int k = 0; k < 3; k++) {
        assert_int_equal(components[k].first_triangle, first[k]);
        assert_int_equal(components[k].genus, genus[k]);
        assert_int_equal(components[k].euler_characteristic, euler[k]);
        assert_int_equal(components[k].boundary_loop_count, loops[k]);
        assert_int_equal(components[k].closed, k < 2);
        assert_true(components[k].oriented && components[k].manifold && components[k].orientable);
    }
    assert_true(components[0].volume < -4);
    assert_true(components[1].volume > 1);
    assert_true(components[2].volume == 0);
    assert_near(report->volume, components[0].volume + components[1].volume, 1e-12);
    assert_int_equal(report->issues[PEL_ISSUE_INSIDE_OUT].count, 1);
    assert_int_equal(report->issues[PEL_ISSUE_INSIDE_OUT].elements[0], 0);
    pel_mesh_report_destroy(report);
    pel_mesh_destroy(mesh);
    free(positions);
    free(triangles);
}

static void test_list_is_cut_but_not_the_count(void **unused)
{
    (void)unused;
    enum { COUNT = 3000 };
    static double positions[COUNT][3];
    int32_t triangles[1][3] = {{0, 1, 2}};
    pel_mesh mesh = {.vertex_count = COUNT, .triangle_count = 1, .positions = positions, .triangles = triangles};
    pel_mesh_report *report = check(&mesh);
    assert_int_equal(report->issues[PEL_ISSUE_ISOLATED_VERTEX].count, COUNT - 3);
    assert_int_equal(report->issues[PEL_ISSUE_ISOLATED_VERTEX].listed_count, PEL_ISSUE_LIST_LIMIT);
    assert_int_equal(report->issues[PEL_ISSUE_ISOLATED_VERTEX].elements[PEL_ISSUE_LIST_LIMIT - 1],
                     PEL_ISSUE_LIST_LIMIT + 2);
    assert_int_equal(report->issues[PEL_ISSUE_DUPLICATE_VERTEX].count, COUNT - 1);
    assert_int_equal(report->issues[PEL_ISSUE_ZERO_AREA].count, 1);
    assert_int_equal(report->worst_triangle, 0);
    assert_true(report->quality_min == 0);
    pel_mesh_report_destroy(report);
}

static void test_empty(void **unused)
{
    (void)unused;
    pel_mesh mesh = {0};
    pel_mesh_report *report = check(&mesh);
    assert_no_issues_but(report, PEL_ISSUE_COUNT);
    assert_false(report->closed);
    assert_int_equal(report->worst_triangle, -1);
    pel_mesh_report_destroy(report);
    mesh.triangle_count = -1;
    assert_int_equal(pel_mesh_check(&mesh, &report, NULL), PEL_BAD_ARGUMENT);
    assert_null(report);
}

/* heights around the limit of a triangle without area, in any unit */
static void test_flat_limit(void **unused)
{
    (void)unused;
    for (int power = -9; power <= 9; power += 9) {
        double unit = pow(10, power);
        for (int high = 0; high < 2; high++) {
            double positions[3][3] = {
                {0, 0, 0}, {unit, 0, 0}, {unit / 3, (high ? 2 : 0.5) * PEL_FLAT_TRIANGLE * unit, 0}};
            int32_t triangles[1][3] = {{0, 1, 2}};
            pel_mesh mesh = {.vertex_count = 3, .triangle_count = 1, .positions = positions, .triangles = triangles};
            pel_mesh_report *report = check(&mesh);
            assert_int_equal(report->issues[PEL_ISSUE_ZERO_AREA].count, !high);
            pel_mesh_report_destroy(report);
        }
    }
}

enum { MOST_VERTICES = 8, MOST_TRIANGLES = 8 };

/* findings of a slow and simple check of a small mesh */
typedef struct oracle {
    const pel_mesh *mesh;
    bool skip[MOST_TRIANGLES];
    int32_t counts[PEL_ISSUE_COUNT];
    int32_t edge_count, component_count, loop_count, used_count;
} oracle;

static bool holds(const oracle *it, int32_t t, int32_t v)
{
    const int32_t *corners = it->mesh->triangles[t];
    return !it->skip[t] && (corners[0] == v || corners[1] == v || corners[2] == v);
}

/* 1 = along, -1 = against, 0 = the triangle does not have the edge */
static int direction(const oracle *it, int32_t t, int32_t a, int32_t b)
{
    for (int i = 0; i < 3 && !it->skip[t]; i++) {
        int32_t p = it->mesh->triangles[t][i], q = it->mesh->triangles[t][(i + 1) % 3];
        if (p == a && q == b)
            return 1;
        if (p == b && q == a)
            return -1;
    }
    return 0;
}

static int32_t triangles_on_edge(const oracle *it, int32_t a, int32_t b, int32_t found[MOST_TRIANGLES])
{
    int32_t count = 0;
    for (int32_t t = 0; t < it->mesh->triangle_count; t++)
        if (direction(it, t, a, b) != 0)
            found[count++] = t;
    return count;
}

/* joins by relabelling: count labels, i and j become one */
static void merge(int32_t *labels, int32_t count, int32_t i, int32_t j)
{
    int32_t from = labels[i], to = labels[j];
    for (int32_t k = 0; k < count; k++)
        if (labels[k] == from)
            labels[k] = to;
}

static void oracle_elements(oracle *it)
{
    const pel_mesh *mesh = it->mesh;
    bool used[MOST_VERTICES] = {false}, nan[MOST_VERTICES];
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        nan[v] = isnan(mesh->positions[v][0]);
        it->counts[PEL_ISSUE_NOT_FINITE] += nan[v];
        bool duplicate = false;
        for (int32_t w = 0; w < v; w++)
            duplicate = duplicate || (mesh->positions[v][0] == mesh->positions[w][0] &&
                                      mesh->positions[v][1] == mesh->positions[w][1] &&
                                      mesh->positions[v][2] == mesh->positions[w][2]);
        it->counts[PEL_ISSUE_DUPLICATE_VERTEX] += duplicate;
    }
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        bool bad = false;
        for (int i = 0; i < 3; i++)
            bad = bad || v[i] < 0 || v[i] >= mesh->vertex_count;
        bool repeated = !bad && (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]);
        it->skip[t] = bad || repeated;
        it->counts[PEL_ISSUE_BAD_INDEX] += bad;
        it->counts[PEL_ISSUE_REPEATED_VERTEX] += repeated;
        if (bad)
            continue;
        used[v[0]] = used[v[1]] = used[v[2]] = true;
        if (repeated)
            continue;
        /* whole coordinates: the cross product is exact; in the plane z = 0 only its third part counts */
        const double *a = mesh->positions[v[0]], *b = mesh->positions[v[1]], *c = mesh->positions[v[2]];
        if (!nan[v[0]] && !nan[v[1]] && !nan[v[2]])
            it->counts[PEL_ISSUE_ZERO_AREA] += (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) == 0;
        bool duplicate = false;
        for (int32_t u = 0; u < t; u++)
            duplicate = duplicate || (holds(it, u, v[0]) && holds(it, u, v[1]) && holds(it, u, v[2]));
        it->counts[PEL_ISSUE_DUPLICATE_TRIANGLE] += duplicate;
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        it->counts[PEL_ISSUE_ISOLATED_VERTEX] += !used[v];
}

static void oracle_topology(oracle *it)
{
    const pel_mesh *mesh = it->mesh;
    /* fans are labels of (triangle, vertex); loops join the fans along boundary edges */
    enum { PAIRS = MOST_TRIANGLES * MOST_VERTICES };
    int32_t components[MOST_TRIANGLES], fans[PAIRS], loops[PAIRS], found[MOST_TRIANGLES];
    bool on_boundary[PAIRS] = {false};
    for (int32_t t = 0; t < MOST_TRIANGLES; t++)
        components[t] = t;
    for (int32_t k = 0; k < PAIRS; k++)
        fans[k] = k;
    for (int32_t a = 0; a < mesh->vertex_count; a++) {
        for (int32_t b = a + 1; b < mesh->vertex_count; b++) {
            int32_t count = triangles_on_edge(it, a, b, found);
            it->edge_count += count > 0;
            it->counts[PEL_ISSUE_BOUNDARY_EDGE] += count == 1;
            it->counts[PEL_ISSUE_NON_MANIFOLD_EDGE] += count > 2;
            it->counts[PEL_ISSUE_INCONSISTENT_WINDING] +=
                count == 2 && direction(it, found[0], a, b) == direction(it, found[1], a, b);
            for (int32_t k = 1; k < count; k++) {
                merge(components, MOST_TRIANGLES, found[0], found[k]);
                merge(fans, PAIRS, found[0] * MOST_VERTICES + a, found[k] * MOST_VERTICES + a);
                merge(fans, PAIRS, found[0] * MOST_VERTICES + b, found[k] * MOST_VERTICES + b);
            }
        }
    }
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        it->component_count += !it->skip[t] && components[t] == t;
    /* a label is some member of its set: count the sets of each vertex */
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        int32_t fan_count = 0;
        for (int32_t t = 0; t < mesh->triangle_count; t++)
            fan_count += holds(it, t, v) && fans[t * MOST_VERTICES + v] == t * MOST_VERTICES + v;
        it->counts[PEL_ISSUE_NON_MANIFOLD_VERTEX] += fan_count > 1;
        it->used_count += fan_count > 0;
    }
    memcpy(loops, fans, sizeof loops);
    for (int32_t a = 0; a < mesh->vertex_count; a++) {
        for (int32_t b = a + 1; b < mesh->vertex_count; b++) {
            if (triangles_on_edge(it, a, b, found) != 1)
                continue;
            merge(loops, PAIRS, found[0] * MOST_VERTICES + a, found[0] * MOST_VERTICES + b);
            on_boundary[found[0] * MOST_VERTICES + a] = true;
        }
    }
    bool seen[PAIRS] = {false};
    for (int32_t k = 0; k < PAIRS; k++) {
        if (!on_boundary[k] || seen[loops[k]])
            continue;
        seen[loops[k]] = true;
        it->loop_count++;
    }
    /* a component is orientable when some choice of turned triangles makes every edge of two triangles consistent */
    for (int32_t c = 0; c < mesh->triangle_count; c++) {
        bool orientable = it->skip[c] || components[c] != c;
        for (int32_t turned = 0; turned < 1 << mesh->triangle_count && !orientable; turned++) {
            orientable = true;
            for (int32_t a = 0; a < mesh->vertex_count && orientable; a++) {
                for (int32_t b = a + 1; b < mesh->vertex_count && orientable; b++) {
                    if (triangles_on_edge(it, a, b, found) != 2 || components[found[0]] != c)
                        continue;
                    bool same = direction(it, found[0], a, b) == direction(it, found[1], a, b);
                    orientable = same == ((turned >> found[0] & 1) != (turned >> found[1] & 1));
                }
            }
        }
        it->counts[PEL_ISSUE_NON_ORIENTABLE] += !orientable;
    }
}

static void test_random_against_oracle(void **unused)
{
    (void)unused;
    random_state random = {5};
    int32_t met[PEL_ISSUE_COUNT] = {0};
    for (int round = 0; round < 1000; round++) {
        double positions[MOST_VERTICES][3] = {{0}};
        int32_t triangles[MOST_TRIANGLES][3];
        pel_mesh mesh = {.vertex_count = 3 + random_below(&random, MOST_VERTICES - 2),
                         .triangle_count = 1 + random_below(&random, MOST_TRIANGLES),
                         .positions = positions,
                         .triangles = triangles};
        for (int32_t v = 0; v < mesh.vertex_count; v++) {
            positions[v][0] = random_below(&random, 40);
            positions[v][1] = random_below(&random, 3);
            if (random_below(&random, 30) == 0)
                positions[v][0] = (double)NAN;
        }
        for (int32_t t = 0; t < mesh.triangle_count; t++)
            for (int i = 0; i < 3; i++)
                triangles[t][i] =
                    random_below(&random, 150) == 0 ? 1000 - 2000 * (i % 2) : random_below(&random, mesh.vertex_count);
        /* loose triangles seldom make a one-sided band: put one in now and then */
        if (round % 20 == 0 && mesh.vertex_count >= 5 && mesh.triangle_count >= 5)
            memcpy(triangles, moebius_strip, sizeof moebius_strip);
        oracle it = {.mesh = &mesh};
        oracle_elements(&it);
        oracle_topology(&it);
        pel_mesh_report *report = check(&mesh);
        it.counts[PEL_ISSUE_INSIDE_OUT] = report->issues[PEL_ISSUE_INSIDE_OUT].count;
        for (int32_t kind = 0; kind < PEL_ISSUE_COUNT; kind++) {
            /* the seam of a one-sided surface is not listed: turning triangles would only move it */
            if (kind == PEL_ISSUE_INCONSISTENT_WINDING && it.counts[PEL_ISSUE_NON_ORIENTABLE] > 0) {
                assert_true(report->issues[kind].count <= it.counts[kind]);
                continue;
            }
            if (report->issues[kind].count != it.counts[kind])
                print_error("round %d: %s\n", round, pel_issue_info_of((pel_issue_kind)kind)->name);
            assert_int_equal(report->issues[kind].count, it.counts[kind]);
            met[kind] += it.counts[kind] > 0;
        }
        assert_int_equal(report->edge_count, it.edge_count);
        assert_int_equal(report->component_count, it.component_count);
        assert_int_equal(report->boundary_loop_count, it.loop_count);
        pel_mesh_report_destroy(report);
    }
    for (int32_t kind = 0; kind < PEL_ISSUE_COUNT; kind++)
        assert_true(kind == PEL_ISSUE_INSIDE_OUT || met[kind] > 5);
}

/* the topology takes exactly the meshes without errors of connection */
static void test_agrees_with_topology(void **unused)
{
    (void)unused;
    random_state random = {6};
    int accepted = 0;
    for (int round = 0; round < 5000; round++) {
        int32_t triangles[18], vertex_count = 3 + random_below(&random, 5),
                               triangle_count = 1 + random_below(&random, 5);
        for (int32_t i = 0; i < 3 * triangle_count; i++)
            triangles[i] = random_below(&random, vertex_count);
        pel_mesh *mesh = sample_mesh(vertex_count, triangles, triangle_count);
        pel_topology *topology;
        pel_status status = pel_topology_create(mesh, &topology, NULL);
        pel_mesh_report *report = check(mesh);
        assert_int_equal(status == PEL_OK, report->manifold && report->oriented);
        if (status == PEL_OK) {
            accepted++;
            assert_int_equal(topology->edge_count, report->edge_count);
            assert_int_equal(topology->boundary_edge_count, report->issues[PEL_ISSUE_BOUNDARY_EDGE].count);
        }
        pel_mesh_report_destroy(report);
        pel_topology_destroy(topology);
        pel_mesh_destroy(mesh);
    }
    assert_in_range(accepted, 200, 4800);
}

/* numbers of the table in ../shared/data/README.md */
static void test_shared_meshes(void **unused)
{
    (void)unused;
    static const struct {
        const char *name;
        int32_t vertices, triangles, loops;
        double volume, shortest, median, longest, worst;
    } rows[] = {
        {"liver.obj", 17951, 35898, 0, 0.0021382, 0.000389, 0.00269, 0.00812, 0.148},
        {"liver-coarse.obj", 881, 1758, 0, 0.0021121, 0.00755, 0.0118, 0.017, 0.796},
        {"spleen.obj", 4274, 8544, 0, 0.00019074, 0.000459, 0.00235, 0.00459, 0.442},
        {"gallbladder.obj", 997, 1990, 0, 5.1149e-06, 0.000318, 0.00404, 0.00775, 0.352},
        {"membrane.obj", 6368, 12448, 1, 0, 0.000593, 0.00249, 0.00834, 0.218},
        {"spot.obj", 2930, 5856, 0, 0.71826, 0.00434, 0.0478, 0.119, 0.297},
        {"goat-head.obj", 2763, 5522, 0, 421.74, 0.159, 0.399, 0.667, 0.511},
        {"koala.obj", 3560, 7116, 0, 56.111, 0.079, 0.191, 0.308, 0.474},
        {"cat.obj", 7949, 15894, 0, 1.9817, 0.02, 0.0439, 0.0649, 0.507},
        {"nefertiti-head.obj", 12442, 24880, 0, 1.154e+07, 3.35, 5.77, 8.95, 0.709},
        {"sphere-252.obj", 252, 500, 0, 4.0972, 0.198, 0.245, 0.262, 0.976},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        pel_mesh *mesh = sample_shared(rows[i].name);
        if (mesh == NULL)
            continue;
        pel_mesh_report *report = check(mesh);
        assert_no_issues_but(report, rows[i].loops > 0 ? PEL_ISSUE_BOUNDARY_EDGE : PEL_ISSUE_COUNT);
        assert_int_equal(report->vertex_count, rows[i].vertices);
        assert_int_equal(report->triangle_count, rows[i].triangles);
        assert_int_equal(report->boundary_loop_count, rows[i].loops);
        assert_int_equal(report->genus, 0);
        /* the table has three to five digits */
        assert_near(report->volume / fmax(rows[i].volume, 1e-30), rows[i].volume > 0, 1e-4);
        assert_near(report->edge_length_min / rows[i].shortest, 1, 5e-3);
        assert_near(report->edge_length_median / rows[i].median, 1, 5e-3);
        assert_near(report->edge_length_max / rows[i].longest, 1, 5e-3);
        assert_near(report->quality_min, rows[i].worst, 6e-4);
        pel_mesh_report_destroy(report);
        pel_mesh_destroy(mesh);
    }
}

static pel_status check_case(const void *mesh, pel_error *error)
{
    pel_mesh_report *report;
    pel_status status = pel_mesh_check(mesh, &report, error);
    if (status != PEL_OK)
        assert_null(report);
    pel_mesh_report_destroy(report);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    /* one finding of most kinds */
    static const int32_t triangles[18] = {0, 1, 2, 1, 0, 3, 0, 1, 4, 2, 0, 1, 5, 5, 6, 2, 7, 8};
    pel_mesh *mesh = sample_mesh(10, triangles, 6);
    mesh->positions[9][0] = (double)NAN;
    assert_true(for_every_allocation_failure(check_case, mesh) > 20);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_sphere_figures),
        cmocka_unit_test(test_even_median),
        cmocka_unit_test(test_edge_figures),
        cmocka_unit_test(test_volume_far_away),
        cmocka_unit_test(test_single_issues),
        cmocka_unit_test(test_moebius_strip),
        cmocka_unit_test(test_components),
        cmocka_unit_test(test_list_is_cut_but_not_the_count),
        cmocka_unit_test(test_empty),
        cmocka_unit_test(test_flat_limit),
        cmocka_unit_test(test_random_against_oracle),
        cmocka_unit_test(test_agrees_with_topology),
        cmocka_unit_test(test_shared_meshes),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
