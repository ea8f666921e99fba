/* The folder of a study. Each chunk has a file of its own in rows/: a first line that names the study, then a line for
   each run, with a hash in front, so that a line that was cut off by a kill or a full disk is not taken for a row. */
#define _DEFAULT_SOURCE /* flock */
#include "base/assert.h"
#include "study/study.h"

#include "base/hash.h"
#include "base/memory.h"
#include "base/room.h"
#include "io/file.h"
#include "io/json.h"
#include "pellicle/run.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const char rows_ending[] = ".rows";
enum { HASH_DIGITS = 16 };

typedef enum row_state { ROW_MISSING, ROW_FAILED, ROW_DONE } row_state;

struct pel_study_store {
    const pel_study *study;
    char *folder;
    int32_t chunk, chunk_count;
    int descriptor;     /* of the chunk's rows */
    char *path;         /* of these */
    pel_json lines;     /* that were gathered, and are not written yet */
    row_state *present; /* (run_count) rows that were there when the folder was opened */
    char **rows;        /* (run_count) while rows are collected; null = missing */
    char zeros[PEL_STUDY_ZEROS_SIZE], warnings[PEL_STUDY_WARNINGS_SIZE];
};

static pel_status fail_file(const char *path, const char *what, int number, pel_error *error)
{
    pel_fail(error, PEL_BAD_FILE, "%s: %s", what, strerror(number));
    pel_fail_remedy(error, "%s", pel_file_write_remedy(number));
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_FILE;
}

/* ---- folders ---- */

static bool make_folder(const char *path)
{
    struct stat information;
    return mkdir(path, 0777) == 0 || (errno == EEXIST && stat(path, &information) == 0 && S_ISDIR(information.st_mode));
}

static bool has_file(const char *folder, const char *name)
{
    char path[PEL_STUDY_PATH_SIZE];
    struct stat information;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return stat(path, &information) == 0;
}

/* A table or a page without rows is of somebody else, and would be written over. */
static pel_status refuse_foreign(const char *folder, pel_error *error)
{
    static const char *const names[] = {"runs.csv", "report.html", "job.sh"};
    for (size_t i = 0; i < sizeof names / sizeof *names && !has_file(folder, "rows"); i++) {
        if (!has_file(folder, names[i]))
            continue;
        pel_fail(error, PEL_BAD_FILE, "the folder has a file %s, and no rows of a study", names[i]);
        pel_fail_remedy(error, "choose a new or empty folder with -o; nothing was changed");
        pel_fail_place(error, folder, 0, 0);
        return PEL_BAD_FILE;
    }
    return PEL_OK;
}

/* with its parents */
static pel_status make_folders(const char *folder, pel_error *error)
{
    char path[PEL_STUDY_PATH_SIZE];
    snprintf(path, sizeof path, "%s/rows/", folder);
    for (char *slash = path + 1; *slash != '\0'; slash++) {
        if (*slash != '/' || slash[-1] == '/')
            continue;
        *slash = '\0';
        if (!make_folder(path) || !pel_file_sync_folder(path))
            return fail_file(path, "cannot make the folder", errno, error);
        *slash = '/';
    }
    return PEL_OK;
}

/* ---- lines ---- */

static void put_hash(char text[HASH_DIGITS + 2], const char *row, size_t length)
{
    uint64_t hash = pel_hash_block(PEL_HASH_START, row, length);
    for (int i = 0; i < HASH_DIGITS; i++)
        text[i] = "0123456789abcdef"[(hash >> (4 * (HASH_DIGITS - 1 - i))) & 15];
    text[HASH_DIGITS] = ' ';
    text[HASH_DIGITS + 1] = '\0';
}

/* the row of a line without its newline, null when the line is none */
static const char *line_row(const char *line, size_t length)
{
    char hash[HASH_DIGITS + 2];
    if (length <= HASH_DIGITS + 1)
        return NULL;
    put_hash(hash, line + HASH_DIGITS + 1, length - HASH_DIGITS - 1);
    return memcmp(line, hash, HASH_DIGITS + 1) == 0 ? line + HASH_DIGITS + 1 : NULL;
}

