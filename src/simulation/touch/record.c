/* Reads the records of contacts of the last step (contact/record.c). */
#include "base/status.h"
#include "pellicle/geometry.h"
#include "pellicle/sim_contact.h"
#include "stage/surface_view.h"
#include "tool/tool.h"

int64_t pel_sim_contact_record_count(const pel_sim *sim)
{
    return sim != NULL && sim->contact_forces.records != NULL ? (int64_t)sim->contact_forces.records->last.count : 0;
}

/* signed distance of a point from a tool, and the direction out of it */
static double tool_distance(const pel_tool *tool, const double point[3], double normal[3])
{
    double local[3], best[3] = {0, 0, 0}, least = HUGE_VAL;
    pel_pose_to_local(&tool->pose, point, local);
    if (tool->mesh == NULL) {
        least = pel_solid_distance(&tool->solid, local, best);
        pel_rotate(tool->pose.rotation, best, normal);
        return least;
    }
    for (int32_t t = 0; t < tool->mesh->triangle_count; t++) {
        const int32_t *corners = tool->mesh->triangles[t];
        const double *a = tool->mesh->positions[corners[0]], *b = tool->mesh->positions[corners[1]],
                     *c = tool->mesh->positions[corners[2]];
        double weights[3], away[3];
        double distance = sqrt(pel_closest_point_triangle(local, a, b, c, weights));
        if (distance >= least)
            continue;
        least = distance;
        for (int k = 0; k < 3; k++)
            away[k] = local[k] - weights[0] * a[k] - weights[1] * b[k] - weights[2] * c[k];
        pel_vec3_scale(away, distance > 0 ? 1 / distance : 0, best);
    }
    pel_rotate(tool->pose.rotation, best, normal);
    return least;
}

/* the point of one side, by the sign of its weights */
static void side_point(const pel_sim *sim, const pel_contact_entry *entry, double sign, double point[3])
{
    double x[3];
    pel_vec3_set(point, 0, 0, 0);
    for (int i = 0; i < 4; i++) {
        if (!(sign * entry->weights[i] > 0))
            continue;
        pel_vertex_position(sim->state->position, entry->vertices[i], x);
        pel_vec3_along(point, sign * entry->weights[i] / entry->size, x, point);
    }
}

static void read_corners(const pel_sim *sim, const pel_contact_entry *entry, pel_contact_record *record)
{
    for (int i = 0; i < 4; i++) {
        int32_t place = entry->vertices[i];
        record->vertices[i] = -1;
        record->weights[i] = entry->weights[i] / entry->size;
        if (place < 0)
            continue;
        int32_t body = sim->model->body_of_slice[place / PEL_WIDTH];
        record->bodies[record->weights[i] < 0] = body;
        /* the middle of a ball is no vertex */
        int32_t v = sim->model->mesh_vertex[place];
        record->vertices[i] = v >= 0 ? pel_output_vertex(sim, body, v) : -1;
    }
}

static void read_record(const pel_sim *sim, const pel_contact_entry *entry, pel_contact_record *record)
{
    double load = pel_vec3_length(entry->load), other[3], out[3] = {0, 0, 0};
    *record = (pel_contact_record){.bodies = {-1, -1}, .tool = entry->obstacle};
    read_corners(sim, entry, record);
    side_point(sim, entry, 1, record->point);
    pel_vec3_copy(entry->force, record->force);
    pel_vec3_scale(entry->load, load > 0 ? 1 / load : 0, record->normal);
    if (entry->obstacle >= 0) {
        record->gap = tool_distance(&sim->tools->items[entry->obstacle], record->point, out);
        if (!(load > 0))
            pel_vec3_copy(out, record->normal);
        /* the nearest triangle of a mesh has no inside: the normal tells */
        else if (sim->tools->items[entry->obstacle].mesh != NULL && pel_vec3_dot(out, record->normal) < 0)
            record->gap = -record->gap;
        return;
    }
    side_point(sim, entry, -1, other);
    pel_vec3_subtract(record->point, other, other);
    record->gap = pel_vec3_dot(other, record->normal);
}

pel_status pel_sim_get_contact_records(const pel_sim *sim, pel_contact_record *records, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    int64_t count = pel_sim_contact_record_count(sim);
    if (count > 0)
        PEL_REFUSE_NULL(records, error);
    if (sim->contact_forces.records != NULL && sim->contact_forces.records->last.is_short)
        return pel_fail_memory(error);
    for (int64_t i = 0; i < count; i++)
        read_record(sim, &sim->contact_forces.records->last.entries[i], &records[i]);
    return PEL_OK;
}
