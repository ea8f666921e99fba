/* Assembled elements: plates, strips and beams at rest under loads, by Newton's method on dense matrices. */
#include "tangent_fixture.h"

#include "math/pose.h"
#include "measure/midedge.h"

#include <stdlib.h>

/* a strip along x from 0, clamped there */
typedef struct strip {
    pel_mesh *mesh;
    tangents on;
    uint8_t *is_fixed;
    double *load;
} strip;

static pel_body_def plate_body(const pel_mesh *mesh, double young, double poisson, double thickness)
{
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.membrane.young.value = young;
    body.shell.membrane.poisson = poisson;
    body.shell.membrane.thickness.value = thickness;
    body.shell.bending.model = PEL_BENDING_MIDEDGE;
    return body;
}

static int32_t place_of(const tangents *on, int32_t vertex)
{
    return on->model->bodies[0].model_index[vertex];
}

/* unknowns of vertices that do not exist */
static void fix_padding(const tangents *on, uint8_t *is_fixed)
{
    for (int32_t v = 0; v < on->model->vertex_count; v++)
        if (!(on->model->mass[v] > 0))
            memset(is_fixed + 3 * v, 1, 3);
}

/* 1 when both ends of a boundary edge are at this x at rest */
static bool edge_is_at(const strip *on, int32_t e, double x)
{
    const pel_tangent_edge *edge = &pel_tangent_edges_of(on->on.tangent)[e];
    for (int k = 0; k < 2; k++)
        if (fabs((double)on->on.model->rest[edge->vertices[k]][0] - x) > 1e-6)
            return false;
    return edge->triangles[1] < 0;
}

static strip make_strip(int nx, int ny, double length, double width, double young, double thickness)
{
    strip made = {.mesh = make_grid(nx, ny, length, width, PEL_GRID_ONE_DIAGONAL)};
    for (int32_t v = 0; v < made.mesh->vertex_count; v++)
        made.mesh->positions[v][0] += 0.5 * length;
    pel_body_def body = plate_body(made.mesh, young, 0, thickness);
    made.on = make_tangents(&body);
    made.is_fixed = calloc((size_t)made.on.count, 1);
    made.load = calloc((size_t)made.on.count, sizeof *made.load);
    fix_padding(&made.on, made.is_fixed);
    for (int32_t v = 0; v < made.mesh->vertex_count; v++)
        if (fabs(made.mesh->positions[v][0]) < 1e-9)
            memset(made.is_fixed + 3 * place_of(&made.on, v), 1, 3);
    for (int32_t e = 0; e < made.on.pattern->edge_count; e++)
        made.is_fixed[3 * made.on.pattern->vertex_count + e] = edge_is_at(&made, e, 0);
    return made;
}

static void free_strip(strip *made)
{
    free_tangents(&made->on);
    pel_mesh_destroy(made->mesh);
    free(made->is_fixed);
    free(made->load);
}

/* mean position of the vertices at the free end */
static void tip_of(const strip *on, double length, double tip[3])
{
    int count = 0;
    pel_vec3_set(tip, 0, 0, 0);
    for (int32_t v = 0; v < on->mesh->vertex_count; v++)
        if (fabs(on->mesh->positions[v][0] - length) < 1e-9) {
            pel_vec3_add(tip, on->on.unknowns + 3 * place_of(&on->on, v), tip);
            count++;
        }
    pel_vec3_scale(tip, 1.0 / count, tip);
}

/* the planar rod theta'' = -(load + weight (1 - s)) cos theta of length 1, clamped and horizontal at s = 0 and free of
   moment at the end, by shooting: way forward and down */
static void solve_rod(double load, double weight, double end[2])
{
    enum { STEPS = 4000 };
    double low = 0, high = load + weight;
    for (int attempt = 0; attempt < 60; attempt++) {
        double theta = 0, slope = 0.5 * (low + high), h = 1.0 / STEPS;
        end[0] = end[1] = 0;
        for (int i = 0; i < STEPS; i++) {
            /* midpoint rule */
            double s = (i + 0.5) * h, at = theta + 0.5 * h * slope;
            double bend = -(load + weight * (1 - s)) * cos(at), middle = theta + 0.5 * h * (slope + 0.5 * h * bend);
            end[0] += h * cos(middle);
            end[1] += h * sin(middle);
            theta += h * (slope + 0.5 * h * bend);
            slope += h * bend;
        }
        *(slope > 0 ? &high : &low) = 0.5 * (low + high);
    }
}

