/* Ties. With the vector d from a point to its vertex, the length L and e = |d| - L > 0 the energy is k e^2 / 2, the
   gradient k e n with n = d / |d|, and the Hessian k (n n^T + e / |d| (1 - n n^T)), which is never negative. At L = 0
   this is a spring of the stiffness k in all directions.

   Projection takes e as a constraint with the compliance 1 / k (Macklin, Mueller, Chentanez 2016, XPBD), along the
   vector d so that a length of 0 is no singular point. */
#include "attach/tie.h"

#include "base/assert.h"
#include "base/status.h"
#include "math/extremes.h"
#include "rigid/sum.h"
#include "stage/accessors.h"
#include "tool/follow.h"
#include "tool/tool.h"

#include <math.h>
#include <string.h>

/* ---- one tie ---- */

/* share of the part that a time is in */
static double share_of(const pel_sim *sim, double time)
{
    double start = pel_sim_part_time(sim, 0);
    return pel_max(0, pel_min(1, (time - start) / sim->step.dt));
}

static void place_of(const pel_sim *sim, const pel_tie *tie, double time, double place[3])
{
    const pel_tie_group *group = &sim->ties->groups[tie->group];
    pel_vec3_copy(tie->place, place);
    if (group->def.target == PEL_TIE_TOOL) {
        const pel_tool *tool = &sim->tools->items[group->def.tool];
        pel_pose pose;
        pel_pose_between(&tool->pose_before, &tool->pose, sim->stepper->moves_tools ? share_of(sim, time) : 1, &pose);
        if (sim->stepper->has_substeps)
            pose = tool->pose;
        pel_pose_to_world(&pose, tie->place, place);
    } else if (group->def.target == PEL_TIE_SEQUENCE) {
        pel_sequence_moment moment = pel_sequence_find(group->def.sequence, time);
        pel_sequence_point(&moment, tie->row, place);
    }
}

static bool is_pair(const pel_tie_group *group)
{
    return group->def.target == PEL_TIE_BODY || group->def.target == PEL_TIE_VERTICES;
}

static double length_of(const pel_sim *sim, const pel_tie *tie, double time)
{
    const pel_tie_group *group = &sim->ties->groups[tie->group];
    double least = is_pair(group) ? group->gap : 0, close = group->def.close;
    double start = is_pair(group) ? pel_max(tie->start, least) : 0;
    if (close < 0 || !is_pair(group))
        return start;
    double left = close > 0 ? pel_max(0, 1 - (time - group->def.from) / close) : 0;
    return least + pel_min(left, 1) * (start - least);
}

/* weights times records, less the place */
static void sum_records(const pel_tie *tie, const pel_record *positions, double sum[3])
{
    pel_vec3_set(sum, 0, 0, 0);
    for (int i = 0; i < tie->count; i++)
        for (int k = 0; k < 3; k++)
            sum[k] += tie->weights[i] * (double)positions[tie->vertices[i]][k];
}

static void sum_unknowns(const pel_tie *tie, const double *unknowns, double sum[3])
{
    pel_vec3_set(sum, 0, 0, 0);
    for (int i = 0; i < tie->count; i++)
        pel_vec3_along(sum, tie->weights[i], unknowns + 3 * (size_t)tie->vertices[i], sum);
}

/* From the weighted sum of positions to the direction n and the excess e > 0; false where the thread is slack. */
static bool stretch(const pel_sim *sim, const pel_tie *tie, double time, const double sum[3], double n[3],
                    double *excess, double *distance)
{
    double place[3];
    place_of(sim, tie, time, place);
    pel_vec3_subtract(sum, place, n);
    *distance = pel_vec3_length(n);
    *excess = *distance - length_of(sim, tie, time);
    if (!(*excess > 0))
        return false;
    pel_vec3_scale(n, 1 / *distance, n);
    return true;
}

/* ---- in a step ---- */

static void begin_tie(const pel_sim *sim, pel_tie *tie, const pel_record *positions)
{
    const pel_tie_group *group = &sim->ties->groups[tie->group];
    double sum[3];
    tie->phase = PEL_TIE_HOLDING;
    sum_records(tie, positions, sum);
    tie->start = pel_vec3_length(sum);
    if (group->def.target == PEL_TIE_PLACE)
        pel_vec3_copy(sum, tie->place);
    else if (group->def.target == PEL_TIE_TOOL)
        pel_pose_to_local(&sim->tools->items[group->def.tool].pose, sum, tie->place);
}

/* those that begin or end by a time */
static void switch_ties(pel_sim *sim, double time, const pel_record *positions)
{
    pel_ties *ties = sim->ties;
    for (int32_t i = 0; i < ties->count; i++) {
        pel_tie *tie = &ties->items[i];
        const pel_tie_def *def = &ties->groups[tie->group].def;
        const int32_t before = tie->phase;
        if (tie->phase == PEL_TIE_WAITING && time >= def->from)
            begin_tie(sim, tie, positions);
        if (tie->phase == PEL_TIE_HOLDING && time >= def->until)
            tie->phase = PEL_TIE_OPEN;
        ties->change |= tie->phase != before;
    }
}

