/* What self-contact costs where nothing comes near: steps of a shell at rest with contact and without, in turns.
   usage: bench_rest [frequency of the geodesic sphere, 32 by default [steps, 100 by default]] */
#include "bench.h"
#include "pellicle/sim_step.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WARM_STEPS = 20 };

static pel_sim *make_sim(const pel_model *model, pel_method method, bool with_contact)
{
    pel_error error;
    pel_sim *sim;
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver.method = method;
    def.solver.dt = 1e-3;
    def.thread_count = 1;
    def.contact.enabled = def.contact.self = with_contact;
    bench_check(pel_sim_create(&def, &sim, &error), &error);
    return sim;
}

static double time_step(pel_sim *sim)
{
    pel_error error;
    double start = pel_thread_seconds();
    bench_check(pel_sim_step(sim, &error), &error);
    return pel_thread_seconds() - start;
}

static void rest(const char *name, const pel_model *model, pel_method method, int steps)
{
    pel_sim *sims[2] = {make_sim(model, method, false), make_sim(model, method, true)};
    double least[2] = {HUGE_VAL, HUGE_VAL};
    for (int n = 0; n < steps + WARM_STEPS; n++)
        for (int s = 0; s < 2; s++) {
            double time = time_step(sims[s]);
            if (n >= WARM_STEPS)
                least[s] = fmin(least[s], time);
        }
    printf("%-22s without %9.3f ms  with %9.3f ms  ratio %.3f\n", name, 1e3 * least[0], 1e3 * least[1],
           least[1] / least[0]);
    pel_sim_destroy(sims[0]);
    pel_sim_destroy(sims[1]);
}

int main(int argc, char **argv)
{
    int32_t frequency = argc > 1 ? atoi(argv[1]) : 32;
    int steps = argc > 2 ? atoi(argv[2]) : 100;
    pel_mesh *mesh = bench_sphere(frequency);
    printf("%d triangles, one thread, least of %d steps\n", (int)mesh->triangle_count, steps);
    pel_body_def body = pel_body_def_default();
    body.name = "sphere";
    body.mesh = mesh;
    pel_model *springs = bench_model(&body);
    body = pel_body_def_sheet("sphere", mesh, 1e6, 0.01, 1000);
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    body.shell.bending.model = PEL_BENDING_ISOMETRIC_REST;
    pel_model *shell = bench_model(&body);
    rest("springs, quasi-static", springs, PEL_METHOD_QUASI_STATIC, steps);
    rest("springs, explicit", springs, PEL_METHOD_EXPLICIT, steps);
    rest("shell, pbd", shell, PEL_METHOD_PBD, steps);
    pel_model_destroy(springs);
    pel_model_destroy(shell);
    pel_mesh_destroy(mesh);
    return 0;
}
