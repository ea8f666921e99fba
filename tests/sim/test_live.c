/* Changes between steps: continuation, refusals, and undo. */
#include "failing_malloc.h"
#include "pellicle/live.h"
#include "pellicle/sim_ledger.h"
#include "sim/fixture.h"
#include "stage/stage.h"

static pel_body_def shell_body(const pel_mesh *mesh)
{
    pel_body_def body = ball_body(mesh);
    body.mass_kind = PEL_MASS_DENSITY;
    body.mass = 1000;
    body.thickness.value = 0.01;
    body.shell.membrane.on = true;
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    body.shell.membrane.young.value = 1000;
    body.shell.membrane.thickness.value = 0.01;
    body.shell.bending.model = PEL_BENDING_HINGE;
    return body;
}

static const pel_pose_key standing[1] = {{0, {0, 0, 1.3}, {0, 0, 0, 1}, {0}}};
static const pel_pose_key pressing[2] = {{0, {0, 0, 1.25}, {0, 0, 0, 1}, {0}}, {0.1, {0, 0, 1.1}, {0, 0, 0, 1}, {0}}};

static pel_tool_def probe(const char *name)
{
    pel_tool_def tool = pel_tool_def_default();
    tool.name = name;
    tool.radius = 0.2;
    tool.keys = standing;
    tool.key_count = 1;
    return tool;
}

static stage make_stage(pel_method method, double dt)
{
    stage s;
    s.mesh = make_sphere(4);
    pel_body_def body = shell_body(s.mesh);
    s.model = make_model(&body);
    pel_sim_def def = lone_sim(s.model, method, dt);
    pel_tool_def tool = probe("probe");
    tool.keys = pressing;
    tool.key_count = 2;
    def.tools = &tool;
    def.tool_count = 1;
    s.sim = make_sim(&def);
    return s;
}

static double value_of(const pel_sim *sim, const char *path)
{
    pel_parameter_info info;
    assert_int_equal(pel_parameter_find(sim, path, &info, NULL), PEL_OK);
    return info.value[0];
}

static void set(pel_sim *sim, const char *path, double value)
{
    pel_error error;
    char text[800];
    if (pel_set_parameter(sim, path, value, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, text, sizeof text));
}

/* ---- continuation ---- */

/* a change keeps time, positions, velocities, tools and ledger; its energy is the work of setters */
static void test_goes_on(void **unused)
{
    (void)unused;
    static const pel_method methods[] = {PEL_METHOD_EXPLICIT, PEL_METHOD_PBD, PEL_METHOD_XPBD, PEL_METHOD_DESCENT,
                                         PEL_METHOD_IMPLICIT};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        stage s = make_stage(methods[m], 1e-3);
        run_steps(s.sim, 60);
        pel_sim_ledger before, after;
        pel_tool_reading held, still;
        uint64_t hash = pel_sim_hash(s.sim);
        pel_sim_get_ledger(s.sim, &before);
        pel_sim_get_tool(s.sim, 0, &held);
        set(s.sim, "bodies.ball.membrane.young", 1500);
        pel_sim_get_ledger(s.sim, &after);
        pel_sim_get_tool(s.sim, 0, &still);
        assert_int_equal(pel_sim_hash(s.sim), hash);
        assert_true(pel_sim_time(s.sim) > 0.059);
        assert_memory_equal(held.force, still.force, sizeof held.force);
        assert_memory_equal(held.position, still.position, sizeof held.position);
        assert_true(after.elastic > before.elastic);
        double booked = after.work_setters - before.work_setters,
               risen = after.elastic + after.kinetic - before.elastic - before.kinetic;
        assert_near(booked, risen, 1e-6 * fabs(risen));
        assert_near(after.energy_error - after.dissipated_solver, before.energy_error - before.dissipated_solver,
                    1e-6 * after.supplied);
        run_steps(s.sim, 10);
        assert_true(value_of(s.sim, "bodies.ball.membrane.young") == 1500);
        end_stage(&s);
    }
}

