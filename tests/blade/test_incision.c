/* Blades: the cut is where the edge went, at any speed and under every method; its resistance against the energy that
   the tool spends; snapshots, threads, hooks, and what is refused. */
#include "sim/cut_fixture.h"

#include "failing_malloc.h"
#include "pellicle/live.h"
#include "pellicle/sim.h"
#include "pellicle/tear.h"
#include "stage/stage.h"
#include "tool/tool.h"

#define LENGTH 0.1
#define WIDTH 0.06
#define YOUNG 1e6
#define THICKNESS 1e-3
#define EDGE (LENGTH / 30)

typedef struct sheet {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
} sheet;

/* pinned along both long borders */
static pel_model *model_of(const pel_mesh *mesh)
{
    static int32_t pins[2000];
    pel_body_def body = pel_body_def_sheet("shell", mesh, YOUNG, THICKNESS, 1000);
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (fabs(fabs(mesh->positions[v][1]) - WIDTH / 2) < 1e-9)
            pins[body.pinned_count++] = v;
    body.pinned = pins;
    return make_model(&body);
}

/* hangs from the border of the largest y */
static pel_model *soft_model(const pel_mesh *mesh)
{
    int32_t pins[32];
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_NEO_HOOKEAN);
    body.shell.membrane.young.value = 1e4;
    body.shell.membrane.thickness.value = 0.01;
    body.spring_stiffness.value = body.spring_damping.value = body.volumetric_stiffness.value = 0;
    body.mass_kind = PEL_MASS_DENSITY;
    body.mass = 1000;
    body.thickness.value = 0.01;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (mesh->positions[v][1] > 0.49)
            pins[body.pinned_count++] = v;
    body.pinned = pins;
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    def.gravity[1] = -1;
    def.gravity[2] = 0.2;
    pel_model *model;
    assert_int_equal(pel_model_create(&def, &model, NULL), PEL_OK);
    return model;
}

static pel_tool_def straight(pel_pose_key keys[2], double duration)
{
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "blade";
    tool.shape = PEL_TOOL_BLADE;
    tool.edge[0][2] = -0.01;
    tool.edge[1][2] = 0.01;
    keys[0] = (pel_pose_key){.position = {-0.6 * LENGTH, -0.0061, 0}, .rotation = {0, 0, 0, 1}};
    keys[1] = (pel_pose_key){.time = duration, .position = {0.3 * LENGTH, 0.0073, 0}, .rotation = {0, 0, 0, 1}};
    tool.keys = keys;
    tool.key_count = 2;
    return tool;
}

static sheet make_sheet(pel_method method, double dt, const pel_tool_def *tool, int threads)
{
    sheet s = {.mesh = make_grid(30, 18, LENGTH, WIDTH, PEL_GRID_ONE_DIAGONAL)};
    s.model = model_of(s.mesh);
    pel_sim_def def = lone_sim(s.model, method, dt);
    def.tools = tool;
    def.tool_count = 1;
    def.thread_count = threads;
    s.sim = make_sim(&def);
    return s;
}

static void end_sheet(sheet *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
}

static double length_of(const pel_sim *sim)
{
    pel_cut_reading reading;
    assert_int_equal(pel_sim_get_cuts(sim, 0, &reading, NULL), PEL_OK);
    return reading.length;
}

static void step(pel_sim *sim, int count)
{
    pel_error error;
    for (int i = 0; i < count; i++)
        if (pel_sim_step(sim, &error) != PEL_OK)
            fail_msg("%s: %s", error.what, error.remedy);
}

