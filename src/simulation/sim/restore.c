/* Snapshots of other surfaces, and snapshots with the defs of the simulation, which undo changes of parameters. */
#include "base/memory.h"
#include "base/status.h"
#include "pellicle/live.h"
#include "sim/change.h"
#include "sim/own_def.h"
#include "sim/sim.h"
#include "sim/snapshot.h"
#include "sim/topology.h"

#include <string.h>

struct pel_snapshot {
    const pel_sim *sim; /* whose it is: only compared */
    pel_model_def model;
    pel_sim_def def;
    pel_copies copies;
    pel_mesh **meshes; /* (def.tool_count) of tools, null = none */
    pel_fingerprint fingerprint;
    size_t size;
    void *bytes;
};

/* meshes of bodies live as long as the simulation, meshes of tools as long as the tools */
static pel_status copy_meshes(pel_snapshot *snapshot, pel_error *error)
{
    pel_tool_def *tools = (pel_tool_def *)(uintptr_t)snapshot->def.tools;
    int32_t count = snapshot->def.tool_count;
    snapshot->def.tool_count = 0;
    snapshot->meshes = pel_allocate((size_t)count, sizeof *snapshot->meshes);
    if (snapshot->meshes == NULL)
        return pel_fail_memory(error);
    pel_status status = PEL_OK;
    for (int32_t t = 0; status == PEL_OK && t < count; t++) {
        const pel_mesh *mesh = tools[t].mesh;
        if (mesh != NULL)
            status = pel_mesh_create(mesh->positions[0], mesh->vertex_count, mesh->triangles[0], mesh->triangle_count,
                                     &snapshot->meshes[t], error);
        tools[t].mesh = snapshot->meshes[t];
        snapshot->def.tool_count = t + 1;
    }
    return status;
}

pel_status pel_snapshot_create(const pel_sim *sim, pel_snapshot **snapshot, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(snapshot, error);
    *snapshot = NULL;
    pel_snapshot *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->sim = sim;
    made->model = sim->given->def;
    made->def = sim->def;
    made->fingerprint = pel_house_of(sim)->fingerprint;
    made->size = pel_sim_save_size(sim);
    made->bytes = pel_allocate(made->size, 1);
    pel_status status = made->bytes != NULL ? PEL_OK : pel_fail_memory(error);
    if (status == PEL_OK)
        status = pel_def_copy(&made->copies, PEL_DEF_MODEL, &made->model, error);
    if (status == PEL_OK)
        status = pel_sim_def_copy(&made->copies, &made->def, error);
    if (status == PEL_OK)
        status = copy_meshes(made, error);
    if (status != PEL_OK) {
        pel_snapshot_destroy(made);
        return status;
    }
    pel_sim_save(sim, made->bytes);
    *snapshot = made;
    return PEL_OK;
}

void pel_snapshot_destroy(pel_snapshot *snapshot)
{
    if (snapshot == NULL)
        return;
    for (int32_t t = 0; snapshot->meshes != NULL && t < snapshot->def.tool_count; t++)
        pel_mesh_destroy(snapshot->meshes[t]);
    pel_free(snapshot->meshes);
    pel_copies_free(&snapshot->copies);
    pel_free(snapshot->bytes);
    pel_free(snapshot);
}

size_t pel_snapshot_size(const pel_snapshot *snapshot)
{
    if (snapshot == NULL)
        return 0;
    return sizeof *snapshot + snapshot->size;
}

/* the snapshot has other cuts: the simulation is made anew with its surfaces, and loads it then */
static pel_status load_surfaces(pel_sim *sim, const void *bytes, size_t size, pel_error *error)
{
    pel_surfaces surfaces;
    pel_change change = {0};
    pel_status status = pel_surfaces_begin(sim, &surfaces, error);
    if (status == PEL_OK)
        status = pel_snapshot_read_surfaces(sim, bytes, size, &surfaces, error);
    if (status == PEL_OK)
        status = pel_change_begin(sim, &change, error);
    if (status == PEL_OK)
        status = pel_change_surfaces(&change, &surfaces, error);
    if (status == PEL_OK) {
        change.state = bytes;
        change.state_size = size;
        status = pel_change_apply(sim, &change, error);
    }
    pel_change_end(&change);
    pel_surfaces_end(&surfaces);
    return status;
}

pel_status pel_sim_load(pel_sim *sim, const void *bytes, size_t size, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(bytes, error);
    bool has_surfaces;
    pel_status status = pel_snapshot_check(sim, bytes, size, &has_surfaces, error);
    if (status != PEL_OK)
        return status;
    if (has_surfaces)
        return pel_snapshot_load(sim, bytes, size, error);
    status = load_surfaces(sim, bytes, size, error);
    /* with another mesh, what it has are no surfaces of the simulation */
    bool is_refused = status != PEL_OK && status != PEL_OUT_OF_MEMORY;
    return is_refused ? pel_snapshot_refuse_other(sim, bytes, status, error) : status;
}

/* the defs are the snapshot's own, the meshes of bodies those of its surfaces */
static pel_status restore_defs(pel_sim *sim, const pel_snapshot *snapshot, const pel_surfaces *surfaces,
                               pel_error *error)
{
    pel_body_def *bodies = (pel_body_def *)(uintptr_t)snapshot->model.bodies;
    for (int32_t b = 0; b < snapshot->model.body_count; b++)
        bodies[b].mesh = surfaces->meshes[b];
    const pel_change change = {.model = snapshot->model,
                               .sim = snapshot->def,
                               .changes_model = true,
                               .surfaces = surfaces,
                               .state = snapshot->bytes,
                               .state_size = snapshot->size};
    return pel_change_apply(sim, &change, error);
}

pel_status pel_snapshot_restore(pel_sim *sim, const pel_snapshot *snapshot, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(snapshot, error);
    if (snapshot->sim != sim)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "restore the simulation that it was made from",
                          "the snapshot is of another simulation");
    if (memcmp(&snapshot->fingerprint, &pel_house_of(sim)->fingerprint, sizeof pel_house_of(sim)->fingerprint) == 0)
        return pel_sim_load(sim, snapshot->bytes, snapshot->size, error);
    pel_surfaces surfaces;
    pel_status status = pel_surfaces_begin(sim, &surfaces, error);
    if (status == PEL_OK)
        status = pel_snapshot_read_surfaces(sim, snapshot->bytes, snapshot->size, &surfaces, error);
    if (status == PEL_OK)
        status = restore_defs(sim, snapshot, &surfaces, error);
    pel_surfaces_end(&surfaces);
    return status;
}
