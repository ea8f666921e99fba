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
        set->heights.bounds[t] = 0;
        if (set->triangles[t][0] >= set->vertex_count || pel_rigid_of(set->def.rigids, set->triangles[t][0]) != NULL)
            continue;
        measure_squares(set->triangles[t], set->def.rest, &longest, &area);
        set->heights.bounds[t] = (float)(bound * sqrt(area / longest));
    }
    set->heights.slack = 0;
}

/* ---- loops in chunks ---- */

typedef struct height_job {
    const pel_contact_set *set;
    const pel_record *positions;
} height_job;

static void run_chunks(const pel_contact_set *set, int32_t count, pel_chunk_function *function, height_job *job)
{
    pel_pool_run(set->def.pool, (count + PEL_HEIGHT_CHUNK - 1) / PEL_HEIGHT_CHUNK, function, job);
}

static int32_t chunk_end(int32_t chunk, int32_t count)
{
    int32_t first = chunk * PEL_HEIGHT_CHUNK;
    return count - first < PEL_HEIGHT_CHUNK ? count : first + PEL_HEIGHT_CHUNK;
}

/* the square of the largest way since the last measurement, and the largest coordinate then */
static void measure_ways(void *context, int32_t chunk)
{
    const height_job *job = context;
    const pel_contact_heights *heights = &job->set->heights;
    double most = 0, size = 0;
    for (int32_t v = chunk * PEL_HEIGHT_CHUNK; v < chunk_end(chunk, job->set->vertex_count); v++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            double place = (double)heights->places[v][k], way = (double)job->positions[v][k] - place;
            square += way * way;
            size = fabs(place) > size ? fabs(place) : size;
        }
        most = square > most ? square : most;
    }
    heights->parts[chunk][0] = most;
    heights->parts[chunk][1] = size;
}

/* true if no vertex has moved by half of the slack since the last measurement: a width changes by at most twice the
   largest displacement */
static bool are_far_from_flat(const pel_contact_set *set, height_job *job)
{
    const pel_contact_heights *heights = &set->heights;
    double most = 0, size = 0;
    if (!(heights->slack > 0))
        return false;
    run_chunks(set, set->vertex_count, measure_ways, job);
    for (int32_t chunk = 0; chunk * PEL_HEIGHT_CHUNK < set->vertex_count; chunk++) {
        most = pel_max(most, heights->parts[chunk][0]);
        size = pel_max(size, heights->parts[chunk][1]);
    }
    return 2 * (sqrt(most) + (double)FLT_EPSILON * size) < heights->slack;
}

static void keep_places(void *context, int32_t chunk)
{
    const height_job *job = context;
    const pel_contact_set *set = job->set;
    for (int32_t v = chunk * PEL_HEIGHT_CHUNK; v < chunk_end(chunk, set->vertex_count); v++)
        for (int k = 0; k < 3; k++)
            set->heights.places[v][k] = (float)job->positions[v][k];
}

/* how far the triangle is above its bound; 0 where it may be too flat, or is not a number */
static double room_of(const pel_contact_set *set, int32_t t, const pel_record *positions)
{
    double longest, area;
    if (set->triangles[t][0] >= set->vertex_count)
        return HUGE_VAL;
    measure_squares(set->triangles[t], positions, &longest, &area);
    double room = sqrt(area / longest) - (double)set->heights.bounds[t];
    return room > 0 ? room : 0;
}

static void measure_rooms(void *context, int32_t chunk)
{
    const height_job *job = context;
    double least = HUGE_VAL;
    for (int32_t t = chunk * PEL_HEIGHT_CHUNK; t < chunk_end(chunk, job->set->triangle_count); t++) {
        double room = room_of(job->set, t, job->positions);
        least = room < least ? room : least;
    }
    job->set->heights.parts[chunk][0] = least;
}

/* ---- the list ---- */

static pel_status add(pel_contact_heights *heights, int32_t t, double least, pel_error *error)
{
    size_t count = (size_t)heights->list.count;
    if (!pel_reserve((void **)&heights->list.contacts, &heights->capacity, count + 1, sizeof *heights->list.contacts) ||
        !pel_reserve((void **)&heights->triangles, &heights->triangle_capacity, count + 1, sizeof *heights->triangles))
        return pel_fail_memory(error);
    heights->list.contacts[count] = (pel_contact){.separation = (pel_real)least};
    heights->triangles[count] = t;
    heights->list.count++;
    return PEL_OK;
}

/* the triangles of a chunk that are to be watched */
static pel_status list_chunk(pel_contact_set *set, int32_t chunk, const pel_record *positions, pel_error *error)
{
    pel_status status = PEL_OK;
    int32_t end = chunk_end(chunk, set->triangle_count);
    for (int32_t t = chunk * PEL_HEIGHT_CHUNK; status == PEL_OK && t < end; t++) {
        if (room_of(set, t, positions) > 0)
            continue;
        double least = LEAST_SHARE * measure_triangle(set->triangles[t], set->def.rest).length;
        if (measure_triangle(set->triangles[t], positions).length < WATCH * least)
            status = add(&set->heights, t, least, error);
    }
    return status;
}

pel_status pel_contact_heights_find(pel_contact_set *set, const pel_record *position, pel_error *error)
{
    pel_contact_heights *heights = &set->heights;
    height_job job = {set, position};
    pel_status status = PEL_OK;
    heights->list.count = 0;
    if (are_far_from_flat(set, &job))
        return PEL_OK;
    heights->slack = HUGE_VAL;
    run_chunks(set, set->vertex_count, keep_places, &job);
    run_chunks(set, set->triangle_count, measure_rooms, &job);
    for (int32_t chunk = 0; status == PEL_OK && chunk * PEL_HEIGHT_CHUNK < set->triangle_count; chunk++) {
        heights->slack = pel_min(heights->slack, heights->parts[chunk][0]);
        if (!(heights->parts[chunk][0] > 0))
            status = list_chunk(set, chunk, position, error);
    }
    return status;
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
