/* Saving and loading: see transfer.h. */
#include "stage/transfer.h"
#include "base/assert.h"

#include <string.h>

void pel_transfer(pel_cursor *at, void *data, size_t size)
{
    bool is_short = at->load && size > at->size - at->at;
    at->is_short |= is_short;
    /* an empty list may have no memory */
    if (is_short || size == 0)
        return;
    if (at->bytes != NULL && at->load)
        memcpy(data, at->bytes + at->at, size);
    else if (at->bytes != NULL)
        memcpy(at->bytes + at->at, data, size);
    at->at += size;
}

void pel_transfer_vertices(pel_cursor *at, void *data, size_t count, size_t size)
{
    if (at->places == NULL || !at->load) {
        pel_transfer(at, data, count * size);
        return;
    }
    const unsigned char *saved = at->bytes + at->at;
    for (size_t i = 0; i < count; i++)
        if (at->places[i] >= 0)
            memcpy((unsigned char *)data + i * size, saved + (size_t)at->places[i] * size, size);
    at->at += at->place_count * size;
}

void pel_transfer_list(pel_cursor *at, void *data, size_t count, size_t size)
{
    pel_transfer(at, data, (at->places != NULL && at->load ? at->place_count : count) * size);
}

void pel_transfer_count(pel_cursor *at, int64_t *count, size_t least)
{
    pel_transfer(at, count, sizeof *count);
    if (!at->load || (!at->is_short && *count >= 0 && (uint64_t)*count <= (at->size - at->at) / least))
        return;
    at->is_short = true;
    *count = 0;
}

void pel_transfer_motion(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_state *state = sim->state;
    size_t count = (size_t)sim->model->vertex_count;
    pel_transfer_vertices(at, state->position, count, sizeof *state->position);
    pel_transfer_vertices(at, state->position_before, count, sizeof *state->position_before);
    if (state->velocity != NULL)
        pel_transfer_vertices(at, state->velocity, count, sizeof *state->velocity);
    if (state->rigids != NULL)
        pel_transfer(at, state->rigids, (size_t)sim->model->body_count * sizeof *state->rigids);
}

void pel_transfer_history(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_state *state = sim->state;
    size_t count = (size_t)sim->model->vertex_count;
    if (state->older_position != NULL) {
        pel_transfer_vertices(at, state->older_position, count, sizeof *state->older_position);
        pel_transfer_vertices(at, state->older_velocity, count, sizeof *state->older_velocity);
        pel_transfer(at, &state->older_is_known, sizeof state->older_is_known);
        pel_transfer(at, &state->collision, sizeof state->collision);
        pel_transfer(at, state->touched, (size_t)sim->model->body_count);
        pel_transfer(at, &state->unresolved, sizeof state->unresolved);
    }
}

void pel_transfer_marks(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_transfer_vertices(at, sim->state->contact, (size_t)sim->model->vertex_count, sizeof *sim->state->contact);
}

void pel_transfer_factors(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_transfer(at, sim->state->factors, (size_t)sim->model->body_count * sizeof *sim->state->factors);
}

void pel_transfer_bending(pel_cursor *at, const pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    pel_transfer(at, &sim->state->bending[body], sizeof *sim->state->bending);
}

void pel_transfer_held(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->held != NULL)
        pel_transfer(at, sim->held, (size_t)sim->model->vertex_count * sizeof *sim->held);
}

bool pel_is_list(const int32_t *list, int32_t count, size_t limit)
{
    if (count < 0 || (size_t)count > limit)
        return false;
    for (int32_t i = 0; i < count; i++)
        if (list[i] < 0 || (size_t)list[i] >= limit)
            return false;
    return true;
}
