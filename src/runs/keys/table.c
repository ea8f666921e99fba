#include "keys/table.h"

#include "def/row_words.h"
#include "geom/solid.h"
#include "keys/shape_rows.h"
#include "pellicle/preset.h"
#include "pellicle/scene.h"

#include <stdio.h>
#include <string.h>

/* members of a scene itself, which no fingerprint has */
#define SCENE(member) OF(SCENE, pel_scene, member, NONE)
#define OUTPUT(member) OF(OUTPUT, pel_output_def, member, NONE)

/* before the bodies, and after the solver, in the order of the reference page and of resolved scenes */
static const pel_def_row first_rows[] = {
    {"version", INTEGER, BETWEEN(1, 1), REQUIRED, .doc = "version of the scene format"},
    {"title", SCENE(title), TEXT, .doc = "title of the run, shown in reports"},
    {"up", SCENE(up), WORD("x", "y", "z"), .preset = "z",
     .doc = "axis that points up: for tools above the highest point, and in pictures and pages"},
};

static const pel_def_row run_rows[] = {
    {"imperfection", MAP,
     .doc =
         "changes the rest shapes by a buckling mode under the loads of the scene (as analysis: buckling finds it), so "
         "that equilibria leave the straight branch: post-buckling, wrinkles; optional"},
    {"imperfection.mode", SCENE(imperfection_mode), INTEGER, BETWEEN(1, 100), .preset = "1",
     .doc = "number of the mode, by rising load factor"},
    {"imperfection.amplitude", SCENE(imperfection_amplitude), NUMBER, .unit = "m", POSITIVE, REQUIRED,
     .doc = "largest displacement of a vertex by the mode, for example a tenth of the thickness"},

    {"duration", SCENE(duration), NUMBER, .unit = "s", POSITIVE, REQUIRED, .supplied = "",
     .doc = "simulated time; optional if stop.time or stop.frames is set, and under static: its steps and frames then "
            "go to the last key, or it takes one step if nothing has keys"},
    {"stop", MAP, .doc = "conditions that end a run before its duration; optional"},
    {"stop.at_rest", SCENE(rest_speed), NUMBER, .unit = "m/s", POSITIVE,
     .doc = "ends the run when loads and tools have stopped changing and all vertices are slower than this"},
    {"stop.volume_ratio_below", SCENE(least_volume_ratio), NUMBER, POSITIVE,
     .doc = "ends the run when the ratio of the volume to the rest volume is below this; needs a closed body"},
    {"stop.frames", SCENE(frame_limit), INTEGER, COUNT_FROM(1),
     .doc = "ends the run after this number of steps of dt (paper B's frames)"},
    {"stop.time", SCENE(time_limit), NUMBER, .unit = "s", POSITIVE, .doc = "ends the run at this simulated time"},
    {"stop.self_contact", SCENE(stop_at_contact), BOOLEAN, .preset = "false",
     .doc = "ends the run when a body touches itself or another"},

    {"session", LIST, .doc = "commands that `pellicle live` recorded, replayed bit for bit; optional"},
    {"session[]", TEXT,
     .doc = "number of the step before which the command acts, and a command of pellicle/session.h, such as 120 set "
            "solver.drag 2; in the order of steps"},

    {"output", MAP, .preset = "{}", .doc = "results in the run's folder"},
    {"output.every", OUTPUT(every), NUMBER, .unit = "s", POSITIVE, ALTERNATIVE, .preset = "0.1",
     .doc = "simulated time between frames"},
    {"output.every_frame", OUTPUT(every_frame), INTEGER, COUNT_FROM(1), ALTERNATIVE, .doc = "steps between frames"},
    {"output.fields", LIST, .preset = "[\"displacement\", \"force\"]",
     .doc = "vertex fields of the frames: fields of the list below and fields of the meshes"},
    {"output.fields[]", NAME, .doc = "name of a field"},
    {"output.compress", OUTPUT(compress), BOOLEAN, .preset = "false",
     .doc = "compresses the .vtp files (zlib): less than half the size; writing takes several times as long"},
    {"output.precision", OUTPUT(float64), WORD("single", "double"), .preset = "single",
     .doc = "precision of the .vtp files; single becomes double where it would lose 1e-5 of the size of a body"},
    {"output.checkpoint", OUTPUT(checkpoint), NUMBER, .unit = "s", AT_LEAST(0), .preset = "0",
     .doc = "simulated time between checkpoints; 0: keeps only the last good state of a run that fails, is stopped or "
            "is killed"},

    {"<mesh>", MAP, .doc = "a surface, in metres after `scale`: a generated shape or a file"},
    {"<mesh>.shape", .forms = PEL_FORM_WORD, ALTERNATIVE,
     .doc = "a generated surface; its parameters are further keys of the mesh"},
    {"<mesh>.file", TEXT, ALTERNATIVE, .doc = "a mesh file; its path is relative to the scene"},
    {"<mesh>.format", WORD("auto", "obj", "ply", "stl", "off", "vtp"), .needs = "file", .preset = "auto",
     .doc = "format of the file; auto: by its extension and content, also glTF, USD, FBX, 3MF and others; tetrahedra: "
            ".msh, "
            ".vtk, .vtu, .node"},
    {"<mesh>.weld", BOOLEAN, .needs = "file", .preset = "true",
     .doc =
         "welds the seams of the file: borders that lie on each other, within a millionth of the size, and run against "
         "each other, where "
         "vertices stand twice because texture coordinates or normals differ. Regions name vertices by their numbers "
         "in the file; the field `file_vertex` has the first of each vertex. false: slits stay open"},
    {"<mesh>.scale", .forms = PEL_FORM_NUMBER | PEL_FORM_VECTOR, POSITIVE, .preset = "1",
     .doc = "factor on all coordinates or on x, y and z (0.001 for millimetres); applied first"},
    {"<mesh>.size", NUMBER, .unit = "m", POSITIVE, .needs = "file",
     .doc = "longest side of the bounding box, for files in unknown units: multiplies `scale` by what gives it"},
    {"<mesh>.rotate", MAP, .doc = "rotation of the mesh about the origin; applied second"},
    {"<mesh>.rotate.axis", VECTOR, REQUIRED, .doc = "axis of rotation, of any length but 0"},
    {"<mesh>.rotate.angle", NUMBER, .unit = "degrees", REQUIRED, .doc = "angle, counter-clockwise"},
    {"<mesh>.translate", VECTOR, .unit = "m", .preset = "[0, 0, 0]", .doc = "translation; applied last"},

    {"<quantity>", MAP, .doc = "a number that varies over the body or over time"},
    {"<quantity>.field", TEXT, ALTERNATIVE, .doc = "vertex field of the mesh that gives the number at each vertex"},
    {"<quantity>.map", .forms = PEL_FORM_PAIR, .scoped = true, .needs = "field",
     .doc = "numbers at the field values 0 and 1; other values are interpolated or extrapolated linearly; default: the "
            "values of the field"},
    {"<quantity>.keys", LIST, COUNT_FROM(1), ALTERNATIVE, .scoped = true,
     .doc = "numbers over time, linear between the keys"},
    {"<quantity>.keys[]", .forms = PEL_FORM_KEY, .scoped = true, .doc = "time [s] and number"},

    {"<spring damping>", MAP, .doc = "a number that varies over the body or over time, or damping of the material"},
    {"<spring damping>.field", TEXT, ALTERNATIVE, .doc = "as of other numbers"},
    {"<spring damping>.map", .forms = PEL_FORM_PAIR, .scoped = true, .needs = "field", .doc = "as of other numbers"},
    {"<spring damping>.keys", LIST, COUNT_FROM(1), ALTERNATIVE, .scoped = true, .doc = "as of other numbers"},
    {"<spring damping>.keys[]", .forms = PEL_FORM_KEY, .scoped = true, .doc = "time [s] and number"},
    {"<spring damping>.stiffness", NUMBER, .unit = "s", AT_LEAST(0), ALTERNATIVE,
     .doc = "becomes `springs.viscosity.stiffness`"},
    {"<spring damping>.loss_factor", NUMBER, BETWEEN(0, 2), ALTERNATIVE,
     .doc = "becomes `springs.viscosity.loss_factor`"},

    {"<field>", MAP, .doc = "a number that varies over the body"},
    {"<field>.field", TEXT, ALTERNATIVE, .doc = "vertex field of the mesh that gives the number at each vertex"},
    {"<field>.map", .forms = PEL_FORM_PAIR, .scoped = true, .needs = "field",
     .doc = "numbers at the field values 0 and 1; other values are interpolated or extrapolated linearly; default: the "
            "values of the field"},
    {"<field>.base", NUMBER, ALTERNATIVE, .scoped = true, .doc = "the number outside of `regions`"},
    {"<field>.regions", LIST, COUNT_FROM(1), .scoped = true, .needs = "base",
     .doc = "parts of the body with other numbers, such as a stiff nodule; later ones take precedence"},
    {"<field>.regions[]", MAP, .scoped = true, .doc = "one part"},
    {"<field>.regions[].region", REGION, REQUIRED, .doc = "its vertices; over a `falloff` the number fades"},
    {"<field>.regions[].value", NUMBER, REQUIRED, .scoped = true, .doc = "the number there"},
};

