/* Filling closed surfaces with tetrahedra: exact boxes, volumes, dihedral angles, the surface around, and refusals. */
#include "check.h"
#include "failing_malloc.h"

#include "math/vec3.h"
#include "pellicle/measure.h"
#include "pellicle/shape.h"
#include "pellicle/topology.h"
#include "pellicle/volume.h"

static pel_mesh *make_box(double x, double y, double z)
{
    const double points[8][3] = {{0, 0, 0}, {x, 0, 0}, {x, y, 0}, {0, y, 0},
                                 {0, 0, z}, {x, 0, z}, {x, y, z}, {0, y, z}};
    static const int32_t triangles[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                             {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(points[0], 8, triangles[0], 12, &mesh, NULL), PEL_OK);
    return mesh;
}

static pel_mesh *make_shape(pel_shape_kind kind)
{
    pel_shape_def def = pel_shape_def_default(kind);
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

static double surface_volume(const pel_mesh *mesh)
{
    return pel_surface_volume(mesh->positions[0], mesh->triangles[0], mesh->triangle_count, NULL);
}

static void load(const pel_mesh *mesh, int32_t t, double x[4][3])
{
    for (int k = 0; k < 4; k++)
        pel_vec3_copy(mesh->positions[mesh->tetrahedra[t][k]], x[k]);
}

/* degrees, between the faces at the edge a b */
static double angle_at(const double x[4][3], int a, int b, int c, int d)
{
    double edge[3], first[3], second[3];
    pel_vec3_subtract(x[b], x[a], edge);
    pel_vec3_subtract(x[c], x[a], first);
    pel_vec3_subtract(x[d], x[a], second);
    const double square = pel_vec3_dot(edge, edge);
    pel_vec3_along(first, -pel_vec3_dot(first, edge) / square, edge, first);
    pel_vec3_along(second, -pel_vec3_dot(second, edge) / square, edge, second);
    return acos(pel_vec3_dot(first, second) / (pel_vec3_length(first) * pel_vec3_length(second))) * 57.29577951308232;
}

static const int sides[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};

/* tetrahedra without a vertex on the surface are those of the body-centred lattice: angles of 60 and 90 degrees */
static void check_inside(const pel_mesh *mesh, int32_t surface_count)
{
    int count = 0;
    for (int32_t t = 0; t < mesh->tetrahedron_count; t++) {
        const int32_t *v = mesh->tetrahedra[t];
        double x[4][3];
        bool is_inside = true;
        for (int k = 0; k < 4; k++)
            is_inside &= v[k] >= surface_count;
        load(mesh, t, x);
        for (int i = 0; is_inside && i < 6; i++) {
            double angle = angle_at((const double(*)[3])x, sides[i][0], sides[i][1], sides[i][2], sides[i][3]);
            assert_near(fmin(fabs(angle - 60), fabs(angle - 90)), 0, 0.5);
        }
        count += is_inside;
    }
    assert_true(count > 100);
}

typedef struct figures {
    double volume, least_angle, most_angle;
    int32_t surface_count; /* vertices in triangles */
} figures;

/* whole: positive tetrahedra that fill the surface, vertices of which come first */
static figures check_whole(const pel_mesh *mesh)
{
    figures found = {.least_angle = 180};
    for (int32_t t = 0; t < mesh->tetrahedron_count; t++) {
        double x[4][3];
        load(mesh, t, x);
        const double volume = pel_tetrahedron_volume((const double(*)[3])x);
        assert_true(volume > 0);
        found.volume += volume;
        for (int i = 0; i < 6; i++) {
            const double angle = angle_at((const double(*)[3])x, sides[i][0], sides[i][1], sides[i][2], sides[i][3]);
            found.least_angle = fmin(found.least_angle, angle);
            found.most_angle = fmax(found.most_angle, angle);
        }
    }
    pel_topology *topology;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    assert_int_equal(topology->boundary_edge_count, 0);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        if (topology->corner_of_vertex[v] >= 0)
            assert_int_equal(found.surface_count++, v);
    }
    pel_topology_destroy(topology);
    assert_near(surface_volume(mesh), found.volume, 1e-12 * found.volume);
    return found;
}

static pel_mesh *fill(const pel_mesh *surface, double edge)
{
    pel_mesh *filled;
    pel_error error;
    char text[800];
    pel_status status = pel_mesh_fill(surface, edge, &filled, &error);
    if (status != PEL_OK)
        print_error("%s\n", pel_error_text(&error, text, sizeof text));
    assert_int_equal(status, PEL_OK);
    return filled;
}

static void boxes_are_exact(void **state)
{
    (void)state;
    pel_mesh *box = make_box(1, 0.7, 2.3);
    static const double edges[] = {0.1, 0.25, 0.33, 0.7, 5};
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++) {
        pel_mesh *filled = fill(box, edges[i]);
        const figures found = check_whole(filled);
        assert_near(found.volume, 1 * 0.7 * 2.3, 1e-12);
        int corners = 0;
        for (int32_t v = 0; v < found.surface_count; v++) {
            const double *x = filled->positions[v];
            const double off[3] = {fmin(fabs(x[0]), fabs(x[0] - 1)), fmin(fabs(x[1]), fabs(x[1] - 0.7)),
                                   fmin(fabs(x[2]), fabs(x[2] - 2.3))};
            assert_near(fmin(off[0], fmin(off[1], off[2])), 0, 1e-12);
            corners += off[0] + off[1] + off[2] < 1e-12;
        }
        assert_int_equal(corners, 8);
        pel_mesh_destroy(filled);
    }
    pel_mesh_destroy(box);
}

