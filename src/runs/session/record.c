#include "session/record.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/status.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const char before[] = "  - \"", behind[] = "\"\n";
enum { BEFORE = sizeof before - 1, BEHIND = sizeof behind - 1, NUMBER = 24 };

void pel_session_events_cut(pel_session_events *events, size_t length)
{
    events->length = length < events->length ? length : events->length;
    events->unchanged = events->length < events->unchanged ? events->length : events->unchanged;
}

void pel_session_events_clear(pel_session_events *events)
{
    pel_free(events->text);
    *events = (pel_session_events){0};
}

/* a hand can always let go */
static bool has_room(const pel_session_events *events, const pel_command *command)
{
    return command->word == PEL_COMMAND_RELEASE ||
           events->length + BEFORE + NUMBER + strlen(command->line) + BEHIND <= PEL_SESSION_RECORD;
}

pel_status pel_session_events_reserve(pel_session_events *events, const pel_command *command, pel_error *error)
{
    void *text = events->text;
    if (command->word != PEL_COMMAND_MARK && !has_room(events, command))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "save the session as a scene and reset, or undo",
                          "the session has recorded %d MiB of commands, as many as a scene may repeat",
                          (int)(PEL_SESSION_RECORD >> 20));
    if (!pel_reserve(&text, &events->room, events->length + BEFORE + NUMBER + PEL_SESSION_LINE + BEHIND + 1, 1))
        return pel_fail_memory(error);
    events->text = text;
    return PEL_OK;
}

/* where the last line starts */
static size_t find_last(const pel_session_events *events)
{
    size_t start = events->length > 0 ? events->length - 1 : 0;
    while (start > 0 && events->text[start - 1] != '\n')
        start--;
    return start;
}

void pel_session_events_add(pel_session_events *events, int64_t step, const pel_command *command)
{
    static const char move[] = "move ";
    char begin[BEFORE + NUMBER + sizeof move];
    snprintf(begin, sizeof begin, "%s%" PRId64 " %s", before, step, move);
    size_t last = find_last(events), length = strlen(begin);
    if (command->word == PEL_COMMAND_MOVE && events->length - last > length &&
        memcmp(events->text + last, begin, length) == 0)
        pel_session_events_cut(events, last);
    size_t room = events->room - events->length;
    events->length += (size_t)snprintf(events->text + events->length, room, "%s%" PRId64 " %s%s", before, step,
                                       command->line, behind);
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

pel_status pel_session_events_lines(const pel_session_events *events, char **text, pel_error *error)
{
    writer out = {0};
    put_text(&out, "");
    for (size_t at = 0, end; at < events->length; at = end) {
        const char *line_end = memchr(events->text + at, '\n', events->length - at);
        end = (size_t)(line_end - events->text) + 1;
        put(&out, events->text + at + BEFORE, end - at - BEFORE - BEHIND);
        put_text(&out, "\n");
    }
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
    put_text(&out, "\n");
    if (events->length > 0) {
        put_text(&out, "session:\n");
        put(&out, events->text, events->length);
    }
    return hand_over(&out, text, error);
}