void pel_ties_begin(pel_sim *sim)
{
    pel_ties *ties = sim->ties;
    if (ties == NULL)
        return;
    ties->change = false;
    for (int32_t i = 0; i < ties->count; i++)
        pel_vec3_set(ties->items[i].sum, 0, 0, 0);
    const int32_t count = pel_sim_is_projected(sim) ? sim->solver.substeps : 1;
    switch_ties(sim, pel_sim_part_time(sim, 0.5 / count), sim->state->position);
}

/* N on the vertex, at positions and a time */
static void force_at(const pel_sim *sim, const pel_tie *tie, double time, const pel_record *positions, double force[3])
{
    double sum[3], n[3], excess, distance;
    pel_vec3_set(force, 0, 0, 0);
    if (tie->phase != PEL_TIE_HOLDING)
        return;
    sum_records(tie, positions, sum);
    if (stretch(sim, tie, time, sum, n, &excess, &distance))
        pel_vec3_scale(n, -tie->stiffness * excess, force);
}

static void let_go(pel_ties *ties, pel_tie *tie, double time)
{
    pel_tie_group *group = &ties->groups[tie->group];
    double most = group->def.strength > 0 ? group->def.strength : (double)HUGE_VAL;
    if (tie->phase != PEL_TIE_HOLDING || !(pel_vec3_length(tie->force) > most))
        return;
    tie->phase = PEL_TIE_OPEN;
    if (group->lost_count++ == 0) {
        group->lost_time = time;
        group->lost_force = pel_vec3_length(tie->force);
    }
}

/* The force on the tool at its point, which does its own work: only the rest of the way of the vertex counts. */
static void pass_on(pel_sim *sim, const pel_tie *tie, const double mean[3], double way[3])
{
    pel_tool *tool = &sim->tools->items[sim->ties->groups[tie->group].def.tool];
    double before[3], after[3], force[3];
    pel_pose_to_world(&tool->pose_before, tie->place, before);
    pel_pose_to_world(&tool->pose, tie->place, after);
    pel_vec3_scale(mean, -1, force);
    pel_tool_add_reaction(tool, after, force);
    pel_vec3_subtract(after, before, after);
    pel_vec3_subtract(way, after, way);
}

void pel_ties_end(pel_sim *sim, double next)
{
    pel_ties *ties = sim->ties;
    sim->tie_work = 0;
    if (ties == NULL)
        return;
    for (int32_t i = 0; i < ties->count; i++) {
        pel_tie *tie = &ties->items[i];
        double before[3], after[3], mean[3];
        if (tie->phase == PEL_TIE_HOLDING && sim->stepper->has_substeps)
            pel_vec3_scale(tie->sum, 1.0 / sim->solver.substeps, tie->force);
        else
            force_at(sim, tie, next, sim->state->position_next, tie->force);
        sum_records(tie, sim->state->position, before);
        sum_records(tie, sim->state->position_next, after);
        pel_vec3_subtract(after, before, after);
        bool is_rigid = !isfinite(tie->stiffness);
        for (int k = 0; k < 3; k++)
            mean[k] = is_rigid ? tie->force[k] : 0.5 * (tie->force[k] + tie->before[k]);
        if (ties->groups[tie->group].def.target == PEL_TIE_TOOL)
            pass_on(sim, tie, mean, after);
        sim->tie_work += pel_vec3_dot(mean, after);
        pel_vec3_copy(tie->force, tie->before);
        let_go(ties, tie, next);
    }
}

/* ---- Newton's method ---- */

double pel_ties_evaluate(pel_sim *sim, double time, const double *unknowns, double *gradient)
{
    const pel_ties *ties = sim->ties;
    double energy = 0;
    for (int32_t i = 0; ties != NULL && i < ties->count; i++) {
        const pel_tie *tie = &ties->items[i];
        double sum[3], n[3], excess, distance;
        if (tie->phase != PEL_TIE_HOLDING)
            continue;
        sum_unknowns(tie, unknowns, sum);
        if (!stretch(sim, tie, time, sum, n, &excess, &distance))
            continue;
        for (int j = 0; j < tie->count; j++) {
            double *at = gradient + 3 * (size_t)tie->vertices[j];
            pel_vec3_along(at, tie->weights[j] * tie->stiffness * excess, n, at);
        }
        energy += 0.5 * tie->stiffness * excess * excess;
    }
    return energy;
}

