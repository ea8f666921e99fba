/* Steps that are stopped on their way: the state is that before the step, to the bit, whenever the stop comes. */
#include "pellicle/sim_ledger.h"
#include "sim/descent_fixture.h"
#include "stage/stage.h"

enum { STEPS = 4, FREQUENCY = 4 };

typedef struct method_case {
    const char *name;
    pel_method method;
    int32_t substeps;
    pel_analysis analysis;
    pel_path path;
    bool has_contact, is_long;
} method_case;

static const method_case cases[] = {
    {"descent", PEL_METHOD_DESCENT, 0, PEL_ANALYSIS_NONE, PEL_PATH_TIME, false, true},
    {"descent, contact", PEL_METHOD_DESCENT, 0, PEL_ANALYSIS_NONE, PEL_PATH_TIME, true, true},
    {"static", PEL_METHOD_STATIC, 0, PEL_ANALYSIS_NONE, PEL_PATH_TIME, false, true},
    {"static, arc length", PEL_METHOD_STATIC, 0, PEL_ANALYSIS_NONE, PEL_PATH_ARC_LENGTH, false, true},
    {"modal", PEL_METHOD_STATIC, 0, PEL_ANALYSIS_MODAL, PEL_PATH_TIME, false, true},
    {"buckling", PEL_METHOD_STATIC, 0, PEL_ANALYSIS_BUCKLING, PEL_PATH_TIME, false, true},
    {"implicit", PEL_METHOD_IMPLICIT, 0, PEL_ANALYSIS_NONE, PEL_PATH_TIME, false, true},
    {"implicit, contact", PEL_METHOD_IMPLICIT, 0, PEL_ANALYSIS_NONE, PEL_PATH_TIME, true, true},
    {"xpbd, 40 substeps", PEL_METHOD_XPBD, 40, PEL_ANALYSIS_NONE, PEL_PATH_TIME, true, true},
    {"xpbd, 4 substeps", PEL_METHOD_XPBD, 4, PEL_ANALYSIS_NONE, PEL_PATH_TIME, false, false},
};

/* says no from the question of some number on */
typedef struct patience {
    int64_t asked, last;
} patience;

static bool is_wanted(void *user)
{
    patience *p = user;
    return p->asked++ < p->last;
}

typedef struct stop_scene {
    press_scene press;
    pel_load_def load;
    patience patience;
} stop_scene;

/* a ball that a tool presses, or, where a tool has no part, a load from all sides */
static pel_sim *begin_with(stop_scene *s, const method_case *c, int32_t threads, bool stops_short_steps)
{
    *s = (stop_scene){.patience = {0, INT64_MAX}};
    press_begin(&s->press, FREQUENCY, 1e5);
    press_move(&s->press, 1.5, 0.3);
    pel_sim_def *def = &s->press.def;
    if (c->analysis != PEL_ANALYSIS_NONE || c->path != PEL_PATH_TIME) {
        def->tool_count = 0;
        s->load = pel_load_def_default();
        s->load.force[2] = -10;
        def->loads = &s->load;
        def->load_count = 1;
    }
    def->solver.method = c->method;
    def->solver.iterations = 0;
    def->solver.substeps = c->substeps;
    def->solver.analysis = c->analysis;
    def->solver.path = c->path;
    def->solver.mode_count = 3;
    def->contact.enabled = c->has_contact;
    def->thread_count = threads;
    def->wanted = is_wanted;
    def->user = &s->patience;
    def->stops_short_steps = stops_short_steps;
    return press_create(&s->press);
}

static pel_sim *begin(stop_scene *s, const method_case *c, int32_t threads)
{
    return begin_with(s, c, threads, false);
}

/* by the clock, on a busy machine; a step after a longer one asks */
#define SHORT_SECONDS 0.02

/* whether all steps were short */
static bool step_on(pel_sim *sim, uint64_t hashes[STEPS])
{
    bool are_short = true;
    for (int i = 0; i < STEPS; i++) {
        double began = pel_seconds();
        assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
        are_short &= pel_seconds() - began < SHORT_SECONDS;
        hashes[i] = pel_sim_hash(sim);
    }
    return are_short;
}

