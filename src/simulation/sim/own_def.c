/* The def of a simulation: a deep copy, and its fingerprint. */
#include "sim/own_def.h"

#include "base/status.h"
#include "sim/sim.h"

static int32_t weight_count(const pel_sim_def *def, const pel_load_def *load)
{
    return load->vertices != NULL ? load->vertex_count : def->model->bodies[load->body].mesh->vertex_count;
}

void pel_sim_take_fingerprint(pel_sim *sim)
{
    const pel_sim_def *def = &sim->def;
    pel_house_of(sim)->fingerprint = sim->given->fingerprint;
    for (int32_t l = 0; l < def->load_count; l++)
        if (def->loads[l].weights != NULL)
            pel_fingerprint_add_bytes(&pel_house_of(sim)->fingerprint, PEL_PART_LOADS, def->loads[l].weights,
                                      (size_t)weight_count(def, &def->loads[l]) * sizeof(double));
    for (int32_t t = 0; t < def->tie_count; t++)
        if (def->ties[t].stiffnesses != NULL)
            pel_fingerprint_add_bytes(&pel_house_of(sim)->fingerprint, PEL_PART_TIES, def->ties[t].stiffnesses,
                                      (size_t)def->ties[t].vertex_count * sizeof(double));
    pel_fingerprint_add(&pel_house_of(sim)->fingerprint, PEL_DEF_SIM, def);
}

pel_status pel_sim_def_copy(pel_copies *copies, pel_sim_def *def, pel_error *error)
{
    pel_status status = pel_def_copy(copies, PEL_DEF_SIM, def, error);
    pel_load_def *loads = (pel_load_def *)(uintptr_t)def->loads;
    for (int32_t l = 0; status == PEL_OK && l < def->load_count; l++) {
        if (loads[l].weights == NULL)
            continue;
        loads[l].weights =
            pel_copies_take(copies, loads[l].weights, (size_t)weight_count(def, &loads[l]) * sizeof(double));
        if (loads[l].weights == NULL)
            return pel_fail_memory(error);
    }
    pel_tie_def *ties = (pel_tie_def *)(uintptr_t)def->ties;
    for (int32_t t = 0; status == PEL_OK && t < def->tie_count; t++) {
        if (ties[t].stiffnesses == NULL)
            continue;
        ties[t].stiffnesses =
            pel_copies_take(copies, ties[t].stiffnesses, (size_t)ties[t].vertex_count * sizeof(double));
        if (ties[t].stiffnesses == NULL)
            return pel_fail_memory(error);
    }
    return status;
}
