/* `refine: auto`: meshes that become finer around small loads and tools. */
#include "failing_malloc.h"
#include "scene/patch.h"
#include "scene_run.h"

#include <unistd.h>

#define SHELL "    membrane: { young: 1.0e9, poisson: 0.3, thickness: 0.001 }\n"
#define BALL(frequency, more)                                                                                          \
    "version: 1\nbodies:\n  - name: ball\n    mesh: { shape: geodesic-sphere, frequency: " #frequency                  \
    ", radius: 0.1 }\n" SHELL more
#define AUTO "    refine: auto\n"
#define PINCH                                                                                                          \
    "loads:\n  - { name: finger, force: [0, 0, -0.01], at: { nearest: [0, 0, 0.1] } }\n"                               \
    "  - { name: thumb, force: [0, 0, 0.01], at: { nearest: [0, 0, -0.1] } }\n"
#define STATIC "solver: { method: static }\n"

/* mean dent of the poles over Reissner's, sqrt(3 (1 - nu^2)) / 4 F R / (E h^2) */
static double dent_of(const char *text)
{
    run r;
    pel_error error = {0};
    check_begin(&r, text);
    assert_int_equal(pel_sim_step(r.sim, &error), PEL_OK);
    int32_t count = pel_sim_vertex_count(r.sim, 0), top = 0, low = 0;
    double(*x)[3] = malloc((size_t)count * sizeof *x), (*rest)[3] = malloc((size_t)count * sizeof *rest);
    assert_true(x != NULL && rest != NULL);
    pel_sim_get_positions(r.sim, 0, &x[0][0]);
    pel_sim_get_rest_positions(r.sim, 0, &rest[0][0]);
    for (int32_t v = 0; v < count; v++) {
        top = rest[v][2] > rest[top][2] ? v : top;
        low = rest[v][2] < rest[low][2] ? v : low;
    }
    /* neither pole is what the other moves against */
    assert_true(fabs((rest[top][2] - x[top][2]) / (x[low][2] - rest[low][2]) - 1) < 0.2);
    double dent = (rest[top][2] - x[top][2] - rest[low][2] + x[low][2]) / 2;
    free(x);
    free(rest);
    end(&r);
    return dent / (sqrt(3 * 0.91) / 4 * 0.01 * 0.1 / 1e9 / 1e-6);
}

static void test_point_load(void **unused)
{
    (void)unused;
    /* edges of 0.72 sqrt(R h) and twice that */
    assert_true(dent_of(BALL(16, "") PINCH STATIC) > 1.4);
    assert_true(fabs(dent_of(BALL(16, AUTO) PINCH STATIC) - 1) < 0.03);
    assert_true(fabs(dent_of(BALL(8, AUTO) PINCH STATIC) - 1) < 0.03);
    /* what needs nothing stays as it is */
    run r;
    check_begin(&r, BALL(8, "") STATIC);
    const int32_t field_count = r.scene->output.field_count;
    end(&r);
    check_begin(&r, BALL(8, AUTO) STATIC);
    assert_int_equal(r.scene->model.bodies[0].mesh->triangle_count, 1280);
    assert_int_equal(r.scene->output.field_count, field_count);
    assert_non_null(strstr(r.told.text, "'ball' is not refined"));
    end(&r);
}

/* shortest edge of the body within a distance of a point */
static double shortest(const run *r, double x, double y, double z, double reach)
{
    const pel_mesh *mesh = r->scene->model.bodies[0].mesh;
    double least = (double)HUGE_VAL;
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            const double *a = mesh->positions[mesh->triangles[t][i]],
                         *b = mesh->positions[mesh->triangles[t][(i + 1) % 3]];
            if (hypot(hypot(a[0] - x, a[1] - y), a[2] - z) < reach)
                least = fmin(least, hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]));
        }
    return least;
}

#define MOTION(z) "motion: [ { position: [0, 0, 0.2] }, { time: 1, position: [0, 0, " #z "] } ] } ]\n"

