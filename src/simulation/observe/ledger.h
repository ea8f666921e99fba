/* Energy ledger of a simulation: the work that each step takes in, and the energy that damping takes out. A step adds
   sums over vertices that carry weight, loads and damping; energies are evaluated only when the ledger is read. */
#ifndef PEL_OBSERVE_LEDGER_H
#define PEL_OBSERVE_LEDGER_H

#include "model/model.h"
#include "pellicle/sim_ledger.h"
#include "stage/stage.h"
#include "stage/transfer.h"

typedef struct pel_ledger_chunk {
    double moment[3]; /* kg m: sum of mass times displacement */
    double damping;   /* J */
} pel_ledger_chunk;

/* of a tool that is held back: the gaps that it closes in a step at rest */
typedef struct pel_closing {
    bool is_open;
    int64_t step;  /* in which */
    double load;   /* N, before the step */
    double way;    /* m, of surfaces off the tool, in all tries of the step */
    double booked; /* J, of the last try */
} pel_closing;

/* of a step in which the force of a tool is not known */
typedef struct pel_unsure_work {
    bool is_open;
    double most;      /* J, by the size of what was read */
    double remainder; /* J, before the step */
    double given;     /* J, by all tools before the step */
} pel_unsure_work;

typedef struct pel_ledger {
    pel_sim_ledger sums;                  /* over all steps; members of the present state stay 0 */
    double gravity_level;                 /* J, work of gravity from the rest shape to where it was booked last */
    uint8_t is_started;                   /* the energies at the start are known */
    bool is_unread;                       /* nobody reads it: the energies at the start stay 0 */
    bool has_damping, has_radial_damping; /* any vertex has its own damping, along its volumetric spring */
    double rounding;                      /* J, energy that rounding of positions alone can show */
    double rounding_moment;               /* J s2; over the square of a substep: that of velocities */
    pel_tool_reading *tools;              /* (tool_count) at the start of the step */
    pel_closing *closings;                /* (tool_count) */
    pel_unsure_work unsure;
    uint8_t *owes;                          /* (tool_count) it touches since a step in which its force was not known */
    double *given;                          /* (tool_count) J, that it is known to have put in since it touched */
    double (*factors)[PEL_PARAMETER_COUNT]; /* (body_count) of keyed parameters, in the step before */
    double *volumes;                        /* (body_count) m3, at the start of the step; NAN = unknown */
    pel_ledger_chunk *chunks;               /* scratch of the sums over vertices */
} pel_ledger;

/* Allocates the ledger; tools must exist already. PEL_OUT_OF_MEMORY. */
pel_status pel_ledger_create(pel_sim *sim, pel_error *error);
/* Recomputes its constants after the numbers of the model have changed. */
void pel_ledger_refill(pel_sim *sim);
void pel_ledger_destroy(pel_sim *sim);

/* Records the energies at the start, once, before the first step. */
void pel_ledger_start(pel_sim *sim);
/* Adds the step to position_next, at the time `next`, before it is accepted. */
void pel_ledger_step(pel_sim *sim, double next);
/* After it is accepted: books the work of tools whose forces are not known. */
void pel_ledger_end_step(pel_sim *sim);

/* Elastic plus kinetic energy [J] before a setter changes the state; 0 before the first step. */
double pel_ledger_energy(pel_sim *sim);
/* After the setter: books the change as work of the caller. */
void pel_ledger_book_change(pel_sim *sim, double energy_before);

/* After a cut: books the energy that it released. */
void pel_ledger_book_cut(pel_sim *sim, double energy_before);
/* After a tear has grown: books the energy that its edges and moving vertices changed, and what the material takes. */
void pel_ledger_book_remesh(pel_sim *sim, double energy_before);
void pel_ledger_book_tear(pel_sim *sim, double energy);
/* J, what no booking explains so far: energy_error - dissipated_solver. */
double pel_ledger_remainder(pel_sim *sim);

/* Reads tools and keyed parameters again after a snapshot was loaded. */
void pel_ledger_follow(pel_sim *sim);

/* a pel_transfer_part */
void pel_ledger_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);

#endif
