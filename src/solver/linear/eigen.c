#include "linear/eigen.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"

#include <math.h>
#include <string.h>

/* vectors that the basis grows by at a time: the six motions of a free body are found at once */
enum { BLOCK = 6, SPARE = 18, SWEEPS = 60 };
/* what is left of a vector beside the basis, of its length, that is rounding */
#define DEPENDENT 1e-12

struct pel_eigen {
    int32_t unknown_count, wanted, room; /* room: most vectors of the basis */
    int32_t count;                       /* vectors of the basis */
    double *basis, *image;               /* (room x unknown_count) V and A V */
    double *measured, *scratch;          /* (unknown_count), (room) */
    double *ritz, *products, *matrix;    /* (room x room): rows of vectors; V . N A V, and a copy */
    double *values;                      /* (room) */
};

pel_status pel_eigen_create(int32_t unknown_count, int32_t wanted, pel_eigen **eigen, pel_error *error)
{
    *eigen = NULL;
    pel_eigen *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->unknown_count = unknown_count;
    made->wanted = wanted;
    made->room = 2 * wanted + SPARE;
    size_t room = (size_t)made->room, count = (size_t)unknown_count;
    double **arrays[] = {&made->basis, &made->image,    &made->measured, &made->scratch,
                         &made->ritz,  &made->products, &made->matrix,   &made->values};
    const size_t sizes[] = {room * count, room * count, count, room, room * room, room * room, room * room, room};
    bool fits = true;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        fits &= (*arrays[i] = pel_allocate(sizes[i], sizeof(double))) != NULL;
    if (!fits) {
        pel_eigen_destroy(made);
        return pel_refuse(error, PEL_OUT_OF_MEMORY, "ask for fewer modes or use a coarser mesh",
                          "%d modes need %.3g GB, and this memory is not available", (int)wanted,
                          2e-9 * (double)(room * count * sizeof(double)));
    }
    *eigen = made;
    return PEL_OK;
}

void pel_eigen_destroy(pel_eigen *eigen)
{
    if (eigen == NULL)
        return;
    double *arrays[] = {eigen->basis, eigen->image,    eigen->measured, eigen->scratch,
                        eigen->ritz,  eigen->products, eigen->matrix,   eigen->values};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        pel_free(arrays[i]);
    pel_free(eigen);
}

double pel_eigen_value(const pel_eigen *eigen, int32_t number)
{
    return eigen->values[number];
}

const double *pel_eigen_vector(const pel_eigen *eigen, int32_t number)
{
    return eigen->basis + (size_t)number * (size_t)eigen->unknown_count;
}

/* ---- dense ---- */

/* turns rows and columns p and q so that their entry is 0 */
static void rotate(int32_t n, double *a, double *vectors, int32_t p, int32_t q)
{
    double theta = (a[q * n + q] - a[p * n + p]) / (2 * a[p * n + q]);
    double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
    double c = 1 / sqrt(t * t + 1), s = t * c;
    for (int32_t k = 0; k < n; k++) {
        double x = a[k * n + p], y = a[k * n + q];
        a[k * n + p] = c * x - s * y;
        a[k * n + q] = s * x + c * y;
    }
    for (int32_t k = 0; k < n; k++) {
        double x = a[p * n + k], y = a[q * n + k];
        a[p * n + k] = c * x - s * y;
        a[q * n + k] = s * x + c * y;
        x = vectors[p * n + k];
        y = vectors[q * n + k];
        vectors[p * n + k] = c * x - s * y;
        vectors[q * n + k] = s * x + c * y;
    }
}

static void sort_pairs(int32_t n, double *values, double *vectors)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t largest = i;
        for (int32_t j = i + 1; j < n; j++)
            largest = values[j] > values[largest] ? j : largest;
        double value = values[i];
        values[i] = values[largest];
        values[largest] = value;
        for (int32_t k = 0; k < n && largest != i; k++) {
            double x = vectors[i * n + k];
            vectors[i * n + k] = vectors[largest * n + k];
            vectors[largest * n + k] = x;
        }
    }
}

