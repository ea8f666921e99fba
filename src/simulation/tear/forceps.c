/* Forceps that lead a tear around an axis, as a surgeon's do in a capsulorhexis. The flap is folded over at the tip,
   and the tool pulls what it holds of it beyond the tip. If the flap does not stretch, an advance a of the tip lets the
   tool go by a . (p + e), with the direction p of the pull and the direction e from what is held to the tip at rest. So
   the configurational force is F (p + e), and lies along the circle if p is the mirror image of e about it. A real flap
   stretches, and its base holds it too. So as soon as the tip is loaded the tool turns about the tip, from where it is,
   by the angle that the force lacks, and pulls on slowly until the force points right: turning it after the tip has
   grown would be too late. It stays near the mirror image, because the force does not follow a pull far aside.
   Methods that approach rest over many steps let it pull on only as fast as the force on the tip follows.

   The tool aims at a point ahead of itself on the line from the tip along p, and goes there by its speed, so no step of
   it is longer than another. Far from the tip it lets go, and takes the inner lip behind the tip, but not so near to
   the tip that its forces would be within the rings of the survey.

   The tool keeps its height along the axis, to which it also comes back after a new grasp. Nothing but its pose is
   remembered from step to step. */
#include "tear/forceps.h"

#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "tear/growth.h"
#include "tear/material.h"
#include "tool/grip.h"

#include <math.h>

/* where it aims, from itself, over the distance of a new grasp */
#define AIM_AHEAD 0.2
/* where a new grasp takes the flap behind the tip, over how far the tool grasps; in edges, beyond the rings */
#define GRASP_BEHIND 2.0
#define EDGES_BEYOND 1.0
/* rad, that the tear is led back to the circle by at most; the distance from it that asks for one radian, over its
 * radius
 */
#define MOST_OFF 0.2
#define RETURN 0.1
/* release over resistance of a tip from which on the direction of its force counts */
#define LEAST_LOAD 0.3
/* the turn of the tool over the angle that the force lacks: half of it, if the flap does not stretch */
#define TURN 2.0
/* rad, of that turn, and from the mirror image */
#define MOST_TURN 0.5
#define MOST_ASIDE 0.6
/* rad, that the force lacks where the tool pulls on by the least share of its way */
#define WRONG 0.2
/* of its way, and of its speed while the flap does not follow */
#define LEAST_SHARE 0.1

typedef struct forceps {
    pel_sim *sim;
    pel_tool *tool;
    const pel_tool_def *def;
    pel_survey *survey;      /* of the body of the tip */
    int32_t tip;             /* -1 = none */
    double axis[3];          /* unit */
    double at[3], rest[3];   /* m, of the tip, at present and at rest */
    double ahead[3];         /* unit, in which the tip was opened */
    double along[3], out[3]; /* unit: along the circle, and away from the axis */
    double radius;           /* m, of the tip from the axis at rest */
    double load;             /* release of the tip over its resistance */
    double change;           /* of that load in a step */
    double course, force;    /* rad from `along` outward: where the tip shall go, and its force */
} forceps;

static bool is_by_hand(const pel_tool_def *def)
{
    return def->lead_speed == 0;
}

static void place_of(const pel_survey *s, int32_t v, double x[3])
{
    pel_vertex_position(s->sim->state->position, s->sim->model->bodies[s->body].model_index[v], x);
}

/* ---- the tip ---- */

/* part of a vector across the axis */
static void flatten(const forceps *f, double x[3])
{
    pel_vec3_along(x, -pel_vec3_dot(x, f->axis), f->axis, x);
}

/* rad, from along the circle outward */
static double angle_of(const forceps *f, const double x[3])
{
    return pel_atan2(pel_vec3_dot(x, f->out), pel_vec3_dot(x, f->along));
}

/* a cut may have another end within the flap */
static bool is_near_circle(const forceps *f, const pel_survey *s, int32_t v)
{
    double x[3], radius = f->def->lead_radius;
    pel_vec3_subtract(s->sim->model->bodies[s->body].mesh->positions[v], f->def->lead_center, x);
    flatten(f, x);
    return fabs(pel_vec3_length(x) - radius) < 0.5 * radius;
}