static void add_blocks(pel_matrix *matrix, const pel_tie *tie, const double n[3], double across)
{
    for (int i = 0; i < tie->count; i++)
        for (int j = 0; j < tie->count; j++) {
            int32_t block = pel_matrix_block(matrix, tie->vertices[i], tie->vertices[j]);
            double *values = matrix->values + matrix->block_start[block];
            double weight = tie->weights[i] * tie->weights[j] * tie->stiffness;
            for (int a = 0; a < 3; a++)
                for (int b = 0; b < 3; b++)
                    values[a + 3 * b] += weight * ((1 - across) * n[a] * n[b] + (a == b ? across : 0));
        }
}

void pel_ties_add_matrix(pel_sim *sim, double time, const double *unknowns, pel_matrix *matrix)
{
    const pel_ties *ties = sim->ties;
    for (int32_t i = 0; ties != NULL && i < ties->count; i++) {
        const pel_tie *tie = &ties->items[i];
        double sum[3], n[3], excess, distance;
        if (tie->phase != PEL_TIE_HOLDING)
            continue;
        sum_unknowns(tie, unknowns, sum);
        if (stretch(sim, tie, time, sum, n, &excess, &distance))
            add_blocks(matrix, tie, n, excess / distance);
        else if (!(length_of(sim, tie, time) > 0))
            add_blocks(matrix, tie, (const double[3]){0, 0, 0}, 1);
    }
}

int32_t pel_ties_list_couplings(const pel_sim *sim, const int32_t (**vertices)[4])
{
    pel_ties *ties = sim->ties;
    int32_t count = 0;
    for (int32_t i = 0; ties != NULL && i < ties->count; i++)
        if (ties->items[i].phase == PEL_TIE_HOLDING && ties->items[i].count > 1)
            memcpy(ties->couplings[count++], ties->items[i].vertices, sizeof *ties->couplings);
    if (ties != NULL)
        *vertices = (const int32_t(*)[4])ties->couplings;
    return count;
}

/* ---- explicit ---- */

void pel_ties_apply(pel_sim *sim, double ratio)
{
    const pel_ties *ties = sim->ties;
    double time = pel_sim_time(sim);
    for (int32_t i = 0; ties != NULL && i < ties->count; i++) {
        const pel_tie *tie = &ties->items[i];
        double own[3];
        force_at(sim, tie, time, sim->state->position, own);
        for (int j = 0; j < tie->count; j++) {
            int32_t v = tie->vertices[j];
            double gain = pel_tool_mobility(sim, v) * sim->step.dt;
            for (int k = 0; k < 3; k++) {
                double change = gain * tie->weights[j] * own[k];
                sim->state->velocity_next[v][k] += (pel_real)change;
                sim->state->position_next[v][k] += (pel_real)(ratio * change);
            }
        }
    }
}

/* ---- projection ---- */

void pel_ties_begin_substep(pel_sim *sim, double middle, const pel_record *start)
{
    if (sim->ties == NULL)
        return;
    switch_ties(sim, middle, start);
    for (int32_t i = 0; i < sim->ties->count; i++)
        pel_vec3_set(sim->ties->items[i].multiplier, 0, 0, 0);
}

/* one of vertices of rigid bodies: along what is left */
static void project_rigid(pel_sim *sim, pel_tie *tie, double time, double tau, pel_record *positions)
{
    pel_rigid_sum sum;
    double n[3], excess, distance, left[3], way[3], compliance = 1 / (tie->stiffness * tau * tau);
    pel_rigid_sum_set(&sum, sim->rigids, tie->vertices, tie->weights, tie->count, positions);
    bool is_taut = stretch(sim, tie, time, sum.value, n, &excess, &distance);
    for (int k = 0; k < 3; k++)
        left[k] = (is_taut ? -excess * n[k] : 0) - compliance * tie->multiplier[k];
    pel_vec3_copy(left, way);
    if (!(pel_vec3_normalize(way) > 0))
        return;
    double free = pel_rigid_sum_mobility(&sum, way);
    if (!(free > 0))
        return;
    pel_vec3_scale(left, 1 / (free + compliance), left);
    pel_vec3_add(tie->multiplier, left, tie->multiplier);
    pel_rigid_sum_push(&sum, sim->rigids, positions, left);
}

static void project(pel_sim *sim, pel_tie *tie, double time, double tau, pel_record *positions)
{
    double sum[3], n[3], excess, distance, w = 0, compliance = 1 / (tie->stiffness * tau * tau);
    for (int j = 0; j < tie->count; j++)
        w += tie->weights[j] * tie->weights[j] * pel_tool_mobility(sim, tie->vertices[j]);
    sum_records(tie, positions, sum);
    bool is_taut = stretch(sim, tie, time, sum, n, &excess, &distance);
    if (!(w > 0))
        return;
    for (int k = 0; k < 3; k++) {
        /* a thread that is slack gives back what it has pulled in this substep */
        double change = ((is_taut ? -excess * n[k] : 0) - compliance * tie->multiplier[k]) / (w + compliance);
        tie->multiplier[k] += change;
        for (int j = 0; j < tie->count; j++) {
            int32_t v = tie->vertices[j];
            positions[v][k] += (pel_real)(change * tie->weights[j] * pel_tool_mobility(sim, v));
        }
    }
}

