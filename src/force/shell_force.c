#include "force/shell_force.h"

#include "base/memory.h"
#include "base/status.h"
#include "element/membrane.h"
#include "force/pressure.h"
#include "math/vec3.h"

#include <string.h>

/* elements and vertices of one chunk of a parallel loop */
enum { ELEMENT_CHUNK = 256, VERTEX_CHUNK = 512 };

/* fibres of one region in one triangle, as the loop needs them */
typedef struct triangle_fibre {
    int32_t region;
    double stiffness; /* N/m, weight included */
    double direction[2];
} triangle_fibre;

typedef struct shell_body {
    const pel_shell *shell;
    int32_t body;
    int32_t first_place, place_count;
    int pressure_part;      /* which of the parts its pressure is; 0 = none */
    pel_membrane_law *laws; /* (triangle_count), or one when the material is uniform */
    int32_t *fibre_begin;   /* (triangle_count + 1); null without fibres */
    triangle_fibre *fibres;
    double (*rows)[3];         /* (3 triangle_count + 4 hinge_count) forces on corners */
    double (*area_vectors)[3]; /* (triangle_count) weighted, of the vertex-normal form; else null */
    double (*energies)[3];     /* (chunks) membrane or bending, fibres, volume */
    int32_t *gather_begin;     /* (place_count + 1) */
    int32_t *gather;           /* numbers of rows */
} shell_body;

struct pel_shell_forces {
    const pel_model *model;
    int32_t count;
    shell_body *bodies;
};

/* one evaluation of one body */
typedef struct shell_loop {
    const shell_body *own;
    const pel_record *position;
    pel_record *force;
    double time;
    double pressure; /* Pa, positive inflates */
    int parts;
} shell_loop;

static int32_t chunk_count(int32_t count, int32_t size)
{
    return (count + size - 1) / size;
}

static void load_points(const pel_record *position, const int32_t *vertices, int count, double x[][3])
{
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            x[i][c] = (double)position[vertices[i]][c];
}

double pel_shell_hinge_factor(const pel_shell *shell, const pel_shell_hinge *hinge)
{
    return shell->bending == PEL_BENDING_HINGE ? hinge->stiffness : hinge->stiffness / 3;
}

/* ---- elements ---- */

static double fibre_energy(const shell_body *own, const pel_rest_triangle *rest, const triangle_fibre *fibre,
                           double time, const double x[3][3], double gradient[3][3])
{
    const pel_shell_region *region = &own->shell->regions[fibre->region];
    if (region->def.mode == PEL_FIBRE_STRAIN)
        return pel_fibre_energy(rest, region->def.kind, fibre->stiffness, fibre->direction, x, gradient);
    double length =
        region->def.rest_length.value * pel_curve_value(region->rest_length.keys, region->rest_length.key_count, time);
    return pel_fibre_active_energy(rest, fibre->stiffness, length, fibre->direction, x, gradient);
}

static void subtract_rows(double rows[][3], double gradient[][3], int count)
{
    for (int i = 0; i < count; i++)
        pel_vec3_subtract(rows[i], gradient[i], rows[i]);
}

/* energy of the membrane of triangle t; subtracts its gradient from the rows, which may be null */
static double membrane_energy(const shell_body *own, int32_t t, const double x[3][3], double rows[3][3])
{
    const pel_shell *shell = own->shell;
    if (!shell->has_membrane)
        return 0;
    const pel_membrane_law *law = &own->laws[shell->uniform ? 0 : t];
    double gradient[3][3];
    if (rows == NULL)
        return pel_membrane_law_energy(&shell->triangles[t].rest, law, x, NULL);
    double energy = pel_membrane_law_energy(&shell->triangles[t].rest, law, x, gradient);
    subtract_rows(rows, gradient, 3);
    return energy;
}

