/* The loop with a simulation: forces against a simulation that steps at the loop's own rate, energy, learning, grasps,
   the thread. */
#include "failing_malloc.h"
#include "haptic/idle_device.h"
#include "haptic/local_model.h"
#include "haptic/proxy.h"
#include "math/vec3.h"
#include "pellicle/haptic.h"
#include "pellicle/live.h"
#include "pellicle/shape.h"
#include "sim/fixture.h"
#include "tool/tool.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <time.h>

/* m, of ball and tip; Hz of the loop, and updates in a step of the simulation */
#define BALL 0.05
#define TIP 0.008
enum { RATE = 1000, UPDATES = 10 };

static const double upright[4] = {0, 0, 0, 1};

/* a ball filled with tissue of 5 kPa, described by Young's moduli */
static pel_body_def tissue_body(const pel_mesh *mesh)
{
    pel_body_def body = ball_body(mesh);
    body.mass_kind = PEL_MASS_DENSITY;
    body.mass = 1000;
    body.thickness.value = BALL / 3;
    body.spring_stiffness.value = body.volumetric_stiffness.value = 5000;
    body.spring_thickness = 0.1 * BALL;
    body.volumetric_depth = BALL;
    body.spring_damping.value = body.volumetric_damping.value = 10;
    return body;
}

static stage make_tissue_of(pel_method method, double dt, const pel_tool_def *tool)
{
    stage s;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    shape.frequency = 8;
    shape.radius = BALL;
    assert_int_equal(pel_shape_create(&shape, &s.mesh, NULL), PEL_OK);
    pel_body_def body = tissue_body(s.mesh);
    s.model = make_model(&body);
    pel_sim_def def = lone_sim(s.model, method, dt);
    def.tools = tool;
    def.tool_count = 1;
    def.contact.enabled = tool->shape == PEL_TOOL_MESH;
    s.sim = make_sim(&def);
    return s;
}

static stage make_tissue(double dt, const pel_tool_def *tool)
{
    return make_tissue_of(PEL_METHOD_XPBD, dt, tool);
}

static pel_tool_def make_tip(const pel_pose_key *key)
{
    pel_tool_def tip = pel_tool_def_default();
    tip.name = "tip";
    tip.radius = TIP;
    tip.keys = key;
    tip.key_count = 1;
    tip.press = true;
    return tip;
}

static stage make_press(double dt)
{
    const pel_pose_key above = {.position = {0, 0, BALL + 1.3 * TIP}, .rotation = {0, 0, 0, 1}};
    const pel_tool_def tip = make_tip(&above);
    return make_tissue(dt, &tip);
}

static pel_haptic *make_haptic(const pel_haptic_def *def)
{
    pel_haptic *haptic;
    pel_error error;
    char text[800];
    pel_status status = pel_haptic_create(def, &haptic, &error);
    if (status != PEL_OK)
        print_error("%s\n", pel_error_text(&error, text, sizeof text));
    assert_int_equal(status, PEL_OK);
    return haptic;
}

/* before an update: every so often a step of the simulation */
static void step_between(pel_haptic *haptic, pel_sim *sim, int update)
{
    if (update % UPDATES != 0)
        return;
    assert_int_equal(pel_haptic_sync(haptic, NULL), PEL_OK);
    run_steps(sim, 1);
}

