/* Regions of a scene: which vertices of a body a load or a pin means. */
#ifndef PEL_SCENE_REGION_H
#define PEL_SCENE_REGION_H

#include "keys/value.h"

#include "pellicle/mesh.h"

/* Vertices in the arena of the reader. */
typedef struct pel_scene_region {
    int32_t count;
    int32_t *vertices; /* (count) rising; null = all vertices of the mesh */
    double *weights;   /* (count) 0 to 1; null = 1 */
} pel_scene_region;

/* Finds the vertices of a checked region; PEL_BAD_SCENE at its place if there are none. */
pel_status pel_scene_region_find(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                                 pel_scene_region *region);

#endif
