/* USD as text (openusd.org, "Crate and text file formats" and the schema UsdGeomMesh): one Xform with a Mesh for each
   body and tool. Triangles and texture coordinates are constant; points, normals and extent have a sample for each
   frame, or one value where there are no frames. */
#include "export/export.h"
#include "export/parts.h"

#include "base/number.h"
#include "base/room.h"
#include "base/status.h"
#include "io/file.h"
#include "math/extremes.h"

#include <stdio.h>
#include <string.h>

/* codes per second of frames at unequal intervals; largest relative difference of equal ones */
#define FREE_RATE 24.0
#define EQUAL 1e-6

typedef struct usd {
    pel_file_writer writer;
    const pel_export_source *source; /* null: a mesh alone */
    const pel_frames *frames;        /* null: a mesh alone */
    const pel_mesh *first;
    pel_export_parts by;
    int32_t *vertices;    /* (vertex_count) of the mesh, in the order of parts */
    double (*normals)[3]; /* (vertex_count x 3) */
    double rate;          /* time codes per second */
    bool is_even;         /* the code of a frame is its number */
} usd;

/* ---- words ---- */

static void put(usd *u, const char *text)
{
    pel_file_writer_write(&u->writer, text, strlen(text));
}

/* the shortest digits of the float, and no number that USD cannot read */
static void put_float(usd *u, double value)
{
    char text[PEL_NUMBER_SIZE];
    for (int digits = 6; digits <= 9; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        for (char *c = text; *c != '\0'; c++)
            *c = *c == ',' ? '.' : *c;
        const char *end = text + strlen(text);
        double back = 0;
        if (pel_number_parse(text, end, &back) == end && (float)back == (float)value)
            break;
    }
    put(u, text);
}

static void put_double(usd *u, double value)
{
    char text[PEL_NUMBER_SIZE];
    pel_number_print(text, value);
    put(u, text);
}

static void put_vector(usd *u, const double *values, int count)
{
    put(u, "(");
    for (int i = 0; i < count; i++) {
        put(u, i > 0 ? ", " : "");
        put_float(u, values[i]);
    }
    put(u, ")");
}

static const char *tool_name(const usd *u, int32_t p)
{
    return u->source != NULL ? pel_export_tool_name(u->source, p) : NULL;
}

/* An identifier: letters, digits and underscores, no digit first. The number keeps names apart that become the same. */
static void put_name(usd *u, int32_t p)
{
    const char *tool = tool_name(u, p);
    if (tool == NULL) {
        pel_file_writer_printf(&u->writer, "\"body_%d\"", (int)p);
        return;
    }
    char name[PEL_NAME_SIZE];
    snprintf(name, sizeof name, "%s", tool);
    for (char *c = name; *c != '\0'; c++)
        if (!(*c >= 'a' && *c <= 'z') && !(*c >= 'A' && *c <= 'Z') && !(*c >= '0' && *c <= '9'))
            *c = '_';
    pel_file_writer_printf(&u->writer, "\"tool_%d_%s\"", (int)(p - u->source->body_count), name);
}

/* ---- what is constant ---- */

static void find_rate(usd *u)
{
    const pel_frames *frames = u->frames;
    const double *times = frames->times;
    const double interval = frames->frame_count > 1 ? times[1] - times[0] : 1 / FREE_RATE;
    u->is_even = true;
    for (int32_t f = 1; f < frames->frame_count; f++)
        u->is_even &= fabs(times[f] - times[0] - f * interval) <= EQUAL * f * interval;
    u->rate = u->is_even ? 1 / interval : FREE_RATE;
    /* a whole number of frames per second that rounding has changed */
    const double whole = floor(u->rate + 0.5);
    if (fabs(u->rate - whole) <= EQUAL * whole)
        u->rate = whole;
}

static double code_of(const usd *u, int32_t frame)
{
    return u->is_even ? frame : u->frames->times[frame] * u->rate;
}

