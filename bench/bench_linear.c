/* Sparse solver on spheres under the sparsity of hinges (one ring and opposite vertices) and of mid-edge bending (three
   unknowns a vertex, one an edge): pattern, plan, factor in float and double, solve, product, conjugate gradients.
   usage: bench_linear [threads] [frequency] */
#include "bench.h"
#include "linear/factor.h"
#include "linear/jacobi.h"
#include "linear/pcg.h"

#include "pellicle/topology.h"
#ifdef PEL_PEERS
#include "peers/peer_linear.h"
#endif

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REPEATS = 9 };

/* processor time where one thread runs: other jobs on the machine count less */
static double (*seconds)(void);

/* a shell as springs along edges, rank-one bending of hinges or triangles, and a mass */
typedef struct shell {
    const pel_mesh *mesh;
    int32_t element_count, node_count;
    int32_t *start, *nodes;
    uint8_t *sizes;
    double (*places)[3];
    double stretch, bending;
} shell;

/* outer product of a gradient with itself */
static void add_square(double factor, const double *gradient, int size, double *block)
{
    for (int i = 0; i < size; i++)
        for (int j = 0; j < size; j++)
            block[i * size + j] += factor * gradient[i] * gradient[j];
}

static void subtract(const double *a, const double *b, double c[3])
{
    for (int k = 0; k < 3; k++)
        c[k] = a[k] - b[k];
}
static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* spring between two of the vertices of an element */
static void add_spring(const shell *s, const int32_t *nodes, int i, int j, int size, double *block)
{
    double gradient[PEL_ELEMENT_SIZE_LIMIT] = {0}, edge[3];
    subtract(s->places[nodes[j]], s->places[nodes[i]], edge);
    double length = sqrt(dot(edge, edge));
    for (int k = 0; k < 3; k++) {
        gradient[3 * i + k] = -edge[k] / length;
        gradient[3 * j + k] = edge[k] / length;
    }
    add_square(s->stretch, gradient, size, block);
}

/* gradient of the angle at edge 0-1 of the corner c, of triangle 0 1 c with unit normal n */
static void add_angle(const shell *s, const int32_t *nodes, int a, int b, int c, double sign, double *gradient)
{
    const double *x0 = s->places[nodes[a]], *x1 = s->places[nodes[b]], *x2 = s->places[nodes[c]];
    double e[3], f[3], n[3];
    subtract(x1, x0, e);
    subtract(x2, x0, f);
    n[0] = e[1] * f[2] - e[2] * f[1];
    n[1] = e[2] * f[0] - e[0] * f[2];
    n[2] = e[0] * f[1] - e[1] * f[0];
    double area = sqrt(dot(n, n)), length = sqrt(dot(e, e)), share = dot(e, f) / (length * length);
    for (int k = 0; k < 3; k++) {
        double height = sign * length * n[k] / (area * area);
        gradient[3 * c + k] += height;
        gradient[3 * a + k] -= (1 - share) * height;
        gradient[3 * b + k] -= share * height;
    }
}

static void fill_hinges(void *context, const int32_t *elements, int32_t count, double *blocks)
{
    const shell *s = context;
    memset(blocks, 0, (size_t)count * 144 * sizeof *blocks);
    for (int32_t i = 0; i < count; i++) {
        const int32_t *nodes = &s->nodes[s->start[elements[i]]];
        double gradient[12] = {0};
        add_spring(s, nodes, 0, 1, 12, &blocks[144 * i]);
        add_angle(s, nodes, 0, 1, 2, 1, gradient);
        add_angle(s, nodes, 1, 0, 3, 1, gradient);
        add_square(s->bending, gradient, 12, &blocks[144 * i]);
    }
}

static void fill_triangles(void *context, const int32_t *elements, int32_t count, double *blocks)
{
    const shell *s = context;
    memset(blocks, 0, (size_t)count * 144 * sizeof *blocks);
    for (int32_t i = 0; i < count; i++) {
        const int32_t *nodes = &s->nodes[s->start[elements[i]]];
        for (int k = 0; k < 3; k++) {
            double gradient[12] = {0};
            add_spring(s, nodes, k, (k + 1) % 3, 12, &blocks[144 * i]);
            add_angle(s, nodes, k, (k + 1) % 3, (k + 2) % 3, 1, gradient);
            gradient[9 + k] = nodes[k] < nodes[(k + 1) % 3] ? 1 : -1;
            add_square(s->bending, gradient, 12, &blocks[144 * i]);
        }
    }
}

static void add_element(shell *s, const int32_t *nodes, int count)
{
    int32_t start = s->start[s->element_count++];
    memcpy(&s->nodes[start], nodes, (size_t)count * sizeof *nodes);
    s->start[s->element_count] = start + count;
}

