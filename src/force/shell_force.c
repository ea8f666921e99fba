#include "force/pressure.h"
#include "force/shell_body.h"
#include "math/vec3.h"
#include "measure/element.h"

#include <string.h>

/* vertices of one chunk of a parallel loop */
enum { VERTEX_CHUNK = 512 };

/* one evaluation of one body */
typedef struct shell_loop {
    const pel_shell_body *own;
    const pel_record *position;
    pel_record *force;
    double time;
    double pressure; /* Pa, positive inflates */
    int parts;
} shell_loop;

/* ---- elements ---- */

/* the blocks of a chunk of so many elements */
static pel_shell_sweep sweep_of(const shell_loop *loop, int32_t chunk, int32_t count)
{
    int32_t first = chunk * PEL_SHELL_CHUNK, end = first + PEL_SHELL_CHUNK;
    return (pel_shell_sweep){
        .position = loop->position,
        .begin = first / PEL_BLOCK,
        .end = pel_block_count(end < count ? end : count),
        .pressure = loop->pressure,
        .with_pressure = (loop->parts & loop->own->pressure_part) != 0,
    };
}

/* energy of the fibres of the triangle in a lane; adds their forces to its rows */
static double add_fibres(const shell_loop *loop, int32_t lane)
{
    const pel_shell_body *own = loop->own;
    int32_t t = own->triangle_at[lane];
    double x[3][3], forces[3][3] = {{0}};
    if (own->fibre_begin[t] == own->fibre_begin[t + 1])
        return 0;
    pel_load_points(loop->position, own->shell->triangles[t].vertices, 3, x);
    double energy = pel_shell_fibre_energies(own, t, loop->time, (const double(*)[3])x, forces);
    for (int k = 0; k < 3; k++)
        own->rows[pel_row_of(lane, 3, k)] +=
            (pel_record){(pel_real)forces[k][0], (pel_real)forces[k][1], (pel_real)forces[k][2], 0};
    return energy;
}

static void triangle_chunk(void *context, int32_t chunk)
{
    const shell_loop *loop = context;
    const pel_shell_body *own = loop->own;
    int32_t count = own->shell->triangle_count, first = chunk * PEL_SHELL_CHUNK, end = first + PEL_SHELL_CHUNK;
    pel_shell_sweep sweep = sweep_of(loop, chunk, count);
    own->energies[chunk][0] = pel_shell_sweep_triangles(own, &sweep, (loop->parts & PEL_SHELL_MEMBRANE) != 0);
    own->energies[chunk][1] = 0;
    bool with_fibres = (loop->parts & PEL_SHELL_FIBRES) != 0 && own->fibre_begin != NULL;
    for (int32_t lane = first; with_fibres && lane < end && lane < count; lane++)
        own->energies[chunk][1] += add_fibres(loop, lane);
}

static void hinge_chunk(void *context, int32_t chunk)
{
    const shell_loop *loop = context;
    const pel_shell_body *own = loop->own;
    pel_shell_sweep sweep = sweep_of(loop, chunk, own->shell->hinge_count);
    own->energies[chunk][0] = pel_shell_sweep_hinges(own, &sweep);
}

static void volume_chunk(void *context, int32_t chunk)
{
    const shell_loop *loop = context;
    const pel_shell_body *own = loop->own;
    pel_shell_sweep sweep = sweep_of(loop, chunk, own->shell->triangle_count);
    own->energies[chunk][2] = pel_shell_sweep_volumes(own, &sweep);
}

/* ---- vertices ---- */

static bool has_normal_pressure(const shell_loop *loop)
{
    return loop->own->area_vectors != NULL && (loop->parts & loop->own->pressure_part) != 0;
}

/* the paper's pressure: a third of the areas around along the vertex's normal */
static pel_record normal_pressure(const shell_loop *loop, int32_t place)
{
    const pel_shell_body *own = loop->own;
    double area = 0, normal[3] = {0, 0, 0}, sum[3];
    for (int32_t i = own->gather_begin[place]; i < own->gather_begin[place + 1]; i++) {
        double own_area[3];
        if ((size_t)own->gather[i] >= own->first_hinge_row)
            break;
        int32_t lane = pel_lane_of(own->gather[i], 3);
        pel_load_points(own->area_vectors, &lane, 1, &own_area);
        area += pel_vec3_length(own_area);
        pel_vec3_add(normal, own_area, normal);
    }
    pel_vec3_normalize(normal);
    pel_vec3_scale(normal, loop->pressure * area / 3, sum);
    return (pel_record){(pel_real)sum[0], (pel_real)sum[1], (pel_real)sum[2], 0};
}

