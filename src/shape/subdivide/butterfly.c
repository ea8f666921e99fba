/* The stencils of Zorin, Schroeder and Sweldens 1996 ("Interpolating subdivision for meshes with arbitrary topology").

   An irregular end c with K triangles around and ring x_0 .. x_(K-1), x_0 being the other end of the edge:
       3/4 c + sum_j s_j x_j,   K = 3: 5/12, -1/12, -1/12    K = 4: 3/8, 0, -1/8, 0
                                K >= 5: s_j = (1/4 + cos(2 pi j / K) + cos(4 pi j / K) / 2) / K
   All three are s_j = (1/4 + cos(2 pi j / K) + g cos(4 pi j / K)) / K with g = 0, 1/4, 1/2, because a ring of three has
   no second harmonic and a ring of four only one half of it. So the points of all K edges of a ring come from five sums
   over it (its mean, and cosine and sine waves of both harmonics): linear time for a vertex of any valence. The sums
   are of x_j - c, which is exact for a far away mesh, as the weights add up to one.

   The eight points of the regular rule are summed in pairs such that the direction of the edge and a mirror image do
   not change a bit of the result. */
#include "subdivide/butterfly.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/functions.h"

#include <math.h>
#include <string.h>

/* rings up to this size have tables: ring K starts at K (K - 1) of the cosine-sine pairs */
enum { SHORT_RING = 16, SHORT_PAIRS = SHORT_RING * (SHORT_RING + 1) / 2 };
/* buffer of several rings that are gathered together: each step around a vertex depends on the previous one, so that a
   single ring leaves the processor idle */
enum { LEAST_RINGS = 256 };

static void fill_wave(int32_t ring_size, double *wave)
{
    for (int32_t j = 0; j < ring_size; j++) {
        double angle = 6.283185307179586477 * j / ring_size;
        wave[2 * j] = pel_cos(angle);
        wave[2 * j + 1] = pel_sin(angle);
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
    size_t ring = (size_t)base->triangle_count + LEAST_RINGS;
    return (size_t)base->vertex_count * 2 * sizeof(int32_t) + ring * 2 * (sizeof(int32_t) + sizeof(double)) +
           2 * SHORT_PAIRS * sizeof(double);
}

/* lists the irregular vertices and keeps their ring sizes; returns the size of the longest ring */
static int32_t find_irregular(pel_butterfly *butterfly, const pel_topology *base)
{
    int32_t longest = 0, *size = butterfly->ring_size;
    const int32_t *origin = base->triangles[0];
    for (int32_t h = 0; h < 3 * base->triangle_count; h++)
        size[origin[h]]++;
    for (int32_t v = 0; v < base->vertex_count; v++) {
        int32_t corner = base->corner_of_vertex[v];
        if (size[v] == 6 || corner < 0 || base->twin[corner] < 0) {
            size[v] = 0;
            continue;
        }
        butterfly->irregular[butterfly->irregular_count++] = v;
        longest = size[v] > longest ? size[v] : longest;
    }
    return longest;
}

static bool allocate_butterfly(pel_butterfly *butterfly, const pel_topology *base)
{
    butterfly->base_vertex_count = base->vertex_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(butterfly->irregular, base->vertex_count),
                          PEL_ROOM(butterfly->ring_size, base->vertex_count)))
        return false;
    size_t longest = (size_t)find_irregular(butterfly, base);
    butterfly->ring_limit = (int32_t)longest > LEAST_RINGS ? (int32_t)longest : LEAST_RINGS;
    return PEL_ALLOCATE_ALL(PEL_ROOM(butterfly->ring, 2 * (size_t)butterfly->ring_limit),
                            PEL_ROOM(butterfly->wave, 2 * (SHORT_PAIRS + longest)));
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
    PEL_FREE_ALL(butterfly->irregular, butterfly->ring_size, butterfly->ring, butterfly->wave, butterfly);
}

static inline bool is_irregular(const pel_butterfly *butterfly, int32_t v)
{
    return v < butterfly->base_vertex_count && butterfly->ring_size[v] != 0;
}

