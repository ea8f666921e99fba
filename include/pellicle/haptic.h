/* Pellicle: force feedback. A loop at 1 kHz renders the force of a tool to a haptic device beside a simulation that
   runs at any rate.

       pel_haptic_def def = pel_haptic_def_default();
       def.sim = sim;                                  // tool 0 follows the device
       pel_haptic_create(&def, &haptic, &error);
       pel_haptic_start(haptic, &device, &error);      // the loop, in a thread of its own
       while (running) {
           pel_haptic_sync(haptic, &error);            // between two steps
           pel_sim_step(sim, &error);
       }
       pel_haptic_destroy(haptic);

   Each sync takes a local model of the surface at the tool from the last step: planes with an offset and a stiffness,
   so that at the tool's pose they give the force of the simulation (multirate rendering: Cavusoglu and Tendick, ICRA
   2000). Each update of the loop places a proxy of the tool on these planes (god-object: Zilles and Salisbury, IROS
   1995; proxy: Ruspini, Kolarov and Khatib, SIGGRAPH 1997) where a virtual coupling, a spring between proxy and device,
   balances them. The force of the coupling goes to the device, and the tool of the simulation follows the proxy. From
   one model to the next the planes are blended over the time between the last two syncs.

   docs/haptics.md has the equations, the limits of passivity and how devices are attached. Forces only: the orientation
   of the device is handed to the tool, torques are not rendered.

   Threads: the thread that steps the simulation calls everything but pel_haptic_update, which may be called by another
   one. Both sides exchange data without locks, so that the loop never waits for the simulation. */
#ifndef PELLICLE_HAPTIC_H
#define PELLICLE_HAPTIC_H

#include "sim.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pel_haptic pel_haptic;

/* A loop, its coupling and its limits. */
typedef struct pel_haptic_def {
    pel_sim *sim;          /* lives longer than the loop */
    int32_t tool;          /* that follows the device: a sphere, capsule, box or mesh */
    double rate;           /* Hz, of updates; 100 .. 10000; default: 1000 */
    double reach;          /* m: triangles this near to the tool become planes before it touches them, and the tool
                              moves at most so far in a step; 0, the default = half of the tool's mean
                              half width */
    double device_damping; /* N s/m > 0, of the device and the hand on it; default: 0.5, a light grasp of a stylus */
    double coupling_stiffness; /* N/m; 0, the default = half of pel_haptic_passive_stiffness */
    double coupling_damping;   /* N s/m >= 0, of the coupling while it presses; default: 0 */
    double surface_stiffness;  /* N/m, assumed of a surface until the simulation has shown its own; 0, the default = a
                                  hundredth of the coupling's */
    bool passivity_control; /* keeps the energy that the loop gives within energy_budget: planes are withdrawn where a
                               new local model would store more. Default: true. false for tissue that moves by
                               itself and is to push the hand */
    double energy_budget;   /* J >= 0; default: 2e-5 */
    double max_force;       /* N > 0; default: 4 */
    double max_force_rate;  /* N/s > 0, how fast the force may grow; it falls at once; default: 4000 */
    uint32_t cookie;
} pel_haptic_def;

PEL_API pel_haptic_def pel_haptic_def_default(void);

/* N/m, the largest stiffness of the coupling at which the loop can give no energy to a device of this damping [N s/m]:
   2 (b - B) / T with the period T = 1 / rate [Hz] (Colgate and Schenkel, J. Robotic Systems 1997: b > K T / 2 +
   B for a wall of spring K and damper B behind a zero-order hold; a coupling in series with anything passive is softer:
   Adams and Hannaford, IEEE Trans. Robotics and Automation 1999). 0 where B >= b. */
PEL_API double pel_haptic_passive_stiffness(double device_damping, double coupling_damping, double rate);

/* Errors: PEL_BAD_ARGUMENT for a def out of range, a tool that does not exist or has no surface; PEL_UNSTABLE with the
   limit where the coupling is stiffer than pel_haptic_passive_stiffness; PEL_OUT_OF_MEMORY. Destroy before the
   simulation. */
PEL_API pel_status pel_haptic_create(const pel_haptic_def *def, pel_haptic **haptic, pel_error *error);
/* Stops the loop first. Null is fine. */
PEL_API void pel_haptic_destroy(pel_haptic *haptic);

