/* Growth of tears by toughness: which tips move on in the present state, and to which vertices. */
#ifndef PEL_TEAR_GROWTH_H
#define PEL_TEAR_GROWTH_H

#include "tear/adhesion.h"
#include "tear/material.h"
#include "tear/seam.h"
#include "tear/survey.h"

/* Surveys of the bodies that can tear, made for the present triangles: a step that finds nothing allocates nothing. */
typedef struct pel_tear {
    int32_t survey_count;
    pel_survey *surveys;
    pel_tip *tips; /* (tip_room) of the body at work, the readiest first */
    int32_t tip_room;
    int32_t adhesion_count;
    pel_adhesion *adhesions; /* of the bodies that adhere to their filling */
    int32_t seam_count;
    pel_seams *seams; /* of the bodies that have any */
} pel_tear;

/* sim->tear stays null if no body can tear, adheres or has a seam. PEL_BAD_ARGUMENT, PEL_OUT_OF_MEMORY. */
pel_status pel_tear_create(pel_sim *sim, pel_error *error);
void pel_tear_destroy(pel_sim *sim);

/* What grows in a body. */
typedef struct pel_growth {
    int32_t edge_count; /* edges that open; 0 = nothing grows, and the rest is null */
    uint8_t *marks;     /* (edges of the topology) of them */
    pel_mesh *mesh;     /* with the vertices that have moved in the rest shape */
    uint8_t *is_moved;  /* (vertices) */
    double left_behind; /* share of their ways that these do not follow in space; 0 where nothing is in the way */
    double energy;      /* J, that the edges take */
} pel_growth;

/* Finds the growth of one of the surveys. Free with pel_growth_clear, also on failure. PEL_OUT_OF_MEMORY. */
pel_status pel_growth_find(pel_tear *tear, int32_t survey, pel_growth *growth, pel_error *error);
/* Its vertices move by this share of their ways only; 0 = they stay. */
void pel_growth_shorten(const pel_tear *tear, int32_t survey, pel_growth *growth, double share);
void pel_growth_clear(pel_growth *growth);
/* Marks the vertices of a body that must not move in its rest shape: held ones, those that loads, supports, cuts and
   seams name, and all copies. */
void pel_growth_mark_fixed(const pel_sim *sim, int32_t body, uint8_t *marks);

#endif
