/* Building the model: checks of the defs, then masses, springs and triangles in the model's vertex order. */
#include "model/model.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/vec3.h"
#include "mesh/allocate.h"
#include "mesh/figures.h"
#include "model/levels.h"
#include "model/orient.h"
#include "model/origin.h"
#include "model/quantity.h"
#include "model/rigid_body.h"
#include "model/shell.h"
#include "model/vertex_order.h"
#include "pellicle/measure.h"
#include "pellicle/topology.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* a closed surface that encloses less than this share of area^1.5 is flat; a ball has 0.094 */
#define LEAST_VOLUME 1e-6
enum { BODY_COOKIE = 0x626f6479, MODEL_COOKIE = 0x6d6f6465 };

pel_body_def pel_body_def_default(void)
{
    pel_body_def def = {.refine = {.memory_limit = (size_t)2 << 30}, .cookie = BODY_COOKIE};
    pel_def_reset(PEL_DEF_BODY, &def);
    return def;
}

pel_body_def pel_body_def_sheet(const char *name, const pel_mesh *mesh, double young, double thickness, double density)
{
    pel_body_def def = pel_body_def_default();
    def.name = name;
    def.mesh = mesh;
    def.mass_kind = PEL_MASS_DENSITY;
    def.mass = density;
    def.spring_stiffness.value = def.spring_damping.value = 0;
    def.volumetric_stiffness.value = def.volumetric_damping.value = 0;
    def.shell.membrane.on = true;
    def.shell.membrane.young.value = young;
    def.thickness.value = def.shell.membrane.thickness.value = thickness;
    return def;
}

pel_model_def pel_model_def_default(void)
{
    return (pel_model_def){.cookie = MODEL_COOKIE};
}

/* ---- checks ---- */

static pel_status check_name(const pel_model_def *def, int32_t body, pel_error *error)
{
    const char *name = def->bodies[body].name;
    if (name == NULL || name[0] == '\0' || strlen(name) >= PEL_NAME_SIZE) {
        pel_fail(error, PEL_BAD_ARGUMENT, "body has no name or one longer than %d characters", PEL_NAME_SIZE - 1);
        pel_fail_element(error, "body", body);
        return PEL_BAD_ARGUMENT;
    }
    for (int32_t other = 0; other < body; other++)
        if (strcmp(def->bodies[other].name, name) == 0)
            return pel_refuse(error, PEL_BAD_ARGUMENT, "give each body a name of its own", "two bodies are named '%s'",
                              name);
    return PEL_OK;
}

static pel_status check_amounts(const pel_body_def *b, int32_t body, pel_error *error)
{
    if (!(b->fluid_density >= 0 && isfinite(b->fluid_density)))
        return pel_body_refuse(error, body, "fluid_density", b->fluid_density, "give a density, or 0 for no liquid");
    if (isnan(b->fluid_level) || b->fluid_level == -HUGE_VAL)
        return pel_body_refuse(error, body, "fluid_level", b->fluid_level, "give a height, or HUGE_VAL");
    if (!(b->spring_retardation >= 0 && isfinite(b->spring_retardation)))
        return pel_body_refuse(error, body, "spring_retardation", b->spring_retardation, "give a time in s, or 0");
    if (!(b->spring_thickness >= 0 && isfinite(b->spring_thickness)))
        return pel_body_refuse(error, body, "spring_thickness", b->spring_thickness, "give a number of metres, or 0");
    if (!(b->volumetric_depth >= 0 && isfinite(b->volumetric_depth)))
        return pel_body_refuse(error, body, "volumetric_depth", b->volumetric_depth, "give a number of metres, or 0");
    return pel_rigid_body_check(b, body, error);
}

static pel_status check_spring_toughness(const pel_body_def *b, int32_t body, pel_error *error)
{
    pel_status status = pel_toughness_check(&b->spring_toughness, b, body, error);
    if (status == PEL_OK)
        status = pel_strength_check(&b->spring_strength, &b->spring_toughness, b, body, error);
    if (status == PEL_OK && (b->spring_toughness.value > 0 || b->spring_toughness.field != NULL) &&
        !(b->spring_thickness > 0))
        status =
            pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, "give springs by Young's modulus and thickness",
                               "springs with a toughness have no thickness");
    return status;
}

static pel_status check_adhesion(const pel_body_def *b, int32_t body, pel_error *error)
{
    bool has_springs = b->volumetric_stiffness.value > 0 || b->volumetric_stiffness.field != NULL;
    if (!(b->adhesion >= 0 && isfinite(b->adhesion)))
        return pel_body_refuse(error, body, "adhesion", b->adhesion, "give a number of pascals above 0, or 0 for ever");
    if (b->adhesion > 0 && !has_springs)
        return pel_body_refuse(error, body, "adhesion", b->adhesion,
                               "give volumetric springs a stiffness above 0, or leave the adhesion out");
    if (b->adhesion > 0 && b->refine.levels > 0)
        return pel_body_refuse(error, body, "adhesion", b->adhesion,
                               "leave the adhesion out, or subdivide the mesh instead of `refine`");
    if (b->released_count < 0 || (b->released_count > 0 && b->released == NULL))
        return pel_body_refuse(error, body, "released_count", b->released_count, "give the released vertices with it");
    for (int32_t r = 0; r < b->released_count; r++)
        if (b->released[r] < 0 || b->released[r] >= b->mesh->vertex_count)
            return pel_body_refuse(error, body, "released vertex", b->released[r],
                                   "give vertex numbers of the body's mesh");
    return PEL_OK;
}

