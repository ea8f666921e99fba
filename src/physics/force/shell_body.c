#include "force/shell_body.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "force/pressure.h"

#include <string.h>

const pel_shell_body *pel_shell_body_of(const pel_shell_forces *forces, int32_t body)
{
    return forces != NULL && forces->bodies[body].shell != NULL ? &forces->bodies[body] : NULL;
}

/* ---- elements at a place ---- */

/* Lists by owner: counts stand two places after their owner's number, sums make them begins one place after; filling
   moves each up to the start of the next owner, so that begin[owner] .. begin[owner + 1] is right at the end. */
static void visit_element(pel_shell_body *own, bool list, int32_t element, const int32_t *vertices, int count)
{
    for (int k = 0; k < count; k++) {
        int32_t *begin = &own->element_begin[vertices[k] - own->first_place];
        if (list)
            own->elements[begin[1]++] = element;
        else
            begin[2]++;
    }
}

static void visit_elements(pel_shell_body *own, bool list)
{
    const pel_shell *shell = own->shell;
    for (int32_t t = 0; t < shell->triangle_count; t++)
        visit_element(own, list, t, shell->corners[t], 3);
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
        visit_element(own, list, shell->triangle_count + i, hinge.vertices, 4);
    }
}

static void fill_elements(pel_shell_body *own)
{
    memset(own->element_begin, 0, ((size_t)own->place_count + 2) * sizeof *own->element_begin);
    visit_elements(own, false);
    for (int32_t i = 0; i < own->place_count; i++)
        own->element_begin[i + 2] += own->element_begin[i + 1];
    visit_elements(own, true);
}

pel_status pel_shell_forces_list(pel_shell_forces *forces, int32_t body, pel_error *error)
{
    PEL_ASSERT(forces == NULL || (body >= 0 && body < forces->model->body_count));
    pel_shell_body *own = &forces->bodies[body];
    const pel_shell *shell = own->shell;
    if (shell == NULL || own->elements != NULL)
        return PEL_OK;
    size_t count = 3 * (size_t)shell->triangle_limit + 4 * (size_t)shell->hinge_limit;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(own->element_begin, (size_t)own->place_count + 2), PEL_ROOM(own->elements, count)))
        return pel_fail_memory(error);
    fill_elements(own);
    return PEL_OK;
}

void pel_shell_forces_rebuild(pel_shell_forces *forces, int32_t body)
{
    if (forces != NULL && forces->bodies[body].elements != NULL)
        fill_elements(&forces->bodies[body]);
}

/* ---- creation ---- */

static pel_status start_body(pel_shell_forces *forces, int32_t b, pel_error *error)
{
    const pel_body *body = &forces->model->bodies[b];
    pel_shell_body *own = &forces->bodies[b];
    if (body->shell == NULL)
        return PEL_OK;
    *own = (pel_shell_body){.shell = body->shell, .body = b, .first_place = body->slice_begin * PEL_WIDTH};
    if (body->shell->pressure.kind != PEL_PRESSURE_NONE)
        own->pressure_part = pel_pressure_is_conservative(body) ? PEL_SHELL_CONSERVATIVE : PEL_SHELL_FOLLOWER;
    own->is_pushed = pel_shell_has_mode(own->shell, PEL_FIBRE_NORMAL);
    own->place_count = pel_body_place_end(forces->model, b) - own->first_place;
    const pel_body_batches *batches = &forces->batches->bodies[b];
    /* it stands last */
    if (own->pressure_part != 0)
        own->pressed = &batches->batches[batches->batch_count - 1];
    return pel_shell_check_bending(own->shell, own->body, error);
}

static pel_status fill_forces(pel_shell_forces *forces, pel_error *error)
{
    const pel_model *model = forces->model;
    bool normal_form = false;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(forces->bodies, model->body_count),
                          PEL_ROOM(forces->energies, forces->batches->phase_begin[PEL_PHASE_COUNT]),
                          PEL_ROOM(forces->sums, model->vertex_count)))
        return pel_fail_memory(error);
    pel_status status = PEL_OK;
    for (int32_t b = 0; status == PEL_OK && b < model->body_count; b++) {
        status = start_body(forces, b, error);
        normal_form |= model->bodies[b].shell != NULL && pel_shell_is_normal_form(model->bodies[b].shell);
    }
    if (status == PEL_OK && normal_form) {
        forces->area_vectors = pel_allocate_aligned((size_t)model->vertex_count, sizeof *forces->area_vectors);
        status = forces->area_vectors != NULL ? PEL_OK : pel_fail_memory(error);
    }
    return status;
}

pel_status pel_shell_forces_create(pel_batches *batches, pel_shell_forces **forces, pel_error *error)
{
    *forces = NULL;
    int32_t count = 0;
    for (int32_t b = 0; b < batches->model->body_count; b++)
        count += batches->model->bodies[b].shell != NULL;
    if (count == 0)
        return PEL_OK;
    pel_shell_forces *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->model = batches->model;
    made->load_factor = 1;
    made->batches = batches;
    pel_status status = fill_forces(made, error);
    if (status == PEL_OK)
        *forces = made;
    else
        pel_shell_forces_destroy(made);
    return status;
}

void pel_shell_forces_set_load_factor(pel_shell_forces *forces, double factor)
{
    if (forces != NULL)
        forces->load_factor = factor;
}

void pel_shell_forces_destroy(pel_shell_forces *forces)
{
    if (forces == NULL)
        return;
    for (int32_t b = 0; forces->bodies != NULL && b < forces->model->body_count; b++) {
        pel_free(forces->bodies[b].element_begin);
        pel_free(forces->bodies[b].elements);
    }
    PEL_FREE_ALL(forces->bodies, forces->energies, forces->area_vectors, forces->sums, forces);
}
