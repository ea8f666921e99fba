/* The shell of a surface that refines, triangle by triangle and hinge by hinge against its definition. */
#include "failing_malloc.h"
#include "shell_fixture.h"

#include "refined/refined_model.h"

#include <stdlib.h>
#include <string.h>

/* the tested body follows another one that takes more places in the active model */
enum { BODY = 1, REGIONS = 4, FIBRE_REGIONS = 2 };

/* an active model of a body with all that varies over it */
typedef struct fixture {
    pel_mesh *mesh;
    double *young, *thickness, *weights;
    pel_anisotropy_def regions[REGIONS];
    pel_model *model;
    pel_refined_model *active;
    pel_state *state;
} fixture;

static void create_model(fixture *made, const pel_body_def bodies[2])
{
    pel_model_def def = pel_model_def_default();
    def.bodies = bodies;
    def.body_count = 2;
    assert_int_equal(pel_model_create(&def, &made->model, NULL), PEL_OK);
    assert_int_equal(pel_refined_create(made->model, &made->active, NULL), PEL_OK);
    assert_int_equal(pel_state_create(&made->active->model, false, &made->state, NULL), PEL_OK);
}

static void begin(fixture *made)
{
    pel_mesh *mesh = made->mesh = make_sphere(3);
    size_t count = (size_t)mesh->vertex_count;
    double **fields[] = {&made->young, &made->thickness, &made->weights};
    for (int i = 0; i < 3; i++)
        *fields[i] = calloc(count, sizeof(double));
    for (size_t v = 0; v < count; v++) {
        made->young[v] = 1e5 * (2 + mesh->positions[v][0]);
        made->thickness[v] = 0.01 * (2 + mesh->positions[v][1]);
        made->weights[v] = fmax(0, mesh->positions[v][2]);
    }
    for (int i = 0; i < REGIONS; i++) {
        made->regions[i] = pel_anisotropy_def_default();
        made->regions[i].weights = made->weights;
    }
    made->regions[0].mode = PEL_FIBRE_STRAIN;
    made->regions[0].center[2] = 2;
    made->regions[1].mode = PEL_FIBRE_ACTIVE;
    made->regions[1].direction = PEL_FIBRE_ALONG;
    made->regions[2].mode = made->regions[3].mode = PEL_FIBRE_CURL;
    made->regions[3].curvature = 0.7;
    pel_body_def bodies[2] = {shell_body(mesh, PEL_MEMBRANE_STVK), shell_body(mesh, PEL_MEMBRANE_STVK)},
                 *shell = &bodies[BODY];
    bodies[0].name = "first";
    bodies[0].refine.levels = 1;
    shell->shell.membrane.young.field = made->young;
    shell->shell.membrane.thickness.field = made->thickness;
    shell->shell.bending.model = PEL_BENDING_HINGE;
    shell->shell.anisotropies = made->regions;
    shell->shell.anisotropy_count = REGIONS;
    shell->shell.pressure.kind = PEL_PRESSURE_GIVEN;
    shell->shell.pressure.outside.value = 1;
    shell->shell.pressure.weights = made->weights;
    shell->refine.levels = 2;
    create_model(made, bodies);
}

/* woven cloth, whose warp is a direction or runs along a coordinate that rises in it */
static void begin_woven(fixture *made, const double direction[3], bool is_coordinate)
{
    *made = (fixture){.mesh = make_sphere(3)};
    pel_body_def bodies[2] = {shell_body(made->mesh, PEL_MEMBRANE_STVK),
                              shell_body(made->mesh, PEL_MEMBRANE_ORTHOTROPIC)},
                 *shell = &bodies[BODY];
    double *coordinate = made->weights = calloc((size_t)made->mesh->vertex_count, sizeof(double));
    for (int32_t v = 0; v < made->mesh->vertex_count; v++)
        coordinate[v] = pel_vec3_dot(direction, made->mesh->positions[v]);
    bodies[0].name = "first";
    shell->shell.membrane.weft = 5e4;
    memcpy(shell->shell.membrane.direction, direction, 3 * sizeof *direction);
    if (is_coordinate)
        shell->shell.membrane.coordinate = coordinate;
    shell->refine.levels = 2;
    create_model(made, bodies);
}

