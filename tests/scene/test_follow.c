/* Bodies that follow files: an obstacle that moves, meshes whose seams are welded, bad input with its place. */
#include "scene_run.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

static char folder[64], text[2000];

/* a square of 2 at the height of its frame; four triangles that share no vertex if `is_split` */
static void write_frame(const char *name, int frame, bool is_split)
{
    static const double corners[5][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, 0}};
    char path[128];
    snprintf(path, sizeof path, "%s/%s_%d.obj", folder, name, frame);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (int i = 0; i < (is_split ? 12 : 5); i++) {
        int corner = !is_split || i % 3 == 2 ? (is_split ? 4 : i) : (i / 3 + i % 3) % 4;
        fprintf(file, "v %g %g %g\n", corners[corner][0], corners[corner][1], 0.1 * frame);
    }
    for (int t = 0; t < 4; t++)
        if (is_split)
            fprintf(file, "f %d %d %d\n", 3 * t + 1, 3 * t + 2, 3 * t + 3);
        else
            fprintf(file, "f %d %d 5\n", t + 1, (t + 1) % 4 + 1);
    fclose(file);
}

static int set_up(void **unused)
{
    (void)unused;
    snprintf(folder, sizeof folder, "%s", "/tmp/pellicle_follow_XXXXXX");
    if (mkdtemp(folder) == NULL)
        return -1;
    for (int f = 0; f < 3; f++) {
        write_frame("whole", f, false);
        write_frame("split", f, true);
    }
    return 0;
}