static void put_head(usd *u)
{
    put(u, "#usda 1.0\n(\n    doc = \"pellicle " PEL_VERSION "\"\n    defaultPrim = \"run\"\n    upAxis = \"Z\"\n"
           "    metersPerUnit = 1");
    if (u->frames != NULL) {
        put(u, "\n    startTimeCode = ");
        put_double(u, code_of(u, 0));
        put(u, "\n    endTimeCode = ");
        put_double(u, code_of(u, u->frames->frame_count - 1));
        put(u, "\n    timeCodesPerSecond = ");
        put_double(u, u->rate);
        put(u, "\n    framesPerSecond = ");
        put_double(u, u->rate);
    }
    put(u, "\n)\n\ndef Xform \"run\" (\n    kind = \"component\"\n)\n{\n");
}

static void put_triangles(usd *u, const pel_export_part *of)
{
    put(u, "        int[] faceVertexCounts = [");
    for (size_t i = 0; i < of->index_count; i += 3)
        put(u, i > 0 ? ", 3" : "3");
    put(u, "]\n        int[] faceVertexIndices = [");
    for (size_t i = 0; i < of->index_count; i++)
        pel_file_writer_printf(&u->writer, "%s%u", i > 0 ? ", " : "", (unsigned)u->by.indices[of->index_begin + i]);
    put(u, "]\n");
}

/* both texture coordinates of a vertex; false if the frames have none */
static bool find_coordinates(const pel_mesh *mesh, const double *values[2], int32_t *stride)
{
    static const char *const pairs[][2] = {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}};
    static const char *const vectors[] = {"st", "uv"};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) {
        const pel_field *field = pel_mesh_field(mesh, vectors[i]);
        if (field != NULL && field->component_count == 2) {
            values[0] = field->values;
            values[1] = field->values + 1;
            *stride = 2;
            return true;
        }
    }
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        const pel_field *a = pel_mesh_field(mesh, pairs[i][0]), *b = pel_mesh_field(mesh, pairs[i][1]);
        if (a != NULL && b != NULL && a->component_count == 1 && b->component_count == 1) {
            values[0] = a->values;
            values[1] = b->values;
            *stride = 1;
            return true;
        }
    }
    return false;
}

static void put_coordinates(usd *u, const pel_export_part *of)
{
    const double *values[2];
    int32_t stride;
    if (!find_coordinates(u->first, values, &stride))
        return;
    put(u, "        texCoord2f[] primvars:st = [");
    for (size_t i = 0; i < of->vertex_count; i++) {
        const size_t v = (size_t)u->vertices[of->vertex_begin + i] * (size_t)stride;
        put(u, i > 0 ? ", " : "");
        put_vector(u, (double[2]){values[0][v], values[1][v]}, 2);
    }
    put(u, "] (\n            interpolation = \"vertex\"\n        )\n");
}

/* ---- samples ---- */

static void put_rows(usd *u, const pel_export_part *of, const double (*rows)[3])
{
    for (size_t i = 0; i < of->vertex_count; i++) {
        put(u, i > 0 ? ", " : "");
        put_vector(u, rows[u->vertices[of->vertex_begin + i]], 3);
    }
}

static void put_extent(usd *u, const pel_export_part *of, const double (*positions)[3])
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (size_t i = 0; i < of->vertex_count; i++)
        for (int c = 0; c < 3; c++) {
            const double x = positions[u->vertices[of->vertex_begin + i]][c];
            low[c] = pel_min(low[c], x);
            high[c] = pel_max(high[c], x);
        }
    put_vector(u, low, 3);
    put(u, ", ");
    put_vector(u, high, 3);
}

typedef enum sampled { POINTS, NORMALS, EXTENT, SAMPLED_COUNT } sampled;

static void put_sample(usd *u, const pel_export_part *of, const pel_mesh *mesh, sampled what)
{
    const double(*positions)[3] = (const double(*)[3])mesh->positions;
    if (what == EXTENT) {
        put_extent(u, of, positions);
    } else if (what == POINTS) {
        put_rows(u, of, positions);
    } else {
        pel_export_normals(mesh, u->normals);
        put_rows(u, of, (const double(*)[3])u->normals);
    }
}