static pel_status check_meshes(const pel_body_def *b, int32_t body, pel_error *error)
{
    if (b->mesh == NULL)
        return pel_body_refuse(error, body, "mesh", 0, "give each body a mesh");
    if (b->rest == NULL)
        return PEL_OK;
    size_t size = (size_t)b->mesh->triangle_count * sizeof *b->mesh->triangles;
    if (b->rest->vertex_count != b->mesh->vertex_count || b->rest->triangle_count != b->mesh->triangle_count ||
        memcmp(b->rest->triangles, b->mesh->triangles, size) != 0)
        return pel_body_refuse(error, body, "triangles of the rest shape", b->rest->triangle_count,
                               "give it the vertices and triangles of the mesh, in their order");
    if (b->refine.levels > 0 || b->volume.on || b->rigid.on || b->origins != NULL)
        return pel_body_refuse(error, body, "rest", 0, "leave it out: the body refines, is rigid, filled or cut");
    return PEL_OK;
}

static pel_status check_body(const pel_model_def *def, int32_t body, pel_error *error)
{
    const pel_body_def *b = &def->bodies[body];
    if (b->cookie != BODY_COOKIE)
        return pel_body_refuse(error, body, "cookie", b->cookie, "start from pel_body_def_default()");
    pel_status status = check_name(def, body, error);
    if (status == PEL_OK)
        status = check_meshes(b, body, error);
    if (status != PEL_OK)
        return status;
    if (PEL_IS_NO_CHOICE(b->mass_kind, PEL_MASS_DENSITY + 1))
        return pel_body_refuse(error, body, "mass_kind", (double)b->mass_kind, "give one of pel_mass_kind");
    if (b->pinned_count < 0 || (b->pinned_count > 0 && b->pinned == NULL))
        return pel_body_refuse(error, body, "pinned_count", b->pinned_count, "give the pinned vertices with it");
    if (!(b->mass > 0 && isfinite(b->mass)))
        return pel_body_refuse(error, body, "mass", b->mass, "give a finite mass above 0");
    for (int k = 0; k < 3; k++)
        if (!isfinite(b->velocity[k]) || !isfinite(b->angular_velocity[k]))
            return pel_body_refuse(error, body, isfinite(b->velocity[k]) ? "angular_velocity" : "velocity",
                                   isfinite(b->velocity[k]) ? b->angular_velocity[k] : b->velocity[k],
                                   "give three finite numbers");
    if (!isfinite(b->friction))
        return pel_body_refuse(error, body, "friction", b->friction, "give a finite coefficient");
    if (!isfinite(b->contact_thickness))
        return pel_body_refuse(error, body, "contact_thickness", b->contact_thickness,
                               "give a number of metres above 0");
    if (!isfinite(b->restitution))
        return pel_body_refuse(error, body, "restitution", b->restitution, "give a number from 0 to 1");
    status = check_amounts(b, body, error);
    if (status != PEL_OK)
        return status;
    if (b->reference_count < 1)
        return pel_body_refuse(error, body, "reference_count", b->reference_count, "give at least 1");
    const struct {
        const char *name;
        const pel_quantity *quantity;
        bool keys;
    } quantities[] = {
        {"thickness", &b->thickness, false},
        {"spring stiffness", &b->spring_stiffness, true},
        {"spring damping", &b->spring_damping, true},
        {"volumetric stiffness", &b->volumetric_stiffness, true},
        {"volumetric damping", &b->volumetric_damping, true},
    };
    for (size_t q = 0; status == PEL_OK && q < sizeof quantities / sizeof *quantities; q++)
        status = pel_quantity_check(quantities[q].quantity, b->mesh->vertex_count, body, quantities[q].name,
                                    quantities[q].keys, error);
    for (int32_t p = 0; status == PEL_OK && p < b->pinned_count; p++)
        if (b->pinned[p] < 0 || b->pinned[p] >= b->mesh->vertex_count)
            status =
                pel_body_refuse(error, body, "pinned vertex", b->pinned[p], "give vertex numbers of the body's mesh");
    if (status == PEL_OK)
        status = pel_origins_check(b, body, error);
    if (status == PEL_OK)
        status = check_adhesion(b, body, error);
    if (status == PEL_OK)
        status = pel_refine_check(&b->refine, body, b->mesh->vertex_count, error);
    if (status == PEL_OK)
        status = pel_shell_check(b, body, error);
    if (status == PEL_OK)
        status = pel_filled_check(b, body, error);
    return status == PEL_OK ? check_spring_toughness(b, body, error) : status;
}

