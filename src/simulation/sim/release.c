/* Vertices that leave their volumetric springs, between two steps. */
#include "base/status.h"
#include "sim/change.h"
#include "sim/cut.h"
#include "tear/growth.h"

static pel_status release(pel_sim *sim, const pel_adhesion *adhesion, int32_t count, pel_error *error)
{
    pel_change change;
    pel_status status = pel_change_begin(sim, &change, error);
    if (status == PEL_OK) {
        /* the list lives until the old simulation goes, after the new one has its copy */
        pel_body_def *def = pel_change_body(&change, adhesion->body);
        def->released = adhesion->list;
        def->released_count = count;
        change.changes_model = change.is_release = true;
        status = pel_change_apply(sim, &change, error);
    }
    pel_change_end(&change);
    return status;
}

pel_status pel_adhesions_release(pel_sim *sim, bool *has_released, pel_error *error)
{
    pel_status status = PEL_OK;
    *has_released = false;
    /* a body that lets go makes the adhesions anew */
    for (int32_t i = 0; status == PEL_OK && sim->tear != NULL && i < sim->tear->adhesion_count; i++) {
        const pel_adhesion *adhesion = &sim->tear->adhesions[i];
        int32_t count = pel_adhesion_look(adhesion, sim);
        if (count == adhesion->released_count)
            continue;
        status = release(sim, adhesion, count, error);
        *has_released |= status == PEL_OK;
    }
    return status;
}
