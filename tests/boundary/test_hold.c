/* Supports of single components: standard problems of shells against their answers, reactions, and bad supports. */
#include "pellicle/shape.h"
#include "pellicle/sim_ledger.h"
#include "shell_fixture.h"
#include "stage/stage.h"

#include <string.h>

static const double PI = 3.14159265358979323846;

enum { MOST = 11000, MOST_SUPPORTS = 8 };

/* a shell by one step of statics */
typedef struct structure {
    pel_mesh *mesh;
    pel_body_def body;
    double gravity[3];
    pel_support_def supports[MOST_SUPPORTS];
    int32_t vertices[MOST_SUPPORTS + 2][MOST], support_count, load_count;
    pel_load_def loads[2];
    pel_key key[1];
    pel_method method;
    pel_model *model;
    pel_sim *sim;
} structure;

static void begin(structure *s, pel_mesh *mesh, double young, double poisson, double thickness)
{
    memset(s, 0, sizeof *s);
    s->mesh = mesh;
    s->method = PEL_METHOD_STATIC;
    s->body = shell_body(mesh, PEL_MEMBRANE_STVK);
    s->body.thickness.value = s->body.shell.membrane.thickness.value = thickness;
    s->body.shell.membrane.young.value = young;
    s->body.shell.membrane.poisson = poisson;
    s->body.shell.bending.model = PEL_BENDING_MIDEDGE;
}

/* vertices with normal . x = offset */
static int32_t find(structure *s, const double normal[3], double offset, int32_t *list)
{
    int32_t count = 0;
    for (int32_t v = 0; v < s->mesh->vertex_count; v++)
        if (fabs(pel_vec3_dot(normal, s->mesh->positions[v]) - offset) < 1e-6 * (1 + fabs(offset)))
            list[count++] = v;
    return count;
}

static int32_t nearest(const structure *s, double x, double y, double z)
{
    const double point[3] = {x, y, z};
    int32_t best = 0;
    for (int32_t v = 1; v < s->mesh->vertex_count; v++)
        if (pel_vec3_distance(point, s->mesh->positions[v]) < pel_vec3_distance(point, s->mesh->positions[best]))
            best = v;
    return best;
}

/* at the plane of a coordinate */
static pel_support_def *support(structure *s, int axis, double offset, bool x, bool y, bool z, bool rotation)
{
    const double normal[3] = {axis == 0, axis == 1, axis == 2};
    int32_t number = s->support_count++;
    pel_support_def *made = &s->supports[number];
    *made = pel_support_def_default();
    made->name = "support";
    made->vertices = s->vertices[number];
    made->vertex_count = find(s, normal, offset, s->vertices[number]);
    assert_true(made->vertex_count > 0);
    made->fix[0] = x;
    made->fix[1] = y;
    made->fix[2] = z;
    made->fix_rotation = rotation;
    return made;
}

static void symmetry(structure *s, int axis)
{
    support(s, axis, 0, axis == 0, axis == 1, axis == 2, true);
}

static void support_vertex(structure *s, int32_t v, bool x, bool y, bool z)
{
    pel_support_def *made = support(s, 0, s->mesh->positions[v][0], x, y, z, false);
    s->vertices[s->support_count - 1][0] = v;
    made->vertex_count = 1;
}

static pel_load_def *load_vertex(structure *s, int32_t v, double x, double y, double z)
{
    pel_load_def *load = &s->loads[s->load_count];
    *load = pel_load_def_default();
    s->vertices[MOST_SUPPORTS + s->load_count][0] = v;
    load->vertices = s->vertices[MOST_SUPPORTS + s->load_count++];
    load->vertex_count = 1;
    pel_vec3_set(load->force, x, y, z);
    return load;
}

static pel_status try_create(structure *s, pel_error *error)
{
    pel_model_def model = pel_model_def_default();
    model.bodies = &s->body;
    model.body_count = 1;
    pel_vec3_copy(s->gravity, model.gravity);
    assert_int_equal(pel_model_create(&model, &s->model, error), PEL_OK);
    pel_sim_def def = lone_sim(s->model, s->method, 1);
    def.loads = s->loads;
    def.load_count = s->load_count;
    def.supports = s->supports;
    def.support_count = s->support_count;
    return pel_sim_create(&def, &s->sim, error);
}

