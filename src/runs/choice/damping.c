/* A Kelvin-Voigt material with the retardation T has the loss factor T w at the angular frequency w, which is twice the
   ratio to critical damping of a vibration that strains it. */
#include "choice/damping.h"

#include "base/status.h"
#include "choice/time_step.h"
#include "keys/validate.h"

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* parts of a body that have loss factors, with the member that they become */
static const struct {
    const char *key;
    size_t offset;
} parts[] = {{"membrane.damping.loss_factor", offsetof(pel_body_def, shell.membrane.retardation)},
             {"bending.damping.loss_factor", offsetof(pel_body_def, shell.bending.retardation)},
             {"springs.viscosity.loss_factor", offsetof(pel_body_def, spring_retardation)}};
enum { PART_COUNT = sizeof parts / sizeof *parts };
/* share of a vibration's stiffness that is strain, below which the run says so */
#define DILUTED 0.5
#define TWO_PI 6.283185307179586

static double *retardation_of(pel_body_def *body, int part)
{
    return (double *)(void *)((char *)body + parts[part].offset);
}

static pel_status refuse(pel_scene_reader *reader, const pel_scene_value *value, const char *name)
{
    pel_scene_fail(reader, &value->place,
                   "loss_factor refers to the lowest frequency of body '%s', which could not be found", name);
    pel_fail_remedy(reader->error, "give `stiffness`, the loss factor over 2 pi times a frequency [Hz]");
    return PEL_BAD_SCENE;
}

/* A vibration that tension holds strains the material in second order only; one on springs to fixed points not at all.
 */
static void tell_dilution(pel_scene_reader *reader, const char *name, double factor, const pel_vibration *lowest)
{
    if (lowest->strain < DILUTED)
        pel_log_line(
            reader->log,
            "%.2g %% of the stiffness of this vibration of '%s' is strain of the damped material, the rest is "
            "tension or springs to fixed points: its ratio to critical damping is %.2g, not %.2g. solver.drag %.3g "
            "1/s would brake it by the loss factor",
            100 * lowest->strain, name, 0.5 * factor * lowest->strain, 0.5 * factor,
            factor * TWO_PI * lowest->frequency);
}

static pel_status take_body(pel_scene_reader *reader, const pel_scene_value *value, pel_scene *scene, int32_t b,
                            bool *any)
{
    /* the scene's own array, which it was built into */
    pel_body_def *body = (pel_body_def *)(uintptr_t)&scene->model.bodies[b];
    double most = 0;
    pel_vibration lowest = {0};
    const pel_scene_value *factors[PART_COUNT], *first = NULL;
    for (int i = PART_COUNT - 1; i >= 0; i--) {
        factors[i] = pel_scene_value_at(value, parts[i].key);
        if (factors[i] == NULL)
            continue;
        first = factors[i];
        *retardation_of(body, i) = first->number;
        most = first->number > most ? first->number : most;
    }
    if (first == NULL)
        return PEL_OK;
    *any = true;
    if (pel_scene_find_vibration(scene, b, &lowest) == PEL_OUT_OF_MEMORY)
        return pel_fail_memory(reader->error);
    if (!(lowest.frequency > 0))
        return refuse(reader, first, body->name);
    for (int i = 0; i < PART_COUNT; i++) {
        if (factors[i] == NULL)
            continue;
        *retardation_of(body, i) /= TWO_PI * lowest.frequency;
        pel_log_line(reader->log,
                     "loss factor %.3g of the %.*s of '%s' at its lowest frequency, %.4g Hz: damping.stiffness %.4g s",
                     factors[i]->number, (int)strcspn(parts[i].key, "."), parts[i].key, body->name, lowest.frequency,
                     *retardation_of(body, i));
    }
    tell_dilution(reader, body->name, most, &lowest);
    return PEL_OK;
}

pel_status pel_scene_take_loss_factors(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene,
                                       bool *any)
{
    const pel_scene_value *list = pel_scene_value_entry(root, "bodies");
    pel_status status = PEL_OK;
    int32_t b = 0;
    *any = false;
    for (const pel_scene_value *value = list->first; status == PEL_OK && value != NULL; value = value->next)
        status = take_body(reader, value, scene, b++, any);
    return status;
}
