/* How many steps what moves has in a vibration: of positions and velocities of some vertices over a run. For steps x_i
   of a vibration of the frequency w that keep its energy, the mean of (v dt)^2 over the variance of x is (w dt)^2. Fast
   vibrations that hardly move anything count little. */
#ifndef PEL_RUN_SWING_H
#define PEL_RUN_SWING_H

#include <stdbool.h>
#include <stdint.h>

enum { PEL_SWING_VERTICES = 32 };

/* Sums over the steps; stored in checkpoints unchanged. Zero = none yet. */
typedef struct pel_swing {
    int32_t vertex_count; /* of the simulation */
    bool is_over;         /* something touched, or vertices came or went */
    int64_t step_count;
    double sudden;                      /* rad in a step, of what a load does in the first two; 0 = none acts at once */
    double ways, squares;               /* m^2, of velocities times the step and of displacements */
    double sums[PEL_SWING_VERTICES][3]; /* m, of displacements */
} pel_swing;

struct pel_run_state;

/* after each step */
void pel_swing_add(struct pel_run_state *run);
/* Frequency times step of what moves, in rad; 0 = not known, the motion is resolved or too short. Of a method with
   velocities that nothing damps. */
double pel_swing_angle(const struct pel_run_state *run);

#endif
