/* Meshes to subdivide: shapes, rings of any valence, random surfaces. */
#ifndef PEL_TESTS_SUBDIVIDE_SAMPLE_H
#define PEL_TESTS_SUBDIVIDE_SAMPLE_H

#include "check.h"
#include "random.h"

#include "pellicle/shape.h"
#include "pellicle/topology.h"

#include <stdlib.h>

static inline pel_mesh *sample_create(const double (*positions)[3], int32_t vertex_count, const int32_t (*triangles)[3],
                                      int32_t triangle_count)
{
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions[0], vertex_count, triangles[0], triangle_count, &mesh, NULL), PEL_OK);
    return mesh;
}

static inline pel_mesh *sample_sphere(int32_t frequency)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = frequency;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

static inline pel_mesh *sample_tetrahedron(void)
{
    static const double positions[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    static const int32_t triangles[4][3] = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
    return sample_create(positions, 4, triangles, 4);
}

static inline pel_mesh *sample_octahedron(void)
{
    static const double positions[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    static const int32_t triangles[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                            {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    return sample_create(positions, 6, triangles, 8);
}

/* vertex 0 amid `valence` triangles; closed: the same from below to vertex 1, else a rim (and vertex 1 is isolated) */
static inline pel_mesh *sample_ring(int32_t valence, bool closed, random_state *random)
{
    double(*positions)[3] = calloc((size_t)valence + 2, sizeof *positions);
    int32_t(*triangles)[3] = calloc(2 * (size_t)valence, sizeof *triangles);
    assert_true(positions != NULL && triangles != NULL);
    positions[0][2] = 1;
    positions[1][2] = -1;
    for (int32_t j = 0; j < valence; j++) {
        double angle = 6.283185307179586 * j / valence, radius = random_between(random, 0.8, 1.2);
        positions[2 + j][0] = radius * cos(angle);
        positions[2 + j][1] = radius * sin(angle);
        positions[2 + j][2] = random_between(random, -0.2, 0.2);
        int32_t a = 2 + j, b = 2 + (j + 1) % valence;
        const int32_t upper[3] = {0, a, b}, lower[3] = {b, a, 1};
        memcpy(triangles[j], upper, sizeof upper);
        memcpy(triangles[valence + j], lower, sizeof lower);
    }
    pel_mesh *mesh = sample_create((const double(*)[3])positions, valence + 2, (const int32_t(*)[3])triangles,
                                   closed ? 2 * valence : valence);
    free(positions);
    free(triangles);
    return mesh;
}

static inline bool sample_has_half_edge(const pel_mesh *mesh, int32_t from, int32_t to)
{
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            if (mesh->triangles[t][i] == from && mesh->triangles[t][(i + 1) % 3] == to)
                return true;
    return false;
}

/* turns an edge of two triangles to their other diagonal, where that one is not an edge yet */
static inline void sample_flip_edge(pel_mesh *mesh, random_state *random)
{
    pel_topology *topology;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    int32_t h = (int32_t)random_integer(random, 0, 3 * mesh->triangle_count - 1), g = topology->twin[h];
    if (g >= 0) {
        int32_t a = pel_half_edge_origin(topology, h), b = pel_half_edge_target(topology, h);
        int32_t c = pel_half_edge_origin(topology, pel_half_edge_previous(h));
        int32_t d = pel_half_edge_origin(topology, pel_half_edge_previous(g));
        if (!sample_has_half_edge(mesh, c, d) && !sample_has_half_edge(mesh, d, c)) {
            const int32_t first[3] = {c, d, b}, second[3] = {d, c, a};
            memcpy(mesh->triangles[h / 3], first, sizeof first);
            memcpy(mesh->triangles[g / 3], second, sizeof second);
        }
    }
    pel_topology_destroy(topology);
}

/* removes a triangle when what is left is still a manifold */
static inline void sample_remove_triangle(pel_mesh *mesh, random_state *random)
{
    int32_t t = (int32_t)random_integer(random, 0, mesh->triangle_count - 1), kept[3];
    int32_t *last = mesh->triangles[mesh->triangle_count - 1];
    memcpy(kept, mesh->triangles[t], sizeof kept);
    memmove(mesh->triangles[t], last, sizeof kept);
    mesh->triangle_count--;
    pel_topology *topology;
    if (mesh->triangle_count > 0 && pel_topology_create(mesh, &topology, NULL) == PEL_OK) {
        pel_topology_destroy(topology);
        return;
    }
    memmove(last, mesh->triangles[t], sizeof kept);
    memcpy(mesh->triangles[t], kept, sizeof kept);
    mesh->triangle_count++;
}

/* corners of each triangle turned and triangles shuffled: nothing may depend on where a triangle starts */
static inline void sample_shuffle(pel_mesh *mesh, random_state *random)
{
    for (int32_t t = mesh->triangle_count - 1; t >= 0; t--) {
        int32_t other = (int32_t)random_integer(random, 0, t), kept[3];
        memcpy(kept, mesh->triangles[t], sizeof kept);
        memmove(mesh->triangles[t], mesh->triangles[other], sizeof kept);
        int64_t turn = random_integer(random, 0, 2);
        for (int i = 0; i < 3; i++)
            mesh->triangles[other][i] = kept[(i + turn) % 3];
    }
}

/* a grid, sphere or torus with random edges, holes and positions: valences from 1 to about 15 */
static inline pel_mesh *sample_random(random_state *random)
{
    static const pel_shape_kind kinds[3] = {PEL_SHAPE_GRID, PEL_SHAPE_GEODESIC_SPHERE, PEL_SHAPE_TORUS};
    pel_shape_def def = pel_shape_def_default(kinds[random_integer(random, 0, 2)]);
    def.nx = def.ny = 7;
    def.frequency = 3;
    def.slices = 12;
    def.rings = 7;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    for (int64_t i = random_integer(random, 0, 150); i > 0; i--)
        sample_flip_edge(mesh, random);
    for (int64_t i = random_integer(random, -5, 60); i > 0; i--)
        sample_remove_triangle(mesh, random);
    sample_shuffle(mesh, random);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            mesh->positions[v][i] += 0.2 * random_normal(random);
    return mesh;
}

#endif