static pel_status check_def(const pel_model_def *def, pel_error *error)
{
    if (def->cookie != MODEL_COOKIE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "model def was not made by pel_model_def_default()");
    if (def->body_count < 1 || def->bodies == NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "model has no body: bodies is null or body_count below 1");
    int64_t vertex_count = 0, triangle_count = 0;
    for (int32_t b = 0; b < def->body_count; b++) {
        pel_status status = check_body(def, b, error);
        if (status != PEL_OK)
            return status;
        vertex_count += def->bodies[b].mesh->vertex_count + PEL_WIDTH;
        triangle_count += def->bodies[b].mesh->triangle_count;
    }
    if (vertex_count > INT32_MAX / 16 || triangle_count > INT32_MAX / 16)
        return pel_fail(error, PEL_BAD_ARGUMENT, "model has %lld vertices; at most %d are possible",
                        (long long)vertex_count, INT32_MAX / 16);
    for (int i = 0; i < 3; i++)
        if (!isfinite(def->gravity[i]))
            return pel_fail(error, PEL_BAD_ARGUMENT, "gravity is not finite");
    return PEL_OK;
}

/* ---- geometry of a body ---- */

/* a third of the area of the triangles around each vertex; returns the whole area, fails on a triangle without any */
static pel_status lump_areas(const pel_mesh *mesh, double *areas, double *total, pel_error *error)
{
    *total = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        double area = pel_vec3_triangle_area(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]]);
        if (!(area > 0 && isfinite(area)))
            return pel_refuse_area(mesh, t, error);
        *total += area;
        for (int i = 0; i < 3; i++)
            areas[v[i]] += area / 3;
    }
    return PEL_OK;
}

/* about the first vertex */
static void measure_volume(pel_body *body)
{
    const pel_mesh *mesh = body->mesh;
    double flat = LEAST_VOLUME * body->rest_area * sqrt(body->rest_area);
    body->rest_volume =
        pel_surface_volume(mesh->positions[0], mesh->triangles[0], mesh->triangle_count, mesh->positions[0]);
    body->has_volume = body->closed && fabs(body->rest_volume) > flat;
}

/* ---- arrays ---- */

bool pel_model_allocate(pel_model *model)
{
    size_t count = (size_t)model->vertex_count, slices = (size_t)model->slice_count;
    return PEL_ALLOCATE_ALL(PEL_ROOM_ALIGNED(model->rest, count), PEL_ROOM_ALIGNED(model->inverse_mass, count),
                            PEL_ROOM_ALIGNED(model->mass, count), PEL_ROOM_ALIGNED(model->damping, count),
                            PEL_ROOM_ALIGNED(model->volumetric_damping, count), PEL_ROOM(model->body_of_slice, slices),
                            PEL_ROOM(model->mesh_vertex, count), PEL_ROOM(model->slot_begin, slices + 1),
                            PEL_ROOM(model->slot_end, slices), PEL_ROOM(model->triangles, model->triangle_count),
                            PEL_ROOM(model->triangle_begin, (size_t)model->body_count + 1),
                            PEL_ROOM(model->fan_begin, count + 2));
}

bool pel_model_allocate_slots(pel_model *model, pel_spring_room room, int32_t fan_count)
{
    bool with_lengths = room != PEL_SPRINGS_OFF, with_stiffness = room == PEL_SPRINGS_OWN;
    int32_t count = model->slot_begin[model->slice_count];
    return PEL_ALLOCATE_ALL(
        PEL_ROOM_ALIGNED(model->neighbours, count), PEL_ROOM_ALIGNED_IF(with_lengths, model->rest_lengths, count),
        PEL_ROOM_ALIGNED_IF(with_stiffness, model->stiffnesses, count),
        PEL_ROOM_ALIGNED_IF(with_stiffness, model->products, count), PEL_ROOM(model->fans, fan_count));
}

void pel_model_free_arrays(pel_model *model)
{
    PEL_FREE_ALL(model->rest, model->inverse_mass, model->mass, model->damping, model->volumetric_damping,
                 model->body_of_slice, model->mesh_vertex, model->slot_begin, model->slot_end, model->neighbours,
                 model->rest_lengths, model->plain_slices, model->stiffnesses, model->products, model->triangles,
                 model->triangle_begin, model->fan_begin, model->fans);
}

/* kg, of a vertex without a filling; areas: volumes, of a body of tetrahedra */
static double mass_of(const pel_body_def *def, const pel_body *body, const double *areas, int32_t v)
{
    PEL_ASSERT_INDEX(v, def->mesh->vertex_count);
    if (def->volume.on && def->mass_kind != PEL_MASS_PER_VERTEX)
        return def->mass * (def->mass_kind == PEL_MASS_TOTAL ? areas[v] / body->rest_volume : areas[v]);
    if (body->rigid != NULL)
        return areas[v];
    if (def->mass_kind == PEL_MASS_TOTAL)
        return def->mass * (areas[v] / body->rest_area);
    if (def->mass_kind == PEL_MASS_DENSITY)
        return def->mass * (pel_quantity_at(&def->thickness, v) * areas[v]);
    return pel_vertex_share(body, v) * def->mass;
}