static void vertex_chunk(void *context, int32_t chunk)
{
    const shell_loop *loop = context;
    const pel_shell_body *own = loop->own;
    int32_t first = chunk * VERTEX_CHUNK, end = first + VERTEX_CHUNK;
    bool normal_form = has_normal_pressure(loop);
    size_t row_end = (loop->parts & PEL_SHELL_BENDING) != 0 ? SIZE_MAX : own->first_hinge_row;
    for (int32_t v = first; v < end && v < own->place_count; v++) {
        pel_record sum = {0};
        for (int32_t i = own->gather_begin[v]; i < own->gather_begin[v + 1] && (size_t)own->gather[i] < row_end; i++)
            sum += own->rows[own->gather[i]];
        if (normal_form)
            sum += normal_pressure(loop, v);
        loop->force[own->first_place + v] += sum;
    }
}

/* ---- evaluation ---- */

static double sum_energies(const pel_shell_body *own, int32_t count, int column)
{
    double sum = 0;
    for (int32_t chunk = 0; chunk < count; chunk++)
        sum += own->energies[chunk][column];
    return sum;
}

static double body_volume(shell_loop *loop, pel_pool *pool)
{
    int32_t chunks = pel_shell_chunk_count(loop->own->shell->triangle_count, PEL_SHELL_CHUNK);
    pel_pool_run(pool, chunks, volume_chunk, loop);
    return sum_energies(loop->own, chunks, 2);
}

/* sets the loop's pressure; returns its potential */
static double find_pressure(const pel_model *model, shell_loop *loop, pel_pool *pool)
{
    const pel_body *body = &model->bodies[loop->own->body];
    const pel_shell *shell = loop->own->shell;
    if ((loop->parts & loop->own->pressure_part) == 0)
        return 0;
    bool conservative = loop->own->pressure_part == PEL_SHELL_CONSERVATIVE;
    double volume = body->rest_volume;
    if (conservative || shell->pressure.kind != PEL_PRESSURE_GIVEN)
        volume = body_volume(loop, pool);
    loop->pressure = pel_pressure_difference(shell, loop->time, volume, body->rest_volume);
    return conservative ? pel_pressure_potential(shell, loop->time, volume, body->rest_volume) : 0;
}

static void add_body(const pel_model *model, shell_loop *loop, pel_pool *pool, pel_shell_energy *energy)
{
    const pel_shell *shell = loop->own->shell;
    int32_t triangle_chunks = pel_shell_chunk_count(shell->triangle_count, PEL_SHELL_CHUNK);
    int32_t hinge_chunks = pel_shell_chunk_count(shell->hinge_count, PEL_SHELL_CHUNK);
    energy->pressure += find_pressure(model, loop, pool);
    pel_pool_run(pool, triangle_chunks, triangle_chunk, loop);
    energy->membrane += sum_energies(loop->own, triangle_chunks, 0);
    energy->fibres += sum_energies(loop->own, triangle_chunks, 1);
    if ((loop->parts & PEL_SHELL_BENDING) != 0) {
        pel_pool_run(pool, hinge_chunks, hinge_chunk, loop);
        energy->bending += sum_energies(loop->own, hinge_chunks, 0);
    }
    if (loop->force != NULL)
        pel_pool_run(pool, pel_shell_chunk_count(loop->own->place_count, VERTEX_CHUNK), vertex_chunk, loop);
}

pel_shell_energy pel_shell_forces_add(pel_shell_forces *forces, const pel_record *position, double time, int parts,
                                      pel_pool *pool, pel_record *force)
{
    pel_shell_energy energy = {0};
    for (int32_t i = 0; forces != NULL && i < forces->count; i++) {
        shell_loop loop = {&forces->bodies[i], position, force, time, 0, parts};
        add_body(forces->model, &loop, pool, &energy);
    }
    return energy;
}

void pel_shell_forces_follow(pel_shell_forces *forces, const pel_record *position)
{
    for (int32_t b = 0; forces != NULL && b < forces->count; b++) {
        const pel_shell_body *own = &forces->bodies[b];
        for (int32_t t = 0; own->fibre_begin != NULL && t < own->shell->triangle_count; t++)
            for (int32_t i = own->fibre_begin[t]; i < own->fibre_begin[t + 1]; i++) {
                if (own->shell->regions[own->fibres[i].region].def.direction != PEL_FIBRE_PRINCIPAL)
                    continue;
                const pel_shell_triangle *triangle = &own->shell->triangles[t];
                double x[3][3];
                pel_load_points(position, triangle->vertices, 3, x);
                pel_principal_direction(&triangle->rest, (const double(*)[3])x, own->fibres[i].direction);
            }
    }
}
