/* Forces of the caller on vertices. */
#include "base/memory.h"
#include "base/status.h"
#include "sim/sim.h"

/* a snapshot before steps in parts takes them in as well */
static pel_status grow_parts(pel_sim *sim, size_t size, pel_error *error)
{
    pel_sim_parts *parts = &sim->parts;
    void *before = pel_allocate(parts->before_size + size, 1);
    if (before == NULL)
        return pel_fail_memory(error);
    pel_free(parts->before);
    parts->before = before;
    parts->before_size += size;
    return PEL_OK;
}

pel_status pel_sim_make_forces(pel_sim *sim, bool has_forces, pel_error *error)
{
    size_t count = (size_t)sim->model->vertex_count;
    if (has_forces == (sim->external != NULL))
        return PEL_OK;
    if (!has_forces) {
        pel_free(sim->external);
        sim->external = NULL;
        return PEL_OK;
    }
    pel_record *made = pel_allocate_aligned(count, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    pel_status status = sim->parts.before != NULL ? grow_parts(sim, count * sizeof *made, error) : PEL_OK;
    if (status == PEL_OK)
        sim->external = made;
    else
        pel_free(made);
    return status;
}
