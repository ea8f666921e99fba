/* The cost of a step is estimated from counts, so that a scene has the same method on all machines: processor time of
   one core per triangle, measured on balls and sheets of 320 to 20,480 triangles, with contact on things that press
   against each other (docs/solvers.md, cost of a step). A step of implicit grows faster than the triangles, with the
   fill of its factor: with tetrahedra by their square (19, 90, 900 ms of 6,768, 18,432, 52,128). */
#include "choice/method.h"

#include "base/number.h"
#include "base/status.h"
#include "choice/time_step.h"
#include "def/row.h"
#include "keys/arena.h"
#include "math/bounds.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "model/model.h"
#include "model/quantity.h"
#include "model/shell.h"
#include "stage/stepper.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool needs_projection(const pel_model *model)
{
    bool needs = false;
    for (int32_t b = 0; b < model->body_count; b++)
        needs |= pel_shell_needs_projection(model->bodies[b].shell);
    return needs;
}

bool pel_scene_has_balls(const pel_scene *scene)
{
    bool any = false;
    for (int32_t b = 0; b < scene->model.body_count; b++)
        any |= scene->model.bodies[b].rigid.on && scene->model.bodies[b].rigid.sphere;
    return any;
}

static bool refines(const pel_model *model)
{
    bool any = false;
    for (int32_t b = 0; b < model->body_count; b++)
        any |= model->bodies[b].detail != NULL;
    return any;
}

/* ms of one core: a substep of xpbd; a step of implicit as it may be where bodies jam or crumple, as it is for most,
   and as it is where its systems settle at once; that up to which xpbd is taken */
typedef struct step_cost {
    double substep, implicit, usual, system, choice;
} step_cost;

/* s of one core: a run of implicit that takes longer in default steps is left to xpbd; one that takes longer is told */
#define MOST_RUN 1
#define LONG_RUN 30
/* ms of a substep of xpbd, of a tetrahedron; of a system of implicit or static, with so many of them */
#define SOLID_SUBSTEP 100e-6
#define SOLID_SYSTEM 900.0
#define SOLID_TETRAHEDRA 52128.0
/* the same of smooth elements, over that */
#define SMOOTH_SYSTEM 4

/* of the diagonal: sheets that bend under their weight over less of it hang and flutter without any stiffness */
#define LIMP 0.1
/* of the area */
#define FLAT 0.5

typedef enum sheet_kind { NO_SHEETS, SHEETS, LIMP_SHEETS } sheet_kind;

/* m: the length (D / weight per area)^(1/3) over that a sheet bends under its weight; infinite where nothing weighs it
 */
static double bending_length(const pel_scene *scene, const pel_body_def *def)
{
    const pel_membrane_def *membrane = &def->shell.membrane;
    int32_t count = def->mesh->vertex_count;
    double thickness = pel_quantity_mean(&membrane->thickness, count), given = def->shell.bending.stiffness.value;
    double young = pel_quantity_mean(&membrane->young, count), poisson = membrane->poisson;
    double plate = young * thickness * thickness * thickness / (12 * (1 - poisson * poisson));
    double weight = def->mass * pel_quantity_mean(&def->thickness, count) * pel_vec3_length(scene->model.gravity);
    double rigidity = given < 0 || def->shell.bending.stiffness.field != NULL ? plate : given;
    return def->mass_kind == PEL_MASS_DENSITY && weight > 0 ? pel_pow(rigidity / weight, 1.0 / 3) : (double)HUGE_VAL;
}

/* by its vector area, which of a closed surface is 0 */
static bool is_flat(const pel_mesh *mesh)
{
    double sum[3] = {0}, area = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        double normal[3];
        pel_vec3_triangle_normal(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]], normal);
        pel_vec3_add(sum, normal, sum);
        area += pel_vec3_length(normal);
    }
    return pel_vec3_length(sum) > FLAT * area;
}

