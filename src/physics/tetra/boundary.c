/* A face with one tetrahedron belongs to the surface. Faces are found by sorting them by their vertices. */
#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/vec3.h"
#include "mesh/allocate.h"
#include "pellicle/topology.h"
#include "pellicle/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* a face of a tetrahedron: its vertices by rising number, and the corner across from it */
typedef struct face {
    int32_t key[3], tetrahedron, corner;
} face;

/* counter-clockwise from outside, across from each corner */
static const int faces_of[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

static int compare(const void *a, const void *b)
{
    const face *first = a, *second = b;
    for (int k = 0; k < 3; k++)
        if (first->key[k] != second->key[k])
            return first->key[k] < second->key[k] ? -1 : 1;
    return first->tetrahedron < second->tetrahedron ? -1 : first->tetrahedron > second->tetrahedron;
}

static void swap_if_above(int32_t *a, int32_t *b)
{
    if (*a > *b) {
        int32_t kept = *a;
        *a = *b;
        *b = kept;
    }
}

static void list_faces(const int32_t (*tetrahedra)[4], int32_t count, face *faces)
{
    for (int32_t t = 0; t < count; t++)
        for (int corner = 0; corner < 4; corner++) {
            face *own = &faces[4 * (size_t)t + (size_t)corner];
            *own = (face){.tetrahedron = t, .corner = corner};
            for (int k = 0; k < 3; k++)
                own->key[k] = tetrahedra[t][faces_of[corner][k]];
            swap_if_above(&own->key[0], &own->key[1]);
            swap_if_above(&own->key[1], &own->key[2]);
            swap_if_above(&own->key[0], &own->key[1]);
        }
    qsort(faces, 4 * (size_t)count, sizeof *faces, compare);
}

static bool is_same(const face *a, const face *b)
{
    return memcmp(a->key, b->key, sizeof a->key) == 0;
}

/* moves faces with one tetrahedron to the front, by rising tetrahedron; -1 and the third tetrahedron of a face that has
   more than two */
static int by_tetrahedron(const void *a, const void *b)
{
    const face *first = a, *second = b;
    if (first->tetrahedron != second->tetrahedron)
        return first->tetrahedron < second->tetrahedron ? -1 : 1;
    return first->corner < second->corner ? -1 : first->corner > second->corner;
}

static int32_t keep_single(face *faces, size_t count, int32_t *third)
{
    int32_t kept = 0;
    for (size_t i = 0, next; i < count; i = next) {
        for (next = i + 1; next < count && is_same(&faces[i], &faces[next]);)
            next++;
        if (next - i > 2) {
            *third = faces[i + 2].tetrahedron;
            return -1;
        }
        if (next - i == 1)
            faces[kept++] = faces[i];
    }
    qsort(faces, (size_t)kept, sizeof *faces, by_tetrahedron);
    return kept;
}

/* new numbers of the points in use: those of the surface first; returns how many */
static int32_t number_points(const int32_t (*tetrahedra)[4], int32_t count, const face *faces, int32_t face_count,
                             int32_t *numbers, int32_t point_count)
{
    enum { USED = -2, ON_SURFACE = -3 };
    for (int32_t p = 0; p < point_count; p++)
        numbers[p] = -1;
    for (int32_t t = 0; t < count; t++)
        for (int k = 0; k < 4; k++)
            numbers[tetrahedra[t][k]] = USED;
    for (int32_t f = 0; f < face_count; f++)
        for (int k = 0; k < 3; k++)
            numbers[faces[f].key[k]] = ON_SURFACE;
    int32_t next = 0;
    for (int32_t p = 0; p < point_count; p++)
        if (numbers[p] == ON_SURFACE)
            numbers[p] = next++;
    for (int32_t p = 0; p < point_count; p++)
        if (numbers[p] == USED)
            numbers[p] = next++;
    return next;
}

static pel_status check_volumes(const double (*points)[3], const int32_t (*tetrahedra)[4], int32_t count,
                                pel_error *error)
{
    for (int32_t t = 0; t < count; t++) {
        double x[4][3];
        for (int k = 0; k < 4; k++)
            pel_vec3_copy(points[tetrahedra[t][k]], x[k]);
        double volume = pel_tetrahedron_volume((const double(*)[3])x);
        if (!(volume > 0))
            return pel_refuse_element(error, PEL_BAD_MESH, "tetrahedron", t,
                                      volume < 0 ? "swap two of its vertices"
                                                 : "move one of its vertices, or remove it",
                                      volume < 0 ? "tetrahedron is turned inside out" : "tetrahedron has no volume");
    }
    return PEL_OK;
}

static pel_status check_manifold(const pel_mesh *mesh, pel_error *error)
{
    pel_topology *topology = NULL;
    pel_status status = pel_topology_create(mesh, &topology, error);
    pel_topology_destroy(topology);
    return status;
}

static pel_status check_input(const double *points, int32_t point_count, const int32_t *tetrahedra, int32_t count,
                              pel_error *error)
{
    if (point_count < 1 || count < 1)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give at least one tetrahedron with four points",
                          "mesh has %d points and %d tetrahedra", (int)point_count, (int)count);
    for (int32_t i = 0; i < 3 * point_count; i++)
        if (!isfinite(points[i]))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "vertex", i / 3, "give finite positions",
                                      "position of the vertex is %g", points[i]);
    for (int32_t i = 0; i < 4 * count; i++)
        if (tetrahedra[i] < 0 || tetrahedra[i] >= point_count)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tetrahedron", i / 4, "give numbers of its points",
                                      "tetrahedron has the vertex %d of %d", (int)tetrahedra[i], (int)point_count);
    return PEL_OK;
}

