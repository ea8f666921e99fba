#include "model/origin.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/vec3.h"

#include <stdlib.h>

pel_status pel_origins_check(const pel_body_def *def, int32_t body, pel_error *error)
{
    const char *remedy = "give each vertex the one that it is a copy of, originals first, or leave the origins out";
    int32_t count = def->mesh->vertex_count, base = 0;
    if (def->origins == NULL && def->origin_count == 0)
        return PEL_OK;
    if (def->origins == NULL || def->origin_count != count)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, remedy, "body has %d origins of %d vertices",
                                  (int)def->origin_count, (int)count);
    while (base < count && def->origins[base] == base)
        base++;
    for (int32_t v = base; v < count; v++)
        if (def->origins[v] < 0 || def->origins[v] >= base)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, remedy,
                                      "origin of vertex %d is %d, which is no vertex before the cuts", (int)v,
                                      (int)def->origins[v]);
    if (base < count && def->refine.levels > 0)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body,
                                  "subdivide the mesh before (`pellicle subdivide`), and leave out `refine`",
                                  "a body that was cut does not refine");
    return PEL_OK;
}

int32_t pel_origins_base_count(const pel_body_def *def)
{
    int32_t base = 0;
    if (def->origins == NULL)
        return def->mesh->vertex_count;
    while (base < def->origin_count && def->origins[base] == base)
        base++;
    return base;
}

/* ---- shares ---- */

static double area_beside(const pel_mesh *mesh, int32_t half_edge)
{
    const int32_t *v = mesh->triangles[half_edge / 3];
    return pel_vec3_triangle_area(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]]);
}

/* both lips of an edge have the same origins at their ends, and run against each other */
static int64_t key_of(const pel_body_def *def, const pel_topology *topology, int32_t h, bool is_reversed)
{
    int64_t a = def->origins[pel_half_edge_origin(topology, h)], b = def->origins[pel_half_edge_target(topology, h)];
    return is_reversed ? b << 32 | a : a << 32 | b;
}

static bool is_divided(const double *shares, const pel_topology *topology, int32_t h)
{
    return topology->twin[h] < 0 &&
           (shares[pel_half_edge_origin(topology, h)] < 1 || shares[pel_half_edge_target(topology, h)] < 1);
}

typedef struct border {
    int64_t key;
    int32_t half_edge;
} border;

static int compare(const void *left, const void *right)
{
    const border *a = left, *b = right;
    return a->key < b->key ? -1 : a->key > b->key;
}

/* the border that has this key; -1 */
static int32_t find_border(const border *borders, int32_t count, int64_t key)
{
    int32_t low = 0, high = count;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (borders[middle].key < key)
            low = middle + 1;
        else
            high = middle;
    }
    return low < count && borders[low].key == key ? borders[low].half_edge : -1;
}

static pel_status divide_edges(const pel_body_def *def, const pel_topology *topology, const double *shares,
                               double *lip_shares, pel_error *error)
{
    border *borders = pel_allocate((size_t)topology->boundary_edge_count + 1, sizeof *borders);
    int32_t count = 0, half_edge_count = 3 * topology->triangle_count;
    if (borders == NULL)
        return pel_fail_memory(error);
    for (int32_t h = 0; h < half_edge_count; h++) {
        lip_shares[h] = 1;
        if (is_divided(shares, topology, h))
            borders[count++] = (border){key_of(def, topology, h, false), h};
    }
    qsort(borders, (size_t)count, sizeof *borders, compare);
    for (int32_t i = 0; i < count; i++) {
        int32_t h = borders[i].half_edge, g = find_border(borders, count, key_of(def, topology, h, true));
        double own = area_beside(def->mesh, h);
        if (g >= 0)
            lip_shares[h] = own / (own + area_beside(def->mesh, g));
    }
    pel_free(borders);
    return PEL_OK;
}

pel_status pel_origins_find_shares(const pel_body_def *def, const pel_topology *topology, const double *areas,
                                   double *shares, double *lip_shares, pel_error *error)
{
    int32_t count = def->mesh->vertex_count;
    double *sums = pel_allocate((size_t)count, sizeof *sums);
    if (sums == NULL)
        return pel_fail_memory(error);
    for (int32_t v = 0; v < count; v++)
        sums[def->origins[v]] += areas[v];
    for (int32_t v = 0; v < count; v++)
        shares[v] = areas[v] / sums[def->origins[v]];
    pel_free(sums);
    return divide_edges(def, topology, shares, lip_shares, error);
}
