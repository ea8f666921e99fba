#include "tear/adhesion.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/vec3.h"

#include <math.h>

/* areas and normals around the vertices */
static void sum_triangles(pel_adhesion *a, const pel_mesh *mesh)
{
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        double normal[3];
        pel_vec3_triangle_normal(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]], normal);
        double area = pel_vec3_triangle_area(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]]);
        for (int c = 0; c < 3; c++) {
            a->strengths[v[c]] += area / 3;
            pel_vec3_add(a->normals[v[c]], normal, a->normals[v[c]]);
        }
    }
}

pel_status pel_adhesion_begin(pel_adhesion *a, const pel_sim *sim, int32_t body, pel_error *error)
{
    const pel_body_def *def = &sim->given->def.bodies[body];
    const pel_mesh *mesh = def->mesh;
    *a = (pel_adhesion){.body = body, .vertex_count = mesh->vertex_count, .released_count = def->released_count};
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(a->strengths, mesh->vertex_count), PEL_ROOM(a->normals, mesh->vertex_count),
                          PEL_ROOM(a->list, mesh->vertex_count)))
        return pel_fail_memory(error);
    sum_triangles(a, mesh);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        a->strengths[v] *= def->adhesion;
        pel_vec3_normalize(a->normals[v]);
    }
    for (int32_t i = 0; i < def->released_count; i++) {
        a->list[i] = def->released[i];
        a->strengths[def->released[i]] = (double)HUGE_VAL;
    }
    return PEL_OK;
}

void pel_adhesion_end(pel_adhesion *a)
{
    PEL_FREE_ALL(a->strengths, a->normals, a->list);
    *a = (pel_adhesion){0};
}

int32_t pel_adhesion_look(const pel_adhesion *a, const pel_sim *sim)
{
    const pel_body *body = &sim->given->bodies[a->body];
    double factor = sim->state->factors[a->body][PEL_VOLUMETRIC_STIFFNESS], x[3], rest[3], pull[3];
    int32_t count = a->released_count;
    for (int32_t v = 0; v < a->vertex_count; v++) {
        int32_t place = body->model_index[v];
        if (isinf(a->strengths[v]))
            continue;
        pel_vertex_position(sim->state->position, place, x);
        pel_vertex_position(sim->given->rest, place, rest);
        pel_vec3_subtract(x, rest, pull);
        double inward = pel_vec3_dot(pull, a->normals[v]);
        if (inward < 0)
            pel_vec3_along(pull, -inward, a->normals[v], pull);
        if (factor * (double)sim->given->rest[place][3] * pel_vec3_length(pull) > a->strengths[v])
            a->list[count++] = v;
    }
    return count;
}