static int64_t row_run(const pel_study *study, const char *row)
{
    char *end;
    long long run = strtoll(row, &end, 10);
    return end > row && *end == ',' && run >= 0 && run < study->run_count ? run : -1;
}

static void put_title(const pel_study *study, char *title, size_t size)
{
    snprintf(title, size, "pellicle study %016" PRIx64 "\n", study->fingerprint);
}

static pel_status fail_other_study(const char *folder, pel_error *error)
{
    pel_fail(error, PEL_BAD_FILE,
             "the folder holds rows of another study, or of this one before it, its scene or the program changed");
    pel_fail_remedy(error,
                    "choose another folder, or remove rows/, runs.csv and report.html of it to do all runs again");
    pel_fail_place(error, folder, 0, 0);
    return PEL_BAD_FILE;
}

static bool is_done(const char *row, size_t length)
{
    static const char ending[] = ",done,";
    return length >= sizeof ending - 1 && memcmp(row + length - (sizeof ending - 1), ending, sizeof ending - 1) == 0;
}

bool pel_study_row_is_done(const char *row)
{
    return is_done(row, strlen(row));
}

/* what a row is given to */
typedef pel_status row_visitor(pel_study_store *store, int64_t run, const char *row, size_t length);

static pel_status note_present(pel_study_store *store, int64_t run, const char *row, size_t length)
{
    PEL_ASSERT_INDEX(run, store->study->run_count);
    if (store->present[run] != ROW_DONE)
        store->present[run] = is_done(row, length) ? ROW_DONE : ROW_FAILED;
    return PEL_OK;
}

/* of a run that was done again, the row that is done, else the later one */
static pel_status keep_row(pel_study_store *store, int64_t run, const char *row, size_t length)
{
    PEL_ASSERT_INDEX(run, store->study->run_count);
    if (store->rows[run] != NULL && pel_study_row_is_done(store->rows[run]))
        return PEL_OK;
    char *copy = pel_allocate(length + 1, 1);
    if (copy == NULL)
        return PEL_OUT_OF_MEMORY;
    memcpy(copy, row, length);
    pel_free(store->rows[run]);
    store->rows[run] = copy;
    return PEL_OK;
}

/* the whole rows of a file; one of another study is refused, an empty one is that of a chunk that begins */
static pel_status visit_file(pel_study_store *store, const char *path, row_visitor *visit, pel_error *error)
{
    char title[64], *bytes;
    size_t size;
    pel_status status = pel_file_read(path, &bytes, &size, error);
    if (status != PEL_OK)
        return status;
    put_title(store->study, title, sizeof title);
    size_t title_length = strlen(title), common = size < title_length ? size : title_length;
    if (memcmp(bytes, title, common) != 0)
        status = fail_other_study(store->folder, error);
    const char *at = bytes + common, *end = bytes + size;
    while (status == PEL_OK && at < end) {
        const char *line_end = memchr(at, '\n', (size_t)(end - at));
        if (line_end == NULL)
            break;
        const char *row = line_row(at, (size_t)(line_end - at));
        int64_t run = row != NULL ? row_run(store->study, row) : -1;
        if (run >= 0 && visit(store, run, row, (size_t)(line_end - row)) != PEL_OK)
            status = pel_fail_memory(error);
        at = line_end + 1;
    }
    pel_free(bytes);
    return status;
}

static pel_status visit_rows(pel_study_store *store, row_visitor *visit, pel_error *error)
{
    char folder[PEL_STUDY_PATH_SIZE], path[PEL_STUDY_PATH_SIZE + 300];
    snprintf(folder, sizeof folder, "%s/rows", store->folder);
    DIR *list = opendir(folder);
    if (list == NULL)
        return fail_file(folder, "cannot read the folder", errno, error);
    pel_status status = PEL_OK;
    for (const struct dirent *entry = readdir(list); entry != NULL && status == PEL_OK; entry = readdir(list)) {
        size_t length = strlen(entry->d_name), ending = sizeof rows_ending - 1;
        if (length <= ending || strcmp(entry->d_name + length - ending, rows_ending) != 0)
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        status = visit_file(store, path, visit, error);
    }
    closedir(list);
    return status;
}

