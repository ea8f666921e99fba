/* Repair in passes over marks: the place of each vertex, triangles that are kept, triangles that are reversed. The
   repaired mesh is written once, at the end. Welding keeps the position of the first vertex of each place, and places
   are linked by steps of at most the tolerance, so no two places of the result are within the tolerance: repairing
   again welds no two places. */
#include "base/assert.h"
#include "pellicle/mesh_check.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "mesh/allocate.h"
#include "mesh/cut.h"
#include "mesh/duplicate.h"
#include "mesh/edge_table.h"
#include "mesh/flat_triangle.h"
#include "mesh/patch.h"
#include "mesh/slit.h"
#include "mesh/union_find.h"
#include "mesh/weld.h"

#include <math.h>
#include <string.h>

/* data shared by the passes */
typedef struct work {
    const pel_mesh *mesh;
    pel_repair_options options;
    pel_repair_summary summary;
    int32_t (*triangles)[3];              /* (triangle_count x 3) with welded vertices, turned as needed */
    uint8_t *dropped;                     /* (triangle_count) */
    uint8_t *turned;                      /* (triangle_count) winding is reversed */
    uint8_t *flipped;                     /* (triangle_count) has other corners, so that a slit is closed */
    int32_t *first_of;                    /* (vertex_count) the vertex that each is merged into */
    pel_cut cut;                          /* copies of vertices made for fans */
    int32_t *new_number;                  /* (vertex_count + copy_count) in the repaired mesh, -1 = dropped */
    int32_t vertex_count, triangle_count; /* of the repaired mesh */
} work;

pel_repair_options pel_repair_options_default(void)
{
    const pel_repair_options options = {
        .weld = true,
        .drop_degenerate = true,
        .drop_duplicates = true,
        .drop_isolated = true,
        .close_slits = true,
        .cut = true,
        .orient = true,
        .outward = true,
    };
    return options;
}

static bool finite_vertex(const pel_mesh *mesh, int32_t v)
{
    const double *p = mesh->positions[v];
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
}

static bool usable_triangle(const pel_mesh *mesh, int32_t t)
{
    for (int i = 0; i < 3; i++) {
        int32_t v = mesh->triangles[t][i];
        if (v < 0 || v >= mesh->vertex_count || !finite_vertex(mesh, v))
            return false;
    }
    return true;
}

static void drop_bad_triangles(work *w)
{
    for (int32_t t = 0; t < w->mesh->triangle_count; t++) {
        w->dropped[t] = !usable_triangle(w->mesh, t);
        w->summary.bad_triangles += w->dropped[t];
    }
}

/* fills first_of; vertices that are not finite stay alone */
static pel_status weld(work *w)
{
    int32_t vertex_count = w->mesh->vertex_count, place_count;
    for (int32_t v = 0; v < vertex_count; v++)
        w->first_of[v] = v;
    if (!w->options.weld)
        return PEL_OK;
    int32_t *first_of_place = pel_allocate((size_t)vertex_count, sizeof *first_of_place);
    if (first_of_place == NULL)
        return PEL_OUT_OF_MEMORY;
    pel_status status = pel_weld_points((const double(*)[3])w->mesh->positions, vertex_count, w->options.weld_tolerance,
                                        w->first_of, &place_count);
    for (int32_t v = 0, seen = 0; v < vertex_count && status == PEL_OK; v++) {
        int32_t place = w->first_of[v];
        if (place == seen)
            first_of_place[seen++] = v;
        else
            w->summary.welded_vertices++;
        w->first_of[v] = first_of_place[place];
    }
    pel_free(first_of_place);
    return status;
}

static void weld_triangles(work *w)
{
    for (int32_t t = 0; t < w->mesh->triangle_count; t++)
        for (int i = 0; i < 3 && !w->dropped[t]; i++)
            w->triangles[t][i] = w->first_of[w->mesh->triangles[t][i]];
}

static bool repeats_vertex(const work *w, int32_t t)
{
    PEL_ASSERT_INDEX(t, w->mesh->triangle_count);
    const int32_t *v = w->triangles[t];
    return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
}

static bool is_flat(const work *w, int32_t t)
{
    PEL_ASSERT_INDEX(t, w->mesh->triangle_count);
    const int32_t *v = w->triangles[t];
    double(*positions)[3] = w->mesh->positions;
    return pel_triangle_is_flat(positions[v[0]], positions[v[1]], positions[v[2]]);
}

/* drops the triangles for which `is_bad` is true; returns their number */
static int32_t drop_triangles(work *w, bool (*is_bad)(const work *w, int32_t t))
{
    int32_t count = 0;
    for (int32_t t = 0; t < w->mesh->triangle_count; t++) {
        if (w->dropped[t] || !is_bad(w, t))
            continue;
        w->dropped[t] = 1;
        count++;
    }
    return count;
}

