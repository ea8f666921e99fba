#include "refined/shell_front.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/vec3.h"

#include <string.h>

/* ---- creation ---- */

static bool allocate_regions(pel_shell_front *own)
{
    const pel_shell *given = own->given;
    pel_shell *shell = &own->shell;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(shell->regions, given->region_count),
                          PEL_ROOM(own->fibre_of_triangle, given->region_count)))
        return false;
    for (int32_t r = 0; r < given->region_count; r++) {
        pel_shell_region *region = &shell->regions[r];
        *region = given->regions[r];
        region->fibre_limit = region->fibre_count > 0 ? shell->triangle_limit : 0;
        size_t limit = (size_t)region->fibre_limit;
        int32_t **fibre_of = &own->fibre_of_triangle[r];
        if (!PEL_ALLOCATE_ALL(PEL_ROOM(region->triangles, limit), PEL_ROOM(region->weights, limit),
                              PEL_ROOM(region->directions, limit), PEL_ROOM(*fibre_of, given->triangle_count)))
            return false;
        memset(*fibre_of, -1, (size_t)given->triangle_count * sizeof **fibre_of);
        for (int32_t i = 0; i < region->fibre_count; i++)
            (*fibre_of)[pel_shell_fibre_triangle(&given->regions[r], i)] = i;
    }
    return true;
}

static bool allocate_shell(pel_shell_front *own)
{
    const pel_shell *given = own->given;
    pel_shell *shell = &own->shell;
    size_t triangles = (size_t)shell->triangle_limit, hinges = (size_t)shell->hinge_limit;
    /* of each triangle for mid-edge elements; hinges look them up in the given shell */
    bool has_parts = shell->bending->turns_edges && given->parts != NULL;
    shell->regions = NULL;
    bool room = PEL_ALLOCATE_ALL(PEL_ROOM(own->corners, triangles), PEL_ROOM(shell->rests, triangles),
                                 PEL_ROOM(shell->hinge_sides, hinges), PEL_ROOM(shell->rest_angles, hinges),
                                 PEL_ROOM_IF(given->sheets != NULL, shell->sheets, triangles),
                                 PEL_ROOM_IF(given->axes != NULL, shell->axes, triangles),
                                 PEL_ROOM_IF(given->pressure_weights != NULL, shell->pressure_weights, triangles),
                                 PEL_ROOM_IF(has_parts, shell->parts, triangles),
                                 PEL_ROOM_IF(given->hinge_stiffnesses != NULL, shell->hinge_stiffnesses, hinges));
    shell->corners = (const int32_t(*)[3])own->corners;
    return room && allocate_regions(own);
}

static bool allocate_scratch(pel_shell_front *own)
{
    size_t triangles = (size_t)own->shell.triangle_limit, base = (size_t)own->given->triangle_count;
    return PEL_ALLOCATE_ALL(PEL_ROOM(own->hinge_of_half_edge, 3 * base), PEL_ROOM(own->surface, triangles),
                            PEL_ROOM(own->base_of_triangle, triangles), PEL_ROOM(own->is_base, triangles),
                            PEL_ROOM(own->begin, (size_t)own->place_count + 2),
                            PEL_ROOM(own->half_edges, 3 * triangles));
}

static void find_hinges(pel_shell_front *own)
{
    const pel_shell *given = own->given;
    memset(own->hinge_of_half_edge, -1, 3 * (size_t)given->triangle_count * sizeof *own->hinge_of_half_edge);
    for (int32_t i = 0; i < given->hinge_count; i++)
        own->hinge_of_half_edge[given->hinge_sides[i][0]] = i;
}

pel_status pel_shell_front_create(const pel_body *given, const pel_body *body, const int32_t (*corners)[3],
                                  int32_t place_limit, int32_t triangle_limit, pel_shell_front **made, pel_error *error)
{
    *made = NULL;
    pel_shell_front *own = pel_allocate(1, sizeof *own);
    if (own == NULL)
        return pel_fail_memory(error);
    own->given = given->shell;
    own->shell = *given->shell;
    own->shell.corners = corners;
    own->refines = body->front != NULL;
    *made = own;
    if (!own->refines)
        return PEL_OK;
    own->first_place = body->slice_begin * PEL_WIDTH;
    own->place_count = place_limit - own->first_place;
    own->shell.triangle_limit = triangle_limit;
    /* each triangle has three sides, and each hinge two triangles */
    own->shell.hinge_limit = pel_bending_is_on(given->shell->bending) ? triangle_limit / 2 * 3 + 3 : 0;
    own->shell.triangle_count = own->shell.hinge_count = 0;
    bool room = allocate_shell(own);
    if (!room || !allocate_scratch(own)) {
        pel_shell_front_destroy(own);
        *made = NULL;
        return pel_fail_memory(error);
    }
    find_hinges(own);
    return PEL_OK;
}

