#include "pellicle/region.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "base/text.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "mesh/edge_table.h"
#include "mesh/figures.h"

#include <math.h>
#include <string.h>

enum { COOKIE = 0x52454749 };

pel_region pel_region_default(void)
{
    pel_region region;
    memset(&region, 0, sizeof region);
    region.kind = PEL_REGION_ALL;
    region.above = 0.5;
    region.loop = -1;
    region.cookie = COOKIE;
    return region;
}

static bool finite_point(const double point[3])
{
    return isfinite(point[0]) && isfinite(point[1]) && isfinite(point[2]);
}

static pel_status check_falloff(const pel_region *region, pel_error *error)
{
    bool has_distance = region->kind == PEL_REGION_NEAREST || region->kind == PEL_REGION_SPHERE ||
                        region->kind == PEL_REGION_BOX || region->kind == PEL_REGION_PLANE;
    if (!isfinite(region->falloff) || region->falloff < 0)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give a width in metres, 0 for none",
                          "falloff of the region is not a number from 0 on");
    if (region->falloff > 0 && !has_distance)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "set falloff to 0, or use a sphere, box, plane or nearest",
                          "this kind of region has no falloff");
    return PEL_OK;
}

static pel_status check_box(const pel_region *region, pel_error *error)
{
    bool right = finite_point(region->low) && finite_point(region->high);
    for (int i = 0; i < 3; i++)
        right = right && region->low[i] <= region->high[i];
    return right ? PEL_OK
                 : pel_refuse(error, PEL_BAD_ARGUMENT, "give the lowest and the highest corner",
                              "box of the region has a corner that is not finite or is upside down");
}

static pel_status check_vertices(const pel_region *region, const pel_mesh *mesh, pel_error *error)
{
    if (region->vertex_count > 0)
        PEL_REFUSE_NULL(region->vertices, error);
    for (int32_t i = 0; i < region->vertex_count; i++) {
        int32_t v = region->vertices[i];
        if (v >= 0 && v < mesh->vertex_count)
            continue;
        pel_fail(error, PEL_BAD_ARGUMENT, "the mesh has no vertex %d", (int)v);
        pel_fail_remedy(error, "give numbers from 0 to %d", (int)mesh->vertex_count - 1);
        return PEL_BAD_ARGUMENT;
    }
    return PEL_OK;
}

/* the field whose name is most like this one, null when none is near */
static const char *nearest_field(const pel_mesh *mesh, const char *name)
{
    const char *best = NULL;
    for (int32_t f = 0; f < mesh->field_count; f++) {
        const char *pair[2] = {best != NULL ? best : mesh->fields[f].name, mesh->fields[f].name};
        best = pel_nearest_name(name, pair, 2);
    }
    return best;
}

static pel_status fail_unknown_field(const pel_mesh *mesh, const char *name, pel_error *error)
{
    const char *nearest = nearest_field(mesh, name);
    pel_fail(error, PEL_BAD_ARGUMENT, "the mesh has no field '%s'", name);
    if (nearest != NULL)
        pel_fail_remedy(error, "did you mean '%s'?", nearest);
    else if (mesh->field_count > 0)
        pel_fail_remedy(error, "its first of %d fields is '%s'", (int)mesh->field_count, mesh->fields[0].name);
    else
        pel_fail_remedy(error, "it has no fields: use a PLY file with custom vertex properties");
    return PEL_BAD_ARGUMENT;
}

static pel_status check_field(const pel_region *region, const pel_mesh *mesh, pel_error *error)
{
    if (region->field == NULL || isnan(region->above))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "set field and above", "region has no field name or no number");
    const pel_field *field = pel_mesh_field(mesh, region->field);
    if (field == NULL)
        return fail_unknown_field(mesh, region->field, error);
    if (field->component_count == 1)
        return PEL_OK;
    return pel_refuse(error, PEL_BAD_ARGUMENT, "use a field with one number per vertex",
                      "field '%s' has %d numbers per vertex", field->name, (int)field->component_count);
}

