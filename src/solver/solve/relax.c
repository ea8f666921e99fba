#include "solve/relax.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "force/body_force.h"

#include <string.h>

/* share of the stages' range of stability that is used, as for the base */
#define SAFE_SHARE 0.9

/* ---- lists ---- */

pel_status pel_relax_create(const pel_refined_model *active, pel_relax **relax, pel_error *error)
{
    const pel_model *model = &active->model;
    size_t vertices = (size_t)model->vertex_count, slices = (size_t)model->slice_count;
    *relax = NULL;
    pel_relax *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->active = active;
    made->revision = -1;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(made->slices, slices), PEL_ROOM(made->slice_begin, (size_t)model->body_count + 1),
                          PEL_ROOM(made->border, vertices), PEL_ROOM(made->is_border, vertices),
                          PEL_ROOM_ALIGNED(made->stage, vertices),
                          PEL_ROOM(made->inside, pel_slice_chunk_count(0, model->slice_count)))) {
        pel_relax_destroy(made);
        return pel_fail_memory(error);
    }
    *relax = made;
    return PEL_OK;
}

void pel_relax_destroy(pel_relax *relax)
{
    if (relax == NULL)
        return;
    PEL_FREE_ALL(relax->slices, relax->slice_begin, relax->border, relax->is_border, relax->stage, relax->inside,
                 relax);
}

static void list_slices(pel_relax *relax)
{
    const pel_refined_model *active = relax->active;
    const pel_model *model = &active->model;
    int32_t count = 0;
    relax->rate = 0;
    for (int32_t b = 0; b < model->body_count; b++) {
        relax->slice_begin[b] = count;
        for (int32_t s = model->bodies[b].slice_begin; s < model->bodies[b].slice_end; s++)
            if (active->fine_counts[s] > 0)
                relax->slices[count++] = s;
    }
    relax->slice_begin[model->body_count] = count;
    for (int32_t i = 0; i < count; i++)
        for (int32_t v = relax->slices[i] * PEL_WIDTH; v < (relax->slices[i] + 1) * PEL_WIDTH; v++)
            if (active->is_fine[v] && active->rates[v] > relax->rate)
                relax->rate = active->rates[v];
}

static void list_border(pel_relax *relax)
{
    const pel_refined_model *active = relax->active;
    const pel_model *model = &active->model;
    relax->border_count = 0;
    for (int32_t i = 0; i < relax->slice_begin[model->body_count]; i++) {
        int32_t slice = relax->slices[i];
        for (int32_t slot = model->slot_begin[slice]; slot < model->slot_end[slice]; slot++)
            for (int32_t lane = 0; lane < PEL_WIDTH; lane++) {
                int32_t v = model->neighbours[slot][lane];
                bool is_filler = v == slice * PEL_WIDTH + lane;
                if (is_filler || active->is_fine[v] || relax->is_border[v])
                    continue;
                relax->is_border[v] = 1;
                relax->border[relax->border_count++] = v;
            }
    }
    for (int32_t i = 0; i < relax->border_count; i++)
        relax->is_border[relax->border[i]] = 0;
}

bool pel_relax_follow(pel_relax *relax)
{
    if (relax->revision != relax->active->revision) {
        list_slices(relax);
        list_border(relax);
        relax->revision = relax->active->revision;
    }
    return relax->slice_begin[relax->active->model.body_count] > 0;
}

int32_t pel_relax_stage_count(const pel_relax *relax, double shell_rate)
{
    double range = relax->active->relaxation.factor * (relax->rate + shell_rate) / SAFE_SHARE;
    int32_t s = 1;
    while ((double)s * (s + 1) < range)
        s++;
    return s;
}

/* ---- stages ---- */

pel_record *pel_relax_positions(const pel_relax *relax, const pel_state *state, int32_t stage_count, int32_t j)
{
    return (stage_count - j) % 2 == 0 ? relax->stage : state->position_next;
}

void pel_relax_begin(pel_relax *relax, pel_state *state, bool whole)
{
    const pel_refined_model *active = relax->active;
    if (whole)
        memcpy(relax->stage, state->position_next, (size_t)active->model.vertex_count * sizeof *relax->stage);
    for (int32_t i = 0; i < relax->slice_begin[active->model.body_count]; i++)
        for (int32_t v = relax->slices[i] * PEL_WIDTH; v < (relax->slices[i] + 1) * PEL_WIDTH; v++) {
            if (active->is_fine[v])
                state->position_next[v] = state->position[v];
            relax->stage[v] = state->position_next[v];
        }
    for (int32_t i = 0; i < relax->border_count; i++)
        relax->stage[relax->border[i]] = state->position_next[relax->border[i]];
}

typedef struct stage {
    const pel_relax *relax;
    const pel_state *state;
    const pel_record *now; /* Y_(j-1) */
    pel_record *next;      /* Y_(j-2), then Y_j */
    const pel_record *force;
    const uint8_t *held;
    int32_t begin, end; /* of the list of slices */
    pel_body_force body;
    pel_real momentum, share; /* (j-1)/j, (2j-1)/j 2/(s^2+s) */
    pel_real square_bound;
} stage;

