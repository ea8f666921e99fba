#include "failing_malloc.h"
#include "sample.h"

#include "pellicle/subdivide.h"

/* rounding of sums over rings of up to 1000 neighbours, in a box of size 2 */
static const double tolerance = 1e-14;

/* the oracle: stencils from a list of triangles by search, weights straight from the theory page */

/* (vertex_count x vertex_count) the half-edge from one vertex to the other, -1 = none */
static int32_t *half_edge_table;

static void build_half_edge_table(const pel_mesh *mesh)
{
    size_t count = (size_t)mesh->vertex_count;
    half_edge_table = malloc(count * count * sizeof *half_edge_table);
    assert_non_null(half_edge_table);
    memset(half_edge_table, -1, count * count * sizeof *half_edge_table);
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            half_edge_table[(size_t)mesh->triangles[t][i] * count + (size_t)mesh->triangles[t][(i + 1) % 3]] =
                3 * t + i;
}

static int32_t find_half_edge(const pel_mesh *mesh, int32_t from, int32_t to)
{
    return half_edge_table[(size_t)from * (size_t)mesh->vertex_count + (size_t)to];
}

static int32_t tip_of(const pel_mesh *mesh, int32_t h)
{
    return mesh->triangles[h / 3][(h % 3 + 2) % 3];
}

static void add_vertex(const pel_mesh *mesh, double weight, int32_t v, double point[3])
{
    for (int i = 0; i < 3; i++)
        point[i] += weight * mesh->positions[v][i];
}

/* the ring of v from neighbour `first`, counter-clockwise; 0 when v is on the boundary */
static int32_t ring_of(const pel_mesh *mesh, int32_t v, int32_t first, int32_t *ring)
{
    int32_t size = 0, w = first;
    do {
        int32_t h = find_half_edge(mesh, v, w);
        if (h < 0)
            return 0;
        ring[size++] = w;
        w = tip_of(mesh, h);
    } while (w != first);
    return size;
}

static void add_ring_rule(const pel_mesh *mesh, double weight, int32_t v, const int32_t *ring, int32_t size,
                          double point[3])
{
    add_vertex(mesh, weight * 0.75, v, point);
    for (int32_t j = 0; j < size; j++) {
        double s;
        if (size == 3)
            s = j == 0 ? 5.0 / 12 : -1.0 / 12;
        else if (size == 4)
            s = j == 0 ? 3.0 / 8 : j == 2 ? -1.0 / 8 : 0;
        else
            s = (0.25 + cos(6.283185307179586 * j / size) + 0.5 * cos(12.566370614359172 * j / size)) / size;
        add_vertex(mesh, weight * s, ring[j], point);
    }
}

static void add_outer_tip(const pel_mesh *mesh, int32_t p, int32_t q, int32_t r, double point[3])
{
    int32_t h = find_half_edge(mesh, q, p);
    if (h >= 0) {
        add_vertex(mesh, -1.0 / 16, tip_of(mesh, h), point);
        return;
    }
    add_vertex(mesh, -1.0 / 16, p, point);
    add_vertex(mesh, -1.0 / 16, q, point);
    add_vertex(mesh, 1.0 / 16, r, point);
}

static void add_side(const pel_mesh *mesh, int32_t a, int32_t b, double point[3])
{
    int32_t tip = tip_of(mesh, find_half_edge(mesh, a, b));
    add_vertex(mesh, 0.5, a, point);
    add_vertex(mesh, 0.125, tip, point);
    add_outer_tip(mesh, b, tip, a, point);
    add_outer_tip(mesh, tip, a, b, point);
}

static void add_boundary_rule(const pel_mesh *mesh, int32_t a, int32_t b, double point[3])
{
    add_vertex(mesh, 9.0 / 16, a, point);
    add_vertex(mesh, 9.0 / 16, b, point);
    for (int32_t h = 0; h < 3 * mesh->triangle_count; h++) {
        int32_t from = mesh->triangles[h / 3][h % 3], to = mesh->triangles[h / 3][(h % 3 + 1) % 3];
        if (find_half_edge(mesh, to, from) >= 0)
            continue;
        if (to == a)
            add_vertex(mesh, -1.0 / 16, from, point);
        if (from == b)
            add_vertex(mesh, -1.0 / 16, to, point);
    }
}

