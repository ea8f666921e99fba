/* The stage: what all rooms of a simulation share. Each room keeps what is its own behind one pointer, and only rooms
   above it know what is there. */
#ifndef PEL_STAGE_STAGE_H
#define PEL_STAGE_STAGE_H

#include "action/force.h"
#include "base/assert.h"
#include "batch/batches.h"
#include "contact/layer.h"
#include "force/body_force.h"
#include "force/shell_force.h"
#include "math/vec3.h"
#include "model/boundary.h"
#include "refined/refined_model.h"
#include "solve/step.h"
#include "stage/stepper.h"
#include "sweep/contact.h"

typedef struct pel_cursor pel_cursor; /* (transfer.h) */
typedef struct pel_surface_rows pel_surface_rows;
typedef struct pel_loads pel_loads;
typedef struct pel_holds pel_holds;
typedef struct pel_tools pel_tools;
typedef struct pel_joints pel_joints;
typedef struct pel_ties pel_ties;
typedef struct pel_ledger pel_ledger;
typedef struct pel_viscous pel_viscous;
typedef struct pel_observer pel_observer;
typedef struct pel_picker pel_picker;
typedef struct pel_touch pel_touch;
typedef struct pel_refine_body pel_refine_body;
typedef struct pel_substeps pel_substeps;
typedef struct pel_projector pel_projector;
typedef struct pel_relax pel_relax;
typedef struct pel_minimise pel_minimise;
typedef struct pel_newton pel_newton;
typedef struct pel_sim_path pel_sim_path;
typedef struct pel_sim_modes pel_sim_modes;
typedef struct pel_tear pel_tear;
typedef struct pel_contact_set pel_contact_set;

/* Parts of a step. Sizes are in units of a step over PEL_PART_LIMIT. */
enum { PEL_PART_LIMIT = 64 };

/* Linear systems under constraints after which a step is divided no more: the rest of it goes in parts that grow, and
   each of them ends after few systems, converged or not. */
enum { PEL_STEP_SYSTEMS = 120 };

/* the part of the step in progress */
typedef struct pel_step_part {
    int32_t at;        /* where it begins; 0 between steps */
    int32_t step_size; /* its size */
    int32_t substeps;  /* of a whole step */
    bool is_refused;   /* repeat it with a shorter step */
    bool is_repeated;  /* repeat it, with shorter strides of tools */
    int32_t repeat_count;
    bool can_halve;         /* false = all steps are whole */
    int32_t systems;        /* of the step so far under constraints, those of refused parts included */
    int32_t conflict_count; /* conflicts of fast motion when this part was last refused; 0 = it was not */
} pel_step_part;

/* Gaps between surfaces exceed the thickness by this share of it, with a slightly smaller tolerance: nothing has to be
   corrected after a step, and surfaces that start at the thickness are lifted by at most that. */
#define PEL_SLACK_SHARE 0.05

/* What is known of the present state; found when asked for. */
typedef struct pel_present {
    bool has_force;    /* sim->force holds the forces of the present state */
    bool has_energies; /* and these its energies [J], when has_force */
    double spring_energy, volumetric_energy, kinetic_energy;
    pel_shell_energy shell_energy; /* when has_force */
} pel_present;

/* What has to be asked around an event of refinement under contact (sim/contact_event.h). */
typedef struct pel_event_guard {
    /* before events: finds room for that data. PEL_OUT_OF_MEMORY */
    pel_status (*prepare)(pel_sim *sim, pel_error *error);
    /* saves the data to revert an event */
    void (*before)(pel_sim *sim);
    /* true if the new surface of a body does not cut itself; otherwise nothing changes */
    bool (*accept)(pel_sim *sim, int32_t body);
} pel_event_guard;

/* How far the energy release rate of a tip falls while it goes on by one edge, in balance: the mean over the edge is
   what the material takes. */
typedef struct pel_tear_drop {
    int32_t body, vertex; /* the tip after the last advance that is not in balance yet; vertex -1 = none */
    double before;        /* N, its release before */
    double ratio;         /* of the last two in balance; 0 = unknown */
} pel_tear_drop;

