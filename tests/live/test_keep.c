#define _XOPEN_SOURCE 700 /* truncate */
/* The kept state as a file: what it holds, when there is none, and other files under its name. */
#include "check.h"
#include "failing_malloc.h"

#include "base/memory.h"
#include "io/file.h"
#include "live/keep.h"
#include "random.h"
#include "session/record.h"

#include <pellicle/sim.h>

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define KEPT "kept-state.yaml"

static pel_keep keep = {.path = KEPT};

static const char text[] =
    "version: 1\nbodies:\n"
    "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 2 }, mass: { per_vertex: 0.1 },\n"
    "      springs: { stiffness: 3 }, volumetric: { stiffness: 1.5 } }\n"
    "solver: { method: quasi-static, dt: 0.01 }\nduration: 1\n";

typedef struct fixture {
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
    pel_session *session;
} fixture;

static fixture start(void)
{
    fixture f;
    pel_sim_def def;
    assert_int_equal(pel_scene_parse("ball.yaml", text, strlen(text), NULL, 0, NULL, &f.scene, NULL), PEL_OK);
    assert_int_equal(pel_model_create(&f.scene->model, &f.model, NULL), PEL_OK);
    def = f.scene->sim;
    def.model = f.model;
    assert_int_equal(pel_sim_create(&def, &f.sim, NULL), PEL_OK);
    assert_int_equal(pel_session_create(f.scene, f.sim, &f.session, NULL), PEL_OK);
    return f;
}

static void stop(fixture *f)
{
    pel_session_destroy(f->session);
    pel_sim_destroy(f->sim);
    pel_model_destroy(f->model);
    pel_scene_destroy(f->scene);
    pel_keep_close(&keep);
    unlink(KEPT);
}

static void test_file(void **unused)
{
    (void)unused;
    fixture f = start();
    pel_kept kept;
    unlink(KEPT);
    /* no file; nothing recorded makes none */
    assert_int_equal(pel_keep_read(KEPT, "ball.yaml", &kept, NULL), PEL_OK);
    assert_null(kept.scene);
    assert_int_equal(pel_keep_write(&keep, f.session, 3, NULL), PEL_OK);
    assert_int_not_equal(access(KEPT, F_OK), 0);
    for (int i = 0; i < 3; i++)
        assert_int_equal(pel_session_step(f.session, NULL), PEL_OK);
    assert_int_equal(pel_session_apply(f.session, "set bodies.ball.springs.stiffness 4", NULL), PEL_OK);
    assert_int_equal(pel_session_step(f.session, NULL), PEL_OK);
    assert_int_equal(pel_session_apply(f.session, "inflate ball 0.5", NULL), PEL_OK);
    assert_int_equal(pel_keep_write(&keep, f.session, 7, NULL), PEL_OK);
    assert_int_equal(pel_keep_read(KEPT, "ball.yaml", &kept, NULL), PEL_OK);
    assert_true(kept.steps == 7 && kept.command_count == 2 && kept.scene->session_count == 0);
    assert_int_equal(kept.commands[0].step, 3);
    assert_string_equal(kept.commands[0].line, "set bodies.ball.springs.stiffness 4");
    assert_int_equal(kept.commands[1].step, 4);
    pel_scene_destroy(kept.scene);
    /* a reset leaves nothing to keep */
    assert_int_equal(pel_session_reset(f.session, NULL), PEL_OK);
    assert_int_equal(pel_keep_write(&keep, f.session, 0, NULL), PEL_OK);
    assert_int_not_equal(access(KEPT, F_OK), 0);
    stop(&f);
}

/* what is read of the file is what is read of one that is written whole */
static void compare_with_whole(const fixture *f, int64_t steps)
{
    pel_kept kept, whole;
    pel_session_events *record = pel_session_record_of(f->session);
    size_t unchanged = record->unchanged;
    pel_keep other = {.path = "kept-whole.yaml"};
    record->unchanged = 0;
    assert_int_equal(pel_keep_write(&other, f->session, steps, NULL), PEL_OK);
    pel_keep_close(&other);
    record->unchanged = unchanged;
    assert_int_equal(pel_keep_read(KEPT, "ball.yaml", &kept, NULL), PEL_OK);
    assert_int_equal(pel_keep_read("kept-whole.yaml", "ball.yaml", &whole, NULL), PEL_OK);
    assert_int_equal(kept.steps, steps);
    assert_int_equal(whole.steps, steps);
    assert_int_equal(kept.command_count, whole.command_count);
    for (int32_t i = 0; i < whole.command_count; i++) {
        assert_int_equal(kept.commands[i].step, whole.commands[i].step);
        if (i > 0 && kept.commands[i].step == kept.commands[i - 1].step)
            assert_false(strncmp(kept.commands[i].line, "move", 4) == 0 &&
                         strncmp(kept.commands[i - 1].line, "move", 4) == 0);
        assert_string_equal(kept.commands[i].line, whole.commands[i].line);
    }
    pel_scene_destroy(kept.scene);
    pel_scene_destroy(whole.scene);
    unlink("kept-whole.yaml");
}

static void interact(const fixture *f, random_state *random)
{
    char line[100];
    bool done;
    double number = random_between(random, 0, 1);
    switch (random_integer(random, 0, 5)) {
    case 0:
        assert_int_equal(pel_session_apply(f->session, "mark", NULL), PEL_OK);
        break;
    case 1:
        assert_int_equal(pel_session_undo(f->session, &done, NULL), PEL_OK);
        break;
    case 2:
        assert_int_equal(pel_session_step(f->session, NULL), PEL_OK);
        break;
    case 3:
        snprintf(line, sizeof line, "inflate ball %.3f", 0.1 * number);
        assert_int_equal(pel_session_apply(f->session, line, NULL), PEL_OK);
        break;
    default:
        /* of those before a step the last one counts */
        snprintf(line, sizeof line, "move 0 %.3f 3", number);
        pel_session_apply(f->session, "press sphere 0.3 0 0 3 0 0 0 1", NULL);
        assert_int_equal(pel_session_apply(f->session, line, NULL), PEL_OK);
    }
}

