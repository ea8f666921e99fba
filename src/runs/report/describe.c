/* Description of a run in a report, apart from its frames, as JSON: see web/src/data.js. */
#include "pellicle/observe.h"
#include "report/read.h"

#include "base/memory.h"
#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { NOTE_SIZE = 256 };

/* one sentence about omitted data, for the report and the log */
PEL_PRINTF(3, 4)
static void put_note(pel_report_run *run, const pel_log *log, const char *format, ...)
{
    char text[NOTE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    pel_json *json = &run->json;
    if (json->length > 0 && json->text[json->length - 1] != '[')
        pel_json_print(json, ",");
    pel_json_put_text(json, text);
    pel_log_line(log, "%s: %s", run->folder, text);
}

static void put_plan_notes(pel_report_run *run, const pel_log *log)
{
    const pel_report_plan *plan = &run->plan;
    bool vectors = false;
    for (int32_t f = 0; f < run->field_count; f++)
        vectors = vectors || run->fields[f].component_count > 1;
    if (!plan->components && vectors)
        put_note(run, log, "vectors are kept as magnitudes only");
    if (plan->bits < 16 && run->field_count > 0)
        put_note(run, log, "fields are rounded to 1/255 of their range");
    if (plan->stride > 1)
        put_note(run, log, "%d of %d frames are kept", (int)run->frames_kept, (int)run->frames->frame_count);
}

/* ---- texts of the folder ---- */

/* keeps every stride-th row of a table, its header and its last row; returns the new size */
static size_t thin_rows(char *text, size_t size, size_t stride)
{
    size_t kept = 0, row = 0;
    for (size_t at = 0; at < size; row++) {
        const char *end = memchr(text + at, '\n', size - at);
        size_t next = end != NULL ? (size_t)(end - text) + 1 : size;
        if (row == 0 || (row - 1) % stride == 0 || next == size) {
            memmove(text + kept, text + at, next - at);
            kept += next - at;
        }
        at = next;
    }
    text[kept] = '\0';
    return kept;
}

/* Reads a text file of the folder; null, without failure, when it is not there. */
static pel_status read_text(const pel_report_run *run, const char *name, char **text, size_t *size, pel_error *error)
{
    size_t room = strlen(run->folder) + strlen(name) + 2;
    char *path = pel_allocate(room, 1);
    *text = NULL;
    *size = 0;
    if (path == NULL)
        return pel_fail_memory(error);
    snprintf(path, room, "%s/%s", run->folder, name);
    pel_status status = pel_file_check_inside(run->folder, path, error);
    if (status == PEL_OK)
        status = pel_file_read(path, text, size, error);
    pel_free(path);
    return status == PEL_BAD_FILE ? PEL_OK : status;
}

/* the member `key` with the text of a file; a long one loses rows or is truncated */
static pel_status put_text(pel_report_run *run, const char *key, pel_run_file file, bool table, pel_error *error)
{
    char *text;
    size_t size;
    pel_status status = read_text(run, pel_run_file_name(file), &text, &size, error);
    if (status != PEL_OK)
        return status;
    if (size > PEL_REPORT_TEXT_LIMIT && table)
        thin_rows(text, size, size / PEL_REPORT_TEXT_LIMIT + 1);
    else if (size > PEL_REPORT_TEXT_LIMIT)
        text[PEL_REPORT_TEXT_LIMIT] = '\0';
    pel_json_print(&run->json, ",\n\"%s\":", key);
    pel_json_put_text(&run->json, text != NULL ? text : "");
    pel_json_print(&run->json, ",\n\"%s_thinned\":%s", key, size > PEL_REPORT_TEXT_LIMIT ? "true" : "false");
    pel_free(text);
    return PEL_OK;
}

/* ---- frames and fields ---- */

static void put_frames(pel_report_run *run)
{
    pel_json *json = &run->json;
    const char *separator = "";
    pel_json_print(json, ",\n\"frame_total\":%d,\"topologies\":[", (int)run->frames->frame_count);
    for (int32_t i = 0; i < run->topology_count; i++)
        pel_json_print(json, "%s[%d,%d]", i > 0 ? "," : "", (int)run->topologies[i].vertex_count,
                       (int)run->topologies[i].triangle_count);
    pel_json_print(json, "],\n\"frames\":[");
    for (int32_t f = 0; f < run->frames->frame_count; f++) {
        if (!pel_report_run_keeps(run, f))
            continue;
        pel_json_print(json, "%s[%d,", separator, (int)f);
        pel_json_put_number(json, run->frames->times[f]);
        pel_json_print(json, ",%d]", (int)run->frame_topology[f]);
        separator = ",";
    }
    pel_json_print(json, "],\n\"low\":");
    pel_json_put_numbers(json, run->low, 3);
    pel_json_print(json, ",\"high\":");
    pel_json_put_numbers(json, run->high, 3);
}

static void put_fields(pel_report_run *run)
{
    pel_json *json = &run->json;
    pel_json_print(json, ",\n\"fields\":[");
    for (int32_t f = 0; f < run->field_count; f++) {
        const pel_report_field *field = &run->fields[f];
        bool components = run->plan.components && field->component_count <= 3 && field->component_count > 1;
        const double range[2] = {components ? field->low : field->magnitude_low,
                                 components ? field->high : field->magnitude_high};
        const double magnitudes[2] = {field->magnitude_low, field->magnitude_high};
        pel_json_print(json, "%s\n{\"name\":", f > 0 ? "," : "");
        pel_json_put_text(json, field->name);
        int32_t known = pel_field_find(field->name);
        if (known >= 0)
            pel_json_print(json, ",\"unit\":\"%s\"", pel_field_at(known)->unit);
        pel_json_print(json, ",\"components\":%d,\"channels\":%d,\"bits\":%d,\"range\":", (int)field->component_count,
                       components ? (int)field->component_count : 1, (int)run->plan.bits);
        pel_json_put_numbers(json, range, 2);
        pel_json_print(json, ",\"magnitudes\":");
        pel_json_put_numbers(json, magnitudes, 2);
        pel_json_print(json, "}");
    }
    pel_json_print(json, "]");
}

/* the last part of a path; slashes at its end do not count */
static void put_name(pel_json *json, const char *path)
{
    char name[NOTE_SIZE];
    size_t end = strlen(path);
    while (end > 1 && path[end - 1] == '/')
        end--;
    size_t start = end;
    while (start > 0 && path[start - 1] != '/')
        start--;
    snprintf(name, sizeof name, "%.*s", (int)(end - start < sizeof name ? end - start : sizeof name - 1), path + start);
    pel_json_put_text(json, name);
}

pel_status pel_report_run_describe(pel_report_run *run, const pel_log *log, pel_error *error)
{
    pel_json *json = &run->json;
    pel_json_free(json);
    pel_json_print(json, "{\"program\":\"pellicle " PEL_VERSION "\",\"name\":");
    put_name(json, run->folder);
    put_frames(run);
    put_fields(run);
    pel_json_print(json, ",\n\"notes\":[");
    put_plan_notes(run, log);
    pel_json_print(json, "]");
    pel_status status = pel_report_run_put_tools(run, error);
    if (status == PEL_OK)
        status = put_text(run, "series", PEL_RUN_SERIES, true, error);
    if (status == PEL_OK)
        status = put_text(run, "summary", PEL_RUN_SUMMARY, false, error);
    if (status == PEL_OK)
        status = put_text(run, "scene", PEL_RUN_SCENE, false, error);
    pel_json_print(json, "}");
    if (status == PEL_OK && json->failed)
        status = pel_fail_memory(error);
    return status;
}
