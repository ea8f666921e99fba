#include "force/pressure.h"
#include "force/shell_body.h"
#include "math/vec3.h"

#include <math.h>
#include <string.h>

/* vertices of one chunk of a parallel loop, and parts of a sum over triangles */
enum { VERTEX_CHUNK = 512, VOLUME_PARTS = 64 };

/* one evaluation */
typedef struct shell_loop {
    const pel_shell_forces *forces;
    const pel_record *position;
    pel_record *force;
    pel_span span;
    int parts;
    int32_t first; /* bundle of the phase */
} shell_loop;

/* ---- elements ---- */

static int part_of(const pel_shell_body *own, const pel_batch *batch)
{
    if (batch->arity == 2 || batch->kind == PEL_CONSTRAINT_CAVE || batch->kind == PEL_CONSTRAINT_LIMIT)
        return 0;
    if (batch->kind == PEL_CONSTRAINT_PRESSURE)
        return own->pressure_part;
    if (pel_batch_is_push(batch))
        return batch->is_projected ? 0 : PEL_SHELL_FOLLOWER;
    if (pel_batch_is_solid(batch))
        return PEL_SHELL_VOLUME;
    return batch->arity == 4 ? PEL_SHELL_BENDING : batch->region >= 0 ? PEL_SHELL_FIBRES : PEL_SHELL_MEMBRANE;
}

static double amount_of(const shell_loop *loop, const pel_shell_body *own, const pel_batch *batch)
{
    if (batch->region < 0)
        return own->pressure;
    const pel_shell_region *region = &own->shell->regions[batch->region];
    return region->def.mode == PEL_FIBRE_NORMAL ? region->def.stiffness
                                                : pel_shell_fibre_amount(region, loop->span.time);
}

static void bundle_chunk(void *context, int32_t chunk)
{
    const shell_loop *loop = context;
    const pel_batches *batches = loop->forces->batches;
    const pel_bundle *bundle = &batches->bundles[loop->first + chunk];
    const pel_shell_body *own = &loop->forces->bodies[bundle->body];
    double *energy = loop->forces->energies[loop->first + chunk];
    for (int column = 0; column < PEL_ENERGY_COLUMNS; column++)
        energy[column] = 0;
    for (int32_t i = 0; own->shell != NULL && i < batches->bodies[bundle->body].batch_count; i++) {
        const pel_batch *batch = &batches->bodies[bundle->body].batches[i];
        int part = part_of(own, batch);
        int32_t begin = batch->bundle_begin[bundle->number], end = batch->bundle_begin[bundle->number + 1];
        if ((part & loop->parts) == 0)
            continue;
        if (batch->region >= 0 && part == PEL_SHELL_FOLLOWER)
            pel_shell_sweep(batch, begin, end, loop->position, amount_of(loop, own, batch), loop->force);
        else if (part != own->pressure_part)
            energy[part == PEL_SHELL_MEMBRANE  ? PEL_ENERGY_MEMBRANE
                   : part == PEL_SHELL_BENDING ? PEL_ENERGY_BENDING
                   : part == PEL_SHELL_VOLUME  ? PEL_ENERGY_VOLUME
                                               : PEL_ENERGY_FIBRES] +=
                pel_shell_sweep(batch, begin, end, loop->position, amount_of(loop, own, batch), loop->force);
        else if (pel_shell_is_normal_form(own->shell) && loop->force != NULL)
            pel_shell_sweep_areas(batch, begin, end, loop->position, loop->forces->area_vectors);
        else if (loop->force != NULL)
            pel_shell_sweep(batch, begin, end, loop->position, own->pressure, loop->force);
    }
}

/* ---- volume ---- */

typedef struct volume_job {
    const pel_batch *batch;
    const pel_record *position;
    pel_record origin;
    double parts[VOLUME_PARTS];
} volume_job;

static void volume_part(void *context, int32_t part)
{
    volume_job *job = context;
    int64_t count = job->batch->block_count;
    job->parts[part] =
        pel_shell_sweep_volumes(job->batch, (int32_t)(count * part / VOLUME_PARTS),
                                (int32_t)(count * (part + 1) / VOLUME_PARTS), job->position, job->origin);
}

/* between the triangles and the first corner of all */
static double find_volume(const shell_loop *loop, const pel_shell_body *own, pel_pool *pool)
{
    /* parts of the surface with a weight of 0 have a volume too */
    if (own->shell->pressure_weights != NULL)
        return pel_body_volume(loop->forces->model, own->body, loop->position);
    volume_job job = {.batch = own->pressed, .position = loop->position};
    double volume = 0;
    job.origin = loop->position[own->shell->corners[0][0]];
    pel_pool_run(pool, VOLUME_PARTS, volume_part, &job);
    for (int part = 0; part < VOLUME_PARTS; part++)
        volume += job.parts[part];
    return volume;
}

/* ---- pressure ---- */

/* sets a body's pressure; returns its potential, when that is asked for */
static double find_pressure(const shell_loop *loop, pel_shell_body *own, bool with_potential, pel_pool *pool)
{
    const pel_shell *shell = own->shell;
    double rest_volume = loop->forces->model->bodies[own->body].rest_volume, volume = rest_volume;
    with_potential &= own->pressure_part == PEL_SHELL_CONSERVATIVE;
    if (with_potential || shell->pressure.kind != PEL_PRESSURE_GIVEN)
        volume = find_volume(loop, own, pool);
    own->pressure = pel_pressure_difference(shell, loop->span, loop->forces->load_factor, volume, rest_volume);
    if (pel_shell_is_normal_form(shell))
        memset(loop->forces->area_vectors + own->first_place, 0, (size_t)own->place_count * sizeof(pel_record));
    return with_potential ? pel_pressure_potential(shell, loop->span, loop->forces->load_factor, volume, rest_volume)
                          : 0;
}

