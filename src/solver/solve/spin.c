#include "solve/spin.h"

#include "base/memory.h"
#include "base/room.h"
#include "math/vec3.h"
#include "rigid/inertia.h"

/* vertices of one piece of a loop */
enum { PIECE = 2048 };
/* determinant over the cube of the trace of the inertia below which a body is a line */
#define LEAST_INERTIA 1e-12

typedef double record4 __attribute__((vector_size(32)));

/* moments of the masses; products x y, y z and z x */
typedef struct sums {
    double mass;
    record4 torque, first, squares, products; /* torque: of positions about the base, turned once */
} sums;

typedef struct piece {
    int32_t body, begin, end;
    bool is_free;
    record4 before;
    sums after;
} piece;

/* what a body turns by, about a center */
typedef struct turn {
    bool is_on;
    double angle[3], center[3];
} turn;

struct pel_spin {
    const pel_model *model;
    int32_t piece_count;
    piece *pieces;
    turn *turns;            /* (body_count) */
    pel_record *copy;       /* (vertex_count) positions before the sweep */
    const pel_record *base; /* or these */
    pel_record *positions;
};

static bool is_deformable(const pel_model *model, int32_t body)
{
    return model->bodies[body].rigid == NULL;
}

static int32_t piece_count(const pel_model *model, int32_t body)
{
    int32_t count = pel_body_place_end(model, body) - model->bodies[body].slice_begin * PEL_WIDTH;
    return is_deformable(model, body) ? (count + PIECE - 1) / PIECE : 0;
}

pel_status pel_spin_create(const pel_model *model, pel_spin **spin)
{
    int32_t count = 0;
    *spin = NULL;
    for (int32_t b = 0; b < model->body_count; b++)
        count += piece_count(model, b);
    if (count == 0)
        return PEL_OK;
    pel_spin *made = *spin = pel_allocate(1, sizeof *made);
    if (made == NULL ||
        !PEL_ALLOCATE_ALL(PEL_ROOM_ALIGNED(made->pieces, count), PEL_ROOM(made->turns, model->body_count),
                          PEL_ROOM_ALIGNED(made->copy, model->vertex_count)))
        return PEL_OUT_OF_MEMORY;
    made->model = model;
    for (int32_t b = 0; b < model->body_count; b++)
        for (int32_t i = 0; i < piece_count(model, b); i++) {
            const int32_t begin = model->bodies[b].slice_begin * PEL_WIDTH + i * PIECE,
                          end = pel_body_place_end(model, b);
            made->pieces[made->piece_count++] =
                (piece){.body = b, .begin = begin, .end = end - begin < PIECE ? end : begin + PIECE};
        }
    return PEL_OK;
}

void pel_spin_destroy(pel_spin *spin)
{
    if (spin == NULL)
        return;
    PEL_FREE_ALL(spin->pieces, spin->turns, spin->copy);
    pel_free(spin);
}

/* y, z, x */
static inline record4 turned(record4 a)
{
    return __builtin_shufflevector(a, a, 1, 2, 0, 3);
}

static inline record4 cross(record4 a, record4 b)
{
    return turned(a * turned(b) - turned(a) * b);
}

static inline record4 load(const pel_record *records, int32_t v)
{
    return __builtin_convertvector(records[v], record4);
}

/* padding has no mass, as what is held */
static inline double mass_of(record4 x)
{
    return x[3] > 0 ? 1 / x[3] : 0;
}

static void measure_before(void *context, int32_t i)
{
    const pel_spin *spin = context;
    piece *p = &((pel_spin *)context)->pieces[i];
    const bool is_copied = spin->base == spin->copy;
    int32_t held = 0;
    p->before = (record4){0};
    for (int32_t v = p->begin; v < p->end; v++) {
        const record4 x = load(spin->positions, v);
        held += !(x[3] > 0);
        held -= spin->model->mesh_vertex[v] < 0;
        if (is_copied) {
            spin->copy[v] = spin->positions[v];
        } else {
            const record4 y = load(spin->base, v);
            p->before += mass_of(x) * (y * turned(x) - turned(y) * x);
        }
    }
    p->is_free = held == 0;
}