static double length(const double a[3])
{
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* height of the hand over the ball [m]: down in 1 s, aside, up in the third; smooth */
static void slow_hand(double time, double position[3])
{
    double down = 0.5 - 0.5 * cos(acos(-1) * fmin(time, 1)),
           up = 0.5 - 0.5 * cos(acos(-1) * fmin(fmax(time - 2, 0), 1));
    position[0] = 0.004 * fmin(fmax(time - 1, 0), 1);
    position[1] = 0;
    position[2] = BALL + 1.3 * TIP - 1.2 * TIP * (down - up);
}

/* Against a simulation at the rate of the loop, whose tool is at the proxy: below 3 % of the largest force. Both are
   means over a step of the slow simulation: in the fast one the first touch of a vertex is the impact of its mass. */
static void test_force_error(void **unused)
{
    (void)unused;
    skip_if_slow();
    stage s = make_press(0.01), fast = make_press(0.001);
    pel_haptic_def def = pel_haptic_def_default();
    def.sim = s.sim;
    pel_haptic *haptic = make_haptic(&def);
    pel_haptic_reading reading;
    double largest = 0, worst = 0, sum[3] = {0}, difference[3] = {0};
    for (int update = 0; update < 3200; update++) {
        double hand[3], force[3];
        pel_tool_reading felt;
        step_between(haptic, s.sim, update);
        slow_hand(update / (double)RATE, hand);
        assert_int_equal(pel_haptic_update(haptic, hand, NULL, force, NULL), PEL_OK);
        pel_haptic_get(haptic, &reading);
        assert_int_equal(pel_sim_set_tool_pose(fast.sim, 0, reading.proxy, upright, NULL), PEL_OK);
        run_steps(fast.sim, 1);
        pel_sim_get_tool(fast.sim, 0, &felt);
        for (int i = 0; i < 3; i++) {
            sum[i] += felt.force[i] / UPDATES;
            difference[i] += (force[i] - felt.force[i]) / UPDATES;
        }
        if (update % UPDATES == UPDATES - 1) {
            largest = fmax(largest, length(sum));
            worst = fmax(worst, length(difference));
            memset(sum, 0, sizeof sum);
            memset(difference, 0, sizeof difference);
        }
    }
    print_message("largest force %.3f N, largest error %.2f %% of it\n", largest, 100 * worst / largest);
    assert_true(largest > 0.15);
    assert_true(worst < 0.03 * largest);
    /* the device is free again, and got nothing */
    assert_false(reading.touches);
    assert_true(reading.most_energy <= def.energy_budget && reading.limited_count == 0);
    assert_true(reading.plane_count == 1 && reading.planes[0].normal[2] > 0.9);
    pel_haptic_destroy(haptic);
    end_stage(&fast);
    end_stage(&s);
}

/* J and N after a mass of 80 g was pushed into the ball for 3 s */
static pel_haptic_reading push(double coupling, double *force_end)
{
    stage s = make_press(0.01);
    pel_haptic_def def = pel_haptic_def_default();
    def.sim = s.sim;
    def.coupling_stiffness = coupling;
    pel_haptic *haptic = make_haptic(&def);
    double z = BALL + 1.2 * TIP, v = -0.1, force[3];
    for (int update = 0; update < 3000; update++) {
        step_between(haptic, s.sim, update);
        assert_int_equal(pel_haptic_update(haptic, (const double[3]){0, 0, z}, NULL, force, NULL), PEL_OK);
        for (int n = 0; n < 10; n++) {
            v += 1e-4 * (force[2] - 0.2 - def.device_damping * v) / 0.08;
            z += 1e-4 * v;
        }
    }
    pel_haptic_reading reading;
    pel_haptic_get(haptic, &reading);
    *force_end = force[2];
    pel_haptic_destroy(haptic);
    end_stage(&s);
    return reading;
}

static void test_contact_comes_to_rest(void **unused)
{
    (void)unused;
    for (double coupling = 250; coupling <= 1000; coupling *= 2) {
        double force;
        pel_haptic_reading reading = push(coupling, &force);
        assert_near(reading.coupling_stiffness, coupling, 0);
        assert_near(force, 0.2, 0.002);
        assert_true(reading.touches && reading.energy < 0);
        assert_true(reading.most_energy <= 2e-5);
    }
}

/* the same syncs and updates give the same bits, and take no memory */
static void test_deterministic_without_memory(void **unused)
{
    (void)unused;
    pel_haptic_reading ends[2];
    uint64_t hashes[2];
    for (int run = 0; run < 2; run++) {
        stage s = make_press(0.01);
        pel_haptic_def def = pel_haptic_def_default();
        def.sim = s.sim;
        pel_haptic *haptic = make_haptic(&def);
        for (int update = 0; update < 800; update++) {
            double hand[3], force[3];
            step_between(haptic, s.sim, update);
            slow_hand(update / (double)RATE, hand);
            failing_malloc_begin(0);
            assert_int_equal(pel_haptic_update(haptic, hand, NULL, force, NULL), PEL_OK);
            assert_int_equal(pel_haptic_sync(haptic, NULL), PEL_OK);
            assert_int_equal(failing_malloc_end().calls, 0);
        }
        memset(&ends[run], 0, sizeof ends[run]);
        pel_haptic_get(haptic, &ends[run]);
        hashes[run] = pel_sim_hash(s.sim);
        pel_haptic_destroy(haptic);
        end_stage(&s);
    }
    assert_true(ends[0].touches && length(ends[0].force) > 0);
    assert_memory_equal(ends[0].force, ends[1].force, sizeof ends[0].force);
    assert_true(hashes[0] == hashes[1]);
}

/* in front of a box that lies between two walls, planes of both walls are there before it touches either */
static void test_planes_of_a_groove(void **unused)
{
    (void)unused;
    /* two sheets like an open book, 90 degrees, and a ball in the fold that touches neither */
    pel_mesh *mesh;
    static const double positions[6][3] = {{0, -0.05, 0},      {0, 0.05, 0},         {0.05, -0.05, 0.05},
                                           {0.05, 0.05, 0.05}, {-0.05, -0.05, 0.05}, {-0.05, 0.05, 0.05}};
    static const int32_t triangles[4][3] = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}};
    assert_int_equal(pel_mesh_create(positions[0], 6, triangles[0], 4, &mesh, NULL), PEL_OK);
    pel_body_def body = ball_body(mesh);
    pel_model *model = make_model(&body);
    const pel_pose_key key = {.position = {0, 0, 0.02}, .rotation = {0, 0, 0, 1}};
    pel_tool_def tip = make_tip(&key);
    tip.radius = 0.012;
    pel_sim_def def = lone_sim(model, PEL_METHOD_QUASI_STATIC, 0.01);
    def.tools = &tip;
    def.tool_count = 1;
    pel_sim *sim = make_sim(&def);
    pel_haptic_def haptic_def = pel_haptic_def_default();
    haptic_def.sim = sim;
    pel_haptic *haptic = make_haptic(&haptic_def);
    double force[3];
    pel_haptic_reading reading;
    assert_int_equal(pel_haptic_sync(haptic, NULL), PEL_OK);
    assert_int_equal(pel_haptic_update(haptic, key.position, NULL, force, NULL), PEL_OK);
    pel_haptic_get(haptic, &reading);
    assert_int_equal(reading.plane_count, 2);
    for (int i = 0; i < 2; i++) {
        /* 0.02 / sqrt 2 from the walls, less the radius */
        double gap = reading.planes[i].normal[2] * key.position[2] - reading.planes[i].offset;
        assert_near(fabs(reading.planes[i].normal[0]), sqrt(0.5), 1e-6);
        assert_near(reading.planes[i].normal[2], sqrt(0.5), 1e-6);
        assert_near(gap, 0.02 * sqrt(0.5) - 0.012, 1e-6);
    }
    pel_haptic_destroy(haptic);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* in an open box with four walls and a floor only four planes fit: that of the farthest wall goes */
