/* A weighted sum of vertices of one or two rigid bodies, as sweeps push it many times in a substep: arms, tensors and
   places are found once, and the bodies turn only where something asks for them (pel_rigid_settle). What a turn of the
   body changes of an arm within a substep is of second order; rows of bodies that turned far are found anew. */
#ifndef PEL_RIGID_ROW_H
#define PEL_RIGID_ROW_H

#include "rigid/sum.h"

/* a side of a row */
typedef struct pel_rigid_side {
    pel_rigid *rigid;                /* null = there is none that moves */
    int32_t far_turns;               /* those of the body at which the row was set */
    double weight, arm[3], lever[3]; /* from the pivot: of its points, and of where pushes act (rigid/sum.c) */
} pel_rigid_side;

struct pel_rigid_row {
    int32_t vertices[PEL_SUM_MOST];
    double weights[PEL_SUM_MOST];
    pel_rigid_side sides[2];
    double place[3];     /* m: the sum, less what the bodies have moved in this substep */
    double start[3];     /* m: the sum at the start of the substep */
    double answer[3][3]; /* 1/kg: the way of the sum by a push on it */
    bool has_ball;       /* it is of a contact of a ball, along: */
    double normal[3];
};

/* The row of a sum at positions, where `start` (vertex_count) is the start of the substep; false = something of it is
   loose, or is of more than two bodies. */
bool pel_rigid_row_set(pel_rigid_row *row, const pel_rigids *rigids, const pel_rigid_sum *sum, const pel_record *start);

/* whether it is that of a sum of these (PEL_SUM_MOST) vertices and weights, along this normal if that is of a ball, and
   no body has turned far since */
static inline bool pel_rigid_row_is_of(const pel_rigid_row *row, const int32_t *vertices, const double *weights,
                                       const double *normal)
{
    bool is_same =
        !row->has_ball || (row->normal[0] == normal[0] && row->normal[1] == normal[1] && row->normal[2] == normal[2]);
    for (int i = 0; i < 2 && row->sides[i].rigid != NULL; i++)
        is_same &= row->sides[i].far_turns == row->sides[i].rigid->far_turns;
    for (int i = 0; i < PEL_SUM_MOST; i++)
        is_same &= row->vertices[i] == vertices[i] && row->weights[i] == weights[i];
    return is_same;
}

/* rows that were set before are none of this round */
void pel_rigid_rows_begin(pel_rigids *rigids);
/* a row to be set; null = there is no memory */
pel_rigid_row *pel_rigid_rows_add(pel_rigids *rigids);
/* m, the sum now */
void pel_rigid_row_place(const pel_rigid_row *row, double place[3]);
/* 1/kg, how the sum moves by 1 N s2 on it along a direction */
double pel_rigid_row_mobility(const pel_rigid_row *row, const double direction[3]);
/* its place follows a push [N s2] on it, as if it acted on the points */
void pel_rigid_row_follow(const pel_rigid_row *row, const double push[3], double place[3]);
/* moves the bodies by a push [N s2] on the sum */
void pel_rigid_row_push(const pel_rigid_row *row, const double push[3], double rate);

#endif
