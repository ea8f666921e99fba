#ifndef PAPERS_LAB_TRIAL_H
#define PAPERS_LAB_TRIAL_H

#include <pellicle/scene.h>

/* A scene at work, without a folder. */
typedef struct lab_trial {
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
} lab_trial;

/* The scene is given as text with overrides (null-terminated list, nullable); errors name it. Closing a trial that
   failed to open is fine. */
pel_status lab_open_trial(const char *name, const char *text, const char *const *overrides, lab_trial *trial,
                          pel_error *error);
void lab_close_trial(lab_trial *trial);

/* so many steps */
pel_status lab_step_trial(lab_trial *trial, int steps, pel_error *error);

/* length of a null-terminated list, which may be null */
int32_t lab_count_overrides(const char *const *overrides);

#endif