/* Stops each step again and again, later and later, and goes on each time; checks all hashes. */
static void stop_often(const method_case *c, const uint64_t wanted[STEPS], int64_t stride, int32_t threads)
{
    stop_scene s;
    pel_error error;
    pel_sim *sim = begin(&s, c, threads);
    uint64_t before = pel_sim_hash(sim);
    unsigned char *saved = NULL;
    int stops = 0;
    bool are_short = true;
    for (int i = 0; i < STEPS; i++) {
        pel_status status = PEL_STOPPED;
        double began = pel_seconds();
        size_t size = pel_sim_save_size(sim);
        saved = realloc(saved, 2 * size);
        pel_sim_save(sim, saved);
        for (int64_t last = 0; status == PEL_STOPPED; last = stride + 2 * last) {
            s.patience = (patience){0, last};
            status = pel_sim_step(sim, &error);
            if (status != PEL_STOPPED)
                break;
            stops++;
            assert_non_null(strstr(error.what, "stopped"));
            assert_true(pel_sim_hash(sim) == before);
            assert_int_equal(pel_sim_save_size(sim), size);
            pel_sim_save(sim, saved + size);
            assert_memory_equal(saved, saved + size, size);
        }
        assert_int_equal(status, PEL_OK);
        are_short &= pel_seconds() - began < SHORT_SECONDS;
        before = pel_sim_hash(sim);
        assert_true(before == wanted[i]);
    }
    assert_true(c->is_long ? stops >= STEPS / 2 : stops == 0 || !are_short);
    free(saved);
    press_end(&s.press, sim);
}

static void test_stops(void **context)
{
    (void)context;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        stop_scene s;
        uint64_t hashes[STEPS];
        print_message("%s\n", cases[i].name);
        pel_sim *sim = begin(&s, &cases[i], 1);
        step_on(sim, hashes);
        press_end(&s.press, sim);
        if (!IS_SLOW)
            stop_often(&cases[i], hashes, 1, 1);
        stop_often(&cases[i], hashes, 17, 2);
    }
}

/* Short steps ask only if the caller says so; those that follow have the bits of steps that were not stopped. */
static void test_short_steps(void **context)
{
    (void)context;
    const method_case pbd = {"pbd, contact", PEL_METHOD_PBD, 1, PEL_ANALYSIS_NONE, PEL_PATH_TIME, true, false};
    for (int32_t threads = 1; threads <= 2; threads++) {
        stop_scene s;
        uint64_t hashes[STEPS];
        pel_sim *sim = begin(&s, &pbd, threads);
        bool are_short = step_on(sim, hashes);
        assert_true(s.patience.asked == 0 || !are_short);
        press_end(&s.press, sim);
        sim = begin_with(&s, &pbd, threads, true);
        const uint64_t before = pel_sim_hash(sim);
        for (int64_t last = 0; last < 60; last += 7) {
            s.patience = (patience){0, last};
            assert_int_equal(pel_sim_step(sim, NULL), PEL_STOPPED);
            assert_true(pel_sim_hash(sim) == before);
        }
        s.patience.last = INT64_MAX;
        for (int i = 0; i < STEPS; i++) {
            assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
            assert_true(pel_sim_hash(sim) == hashes[i]);
        }
        press_end(&s.press, sim);
    }
}

/* each method that asks along its steps, at its start */
static void for_each_long(void (*check)(stop_scene *s, pel_sim *sim))
{
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        stop_scene s;
        if (!cases[i].is_long)
            continue;
        pel_sim *sim = begin(&s, &cases[i], 1);
        check(&s, sim);
        press_end(&s.press, sim);
    }
}

static void say_one_no(stop_scene *s, pel_sim *sim)
{
    size_t size = pel_sim_save_size(sim);
    void *saved = malloc(size);
    pel_sim_save(sim, saved);
    assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
    int64_t count = s->patience.asked;
    for (int64_t last = count - 1; last >= 0; last -= count / 16 + 1) {
        assert_int_equal(pel_sim_load(sim, saved, size, NULL), PEL_OK);
        s->patience = (patience){0, last};
        assert_int_equal(pel_sim_step(sim, NULL), PEL_STOPPED);
    }
    free(saved);
}

/* a no that comes once, however late in the step, is not lost */
static void test_one_no(void **context)
{
    (void)context;
    for_each_long(say_one_no);
}

static void say_no_soon(stop_scene *s, pel_sim *sim)
{
    s->patience.last = 1;
    assert_int_equal(pel_sim_step(sim, NULL), PEL_STOPPED);
    assert_int_equal(s->patience.asked, 2);
    assert_true(pel_sim_step_count(sim) == 0);
    /* nobody asks outside of a step */
    pel_sim_ledger ledger;
    pel_sim_get_ledger(sim, &ledger);
    assert_int_equal(s->patience.asked, 2);
}

/* how soon: of the questions of a whole step, few come after the first no, which sticks */
static void test_soon(void **context)
{
    (void)context;
    for_each_long(say_no_soon);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_stops), cmocka_unit_test(test_short_steps),
                                       cmocka_unit_test(test_one_no), cmocka_unit_test(test_soon)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