/* Between two steps of the simulation: takes the local model from the last step, once for each step, and lets the tool
   follow the proxy, at most by the reach. Until the first update the tool stays on its keys. Allocates nothing.
   PEL_BAD_ARGUMENT where the tool was removed meanwhile. */
PEL_API pel_status pel_haptic_sync(pel_haptic *haptic, pel_error *error);

/* One update without a thread: the pose of the device, in the coordinates of the simulation, gives the force on it (3)
   [N], to be held until the next update one period later. rotation: unit quaternion x, y, z, w; null = as before.
   Deterministic: the same syncs and updates give the same bits. A position that is not finite gives PEL_BAD_ARGUMENT
   and no force; so does a call while the loop runs. */
PEL_API pel_status pel_haptic_update(pel_haptic *haptic, const double position[3], const double rotation[4],
                                     double force[3], pel_error *error);

/* Where the loop reads poses and writes forces; both are called in its thread and must not block. */
typedef struct pel_haptic_device {
    /* Fills the pose, in the coordinates of the simulation; rotation holds the last one. False: the device is lost, and
       the force is 0 until it is back. */
    bool (*read)(void *user, double position[3], double rotation[4]);
    void (*write)(void *user, const double force[3]); /* N */
    void *user;                                       /* nullable */
} pel_haptic_device;

/* Starts the loop in a thread of its own, with real-time priority where the system grants it (the user needs the right
   for SCHED_FIFO). The device lives until the loop is stopped. PEL_BAD_ARGUMENT for a device without both functions and
   where the loop runs already; PEL_OUT_OF_MEMORY where no thread can be had. */
PEL_API pel_status pel_haptic_start(pel_haptic *haptic, const pel_haptic_device *device, pel_error *error);
/* Ends the loop after a last write of no force; does nothing where none runs. */
PEL_API void pel_haptic_stop(pel_haptic *haptic);

/* A half space of the local model, for the position of the tool: it gives the force stiffness (offset - normal . x)
   along the normal to a tool at x, while that is above 0. */
typedef struct pel_haptic_plane {
    double normal[3];  /* unit, out of the surface */
    double offset;     /* m */
    double stiffness;  /* N/m */
    bool is_two_sided; /* of a grasp: it pulls as well */
} pel_haptic_plane;

enum { PEL_HAPTIC_PLANES = 4, PEL_HAPTIC_LATENCY_BINS = 101 };

/* How late the thread began its updates. */
typedef struct pel_haptic_latency {
    int64_t bins[PEL_HAPTIC_LATENCY_BINS]; /* updates that began 10 i .. 10 (i + 1) microseconds late; the last one: all
                                              that were later */
    int64_t count;                         /* updates */
    int64_t missed_count;                  /* updates left out, because one before was late by a period or more */
    double most;                           /* s, the latest */
    double most_update;                    /* s, longest update, reading and writing the device included */
    bool is_real_time;                     /* the thread has real-time priority */
} pel_haptic_latency;

/* s: the share (0 .. 1) of updates that began no later than this, to the upper end of the bin; `most` in the last bin;
   0 without updates. */
PEL_API double pel_haptic_latency_quantile(const pel_haptic_latency *latency, double share);

/* The loop after its last update. */
typedef struct pel_haptic_reading {
    int64_t update_count;
    double device[3], proxy[3]; /* m */
    double force[3];            /* N, on the device */
    double stiffness;           /* N/m, of the surface as learned from the simulation */
    double coupling_stiffness;  /* N/m, in use */
    bool touches;               /* a plane pushes */
    /* passivity observer (Hannaford and Ryu, IEEE Trans. Robotics and Automation 2002): work of the force on the
       device, less what device_damping takes, in contact; below 0 while a surface is pressed in */
    double energy;           /* J */
    double most_energy;      /* J, largest so far; at most energy_budget under passivity_control */
    int64_t withdrawn_count; /* updates in which planes were withdrawn by passivity_control */
    int64_t limited_count;   /* updates in which a limit of the force acted */
    int64_t lost_count;      /* updates without a finite position */
    int32_t plane_count;     /* of the newest local model */
    pel_haptic_plane planes[PEL_HAPTIC_PLANES];
    pel_haptic_latency latency; /* zero without a thread */
} pel_haptic_reading;

PEL_API void pel_haptic_get(pel_haptic *haptic, pel_haptic_reading *reading);

#ifdef __cplusplus
}
#endif
#endif
