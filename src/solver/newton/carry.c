/* The prepared factor is that of an earlier shape. Stiffness turns with the material: with the rotation R of each
   vertex's surroundings since then, the matrix is nearly R K R^T, and its inverse R K^-1 R^T. So the factor serves
   bodies that swing and turn far (corotation; Mueller and Gross 2004, of a factor instead of elements).

   R is the rotation nearest to the sum of x X^T over the ways to the neighbours of a vertex in the pattern, by their
   inverse squares. Vertices with fixed unknowns or axes of their own keep their axes. */
#include "measure/tetra.h"
#include "newton/run.h"

#include <string.h>

enum { CHUNK = 256 };
/* of the largest stretch: the second one of what has a rotation */
#define LEAST_SPREAD 1e-2

typedef struct carry_job {
    pel_newton *newton;
    const double *unknowns;
} carry_job;

static void set_identity(double r[9])
{
    memset(r, 0, 9 * sizeof *r);
    r[0] = r[4] = r[8] = 1;
}

static bool is_tied(const pel_newton *newton, int32_t v)
{
    const uint8_t *fixed = newton->fixed + 3 * (size_t)v;
    return newton->frame[v] >= 0 || fixed[0] != 0 || fixed[1] != 0 || fixed[2] != 0;
}

/* sum of x X^T over the neighbours, by rows */
static void find_spread(const pel_newton *newton, const double *unknowns, int32_t v, double f[9])
{
    const pel_matrix *matrix = newton->matrix;
    const double *before = newton->prepared_at;
    memset(f, 0, 9 * sizeof *f);
    for (int32_t block = matrix->row_start[v]; block < matrix->row_start[v + 1]; block++) {
        double now[3], then[3];
        int32_t other = matrix->column[block];
        if (other == v || other >= newton->pattern->vertex_count)
            continue;
        pel_vec3_subtract(unknowns + 3 * (size_t)other, unknowns + 3 * (size_t)v, now);
        pel_vec3_subtract(before + 3 * (size_t)other, before + 3 * (size_t)v, then);
        double square = pel_vec3_squared_length(then), weight = square > 0 ? 1 / square : 0;
        for (int i = 0; i < 9; i++)
            f[i] += weight * now[i / 3] * then[i % 3];
    }
}

static void find_rotation(const pel_newton *newton, const double *unknowns, int32_t v, double r[9])
{
    double f[9], u[9], s[3], w[9];
    set_identity(r);
    if (is_tied(newton, v))
        return;
    find_spread(newton, unknowns, v, f);
    pel_signed_svd(f, u, s, w);
    if (!(s[1] > LEAST_SPREAD * s[0]))
        return;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r[3 * i + j] = u[3 * i] * w[3 * j] + u[3 * i + 1] * w[3 * j + 1] + u[3 * i + 2] * w[3 * j + 2];
}

static void carry_chunk(void *context, int32_t chunk)
{
    const carry_job *job = context;
    int32_t end = (chunk + 1) * CHUNK, count = job->newton->pattern->vertex_count;
    for (int32_t v = chunk * CHUNK; v < (end < count ? end : count); v++)
        find_rotation(job->newton, job->unknowns, v, job->newton->rotations[v]);
}

void pel_newton_carry(newton_run *run)
{
    pel_newton *newton = run->newton;
    carry_job job = {newton, run->unknowns};
    pel_pool_run(newton->pool, (newton->pattern->vertex_count + CHUNK - 1) / CHUNK, carry_chunk, &job);
    newton->is_carried = true;
}

void pel_newton_carry_back(const pel_newton *newton, double *vector)
{
    for (int32_t v = 0; newton->is_carried && v < newton->pattern->vertex_count; v++) {
        const double *r = newton->rotations[v];
        double *x = vector + 3 * (size_t)v, a = x[0], b = x[1], c = x[2];
        for (int k = 0; k < 3; k++)
            x[k] = r[k] * a + r[3 + k] * b + r[6 + k] * c;
    }
}

void pel_newton_carry_on(const pel_newton *newton, double *vector)
{
    for (int32_t v = 0; newton->is_carried && v < newton->pattern->vertex_count; v++) {
        const double *r = newton->rotations[v];
        double *x = vector + 3 * (size_t)v, a = x[0], b = x[1], c = x[2];
        for (int k = 0; k < 3; k++)
            x[k] = r[3 * k] * a + r[3 * k + 1] * b + r[3 * k + 2] * c;
    }
}