static void edge_point(const pel_mesh *mesh, int32_t a, int32_t b, double point[3])
{
    static int32_t ring_a[4096], ring_b[4096];
    memset(point, 0, 3 * sizeof *point);
    if (find_half_edge(mesh, b, a) < 0) {
        add_boundary_rule(mesh, a, b, point);
        return;
    }
    int32_t size_a = ring_of(mesh, a, b, ring_a), size_b = ring_of(mesh, b, a, ring_b);
    bool irregular_a = size_a > 0 && size_a != 6, irregular_b = size_b > 0 && size_b != 6;
    if (irregular_a)
        add_ring_rule(mesh, irregular_b ? 0.5 : 1, a, ring_a, size_a, point);
    if (irregular_b)
        add_ring_rule(mesh, irregular_a ? 0.5 : 1, b, ring_b, size_b, point);
    if (!irregular_a && !irregular_b) {
        add_side(mesh, a, b, point);
        add_side(mesh, b, a, point);
    }
}

/* one level of `mesh` against the oracle: positions, numbering and triangles */
static void check_against_oracle(const pel_mesh *mesh)
{
    pel_mesh *fine;
    build_half_edge_table(mesh);
    assert_int_equal(pel_mesh_subdivide(mesh, 1, &fine, NULL), PEL_OK);
    assert_memory_equal(fine->positions, mesh->positions, (size_t)mesh->vertex_count * 3 * sizeof(double));
    int32_t *edge = malloc(3 * (size_t)mesh->triangle_count * sizeof *edge), edge_count = 0;
    for (int32_t h = 0; h < 3 * mesh->triangle_count; h++) {
        int32_t a = mesh->triangles[h / 3][h % 3], b = mesh->triangles[h / 3][(h % 3 + 1) % 3];
        int32_t g = find_half_edge(mesh, b, a);
        if (g >= 0 && g < h) {
            edge[h] = edge[g];
            continue;
        }
        edge[h] = mesh->vertex_count + edge_count++;
        double point[3];
        edge_point(mesh, a, b, point);
        for (int i = 0; i < 3; i++)
            assert_near(fine->positions[edge[h]][i], point[i], tolerance);
    }
    assert_int_equal(fine->vertex_count, mesh->vertex_count + edge_count);
    assert_int_equal(fine->triangle_count, 4 * mesh->triangle_count);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *corner = mesh->triangles[t], *middle = edge + 3 * t;
        const int32_t expected[4][3] = {{corner[0], middle[0], middle[2]},
                                        {corner[1], middle[1], middle[0]},
                                        {corner[2], middle[2], middle[1]},
                                        {middle[0], middle[1], middle[2]}};
        assert_memory_equal(fine->triangles[4 * t], expected, sizeof expected);
    }
    free(edge);
    free(half_edge_table);
    pel_mesh_destroy(fine);
}

static void test_rings_against_oracle(void **unused)
{
    (void)unused;
    random_state random = {21};
    for (int32_t valence = 3; valence <= 1000; valence = valence < 20 ? valence + 1 : 2 * valence) {
        for (int closed = 0; closed < 2; closed++) {
            pel_mesh *mesh = sample_ring(valence, closed, &random);
            check_against_oracle(mesh);
            pel_mesh_destroy(mesh);
        }
    }
    pel_mesh *mesh = sample_ring(1000, true, &random);
    check_against_oracle(mesh);
    pel_mesh_destroy(mesh);
}

static void test_random_meshes_against_oracle(void **unused)
{
    (void)unused;
    random_state random = {22};
    for (int trial = 0; trial < 60; trial++) {
        pel_mesh *mesh = sample_random(&random), *fine;
        check_against_oracle(mesh);
        if (trial % 10 == 0) {
            assert_int_equal(pel_mesh_subdivide(mesh, 1, &fine, NULL), PEL_OK);
            check_against_oracle(fine);
            pel_mesh_destroy(fine);
        }
        pel_mesh_destroy(mesh);
    }
}