static bool any_flat(const work *w)
{
    for (int32_t t = 0; t < w->mesh->triangle_count; t++)
        if (!w->dropped[t] && is_flat(w, t))
            return true;
    return false;
}

static pel_status drop_duplicate_triangles(work *w)
{
    int32_t triangle_count = w->mesh->triangle_count;
    if (!w->options.drop_duplicates)
        return PEL_OK;
    int32_t *first_like = pel_allocate((size_t)triangle_count, sizeof *first_like);
    if (first_like == NULL)
        return PEL_OUT_OF_MEMORY;
    pel_status status =
        pel_find_duplicate_triangles((const int32_t(*)[3])w->triangles, triangle_count, w->dropped, first_like);
    for (int32_t t = 0; t < triangle_count && status == PEL_OK; t++) {
        if (first_like[t] < 0 || first_like[t] == t)
            continue;
        w->dropped[t] = 1;
        w->summary.duplicate_triangles++;
    }
    pel_free(first_like);
    return status;
}

static void turn_triangle(work *w, int32_t t)
{
    PEL_ASSERT_INDEX(t, w->mesh->triangle_count);
    int32_t second = w->triangles[t][1];
    w->triangles[t][1] = w->triangles[t][2];
    w->triangles[t][2] = second;
    w->turned[t] ^= 1;
}

/* of a vertex or a copy of one */
static const double *position_of(const work *w, int32_t v)
{
    int32_t copy = v - w->mesh->vertex_count;
    return w->mesh->positions[copy >= 0 ? w->cut.source_of[copy] : v];
}

/* properties of a patch */
typedef struct patch {
    int32_t triangle_count, flipped_count, first_triangle;
    bool open, inward;
    double volume, area;
} patch;

static int32_t total_vertex_count(const work *w)
{
    return w->mesh->vertex_count + w->cut.copy_count;
}

static patch *allocate_patches(const work *w, const pel_patches *patches)
{
    patch *all = pel_allocate((size_t)patches->patch_count, sizeof *all);
    for (int32_t t = 0; all != NULL && t < w->mesh->triangle_count; t++) {
        if (patches->patch_of_triangle[t] < 0)
            continue;
        patch *one = &all[patches->patch_of_triangle[t]];
        if (one->triangle_count == 0)
            one->first_triangle = t;
        one->triangle_count++;
        one->flipped_count += patches->flipped[t];
    }
    return all;
}

/* turns the smaller part of each patch */
static void make_consistent(work *w, const pel_patches *patches, patch *all)
{
    for (int32_t t = 0; t < w->mesh->triangle_count; t++) {
        int32_t p = patches->patch_of_triangle[t];
        if (p < 0 || patches->non_orientable[p])
            continue;
        bool turn_flipped = 2 * (int64_t)all[p].flipped_count <= all[p].triangle_count;
        if (patches->flipped[t] == turn_flipped)
            turn_triangle(w, t);
    }
    w->summary.non_orientable = 0;
    for (int32_t p = 0; p < patches->patch_count; p++)
        w->summary.non_orientable += patches->non_orientable[p];
}

/* area and volume of each patch about its first vertex, and whether all its edges have two triangles */
static void measure_patches(const work *w, const pel_patches *patches, const pel_edge_table *edges, patch *all)
{
    for (int32_t t = 0; t < w->mesh->triangle_count; t++) {
        if (patches->patch_of_triangle[t] < 0)
            continue;
        patch *one = &all[patches->patch_of_triangle[t]];
        const int32_t *v = w->triangles[t];
        const double *first = position_of(w, v[0]);
        double normal[3], arm[3];
        pel_vec3_triangle_normal(first, position_of(w, v[1]), position_of(w, v[2]), normal);
        pel_vec3_subtract(first, position_of(w, w->triangles[one->first_triangle][0]), arm);
        one->volume += pel_vec3_dot(normal, arm) / 6;
        one->area += pel_vec3_length(normal) / 2;
        for (int32_t h = 3 * t; h < 3 * t + 3; h++)
            if (pel_edge_table_valence(edges, edges->edge_of_half_edge[h]) != 2)
                one->open = true;
    }
}

