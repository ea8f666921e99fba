/* Pellicle: a session, which is a simulation under a hand: commands in words between its steps, undo and reset, and a
   record that a scene can hold and `pellicle run` repeats to the bit. In the library pellicle_scene.

       pel_session_create(scene, sim, &session, &error);
       pel_session_apply(session, "grab 0 0 1  0 0 -1  50 0.05", &error);
       pel_session_apply(session, "move 0 0 0.3", &error);
       pel_session_step(session, &error);

   A command is one line: a word and its values, separated by single or several spaces. SI units.

       set PATH VALUE                     a parameter as in pel_set_parameter_text
       grab OX OY OZ DX DY DZ K REACH     take hold where the ray from O along D meets a body: spring K [N/m], vertices
                                          within REACH [m]
       press SHAPE R X Y Z QX QY QZ QW    a tool at a place [m] with a rotation; SHAPE sphere, box (half edge R),
                                          capsule (radius R, half length 2 R); where the scene has contact a mesh that
                                          the sphere of radius R holds: torus, cylinder, blend, or a mesh file with
                                          %20 for spaces, relative to the folder of the scene (absolute in the record)
       move X Y Z                         where the hand goes [m]: end of the spring, or the tool
       release                            lets go
       pin OX OY OZ DX DY DZ REACH        hold the vertices within REACH [m] of the hit where they are
       unpin OX OY OZ DX DY DZ REACH      release them
       inflate BODY P                     pressure [Pa] along the normals of a body, beside the scene's own
       mark                               begin of an interaction: undo goes back to here

   One thread uses a session at a time. */
#ifndef PELLICLE_SESSION_H
#define PELLICLE_SESSION_H

#include "live.h"
#include "scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* longest command, terminating zero included */
enum { PEL_SESSION_LINE = 512 };

typedef struct pel_session pel_session;

typedef enum pel_hand_kind { PEL_HAND_FREE, PEL_HAND_GRAB, PEL_HAND_PRESS } pel_hand_kind;

/* What the hand does. */
typedef struct pel_hand_reading {
    pel_hand_kind kind;
    pel_tool_shape shape; /* of a tool that presses */
    double radius;        /* m, likewise */
    double point[3];      /* m, where the surface is held, or the tool is */
    double rotation[4];   /* of the tool */
    double target[3];     /* m, where it is to go */
    double force[3];      /* N: of the hand's spring on the surface, of the tool on what it touches */
} pel_hand_reading;

/* A session over a simulation that was made from the scene and has done no step; both must outlive it. Takes the
   snapshot that reset goes back to. PEL_BAD_SCENE where the scene has a `session` with a line that is not a command;
   PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_session_create(const pel_scene *scene, pel_sim *sim, pel_session **session, pel_error *error);
PEL_API void pel_session_destroy(pel_session *session);

/* Does a command and records it. PEL_BAD_ARGUMENT says which word is wrong, and what else the functions of
   pellicle/live.h return; neither simulation nor record has changed then. A ray that meets no body is no error:
   nothing is done. */
PEL_API pel_status pel_session_apply(pel_session *session, const char *line, pel_error *error);

/* Moves the hand and does a step. After PEL_DIVERGED the session is back at the last mark (or the start), with its
   hand free; the error says so. */
PEL_API pel_status pel_session_step(pel_session *session, pel_error *error);

/* Back to the last mark, or to the start; the hand is free, and the record ends there. *done false: no mark is left. */
PEL_API pel_status pel_session_undo(pel_session *session, bool *done, pel_error *error);
PEL_API pel_status pel_session_reset(pel_session *session, pel_error *error);

PEL_API void pel_session_get_hand(const pel_session *session, pel_hand_reading *reading);
/* The mesh of the tool that presses, about the tool's own origin [m]; null where it is none. Lives until the hand is
   free. */
PEL_API const pel_mesh *pel_session_tool_mesh(const pel_session *session);
/* marks that undo can go back to */
PEL_API int32_t pel_session_undo_count(const pel_session *session);
/* 1 for the vertices of a body's mesh that are pinned now, else 0: (*count, the vertices of the mesh); lives until the
   next command. */
PEL_API const unsigned char *pel_session_pins(const pel_session *session, int32_t body, int32_t *count);
/* Pa, of `inflate` */
PEL_API double pel_session_pressure(const pel_session *session, int32_t body);

/* The record, lines "STEP COMMAND"; free it with pel_session_free_text. PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_session_record(const pel_session *session, char **text, pel_error *error);
/* A scene that repeats the session up to now: that of the session with the record as `session`. Free as above. */
PEL_API pel_status pel_session_scene(const pel_session *session, char **text, pel_error *error);
PEL_API void pel_session_free_text(char *text);

/* Does what the scene's own `session` says for the present step; before each pel_session_step. PEL_BAD_SCENE with the
   line that cannot be repeated. */
PEL_API pel_status pel_session_repeat(pel_session *session, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
