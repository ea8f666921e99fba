/* Contact over an event of refinement: the surface changes without a step, and must not cut itself afterwards.

   New vertices lie a little off the middle of their edge (refine_transfer.c), and coarsened regions lose their bulges,
   so the new surface is tested exactly. If it cuts itself, new vertices move to the middles, which does not move a
   refined surface; if that does not help, the event is reverted by a snapshot from before it. */
#include "sim/contact_event.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "sim/snapshot.h"
#include "touch/contact.h"

static pel_status prepare(pel_sim *sim, pel_error *error)
{
    pel_touch *touch = sim->touch;
    size_t size = touch->event_least + pel_snapshot_lists_size(sim);
    return pel_reserve(&touch->before_event, &touch->event_room, size, 1) ? PEL_OK : pel_fail_memory(error);
}

static void save_before(pel_sim *sim)
{
    sim->touch->event_size = pel_sim_save_size(sim);
    PEL_ASSERT(sim->touch->event_size <= sim->touch->event_room);
    pel_sim_save(sim, sim->touch->before_event);
}

/* pairs at the present positions; false when that cannot be told */
static bool count_pairs(pel_sim *sim, int64_t *count)
{
    pel_contacts_place_start(sim);
    if (pel_contacts_update_surface(sim, NULL) != PEL_OK || pel_tangles_find(sim->contacts, NULL) != PEL_OK)
        return false;
    *count = sim->contacts->tangles.count;
    return true;
}

/* the middle of the edge of a new vertex; velocities stay */
static void move_to_middle(pel_sim *sim, const pel_refined_body *own, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    const pel_lod_forest *forest = own->front->forest;
    const pel_topology *coarse = forest->levels[pel_lod_forest_vertex_level(forest, v) - 1];
    int32_t h = coarse->half_edge_of_edge[v - coarse->vertex_count], place = own->model_index[v];
    int32_t a = own->model_index[pel_half_edge_origin(coarse, h)];
    int32_t b = own->model_index[pel_half_edge_target(coarse, h)];
    pel_state *state = sim->state;
    for (int k = 0; k < 3; k++) {
        pel_real middle = (pel_real)0.5 * (state->position[a][k] + state->position[b][k]);
        state->position_before[place][k] += middle - state->position[place][k];
        state->position[place][k] = middle;
    }
}

static bool accept(pel_sim *sim, int32_t body)
{
    const pel_refined_body *own = &sim->active->bodies[body];
    const pel_tangles *tangles = &sim->contacts->tangles;
    int64_t known = tangles->is_known ? tangles->count : 0, count;
    if (count_pairs(sim, &count) && count <= known)
        return true;
    /* ascending: the ends of an edge come first */
    for (int32_t i = 0; i < own->front->added_count; i++)
        move_to_middle(sim, own, own->front->added_vertices[i]);
    if (count_pairs(sim, &count) && count <= known)
        return true;
    pel_snapshot_load(sim, sim->touch->before_event, sim->touch->event_size, NULL);
    return false;
}

pel_status pel_contacts_create_event(pel_sim *sim, pel_error *error)
{
    if (sim->contacts == NULL || sim->active == NULL)
        return PEL_OK;
    /* forces of the caller may come later */
    size_t forces = sim->loads->external == NULL ? (size_t)sim->model->vertex_count * sizeof *sim->loads->external : 0;
    static const pel_event_guard guards = {prepare, save_before, accept};
    sim->guards = &guards;
    sim->touch->event_least = pel_sim_save_size(sim) - pel_snapshot_lists_size(sim) + forces;
    return prepare(sim, error);
}