/* the same of its fibres */
static double fibre_energies(const shell_body *own, int32_t t, double time, const double x[3][3], double rows[3][3])
{
    double sum = 0, gradient[3][3];
    if (own->fibre_begin == NULL)
        return 0;
    for (int32_t i = own->fibre_begin[t]; i < own->fibre_begin[t + 1]; i++) {
        const pel_rest_triangle *rest = &own->shell->triangles[t].rest;
        sum += fibre_energy(own, rest, &own->fibres[i], time, x, rows != NULL ? gradient : NULL);
        if (rows != NULL)
            subtract_rows(rows, gradient, 3);
    }
    return sum;
}

static void add_pressure(const shell_loop *loop, int32_t t, const double x[3][3], double rows[3][3])
{
    const shell_body *own = loop->own;
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
    const shell_body *own = loop->own;
    const pel_shell *shell = own->shell;
    int32_t first = chunk * ELEMENT_CHUNK, end = first + ELEMENT_CHUNK;
    double membrane = 0, fibres = 0;
    for (int32_t t = first; t < end && t < shell->triangle_count; t++) {
        double x[3][3], (*rows)[3] = &own->rows[3 * (size_t)t];
        load_points(loop->position, shell->triangles[t].vertices, 3, x);
        memset(rows, 0, 3 * sizeof *rows);
        if ((loop->parts & PEL_SHELL_MEMBRANE) != 0)
            membrane += membrane_energy(own, t, (const double(*)[3])x, rows);
        if ((loop->parts & PEL_SHELL_FIBRES) != 0)
            fibres += fibre_energies(own, t, loop->time, (const double(*)[3])x, rows);
        if ((loop->parts & own->pressure_part) != 0)
            add_pressure(loop, t, (const double(*)[3])x, rows);
    }
    own->energies[chunk][0] = membrane;
    own->energies[chunk][1] = fibres;
}

static double hinge_energy(const pel_shell *shell, const pel_shell_hinge *hinge, const double x[4][3],
                           double gradient[4][3])
{
    if (shell->bending == PEL_BENDING_HINGE)
        return pel_hinge_energy(&hinge->hinge, x, gradient);
    pel_bending_form form = shell->bending == PEL_BENDING_ISOMETRIC ? PEL_BENDING_LITERAL : PEL_BENDING_REST_SUBTRACTED;
    return pel_bending_isometric_energy(&hinge->isometric, form, x, gradient);
}

static void hinge_chunk(void *context, int32_t chunk)
{
    const shell_loop *loop = context;
    const shell_body *own = loop->own;
    const pel_shell *shell = own->shell;
    int32_t first = chunk * ELEMENT_CHUNK, end = first + ELEMENT_CHUNK;
    double bending = 0;
    for (int32_t i = first; i < end && i < shell->hinge_count; i++) {
        const pel_shell_hinge *hinge = &shell->hinges[i];
        double x[4][3], (*rows)[3] = &own->rows[3 * (size_t)shell->triangle_count + 4 * (size_t)i];
        double factor = (loop->parts & PEL_SHELL_BENDING) != 0 ? pel_shell_hinge_factor(shell, hinge) : 0;
        load_points(loop->position, hinge->vertices, 4, x);
        bending += factor * hinge_energy(shell, hinge, (const double(*)[3])x, rows);
        for (int k = 0; k < 4; k++)
            pel_vec3_scale(rows[k], -factor, rows[k]);
    }
    own->energies[chunk][0] = bending;
}

static void volume_chunk(void *context, int32_t chunk)
{
    const shell_loop *loop = context;
    const shell_body *own = loop->own;
    int32_t first = chunk * ELEMENT_CHUNK, end = first + ELEMENT_CHUNK;
    double volume = 0, origin[1][3];
    load_points(loop->position, own->shell->triangles[0].vertices, 1, origin);
    for (int32_t t = first; t < end && t < own->shell->triangle_count; t++) {
        double x[3][3];
        load_points(loop->position, own->shell->triangles[t].vertices, 3, x);
        volume += pel_vec3_cone_volume(origin[0], x[0], x[1], x[2]);
    }
    own->energies[chunk][2] = volume;
}

