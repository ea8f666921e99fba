/* The haptic loop's own arithmetic: from the position of the device to the force on it. No simulation, no thread.

   The proxy p minimises the energy of the coupling (stiffness K, device at x) and of the planes of the local model,

       U(x) = min_p  K/2 |p - x|^2 + sum_i k_i/2 max(0, offset_i - normal_i . p)^2,       F = -grad U = K (p - x).

   U is the Moreau envelope of a convex function: its gradient has the Lipschitz constant K for any planes. Held over a
   period T, the force does the work F . d <= U(x) - U(x + d) + K/2 |d|^2 on the device over a displacement d, and the
   device's damping b dissipates at least b |d|^2 / T. With K T / 2 <= b (Colgate and Schenkel's condition) the observed
   energy E, work less a part of the dissipation, K/2 |d|^2 or more, keeps E + U <= 0 while the planes are fixed. A new
   local model may store more in U than the device has given; then the planes are withdrawn until E + U is within the
   budget again. So E never exceeds the budget, for any motion of simulation and hand. */
#ifndef PEL_HAPTIC_PROXY_H
#define PEL_HAPTIC_PROXY_H

#include "pellicle/haptic.h"

/* most planes that fade out while those of a new model fade in */
enum { PEL_PROXY_OLD = 8, PEL_PROXY_PLANES = PEL_PROXY_OLD + PEL_HAPTIC_PLANES };

/* The loop's knowledge of the surface. */
typedef struct pel_local_model {
    pel_haptic_plane planes[PEL_HAPTIC_PLANES];
    int32_t plane_count;
    int32_t touched_count;   /* the first ones carry the force of the last step, the others are near */
    double tool_position[3]; /* m, where the force of the last step belongs */
    double force[3];         /* N, on the tool in the last step */
    double stiffness;        /* N/m, as learned */
    double reach;            /* m: range of validity about the tool */
} pel_local_model;

typedef struct pel_proxy {
    /* numbers of the def; fixed */
    double period; /* s */
    double coupling_stiffness, coupling_damping;
    double taken;                 /* J/m2, counted as taken by the device's damping */
    double max_force, max_growth; /* N; N in a period */
    double energy_budget;         /* J */
    bool controls;                /* passivity_control */

    /* blended local model: old planes fade out, those of `model` fade in */
    pel_local_model model;
    pel_haptic_plane old[PEL_PROXY_OLD];
    int32_t old_count;
    int64_t arrived_at, blend_count; /* update at which the model came; updates over which it is blended in */
    bool is_engaged;                 /* the device has been near the tool */

    /* last update */
    int64_t update_count;
    bool has_last; /* device, proxy and force of the previous update */
    bool touches;
    double device[3], proxy[3], force[3];

    /* observer */
    double energy, most_energy;
    int64_t limited_count, withdrawn_count, lost_count;
} pel_proxy;

/* def: checked, with all automatic numbers resolved */
void pel_proxy_create(pel_proxy *proxy, const pel_haptic_def *def);

/* A new local model: blended in over the number of updates between the last two models. */
void pel_proxy_set_model(pel_proxy *proxy, const pel_local_model *model);

/* One update: the device is at position. */
void pel_proxy_update(pel_proxy *proxy, const double position[3]);
/* One update without a position: no force. */
void pel_proxy_lose(pel_proxy *proxy);

/* The position that minimises the energy of the coupling and count planes for a device at x; returns whether any plane
   pushes or pulls. */
bool pel_proxy_find(const pel_haptic_plane *planes, int32_t count, double coupling_stiffness, const double x[3],
                    double p[3]);

#endif
