/* Random paths through surfaces, and what a cut leaves as it is. */
#ifndef PEL_TESTS_SIM_CUT_FIXTURE_H
#define PEL_TESTS_SIM_CUT_FIXTURE_H

#include "shell_fixture.h"

#include "mesh/topology_check.h"
#include "pellicle/sim.h"
#include "pellicle/sim_contact.h"
#include "pellicle/tear.h"
#include "pellicle/topology.h"

static inline uint32_t random_below(random_state *random, uint32_t limit)
{
    return (uint32_t)random_between(random, 0, limit - 1e-9);
}

/* ---- sums ---- */

typedef struct sums {
    double mass, momentum[3], angular[3], kinetic, elastic, bending;
} sums;

static inline sums sums_of(pel_sim *sim)
{
    sums s = {0};
    pel_sim_measures m;
    int32_t count = pel_sim_vertex_count(sim, 0);
    double *x = calloc((size_t)count, 24), *v = calloc((size_t)count, 24), *mass = calloc((size_t)count, 8);
    pel_sim_get_positions(sim, 0, x);
    pel_sim_get_velocities(sim, 0, v);
    pel_sim_get_masses(sim, 0, mass);
    for (int32_t i = 0; i < count; i++) {
        double arm[3];
        pel_vec3_cross(x + 3 * i, v + 3 * i, arm);
        s.mass += mass[i];
        pel_vec3_along(s.momentum, mass[i], v + 3 * i, s.momentum);
        pel_vec3_along(s.angular, mass[i], arm, s.angular);
        s.kinetic += 0.5 * mass[i] * pel_vec3_squared_length(v + 3 * i);
    }
    pel_sim_measure(sim, &m);
    s.elastic = m.elastic_energy;
    s.bending = m.bending_energy;
    free(x);
    free(v);
    free(mass);
    return s;
}

static inline void compare_motion(const sums *a, const sums *b)
{
    double size = sqrt(2 * a->mass * a->kinetic) + 1e-30;
    assert_near(b->mass / a->mass, 1, IN_FLOAT(1e-14, 1e-6));
    for (int c = 0; c < 3; c++) {
        assert_near(b->momentum[c], a->momentum[c], IN_FLOAT(1e-13, 1e-6) * size);
        assert_near(b->angular[c], a->angular[c], IN_FLOAT(1e-13, 1e-6) * size);
    }
    assert_near(b->kinetic, a->kinetic, IN_FLOAT(1e-12, 1e-6) * a->kinetic);
}

static inline void compare(const sums *a, const sums *b)
{
    compare_motion(a, b);
    assert_near(b->elastic - b->bending, a->elastic - a->bending, IN_FLOAT(1e-12, 1e-5) * a->elastic);
}

/* ---- paths ---- */

/* vertices that edges join, through the surface, each once; returns their number */
static inline int32_t random_path(const pel_mesh *mesh, random_state *random, int32_t most, int32_t *path)
{
    pel_topology *topology;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    uint8_t *seen = calloc((size_t)mesh->vertex_count, 1);
    int32_t count = 0, v = (int32_t)random_below(random, (uint32_t)mesh->vertex_count);
    while (count < most) {
        path[count++] = v;
        seen[v] = 1;
        int32_t next = -1, choices = 0;
        for (int32_t h = 0; h < 3 * mesh->triangle_count; h++)
            if (pel_half_edge_origin(topology, h) == v && topology->twin[h] >= 0 &&
                !seen[pel_half_edge_target(topology, h)] && random_below(random, (uint32_t)++choices) == 0)
                next = pel_half_edge_target(topology, h);
        if (next < 0)
            break;
        v = next;
    }
    free(seen);
    pel_topology_destroy(topology);
    return count;
}

