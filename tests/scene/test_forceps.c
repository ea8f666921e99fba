/* Forceps: one patch of what is in reach, and a tear that is led around an axis. */
#include "scene_run.h"

#include "math/vec3.h"
#include "pellicle/live.h"
#include "pellicle/sim_contact.h"
#include "pellicle/tear.h"
#include "stage/stage.h"
#include "tool/tools.h"

/* a disk with a slit from the middle and 60 degrees along a circle, whose flap a sphere leads on */
#define PATH "[0, 0, 0], [0.0025, 0, 0], [0.00235, 0.00086, 0], [0.00192, 0.0016, 0], [0.00125, 0.00217, 0]"
#define SOLVER "solver: {method: quasi-static, dt: 0.0005}\n"
#define DISK(lead) DISK_OF(PATH, lead, "0.0004", SOLVER)
#define DISK_OF(path, lead, height, solver)                                                                            \
    "version: 1\n"                                                                                                     \
    "bodies:\n"                                                                                                        \
    "  - mesh: {shape: disk, radius: 0.004, rings: 12}\n"                                                              \
    "    mass: {per_vertex: 1.0e-6}\n"                                                                                 \
    "    springs: {young: 1.5e6, thickness: 13e-6, toughness: 1300}\n"                                                 \
    "    pinned: boundary\n"                                                                                           \
    "cuts:\n"                                                                                                          \
    "  - path: [" path "]\n"                                                                                           \
    "tools:\n"                                                                                                         \
    "  - {name: forceps, shape: sphere, radius: 0.0003, press: false, grasp: {reach: 1e-5, " lead "}, motion: "        \
    "[{position: [0.0022, 0.001, " height "]}]}\n" solver "duration: 100\n"
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
    for (int i = 0; i < 45; i++) {
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

/* m, the way of a tool in a step */
static double stride(pel_sim *sim)
{
    pel_tool_reading before, after;
    pel_sim_get_tool(sim, 0, &before);
    go(sim, 1);
    pel_sim_get_tool(sim, 0, &after);
    return pel_vec3_distance(before.position, after.position);
}

/* the flap in contact with itself and the sheet, by steps with momentum: the tear stays on the circle and goes on as
   fast, but for the steps in which the flap does not follow */
static void test_contact(void **unused)
{
    (void)unused;
    run r;
    double rest[3] = {0};
    int64_t count;
    int slow_count = 0;
    check_begin(&r, DISK_OF(PATH, "lead: {radius: 0.0025, speed: 0.005, regrasp: 0.003}", "0.0004",
                            "contact: {self: true, thickness: 13e-6}\n"
                            "solver: {method: quasi-static, momentum: 0.95, dt: 0.001}\n"));
    for (int i = 0; i < 12; i++) {
        for (int k = 0; k < 200; k++)
            slow_count += stride(r.sim) < 0.5 * 0.005 * 0.001;
        assert_int_equal(pel_sim_intersections(r.sim, &count, NULL), PEL_OK);
        assert_int_equal(count, 0);
        assert_true(find_tip(r.sim, rest));
        assert_near(pel_vec3_length(rest), 0.0025, 0.0001);
    }
    assert_true(slow_count > 10 && slow_count < 600);
    assert_true(atan2(rest[1], rest[0]) > 1.4 || rest[1] < 0);
    end(&r);
}

/* forceps that contact has held back go on by their speed: they aim from where they are */
static void test_speed(void **unused)
{
    (void)unused;
    run r;
    check_begin(&r, DISK(LEAD));
    go(r.sim, 500);
    r.sim->tools->items[0].blocked = true;
    assert_near(stride(r.sim), 0.004 * 0.0005, 1e-9);
    end(&r);
}

/* a cut shorter than the distance behind the tip at which forceps grasp: they take the inner lip as far as it goes, and
   do not look for more around the ends of the cut for ever */
static void test_short(void **unused)
{
    (void)unused;
    run r;
    pel_tool_reading reading;
    check_begin(&r,
                DISK_OF("[0.00217, 0.00125, 0], [0.00192, 0.0016, 0], [0.00125, 0.00217, 0]", LEAD, "0.0004", SOLVER));
    go(r.sim, 1);
    pel_tool *tool = &r.sim->tools->items[0];
    assert_int_equal(tool->phase, PEL_GRASP_HOLDING);
    tool->held_count = 0;
    go(r.sim, 1);
    pel_sim_get_tool(r.sim, 0, &reading);
    assert_true(reading.contact_count > 0 && reading.contact_count < 30);
    end(&r);
}

/* m, mean distance from the middle at rest of the triangles around a vertex, less its own */
static double surplus(const pel_mesh *mesh, int32_t vertex)
{
    double sum = 0;
    int count = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        double x[3] = {0};
        if (v[0] != vertex && v[1] != vertex && v[2] != vertex)
            continue;
        for (int c = 0; c < 3; c++)
            pel_vec3_along(x, 1.0 / 3, mesh->positions[v[c]], x);
        sum += pel_vec3_length(x);
        count++;
    }
    return sum / count - pel_vec3_length(mesh->positions[vertex]);
}

/* forceps that have nothing take the inner lip, also where the cut turns outward or inward at its end */
static void test_lip(void **unused)
{
    (void)unused;
    static const char *const texts[] = {
        DISK_OF(PATH ", [0.0012, 0.00245, 0]", LEAD, "0.002", SOLVER),
        DISK_OF(PATH ", [0.00115, 0.0027, 0]", LEAD, "0.002", SOLVER),
        DISK_OF(PATH ", [0.0008, 0.0021, 0]", LEAD, "0.002", SOLVER),
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        run r;
        check_begin(&r, texts[i]);
        go(r.sim, 2);
        const pel_tool *tool = &r.sim->tools->items[0];
        assert_true(tool->held_count > 0);
        const pel_mesh *mesh = r.sim->given->bodies[0].mesh;
        double most = -HUGE_VAL;
        for (int32_t k = 0; k < tool->held_count; k++)
            most = fmax(most, surplus(mesh, r.sim->model->mesh_vertex[tool->held[k]]));
        assert_true(most < 0.00005);
        end(&r);
    }
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
        cmocka_unit_test(test_lead),  cmocka_unit_test(test_contact),  cmocka_unit_test(test_speed),
        cmocka_unit_test(test_short), cmocka_unit_test(test_lip),      cmocka_unit_test(test_end),
        cmocka_unit_test(test_patch), cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
