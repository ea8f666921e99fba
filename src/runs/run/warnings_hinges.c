/* Hinges bend a flat sheet as its material does only in the mean over all directions and meshes: their stiffness
   depends on the directions of edges, and they know no Poisson's ratio, so that twist is up to 2 / (1 - nu) times too
   stiff. The shape at the end tells: with the mean curvature H and the Gaussian curvature K a plate of the rigidity D
   stores D (2 H^2 - (1 - nu) K) per area. Where hinges take another shape than a plate would, they may store as much as
   a plate there, and nothing is told. */
#include "run/warnings_hinges.h"

#include "base/memory.h"
#include "field/corner.h"
#include "model/shell.h"
#include "pellicle/measure.h"
#include "pellicle/sim_surface.h"
#include "pellicle/topology.h"
#include "run/state.h"
#include "run/warnings_springs.h"
#include "stage/stepper.h"

#include <math.h>
#include <stdio.h>

/* of the elastic energy: less bending than that does not hold the shape */
#define LEAST_SHARE 0.5
/* of the supplied energy: less than that is rounding */
#define LEAST_ENERGY 1e-6
/* rad, root of the mean square: an edge turns by more where the mesh does not show the shape */
#define MOST_TURN 0.2
/* of the energy of the plate, which the mesh itself gives within a tenth */
#define MOST_ERROR 0.15

/* over triangles with a corner inside */
typedef struct plate_sums {
    double energy;  /* J, of the plate */
    double covered; /* m2 */
    double area;    /* m2, of all triangles */
    double turn;    /* of squares of the turns of edges, times area */
} plate_sums;

/* D and Poisson's ratio are those of all hinges, and the sheet is flat at rest: folds that stay store no energy */
static bool is_plate(const pel_run_state *run, int32_t b)
{
    const pel_body_def *body = &run->scene->model.bodies[b];
    const pel_shell *shell = run->model->bodies[b].shell;
    double axes[2][3];
    return shell != NULL && shell->has_membrane && body->shell.bending.model == PEL_BENDING_HINGE &&
           body->shell.membrane.kind != PEL_MEMBRANE_ORTHOTROPIC && shell->hinge_stiffnesses == NULL &&
           shell->hinge_stiffness > 0 && shell->yield_angles == NULL && body->refine.levels == 0 &&
           pel_sim_vertex_count(run->sim, b) == body->mesh->vertex_count && pel_warnings_find_plane(body->mesh, axes);
}

/* a body in its shape at the end */
typedef struct bent_plate {
    const pel_topology *topology;
    const double *now;            /* (3 vertex_count) */
    pel_vertex_measure *measures; /* (vertex_count) */
    double (*sums)[2];            /* (vertex_count) of mean curvature times area, of area */
} bent_plate;

/* Means over a triangle of the curvatures of its corners inside, weighted by their parts of it, where fields of
   vertices that oscillate with the pattern of the mesh cancel; false where no corner is inside. */
static bool find_means(const bent_plate *plate, int32_t t, double means[2])
{
    double area = 0;
    means[0] = means[1] = 0;
    for (int i = 0; i < 3; i++) {
        const pel_vertex_measure *at = &plate->measures[plate->topology->triangles[t][i]];
        pel_corner corner = pel_corner_load(plate->topology, plate->now, 3 * t + i);
        double part = at->boundary ? 0 : pel_corner_mixed_area(&corner);
        area += part;
        means[0] += part * at->mean_curvature;
        means[1] += part * at->gaussian_curvature;
    }
    for (int k = 0; k < 2 && area > 0; k++)
        means[k] /= area;
    return area > 0;
}

/* the mean curvatures of vertices become the means of the triangles around them */
static void smooth(const bent_plate *plate)
{
    double means[2];
    for (int32_t t = 0; t < plate->topology->triangle_count; t++) {
        bool is_inside = find_means(plate, t, means);
        for (int i = 0; is_inside && i < 3; i++) {
            pel_corner corner = pel_corner_load(plate->topology, plate->now, 3 * t + i);
            double *sums = plate->sums[plate->topology->triangles[t][i]];
            sums[0] += pel_corner_mixed_area(&corner) * means[0];
            sums[1] += pel_corner_mixed_area(&corner);
        }
    }
    for (int32_t v = 0; v < plate->topology->vertex_count; v++)
        if (plate->sums[v][1] > 0)
            plate->measures[v].mean_curvature = plate->sums[v][0] / plate->sums[v][1];
}

