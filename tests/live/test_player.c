/* When the player steps and posts: a command is answered immediately, by at most one step ahead of the clock. */
#include "check.h"

#include "live/player.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* steps that are far longer than the test */
static const char text[] =
    "version: 1\nbodies:\n"
    "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 2 }, mass: { density: 1000 },\n"
    "      membrane: { preset: rubber, thickness: 0.001 } }\n"
    "solver: { method: pbd, dt: 60, substeps: 2 }\nduration: 600\n";

typedef struct fixture {
    pel_mailbox box;
    pel_scene *scene;
    pel_server_def def;
    pel_player *player;
    pel_mail_reader reader;
} fixture;

static void start_scene(fixture *f, const char *scene)
{
    *f = (fixture){.def = pel_server_def_default()};
    pel_mailbox_create(&f->box);
    assert_int_equal(pel_scene_parse("ball.yaml", scene, strlen(scene), NULL, 0, NULL, &f->scene, NULL), PEL_OK);
    f->def.scene = f->scene;
    assert_int_equal(pel_player_create(&f->def, &f->box, &f->player, NULL), PEL_OK);
    pel_mailbox_welcome(&f->box, &f->reader);
}

static void start(fixture *f)
{
    start_scene(f, text);
}

static void stop(fixture *f)
{
    pel_player_destroy(f->player);
    pel_mailbox_destroy(&f->box);
    pel_scene_destroy(f->scene);
}

static void say(fixture *f, const char *line)
{
    char *copy = pel_allocate(strlen(line) + 1, 1);
    assert_non_null(copy);
    memcpy(copy, line, strlen(line) + 1);
    pel_mailbox_line(&f->box, copy, pel_player_interrupts(copy));
    assert_true(pel_player_turn(f->player, 0));
}

/* the step of the newest frame, once one is posted after `revision` */
static int next_step(fixture *f, uint32_t revision)
{
    const pel_post *post = &f->box.posts[PEL_POST_FRAME];
    for (int turn = 0; turn < 2000 && post->revision == revision; turn++) {
        const struct timespec pause = {.tv_nsec = 1000000};
        pel_mailbox_want(&f->box);
        nanosleep(&pause, NULL);
        assert_true(pel_player_turn(f->player, 0));
    }
    assert_int_not_equal(post->revision, revision);
    char head[400] = {0};
    memcpy(head, post->bytes + 4, sizeof head - 1);
    const char *found = strstr(head, "\"step\":");
    assert_non_null(found);
    return atoi(found + 7);
}

static int say_and_see(fixture *f, const char *line)
{
    uint32_t revision = f->box.posts[PEL_POST_FRAME].revision;
    say(f, line);
    return next_step(f, revision);
}

static void test_answer(void **unused)
{
    (void)unused;
    fixture f;
    start(&f);
    assert_int_equal(say_and_see(&f, "play"), 1);
    double rest = pel_player_rest(f.player);
    assert_true(rest > 0 && rest <= 0.1);
    /* the next step is due in a minute; a command has it now, but the one after that waits */
    assert_int_equal(say_and_see(&f, "grab 0 0 5 0 0 -1 1 0.3"), 2);
    assert_int_equal(say_and_see(&f, "move 0 0 2"), 2);
    assert_int_equal(say_and_see(&f, "pause"), 2);
    assert_int_equal(say_and_see(&f, "step"), 3);
    stop(&f);
}

static const char *posted(const fixture *f, int kind)
{
    const pel_post *post = &f->box.posts[kind];
    return post->bytes != NULL ? (const char *)post->bytes : "";
}

static bool holds(const fixture *f, int kind, const char *words)
{
    const pel_post *post = &f->box.posts[kind];
    const size_t size = strlen(words);
    for (size_t i = 0; post->bytes != NULL && i + size <= post->size; i++)
        if (memcmp(post->bytes + i, words, size) == 0)
            return true;
    print_error("%.*s\nholds no %s\n", (int)post->size, posted(f, kind), words);
    return false;
}

