/* Shapes of revolution about z: a list of rows (parallels), each a ring of equally spaced points or a single point on
   the axis, stitched from one row to the next. Rows run from top to bottom along the outside, which turns the triangles
   outward. Neighbouring rows may have different counts (the discs that close a cylinder). */
#include "primitive/shape_build.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "mesh/allocate.h"

#include <math.h>

typedef struct row {
    double radius, z;
    int32_t count; /* 1 = a point on the axis */
} row;

/* cosine and sine of step/count of a full turn, exact at quarters and mirrored in bits about every eighth */
static void turn(int32_t step, int32_t count, double *cosine, double *sine)
{
    const double quarter = 1.57079632679489661923;
    int64_t quadrant = 4 * (int64_t)step / count, rest = 4 * (int64_t)step % count;
    bool past_eighth = 2 * rest > count;
    double angle = quarter * (double)(past_eighth ? count - rest : rest) / (double)count;
    double c = past_eighth ? pel_sin(angle) : pel_cos(angle), s = past_eighth ? pel_cos(angle) : pel_sin(angle);
    const double cosines[4] = {c, -s, -c, s}, sines[4] = {s, c, -s, -c};
    *cosine = cosines[quadrant % 4];
    *sine = sines[quadrant % 4];
}

static void fill_row(const row *ring, double (*positions)[3])
{
    if (ring->count == 1) {
        pel_vec3_set(positions[0], 0, 0, ring->z);
        return;
    }
    for (int32_t k = 0; k < ring->count; k++) {
        double c, s;
        turn(k, ring->count, &c, &s);
        pel_vec3_set(positions[k], ring->radius * c, ring->radius * s, ring->z);
    }
}

static int64_t strip_triangle_count(const row *upper, const row *lower)
{
    return (upper->count > 1 ? (int64_t)upper->count : 0) + (lower->count > 1 ? (int64_t)lower->count : 0);
}

/* triangles between two rings of m and n points; of the two possible diagonals the one that turns less */
static void stitch(const row *upper, int32_t upper_first, const row *lower, int32_t lower_first,
                   int32_t (**triangles)[3])
{
    int64_t m = upper->count, n = lower->count, i = 0, j = 0;
    int64_t m_end = m > 1 ? m : 0, n_end = n > 1 ? n : 0;
    while (i < m_end || j < n_end) {
        int32_t a = upper_first + (int32_t)(i % m), b = lower_first + (int32_t)(j % n);
        bool advance_upper = j == n_end || (i < m_end && (i + 1) * n - j * m <= (j + 1) * m - i * n);
        if (advance_upper)
            pel_shape_put_triangle(triangles, a, b, upper_first + (int32_t)(++i % m));
        else
            pel_shape_put_triangle(triangles, a, b, lower_first + (int32_t)(++j % n));
    }
}

/* closed_ring: the last row is stitched to the first (torus) */
static pel_status revolve(const row *rows, int32_t row_count, bool closed_ring, pel_mesh **mesh, pel_error *error)
{
    int64_t vertex_count = 0, triangle_count = 0;
    int32_t strip_count = closed_ring ? row_count : row_count - 1;
    for (int32_t r = 0; r < row_count; r++)
        vertex_count += rows[r].count;
    for (int32_t r = 0; r < strip_count; r++)
        triangle_count += strip_triangle_count(&rows[r], &rows[(r + 1) % row_count]);
    pel_status status = pel_shape_check_size(vertex_count, triangle_count, error);
    if (status != PEL_OK)
        return status;
    pel_mesh *made = pel_mesh_allocate((int32_t)vertex_count, (int32_t)triangle_count);
    if (made == NULL)
        return pel_fail_memory(error);
    int32_t(*triangles)[3] = made->triangles;
    for (int32_t r = 0, first = 0; r < row_count; r++) {
        fill_row(&rows[r], made->positions + first);
        int32_t next_first = r + 1 < row_count ? first + rows[r].count : 0;
        if (r < strip_count)
            stitch(&rows[r], first, &rows[(r + 1) % row_count], next_first, &triangles);
        first = next_first;
    }
    *mesh = made;
    return PEL_OK;
}

/* revolves rows that were allocated, and frees them */
static pel_status revolve_and_free(row *rows, int32_t row_count, bool closed_ring, pel_mesh **mesh, pel_error *error)
{
    pel_status status = revolve(rows, row_count, closed_ring, mesh, error);
    pel_free(rows);
    return status;
}

