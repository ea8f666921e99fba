#include "session/grasp.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "pellicle/sim_reading.h"
#include "pellicle/sim_surface.h"

#include <math.h>
#include <stdio.h>

/* how far beyond the nearest vertex forceps reach at least */
#define MARGIN 1.01
/* s */
#define NEVER 1e9
/* radii of their circle, by which forceps of the scene leave: out of the picture */
#define AWAY 20.0

/* m, from the hit to the nearest corner of its triangle */
static pel_status find_corner(const pel_sim *sim, const pel_pick_hit *hit, double *distance, pel_error *error)
{
    double *positions = pel_allocate(3 * (size_t)pel_sim_vertex_count(sim, hit->body), sizeof *positions);
    if (positions == NULL)
        return pel_fail_memory(error);
    pel_sim_get_positions(sim, hit->body, positions);
    *distance = HUGE_VAL;
    for (int c = 0; c < 3; c++)
        *distance = pel_min(*distance, pel_vec3_distance(positions + 3 * (size_t)hit->vertices[c], hit->point));
    pel_free(positions);
    return PEL_OK;
}

static pel_status end_lead(pel_sim *sim, int32_t t, const pel_tool_def *def, pel_error *error)
{
    char path[PEL_NAME_SIZE + 40];
    double axis[3], now = pel_sim_time(sim);
    pel_parameter_info from, until;
    pel_tool_reading tool;
    snprintf(path, sizeof path, "tools.%s.grasp.from", def->name);
    pel_status status = pel_parameter_find(sim, path, &from, error);
    bool waits = status == PEL_OK && (now == 0 || from.value[0] > now);
    if (status == PEL_OK && !waits) {
        snprintf(path, sizeof path, "tools.%s.grasp.until", def->name);
        status = pel_parameter_find(sim, path, &until, error);
    }
    if (status != PEL_OK || (waits ? from.value[0] >= NEVER : until.value[0] <= now))
        return status;
    status = pel_set_parameter(sim, path, waits ? NEVER : now, error);
    if (status != PEL_OK)
        return status;
    pel_sim_get_tool(sim, t, &tool);
    pel_vec3_copy(def->lead_axis, axis);
    pel_vec3_normalize(axis);
    pel_vec3_along(tool.position, AWAY * def->lead_radius, axis, tool.position);
    return pel_sim_set_tool_pose(sim, t, tool.position, tool.rotation, error);
}

/* the circle that forceps of the scene follow, but by hand */
static void copy_lead(const pel_tool_def *from, pel_tool_def *def)
{
    def->leads = true;
    pel_vec3_copy(from->lead_center, def->lead_center);
    pel_vec3_copy(from->lead_axis, def->lead_axis);
    def->lead_radius = from->lead_radius;
    def->lead_regrasp = from->lead_regrasp;
    def->lead_speed = 0;
}

/* Through the hole the ray meets the far side of the body: the forceps then begin at the height of those of the scene,
   where they hold nothing, and take the flap. */
static void stay_above(const pel_tool_def *from, pel_pose_key *key)
{
    double axis[3], way[3];
    pel_vec3_copy(from->lead_axis, axis);
    pel_vec3_normalize(axis);
    pel_vec3_subtract(key->position, from->lead_center, way);
    if (pel_vec3_dot(way, axis) >= 0)
        return;
    pel_vec3_subtract(from->keys[0].position, key->position, way);
    pel_vec3_along(key->position, pel_vec3_dot(way, axis), axis, key->position);
}

pel_status pel_grasp_begin(pel_sim *sim, const pel_scene *scene, const pel_pick_hit *hit, bool anew, pel_tool_def *def,
                           pel_pose_key *key, pel_error *error)
{
    double corner = 0;
    pel_status status = find_corner(sim, hit, &corner, error);
    if (status != PEL_OK)
        return status;
    def->radius = pel_max(def->radius, MARGIN * corner);
    def->body = hit->body;
    def->press = false;
    def->grasp = def->grasp_one_patch = true;
    for (int32_t t = 0; anew && t < scene->sim.tool_count; t++)
        if (scene->sim.tools[t].leads) {
            copy_lead(&scene->sim.tools[t], def);
            stay_above(&scene->sim.tools[t], key);
        }
    def->keys = key;
    def->key_count = 1;
    status = pel_sim_add_tool(sim, def, error);
    if (status != PEL_OK)
        return status;
    for (int32_t t = 0; status == PEL_OK && t < scene->sim.tool_count; t++)
        if (scene->sim.tools[t].leads)
            status = end_lead(sim, t, &scene->sim.tools[t], error);
    if (status != PEL_OK)
        (void)pel_sim_remove_tool(sim, pel_sim_tool_count(sim) - 1, NULL);
    return status;
}