/* turns closed patches of negative volume as a whole, rounding of flat ones aside */
static void turn_outward(work *w, const pel_patches *patches, patch *all)
{
    for (int32_t p = 0; p < patches->patch_count; p++) {
        bool consistent = !patches->non_orientable[p] && (w->options.orient || all[p].flipped_count == 0);
        all[p].inward = consistent && !all[p].open && all[p].volume < -1e-12 * all[p].area * sqrt(all[p].area);
        w->summary.outward_components += all[p].inward;
    }
    for (int32_t t = 0; t < w->mesh->triangle_count; t++)
        if (patches->patch_of_triangle[t] >= 0 && all[patches->patch_of_triangle[t]].inward)
            turn_triangle(w, t);
}

static void count_turned(work *w)
{
    for (int32_t t = 0; t < w->mesh->triangle_count; t++)
        w->summary.turned_triangles += !w->dropped[t] && w->turned[t] && !w->flipped[t];
}

/* one winding per patch; outward: then closed patches turned outward */
static pel_status orient(work *w, bool outward)
{
    pel_edge_table edges = {0};
    pel_patches patches = {0};
    patch *all = NULL;
    int32_t triangle_count = w->mesh->triangle_count;
    const int32_t(*triangles)[3] = (const int32_t(*)[3])w->triangles;
    if (!w->options.orient && !outward)
        return PEL_OK;
    pel_status status = pel_edge_table_build(triangles, triangle_count, total_vertex_count(w), w->dropped, &edges);
    if (status == PEL_OK)
        status = pel_patches_build(triangles, triangle_count, &edges, &patches);
    if (status == PEL_OK) {
        all = allocate_patches(w, &patches);
        status = all != NULL ? PEL_OK : PEL_OUT_OF_MEMORY;
    }
    if (status == PEL_OK && w->options.orient)
        make_consistent(w, &patches, all);
    if (status == PEL_OK && outward) {
        measure_patches(w, &patches, &edges, all);
        turn_outward(w, &patches, all);
    }
    pel_free(all);
    pel_patches_clear(&patches);
    pel_edge_table_clear(&edges);
    return status;
}

/* triangles without area: merged into their neighbours if they would leave a slit, otherwise dropped */
static pel_status drop_flat_triangles(work *w)
{
    pel_status status = PEL_OK;
    if (!w->options.drop_degenerate || !any_flat(w))
        return PEL_OK;
    if (w->options.close_slits) {
        status = orient(w, false);
        if (status == PEL_OK)
            status = pel_slits_close((const double(*)[3])w->mesh->positions, w->mesh->vertex_count, w->triangles,
                                     w->mesh->triangle_count, w->dropped, w->flipped, &w->summary.closed_slits);
    }
    w->summary.degenerate_triangles += drop_triangles(w, is_flat);
    return status == PEL_OK ? drop_duplicate_triangles(w) : status;
}

/* the first triangle of the part of each triangle, and the number of triangles of that part at sizes[first] */
static pel_status find_parts(const work *w, int32_t *first_of_part, int32_t *sizes)
{
    int32_t triangle_count = w->mesh->triangle_count;
    pel_edge_table edges = {0};
    pel_status status = pel_edge_table_build((const int32_t(*)[3])w->triangles, triangle_count, w->mesh->vertex_count,
                                             w->dropped, &edges);
    pel_union_find_reset(first_of_part, triangle_count);
    for (int32_t e = 0; e < edges.edge_count; e++) {
        int32_t first = edges.half_edge_of_edge[e];
        for (int32_t h = edges.next_in_edge[first]; h >= 0; h = edges.next_in_edge[h])
            pel_union_find_join(first_of_part, first / 3, h / 3);
    }
    pel_edge_table_clear(&edges);
    for (int32_t t = 0; t < triangle_count; t++) {
        first_of_part[t] = pel_union_find_root(first_of_part, t);
        if (!w->dropped[t])
            sizes[first_of_part[t]]++;
    }
    return status;
}

/* drops parts of few triangles; lost: vertices that no other triangle has */
static void drop_marked_parts(work *w, const int32_t *first_of_part, const int32_t *sizes, int32_t largest,
                              uint8_t *lost)
{
    for (int32_t t = 0; t < w->mesh->triangle_count; t++) {
        int32_t part = first_of_part[t];
        if (w->dropped[t] || part == largest || sizes[part] > w->options.drop_parts)
            continue;
        w->dropped[t] = 1;
        w->summary.dropped_parts += part == t;
        for (int i = 0; i < 3; i++)
            lost[w->triangles[t][i]] = 1;
    }
    for (int32_t t = 0; t < w->mesh->triangle_count; t++)
        for (int i = 0; i < 3 && !w->dropped[t]; i++)
            lost[w->triangles[t][i]] = 0;
}

