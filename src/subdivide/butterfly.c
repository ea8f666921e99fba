/* The stencils of Zorin, Schroeder and Sweldens 1996 ("Interpolating subdivision for meshes with arbitrary topology").

   An irregular end c with K triangles around and ring x_0 .. x_(K-1), x_0 being the other end of the edge:
       3/4 c + sum_j s_j x_j,   K = 3: 5/12, -1/12, -1/12    K = 4: 3/8, 0, -1/8, 0
                                K >= 5: s_j = (1/4 + cos(2 pi j / K) + cos(4 pi j / K) / 2) / K
   All three are s_j = (1/4 + cos(2 pi j / K) + g cos(4 pi j / K)) / K with g = 0, 1/4, 1/2, for a ring of three has no
   second harmonic and a ring of four only one half of it. So the points of all K edges of a ring come from five sums
   over it (its mean, and cosine and sine waves of both harmonics): linear time for a vertex of any valence. The sums
   are of x_j - c, which is exact for a far away mesh, as the weights add up to one.

   The eight points of the regular rule are summed in pairs such that neither the side of the edge that comes first nor
   a mirror image changes a bit of the result. */
#include "subdivide/butterfly.h"

#include "base/memory.h"
#include "base/status.h"

#include <math.h>
#include <string.h>

/* rings up to this size have tables of their own: ring K starts at K (K - 1) of the cosine-sine pairs */
enum { SHORT_RING = 16, SHORT_PAIRS = SHORT_RING * (SHORT_RING + 1) / 2 };

/* triangles around a vertex; 0 on the boundary or without triangles */
static int32_t inner_ring_size(const pel_topology *topology, int32_t v)
{
    int32_t begin = topology->corner_of_vertex[v], size = 0;
    if (begin < 0 || topology->twin[begin] < 0)
        return 0;
    int32_t h = begin;
    do {
        size++;
        h = pel_half_edge_turn(topology, h);
    } while (h != begin);
    return size;
}

static void fill_wave(int32_t ring_size, double *wave)
{
    for (int32_t j = 0; j < ring_size; j++) {
        double angle = 6.283185307179586477 * j / ring_size;
        wave[2 * j] = cos(angle);
        wave[2 * j + 1] = sin(angle);
    }
}

static double *short_wave(const pel_butterfly *butterfly, int32_t ring_size)
{
    return butterfly->wave + ring_size * (ring_size - 1);
}

/* cosine and sine of 2 pi j / K */
static const double *wave_of_ring(pel_butterfly *butterfly, int32_t ring_size)
{
    if (ring_size <= SHORT_RING)
        return short_wave(butterfly, ring_size);
    double *wave = butterfly->wave + 2 * SHORT_PAIRS;
    if (butterfly->long_ring != ring_size) {
        fill_wave(ring_size, wave);
        butterfly->long_ring = ring_size;
    }
    return wave;
}

size_t pel_butterfly_bytes(const pel_topology *base)
{
    size_t ring = (size_t)base->triangle_count;
    return (size_t)base->vertex_count * 2 * sizeof(int32_t) + ring * 2 * (sizeof(int32_t) + sizeof(double)) +
           2 * SHORT_PAIRS * sizeof(double);
}

/* marks and lists the irregular vertices; returns the size of the longest ring */
static int32_t find_irregular(pel_butterfly *butterfly, const pel_topology *base)
{
    int32_t longest = 0;
    for (int32_t v = 0; v < base->vertex_count; v++) {
        int32_t size = inner_ring_size(base, v);
        if (size == 0 || size == 6)
            continue;
        butterfly->ring_size[v] = size;
        butterfly->irregular[butterfly->irregular_count++] = v;
        if (size > longest)
            longest = size;
    }
    return longest;
}

static bool allocate_butterfly(pel_butterfly *butterfly, const pel_topology *base)
{
    butterfly->base_vertex_count = base->vertex_count;
    butterfly->irregular = pel_allocate((size_t)base->vertex_count, sizeof *butterfly->irregular);
    butterfly->ring_size = pel_allocate((size_t)base->vertex_count, sizeof *butterfly->ring_size);
    if (butterfly->irregular == NULL || butterfly->ring_size == NULL)
        return false;
    size_t longest = (size_t)find_irregular(butterfly, base);
    butterfly->ring = pel_allocate(2 * longest, sizeof *butterfly->ring);
    butterfly->wave = pel_allocate(2 * (SHORT_PAIRS + longest), sizeof *butterfly->wave);
    return butterfly->ring != NULL && butterfly->wave != NULL;
}

