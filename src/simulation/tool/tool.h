/* Tools: what one is, what all of them share, and small questions to them. */
#ifndef PEL_TOOL_TOOL_H
#define PEL_TOOL_TOOL_H

#include "action/force.h"
#include "base/assert.h"
#include "geom/solid.h"
#include "math/pose.h"
#include "sequence/sequence.h"
#include "stage/stage.h"
#include "tool/search.h"

typedef enum pel_grasp_phase { PEL_GRASP_WAITING, PEL_GRASP_HOLDING, PEL_GRASP_DONE } pel_grasp_phase;

/* Action of one tool on one vertex during a step. */
typedef struct pel_contact_vertex {
    int32_t vertex;
    double push[3]; /* sum of the displacements, for the direction of the contact */
} pel_contact_vertex;

/* Where a triangle touched a tool: the point of the triangle, and the half space of the tool's frame,
   normal . x >= offset, in which it has to stay during the next step. */
typedef struct pel_contact_plane {
    double weights[3];
    double normal[3];
    double offset;
    int64_t triangle;
} pel_contact_plane;

/* A point of a triangle that a tool keeps out in this step (stop.h). */
typedef struct pel_stop {
    int32_t vertices[3], triangle;
    double weights[3], normal[3]; /* of the point; out of the tool */
    double offset;                /* m, normal . point is at least this */
    double stuck[3];              /* where the point would be if it had gone with the tool */
    double inertia;               /* sum w b^2 */
    double push, rub[3];          /* m, sum of the displacements along the normal, at least 0, and across it */
} pel_stop;

/* points with room from the start on; more allocate when they come first */
enum { PEL_STOP_ROOM = 2048 };

typedef struct pel_stops {
    pel_stop *items; /* (count) of the tool at work */
    int32_t count;
    size_t capacity;
    bool is_new; /* no point can be among them yet */
} pel_stops;

/* Of a tool that the guard holds back: a stride as short is not tried again in the same step; a grasp whose stride was
   halved in steps to less than this is stuck. */
#define PEL_LEAST_STRIDE 0.01
#define PEL_STUCK_STRIDE (PEL_LEAST_STRIDE / 1024)

/* planes a tool remembers at most (they matter where it touches few, large triangles); places where a blade cuts */
enum { PEL_PLANE_LIMIT = 1024, PEL_BLADE_TIPS = 32 };

typedef struct pel_tool_tally {          /* since the start */
    int64_t held_back_count, lost_count; /* steps; vertices */
    double held_back_time, lost_time;    /* s, of the first one; 0 = none yet */
    double lost_limit;                   /* N, that the first ones exceeded; 0 = the grasp was stuck */
} pel_tool_tally;

/* Where a blade is in a surface. */
typedef struct pel_blade_tip {
    int32_t body, vertex;         /* of the mesh: the end of the cut, or the vertex where it is to begin */
    int32_t is_open, is_pressing; /* the edge behind it is; the blade rests on the surface, and has not pierced it */
    double from[3], to[3];        /* m, at rest: where the blade met the surface, and where it was last */
    double ahead[3];              /* unit, at rest: the last edge; 0 = none yet */
    double pull[3];               /* N, of the vertex on the blade when it last held it; 0 = not yet */
    double width;                 /* m, at rest, of the edge that presses */
    double slack; /* m, by which a vertex that the blade drags may overtake it; 0 = the blade holds the vertex */
} pel_blade_tip;

typedef struct pel_blade {
    pel_blade_tip tips[PEL_BLADE_TIPS]; /* (tip_count) */
    int32_t tip_count, closing_count;
    pel_pose pose_before;         /* at the start of the step */
    double closed, closed_before; /* share of scissors at present, and then; else 1 */
    pel_key *closing;             /* (closing_count) of scissors; else null */
} pel_blade;

