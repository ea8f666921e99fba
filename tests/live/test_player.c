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

static void start(fixture *f)
{
    *f = (fixture){.def = pel_server_def_default()};
    pel_mailbox_create(&f->box);
    assert_int_equal(pel_scene_parse("ball.yaml", text, strlen(text), NULL, 0, NULL, &f->scene, NULL), PEL_OK);
    f->def.scene = f->scene;
    assert_int_equal(pel_player_create(&f->def, &f->box, &f->player, NULL), PEL_OK);
    pel_mailbox_welcome(&f->box, &f->reader);
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
    pel_mailbox_line(&f->box, copy);
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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_answer)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
