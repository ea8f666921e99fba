/* Triangles that collapse. A law such as StVK resists less and less where a triangle is pressed flat in its own plane,
   and no pair of features tells it: the features have vertices in common. The edges about a collapsed triangle then lie
   along each other, and everything in their neighbourhood jams. So with contact the height of each triangle of a body
   over its longest edge stays above a share of its least height at rest: a contact between a vertex and an edge. */
#include "contact/set.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"

#include <float.h>
#include <math.h>

/* least height, of that at rest */
#define LEAST_SHARE 0.05
/* triangles below so many least heights at the start of a step are watched in it */
#define WATCH 4.0

/* from the longest edge, a to b, to the third vertex */
typedef struct height {
    int vertex, a, b;
    double share;  /* of the edge, where the height stands on it */
    double way[3]; /* from there to the vertex */
    double length; /* m */
} height;

static height measure(double x[3][3])
{
    double longest = -1, along[3], way[3];
    height h = {0};
    for (int i = 0; i < 3; i++) {
        int a = (i + 1) % 3, b = (i + 2) % 3;
        pel_vec3_subtract(x[b], x[a], along);
        double square = pel_vec3_squared_length(along);
        if (!(square > longest))
            continue;
        longest = square;
        pel_vec3_subtract(x[i], x[a], way);
        h = (height){.vertex = i, .a = a, .b = b, .share = square > 0 ? pel_vec3_dot(way, along) / square : 0};
        pel_vec3_along(way, -h.share, along, h.way);
    }
    h.length = pel_vec3_length(h.way);
    return h;
}

static height measure_triangle(const int32_t *v, const pel_record *positions)
{
    double x[3][3];
    for (int i = 0; i < 3; i++)
        pel_vertex_position(positions, v[i], x[i]);
    return measure(x);
}

/* squares of the longest edge and of twice the area */
static void measure_squares(const int32_t *v, const pel_record *positions, double *longest, double *area)
{
    double x[3][3], a[3], b[3], c[3], normal[3];
    for (int i = 0; i < 3; i++)
        pel_vertex_position(positions, v[i], x[i]);
    pel_vec3_subtract(x[1], x[0], a);
    pel_vec3_subtract(x[2], x[1], b);
    pel_vec3_subtract(x[0], x[2], c);
    pel_vec3_cross(a, b, normal);
    double square = pel_vec3_squared_length(a), other = pel_vec3_squared_length(b);
    double third = pel_vec3_squared_length(c);
    square = square > other ? square : other;
    *longest = square > third ? square : third;
    *area = pel_vec3_squared_length(normal);
}

/* The height is the width of the triangle, twice its area over its longest edge. The bound leaves a few percent for
   rounding. */
void pel_contact_heights_set_surface(pel_contact_set *set)
{
    const double bound = 1.05 * WATCH * LEAST_SHARE;
    for (int32_t t = 0; t < set->triangle_count; t++) {
        double longest, area;
        if (set->triangles[t][0] >= set->vertex_count)
            continue;
        measure_squares(set->triangles[t], set->def.rest, &longest, &area);
        set->heights.bounds[t] = (float)(bound * sqrt(area / longest));
    }
    set->heights.slack = 0;
}

/* true if no vertex has moved by half of the slack since the last measurement: a width changes by at most twice the
   largest displacement */
static bool are_far_from_flat(const pel_contact_set *set, const pel_record *positions)
{
    const pel_contact_heights *heights = &set->heights;
    double most = 0, size = 0;
    if (!(heights->slack > 0))
        return false;
    for (int32_t v = 0; v < set->vertex_count; v++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            double place = (double)heights->places[v][k], way = (double)positions[v][k] - place;
            square += way * way;
            size = fabs(place) > size ? fabs(place) : size;
        }
        most = square > most ? square : most;
    }
    return 2 * (sqrt(most) + (double)FLT_EPSILON * size) < heights->slack;
}

static void keep_places(pel_contact_set *set, const pel_record *positions)
{
    for (int32_t v = 0; v < set->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            set->heights.places[v][k] = (float)positions[v][k];
}

pel_status pel_contact_heights_find(pel_contact_set *set, const pel_record *position, pel_error *error)
{
    pel_contact_heights *heights = &set->heights;
    heights->list.count = 0;
    if (are_far_from_flat(set, position))
        return PEL_OK;
    heights->slack = HUGE_VAL;
    keep_places(set, position);
    for (int32_t t = 0; t < set->triangle_count; t++) {
        const int32_t *v = set->triangles[t];
        double longest, area;
        if (v[0] >= set->vertex_count)
            continue;
        measure_squares(v, position, &longest, &area);
        double room = sqrt(area / longest) - (double)heights->bounds[t];
        heights->slack = room > 0 ? pel_min(room, heights->slack) : 0;
        if (room > 0)
            continue;
        double least = LEAST_SHARE * measure_triangle(v, set->def.rest).length;
        if (!(measure_triangle(v, position).length < WATCH * least))
            continue;
        size_t count = (size_t)heights->list.count;
        if (!pel_reserve((void **)&heights->list.contacts, &heights->capacity, count + 1,
                         sizeof *heights->list.contacts) ||
            !pel_reserve((void **)&heights->triangles, &heights->triangle_capacity, count + 1,
                         sizeof *heights->triangles))
            return pel_fail_memory(error);
        heights->list.contacts[count] = (pel_contact){.separation = (pel_real)least};
        heights->triangles[count] = t;
        heights->list.count++;
    }
    return PEL_OK;
}

void pel_contact_heights_refresh(pel_contact_set *set, const pel_record *positions)
{
    const pel_contact_heights *heights = &set->heights;
    for (int32_t c = 0; c < heights->list.count; c++) {
        pel_contact *contact = &heights->list.contacts[c];
        const int32_t *v = set->triangles[heights->triangles[c]];
        height h = measure_triangle(v, positions);
        const int32_t vertices[4] = {v[h.vertex], v[h.a], v[h.b], v[h.b]};
        const double weights[4] = {1, h.share - 1, -h.share, 0};
        for (int i = 0; i < 4; i++) {
            contact->vertices[i] = vertices[i];
            contact->weights[i] = (pel_real)weights[i];
        }
        for (int k = 0; k < 3 && h.length > 0; k++)
            contact->normal[k] = (pel_real)(h.way[k] / h.length);
    }
}
