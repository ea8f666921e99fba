#include "results/surface.h"

#include "base/memory.h"
#include "base/status.h"
#include "base/text.h"
#include "math/vec3.h"
#include "pellicle/intersect.h"
#include "pellicle/measure.h"
#include "pellicle/mesh_io.h"
#include "results/fields.h"

#include <math.h>
#include <string.h>

/* sources of fields that change with the surface alone */
enum { SOURCE_MESH = PEL_RUN_FIELD_COUNT, SOURCE_BODY, SOURCE_LEVEL, SOURCE_MESH_VERTICES, SOURCE_MESH_WEIGHTS };

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

/* where the rows of a body lie in its mesh: the triangles behind the scratch, the weights in it */
static const int32_t *read_places(const pel_run_surface *surface, const pel_sim *sim, int32_t body)
{
    pel_sim_get_mesh_places(sim, body, surface->row_numbers, surface->scratch);
    return surface->row_numbers;
}

/* a field of a mesh on the rows of its body; finer vertices take the mean of the triangle they lie in */
static void fill_rows(const pel_run_surface *surface, const pel_sim *sim, int32_t body, const pel_field *part,
                      double *values)
{
    const pel_mesh *mesh = pel_model_mesh(pel_sim_model(sim), body);
    size_t components = (size_t)part->component_count, mesh_count = (size_t)mesh->vertex_count;
    size_t count = (size_t)(surface->begin[body + 1] - surface->begin[body]);
    memcpy(values, part->values, components * mesh_count * sizeof *values);
    if (count == mesh_count)
        return;
    const int32_t *triangles = read_places(surface, sim, body);
    for (size_t r = mesh_count; r < count; r++)
        for (size_t c = 0; c < components; c++) {
            double sum = 0;
            for (size_t k = 0; k < 3; k++)
                sum += surface->scratch[3 * r + k] *
                       part->values[components * (size_t)mesh->triangles[triangles[r]][k] + c];
            values[components * r + c] = sum;
        }
}

/* values of all bodies; zero on bodies that do not have the field */
static void fill_mesh_field(const pel_run_surface *surface, const pel_sim *sim, const char *name,
                            int32_t component_count, double *values)
{
    for (int32_t b = 0; b < surface->body_count; b++) {
        const pel_field *part = pel_mesh_field(pel_model_mesh(pel_sim_model(sim), b), name);
        if (part != NULL && part->component_count == component_count)
            fill_rows(surface, sim, b, part, values + (size_t)component_count * (size_t)surface->begin[b]);
    }
}

static void fill_body_numbers(const pel_run_surface *surface, double *values)
{
    for (int32_t b = 0; b < surface->body_count; b++)
        for (int32_t v = surface->begin[b]; v < surface->begin[b + 1]; v++)
            values[v] = b;
}

/* the finest level of the triangles at a vertex: a triangle has the level of its finest corner */
static void fill_levels(const pel_run_surface *surface, const pel_sim *sim, double *values)
{
    for (int32_t b = 0; b < surface->body_count; b++)
        pel_sim_get_levels(sim, b, surface->row_numbers + surface->begin[b]);
    memset(values, 0, (size_t)surface->vertex_count * sizeof *values);
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        const int32_t *v = surface->triangles + 3 * (size_t)t;
        double finest = 0;
        for (int i = 0; i < 3; i++)
            finest = fmax(finest, surface->row_numbers[v[i]]);
        for (int i = 0; i < 3; i++)
            values[v[i]] = fmax(values[v[i]], finest);
    }
}

/* the corners of the triangle of the mesh that a vertex lies in, or their weights */
static void fill_places(const pel_run_surface *surface, const pel_sim *sim, int source, double *values)
{
    for (int32_t b = 0; b < surface->body_count; b++) {
        const pel_mesh *mesh = pel_model_mesh(pel_sim_model(sim), b);
        const int32_t *triangles = read_places(surface, sim, b);
        size_t first = (size_t)surface->begin[b], count = (size_t)surface->begin[b + 1] - first;
        double *out = values + 3 * first;
        if (source == SOURCE_MESH_WEIGHTS)
            memcpy(out, surface->scratch, 3 * count * sizeof *out);
        for (size_t i = 0; source == SOURCE_MESH_VERTICES && i < 3 * count; i++)
            out[i] = mesh->triangles[triangles[i / 3]][i % 3];
    }
}

