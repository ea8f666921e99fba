#include "results/tally.h"

#include "math/extremes.h"

/* shares of the elastic energy of shells above which bending matters, and of the supplied energy below which is
   rounding */
#define LAYER_SHARE 0.1
#define LEAST_ENERGY 1e-6
/* Of the force of a tool: net forces on free vertices of a frame at which the body is not at rest under the tool. The
   tool's force is off by about this share: 0.01, 0.17, 0.27, 0.36 where it is 0.7, 14, 22, 28 % too large (the lens
   capsule of scenes/ against static), 0.43 and 0.5 where it is 62 and 33 % (its refined sphere). */
#define RESTLESS_SHARE 0.2
/* a body without filling has collapsed below this share of its volume */
#define COLLAPSED_SHARE 0.7

void pel_warn(pel_warning_tallies *tallies, pel_warning_kind kind, int64_t frame, double value)
{
    pel_warning_tally *tally = &tallies->of[kind];
    if (tally->count == 0 || frame < tally->first_frame)
        tally->first_frame = frame;
    tally->worst = tally->count == 0 ? value : pel_max(tally->worst, value);
    tally->count++;
}

void pel_warnings_merge(pel_warning_tallies *tallies, pel_warning_tallies *from)
{
    for (int k = 0; k < PEL_WARN_COUNT; k++) {
        const pel_warning_tally *more = &from->of[k];
        if (more->count == 0)
            continue;
        pel_warn(tallies, (pel_warning_kind)k, more->first_frame, more->worst);
        tallies->of[k].count += more->count - 1;
    }
    *from = (pel_warning_tallies){0};
}

/* In that layer bending and stretching have energies of the same size (Pogorelov 1988, Bendings of Surfaces and
   Stability of Shells, chapter 1). In a membrane state the share of bending is h / R; inextensional bending extends
   over the length of the body. */
static bool bends_locally(const pel_sim_measures *measures, const pel_sim_ledger *ledger)
{
    double bending = measures->bending_energy, both = bending + measures->membrane_energy;
    return both > LEAST_ENERGY * ledger->supplied && bending > LAYER_SHARE * both && bending < (1 - LAYER_SHARE) * both;
}

void pel_warnings_check_frame(pel_warning_tallies *tallies, int64_t frame, const pel_sim_measures *measures,
                              const pel_sim_ledger *ledger)
{
    if (measures->least_volume_ratio <= 0)
        pel_warn(tallies, PEL_WARN_INVERTED_VOLUME, frame, -measures->least_volume_ratio);
    if (measures->least_volume_ratio < COLLAPSED_SHARE)
        pel_warn(tallies, PEL_WARN_HOLLOW, frame, -measures->least_volume_ratio);
    if (bends_locally(measures, ledger))
        pel_warn(tallies, PEL_WARN_COARSE, frame, 0);
    if (ledger->energy_error > ledger->tolerance)
        pel_warn(tallies, PEL_WARN_ENERGY, frame, ledger->energy_error);
    if (ledger->work_estimated > 0)
        pel_warn(tallies, PEL_WARN_ESTIMATED, frame, ledger->work_estimated);
}

void pel_warnings_check_frame_rest(pel_warning_tallies *tallies, int64_t frame, const pel_sim_measures *measures,
                                   double tool_force)
{
    if (tool_force > 0 && measures->unbalanced_force > RESTLESS_SHARE * tool_force)
        pel_warn(tallies, PEL_WARN_UNSETTLED, frame, measures->unbalanced_force / tool_force);
}