/* back and forth gives the bits of a run without a change, independent of rebuilds in between */
static void test_there_and_back(void **unused)
{
    (void)unused;
    static const pel_method methods[] = {PEL_METHOD_QUASI_STATIC, PEL_METHOD_EXPLICIT, PEL_METHOD_PBD,
                                         PEL_METHOD_DESCENT, PEL_METHOD_STATIC};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        stage a = make_stage(methods[m], 1e-3), b = make_stage(methods[m], 1e-3);
        run_steps(a.sim, 70);
        run_steps(b.sim, 30);
        set(b.sim, "bodies.ball.membrane.young", 3000);
        set(b.sim, "bodies.ball.membrane.young", 1000);
        run_steps(b.sim, 40);
        assert_int_equal(pel_sim_hash(a.sim), pel_sim_hash(b.sim));
        end_stage(&a);
        end_stage(&b);
    }
}

/* a stiffer ball is pressed in by a larger force */
static void test_has_its_effect(void **unused)
{
    (void)unused;
    stage s = make_stage(PEL_METHOD_STATIC, 0.02);
    pel_tool_reading soft, stiff;
    run_steps(s.sim, 6);
    pel_sim_get_tool(s.sim, 0, &soft);
    set(s.sim, "bodies.ball.membrane.young", 2000);
    set(s.sim, "bodies.ball.springs.stiffness", 6);
    set(s.sim, "bodies.ball.volumetric.stiffness", 3);
    run_steps(s.sim, 1);
    pel_sim_get_tool(s.sim, 0, &stiff);
    assert_true(soft.force[2] > 0);
    assert_near(stiff.force[2], 2 * soft.force[2], 0.1 * soft.force[2]);
    end_stage(&s);
}

/* ---- refusals ---- */

static void refuse(pel_sim *sim, const char *path, double value, const char *what, const char *remedy)
{
    pel_error error;
    uint64_t hash = pel_sim_hash(sim);
    pel_status status = pel_set_parameter(sim, path, value, &error);
    assert_true(status == PEL_BAD_ARGUMENT || status == PEL_UNSTABLE);
    if (strstr(error.what, what) == NULL || strstr(error.remedy, remedy) == NULL)
        fail_msg("'%s' / '%s' lacks '%s' / '%s'", error.what, error.remedy, what, remedy);
    assert_int_equal(pel_sim_hash(sim), hash);
}

