/* Pellicle: readings of a simulation: tools, supports, solver, modes and paths. */
#ifndef PELLICLE_SIM_READING_H
#define PELLICLE_SIM_READING_H

#include "sim_step.h"

#ifdef __cplusplus
extern "C" {
#endif

PEL_API int32_t pel_sim_tool_count(const pel_sim *sim);
PEL_API const char *pel_sim_tool_name(const pel_sim *sim, int32_t tool);
/* Present pose, and loads of the bodies on the tool in the last step. */
typedef struct pel_tool_reading {
    double position[3];
    double rotation[4];
    double force[3];       /* N, on the tool */
    double torque[3];      /* N m about the tool's position */
    int32_t contact_count; /* vertices touched or held */
    int32_t held_count;    /* vertices held by the grasp after the step */
    bool is_held_back;     /* contact stopped the tool in the last step, because a body was trapped */
    bool force_known;      /* false = the guard took the tool back after the solver, in the last step: force and torque
                              are those of a way that it did not go; or a step of implicit has not converged */
    int64_t lost_count;    /* vertices released by grasp_max_force since the start */
    double lost_time;      /* s, end of the step that lost the first ones; 0 = none yet */
    double lost_limit;     /* N, the limit that they exceeded; 0 = none yet, or contact held the grasp */
    int64_t held_back_count; /* steps in which the tool was stopped, since the start */
    double held_back_time;   /* s, end of the first of them; 0 = none yet */
} pel_tool_reading;
PEL_API void pel_sim_get_tool(const pel_sim *sim, int32_t tool, pel_tool_reading *reading);

/* Load of a body on its supports: pinned vertices, tools of PEL_TOOL_SUPPORT, and supports of the def.

   Position-based methods: the multipliers of the constraints at the pinned vertices and the loads on them, mean of the
   last step. Methods static and implicit: the forces of the equilibrium at the end of the last step. Other methods: the
   forces of the body and the loads at the pinned vertices in the present state. All include the weight of the pinned
   vertices and contacts on them in the last step. */
typedef struct pel_support_reading {
    double force[3];      /* N, on the supports */
    double torque[3];     /* N m, about the origin */
    int32_t vertex_count; /* vertices pinned or held by them; 0 = the body has no support */
} pel_support_reading;
PEL_API void pel_sim_get_support(pel_sim *sim, int32_t body, pel_support_reading *reading);

/* Single supports of the def: the force along the held components. Zero before the first step. */
PEL_API int32_t pel_sim_support_count(const pel_sim *sim);
/* Ties (pel_sim_def.ties); 0 for null, "" for one that does not exist, whose reading stays as it was. */
PEL_API int32_t pel_sim_tie_count(const pel_sim *sim);
PEL_API const char *pel_sim_tie_name(const pel_sim *sim, int32_t tie);
PEL_API void pel_sim_get_tie(const pel_sim *sim, int32_t tie, pel_tie_reading *reading);

/* Joints of rigid bodies (pel_sim_def.joints), after the last step; 0 for null, "" and false, and nothing is written,
   for one that does not exist. */
PEL_API int32_t pel_sim_joint_count(const pel_sim *sim);
PEL_API const char *pel_sim_joint_name(const pel_sim *sim, int32_t joint);
PEL_API bool pel_sim_get_joint(const pel_sim *sim, int32_t joint, pel_joint_reading *reading);

PEL_API const char *pel_sim_support_name(const pel_sim *sim, int32_t support);
PEL_API void pel_sim_get_support_part(const pel_sim *sim, int32_t support, pel_support_reading *reading);

/* xpbd: excess stretch of springs and shells relative to their material (0.1 = 10 %), at most, because one sweep per
   substep does not converge. Small ones go with the fourth power of the substep (docs/shells.md: how, and
   measurements). Estimated at the start, every 8 to 32 steps and after refinement. 0 for other methods. */
PEL_API double pel_sim_softness(const pel_sim *sim);

/* Convergence of the last step of PEL_METHOD_DESCENT, STATIC or IMPLICIT, and the substeps of position-based methods;
   zero for others. */
typedef struct pel_solver_reading {
    bool solves; /* the method solves for balanced forces in each step: the next members are valid */
    int32_t iterations;
    int32_t evaluations; /* of energy and forces */
    double energy;       /* J, with the potential of loads and pressure */
    double residual;     /* N, root of the sum of squares of the forces, contact included, on all free components */
    bool unstable;       /* static: an equilibrium that is no minimum of the energy; none was found nearby */
    int32_t stray_body;  /* static, descent: a body held only by contact that moved farther than all tools by at least
                            half its size; -1 = none */
    double stray_way;    /* m, displacement of this body */
    bool has_budget;     /* solver.budget is set */
    bool converged;   /* every gap is within tolerance, and residual is at most 1e-6 (2e-3 in float) of the forces that
                         act: loads, pressure, contacts, grasps; without any, of the largest earlier ones */
    int32_t substeps; /* of the last step; of the next one before the first step */
    int32_t least_substeps, most_substeps; /* of all steps taken */
    int32_t needed_substeps;               /* xpbd: largest automatic number without the limit max_substeps */
    bool second_order;                     /* xpbd: in use */
    bool has_caving;                       /* pbd with fibres of the mode normal: the next member is valid */
    double caving_limited;                 /* share of their corrections in the last step that max_step cut */
    double softness, most_softness;        /* pel_sim_softness, and its maximum over the steps */
} pel_solver_reading;
PEL_API void pel_sim_get_solver(const pel_sim *sim, pel_solver_reading *reading);

/* Results of an analysis after its first step: Hz, or load factors, ascending; values (at most mode_count) may be null.
   Returns their number, 0 before. Modes have a largest displacement of 5 % of the largest body. */
PEL_API int32_t pel_sim_get_modes(const pel_sim *sim, double *values);
PEL_API pel_analysis pel_sim_analysis(const pel_sim *sim);
/* value of the mode shown by the present state; 0 = none */
PEL_API double pel_sim_mode_value(const pel_sim *sim);

/* Factor of all loads, gravity and prescribed pressure in the present state: 1 except along PEL_PATH_ARC_LENGTH. */
PEL_API double pel_sim_load_factor(const pel_sim *sim);
PEL_API pel_path pel_sim_path_kind(const pel_sim *sim);

/* State of a path along PEL_PATH_ARC_LENGTH; steps beyond its end change nothing. */
typedef enum pel_path_end {
    PEL_PATH_GOES_ON,
    PEL_PATH_END_FULL_LOAD, /* the factor is 1 */
    PEL_PATH_END_LOST       /* no step, however short, finds an equilibrium: bifurcation or collapse */
} pel_path_end;
PEL_API pel_path_end pel_sim_get_path_end(const pel_sim *sim);

/* Points of a path that the step which would pass them ends at: limit points, where the load factor stops rising or
   falling, and, before the first of those, crossings with another path (bifurcations), beyond which the balance is
   unstable: the factor there is at most 0.1 % too large. */
enum { PEL_LIMIT_POINTS = 64 };
typedef enum pel_limit_kind { PEL_LIMIT_MAXIMUM, PEL_LIMIT_MINIMUM, PEL_LIMIT_BIFURCATION } pel_limit_kind;
typedef struct pel_limit_point {
    int64_t step;
    double load_factor;
    pel_limit_kind kind;
} pel_limit_point;

/* Those so far, the first PEL_LIMIT_POINTS of them in order; points may be null. Returns their number. */
PEL_API int32_t pel_sim_get_limit_points(const pel_sim *sim, pel_limit_point *points);

#ifdef __cplusplus
}
#endif
#endif