/* ---- vertices ---- */

/* the paper's pressure: a third of the areas around along the vertex's normal */
static void add_normal_pressure(const shell_loop *loop, int32_t place, double sum[3])
{
    const shell_body *own = loop->own;
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
    const shell_body *own = loop->own;
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

static double sum_energies(const shell_body *own, int32_t count, int column)
{
    double sum = 0;
    for (int32_t chunk = 0; chunk < count; chunk++)
        sum += own->energies[chunk][column];
    return sum;
}

static double body_volume(shell_loop *loop, pel_pool *pool)
{
    int32_t chunks = chunk_count(loop->own->shell->triangle_count, ELEMENT_CHUNK);
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
    int32_t triangle_chunks = chunk_count(shell->triangle_count, ELEMENT_CHUNK);
    int32_t hinge_chunks = chunk_count(shell->hinge_count, ELEMENT_CHUNK);
    energy->pressure += find_pressure(model, loop, pool);
    pel_pool_run(pool, triangle_chunks, triangle_chunk, loop);
    energy->membrane += sum_energies(loop->own, triangle_chunks, 0);
    energy->fibres += sum_energies(loop->own, triangle_chunks, 1);
    pel_pool_run(pool, hinge_chunks, hinge_chunk, loop);
    energy->bending += sum_energies(loop->own, hinge_chunks, 0);
    if (loop->force != NULL)
        pel_pool_run(pool, chunk_count(loop->own->place_count, VERTEX_CHUNK), vertex_chunk, loop);
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

/* the direction of the largest stretch; the first axis where there is none */
static void principal_direction(const pel_rest_triangle *rest, const double x[3][3], double direction[2])
{
    double f[6], c11 = 0, c12 = 0, c22 = 0;
    pel_deformation_gradient(rest, x, f);
    for (int i = 0; i < 3; i++) {
        c11 += f[2 * i] * f[2 * i];
        c12 += f[2 * i] * f[2 * i + 1];
        c22 += f[2 * i + 1] * f[2 * i + 1];
    }
    double difference = 0.5 * (c11 - c22), size = hypot(difference, c12);
    double angle = size > 1e-9 * (c11 + c22) ? 0.5 * atan2(c12, difference) : 0;
    direction[0] = cos(angle);
    direction[1] = sin(angle);
}

void pel_shell_forces_follow(pel_shell_forces *forces, const pel_record *position)
{
    for (int32_t b = 0; forces != NULL && b < forces->count; b++) {
        const shell_body *own = &forces->bodies[b];
        for (int32_t t = 0; own->fibre_begin != NULL && t < own->shell->triangle_count; t++)
            for (int32_t i = own->fibre_begin[t]; i < own->fibre_begin[t + 1]; i++) {
                if (own->shell->regions[own->fibres[i].region].def.direction != PEL_FIBRE_PRINCIPAL)
                    continue;
                const pel_shell_triangle *triangle = &own->shell->triangles[t];
                double x[3][3];
                load_points(position, triangle->vertices, 3, x);
                principal_direction(&triangle->rest, (const double(*)[3])x, own->fibres[i].direction);
            }
    }
}

static void share(double energy, const int32_t *vertices, int count, const int32_t *mesh_vertex, double *values)
{
    for (int i = 0; i < count; i++)
        values[mesh_vertex[vertices[i]]] += energy / count;
}

static const shell_body *find_body(const pel_shell_forces *forces, int32_t body)
{
    for (int32_t i = 0; forces != NULL && i < forces->count; i++)
        if (forces->bodies[i].body == body)
            return &forces->bodies[i];
    return NULL;
}

void pel_shell_add_virials(const pel_shell_forces *forces, int32_t body, const pel_record *position, double time,
                           double *virials)
{
    const shell_body *own = find_body(forces, body);
    for (int32_t t = 0; own != NULL && t < own->shell->triangle_count; t++) {
        const int32_t *vertices = own->shell->triangles[t].vertices;
        double x[3][3], rows[3][3] = {{0}}, side[3], sum = 0;
        load_points(position, vertices, 3, x);
        membrane_energy(own, t, (const double(*)[3])x, rows);
        fibre_energies(own, t, time, (const double(*)[3])x, rows);
        for (int i = 1; i < 3; i++) {
            pel_vec3_subtract(x[i], x[0], side);
            sum -= pel_vec3_dot(rows[i], side);
        }
        share(sum, vertices, 3, forces->model->mesh_vertex, virials);
    }
}

void pel_shell_vertex_energies(const pel_shell_forces *forces, int32_t body, int32_t vertex_count,
                               const pel_record *position, double time, double *membrane, double *bending,
                               double *fibres)
{
    const shell_body *own = find_body(forces, body);
    double *lists[3] = {membrane, bending, fibres};
    for (int i = 0; i < 3; i++)
        memset(lists[i], 0, (size_t)vertex_count * sizeof **lists);
    if (own == NULL)
        return;
    const pel_shell *shell = own->shell;
    const int32_t *mesh_vertex = forces->model->mesh_vertex;
    double x[4][3];
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        const pel_shell_triangle *triangle = &shell->triangles[t];
        load_points(position, triangle->vertices, 3, x);
        share(membrane_energy(own, t, (const double(*)[3])x, NULL), triangle->vertices, 3, mesh_vertex, membrane);
        share(fibre_energies(own, t, time, (const double(*)[3])x, NULL), triangle->vertices, 3, mesh_vertex, fibres);
    }
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        const pel_shell_hinge *hinge = &shell->hinges[i];
        load_points(position, hinge->vertices, 4, x);
        double energy = pel_shell_hinge_factor(shell, hinge) * hinge_energy(shell, hinge, (const double(*)[3])x, NULL);
        share(energy, hinge->vertices, 4, mesh_vertex, bending);
    }
}

