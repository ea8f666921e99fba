/* Memory of a model and a simulation with everything on (membrane, bending, fibres, pressure, with and without contact)
   on geodesic spheres: bytes a triangle that are held when the model is there, when the simulation is, and after some
   steps, and the most that were held in between.
   usage: bench_memory [largest frequency, 64 by default] */
#include "bench.h"
#include "pellicle/sim_step.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

enum { STEPS = 3 };

/* held by the heap, large blocks included */
static double held_bytes(void)
{
    struct mallinfo2 info = mallinfo2();
    return (double)info.uordblks + (double)info.hblkhd;
}

static pel_model *make_model(const pel_mesh *mesh, pel_bending_model bending)
{
    pel_anisotropy_def fibres = pel_anisotropy_def_default();
    fibres.mode = PEL_FIBRE_STRAIN;
    fibres.direction = PEL_FIBRE_ALONG;
    fibres.stiffness = 100;
    pel_body_def body = pel_body_def_sheet("sphere", mesh, 1e5, 0.01, 1000);
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    body.shell.bending.model = bending;
    body.shell.anisotropies = &fibres;
    body.shell.anisotropy_count = 1;
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body.shell.pressure.outside.value = 5;
    return bench_model(&body);
}

static void bench(int32_t frequency, pel_method method, const char *name, bool contact)
{
    pel_error error;
    pel_mesh *mesh = bench_sphere(frequency);
    double count = mesh->triangle_count, start = held_bytes();
    pel_model *model = make_model(mesh, PEL_BENDING_HINGE);
    double with_model = held_bytes() - start;
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver.method = method;
    def.solver.dt = 0.01;
    def.solver.substeps = method == PEL_METHOD_XPBD ? 4 : 0;
    def.solver.iterations = method == PEL_METHOD_DESCENT ? 20 : 0;
    def.contact.enabled = contact;
    def.thread_count = 1;
    pel_sim *sim;
    bench_check(pel_sim_create(&def, &sim, &error), &error);
    double with_sim = held_bytes() - start - with_model;
    for (int i = 0; i < STEPS; i++)
        bench_check(pel_sim_step(sim, &error), &error);
    double after = held_bytes() - start - with_model;
    printf("%9.0f  %-10s %-8s %7.0f %7.0f %7.0f %9.0f\n", count, name, contact ? "contact" : "", with_model / count,
           with_sim / count, after / count, (with_model + after) / count);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(int argc, char **argv)
{
    int32_t largest = argc > 1 ? atoi(argv[1]) : 64;
    printf("bytes a triangle, %s\n", sizeof(pel_real) == 8 ? "double" : "float");
    printf("triangles  method                model     sim   after steps  together\n");
    for (int32_t frequency = 32; frequency <= largest; frequency *= 2)
        for (int contact = 0; contact < 2; contact++) {
            bench(frequency, PEL_METHOD_PBD, "pbd", contact);
            bench(frequency, PEL_METHOD_XPBD, "xpbd", contact);
            bench(frequency, PEL_METHOD_DESCENT, "descent", contact);
        }
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    printf("peak resident %.1f MB\n", (double)usage.ru_maxrss / 1024);
    return 0;
}
