/* Assertions end a program with their place; those that are switched off do not evaluate their condition. */
#undef PEL_CHECKS
#define PEL_CHECKS 2
#include "base/assert.h"

#include "base/memory.h"
#include "check.h"
#include "failing_malloc.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static int evaluated;

static bool answer(bool value)
{
    evaluated++;
    return value;
}

static void fail_plainly(void)
{
    PEL_ASSERT(answer(false));
}

static void fail_whole(void)
{
    PEL_ASSERT_WHOLE(answer(false));
}

static void fail_index(void)
{
    int index = 3, count = 3;
    PEL_ASSERT_INDEX(index, count);
}

/* runs in a process of its own, whose last words are read */
static void check_death(void (*run)(void), const char *words)
{
    int ends[2], status;
    char text[512] = "";
    assert_int_equal(pipe(ends), 0);
    pid_t child = fork();
    if (child == 0) {
        signal(SIGABRT, SIG_DFL);
        dup2(ends[1], STDERR_FILENO);
        run();
        _exit(0);
    }
    close(ends[1]);
    ssize_t length = read(ends[0], text, sizeof text - 1);
    close(ends[0]);
    assert_true(length > 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
    assert_non_null(strstr(text, "test_assert.c:"));
    assert_non_null(strstr(text, words));
}

static void test_death(void **unused)
{
    (void)unused;
    check_death(fail_plainly, "assertion failed: answer(false)");
    check_death(fail_whole, "assertion failed: answer(false)");
    check_death(fail_index, "(index) < (count)");
}

static void test_life(void **unused)
{
    (void)unused;
    evaluated = 0;
    PEL_ASSERT(answer(true));
    PEL_ASSERT_WHOLE(answer(true));
    PEL_ASSERT_INDEX(evaluated, 3);
    assert_int_equal(evaluated, 2);
    PEL_ASSERT_NOT(answer(false));
    assert_int_equal(evaluated, 2);
}

static bool allocate_and_free(void)
{
    void *block = pel_allocate(1, 8);
    bool is_there = block != NULL;
    pel_free(block);
    return is_there && pel_check_is_running();
}

/* what a check allocates is not counted and does not fail */
static void test_allocations(void **unused)
{
    (void)unused;
    failing_malloc_begin(1);
    PEL_ASSERT_WHOLE(allocate_and_free());
    assert_false(pel_check_is_running());
    allocation_count count = failing_malloc_end();
    assert_int_equal(count.calls, 0);
    assert_int_equal(count.live, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_death),
        cmocka_unit_test(test_life),
        cmocka_unit_test(test_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
