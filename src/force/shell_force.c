#include "element/membrane.h"
#include "force/pressure.h"
#include "force/shell_body.h"
#include "math/vec3.h"

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

static void add_pressure(const shell_loop *loop, int32_t t, const double x[3][3], double rows[3][3])
{
    const pel_shell_body *own = loop->own;
    const double *weights = own->shell->pressure_weights;
    double weight = weights != NULL ? weights[t] : 1, force[3];
    if (own->area_vectors != NULL) {
        pel_vec3_triangle_normal(x[0], x[1], x[2], force);
        pel_vec3_scale(force, 0.5 * weight, own->area_vectors[t]);
        return;
    }
    pel_triangle_pressure_force(x, loop->pressure * weight, force);
    for (int i = 0; i < 3; i++)
        pel_vec3_add(rows[i], force, rows[i]);
}

static void triangle_chunk(void *context, int32_t chunk)
{
    const shell_loop *loop = context;
    const pel_shell_body *own = loop->own;
    const pel_shell *shell = own->shell;
    int32_t first = chunk * PEL_SHELL_CHUNK, end = first + PEL_SHELL_CHUNK;
    double membrane = 0, fibres = 0;
    for (int32_t t = first; t < end && t < shell->triangle_count; t++) {
        double x[3][3], (*rows)[3] = &own->rows[3 * (size_t)t];
        pel_load_points(loop->position, shell->triangles[t].vertices, 3, x);
        memset(rows, 0, 3 * sizeof *rows);
        if ((loop->parts & PEL_SHELL_MEMBRANE) != 0)
            membrane += pel_shell_membrane_energy(own, t, (const double(*)[3])x, rows);
        if ((loop->parts & PEL_SHELL_FIBRES) != 0)
            fibres += pel_shell_fibre_energies(own, t, loop->time, (const double(*)[3])x, rows);
        if ((loop->parts & own->pressure_part) != 0)
            add_pressure(loop, t, (const double(*)[3])x, rows);
    }
    own->energies[chunk][0] = membrane;
    own->energies[chunk][1] = fibres;
}

static void hinge_chunk(void *context, int32_t chunk)
{
    const shell_loop *loop = context;
    const pel_shell_body *own = loop->own;
    const pel_shell *shell = own->shell;
    int32_t first = chunk * PEL_SHELL_CHUNK, end = first + PEL_SHELL_CHUNK;
    double bending = 0;
    for (int32_t i = first; i < end && i < shell->hinge_count; i++) {
        const pel_shell_hinge *hinge = &shell->hinges[i];
        double x[4][3], (*rows)[3] = &own->rows[3 * (size_t)shell->triangle_count + 4 * (size_t)i];
        double factor = (loop->parts & PEL_SHELL_BENDING) != 0 ? pel_shell_hinge_factor(shell, hinge) : 0;
        pel_load_points(loop->position, hinge->vertices, 4, x);
        bending += factor * pel_shell_hinge_energy(shell, hinge, (const double(*)[3])x, rows);
        for (int k = 0; k < 4; k++)
            pel_vec3_scale(rows[k], -factor, rows[k]);
    }
    own->energies[chunk][0] = bending;
}

static void volume_chunk(void *context, int32_t chunk)
{
    const shell_loop *loop = context;
    const pel_shell_body *own = loop->own;
    int32_t first = chunk * PEL_SHELL_CHUNK, end = first + PEL_SHELL_CHUNK;
    double volume = 0, origin[1][3];
    pel_load_points(loop->position, own->shell->triangles[0].vertices, 1, origin);
    for (int32_t t = first; t < end && t < own->shell->triangle_count; t++) {
        double x[3][3];
        pel_load_points(loop->position, own->shell->triangles[t].vertices, 3, x);
        volume += pel_vec3_cone_volume(origin[0], x[0], x[1], x[2]);
    }
    own->energies[chunk][2] = volume;
}

/* ---- vertices ---- */

/* the paper's pressure: a third of the areas around along the vertex's normal */
static void add_normal_pressure(const shell_loop *loop, int32_t place, double sum[3])
{
    const pel_shell_body *own = loop->own;
    double area = 0, normal[3] = {0, 0, 0};
    for (int32_t i = own->gather_begin[place]; i < own->gather_begin[place + 1]; i++) {
        int32_t t = own->gather[i] / 3;
        if (t >= own->shell->triangle_count)
            break;
        area += pel_vec3_length(own->area_vectors[t]);
        pel_vec3_add(normal, own->area_vectors[t], normal);
    }
    pel_vec3_normalize(normal);
    pel_vec3_along(sum, loop->pressure * area / 3, normal, sum);
}

static void vertex_chunk(void *context, int32_t chunk)
{
    const shell_loop *loop = context;
    const pel_shell_body *own = loop->own;
    int32_t first = chunk * VERTEX_CHUNK, end = first + VERTEX_CHUNK;
    bool normal_form = own->area_vectors != NULL && (loop->parts & own->pressure_part) != 0;
    for (int32_t v = first; v < end && v < own->place_count; v++) {
        double sum[3] = {0, 0, 0};
        for (int32_t i = own->gather_begin[v]; i < own->gather_begin[v + 1]; i++)
            pel_vec3_add(sum, own->rows[own->gather[i]], sum);
        if (normal_form)
            add_normal_pressure(loop, v, sum);
        loop->force[own->first_place + v] += (pel_record){(pel_real)sum[0], (pel_real)sum[1], (pel_real)sum[2], 0};
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
    pel_pool_run(pool, hinge_chunks, hinge_chunk, loop);
    energy->bending += sum_energies(loop->own, hinge_chunks, 0);
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
