#include "model/rigid_body.h"

#include "base/memory.h"
#include "base/status.h"

#include "math/vec3.h"

#include <math.h>

/* of the radius of a ball: how far its vertices may lie under the sphere; of the volume of the sphere: what its mesh
   fills at least (an icosahedron fills .61, a cube .37) */
#define SPHERE_TOLERANCE 1e-3
#define LEAST_FILLING 0.5
#define PI 3.14159265358979323846

static pel_status refuse(pel_error *error, int32_t body, const char *name, double value, const char *remedy)
{
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, remedy, "%s is %g", name, value);
}

static const char *find_company(const pel_body_def *def)
{
    const struct {
        bool is_on;
        const char *name;
    } parts[] = {{def->shell.membrane.on, "a membrane"},
                 {def->shell.bending.model != PEL_BENDING_NONE, "bending"},
                 {def->shell.anisotropy_count > 0, "fibres"},
                 {def->shell.pressure.kind != PEL_PRESSURE_NONE, "pressure"},
                 {def->volume.on, "a volume"},
                 {def->refine.levels > 0, "refinement"},
                 {def->origins != NULL, "cuts"},
                 {def->adhesion > 0 || def->released_count > 0, "an adhesion"},
                 {def->fluid_density > 0, "a liquid"}};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (parts[i].is_on)
            return parts[i].name;
    return NULL;
}

pel_status pel_rigid_body_check(const pel_body_def *def, int32_t body, pel_error *error)
{
    const pel_rigid_def *rigid = &def->rigid;
    if (!rigid->on)
        return PEL_OK;
    const char *part = find_company(def);
    if (part != NULL)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, "leave it out, or the rigid part",
                                  "a rigid body has %s", part);
    if (!(rigid->mass >= 0 && isfinite(rigid->mass)))
        return refuse(error, body, "rigid mass", rigid->mass, "give a number of kg, or 0 for a density");
    if (!(rigid->mass > 0) && !(rigid->density > 0 && isfinite(rigid->density)))
        return refuse(error, body, "rigid density", rigid->density, "give a number of kg/m3 above 0");
    if (!(rigid->thickness >= 0 && isfinite(rigid->thickness)))
        return refuse(error, body, "rigid thickness", rigid->thickness,
                      "give a number of metres, or 0 for a filled body");
    return PEL_OK;
}

void pel_rigid_body_stiffen(pel_body_def *def)
{
    if (!def->rigid.on)
        return;
    def->mass_kind = PEL_MASS_TOTAL;
    def->mass = 1;
    def->spring_stiffness = def->spring_damping = (pel_quantity){0};
    def->volumetric_stiffness = def->volumetric_damping = (pel_quantity){0};
    def->spring_thickness = def->spring_retardation = def->volumetric_depth = 0;
    def->volumetric_by_area = false;
}

static pel_status find_inertia(const pel_body_def *def, bool has_volume, pel_inertia *inertia, pel_error *error)
{
    const pel_rigid_def *rigid = &def->rigid;
    bool is_sheet = rigid->thickness > 0;
    if (!is_sheet && !has_volume)
        return pel_refuse(error, PEL_BAD_ARGUMENT,
                          "give rigid.thickness, of the sheet that it is, or a mesh without borders",
                          "a rigid body has a mesh with borders, or a flat one, which encloses no volume");
    double density = rigid->mass > 0 ? 1 : rigid->density;
    if (is_sheet)
        pel_inertia_of_sheet(def->mesh, density * rigid->thickness, inertia);
    else
        pel_inertia_of_solid(def->mesh, density, inertia);
    double scale = rigid->mass > 0 ? rigid->mass / inertia->mass : 1;
    inertia->mass *= scale;
    for (int a = 0; a < 3; a++)
        pel_vec3_scale(inertia->tensor[a], scale, inertia->tensor[a]);
    double inverse[3][3];
    if (inertia->mass > 0 && isfinite(inertia->mass) &&
        pel_inertia_invert((const double(*)[3])inertia->tensor, inverse))
        return PEL_OK;
    return pel_refuse(error, PEL_BAD_ARGUMENT, "give a mesh with extent across its longest axis, and a mass above 0",
                      "a rigid body of %g kg has no inertia about one of its axes", inertia->mass);
}