static void clear_regions(pel_shell_front *own)
{
    for (int32_t r = 0; r < own->given->region_count; r++) {
        if (own->shell.regions != NULL) {
            PEL_FREE_ALL(own->shell.regions[r].triangles, own->shell.regions[r].weights,
                         own->shell.regions[r].directions);
        }
        if (own->fibre_of_triangle != NULL)
            pel_free(own->fibre_of_triangle[r]);
    }
}

void pel_shell_front_destroy(pel_shell_front *own)
{
    if (own == NULL)
        return;
    /* else the arrays are the given shell's */
    if (own->refines) {
        pel_shell *shell = &own->shell;
        clear_regions(own);
        PEL_FREE_ALL(own->corners, shell->rests, shell->sheets, shell->axes, shell->parts, shell->hinge_sides,
                     shell->hinge_stiffnesses, shell->rest_angles, shell->regions, shell->pressure_weights,
                     own->fibre_of_triangle, own->hinge_of_half_edge, own->surface, own->base_of_triangle, own->is_base,
                     own->begin, own->half_edges);
    }
    pel_free(own);
}

/* ---- update ---- */

static void load_rest(const pel_front *front, const int32_t *vertices, int count, double x[][3])
{
    for (int k = 0; k < count; k++)
        pel_vec3_copy(front->forest->rest_positions[vertices[k]], x[k]);
}

/* the warp of a triangle of the mesh, in the frame of a finer one at x */
static void turn_axis(const pel_shell *given, int32_t base, const double x[3][3], double axis[PEL_LAW_AXIS])
{
    double corners[3][3], along[3];
    for (int k = 0; k < 3; k++)
        pel_vec3_copy(given->mesh->positions[given->mesh->triangles[base][k]], corners[k]);
    pel_shell_warp(given, base, (const double(*)[3])corners, along);
    pel_rest_triangle_direction(x, along, axis);
}

static void update_triangles(pel_shell_front *own, const pel_front *front, const int32_t *model_index)
{
    pel_shell *shell = &own->shell;
    pel_front_surface(front, own->surface);
    shell->triangle_count = front->triangle_count;
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        const pel_front_triangle *face = &own->surface[t];
        int32_t level = pel_front_level(front, face->node);
        int32_t base = own->base_of_triangle[t] = (face->node - front->node_begin[level]) >> (2 * level);
        if (own->shell.parts != NULL)
            own->shell.parts[t] = own->given->parts[base];
        own->is_base[t] = level == 0 && front->shapes[face->node] == PEL_FRONT_WHOLE;
        double x[3][3];
        load_rest(front, face->vertices, 3, x);
        pel_rest_triangle_setup((const double(*)[3])x, &shell->rests[t]);
        for (int k = 0; k < 3; k++)
            own->corners[t][k] = model_index[face->vertices[k]];
        if (shell->axes != NULL)
            turn_axis(own->given, base, (const double(*)[3])x, shell->axes[t]);
        if (shell->sheets != NULL)
            shell->sheets[t] = own->given->sheets[base];
        if (shell->pressure_weights != NULL)
            shell->pressure_weights[t] = own->given->pressure_weights[base];
    }
}

static void update_region(pel_shell_front *own, const pel_front *front, int32_t r)
{
    const pel_shell_region *given = &own->given->regions[r];
    pel_shell_region *region = &own->shell.regions[r];
    region->fibre_count = 0;
    for (int32_t t = 0; given->fibre_count > 0 && t < own->shell.triangle_count; t++) {
        int32_t i = own->fibre_of_triangle[r][own->base_of_triangle[t]];
        if (i < 0)
            continue;
        int32_t fibre = region->fibre_count++;
        double x[3][3];
        load_rest(front, own->surface[t].vertices, 3, x);
        region->triangles[fibre] = t;
        region->weights[fibre] = pel_shell_fibre_weight(given, i);
        pel_shell_fibre_direction(&region->def, (const double(*)[3])x, region->directions[fibre]);
    }
}

static int32_t origin_of(const pel_shell_front *own, int32_t h)
{
    return own->corners[h / 3][h % 3];
}

static int32_t target_of(const pel_shell_front *own, int32_t h)
{
    return own->corners[h / 3][pel_half_edge_next(h) % 3];
}

static int32_t bucket_of(const pel_shell_front *own, int32_t h)
{
    int32_t a = origin_of(own, h), b = target_of(own, h);
    return (a < b ? a : b) - own->first_place;
}

