#include "io/formats.h"
#include "io/polygon_soup.h"

#include "base/memory.h"
#include "base/room.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Names of objects, groups and materials: bit i of a mask is name i. */
enum { MOST_GROUPS = 64, PREFIX = sizeof "group:" - 1 };

/* the names of the polygons from one on */
typedef struct obj_run {
    size_t first;
    uint64_t names;
} obj_run;

typedef struct obj_reader {
    pel_text_cursor *scan;
    pel_polygon_soup builder;
    char names[MOST_GROUPS][PEL_NAME_SIZE - PREFIX];
    int name_count;
    uint64_t object, groups, material; /* in force */
    obj_run *runs;
    size_t run_count, run_capacity, lost_names;
    double (*colours)[3]; /* of the vertices, until the first without one */
    size_t coloured_count, colour_capacity;
    double (*textures)[2];
    size_t texture_count, texture_capacity;
    int64_t *texture_of; /* of the vertices: number of the texture coordinates from 1; 0 = none */
    size_t mapped_count, mapped_capacity;
    size_t seam_count;    /* corners with others than the first of their vertex */
    size_t extra_count;   /* vertices with a colour or weight */
    size_t normal_count;  /* corners with normals */
    size_t curve_count;   /* points and lines */
    size_t unknown_count; /* statements that are not of OBJ */
} obj_reader;

/* white space within a statement; a backslash at the end of a line continues it */
static inline void skip_blanks(pel_text_cursor *scan)
{
    while (scan->at < scan->end) {
        if (pel_is_blank(*scan->at)) {
            scan->at++;
        } else if (*scan->at == '\\' && scan->at + 1 < scan->end && pel_is_line_end(scan->at[1])) {
            bool two = scan->at[1] == '\r' && scan->at + 2 < scan->end && scan->at[2] == '\n';
            scan->at += two ? 3 : 2;
        } else {
            return;
        }
    }
}

static inline bool at_statement_end(const pel_text_cursor *scan)
{
    return scan->at == scan->end || pel_is_line_end(*scan->at) || *scan->at == '#';
}

/* to the end of a statement, over continued lines; a comment is never continued */
static void skip_statement(pel_text_cursor *scan)
{
    while (!at_statement_end(scan)) {
        skip_blanks(scan);
        if (!at_statement_end(scan))
            scan->at++;
    }
    pel_text_cursor_skip_line(scan);
}

/* a colour counts if all vertices before have one */
static bool keep_colour(obj_reader *reader, const double colour[3])
{
    const size_t count = reader->coloured_count;
    void *colours = reader->colours;
    if (count != reader->builder.vertex_count || !isfinite(colour[0] + colour[1] + colour[2]))
        return true;
    if (!pel_reserve(&colours, &reader->colour_capacity, count + 1, sizeof *reader->colours))
        return false;
    reader->colours = colours;
    memcpy(reader->colours[count], colour, sizeof *reader->colours);
    reader->coloured_count++;
    return true;
}

static pel_status read_vertex(obj_reader *reader, pel_error *error)
{
    pel_text_cursor *scan = reader->scan;
    double position[3], rest[4] = {0};
    int rest_count = 0;
    for (int i = 0; i < 3; i++) {
        skip_blanks(scan);
        if (!pel_text_cursor_number(scan, &position[i]))
            return pel_text_cursor_fail_number(scan, error, "a finite coordinate");
    }
    /* a weight or a colour may follow */
    skip_blanks(scan);
    for (; !at_statement_end(scan); skip_blanks(scan), rest_count++)
        if (!pel_text_cursor_any_number(scan, &rest[rest_count < 3 ? rest_count : 3]))
            return pel_text_cursor_fail_number(scan, error, "a number");
    reader->extra_count += rest_count > 0;
    if (rest_count == 3 && !keep_colour(reader, rest))
        return pel_fail_memory(error);
    return pel_polygon_soup_add_vertex(&reader->builder, position) ? PEL_OK : pel_fail_memory(error);
}

