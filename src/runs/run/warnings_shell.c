/* Rows of vertices that are hinges, pressures beyond the largest, loads and modes that a mesh is too coarse for
   (choice/mode_wave.h).

   Hinges. Pinned vertices hold positions, not rotations. If all held vertices of a body lie on a line, the body turns
   about it. That is meant for a door, and does not matter for cloth, which its own stiffness could not hold up either.
   It is told where a clamp could: with the moment M of the loads about the row, its length w, the length L of the body
   across it and the bending stiffness D, a clamped strip sags by s = M L / (3 D w) of its length (a force at its end;
   3/4 of that under its weight). Told where s < 1. A body that hangs from the row turns back by its weight, as a
   pendulum or a sign does: there only loads count that turn it farther than its weight can hold. Two rows clamp no
   edge either: the body bends as if it began half a cell behind the inner one, with the depth c of the cells by
   3 c / (2 L) too far (measured 17, 8.3, 4.7 % for c / L = 1/9, 1/19, 1/39).

   Loads on few vertices. Under a force P normal to a plate with the bending stiffness D, elements with edges e give a
   deflection under the force that is too large by POINT_ERROR P e^2 / D: measured on a clamped disc with edges of 1/4,
   1/8, 1/16 of its radius, 0.104, 0.131, 0.159. On a sphere with edges of 0.72, 0.36, 0.18, 0.12 sqrt(R h) the errors
   are 0.22, 0.45, 0.7, 1 of that. Over a region of radius r the error falls by 1 + (r / e)^2. It is compared with the
   displacement. Where the shell carries the load by tension, as a drum does, bending has less than the half of the
   energy that it has on a sphere, and the error falls by the square: loads on drums are within 1 to 3 %. */
#include "run/warnings_shell.h"

#include "base/memory.h"
#include "base/status.h"
#include "boundary/hold.h"
#include "boundary/loads.h"
#include "choice/time_step.h"
#include "force/pressure.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "minimise/step_modes.h"
#include "model/shell.h"
#include "pellicle/sim_surface.h"
#include "run/state.h"
#include "scene/build.h"
#include "stage/shells.h"
#include "stage/stepper.h"
#include "tool/tool.h"

#include <stdio.h>

/* of the size, that held vertices may be beside the line of a row */
#define ROW_WIDTH 1e-4
/* of its length, that a clamped body would sag by */
#define MOST_SAG 1.0
/* of all moments of single vertices, that is rounding */
#define LEAST_MOMENT 1e-6
/* volume of a round body over that at the largest pressure */
#define JUMP 1.5
/* cosine of the largest angle between gravity and the way from the row to the center of mass of a body that hangs */
#define LEAST_HANG 0.5
/* share of the deflection, by the cells of two rows */
#define CELL_ERROR 1.5
/* more than that are held for another reason */
#define MOST_CELLS 0.4
#define POINT_ERROR 0.15
#define MOST_ERROR 0.03
#define GOOD_ERROR 0.02
/* deflection that is too large, over what jumps of curvature tell: 0.9 on plates of 8 to 24 cells on supports, 1.1 to
   1.6 where they are clamped (docs/statics.md) */
#define BENDING_TIMES 1.4
#define MOST_BENDING 0.05
/* of the energy supplied, that moves in a frame; larger meshes are fine enough for their slowest vibration */
#define MOVING_SHARE 0.02
/* frequency of a clamped beam over sqrt(D w / (m L^3)), and the share of it below which a body turns about a row */
#define BEAM 0.5596
#define SLACK 0.1
/* edges in a wave for a frequency within about 2 %, over those within 5 % */
#define FINE 1.8
enum { MOST_COARSE_TRIANGLES = 2000 };
#define PI 3.14159265358979323846

static bool bends(const pel_run_state *run, int32_t b)
{
    const pel_shell *shell = run->sim->model->bodies[b].shell;
    return shell != NULL && shell->has_membrane && pel_bending_is_on(shell->bending) && shell->hinge_stiffness > 0 &&
           pel_stepper_knows_material(pel_stepper_of(run->scene->sim.solver.method));
}