/* after the fibres */
static const pel_def_row last_rows[] = {
    {"<region>", MAP,
     .doc = "a set of vertices of a body, selected at rest; `all`: all vertices; `boundary`: those on open edges"},
    {"<region>.sphere", MAP, ALTERNATIVE, .doc = "the vertices inside a sphere"},
    {"<region>.sphere.center", VECTOR, .unit = "m", REQUIRED, .doc = "center of the sphere"},
    {"<region>.sphere.radius", NUMBER, .unit = "m", POSITIVE, REQUIRED, .doc = "radius of the sphere"},
    {"<region>.falloff", NUMBER, .unit = "m", AT_LEAST(0), .needs = "sphere, box, plane, nearest, ray", .preset = "0",
     .doc = "width around the region over which its weight decreases smoothly from 1 to 0"},
    {"<region>.box", MAP, ALTERNATIVE, .doc = "the vertices inside a box parallel to the axes"},
    {"<region>.box.min", VECTOR, .unit = "m", REQUIRED, .doc = "lowest corner"},
    {"<region>.box.max", VECTOR, .unit = "m", REQUIRED, .doc = "highest corner"},
    {"<region>.vertices", LIST, COUNT_FROM(1), ALTERNATIVE, .doc = "the vertices with these numbers"},
    {"<region>.vertices[]", INTEGER, COUNT_FROM(0), .doc = "number of a vertex, from 0"},
    {"<region>.field", TEXT, ALTERNATIVE, .doc = "the vertices at which this field of the mesh exceeds `above`"},
    {"<region>.above", NUMBER, .needs = "field", .preset = "0.5", .doc = "threshold of the field"},
    {"<region>.nearest", VECTOR, .unit = "m", ALTERNATIVE, .doc = "the one vertex nearest to this point"},
    {"<region>.ray", MAP, ALTERNATIVE, .like = "<ray>",
     .doc = "the one vertex nearest to the first point at which this ray meets the body"},
    {"<region>.plane", MAP, ALTERNATIVE, .doc = "the vertices on one side of a plane, and on it"},
    {"<region>.plane.point", VECTOR, .unit = "m", .preset = "[0, 0, 0]", .doc = "a point of the plane"},
    {"<region>.plane.normal", VECTOR, REQUIRED,
     .doc = "direction from the plane to the side that is selected, of any length but 0"},
    {"<region>.boundary", INTEGER, COUNT_FROM(0), ALTERNATIVE,
     .doc =
         "the vertices on one loop of open edges: its number from 0, the longest first; all loops: the word `boundary` "
         "alone, without a map"},
    {"<region>.group", TEXT, ALTERNATIVE,
     .doc = "the vertices of the faces of this object, group or material of an OBJ file (field `group:NAME`)"},
    {"<region>.union", LIST, COUNT_FROM(1), ALTERNATIVE, .doc = "the vertices of all of these regions"},
    {"<region>.union[]", REGION, .doc = "one region"},
    {"<region>.not", REGION, ALTERNATIVE, .doc = "the vertices outside this region"},
    {"<ray>", MAP, .doc = "a ray that is cast at bodies at rest"},
    {"<ray>.origin", VECTOR, .unit = "m", REQUIRED, .doc = "where it starts"},
    {"<ray>.direction", VECTOR, REQUIRED, .doc = "where it points, of any length but 0"},
    {"<place>", MAP, .doc = "a place of a tool that is given by the bodies at rest"},
    {"<place>.above", WORD_OR_MAP("highest"), ALTERNATIVE,
     .doc =
         "the point of the body that the tool faces. highest: the highest along `up`, the middle one of a level top"},
    {"<place>.above.vertex", INTEGER, COUNT_FROM(0), ALTERNATIVE, .doc = "the vertex of this number"},
    {"<place>.above.ray", MAP, ALTERNATIVE, .like = "<ray>", .doc = "where this ray first meets the body"},
    {"<place>.below", .forms = PEL_FORM_WORD, WORDS("lowest"), ALTERNATIVE,
     .doc = "the lowest point along `up`, the middle one of a level bottom: where a floor stands"},
    {"<place>.by", .forms = PEL_FORM_NUMBER | PEL_FORM_TEXT, .unit = "m", .preset = "0",
     .doc = "distance between the tool and that point, along `up` for highest and lowest, else along the normal of the "
            "surface; at least the contact thickness where there is contact; below 0 the tool is pressed in. A number "
            "of metres, or "
            "`relative` and a factor on the diagonal of the box about the bodies, such as relative 0.05"},
    {"<place>.body", TEXT, .doc = "name of the body; default: all bodies"},
};

