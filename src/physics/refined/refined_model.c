#include "refined/refined_model.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/vec3.h"
#include "refined/event_energy.h"

#include <math.h>
#include <string.h>

/* springs that a vertex in the middle of an edge has at most: six neighbours and a bisector between any two */
enum { FINE_VALENCE = 12 };

typedef struct pel_row_spring {
    int32_t edge, vertex;
    double stiffness;
} row_spring;

/* contribution of one triangle to the row of a vertex */
typedef struct pel_row_triangle {
    int32_t level, t;
    int split;    /* its split edge, -1 = whole */
    bool is_base; /* a whole triangle of the mesh */
    double share; /* area that counts for masses [m2] */
    double area;  /* at rest [m2] */
} row_triangle;

bool pel_model_refines(const pel_model *model)
{
    for (int32_t b = 0; b < model->body_count; b++)
        if (model->bodies[b].detail != NULL)
            return true;
    return false;
}

/* ---- room ---- */

static int32_t fine_vertex_count(const pel_body_levels *detail)
{
    return detail->forest->levels[detail->forest->depth]->vertex_count;
}

/* places that the finer vertices of a body need at most: each splits an edge and makes at least one more triangle */
static int32_t fine_capacity(const pel_body_levels *detail)
{
    const pel_topology *base = detail->forest->levels[0];
    int32_t all = fine_vertex_count(detail) - base->vertex_count;
    int32_t budget = detail->def.budget, extra = budget - base->triangle_count;
    /* twice: in an event new ones are added before old ones are removed */
    int32_t asked = budget > 0 && extra < all / 2 ? 2 * extra : all;
    return (asked + PEL_WIDTH - 1) / PEL_WIDTH * PEL_WIDTH;
}

static pel_status check_budget(const pel_model *model, int32_t body, pel_error *error)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_body_levels *detail = model->bodies[body].detail;
    int32_t least = detail->forest->levels[detail->def.everywhere ? detail->forest->depth : 0]->triangle_count;
    if (detail->def.budget == 0 || detail->def.budget >= least)
        return PEL_OK;
    pel_fail(error, PEL_BAD_ARGUMENT, "refine: the budget is %d triangles, %d are needed", (int)detail->def.budget,
             (int)least);
    pel_fail_element(error, "body", body);
    pel_fail_remedy(error, "give at least %d, or leave the budget out", (int)least);
    return PEL_BAD_ARGUMENT;
}

/* places of the bodies in the active model, and its counts */
static pel_status lay_out(pel_refined_model *active, pel_error *error)
{
    pel_model *model = &active->model;
    model->slice_count = model->triangle_count = 0;
    for (int32_t b = 0; b < model->body_count; b++) {
        pel_body *body = &model->bodies[b];
        pel_refined_body *own = &active->bodies[b];
        int32_t base_slices = body->slice_end - body->slice_begin;
        body->slice_begin = model->slice_count;
        body->slice_end = model->slice_count + base_slices;
        own->fine_begin = own->fine_end = own->fine_limit = body->slice_end * PEL_WIDTH;
        model->slice_count = body->slice_end;
        if (body->detail == NULL) {
            model->triangle_count += body->mesh->triangle_count;
            continue;
        }
        pel_status status = check_budget(model, b, error);
        if (status == PEL_OK)
            status = pel_front_create(body->detail->forest, &own->front, error);
        if (status != PEL_OK)
            return status;
        body->front = own->front;
        int32_t fine = fine_capacity(body->detail);
        own->fine_limit += fine;
        own->triangle_limit = body->detail->def.budget > 0 ? body->detail->def.budget : INT32_MAX;
        model->slice_count += fine / PEL_WIDTH;
        model->triangle_count += 2 * own->front->node_count;
    }
    model->vertex_count = model->slice_count * PEL_WIDTH;
    return PEL_OK;
}

static bool allocate_places(pel_refined_model *active)
{
    size_t count = (size_t)active->model.vertex_count;
    size_t slices = (size_t)active->model.slice_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(active->valence, count), PEL_ROOM(active->change, count),
                          PEL_ROOM(active->areas, count), PEL_ROOM(active->is_base, count),
                          PEL_ROOM(active->is_fine, count), PEL_ROOM(active->rates, count),
                          PEL_ROOM(active->fine_counts, slices), PEL_ROOM(active->mixed_counts, slices),
                          PEL_ROOM(active->model.plain_slices, slices), PEL_ROOM(active->is_dirty, count),
                          PEL_ROOM(active->dirty, count), PEL_ROOM(active->released, count),
                          PEL_ROOM(active->event_places, count), PEL_ROOM_ALIGNED(active->event_direction, count)))
        return false;
    memset(active->is_base, 1, count);
    memset(active->model.plain_slices, 1, slices);
    return true;
}

