/* Pellicle: live simulations in a browser. Either a program steps the simulation and serves the page by HTTP, with one
   WebSocket for the frames and the user's commands, or the page itself contains the simulation. In the library
   pellicle_live. */
#ifndef PELLICLE_SERVER_H
#define PELLICLE_SERVER_H

#include "session.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pel_server_def {
    const pel_scene *scene;
    const char *page; /* path of the page, one file */
    /* IPv4 address of an interface; null = 127.0.0.1, reachable only from this machine; 0.0.0.0 = all interfaces */
    const char *host;
    int32_t port;         /* 0 = any free port */
    int32_t thread_count; /* 0 = as in the scene */
    bool paused;          /* true: wait for the user; false: start when the first page connects */
    /* Path of a file that keeps the session as a scene, null = none. It is written at most 0.5 s after each step and
       command, so a crash loses no more, and removed while nothing is recorded. If it is there at the start, the server
       first repeats it, as fast as the machine can, to the same bits. For one server at a time. */
    const char *kept;
    /* Called once, when the server accepts connections, with "http://127.0.0.1:PORT/?token=TOKEN". Nullable. */
    void (*opened)(void *user, const char *address);
    /* Called about ten times a second; returning false ends the server. Nullable. */
    bool (*wanted)(void *user);
    void *user;
    const pel_log *log; /* receives refused steps and commands; nullable */
    uint32_t cookie;    /* set by pel_server_def_default */
} pel_server_def;

PEL_API pel_server_def pel_server_def_default(void);

/* Serves the scene until `wanted` returns false. The simulation steps in its own thread, in real time or, if that is
   not possible, as fast as the machine can. Requests need the token; requests with another Host or from another Origin
   are refused with status 403. PEL_BAD_FILE (the page cannot be read; the port is in use), errors of pel_model_create
   and pel_sim_create, PEL_BAD_ARGUMENT, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_serve(const pel_server_def *def, pel_error *error);

/* Writes a page, one file, that simulates the scene in the browser without a program or a server. `template_path` is
   the page play.html of `make wasm`, which contains the library as WebAssembly. The page contains the scene and its
   meshes without absolute paths: meshes keep their file names, and meshes in formats that assimp reads become PLY.
   paused: the page waits for the user to start the simulation. PEL_BAD_FILE (template, meshes, path), PEL_BAD_FORMAT
   (the template is another file), PEL_OUT_OF_MEMORY, errors of pel_model_create and pel_sim_create. After an error
   nothing is written.
 */
PEL_API pel_status pel_page_write(const char *path, const char *template_path, const pel_scene *scene, bool paused,
                                  pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
