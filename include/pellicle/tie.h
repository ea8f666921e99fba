/* Pellicle: ties, which hold vertices of a body to another body, a tool, a place or a sequence. */
#ifndef PELLICLE_TIE_H
#define PELLICLE_TIE_H

#include "sequence.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum pel_tie_target {
    PEL_TIE_PLACE,    /* where the vertices are when the tie begins */
    PEL_TIE_BODY,     /* the nearest point, by barycentric coordinates, of the triangles of to_body at rest */
    PEL_TIE_VERTICES, /* to_vertices of to_body, one for each vertex */
    PEL_TIE_TOOL,     /* where the vertices are in the frame of tool when the tie begins */
    PEL_TIE_SEQUENCE  /* their rows of sequence */
} pel_tie_target;

enum { PEL_TIE_TARGET_COUNT = PEL_TIE_SEQUENCE + 1 }; /* number of targets */

/* Each vertex is drawn to its point of the target by a thread: the force is stiffness times (distance - length), and 0
   below the length. Both ends have the same force. For the methods implicit, static, xpbd and explicit; the bodies
   do not refine, tear or have cuts. */
typedef struct pel_tie_def {
    const char *name;        /* unique among the ties, not empty */
    int32_t body;            /* whose vertices are tied */
    const int32_t *vertices; /* (vertex_count) of its mesh; copied */
    int32_t vertex_count;
    pel_tie_target target;
    int32_t to_body; /* of PEL_TIE_BODY, which is another body, and PEL_TIE_VERTICES, which may be the same */
    const int32_t *to_vertices;   /* (vertex_count) of its mesh; copied */
    int32_t tool;                 /* of PEL_TIE_TOOL */
    const pel_sequence *sequence; /* of PEL_TIE_SEQUENCE; the simulation keeps a share */
    const double *stiffnesses;    /* (vertex_count) N/m; copied; null = stiffness */
    double stiffness;             /* N/m; 0 (default) = rigid for xpbd, else a hundred times that of a vertex of the
                                     material, for explicit at most a quarter of what its dt allows */
    double from, until;           /* s; default 0, infinity */
    double close; /* s, after which the length is as short as contact allows, linear from the distance at `from`; 0 = at
                     once; below 0 (default) = PEL_TIE_BODY and PEL_TIE_VERTICES keep the distance at `from` */
    double strength; /* N; 0 (default) = no limit. A vertex whose force is larger at the end of a step is let go */
} pel_tie_def;

PEL_API pel_tie_def pel_tie_def_default(void);

typedef struct pel_tie_reading {
    double force[3]; /* N, of the ties on the vertices of the body, the mean of the last step; static: at its end */
    double largest;  /* N, of one vertex */
    double longest;  /* m, the largest distance between a vertex and its point */
    int32_t held_count, lost_count; /* vertices that are tied now; that were let go by force */
    double lost_time;               /* s, of the first one; 0 = none yet */
    double lost_force;              /* N, with which it was let go */
} pel_tie_reading;

#ifdef __cplusplus
}
#endif
#endif
