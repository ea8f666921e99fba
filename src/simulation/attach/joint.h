/* Joints of rigid bodies: in the substeps of position-based methods, and as rows of Newton's method. */
#ifndef PEL_ATTACH_JOINT_H
#define PEL_ATTACH_JOINT_H

#include "newton/newton.h"
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
    pel_newton_row *rows; /* (row_count) of Newton's method */
    int32_t row_count;
    /* what changes while it runs; the rest of this struct goes through snapshots */
    double position, aim, speed, force[3], torque[3], load, work;
} pel_joint;

struct pel_joints {
    pel_joint *items; /* (count) */
    int32_t count;
    pel_newton_row *rows; /* (PEL_JOINT_ROWS count) joint by joint (joint_rows.c) */
    double (*speeds)[3];  /* (PEL_JOINT_ROWS count) scratch (joint_speed.c) */
};

/* rows of a joint: three of the point, two of the axis, motor and both limits; or two, three, and these */
enum { PEL_JOINT_ROWS = 8 };

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

/* A vector of one of its bodies at rest as it is now; the point of one of them; the position, of whose whole turns
   joint->present decides. */
void pel_joint_turn(const pel_joint *joint, int side, const double local[3], double turned[3]);
void pel_joint_point(const pel_joint *joint, int side, double point[3]);
double pel_joint_position(const pel_joint *joint);
/* whether it has an axis, which a motor and limits act along */
bool pel_joint_is_driven(const pel_joint *joint);

/* Newton's method, after pel_joints_begin. Rows with the loads of the last step, whose stiffness is that of the inertia
   at a rate squared [1/s2], much enlarged; rigids gets them. */
void pel_joints_set_rows(pel_sim *sim, double squared_rate, pel_newton_rigids *rigids);
/* After a run: the loads go to those that it ended with. Returns the largest error, relative to the size of the bodies.
 */
double pel_joints_renew_rows(pel_sim *sim);
/* N m on the first body beside the levers, by a load of one on a row */
void pel_joint_couple(const pel_newton_row *row, double couple[3]);
/* After a stage: velocities across the rows end by impulses along them (joint_speed.c). */
void pel_joints_keep_speeds(pel_sim *sim);
/* Likewise of the velocities at the start, before the first step. */
void pel_joints_start_speeds(pel_sim *sim);
/* loads, position and work of the step from the rows */
void pel_joints_take_rows(pel_sim *sim);

/* whether a joint of a body has met a limit in this step */
bool pel_joints_met(const pel_sim *sim, int32_t body);
/* the point at rest of the first joint of a body, false without any */
bool pel_joints_find_point(const pel_sim *sim, const pel_rigid *body, double point[3]);
/* whether any joint has a motor or limits */
bool pel_joints_drive(const pel_sim *sim);
/* whether a joint holds a body, to the world or to another one */
bool pel_joints_hold(const pel_sim *sim, int32_t body);

/* whether its motor has a speed to reach */
bool pel_joint_is_running(const pel_joint *joint);

/* a pel_transfer_part */
void pel_joints_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);

#endif