static void add_triangle(const bent_plate *plate, int32_t t, double rigidity, double poisson, plate_sums *sums)
{
    pel_corner corner = pel_corner_load(plate->topology, plate->now, 3 * t);
    double means[2], area = corner.twice_area / 2;
    sums->area += area;
    if (!find_means(plate, t, means))
        return;
    sums->covered += area;
    sums->energy += area * rigidity * (2 * means[0] * means[0] - (1 - poisson) * means[1]);
    sums->turn += 4 * area * area * means[0] * means[0];
}

/* false where memory runs out */
static bool add_body(const pel_run_state *run, int32_t b, plate_sums *sums)
{
    const pel_mesh *mesh = run->scene->model.bodies[b].mesh;
    const double rigidity = run->model->bodies[b].shell->hinge_stiffness;
    const double poisson = run->scene->model.bodies[b].shell.membrane.poisson;
    pel_topology *topology = NULL;
    double *now = pel_allocate(3 * (size_t)mesh->vertex_count, sizeof *now);
    pel_vertex_measure *measures = pel_allocate((size_t)mesh->vertex_count, sizeof *measures);
    double(*weights)[2] = pel_allocate((size_t)mesh->vertex_count, sizeof *weights);
    bool is_done =
        now != NULL && measures != NULL && weights != NULL && pel_topology_create(mesh, &topology, NULL) == PEL_OK;
    if (is_done) {
        const bent_plate plate = {topology, now, measures, weights};
        pel_sim_get_positions(run->sim, b, now);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            pel_vertex_measure_fill(topology, now, v, &measures[v]);
        smooth(&plate);
        for (int32_t t = 0; t < mesh->triangle_count; t++)
            add_triangle(&plate, t, rigidity, poisson, sums);
    }
    pel_topology_destroy(topology);
    pel_free(weights);
    pel_free(measures);
    pel_free(now);
    return is_done;
}

void pel_warnings_check_hinges(pel_run_state *run, int64_t frame)
{
    const pel_sim_measures *measures = &run->measures;
    const double bending = measures->bending_energy, both = bending + measures->membrane_energy;
    plate_sums sums = {0};
    int32_t first = -1;
    /* who names them knows them */
    if (!run->scene->hinges_are_implied || !(bending > LEAST_SHARE * both) ||
        !(both > LEAST_ENERGY * run->ledger.supplied) ||
        !pel_stepper_knows_material(pel_stepper_of(run->scene->sim.solver.method)))
        return;
    for (int32_t b = 0; b < run->scene->model.body_count; b++) {
        const pel_shell *shell = run->model->bodies[b].shell;
        if (shell == NULL || !shell->has_membrane)
            continue;
        if (!is_plate(run, b) || !add_body(run, b, &sums))
            return;
        first = first < 0 ? b : first;
    }
    if (first < 0 || !(sums.covered > 0) || !(sums.turn < MOST_TURN * MOST_TURN * sums.covered))
        return;
    const double factor = bending * sums.covered / (sums.energy * sums.area);
    if (!(factor > 0) || !(fabs(factor - 1) > MOST_ERROR))
        return;
    run->flagged[PEL_WARN_HINGES] = (pel_flagged_body){first, factor, 0};
    pel_warn(&run->totals.warnings, PEL_WARN_HINGES, frame, fabs(factor - 1));
}

void pel_tell_hinges(const pel_warning_text *at)
{
    const pel_flagged_body *flagged = &at->run->flagged[PEL_WARN_HINGES];
    snprintf(at->text, at->size,
             "the hinges of body '%s' are about %.2g times as stiff as its material in the shape at the end: their "
             "stiffness depends on the directions of edges. use the method implicit or static, whose bending (model "
             "midedge) does not",
             at->run->scene->model.bodies[flagged->body].name, flagged->value);
}