static void test_planes_of_a_box(void **unused)
{
    (void)unused;
    static const double half = 0.0145;
    static const int32_t triangles[10][3] = {{4, 0, 3}, {4, 3, 7}, {5, 1, 0}, {5, 0, 4}, {6, 2, 1},
                                             {6, 1, 5}, {7, 3, 2}, {7, 2, 6}, {0, 1, 2}, {0, 2, 3}};
    double positions[8][3];
    for (int v = 0; v < 8; v++)
        pel_vec3_set(positions[v], v % 4 == 0 || v % 4 == 3 ? -half : half, v % 4 < 2 ? -half : half, v < 4 ? 0 : 0.04);
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions[0], 8, triangles[0], 10, &mesh, NULL), PEL_OK);
    pel_body_def body = ball_body(mesh);
    pel_model *model = make_model(&body);
    const pel_pose_key key = {.position = {0.001, 0.0005, half}, .rotation = {0, 0, 0, 1}};
    pel_tool_def tip = make_tip(&key);
    tip.radius = 0.012;
    pel_sim_def def = lone_sim(model, PEL_METHOD_QUASI_STATIC, 0.01);
    def.tools = &tip;
    def.tool_count = 1;
    pel_sim *sim = make_sim(&def);
    pel_haptic_def haptic_def = pel_haptic_def_default();
    haptic_def.sim = sim;
    pel_haptic *haptic = make_haptic(&haptic_def);
    double force[3], sum[3] = {0, 0, 0};
    pel_haptic_reading reading;
    assert_int_equal(pel_haptic_sync(haptic, NULL), PEL_OK);
    assert_int_equal(pel_haptic_update(haptic, key.position, NULL, force, NULL), PEL_OK);
    pel_haptic_get(haptic, &reading);
    assert_int_equal(reading.plane_count, 4);
    /* gaps of 1.5 mm at +x, 2 and 3 mm at both y, 2.5 mm at the floor; not 3.5 mm at -x */
    for (int i = 0; i < 4; i++) {
        const pel_haptic_plane *plane = &reading.planes[i];
        assert_near(pel_vec3_dot(plane->normal, key.position) - plane->offset, 0.0015 + 0.0005 * i, 1e-9);
        pel_vec3_add(sum, plane->normal, sum);
    }
    assert_near(sum[0], -1, 1e-9);
    assert_near(sum[1], 0, 1e-9);
    assert_near(sum[2], 1, 1e-9);
    pel_haptic_destroy(haptic);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* If other contacts cancel the forces on all touched vertices, such as those of a second tool behind a sheet, one plane
   through the tool has its force. */