static bool allocate_body(pel_refined_model *active, int32_t b)
{
    PEL_ASSERT_INDEX(b, active->model.body_count);
    pel_body *body = &active->model.bodies[b];
    pel_refined_body *own = &active->bodies[b];
    body->model_index = pel_allocate((size_t)body->mesh->vertex_count, sizeof *body->model_index);
    if (body->model_index == NULL)
        return false;
    if (body->detail == NULL)
        return true;
    size_t words = (size_t)(own->fine_limit - own->fine_begin) / 64 + 1;
    return PEL_ALLOCATE_ALL(PEL_ROOM(own->used, words), PEL_ROOM(own->model_index, fine_vertex_count(body->detail)));
}

/* slots of each slice; returns the longest row of a body that refines */
static int32_t lay_out_slots(pel_refined_model *active)
{
    pel_model *model = &active->model;
    int32_t longest = FINE_VALENCE;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b], *given = &active->given->bodies[b];
        int32_t limit = active->bodies[b].fine_limit / PEL_WIDTH;
        for (int32_t s = body->slice_begin; s < limit; s++) {
            int32_t from = given->slice_begin + s - body->slice_begin, room = FINE_VALENCE;
            if (s < body->slice_end)
                room = active->given->slot_begin[from + 1] - active->given->slot_begin[from];
            if (s < body->slice_end && body->detail != NULL)
                room *= 2;
            longest = room > longest ? room : longest;
            model->slot_begin[s + 1] = model->slot_end[s] = model->slot_begin[s] + room;
            model->body_of_slice[s] = b;
        }
    }
    return longest;
}

/* longest: springs of a row at most */
static bool allocate_row(pel_refined_model *active, int32_t longest)
{
    active->fan_limit = longest + 1;
    return PEL_ALLOCATE_ALL(PEL_ROOM(active->fan, active->fan_limit), PEL_ROOM(active->row, active->fan_limit),
                            PEL_ROOM(active->around, active->fan_limit));
}

/* ---- the plain part ---- */

/* A place that no vertex has is where the first one of its body is, whatever had it before: the order of a factor
   depends on the places of all. */
static void rest_unused(pel_refined_model *active, int32_t b, int32_t place)
{
    const pel_model *given = active->given;
    active->model.rest[place] = given->rest[given->bodies[b].slice_begin * PEL_WIDTH];
    active->model.rest[place][3] = 0;
    active->model.mesh_vertex[place] = -1;
}

/* vertices of a body's mesh, and its springs with the places shifted */
static void copy_vertices(pel_refined_model *active, int32_t b)
{
    PEL_ASSERT_INDEX(b, active->model.body_count);
    pel_model *model = &active->model;
    const pel_model *given = active->given;
    const pel_body *body = &model->bodies[b];
    int32_t shift = (body->slice_begin - given->bodies[b].slice_begin) * PEL_WIDTH;
    for (int32_t v = 0; v < body->mesh->vertex_count; v++)
        body->model_index[v] = given->bodies[b].model_index[v] + shift;
    int32_t limit = active->bodies[b].fine_limit;
    for (int32_t i = body->slice_begin * PEL_WIDTH; i < limit; i++) {
        int32_t from = i - shift;
        if (i >= body->slice_end * PEL_WIDTH) {
            rest_unused(active, b, i);
            continue;
        }
        model->rest[i] = given->rest[from];
        model->mesh_vertex[i] = given->mesh_vertex[from];
        model->mass[i] = given->mass[from];
        model->inverse_mass[i] = given->inverse_mass[from];
        model->damping[i] = given->damping[from];
        model->volumetric_damping[i] = given->volumetric_damping[from];
    }
}

static void copy_springs(pel_refined_model *active, int32_t b)
{
    PEL_ASSERT_INDEX(b, active->model.body_count);
    pel_model *model = &active->model;
    const pel_model *given = active->given;
    const pel_body *body = &model->bodies[b];
    int32_t shift = (body->slice_begin - given->bodies[b].slice_begin) * PEL_WIDTH;
    for (int32_t s = body->slice_begin; s < body->slice_end; s++) {
        int32_t from = given->slot_begin[s - shift / PEL_WIDTH], to = model->slot_begin[s];
        for (int32_t i = 0; i < model->slot_end[s] - to; i++) {
            for (int32_t lane = 0; lane < PEL_WIDTH; lane++)
                model->rest_lengths[to + i][lane] =
                    pel_model_rest_length(given, from + i, s * PEL_WIDTH - shift + lane);
            if (given->stiffnesses != NULL) {
                model->stiffnesses[to + i] = given->stiffnesses[from + i];
                model->products[to + i] = given->products[from + i];
            }
            for (int32_t lane = 0; lane < PEL_WIDTH; lane++)
                model->neighbours[to + i][lane] = given->neighbours[from + i][lane] + shift;
        }
    }
}

