#include "mesh/seam.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "mesh/edge_table.h"
#include "mesh/figures.h"
#include "mesh/union_find.h"
#include "mesh/weld.h"

#include <math.h>
#include <string.h>

enum { MOST_ROUNDS = 4 };

typedef struct sewing {
    const int32_t (*triangles)[3];
    int32_t vertex_count, triangle_count;
    int32_t *place_of;   /* (vertex_count) vertices with equal positions have the same place */
    int32_t (*at)[3];    /* (triangle_count) triangles of places, later of the sewn vertices */
    uint8_t *skip;       /* (triangle_count) two corners at one place */
    uint8_t *is_border;  /* (3 triangle_count) the half-edge is alone on its edge */
    uint8_t *stays_open; /* (vertex_count) by place: sewing at it makes no surface */
    int32_t *number_of;  /* (vertex_count) scratch */
} sewing;

static bool has_twice(const int32_t triangle[3])
{
    return triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
}

/* the vertex at the beginning or end of a half-edge */
static int32_t end_of(const int32_t (*triangles)[3], int32_t h, int end)
{
    return triangles[h / 3][(h % 3 + end) % 3];
}

static bool is_same_edge(const int32_t (*triangles)[3], int32_t h, int32_t other)
{
    const int32_t a = end_of(triangles, h, 0), b = end_of(triangles, h, 1), c = end_of(triangles, other, 0),
                  d = end_of(triangles, other, 1);
    return (a == c && b == d) || (a == d && b == c);
}

static pel_status find_border(sewing *s, bool *any)
{
    pel_edge_table edges;
    *any = false;
    for (int32_t t = 0; t < s->triangle_count; t++)
        s->skip[t] = has_twice(s->triangles[t]);
    if (pel_edge_table_build(s->triangles, s->triangle_count, s->vertex_count, s->skip, &edges) != PEL_OK)
        return PEL_OUT_OF_MEMORY;
    for (int32_t e = 0; e < edges.edge_count; e++) {
        const int32_t h = edges.half_edge_of_edge[e];
        s->is_border[h] = edges.next_in_edge[h] < 0;
        *any |= s->is_border[h];
    }
    pel_edge_table_clear(&edges);
    return PEL_OK;
}

/* the triangles as their places have them */
static void find_places(sewing *s)
{
    for (int32_t t = 0; t < s->triangle_count; t++) {
        for (int i = 0; i < 3; i++)
            s->at[t][i] = s->place_of[s->triangles[t][i]];
        s->skip[t] = has_twice(s->at[t]);
    }
}

/* joins the ends of two borders that are alone at their place and run against each other */
static void sew_edge(const sewing *s, const pel_edge_table *edges, int32_t e, int32_t *index_of, pel_seams *seams)
{
    int32_t border[2] = {-1, -1}, count = 0;
    for (int32_t h = edges->half_edge_of_edge[e]; h >= 0; h = edges->next_in_edge[h])
        if (s->is_border[h])
            border[count++ > 0] = h;
    if (count < 2)
        return;
    const int32_t first = border[0], second = border[1];
    const int32_t a = end_of((const int32_t(*)[3])s->at, first, 0), b = end_of((const int32_t(*)[3])s->at, first, 1);
    if (count > 2 || end_of((const int32_t(*)[3])s->at, second, 0) == a || s->stays_open[a] || s->stays_open[b]) {
        seams->open_count++;
        return;
    }
    pel_union_find_join(index_of, end_of(s->triangles, first, 0), end_of(s->triangles, second, 1));
    pel_union_find_join(index_of, end_of(s->triangles, first, 1), end_of(s->triangles, second, 0));
    seams->closed_count++;
}

static int32_t number_vertices(const sewing *s, int32_t *index_of)
{
    int32_t count = 0;
    for (int32_t v = 0; v < s->vertex_count; v++)
        index_of[v] = pel_union_find_root(index_of, v);
    for (int32_t v = 0; v < s->vertex_count; v++) {
        if (index_of[v] == v)
            s->number_of[v] = count++;
        index_of[v] = s->number_of[index_of[v]];
    }
    return count;
}

/* Marks what sewing made worse: triangles with a vertex twice, and edges on which more than two half-edges lie, or two
   that run alike, and that were not one edge before. false = nothing. */