static void test_force_without_vertices(void **unused)
{
    (void)unused;
    static const double force[3] = {3, 0, 4};
    stage s = make_press(0.01);
    run_steps(s.sim, 1);
    assert_int_equal(s.sim->tools->items[0].touch_count, 0);
    pel_vec3_copy(force, s.sim->tools->items[0].force);
    pel_local_model model;
    pel_surface_estimate estimate = {.stiffness = 1000, .least = 1000, .most = 1000};
    pel_local_model_take(s.sim, 0, TIP, NULL, &estimate, &model);
    assert_int_equal(model.touched_count, 1);
    const pel_haptic_plane *plane = &model.planes[0];
    double depth = plane->offset - pel_vec3_dot(plane->normal, model.tool_position);
    for (int i = 0; i < 3; i++)
        assert_near(plane->stiffness * depth * plane->normal[i], force[i], 1e-9);
    end_stage(&s);
}

/* The force that is known acts where the tool was: in the middle of its way in the step, at its end where there are no
   velocities. Half a step beside it the hand would feel a wall of another depth. */
static void test_place_of_the_force(void **unused)
{
    (void)unused;
    const pel_pose_key keys[2] = {{.position = {0, 0, BALL + 3 * TIP}, .rotation = {0, 0, 0, 1}},
                                  {.time = 1, .position = {0, 0, BALL + 2 * TIP}, .rotation = {0, 0, 0, 1}}};
    static const pel_method methods[2] = {PEL_METHOD_XPBD, PEL_METHOD_QUASI_STATIC};
    for (int m = 0; m < 2; m++) {
        pel_tool_def tip = make_tip(keys);
        tip.key_count = 2;
        stage s = make_tissue_of(methods[m], 0.1, &tip);
        run_steps(s.sim, 3);
        pel_local_model model;
        pel_surface_estimate estimate = {.stiffness = 1000, .least = 1000, .most = 1000};
        pel_local_model_take(s.sim, 0, TIP, NULL, &estimate, &model);
        assert_near(model.tool_position[2], BALL + 3 * TIP - (m == 0 ? 0.25 : 0.3) * TIP, 1e-9);
        end_stage(&s);
    }
}

