/* Linear tetrahedra bend too stiffly: with edges e, a plate or beam of thickness t by a factor of about 1 + 1.1 (e /
   t)^2 (measured on bars of 4, 2, 1 and 0.4 edges: 1.065, 1.29, 2.1 and 8.5). They lock where the material is nearly
   incompressible: a beam of 4 cells is 5 % too stiff at a Poisson's ratio of 0.3, 7 % at 0.45 and 9 % at 0.49
   (docs/volumes.md). A cube that is pinned below and pulled aside above is 46, 17, 9 and 5 % too stiff with 1, 2, 3 and
   4 edges, at 0.45 43, 20, 11 and 7 %: it bends as well. */
#include "choice/element.h"

#include "choice/method.h"
#include "linear/eigen.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "model/model.h"
#include "model/quantity.h"
#include "pellicle/volume.h"
#include "stage/stepper.h"

#include <math.h>

#define BENDING_ERROR 1.1
/* the same of a cube, from two edges on; wider blocks have less of it */
#define SHEAR_ERROR 0.9
/* length over thickness from which a body bends */
#define SLENDER 3
/* twice volume over area is the thickness of a curved sheet; where it is more than this share of the thickness of the
   box with the same inertia, the body is a bar or a plate of that thickness */
#define SHEET_SHARE 0.33
/* of the stiffness in bending, from which elements are smooth, if a step of implicit takes at most so many ms */
#define BENDS 0.02
#define MOST_STEP 100.0

/* adds the moments of second order of a tetrahedron about the origin */
static void add_moments(const double x[4][3], double volume, double moments[9])
{
    double sum[3] = {0};
    for (int k = 0; k < 4; k++)
        pel_vec3_add(sum, x[k], sum);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double products = sum[i] * sum[j];
            for (int k = 0; k < 4; k++)
                products += x[k][i] * x[k][j];
            moments[3 * i + j] += volume * products / 20;
        }
}

static double longest_edge(const double x[4][3])
{
    double longest = 0;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i; j++)
            longest = pel_max(longest, pel_vec3_distance(x[i], x[j]));
    return longest;
}

static double area_of(const pel_mesh *mesh)
{
    double sum = 0, normal[3];
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        pel_vec3_triangle_normal(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]], normal);
        sum += 0.5 * pel_vec3_length(normal);
    }
    return sum;
}

/* about the first vertex, so that a place far from the origin costs no digits */
pel_solid_shape pel_solid_shape_of(const pel_mesh *mesh)
{
    double total = 0, center[3] = {0}, moments[9] = {0}, values[3], vectors[9], edges = 0;
    for (int32_t t = 0; t < mesh->tetrahedron_count; t++) {
        double x[4][3];
        for (int k = 0; k < 4; k++)
            pel_vec3_subtract(mesh->positions[mesh->tetrahedra[t][k]], mesh->positions[0], x[k]);
        double volume = pel_tetrahedron_volume((const double(*)[3])x);
        total += volume;
        edges += longest_edge((const double(*)[3])x);
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < 3; i++)
                center[i] += 0.25 * volume * x[k][i];
        add_moments((const double(*)[3])x, volume, moments);
    }
    for (int i = 0; i < 9; i++)
        moments[i] = moments[i] / total - center[i / 3] / total * center[i % 3] / total;
    pel_eigen_dense(3, moments, values, vectors);
    /* of a box with this inertia */
    pel_solid_shape shape = {edges / mesh->tetrahedron_count, sqrt(12 * pel_max(values[2], 0)), sqrt(12 * values[0])};
    double sheet = 2 * total / area_of(mesh);
    if (sheet < SHEET_SHARE * shape.thickness)
        shape.thickness = sheet;
    return shape;
}

double pel_solid_bending_error(const pel_solid_shape *shape)
{
    double share = shape->edge / shape->thickness;
    return shape->length > SLENDER * shape->thickness ? BENDING_ERROR * share * share : 0;
}

double pel_solid_shear_error(const pel_solid_shape *shape)
{
    double share = pel_min(shape->edge / shape->thickness, 0.7);
    return shape->length > SLENDER * shape->thickness ? 0 : SHEAR_ERROR * share * share;
}

/* ---- fillings ---- */

/* thicknesses that a slender body extends from its pins, and motion over that length that its weight would cause */
#define EXTENDED 1.5
#define MOST_SAG 0.1
/* pairs of vertices and pins that are looked at */
#define MOST_PAIRS 10000000

