#include "sim/cut.h"

#include "base/status.h"

#include <math.h>

pel_status pel_cut_check_path(const pel_sim *sim, int32_t body, const int32_t *vertices, int32_t vertex_count,
                              pel_error *error)
{
    if (body < 0 || body >= sim->given->body_count)
        return pel_fail(error, PEL_BAD_ARGUMENT, "body %d does not exist", (int)body);
    const pel_mesh *mesh = sim->given->bodies[body].mesh;
    if (vertices == NULL || vertex_count < 2)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give two or more vertices", "a cut has %d vertices",
                          (int)vertex_count);
    for (int32_t i = 0; i < vertex_count; i++)
        if (vertices[i] < 0 || vertices[i] >= mesh->vertex_count)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "vertex", vertices[i], "give vertices of the mesh",
                                      "a cut names a vertex that does not exist");
    return PEL_OK;
}

pel_status pel_cut_check_sim(const pel_sim *sim, pel_error *error)
{
    if (sim->active != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT,
                          "subdivide the mesh before (`pellicle subdivide`), and leave out `refine`",
                          "a cut of bodies of which one refines");
    if (sim->def.solver.path != PEL_PATH_TIME || sim->def.solver.analysis != PEL_ANALYSIS_NONE)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "use steps over time, without path and analysis",
                          "a cut along a path of balances or in an analysis");
    return PEL_OK;
}

pel_status pel_cuts_check(const pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    pel_status status = def->cut_count > 0 ? pel_cut_check_sim(sim, error) : PEL_OK;
    for (int32_t c = 0; status == PEL_OK && c < def->cut_count; c++) {
        const pel_cut_def *cut = &def->cuts[c];
        if (!(cut->at >= 0 && isfinite(cut->at)) || (c > 0 && cut->at < cut[-1].at))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "cut", c, "give cuts in the order of their times",
                                      "time of the cut is %g s", cut->at);
        status = pel_cut_check_path(sim, cut->body, cut->vertices, cut->vertex_count, error);
    }
    return status;
}