/* whether all bodies are sheets with a membrane that start nearly flat, and limp */
static sheet_kind sheets_of(const pel_scene *scene)
{
    sheet_kind kind = LIMP_SHEETS;
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        const pel_body_def *def = &scene->model.bodies[b];
        double low[3], high[3];
        if (!def->shell.membrane.on || def->rigid.on || def->volume.on || !is_flat(def->mesh))
            return NO_SHEETS;
        pel_bounds_clear(low, high);
        for (int32_t v = 0; v < def->mesh->vertex_count; v++)
            pel_bounds_add(low, high, def->mesh->positions[v]);
        if (!(bending_length(scene, def) < LIMP * pel_vec3_distance(low, high)))
            kind = SHEETS;
    }
    return scene->model.body_count > 0 ? kind : NO_SHEETS;
}

static step_cost cost_of(const pel_scene *scene, bool touches)
{
    enum { FREE, TOOLS, CONTACT };
    /* of a triangle */
    static const double substep[] = {50e-6, 63e-6, 160e-6}, implicit[] = {5e-3, 17e-3, 250e-3};
    static const double usual[] = {5e-3, 17e-3, 30e-3};
    /* of sheets that nothing touches: they crumple */
    static const double sheet_usual = 25e-3, sheet_most = 110e-3;
    int kind = touches ? CONTACT : scene->sim.tool_count > 0 ? TOOLS : FREE;
    double triangles = 0, tetrahedra = 0, systems = 0;
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        const pel_mesh *mesh = scene->model.bodies[b].mesh;
        double share = mesh->tetrahedron_count / SOLID_TETRAHEDRA;
        triangles += mesh->triangle_count;
        tetrahedra += mesh->tetrahedron_count;
        bool is_smooth = scene->model.bodies[b].volume.element == PEL_VOLUME_SMOOTH;
        systems += (is_smooth ? SMOOTH_SYSTEM : 1) * SOLID_SYSTEM * share * share;
    }
    double growth = triangles * sqrt(sqrt(triangles / 1000));
    sheet_kind sheets = kind == FREE ? sheets_of(scene) : NO_SHEETS;
    bool is_sheet = sheets != NO_SHEETS;
    return (step_cost){.substep = substep[kind] * triangles + SOLID_SUBSTEP * tetrahedra,
                       .implicit = (is_sheet ? sheet_most : implicit[kind]) * growth + systems,
                       .usual = (is_sheet ? sheet_usual : usual[kind]) * growth + systems,
                       .system = implicit[kind] * growth + systems,
                       .choice = (sheets == LIMP_SHEETS ? sheet_usual : implicit[kind]) * growth + systems};
}

double pel_scene_step_cost(const pel_scene *scene)
{
    /* bodies that have contact by default may never meet */
    const step_cost cost = cost_of(scene, scene->sim.contact.enabled && !scene->contact_is_implied);
    return pel_min(cost.system, cost.usual);
}

double pel_scene_substep_cost(const pel_scene *scene)
{
    return cost_of(scene, scene->sim.contact.enabled && !scene->contact_is_implied).substep;
}

/* with more substeps than this, implicit is as exact in less time */
static int32_t most_substeps(const step_cost *cost)
{
    return (int32_t)(cost->choice / cost->substep);
}

/* two digits, for messages */
static double rough(double x)
{
    double unit = 1e-6;
    while (x >= 100 * unit)
        unit *= 10;
    return unit * round(x / unit);
}

enum { RANGE_SIZE = 40 };

/* ms of a step of implicit, with what it may be where bodies jam */
static const char *implicit_cost(const step_cost *cost, char range[RANGE_SIZE])
{
    if (cost->usual < cost->implicit)
        snprintf(range, RANGE_SIZE, "%g to %g", rough(cost->usual), rough(cost->implicit));
    else
        snprintf(range, RANGE_SIZE, "%g", rough(cost->implicit));
    return range;
}

