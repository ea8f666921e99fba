/* Scissors: what lies between their blades is cut while they close, in any number of steps, and nothing else; a second
   bite goes on with the cut of the first one; snapshots, threads, and what is refused. */
#include "shell_fixture.h"

#include "pellicle/live.h"
#include "pellicle/sim.h"
#include "pellicle/tear.h"
#include "stage/stage.h"
#include "tool/tool.h"

#define LENGTH 0.1
#define WIDTH 0.06
#define EDGE (LENGTH / 30)
#define REACH 0.06
#define Y 0.0013

typedef struct sheet {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
} sheet;

static sheet make_sheet(const pel_tool_def *tool, int threads)
{
    sheet s = {.mesh = make_grid(30, 18, LENGTH, WIDTH, PEL_GRID_ONE_DIAGONAL)};
    pel_body_def body = pel_body_def_sheet("shell", s.mesh, 1e6, 1e-3, 1000);
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    s.model = make_model(&body);
    pel_sim_def def = lone_sim(s.model, PEL_METHOD_IMPLICIT, 1e-3);
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

/* beside the left border, along x, one blade above the sheet and one below */
static pel_tool_def scissors(const pel_pose_key *keys, int key_count, const pel_key *closing, int closing_count)
{
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "scissors";
    tool.shape = PEL_TOOL_SCISSORS;
    tool.edge[0][0] = tool.edge[1][0] = REACH;
    tool.edge[0][2] = 0.02;
    tool.edge[1][2] = -0.015;
    tool.keys = keys;
    tool.key_count = key_count;
    tool.closing = closing;
    tool.closing_count = closing_count;
    return tool;
}

static const pel_pose_key beside = {.position = {-0.505 * LENGTH, Y, 0}, .rotation = {0, 0, 0, 1}};

static void step(pel_sim *sim, int count)
{
    pel_error error;
    for (int i = 0; i < count; i++)
        if (pel_sim_step(sim, &error) != PEL_OK)
            fail_msg("%s: %s", error.what, error.remedy);
}

static double length_of(const pel_sim *sim)
{
    pel_cut_reading reading;
    assert_int_equal(pel_sim_get_cuts(sim, 0, &reading, NULL), PEL_OK);
    return reading.length;
}

/* m, the farthest vertex of the cut from the line that the scissors close along */
static double farthest(const sheet *s)
{
    int32_t count = pel_sim_vertex_count(s->sim, 0);
    int32_t *origins = calloc((size_t)count, sizeof *origins);
    const pel_mesh *mesh = pel_model_mesh(pel_sim_model(s->sim), 0);
    double most = 0;
    pel_sim_get_origins(s->sim, 0, origins);
    for (int32_t v = 0; v < count; v++)
        if (origins[v] != v)
            most = fmax(most, fabs(mesh->positions[v][1] - Y));
    free(origins);
    return most;
}

static void any_speed(void **unused)
{
    (void)unused;
    for (int count = 1; count < 100; count *= 4) {
        const pel_key closing[] = {{0, 0}, {count * 1e-3, 1}};
        const pel_tool_def tool = scissors(&beside, 1, closing, 2);
        sheet s = make_sheet(&tool, 1);
        step(s.sim, count + 1);
        assert_near(length_of(s.sim), REACH - 0.005 * LENGTH, 0.6 * EDGE);
        assert_true(farthest(&s) < 0.1 * EDGE);
        pel_tool_reading reading;
        pel_sim_get_tool(s.sim, 0, &reading);
        assert_near(pel_vec3_length(reading.force), 0, 0);
        /* it opens again, and cuts no more */
        step(s.sim, 5);
        assert_near(length_of(s.sim), REACH - 0.005 * LENGTH, 0.6 * EDGE);
        end_sheet(&s);
    }
}

/* half closed scissors that move through the sheet, that open in it, and a sheet that is not between the blades */
static void cuts_nothing_else(void **unused)
{
    (void)unused;
    const pel_pose_key across[] = {{.position = {-2 * LENGTH, Y, 0}, .rotation = {0, 0, 0, 1}},
                                   {.time = 0.02, .position = {0, Y, 0}, .rotation = {0, 0, 0, 1}}};
    const pel_key stays[] = {{0, 0.5}}, opens[] = {{0, 1}, {0.02, 0}}, closes[] = {{0, 0}, {0.01, 1}};
    pel_tool_def tools[] = {scissors(across, 2, stays, 1), scissors(across, 2, opens, 2),
                            scissors(&beside, 1, closes, 2)};
    tools[2].edge[1][2] = 0.002;
    for (int i = 0; i < 3; i++) {
        sheet s = make_sheet(&tools[i], 1);
        step(s.sim, 22);
        assert_near(length_of(s.sim), 0, 0);
        end_sheet(&s);
    }
}

/* three bites, each from behind the end of the cut before, are one cut with one end; in one step or ten each */
static void bites(void **unused)
{
    (void)unused;
    for (int count = 1; count <= 10; count += 9) {
        pel_pose_key keys[6];
        pel_key closing[6];
        for (int i = 0; i < 6; i++) {
            keys[i] = beside;
            keys[i].time = 1e-3 * count * i;
            keys[i].position[0] += 0.02 * (i / 2);
            closing[i] = (pel_key){1e-3 * count * i, i % 2 * 0.5};
        }
        const pel_tool_def tool = scissors(keys, 6, closing, 6);
        sheet s = make_sheet(&tool, 1);
        int32_t tips;
        step(s.sim, 5 * count + 2);
        assert_near(length_of(s.sim), 0.04 + 0.5 * REACH - 0.005 * LENGTH, 0.8 * EDGE);
        assert_true(farthest(&s) < 0.1 * EDGE);
        assert_int_equal(pel_sim_tips(s.sim, 0, NULL, 0, &tips, NULL), PEL_OK);
        assert_int_equal(tips, 1);
        end_sheet(&s);
    }
}

static void returns(void **unused)
{
    (void)unused;
    const pel_key closing[] = {{0, 0}, {0.02, 1}};
    const pel_tool_def tool = scissors(&beside, 1, closing, 2);
    sheet s = make_sheet(&tool, 1), other = make_sheet(&tool, 4);
    pel_snapshot *snapshot;
    step(s.sim, 11);
    assert_int_equal(pel_snapshot_create(s.sim, &snapshot, NULL), PEL_OK);
    step(s.sim, 11);
    uint64_t hash = pel_sim_hash(s.sim);
    assert_true(length_of(s.sim) > 0.05);
    assert_int_equal(pel_snapshot_restore(s.sim, snapshot, NULL), PEL_OK);
    assert_true(length_of(s.sim) < 0.04);
    step(s.sim, 11);
    assert_true(pel_sim_hash(s.sim) == hash);
    step(other.sim, 22);
    assert_true(pel_sim_hash(other.sim) == hash);
    pel_snapshot_destroy(snapshot);
    /* shares out of range in a damaged snapshot */
    size_t size = pel_sim_save_size(s.sim);
    unsigned char *bytes = malloc(size);
    double *closed = &s.sim->tools->items[0].blade->closed;
    for (int i = 0; i < 3; i++) {
        *closed = i == 0 ? 1.5 : i == 1 ? -0.5 : 0.5;
        pel_sim_save(s.sim, bytes);
        *closed = 1;
        assert_int_equal(pel_sim_load(s.sim, bytes, size, NULL), i < 2 ? PEL_BAD_FORMAT : PEL_OK);
    }
    free(bytes);
    end_sheet(&s);
    end_sheet(&other);
}

static void refuse(const pel_model *model, const pel_tool_def *tool, const char *why)
{
    pel_sim *sim;
    pel_error error;
    pel_sim_def def = lone_sim(model, PEL_METHOD_IMPLICIT, 1e-3);
    def.tools = tool;
    def.tool_count = 1;
    assert_int_equal(pel_sim_create(&def, &sim, &error), PEL_BAD_ARGUMENT);
    if (strstr(error.what, why) == NULL)
        fail_msg("%s", error.what);
    assert_true(error.remedy[0] != '\0');
}

static void refusals(void **unused)
{
    (void)unused;
    const pel_key closing[] = {{0, 0}, {0.02, 1}}, beyond[] = {{0, 0}, {0.02, 1.1}}, late[] = {{0.1, 0}, {0.02, 1}},
                  half[] = {{0, 0.5}};
    const pel_tool_def good = scissors(&beside, 1, closing, 2);
    sheet s = make_sheet(&good, 1);
    pel_tool_def bad = good;
    bad.closing_count = 0;
    refuse(s.model, &bad, "closes by no keys");
    bad = good;
    bad.closing = beyond;
    refuse(s.model, &bad, "out of range");
    bad.closing = late;
    refuse(s.model, &bad, "or order");
    bad = good;
    pel_vec3_scale(bad.edge[0], 0.5, bad.edge[1]);
    refuse(s.model, &bad, "do not open");
    bad = good;
    bad.sharpness = 100;
    refuse(s.model, &bad, "have a sharpness");
    bad = good;
    bad.grasp = true;
    bad.reach = 1;
    refuse(s.model, &bad, "an edge and a grasp");
    /* half closed around the sheet; open scissors may start on it */
    pel_pose_key within = beside;
    within.position[0] = 0;
    bad = good;
    bad.keys = &within;
    bad.closing = half;
    bad.closing_count = 1;
    refuse(s.model, &bad, "starts in the surface");
    end_sheet(&s);
    bad.closing = closing;
    bad.closing_count = 2;
    s = make_sheet(&bad, 1);
    end_sheet(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_speed), cmocka_unit_test(cuts_nothing_else), cmocka_unit_test(bites),
        cmocka_unit_test(returns),   cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
