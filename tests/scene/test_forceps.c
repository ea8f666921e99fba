/* Forceps: one patch of what is in reach, and a tear that is led around an axis. */
#include "scene_run.h"

#include "math/vec3.h"
#include "pellicle/live.h"
#include "pellicle/tear.h"
#include "stage/stage.h"

/* a disk with a slit from the middle and 60 degrees along a circle, whose flap a sphere leads on */
#define DISK(lead)                                                                                                     \
    "version: 1\n"                                                                                                     \
    "bodies:\n"                                                                                                        \
    "  - mesh: {shape: disk, radius: 0.004, rings: 12}\n"                                                              \
    "    mass: {per_vertex: 1.0e-6}\n"                                                                                 \
    "    springs: {young: 1.5e6, thickness: 13e-6, toughness: 1300}\n"                                                 \
    "    pinned: boundary\n"                                                                                           \
    "cuts:\n"                                                                                                          \
    "  - path: [[0, 0, 0], [0.0025, 0, 0], [0.00235, 0.00086, 0], [0.00192, 0.0016, 0], [0.00125, 0.00217, 0]]\n"      \
    "tools:\n"                                                                                                         \
    "  - {name: forceps, shape: sphere, radius: 0.0003, press: false, grasp: {reach: 1e-5, " lead "}, motion: "        \
    "[{position: [0.0022, 0.001, 0.0004]}]}\n"                                                                         \
    "solver: {method: quasi-static, dt: 0.0005}\n"                                                                     \
    "duration: 100\n"
#define LEAD "lead: {radius: 0.0025, speed: 0.004, regrasp: 0.003}"

static void go(pel_sim *sim, int count)
{
    for (int i = 0; i < count; i++)
        assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
}

/* the tip farthest from the middle, where it is at rest */
static bool find_tip(pel_sim *sim, double rest[3])
{
    pel_tip tips[8];
    int32_t count;
    double best = 0;
    assert_int_equal(pel_sim_tips(sim, 0, tips, 8, &count, NULL), PEL_OK);
    const pel_mesh *mesh = sim->given->bodies[0].mesh;
    for (int32_t t = 0; t < count; t++) {
        const double *x = mesh->positions[tips[t].vertex];
        if (pel_vec3_length(x) > best) {
            best = pel_vec3_length(x);
            pel_vec3_copy(x, rest);
        }
    }
    return best > 0;
}

/* the tear goes on along the circle by a right angle and more, counter-clockwise as its start */
static void test_lead(void **unused)
{
    (void)unused;
    run r;
    double rest[3] = {0};
    int ahead_count = 0;
    check_begin(&r, DISK(LEAD));
    for (int i = 0; i < 40; i++) {
        go(r.sim, 250);
        pel_tool_reading reading;
        pel_sim_get_tool(r.sim, 0, &reading);
        assert_true(reading.contact_count > 0 && reading.contact_count < 30);
        assert_true(find_tip(r.sim, rest));
        assert_near(pel_vec3_length(rest), 0.0025, 0.0001);
        ahead_count += rest[0] * reading.position[1] > rest[1] * reading.position[0];
    }
    /* but for the way from a new grasp on the tool is ahead of the tip */
    assert_true(ahead_count > 20);
    assert_true(atan2(rest[1], rest[0]) > 2.2 || rest[1] < 0);
    end(&r);
}

/* a pose that the caller sets ends the leading, and a snapshot knows of it */
static void test_end(void **unused)
{
    (void)unused;
    static const double place[3] = {0.001, 0.002, 0.001}, none[4] = {0, 0, 0, 1};
    run r;
    pel_tool_reading reading;
    check_begin(&r, DISK(LEAD));
    go(r.sim, 100);
    size_t size = pel_sim_save_size(r.sim);
    void *bytes = malloc(size);
    pel_sim_save(r.sim, bytes);
    go(r.sim, 100);
    uint64_t hash = pel_sim_hash(r.sim);
    assert_int_equal(pel_sim_set_tool_pose(r.sim, 0, place, none, NULL), PEL_OK);
    go(r.sim, 50);
    pel_sim_get_tool(r.sim, 0, &reading);
    assert_near(pel_vec3_distance(reading.position, place), 0, 1e-12);
    assert_int_equal(pel_sim_load(r.sim, bytes, size, NULL), PEL_OK);
    go(r.sim, 100);
    assert_true(pel_sim_hash(r.sim) == hash);
    free(bytes);
    end(&r);
}

/* of two sheets in reach the nearer one */
static void test_patch(void **unused)
{
    (void)unused;
    for (int one = 0; one < 2; one++) {
        char text[2000];
        run r;
        pel_tool_reading reading;
        snprintf(text, sizeof text,
                 "version: 1\n"
                 "bodies:\n"
                 "  - {name: a, mesh: {shape: grid, nx: 4, ny: 4}}\n"
                 "  - {name: b, mesh: {shape: grid, nx: 4, ny: 4, translate: [0, 0, 0.02]}}\n"
                 "tools: [{shape: sphere, radius: 0.3, press: false, grasp: {reach: 0.01, one_patch: %s}, motion: "
                 "[{position: [0, 0, 0.03]}]}]\n"
                 "solver: {method: quasi-static, dt: 0.01}\nduration: 1\n",
                 one ? "true" : "false");
        check_begin(&r, text);
        go(r.sim, 1);
        pel_sim_get_tool(r.sim, 0, &reading);
        assert_int_equal(reading.contact_count, one ? 5 : 10);
        end(&r);
    }
}

static void test_refusals(void **unused)
{
    (void)unused;
    static const refusal cases[] = {
        {DISK("lead: {radius: 0.0025, speed: 0.002, regrasp: 0.001}"), "anew 0.001 m from the tip"},
        {DISK("lead: {radius: 0.0025, speed: 0.002, regrasp: 0.003, axis: [0, 0, 0]}"), "number out of range"},
        {DISK("lead: {speed: 0.002, regrasp: 0.003}"), "radius"},
        {"version: 1\nbodies: [{mesh: {shape: grid}}]\n"
         "tools: [{name: t, shape: sphere, radius: 0.1, press: false, grasp: {reach: 0.1, lead: {radius: 1, speed: 1, "
         "regrasp: 1}}, motion: [{position: [0, 0, 0]}]}]\nduration: 1\n",
         "no body that it acts on can tear"},
    };
    check_refusals(cases, sizeof cases / sizeof *cases);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lead),
        cmocka_unit_test(test_end),
        cmocka_unit_test(test_patch),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