void pel_ties_project(pel_sim *sim, double time, double tau, pel_record *positions)
{
    for (int32_t i = 0; sim->ties != NULL && i < sim->ties->count; i++) {
        pel_tie *tie = &sim->ties->items[i];
        if (tie->phase != PEL_TIE_HOLDING)
            continue;
        if (pel_rigid_sum_is_asked(sim->rigids, tie->vertices, tie->weights, tie->count))
            project_rigid(sim, tie, time, tau, positions);
        else
            project(sim, tie, time, tau, positions);
    }
    pel_rigids_place(sim->rigids, positions);
}

void pel_ties_tally(pel_sim *sim, double tau, pel_record *reaction)
{
    for (int32_t i = 0; sim->ties != NULL && i < sim->ties->count; i++) {
        pel_tie *tie = &sim->ties->items[i];
        pel_vec3_along(tie->sum, 1 / (tau * tau), tie->multiplier, tie->sum);
        for (int j = 0; reaction != NULL && j < tie->count; j++) {
            if (pel_tool_mobility(sim, tie->vertices[j]) > 0)
                continue;
            for (int k = 0; k < 3; k++)
                reaction[tie->vertices[j]][k] += (pel_real)(tie->weights[j] * tie->multiplier[k] / (tau * tau));
        }
    }
}

/* ---- questions ---- */

bool pel_ties_hold(const pel_sim *sim, int32_t body)
{
    const pel_ties *ties = sim->ties;
    for (int32_t i = 0; ties != NULL && i < ties->count; i++) {
        const pel_tie *tie = &ties->items[i];
        bool begins = tie->phase == PEL_TIE_WAITING && !(ties->groups[tie->group].def.from > pel_sim_time(sim));
        for (int j = 0; j < tie->count && (begins || tie->phase == PEL_TIE_HOLDING); j++)
            if (sim->model->body_of_slice[tie->vertices[j] / PEL_WIDTH] == body)
                return true;
    }
    return false;
}

int32_t pel_sim_tie_count(const pel_sim *sim)
{
    return sim != NULL && sim->ties != NULL ? sim->ties->group_count : 0;
}

const char *pel_sim_tie_name(const pel_sim *sim, int32_t tie)
{
    return tie >= 0 && tie < pel_sim_tie_count(sim) ? sim->ties->groups[tie].name : "";
}

void pel_sim_get_tie(const pel_sim *sim, int32_t tie, pel_tie_reading *reading)
{
    if (reading == NULL || tie < 0 || tie >= pel_sim_tie_count(sim))
        return;
    const pel_tie_group *group = &sim->ties->groups[tie];
    *reading = (pel_tie_reading){
        .lost_count = group->lost_count, .lost_time = group->lost_time, .lost_force = group->lost_force};
    for (int32_t i = group->first; i < group->first + group->count; i++) {
        const pel_tie *item = &sim->ties->items[i];
        double sum[3], place[3];
        pel_vec3_add(reading->force, item->force, reading->force);
        reading->largest = pel_max(reading->largest, pel_vec3_length(item->force));
        if (item->phase != PEL_TIE_HOLDING)
            continue;
        sum_records(item, sim->state->position, sum);
        place_of(sim, item, pel_sim_time(sim), place);
        reading->longest = pel_max(reading->longest, pel_vec3_distance(sum, place));
        reading->held_count++;
    }
}

/* ---- snapshots ---- */

void pel_ties_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_ties *ties = sim->ties;
    for (int32_t g = 0; ties != NULL && g < ties->group_count; g++) {
        pel_transfer(at, &ties->groups[g].lost_count, sizeof ties->groups[g].lost_count);
        pel_transfer(at, &ties->groups[g].lost_time, sizeof ties->groups[g].lost_time);
        pel_transfer(at, &ties->groups[g].lost_force, sizeof ties->groups[g].lost_force);
    }
    for (int32_t i = 0; ties != NULL && i < ties->count; i++) {
        pel_tie *tie = &ties->items[i];
        pel_transfer(at, tie->place, sizeof *tie - offsetof(pel_tie, place));
        if (at->load && (tie->phase < PEL_TIE_WAITING || tie->phase > PEL_TIE_OPEN))
            tie->phase = PEL_TIE_OPEN;
    }
}

pel_status pel_ties_refuse(const char *what, pel_error *error)
{
    return pel_refuse(error, PEL_BAD_ARGUMENT, "leave attachments and stitches out",
                      "%s does not support attachments and stitches", what);
}
