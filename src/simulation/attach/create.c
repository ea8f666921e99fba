/* Ties from their defs: checks, points, stiffness. */
#include "attach/tie.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "pellicle/geometry.h"
#include "stage/layer.h"
#include "tool/tool.h"

#include <stdio.h>
#include <string.h>

/* over the stiffness of a vertex of the material: the thread gives way by a hundredth of an edge where its force
   doubles the length of the sheet */
#define AUTO_SHARE 100.0
/* of the square of the frequency that an explicit step resolves */
#define SAFE_SHARE 0.25

pel_tie_def pel_tie_def_default(void)
{
    pel_tie_def def = {0};
    pel_def_reset(PEL_DEF_TIE, &def);
    return def;
}

/* ---- checks ---- */

static pel_status refuse(pel_error *error, int32_t tie, const char *remedy, const char *what)
{
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tie", tie, remedy, "%s", what);
}

static bool are_vertices(const pel_sim *sim, int32_t body, const int32_t *list, int32_t count)
{
    for (int32_t i = 0; list != NULL && i < count; i++)
        if (list[i] < 0 || list[i] >= sim->model->bodies[body].mesh->vertex_count)
            return false;
    return list != NULL;
}

static pel_status check_names(const pel_tie_def *defs, int32_t tie, pel_error *error)
{
    const char *name = defs[tie].name;
    if (name == NULL || name[0] == '\0' || strlen(name) >= PEL_NAME_SIZE)
        return refuse(error, tie, "give a short name", "tie has no name or a very long one");
    for (int32_t other = 0; other < tie; other++)
        if (strcmp(defs[other].name, name) == 0)
            return refuse(error, tie, "give each tie a name of its own", "two ties have the same name");
    return PEL_OK;
}

static pel_status check_target(const pel_sim *sim, const pel_tie_def *def, int32_t tie, pel_error *error)
{
    bool is_pair = def->target == PEL_TIE_BODY || def->target == PEL_TIE_VERTICES;
    if (PEL_IS_NO_CHOICE(def->target, PEL_TIE_TARGET_COUNT))
        return refuse(error, tie, "give one of pel_tie_target", "target of the tie is unknown");
    if (is_pair && (def->to_body < 0 || def->to_body >= sim->model->body_count))
        return refuse(error, tie, "give the number of a body", "tie leads to a body that does not exist");
    if (def->target == PEL_TIE_BODY && def->to_body == def->body)
        return refuse(error, tie, "give another body, or pairs of vertices",
                      "tie leads from a body to its own surface");
    if (def->target == PEL_TIE_VERTICES && !are_vertices(sim, def->to_body, def->to_vertices, def->vertex_count))
        return refuse(error, tie, "give vertices of the mesh, one for each vertex",
                      "tie leads to a vertex that does not exist");
    if (def->target == PEL_TIE_TOOL && (def->tool < 0 || def->tool >= sim->tools->count))
        return refuse(error, tie, "give the number of a tool", "tie leads to a tool that does not exist");
    if (def->target == PEL_TIE_SEQUENCE &&
        (def->sequence == NULL || def->sequence->vertex_count != sim->model->bodies[def->body].mesh->vertex_count))
        return refuse(error, tie, "give a sequence of the mesh of the body",
                      "tie has no sequence, or one with another number of vertices");
    return PEL_OK;
}

static bool is_number(double number)
{
    return number >= 0 && isfinite(number);
}

static pel_status check_numbers(const pel_tie_def *def, int32_t tie, pel_error *error)
{
    for (int32_t i = 0; def->stiffnesses != NULL && i < def->vertex_count; i++)
        if (!is_number(def->stiffnesses[i]))
            return refuse(error, tie, "give finite stiffnesses of at least 0 N/m", "stiffness of a vertex is below 0");
    if (!is_number(def->stiffness) || !(def->strength >= 0) || !isfinite(def->close) || !isfinite(def->from))
        return refuse(error, tie, "give finite numbers of at least 0",
                      "stiffness, strength, close or from of the tie is out of range");
    if (!(def->until > def->from))
        return refuse(error, tie, "give `from` less than `until`", "tie ends before it begins");
    return PEL_OK;
}

