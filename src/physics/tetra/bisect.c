/* Longest-edge bisection: the longest edge of a tetrahedron is cut in its middle, in all tetrahedra around it, once it
   is the longest one in each of them; else a longer one beside it is cut first. Lengths, and the numbers of vertices
   where they are equal, put all edges in one order, so that this ends. The tetrahedra of a body-centred lattice have
   three shapes after any number of such cuts (those of Maubach 1995); dihedral angles at the surface stay above about
   half of those that isosurface stuffing left. */
#include "tetra/bisect.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/status.h"
#include "bvh/mesh_query.h"
#include "math/vec3.h"
#include "pellicle/volume.h"

#include <math.h>
#include <string.h>

/* of an edge: how far its middle may move on to the given surface */
#define REACH 0.3
/* of its volume: what is left at least of a tetrahedron when it does */
#define LEAST_VOLUME 0.3

/* tetrahedra at each vertex are a list of slots, 4 t + corner */
typedef struct bisection {
    const pel_bisect_def *def;
    pel_mesh_query *query;
    double (*points)[3];
    int32_t (*tetrahedra)[4];
    int32_t *first; /* (point_count) slot, -1 = none */
    int32_t *next;  /* (4 count) */
    int32_t *shell; /* (shell_count) tetrahedra around an edge */
    size_t point_room, room, first_room, next_room, shell_room;
    int32_t point_count, count, shell_count;
} bisection;

typedef struct edge {
    double square; /* m2 */
    int32_t low, high;
} edge;

static bool is_longer(const edge *a, const edge *b)
{
    if (a->square != b->square)
        return a->square > b->square;
    return a->low != b->low ? a->low < b->low : a->high < b->high;
}

static edge longest_of(const bisection *job, int32_t t)
{
    static const int ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    const int32_t *v = job->tetrahedra[t];
    edge longest = {.square = -1};
    for (int i = 0; i < 6; i++) {
        const int32_t a = v[ends[i][0]], b = v[ends[i][1]];
        edge own = {.low = a < b ? a : b, .high = a < b ? b : a};
        const double length = pel_vec3_distance(job->points[own.low], job->points[own.high]);
        own.square = length * length;
        if (is_longer(&own, &longest))
            longest = own;
    }
    return longest;
}

static int corner_of(const bisection *job, int32_t t, int32_t vertex)
{
    for (int k = 0; k < 4; k++)
        if (job->tetrahedra[t][k] == vertex)
            return k;
    return -1;
}

static bool find_shell(bisection *job, const edge *around)
{
    job->shell_count = 0;
    for (int32_t slot = job->first[around->low]; slot >= 0; slot = job->next[slot]) {
        if (corner_of(job, slot / 4, around->high) < 0)
            continue;
        if (!pel_reserve((void **)&job->shell, &job->shell_room, (size_t)job->shell_count + 1, sizeof *job->shell))
            return false;
        job->shell[job->shell_count++] = slot / 4;
    }
    return true;
}

/* the tetrahedra around an edge of the surface do not close: two of the vertices across from it have one only */
static bool is_on_surface(const bisection *job, const edge *around)
{
    for (int32_t i = 0; i < job->shell_count; i++)
        for (int k = 0; k < 4; k++) {
            const int32_t v = job->tetrahedra[job->shell[i]][k];
            int count = 0;
            for (int32_t j = 0; v != around->low && v != around->high && j < job->shell_count; j++)
                count += corner_of(job, job->shell[j], v) >= 0;
            if (count == 1)
                return true;
        }
    return false;
}

static double volume_with(const bisection *job, int32_t t, int32_t vertex, const double point[3])
{
    double x[4][3];
    for (int k = 0; k < 4; k++) {
        const int32_t v = job->tetrahedra[t][k];
        pel_vec3_copy(v == vertex ? point : job->points[v], x[k]);
    }
    return pel_tetrahedron_volume((const double(*)[3])x);
}

/* the middle of an edge, on the given surface where that leaves the tetrahedra their volumes */
static void place_middle(const bisection *job, const edge *cut, double middle[3])
{
    double moved[3];
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * (job->points[cut->low][k] + job->points[cut->high][k]);
    if (job->query == NULL || !is_on_surface(job, cut) ||
        !pel_mesh_query_nearest(job->query, middle, REACH * sqrt(cut->square), moved))
        return;
    for (int32_t i = 0; i < job->shell_count; i++) {
        const int32_t t = job->shell[i];
        const double least = 0.5 * LEAST_VOLUME * volume_with(job, t, -1, moved);
        if (!(volume_with(job, t, cut->low, moved) > least && volume_with(job, t, cut->high, moved) > least))
            return;
    }
    pel_vec3_copy(moved, middle);
}