/* the shapes of tools, or the solids among them; null when out of memory */
static const char *const *shape_words(pel_arena *arena, bool of_solids)
{
    const char **words = pel_arena_take(arena, PEL_TOOL_SHAPE_COUNT + 1, sizeof *words);
    for (int i = 0, count = 0; words != NULL && i < PEL_TOOL_SHAPE_COUNT; i++)
        if (!of_solids || pel_solid_rows[i].distance != NULL)
            words[count++] = pel_solid_rows[i].word;
    return (const char *const *)words;
}

/* names of the materials; null when out of memory */
static const char *const *preset_words(pel_arena *arena)
{
    int32_t count;
    const pel_material_preset *presets = pel_material_presets(&count);
    const char **words = pel_arena_take(arena, (size_t)count + 1, sizeof *words);
    for (int32_t i = 0; words != NULL && i < count; i++)
        words[i] = presets[i].name;
    return (const char *const *)words;
}

/* length of the only prefix that a row may stand directly below */
static size_t parent_length(const char *path)
{
    const char *dot = strrchr(path, '.'), *bracket = strrchr(path, '[');
    const char *last = bracket != NULL && (dot == NULL || bracket > dot) ? bracket : dot;
    return last != NULL ? (size_t)(last - path) : 0;
}

/* the part of a path that follows its parent; null for rows such as <mesh> */
static const char *name_below(const char *path, size_t length)
{
    const char *name = path + length;
    if (length > 0 && strcmp(name, "[]") == 0)
        return name;
    name += length > 0 && *name == '.';
    return *name != '<' ? name : NULL;
}

