/* haptic recorded | damper | thread SECONDS: force feedback from a simulation of a soft ball that runs at 100 Hz

   - recorded: A fingertip presses into the ball and slides, with a recorded hand motion. Compares the force of the loop
     with that of a simulation at 1000 Hz.
   - damper: A constant force pushes a simulated device with mass and damping against the ball. Shows whether the device
     comes to rest, and how much energy the loop generates.
   - thread SECONDS: Runs the loop in its own thread for SECONDS of wall time. Shows the latency of its updates.

   The first two measure time in updates, so they print the same on every machine. */
#include <math.h>
#include <pellicle/pellicle.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* m, radii of the ball and the fingertip; Hz, rates of the loop's updates and the simulation's steps */
#define BALL 0.05
#define TIP 0.008
/* Pa, Young's moduli of tissue and of a hard material */
#define SOFT 5e3
#define HARD 5e6
enum { RATE = 1000, STEP_RATE = 100 };

static void check(pel_status status, const pel_error *error)
{
    char text[800];
    if (status == PEL_OK)
        return;
    fprintf(stderr, "%s\n", pel_error_text(error, text, sizeof text));
    exit(1);
}

/* ---- the simulation ---- */

typedef struct stage {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
} stage;

/* a ball of 10 cm diameter, filled with tissue of the Young's modulus `young` [Pa], and a fingertip above it */
static stage make_stage(double young, int rate)
{
    pel_error error;
    stage s;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    check(pel_shape_set_number(&shape, "frequency", 12, &error), &error);
    check(pel_shape_set_number(&shape, "radius", BALL, &error), &error);
    check(pel_shape_create(&shape, &s.mesh, &error), &error);

    pel_body_def body = pel_body_def_default();
    body.name = "ball";
    body.mesh = s.mesh;
    /* the mass of the filling, and springs by Young's modulus */
    body.mass_kind = PEL_MASS_DENSITY;
    body.mass = 1000;
    body.thickness.value = BALL / 3;
    body.spring_stiffness.value = body.volumetric_stiffness.value = young;
    body.spring_thickness = 0.1 * BALL;
    body.volumetric_depth = BALL;
    body.spring_damping.value = body.volumetric_damping.value = 10;
    pel_model_def model_def = pel_model_def_default();
    model_def.bodies = &body;
    model_def.body_count = 1;
    check(pel_model_create(&model_def, &s.model, &error), &error);

    const pel_pose_key above = {.position = {0, 0, BALL + 1.5 * TIP}, .rotation = {0, 0, 0, 1}};
    pel_tool_def tip = pel_tool_def_default();
    tip.name = "fingertip";
    tip.radius = TIP;
    tip.keys = &above;
    tip.key_count = 1;
    tip.press = true;
    pel_sim_def def = pel_sim_def_default();
    def.model = s.model;
    def.tools = &tip;
    def.tool_count = 1;
    def.solver.method = PEL_METHOD_XPBD;
    def.solver.dt = 1.0 / rate;
    /* the loop compares two rates: both sweep twice, so that the step of the slower one is solved as well */
    def.solver.iterations = 2;
    check(pel_sim_create(&def, &s.sim, &error), &error);
    return s;
}

static void end_stage(stage *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
}

/* ---- a recorded hand motion ---- */

/* positions of a fingertip over time: s, and m above and beside the top of the ball, in intervals of 0.2 s */
static const double recording[][3] = {
    {0.0, 0.0115, 0.0000},  {0.2, 0.0109, 0.0000},  {0.4, 0.0087, 0.0001},  {0.6, 0.0062, 0.0001},
    {0.8, 0.0044, 0.0002},  {1.0, 0.0029, 0.0002},  {1.2, 0.0011, 0.0003},  {1.4, -0.0003, 0.0003},
    {1.6, -0.0010, 0.0004}, {1.8, -0.0012, 0.0004}, {2.0, -0.0013, 0.0007}, {2.2, -0.0012, 0.0013},
    {2.4, -0.0013, 0.0020}, {2.6, -0.0011, 0.0026}, {2.8, -0.0006, 0.0030}, {3.0, 0.0010, 0.0031},
    {3.2, 0.0034, 0.0031},  {3.4, 0.0063, 0.0030},  {3.6, 0.0095, 0.0030},  {3.8, 0.0115, 0.0030}};
enum { SAMPLES = sizeof recording / sizeof *recording };