/* the vertices lie on the ball, so the missing volume falls with the square of the edge */
static void balls_converge(void **state)
{
    (void)state;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = 30;
    pel_mesh *ball;
    assert_int_equal(pel_shape_create(&def, &ball, NULL), PEL_OK);
    double missing[2];
    for (int i = 0; i < 2; i++) {
        pel_mesh *filled = fill(ball, i == 0 ? 0.2 : 0.1);
        const figures found = check_whole(filled);
        missing[i] = surface_volume(ball) - found.volume;
        assert_true(missing[i] > 0);
        /* the promise of pellicle/volume.h */
        assert_true(found.least_angle > 10 && found.most_angle < 165);
        check_inside(filled, found.surface_count);
        for (int32_t v = 0; v < found.surface_count; v++)
            assert_near(pel_vec3_length(filled->positions[v]), 1, 2e-3);
        pel_mesh_destroy(filled);
    }
    assert_true(missing[0] / missing[1] > 3.5 && missing[0] / missing[1] < 4.5);
    pel_mesh_destroy(ball);
}

static void bodies_keep_their_holes(void **state)
{
    (void)state;
    pel_mesh *torus = make_shape(PEL_SHAPE_TORUS), *filled = fill(torus, 0.1);
    const figures found = check_whole(filled);
    pel_topology *topology;
    assert_int_equal(pel_topology_create(filled, &topology, NULL), PEL_OK);
    assert_int_equal(found.surface_count - topology->edge_count + filled->triangle_count, 0);
    pel_topology_destroy(topology);
    assert_true(found.least_angle > 10 && found.most_angle < 165);
    assert_near(found.volume, surface_volume(torus), 0.02 * found.volume);
    pel_mesh_destroy(filled);
    pel_mesh_destroy(torus);
}

/* ten rotated boxes, whose faces lie along no axis */
static void turned_boxes_have_good_angles(void **state)
{
    (void)state;
    for (int i = 0; i < 10; i++) {
        pel_mesh *box = make_box(1, 0.8, 1.4);
        pel_transform transform = pel_transform_default();
        const double turn[4] = {0.3 + 0.1 * i, 0.7 - 0.1 * i, 0.2, 0.9};
        memcpy(transform.rotation, turn, sizeof turn);
        assert_int_equal(pel_mesh_transform(box, &transform, NULL), PEL_OK);
        pel_mesh *filled = fill(box, 0.17);
        const figures found = check_whole(filled);
        /* the cells are not quite cubes */
        assert_true(found.least_angle > 8 && found.most_angle < 168);
        assert_near(found.volume, 1 * 0.8 * 1.4, 0.08);
        pel_mesh_destroy(filled);
        pel_mesh_destroy(box);
    }
}

static void assert_refused(const pel_mesh *mesh, double edge, pel_status expected, const char *kind)
{
    pel_mesh *filled = (pel_mesh *)(uintptr_t)mesh;
    pel_error error;
    assert_int_equal(pel_mesh_fill(mesh, edge, &filled, &error), expected);
    assert_null(filled);
    assert_string_equal(error.element_kind, kind);
    assert_true(error.remedy[0] != '\0');
}

