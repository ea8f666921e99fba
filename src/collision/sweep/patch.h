/* Patches of contact of rigid bodies. Where a face lies on another one, every vertex and every crossing of edges is a
   contact: dozens of them, with one normal. Their gaps are linear over the patch, so that those at its border hold all
   others. Sweeps need only these: the farthest contacts in eight directions across the normal, the nearest one, and
   those that carry a load. */
#ifndef PEL_SWEEP_PATCH_H
#define PEL_SWEEP_PATCH_H

#include "sweep/contact.h"

enum { PEL_PATCH_DIRECTIONS = 8 };

/* contacts of two rigid bodies, or of one with obstacles, along one normal */
typedef struct pel_contact_patch {
    int32_t first, second;                           /* rigid bodies, -1 = obstacles; the lower one first */
    double normal[3], across[2][3];                  /* unit, from the first to the second; across it */
    double most[PEL_PATCH_DIRECTIONS], least;        /* m: the farthest way along each direction; the least gap */
    int32_t farthest[PEL_PATCH_DIRECTIONS], nearest; /* the contacts that have these, -1 = there is none yet */
} pel_contact_patch;

/* scratch */
typedef struct pel_contact_patches {
    pel_contact_patch *items;
    int32_t *table, *of; /* (table_size) items by bodies, -1 = none; (active contacts) their items, -1 = none */
    size_t table_size, capacity, table_capacity, of_capacity;
} pel_contact_patches;

/* Makes room for so many contacts of a list; false when out of memory. */
bool pel_contact_patches_expect(pel_contact_patches *patches, const pel_contact_list *list, size_t count);
void pel_contact_patches_clear(pel_contact_patches *patches);
/* Of the active contacts (list->active_count) leaves those that hold all others open; positions (vertex_count). */
void pel_contact_patches_thin(pel_contact_patches *patches, pel_contact_list *list, int32_t *active,
                              const pel_record *positions);

#endif
