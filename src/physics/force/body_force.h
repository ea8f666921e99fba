/* Forces of paper A's body on the vertices of one slice, gathered from their springs (eq. without loads).
   Everything is inline, so that a solver's loop reads each vertex once and integrates it in registers. */
#ifndef PEL_FORCE_BODY_FORCE_H
#define PEL_FORCE_BODY_FORCE_H

#include "base/assert.h"
#include "base/pool.h"
#include "measure/spring.h"
#include "model/state.h"

/* slices of one chunk of a parallel loop */
enum { PEL_SLICE_CHUNK = 512 / PEL_WIDTH };

static inline int32_t pel_slice_chunk_count(int32_t slice_begin, int32_t slice_end)
{
    return (slice_end - slice_begin + PEL_SLICE_CHUNK - 1) / PEL_SLICE_CHUNK;
}

typedef struct pel_slice {
    pel_wide3 position;
    pel_wide inverse_mass;
} pel_slice;

/* loads the records of a slice, turned so that a lane is a vertex */
static inline pel_slice pel_slice_load(const pel_record *records, int32_t slice)
{
    pel_wide a, b, c, d;
    pel_wide_load(records + (size_t)slice * PEL_WIDTH, &a, &b, &c, &d);
    return (pel_slice){{a, b, c}, d};
}

static inline void pel_slice_store(pel_record *records, int32_t slice, pel_wide3 vector, pel_wide fourth)
{
    pel_wide_store(records + (size_t)slice * PEL_WIDTH, vector.x, vector.y, vector.z, fourth);
}

/* vectors to the neighbours of one slot */
static inline pel_wide3 pel_slot_offset(const pel_model *model, const pel_record *position, int32_t slot,
                                        const pel_wide3 *own)
{
    PEL_ASSERT_INDEX(slot, model->slot_begin[model->slice_count]);
    pel_wide a, b, c, d;
    pel_wide_gather(position, model->neighbours[slot], &a, &b, &c, &d);
    return (pel_wide3){a - own->x, b - own->y, c - own->z};
}

/* A slot of springs on its way. Their square root takes longer than what a processor can look ahead from one slot to
   the next, so the loop begins the springs of the next slot before it ends those of the present one (7 % faster; tried
   and slower: a square root and division in float made exact by Newton's steps, loads of half records, several slots in
   passes). */
typedef struct pel_slot_flight {
    pel_wide3 offset;
    pel_wide length;
} pel_slot_flight;

static inline pel_slot_flight pel_slot_begin(const pel_model *model, const pel_record *position, int32_t slot,
                                             const pel_wide3 *own)
{
    PEL_ASSERT_INDEX(slot, model->slot_begin[model->slice_count]);
    pel_wide3 offset = pel_slot_offset(model, position, slot, own);
    return (pel_slot_flight){offset, pel_spring_length(offset)};
}

/* rest lengths of a slot; where no body has springs, which have no force then, the present ones do */
static inline pel_wide pel_slot_rest(const pel_model *model, int32_t slot, pel_wide length)
{
    PEL_ASSERT_INDEX(slot, model->slot_begin[model->slice_count]);
    return model->rest_lengths != NULL ? model->rest_lengths[slot] : length;
}

/* sums of a slice: force over the common factor of the stiffnesses, and the longest spring */
typedef struct pel_spring_sum {
    pel_wide3 force;
    pel_wide longest;
} pel_spring_sum;

static inline void pel_slot_end(const pel_model *model, int32_t slot, bool uniform, const pel_slot_flight *flight,
                                pel_spring_sum *sum)
{
    PEL_ASSERT_INDEX(slot, model->slot_begin[model->slice_count]);
    pel_wide scale =
        uniform ? pel_spring_scale(flight->length, pel_wide_splat(1), pel_slot_rest(model, slot, flight->length))
                : pel_spring_scale(flight->length, model->stiffnesses[slot], model->products[slot]);
    sum->force.x += scale * flight->offset.x;
    sum->force.y += scale * flight->offset.y;
    sum->force.z += scale * flight->offset.z;
    sum->longest = pel_wide_max(flight->length, sum->longest);
}

/* The structural springs of a slice at `own`, the first slot of which has begun. Leaves the first slot of the slice
   `next`, at next_own, begun. */
static inline pel_wide3 pel_spring_force(const pel_model *model, const pel_record *position, int32_t slice,
                                         const pel_wide3 *own, int32_t next, const pel_wide3 *next_own, bool uniform,
                                         pel_slot_flight *flight, pel_wide *longest)
{
    PEL_ASSERT_INDEX(slice, model->slice_count);
    const pel_wide zero = pel_wide_splat(0);
    pel_spring_sum sum = {{zero, zero, zero}, *longest};
    int32_t last = model->slot_end[slice] - 1;
    for (int32_t slot = model->slot_begin[slice]; slot < last; slot++) {
        pel_slot_flight begun = pel_slot_begin(model, position, slot + 1, own);
        pel_slot_end(model, slot, uniform, flight, &sum);
        *flight = begun;
    }
    pel_slot_flight begun = pel_slot_begin(model, position, model->slot_begin[next], next_own);
    pel_slot_end(model, last, uniform, flight, &sum);
    *flight = begun;
    *longest = sum.longest;
    return sum.force;
}