static double *field_values(const pel_vtp_field *field)
{
    /* made by make_values; const for those who read the file's description only */
    return (double *)(uintptr_t)field->values;
}

/* values of a field for the present number of vertices; those that change with the surface alone are filled in */
static pel_status make_values(const pel_run_surface *surface, const pel_sim *sim, int source, pel_vtp_field *field,
                              pel_error *error)
{
    pel_free(field_values(field));
    double *values = pel_allocate((size_t)surface->vertex_count * (size_t)field->component_count, sizeof *values);
    field->values = values;
    if (values == NULL)
        return pel_fail_memory(error);
    if (source == SOURCE_MESH)
        fill_mesh_field(surface, sim, field->name, field->component_count, values);
    else if (source == SOURCE_BODY)
        fill_body_numbers(surface, values);
    else if (source == SOURCE_LEVEL)
        fill_levels(surface, sim, values);
    else if (source == SOURCE_MESH_VERTICES || source == SOURCE_MESH_WEIGHTS)
        fill_places(surface, sim, source, values);
    return PEL_OK;
}

static pel_status add_field(pel_run_surface *surface, const pel_sim *sim, const char *name, int source,
                            int32_t component_count, pel_error *error)
{
    for (int32_t f = 0; f < surface->field_count; f++)
        if (strcmp(surface->fields[f].name, name) == 0)
            return PEL_OK;
    pel_vtp_field *field = &surface->fields[surface->field_count];
    *field = (pel_vtp_field){name, component_count, NULL};
    surface->sources[surface->field_count++] = source;
    return make_values(surface, sim, source, field, error);
}

static pel_status add_named_field(pel_run_surface *surface, const pel_sim *sim, const char *name, pel_error *error)
{
    int source = pel_run_field_find(name);
    if (source < PEL_RUN_FIELD_COUNT)
        return add_field(surface, sim, name, source, pel_run_fields[source].component_count, error);
    const pel_field *part = find_mesh_field(pel_sim_model(sim), name);
    if (part == NULL)
        return refuse_field(name, error);
    return add_field(surface, sim, part->name, SOURCE_MESH, part->component_count, error);
}

static pel_status add_fields(pel_run_surface *surface, const pel_sim *sim, const pel_output_def *output,
                             pel_error *error)
{
    bool refines = false;
    for (int32_t b = 0; b < surface->body_count; b++)
        refines |= pel_sim_refines(sim, b);
    pel_status status = PEL_OK;
    for (int32_t f = 0; status == PEL_OK && f < output->field_count; f++)
        status = add_named_field(surface, sim, output->fields[f], error);
    if (status == PEL_OK && surface->body_count > 1)
        status = add_field(surface, sim, "body", SOURCE_BODY, 1, error);
    if (status == PEL_OK && refines)
        status = add_field(surface, sim, "level", SOURCE_LEVEL, 1, error);
    if (status == PEL_OK && refines)
        status = add_field(surface, sim, "mesh_vertices", SOURCE_MESH_VERTICES, 3, error);
    if (status == PEL_OK && refines)
        status = add_field(surface, sim, "mesh_weights", SOURCE_MESH_WEIGHTS, 3, error);
    return status;
}

/* ---- creation ---- */

static pel_status count_surface(const pel_sim *sim, pel_run_surface *surface, pel_error *error)
{
    int64_t vertex_count = 0, triangle_count = 0;
    surface->revision = 0;
    for (int32_t b = 0; b < surface->body_count; b++) {
        vertex_count += pel_sim_vertex_count(sim, b);
        triangle_count += pel_sim_triangle_count(sim, b);
        surface->revision += pel_sim_surface_revision(sim, b);
    }
    if (vertex_count > INT32_MAX || triangle_count > INT32_MAX / 3)
        return pel_fail(error, PEL_BAD_SCENE, "the bodies have too many vertices or triangles for one file");
    surface->vertex_count = (int32_t)vertex_count;
    surface->triangle_count = (int32_t)triangle_count;
    return PEL_OK;
}