/* Rows with the same parent as a chain, so that the rows below a prefix are found without a search over all rows. Later
   rows are in buckets, the nearest first. */
static void link_siblings(const pel_def_row *all, size_t count, const size_t *parents, const char **names,
                          size_t *siblings, size_t *later)
{
    enum { BUCKETS = 128 };
    size_t first[BUCKETS];
    for (size_t b = 0; b < BUCKETS; b++)
        first[b] = count;
    for (size_t i = count; i-- > 0;) {
        const char *path = all[i].path;
        size_t length = parents[i], bucket = 0, j;
        if (length > 0)
            bucket = (7 * length + (unsigned char)path[length / 2] + (unsigned char)path[length - 1]) % BUCKETS;
        names[i] = name_below(path, length);
        for (j = first[bucket]; j < count && (parents[j] != length || memcmp(all[j].path, path, length) != 0);)
            j = later[j];
        siblings[i] = j;
        later[i] = first[bucket];
        if (names[i] != NULL)
            first[bucket] = i;
    }
}

/* the rows of a table while they are put together */
typedef struct row_list {
    pel_arena *arena;
    pel_def_row *rows;
    size_t count;
    bool failed; /* out of memory */
} row_list;

static void add_row(row_list *list, const pel_def_row *row)
{
    pel_def_row *made = &list->rows[list->count++];
    *made = *row;
    if (strcmp(row->path, "bodies[].membrane.preset") == 0)
        list->failed |= (made->words = preset_words(list->arena)) == NULL;
    if (strcmp(row->path, "tools[].shape") == 0) {
        made->words = shape_words(list->arena, true);
        made->values = shape_words(list->arena, false);
        list->failed |= made->words == NULL || made->values == NULL;
    }
    if (strcmp(row->path, "<mesh>.shape") != 0)
        return;
    made->words = pel_scene_shape_words(list->arena);
    list->failed |= made->words == NULL || !pel_scene_shape_rows(list->arena, "<mesh>", made + 1);
    list->count += pel_scene_shape_row_count();
}

static void add_rows(row_list *list, const pel_def_row *rows, size_t count)
{
    for (size_t i = 0; i < count; i++)
        add_row(list, &rows[i]);
}

/* the rows of members that have a key: those of the groups of the scene, which come last, or the others */
static void add_members(row_list *list, bool of_groups)
{
    const pel_def_row *row;
    for (int32_t i = 0; (row = pel_def_row_at(i)) != NULL; i++)
        if (row->path != NULL && (row->path[0] == '<') == of_groups)
            add_row(list, row);
}