/* m, the farthest vertex of the cut from the way of the blade */
static double farthest(const sheet *s, const pel_tool_def *tool)
{
    int32_t count = pel_sim_vertex_count(s->sim, 0);
    int32_t *origins = calloc((size_t)count, sizeof *origins);
    const pel_mesh *mesh = s->sim->given->bodies[0].mesh;
    double most = 0, along[3], arm[3];
    pel_vec3_subtract(tool->keys[1].position, tool->keys[0].position, along);
    pel_vec3_normalize(along);
    pel_sim_get_origins(s->sim, 0, origins);
    for (int32_t v = 0; v < count; v++) {
        if (origins[v] == v)
            continue;
        pel_vec3_subtract(mesh->positions[v], tool->keys[0].position, arm);
        double off = fabs(arm[0] * along[1] - arm[1] * along[0]);
        most = off > most ? off : most;
    }
    free(origins);
    return most;
}

/* ---- without resistance ---- */

static const pel_method methods[] = {PEL_METHOD_XPBD, PEL_METHOD_IMPLICIT, PEL_METHOD_EXPLICIT};

/* from one step to 200, the same way is cut */
static void any_speed(void **unused)
{
    (void)unused;
    const int counts[] = {2, 7, 20};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++)
        for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
            double dt = methods[m] == PEL_METHOD_EXPLICIT ? 2e-6 : 1e-3;
            pel_pose_key keys[2];
            pel_tool_def tool = straight(keys, counts[i] * dt);
            sheet s = make_sheet(methods[m], dt, &tool, 1);
            step(s.sim, counts[i] + 1);
            double whole = pel_vec3_distance(keys[0].position, keys[1].position) * 0.8 / 0.9;
            assert_near(length_of(s.sim), whole, EDGE);
            assert_true(farthest(&s, &tool) < 0.1 * EDGE);
            pel_tool_reading reading;
            pel_sim_get_tool(s.sim, 0, &reading);
            assert_near(pel_vec3_length(reading.force), 0, 0);
            end_sheet(&s);
        }
}

/* with contact a sheet at rest is cut too, wherever its first vertex has to move to */
static void beside_contact(void **unused)
{
    (void)unused;
    for (int i = 0; i < 6; i++) {
        sheet s = {.mesh = make_grid(12, 12, 1, 1, PEL_GRID_ONE_DIAGONAL)};
        pel_pose_key keys[2];
        pel_tool_def tool = straight(keys, 0.02);
        tool.edge[0][2] = -0.2;
        tool.edge[1][2] = 0.2;
        keys[0].position[0] = -0.52;
        keys[1].position[0] = -0.12;
        keys[0].position[1] = keys[1].position[1] = 0.17 + 0.015 * i;
        s.model = model_of(s.mesh);
        pel_sim_def def = lone_sim(s.model, PEL_METHOD_XPBD, 1e-3);
        def.tools = &tool;
        def.tool_count = 1;
        def.contact.enabled = true;
        def.contact.thickness = 1.4e-4;
        s.sim = make_sim(&def);
        step(s.sim, 22);
        assert_near(length_of(s.sim), 0.38, 0.08);
        end_sheet(&s);
    }
}

/* a sheet that hangs and swings: a vertex that moves onto the way and opens at once takes its copy along */
static void swinging(void **unused)
{
    (void)unused;
    for (int i = 0; i < 8; i++) {
        pel_pose_key keys[2];
        pel_tool_def tool = straight(keys, i < 4 ? 0.25 : 0.05);
        for (int k = 0; k < 2; k++) {
            keys[k].position[0] = k == 0 ? -0.52 : -0.12;
            keys[k].position[1] = i % 2 == 0 ? 0.2 : 0.22;
            keys[k].time += 0.12;
            tool.edge[k][2] = k == 0 ? -0.2 : 0.2;
        }
        sheet s = {.mesh = make_grid(12, 12, 1, 1, PEL_GRID_ONE_DIAGONAL)};
        s.model = soft_model(s.mesh);
        pel_sim_def def = lone_sim(s.model, i % 4 < 2 ? PEL_METHOD_XPBD : PEL_METHOD_IMPLICIT, 0.01);
        def.tools = &tool;
        def.tool_count = 1;
        def.contact.enabled = true;
        def.contact.thickness = 1.4e-4;
        s.sim = make_sim(&def);
        for (int n = 0; n < 50; n++) {
            int32_t count = pel_sim_vertex_count(s.sim, 0);
            step(s.sim, 1);
            assert_true(farthest_new_copy(s.sim, count) < 1e-3);
        }
        pel_sim_ledger ledger;
        pel_sim_get_ledger(s.sim, &ledger);
        assert_near(length_of(s.sim), 0.38, 0.08);
        assert_true(fabs(ledger.energy_error) < 0.02 * ledger.supplied);
        assert_true(fabs(ledger.dissipated_remesh) < 0.01 * ledger.supplied);
        end_sheet(&s);
    }
}

