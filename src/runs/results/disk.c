#define _XOPEN_SOURCE 700
#include "results/disk.h"

#include "base/status.h"
#include "math/extremes.h"
#include "results/folder.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/statvfs.h>

/* files of a kind in a run, at most: more take a file system minutes to list */
#define MOST_FILES 1e7
/* files and bytes that are told */
#define MANY_FILES 1e5
#define MUCH 1e10
/* of what would just fit */
#define MARGIN 2
/* bytes of a row of the series, and of the text around the numbers of a frame */
#define ROW_BYTES 500.0
#define FRAME_TEXT 1000.0
/* least share of them that is left of compressed numbers (measured: about a half) */
#define COMPRESSED 0.2

double pel_run_frame_bytes(const pel_run_surface *surface, const pel_output_def *output)
{
    const double size = output->float64 ? 8 : 4, index = 4, corners = 3;
    double per_vertex = 3, per_triangle = 0;
    for (int32_t f = 0; f < surface->field_count; f++)
        per_vertex += surface->fields[f].component_count;
    for (int32_t f = 0; f < surface->cell_field_count; f++)
        per_triangle += surface->cell_fields[f].component_count;
    double bytes = size * (per_vertex * surface->vertex_count + per_triangle * surface->triangle_count) +
                   (corners + 1) * index * surface->triangle_count;
    return (output->compress ? COMPRESSED : 1) * bytes + FRAME_TEXT + ROW_BYTES;
}

/* bytes that are free for the folder, or for the first one above that is there; infinite where the system does not
   tell, as for file systems without blocks */
static double free_bytes(const char *folder)
{
    char path[PEL_RUN_FILE_SIZE];
    struct statvfs disk;
    snprintf(path, sizeof path, "%s", folder);
    while (statvfs(path, &disk) != 0) {
        char *slash = strrchr(path, '/');
        if (strcmp(path, "/") == 0 || strcmp(path, ".") == 0)
            return (double)HUGE_VAL;
        if (slash != NULL)
            slash[slash == path] = '\0';
        else
            snprintf(path, sizeof path, ".");
    }
    return disk.f_blocks > 0 ? (double)disk.f_bavail * (double)disk.f_frsize : (double)HUGE_VAL;
}

/* "1000 frames of 1.7 MB and 10 checkpoints of 2.2 MB take about 1.72 GB" */
static void describe(const pel_disk_need *need, double bytes, char *text, size_t size)
{
    char checkpoints[128] = "";
    if (need->checkpoint_count > 0)
        snprintf(checkpoints, sizeof checkpoints, " and %.0f checkpoints of %.3g MB", need->checkpoint_count,
                 1e-6 * need->checkpoint_bytes);
    snprintf(text, size, "%.0f frames of %.3g MB%s take about %.4g GB", need->frame_count, 1e-6 * need->frame_bytes,
             checkpoints, 1e-9 * bytes);
}

pel_status pel_run_check_disk(const char *folder, const pel_disk_need *need, const pel_log *log, pel_error *error)
{
    const double frames = need->frame_count * need->frame_bytes;
    const double checkpoints = need->checkpoint_count * need->checkpoint_bytes;
    const double bytes = frames + checkpoints, room = free_bytes(folder);
    const double files = pel_max(need->frame_count, need->checkpoint_count);
    const bool is_checkpoint = checkpoints > frames || need->checkpoint_count > need->frame_count;
    const double factor = pel_max(bytes / pel_max(room, 1), files / MOST_FILES);
    char text[300], remedy[128];
    if (!(bytes > MUCH || files > MANY_FILES || factor > 1))
        return PEL_OK;
    describe(need, bytes, text, sizeof text);
    snprintf(remedy, sizeof remedy, "set output.%s to %.2g s or more", is_checkpoint ? "checkpoint" : "every",
             MARGIN * pel_max(factor, 1) * (is_checkpoint ? need->checkpoint_seconds : need->frame_seconds));
    if (!(factor > 1) || need->may_take_less) {
        char rest[64] = "";
        if (isfinite(room))
            snprintf(rest, sizeof rest, ", of %.4g GB on the disk", 1e-9 * room);
        pel_log_line(log, "%s%s: for fewer %s", text, rest, remedy);
        return PEL_OK;
    }
    if (files > MOST_FILES)
        pel_fail(error, PEL_BAD_SCENE, "%s, in more files than %.0f", text, MOST_FILES);
    else
        pel_fail(error, PEL_BAD_SCENE, "%s, and the disk has %.4g GB", text, 1e-9 * room);
    pel_fail_remedy(error, "%s, or write to another disk", remedy);
    return PEL_BAD_SCENE;
}
