/* A page that has the simulation in it. The template has the mark below; in its place come a JSON object and, for each
   mesh, its file packed by zlib in base64 (web/src/live/play.js reads them):

       <script type="application/json" id="scene">{"scene":"...","files":["meshes/ball.ply"],"paused":false}</script>
       <script type="text/plain" class="mesh">...</script> */
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "io/json.h"
#include "pellicle/import.h"
#include "pellicle/mesh_io.h"
#include "pellicle/server.h"
#include "report/report_pack.h"
#include "scene/portable.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* the number is the format version of web/src/live/play.js */
static const char mark[] = "<!--pellicle scene, format 1-->";
static const char mark_start[] = "<!--pellicle scene";
enum { NAME_SIZE = 512, PATH_SIZE = 4096 };

typedef struct page {
    const pel_scene *scene;
    int32_t count;            /* meshes, each file once for each time that the scene names it */
    char (*names)[NAME_SIZE]; /* (count) in the page */
    const char **name_list;   /* (count) into names */
    pel_report_pack *packs;   /* (count) open for the first of equal names only */
} page;

/* ---- meshes ---- */

/* the index of the first mesh of the same file */
static int32_t first_use(const pel_scene *scene, int32_t m)
{
    int32_t first = 0;
    while (strcmp(scene->mesh_files[first], scene->mesh_files[m]) != 0)
        first++;
    return first;
}

static bool is_foreign(const char *path)
{
    return pel_mesh_format_of_path(path) == PEL_FORMAT_AUTO;
}

/* meshes/NAME; where another file has that name, meshes/2-NAME */
static void name_mesh(page *p, int32_t m)
{
    const char *path = p->scene->mesh_files[m], *slash = strrchr(path, '/');
    const char *name = slash != NULL ? slash + 1 : path, *end = is_foreign(path) ? ".ply" : "";
    char prefix[16] = "";
    int32_t first = first_use(p->scene, m);
    if (first < m) {
        memcpy(p->names[m], p->names[first], NAME_SIZE);
        return;
    }
    for (int32_t number = 2, other = 0; other < m; other++) {
        snprintf(p->names[m], NAME_SIZE, "meshes/%s%.400s%s", prefix, name, end);
        if (strcmp(p->names[other], p->names[m]) == 0) {
            snprintf(prefix, sizeof prefix, "%d-", (int)number++);
            other = -1;
        }
    }
    snprintf(p->names[m], NAME_SIZE, "meshes/%s%.400s%s", prefix, name, end);
}

/* the bytes of a mesh that the module cannot read, as PLY: written next to the page and removed again */
static pel_status convert(const char *path, const char *beside, char **bytes, size_t *size, pel_error *error)
{
    char passing[PATH_SIZE];
    pel_mesh *mesh = NULL;
    if (snprintf(passing, sizeof passing, "%s.%ld.ply", beside, (long)getpid()) >= (int)sizeof passing)
        return pel_fail(error, PEL_BAD_FILE, "the name of the page is too long");
    pel_status status = pel_mesh_import(path, NULL, &mesh, error);
    if (status == PEL_OK)
        status = pel_mesh_write(passing, PEL_FORMAT_PLY, mesh, NULL, error);
    pel_mesh_destroy(mesh);
    if (status == PEL_OK)
        status = pel_file_read(passing, bytes, size, error);
    (void)remove(passing);
    return status;
}

static pel_status pack_mesh(page *p, int32_t m, const char *beside, pel_error *error)
{
    const char *path = p->scene->mesh_files[m];
    char *bytes = NULL;
    size_t size = 0;
    pel_status status =
        is_foreign(path) ? convert(path, beside, &bytes, &size, error) : pel_file_read(path, &bytes, &size, error);
    if (status == PEL_OK)
        status = pel_report_pack_open(&p->packs[m], SIZE_MAX, error);
    if (status == PEL_OK)
        status = pel_report_pack_add(&p->packs[m], bytes, size, error);
    if (status == PEL_OK)
        status = pel_report_pack_close(&p->packs[m], error);
    pel_free(bytes);
    return status;
}

static pel_status pack_meshes(page *p, const char *beside, pel_error *error)
{
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(p->names, p->count), PEL_ROOM(p->name_list, p->count), PEL_ROOM(p->packs, p->count)))
        return pel_fail_memory(error);
    pel_status status = PEL_OK;
    for (int32_t m = 0; status == PEL_OK && m < p->count; m++) {
        name_mesh(p, m);
        p->name_list[m] = p->names[m];
        if (first_use(p->scene, m) == m)
            status = pack_mesh(p, m, beside, error);
    }
    return status;
}