static pel_status read_texture(obj_reader *reader, pel_error *error)
{
    double at[2] = {0}, depth;
    for (int i = 0; i < 2; i++) {
        skip_blanks(reader->scan);
        if (!at_statement_end(reader->scan) && !pel_text_cursor_any_number(reader->scan, i == 0 ? &at[0] : &at[1]))
            return pel_text_cursor_fail_number(reader->scan, error, "a texture coordinate");
    }
    skip_blanks(reader->scan);
    if (!at_statement_end(reader->scan) && !pel_text_cursor_any_number(reader->scan, &depth))
        return pel_text_cursor_fail_number(reader->scan, error, "a texture coordinate");
    void *textures = reader->textures;
    if (!pel_reserve(&textures, &reader->texture_capacity, reader->texture_count + 1, sizeof *reader->textures))
        return pel_fail_memory(error);
    reader->textures = textures;
    memcpy(reader->textures[reader->texture_count++], at, sizeof at);
    skip_statement(reader->scan);
    return PEL_OK;
}

/* notes the texture coordinates of a corner; those of a face before them, or before its vertices, count as none */
static bool keep_texture(obj_reader *reader, int32_t vertex, int64_t number)
{
    const int64_t count = (int64_t)reader->texture_count;
    const int64_t place = number < 0 ? count + number + 1 : number;
    void *texture_of = reader->texture_of;
    if ((size_t)vertex >= reader->builder.vertex_count)
        return true;
    if (!pel_reserve(&texture_of, &reader->mapped_capacity, (size_t)vertex + 1, sizeof *reader->texture_of))
        return false;
    reader->texture_of = texture_of;
    while (reader->mapped_count <= (size_t)vertex)
        reader->texture_of[reader->mapped_count++] = 0;
    if (place < 1 || place > count)
        return true;
    int64_t *own = &reader->texture_of[vertex];
    if (*own == 0)
        *own = place;
    const double *a = reader->textures[*own - 1], *b = reader->textures[place - 1];
    reader->seam_count += a[0] < b[0] || a[0] > b[0] || a[1] < b[1] || a[1] > b[1];
    return true;
}

/* vertex number of the file, from 1 or counted back from the last vertex, to an index */
static pel_status resolve_index(const obj_reader *reader, int64_t number, const char *place, int32_t *vertex,
                                pel_error *error)
{
    const int64_t count = (int64_t)reader->builder.vertex_count;
    int64_t index = number > 0 ? number - 1 : count + number;
    if (number == 0)
        return pel_text_cursor_fail(reader->scan, place, error, "number the vertices from 1",
                                    "a face uses vertex 0 but OBJ counts from 1");
    if (index < 0 || index >= INT32_MAX)
        return pel_text_cursor_fail(reader->scan, place, error, "correct the index",
                                    "a face uses vertex %lld but %lld vertices stand before it", (long long)number,
                                    (long long)count);
    *vertex = (int32_t)index;
    return PEL_OK;
}

/* v, v/vt, v//vn or v/vt/vn */
static pel_status read_corner(obj_reader *reader, pel_error *error)
{
    pel_text_cursor *scan = reader->scan;
    const char *place = scan->at;
    int64_t number, extra[2] = {0, 0};
    int32_t vertex = 0;
    if (!pel_text_cursor_integer(scan, &number))
        return pel_text_cursor_fail_number(scan, error, "a vertex number");
    for (int i = 0; i < 2 && scan->at < scan->end && *scan->at == '/'; i++) {
        scan->at++;
        pel_text_cursor_integer(scan, &extra[i]);
    }
    reader->normal_count += extra[1] != 0;
    if (!pel_text_cursor_at_break(scan)) {
        scan->at = place;
        return pel_text_cursor_fail_number(scan, error, "a face corner (v, v/vt, v//vn or v/vt/vn)");
    }
    pel_status status = resolve_index(reader, number, place, &vertex, error);
    if (status == PEL_OK && ((extra[0] != 0 && !keep_texture(reader, vertex, extra[0])) ||
                             !pel_polygon_soup_add_corner(&reader->builder, vertex, place)))
        status = pel_fail_memory(error);
    return status;
}