/* ---- rows ---- */

/* the held vertices of a body: ends of their line */
typedef struct held_row {
    const pel_run_state *run;
    int32_t body, first, end; /* places of the body */
    uint8_t *held;            /* (places) */
    double start[3], axis[3], length;
} held_row;

static void rest_of(const held_row *row, int32_t place, double x[3])
{
    pel_vertex_position(row->run->sim->model->rest, place, x);
}

/* distance from the line of the row, and the arm there */
static double arm_of(const held_row *row, int32_t place, double arm[3])
{
    rest_of(row, place, arm);
    pel_vec3_subtract(arm, row->start, arm);
    pel_vec3_along(arm, -pel_vec3_dot(arm, row->axis), row->axis, arm);
    return pel_vec3_length(arm);
}

static void mark_held(held_row *row)
{
    const pel_sim *sim = row->run->sim;
    for (int32_t v = row->first; v < row->end; v++)
        row->held[v - row->first] = sim->model->mesh_vertex[v] >= 0 && !(sim->model->inverse_mass[v] > 0);
    for (int32_t i = 0; sim->holds != NULL && i < sim->holds->held_count; i++) {
        int32_t v = sim->holds->held[i].vertex;
        if (v >= row->first && v < row->end)
            row->held[v - row->first] = 1;
    }
    for (int32_t i = 0; sim->holds != NULL && i < sim->holds->spring_count; i++) {
        int32_t v = sim->holds->springs[i].vertex;
        if (v >= row->first && v < row->end)
            row->held[v - row->first] = 1;
    }
}

