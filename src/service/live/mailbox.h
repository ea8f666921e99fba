/* Exchange between the thread of the simulation and the thread of the server: messages to the pages (the newest of each
   kind) and lines from the pages. */
#ifndef PEL_LIVE_MAILBOX_H
#define PEL_LIVE_MAILBOX_H

#include "pellicle/base.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

/* kinds of messages, in the order in which a page needs them */
typedef enum pel_post_kind {
    PEL_POST_HELLO,      /* text: constant information */
    PEL_POST_PARAMETERS, /* text */
    PEL_POST_SURFACE,    /* binary: triangles and pins */
    PEL_POST_NOTICE,     /* text */
    PEL_POST_SCENE,      /* text: the session as a scene */
    PEL_POST_FRAME,      /* binary */
    PEL_POST_COUNT
} pel_post_kind;

enum {
    PEL_LINE_LIMIT = 1024,        /* lines that wait */
    PEL_MESSAGE_LIMIT = 8 << 20,  /* bytes of one */
    PEL_WAITING_LIMIT = 32 << 20, /* bytes of all that wait */
    PEL_FRAMES_UNDER_WAY = 2,
};

typedef struct pel_post {
    unsigned char *bytes;
    size_t size;
    uint32_t revision; /* 0 = none */
} pel_post;

typedef struct pel_mailbox {
    pthread_mutex_t lock;
    pthread_cond_t arrived; /* a line, a wish for a frame, or the end */
    pel_post posts[PEL_POST_COUNT];
    char *lines[PEL_LINE_LIMIT];
    int32_t line_count;
    size_t line_bytes;
    int64_t lost_lines;      /* that did not fit */
    atomic_int interrupting; /* lines of those that wait which stop the present stage */
    const char *stage;       /* present long stage, "" or null = none; a literal */
    double stage_at;         /* clock of its start */
    int32_t behind_stage;    /* lines that were taken and wait for it */
    bool stage_is_told;
    atomic_bool ended;        /* the simulation has to end */
    atomic_bool wanted;       /* a page waits for a frame */
    void (*ring)(void *user); /* wakes the server: there is a new message */
    void *user;
} pel_mailbox;

void pel_mailbox_create(pel_mailbox *box);
void pel_mailbox_destroy(pel_mailbox *box);

/* Messages that one page has received. */
typedef struct pel_mail_reader {
    uint32_t known[PEL_POST_COUNT]; /* revisions */
    uint32_t sent, received;        /* frames */
} pel_mail_reader;

/* ---- the simulation's side ---- */

/* Takes the ownership of bytes (pel_allocate); null is fine and does nothing. */
void pel_mailbox_post(pel_mailbox *box, pel_post_kind kind, unsigned char *bytes, size_t size);
/* The simulation begins something that may take long, or has ended it (null); behind: lines that it has taken and that
   come after it. */
void pel_mailbox_begin(pel_mailbox *box, const char *stage, int32_t behind);
/* Waits at most so long for lines; takes them (to be freed). Returns false at the end. */
bool pel_mailbox_wait(pel_mailbox *box, double seconds, char **lines, int32_t *count);

/* ---- the reader's side ---- */

/* Copies the first message that is due to *bytes + before (*bytes grows; *room is its size). Returns its kind, -1 when
   out of memory, and PEL_POST_COUNT when none is due: then it asks for a frame if the page can take one. A page with
   PEL_FRAMES_UNDER_WAY frames that it has not received gets no further one, so that no queue grows between the
   simulation and the eye. */
int pel_mailbox_take(pel_mailbox *box, pel_mail_reader *reader, size_t before, unsigned char **bytes, size_t *room,
                     size_t *size);
/* The page has a frame. */
void pel_mailbox_received(pel_mail_reader *reader);
/* Starts a reader without the notices and saved scenes of others. */
void pel_mailbox_welcome(pel_mailbox *box, pel_mail_reader *reader);

/* Takes the ownership of the line; null is fine and does nothing. Beyond PEL_LINE_LIMIT lines or PEL_WAITING_LIMIT
   bytes the line is lost. */
void pel_mailbox_line(pel_mailbox *box, char *line, bool interrupts);
/* The stage that began before this clock while lines wait, once for each; otherwise null. */
const char *pel_mailbox_find_busy(pel_mailbox *box, double before);
void pel_mailbox_want(pel_mailbox *box);
void pel_mailbox_end(pel_mailbox *box);

#endif