static void end(structure *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
}

static void solve(structure *s)
{
    pel_error error;
    char text[800];
    pel_status status = try_create(s, &error);
    if (status == PEL_OK)
        status = pel_sim_step(s->sim, &error);
    if (status != PEL_OK)
        print_error("%s\n", pel_error_text(&error, text, sizeof text));
    assert_int_equal(status, PEL_OK);
    pel_solver_reading reading;
    pel_sim_get_solver(s->sim, &reading);
    assert_true(reading.converged);
}

static void moved(const structure *s, int32_t vertex, double way[3])
{
    int32_t v = s->model->bodies[0].model_index[vertex];
    pel_vertex_position(s->sim->state->position, v, way);
    pel_vec3_subtract(way, s->mesh->positions[vertex], way);
}

static void assert_within(double got, double truth, double share)
{
    if (!(fabs(got - truth) <= share * fabs(truth)))
        fail_msg("%.8g is not %.8g within %g", got, truth, share);
}

/* ---- standard problems ---- */

/* a grid on the unit square */
static pel_mesh *unit_grid(int n, int m)
{
    pel_mesh *mesh = make_grid(n, m, 1, 1, PEL_GRID_ONE_DIAGONAL);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int k = 0; k < 2; k++)
            mesh->positions[v][k] += 0.5;
    return mesh;
}

/* Scordelis and Lo: a roof under its weight on diaphragms, a quarter of it */
static void roof_is_the_reference(void **state)
{
    (void)state;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* positions in float strain a stiff sheet by 1e-7 */
    const double radius = 25, half = 40 * PI / 180, scale = 1e-3;
    structure *s = malloc(sizeof *s);
    pel_mesh *mesh = unit_grid(40, 40);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double angle = half * mesh->positions[v][0], along = 25 * mesh->positions[v][1];
        pel_vec3_set(mesh->positions[v], radius * sin(angle), along, radius * cos(angle));
    }
    begin(s, mesh, 4.32e8, 0, 0.25);
    s->body.mass = 360;
    s->gravity[2] = -scale;
    support(s, 1, 25, true, false, true, false);
    symmetry(s, 0);
    symmetry(s, 1);
    solve(s);
    double way[3];
    pel_support_reading reading;
    moved(s, nearest(s, radius * sin(half), 0, radius * cos(half)), way);
    assert_within(-way[2] / scale, 0.3024, 0.02);
    /* the diaphragm carries all of it */
    pel_sim_get_support_part(s->sim, 0, &reading);
    assert_within(reading.force[2], -90 * scale * 25 * 2 * 40 * radius * sin(half / 80), 1e-3);
    end(s);
    free(s);
}

/* a cylinder on diaphragms, pinched by two forces: an eighth of it */
static void pinched_cylinder_is_the_reference(void **state)
{
    (void)state;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* positions in float strain a stiff sheet by 1e-7 */
    structure *s = malloc(sizeof *s);
    pel_mesh *mesh = unit_grid(100, 100);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double angle = 0.5 * PI * mesh->positions[v][0], along = 300 * mesh->positions[v][1];
        pel_vec3_set(mesh->positions[v], 300 * sin(angle), along, 300 * cos(angle));
    }
    begin(s, mesh, 3e6, 0.3, 3);
    support(s, 1, 300, true, false, true, false);
    for (int axis = 0; axis < 3; axis++)
        symmetry(s, axis);
    int32_t top = nearest(s, 0, 0, 300);
    load_vertex(s, top, 0, 0, -0.25);
    solve(s);
    double way[3];
    moved(s, top, way);
    assert_within(-way[2], 1.8248e-5, 0.03);
    end(s);
    free(s);
}

