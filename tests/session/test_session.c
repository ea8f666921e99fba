/* Sessions: words that are refused, undo and reset to the bit, a record that a run repeats to the bit. */
#define _XOPEN_SOURCE 700
#include "session/play.h"

#include "math/vec3.h"
#include "pellicle/mesh_io.h"
#include "pellicle/shape.h"
#include "pellicle/sim_surface.h"
#include "pellicle/tear.h"
#include "session/command.h"

/* a sheet that hangs on two pins, and a ball of springs, with a tool of the scene */
static const char text[] =
    "version: 1\ntitle: play\nbodies:\n"
    "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 3 }, mass: { per_vertex: 0.1 },\n"
    "      springs: { stiffness: 3, damping: 0.1 }, volumetric: { stiffness: 1.5, damping: 0.1 } }\n"
    "  - { name: sheet, mesh: { shape: grid, nx: 8, ny: 8, translate: [3, 0, 0] }, mass: { density: 1000, thickness: "
    "0.01 },\n"
    "      membrane: { young: 1e4, thickness: 0.01 }, pinned: { nearest: [3, 0, 0] } }\n"
    "tools:\n"
    "  - { name: probe, shape: sphere, radius: 0.3, body: ball,\n"
    "      motion: [{ time: 0, position: [0, 0, 1.35] }, { time: 0.3, position: [0, 0, 1.2] }] }\n"
    "solver: { method: xpbd, dt: 0.01, substeps: 4 }\nduration: 0.5\nstop: { time: 0.4 }\n"
    "output: { every: 0.1 }\ncontact: none\n";

/* every word once and more */
static void act(play *made)
{
    pel_hand_reading hand;
    steps(made, 3);
    apply(made, "mark");
    apply(made, "grab 0 -5 0.1  0 1 0  20 0.3");
    pel_session_get_hand(made->session, &hand);
    assert_int_equal(hand.kind, PEL_HAND_GRAB);
    for (int i = 0; i < 6; i++) {
        char line[64];
        snprintf(line, sizeof line, "move 0 %g 0.1", -1 - 0.05 * i);
        apply(made, "move 0 -0.9 0.1");
        apply(made, line);
        steps(made, 1);
    }
    pel_session_get_hand(made->session, &hand);
    assert_true(hand.force[1] < 0);
    apply(made, "release");
    apply(made, "set bodies.ball.springs.stiffness 4.25");
    apply(made, "set gravity [0, 0, -1]");
    apply(made, "inflate sheet 3");
    apply(made, "pin 3.3 0.2 4  0 0 -1  0.2");
    steps(made, 4);
    apply(made, "mark");
    apply(made, "press box 0.2  -2 0 0  0 0.5 0 1");
    apply(made, "move -1 0 0");
    double most = 0;
    for (int i = 0; i < 30; i++) {
        steps(made, 1);
        pel_session_get_hand(made->session, &hand);
        assert_int_equal(hand.kind, PEL_HAND_PRESS);
        assert_int_equal(hand.shape, PEL_TOOL_BOX);
        most = fmax(most, hand.force[0]);
    }
    /* it knocks the ball away */
    assert_true(most > 0);
    apply(made, "unpin 3.3 0.2 4  0 0 -1  0.2");
    apply(made, "inflate sheet 0");
    steps(made, 5);
}

static void test_undo_and_reset(void **unused)
{
    (void)unused;
    play made = begin(text);
    char *record;
    bool done;
    int32_t pin_count;
    uint64_t start = pel_sim_hash(made.sim);
    act(&made);
    uint64_t last = pel_sim_hash(made.sim);
    assert_int_equal(pel_session_undo_count(made.session), 2);
    /* over the tool that presses: the pins and the pressure of then */
    assert_int_equal(pel_session_undo(made.session, &done, NULL), PEL_OK);
    assert_true(done && pel_session_pressure(made.session, 1) == 3);
    const unsigned char *pins = pel_session_pins(made.session, 1, &pin_count);
    int32_t pinned = 0;
    for (int32_t v = 0; v < pin_count; v++)
        pinned += pins[v];
    assert_true(pinned > 1);
    assert_int_equal(pel_sim_step_count(made.sim), 13);
    /* the same again from there gives the same */
    apply(&made, "press box 0.2  -2 0 0  0 0.5 0 1");
    apply(&made, "move -1 0 0");
    steps(&made, 30);
    apply(&made, "unpin 3.3 0.2 4  0 0 -1  0.2");
    apply(&made, "inflate sheet 0");
    steps(&made, 5);
    assert_true(pel_sim_hash(made.sim) == last);
    assert_int_equal(pel_session_reset(made.session, NULL), PEL_OK);
    assert_true(pel_sim_hash(made.sim) == start);
    assert_int_equal(pel_session_undo(made.session, &done, NULL), PEL_OK);
    assert_false(done);
    assert_int_equal(pel_session_record(made.session, &record, NULL), PEL_OK);
    assert_string_equal(record, "");
    pel_session_free_text(record);
    act(&made);
    assert_true(pel_sim_hash(made.sim) == last);
    end(&made);
}