/* vertices and edges around v, one after the other; returns the end */
static int32_t *gather_ring(const pel_butterfly *butterfly, const pel_topology *level, int32_t v, int32_t *ring)
{
    PEL_ASSERT_INDEX(v, level->vertex_count);
    const int32_t *origin = level->triangles[0];
    int32_t h = level->corner_of_vertex[v], *end = ring + 2 * butterfly->ring_size[v];
    for (; ring != end; ring += 2) {
        ring[0] = origin[pel_half_edge_next(h)];
        ring[1] = level->edge_of_half_edge[h];
        h = level->twin[pel_half_edge_previous(h)];
    }
    return end;
}

/* the rings of irregular vertices from the k-th on, up to the size of the buffer; returns the one after the last */
static int32_t gather_rings(const pel_butterfly *butterfly, const pel_topology *level, int32_t k)
{
    int32_t *ring = butterfly->ring, *limit = ring + 2 * butterfly->ring_limit;
    for (; k < butterfly->irregular_count; k++) {
        int32_t v = butterfly->irregular[k];
        if (limit - ring < 2 * butterfly->ring_size[v])
            break;
        ring = gather_ring(butterfly, level, v, ring);
    }
    return k;
}

/* the count of components is a constant at each call of edge_values */
#define ROW_INLINE static inline __attribute__((always_inline))

/* up to four components together */
typedef double quad __attribute__((vector_size(32)));
enum { QUAD = 4 };

ROW_INLINE quad splat(double a)
{
    return (quad){a, a, a, a};
}

/* the first `count` components; the others are 0 */
ROW_INLINE quad load(const double *row, int32_t count)
{
    return (quad){row[0], count > 1 ? row[1] : 0, count > 2 ? row[2] : 0, count > 3 ? row[3] : 0};
}

ROW_INLINE void store(double *row, int32_t count, quad a)
{
    for (int32_t c = 0; c < count; c++)
        row[c] = a[c];
}

/* `count` components of all rows, from `first` on */
typedef struct columns {
    double *values;
    size_t row_size;
    int32_t count;
} columns;

ROW_INLINE quad load_row(const columns *part, int32_t v)
{
    return load(part->values + (size_t)v * part->row_size, part->count);
}

/* ---- irregular ends ---- */

/* the values of all edges around an irregular vertex; half of them if the other end is irregular too: the end with the
   lower number comes first. The sums are of differences from the centre: mean, and waves of both harmonics */
ROW_INLINE void ring_values(const pel_butterfly *butterfly, const pel_topology *level, int32_t v, const int32_t *ring,
                            const columns *part, const double *wave)
{
    PEL_ASSERT_INDEX(v, level->vertex_count);
    const int32_t size = butterfly->ring_size[v];
    const quad second = splat(size == 3 ? 0 : size == 4 ? 0.25 : 0.5), inverse = splat(1.0 / size);
    const quad centre = load_row(part, v);
    quad mean = splat(0), cosine1 = mean, sine1 = mean, cosine2 = mean, sine2 = mean;
    for (int32_t j = 0, k = 0; j < size; j++, k = k + 2 < size ? k + 2 : k + 2 - size) {
        quad difference = load_row(part, ring[2 * j]) - centre;
        mean += difference;
        cosine1 += splat(wave[2 * j]) * difference;
        sine1 += splat(wave[2 * j + 1]) * difference;
        cosine2 += splat(wave[2 * k]) * difference;
        sine2 += splat(wave[2 * k + 1]) * difference;
    }
    for (int32_t j = 0, k = 0; j < size; j++, k = k + 2 < size ? k + 2 : k + 2 - size) {
        quad first_wave = splat(wave[2 * j]) * cosine1 + splat(wave[2 * j + 1]) * sine1;
        quad second_wave = splat(wave[2 * k]) * cosine2 + splat(wave[2 * k + 1]) * sine2;
        quad value = centre + inverse * (splat(0.25) * mean + first_wave + second * second_wave);
        double *row = part->values + (size_t)(level->vertex_count + ring[2 * j + 1]) * part->row_size;
        if (is_irregular(butterfly, ring[2 * j]))
            value = splat(0.5) * value + (ring[2 * j] < v ? load(row, part->count) : splat(0));
        store(row, part->count, value);
    }
}

/* ---- other edges ---- */

