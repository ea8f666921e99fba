#include "live/keep.h"

#include "base/memory.h"
#include "base/status.h"
#include "io/file.h"
#include "session/record.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* at the start of the file, and at its end */
static const char title[] = "# pellicle live: %" PRId64 " steps\n";

void pel_keep_close(pel_keep *keep)
{
    if (keep->stream != NULL)
        fclose(keep->stream);
    keep->stream = NULL;
}

static pel_status fail_keep(const pel_keep *keep, const char *what, int number, pel_error *error)
{
    pel_fail(error, PEL_BAD_FILE, "cannot %s the file: %s", what, strerror(number));
    pel_fail_remedy(error, "%s", pel_file_write_remedy(number));
    pel_fail_place(error, keep->path, 0, 0);
    return PEL_BAD_FILE;
}

static pel_status write_whole(pel_keep *keep, const pel_session *session, const pel_session_events *record,
                              int64_t steps, pel_error *error)
{
    char *text = NULL;
    pel_file_writer writer;
    pel_status status = pel_session_scene(session, &text, error);
    if (status != PEL_OK)
        return status;
    status = pel_file_writer_open(&writer, keep->path, error);
    if (status == PEL_OK) {
        size_t length = strlen(text);
        pel_file_writer_printf(&writer, title, steps);
        pel_file_writer_write(&writer, text, length);
        pel_file_writer_printf(&writer, title, steps);
        keep->head = (size_t)snprintf(NULL, 0, title, steps) + length - record->length;
        status = pel_file_writer_commit(&writer, error);
    }
    pel_session_free_text(text);
    if (status == PEL_OK && (keep->stream = fopen(keep->path, "r+b")) == NULL)
        status = fail_keep(keep, "write", errno, error);
    return status;
}

/* What changed goes first: a file that lacks its last line is read without it. */
static bool write_new(pel_keep *keep, const pel_session_events *record, int64_t steps)
{
    size_t from = record->unchanged;
    if (fseek(keep->stream, (long)(keep->head + from), SEEK_SET) != 0)
        return false;
    if (from < keep->length && ftruncate(fileno(keep->stream), (off_t)(keep->head + from)) != 0)
        return false;
    return fwrite(record->text + from, 1, record->length - from, keep->stream) == record->length - from &&
           fprintf(keep->stream, title, steps) > 0 && fflush(keep->stream) == 0;
}

pel_status pel_keep_write(pel_keep *keep, pel_session *session, int64_t steps, pel_error *error)
{
    pel_session_events *record = pel_session_record_of(session);
    pel_status status = PEL_OK;
    /* nothing of a session that was begun anew is in the file */
    if (record->unchanged == 0)
        pel_keep_close(keep);
    if (record->length == 0)
        return unlink(keep->path) == 0 || errno == ENOENT ? PEL_OK : fail_keep(keep, "remove", errno, error);
    if (keep->stream == NULL)
        status = write_whole(keep, session, record, steps, error);
    else if (!write_new(keep, record, steps))
        status = fail_keep(keep, "write", errno, error);
    if (status != PEL_OK)
        pel_keep_close(keep);
    else
        record->unchanged = keep->length = record->length;
    return status;
}

/* of the last line that tells it, but at least that of the last command */
static int64_t find_steps(const pel_kept *kept, const char *text)
{
    int64_t steps = 0, last = 0;
    for (const char *at = text; (at = strstr(at, "# pellicle live: ")) != NULL; at++)
        sscanf(at, "# pellicle live: %" SCNd64 " steps", &steps);
    if (kept->command_count > 0)
        last = kept->commands[kept->command_count - 1].step;
    return steps > last ? steps : last;
}

static pel_status parse(const char *path, const char *scene_path, char *text, size_t size, pel_kept *kept,
                        pel_error *error)
{
    if (sscanf(text, "# pellicle live: %" SCNd64 " steps", &kept->steps) != 1 || kept->steps < 0) {
        pel_fail(error, PEL_BAD_FORMAT, "this is no kept state of pellicle live");
        pel_fail_remedy(error, "remove the file");
        pel_fail_place(error, path, 0, 0);
        return PEL_BAD_FORMAT;
    }
    while (size > 0 && text[size - 1] != '\n')
        size--;
    text[size] = '\0';
    pel_status status = pel_scene_parse(scene_path, text, size, NULL, 0, NULL, &kept->scene, error);
    if (status != PEL_OK)
        return status;
    kept->commands = kept->scene->session;
    kept->command_count = kept->scene->session_count;
    kept->scene->session_count = 0;
    kept->steps = find_steps(kept, text);
    return PEL_OK;
}

pel_status pel_keep_read(const char *path, const char *scene_path, pel_kept *kept, pel_error *error)
{
    char *text = NULL;
    size_t size = 0;
    *kept = (pel_kept){0};
    if (access(path, F_OK) != 0 && errno == ENOENT)
        return PEL_OK;
    pel_status status = pel_file_read(path, &text, &size, error);
    if (status == PEL_OK)
        status = parse(path, scene_path, text, size, kept, error);
    pel_free(text);
    if (status != PEL_OK)
        *kept = (pel_kept){0};
    return status;
}
