/* The step of a scene that leaves it to the program. */
#ifndef PEL_CHOICE_TIME_STEP_H
#define PEL_CHOICE_TIME_STEP_H

#include "choice/excited.h"
#include "choice/mode_wave.h"
#include "keys/value.h"
#include "pellicle/scene.h"

/* what asks for the shortest step */
typedef struct pel_fastest_motion {
    double dt;        /* s */
    char reason[160]; /* empty = nothing does */
} pel_fastest_motion;

/* of those of a scene */
typedef struct pel_motions {
    double shortest;            /* s; what asks for less is not chosen */
    pel_fastest_motion fastest; /* of all */
    pel_fastest_motion chosen;
} pel_motions;

/* What nothing touches goes on moving to the end of the run: no damping of vertices, and hardly any drag. */
bool pel_scene_is_undamped(const pel_scene *scene);
/* The lowest vibration of a body, see pel_scene_frequency. */
typedef struct pel_vibration {
    double frequency; /* Hz; 0 = none */
    double strain;    /* share of its stiffness that the damping of the body's material meets */
    pel_mode_wave wave;
    pel_excited excited;
} pel_vibration;
pel_status pel_scene_find_vibration(const pel_scene *scene, int32_t body, pel_vibration *vibration);

/* The steps below dt that resolve the vibrations, loads and moving pins of a scene. PEL_OUT_OF_MEMORY. */
pel_status pel_scene_find_motions(const pel_scene *scene, double dt, double shortest, pel_motions *motions);

/* the method of equilibria, which has analyses */
pel_method pel_scene_static_method(void);

/* Sets dt of the method explicit to a stable one, and refuses scenes that take more than ten minutes so. Sets dt of the
   method implicit, in the def and in the tree, with a line to the log, where motion goes on that steps
   of the default would not resolve: no tools that stay, no damping, hardly any drag, and a shorter vibration or load.
   Only in scenes that give no dt and count no steps. Before that, dt of methods with velocities and a material is at
   most the time between frames. PEL_OUT_OF_MEMORY, PEL_BAD_SCENE. */
pel_status pel_scene_choose_dt(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene);

#endif