/* a half sphere with a hole of 18 degrees, pulled and pinched: a quarter of it */
static void hemisphere_is_the_reference(void **state)
{
    (void)state;
    const double scale = 1e-3;
    structure *s = malloc(sizeof *s);
    pel_mesh *mesh = unit_grid(24, 24);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double around = 0.5 * PI * mesh->positions[v][0], up = 72 * PI / 180 * mesh->positions[v][1];
        pel_vec3_set(mesh->positions[v], 10 * cos(up) * cos(around), 10 * cos(up) * sin(around), 10 * sin(up));
    }
    begin(s, mesh, 6.825e7, 0.3, 0.04);
    symmetry(s, 0);
    symmetry(s, 1);
    int32_t a = nearest(s, 10, 0, 0), b = nearest(s, 0, 10, 0);
    support_vertex(s, a, false, false, true);
    load_vertex(s, a, scale, 0, 0);
    load_vertex(s, b, 0, -scale, 0);
    solve(s);
    double out[3], in[3];
    moved(s, a, out);
    moved(s, b, in);
    assert_within(out[0] / scale, 0.0940, 0.015);
    assert_within(-in[1] / scale, 0.0940, 0.015);
    end(s);
    free(s);
}

/* Sze et al. 2004: a strip under a shear at its end, P L^2 / EI = 4 */
static void cantilever_is_the_reference(void **state)
{
    (void)state;
    structure *s = malloc(sizeof *s);
    pel_mesh *mesh = unit_grid(32, 2);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        mesh->positions[v][0] *= 10;
    begin(s, mesh, 1.2e6, 0, 0.1);
    support(s, 0, 0, true, true, true, true);
    pel_load_def *load = load_vertex(s, 0, 0, 0, 4);
    const double normal[3] = {1, 0, 0};
    load->kind = PEL_LOAD_PER_LENGTH;
    load->vertex_count = find(s, normal, 10, s->vertices[MOST_SUPPORTS]);
    assert_int_equal(load->vertex_count, 3);
    solve(s);
    double way[3];
    pel_support_reading reading;
    moved(s, nearest(s, 10, 0.5, 0), way);
    assert_within(way[2], 6.698, 0.01);
    assert_within(-way[0], 3.286, 0.01);
    pel_sim_get_support_part(s->sim, 0, &reading);
    assert_within(reading.force[2], 4, 1e-4);
    /* the clamp takes the moment of the load about the wall */
    assert_within(reading.torque[1], -4 * (10 + way[0]), 0.01);
    end(s);
    free(s);
}

/* a strip under a moment at its end that bends it to a quarter of a circle */
static void moment_rolls_a_strip_up(void **state)
{
    (void)state;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* positions in float strain a stiff sheet by 1e-7 */
    structure *s = malloc(sizeof *s);
    pel_mesh *mesh = unit_grid(40, 2);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        mesh->positions[v][0] *= 10;
    begin(s, mesh, 1.2e6, 0, 0.1);
    support(s, 0, 0, true, true, true, true);
    /* E I / L times the angle; it lifts the end */
    const double angle = 0.5 * PI, normal[3] = {1, 0, 0};
    pel_load_def *load = load_vertex(s, 0, 0, -100.0 / 10 * angle, 0);
    load->kind = PEL_LOAD_MOMENT;
    load->vertex_count = find(s, normal, 10, s->vertices[MOST_SUPPORTS]);
    solve(s);
    double way[3];
    pel_support_reading reading;
    moved(s, nearest(s, 10, 0.5, 0), way);
    assert_within(10 + way[0], 10 * sin(angle) / angle, 0.01);
    assert_within(way[2], 10 * (1 - cos(angle)) / angle, 0.01);
    pel_sim_get_support_part(s->sim, 0, &reading);
    assert_true(fabs(reading.force[2]) < 1e-3);
    assert_within(reading.torque[1], -100.0 / 10 * angle, 0.01);
    pel_sim_ledger ledger;
    pel_sim_get_ledger(s->sim, &ledger);
    assert_within(ledger.work_loads, 100.0 / 10 * angle * angle, 0.02);
    end(s);
    free(s);
}