/* lists the half-edges by the lower of their places, rising within each */
static void sort_half_edges(pel_shell_front *own)
{
    int32_t count = 3 * own->shell.triangle_count, *begin = own->begin;
    memset(begin, 0, ((size_t)own->place_count + 2) * sizeof *begin);
    for (int32_t h = 0; h < count; h++)
        begin[bucket_of(own, h) + 2]++;
    for (int32_t i = 0; i < own->place_count; i++)
        begin[i + 2] += begin[i + 1];
    for (int32_t h = 0; h < count; h++)
        own->half_edges[begin[bucket_of(own, h) + 1]++] = h;
}

/* the other half-edge of an edge, -1 on the boundary */
static int32_t twin_of(const pel_shell_front *own, int32_t h)
{
    int32_t bucket = bucket_of(own, h);
    for (int32_t i = own->begin[bucket]; i < own->begin[bucket + 1]; i++) {
        int32_t other = own->half_edges[i];
        if (origin_of(own, other) == target_of(own, h) && target_of(own, other) == origin_of(own, h))
            return other;
    }
    return -1;
}

/* adds a hinge */
static void put_hinge(pel_shell *shell, int32_t h, int32_t twin, double rest_angle, double stiffness)
{
    int32_t i = shell->hinge_count++;
    shell->hinge_sides[i][0] = h;
    shell->hinge_sides[i][1] = twin;
    shell->rest_angles[i] = rest_angle;
    if (shell->hinge_stiffnesses != NULL)
        shell->hinge_stiffnesses[i] = stiffness;
}

/* adds a hinge of the base as given; false if there is none */
static bool copy_hinge(pel_shell_front *own, int32_t h, int32_t twin)
{
    int32_t i = own->hinge_of_half_edge[3 * own->base_of_triangle[h / 3] + h % 3];
    if (i < 0)
        return false;
    put_hinge(&own->shell, h, twin, pel_shell_rest_angle(own->given, i), pel_shell_hinge_stiffness(own->given, i));
    return true;
}

static void make_hinge(pel_shell_front *own, const pel_front *front, int32_t h, int32_t twin)
{
    const int32_t corners[4] = {h, pel_half_edge_next(h), pel_half_edge_previous(h), pel_half_edge_previous(twin)};
    double x[4][3];
    for (int k = 0; k < 4; k++)
        pel_vec3_copy(front->forest->rest_positions[own->surface[corners[k] / 3].vertices[corners[k] % 3]], x[k]);
    pel_hinge stencil;
    if (!pel_hinge_setup((const double(*)[3])x, &stencil))
        return;
    const pel_shell_part_bending *parts = own->given->parts;
    const pel_shell_part_bending *left = &parts[own->base_of_triangle[h / 3]];
    const pel_shell_part_bending *right = &parts[own->base_of_triangle[twin / 3]];
    const int32_t sides[2] = {h, twin};
    double share = own->shell.axes != NULL ? pel_shell_hinge_share(&own->shell, sides) : 1;
    put_hinge(&own->shell, h, twin, stencil.rest_angle * 0.5 * (left->curl + right->curl),
              share * 0.5 * (left->stiffness + right->stiffness));
}

static void update_hinges(pel_shell_front *own, const pel_front *front)
{
    pel_shell *shell = &own->shell;
    shell->hinge_count = 0;
    if (!pel_bending_is_on(shell->bending))
        return;
    sort_half_edges(own);
    for (int32_t h = 0; h < 3 * shell->triangle_count; h++) {
        int32_t twin = twin_of(own, h);
        if (twin < h)
            continue;
        bool base = own->is_base[h / 3] && own->is_base[twin / 3];
        if (base && (copy_hinge(own, h, twin) || copy_hinge(own, twin, h)))
            continue;
        if (base)
            make_hinge(own, front, twin, h);
        else
            make_hinge(own, front, h, twin);
    }
}

void pel_shell_front_update(pel_shell_front *own, const pel_front *front, const int32_t *model_index)
{
    update_triangles(own, front, model_index);
    for (int32_t r = 0; r < own->shell.region_count; r++)
        update_region(own, front, r);
    update_hinges(own, front);
}

double pel_shell_front_rest_volume(const pel_shell_front *own, const pel_front *front)
{
    double volume = 0, x[3][3], origin[3];
    pel_vec3_copy(front->forest->rest_positions[0], origin);
    for (int32_t t = 0; t < own->shell.triangle_count; t++) {
        load_rest(front, own->surface[t].vertices, 3, x);
        volume += pel_vec3_cone_volume(origin, x[0], x[1], x[2]);
    }
    return volume;
}
