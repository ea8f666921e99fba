/* pellicle live: a scene, or a mesh with a scene that suits it, on a page that a browser shows. */
#define _DEFAULT_SOURCE /* flock */
#define _XOPEN_SOURCE 700
#include "commands.h"
#include "diagnostics.h"
#include "stop.h"

#include <pellicle/geometry.h>
#include <pellicle/import.h>

#ifndef PELLICLE_LIVE

int cli_live(const cli_call *call)
{
    (void)call;
    return cli_complain("this program was built without a server. build it with -DPELLICLE_LIVE=ON");
}

#else

#include <pellicle/server.h>

#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PATH_SIZE = 4096, SCENE_SIZE = 2 * PATH_SIZE + 1024 };

/* ---- the scene of a mesh ---- */

/* a path between double quotes of YAML */
static bool quote(const char *path, char *out, size_t size)
{
    size_t length = 0;
    for (; *path != '\0'; path++) {
        if (length + 3 > size || (unsigned char)*path < ' ')
            return false;
        if (*path == '"' || *path == '\\')
            out[length++] = '\\';
        out[length++] = *path;
    }
    out[length] = '\0';
    return true;
}

/* of a shell, of the diagonal */
static const double THICKNESS = 0.01;

static double diagonal_of(const pel_mesh *mesh)
{
    double low[3], high[3], squared = 0;
    pel_mesh_box(mesh, low, high);
    for (int i = 0; i < 3; i++)
        squared += (high[i] - low[i]) * (high[i] - low[i]);
    return sqrt(squared);
}

/* Tissue fills the mesh (paper A): springs on the edges, and each vertex is pulled back to its rest position, as
   strongly as on the paper's sphere of 252 vertices for any mesh. A shell is a sheet of rubber, 1/100 of the diagonal
   thick. */
static bool write_scene(const pel_mesh *mesh, const char *path, bool shell, char *text)
{
    char name[PATH_SIZE * 2];
    if (!quote(path, name, sizeof name))
        return false;
    static const char tissue[] = "    mass: { total: 1 }\n    scale_with_area: true\n"
                                 "    springs: { stiffness: 3, damping: 0.01 }\n"
                                 "    volumetric: { stiffness: 1.5, damping: 0.01 }\n"
                                 "solver: { method: quasi-static, dt: 0.01 }\n";
    const char *slash = strrchr(path, '/');
    int length = snprintf(text, SCENE_SIZE,
                          "version: 1\ntitle: \"%.200s\"\nbodies:\n  - name: body\n    mesh: { file: \"%s\" }\n",
                          slash != NULL ? slash + 1 : path, name);
    if (!shell)
        length += snprintf(text + length, SCENE_SIZE - (size_t)length, "%s", tissue);
    else
        length += snprintf(text + length, SCENE_SIZE - (size_t)length,
                           "    membrane: { preset: rubber, thickness: %.6g }\n    bending: { model: hinge }\n"
                           "    mass: { density: 1000 }\n"
                           "solver: { method: xpbd, dt: 0.01, substeps: 20, second_order: false, drag: 2 }\n",
                           THICKNESS * diagonal_of(mesh));
    snprintf(text + length, SCENE_SIZE - (size_t)length, "duration: 60\n");
    return true;
}

/* m: a larger body is probably in millimetres, as in the warning of runs */
static const double LARGE_BODY = 20;

/* says so if the scene's body is that large */
static void note_size(const cli_call *call, const pel_scene *scene)
{
    const double size = diagonal_of(scene->model.bodies[0].mesh);
    if (cli_has(call, "quiet") || !(size > LARGE_BODY))
        return;
    fprintf(stderr, "note: '%s' is %.4g m across. if it is in millimetres, add --set bodies.body.mesh.scale=0.001",
            call->arguments[0], size);
    if (cli_has(call, "shell"))
        fprintf(stderr, " --set bodies.body.membrane.thickness=%.4g", THICKNESS * 0.001 * size);
    fputc('\n', stderr);
}