/* all held vertices are on one line, with an edge between two of them */
static bool find_row(held_row *row)
{
    const pel_model *model = row->run->sim->model;
    double size = model->bodies[row->body].diameter, x[3];
    int32_t first = -1;
    for (int32_t v = row->first; v < row->end; v++) {
        if (!row->held[v - row->first])
            continue;
        if (first < 0) {
            rest_of(row, v, row->start);
            first = v;
        }
        rest_of(row, v, x);
        pel_vec3_subtract(x, row->start, x);
        double length = pel_vec3_length(x);
        if (length > row->length) {
            row->length = length;
            pel_vec3_scale(x, 1 / length, row->axis);
        }
    }
    for (int32_t v = row->first; v < row->end; v++)
        if (row->held[v - row->first] && arm_of(row, v, x) > ROW_WIDTH * size)
            return false;
    const pel_shell *shell = model->bodies[row->body].shell;
    for (int32_t t = 0; row->length > 0 && t < shell->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            if (row->held[shell->corners[t][i] - row->first] && row->held[shell->corners[t][(i + 1) % 3] - row->first])
                return true;
    return false;
}

/* something else may hold it: clamps, grasps, volumetric springs */
static bool is_held_otherwise(const pel_run_state *run, int32_t b)
{
    const pel_sim *sim = run->sim;
    bool is_held = sim->model->bodies[b].has_volumetric;
    for (int32_t h = 0; sim->holds != NULL && h < sim->holds->hold_count; h++)
        is_held |= sim->holds->holds[h].body == b && sim->holds->holds[h].fixes_rotation;
    for (int32_t t = 0; t < run->scene->sim.tool_count; t++) {
        const pel_tool_def *tool = &run->scene->sim.tools[t];
        is_held |= tool->grasp && (tool->body == b || tool->body < 0);
    }
    return is_held;
}

/* adds the moment of a force about the row to a sum, and its size to another */
static void add_moment(const held_row *row, int32_t place, const double force[3], double moment[2])
{
    double arm[3], turned[3];
    double length = arm_of(row, place, arm);
    pel_vec3_cross(arm, force, turned);
    moment[0] += pel_vec3_dot(turned, row->axis);
    moment[1] += length * pel_vec3_length(force);
}

static double size_of_moment(const double moment[2])
{
    return fabs(moment[0]) > LEAST_MOMENT * moment[1] ? fabs(moment[0]) : 0;
}

/* N m about the row that the weight makes; below 0: of a body that hangs from it, the most that its weight holds */
static double find_weight_moment(const held_row *row)
{
    const pel_model *model = row->run->sim->model;
    double weight[2] = {0}, center[3] = {0}, gravity[3], mass = 0;
    for (int32_t v = row->first; v < row->end; v++) {
        double force[3], arm[3];
        if (!(model->inverse_mass[v] > 0))
            continue;
        double own = 1 / (double)model->inverse_mass[v];
        pel_vec3_scale(row->run->scene->model.gravity, own, force);
        add_moment(row, v, force, weight);
        arm_of(row, v, arm);
        pel_vec3_along(center, own, arm, center);
        mass += own;
    }
    pel_vec3_copy(row->run->scene->model.gravity, gravity);
    pel_vec3_along(gravity, -pel_vec3_dot(gravity, row->axis), row->axis, gravity);
    double most = pel_vec3_length(center) * pel_vec3_length(gravity), along = pel_vec3_dot(center, gravity);
    bool hangs = mass > 0 && along > LEAST_HANG * most;
    return hangs ? -most : size_of_moment(weight);
}

/* N m about the row: of the weight, of each load and of the pressure, as if all turned it the same way */
static double find_moment(const held_row *row)
{
    const pel_sim *sim = row->run->sim;
    const pel_model *model = sim->model;
    const pel_body_def *def = &row->run->scene->model.bodies[row->body];
    double pressure[2] = {0}, sum = find_weight_moment(row);
    for (int32_t l = 0; l < sim->loads->count; l++) {
        const pel_load *load = &sim->loads->items[l];
        double own[2] = {0};
        for (int32_t i = 0; load->body == row->body && i < load->vertex_count; i++) {
            double force[3];
            pel_vec3_scale(load->force, load->weights[i], force);
            add_moment(row, load->vertices[i], force, own);
        }
        sum += size_of_moment(own);
    }
    for (int32_t t = 0; t < model->bodies[row->body].shell->triangle_count; t++) {
        const int32_t *corners = model->bodies[row->body].shell->corners[t];
        double x[3][3], force[3];
        for (int i = 0; i < 3; i++)
            rest_of(row, corners[i], x[i]);
        pel_vec3_triangle_normal(x[0], x[1], x[2], force);
        pel_vec3_scale(force, def->shell.pressure.outside.value / 6, force);
        for (int i = 0; i < 3; i++)
            add_moment(row, corners[i], force, pressure);
    }
    return sum + size_of_moment(pressure);
}

/* Sides between held vertices, of triangles with a free one: if they lie on a line it becomes that of the row, and the
   distance of the held vertices next to it is returned, else 0. */
static double find_cells(held_row *row)
{
    const pel_shell *shell = row->run->sim->model->bodies[row->body].shell;
    const double size = row->run->sim->model->bodies[row->body].diameter;
    double depth = HUGE_VAL, arm[3], x[2][3];
    int32_t count = 0;
    row->length = 0;
    for (int32_t t = 0; t < shell->triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            const int32_t *v = shell->corners[t], a = v[i], b = v[(i + 1) % 3], c = v[(i + 2) % 3];
            if (!row->held[a - row->first] || !row->held[b - row->first] || row->held[c - row->first])
                continue;
            rest_of(row, a, x[0]);
            rest_of(row, b, x[1]);
            if (count++ == 0) {
                pel_vec3_copy(x[0], row->start);
                pel_vec3_subtract(x[1], x[0], row->axis);
                pel_vec3_normalize(row->axis);
            }
            row->length += pel_vec3_distance(x[0], x[1]);
            if (arm_of(row, a, arm) > ROW_WIDTH * size || arm_of(row, b, arm) > ROW_WIDTH * size)
                return 0;
        }
    for (int32_t v = row->first; count > 0 && v < row->end; v++)
        if (row->held[v - row->first] && arm_of(row, v, arm) > ROW_WIDTH * size)
            depth = pel_min(depth, pel_vec3_length(arm));
    return depth < HUGE_VAL ? depth : 0;
}

/* of analyses once: a resumed one has counted it, and finds here what it is about */
static void warn_of_row(pel_run_state *run, const held_row *row, double error)
{
    pel_flagged_body *flagged = &run->flagged[PEL_WARN_HINGE_ROW];
    if (!(flagged->value > 0))
        *flagged = (pel_flagged_body){row->body, row->length, error};
    if (run->sim->modes == NULL || run->totals.warnings.of[PEL_WARN_HINGE_ROW].count == 0)
        pel_warn(&run->totals.warnings, PEL_WARN_HINGE_ROW, 0, row->length);
}

static void tell_row(pel_run_state *run, held_row *row, double depth)
{
    const pel_model *model = run->sim->model;
    double arm[3], across = 0, mass = 0, stiffness = model->bodies[row->body].shell->hinge_stiffness;
    for (int32_t v = row->first; v < row->end; v++) {
        bool is_free = model->mesh_vertex[v] >= 0 && !row->held[v - row->first];
        across = is_free ? pel_max(across, arm_of(row, v, arm)) : across;
        mass += (double)model->mass[v];
    }
    const double error = across > 0 ? CELL_ERROR * depth / across : 0, moment = find_moment(row);
    if (!(across > 0) || (depth > 0 && !(error > MOST_ERROR && error < MOST_CELLS)))
        return;
    bool bends = moment > 0 && moment * across < MOST_SAG * 3 * stiffness * row->length;
    if (run->sim->modes != NULL)
        bends = depth > 0 || run->sim->modes->values[0] <
                                 SLACK * BEAM * sqrt(stiffness * row->length / (mass * across * across * across));
    if (bends)
        warn_of_row(run, row, error);
}

static void check_row(pel_run_state *run, held_row *row)
{
    mark_held(row);
    const bool is_one = find_row(row);
    /* hinges do not turn edges */
    const bool turns = run->sim->model->bodies[row->body].shell->bending->turns_edges;
    const double depth = !is_one && turns ? find_cells(row) : 0;
    if (is_one || depth > 0)
        tell_row(run, row, depth);
}

pel_status pel_warnings_check_rows(pel_run_state *run, pel_error *error)
{
    const pel_model *model = run->sim->model;
    for (int32_t b = 0; b < model->body_count; b++) {
        held_row row = {.run = run, .body = b, .first = model->bodies[b].slice_begin * PEL_WIDTH};
        if (!bends(run, b) || is_held_otherwise(run, b))
            continue;
        row.end = pel_body_place_end(model, b);
        row.held = pel_allocate((size_t)(row.end - row.first), sizeof *row.held);
        if (row.held == NULL)
            return pel_fail_memory(error);
        check_row(run, &row);
        pel_free(row.held);
    }
    return PEL_OK;
}

void pel_warnings_tell_row(const pel_run_state *run, char *text, size_t size)
{
    const pel_flagged_body *flagged = &run->flagged[PEL_WARN_HINGE_ROW];
    const char *name = run->scene->model.bodies[flagged->body].name;
    if (flagged->limit > 0)
        snprintf(text, size,
                 "body '%s' is held by two rows of vertices, which clamp it half a cell behind the inner one: it bends "
                 "about %.2g %% too far, and vibrates about %.2g %% too slowly. use supports: [ { at: ..., rotation: "
                 "fixed } ] on the inner row under static "
                 "and implicit, or finer cells there",
                 name, 100 * flagged->limit, 200.0 / 3 * flagged->limit);
    else
        snprintf(text, size,
                 "body '%s' is held along one row of vertices, and turns about it as on a hinge. to clamp it, use "
                 "supports: [ { at: ..., rotation: fixed } ] under static and implicit, or pin a second row close to "
                 "the first",
                 name);
}

/* ---- pressures ---- */

/* The given pressure exceeds the largest, or the body went far beyond where it is the largest: by its area, as a body
   that only unfolds multiplies its volume too. */
void pel_warnings_check_pressures(pel_run_state *run, int64_t frame)
{
    const pel_model *model = run->sim->model;
    const pel_solver_def *solver = &run->scene->sim.solver;
    bool is_judged = solver->path != PEL_PATH_ARC_LENGTH && solver->analysis == PEL_ANALYSIS_NONE &&
                     pel_stepper_knows_material(pel_stepper_of(solver->method)) &&
                     run->totals.warnings.of[PEL_WARN_LARGEST_PRESSURE].count == 0;
    for (int32_t b = 0; is_judged && b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b];
        double ratio, largest = pel_pressure_peak(model, b, &ratio);
        double given = body->shell != NULL ? pel_pressure_given(body->shell) : 0;
        const double square = (JUMP * ratio) * (JUMP * ratio);
        bool is_beyond = given > largest;
        const double growth = pel_body_area(model, b, run->sim->state->position) / body->rest_area;
        if (frame > 0 && given > 0 && isfinite(largest))
            is_beyond |= growth * growth * growth > square;
        if (!is_beyond)
            continue;
        if (run->totals.warnings.of[PEL_WARN_LARGEST_PRESSURE].count == 0)
            run->flagged[PEL_WARN_LARGEST_PRESSURE] = (pel_flagged_body){b, given, largest};
        pel_warn(&run->totals.warnings, PEL_WARN_LARGEST_PRESSURE, frame, given);
    }
}