/* interpolates the samples by Catmull-Rom splines, which have a continuous velocity */
static void hand_at(double time, double position[3])
{
    int k = (int)(time / 0.2);
    k = k < SAMPLES - 2 ? k : SAMPLES - 2;
    const double *p0 = recording[k > 0 ? k - 1 : 0], *p1 = recording[k], *p2 = recording[k + 1];
    const double *p3 = recording[k + 2 < SAMPLES ? k + 2 : SAMPLES - 1];
    double s = fmin((time - p1[0]) / 0.2, 1), x[2];
    for (int i = 1; i <= 2; i++)
        x[i - 1] =
            p1[i] + 0.5 * s *
                        (p2[i] - p0[i] +
                         s * (2 * p0[i] - 5 * p1[i] + 4 * p2[i] - p3[i] + s * (3 * (p1[i] - p2[i]) + p3[i] - p0[i])));
    position[0] = x[1];
    position[1] = 0;
    position[2] = BALL + x[0];
}

static double length(const double a[3])
{
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* Plays the recorded motion with a simulation at 100 Hz. For comparison, a second simulation steps at the rate of the
   loop with its tool at the proxy: its force is the one that a fast enough simulation would give. */
static int play_recording(void)
{
    pel_error error;
    stage s = make_stage(SOFT, STEP_RATE), fast = make_stage(SOFT, RATE);
    pel_haptic_def def = pel_haptic_def_default();
    def.sim = s.sim;
    pel_haptic *haptic;
    pel_haptic_reading reading;
    check(pel_haptic_create(&def, &haptic, &error), &error);
    double largest = 0, worst = 0, sum = 0, force[3] = {0, 0, 0};
    const double upright[4] = {0, 0, 0, 1};
    int count = 0;
    for (int update = 0; update < 4 * RATE; update++) {
        double hand[3];
        pel_tool_reading felt;
        if (update % (RATE / STEP_RATE) == 0) {
            check(pel_haptic_sync(haptic, &error), &error);
            check(pel_sim_step(s.sim, &error), &error);
        }
        hand_at(update / (double)RATE, hand);
        check(pel_haptic_update(haptic, hand, NULL, force, &error), &error);
        pel_haptic_get(haptic, &reading);
        check(pel_sim_set_tool_pose(fast.sim, 0, reading.proxy, upright, &error), &error);
        check(pel_sim_step(fast.sim, &error), &error);
        pel_sim_get_tool(fast.sim, 0, &felt);
        double difference[3] = {force[0] - felt.force[0], force[1] - felt.force[1], force[2] - felt.force[2]};
        largest = fmax(largest, length(felt.force));
        worst = fmax(worst, length(difference));
        if (length(felt.force) > 0) {
            sum += length(difference) * length(difference);
            count++;
        }
        if (update % 200 == 199)
            printf("%.1f s: fingertip %6.2f mm, force of the loop %6.3f N, of a simulation at %d Hz %6.3f N\n",
                   pel_sim_time(fast.sim), 1000 * (felt.position[2] - BALL - TIP), force[2], RATE, felt.force[2]);
    }
    printf("largest force %.3f N; error relative to it: root mean square %.2f %%, largest %.2f %%\n", largest,
           100 * sqrt(sum / fmax(count, 1)) / largest, 100 * worst / largest);
    printf("stiffness of the surface %.0f N/m, of the coupling %.0f N/m; energy generated by the loop %.1e J\n",
           reading.stiffness, reading.coupling_stiffness, reading.most_energy);
    pel_haptic_destroy(haptic);
    end_stage(&fast);
    end_stage(&s);
    return 0;
}

/* ---- a simulated device with mass and damping ---- */

static void push_device(double stiffness, bool control)
{
    pel_error error;
    stage s = make_stage(HARD, STEP_RATE);
    pel_haptic_def def = pel_haptic_def_default();
    def.sim = s.sim;
    def.coupling_stiffness = stiffness;
    def.passivity_control = control;
    pel_haptic *haptic;
    pel_status status = pel_haptic_create(&def, &haptic, &error);
    if (status == PEL_UNSTABLE) {
        char text[800];
        printf("%6.0f N/m: %s\n", stiffness, pel_error_text(&error, text, sizeof text));
        end_stage(&s);
        return;
    }
    check(status, &error);
    /* 80 g, pressed down by 0.3 N; ten integration steps in an update */
    const double mass = 0.08, push = -0.3, h = 1.0 / (10 * RATE);
    double z = BALL + 1.4 * TIP, v = 0, force[3] = {0, 0, 0}, last_speed = 0;
    for (int update = 0; update < 4 * RATE; update++) {
        if (update % (RATE / STEP_RATE) == 0) {
            check(pel_haptic_sync(haptic, &error), &error);
            check(pel_sim_step(s.sim, &error), &error);
        }
        check(pel_haptic_update(haptic, (const double[3]){0, 0, z}, NULL, force, &error), &error);
        for (int n = 0; n < 10; n++) {
            v += h * (push + force[2] - def.device_damping * v) / mass;
            z += h * v;
        }
        if (update >= 3 * RATE)
            last_speed = fmax(last_speed, fabs(v));
    }
    pel_haptic_reading reading;
    pel_haptic_get(haptic, &reading);
    printf(
        "%6.0f N/m, control %-3s: force %.3f N, largest speed in the last second %.2g mm/s, energy generated %.1e J\n",
        reading.coupling_stiffness, control ? "on" : "off", force[2], 1000 * last_speed, reading.most_energy);
    pel_haptic_destroy(haptic);
    end_stage(&s);
}

static int push_devices(void)
{
    pel_haptic_def def = pel_haptic_def_default();
    double most = pel_haptic_passive_stiffness(def.device_damping, 0, def.rate);
    printf("device of 80 g and %.1f N s/m: passive up to %.0f N/m\n", def.device_damping, most);
    for (double share = 0.25; share < 3; share *= 2) {
        push_device(share * most, false);
        if (share <= 1)
            push_device(share * most, true);
    }
    return 0;
}

/* ---- the thread ---- */

/* a device that repeats the recorded motion in real time and stores the largest force */
typedef struct player {
    double start, largest;
} player;

static bool read_hand(void *user, double position[3], double rotation[4])
{
    (void)rotation;
    hand_at(fmod(pel_seconds() - ((player *)user)->start, 3.8), position);
    return true;
}

static void write_force(void *user, const double force[3])
{
    player *p = user;
    p->largest = fmax(p->largest, length(force));
}

static int run_thread(double seconds)
{
    pel_error error;
    stage s = make_stage(SOFT, STEP_RATE);
    pel_haptic_def def = pel_haptic_def_default();
    def.sim = s.sim;
    pel_haptic *haptic;
    check(pel_haptic_create(&def, &haptic, &error), &error);
    player hand = {.start = pel_seconds()};
    const pel_haptic_device device = {read_hand, write_force, &hand};
    check(pel_haptic_start(haptic, &device, &error), &error);
    for (int64_t step = 0; pel_seconds() - hand.start < seconds; step++) {
        check(pel_haptic_sync(haptic, &error), &error);
        check(pel_sim_step(s.sim, &error), &error);
        /* wait for the real time of the next step */
        double wait = (double)(step + 1) / STEP_RATE - (pel_seconds() - hand.start);
        if (wait > 0)
            nanosleep(&(struct timespec){(time_t)wait, (long)(1e9 * fmod(wait, 1))}, NULL);
    }
    pel_haptic_stop(haptic);
    pel_haptic_reading reading;
    pel_haptic_get(haptic, &reading);
    const pel_haptic_latency *late = &reading.latency;
    printf("%lld updates, %lld skipped, %s priority; largest force %.3f N\n", (long long)late->count,
           (long long)late->missed_count, late->is_real_time ? "real-time" : "normal", hand.largest);
    printf("latency: median %.0f us, 99 %% %.0f us, 99.9 %% %.0f us, largest %.0f us; longest update %.0f us\n",
           1e6 * pel_haptic_latency_quantile(late, 0.5), 1e6 * pel_haptic_latency_quantile(late, 0.99),
           1e6 * pel_haptic_latency_quantile(late, 0.999), 1e6 * late->most, 1e6 * late->most_update);
    pel_haptic_destroy(haptic);
    end_stage(&s);
    return 0;
}

int main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "recorded") == 0)
        return play_recording();
    if (argc == 2 && strcmp(argv[1], "damper") == 0)
        return push_devices();
    if (argc == 3 && strcmp(argv[1], "thread") == 0 && atof(argv[2]) > 0)
        return run_thread(atof(argv[2]));
    fprintf(stderr, "usage: haptic recorded | damper | thread SECONDS\n");
    return 2;
}