const pel_scene_table *pel_scene_table_create(pel_arena *arena)
{
    enum { FIRST = sizeof first_rows / sizeof *first_rows };
    enum { RUN = sizeof run_rows / sizeof *run_rows, LAST = sizeof last_rows / sizeof *last_rows };
    const size_t most = FIRST + (size_t)pel_def_row_count() + RUN + pel_scene_shape_row_count() + LAST;
    pel_scene_table *table = pel_arena_take(arena, 1, sizeof *table);
    row_list list = {.arena = arena, .rows = pel_arena_take(arena, most, sizeof *list.rows)};
    size_t *parents = pel_arena_take(arena, most, sizeof *parents);
    size_t *siblings = pel_arena_take(arena, most, sizeof *siblings);
    size_t *later = pel_arena_take(arena, most, sizeof *later);
    const char **names = pel_arena_take(arena, most, sizeof *names);
    if (table == NULL || list.rows == NULL || parents == NULL || siblings == NULL || later == NULL || names == NULL)
        return NULL;
    add_rows(&list, first_rows, FIRST);
    add_members(&list, false);
    add_rows(&list, run_rows, RUN);
    add_members(&list, true);
    add_rows(&list, last_rows, LAST);
    if (list.failed)
        return NULL;
    for (size_t i = 0; i < list.count; i++)
        parents[i] = parent_length(list.rows[i].path);
    link_siblings(list.rows, list.count, parents, names, siblings, later);
    *table = (pel_scene_table){list.rows, list.count, parents, names, siblings};
    return table;
}

const char *pel_scene_row_prefix(const pel_def_row *row)
{
    if (row == NULL)
        return "";
    return row->like != NULL ? row->like : row->path;
}

const char *pel_scene_row_name(const pel_def_row *row, const char *prefix)
{
    return name_below(row->path, strlen(prefix));
}

const pel_def_row *pel_scene_row_next(const pel_scene_table *table, const char *prefix, const pel_def_row *row)
{
    size_t length, i = 0;
    if (row != NULL) {
        i = table->siblings[row - table->rows];
        return i < table->row_count ? &table->rows[i] : NULL;
    }
    for (length = strlen(prefix); i < table->row_count; i++)
        if (table->parent_lengths[i] == length && table->names[i] != NULL &&
            memcmp(table->rows[i].path, prefix, length) == 0)
            return &table->rows[i];
    return NULL;
}

const pel_def_row *pel_scene_row_find(const pel_scene_table *table, const char *prefix, const char *name)
{
    const pel_def_row *row = pel_scene_row_next(table, prefix, NULL);
    while (row != NULL && strcmp(table->names[row - table->rows], name) != 0)
        row = pel_scene_row_next(table, prefix, row);
    return row;
}

bool pel_scene_row_needs(const pel_def_row *row, const char *key)
{
    size_t length = strlen(key);
    for (const char *name = row->needs; *name != '\0';) {
        size_t name_length = strcspn(name, ",");
        if (name_length == length && strncmp(name, key, length) == 0)
            return true;
        name += name_length;
        name += strspn(name, ", ");
    }
    return false;
}

/* appends to text with " or " before all but the first */
static void add_form(char *text, size_t size, const char *form)
{
    size_t length = strlen(text);
    snprintf(text + length, size - length, "%s%s", length > 0 ? " or " : "", form);
}

const char *pel_scene_form_text(const pel_def_row *row, char *text, size_t size)
{
    static const struct {
        unsigned form;
        const char *text;
    } forms[] = {
        {PEL_FORM_NUMBER, "number"},
        {PEL_FORM_INTEGER, "whole number"},
        {PEL_FORM_BOOLEAN, "true or false"},
        {PEL_FORM_TEXT, "text"},
        {PEL_FORM_PAIR, "[number, number]"},
        {PEL_FORM_KEY, "[time, value]"},
        {PEL_FORM_VECTOR, "vector [x, y, z]"},
        {PEL_FORM_LIST, "list"},
        {PEL_FORM_MAP, "map"},
    };
    text[0] = '\0';
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++)
        if ((row->forms & forms[i].form) != 0)
            add_form(text, size, forms[i].text);
    for (size_t i = 0; (row->forms & PEL_FORM_WORD) != 0 && row->words[i] != NULL; i++)
        add_form(text, size, row->words[i]);
    return text;
}
