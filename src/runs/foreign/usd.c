#include "foreign/usd.h"

#include "base/memory.h"
#include "base/room.h"
#include "io/file.h"
#include "io/polygon_soup.h"
#include "mesh/seam.h"
#include "sequence/sequence.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const again = "export the file again, or as OBJ, PLY or glTF";

/* prims within prims; of all frames together, of vertices (1.5 GB) and of prims, which take as long as PRIM of them */
enum { MOST_DEPTH = 200, PRIM = 16 };
#define MOST_PLACES 64e6

typedef struct usd_prim {
    int32_t parent; /* -1 = the stage */
    bool is_hidden; /* or a prim around it is */
    bool is_used;   /* a mesh that is shown stands in it */
    pel_usd_ops ops;
    pel_place world; /* of place_prims */
} usd_prim;

typedef struct usd_mesh {
    int32_t prim;
    const char *at; /* in the text */
    pel_usd_samples points, sizes, corners, holes;
    bool is_left_handed;
} usd_mesh;

typedef struct usd_reader {
    pel_text_cursor scan;
    usd_prim *prims; /* (prim_count) parents before children */
    size_t prim_count, prim_capacity;
    usd_mesh *meshes; /* (mesh_count) */
    size_t mesh_count, mesh_capacity;
    double unit; /* metres; 0 = the file does not say */
    double rate; /* time codes per second */
    bool is_y_up;
    size_t other_count;       /* shapes without triangles */
    size_t bone_count;        /* skeletons */
    size_t elsewhere_count;   /* prims and layers in other places of the file or in other files */
    const char *elsewhere_at; /* the first of them */
    pel_polygon_soup soup;
    double *codes; /* (code_count) rising, of all samples */
    size_t code_count, code_capacity;
} usd_reader;

/* ---- metadata ---- */

static bool is_one_of(const char *word, size_t length, const char *const *words)
{
    for (; *words != NULL; words++)
        if (pel_usd_is(word, length, *words))
            return true;
    return false;
}

/* a number or a word, without quotes */
static pel_status read_plain(usd_reader *r, const char **text, size_t *length, pel_error *error)
{
    pel_text_cursor_skip_comments(&r->scan);
    if (r->scan.at < r->scan.end && (*r->scan.at == '"' || *r->scan.at == '\''))
        return pel_usd_read_string(&r->scan, text, length, error);
    *text = r->scan.at;
    pel_status status = pel_usd_pass_value(&r->scan, error);
    *length = (size_t)(r->scan.at - *text);
    return status;
}

static pel_status read_positive(usd_reader *r, double *number, pel_error *error)
{
    pel_usd_samples one = {0};
    pel_text_cursor_skip_comments(&r->scan);
    const char *at = r->scan.at;
    pel_status status = pel_usd_read_value(&r->scan, &one, error);
    if (status == PEL_OK && !(one.value_count == 1 && one.values[0] > 0 && isfinite(one.values[0])))
        status = pel_text_cursor_fail(&r->scan, at, error, again, "this must be a number above 0");
    if (status == PEL_OK)
        *number = one.values[0];
    pel_usd_samples_free(&one);
    return status;
}

static pel_status read_layer_entry(usd_reader *r, const char *key, size_t length, pel_error *error)
{
    const char *text;
    size_t size;
    if (pel_usd_is(key, length, "metersPerUnit"))
        return read_positive(r, &r->unit, error);
    if (pel_usd_is(key, length, "timeCodesPerSecond"))
        return read_positive(r, &r->rate, error);
    if (pel_usd_is(key, length, "subLayers") && r->elsewhere_count++ == 0)
        r->elsewhere_at = key;
    pel_status status = read_plain(r, &text, &size, error);
    if (status == PEL_OK && pel_usd_is(key, length, "upAxis"))
        r->is_y_up = pel_usd_is(text, size, "Y");
    return status;
}

static pel_status read_prim_entry(usd_reader *r, usd_prim *prim, const char *key, size_t length, pel_error *error)
{
    static const char *const arcs[] = {"references", "payload", "inherits", "specializes", NULL};
    const char *text;
    size_t size;
    if (is_one_of(key, length, arcs) && r->elsewhere_count++ == 0)
        r->elsewhere_at = key;
    pel_status status = read_plain(r, &text, &size, error);
    if (status == PEL_OK && pel_usd_is(key, length, "active"))
        prim->is_hidden |= pel_usd_is(text, size, "false") || pel_usd_is(text, size, "0");
    return status;
}