static pel_status read_face(obj_reader *reader, pel_error *error)
{
    size_t count = 0;
    for (skip_blanks(reader->scan); !at_statement_end(reader->scan); skip_blanks(reader->scan), count++) {
        pel_status status = read_corner(reader, error);
        if (status != PEL_OK)
            return status;
    }
    return pel_polygon_soup_end_polygon(&reader->builder, count) ? PEL_OK : pel_fail_memory(error);
}

/* the bit of a name; 0 for those beyond the last */
static uint64_t bit_of_name(obj_reader *reader, const char *name, size_t length)
{
    char text[PEL_NAME_SIZE - PREFIX];
    snprintf(text, sizeof text, "%.*s", (int)(length < sizeof text ? length : sizeof text), name);
    int i = 0;
    while (i < reader->name_count && strcmp(reader->names[i], text) != 0)
        i++;
    if (i == MOST_GROUPS) {
        reader->lost_names++;
        return 0;
    }
    if (i == reader->name_count)
        memcpy(reader->names[reader->name_count++], text, sizeof text);
    return (uint64_t)1 << i;
}

/* the names of an object, groups or a material hold for the polygons that follow */
static pel_status read_names(obj_reader *reader, char kind, pel_error *error)
{
    uint64_t *names = kind == 'o' ? &reader->object : kind == 'g' ? &reader->groups : &reader->material;
    *names = 0;
    for (skip_blanks(reader->scan); !at_statement_end(reader->scan); skip_blanks(reader->scan)) {
        size_t length;
        const char *name = pel_text_cursor_word(reader->scan, &length);
        if (length == 0)
            break;
        *names |= bit_of_name(reader, name, length);
    }
    skip_statement(reader->scan);
    void *runs = reader->runs;
    if (!pel_reserve(&runs, &reader->run_capacity, reader->run_count + 1, sizeof *reader->runs))
        return pel_fail_memory(error);
    reader->runs = runs;
    const uint64_t all = reader->object | reader->groups | reader->material;
    reader->runs[reader->run_count++] = (obj_run){reader->builder.polygon_count, all};
    return PEL_OK;
}

/* Names at each vertex of the polygons (vertex_count). Returns those that some polygons have and others lack. */
static uint64_t spread_names(const obj_reader *reader, uint64_t *at_vertex)
{
    const pel_polygon_soup *soup = &reader->builder;
    uint64_t some = 0, all = ~(uint64_t)0, names = 0;
    size_t corner = 0, run = 0;
    for (size_t i = 0; i < soup->polygon_count; i++) {
        while (run < reader->run_count && reader->runs[run].first <= i)
            names = reader->runs[run++].names;
        some |= names;
        all &= names;
        for (int32_t k = 0; k < soup->sizes[i]; k++)
            at_vertex[soup->corners[corner++]] |= names;
    }
    return some & ~all;
}

/* a field "group:NAME" for each name that does not hold for the whole mesh: 1 at its vertices, else 0 */
static pel_status add_groups(const obj_reader *reader, const uint64_t *at_vertex, uint64_t names, pel_mesh *mesh,
                             pel_error *error)
{
    double *values = pel_allocate((size_t)mesh->vertex_count, sizeof *values);
    pel_status status = values != NULL ? PEL_OK : pel_fail_memory(error);
    for (int i = 0; i < reader->name_count && status == PEL_OK; i++) {
        char field[PEL_NAME_SIZE];
        if ((names >> i & 1) == 0)
            continue;
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            values[v] = (double)(at_vertex[v] >> i & 1);
        snprintf(field, sizeof field, "group:%s", reader->names[i]);
        status = pel_mesh_add_field(mesh, field, 1, values, error);
    }
    pel_free(values);
    return status;
}

