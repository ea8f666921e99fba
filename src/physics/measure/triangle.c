#define PEL_LANE_DOUBLE
#include "measure/element.h"

#include "law/fibre.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "measure/volume.h"

#include <math.h>
#include <string.h>

/* the frame of a rest triangle: axes in space, and X1 - X2 in it; false without area */
typedef struct rest_frame {
    double axis[2][3];
    double length;   /* |X0 - X2| */
    double other[2]; /* X1 - X2 */
} rest_frame;

static bool find_frame(const double rest[3][3], rest_frame *frame)
{
    double normal[3], other[3];
    pel_vec3_subtract(rest[0], rest[2], frame->axis[0]);
    pel_vec3_subtract(rest[1], rest[2], other);
    pel_vec3_cross(frame->axis[0], other, normal);
    double double_area = pel_vec3_normalize(normal);
    frame->length = pel_vec3_normalize(frame->axis[0]);
    if (!(double_area > 0) || !(frame->length > 0))
        return false;
    pel_vec3_cross(normal, frame->axis[0], frame->axis[1]);
    frame->other[0] = pel_vec3_dot(other, frame->axis[0]);
    frame->other[1] = double_area / frame->length;
    return true;
}

bool pel_rest_triangle_setup(const double rest[3][3], pel_rest_triangle *triangle)
{
    memset(triangle, 0, sizeof *triangle);
    rest_frame frame;
    if (!find_frame(rest, &frame))
        return false;
    triangle->inverse[0] = 1 / frame.length;
    triangle->inverse[1] = -frame.other[0] / (frame.length * frame.other[1]);
    triangle->inverse[2] = 1 / frame.other[1];
    triangle->area = 0.5 * frame.length * frame.other[1];
    return true;
}

bool pel_rest_triangle_direction(const double rest[3][3], const double vector[3], double direction[2])
{
    rest_frame frame;
    direction[0] = 1;
    direction[1] = 0;
    if (!find_frame(rest, &frame))
        return false;
    double u = pel_vec3_dot(vector, frame.axis[0]), v = pel_vec3_dot(vector, frame.axis[1]), length = pel_hypot(u, v);
    if (!(length > 1e-12 * pel_vec3_length(vector)))
        return false;
    direction[0] = u / length;
    direction[1] = v / length;
    return true;
}

void pel_triangle_gradient(const double x[3][3], const double values[3], double gradient[3])
{
    double first[3], second[3], normal[3], part[3];
    pel_vec3_subtract(x[0], x[2], first);
    pel_vec3_subtract(x[1], x[2], second);
    pel_vec3_cross(first, second, normal);
    const double square = pel_vec3_squared_length(normal), scale = square > 0 ? 1 / square : 0;
    pel_vec3_cross(second, normal, gradient);
    pel_vec3_scale(gradient, scale * (values[0] - values[2]), gradient);
    pel_vec3_cross(normal, first, part);
    pel_vec3_along(gradient, scale * (values[1] - values[2]), part, gradient);
}

void pel_deformation_gradient(const pel_rest_triangle *triangle, const double x[3][3], double deformation_gradient[6])
{
    const double *inverse = triangle->inverse;
    for (int i = 0; i < 3; i++) {
        double first = x[0][i] - x[2][i], second = x[1][i] - x[2][i];
        deformation_gradient[2 * i] = first * inverse[0];
        deformation_gradient[2 * i + 1] = first * inverse[1] + second * inverse[2];
    }
}

void pel_stress_gradient(const pel_rest_triangle *triangle, const double first_piola[6], double gradient[3][3])
{
    const double *inverse = triangle->inverse;
    for (int i = 0; i < 3; i++) {
        double p1 = triangle->area * first_piola[2 * i], p2 = triangle->area * first_piola[2 * i + 1];
        gradient[0][i] = p1 * inverse[0] + p2 * inverse[1];
        gradient[1][i] = p2 * inverse[2];
        gradient[2][i] = -(gradient[0][i] + gradient[1][i]);
    }
}

