#include "results/surface.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "base/text.h"
#include "math/bounds.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "observe/field.h"
#include "pellicle/intersect.h"
#include "pellicle/mesh_io.h"
#include "pellicle/sim_surface.h"
#include "pellicle/tear.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* of the size of a body: error of positions from which float does not suffice */
#define FLOAT_ERROR 1e-5
/* of the mean edge: lips of a cut that are nearer have not opened */
#define CLOSED_LIP 1e-6

/* sources of fields that change with the surface alone */
enum { SOURCE_MESH = PEL_FIELD_COUNT, SOURCE_BODY, SOURCE_LEVEL, SOURCE_MESH_VERTICES, SOURCE_MESH_WEIGHTS };

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
    const char *names[PEL_FIELD_COUNT];
    for (int f = 0; f < PEL_FIELD_COUNT; f++)
        names[f] = pel_field_at(f)->name;
    const char *nearest = pel_nearest_name(name, names, PEL_FIELD_COUNT);
    pel_fail(error, PEL_BAD_SCENE, "output field '%s' is neither one of the simulation nor of a mesh", name);
    if (nearest != NULL)
        pel_fail_remedy(error, "did you mean '%s'?", nearest);
    else
        pel_fail_remedy(error, "use the name of a mesh field or one that `pellicle reference` lists");
    return PEL_BAD_SCENE;
}

/* where the rows of a body lie in its mesh: the triangles after the scratch, the weights in it */
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
            finest = pel_max(finest, surface->row_numbers[v[i]]);
        for (int i = 0; i < 3; i++)
            values[v[i]] = pel_max(values[v[i]], finest);
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
    int32_t source = pel_field_find(name);
    if (source >= 0)
        return add_field(surface, sim, name, source, pel_field_at(source)->component_count, error);
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
    PEL_FREE_ALL(surface->row_numbers, surface->scratch, surface->positions, surface->rest, surface->triangles);
}

/* buffers for the present surface */
static pel_status make_buffers(const pel_sim *sim, pel_run_surface *surface, pel_error *error)
{
    pel_status status = count_surface(sim, surface, error);
    if (status != PEL_OK)
        return status;
    size_t vertex_count = (size_t)surface->vertex_count;
    free_buffers(surface);
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(surface->triangles, 3 * (size_t)surface->triangle_count),
                          PEL_ROOM(surface->rest, 3 * vertex_count), PEL_ROOM(surface->positions, 3 * vertex_count),
                          PEL_ROOM(surface->scratch, 3 * vertex_count), PEL_ROOM(surface->row_numbers, vertex_count))) {
        surface->revision = -1;
        return pel_fail_memory(error);
    }
    join_bodies(sim, surface);
    return PEL_OK;
}

static void free_cell_fields(pel_run_surface *surface)
{
    for (int32_t f = 0; f < surface->cell_field_count; f++)
        pel_free(field_values(&surface->cell_fields[f]));
    surface->cell_field_count = 0;
}

/* fields that are on triangles as well */
static pel_status make_cell_fields(pel_run_surface *surface, pel_error *error)
{
    free_cell_fields(surface);
    for (int32_t f = 0; f < surface->field_count; f++) {
        if (!pel_field_is_mechanics(surface->sources[f]))
            continue;
        pel_vtp_field *field = &surface->cell_fields[surface->cell_field_count];
        *field = surface->fields[f];
        field->values = pel_allocate((size_t)surface->triangle_count * (size_t)field->component_count, sizeof(double));
        surface->cell_sources[surface->cell_field_count++] = surface->sources[f];
        if (field->values == NULL)
            return pel_fail_memory(error);
    }
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
        status = make_cell_fields(surface, error);
    if (status != PEL_OK)
        surface->revision = -1;
    return status;
}

pel_status pel_run_surface_create(const pel_sim *sim, const pel_output_def *output, pel_run_surface *surface,
                                  pel_error *error)
{
    *surface = (pel_run_surface){.body_count = pel_model_body_count(pel_sim_model(sim))};
    size_t field_room = (size_t)output->field_count + 4;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(surface->begin, (size_t)surface->body_count + 1),
                          PEL_ROOM(surface->fields, field_room), PEL_ROOM(surface->sources, field_room),
                          PEL_ROOM(surface->cell_fields, field_room), PEL_ROOM(surface->cell_sources, field_room)))
        return pel_fail_memory(error);
    pel_status status = make_buffers(sim, surface, error);
    if (status == PEL_OK)
        status = pel_vtp_writer_create(&surface->writer, error);
    if (status == PEL_OK)
        status = add_fields(surface, sim, output, error);
    return status == PEL_OK ? make_cell_fields(surface, error) : status;
}