static void assert_has_vertex(const pel_mesh *mesh, double x, double y, double z)
{
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->positions[v];
        if (fabs(p[0] - x) + fabs(p[1] - y) + fabs(p[2] - z) < 1e-15)
            return;
    }
    fail_msg("no vertex at (%g, %g, %g)", x, y, z);
}

static void test_hand_anchors(void **unused)
{
    (void)unused;
    pel_mesh *mesh = sample_tetrahedron(), *fine;
    assert_int_equal(pel_mesh_subdivide(mesh, 1, &fine, NULL), PEL_OK);
    assert_has_vertex(fine, 4.0 / 3, 0, 0);
    pel_mesh_destroy(fine);
    pel_mesh_destroy(mesh);
    mesh = sample_octahedron();
    assert_int_equal(pel_mesh_subdivide(mesh, 1, &fine, NULL), PEL_OK);
    assert_has_vertex(fine, 0.625, 0.625, 0);
    pel_mesh_destroy(fine);
    pel_mesh_destroy(mesh);
}

static void radius_range(const pel_mesh *mesh, double *least, double *greatest)
{
    *least = HUGE_VAL;
    *greatest = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->positions[v];
        double radius = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        *least = fmin(*least, radius);
        *greatest = fmax(*greatest, radius);
    }
}

/* theory page section 15 */
static void test_sphere_quality(void **unused)
{
    (void)unused;
    static const double fine_least[3] = {0.999101, 0.999017, 0.998972};
    static const double coarse_least[4] = {0.968208, 0.961959, 0.959269, 0.958668};
    double least, greatest;
    pel_mesh *sphere = sample_sphere(5), *icosahedron = sample_sphere(1), *fine;
    for (int32_t levels = 1; levels <= 4; levels++) {
        assert_int_equal(pel_mesh_subdivide(icosahedron, levels, &fine, NULL), PEL_OK);
        radius_range(fine, &least, &greatest);
        assert_near(least, coarse_least[levels - 1], 5e-7);
        assert_near(greatest, 1, 1e-15);
        pel_mesh_destroy(fine);
        if (levels == 4)
            break;
        assert_int_equal(pel_mesh_subdivide(sphere, levels, &fine, NULL), PEL_OK);
        assert_int_equal(fine->triangle_count, 500 << (2 * levels));
        assert_int_equal(fine->vertex_count, 2 + fine->triangle_count / 2);
        radius_range(fine, &least, &greatest);
        assert_near(least, fine_least[levels - 1], 5e-7);
        assert_near(greatest, 1.000686, 5e-7);
        pel_mesh_destroy(fine);
    }
    pel_mesh_destroy(icosahedron);
    pel_mesh_destroy(sphere);
}

/* on a regular plane the new vertices are the midpoints, near the boundary too; on it only off the corners */
static void test_linear_precision(void **unused)
{
    (void)unused;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    def.nx = 9;
    def.ny = 6;
    pel_mesh *mesh, *fine;
    pel_topology *topology;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    assert_int_equal(pel_mesh_subdivide(mesh, 1, &fine, NULL), PEL_OK);
    int32_t inner = 0, bent = 0;
    for (int32_t e = 0; e < topology->edge_count; e++) {
        int32_t h = topology->half_edge_of_edge[e];
        const double *a = mesh->positions[pel_half_edge_origin(topology, h)];
        const double *b = mesh->positions[pel_half_edge_target(topology, h)];
        double worst = 0;
        for (int i = 0; i < 3; i++)
            worst = fmax(worst, fabs(fine->positions[mesh->vertex_count + e][i] - 0.5 * (a[i] + b[i])));
        if (topology->twin[h] >= 0) {
            assert_near(worst, 0, 1e-15);
            inner++;
        } else {
            bent += worst > 1e-15;
        }
    }
    assert_int_equal(inner, topology->edge_count - topology->boundary_edge_count);
    assert_int_equal(bent, 8);
    pel_topology_destroy(topology);
    pel_mesh_destroy(fine);
    pel_mesh_destroy(mesh);
}

