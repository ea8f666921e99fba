/* A checkpoint file: header, totals, the tools' largest forces, the simulation's snapshot, and a hash of all of it. It
   is read by the program that wrote it, on a machine of the same kind. */
#include "base/hash.h"
#include "base/memory.h"
#include "base/status.h"
#include "io/file.h"
#include "results/folder.h"
#include "run/state.h"

#include <stdio.h>
#include <string.h>

typedef struct checkpoint_header {
    char magic[8];
    char version[16]; /* of the program */
    uint64_t fingerprint;
    int64_t step;
    uint64_t size;        /* of the file, hash included */
    uint64_t snapshot_at; /* where the snapshot begins */
    pel_run_totals totals;
} checkpoint_header;

static const char magic[8] = "PELRUN7";

static size_t tool_bytes(const pel_run_state *run)
{
    return PEL_TOOL_NUMBERS * (size_t)run->tool_count * sizeof *run->tool_force;
}

pel_status pel_run_checkpoint_prepare(pel_run_state *run, pel_error *error)
{
    run->checkpoint_size = sizeof(checkpoint_header) + tool_bytes(run) + pel_sim_save_size(run->sim) + sizeof(uint64_t);
    bool has_room = pel_reserve((void **)&run->checkpoint, &run->checkpoint_room, run->checkpoint_size, 1);
    return has_room ? PEL_OK : pel_fail_memory(error);
}

static void fill_buffer(pel_run_state *run)
{
    checkpoint_header header = {
        .version = PEL_VERSION,
        .fingerprint = run->fingerprint,
        .step = pel_sim_step_count(run->sim),
        .size = run->checkpoint_size,
        .snapshot_at = sizeof header + tool_bytes(run),
        .totals = run->totals,
    };
    memcpy(header.magic, magic, sizeof magic);
    header.totals.wall_seconds += pel_seconds() - run->start;
    unsigned char *out = run->checkpoint;
    memcpy(out, &header, sizeof header);
    memcpy(out + sizeof header, run->tool_force, tool_bytes(run));
    pel_sim_save(run->sim, out + header.snapshot_at);
    uint64_t hash = pel_hash_bytes(PEL_HASH_START, out, run->checkpoint_size - sizeof hash);
    memcpy(out + run->checkpoint_size - sizeof hash, &hash, sizeof hash);
}

/* the file is the last good state now */
static void remember(pel_run_state *run, const char *path)
{
    snprintf(run->checkpoint_path, sizeof run->checkpoint_path, "%s", path);
    run->checkpoint_step = pel_sim_step_count(run->sim);
}

static pel_status write_buffer(pel_run_state *run, const char *path, pel_error *error)
{
    pel_file_writer writer;
    pel_status status = pel_run_folder_sync(run->def->folder, error);
    if (status == PEL_OK)
        status = pel_file_writer_open(&writer, path, error);
    if (status != PEL_OK)
        return status;
    pel_file_writer_keep(&writer);
    pel_file_writer_write(&writer, run->checkpoint, run->checkpoint_size);
    status = pel_file_writer_commit(&writer, error);
    if (status == PEL_OK)
        remember(run, path);
    return status;
}

pel_status pel_run_checkpoint_write(pel_run_state *run, bool numbered, pel_error *error)
{
    char path[PEL_RUN_FILE_SIZE];
    pel_status status = pel_run_checkpoint_prepare(run, error);
    if (status == PEL_OK)
        fill_buffer(run);
    if (status == PEL_OK && numbered)
        status =
            write_buffer(run, pel_run_checkpoint_path(path, run->def->folder, pel_sim_step_count(run->sim)), error);
    if (status == PEL_OK)
        status = write_buffer(run, pel_run_path(path, run->def->folder, PEL_RUN_CHECKPOINT), error);
    return status;
}

static pel_status refuse(const char *path, const char *what, const char *remedy, pel_error *error)
{
    pel_refuse(error, PEL_BAD_FORMAT, remedy, "%s", what);
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_FORMAT;
}

static pel_status refuse_version(const char *path, pel_error *error)
{
    return refuse(path, "the checkpoint was written by another version of the program",
                  "run from the beginning, or use that version", error);
}

/* names the difference of the scene: parts of the simulation, from its snapshot, or settings of the run */
static pel_status refuse_scene(const pel_run_state *run, const char *path, const char *bytes, size_t size, size_t at,
                               pel_error *error)
{
    static const char parts[] = "the snapshot was made with other: ";
    char what[sizeof error->what];
    pel_error found = {0};
    const char *differs = "output, duration, stop or names";
    bool loads = pel_sim_load(run->sim, bytes + at, at < size ? size - at : 0, &found) == PEL_OK;
    if (!loads && strncmp(found.what, parts, strlen(parts)) != 0)
        return refuse(path, found.what, found.remedy, error);
    if (!loads)
        differs = found.what + strlen(parts);
    snprintf(what, sizeof what, "the checkpoint belongs to another scene: it was made with other %.250s", differs);
    return refuse(path, what, "resume with the same scene, overrides and mesh files, or run from the beginning", error);
}

/* everything but the snapshot, which checks itself */
static pel_status check(const pel_run_state *run, const char *path, const char *bytes, size_t size,
                        checkpoint_header *header, pel_error *error)
{
    uint64_t hash;
    if (size < sizeof magic || memcmp(bytes, magic, sizeof magic - 2) != 0)
        return refuse(path, "this is not a checkpoint of a run", "give the file `checkpoint` of a run's folder", error);
    if (memcmp(bytes, magic, sizeof magic) != 0)
        return refuse_version(path, error);
    if (size < sizeof *header + sizeof hash)
        return refuse(path, "the checkpoint is damaged", "use an older one, or run from the beginning", error);
    memcpy(header, bytes, sizeof *header);
    memcpy(&hash, bytes + size - sizeof hash, sizeof hash);
    if (header->size != size || hash != pel_hash_bytes(PEL_HASH_START, bytes, size - sizeof hash))
        return refuse(path, "the checkpoint is damaged", "use an older one, or run from the beginning", error);
    if (strncmp(header->version, PEL_VERSION, sizeof header->version) != 0)
        return refuse_version(path, error);
    size_t at = sizeof *header + tool_bytes(run);
    if (header->fingerprint != run->fingerprint || header->snapshot_at != at || size < at + sizeof hash)
        return refuse_scene(run, path, bytes, size - sizeof hash, (size_t)header->snapshot_at, error);
    return PEL_OK;
}

pel_status pel_run_checkpoint_read(pel_run_state *run, const char *path, pel_error *error)
{
    char *bytes;
    size_t size;
    checkpoint_header header;
    pel_status status = pel_file_read(path, &bytes, &size, error);
    if (status != PEL_OK)
        return status;
    status = check(run, path, bytes, size, &header, error);
    if (status == PEL_OK) {
        size_t at = sizeof header + tool_bytes(run);
        memcpy(run->tool_force, bytes + sizeof header, tool_bytes(run));
        status = pel_sim_load(run->sim, bytes + at, size - sizeof(uint64_t) - at, error);
        run->totals = header.totals;
        pel_sim_get_contact_statistics(run->sim, &run->contact_before);
        remember(run, path);
    }
    pel_free(bytes);
    return status;
}