/* over both borders: two pieces */
static void falls_apart(void **unused)
{
    (void)unused;
    for (int count = 1; count < 40; count = 3 * count + 1) {
        pel_pose_key keys[2];
        pel_tool_def tool = straight(keys, count * 1e-3);
        keys[1].position[0] = 0.6 * LENGTH;
        sheet s = make_sheet(PEL_METHOD_IMPLICIT, 1e-3, &tool, 1);
        step(s.sim, count + 1);
        pel_cut_reading reading;
        assert_int_equal(pel_sim_get_cuts(s.sim, 0, &reading, NULL), PEL_OK);
        assert_int_equal(reading.island_count, 1);
        end_sheet(&s);
    }
}

/* a point that dips into the sheet, is led through it and comes out again */
static void inside(void **unused)
{
    (void)unused;
    pel_pose_key keys[2];
    const pel_pose_key way[] = {{.position = {-0.02, 0, 0.012}, .rotation = {0, 0, 0, 1}},
                                {.time = 0.01, .position = {-0.02, 0, 0.005}, .rotation = {0, 0, 0, 1}},
                                {.time = 0.04, .position = {0.02, 0.003, 0.005}, .rotation = {0, 0, 0, 1}},
                                {.time = 0.05, .position = {0.02, 0.003, 0.02}, .rotation = {0, 0, 0, 1}}};
    pel_tool_def tool = straight(keys, 1);
    tool.keys = way;
    tool.key_count = 4;
    sheet s = make_sheet(PEL_METHOD_IMPLICIT, 1e-3, &tool, 1);
    step(s.sim, 60);
    assert_near(length_of(s.sim), 0.0401, EDGE);
    /* three edges above the sheet it has left the end of its cut */
    assert_int_equal(s.sim->tools->items[0].blade->tip_count, 0);
    double length = length_of(s.sim);
    step(s.sim, 10);
    assert_near(length_of(s.sim), length, 0);
    end_sheet(&s);
}

/* an edge that lies along the sheet and falls through it cuts all of its length at once */
static void guillotine(void **unused)
{
    (void)unused;
    pel_pose_key keys[2];
    pel_tool_def tool = straight(keys, 0.01);
    tool.edge[0][0] = -0.02;
    tool.edge[1][0] = 0.021;
    tool.edge[0][2] = tool.edge[1][2] = 0;
    keys[0] = (pel_pose_key){.position = {0, 0.001, 0.01}, .rotation = {0, 0, 0, 1}};
    keys[1] = (pel_pose_key){.time = 0.01, .position = {0, 0.001, -0.01}, .rotation = {0, 0, 0, 1}};
    sheet s = make_sheet(PEL_METHOD_XPBD, 1e-3, &tool, 1);
    step(s.sim, 12);
    assert_near(length_of(s.sim), 0.041, 1.5 * EDGE);
    end_sheet(&s);
}

/* ---- resistance ---- */

#define SHARPNESS 1000.0

typedef struct firm_case {
    pel_method method;
    double dt, sharpness;
} firm_case;

/* the force is sharpness times thickness from the first edge on, in steps of all lengths, and its work is the energy of
   the new area but for the edges behind the blade; the cut lies on the way of the blade, and never runs ahead of it */