/* a moved and turned mesh gives the moved and turned result */
static void test_rigid_motion(void **unused)
{
    (void)unused;
    random_state random = {23};
    for (int trial = 0; trial < 20; trial++) {
        pel_mesh *mesh = sample_random(&random), *moved, *fine, *fine_moved;
        double r[9];
        const double shift[3] = {10, -20, 30};
        random_rotation(&random, r);
        moved = sample_create((const double(*)[3])mesh->positions, mesh->vertex_count,
                              (const int32_t(*)[3])mesh->triangles, mesh->triangle_count);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            for (int i = 0; i < 3; i++) {
                const double *p = mesh->positions[v];
                moved->positions[v][i] = shift[i] + r[3 * i] * p[0] + r[3 * i + 1] * p[1] + r[3 * i + 2] * p[2];
            }
        assert_int_equal(pel_mesh_subdivide(mesh, 2, &fine, NULL), PEL_OK);
        assert_int_equal(pel_mesh_subdivide(moved, 2, &fine_moved, NULL), PEL_OK);
        for (int32_t v = 0; v < fine->vertex_count; v++)
            for (int i = 0; i < 3; i++) {
                const double *p = fine->positions[v];
                assert_near(fine_moved->positions[v][i],
                            shift[i] + r[3 * i] * p[0] + r[3 * i + 1] * p[1] + r[3 * i + 2] * p[2], 1e-13);
            }
        pel_mesh_destroy(fine_moved);
        pel_mesh_destroy(fine);
        pel_mesh_destroy(moved);
        pel_mesh_destroy(mesh);
    }
}

/* fields of any width go by the same stencils; clamped ones keep their range */
static void test_fields(void **unused)
{
    (void)unused;
    random_state random = {24};
    pel_mesh *mesh = sample_random(&random), *fine, *clamped;
    size_t count = (size_t)mesh->vertex_count;
    double *two = calloc(2 * count, sizeof *two), *one = calloc(count, sizeof *one);
    for (size_t v = 0; v < count; v++) {
        two[2 * v] = one[v] = mesh->positions[v][1];
        two[2 * v + 1] = (double)(random_bits(&random) % 2);
    }
    assert_int_equal(pel_mesh_add_field(mesh, "position", 3, mesh->positions[0], NULL), PEL_OK);
    assert_int_equal(pel_mesh_add_field(mesh, "two", 2, two, NULL), PEL_OK);
    assert_int_equal(pel_mesh_add_field(mesh, "one", 1, one, NULL), PEL_OK);
    pel_subdivide_def def = pel_subdivide_def_default();
    def.levels = 2;
    assert_int_equal(pel_mesh_subdivide_with(mesh, &def, &clamped, NULL), PEL_OK);
    def.clamp_fields = false;
    assert_int_equal(pel_mesh_subdivide_with(mesh, &def, &fine, NULL), PEL_OK);
    bool left_range = false;
    for (int32_t v = 0; v < fine->vertex_count; v++) {
        assert_memory_equal(fine->positions[v], pel_mesh_field(fine, "position")->values + 3 * v, 3 * sizeof(double));
        assert_near(pel_mesh_field(fine, "two")->values[2 * v], fine->positions[v][1], 0);
        assert_near(pel_mesh_field(fine, "one")->values[v], fine->positions[v][1], 0);
        double weight = pel_mesh_field(fine, "two")->values[2 * v + 1];
        left_range |= weight < 0 || weight > 1;
        weight = pel_mesh_field(clamped, "two")->values[2 * v + 1];
        assert_true(weight >= 0 && weight <= 1);
    }
    assert_true(left_range);
    assert_memory_equal(fine->positions, clamped->positions, (size_t)fine->vertex_count * sizeof *fine->positions);
    free(two);
    free(one);
    pel_mesh_destroy(clamped);
    pel_mesh_destroy(fine);
    pel_mesh_destroy(mesh);
}