static void join_bodies(const pel_sim *sim, pel_run_surface *surface)
{
    int32_t *out = surface->triangles;
    for (int32_t b = 0; b < surface->body_count; b++) {
        int32_t first = surface->begin[b], corner_count = 3 * pel_sim_triangle_count(sim, b);
        surface->begin[b + 1] = first + pel_sim_vertex_count(sim, b);
        pel_sim_get_rest_positions(sim, b, surface->rest + 3 * (size_t)first);
        pel_sim_get_triangles(sim, b, out);
        for (int32_t i = 0; i < corner_count; i++)
            out[i] += first;
        out += corner_count;
    }
}

static void free_buffers(pel_run_surface *surface)
{
    pel_free(surface->row_numbers);
    pel_free(surface->scratch);
    pel_free(surface->positions);
    pel_free(surface->rest);
    pel_free(surface->triangles);
}

/* buffers for the present surface */
static pel_status make_buffers(const pel_sim *sim, pel_run_surface *surface, pel_error *error)
{
    pel_status status = count_surface(sim, surface, error);
    if (status != PEL_OK)
        return status;
    size_t vertex_count = (size_t)surface->vertex_count;
    free_buffers(surface);
    surface->triangles = pel_allocate(3 * (size_t)surface->triangle_count, sizeof *surface->triangles);
    surface->rest = pel_allocate(3 * vertex_count, sizeof(double));
    surface->positions = pel_allocate(3 * vertex_count, sizeof(double));
    surface->scratch = pel_allocate(3 * vertex_count, sizeof(double));
    surface->row_numbers = pel_allocate(vertex_count, sizeof *surface->row_numbers);
    if (surface->triangles == NULL || surface->rest == NULL || surface->positions == NULL || surface->scratch == NULL ||
        surface->row_numbers == NULL) {
        surface->revision = -1;
        return pel_fail_memory(error);
    }
    join_bodies(sim, surface);
    return PEL_OK;
}

static bool is_measured(const pel_run_surface *surface)
{
    for (int32_t f = 0; f < surface->field_count; f++)
        if (surface->sources[f] >= PEL_RUN_AREA && surface->sources[f] < PEL_RUN_STRESS)
            return true;
    return false;
}

static void free_topologies(pel_run_surface *surface)
{
    for (int32_t b = 0; surface->topologies != NULL && b < surface->body_count; b++)
        pel_topology_destroy(surface->topologies[b]);
    pel_free(surface->topologies);
    surface->topologies = NULL;
}

static pel_status make_topology(const pel_run_surface *surface, const pel_sim *sim, int32_t body,
                                pel_topology **topology, pel_error *error)
{
    pel_mesh mesh = {.vertex_count = pel_sim_vertex_count(sim, body),
                     .triangle_count = pel_sim_triangle_count(sim, body),
                     .positions = (double(*)[3])(surface->rest + 3 * (size_t)surface->begin[body])};
    mesh.triangles = pel_allocate((size_t)mesh.triangle_count, sizeof *mesh.triangles);
    if (mesh.triangles == NULL)
        return pel_fail_memory(error);
    pel_sim_get_triangles(sim, body, mesh.triangles[0]);
    pel_status status = pel_topology_create(&mesh, topology, error);
    pel_free(mesh.triangles);
    return status;
}

/* for the fields that are measured on the surface */
static pel_status make_topologies(pel_run_surface *surface, const pel_sim *sim, pel_error *error)
{
    free_topologies(surface);
    if (!is_measured(surface))
        return PEL_OK;
    surface->topologies = pel_allocate((size_t)surface->body_count, sizeof *surface->topologies);
    if (surface->topologies == NULL)
        return pel_fail_memory(error);
    pel_status status = PEL_OK;
    for (int32_t b = 0; status == PEL_OK && b < surface->body_count; b++)
        status = make_topology(surface, sim, b, &surface->topologies[b], error);
    return status;
}