void pel_warnings_tell_pressure(const pel_run_state *run, char *text, size_t size)
{
    static const char *const remedy =
        "use less, prescribe the volume (pressure: { volume: ... }), or follow the equilibria (solver: { path: "
        "arc-length })";
    const pel_flagged_body *flagged = &run->flagged[PEL_WARN_LARGEST_PRESSURE];
    const char *name = run->scene->model.bodies[flagged->body].name;
    double ratio;
    bool has_end = pel_pressure_largest(run->model, flagged->body, &ratio) <= flagged->value;
    pel_pressure_peak(run->model, flagged->body, &ratio);
    if (flagged->value > flagged->limit)
        snprintf(text, size,
                 "the pressure in body '%s' is up to %.4g Pa, but the largest that it balances is about %.4g Pa, at "
                 "%.3g times its volume: beyond it %s. %s",
                 name, flagged->value, flagged->limit, ratio,
                 has_end ? "grows without bound" : "jumps to a far larger size", remedy);
    else
        snprintf(
            text, size,
            "body '%s' jumped to a far larger size: %.4g Pa is near the largest pressure that it balances, %.4g Pa "
            "if it were round, at %.3g times its volume, and less where it is wider or if the pressure acts at "
            "once. let it grow in time (inside: { keys: [[0, 0], [1, %.4g]] }), %s",
            name, flagged->value, flagged->limit, ratio, flagged->value, remedy);
}