/* a liquid that fills a body is a share of its masses */
static pel_status find_filling(const pel_body_def *def, pel_body *body, const double *areas, pel_error *error)
{
    double own = 0, filling = def->fluid_density * fabs(body->rest_volume);
    body->fluid_share = 0;
    if (!(def->fluid_density > 0) || isfinite(def->fluid_level))
        return PEL_OK;
    if (!body->has_volume)
        return pel_refuse(error, PEL_BAD_ARGUMENT,
                          "give fluid.level, the height of its surface, or a mesh without borders",
                          "a liquid cannot fill an open body");
    for (int32_t v = 0; v < def->mesh->vertex_count; v++)
        own += mass_of(def, body, areas, v);
    body->fluid_share = filling / (own + filling);
    return PEL_OK;
}

/* masses, damping and volumetric springs of one body's vertices; padding repeats the first vertex without mass */
static void fill_vertices(pel_model *model, const pel_body_def *def, const pel_body *body, const int32_t *order,
                          const double *areas)
{
    int32_t first = body->slice_begin * PEL_WIDTH, last = body->slice_end * PEL_WIDTH;
    double mean_area = body->rest_area / def->reference_count, depth = def->volumetric_depth;
    double filled = 1 / (1 - body->fluid_share);
    for (int32_t i = first; i < last; i++) {
        bool padding = i - first >= def->mesh->vertex_count;
        int32_t v = order[padding ? 0 : i - first];
        const double *x = def->mesh->positions[v];
        double part = pel_vertex_share(body, v), share = def->volumetric_by_area ? areas[v] / mean_area : part;
        double volumetric_share = depth > 0 ? areas[v] / depth : share;
        double volumetric = padding ? 0 : volumetric_share * pel_quantity_at(&def->volumetric_stiffness, v);
        model->rest[i] = (pel_record){(pel_real)x[0], (pel_real)x[1], (pel_real)x[2], (pel_real)volumetric};
        model->mesh_vertex[i] = padding ? -1 : v;
        if (padding)
            continue;
        body->model_index[v] = i;
        double mass = mass_of(def, body, areas, v) * filled;
        model->mass[i] = (pel_real)mass;
        model->inverse_mass[i] = (pel_real)(1 / mass);
        double spring_share = def->spring_thickness > 0 ? mass : share, filling_share = depth > 0 ? mass : share;
        model->damping[i] = (pel_real)(spring_share * pel_quantity_at(&def->spring_damping, v));
        model->volumetric_damping[i] = (pel_real)(filling_share * pel_quantity_at(&def->volumetric_damping, v));
    }
    if (body->rigid != NULL && body->rigid->radius > 0) {
        const double *x = body->rigid->middle;
        int32_t middle = first + def->mesh->vertex_count;
        model->rest[middle] = (pel_record){(pel_real)x[0], (pel_real)x[1], (pel_real)x[2], 0};
        model->inverse_mass[middle] = (pel_real)(1 / body->rigid->mass);
    }
    for (int32_t p = 0; p < def->pinned_count; p++)
        model->inverse_mass[body->model_index[def->pinned[p]]] = 0;
    for (int32_t r = 0; r < def->released_count; r++) {
        int32_t place = body->model_index[def->released[r]];
        model->rest[place][3] = model->volumetric_damping[place] = 0;
    }
}

/* slots of each slice = largest valence in it; one where the middle of a ball is alone */
static void count_slots(pel_model *model, const pel_body *body, const int32_t *valence)
{
    for (int32_t s = body->slice_begin; s < body->slice_end; s++) {
        int32_t most = 1;
        for (int32_t i = s * PEL_WIDTH; i < (s + 1) * PEL_WIDTH; i++)
            if (model->mesh_vertex[i] >= 0 && valence[model->mesh_vertex[i]] > most)
                most = valence[model->mesh_vertex[i]];
        model->slot_begin[s + 1] = model->slot_end[s] = model->slot_begin[s] + most;
    }
}

static double area_beside(const pel_mesh *mesh, int32_t half_edge)
{
    return half_edge < 0 ? 0 : pel_surface_area(mesh->positions[0], mesh->triangles[half_edge / 3], 1);
}

double pel_model_rest_stiffness(const pel_body_def *def, const pel_topology *topology, int32_t edge)
{
    int32_t h = topology->half_edge_of_edge[edge];
    int32_t a = pel_half_edge_origin(topology, h), b = pel_half_edge_target(topology, h);
    double d[3],
        given = 0.5 * (pel_quantity_at(&def->spring_stiffness, a) + pel_quantity_at(&def->spring_stiffness, b));
    if (!(def->spring_thickness > 0))
        return given;
    pel_vec3_subtract(def->mesh->positions[b], def->mesh->positions[a], d);
    double area = area_beside(def->mesh, h) + area_beside(def->mesh, topology->twin[h]);
    return given * def->spring_thickness * area / pel_vec3_squared_length(d);
}