/* ---- bound of the stiffness ---- */

/* adds to each vertex of an element the norms of its row of blocks, which are at most stiffness |g_a| |g_b| */
static void add_norms(double stiffness, const int32_t *vertices, int count, const double *norms, int32_t first,
                      double *sums)
{
    double total = 0;
    for (int i = 0; i < count; i++)
        total += norms[i];
    for (int i = 0; i < count; i++)
        sums[vertices[i] - first] += stiffness * norms[i] * total;
}

/* |d F / d x_a| of a rest triangle */
static void strain_norms(const pel_rest_triangle *rest, double norms[3])
{
    const double *i = rest->inverse;
    norms[0] = hypot(i[0], i[1]);
    norms[1] = fabs(i[2]);
    norms[2] = hypot(i[0], i[1] + i[2]);
}

static void add_hinge_norms(const pel_shell *shell, const pel_shell_hinge *hinge, const double x[4][3], int32_t first,
                            double *sums)
{
    double norms[4], gradient[4][3];
    double factor = pel_shell_hinge_factor(shell, hinge);
    if (shell->bending == PEL_BENDING_HINGE) {
        pel_dihedral_angle(x, gradient);
        factor *= hinge->hinge.factor;
    } else {
        factor *= hinge->isometric.factor;
    }
    for (int a = 0; a < 4; a++)
        norms[a] =
            shell->bending == PEL_BENDING_HINGE ? pel_vec3_length(gradient[a]) : fabs(hinge->isometric.weight[a]);
    add_norms(factor, hinge->vertices, 4, norms, first, sums);
}

/* largest stiffness of a triangle's material and fibres at rest [N/m] */
static double triangle_stiffness(const shell_body *own, int32_t t)
{
    const pel_shell *shell = own->shell;
    const pel_shell_triangle *triangle = &shell->triangles[t];
    double sum = 0, mu, lambda;
    if (shell->has_membrane) {
        bool half = shell->material.kind == PEL_MEMBRANE_MOONEY_RIVLIN;
        pel_plane_stress_lame(triangle->young, half ? 0.5 : shell->material.poisson, triangle->thickness, &mu, &lambda);
        sum += 2 * mu + 2 * fmax(lambda, 0);
    }
    for (int32_t i = own->fibre_begin != NULL ? own->fibre_begin[t] : 0;
         own->fibre_begin != NULL && i < own->fibre_begin[t + 1]; i++)
        sum += own->fibres[i].stiffness * (shell->regions[own->fibres[i].region].def.kind == PEL_FIBRE_STVK ? 4 : 1);
    return sum;
}

