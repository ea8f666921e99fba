/* Fuzzes what lies in the folders of runs and studies, and in kept sessions. The first letter of the input chooses the
   reader: p frames.pvd, s series.csv, j summary.json, t a study, k a kept session; n and c change 4-byte words of a
   good snapshot and a good checkpoint, each with its checksum made right again: pairs of a place and a word
   (little-endian, 4 bytes each) follow the letter. Files lie in a folder of /dev/shm if there is one. */
#define _XOPEN_SOURCE 700
#include "base/hash.h"
#include "base/memory.h"
#include "io/file.h"
#include "live/keep.h"
#include "sim/snapshot.h"

#include "pellicle/frames.h"
#include "pellicle/results.h"
#include "pellicle/run.h"
#include "pellicle/study.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerInitialize(int *count, char ***words);

static const char scene_text[] =
    "version: 1\nbodies:\n"
    "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 2 }, mass: { per_vertex: 1 },\n"
    "      springs: { stiffness: 3 }, volumetric: { stiffness: 1.5 } }\n"
    "tools: [{ name: probe, shape: sphere, radius: 0.3, motion: [{ position: [0, 0, 1.4] },\n"
    "          { time: 0.05, position: [0, 0, 1.2] }] }]\n"
    "contact: { self: true }\n"
    "solver: { method: quasi-static, dt: 0.01, threads: 1 }\nduration: 0.04\n"
    "output: { every_frame: 2, checkpoint: 0.02 }\n";

static char folder[64];
static pel_scene *scene;
static pel_model *model;
static pel_sim *sim;
static unsigned char *snapshot;
static char *checkpoint;
static size_t snapshot_size, checkpoint_size;

static void require_at(bool condition, int line)
{
    if (!condition) {
        fprintf(stderr, "%s:%d\n", __FILE__, line);
        abort();
    }
}
#define require(condition) require_at(condition, __LINE__)

/* an error has a text; unless memory or a file is missing also a remedy */
static void check_error(pel_status status, const pel_error *error)
{
    if (status != PEL_OK)
        require(error->status == status && error->what[0] != '\0');
}

static const char *path_of(const char *name)
{
    static char path[4][160];
    static int turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
    return path[turn];
}

static void put_file(const char *name, const void *bytes, size_t size)
{
    FILE *file = fopen(path_of(name), "wb");
    require(file != NULL);
    require(fwrite(bytes, 1, size, file) == size && fclose(file) == 0);
}

static void put_text(const char *name, const char *text)
{
    put_file(name, text, strlen(text));
}

static pel_status run(const char *resume, pel_error *error)
{
    pel_run_def def = pel_run_def_default();
    pel_run_summary summary;
    char place[160];
    snprintf(place, sizeof place, "%s", path_of("run"));
    def.folder = place;
    def.overwrite = true;
    def.thread_count = 1;
    def.resume = resume;
    return pel_run(scene, &def, &summary, error);
}

