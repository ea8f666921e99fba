/* The default contact thickness of sheets: that of the membrane, as far as mesh and start leave room for it. It acts on
   nothing at the start, and stays what it was then. */
#include "touch/thickness.h"

#include "pellicle/live.h"
#include "pellicle/tear.h"
#include "sim/contact_scene.h"
#include "tool/tools.h"
#include "touch/contact.h"

enum { CELLS = 10 };
static const double edge = 0.1, sheet = 0.02;

/* a unit square of 10 x 10 cells, at the height z */
static pel_body_def *add_sheet(contact_scene *scene, double z)
{
    scene_body(scene, make_sheet(CELLS, 0));
    pel_body_def *body = &scene->bodies[scene->body_count - 1];
    for (int32_t v = 0; v < scene->meshes[scene->body_count - 1]->vertex_count; v++)
        scene->meshes[scene->body_count - 1]->positions[v][2] += z;
    body->spring_stiffness.value = body->spring_damping.value = 0;
    body->shell.membrane.on = true;
    body->shell.membrane.young.value = 1e4;
    body->shell.membrane.thickness.value = sheet;
    return body;
}

static pel_tool_def *add_tool(contact_scene *scene, pel_tool_shape shape, double z)
{
    pel_tool_def *tool = scene_tool(scene, shape);
    tool->radius = 0.3;
    tool->half_extents[0] = tool->half_extents[1] = tool->half_extents[2] = 0.3;
    scene_move(scene, scene->def.tool_count - 1, 0.5, 0.5, z, z, 1);
    return tool;
}

static double thickness_of(const pel_sim *sim)
{
    return pel_sim_body_contact_thickness(sim, 0);
}

static void assert_described(const pel_sim *sim, const char *part)
{
    char text[256];
    pel_contacts_describe_thickness(sim, 0, text, sizeof text);
    if (strstr(text, part) == NULL)
        print_error("'%s' is not in '%s'\n", part, text);
    assert_non_null(strstr(text, part));
}

/* nothing is near: the membrane and the mesh decide */
static void test_of_the_sheet(void **unused)
{
    (void)unused;
    const struct {
        double membrane, squeeze, expected;
        const char *text;
    } cases[] = {
        {0.02, 1, 0.02, "0.02 m of its sheet"},
        {0.5, 1, 0.25 * 0.1, "a quarter of its shortest edge; its sheet has 0.5 m"},
        /* heights of the triangles are half of a sixth of an edge */
        {0.02, 1.0 / 6, 0.25 / 60, "a quarter of its shortest edge"},
        /* thinner than what has no sheet */
        {1e-6, 1, 1e-4 * 1.4142135623730951, "thickness 0.000141 m"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        contact_scene scene;
        scene_begin(&scene, PEL_METHOD_XPBD);
        add_sheet(&scene, 0)->shell.membrane.thickness.value = cases[i].membrane;
        for (int32_t v = 0; v < scene.meshes[0]->vertex_count; v++)
            scene.meshes[0]->positions[v][0] *= cases[i].squeeze;
        pel_sim *sim = scene_create(&scene);
        assert_near(thickness_of(sim), cases[i].expected, 1e-12);
        assert_described(sim, cases[i].text);
        scene_end(&scene, sim);
    }
}

/* needles: long edges, and hardly any height */
static void test_of_needles(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    add_sheet(&scene, 0);
    double(*x)[3] = scene.meshes[0]->positions;
    /* shears the sheet along its rows, whose edges stay as long */
    for (int32_t v = 0; v < scene.meshes[0]->vertex_count; v++) {
        double row = x[v][1] / edge;
        x[v][0] += 0.999 * row * edge;
        x[v][1] = 0.05 * row * edge;
    }
    pel_sim *sim = scene_create(&scene);
    /* from the diagonal, nearly twice as long as an edge, to the corner beside it */
    assert_near(thickness_of(sim), 0.5 * 0.05 * edge * edge / sqrt(pow(1.999 * edge, 2) + pow(0.05 * edge, 2)), 1e-12);
    assert_described(sim, "half of its least height of a triangle");
    scene_end(&scene, sim);
}

/* these keep what they had: closed, rigid, of springs alone, given */
static void test_of_others(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < 5; kind++) {
        contact_scene scene;
        scene_begin(&scene, PEL_METHOD_XPBD);
        pel_body_def *body = add_sheet(&scene, 0);
        double expected = 1e-4 * sqrt(2);
        if (kind == 0) {
            body->shell.membrane.on = false;
            body->spring_stiffness.value = 30;
        } else if (kind == 1) {
            scene.def.contact.relative_thickness = 1e-4;
        } else if (kind == 2) {
            scene.def.contact.thickness = expected = 3e-3;
        } else if (kind == 3) {
            body->contact_thickness = expected = 4e-3;
        } else {
            pel_mesh_destroy(scene.meshes[0]);
            body->mesh = scene.meshes[0] = make_sphere(4);
            expected = 1e-4 * sqrt(12);
        }
        pel_sim *sim = scene_create(&scene);
        assert_near(thickness_of(sim), expected, kind == 4 ? 2e-5 : 1e-12);
        scene_end(&scene, sim);
    }
}