/* a column of a grid with nx by ny cells, from its lower border over `cells` */
static inline int32_t column(const pel_mesh *mesh, double x, double low, double high, int32_t *path)
{
    int32_t count = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (fabs(mesh->positions[v][0] - x) < 1e-9 && mesh->positions[v][1] > low - 1e-9 &&
            mesh->positions[v][1] < high + 1e-9)
            path[count++] = v;
    for (int32_t i = 0; i < count; i++)
        for (int32_t j = i + 1; j < count; j++)
            if (mesh->positions[path[j]][1] < mesh->positions[path[i]][1]) {
                int32_t other = path[i];
                path[i] = path[j];
                path[j] = other;
            }
    return count;
}

/* ---- random surfaces ---- */

/* a sheet, an irregular one, a disk, a ball or a ring */
static inline pel_mesh *random_surface(random_state *random)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    switch (random_below(random, 6)) {
    case 0:
        return make_grid((int32_t)random_integer(random, 3, 9), (int32_t)random_integer(random, 3, 9), 1, 1,
                         (pel_grid_diagonals)random_below(random, 3));
    case 1:
        return make_irregular_patch((int32_t)random_integer(random, 4, 9), random);
    case 2:
        return make_irregular_ball((int32_t)random_integer(random, 1, 3), random);
    case 3:
        def = pel_shape_def_default(PEL_SHAPE_DISK);
        def.rings = (int32_t)random_integer(random, 2, 5);
        return make_shape(&def);
    case 4:
        def = pel_shape_def_default(PEL_SHAPE_TORUS);
        def.slices = (int32_t)random_integer(random, 6, 14);
        def.rings = (int32_t)random_integer(random, 4, 8);
        return make_shape(&def);
    default:
        def.frequency = (int32_t)random_integer(random, 1, 4);
        return make_shape(&def);
    }
}

/* the same number of triangles, each edge between two of them at most, each vertex with one fan, and no intersection */
static inline void check_opened(pel_sim *sim, int32_t triangle_count, bool has_contact)
{
    const pel_mesh *mesh = pel_model_mesh(pel_sim_model(sim), 0);
    pel_topology *topology;
    assert_int_equal(mesh->triangle_count, triangle_count);
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    assert_true(pel_topology_is_valid(topology));
    pel_topology_destroy(topology);
    int64_t crossings = 0;
    if (has_contact)
        assert_int_equal(pel_sim_intersections(sim, &crossings, NULL), PEL_OK);
    assert_int_equal(crossings, 0);
}

/* a push that pulls the surface apart, or presses it together */
static inline void push(pel_sim *sim, random_state *random)
{
    int32_t count = pel_sim_vertex_count(sim, 0);
    double *x = calloc((size_t)count, 24), *v = calloc((size_t)count, 24), rates[3];
    for (int c = 0; c < 3; c++)
        rates[c] = random_between(random, -10, 20);
    pel_sim_get_positions(sim, 0, x);
    for (int32_t i = 0; i < 3 * count; i++)
        v[i] = rates[i % 3] * x[i];
    assert_int_equal(pel_sim_set_velocities(sim, 0, v, NULL), PEL_OK);
    free(x);
    free(v);
}

/* m, the farthest of the copies from `first` on from the vertices that they are like: as they are made they lie there
 */
static inline double farthest_new_copy(const pel_sim *sim, int32_t first)
{
    int32_t count = pel_sim_vertex_count(sim, 0);
    int32_t *origins = calloc((size_t)count, sizeof *origins);
    double *x = calloc((size_t)count, 24), most = 0;
    pel_sim_get_origins(sim, 0, origins);
    pel_sim_get_positions(sim, 0, x);
    for (int32_t v = first; v < count; v++) {
        double least = HUGE_VAL;
        for (int32_t k = 0; k < count; k++)
            if (k != v && origins[k] == origins[v])
                least = fmin(least, pel_vec3_distance(x + 3 * k, x + 3 * v));
        most = fmax(most, least);
    }
    free(origins);
    free(x);
    return most;
}

#endif
