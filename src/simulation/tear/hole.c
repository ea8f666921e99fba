/* The hole that a tear opens around an axis: the farthest open edge in each sector. The first cut may come from the
   middle, and the flap has edges too, within the hole: the farthest ones are those of the hole. */
#include "tear/hole.h"

#include "base/status.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "stage/stage.h"
#include "tear/forceps.h"

#include <math.h>

static const double FULL_TURN = 6.283185307179586476925;
/* of the aim: nearer to the axis open edges are the first cut's */
#define LEAST_RADIUS 0.5
/* of the aim: farther out the tear has run out */
#define RUN_OUT 1.15
/* places of an edge that count: one of 60 degrees has more than one in each sector */
enum { SAMPLES = 16 };

/* ---- the profile ---- */

static void choose_frame(const double lead_axis[3], double axis[3], pel_hole_reading *hole)
{
    int least = 0;
    pel_vec3_copy(lead_axis, axis);
    pel_vec3_normalize(axis);
    for (int c = 1; c < 3; c++)
        least = fabs(axis[c]) < fabs(axis[least]) ? c : least;
    pel_vec3_set(hole->along, least == 0, least == 1, least == 2);
    pel_vec3_along(hole->along, -axis[least], axis, hole->along);
    pel_vec3_normalize(hole->along);
    pel_vec3_cross(axis, hole->along, hole->across);
}

static void add_place(const double x[3], const double center[3], pel_hole_reading *hole)
{
    double out[3];
    pel_vec3_subtract(x, center, out);
    double a = pel_vec3_dot(out, hole->along), b = pel_vec3_dot(out, hole->across), radius = sqrt(a * a + b * b);
    double turn = pel_atan2(b, a) / FULL_TURN;
    int sector = (int)floor((turn < 0 ? turn + 1 : turn) * PEL_HOLE_SECTORS) % PEL_HOLE_SECTORS;
    if (radius >= LEAST_RADIUS * hole->aim)
        hole->radius[sector] = pel_max(hole->radius[sector], radius);
}

static void add_edges(const pel_body *body, const double center[3], pel_hole_reading *hole)
{
    const pel_mesh *mesh = body->mesh;
    for (int32_t h = 0; body->lip_shares != NULL && h < 3 * mesh->triangle_count; h++) {
        const double *from = mesh->positions[mesh->triangles[h / 3][h % 3]],
                     *to = mesh->positions[mesh->triangles[h / 3][(h + 1) % 3]];
        double way[3], x[3];
        if (!pel_is_lip(body, h))
            continue;
        pel_vec3_subtract(to, from, way);
        for (int i = 0; i <= SAMPLES; i++) {
            pel_vec3_along(from, (double)i / SAMPLES, way, x);
            add_place(x, center, hole);
        }
    }
}

/* ---- its numbers ---- */

static double angle_of(int sector)
{
    return FULL_TURN * (sector + 0.5) / PEL_HOLE_SECTORS;
}

static int count_open(const pel_hole_reading *hole)
{
    int count = 0;
    for (int k = 0; k < PEL_HOLE_SECTORS; k++)
        count += hole->radius[k] > 0;
    return count;
}

/* the first sector of each place that is farther out than its neighbour before */
static int32_t count_run_outs(const pel_hole_reading *hole)
{
    int32_t count = 0;
    for (int k = 0; k < PEL_HOLE_SECTORS; k++) {
        double before = hole->radius[(k + PEL_HOLE_SECTORS - 1) % PEL_HOLE_SECTORS], most = RUN_OUT * hole->aim;
        count += hole->radius[k] > most && before <= most;
    }
    /* all of it */
    return count == 0 && hole->radius[0] > RUN_OUT * hole->aim ? 1 : count;
}

/* of slices around the axis with constant radii */
static void measure_whole(pel_hole_reading *hole)
{
    double area = 0, middle[2] = {0, 0}, least = HUGE_VAL, most = 0, slice = FULL_TURN / PEL_HOLE_SECTORS;
    for (int k = 0; k < PEL_HOLE_SECTORS; k++) {
        double r = hole->radius[k], a = angle_of(k);
        area += 0.5 * slice * r * r;
        middle[0] += slice * r * r * r / 3 * pel_cos(a);
        middle[1] += slice * r * r * r / 3 * pel_sin(a);
    }
    middle[0] /= area;
    middle[1] /= area;
    for (int k = 0; k < PEL_HOLE_SECTORS; k++) {
        double x = hole->radius[k] * pel_cos(angle_of(k)) - middle[0],
               y = hole->radius[k] * pel_sin(angle_of(k)) - middle[1], distance = sqrt(x * x + y * y);
        least = pel_min(least, distance);
        most = pel_max(most, distance);
    }
    hole->diameter = 2 * sqrt(2 * area / FULL_TURN);
    hole->offset = sqrt(middle[0] * middle[0] + middle[1] * middle[1]);
    hole->roundness = least / most;
}

void pel_hole_measure(pel_hole_reading *hole)
{
    int count = count_open(hole);
    double sum = 0;
    for (int k = 0; k < PEL_HOLE_SECTORS; k++) {
        sum += hole->radius[k];
        hole->largest = pel_max(hole->largest, hole->radius[k]);
    }
    hole->swept = FULL_TURN * count / PEL_HOLE_SECTORS;
    hole->diameter = count > 0 ? 2 * sum / count : 0;
    hole->offset = hole->roundness = (double)NAN;
    hole->run_out_count = count_run_outs(hole);
    if (count == PEL_HOLE_SECTORS)
        measure_whole(hole);
}

bool pel_sim_get_hole(const pel_sim *sim, pel_hole_reading *reading)
{
    double axis[3];
    pel_cut_reading cuts = {0};
    if (reading == NULL)
        return false;
    *reading = (pel_hole_reading){0};
    const pel_tool_def *lead = sim != NULL ? pel_forceps_first(&sim->def) : NULL;
    if (lead == NULL)
        return false;
    reading->aim = lead->lead_radius;
    choose_frame(lead->lead_axis, axis, reading);
    for (int32_t b = 0; b < sim->given->body_count; b++)
        if (lead->body < 0 || lead->body == b)
            add_edges(&sim->given->bodies[b], lead->lead_center, reading);
    pel_hole_measure(reading);
    bool is_open = pel_sim_get_cuts(sim, lead->body, &cuts, NULL) == PEL_OK && cuts.island_count > 0;
    reading->is_whole = is_open && !isnan(reading->roundness);
    return true;
}