static void make_folder(void)
{
    snprintf(folder, sizeof folder, "%s/pellicle-fuzz-XXXXXX", access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
    require(mkdtemp(folder) != NULL && mkdir(path_of("list"), 0700) == 0);
    const double corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const int32_t triangle[3] = {0, 1, 2};
    const pel_vtp frame = {.vertex_count = 3, .triangle_count = 1, .positions = corners, .triangles = triangle};
    require(pel_vtp_write(path_of("list/f.vtp"), &frame, NULL) == PEL_OK);
}

static void remove_folder(void)
{
    char command[100];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    (void)!system(command);
}

int LLVMFuzzerInitialize(int *count, char ***words)
{
    (void)count;
    (void)words;
    make_folder();
    atexit(remove_folder);
    require(pel_scene_parse("fuzz.yaml", scene_text, strlen(scene_text), NULL, 0, NULL, &scene, NULL) == PEL_OK);
    require(pel_model_create(&scene->model, &model, NULL) == PEL_OK);
    pel_sim_def def = scene->sim;
    def.model = model;
    require(pel_sim_create(&def, &sim, NULL) == PEL_OK);
    for (int i = 0; i < 3; i++)
        require(pel_sim_step(sim, NULL) == PEL_OK);
    snapshot_size = pel_sim_save_size(sim);
    snapshot = malloc(snapshot_size);
    require(snapshot != NULL);
    pel_sim_save(sim, snapshot);
    require(run(NULL, NULL) == PEL_OK);
    require(pel_file_read(path_of("run/checkpoint-2.pel"), &checkpoint, &checkpoint_size, NULL) == PEL_OK);
    char path[160];
    snprintf(path, sizeof path, "%s", path_of("run/checkpoint-2.pel"));
    require(run(path, NULL) == PEL_OK);
    return 0;
}

/* changes words; none behind `end` */
static void change(unsigned char *bytes, size_t end, const uint8_t *data, size_t size)
{
    for (; size >= 8; data += 8, size -= 8) {
        uint32_t at;
        memcpy(&at, data, 4);
        size_t place = at % (end / 4) * 4;
        memcpy(bytes + place, data + 4, 4);
    }
}

static void try_snapshot(const uint8_t *data, size_t size)
{
    pel_error error;
    unsigned char *bytes = malloc(snapshot_size);
    require(bytes != NULL);
    memcpy(bytes, snapshot, snapshot_size);
    change(bytes, snapshot_size, data, size);
    pel_snapshot_seal(bytes, snapshot_size);
    pel_status status = pel_sim_load(sim, bytes, snapshot_size, &error);
    check_error(status, &error);
    /* whatever it was, the simulation can be stepped, and reset */
    (void)pel_sim_step(sim, NULL);
    require(pel_sim_load(sim, snapshot, snapshot_size, NULL) == PEL_OK);
    free(bytes);
}

static void try_checkpoint(const uint8_t *data, size_t size)
{
    pel_error error;
    unsigned char *bytes = malloc(checkpoint_size);
    require(bytes != NULL);
    memcpy(bytes, checkpoint, checkpoint_size);
    change(bytes, checkpoint_size - sizeof(uint64_t), data, size);
    uint64_t hash = pel_hash_bytes(PEL_HASH_START, bytes, checkpoint_size - sizeof hash);
    memcpy(bytes + checkpoint_size - sizeof hash, &hash, sizeof hash);
    put_file("run/checkpoint-2.pel", bytes, checkpoint_size);
    free(bytes);
    char path[160];
    snprintf(path, sizeof path, "%s", path_of("run/checkpoint-2.pel"));
    pel_status status = run(path, &error);
    check_error(status, &error);
}

static void try_list(const char *name, const uint8_t *data, size_t size)
{
    pel_frames *frames;
    pel_frames_outline outline;
    pel_error error;
    put_text("list/frames.pvd", "<VTKFile><DataSet timestep=\"0\" file=\"f.vtp\"/></VTKFile>");
    put_text("list/summary.json", "{ \"version\": \"" PEL_VERSION "\" }\n");
    put_text("list/scene.yaml", "# a scene of pellicle " PEL_VERSION " with all defaults\n");
    put_file(name, data, size);
    pel_status status = pel_frames_open(path_of("list"), &frames, &error);
    check_error(status, &error);
    if (status == PEL_OK)
        check_error(pel_frames_check(frames, &outline, &error), &error);
    for (int32_t f = 0; status == PEL_OK && f < frames->frame_count && f < 4; f++) {
        pel_mesh *mesh;
        check_error(pel_frames_read(frames, f, &mesh, &error), &error);
        pel_mesh_destroy(mesh);
    }
    pel_frames_close(status == PEL_OK ? frames : NULL);
}

static void try_series(const uint8_t *data, size_t size)
{
    static const char *const names[] = {"frame", "time", "probe_force"};
    pel_series *series;
    pel_error error;
    put_file("series.csv", data, size);
    pel_status status = pel_series_read(path_of("series.csv"), names, 3, &series, &error);
    check_error(status, &error);
    for (int32_t c = -1; status == PEL_OK && c < 4; c++)
        for (int64_t row = -1; row <= series->row_count && row < 20; row++)
            (void)pel_series_value(series, c, row);
    pel_series_destroy(status == PEL_OK ? series : NULL);
}

static void try_study(const uint8_t *data, size_t size)
{
    pel_study *study;
    pel_error error;
    put_text("scene.yaml", scene_text);
    pel_status status = pel_study_parse(path_of("study.yaml"), (const char *)data, size, &study, &error);
    check_error(status, &error);
    if (status == PEL_OK)
        require(pel_study_run_count(study) > 0 && pel_study_row_size(study) > strlen(pel_study_header(study)) / 2);
    pel_study_destroy(status == PEL_OK ? study : NULL);
}

static void try_kept(const uint8_t *data, size_t size)
{
    pel_kept kept;
    pel_error error;
    put_file("kept.yaml", data, size);
    pel_status status = pel_keep_read(path_of("kept.yaml"), path_of("scene.yaml"), &kept, &error);
    check_error(status, &error);
    require(status == PEL_OK || kept.scene == NULL);
    pel_scene_destroy(kept.scene);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0)
        return -1;
    const char kind = (char)data[0];
    data++;
    size--;
    switch (kind) {
    case 'p':
        try_list("list/frames.pvd", data, size);
        return 0;
    case 'j':
        try_list("list/summary.json", data, size);
        return 0;
    case 's':
        try_series(data, size);
        return 0;
    case 't':
        try_study(data, size);
        return 0;
    case 'k':
        try_kept(data, size);
        return 0;
    case 'n':
        try_snapshot(data, size);
        return 0;
    case 'c':
        try_checkpoint(data, size);
        return 0;
    default:
        return -1;
    }
}
