/* What the thread of the simulation and that of the server exchange: messages to the pages, each kind with its newest
   one, and lines from the pages. */
#ifndef PEL_LIVE_MAILBOX_H
#define PEL_LIVE_MAILBOX_H

#include "pellicle/base.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

/* kinds of messages, in the order in which a page needs them */
typedef enum pel_post_kind {
    PEL_POST_HELLO,      /* text: what does not change */
    PEL_POST_PARAMETERS, /* text */
    PEL_POST_SURFACE,    /* binary: triangles and pins */
    PEL_POST_NOTICE,     /* text */
    PEL_POST_SCENE,      /* text: the session as a scene */
    PEL_POST_FRAME,      /* binary */
    PEL_POST_COUNT
} pel_post_kind;

enum {
    PEL_LINE_LIMIT = 1024,       /* lines that wait */
    PEL_MESSAGE_LIMIT = 8 << 20, /* bytes of one */
};

typedef struct pel_post {
    unsigned char *bytes;
    size_t size;
    uint32_t revision; /* 0 = there is none */
} pel_post;

typedef struct pel_mailbox {
    pthread_mutex_t lock;
    pthread_cond_t arrived; /* a line, a wish for a frame, or the end */
    pel_post posts[PEL_POST_COUNT];
    char *lines[PEL_LINE_LIMIT];
    int32_t line_count;
    int64_t lost_lines;       /* that did not fit */
    atomic_bool ended;        /* the simulation has to end */
    atomic_bool wanted;       /* a page waits for a frame */
    void (*ring)(void *user); /* wakes the server: there is a new message */
    void *user;
} pel_mailbox;

void pel_mailbox_create(pel_mailbox *box);
void pel_mailbox_destroy(pel_mailbox *box);

/* ---- the simulation's side ---- */

/* Takes the ownership of bytes (pel_allocate); null is fine and does nothing. */
void pel_mailbox_post(pel_mailbox *box, pel_post_kind kind, unsigned char *bytes, size_t size);
/* Waits at most so long for lines; takes them (to be freed). Returns false at the end. */
bool pel_mailbox_wait(pel_mailbox *box, double seconds, char **lines, int32_t *count);

/* ---- the server's side ---- */

/* Takes the ownership of the line; null is fine and does nothing. */
void pel_mailbox_line(pel_mailbox *box, char *line);
void pel_mailbox_want(pel_mailbox *box);
void pel_mailbox_end(pel_mailbox *box);

#endif