/* ---- modes ---- */

void pel_warnings_check_mode(pel_run_state *run)
{
    const pel_sim *sim = run->sim;
    if (sim->modes == NULL || !sim->modes->is_solved || sim->modes->count == 0)
        return;
    int32_t number = (int32_t)((sim->state->step - 1) % sim->modes->count);
    if (run->scene->sim.solver.analysis == PEL_ANALYSIS_MODAL)
        pel_warnings_check_rows(run, NULL);
    pel_flagged_body *flagged = &run->flagged[PEL_WARN_COARSE_MODE];
    const bool buckles = run->scene->sim.solver.analysis == PEL_ANALYSIS_BUCKLING;
    pel_mode_wave wave = {0};
    /* after a resume with those before, for the first one */
    const bool is_told = flagged->limit > 0 || run->totals.warnings.of[PEL_WARN_COARSE_MODE].count == 0;
    for (int32_t i = is_told ? number : 0; i <= number; i++) {
        wave = pel_mode_wave_of(sim, pel_modes_vector(sim->modes->modes, i), sim->modes->values[i], buckles);
        if (wave.edges < wave.least && !(flagged->limit > 0))
            *flagged = (pel_flagged_body){i, wave.edges, wave.least};
    }
    if (wave.edges < wave.least)
        pel_warn(&run->totals.warnings, PEL_WARN_COARSE_MODE, run->totals.frame_count, -wave.edges);
}

