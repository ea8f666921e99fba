/* Runs beside a run: simulations that are stepped with it, and rows of their series at its frames. */
#include "base/room.h"
#include "base/status.h"
#include "gradient/step_beside.h"
#include "run/state.h"

static pel_status make_room(pel_run_state *run, pel_error *error)
{
    size_t count = (size_t)run->def->beside->count;
    bool made = PEL_ALLOCATE_ALL(PEL_ROOM(run->models_beside, count), PEL_ROOM(run->sims_beside, count),
                                 PEL_ROOM(run->series_beside, count));
    return made ? PEL_OK : pel_fail_memory(error);
}

pel_status pel_run_beside_create(pel_run_state *run, pel_error *error)
{
    const pel_run_beside *beside = run->def->beside;
    if (beside == NULL || beside->count == 0)
        return PEL_OK;
    if (run->scene->session_count > 0)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "take derivatives by differences of whole runs",
                          "a session has no runs beside it");
    pel_status status = make_room(run, error);
    for (int32_t i = 0; status == PEL_OK && i < beside->count; i++) {
        pel_sim_def def = beside->scenes[i]->sim;
        status = pel_model_create(&beside->scenes[i]->model, &run->models_beside[i], error);
        if (status != PEL_OK)
            return status;
        def.model = run->models_beside[i];
        def.thread_count = run->thread_count;
        status = pel_sim_create(&def, &run->sims_beside[i], error);
        if (status == PEL_OK)
            status = pel_run_series_create(&run->series_beside[i], NULL, run->sims_beside[i], error);
    }
    return status == PEL_OK ? pel_sim_check_beside(run->sim, run->sims_beside, beside->count, error) : status;
}

void pel_run_beside_destroy(pel_run_state *run)
{
    bool has_room = run->models_beside != NULL && run->sims_beside != NULL && run->series_beside != NULL;
    for (int32_t i = 0; has_room && i < run->def->beside->count; i++) {
        pel_run_series_close(&run->series_beside[i]);
        pel_sim_destroy(run->sims_beside[i]);
        pel_model_destroy(run->models_beside[i]);
    }
    PEL_FREE_ALL(run->models_beside, run->sims_beside, run->series_beside);
}

void pel_run_beside_add_frame(pel_run_state *run)
{
    const pel_run_beside *beside = run->def->beside;
    if (run->sims_beside == NULL || beside->row == NULL)
        return;
    for (int32_t i = 0; i < beside->count; i++) {
        pel_run_row row = {.frame = run->totals.frame_count};
        pel_run_measure(run->sims_beside[i], 0, &row.measures, &row.ledger);
        pel_run_series_make(&run->series_beside[i], run->sims_beside[i], &row);
        beside->row(beside->user, i, run->series_beside[i].line);
    }
}

void pel_run_beside_end(pel_run_state *run)
{
    if (run->def->ended == NULL)
        return;
    run->def->ended(run->def->user, -1, run->sim);
    for (int32_t i = 0; run->sims_beside != NULL && i < run->def->beside->count; i++)
        run->def->ended(run->def->user, i, run->sims_beside[i]);
}