static void end(fixture *made)
{
    pel_state_destroy(made->state);
    pel_refined_destroy(made->active);
    pel_model_destroy(made->model);
    pel_mesh_destroy(made->mesh);
    free(made->young);
    free(made->thickness);
    free(made->weights);
}

static void corners_of(const fixture *made, const int32_t *places, int count, double x[][3])
{
    pel_load_points(made->active->model.rest, places, count, x);
}

/* the base triangle whose cone from the middle of the sphere holds the centroid of another one */
static int32_t base_around(const fixture *made, const double x[3][3])
{
    double centroid[3], best = -HUGE_VAL;
    int32_t found = -1;
    for (int i = 0; i < 3; i++)
        centroid[i] = x[0][i] + x[1][i] + x[2][i];
    for (int32_t t = 0; t < made->mesh->triangle_count; t++) {
        double least = HUGE_VAL, normal[3];
        for (int i = 0; i < 3; i++) {
            const int32_t *v = made->mesh->triangles[t];
            pel_vec3_cross(made->mesh->positions[v[i]], made->mesh->positions[v[(i + 1) % 3]], normal);
            pel_vec3_normalize(normal);
            least = fmin(least, pel_vec3_dot(normal, centroid));
        }
        if (least > best) {
            best = least;
            found = t;
        }
    }
    assert_true(best > 0);
    return found;
}

static void check_triangle(const fixture *made, const pel_shell *shell, int32_t t)
{
    const pel_shell *given = made->model->bodies[BODY].shell;
    const pel_rest_triangle rest = pel_shell_rest(shell, t);
    double x[3][3], f[6], normal[3];
    corners_of(made, shell->corners[t], 3, x);
    int32_t base = base_around(made, (const double(*)[3])x);
    pel_shell_sheet sheet = pel_shell_sheet_of(shell, t), whole = pel_shell_sheet_of(given, base);
    double tolerance = sizeof(pel_real) == 8 ? 1e-12 : 1e-5;
    pel_vec3_triangle_normal(x[0], x[1], x[2], normal);
    assert_near(rest.area / (0.5 * pel_vec3_length(normal)), 1, tolerance);
    pel_deformation_gradient(&rest, (const double(*)[3])x, f);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            assert_near(f[i] * f[j] + f[2 + i] * f[2 + j] + f[4 + i] * f[4 + j], i == j, tolerance);
    assert_true(sheet.young == whole.young && sheet.thickness == whole.thickness);
    const int32_t *v = made->mesh->triangles[base];
    double weight = (made->weights[v[0]] + made->weights[v[1]] + made->weights[v[2]]) / 3;
    assert_near(given->parts[base].curl, (1 - 2 * weight) * (1 - 0.3 * weight), 1e-12);
    assert_int_equal(made->active->bodies[BODY].shell->base_of_triangle[t], base);
    assert_true(shell->pressure_weights[t] == given->pressure_weights[base]);
    for (int r = 0; r < FIBRE_REGIONS; r++) {
        const pel_shell_region *region = &shell->regions[r], *of = &given->regions[r];
        int32_t at = -1, origin = -1;
        for (int32_t i = 0; i < region->fibre_count; i++)
            at = pel_shell_fibre_triangle(region, i) == t ? i : at;
        for (int32_t i = 0; i < of->fibre_count; i++)
            origin = pel_shell_fibre_triangle(of, i) == base ? i : origin;
        assert_true((at < 0) == (origin < 0));
        if (at < 0)
            continue;
        const pel_shell_fibre fibre = pel_shell_fibre_of(shell, region, at);
        double direction[2];
        pel_shell_fibre_direction(&made->regions[r], (const double(*)[3])x, direction);
        assert_true(fibre.weight == pel_shell_fibre_weight(of, origin));
        assert_near(fibre.direction[0], direction[0], tolerance);
        assert_near(fibre.direction[1], direction[1], tolerance);
    }
}

