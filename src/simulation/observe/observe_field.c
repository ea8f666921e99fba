/* Fields of the present state by number. Intermediate results of several fields (positions, measures of the surface,
   mechanics of its triangles) are kept for their state. */
#include "observe/observe_field.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "observe/field.h"
#include "observe/field_mechanics.h"
#include "pellicle/measure.h"
#include "pellicle/sim_contact.h"
#include "pellicle/sim_surface.h"
#include "pellicle/topology.h"
#include "stage/stage.h"
#include "stage/surface_view.h"
#include "tool/support.h"

#include <string.h>

/* one body; arrays are null until a field needs them */
typedef struct view {
    int64_t revision; /* of its surface */
    int32_t vertex_count, triangle_count;
    int32_t *triangles;       /* (triangle_count x 3) */
    double *rest, *positions; /* (vertex_count x 3) */
    double *scratch;          /* (vertex_count x 3) */
    pel_topology *topology;
    pel_vertex_measure *measures;                    /* (vertex_count) */
    pel_triangle_mechanics *numbers;                 /* (triangle_count) */
    pel_field_mechanics *on_triangles, *on_vertices; /* (triangle_count), (vertex_count) */
    int64_t positions_of, measures_of, mechanics_of; /* number of the state */
} view;

struct pel_observer {
    int32_t body_count;
    view *views; /* (body_count) */
};

static void empty(view *v)
{
    pel_topology_destroy(v->topology);
    PEL_FREE_ALL(v->triangles, v->rest, v->positions, v->scratch, v->measures, v->numbers, v->on_triangles,
                 v->on_vertices);
    *v = (view){.revision = -1, .positions_of = -1, .measures_of = -1, .mechanics_of = -1};
}

void pel_observer_destroy(pel_observer *observer)
{
    for (int32_t b = 0; observer != NULL && observer->views != NULL && b < observer->body_count; b++)
        empty(&observer->views[b]);
    if (observer != NULL)
        pel_free(observer->views);
    pel_free(observer);
}

static pel_status make_observer(pel_sim *sim, pel_error *error)
{
    pel_observer *made = pel_allocate(1, sizeof *made);
    if (made != NULL)
        made->views = pel_allocate((size_t)sim->model->body_count, sizeof *made->views);
    if (made == NULL || made->views == NULL) {
        pel_free(made);
        return pel_fail_memory(error);
    }
    made->body_count = sim->model->body_count;
    for (int32_t b = 0; b < made->body_count; b++)
        empty(&made->views[b]);
    sim->observer = made;
    return PEL_OK;
}

/* the view of a body, empty after its surface has changed */
static pel_status look(pel_sim *sim, int32_t field, int32_t body, view **made, pel_error *error)
{
    if (field < 0 || field >= PEL_FIELD_COUNT) {
        pel_fail(error, PEL_BAD_ARGUMENT, "there is no field %d", (int)field);
        pel_fail_remedy(error, "give a number of pel_field_find, 0 to %d", PEL_FIELD_COUNT - 1);
        return PEL_BAD_ARGUMENT;
    }
    if (body < 0 || body >= sim->model->body_count)
        return pel_fail(error, PEL_BAD_ARGUMENT, "body %d does not exist", (int)body);
    pel_status status = sim->observer != NULL ? PEL_OK : make_observer(sim, error);
    if (status != PEL_OK)
        return status;
    view *v = *made = &sim->observer->views[body];
    int64_t revision = pel_sim_surface_revision(sim, body);
    if (v->revision == revision)
        return PEL_OK;
    empty(v);
    v->revision = revision;
    v->vertex_count = pel_sim_vertex_count(sim, body);
    v->triangle_count = pel_sim_triangle_count(sim, body);
    return PEL_OK;
}

/* ---- intermediate results of fields ---- */

/* allocates an array if necessary */
static bool has_room(void *array, int32_t count, size_t size)
{
    void *present;
    memcpy(&present, array, sizeof present);
    if (present != NULL)
        return true;
    present = pel_allocate((size_t)count, size);
    memcpy(array, &present, sizeof present);
    return present != NULL;
}

static bool has_scratch(view *v)
{
    return has_room(&v->scratch, 3 * v->vertex_count, sizeof *v->scratch);
}

static bool has_rest(const pel_sim *sim, int32_t body, view *v)
{
    bool is_known = v->rest != NULL;
    if (!has_room(&v->rest, 3 * v->vertex_count, sizeof *v->rest))
        return false;
    if (!is_known)
        pel_sim_get_rest_positions(sim, body, v->rest);
    return true;
}

static bool has_triangles(const pel_sim *sim, int32_t body, view *v)
{
    bool is_known = v->triangles != NULL;
    if (!has_room(&v->triangles, 3 * v->triangle_count, sizeof *v->triangles))
        return false;
    if (!is_known)
        pel_sim_get_triangles(sim, body, v->triangles);
    return true;
}