/* ---- patches ---- */

/* sheets of different triangles, the last of which is the mirror image of the first */
static pel_mesh *make_sheet(int kind, random_state *random)
{
    static const pel_grid_diagonals diagonals[] = {PEL_GRID_ONE_DIAGONAL, PEL_GRID_UNION_JACK, PEL_GRID_EQUILATERAL};
    if (kind == 3)
        return make_irregular_patch(8, random);
    pel_mesh *mesh = make_grid(8, 8, 1, 1, kind < 3 ? diagonals[kind] : PEL_GRID_ONE_DIAGONAL);
    for (int32_t v = 0; kind == 4 && v < mesh->vertex_count; v++)
        mesh->positions[v][0] = -mesh->positions[v][0];
    for (int32_t t = 0; kind == 4 && t < mesh->triangle_count; t++) {
        int32_t kept = mesh->triangles[t][1];
        mesh->triangles[t][1] = mesh->triangles[t][2];
        mesh->triangles[t][2] = kept;
    }
    return mesh;
}
enum { SHEET_COUNT = 5 };

/* a sheet bent to z = 1/2 (k11 x^2 + 2 k12 x y + k22 y^2), with that surface's normals along the border */
static void bend_sheet(tangents *on, const double k[3], uint8_t *is_border)
{
    const pel_tangent_edge *edges = pel_tangent_edges_of(on->tangent);
    for (int32_t v = 0; v < on->model->vertex_count; v++) {
        double *x = on->unknowns + 3 * v;
        x[2] = 0.5 * k[0] * x[0] * x[0] + k[1] * x[0] * x[1] + 0.5 * k[2] * x[1] * x[1];
    }
    for (int32_t e = 0; e < on->pattern->edge_count; e++) {
        double x[3][3];
        is_border[e] = edges[e].triangles[1] < 0;
        for (int c = 0; is_border[e] && c < 3; c++)
            pel_vec3_copy(on->unknowns + 3 * edges[e].vertices[c], x[c]);
        if (!is_border[e])
            continue;
        double u = 0.5 * (x[0][0] + x[1][0]), v = 0.5 * (x[0][1] + x[1][1]);
        const double normal[3] = {-k[0] * u - k[1] * v, -k[1] * u - k[2] * v, 1};
        on->unknowns[3 * on->pattern->vertex_count + e] = pel_midedge_angle((const double(*)[3])x, normal);
    }
}

/* cylinders, a sphere, a saddle and twists have a plate's energy on any mesh */
static void bent_sheets_have_a_plates_energy(void **unused)
{
    (void)unused;
    random_state random = {1};
    static const double curvatures[][3] = {{1, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, -1}, {0, 1, 0}, {0.3, -0.8, 0.5}};
    const double young = 3e5, poisson = 0.3, thickness = 0.02;
    const double d = pel_bending_stiffness(young, poisson, thickness);
    for (int kind = 0; kind < SHEET_COUNT; kind++) {
        pel_mesh *mesh = make_sheet(kind, &random);
        pel_body_def body = plate_body(mesh, young, poisson, thickness);
        tangents on = make_tangents(&body);
        uint8_t *is_border = calloc((size_t)on.pattern->edge_count, 1);
        for (size_t i = 0; i < sizeof curvatures / sizeof *curvatures; i++) {
            double k[3];
            pel_vec3_scale(curvatures[i], 1e-4, k);
            memset(on.unknowns, 0, (size_t)on.count * sizeof *on.unknowns);
            set_rest_unknowns(&on);
            bend_sheet(&on, k, is_border);
            pel_tangent_settle_edges(on.tangent, on.unknowns, is_border);
            evaluate_tangents(&on, (pel_tangent_input){0});
            double trace = k[0] + k[2], square = k[0] * k[0] + 2 * k[1] * k[1] + k[2] * k[2];
            double area = on.model->bodies[0].rest_area;
            double expected = 0.5 * d * area * ((1 - poisson) * square + poisson * trace * trace);
            assert_near(on.energy.edges / expected, 1, 1e-6);
        }
        free(is_border);
        free_tangents(&on);
        pel_mesh_destroy(mesh);
    }
}