static void what_cannot_be_filled_is_refused(void **state)
{
    (void)state;
    pel_mesh *box = make_box(1, 1, 1), *disk = make_shape(PEL_SHAPE_DISK), *torus = make_shape(PEL_SHAPE_TORUS);
    pel_mesh *plate = make_box(1, 1, 1e-3), *filled;
    assert_refused(box, -1, PEL_BAD_ARGUMENT, "");
    assert_refused(box, (double)NAN, PEL_BAD_ARGUMENT, "");
    assert_refused(box, 1e-3, PEL_BAD_ARGUMENT, "");
    assert_refused(disk, 0.1, PEL_BAD_MESH, "triangle");
    assert_refused(torus, 1.5, PEL_BAD_MESH, "triangle");
    /* a torus about as thin as the edge, whose surface would touch itself: the edge of the remedy serves */
    pel_error error;
    pel_transform transform = pel_transform_default();
    const double turn[4] = {1, 2, 3, 14}; /* x, y, z, w */
    memcpy(transform.rotation, turn, sizeof turn);
    assert_int_equal(pel_mesh_transform(torus, &transform, NULL), PEL_OK);
    assert_int_equal(pel_mesh_fill(torus, 0.4, &filled, &error), PEL_BAD_MESH);
    assert_non_null(strstr(error.what, "about as thin as the tetrahedra"));
    assert_non_null(strstr(error.remedy, "at most 0.28 m"));
    pel_mesh_destroy(fill(torus, 0.28));
    filled = fill(plate, 0.1); /* one cell thick */
    assert_near(check_whole(filled).volume, 1e-3, 1e-15);
    pel_mesh_destroy(filled);
    assert_int_equal(pel_mesh_fill(NULL, 1, &filled, NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_mesh_fill(box, 1, NULL, NULL), PEL_BAD_ARGUMENT);
    pel_mesh_destroy(plate);
    pel_mesh_destroy(torus);
    pel_mesh_destroy(disk);
    pel_mesh_destroy(box);
}

static const double points[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 5, 5}, {1, 1, 1}};

static void own_tetrahedra_get_their_surface(void **state)
{
    (void)state;
    static const int32_t two[2][4] = {{0, 1, 2, 3}, {1, 2, 3, 5}};
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create_filled(points[0], 6, two[0], 2, &mesh, NULL), PEL_OK);
    assert_int_equal(mesh->vertex_count, 5);
    assert_int_equal(mesh->triangle_count, 6);
    assert_near(check_whole(mesh).volume, 1.0 / 6 + 2.0 / 6, 1e-15);
    pel_mesh_destroy(mesh);
}

static void bad_tetrahedra_are_named(void **state)
{
    (void)state;
    const struct {
        int32_t tetrahedra[3][4], count;
        pel_status expected;
        int64_t element;
    } bad[] = {
        {{{0, 1, 2, 3}, {2, 1, 3, 5}}, 2, PEL_BAD_MESH, 1},               /* turned inside out */
        {{{0, 1, 2, 3}, {0, 1, 2, 1}}, 2, PEL_BAD_MESH, 1},               /* flat */
        {{{0, 1, 2, 3}, {1, 2, 3, 5}, {1, 2, 3, 4}}, 3, PEL_BAD_MESH, 2}, /* three at a face */
        {{{0, 1, 2, 6}}, 1, PEL_BAD_ARGUMENT, 0},                         /* no such point */
        {{{0, 1, 2, 3}}, 0, PEL_BAD_ARGUMENT, -1},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        pel_mesh *mesh;
        pel_error error;
        assert_int_equal(pel_mesh_create_filled(points[0], 6, bad[i].tetrahedra[0], bad[i].count, &mesh, &error),
                         bad[i].expected);
        assert_null(mesh);
        assert_int_equal(error.element, bad[i].element);
    }
    pel_mesh *mesh;
    const double lost[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, (double)NAN}};
    assert_int_equal(pel_mesh_create_filled(lost[0], 4, bad[0].tetrahedra[0], 1, &mesh, NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_mesh_create_filled(NULL, 4, bad[0].tetrahedra[0], 1, &mesh, NULL), PEL_BAD_ARGUMENT);
}

/* a mirrored mesh keeps positive tetrahedra */
static void mirrors_turn_tetrahedra(void **state)
{
    (void)state;
    pel_mesh *box = make_box(1, 1, 1), *filled = fill(box, 0.5);
    pel_transform mirror = pel_transform_default();
    mirror.scale[1] = -2;
    assert_int_equal(pel_mesh_transform(filled, &mirror, NULL), PEL_OK);
    assert_near(check_whole(filled).volume, 2, 1e-12);
    pel_mesh_destroy(filled);
    pel_mesh_destroy(box);
}

static pel_status fill_case(const void *data, pel_error *error)
{
    pel_mesh *filled;
    pel_status status = pel_mesh_fill(data, 0.5, &filled, error);
    if (status != PEL_OK)
        assert_null(filled);
    pel_mesh_destroy(filled);
    return status;
}

static void memory_may_run_out(void **state)
{
    (void)state;
    pel_mesh *box = make_box(1, 1, 1);
    assert_true(for_every_allocation_failure(fill_case, box) > 10);
    pel_mesh_destroy(box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_are_exact),
        cmocka_unit_test(balls_converge),
        cmocka_unit_test(bodies_keep_their_holes),
        cmocka_unit_test(turned_boxes_have_good_angles),
        cmocka_unit_test(what_cannot_be_filled_is_refused),
        cmocka_unit_test(own_tetrahedra_get_their_surface),
        cmocka_unit_test(bad_tetrahedra_are_named),
        cmocka_unit_test(mirrors_turn_tetrahedra),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
