/* Search of the triangles that reach into a box, for tools. Each triangle of the surfaces is owned by its last corner
   in the model's order, so that an event of refinement moves only triangles that it changed. Base vertices form blocks
   that are compact at rest, finer ones blocks in the model's order; a block has a box about all triangles of its
   vertices, the union of boxes about the vertices of the few blocks to which these triangles reach. Only triangles of
   blocks near the box are tested: after one pass over the vertices, the time of a search grows with the number of
   triangles near the tool.

   The boxes belong to the positions of the last fit. If these are kept, `drift` bounds the displacements since then, by
   axis: a list of the triangles that reached then into a box contains all triangles that reach now into that box shrunk
   by the drift on all sides, so it serves many steps (near.c). */
#ifndef PEL_TOOL_SEARCH_H
#define PEL_TOOL_SEARCH_H

#include "model/model.h"

/* along the axes of the world */
typedef struct pel_search_box {
    pel_record low, high;
} pel_search_box;

static inline pel_search_box pel_search_triangle(const pel_record *positions, const int32_t corners[3])
{
    pel_record a = positions[corners[0]], b = positions[corners[1]], c = positions[corners[2]];
    return (pel_search_box){pel_record_min(pel_record_min(a, b), c), pel_record_max(pel_record_max(a, b), c)};
}

/* whether a side of one box keeps them apart */
static inline bool pel_search_apart(const pel_search_box *a, const pel_search_box *b)
{
    return pel_record_exceeds(a->low, b->high) || pel_record_exceeds(b->low, a->high);
}

typedef struct pel_search_body {
    int32_t first_place, fine_place;            /* of its base and of its finer vertices */
    int32_t block_begin, block_fine, block_end; /* blocks of its base and of finer vertices that there may be */
} pel_search_body;

/* positions that stay while it is the same */
typedef struct pel_search_state {
    const pel_record *positions;
    int64_t number; /* of the state of the sim */
    int32_t part;   /* of the step */
} pel_search_state;

typedef struct pel_tool_search {
    const pel_model *model;
    pel_search_body *bodies;
    int32_t *member; /* (vertex_count) vertices by block */
    int32_t *block;  /* (vertex_count) of each vertex */
    /* lists of triangles by owner, -1 = end or none */
    int32_t *owner, *next; /* (triangle_count) */
    int32_t *first;        /* (vertex_count) */
    /* blocks */
    pel_search_box *own;   /* (block_count) of their vertices */
    pel_search_box *boxes; /* (block_count) of the triangles of their vertices */
    int32_t *beside;       /* (block_count x BESIDE_LIMIT) other blocks to which the triangles of a block reach */
    uint8_t *beside_count; /* (block_count) BESIDE_LIMIT + 1 = more than that */
    uint8_t *is_stale;     /* (block_count) 1 = the list has to be rebuilt */
    int32_t block_count;
    int32_t *sorted;          /* (triangle_count) scratch */
    uint64_t *set;            /* (triangle_count / 64 + 1) scratch, 0 between searches */
    const pel_record *fitted; /* (vertex_count) m, positions of the last fit: the copy or the caller's */
    pel_record *copy;         /* (vertex_count) */
    pel_search_state state;   /* of these positions where they are not copied; null = not known */
    int64_t fit_count;
    bool is_fitted; /* false = the surface has changed since the last fit */
} pel_tool_search;

/* Triangles near one tool, kept while they serve. */
typedef struct pel_near_list {
    pel_real box[2][4]; /* a pel_search_box: all triangles that reached into it at the fit are listed */
    int64_t fit;        /* number of the fit; 0 = nothing is listed */
    int32_t *triangles; /* (count, room for all) in rising order */
    int32_t count;
} pel_near_list;

/* For the present surfaces of a model that lives as long. Errors: PEL_OUT_OF_MEMORY. */
pel_status pel_tool_search_create(const pel_model *model, pel_tool_search **search, pel_error *error);
void pel_tool_search_destroy(pel_tool_search *search);

/* After the last commit of the body's front; null does nothing. */
void pel_tool_search_update(pel_tool_search *search, int32_t body);
/* After any change of the body's surface; null does nothing. */
void pel_tool_search_rebuild(pel_tool_search *search, int32_t body);

/* Fits all boxes to the positions, and keeps these if wanted; otherwise they have to stay while they are searched. */
void pel_tool_search_fit(pel_tool_search *search, const pel_record *positions, bool keeps);
/* The largest displacement [m] of any vertex along each axis since the fit, which has kept its positions. */
pel_record pel_tool_search_drift(const pel_tool_search *search, const pel_record *positions);

/* Appends the triangles of a body whose own boxes at the fit overlap the box to `triangles` (which has count entries),
   in no particular order; returns the new count. */
int32_t pel_tool_search_find(const pel_tool_search *search, int32_t body, const pel_search_box *box, int32_t *triangles,
                             int32_t count);

/* Puts found triangles in rising order. */
void pel_tool_search_sort(pel_tool_search *search, int32_t *triangles, int32_t count);

#endif
