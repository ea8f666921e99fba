/* Arrays and lists of vertices in a def, after its mesh has got copies of vertices or lost them. */
#ifndef PEL_DEF_VERTICES_H
#define PEL_DEF_VERTICES_H

#include "def/copy.h"

typedef struct pel_vertex_sources {
    int32_t kept_count;     /* vertices that stay what they are */
    int32_t count;          /* afterwards */
    const int32_t *sources; /* (count) the vertex below kept_count that each one is a copy of, or itself */
} pel_vertex_sources;

/* Values of copies are those of their sources. Lists lose the vertices from kept_count on, and get the copies of their
   members at the end. The def and its nested defs are copies (pel_def_copy); of a body, `origins` is left as it is.
   PEL_OUT_OF_MEMORY. */
pel_status pel_def_follow_vertices(pel_copies *copies, pel_def_kind kind, void *def, const pel_vertex_sources *vertices,
                                   pel_error *error);

/* One such array (null stays null) and one such list with the weights of its members (null = none). */
bool pel_values_follow(pel_copies *copies, const double **values, const pel_vertex_sources *vertices);
bool pel_list_follows(pel_copies *copies, const int32_t **list, int32_t *list_count, const double **weights,
                      const pel_vertex_sources *vertices);

#endif