/* reports a mesh that cannot be simulated, with the command that repairs it */
static int load_mesh(const cli_call *call, const char *const *settings, int setting_count, pel_scene **scene)
{
    const char *path = call->arguments[0];
    char full[PATH_SIZE], text[SCENE_SIZE];
    int status = CLI_DONE;
    pel_error error;
    pel_mesh *mesh = cli_read_mesh(path, &cli_notes, NULL, &status);
    if (mesh == NULL)
        return status;
    bool written = realpath(path, full) != NULL && write_scene(mesh, full, cli_has(call, "shell"), text);
    pel_mesh_destroy(mesh);
    if (!written)
        return cli_complain("the name of '%s' is too long or holds control characters", path);
    if (pel_scene_parse(path, text, strlen(text), settings, setting_count, NULL, scene, &error) != PEL_OK)
        return cli_report(&error);
    note_size(call, *scene);
    return CLI_DONE;
}

static int load(const cli_call *call, const char *const *settings, int setting_count, pel_scene **scene)
{
    const char *path = call->arguments[0];
    pel_error error;
    if (pel_mesh_format_of_path(path) != PEL_FORMAT_AUTO)
        return load_mesh(call, settings, setting_count, scene);
    if (cli_has(call, "shell"))
        return cli_complain("--shell is for a mesh, and '%s' is a scene: give its body a membrane", path);
    bool done = pel_scene_load(path, settings, setting_count, &cli_notes, scene, &error) == PEL_OK;
    if (!done)
        cli_suggest_scene(&error, path);
    return done ? CLI_DONE : cli_report(&error);
}

/* ---- the server ---- */

typedef struct serving {
    const cli_call *call;
    pid_t opener;        /* the process that opens the browser; 0 = none is left */
    char way[PATH_SIZE]; /* a file that leads the browser to the address; "" = none */
} serving;

/* Starts the browser of the desktop, which may run in the foreground: the server does not wait for it. */
static pid_t open_browser(const char *path)
{
    pid_t child = fork();
    if (child != 0)
        return child;
    setsid();
    if (freopen("/dev/null", "w", stdout) != NULL && freopen("/dev/null", "w", stderr) != NULL)
        execlp("xdg-open", "xdg-open", path, (char *)NULL);
    _exit(127);
}

/* All users see the words of a process, and the address has the token: the browser gets a file, which only this user
   can read. */
static bool write_way(const char *address, char *path, size_t size)
{
    const char *folder = getenv("XDG_RUNTIME_DIR");
    if (folder == NULL || access(folder, W_OK) != 0)
        folder = "/tmp";
    bool fits = snprintf(path, size, "%s/pellicle-XXXXXX", folder) + (int)sizeof "/live.html" < (int)size;
    char *made = fits ? mkdtemp(path) : NULL;
    if (made == NULL) {
        path[0] = '\0';
        return false;
    }
    strcat(path, "/live.html");
    int descriptor = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    bool written =
        descriptor >= 0 && dprintf(descriptor,
                                   "<!doctype html>\n<meta charset=\"utf-8\">\n<title>Pellicle live</title>\n"
                                   "<meta http-equiv=\"refresh\" content=\"0;url=%s\">\n",
                                   address) > 0;
    if (descriptor >= 0)
        close(descriptor);
    return written;
}

/* with its folder */
static void remove_way(char *path)
{
    if (path[0] == '\0')
        return;
    unlink(path);
    *strrchr(path, '/') = '\0';
    rmdir(path);
}

static void note_no_browser(void)
{
    fputs("note: no browser could be opened. open the address yourself\n", stderr);
}

static void tell_address(void *user, const char *address)
{
    serving *s = user;
    cli_catch_stop("");
    printf("live at %s\n", address);
    fflush(stdout);
    if (cli_has(s->call, "no-open"))
        return;
    s->opener = write_way(address, s->way, sizeof s->way) ? open_browser(s->way) : -1;
    if (s->opener < 0)
        note_no_browser();
}

/* ---- the kept session ---- */

/* FNV-1a (Fowler, Noll, Vo) */
static uint64_t hash_text(uint64_t hash, const char *text)
{
    for (; *text != '\0'; text++)
        hash = (hash ^ (unsigned char)*text) * UINT64_C(0x100000001b3);
    return hash;
}

/* $XDG_STATE_HOME/pellicle, with its parents; false if there is none */
static bool make_state_folder(char *path, size_t size)
{
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    bool is_set = state != NULL && state[0] == '/';
    int length = snprintf(path, size, "%s%s/pellicle", is_set ? state : home, is_set ? "" : "/.local/state");
    if ((!is_set && (home == NULL || home[0] != '/')) || length >= (int)size)
        return false;
    for (char *at = path + 1; *at != '\0'; at++)
        if (*at == '/') {
            *at = '\0';
            mkdir(path, 0700);
            *at = '/';
        }
    mkdir(path, 0700);
    return access(path, W_OK | X_OK) == 0;
}