/* held somewhere, so that what moves in it vibrates */
static bool is_held(const pel_scene *scene, int32_t b)
{
    bool any = scene->model.bodies[b].pinned_count > 0;
    for (int32_t s = 0; s < scene->sim.support_count; s++)
        any |= scene->sim.supports[s].body == b;
    for (int32_t t = 0; t < scene->sim.tool_count; t++)
        any |= scene->sim.tools[t].shape == PEL_TOOL_SUPPORT && scene->sim.tools[t].body == b;
    return any;
}

/* nothing presses a body */
static bool is_free(const pel_scene *scene)
{
    bool any = !scene->sim.contact.enabled || scene->contact_is_implied;
    for (int32_t t = 0; t < scene->sim.tool_count; t++)
        any &= scene->sim.tools[t].shape == PEL_TOOL_SUPPORT;
    return any;
}

/* whether what moves goes on for ever, and nothing presses it */
static bool swings(const pel_run_state *run)
{
    const pel_scene *scene = run->scene;
    const pel_stepper *stepper = pel_stepper_of(scene->sim.solver.method);
    return stepper->has_velocity && pel_stepper_knows_material(stepper) && pel_scene_is_undamped(scene) &&
           is_free(scene) && run->totals.most_kinetic > MOVING_SHARE * run->ledger.supplied;
}

/* The slowest vibration of a body that swings by its stiffness, not by its weight. */
void pel_warnings_check_vibrations(pel_run_state *run)
{
    const pel_scene *scene = run->scene;
    for (int32_t b = 0; b < scene->model.body_count && swings(run); b++) {
        const pel_body *body = &run->sim->model->bodies[b];
        pel_vibration lowest;
        if (body->shell == NULL || !body->shell->has_membrane || body->mesh->triangle_count > MOST_COARSE_TRIANGLES ||
            !is_held(scene, b) || pel_scene_find_vibration(scene, b, &lowest) != PEL_OK)
            continue;
        const double weight = sqrt(pel_vec3_length(scene->model.gravity) / body->diameter);
        if (!(lowest.wave.edges < FINE * lowest.wave.least) || !(PI * lowest.frequency > weight))
            continue;
        if (run->totals.warnings.of[PEL_WARN_COARSE_MODE].count == 0)
            run->flagged[PEL_WARN_COARSE_MODE] = (pel_flagged_body){b, lowest.wave.edges, FINE * lowest.wave.least};
        pel_warn(&run->totals.warnings, PEL_WARN_COARSE_MODE, run->totals.frame_count - 1, -lowest.wave.edges);
    }
}

void pel_warnings_tell_mode(const pel_run_state *run, char *text, size_t size)
{
    const pel_flagged_body *flagged = &run->flagged[PEL_WARN_COARSE_MODE];
    const pel_analysis analysis = run->scene->sim.solver.analysis;
    const double levels = pel_max(ceil(pel_log2(flagged->limit / flagged->value)), 1);
    bool is_filled = run->scene->model.body_count > 0 && run->scene->model.bodies[0].volume.on;
    char remedy[80], mode[PEL_NAME_SIZE + 40];
    if (is_filled)
        snprintf(remedy, sizeof remedy, "use a volume.edge smaller by a factor of %.0f", ldexp(1, (int)levels));
    else
        snprintf(remedy, sizeof remedy, "subdivide the mesh (pellicle subdivide -n %.0f)", levels);
    if (analysis != PEL_ANALYSIS_NONE)
        snprintf(mode, sizeof mode, "mode %d", (int)flagged->body + 1);
    else
        snprintf(mode, sizeof mode, "the slowest vibration of body '%s'", run->scene->model.bodies[flagged->body].name);
    snprintf(text, size,
             "the mesh is too coarse for %s: its waves are %.2g edges long, and %s from fewer than %.2g are too low "
             "by more than %s %%. %s",
             mode, flagged->value, analysis == PEL_ANALYSIS_BUCKLING ? "load factors" : "frequencies", flagged->limit,
             analysis == PEL_ANALYSIS_NONE ? "about 2" : "5", remedy);
}