/* largest size of a curve's values */
static double curve_size(const pel_curve *curve)
{
    double size = curve->key_count > 0 ? 0 : 1;
    for (int32_t k = 0; k < curve->key_count; k++)
        size = fmax(size, fabs(curve->keys[k].value));
    return size;
}

/* the largest size that the pressure difference takes near rest [Pa] */
static double pressure_size(const pel_shell *shell)
{
    const pel_pressure_def *def = &shell->pressure;
    if (def->kind == PEL_PRESSURE_GIVEN)
        return fabs(def->outside.value) * curve_size(&shell->outside);
    if (def->kind == PEL_PRESSURE_VOLUME)
        return def->bulk * fmax(1, fabs(def->target.value) * curve_size(&shell->target) - 1);
    return 0;
}

static void add_pressure_norms(const shell_body *own, int32_t t, const double x[3][3], double *sums)
{
    const pel_shell *shell = own->shell;
    double size = pressure_size(shell) * (shell->pressure_weights != NULL ? fabs(shell->pressure_weights[t]) : 1);
    double edges = pel_vec3_distance(x[0], x[1]) + pel_vec3_distance(x[1], x[2]) + pel_vec3_distance(x[2], x[0]);
    for (int i = 0; i < 3; i++)
        sums[shell->triangles[t].vertices[i] - own->first_place] += size * edges / 6;
}

/* what a pressure that changes with the volume adds: the eigenvalue c sum |g|^2 / m of c g g^T / m, with its slope c
   and the gradient g of the volume. sums is scratch */
static double volume_bound(const pel_model *model, const shell_body *own, double *sums)
{
    const pel_shell *shell = own->shell;
    const pel_pressure_def *def = &shell->pressure;
    double slope = def->kind == PEL_PRESSURE_GAS      ? def->gamma * def->value
                   : def->kind == PEL_PRESSURE_VOLUME ? def->bulk
                                                      : 0;
    if (slope == 0)
        return 0;
    memset(sums, 0, (size_t)own->place_count * sizeof *sums);
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        double weight = shell->pressure_weights != NULL ? fabs(shell->pressure_weights[t]) : 1;
        for (int i = 0; i < 3; i++)
            sums[shell->triangles[t].vertices[i] - own->first_place] += weight * shell->triangles[t].rest.area / 3;
    }
    double sum = 0;
    for (int32_t v = 0; v < own->place_count; v++)
        sum += sums[v] * sums[v] * (double)model->inverse_mass[own->first_place + v];
    return slope / model->bodies[own->body].rest_volume * sum;
}

static double body_bound(const pel_model *model, const shell_body *own)
{
    const pel_shell *shell = own->shell;
    /* the rows are free between evaluations: there are more of them than vertices */
    double *sums = own->rows[0], bound = 0, volume = volume_bound(model, own, sums);
    memset(sums, 0, (size_t)own->place_count * sizeof *sums);
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        double x[3][3], norms[3];
        load_points(model->rest, shell->triangles[t].vertices, 3, x);
        strain_norms(&shell->triangles[t].rest, norms);
        add_norms(shell->triangles[t].rest.area * triangle_stiffness(own, t), shell->triangles[t].vertices, 3, norms,
                  own->first_place, sums);
        add_pressure_norms(own, t, (const double(*)[3])x, sums);
    }
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        double x[4][3];
        load_points(model->rest, shell->hinges[i].vertices, 4, x);
        add_hinge_norms(shell, &shell->hinges[i], (const double(*)[3])x, own->first_place, sums);
    }
    for (int32_t v = 0; v < own->place_count; v++)
        bound = fmax(bound, sums[v] * (double)model->inverse_mass[own->first_place + v]);
    return bound + volume;
}