/* the nearest one, and the pull there */
static void find_tip(forceps *f)
{
    double least = HUGE_VAL, ahead[3] = {0}, x[3], found[3];
    for (int32_t i = 0; i < f->sim->tear->survey_count; i++) {
        pel_survey *s = &f->sim->tear->surveys[i];
        for (int32_t k = 0; pel_tool_acts_on(f->tool, s->body) && k < pel_survey_count_tips(s); k++) {
            int32_t v = s->tips[k];
            if (!pel_survey_is_tip(s, v, found) || !is_near_circle(f, s, v))
                continue;
            place_of(s, v, x);
            double distance = pel_vec3_distance(x, f->tool->pose.position);
            if (distance >= least)
                continue;
            least = distance;
            f->survey = s;
            f->tip = v;
            pel_vec3_copy(x, f->at);
            pel_vec3_copy(found, ahead);
        }
    }
    if (f->tip < 0)
        return;
    pel_tip tip;
    pel_survey_read(f->survey, f->tip, ahead, &tip);
    pel_vec3_copy(ahead, f->ahead);
    f->load = tip.release / pel_tear_resistance(f->sim, f->survey->body, f->tip);
    f->change = is_by_hand(f->def) || !(f->load > 0) ? 0 : f->load * pel_survey_change(f->survey, &tip);
    pel_vec3_copy(f->survey->sim->model->bodies[f->survey->body].mesh->positions[f->tip], f->rest);
    pel_vec3_subtract(f->rest, f->def->lead_center, f->out);
    flatten(f, f->out);
    f->radius = pel_vec3_normalize(f->out);
    pel_vec3_cross(f->axis, f->out, f->along);
    if (pel_vec3_dot(f->along, ahead) < 0)
        pel_vec3_scale(f->along, -1, f->along);
    f->force = angle_of(f, tip.force);
    double off =
        pel_max(-MOST_OFF, pel_min(MOST_OFF, (f->def->lead_radius - f->radius) / (RETURN * f->def->lead_radius)));
    f->course = f->def->lead_outward != 0 ? 0 : pel_atan2(off, 1);
}

/* ---- the flap ---- */

/* m, middle of a triangle at rest */
static void centre_at_rest(const pel_mesh *mesh, int32_t t, double x[3])
{
    const int32_t *v = mesh->triangles[t];
    for (int c = 0; c < 3; c++)
        x[c] = (mesh->positions[v[0]][c] + mesh->positions[v[1]][c] + mesh->positions[v[2]][c]) / 3;
}

/* m, mean length of the edges at the tip, at rest */
static double edge_at_tip(const forceps *f)
{
    const pel_survey *s = f->survey;
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    double sum = 0;
    int32_t count = 0;
    for (int32_t h = s->topology->corner_of_vertex[f->tip]; h >= 0; h = pel_survey_turn(s, f->tip, h), count++)
        sum += pel_vec3_distance(f->rest, mesh->positions[pel_half_edge_target(s->topology, h)]);
    return sum / count;
}

/* whether the lip that a half-edge at the tip belongs to is the inner one */
static bool is_inner(const forceps *f, int32_t half_edge)
{
    const pel_mesh *mesh = f->sim->model->bodies[f->survey->body].mesh;
    double across[3], aside[3], x[3];
    pel_vec3_cross(f->axis, f->ahead, across);
    pel_vec3_cross(f->axis, f->along, aside);
    centre_at_rest(mesh, half_edge / 3, x);
    pel_vec3_subtract(x, f->rest, x);
    return (pel_vec3_dot(x, across) < 0) == (pel_vec3_dot(f->out, aside) > 0);
}

/* the vertex of the inner lip far enough behind the tip for a tool; where the lip ends before, at the other end of the
   cut or at a border, its farthest one, if a tool has room there, or -1 */
static int32_t find_grip(const forceps *f)
{
    const pel_survey *s = f->survey;
    const pel_body *body = &f->sim->model->bodies[s->body];
    int32_t from = s->topology->corner_of_vertex[f->tip], to = pel_survey_last(s, f->tip), v = f->tip;
    bool is_from_inner = is_inner(f, from);
    double beyond = (EDGES_BEYOND + pel_survey_rings(f->survey, f->tip)) * edge_at_tip(f);
    double most = GRASP_BEHIND * pel_grasp_extent(&f->tool->solid, f->tool->reach), far = pel_max(most, beyond);
    double other[3];
    int32_t grip = -1;
    for (int32_t h = is_from_inner ? from : to; pel_is_lip(body, h) && (grip < 0 || most < far);) {
        v = is_from_inner ? pel_half_edge_target(s->topology, h) : pel_half_edge_origin(s->topology, h);
        if (pel_survey_is_tip(s, v, other))
            break;
        double distance = pel_vec3_distance(body->mesh->positions[v], f->rest);
        if (distance >= most) {
            most = distance;
            grip = v;
        }
        h = is_from_inner ? s->topology->corner_of_vertex[v] : pel_survey_last(s, v);
    }
    return grip;
}

static bool holds(const pel_tool *tool, int32_t v)
{
    for (int32_t i = 0; i < tool->held_count; i++)
        if (tool->held[i] == v)
            return true;
    return false;
}

/* forceps that pull a stretched flap far keep what they have */
static void regrasp(forceps *f)
{
    int32_t grip = find_grip(f), v = grip >= 0 ? f->sim->model->bodies[f->survey->body].model_index[grip] : -1;
    if (v >= 0 && !holds(f->tool, v))
        pel_tool_take_patch(f->sim, f->tool, v);
}

/* ---- the step ---- */