pel_status pel_shape_uv_sphere(const pel_shape_def *def, pel_mesh **mesh, pel_error *error)
{
    row *rows = pel_allocate((size_t)def->rings + 1, sizeof *rows);
    if (rows == NULL)
        return pel_fail_memory(error);
    for (int32_t r = 0; r <= def->rings; r++) {
        double c, s;
        turn(r, 2 * def->rings, &c, &s);
        rows[r] = (row){def->radius * s, def->radius * c, r == 0 || r == def->rings ? 1 : def->slices};
    }
    return revolve_and_free(rows, def->rings + 1, false, mesh, error);
}

/* rows of a disc from its middle outward, without the rim; spacing as on the rim. Returns how many */
static int32_t disc_ring_count(int32_t slices)
{
    return slices < 9 ? 1 : (slices + 3) / 6;
}

static row disc_row(const pel_shape_def *def, int32_t ring, double z)
{
    int32_t rings = disc_ring_count(def->slices);
    int64_t count = ((int64_t)def->slices * ring + rings / 2) / rings;
    return (row){def->radius * (double)ring / (double)rings, z, ring == 0 ? 1 : (int32_t)count};
}

pel_status pel_shape_disk(const pel_shape_def *def, pel_mesh **mesh, pel_error *error)
{
    row *rows = pel_allocate((size_t)def->rings + 1, sizeof *rows);
    if (rows == NULL)
        return pel_fail_memory(error);
    for (int32_t k = 0; k <= def->rings; k++)
        rows[k] = (row){def->radius * k / def->rings, 0, k == 0 ? 1 : 6 * k};
    return revolve_and_free(rows, def->rings + 1, false, mesh, error);
}

pel_status pel_shape_cylinder(const pel_shape_def *def, pel_mesh **mesh, pel_error *error)
{
    int32_t disc_rows = def->capped ? disc_ring_count(def->slices) : 0;
    int32_t row_count = def->segments + 1 + 2 * disc_rows, r = 0;
    row *rows = pel_allocate((size_t)row_count, sizeof *rows);
    if (rows == NULL)
        return pel_fail_memory(error);
    for (int32_t ring = 0; ring < disc_rows; ring++)
        rows[r++] = disc_row(def, ring, def->height / 2);
    for (int32_t k = 0; k <= def->segments; k++)
        rows[r++] = (row){def->radius, def->height * (0.5 - (double)k / def->segments), def->slices};
    for (int32_t ring = disc_rows - 1; ring >= 0; ring--)
        rows[r++] = disc_row(def, ring, -def->height / 2);
    return revolve_and_free(rows, row_count, false, mesh, error);
}

pel_status pel_shape_torus(const pel_shape_def *def, pel_mesh **mesh, pel_error *error)
{
    if (def->minor_radius >= def->major_radius)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "make minor_radius smaller, so that the hole stays open",
                          "torus: minor_radius %g is not less than major_radius %g", def->minor_radius,
                          def->major_radius);
    row *rows = pel_allocate((size_t)def->rings, sizeof *rows);
    if (rows == NULL)
        return pel_fail_memory(error);
    for (int32_t r = 0; r < def->rings; r++) {
        double c, s;
        turn(r, def->rings, &c, &s);
        rows[r] = (row){def->major_radius + def->minor_radius * c, def->minor_radius * (0 - s), def->slices};
    }
    return revolve_and_free(rows, def->rings, true, mesh, error);
}

pel_status pel_shape_capsule(const pel_shape_def *def, pel_mesh **mesh, pel_error *error)
{
    int32_t segments = def->height > 0 ? def->segments : 0;
    int32_t row_count = 2 * def->rings + 1 + segments, r = 0;
    row *rows = pel_allocate((size_t)row_count, sizeof *rows);
    if (rows == NULL)
        return pel_fail_memory(error);
    double half = def->height / 2, c, s;
    for (int32_t ring = 0; ring < def->rings; ring++) {
        turn(ring, 4 * def->rings, &c, &s);
        rows[r++] = (row){def->radius * s, half + def->radius * c, ring == 0 ? 1 : def->slices};
    }
    rows[r++] = (row){def->radius, half, def->slices};
    for (int32_t k = 1; k <= segments; k++)
        rows[r++] = (row){def->radius, def->height * (0.5 - (double)k / segments), def->slices};
    for (int32_t ring = def->rings - 1; ring >= 0; ring--) {
        turn(ring, 4 * def->rings, &c, &s);
        rows[r++] = (row){def->radius * s, -half - def->radius * c, ring == 0 ? 1 : def->slices};
    }
    return revolve_and_free(rows, row_count, false, mesh, error);
}