static void test_levels(void **unused)
{
    (void)unused;
    pel_mesh *mesh = sample_sphere(2), *once, *twice, *both, *none;
    assert_int_equal(pel_mesh_subdivide(mesh, 0, &none, NULL), PEL_OK);
    assert_int_equal(none->triangle_count, mesh->triangle_count);
    assert_memory_equal(none->triangles, mesh->triangles, (size_t)mesh->triangle_count * sizeof *mesh->triangles);
    assert_int_equal(pel_mesh_subdivide(mesh, 1, &once, NULL), PEL_OK);
    assert_int_equal(pel_mesh_subdivide(once, 1, &twice, NULL), PEL_OK);
    assert_int_equal(pel_mesh_subdivide(mesh, 2, &both, NULL), PEL_OK);
    assert_int_equal(twice->vertex_count, both->vertex_count);
    assert_memory_equal(twice->triangles, both->triangles, (size_t)both->triangle_count * sizeof *both->triangles);
    assert_memory_equal(twice->positions, both->positions, (size_t)both->vertex_count * sizeof *both->positions);
    pel_mesh_destroy(both);
    pel_mesh_destroy(twice);
    pel_mesh_destroy(once);
    pel_mesh_destroy(none);
    pel_mesh_destroy(mesh);
}

/* a pillow: two triangles back to back, three vertices with a ring of two */
static void test_smallest_meshes(void **unused)
{
    (void)unused;
    static const double positions[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static const int32_t triangles[2][3] = {{0, 1, 2}, {2, 1, 0}};
    for (int32_t count = 1; count <= 2; count++) {
        pel_mesh *mesh = sample_create(positions, 3, triangles, count), *fine;
        assert_int_equal(pel_mesh_subdivide(mesh, 3, &fine, NULL), PEL_OK);
        for (int32_t v = 0; v < fine->vertex_count; v++)
            for (int i = 0; i < 3; i++)
                assert_true(fabs(fine->positions[v][i]) < 2);
        pel_mesh_destroy(fine);
        pel_mesh_destroy(mesh);
    }
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_mesh *mesh = sample_sphere(5), *fine = mesh;
    pel_error error;
    assert_int_equal(pel_mesh_subdivide(mesh, -1, &fine, &error), PEL_BAD_ARGUMENT);
    assert_null(fine);
    assert_int_equal(pel_mesh_subdivide(mesh, 30, &fine, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.remedy, "at most"));
    pel_subdivide_def def = pel_subdivide_def_default();
    def.levels = 30;
    def.memory_limit = 0;
    assert_int_equal(pel_mesh_subdivide_with(mesh, &def, &fine, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.remedy, "at most 10 times"));
    def.levels = 3;
    def.memory_limit = 1 << 20;
    assert_int_equal(pel_mesh_subdivide_with(mesh, &def, &fine, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "32000 triangles"));
    def.levels = 1;
    assert_int_equal(pel_mesh_subdivide_with(mesh, &def, &fine, &error), PEL_OK);
    pel_mesh_destroy(fine);
    def.cookie = 0;
    assert_int_equal(pel_mesh_subdivide_with(mesh, &def, &fine, &error), PEL_BAD_ARGUMENT);
    pel_mesh_destroy(mesh);
    static const double positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}};
    static const int32_t wrong[2][3] = {{0, 1, 2}, {0, 1, 3}};
    mesh = sample_create(positions, 4, wrong, 2);
    assert_int_equal(pel_mesh_subdivide(mesh, 1, &fine, &error), PEL_BAD_MESH);
    assert_null(fine);
    pel_mesh_destroy(mesh);
}

static pel_status subdivide_case(const void *mesh, pel_error *error)
{
    pel_mesh *fine = (pel_mesh *)1;
    pel_status status = pel_mesh_subdivide(mesh, 2, &fine, error);
    assert_true((status == PEL_OK) == (fine != NULL));
    pel_mesh_destroy(fine);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    random_state random = {25};
    pel_mesh *mesh = sample_random(&random);
    assert_int_equal(pel_mesh_add_field(mesh, "two", 2, NULL, NULL), PEL_OK);
    assert_true(for_every_allocation_failure(subdivide_case, mesh) > 10);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rings_against_oracle),
        cmocka_unit_test(test_random_meshes_against_oracle),
        cmocka_unit_test(test_hand_anchors),
        cmocka_unit_test(test_sphere_quality),
        cmocka_unit_test(test_linear_precision),
        cmocka_unit_test(test_rigid_motion),
        cmocka_unit_test(test_fields),
        cmocka_unit_test(test_levels),
        cmocka_unit_test(test_smallest_meshes),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
