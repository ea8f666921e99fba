/* A scene given as text, its model and simulation, and what reading it told. */
#ifndef TESTS_SCENE_RUN_H
#define TESTS_SCENE_RUN_H

#include "check.h"

#include "pellicle/scene.h"
#include "pellicle/sim.h"

typedef struct heard {
    char text[2000];
} heard;

static inline void hear(void *user, const char *text)
{
    heard *told = user;
    size_t length = strlen(told->text);
    snprintf(told->text + length, sizeof told->text - length, "%s\n", text);
}

typedef struct run {
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
    heard told;
} run;

static inline pel_status begin(run *r, const char *text, pel_error *error)
{
    *r = (run){0};
    pel_log log = {.write = hear, .user = &r->told};
    pel_status status = pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, &log, &r->scene, error);
    if (status == PEL_OK)
        status = pel_model_create(&r->scene->model, &r->model, error);
    if (status != PEL_OK)
        return status;
    r->scene->sim.model = r->model;
    return pel_sim_create(&r->scene->sim, &r->sim, error);
}

static inline void end(run *r)
{
    pel_sim_destroy(r->sim);
    pel_model_destroy(r->model);
    pel_scene_destroy(r->scene);
}

static inline void check_begin(run *r, const char *text)
{
    pel_error error = {0};
    char message[1000];
    if (begin(r, text, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, message, sizeof message));
}

/* a scene that is refused, and part of the reason */
typedef struct refusal {
    const char *text, *says;
} refusal;

static inline void check_refusals(const refusal *cases, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        run r;
        pel_error error = {0};
        char message[1000] = "";
        pel_status status = begin(&r, cases[i].text, &error);
        pel_error_text(&error, message, sizeof message);
        if (status == PEL_OK || strstr(message, cases[i].says) == NULL || error.remedy[0] == '\0')
            fail_msg("case %d: %s", (int)i, message);
        end(&r);
    }
}

#endif