/* alpha dt^2 / m of fine vertices, 0 for others: the state has no inverse mass for fine ones */
static pel_wide mobility(const stage *run, int32_t slice, pel_wide state_inverse_mass)
{
    const pel_model *model = &run->relax->active->model;
    const pel_wide *inverse_mass = (const pel_wide *)model->inverse_mass;
    pel_wide factor = pel_wide_splat((pel_real)run->relax->active->relaxation.factor);
    factor *= inverse_mass[slice] - state_inverse_mass;
    static const uint8_t none[PEL_WIDTH];
    const uint8_t *held = run->held != NULL ? run->held + slice * PEL_WIDTH : none;
    for (int32_t lane = 0; memcmp(held, none, sizeof none) != 0 && lane < PEL_WIDTH; lane++)
        if (held[lane])
            factor[lane] = 0;
    return factor;
}

/* divides a displacement by 1 + b, and by 1 + b + b' along the volumetric spring */
static void drag(const stage *run, int32_t slice, pel_wide factor, pel_wide3 *way)
{
    const pel_refined_model *active = run->relax->active;
    const pel_model *model = &active->model;
    const pel_wide *damping = (const pel_wide *)model->damping, *radial = (const pel_wide *)model->volumetric_damping;
    pel_slice start = pel_slice_load(run->state->position, slice), rest = pel_slice_load(model->rest, slice);
    pel_wide3 e = {start.position.x - rest.position.x, start.position.y - rest.position.y,
                   start.position.z - rest.position.z};
    pel_wide one = pel_wide_splat(1), rate = factor * pel_wide_splat((pel_real)(1 / active->relaxation.dt));
    pel_wide all = one + rate * pel_wide_splat(run->body.damping) * damping[slice];
    pel_wide along = rate * pel_wide_splat(run->body.volumetric_damping) * radial[slice];
    pel_wide c = pel_volumetric_damping(e, *way, along / (all + along));
    way->x = (way->x - c * e.x) / all;
    way->y = (way->y - c * e.y) / all;
    way->z = (way->z - c * e.z) / all;
}

/* returns whether the fine vertices of the slice stay inside the bound */
static bool stage_slice(const stage *run, int32_t slice, const pel_slice *own, pel_wide3 force)
{
    pel_slice before = pel_slice_load(run->next, slice), outer = pel_slice_load(run->force, slice);
    pel_wide factor = mobility(run, slice, own->inverse_mass), kept = pel_wide_splat(run->momentum);
    pel_wide3 way = {factor * (force.x + outer.position.x), factor * (force.y + outer.position.y),
                     factor * (force.z + outer.position.z)};
    if (run->relax->active->relaxation.keep_velocity)
        drag(run, slice, factor, &way);
    pel_wide share = pel_wide_splat(run->share);
    pel_wide3 next = {own->position.x + kept * (own->position.x - before.position.x) + share * way.x,
                      own->position.y + kept * (own->position.y - before.position.y) + share * way.y,
                      own->position.z + kept * (own->position.z - before.position.z) + share * way.z};
    pel_slice_store(run->next, slice, next, own->inverse_mass);
    pel_wide_mask inside = pel_wide3_dot(next, next) < pel_wide_splat(run->square_bound);
    return pel_wide_all(inside);
}

static void run_chunk(void *context, int32_t chunk)
{
    const stage *run = context;
    const pel_model *model = &run->relax->active->model;
    const int32_t *slices = run->relax->slices;
    int32_t first = run->begin + chunk * PEL_SLICE_CHUNK;
    int32_t last = run->end - first < PEL_SLICE_CHUNK ? run->end : first + PEL_SLICE_CHUNK;
    pel_wide longest = pel_wide_splat(0);
    pel_slice own = pel_slice_load(run->now, slices[first]);
    pel_slot_flight flight = pel_slot_begin(model, run->now, model->slot_begin[slices[first]], &own.position);
    bool inside = true;
    for (int32_t i = first; i < last; i++) {
        int32_t slice = slices[i], next = slices[i + 1 < last ? i + 1 : i];
        pel_slice next_own = pel_slice_load(run->now, next);
        pel_wide3 force = pel_spring_force(model, run->now, slice, &own.position, next, &next_own.position,
                                           run->body.uniform, &flight, &longest);
        pel_add_volumetric(model, slice, &own.position, &run->body, &force);
        inside &= stage_slice(run, slice, &own, force);
        own = next_own;
    }
    run->relax->inside[chunk] = inside;
}

bool pel_relax_stage(pel_relax *relax, pel_state *state, const pel_record *force, const uint8_t *held, pel_pool *pool,
                     double bound, int32_t stage_count, int32_t j)
{
    const pel_model *model = &relax->active->model;
    bool inside = true;
    for (int32_t b = 0; b < model->body_count; b++) {
        stage run = {
            .relax = relax,
            .state = state,
            .now = pel_relax_positions(relax, state, stage_count, j),
            .next = pel_relax_positions(relax, state, stage_count, j + 1),
            .force = force,
            .held = held,
            .begin = relax->slice_begin[b],
            .end = relax->slice_begin[b + 1],
            .body = pel_body_force_of(model, state, b),
            .momentum = (pel_real)((j - 1.0) / j),
            .share = (pel_real)((2.0 * j - 1) / j * 2 / ((double)stage_count * (stage_count + 1))),
            .square_bound = (pel_real)(bound * bound),
        };
        int32_t chunk_count = pel_slice_chunk_count(run.begin, run.end);
        pel_pool_run(pool, chunk_count, run_chunk, &run);
        for (int32_t chunk = 0; chunk < chunk_count; chunk++)
            inside &= relax->inside[chunk];
    }
    return inside;
}
