#include "pellicle/frames.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/room.h"
#include "base/status.h"
#include "io/file.h"
#include "io/xml.h"
#include "mesh/figures.h"
#include "pellicle/results.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* characters; parts of a frame in a list that is not damaged */
enum { LONGEST_NAME = 1024, MOST_TOOLS = 4096 };

/* folder/name in a new block */
static char *join_path(const char *folder, const char *name)
{
    size_t size = strlen(folder) + strlen(name) + 2;
    char *path = pel_allocate(size, 1);
    if (path != NULL)
        snprintf(path, size, "%s/%s", name[0] == '/' ? "" : folder, name);
    return path;
}

/* ---- version ---- */

/* the version after `mark` in a text; false if there is none */
static bool find_version(const char *text, const char *mark, int version[3])
{
    const char *at = strstr(text, mark);
    return at != NULL && sscanf(at + strlen(mark), "%d.%d.%d", &version[0], &version[1], &version[2]) == 3;
}

/* patch versions share their formats */
static bool is_newer(const int version[3])
{
    return version[0] > PEL_VERSION_MAJOR || (version[0] == PEL_VERSION_MAJOR && version[1] > PEL_VERSION_MINOR);
}

/* refuses a run of a newer version, as one of its files tells; a file that is not there tells nothing */
static pel_status check_version(const char *folder, pel_run_file file, const char *mark, pel_error *error)
{
    char *path = join_path(folder, pel_run_file_name(file)), *text = NULL;
    size_t size;
    int version[3];
    if (path == NULL)
        return pel_fail_memory(error);
    pel_status status = pel_file_check_inside(folder, path, error);
    if (status == PEL_OK)
        status = pel_file_read(path, &text, &size, error);
    if (status == PEL_BAD_FILE) {
        status = PEL_OK;
    } else if (status == PEL_OK && find_version(text, mark, version) && is_newer(version)) {
        status = pel_fail(error, PEL_BAD_FORMAT, "the run is of pellicle %d.%d.%d and this is " PEL_VERSION, version[0],
                          version[1], version[2]);
        pel_fail_remedy(error, "read it with that version or a later one");
        pel_fail_place(error, path, 0, 0);
    }
    pel_free(text);
    pel_free(path);
    return status;
}

static pel_status check_folder(const char *folder, pel_error *error)
{
    struct stat information;
    if (stat(folder, &information) == 0 && S_ISDIR(information.st_mode))
        return PEL_OK;
    pel_fail(error, PEL_BAD_FILE, "there is no such folder");
    pel_fail_remedy(error, "name the folder that a run wrote");
    pel_fail_place(error, folder, 0, 0);
    return PEL_BAD_FILE;
}

/* ---- frames.pvd ---- */

static pel_status fail_list(const char *path, const char *what, const char *remedy, pel_error *error)
{
    pel_fail(error, PEL_BAD_FORMAT, "%s", what);
    pel_fail_remedy(error, "%s", remedy);
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_FORMAT;
}

/* a DataSet of frames.pvd */
typedef struct data_set {
    char file[LONGEST_NAME], name[PEL_NAME_SIZE];
    double time;
    int64_t part; /* 0 = the bodies of a frame, else the number of a tool plus 1 */
} data_set;

static pel_status read_data_set(const pel_xml_tag *tag, const char *path, data_set *set, pel_error *error)
{
    static const char write_again[] = "run the scene again, or remove the damaged line";
    char text[PEL_NUMBER_SIZE];
    double part = 0;
    if (!pel_xml_attribute(tag, "file", set->file, sizeof set->file) || set->file[0] == '\0')
        return fail_list(path, "a DataSet names no file", write_again, error);
    if (!pel_xml_attribute(tag, "timestep", text, sizeof text) ||
        pel_number_parse(text, text + strlen(text), &set->time) == NULL || !isfinite(set->time))
        return fail_list(path, "a DataSet has no time", write_again, error);
    if (pel_xml_attribute(tag, "part", text, sizeof text) && text[0] != '\0' &&
        (pel_number_parse(text, text + strlen(text), &part) == NULL || !(part >= 0 && part <= MOST_TOOLS)))
        return fail_list(path, "a DataSet has no number as its part", write_again, error);
    set->part = (int64_t)part;
    if (!pel_xml_attribute(tag, "name", set->name, sizeof set->name))
        set->name[0] = '\0';
    return PEL_OK;
}

static pel_status append_frame(pel_frames *frames, const data_set *set, pel_error *error)
{
    int32_t f = frames->frame_count;
    frames->paths[f] = join_path(frames->folder, set->file);
    frames->times[f] = set->time;
    if (frames->paths[f] == NULL)
        return pel_fail_memory(error);
    frames->frame_count++;
    return pel_file_check_inside(frames->folder, frames->paths[f], error);
}

