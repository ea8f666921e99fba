/* Fuzzes the scene reader. Input: the scene's text, then overrides, separated by zero bytes. Scenes that name files or
   have large numbers are checked but not built, so that no input asks for a huge mesh. */
#include "keys/override.h"
#include "keys/print.h"
#include "keys/validate.h"
#include "keys/yaml.h"
#include "pellicle/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_OVERRIDES = 8 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

typedef struct fuzz_input {
    const char *text;
    size_t size;
    const char *overrides[MOST_OVERRIDES];
    int32_t override_count;
} fuzz_input;

static bool is_small(const pel_scene_value *value)
{
    if (fabs(value->number) > 50 || (value->key != NULL && strcmp(value->key, "file") == 0))
        return false;
    for (const pel_scene_value *child = value->first; child != NULL; child = child->next)
        if (!is_small(child))
            return false;
    return true;
}

static bool is_buildable(const fuzz_input *input)
{
    pel_arena arena = {0};
    pel_error error = {0};
    pel_scene_reader reader = {.arena = &arena, .table = pel_scene_table_create(&arena), .error = &error};
    pel_scene_value *root = pel_scene_yaml_parse(&reader, "fuzz.yaml", input->text, input->size, true);
    bool good = root != NULL && root->kind == PEL_SCENE_MAP;
    for (int32_t i = 0; good && i < input->override_count; i++)
        good = pel_scene_override(&reader, root, input->overrides[i]) == PEL_OK;
    good = good && pel_scene_check(&reader, root) == PEL_OK;
    if (!good && root == NULL && error.what[0] == '\0')
        abort();
    good = good && pel_scene_print(&reader, root) != NULL && is_small(root);
    pel_arena_free(&arena);
    return good;
}

/* the resolved text of a scene that was read gives the same text again */
static void check_fixed_point(const pel_scene *scene)
{
    const char *text = pel_scene_text(scene);
    pel_scene *again;
    if (pel_scene_parse("fuzz.yaml", text, strlen(text), NULL, 0, NULL, &again, NULL) != PEL_OK)
        abort();
    if (strcmp(text, pel_scene_text(again)) != 0)
        abort();
    pel_scene_destroy(again);
}

static void run(const fuzz_input *input)
{
    pel_scene *scene;
    pel_error error = {0};
    if (!is_buildable(input))
        return;
    if (pel_scene_parse("fuzz.yaml", input->text, input->size, input->overrides, input->override_count, NULL, &scene,
                        &error) == PEL_OK)
        check_fixed_point(scene);
    else if (error.what[0] == '\0' || error.remedy[0] == '\0')
        abort();
    pel_scene_destroy(scene);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = calloc(size + 1, 1);
    if (text == NULL)
        return 0;
    if (size > 0)
        memcpy(text, data, size);
    fuzz_input input = {.text = text, .size = strlen(text)};
    for (size_t i = input.size; i < size && input.override_count < MOST_OVERRIDES; i += strlen(text + i) + 1)
        if (text[i] != '\0')
            input.overrides[input.override_count++] = text + i;
    run(&input);
    free(text);
    return 0;
}