static bool mark_worse(sewing *s, const pel_edge_table *edges, const int32_t (*sewn)[3])
{
    bool any = false;
    for (int32_t t = 0; t < s->triangle_count; t++) {
        if (has_twice(s->triangles[t]) || !has_twice(sewn[t]))
            continue;
        for (int i = 0; i < 3; i++)
            s->stays_open[s->place_of[s->triangles[t][i]]] = 1;
        any = true;
    }
    for (int32_t e = 0; e < edges->edge_count; e++) {
        const int32_t first = edges->half_edge_of_edge[e], second = edges->next_in_edge[first];
        if (second < 0)
            continue;
        bool is_worse = edges->next_in_edge[second] >= 0 || end_of(sewn, first, 0) == end_of(sewn, second, 0);
        bool is_new = false;
        for (int32_t h = second; h >= 0; h = edges->next_in_edge[h])
            is_new |= !is_same_edge(s->triangles, first, h);
        if (!is_worse || !is_new)
            continue;
        for (int end = 0; end < 2; end++)
            s->stays_open[s->place_of[end_of(s->triangles, first, end)]] = 1;
        any = true;
    }
    return any;
}

/* sews what may be sewn; is_final: nothing had to be opened again */
static pel_status sew(sewing *s, const pel_edge_table *places, int32_t *index_of, int32_t *count, pel_seams *seams,
                      bool *is_final)
{
    int32_t(*sewn)[3] = pel_allocate((size_t)s->triangle_count, sizeof *sewn);
    uint8_t *skip = pel_allocate((size_t)s->triangle_count, 1);
    pel_edge_table edges = {0};
    pel_status status = sewn != NULL && skip != NULL ? PEL_OK : PEL_OUT_OF_MEMORY;
    *seams = (pel_seams){0};
    pel_union_find_reset(index_of, s->vertex_count);
    for (int32_t e = 0; e < places->edge_count; e++)
        sew_edge(s, places, e, index_of, seams);
    *count = number_vertices(s, index_of);
    for (int32_t t = 0; t < s->triangle_count && status == PEL_OK; t++) {
        for (int i = 0; i < 3; i++)
            sewn[t][i] = index_of[s->triangles[t][i]];
        skip[t] = has_twice(sewn[t]);
    }
    if (status == PEL_OK)
        status = pel_edge_table_build((const int32_t(*)[3])sewn, s->triangle_count, *count, skip, &edges);
    if (status == PEL_OK)
        *is_final = !mark_worse(s, &edges, (const int32_t(*)[3])sewn);
    pel_edge_table_clear(&edges);
    pel_free(sewn);
    pel_free(skip);
    return status;
}

/* sews, opens what makes no surface, and sews the rest again */
static pel_status sew_in_rounds(sewing *s, int32_t *index_of, int32_t *count, pel_seams *seams)
{
    pel_edge_table places;
    bool is_final = false;
    pel_status status =
        pel_edge_table_build((const int32_t(*)[3])s->at, s->triangle_count, s->vertex_count, s->skip, &places);
    for (int round = 0; status == PEL_OK && !is_final; round++) {
        if (round == MOST_ROUNDS)
            memset(s->stays_open, 1, (size_t)s->vertex_count);
        status = sew(s, &places, index_of, count, seams, &is_final);
        is_final |= round == MOST_ROUNDS;
    }
    pel_edge_table_clear(&places);
    return status;
}

pel_status pel_seams_find(const double (*positions)[3], int32_t vertex_count, const int32_t (*triangles)[3],
                          int32_t triangle_count, double tolerance, int32_t *index_of, int32_t *count, pel_seams *seams)
{
    sewing s = {.triangles = triangles, .vertex_count = vertex_count, .triangle_count = triangle_count};
    const size_t t = (size_t)triangle_count, v = (size_t)vertex_count;
    int32_t place_count = vertex_count;
    bool has_border;
    *seams = (pel_seams){0};
    *count = vertex_count;
    pel_union_find_reset(index_of, vertex_count);
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(s.place_of, v), PEL_ROOM(s.at, t), PEL_ROOM(s.skip, t), PEL_ROOM(s.is_border, 3 * t),
                          PEL_ROOM(s.stays_open, v), PEL_ROOM(s.number_of, v)))
        return PEL_OUT_OF_MEMORY;
    pel_status status = find_border(&s, &has_border);
    if (status == PEL_OK && has_border)
        status = pel_weld_points(positions, vertex_count, tolerance, s.place_of, &place_count);
    if (status == PEL_OK && place_count < vertex_count) {
        find_places(&s);
        status = sew_in_rounds(&s, index_of, count, seams);
    }
    PEL_FREE_ALL(s.number_of, s.stays_open, s.is_border, s.skip, s.at, s.place_of);
    return status;
}