/* length of the longest spring of each vertex of a slice */
static inline pel_wide pel_slice_longest(const pel_model *model, const pel_record *position, int32_t slice,
                                         const pel_wide3 *own)
{
    PEL_ASSERT_INDEX(slice, model->slice_count);
    pel_wide square = pel_wide_splat(0);
    for (int32_t slot = model->slot_begin[slice]; slot < model->slot_end[slice]; slot++) {
        pel_wide3 d = pel_slot_offset(model, position, slot, own);
        square = pel_wide_max(pel_wide3_dot(d, d), square);
    }
    return pel_wide_sqrt(square);
}

/* how the loops treat one body at the present time */
typedef struct pel_body_force {
    bool uniform;       /* one stiffness for all springs of the body */
    pel_real stiffness; /* that stiffness times its present factor, or the factor of the stored ones */
    pel_real damping, volumetric_stiffness, volumetric_damping; /* present factors */
} pel_body_force;

static inline pel_body_force pel_body_force_of(const pel_model *model, const pel_state *state, int32_t body)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const double *factor = state->factors[body];
    double uniform = model->bodies[body].uniform_spring;
    return (pel_body_force){
        .uniform = uniform >= 0,
        .stiffness = (pel_real)(uniform >= 0 ? uniform * factor[PEL_SPRING_STIFFNESS] : factor[PEL_SPRING_STIFFNESS]),
        .damping = (pel_real)factor[PEL_SPRING_DAMPING],
        .volumetric_stiffness = (pel_real)factor[PEL_VOLUMETRIC_STIFFNESS],
        .volumetric_damping = (pel_real)factor[PEL_VOLUMETRIC_DAMPING],
    };
}

/* the same in one slice: where no vertex is off the base, springs need not be read */
static inline pel_body_force pel_slice_force_of(const pel_model *model, const pel_state *state, int32_t slice)
{
    PEL_ASSERT_INDEX(slice, model->slice_count);
    int32_t body = model->body_of_slice[slice];
    pel_body_force numbers = pel_body_force_of(model, state, body);
    double spring = model->bodies[body].plain_spring;
    if (!numbers.uniform && spring >= 0 && model->plain_slices != NULL && model->plain_slices[slice]) {
        numbers.uniform = true;
        numbers.stiffness = (pel_real)(spring * state->factors[body][PEL_SPRING_STIFFNESS]);
    }
    return numbers;
}

/* makes structural springs over the common factor the whole elastic force: adds the volumetric springs */
static inline void pel_add_volumetric(const pel_model *model, int32_t slice, const pel_wide3 *own,
                                      const pel_body_force *body, pel_wide3 *force)
{
    PEL_ASSERT_INDEX(slice, model->slice_count);
    pel_slice rest = pel_slice_load(model->rest, slice); /* its fourth number is k' */
    pel_wide common = pel_wide_splat(body->stiffness);
    pel_wide k = pel_wide_splat(body->volumetric_stiffness) * rest.inverse_mass;
    force->x = common * force->x + k * (rest.position.x - own->x);
    force->y = common * force->y + k * (rest.position.y - own->y);
    force->z = common * force->z + k * (rest.position.z - own->z);
}

/* structural and volumetric springs of one slice; the part that depends on positions alone */
static inline pel_wide3 pel_elastic_force(const pel_model *model, const pel_record *position, int32_t slice,
                                          const pel_wide3 *own, const pel_body_force *body, pel_wide *longest)
{
    PEL_ASSERT_INDEX(slice, model->slice_count);
    pel_slot_flight flight = pel_slot_begin(model, position, model->slot_begin[slice], own);
    pel_wide3 force = pel_spring_force(model, position, slice, own, slice, own, body->uniform, &flight, longest);
    pel_add_volumetric(model, slice, own, body, &force);
    return force;
}

/* adds the part that depends on velocity: -d v and the damping of the volumetric springs */
static inline void pel_add_damping(const pel_model *model, int32_t slice, const pel_wide3 *own,
                                   const pel_wide3 *velocity, const pel_body_force *body, pel_wide3 *force)
{
    PEL_ASSERT_INDEX(slice, model->slice_count);
    const pel_wide *damping = (const pel_wide *)model->damping, *radial = (const pel_wide *)model->volumetric_damping;
    pel_slice rest = pel_slice_load(model->rest, slice);
    pel_wide3 e = {own->x - rest.position.x, own->y - rest.position.y, own->z - rest.position.z};
    pel_wide c = pel_volumetric_damping(e, *velocity, pel_wide_splat(body->volumetric_damping) * radial[slice]);
    pel_wide d = pel_wide_splat(body->damping) * damping[slice];
    force->x -= d * velocity->x + c * e.x;
    force->y -= d * velocity->y + c * e.y;
    force->z -= d * velocity->z + c * e.z;
}

/* Forces on all vertices into force (vertex_count), fourth number 0. velocity null = none. */
void pel_body_forces(const pel_model *model, const pel_state *state, const pel_record *velocity, pel_pool *pool,
                     pel_record *force);

/* Length of the longest spring, which stands on the longest edge. longest: (chunks of the largest body) scratch. */
double pel_longest_spring(const pel_model *model, const pel_record *position, pel_pool *pool, double *longest);

/* Elastic force on one vertex: the same bits as in the loop over all. */
pel_record pel_elastic_force_at(const pel_model *model, const pel_state *state, const pel_record *position,
                                int32_t vertex);

/* Energies on one slice's vertices: half of each spring there, and the volumetric spring. */
void pel_slice_energy(const pel_model *model, const pel_state *state, int32_t slice, pel_wide *spring,
                      pel_wide *volumetric);

/* sum plus the energies on the vertices of a slice: those of the structural springs, and of the volumetric ones */
double pel_slice_energy_add(const pel_model *model, const pel_state *state, int32_t slice, bool is_volumetric,
                            double sum);

#endif
