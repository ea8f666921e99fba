#include "keys/schema_api.h"

#include "pellicle/scene.h"

typedef void put_document(FILE *file, const pel_scene_table *table);

static pel_status finish_document(FILE *file, pel_error *error)
{
    if (fflush(file) == 0 && !ferror(file))
        return PEL_OK;
    return pel_refuse(error, PEL_BAD_FILE, "look for a full disk or a closed pipe", "cannot write the text");
}

static pel_status write_document(FILE *file, put_document *put, pel_error *error)
{
    pel_arena arena = {0};
    const pel_scene_table *table = pel_scene_table_create(&arena);
    pel_status status = table != NULL ? PEL_OK : pel_fail_memory(error);
    if (table != NULL) {
        put(file, table);
        status = finish_document(file, error);
    }
    pel_arena_free(&arena);
    return status;
}

pel_status pel_scene_write_schema(FILE *file, pel_error *error)
{
    PEL_REFUSE_NULL(file, error);
    pel_arena arena = {0};
    pel_json json = {0};
    const pel_scene_table *table = pel_scene_table_create(&arena);
    if (table != NULL)
        pel_scene_put_schema(&json, table);
    pel_status status = table == NULL || json.failed ? pel_fail_memory(error) : PEL_OK;
    if (status == PEL_OK) {
        fputs(json.text, file);
        status = finish_document(file, error);
    }
    pel_json_free(&json);
    pel_arena_free(&arena);
    return status;
}

pel_status pel_scene_write_reference(FILE *file, pel_error *error)
{
    PEL_REFUSE_NULL(file, error);
    return write_document(file, pel_scene_put_reference, error);
}

pel_status pel_scene_write_parameters(FILE *file, pel_error *error)
{
    PEL_REFUSE_NULL(file, error);
    return write_document(file, pel_scene_put_parameters, error);
}