/* unit, across the axis, from what is held to the tip at rest */
static void find_lip(const forceps *f, double lip[3])
{
    double x[3];
    pel_vec3_scale(f->rest, f->tool->held_count, lip);
    for (int32_t i = 0; i < f->tool->held_count; i++) {
        pel_vertex_position(f->sim->model->rest, f->tool->held[i], x);
        pel_vec3_subtract(lip, x, lip);
    }
    flatten(f, lip);
    if (!(pel_vec3_normalize(lip) > 0))
        pel_vec3_copy(f->along, lip);
}

/* whether the direction of the force on the tip is known, and the tool shall mend it */
static bool is_steering(const forceps *f)
{
    return f->def->lead_outward == 0 && f->load > LEAST_LOAD && f->tool->held_count > 0;
}

/* the mirror image of the lip about where the tear shall go, along the circle through the tip and back to its radius;
   under load mended by what the force lacks */
static void find_pull(const forceps *f, double pull[3])
{
    double lip[3], way[3];
    find_lip(f, lip);
    double angle = 2 * f->course - angle_of(f, lip) + f->def->lead_outward;
    if (is_steering(f)) {
        pel_vec3_subtract(f->tool->pose.position, f->at, way);
        double turn = pel_max(-MOST_TURN, pel_min(MOST_TURN, TURN * (f->course - f->force)));
        angle = pel_max(angle - MOST_ASIDE, pel_min(angle + MOST_ASIDE, angle_of(f, way) + turn));
    }
    pel_vec3_scale(f->along, pel_cos(angle), pull);
    pel_vec3_along(pull, pel_sin(angle), f->out, pull);
}

/* a point ahead of the tool: on the line of the pull, or off the surface where there is no tip any more */
static void find_aim(const forceps *f, double aim[3])
{
    double pull[3], way[3], ahead = AIM_AHEAD * f->def->lead_regrasp;
    const double *x = f->tool->pose.position;
    if (f->tip < 0) {
        pel_vec3_along(x, ahead, f->axis, aim);
        return;
    }
    find_pull(f, pull);
    if (is_steering(f))
        ahead *= pel_max(LEAST_SHARE, 1 - fabs(f->course - f->force) / WRONG);
    pel_vec3_subtract(x, f->at, way);
    pel_vec3_along(f->at, pel_vec3_dot(way, pull) + ahead, pull, aim);
    pel_vec3_subtract(f->tool->keys[0].position, aim, way);
    pel_vec3_along(aim, pel_vec3_dot(way, f->axis), f->axis, aim);
}

/* m, mean distance from the axis at rest of what is held */
static double held_radius(const forceps *f)
{
    double sum = 0, x[3];
    for (int32_t i = 0; i < f->tool->held_count; i++) {
        pel_vertex_position(f->sim->model->rest, f->tool->held[i], x);
        pel_vec3_subtract(x, f->def->lead_center, x);
        flatten(f, x);
        sum += pel_vec3_length(x);
    }
    return f->tool->held_count > 0 ? sum / f->tool->held_count : HUGE_VAL;
}

/* m, in a step: slower while the force on the tip does not follow */
static double longest_way(const forceps *f)
{
    double pace = pel_max(LEAST_SHARE, PEL_TIP_RELAXED / pel_max(f->change, PEL_TIP_RELAXED));
    return pace * f->def->lead_speed * f->sim->solver.dt;
}

static void lead(forceps *f)
{
    pel_tool *tool = f->tool;
    double way[3], aim[3], distance;
    find_tip(f);
    pel_vec3_subtract(tool->pose.position, f->at, way);
    flatten(f, way);
    if (f->tip >= 0 && (tool->held_count == 0 || pel_vec3_length(way) > f->def->lead_regrasp ||
                        (is_by_hand(f->def) && held_radius(f) > f->radius)))
        regrasp(f);
    if (is_by_hand(f->def))
        return;
    tool->driven_pose = tool->pose;
    tool->driven = tool->is_leading = true;
    /* it aims from where it is, and has nothing to catch up with */
    tool->blocked = false;
    find_aim(f, aim);
    pel_vec3_subtract(aim, tool->pose.position, way);
    distance = pel_vec3_normalize(way);
    pel_vec3_along(tool->pose.position, pel_min(distance, longest_way(f)), way, tool->driven_pose.position);
}

void pel_forceps_lead(pel_sim *sim)
{
    for (int32_t i = 0; sim->tear != NULL && i < sim->tools->count; i++) {
        pel_tool *tool = &sim->tools->items[i];
        forceps f = {.sim = sim, .tool = tool, .def = &sim->def.tools[i], .tip = -1};
        bool is_led = is_by_hand(f.def) || !tool->driven || tool->is_leading;
        if (!f.def->leads || tool->phase != PEL_GRASP_HOLDING || !is_led)
            continue;
        pel_vec3_copy(f.def->lead_axis, f.axis);
        pel_vec3_normalize(f.axis);
        lead(&f);
    }
}
