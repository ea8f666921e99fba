/* Parsing mesh files in strings, and their messages. */
#ifndef PEL_TESTS_IO_PARSE_H
#define PEL_TESTS_IO_PARSE_H

#include "check.h"

#include "pellicle/mesh_io.h"

/* collects the notes of a reader or writer */
typedef struct notes {
    char text[4000];
} notes;

static inline void note(void *user, const char *text)
{
    notes *to = user;
    size_t length = strlen(to->text);
    snprintf(to->text + length, sizeof to->text - length, "%s\n", text);
}

static inline pel_log log_to(notes *to)
{
    to->text[0] = '\0';
    return (pel_log){note, to};
}

/* the mesh of a text that must parse; notes may be null */
static inline pel_mesh *parse_bytes(const char *name, const void *bytes, size_t size, notes *to)
{
    pel_mesh *mesh;
    pel_error error;
    char text[700];
    pel_log log = {0};
    if (to != NULL)
        log = log_to(to);
    pel_status status = pel_mesh_parse(name, bytes, size, PEL_FORMAT_AUTO, &log, &mesh, &error);
    if (status != PEL_OK)
        fail_msg("%s", pel_error_text(&error, text, sizeof text));
    return mesh;
}

static inline pel_mesh *parse_text(const char *name, const char *text, notes *to)
{
    return parse_bytes(name, text, strlen(text), to);
}

/* an allocation_case (failing_malloc.h): the name of a file and its text */
static inline pel_status parse_case(const void *name_and_text, pel_error *error)
{
    const char *const *file = name_and_text;
    pel_mesh *mesh;
    pel_status status = pel_mesh_parse(file[0], file[1], strlen(file[1]), PEL_FORMAT_AUTO, NULL, &mesh, error);
    if (status != PEL_OK)
        assert_null(mesh);
    pel_mesh_destroy(mesh);
    return status;
}

/* parsing must fail with a bad format, a remedy and the words; returns the error for checks of its place */
static inline pel_error refuse_bytes(const char *name, const void *bytes, size_t size, const char *words)
{
    pel_mesh *mesh = (pel_mesh *)(uintptr_t)1;
    pel_error error = {0};
    char text[700] = "";
    pel_status status = pel_mesh_parse(name, bytes, size, PEL_FORMAT_AUTO, NULL, &mesh, &error);
    if (status != PEL_OK)
        pel_error_text(&error, text, sizeof text);
    if (status != PEL_BAD_FORMAT || mesh != NULL || strstr(text, words) == NULL || error.remedy[0] == '\0')
        fail_msg("expected '%s', got '%s' for\n%.300s", words, text, (const char *)bytes);
    return error;
}

static inline void refuse_text(const char *name, const char *text, const char *words)
{
    refuse_bytes(name, text, strlen(text), words);
}

static inline void check_triangle(const pel_mesh *mesh, int32_t t, int32_t a, int32_t b, int32_t c)
{
    const int32_t expected[3] = {a, b, c};
    assert_true(t < mesh->triangle_count);
    assert_memory_equal(mesh->triangles[t], expected, sizeof expected);
}

static inline void check_position(const pel_mesh *mesh, int32_t v, double x, double y, double z)
{
    const double expected[3] = {x, y, z};
    assert_true(v < mesh->vertex_count);
    assert_memory_equal(mesh->positions[v], expected, sizeof expected);
}

static inline void check_counts(const pel_mesh *mesh, int32_t vertex_count, int32_t triangle_count)
{
    assert_int_equal(mesh->vertex_count, vertex_count);
    assert_int_equal(mesh->triangle_count, triangle_count);
}

static inline void check_same_mesh(const pel_mesh *mesh, const pel_mesh *other)
{
    check_counts(mesh, other->vertex_count, other->triangle_count);
    assert_memory_equal(mesh->positions, other->positions, (size_t)mesh->vertex_count * sizeof *mesh->positions);
    assert_memory_equal(mesh->triangles, other->triangles, (size_t)mesh->triangle_count * sizeof *mesh->triangles);
}

#endif
