#include "foreign/place.h"

#include <math.h>

static double determinant(const double (*m)[3])
{
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

pel_place pel_place_identity(void)
{
    return (pel_place){.linear = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

pel_place pel_place_product(const pel_place *outer, const pel_place *inner)
{
    pel_place product;
    for (int i = 0; i < 3; i++) {
        product.shift[i] = outer->shift[i];
        for (int k = 0; k < 3; k++) {
            product.shift[i] += outer->linear[i][k] * inner->shift[k];
            product.linear[i][k] = 0;
            for (int j = 0; j < 3; j++)
                product.linear[i][k] += outer->linear[i][j] * inner->linear[j][k];
        }
    }
    return product;
}

void pel_place_point(const pel_place *place, const double point[3], double placed[3])
{
    for (int i = 0; i < 3; i++) {
        placed[i] = place->shift[i];
        for (int k = 0; k < 3; k++)
            placed[i] += place->linear[i][k] * point[k];
    }
}

bool pel_place_mirrors(const pel_place *place)
{
    return determinant(place->linear) < 0;
}

bool pel_place_by_parts(const double t[3], const double q[4], const double s[3], pel_place *place)
{
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 0))
        return false;
    const double x = q[0] / length, y = q[1] / length, z = q[2] / length, w = q[3] / length;
    const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                            {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                            {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            place->linear[i][k] = r[i][k] * s[k];
        place->shift[i] = t[i];
    }
    return true;
}

bool pel_place_inverse(const pel_place *place, pel_place *inverse)
{
    const double(*m)[3] = place->linear;
    const double d = determinant(m);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            const int a = (k + 1) % 3, b = (k + 2) % 3, c = (i + 1) % 3, e = (i + 2) % 3;
            inverse->linear[i][k] = (m[a][c] * m[b][e] - m[a][e] * m[b][c]) / d;
        }
    for (int i = 0; i < 3; i++) {
        inverse->shift[i] = 0;
        for (int k = 0; k < 3; k++)
            inverse->shift[i] -= inverse->linear[i][k] * place->shift[k];
    }
    return d != 0 && isfinite(1 / d);
}