/* every statement that is not a vertex or a face */
static pel_status read_other(obj_reader *reader, const char *word, size_t length, pel_error *error)
{
    static const char *const curves[] = {"l", "p", NULL};
    static const char *const silent[] = {"s", "vn", "mtllib", NULL};
    static const char *const naming[] = {"o", "g", "usemtl", NULL};
    static const char *const known[] = {"vp",     "curv",       "curv2",     "surf",     "parm",  "trim",   "hole",
                                        "scrv",   "sp",         "end",       "deg",      "bmat",  "step",   "cstype",
                                        "con",    "mg",         "bevel",     "c_interp", "lod",   "usemap", "d_interp",
                                        "maplib", "shadow_obj", "trace_obj", "ctech",    "stech", "call",   "csh",
                                        "bsp",    "bzp",        "cdc",       "cdp",      "res",   NULL};
    if (pel_word_is_one_of(word, length, naming))
        return read_names(reader, word[0], error);
    if (pel_word_is_one_of(word, length, curves)) {
        reader->curve_count++;
    } else if (pel_word_is_one_of(word, length, known)) {
        reader->unknown_count++;
    } else if (!pel_word_is_one_of(word, length, silent)) {
        reader->scan->at = word;
        return pel_text_cursor_fail_number(reader->scan, error, "an OBJ statement");
    }
    skip_statement(reader->scan);
    return PEL_OK;
}

static pel_status read_statement(obj_reader *reader, pel_error *error)
{
    size_t length;
    const char *word = pel_text_cursor_word(reader->scan, &length);
    if (length == 1 && word[0] == 'v')
        return read_vertex(reader, error);
    if (length == 1 && word[0] == 'f')
        return read_face(reader, error);
    if (length == 2 && word[0] == 'v' && word[1] == 't')
        return read_texture(reader, error);
    return read_other(reader, word, length, error);
}

static pel_status read_statements(obj_reader *reader, pel_error *error)
{
    pel_text_cursor *scan = reader->scan;
    pel_status status = PEL_OK;
    for (pel_text_cursor_skip_comments(scan); scan->at < scan->end && status == PEL_OK;
         pel_text_cursor_skip_comments(scan))
        status = read_statement(reader, error);
    return status;
}

static bool is_coloured(const obj_reader *reader)
{
    return reader->coloured_count > 0 && reader->coloured_count == reader->builder.vertex_count;
}

/* every vertex has texture coordinates, and no other ones */
static bool is_mapped(const obj_reader *reader)
{
    bool all =
        reader->mapped_count > 0 && reader->seam_count == 0 && reader->mapped_count == reader->builder.vertex_count;
    for (size_t v = 0; all && v < reader->mapped_count; v++)
        all = reader->texture_of[v] > 0 && isfinite(reader->textures[reader->texture_of[v] - 1][0]) &&
              isfinite(reader->textures[reader->texture_of[v] - 1][1]);
    return all;
}

/* the fields u and v */
static pel_status add_textures(const obj_reader *reader, pel_mesh *mesh, pel_error *error)
{
    static const char *const names[2] = {"u", "v"};
    double *values = pel_allocate((size_t)mesh->vertex_count, sizeof *values);
    pel_status status = values != NULL ? PEL_OK : pel_fail_memory(error);
    for (int i = 0; i < 2 && status == PEL_OK; i++) {
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            values[v] = reader->textures[reader->texture_of[v] - 1][i];
        status = pel_mesh_add_field(mesh, names[i], 1, values, error);
    }
    pel_free(values);
    return status;
}

/* the fields red, green and blue, as PLY files name them */
static pel_status add_colours(const obj_reader *reader, pel_mesh *mesh, pel_error *error)
{
    static const char *const names[3] = {"red", "green", "blue"};
    double *values = pel_allocate((size_t)mesh->vertex_count, sizeof *values);
    pel_status status = values != NULL ? PEL_OK : pel_fail_memory(error);
    for (int i = 0; i < 3 && status == PEL_OK; i++) {
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            values[v] = reader->colours[v][i];
        status = pel_mesh_add_field(mesh, names[i], 1, values, error);
    }
    pel_free(values);
    return status;
}