/* a load that ends, with a factor over time that is 1 */
static const char pushed[] =
    "version: 1\nbodies:\n"
    "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 2 }, mass: { density: 1000 },\n"
    "      membrane: { preset: rubber, thickness: 0.001 } }\n"
    "loads: [{ name: finger, body: ball, at: { nearest: [0, 0, 1] }, force: [0, 0, -1], until: 5 }]\n"
    "solver: { method: pbd, dt: 60, substeps: 2 }\nduration: 600\n";

/* a field is shown or none is; others are told */
static void test_fields(void **unused)
{
    (void)unused;
    fixture f;
    start(&f);
    uint32_t told = f.box.posts[PEL_POST_NOTICE].revision;
    say(&f, "field displacement");
    say(&f, "field none");
    assert_int_equal(f.box.posts[PEL_POST_NOTICE].revision, told);
    say(&f, "field displacemend");
    assert_true(holds(&f, PEL_POST_NOTICE, "there is no field 'displacemend'"));
    stop(&f);
}

/* what is refused is told by the names of the scene and without its file; curves are not offered for change */
static void test_refusals(void **unused)
{
    (void)unused;
    fixture f;
    start_scene(&f, pushed);
    say(&f, "set loads.finger.from 9");
    assert_true(holds(&f, PEL_POST_NOTICE, "\"kind\":\"refused\",\"text\":\"load 'finger': load ends"));
    assert_true(holds(&f, PEL_POST_PARAMETERS, "\"path\":\"loads.finger.keys\""));
    assert_true(holds(&f, PEL_POST_PARAMETERS, "\"live\":false,\"refusal\":\"it is a factor over time\""));
    stop(&f);
}

/* pages hear of parameters that a command changed or was refused, not of each command */
static void test_parameters_told(void **unused)
{
    (void)unused;
    static const struct {
        const char *line;
        bool told;
    } cases[] = {{"grab 0 0 5 0 0 -1 1 0.3", false}, {"move 0 0 2", false},      {"release", false},
                 {"set gravity [0, 0, -1]", true},   {"inflate ball 2", true},   {"set gravity [0, 0, here]", true},
                 {"inflate nobody 2", true},         {"grab 0 0 5 0 0 0", true}, {"mark", false}};
    fixture f;
    start(&f);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        uint32_t before = f.box.posts[PEL_POST_PARAMETERS].revision;
        say(&f, cases[i].line);
        bool told = f.box.posts[PEL_POST_PARAMETERS].revision != before;
        if (told != cases[i].told)
            print_error("%s\n", cases[i].line);
        assert_int_equal(told, cases[i].told);
    }
    stop(&f);
}

/* the greeting names the tools of the scene with their sizes */
static void test_tools_told(void **unused)
{
    (void)unused;
    char scene[sizeof text + 200];
    snprintf(scene, sizeof scene,
             "%stools: [{ name: probe, shape: sphere, radius: 0.25, motion: [{ position: [0, 0, 2] }] }]\n", text);
    fixture f;
    start_scene(&f, scene);
    assert_true(holds(&f, PEL_POST_HELLO, "\"tools\":[{\"name\":\"probe\",\"shape\":\"sphere\",\"radius\":0.25,"));
    stop(&f);
}

/* of a vector a page gets the length: in free fall that of the velocity is the same everywhere, 9 m/s after 1 s */
static void test_length_of_vectors(void **unused)
{
    (void)unused;
    static const char falling[] =
        "version: 1\nbodies:\n"
        "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 2 }, mass: { density: 1000 },\n"
        "      membrane: { preset: rubber, thickness: 0.001 } }\n"
        "gravity: [1, 4, 8]\nsolver: { method: implicit, dt: 1 }\nduration: 10\n";
    enum { VERTICES = 42 };
    fixture f;
    start_scene(&f, falling);
    say(&f, "field velocity");
    assert_int_equal(say_and_see(&f, "step"), 1);
    const pel_post *post = &f.box.posts[PEL_POST_FRAME];
    const unsigned char *head = (const unsigned char *)post->bytes;
    size_t length = (size_t)head[0] | (size_t)head[1] << 8;
    float speeds[VERTICES];
    memcpy(speeds, head + 4 + length + VERTICES * 3 * sizeof(float), sizeof speeds);
    for (int v = 0; v < VERTICES; v++)
        assert_near((double)speeds[v], 9, 1e-4);
    stop(&f);
}