/* the oldest marks go: undo leads to the last ones, each to the bit */
static void test_many_marks(void **unused)
{
    (void)unused;
    enum { MARKS = 20, KEPT = 16 };
    play made = begin(text);
    uint64_t hashes[MARKS];
    bool done;
    for (int i = 0; i < MARKS; i++) {
        hashes[i] = pel_sim_hash(made.sim);
        apply(&made, "mark");
        steps(&made, 1);
    }
    assert_int_equal(pel_session_undo_count(made.session), KEPT);
    for (int i = MARKS - 1; i >= MARKS - KEPT; i--) {
        assert_int_equal(pel_session_undo(made.session, &done, NULL), PEL_OK);
        assert_true(done && pel_sim_hash(made.sim) == hashes[i]);
    }
    assert_int_equal(pel_session_undo(made.session, &done, NULL), PEL_OK);
    assert_false(done);
    end(&made);
}

/* A full record is told, with a remedy that helps: the hand can still let go, undo makes room, and the scene of the
   session can be read. */
static void test_full_record(void **unused)
{
    (void)unused;
    play made = begin(text);
    char line[PEL_SESSION_LINE], *scene;
    int32_t count = 0;
    bool done;
    pel_error error;
    apply(&made, "grab 0 -5 0.1  0 1 0  20 0.3");
    snprintf(line, sizeof line, "inflate ball 0.5%0*d", 480, 0);
    const size_t first = strlen("  - \"0 grab 0 -5 0.1 0 1 0 20 0.3\"\n"), each = strlen("  - \"0 \"\n") + strlen(line);
    apply(&made, "mark");
    while (pel_session_apply(made.session, line, &error) == PEL_OK)
        count++;
    assert_true(first + (size_t)count * each <= PEL_SESSION_RECORD);
    assert_true(first + (size_t)(count + 1) * each + 24 > PEL_SESSION_RECORD);
    assert_string_equal(error.what, "the session has recorded 12 MiB of commands, as many as a scene may repeat");
    assert_string_equal(error.remedy, "save the session as a scene and reset, or undo");
    apply(&made, "mark");
    apply(&made, "release");
    assert_int_equal(pel_session_scene(made.session, &scene, NULL), PEL_OK);
    pel_scene *read = load_scene(scene, NULL, 0);
    assert_int_equal(read->session_count, count + 2);
    pel_scene_destroy(read);
    pel_session_free_text(scene);
    assert_int_equal(pel_session_undo(made.session, &done, NULL), PEL_OK);
    assert_int_equal(pel_session_apply(made.session, line, NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_session_undo(made.session, &done, NULL), PEL_OK);
    apply(&made, line);
    end(&made);
}

/* a hand that stays closed, and commands after an undo, are in the record too */
static void test_run_repeats(void **unused)
{
    (void)unused;
    play made = begin(text);
    bool done;
    char *repeated;
    act(&made);
    assert_int_equal(pel_session_undo(made.session, &done, NULL), PEL_OK);
    apply(&made, "grab 2.8 0.1 4  0 0 -1  2 0.1");
    apply(&made, "move 2.8 0.1 0.4");
    steps(&made, 12);
    uint64_t hash = pel_sim_hash(made.sim);
    int64_t count = pel_sim_step_count(made.sim);
    assert_int_equal(pel_session_scene(made.session, &repeated, NULL), PEL_OK);
    end(&made);
    for (int32_t threads = 1; threads <= 2; threads++) {
        pel_scene *scene = load_scene(repeated, NULL, 0);
        run_case test = {.run = "repeat", .threads = threads};
        check_run(scene, &test, PEL_OK);
        assert_int_equal(test.summary.steps, count);
        assert_true(test.summary.state_hash == hash);
        check_whole("repeat");
        /* the resolved scene says it all again */
        pel_scene *again = load_scene(pel_scene_text(scene), NULL, 0);
        assert_string_equal(pel_scene_text(again), pel_scene_text(scene));
        pel_scene_destroy(again);
        test = (run_case){.run = "repeat", .resume = "checkpoint"};
        assert_int_equal(do_run(scene, &test), PEL_BAD_SCENE);
        pel_scene_destroy(scene);
    }
    pel_session_free_text(repeated);
}

/* the hand holds the solid that was named, and presses with it: no mesh of the same name, which would need contact */
static void test_solid_tools(void **unused)
{
    (void)unused;
    static const struct {
        const char *name;
        pel_tool_shape shape;
    } solids[] = {{"sphere", PEL_TOOL_SPHERE}, {"capsule", PEL_TOOL_CAPSULE}, {"box", PEL_TOOL_BOX}};
    play made = begin(text);
    pel_hand_reading hand;
    for (size_t i = 0; i < sizeof solids / sizeof *solids; i++) {
        char line[64];
        snprintf(line, sizeof line, "press %s 0.2  -2 0 0  0 0 0 1", solids[i].name);
        apply(&made, line);
        pel_session_get_hand(made.session, &hand);
        assert_int_equal(hand.kind, PEL_HAND_PRESS);
        assert_int_equal(hand.shape, solids[i].shape);
        assert_null(pel_session_tool_mesh(made.session));
        apply(&made, "release");
    }
    end(&made);
}

/* a ball that meshes may touch */
static const char touched[] =
    "version: 1\nbodies:\n"
    "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 4 }, mass: { per_vertex: 0.1 },\n"
    "      springs: { stiffness: 3, damping: 0.1 }, volumetric: { stiffness: 1.5, damping: 0.1 } }\n"
    "solver: { method: quasi-static, dt: 0.02 }\ncontact: { self: false }\nduration: 1\n";

/* a mesh presses where there is contact, as large as asked for; commands with a file in the scene's folder are repeated
   from another folder */
static void test_mesh_tool(void **unused)
{
    (void)unused;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_TORUS);
    pel_mesh *ring = NULL;
    pel_hand_reading hand;
    char *repeated;
    assert_int_equal(pel_shape_create(&shape, &ring, NULL), PEL_OK);
    assert_int_equal(pel_mesh_write("a ring.ply", PEL_FORMAT_AUTO, ring, NULL, NULL), PEL_OK);
    pel_mesh_destroy(ring);
    play made = begin(touched);
    for (int turn = 0; turn < 2; turn++) {
        apply(&made, turn == 0 ? "press torus 0.5 0 0 1.6 0 0 0 1" : "press a%20ring.ply 0.5 0 0 1.6 0 0 0 1");
        const pel_mesh *mesh = pel_session_tool_mesh(made.session);
        assert_non_null(mesh);
        double most = 0;
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            most = fmax(most, pel_vec3_length(mesh->positions[v]));
        assert_float_equal(most, 0.5, 1e-12);
        apply(&made, "move 0 0 0.95");
        steps(&made, 40);
        pel_session_get_hand(made.session, &hand);
        assert_true(hand.kind == PEL_HAND_PRESS && hand.shape == PEL_TOOL_MESH && hand.force[2] < -0.01);
        apply(&made, "release");
        assert_null(pel_session_tool_mesh(made.session));
        steps(&made, 20);
    }
    uint64_t hash = pel_sim_hash(made.sim);
    assert_int_equal(pel_session_scene(made.session, &repeated, NULL), PEL_OK);
    assert_non_null(strstr(repeated, "/a%20ring.ply 0.5"));
    end(&made);
    pel_scene *scene = NULL;
    assert_int_equal(pel_scene_parse("elsewhere/scene.yaml", repeated, strlen(repeated), NULL, 0, NULL, &scene, NULL),
                     PEL_OK);
    run_case test = {.run = "pressed"};
    check_run(scene, &test, PEL_OK);
    assert_true(test.summary.state_hash == hash);
    pel_scene_destroy(scene);
    pel_session_free_text(repeated);
    remove("a ring.ply");
}

