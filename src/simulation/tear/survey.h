/* A survey of the tips in one body: where they are, and the configurational force on each. */
#ifndef PEL_TEAR_SURVEY_H
#define PEL_TEAR_SURVEY_H

#include "pellicle/tear.h"
#include "pellicle/topology.h"
#include "stage/stage.h"

/* a tip as it was read last */
typedef struct pel_tip_reading {
    int64_t state; /* number of the state + 1; 0 = none */
    pel_tip tip;
} pel_tip_reading;

enum { PEL_TIP_READINGS = 8 };

typedef struct pel_survey {
    pel_sim *sim;
    int32_t body;
    bool has_notches; /* corners of the border that point inward count as tips */
    pel_topology *topology;
    /* (vertices of the mesh) of its tips, in their order, once they are asked for */
    int32_t *tips, tip_count;                   /* -1 = not yet */
    pel_tip_reading readings[PEL_TIP_READINGS]; /* by their vertices */
    /* (vertices of the mesh) */
    double *weights;   /* q of the tip at work; 0 else */
    int32_t *queue;    /* of vertices around it */
    int32_t *rings;    /* of a vertex in the queue, -1 else */
    uint8_t *is_side;  /* on the sides of the cut behind the tip at work */
    double (*sums)[3]; /* N, of the gradients around a vertex in the queue; 0 else */
    double *areas;     /* m2, likewise of the triangles */
    /* (triangles) */
    int32_t *triangles; /* around it */
    uint8_t *is_listed;
    double (*gradients)[3][3], *energies; /* of the listed ones */
    double *stresses;                     /* Pa, largest true stress of a body with a strength; null = without */
    double (*axes)[3];                    /* unit, the direction of that at rest */
} pel_survey;

/* Made for the present triangles. PEL_OUT_OF_MEMORY; pel_survey_end also then. */
pel_status pel_survey_begin(pel_survey *survey, pel_sim *sim, int32_t body, pel_error *error);
void pel_survey_end(pel_survey *survey);

/* The direction (unit, in the rest shape) ahead of a tip; false if the vertex is none. */
bool pel_survey_is_tip(const pel_survey *survey, int32_t vertex, double ahead[3]);
/* Number of the tips, which `tips` of the survey lists: they stay as long as the survey. */
int32_t pel_survey_count_tips(pel_survey *survey);
/* whether a vertex cannot move: pinned, or held by a tool */
bool pel_survey_is_held(const pel_survey *survey, int32_t vertex);
bool pel_vertex_is_held(const pel_sim *sim, int32_t body, int32_t vertex);
/* The tip in the present state (pel_shell_forces_follow has been called for it). */
void pel_survey_read(pel_survey *survey, int32_t vertex, const double ahead[3], pel_tip *tip);
/* change of the force on a tip in a step, over the force, below which its state counts as relaxed */
#define PEL_TIP_RELAXED 0.02
/* That change, of the present triangles; 0 under methods that do not approach rest over many steps. */
double pel_survey_change(pel_survey *survey, const pel_tip *tip);
/* Vertices up to some ring around one, with their rings in `rings`, until pel_survey_leave; returns their number. */
int32_t pel_survey_walk(pel_survey *survey, int32_t vertex, int32_t ring_count);
/* Number of the rings from which the force on a tip comes. */
int32_t pel_survey_rings(pel_survey *survey, int32_t tip);
/* Likewise those that edges lead to within a distance [m] at rest, with the neighbours of each. */
int32_t pel_survey_spread(pel_survey *survey, int32_t vertex, double distance);
void pel_survey_leave(pel_survey *survey, int32_t count);
/* Energy [J] of membrane, fibres and springs in a triangle, whose gradients [N] on the corners are added. */
double pel_survey_triangle(const pel_survey *survey, int32_t t, double gradient[3][3]);

/* the next outgoing half-edge around a vertex, from corner_of_vertex on; -1 after the last */
static inline int32_t pel_survey_turn(const pel_survey *survey, int32_t v, int32_t h)
{
    int32_t next = pel_half_edge_turn(survey->topology, h);
    return next == survey->topology->corner_of_vertex[v] ? -1 : next;
}

/* the half-edge of the border that comes to a vertex of it */
static inline int32_t pel_survey_last(const pel_survey *survey, int32_t v)
{
    int32_t last = survey->topology->corner_of_vertex[v];
    for (int32_t h = last; h >= 0; h = pel_survey_turn(survey, v, h))
        last = h;
    return pel_half_edge_previous(last);
}

#endif