/* Sums over the steps so far while a tool leads a tear. */
typedef struct pel_score_sums {
    double peak, squares; /* N, N2: of the largest force of all tools in a step */
    int64_t pulls;        /* steps with a force */
    int64_t touches;      /* steps in which a tool was at the far side */
    double begin, end;    /* s, of the first and of the last step with a force */
} pel_score_sums;

struct pel_sim {
    /* what is simulated */
    const pel_model *model; /* the given one, or the active one when any body refines */
    const pel_model *given;
    pel_refined_model *active; /* null = no body refines */
    pel_state *state;
    int64_t state_number; /* another one for each state */
    pel_sim_def def;      /* the def with all changes since creation */
    bool goes_on;         /* continues from a state: skip the checks of a start at rest */
    bool is_opened;       /* after a cut: contact takes its surface where that is, not at rest first */
    int32_t cuts_done;    /* of def.cuts */
    bool cut_is_held;     /* the last cut that was tried is held back: its lips would intersect */
    int64_t cut_revision; /* another one after each change of the triangles by a cut */
    pel_tear_drop tear_drop;
    pel_score_sums score;

    /* how */
    pel_solver_def solver;
    const pel_stepper *stepper; /* of its method */
    pel_step step;
    pel_step_part part;
    double alpha_limit;
    double (*clock)(void); /* s, from any origin; for solver.budget. Tests replace it */
    double deadline;       /* s by that clock, of the step at work; HUGE_VAL = none */
    pel_pool *pool;        /* null = one thread */

    /* elements, contacts and forces */
    pel_batches *batches;      /* the elements of all bodies */
    pel_shell_forces *shells;  /* null = no body is a shell */
    pel_contact_layer *layers; /* (stage/layer.h, body_count) */
    pel_contact_set *contacts; /* (contact/set.h) null = none */
    bool contact_in_loop;      /* the solver sweeps over them too */
    bool self_contact;         /* no body can cut itself */
    const uint8_t *asleep;     /* (body_count) 1 = left out of the step (touch/sleep.h); null = all are awake */
    pel_contact_forces contact_forces;
    pel_present present;

    pel_rigids *rigids; /* (stage/rigids.h) null = no body is rigid */

    /* arrays by vertex, and scratch */
    pel_record *force;       /* (vertex_count) scratch: forces, and loads on touched vertices */
    pel_record *predicted;   /* (vertex_count) scratch of the explicit method beside rigid bodies; else null */
    pel_record *pin_force;   /* (vertex_count) N, there: on pins; null = nobody asks */
    uint8_t *held;           /* (vertex_count) 1 = a tool holds it; null without tools */
    uint8_t *loose;          /* (vertex_count) 1 = of a piece that stays (tear/loose.h); null = none */
    double (*reactions)[3];  /* (vertex_count) N, of supports on vertices in the last step; null = none */
    double *checked_volumes; /* (body_count) m3, of the new positions where the check of the step found it; else NAN */
    double *chunk_longest;   /* scratch of the step */
    double tie_work;         /* J, of ties and motors on the bodies in the last part of a step */
    double plastic_loss;     /* J, that what yields has dissipated in the part of the step in progress */
    double growth_work;      /* J, that growth does in the part of the step in progress */
    double growth_size;      /* J, that it would do on a body that does not follow */
    double viscous_loss;     /* J, that damping of the material takes out in the step in progress */
    pel_viscous *viscous;    /* (viscous.h) of methods that do not find this themselves; null = none */