static bool has_positions(const pel_sim *sim, int32_t body, view *v)
{
    if (!has_room(&v->positions, 3 * v->vertex_count, sizeof *v->positions))
        return false;
    if (v->positions_of != sim->state_number)
        pel_sim_get_positions(sim, body, v->positions);
    v->positions_of = sim->state_number;
    return true;
}

static pel_status make_topology(const pel_sim *sim, int32_t body, view *v, pel_error *error)
{
    if (v->topology != NULL)
        return PEL_OK;
    if (!has_rest(sim, body, v) || !has_triangles(sim, body, v))
        return pel_fail_memory(error);
    const pel_mesh mesh = {.vertex_count = v->vertex_count,
                           .triangle_count = v->triangle_count,
                           .positions = (double(*)[3])v->rest,
                           .triangles = (int32_t(*)[3])v->triangles};
    return pel_topology_create(&mesh, &v->topology, error);
}

static pel_status measure(const pel_sim *sim, int32_t body, view *v, pel_error *error)
{
    pel_status status = make_topology(sim, body, v, error);
    if (status != PEL_OK || v->measures_of == sim->state_number)
        return status;
    if (!has_positions(sim, body, v) || !has_room(&v->measures, v->vertex_count, sizeof *v->measures))
        return pel_fail_memory(error);
    for (int32_t i = 0; i < v->vertex_count; i++)
        pel_vertex_measure_fill(v->topology, v->positions, i, &v->measures[i]);
    v->measures_of = sim->state_number;
    return PEL_OK;
}

static pel_status find_mechanics(pel_sim *sim, int32_t body, view *v, pel_error *error)
{
    if (v->mechanics_of == sim->state_number)
        return PEL_OK;
    if (!has_rest(sim, body, v) || !has_triangles(sim, body, v) || !has_positions(sim, body, v) ||
        !has_room(&v->numbers, v->triangle_count, sizeof *v->numbers) ||
        !has_room(&v->on_triangles, v->triangle_count, sizeof *v->on_triangles) ||
        !has_room(&v->on_vertices, v->vertex_count, sizeof *v->on_vertices))
        return pel_fail_memory(error);
    pel_sim_get_mechanics(sim, body, v->numbers);
    pel_field_mechanics_of(v->numbers, v->triangles, v->triangle_count, v->rest, v->positions, v->on_triangles);
    pel_field_mechanics_smooth(v->on_triangles, v->triangles, v->triangle_count, v->vertex_count, v->on_vertices);
    v->mechanics_of = sim->state_number;
    return PEL_OK;
}

/* ---- fields ---- */

static pel_status read_displacement(const pel_sim *sim, int32_t body, view *v, double *values, pel_error *error)
{
    if (!has_rest(sim, body, v))
        return pel_fail_memory(error);
    pel_sim_get_positions(sim, body, values);
    for (size_t i = 0; i < 3 * (size_t)v->vertex_count; i++)
        values[i] -= v->rest[i];
    return PEL_OK;
}

/* adds one of three lists of the scratch, or all of them, to values */
static void add_lists(const view *v, int32_t first_field, int32_t field, double *values)
{
    for (int i = 0; i < 3; i++)
        for (int32_t k = 0; (field == PEL_FIELD_ENERGY || field == first_field + i) && k < v->vertex_count; k++)
            values[k] += v->scratch[(size_t)i * (size_t)v->vertex_count + (size_t)k];
}

/* one energy of a body, or the sum of all */
static pel_status read_energies(const pel_sim *sim, int32_t field, int32_t body, view *v, double *values,
                                pel_error *error)
{
    if (!has_scratch(v))
        return pel_fail_memory(error);
    double *first = v->scratch, *second = first + v->vertex_count, *third = second + v->vertex_count;
    memset(values, 0, (size_t)v->vertex_count * sizeof *values);
    if (field <= PEL_FIELD_VOLUMETRIC_ENERGY) {
        pel_sim_get_energies(sim, body, first, second);
        memset(third, 0, (size_t)v->vertex_count * sizeof *third);
        add_lists(v, PEL_FIELD_SPRING_ENERGY, field, values);
    }
    if (field == PEL_FIELD_ENERGY || field >= PEL_FIELD_MEMBRANE_ENERGY) {
        pel_sim_get_shell_energies(sim, body, first, second, third);
        add_lists(v, PEL_FIELD_MEMBRANE_ENERGY, field, values);
    }
    if (field == PEL_FIELD_ENERGY) {
        pel_shell_add_tetra_energies(sim->shells, body, pel_output_numbers(sim, body), sim->state->position, values);
    }
    return PEL_OK;
}

