/* spacemouse [MESH RADIUS]: presses a ball of a radius [m] into a soft body with a SpaceMouse, through libspnav and the
   daemon spacenavd

   A SpaceMouse reports the deflection of its cap and has no motors. The velocity of the ball is proportional to the
   deflection, plus force / damping for the force of the loop. If the deflection is constant, the ball stops where both
   velocities cancel out, so a larger deflection presses deeper. For another device, replace read_device and
   write_device. */
#include <math.h>
#include <pellicle/pellicle.h>
#include <signal.h>
#include <spnav.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { RATE = 1000, STEP_RATE = 100 };
/* value of libspnav at full deflection */
#define FULL 350.0
/* s without an event after which the cap counts as released */
#define SILENCE 0.1

static volatile sig_atomic_t stopped;

static void stop(int number)
{
    (void)number;
    stopped = 1;
}

static void check(pel_status status, const pel_error *error)
{
    char text[800];
    if (status == PEL_OK)
        return;
    fprintf(stderr, "%s\n", pel_error_text(error, text, sizeof text));
    exit(1);
}

/* state of the device in the thread of the loop */
typedef struct device {
    double position[3];   /* m */
    double deflection[3]; /* -1 .. 1, in the axes of the scene */
    double force[3];      /* N, last written */
    double speed;         /* m/s at full deflection */
    double damping;       /* N s/m */
    int quiet;            /* updates since the last event */
} device;

/* converts the axes of the daemon (x right, y up, z towards the user) to those of the scene (z up) */
static bool read_device(void *user, double position[3], double rotation[4])
{
    device *d = user;
    spnav_event event;
    (void)rotation;
    d->quiet++;
    while (spnav_poll_event(&event) != 0)
        if (event.type == SPNAV_EVENT_MOTION) {
            d->deflection[0] = event.motion.x / FULL;
            d->deflection[1] = event.motion.z / FULL;
            d->deflection[2] = event.motion.y / FULL;
            d->quiet = 0;
        }
    for (int i = 0; i < 3; i++) {
        double wanted = d->quiet < SILENCE * RATE ? d->speed * d->deflection[i] : 0;
        d->position[i] += (wanted + d->force[i] / d->damping) / RATE;
        position[i] = d->position[i];
    }
    return true;
}

static void write_device(void *user, const double force[3])
{
    memcpy(((device *)user)->force, force, sizeof((device *)user)->force);
}

int main(int argc, char **argv)
{
    pel_error error;
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
    pel_haptic *haptic;
    if (spnav_open() != 0) {
        fprintf(stderr, "error: spacenavd does not answer. start the daemon and connect the device\n");
        return 1;
    }
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    check(argc > 2 ? pel_mesh_read(argv[1], PEL_FORMAT_AUTO, NULL, &mesh, &error)
                   : pel_shape_create(&shape, &mesh, &error),
          &error);
    pel_body_def body = pel_body_def_default();
    body.name = "body";
    body.mesh = mesh;
    pel_model_def model_def = pel_model_def_default();
    model_def.bodies = &body;
    model_def.body_count = 1;
    check(pel_model_create(&model_def, &model, &error), &error);

    /* the ball starts above the highest vertex */
    const double *top = mesh->positions[0];
    for (int32_t v = 1; v < mesh->vertex_count; v++)
        top = mesh->positions[v][2] > top[2] ? mesh->positions[v] : top;
    const double radius = argc > 2 ? atof(argv[2]) : 0.2;
    const pel_pose_key start = {.position = {top[0], top[1], top[2] + 1.5 * radius}, .rotation = {0, 0, 0, 1}};
    pel_tool_def ball = pel_tool_def_default();
    ball.name = "ball";
    ball.radius = radius;
    ball.keys = &start;
    ball.key_count = 1;
    ball.press = true;
    pel_sim_def sim_def = pel_sim_def_default();
    sim_def.model = model;
    sim_def.tools = &ball;
    sim_def.tool_count = 1;
    sim_def.solver.dt = 1.0 / STEP_RATE;
    check(pel_sim_create(&sim_def, &sim, &error), &error);

    pel_haptic_def def = pel_haptic_def_default();
    def.sim = sim;
    check(pel_haptic_create(&def, &haptic, &error), &error);
    device d = {.speed = radius, .damping = def.device_damping};
    memcpy(d.position, start.position, sizeof d.position);
    const pel_haptic_device functions = {read_device, write_device, &d};
    check(pel_haptic_start(haptic, &functions, &error), &error);
    signal(SIGINT, stop);
    const double begin = pel_seconds();
    for (int64_t step = 1; !stopped; step++) {
        check(pel_haptic_sync(haptic, &error), &error);
        check(pel_sim_step(sim, &error), &error);
        double wait = begin + (double)step / STEP_RATE - pel_seconds();
        if (wait > 0)
            nanosleep(&(struct timespec){(time_t)wait, (long)(1e9 * fmod(wait, 1))}, NULL);
        if (step % (STEP_RATE / 10) == 0) {
            pel_haptic_reading felt;
            pel_haptic_get(haptic, &felt);
            printf("\rball at %6.3f %6.3f %6.3f m, force %6.3f N ", felt.device[0], felt.device[1], felt.device[2],
                   sqrt(felt.force[0] * felt.force[0] + felt.force[1] * felt.force[1] + felt.force[2] * felt.force[2]));
            fflush(stdout);
        }
    }
    printf("\n");
    pel_haptic_destroy(haptic);
    spnav_close();
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}
