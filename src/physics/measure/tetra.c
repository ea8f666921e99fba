#include "measure/tetra.h"

#include "base/status.h"
#include "math/extremes.h"
#include "math/vec3.h"

#include <math.h>
#include <string.h>

/* of the sum of two stretches that the rotation's part divides by */
#define LEAST_SUM 1e-6
enum { SVD_SWEEPS = 12 };

/* ---- deformation ---- */

bool pel_rest_tetra_setup(const double x[4][3], pel_rest_tetra *rest)
{
    double edge[3][3];
    for (int k = 0; k < 3; k++)
        pel_vec3_subtract(x[k], x[3], edge[k]);
    double normal[3][3];
    for (int k = 0; k < 3; k++)
        pel_vec3_cross(edge[(k + 1) % 3], edge[(k + 2) % 3], normal[k]);
    /* the fourth corner is on the side from which the first three are clockwise: this determinant is negative */
    const double determinant = pel_vec3_dot(edge[0], normal[0]);
    rest->volume = -determinant / 6;
    pel_vec3_set(rest->gradients[3], 0, 0, 0);
    for (int k = 0; k < 3; k++) {
        pel_vec3_scale(normal[k], 1 / determinant, rest->gradients[k]);
        pel_vec3_subtract(rest->gradients[3], rest->gradients[k], rest->gradients[3]);
    }
    return rest->volume > 0 && isfinite(1 / rest->volume);
}

void pel_patch_deformation(int count, const double (*gradients)[3], const double *x, double f[9])
{
    const double *last = x + 3 * (count - 1);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double sum = 0;
            for (int k = 0; k < count - 1; k++)
                sum += (x[3 * k + i] - last[i]) * gradients[k][j];
            f[3 * i + j] = sum;
        }
}

void pel_tetra_deformation(const pel_rest_tetra *rest, const double x[4][3], double f[9])
{
    pel_patch_deformation(4, rest->gradients, x[0], f);
}

static double determinant_of(const double f[9])
{
    return f[0] * (f[4] * f[8] - f[5] * f[7]) + f[1] * (f[5] * f[6] - f[3] * f[8]) + f[2] * (f[3] * f[7] - f[4] * f[6]);
}

static void cofactor_of(const double f[9], double cofactor[9])
{
    for (int i = 0; i < 3; i++)
        pel_vec3_cross(f + 3 * ((i + 1) % 3), f + 3 * ((i + 2) % 3), cofactor + 3 * i);
}

