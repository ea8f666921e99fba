/* The step, the same for all methods: surface, method, contact and tools, readings, ledger; then it is accepted. */
#include "sim/sim.h"

#include "adapt/refine.h"
#include "attach/joint.h"
#include "attach/tie.h"
#include "base/assert.h"
#include "base/memory.h"
#include "base/pool.h"
#include "base/status.h"
#include "blade/hold.h"
#include "force/pressure.h"
#include "math/extremes.h"
#include "method/bending_weight.h"
#include "method/step_explicit.h"
#include "observe/ledger.h"
#include "pellicle/tear.h"
#include "sim/cut.h"
#include "stage/accessors.h"
#include "stage/growth.h"
#include "stage/plastic.h"
#include "stage/rigids.h"
#include "stage/shells.h"
#include "tear/forceps.h"
#include "tear/score.h"
#include "tear/seam.h"
#include "tool/grip.h"
#include "tool/reading.h"
#include "tool/support.h"
#include "tool/tools.h"
#include "touch/restitution.h"

#include <string.h>

/* Of the largest pressure that a sphere balances: what swings past it if applied at once. There the work p (V - V0)
   equals the energy at rest for a moment; a neo-Hookean sphere gives 1.11 / 1.24 = .89, and other shapes have parts
   that are wider than a sphere of their volume and area, which balance less. */
#define SUDDEN_SHARE .5

/* a prescribed pressure goes on acting on what is left of a body that has opened */
static void advise_after_burst(const pel_sim *sim, int32_t body, double given, pel_error *error)
{
    pel_cut_reading cuts;
    pel_sim_get_cuts(sim, body, &cuts, NULL);
    if (cuts.length > 0)
        pel_fail_remedy(error,
                        "let the pressure fall when the body has opened (inside: { keys: [[0, %g], [T, 0]] }), or end "
                        "the run there (stop: { time: T })",
                        given);
}

/* m, how far a surface is open, and the middle of that at rest */
static double read_opening(const pel_body *body, double middle[3])
{
    const pel_mesh *mesh = body->mesh;
    double length = 0;
    pel_vec3_set(middle, 0, 0, 0);
    for (int32_t h = 0; h < 3 * mesh->triangle_count; h++) {
        const double *a = mesh->positions[mesh->triangles[h / 3][h % 3]],
                     *b = mesh->positions[mesh->triangles[h / 3][(h + 1) % 3]];
        double half = pel_is_lip(body, h) ? 0.5 * pel_vec3_distance(a, b) : 0;
        length += half;
        pel_vec3_along(middle, 0.5 * half, a, middle);
        pel_vec3_along(middle, 0.5 * half, b, middle);
    }
    if (length > 0)
        pel_vec3_scale(middle, 1 / length, middle);
    return length;
}

/* a balance that an open body lacks under pressure: what burst, how far and where */
static void name_burst(const pel_sim *sim, pel_error *error)
{
    if (error == NULL || strcmp(error->element_kind, "body") != 0 || error->element < 0 ||
        error->element >= sim->model->body_count)
        return;
    int32_t b = (int32_t)error->element;
    const pel_body *body = &sim->model->bodies[b];
    double middle[3], opening = read_opening(body, middle);
    if (opening > 0 && body->shell != NULL && pel_pressure_given(body->shell) != 0)
        pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", b,
                           "let the pressure fall by then (inside: { keys: ... }), end the run before (stop: { time: "
                           "... }), or use the method implicit, xpbd or explicit",
                           "body '%s' burst at time %.4g s, open over %.3g m about (%.3g, %.3g, %.3g) at rest: its "
                           "pressure has no balance any more",
                           body->name, pel_sim_time(sim) + sim->step.dt, opening, middle[0], middle[1], middle[2]);
}

