/* Pellicle: rigid instruments with a motion in time. */
#ifndef PELLICLE_TOOL_H
#define PELLICLE_TOOL_H

#include "quantity.h"
#include "sequence.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum pel_tool_shape {
    PEL_TOOL_SPHERE,  /* radius */
    PEL_TOOL_CAPSULE, /* radius; axis along the tool's z from -half_length to +half_length */
    PEL_TOOL_BOX,     /* half_extents; sharp */
    PEL_TOOL_MESH,    /* mesh; needs contact (pel_contact_def) */
    PEL_TOOL_SUPPORT, /* a support with keys: no surface; holds `vertices` of `body` from the first step on */
    PEL_TOOL_BLADE,   /* edge; cuts what the edge passes through, at any speed */
    PEL_TOOL_HOOK,    /* edge; holds the rim of a surface that the edge passes over */
    PEL_TOOL_SCISSORS /* edge, closing; cut what is between their blades while they close */
} pel_tool_shape;

enum { PEL_TOOL_SHAPE_COUNT = PEL_TOOL_SCISSORS + 1 }; /* number of shapes */

/* Pose of a tool at a time: x -> exp(rotation_vector) rotation x + position.

   Between two keys positions are interpolated linearly, quaternions spherically along the shorter arc. Rotation
   vectors about one axis are interpolated linearly in the angle: from 0 to 2 pi is one full turn, from 0 to 4 pi two.
   Between different axes whole turns are interpolated linearly and the remaining rotations spherically. */
typedef struct pel_pose_key {
    double time;               /* s */
    double position[3];        /* m */
    double rotation[4];        /* unit quaternion x, y, z, w */
    double rotation_vector[3]; /* rad, axis times angle, after `rotation`; at most 1e6 turns; 0 = none */
} pel_pose_key;