/* under a tool given as a mesh one plane carries all of its force */
static void test_mesh_tool(void **unused)
{
    (void)unused;
    pel_mesh *mesh;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    shape.frequency = 3;
    shape.radius = TIP;
    assert_int_equal(pel_shape_create(&shape, &mesh, NULL), PEL_OK);
    const pel_pose_key above = {.position = {0, 0, BALL + 1.3 * TIP}, .rotation = {0, 0, 0, 1}};
    pel_tool_def tip = make_tip(&above);
    tip.shape = PEL_TOOL_MESH;
    tip.mesh = mesh;
    stage s = make_tissue(0.01, &tip);
    pel_haptic_def def = pel_haptic_def_default();
    def.sim = s.sim;
    pel_haptic *haptic = make_haptic(&def);
    double force[3];
    pel_tool_reading felt;
    pel_haptic_reading reading;
    for (int update = 0; update < 1000; update++) {
        const double hand[3] = {0, 0, BALL + TIP * (1.3 - 0.6 * fmin(update / 500.0, 1))};
        step_between(haptic, s.sim, update);
        assert_int_equal(pel_haptic_update(haptic, hand, NULL, force, NULL), PEL_OK);
    }
    assert_int_equal(pel_haptic_sync(haptic, NULL), PEL_OK);
    const double rest[3] = {0, 0, BALL + 0.7 * TIP};
    assert_int_equal(pel_haptic_update(haptic, rest, NULL, force, NULL), PEL_OK);
    pel_sim_get_tool(s.sim, 0, &felt);
    pel_haptic_get(haptic, &reading);
    assert_true(reading.touches && felt.force[2] > 0.005);
    assert_int_equal(reading.plane_count, 1);
    for (int k = 0; k < 3; k++)
        assert_near(reading.planes[0].normal[k] * length(felt.force), felt.force[k], 1e-12);
    assert_near(force[2], felt.force[2], 0.05 * felt.force[2]);
    pel_haptic_destroy(haptic);
    end_stage(&s);
    pel_mesh_destroy(mesh);
}

/* a grasp pulls: lifted, the hand feels the ball hold back */
static void test_grasp_pulls(void **unused)
{
    (void)unused;
    const pel_pose_key on_top = {.position = {0, 0, BALL}, .rotation = {0, 0, 0, 1}};
    pel_tool_def tip = make_tip(&on_top);
    tip.press = false;
    tip.grasp = true;
    tip.grasp_until = 1e9;
    stage s = make_tissue(0.01, &tip);
    pel_haptic_def def = pel_haptic_def_default();
    def.sim = s.sim;
    pel_haptic *haptic = make_haptic(&def);
    double force[3];
    pel_tool_reading felt;
    for (int update = 0; update < 2000; update++) {
        const double hand[3] = {0, 0, BALL + 0.005 * fmin(update / 1000.0, 1)};
        step_between(haptic, s.sim, update);
        assert_int_equal(pel_haptic_update(haptic, hand, NULL, force, NULL), PEL_OK);
    }
    pel_sim_get_tool(s.sim, 0, &felt);
    assert_true(felt.held_count > 0 && force[2] < -0.02);
    assert_near(force[2], felt.force[2], 0.03 * fabs(felt.force[2]));
    pel_haptic_destroy(haptic);
    end_stage(&s);
}

