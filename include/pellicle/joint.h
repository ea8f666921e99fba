/* Pellicle: joints of rigid bodies, to the world or to each other. */
#ifndef PELLICLE_JOINT_H
#define PELLICLE_JOINT_H

#include "base.h"

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum pel_joint_kind {
    PEL_JOINT_BALL,   /* a point of both stays together */
    PEL_JOINT_HINGE,  /* and they turn about the axis alone */
    PEL_JOINT_SLIDER, /* they move along the axis alone and do not turn */
    PEL_JOINT_WELD    /* they move as one */
} pel_joint_kind;

enum { PEL_JOINT_KIND_COUNT = PEL_JOINT_WELD + 1 }; /* number of kinds */

/* A joint of a rigid body. Its position is 0 at rest: the angle [rad] by which a hinge has turned counter-clockwise
   about its axis, or the way [m] of a slider along it, of `body` against the other one. */
typedef struct pel_joint_def {
    const char *name; /* unique among the joints, not empty */
    int32_t body;     /* rigid */
    int32_t to_body;  /* another rigid body; -1 (default) = the world */
    pel_joint_kind kind;
    double point[3];    /* m, at rest */
    double axis[3];     /* of hinges and sliders, of any length but 0; default z */
    double least, most; /* rad or m: limits of the position, which include 0; default: none */
    double speed;       /* rad/s or m/s, that the motor aims at */
    double strength;    /* N m or N, the largest load of the motor; 0 (default) = no motor */
} pel_joint_def;

PEL_API pel_joint_def pel_joint_def_default(void);

typedef struct pel_joint_reading {
    double position, speed;     /* rad or m, rad/s or m/s; 0 of other kinds than hinges and sliders */
    double force[3], torque[3]; /* N and N m on `body`, about the point, the mean of the last step, motor included */
    double load;                /* N m or N, of the motor or the limit along the axis, the mean of the last step */
    double work;                /* J, of the motor since the start */
} pel_joint_reading;

#ifdef __cplusplus
}
#endif
#endif
