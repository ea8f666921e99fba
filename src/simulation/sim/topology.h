/* The triangles of bodies that were cut, in snapshots: for each body the origins of its copies of vertices, and the
   corners that have one. With the mesh before all cuts, which these numbers lead back to, they say the whole surface.
   Of bodies that do not refine, the rest positions too, which tears and blades move; of bodies that adhere to their
   filling, the vertices that have left it. */
#ifndef PEL_SIM_TOPOLOGY_H
#define PEL_SIM_TOPOLOGY_H

#include "stage/transfer.h"

/* a pel_transfer_part; when it loads, the present surface must be that of the snapshot */
void pel_topology_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);
/* another one: what is known of tears */
pel_transfer_part pel_tear_transfer;
/* Whether the part at this place is of the present surface; goes past it if so. */
bool pel_topology_is_present(pel_cursor *at, const pel_sim *sim);

/* A vertex that has moved over the surface: where it was, as a mean of the corners of a triangle and of its own place.
 */
typedef struct pel_vertex_move {
    int32_t vertex, corners[3]; /* of the mesh before */
    double weights[3], own;
} pel_vertex_move;

/* Surfaces of bodies for a change. */
typedef struct pel_surfaces {
    int32_t body_count, cuts_done;
    bool is_tear;             /* edges open by themselves, and no cut is made */
    pel_mesh **meshes;        /* (body_count) null = as it is */
    int32_t **origins;        /* (body_count) of the vertices of these meshes */
    int32_t **sources;        /* (body_count) the vertex of the present mesh that each one is like */
    int32_t *kept_counts;     /* (body_count) vertices of the present mesh that keep their number */
    pel_vertex_move **moves;  /* (body_count) of vertices that are elsewhere in the rest shape; null = none */
    int32_t *move_counts;     /* (body_count) */
    int32_t **released;       /* (body_count) vertices that have left their volumetric springs; null = as they are */
    int32_t *released_counts; /* (body_count) */
} pel_surfaces;

pel_status pel_surfaces_begin(const pel_sim *sim, pel_surfaces *surfaces, pel_error *error);
void pel_surfaces_end(pel_surfaces *surfaces);
/* Those of a snapshot, from its part. PEL_BAD_FORMAT if it is damaged. */
pel_status pel_surfaces_read(pel_surfaces *surfaces, const pel_sim *sim, pel_cursor *at, pel_error *error);
/* The mesh of a body with other triangles; vertices beyond the present ones are copies of their sources. `rest` has the
   rest positions of the present vertices; null = as they are. */
pel_status pel_surfaces_set(pel_surfaces *surfaces, const pel_sim *sim, int32_t body, int32_t vertex_count,
                            const int32_t (*triangles)[3], const double (*rest)[3], pel_error *error);
#endif