/* deflection of a corner of a square plate that is held at the three others, over the exact P / (2 D (1 - nu)) */
static double corner_deflection(pel_mesh *mesh, pel_bending_model model)
{
    const double young = 3e5, poisson = 0.3, thickness = 0.02, force = 1e-8;
    pel_body_def body = plate_body(mesh, young, poisson, thickness);
    body.shell.bending.model = model;
    tangents on = make_tangents(&body);
    uint8_t *is_fixed = calloc((size_t)on.count, 1);
    double *load = calloc((size_t)on.count, sizeof *load);
    fix_padding(&on, is_fixed);
    int32_t loaded = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *x = mesh->positions[v];
        int32_t place = 3 * place_of(&on, v);
        bool corner = fabs(fabs(x[0]) - 0.5) < 1e-9 && fabs(fabs(x[1]) - 0.5) < 1e-9;
        is_fixed[place] = is_fixed[place + 1] = 1;
        if (corner && x[0] > 0 && x[1] > 0)
            loaded = place + 2;
        else if (corner)
            is_fixed[place + 2] = 1;
    }
    load[loaded] = force;
    assert_in_range(solve_static(&on, load, is_fixed, 1, 10), 1, 10);
    double deflection = on.unknowns[loaded];
    free(is_fixed);
    free(load);
    free_tangents(&on);
    return deflection / (force / (2 * pel_bending_stiffness(young, poisson, thickness) * (1 - poisson)));
}

/* the twist of a plate under forces on its corners is exact on any mesh; hinges are 2 / (1 - nu) too stiff */
static void twisted_plates_are_exact(void **unused)
{
    (void)unused;
    random_state random = {2};
    for (int kind = 0; kind < SHEET_COUNT; kind++) {
        if (kind == 2)
            continue; /* its sides are no straight lines of edges */
        pel_mesh *mesh = make_sheet(kind, &random);
        assert_near(corner_deflection(mesh, PEL_BENDING_MIDEDGE), 1, 1e-6);
        if (kind == 1)
            assert_near(corner_deflection(mesh, PEL_BENDING_HINGE), 0.35, 0.05);
        pel_mesh_destroy(mesh);
    }
}

/* ---- strips ---- */

/* a strip under its weight, 24 x 3 cells, Gamma = 12 rho g L^3 / (E h^2) = 10 */
static void heavy_strip_is_an_elastica(void **unused)
{
    (void)unused;
    const double young = 1e6, thickness = 0.01, gamma = 10;
    strip on = make_strip(24, 3, 1, 0.125, young, thickness);
    const pel_shell *shell = on.on.model->bodies[0].shell;
    double pressure = gamma * young * thickness * thickness * thickness / 12, exact[2], tip[3];
    for (int32_t t = 0; t < shell->triangle_count; t++)
        for (int k = 0; k < 3; k++)
            on.load[3 * shell->corners[t][k] + 2] -= pressure * pel_shell_rest(shell, t).area / 3;
    int iterations = solve_static(&on.on, on.load, on.is_fixed, 1, 40);
    solve_rod(0, gamma, exact);
    tip_of(&on, 1, tip);
    assert_in_range(iterations, 1, 12);
    assert_near(tip[0] / exact[0], 1, 0.005);
    assert_near(-tip[2] / exact[1], 1, 0.005);
    free_strip(&on);
}

/* cantilever under an end shear, P L^2 / EI = 4 (Sze, Liu, Lo 2004): 6.698 down and 3.286 back */
static void cantilever_bends_under_an_end_shear(void **unused)
{
    (void)unused;
    strip on = make_strip(20, 2, 10, 1, 1.2e6, 0.1);
    double tip[3], total = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int32_t e = 0; e < on.on.pattern->edge_count; e++) {
            const pel_tangent_edge *edge = &pel_tangent_edges_of(on.on.tangent)[e];
            for (int k = 0; edge_is_at(&on, e, 10) && k < 2; k++)
                if (pass == 0)
                    total++;
                else
                    on.load[3 * edge->vertices[k] + 2] += 4 / total;
        }
    int iterations = solve_static(&on.on, on.load, on.is_fixed, 10, 40);
    tip_of(&on, 10, tip);
    assert_in_range(iterations, 1, 12);
    assert_near(tip[2], 6.698, 0.01 * 6.698);
    assert_near(10 - tip[0], 3.286, 0.01 * 3.286);
    free_strip(&on);
}

