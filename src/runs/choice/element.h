/* The elements of filled bodies, where a scene leaves them to the program. */
#ifndef PEL_CHOICE_ELEMENT_H
#define PEL_CHOICE_ELEMENT_H

#include "keys/value.h"
#include "pellicle/scene.h"

/* above it linear tetrahedra lock */
#define PEL_LOCKING_POISSON 0.45

typedef struct pel_solid_shape {
    double edge;              /* m, mean of the longest edge of each tetrahedron */
    double thickness, length; /* m */
} pel_solid_shape;

pel_solid_shape pel_solid_shape_of(const pel_mesh *filled);

/* Share by which linear tetrahedra make it too stiff in bending; 0 of bodies that are not slender. */
double pel_solid_bending_error(const pel_solid_shape *shape);

/* The same of bodies that are not slender, where they are sheared or bent, at most; 0 of slender ones. */
double pel_solid_shear_error(const pel_solid_shape *shape);

/* Whether volumetric springs carry the weight of a pinned body that a solid of their modulus would not carry without a
   large sag. */
bool pel_scene_is_carried(const pel_scene *scene, const pel_model *model, int32_t body);

/* Smooth elements, in the def and in the tree, with a line to the log, for bodies that bend or lock, where a scene
   gives no `element` and a step stays cheap; not under a given method that takes linear ones only. */
void pel_scene_choose_elements(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene);

#endif
