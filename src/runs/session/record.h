/* The record of a session. Commands between two steps are recorded as lines of words, and a replay executes the same
   lines at the same steps: so it has the bits of the session by construction. Undo truncates the record at the restored
   state. */
#ifndef PEL_SESSION_RECORD_H
#define PEL_SESSION_RECORD_H

#include "session/command.h"

typedef struct pel_session_event {
    int64_t step; /* before which it acts */
    bool is_move;
    char *line;
} pel_session_event;

/* zeros at the start */
typedef struct pel_session_events {
    pel_session_event *events; /* (count) */
    size_t count, room;
} pel_session_events;

void pel_session_events_clear(pel_session_events *events);
/* Forgets the events from a number on. */
void pel_session_events_cut(pel_session_events *events, size_t count);
/* Room for a further event with any line, before its command is executed: *line is to be added or freed.
   PEL_OUT_OF_MEMORY. */
pel_status pel_session_events_reserve(pel_session_events *events, const pel_command *command, char **line,
                                      pel_error *error);
/* Adds a command; of the moves before a step the last one counts. line: reserved for it. */
void pel_session_events_add(pel_session_events *events, int64_t step, const pel_command *command, char *line);

/* Lines "STEP COMMAND", and the text of a scene that has these as its session and lasts for `duration` [s]; free them
   with pel_free. PEL_OUT_OF_MEMORY. */
pel_status pel_session_events_lines(const pel_session_events *events, char **text, pel_error *error);
pel_status pel_session_events_scene(const pel_session_events *events, const char *scene, double duration, char **text,
                                    pel_error *error);

#endif