static pel_status report_divergence(const pel_sim *sim, pel_error *error)
{
    const pel_model *model = sim->model;
    int32_t bad = pel_sim_first_outside(sim);
    /* it was rounding that went beyond the bound */
    if (bad < 0)
        bad = model->vertex_count - 1;
    const pel_body *body = &model->bodies[model->body_of_slice[bad / PEL_WIDTH]];
    pel_fail(error, PEL_DIVERGED, "body '%s' diverged in step %lld (t = %g s)", body->name,
             (long long)sim->state->step + 1, pel_sim_time(sim) + sim->step.dt);
    pel_fail_element(error, "vertex", model->mesh_vertex[bad]);
    sim->stepper->advise(sim, error);
    double ratio, largest = pel_pressure_peak(model, (int32_t)(body - model->bodies), &ratio);
    double given = body->shell != NULL ? pel_pressure_given(body->shell) : 0;
    if (given > largest)
        pel_fail_remedy(
            error,
            "use less than %.4g Pa, the largest pressure that it balances before it jumps to a far larger size (at "
            "%.3g times its volume), or "
            "prescribe the volume (pressure: { volume: ... })",
            largest, ratio);
    else if (given > SUDDEN_SHARE * largest && body->shell->outside.key_count == 0)
        pel_fail_remedy(error,
                        "let the pressure grow in time (inside: { keys: [[0, 0], [1, %g]] }): at once it swings past "
                        "the largest that holds, %.4g Pa if round, else less",
                        given, largest);
    else if (given > 0)
        advise_after_burst(sim, (int32_t)(body - model->bodies), given, error);
    return PEL_DIVERGED;
}

/* the new positions and velocities become the present ones */
static void accept(pel_state *state)
{
    PEL_ASSERT(state->position != state->position_next);
    pel_record *oldest = state->position_before, *velocity = state->velocity;
    state->position_before = state->position;
    state->position = state->position_next;
    state->position_next = oldest;
    state->velocity = state->velocity_next;
    state->velocity_next = velocity;
    pel_rigid_state *rigids = state->rigids_before;
    state->rigids_before = state->rigids;
    state->rigids = state->rigids_next;
    state->rigids_next = rigids;
}

static void mark_contacts(pel_sim *sim)
{
    if (sim->tools->count == 0 && sim->contacts == NULL)
        return;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        int32_t first = body->slice_begin * PEL_WIDTH, count = body->slice_end * PEL_WIDTH - first;
        if (sim->part.at == 0)
            memset(sim->state->contact + first, 0, (size_t)count);
    }
    for (int32_t i = 0; i < sim->tools->count; i++)
        for (int32_t k = 0; k < sim->tools->items[i].touch_count; k++)
            sim->state->contact[sim->tools->items[i].touches[k].vertex] = 1;
    if (sim->contacts != NULL)
        pel_contact_set_mark(sim->contacts, sim->state->contact);
    if (sim->stepper->mark_contacts != NULL)
        sim->stepper->mark_contacts(sim);
}

/* Refinement comes before the tools, so that they push new vertices out as well; contact follows the new surface. */
static pel_status follow_surface(pel_sim *sim, pel_error *error)
{
    sim->present.has_force = false;
    sim->state_number++;
    pel_status status = sim->guards != NULL ? sim->guards->prepare(sim, error) : PEL_OK;
    if (status == PEL_OK && sim->active != NULL)
        pel_refine_step(sim);
    return status == PEL_OK && sim->contacts != NULL ? pel_contacts_begin_step(sim, error) : status;
}

static pel_status check_volumes(const pel_sim *sim, pel_error *error)
{
    pel_status status = pel_shells_check_volume(sim, error);
    if (status == PEL_DIVERGED && sim->stepper->is_explicit)
        pel_explicit_advise(sim, error);
    return status;
}

