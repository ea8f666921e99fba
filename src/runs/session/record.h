/* The record of a session. Commands between two steps are recorded as lines of words, and a replay executes the same
   lines at the same steps: so it has the bits of the session by construction. Undo truncates the record at the restored
   state. */
#ifndef PEL_SESSION_RECORD_H
#define PEL_SESSION_RECORD_H

#include "session/command.h"

/* As the items of `session` in a scene, `  - "STEP COMMAND"` and a newline each: hours of use take the bytes of this
   text and no more. Zeros at the start. */
typedef struct pel_session_events {
    char *text; /* (length) not zero-terminated */
    size_t length, room;
    size_t unchanged; /* bytes that are as they were when it was last set to `length` */
} pel_session_events;

void pel_session_events_clear(pel_session_events *events);
/* Forgets the events from a length on. */
void pel_session_events_cut(pel_session_events *events, size_t length);
/* Room for a further event, before its command is executed. PEL_BAD_ARGUMENT if the record is full; PEL_OUT_OF_MEMORY.
 */
pel_status pel_session_events_reserve(pel_session_events *events, const pel_command *command, pel_error *error);
/* Adds a command, for which there is room; of the moves before a step the last one counts. */
void pel_session_events_add(pel_session_events *events, int64_t step, const pel_command *command);
/* Those of a session, for the file that keeps them. */
pel_session_events *pel_session_record_of(pel_session *session);

/* Lines "STEP COMMAND", and the text of a scene that ends with these as its session and lasts for `duration` [s]; free
   them with pel_free. PEL_OUT_OF_MEMORY. */
pel_status pel_session_events_lines(const pel_session_events *events, char **text, pel_error *error);
pel_status pel_session_events_scene(const pel_session_events *events, const char *scene, double duration, char **text,
                                    pel_error *error);

#endif