static void cut_firmly(const firm_case *c)
{
    pel_pose_key keys[2];
    pel_tool_def tool = straight(keys, 0.2);
    double limit = c->sharpness * THICKNESS, mean = 0, largest = 0;
    int count = (int)(0.2 / c->dt + 0.5);
    tool.sharpness = c->sharpness;
    sheet s = make_sheet(c->method, c->dt, &tool, 1);
    for (int i = 0; i < count; i++) {
        pel_tool_reading reading;
        step(s.sim, 1);
        pel_sim_get_tool(s.sim, 0, &reading);
        double force = pel_vec3_length(reading.force);
        mean += 2 * i >= count ? 2 * force / count : 0;
        largest = 2 * i >= count && force > largest ? force : largest;
        double way = (i + 1.0) / count * pel_vec3_distance(keys[0].position, keys[1].position) - 0.1 * LENGTH;
        assert_true(length_of(s.sim) < (way > 0 ? way : 0) + EDGE);
    }
    pel_sim_ledger ledger;
    pel_sim_get_ledger(s.sim, &ledger);
    /* static holds the vertex, and its force is low for some steps once an edge has opened */
    bool is_static = c->method == PEL_METHOD_STATIC;
    assert_near(mean, limit, (is_static ? 0.2 : 0.01) * limit);
    assert_near(largest, limit, (is_static ? 0.6 : 0.01) * limit);
    assert_true(length_of(s.sim) > 0.07 && farthest(&s, &tool) < EDGE);
    assert_near(ledger.dissipated_fracture, limit * length_of(s.sim), 1e-9);
    assert_near(ledger.work_tools, ledger.dissipated_fracture, (is_static ? 0.1 : 0.06) * ledger.dissipated_fracture);
    end_sheet(&s);
}

static void resistance(void **unused)
{
    (void)unused;
    const firm_case cases[] = {
        {PEL_METHOD_IMPLICIT, 1e-3, 0.3 * SHARPNESS}, {PEL_METHOD_XPBD, 1e-3, SHARPNESS},
        {PEL_METHOD_QUASI_STATIC, 1e-3, SHARPNESS},   {PEL_METHOD_DESCENT, 1e-3, 0.3 * SHARPNESS},
        {PEL_METHOD_EXPLICIT, 2e-5, 0.3 * SHARPNESS}, {PEL_METHOD_IMPLICIT, 5e-4, SHARPNESS},
        {PEL_METHOD_XPBD, 2.5e-4, 0.3 * SHARPNESS},   {PEL_METHOD_STATIC, 1e-3, 0.3 * SHARPNESS},
    };
    for (int i = 0; i < LONG(8, 5); i++)
        cut_firmly(&cases[i]);
}

/* along its edge a blade holds nothing: drawn out of the sheet after its cut it does not pull the end of it along */
static void draws_out(void **unused)
{
    (void)unused;
    pel_pose_key keys[3];
    pel_tool_def tool = straight(keys, 0.1);
    double pulled = 0;
    tool.sharpness = 0.3 * SHARPNESS;
    tool.edge[0][2] = -0.05;
    tool.edge[1][2] = 0.05;
    pel_vec3_set(keys[1].position, 0, 0.001, 0);
    keys[2] = (pel_pose_key){.time = 0.15, .position = {0, 0.001, 0.04}, .rotation = {0, 0, 0, 1}};
    tool.key_count = 3;
    sheet s = make_sheet(PEL_METHOD_STATIC, 1e-3, &tool, 1);
    step(s.sim, 100);
    assert_true(length_of(s.sim) > 0.03 && s.sim->tools->items[0].held_count == 1);
    for (int i = 0; i < 50; i++) {
        pel_tool_reading reading;
        step(s.sim, 1);
        pel_sim_get_tool(s.sim, 0, &reading);
        pulled = fmax(pulled, fabs(reading.force[2]));
    }
    assert_true(pulled < 0.05 * tool.sharpness * THICKNESS);
    end_sheet(&s);
}

/* A blade that comes down in the middle of a sheet, goes through it with its point and on across it: its force is the
   limit while it goes on, in long and short steps. What it pulled as it came through has another direction, and the
   vertex at the end of the cut swings along the edge and past the blade: once each of these let it cut for nothing. */