/* the new positions and velocities of the method */
static pel_status solve(pel_sim *sim, double next, pel_step_result *result, pel_error *error)
{
    const pel_stepper *stepper = sim->stepper;
    pel_sim_update_factors(sim, stepper->is_at_end ? next : pel_sim_time(sim));
    pel_plastic_begin(sim);
    pel_growth_begin(sim);
    pel_ties_begin(sim);
    pel_status status = stepper->step(sim, result, error);
    /* some methods do not bound the motion: the search of tools needs the new edges */
    if (status == PEL_OK && !result->diverged && !stepper->bounds_motion && sim->tools->count > 0)
        result->longest = pel_sim_longest_edge(sim);
    if (status == PEL_OK && result->diverged)
        status = report_divergence(sim, error);
    /* a surface that never cuts itself cannot turn inside out */
    if (status == PEL_OK && !sim->part.is_refused && !pel_sim_has_self_contact(sim))
        status = check_volumes(sim, error);
    if ((status != PEL_OK || sim->part.is_refused) && stepper->moves_tools)
        pel_tools_return(sim);
    return status;
}

/* correct remaining violations, then guard; without contact tools press by themselves */
static pel_status keep_apart(pel_sim *sim, double next, const pel_step_result *result, pel_error *error)
{
    if (sim->contacts != NULL)
        return pel_contacts_apply(sim, next, result, error);
    if (sim->tools->count == 0)
        return PEL_OK;
    if (!sim->stepper->moves_tools)
        pel_tools_move(sim, next);
    pel_tools_press(sim, result->longest, false);
    pel_tools_read(sim, next);
    return PEL_OK;
}

/* accept the new positions and velocities of a part */
static void accept_part(pel_sim *sim, double next)
{
    PEL_ASSERT(next > 0);
    bool is_last = pel_parts_are_last(sim);
    pel_rigids_keep(sim);
    pel_ties_end(sim, next);
    pel_joints_end(sim);
    pel_supports_read(sim, next);
    mark_contacts(sim);
    pel_growth_end(sim);
    pel_plastic_follow(sim, sim->state->position_next);
    pel_ledger_step(sim, next);
    pel_plastic_accept(sim);
    accept(sim->state);
    pel_contact_forces_accept(&sim->contact_forces, pel_part_share(sim), sim->part.at == 0);
    sim->state->step += is_last;
    pel_tools_end_step(sim, next);
    if (is_last)
        pel_bending_weights_follow(sim);
    if (sim->stepper->accept != NULL)
        sim->stepper->accept(sim);
    pel_restitution_apply(sim);
    pel_ledger_end_step(sim);
    pel_parts_accept(sim);
}

/* a part that failed, or is refused, leaves the state before it */
static pel_status step_part(pel_sim *sim, pel_error *error)
{
    double next = pel_sim_next_time(sim);
    pel_step_result result = {0};
    pel_contact_forces_begin(&sim->contact_forces);
    for (int32_t t = 0; t < sim->tools->count; t++)
        sim->tools->items[t].is_doubtful = false;
    pel_status status = solve(sim, next, &result, error);
    if (status == PEL_OK && !sim->part.is_refused)
        status = keep_apart(sim, next, &result, error);
    if (status == PEL_OK && sim->part.is_repeated) {
        sim->part.is_repeated = false;
        return pel_pool_check(sim->pool, error);
    }
    /* a shorter part has fewer pairs, and does not go that far */
    bool is_too_long = status == PEL_BAD_ARGUMENT || status == PEL_DIVERGED;
    if (sim->part.is_refused || (is_too_long && pel_parts_can_halve(sim)))
        return pel_parts_halve(sim, error);
    if (status == PEL_OK)
        status = pel_pool_check(sim->pool, error);
    if (status == PEL_OK && sim->contact_forces.is_short) {
        sim->contact_forces.is_short = false;
        status = pel_fail_memory(error);
    }
    if (status == PEL_OK) {
        pel_blades_read(sim);
        accept_part(sim, next);
    }
    return status;
}

/* Edges that a tear grows by before a step: just after an edge has opened a tip releases less than in balance, so it
   does not run ahead. A static step grows until the tear rests, or by at most so many. */
enum { MOST_ADVANCES = 2, MOST_STATIC_ADVANCES = 256 };