typedef struct pel_tool {
    char name[PEL_NAME_SIZE];
    pel_solid solid;                         /* of a mesh: the sphere about it */
    double press_margin;                     /* m, the largest distance from a body that it keeps */
    pel_real look_box[2][3];                 /* low, high: box of the criterion of tools in this step */
    double friction, restitution, thickness; /* its own; below 0: the value of contact */
    pel_mesh *mesh;                          /* null = the solid */
    struct pel_mesh_query *query;            /* of a mesh that grasps: finds vertices inside or near; else null */
    pel_pose_key *keys;
    double (*key_spins)[3]; /* (key_count) spin of the pose at each key */
    int32_t key_count, body;
    bool press, grasp;
    double grasp_from, grasp_until, reach;
    double grasp_max_force; /* N, 0 = by the material, infinite = no limit */
    bool one_patch;         /* its grasp takes one */
    bool is_leading;        /* a tear (tear/forceps.h), from the closing of the grasp on until the caller drives it */

    pel_pose pose, pose_before; /* at present; at the start of the step */
    pel_pose pose_wanted;       /* at the end of the step, if nothing holds the tool back */
    pel_pose pose_start;        /* at the start of the step, of which the present one may be a part */
    pel_pose pose_substep;      /* at the start of the substep */
    bool blocked;               /* it was held back, and has not caught up with its keys yet */
    bool is_held_back;          /* the last step held it back */
    bool is_doubtful;           /* in this part its force is not that of the end */
    bool is_stopped;            /* by the guard after the solver, or that changed what it touches, or the step has not
                                   converged: its force is unknown */
    double stride;              /* of its way in a step, that it tries: less than 1 after it was held back */
    pel_tool_tally tally;       /* its history; in snapshots */
    bool driven;                /* the caller sets the pose, keys are not used any more */
    pel_pose driven_pose;
    pel_grasp_phase phase;
    int32_t held_count;
    int32_t *support; /* (support_count) of a keyed support: the places that it holds; else null */
    int32_t support_count;
    uint8_t *support_marks; /* (vertices of the finest level) 1 = of the support; null = its body does not refine */
    double center[3];       /* of a keyed support at rest */
    const pel_sequence *sequence; /* that a support follows (follow.h); null = none */
    int32_t *rows;                /* (vertex_count) of held vertices in the sequence */
    double (*booked_forces)[3];   /* (vertex_count) N, on the tool after the last step; null where velocities exist */
    double strength;              /* N, of each held vertex of a support; infinite = no limit */
    int32_t *held;                /* (held_count) vertices held */
    double (*anchors)[3];         /* (held_count) their places in the tool's frame, less those of the sequence */
    pel_blade *blade;             /* null = none */
    double force[3], torque[3];
    double force_sum[3], torque_sum[3]; /* of a step in parts: means over the parts done */
    bool was_held_back, was_stopped, hold_is_counted;
    bool is_on_its_way, blocked_before; /* during a step, which may fail: the values before it */
    double force_before[3], torque_before[3];
    int32_t contact_count;

    /* contacts of this step and of the one before, up to PEL_PLANE_LIMIT each */
    pel_contact_plane *planes, *planes_before;
    int32_t plane_count, plane_before_count;
    pel_contact_vertex *touches; /* (touch_count) of this step */
    int32_t touch_count;
    int32_t *touch_of_vertex; /* (vertex_count) its touch plus 1, 0 = none */
    pel_near_list near;       /* triangles that it may press in a step */
    pel_near_list in_reach;   /* those that a force loop looks at */
} pel_tool;

typedef struct pel_sim_solids pel_sim_solids;

/* all tools of a simulation */
struct pel_tools {
    pel_tool *items; /* (count) */
    int32_t count;
    pel_tool_search *search;    /* null without tools */
    int32_t *near_triangles;    /* (triangle_count) scratch of the tools; null without tools */
    int32_t *plane_of_triangle; /* (triangle_count) its place in the planes of the tool at work plus 1, 0 = none */
    int64_t *looked_at;         /* (triangle_count) by place in near_triangles: pushes when it was looked at */
    int64_t *moved_at;          /* (vertex_count) push that moved it last */
    int64_t *cornered_at;       /* (vertex_count) the pressing that looked at it as a corner last */
    int64_t push_count;         /* of all steps */
    int64_t press_count;        /* likewise */
    pel_stops stops;            /* scratch of the tool at work */
    pel_boundary boundary;      /* vertices held by tools; its arrays: */
    int32_t *held_vertices;     /* (vertex_count) null when no tool grasps */
    double (*held_targets)[3];  /* (vertex_count) likewise */
    double *strengths;          /* (body_count) N, of a vertex (pel_body_strength); null when no tool grasps */
    double (*grip_forces)[3];   /* (vertex_count) N, of each held vertex on its tool; null when no tool grasps */
    bool held_is_listed;        /* the boundary belongs to the tools */
    pel_record *blade_before;   /* (vertex_count) positions at the start of the step; null without blades */
    pel_sim_solids *solids;     /* (solid.h) methods with substeps; null = no tool presses */
};

