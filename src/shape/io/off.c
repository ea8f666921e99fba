#include "io/formats.h"
#include "io/polygon_soup.h"

#include "base/memory.h"

#include <string.h>

typedef enum off_kind {
    OFF_NONE,  /* not an OFF file */
    OFF_PLAIN, /* positions only */
    OFF_EXTRA, /* normals, colours or texture coordinates after the positions */
    OFF_OTHER  /* positions of four or n coordinates */
} off_kind;

/* skips the header word */
static off_kind accept_header(pel_text_cursor *scan)
{
    static const char *const plain[] = {"OFF", "off", NULL};
    static const char *const extra[] = {"COFF", "NOFF", "CNOFF", "STOFF", "STCOFF", "STNOFF", "STCNOFF", NULL};
    static const char *const other[] = {"4OFF", "nOFF", "4nOFF", "C4OFF", "CnOFF", "N4OFF", "ST4OFF", NULL};
    size_t length;
    pel_text_cursor_skip_comments(scan);
    const char *word = pel_text_cursor_word(scan, &length);
    if (pel_word_is_one_of(word, length, plain))
        return OFF_PLAIN;
    if (pel_word_is_one_of(word, length, extra))
        return OFF_EXTRA;
    return pel_word_is_one_of(word, length, other) ? OFF_OTHER : OFF_NONE;
}

bool pel_off_matches(const pel_text_cursor *scan)
{
    pel_text_cursor ahead = *scan;
    return accept_header(&ahead) != OFF_NONE;
}

static pel_status read_header(pel_text_cursor *scan, off_kind *kind, pel_error *error)
{
    *kind = accept_header(scan);
    if (*kind == OFF_NONE)
        return pel_text_cursor_fail(scan, scan->begin, error, "begin the file with OFF",
                                    "the file does not begin with OFF");
    if (*kind == OFF_OTHER)
        return pel_text_cursor_fail(scan, scan->at, error, "export it as plain OFF",
                                    "vertices have four or n coordinates instead of three");
    pel_text_cursor_skip_blanks(scan);
    if (pel_text_cursor_accept(scan, "BINARY"))
        return pel_text_cursor_fail(scan, scan->at, error, "export it as ASCII OFF or as PLY",
                                    "binary OFF cannot be read");
    return PEL_OK;
}

/* a count that the rest of the file can hold, when each item takes `smallest` bytes or more */
static pel_status read_count(pel_text_cursor *scan, const char *what, int64_t smallest, int64_t *count,
                             pel_error *error)
{
    pel_text_cursor_skip_comments(scan);
    const char *place = scan->at;
    if (!pel_text_cursor_integer(scan, count) || !pel_text_cursor_at_break(scan) || *count < 0) {
        scan->at = place;
        return pel_text_cursor_fail_number(scan, error, what);
    }
    if (*count > (scan->end - scan->at) / smallest)
        return pel_text_cursor_fail(scan, place, error, "the file seems to be cut off: copy or export it again",
                                    "%s is %lld, more than the file can hold", what + 2, (long long)*count);
    return PEL_OK;
}

static pel_status read_vertices(pel_text_cursor *scan, int64_t count, pel_polygon_soup *builder, pel_error *error)
{
    if (!pel_polygon_soup_reserve_vertices(builder, (size_t)count))
        return pel_fail_memory(error);
    for (int64_t v = 0; v < count; v++) {
        double position[3];
        for (int i = 0; i < 3; i++) {
            pel_text_cursor_skip_comments(scan);
            if (!pel_text_cursor_number(scan, &position[i]))
                return pel_text_cursor_fail_number(scan, error, "a finite coordinate");
        }
        /* normals, colours and texture coordinates */
        pel_text_cursor_skip_line(scan);
        if (!pel_polygon_soup_add_vertex(builder, position))
            return pel_fail_memory(error);
    }
    return PEL_OK;
}

static pel_status read_face(pel_text_cursor *scan, pel_polygon_soup *builder, pel_error *error)
{
    int64_t count, vertex;
    pel_status status = read_count(scan, "a number of corners", 2, &count, error);
    for (int64_t i = 0; i < count && status == PEL_OK; i++) {
        pel_text_cursor_skip_comments(scan);
        const char *place = scan->at;
        if (!pel_text_cursor_integer(scan, &vertex) || !pel_text_cursor_at_break(scan) || vertex < 0 ||
            vertex >= INT32_MAX) {
            scan->at = place;
            return pel_text_cursor_fail_number(scan, error, "a vertex index");
        }
        if (!pel_polygon_soup_add_corner(builder, (int32_t)vertex, place))
            return pel_fail_memory(error);
    }
    if (status == PEL_OK && !pel_polygon_soup_end_polygon(builder, (size_t)count))
        status = pel_fail_memory(error);
    /* the colour of the face */
    pel_text_cursor_skip_line(scan);
    return status;
}

static pel_status read_body(pel_text_cursor *scan, pel_polygon_soup *builder, pel_error *error)
{
    int64_t vertex_count, face_count;
    pel_status status = read_count(scan, "a number of vertices", 6, &vertex_count, error);
    if (status == PEL_OK)
        status = read_count(scan, "a number of faces", 2, &face_count, error);
    if (status != PEL_OK)
        return status;
    /* the number of edges, which may be missing */
    pel_text_cursor_skip_line(scan);
    status = read_vertices(scan, vertex_count, builder, error);
    for (int64_t f = 0; f < face_count && status == PEL_OK; f++)
        status = read_face(scan, builder, error);
    return status;
}

pel_status pel_off_read(pel_text_cursor *scan, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    off_kind kind;
    pel_polygon_soup builder;
    pel_polygon_soup_init(&builder, 0);
    pel_status status = read_header(scan, &kind, error);
    if (status == PEL_OK)
        status = read_body(scan, &builder, error);
    if (status == PEL_OK) {
        if (kind == OFF_EXTRA)
            pel_log_line(log, "normals, colours and texture coordinates of vertices ignored");
        status = pel_polygon_soup_finish(&builder, scan, log, mesh, error);
    }
    pel_polygon_soup_free(&builder);
    return status;
}

void pel_off_write(pel_file_writer *writer, const pel_mesh *mesh)
{
    pel_file_writer_printf(writer, "OFF\n%d %d 0\n", (int)mesh->vertex_count, (int)mesh->triangle_count);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        pel_write_numbers(writer, "", mesh->positions[v]);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *c = mesh->triangles[t];
        pel_file_writer_printf(writer, "3 %d %d %d\n", (int)c[0], (int)c[1], (int)c[2]);
    }
}