static void multiply(const double a[9], const double b[9], double product[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            product[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

/* ---- singular values: one-sided Jacobi rotations of the columns of F V ---- */

static double column_dot(const double m[9], int a, int b)
{
    return m[a] * m[b] + m[3 + a] * m[3 + b] + m[6 + a] * m[6 + b];
}

static void turn_columns(double m[9], int a, int b, double cosine, double sine)
{
    for (int i = 0; i < 3; i++) {
        const double first = m[3 * i + a], second = m[3 * i + b];
        m[3 * i + a] = cosine * first - sine * second;
        m[3 * i + b] = sine * first + cosine * second;
    }
}

/* makes two columns orthogonal; false if they are already */
static bool turn_pair(double m[9], double v[9], int a, int b)
{
    const double aa = column_dot(m, a, a), bb = column_dot(m, b, b), ab = column_dot(m, a, b);
    if (!(fabs(ab) > 1e-16 * sqrt(aa * bb)))
        return false;
    const double zeta = (bb - aa) / (2 * ab), size = fabs(zeta) + sqrt(1 + zeta * zeta);
    const double tangent = zeta < 0 ? -1 / size : 1 / size, cosine = 1 / sqrt(1 + tangent * tangent);
    turn_columns(m, a, b, cosine, cosine * tangent);
    turn_columns(v, a, b, cosine, cosine * tangent);
    return true;
}

/* exchanges columns as a rotation by a right angle */
static void order_columns(double m[9], double v[9], int a, int b)
{
    if (column_dot(m, a, a) >= column_dot(m, b, b))
        return;
    turn_columns(m, a, b, 0, -1);
    turn_columns(v, a, b, 0, -1);
}

static void get_column(const double m[9], int j, double column[3])
{
    pel_vec3_set(column, m[j], m[3 + j], m[6 + j]);
}

void pel_signed_svd(const double f[9], double u[9], double s[3], double v[9])
{
    double m[9], column[3][3];
    memcpy(m, f, sizeof m);
    memset(v, 0, 9 * sizeof *v);
    v[0] = v[4] = v[8] = 1;
    bool turned = true;
    for (int sweep = 0; turned && sweep < SVD_SWEEPS; sweep++) {
        turned = turn_pair(m, v, 0, 1);
        turned = turn_pair(m, v, 0, 2) || turned;
        turned = turn_pair(m, v, 1, 2) || turned;
    }
    order_columns(m, v, 0, 1);
    order_columns(m, v, 0, 2);
    order_columns(m, v, 1, 2);
    for (int j = 0; j < 3; j++)
        get_column(m, j, column[j]);
    s[0] = pel_vec3_normalize(column[0]);
    if (!(s[0] > 0))
        pel_vec3_set(column[0], 1, 0, 0);
    /* a second column that is lost in rounding has any direction across */
    pel_vec3_along(column[1], -pel_vec3_dot(column[1], column[0]), column[0], column[1]);
    s[1] = pel_vec3_normalize(column[1]);
    if (!(s[1] > 1e-14 * s[0])) {
        const double other[3] = {fabs(column[0][0]) < 0.6, fabs(column[0][0]) >= 0.6, 0};
        pel_vec3_along(other, -pel_vec3_dot(other, column[0]), column[0], column[1]);
        pel_vec3_normalize(column[1]);
    }
    double last[3];
    get_column(m, 2, last);
    pel_vec3_cross(column[0], column[1], column[2]);
    s[2] = pel_vec3_dot(last, column[2]);
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++)
            u[3 * i + j] = column[j][i];
}

void pel_nearest_rotation(const double f[9], double r[9])
{
    double u[9], s[3], v[9];
    pel_signed_svd(f, u, s, v);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r[3 * i + j] = u[3 * i] * v[3 * j] + u[3 * i + 1] * v[3 * j + 1] + u[3 * i + 2] * v[3 * j + 2];
}

/* ---- energy and stress ---- */

/* products of F that all laws have */
typedef struct strain_sums {
    double square, fourth, j;
    double right[9]; /* F^T F */
} strain_sums;

static strain_sums sums_of(const double f[9])
{
    strain_sums sums = {.j = determinant_of(f)};
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            sums.right[3 * a + b] = column_dot(f, a, b);
    for (int i = 0; i < 9; i++) {
        sums.square += f[i] * f[i];
        sums.fourth += sums.right[i] * sums.right[i];
    }
    return sums;
}

static double energy_of(const pel_solid_law *law, double first, const strain_sums *sums)
{
    const double square = sums->square - 3, change = sums->j - 1;
    return law->a1 * (first - 3) + (law->a2 + 0.5 * law->b2 * square) * square + law->a4 * (sums->fourth - 3) +
           (law->c + 0.5 * law->k * change) * change;
}

double pel_solid_density(const pel_solid_law *law, const double f[9], double first_piola[9])
{
    const strain_sums sums = sums_of(f);
    double rotation[9] = {0}, first = 3;
    if (law->a1 != 0) {
        pel_nearest_rotation(f, rotation);
        first = 0;
        for (int i = 0; i < 9; i++)
            first += rotation[i] * f[i];
    }
    if (first_piola != NULL) {
        double cubic[9], cofactor[9];
        multiply(f, sums.right, cubic);
        cofactor_of(f, cofactor);
        const double linear = 2 * (law->a2 + law->b2 * (sums.square - 3)), volume = law->c + law->k * (sums.j - 1);
        for (int i = 0; i < 9; i++)
            first_piola[i] = law->a1 * rotation[i] + linear * f[i] + 4 * law->a4 * cubic[i] + volume * cofactor[i];
    }
    return energy_of(law, first, &sums);
}

pel_status pel_volume_density(pel_volume_kind kind, double young, double poisson, double mooney_ratio,
                              const double deformation_gradient[9], double *density, double first_piola[9],
                              pel_error *error)
{
    PEL_REFUSE_NULL(deformation_gradient, error);
    PEL_REFUSE_NULL(density, error);
    if (PEL_IS_NO_CHOICE((int)kind, PEL_VOLUME_COUNT))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give one of pel_volume_kind", "kind of the law is %d", (int)kind);
    if (!(young > 0 && isfinite(young)) || !(poisson >= 0 && poisson < 0.5) ||
        !(mooney_ratio >= 0 && isfinite(mooney_ratio)))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give young > 0, poisson from 0 to less than 0.5, mooney_ratio >= 0",
                          "material has young %g, poisson %g, mooney_ratio %g", young, poisson, mooney_ratio);
    for (int i = 0; i < 9; i++)
        if (!isfinite(deformation_gradient[i]))
            return pel_refuse(error, PEL_BAD_ARGUMENT, "give finite numbers", "deformation gradient has the number %g",
                              deformation_gradient[i]);
    const pel_solid_law law = pel_solid_law_of(kind, poisson, mooney_ratio);
    *density = young * pel_solid_density(&law, deformation_gradient, first_piola);
    for (int i = 0; first_piola != NULL && i < 9; i++)
        first_piola[i] *= young;
    return PEL_OK;
}

/* ---- second derivative ---- */

/* in the frames of the singular values: by the diagonal, and for the pair without k those of its two parts */
typedef struct stiffness {
    double diagonal[3][3], symmetric[3], antisymmetric[3];
} stiffness;

static stiffness stiffness_of(const pel_solid_law *law, const double s[3])
{
    const double square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2], j = s[0] * s[1] * s[2];
    const double linear = 2 * (law->a2 + law->b2 * (square - 3)), volume = law->c + law->k * (j - 1);
    stiffness d;
    for (int k = 0; k < 3; k++) {
        const double a = s[(k + 1) % 3], b = s[(k + 2) % 3], both = a * a + b * b, sum = a + b;
        const double safe = fabs(sum) > LEAST_SUM ? sum : sum < 0 ? -LEAST_SUM : LEAST_SUM;
        d.symmetric[k] = linear + 4 * law->a4 * (both + a * b) - volume * s[k];
        d.antisymmetric[k] = linear + 4 * law->a4 * (both - a * b) + volume * s[k] + 2 * law->a1 / safe;
        d.diagonal[k][k] = linear + (12 * law->a4 + 4 * law->b2) * s[k] * s[k] + law->k * (a * b) * (a * b);
        const int i = (k + 1) % 3, l = (k + 2) % 3;
        d.diagonal[i][l] = d.diagonal[l][i] = 4 * law->b2 * a * b + volume * s[k] + law->k * (b * s[k]) * (a * s[k]);
    }
    return d;
}