/* triangles and fans of a body that does not refine */
static void copy_triangles(pel_refined_model *active, int32_t b)
{
    PEL_ASSERT_INDEX(b, active->model.body_count);
    pel_model *model = &active->model;
    const pel_model *given = active->given;
    const pel_body *body = &model->bodies[b], *from = &given->bodies[b];
    int32_t shift = (body->slice_begin - from->slice_begin) * PEL_WIDTH;
    int32_t turn = model->triangle_begin[b] - given->triangle_begin[b];
    for (int32_t t = given->triangle_begin[b]; t < given->triangle_begin[b + 1]; t++)
        for (int c = 0; c < 3; c++)
            model->triangles[t + turn][c] = given->triangles[t][c] + shift;
    for (int32_t i = from->slice_begin * PEL_WIDTH; i < from->slice_end * PEL_WIDTH; i++) {
        model->fan_begin[i + shift] = given->fan_begin[i];
        model->fan_begin[i + shift + 1] = given->fan_begin[i + 1];
        for (int32_t f = given->fan_begin[i]; f < given->fan_begin[i + 1]; f++)
            model->fans[f] = given->fans[f] + turn;
    }
}

/* ---- rows ---- */

static row_triangle row_triangle_of(const pel_body_levels *detail, const pel_front *front,
                                    const pel_front_corner *corner)
{
    int32_t level = pel_front_level(front, corner->node), t = corner->node - front->node_begin[level];
    uint8_t shape = front->shapes[corner->node];
    bool green = pel_front_is_green(shape);
    double share = detail->areas[t >> (2 * level)] / (double)(INT64_C(1) << (2 * level));
    row_triangle triangle = {.level = level,
                             .t = t,
                             .split = green ? shape - PEL_FRONT_BISECTED : -1,
                             .is_base = level == 0 && !green,
                             .share = green ? share / 2 : share};
    /* from the triangle's own corners in their order: the same bits seen from each of them */
    const pel_front_triangle *own = &front->triangles[front->place_of_node[corner->node][corner->half]];
    const double(*x)[3] = (const double(*)[3])front->forest->rest_positions;
    triangle.area = pel_vec3_triangle_area(x[own->vertices[0]], x[own->vertices[1]], x[own->vertices[2]]);
    return triangle;
}

/* number of edge k of a triangle over all levels */
static int32_t edge_number(const pel_front *front, const row_triangle *triangle, int k)
{
    return pel_lod_midpoint(front->forest->levels[triangle->level], 3 * triangle->t + k) -
           front->forest->levels[0]->vertex_count;
}

/* a number given on the edges of the base, for an edge of a triangle of the surface; bisectors take the mean */
static double edge_value(const pel_body_levels *detail, const pel_front *front, const row_triangle *triangle,
                         int32_t edge, const double *values)
{
    PEL_ASSERT_INDEX(edge, front->bisector_begin + front->node_count);
    int32_t level = triangle->level, t = triangle->t;
    if (edge >= front->bisector_begin) {
        double sum = 0;
        for (int k = 0; k < 3; k++)
            sum += values[pel_levels_base_edge(detail, level, t, k)];
        return sum / 3;
    }
    for (int k = 0; k < 3; k++)
        if (k != triangle->split && edge_number(front, triangle, k) == edge)
            return values[pel_levels_base_edge(detail, level, t, k)];
    return values[pel_levels_base_edge(detail, level, t, triangle->split)];
}