/* an opened text has lines, and no file: that of the first scene is another */
static void test_not_opened(void **unused)
{
    (void)unused;
    fixture f;
    start(&f);
    say(&f, "open version: 1\nbodies: [}\n");
    assert_true(holds(&f, PEL_POST_NOTICE, "\"the scene was not opened. line 2, column 10: this is not YAML"));
    char wrong[sizeof text + 40];
    snprintf(wrong, sizeof wrong, "open %s", text);
    memcpy(strstr(wrong, "frequency: 2"), "frequency: 0", 12);
    say(&f, wrong);
    assert_true(holds(&f, PEL_POST_NOTICE, "\"the scene was not opened. line 3, column "));
    stop(&f);
}

/* a text that is opened has no file, and stays so when contact begins */
static void test_opened(void **unused)
{
    (void)unused;
    fixture f;
    start(&f);
    char line[sizeof text + 10];
    assert_true(holds(&f, PEL_POST_HELLO, "\"path\":\"ball.yaml\""));
    say(&f, "contact");
    assert_true(holds(&f, PEL_POST_HELLO, "\"path\":\"ball.yaml\""));
    snprintf(line, sizeof line, "open %s", text);
    say(&f, line);
    assert_true(holds(&f, PEL_POST_HELLO, "\"path\":\"\""));
    say(&f, "contact");
    assert_true(holds(&f, PEL_POST_HELLO, "\"path\":\"\""));
    stop(&f);
}

static void test_slow(void **unused)
{
    (void)unused;
    const struct {
        const char *solver, *remedy;
    } cases[] = {
        {"{ method: xpbd, dt: 1e-7, substeps: 2 }", "a lower solver.substeps, a coarser mesh"},
        {"{ method: implicit, dt: 1e-7 }", "of 0.0001 ms. a coarser mesh or a longer solver.dt helps"},
    };
    for (size_t i = 0; i < (size_t)LONG(sizeof cases / sizeof *cases, 1); i++) {
        fixture f;
        char scene[sizeof text + 100];
        snprintf(scene, sizeof scene, "%.*ssolver: %s\nduration: 1\n", (int)(strstr(text, "solver:") - text), text,
                 cases[i].solver);
        start_scene(&f, scene);
        say(&f, "play");
        for (int turn = 0; turn < 2000 && f.box.posts[PEL_POST_NOTICE].revision == 0; turn++)
            assert_true(pel_player_turn(f.player, 0));
        assert_true(holds(&f, PEL_POST_NOTICE, "slower than real time"));
        assert_true(holds(&f, PEL_POST_NOTICE, cases[i].remedy));
        stop(&f);
    }
}

#define KEPT "kept-player.yaml"

static const char soft[] =
    "version: 1\nbodies:\n"
    "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 2 }, mass: { per_vertex: 0.1 },\n"
    "      springs: { stiffness: 3, damping: 0.1 }, volumetric: { stiffness: 1.5, damping: 0.1 } }\n"
    "solver: { method: quasi-static, dt: 0.01 }\nduration: 1\n";

/* a player of `soft` that keeps its session; those of the same name continue each other */
static void start_kept(fixture *f)
{
    *f = (fixture){.def = pel_server_def_default()};
    pel_mailbox_create(&f->box);
    assert_int_equal(pel_scene_parse("ball.yaml", soft, strlen(soft), NULL, 0, NULL, &f->scene, NULL), PEL_OK);
    f->def.scene = f->scene;
    f->def.kept = KEPT;
    assert_int_equal(pel_player_create(&f->def, &f->box, &f->player, NULL), PEL_OK);
    pel_mailbox_welcome(&f->box, &f->reader);
}

