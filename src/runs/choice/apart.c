/* Contact that a scene does not ask for. Several bodies have it between them, unless they intersect at the start: such
   a scene compares bodies at one place, and contact would refuse it. */
#include "choice/apart.h"

#include "bvh/intersect.h"
#include "mesh/figures.h"

#include <stddef.h>
#include <string.h>

static bool boxes_overlap(const pel_mesh *a, const pel_mesh *b)
{
    double low_a[3], high_a[3], low_b[3], high_b[3];
    pel_mesh_box(a, low_a, high_a);
    pel_mesh_box(b, low_b, high_b);
    bool overlap = true;
    for (int c = 0; c < 3; c++)
        overlap &= low_a[c] <= high_b[c] && low_b[c] <= high_a[c];
    return overlap;
}

/* both meshes as one, in memory of the arena; false if out of memory */
static bool join(pel_arena *arena, const pel_mesh *a, const pel_mesh *b, pel_mesh *both)
{
    size_t vertices = (size_t)a->vertex_count + (size_t)b->vertex_count;
    size_t triangles = (size_t)a->triangle_count + (size_t)b->triangle_count;
    double(*positions)[3] = pel_arena_take(arena, vertices, sizeof *positions);
    int32_t(*corners)[3] = pel_arena_take(arena, triangles, sizeof *corners);
    if (positions == NULL || corners == NULL)
        return false;
    memcpy(positions, a->positions, (size_t)a->vertex_count * sizeof *positions);
    memcpy(positions + a->vertex_count, b->positions, (size_t)b->vertex_count * sizeof *positions);
    memcpy(corners, a->triangles, (size_t)a->triangle_count * sizeof *corners);
    for (int32_t t = 0; t < b->triangle_count; t++)
        for (int c = 0; c < 3; c++)
            corners[a->triangle_count + t][c] = a->vertex_count + b->triangles[t][c];
    *both = (pel_mesh){.vertex_count = (int32_t)vertices, .triangle_count = (int32_t)triangles};
    both->positions = positions;
    both->triangles = corners;
    return true;
}

/* whether two meshes intersect, or have too many boxes that overlap to know */
static pel_status find_intersection(pel_scene_reader *reader, const pel_mesh *a, const pel_mesh *b, bool *found)
{
    pel_mesh both;
    *found = false;
    if (!boxes_overlap(a, b))
        return PEL_OK;
    if (!join(reader->arena, a, b, &both))
        return pel_fail_memory(reader->error);
    pel_status status = pel_mesh_parts_intersect(&both, a->triangle_count, found);
    if (status == PEL_OUT_OF_MEMORY)
        return pel_fail_memory(reader->error);
    *found |= status != PEL_OK;
    return PEL_OK;
}

pel_status pel_scene_keep_apart(pel_scene_reader *reader, pel_scene_value *root, pel_scene *scene)
{
    pel_scene_value *contact = pel_scene_value_entry(root, "contact");
    const pel_body_def *bodies = scene->model.bodies;
    scene->contact_is_implied = contact != NULL && contact->is_implied;
    for (int32_t b = 1; scene->contact_is_implied && b < scene->model.body_count; b++)
        for (int32_t a = 0; scene->contact_is_implied && a < b; a++) {
            bool found;
            pel_status status = find_intersection(reader, bodies[a].mesh, bodies[b].mesh, &found);
            if (status != PEL_OK)
                return status;
            if (!found)
                continue;
            pel_log_line(reader->log,
                         "no contact: bodies '%s' and '%s' intersect at the start. pull them apart, or ignore what "
                         "intersects with contact: { start: tangled }",
                         bodies[a].name, bodies[b].name);
            scene->contact_is_implied = scene->sim.contact.enabled = false;
            pel_scene_value_remove(contact);
        }
    return PEL_OK;
}
