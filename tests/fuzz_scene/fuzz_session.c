/* Fuzzes the commands of a session: each line of the input on a ball, with a step after some. For any input the state
   stays finite, and accepted commands can be read again. */
#include "pellicle/session.h"
#include "session/command.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LINES = 12 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char scene_text[] = "version: 1\nbodies:\n"
                                 "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 1 },\n"
                                 "      springs: { stiffness: 3 }, volumetric: { stiffness: 1.5 } }\n"
                                 "solver: { method: quasi-static, dt: 0.01, threads: 1 }\nduration: 1\n";

/* the tidied line of a command that was read gives the same command again */
static void check_fixed_point(const char *line)
{
    pel_command once, twice;
    if (pel_command_parse(line, &once, NULL) != PEL_OK)
        return;
    if (pel_command_parse(once.line, &twice, NULL) != PEL_OK || strcmp(once.line, twice.line) != 0)
        abort();
}

static void apply_lines(pel_session *session, char *text)
{
    int count = 0;
    for (char *next, *line = text; line != NULL && count < MOST_LINES; line = next, count++) {
        next = strchr(line, '\n');
        if (next != NULL)
            *next++ = '\0';
        pel_error error = {0};
        check_fixed_point(line);
        pel_status status = pel_session_apply(session, line, &error);
        if (status == PEL_OK && count % 2 == 1)
            status = pel_session_step(session, &error);
        if (status != PEL_OK && error.what[0] == '\0')
            abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    pel_scene *scene = NULL;
    pel_model *model = NULL;
    pel_sim *sim = NULL;
    pel_session *session = NULL;
    double positions[12][3];
    char *text = calloc(size + 1, 1);
    if (text == NULL ||
        pel_scene_parse("fuzz.yaml", scene_text, strlen(scene_text), NULL, 0, NULL, &scene, NULL) != PEL_OK ||
        pel_model_create(&scene->model, &model, NULL) != PEL_OK)
        abort();
    if (size > 0)
        memcpy(text, data, size);
    pel_sim_def def = scene->sim;
    def.model = model;
    if (pel_sim_create(&def, &sim, NULL) != PEL_OK || pel_session_create(scene, sim, &session, NULL) != PEL_OK)
        abort();
    apply_lines(session, text);
    pel_sim_get_positions(sim, 0, &positions[0][0]);
    for (int v = 0; v < 12; v++)
        if (!isfinite(positions[v][0] + positions[v][1] + positions[v][2]))
            abort();
    pel_session_destroy(session);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
    free(text);
    return 0;
}