static void test_refusals(void **unused)
{
    (void)unused;
    stage a = make_stage(PEL_METHOD_EXPLICIT, 1e-3), b = make_stage(PEL_METHOD_EXPLICIT, 1e-3);
    run_steps(a.sim, 20);
    run_steps(b.sim, 20);
    refuse(b.sim, "bodies.ball.membrane.young", -1, "cannot be -1", "> 0 Pa");
    refuse(b.sim, "bodies.ball.membrane.young", (double)NAN, "cannot be nan", "> 0 Pa");
    refuse(b.sim, "bodies.ball.membrane.poisson", 1.5, "cannot be 1.5", "above -1 to 1");
    refuse(b.sim, "bodies.ball.membrane.jung", 1, "is not a parameter", "bodies.ball.membrane.young");
    refuse(b.sim, "solver.dt", 0.1, "cannot change while", "substeps");
    refuse(b.sim, "solver.method", 0, "cannot change while", "make a simulation");
    refuse(b.sim, "gravity", 1, "kind of value", "three numbers");
    pel_parameter_info info;
    int word_count = 0;
    assert_int_equal(pel_parameter_find(b.sim, "bodies.ball.membrane.material", &info, NULL), PEL_OK);
    while (info.words[word_count] != NULL)
        word_count++;
    const double none[4] = {99, word_count, -1, 0.5};
    for (int i = 0; i < 4; i++)
        refuse(b.sim, "bodies.ball.membrane.material", none[i], "no such word", "neo-hookean");
    refuse(b.sim, "bodies.ball.membrane.young", 1e9, "unstable", "");
    const pel_key disordered[2] = {{1, 1}, {0, 1}}, key = {0, 1};
    assert_int_equal(pel_set_parameter_keys(b.sim, "bodies.ball.springs.stiffness", disordered, 2, NULL),
                     PEL_BAD_ARGUMENT);
    assert_int_equal(pel_set_parameter_keys(b.sim, "bodies.ball.membrane.young", &key, 1, NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_set_parameter_text(b.sim, "gravity", "[0, 0]", NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_set_parameter_text(b.sim, "solver.drag", "1x", NULL), PEL_BAD_ARGUMENT);
    /* refused changes leave no trace */
    run_steps(a.sim, 20);
    run_steps(b.sim, 20);
    assert_int_equal(pel_sim_hash(a.sim), pel_sim_hash(b.sim));
    pel_sim_ledger first, second;
    pel_sim_get_ledger(a.sim, &first);
    pel_sim_get_ledger(b.sim, &second);
    assert_memory_equal(&first, &second, sizeof first);
    end_stage(&a);
    end_stage(&b);
}

static void test_text(void **unused)
{
    (void)unused;
    stage s = make_stage(PEL_METHOD_XPBD, 1e-3);
    assert_int_equal(pel_set_parameter_text(s.sim, "gravity", " [0, 0, -9.81] ", NULL), PEL_OK);
    assert_int_equal(pel_set_parameter_text(s.sim, "bodies.0.membrane.material", "neo-hookean", NULL), PEL_OK);
    assert_int_equal(pel_set_parameter_text(s.sim, "tools.probe.press", "false", NULL), PEL_OK);
    assert_int_equal(pel_set_parameter_text(s.sim, "solver.substeps", "7", NULL), PEL_OK);
    pel_parameter_info info;
    assert_int_equal(pel_parameter_find(s.sim, "gravity", &info, NULL), PEL_OK);
    assert_true(info.value[2] == -9.81);
    assert_true(value_of(s.sim, "bodies.ball.membrane.material") == PEL_MEMBRANE_NEO_HOOKEAN);
    assert_true(value_of(s.sim, "tools.probe.press") == 0);
    assert_true(value_of(s.sim, "solver.substeps") == 7);
    assert_int_equal(pel_set_parameter_text(s.sim, "solver.substeps", "auto", NULL), PEL_OK);
    assert_true(isnan(value_of(s.sim, "solver.substeps")));
    end_stage(&s);
}

/* ---- loads, tools, pins, forces ---- */

static void test_add_and_remove(void **unused)
{
    (void)unused;
    static const pel_method methods[] = {PEL_METHOD_EXPLICIT, PEL_METHOD_XPBD, PEL_METHOD_IMPLICIT};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        stage s = make_stage(methods[m], 1e-3);
        run_steps(s.sim, 10);
        pel_load_def load = pel_load_def_default();
        load.name = "pull";
        load.force[0] = 2;
        assert_int_equal(pel_sim_add_load(s.sim, &load, NULL), PEL_OK);
        assert_int_equal(pel_sim_add_load(s.sim, &load, NULL), PEL_BAD_ARGUMENT);
        assert_string_equal(pel_sim_load_name(s.sim, 0), "pull");
        run_steps(s.sim, 20);
        pel_sim_ledger ledger;
        pel_sim_get_ledger(s.sim, &ledger);
        assert_true(ledger.work_loads > 0);
        assert_int_equal(pel_sim_remove_load(s.sim, 1, NULL), PEL_BAD_ARGUMENT);
        assert_int_equal(pel_sim_remove_load(s.sim, 0, NULL), PEL_OK);
        run_steps(s.sim, 5);
        double work = ledger.work_loads;
        pel_sim_get_ledger(s.sim, &ledger);
        assert_true(ledger.work_loads >= work - 1e-12);
        end_stage(&s);
    }
}

static void test_tools_come_and_go(void **unused)
{
    (void)unused;
    static const pel_method methods[] = {PEL_METHOD_QUASI_STATIC, PEL_METHOD_EXPLICIT, PEL_METHOD_XPBD,
                                         PEL_METHOD_IMPLICIT};
    for (size_t m = 0; m < sizeof methods / sizeof *methods - LONG(0, 1); m++) {
        stage s = make_stage(methods[m], 1e-3);
        run_steps(s.sim, 10);
        pel_error error;
        pel_tool_def tool = probe("second");
        pel_pose_key inside = {0, {0.9, 0, 0}, {0, 0, 0, 1}, {0}};
        tool.keys = &inside;
        assert_int_equal(pel_sim_add_tool(s.sim, &tool, &error), PEL_BAD_ARGUMENT);
        assert_non_null(strstr(error.what, "starts inside"));
        assert_int_equal(pel_sim_tool_count(s.sim), 1);
        const pel_pose_key keys[2] = {{0.01, {1.25, 0, 0}, {0, 0, 0, 1}, {0}}, {0.05, {1.1, 0, 0}, {0, 0, 0, 1}, {0}}};
        tool.keys = keys;
        tool.key_count = 2;
        assert_int_equal(pel_sim_add_tool(s.sim, &tool, &error), PEL_OK);
        pel_tool_reading reading;
        int pressed = 0;
        for (int n = 0; n < 40; n++) {
            run_steps(s.sim, 1);
            pel_sim_get_tool(s.sim, 1, &reading);
            pressed += reading.force[0] > 0 && reading.contact_count > 0;
        }
        assert_true(pressed > 10);
        assert_int_equal(pel_sim_remove_tool(s.sim, 0, NULL), PEL_OK);
        assert_string_equal(pel_sim_tool_name(s.sim, 0), "second");
        pel_tool_reading kept;
        pel_sim_get_tool(s.sim, 0, &kept);
        assert_memory_equal(kept.force, reading.force, sizeof kept.force);
        assert_memory_equal(kept.position, reading.position, sizeof kept.position);
        assert_int_equal(kept.contact_count, reading.contact_count);
        const pel_pose_key away = {0.05, {1.6, 0, 0}, {0, 0, 0, 1}, {0}};
        assert_int_equal(pel_sim_set_tool_keys(s.sim, 0, &away, 1, NULL), PEL_OK);
        run_steps(s.sim, 120);
        pel_sim_get_tool(s.sim, 0, &kept);
        assert_near(kept.position[0], 1.6, 1e-6);
        assert_int_equal(kept.contact_count, 0);
        end_stage(&s);
    }
}

/* pinned where it is; released it moves again */
static void test_pins(void **unused)
{
    (void)unused;
    stage s = make_stage(PEL_METHOD_XPBD, 1e-3);
    double *before = malloc(3 * (size_t)s.mesh->vertex_count * sizeof(double)),
           *after = malloc(3 * (size_t)s.mesh->vertex_count * sizeof(double));
    int32_t top = nearest_vertex(s.mesh, 0, 0, 1);
    run_steps(s.sim, 60);
    pel_sim_get_positions(s.sim, 0, before);
    assert_true(before[3 * top + 2] < 0.999);
    assert_int_equal(pel_sim_remove_tool(s.sim, 0, NULL), PEL_OK);
    assert_int_equal(pel_sim_set_pins(s.sim, 0, &top, 1, NULL), PEL_OK);
    run_steps(s.sim, 30);
    pel_sim_get_positions(s.sim, 0, after);
    for (int k = 0; k < 3; k++)
        assert_true(before[3 * top + k] == after[3 * top + k]);
    int32_t wrong = s.mesh->vertex_count;
    assert_int_equal(pel_sim_set_pins(s.sim, 0, &wrong, 1, NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_sim_set_pins(s.sim, 0, NULL, 0, NULL), PEL_OK);
    run_steps(s.sim, 30);
    pel_sim_get_positions(s.sim, 0, after);
    assert_true(before[3 * top + 2] != after[3 * top + 2]);
    free(before);
    free(after);
    end_stage(&s);
}

/* forces of the caller are those of a load */
static void test_forces(void **unused)
{
    (void)unused;
    static const pel_method methods[] = {PEL_METHOD_QUASI_STATIC, PEL_METHOD_EXPLICIT, PEL_METHOD_XPBD,
                                         PEL_METHOD_STATIC, PEL_METHOD_IMPLICIT};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        stage a = make_stage(methods[m], 1e-3), b = make_stage(methods[m], 1e-3);
        double *forces = calloc(3 * (size_t)a.mesh->vertex_count, sizeof *forces);
        pel_load_def load = pel_load_def_default();
        load.kind = PEL_LOAD_PER_VERTEX;
        load.force[1] = 1e-3;
        for (int32_t v = 0; v < a.mesh->vertex_count; v++)
            forces[3 * v + 1] = 1e-3;
        assert_int_equal(pel_sim_add_load(a.sim, &load, NULL), PEL_OK);
        assert_int_equal(pel_sim_set_forces(b.sim, 0, forces, NULL), PEL_OK);
        run_steps(a.sim, 20);
        run_steps(b.sim, 20);
        assert_int_equal(pel_sim_hash(a.sim), pel_sim_hash(b.sim));
        pel_sim_ledger first, second;
        pel_sim_get_ledger(a.sim, &first);
        pel_sim_get_ledger(b.sim, &second);
        assert_near(first.work_loads, second.work_loads, 1e-6 * fabs(first.work_loads));
        forces[7] = (double)NAN;
        assert_int_equal(pel_sim_set_forces(b.sim, 0, forces, NULL), PEL_BAD_ARGUMENT);
        assert_int_equal(pel_sim_set_forces(b.sim, 0, NULL, NULL), PEL_OK);
        assert_int_equal(pel_sim_set_forces(b.sim, 1, NULL, NULL), PEL_BAD_ARGUMENT);
        free(forces);
        end_stage(&a);
        end_stage(&b);
    }
}

/* ---- picking and dragging ---- */

static void test_pick(void **unused)
{
    (void)unused;
    stage s = make_stage(PEL_METHOD_XPBD, 1e-3);
    const double origin[3] = {3, 0.1, 0.05}, direction[3] = {-2, 0, 0}, away[3] = {1, 0, 0}, none[3] = {0, 0, 0};
    pel_pick_hit hit;
    assert_int_equal(pel_pick(s.sim, origin, direction, &hit, NULL), PEL_OK);
    assert_true(hit.is_hit && hit.body == 0);
    assert_near(hit.point[1], 0.1, 1e-12);
    assert_near(hit.point[2], 0.05, 1e-12);
    assert_near(hit.distance, 3 - hit.point[0], 1e-12);
    assert_near(hit.weights[0] + hit.weights[1] + hit.weights[2], 1, 1e-12);
    assert_true(hit.normal[0] > 0.9 && hit.mesh_vertex >= 0);
    /* near a vertex the nearest of the mesh is that vertex, whichever corner of the triangle it is */
    for (int32_t v = 0; v < s.mesh->vertex_count; v++) {
        double from[3], inward[3];
        for (int i = 0; i < 3; i++) {
            from[i] = 3 * s.mesh->positions[v][i] + (i == 0 ? 1e-3 : 0);
            inward[i] = -s.mesh->positions[v][i];
        }
        assert_int_equal(pel_pick(s.sim, from, inward, &hit, NULL), PEL_OK);
        assert_true(hit.is_hit);
        assert_int_equal(hit.mesh_vertex, v);
    }
    assert_int_equal(pel_pick(s.sim, origin, away, &hit, NULL), PEL_OK);
    assert_false(hit.is_hit);
    assert_int_equal(pel_pick(s.sim, origin, none, &hit, NULL), PEL_BAD_ARGUMENT);
    end_stage(&s);
}

/* rays of any finite direction, on the surface as well; an origin so far that its distance overflows is told */
static void test_odd_rays(void **unused)
{
    (void)unused;
    stage s = make_stage(PEL_METHOD_XPBD, 1e-3);
    static const double lengths[] = {1e-320, 1e-200, 1, 1e200, 1.7e308};
    const double origin[3] = {3, 0.1, 0.05}, far[3] = {1e300, 0, 0}, along[3] = {-1, 0, 0},
                 bad[3] = {0, (double)NAN, 0};
    pel_pick_hit first, hit;
    pel_error error;
    assert_int_equal(pel_pick(s.sim, origin, along, &first, NULL), PEL_OK);
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        const double direction[3] = {-lengths[i], 0, 0};
        assert_int_equal(pel_pick(s.sim, origin, direction, &hit, NULL), PEL_OK);
        assert_memory_equal(&hit, &first, sizeof hit);
    }
    assert_int_equal(pel_pick(s.sim, first.point, along, &hit, NULL), PEL_OK);
    assert_false(signbit(hit.distance));
    assert_int_equal(pel_pick(s.sim, bad, along, &hit, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "not finite"));
    assert_int_equal(pel_pick(s.sim, far, along, &hit, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "too far away: 1e+300"));
    end_stage(&s);
}