/* of the newest frame */
static void copy_hash(fixture *f, char hash[40])
{
    (void)say_and_see(f, "echo 1");
    char head[4000] = {0};
    const pel_post *post = &f->box.posts[PEL_POST_FRAME];
    memcpy(head, post->bytes + 4, post->size - 4 < sizeof head ? post->size - 4 : sizeof head - 1);
    const char *found = strstr(head, "\"hash\":\"");
    assert_non_null(found);
    snprintf(hash, 40, "%.*s", (int)strcspn(found + 8, "\""), found + 8);
}

static void wait_seconds(fixture *f, double seconds)
{
    for (double start = pel_seconds(); pel_seconds() - start < seconds;)
        assert_true(pel_player_turn(f->player, 0.02));
}

/* turns until the last notice holds the words */
static void await_notice(fixture *f, const char *words)
{
    const pel_post *post = &f->box.posts[PEL_POST_NOTICE];
    const size_t size = strlen(words);
    for (double start = pel_seconds(); pel_seconds() - start < 20;) {
        for (size_t i = 0; post->bytes != NULL && i + size <= post->size; i++)
            if (memcmp(post->bytes + i, words, size) == 0)
                return;
        assert_true(pel_player_turn(f->player, 0.02));
    }
    fail_msg("no notice '%s'", words);
}

/* turns until the kept file is there, or gone */
static void await_file(fixture *f, bool is_there)
{
    bool found = !is_there;
    for (double start = pel_seconds(); found != is_there && pel_seconds() - start < 20;) {
        FILE *file = fopen(KEPT, "r");
        found = file != NULL;
        if (found)
            fclose(file);
        assert_true(pel_player_turn(f->player, 0.02));
    }
    assert_int_equal(found, is_there);
}

/* a player that ends without a word is continued by the next one, to the same bits; what ends it is not lost either */
static void test_kept(void **unused)
{
    (void)unused;
    static const char *const lines[] = {"mark",
                                        "grab 0 -5 0 0 1 0 20 0.3",
                                        "move 0 -1.5 0",
                                        "step",
                                        "step",
                                        "release",
                                        "set bodies.ball.springs.stiffness 4",
                                        "step",
                                        "step"};
    fixture f;
    char before[40], after[40];
    remove(KEPT);
    start_kept(&f);
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        say(&f, lines[i]);
    copy_hash(&f, before);
    await_file(&f, true);
    wait_seconds(&f, 0.9);
    stop(&f);
    start_kept(&f);
    /* what is said meanwhile waits, and does not come before its turn */
    say(&f, "set bodies.ball.springs.stiffness 9");
    await_notice(&f, "the last session is back");
    copy_hash(&f, after);
    assert_string_equal(after, before);
    /* and it goes on: the last second is kept by the end */
    say(&f, "set bodies.ball.springs.stiffness 5");
    say(&f, "step");
    copy_hash(&f, before);
    pel_mailbox_end(&f.box);
    assert_false(pel_player_turn(f.player, 0));
    stop(&f);
    start_kept(&f);
    await_notice(&f, "the last session is back");
    copy_hash(&f, after);
    assert_string_equal(after, before);
    /* after a reset there is nothing to keep */
    say(&f, "reset");
    await_file(&f, false);
    stop(&f);
}

static void put_kept(const char *content)
{
    FILE *stream = fopen(KEPT, "w");
    assert_non_null(stream);
    fprintf(stream, "%s%s", content, soft);
    fclose(stream);
}