static void free_page(page *p)
{
    for (int32_t m = 0; p->packs != NULL && m < p->count; m++)
        pel_report_pack_free(&p->packs[m]);
    PEL_FREE_ALL(p->packs, p->name_list, p->names);
}

/* ---- the page ---- */

/* refuse invalid scenes here, not in the browser */
static pel_status try_scene(const pel_scene *scene, pel_error *error)
{
    pel_model *model = NULL;
    pel_sim *sim = NULL;
    pel_session *session = NULL;
    pel_status status = pel_model_create(&scene->model, &model, error);
    pel_sim_def def = scene->sim;
    def.model = model;
    def.thread_count = 1;
    if (status == PEL_OK)
        status = pel_sim_create(&def, &sim, error);
    if (status == PEL_OK)
        status = pel_session_create(scene, sim, &session, error);
    pel_session_destroy(session);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    return status;
}

static pel_status read_template(const char *path, char **text, size_t *size, const char **place, pel_error *error)
{
    pel_status status = pel_file_read(path, text, size, error);
    if (status == PEL_BAD_FILE)
        pel_fail_remedy(error, "build the page once with 'make wasm', which needs emscripten and Node.js");
    if (status != PEL_OK)
        return status;
    *place = strstr(*text, mark);
    if (*place != NULL)
        return PEL_OK;
    pel_fail(error, PEL_BAD_FORMAT, "%s",
             strstr(*text, mark_start) != NULL ? "the page is of another version of pellicle"
                                               : "this is not a page that simulates");
    pel_fail_remedy(error, "build the page again with 'make wasm'");
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_FORMAT;
}

static pel_status describe(const page *p, bool paused, pel_json *json, pel_error *error)
{
    char *text = pel_scene_portable_text(p->scene, p->name_list);
    if (text == NULL)
        return pel_fail_memory(error);
    pel_json_open(json, NULL, '{');
    pel_json_text(json, "scene", text);
    pel_free(text);
    pel_json_open(json, "files", '[');
    for (int32_t m = 0; m < p->count; m++)
        if (first_use(p->scene, m) == m)
            pel_json_text(json, NULL, p->names[m]);
    pel_json_close(json, ']');
    pel_json_bool(json, "paused", paused);
    pel_json_close(json, '}');
    return json->failed ? pel_fail_memory(error) : PEL_OK;
}

static pel_status write_page(const page *p, const char *path, const pel_json *json, const char *text, size_t size,
                             const char *place, pel_error *error)
{
    pel_file_writer writer;
    pel_status status = pel_file_writer_open(&writer, path, error);
    if (status != PEL_OK)
        return status;
    const char *rest = place + strlen(mark);
    pel_file_writer_write(&writer, text, (size_t)(place - text));
    pel_file_writer_printf(&writer, "<script type=\"application/json\" id=\"scene\">");
    pel_file_writer_write(&writer, json->text, json->length);
    pel_file_writer_printf(&writer, "</script>\n");
    for (int32_t m = 0; m < p->count; m++)
        if (first_use(p->scene, m) == m) {
            pel_file_writer_printf(&writer, "<script type=\"text/plain\" class=\"mesh\">");
            pel_report_pack_write_base64(&p->packs[m], &writer);
            pel_file_writer_printf(&writer, "</script>\n");
        }
    pel_file_writer_write(&writer, rest, size - (size_t)(rest - text));
    return pel_file_writer_commit(&writer, error);
}

pel_status pel_page_write(const char *path, const char *template_path, const pel_scene *scene, bool paused,
                          pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(template_path, error);
    PEL_REFUSE_NULL(scene, error);
    page p = {.scene = scene, .count = scene->mesh_file_count};
    pel_json json = {0};
    char *text = NULL;
    const char *place = NULL;
    size_t size = 0;
    pel_status status = read_template(template_path, &text, &size, &place, error);
    if (status == PEL_OK)
        status = try_scene(scene, error);
    if (status == PEL_OK)
        status = pack_meshes(&p, path, error);
    if (status == PEL_OK)
        status = describe(&p, paused, &json, error);
    if (status == PEL_OK)
        status = write_page(&p, path, &json, text, size, place, error);
    pel_json_free(&json);
    free_page(&p);
    pel_free(text);
    return status;
}