/* The file that keeps the session of a scene with these texts at this place; false if there is none. It belongs to one
   process, which holds a lock until it ends. */
static bool find_kept(const cli_call *call, const pel_scene *scene, char *path, size_t size)
{
    char full[PATH_SIZE], lock[PATH_SIZE];
    const char *place = realpath(call->arguments[0], full) != NULL ? full : call->arguments[0];
    uint64_t hash = hash_text(hash_text(UINT64_C(0xcbf29ce484222325), place), pel_scene_text(scene));
    if (!make_state_folder(full, sizeof full) ||
        snprintf(path, size, "%s/live-%016" PRIx64 ".yaml", full, hash) >= (int)size ||
        snprintf(lock, sizeof lock, "%s.lock", path) >= (int)sizeof lock)
        return false;
    int descriptor = open(lock, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (descriptor < 0)
        return false;
    if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
        fputs("note: another 'pellicle live' keeps the session of this scene, so this one is not kept\n", stderr);
        close(descriptor);
        return false;
    }
    if (cli_has(call, "fresh"))
        unlink(path);
    return true;
}

/* takes leave of the opener once it has ended */
static bool is_wanted(void *user)
{
    serving *s = user;
    int status = 0;
    if (s->opener > 0 && waitpid(s->opener, &status, WNOHANG) == s->opener) {
        s->opener = 0;
        if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
            note_no_browser();
    }
    return !cli_stop_asked();
}

static int serve(const cli_call *call, const pel_scene *scene)
{
    char found[PATH_SIZE], kept[PATH_SIZE];
    pel_server_def def = pel_server_def_default();
    serving state = {.call = call};
    pel_error error;
    def.scene = scene;
    def.page = cli_value(call, "page");
    if (def.page == NULL)
        def.page = cli_share_path(found, sizeof found, "live.html");
    if (def.page == NULL)
        return cli_complain("the live page has not been built. build it once with 'make web' (it takes the Debian "
                            "packages nodejs and npm), then 'make install', or name it with --page");
    def.host = cli_value(call, "host");
    def.port = cli_count(call, "port");
    def.thread_count = cli_count(call, "threads");
    def.paused = cli_has(call, "paused");
    def.kept = find_kept(call, scene, kept, sizeof kept) ? kept : NULL;
    def.opened = tell_address;
    def.wanted = is_wanted;
    def.user = &state;
    def.log = cli_has(call, "quiet") ? NULL : &cli_notes;
    pel_status served = pel_serve(&def, &error);
    remove_way(state.way);
    if (served == PEL_OK)
        return CLI_DONE;
    pel_scene_locate(scene, &error);
    return cli_report(&error);
}

/* a page with the simulation in it */
static int write_page(const cli_call *call, const pel_scene *scene)
{
    char found[PATH_SIZE];
    const char *out = cli_value(call, "html"), *page = cli_value(call, "page");
    pel_error error;
    if (page == NULL)
        page = cli_share_path(found, sizeof found, "play.html");
    if (page == NULL)
        return cli_complain("the page that simulates has not been built. build it once with 'make wasm' (it takes the "
                            "Debian packages emscripten, nodejs and npm), then 'make install', or name it with --page");
    if (pel_page_write(out, page, scene, cli_has(call, "paused"), &error) != PEL_OK) {
        pel_scene_locate(scene, &error);
        return cli_report(&error);
    }
    if (!cli_has(call, "quiet"))
        printf("%s\n", out);
    return CLI_DONE;
}

int cli_live(const cli_call *given)
{
    char path[PATH_SIZE];
    cli_call named = *given;
    pel_scene *scene = NULL;
    named.arguments[0] = cli_scene_path(path, sizeof path, given->argument_count > 0 ? given->arguments[0] : "balloon");
    const char **settings = calloc((size_t)named.given_count + 1, sizeof *settings);
    if (settings == NULL) {
        cli_complain("out of memory");
        return CLI_FAILED;
    }
    int status = load(&named, settings, cli_values(&named, "set", settings), &scene);
    if (status == CLI_DONE)
        status = cli_value(&named, "html") != NULL ? write_page(&named, scene) : serve(&named, scene);
    pel_scene_destroy(scene);
    free(settings);
    return status;
}

#endif
