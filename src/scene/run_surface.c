#include "scene/run_surface.h"

#include "base/memory.h"
#include "base/status.h"
#include "base/text.h"
#include "pellicle/intersect.h"
#include "pellicle/measure.h"
#include "pellicle/mesh_io.h"
#include "scene/run_fields.h"

#include <math.h>
#include <string.h>

/* the source of a field that does not change: it is filled in at the beginning */
enum { CONSTANT = PEL_RUN_FIELD_COUNT };

/* ---- fields ---- */

static const pel_field *find_mesh_field(const pel_model *model, const char *name)
{
    for (int32_t b = 0; b < pel_model_body_count(model); b++) {
        const pel_field *field = pel_mesh_field(pel_model_mesh(model, b), name);
        if (field != NULL)
            return field;
    }
    return NULL;
}

static pel_status refuse_field(const char *name, pel_error *error)
{
    const char *names[PEL_RUN_FIELD_COUNT];
    for (int f = 0; f < PEL_RUN_FIELD_COUNT; f++)
        names[f] = pel_run_fields[f].name;
    const char *nearest = pel_nearest_name(name, names, PEL_RUN_FIELD_COUNT);
    pel_fail(error, PEL_BAD_SCENE, "output field '%s' is neither one of the simulation nor of a mesh", name);
    if (nearest != NULL)
        pel_fail_remedy(error, "did you mean '%s'?", nearest);
    else
        pel_fail_remedy(error, "use the name of a mesh field or one that `pellicle reference` lists");
    return PEL_BAD_SCENE;
}

/* values of all bodies; zero on bodies that do not have the field */
static void fill_mesh_field(const pel_run_surface *surface, const pel_model *model, const pel_vtp_field *field,
                            double *values)
{
    size_t components = (size_t)field->component_count;
    for (int32_t b = 0; b < surface->body_count; b++) {
        const pel_mesh *mesh = pel_model_mesh(model, b);
        const pel_field *part = pel_mesh_field(mesh, field->name);
        if (part != NULL && part->component_count == field->component_count)
            memcpy(values + components * (size_t)surface->begin[b], part->values,
                   components * (size_t)mesh->vertex_count * sizeof *values);
    }
}

static void fill_body_numbers(const pel_run_surface *surface, double *values)
{
    for (int32_t b = 0; b < surface->body_count; b++)
        for (int32_t v = surface->begin[b]; v < surface->begin[b + 1]; v++)
            values[v] = b;
}

static pel_status add_field(pel_run_surface *surface, const char *name, int source, int32_t component_count,
                            double **values, pel_error *error)
{
    pel_vtp_field *field = &surface->fields[surface->field_count];
    *values = pel_allocate((size_t)surface->vertex_count * (size_t)component_count, sizeof(double));
    if (*values == NULL)
        return pel_fail_memory(error);
    *field = (pel_vtp_field){name, component_count, *values};
    surface->sources[surface->field_count++] = source;
    return PEL_OK;
}

static pel_status add_named_field(pel_run_surface *surface, const pel_model *model, const char *name, pel_error *error)
{
    double *values;
    for (int32_t f = 0; f < surface->field_count; f++)
        if (strcmp(surface->fields[f].name, name) == 0)
            return PEL_OK;
    int source = pel_run_field_find(name);
    if (source < PEL_RUN_FIELD_COUNT)
        return add_field(surface, name, source, pel_run_fields[source].component_count, &values, error);
    const pel_field *part = find_mesh_field(model, name);
    if (part == NULL)
        return refuse_field(name, error);
    pel_status status = add_field(surface, part->name, CONSTANT, part->component_count, &values, error);
    if (status == PEL_OK)
        fill_mesh_field(surface, model, &surface->fields[surface->field_count - 1], values);
    return status;
}