/* m: how far vertices are from the nearest pin, at most: across gravity, whose unit vector is down, and along it */
static void measure_reach(const pel_body_def *body, const double down[3], double *across, double *along)
{
    const int64_t pairs = (int64_t)body->mesh->vertex_count * body->pinned_count;
    const int32_t stride = (int32_t)(1 + pairs / MOST_PAIRS);
    *across = *along = 0;
    for (int32_t v = 0; v < body->mesh->vertex_count; v += stride) {
        double least[2] = {HUGE_VAL, HUGE_VAL};
        for (int32_t i = 0; i < body->pinned_count; i++) {
            double way[3];
            pel_vec3_subtract(body->mesh->positions[v], body->mesh->positions[body->pinned[i]], way);
            double fall = pel_vec3_dot(way, down), square = pel_vec3_squared_length(way);
            least[0] = pel_min(least[0], square - fall * fall);
            least[1] = pel_min(least[1], fabs(fall));
        }
        *across = pel_max(*across, sqrt(pel_max(least[0], 0)));
        *along = pel_max(*along, least[1]);
    }
}

/* As a round rod of the filling's modulus, held at both ends: its middle sags by w a^4 / (24 E I) at a distance a from
   them, and one that hangs stretches by half of its weight. A cantilever sags three times as far. */
bool pel_scene_is_carried(const pel_scene *scene, const pel_model *model, int32_t b)
{
    const pel_body_def *def = &scene->model.bodies[b];
    const pel_body *body = &model->bodies[b];
    const double g = pel_vec3_length(scene->model.gravity);
    const double young = pel_quantity_mean(&def->volumetric_stiffness, def->mesh->vertex_count);
    if (!(def->volumetric_depth > 0 && young > 0 && g > 0) || def->pinned_count == 0 || !body->has_volume)
        return false;
    double mass = 0, across, along, down[3];
    for (int32_t i = body->slice_begin * PEL_WIDTH; i < body->slice_end * PEL_WIDTH; i++)
        mass += (double)model->mass[i];
    pel_vec3_scale(scene->model.gravity, 1 / g, down);
    measure_reach(def, down, &across, &along);
    const double thickness = 4 * fabs(body->rest_volume) / body->rest_area, weight = g * mass / fabs(body->rest_volume);
    const double slenderness = across / thickness;
    const double sag = 2.0 / 3 * weight * across * slenderness * slenderness / young;
    return (slenderness > EXTENDED && sag > MOST_SAG) ||
           (along > EXTENDED * thickness && 0.5 * weight * along / young > MOST_SAG);
}

/* ---- choice ---- */

/* explicit takes both, with a shorter step; it keeps what it had. Implicit does not know rigid spheres */
static bool takes_smooth(const pel_scene_value *root, const pel_scene *scene)
{
    return !pel_scene_has_balls(scene) && (pel_scene_value_at(root, "solver.method")->is_implied ||
                                           pel_stepper_of(scene->sim.solver.method)->turns_edges);
}

static void choose_element(pel_scene_reader *reader, pel_scene_value *element, pel_scene *scene, int32_t b)
{
    /* the defs of the arena may be written to */
    pel_body_def *body = (pel_body_def *)(uintptr_t)&scene->model.bodies[b];
    const pel_solid_shape shape = pel_solid_shape_of(body->mesh);
    const double error = pel_solid_bending_error(&shape);
    const bool locks = body->volume.poisson > PEL_LOCKING_POISSON;
    if (!locks && error < BENDS)
        return;
    body->volume.element = PEL_VOLUME_SMOOTH;
    if (pel_scene_step_cost(scene) > MOST_STEP) {
        body->volume.element = PEL_VOLUME_LINEAR;
        return;
    }
    element->text = "smooth";
    if (locks)
        pel_log_line(reader->log,
                     "body '%s' has smooth elements: linear ones lock at a Poisson's ratio of %.4g (volume: { element: "
                     "linear } chooses them)",
                     body->name, body->volume.poisson);
    else
        pel_log_line(reader->log,
                     "body '%s' has smooth elements: linear ones of %.2g m in a thickness of %.2g m bend about %.2g %% "
                     "too stiffly (volume: { element: linear } chooses them)",
                     body->name, shape.edge, shape.thickness, 100 * error);
}

void pel_scene_choose_elements(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene)
{
    const pel_scene_value *list = pel_scene_value_entry(root, "bodies");
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        pel_scene_value *element = pel_scene_value_at(pel_scene_value_element(list, b), "volume.element");
        const pel_volume_def *volume = &scene->model.bodies[b].volume;
        if (volume->on && volume->element == PEL_VOLUME_LINEAR && element != NULL && element->is_implied &&
            takes_smooth(root, scene))
            choose_element(reader, element, scene, b);
    }
}