/* such as stray pieces of a scan */
static pel_status drop_small_parts(work *w)
{
    size_t vertex_count = (size_t)w->mesh->vertex_count, triangle_count = (size_t)w->mesh->triangle_count;
    int32_t largest = 0;
    if (w->options.drop_parts == 0)
        return PEL_OK;
    int32_t *first_of_part = pel_allocate(triangle_count, sizeof *first_of_part),
            *sizes = pel_allocate(triangle_count, sizeof *sizes);
    uint8_t *lost = pel_allocate(vertex_count, 1);
    pel_status status = first_of_part != NULL && sizes != NULL && lost != NULL ? find_parts(w, first_of_part, sizes)
                                                                               : PEL_OUT_OF_MEMORY;
    if (status == PEL_OK) {
        for (int32_t t = 0; t < w->mesh->triangle_count; t++)
            if (sizes[t] > sizes[largest])
                largest = t;
        drop_marked_parts(w, first_of_part, sizes, largest, lost);
        for (size_t v = 0; v < vertex_count && w->options.drop_isolated; v++)
            w->summary.isolated_vertices -= lost[v];
    }
    PEL_FREE_ALL(first_of_part, sizes, lost);
    return status;
}

/* split non-manifold vertices and edges */
static pel_status cut_apart(work *w)
{
    if (!w->options.cut)
        return PEL_OK;
    /* which triangles face each other is known by their winding */
    pel_status status = orient(w, false);
    if (status == PEL_OK)
        status = pel_cut_find((const double(*)[3])w->mesh->positions, w->mesh->vertex_count,
                              (const int32_t(*)[3])w->triangles, w->mesh->triangle_count, w->dropped, &w->cut);
    if (status != PEL_OK)
        return status;
    for (int32_t t = 0; t < w->mesh->triangle_count; t++)
        memcpy(w->triangles[t], w->cut.corners + 3 * t, sizeof w->triangles[t]);
    w->summary.cut_vertices = w->cut.copy_count;
    return PEL_OK;
}

/* fills new_number and the counts; copies come last */
static void number_vertices(work *w)
{
    memset(w->new_number, -1, (size_t)total_vertex_count(w) * sizeof *w->new_number);
    for (int32_t t = 0; t < w->mesh->triangle_count; t++) {
        if (w->dropped[t])
            continue;
        w->triangle_count++;
        for (int i = 0; i < 3; i++)
            w->new_number[w->triangles[t][i]] = 0;
    }
    for (int32_t v = 0; v < w->mesh->vertex_count; v++) {
        bool used = w->new_number[v] == 0;
        if (w->first_of[v] != v) {
            w->new_number[v] = w->new_number[w->first_of[v]];
        } else if (used || (!w->options.drop_isolated && finite_vertex(w->mesh, v))) {
            w->new_number[v] = w->vertex_count++;
        } else {
            w->summary.isolated_vertices++;
        }
    }
    for (int32_t v = w->mesh->vertex_count; v < total_vertex_count(w); v++)
        w->new_number[v] = w->vertex_count++;
}

/* the vertex of the mesh that vertex v of the work is written from; -1 = it is not written */
static int32_t written_from(const work *w, int32_t v)
{
    if (v >= w->mesh->vertex_count)
        return w->cut.source_of[v - w->mesh->vertex_count];
    return w->first_of[v] == v && w->new_number[v] >= 0 ? v : -1;
}

static pel_status copy_field(const work *w, const pel_field *field, pel_mesh *mesh, pel_error *error)
{
    size_t width = (size_t)field->component_count;
    double *values = pel_allocate((size_t)w->vertex_count * width, sizeof *values);
    if (values == NULL)
        return pel_fail_memory(error);
    for (int32_t v = 0; v < total_vertex_count(w); v++) {
        int32_t from = written_from(w, v);
        if (from >= 0)
            memcpy(values + (size_t)w->new_number[v] * width, field->values + (size_t)from * width,
                   width * sizeof *values);
    }
    pel_status status = pel_mesh_add_field(mesh, field->name, field->component_count, values, error);
    pel_free(values);
    return status;
}

static pel_status write_mesh(const work *w, pel_mesh **repaired, pel_error *error)
{
    pel_mesh *mesh = pel_mesh_allocate(w->vertex_count, w->triangle_count);
    if (mesh == NULL)
        return pel_fail_memory(error);
    for (int32_t v = 0; v < total_vertex_count(w); v++) {
        int32_t from = written_from(w, v);
        if (from >= 0)
            pel_vec3_copy(w->mesh->positions[from], mesh->positions[w->new_number[v]]);
    }
    for (int32_t t = 0, kept = 0; t < w->mesh->triangle_count; t++) {
        if (w->dropped[t])
            continue;
        for (int i = 0; i < 3; i++)
            mesh->triangles[kept][i] = w->new_number[w->triangles[t][i]];
        kept++;
    }
    for (int32_t f = 0; f < w->mesh->field_count; f++) {
        pel_status status = copy_field(w, &w->mesh->fields[f], mesh, error);
        if (status != PEL_OK) {
            pel_mesh_destroy(mesh);
            return status;
        }
    }
    *repaired = mesh;
    return PEL_OK;
}