/* entries in brackets, if there are any: of the layer without a prim */
static pel_status read_metadata(usd_reader *r, usd_prim *prim, pel_error *error)
{
    pel_text_cursor *scan = &r->scan;
    pel_usd_pass_space(scan);
    if (scan->at == scan->end || *scan->at != '(')
        return PEL_OK;
    scan->at++;
    for (pel_usd_pass_space(scan); scan->at < scan->end && *scan->at != ')'; pel_usd_pass_space(scan)) {
        const char *key, *text;
        size_t length;
        pel_status status = PEL_OK;
        if (*scan->at == '"' || *scan->at == '\'') {
            status = pel_usd_read_string(scan, &text, &length, error);
        } else if (*scan->at == '=') {
            return pel_text_cursor_fail(scan, scan->at, error, again, "a key is missing before '='");
        } else {
            /* `prepend references = ...`: the last word is the key */
            do {
                key = pel_usd_word(scan, &length);
                pel_text_cursor_skip_blanks(scan);
            } while (length > 0 && scan->at < scan->end && *scan->at != '=' && !pel_is_line_end(*scan->at));
            if (length == 0 || scan->at == scan->end || *scan->at != '=')
                return pel_text_cursor_fail(scan, scan->at, error, again, "'=' is missing after a key");
            scan->at++;
            status =
                prim == NULL ? read_layer_entry(r, key, length, error) : read_prim_entry(r, prim, key, length, error);
        }
        if (status != PEL_OK)
            return status;
    }
    if (scan->at == scan->end)
        return pel_text_cursor_fail(scan, scan->at, error, again, "')' is missing: the file is cut off or damaged");
    scan->at++;
    return PEL_OK;
}

/* ---- properties ---- */

static pel_status read_numbers(usd_reader *r, bool is_timed, pel_usd_samples *samples, pel_error *error)
{
    return is_timed ? pel_usd_read_samples(&r->scan, samples, error) : pel_usd_read_value(&r->scan, samples, error);
}

static pel_status read_op(usd_reader *r, pel_usd_ops *ops, const char *name, size_t length, bool is_timed,
                          pel_error *error)
{
    pel_usd_op *op = ops->ops;
    size_t i = 0;
    while (i < ops->count && !(ops->ops[i].length == length && memcmp(ops->ops[i].name, name, length) == 0))
        i++;
    if (i == PEL_USD_OPS)
        return pel_text_cursor_fail(&r->scan, name, error, again, "a prim has more than %d xformOps", (int)PEL_USD_OPS);
    if (i == ops->count) {
        if (!pel_reserve((void **)&ops->ops, &ops->capacity, ops->count + 1, sizeof *ops->ops))
            return pel_fail_memory(error);
        ops->ops[ops->count++] = (pel_usd_op){.name = name, .length = length};
    }
    op = &ops->ops[i];
    return read_numbers(r, is_timed, &op->samples, error);
}

/* the value of a property of a mesh; null = not one that we need */
static pel_usd_samples *find_samples(usd_mesh *mesh, const char *name, size_t length)
{
    if (mesh == NULL)
        return NULL;
    return pel_usd_is(name, length, "points")              ? &mesh->points
           : pel_usd_is(name, length, "faceVertexCounts")  ? &mesh->sizes
           : pel_usd_is(name, length, "faceVertexIndices") ? &mesh->corners
           : pel_usd_is(name, length, "holeIndices")       ? &mesh->holes
                                                           : NULL;
}

static pel_status read_value(usd_reader *r, int32_t p, usd_mesh *mesh, const char *name, size_t length, bool is_timed,
                             pel_error *error)
{
    usd_prim *prim = &r->prims[p];
    pel_usd_samples *samples = find_samples(mesh, name, length);
    const char *text;
    size_t size;
    if (samples != NULL)
        return read_numbers(r, is_timed, samples, error);
    if (length > 8 && memcmp(name, "xformOp:", 8) == 0)
        return read_op(r, &prim->ops, name, length, is_timed, error);
    pel_status status = read_plain(r, &text, &size, error);
    if (is_timed || status != PEL_OK)
        return status;
    if (pel_usd_is(name, length, "xformOpOrder")) {
        prim->ops.order = text;
        prim->ops.order_end = text + size;
    } else if (pel_usd_is(name, length, "visibility")) {
        prim->is_hidden |= pel_usd_is(text, size, "invisible");
    } else if (pel_usd_is(name, length, "purpose")) {
        prim->is_hidden |= pel_usd_is(text, size, "guide") || pel_usd_is(text, size, "proxy");
    } else if (mesh != NULL && pel_usd_is(name, length, "orientation")) {
        mesh->is_left_handed = pel_usd_is(text, size, "leftHanded");
    }
    return PEL_OK;
}