static pel_status add_fields(pel_run_surface *surface, const pel_model *model, const pel_output_def *output,
                             pel_error *error)
{
    double *values;
    pel_status status = PEL_OK;
    for (int32_t f = 0; status == PEL_OK && f < output->field_count; f++)
        status = add_named_field(surface, model, output->fields[f], error);
    if (status != PEL_OK || surface->body_count == 1)
        return status;
    for (int32_t f = 0; f < surface->field_count; f++)
        if (strcmp(surface->fields[f].name, "body") == 0)
            return PEL_OK;
    status = add_field(surface, "body", CONSTANT, 1, &values, error);
    if (status == PEL_OK)
        fill_body_numbers(surface, values);
    return status;
}

/* ---- creation ---- */

static pel_status count_surface(const pel_model *model, pel_run_surface *surface, pel_error *error)
{
    int64_t vertex_count = 0, triangle_count = 0;
    for (int32_t b = 0; b < surface->body_count; b++) {
        vertex_count += pel_model_mesh(model, b)->vertex_count;
        triangle_count += pel_model_mesh(model, b)->triangle_count;
    }
    if (vertex_count > INT32_MAX || triangle_count > INT32_MAX / 3)
        return pel_fail(error, PEL_BAD_SCENE, "the bodies have too many vertices or triangles for one file");
    surface->vertex_count = (int32_t)vertex_count;
    surface->triangle_count = (int32_t)triangle_count;
    return PEL_OK;
}

static void join_bodies(const pel_model *model, pel_run_surface *surface)
{
    int32_t *out = surface->triangles;
    for (int32_t b = 0; b < surface->body_count; b++) {
        const pel_mesh *mesh = pel_model_mesh(model, b);
        int32_t first = surface->begin[b];
        surface->begin[b + 1] = first + mesh->vertex_count;
        memcpy(surface->rest + 3 * (size_t)first, mesh->positions, (size_t)mesh->vertex_count * 3 * sizeof(double));
        for (int32_t t = 0; t < mesh->triangle_count; t++)
            for (int i = 0; i < 3; i++)
                *out++ = first + mesh->triangles[t][i];
    }
}

static bool is_measured(const pel_run_surface *surface)
{
    for (int32_t f = 0; f < surface->field_count; f++)
        if (surface->sources[f] >= PEL_RUN_AREA && surface->sources[f] != CONSTANT)
            return true;
    return false;
}

static pel_status add_topologies(pel_run_surface *surface, const pel_model *model, pel_error *error)
{
    pel_status status = PEL_OK;
    surface->topologies = pel_allocate((size_t)surface->body_count, sizeof *surface->topologies);
    if (surface->topologies == NULL)
        return pel_fail_memory(error);
    for (int32_t b = 0; status == PEL_OK && b < surface->body_count; b++)
        status = pel_topology_create(pel_model_mesh(model, b), &surface->topologies[b], error);
    return status;
}

pel_status pel_run_surface_create(const pel_model *model, const pel_output_def *output, pel_run_surface *surface,
                                  pel_error *error)
{
    *surface = (pel_run_surface){.body_count = pel_model_body_count(model)};
    pel_status status = count_surface(model, surface, error);
    if (status != PEL_OK)
        return status;
    size_t vertex_count = (size_t)surface->vertex_count, field_room = (size_t)output->field_count + 1;
    surface->begin = pel_allocate((size_t)surface->body_count + 1, sizeof *surface->begin);
    surface->triangles = pel_allocate(3 * (size_t)surface->triangle_count, sizeof *surface->triangles);
    surface->rest = pel_allocate(3 * vertex_count, sizeof(double));
    surface->positions = pel_allocate(3 * vertex_count, sizeof(double));
    surface->scratch = pel_allocate(3 * vertex_count, sizeof(double));
    surface->fields = pel_allocate(field_room, sizeof *surface->fields);
    surface->sources = pel_allocate(field_room, sizeof *surface->sources);
    if (surface->begin == NULL || surface->triangles == NULL || surface->rest == NULL || surface->positions == NULL ||
        surface->scratch == NULL || surface->fields == NULL || surface->sources == NULL)
        return pel_fail_memory(error);
    join_bodies(model, surface);
    status = add_fields(surface, model, output, error);
    return status == PEL_OK && is_measured(surface) ? add_topologies(surface, model, error) : status;
}

