/* What snapshots contain of refinement, and its way into a changed simulation. */
#include "adapt/transfer.h"

#include "adapt/criterion.h"
#include "adapt/refine.h"
#include "base/assert.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "pellicle/sim_surface.h"
#include "stage/shells.h"
#include "stage/surface_view.h"
#include "tool/tool.h"

/* the criterion's memory, and which vertex has which place; the front follows from the marks */
void pel_refine_transfer(pel_cursor *at, const pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_refined_body *own = &sim->active->bodies[body];
    pel_refine_body *refine = &sim->refine[body];
    const pel_front *front = own->front;
    size_t fine = (size_t)front->forest->levels[front->forest->depth]->vertex_count;
    size_t coarse = (size_t)front->forest->levels[0]->vertex_count;
    pel_transfer(at, refine->mark_counts, (size_t)front->red_limit * sizeof *refine->mark_counts);
    pel_transfer(at, refine->requests, fine * sizeof *refine->requests);
    pel_transfer(at, refine->warm_step, fine * sizeof *refine->warm_step);
    pel_transfer(at, refine->strengths, fine * sizeof *refine->strengths);
    pel_transfer(at, refine->asked_level, coarse * sizeof *refine->asked_level);
    int32_t *lists[] = {refine->candidates, refine->leaving, refine->hot, refine->hot_place};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        pel_transfer(at, lists[i], fine * sizeof *lists[i]);
    pel_transfer(at, &refine->candidate_count, sizeof refine->candidate_count);
    pel_transfer(at, &refine->waiting_count, sizeof refine->waiting_count);
    pel_transfer(at, &refine->leaving_count, sizeof refine->leaving_count);
    pel_transfer(at, &refine->hot_count, sizeof refine->hot_count);
    pel_transfer(at, &refine->part, sizeof refine->part);
    pel_transfer(at, &sim->rows[body].revision, sizeof sim->rows[body].revision);
    /* loading, the places wait in the scratch of the walks until the front is there */
    size_t places = (size_t)(own->fine_limit - own->fine_begin);
    pel_transfer(at, at->load ? refine->queue : sim->model->mesh_vertex + own->fine_begin, places * sizeof(int32_t));
}

/* checks the ranges of the numbers read by pel_refine_transfer */
static bool is_whole(const pel_sim *sim, int32_t body)
{
    const pel_lod_forest *forest = sim->active->bodies[body].front->forest;
    const pel_refine_body *refine = &sim->refine[body];
    size_t fine = (size_t)forest->levels[forest->depth]->vertex_count;
    return pel_is_list(refine->candidates, refine->candidate_count, fine) && refine->waiting_count >= 0 &&
           refine->waiting_count <= refine->candidate_count &&
           pel_is_list(refine->leaving, refine->leaving_count, fine) &&
           pel_is_list(refine->hot, refine->hot_count, fine) && pel_is_list(refine->hot_place, (int32_t)fine, fine);
}

bool pel_refine_restore(pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    pel_refined_body *own = &sim->active->bodies[body];
    pel_refine_body *refine = &sim->refine[body];
    if (!is_whole(sim, body))
        return false;
    for (int32_t node = 0; node < own->front->red_limit; node++)
        pel_front_mark(own->front, node, refine->mark_counts[node] > 0);
    if (pel_front_close(own->front) > own->triangle_limit)
        return false;
    pel_refined_commit(sim->active, body, sim->state);
    sim->rows[body].made_revision = -1;
    if (!pel_refined_set_places(sim->active, body, refine->queue))
        return false;
    pel_refined_rebuild(sim->active, body, sim->state);
    pel_loads_rebuild(sim, body);
    pel_tool_search_rebuild(sim->tools->search, body);
    pel_shells_follow(sim, body);
    pel_refine_criterion_forget(sim, body);
    return true;
}

/* The places of fine vertices are laid out once: as many as the budget needs, or, from some budget on, as all levels
   have. From there on a budget can change as long as the surface fits it. */
static pel_status refuse_room(const pel_refined_body *now, pel_error *error)
{
    const pel_lod_forest *forest = now->front->forest;
    const int32_t base = forest->levels[0]->vertex_count, all = forest->levels[forest->depth]->vertex_count - base;
    const int32_t least = forest->levels[0]->triangle_count + all / 2;
    const bool is_less = now->fine_limit - now->fine_begin < all;
    pel_fail(error, PEL_BAD_ARGUMENT,
             "refine: the simulation has room for %d finer vertices, which cannot change while it runs; the new budget "
             "needs %s",
             (int)(now->fine_limit - now->fine_begin), is_less ? "another number" : "fewer");
    if (is_less)
        pel_fail_remedy(error, "start with the new budget, or with 0 (no limit), from which it can change down to %d",
                        (int)least);
    else
        pel_fail_remedy(error, "give at least %d, or 0 for no limit; start with a lower budget", (int)least);
    return PEL_BAD_ARGUMENT;
}

pel_status pel_refine_check_room(const pel_sim *from, const pel_sim *to, int32_t body, pel_error *error)
{
    PEL_ASSERT_INDEX(body, from->model->body_count);
    const pel_refined_body *old = &from->active->bodies[body], *new = &to->active->bodies[body];
    const int32_t needed = pel_sim_triangle_count(from, body);
    pel_status status = PEL_OK;
    if (old->fine_limit - old->fine_begin != new->fine_limit - new->fine_begin)
        status = refuse_room(old, error);
    else if (needed > new->triangle_limit) {
        status = pel_fail(error, PEL_BAD_ARGUMENT, "refine: the budget is %d triangles, the surface has %d now",
                          (int)new->triangle_limit, (int)needed);
        pel_fail_remedy(error, "give at least %d, or wait until the surface is coarse again", (int)needed);
    }
    if (status != PEL_OK)
        pel_fail_element(error, "body", body);
    return status;
}