static void free_mechanics(pel_run_surface *surface)
{
    for (int32_t f = 0; f < surface->cell_field_count; f++)
        pel_free(field_values(&surface->cell_fields[f]));
    surface->cell_field_count = 0;
    pel_free(surface->mechanics);
    pel_free(surface->on_triangles);
    pel_free(surface->on_vertices);
    surface->mechanics = NULL;
    surface->on_triangles = surface->on_vertices = NULL;
}

/* rooms of the fields of mechanics, when there are any: each on triangles too */
static pel_status make_mechanics(pel_run_surface *surface, pel_error *error)
{
    size_t triangle_count = (size_t)surface->triangle_count;
    free_mechanics(surface);
    for (int32_t f = 0; f < surface->field_count; f++) {
        if (!pel_run_field_is_mechanics(surface->sources[f]))
            continue;
        pel_vtp_field *field = &surface->cell_fields[surface->cell_field_count];
        *field = surface->fields[f];
        field->values = pel_allocate(triangle_count * (size_t)field->component_count, sizeof(double));
        surface->cell_sources[surface->cell_field_count++] = surface->sources[f];
        if (field->values == NULL)
            return pel_fail_memory(error);
    }
    if (surface->cell_field_count == 0)
        return PEL_OK;
    surface->mechanics = pel_allocate(triangle_count, sizeof *surface->mechanics);
    surface->on_triangles = pel_allocate(triangle_count, sizeof *surface->on_triangles);
    surface->on_vertices = pel_allocate((size_t)surface->vertex_count, sizeof *surface->on_vertices);
    if (surface->mechanics == NULL || surface->on_triangles == NULL || surface->on_vertices == NULL)
        return pel_fail_memory(error);
    return PEL_OK;
}

/* brings the buffers after the surface when a body has refined or coarsened */
static pel_status refresh(pel_run_surface *surface, const pel_sim *sim, pel_error *error)
{
    int64_t revision = 0;
    for (int32_t b = 0; b < surface->body_count; b++)
        revision += pel_sim_surface_revision(sim, b);
    if (revision == surface->revision)
        return PEL_OK;
    pel_status status = make_buffers(sim, surface, error);
    for (int32_t f = 0; status == PEL_OK && f < surface->field_count; f++)
        status = make_values(surface, sim, surface->sources[f], &surface->fields[f], error);
    if (status == PEL_OK)
        status = make_topologies(surface, sim, error);
    if (status == PEL_OK)
        status = make_mechanics(surface, error);
    if (status != PEL_OK)
        surface->revision = -1;
    return status;
}

pel_status pel_run_surface_create(const pel_sim *sim, const pel_output_def *output, pel_run_surface *surface,
                                  pel_error *error)
{
    *surface = (pel_run_surface){.body_count = pel_model_body_count(pel_sim_model(sim))};
    size_t field_room = (size_t)output->field_count + 4;
    surface->begin = pel_allocate((size_t)surface->body_count + 1, sizeof *surface->begin);
    surface->fields = pel_allocate(field_room, sizeof *surface->fields);
    surface->sources = pel_allocate(field_room, sizeof *surface->sources);
    surface->cell_fields = pel_allocate(field_room, sizeof *surface->cell_fields);
    surface->cell_sources = pel_allocate(field_room, sizeof *surface->cell_sources);
    if (surface->cell_fields == NULL || surface->cell_sources == NULL || surface->begin == NULL ||
        surface->fields == NULL || surface->sources == NULL)
        return pel_fail_memory(error);
    pel_status status = make_buffers(sim, surface, error);
    if (status == PEL_OK)
        status = pel_vtp_writer_create(&surface->writer, error);
    if (status == PEL_OK)
        status = add_fields(surface, sim, output, error);
    if (status == PEL_OK)
        status = make_topologies(surface, sim, error);
    return status == PEL_OK ? make_mechanics(surface, error) : status;
}

void pel_run_surface_destroy(pel_run_surface *surface)
{
    for (int32_t f = 0; f < surface->field_count; f++)
        pel_free(field_values(&surface->fields[f]));
    free_topologies(surface);
    free_mechanics(surface);
    pel_free(surface->cell_sources);
    pel_free(surface->cell_fields);
    pel_vtp_writer_destroy(surface->writer);
    pel_free(surface->sources);
    pel_free(surface->fields);
    free_buffers(surface);
    pel_free(surface->begin);
    *surface = (pel_run_surface){0};
}