/* stiffness of an edge from its one or two triangles (null = none) */
static double edge_stiffness(const pel_body_levels *detail, const pel_front *front, int32_t v, int32_t other,
                             int32_t edge, const row_triangle *sides[2])
{
    PEL_ASSERT_INDEX(v, front->forest->levels[front->forest->depth]->vertex_count);
    PEL_ASSERT_INDEX(edge, front->bisector_begin + front->node_count);
    bool unchanged = detail->def.springs == PEL_REFINE_UNCHANGED;
    double sum = 0, d[3];
    int count = 0, base = 0;
    for (int s = 0; s < 2; s++) {
        if (sides[s] == NULL)
            continue;
        count++;
        base += sides[s]->is_base;
        sum += unchanged ? edge_value(detail, front, sides[s], edge, detail->stiffnesses)
                         : edge_value(detail, front, sides[s], edge, detail->moduli) * sides[s]->area;
    }
    if (base == count)
        return detail->stiffnesses[edge];
    if (unchanged)
        return sum / count;
    const double(*x)[3] = (const double(*)[3])front->forest->rest_positions;
    pel_vec3_subtract(x[other], x[v], d);
    return sum / pel_vec3_squared_length(d);
}

/* the springs of a vertex by their edges' numbers; returns how many */
static int32_t collect_row(pel_refined_model *active, const pel_body_levels *detail, const pel_front *front, int32_t v,
                           int32_t fan_count)
{
    PEL_ASSERT_INDEX(v, front->forest->levels[front->forest->depth]->vertex_count);
    const pel_front_corner *fan = active->fan;
    const row_triangle *around = active->around;
    bool open = fan[fan_count - 1].previous_edge != fan[0].next_edge;
    int32_t count = 0;
    for (int32_t i = 0; i < fan_count + open; i++) {
        const row_triangle *sides[2] = {i < fan_count ? &around[i] : NULL,
                                        i > 0 ? &around[i - 1] : (open ? NULL : &around[fan_count - 1])};
        int32_t edge = i < fan_count ? fan[i].next_edge : fan[i - 1].previous_edge;
        int32_t other = i < fan_count ? fan[i].next : fan[i - 1].previous, at = count++;
        row_spring spring = {edge, other, edge_stiffness(detail, front, v, other, edge, sides)};
        for (; at > 0 && active->row[at - 1].edge > edge; at--)
            active->row[at] = active->row[at - 1];
        active->row[at] = spring;
    }
    return count;
}

/* the springs of one place; in the rest of its lane, springs to itself stay */
static void write_row(pel_refined_model *active, const pel_refined_body *own, int32_t place, int32_t count)
{
    PEL_ASSERT_INDEX(place, active->model.vertex_count);
    pel_model *model = &active->model;
    int32_t slice = place / PEL_WIDTH, begin = model->slot_begin[slice], longest = 1;
    for (int32_t s = 0; s < count; s++)
        pel_model_set_spring(model, begin + s, place, own->model_index[active->row[s].vertex],
                             active->row[s].stiffness);
    for (int32_t s = count; s < active->valence[place]; s++)
        pel_model_set_spring(model, begin + s, place, place, 0);
    active->valence[place] = count;
    for (int32_t i = slice * PEL_WIDTH; i < (slice + 1) * PEL_WIDTH; i++)
        longest = active->valence[i] > longest ? active->valence[i] : longest;
    model->slot_end[slice] = begin + longest;
}

/* a vertex amid triangles of the base has the numbers that were given */
static void set_given(pel_refined_model *active, int32_t body, int32_t v, int32_t place)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    PEL_ASSERT_INDEX(place, active->model.vertex_count);
    pel_model *model = &active->model;
    const pel_model *given = active->given;
    int32_t from = given->bodies[body].model_index[v];
    model->rest[place] = given->rest[from];
    model->mass[place] = given->mass[from];
    model->inverse_mass[place] = given->inverse_mass[from];
    model->damping[place] = given->damping[from];
    model->volumetric_damping[place] = given->volumetric_damping[from];
}

static void set_shared(pel_refined_model *active, int32_t body, int32_t v, int32_t place, double area)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    PEL_ASSERT_INDEX(place, active->model.vertex_count);
    pel_model *model = &active->model;
    const pel_body_levels *detail = model->bodies[body].detail;
    const pel_nodal *density = &detail->densities[v];
    const double *x = detail->forest->rest_positions[v];
    model->rest[place] =
        (pel_record){(pel_real)x[0], (pel_real)x[1], (pel_real)x[2], (pel_real)(density->volumetric_stiffness * area)};
    model->mass[place] = (pel_real)(density->mass * area);
    model->inverse_mass[place] = detail->pinned[v] ? 0 : 1 / model->mass[place];
    model->damping[place] = (pel_real)(density->damping * area);
    model->volumetric_damping[place] = (pel_real)(density->volumetric_damping * area);
}

/* ---- fine vertices ---- */

