/* The first triangle that a ray meets. */
#ifndef PEL_BVH_RAY_H
#define PEL_BVH_RAY_H

#include "bvh/tree.h"

typedef struct pel_ray {
    double origin[3], direction[3]; /* of any length but 0, finite */
} pel_ray;

typedef struct pel_ray_hit {
    int32_t triangle;  /* -1 = none */
    double distance;   /* in lengths of the direction, at least 0 */
    double weights[3]; /* of its corners */
} pel_ray_hit;

/* Whether a ray meets a triangle, from either side, and where. Watertight (Woop, Benthin and Wald 2013): a ray through
   a closed surface meets at least one triangle, even through an edge or a vertex. */
bool pel_ray_triangle(const pel_ray *ray, const double a[3], const double b[3], const double c[3], pel_ray_hit *hit);

/* The nearest triangle of a tree whose boxes are fitted to the positions (tree->vertex_count), taken less `center`. Of
   several at the same distance the one with the lowest number. */
pel_ray_hit pel_tree_cast(const pel_tree *tree, const double (*positions)[3], const double center[3],
                          const pel_ray *ray);

#endif