static pel_status check_triangles(const pel_mesh *mesh, pel_error *error)
{
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            int32_t v = mesh->triangles[t][i];
            if (v >= 0 && v < mesh->vertex_count)
                continue;
            pel_fail(error, PEL_BAD_ARGUMENT, "the mesh has no vertex %d", (int)v);
            pel_fail_element(error, "triangle", t);
            pel_fail_remedy(error, "give corners from 0 to %d", (int)mesh->vertex_count - 1);
            return PEL_BAD_ARGUMENT;
        }
    return PEL_OK;
}

static pel_status check_region(const pel_region *region, const pel_mesh *mesh, pel_error *error)
{
    if (region->cookie != COOKIE)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "begin with pel_region_default() and change its members",
                          "the region was not filled by pel_region_default");
    pel_status status = check_falloff(region, error);
    if (status != PEL_OK)
        return status;
    switch (region->kind) {
    case PEL_REGION_ALL:
        return PEL_OK;
    case PEL_REGION_NEAREST:
        return finite_point(region->point)
                   ? PEL_OK
                   : pel_refuse(error, PEL_BAD_ARGUMENT, "give three numbers", "point of the region is not finite");
    case PEL_REGION_SPHERE:
        if (finite_point(region->center) && isfinite(region->radius) && region->radius >= 0)
            return PEL_OK;
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give three numbers and a radius from 0 on",
                          "sphere of the region has a centre or radius that is not finite, or a negative radius");
    case PEL_REGION_BOX:
        return check_box(region, error);
    case PEL_REGION_VERTICES:
        return check_vertices(region, mesh, error);
    case PEL_REGION_FIELD:
        return check_field(region, mesh, error);
    case PEL_REGION_BOUNDARY:
        return check_triangles(mesh, error);
    case PEL_REGION_PLANE:
        if (finite_point(region->point) && finite_point(region->normal) && pel_vec3_length(region->normal) > 0)
            return PEL_OK;
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give three numbers each, a normal that is not 0",
                          "plane of the region has a point or a normal that is no place or direction");
    default:
        return pel_refuse(error, PEL_BAD_ARGUMENT, "use one of pel_region_kind", "there is no such kind of region");
    }
}

static int32_t nearest_vertex(const pel_mesh *mesh, const double point[3])
{
    int32_t nearest = 0;
    double least = (double)HUGE_VAL;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double distance = pel_vec3_distance(mesh->positions[v], point);
        if (distance < least) {
            least = distance;
            nearest = v;
        }
    }
    return nearest;
}

static double box_distance(const double low[3], const double high[3], const double point[3])
{
    double inside[3];
    for (int i = 0; i < 3; i++)
        inside[i] = pel_min(pel_max(point[i], low[i]), high[i]);
    return pel_vec3_distance(point, inside);
}

/* 1 at distance 0 and below, 0 from the falloff on */
static double weight_at(double distance, double falloff)
{
    if (distance <= 0)
        return 1;
    if (distance >= falloff)
        return 0;
    double s = distance / falloff;
    return 1 - s * s * (3 - 2 * s);
}