static void set_fine(pel_refined_model *active, int32_t place, bool fine, pel_state *state)
{
    PEL_ASSERT_INDEX(place, active->model.vertex_count);
    uint8_t *is_fine = &active->is_fine[place], *count = &active->fine_counts[place / PEL_WIDTH];
    *count = (uint8_t)(*count + fine - *is_fine);
    *is_fine = fine;
    if (state != NULL)
        state->position[place][3] = fine ? 0 : active->model.inverse_mass[place];
}

static void set_base(pel_refined_model *active, int32_t place, bool base)
{
    PEL_ASSERT_INDEX(place, active->model.vertex_count);
    int32_t slice = place / PEL_WIDTH;
    active->mixed_counts[slice] = (uint8_t)(active->mixed_counts[slice] + active->is_base[place] - base);
    active->is_base[place] = base;
    active->model.plain_slices[slice] = active->mixed_counts[slice] == 0;
}

/* notes the rate of a vertex off the base by its row (Gershgorin's bound), and whether it is fine */
static void judge_row(pel_refined_model *active, int32_t body, int32_t place, int32_t count, pel_state *state)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    PEL_ASSERT_INDEX(place, active->model.vertex_count);
    const pel_model *model = &active->model;
    const pel_relaxation *relaxation = &active->relaxation;
    const pel_curve *curves = model->bodies[body].curves;
    double sum = 0, inverse_mass = (double)model->inverse_mass[place];
    for (int32_t s = 0; s < count; s++)
        sum += active->row[s].stiffness;
    double stiffness = 2 * sum * pel_curve_largest(&curves[PEL_SPRING_STIFFNESS]) +
                       (double)model->rest[place][3] * pel_curve_largest(&curves[PEL_VOLUMETRIC_STIFFNESS]);
    double drag = (double)model->damping[place] * pel_curve_largest(&curves[PEL_SPRING_DAMPING]) +
                  (double)model->volumetric_damping[place] * pel_curve_largest(&curves[PEL_VOLUMETRIC_DAMPING]);
    drag = relaxation->keep_velocity ? drag / relaxation->dt : 0;
    active->rates[place] = stiffness * inverse_mass;
    bool fine = inverse_mass > 0 && !active->is_base[place] &&
                relaxation->factor * inverse_mass * (stiffness + 2 * drag) > relaxation->limit;
    set_fine(active, place, fine && relaxation->factor > 0, state);
}

/* forces of shells reach over two triangles: while any triangle is refined, all vertices of the body count as fine */
static void judge_shell(pel_refined_model *active, int32_t body, pel_state *state)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    const pel_refined_body *own = &active->bodies[body];
    bool fine = active->relaxation.factor > 0 && own->front->red_count > 0;
    for (int32_t i = 0; i < own->front->vertex_count; i++) {
        int32_t place = own->model_index[own->front->vertices[i]];
        set_fine(active, place, fine && active->model.inverse_mass[place] > 0, state);
    }
}

static void rebuild_vertex(pel_refined_model *active, int32_t body, int32_t v, pel_state *state)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    const pel_refined_body *own = &active->bodies[body];
    const pel_body_levels *detail = active->model.bodies[body].detail;
    int32_t place = own->model_index[v], fan_count = pel_front_fan(own->front, v, active->fan);
    double area = 0;
    bool base = true;
    for (int32_t i = 0; i < fan_count; i++) {
        active->around[i] = row_triangle_of(detail, own->front, &active->fan[i]);
        area += active->around[i].share;
        base &= active->around[i].is_base;
    }
    if (base)
        set_given(active, body, v, place);
    else
        set_shared(active, body, v, place, area);
    active->areas[place] = area;
    set_base(active, place, base);
    int32_t count = collect_row(active, detail, own->front, v, fan_count);
    judge_row(active, body, place, count, state);
    write_row(active, own, place, count);
}

/* ---- places ---- */

static int32_t take_place(pel_refined_body *own)
{
    PEL_ASSERT(own->lowest_free >= 0 && own->lowest_free <= own->fine_limit - own->fine_begin);
    int32_t word = own->lowest_free / 64;
    while (own->used[word] == UINT64_MAX)
        word++;
    int32_t place = 64 * word;
    while (own->used[word] >> (place % 64) & 1)
        place++;
    own->used[word] |= UINT64_C(1) << (place % 64);
    own->lowest_free = place + 1;
    place += own->fine_begin;
    PEL_ASSERT(place < own->fine_limit);
    own->fine_end = place < own->fine_end ? own->fine_end : place + 1;
    return place;
}