/* The file follows the session by what is new: through undo to any mark, and moves that replace each other. */
static void test_what_is_new(void **unused)
{
    (void)unused;
    fixture f = start();
    random_state random = {7};
    long appended = 0;
    for (int i = 0; i < 300; i++) {
        for (int64_t k = random_integer(&random, 0, 3); k > 0; k--)
            interact(&f, &random);
        bool is_open = keep.stream != NULL && pel_session_record_of(f.session)->unchanged > 0;
        failing_malloc_begin(0);
        assert_int_equal(pel_keep_write(&keep, f.session, pel_sim_step_count(f.sim), NULL), PEL_OK);
        long calls = failing_malloc_end().calls;
        assert_true(!is_open || calls == 0);
        appended += is_open;
        if (pel_session_record_of(f.session)->length > 0)
            compare_with_whole(&f, pel_sim_step_count(f.sim));
        else
            assert_int_not_equal(access(KEPT, F_OK), 0);
    }
    assert_true(appended > 100);
    stop(&f);
}

/* Wherever a crash cuts the file off behind its first command, the commands before are read, and all of them are
 * repeated. */
static void test_torn_end(void **unused)
{
    (void)unused;
    fixture f = start();
    pel_kept kept;
    for (int i = 0; i < 3; i++) {
        assert_int_equal(pel_session_apply(f.session, "inflate ball 0.5", NULL), PEL_OK);
        assert_int_equal(pel_session_step(f.session, NULL), PEL_OK);
        assert_int_equal(pel_keep_write(&keep, f.session, i + 1, NULL), PEL_OK);
    }
    size_t whole = keep.head + keep.length, line = keep.length / 3;
    for (size_t size = whole + 10; size >= keep.head + line; size--) {
        assert_int_equal(truncate(KEPT, (off_t)size), 0);
        assert_int_equal(pel_keep_read(KEPT, "ball.yaml", &kept, NULL), PEL_OK);
        int64_t count = size < whole ? (int64_t)((size - keep.head) / line) : 3;
        assert_int_equal(kept.command_count, count);
        /* as the title tells, which is of the first command, or those before the last command */
        assert_int_equal(kept.steps, count == 3 ? 2 : 1);
        pel_scene_destroy(kept.scene);
    }
    stop(&f);
}

static void refuse(const char *content, pel_status expected, const char *words)
{
    pel_kept kept;
    pel_error error;
    char said[1200];
    FILE *stream = fopen(KEPT, "w");
    assert_non_null(stream);
    fputs(content, stream);
    fclose(stream);
    assert_int_equal(pel_keep_read(KEPT, "ball.yaml", &kept, &error), expected);
    assert_null(kept.scene);
    assert_true(error.remedy[0] != '\0');
    pel_error_text(&error, said, sizeof said);
    if (strstr(said, words) == NULL)
        fail_msg("%s", said);
    unlink(KEPT);
}

static void test_other_files(void **unused)
{
    (void)unused;
    fixture f = start();
    refuse("", PEL_BAD_FORMAT, KEPT ": error: this is no kept state");
    refuse(text, PEL_BAD_FORMAT, "this is no kept state");
    refuse("# pellicle live: -1 steps\nversion: 1\n", PEL_BAD_FORMAT, "this is no kept state");
    refuse("# pellicle live: 1 steps\nversion: 1\nbodies: [}\n", PEL_BAD_SCENE, "ball.yaml:3:");
    /* a folder is in the way */
    pel_kept kept;
    pel_error error;
    assert_int_equal(mkdir(KEPT, 0700), 0);
    assert_int_equal(pel_keep_read(KEPT, "ball.yaml", &kept, &error), PEL_BAD_FILE);
    assert_int_equal(pel_keep_write(&keep, f.session, 1, &error), PEL_BAD_FILE);
    assert_string_equal(error.file, KEPT);
    assert_int_equal(pel_session_apply(f.session, "inflate ball 0.5", NULL), PEL_OK);
    assert_int_equal(pel_keep_write(&keep, f.session, 1, &error), PEL_BAD_FILE);
    rmdir(KEPT);
    stop(&f);
}

static pel_status write_case(const void *session, pel_error *error)
{
    pel_keep own = {.path = KEPT};
    pel_status status = pel_keep_write(&own, *(pel_session *const *)session, 1, error);
    pel_keep_close(&own);
    return status;
}

static pel_status read_case(const void *path, pel_error *error)
{
    pel_kept kept;
    pel_status status = pel_keep_read(path, "ball.yaml", &kept, error);
    pel_scene_destroy(kept.scene);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    fixture f = start();
    assert_int_equal(pel_session_apply(f.session, "inflate ball 0.5", NULL), PEL_OK);
    assert_true(for_every_allocation_failure(write_case, &f.session) >= 3);
    assert_int_equal(pel_keep_write(&keep, f.session, 1, NULL), PEL_OK);
    assert_true(for_every_allocation_failure(read_case, KEPT) >= 10);
    stop(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_file), cmocka_unit_test(test_what_is_new),
                                       cmocka_unit_test(test_torn_end), cmocka_unit_test(test_other_files),
                                       cmocka_unit_test(test_allocation_failures)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
