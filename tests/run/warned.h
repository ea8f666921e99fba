/* Runs of scenes whose warnings are looked at. Define _XOPEN_SOURCE 700 before. */
#ifndef PEL_TEST_WARNED_H
#define PEL_TEST_WARNED_H

#include "run/run_fixture.h"

/* a thin shell under pressure; %s: more of it */
#define SHELL                                                                                                          \
    "version: 1\nbodies:\n  - name: ball\n    mesh: { shape: geodesic-sphere, frequency: 3, radius: 0.05 }\n"          \
    "    membrane: { preset: rubber }\n    pressure: { inside: 2000 }\n"                                               \
    "stop: { frames: 4 }\noutput: { every_frame: 1 }\n"

/* lines of the log */
typedef struct told_lines {
    char text[4000];
    int count;
} told_lines;

static inline void take_line(void *user, const char *text)
{
    told_lines *lines = user;
    size_t length = strlen(lines->text);
    snprintf(lines->text + length, sizeof lines->text - length, "%s\n", text);
    lines->count++;
}

static inline told_lines run_scene(const char *text, const char *const *overrides, int32_t count, const char *resume,
                                   int64_t max_frames, pel_run_summary *summary)
{
    char path[256], checkpoint[256];
    told_lines lines = {.count = 0};
    const pel_log log = {take_line, &lines};
    pel_scene *scene = load_scene(text, overrides, count);
    pel_run_def def = pel_run_def_default();
    pel_error error;
    def.folder = in_folder(path, "warned", "");
    def.resume = resume != NULL ? in_folder(checkpoint, "warned", resume) : NULL;
    def.max_frames = max_frames;
    def.thread_count = thread_count;
    def.warnings = &log;
    pel_status status = pel_run(scene, &def, summary, &error);
    if (status != PEL_OK)
        print_error("%s\n", error.what);
    assert_int_equal(status, PEL_OK);
    pel_scene_destroy(scene);
    /* each warning is a line, and the other way round */
    assert_int_equal(lines.count, summary->warning_count);
    for (int32_t i = 0; i < summary->warning_count; i++) {
        char entry[600];
        assert_non_null(strstr(lines.text, summary->warnings[i].text));
        snprintf(entry, sizeof entry, "{\"code\": \"%s\", \"first_frame\": %d, \"count\": %d, \"text\": \"%.20s",
                 summary->warnings[i].code, (int)summary->warnings[i].first_frame, (int)summary->warnings[i].count,
                 summary->warnings[i].text);
        check_contains("warned", "summary.json", entry);
    }
    return lines;
}

static inline const pel_run_warning *find_warning(const pel_run_summary *summary, const char *code)
{
    for (int32_t i = 0; i < summary->warning_count; i++)
        if (strcmp(summary->warnings[i].code, code) == 0)
            return &summary->warnings[i];
    return NULL;
}

#endif