static pel_status check_def(const pel_sim *sim, const pel_sim_def *all, int32_t tie, pel_error *error)
{
    const pel_tie_def *def = &all->ties[tie];
    pel_status status = check_names(all->ties, tie, error);
    if (status == PEL_OK && (def->body < 0 || def->body >= sim->model->body_count))
        return refuse(error, tie, "give the number of a body", "tie names a body that does not exist");
    if (status == PEL_OK && (def->vertex_count < 1 || !are_vertices(sim, def->body, def->vertices, def->vertex_count)))
        return refuse(error, tie, "choose a region with at least one vertex of the mesh",
                      "tie has no vertex, or one that does not exist");
    if (status == PEL_OK)
        status = check_target(sim, def, tie, error);
    return status == PEL_OK ? check_numbers(def, tie, error) : status;
}

static pel_status check_sim(const pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    if (!sim->stepper->is_compliant && !sim->stepper->turns_edges &&
        !(sim->stepper->is_explicit && pel_sim_has_velocity(sim)))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "use method implicit, static, xpbd or explicit",
                          "this method has no attachments and stitches");
    if (sim->stepper->is_static && (def->solver.analysis != PEL_ANALYSIS_NONE || def->solver.path != PEL_PATH_TIME))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "leave attachments and stitches out",
                          "analyses and paths by arc length do not support attachments and stitches");
    if (sim->active != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "remove `refine`", "attachments and stitches of models that refine");
    if (def->cut_count > 0)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give stitches a strength, which opens them, or remove `cuts`",
                          "attachments and stitches beside cuts");
    return PEL_OK;
}

/* ---- points ---- */

/* the nearest point of the surface at rest */
static void find_point(const pel_sim *sim, int32_t body, const double x[3], pel_tie *tie)
{
    const pel_body *to = &sim->model->bodies[body];
    double least = (double)HUGE_VAL;
    for (int32_t t = 0; t < to->mesh->triangle_count; t++) {
        const int32_t *corners = to->mesh->triangles[t];
        double a[3][3], weights[3];
        for (int k = 0; k < 3; k++)
            pel_vertex_position(sim->model->rest, to->model_index[corners[k]], a[k]);
        double distance = pel_closest_point_triangle(x, a[0], a[1], a[2], weights);
        if (!(distance < least))
            continue;
        least = distance;
        for (int k = 0; k < 3; k++) {
            tie->vertices[1 + k] = to->model_index[corners[k]];
            tie->weights[1 + k] = -weights[k];
        }
    }
}

/* N/m, of a vertex of the material; 0 = unknown */
static double stiffness_of(const pel_sim *sim, int32_t body)
{
    const pel_body *own = &sim->model->bodies[body];
    double edge = own->diameter / sqrt((double)own->mesh->vertex_count);
    return edge > 0 ? pel_body_strength(sim, body) / edge : 0;
}

static double mobility(const pel_sim *sim, const pel_tie *tie)
{
    double w = 0;
    for (int i = 0; i < tie->count; i++)
        w += tie->weights[i] * tie->weights[i] * (double)sim->model->inverse_mass[tie->vertices[i]];
    return w;
}

static double automatic(const pel_sim *sim, const pel_tie_def *def, const pel_tie *tie)
{
    double own = stiffness_of(sim, def->body), w = mobility(sim, tie), dt = sim->solver.dt;
    if (sim->stepper->has_substeps)
        return (double)HUGE_VAL;
    if (tie->count > 1)
        own = pel_max(own, stiffness_of(sim, def->to_body));
    double inertia = w > 0 ? 1 / (w * dt * dt) : 1;
    double made = own > 0 ? AUTO_SHARE * own : inertia;
    return sim->stepper->is_explicit ? pel_min(made, SAFE_SHARE * inertia) : made;
}

/* the leapfrog is unstable from omega dt = 2 on */
static pel_status check_dt(const pel_sim *sim, const pel_tie *tie, int32_t number, pel_error *error)
{
    double most = 4 / (mobility(sim, tie) * sim->solver.dt * sim->solver.dt);
    if (!sim->stepper->is_explicit || sim->stepper->has_substeps || !(tie->stiffness > SAFE_SHARE * most))
        return PEL_OK;
    return pel_refuse_element(error, PEL_UNSTABLE, "tie", number, "use a smaller dt, or method implicit or xpbd",
                              "a stiffness of %.3g N/m is unstable at dt %.3g: use at most %.3g N/m", tie->stiffness,
                              sim->solver.dt, SAFE_SHARE * most);
}