void pel_eigen_dense(int32_t n, double *matrix, double *values, double *vectors)
{
    memset(vectors, 0, (size_t)n * (size_t)n * sizeof *vectors);
    for (int32_t i = 0; i < n; i++)
        vectors[i * n + i] = 1;
    bool turned = true;
    for (int sweep = 0; turned && sweep < SWEEPS; sweep++) {
        turned = false;
        for (int32_t p = 0; p < n; p++)
            for (int32_t q = p + 1; q < n; q++) {
                double entry = fabs(matrix[p * n + q]);
                if (entry <= 1e-17 * sqrt(fabs(matrix[p * n + p] * matrix[q * n + q])) || entry < 1e-300)
                    continue;
                rotate(n, matrix, vectors, p, q);
                turned = true;
            }
    }
    for (int32_t i = 0; i < n; i++)
        values[i] = matrix[i * n + i];
    sort_pairs(n, values, vectors);
}

/* ---- the basis ---- */

static double *row(const pel_eigen *eigen, double *rows, int32_t number)
{
    return rows + (size_t)number * (size_t)eigen->unknown_count;
}

static double dot(const pel_eigen *eigen, const double *x, const double *y)
{
    double sum = 0;
    for (int32_t u = 0; u < eigen->unknown_count; u++)
        sum += x[u] * y[u];
    return sum;
}

static void add_scaled(const pel_eigen *eigen, double *x, double factor, const double *y)
{
    for (int32_t u = 0; u < eigen->unknown_count; u++)
        x[u] += factor * y[u];
}

/* length in the metric; leaves N x in `measured` */
static double measure(pel_eigen *eigen, const pel_eigen_def *def, const double *x)
{
    def->metric(def->context, x, eigen->measured);
    return sqrt(pel_max(dot(eigen, x, eigen->measured), 0));
}

/* Takes the vector behind the basis into it, orthogonal and of length 1; false where it depends on the basis. Its
   image and products with the others follow. */
static bool take_vector(pel_eigen *eigen, const pel_eigen_def *def)
{
    int32_t last = eigen->count;
    double *x = row(eigen, eigen->basis, last), before = measure(eigen, def, x);
    if (!(before > 0) || !isfinite(before))
        return false;
    for (int pass = 0; pass < 3; pass++) {
        for (int32_t i = 0; i < last; i++)
            eigen->scratch[i] = dot(eigen, row(eigen, eigen->basis, i), eigen->measured);
        for (int32_t i = 0; i < last; i++)
            add_scaled(eigen, x, -eigen->scratch[i], row(eigen, eigen->basis, i));
        double length = measure(eigen, def, x);
        if (!(length > DEPENDENT * before))
            return false;
        for (int32_t u = 0; u < eigen->unknown_count; u++)
            x[u] /= length;
        for (int32_t u = 0; u < eigen->unknown_count; u++)
            eigen->measured[u] /= length;
    }
    double *image = row(eigen, eigen->image, last);
    def->apply(def->context, x, image);
    def->metric(def->context, image, eigen->measured);
    for (int32_t i = 0; i <= last; i++) {
        double product = dot(eigen, row(eigen, eigen->basis, i), eigen->measured);
        eigen->products[i * eigen->room + last] = eigen->products[last * eigen->room + i] = product;
    }
    eigen->count++;
    return true;
}

/* Takes a block of random vectors that the operator has been applied to into the basis, what of them it does not
   contain: what the operator takes away has no length in the metric. */
static void take_random(pel_eigen *eigen, const pel_eigen_def *def, uint32_t *random, pel_eigen_result *result)
{
    for (int b = 0; b < BLOCK && eigen->count < eigen->room; b++) {
        double *image = row(eigen, eigen->image, eigen->count);
        for (int32_t u = 0; u < eigen->unknown_count; u++) {
            *random = *random * 1664525u + 1013904223u;
            image[u] = (double)(*random >> 8) / (1 << 23) - 1;
        }
        def->apply(def->context, image, row(eigen, eigen->basis, eigen->count));
        result->products += 1 + take_vector(eigen, def);
    }
}