/* a sheet that hangs in contact with itself, and is cut by a scripted cut as well */
static const char sliced[] =
    "version: 1\nbodies:\n"
    "  - { name: sheet, mesh: { shape: grid, nx: 12, ny: 12, size_x: 1, size_y: 1 },\n"
    "      membrane: { young: 1e4, thickness: 0.01 }, mass: { density: 1000 }, pinned: { box: { min: "
    "[-1, 0.499, -1], max: [1, 1, "
    "1] } } }\n"
    "gravity: [0, -1, 0.2]\ncontact: {}\nsolver: { method: xpbd, dt: 0.01 }\nduration: 1\n"
    "cuts: [{ at: 0.1, path: [[0.2, -0.5, 0], [0.2, 0.1, 0]] }]\n";

/* x, y of the surface, seen from above */
static void slice(play *made, double x, double y)
{
    char line[80];
    snprintf(line, sizeof line, "cut %g %g 5  0 0 -1", x, y);
    apply(made, line);
}

/* a blade opens the surface where it is led; undo shuts it, pins follow, and a run repeats it to the bit */
static void test_cut(void **unused)
{
    (void)unused;
    play made = begin(sliced);
    pel_hand_reading hand;
    pel_cut_reading reading;
    int32_t count = pel_sim_vertex_count(made.sim, 0), pin_count;
    bool done;
    char *repeated;
    steps(&made, 2);
    uint64_t hash = pel_sim_hash(made.sim);
    for (int round = 0; round < 2; round++) {
        apply(&made, "mark");
        slice(&made, -0.35, 0.5);
        pel_session_get_hand(made.session, &hand);
        assert_int_equal(hand.kind, PEL_HAND_CUT);
        slice(&made, -0.3, 0.25);
        assert_true(pel_sim_vertex_count(made.sim, 0) > count);
        steps(&made, 1);
        slice(&made, -0.25, -0.1);
        /* beside the sheet */
        slice(&made, -3, 0);
        apply(&made, "release");
        assert_int_equal(pel_sim_get_cuts(made.sim, 0, &reading, NULL), PEL_OK);
        assert_true(reading.length > 0.5 && reading.length < 0.9 && reading.island_count == 0);
        /* the copy of the pinned vertex where the cut begins is pinned too */
        const unsigned char *pins = pel_session_pins(made.session, 0, &pin_count);
        assert_int_equal(pin_count, pel_sim_vertex_count(made.sim, 0));
        int pinned = 0;
        for (int32_t v = 0; v < pin_count; v++)
            pinned += pins[v];
        assert_int_equal(pinned, 14);
        apply(&made, "inflate sheet 0.1");
        steps(&made, 3);
        if (round > 0)
            break;
        assert_int_equal(pel_session_undo(made.session, &done, NULL), PEL_OK);
        assert_true(pel_sim_hash(made.sim) == hash && pel_sim_vertex_count(made.sim, 0) == count);
        pel_session_pins(made.session, 0, &pin_count);
        assert_int_equal(pin_count, count);
    }
    /* a single edge inside waits, and the blade leaves the border to the border */
    int32_t now = pel_sim_vertex_count(made.sim, 0);
    slice(&made, 0, 0.25);
    slice(&made, 1 / 12.0, 0.25);
    assert_int_equal(pel_sim_vertex_count(made.sim, 0), now);
    apply(&made, "release");
    slice(&made, -0.48, -0.48);
    slice(&made, 0, -0.48);
    apply(&made, "release");
    apply(&made, "grab -0.1 -0.3 5  0 0 -1  50 0.1");
    apply(&made, "move -0.1 -0.3 0.3");
    int32_t before = pel_sim_vertex_count(made.sim, 0);
    steps(&made, 20);
    /* by the scene, while the hand holds the sheet */
    assert_true(pel_sim_vertex_count(made.sim, 0) > before);
    apply(&made, "release");
    steps(&made, 3);
    hash = pel_sim_hash(made.sim);
    int64_t step_count = pel_sim_step_count(made.sim);
    assert_int_equal(pel_session_scene(made.session, &repeated, NULL), PEL_OK);
    end(&made);
    pel_scene *scene = load_scene(repeated, NULL, 0);
    run_case test = {.run = "sliced"};
    check_run(scene, &test, PEL_OK);
    assert_int_equal(test.summary.steps, step_count);
    assert_true(test.summary.state_hash == hash && test.summary.self_intersections_final == 0);
    check_whole("sliced");
    pel_scene_destroy(scene);
    pel_session_free_text(repeated);
}

