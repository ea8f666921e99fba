/* Forces of the caller on vertices. */
#include "base/memory.h"
#include "base/status.h"
#include "sim/sim.h"

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
    sim->external = made;
    return PEL_OK;
}