static void pierces_and_goes_on(void **unused)
{
    (void)unused;
    const double dt[] = {0.01, 0.002};
    const pel_pose_key way[] = {{.position = {-0.02, 0, 0.021}, .rotation = {0, 0, 0, 1}},
                                {.time = 0.1, .position = {-0.02, 0, -0.01}, .rotation = {0, 0, 0, 1}},
                                {.time = 0.5, .position = {0.03, 0, -0.01}, .rotation = {0, 0, 0, 1}}};
    for (int i = 0; i < 2; i++) {
        pel_pose_key keys[2];
        pel_tool_def tool = straight(keys, 1);
        int count = (int)(0.5 / dt[i] + 0.5), loaded = 0;
        tool.sharpness = 0.3 * SHARPNESS;
        pel_vec3_set(tool.edge[0], 0, 0, -0.02);
        pel_vec3_set(tool.edge[1], -0.004, 0, 0.04);
        tool.keys = way;
        tool.key_count = 3;
        sheet s = make_sheet(PEL_METHOD_IMPLICIT, dt[i], &tool, 1);
        for (int k = 0; k < count; k++) {
            pel_tool_reading reading;
            step(s.sim, 1);
            pel_sim_get_tool(s.sim, 0, &reading);
            loaded += 2 * k >= count && pel_vec3_length(reading.force) > 0.8 * tool.sharpness * THICKNESS;
        }
        pel_sim_ledger ledger;
        pel_sim_get_ledger(s.sim, &ledger);
        assert_true(length_of(s.sim) > 0.04 && 2 * loaded > 0.95 * count);
        assert_true(ledger.work_tools > ledger.dissipated_fracture);
        end_sheet(&s);
    }
}

/* a blade that the sheet can follow presses, and cuts nothing */
static void presses(void **unused)
{
    (void)unused;
    pel_pose_key keys[2];
    pel_tool_def tool = straight(keys, 0.2);
    keys[1].position[0] = -0.5 * LENGTH + 0.001;
    tool.sharpness = 1e5;
    sheet s = make_sheet(PEL_METHOD_IMPLICIT, 1e-2, &tool, 1);
    step(s.sim, 20);
    pel_tool_reading reading;
    pel_sim_get_tool(s.sim, 0, &reading);
    assert_near(length_of(s.sim), 0, 0);
    assert_true(reading.force[0] < -0.01 && reading.held_count == 1);
    end_sheet(&s);
}

/* ---- snapshots and threads ---- */

static void returns(void **unused)
{
    (void)unused;
    const double sharpness[] = {0, SHARPNESS};
    for (int i = 0; i < 2; i++) {
        pel_pose_key keys[2];
        pel_tool_def tool = straight(keys, 0.1);
        tool.sharpness = sharpness[i];
        sheet s = make_sheet(PEL_METHOD_IMPLICIT, 1e-3, &tool, 1),
              other = make_sheet(PEL_METHOD_IMPLICIT, 1e-3, &tool, 4);
        pel_snapshot *snapshot;
        step(s.sim, 50);
        assert_int_equal(pel_snapshot_create(s.sim, &snapshot, NULL), PEL_OK);
        step(s.sim, 40);
        uint64_t hash = pel_sim_hash(s.sim);
        assert_true(length_of(s.sim) > 0.03);
        assert_int_equal(pel_snapshot_restore(s.sim, snapshot, NULL), PEL_OK);
        step(s.sim, 40);
        assert_true(pel_sim_hash(s.sim) == hash);
        step(other.sim, 90);
        assert_true(pel_sim_hash(other.sim) == hash);
        pel_snapshot_destroy(snapshot);
        end_sheet(&s);
        end_sheet(&other);
    }
}