/* a tool of the last frame */
static pel_status append_tool(pel_frames *frames, const data_set *set, const char *path, pel_error *error)
{
    int64_t f = frames->frame_count - 1, tool = set->part - 1;
    if (f < 0 || set->time != frames->times[f])
        return fail_list(path, "a tool has no frame of its time", "run the scene again", error);
    char **name = &frames->tool_names[tool], **file = &frames->tool_paths[f * frames->tool_count + tool];
    if (*name == NULL)
        *name = pel_copy_string(set->name);
    pel_free(*file);
    *file = join_path(frames->folder, set->file);
    if (*name == NULL || *file == NULL)
        return pel_fail_memory(error);
    return pel_file_check_inside(frames->folder, *file, error);
}

/* counts frames, and tools by their largest number */
static pel_status count_data_sets(const char *path, const char *at, const char *end, size_t *count, pel_frames *frames,
                                  pel_error *error)
{
    pel_status status = PEL_OK;
    data_set set;
    *count = 0;
    for (pel_xml_tag tag; status == PEL_OK && pel_xml_next(&at, end, &tag);) {
        if (!pel_xml_is(&tag, "DataSet"))
            continue;
        status = read_data_set(&tag, path, &set, error);
        *count += set.part == 0;
        frames->tool_count = set.part > frames->tool_count ? (int32_t)set.part : frames->tool_count;
    }
    return status;
}

static pel_status parse_list(pel_frames *frames, const char *path, const char *at, const char *end, pel_error *error)
{
    size_t count = 0;
    pel_status status = count_data_sets(path, at, end, &count, frames, error);
    if (status != PEL_OK)
        return status;
    if (count == 0)
        return fail_list(path, "it names no frame", "name the folder of a run that has written frames", error);
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(frames->paths, count), PEL_ROOM(frames->times, count),
                          PEL_ROOM(frames->tool_names, frames->tool_count),
                          PEL_ROOM(frames->tool_paths, count * (size_t)frames->tool_count)))
        return pel_fail_memory(error);
    bool whole = false;
    data_set set;
    for (pel_xml_tag tag; status == PEL_OK && pel_xml_next(&at, end, &tag);) {
        if (pel_xml_is(&tag, "DataSet")) {
            status = read_data_set(&tag, path, &set, error);
            if (status == PEL_OK)
                status = set.part == 0 ? append_frame(frames, &set, error) : append_tool(frames, &set, path, error);
        }
        whole = whole || pel_xml_is(&tag, "/VTKFile");
    }
    if (status == PEL_OK && !whole)
        return fail_list(path, "the file is cut off", "run the scene again", error);
    /* of frames that a resumed run has taken back */
    for (int32_t i = 0; status == PEL_OK && i < frames->tool_count; i++)
        if (frames->tool_names[i] == NULL && (frames->tool_names[i] = pel_copy_string("")) == NULL)
            status = pel_fail_memory(error);
    return status;
}

static pel_status read_list(pel_frames *frames, pel_error *error)
{
    char *path = join_path(frames->folder, pel_run_file_name(PEL_RUN_FRAMES)), *text = NULL;
    size_t size;
    if (path == NULL)
        return pel_fail_memory(error);
    pel_status status = pel_file_check_inside(frames->folder, path, error);
    if (status == PEL_OK)
        status = pel_file_read(path, &text, &size, error);
    if (status == PEL_BAD_FILE)
        pel_fail_remedy(error, "name the folder that a run wrote; it holds frames.pvd");
    if (status == PEL_OK)
        status = parse_list(frames, path, text, text + size, error);
    pel_free(text);
    pel_free(path);
    return status;
}

pel_status pel_frames_open(const char *folder, pel_frames **frames, pel_error *error)
{
    PEL_REFUSE_NULL(folder, error);
    PEL_REFUSE_NULL(frames, error);
    *frames = NULL;
    pel_status status = check_folder(folder, error);
    if (status != PEL_OK)
        return status;
    pel_frames *made = pel_allocate(1, sizeof *made);
    if (made != NULL)
        made->folder = pel_copy_string(folder);
    if (made == NULL || made->folder == NULL) {
        pel_frames_close(made);
        return pel_fail_memory(error);
    }
    status = check_version(folder, PEL_RUN_SUMMARY, "\"version\": \"", error);
    if (status == PEL_OK)
        status = check_version(folder, PEL_RUN_SCENE, "# a scene of pellicle ", error);
    if (status == PEL_OK)
        status = read_list(made, error);
    if (status != PEL_OK) {
        pel_frames_close(made);
        return status;
    }
    *frames = made;
    return PEL_OK;
}

