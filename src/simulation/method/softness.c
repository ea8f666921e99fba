/* Substeps of xpbd: the number at which it is not softer than the material (solve/softness.h), chosen at the start,
   every 8 to 32 steps, and after refinement. A look takes as long as some substeps, so it is spread over the last steps
   before the choice. Springs with keys may stiffen within these steps: then it is done at once. Where the caller fixes
   the number, only the start, live changes and springs with keys are looked at. */
#include "method/softness.h"

#include "base/status.h"
#include "math/extremes.h"
#include "solve/project.h"

#include <math.h>

/* stretch beyond the material's that automatic substeps allow: of one sweep, and of several, which are trusted less
   than they do */
#define MOST_SOFTNESS_ONE 0.0042
#define MOST_SOFTNESS 0.048
/* largest (substep)^2 stiffness / mass of a pressure that changes with the volume; the limit of stability is 4 */
#define PRESSURE_SQUARE 1.0
/* fewer substeps are taken only below this share of the present ones: each change costs accuracy in time */
#define KEEP_SHARE 0.75
/* a rate that changed by less than this between two looks is looked at half as often */
#define CALM_CHANGE 0.05

/* where something touches, substeps also bound how far it moves before it is met */
enum {
    LEAST_FREE = 4,
    LEAST_TOUCHING = 16,
    DEFAULT_MOST = 200,
    INTERVAL = 8, /* also the steps that a look is spread over */
    LONGEST_INTERVAL = 32,
    XPBD_ITERATIONS = 1,
    PBD_ITERATIONS = 5
};

bool pel_has_stiff_pressure(const pel_body *body)
{
    const pel_shell *shell = body->shell;
    return shell != NULL && (shell->pressure.kind == PEL_PRESSURE_GAS || shell->pressure.kind == PEL_PRESSURE_VOLUME);
}

static int32_t count_stiff_pressures(const pel_model *model)
{
    int32_t count = 0;
    for (int32_t b = 0; b < model->body_count; b++)
        count += pel_has_stiff_pressure(&model->bodies[b]);
    return count;
}

static bool has_rigid(const pel_model *model)
{
    bool has = false;
    for (int32_t b = 0; b < model->body_count; b++)
        has |= model->bodies[b].rigid != NULL;
    return has;
}

void pel_substeps_configure(pel_sim *sim, const pel_sim_def *def)
{
    pel_solver_def *solver = &sim->solver;
    bool compliant = sim->stepper->is_compliant;
    if (pel_sim_is_projected(sim) && !pel_sim_projects_elements(sim))
        solver->substeps = 1;
    if (!pel_sim_projects_elements(sim))
        return;
    sim->substeps->is_automatic = compliant && solver->substeps == 0;
    if (solver->iterations == 0)
        solver->iterations = compliant ? XPBD_ITERATIONS : PBD_ITERATIONS;
    if (solver->substeps == 0)
        solver->substeps = 1;
    if (solver->max_substeps == 0)
        solver->max_substeps = DEFAULT_MOST;
    bool touches = def->tool_count > 0 || def->contact.enabled;
    sim->substeps->least = touches ? LEAST_TOUCHING : LEAST_FREE;
    /* a force held over a substep that stiffens the body feeds oscillations of second order; rigid bodies take the way
       of a substep for their velocity, which is not what attachments act over there */
    const int32_t stiff_count = count_stiff_pressures(def->model);
    bool is_plain = stiff_count == def->model->body_count || (def->tie_count > 0 && has_rigid(def->model));
    sim->substeps->keeps_stiff_plain = stiff_count > 0 && solver->second_order == PEL_AUTO;
    if (solver->second_order == PEL_AUTO)
        solver->second_order = compliant && !is_plain ? PEL_YES : PEL_NO;
}

/* s, the longest of the bodies */
static double retardation_of(const pel_sim *sim)
{
    double longest = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        longest = pel_max(longest, body->spring_retardation);
        if (body->shell != NULL)
            longest = pel_max(longest, pel_max(body->shell->membrane_retardation, body->shell->bending_retardation));
    }
    return longest;
}

/* second order throughout: what touches, or encloses a gas, goes by first order */
static bool is_free(const pel_sim *sim)
{
    return sim->solver.second_order && sim->substeps->least == LEAST_FREE && !sim->substeps->keeps_stiff_plain;
}

/* tau of a substep */
static double tau_share(const pel_sim *sim)
{
    return is_free(sim) ? 2.0 / 3 : 1;
}

/* A sweep takes damping of the material for a stiffness that is larger by the retardation over the substep
   (solve/project_kernel.h), so that tau (tau + share of the retardation) stands in place of the square of tau. */