/* what makes the mesh */
typedef struct build {
    const double (*points)[3];
    const int32_t (*tetrahedra)[4];
    int32_t point_count, count, face_count;
    face *faces;
    int32_t *numbers;
} build;

static pel_status make_mesh(const build *job, int32_t kept, pel_mesh **mesh, pel_error *error)
{
    pel_mesh *made = *mesh = pel_mesh_allocate(kept, job->face_count);
    if (made != NULL)
        made->tetrahedra = pel_allocate((size_t)job->count, sizeof *made->tetrahedra);
    if (made == NULL || made->tetrahedra == NULL)
        return pel_fail_memory(error);
    made->tetrahedron_count = job->count;
    for (int32_t p = 0; p < job->point_count; p++)
        if (job->numbers[p] >= 0)
            pel_vec3_copy(job->points[p], made->positions[job->numbers[p]]);
    for (int32_t f = 0; f < job->face_count; f++)
        for (int k = 0; k < 3; k++)
            made->triangles[f][k] =
                job->numbers[job->tetrahedra[job->faces[f].tetrahedron][faces_of[job->faces[f].corner][k]]];
    for (int32_t t = 0; t < job->count; t++)
        for (int k = 0; k < 4; k++)
            made->tetrahedra[t][k] = job->numbers[job->tetrahedra[t][k]];
    return check_manifold(made, error);
}

static pel_status build_mesh(build *job, pel_mesh **mesh, pel_error *error)
{
    int32_t third = -1;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(job->faces, 4 * (size_t)job->count), PEL_ROOM(job->numbers, job->point_count)))
        return pel_fail_memory(error);
    list_faces(job->tetrahedra, job->count, job->faces);
    job->face_count = keep_single(job->faces, 4 * (size_t)job->count, &third);
    if (job->face_count < 0)
        return pel_refuse_element(error, PEL_BAD_MESH, "tetrahedron", third, "remove all but two of them",
                                  "has a face that belongs to more than two tetrahedra");
    if (job->face_count == 0)
        return pel_refuse_element(error, PEL_BAD_MESH, "tetrahedron", 0, "remove tetrahedra that stand twice",
                                  "has no face of its own, like all others, so that the body has no surface");
    int32_t kept =
        number_points(job->tetrahedra, job->count, job->faces, job->face_count, job->numbers, job->point_count);
    return make_mesh(job, kept, mesh, error);
}

pel_status pel_mesh_create_filled(const double *points, int32_t point_count, const int32_t *tetrahedra,
                                  int32_t tetrahedron_count, pel_mesh **mesh, pel_error *error)
{
    PEL_REFUSE_NULL(points, error);
    PEL_REFUSE_NULL(tetrahedra, error);
    PEL_REFUSE_NULL(mesh, error);
    *mesh = NULL;
    build job = {.points = (const double(*)[3])points,
                 .tetrahedra = (const int32_t(*)[4])tetrahedra,
                 .point_count = point_count,
                 .count = tetrahedron_count};
    pel_status status = check_input(points, point_count, tetrahedra, tetrahedron_count, error);
    if (status == PEL_OK)
        status = check_volumes(job.points, job.tetrahedra, job.count, error);
    if (status == PEL_OK)
        status = build_mesh(&job, mesh, error);
    PEL_FREE_ALL(job.faces, job.numbers);
    if (status != PEL_OK) {
        pel_mesh_destroy(*mesh);
        *mesh = NULL;
    }
    return status;
}
