/* Weighted sums of vertices, of which some belong to rigid bodies: what contacts, attachments and stitches act on. */
#ifndef PEL_RIGID_SUM_H
#define PEL_RIGID_SUM_H

#include "rigid/rigid.h"

enum { PEL_SUM_MOST = 4, PEL_SUM_GRIPS = 4 };

typedef struct pel_rigid_sum {
    const int32_t *vertices;      /* (PEL_SUM_MOST) */
    double weights[PEL_SUM_MOST]; /* 0 where unused */
    pel_rigid_grip grips[PEL_SUM_GRIPS];
    int grip_count;
    double value[3];  /* m, the sum of weights times positions */
    double looseness; /* 1/kg, of the vertices that are loose: inverse masses times squared weights */
    bool has_ball;    /* it is of a contact of a ball, along: */
    double normal[3];
} pel_rigid_sum;

/* whether one of the vertices is of a rigid body */
static inline bool pel_rigid_sum_is_asked(const pel_rigids *rigids, const int32_t *vertices, const double *weights,
                                          int count)
{
    for (int i = 0; rigids != NULL && i < count; i++)
        if (weights[i] != 0 && rigids->of_slice[vertices[i] / PEL_WIDTH] >= 0)
            return true;
    return false;
}

/* at positions (vertex_count) with their inverse masses; vertices have to live on */
void pel_rigid_sum_set(pel_rigid_sum *sum, const pel_rigids *rigids, const int32_t *vertices, const double *weights,
                       int count, const pel_record *positions);
/* The same for a contact along a unit normal: what acts on the middle of a ball acts where the ball touches, a radius
   away along the normal. The value stays that of the middle. */
void pel_rigid_sum_set_contact(pel_rigid_sum *sum, const pel_rigids *rigids, const int32_t *vertices,
                               const double *weights, const double normal[3], const pel_record *positions);
/* Subtracts from the start of a sum what the turns of its balls since then have moved of where they touch now: their
   points there are others than those of the middle. */
void pel_rigid_sum_turn_start(const pel_rigid_sum *sum, const pel_rigids *rigids, double start[3]);
/* how far 1 N s2 along a direction moves the sum that way */
double pel_rigid_sum_mobility(const pel_rigid_sum *sum, const double direction[3]);
/* moves everything by a push [N s2] on the sum */
void pel_rigid_sum_push(const pel_rigid_sum *sum, const pel_rigids *rigids, pel_record *positions,
                        const double push[3]);
/* velocities alone, by an impulse [N s]; positions give the inverse masses */
void pel_rigid_sum_hit(const pel_rigid_sum *sum, const pel_rigids *rigids, const pel_record *positions,
                       pel_record *velocities, const double impulse[3]);
/* m/s */
void pel_rigid_sum_velocity(const pel_rigid_sum *sum, const pel_rigids *rigids, const pel_record *velocities,
                            double velocity[3]);

#endif