/* what a refusal of a vector and of no keys suggests */
static void test_refused_shapes(void **unused)
{
    (void)unused;
    stage s = make_stage(PEL_METHOD_XPBD, 1e-3);
    const double bad[3] = {0, (double)NAN, 0};
    const pel_key key = {0, 1};
    pel_error error;
    assert_int_equal(pel_set_parameter_vector(s.sim, "gravity", bad, &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.remedy, "give three numbers: finite, in m/s2");
    pel_parameter_info info = {.may_be_keyed = false};
    for (int32_t i = 0; !info.may_be_keyed && i < pel_parameter_count(s.sim); i++)
        pel_parameter_at(s.sim, i, &info);
    assert_true(info.may_be_keyed);
    assert_int_equal(pel_set_parameter_keys(s.sim, info.path, &key, 0, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.remedy, "one or more keys"));
    end_stage(&s);
}

/* at rest the spring pulls with the force that the surface gives back, and the point is between surface and target */
static void test_drag(void **unused)
{
    (void)unused;
    static const pel_method methods[] = {PEL_METHOD_QUASI_STATIC, PEL_METHOD_EXPLICIT, PEL_METHOD_PBD,
                                         PEL_METHOD_XPBD,         PEL_METHOD_DESCENT,  PEL_METHOD_STATIC,
                                         PEL_METHOD_IMPLICIT};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        stage s = make_stage(methods[m], 2e-3);
        set(s.sim, "bodies.ball.mass.density", 10);
        assert_int_equal(pel_sim_remove_tool(s.sim, 0, NULL), PEL_OK);
        if (methods[m] == PEL_METHOD_EXPLICIT || methods[m] == PEL_METHOD_PBD || methods[m] == PEL_METHOD_XPBD)
            set(s.sim, "solver.drag", 5);
        const double origin[3] = {3, 0, 0}, direction[3] = {-1, 0, 0};
        pel_pick_hit hit;
        pel_drag *drag;
        pel_drag_reading reading;
        assert_int_equal(pel_pick(s.sim, origin, direction, &hit, NULL), PEL_OK);
        assert_int_equal(pel_drag_begin(s.sim, &hit, 20, 0.1, &drag, NULL), PEL_OK);
        double target[3] = {hit.point[0] + 0.2, hit.point[1], hit.point[2]};
        double hardest = 0;
        int steps = methods[m] == PEL_METHOD_STATIC || methods[m] == PEL_METHOD_DESCENT ? 30
                    : methods[m] == PEL_METHOD_IMPLICIT                                 ? LONG(1500, 40)
                                                                                        : ROUNDS(1500, 40);
        for (int i = 0; i < steps; i++) {
            assert_int_equal(pel_drag_move(drag, target, NULL), PEL_OK);
            run_steps(s.sim, 1);
            pel_drag_get(drag, &reading);
            hardest = fmax(hardest, fabs(reading.reaction[0]));
        }
        assert_true(reading.held_count > 0);
        /* the hand does not shake: nothing is much harder than the spring when it begins, 4 N */
        assert_true(hardest < 7);
        assert_true(reading.point[0] > hit.point[0] + 0.001 && reading.point[0] < target[0] + 1e-9);
        if (methods[m] != PEL_METHOD_PBD && steps != 40) {
            assert_true(reading.force[0] > 0);
            assert_near(reading.reaction[0], -reading.force[0], 0.02 * fabs(reading.force[0]));
            /* that of the states of rest */
            assert_near(reading.force[0], 1.1397, IN_FLOAT(0.01, 0.1));
        }
        assert_int_equal(pel_drag_end(drag, NULL), PEL_OK);
        assert_int_equal(pel_sim_tool_count(s.sim), 0);
        run_steps(s.sim, 2);
        end_stage(&s);
    }
}