pel_status pel_butterfly_create(const pel_topology *base, pel_butterfly **butterfly, pel_error *error)
{
    *butterfly = NULL;
    pel_butterfly *made = pel_allocate(1, sizeof *made);
    if (made == NULL || !allocate_butterfly(made, base)) {
        pel_butterfly_destroy(made);
        return pel_fail_memory(error);
    }
    for (int32_t size = 1; size <= SHORT_RING; size++)
        fill_wave(size, short_wave(made, size));
    *butterfly = made;
    return PEL_OK;
}

void pel_butterfly_destroy(pel_butterfly *butterfly)
{
    if (butterfly == NULL)
        return;
    pel_free(butterfly->irregular);
    pel_free(butterfly->ring_size);
    pel_free(butterfly->ring);
    pel_free(butterfly->wave);
    pel_free(butterfly);
}

static inline bool is_irregular(const pel_butterfly *butterfly, int32_t v)
{
    return v < butterfly->base_vertex_count && butterfly->ring_size[v] != 0;
}

/* vertices and edges around v into butterfly->ring, one after the other */
static void gather_ring(pel_butterfly *butterfly, const pel_topology *level, int32_t v)
{
    const int32_t *origin = level->triangles[0];
    int32_t h = level->corner_of_vertex[v], *ring = butterfly->ring, *end = ring + 2 * butterfly->ring_size[v];
    for (; ring != end; ring += 2) {
        ring[0] = origin[pel_half_edge_next(h)];
        ring[1] = level->edge_of_half_edge[h];
        h = level->twin[pel_half_edge_previous(h)];
    }
}

/* five sums over a ring of one component's differences from the centre: mean, and waves of both harmonics */
typedef struct ring_sums {
    double centre, mean, cosine1, sine1, cosine2, sine2;
} ring_sums;

/* the values of all edges around an irregular vertex, in `count` (at most RING_BLOCK) components from `first` on; half
   of them where the other end is irregular too: the end with the lower number comes first */
enum { RING_BLOCK = 3 };
static inline void ring_block(const pel_butterfly *butterfly, const pel_topology *level, int32_t v, int32_t n,
                              int32_t first, int32_t count, const double *wave, double *values)
{
    const int32_t size = butterfly->ring_size[v], *ring = butterfly->ring;
    const double second = size == 3 ? 0 : size == 4 ? 0.25 : 0.5, inverse = 1.0 / size;
    ring_sums sums[RING_BLOCK];
    memset(sums, 0, sizeof sums);
    for (int32_t c = 0; c < count; c++)
        sums[c].centre = values[(size_t)v * (size_t)n + (size_t)(first + c)];
    for (int32_t j = 0, k = 0; j < size; j++, k = k + 2 < size ? k + 2 : k + 2 - size) {
        const double *row = values + (size_t)ring[2 * j] * (size_t)n + first;
        for (int32_t c = 0; c < count; c++) {
            double difference = row[c] - sums[c].centre;
            sums[c].mean += difference;
            sums[c].cosine1 += wave[2 * j] * difference;
            sums[c].sine1 += wave[2 * j + 1] * difference;
            sums[c].cosine2 += wave[2 * k] * difference;
            sums[c].sine2 += wave[2 * k + 1] * difference;
        }
    }
    for (int32_t j = 0, k = 0; j < size; j++, k = k + 2 < size ? k + 2 : k + 2 - size) {
        bool halved = is_irregular(butterfly, ring[2 * j]), added = halved && ring[2 * j] < v;
        double *row = values + ((size_t)level->vertex_count + (size_t)ring[2 * j + 1]) * (size_t)n + first;
        for (int32_t c = 0; c < count; c++) {
            double first_wave = wave[2 * j] * sums[c].cosine1 + wave[2 * j + 1] * sums[c].sine1;
            double second_wave = wave[2 * k] * sums[c].cosine2 + wave[2 * k + 1] * sums[c].sine2;
            double value = sums[c].centre + inverse * (0.25 * sums[c].mean + first_wave + second * second_wave);
            row[c] = halved ? (added ? row[c] : 0) + 0.5 * value : value;
        }
    }
}

static inline void ring_values(pel_butterfly *butterfly, const pel_topology *level, int32_t v, int32_t n,
                               double *values)
{
    const double *wave = wave_of_ring(butterfly, butterfly->ring_size[v]);
    gather_ring(butterfly, level, v);
    int32_t c = 0;
    for (; c + RING_BLOCK <= n; c += RING_BLOCK)
        ring_block(butterfly, level, v, n, c, RING_BLOCK, wave, values);
    for (; c < n; c++)
        ring_block(butterfly, level, v, n, c, 1, wave, values);
}