static void give_back(pel_refined_body *own, int32_t place)
{
    int32_t at = place - own->fine_begin;
    PEL_ASSERT(at >= 0 && place < own->fine_end);
    PEL_ASSERT((own->used[at / 64] >> (at % 64) & 1) != 0);
    own->used[at / 64] &= ~(UINT64_C(1) << (at % 64));
    own->lowest_free = at < own->lowest_free ? at : own->lowest_free;
    for (int32_t last = own->fine_end - own->fine_begin - 1;
         last >= 0 && (own->used[last / 64] >> (last % 64) & 1) == 0; last--)
        own->fine_end--;
}

/* a place without mass and springs, as padding is */
static void clear_place(pel_refined_model *active, int32_t place, pel_state *state)
{
    PEL_ASSERT_INDEX(place, active->model.vertex_count);
    pel_model *model = &active->model;
    rest_unused(active, model->body_of_slice[place / PEL_WIDTH], place);
    model->mass[place] = model->inverse_mass[place] = 0;
    model->damping[place] = model->volumetric_damping[place] = 0;
    write_row(active, NULL, place, 0);
    set_fine(active, place, false, state);
    set_base(active, place, true);
    if (state == NULL)
        return;
    state->position_before[place] = state->position_next[place] = state->position[place];
    state->contact[place] = 0;
    if (state->velocity != NULL)
        state->velocity[place] = state->velocity_next[place] = (pel_record){0};
}

/* ---- an event ---- */

static void note_dirty(pel_refined_model *active, const pel_refined_body *own, int32_t v)
{
    int32_t place = own->model_index[v];
    if (!pel_front_has_vertex(own->front, v) || active->is_dirty[place])
        return;
    active->is_dirty[place] = 1;
    active->dirty[active->dirty_count++] = v;
}

/* the energy of the elements that the event removes, before their rows change */
static void note_energy(pel_refined_model *active, int32_t body, const pel_state *state)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    const pel_refined_body *own = &active->bodies[body];
    const pel_front *front = own->front;
    int32_t count = 0;
    for (int32_t c = 0; c < front->change_count; c++) {
        int32_t node = front->changes[c].node, level = pel_front_level(front, node);
        const pel_topology *topology = front->forest->levels[level];
        for (int k = 0; k < 6; k++) {
            int32_t t = node - front->node_begin[level];
            if (k >= 3 && level == front->forest->depth)
                break;
            int32_t v = k < 3 ? topology->triangles[t][k] : pel_lod_midpoint(topology, 3 * t + k - 3);
            int32_t place = own->model_index[v];
            if (place < 0 || active->is_dirty[place])
                continue;
            active->is_dirty[place] = 1;
            active->event_places[count++] = place;
        }
    }
    active->event_energy = pel_event_energy(active, body, state, active->event_places, count, NULL);
}

static void collect_dirty(pel_refined_model *active, const pel_refined_body *own)
{
    const pel_front *front = own->front;
    active->dirty_count = 0;
    for (int32_t c = 0; c < front->change_count; c++) {
        int32_t node = front->changes[c].node, level = pel_front_level(front, node);
        const pel_topology *topology = front->forest->levels[level];
        int32_t t = node - front->node_begin[level];
        for (int k = 0; k < 3; k++) {
            note_dirty(active, own, topology->triangles[t][k]);
            if (level < front->forest->depth)
                note_dirty(active, own, pel_lod_midpoint(topology, 3 * t + k));
        }
    }
    for (int32_t d = 0; d < active->dirty_count; d++)
        active->is_dirty[own->model_index[active->dirty[d]]] = 0;
}

static void write_triangles(pel_refined_model *active, int32_t body, int32_t node)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    const pel_refined_body *own = &active->bodies[body];
    for (int half = 0; half < 2; half++) {
        int32_t at = own->front->place_of_node[node][half];
        if (at < 0)
            continue;
        const pel_front_triangle *triangle = &own->front->triangles[at];
        int32_t *written = active->model.triangles[active->model.triangle_begin[body] + pel_surface_number(triangle)];
        for (int c = 0; c < 3; c++)
            written[c] = own->model_index[triangle->vertices[c]];
    }
}

static void update_body(pel_refined_model *active, int32_t body, pel_state *state)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    active->revision++;
    pel_body *b = &active->model.bodies[body];
    const pel_refined_body *own = &active->bodies[body];
    double given = active->given->bodies[body].uniform_spring;
    bool base = own->front->red_count == 0 || b->detail->def.springs == PEL_REFINE_UNCHANGED;
    b->uniform_spring = base ? given : -1;
    b->slice_end = (own->fine_end + PEL_WIDTH - 1) / PEL_WIDTH;
    if (own->shell == NULL)
        return;
    judge_shell(active, body, state);
    pel_shell_front_update(own->shell, own->front, own->model_index);
    b->rest_volume = own->front->red_count == 0 ? active->given->bodies[body].rest_volume
                                                : pel_shell_front_rest_volume(own->shell, own->front);
}