/* square plates under a pressure: Timoshenko, tables 8 and 35 */
static double plate_deflection(bool clamped, double turn)
{
    structure *s = malloc(sizeof *s);
    pel_mesh *mesh = make_grid(40, 40, 1, 1, PEL_GRID_UNION_JACK);
    begin(s, mesh, 1e9, 0.3, 0.01);
    s->body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    s->body.shell.pressure.outside.value = 1;
    for (int axis = 0; axis < 2; axis++)
        for (int side = -1; side < 2; side += 2)
            support(s, axis, 0.5 * side, clamped, clamped, true, clamped);
    int32_t middle = nearest(s, 0, 0, 0);
    support_vertex(s, middle, !clamped, true, false);
    support_vertex(s, nearest(s, 0.5, 0, 0), false, true, false);
    /* everything turned about x */
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double *x = mesh->positions[v], y = x[1];
        x[1] = y * cos(turn);
        x[2] = y * sin(turn);
    }
    for (int32_t i = 0; i < s->support_count; i++) {
        pel_vec3_set(s->supports[i].axes[1], 0, cos(turn), sin(turn));
        pel_vec3_set(s->supports[i].axes[2], 0, -sin(turn), cos(turn));
    }
    solve(s);
    double way[3];
    moved(s, middle, way);
    pel_support_reading sum;
    pel_sim_get_support(s->sim, 0, &sum);
    assert_within(sum.force[2], -cos(turn), 1e-3);
    if (turn != 0)
        assert_within(sum.force[1], sin(turn), 1e-3);
    check_reactions(s->sim);
    end(s);
    free(s);
    return pel_vec3_length(way) * 1e9 * 1e-6 / (12 * 0.91);
}

static void plates_are_the_closed_forms(void **state)
{
    (void)state;
    assert_within(plate_deflection(true, 0), 0.00126532, 0.02);
    double simple = plate_deflection(false, 0);
    assert_within(simple, 0.00406235, 0.01);
    assert_within(plate_deflection(false, 0.7), simple, 1e-6);
}

/* ---- displacements and springs ---- */

/* a bar of membrane along x of unit width, 2 m long */
static void begin_bar(structure *s)
{
    pel_mesh *mesh = unit_grid(8, 4);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        mesh->positions[v][0] *= 2;
    begin(s, mesh, 1e6, 0, 0.01);
    support(s, 0, 0, true, true, true, true);
}

/* the ledger's work of supports is what the bodies have gained, by a share */
static void assert_booked(pel_sim *sim, double share)
{
    pel_sim_ledger ledger;
    pel_sim_get_ledger(sim, &ledger);
    assert_true(ledger.elastic > 0);
    assert_within(ledger.work_tools, ledger.elastic + ledger.kinetic, share);
}

static void displacement_pulls_with_the_stiffness_of_the_bar(void **state)
{
    (void)state;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* positions in float strain a stiff sheet by 1e-7 */
    structure *s = malloc(sizeof *s);
    begin_bar(s);
    pel_support_def *pull = support(s, 0, 2, true, false, false, false);
    s->key[0] = (pel_key){0, 0.5};
    pull->displacement[0] = 4e-6;
    pull->keys = s->key;
    pull->key_count = 1;
    solve(s);
    double way[3];
    pel_support_reading left, right;
    moved(s, nearest(s, 2, 0.5, 0), way);
    assert_within(way[0], 2e-6, 1e-9);
    pel_sim_get_support_part(s->sim, 0, &left);
    pel_sim_get_support_part(s->sim, 1, &right);
    assert_within(right.force[0], -1e6 * 0.01 * 1e-6, 1e-5);
    assert_within(left.force[0], 1e6 * 0.01 * 1e-6, 1e-5);
    assert_int_equal(right.vertex_count, 5);
    assert_booked(s->sim, 1e-4);
    end(s);
    free(s);
}

/* One vertex on an incline, the only one that is held: it moves along the normal of the incline as told and along the
   incline freely, so that the force on it is normal. Newton's method takes few systems, as of an exact matrix. */
