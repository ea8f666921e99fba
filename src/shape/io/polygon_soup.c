#include "io/polygon_soup.h"

#include "base/memory.h"
#include "base/patience.h"
#include "base/room.h"
#include "geom/polygon.h"
#include "mesh/weld.h"

#include <string.h>

void pel_polygon_soup_init(pel_polygon_soup *builder, int32_t index_base)
{
    memset(builder, 0, sizeof *builder);
    builder->index_base = index_base;
    builder->largest_corner = -1;
}

void pel_polygon_soup_free(pel_polygon_soup *builder)
{
    PEL_FREE_ALL(builder->positions, builder->corners, builder->sizes);
    pel_polygon_soup_init(builder, builder->index_base);
}

/* pel_reserve for typed arrays, without aliasing a pointer of another type */
#define RESERVE(array, capacity, needed) reserve_typed(&(array), sizeof(array), &(capacity), needed, sizeof *(array))

static bool reserve_typed(void *array_place, size_t pointer_size, size_t *capacity, size_t needed, size_t size)
{
    void *block;
    memcpy(&block, array_place, pointer_size);
    bool grown = pel_reserve(&block, capacity, needed, size) != 0;
    memcpy(array_place, &block, pointer_size);
    return grown;
}

bool pel_polygon_soup_reserve_vertices(pel_polygon_soup *builder, size_t count)
{
    return RESERVE(builder->positions, builder->vertex_capacity, count);
}

bool pel_polygon_soup_add_vertex(pel_polygon_soup *builder, const double position[3])
{
    bool is_full = builder->vertex_count == builder->vertex_capacity;
    if ((is_full && !pel_polygon_soup_reserve_vertices(builder, builder->vertex_count + 1)) || pel_patience_is_lost())
        return false;
    memcpy(builder->positions[builder->vertex_count++], position, sizeof *builder->positions);
    return true;
}

static bool reserve_corners(pel_polygon_soup *builder, size_t more)
{
    const size_t needed = builder->corner_count + more;
    return needed <= builder->corner_capacity || RESERVE(builder->corners, builder->corner_capacity, needed);
}

static void put_corner(pel_polygon_soup *builder, int32_t vertex, const char *place)
{
    builder->corners[builder->corner_count++] = vertex;
    if (vertex > builder->largest_corner) {
        builder->largest_corner = vertex;
        builder->largest_place = place;
    }
}

bool pel_polygon_soup_add_corner(pel_polygon_soup *builder, int32_t vertex, const char *place)
{
    if (!reserve_corners(builder, 1))
        return false;
    put_corner(builder, vertex, place);
    return true;
}

bool pel_polygon_soup_add_triangle(pel_polygon_soup *builder, const int32_t vertices[3], const char *place)
{
    if (!reserve_corners(builder, 3))
        return false;
    for (int i = 0; i < 3; i++)
        put_corner(builder, vertices[i], place);
    return pel_polygon_soup_end_polygon(builder, 3);
}

bool pel_polygon_soup_end_polygon(pel_polygon_soup *builder, size_t corner_count)
{
    if (corner_count < 3 || corner_count > INT32_MAX) {
        builder->corner_count -= corner_count;
        builder->ignored_count++;
        return true;
    }
    bool is_full = builder->polygon_count == builder->polygon_capacity;
    if ((is_full && !RESERVE(builder->sizes, builder->polygon_capacity, builder->polygon_count + 1)) ||
        pel_patience_is_lost())
        return false;
    builder->sizes[builder->polygon_count++] = (int32_t)corner_count;
    return true;
}

bool pel_polygon_soup_add_loose_corner(pel_polygon_soup *builder, const double position[3], const char *place)
{
    const size_t vertex = builder->vertex_count;
    return vertex < INT32_MAX && pel_polygon_soup_add_vertex(builder, position) &&
           pel_polygon_soup_add_corner(builder, (int32_t)vertex, place);
}

