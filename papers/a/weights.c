/* Figure 4 of paper A: the weights of the modified butterfly scheme, read off from meshes on which one vertex has the
   value 1 and all others 0. */
#include "papers/a/weights.h"

#include <pellicle/subdivide.h>

#include <math.h>
#include <stdio.h>

enum { MOST_RING = 9, MOST_VERTICES = 1 + 3 * MOST_RING, MOST_TRIANGLES = 4 * MOST_RING };

/* A vertex with a ring of n, whose vertices have six neighbours each, in an outer ring of 2 n: vertices 0, 1 .. n,
   n + 1 .. 3 n. Triangle 0 begins with the centre and vertex 1. */
static int32_t make_rings(int n, double positions[][3], int32_t triangles[][3])
{
    const double turn = 2 * acos(-1.0) / n;
    int32_t count = 0;
    positions[0][0] = positions[0][1] = positions[0][2] = 0;
    for (int i = 0; i < 3 * n; i++) {
        double angle = i < n ? i * turn : (i - n) * turn / 2, radius = i < n ? 1 : 2;
        double *p = positions[1 + i];
        p[0] = radius * cos(angle);
        p[1] = radius * sin(angle);
        p[2] = 0;
    }
    for (int i = 0; i < n; i++) {
        int32_t a = 1 + i, b = 1 + (i + 1) % n, before = n + 1 + (2 * i + 2 * n - 1) % (2 * n), at = n + 1 + 2 * i;
        const int32_t made[4][3] = {{0, a, b}, {a, before, at}, {a, at, at + 1}, {a, at + 1, b}};
        for (int t = 0; t < 4; t++, count++)
            for (int k = 0; k < 3; k++)
                triangles[count][k] = made[t][k];
    }
    return count;
}

/* the value of the edge from the centre to vertex 1, by the values of all vertices */
static pel_status read_edge(const pel_mesh *mesh, double *value, pel_error *error)
{
    pel_subdivide_def def = pel_subdivide_def_default();
    pel_mesh *fine;
    def.levels = 1;
    def.clamp_fields = false;
    pel_status status = pel_mesh_subdivide_with(mesh, &def, &fine, error);
    if (status == PEL_OK)
        *value = fine->fields[0].values[fine->triangles[3][0]];
    pel_mesh_destroy(fine);
    return status;
}

/* weights of the centre, at 0, and of its ring from vertex 1 on */
static pel_status read_weights(int n, double *weights, pel_error *error)
{
    double positions[MOST_VERTICES][3];
    int32_t triangles[MOST_TRIANGLES][3], count = make_rings(n, positions, triangles);
    pel_status status = PEL_OK;
    for (int v = 0; status == PEL_OK && v <= n; v++) {
        double values[MOST_VERTICES] = {0};
        pel_mesh *mesh;
        values[v] = 1;
        status = pel_mesh_create(positions[0], 1 + 3 * n, triangles[0], count, &mesh, error);
        if (status == PEL_OK)
            status = pel_mesh_add_field(mesh, "mark", 1, values, error);
        if (status == PEL_OK)
            status = read_edge(mesh, &weights[v], error);
        pel_mesh_destroy(mesh);
    }
    return status;
}

/* weight of the k-th vertex of a ring of n, as published (Zorin, Schroeder, Sweldens 1996) */
static double published(int n, int k)
{
    const double angle = 2 * acos(-1.0) * k / n;
    static const double three[3] = {5.0 / 12, -1.0 / 12, -1.0 / 12}, four[4] = {3.0 / 8, 0, -1.0 / 8, 0};
    if (n == 3)
        return three[k];
    if (n == 4)
        return four[k];
    return (0.25 + cos(angle) + 0.5 * cos(2 * angle)) / n;
}

/* of an edge between two vertices of six neighbours: its other end has 1/2 too, the two beside it 1/8, those across
   its ring -1/16 */
static double published_regular(int k)
{
    static const double weights[6] = {0.5, 0.125, -0.0625, 0, -0.0625, 0.125};
    return weights[k];
}

pel_status a_judge_weights(lab_experiment *experiment)
{
    static const int rings[] = {3, 4, 5, 6, 7, 9};
    lab_begin_claim(experiment, LAB_PAPER, "the weights are those of the modified butterfly scheme", NULL);
    for (size_t i = 0; i < sizeof rings / sizeof *rings; i++) {
        int n = rings[i];
        double weights[1 + MOST_RING] = {0}, off = 0;
        char name[64];
        pel_status status = read_weights(n, weights, experiment->error);
        if (status != PEL_OK)
            return status;
        off = fabs(weights[0] - (n == 6 ? 0.5 : 0.75));
        for (int k = 0; k < n; k++)
            off = fmax(off, fabs(weights[1 + k] - (n == 6 ? published_regular(k) : published(n, k))));
        snprintf(name, sizeof name, "ring of %d: error of the weights", n);
        lab_at_most(experiment, name, off, 1e-14, "paper A, section 3.1, figure 4");
    }
    return PEL_OK;
}
