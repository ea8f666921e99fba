#include "papers/lab/trial.h"

#include <string.h>

int32_t lab_count_overrides(const char *const *overrides)
{
    int32_t count = 0;
    while (overrides != NULL && overrides[count] != NULL)
        count++;
    return count;
}

pel_status lab_open_trial(const char *name, const char *text, const char *const *overrides, lab_trial *trial,
                          pel_error *error)
{
    *trial = (lab_trial){NULL, NULL, NULL};
    pel_status status = pel_scene_parse(name, text, strlen(text), overrides, lab_count_overrides(overrides), NULL,
                                        &trial->scene, error);
    if (status == PEL_OK)
        status = pel_model_create(&trial->scene->model, &trial->model, error);
    if (status == PEL_OK) {
        trial->scene->sim.model = trial->model;
        status = pel_sim_create(&trial->scene->sim, &trial->sim, error);
    }
    return status;
}

void lab_close_trial(lab_trial *trial)
{
    pel_sim_destroy(trial->sim);
    pel_model_destroy(trial->model);
    pel_scene_destroy(trial->scene);
}

pel_status lab_step_trial(lab_trial *trial, int steps, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < steps; i++)
        status = pel_sim_step(trial->sim, error);
    return status;
}
