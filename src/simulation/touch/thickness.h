/* The contact thickness of bodies and tools, and the distances at which they start. */
#ifndef PEL_TOUCH_THICKNESS_H
#define PEL_TOUCH_THICKNESS_H

#include "stage/stage.h"
#include "stage/transfer.h"

typedef struct pel_contact_set_def pel_contact_set_def;
typedef struct pel_contact_group pel_contact_group;

/* Why a body has no more of its sheet's thickness; 0 or above: it starts so near to this body (itself: parts of it), or
   body count and a tool. */
enum { PEL_LIMIT_EDGE = -1, PEL_LIMIT_HEIGHT = -2, PEL_LIMIT_FINEST = -3 };

/* The largest default thickness of a body. */
typedef struct pel_thickness_limit {
    double most; /* m */
    int32_t reason, unused;
} pel_thickness_limit;

/* Elements that start nearer to each other than their contact thickness: contact pushes them apart. */
typedef struct pel_start_gap {
    int64_t count;         /* pairs of elements */
    double gap, thickness; /* m, of the pair that lacks most of its thickness */
    int32_t groups[2];     /* its bodies, or body count and the number of a tool */
} pel_start_gap;

/* Times the diagonal of all bodies, for those without a sheet. */
double pel_contact_relative_thickness(const pel_contact_def *def);
/* m, mean of the membrane of a body; 0 = it has none. */
double pel_membrane_thickness(const pel_body_def *def);
/* What the triangles of a mesh leave room for, halved for each level of refinement. */
pel_thickness_limit pel_mesh_thickness_limit(const pel_mesh *mesh, int32_t levels);

/* Limits of all bodies by their meshes, before the set is created. */
void pel_contacts_limit_by_mesh(const pel_sim *sim);
/* Groups of the set (body_count + obstacle_count), and the numbers of its def that follow from them. PEL_BAD_ARGUMENT
   for a given thickness beyond the edges. */
pel_status pel_contacts_set_groups(pel_sim *sim, pel_contact_set_def *def, pel_contact_group *groups, pel_error *error);
/* Limits by the distances at which surfaces start; then all take their thickness. Errors of pel_collider_detect. */
pel_status pel_contacts_limit_by_start(pel_sim *sim, pel_error *error);
/* Part of snapshots. */
void pel_contacts_transfer_limits(pel_cursor *at, const pel_sim *sim, int32_t unused);

/* Looks for them at the present positions, with a search of its own: nothing of the simulation changes. Errors of
   pel_collider_detect. */
pel_status pel_contacts_find_start_gap(pel_sim *sim, pel_start_gap *gap, pel_error *error);
/* "contact thickness 0.001 m of its sheet", or what limits it */
void pel_contacts_describe_thickness(const pel_sim *sim, int32_t body, char *text, size_t size);

#endif