ROW_INLINE int32_t tip_of(const pel_topology *level, int32_t h)
{
    PEL_ASSERT_INDEX(h, 3 * level->triangle_count);
    const int32_t *origin = level->triangles[0];
    return origin[pel_half_edge_previous(h)];
}

/* the point across an edge: the tip of the triangle there, or p + q - r beyond the boundary edge p q of triangle p q r
 */
ROW_INLINE quad tip_across(const pel_topology *level, int32_t h, const columns *part, quad p, quad q, quad r)
{
    PEL_ASSERT_INDEX(h, 3 * level->triangle_count);
    int32_t g = level->twin[h];
    return g >= 0 ? load_row(part, tip_of(level, g)) : p + q - r;
}

ROW_INLINE quad regular_value(const pel_topology *level, int32_t h, int32_t g, const columns *part)
{
    PEL_ASSERT_INDEX(h, 3 * level->triangle_count);
    const int32_t *origin = level->triangles[0];
    const int32_t h1 = pel_half_edge_next(h), h2 = pel_half_edge_previous(h);
    const int32_t g1 = pel_half_edge_next(g), g2 = pel_half_edge_previous(g);
    const quad a = load_row(part, origin[h]), b = load_row(part, origin[h1]);
    const quad left = load_row(part, origin[h2]), right = load_row(part, origin[g2]);
    quad tips = (tip_across(level, h1, part, b, left, a) + tip_across(level, h2, part, left, a, b)) +
                (tip_across(level, g1, part, a, right, b) + tip_across(level, g2, part, right, b, a));
    return splat(0.5) * (a + b) + splat(0.125) * (left + right) - splat(0.0625) * tips;
}

/* half-edge h is the first about its origin; the last one ends in the boundary edge before */
ROW_INLINE quad boundary_value(const pel_topology *level, int32_t h, const columns *part)
{
    PEL_ASSERT_INDEX(h, 3 * level->triangle_count);
    int32_t last = h, turned;
    while ((turned = pel_half_edge_turn(level, last)) >= 0)
        last = turned;
    int32_t before = tip_of(level, last), end = pel_half_edge_target(level, h);
    int32_t after = pel_half_edge_target(level, level->corner_of_vertex[end]);
    quad ends = load_row(part, pel_half_edge_origin(level, h)) + load_row(part, end);
    quad outer = load_row(part, before) + load_row(part, after);
    return splat(0.5625) * ends - splat(0.0625) * outer;
}

/* one body for any number of components up to four, compiled for each of them */
ROW_INLINE void edge_values(pel_butterfly *butterfly, const pel_topology *level, const columns *part)
{
    for (int32_t k = 0, end; k < butterfly->irregular_count; k = end) {
        const int32_t *ring = butterfly->ring;
        end = gather_rings(butterfly, level, k);
        for (int32_t i = k; i < end; i++) {
            int32_t v = butterfly->irregular[i], size = butterfly->ring_size[v];
            ring_values(butterfly, level, v, ring, part, wave_of_ring(butterfly, size));
            ring += 2 * size;
        }
    }
    const int32_t *origin = level->triangles[0];
    double *row = part->values + (size_t)level->vertex_count * part->row_size;
    for (int32_t h = 0; h < 3 * level->triangle_count; h++) {
        int32_t g = level->twin[h];
        if (g >= 0 && g < h)
            continue;
        if (g < 0)
            store(row, part->count, boundary_value(level, h, part));
        else if (!is_irregular(butterfly, origin[h]) && !is_irregular(butterfly, origin[g]))
            store(row, part->count, regular_value(level, h, g, part));
        row += part->row_size;
    }
}

void pel_butterfly_edge_values(pel_butterfly *butterfly, const pel_topology *level, int32_t component_count,
                               double *values)
{
    const size_t n = (size_t)component_count;
    for (int32_t first = 0; first < component_count; first += QUAD) {
        int32_t count = component_count - first < QUAD ? component_count - first : QUAD;
        double *from = values + first;
        if (n == 3)
            edge_values(butterfly, level, &(columns){from, 3, 3});
        else if (n == 1)
            edge_values(butterfly, level, &(columns){from, 1, 1});
        else
            edge_values(butterfly, level, &(columns){from, n, count});
    }
}
