#include "session/blade.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/vec3.h"
#include "model/model.h"
#include "pellicle/tear.h"
#include "pellicle/topology.h"

static bool add(pel_blade *blade, int32_t vertex)
{
    if (!pel_reserve((void **)&blade->path, &blade->room, (size_t)blade->count + 1, sizeof *blade->path))
        return false;
    blade->path[blade->count++] = vertex;
    return true;
}

pel_status pel_blade_begin(pel_blade *blade, const pel_pick_hit *hit, pel_error *error)
{
    *blade = (pel_blade){.body = hit->body};
    return add(blade, hit->mesh_vertex) ? PEL_OK : pel_fail_memory(error);
}

void pel_blade_end(pel_blade *blade)
{
    pel_free(blade->path);
    *blade = (pel_blade){0};
}

typedef struct lead {
    const pel_mesh *mesh;
    const pel_topology *topology;
    const int32_t *origins; /* (vertex_count) */
    const double *target;   /* m, at rest */
    int32_t from, next;     /* -1 = none is nearer */
    double least;           /* m */
} lead;

/* the neighbours of one copy, across edges inside the surface */
static void look(lead *l, int32_t v)
{
    const pel_topology *topology = l->topology;
    int32_t first = topology->corner_of_vertex[v], h = first;
    double left = pel_vec3_distance(l->mesh->positions[v], l->target);
    while (h >= 0) {
        int32_t to = pel_half_edge_target(topology, h);
        const double *x = l->mesh->positions[to];
        double rest = pel_vec3_distance(x, l->target), way = pel_vec3_distance(l->mesh->positions[v], x) + rest;
        if (topology->twin[h] >= 0 && rest < left && way < l->least) {
            l->least = way;
            l->next = to;
        }
        h = pel_half_edge_turn(topology, h);
        h = h == first ? -1 : h;
    }
}

static pel_status find_path(pel_blade *blade, lead *l, pel_error *error)
{
    for (l->from = blade->path[blade->count - 1];; l->from = l->next) {
        l->next = -1;
        l->least = HUGE_VAL;
        for (int32_t v = 0; v < l->mesh->vertex_count; v++)
            if (l->origins[v] == l->origins[l->from] && l->topology->corner_of_vertex[v] >= 0)
                look(l, v);
        if (l->next < 0)
            return PEL_OK;
        if (!add(blade, l->next))
            return pel_fail_memory(error);
    }
}

/* where the blade is */
static void drop_waiting(pel_blade *blade)
{
    blade->path[0] = blade->path[blade->count - 1];
    blade->count = 1;
}

pel_status pel_blade_lead(pel_blade *blade, pel_sim *sim, const pel_pick_hit *hit, bool *moved, pel_error *error)
{
    int32_t before = blade->count;
    *moved = false;
    if (hit->body != blade->body || hit->mesh_vertex == blade->path[before - 1])
        return PEL_OK;
    const pel_mesh *mesh = pel_sim_model(sim)->bodies[blade->body].mesh;
    int32_t *origins = pel_allocate((size_t)mesh->vertex_count, sizeof *origins);
    pel_topology *topology = NULL;
    pel_status status = origins != NULL ? pel_topology_create(mesh, &topology, error) : pel_fail_memory(error);
    if (status == PEL_OK) {
        pel_sim_get_origins(sim, blade->body, origins);
        lead l = {.mesh = mesh, .topology = topology, .origins = origins, .target = mesh->positions[hit->mesh_vertex]};
        status = find_path(blade, &l, error);
    }
    pel_topology_destroy(topology);
    pel_free(origins);
    *moved = blade->count > before;
    if (status != PEL_OK || !*moved)
        return status;
    status = pel_cut(sim, blade->body, blade->path, blade->count, error);
    if (status == PEL_BAD_ARGUMENT && blade->count == 2 && !pel_sim_cut_is_held(sim))
        return PEL_OK;
    drop_waiting(blade);
    return status;
}