void pel_refined_commit(pel_refined_model *active, int32_t body, pel_state *state)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    pel_refined_body *own = &active->bodies[body];
    pel_front *front = own->front;
    pel_front_commit(front);
    active->dirty_count = active->released_count = 0;
    if (front->change_count == 0)
        return;
    note_energy(active, body, state);
    for (int32_t i = 0; i < front->added_count; i++) {
        int32_t place = take_place(own);
        own->model_index[front->added_vertices[i]] = place;
        active->model.mesh_vertex[place] = front->added_vertices[i];
    }
    pel_refine_transfer_positions(active, body, state);
    pel_refine_transfer_gather(active, body, state);
    for (int32_t i = 0; i < front->removed_count; i++) {
        int32_t v = front->removed_vertices[i];
        active->released[active->released_count++] = own->model_index[v];
        own->model_index[v] = -1;
    }
    collect_dirty(active, own);
    for (int32_t d = 0; d < active->dirty_count; d++) {
        int32_t v = active->dirty[d];
        const double *x = front->forest->rest_positions[v];
        for (int i = 0; i < 3; i++)
            active->model.rest[own->model_index[v]][i] = (pel_real)x[i];
    }
    for (int32_t d = 0; d < active->dirty_count; d++)
        rebuild_vertex(active, body, active->dirty[d], state);
    pel_refine_transfer_apply(active, body, state);
    for (int32_t i = 0; i < active->released_count; i++) {
        clear_place(active, active->released[i], state);
        give_back(own, active->released[i]);
    }
    for (int32_t c = 0; c < front->change_count; c++)
        write_triangles(active, body, front->changes[c].node);
    update_body(active, body, state);
}

void pel_refined_rebuild(pel_refined_model *active, int32_t body, pel_state *state)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    const pel_refined_body *own = &active->bodies[body];
    for (int32_t i = 0; i < own->front->vertex_count; i++) {
        int32_t v = own->front->vertices[i];
        const double *x = own->front->forest->rest_positions[v];
        for (int c = 0; c < 3; c++)
            active->model.rest[own->model_index[v]][c] = (pel_real)x[c];
    }
    for (int32_t i = 0; i < own->front->vertex_count; i++)
        rebuild_vertex(active, body, own->front->vertices[i], state);
    for (int32_t i = 0; i < own->front->triangle_count; i++)
        write_triangles(active, body, own->front->triangles[i].node);
    update_body(active, body, state);
}

bool pel_refined_set_places(pel_refined_model *active, int32_t body, const int32_t *vertex_of_place)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    pel_refined_body *own = &active->bodies[body];
    const pel_front *front = own->front;
    int32_t base_count = front->forest->levels[0]->vertex_count, fine_count = 0;
    int32_t limit = own->fine_limit - own->fine_begin, last = front->forest->levels[front->forest->depth]->vertex_count;
    for (int32_t at = 0; at < limit; at++) {
        int32_t v = vertex_of_place[at];
        if (v < -1 || (v >= 0 && (v < base_count || v >= last || !pel_front_has_vertex(front, v))))
            return false;
        fine_count += v >= 0;
    }
    if (fine_count != front->vertex_count - base_count)
        return false;
    memset(own->used, 0, ((size_t)limit / 64 + 1) * sizeof *own->used);
    own->fine_end = own->fine_begin;
    own->lowest_free = 0;
    for (int32_t at = 0; at < limit; at++) {
        int32_t place = own->fine_begin + at;
        clear_place(active, place, NULL);
        if (vertex_of_place[at] < 0)
            continue;
        own->used[at / 64] |= UINT64_C(1) << (at % 64);
        own->model_index[vertex_of_place[at]] = place;
        active->model.mesh_vertex[place] = vertex_of_place[at];
        own->fine_end = place + 1;
    }
    return true;
}

/* ---- creation ---- */