double pel_shell_stiffness_bound(const pel_shell_forces *forces)
{
    double bound = 0;
    for (int32_t i = 0; forces != NULL && i < forces->count; i++)
        bound = fmax(bound, body_bound(forces->model, &forces->bodies[i]));
    return bound;
}

/* ---- creation ---- */

/* bending needs a stiffness when forces are asked for */
static pel_status check_bending(const shell_body *own, pel_error *error)
{
    const pel_shell *shell = own->shell;
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        if (shell->has_membrane || shell->hinges[i].stiffness > 0)
            continue;
        pel_fail(error, PEL_BAD_ARGUMENT, "bending has no stiffness");
        pel_fail_element(error, "body", own->body);
        pel_fail_remedy(error, "give the bending a stiffness above 0 [N m], or the body a membrane");
        return PEL_BAD_ARGUMENT;
    }
    return PEL_OK;
}

static pel_status make_laws(shell_body *own, pel_error *error)
{
    const pel_shell *shell = own->shell;
    if (!shell->has_membrane)
        return PEL_OK;
    int32_t count = shell->uniform ? 1 : shell->triangle_count;
    own->laws = pel_allocate((size_t)count, sizeof *own->laws);
    if (own->laws == NULL)
        return pel_fail_memory(error);
    for (int32_t t = 0; t < count; t++) {
        pel_membrane_material material = shell->material;
        material.young = shell->triangles[t].young;
        material.thickness = shell->triangles[t].thickness;
        own->laws[t] = pel_membrane_law_of(&material);
    }
    return PEL_OK;
}

/* Lists by owner: counts stand two places after their owner's number, sums make them begins one place after; filling
   moves each up to the begin of the next owner, so that begin[owner] .. begin[owner + 1] is right in the end. */
static void sum_counts(int32_t *begin, int32_t owner_count)
{
    for (int32_t i = 0; i < owner_count; i++)
        begin[i + 2] += begin[i + 1];
}

/* fibres that give forces */
static int32_t force_fibre_count(const pel_shell_region *region)
{
    return region->def.mode != PEL_FIBRE_CAVE ? region->fibre_count : 0;
}

/* the fibres of all regions by triangle */
static pel_status make_fibres(shell_body *own, pel_error *error)
{
    const pel_shell *shell = own->shell;
    int32_t count = 0;
    for (int32_t r = 0; r < shell->region_count; r++)
        count += force_fibre_count(&shell->regions[r]);
    if (count == 0)
        return PEL_OK;
    own->fibre_begin = pel_allocate((size_t)shell->triangle_count + 2, sizeof *own->fibre_begin);
    own->fibres = pel_allocate((size_t)count, sizeof *own->fibres);
    if (own->fibre_begin == NULL || own->fibres == NULL)
        return pel_fail_memory(error);
    for (int32_t r = 0; r < shell->region_count; r++)
        for (int32_t i = 0; i < force_fibre_count(&shell->regions[r]); i++)
            own->fibre_begin[shell->regions[r].fibres[i].triangle + 2]++;
    sum_counts(own->fibre_begin, shell->triangle_count);
    for (int32_t r = 0; r < shell->region_count; r++)
        for (int32_t i = 0; i < force_fibre_count(&shell->regions[r]); i++) {
            const pel_shell_fibre *fibre = &shell->regions[r].fibres[i];
            triangle_fibre *made = &own->fibres[own->fibre_begin[fibre->triangle + 1]++];
            *made = (triangle_fibre){.region = r, .stiffness = shell->regions[r].def.stiffness * fibre->weight};
            memcpy(made->direction, fibre->direction, sizeof made->direction);
        }
    return PEL_OK;
}

