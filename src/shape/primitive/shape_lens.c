#include "primitive/shape_build.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "primitive/lens.h"

#include <math.h>

/* length along the outline for the angle from the pole of a sphere: the front half to the front, evenly on each side */
static double length_of_angle(const pel_lens_outline *outline, double angle)
{
    const double quarter = 1.57079632679489661923;
    double share = angle / quarter;
    if (share <= 1)
        return share * outline->length_to_equator;
    return outline->length - (2 - share) * (outline->length - outline->length_to_equator);
}

/* moves the vertices of a unit sphere to the lens and gives the capsule's thickness there */
static void move_to_lens(const pel_lens_outline *outline, pel_mesh *mesh, double *thickness)
{
    const double metre = 1e-3;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double *p = mesh->positions[v];
        double from_axis = sqrt(p[0] * p[0] + p[1] * p[1]), r, z;
        double along = length_of_angle(outline, pel_atan2(from_axis, p[2]));
        along = pel_min(pel_max(along, 0), outline->length);
        pel_lens_outline_point(outline, along, &r, &z);
        double scale = from_axis > 0 ? metre * r / from_axis : 0;
        pel_vec3_set(p, scale * p[0], scale * p[1], metre * z);
        thickness[v] = pel_lens_thickness(outline, along);
    }
}

pel_status pel_shape_lens_capsule(const pel_shape_def *def, pel_mesh **mesh, pel_error *error)
{
    pel_lens_outline outline;
    if (!pel_lens_outline_of_age(def->age, &outline))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "use age 11, 29 or 45",
                          "lens-capsule: there is no outline for age %d", (int)def->age);
    pel_mesh *made;
    pel_status status = pel_shape_geodesic_sphere(def->frequency, 1, true, &made, error);
    if (status != PEL_OK)
        return status;
    double *thickness = pel_allocate((size_t)made->vertex_count, sizeof *thickness);
    if (thickness == NULL) {
        status = pel_fail_memory(error);
    } else {
        move_to_lens(&outline, made, thickness);
        status = pel_mesh_add_field(made, "thickness", 1, thickness, error);
    }
    pel_free(thickness);
    if (status != PEL_OK) {
        pel_mesh_destroy(made);
        return status;
    }
    *mesh = made;
    return PEL_OK;
}