/* ---- loads ---- */

/* how a load acts on a shell: the vertex with most of it, the edges there, its radius around it */
typedef struct load_spot {
    int32_t vertex;
    double normal[3], edge, radius, displacement[3];
} load_spot;

static int32_t heaviest_of(const pel_load *load)
{
    int32_t heaviest = 0;
    for (int32_t i = 1; i < load->vertex_count; i++)
        if (load->weights[i] > load->weights[heaviest])
            heaviest = i;
    return load->vertices[heaviest];
}

static load_spot find_spot(const pel_sim *sim, const pel_load *load)
{
    load_spot spot = {.vertex = heaviest_of(load)};
    const pel_shell *shell = sim->model->bodies[load->body].shell;
    double x[3][3], normal[3], center[3] = {0, 0, 0}, sum = 0, weights = 0, at[3];
    int32_t count = 0;
    pel_vertex_position(sim->model->rest, spot.vertex, at);
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        const int32_t *v = shell->corners[t];
        if (v[0] != spot.vertex && v[1] != spot.vertex && v[2] != spot.vertex)
            continue;
        for (int i = 0; i < 3; i++)
            pel_vertex_position(sim->model->rest, v[i], x[i]);
        pel_vec3_triangle_normal(x[0], x[1], x[2], normal);
        pel_vec3_add(spot.normal, normal, spot.normal);
        for (int i = 0; i < 3; i++, count++)
            spot.edge += pel_vec3_distance(x[i], x[(i + 1) % 3]);
    }
    spot.edge /= pel_max(count, 1);
    pel_vec3_normalize(spot.normal);
    for (int32_t i = 0; i < load->vertex_count; i++) {
        pel_vertex_position(sim->model->rest, load->vertices[i], x[0]);
        pel_vec3_along(center, load->weights[i], x[0], center);
        weights += load->weights[i];
    }
    pel_vec3_scale(center, weights > 0 ? 1 / weights : 0, center);
    for (int32_t i = 0; i < load->vertex_count; i++) {
        pel_vertex_position(sim->model->rest, load->vertices[i], x[0]);
        sum += load->weights[i] * pel_vec3_distance(x[0], center) * pel_vec3_distance(x[0], center);
    }
    /* of a disc the mean square is half that of its radius */
    spot.radius = weights > 0 ? sqrt(2 * sum / weights) : 0;
    pel_vertex_position(sim->state->position, spot.vertex, x[0]);
    pel_vec3_subtract(x[0], at, spot.displacement);
    return spot;
}

/* of the displacement under the load; 0 where nothing is known */
static double error_of(const pel_run_state *run, const pel_load *load, const load_spot *spot)
{
    const pel_sim *sim = run->sim;
    double force = 0, stiffness = sim->model->bodies[load->body].shell->hinge_stiffness;
    for (int32_t i = 0; i < load->vertex_count; i++)
        force += load->weights[i] * fabs(pel_vec3_dot(load->force, spot->normal));
    bool rests = pel_stepper_of(run->scene->sim.solver.method)->is_static;
    double way = rests ? fabs(pel_vec3_dot(spot->displacement, spot->normal)) : run->measures.max_displacement;
    double share = spot->radius / spot->edge, bending = run->measures.bending_energy;
    double both = bending + run->measures.membrane_energy, bends = both > 0 ? pel_min(2 * bending / both, 1) : 1;
    double error = bends * bends * POINT_ERROR * force * spot->edge * spot->edge / stiffness / (1 + share * share);
    return way > 0 ? error / way : 0;
}