static bool same_place(const double p[3], const double q[3])
{
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

bool pel_polygon_soup_end_loose_polygon(pel_polygon_soup *builder, size_t corner_count)
{
    const double(*corners)[3] = (const double(*)[3])builder->positions + (builder->vertex_count - corner_count);
    bool dropped = corner_count == 3 && (same_place(corners[0], corners[1]) || same_place(corners[1], corners[2]) ||
                                         same_place(corners[2], corners[0]));
    if (dropped || corner_count < 3)
        builder->vertex_count -= corner_count;
    if (!dropped)
        return pel_polygon_soup_end_polygon(builder, corner_count);
    builder->corner_count -= corner_count;
    builder->dropped_count++;
    return true;
}

pel_status pel_polygon_soup_weld(pel_polygon_soup *builder, const pel_log *log, pel_error *error)
{
    const size_t count = builder->vertex_count;
    int32_t place_count = 0, *index_of = pel_allocate(count, sizeof *index_of);
    if (index_of == NULL ||
        pel_weld_points((const double(*)[3])builder->positions, (int32_t)count, 0, index_of, &place_count) != PEL_OK) {
        pel_free(index_of);
        return pel_fail_memory(error);
    }
    /* the first vertex of a place never stands before the place's number */
    int32_t first = 0;
    for (size_t v = 0; v < count; v++)
        if (index_of[v] == first)
            memmove(builder->positions[first++], builder->positions[v], sizeof *builder->positions);
    for (size_t i = 0; i < builder->corner_count; i++)
        builder->corners[i] = index_of[builder->corners[i]];
    pel_free(index_of);
    builder->vertex_count = (size_t)place_count;
    builder->largest_corner = place_count - 1;
    if (count > builder->vertex_count)
        pel_log_line(log, "%zu corners welded into %zu vertices", count, builder->vertex_count);
    return PEL_OK;
}

static pel_status check_counts(const pel_polygon_soup *builder, const pel_text_cursor *scan, pel_error *error)
{
    const size_t vertex_count = builder->vertex_count;
    if (builder->polygon_count == 0) {
        pel_fail(error, PEL_BAD_FORMAT, "the file has %zu vertices and no triangles", vertex_count);
        pel_fail_remedy(error, "export the surface with its faces; point clouds and curves cannot be used");
        pel_fail_place(error, scan->name, 0, 0);
        return PEL_BAD_FORMAT;
    }
    if (builder->largest_corner >= (int64_t)vertex_count)
        return pel_text_cursor_fail(
            scan, builder->largest_place, error, "correct the index or add the missing vertices",
            "a face uses vertex %lld but the file has %zu vertices, numbered from %d",
            (long long)builder->largest_corner + builder->index_base, vertex_count, (int)builder->index_base);
    /* every polygon yields two triangles less than it has corners */
    if (vertex_count > INT32_MAX || builder->corner_count - 2 * builder->polygon_count > INT32_MAX)
        return pel_text_cursor_fail(scan, scan->end, error, "split the mesh into smaller parts",
                                    "the file has more than %d vertices or triangles", (int)INT32_MAX);
    return PEL_OK;
}

/* replaces the corners by triangles */
static bool cut_polygons(pel_polygon_soup *builder, size_t triangle_count, const pel_log *log)
{
    int32_t(*triangles)[3] = pel_allocate(triangle_count, sizeof *triangles);
    if (triangles == NULL)
        return false;
    const int32_t *corners = builder->corners;
    size_t made = 0, cut = 0;
    for (size_t i = 0; i < builder->polygon_count; i++) {
        const int32_t size = builder->sizes[i];
        pel_polygon_cut((const double(*)[3])builder->positions, corners, size, triangles + made);
        corners += size;
        made += (size_t)size - 2;
        cut += size > 3;
    }
    pel_free(builder->corners);
    builder->corners = (int32_t *)triangles;
    pel_log_line(log, "%zu faces with more than three corners cut into %zu triangles", cut,
                 triangle_count - (builder->polygon_count - cut));
    return true;
}

pel_status pel_polygon_soup_finish(pel_polygon_soup *builder, const pel_text_cursor *scan, const pel_log *log,
                                   pel_mesh **mesh, pel_error *error)
{
    pel_status status = check_counts(builder, scan, error);
    if (status != PEL_OK)
        return status;
    if (builder->ignored_count > 0)
        pel_log_line(log, "%zu faces with fewer than three corners ignored", builder->ignored_count);
    if (builder->dropped_count > 0)
        pel_log_line(log, "%zu triangles with equal corners dropped", builder->dropped_count);
    const size_t triangle_count = builder->corner_count - 2 * builder->polygon_count;
    pel_mesh *made = pel_allocate(1, sizeof *made);
    if (made == NULL || (triangle_count != builder->polygon_count && !cut_polygons(builder, triangle_count, log))) {
        pel_free(made);
        return pel_fail_memory(error);
    }
    made->vertex_count = (int32_t)builder->vertex_count;
    made->triangle_count = (int32_t)triangle_count;
    made->positions = builder->positions;
    made->triangles = (int32_t(*)[3])builder->corners;
    builder->positions = NULL;
    builder->corners = NULL;
    pel_polygon_soup_free(builder);
    *mesh = made;
    return PEL_OK;
}