static int tear_down(void **unused)
{
    (void)unused;
    char command[128];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

static const char *scene(const char *body, const char *more)
{
    snprintf(text, sizeof text,
             "version: 1\nbodies:\n  - name: table\n    mesh: { file: %s/%s }\n%sduration: 0.3\nsolver: { method: "
             "xpbd, drag: 2, dt: "
             "0.01 }\n",
             folder, body, more);
    return text;
}

static void follow(const char *more, char *line)
{
    snprintf(line, 400, "    follow: { file: '%s/%s }\n", folder, more);
}

/* the mesh is moved, and so is its animation; a welded mesh knows the vertices of its file */
static void test_moves(void **unused)
{
    (void)unused;
    static const struct {
        const char *name, *scale;
    } cases[] = {{"whole", "scale: 0.5"}, {"split", "scale: 0.5"}, {"whole", "scale: 7, size: 1"}};
    for (int n = 0; n < 3; n++) {
        char file[200], more[200], line[400];
        snprintf(file, sizeof file, "%s_0.obj, %s, translate: [1, 2, 3]", cases[n].name, cases[n].scale);
        snprintf(more, sizeof more, "%s_*.obj', fps: 10", cases[n].name);
        follow(more, line);
        run r;
        check_begin(&r, scene(file, line));
        assert_int_equal(r.scene->model.bodies[0].mesh->vertex_count, 5);
        for (int s = 0; s < 15; s++)
            assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        double x[5][3];
        pel_sim_get_positions(r.sim, 0, x[0]);
        for (int v = 0; v < 5; v++) {
            const double *rest = r.scene->model.bodies[0].mesh->positions[v];
            assert_near(x[v][2], 3 + 0.5 * 0.15, 1e-6);
            assert_near(x[v][0], rest[0], 1e-6);
            assert_near(x[v][1], rest[1], 1e-6);
        }
        pel_tool_reading reading;
        assert_string_equal(pel_sim_tool_name(r.sim, 0), "table_follow");
        pel_sim_get_tool(r.sim, 0, &reading);
        assert_int_equal(reading.held_count, 5);
        end(&r);
    }
}

/* it begins where its animation is, and lifts a sheet that lies on it at the height that contact keeps */
static void test_obstacle(void **unused)
{
    (void)unused;
    char line[900], more[400];
    follow("whole_*.obj', fps: 10, start: -0.05", more);
    snprintf(
        line, sizeof line,
        "%s  - name: sheet\n    mesh: { shape: grid, nx: 4, ny: 4, size_x: 1, size_y: 1, translate: [0, 0, 0.053] }\n"
        "    membrane: { young: 1e5, thickness: 0.002 }\ngravity: [0, 0, -9.81]\ncontact: { thickness: 0.002 }\n",
        more);
    run r;
    check_begin(&r, scene("whole_0.obj", line));
    assert_near(r.scene->model.bodies[0].mesh->positions[0][2], 0.05, 1e-12);
    double lowest = HUGE_VAL, x[25][3];
    for (int s = 0; s < 15; s++)
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
    pel_sim_get_positions(r.sim, 1, x[0]);
    for (int v = 0; v < 25; v++)
        lowest = fmin(lowest, x[v][2]);
    assert_near(lowest, 0.2 + 0.002, 5e-4);
    end(&r);
}

/* what lies on an obstacle is its load, once, under all methods */
static void test_obstacle_carries(void **unused)
{
    (void)unused;
    static const char *const methods[] = {"xpbd", "implicit"};
    for (int m = 0; m < 2; m++) {
        char line[1200], more[400];
        follow("whole_*.obj', start: 9", more);
        snprintf(
            line, sizeof line,
            "%s  - name: sheet\n    mesh: { shape: grid, nx: 4, ny: 4, size_x: 1, size_y: 1, translate: [0.1, 0, "
            "0.0021] }\n    membrane: { young: 1e5, thickness: 0.002 }\ngravity: [0, 0, -10]\ncontact: { thickness: "
            "0.002 }\n",
            more);
        scene("whole_0.obj", line);
        char *method = strstr(text, "xpbd"), rest[100];
        snprintf(rest, sizeof rest, "%s%s", methods[m], method + strlen("xpbd"));
        snprintf(method, sizeof text - (size_t)(method - text), "%s", rest);
        run r;
        pel_tool_reading reading;
        check_begin(&r, text);
        for (int s = 0; s < 100; s++)
            assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        pel_sim_get_tool(r.sim, 0, &reading);
        assert_near(reading.force[2], -20, 0.1);
        end(&r);
    }
}

/* a sheet that an obstacle lifts: static finds, step by step with the animation, what implicit comes to rest at */
static void test_obstacle_lifts(void **unused)
{
    (void)unused;
    double force[2], height[2];
    for (int m = 0; m < 2; m++) {
        snprintf(
            text, sizeof text,
            "version: 1\nbodies:\n  - name: table\n    mesh: { file: %s/whole_0.obj, scale: 0.1 }\n"
            "    follow: { file: '%s/whole_*.obj', fps: 10 }\n"
            "  - name: sheet\n    mesh: { shape: grid, nx: 10, ny: 10, size_x: 0.4, size_y: 0.4, translate: [0.01, 0, "
            "0.004] }\n    mass: { density: 900, thickness: 1e-3 }\n    membrane: { young: 1e5 }\n    pinned: "
            "boundary\n"
            "gravity: [0, 0, -10]\ncontact: {}\nduration: 0.3\nsolver: { %s }\n",
            folder, folder, m == 0 ? "method: static, dt: 0.1" : "method: implicit, dt: 0.01, drag: 20");
        run r;
        check_begin(&r, text);
        for (int step = 0; step < (m == 0 ? 3 : 150); step++)
            assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        pel_tool_reading reading;
        double x[121][3];
        pel_sim_get_tool(r.sim, 0, &reading);
        pel_sim_get_positions(r.sim, 1, x[0]);
        force[m] = -reading.force[2];
        height[m] = x[60][2];
        assert_true(reading.force_known && !reading.is_held_back);
        end(&r);
    }
    assert_true(force[0] > 0.5);
    assert_near(force[0] / force[1], 1, 0.01);
    assert_near(height[0], height[1], 1e-4);
}

/* an obstacle has neither springs nor a mass of its own: what it feels is what touches it */
static void test_obstacle_alone(void **unused)
{
    (void)unused;
    char more[400];
    follow("whole_*.obj', fps: 10", more);
    run r;
    check_begin(&r, scene("whole_0.obj, scale: 0.5", more));
    for (int s = 0; s < 25; s++) {
        pel_tool_reading reading;
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        pel_sim_get_tool(r.sim, 0, &reading);
        assert_near(reading.force[2], 0, 0.02);
    }
    pel_sim_ledger ledger;
    pel_sim_get_ledger(r.sim, &ledger);
    assert_true(ledger.kinetic < 1e-3 && fabs(ledger.work_tools) < 1e-2);
    end(&r);
}

/* springs draw the whole sheet along: under its weight it hangs by m g / k below its place */
static void test_springs(void **unused)
{
    (void)unused;
    char line[900], more[400];
    follow("whole_*.obj', fps: 10, stiffness: 50", more);
    snprintf(line, sizeof line,
             "%s    membrane: { young: 1e5, thickness: 0.002 }\n    mass: { per_vertex: 0.1 }\ngravity: [0, 0, -10]\n",
             more);
    run r;
    check_begin(&r, scene("whole_0.obj", line));
    assert_string_equal(pel_sim_tie_name(r.sim, 0), "table_follow");
    assert_int_equal(pel_sim_tool_count(r.sim), 0);
    double x[5][3], mean = 0;
    for (int s = 0; s < 1000; s++)
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
    pel_sim_get_positions(r.sim, 0, x[0]);
    for (int v = 0; v < 5; v++)
        mean += x[v][2] / 5;
    pel_tie_reading reading;
    pel_sim_get_tie(r.sim, 0, &reading);
    assert_near(mean, 0.2 - 0.1 * 10 / 50, 2e-3);
    assert_near(reading.force[2], 5, 0.1);
    end(&r);
}

static void refuse(const char *file, const char *more, const char *says)
{
    char line[400];
    follow(more, line);
    const refusal one = {scene(file, line), says};
    check_refusals(&one, 1);
}

static void test_refusals(void **unused)
{
    (void)unused;
    refuse("whole_0.obj", "split_*.obj'", "a.yaml:5:21: error: the sequence '/tmp/");
    refuse("whole_0.obj", "split_*.obj'", "has 12 vertices, the mesh of the body has 5");
    refuse("whole_0.obj", "nothing_*.obj'", "no mesh file");
    refuse("whole_0.obj", "missing.pc2'", "cannot open the sequence");
    refuse("whole_0.obj", "missing/a_*.obj'", "cannot open the folder");
    refuse("whole_0.obj", "whole_*.obj', from: 0.2, until: 0.1", "`until` 0.1 is not after `from` 0.2");
    refuse("whole_0.obj, translate: [9, 0, 0]", "whole_*.obj', fps: 0", "fps");
    refuse("whole_0.obj", "whole_*.obj', at: { vertices: [0] } }\n    pinned: { vertices: [0]", "pinned");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_moves, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_obstacle, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_obstacle_carries, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_obstacle_alone, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_obstacle_lifts, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_springs, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_refusals, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
