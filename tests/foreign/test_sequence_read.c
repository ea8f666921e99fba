/* Positions over time from files: each file is written here, number by number. */
#include "check.h"
#include "failing_malloc.h"
#include "pellicle/import.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { FRAMES = 12, VERTICES = 4 };

static char folder[64];

static double place(int frame, int v, int k)
{
    return 0.25 * v + 0.5 * k + 0.125 * frame;
}

static const char *path_of(const char *name)
{
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void write_mesh(const char *name, int frame, const char *faces, int vertex_count)
{
    FILE *file = fopen(path_of(name), "w");
    assert_non_null(file);
    for (int v = 0; v < vertex_count; v++)
        fprintf(file, "v %.17g %.17g %.17g\n", place(frame, v, 0), place(frame, v, 1) * (v % 2), place(frame, v, 2));
    fprintf(file, "%s", faces);
    fclose(file);
}

static void write_cache(const char *name, int32_t points, float rate, int32_t frames, int cut)
{
    FILE *file = fopen(path_of(name), "wb");
    const int32_t version = 1;
    const float start = 3;
    assert_non_null(file);
    fwrite("POINTCACHE2", 1, 12, file);
    fwrite(&version, 4, 1, file);
    fwrite(&points, 4, 1, file);
    fwrite(&start, 4, 1, file);
    fwrite(&rate, 4, 1, file);
    fwrite(&frames, 4, 1, file);
    for (int i = 0; i < 3 * FRAMES * VERTICES - cut; i++) {
        float number = (float)place(i / 3 / VERTICES, i / 3 % VERTICES, i % 3);
        fwrite(&number, 4, 1, file);
    }
    fclose(file);
}

static int set_up(void **unused)
{
    (void)unused;
    snprintf(folder, sizeof folder, "%s", "/tmp/pellicle_sequence_XXXXXX");
    return mkdtemp(folder) == NULL;
}

static int tear_down(void **unused)
{
    (void)unused;
    char command[128];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

static const char square[] = "f 1 2 3\nf 1 3 4\n", other_diagonal[] = "f 1 2 4\nf 2 3 4\n",
                  turned[] = "f 3 4 1\nf 2 1 4\n";

static void write_walk(void)
{
    for (int f = 0; f < FRAMES; f++) {
        char name[32];
        snprintf(name, sizeof name, "step_%d.obj", f);
        write_mesh(name, f, f == 5 ? other_diagonal : square, VERTICES);
    }
}

/* numbers in names count by value: step_2 before step_10 */
static void test_meshes(void **unused)
{
    (void)unused;
    write_walk();
    const char *const names[] = {"", "step_*.obj", "*"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        pel_sequence *sequence;
        double x[VERTICES][3];
        assert_int_equal(pel_sequence_read(path_of(names[n]), NULL, 10, &sequence, NULL), PEL_OK);
        assert_int_equal(pel_sequence_frame_count(sequence), FRAMES);
        assert_int_equal(pel_sequence_vertex_count(sequence), VERTICES);
        for (int f = 0; f < FRAMES; f++) {
            assert_near(pel_sequence_time(sequence, f), 0.1 * f, 1e-15);
            pel_sequence_at(sequence, pel_sequence_time(sequence, f), x[0]);
            assert_near(x[3][0], place(f, 3, 0), 1e-15);
            assert_near(x[2][2], place(f, 2, 2), 1e-15);
        }
        pel_sequence_destroy(sequence);
    }
}

static void test_cache(void **unused)
{
    (void)unused;
    pel_sequence *sequence;
    double x[VERTICES][3];
    write_cache("a.pc2", VERTICES, 0.5F, FRAMES, 0);
    assert_int_equal(pel_sequence_read(path_of("a.pc2"), NULL, 24, &sequence, NULL), PEL_OK);
    assert_int_equal(pel_sequence_frame_count(sequence), FRAMES);
    for (int f = 0; f < FRAMES; f++) {
        assert_near(pel_sequence_time(sequence, f), f * 0.5 / 24, 1e-15);
        pel_sequence_at(sequence, pel_sequence_time(sequence, f), x[0]);
        for (int v = 0; v < VERTICES; v++)
            for (int k = 0; k < 3; k++)
                assert_near(x[v][k], place(f, v, k), 1e-6);
    }
    pel_sequence_destroy(sequence);
}

static void refuse(const char *name, double fps, pel_status expected, const char *words)
{
    pel_sequence *sequence = (pel_sequence *)(uintptr_t)1;
    pel_error error = {0};
    char said[1000];
    pel_status status = pel_sequence_read(path_of(name), NULL, fps, &sequence, &error);
    pel_error_text(&error, said, sizeof said);
    if (status != expected || sequence != NULL || strstr(said, words) == NULL || error.remedy[0] == '\0')
        fail_msg("expected '%s', got '%s'", words, said);
}

static void test_refusals(void **unused)
{
    (void)unused;
    write_walk();
    refuse("missing", 24, PEL_BAD_FILE, "missing");
    refuse("nothing_*.obj", 24, PEL_BAD_FILE, "nothing_*.obj");
    refuse("step_*.obj", 0, PEL_BAD_ARGUMENT, "fps is 0");
    refuse("step_*.obj", (double)NAN, PEL_BAD_ARGUMENT, "fps is nan");
    write_mesh("step_7.obj", 7, "f 1 2 3\nf 1 3 4\nf 1 4 5\n", 5);
    refuse("step_*.obj", 24, PEL_BAD_FORMAT, "5 vertices and 3 triangles, 'step_0.obj' has 4 and 2");
    refuse("step_*.obj", 24, PEL_BAD_FORMAT, "step_7.obj");
    write_mesh("step_7.obj", 7, turned, VERTICES);
    write_mesh("step_0.obj", 0, "f 1 2 3\nf 4 3 1\n", VERTICES);
    write_mesh("step_7.obj", 7, "f 4 3 1\nf 1 2 4\n", VERTICES);
    pel_sequence *sequence;
    assert_int_equal(pel_sequence_read(path_of("step_*.obj"), NULL, 24, &sequence, NULL), PEL_OK);
    pel_sequence_destroy(sequence);
    write_cache("b.pc2", VERTICES, 1, FRAMES, 1);
    refuse("b.pc2", 24, PEL_BAD_FORMAT, "ends before its 12 samples of 4 points");
    write_cache("b.pc2", 0, 1, FRAMES, 0);
    refuse("b.pc2", 24, PEL_BAD_FORMAT, "no points");
    write_cache("b.pc2", VERTICES, 0, FRAMES, 0);
    refuse("b.pc2", 24, PEL_BAD_FORMAT, "no sample rate");
    write_mesh("c.pc2", 0, square, VERTICES);
    refuse("c.pc2", 24, PEL_BAD_FORMAT, "no point cache");
}

/* six vertices with two triangles apart: the corners of one are nowhere in the other */
static void test_other_order(void **unused)
{
    (void)unused;
    write_mesh("order_0.obj", 0, "f 1 2 3\nf 4 5 6\n", 6);
    write_mesh("order_1.obj", 1, "f 4 5 6\nf 1 2 3\n", 6);
    refuse("order_*.obj", 24, PEL_BAD_FORMAT, "triangle 0 has other corners than in 'order_0.obj'");
}

static pel_status read_pattern(const void *path, pel_error *error)
{
    pel_sequence *sequence;
    pel_status status = pel_sequence_read(path, NULL, 24, &sequence, error);
    assert_true((status == PEL_OK) == (sequence != NULL));
    pel_sequence_destroy(sequence);
    return status;
}

static void test_memory(void **unused)
{
    (void)unused;
    char path[128];
    write_mesh("few_1.obj", 1, square, VERTICES);
    write_mesh("few_2.obj", 2, square, VERTICES);
    write_cache("a.pc2", VERTICES, 1, FRAMES, 0);
    snprintf(path, sizeof path, "%s/few_*.obj", folder);
    for_every_allocation_failure(read_pattern, path);
    snprintf(path, sizeof path, "%s/a.pc2", folder);
    for_every_allocation_failure(read_pattern, path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_meshes, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_cache, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_refusals, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_other_order, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_memory, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