static void add_spring(pel_model *model, int32_t i, int32_t j, int32_t *filled, double stiffness)
{
    pel_model_set_spring(model, model->slot_begin[i / PEL_WIDTH] + filled[i]++, i, j, stiffness);
}

/* both ends of every edge; lanes that stay empty point to their own vertex */
static void fill_springs(pel_model *model, const pel_body_def *def, const pel_body *body, const pel_topology *topology,
                         int32_t *filled)
{
    for (int32_t s = body->slice_begin; s < body->slice_end; s++)
        for (int32_t slot = model->slot_begin[s]; slot < model->slot_begin[s + 1]; slot++)
            for (int32_t i = s * PEL_WIDTH; i < (s + 1) * PEL_WIDTH; i++)
                pel_model_set_spring(model, slot, i, i, 0);
    for (int32_t e = 0; e < topology->edge_count; e++) {
        int32_t h = topology->half_edge_of_edge[e];
        int32_t a = pel_half_edge_origin(topology, h), b = pel_half_edge_target(topology, h);
        double stiffness = pel_model_rest_stiffness(def, topology, e);
        /* that of a sheet is by the area beside the lip already */
        if (!(def->spring_thickness > 0))
            stiffness *= pel_lip_share(body, h);
        int32_t i = body->model_index[a], j = body->model_index[b];
        add_spring(model, i, j, filled, stiffness);
        add_spring(model, j, i, filled, stiffness);
    }
}

static void fill_triangles(pel_model *model, int32_t body)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_body *b = &model->bodies[body];
    int32_t first = model->triangle_begin[body];
    model->triangle_begin[body + 1] = first + b->mesh->triangle_count;
    for (int32_t t = 0; t < b->mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            model->triangles[first + t][i] = b->model_index[b->mesh->triangles[t][i]];
}