static const char snipped[] =
    "version: 1\nbodies:\n"
    "  - { name: sheet, mesh: { shape: grid, nx: 12, ny: 12, size_x: 1, size_y: 1 },\n"
    "      membrane: { young: 1e4, thickness: 0.01 }, mass: { density: 1000 }, pinned: boundary }\n"
    "gravity: [0, 0, 0]\nsolver: { method: implicit, dt: 0.01 }\nduration: 1\n";

/* scissors of the hand close within 0.25 s, cut what lies between them and leave; undo shuts it, and a run repeats it
 */
static void test_snip(void **unused)
{
    (void)unused;
    play made = begin(snipped);
    pel_cut_reading reading;
    bool done;
    char *repeated;
    steps(&made, 12);
    apply(&made, "mark");
    assert_int_equal(pel_sim_get_cuts(made.sim, 0, &reading, NULL), PEL_OK);
    double before = reading.length;
    uint64_t hash = pel_sim_hash(made.sim);
    for (int round = 0; round < 2; round++) {
        apply(&made, "press scissors 0.2 -0.52 0.2 0  0 0 0 1");
        steps(&made, 10);
        assert_int_equal(pel_sim_get_cuts(made.sim, 0, &reading, NULL), PEL_OK);
        assert_in_range((int)(1000 * (reading.length - before)), 50, 200);
        steps(&made, 20);
        assert_int_equal(pel_sim_get_cuts(made.sim, 0, &reading, NULL), PEL_OK);
        assert_in_range((int)(1000 * (reading.length - before)), 300, 460);
        pel_hand_reading hand;
        pel_session_get_hand(made.session, &hand);
        assert_int_equal(hand.kind, PEL_HAND_FREE);
        assert_int_equal(pel_sim_tool_count(made.sim), 0);
        if (round > 0)
            break;
        assert_int_equal(pel_session_undo(made.session, &done, NULL), PEL_OK);
        assert_true(done && pel_sim_hash(made.sim) == hash);
    }
    hash = pel_sim_hash(made.sim);
    assert_int_equal(pel_session_scene(made.session, &repeated, NULL), PEL_OK);
    end(&made);
    pel_scene *scene = load_scene(repeated, NULL, 0);
    run_case test = {.run = "snipped"};
    check_run(scene, &test, PEL_OK);
    assert_true(test.summary.state_hash == hash);
    pel_scene_destroy(scene);
    pel_session_free_text(repeated);
}