/* ---- meshes ---- */

/* how many vertices have another value than the first one of their place */
static int32_t count_differences(const pel_field *field, const int32_t *index_of, const int32_t *first_of,
                                 int32_t vertex_count)
{
    const size_t width = (size_t)field->component_count;
    int32_t differences = 0;
    for (int32_t v = 0; v < vertex_count; v++)
        differences += memcmp(field->values + (size_t)v * width, field->values + (size_t)first_of[index_of[v]] * width,
                              width * sizeof(double)) != 0;
    return differences;
}

static void log_fields(const pel_mesh *mesh, const int32_t *index_of, const int32_t *first_of, const pel_log *log)
{
    for (int32_t f = 0; f < mesh->field_count; f++) {
        const pel_field *field = &mesh->fields[f];
        const int32_t differences = count_differences(field, index_of, first_of, mesh->vertex_count);
        if (differences > 0)
            pel_log_line(log,
                         "field '%s' differs across the seams at %d vertices: the first value of each place is kept",
                         field->name, (int)differences);
    }
}

static void compact(pel_mesh *mesh, const int32_t *index_of, const int32_t *first_of, int32_t count)
{
    for (int32_t i = 0; i < count; i++)
        memmove(mesh->positions[i], mesh->positions[first_of[i]], sizeof *mesh->positions);
    for (int32_t f = 0; f < mesh->field_count; f++) {
        const size_t width = (size_t)mesh->fields[f].component_count;
        double *values = mesh->fields[f].values;
        for (int32_t i = 0; i < count; i++)
            memmove(values + (size_t)i * width, values + (size_t)first_of[i] * width, width * sizeof *values);
    }
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            mesh->triangles[t][i] = index_of[mesh->triangles[t][i]];
    mesh->vertex_count = count;
}

static void log_open(const pel_seams *seams, const pel_log *log)
{
    if (seams->open_count > 0)
        pel_log_line(log,
                     "%d edges on open seams: borders lie on each other there, but which belong together is not "
                     "clear, so they stay apart",
                     (int)seams->open_count);
}

#define EDGE_SHARE 0.1

double pel_seams_tolerance(const pel_mesh *mesh, double share)
{
    double shortest = HUGE_VAL, tolerance;
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            double edge[3];
            pel_vec3_subtract(mesh->positions[mesh->triangles[t][i]], mesh->positions[mesh->triangles[t][(i + 1) % 3]],
                              edge);
            /* two corners at one place are no edge */
            const double length = pel_vec3_length(edge);
            shortest = length > 0 ? pel_min(shortest, length) : shortest;
        }
    tolerance = pel_min(share * pel_mesh_diagonal(mesh), EDGE_SHARE * shortest);
    return pel_weld_tolerance_allowed((const double(*)[3])mesh->positions, mesh->vertex_count, tolerance) ? tolerance
                                                                                                          : 0;
}

pel_status pel_seams_weld(pel_mesh *mesh, int32_t **index_of, const pel_log *log, pel_error *error)
{
    pel_seams seams;
    const int32_t before = mesh->vertex_count;
    int32_t count, *map, *first_of;
    if (index_of != NULL)
        *index_of = NULL;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(map, before), PEL_ROOM(first_of, before)))
        return pel_fail_memory(error);
    if (pel_seams_find((const double(*)[3])mesh->positions, before, (const int32_t(*)[3])mesh->triangles,
                       mesh->triangle_count, pel_seams_tolerance(mesh, PEL_SEAM_SHARE), map, &count,
                       &seams) != PEL_OK) {
        PEL_FREE_ALL(map, first_of);
        return pel_fail_memory(error);
    }
    log_open(&seams, log);
    if (count < before) {
        for (int32_t v = before - 1; v >= 0; v--)
            first_of[map[v]] = v;
        pel_log_line(log, "%d vertices on seams welded into %d: they stand in the file twice or more", (int)before,
                     (int)count);
        log_fields(mesh, map, first_of, log);
        compact(mesh, map, first_of, count);
    }
    const bool is_kept = index_of != NULL && count < before;
    if (is_kept)
        *index_of = map;
    PEL_FREE_ALL(first_of, is_kept ? NULL : map);
    return PEL_OK;
}
