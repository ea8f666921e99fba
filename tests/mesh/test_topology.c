#include "failing_malloc.h"
#include "sample.h"

#include "pellicle/topology.h"

static pel_status topology_of(int32_t vertex_count, const int32_t *triangles, int32_t triangle_count,
                              pel_topology **topology, pel_error *error)
{
    pel_mesh *mesh = sample_mesh(vertex_count, triangles, triangle_count);
    pel_status status = pel_topology_create(mesh, topology, error);
    pel_mesh_destroy(mesh);
    return status;
}

/* -1 = no such half-edge, -2 = several */
static int32_t find_half_edge(const int32_t *triangles, int32_t triangle_count, int32_t from, int32_t to)
{
    int32_t found = -1;
    for (int32_t h = 0; h < 3 * triangle_count; h++)
        if (triangles[h] == from && triangles[pel_half_edge_next(h)] == to)
            found = found == -1 ? h : -2;
    return found;
}

/* quadratic: do the triangles around each vertex form one fan? */
static bool brute_force_vertex(const int32_t *triangles, int32_t triangle_count, int32_t v)
{
    int32_t corner_count = 0, boundary_count = 0, first = -1;
    for (int32_t h = 0; h < 3 * triangle_count; h++) {
        if (triangles[h] != v)
            continue;
        corner_count++;
        bool boundary = find_half_edge(triangles, triangle_count, triangles[pel_half_edge_next(h)], v) < 0;
        boundary_count += boundary;
        if (first < 0 || boundary)
            first = h;
    }
    int32_t visited = 0;
    for (int32_t h = first; h >= 0; visited++) {
        h = find_half_edge(triangles, triangle_count, v, triangles[pel_half_edge_previous(h)]);
        if (h == first) {
            visited++;
            break;
        }
    }
    return visited == corner_count && boundary_count <= 1;
}

static bool brute_force_manifold(const int32_t *triangles, int32_t vertex_count, int32_t triangle_count)
{
    for (int32_t t = 0; t < triangle_count; t++) {
        const int32_t *triangle = triangles + 3 * (size_t)t;
        if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
            return false;
    }
    /* no half-edge twice in the same direction: covers edges with three triangles and opposite winding */
    for (int32_t h = 0; h < 3 * triangle_count; h++)
        if (find_half_edge(triangles, triangle_count, triangles[h], triangles[pel_half_edge_next(h)]) == -2)
            return false;
    for (int32_t v = 0; v < vertex_count; v++)
        if (!brute_force_vertex(triangles, triangle_count, v))
            return false;
    return true;
}

static void check_against_brute_force(const pel_topology *topology)
{
    const int32_t *triangles = topology->triangles[0];
    int32_t triangle_count = topology->triangle_count, edge_count = 0, boundary_count = 0;
    for (int32_t h = 0; h < 3 * triangle_count; h++) {
        int32_t twin = find_half_edge(triangles, triangle_count, pel_half_edge_target(topology, h),
                                      pel_half_edge_origin(topology, h));
        assert_int_equal(topology->twin[h], twin);
        if (twin < 0 || twin > h) {
            assert_int_equal(topology->half_edge_of_edge[edge_count], h);
            assert_int_equal(topology->edge_of_half_edge[h], edge_count);
            edge_count++;
        } else {
            assert_int_equal(topology->edge_of_half_edge[h], topology->edge_of_half_edge[twin]);
        }
        boundary_count += twin < 0;
    }
    assert_int_equal(topology->edge_count, edge_count);
    assert_int_equal(topology->boundary_edge_count, boundary_count);
    for (int32_t v = 0; v < topology->vertex_count; v++) {
        int32_t corner_count = 0, visited = 0, begin = topology->corner_of_vertex[v];
        for (int32_t h = 0; h < 3 * triangle_count; h++)
            corner_count += triangles[h] == v;
        for (int32_t h = begin; h >= 0;) {
            assert_int_equal(pel_half_edge_origin(topology, h), v);
            visited++;
            h = pel_half_edge_turn(topology, h);
            if (h == begin)
                break;
        }
        assert_int_equal(visited, corner_count);
        assert_true((begin < 0) == (corner_count == 0));
    }
}

