#include "model/shell_front.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/vec3.h"

#include <string.h>

/* ---- creation ---- */

static bool allocate_regions(pel_shell_front *own, bool refines)
{
    const pel_shell *given = own->given;
    pel_shell *shell = &own->shell;
    shell->regions = pel_allocate((size_t)given->region_count, sizeof *shell->regions);
    own->fibre_of_triangle = pel_allocate((size_t)given->region_count, sizeof *own->fibre_of_triangle);
    if (shell->regions == NULL || own->fibre_of_triangle == NULL)
        return false;
    for (int32_t r = 0; r < given->region_count; r++) {
        pel_shell_region *region = &shell->regions[r];
        *region = given->regions[r];
        if (refines && region->fibre_count > 0)
            region->fibre_limit = shell->triangle_limit;
        region->fibres = pel_allocate((size_t)region->fibre_limit, sizeof *region->fibres);
        if (region->fibres == NULL)
            return false;
        if (!refines)
            continue;
        int32_t *fibre_of = own->fibre_of_triangle[r] =
            pel_allocate((size_t)given->triangle_count, sizeof *own->fibre_of_triangle[r]);
        if (fibre_of == NULL)
            return false;
        memset(fibre_of, -1, (size_t)given->triangle_count * sizeof *fibre_of);
        for (int32_t i = 0; i < region->fibre_count; i++)
            fibre_of[given->regions[r].fibres[i].triangle] = i;
    }
    return true;
}

static bool allocate_shell(pel_shell_front *own, bool refines)
{
    pel_shell *shell = &own->shell;
    size_t triangles = (size_t)shell->triangle_limit;
    shell->triangles = pel_allocate(triangles, sizeof *shell->triangles);
    shell->hinges = pel_allocate((size_t)shell->hinge_limit, sizeof *shell->hinges);
    bool weighted = own->given->pressure_weights != NULL;
    shell->pressure_weights = weighted ? pel_allocate(triangles, sizeof *shell->pressure_weights) : NULL;
    /* of each triangle for mid-edge elements; hinges look them up in the given shell */
    bool has_elements = shell->bending == PEL_BENDING_MIDEDGE;
    shell->parts = has_elements ? pel_allocate(triangles, sizeof *shell->parts) : NULL;
    return shell->triangles != NULL && shell->hinges != NULL && (!weighted || shell->pressure_weights != NULL) &&
           (!has_elements || shell->parts != NULL) && allocate_regions(own, refines);
}

static bool allocate_scratch(pel_shell_front *own)
{
    size_t triangles = (size_t)own->shell.triangle_limit, base = (size_t)own->given->triangle_count;
    own->hinge_of_half_edge = pel_allocate(3 * base, sizeof *own->hinge_of_half_edge);
    own->surface = pel_allocate(triangles, sizeof *own->surface);
    own->base_of_triangle = pel_allocate(triangles, sizeof *own->base_of_triangle);
    own->is_base = pel_allocate(triangles, sizeof *own->is_base);
    own->begin = pel_allocate((size_t)own->place_count + 2, sizeof *own->begin);
    own->half_edges = pel_allocate(3 * triangles, sizeof *own->half_edges);
    return own->hinge_of_half_edge != NULL && own->surface != NULL && own->base_of_triangle != NULL &&
           own->is_base != NULL && own->begin != NULL && own->half_edges != NULL;
}

/* the corner of a triangle at a place */
static int corner_at(const int32_t vertices[3], int32_t place)
{
    return vertices[0] == place ? 0 : vertices[1] == place ? 1 : 2;
}

static void find_hinges(pel_shell_front *own)
{
    const pel_shell *given = own->given;
    memset(own->hinge_of_half_edge, -1, 3 * (size_t)given->triangle_count * sizeof *own->hinge_of_half_edge);
    for (int32_t i = 0; i < given->hinge_count; i++) {
        const pel_shell_hinge *hinge = &given->hinges[i];
        int32_t t = hinge->triangles[0];
        own->hinge_of_half_edge[3 * t + corner_at(given->triangles[t].vertices, hinge->vertices[0])] = i;
    }
}

/* the given shell at the places of the active model */
static void copy_shell(pel_shell_front *own)
{
    const pel_shell *given = own->given;
    pel_shell *shell = &own->shell;
    for (int32_t t = 0; t < given->triangle_count; t++) {
        shell->triangles[t] = given->triangles[t];
        for (int k = 0; k < 3; k++)
            shell->triangles[t].vertices[k] += own->shift;
        if (shell->pressure_weights != NULL)
            shell->pressure_weights[t] = given->pressure_weights[t];
        if (shell->parts != NULL)
            shell->parts[t] = given->parts[t];
    }
    for (int32_t i = 0; i < given->hinge_count; i++) {
        shell->hinges[i] = given->hinges[i];
        for (int k = 0; k < 4; k++)
            shell->hinges[i].vertices[k] += own->shift;
    }
    for (int32_t r = 0; r < given->region_count; r++)
        for (int32_t i = 0; i < given->regions[r].fibre_count; i++)
            shell->regions[r].fibres[i] = given->regions[r].fibres[i];
}

