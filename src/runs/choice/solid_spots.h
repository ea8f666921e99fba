/* `refine: auto` of bodies filled with tetrahedra. */
#ifndef PEL_CHOICE_SOLID_SPOTS_H
#define PEL_CHOICE_SOLID_SPOTS_H

#include "pellicle/scene.h"

/* Replaces the mesh of a filled body by one with shorter tetrahedra where tools press it, with a line to the log;
   `surface` is the mesh that was filled, null for a file of tetrahedra. PEL_OUT_OF_MEMORY. */
pel_status pel_scene_refine_solid(const pel_scene *scene, int32_t body, const pel_mesh *surface, pel_mesh **mesh,
                                  const pel_log *log, pel_error *error);

#endif
