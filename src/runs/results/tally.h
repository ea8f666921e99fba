/* Counts of the warnings of a run, and those that a frame alone decides. */
#ifndef PEL_RESULTS_TALLY_H
#define PEL_RESULTS_TALLY_H

#include "pellicle/run.h"
#include "pellicle/sim_ledger.h"

typedef enum pel_warning_kind {
    PEL_WARN_SOFT,
    PEL_WARN_COARSE,
    PEL_WARN_MILLIMETRES,
    PEL_WARN_INVERTED_MESH,
    PEL_WARN_HELD_IN_PLACE,
    PEL_WARN_CLOSE_START,
    PEL_WARN_POISSON,
    PEL_WARN_COARSE_VOLUME,
    PEL_WARN_FAST_BLADE,
    PEL_WARN_WEIGHTLESS,
    PEL_WARN_HOLLOW,
    PEL_WARN_HINGE_ROW,
    PEL_WARN_OPEN_SEAM,
    PEL_WARN_LARGEST_PRESSURE,
    PEL_WARN_INVERTED_VOLUME,
    PEL_WARN_UNCONVERGED,
    PEL_WARN_UNSTABLE,
    PEL_WARN_STRAY,
    PEL_WARN_ENERGY,
    PEL_WARN_JAMMED,
    PEL_WARN_TOOL_HELD,
    PEL_WARN_ESTIMATED,
    PEL_WARN_CUT_HELD,
    PEL_WARN_GRASP_LOST,
    PEL_WARN_GRASP_EMPTY,
    PEL_WARN_TIE_LOST,
    PEL_WARN_UNCOUNTED,
    PEL_WARN_CROSSING,
    PEL_WARN_COARSE_CONTACT,
    PEL_WARN_COARSE_LOAD,
    PEL_WARN_COARSE_MODE,
    PEL_WARN_COARSE_BENDING,
    PEL_WARN_SPRING_NET,
    PEL_WARN_HINGES,
    PEL_WARN_TOOL_IDLE,
    PEL_WARN_UNSETTLED,
    PEL_WARN_UNRESOLVED,
    PEL_WARN_FALLS,
    PEL_WARN_NOTHING,
    PEL_WARN_LOOSE,
    PEL_WARN_COUNT
} pel_warning_kind;

/* Number of occurrences of a kind. Stored in checkpoints unchanged. */
typedef struct pel_warning_tally {
    int64_t first_frame, count;
    double worst; /* largest value that came with it */
} pel_warning_tally;

typedef struct pel_warning_tallies {
    pel_warning_tally of[PEL_WARN_COUNT];
} pel_warning_tallies;

/* the first body that a warning of the scene is about */
typedef struct pel_flagged_body {
    int32_t body;
    double value, limit; /* in the unit of the kind */
} pel_flagged_body;

/* Counts one more. */
void pel_warn(pel_warning_tallies *tallies, pel_warning_kind kind, int64_t frame, double value);
/* Adds the counts of `from` and resets it. */
void pel_warnings_merge(pel_warning_tallies *tallies, pel_warning_tallies *from);
/* At each frame, by the thread that writes it. */
void pel_warnings_check_frame(pel_warning_tallies *tallies, int64_t frame, const pel_sim_measures *measures,
                              const pel_sim_ledger *ledger);
/* The same of methods that relax, with the largest force until then of tools that press; 0 = none does. */
void pel_warnings_check_frame_rest(pel_warning_tallies *tallies, int64_t frame, const pel_sim_measures *measures,
                                   double tool_force);

#endif