/* elements of a closed mesh: hinges, or triangles with an unknown at each edge */
static shell make_shell(const pel_mesh *mesh, bool has_edges)
{
    int32_t edges = mesh->triangle_count * 3 / 2;
    shell s = {.mesh = mesh, .node_count = mesh->vertex_count + (has_edges ? edges : 0), .stretch = 1};
    size_t elements = (size_t)(has_edges ? mesh->triangle_count : edges);
    s.start = bench_allocate(elements + 1, sizeof *s.start);
    s.nodes = bench_allocate(6 * elements, sizeof *s.nodes);
    s.sizes = bench_allocate((size_t)s.node_count, sizeof *s.sizes);
    s.places = bench_allocate((size_t)s.node_count, sizeof *s.places);
    s.start[0] = 0;
    memcpy(s.places, mesh->positions, (size_t)mesh->vertex_count * sizeof *s.places);
    memset(s.sizes, 3, (size_t)mesh->vertex_count);
    memset(s.sizes + mesh->vertex_count, 1, (size_t)(s.node_count - mesh->vertex_count));
    pel_error error;
    pel_topology *topology;
    bench_check(pel_topology_create(mesh, &topology, &error), &error);
    int32_t *edge_of = bench_allocate(3 * (size_t)mesh->triangle_count, sizeof *edge_of);
    for (int32_t h = 0, e = mesh->vertex_count; h < 3 * mesh->triangle_count; h++) {
        int32_t twin = topology->twin[h];
        const int32_t *t = mesh->triangles[h / 3], *u = mesh->triangles[twin / 3];
        int32_t hinge[4] = {t[h % 3], t[(h + 1) % 3], t[(h + 2) % 3], u[(twin + 2) % 3]};
        if (h < twin && !has_edges)
            add_element(&s, hinge, 4);
        if (h < twin && has_edges)
            for (int k = 0; k < 3; k++)
                s.places[e][k] = 0.5 * (s.places[hinge[0]][k] + s.places[hinge[1]][k]);
        edge_of[h] = h < twin ? e++ : edge_of[twin];
    }
    for (int32_t t = 0; t < mesh->triangle_count && has_edges; t++) {
        const int32_t *v = mesh->triangles[t];
        add_element(&s, (int32_t[]){v[0], v[1], v[2], edge_of[3 * t], edge_of[3 * t + 1], edge_of[3 * t + 2]}, 6);
    }
    free(edge_of);
    pel_topology_destroy(topology);
    return s;
}

static void release_shell(shell *s)
{
    free(s->start);
    free(s->nodes);
    free(s->sizes);
    free(s->places);
}

static double milliseconds(double *times, int count, double *median)
{
    bench_spread spread = bench_spread_of(times, count);
    *median = 1e3 * spread.median;
    return 1e3 * spread.least;
}

/* |b - A x| / |b| */
static double residual_of(const pel_matrix *m, const double *b, const double *x, double *product)
{
    double error = 0, size = 0;
    pel_matrix_multiply(m, NULL, x, product);
    for (int32_t i = 0; i < m->unknown_count; i++) {
        error += (b[i] - product[i]) * (b[i] - product[i]);
        size += b[i] * b[i];
    }
    return sqrt(error / size);
}

/* conjugate gradients to 1e-8 */
static void bench_pcg(const pel_matrix *m, const char *name, pel_preconditioner *precondition, void *context,
                      pel_pool *pool, const double *b, double *x)
{
    pel_error error;
    pel_pcg *pcg;
    bench_check(pel_pcg_create(m->unknown_count, &pcg, &error), &error);
    double times[REPEATS], median;
    pel_pcg_result result = {.iterations = 0};
    for (int i = 0; i < REPEATS; i++) {
        pel_pcg_def def = {.matrix = m,
                           .precondition = precondition,
                           .preconditioner = context,
                           .tolerance = 1e-8,
                           .iterations = 1000};
        double begin = seconds();
        result = pel_pcg_solve(pcg, &def, pool, b, x);
        times[i] = seconds() - begin;
    }
    double least = milliseconds(times, REPEATS, &median);
    printf("  conjugate gradients, %s: %d iterations to %.0e, %.2f ms min %.2f median\n", name, (int)result.iterations,
           result.residual, least, median);
    pel_pcg_destroy(pcg);
}

/* returns the least time of a factorization [ms] */
static double bench_factor(const pel_matrix *m, const pel_factor_plan *plan, pel_factor_precision precision,
                           pel_pool *pool, const double *b, double *x, double *product)
{
    pel_error error;
    pel_factor *factor;
    bench_check(pel_factor_create(plan, precision, &factor, &error), &error);
    double times[REPEATS], solves[REPEATS], median, solve_median;
    pel_factor_result result = {0};
    for (int i = 0; i < REPEATS; i++) {
        double begin = seconds();
        result = pel_factor_compute(factor, m, 0, pool);
        double middle = seconds();
        pel_factor_solve(factor, pool, b, x);
        times[i] = middle - begin;
        solves[i] = seconds() - middle;
    }
    pel_factor_cost cost = pel_factor_plan_cost(plan);
    double least = milliseconds(times, REPEATS, &median), solve = milliseconds(solves, REPEATS, &solve_median);
    printf("  %s factor %8.2f ms min %8.2f median, %5.1f G multiplications/s; solve %6.2f min %6.2f median; residual "
           "%.1e, least pivot %.1e, %.1f MB\n",
           precision == PEL_FACTOR_FLOAT ? "float " : "double", least, median, 1e-6 * cost.operations / 2 / least,
           solve, solve_median, residual_of(m, b, x, product), result.pivot, 1e-6 * (double)cost.bytes[precision]);
    bench_pcg(m, "factor", pel_factor_solve, factor, pool, b, x);
    pel_factor_destroy(factor);
    return least;
}