/* ---- reading the simulation ---- */

static void read_positions(pel_run_surface *surface, const pel_sim *sim)
{
    for (int32_t b = 0; b < surface->body_count; b++)
        pel_sim_get_positions(sim, b, surface->positions + 3 * (size_t)surface->begin[b]);
}

/* adds one of three lists of the scratch, or all of them, to values */
static void add_lists(const pel_run_surface *surface, int32_t count, int first_source, int source, double *values)
{
    for (int i = 0; i < 3; i++)
        for (int32_t v = 0; (source == PEL_RUN_ENERGY || source == first_source + i) && v < count; v++)
            values[v] += surface->scratch[(size_t)i * (size_t)count + (size_t)v];
}

/* one energy of a body, or the sum of all */
static void read_energies(pel_run_surface *surface, const pel_sim *sim, int32_t body, int source, double *values)
{
    int32_t count = surface->begin[body + 1] - surface->begin[body];
    double *first = surface->scratch, *second = first + count, *third = second + count;
    memset(values, 0, (size_t)count * sizeof *values);
    if (source <= PEL_RUN_VOLUMETRIC_ENERGY) {
        pel_sim_get_energies(sim, body, first, second);
        memset(third, 0, (size_t)count * sizeof *third);
        add_lists(surface, count, PEL_RUN_SPRING_ENERGY, source, values);
    }
    if (source == PEL_RUN_ENERGY || source >= PEL_RUN_MEMBRANE_ENERGY) {
        pel_sim_get_shell_energies(sim, body, first, second, third);
        add_lists(surface, count, PEL_RUN_MEMBRANE_ENERGY, source, values);
    }
}

/* triangles of a body, with the rows of the surface as corners */
static const int32_t *triangles_of(const pel_run_surface *surface, const pel_sim *sim, int32_t body, int32_t *count)
{
    size_t first = 0;
    for (int32_t b = 0; b < body; b++)
        first += (size_t)pel_sim_triangle_count(sim, b);
    *count = pel_sim_triangle_count(sim, body);
    return surface->triangles + 3 * first;
}

/* the virial over twice the area that it belongs to: thirds of the triangles */
static void read_stress(pel_run_surface *surface, const pel_sim *sim, int32_t body, double *values)
{
    int32_t count, first = surface->begin[body], rows = surface->begin[body + 1] - first;
    const int32_t *triangles = triangles_of(surface, sim, body, &count);
    double *areas = surface->scratch;
    memset(areas, 0, (size_t)rows * sizeof *areas);
    for (int32_t t = 0; t < count; t++) {
        const int32_t *v = triangles + 3 * (size_t)t;
        const double *x = surface->positions;
        double area = pel_vec3_triangle_area(x + 3 * (size_t)v[0], x + 3 * (size_t)v[1], x + 3 * (size_t)v[2]);
        for (int k = 0; k < 3; k++)
            areas[v[k] - first] += area / 3;
    }
    pel_sim_get_spring_virials(sim, body, values);
    for (int32_t v = 0; v < rows; v++)
        values[v] = areas[v] > 0 ? values[v] / (2 * areas[v]) : 0;
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
    case PEL_RUN_CONTACT_FORCE:
        pel_sim_get_contact_forces(sim, body, values);
        break;
    case PEL_RUN_ENERGY:
    case PEL_RUN_SPRING_ENERGY:
    case PEL_RUN_VOLUMETRIC_ENERGY:
    case PEL_RUN_MEMBRANE_ENERGY:
    case PEL_RUN_BENDING_ENERGY:
    case PEL_RUN_FIBRE_ENERGY:
        read_energies(surface, sim, body, source, values);
        break;
    case PEL_RUN_PRESSURE:
        pel_sim_get_pressure_forces(sim, body, values);
        break;
    case PEL_RUN_STRESS:
        read_stress(surface, sim, body, values);
        break;
    default:
        break;
    }
}

/* one measured number or vector of vertex v */
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