void pel_frames_close(pel_frames *frames)
{
    if (frames == NULL)
        return;
    for (int32_t f = 0; f < frames->frame_count; f++)
        pel_free(frames->paths[f]);
    size_t path_count = (size_t)frames->frame_count * (size_t)frames->tool_count;
    for (size_t i = 0; frames->tool_paths != NULL && i < path_count; i++)
        pel_free(frames->tool_paths[i]);
    for (int32_t i = 0; frames->tool_names != NULL && i < frames->tool_count; i++)
        pel_free(frames->tool_names[i]);
    PEL_FREE_ALL(frames->tool_paths, frames->tool_names, frames->paths, frames->times, frames->folder, frames);
}

/* ---- frames ---- */

static pel_status check_fields(const pel_mesh *mesh, const char *path, pel_error *error)
{
    for (int32_t f = 0; f < mesh->field_count; f++) {
        const pel_field *field = &mesh->fields[f];
        size_t components = (size_t)field->component_count;
        for (size_t i = 0; i < (size_t)mesh->vertex_count * components; i++) {
            if (isfinite(field->values[i]))
                continue;
            pel_fail(error, PEL_BAD_FORMAT, "field '%s' is %s", field->name,
                     isnan(field->values[i]) ? "not a number (NaN)" : "infinite");
            pel_fail_remedy(error, "leave the field out of the scene's output, or run the scene again");
            pel_fail_element(error, "vertex", (int64_t)(i / components));
            pel_fail_place(error, path, 0, 0);
            return PEL_BAD_FORMAT;
        }
    }
    return PEL_OK;
}

pel_status pel_frames_read(const pel_frames *frames, int32_t frame, pel_mesh **mesh, pel_error *error)
{
    PEL_REFUSE_NULL(frames, error);
    PEL_REFUSE_NULL(mesh, error);
    *mesh = NULL;
    if (frame < 0 || frame >= frames->frame_count)
        return pel_fail(error, PEL_BAD_ARGUMENT, "there is no frame %d among %d", (int)frame, (int)frames->frame_count);
    const char *path = frames->paths[frame];
    pel_status status = pel_vtp_read(path, mesh, NULL, error);
    if (status == PEL_BAD_FILE)
        pel_fail_remedy(error, "frames.pvd names this frame; run the scene again");
    if (status == PEL_OK)
        status = check_fields(*mesh, path, error);
    if (status != PEL_OK) {
        pel_mesh_destroy(*mesh);
        *mesh = NULL;
    }
    return status;
}

pel_status pel_frames_read_tool(const pel_frames *frames, int32_t frame, int32_t tool, pel_mesh **mesh,
                                pel_error *error)
{
    PEL_REFUSE_NULL(frames, error);
    PEL_REFUSE_NULL(mesh, error);
    *mesh = NULL;
    if (frame < 0 || frame >= frames->frame_count || tool < 0 || tool >= frames->tool_count)
        return pel_fail(error, PEL_BAD_ARGUMENT, "there is no tool %d in frame %d", (int)tool, (int)frame);
    const char *path = frames->tool_paths[(size_t)frame * (size_t)frames->tool_count + (size_t)tool];
    if (path == NULL)
        return PEL_OK;
    pel_status status = pel_vtp_read(path, mesh, NULL, error);
    if (status == PEL_BAD_FILE)
        pel_fail_remedy(error, "frames.pvd names this file; run the scene again");
    return status;
}

/* ---- all frames ---- */

static bool same_triangles(const pel_mesh *a, const pel_mesh *b)
{
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           memcmp(a->triangles, b->triangles, (size_t)a->triangle_count * sizeof *a->triangles) == 0;
}

pel_status pel_frames_check(const pel_frames *frames, pel_frames_outline *outline, pel_error *error)
{
    PEL_REFUSE_NULL(frames, error);
    PEL_REFUSE_NULL(outline, error);
    pel_mesh *first, *mesh;
    *outline = (pel_frames_outline){.changed_frame = -1};
    pel_status status = pel_frames_read(frames, 0, &first, error);
    if (status != PEL_OK)
        return status;
    outline->vertex_count = first->vertex_count;
    outline->triangle_count = first->triangle_count;
    pel_mesh_box(first, outline->low, outline->high);
    for (int32_t f = 1; status == PEL_OK && f < frames->frame_count; f++) {
        status = pel_frames_read(frames, f, &mesh, error);
        if (status != PEL_OK)
            break;
        if (outline->changed_frame < 0 && !same_triangles(first, mesh))
            outline->changed_frame = f;
        pel_mesh_add_box(mesh, outline->low, outline->high);
        pel_mesh_destroy(mesh);
    }
    pel_mesh_destroy(first);
    return status;
}