static void set_method(const pel_scene_value *root, pel_scene *scene, pel_method method)
{
    scene->sim.solver.method = method;
    pel_scene_value_at(root, "solver.method")->text = pel_method_words[method];
}

void pel_scene_tell_cost(pel_scene_reader *reader, const pel_scene *scene)
{
    const pel_solver_def *solver = &scene->sim.solver;
    const pel_stepper *stepper = pel_stepper_of(solver->method);
    const step_cost cost = cost_of(scene, scene->sim.contact.enabled);
    double steps = solver->dt > 0 ? scene->duration / solver->dt : 0, step = 0;
    if (stepper->turns_edges)
        step = cost.usual * (stepper->is_static ? PEL_STATIC_SYSTEMS : 1);
    else
        step = cost.substep * pel_max(1, pel_max(solver->substeps, scene->needed_substeps));
    if (1e-3 * steps * step > LONG_RUN)
        pel_log_line(reader->log, "%.0f steps of %s take about %g s of one core, %g ms a step%s", steps,
                     pel_method_words[solver->method], rough(1e-3 * steps * step), rough(step),
                     cost.usual < cost.implicit && stepper->turns_edges ? "; more where bodies jam" : "");
}

/* More substeps than by default, as many as cost less than implicit: stiffness may grow in the run. */
static pel_status take_xpbd(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene, int32_t needed,
                            const step_cost *cost)
{
    pel_solver_def *solver = &scene->sim.solver;
    char text[PEL_NUMBER_SIZE], range[RANGE_SIZE];
    solver->max_substeps = most_substeps(cost);
    pel_number_print(text, solver->max_substeps);
    pel_scene_value *value = pel_scene_value_at(root, "solver.max_substeps");
    value->number = solver->max_substeps;
    value->text = pel_arena_text(reader->arena, text, strlen(text));
    if (value->text == NULL)
        return pel_fail_memory(reader->error);
    pel_log_line(reader->log,
                 "method xpbd: %d substeps in a step of %g s, about %g ms of one core against %s ms of implicit",
                 (int)needed, solver->dt, rough(cost->substep * needed), implicit_cost(cost, range));
    return PEL_OK;
}

static void take_implicit(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene, int32_t needed,
                          const step_cost *cost, bool is_open)
{
    const pel_solver_def *solver = &scene->sim.solver;
    char reason[120], range[RANGE_SIZE];
    if (!is_open)
        snprintf(reason, sizeof reason, "more than max_substeps %d", (int)solver->max_substeps);
    else
        snprintf(reason, sizeof reason, "about %g ms of one core against %s ms", rough(cost->substep * needed),
                 implicit_cost(cost, range));
    pel_log_line(reader->log, "method implicit: xpbd would need %d substeps in a step of %g s, %s", (int)needed,
                 solver->dt, reason);
    set_method(root, scene, PEL_METHOD_IMPLICIT);
}

/* feature that only methods with rotations of edges support, in words that may be in `text`; null = none */
static const char *find_edge_feature(const pel_scene *scene, char text[64])
{
    if (scene->sim.support_count > 0)
        return "`supports`";
    for (int32_t l = 0; l < scene->sim.load_count; l++)
        if (scene->sim.loads[l].kind == PEL_LOAD_MOMENT)
            return "a moment on edges";
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        const pel_body_def *body = &scene->model.bodies[b];
        if (body->volume.on && body->volume.element == PEL_VOLUME_SMOOTH)
            return "smooth tetrahedra";
        pel_bending_model model = body->shell.bending.model;
        if (!pel_bending_traits_of(model)->turns_edges)
            continue;
        snprintf(text, 64, "bending of the model %s", pel_bending_words[model]);
        return text;
    }
    return NULL;
}

/* A gas leaves xpbd steps of first order, which damp a swing of 53 Hz to a tenth in half a second. Where nothing else
   damps it and nothing is touched, implicit keeps it. */