static void one_vertex_on_an_incline_is_pushed_along_its_normal(void **state)
{
    (void)state;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* positions in float strain a stiff sheet by 1e-7 */
    structure *s = malloc(sizeof *s);
    begin_bar(s);
    s->body.pinned = s->vertices[0];
    s->body.pinned_count = s->supports[0].vertex_count;
    s->body.pinned_count += find(s, (const double[3]){1, 0, 0}, 0.25, s->vertices[0] + s->body.pinned_count);
    s->support_count = 0;
    int32_t corner = nearest(s, 2, 0.5, 0), list = MOST_SUPPORTS - 1;
    pel_support_def *push = &s->supports[s->support_count++];
    *push = pel_support_def_default();
    push->name = "incline";
    push->vertices = s->vertices[list];
    s->vertices[list][0] = corner;
    push->vertex_count = 1;
    push->fix[0] = true;
    push->fix[1] = push->fix[2] = false;
    double normal[3] = {cos(0.6), sin(0.6), 0}, along[3] = {-sin(0.6), cos(0.6), 0}, way[3];
    pel_vec3_copy(normal, push->axes[0]);
    pel_vec3_copy(along, push->axes[1]);
    push->displacement[0] = 1e-6; /* 1e-3 makes the sheet buckle */
    solve(s);
    moved(s, corner, way);
    assert_within(pel_vec3_dot(way, normal), 1e-6, 1e-9);
    assert_true(fabs(pel_vec3_dot(way, along)) > 1e-7);
    pel_support_reading reading;
    pel_sim_get_support_part(s->sim, 0, &reading);
    assert_true(pel_vec3_dot(reading.force, normal) < -1e-3);
    pel_solver_reading solver;
    pel_sim_get_solver(s->sim, &solver);
    /* 5 systems; a matrix that is not turned does not lead to balance */
    assert_true(solver.iterations <= 8);
    end(s);
    free(s);
}

static void springs_are_in_series_with_the_bar(void **state)
{
    (void)state;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* positions in float strain a stiff sheet by 1e-7 */
    structure *s = malloc(sizeof *s);
    begin_bar(s);
    pel_support_def *pull = support(s, 0, 2, true, false, false, false);
    pull->displacement[0] = 2e-6;
    pull->stiffness = 1000;
    solve(s);
    pel_support_reading right;
    pel_sim_get_support_part(s->sim, 1, &right);
    /* the bar has 5000 N/m, the springs together too; the end stays straight within its shear */
    assert_within(right.force[0], -2500 * 2e-6, 0.01);
    check_reactions(s->sim);
    assert_booked(s->sim, 1e-4);
    end(s);
    free(s);
}

/* Hetenyi 1946: the end of a long beam on an elastic foundation sinks by 2 P beta / k under a force P, beta^4 = k / 4 D
 */
static void foundation_carries_a_beam(void **state)
{
    (void)state;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* positions in float strain a stiff sheet by 1e-7 */
    const double stiffness = 400, force = 0.01, normal[3] = {1, 0, 0};
    structure *s = malloc(sizeof *s);
    pel_mesh *mesh = unit_grid(160, 4);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        mesh->positions[v][0] *= 10;
    begin(s, mesh, 1.2e6, 0, 0.1);
    support(s, 0, 10, true, false, false, false);
    support_vertex(s, nearest(s, 10, 0, 0), false, true, false);
    pel_support_def *bed = support(s, 2, 0, false, false, true, false);
    assert_int_equal(bed->vertex_count, mesh->vertex_count);
    bed->foundation = stiffness;
    pel_load_def *load = load_vertex(s, 0, 0, 0, -force);
    load->kind = PEL_LOAD_PER_LENGTH;
    load->vertex_count = find(s, normal, 0, s->vertices[MOST_SUPPORTS]);
    solve(s);
    double way[3];
    pel_support_reading reading;
    moved(s, nearest(s, 0, 0.5, 0), way);
    assert_within(-way[2], 2 * force / stiffness, 5e-3);
    pel_sim_get_support_part(s->sim, 2, &reading);
    assert_within(reading.force[2], -force, 1e-6);
    assert_int_equal(reading.vertex_count, mesh->vertex_count);
    check_reactions(s->sim);
    end(s);
    free(s);
}