/* mean distance of the vertices from their mean, after some steps of pressure */
static double inflated_radius(const pel_mesh *mesh)
{
    static const char ball[] = "version: 1\nbodies:\n"
                               "  - { name: ball, mesh: { file: a ball.ply }, mass: { per_vertex: 0.1 },\n"
                               "      springs: { stiffness: 3, damping: 0.1 } }\n"
                               "solver: { method: explicit, dt: 0.01 }\nduration: 1\n";
    double x[3 * 100], middle[3] = {0, 0, 0}, radius = 0;
    assert_int_equal(pel_mesh_write("a ball.ply", PEL_FORMAT_AUTO, mesh, NULL, NULL), PEL_OK);
    play made = begin(ball);
    int32_t count = mesh->vertex_count;
    assert_true(count <= 100);
    apply(&made, "inflate ball 5");
    steps(&made, 10);
    pel_sim_get_positions(made.sim, 0, x);
    for (int32_t i = 0; i < 3 * count; i++)
        middle[i % 3] += x[i] / count;
    for (int32_t v = 0; v < count; v++)
        radius += pel_vec3_distance(&x[3 * v], middle) / count;
    end(&made);
    remove("a ball.ply");
    return radius;
}

/* pressure acts outward on a closed surface however its triangles are turned, wherever it is */
static void test_inside_out(void **unused)
{
    (void)unused;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    pel_mesh *mesh = NULL;
    shape.frequency = 3;
    assert_int_equal(pel_shape_create(&shape, &mesh, NULL), PEL_OK);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        mesh->positions[v][1] -= 20;
    double radius = inflated_radius(mesh);
    assert_true(radius > 1.02);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        int32_t first = mesh->triangles[t][0];
        mesh->triangles[t][0] = mesh->triangles[t][1];
        mesh->triangles[t][1] = first;
    }
    const double rounding = 1e-12;
    assert_near(inflated_radius(mesh), radius, rounding);
    pel_mesh_destroy(mesh);
}