static void start_body(pel_refined_model *active, int32_t b)
{
    PEL_ASSERT_INDEX(b, active->model.body_count);
    pel_model *model = &active->model;
    const pel_body *body = &model->bodies[b];
    pel_refined_body *own = &active->bodies[b];
    copy_vertices(active, b);
    if (body->detail == NULL) {
        copy_springs(active, b);
        copy_triangles(active, b);
        return;
    }
    memset(own->model_index, -1, (size_t)fine_vertex_count(body->detail) * sizeof *own->model_index);
    for (int32_t v = 0; v < body->mesh->vertex_count; v++)
        own->model_index[v] = body->model_index[v];
    for (int32_t place = body->slice_begin * PEL_WIDTH; place < own->fine_limit; place++) {
        int32_t slice = place / PEL_WIDTH;
        active->valence[place] = model->slot_begin[slice + 1] - model->slot_begin[slice];
        write_row(active, own, place, 0);
    }
    pel_refined_rebuild(active, b, NULL);
}

static pel_status create_shell(pel_refined_model *active, int32_t b, pel_error *error)
{
    PEL_ASSERT_INDEX(b, active->model.body_count);
    const pel_body *given = &active->given->bodies[b];
    pel_body *body = &active->model.bodies[b];
    pel_refined_body *own = &active->bodies[b];
    if (given->shell == NULL)
        return PEL_OK;
    int32_t limit = given->shell->triangle_count;
    const int32_t(*corners)[3] = (const int32_t(*)[3])active->model.triangles + active->model.triangle_begin[b];
    if (body->front != NULL) {
        const pel_lod_forest *forest = body->front->forest;
        limit = forest->levels[forest->depth]->triangle_count;
        limit = own->triangle_limit < limit ? own->triangle_limit : limit;
    }
    pel_status status = pel_shell_front_create(given, body, corners, own->fine_limit, limit, &own->shell, error);
    if (status == PEL_OK)
        body->shell = &own->shell->shell;
    return status;
}

static pel_status build(pel_refined_model *active, pel_error *error)
{
    pel_model *model = &active->model;
    pel_status status = lay_out(active, error);
    if (status != PEL_OK)
        return status;
    bool room = pel_model_allocate(model) && allocate_places(active);
    for (int32_t b = 0; room && b < model->body_count; b++)
        room = allocate_body(active, b);
    room = room && allocate_row(active, lay_out_slots(active)) &&
           pel_model_allocate_slots(model, PEL_SPRINGS_OWN, 3 * active->given->triangle_count);
    if (!room)
        return pel_fail_memory(error);
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_front *front = model->bodies[b].front;
        model->triangle_begin[b + 1] =
            model->triangle_begin[b] + (front != NULL ? 2 * front->node_count : model->bodies[b].mesh->triangle_count);
        status = create_shell(active, b, error);
        if (status != PEL_OK)
            return status;
        start_body(active, b);
    }
    return PEL_OK;
}

pel_status pel_refined_create(const pel_model *given, pel_refined_model **active, pel_error *error)
{
    *active = NULL;
    pel_refined_model *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->given = given;
    made->model.body_count = given->body_count;
    memcpy(made->model.gravity, given->gravity, sizeof given->gravity);
    made->bodies = pel_allocate((size_t)given->body_count, sizeof *made->bodies);
    made->model.bodies = pel_allocate((size_t)given->body_count, sizeof *made->model.bodies);
    pel_status status = PEL_OK;
    if (made->bodies == NULL || made->model.bodies == NULL)
        status = pel_fail_memory(error);
    for (int32_t b = 0; status == PEL_OK && b < given->body_count; b++) {
        /* names, meshes and curves stay with the given model */
        made->model.bodies[b] = given->bodies[b];
        made->model.bodies[b].model_index = NULL;
    }
    if (status == PEL_OK)
        status = build(made, error);
    if (status == PEL_OK)
        *active = made;
    else
        pel_refined_destroy(made);
    return status;
}

void pel_refined_destroy(pel_refined_model *active)
{
    if (active == NULL)
        return;
    pel_model *model = &active->model;
    for (int32_t b = 0; active->bodies != NULL && model->bodies != NULL && b < model->body_count; b++) {
        pel_shell_front_destroy(active->bodies[b].shell);
        pel_front_destroy(active->bodies[b].front);
        PEL_FREE_ALL(active->bodies[b].model_index, active->bodies[b].used, model->bodies[b].model_index);
    }
    pel_model_free_arrays(model);
    PEL_FREE_ALL(model->bodies, active->bodies, active->areas, active->is_base, active->valence, active->change,
                 active->is_dirty, active->dirty, active->released, active->fan, active->row, active->around,
                 active->is_fine, active->rates, active->fine_counts, active->mixed_counts, active->event_places,
                 active->event_direction);
    pel_free(active);
}