/* what a damaged snapshot says of a blade is refused: number of places, their bodies and vertices */
static void ranges(void **unused)
{
    (void)unused;
    pel_pose_key keys[2];
    pel_tool_def tool = straight(keys, 0.1);
    sheet s = make_sheet(PEL_METHOD_IMPLICIT, 1e-3, &tool, 1);
    step(s.sim, 50);
    size_t size = pel_sim_save_size(s.sim);
    unsigned char *bytes = malloc(size);
    pel_blade *blade = s.sim->tools->items[0].blade, kept = *blade;
    assert_int_equal(kept.tip_count, 1);
    for (int i = 0; i < 7; i++) {
        pel_blade_tip *tip = &blade->tips[0];
        blade->tip_count = i == 0 ? PEL_BLADE_TIPS + 1 : i == 1 ? -1 : 1;
        tip->body = i == 2 ? 1 : i == 3 ? -1 : 0;
        tip->vertex = i == 4 ? s.sim->model->bodies[0].mesh->vertex_count : i == 5 ? -1 : kept.tips[0].vertex;
        pel_sim_save(s.sim, bytes);
        *blade = kept;
        assert_int_equal(pel_sim_load(s.sim, bytes, size, NULL), i < 6 ? PEL_BAD_FORMAT : PEL_OK);
        *blade = kept;
    }
    free(bytes);
    end_sheet(&s);
}

/* ---- hooks ---- */

static void hook(void **unused)
{
    (void)unused;
    pel_pose_key keys[2];
    pel_tool_def tool = straight(keys, 0.2);
    pel_tool_reading reading;
    tool.shape = PEL_TOOL_HOOK;
    tool.grasp_max_force = 0.2;
    sheet s = make_sheet(PEL_METHOD_IMPLICIT, 1e-3, &tool, 1);
    double most = 0;
    for (int i = 0; i < 150; i++) {
        step(s.sim, 1);
        pel_sim_get_tool(s.sim, 0, &reading);
        double force = pel_vec3_length(reading.force);
        most = force > most ? force : most;
    }
    assert_near(length_of(s.sim), 0, 0);
    assert_true(most > 0.15 && most < 0.25);
    assert_int_equal(reading.held_count, 0);
    assert_int_equal(reading.lost_count, 1);
    end_sheet(&s);
}

/* ---- refusals ---- */

static void refuse_under(pel_method method, const pel_model *model, const pel_tool_def *tool, const char *why)
{
    pel_error error;
    pel_sim *sim;
    pel_sim_def def = lone_sim(model, method, method == PEL_METHOD_EXPLICIT ? 2e-6 : 1e-3);
    def.tools = tool;
    def.tool_count = 1;
    assert_int_equal(pel_sim_create(&def, &sim, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, why));
    assert_true(error.remedy[0] != '\0');
}

static void refuse(const pel_model *model, const pel_tool_def *tool, const char *why)
{
    refuse_under(PEL_METHOD_XPBD, model, tool, why);
}

static pel_status create(const void *def, pel_error *error)
{
    pel_sim *sim = NULL;
    pel_status status = pel_sim_create(def, &sim, error);
    for (int i = 0; status == PEL_OK && i < 3; i++)
        status = pel_sim_step(sim, error);
    pel_sim_destroy(sim);
    return status;
}

