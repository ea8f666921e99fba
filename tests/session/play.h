/* A scene with its model, simulation and session. Define _XOPEN_SOURCE 700 before. */
#ifndef PEL_TEST_PLAY_H
#define PEL_TEST_PLAY_H

#include "run/run_fixture.h"

#include "pellicle/session.h"

typedef struct play {
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
    pel_session *session;
} play;

static inline play begin(const char *text)
{
    play made;
    made.scene = load_scene(text, NULL, 0);
    assert_int_equal(pel_model_create(&made.scene->model, &made.model, NULL), PEL_OK);
    pel_sim_def def = made.scene->sim;
    def.model = made.model;
    assert_int_equal(pel_sim_create(&def, &made.sim, NULL), PEL_OK);
    assert_int_equal(pel_session_create(made.scene, made.sim, &made.session, NULL), PEL_OK);
    return made;
}

static inline void end(play *made)
{
    pel_session_destroy(made->session);
    pel_sim_destroy(made->sim);
    pel_model_destroy(made->model);
    pel_scene_destroy(made->scene);
}

static inline void apply(play *made, const char *line)
{
    char message[900];
    pel_error error;
    pel_status status = pel_session_apply(made->session, line, &error);
    if (status != PEL_OK)
        print_error("%s: %s\n", line, pel_error_text(&error, message, sizeof message));
    assert_int_equal(status, PEL_OK);
}

static inline void steps(play *made, int count)
{
    pel_error error;
    char message[900];
    for (int i = 0; i < count; i++) {
        pel_status status = pel_session_step(made->session, &error);
        if (status != PEL_OK)
            print_error("%s\n", pel_error_text(&error, message, sizeof message));
        assert_int_equal(status, PEL_OK);
    }
}

#endif