/* the fields of mechanics of all bodies, on triangles and smoothed */
static void read_mechanics(pel_run_surface *surface, pel_sim *sim)
{
    size_t done = 0;
    for (int32_t b = 0; b < surface->body_count; b++) {
        pel_sim_get_mechanics(sim, b, surface->mechanics + done);
        done += (size_t)pel_sim_triangle_count(sim, b);
    }
    pel_run_mechanics_of(surface->mechanics, surface->triangles, surface->triangle_count, surface->rest,
                         surface->positions, surface->on_triangles);
    pel_run_mechanics_smooth(surface->on_triangles, surface->triangles, surface->triangle_count, surface->vertex_count,
                             surface->on_vertices);
    for (int32_t f = 0; f < surface->field_count; f++) {
        size_t components = (size_t)surface->fields[f].component_count;
        double *values = field_values(&surface->fields[f]);
        if (!pel_run_field_is_mechanics(surface->sources[f]))
            continue;
        for (size_t v = 0; v < (size_t)surface->vertex_count; v++)
            pel_run_mechanics_put(&surface->on_vertices[v], (pel_run_field)surface->sources[f],
                                  values + v * components);
    }
    for (int32_t f = 0; f < surface->cell_field_count; f++) {
        size_t components = (size_t)surface->cell_fields[f].component_count;
        double *values = field_values(&surface->cell_fields[f]);
        for (size_t t = 0; t < (size_t)surface->triangle_count; t++)
            pel_run_mechanics_put(&surface->on_triangles[t], (pel_run_field)surface->cell_sources[f],
                                  values + t * components);
    }
}

pel_status pel_run_surface_intersections(pel_run_surface *surface, const pel_sim *sim, int64_t *count, pel_error *error)
{
    pel_status status = refresh(surface, sim, error);
    if (status != PEL_OK)
        return status;
    read_positions(surface, sim);
    const pel_mesh mesh = {.vertex_count = surface->vertex_count,
                           .triangle_count = surface->triangle_count,
                           .positions = (double(*)[3])surface->positions,
                           .triangles = (int32_t(*)[3])surface->triangles};
    return pel_mesh_self_intersections(&mesh, NULL, 0, count, error);
}

/* ---- writing ---- */

pel_status pel_run_surface_write_frame(pel_run_surface *surface, pel_sim *sim, const pel_output_def *output,
                                       const char *path, pel_error *error)
{
    pel_status status = refresh(surface, sim, error);
    if (status != PEL_OK)
        return status;
    read_positions(surface, sim);
    for (int32_t f = 0; f < surface->field_count; f++)
        for (int32_t b = 0; b < surface->body_count; b++)
            read_field(surface, sim, f, b);
    if (surface->topologies != NULL)
        read_measures(surface);
    if (surface->mechanics != NULL)
        read_mechanics(surface, sim);
    const pel_vtp vtp = {
        .vertex_count = surface->vertex_count,
        .triangle_count = surface->triangle_count,
        .positions = surface->positions,
        .triangles = surface->triangles,
        .fields = surface->fields,
        .field_count = surface->field_count,
        .cell_fields = surface->cell_fields,
        .cell_field_count = surface->cell_field_count,
        .time = pel_sim_time(sim),
        .compress = output->compress,
        .float64 = output->float64,
    };
    return pel_vtp_writer_write(surface->writer, path, &vtp, error);
}

/* every field of a mesh once, on all bodies */
static pel_status add_mesh_fields(const pel_run_surface *surface, const pel_sim *sim, pel_mesh *mesh, pel_error *error)
{
    const pel_model *model = pel_sim_model(sim);
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
            fill_mesh_field(surface, sim, made->name, made->component_count, made->values);
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
    pel_status status = refresh(surface, sim, error);
    if (status != PEL_OK)
        return status;
    read_positions(surface, sim);
    status = pel_mesh_create(surface->positions, surface->vertex_count, surface->triangles, surface->triangle_count,
                             &mesh, error);
    if (status == PEL_OK)
        status = add_mesh_fields(surface, sim, mesh, error);
    if (status == PEL_OK)
        status = pel_mesh_write(path, PEL_FORMAT_PLY, mesh, NULL, error);
    pel_mesh_destroy(mesh);
    return status;
}
