#include "io/bytes.h"
#include "io/formats.h"
#include "io/polygon_soup.h"

#include "base/memory.h"
#include "math/vec3.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* layout of a binary file: 80 bytes of anything, the number of facets, and for each normal, corners, 2 bytes */
enum { HEADER_SIZE = 80, START_SIZE = 84, FACET_SIZE = 50, NORMAL_SIZE = 12, FLOAT_SIZE = 4 };

typedef struct stl_reader {
    pel_text_cursor *scan;
    pel_polygon_soup builder;
} stl_reader;

static bool add_facet(stl_reader *reader, double corners[3][3], const char *place)
{
    for (int i = 0; i < 3; i++)
        if (!pel_polygon_soup_add_loose_corner(&reader->builder, corners[i], place))
            return false;
    return pel_polygon_soup_end_loose_polygon(&reader->builder, 3);
}

static uint64_t binary_facet_count(const pel_text_cursor *scan)
{
    return pel_load_bytes(scan->begin + HEADER_SIZE, 4, false);
}

/* the size that a binary file claims to have; 0 when it is too short to say */
static uint64_t claimed_size(const pel_text_cursor *scan)
{
    return scan->end - scan->begin < START_SIZE ? 0 : START_SIZE + FACET_SIZE * binary_facet_count(scan);
}

bool pel_stl_size_fits(const pel_text_cursor *scan)
{
    return claimed_size(scan) == (uint64_t)(scan->end - scan->begin);
}

/* binary files may begin with "solid" too, but their counts and numbers have zero bytes */
bool pel_stl_matches(const pel_text_cursor *scan)
{
    enum { LOOK = 1000 };
    pel_text_cursor ahead = *scan;
    pel_text_cursor_skip_spaces(&ahead);
    size_t size = (size_t)(ahead.end - ahead.at);
    return pel_text_cursor_accept(&ahead, "solid") && memchr(scan->at, '\0', size < LOOK ? size : LOOK) == NULL;
}

static pel_status check_binary_size(const pel_text_cursor *scan, const pel_log *log, pel_error *error)
{
    const uint64_t size = (uint64_t)(scan->end - scan->begin), claimed = claimed_size(scan);
    if (claimed == 0)
        return pel_text_cursor_fail(scan, scan->end, error, "the file seems to be cut off: copy or export it again",
                                    "neither 'solid' nor the %d bytes that a binary STL begins with", (int)START_SIZE);
    if (claimed > size)
        return pel_text_cursor_fail(scan, scan->begin + HEADER_SIZE, error,
                                    "the file seems to be cut off or is not STL: copy or export it again",
                                    "%llu facets take %llu bytes but the file has %llu",
                                    (unsigned long long)binary_facet_count(scan), (unsigned long long)claimed,
                                    (unsigned long long)size);
    if (claimed < size)
        pel_log_line(log, "%llu bytes behind the last facet ignored", (unsigned long long)(size - claimed));
    return PEL_OK;
}

static pel_status read_binary(stl_reader *reader, const pel_log *log, pel_error *error)
{
    pel_text_cursor *scan = reader->scan;
    scan->binary = true;
    pel_status status = check_binary_size(scan, log, error);
    if (status != PEL_OK)
        return status;
    const uint64_t facet_count = binary_facet_count(scan);
    const char *facet = scan->begin + START_SIZE;
    for (uint64_t f = 0; f < facet_count; f++, facet += FACET_SIZE) {
        double corners[3][3];
        for (int i = 0; i < 9; i++) {
            const char *place = facet + NORMAL_SIZE + FLOAT_SIZE * i;
            double value = pel_load_float(place, false);
            if (!isfinite(value))
                return pel_text_cursor_fail(scan, place, error, "repair the mesh in the program that wrote it",
                                            "a coordinate of facet %llu is %g", (unsigned long long)f, value);
            corners[i / 3][i % 3] = value;
        }
        if (!add_facet(reader, corners, facet))
            return pel_fail_memory(error);
    }
    return PEL_OK;
}

static bool accept_next(pel_text_cursor *scan, const char *word)
{
    pel_text_cursor_skip_spaces(scan);
    return pel_text_cursor_accept(scan, word);
}

static pel_status read_corner(pel_text_cursor *scan, double position[3], pel_error *error)
{
    if (!accept_next(scan, "vertex"))
        return pel_text_cursor_fail_number(scan, error, "'vertex' (a facet has three)");
    for (int i = 0; i < 3; i++) {
        pel_text_cursor_skip_spaces(scan);
        if (!pel_text_cursor_number(scan, &position[i]))
            return pel_text_cursor_fail_number(scan, error, "a finite coordinate");
    }
    return PEL_OK;
}

/* from after the word "facet" to after "endfacet"; any normal is accepted */
static pel_status read_facet(stl_reader *reader, pel_error *error)
{
    pel_text_cursor *scan = reader->scan;
    double corners[3][3];
    size_t length;
    const char *place = scan->at;
    if (accept_next(scan, "normal")) {
        for (int i = 0; i < 3; i++) {
            pel_text_cursor_skip_spaces(scan);
            pel_text_cursor_word(scan, &length);
        }
    }
    if (!accept_next(scan, "outer") || !accept_next(scan, "loop"))
        return pel_text_cursor_fail_number(scan, error, "'outer loop'");
    for (int i = 0; i < 3; i++) {
        pel_status status = read_corner(scan, corners[i], error);
        if (status != PEL_OK)
            return status;
    }
    if (!accept_next(scan, "endloop") || !accept_next(scan, "endfacet"))
        return pel_text_cursor_fail_number(scan, error, "'endloop' and 'endfacet'");
    return add_facet(reader, corners, place) ? PEL_OK : pel_fail_memory(error);
}