static void test_bad_lines(void **unused)
{
    (void)unused;
    static const char *const lines[] = {"",
                                        " ",
                                        "fly",
                                        "Set a 1",
                                        "set",
                                        "set gravity",
                                        "set bodies.ball.springs.stiffness -1",
                                        "set nothing 1",
                                        "set solver.dt 0.02",
                                        "move 1 2",
                                        "move 1 2 3 4",
                                        "move 1 2 x",
                                        "move nan 0 0",
                                        "move inf 0 0",
                                        "move 1e999 0 0",
                                        "release now",
                                        "grab 0 -5 0 0 0 0 20 0.3",
                                        "grab 0 -5 0 0 1 0 -20 0.3",
                                        "grab 0 -5 0 0 1 0 20 -1",
                                        "press cone 0.2 -2 0 0 0 0 0 1",
                                        "press torus 0.2 -2 0 0 0 0 0 1",
                                        "press nothing.ply 0.2 -2 0 0 0 0 0 1",
                                        "press sphere 0 -2 0 0 0 0 0 1",
                                        "press sphere 0.2 -2 0 0 0 0 0 0",
                                        "press sphere 0.2 0 0 0 0 0 0 1",
                                        "pin 3 0 4 0 0 -1 -1",
                                        "pin 3 0 4 0 0 0 1",
                                        "inflate nobody 1",
                                        "inflate sheet",
                                        "mark 1",
                                        "set gravity \"[0, 0, 1]\"",
                                        "set a\\b 1",
                                        "move 0 0 0\n",
                                        "move\t0 0 0"};
    play made = begin(text);
    char long_line[PEL_SESSION_LINE + 8], *record;
    pel_error error;
    steps(&made, 2);
    uint64_t hash = pel_sim_hash(made.sim);
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        pel_status status = pel_session_apply(made.session, lines[i], &error);
        if (status == PEL_OK)
            print_error("taken: '%s'\n", lines[i]);
        assert_int_not_equal(status, PEL_OK);
        assert_true(error.what[0] != '\0');
    }
    memset(long_line, 'a', sizeof long_line - 1);
    long_line[sizeof long_line - 1] = '\0';
    assert_int_equal(pel_session_apply(made.session, long_line, &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.what, "a command is longer than 511 bytes");
    /* one that just fits, and a byte that is no printable ASCII, at its place */
    long_line[PEL_SESSION_LINE - 1] = '\0';
    assert_int_equal(pel_session_apply(made.session, long_line, &error), PEL_BAD_ARGUMENT);
    assert_null(strstr(error.what, "longer than"));
    assert_int_equal(pel_session_apply(made.session, "set a \x1b[0m", &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.what, "a command holds the byte 0x1b at place 6");
    assert_int_equal(pel_session_apply(made.session, "set a \xc3\xa4", &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.what, "a command holds the byte 0xc3 at place 6");
    /* of a tool that is far larger than all bodies nothing can be computed */
    static const char *const large[] = {"press torus 1e300 -2 0 0 0 0 0 1", "press box 1e300 -2 0 0 0 0 0 1"};
    for (size_t i = 0; i < sizeof large / sizeof *large; i++) {
        assert_int_equal(pel_session_apply(made.session, large[i], &error), PEL_BAD_ARGUMENT);
        assert_non_null(strstr(error.what, "more than 1000 times the size of all bodies"));
    }
    /* no hit, or the hand is free: no error, and nothing to repeat */
    apply(&made, "grab 0 -5 9 0 1 0 20 0.3");
    apply(&made, "pin 0 -5 9 0 1 0 0.3");
    apply(&made, "release");
    apply(&made, "move 0 0 0");
    assert_true(pel_sim_hash(made.sim) == hash);
    assert_int_equal(pel_session_record(made.session, &record, NULL), PEL_OK);
    assert_string_equal(record, "");
    pel_session_free_text(record);
    end(&made);
}

/* as the hand, so the record: a line of a scene that cannot be done names its place before anything is written */
static void test_bad_scenes(void **unused)
{
    (void)unused;
    char scene_text[2000];
    static const char *const bad[][2] = {
        {"session: [\"now release\"]\n", "no step from 0 on"},
        {"session: [\"5 release\", \"4 release\"]\n", "no step from 5 on"},
        {"session:\n  - \"0 release\"\n  - \"3 fly\"\n", "'fly' is not a command"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        pel_scene *scene = NULL;
        pel_error error;
        char message[900];
        run_case test = {.run = "bad"};
        snprintf(scene_text, sizeof scene_text, "%s%s", text, bad[i][0]);
        pel_status status = pel_scene_parse("bad.yaml", scene_text, strlen(scene_text), NULL, 0, NULL, &scene, &error);
        if (status == PEL_OK) {
            status = do_run(scene, &test);
            error = test.error;
        }
        assert_int_equal(status, PEL_BAD_SCENE);
        pel_error_text(&error, message, sizeof message);
        if (strstr(message, bad[i][1]) == NULL)
            print_error("%s\n", message);
        assert_non_null(strstr(message, bad[i][1]));
        assert_true(error.line > 10 && error.column > 1);
        assert_false(exists("bad", ""));
        pel_scene_destroy(scene);
    }
}

/* a step that diverges takes the session back to the last mark */
static void test_divergence(void **unused)
{
    (void)unused;
    static const char stiff[] = "version: 1\nbodies:\n"
                                "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 2 },\n"
                                "      mass: { per_vertex: 1 }, springs: { stiffness: 3, damping: 0 } }\n"
                                "solver: { method: explicit, dt: 0.05 }\nduration: 1\n";
    play made = begin(stiff);
    pel_error error;
    pel_status status = PEL_OK;
    steps(&made, 5);
    apply(&made, "mark");
    uint64_t hash = pel_sim_hash(made.sim);
    apply(&made, "inflate ball 1e300");
    for (int i = 0; i < 50 && status == PEL_OK; i++)
        status = pel_session_step(made.session, &error);
    assert_int_equal(status, PEL_DIVERGED);
    assert_true(pel_sim_hash(made.sim) == hash);
    assert_true(pel_session_pressure(made.session, 0) == 0);
    steps(&made, 5);
    end(&made);
}

typedef struct allocation_data {
    const pel_scene *scene;
    pel_sim *sim;
    pel_session *session;
} allocation_data;

static pel_status create_one(const void *context, pel_error *error)
{
    const allocation_data *data = context;
    pel_session *session = (pel_session *)1;
    pel_status status = pel_session_create(data->scene, data->sim, &session, error);
    if (status != PEL_OK)
        assert_null(session);
    pel_session_destroy(session);
    return status;
}

static pel_status record_one(const void *context, pel_error *error)
{
    const allocation_data *data = context;
    char *record = NULL;
    pel_status status = pel_session_record(data->session, &record, error);
    assert_true((record != NULL) == (status == PEL_OK));
    pel_session_free_text(record);
    return status;
}

static pel_status print_one(const void *context, pel_error *error)
{
    const allocation_data *data = context;
    char *record = NULL;
    pel_status status = pel_session_scene(data->session, &record, error);
    assert_true((record != NULL) == (status == PEL_OK));
    pel_session_free_text(record);
    return status;
}

static void test_allocations(void **unused)
{
    (void)unused;
    play made = begin(text);
    const allocation_data data = {made.scene, made.sim, made.session};
    assert_true(for_every_allocation_failure(create_one, &data) > 3);
    act(&made);
    assert_true(for_every_allocation_failure(record_one, &data) > 1);
    assert_true(for_every_allocation_failure(print_one, &data) > 1);
    end(&made);
}

/* a session in which tools come and go gives all of its memory back */
static void test_memory_of_tools(void **unused)
{
    (void)unused;
    failing_malloc_begin(0);
    play made = begin(touched);
    for (int turn = 0; turn < 3; turn++) {
        apply(&made, "press torus 0.2 0 0 3 0 0 0 1");
        apply(&made, "move 0 0 2.9");
        steps(&made, 1);
        apply(&made, "mark");
        if (turn < 2)
            apply(&made, "release");
    }
    end(&made);
    assert_int_equal(failing_malloc_end().live, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_undo_and_reset),
        cmocka_unit_test(test_many_marks),
        cmocka_unit_test(test_full_record),
        cmocka_unit_test(test_run_repeats),
        cmocka_unit_test(test_mesh_tool),
        cmocka_unit_test(test_solid_tools),
        cmocka_unit_test(test_inside_out),
        cmocka_unit_test(test_bad_lines),
        cmocka_unit_test(test_bad_scenes),
        cmocka_unit_test(test_divergence),
        cmocka_unit_test(test_allocations),
        cmocka_unit_test(test_memory_of_tools),
        cmocka_unit_test(test_cut),
        cmocka_unit_test(test_snip),
    };
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