/* ---- snapshots ---- */

static void test_undo(void **unused)
{
    (void)unused;
    static const pel_method methods[] = {PEL_METHOD_QUASI_STATIC, PEL_METHOD_EXPLICIT, PEL_METHOD_XPBD,
                                         PEL_METHOD_DESCENT, PEL_METHOD_IMPLICIT};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        stage s = make_stage(methods[m], 1e-3), other = make_stage(methods[m], 1e-3);
        pel_snapshot *start, *middle;
        double *forces = calloc(3 * (size_t)s.mesh->vertex_count, sizeof *forces);
        forces[0] = 1e-3;
        assert_int_equal(pel_snapshot_create(s.sim, &start, NULL), PEL_OK);
        uint64_t at_start = pel_sim_hash(s.sim);
        run_steps(s.sim, 15);
        assert_int_equal(pel_snapshot_create(s.sim, &middle, NULL), PEL_OK);
        assert_true(pel_snapshot_size(middle) > 1000);
        uint64_t at_middle = pel_sim_hash(s.sim);
        run_steps(s.sim, 10);
        uint64_t at_end = pel_sim_hash(s.sim);
        /* everything changes */
        pel_tool_def tool = probe("second");
        const pel_pose_key low = {0, {0, 0, -1.4}, {0, 0, 0, 1}, {0}};
        tool.keys = &low;
        assert_int_equal(pel_sim_add_tool(s.sim, &tool, NULL), PEL_OK);
        set(s.sim, "bodies.ball.membrane.young", 700);
        assert_int_equal(pel_sim_set_forces(s.sim, 0, forces, NULL), PEL_OK);
        run_steps(s.sim, 10);
        assert_int_equal(pel_snapshot_restore(other.sim, middle, NULL), PEL_BAD_ARGUMENT);
        assert_int_equal(pel_snapshot_restore(s.sim, middle, NULL), PEL_OK);
        assert_int_equal(pel_sim_hash(s.sim), at_middle);
        assert_int_equal(pel_sim_tool_count(s.sim), 1);
        assert_true(value_of(s.sim, "bodies.ball.membrane.young") == 1000);
        run_steps(s.sim, 10);
        assert_int_equal(pel_sim_hash(s.sim), at_end);
        assert_int_equal(pel_snapshot_restore(s.sim, start, NULL), PEL_OK);
        assert_int_equal(pel_sim_hash(s.sim), at_start);
        run_steps(s.sim, 25);
        assert_int_equal(pel_sim_hash(s.sim), at_end);
        pel_snapshot_destroy(start);
        pel_snapshot_destroy(middle);
        free(forces);
        end_stage(&s);
        end_stage(&other);
    }
}