/* counts the rows of each vertex, or lists them; triangles come first */
static void visit_rows(shell_body *own, bool list)
{
    const pel_shell *shell = own->shell;
    int32_t triangle_rows = 3 * shell->triangle_count, count = triangle_rows + 4 * shell->hinge_count;
    for (int32_t row = 0; row < count; row++) {
        int32_t h = row - triangle_rows;
        int32_t place = h < 0 ? shell->triangles[row / 3].vertices[row % 3] : shell->hinges[h / 4].vertices[h % 4];
        int32_t *begin = &own->gather_begin[place - own->first_place];
        if (list)
            own->gather[begin[1]++] = row;
        else
            begin[2]++;
    }
}

static pel_status make_rows(shell_body *own, pel_error *error)
{
    const pel_shell *shell = own->shell;
    size_t triangles = (size_t)shell->triangle_count, rows = 3 * triangles + 4 * (size_t)shell->hinge_count;
    int32_t most = shell->triangle_count > shell->hinge_count ? shell->triangle_count : shell->hinge_count;
    own->rows = pel_allocate(rows, sizeof *own->rows);
    own->gather = pel_allocate(rows, sizeof *own->gather);
    own->gather_begin = pel_allocate((size_t)own->place_count + 2, sizeof *own->gather_begin);
    own->energies = pel_allocate((size_t)chunk_count(most, ELEMENT_CHUNK), sizeof *own->energies);
    bool normal_form = shell->pressure.kind != PEL_PRESSURE_NONE && shell->pressure.form == PEL_PRESSURE_VERTEX_NORMAL;
    if (normal_form)
        own->area_vectors = pel_allocate(triangles, sizeof *own->area_vectors);
    if (own->rows == NULL || own->gather == NULL || own->gather_begin == NULL || own->energies == NULL ||
        (normal_form && own->area_vectors == NULL))
        return pel_fail_memory(error);
    visit_rows(own, false);
    sum_counts(own->gather_begin, own->place_count);
    visit_rows(own, true);
    return PEL_OK;
}

pel_status pel_shell_forces_create(const pel_model *model, pel_shell_forces **forces, pel_error *error)
{
    *forces = NULL;
    int32_t count = 0;
    for (int32_t b = 0; b < model->body_count; b++)
        count += model->bodies[b].shell != NULL;
    if (count == 0)
        return PEL_OK;
    pel_shell_forces *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->model = model;
    made->bodies = pel_allocate((size_t)count, sizeof *made->bodies);
    pel_status status = made->bodies != NULL ? PEL_OK : pel_fail_memory(error);
    for (int32_t b = 0; status == PEL_OK && b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b];
        if (body->shell == NULL)
            continue;
        shell_body *own = &made->bodies[made->count++];
        *own = (shell_body){.shell = body->shell, .body = b, .first_place = body->slice_begin * PEL_WIDTH};
        if (body->shell->pressure.kind != PEL_PRESSURE_NONE)
            own->pressure_part = pel_pressure_is_conservative(body) ? PEL_SHELL_CONSERVATIVE : PEL_SHELL_FOLLOWER;
        own->place_count = (body->slice_end - body->slice_begin) * PEL_WIDTH;
        status = check_bending(own, error);
        if (status == PEL_OK)
            status = make_laws(own, error);
        if (status == PEL_OK)
            status = make_fibres(own, error);
        if (status == PEL_OK)
            status = make_rows(own, error);
    }
    if (status == PEL_OK)
        *forces = made;
    else
        pel_shell_forces_destroy(made);
    return status;
}

void pel_shell_forces_destroy(pel_shell_forces *forces)
{
    if (forces == NULL)
        return;
    for (int32_t i = 0; i < forces->count; i++) {
        shell_body *own = &forces->bodies[i];
        void *arrays[] = {own->laws,         own->fibre_begin, own->fibres,       own->rows,
                          own->area_vectors, own->energies,    own->gather_begin, own->gather};
        for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
            pel_free(arrays[k]);
    }
    pel_free(forces->bodies);
    pel_free(forces);
}
