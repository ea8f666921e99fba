/* What it costs to open the surface one edge further: a stretched sheet that tears, with self-contact and without.
   The advance by itself, the step after it, which may tear once more, and the steps in which nothing opened before.
   usage: bench_tear [cells of a side, 50 by default] */
#include "bench.h"
#include "pellicle/shape.h"
#include "pellicle/sim.h"
#include "pellicle/sim_step.h"
#include "pellicle/sim_surface.h"
#include "pellicle/tear.h"
#include "sim/cut.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* m: a sheet of this side, drawn apart by this share, with a cut of a tenth of it */
#define SIDE 0.1
#define STRETCH 1.05

enum { STEPS = 100, RELAXING_STEPS = 2000, MOST_SIDE = 400 };

static pel_mesh *make_sheet(int32_t cells)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    pel_error error;
    pel_mesh *mesh;
    def.nx = def.ny = cells;
    def.size_x = def.size_y = SIDE;
    bench_check(pel_shape_create(&def, &mesh, &error), &error);
    return mesh;
}

/* pinned at both sides that are drawn apart; the resistance is half of what a slit in a strip releases */
static pel_model *make_model(const pel_mesh *mesh, bool is_shell)
{
    static int32_t pins[2 * MOST_SIDE];
    const double young = 1e6, thickness = 1e-3, strain = STRETCH - 1;
    const double toughness = 0.1 * young * strain * strain * SIDE;
    pel_body_def body = is_shell ? pel_body_def_sheet("sheet", mesh, young, thickness, 1000) : pel_body_def_default();
    body.name = "sheet";
    body.mesh = mesh;
    body.volumetric_stiffness.value = 0;
    body.pinned = pins;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (fabs(mesh->positions[v][1]) > 0.4999 * SIDE)
            pins[body.pinned_count++] = v;
    if (is_shell)
        body.shell.membrane.toughness.value = toughness;
    else {
        body.mass_kind = PEL_MASS_DENSITY;
        body.mass = 1000;
        body.thickness.value = body.spring_thickness = thickness;
        body.spring_stiffness.value = young;
        body.spring_toughness.value = toughness;
    }
    return bench_model(&body);
}

/* along the middle from the border, to a tenth of the sheet */
static void cut(pel_sim *sim, const pel_mesh *mesh)
{
    static int32_t path[MOST_SIDE];
    int32_t count = 0;
    pel_error error;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (fabs(mesh->positions[v][1]) < 1e-9 && mesh->positions[v][0] < -0.4 * SIDE + 1e-9)
            path[count++] = v;
    bench_check(pel_cut(sim, 0, path, count, &error), &error);
}

static pel_sim *make_sim(const pel_model *model, const pel_mesh *mesh, pel_method method, bool with_contact)
{
    pel_error error;
    pel_sim *sim;
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver.method = method;
    def.solver.dt = 1e-3;
    def.solver.momentum = method == PEL_METHOD_QUASI_STATIC ? 0.95 : 0;
    def.thread_count = 1;
    def.contact.enabled = def.contact.self = with_contact;
    bench_check(pel_sim_create(&def, &sim, &error), &error);
    double *x = bench_allocate((size_t)mesh->vertex_count, 3 * sizeof *x);
    memcpy(x, mesh->positions, (size_t)mesh->vertex_count * 3 * sizeof *x);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        x[3 * v + 1] *= STRETCH;
    bench_check(pel_sim_set_positions(sim, 0, x, &error), &error);
    free(x);
    cut(sim, mesh);
    return sim;
}

static double seconds_of(pel_status (*part)(pel_sim *sim, bool *has_grown, pel_error *error), pel_sim *sim, bool *grew)
{
    pel_error error;
    double start = pel_thread_seconds();
    bench_check(part(sim, grew, &error), &error);
    return pel_thread_seconds() - start;
}

static pel_status step(pel_sim *sim, bool *unused, pel_error *error)
{
    (void)unused;
    return pel_sim_step(sim, error);
}

static void tear(const char *name, const pel_model *model, const pel_mesh *mesh, pel_method method, bool with_contact)
{
    static double advances[RELAXING_STEPS], after[RELAXING_STEPS], others[RELAXING_STEPS];
    int grown = 0, still = 0, steps = method == PEL_METHOD_QUASI_STATIC ? RELAXING_STEPS : STEPS;
    pel_sim *sim = make_sim(model, mesh, method, with_contact);
    for (int n = 0; n < steps; n++) {
        bool has_grown;
        double advance = seconds_of(pel_tears_grow, sim, &has_grown), next = seconds_of(step, sim, NULL);
        if (has_grown) {
            advances[grown] = advance;
            after[grown++] = next;
        } else
            others[still++] = next;
    }
    printf("%-14s%-8s %3d advances of %7.3f ms, the step then %7.3f ms, other steps %7.3f ms\n", name,
           with_contact ? " contact" : "", grown, 1e3 * bench_spread_of(advances, grown).median,
           1e3 * bench_spread_of(after, grown).median, 1e3 * bench_spread_of(others, still).median);
    pel_sim_destroy(sim);
}

int main(int argc, char **argv)
{
    pel_mesh *mesh = make_sheet(argc > 1 ? atoi(argv[1]) : 50);
    pel_model *springs = make_model(mesh, false), *shell = make_model(mesh, true);
    printf("%d triangles, one thread, median processor time of a step\n", (int)mesh->triangle_count);
    for (int contact = 0; contact < 2; contact++) {
        tear("quasi-static", springs, mesh, PEL_METHOD_QUASI_STATIC, contact);
        tear("xpbd", shell, mesh, PEL_METHOD_XPBD, contact);
        tear("implicit", shell, mesh, PEL_METHOD_IMPLICIT, contact);
    }
    pel_model_destroy(springs);
    pel_model_destroy(shell);
    pel_mesh_destroy(mesh);
    return 0;
}