/* A rigid instrument that pushes bodies away (press) and can hold vertices (grasp). */
typedef struct pel_tool_def {
    const char *name; /* unique, not empty */
    pel_tool_shape shape;
    double radius;            /* m */
    double half_length;       /* m */
    double half_extents[3];   /* m */
    const pel_mesh *mesh;     /* in the tool's frame, any surface; copied */
    const pel_pose_key *keys; /* (key_count >= 1), times increasing */
    int32_t key_count;
    int32_t body; /* the body it acts on; -1 = all */
    bool press;   /* keeps the body out of the tool */
    bool grasp;   /* holds the vertices inside it or within `reach` of its surface at grasp_from, until
                     grasp_until. Only a closed mesh has an inside */
    double grasp_from, grasp_until; /* s */
    double reach;                   /* m */
    double friction;                /* Coulomb's coefficient; below 0 (default): that of pel_contact_def */
    double restitution;             /* likewise */
    double thickness;               /* m, likewise */
    double grasp_max_force; /* N; infinite = no limit. Maximum sum of the magnitudes of the forces on the held vertices.
                               If a step ends above it, the vertices with the largest forces are released until the rest
                               is within it. 0 (default), but for pbd: ten times the force that
                               doubles the length of the sheet of the held vertices, beside their inertia; and a grasp
                               that contact holds for some steps, however little it moves, releases all of them */
    bool grasp_one_patch;   /* of the vertices in reach only those that edges join, over vertices in reach, to the one
                               nearest to the tool's centre */
    bool leads;            /* with grasp, in bodies that tear: leads the nearest tip that is not farther from the circle
                                          at rest than half its radius, around lead_axis through lead_center.
                              Once the grasp has closed the keys are not used any more. The tool pulls the flap so that
                              the tear follows the circle, at lead_speed, and keeps the height along the axis of its
                              first key. Where it holds nothing, and farther from the tip than lead_regrasp, it grasps
                              one patch of the inner lip, five edges behind the tip. Without a tip it moves along the
                              axis. A pose that the caller sets ends this, unless lead_speed is 0 */
    double lead_center[3]; /* m */
    double lead_axis[3];   /* of any length but 0 */
    double lead_radius;    /* m, of the circle at rest */
    double lead_speed;     /* m/s; 0 = the caller sets the poses, and the tool grasps anew, also where it holds the
                              surface outside the tear */
    double lead_outward;   /* rad, of the pull away from the axis, -pi / 2 to pi / 2; not 0: the tear is not led back */
    double lead_regrasp;   /* m, from the tip; at least four times how far from its centre it grasps */
    /* PEL_TOOL_SUPPORT: x = R (X - center) + position with the rest position X and the pose (R, position) of the keys.
       The support starts at rest: position = center without rotation. If the body refines, a new vertex between two of
       them is held as well */
    const int32_t *vertices; /* (vertex_count) mesh vertices of `body`, none of them pinned, each once; copied */
    int32_t vertex_count;
    double center[3]; /* m, at rest */
    /* PEL_TOOL_SUPPORT, nullable: x is that of the vertex in the sequence instead of X, from grasp_from until
       grasp_until. The sequence has a row for each vertex of the body's mesh; of copies at cuts that of their origin.
       The simulation keeps a share of it. A support whose grasp_from is above 0 keeps the distance of its vertices from
       the sequence at that time. The body may not refine */
    const pel_sequence *sequence;
    /* PEL_TOOL_BLADE and PEL_TOOL_HOOK: neither presses nor grasps otherwise. The edge is straight between two points
       of the tool's frame. After each step the surface opens along the way that the edge has gone through it, one edge
       of the mesh after the other, as in pel_cut: the next vertex of the cut moves onto the way in the rest shape, and
       the cut ends within half an edge of the blade. It begins at a border, at an older cut, or inside the surface once
       the way there is longer than an edge. Bodies must not refine. A hook takes the nearest vertex of a border or lip
       that its edge passes over, and holds it up to grasp_max_force */
    double edge[2][3]; /* m; PEL_TOOL_SCISSORS: the tips of both blades when open, which meet in the tool's origin */
    /* PEL_TOOL_SCISSORS: share of the blades that has closed over time, 0 to 1. From one step to the next the surface
       opens along the way of the segment between the points of both blades at that share of their length, as with
       PEL_TOOL_BLADE; while they open or stay nothing is cut. They exert no force on the surface */
    const pel_key *closing; /* (closing_count) times increasing */
    int32_t closing_count;
    double sharpness; /* J/m2, energy that a new area of the cut takes; 0 (default) = none. With it the blade holds the
                         end of the cut until the force there is sharpness times the thickness of the sheet, and from
                         then on cuts under this force; where it lies on the inside of a surface it presses until its
                         force is sharpness times the thickness times the length that touches over `kerf`, at least
                         over the thickness. The ledger books it as dissipated_fracture. Refused under
                         PEL_METHOD_PBD and PEL_METHOD_PBD_DISTANCE, which have no forces */
    double kerf;      /* m, width of the blade; 0 (default) = the thickness of the sheet */
    double strength;  /* N; 0 (default) = no limit. A vertex of PEL_TOOL_SUPPORT whose force is larger at the end of a
                         step is released for good */
} pel_tool_def;

PEL_API pel_tool_def pel_tool_def_default(void);
/* The surface of a tool in its own frame, wound outward, as results show it; of PEL_TOOL_MESH a copy of its mesh. Free
   with pel_mesh_destroy. PEL_BAD_ARGUMENT for PEL_TOOL_SUPPORT, no mesh and dimensions that are not finite,
   PEL_OUT_OF_MEMORY; *mesh is null then. */
PEL_API pel_status pel_tool_def_surface(const pel_tool_def *def, pel_mesh **mesh, pel_error *error);
/* The pose (position 3, unit quaternion 4) of the keys of a tool at a time [s]; constant before the first key and after
   the last. */
PEL_API void pel_tool_def_pose(const pel_tool_def *def, double time, double position[3], double rotation[4]);

#ifdef __cplusplus
}
#endif
#endif
