/* Pellicle: sessions. A session is an interactive simulation, with text commands between steps, undo and reset. It
   records its commands; a scene can contain this record, and `pellicle run` repeats it bit for bit. In the library
   pellicle_scene.

       pel_session_create(scene, sim, &session, &error);
       pel_session_apply(session, "grab 0 0 1  0 0 -1  50 0.05", &error);
       pel_session_apply(session, "move 0 0 0.3", &error);
       pel_session_step(session, &error);

   A command is one line: a word and its values, separated by one or more spaces. SI units.

       set PATH VALUE                     a parameter as in pel_set_parameter_text
       grab OX OY OZ DX DY DZ K REACH     grasp a body where the ray from O along D meets it: spring K [N/m], vertices
                                          within REACH [m]
       grasp OX OY OZ DX DY DZ REACH ANEW
                                          forceps: hold one connected patch of the surface within REACH [m] of
                                          where the ray meets it, and go where `move` asks. Forceps of the scene
                                          that lead a tear (pel_tool_def) let go then and leave; with ANEW 1 those
                                          of the hand grasp the flap anew behind the tip as they did, with 0 they
                                          hold what they have
       press SHAPE R X Y Z QX QY QZ QW    a tool at a position [m] with a rotation (unit quaternion). SHAPE: sphere, box
                                          (half edge R), capsule (radius R, half length 2 R), blade and hook (edge from
                                          -R to R along its z axis), scissors (blades from X Y Z, 2 R along x, that
                                          open to -R and R along z, close within 0.25 s and leave), with R [m]. If the
                                          scene has contact, also a mesh, scaled to fit into the sphere of radius R:
                                          torus, cylinder, blend, or a mesh file with %20 for spaces, relative to the
                                          folder of the scene (absolute in the record)
       move X Y Z                         target of the hand [m]: end of the spring, or the tool
       release                            release the surface
       pin OX OY OZ DX DY DZ REACH        fix the vertices within REACH [m] of the hit at their positions
       unpin OX OY OZ DX DY DZ REACH      release them
       inflate BODY P                     pressure [Pa] along the normals of a body, in addition to that of the scene
       cut OX OY OZ DX DY DZ              the first one sets a blade on the surface, further ones lead it there: the
                                          surface opens along its edges (pellicle/tear.h) until `release`
       mark                               start of an interaction: undo returns here

   One thread uses a session at a time. */
#ifndef PELLICLE_SESSION_H
#define PELLICLE_SESSION_H

#include "live.h"
#include "scene.h"
#include "tear.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Sizes in bytes: of the longest command, including the terminating zero; of all commands that a session records, as a
   scene has them (which can be read: it has a million values at most). */
enum { PEL_SESSION_LINE = 512, PEL_SESSION_RECORD = 12 << 20 };

typedef struct pel_session pel_session;

typedef enum pel_hand_kind { PEL_HAND_FREE, PEL_HAND_GRAB, PEL_HAND_PRESS, PEL_HAND_CUT, PEL_HAND_GRASP } pel_hand_kind;

/* State of the hand: the spring of `grab`, the tool of `press` or `grasp`, or the blade of `cut` that the user moves.
 */
typedef struct pel_hand_reading {
    pel_hand_kind kind;
    pel_tool_shape shape; /* of the tool */
    double radius;        /* m, of the tool; of forceps how far from their place they hold */
    double point[3];      /* m, the held point, or the position of the tool */
    double rotation[4];   /* of the tool */
    double target[3];     /* m, its target */
    double force[3];      /* N: of the hand's spring on the surface, or of the tool on the bodies */
} pel_hand_reading;

/* Creates a session for a simulation of the scene, before its first step; scene and simulation must outlive it. Takes
   the snapshot for reset. PEL_BAD_SCENE if a line of the scene's `session` is not a command; PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_session_create(const pel_scene *scene, pel_sim *sim, pel_session **session, pel_error *error);
PEL_API void pel_session_destroy(pel_session *session);

/* Executes and records a command. PEL_BAD_ARGUMENT names the wrong word, or says that PEL_SESSION_RECORD bytes are
   recorded, when only `release` and `mark` are executed; other errors are those of pellicle/live.h.
   Errors leave simulation and record unchanged. A ray that meets no body is no error and has no effect. */
PEL_API pel_status pel_session_apply(pel_session *session, const char *line, pel_error *error);

/* Moves the hand and takes a step. PEL_DIVERGED returns the session to the last mark (or the start) with a free hand;
   the error says so. */
PEL_API pel_status pel_session_step(pel_session *session, pel_error *error);

/* Returns to the last mark, or to the start; frees the hand and truncates the record. *done false: no mark remains. */
PEL_API pel_status pel_session_undo(pel_session *session, bool *done, pel_error *error);
PEL_API pel_status pel_session_reset(pel_session *session, pel_error *error);

PEL_API void pel_session_get_hand(const pel_session *session, pel_hand_reading *reading);
/* The mesh of the pressing tool, relative to its origin [m]; null if it has none. Lives until the hand is free. */
PEL_API const pel_mesh *pel_session_tool_mesh(const pel_session *session);
/* Number of marks for undo. */
PEL_API int32_t pel_session_undo_count(const pel_session *session);
/* (*count, the vertices of the body's mesh) 1 for pinned vertices, otherwise 0; lives until the next command. */
PEL_API const unsigned char *pel_session_pins(const pel_session *session, int32_t body, int32_t *count);
/* Pressure of `inflate` [Pa]. */
PEL_API double pel_session_pressure(const pel_session *session, int32_t body);

/* The record, lines "STEP COMMAND"; free it with pel_session_free_text. PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_session_record(const pel_session *session, char **text, pel_error *error);
/* A scene that repeats the session to this point: its scene with the record as `session`. Free as above. */
PEL_API pel_status pel_session_scene(const pel_session *session, char **text, pel_error *error);
PEL_API void pel_session_free_text(char *text);

/* Executes the commands of the scene's `session` for the present step; call before each pel_session_step. PEL_BAD_SCENE
   with the line that cannot be repeated. */
PEL_API pel_status pel_session_repeat(pel_session *session, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
