/* Adhesion of a body to its filling: volumetric springs that leave their vertices once the pull exceeds a strength. */
#ifndef PEL_TEAR_ADHESION_H
#define PEL_TEAR_ADHESION_H

#include "stage/stage.h"

typedef struct pel_adhesion {
    int32_t body, vertex_count;
    double *strengths; /* (vertex_count) N, adhesion times the area around the vertex; infinite once it is released */
    double (*normals)[3]; /* (vertex_count) unit, of the rest shape */
    int32_t *list;        /* (vertex_count) released vertices, those to be released last */
    int32_t released_count;
} pel_adhesion;

static inline bool pel_body_adheres(const pel_sim *sim, int32_t body)
{
    return sim->given->def.bodies[body].adhesion > 0;
}

/* PEL_OUT_OF_MEMORY; pel_adhesion_end also then. */
pel_status pel_adhesion_begin(pel_adhesion *adhesion, const pel_sim *sim, int32_t body, pel_error *error);
void pel_adhesion_end(pel_adhesion *adhesion);
/* Puts the vertices that are pulled too hard at present behind the released ones in the list; returns the number of
   both. A pull towards the inside does not count. */
int32_t pel_adhesion_look(const pel_adhesion *adhesion, const pel_sim *sim);

#endif
