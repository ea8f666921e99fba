/* A static step moves a piece that nothing holds for ever: along the net force on it, or nowhere in particular. Its
   matrix is singular, and a step takes hundreds of times as long before it gives up. So the piece stays as it came off,
   with its stress, until something holds it again or another method goes on. */
#include "tear/loose.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/hold.h"
#include "mesh/union_find.h"
#include "tool/tool.h"

typedef struct pieces {
    pel_sim *sim;
    int32_t body;
    int32_t *parents; /* (vertices of the mesh) */
    uint8_t *is_held; /* (vertices of the mesh) of a piece at its root */
} pieces;

/* a filling, or a tool that may take hold of any piece at any time */
static bool is_held_elsewhere(const pel_sim *sim, int32_t body)
{
    for (int32_t i = 0; i < sim->tools->count; i++) {
        const pel_tool *tool = &sim->tools->items[i];
        bool takes = tool->press || (tool->grasp && tool->support == NULL);
        if (takes && tool->blade == NULL && pel_tool_acts_on(tool, body))
            return true;
    }
    return sim->model->bodies[body].has_volumetric;
}

static void hold(const pieces *p, int32_t place)
{
    int32_t v = p->sim->model->mesh_vertex[place];
    if (v >= 0 && p->sim->model->body_of_slice[place / PEL_WIDTH] == p->body)
        p->is_held[pel_union_find_root(p->parents, v)] = 1;
}

static void find_held(const pieces *p)
{
    const pel_sim *sim = p->sim;
    const pel_body *own = &sim->model->bodies[p->body];
    for (int32_t v = 0; v < own->mesh->vertex_count; v++)
        if (!(sim->model->inverse_mass[own->model_index[v]] > 0))
            hold(p, own->model_index[v]);
    for (int32_t i = 0; sim->holds != NULL && i < sim->holds->held_count; i++)
        hold(p, sim->holds->vertices[i]);
    for (int32_t i = 0; sim->holds != NULL && i < sim->holds->spring_count; i++)
        hold(p, sim->holds->springs[i].vertex);
    for (int32_t t = 0; t < sim->tools->count; t++)
        for (int32_t i = 0; i < sim->tools->items[t].support_count; i++)
            hold(p, sim->tools->items[t].support[i]);
}

static void mark(const pieces *p)
{
    const pel_body *own = &p->sim->model->bodies[p->body];
    const pel_mesh *mesh = own->mesh;
    bool any = false;
    pel_union_find_reset(p->parents, mesh->vertex_count);
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int k = 1; k < 3; k++)
            pel_union_find_join(p->parents, mesh->triangles[t][0], mesh->triangles[t][k]);
    find_held(p);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        any |= p->is_held[v] != 0;
    for (int32_t v = 0; any && v < mesh->vertex_count; v++)
        p->sim->loose[own->model_index[v]] = !p->is_held[pel_union_find_root(p->parents, v)];
}

pel_status pel_loose_find(pel_sim *sim, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t b = 0; status == PEL_OK && b < sim->model->body_count; b++) {
        const pel_mesh *mesh = sim->model->bodies[b].mesh;
        pieces p = {.sim = sim, .body = b};
        if (!sim->stepper->is_static || sim->contacts != NULL || sim->given->def.bodies[b].origins == NULL ||
            is_held_elsewhere(sim, b))
            continue;
        if (sim->loose == NULL)
            sim->loose = pel_allocate((size_t)sim->model->vertex_count, 1);
        if (sim->loose == NULL ||
            !PEL_ALLOCATE_ALL(PEL_ROOM(p.parents, mesh->vertex_count), PEL_ROOM(p.is_held, mesh->vertex_count)))
            status = pel_fail_memory(error);
        else
            mark(&p);
        PEL_FREE_ALL(p.parents, p.is_held);
    }
    return status;
}

void pel_loose_fix(const pel_sim *sim, const double *unknowns, uint8_t *fixed, double *target)
{
    for (int32_t u = 0; sim->loose != NULL && u < 3 * sim->model->vertex_count; u++)
        if (sim->loose[u / 3]) {
            fixed[u] = 1;
            target[u] = unknowns[u];
        }
}

int32_t pel_loose_body(const pel_sim *sim)
{
    for (int32_t v = 0; sim->loose != NULL && v < sim->model->vertex_count; v++)
        if (sim->loose[v])
            return sim->model->body_of_slice[v / PEL_WIDTH];
    return -1;
}