static pel_status mark(work *w)
{
    drop_bad_triangles(w);
    pel_status status = weld(w);
    if (status != PEL_OK)
        return status;
    weld_triangles(w);
    if (w->options.drop_degenerate)
        w->summary.degenerate_triangles += drop_triangles(w, repeats_vertex);
    status = drop_duplicate_triangles(w);
    if (status == PEL_OK)
        status = drop_flat_triangles(w);
    if (status == PEL_OK)
        status = drop_small_parts(w);
    if (status == PEL_OK)
        status = cut_apart(w);
    if (status == PEL_OK)
        status = orient(w, w->options.outward);
    if (status != PEL_OK)
        return status;
    count_turned(w);
    w->new_number = pel_allocate((size_t)total_vertex_count(w), sizeof *w->new_number);
    if (w->new_number == NULL)
        return PEL_OUT_OF_MEMORY;
    number_vertices(w);
    return PEL_OK;
}

static pel_status repair(work *w, pel_mesh **repaired, pel_error *error)
{
    size_t vertex_count = (size_t)w->mesh->vertex_count, triangle_count = (size_t)w->mesh->triangle_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(w->triangles, triangle_count), PEL_ROOM(w->dropped, triangle_count),
                          PEL_ROOM(w->turned, triangle_count), PEL_ROOM(w->flipped, triangle_count),
                          PEL_ROOM(w->first_of, vertex_count)) ||
        mark(w) != PEL_OK)
        return pel_fail_memory(error);
    if (w->triangle_count == 0)
        return pel_refuse(error, PEL_BAD_MESH,
                          "check the file and its unit: every triangle has a bad vertex or no area",
                          "no triangle is left after repair (%d bad, %d degenerate)", (int)w->summary.bad_triangles,
                          (int)w->summary.degenerate_triangles);
    return write_mesh(w, repaired, error);
}

/* vertices that were welded may have been cut again */
static bool same_mesh(const pel_mesh *a, const pel_mesh *b)
{
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           memcmp(a->positions, b->positions, (size_t)a->vertex_count * sizeof *a->positions) == 0 &&
           memcmp(a->triangles, b->triangles, (size_t)a->triangle_count * sizeof *a->triangles) == 0;
}

pel_status pel_mesh_repair(const pel_mesh *mesh, const pel_repair_options *options, pel_mesh **repaired,
                           pel_repair_summary *summary, pel_error *error)
{
    PEL_REFUSE_NULL(mesh, error);
    PEL_REFUSE_NULL(repaired, error);
    work w = {.mesh = mesh, .options = options != NULL ? *options : pel_repair_options_default()};
    *repaired = NULL;
    if (mesh->vertex_count < 1 || mesh->triangle_count < 1 || mesh->triangle_count > INT32_MAX / 3)
        return pel_fail(error, PEL_BAD_ARGUMENT, "mesh has %d vertices and %d triangles; nothing can be repaired",
                        (int)mesh->vertex_count, (int)mesh->triangle_count);
    double tolerance = w.options.weld_tolerance;
    if (!pel_weld_tolerance_allowed((const double(*)[3])mesh->positions, mesh->vertex_count, tolerance))
        return pel_refuse(error, PEL_BAD_ARGUMENT,
                          "give 0 for exactly equal positions, or a length well below the shortest edge to be kept",
                          "weld tolerance is %g", tolerance);
    if (w.options.drop_parts < 0)
        return pel_refuse(error, PEL_BAD_ARGUMENT,
                          "give the number of triangles of the largest part to be dropped, or 0", "drop_parts is %d",
                          (int)w.options.drop_parts);
    pel_status status = repair(&w, repaired, error);
    if (status == PEL_OK && w.options.vertex_map != NULL)
        memcpy(w.options.vertex_map, w.new_number, (size_t)mesh->vertex_count * sizeof(int32_t));
    if (status == PEL_OK && summary != NULL) {
        *summary = w.summary;
        summary->changed = !same_mesh(mesh, *repaired);
    }
    PEL_FREE_ALL(w.triangles, w.dropped, w.turned, w.flipped);
    pel_cut_clear(&w.cut);
    pel_free(w.first_of);
    pel_free(w.new_number);
    return status;
}