static void fill_fans(pel_model *model)
{
    int32_t *begin = model->fan_begin;
    for (int32_t t = 0; t < model->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            begin[model->triangles[t][i] + 2]++;
    for (int32_t i = 0; i <= model->vertex_count; i++)
        begin[i + 1] += begin[i];
    for (int32_t t = 0; t < model->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            model->fans[begin[model->triangles[t][i] + 1]++] = t;
}

/* ---- a body ---- */

/* with positions that the state can hold: a body at rest is free of stress in float as well */
static pel_status copy_mesh(const pel_mesh *mesh, pel_mesh **copy, pel_error *error)
{
    pel_status status =
        pel_mesh_create(mesh->positions[0], mesh->vertex_count, mesh->triangles[0], mesh->triangle_count, copy, error);
    for (int32_t f = 0; status == PEL_OK && f < mesh->field_count; f++) {
        const pel_field *field = &mesh->fields[f];
        status = pel_mesh_add_field(*copy, field->name, field->component_count, field->values, error);
    }
    if (status == PEL_OK)
        status = pel_mesh_copy_tetrahedra(mesh, *copy, error);
    for (int32_t v = 0; status == PEL_OK && v < mesh->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            (*copy)->positions[v][k] = (double)(pel_real)mesh->positions[v][k];
    return status;
}

static pel_status copy_curves(const pel_body_def *def, pel_body *body, pel_error *error)
{
    const pel_quantity *quantities[PEL_PARAMETER_COUNT] = {
        [PEL_SPRING_STIFFNESS] = &def->spring_stiffness,
        [PEL_SPRING_DAMPING] = &def->spring_damping,
        [PEL_VOLUMETRIC_STIFFNESS] = &def->volumetric_stiffness,
        [PEL_VOLUMETRIC_DAMPING] = &def->volumetric_damping,
    };
    pel_status status = PEL_OK;
    for (int p = 0; status == PEL_OK && p < PEL_PARAMETER_COUNT; p++)
        status = pel_curve_copy(quantities[p], &body->curves[p], error);
    return status;
}

/* scratch of building one body */
typedef struct build {
    pel_body_def def; /* as given, with the model's own mesh */
    pel_topology *topology;
    int32_t *order, *valence;
    double *areas;
} build;

static void build_end(build *scratch)
{
    pel_topology_destroy(scratch->topology);
    PEL_FREE_ALL(scratch->order, scratch->valence, scratch->areas);
    *scratch = (struct build){0};
}

/* the mesh of the body takes the shape at rest */
static pel_status take_rest(const pel_mesh *rest, pel_body *body, pel_error *error)
{
    body->start = pel_allocate((size_t)rest->vertex_count, sizeof *body->start);
    for (int32_t v = 0; body->start != NULL && v < rest->vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            body->start[v][k] = body->mesh->positions[v][k];
            body->mesh->positions[v][k] = (double)(pel_real)rest->positions[v][k];
        }
    return body->start != NULL ? PEL_OK : pel_fail_memory(error);
}

/* the mesh of a body at rest, with inside-out parts turned, and its topology */
static pel_status begin_surface(const pel_body_def *given, pel_body *body, build *scratch, pel_error *error)
{
    pel_status status = copy_mesh(given->mesh, &body->mesh, error);
    if (status == PEL_OK && given->rest != NULL)
        status = take_rest(given->rest, body, error);
    scratch->def = *given;
    scratch->def.mesh = body->mesh;
    pel_rigid_body_stiffen(&scratch->def);
    if (status == PEL_OK)
        status = pel_topology_create(body->mesh, &scratch->topology, error);
    if (status == PEL_OK)
        status = pel_orient_outward(body->mesh, scratch->topology, &body->turned_count, error);
    if (status != PEL_OK || body->turned_count == 0)
        return status;
    pel_topology_destroy(scratch->topology);
    scratch->topology = NULL;
    return pel_topology_create(body->mesh, &scratch->topology, error);
}

/* all springs of a body have one stiffness */
static bool same_everywhere(const pel_body_def *def)
{
    const pel_quantity *k = &def->spring_stiffness;
    bool is_whole = def->origins == NULL || pel_quantity_at(k, 0) == 0;
    return is_whole && k->field == NULL && !(def->spring_thickness > 0 && pel_quantity_at(k, 0) > 0);
}

static void copy_numbers(const pel_body_def *def, pel_body *body)
{
    const pel_quantity *k = &def->spring_stiffness, *volumetric = &def->volumetric_stiffness;
    body->has_volumetric = volumetric->field != NULL || volumetric->key_count > 0 || volumetric->value > 0;
    body->is_foundation = body->has_volumetric && def->volumetric_depth > 0;
    body->spring_retardation = def->spring_retardation;
    body->fluid_density = def->fluid_density;
    body->fluid_level = def->fluid_level;
    body->uniform_spring = body->plain_spring = same_everywhere(def) ? pel_quantity_at(k, 0) : -1;
    memcpy(body->velocity, def->velocity, sizeof body->velocity);
    memcpy(body->angular_velocity, def->angular_velocity, sizeof body->angular_velocity);
    body->friction = def->friction;
    body->restitution = def->restitution;
    body->contact_thickness = def->contact_thickness;
}

static pel_status find_shares(const pel_body_def *def, const build *scratch, pel_body *body, pel_error *error)
{
    return PEL_ALLOCATE_ALL(PEL_ROOM(body->shares, def->mesh->vertex_count),
                            PEL_ROOM(body->lip_shares, 3 * (size_t)def->mesh->triangle_count))
               ? pel_origins_find_shares(def, scratch->topology, scratch->areas, body->shares, body->lip_shares, error)
               : pel_fail_memory(error);
}

/* first pass: everything about a body that does not need the model's arrays */
static pel_status begin_body(const pel_body_def *given, pel_body *body, build *scratch, pel_error *error)
{
    const pel_body_def *def = &scratch->def;
    size_t vertex_count = (size_t)given->mesh->vertex_count;
    snprintf(body->name, sizeof body->name, "%s", given->name);
    pel_status status = begin_surface(given, body, scratch, error);
    if (status == PEL_OK)
        status = copy_curves(def, body, error);
    if (status != PEL_OK)
        return status;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(body->model_index, vertex_count), PEL_ROOM(scratch->order, vertex_count),
                          PEL_ROOM(scratch->valence, vertex_count), PEL_ROOM(scratch->areas, vertex_count)))
        return pel_fail_memory(error);
    status = lump_areas(def->mesh, scratch->areas, &body->rest_area, error);
    if (status == PEL_OK)
        status = pel_vertex_order_vertices(scratch->topology, def->volume.on ? def->mesh : NULL, scratch->order,
                                           scratch->valence, error);
    for (size_t v = 0; status == PEL_OK && v < vertex_count; v++)
        if (def->volume.on && scratch->valence[v] == 0)
            scratch->valence[v] = 1; /* every slice has a slot */
        else if (scratch->valence[v] == 0)
            return pel_refuse_element(error, PEL_BAD_MESH, "vertex", (int64_t)v,
                                      "repair the mesh with `pellicle check --fix`", "vertex belongs to no triangle");
    if (status == PEL_OK && def->origins != NULL)
        status = find_shares(def, scratch, body, error);
    copy_numbers(def, body);
    body->diameter = pel_mesh_diagonal(def->mesh);
    body->closed = scratch->topology->boundary_edge_count == 0;
    if (status == PEL_OK)
        measure_volume(body);
    if (status == PEL_OK && def->rigid.on)
        return pel_rigid_body_create(def, body->has_volume ? body->rest_volume : 0, scratch->areas, &body->rigid,
                                     error);
    return status == PEL_OK && def->volume.on ? pel_filled_lump(def->mesh, scratch->areas, error) : status;
}

static pel_status check_masses(const pel_model *model, int32_t body, pel_error *error)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_body *b = &model->bodies[body];
    for (int32_t v = 0; v < b->mesh->vertex_count; v++) {
        pel_real mass = model->mass[b->model_index[v]];
        if (mass > 0 && isfinite(mass) && isfinite(1 / mass))
            continue;
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "vertex", v, "give a density and thickness above 0",
                                  "mass of the vertex is %g in body '%s'", (double)mass, b->name);
    }
    return PEL_OK;
}