    /* what the rooms keep, from the lowest to the highest */
    pel_surface_rows *rows;        /* (surface_view.c, body_count) null = no body refines */
    pel_loads *loads;              /* (boundary/loads.h) */
    pel_holds *holds;              /* (boundary/hold.h) supports of single components; null = none */
    pel_tools *tools;              /* (tool/tool.h) */
    pel_ties *ties;                /* (attach/tie.h) null = none */
    pel_joints *joints;            /* (attach/joint.h) null = none */
    pel_ledger *ledger;            /* (observe/ledger.h) */
    pel_observer *observer;        /* (observe/observe_field.h) null = nobody looked at a field */
    pel_picker *picker;            /* (observe/pick.h) null = no ray was cast */
    pel_touch *touch;              /* (touch/contact.h) */
    pel_refine_body *refine;       /* (adapt/refine.h, body_count) null = no body refines */
    const pel_event_guard *guards; /* of its events; null = no contact */
    pel_substeps *substeps;        /* (method/softness.h) of xpbd */
    pel_projector *projector;      /* (solve/project.h) position-based methods, else null */
    pel_relax *relax;              /* (solve/relax.h) quasi-static method on bodies that refine, else null */
    pel_minimise *minimise;        /* (constraint/frame.h) methods that minimise, else null */
    pel_newton *newton;            /* (newton/newton.h) where one of these has a matrix, else null */
    pel_sim_path *path;            /* (minimise/step_path.h) null = loads by time */
    pel_sim_modes *modes;          /* (minimise/step_modes.h) null = no analysis */
    pel_tear *tear;                /* (tear/growth.h) null = no body can tear */
};

static inline bool pel_sim_is_explicit(const pel_sim *sim)
{
    return sim->stepper->is_explicit;
}

static inline bool pel_sim_has_self_contact(const pel_sim *sim)
{
    return sim->contacts != NULL && sim->self_contact;
}

/* contacts are swept over inside the solver */
static inline bool pel_sim_has_loop_contacts(const pel_sim *sim)
{
    return sim->contacts != NULL && sim->contact_in_loop;
}

/* contacts, solids, ties and grasps act in substeps */
static inline bool pel_sim_is_projected(const pel_sim *sim)
{
    return sim->stepper->has_substeps;
}

/* elements are constraints there too, and loads act substep by substep */
static inline bool pel_sim_projects_elements(const pel_sim *sim)
{
    return sim->stepper->has_substeps && !sim->stepper->is_explicit;
}

/* velocities are part of the state */
static inline bool pel_sim_has_velocity(const pel_sim *sim)
{
    return sim->stepper->has_velocity;
}

/* Whether the step records the force on a pinned vertex: the explicit method does so for rigid bodies alone. */
static inline bool pel_sim_records_pin(const pel_sim *sim, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    return sim->stepper->get_held_force != NULL && (!sim->stepper->is_explicit || pel_rigid_of(sim->rigids, v) != NULL);
}

/* whether the new position of a vertex is within the bound; not so when it is NaN */
static inline bool pel_sim_is_inside(const pel_sim *sim, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    double bound = sim->step.bound, x[3];
    pel_vertex_position(sim->state->position_next, v, x);
    return pel_vec3_squared_length(x) < bound * bound;
}

/* Of an acceleration, to the new positions [s2] and velocities [s]. */
typedef struct pel_gains {
    double position, velocity;
} pel_gains;

static inline bool pel_parts_are_spent(const pel_sim *sim)
{
    return sim->part.systems >= PEL_STEP_SYSTEMS;
}

/* Whether the present part may be refused and repeated in two halves. */
static inline bool pel_parts_can_halve(const pel_sim *sim)
{
    return sim->part.can_halve && sim->part.step_size > 1 && !pel_parts_are_spent(sim);
}
/* of the present part in its step */
static inline double pel_part_share(const pel_sim *sim)
{
    return (double)sim->part.step_size / PEL_PART_LIMIT;
}

/* share of the present part in the rest of its step */
static inline double pel_part_share_left(const pel_sim *sim)
{
    return (double)sim->part.step_size / (PEL_PART_LIMIT - sim->part.at);
}

static inline bool pel_parts_are_last(const pel_sim *sim)
{
    return sim->part.at + sim->part.step_size == PEL_PART_LIMIT;
}

/* whether there is such a body, for public functions that are given any number */
static inline bool pel_sim_has_body(const pel_sim *sim, int32_t body)
{
    return sim != NULL && body >= 0 && body < sim->model->body_count;
}

#endif
