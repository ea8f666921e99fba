#include "pellicle/report.h"

#include "base/memory.h"
#include "base/status.h"
#include "report/read.h"

#include <string.h>

enum { REPORT_COOKIE = 0x7265706f };

/* mark of the runs in the page; the number is the format version of web/src/data.js */
static const char mark[] = "<!--pellicle runs, format 1-->";
static const char mark_start[] = "<!--pellicle runs";
/* text before, between and after the two parts of a run */
static const char run_start[] = "\n<script type=\"application/json\" class=\"run\">";
static const char frames_start[] = "</script>\n<script type=\"text/plain\" class=\"run-frames\">";
static const char run_end[] = "</script>\n";
/* room for the notes on reductions, which are not known before */
enum { NOTES_ROOM = 256 };
enum { RUN_TAGS = sizeof run_start + sizeof frames_start + sizeof run_end - 3 };

pel_report_def pel_report_def_default(void)
{
    return (pel_report_def){.size_limit = 25000000, .cookie = REPORT_COOKIE};
}

static pel_status check_def(const pel_report_def *def, pel_error *error)
{
    if (def->cookie != REPORT_COOKIE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the report def was not made by pel_report_def_default");
    if (def->page == NULL || def->folder_count < 1 || def->field_count < 0 || def->size_limit < 1)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the page, a folder or the size limit is missing");
    PEL_REFUSE_NULL(def->folders, error);
    if (def->field_count > 0)
        PEL_REFUSE_NULL(def->fields, error);
    for (int32_t i = 0; i < def->folder_count; i++)
        PEL_REFUSE_NULL(def->folders[i], error);
    for (int32_t i = 0; i < def->field_count; i++)
        PEL_REFUSE_NULL(def->fields[i], error);
    return PEL_OK;
}

/* reads the page and finds the place of the runs */
static pel_status read_page(const char *path, char **page, size_t *size, const char **place, pel_error *error)
{
    pel_status status = pel_file_read(path, page, size, error);
    if (status == PEL_BAD_FILE)
        pel_fail_remedy(error, "build the page once with 'make web', which needs Node.js, and install it");
    if (status != PEL_OK)
        return status;
    *place = strstr(*page, mark);
    if (*place != NULL)
        return PEL_OK;
    pel_fail(error, PEL_BAD_FORMAT, "%s",
             strstr(*page, mark_start) != NULL ? "the page is of another version of pellicle"
                                               : "this is not a report page");
    pel_fail_remedy(error, "build the page again with 'make web'");
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_FORMAT;
}

/* packed size per run, so that base64 and the texts stay within the limit */
static size_t pack_limit(const pel_report_def *def, size_t page_size, pel_report_run *runs, pel_error *error)
{
    double left = (double)def->size_limit - (double)page_size;
    for (int32_t i = 0; i < def->folder_count; i++) {
        runs[i].plan = (pel_report_plan){.stride = 1};
        if (pel_report_run_describe(&runs[i], NULL, error) != PEL_OK)
            return 0;
        left -= (double)runs[i].json.length + RUN_TAGS + NOTES_ROOM;
    }
    left = left * 3 / 4 / def->folder_count;
    if (left >= 1)
        return (size_t)left;
    pel_fail(error, PEL_BAD_ARGUMENT, "the page and the texts of the runs alone exceed the limit of the report");
    pel_fail_remedy(error, "raise the limit (--limit)");
    return 0;
}

static pel_status read_runs(const pel_report_def *def, size_t page_size, pel_report_run *runs, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < def->folder_count; i++) {
        runs[i].folder = def->folders[i];
        status = pel_report_run_survey(&runs[i], def, error);
    }
    if (status != PEL_OK)
        return status;
    pel_error local;
    size_t limit = pack_limit(def, page_size, runs, error != NULL ? error : &local);
    if (limit == 0)
        return error != NULL ? error->status : local.status;
    for (int32_t i = 0; status == PEL_OK && i < def->folder_count; i++) {
        status = pel_report_run_pack(&runs[i], limit, error);
        if (status == PEL_OK)
            status = pel_report_run_describe(&runs[i], def->log, error);
    }
    return status;
}

static pel_status write_file(const char *path, const char *page, size_t page_size, const char *place,
                             const pel_report_def *def, const pel_report_run *runs, pel_report_summary *summary,
                             pel_error *error)
{
    pel_file_writer writer;
    pel_status status = pel_file_writer_open(&writer, path, error);
    if (status != PEL_OK)
        return status;
    pel_report_summary sum = {.size = (int64_t)page_size};
    pel_file_writer_write(&writer, page, (size_t)(place - page));
    for (int32_t i = 0; i < def->folder_count; i++) {
        const pel_report_run *run = &runs[i];
        pel_file_writer_printf(&writer, "%s", run_start);
        pel_file_writer_write(&writer, run->json.text, run->json.length);
        pel_file_writer_printf(&writer, "%s", frames_start);
        pel_report_pack_write_base64(&run->pack, &writer);
        pel_file_writer_printf(&writer, "%s", run_end);
        sum.size += (int64_t)(run->json.length + (run->pack.size + 2) / 3 * 4 + RUN_TAGS);
        sum.frame_count += run->frames_kept;
        sum.frame_total += run->frames->frame_count;
    }
    pel_file_writer_write(&writer, place + strlen(mark), page_size - (size_t)(place - page) - strlen(mark));
    sum.size -= (int64_t)strlen(mark);
    status = pel_file_writer_commit(&writer, error);
    if (status == PEL_OK && summary != NULL)
        *summary = sum;
    return status;
}

pel_status pel_report_write(const char *path, const pel_report_def *def, pel_report_summary *summary, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(def, error);
    pel_status status = check_def(def, error);
    if (status != PEL_OK)
        return status;
    char *page = NULL;
    const char *place = NULL;
    size_t page_size = 0;
    pel_report_run *runs = pel_allocate((size_t)def->folder_count, sizeof *runs);
    if (runs == NULL)
        return pel_fail_memory(error);
    status = read_page(def->page, &page, &page_size, &place, error);
    if (status == PEL_OK)
        status = read_runs(def, page_size, runs, error);
    if (status == PEL_OK)
        status = write_file(path, page, page_size, place, def, runs, summary, error);
    for (int32_t i = 0; i < def->folder_count; i++)
        pel_report_run_free(&runs[i]);
    pel_free(runs);
    pel_free(page);
    return status;
}
