/* The forceps of the hand: what they hold, what becomes of forceps of the scene, undo, a record that repeats to the
 * bit. */
#define _XOPEN_SOURCE 700
#include "session/play.h"

#include "failing_malloc.h"
#include "math/vec3.h"
#include "pellicle/sim_reading.h"
#include "pellicle/tear.h"

/* a disk with a slit from the middle and 60 degrees along a circle, whose flap a sphere leads on */
static const char disk[] =
    "version: 1\n"
    "bodies:\n"
    "  - mesh: {shape: disk, radius: 0.004, rings: 12}\n"
    "    mass: {per_vertex: 1.0e-6}\n"
    "    springs: {young: 1.5e6, thickness: 13e-6, toughness: 1300}\n"
    "    pinned: boundary\n"
    "cuts:\n"
    "  - path: [[0, 0, 0], [0.0025, 0, 0], [0.00235, 0.00086, 0], [0.00192, 0.0016, 0], [0.00125, 0.00217, 0]]\n"
    "tools:\n"
    "  - {name: forceps, shape: sphere, radius: 0.0003, press: false, grasp: {reach: 1e-5, lead: {radius: 0.0025, "
    "speed: 0.004, regrasp: 0.0022}}, motion: [{position: [0.0022, 0.001, 0.0004]}]}\n"
    "solver: {method: quasi-static, dt: 0.0005}\n"
    "duration: 100\n"
    "stop: {time: 50}\n";

static pel_tool_reading tool(const play *made, int32_t index)
{
    pel_tool_reading reading;
    pel_sim_get_tool(made->sim, index, &reading);
    return reading;
}

static double swept(const play *made)
{
    pel_hole_reading hole;
    assert_true(pel_sim_get_hole(made->sim, &hole));
    return hole.swept;
}

/* takes the forceps over and draws around the circle, a little outside of it */
static void draw_around(play *made, int moves)
{
    apply(made, "grasp 0.0018 0.0009 1  0 0 -1  0.0003 1");
    for (int i = 0; i < moves; i++) {
        char line[100];
        double angle = 0.46 + 0.01 * i;
        snprintf(line, sizeof line, "move %.9g %.9g 0.0003", 0.003 * cos(angle), 0.003 * sin(angle));
        apply(made, line);
        steps(made, 20);
    }
}

/* the hand holds one patch, and those of the scene let go and leave; the tear goes on, the hand grasps anew on its way
 */
static void test_take_over(void **unused)
{
    (void)unused;
    for (int from = 0; from < 2; from++) {
        play made = begin(disk);
        pel_hand_reading hand;
        steps(&made, 20 * from);
        assert_true(from == 0 || tool(&made, 0).held_count > 0);
        double before = swept(&made), height = tool(&made, 0).position[2];
        draw_around(&made, 400);
        assert_int_equal(tool(&made, 0).held_count, 0);
        assert_near(tool(&made, 0).position[2], height + 20 * 0.0025, 1e-9);
        assert_true(tool(&made, 1).held_count > 0 && tool(&made, 1).held_count < 30);
        pel_session_get_hand(made.session, &hand);
        assert_int_equal(hand.kind, PEL_HAND_GRASP);
        double force = pel_vec3_length(hand.force);
        assert_true(force > 0.001 && force < 0.06);
        assert_near(pel_vec3_distance(hand.point, tool(&made, 1).position), 0, 0);
        assert_true(swept(&made) > before + 0.5);
        apply(&made, "release");
        assert_int_equal(pel_sim_tool_count(made.sim), 1);
        end(&made);
    }
}

