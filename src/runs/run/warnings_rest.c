/* A column under more than Euler's load that is straight to the last digit stays straight in time, too. Where bodies
   hardly moved, the static method, which leaves unstable equilibria, starts from the state at the end: if it goes far,
   the bodies only stayed because nothing pushed them aside. */
#include "run/warnings_rest.h"

#include "base/memory.h"
#include "choice/time_step.h"
#include "law/bending_model.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "mesh/figures.h"
#include "model/shell.h"
#include "pellicle/sim_step.h"
#include "pellicle/sim_surface.h"
#include "run/state.h"
#include "stage/stepper.h"

#include <math.h>

/* of its size: a body that moved farther shows what it does */
#define NEAR_SHARE 1e-2
/* the static method moves a vertex by more than this share of the body, and this many times as far as the run did */
#define FAR_SHARE 1e-3
#define FAR_TIMES 10
/* of the supplied energy: bodies that have more of it as motion have only just begun to move */
#define MOST_MOTION 0.6
/* an equilibrium of more takes too long */
enum { MOST_VERTICES = 20000 };

/* m, of the smallest body */
static double least_size(const pel_run_state *run)
{
    double least = HUGE_VAL;
    for (int32_t b = 0; b < run->scene->model.body_count; b++)
        least = pel_min(least, pel_mesh_diagonal(run->scene->model.bodies[b].mesh));
    return least;
}

/* near the start under loads alone, in a state that depends on bending */
static bool is_judged(const pel_run_state *run)
{
    const pel_scene *scene = run->scene;
    const pel_stepper *stepper = pel_stepper_of(scene->sim.solver.method);
    pel_contact_statistics contact;
    int64_t vertices = 0;
    bool bends = false;
    pel_sim_get_contact_statistics(run->sim, &contact);
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        const pel_shell *shell = run->model->bodies[b].shell;
        const pel_body_def *body = &scene->model.bodies[b];
        vertices += pel_sim_vertex_count(run->sim, b);
        bends |= shell != NULL && shell->has_membrane && pel_bending_is_on(shell->bending);
        if (body->refine.levels > 0 || body->volume.on || pel_sim_vertex_count(run->sim, b) != body->mesh->vertex_count)
            return false;
    }
    return stepper->has_velocity && pel_stepper_knows_material(stepper) && bends && vertices <= MOST_VERTICES &&
           scene->sim.tool_count == 0 && scene->sim.tie_count == 0 && scene->sim.cut_count == 0 &&
           scene->sim.seam_count == 0 && scene->sim.wind.density == 0 && run->session == NULL &&
           contact.contacts == 0 && run->ledger.elastic > 0 &&
           run->ledger.kinetic < MOST_MOTION * run->ledger.supplied &&
           pel_run_max_displacement(run) < NEAR_SHARE * least_size(run);
}

/* sets the bodies of `to` where they are in `from`, or finds how far they are apart; 0 = not known */
static double compare(const pel_run_state *run, pel_sim *to, bool sets)
{
    double most = 0;
    for (int32_t b = 0; b < run->scene->model.body_count; b++) {
        size_t count = 3 * (size_t)pel_sim_vertex_count(run->sim, b);
        double *here = pel_allocate(2 * count, sizeof *here), *there = here + count;
        if (here == NULL)
            return 0;
        pel_sim_get_positions(run->sim, b, here);
        pel_sim_get_positions(to, b, there);
        for (size_t v = 0; v < count && !sets; v += 3)
            most = pel_max(most, pel_vec3_distance(here + v, there + v) /
                                     pel_mesh_diagonal(run->scene->model.bodies[b].mesh));
        if (sets)
            most += pel_sim_set_positions(to, b, here, NULL) == PEL_OK;
        pel_free(here);
    }
    return most;
}

/* of its size, how far the static method takes a body from where the run left it */
static double find_way(const pel_run_state *run)
{
    pel_sim_def def = run->scene->sim;
    pel_sim *sim = NULL;
    double way = 0;
    def.model = run->model;
    def.solver = pel_sim_def_default().solver;
    def.solver.method = pel_scene_static_method();
    def.solver.dt = pel_sim_time(run->sim);
    def.wind = pel_sim_def_default().wind;
    def.contact.enabled = false;
    def.wanted = run->def->wanted;
    def.user = run->def->user;
    def.thread_count = run->thread_count;
    if (pel_sim_create(&def, &sim, NULL) == PEL_OK && compare(run, sim, true) == run->scene->model.body_count &&
        pel_sim_step(sim, NULL) == PEL_OK) {
        pel_solver_reading solver;
        pel_sim_get_solver(sim, &solver);
        way = solver.converged ? compare(run, sim, false) : 0;
    }
    pel_sim_destroy(sim);
    return way;
}

void pel_warnings_check_balance(pel_run_state *run, int64_t frame)
{
    if (!is_judged(run))
        return;
    double way = find_way(run);
    if (way > FAR_SHARE && way * least_size(run) > FAR_TIMES * pel_run_max_displacement(run))
        pel_warn(&run->totals.warnings, PEL_WARN_UNSTABLE, frame, way);
}