/* velocity of the point of the tool that is now at `point`: v + w x r with the mean v and w of the last step */
static inline void pel_tool_velocity(const pel_tool *tool, const double point[3], double dt, double velocity[3])
{
    double turn[3], arm[3], before[3];
    pel_pose_turn(&tool->pose_before, &tool->pose, turn);
    pel_vec3_subtract(point, tool->pose.position, arm);
    pel_vec3_cross(turn, arm, velocity);
    pel_vec3_add(arm, tool->pose_before.position, before);
    for (int i = 0; i < 3; i++)
        velocity[i] = (velocity[i] + (point[i] - before[i])) / dt;
}

static inline double pel_tool_size(const pel_tool *tool)
{
    return pel_solid_size(&tool->solid);
}

/* m, how far from its centre a tool grasps at most */
static inline double pel_grasp_extent(const pel_solid *solid, double reach)
{
    double half[3];
    pel_solid_half_box(solid, half);
    return pel_vec3_length(half) / (pel_solid_is_ball(solid) ? 1.7320508075688772 : 1) + reach;
}

/* displacement between two poses: of the position, and of the tool's rim by the rotation */
static inline double pel_tool_way(const pel_tool *tool, const pel_pose *a, const pel_pose *b)
{
    return pel_pose_way(a, b, pel_tool_size(tool));
}

/* grown by a distance about it */
static inline pel_solid pel_solid_grown(const pel_solid *solid, double margin)
{
    pel_solid grown = *solid;
    grown.radius += margin;
    for (int k = 0; k < 3; k++)
        grown.half_extents[k] += margin;
    return grown;
}

static inline bool pel_tool_is_round(const pel_tool *tool)
{
    return tool->mesh == NULL && pel_solid_is_round(&tool->solid);
}

static inline bool pel_tool_acts_on(const pel_tool *tool, int32_t body)
{
    return tool->body < 0 || tool->body == body;
}

/* inverse mass, 0 if a tool holds the vertex */
static inline double pel_tool_mobility(const pel_sim *sim, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    bool is_held = sim->held != NULL && sim->held[v];
    return is_held ? 0 : (double)sim->model->inverse_mass[v];
}

/* the touch of a vertex in this step, new if need be */
static inline pel_contact_vertex *pel_tool_touch(pel_tool *tool, int32_t v)
{
    if (tool->touch_of_vertex[v] == 0) {
        tool->touches[tool->touch_count] = (pel_contact_vertex){.vertex = v};
        tool->touch_of_vertex[v] = ++tool->touch_count;
    }
    return &tool->touches[tool->touch_of_vertex[v] - 1];
}

static inline void pel_tool_add_reaction(pel_tool *tool, const double point[3], const double force[3])
{
    double arm[3], torque[3];
    pel_vec3_subtract(point, tool->pose.position, arm);
    pel_vec3_cross(arm, force, torque);
    pel_vec3_add(tool->force, force, tool->force);
    pel_vec3_add(tool->torque, torque, tool->torque);
}

/* force of a held vertex at a point on its tool */
static inline void pel_tool_add_grip(pel_sim *sim, pel_tool *tool, int32_t v, const double point[3],
                                     const double force[3])
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    double back[3];
    pel_vec3_add(sim->tools->grip_forces[v], force, sim->tools->grip_forces[v]);
    pel_tool_add_reaction(tool, point, force);
    pel_vec3_scale(force, -1, back);
    pel_contact_forces_add_at(&sim->contact_forces, v, (int32_t)(tool - sim->tools->items), back);
}

#endif
