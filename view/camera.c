/* Fitting in closed form. In the axes of the camera a point is (a, b, f), f towards the camera, which stands at f = D
   in front of (p, q). The point is inside the picture's borders across, of tangent s, when |a - p| <= s (D - f), that
   is

       a + s f <= p + s D    and    a - s f >= p - s D

   for all points. With A the largest a + s f and B the least a - s f, p = (A + B) / 2 and D = (A - B) / (2 s) fit
   exactly. Likewise for up; the larger D is used. A ball of radius r adds r sqrt(1 + s^2) to A and to -B. */
#include "view/camera.h"

#include <math.h>
#include <string.h>

static const struct {
    const char *name;
    double azimuth, elevation;
} presets[] = {{"iso", 35, 35},  {"front", 0, 0}, {"back", 180, 0},  {"left", 270, 0},
               {"right", 90, 0}, {"top", 0, 90},  {"bottom", 0, -90}};
enum { PRESET_COUNT = sizeof presets / sizeof presets[0] };

/* tangent of half the angle of view on the shorter side, and the share of the picture that is filled */
static const double half_view = 0.22, filled = 0.94;

const char *pel_camera_preset_name(int index)
{
    return index >= 0 && index < PRESET_COUNT ? presets[index].name : NULL;
}

bool pel_camera_preset_find(const char *name, pel_camera_angle *angle)
{
    if (name == NULL || angle == NULL)
        return false;
    for (int i = 0; i < PRESET_COUNT; ++i) {
        if (strcmp(presets[i].name, name) == 0) {
            *angle = (pel_camera_angle){presets[i].azimuth, presets[i].elevation, 1};
            return true;
        }
    }
    return false;
}

/* z-up coordinates to coordinates of the world */
static void set_axis(double axis[3], int32_t up, double x, double y, double z)
{
    const double values[3][3] = {{z, x, y}, {x, z, -y}, {x, y, z}};
    memcpy(axis, values[up], sizeof values[up]);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void view_camera_begin(view_camera *camera, const pel_camera_angle *angle, int32_t up, int32_t width, int32_t height)
{
    static const double radians = 0.017453292519943295;
    double sa = sin(angle->azimuth * radians), ca = cos(angle->azimuth * radians);
    double se = sin(angle->elevation * radians), ce = cos(angle->elevation * radians);
    *camera = (view_camera){.up = up, .depths = {HUGE_VAL, -HUGE_VAL}, .all_depths = {HUGE_VAL, -HUGE_VAL}};
    set_axis(camera->axes[0], up, ca, sa, 0);
    set_axis(camera->axes[1], up, -se * sa, se * ca, ce);
    set_axis(camera->axes[2], up, ce * sa, -ce * ca, se);
    double shorter = width < height ? width : height;
    camera->tangents[0] = half_view * width / shorter;
    camera->tangents[1] = half_view * height / shorter;
    for (int i = 0; i < 2; ++i) {
        camera->fit_bounds[2 * i] = -HUGE_VAL;
        camera->fit_bounds[2 * i + 1] = HUGE_VAL;
    }
}

void view_camera_reach(view_camera *camera, const double point[3], double radius)
{
    double depth = dot(camera->axes[2], point);
    camera->all_depths[0] = fmin(camera->all_depths[0], depth - radius);
    camera->all_depths[1] = fmax(camera->all_depths[1], depth + radius);
}

void view_camera_see(view_camera *camera, const double point[3], double radius)
{
    double depth = dot(camera->axes[2], point);
    camera->depths[0] = fmin(camera->depths[0], depth - radius);
    camera->depths[1] = fmax(camera->depths[1], depth + radius);
    for (int i = 0; i < 2; ++i) {
        double tangent = filled * camera->tangents[i], across = dot(camera->axes[i], point);
        double *bounds = &camera->fit_bounds[2 * i], wider = radius > 0 ? radius * sqrt(1 + tangent * tangent) : 0;
        bounds[0] = fmax(bounds[0], across + tangent * depth + wider);
        bounds[1] = fmin(bounds[1], across - tangent * depth - wider);
    }
    view_camera_reach(camera, point, radius);
}

void view_camera_fit(view_camera *camera, double zoom)
{
    /* never inside the visible scene, even if it is flat or a single point */
    double thickness = camera->depths[1] - camera->depths[0];
    double least = thickness > 0 ? 0.05 * thickness : 1e-6 * (1 + fabs(camera->depths[1]));
    double stand = camera->depths[1] + least;
    for (int i = 0; i < 2; ++i) {
        const double *bounds = &camera->fit_bounds[2 * i];
        camera->center[i] = 0.5 * (bounds[0] + bounds[1]);
        stand = fmax(stand, 0.5 * (bounds[0] - bounds[1]) / (filled * camera->tangents[i]));
    }
    camera->center[2] = 0.5 * (camera->depths[0] + camera->depths[1]);
    camera->distance = stand - camera->center[2];
    camera->near = fmax(0.98 * (stand - camera->all_depths[1]), 0.02 * camera->distance);
    camera->far = fmax(1.02 * (stand - camera->all_depths[0]), 2 * camera->near);
    for (int i = 0; i < 2; ++i)
        camera->tangents[i] /= zoom;
}

void view_camera_turn(const view_camera *camera, const double point[3], double turned[3])
{
    for (int i = 0; i < 3; ++i)
        turned[i] = dot(camera->axes[i], point) - camera->center[i];
}

void view_camera_project(const view_camera *camera, float matrix[16])
{
    double near = camera->near, far = camera->far, depth = far - near;
    memset(matrix, 0, 16 * sizeof *matrix);
    matrix[0] = (float)(1 / camera->tangents[0]);
    matrix[5] = (float)(1 / camera->tangents[1]);
    /* clip z = ((far + near) (distance - f) - 2 far near) / depth, clip w = distance - f */
    matrix[10] = (float)(-(far + near) / depth);
    matrix[11] = -1;
    matrix[14] = (float)(((far + near) * camera->distance - 2 * far * near) / depth);
    matrix[15] = (float)camera->distance;
}