static void test_tetrahedron(void **unused)
{
    (void)unused;
    static const int32_t tetrahedron[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    pel_topology *topology;
    assert_int_equal(topology_of(4, tetrahedron, 4, &topology, NULL), PEL_OK);
    assert_int_equal(topology->edge_count, 6);
    assert_int_equal(topology->boundary_edge_count, 0);
    check_against_brute_force(topology);
    pel_topology_destroy(topology);
    pel_topology_destroy(NULL);
}

static void test_refusals(void **unused)
{
    (void)unused;
    static const struct {
        const char *kind, *what;
        int64_t element;
        int32_t vertex_count, triangle_count;
        int32_t triangles[24];
    } cases[] = {
        {"edge", "more than two", 0, 5, 3, {0, 1, 2, 1, 0, 3, 0, 1, 4}},
        {"edge", "opposite winding", 1, 4, 2, {0, 1, 2, 1, 2, 3}},
        {"triangle", "twice", 1, 4, 2, {0, 1, 2, 2, 3, 3}},
        {"triangle", "twice", 0, 3, 1, {1, 2, 1}},
        {"vertex", "touch in this vertex", 2, 5, 2, {0, 1, 2, 2, 3, 4}},
        /* tetrahedra that share vertex 0, then an edge */
        {"vertex", "one fan", 0, 7, 8, {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 5, 4, 0, 4, 6, 4, 5, 6, 5, 0, 6}},
        {"edge", "more than two", 2, 6, 8, {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 4, 1, 0, 1, 5, 1, 4, 5, 4, 0, 5}},
        /* the same in an order in which the half-edges of that edge pair up to one turn about each of its ends */
        {"edge", "more than two", 0, 6, 8, {0, 1, 4, 0, 3, 1, 0, 1, 2, 0, 5, 1, 0, 2, 3, 0, 4, 5, 1, 3, 2, 1, 5, 4}},
        /* Moebius strip of five triangles */
        {"edge", "opposite winding", 0, 5, 5, {0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 0, 4, 4, 0, 1}},
    };
    const size_t moebius = sizeof cases / sizeof *cases - 1;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pel_topology *topology;
        pel_error error;
        assert_int_equal(
            topology_of(cases[i].vertex_count, cases[i].triangles, cases[i].triangle_count, &topology, &error),
            PEL_BAD_MESH);
        assert_null(topology);
        assert_string_equal(error.element_kind, cases[i].kind);
        assert_int_equal(error.element, cases[i].element);
        assert_non_null(strstr(error.what, cases[i].what));
        /* repair cannot help a surface with one side */
        assert_non_null(strstr(error.remedy, i == moebius ? "one side only" : "pellicle check"));
    }
}

static void test_bad_index(void **unused)
{
    (void)unused;
    int32_t triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
    double positions[4][3] = {{0}};
    pel_mesh mesh = {.vertex_count = 3, .triangle_count = 2, .positions = positions, .triangles = triangles};
    pel_topology *topology;
    pel_error error;
    assert_int_equal(pel_topology_create(&mesh, &topology, &error), PEL_BAD_MESH);
    assert_int_equal(error.element, 1);
    triangles[0][1] = -1;
    assert_int_equal(pel_topology_create(&mesh, &topology, &error), PEL_BAD_MESH);
    assert_int_equal(error.element, 0);
    mesh.triangle_count = 0;
    assert_int_equal(pel_topology_create(&mesh, &topology, &error), PEL_BAD_ARGUMENT);
    assert_null(topology);
}

/* few triangles on few vertices: manifolds and every kind of other thing */
static void test_random_triangles(void **unused)
{
    (void)unused;
    int accepted = 0;
    random_state random = {1};
    for (int round = 0; round < 8000; round++) {
        int32_t triangles[18];
        int32_t vertex_count = 3 + random_below(&random, 6), triangle_count = 1 + random_below(&random, 6);
        for (int32_t i = 0; i < 3 * triangle_count; i++)
            triangles[i] = random_below(&random, vertex_count);
        pel_topology *topology;
        pel_status status = topology_of(vertex_count, triangles, triangle_count, &topology, NULL);
        assert_int_equal(status == PEL_OK, brute_force_manifold(triangles, vertex_count, triangle_count));
        if (status == PEL_OK) {
            accepted++;
            check_against_brute_force(topology);
        }
        pel_topology_destroy(topology);
    }
    assert_in_range(accepted, 500, 7500);
}