/* orientation goes to the tool; a lost device leaves no force */
static void test_rotation_and_loss(void **unused)
{
    (void)unused;
    stage s = make_press(0.01);
    pel_haptic_def def = pel_haptic_def_default();
    def.sim = s.sim;
    pel_haptic *haptic = make_haptic(&def);
    const double hand[3] = {0, 0, BALL + 1.2 * TIP}, turned[4] = {0, 0, sin(0.3), cos(0.3)};
    double force[3];
    pel_tool_reading tool;
    pel_haptic_reading reading;
    assert_int_equal(pel_haptic_sync(haptic, NULL), PEL_OK);
    run_steps(s.sim, 1);
    pel_sim_get_tool(s.sim, 0, &tool);
    assert_near(tool.position[2], BALL + 1.3 * TIP, 1e-12);
    assert_int_equal(pel_haptic_update(haptic, hand, turned, force, NULL), PEL_OK);
    assert_int_equal(pel_haptic_sync(haptic, NULL), PEL_OK);
    run_steps(s.sim, 1);
    pel_sim_get_tool(s.sim, 0, &tool);
    assert_near(tool.position[2], hand[2], 1e-12);
    assert_near(tool.rotation[2], turned[2], 1e-12);
    assert_int_equal(pel_haptic_update(haptic, (const double[3]){0, 0, (double)NAN}, NULL, force, NULL),
                     PEL_BAD_ARGUMENT);
    assert_true(length(force) == 0);
    pel_haptic_get(haptic, &reading);
    assert_int_equal(reading.lost_count, 1);
    /* far away the tool follows by its reach in a step */
    const double far[3] = {0, 0, BALL + 1.2 * TIP + 0.1};
    assert_int_equal(pel_haptic_update(haptic, far, NULL, force, NULL), PEL_OK);
    assert_int_equal(pel_haptic_sync(haptic, NULL), PEL_OK);
    run_steps(s.sim, 1);
    pel_sim_get_tool(s.sim, 0, &tool);
    assert_near(tool.position[2], hand[2] + 0.5 * TIP, 1e-9);
    pel_haptic_destroy(haptic);
    end_stage(&s);
}

static void test_tool_was_removed(void **unused)
{
    (void)unused;
    stage s = make_press(0.01);
    pel_haptic_def def = pel_haptic_def_default();
    def.sim = s.sim;
    pel_haptic *haptic = make_haptic(&def);
    pel_error error;
    assert_int_equal(pel_sim_remove_tool(s.sim, 0, NULL), PEL_OK);
    assert_int_equal(pel_haptic_sync(haptic, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "tip"));
    pel_haptic_destroy(haptic);
    end_stage(&s);
}

/* ---- the thread ---- */

typedef struct hand {
    atomic_int reads, writes, losses;
    double largest; /* N, of the loop's thread alone, until it has ended */
    double last[3];
} hand;

static bool read_hand(void *user, double position[3], double rotation[4])
{
    hand *h = user;
    int n = atomic_fetch_add(&h->reads, 1);
    (void)rotation;
    slow_hand(1.2 * (n % 1000) / 1000.0, position);
    /* lost for a moment */
    if (n % 1000 != 999)
        return true;
    atomic_fetch_add(&h->losses, 1);
    return false;
}

static void write_hand(void *user, const double force[3])
{
    hand *h = user;
    atomic_fetch_add(&h->writes, 1);
    h->largest = fmax(h->largest, length(force));
    memcpy(h->last, force, sizeof h->last);
}

/* the policy of the thread that reads the device, -1 before */
static bool read_policy(void *user, double position[3], double rotation[4])
{
    (void)position;
    (void)rotation;
    struct sched_param unused;
    int policy = -1;
    pthread_getschedparam(pthread_self(), &policy, &unused);
    atomic_store((atomic_int *)user, policy);
    return false;
}

/* the loop says whether it runs above the usual threads */
static void test_priority(void **unused)
{
    (void)unused;
    stage s = make_press(0.01);
    pel_haptic_def def = pel_haptic_def_default();
    def.sim = s.sim;
    pel_haptic *haptic = make_haptic(&def);
    atomic_int policy = -1;
    const pel_haptic_device device = {read_policy, write_nothing, &policy};
    assert_int_equal(pel_haptic_start(haptic, &device, NULL), PEL_OK);
    while (atomic_load(&policy) < 0)
        nanosleep(&(struct timespec){0, 1000000}, NULL);
    pel_haptic_stop(haptic);
    pel_haptic_reading reading;
    pel_haptic_get(haptic, &reading);
    assert_int_equal(reading.latency.is_real_time, atomic_load(&policy) == SCHED_FIFO);
    pel_haptic_destroy(haptic);
    end_stage(&s);
}