static bool swings_on_gas(const pel_scene *scene, const step_cost *cost)
{
    bool any = false;
    for (int32_t b = 0; b < scene->model.body_count; b++)
        any |= scene->model.bodies[b].shell.pressure.kind == PEL_PRESSURE_GAS;
    return any && pel_scene_is_undamped(scene) && scene->sim.tool_count == 0 && !scene->sim.contact.enabled &&
           1e-3 * cost->system * scene->duration / scene->sim.solver.dt <= MOST_RUN;
}

pel_status pel_scene_choose_method(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene)
{
    const pel_solver_def *solver = &scene->sim.solver;
    const pel_scene_value *method = pel_scene_value_at(root, "solver.method");
    pel_model *model;
    int32_t needed = 0;
    if (!method->is_implied || solver->method != PEL_METHOD_XPBD || solver->substeps > 0 || solver->iterations > 0)
        return PEL_OK;
    char text[64];
    const char *feature = find_edge_feature(scene, text);
    if (feature != NULL) {
        pel_log_line(reader->log, "method implicit: the scene has %s, which xpbd does not support", feature);
        set_method(root, scene, PEL_METHOD_IMPLICIT);
        return PEL_OK;
    }
    pel_status status = pel_model_create(&scene->model, &model, NULL);
    if (status != PEL_OK)
        return status == PEL_OUT_OF_MEMORY ? pel_fail_memory(reader->error) : PEL_OK;
    pel_sim_def def = scene->sim;
    def.model = model;
    status = pel_sim_needed_substeps(&def, &needed, NULL);
    scene->needed_substeps = needed;
    const step_cost cost = cost_of(scene, scene->sim.contact.enabled);
    /* an explicit limit asks for xpbd up to it; the cost of refinement is unknown */
    bool is_open = pel_scene_value_at(root, "solver.max_substeps")->is_implied && !refines(model);
    int32_t most = is_open ? most_substeps(&cost) : solver->max_substeps;
    bool leaves = status != PEL_OK || needs_projection(model) || pel_scene_has_balls(scene);
    pel_model_destroy(model);
    if (status == PEL_OUT_OF_MEMORY)
        return pel_fail_memory(reader->error);
    if (!leaves && needed <= most && is_open && swings_on_gas(scene, &cost)) {
        pel_log_line(reader->log, "method implicit: xpbd damps the swings of bodies that enclose a gas");
        set_method(root, scene, PEL_METHOD_IMPLICIT);
        return PEL_OK;
    }
    if (!leaves && needed > most)
        take_implicit(reader, root, scene, needed, &cost, is_open);
    else if (!leaves && needed > solver->max_substeps)
        return take_xpbd(reader, root, scene, needed, &cost);
    return PEL_OK;
}

/* ---- bending ---- */

static bool needs_hinges(const pel_shell_def *shell)
{
    for (int32_t r = 0; r < shell->anisotropy_count; r++)
        if (shell->anisotropies[r].mode == PEL_FIBRE_CURL)
            return true;
    return shell->bending.yield > 0;
}

void pel_scene_choose_bending(const pel_scene_value *root, pel_scene *scene)
{
    const pel_scene_value *list = pel_scene_value_entry(root, "bodies");
    scene->hinges_are_implied = true;
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        const pel_scene_value *model = pel_scene_value_at(pel_scene_value_element(list, b), "bending.model");
        scene->hinges_are_implied &= model == NULL || model->is_implied;
    }
    if (!pel_stepper_of(scene->sim.solver.method)->turns_edges)
        return;
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        /* the defs of the arena may be written to */
        pel_shell_def *shell = (pel_shell_def *)(uintptr_t)&scene->model.bodies[b].shell;
        pel_scene_value *model = pel_scene_value_at(pel_scene_value_element(list, b), "bending.model");
        if (model == NULL || !model->is_implied || needs_hinges(shell))
            continue;
        model->text = pel_bending_words[PEL_BENDING_MIDEDGE];
        shell->bending.model = PEL_BENDING_MIDEDGE;
    }
}
