#include "diagnostics.h"
#include "commands.h"

#include <pellicle/import.h>

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int cli_report(const pel_error *error)
{
    char text[1200];
    fprintf(stderr, "%s\n", pel_error_text(error, text, sizeof text));
    bool failed = error->status == PEL_DIVERGED || error->status == PEL_STOPPED;
    return failed ? CLI_FAILED : CLI_BAD_INPUT;
}

void cli_write_error(pel_json *json, const pel_error *error)
{
    pel_json_open(json, "error", '{');
    pel_json_text(json, "status", pel_status_text(error->status));
    pel_json_text(json, "file", error->file[0] != '\0' ? error->file : NULL);
    if (error->line > 0)
        pel_json_integer(json, "line", error->line);
    if (error->column > 0)
        pel_json_integer(json, "column", error->column);
    if (error->byte_offset >= 0)
        pel_json_integer(json, "byte_offset", error->byte_offset);
    if (error->element >= 0) {
        pel_json_text(json, "element_kind", error->element_kind);
        pel_json_integer(json, "element", error->element);
    }
    if (error->element_name[0] != '\0')
        pel_json_text(json, "element_name", error->element_name);
    pel_json_text(json, "what", error->what);
    pel_json_text(json, "remedy", error->remedy[0] != '\0' ? error->remedy : NULL);
    pel_json_close(json, '}');
}

const char *cli_severity_name(pel_severity severity)
{
    return severity == PEL_SEVERITY_ERROR ? "error" : severity == PEL_SEVERITY_WARNING ? "warning" : "note";
}

void cli_open_issue(pel_json *json, const pel_issue_info *info, int64_t count)
{
    pel_json_open(json, NULL, '{');
    pel_json_text(json, "name", info->name);
    pel_json_text(json, "severity", cli_severity_name(info->severity));
    pel_json_integer(json, "count", count);
    pel_json_text(json, "what", info->doc);
    pel_json_text(json, "remedy", info->remedy);
    pel_json_bool(json, "repairable", info->repairable);
}

int cli_report_to(const pel_error *error, pel_json *json)
{
    if (json != NULL) {
        pel_json_bool(json, "ok", false);
        cli_write_error(json, error);
    }
    return cli_report(error);
}

void cli_name_file(pel_error *error, const char *path)
{
    if (error->file[0] == '\0')
        pel_fail_place(error, path, 0, 0);
}

bool cli_is_scene(const char *path)
{
    static const char *const endings[] = {".yaml", ".yml", ".json"};
    size_t length = strlen(path);
    for (size_t i = 0; i < sizeof endings / sizeof *endings; ++i) {
        size_t size = strlen(endings[i]);
        if (length > size && strcmp(path + length - size, endings[i]) == 0)
            return true;
    }
    return false;
}

bool cli_is_folder(const char *path)
{
    struct stat information;
    return stat(path, &information) == 0 && S_ISDIR(information.st_mode);
}

static void write_note(void *user, const char *text)
{
    (void)user;
    fprintf(stderr, "note: %s\n", text);
}

const pel_log cli_notes = {.write = write_note};

pel_mesh *cli_read_mesh(const char *path, const pel_log *log, pel_json *json, int *status)
{
    pel_mesh *mesh = NULL;
    pel_error error;
    *status = CLI_DONE;
    if (pel_mesh_import(path, log, &mesh, &error) != PEL_OK) {
        cli_name_file(&error, path);
        *status = cli_report_to(&error, json);
    }
    return mesh;
}

static const struct {
    const char *name;
    pel_mesh_format format;
} formats[] = {
    {"obj", PEL_FORMAT_OBJ},         {"ply", PEL_FORMAT_PLY}, {"ply-ascii", PEL_FORMAT_PLY_ASCII},
    {"ply-big", PEL_FORMAT_PLY_BIG}, {"stl", PEL_FORMAT_STL}, {"stl-ascii", PEL_FORMAT_STL_ASCII},
    {"off", PEL_FORMAT_OFF},         {"vtp", PEL_FORMAT_VTP},
};

enum { FORMAT_COUNT = sizeof formats / sizeof *formats };

const char *cli_format_names(int index)
{
    return index < FORMAT_COUNT ? formats[index].name : NULL;
}