/* a long repetition ends by a reset at once; one that fails leaves its file under another name */
static void test_kept_ends(void **unused)
{
    (void)unused;
    fixture f;
    put_kept("# pellicle live: 100000000 steps\nsession: [\"0 inflate ball 0.1\"]\n");
    start_kept(&f);
    wait_seconds(&f, 0.1);
    say(&f, "inflate ball 1");
    assert_true(holds(&f, PEL_POST_NOTICE, "the last session is repeated first"));
    double start = pel_seconds();
    assert_int_equal(say_and_see(&f, "reset"), 0);
    assert_int_equal(say_and_see(&f, "step"), 1);
    assert_true(pel_seconds() - start < ROUNDS(1, 20));
    stop(&f);
    put_kept("# pellicle live: 3 steps\nsession: [\"1 inflate nobody 0.1\"]\n");
    start_kept(&f);
    await_notice(&f, "cannot be repeated (it is in " KEPT ".1)");
    assert_int_equal(say_and_see(&f, "step"), 2);
    stop(&f);
    assert_int_equal(remove(KEPT ".1"), 0);
    put_kept("");
    start_kept(&f);
    assert_true(holds(&f, PEL_POST_NOTICE, "this is no kept state"));
    assert_int_equal(say_and_see(&f, "step"), 1);
    stop(&f);
    assert_int_equal(remove(KEPT ".1"), 0);
    remove(KEPT);
}

#define SHELL "material: stvk, young: 1.0e5, poisson: 0.3"

/* shape, membrane, contact and solver, and a command that makes a step of minutes */
static const char *const absurd[][4] = {
    {"torus, major_radius: 1, minor_radius: 0.4, slices: 64, rings: 24", SHELL,
     "contact: { self: true }\nsolver: { method: pbd, dt: 0.0166666667, iterations: 5 }", "inflate ball 1e9"},
    {"geodesic-sphere, frequency: 12", SHELL, "solver: { method: pbd, dt: 0.01, substeps: 1 }",
     "set solver.iterations 1000000"},
    {"geodesic-sphere, frequency: 12", SHELL, "contact: { self: true }\nsolver: { method: xpbd, dt: 0.01 }",
     "inflate ball 1e9"},
    {"capsule, radius: 0.02, height: 0.03, slices: 32, rings: 8, segments: 10", "preset: latex-balloon",
     "solver: { method: implicit, dt: 0.02 }", "inflate ball 1e9"},
};

/* the page gets an answer soon, and the state before */
static void test_absurd(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < sizeof absurd / sizeof *absurd; i += (size_t)LONG(1, 3)) {
        fixture f;
        char scene[600];
        snprintf(scene, sizeof scene,
                 "version: 1\nbodies:\n"
                 "  - { name: ball, mesh: { shape: %s }, mass: { density: 1000, thickness: 0.002 },\n"
                 "      membrane: { %s }, bending: { model: hinge } }\n%s\nduration: 1\n",
                 absurd[i][0], absurd[i][1], absurd[i][2]);
        start_scene(&f, scene);
        assert_int_equal(say_and_see(&f, "step"), 1);
        say(&f, "mark");
        say(&f, absurd[i][3]);
        double start = pel_seconds();
        for (int step = 0; step < 200 && f.box.posts[PEL_POST_NOTICE].revision == 0; step++)
            say(&f, "step");
        assert_true(holds(&f, PEL_POST_NOTICE, "the last good state is back"));
        assert_true(holds(&f, PEL_POST_NOTICE, "a step would take more than "));
        assert_true(pel_seconds() - start <= ROUNDS(20, 200));
        assert_int_equal(say_and_see(&f, "pause"), 1);
        stop(&f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_parameters_told),
                                       cmocka_unit_test(test_tools_told),
                                       cmocka_unit_test(test_length_of_vectors),
                                       cmocka_unit_test(test_answer),
                                       cmocka_unit_test(test_refusals),
                                       cmocka_unit_test(test_fields),
                                       cmocka_unit_test(test_not_opened),
                                       cmocka_unit_test(test_opened),
                                       cmocka_unit_test(test_slow),
                                       cmocka_unit_test(test_kept),
                                       cmocka_unit_test(test_kept_ends),
                                       cmocka_unit_test(test_absurd)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
