#include "live/mailbox.h"

#include "base/memory.h"
#include "math/extremes.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <time.h>

void pel_mailbox_create(pel_mailbox *box)
{
    pthread_condattr_t clock;
    *box = (pel_mailbox){0};
    pthread_mutex_init(&box->lock, NULL);
    pthread_condattr_init(&clock);
    pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
    pthread_cond_init(&box->arrived, &clock);
    pthread_condattr_destroy(&clock);
}

void pel_mailbox_destroy(pel_mailbox *box)
{
    for (int k = 0; k < PEL_POST_COUNT; k++)
        pel_free(box->posts[k].bytes);
    for (int32_t i = 0; i < box->line_count; i++)
        pel_free(box->lines[i]);
    pthread_cond_destroy(&box->arrived);
    pthread_mutex_destroy(&box->lock);
}

void pel_mailbox_post(pel_mailbox *box, pel_post_kind kind, unsigned char *bytes, size_t size)
{
    if (bytes == NULL)
        return;
    pthread_mutex_lock(&box->lock);
    pel_post *post = &box->posts[kind];
    unsigned char *old = post->bytes;
    *post = (pel_post){bytes, size, post->revision + 1};
    pthread_mutex_unlock(&box->lock);
    pel_free(old);
    if (box->ring != NULL)
        box->ring(box->user);
}

static struct timespec later(double seconds)
{
    double at = pel_seconds() + seconds, whole = floor(at);
    return (struct timespec){.tv_sec = (time_t)whole, .tv_nsec = (long)(1e9 * (at - whole))};
}

bool pel_mailbox_wait(pel_mailbox *box, double seconds, char **lines, int32_t *count)
{
    struct timespec end = later(pel_max(seconds, 0));
    pthread_mutex_lock(&box->lock);
    int waited = seconds > 0 ? 0 : ETIMEDOUT;
    while (!atomic_load(&box->ended) && box->line_count == 0 && waited != ETIMEDOUT)
        waited = pthread_cond_timedwait(&box->arrived, &box->lock, &end);
    *count = box->line_count;
    for (int32_t i = 0; i < box->line_count; i++)
        lines[i] = box->lines[i];
    box->line_count = 0;
    box->line_bytes = 0;
    atomic_store(&box->interrupting, 0);
    bool goes_on = !atomic_load(&box->ended);
    pthread_mutex_unlock(&box->lock);
    return goes_on;
}

static bool is_slow(const pel_mail_reader *reader)
{
    return reader->sent - reader->received >= PEL_FRAMES_UNDER_WAY;
}

/* the first kind of message that is due, PEL_POST_COUNT for none */
static int find_due(const pel_mailbox *box, const pel_mail_reader *reader)
{
    int kind = 0;
    while (kind < PEL_POST_COUNT &&
           (box->posts[kind].revision == reader->known[kind] || (kind == PEL_POST_FRAME && is_slow(reader))))
        kind++;
    return kind;
}

int pel_mailbox_take(pel_mailbox *box, pel_mail_reader *reader, size_t before, unsigned char **bytes, size_t *room,
                     size_t *size)
{
    void *grown = *bytes;
    pthread_mutex_lock(&box->lock);
    int kind = find_due(box, reader);
    if (kind < PEL_POST_COUNT && !pel_reserve(&grown, room, before + box->posts[kind].size, 1))
        kind = -1;
    if (kind >= 0 && kind < PEL_POST_COUNT) {
        const pel_post *post = &box->posts[kind];
        *bytes = grown;
        memcpy(*bytes + before, post->bytes, post->size);
        *size = post->size;
        reader->known[kind] = post->revision;
        reader->sent += kind == PEL_POST_FRAME;
    }
    pthread_mutex_unlock(&box->lock);
    if (kind == PEL_POST_COUNT && !is_slow(reader))
        pel_mailbox_want(box);
    return kind;
}

void pel_mailbox_received(pel_mail_reader *reader)
{
    reader->received += reader->received != reader->sent;
}

void pel_mailbox_welcome(pel_mailbox *box, pel_mail_reader *reader)
{
    *reader = (pel_mail_reader){0};
    pthread_mutex_lock(&box->lock);
    reader->known[PEL_POST_NOTICE] = box->posts[PEL_POST_NOTICE].revision;
    reader->known[PEL_POST_SCENE] = box->posts[PEL_POST_SCENE].revision;
    pthread_mutex_unlock(&box->lock);
    pel_mailbox_want(box);
}

void pel_mailbox_line(pel_mailbox *box, char *line, bool interrupts)
{
    if (line == NULL)
        return;
    size_t size = strlen(line) + 1;
    pthread_mutex_lock(&box->lock);
    bool fits = box->line_count < PEL_LINE_LIMIT && box->line_bytes + size <= PEL_WAITING_LIMIT;
    if (fits) {
        box->lines[box->line_count++] = line;
        box->line_bytes += size;
    } else {
        box->lost_lines++;
    }
    /* a line that is lost stops the stage too: the queue is full because of it */
    if (interrupts)
        atomic_fetch_add(&box->interrupting, 1);
    pthread_cond_signal(&box->arrived);
    pthread_mutex_unlock(&box->lock);
    if (!fits)
        pel_free(line);
}

void pel_mailbox_begin(pel_mailbox *box, const char *stage, int32_t behind)
{
    pthread_mutex_lock(&box->lock);
    box->stage = stage;
    box->stage_at = pel_seconds();
    box->behind_stage = behind;
    box->stage_is_told = false;
    pthread_mutex_unlock(&box->lock);
}

const char *pel_mailbox_find_busy(pel_mailbox *box, double before)
{
    const char *stage = NULL;
    pthread_mutex_lock(&box->lock);
    if (box->stage != NULL && box->line_count + box->behind_stage > 0 && box->stage_at < before &&
        !box->stage_is_told) {
        stage = box->stage;
        box->stage_is_told = true;
    }
    pthread_mutex_unlock(&box->lock);
    return stage;
}

void pel_mailbox_want(pel_mailbox *box)
{
    atomic_store(&box->wanted, true);
}

void pel_mailbox_end(pel_mailbox *box)
{
    pthread_mutex_lock(&box->lock);
    atomic_store(&box->ended, true);
    pthread_cond_signal(&box->arrived);
    pthread_mutex_unlock(&box->lock);
}