static double longest_substep(const pel_sim *sim)
{
    const pel_softness *found = &sim->substeps->now.found;
    const int32_t sweeps = sim->solver.iterations;
    double share = pel_softness_share(sweeps == 1 ? MOST_SOFTNESS_ONE : MOST_SOFTNESS, sweeps);
    double half = 0.5 * tau_share(sim) * retardation_of(sim), square = found->rate > 0 ? 2 * share / found->rate : 0;
    double elastic = found->rate > 0 ? sqrt(square) : HUGE_VAL;
    double tau = half > 0 && found->rate > 0 ? square / (half + sqrt(half * half + square)) : elastic;
    double pressure = found->pressure > 0 ? sqrt(PRESSURE_SQUARE / found->pressure) : HUGE_VAL;
    return pel_min(is_free(sim) ? 1.5 * tau : tau, pressure);
}

static int32_t needed_substeps(const pel_sim *sim)
{
    double count = ceil(sim->solver.dt / longest_substep(sim));
    return (int32_t)pel_min(pel_max(count, sim->substeps->least), INT32_MAX);
}

/* goes on with the present look; true at its end */
static bool look_on(pel_sim *sim, int64_t end)
{
    pel_substeps *substeps = sim->substeps;
    sim->present.has_force = false;
    pel_softness_look(sim->model, sim->state, pel_sim_time(sim), sim->pool, end, &substeps->scratch,
                      &substeps->now.look);
    if (end < pel_softness_size(sim->model))
        return false;
    substeps->now.found = substeps->now.look.found;
    substeps->now.look.done = 0;
    return true;
}

static void look_at_once(pel_sim *sim)
{
    sim->substeps->now.look.done = 0;
    look_on(sim, pel_softness_size(sim->model));
}

static void note(pel_sim *sim)
{
    pel_substeps_now *now = &sim->substeps->now;
    now->count = sim->solver.substeps;
    now->least = now->least > 0 && now->least < now->count ? now->least : now->count;
    now->most = now->most > now->count ? now->most : now->count;
    now->softness = pel_max(now->softness, pel_sim_softness(sim));
    int32_t needed = needed_substeps(sim);
    now->needed = now->needed > needed ? now->needed : needed;
}

static int32_t clamp_substeps(const pel_sim *sim, int32_t count)
{
    return count < sim->solver.max_substeps ? count : sim->solver.max_substeps;
}

static bool has_keyed_springs(const pel_model *model)
{
    for (int32_t b = 0; b < model->body_count; b++)
        if (model->bodies[b].curves[PEL_SPRING_STIFFNESS].key_count > 0)
            return true;
    return false;
}

/* springs or pressure may change at any time */
static bool has_keys(const pel_model *model)
{
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_shell *shell = model->bodies[b].shell;
        if (shell != NULL && shell->outside.key_count + shell->target.key_count > 0)
            return true;
    }
    return has_keyed_springs(model);
}

/* says when the next look is to end */
static void plan_next(pel_sim *sim, double rate_before)
{
    pel_substeps_now *now = &sim->substeps->now;
    bool is_calm =
        !now->is_stale && !has_keys(sim->model) && fabs(now->found.rate - rate_before) <= CALM_CHANGE * rate_before;
    now->interval = is_calm && now->interval > 0 ? 2 * now->interval : INTERVAL;
    now->interval = now->interval < LONGEST_INTERVAL ? now->interval : LONGEST_INTERVAL;
    now->next = sim->state->step + now->interval;
    now->is_stale = false;
}

static void choose_first(pel_sim *sim)
{
    look_at_once(sim);
    plan_next(sim, 0);
    if (sim->substeps->is_automatic)
        sim->solver.substeps = clamp_substeps(sim, needed_substeps(sim));
    note(sim);
}

/* nothing needs the forces while substeps are chosen */
static pel_status create_scratch(pel_sim *sim, pel_error *error)
{
    _Static_assert(sizeof *sim->force >= 2 * sizeof(double), "two numbers a vertex");
    return pel_softness_create(sim->model, (double *)sim->force, &sim->substeps->scratch, error);
}

pel_status pel_substeps_create(pel_sim *sim, pel_error *error)
{
    if (!sim->stepper->is_compliant)
        return PEL_OK;
    pel_status status = create_scratch(sim, error);
    if (status == PEL_OK && !sim->goes_on)
        choose_first(sim);
    return status;
}

void pel_substeps_destroy(pel_sim *sim)
{
    pel_softness_destroy(&sim->substeps->scratch);
}

/* the element that the present look has to come to; 0 = none is due */
static int64_t look_end(const pel_sim *sim)
{
    const pel_substeps_now *now = &sim->substeps->now;
    int64_t size = pel_softness_size(sim->model), passed = sim->state->step - (now->next - INTERVAL);
    if (has_keyed_springs(sim->model))
        return passed < INTERVAL ? 0 : size;
    if (!sim->substeps->is_automatic || passed <= 0)
        return 0;
    return passed < INTERVAL ? size * passed / INTERVAL : size;
}

