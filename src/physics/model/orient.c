#include "model/orient.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/bounds.h"
#include "math/functions.h"
#include "mesh/union_find.h"

#include <math.h>
#include <string.h>

/* the triangles that are connected by edges, of one part after another */
typedef struct part {
    int32_t begin, end; /* in the list of triangles */
    bool closed, turned;
    double volume; /* about the mesh's first vertex */
    double low[3], high[3];
} part;

typedef struct parts {
    const pel_mesh *mesh;
    int32_t *roots;     /* (triangles) of the union-find, then the number of the part */
    int32_t *triangles; /* (triangles) by part */
    part *list;
    int32_t count;
} parts;

static void join_triangles(parts *p, const pel_topology *topology)
{
    pel_union_find_reset(p->roots, topology->triangle_count);
    for (int32_t h = 0; h < 3 * topology->triangle_count; h++)
        if (topology->twin[h] >= 0)
            pel_union_find_join(p->roots, h / 3, topology->twin[h] / 3);
    p->count = 0;
    for (int32_t t = 0; t < topology->triangle_count; t++)
        p->count += pel_union_find_root(p->roots, t) == t;
}

/* parents are lower than their children: they have the numbers of their parts before those */
static void number_parts(parts *p)
{
    int32_t next = 0;
    for (int32_t t = 0; t < p->mesh->triangle_count; t++)
        p->roots[t] = p->roots[t] == t ? next++ : p->roots[p->roots[t]];
}

static void sort_triangles(parts *p)
{
    int32_t at = 0;
    for (int32_t t = 0; t < p->mesh->triangle_count; t++)
        p->list[p->roots[t]].end++;
    for (int32_t i = 0; i < p->count; i++) {
        p->list[i].begin = at;
        at += p->list[i].end;
        p->list[i].end = p->list[i].begin;
    }
    for (int32_t t = 0; t < p->mesh->triangle_count; t++)
        p->triangles[p->list[p->roots[t]].end++] = t;
}

static void measure_part(const parts *p, const pel_topology *topology, part *own)
{
    const pel_mesh *mesh = p->mesh;
    own->closed = true;
    pel_bounds_clear(own->low, own->high);
    for (int32_t i = own->begin; i < own->end; i++) {
        int32_t t = p->triangles[i];
        const int32_t *v = mesh->triangles[t];
        own->volume += pel_vec3_cone_volume(mesh->positions[0], mesh->positions[v[0]], mesh->positions[v[1]],
                                            mesh->positions[v[2]]);
        for (int k = 0; k < 3; k++) {
            own->closed = own->closed && topology->twin[3 * t + k] >= 0;
            pel_bounds_add(own->low, own->high, mesh->positions[v[k]]);
        }
    }
}

/* sum of the solid angles of a part's triangles over 4 pi: 1 or -1 inside, 0 outside */
static double winding_about(const parts *p, const part *own, const double point[3])
{
    double sum = 0;
    for (int32_t i = own->begin; i < own->end; i++) {
        double x[3][3], product[3], l[3];
        for (int k = 0; k < 3; k++) {
            pel_vec3_subtract(p->mesh->positions[p->mesh->triangles[p->triangles[i]][k]], point, x[k]);
            l[k] = pel_vec3_length(x[k]);
        }
        pel_vec3_cross(x[1], x[2], product);
        sum += pel_atan2(pel_vec3_dot(x[0], product), l[0] * l[1] * l[2] + pel_vec3_dot(x[0], x[1]) * l[2] +
                                                          pel_vec3_dot(x[1], x[2]) * l[0] +
                                                          pel_vec3_dot(x[2], x[0]) * l[1]);
    }
    return sum / 6.283185307179586;
}

static bool encloses(const parts *p, const part *outer, const part *inner)
{
    if (outer == inner || !outer->closed)
        return false;
    for (int c = 0; c < 3; c++)
        if (inner->low[c] < outer->low[c] || inner->high[c] > outer->high[c])
            return false;
    const double *point = p->mesh->positions[p->mesh->triangles[p->triangles[inner->begin]][0]];
    return fabs(winding_about(p, outer, point)) > 0.5;
}

/* which parts are inside out */
static void find_turned(parts *p)
{
    for (int32_t i = 0; i < p->count; i++) {
        part *own = &p->list[i];
        bool enclosed = !(own->closed && own->volume < 0);
        for (int32_t j = 0; j < p->count && !enclosed; j++)
            enclosed = encloses(p, &p->list[j], own);
        if (enclosed)
            continue;
        for (int32_t j = 0; j < p->count; j++)
            if (j == i || (p->list[j].closed && encloses(p, own, &p->list[j])))
                p->list[j].turned = true;
    }
}

static int32_t turn_triangles(const parts *p, pel_mesh *mesh)
{
    int32_t count = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        if (!p->list[p->roots[t]].turned)
            continue;
        int32_t *v = mesh->triangles[t], last = v[2];
        v[2] = v[1];
        v[1] = last;
        count++;
    }
    return count;
}

pel_status pel_orient_outward(pel_mesh *mesh, const pel_topology *topology, int32_t *turned_count, pel_error *error)
{
    size_t count = (size_t)mesh->triangle_count;
    parts p = {.mesh = mesh};
    *turned_count = 0;
    bool room = PEL_ALLOCATE_ALL(PEL_ROOM(p.roots, count), PEL_ROOM(p.triangles, count));
    if (room) {
        join_triangles(&p, topology);
        p.list = pel_allocate((size_t)p.count, sizeof *p.list);
        room = p.list != NULL;
    }
    if (room) {
        number_parts(&p);
        sort_triangles(&p);
        for (int32_t i = 0; i < p.count; i++)
            measure_part(&p, topology, &p.list[i]);
        find_turned(&p);
        *turned_count = turn_triangles(&p, mesh);
    }
    PEL_FREE_ALL(p.roots, p.triangles, p.list);
    return room ? PEL_OK : pel_fail_memory(error);
}