/* a step that fails leaves the state before it, also after a change; the change can be undone */
static void test_divergence(void **unused)
{
    (void)unused;
    stage s = make_stage(PEL_METHOD_EXPLICIT, 1e-3);
    pel_snapshot *snapshot;
    pel_error error;
    run_steps(s.sim, 10);
    assert_int_equal(pel_snapshot_create(s.sim, &snapshot, NULL), PEL_OK);
    uint64_t hash = pel_sim_hash(s.sim), last = hash;
    pel_load_def load = pel_load_def_default();
    load.force[0] = 1e12;
    assert_int_equal(pel_sim_add_load(s.sim, &load, NULL), PEL_OK);
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < 100; i++) {
        last = pel_sim_hash(s.sim);
        status = pel_sim_step(s.sim, &error);
    }
    assert_int_equal(status, PEL_DIVERGED);
    assert_int_equal(pel_sim_hash(s.sim), last);
    assert_int_equal(pel_snapshot_restore(s.sim, snapshot, NULL), PEL_OK);
    assert_int_equal(pel_sim_hash(s.sim), hash);
    run_steps(s.sim, 10);
    pel_snapshot_destroy(snapshot);
    end_stage(&s);
}

/* ---- memory ---- */

static pel_status change_young(const void *data, pel_error *error)
{
    pel_sim *sim = *(pel_sim *const *)data;
    double value = value_of(sim, "bodies.ball.membrane.young");
    uint64_t hash = pel_sim_hash(sim);
    pel_status status = pel_set_parameter(sim, "bodies.ball.membrane.young", value + 1, error);
    assert_int_equal(pel_sim_hash(sim), hash);
    assert_true((value_of(sim, "bodies.ball.membrane.young") == value) == (status != PEL_OK));
    return status;
}