void pel_run_surface_destroy(pel_run_surface *surface)
{
    for (int32_t f = 0; f < surface->field_count; f++)
        pel_free(field_values(&surface->fields[f]));
    free_cell_fields(surface);
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

/* the fields of all bodies, on vertices and on triangles */
static pel_status read_fields(pel_run_surface *surface, pel_sim *sim, pel_error *error)
{
    pel_status status = PEL_OK;
    size_t triangle = 0;
    for (int32_t b = 0; status == PEL_OK && b < surface->body_count; b++) {
        for (int32_t f = 0; status == PEL_OK && f < surface->field_count; f++) {
            const pel_vtp_field *field = &surface->fields[f];
            size_t first = (size_t)surface->begin[b] * (size_t)field->component_count;
            if (surface->sources[f] < PEL_FIELD_COUNT)
                status = pel_observe(sim, surface->sources[f], b, field_values(field) + first, error);
        }
        for (int32_t f = 0; status == PEL_OK && f < surface->cell_field_count; f++) {
            const pel_vtp_field *field = &surface->cell_fields[f];
            size_t first = triangle * (size_t)field->component_count;
            status = pel_observe_triangles(sim, surface->cell_sources[f], b, field_values(field) + first, error);
        }
        triangle += (size_t)pel_sim_triangle_count(sim, b);
    }
    return status;
}

/* m */
static double closed_distance(const pel_run_surface *surface)
{
    double sum = 0;
    for (int32_t t = 0; t < surface->triangle_count; t++)
        sum += pel_vec3_distance(surface->positions + 3 * (size_t)surface->triangles[3 * (size_t)t],
                                 surface->positions + 3 * (size_t)surface->triangles[3 * (size_t)t + 1]);
    return CLOSED_LIP * sum / pel_max(surface->triangle_count, 1);
}

/* Copies of vertices along cuts that lie where another copy, or their original, does: map has the one of them that
   comes first, other vertices themselves. links lead from each copy to the one before it, and at last to the original.
 */
static void close_lips(const pel_run_surface *surface, const pel_sim *sim, int32_t *links, int32_t *map)
{
    const double closed = closed_distance(surface);
    for (int32_t v = 0; v < surface->vertex_count; v++)
        links[v] = map[v] = v;
    for (int32_t b = 0; b < surface->body_count; b++) {
        const int32_t begin = surface->begin[b];
        int32_t *origins = surface->row_numbers + begin;
        if (pel_sim_refines(sim, b))
            continue;
        pel_sim_get_origins(sim, b, origins);
        for (int32_t v = begin; v < surface->begin[b + 1]; v++) {
            int32_t origin = begin + origins[v - begin], at = v;
            if (origin == v)
                continue;
            links[v] = links[origin];
            links[origin] = v;
            do {
                at = links[at];
                if (map[v] == v && pel_vec3_distance(surface->positions + 3 * (size_t)v,
                                                     surface->positions + 3 * (size_t)at) <= closed)
                    map[v] = map[at];
            } while (at != origin);
        }
    }
}

/* lips of a cut that has not opened lie on each other, and are joined */
pel_status pel_run_surface_intersections(pel_run_surface *surface, const pel_sim *sim, int64_t *count, pel_error *error)
{
    int32_t *links = NULL, *map = NULL, *triangles = NULL;
    pel_status status = refresh(surface, sim, error);
    if (status != PEL_OK)
        return status;
    read_positions(surface, sim);
    const size_t corner_count = 3 * (size_t)surface->triangle_count;
    if (PEL_ALLOCATE_ALL(PEL_ROOM(links, surface->vertex_count), PEL_ROOM(map, surface->vertex_count),
                         PEL_ROOM(triangles, corner_count))) {
        close_lips(surface, sim, links, map);
        for (size_t i = 0; i < corner_count; i++)
            triangles[i] = map[surface->triangles[i]];
        const pel_mesh mesh = {.vertex_count = surface->vertex_count,
                               .triangle_count = surface->triangle_count,
                               .positions = (double(*)[3])surface->positions,
                               .triangles = (int32_t(*)[3])triangles};
        status = pel_mesh_self_intersections(&mesh, NULL, 0, count, error);
    } else
        status = pel_fail_memory(error);
    PEL_FREE_ALL(links, map, triangles);
    return status;
}

/* ---- writing ---- */

pel_status pel_run_surface_read(pel_run_surface *surface, pel_sim *sim, pel_error *error)
{
    pel_status status = refresh(surface, sim, error);
    if (status != PEL_OK)
        return status;
    surface->time = pel_sim_time(sim);
    read_positions(surface, sim);
    return read_fields(surface, sim, error);
}

bool pel_positions_need_double(const double *positions, int32_t vertex_count)
{
    double low[3], high[3], farthest = 0;
    pel_bounds_clear(low, high);
    for (int32_t v = 0; v < vertex_count; v++)
        pel_bounds_add(low, high, positions + 3 * (size_t)v);
    for (int c = 0; c < 3; c++)
        farthest = pel_max(farthest, pel_max(fabs(low[c]), fabs(high[c])));
    return vertex_count > 0 && 0.5 * (double)FLT_EPSILON * farthest > FLOAT_ERROR * pel_vec3_distance(low, high);
}

/* a body of its own may be small and far away */
static bool needs_double(const pel_run_surface *surface)
{
    bool needs = false;
    for (int32_t b = 0; b < surface->body_count; b++)
        needs |= pel_positions_need_double(surface->positions + 3 * (size_t)surface->begin[b],
                                           surface->begin[b + 1] - surface->begin[b]);
    return needs;
}

pel_status pel_run_surface_write(pel_run_surface *surface, const pel_output_def *output, const char *path,
                                 pel_error *error)
{
    const pel_vtp vtp = {
        .vertex_count = surface->vertex_count,
        .triangle_count = surface->triangle_count,
        .positions = surface->positions,
        .triangles = surface->triangles,
        .fields = surface->fields,
        .field_count = surface->field_count,
        .cell_fields = surface->cell_fields,
        .cell_field_count = surface->cell_field_count,
        .time = surface->time,
        .compress = output->compress,
        .float64 = output->float64 || needs_double(surface),
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