static void bench_jacobi(const pel_matrix *m, pel_pool *pool, const double *b, double *x)
{
    pel_error error;
    pel_jacobi *jacobi;
    bench_check(pel_jacobi_create(m, &jacobi, &error), &error);
    pel_jacobi_compute(jacobi, m);
    bench_pcg(m, "block Jacobi", pel_jacobi_apply, jacobi, pool, b, x);
    pel_jacobi_destroy(jacobi);
}

/* other libraries, and how many times as long they take as our factors of least milliseconds in float and double */
static void bench_peers(const pel_matrix *m, const double *b, const double least[2])
{
#ifdef PEL_PEERS
    peer_times times[4];
    for (int i = 0, count = peer_linear(m, b, seconds, 3, times); i < count; i++)
        printf("  %-20s analysis %7.1f ms, factor %8.2f ms min (%.1f times our float, %.1f times our double); solve "
               "%.2f; residual %.1e\n",
               times[i].name, 1e3 * times[i].analyze, 1e3 * times[i].factor, 1e3 * times[i].factor / least[0],
               1e3 * times[i].factor / least[1], 1e3 * times[i].solve, times[i].residual);
#else
    (void)m;
    (void)b;
    (void)least;
#endif
}

static void bench_shell(const pel_mesh *mesh, bool has_edges, int threads)
{
    pel_error error;
    pel_pool *pool;
    bench_check(pel_pool_create(threads, &pool, &error), &error);
    shell s = make_shell(mesh, has_edges);
    s.bending = 1e-4;
    pel_matrix_def def = {s.node_count, s.sizes, s.element_count, s.start, s.nodes, NULL, 0, NULL};
    pel_matrix *m;
    double begin = seconds();
    bench_check(pel_matrix_create(&def, &m, &error), &error);
    double pattern = seconds() - begin, times[REPEATS], median;
    for (int i = 0; i < REPEATS; i++) {
        begin = seconds();
        pel_matrix_assemble(m, pool, has_edges ? fill_triangles : fill_hinges, &s);
        times[i] = seconds() - begin;
    }
    double assemble = milliseconds(times, REPEATS, &median);
    pel_matrix_add_diagonal(m, 1e-4, NULL);
    double *b = bench_allocate((size_t)m->unknown_count, sizeof *b),
           *x = bench_allocate((size_t)m->unknown_count, sizeof *x),
           *y = bench_allocate((size_t)m->unknown_count, sizeof *y);
    for (int32_t i = 0; i < m->unknown_count; i++)
        b[i] = sin(i);
    for (int i = 0; i < REPEATS; i++) {
        begin = seconds();
        pel_matrix_multiply(m, pool, b, y);
        times[i] = seconds() - begin;
    }
    double product = milliseconds(times, REPEATS, &median);
    pel_factor_plan *plan = NULL;
    for (int i = 0; i < REPEATS; i++) {
        pel_factor_plan_destroy(plan);
        begin = seconds();
        bench_check(pel_factor_plan_create(m, (const double(*)[3])s.places, &plan, &error), &error);
        times[i] = seconds() - begin;
    }
    double planning = milliseconds(times, REPEATS, &median);
    pel_factor_cost cost = pel_factor_plan_cost(plan);
    printf(
        "%d triangles, %s, %d threads: %d unknowns; pattern %.1f ms, plan %.1f ms, assembly %.2f, product %.2f; %.2f M "
        "entries, %.2f G multiplications, %d fronts, largest %d\n",
        (int)mesh->triangle_count, has_edges ? "mid-edge" : "hinges", threads, (int)m->unknown_count, 1e3 * pattern,
        planning, assemble, product, 1e-6 * (double)cost.entries, 5e-10 * cost.operations, (int)cost.fronts,
        (int)cost.largest_front);
    bench_jacobi(m, pool, b, x);
    double least[2] = {bench_factor(m, plan, PEL_FACTOR_FLOAT, pool, b, x, y),
                       bench_factor(m, plan, PEL_FACTOR_DOUBLE, pool, b, x, y)};
    bench_peers(m, b, least);
    free(b);
    free(x);
    free(y);
    pel_factor_plan_destroy(plan);
    pel_matrix_destroy(m);
    release_shell(&s);
    pel_pool_destroy(pool);
}

int main(int argument_count, char **arguments)
{
    int threads = argument_count > 1 ? atoi(arguments[1]) : 1;
    seconds = threads == 1 ? pel_thread_seconds : pel_seconds;
    int frequency = argument_count > 2 ? atoi(arguments[2]) : 32;
    pel_mesh *mesh = bench_sphere(frequency);
    bench_shell(mesh, false, threads);
    bench_shell(mesh, true, threads);
    pel_mesh_destroy(mesh);
    return 0;
}