static void link_slot(bisection *job, int32_t t, int corner)
{
    int32_t *first = &job->first[job->tetrahedra[t][corner]];
    job->next[4 * (size_t)t + (size_t)corner] = *first;
    *first = 4 * t + corner;
}

static void unlink_slot(bisection *job, int32_t t, int corner)
{
    int32_t *at = &job->first[job->tetrahedra[t][corner]];
    while (*at != 4 * t + corner)
        at = &job->next[*at];
    *at = job->next[*at];
}

static bool make_room(bisection *job, int32_t points, int32_t tetrahedra)
{
    const size_t point_total = (size_t)points, total = (size_t)tetrahedra;
    return pel_reserve((void **)&job->points, &job->point_room, point_total, sizeof *job->points) &&
           pel_reserve((void **)&job->first, &job->first_room, point_total, sizeof *job->first) &&
           pel_reserve((void **)&job->tetrahedra, &job->room, total, sizeof *job->tetrahedra) &&
           pel_reserve((void **)&job->next, &job->next_room, 4 * total, sizeof *job->next);
}

/* cuts the tetrahedra of the shell */
static bool cut_shell(bisection *job, const edge *cut)
{
    double middle[3];
    if (!make_room(job, job->point_count + 1, job->count + job->shell_count))
        return false;
    place_middle(job, cut, middle);
    const int32_t made = job->point_count++;
    pel_vec3_copy(middle, job->points[made]);
    job->first[made] = -1;
    for (int32_t i = 0; i < job->shell_count; i++) {
        const int32_t old = job->shell[i], fresh = job->count++;
        const int low = corner_of(job, old, cut->low), high = corner_of(job, old, cut->high);
        PEL_ASSERT(low >= 0 && high >= 0);
        memcpy(job->tetrahedra[fresh], job->tetrahedra[old], sizeof *job->tetrahedra);
        unlink_slot(job, old, high);
        job->tetrahedra[old][high] = made;
        link_slot(job, old, high);
        job->tetrahedra[fresh][low] = made;
        for (int k = 0; k < 4; k++)
            link_slot(job, fresh, k);
    }
    return true;
}

/* cuts the longest edge of a tetrahedron, or a longer one near it */
static bool cut_longest(bisection *job, int32_t t)
{
    edge cut = longest_of(job, t);
    for (;;) {
        edge longest = cut;
        if (!find_shell(job, &cut))
            return false;
        for (int32_t i = 0; i < job->shell_count; i++) {
            const edge own = longest_of(job, job->shell[i]);
            if (is_longer(&own, &longest))
                longest = own;
        }
        if (!is_longer(&longest, &cut))
            return cut_shell(job, &cut);
        cut = longest;
    }
}

static bool is_too_long(const bisection *job, int32_t t)
{
    double center[3];
    for (int k = 0; k < 3; k++) {
        center[k] = 0;
        for (int i = 0; i < 4; i++)
            center[k] += 0.25 * job->points[job->tetrahedra[t][i]][k];
    }
    const double most = job->def->edge(job->def->user, center);
    return longest_of(job, t).square > most * most;
}

static bool begin(bisection *job, const pel_mesh *filled)
{
    if (!make_room(job, filled->vertex_count, filled->tetrahedron_count))
        return false;
    job->point_count = filled->vertex_count;
    job->count = filled->tetrahedron_count;
    memcpy(job->points, filled->positions, (size_t)job->point_count * sizeof *job->points);
    memcpy(job->tetrahedra, filled->tetrahedra, (size_t)job->count * sizeof *job->tetrahedra);
    for (int32_t v = 0; v < job->point_count; v++)
        job->first[v] = -1;
    for (int32_t t = 0; t < job->count; t++)
        for (int k = 0; k < 4; k++)
            link_slot(job, t, k);
    return true;
}

pel_status pel_mesh_bisect(const pel_mesh *filled, const pel_bisect_def *def, pel_mesh **finer, pel_error *error)
{
    *finer = NULL;
    bisection job = {.def = def};
    pel_status status = def->surface != NULL ? pel_mesh_query_create(def->surface, &job.query, error) : PEL_OK;
    bool has_room = status == PEL_OK && begin(&job, filled);
    /* a tetrahedron keeps its number in one half, the other is seen later */
    for (int32_t t = 0; has_room && t < job.count; t++)
        while (has_room && job.count < def->most && is_too_long(&job, t))
            has_room = cut_longest(&job, t);
    if (status == PEL_OK)
        status = has_room ? pel_mesh_create_filled(job.points[0], job.point_count, job.tetrahedra[0], job.count, finer,
                                                   error)
                          : pel_fail_memory(error);
    pel_mesh_query_destroy(job.query);
    pel_free(job.points);
    pel_free(job.tetrahedra);
    pel_free(job.first);
    pel_free(job.next);
    pel_free(job.shell);
    return status;
}