static void refusals(void **unused)
{
    (void)unused;
    pel_pose_key keys[2];
    pel_mesh *mesh = make_grid(30, 18, LENGTH, WIDTH, PEL_GRID_ONE_DIAGONAL);
    pel_model *model = model_of(mesh);
    pel_tool_def good = straight(keys, 0.003), bad = good;
    memcpy(bad.edge[1], bad.edge[0], sizeof bad.edge[0]);
    refuse(model, &bad, "no length");
    bad = good;
    bad.sharpness = -1;
    refuse(model, &bad, "sharpness");
    bad = good;
    bad.grasp = true;
    bad.reach = 1;
    refuse(model, &bad, "an edge and a grasp");
    bad = good;
    bad.sharpness = SHARPNESS;
    const pel_method loose[] = {PEL_METHOD_PBD, PEL_METHOD_PBD_DISTANCE};
    for (size_t m = 0; m < sizeof loose / sizeof *loose; m++)
        refuse_under(loose[m], model, &bad, "a method that does not balance its force");
    pel_pose_key within = {.position = {0.0012, 0.0007, 0}, .rotation = {0, 0, 0, 1}};
    bad = good;
    bad.keys = &within;
    bad.key_count = 1;
    refuse(model, &bad, "starts in the surface");
    good.sharpness = SHARPNESS;
    pel_sim_def def = lone_sim(model, PEL_METHOD_IMPLICIT, 1e-3);
    def.tools = &good;
    def.tool_count = 1;
    assert_true(for_allocation_failures(create, &def, ROUNDS(17, 61)) > 10);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
    pel_mesh *ball = make_sphere(4);
    pel_body_def body = shell_body(ball, PEL_MEMBRANE_STVK);
    body.shell.pressure.kind = PEL_PRESSURE_GAS;
    body.shell.pressure.value = 100;
    model = make_model(&body);
    keys[0].position[0] = 5;
    refuse(model, &good, "encloses a gas");
    pel_model_destroy(model);
    pel_mesh_destroy(ball);
}

/* a blade goes into a pile of sheets, one above the other, at its border: as many as it can, and one more */
static void places(void **unused)
{
    (void)unused;
    for (int32_t count = PEL_BLADE_TIPS; count <= PEL_BLADE_TIPS + 1; count++) {
        pel_mesh *one = make_grid(7, 4, LENGTH, WIDTH, PEL_GRID_ONE_DIAGONAL), *pile;
        int32_t n = one->vertex_count, m = one->triangle_count;
        double(*x)[3] = calloc((size_t)(count * n), sizeof *x);
        int32_t(*triangles)[3] = calloc((size_t)(count * m), sizeof *triangles);
        for (int32_t k = 0; k < count; k++) {
            for (int32_t v = 0; v < n; v++) {
                pel_vec3_copy(one->positions[v], x[k * n + v]);
                x[k * n + v][2] = 0.03 * k;
            }
            for (int32_t t = 0; t < 3 * m; t++)
                triangles[k * m][t] = one->triangles[0][t] + k * n;
        }
        assert_int_equal(pel_mesh_create(x[0], count * n, triangles[0], count * m, &pile, NULL), PEL_OK);
        pel_model *model = model_of(pile);
        pel_pose_key keys[2];
        pel_tool_def tool = straight(keys, 0.1);
        tool.edge[1][2] = 0.03 * count;
        keys[0].position[0] = -0.505 * LENGTH;
        pel_sim_def def = lone_sim(model, PEL_METHOD_XPBD, 1e-3);
        def.tools = &tool;
        def.tool_count = 1;
        pel_sim *sim = make_sim(&def);
        pel_status status = PEL_OK;
        pel_error error;
        for (int i = 0; i < 15 && status == PEL_OK; i++)
            status = pel_sim_step(sim, &error);
        assert_int_equal(status, count > PEL_BLADE_TIPS ? PEL_BAD_ARGUMENT : PEL_OK);
        if (status != PEL_OK) {
            assert_non_null(strstr(error.what, "at more than 32 places"));
            assert_true(error.remedy[0] != '\0');
        }
        pel_sim_destroy(sim);
        pel_model_destroy(model);
        pel_mesh_destroy(pile);
        pel_mesh_destroy(one);
        free(x);
        free(triangles);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_speed),
        cmocka_unit_test(falls_apart),
        cmocka_unit_test(inside),
        cmocka_unit_test(guillotine),
        cmocka_unit_test(resistance),
        cmocka_unit_test(draws_out),
        cmocka_unit_test(pierces_and_goes_on),
        cmocka_unit_test(presses),
        cmocka_unit_test(returns),
        cmocka_unit_test(hook),
        cmocka_unit_test(refusals),
        cmocka_unit_test(ranges),
        cmocka_unit_test(places),
        cmocka_unit_test(beside_contact),
        cmocka_unit_test(swinging),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