/* [custom] [uniform] float3[] name[.timeSamples] [= value] [(metadata)]; the first word has been read */
static pel_status read_property(usd_reader *r, int32_t p, usd_mesh *mesh, const char *name, size_t length,
                                pel_error *error)
{
    static const char *const timed = ".timeSamples";
    const size_t timed_length = strlen(timed);
    pel_text_cursor *scan = &r->scan;
    pel_status status = PEL_OK;
    for (;;) {
        size_t next_length;
        pel_text_cursor_skip_blanks(scan);
        const char *next = pel_usd_word(scan, &next_length);
        if (next_length == 0)
            break;
        name = next;
        length = next_length;
    }
    if (scan->at < scan->end && *scan->at == '=') {
        scan->at++;
        const bool is_timed = length > timed_length && memcmp(name + length - timed_length, timed, timed_length) == 0;
        status = read_value(r, p, mesh, name, is_timed ? length - timed_length : length, is_timed, error);
    }
    pel_text_cursor_skip_blanks(scan);
    if (status == PEL_OK && scan->at < scan->end && *scan->at == '(')
        status = pel_usd_pass_group(scan, error);
    return status;
}

/* ---- prims ---- */

/* `variantSet "shape" = { ... }` and `reorder nameChildren = [...]`: after the first word */
static pel_status pass_statement(usd_reader *r, bool is_variant, pel_error *error)
{
    pel_text_cursor *scan = &r->scan;
    if (is_variant && r->elsewhere_count++ == 0)
        r->elsewhere_at = scan->at;
    while (scan->at < scan->end && *scan->at != '=' && !pel_is_line_end(*scan->at))
        scan->at++;
    if (scan->at == scan->end || *scan->at != '=')
        return pel_text_cursor_fail(scan, scan->at, error, again, "'=' is missing");
    scan->at++;
    return pel_usd_pass_value(scan, error);
}

static void count_kind(usd_reader *r, const char *type, size_t length)
{
    static const char *const shapes[] = {"Cube",          "Sphere",         "Cylinder",    "Cone",
                                         "Capsule",       "Plane",          "BasisCurves", "NurbsCurves",
                                         "Points",        "PointInstancer", "TetMesh",     "NurbsPatch",
                                         "HermiteCurves", "Cylinder_1",     "Capsule_1",   NULL};
    r->other_count += is_one_of(type, length, shapes);
    r->bone_count += pel_usd_is(type, length, "Skeleton");
}

static pel_status add_prim(usd_reader *r, int32_t parent, pel_error *error)
{
    if (r->prim_count >= INT32_MAX ||
        !pel_reserve((void **)&r->prims, &r->prim_capacity, r->prim_count + 1, sizeof *r->prims))
        return pel_fail_memory(error);
    r->prims[r->prim_count++] = (usd_prim){.parent = parent};
    return PEL_OK;
}

static pel_status add_mesh(usd_reader *r, const char *at, pel_error *error)
{
    if (!pel_reserve((void **)&r->meshes, &r->mesh_capacity, r->mesh_count + 1, sizeof *r->meshes))
        return pel_fail_memory(error);
    r->meshes[r->mesh_count++] = (usd_mesh){.prim = (int32_t)r->prim_count - 1, .at = at};
    return PEL_OK;
}

static pel_status read_prim(usd_reader *r, int32_t parent, int depth, bool is_defined, pel_error *error);