void pel_warnings_check_loads(pel_run_state *run)
{
    const pel_sim *sim = run->sim;
    for (int32_t l = 0; l < sim->loads->count && sim->modes == NULL; l++) {
        const pel_load *load = &sim->loads->items[l];
        bool is_force = load->kind == PEL_LOAD_TOTAL || load->kind == PEL_LOAD_PER_VERTEX;
        bool is_local = load->vertex_count > 0 && load->vertex_count < pel_sim_vertex_count(sim, load->body);
        if (!is_force || !is_local || !bends(run, load->body))
            continue;
        const load_spot spot = find_spot(sim, load);
        double error = error_of(run, load, &spot);
        if (!(error > MOST_ERROR))
            continue;
        if (run->totals.warnings.of[PEL_WARN_COARSE_LOAD].count == 0)
            run->flagged[PEL_WARN_COARSE_LOAD] = (pel_flagged_body){l, spot.edge, spot.edge * sqrt(GOOD_ERROR / error)};
        pel_warn(&run->totals.warnings, PEL_WARN_COARSE_LOAD, run->totals.frame_count - 1, error);
    }
}

void pel_warnings_check_bending(pel_run_state *run, int64_t frame)
{
    const pel_sim *sim = run->sim;
    const bool rests = pel_stepper_of(run->scene->sim.solver.method)->is_static && sim->modes == NULL;
    const double bending = run->measures.bending_energy, both = bending + run->measures.membrane_energy;
    if (!rests || !is_free(run->scene) || run->totals.warnings.of[PEL_WARN_COARSE_LOAD].count > 0)
        return;
    for (int32_t b = 0; b < sim->model->body_count && bending > 0; b++) {
        const double error = BENDING_TIMES * bending / both * pel_sim_bending_error(sim, b);
        if (!(error > MOST_BENDING))
            continue;
        const double edge = sim->model->bodies[b].shell->mean_edge;
        if (run->totals.warnings.of[PEL_WARN_COARSE_BENDING].count == 0)
            run->flagged[PEL_WARN_COARSE_BENDING] = (pel_flagged_body){b, edge, edge * sqrt(GOOD_ERROR / error)};
        pel_warn(&run->totals.warnings, PEL_WARN_COARSE_BENDING, frame, error);
    }
}

void pel_tell_coarse_bending(const pel_warning_text *at)
{
    const pel_flagged_body *flagged = &at->run->flagged[PEL_WARN_COARSE_BENDING];
    const double share = flagged->value / flagged->limit, error = pel_min(GOOD_ERROR * share * share, MOST_CELLS);
    snprintf(at->text, at->size,
             "the mesh of body '%s' is too coarse for how it bends: it gives way by about %.2g %% too much. use edges "
             "of about %.2g m, in place of %.2g m (pellicle subdivide -n %.0f)",
             at->run->scene->model.bodies[flagged->body].name, 100 * error / (1 - error), flagged->limit,
             flagged->value, pel_max(ceil(pel_log2(share)), 1));
}

void pel_warnings_tell_load(const pel_run_state *run, char *text, size_t size)
{
    const pel_flagged_body *flagged = &run->flagged[PEL_WARN_COARSE_LOAD];
    bool is_known = flagged->body < run->sim->loads->count;
    const pel_load *load = is_known ? &run->sim->loads->items[flagged->body] : NULL;
    bool can_refine =
        is_known && !run->scene->model.bodies[load->body].volume.on && !pel_scene_is_fine(run->scene, load->body);
    snprintf(text, size,
             "the edges of body '%s' are %.2g m long under load '%s', too long for so small a load: the dent is too "
             "deep. %s%s%sedges of about %.2g m there, or distribute the load over a larger region",
             is_known ? run->sim->model->bodies[load->body].name : "", flagged->value, is_known ? load->name : "",
             can_refine ? "use bodies." : "use ", can_refine ? run->sim->model->bodies[load->body].name : "",
             can_refine ? ".refine=auto, or " : "", flagged->limit);
}