static void find_ritz(pel_eigen *eigen)
{
    for (int32_t i = 0; i < eigen->count; i++)
        for (int32_t j = 0; j < eigen->count; j++)
            eigen->matrix[i * eigen->count + j] = eigen->products[i * eigen->room + j];
    pel_eigen_dense(eigen->count, eigen->matrix, eigen->values, eigen->ritz);
}

/* rows = the first `kept` Ritz combinations of rows */
static void combine(pel_eigen *eigen, double *rows, int32_t kept)
{
    for (int32_t u = 0; u < eigen->unknown_count; u++) {
        for (int32_t k = 0; k < kept; k++) {
            eigen->scratch[k] = 0;
            for (int32_t i = 0; i < eigen->count; i++)
                eigen->scratch[k] += eigen->ritz[k * eigen->count + i] * row(eigen, rows, i)[u];
        }
        for (int32_t k = 0; k < kept; k++)
            row(eigen, rows, k)[u] = eigen->scratch[k];
    }
}

static void restart(pel_eigen *eigen, int32_t kept)
{
    combine(eigen, eigen->basis, kept);
    combine(eigen, eigen->image, kept);
    eigen->count = kept;
    memset(eigen->ritz, 0, (size_t)eigen->room * (size_t)eigen->room * sizeof *eigen->ritz);
    for (int32_t i = 0; i < kept; i++)
        for (int32_t j = 0; j < kept; j++) {
            eigen->products[i * eigen->room + j] = i == j ? eigen->values[i] : 0;
            eigen->ritz[i * kept + j] = i == j;
        }
}

/* A x - value x of a Ritz vector of the first `count` vectors */
static void find_residual(const pel_eigen *eigen, int32_t count, int32_t number, double *residual)
{
    const double *weights = eigen->ritz + (size_t)number * (size_t)count;
    memset(residual, 0, (size_t)eigen->unknown_count * sizeof *residual);
    for (int32_t i = 0; i < count; i++) {
        add_scaled(eigen, residual, weights[i], row(eigen, eigen->image, i));
        add_scaled(eigen, residual, -weights[i] * eigen->values[number], row(eigen, eigen->basis, i));
    }
}

pel_eigen_result pel_eigen_solve(pel_eigen *eigen, const pel_eigen_def *def)
{
    pel_eigen_result result = {0};
    uint32_t random = 1;
    eigen->count = 0;
    take_random(eigen, def, &random, &result);
    while (eigen->count > 0 && !pel_pool_is_stopped(def->pool)) {
        find_ritz(eigen);
        if (eigen->count + BLOCK > eigen->room)
            restart(eigen, eigen->wanted + BLOCK);
        int32_t before = eigen->count, ritz = eigen->count < eigen->wanted ? eigen->count : eigen->wanted;
        result.count = 0;
        for (int32_t k = 0; k < ritz && eigen->count - before < BLOCK && !pel_pool_is_stopped(def->pool); k++) {
            double *residual = row(eigen, eigen->basis, eigen->count);
            find_residual(eigen, before, k, residual);
            if (measure(eigen, def, residual) <= def->tolerance * fabs(eigen->values[k]))
                result.count += result.count == k;
            else
                result.products += take_vector(eigen, def);
        }
        /* values far above all others, of rigid motions, converge before any vector of the others is there */
        if (eigen->count == before && ritz < eigen->wanted)
            take_random(eigen, def, &random, &result);
        /* nothing new: all have converged, or the basis is all that there is */
        if (eigen->count == before || ++result.iterations >= def->iterations) {
            eigen->count = before;
            restart(eigen, ritz);
            break;
        }
    }
    return result;
}