static pel_status keep(const void *data, pel_error *error)
{
    pel_snapshot *snapshot;
    pel_status status = pel_snapshot_create(*(pel_sim *const *)data, &snapshot, error);
    pel_snapshot_destroy(snapshot);
    return status;
}

static pel_status drag_once(const void *data, pel_error *error)
{
    pel_sim *sim = *(pel_sim *const *)data;
    const double origin[3] = {3, 0, 0}, direction[3] = {-1, 0, 0};
    pel_pick_hit hit;
    pel_drag *drag = NULL;
    pel_status status = pel_pick(sim, origin, direction, &hit, error);
    if (status == PEL_OK)
        status = pel_drag_begin(sim, &hit, 20, 0.1, &drag, error);
    if (status != PEL_OK)
        return status;
    status = pel_drag_end(drag, error);
    while (pel_sim_tool_count(sim) > 1)
        (void)pel_sim_remove_tool(sim, 1, NULL);
    return status;
}

/* the n-th allocation fails; blocks that stay are those of the sim, so their number is compared before and after */
static void check_failures(allocation_case *run, pel_sim *sim)
{
    long n = 0;
    for (bool is_done = false; !is_done && n < 2000;) {
        pel_error error = {.status = PEL_OK};
        failing_malloc_begin(++n);
        pel_status status = run(&sim, &error);
        allocation_count count = failing_malloc_end();
        is_done = count.failed == 0;
        if (!is_done && !count.failed_shrink) {
            assert_int_equal(status, PEL_OUT_OF_MEMORY);
            assert_int_equal(error.status, PEL_OUT_OF_MEMORY);
        }
    }
    assert_in_range(n, 5, 1999);
    run_steps(sim, 2);
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    stage s = make_stage(PEL_METHOD_XPBD, 1e-3);
    run_steps(s.sim, 3);
    check_failures(change_young, s.sim);
    check_failures(keep, s.sim);
    assert_true(for_every_allocation_failure(keep, &s.sim) > 3);
    end_stage(&s);
    s = make_stage(PEL_METHOD_XPBD, 1e-3);
    check_failures(drag_once, s.sim);
    end_stage(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_goes_on),
        cmocka_unit_test(test_there_and_back),
        cmocka_unit_test(test_has_its_effect),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_add_and_remove),
        cmocka_unit_test(test_tools_come_and_go),
        cmocka_unit_test(test_pins),
        cmocka_unit_test(test_forces),
        cmocka_unit_test(test_pick),
        cmocka_unit_test(test_odd_rays),
        cmocka_unit_test(test_refused_shapes),
        cmocka_unit_test(test_drag),
        cmocka_unit_test(test_undo),
        cmocka_unit_test(test_divergence),
        cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