pel_status pel_shell_front_create(const pel_body *given, const pel_body *body, int32_t shift, int32_t place_limit,
                                  int32_t triangle_limit, pel_shell_front **made, pel_error *error)
{
    *made = NULL;
    pel_shell_front *own = pel_allocate(1, sizeof *own);
    if (own == NULL)
        return pel_fail_memory(error);
    bool refines = body->front != NULL;
    own->given = given->shell;
    own->shift = shift;
    own->first_place = body->slice_begin * PEL_WIDTH;
    own->place_count = place_limit - own->first_place;
    own->shell = *given->shell;
    own->shell.triangles = NULL;
    own->shell.hinges = NULL;
    own->shell.regions = NULL;
    own->shell.pressure_weights = NULL;
    own->shell.parts = NULL;
    if (refines) {
        own->shell.triangle_limit = triangle_limit;
        /* each triangle has three sides, and each hinge two triangles */
        own->shell.hinge_limit = given->shell->bending != PEL_BENDING_OFF ? triangle_limit / 2 * 3 + 3 : 0;
    }
    if (!allocate_shell(own, refines) || (refines && !allocate_scratch(own))) {
        pel_shell_front_destroy(own);
        return pel_fail_memory(error);
    }
    copy_shell(own);
    if (refines)
        find_hinges(own);
    *made = own;
    return PEL_OK;
}

void pel_shell_front_destroy(pel_shell_front *own)
{
    if (own == NULL)
        return;
    for (int32_t r = 0; r < own->given->region_count; r++) {
        if (own->shell.regions != NULL)
            pel_free(own->shell.regions[r].fibres);
        if (own->fibre_of_triangle != NULL)
            pel_free(own->fibre_of_triangle[r]);
    }
    void *arrays[] = {own->shell.triangles,   own->shell.hinges,
                      own->shell.regions,     own->shell.pressure_weights,
                      own->fibre_of_triangle, own->hinge_of_half_edge,
                      own->surface,           own->base_of_triangle,
                      own->is_base,           own->begin,
                      own->half_edges,        own->shell.parts};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        pel_free(arrays[i]);
    pel_free(own);
}

/* ---- update ---- */

static void load_rest(const pel_front *front, const int32_t *vertices, int count, double x[][3])
{
    for (int k = 0; k < count; k++)
        pel_vec3_copy(front->forest->rest_positions[vertices[k]], x[k]);
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
        pel_shell_triangle *triangle = &shell->triangles[t];
        *triangle = own->given->triangles[base];
        for (int k = 0; k < 3; k++)
            triangle->vertices[k] = model_index[face->vertices[k]];
        if (!own->is_base[t]) {
            double x[3][3];
            load_rest(front, face->vertices, 3, x);
            pel_rest_triangle_setup((const double(*)[3])x, &triangle->rest);
        }
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
        pel_shell_fibre *fibre = &region->fibres[region->fibre_count++];
        *fibre = given->fibres[i];
        fibre->triangle = t;
        if (own->is_base[t])
            continue;
        double x[3][3];
        load_rest(front, own->surface[t].vertices, 3, x);
        pel_shell_fibre_direction(&region->def, (const double(*)[3])x, fibre->direction);
    }
}

static int32_t origin_of(const pel_shell_front *own, int32_t h)
{
    return own->shell.triangles[h / 3].vertices[h % 3];
}

static int32_t target_of(const pel_shell_front *own, int32_t h)
{
    return own->shell.triangles[h / 3].vertices[pel_half_edge_next(h) % 3];
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

/* a hinge of the base as it was given; false when there is none there */
static bool copy_hinge(const pel_shell_front *own, int32_t h, pel_shell_hinge *hinge)
{
    int32_t i = own->hinge_of_half_edge[3 * own->base_of_triangle[h / 3] + h % 3];
    if (i < 0)
        return false;
    *hinge = own->given->hinges[i];
    for (int k = 0; k < 4; k++)
        hinge->vertices[k] += own->shift;
    return true;
}

static bool make_hinge(const pel_shell_front *own, const pel_front *front, int32_t h, int32_t twin,
                       pel_shell_hinge *hinge)
{
    const int32_t corners[4] = {h, pel_half_edge_next(h), pel_half_edge_previous(h), pel_half_edge_previous(twin)};
    double x[4][3];
    for (int k = 0; k < 4; k++) {
        int32_t t = corners[k] / 3, c = corners[k] % 3;
        hinge->vertices[k] = own->shell.triangles[t].vertices[c];
        pel_vec3_copy(front->forest->rest_positions[own->surface[t].vertices[c]], x[k]);
    }
    pel_hinge stencil;
    if (!pel_hinge_setup((const double(*)[3])x, &stencil))
        return false;
    const pel_shell_part_bending *parts = own->given->parts;
    const pel_shell_part_bending *left = &parts[own->base_of_triangle[h / 3]];
    const pel_shell_part_bending *right = &parts[own->base_of_triangle[twin / 3]];
    hinge->stiffness = 0.5 * (left->stiffness + right->stiffness);
    hinge->rest_angle = stencil.rest_angle * 0.5 * (left->curl + right->curl);
    return true;
}

static void update_hinges(pel_shell_front *own, const pel_front *front)
{
    pel_shell *shell = &own->shell;
    shell->hinge_count = 0;
    if (shell->bending == PEL_BENDING_OFF)
        return;
    sort_half_edges(own);
    for (int32_t h = 0; h < 3 * shell->triangle_count; h++) {
        int32_t twin = twin_of(own, h);
        if (twin < h)
            continue;
        pel_shell_hinge *hinge = &shell->hinges[shell->hinge_count];
        int32_t first = h, second = twin;
        bool base = own->is_base[h / 3] && own->is_base[twin / 3];
        if (base && !copy_hinge(own, first, hinge)) {
            first = twin;
            second = h;
            base = copy_hinge(own, first, hinge);
        }
        if (!base && !make_hinge(own, front, first, second, hinge))
            continue;
        hinge->triangles[0] = first / 3;
        hinge->triangles[1] = second / 3;
        shell->hinge_count++;
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
