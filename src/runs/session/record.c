#include "session/record.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/status.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

void pel_session_events_cut(pel_session_events *events, size_t count)
{
    while (events->count > count)
        pel_free(events->events[--events->count].line);
}

void pel_session_events_clear(pel_session_events *events)
{
    pel_session_events_cut(events, 0);
    pel_free(events->events);
    *events = (pel_session_events){0};
}

pel_status pel_session_events_reserve(pel_session_events *events, const pel_command *command, char **line,
                                      pel_error *error)
{
    void *all = events->events;
    *line = pel_allocate(command->shape == PEL_TOOL_MESH ? PEL_SESSION_LINE : strlen(command->line) + 1, 1);
    if (*line == NULL || !pel_reserve(&all, &events->room, events->count + 1, sizeof *events->events)) {
        pel_free(*line);
        return pel_fail_memory(error);
    }
    events->events = all;
    return PEL_OK;
}

void pel_session_events_add(pel_session_events *events, int64_t step, const pel_command *command, char *line)
{
    pel_session_event *last = events->count > 0 ? &events->events[events->count - 1] : NULL;
    bool is_move = command->word == PEL_COMMAND_MOVE;
    memcpy(line, command->line, strlen(command->line) + 1);
    if (is_move && last != NULL && last->is_move && last->step == step) {
        pel_free(last->line);
        last->line = line;
        return;
    }
    events->events[events->count++] = (pel_session_event){step, is_move, line};
}

/* ---- as text ---- */

typedef struct writer {
    char *text;
    size_t length, room;
    bool failed;
} writer;

static void put(writer *out, const char *bytes, size_t size)
{
    void *text = out->text;
    if (out->failed || !pel_reserve(&text, &out->room, out->length + size + 1, 1)) {
        out->failed = true;
        return;
    }
    out->text = text;
    memcpy(out->text + out->length, bytes, size);
    out->length += size;
    out->text[out->length] = '\0';
}

static void put_text(writer *out, const char *text)
{
    put(out, text, strlen(text));
}

static pel_status hand_over(writer *out, char **text, pel_error *error)
{
    if (out->failed) {
        pel_free(out->text);
        return pel_fail_memory(error);
    }
    *text = out->text;
    return PEL_OK;
}

static void put_events(const pel_session_events *events, writer *out, const char *before, const char *after)
{
    char number[32];
    for (size_t i = 0; i < events->count; i++) {
        put_text(out, before);
        snprintf(number, sizeof number, "%" PRId64 " ", events->events[i].step);
        put_text(out, number);
        put_text(out, events->events[i].line);
        put_text(out, after);
    }
}

pel_status pel_session_events_lines(const pel_session_events *events, char **text, pel_error *error)
{
    writer out = {0};
    put_text(&out, "");
    put_events(events, &out, "", "\n");
    return hand_over(&out, text, error);
}

/* the scene but for how long it goes and its session: blocks of the keys at the left margin */
static void put_scene(writer *out, const char *text)
{
    static const char *const left_out[] = {"duration:", "stop:", "session:"};
    bool skips = false;
    for (const char *end; *text != '\0'; text = end) {
        end = strchr(text, '\n');
        end = end != NULL ? end + 1 : text + strlen(text);
        if (*text != ' ' && *text != '-') {
            skips = false;
            for (size_t i = 0; i < sizeof left_out / sizeof *left_out; i++)
                skips |= strncmp(text, left_out[i], strlen(left_out[i])) == 0;
        }
        if (!skips)
            put(out, text, (size_t)(end - text));
    }
}

pel_status pel_session_events_scene(const pel_session_events *events, const char *scene, double duration, char **text,
                                    pel_error *error)
{
    char number[PEL_NUMBER_SIZE];
    writer out = {0};
    put_scene(&out, scene);
    pel_number_print(number, duration);
    put_text(&out, "duration: ");
    put_text(&out, number);
    put_text(&out, events->count > 0 ? "\nsession:\n" : "\n");
    put_events(events, &out, "  - \"", "\"\n");
    return hand_over(&out, text, error);
}