static double *field_values(const pel_vtp_field *field)
{
    /* made by add_field; const for those who read the file's description only */
    return (double *)(uintptr_t)field->values;
}

void pel_run_surface_destroy(pel_run_surface *surface)
{
    for (int32_t f = 0; f < surface->field_count; f++)
        pel_free(field_values(&surface->fields[f]));
    for (int32_t b = 0; surface->topologies != NULL && b < surface->body_count; b++)
        pel_topology_destroy(surface->topologies[b]);
    pel_free(surface->topologies);
    pel_free(surface->sources);
    pel_free(surface->fields);
    pel_free(surface->scratch);
    pel_free(surface->positions);
    pel_free(surface->rest);
    pel_free(surface->triangles);
    pel_free(surface->begin);
    *surface = (pel_run_surface){0};
}

/* ---- reading the simulation ---- */

static void read_positions(pel_run_surface *surface, const pel_sim *sim)
{
    for (int32_t b = 0; b < surface->body_count; b++)
        pel_sim_get_positions(sim, b, surface->positions + 3 * (size_t)surface->begin[b]);
}

/* the two energies of a body into the scratch, wanted in this mix into values */
static void read_energies(pel_run_surface *surface, const pel_sim *sim, int32_t body, int source, double *values)
{
    int32_t count = surface->begin[body + 1] - surface->begin[body];
    double *spring = surface->scratch, *volumetric = surface->scratch + count;
    pel_sim_get_energies(sim, body, spring, volumetric);
    for (int32_t v = 0; v < count; v++)
        values[v] = (source == PEL_RUN_VOLUMETRIC_ENERGY ? 0 : spring[v]) +
                    (source == PEL_RUN_SPRING_ENERGY ? 0 : volumetric[v]);
}

static void read_field(pel_run_surface *surface, pel_sim *sim, int32_t f, int32_t body)
{
    int source = surface->sources[f];
    size_t first = (size_t)surface->begin[body];
    double *values = field_values(&surface->fields[f]) + first * (size_t)surface->fields[f].component_count;
    switch (source) {
    case PEL_RUN_DISPLACEMENT:
        for (size_t i = 3 * first; i < 3 * (size_t)surface->begin[body + 1]; i++)
            values[i - 3 * first] = surface->positions[i] - surface->rest[i];
        break;
    case PEL_RUN_VELOCITY:
        pel_sim_get_velocities(sim, body, values);
        break;
    case PEL_RUN_FORCE:
        pel_sim_get_forces(sim, body, values);
        break;
    case PEL_RUN_CONTACT:
        pel_sim_get_contacts(sim, body, values);
        break;
    case PEL_RUN_ENERGY:
    case PEL_RUN_SPRING_ENERGY:
    case PEL_RUN_VOLUMETRIC_ENERGY:
        read_energies(surface, sim, body, source, values);
        break;
    case PEL_RUN_STRESS:
        pel_sim_get_spring_virials(sim, body, values);
        break;
    default:
        break;
    }
}

/* one measured number or vector of vertex v; a stress holds the virial so far */
static void put_measure(int source, const pel_vertex_measure *measure, int32_t v, double *values)
{
    if (source == PEL_RUN_AREA)
        values[v] = measure->area;
    else if (source == PEL_RUN_NORMAL)
        memcpy(values + 3 * (size_t)v, measure->normal, sizeof measure->normal);
    else if (source == PEL_RUN_MEAN_CURVATURE)
        values[v] = measure->mean_curvature;
    else if (source == PEL_RUN_GAUSSIAN_CURVATURE)
        values[v] = measure->gaussian_curvature;
    else if (source == PEL_RUN_STRESS)
        values[v] = measure->area > 0 ? values[v] / (2 * measure->area) : 0;
}

