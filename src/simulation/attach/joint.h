/* Joints of rigid bodies in the substeps of position-based methods. */
#ifndef PEL_ATTACH_JOINT_H
#define PEL_ATTACH_JOINT_H

#include "pellicle/joint.h"
#include "stage/stage.h"
#include "stage/transfer.h"

typedef struct pel_joint {
    char name[PEL_NAME_SIZE];
    pel_joint_def def;    /* its name is not kept */
    pel_rigid *bodies[2]; /* the second may be null: the world */
    double arms[2][3];    /* m, of the point from the pivots at rest; of the world its place */
    double axes[3][3];    /* at rest: that of the joint, and two across it */
    double size;          /* m, of the bodies */
    double begun, start;  /* rad or m, position when the part of a step and the substep began */
    double pace;          /* rad or m, way in a substep as fast as when it began */
    double drive, motor;  /* N s2 or N m s2, of motor and limit in this substep, and that of the motor */
    double target;        /* rad or m, where the motor has led to */
    double present;       /* rad or m, position at the end of the last substep */
    double pushed[6];     /* N s2 and N m s2, of all rows in this substep */
    double sum[7];        /* N and N m, of the substeps of the step: force, torque, load */
    double done;          /* J, of the motor in the step */
    /* what changes while it runs; the rest of this struct goes through snapshots */
    double position, aim, speed, force[3], torque[3], load, work;
} pel_joint;

struct pel_joints {
    pel_joint *items; /* (count) */
    int32_t count;
};

/* Checks the joints of the def; sim->joints stays null without any. After rigid bodies. PEL_BAD_ARGUMENT,
   PEL_OUT_OF_MEMORY. */
pel_status pel_joints_create(pel_sim *sim, const pel_sim_def *def, pel_error *error);
void pel_joints_destroy(pel_sim *sim);

/* Before a part of a step, and before a substep: where they are, without loads. */
void pel_joints_begin(pel_sim *sim);
void pel_joints_begin_substep(pel_sim *sim);
/* A sweep of a substep of this length [s]; returns the largest correction, relative to the size of the bodies. */
double pel_joints_project(pel_sim *sim, double substep);
/* after the sweeps of a substep */
void pel_joints_tally(pel_sim *sim, double substep);
/* After a part that is accepted. */
void pel_joints_end(pel_sim *sim);

/* whether its motor has a speed to reach */
bool pel_joint_is_running(const pel_joint *joint);

/* a pel_transfer_part */
void pel_joints_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);

#endif
