#include "sim/cut.h"

#include "base/status.h"
#include "model/origin.h"

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

static bool names_vertices(const int32_t *vertices, int32_t count, int32_t vertex_count)
{
    for (int32_t i = 0; vertices != NULL && i < count; i++)
        if (vertices[i] < 0 || vertices[i] >= vertex_count)
            return false;
    return vertices == NULL || count > 1;
}

static pel_status check_seam(const pel_sim *sim, const pel_seam_def *seam, int32_t number, pel_error *error)
{
    const char *fault = NULL, *remedy = NULL;
    if (seam->body < 0 || seam->body >= sim->given->body_count)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "seam", number, "give a body of the model",
                                  "body %d does not exist", (int)seam->body);
    const pel_body_def *def = &sim->given->def.bodies[seam->body];
    int32_t vertex_count = pel_origins_base_count(def);
    pel_pressure_kind kind = def->shell.pressure.kind;
    if ((seam->path != NULL) == (seam->vertices != NULL)) {
        fault = "has both a path and vertices, or none";
        remedy = "give one of them";
    } else if (!names_vertices(seam->path, seam->path_count, vertex_count) ||
               !names_vertices(seam->vertices, seam->vertex_count, vertex_count)) {
        fault = "has less than two vertices, or names one that does not exist";
        remedy = "give vertices of the mesh";
    } else if (!(seam->strength >= 0 && isfinite(seam->strength)) || isnan(seam->opens_at)) {
        fault = "has a strength below 0 or numbers that are not finite";
        remedy = "give a strength in N/m, and a time in s";
    } else if (seam->strength == 0 && seam->opens_at < 0) {
        fault = "never opens";
        remedy = "give it a strength (N/m), or a time (opens_at)";
    } else if (kind == PEL_PRESSURE_GAS || kind == PEL_PRESSURE_VOLUME) {
        fault = "would open a body that encloses a gas or has a target volume";
        remedy = "give its pressure as a number or keys";
    }
    if (fault == NULL)
        return PEL_OK;
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "seam", number, remedy, "seam %d of body '%s' %s",
                              (int)number + 1, sim->given->bodies[seam->body].name, fault);
}

pel_status pel_cuts_check(const pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    pel_status status = def->cut_count > 0 || def->seam_count > 0 ? pel_cut_check_sim(sim, error) : PEL_OK;
    for (int32_t s = 0; status == PEL_OK && s < def->seam_count; s++)
        status = check_seam(sim, &def->seams[s], s, error);
    for (int32_t c = 0; status == PEL_OK && c < def->cut_count; c++) {
        const pel_cut_def *cut = &def->cuts[c];
        if (!(cut->at >= 0 && isfinite(cut->at)) || (c > 0 && cut->at < cut[-1].at))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "cut", c, "give cuts in the order of their times",
                                      "time of the cut is %g s", cut->at);
        status = pel_cut_check_path(sim, cut->body, cut->vertices, cut->vertex_count, error);
    }
    return status;
}