double pel_membrane_law_energy(const pel_rest_triangle *triangle, const pel_membrane_law *law, const double x[3][3],
                               double gradient[3][3])
{
    double f[6], p[6];
    pel_deformation_gradient(triangle, x, f);
    double psi = pel_membrane_law_density(law, f, gradient != NULL ? p : NULL);
    if (gradient != NULL)
        pel_stress_gradient(triangle, p, gradient);
    return triangle->area * psi;
}

void pel_principal_direction(const pel_rest_triangle *triangle, const double x[3][3], double direction[2])
{
    double f[6], c11 = 0, c12 = 0, c22 = 0;
    pel_deformation_gradient(triangle, x, f);
    for (int i = 0; i < 3; i++) {
        c11 += f[2 * i] * f[2 * i];
        c12 += f[2 * i] * f[2 * i + 1];
        c22 += f[2 * i + 1] * f[2 * i + 1];
    }
    double difference = 0.5 * (c11 - c22), size = pel_hypot(difference, c12);
    double angle = size > 1e-9 * (c11 + c22) ? 0.5 * pel_atan2(c12, difference) : 0;
    direction[0] = pel_cos(angle);
    direction[1] = pel_sin(angle);
}

double pel_membrane_energy(const pel_rest_triangle *triangle, const pel_membrane_material *material,
                           const double x[3][3], double gradient[3][3])
{
    pel_membrane_law law = pel_membrane_law_of(material);
    return pel_membrane_law_energy(triangle, &law, x, gradient);
}

double pel_fibre_energy(const pel_rest_triangle *triangle, pel_fibre_kind kind, double stiffness,
                        const double direction[2], const double x[3][3], double gradient[3][3])
{
    double f[6], p[6];
    pel_deformation_gradient(triangle, x, f);
    double psi = pel_fibre_density(kind, stiffness, direction, f, p);
    if (gradient != NULL)
        pel_stress_gradient(triangle, p, gradient);
    return triangle->area * psi;
}

double pel_fibre_active_energy(const pel_rest_triangle *triangle, double stiffness, double rest_length,
                               const double direction[2], const double x[3][3], double gradient[3][3])
{
    double f[6], p[6];
    pel_deformation_gradient(triangle, x, f);
    double psi = pel_fibre_active_density(stiffness, rest_length, direction, f, p);
    if (gradient != NULL)
        pel_stress_gradient(triangle, p, gradient);
    return triangle->area * psi;
}

double pel_muscle_energy(const pel_rest_triangle *triangle, double tension, double optimum, double width,
                         const double direction[2], const double x[3][3], double gradient[3][3])
{
    double f[6], image[3], p[6];
    pel_deformation_gradient(triangle, x, f);
    for (int i = 0; i < 3; i++)
        image[i] = f[2 * i] * direction[0] + f[2 * i + 1] * direction[1];
    const double length = pel_vec3_length(image);
    const pel_muscle_response r = pel_law_muscle(length, optimum, width);
    /* P = tension force (F a) a^T / |F a| */
    for (int i = 0; i < 6; i++)
        p[i] = length > 0 ? tension * r.force / length * image[i / 2] * direction[i % 2] : 0;
    if (gradient != NULL)
        pel_stress_gradient(triangle, p, gradient);
    return triangle->area * tension * r.energy;
}

static pel_lane3 point_of(const double x[3])
{
    return (pel_lane3){x[0], x[1], x[2]};
}

double pel_triangle_volume(const double x[3][3], double gradient[3][3])
{
    for (int i = 0; gradient != NULL && i < 3; i++) {
        pel_vec3_cross(x[(i + 1) % 3], x[(i + 2) % 3], gradient[i]);
        pel_vec3_scale(gradient[i], 1.0 / 6, gradient[i]);
    }
    return pel_volume_of(point_of(x[0]), point_of(x[1]), point_of(x[2])) / 6;
}

void pel_triangle_pressure_force(const double x[3][3], double pressure, double force[3])
{
    pel_lane3 vector = pel_area_vector(point_of(x[0]), point_of(x[1]), point_of(x[2]));
    pel_vec3_set(force, pressure / 6 * vector.x, pressure / 6 * vector.y, pressure / 6 * vector.z);
}