/* the fields that are measured on the surface, all in one pass over the vertices of each body */
static void read_measures(pel_run_surface *surface)
{
    for (int32_t b = 0; b < surface->body_count; b++) {
        int32_t first = surface->begin[b];
        for (int32_t v = first; v < surface->begin[b + 1]; v++) {
            pel_vertex_measure measure;
            pel_vertex_measure_fill(surface->topologies[b], surface->positions + 3 * (size_t)first, v - first,
                                    &measure);
            for (int32_t f = 0; f < surface->field_count; f++)
                put_measure(surface->sources[f], &measure, v, field_values(&surface->fields[f]));
        }
    }
}

pel_status pel_run_surface_intersections(pel_run_surface *surface, const pel_sim *sim, int64_t *count, pel_error *error)
{
    read_positions(surface, sim);
    const pel_mesh mesh = {.vertex_count = surface->vertex_count,
                           .triangle_count = surface->triangle_count,
                           .positions = (double(*)[3])surface->positions,
                           .triangles = (int32_t(*)[3])surface->triangles};
    return pel_mesh_self_intersections(&mesh, NULL, 0, count, error);
}

double pel_run_surface_speed(pel_run_surface *surface, const pel_sim *sim)
{
    double largest = 0;
    for (int32_t b = 0; b < surface->body_count; b++) {
        pel_sim_get_velocities(sim, b, surface->scratch);
        for (int32_t v = 0; v < surface->begin[b + 1] - surface->begin[b]; v++) {
            const double *u = surface->scratch + 3 * (size_t)v;
            largest = fmax(largest, u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        }
    }
    return sqrt(largest);
}

/* ---- writing ---- */

pel_status pel_run_surface_write_frame(pel_run_surface *surface, pel_sim *sim, const pel_output_def *output,
                                       const char *path, pel_error *error)
{
    read_positions(surface, sim);
    for (int32_t f = 0; f < surface->field_count; f++)
        for (int32_t b = 0; b < surface->body_count; b++)
            read_field(surface, sim, f, b);
    if (surface->topologies != NULL)
        read_measures(surface);
    const pel_vtp vtp = {
        .vertex_count = surface->vertex_count,
        .triangle_count = surface->triangle_count,
        .positions = surface->positions,
        .triangles = surface->triangles,
        .fields = surface->fields,
        .field_count = surface->field_count,
        .time = pel_sim_time(sim),
        .compress = output->compress,
        .float64 = output->float64,
    };
    return pel_vtp_write(path, &vtp, error);
}

/* every field of a mesh once, on all bodies */
static pel_status add_mesh_fields(const pel_run_surface *surface, const pel_model *model, pel_mesh *mesh,
                                  pel_error *error)
{
    for (int32_t b = 0; b < surface->body_count; b++) {
        const pel_mesh *part = pel_model_mesh(model, b);
        for (int32_t f = 0; f < part->field_count; f++) {
            const pel_field *field = &part->fields[f];
            if (pel_mesh_field(mesh, field->name) != NULL)
                continue;
            pel_status status = pel_mesh_add_field(mesh, field->name, field->component_count, NULL, error);
            if (status != PEL_OK)
                return status;
            const pel_field *made = pel_mesh_field(mesh, field->name);
            const pel_vtp_field description = {made->name, made->component_count, made->values};
            fill_mesh_field(surface, model, &description, made->values);
        }
    }
    if (surface->body_count == 1 || pel_mesh_field(mesh, "body") != NULL)
        return PEL_OK;
    pel_status status = pel_mesh_add_field(mesh, "body", 1, NULL, error);
    if (status == PEL_OK)
        fill_body_numbers(surface, pel_mesh_field(mesh, "body")->values);
    return status;
}

pel_status pel_run_surface_write_final(pel_run_surface *surface, const pel_sim *sim, const char *path, pel_error *error)
{
    pel_mesh *mesh;
    read_positions(surface, sim);
    pel_status status = pel_mesh_create(surface->positions, surface->vertex_count, surface->triangles,
                                        surface->triangle_count, &mesh, error);
    if (status == PEL_OK)
        status = add_mesh_fields(surface, pel_sim_model(sim), mesh, error);
    if (status == PEL_OK)
        status = pel_mesh_write(path, PEL_FORMAT_PLY, mesh, NULL, error);
    pel_mesh_destroy(mesh);
    return status;
}