/* The middle of the sphere through the vertices, as least squares of |x - m|^2 - r^2, and its radius to the farthest
   one; returns the distance of the nearest one [m]. */
static double fit_sphere(const pel_mesh *mesh, double middle[3], double *radius)
{
    double mean[3] = {0}, size = 0, spread[3][3] = {{0}}, inverse[3][3], sum[3] = {0}, x[3], nearest = HUGE_VAL;
    int32_t count = mesh->vertex_count;
    for (int32_t v = 0; v < count; v++)
        pel_vec3_along(mean, 1.0 / count, mesh->positions[v], mean);
    for (int32_t v = 0; v < count; v++) {
        pel_vec3_subtract(mesh->positions[v], mean, x);
        size += pel_vec3_squared_length(x) / count;
    }
    for (int32_t v = 0; v < count; v++) {
        pel_vec3_subtract(mesh->positions[v], mean, x);
        pel_vec3_along(sum, 0.5 * (pel_vec3_squared_length(x) - size), x, sum);
        for (int i = 0; i < 3; i++)
            pel_vec3_along(spread[i], x[i], x, spread[i]);
    }
    pel_inertia_invert((const double(*)[3])spread, inverse);
    for (int i = 0; i < 3; i++)
        middle[i] = mean[i] + pel_vec3_dot(inverse[i], sum);
    *radius = 0;
    for (int32_t v = 0; v < count; v++) {
        double distance = pel_vec3_distance(mesh->positions[v], middle);
        *radius = distance > *radius ? distance : *radius;
        nearest = distance < nearest ? distance : nearest;
    }
    return nearest;
}

/* mass and inertia of the sphere in place of those of the mesh */
static pel_status find_ball(const pel_body_def *def, double volume, pel_rigid_shape *ball, pel_inertia *inertia,
                            pel_error *error)
{
    const pel_rigid_def *rigid = &def->rigid;
    double nearest = fit_sphere(def->mesh, ball->middle, &ball->radius), r = ball->radius;
    if (!(nearest >= (1 - SPHERE_TOLERANCE) * r))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "leave rigid.sphere out: then the body collides by its triangles",
                          "a sphere of %g m about the mesh of a rigid sphere has vertices up to %g m inside", r,
                          r - nearest);
    double whole = 4 * PI / 3 * r * r * r;
    if (!(fabs(volume) > LEAST_FILLING * whole))
        return pel_refuse(
            error, PEL_BAD_ARGUMENT,
            "give a closed mesh with more triangles, or leave rigid.sphere out: then the body collides by "
            "its triangles",
            "the mesh of a rigid sphere fills %.2g of the sphere", fabs(volume) / whole);
    bool is_hollow = rigid->thickness > 0;
    double amount = is_hollow ? 4 * PI * r * r * rigid->thickness : whole;
    *inertia = (pel_inertia){.mass = rigid->mass > 0 ? rigid->mass : rigid->density * amount};
    pel_vec3_copy(ball->middle, inertia->center);
    for (int k = 0; k < 3; k++)
        inertia->tensor[k][k] = (is_hollow ? 2.0 / 3 : 0.4) * inertia->mass * r * r;
    return PEL_OK;
}

pel_status pel_rigid_body_create(const pel_body_def *def, double volume, double *areas, pel_rigid_shape **shape,
                                 pel_error *error)
{
    pel_inertia inertia;
    pel_rigid_shape ball = {0};
    pel_status status = find_inertia(def, volume != 0, &inertia, error);
    if (status == PEL_OK && def->rigid.sphere)
        status = find_ball(def, volume, &ball, &inertia, error);
    if (status != PEL_OK)
        return status;
    if (!pel_inertia_lump(def->mesh, &inertia, areas, areas))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "turn its parts outward (`pellicle check --fix`)",
                          "the center of mass of a rigid body lies outside of its mesh");
    *shape = pel_allocate(1, sizeof **shape);
    if (*shape == NULL)
        return pel_fail_memory(error);
    pel_rigid_shape_set(*shape, &inertia, def->mesh, def->pinned, def->pinned_count);
    (*shape)->radius = ball.radius;
    pel_vec3_copy(ball.middle, (*shape)->middle);
    return PEL_OK;
}