/* adds the body to an error: as its element, or before the text if that names a vertex or triangle */
static pel_status name_body(pel_status status, const char *name, int32_t body, pel_error *error)
{
    char what[sizeof error->what];
    if (error == NULL || status == PEL_OK || status == PEL_OUT_OF_MEMORY || strcmp(error->element_kind, "body") == 0)
        return status;
    if (error->element < 0) {
        pel_fail_element(error, "body", body);
        return status;
    }
    memcpy(what, error->what, sizeof what);
    snprintf(error->what, sizeof error->what, "body '%s': %.*s", name, (int)(sizeof what - PEL_NAME_SIZE - 10), what);
    return status;
}

static pel_spring_room needed_springs(const pel_model *model)
{
    pel_spring_room springs = PEL_SPRINGS_OFF;
    for (int32_t b = 0; b < model->body_count; b++) {
        double uniform = model->bodies[b].uniform_spring;
        if (uniform < 0)
            springs = PEL_SPRINGS_OWN;
        else if (uniform > 0 && springs == PEL_SPRINGS_OFF)
            springs = PEL_SPRINGS_UNIFORM;
    }
    return springs;
}

static pel_status build_bodies(pel_model *model, const pel_model_def *def, build *builds, pel_error *error)
{
    for (int32_t b = 0; b < model->body_count; b++) {
        pel_body *body = &model->bodies[b];
        pel_status status = begin_body(&def->bodies[b], body, &builds[b], error);
        if (status != PEL_OK)
            return name_body(status, def->bodies[b].name, b, error);
        body->slice_begin = model->slice_count;
        /* a ball has a place for its middle */
        bool is_ball = body->rigid != NULL && body->rigid->radius > 0;
        model->slice_count += (body->mesh->vertex_count + is_ball + PEL_WIDTH - 1) / PEL_WIDTH;
        body->slice_end = model->slice_count;
        model->triangle_count += body->mesh->triangle_count;
    }
    model->vertex_count = model->slice_count * PEL_WIDTH;
    if (!pel_model_allocate(model))
        return pel_fail_memory(error);
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b];
        pel_status status = find_filling(&builds[b].def, &model->bodies[b], builds[b].areas, error);
        if (status != PEL_OK)
            return name_body(status, body->name, b, error);
        fill_vertices(model, &builds[b].def, body, builds[b].order, builds[b].areas);
        count_slots(model, body, builds[b].valence);
        for (int32_t s = body->slice_begin; s < body->slice_end; s++)
            model->body_of_slice[s] = b;
        status = check_masses(model, b, error);
        if (status != PEL_OK)
            return name_body(status, body->name, b, error);
        fill_triangles(model, b);
    }
    int32_t *filled = pel_allocate((size_t)model->vertex_count, sizeof *filled);
    bool room = filled != NULL && pel_model_allocate_slots(model, needed_springs(model), 3 * model->triangle_count);
    for (int32_t b = 0; room && b < model->body_count; b++)
        fill_springs(model, &builds[b].def, &model->bodies[b], builds[b].topology, filled);
    pel_free(filled);
    if (!room)
        return pel_fail_memory(error);
    fill_fans(model);
    for (int32_t b = 0; b < model->body_count; b++) {
        pel_status status = pel_body_detail_create(&builds[b].def, model, b, error);
        if (status == PEL_OK)
            status = pel_body_shell_create(&builds[b].def, model, b, builds[b].topology, error);
        if (status != PEL_OK)
            return name_body(status, model->bodies[b].name, b, error);
    }
    return PEL_OK;
}

/* keeps the def of the model, to create one with other numbers */
static pel_status keep_def(pel_model *model, const pel_model_def *def, pel_error *error)
{
    model->def = *def;
    pel_status status = pel_def_copy(&model->copies, PEL_DEF_MODEL, &model->def, error);
    /* the bodies are a copy of this model: it may write to them */
    pel_body_def *bodies = (pel_body_def *)(uintptr_t)model->def.bodies;
    for (int32_t b = 0; status == PEL_OK && b < model->body_count; b++) {
        bodies[b].mesh = model->bodies[b].mesh;
        bodies[b].rest = NULL; /* the state goes on in other models: bodies do not start there */
        pel_rigid_body_stiffen(&bodies[b]);
    }
    return status;
}

pel_status pel_model_create(const pel_model_def *def, pel_model **model, pel_error *error)
{
    PEL_REFUSE_NULL(def, error);
    PEL_REFUSE_NULL(model, error);
    *model = NULL;
    pel_status status = check_def(def, error);
    if (status != PEL_OK)
        return status;
    pel_model *made = pel_allocate(1, sizeof *made);
    build *builds = pel_allocate((size_t)def->body_count, sizeof *builds);
    if (made != NULL)
        made->bodies = pel_allocate((size_t)def->body_count, sizeof *made->bodies);
    if (made == NULL || builds == NULL || made->bodies == NULL) {
        status = pel_fail_memory(error);
    } else {
        made->body_count = def->body_count;
        memcpy(made->gravity, def->gravity, sizeof made->gravity);
        pel_fingerprint_add(&made->fingerprint, PEL_DEF_MODEL, def);
        status = build_bodies(made, def, builds, error);
        for (int32_t b = 0; b < def->body_count; b++)
            build_end(&builds[b]);
        if (status == PEL_OK)
            status = keep_def(made, def, error);
    }
    pel_free(builds);
    if (status == PEL_OK)
        *model = made;
    else
        pel_model_destroy(made);
    return status;
}

