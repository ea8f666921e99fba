/* A folder as a run leaves it: a tetrahedron that moves, with a scalar and a vector field. */
#ifndef PEL_TESTS_RUN_FOLDER_H
#define PEL_TESTS_RUN_FOLDER_H

#include "check.h"

#include "io/pvd.h"
#include "pellicle/results.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FOLDER_FRAMES = 4, FOLDER_VERTICES = 4, FOLDER_SIZE = 64, FOLDER_PATH = 128 };

static const int32_t folder_triangles[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};

/* content of the frame */
static inline void folder_values(int frame, double positions[12], double scalar[4], double vector[12])
{
    static const double rest[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int i = 0; i < 12; i++) {
        positions[i] = rest[i] * (1 + 0.1 * frame) + 10;
        vector[i] = 0.1 * frame * rest[i];
    }
    for (int v = 0; v < 4; v++)
        scalar[v] = 0.25 * v - frame;
}

static inline const char *folder_path(char path[FOLDER_PATH], const char *folder, const char *name)
{
    snprintf(path, FOLDER_PATH, "%s/%s", folder, name);
    return path;
}

static inline void folder_write_text(const char *folder, const char *name, const char *text)
{
    char path[FOLDER_PATH];
    FILE *file = fopen(folder_path(path, folder, name), "wb");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

/* one frame; a hole when triangle_count is 3; `bad` replaces the scalar of vertex 2 unless it is 0 */
static inline void folder_write_frame(const char *folder, int frame, int32_t triangle_count, double bad)
{
    char path[FOLDER_PATH], name[32];
    double positions[12], scalar[4], vector[12];
    folder_values(frame, positions, scalar, vector);
    if (bad != 0)
        scalar[2] = bad;
    const pel_vtp_field fields[2] = {{"energy", 1, scalar}, {"force", 3, vector}};
    const pel_vtp vtp = {.vertex_count = FOLDER_VERTICES,
                         .triangle_count = triangle_count,
                         .positions = positions,
                         .triangles = folder_triangles,
                         .fields = fields,
                         .field_count = 2,
                         .time = 0.5 * frame,
                         .compress = frame % 2 == 0,
                         .float64 = true};
    snprintf(name, sizeof name, "frames/f%05d.vtp", frame);
    assert_int_equal(pel_vtp_write(folder_path(path, folder, name), &vtp, NULL), PEL_OK);
}

/* makes folder, a name that ends in XXXXXX */
static inline void folder_make(char folder[FOLDER_SIZE])
{
    char path[FOLDER_PATH];
    const char *names[FOLDER_FRAMES];
    char texts[FOLDER_FRAMES][32];
    double times[FOLDER_FRAMES];
    assert_non_null(mkdtemp(folder));
    assert_int_equal(mkdir(folder_path(path, folder, "frames"), 0777), 0);
    for (int f = 0; f < FOLDER_FRAMES; f++) {
        folder_write_frame(folder, f, 4, 0);
        snprintf(texts[f], sizeof texts[f], "frames/f%05d.vtp", f);
        names[f] = texts[f];
        times[f] = 0.5 * f;
    }
    assert_int_equal(pel_pvd_write(folder_path(path, folder, "frames.pvd"), names, times, FOLDER_FRAMES, NULL), PEL_OK);
    folder_write_text(folder, "series.csv", "frame,time,max_force\n0,0,1\n1,0.5,2\n");
    folder_write_text(folder, "summary.json", "{\n  \"status\": \"done\",\n  \"version\": \"" PEL_VERSION "\"\n}\n");
    folder_write_text(folder, "scene.yaml",
                      "# a scene of pellicle " PEL_VERSION " with all defaults\ntitle: \"</script>\"\n");
}

/* adds a tool, 'tip/1', a box that rises by 1 from frame to frame and is not there in frame 0 */
static inline void folder_add_tool(const char *folder)
{
    static const int32_t faces[36] = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                      2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    char path[FOLDER_PATH], names[2 * FOLDER_FRAMES][32];
    pel_pvd_entry entries[2 * FOLDER_FRAMES];
    size_t count = 0;
    for (int f = 0; f < FOLDER_FRAMES; f++) {
        double positions[24];
        for (int i = 0; i < 24; i++)
            positions[i] = (i / 3 >> i % 3 & 1) + (i % 3 == 2 ? f : 0);
        const pel_vtp vtp = {.vertex_count = 8, .triangle_count = 12, .positions = positions, .triangles = faces};
        snprintf(names[count], sizeof names[count], "frames/f%05d.vtp", f);
        entries[count] = (pel_pvd_entry){.file = names[count], .time = 0.5 * f};
        count++;
        if (f == 0)
            continue;
        snprintf(names[count], sizeof names[count], "frames/t%05d-0.vtp", f);
        assert_int_equal(pel_vtp_write(folder_path(path, folder, names[count]), &vtp, NULL), PEL_OK);
        entries[count] = (pel_pvd_entry){.file = names[count], .name = "tip/1", .time = 0.5 * f, .part = 1};
        count++;
    }
    assert_int_equal(pel_pvd_write_entries(folder_path(path, folder, "frames.pvd"), entries, count, NULL), PEL_OK);
}

static inline void folder_remove(const char *folder)
{
    char command[FOLDER_PATH];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    assert_int_equal(system(command), 0);
}

#endif