/* a point across an edge: the tip of the triangle there, or p + q - r beyond the boundary edge p q of triangle p q r */
typedef struct across {
    const double *tip; /* or null */
    const double *p, *q, *r;
} across;

static inline int32_t tip_of(const pel_topology *level, int32_t h)
{
    const int32_t *origin = level->triangles[0];
    return origin[pel_half_edge_previous(h)];
}

static inline const double *row_of(const double *values, int32_t v, int32_t n)
{
    return values + (size_t)v * (size_t)n;
}

static inline across look_across(const pel_topology *level, int32_t h, const double *p, const double *q,
                                 const double *r, int32_t n, const double *values)
{
    int32_t g = level->twin[h];
    if (g < 0)
        return (across){NULL, p, q, r};
    return (across){row_of(values, tip_of(level, g), n), p, q, r};
}

static inline double across_value(const across *point, int32_t c)
{
    return point->tip != NULL ? point->tip[c] : point->p[c] + point->q[c] - point->r[c];
}

static inline void regular_value(const pel_topology *level, int32_t h, int32_t g, int32_t n, const double *values,
                                 double *value)
{
    const int32_t *origin = level->triangles[0];
    const int32_t h1 = pel_half_edge_next(h), h2 = pel_half_edge_previous(h);
    const int32_t g1 = pel_half_edge_next(g), g2 = pel_half_edge_previous(g);
    const double *a = row_of(values, origin[h], n), *b = row_of(values, origin[h1], n);
    const double *left = row_of(values, origin[h2], n), *right = row_of(values, origin[g2], n);
    const across outer[4] = {
        look_across(level, h1, b, left, a, n, values), look_across(level, h2, left, a, b, n, values),
        look_across(level, g1, a, right, b, n, values), look_across(level, g2, right, b, a, n, values)};
    for (int32_t c = 0; c < n; c++) {
        double tips = (across_value(&outer[0], c) + across_value(&outer[1], c)) +
                      (across_value(&outer[2], c) + across_value(&outer[3], c));
        value[c] = 0.5 * (a[c] + b[c]) + 0.125 * (left[c] + right[c]) - 0.0625 * tips;
    }
}

/* half-edge h is the first about its origin; the last one ends in the boundary edge before */
static inline void boundary_value(const pel_topology *level, int32_t h, int32_t n, const double *values, double *value)
{
    int32_t last = h, turned;
    while ((turned = pel_half_edge_turn(level, last)) >= 0)
        last = turned;
    int32_t before = tip_of(level, last), end = pel_half_edge_target(level, h);
    int32_t after = pel_half_edge_target(level, level->corner_of_vertex[end]);
    const double *a = row_of(values, pel_half_edge_origin(level, h), n), *b = row_of(values, end, n);
    const double *outer_a = row_of(values, before, n), *outer_b = row_of(values, after, n);
    for (int32_t c = 0; c < n; c++)
        value[c] = 0.5625 * (a[c] + b[c]) - 0.0625 * (outer_a[c] + outer_b[c]);
}

/* one body for any number of components, compiled for three and for one */
static inline void edge_values(pel_butterfly *butterfly, const pel_topology *level, int32_t n, double *values)
{
    for (int32_t k = 0; k < butterfly->irregular_count; k++)
        ring_values(butterfly, level, butterfly->irregular[k], n, values);
    const int32_t *origin = level->triangles[0];
    double *value = values + (size_t)level->vertex_count * (size_t)n;
    for (int32_t h = 0; h < 3 * level->triangle_count; h++) {
        int32_t g = level->twin[h];
        if (g >= 0 && g < h)
            continue;
        if (g < 0)
            boundary_value(level, h, n, values, value);
        else if (!is_irregular(butterfly, origin[h]) && !is_irregular(butterfly, origin[g]))
            regular_value(level, h, g, n, values, value);
        value += n;
    }
}

void pel_butterfly_edge_values(pel_butterfly *butterfly, const pel_topology *level, int32_t component_count,
                               double *values)
{
    if (component_count == 3)
        edge_values(butterfly, level, 3, values);
    else if (component_count == 1)
        edge_values(butterfly, level, 1, values);
    else
        edge_values(butterfly, level, component_count, values);
}