/* ---- the chunk's own file ---- */

static pel_status fail_busy(const pel_study_store *store, pel_error *error)
{
    pel_fail(error, PEL_BAD_FILE, "another program is doing chunk %d of %d of this study in this folder",
             (int)store->chunk, (int)store->chunk_count);
    pel_fail_remedy(error, "wait until it has ended, or choose another folder");
    pel_fail_place(error, store->folder, 0, 0);
    return PEL_BAD_FILE;
}

/* the end of the last whole line */
static pel_status cut_last_line(const pel_study_store *store, pel_error *error)
{
    char *bytes;
    size_t size;
    pel_status status = pel_file_read(store->path, &bytes, &size, error);
    if (status != PEL_OK)
        return status;
    size_t whole = size;
    while (whole > 0 && bytes[whole - 1] != '\n')
        whole--;
    pel_free(bytes);
    if (whole < size && ftruncate(store->descriptor, (off_t)whole) != 0)
        return fail_file(store->path, "cannot write the file", errno, error);
    return PEL_OK;
}

/* One write: rows of several threads do not mix. */
static pel_status append(const pel_study_store *store, const char *text, size_t length, pel_error *error)
{
    ssize_t written = write(store->descriptor, text, length);
    if (written == (ssize_t)length)
        return pel_file_sync(store->descriptor) ? PEL_OK
                                                : fail_file(store->path, "cannot write the file", errno, error);
    return fail_file(store->path, "cannot write the file", written < 0 ? errno : ENOSPC, error);
}