/* two threads: under the thread sanitizer this tests their shared data */
static void test_thread(void **unused)
{
    (void)unused;
    stage s = make_press(0.01);
    pel_haptic_def def = pel_haptic_def_default();
    def.sim = s.sim;
    pel_haptic *haptic = make_haptic(&def);
    hand h = {.largest = 0};
    const pel_haptic_device device = {read_hand, write_hand, &h};
    double force[3];
    assert_int_equal(pel_haptic_start(haptic, &device, NULL), PEL_OK);
    assert_int_equal(pel_haptic_start(haptic, &device, NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_haptic_update(haptic, upright, NULL, force, NULL), PEL_BAD_ARGUMENT);
    pel_haptic_reading reading;
    for (int step = 0; step < 10000 && atomic_load(&h.losses) == 0; step++) {
        assert_int_equal(pel_haptic_sync(haptic, NULL), PEL_OK);
        run_steps(s.sim, 1);
        pel_haptic_get(haptic, &reading);
        nanosleep(&(struct timespec){0, 5000000}, NULL);
    }
    pel_haptic_stop(haptic);
    pel_haptic_stop(haptic);
    pel_haptic_get(haptic, &reading);
    const pel_haptic_latency *late = &reading.latency;
    print_message("%d updates, late by %.0f us (median), %.0f us (99.9 %%), %.0f us at most, %d left out\n",
                  (int)late->count, 1e6 * pel_haptic_latency_quantile(late, 0.5),
                  1e6 * pel_haptic_latency_quantile(late, 0.999), 1e6 * late->most, (int)late->missed_count);
    assert_true(h.largest > 0.05 && length(h.last) == 0);
    assert_int_equal(late->count, atomic_load(&h.reads));
    assert_int_equal(reading.update_count, late->count);
    assert_int_equal(atomic_load(&h.writes), late->count + 1);
    int64_t sum = 0;
    for (int i = 0; i < PEL_HAPTIC_LATENCY_BINS; i++)
        sum += late->bins[i];
    assert_int_equal(sum, late->count);
    assert_true(reading.lost_count >= 1);
    /* it can be started again, and is stopped by destroying it */
    assert_int_equal(pel_haptic_start(haptic, &device, NULL), PEL_OK);
    pel_haptic_destroy(haptic);
    end_stage(&s);
}

/* ---- memory ---- */

static pel_status create_haptic(const void *data, pel_error *error)
{
    pel_haptic *haptic;
    pel_status status = pel_haptic_create(data, &haptic, error);
    assert_true((haptic == NULL) == (status != PEL_OK));
    pel_haptic_destroy(haptic);
    return status;
}

static pel_status start_haptic(const void *data, pel_error *error)
{
    pel_haptic *haptic;
    const pel_haptic_device device = {read_nothing, write_nothing, NULL};
    pel_status status = pel_haptic_create(data, &haptic, error);
    if (status == PEL_OK)
        status = pel_haptic_start(haptic, &device, error);
    pel_haptic_destroy(haptic);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    stage s = make_press(0.01);
    pel_haptic_def def = pel_haptic_def_default();
    def.sim = s.sim;
    assert_true(for_every_allocation_failure(create_haptic, &def) >= 1);
    assert_true(for_every_allocation_failure(start_haptic, &def) >= 2);
    end_stage(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_mesh_tool),
                                       cmocka_unit_test(test_planes_of_a_box),
                                       cmocka_unit_test(test_force_without_vertices),
                                       cmocka_unit_test(test_place_of_the_force),
                                       cmocka_unit_test(test_priority),
                                       cmocka_unit_test(test_force_error),
                                       cmocka_unit_test(test_contact_comes_to_rest),
                                       cmocka_unit_test(test_deterministic_without_memory),
                                       cmocka_unit_test(test_planes_of_a_groove),
                                       cmocka_unit_test(test_grasp_pulls),
                                       cmocka_unit_test(test_rotation_and_loss),
                                       cmocka_unit_test(test_tool_was_removed),
                                       cmocka_unit_test(test_thread),
                                       cmocka_unit_test(test_out_of_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
