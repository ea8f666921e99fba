/* Inside of the simulation: the state, copies of loads and tools, and scratch that is allocated once. */
#ifndef PEL_SIM_SIM_H
#define PEL_SIM_SIM_H

#include "force/body_force.h"
#include "geom/solid.h"
#include "pellicle/sim.h"
#include "solve/stability.h"

typedef struct pel_load {
    char name[PEL_NAME_SIZE];
    double force[3];   /* N, on a vertex of weight 1 */
    int32_t *vertices; /* (vertex_count) in model order */
    double *weights;   /* (vertex_count) */
    int32_t vertex_count;
    double from, until;
    pel_key *keys;
    int32_t key_count;
    int32_t body;
    pel_load_kind kind;
} pel_load;

typedef struct pel_pose {
    double position[3];
    double rotation[4]; /* x, y, z, w */
} pel_pose;

typedef enum pel_grasp_phase { PEL_GRASP_WAITING, PEL_GRASP_HOLDING, PEL_GRASP_DONE } pel_grasp_phase;

/* What one tool did to one vertex during a step. */
typedef struct pel_touch {
    int32_t vertex;
    double push[3]; /* sum of the displacements, for the direction of the contact */
} pel_touch;

/* Where a triangle touched a tool: the point of the triangle, and the half space of the tool's frame,
   normal . x >= offset, in which it has to stay during the next step. */
typedef struct pel_plane {
    double weights[3];
    double normal[3];
    double offset;
    int64_t triangle;
} pel_plane;

/* planes a tool remembers at most; they matter where it touches few, large triangles */
enum { PEL_PLANE_LIMIT = 1024 };

typedef struct pel_tool {
    char name[PEL_NAME_SIZE];
    pel_solid solid;
    pel_pose_key *keys;
    int32_t key_count;
    int32_t body;
    bool press, grasp;
    double grasp_from, grasp_until, reach;

    pel_pose pose, pose_before;
    bool driven; /* the caller sets the pose, keys are not used any more */
    pel_pose driven_pose;
    pel_grasp_phase phase;
    int32_t held_count;
    int32_t *held;        /* (held_count) vertices held */
    double (*anchors)[3]; /* (held_count) their places in the tool's frame */
    double force[3], torque[3];
    int32_t contact_count;

    /* contacts of this step and of the one before, up to PEL_PLANE_LIMIT each */
    pel_plane *planes, *planes_before;
    int32_t plane_count, plane_before_count;
    pel_touch *touches; /* (touch_count) of this step */
    int32_t touch_count;
    int32_t *touch_of_vertex; /* (vertex_count) its touch plus 1, 0 = none */
} pel_tool;

struct pel_sim {
    const pel_model *model;
    pel_state *state;
    pel_solver_def solver;
    pel_step step;
    pel_pool *pool;        /* null = one thread */
    double *chunk_longest; /* scratch of the step */
    double alpha_limit;
    pel_load *loads;
    int32_t load_count;
    pel_tool *tools;
    int32_t tool_count;
    pel_record *force;          /* (vertex_count) scratch: forces, and loads on touched vertices */
    int32_t *near_triangles;    /* (triangle_count) scratch of the tools; null without tools */
    int32_t *plane_of_triangle; /* (triangle_count) its place in the planes of the tool at work plus 1, 0 = none */
    uint8_t *triangle_marks;    /* (triangle_count) */
    uint8_t *held;              /* (vertex_count) 1 = a tool holds it */
};

static inline bool pel_sim_is_explicit(const pel_sim *sim)
{
    return sim->solver.method == PEL_METHOD_EXPLICIT;
}

/* ---- loads.c ---- */
pel_status pel_loads_create(pel_sim *sim, const pel_load_def *defs, int32_t count, pel_error *error);
void pel_loads_destroy(pel_sim *sim);
/* Moves the new positions and velocities by the loads at the present time. False when a vertex leaves the bound. */
bool pel_loads_apply(pel_sim *sim);
/* Adds the loads at a time, gravity included, to force (vertex_count). */
void pel_loads_add(const pel_sim *sim, double time, pel_record *force);

/* ---- tools.c ---- */
pel_status pel_tools_create(pel_sim *sim, const pel_tool_def *defs, int32_t count, pel_error *error);
void pel_tools_destroy(pel_sim *sim);
/* Moves the tools to `time` and the new positions out of them, and reads the forces. longest: spring length bound. */
void pel_tools_apply(pel_sim *sim, double time, double longest);
/* a keyed pose at a time */
pel_pose pel_tool_pose_at(const pel_tool *tool, double time);

#endif
