/* Pellicle: a simulation in a browser: served by a program, or inside the page. A page is served by HTTP; one WebSocket
   carries the frames and the commands of the user. In the library pellicle_live, which is built where libwebsockets is
   installed. */
#ifndef PELLICLE_SERVER_H
#define PELLICLE_SERVER_H

#include "session.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pel_server_def {
    const pel_scene *scene;
    const char *page; /* path of the page, one file */
    /* IPv4 address of an interface; null = 127.0.0.1, which only this machine reaches; 0.0.0.0 = all */
    const char *host;
    int32_t port;         /* 0 = any that is free */
    int32_t thread_count; /* 0 = as the scene says */
    bool paused;          /* does not begin when the first page comes */
    /* Called once when browsers can come: "http://127.0.0.1:PORT/?token=TOKEN". Nullable. */
    void (*opened)(void *user, const char *address);
    /* Asked about ten times a second; false ends the server. Nullable. */
    bool (*wanted)(void *user);
    void *user;
    const pel_log *log; /* refused steps and commands; nullable */
    uint32_t cookie;    /* set by pel_server_def_default */
} pel_server_def;

PEL_API pel_server_def pel_server_def_default(void);

/* Serves the scene until `wanted` returns false. The simulation steps in its own thread, in real time or as fast as it
   can. Requests need the token; those with another Host or a foreign Origin are refused with status 403. PEL_BAD_FILE
   (the page cannot be read; the port is taken, with the remedy), errors of pel_model_create and pel_sim_create,
   PEL_BAD_ARGUMENT, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_serve(const pel_server_def *def, pel_error *error);

/* Writes a page of one file that simulates the scene in the browser, without a program or a server: `template_path` is
   the page play.html of `make wasm`, which has the library as WebAssembly; scene and meshes are embedded, without
   absolute paths: meshes keep their file names, and meshes that assimp reads become PLY. paused: the page waits for the
   user to start it. PEL_BAD_FILE (template, meshes, path), PEL_BAD_FORMAT (no such template), PEL_OUT_OF_MEMORY, errors
   of pel_model_create and pel_sim_create; nothing is written then. */
PEL_API pel_status pel_page_write(const char *path, const char *template_path, const pel_scene *scene, bool paused,
                                  pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