/* the virial over twice the area that it belongs to: thirds of the triangles */
static pel_status read_stress(const pel_sim *sim, int32_t body, view *v, double *values, pel_error *error)
{
    if (!has_scratch(v) || !has_triangles(sim, body, v) || !has_positions(sim, body, v))
        return pel_fail_memory(error);
    double *areas = v->scratch;
    const double *x = v->positions;
    memset(areas, 0, (size_t)v->vertex_count * sizeof *areas);
    for (int32_t t = 0; t < v->triangle_count; t++) {
        const int32_t *corner = v->triangles + 3 * (size_t)t;
        double area =
            pel_vec3_triangle_area(x + 3 * (size_t)corner[0], x + 3 * (size_t)corner[1], x + 3 * (size_t)corner[2]);
        for (int k = 0; k < 3; k++)
            areas[corner[k]] += area / 3;
    }
    pel_sim_get_spring_virials(sim, body, values);
    for (int32_t k = 0; k < v->vertex_count; k++)
        values[k] = areas[k] > 0 ? values[k] / (2 * areas[k]) : 0;
    return PEL_OK;
}

/* a triangle has the level of its finest corner: midpoints of edges appear with the triangles that share them */
static pel_status read_levels(const pel_sim *sim, int32_t body, view *v, double *values, pel_error *error)
{
    if (!has_scratch(v) || !has_triangles(sim, body, v))
        return pel_fail_memory(error);
    int32_t *levels = (int32_t *)(void *)v->scratch;
    pel_sim_get_levels(sim, body, levels);
    memset(values, 0, (size_t)v->vertex_count * sizeof *values);
    for (int32_t t = 0; t < v->triangle_count; t++) {
        const int32_t *corner = v->triangles + 3 * (size_t)t;
        int32_t level = 0;
        for (int k = 0; k < 3; k++)
            level = levels[corner[k]] > level ? levels[corner[k]] : level;
        for (int k = 0; k < 3; k++)
            values[corner[k]] = values[corner[k]] < level ? level : values[corner[k]];
    }
    return PEL_OK;
}

static pel_status read_measures(const pel_sim *sim, int32_t field, int32_t body, view *v, double *values,
                                pel_error *error)
{
    pel_status status = measure(sim, body, v, error);
    for (int32_t i = 0; status == PEL_OK && i < v->vertex_count; i++) {
        const pel_vertex_measure *at = &v->measures[i];
        if (field == PEL_FIELD_AREA)
            values[i] = at->area;
        else if (field == PEL_FIELD_NORMAL)
            memcpy(values + 3 * (size_t)i, at->normal, sizeof at->normal);
        else
            values[i] = field == PEL_FIELD_MEAN_CURVATURE ? at->mean_curvature : at->gaussian_curvature;
    }
    return status;
}

static void put_mechanics(const pel_field_mechanics *at, int32_t count, int32_t field, double *values)
{
    size_t components = (size_t)pel_field_at(field)->component_count;
    for (size_t i = 0; i < (size_t)count; i++)
        pel_field_mechanics_put(&at[i], field, values + i * components);
}

pel_status pel_observe(pel_sim *sim, int32_t field, int32_t body, double *values, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(values, error);
    view *v;
    pel_status status = look(sim, field, body, &v, error);
    if (status != PEL_OK)
        return status;
    if (pel_field_is_measure(field))
        return read_measures(sim, field, body, v, values, error);
    if (pel_field_is_mechanics(field)) {
        status = find_mechanics(sim, body, v, error);
        if (status == PEL_OK)
            put_mechanics(v->on_vertices, v->vertex_count, field, values);
        return status;
    }
    switch ((pel_field_kind)field) {
    case PEL_FIELD_DISPLACEMENT:
        return read_displacement(sim, body, v, values, error);
    case PEL_FIELD_VELOCITY:
        pel_sim_get_velocities(sim, body, values);
        break;
    case PEL_FIELD_FORCE:
        pel_sim_get_forces(sim, body, values);
        break;
    case PEL_FIELD_CONTACT:
        pel_sim_get_contacts(sim, body, values);
        break;
    case PEL_FIELD_CONTACT_FORCE:
        pel_sim_get_contact_forces(sim, body, values);
        break;
    case PEL_FIELD_REACTION:
        pel_supports_get_reactions(sim, body, values);
        break;
    case PEL_FIELD_PRESSURE:
        pel_sim_get_pressure_forces(sim, body, values);
        break;
    case PEL_FIELD_LEVEL:
        return read_levels(sim, body, v, values, error);
    case PEL_FIELD_STRESS:
        return read_stress(sim, body, v, values, error);
    default:
        return read_energies(sim, field, body, v, values, error);
    }
    return PEL_OK;
}

pel_status pel_observe_triangles(pel_sim *sim, int32_t field, int32_t body, double *values, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(values, error);
    view *v;
    pel_status status = look(sim, field, body, &v, error);
    if (status == PEL_OK && !pel_field_is_mechanics(field))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "look at it with pel_observe", "the field '%s' is on vertices alone",
                          pel_field_at(field)->name);
    if (status == PEL_OK)
        status = find_mechanics(sim, body, v, error);
    if (status == PEL_OK)
        put_mechanics(v->on_triangles, v->triangle_count, field, values);
    return status;
}