/* random pieces of a sphere with vertices and triangles renumbered */
static void test_random_patches(void **unused)
{
    (void)unused;
    pel_mesh *sphere = sample_sphere(2);
    int accepted = 0;
    random_state random = {2};
    for (int round = 0; round < 2000; round++) {
        int32_t triangles[240], triangle_count = 0, shift = random_below(&random, 42), dropped = round % 10;
        for (int32_t t = 0; t < sphere->triangle_count; t++)
            for (int i = 0; i < 3; i++)
                triangles[3 * t + i] = (sphere->triangles[t][i] * 5 + shift) % 42;
        triangle_count = sphere->triangle_count;
        while (dropped-- > 0) {
            int32_t t = random_below(&random, triangle_count--);
            memmove(triangles + 3 * t, triangles + 3 * triangle_count, 3 * sizeof *triangles);
        }
        if (round % 17 == 0) {
            int32_t first = triangles[0];
            triangles[0] = triangles[1];
            triangles[1] = first;
        }
        pel_topology *topology;
        pel_status status = topology_of(42, triangles, triangle_count, &topology, NULL);
        assert_int_equal(status == PEL_OK, brute_force_manifold(triangles, 42, triangle_count));
        if (status == PEL_OK) {
            accepted++;
            check_against_brute_force(topology);
        }
        pel_topology_destroy(topology);
    }
    assert_in_range(accepted, 500, 1900);
    pel_mesh_destroy(sphere);
}

static void test_sphere_and_isolated_vertex(void **unused)
{
    (void)unused;
    pel_mesh *mesh = sample_sphere(5);
    pel_topology *topology;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    assert_int_equal(mesh->vertex_count - topology->edge_count + mesh->triangle_count, 2);
    check_against_brute_force(topology);
    pel_topology_destroy(topology);
    pel_mesh_destroy(mesh);
    static const int32_t triangle[3] = {3, 0, 2};
    assert_int_equal(topology_of(4, triangle, 1, &topology, NULL), PEL_OK);
    assert_int_equal(topology->corner_of_vertex[1], -1);
    assert_int_equal(topology->boundary_edge_count, 3);
    pel_topology_destroy(topology);
}

/* a cone of many triangles in random order: the fast path fails, the slow one gives the same table */
static void test_many_about_a_vertex(void **unused)
{
    (void)unused;
    enum { COUNT = 900 };
    random_state random = {3};
    int32_t triangles[3 * COUNT];
    for (int32_t t = 0; t < COUNT; t++) {
        triangles[3 * t] = 0;
        triangles[3 * t + 1] = 1 + t;
        triangles[3 * t + 2] = 1 + (t + 1) % COUNT;
    }
    for (int32_t t = COUNT - 1; t > 0; t--) {
        int32_t other = random_below(&random, t + 1), kept[3];
        memcpy(kept, triangles + 3 * t, sizeof kept);
        memmove(triangles + 3 * t, triangles + 3 * other, sizeof kept);
        memcpy(triangles + 3 * other, kept, sizeof kept);
    }
    pel_topology *topology;
    assert_int_equal(topology_of(COUNT + 1, triangles, COUNT, &topology, NULL), PEL_OK);
    assert_int_equal(topology->boundary_edge_count, COUNT);
    check_against_brute_force(topology);
    pel_topology_destroy(topology);
}

static pel_status create_case(const void *mesh, pel_error *error)
{
    pel_topology *topology;
    pel_status status = pel_topology_create(mesh, &topology, error);
    if (status != PEL_OK)
        assert_null(topology);
    pel_topology_destroy(topology);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    pel_mesh *mesh = sample_sphere(2);
    assert_true(for_every_allocation_failure(create_case, mesh) > 8);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tetrahedron),         cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_bad_index),           cmocka_unit_test(test_random_triangles),
        cmocka_unit_test(test_random_patches),      cmocka_unit_test(test_sphere_and_isolated_vertex),
        cmocka_unit_test(test_many_about_a_vertex), cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