/* a fine body is searched as far as the thickest layer */
static void test_of_the_finest(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    add_sheet(&scene, 0);
    scene_body(&scene, make_moved_sphere(16, 0, 0, 3));
    for (int32_t v = 0; v < scene.meshes[1]->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            scene.meshes[1]->positions[v][k] *= 0.1;
    pel_sim *sim = scene_create(&scene);
    assert_true(thickness_of(sim) < 0.5 * sheet && thickness_of(sim) > 0.1 * sheet);
    assert_described(sim, "of the finest body");
    scene_end(&scene, sim);
}

typedef struct near_start {
    const char *name;
    double gap;
    double expected;
    double other; /* contact thickness of what is near; 0 = by default */
} near_start;

/* Nothing is pushed at the start, whatever is near: without loads all stays where it is, exactly. */
static void assert_rests(pel_sim *sim)
{
    pel_sim_ledger before, ledger;
    pel_start_gap gap;
    assert_int_equal(pel_contacts_find_start_gap(sim, &gap, NULL), PEL_OK);
    assert_int_equal(gap.count, 0);
    int32_t count = pel_sim_vertex_count(sim, 0);
    double *x = calloc((size_t)count, 24), *y = calloc((size_t)count, 24);
    pel_sim_get_positions(sim, 0, x);
    pel_sim_get_ledger(sim, &before);
    run_steps(sim, 20);
    pel_sim_get_positions(sim, 0, y);
    pel_sim_get_ledger(sim, &ledger);
    for (int32_t i = 0; i < 3 * count; i++)
        assert_near(y[i], x[i], IN_FLOAT(1e-12, 1e-7));
    assert_near(ledger.kinetic, 0, IN_FLOAT(1e-20, 1e-10));
    free(x);
    free(y);
}

static void test_near_starts(void **unused)
{
    (void)unused;
    const near_start starts[] = {
        {"sheet", 0.005, 0.99 * 0.005, 0},
        {"box", 0.005, 0.99 * 0.005, 0},
        {"sphere", 0.005, 0.99 * 0.005, 0},
        {"fold", 0.005, 0.99 * 0.005, 0},
        {"box", 0.005, 2 * 0.99 * 0.005 - 8e-3, 8e-3},
        {"sphere", 0.005, 2 * 0.99 * 0.005 - 8e-3, 8e-3},
    };
    for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
        const near_start *near = &starts[i];
        contact_scene scene;
        scene_begin(&scene, PEL_METHOD_XPBD);
        add_sheet(&scene, 0);
        if (strcmp(near->name, "sheet") == 0)
            add_sheet(&scene, near->gap);
        else if (strcmp(near->name, "box") == 0)
            add_tool(&scene, PEL_TOOL_BOX, -0.3 - near->gap)->thickness = near->other > 0 ? near->other : -1;
        else if (strcmp(near->name, "sphere") == 0)
            add_tool(&scene, PEL_TOOL_SPHERE, -0.3 - near->gap)->thickness = near->other > 0 ? near->other : -1;
        else {
            /* a crease, at which the half above comes back over the half below */
            double(*x)[3] = scene.meshes[0]->positions;
            for (int32_t v = 0; v < scene.meshes[0]->vertex_count; v++) {
                bool above = x[v][0] > 0.55, at = fabs(x[v][0] - 0.5) < 0.01;
                x[v][2] = above ? near->gap : at ? 0.5 * near->gap : 0;
                x[v][0] = above ? 1 - x[v][0] : x[v][0];
            }
        }
        pel_sim *sim = scene_create(&scene);
        if (fabs(thickness_of(sim) / near->expected - 1) > 0.05)
            print_error("%s: %g\n", near->name, thickness_of(sim));
        /* parts of the fold beside its crease are nearer */
        if (strcmp(near->name, "fold") == 0)
            assert_true(thickness_of(sim) < near->expected && thickness_of(sim) > 0.2 * near->expected);
        else
            assert_near(thickness_of(sim), near->expected, IN_FLOAT(1e-9, 1e-7));
        assert_described(sim, "it starts so near to");
        assert_rests(sim);
        scene_end(&scene, sim);
    }
}