/* distance of each vertex from the sphere, box, half space or nearest vertex; <= 0 inside */
static void measure_distances(const pel_mesh *mesh, const pel_region *region, double *distances)
{
    if (region->kind == PEL_REGION_PLANE) {
        double normal[3] = {region->normal[0], region->normal[1], region->normal[2]}, from[3];
        pel_vec3_normalize(normal);
        for (int32_t v = 0; v < mesh->vertex_count; v++) {
            pel_vec3_subtract(mesh->positions[v], region->point, from);
            distances[v] = -pel_vec3_dot(from, normal);
        }
        return;
    }
    const double *middle = region->center;
    double radius = region->radius;
    if (region->kind == PEL_REGION_NEAREST) {
        middle = mesh->positions[nearest_vertex(mesh, region->point)];
        radius = 0;
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        distances[v] = region->kind == PEL_REGION_BOX ? box_distance(region->low, region->high, mesh->positions[v])
                                                      : pel_vec3_distance(mesh->positions[v], middle) - radius;
}

/* the nearest vertex is one vertex, not all at its place */
static void weigh_by_distance(const pel_mesh *mesh, const pel_region *region, double *weights)
{
    measure_distances(mesh, region, weights);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        weights[v] = weight_at(weights[v], region->falloff);
    if (region->kind == PEL_REGION_NEAREST && region->falloff == 0) {
        memset(weights, 0, (size_t)mesh->vertex_count * sizeof *weights);
        weights[nearest_vertex(mesh, region->point)] = 1;
    }
}

static void weigh_by_field(const pel_mesh *mesh, const pel_region *region, double *weights)
{
    const double *values = pel_mesh_field(mesh, region->field)->values;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        weights[v] = values[v] > region->above;
}

/* the root of the loop that a vertex belongs to; shortens the path to it */
static int32_t loop_of(int32_t *parents, int32_t v)
{
    while (parents[v] != v) {
        parents[v] = parents[parents[v]];
        v = parents[v];
    }
    return v;
}

/* The root of the loop of that number, by decreasing length; -1 if there are fewer. Lengths are at the roots, 0 at
   other vertices, and are lost. */
static int32_t longest_loop(double *lengths, int32_t vertex_count, int32_t number)
{
    int32_t longest = -1;
    for (int32_t n = 0; n <= number; n++) {
        if (longest >= 0)
            lengths[longest] = 0;
        longest = -1;
        for (int32_t v = 0; v < vertex_count; v++)
            if (lengths[v] > 0 && (longest < 0 || lengths[v] > lengths[longest]))
                longest = v;
        if (longest < 0)
            break;
    }
    return longest;
}

/* keeps the weights of one loop: boundary edges that hang together are a loop */
static pel_status keep_loop(const pel_mesh *mesh, const pel_edge_table *edges, int32_t number, double *weights,
                            pel_error *error)
{
    int32_t *parents = pel_allocate((size_t)mesh->vertex_count, sizeof *parents);
    double *lengths = pel_allocate((size_t)mesh->vertex_count, sizeof *lengths);
    if (parents == NULL || lengths == NULL) {
        pel_free(parents);
        pel_free(lengths);
        return pel_fail_memory(error);
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        parents[v] = v;
    for (int pass = 0; pass < 2; pass++)
        for (int32_t e = 0; e < edges->edge_count; e++) {
            const int32_t h = edges->half_edge_of_edge[e];
            const int32_t a = mesh->triangles[h / 3][h % 3], b = mesh->triangles[h / 3][(h + 1) % 3];
            if (pel_edge_table_valence(edges, e) > 1)
                continue;
            if (pass == 0)
                parents[loop_of(parents, a)] = loop_of(parents, b);
            else
                lengths[loop_of(parents, a)] += pel_vec3_distance(mesh->positions[a], mesh->positions[b]);
        }
    const int32_t root = longest_loop(lengths, mesh->vertex_count, number);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        weights[v] = weights[v] > 0 && root >= 0 && loop_of(parents, v) == root;
    pel_free(parents);
    pel_free(lengths);
    return PEL_OK;
}

/* vertices of edges that have one triangle */
static pel_status weigh_boundary(const pel_mesh *mesh, const pel_region *region, double *weights, pel_error *error)
{
    pel_edge_table edges;
    if (pel_edge_table_build((const int32_t(*)[3])mesh->triangles, mesh->triangle_count, mesh->vertex_count, NULL,
                             &edges) != PEL_OK)
        return pel_fail_memory(error);
    for (int32_t e = 0; e < edges.edge_count; e++) {
        int32_t h = edges.half_edge_of_edge[e];
        if (pel_edge_table_valence(&edges, e) > 1)
            continue;
        weights[mesh->triangles[h / 3][h % 3]] = 1;
        weights[mesh->triangles[h / 3][(h + 1) % 3]] = 1;
    }
    const pel_status status = region->loop >= 0 ? keep_loop(mesh, &edges, region->loop, weights, error) : PEL_OK;
    pel_edge_table_clear(&edges);
    return status;
}

static pel_status weigh(const pel_mesh *mesh, const pel_region *region, double *weights, pel_error *error)
{
    switch (region->kind) {
    case PEL_REGION_ALL:
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            weights[v] = 1;
        break;
    case PEL_REGION_VERTICES:
        for (int32_t i = 0; i < region->vertex_count; i++)
            weights[region->vertices[i]] = 1;
        break;
    case PEL_REGION_FIELD:
        weigh_by_field(mesh, region, weights);
        break;
    case PEL_REGION_BOUNDARY:
        return weigh_boundary(mesh, region, weights, error);
    default:
        weigh_by_distance(mesh, region, weights);
        break;
    }
    return PEL_OK;
}

/* says how far off the region is */
static pel_status fail_empty(const pel_mesh *mesh, const pel_region *region, double *scratch, pel_error *error)
{
    if (region->kind == PEL_REGION_VERTICES)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give at least one number", "the region lists no vertex");
    if (region->kind == PEL_REGION_BOUNDARY && region->loop >= 0)
        return pel_refuse(error, PEL_BAD_ARGUMENT,
                          "count the loops from 0, the longest first, or use the whole boundary",
                          "the region is empty: the boundary of the mesh has no loop %d", (int)region->loop);
    if (region->kind == PEL_REGION_BOUNDARY)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "select vertices by a sphere, a box or a field",
                          "the region is empty: the mesh is closed, it has no boundary");
    if (region->kind == PEL_REGION_FIELD) {
        double greatest = -(double)HUGE_VAL;
        const double *values = pel_mesh_field(mesh, region->field)->values;
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            greatest = pel_max(greatest, values[v]);
        pel_fail(error, PEL_BAD_ARGUMENT, "the region is empty: field '%s' is nowhere above %g", region->field,
                 region->above);
        pel_fail_remedy(error, "its greatest value is %g", greatest);
        return PEL_BAD_ARGUMENT;
    }
    int32_t nearest = 0;
    measure_distances(mesh, region, scratch);
    for (int32_t v = 1; v < mesh->vertex_count; v++)
        if (scratch[v] < scratch[nearest])
            nearest = v;
    const double *p = mesh->positions[nearest];
    pel_fail(error, PEL_BAD_ARGUMENT, "the region is empty: the nearest vertex is %g m outside it", scratch[nearest]);
    pel_fail_remedy(error, "that vertex lies at (%g, %g, %g); move or enlarge the region%s", p[0], p[1], p[2],
                    pel_mesh_diagonal(mesh) > PEL_LARGE_BODY ? ", or give a mesh in millimetres scale: 0.001" : "");
    pel_fail_element(error, "vertex", nearest);
    return PEL_BAD_ARGUMENT;
}

static pel_status collect(const pel_mesh *mesh, const double *weights, int32_t count, pel_selection **selection,
                          pel_error *error)
{
    pel_selection *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(made->vertices, count), PEL_ROOM(made->weights, count))) {
        pel_selection_destroy(made);
        return pel_fail_memory(error);
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        if (!(weights[v] > 0))
            continue;
        made->vertices[made->count] = v;
        made->weights[made->count++] = weights[v];
    }
    *selection = made;
    return PEL_OK;
}

pel_status pel_mesh_select(const pel_mesh *mesh, const pel_region *region, pel_selection **selection, pel_error *error)
{
    PEL_REFUSE_NULL(mesh, error);
    PEL_REFUSE_NULL(region, error);
    PEL_REFUSE_NULL(selection, error);
    *selection = NULL;
    pel_status status = check_region(region, mesh, error);
    if (status != PEL_OK)
        return status;
    double *weights = pel_allocate((size_t)mesh->vertex_count, sizeof *weights);
    if (weights == NULL)
        return pel_fail_memory(error);
    status = weigh(mesh, region, weights, error);
    int32_t count = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        count += weights[v] > 0;
    if (status == PEL_OK && count > 0)
        status = collect(mesh, weights, count, selection, error);
    else if (status == PEL_OK)
        status = fail_empty(mesh, region, weights, error);
    pel_free(weights);
    return status;
}

void pel_selection_destroy(pel_selection *selection)
{
    if (selection == NULL)
        return;
    PEL_FREE_ALL(selection->vertices, selection->weights, selection);
}