static pel_status put_samples(usd *u, const pel_export_part *of, sampled what, pel_error *error)
{
    static const char *const heads[SAMPLED_COUNT] = {"point3f[] points", "normal3f[] normals", "float3[] extent"};
    if (u->frames == NULL) {
        pel_file_writer_printf(&u->writer, "        %s = [", heads[what]);
        put_sample(u, of, u->first, what);
        put(u, what == NORMALS ? "] (\n            interpolation = \"vertex\"\n        )\n" : "]\n");
        return PEL_OK;
    }
    if (what == NORMALS)
        put(u, "        normal3f[] normals (\n            interpolation = \"vertex\"\n        )\n");
    pel_file_writer_printf(&u->writer, "        %s.timeSamples = {\n", heads[what]);
    for (int32_t f = 0; f < u->frames->frame_count; f++) {
        pel_mesh *mesh;
        pel_status status = pel_export_read(u->source, f, &mesh, error);
        if (status != PEL_OK)
            return status;
        put(u, "            ");
        put_double(u, code_of(u, f));
        put(u, ": [");
        put_sample(u, of, mesh, what);
        put(u, "],\n");
        pel_mesh_destroy(mesh);
    }
    put(u, "        }\n");
    return PEL_OK;
}

/* ---- the file ---- */

static pel_status put_part(usd *u, int32_t p, pel_error *error)
{
    const pel_export_part *of = &u->by.parts[p];
    pel_status status = PEL_OK;
    put(u, "    def Mesh ");
    put_name(u, p);
    put(u, "\n    {\n        uniform token subdivisionScheme = \"none\"\n        uniform bool doubleSided = 1\n");
    put(u, "        color3f[] primvars:displayColor = [");
    put(u, tool_name(u, p) != NULL ? "(0.45, 0.5, 0.56)]\n" : "(0.8, 0.55, 0.45)]\n");
    put_triangles(u, of);
    put_coordinates(u, of);
    for (int what = 0; status == PEL_OK && what < SAMPLED_COUNT; what++)
        status = put_samples(u, of, (sampled)what, error);
    put(u, "    }\n");
    return status;
}

static pel_status write_file(const char *path, usd *u, pel_error *error)
{
    pel_status status = pel_file_writer_open(&u->writer, path, error);
    if (status != PEL_OK)
        return status;
    put_head(u);
    for (int32_t p = 0; status == PEL_OK && p < u->by.count; p++)
        status = put_part(u, p, error);
    put(u, "}\n");
    if (status == PEL_OK)
        return pel_file_writer_commit(&u->writer, error);
    pel_file_writer_abandon(&u->writer);
    return status;
}

static pel_status export_all(const char *path, usd *u, pel_error *error)
{
    pel_status status = pel_export_parts_create(u->first, &u->by, error);
    const int32_t count = u->first->vertex_count;
    if (status == PEL_OK && !PEL_ALLOCATE_ALL(PEL_ROOM(u->vertices, count), PEL_ROOM(u->normals, count)))
        status = pel_fail_memory(error);
    if (status == PEL_OK) {
        for (int32_t v = 0; v < count; v++)
            u->vertices[u->by.place[v]] = v;
        if (u->frames != NULL)
            find_rate(u);
        status = write_file(path, u, error);
    }
    PEL_FREE_ALL(u->normals, u->vertices);
    pel_export_parts_free(&u->by);
    return status;
}

pel_status pel_export_usd(const char *path, const pel_frames *frames, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(frames, error);
    pel_export_source source;
    pel_mesh *first = NULL;
    pel_status status = pel_export_open(&source, frames, error);
    if (status == PEL_OK)
        status = pel_export_check_size(&source, error);
    if (status == PEL_OK)
        status = pel_export_check_times(frames, error);
    if (status == PEL_OK)
        status = pel_export_read(&source, 0, &first, error);
    if (status == PEL_OK)
        status = export_all(path, &(usd){.source = &source, .frames = frames, .first = first}, error);
    pel_mesh_destroy(first);
    pel_export_close(&source);
    return status;
}

pel_status pel_export_usd_mesh(const char *path, const pel_mesh *mesh, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(mesh, error);
    for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
        if (!pel_export_fits_float(mesh->positions[i / 3][i % 3]))
            return pel_refuse(error, PEL_BAD_ARGUMENT, "scale the mesh", "a coordinate of vertex %zu exceeds a float",
                              i / 3);
    return export_all(path, &(usd){.first = mesh}, error);
}