/* a start in touch keeps what it had before there was a default of sheets */
static void test_in_touch(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    add_sheet(&scene, 0);
    add_sheet(&scene, 1e-7);
    pel_sim *sim = scene_create(&scene);
    assert_near(thickness_of(sim), pel_sim_contact_thickness(sim), 0);
    scene_end(&scene, sim);
}

/* ---- later ---- */

/* a sheet over a box that starts near, so that its thickness is that of the start */
static pel_sim *begin(contact_scene *scene, double gap)
{
    scene_begin(scene, PEL_METHOD_XPBD);
    add_sheet(scene, 0);
    add_tool(scene, PEL_TOOL_BOX, -0.3 - gap);
    scene->gravity = -10;
    scene->def.solver.drag = 10;
    return scene_create(scene);
}

static void cut_middle(pel_sim *sim)
{
    int32_t path[3];
    for (int32_t i = 0; i < 3; i++)
        path[i] = 5 * (CELLS + 1) + 4 + i;
    pel_error error;
    char text[400];
    pel_status status = pel_cut(sim, 0, path, 3, &error);
    if (status != PEL_OK)
        print_error("%s\n", pel_error_text(&error, text, sizeof text));
    assert_int_equal(status, PEL_OK);
}

/* cuts, changes and steps leave it as it was, and so do snapshots, also of what was cut */
static void test_stays(void **unused)
{
    (void)unused;
    for (int cuts = 0; cuts < 2; cuts++) {
        contact_scene scene;
        pel_sim *sim = begin(&scene, 0.005), *other = make_sim(&scene.def);
        double thickness = thickness_of(sim);
        assert_near(thickness, 0.99 * 0.005, IN_FLOAT(1e-9, 1e-7));
        run_steps(sim, 10);
        if (cuts)
            cut_middle(sim);
        run_steps(sim, 10);
        assert_true(thickness_of(sim) == thickness);
        assert_int_equal(pel_set_parameter(sim, "solver.drag", 11, NULL), PEL_OK);
        assert_int_equal(pel_set_parameter(other, "solver.drag", 11, NULL), PEL_OK);
        assert_true(thickness_of(sim) == thickness);
        assert_true(sim->layers[0].thickness == thickness && sim->contacts->largest == thickness);
        void *bytes = malloc(pel_sim_save_size(sim));
        pel_sim_save(sim, bytes);
        assert_int_equal(pel_sim_load(other, bytes, pel_sim_save_size(sim), NULL), PEL_OK);
        free(bytes);
        run_steps(sim, 10);
        run_steps(other, 10);
        assert_true(thickness_of(other) == thickness && pel_sim_hash(other) == pel_sim_hash(sim));
        assert_near(other->tools->items[0].press_margin, sim->tools->items[0].press_margin, 0);
        assert_described(other, "it starts so near to tool 'upper'");
        pel_sim_destroy(other);
        scene_end(&scene, sim);
    }
}

/* A change before the first step is one of the start; later ones find the limits of the start. */
static void test_changes(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = begin(&scene, 0.015);
    assert_near(thickness_of(sim), 0.99 * 0.015, IN_FLOAT(1e-9, 1e-7));
    assert_int_equal(pel_set_parameter(sim, "bodies.first.membrane.thickness", 0.01, NULL), PEL_OK);
    assert_near(thickness_of(sim), 0.01, 1e-12);
    run_steps(sim, 10);
    assert_int_equal(pel_set_parameter(sim, "contact.thickness", 0.004, NULL), PEL_OK);
    assert_near(thickness_of(sim), 0.004, 1e-12);
    run_steps(sim, 10);
    assert_int_equal(pel_set_parameter(sim, "contact.thickness", (double)NAN, NULL), PEL_OK);
    assert_int_equal(pel_set_parameter(sim, "bodies.first.membrane.thickness", 0.02, NULL), PEL_OK);
    assert_near(thickness_of(sim), 0.99 * 0.015, IN_FLOAT(1e-9, 1e-7));
    scene_end(&scene, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_of_the_sheet),  cmocka_unit_test(test_of_needles),  cmocka_unit_test(test_of_others),
        cmocka_unit_test(test_of_the_finest), cmocka_unit_test(test_near_starts), cmocka_unit_test(test_in_touch),
        cmocka_unit_test(test_stays),         cmocka_unit_test(test_changes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
