/* The folder of a study. Each chunk has a file of its own in rows/: a first line that names the study, then a line for
   each run, with a hash in front, so that a line that was cut off by a kill or a full disk is not taken for a row.
   Files are read line by line, and of a row only its place is kept: a study may have more rows than memory. */
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

/* Where the row of a run is. A line never begins at byte 0, which the title has: there no row is meant. */
typedef struct row_place {
    uint64_t at : 40, file : 23, is_done : 1;
} row_place;
enum { MOST_FILES = 1 << 23 };
#define MOST_BYTES ((uint64_t)1 << 40)

/* a piece of the file that rows were read from last */
enum { PIECE = 1 << 16 };
typedef struct row_reader {
    int descriptor; /* -1 = none */
    uint64_t file, start;
    size_t length;
    char *piece; /* (PIECE + line_room) */
} row_reader;

struct pel_study_store {
    const pel_study *study;
    char *folder;
    int32_t chunk, chunk_count;
    int descriptor;    /* of the chunk's rows */
    char *path;        /* of these */
    pel_json lines;    /* that were gathered, and are not written yet */
    row_place *places; /* (run_count) of rows that were there when the folder was looked at last */
    pel_json names;    /* of the files that hold rows, each with its zero */
    uint64_t file_count;
    char *line; /* (line_room) the longest one with its newline or zero */
    size_t line_room;
    row_reader reader;
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

/* of a run that was done again, the row that is done, else the later one */
static void keep_place(pel_study_store *store, int64_t run, row_place place)
{
    PEL_ASSERT_INDEX(run, store->study->run_count);
    if (!store->places[run].is_done)
        store->places[run] = place;
}

/* The length of the next line without its newline, of which `line` (room) takes what it has room for; -1 when the file
   ends before a newline. */
static int64_t next_line(FILE *stream, char *line, size_t room)
{
    int64_t length = 0;
    for (int letter = getc(stream); letter != EOF; letter = getc(stream), length++) {
        if (letter == '\n')
            return length;
        if ((size_t)length < room)
            line[length] = (char)letter;
    }
    return -1;
}

static void find_rows(pel_study_store *store, FILE *stream, uint64_t at)
{
    int64_t length;
    for (; at < MOST_BYTES && (length = next_line(stream, store->line, store->line_room)) >= 0;
         at += (uint64_t)length + 1) {
        if ((size_t)length >= store->line_room)
            continue;
        store->line[length] = '\0';
        const char *row = line_row(store->line, (size_t)length);
        int64_t run = row != NULL ? row_run(store->study, row) : -1;
        if (run >= 0)
            keep_place(store, run,
                       (row_place){.at = at & (MOST_BYTES - 1),
                                   .file = store->file_count & (MOST_FILES - 1),
                                   .is_done = is_done(row, (size_t)length - HASH_DIGITS - 1)});
    }
}

/* the whole rows of a file; one of another study is refused, an empty one is that of a chunk that begins */
static pel_status visit_file(pel_study_store *store, const char *path, pel_error *error)
{
    char title[64], begin[64];
    pel_status status = pel_file_check(path, error);
    if (status != PEL_OK)
        return status;
    FILE *stream = fopen(path, "rb");
    if (stream == NULL)
        return fail_file(path, "cannot read the file", errno, error);
    put_title(store->study, title, sizeof title);
    size_t title_length = strlen(title), common = fread(begin, 1, title_length, stream);
    if (memcmp(begin, title, common) != 0)
        status = fail_other_study(store->folder, error);
    else
        find_rows(store, stream, title_length);
    if (status == PEL_OK && ferror(stream))
        status = fail_file(path, "cannot read the file", errno, error);
    fclose(stream);
    return status;
}

static pel_status visit_files(pel_study_store *store, DIR *list, pel_error *error)
{
    char path[PEL_STUDY_PATH_SIZE + 300];
    pel_status status = PEL_OK;
    for (const struct dirent *entry = readdir(list); entry != NULL && status == PEL_OK; entry = readdir(list)) {
        size_t length = strlen(entry->d_name), ending = sizeof rows_ending - 1;
        if (length <= ending || strcmp(entry->d_name + length - ending, rows_ending) != 0 ||
            store->file_count == MOST_FILES)
            continue;
        pel_json_print(&store->names, "rows/%s%c", entry->d_name, '\0');
        snprintf(path, sizeof path, "%s/rows/%s", store->folder, entry->d_name);
        status = store->names.failed ? pel_fail_memory(error) : visit_file(store, path, error);
        store->file_count++;
    }
    return status;
}

static pel_status visit_rows(pel_study_store *store, pel_error *error)
{
    char folder[PEL_STUDY_PATH_SIZE];
    snprintf(folder, sizeof folder, "%s/rows", store->folder);
    DIR *list = opendir(folder);
    if (list == NULL)
        return fail_file(folder, "cannot read the folder", errno, error);
    if (store->file_count > 0)
        memset(store->places, 0, (size_t)store->study->run_count * sizeof *store->places);
    store->file_count = 0;
    store->names.length = 0;
    pel_status status = visit_files(store, list, error);
    closedir(list);
    return status;
}

static bool has_row(const pel_study_store *store, int64_t run)
{
    return store->places[run].at > 0;
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

/* the number of bytes of a file of `end` bytes to the end of its last whole line; -1 with errno */
static int64_t find_last_line(int descriptor, int64_t end)
{
    char piece[4096];
    while (end > 0) {
        int64_t begin = end > (int64_t)sizeof piece ? end - (int64_t)sizeof piece : 0;
        ssize_t got =
            lseek(descriptor, (off_t)begin, SEEK_SET) < 0 ? -1 : read(descriptor, piece, (size_t)(end - begin));
        if (got < 0)
            return -1;
        for (int64_t i = got; i > 0; i--)
            if (piece[i - 1] == '\n')
                return begin + i;
        end = begin;
    }
    return end;
}

static pel_status cut_last_line(const pel_study_store *store, pel_error *error)
{
    int64_t size = lseek(store->descriptor, 0, SEEK_END), whole = find_last_line(store->descriptor, size);
    if (whole < 0 || (whole < size && ftruncate(store->descriptor, (off_t)whole) != 0))
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
    store->descriptor = open(store->path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
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
    store->places = pel_allocate((size_t)store->study->run_count, sizeof *store->places);
    store->line_room = HASH_DIGITS + 1 + store->study->row_size;
    store->line = pel_allocate(store->line_room, 1);
    if (store->folder == NULL || store->path == NULL || store->places == NULL || store->line == NULL)
        return pel_fail_memory(error);
    snprintf(store->path, size, "%s/rows/%d-of-%d%s", folder, (int)store->chunk, (int)store->chunk_count, rows_ending);
    pel_status status = refuse_foreign(folder, error);
    if (status == PEL_OK)
        status = make_folders(folder, error);
    /* rows of another study are refused before anything is written beside them */
    if (status == PEL_OK)
        status = visit_rows(store, error);
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
    *made = (pel_study_store){
        .study = study, .chunk = chunk, .chunk_count = chunk_count, .descriptor = -1, .reader.descriptor = -1};
    pel_status status = open_store(made, folder, error);
    if (status == PEL_OK)
        *store = made;
    else
        pel_study_store_close(made);
    return status;
}

static void close_reader(row_reader *reader)
{
    if (reader->descriptor >= 0)
        close(reader->descriptor);
    pel_free(reader->piece);
    *reader = (row_reader){.descriptor = -1};
}

void pel_study_store_close(pel_study_store *store)
{
    if (store == NULL)
        return;
    if (store->descriptor >= 0)
        close(store->descriptor);
    close_reader(&store->reader);
    pel_json_free(&store->lines);
    pel_json_free(&store->names);
    PEL_FREE_ALL(store->line, store->places, store->path, store->folder, store);
}

static bool is_of_chunk(const pel_study_store *store, int64_t run)
{
    return store != NULL && run >= 0 && run < store->study->run_count && run % store->chunk_count == store->chunk - 1;
}

bool pel_study_store_needs(const pel_study_store *store, int64_t run)
{
    return is_of_chunk(store, run) && !has_row(store, run);
}

bool pel_study_store_failed(const pel_study_store *store, int64_t run)
{
    return is_of_chunk(store, run) && has_row(store, run) && !store->places[run].is_done;
}

pel_status pel_study_store_gather(pel_study_store *store, const char *row, pel_error *error)
{
    char hash[HASH_DIGITS + 2];
    if (row_run(store->study, row) < 0 || strchr(row, '\n') != NULL || strlen(row) >= store->study->row_size)
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

/* ---- the table ---- */

static pel_status fail_changed(const pel_study_store *store, int64_t run, pel_error *error)
{
    pel_fail(error, PEL_BAD_FILE, "the row of run %" PRId64 " changed while the table was written", run);
    pel_fail_remedy(error, "repeat the command: runs whose rows are whole are not done again");
    pel_fail_place(error, store->folder, 0, 0);
    return PEL_BAD_FILE;
}

static pel_status open_reader(pel_study_store *store, uint64_t file, pel_error *error)
{
    char path[PEL_STUDY_PATH_SIZE + 300];
    row_reader *reader = &store->reader;
    const char *name = store->names.text;
    for (uint64_t i = 0; i < file; i++)
        name += strlen(name) + 1;
    snprintf(path, sizeof path, "%s/%s", store->folder, name);
    if (reader->descriptor >= 0)
        close(reader->descriptor);
    reader->descriptor = open(path, O_RDONLY | O_CLOEXEC);
    reader->file = file;
    reader->length = 0;
    if (reader->descriptor < 0)
        return fail_file(path, "cannot read the file", errno, error);
    reader->piece = reader->piece != NULL ? reader->piece : pel_allocate(PIECE + store->line_room, 1);
    return reader->piece != NULL ? PEL_OK : pel_fail_memory(error);
}

/* The row of a run, in `line`. Rows of one file mostly come one after the other, those of many chunks in turn: a piece
   is read ahead only where the last row was of the same file. */
static pel_status read_row(pel_study_store *store, int64_t run, const char **row, pel_error *error)
{
    row_reader *reader = &store->reader;
    uint64_t at = store->places[run].at, file = store->places[run].file;
    bool is_other = reader->descriptor < 0 || reader->file != file;
    pel_status status = is_other ? open_reader(store, file, error) : PEL_OK;
    if (status != PEL_OK)
        return status;
    if (at < reader->start || at + store->line_room > reader->start + reader->length) {
        size_t wanted = store->line_room + (is_other ? 0 : PIECE);
        ssize_t got =
            lseek(reader->descriptor, (off_t)at, SEEK_SET) < 0 ? -1 : read(reader->descriptor, reader->piece, wanted);
        reader->start = at;
        reader->length = got > 0 ? (size_t)got : 0;
    }
    const char *line = reader->piece + (at - reader->start);
    size_t left = reader->length - (size_t)(at - reader->start);
    const char *end = memchr(line, '\n', left < store->line_room ? left : store->line_room);
    *row = end != NULL ? line_row(line, (size_t)(end - line)) : NULL;
    if (*row == NULL)
        return fail_changed(store, run, error);
    *row = memcpy(store->line, *row, (size_t)(end - *row));
    store->line[end - line - HASH_DIGITS - 1] = '\0';
    return row_run(store->study, *row) == run ? PEL_OK : fail_changed(store, run, error);
}

/* measures that are looked at */
enum { ZEROS_MOST = 64 };

/* what the rows that are done have in common */
typedef struct row_tally {
    int64_t done;
    bool is_zero[ZEROS_MOST]; /* of the measures that the study asks for */
    char codes[PEL_RUN_WARNING_LIMIT][32];
    int64_t runs[PEL_RUN_WARNING_LIMIT]; /* that have the code */
    int32_t code_count;
} row_tally;

static row_tally start_tally(const pel_study *study)
{
    row_tally tally = {.done = 0};
    for (int32_t m = 0; m < ZEROS_MOST && m < study->measure_count; m++)
        tally.is_zero[m] = pel_study_measure_expects(&study->measures[m]);
    return tally;
}

/* the codes in a cell, with spaces */
static void count_codes(row_tally *tally, const char *cell, const char *end)
{
    for (const char *next; cell < end; cell = next + 1) {
        size_t length = strcspn(cell, " ,");
        int32_t i = 0;
        next = cell + length;
        while (i < tally->code_count &&
               (strncmp(tally->codes[i], cell, length) != 0 || tally->codes[i][length] != '\0'))
            i++;
        if (length == 0 || length >= sizeof tally->codes[0] || i == PEL_RUN_WARNING_LIMIT)
            continue;
        if (i == tally->code_count)
            memcpy(tally->codes[tally->code_count++], cell, length);
        tally->runs[i]++;
    }
}

static void count_row(const pel_study *study, row_tally *tally, const char *row)
{
    if (!pel_study_row_is_done(row))
        return;
    tally->done++;
    /* ",done," ends the row, and measures have no commas */
    const char *end = row + strlen(row) - strlen(",done,");
    for (int32_t m = study->measure_count - 1; m >= 0; m--) {
        const char *cell = end;
        while (cell[-1] != ',')
            cell--;
        if (m < ZEROS_MOST && !(end - cell == 1 && *cell == '0'))
            tally->is_zero[m] = false;
        if (pel_study_measure_is_codes(&study->measures[m]))
            count_codes(tally, cell, end);
        end = cell - 1;
    }
}

/* Names of the measures that the study asks for and that are 0 in every row that is done. */
static void note_zeros(pel_study_store *store, const row_tally *tally)
{
    const pel_study *study = store->study;
    size_t length = 0;
    for (int32_t m = 0; m < study->measure_count && m < ZEROS_MOST && tally->done > 1; m++) {
        const char *name = study->measures[m].name;
        if (!tally->is_zero[m] || length + strlen(name) + 3 > sizeof store->zeros)
            continue;
        length +=
            (size_t)snprintf(store->zeros + length, sizeof store->zeros - length, "%s%s", length > 0 ? ", " : "", name);
    }
}

/* sums up the warnings of the rows that are done, in the order in which they first come */
static void note_warnings(pel_study_store *store, const row_tally *tally)
{
    size_t length = 0, room = sizeof store->warnings;
    for (int32_t i = 0; i < tally->code_count && length < room; i++)
        length += (size_t)snprintf(store->warnings + length, room - length, "%s%s in %" PRId64 " run%s",
                                   i > 0 ? ", " : "", tally->codes[i], tally->runs[i], tally->runs[i] > 1 ? "s" : "");
}

static pel_status put_rows(pel_study_store *store, pel_file_writer *table, pel_study_page *page, pel_error *error)
{
    const char *row;
    row_tally tally = start_tally(store->study);
    pel_file_writer_printf(table, "%s\n", store->study->header);
    for (int64_t run = 0; run < store->study->run_count; run++) {
        pel_status status = read_row(store, run, &row, error);
        if (status != PEL_OK)
            return status;
        pel_file_writer_printf(table, "%s\n", row);
        pel_study_page_put(page, row);
        count_row(store->study, &tally, row);
    }
    note_zeros(store, &tally);
    note_warnings(store, &tally);
    return PEL_OK;
}

/* both files or none, as far as this program can tell before it writes their names */
static pel_status write_table(pel_study_store *store, pel_error *error)
{
    char path[PEL_STUDY_PATH_SIZE];
    pel_file_writer table;
    pel_study_page page;
    snprintf(path, sizeof path, "%s/runs.csv", store->folder);
    pel_status status = pel_file_writer_open(&table, path, error);
    if (status != PEL_OK)
        return status;
    snprintf(path, sizeof path, "%s/report.html", store->folder);
    status = pel_study_page_open(&page, store->study, path, error);
    if (status == PEL_OK && (status = put_rows(store, &table, &page, error)) != PEL_OK)
        pel_study_page_abandon(&page);
    if (status != PEL_OK) {
        pel_file_writer_abandon(&table);
        return status;
    }
    status = pel_file_writer_commit(&table, error);
    if (status == PEL_OK)
        return pel_study_page_commit(&page, error);
    pel_study_page_abandon(&page);
    return status;
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
    pel_status status = visit_rows(store, error);
    for (int64_t run = 0; run < store->study->run_count && status == PEL_OK; run++) {
        lacking += !has_row(store, run);
        bad += has_row(store, run) && !store->places[run].is_done;
    }
    if (status == PEL_OK && lacking == 0)
        status = write_table(store, error);
    close_reader(&store->reader);
    if (missing != NULL)
        *missing = lacking;
    if (failed != NULL)
        *failed = bad;
    return status;
}