/* ---- other numbers ---- */

/* springs of one stiffness have no array of it, and the order of vertices stays */
static bool may_refill(const pel_model *model, const pel_body *body, const pel_body_def *def)
{
    bool has_parts = body->detail != NULL || body->shell != NULL || body->rigid != NULL;
    return !has_parts && model->stiffnesses == NULL && same_everywhere(def);
}

/* null where nothing asks for areas */
static pel_status refill_vertices(pel_model *model, int32_t b, pel_error *error)
{
    pel_body *body = &model->bodies[b];
    const pel_body_def *def = &model->def.bodies[b];
    bool has_areas = def->volumetric_by_area || def->volumetric_depth > 0 || def->mass_kind != PEL_MASS_PER_VERTEX;
    double *areas = NULL;
    pel_status status = PEL_OK;
    if (has_areas) {
        areas = pel_allocate((size_t)def->mesh->vertex_count, sizeof *areas);
        status = areas != NULL ? lump_areas(def->mesh, areas, &body->rest_area, error) : pel_fail_memory(error);
    }
    if (status == PEL_OK) {
        copy_numbers(def, body);
        status = find_filling(def, body, areas, error);
    }
    if (status == PEL_OK) {
        fill_vertices(model, def, body, model->mesh_vertex + body->slice_begin * PEL_WIDTH, areas);
        status = check_masses(model, b, error);
    }
    pel_free(areas);
    return status;
}

bool pel_model_refill(pel_model *model)
{
    const pel_model_def *def = &model->def;
    pel_spring_room before = needed_springs(model);
    bool may = check_def(def, NULL) == PEL_OK;
    for (int32_t b = 0; may && b < model->body_count; b++)
        may = may_refill(model, &model->bodies[b], &def->bodies[b]);
    for (int32_t b = 0; may && b < model->body_count; b++)
        may = refill_vertices(model, b, NULL) == PEL_OK;
    memcpy(model->gravity, def->gravity, sizeof model->gravity);
    pel_fingerprint_renew(&model->fingerprint, def);
    return may && needed_springs(model) == before;
}

void pel_model_destroy(pel_model *model)
{
    if (model == NULL)
        return;
    for (int32_t b = 0; model->bodies != NULL && b < model->body_count; b++) {
        pel_mesh_destroy(model->bodies[b].mesh);
        PEL_FREE_ALL(model->bodies[b].model_index, model->bodies[b].shares, model->bodies[b].lip_shares,
                     model->bodies[b].start, model->bodies[b].rigid);
        pel_body_detail_destroy(model->bodies[b].detail);
        pel_shell_destroy(model->bodies[b].shell);
        for (int p = 0; p < PEL_PARAMETER_COUNT; p++)
            pel_free(model->bodies[b].curves[p].keys);
    }
    pel_model_free_arrays(model);
    pel_copies_free(&model->copies);
    pel_free(model->bodies);
    pel_free(model);
}

/* whether there is such a body, for functions that are given any number */
static bool has_body(const pel_model *model, int32_t body)
{
    return model != NULL && body >= 0 && body < model->body_count;
}

int32_t pel_model_body_count(const pel_model *model)
{
    if (model == NULL)
        return 0;
    return model->body_count;
}

int32_t pel_model_find_body(const pel_model *model, const char *name)
{
    if (model == NULL || name == NULL)
        return -1;
    for (int32_t b = 0; b < model->body_count; b++)
        if (strcmp(model->bodies[b].name, name) == 0)
            return b;
    return -1;
}

const pel_mesh *pel_model_mesh(const pel_model *model, int32_t body)
{
    if (!has_body(model, body))
        return NULL;
    return model->bodies[body].mesh;
}

int32_t pel_model_turned_count(const pel_model *model, int32_t body)
{
    if (!has_body(model, body))
        return 0;
    return model->bodies[body].turned_count;
}

bool pel_model_is_closed(const pel_model *model, int32_t body)
{
    if (!has_body(model, body))
        return false;
    return model->bodies[body].closed;
}

int32_t pel_model_pinned_count(const pel_model *model, int32_t body)
{
    if (!has_body(model, body))
        return 0;
    const pel_body *own = &model->bodies[body];
    int32_t count = 0;
    for (int32_t v = 0; v < own->mesh->vertex_count; v++)
        count += !(model->inverse_mass[own->model_index[v]] > 0);
    return count;
}

const char *pel_model_body_name(const pel_model *model, int32_t body)
{
    if (!has_body(model, body))
        return "";
    return model->bodies[body].name;
}
