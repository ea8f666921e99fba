/* Supports of single components: `bodies[].supports`. */
#include "keys/table.h"
#include "math/vec3.h"
#include "scene/build.h"
#include "scene/region.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* the axis of a word (x, y, z) or along a vector; PEL_BAD_SCENE for none */
static pel_status read_direction(pel_scene_reader *reader, const pel_scene_value *value, double direction[3])
{
    if (value->form == PEL_FORM_WORD) {
        pel_vec3_set(direction, value->number<0.5, fabs(value->number - 1) < 0.5, value->number> 1.5);
        return PEL_OK;
    }
    pel_scene_value_numbers(value, direction);
    if (pel_vec3_normalize(direction) > 0)
        return PEL_OK;
    pel_scene_fail(reader, &value->place, "the direction has no length");
    pel_fail_remedy(reader->error, "give a vector that is not 0");
    return PEL_BAD_SCENE;
}

/* the unit vector that is least along x */
static void any_across(const double x[3], double y[3])
{
    int least = 0;
    for (int k = 1; k < 3; k++)
        least = fabs(x[k]) < fabs(x[least]) ? k : least;
    pel_vec3_set(y, least == 0, least == 1, least == 2);
}

/* x, y less its part along x, and their product */
static pel_status read_axes(pel_scene_reader *reader, const pel_scene_value *x, const pel_scene_value *y,
                            double axes[3][3])
{
    pel_status status = read_direction(reader, x, axes[0]);
    if (status == PEL_OK && y != NULL)
        status = read_direction(reader, y, axes[1]);
    if (status != PEL_OK)
        return status;
    if (y == NULL)
        any_across(axes[0], axes[1]);
    pel_vec3_along(axes[1], -pel_vec3_dot(axes[0], axes[1]), axes[0], axes[1]);
    if (pel_vec3_length(axes[1]) < 1e-6) {
        pel_scene_fail(reader, &y->place, "y is parallel to x");
        pel_fail_remedy(reader->error, "give another direction, or omit it");
        return PEL_BAD_SCENE;
    }
    pel_vec3_normalize(axes[1]);
    pel_vec3_cross(axes[0], axes[1], axes[2]);
    return PEL_OK;
}

static pel_status read_components(pel_scene_reader *reader, const pel_scene_value *value, pel_support_def *support)
{
    const pel_scene_value *symmetry = pel_scene_value_entry(value, "symmetry");
    const pel_scene_value *frame = pel_scene_value_entry(value, "frame");
    for (int k = 0; k < 3; k++)
        support->fix[k] = symmetry != NULL && k == 0;
    if (symmetry != NULL) {
        support->fix_rotation = true;
        return read_axes(reader, symmetry, NULL, support->axes);
    }
    for (const pel_scene_value *word = pel_scene_value_entry(value, "fix")->first; word != NULL; word = word->next)
        support->fix[(int)word->number] = true;
    if (frame == NULL)
        return PEL_OK;
    return read_axes(reader, pel_scene_value_entry(frame, "x"), pel_scene_value_entry(frame, "y"), support->axes);
}

/* refuse supports that hold nothing or ignore a key */
static pel_status check_support(pel_scene_reader *reader, const pel_scene_value *value, const pel_support_def *support)
{
    const char *what = NULL, *remedy = NULL;
    for (int k = 0; k < 3; k++)
        if (support->displacement[k] != 0 && !support->fix[k]) {
            what = "the support displaces a component that it does not hold";
            remedy = "add the component to `fix`, or set its displacement to 0";
        }
    if (!support->fix[0] && !support->fix[1] && !support->fix[2] && !support->fix_rotation) {
        what = "the support holds nothing";
        remedy = "list components in `fix`, or set `rotation: fixed`";
    }
    if (support->stiffness > 0 && support->foundation > 0) {
        what = "the support has a stiffness of its vertices and one of a foundation";
        remedy = "give `stiffness` [N/m] or `foundation` [N/m3], or two supports";
    }
    if (what == NULL)
        return PEL_OK;
    pel_scene_fail(reader, &value->place, "%s", what);
    pel_fail_remedy(reader->error, "%s", remedy);
    return PEL_BAD_SCENE;
}

static pel_status read_support(pel_scene_reader *reader, const pel_scene_value *value, const pel_body_def *body,
                               int32_t number, pel_support_def *support)
{
    const char *own = pel_scene_value_entry(value, "name")->text;
    size_t size = strlen(body->name) + strlen(own) + sizeof "_";
    char *name = pel_arena_take(reader->arena, size, 1);
    if (name == NULL)
        return pel_fail_memory(reader->error);
    snprintf(name, size, "%s_%s", body->name, own);
    *support = pel_support_def_default();
    const pel_scene_part source = {reader, value, body->mesh};
    pel_status status = pel_scene_read_members(&source, PEL_DEF_SUPPORT, support);
    support->name = name;
    support->body = number;
    if (status == PEL_OK)
        status = pel_scene_read_vertices(&source, pel_scene_value_entry(value, "at"), &support->vertices,
                                         &support->vertex_count);
    if (status == PEL_OK)
        status = read_components(reader, value, support);
    return status == PEL_OK ? check_support(reader, value, support) : status;
}

pel_status pel_scene_build_supports(pel_scene_reader *reader, const pel_scene_value *bodies, pel_scene *scene)
{
    size_t most = 0;
    for (const pel_scene_value *body = bodies->first; body != NULL; body = body->next)
        most += (size_t)pel_scene_value_count(pel_scene_value_entry(body, "supports"));
    pel_support_def *supports = pel_arena_take(reader->arena, most, sizeof *supports);
    if (supports == NULL)
        return pel_fail_memory(reader->error);
    int32_t count = 0, b = 0;
    for (const pel_scene_value *body = bodies->first; body != NULL; body = body->next, b++) {
        const pel_scene_value *list = pel_scene_value_entry(body, "supports");
        pel_status status = pel_scene_check_names(reader, list);
        for (const pel_scene_value *value = list->first; status == PEL_OK && value != NULL; value = value->next)
            status = read_support(reader, value, &scene->model.bodies[b], b, &supports[count++]);
        if (status != PEL_OK)
            return status;
    }
    scene->sim.supports = supports;
    scene->sim.support_count = count;
    return PEL_OK;
}
