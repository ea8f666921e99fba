#include "boundary/share.h"

#include "base/assert.h"
#include "base/room.h"
#include "base/status.h"
#include "math/vec3.h"
#include "model/origin.h"
#include "pellicle/topology.h"

#include <math.h>
#include <string.h>

/* the elements that a force is spread over; they have all their corners in the region, or some */
typedef enum spread { SOLIDS, FACES, BORDER, EDGES, FACES_AROUND, SOLIDS_AROUND, SPREAD_COUNT } spread;

typedef struct region {
    const pel_body *body;
    const pel_body_def *def;
    const pel_topology *topology;
    uint8_t *marks;   /* (mesh vertices) of vertices before cuts: they are in it */
    double *measures; /* (mesh vertices) m, m2 or m3, of the elements there */
    int32_t count;    /* of marks */
} region;

/* returns the corners of element i, and its size; 0 = there is none */
static int find_element(const region *r, spread over, int32_t i, int32_t corners[4], double *size)
{
    const pel_mesh *mesh = r->body->mesh;
    const double(*x)[3] = (const double(*)[3])mesh->positions;
    if (over == SOLIDS || over == SOLIDS_AROUND) {
        const int32_t *v = memcpy(corners, mesh->tetrahedra[i], sizeof mesh->tetrahedra[i]);
        double sides[3][3], normal[3];
        for (int k = 0; k < 3; k++)
            pel_vec3_subtract(x[v[k + 1]], x[v[0]], sides[k]);
        pel_vec3_cross(sides[0], sides[1], normal);
        *size = fabs(pel_vec3_dot(normal, sides[2])) / 6;
        return 4;
    }
    if (over == FACES || over == FACES_AROUND) {
        const int32_t *v = memcpy(corners, mesh->triangles[i], sizeof mesh->triangles[i]);
        *size = pel_vec3_triangle_area(x[v[0]], x[v[1]], x[v[2]]);
        return 3;
    }
    corners[0] = pel_half_edge_origin(r->topology, i);
    corners[1] = pel_half_edge_target(r->topology, i);
    /* lips are one edge of the surface before it was cut */
    int32_t twin = r->topology->twin[i];
    bool is_border = twin < 0 && !pel_is_lip(r->body, i), is_second = twin >= 0 && twin < i;
    *size = pel_vec3_distance(x[corners[0]], x[corners[1]]) * pel_lip_share(r->body, i);
    return (over == BORDER && !is_border) || is_second ? 0 : 2;
}

static int32_t count_elements(const region *r, spread over)
{
    if (over == SOLIDS || over == SOLIDS_AROUND)
        return r->def->volume.on ? r->body->mesh->tetrahedron_count : 0;
    return over == FACES || over == FACES_AROUND ? r->topology->triangle_count : 3 * r->topology->triangle_count;
}

/* measures the elements at each vertex; returns their size together, and whether all vertices of the region have some
 */
static double measure(region *r, spread over, bool *is_whole)
{
    int32_t element_count = count_elements(r, over), corners[4], left = r->count;
    bool takes_part = over == FACES_AROUND || over == SOLIDS_AROUND;
    double sum = 0, size;
    memset(r->measures, 0, (size_t)r->body->mesh->vertex_count * sizeof *r->measures);
    for (int32_t i = 0; i < element_count; i++) {
        int count = find_element(r, over, i, corners, &size), inside = 0;
        for (int k = 0; k < count; k++)
            inside += r->marks[corners[k] = pel_origin_of(r->def, corners[k])];
        for (int k = 0; k < count && size > 0 && (takes_part || inside == count); k++) {
            if (!r->marks[corners[k]])
                continue;
            left -= r->measures[corners[k]] == 0;
            r->measures[corners[k]] += size;
            sum += size;
        }
    }
    *is_whole = left == 0;
    return sum;
}

/* the measures of vertices over their sum, returned */
static double measure_region(region *r)
{
    bool is_whole = false, has_faces = false, has_edges = false;
    for (spread over = SOLIDS; over < SPREAD_COUNT; over++) {
        if ((over == EDGES && has_faces) || (over == FACES_AROUND && !has_faces && !has_edges))
            continue;
        double sum = measure(r, over, &is_whole);
        if (is_whole)
            return sum;
        has_faces |= over == FACES && sum > 0;
        has_edges |= over == EDGES && sum > 0;
    }
    for (int32_t v = 0; v < r->body->mesh->vertex_count; v++)
        r->measures[v] = r->marks[v];
    return r->count;
}

static void mark_region(region *r, const pel_load_def *def)
{
    int32_t count = def->vertices != NULL ? def->vertex_count : r->body->mesh->vertex_count;
    for (int32_t i = 0; i < count; i++) {
        int32_t v = pel_origin_of(r->def, def->vertices != NULL ? def->vertices[i] : i);
        r->count += !r->marks[v];
        r->marks[v] = 1;
    }
}

pel_status pel_load_share(const pel_model *given, const pel_load_def *def, double *weights, pel_error *error)
{
    PEL_ASSERT_INDEX(def->body, given->body_count);
    region r = {.body = &given->bodies[def->body], .def = &given->def.bodies[def->body]};
    int32_t vertex_count = r.body->mesh->vertex_count, count = def->vertices != NULL ? def->vertex_count : vertex_count;
    pel_topology *topology = NULL;
    double *parts = NULL, sum = 1;
    pel_status status = PEL_ALLOCATE_ALL(PEL_ROOM(r.marks, vertex_count), PEL_ROOM(r.measures, vertex_count),
                                         PEL_ROOM(parts, vertex_count))
                            ? PEL_OK
                            : pel_fail_memory(error);
    bool is_total = def->kind == PEL_LOAD_TOTAL;
    if (status == PEL_OK && is_total)
        status = pel_topology_create(r.body->mesh, &topology, error);
    if (status == PEL_OK && is_total) {
        r.topology = topology;
        mark_region(&r, def);
        sum = measure_region(&r);
    }
    for (int32_t i = 0; status == PEL_OK && i < count; i++) {
        int32_t v = def->vertices != NULL ? def->vertices[i] : i;
        parts[pel_origin_of(r.def, v)] += pel_vertex_share(r.body, v);
    }
    for (int32_t i = 0; status == PEL_OK && i < count; i++) {
        int32_t v = def->vertices != NULL ? def->vertices[i] : i, origin = pel_origin_of(r.def, v);
        double whole = is_total ? r.measures[origin] / sum : 1;
        weights[i] *= whole * (pel_vertex_share(r.body, v) / parts[origin]);
    }
    pel_topology_destroy(topology);
    PEL_FREE_ALL(r.marks, r.measures, parts);
    return status;
}