static void measure_after(void *context, int32_t i)
{
    const pel_spin *spin = context;
    piece *p = &((pel_spin *)context)->pieces[i];
    sums s = {0};
    for (int32_t v = p->begin; v < p->end && spin->turns[p->body].is_on; v++) {
        const record4 x = load(spin->positions, v), y = load(spin->base, v);
        const double mass = mass_of(x);
        const record4 moment = mass * x;
        s.torque += mass * (y * turned(x) - turned(y) * x);
        s.mass += mass;
        s.first += moment;
        s.squares += moment * x;
        s.products += moment * turned(x);
    }
    p->after = s;
}

static void turn_piece(void *context, int32_t i)
{
    const pel_spin *spin = context;
    const piece *p = &spin->pieces[i];
    const turn *t = &spin->turns[p->body];
    const record4 angle = {t->angle[0], t->angle[1], t->angle[2]}, center = {t->center[0], t->center[1], t->center[2]};
    for (int32_t v = p->begin; v < p->end && t->is_on; v++) {
        const record4 x = load(spin->positions, v), way = cross(angle, x - center);
        if (x[3] > 0)
            spin->positions[v] = pel_record_with(__builtin_convertvector(x + way, pel_record), spin->positions[v][3]);
    }
}

void pel_spin_begin(pel_spin *spin, const pel_record *base, const pel_record *positions, pel_pool *pool)
{
    if (spin == NULL)
        return;
    spin->base = base != NULL ? base : spin->copy;
    spin->positions = (pel_record *)(uintptr_t)positions;
    pel_pool_run(pool, spin->piece_count, measure_before, spin);
    for (int32_t b = 0; b < spin->model->body_count; b++)
        spin->turns[b].is_on = is_deformable(spin->model, b);
    for (int32_t i = 0; i < spin->piece_count; i++)
        spin->turns[spin->pieces[i].body].is_on &= spin->pieces[i].is_free;
}

/* before, and the torque of the sums: turned once */
static void find_turn(const sums *s, record4 before, turn *t)
{
    double inertia[3][3], inverse[3][3], missing[3];
    const record4 torque = turned(before - s->torque), center = s->first / s->mass;
    const record4 squares = s->squares - s->mass * center * center,
                  products = s->products - s->mass * center * turned(center);
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        inertia[a][a] = squares[0] + squares[1] + squares[2] - squares[a];
        inertia[a][b] = inertia[b][a] = -products[a];
        missing[a] = torque[a];
        t->center[a] = center[a];
    }
    t->is_on = pel_inertia_invert_above((const double(*)[3])inertia, LEAST_INERTIA, inverse);
    for (int a = 0; a < 3; a++)
        t->angle[a] = pel_vec3_dot(inverse[a], missing);
}

void pel_spin_end(pel_spin *spin, pel_record *positions, pel_pool *pool)
{
    if (spin == NULL)
        return;
    spin->positions = positions;
    pel_pool_run(pool, spin->piece_count, measure_after, spin);
    for (int32_t i = 0; i < spin->piece_count;) {
        const int32_t b = spin->pieces[i].body;
        sums total = {0};
        record4 before = {0};
        for (; i < spin->piece_count && spin->pieces[i].body == b; i++) {
            const sums *s = &spin->pieces[i].after;
            before += spin->pieces[i].before;
            total.mass += s->mass;
            total.torque += s->torque;
            total.first += s->first;
            total.squares += s->squares;
            total.products += s->products;
        }
        if (spin->turns[b].is_on)
            find_turn(&total, before, &spin->turns[b]);
    }
    pel_pool_run(pool, spin->piece_count, turn_piece, spin);
}