bool cli_output_format(const cli_call *call, const char *path, pel_mesh_format *format)
{
    const char *name = cli_value(call, "format");
    *format = pel_mesh_format_of_path(path);
    for (int i = 0; name != NULL && i < FORMAT_COUNT; ++i) {
        if (strcmp(formats[i].name, name) == 0)
            *format = formats[i].format;
    }
    if (*format != PEL_FORMAT_AUTO)
        return true;
    cli_complain("'%s' is not a mesh format that can be written. end the name in .obj, .ply, .stl, .off or .vtp", path);
    return false;
}

int cli_write_mesh(const char *path, pel_mesh_format format, const pel_mesh *mesh, const pel_log *log, bool quiet)
{
    pel_error error;
    if (pel_mesh_write(path, format, mesh, log, &error) != PEL_OK)
        return cli_report(&error);
    if (!quiet)
        printf("%s: %d vertices, %d triangles\n", path, (int)mesh->vertex_count, (int)mesh->triangle_count);
    return CLI_DONE;
}

const char *cli_share_path(char *path, size_t size, const char *name)
{
    static const char *const places[] = {"../share/pellicle", "../web", "../.."};
    char program[4096];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length < 0)
        return NULL;
    program[length] = '\0';
    char *slash = strrchr(program, '/');
    *slash = '\0';
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        int written = snprintf(path, size, "%s/%s/%s", program, places[i], name);
        if (written > 0 && (size_t)written < size && access(path, R_OK) == 0)
            return path;
    }
    return NULL;
}

const char *cli_scene_path(char *path, size_t size, const char *name)
{
    char file[256];
    if (strpbrk(name, "/.") != NULL || access(name, F_OK) == 0 ||
        snprintf(file, sizeof file, "scenes/%s.yaml", name) >= (int)sizeof file)
        return name;
    const char *found = cli_share_path(path, size, file);
    return found != NULL ? found : name;
}

enum { MOST_SCENES = 64 };

static int by_letters(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* those in share/pellicle/scenes, by letters; their number */
static size_t list_scenes(const char **pointers, size_t room)
{
    static char names[MOST_SCENES][PEL_NAME_SIZE];
    char folder[4096];
    size_t count = 0;
    const char *found = cli_share_path(folder, sizeof folder, "scenes");
    DIR *list = found != NULL ? opendir(found) : NULL;
    for (struct dirent *entry; list != NULL && count < room && (entry = readdir(list)) != NULL;) {
        const char *dot = strrchr(entry->d_name, '.');
        if (dot == NULL || strcmp(dot, ".yaml") != 0)
            continue;
        snprintf(names[count], sizeof names[count], "%.*s", (int)(dot - entry->d_name), entry->d_name);
        pointers[count] = names[count];
        count++;
    }
    if (list != NULL)
        closedir(list);
    qsort(pointers, count, sizeof *pointers, by_letters);
    return count;
}

void cli_suggest_scene(pel_error *error, const char *name)
{
    const char *scenes[MOST_SCENES], *dot = strchr(name, '.');
    char own[PEL_NAME_SIZE];
    snprintf(own, sizeof own, "%.*s", dot != NULL ? (int)(dot - name) : (int)strlen(name), name);
    bool is_name = strchr(name, '/') == NULL && (dot == NULL || strcmp(dot, ".yaml") == 0);
    size_t count = is_name && error->status == PEL_BAD_FILE ? list_scenes(scenes, MOST_SCENES) : 0;
    const char *nearest = pel_nearest_name(own, scenes, count);
    if (nearest != NULL)
        snprintf(error->remedy, sizeof error->remedy, "did you mean the installed scene '%s'?", nearest);
    if (nearest != NULL || count == 0)
        return;
    const size_t room = sizeof error->remedy;
    size_t i = 0, length = (size_t)snprintf(error->remedy, room, "give the path of a file, or an installed scene:");
    for (; i < count && length + strlen(scenes[i]) + strlen(" ,...") + 1 < room; i++)
        length += (size_t)snprintf(error->remedy + length, room - length, "%s %s", i > 0 ? "," : "", scenes[i]);
    if (i < count)
        snprintf(error->remedy + length, room - length, "...");
}