static int corner_with(const int32_t corners[3], int32_t place)
{
    for (int k = 0; k < 3; k++)
        if (corners[k] == place)
            return k;
    fail();
    return -1;
}

static void check_hinge(const fixture *made, const pel_shell *shell, const pel_shell_hinge *hinge)
{
    const pel_refined_body *own = &made->active->bodies[BODY];
    const int32_t *sides[2];
    const pel_shell_part_bending *parts[2];
    for (int s = 0; s < 2; s++) {
        parts[s] = &own->shell->given->parts[own->shell->base_of_triangle[hinge->triangles[s]]];
        sides[s] = shell->corners[hinge->triangles[s]];
        /* along the edge in the left one, against it in the right one, with the tip behind */
        int from = corner_with(sides[s], hinge->vertices[s]);
        assert_int_equal(sides[s][(from + 1) % 3], hinge->vertices[1 - s]);
        assert_int_equal(sides[s][(from + 2) % 3], hinge->vertices[2 + s]);
    }
    double x[4][3], tolerance = sizeof(pel_real) == 8 ? 1e-12 : 1e-5;
    corners_of(made, hinge->vertices, 4, x);
    assert_near(hinge->stiffness, 0.5 * (parts[0]->stiffness + parts[1]->stiffness), 1e-12 * hinge->stiffness);
    /* on the base the curl is that of the ends of the edge */
    if (own->shell->is_base[hinge->triangles[0]] && own->shell->is_base[hinge->triangles[1]])
        return;
    double angle = pel_dihedral_angle((const double(*)[3])x, NULL);
    assert_near(pel_shell_rest_angle(shell, hinge->number), angle * 0.5 * (parts[0]->curl + parts[1]->curl),
                10 * tolerance);
}

/* one hinge on each edge, and on the closed ball all edges have one */
static void check_hinges(const fixture *made, const pel_shell *shell)
{
    assert_int_equal(2 * shell->hinge_count, 3 * shell->triangle_count);
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
        const int32_t *v = hinge.vertices;
        check_hinge(made, shell, &hinge);
        for (int32_t k = 0; k < i; k++) {
            const pel_shell_hinge other = pel_shell_hinge_of(shell, k);
            const int32_t *w = other.vertices;
            assert_false((v[0] == w[0] && v[1] == w[1]) || (v[0] == w[1] && v[1] == w[0]));
        }
    }
}

static void check_shell(const fixture *made)
{
    const pel_refined_body *own = &made->active->bodies[BODY];
    const pel_shell *shell = &own->shell->shell;
    double volume = 0, x[3][3];
    assert_int_equal(shell->triangle_count, own->front->triangle_count);
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        check_triangle(made, shell, t);
        corners_of(made, shell->corners[t], 3, x);
        volume += pel_triangle_volume((const double(*)[3])x, NULL);
    }
    check_hinges(made, shell);
    assert_near(pel_shell_front_rest_volume(own->shell, own->front) / volume, 1, sizeof(pel_real) == 8 ? 1e-12 : 1e-5);
}

/* unrefined parts are as given, at the places of the active model */
static void check_base(const fixture *made)
{
    const pel_shell_front *own = made->active->bodies[BODY].shell;
    const pel_shell *shell = &own->shell, *given = own->given;
    const pel_model *active = &made->active->model;
    int32_t shift = (active->bodies[BODY].slice_begin - made->model->bodies[BODY].slice_begin) * PEL_WIDTH;
    assert_true(shift > 0);
    assert_int_equal(shell->triangle_count, given->triangle_count);
    assert_int_equal(shell->hinge_count, given->hinge_count);
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        const pel_rest_triangle rest = pel_shell_rest(shell, t), like = pel_shell_rest(given, t);
        assert_memory_equal(&rest, &like, sizeof rest);
    }
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
        int32_t like = -1;
        for (int32_t k = 0; k < given->hinge_count; k++) {
            bool same = true;
            for (int c = 0; c < 2; c++)
                same &= pel_shell_hinge_of(given, k).vertices[c] + shift == hinge.vertices[c];
            like = same ? k : like;
        }
        assert_true(like >= 0);
        assert_true(hinge.stiffness == pel_shell_hinge_stiffness(given, like));
        assert_true(pel_shell_rest_angle(shell, i) == pel_shell_rest_angle(given, like));
    }
}