/* the rest of a prim; `mesh` is the number of its mesh or -1 */
static pel_status read_body(usd_reader *r, int32_t prim, int64_t mesh, int depth, pel_error *error)
{
    static const char *const specifiers[] = {"def", "over", "class", NULL};
    pel_text_cursor *scan = &r->scan;
    const char *begin = scan->at;
    pel_status status = PEL_OK;
    while (status == PEL_OK) {
        size_t length;
        pel_usd_pass_space(scan);
        if (scan->at == scan->end)
            return pel_text_cursor_fail(scan, begin, error, again, "a prim is not closed: the file is cut off");
        if (*scan->at == '}') {
            scan->at++;
            return PEL_OK;
        }
        const char *word = pel_usd_word(scan, &length);
        if (length == 0)
            return pel_text_cursor_fail(scan, word, error, again, "a property or a prim should stand here");
        if (is_one_of(word, length, specifiers))
            status = read_prim(r, prim, depth + 1, pel_usd_is(word, length, "def"), error);
        else if (pel_usd_is(word, length, "variantSet") || pel_usd_is(word, length, "reorder"))
            status = pass_statement(r, pel_usd_is(word, length, "variantSet"), error);
        else
            status = read_property(r, prim, mesh >= 0 ? &r->meshes[mesh] : NULL, word, length, error);
    }
    return status;
}

/* TYPE "name" (metadata) { ... } after its specifier; what is not defined, as classes, is not shown */
static pel_status read_prim(usd_reader *r, int32_t parent, int depth, bool is_defined, pel_error *error)
{
    pel_text_cursor *scan = &r->scan;
    const char *type, *name;
    size_t type_length, name_length;
    pel_text_cursor_skip_blanks(scan);
    const char *at = scan->at;
    type = pel_usd_word(scan, &type_length);
    pel_text_cursor_skip_blanks(scan);
    if (scan->at == scan->end || *scan->at != '"')
        return pel_text_cursor_fail(scan, scan->at, error, again, "the name of a prim is missing");
    if (depth > MOST_DEPTH)
        return pel_text_cursor_fail(scan, at, error, again, "prims stand more than %d deep in each other",
                                    (int)MOST_DEPTH);
    pel_status status = pel_usd_read_string(scan, &name, &name_length, error);
    if (status == PEL_OK)
        status = add_prim(r, parent, error);
    if (status != PEL_OK)
        return status;
    const int32_t prim = (int32_t)r->prim_count - 1;
    const bool is_mesh = pel_usd_is(type, type_length, "Mesh");
    r->prims[prim].is_hidden |= !is_defined;
    count_kind(r, type, type_length);
    if (is_mesh)
        status = add_mesh(r, at, error);
    const int64_t mesh = is_mesh ? (int64_t)r->mesh_count - 1 : -1;
    if (status == PEL_OK)
        status = read_metadata(r, &r->prims[prim], error);
    if (status != PEL_OK)
        return status;
    pel_usd_pass_space(scan);
    if (scan->at == scan->end || *scan->at != '{')
        return pel_text_cursor_fail(scan, scan->at, error, again, "'{' is missing after the name of a prim");
    scan->at++;
    return read_body(r, prim, mesh, depth, error);
}

static pel_status read_stage(usd_reader *r, pel_error *error)
{
    static const char *const specifiers[] = {"def", "over", "class", NULL};
    pel_text_cursor *scan = &r->scan;
    pel_status status = read_metadata(r, NULL, error);
    for (pel_usd_pass_space(scan); status == PEL_OK && scan->at < scan->end; pel_usd_pass_space(scan)) {
        size_t length;
        const char *word = pel_usd_word(scan, &length);
        if (is_one_of(word, length, specifiers))
            status = read_prim(r, -1, 1, pel_usd_is(word, length, "def"), error);
        else if (pel_usd_is(word, length, "reorder"))
            status = pass_statement(r, false, error);
        else
            status = pel_text_cursor_fail(scan, word, error, again, "a prim should begin here");
    }
    return status;
}

/* ---- time ---- */

