/* Messages to the pages. Text messages are JSON objects with `type`; binary ones are a length (uint32, little-endian),
   a JSON object of that length, spaces up to a multiple of 4, and the arrays that it describes. web/src/live/wire.js
   reads them. */
#ifndef PEL_LIVE_MESSAGE_H
#define PEL_LIVE_MESSAGE_H

#include "pellicle/session.h"

/* how the simulation runs, for the head of a frame */
typedef struct pel_pace {
    bool playing;
    double pace;    /* simulated over real time */
    double step_ms; /* of a step, mean */
    double serving; /* share of the thread's time that is not stepping */
    uint32_t echo;  /* of the newest `echo` command */
    bool measures;  /* whether measures and ledger follow */
} pel_pace;

/* Each returns a new message (pel_allocate), null when out of memory. */
/* path: of the scene's file, "" = it came as text */
unsigned char *pel_message_hello(const pel_scene *scene, const char *path, pel_sim *sim, size_t *size);
unsigned char *pel_message_parameters(const pel_sim *sim, const pel_session *session, const pel_scene *scene,
                                      size_t *size);
/* field -1 = none */
unsigned char *pel_message_frame(pel_sim *sim, const pel_session *session, int32_t field, const pel_pace *pace,
                                 size_t *size);
/* text: time, step, hash, hand, tools and measures */
unsigned char *pel_message_summary(pel_sim *sim, const pel_session *session, size_t *size);
unsigned char *pel_message_surface(const pel_sim *sim, const pel_session *session, size_t *size);
unsigned char *pel_message_scene(const char *text, size_t *size);
unsigned char *pel_message_notice(const char *kind, const char *text, size_t *size);

#endif