void pel_substeps_follow(pel_sim *sim)
{
    pel_substeps *substeps = sim->substeps;
    double before = substeps->now.found.rate;
    if (!sim->stepper->is_compliant)
        return;
    if (substeps->now.is_stale)
        look_at_once(sim);
    else if (look_end(sim) == 0 || !look_on(sim, look_end(sim)))
        return;
    plan_next(sim, before);
    int32_t count = clamp_substeps(sim, needed_substeps(sim)), present = sim->solver.substeps;
    if (substeps->is_automatic && (count > present || count < KEEP_SHARE * present)) {
        sim->stepper->set_substeps(sim, count, false);
        sim->solver.substeps = count;
    }
    note(sim);
}

void pel_substeps_follow_surface(pel_sim *sim)
{
    sim->substeps->now.is_stale |= sim->substeps->is_automatic || sim->state->step == 0;
}

bool pel_substeps_restore(pel_sim *sim)
{
    const pel_substeps_now *now = &sim->substeps->now;
    bool is_whole =
        now->count > 0 && now->interval > 0 && now->look.done >= 0 && now->look.done <= pel_softness_size(sim->model) &&
        (sim->substeps->is_automatic ? now->count <= sim->solver.max_substeps : now->count == sim->solver.substeps);
    if (!is_whole)
        return false;
    sim->solver.substeps = now->count;
    sim->stepper->set_substeps(sim, now->count, true);
    return true;
}

/* whether the known softness is valid in the changed simulation */
static bool is_as_soft(const pel_sim *from, const pel_sim *to)
{
    return from->given == to->given && from->substeps->is_automatic == to->substeps->is_automatic &&
           from->substeps->least == to->substeps->least && from->solver.second_order == to->solver.second_order &&
           from->solver.iterations == to->solver.iterations && from->solver.max_substeps == to->solver.max_substeps;
}

void pel_substeps_carry(const pel_sim *from, pel_sim *to)
{
    pel_substeps_now *now = &to->substeps->now;
    if (!to->stepper->is_compliant)
        return;
    if (from->state->step == 0) {
        choose_first(to);
    } else {
        *now = from->substeps->now;
        now->look.done = 0;
        now->is_stale |= !is_as_soft(from, to);
        if (to->substeps->is_automatic && from->substeps->is_automatic)
            to->solver.substeps = clamp_substeps(to, now->count);
        now->count = to->solver.substeps;
    }
    pel_projector_set_substeps(to->projector, NULL, to->solver.substeps);
}

/* edges are halved on each level of a body that is refined everywhere */
static double finest_factor(const pel_model *model)
{
    int32_t levels = 0;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_body_levels *detail = model->bodies[b].detail;
        if (detail != NULL && detail->def.everywhere && detail->def.levels > levels)
            levels = detail->def.levels;
    }
    return ldexp(1, levels);
}

pel_status pel_substeps_count(pel_sim *sim, int32_t *count, pel_error *error)
{
    pel_status status = create_scratch(sim, error);
    if (status != PEL_OK)
        return status;
    look_at_once(sim);
    *count = (int32_t)pel_min(needed_substeps(sim) * finest_factor(sim->model), INT32_MAX);
    return PEL_OK;
}

double pel_sim_softness(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    if (!sim->stepper->is_compliant)
        return 0;
    double substep = sim->step.dt / sim->solver.substeps, tau = tau_share(sim) * substep;
    double square = tau * (tau + tau_share(sim) * retardation_of(sim));
    return pel_softness_after(0.5 * square * sim->substeps->now.found.rate, sim->solver.iterations);
}

void pel_substeps_remedy(const pel_sim *sim, pel_error *error)
{
    pel_fail_remedy(error, "use %s >= %d, or method implicit (static for equilibria)",
                    sim->substeps->is_automatic ? "max_substeps" : "substeps", (int)needed_substeps(sim));
}

void pel_substeps_read(const pel_sim *sim, pel_solver_reading *reading)
{
    bool compliant = sim->stepper->is_compliant;
    reading->substeps = sim->solver.substeps;
    reading->least_substeps = compliant ? sim->substeps->now.least : sim->solver.substeps;
    reading->most_substeps = compliant ? sim->substeps->now.most : sim->solver.substeps;
    reading->needed_substeps = compliant ? sim->substeps->now.needed : sim->solver.substeps;
    reading->second_order = compliant && sim->solver.second_order != PEL_NO;
    reading->softness = pel_sim_softness(sim);
    reading->most_softness = sim->substeps->now.softness;
    reading->has_caving = pel_projector_limited(sim->projector, &reading->caving_limited);
}

/* ---- snapshots ---- */

void pel_substeps_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    const pel_softness_scratch *scratch = &sim->substeps->scratch;
    size_t count = (size_t)sim->model->vertex_count;
    if (!sim->stepper->is_compliant)
        return;
    pel_transfer(at, &sim->substeps->now, sizeof sim->substeps->now);
    if (sim->substeps->is_automatic) {
        pel_transfer(at, scratch->energy, count * sizeof *scratch->energy);
        pel_transfer(at, scratch->excess, count * sizeof *scratch->excess);
    }
}