static int compare_codes(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static pel_status add_codes(usd_reader *r, const pel_usd_samples *samples, pel_error *error)
{
    if (!samples->is_timed)
        return PEL_OK;
    if (!pel_reserve((void **)&r->codes, &r->code_capacity, r->code_count + samples->count, sizeof *r->codes))
        return pel_fail_memory(error);
    if (samples->count > 0)
        memcpy(r->codes + r->code_count, samples->codes, samples->count * sizeof *r->codes);
    r->code_count += samples->count;
    return PEL_OK;
}

static bool is_shown(const usd_reader *r, const usd_mesh *mesh)
{
    return !r->prims[mesh->prim].is_hidden && mesh->points.count > 0 && mesh->sizes.count > 0 &&
           mesh->corners.count > 0;
}

/* what is hidden with a prim around it, and what a mesh that is shown stands in */
static void mark_prims(usd_reader *r)
{
    for (size_t p = 0; p < r->prim_count; p++)
        r->prims[p].is_hidden |= r->prims[p].parent >= 0 && r->prims[r->prims[p].parent].is_hidden;
    for (size_t m = 0; m < r->mesh_count; m++)
        for (int32_t p = is_shown(r, &r->meshes[m]) ? r->meshes[m].prim : -1; p >= 0; p = r->prims[p].parent)
            r->prims[p].is_used = true;
}

/* the time codes at which a mesh that is shown has a sample, or a prim around it */
static pel_status find_codes(usd_reader *r, pel_error *error)
{
    pel_status status = PEL_OK;
    for (size_t m = 0; m < r->mesh_count && status == PEL_OK; m++)
        if (is_shown(r, &r->meshes[m]))
            status = add_codes(r, &r->meshes[m].points, error);
    for (size_t p = 0; p < r->prim_count; p++)
        for (size_t i = 0; r->prims[p].is_used && i < r->prims[p].ops.count && status == PEL_OK; i++)
            status = add_codes(r, &r->prims[p].ops.ops[i].samples, error);
    if (status != PEL_OK || r->code_count == 0)
        return status;
    qsort(r->codes, r->code_count, sizeof *r->codes, compare_codes);
    size_t kept = 1;
    for (size_t i = 1; i < r->code_count; i++)
        if (r->codes[i] > r->codes[kept - 1])
            r->codes[kept++] = r->codes[i];
    r->code_count = kept;
    return PEL_OK;
}

static pel_status place_prims(usd_reader *r, double code, pel_error *error)
{
    pel_status status = PEL_OK;
    pel_place stage = pel_place_identity();
    for (int i = 0; i < 3 && r->unit > 0; i++)
        stage.linear[i][i] = r->unit;
    for (size_t p = 0; p < r->prim_count && status == PEL_OK; p++) {
        usd_prim *prim = &r->prims[p];
        pel_place own;
        bool is_reset;
        status = pel_usd_ops_place(&prim->ops, &r->scan, code, &own, &is_reset, error);
        const pel_place *in = prim->parent < 0 || is_reset ? &stage : &r->prims[prim->parent].world;
        prim->world = pel_place_product(in, &own);
    }
    return status;
}

/* ---- meshes ---- */

static size_t point_count(const usd_mesh *mesh)
{
    size_t count;
    pel_usd_sample(&mesh->points, 0, &count);
    return count / 3;
}

static pel_status fail_mesh(const usd_reader *r, const usd_mesh *mesh, pel_error *error, const char *what)
{
    return pel_text_cursor_fail(&r->scan, mesh->at, error, again, "%s", what);
}

/* point v of a mesh at a code, in the world */
static pel_status place_point(const usd_reader *r, const usd_mesh *mesh, double code, size_t v, double placed[3],
                              pel_error *error)
{
    double share, x[3];
    size_t count;
    const size_t i = pel_usd_sample_at(&mesh->points, code, &share);
    const double *here = pel_usd_sample(&mesh->points, i, &count) + 3 * v;
    const double *next = share > 0 ? here + count : here;
    for (int k = 0; k < 3; k++)
        x[k] = (1 - share) * here[k] + share * next[k];
    pel_place_point(&r->prims[mesh->prim].world, x, placed);
    if (isfinite(placed[0]) && isfinite(placed[1]) && isfinite(placed[2]))
        return PEL_OK;
    return fail_mesh(r, mesh, error, "a coordinate is not finite where the prims place the mesh");
}

static pel_status check_mesh(const usd_reader *r, const usd_mesh *mesh, pel_error *error)
{
    size_t values, sizes, corners;
    double sum = 0;
    for (size_t i = 0; i < mesh->points.count; i++) {
        pel_usd_sample(&mesh->points, i, &values);
        if (values % 3 != 0 || values / 3 != point_count(mesh))
            return fail_mesh(r, mesh, error, "the number of points of a mesh changes, or is no multiple of three");
    }
    for (size_t i = 0; i < mesh->points.value_count; i++)
        if (!isfinite(mesh->points.values[i]))
            return fail_mesh(r, mesh, error, "a point of a mesh is not finite");
    if (mesh->sizes.count > 1 || mesh->corners.count > 1)
        return fail_mesh(r, mesh, error, "the faces of a mesh change over time");
    const double *size = pel_usd_sample(&mesh->sizes, 0, &sizes);
    const double *corner = pel_usd_sample(&mesh->corners, 0, &corners);
    for (size_t f = 0; f < sizes; f++) {
        if (!(size[f] >= 0 && size[f] == floor(size[f])))
            return fail_mesh(r, mesh, error, "faceVertexCounts must be whole numbers from 0");
        sum += size[f];
    }
    if (sum != (double)corners)
        return fail_mesh(r, mesh, error, "the sum of faceVertexCounts is not the number of faceVertexIndices");
    for (size_t c = 0; c < corners; c++)
        if (!(corner[c] >= 0 && corner[c] == floor(corner[c]) && corner[c] < (double)point_count(mesh)))
            return fail_mesh(r, mesh, error, "a number of faceVertexIndices is no point of the mesh");
    return PEL_OK;
}

static pel_status mark_holes(const usd_reader *r, const usd_mesh *mesh, size_t face_count, bool *is_hole,
                             pel_error *error)
{
    size_t count = 0;
    const double *holes = mesh->holes.count > 0 ? pel_usd_sample(&mesh->holes, 0, &count) : NULL;
    for (size_t i = 0; i < count; i++) {
        if (!(holes[i] >= 0 && holes[i] < (double)face_count))
            return fail_mesh(r, mesh, error, "a number of holeIndices is no face of the mesh");
        is_hole[(size_t)holes[i]] = true;
    }
    return PEL_OK;
}

static pel_status add_faces(usd_reader *r, const usd_mesh *mesh, int32_t first, pel_error *error)
{
    size_t face_count, corner_count;
    const double *size = pel_usd_sample(&mesh->sizes, 0, &face_count);
    const double *corner = pel_usd_sample(&mesh->corners, 0, &corner_count);
    const bool is_turned = mesh->is_left_handed != pel_place_mirrors(&r->prims[mesh->prim].world);
    bool *is_hole = pel_allocate(face_count, sizeof *is_hole);
    if (is_hole == NULL)
        return pel_fail_memory(error);
    pel_status status = mark_holes(r, mesh, face_count, is_hole, error);
    for (size_t f = 0; f < face_count && status == PEL_OK; corner += (size_t)size[f], f++) {
        const size_t count = is_hole[f] ? 0 : (size_t)size[f];
        bool has_room = true;
        for (size_t i = 0; i < count && has_room; i++)
            has_room =
                pel_polygon_soup_add_corner(&r->soup, first + (int32_t)corner[is_turned ? count - 1 - i : i], NULL);
        if (!has_room || (count > 0 && !pel_polygon_soup_end_polygon(&r->soup, count)))
            status = pel_fail_memory(error);
    }
    pel_free(is_hole);
    return status;
}

static pel_status add_surface(usd_reader *r, const usd_mesh *mesh, double code, pel_error *error)
{
    const size_t first = r->soup.vertex_count;
    pel_status status = check_mesh(r, mesh, error);
    if (status != PEL_OK)
        return status;
    if (first + point_count(mesh) > INT32_MAX)
        return pel_fail_memory(error);
    for (size_t v = 0; v < point_count(mesh); v++) {
        double placed[3];
        status = place_point(r, mesh, code, v, placed, error);
        if (status == PEL_OK && !pel_polygon_soup_add_vertex(&r->soup, placed))
            status = pel_fail_memory(error);
        if (status != PEL_OK)
            return status;
    }
    return add_faces(r, mesh, (int32_t)first, error);
}

/* ---- the whole ---- */

static void log_stage(const usd_reader *r, size_t shown, const pel_log *log)
{
    if (shown > 1)
        pel_log_line(log, "%zu meshes of the stage joined", shown);
    if (r->mesh_count > shown)
        pel_log_line(log, "%zu meshes left out: invisible, guide, proxy, class or without faces",
                     r->mesh_count - shown);
    if (r->other_count > 0)
        pel_log_line(log, "%zu shapes that are no meshes left out", r->other_count);
    if (r->bone_count > 0)
        pel_log_line(log, "%zu skeletons left out: bake the motion into the points", r->bone_count);
    if (r->elsewhere_count > 0)
        pel_log_line(log, "%zu references, layers or variants not followed: flatten the stage (usdcat --flatten)",
                     r->elsewhere_count);
    if (r->unit == 0)
        pel_log_line(log, "the file has no metersPerUnit: its coordinates are taken as metres");
    else if (r->unit != 1)
        pel_log_line(log, "coordinates multiplied by metersPerUnit = %g", r->unit);
    if (r->is_y_up)
        pel_log_line(log, "upAxis = \"Y\": in a scene write `up: y`, or rotate the mesh");
}

static pel_status check_head(usd_reader *r, pel_error *error)
{
    static const char binary[] = "PXR-USDC", zip[] = "PK\003\004", text[] = "#usda";
    pel_text_cursor *scan = &r->scan;
    const size_t size = (size_t)(scan->end - scan->at);
    if ((size >= 8 && memcmp(scan->at, binary, 8) == 0) || (size >= 4 && memcmp(scan->at, zip, 4) == 0))
        return pel_text_cursor_fail(scan, scan->at, error,
                                    "write it as text: usdcat -o NAME.usda FILE, or save as .usda",
                                    "the file is binary USD, of which only text is read");
    if (size < 5 || memcmp(scan->at, text, 5) != 0)
        return pel_text_cursor_fail(scan, scan->at, error, again, "a USD file begins with '#usda 1.0'");
    pel_text_cursor_skip_line(scan);
    return PEL_OK;
}

static pel_status fail_empty(const usd_reader *r, pel_error *error)
{
    if (r->elsewhere_count > 0)
        return pel_text_cursor_fail(&r->scan, r->elsewhere_at, error, "flatten it: usdcat --flatten -o NAME.usda FILE",
                                    "the stage has no visible mesh of its own, only references, layers or variants");
    return pel_text_cursor_fail(&r->scan, r->scan.end, error, "export meshes, and show them",
                                "the stage has no visible mesh");
}

/* the mesh at the first time code; new_number_of as of pel_seams_weld */
static pel_status read_mesh(usd_reader *r, const pel_log *log, pel_mesh **mesh, int32_t **new_number_of,
                            pel_error *error)
{
    size_t shown = 0;
    pel_status status = check_head(r, error);
    if (status == PEL_OK)
        status = read_stage(r, error);
    mark_prims(r);
    if (status == PEL_OK)
        status = find_codes(r, error);
    const double code = r->code_count > 0 ? r->codes[0] : 0;
    if (status == PEL_OK)
        status = place_prims(r, code, error);
    for (size_t m = 0; m < r->mesh_count && status == PEL_OK; m++) {
        shown += is_shown(r, &r->meshes[m]);
        if (is_shown(r, &r->meshes[m]))
            status = add_surface(r, &r->meshes[m], code, error);
    }
    if (status != PEL_OK)
        return status;
    if (shown == 0)
        return fail_empty(r, error);
    log_stage(r, shown, log);
    status = pel_polygon_soup_finish(&r->soup, &r->scan, log, mesh, error);
    return status == PEL_OK ? pel_seams_weld(*mesh, new_number_of, log, error) : status;
}

static pel_status pose_frames(usd_reader *r, const int32_t *new_number_of, int32_t vertex_count,
                              pel_sequence **sequence, pel_error *error)
{
    if (r->code_count == 0)
        return pel_text_cursor_fail(&r->scan, r->scan.end, error, "export it with its animation",
                                    "no visible mesh of the stage moves: nothing has samples over time");
    if (!((double)r->code_count * (vertex_count + (double)PRIM * (double)r->prim_count) < MOST_PLACES))
        return pel_text_cursor_fail(&r->scan, r->scan.end, error, "export fewer frames, or a coarser mesh",
                                    "%zu frames of %d vertices and %zu prims are more than %g places", r->code_count,
                                    (int)vertex_count, r->prim_count, MOST_PLACES);
    pel_status status = pel_sequence_allocate((int32_t)r->code_count, vertex_count, sequence, error);
    for (size_t f = 0; f < r->code_count && status == PEL_OK; f++) {
        double(*frame)[3] = (*sequence)->positions + f * (size_t)vertex_count;
        int32_t number = 0;
        (*sequence)->times[f] = (r->codes[f] - r->codes[0]) / r->rate;
        status = place_prims(r, r->codes[f], error);
        for (size_t m = 0; m < r->mesh_count && status == PEL_OK; m++)
            for (size_t v = 0; is_shown(r, &r->meshes[m]) && v < point_count(&r->meshes[m]) && status == PEL_OK; v++)
                status = place_point(r, &r->meshes[m], r->codes[f], v,
                                     frame[new_number_of != NULL ? new_number_of[number++] : number++], error);
    }
    if (status == PEL_OK)
        pel_sequence_finish(*sequence);
    return status;
}

static pel_status read_sequence(usd_reader *r, pel_sequence **sequence, pel_error *error)
{
    pel_mesh *mesh = NULL;
    int32_t *new_number_of = NULL;
    pel_status status = read_mesh(r, NULL, &mesh, &new_number_of, error);
    if (status == PEL_OK)
        status = pose_frames(r, new_number_of, mesh->vertex_count, sequence, error);
    if (status != PEL_OK) {
        pel_sequence_destroy(*sequence);
        *sequence = NULL;
    }
    pel_mesh_destroy(mesh);
    pel_free(new_number_of);
    return status;
}

static void free_reader(usd_reader *r)
{
    for (size_t p = 0; p < r->prim_count; p++)
        pel_usd_ops_free(&r->prims[p].ops);
    for (size_t m = 0; m < r->mesh_count; m++) {
        pel_usd_samples_free(&r->meshes[m].points);
        pel_usd_samples_free(&r->meshes[m].sizes);
        pel_usd_samples_free(&r->meshes[m].corners);
        pel_usd_samples_free(&r->meshes[m].holes);
    }
    pel_polygon_soup_free(&r->soup);
    PEL_FREE_ALL(r->prims, r->meshes, r->codes);
}

/* a mesh, or a sequence where mesh is null */
static pel_status parse(const char *name, const void *bytes, size_t size, const pel_log *log, pel_mesh **mesh,
                        pel_sequence **sequence, pel_error *error)
{
    const char *text = bytes;
    usd_reader r = {.scan = {.name = name, .begin = text, .at = text, .end = text + size}, .rate = 24};
    pel_polygon_soup_init(&r.soup, 0);
    pel_status status = mesh != NULL ? read_mesh(&r, log, mesh, NULL, error) : read_sequence(&r, sequence, error);
    if (status != PEL_OK && mesh != NULL) {
        pel_mesh_destroy(*mesh);
        *mesh = NULL;
    }
    free_reader(&r);
    return status;
}

static pel_status read_file(const char *path, const pel_log *log, pel_mesh **mesh, pel_sequence **sequence,
                            pel_error *error)
{
    char *bytes;
    size_t size;
    pel_status status = pel_file_read(path, &bytes, &size, error);
    if (status == PEL_OK)
        status = parse(path, bytes, size, log, mesh, sequence, error);
    pel_free(bytes);
    return status;
}

pel_status pel_usd_parse(const char *name, const void *bytes, size_t size, const pel_log *log, pel_mesh **mesh,
                         pel_error *error)
{
    *mesh = NULL;
    return parse(name, bytes, size, log, mesh, NULL, error);
}

pel_status pel_usd_read(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    *mesh = NULL;
    return read_file(path, log, mesh, NULL, error);
}

pel_status pel_usd_parse_sequence(const char *name, const void *bytes, size_t size, pel_sequence **sequence,
                                  pel_error *error)
{
    *sequence = NULL;
    return parse(name, bytes, size, NULL, NULL, sequence, error);
}

pel_status pel_usd_read_sequence(const char *path, pel_sequence **sequence, pel_error *error)
{
    *sequence = NULL;
    return read_file(path, NULL, NULL, sequence, error);
}

bool pel_usd_is_path(const char *path)
{
    static const char *const extensions[] = {"usda", "usd", "usdc", "usdz"};
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot != NULL && i < sizeof extensions / sizeof *extensions; i++) {
        pel_text_cursor ahead = {.at = dot + 1, .end = dot + strlen(dot)};
        if (pel_text_cursor_accept(&ahead, extensions[i]) && ahead.at == ahead.end)
            return true;
    }
    return false;
}