/* a support that moves in time carries the bar with it */
static void implicit_follows_a_support(void **state)
{
    (void)state;
    structure *s = malloc(sizeof *s);
    begin_bar(s);
    s->method = PEL_METHOD_IMPLICIT;
    s->supports[0].displacement[1] = 0.25;
    pel_error error;
    assert_int_equal(try_create(s, &error), PEL_OK);
    for (int i = 0; i < 100; i++)
        assert_int_equal(pel_sim_step(s->sim, &error), PEL_OK);
    double way[3];
    moved(s, nearest(s, 2, 0.5, 0), way);
    assert_within(way[1], 0.25, 0.02);
    end(s);
    free(s);
}

/* ---- bad supports ---- */

static void assert_sim_refused(structure *s, const char *words)
{
    pel_error error;
    char text[800];
    assert_int_equal(try_create(s, &error), PEL_BAD_ARGUMENT);
    pel_error_text(&error, text, sizeof text);
    if (strstr(text, words) == NULL)
        fail_msg("'%s' does not say '%s'", text, words);
    end(s);
}

static void bad_supports_are_refused(void **state)
{
    (void)state;
    structure *s = malloc(sizeof *s);
    begin_bar(s);
    s->supports[0].fix[0] = s->supports[0].fix_rotation = false;
    assert_sim_refused(s, "free to move along (1, 0, 0)");
    begin_bar(s);
    s->supports[0].fix_rotation = false;
    assert_sim_refused(s, "free to turn about the axis (0, 1, 0) through (0, ");
    begin_bar(s);
    s->body.shell.bending.model = PEL_BENDING_NONE;
    assert_sim_refused(s, "give the body bending of model midedge");
    begin_bar(s);
    s->body.shell.bending.model = PEL_BENDING_HINGE;
    assert_sim_refused(s, "support clamps edges, which only bending of model midedge has rotations for");
    begin_bar(s);
    support(s, 0, 0, true, false, false, false)->displacement[0] = 0.1;
    assert_sim_refused(s, "contradict each other at vertex");
    begin_bar(s);
    s->supports[0].displacement[0] = 0.1;
    s->body.pinned = s->supports[0].vertices;
    s->body.pinned_count = 1;
    assert_sim_refused(s, "which is pinned");
    begin_bar(s);
    s->supports[0].axes[0][1] = 0.1;
    assert_sim_refused(s, "not orthonormal");
    begin_bar(s);
    s->supports[0].stiffness = -1;
    assert_sim_refused(s, "stiffness of the support");
    begin_bar(s);
    s->supports[0].foundation = (double)NAN;
    assert_sim_refused(s, "foundation of the support");
    begin_bar(s);
    s->supports[0].foundation = s->supports[0].stiffness = 1;
    assert_sim_refused(s, "beside a stiffness");
    begin_bar(s);
    s->supports[0].foundation = 1;
    assert_sim_refused(s, "under no triangle");
    begin_bar(s);
    s->method = PEL_METHOD_XPBD;
    s->body.shell.bending.model = PEL_BENDING_HINGE;
    assert_sim_refused(s, "no supports of single components");
    begin_bar(s);
    load_vertex(s, 0, 1, 0, 0)->kind = PEL_LOAD_PER_LENGTH;
    assert_sim_refused(s, "acts on no boundary edge");
    begin_bar(s);
    load_vertex(s, 0, 1, 0, 0)->kind = PEL_LOAD_MOMENT;
    assert_sim_refused(s, "moment acts on no boundary edge");
    free(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(roof_is_the_reference),
        cmocka_unit_test(pinched_cylinder_is_the_reference),
        cmocka_unit_test(hemisphere_is_the_reference),
        cmocka_unit_test(cantilever_is_the_reference),
        cmocka_unit_test(moment_rolls_a_strip_up),
        cmocka_unit_test(plates_are_the_closed_forms),
        cmocka_unit_test(foundation_carries_a_beam),
        cmocka_unit_test(displacement_pulls_with_the_stiffness_of_the_bar),
        cmocka_unit_test(one_vertex_on_an_incline_is_pushed_along_its_normal),
        cmocka_unit_test(springs_are_in_series_with_the_bar),
        cmocka_unit_test(implicit_follows_a_support),
        cmocka_unit_test(bad_supports_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