static pel_status step_once(pel_sim *sim, pel_error *error)
{
    pel_status status = pel_parts_keep(sim, error);
    pel_blades_begin(sim);
    pel_ledger_start(sim);
    if (status == PEL_OK)
        status = follow_surface(sim, error);
    if (status == PEL_OK) {
        /* substeps depend on the stiffness at this time */
        pel_sim_update_factors(sim, pel_sim_time(sim));
        status = pel_parts_begin(sim, error);
    }
    while (status == PEL_OK && sim->part.at < PEL_PART_LIMIT)
        status = step_part(sim, error);
    /* a stop that was asked for after the last part was accepted is not lost */
    if (status == PEL_OK)
        status = pel_pool_check(sim->pool, error);
    pel_parts_end(sim, status);
    return status;
}

static pel_status step_to_rest(pel_sim *sim, pel_error *error)
{
    pel_status status = step_once(sim, error);
    bool may_repeat = sim->stepper->repeats != NULL;
    for (int times = 1; status == PEL_OK && may_repeat && sim->stepper->repeats(sim, times); times++) {
        sim->state->step--;
        status = step_once(sim, error);
    }
    return status;
}

/* After the step in which seams opened: books what their ends have released, as far as the step has lost it. Where it
   became motion, it stays in the balance. */
static void book_seams(pel_sim *sim, const pel_seam_ends *ends, double remainder)
{
    double lost = remainder - pel_ledger_remainder(sim), released = pel_seam_ends_work(ends, sim);
    pel_ledger_book_tear(sim, pel_max(pel_min(released, lost), 0));
}

/* a balance in which a tip still releases enough, or a seam carries too much, is none: the same step again, from there
 */
static pel_status grow_to_rest(pel_sim *sim, pel_error *error)
{
    bool has_grown = true, has_released = false, has_cut = false;
    pel_status status = PEL_OK;
    for (int advance = 0; status == PEL_OK && has_grown && advance < MOST_STATIC_ADVANCES; advance++) {
        pel_seam_ends ends = {0};
        status = pel_seams_open(sim, &ends, error);
        double remainder = ends.count > 0 ? pel_ledger_remainder(sim) : 0;
        if (status == PEL_OK)
            status = pel_adhesions_release(sim, &has_released, error);
        if (status == PEL_OK)
            status = pel_tears_grow(sim, &has_grown, error);
        if (status == PEL_OK)
            status = pel_blades_cut(sim, &has_cut, error);
        has_grown |= ends.count > 0 || has_released || has_cut;
        if (status == PEL_OK && has_grown) {
            sim->state->step--;
            status = step_to_rest(sim, error);
        }
        if (status == PEL_OK && ends.count > 0)
            book_seams(sim, &ends, remainder);
        pel_free(ends.list);
    }
    return status;
}

pel_status pel_sim_step(pel_sim *sim, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    bool has_grown = !sim->stepper->is_static, has_cut, has_released;
    pel_seam_ends ends = {0};
    pel_status status = pel_cuts_make(sim, error);
    if (status == PEL_OK)
        status = pel_seams_open(sim, &ends, error);
    double remainder = ends.count > 0 ? pel_ledger_remainder(sim) : 0;
    if (status == PEL_OK && !sim->stepper->is_static)
        status = pel_adhesions_release(sim, &has_released, error);
    for (int advance = 0; status == PEL_OK && has_grown && advance < MOST_ADVANCES; advance++)
        status = pel_tears_grow(sim, &has_grown, error);
    if (status == PEL_OK) {
        pel_forceps_lead(sim);
        status = step_to_rest(sim, error);
    }
    if (status == PEL_OK && ends.count > 0)
        book_seams(sim, &ends, remainder);
    pel_free(ends.list);
    if (status == PEL_OK && sim->stepper->is_static)
        status = grow_to_rest(sim, error);
    if (status == PEL_BAD_ARGUMENT && sim->stepper->minimises)
        name_burst(sim, error);
    if (status == PEL_OK && !sim->stepper->is_static)
        status = pel_blades_cut(sim, &has_cut, error);
    return status == PEL_OK ? pel_score_add(sim, error) : status;
}