static void mark_some(fixture *made, random_state *random, bool marked[])
{
    pel_front *front = made->active->bodies[BODY].front;
    for (int n = 0; n < 12; n++) {
        int32_t node = (int32_t)random_between(random, 0, front->node_begin[2]);
        if (node < front->node_begin[2]) {
            marked[node] = !marked[node];
            pel_front_mark(front, node, marked[node]);
        }
    }
    pel_front_close(front);
    pel_refined_commit(made->active, BODY, made->state);
}

static void test_random_fronts(void **unused)
{
    (void)unused;
    fixture made;
    random_state random = {7};
    begin(&made);
    check_shell(&made);
    check_base(&made);
    pel_front *front = made.active->bodies[BODY].front;
    bool *marked = calloc((size_t)front->node_begin[2], sizeof *marked);
    for (int round = 0; round < 8; round++) {
        mark_some(&made, &random, marked);
        assert_true(front->triangle_count > made.mesh->triangle_count);
        check_shell(&made);
    }
    for (int32_t node = 0; node < front->node_begin[2]; node++)
        if (marked[node])
            pel_front_mark(front, node, false);
    pel_front_close(front);
    pel_refined_commit(made.active, BODY, made.state);
    check_shell(&made);
    check_base(&made);
    free(marked);
    end(&made);
}

/* the warp of a triangle in its rest frame: the given direction, or the part within the base triangle of the gradient
   of a coordinate */
static void check_warp(const fixture *made, const double direction[3], bool is_coordinate)
{
    const pel_shell_front *own = made->active->bodies[BODY].shell;
    for (int32_t t = 0; t < own->shell.triangle_count; t++) {
        const int32_t *v = made->mesh->triangles[own->base_of_triangle[t]];
        double x[3][3], normal[3], along[3], expected[2];
        corners_of(made, own->shell.corners[t], 3, x);
        pel_vec3_copy(direction, along);
        pel_vec3_triangle_normal(made->mesh->positions[v[0]], made->mesh->positions[v[1]], made->mesh->positions[v[2]],
                                 normal);
        pel_vec3_normalize(normal);
        if (is_coordinate)
            pel_vec3_along(along, -pel_vec3_dot(along, normal), normal, along);
        assert_true(pel_rest_triangle_direction((const double(*)[3])x, along, expected));
        for (int i = 0; i < PEL_LAW_AXIS; i++)
            assert_near(own->shell.axes[t][i], expected[i], sizeof(pel_real) == 8 ? 1e-12 : 1e-5);
    }
}

static void test_warp(void **unused)
{
    (void)unused;
    static const double direction[3] = {0.3, 1, 0.2};
    for (int is_coordinate = 0; is_coordinate < 2; is_coordinate++) {
        fixture made;
        random_state random = {11};
        begin_woven(&made, direction, is_coordinate);
        check_warp(&made, direction, is_coordinate);
        bool *marked = calloc((size_t)made.active->bodies[BODY].front->node_begin[2], sizeof *marked);
        for (int round = 0; round < 3; round++) {
            mark_some(&made, &random, marked);
            check_warp(&made, direction, is_coordinate);
        }
        free(marked);
        end(&made);
    }
}

static pel_status create_active(const void *model, pel_error *error)
{
    pel_refined_model *active;
    pel_status status = pel_refined_create(model, &active, error);
    assert_true((active == NULL) == (status != PEL_OK));
    pel_refined_destroy(active);
    return status;
}

static void test_every_allocation(void **unused)
{
    (void)unused;
    fixture made;
    begin(&made);
    assert_true(for_every_allocation_failure(create_active, made.model) > 30);
    end(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_fronts),
        cmocka_unit_test(test_warp),
        cmocka_unit_test(test_every_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
