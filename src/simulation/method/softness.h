/* Substeps of xpbd: chosen at the start, and followed. */
#ifndef PEL_METHOD_SOFTNESS_H
#define PEL_METHOD_SOFTNESS_H

#include "solve/softness.h"
#include "stage/stage.h"
#include "stage/transfer.h"

/* Substeps of xpbd: present number and history; in snapshots. */
typedef struct pel_substeps_now {
    int32_t count, least, most;
    int32_t needed;     /* maximum over the run, without max_substeps */
    int32_t is_stale;   /* the surface or the state has changed: update before the next step */
    int32_t interval;   /* steps from the end of the last look to that of the next one */
    int64_t next;       /* the step before which the next look ends */
    double softness;    /* the largest so far */
    pel_softness found; /* at the last look */
    pel_softness_progress look;
} pel_substeps_now;

struct pel_substeps {
    bool is_automatic;
    int32_t least;          /* of automatic ones */
    bool keeps_stiff_plain; /* second order is automatic: bodies with a stiff pressure are of first order */
    pel_softness_scratch scratch;
    pel_substeps_now now;
};

/* an enclosed gas, or a target volume */
bool pel_has_stiff_pressure(const pel_body *body);
/* Fills automatic values of the def: iterations, the limit of substeps, second order. */
void pel_substeps_configure(pel_sim *sim, const pel_sim_def *def);
/* How many the state at the start needs, on the finest level that it has everywhere. PEL_OUT_OF_MEMORY. */
pel_status pel_substeps_count(pel_sim *sim, int32_t *count, pel_error *error);
/* Chooses the substeps for the state at the start. */
pel_status pel_substeps_create(pel_sim *sim, pel_error *error);
void pel_substeps_destroy(pel_sim *sim);
/* Goes on with a look at the start of a step, and updates them when it ends. */
void pel_substeps_follow(pel_sim *sim);
/* After the surface has changed. */
void pel_substeps_follow_surface(pel_sim *sim);
/* After a snapshot was loaded; false when its numbers are out of range. */
bool pel_substeps_restore(pel_sim *sim);
/* Transfers the count and the tallies to a changed simulation; the next step updates them. */
void pel_substeps_carry(const pel_sim *from, pel_sim *to);
/* the remedy of a run that diverged because xpbd is too soft */
void pel_substeps_remedy(const pel_sim *sim, pel_error *error);
void pel_substeps_read(const pel_sim *sim, pel_solver_reading *reading);

/* a pel_transfer_part */
void pel_substeps_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);

#endif