/* eigenvalues of a symmetric matrix below 0 become 0 */
static void clamp_matrix(double m[3][3])
{
    double f[9], u[9], s[3], v[9], shift = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            shift = pel_max(shift, fabs(m[i][j]));
    if (!(shift > 0))
        return;
    /* shifted to be positive definite its singular values are its eigenvalues */
    shift *= 4;
    for (int i = 0; i < 9; i++)
        f[i] = m[i / 3][i % 3] + (i % 4 == 0 ? shift : 0);
    pel_signed_svd(f, u, s, v);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                sum += pel_max(s[k] - shift, 0) * v[3 * i + k] * v[3 * j + k];
            m[i][j] = sum;
        }
}

static void clamp(stiffness *d)
{
    for (int k = 0; k < 3; k++) {
        d->symmetric[k] = pel_max(d->symmetric[k], 0);
        d->antisymmetric[k] = pel_max(d->antisymmetric[k], 0);
    }
    clamp_matrix(d->diagonal);
}

/* the block of two corners in the frames, where their gradients are V^T b */
static void make_block(const stiffness *d, const double first[3], const double second[3], double block[9])
{
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            const int c = 3 - a - b; /* the third one, of a pair */
            double sum = d->diagonal[a][b] * first[a] * second[b];
            if (a != b)
                sum += 0.5 * (d->symmetric[c] - d->antisymmetric[c]) * first[b] * second[a];
            for (int other = 0; a == b && other < 3; other++)
                if (other != a)
                    sum += 0.5 * (d->symmetric[3 - a - other] + d->antisymmetric[3 - a - other]) * first[other] *
                           second[other];
            block[3 * a + b] = sum;
        }
}

/* V^T b */
static void turn_back(const double v[9], const double b[3], double turned[3])
{
    for (int j = 0; j < 3; j++)
        turned[j] = v[j] * b[0] + v[3 + j] * b[1] + v[6 + j] * b[2];
}

static void add_hessian(int count, const double (*gradients)[3], const pel_solid_law *law, double scale,
                        const double f[9], pel_tangent_kind kind, const pel_tangent_sum *sum)
{
    double u[9], s[3], v[9];
    pel_signed_svd(f, u, s, v);
    stiffness d = stiffness_of(law, s);
    if (kind == PEL_TANGENT_POSITIVE)
        clamp(&d);
    for (int k = 0; k < count; k++)
        for (int l = 0; l <= k; l++) {
            double block[9], half[9], first[3], second[3];
            turn_back(v, gradients[k], first);
            turn_back(v, gradients[l], second);
            make_block(&d, first, second, block);
            multiply(u, block, half);
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) {
                    const double value = scale * (half[3 * i] * u[3 * j] + half[3 * i + 1] * u[3 * j + 1] +
                                                  half[3 * i + 2] * u[3 * j + 2]);
                    sum->hessian[(3 * k + i) * sum->stride + 3 * l + j] += value;
                    if (l < k)
                        sum->hessian[(3 * l + j) * sum->stride + 3 * k + i] += value;
                }
        }
}

double pel_patch_tangent(int count, const double (*gradients)[3], const pel_solid_law *law, double scale,
                         const double *x, pel_tangent_kind kind, const pel_tangent_sum *sum)
{
    double f[9], stress[9];
    pel_patch_deformation(count, gradients, x, f);
    const double energy = scale * pel_solid_density(law, f, sum->gradient != NULL ? stress : NULL);
    for (int k = 0; sum->gradient != NULL && k < count; k++)
        for (int i = 0; i < 3; i++)
            sum->gradient[3 * k + i] += scale * pel_vec3_dot(stress + 3 * i, gradients[k]);
    if (sum->hessian != NULL)
        add_hessian(count, gradients, law, scale, f, kind, sum);
    return energy;
}

double pel_tetra_tangent(const pel_rest_tetra *rest, const pel_solid_law *law, double scale, const double *x,
                         pel_tangent_kind kind, const pel_tangent_sum *sum)
{
    return pel_patch_tangent(4, rest->gradients, law, scale, x, kind, sum);
}
