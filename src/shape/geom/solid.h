/* Rigid convex solids in their own frame: the shapes of tools. A row holds what the code asks of a shape, so that a new
   one is an enumerator of pel_tool_shape and a row with its functions in solid.c. */
#ifndef PEL_GEOM_SOLID_H
#define PEL_GEOM_SOLID_H

#include "pellicle/tool.h"

/* most corners of a solid with flat faces */
enum { PEL_SOLID_CORNERS = 8 };

typedef struct pel_solid {
    pel_tool_shape shape; /* with a surface of its own: no mesh and no support */
    double radius, half_length;
    double half_extents[3];
    double edge[2][3];
    double closed; /* of scissors, 0 to 1 */
} pel_solid;

typedef struct pel_solid_row {
    const char *word; /* in scenes, commands and messages */
    /* Round: the points within the radius of the segment from -half_length to half_length of the z axis. Otherwise it
       has flat faces, and the members below. */
    bool is_round;
    bool has_radius, has_length, has_size, has_edge; /* the numbers that it reads; with an edge: no inside */
    /* the functions below; null = no solid */
    double (*distance)(const pel_solid *solid, const double p[3], double normal[3]);
    double (*depth)(const pel_solid *solid, const double a[3], const double b[3], const double c[3], double weights[3],
                    double normal[3]);
    void (*half_box)(const pel_solid *solid, double half[3]);
    /* of flat faces */
    double (*separation)(const pel_solid *solid, const double triangle[3][3], double axis[3]);
    double (*corner_room)(const pel_solid *solid, const double triangle[3][3]);
    int32_t corner_count, triangle_count;
    const double (*corners)[3]; /* (corner_count) in units of half_extents */
    const int32_t (*triangles)[3];
} pel_solid_row;

extern const pel_solid_row pel_solid_rows[PEL_TOOL_SHAPE_COUNT];

static inline bool pel_solid_is_round(const pel_solid *solid)
{
    return pel_solid_rows[solid->shape].is_round;
}

/* a blade, a hook or scissors */
static inline bool pel_solid_has_edge(const pel_solid *solid)
{
    return pel_solid_rows[solid->shape].has_edge;
}

static inline bool pel_solid_is_ball(const pel_solid *solid)
{
    return pel_solid_is_round(solid) && solid->half_length == 0;
}

/* The shape of a solid with that word; false, without a change, if there is none. */
bool pel_solid_find(const char *word, pel_tool_shape *shape);

/* The solid of a tool; of a mesh or a support a sphere. */
pel_solid pel_solid_of(const pel_tool_def *def);

/* Signed distance of p, negative inside. normal (3) is the unit direction out of the solid through the nearest face. */
double pel_solid_distance(const pel_solid *solid, const double p[3], double normal[3]);

/* Depth of the triangle in the solid: positive at its deepest point, whose weights (3) are written, along `normal` (3),
   the direction out; 0 or less if it stays out (weights and normal are not written then): of a round solid minus a
   lower bound of the distance. Exact: closest points for round solids; for a box the deepest point by a small linear
   program and the direction by pel_solid_separation. */
double pel_solid_depth(const pel_solid *solid, const double a[3], const double b[3], const double c[3],
                       double weights[3], double normal[3]);

/* The axis (3), out of a solid with flat faces, along which it and a triangle are farthest apart or overlap least: a
   normal of a face, that of the triangle, or one across an edge of each. Where an edge of the solid presses into the
   triangle, no face gives the direction out. Returns the support of the solid: the signed distance of the triangle's
   point p is axis . p minus it. */
double pel_solid_separation(const pel_solid *solid, const double triangle[3][3], double axis[3]);

/* A corner of the triangle is surely as deep in flat faces as any other of its points, also after its corners have
   moved by this much [m]; negative = that is not sure. */
double pel_solid_corner_room(const pel_solid *solid, const double triangle[3][3]);

/* Half sizes of the box about the solid in its own frame. */
void pel_solid_half_box(const pel_solid *solid, double half[3]);
/* How far a tool with this rotation (unit quaternion) reaches from its center along a unit vector: of its mesh, or of
   the box about its solid. */
double pel_tool_def_reach(const pel_tool_def *def, const double rotation[4], const double along[3]);
/* m, the least of these */
double pel_solid_least_half_width(const pel_solid *solid);

/* Sum of these half sizes: a length that no point of the solid is farther from its center than. */
double pel_solid_size(const pel_solid *solid);

/* Corner i of a solid with flat faces. */
void pel_solid_corner(const pel_solid *solid, int32_t i, double corner[3]);

#endif