/* A moment of 2 pi D / L on the end, a force on the rotation of its edges, rolls a strip up to a full circle. Its
   vertices keep their y: a moment that turns with its edge in space has no potential. */
static void end_moment_rolls_a_strip_up(void **unused)
{
    (void)unused;
    enum { LOAD_STEPS = 8 };
    const double young = 1e6, thickness = 0.01, width = 0.1;
    strip on = make_strip(32, 2, 1, width, young, thickness);
    int32_t first = 3 * on.on.pattern->vertex_count;
    for (int32_t v = 0; v < on.on.model->vertex_count; v++)
        on.is_fixed[3 * v + 1] = 1;
    double moment = 2 * acos(-1.0) * pel_bending_stiffness(young, 0, thickness), tip[3];
    for (int step = 1; step <= LOAD_STEPS; step++) {
        for (int32_t e = 0; e < on.on.pattern->edge_count; e++)
            if (edge_is_at(&on, e, 1))
                on.load[first + e] = moment * width / 2 * step / LOAD_STEPS;
        assert_in_range(solve_static(&on.on, on.load, on.is_fixed, 1, 40), 1, 8);
        double angle = 2 * acos(-1.0) * step / LOAD_STEPS;
        tip_of(&on, 1, tip);
        assert_near(tip[0], sin(angle) / angle, 0.003);
        assert_near(fabs(tip[2]), (1 - cos(angle)) / angle, 0.003);
    }
    free_strip(&on);
}

/* two triangles of a square, folded by an angle about its diagonal */
static void fold_square(tangents *on, double angle)
{
    const pel_tangent_edge *edges = pel_tangent_edges_of(on->tangent), *diagonal = edges;
    while (diagonal->triangles[1] < 0)
        diagonal++;
    const double still[4] = {0, 0, 0, 1};
    double axis[3], way[3], turned[4];
    double *tail = on->unknowns + 3 * diagonal->vertices[0], *tip = on->unknowns + 3 * diagonal->vertices[3];
    set_rest_unknowns(on);
    pel_vec3_subtract(on->unknowns + 3 * diagonal->vertices[1], tail, axis);
    pel_vec3_normalize(axis);
    pel_rotation_turn(still, axis, angle, turned);
    pel_vec3_subtract(tip, tail, way);
    pel_rotate(turned, way, way);
    pel_vec3_add(tail, way, tip);
}

/* before equilibrium a fold may pass through its closed state: its energy continues to grow; once edges are settled
   again it is a fold to the other side */
static void folds_have_no_jump_where_they_are_closed(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(1, 1, 1, 1, PEL_GRID_ONE_DIAGONAL);
    pel_body_def body = plate_body(mesh, 3e5, 0.3, 0.02);
    tangents on = make_tangents(&body);
    for (int side = -1; side <= 1; side += 2) {
        fold_square(&on, 3 * side);
        pel_tangent_settle_edges(on.tangent, on.unknowns, NULL);
        double before = 0;
        for (double angle = 3; angle < 3.4; angle += 0.02) {
            fold_square(&on, side * angle);
            evaluate_tangents(&on, (pel_tangent_input){0});
            assert_true(on.energy.edges > before);
            before = on.energy.edges;
        }
        memset(on.unknowns, 0, (size_t)on.count * sizeof *on.unknowns);
        fold_square(&on, 3.4 * side);
        pel_tangent_settle_edges(on.tangent, on.unknowns, NULL);
        evaluate_tangents(&on, (pel_tangent_input){0});
        assert_true(on.energy.edges < before);
    }
    free_tangents(&on);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bent_sheets_have_a_plates_energy), cmocka_unit_test(twisted_plates_are_exact),
        cmocka_unit_test(heavy_strip_is_an_elastica),       cmocka_unit_test(cantilever_bends_under_an_end_shear),
        cmocka_unit_test(end_moment_rolls_a_strip_up),      cmocka_unit_test(folds_have_no_jump_where_they_are_closed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