static pel_status make_tie(const pel_sim *sim, const pel_tie_def *def, int32_t group, int32_t i, pel_tie *tie,
                           pel_error *error)
{
    const pel_body *body = &sim->model->bodies[def->body];
    int32_t v = body->model_index[def->vertices[i]];
    double x[3];
    *tie = (pel_tie){.group = group, .count = 1, .vertices = {v, v, v, v}, .weights = {1}, .row = def->vertices[i]};
    pel_vertex_position(sim->model->rest, v, x);
    if (def->target == PEL_TIE_BODY) {
        tie->count = 4;
        find_point(sim, def->to_body, x, tie);
    } else if (def->target == PEL_TIE_VERTICES) {
        tie->count = 2;
        tie->vertices[1] = sim->model->bodies[def->to_body].model_index[def->to_vertices[i]];
        tie->weights[1] = -1;
        if (tie->vertices[1] == v)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tie", group, "pair different vertices",
                                      "vertex %d is tied to itself", (int)def->vertices[i]);
    }
    tie->stiffness = def->stiffnesses != NULL ? def->stiffnesses[i] : def->stiffness;
    if (def->stiffnesses == NULL && !(def->stiffness > 0))
        tie->stiffness = automatic(sim, def, tie);
    /* a vertex without stiffness is not tied */
    tie->phase = tie->stiffness > 0 ? PEL_TIE_WAITING : PEL_TIE_OPEN;
    return check_dt(sim, tie, group, error);
}

static double gap_between(const pel_sim *sim, const pel_tie_def *def)
{
    if (sim->contacts == NULL || def->to_body < 0 || sim->layers == NULL)
        return 0;
    double share = 1 + 2 * PEL_SLACK_SHARE;
    return share * 0.5 * (sim->layers[def->body].thickness + sim->layers[def->to_body].thickness);
}

static pel_status make_group(pel_sim *sim, const pel_tie_def *def, int32_t number, pel_error *error)
{
    pel_ties *ties = sim->ties;
    pel_tie_group *group = &ties->groups[number];
    snprintf(group->name, sizeof group->name, "%s", def->name);
    group->def = *def;
    group->def.sequence = NULL;
    group->first = ties->count;
    bool is_pair = def->target == PEL_TIE_BODY || def->target == PEL_TIE_VERTICES;
    group->gap = is_pair ? gap_between(sim, def) : 0;
    if (def->target == PEL_TIE_SEQUENCE)
        group->def.sequence = pel_sequence_share(def->sequence);
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < def->vertex_count; i++)
        status = make_tie(sim, def, number, i, &ties->items[ties->count++], error);
    group->count = ties->count - group->first;
    return status;
}

pel_status pel_ties_create(pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    size_t count = 0;
    if (def->tie_count == 0)
        return PEL_OK;
    pel_status status = check_sim(sim, def, error);
    for (int32_t i = 0; status == PEL_OK && i < def->tie_count; i++) {
        status = check_def(sim, def, i, error);
        count += status == PEL_OK ? (size_t)def->ties[i].vertex_count : 0;
    }
    if (status != PEL_OK)
        return status;
    pel_ties *ties = sim->ties = pel_allocate(1, sizeof *ties);
    if (ties == NULL || !PEL_ALLOCATE_ALL(PEL_ROOM(ties->groups, def->tie_count), PEL_ROOM(ties->items, count),
                                          PEL_ROOM(ties->couplings, count)))
        return pel_fail_memory(error);
    ties->group_count = def->tie_count;
    for (int32_t i = 0; status == PEL_OK && i < def->tie_count; i++)
        status = make_group(sim, &def->ties[i], i, error);
    return status;
}

void pel_ties_destroy(pel_sim *sim)
{
    pel_ties *ties = sim->ties;
    if (ties == NULL)
        return;
    for (int32_t g = 0; ties->groups != NULL && g < ties->group_count; g++)
        pel_sequence_destroy((pel_sequence *)(uintptr_t)ties->groups[g].def.sequence);
    PEL_FREE_ALL(ties->groups, ties->items, ties->couplings);
    pel_free(ties);
    sim->ties = NULL;
}