static void test_tools(void **unused)
{
    (void)unused;
    run r;
    check_begin(&r, BALL(6, AUTO) "tools: [ { name: finger, shape: sphere, radius: 0.02, " MOTION(0.118) STATIC);
    assert_true(shortest(&r, 0, 0, 0.1, 0.005) < 0.0011);
    assert_true(shortest(&r, 0, 0, -0.1, 0.05) > 0.01);
    assert_non_null(strstr(r.told.text, "around 1 small loads and tools"));
    end(&r);
    /* one that does not come near */
    check_begin(&r, BALL(6, AUTO) "tools: [ { name: finger, shape: sphere, radius: 0.02, " MOTION(0.15) STATIC);
    assert_int_equal(r.scene->model.bodies[0].mesh->triangle_count, 720);
    end(&r);
}

/* numbers of a file that was welded are still those of the file */
static void test_welded(void **unused)
{
    (void)unused;
    run r;
    FILE *stream = fopen("fine-spots.obj", "wb");
    assert_non_null(stream);
    fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 0\nv 0 -1 0\nf 1 2 3\nf 4 5 6\n", stream);
    fclose(stream);
    check_begin(&r, "version: 1\nbodies:\n  - mesh: { file: fine-spots.obj }\n" SHELL AUTO
                    "    pinned: { vertices: [5] }\nloads: [ { force: [0, 0, 1], at: { vertices: [4] } } ]\n" STATIC);
    unlink("fine-spots.obj");
    const pel_body_def *body = &r.scene->model.bodies[0];
    assert_true(body->mesh->triangle_count > 20 && r.scene->sim.loads[0].vertices[0] == 0 && body->pinned[0] == 3);
    const pel_field *numbers = pel_mesh_field(body->mesh, "file_vertex");
    assert_true(numbers->values[3] == 5 && numbers->values[4] == -1);
    end(&r);
}

static void test_studies(void **unused)
{
    (void)unused;
    run r;
    pel_parameter_place place;
    check_begin(&r, BALL(4, AUTO) PINCH STATIC);
    assert_false(pel_scene_patch_find(r.scene, "loads.finger.force", &place));
    end(&r);
    check_begin(&r, BALL(4, "") PINCH STATIC);
    assert_true(pel_scene_patch_find(r.scene, "loads.finger.force", &place));
    end(&r);
}

static void test_refusals(void **unused)
{
    (void)unused;
    const refusal cases[] = {
        {"version: 1\nbodies: [ { mesh: { shape: geodesic-sphere }, refine: auto } ]\nduration: 1\n", "no membrane"},
        {BALL(4, AUTO "    mass: { per_vertex: 1 }\n") PINCH STATIC, "per vertex"},
        {"version: 1\nbodies:\n  - mesh: { shape: grid }\n" SHELL AUTO
         "cuts: [ { path: [ [0, 0, 0], [0.3, 0, 0] ] } ]\n" STATIC,
         "cuts"},
        {BALL(4, AUTO) PINCH
         "  - { name: rain, force: [0, 0, -1], per: vertex, at: { sphere: { center: [0, 0, 0.1], radius: "
         "0.05 } } }\n" STATIC,
         "'rain' acts on each"},
        {BALL(4, "    refine: everywhere\n") PINCH STATIC, "auto"},
    };
    check_refusals(cases, sizeof cases / sizeof *cases);
}

static pel_status parse_case(const void *unused, pel_error *error)
{
    (void)unused;
    const char *text = BALL(2, AUTO) PINCH STATIC;
    pel_scene *scene;
    pel_status status = pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, error);
    pel_scene_destroy(scene);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    for_every_allocation_failure(parse_case, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_point_load), cmocka_unit_test(test_tools),    cmocka_unit_test(test_welded),
        cmocka_unit_test(test_studies),    cmocka_unit_test(test_refusals), cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