typedef struct normal_job {
    const pel_shell_body *own;
    const pel_record *area_vectors;
    pel_record *force;
} normal_job;

/* the paper's pressure: a third of the areas around along the vertex's normal */
static void normal_chunk(void *context, int32_t chunk)
{
    const normal_job *job = context;
    const pel_shell_body *own = job->own;
    int32_t first = chunk * VERTEX_CHUNK, end = first + VERTEX_CHUNK;
    for (int32_t v = first; v < end && v < own->place_count; v++) {
        pel_record area = job->area_vectors[own->first_place + v];
        double normal[3] = {(double)area[0], (double)area[1], (double)area[2]};
        pel_vec3_normalize(normal);
        pel_vec3_scale(normal, own->pressure * (double)area[3] / 3, normal);
        job->force[own->first_place + v] +=
            (pel_record){(pel_real)normal[0], (pel_real)normal[1], (pel_real)normal[2], 0};
    }
}

static void add_normal_pressures(const shell_loop *loop, pel_pool *pool)
{
    for (int32_t b = 0; b < loop->forces->model->body_count; b++) {
        const pel_shell_body *own = &loop->forces->bodies[b];
        if (own->shell == NULL || (loop->parts & own->pressure_part) == 0 || !pel_shell_is_normal_form(own->shell))
            continue;
        normal_job job = {own, loop->forces->area_vectors, loop->force};
        pel_pool_run(pool, (own->place_count + VERTEX_CHUNK - 1) / VERTEX_CHUNK, normal_chunk, &job);
    }
}

/* ---- smooth tetrahedra ---- */

/* element by element in double, as tangents have them; returns the energy */
static double add_stars(const shell_loop *loop, const pel_shell *shell)
{
    double energy = 0, x[3 * PEL_STAR_NODES], gradient[3 * PEL_STAR_NODES];
    const pel_tangent_sum sum = {.gradient = loop->force != NULL ? gradient : NULL};
    for (int32_t e = 0; shell->stars != NULL && e < shell->stars->count; e++) {
        const int32_t begin = shell->stars->begin[e], count = shell->stars->begin[e + 1] - begin;
        const int32_t *nodes = shell->stars->nodes + begin;
        for (int32_t k = 0; k < count; k++)
            pel_vertex_position(loop->position, nodes[k], x + 3 * k);
        memset(gradient, 0, 3 * (size_t)count * sizeof *gradient);
        energy += pel_star_tangent(shell->stars, e, &shell->solid, x, PEL_TANGENT_EXACT, &sum);
        for (int32_t k = 0; loop->force != NULL && k < count; k++)
            loop->force[nodes[k]] -= (pel_record){(pel_real)gradient[3 * k], (pel_real)gradient[3 * k + 1],
                                                  (pel_real)gradient[3 * k + 2], 0};
    }
    return energy;
}

/* ---- evaluation ---- */

static pel_shell_energy evaluate(shell_loop *loop, bool with_potential, pel_pool *pool)
{
    const pel_shell_forces *forces = loop->forces;
    pel_shell_energy energy = {0};
    for (int32_t b = 0; b < forces->model->body_count; b++)
        if ((loop->parts & forces->bodies[b].pressure_part) != 0)
            energy.pressure += find_pressure(loop, &forces->bodies[b], with_potential, pool);
    for (int phase = 0; phase < PEL_PHASE_COUNT; phase++) {
        loop->first = forces->batches->phase_begin[phase];
        pel_pool_run(pool, forces->batches->phase_begin[phase + 1] - loop->first, bundle_chunk, loop);
    }
    for (int32_t i = 0; i < forces->batches->phase_begin[PEL_PHASE_COUNT]; i++) {
        energy.membrane += forces->energies[i][PEL_ENERGY_MEMBRANE];
        energy.bending += forces->energies[i][PEL_ENERGY_BENDING];
        energy.fibres += forces->energies[i][PEL_ENERGY_FIBRES];
        energy.volume += forces->energies[i][PEL_ENERGY_VOLUME];
    }
    for (int32_t b = 0; (loop->parts & PEL_SHELL_VOLUME) != 0 && b < forces->model->body_count; b++)
        if (forces->bodies[b].shell != NULL)
            energy.volume += add_stars(loop, forces->bodies[b].shell);
    if (loop->force != NULL)
        add_normal_pressures(loop, pool);
    return energy;
}

pel_shell_energy pel_shell_forces_add(pel_shell_forces *forces, const pel_record *position, pel_span span, int parts,
                                      pel_pool *pool, pel_record *force)
{
    shell_loop loop = {forces, position, force, span, parts, 0};
    return forces != NULL ? evaluate(&loop, true, pool) : (pel_shell_energy){0};
}

void pel_shell_forces_press(pel_shell_forces *forces, const pel_record *position, pel_span span, pel_pool *pool,
                            pel_record *force)
{
    shell_loop loop = {forces, position, force, span, PEL_SHELL_PRESSURE, 0};
    bool any = false;
    for (int32_t b = 0; forces != NULL && b < forces->model->body_count; b++)
        any |= forces->bodies[b].pressure_part != 0 || forces->bodies[b].is_pushed;
    if (any)
        evaluate(&loop, false, pool);
}

void pel_shell_forces_follow(pel_shell_forces *forces, const pel_record *position)
{
    for (int32_t b = 0; forces != NULL && b < forces->model->body_count; b++)
        pel_batches_follow(forces->batches, b, position);
}