/* without grasping anew the hand holds what it has, as far as it pulls, and also outside of the tear */
static void test_hold(void **unused)
{
    (void)unused;
    play made = begin(disk);
    apply(&made, "grasp 0.0032 0.0009 1  0 0 -1  0.0003 0");
    steps(&made, 2);
    int32_t held = tool(&made, 1).held_count;
    assert_true(held > 0 && held < 10);
    /* 0.1 mm, nearer by a factor of e in 20 ms */
    apply(&made, "move 0.0033 0.0009 0");
    steps(&made, 40);
    assert_near(tool(&made, 1).position[0], 0.0033 - 1e-4 * pow(1 + 0.0005 / 0.02, -40), 3e-6);
    steps(&made, 360);
    assert_near(tool(&made, 1).position[0], 0.0033, 2e-6);
    assert_int_equal(tool(&made, 1).held_count, held);
    /* and no faster than 0.4 diagonals in a second */
    double from = tool(&made, 1).position[0], most = 0.4 * hypot(0.008, 0.008) * 0.0005;
    apply(&made, "move 0.0063 0.0009 0");
    steps(&made, 5);
    assert_near(tool(&made, 1).position[0], from + 5 * most, 0.5 * most);
    apply(&made, "release");
    /* at least the nearest vertex */
    apply(&made, "grasp 0.0011 -0.0015 1  0 0 -1  0 0");
    steps(&made, 2);
    assert_true(tool(&made, 1).held_count > 0 && tool(&made, 1).held_count < 3);
    apply(&made, "release");
    /* with it the hand takes the flap at once, also from a place beside the tip, which is outside */
    apply(&made, "grasp 0.0015 0.0026 1  0 0 -1  0.0003 1");
    steps(&made, 2);
    double place[3], target[3] = {0.0015, 0.0026, 0};
    pel_vec3_copy(tool(&made, 1).position, place);
    assert_true(hypot(place[0], place[1]) < 0.0027);
    /* and draws it from there, not from where the hand pressed */
    for (int i = 0; i < 20; i++) {
        pel_vec3_copy(tool(&made, 1).position, place);
        steps(&made, 1);
        assert_near(pel_vec3_distance(tool(&made, 1).position, place), most, 1e-3 * most);
        assert_near(pel_vec3_distance(place, target) - pel_vec3_distance(tool(&made, 1).position, target), most,
                    1e-3 * most);
    }
    end(&made);
}

static void test_undo_and_record(void **unused)
{
    (void)unused;
    play made = begin(disk);
    bool done;
    char *repeated;
    steps(&made, 30);
    uint64_t start = pel_sim_hash(made.sim);
    apply(&made, "mark");
    draw_around(&made, 100);
    assert_int_equal(pel_session_undo(made.session, &done, NULL), PEL_OK);
    assert_true(done && pel_sim_hash(made.sim) == start && pel_sim_tool_count(made.sim) == 1);
    /* those of the scene lead on */
    steps(&made, 30);
    assert_true(tool(&made, 0).held_count > 0);
    draw_around(&made, 100);
    apply(&made, "release");
    steps(&made, 3);
    uint64_t hash = pel_sim_hash(made.sim);
    assert_int_equal(pel_session_scene(made.session, &repeated, NULL), PEL_OK);
    end(&made);
    made = begin(repeated);
    int64_t count = 30 + 30 + 2000 + 3;
    for (int64_t i = 0; i < count; i++) {
        assert_int_equal(pel_session_repeat(made.session, NULL), PEL_OK);
        steps(&made, 1);
    }
    assert_true(pel_sim_hash(made.sim) == hash);
    end(&made);
    pel_session_free_text(repeated);
}

static void test_refusals(void **unused)
{
    (void)unused;
    static const char *const lines[] = {"grasp 0 0 1 0 0 -1 -1 0", "grasp 0 0 1 0 0 0 0.1 0", "grasp 0 0 1 0 0 -1 0.1",
                                        /* four times as large as the way to a new grasp */
                                        "grasp 0.0018 0.0009 1 0 0 -1 0.001 1"};
    play made = begin(disk);
    steps(&made, 2);
    uint64_t hash = pel_sim_hash(made.sim);
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        assert_int_equal(pel_session_apply(made.session, lines[i], NULL), PEL_BAD_ARGUMENT);
    /* beside the disk */
    apply(&made, "grasp 1 1 1 0 0 -1 0.1 0");
    assert_true(pel_sim_hash(made.sim) == hash && pel_sim_tool_count(made.sim) == 1);
    apply(&made, "grasp 0.0018 0.0009 1 0 0 -1 0.0003 1");
    assert_int_equal(pel_session_apply(made.session, "grasp 0 0.001 1 0 0 -1 0.0003 1", NULL), PEL_BAD_ARGUMENT);
    end(&made);
}

/* without memory nothing changes */
static void test_allocations(void **unused)
{
    (void)unused;
    play made = begin(disk);
    allocation_count count;
    long n = 0;
    steps(&made, 2);
    uint64_t hash = pel_sim_hash(made.sim);
    do {
        failing_malloc_begin(++n);
        pel_status status = pel_session_apply(made.session, "grasp 0.0018 0.0009 1 0 0 -1 0.0003 1", NULL);
        count = failing_malloc_end();
        if (status == PEL_OK)
            apply(&made, "release");
        else
            assert_int_equal(status, PEL_OUT_OF_MEMORY);
        assert_true(pel_sim_hash(made.sim) == hash && pel_sim_tool_count(made.sim) == 1);
    } while (count.failed > 0);
    assert_true(n > 3);
    end(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_take_over), cmocka_unit_test(test_hold),        cmocka_unit_test(test_undo_and_record),
        cmocka_unit_test(test_refusals),  cmocka_unit_test(test_allocations),
    };
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