static pel_status open_rows(pel_study_store *store, pel_error *error)
{
    char title[64];
    store->descriptor = open(store->path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (store->descriptor < 0)
        return fail_file(store->path, "cannot write the file", errno, error);
    /* where the file system has no locks, nothing keeps two programs apart; their rows are the same */
    if (flock(store->descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        return fail_busy(store, error);
    pel_status status = cut_last_line(store, error);
    if (status != PEL_OK || lseek(store->descriptor, 0, SEEK_END) > 0)
        return status;
    put_title(store->study, title, sizeof title);
    status = append(store, title, strlen(title), error);
    return status == PEL_OK && !pel_file_sync_folder(store->path)
               ? fail_file(store->path, "cannot write the file", errno, error)
               : status;
}

/* ---- public ---- */

static pel_status open_store(pel_study_store *store, const char *folder, pel_error *error)
{
    size_t size = strlen(folder) + 64;
    store->folder = pel_copy_string(folder);
    store->path = pel_allocate(size, 1);
    store->present = pel_allocate((size_t)store->study->run_count, sizeof *store->present);
    store->rows = pel_allocate((size_t)store->study->run_count, sizeof *store->rows);
    if (store->folder == NULL || store->path == NULL || store->present == NULL || store->rows == NULL)
        return pel_fail_memory(error);
    snprintf(store->path, size, "%s/rows/%d-of-%d%s", folder, (int)store->chunk, (int)store->chunk_count, rows_ending);
    pel_status status = refuse_foreign(folder, error);
    if (status == PEL_OK)
        status = make_folders(folder, error);
    /* rows of another study are refused before anything is written beside them */
    if (status == PEL_OK)
        status = visit_rows(store, note_present, error);
    return status == PEL_OK ? open_rows(store, error) : status;
}

pel_status pel_study_store_open(const pel_study *study, const char *folder, int32_t chunk, int32_t chunk_count,
                                pel_study_store **store, pel_error *error)
{
    PEL_REFUSE_NULL(store, error);
    *store = NULL;
    PEL_REFUSE_NULL(study, error);
    PEL_REFUSE_NULL(folder, error);
    if (folder[0] == '\0' || strlen(folder) + 200 > PEL_STUDY_PATH_SIZE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the name of the folder is empty or too long");
    if (chunk_count < 1 || chunk < 1 || chunk > chunk_count)
        return pel_fail(error, PEL_BAD_ARGUMENT, "there is no chunk %d of %d", (int)chunk, (int)chunk_count);
    pel_study_store *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    *made = (pel_study_store){.study = study, .chunk = chunk, .chunk_count = chunk_count, .descriptor = -1};
    pel_status status = open_store(made, folder, error);
    if (status == PEL_OK)
        *store = made;
    else
        pel_study_store_close(made);
    return status;
}

static void drop_rows(pel_study_store *store)
{
    for (int64_t run = 0; store->rows != NULL && run < store->study->run_count; run++) {
        pel_free(store->rows[run]);
        store->rows[run] = NULL;
    }
}

void pel_study_store_close(pel_study_store *store)
{
    if (store == NULL)
        return;
    if (store->descriptor >= 0)
        close(store->descriptor);
    drop_rows(store);
    pel_json_free(&store->lines);
    PEL_FREE_ALL(store->rows, store->present, store->path, store->folder, store);
}

bool pel_study_store_needs(const pel_study_store *store, int64_t run)
{
    return store != NULL && run >= 0 && run < store->study->run_count && run % store->chunk_count == store->chunk - 1 &&
           store->present[run] == ROW_MISSING;
}

bool pel_study_store_failed(const pel_study_store *store, int64_t run)
{
    return store != NULL && run >= 0 && run < store->study->run_count && run % store->chunk_count == store->chunk - 1 &&
           store->present[run] == ROW_FAILED;
}

pel_status pel_study_store_gather(pel_study_store *store, const char *row, pel_error *error)
{
    char hash[HASH_DIGITS + 2];
    if (row_run(store->study, row) < 0 || strchr(row, '\n') != NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the text is not a row of this study");
    put_hash(hash, row, strlen(row));
    pel_json_print(&store->lines, "%s%s\n", hash, row);
    return store->lines.failed ? pel_fail_memory(error) : PEL_OK;
}

pel_status pel_study_store_flush(pel_study_store *store, pel_error *error)
{
    size_t length = store->lines.length;
    store->lines.length = 0;
    return length > 0 ? append(store, store->lines.text, length, error) : PEL_OK;
}

pel_status pel_study_store_add(pel_study_store *store, const char *row, pel_error *error)
{
    PEL_REFUSE_NULL(store, error);
    PEL_REFUSE_NULL(row, error);
    pel_status status = pel_study_store_gather(store, row, error);
    return status == PEL_OK ? pel_study_store_flush(store, error) : status;
}

static pel_status write_table(const pel_study_store *store, pel_error *error)
{
    char path[PEL_STUDY_PATH_SIZE];
    pel_file_writer writer;
    snprintf(path, sizeof path, "%s/runs.csv", store->folder);
    pel_status status = pel_file_writer_open(&writer, path, error);
    if (status != PEL_OK)
        return status;
    pel_file_writer_printf(&writer, "%s\n", store->study->header);
    for (int64_t run = 0; run < store->study->run_count; run++)
        pel_file_writer_printf(&writer, "%s\n", store->rows[run]);
    status = pel_file_writer_commit(&writer, error);
    if (status != PEL_OK)
        return status;
    snprintf(path, sizeof path, "%s/report.html", store->folder);
    return pel_study_write_page(store->study, path, (const char *const *)store->rows, error);
}

/* measures that are looked at */
enum { ZEROS_MOST = 64 };

/* Names of the measures that the study asks for and that are 0 in every row that is done. */
static void note_zeros(pel_study_store *store)
{
    const pel_study *study = store->study;
    int64_t done = 0;
    bool is_zero[ZEROS_MOST];
    for (int32_t m = 0; m < ZEROS_MOST && m < study->measure_count; m++)
        is_zero[m] = pel_study_measure_expects(&study->measures[m]);
    for (int64_t run = 0; run < study->run_count; run++) {
        const char *row = store->rows[run], *end;
        if (row == NULL || !pel_study_row_is_done(row))
            continue;
        done++;
        /* ",done," ends the row, and measures have no commas */
        end = row + strlen(row) - strlen(",done,");
        for (int32_t m = study->measure_count - 1; m >= 0; m--) {
            const char *cell = end;
            while (cell[-1] != ',')
                cell--;
            if (m < ZEROS_MOST && !(end - cell == 1 && *cell == '0'))
                is_zero[m] = false;
            end = cell - 1;
        }
    }
    size_t length = 0;
    for (int32_t m = 0; m < study->measure_count && m < ZEROS_MOST && done > 1; m++) {
        const char *name = study->measures[m].name;
        if (!is_zero[m] || length + strlen(name) + 3 > sizeof store->zeros)
            continue;
        length +=
            (size_t)snprintf(store->zeros + length, sizeof store->zeros - length, "%s%s", length > 0 ? ", " : "", name);
    }
}

/* the number of runs that have each code */
typedef struct code_counts {
    char codes[PEL_RUN_WARNING_LIMIT][32];
    int64_t runs[PEL_RUN_WARNING_LIMIT];
    int32_t count;
} code_counts;

/* the codes in a cell, with spaces */
static void count_codes(code_counts *counts, const char *cell, const char *end)
{
    for (const char *next; cell < end; cell = next + 1) {
        size_t length = strcspn(cell, " ,");
        int32_t i = 0;
        next = cell + length;
        while (i < counts->count && (strncmp(counts->codes[i], cell, length) != 0 || counts->codes[i][length] != '\0'))
            i++;
        if (length == 0 || length >= sizeof counts->codes[0] || i == PEL_RUN_WARNING_LIMIT)
            continue;
        if (i == counts->count)
            memcpy(counts->codes[counts->count++], cell, length);
        counts->runs[i]++;
    }
}

/* sums up the warnings of the rows that are done, in the order in which they first come */
static void note_warnings(pel_study_store *store)
{
    const pel_study *study = store->study;
    code_counts counts = {.count = 0};
    for (int64_t run = 0; run < study->run_count; run++) {
        const char *row = store->rows[run];
        if (row == NULL || !pel_study_row_is_done(row))
            continue;
        const char *end = row + strlen(row) - strlen(",done,");
        for (int32_t m = study->measure_count - 1; m >= 0; m--) {
            const char *cell = end;
            while (cell[-1] != ',')
                cell--;
            if (pel_study_measure_is_codes(&study->measures[m]))
                count_codes(&counts, cell, end);
            end = cell - 1;
        }
    }
    size_t length = 0, room = sizeof store->warnings;
    for (int32_t i = 0; i < counts.count && length < room; i++)
        length += (size_t)snprintf(store->warnings + length, room - length, "%s%s in %" PRId64 " run%s",
                                   i > 0 ? ", " : "", counts.codes[i], counts.runs[i], counts.runs[i] > 1 ? "s" : "");
}

const char *pel_study_store_warnings(const pel_study_store *store)
{
    return store->warnings;
}

const char *pel_study_store_zeros(const pel_study_store *store)
{
    return store->zeros;
}

pel_status pel_study_store_collect(pel_study_store *store, int64_t *missing, int64_t *failed, pel_error *error)
{
    PEL_REFUSE_NULL(store, error);
    int64_t lacking = 0, bad = 0;
    pel_status status = visit_rows(store, keep_row, error);
    for (int64_t run = 0; run < store->study->run_count && status == PEL_OK; run++) {
        lacking += store->rows[run] == NULL;
        bad += store->rows[run] != NULL && !pel_study_row_is_done(store->rows[run]);
    }
    if (status == PEL_OK && lacking == 0)
        status = write_table(store, error);
    if (status == PEL_OK && lacking == 0)
        note_zeros(store);
    if (status == PEL_OK && lacking == 0)
        note_warnings(store);
    drop_rows(store);
    if (missing != NULL)
        *missing = lacking;
    if (failed != NULL)
        *failed = bad;
    return status;
}