/* The title of a solid: up to the end of the line, or to its first facet where the whole file is one line. */
static void skip_title(pel_text_cursor *scan)
{
    size_t length = 1;
    while (length > 0) {
        pel_text_cursor ahead = *scan;
        if (accept_next(&ahead, "facet") && (accept_next(&ahead, "normal") || accept_next(&ahead, "outer")))
            return;
        pel_text_cursor_word(scan, &length);
    }
}

static pel_status read_ascii(stl_reader *reader, const pel_log *log, pel_error *error)
{
    pel_text_cursor *scan = reader->scan;
    bool ended = false;
    for (pel_text_cursor_skip_spaces(scan); scan->at < scan->end; pel_text_cursor_skip_spaces(scan)) {
        if (pel_text_cursor_accept(scan, "facet")) {
            pel_status status = read_facet(reader, error);
            if (status != PEL_OK)
                return status;
            ended = false;
        } else if (pel_text_cursor_accept(scan, "solid")) {
            skip_title(scan);
        } else if (pel_text_cursor_accept(scan, "endsolid")) {
            skip_title(scan);
            ended = true;
        } else {
            return pel_text_cursor_fail_number(scan, error, "'solid', 'facet' or 'endsolid'");
        }
    }
    if (!ended)
        pel_log_line(log, "the file does not end with 'endsolid': it may be cut off");
    return PEL_OK;
}

pel_status pel_stl_read(pel_text_cursor *scan, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    stl_reader reader = {.scan = scan};
    pel_polygon_soup_init(&reader.builder, 0);
    /* many binary files begin with "solid" too, so the size decides first */
    const bool ascii = !pel_stl_size_fits(scan) && pel_stl_matches(scan);
    pel_status status = ascii ? read_ascii(&reader, log, error) : read_binary(&reader, log, error);
    if (status == PEL_OK)
        status = pel_polygon_soup_weld(&reader.builder, log, error);
    if (status == PEL_OK)
        status = pel_polygon_soup_finish(&reader.builder, scan, log, mesh, error);
    pel_polygon_soup_free(&reader.builder);
    return status;
}

/* unit normal, or zero when the triangle has no area or one that is too large for a number */
static void find_normal(const pel_mesh *mesh, const int32_t triangle[3], double normal[3])
{
    pel_vec3_triangle_normal(mesh->positions[triangle[0]], mesh->positions[triangle[1]], mesh->positions[triangle[2]],
                             normal);
    if (isfinite(pel_vec3_length(normal)))
        pel_vec3_normalize(normal);
    else
        pel_vec3_set(normal, 0, 0, 0);
}

static void write_ascii(pel_file_writer *writer, const pel_mesh *mesh)
{
    pel_file_writer_printf(writer, "solid pellicle\n");
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double normal[3];
        find_normal(mesh, mesh->triangles[t], normal);
        pel_write_numbers(writer, "facet normal ", normal);
        pel_file_writer_printf(writer, "outer loop\n");
        for (int i = 0; i < 3; i++)
            pel_write_numbers(writer, "vertex ", mesh->positions[mesh->triangles[t][i]]);
        pel_file_writer_printf(writer, "endloop\nendfacet\n");
    }
    pel_file_writer_printf(writer, "endsolid pellicle\n");
}

static void write_binary(pel_file_writer *writer, const pel_mesh *mesh)
{
    char start[START_SIZE] = "binary STL written by pellicle";
    pel_store_bytes(start + HEADER_SIZE, 4, false, (uint64_t)mesh->triangle_count);
    pel_file_writer_write(writer, start, sizeof start);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        char facet[FACET_SIZE] = {0};
        double normal[3];
        find_normal(mesh, mesh->triangles[t], normal);
        for (int i = 0; i < 3; i++)
            pel_store_float(facet + FLOAT_SIZE * i, false, (float)normal[i]);
        for (int i = 0; i < 9; i++)
            pel_store_float(facet + NORMAL_SIZE + FLOAT_SIZE * i, false,
                            (float)mesh->positions[mesh->triangles[t][i / 3]][i % 3]);
        pel_file_writer_write(writer, facet, sizeof facet);
    }
}

pel_status pel_stl_write(pel_file_writer *writer, pel_encoding encoding, const pel_mesh *mesh, pel_error *error)
{
    if (encoding == PEL_ENCODING_ASCII) {
        write_ascii(writer, mesh);
        return PEL_OK;
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        for (int i = 0; i < 3; i++) {
            if (fabs(mesh->positions[v][i]) <= (double)FLT_MAX)
                continue;
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "vertex", v,
                                      "scale the mesh or write PLY, OBJ or ASCII STL",
                                      "coordinate %g is too large for binary STL", mesh->positions[v][i]);
        }
    }
    write_binary(writer, mesh);
    return PEL_OK;
}