static void note_ignored(const obj_reader *reader, const pel_log *log)
{
    if (reader->curve_count > 0)
        pel_log_line(log, "%zu points and lines ignored", reader->curve_count);
    if (reader->extra_count > 0 && !is_coloured(reader))
        pel_log_line(log, "colours or weights of %zu vertices ignored", reader->extra_count);
    if (reader->seam_count > 0)
        pel_log_line(log, "texture coordinates ignored: %zu corners on seams have others than their vertex",
                     reader->seam_count);
    else if (reader->mapped_count > 0 && !is_mapped(reader))
        pel_log_line(log, "texture coordinates ignored: some vertices have none");
    if (reader->normal_count > 0)
        pel_log_line(log, "normals ignored");
    if (reader->lost_names > 0)
        pel_log_line(log, "groups beyond the first %d names ignored", MOST_GROUPS);
    if (reader->unknown_count > 0)
        pel_log_line(log, "%zu statements for curves, surfaces or display ignored", reader->unknown_count);
}

/* the mesh, and the fields of its groups */
static pel_status finish(obj_reader *reader, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    pel_polygon_soup *soup = &reader->builder;
    uint64_t *at_vertex = NULL, names = 0;
    if (reader->run_count > 0 && soup->largest_corner < (int64_t)soup->vertex_count) {
        at_vertex = pel_allocate(soup->vertex_count, sizeof *at_vertex);
        if (at_vertex == NULL)
            return pel_fail_memory(error);
        names = spread_names(reader, at_vertex);
    }
    const bool coloured = is_coloured(reader), mapped = is_mapped(reader);
    pel_status status = pel_polygon_soup_finish(soup, reader->scan, log, mesh, error);
    bool made = status == PEL_OK;
    if (status == PEL_OK && names != 0)
        status = add_groups(reader, at_vertex, names, *mesh, error);
    if (status == PEL_OK && coloured)
        status = add_colours(reader, *mesh, error);
    if (status == PEL_OK && mapped)
        status = add_textures(reader, *mesh, error);
    if (made && status != PEL_OK) {
        pel_mesh_destroy(*mesh);
        *mesh = NULL;
    }
    pel_free(at_vertex);
    return status;
}

pel_status pel_obj_read(pel_text_cursor *scan, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    obj_reader reader = {.scan = scan};
    pel_polygon_soup_init(&reader.builder, 1);
    pel_status status = read_statements(&reader, error);
    if (status == PEL_OK) {
        note_ignored(&reader, log);
        status = finish(&reader, log, mesh, error);
    }
    pel_polygon_soup_free(&reader.builder);
    pel_free(reader.runs);
    PEL_FREE_ALL(reader.colours, reader.textures, reader.texture_of);
    return status;
}

bool pel_obj_matches(const pel_text_cursor *scan)
{
    static const char *const words[] = {"v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl", NULL};
    pel_text_cursor ahead = *scan;
    pel_text_cursor_skip_comments(&ahead);
    size_t length;
    const char *word = pel_text_cursor_word(&ahead, &length);
    return pel_word_is_one_of(word, length, words);
}

/* the number of the body of a triangle, by the field `body`; -1 without that */
static double body_of(const pel_field *body, const int32_t *corners)
{
    return body != NULL && body->component_count == 1 ? body->values[corners[0]] : -1;
}

/* with the field `body` each body is an object */
void pel_obj_write(pel_file_writer *writer, const pel_mesh *mesh)
{
    const pel_field *body = pel_mesh_field(mesh, "body");
    double last = -1;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        pel_write_numbers(writer, "v ", mesh->positions[v]);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *c = mesh->triangles[t];
        double number = body_of(body, c);
        if (number >= 0 && (number < last || number > last))
            pel_file_writer_printf(writer, "o body_%.0f\n", number);
        last = number;
        pel_file_writer_printf(writer, "f %lld %lld %lld\n", c[0] + 1LL, c[1] + 1LL, c[2] + 1LL);
    }
}
