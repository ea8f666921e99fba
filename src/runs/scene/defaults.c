#include "scene/defaults.h"

#include "base/number.h"
#include "keys/validate.h"
#include "law/membrane.h"
#include "math/extremes.h"
#include "pellicle/preset.h"
#include "stage/stepper.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* of a modulus from the slope that it repeats */
#define SAME_SLOPE 1e-9

enum { MOST_PRESETS = 64, DEFAULT_PATH_STEPS = 100, MOST_STATIC_STEPS = 1000 };

/* the default of the table */
static const char *preset_of(const pel_scene_reader *reader, const char *prefix, const char *key)
{
    return pel_scene_row_find(reader->table, prefix, key)->preset;
}

/* the entry of a map; one without value counts as missing */
static pel_scene_value *find(pel_scene_value *map, const char *key)
{
    pel_scene_value *entry = map != NULL && map->kind == PEL_SCENE_MAP ? pel_scene_value_entry(map, key) : NULL;
    if (entry == NULL || !pel_scene_value_is_null(entry))
        return entry;
    pel_scene_value_remove(entry);
    return NULL;
}

static pel_scene_value *find_map(pel_scene_value *map, const char *key)
{
    pel_scene_value *entry = find(map, key);
    return entry != NULL && entry->kind == PEL_SCENE_MAP ? entry : NULL;
}

/* a new entry; null when out of memory */
static pel_scene_value *add(pel_scene_reader *reader, pel_scene_value *map, const char *key, pel_scene_value_kind kind)
{
    pel_scene_value *value = pel_scene_value_create(reader, kind, map->place);
    if (value != NULL)
        pel_scene_value_append(map, key, value);
    return value;
}

static pel_status set_text(pel_scene_reader *reader, pel_scene_value *map, const char *key, const char *text)
{
    if (find(map, key) != NULL)
        return PEL_OK;
    pel_scene_value *value = add(reader, map, key, PEL_SCENE_SCALAR);
    if (value == NULL)
        return PEL_OUT_OF_MEMORY;
    value->is_implied = true;
    value->text = pel_arena_text(reader->arena, text, strlen(text));
    return value->text != NULL ? PEL_OK : pel_fail_memory(reader->error);
}

static pel_status set_number(pel_scene_reader *reader, pel_scene_value *map, const char *key, double number)
{
    char text[PEL_NUMBER_SIZE];
    pel_number_print(text, number);
    return set_text(reader, map, key, text);
}

/* a copy of a value with all that is below it as an entry of a map */
static pel_status set_copy(pel_scene_reader *reader, pel_scene_value *map, const char *key,
                           const pel_scene_value *source)
{
    pel_scene_value *copy = add(reader, map, key, source->kind);
    if (copy == NULL)
        return PEL_OUT_OF_MEMORY;
    copy->quoted = source->quoted;
    copy->text = source->text;
    copy->place = source->place;
    pel_status status = PEL_OK;
    for (const pel_scene_value *child = source->first; status == PEL_OK && child != NULL; child = child->next)
        status = set_copy(reader, copy, child->key, child);
    return status;
}

static bool is_word(pel_scene_value *map, const char *key, const char *word)
{
    const pel_scene_value *value = find(map, key);
    return value != NULL && value->kind == PEL_SCENE_SCALAR && strcmp(value->text, word) == 0;
}

/* the row of the method that the scene names, null for none */
static const pel_stepper *find_method(pel_scene_value *solver)
{
    const pel_scene_value *value = find(solver, "method");
    return value != NULL && value->kind == PEL_SCENE_SCALAR ? pel_stepper_find(value->text) : NULL;
}

/* the number of an entry, 0 unless it is a number above 0 */
static double positive(pel_scene_value *map, const char *key)
{
    const pel_scene_value *value = find(map, key);
    double number = 0;
    bool is_number = value != NULL && value->kind == PEL_SCENE_SCALAR && pel_scene_parse_number(value->text, &number);
    return is_number && number > 0 ? number : 0;
}

/* the same of a key of the solver, or its default */
static double positive_or_preset(const pel_scene_reader *reader, pel_scene_value *solver, const char *key)
{
    double number = positive(solver, key);
    if (!(number > 0))
        pel_scene_parse_number(preset_of(reader, "solver", key), &number);
    return number;
}

/* preset of a membrane, null for none; report a wrong name before missing keys */
static pel_status find_preset(pel_scene_reader *reader, pel_scene_value *membrane, const pel_material_preset **preset)
{
    const char *names[MOST_PRESETS];
    int32_t count;
    const pel_material_preset *presets = pel_material_presets(&count);
    const pel_scene_value *name = find(membrane, "preset");
    *preset = NULL;
    if (name == NULL || name->kind != PEL_SCENE_SCALAR)
        return PEL_OK;
    *preset = pel_material_preset_find(name->text);
    if (*preset != NULL)
        return PEL_OK;
    size_t known = 0;
    for (int32_t i = 0; i < count && known < MOST_PRESETS; i++)
        names[known++] = presets[i].name;
    return pel_scene_fail_word(reader, name, names, known);
}

/* the law of a membrane, PEL_MEMBRANE_COUNT if its word is wrong */
static int law_of(pel_scene_value *membrane, const pel_material_preset *preset)
{
    const pel_scene_value *word = find(membrane, "material");
    int kind = 0;
    if (word == NULL)
        return (int)(preset != NULL ? preset->material.kind : PEL_MEMBRANE_NEO_HOOKEAN);
    while (kind < PEL_MEMBRANE_COUNT && !is_word(membrane, "material", pel_membrane_words[kind]))
        kind++;
    return kind;
}

static void list_readers(int trait, pel_error *error, const char *name)
{
    char words[160] = "";
    const char *before = "";
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++)
        if ((pel_membrane_law_traits((pel_membrane_kind)kind) & trait) != 0) {
            size_t length = strlen(words);
            snprintf(words + length, sizeof words - length, "%s%s", before, pel_membrane_words[kind]);
            before = " or ";
        }
    pel_fail_remedy(error, "remove %s, or use material %s", name, words);
}

/* scenes that runs have written contain the defaults of all laws */
static bool is_usual(const pel_scene_value *value, const char *preset)
{
    double number = 0, usual = 0;
    return preset != NULL && value->kind == PEL_SCENE_SCALAR && pel_scene_parse_number(value->text, &number) &&
           pel_scene_parse_number(preset, &usual) && number == usual;
}

/* A number of another law would have no effect; rows that need a material tell it themselves. Poisson's ratio is one of
   every material: that of incompressible ones is known. */
static pel_status refuse_unread(pel_scene_reader *reader, pel_scene_value *membrane, const pel_material_preset *preset)
{
    const pel_material_number *own;
    const int kind = law_of(membrane, preset);
    for (int32_t i = 0; kind < PEL_MEMBRANE_COUNT && (own = pel_material_number_at(i)) != NULL; i++) {
        const pel_scene_value *value = find(membrane, own->name);
        const pel_def_row *row = pel_scene_row_find(reader->table, "bodies[].membrane", own->name);
        bool is_read = (pel_membrane_law_traits((pel_membrane_kind)kind) & own->trait) != 0;
        if (value == NULL || is_read || row->needs != NULL || own->trait == PEL_LAW_READS_POISSON ||
            is_usual(value, row->preset))
            continue;
        pel_scene_fail(reader, &value->key_place, "'%s' has no effect on the material %s", own->name,
                       pel_membrane_words[kind]);
        list_readers(own->trait, reader->error, own->name);
        return PEL_BAD_SCENE;
    }
    return PEL_OK;
}

static pel_status imply_material(pel_scene_reader *reader, pel_scene_value *membrane, const pel_material_preset *preset)
{
    const pel_membrane_material *material = &preset->material;
    const struct {
        const char *key;
        double number;
    } numbers[] = {{"young", material->young}, {"poisson", material->poisson}, {"thickness", material->thickness}};
    const pel_material_number *own;
    pel_status status = PEL_OK;
    /* the numbers of the law, unless the scene takes another */
    bool is_same = find(membrane, "material") == NULL;
    for (int32_t i = 0; is_same && status == PEL_OK && (own = pel_material_number_at(i)) != NULL; i++)
        if ((pel_membrane_law_traits(material->kind) & own->trait) != 0)
            status = set_number(reader, membrane, own->name, *(const double *)((const char *)material + own->offset));
    if (status == PEL_OK)
        status = set_text(reader, membrane, "material", pel_membrane_kind_name(material->kind));
    for (int i = 0; status == PEL_OK && i < 3; i++)
        status = set_number(reader, membrane, numbers[i].key, numbers[i].number);
    return status;
}

/* the mass of a sheet: density and thickness; the capsule of a filled body has none of its own */
static pel_status imply_mass(pel_scene_reader *reader, pel_scene_value *body, pel_scene_value *membrane,
                             const pel_material_preset *preset)
{
    pel_scene_value *thickness = find(membrane, "thickness"), *mass = find(body, "mass");
    if (thickness == NULL || find(body, "volume") != NULL || (mass != NULL && mass->kind != PEL_SCENE_MAP))
        return PEL_OK;
    /* a wrong thickness is to be told where it stands */
    if (thickness->kind == PEL_SCENE_SCALAR && !(positive(membrane, "thickness") > 0))
        return PEL_OK;
    if (mass == NULL && (mass = add(reader, body, "mass", PEL_SCENE_MAP)) == NULL)
        return PEL_OUT_OF_MEMORY;
    if (find(mass, "per_vertex") != NULL || find(mass, "total") != NULL)
        return PEL_OK;
    pel_status status = preset != NULL
                            ? set_number(reader, mass, "density", preset->density)
                            : set_text(reader, mass, "density", preset_of(reader, "bodies[].mass", "density"));
    if (status == PEL_OK && find(mass, "thickness") == NULL)
        status = set_copy(reader, mass, "thickness", thickness);
    return status;
}

/* young: [warp, weft] is short for young and weft */
static pel_status imply_weft(pel_scene_reader *reader, pel_scene_value *membrane)
{
    pel_scene_value *pair = find(membrane, "young");
    if (pair == NULL || pair->kind != PEL_SCENE_LIST || pel_scene_value_count(pair) != 2 ||
        pair->first->kind != PEL_SCENE_SCALAR || pair->last->kind != PEL_SCENE_SCALAR || find(membrane, "weft") != NULL)
        return PEL_OK;
    pel_status status = set_copy(reader, membrane, "weft", pair->last);
    pair->kind = PEL_SCENE_SCALAR;
    pair->text = pair->first->text;
    pair->quoted = pair->first->quoted;
    pair->place = pair->first->place;
    pair->first = pair->last = NULL;
    return status;
}

/* the curves of weave take the place of moduli: `young` is their first slope, in scenes that were resolved before */
static pel_status refuse_moduli(pel_scene_reader *reader, pel_scene_value *membrane, double slope)
{
    const pel_scene_value *young = find(membrane, "young"), *weft = find(membrane, "weft");
    double number;
    if (weft != NULL) {
        pel_scene_fail(reader, &weft->key_place, "'weft' has no effect on the material weave, which has curves");
        pel_fail_remedy(reader->error, "give the pull across the warp as weft_curve, or use material orthotropic");
        return PEL_BAD_SCENE;
    }
    bool is_slope = young != NULL && young->kind == PEL_SCENE_SCALAR && pel_scene_parse_number(young->text, &number) &&
                    fabs(number - slope) <= SAME_SLOPE * slope;
    if (young == NULL || is_slope)
        return PEL_OK;
    pel_scene_fail(reader, &young->key_place,
                   "'young' has no effect on the material weave, whose modulus is the first slope of warp_curve, %g Pa",
                   slope);
    pel_fail_remedy(reader->error, "remove young, or use material orthotropic, which has young and weft");
    return PEL_BAD_SCENE;
}

/* weave: the first slope of the curve of the warp, which the weft has too unless it is given */
static pel_status imply_curves(pel_scene_reader *reader, pel_scene_value *membrane)
{
    const pel_scene_value *warp = find(membrane, "warp_curve"),
                          *point = warp != NULL && warp->kind == PEL_SCENE_LIST ? warp->first : NULL;
    double strain, stress;
    if (point == NULL || point->kind != PEL_SCENE_LIST || pel_scene_value_count(point) != 2 ||
        point->first->kind != PEL_SCENE_SCALAR || point->last->kind != PEL_SCENE_SCALAR ||
        !is_word(membrane, "material", "weave"))
        return PEL_OK;
    pel_status status = find(membrane, "weft_curve") == NULL ? set_copy(reader, membrane, "weft_curve", warp) : PEL_OK;
    if (status != PEL_OK || !pel_scene_parse_number(point->first->text, &strain) ||
        !pel_scene_parse_number(point->last->text, &stress) || !(strain > 0 && stress > 0))
        return status;
    status = refuse_moduli(reader, membrane, stress / strain);
    return status == PEL_OK ? set_number(reader, membrane, "young", stress / strain) : status;
}

static pel_status imply_membrane(pel_scene_reader *reader, pel_scene_value *body, pel_scene_value *membrane)
{
    const pel_material_preset *preset;
    pel_scene_value *mass = find_map(body, "mass"), *thickness = find(mass, "thickness");
    pel_status status = imply_curves(reader, membrane);
    if (status == PEL_OK)
        status = imply_weft(reader, membrane);
    if (status == PEL_OK)
        status = find_preset(reader, membrane, &preset);
    if (status == PEL_OK)
        status = refuse_unread(reader, membrane, preset);
    if (status == PEL_OK && thickness != NULL && find(membrane, "thickness") == NULL &&
        !is_word(mass, "thickness", "auto"))
        status = set_copy(reader, membrane, "thickness", thickness);
    if (status == PEL_OK && preset != NULL)
        status = imply_material(reader, membrane, preset);
    return status == PEL_OK ? imply_mass(reader, body, membrane, preset) : status;
}

/* springs of no stiffness */
static pel_status imply_no_springs(pel_scene_reader *reader, pel_scene_value *body)
{
    if (find(body, "springs") != NULL)
        return PEL_OK;
    pel_scene_value *springs = add(reader, body, "springs", PEL_SCENE_MAP);
    if (springs == NULL)
        return PEL_OUT_OF_MEMORY;
    pel_status status = set_text(reader, springs, "stiffness", "0");
    return status == PEL_OK ? set_text(reader, springs, "damping", "0") : status;
}

/* a number of paper A in a map, unless one of the keys that exclude it is there */
static pel_status imply_number(pel_scene_reader *reader, pel_scene_value *map, const char *key, const char *number,
                               const char *const *others)
{
    for (; *others != NULL; others++)
        if (find(map, *others) != NULL)
            return PEL_OK;
    return set_text(reader, map, key, number);
}

static pel_status find_or_add(pel_scene_reader *reader, pel_scene_value *body, const char *key, pel_scene_value **map)
{
    *map = find(body, key);
    if (*map == NULL)
        *map = add(reader, body, key, PEL_SCENE_MAP);
    return *map != NULL ? PEL_OK : PEL_OUT_OF_MEMORY;
}

static pel_status imply_paper_a(pel_scene_reader *reader, pel_scene_value *body)
{
    static const char *const masses[] = {"total", "density", NULL}, *const young[] = {"young", NULL};
    pel_scene_value *mass, *springs, *volumetric = find_map(body, "volumetric");
    pel_status status = find_or_add(reader, body, "mass", &mass);
    if (status == PEL_OK)
        status = find_or_add(reader, body, "springs", &springs);
    if (status == PEL_OK && mass->kind == PEL_SCENE_MAP)
        status = imply_number(reader, mass, "per_vertex", "1", masses);
    if (status == PEL_OK && springs->kind == PEL_SCENE_MAP)
        status = imply_number(reader, springs, "stiffness", "3", young);
    if (status == PEL_OK && volumetric != NULL)
        status = imply_number(reader, volumetric, "stiffness", "1.5", young);
    return status;
}

/* What only follows an animation is an obstacle. With springs and a mass the force on it would be that of its own
   springs, damping and inertia, which no tool has. */
static pel_status imply_obstacle(pel_scene_reader *reader, pel_scene_value *body)
{
    static const char *const made[] = {"membrane", "volume", "springs", "volumetric",
                                       "pressure", "preset", "mass",    NULL};
    static const char *const partly[] = {"at", "from", "until", "stiffness", "strength", NULL};
    pel_scene_value *follow = find_map(body, "follow");
    bool is_obstacle = follow != NULL;
    for (const char *const *key = made; *key != NULL; key++)
        is_obstacle = is_obstacle && find(body, *key) == NULL;
    for (const char *const *key = partly; *key != NULL; key++)
        is_obstacle = is_obstacle && find(follow, *key) == NULL;
    if (!is_obstacle)
        return PEL_OK;
    pel_scene_value *mass = add(reader, body, "mass", PEL_SCENE_MAP);
    pel_status status = mass != NULL ? set_text(reader, mass, "density", "1.0e-3") : PEL_OUT_OF_MEMORY;
    return status == PEL_OK ? imply_no_springs(reader, body) : status;
}

/* the filling is as stiff as the skin */
static pel_status imply_tissue(pel_scene_reader *reader, pel_scene_value *body)
{
    pel_scene_value *young = find(find_map(body, "springs"), "young"), *volumetric = find_map(body, "volumetric");
    if (young == NULL || volumetric == NULL || find(volumetric, "young") != NULL ||
        find(volumetric, "stiffness") != NULL)
        return PEL_OK;
    return set_copy(reader, volumetric, "young", young);
}

/* the measured rigidity of a preset, unless the scene takes another material or thickness */
static pel_status imply_rigidity(pel_scene_reader *reader, pel_scene_value *body)
{
    pel_scene_value *membrane = find_map(body, "membrane"), *bending = find_map(body, "bending");
    const pel_scene_value *name = find(membrane, "preset");
    const pel_material_preset *preset =
        name != NULL && name->kind == PEL_SCENE_SCALAR ? pel_material_preset_find(name->text) : NULL;
    if (preset == NULL || bending == NULL || !(preset->bending[0] > 0) || find(bending, "stiffness") != NULL)
        return PEL_OK;
    pel_status status = set_number(reader, bending, "stiffness", preset->bending[0]);
    return status == PEL_OK ? set_number(reader, bending, "weft", preset->bending[1]) : status;
}

/* A sheet resists bending, unless pbd gives it its own weight. method.c may choose another model once the method is
   known. */
static pel_status imply_bending(pel_scene_reader *reader, pel_scene_value *root, pel_scene_value *body)
{
    pel_scene_value *solver = find_map(root, "solver"), *bending = find(body, "bending");
    const pel_stepper *stepper = find_method(solver);
    bool is_weight = stepper != NULL && !pel_stepper_knows_material(stepper);
    if (bending == NULL && find_map(body, "membrane") != NULL && !is_weight &&
        (bending = add(reader, body, "bending", PEL_SCENE_MAP)) == NULL)
        return PEL_OUT_OF_MEMORY;
    pel_status status =
        bending != NULL && bending->kind == PEL_SCENE_MAP ? set_text(reader, bending, "model", "hinge") : PEL_OK;
    return status == PEL_OK ? imply_rigidity(reader, body) : status;
}

/* damping of springs in the words of a membrane's is `viscosity`: a number is that of vertices */
static pel_status imply_viscosity(pel_scene_reader *reader, pel_scene_value *body)
{
    pel_scene_value *springs = find_map(body, "springs"), *damping = find_map(springs, "damping");
    if (damping == NULL || (find(damping, "stiffness") == NULL && find(damping, "loss_factor") == NULL))
        return PEL_OK;
    pel_status status = set_copy(reader, springs, "viscosity", damping);
    pel_scene_value_remove(damping);
    return status;
}

/* a rigid body has no material: its mass and inertia are those of `rigid` */
static const char *const soft_keys[] = {"mass",     "springs",  "volumetric", "membrane",   "bending",
                                        "volume",   "pressure", "fluid",      "anisotropy", "refine",
                                        "supports", "follow",   "preset",     NULL};

void pel_scene_forget_soft_keys(pel_scene_value *root)
{
    const pel_scene_value *bodies = pel_scene_value_entry(root, "bodies");
    for (pel_scene_value *body = bodies != NULL ? bodies->first : NULL; body != NULL; body = body->next)
        for (const char *const *key = soft_keys; *key != NULL && find_map(body, "rigid") != NULL; key++) {
            pel_scene_value *value = find(body, *key);
            if (value != NULL)
                pel_scene_value_remove(value);
        }
}

static pel_status check_rigid(pel_scene_reader *reader, pel_scene_value *body)
{
    static const char *const remedies[] = {"give rigid.density, or rigid.mass", "give pinned vertices", NULL};
    for (const char *const *key = soft_keys; *key != NULL; key++) {
        const pel_scene_value *value = find(body, *key);
        if (value == NULL)
            continue;
        int remedy = strcmp(*key, "mass") == 0 ? 0 : strcmp(*key, "supports") == 0 ? 1 : 2;
        pel_scene_fail(reader, &value->key_place, "a rigid body has no '%s'", *key);
        pel_fail_remedy(reader->error, "%s%sremove '%s'", remedy < 2 ? remedies[remedy] : "",
                        remedy < 2 ? ", and " : "", *key);
        return PEL_BAD_SCENE;
    }
    return PEL_OK;
}

/* `has_material`: its response follows from a material, not from numbers per edge */
static pel_status imply_body(pel_scene_reader *reader, pel_scene_value *body, bool *has_material)
{
    pel_scene_value *membrane = find_map(body, "membrane");
    if (find_map(body, "rigid") != NULL) {
        *has_material = true;
        pel_status fit = check_rigid(reader, body);
        return fit == PEL_OK ? imply_no_springs(reader, body) : fit;
    }
    pel_status status = imply_obstacle(reader, body);
    if (status == PEL_OK)
        status = imply_viscosity(reader, body);
    if (status == PEL_OK && membrane != NULL)
        status = imply_membrane(reader, body, membrane);
    pel_scene_value *volume = find_map(body, "volume");
    if (status == PEL_OK && (membrane != NULL || volume != NULL || find(body, "bending") != NULL))
        status = imply_no_springs(reader, body);
    if (status != PEL_OK)
        return status;
    bool is_paper_a = body->kind == PEL_SCENE_MAP && is_word(body, "preset", "paper-a");
    status = is_paper_a ? imply_paper_a(reader, body) : imply_tissue(reader, body);
    *has_material |= membrane != NULL || volume != NULL || find(find_map(body, "springs"), "stiffness") == NULL;
    return status;
}

/* modes, or a path of balances */
static bool is_equilibrium_search(pel_scene_value *solver)
{
    bool has_modes = find(solver, "analysis") != NULL && !is_word(solver, "analysis", "none");
    return has_modes || is_word(solver, "path", "arc-length");
}

/* nothing but a mesh, what it weighs and how it moves at the start */
static bool is_bare(const pel_scene_value *body)
{
    static const char *const keys[] = {"name", "mesh", "mass", "velocity", "angular_velocity"};
    bool is = body->kind == PEL_SCENE_MAP;
    for (const pel_scene_value *entry = body->first; is && entry != NULL; entry = entry->next) {
        bool found = false;
        for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
            found |= entry->key != NULL && strcmp(entry->key, keys[k]) == 0;
        is = found;
    }
    return is;
}

/* The tissue that fills a body by its mass keeps its volume: without a filling an organ that lies on a table under its
   weight is an empty bag. choice/fluid.c takes the filling from surfaces that are open. */
static pel_status imply_filling(pel_scene_reader *reader, pel_scene_value *root, pel_scene_value *body)
{
    if (!is_bare(body) || find(root, "gravity") == NULL || find(find_map(root, "solver"), "method") != NULL ||
        is_equilibrium_search(find_map(root, "solver")))
        return PEL_OK;
    pel_scene_value *pressure = add(reader, body, "pressure", PEL_SCENE_MAP);
    pel_scene_value *volume = pressure != NULL ? add(reader, pressure, "volume", PEL_SCENE_MAP) : NULL;
    if (volume == NULL)
        return PEL_OUT_OF_MEMORY;
    pressure->is_implied = true;
    pel_status status = set_text(reader, volume, "target", "1");
    return status == PEL_OK ? set_text(reader, volume, "bulk", "1.0e5") : status;
}

static pel_status imply_method(pel_scene_reader *reader, pel_scene_value *root)
{
    pel_scene_value *solver = find(root, "solver");
    if (solver == NULL && (solver = add(reader, root, "solver", PEL_SCENE_MAP)) == NULL)
        return PEL_OUT_OF_MEMORY;
    /* method.c may choose another one once the meshes are known */
    return solver->kind == PEL_SCENE_MAP ? set_text(reader, solver, "method", "xpbd") : PEL_OK;
}

/* ---- contact ---- */

static bool has_several(const pel_scene_value *list)
{
    return list->first != NULL && list->first->next != NULL;
}

static bool has_mesh_tool(pel_scene_value *root)
{
    pel_scene_value *tools = find(root, "tools");
    bool has = false;
    for (pel_scene_value *tool = tools != NULL ? tools->first : NULL; tool != NULL; tool = tool->next)
        has |= find(tool, "mesh") != NULL;
    return has;
}

static bool has_sphere(const pel_scene_value *bodies)
{
    bool has = false;
    for (pel_scene_value *body = bodies->first; body != NULL; body = body->next) {
        pel_scene_value *rigid = find_map(body, "rigid");
        has |= rigid != NULL && is_word(rigid, "sphere", "true");
    }
    return has;
}

/* what falls on a tool under static does so in tries, which only contact follows on their way */
static bool settles_rigid(pel_scene_value *root, const pel_scene_value *bodies)
{
    pel_scene_value *solver = find_map(root, "solver"), *tools = find(root, "tools");
    bool has = false;
    for (pel_scene_value *body = bodies->first; body != NULL; body = body->next)
        has |= find_map(body, "rigid") != NULL;
    return has && tools != NULL && tools->first != NULL && solver != NULL && is_word(solver, "method", "static");
}

/* Bodies do not pass through each other, nor through tools that are meshes, which press by contact alone; a rigid
   sphere is one to tools of every shape. */
static pel_status imply_contact(pel_scene_reader *reader, pel_scene_value *root, const pel_scene_value *bodies)
{
    if (find(root, "contact") != NULL ||
        !(has_several(bodies) || has_mesh_tool(root) || has_sphere(bodies) || settles_rigid(root, bodies)) ||
        is_equilibrium_search(find_map(root, "solver")))
        return PEL_OK;
    pel_scene_value *contact = add(reader, root, "contact", PEL_SCENE_MAP);
    if (contact == NULL)
        return PEL_OUT_OF_MEMORY;
    contact->is_implied = true;
    return set_text(reader, contact, "self", "false");
}

/* ---- statics: neither duration nor dt ---- */

static pel_status imply_static(pel_scene_reader *reader, pel_scene_value *root)
{
    pel_scene_value *solver = find_map(root, "solver");
    return is_equilibrium_search(solver) ? set_text(reader, solver, "method", "static") : PEL_OK;
}

/* the greatest common divisor of two times, at least `least` */
static double common_time(double a, double b, double least)
{
    while (b > least) {
        double rest = fmod(a, b);
        a = b;
        b = b - rest > least ? rest : 0;
    }
    return a;
}

/* when loads, tools and numbers change: the last time and the greatest one that all are multiples of */
typedef struct key_times {
    double last, step;
} key_times;

static void take_time(const pel_scene_value *value, key_times *times)
{
    double time;
    if (value == NULL || value->kind != PEL_SCENE_SCALAR || !pel_scene_parse_number(value->text, &time) ||
        !(time > 0) || !isfinite(time))
        return;
    times->last = pel_max(times->last, time);
    times->step =
        times->step > 0 ? common_time(pel_max(time, times->step), pel_min(time, times->step), 1e-6 * time) : time;
}

static void take_times(const pel_scene_value *value, key_times *times)
{
    for (const pel_scene_value *entry = value->first; entry != NULL; entry = entry->next) {
        const char *key = entry->key;
        if (key != NULL && (strcmp(key, "from") == 0 || strcmp(key, "until") == 0 || strcmp(key, "time") == 0))
            take_time(entry, times);
        for (pel_scene_value *pair = entry->first; key != NULL && strcmp(key, "keys") == 0 && pair != NULL;
             pair = pair->next)
            if (pair->kind == PEL_SCENE_LIST)
                take_time(pair->first, times);
        take_times(entry, times);
    }
}

/* A step, and a frame, for each multiple of the common divisor of all keys; with `steps`, that number to the last key;
   for each mode; for each step of a path; one step if nothing is keyed. */
static pel_status imply_static_times(pel_scene_reader *reader, pel_scene_value *root)
{
    pel_scene_value *solver = find_map(root, "solver"), *output = find(root, "output");
    const char *const parts[] = {"bodies", "loads", "tools"};
    double steps = positive(solver, "steps"), dt = positive(solver, "dt");
    key_times times = {0};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (find(root, parts[i]) != NULL)
            take_times(find(root, parts[i]), &times);
    bool has_modes = find(solver, "analysis") != NULL && !is_word(solver, "analysis", "none");
    double last = times.last > 0 ? times.last : 1, step = times.last > 0 ? times.step : 1;
    step = steps > 0 ? last / steps : pel_max(step, last / MOST_STATIC_STEPS);
    if (has_modes)
        last = positive_or_preset(reader, solver, "modes") * (step = dt > 0 ? dt : 1);
    else if (is_word(solver, "path", "arc-length"))
        last = (steps > 0 ? steps : DEFAULT_PATH_STEPS) * (step = dt > 0 ? dt : 1);
    if (output == NULL && (output = add(reader, root, "output", PEL_SCENE_MAP)) == NULL)
        return PEL_OUT_OF_MEMORY;
    pel_status status = set_number(reader, solver, "dt", step);
    if (status == PEL_OK)
        status = set_number(reader, root, "duration", pel_max(last, dt));
    bool is_open = output->kind == PEL_SCENE_MAP && find(output, "every") == NULL;
    return status == PEL_OK && is_open ? set_text(reader, output, "every_frame", "1") : status;
}

static pel_status imply_duration(pel_scene_reader *reader, pel_scene_value *root)
{
    pel_scene_value *stop = find_map(root, "stop");
    if (find(root, "duration") != NULL)
        return PEL_OK;
    double dt = positive_or_preset(reader, find_map(root, "solver"), "dt");
    double time = positive(stop, "time"), frames = positive(stop, "frames") * dt;
    if (time > 0 || frames > 0)
        return set_number(reader, root, "duration", time > 0 && (!(frames > 0) || time < frames) ? time : frames);
    const pel_stepper *stepper = find_method(find_map(root, "solver"));
    if (stepper != NULL && stepper->is_static)
        return imply_static_times(reader, root);
    return PEL_OK;
}

pel_status pel_scene_fill_defaults(pel_scene_reader *reader, pel_scene_value *root)
{
    pel_scene_value *bodies = root->kind == PEL_SCENE_MAP ? pel_scene_value_entry(root, "bodies") : NULL;
    bool has_material = false;
    pel_status status = PEL_OK;
    if (bodies == NULL || bodies->kind != PEL_SCENE_LIST)
        return PEL_OK;
    for (pel_scene_value *body = bodies->first; status == PEL_OK && body != NULL; body = body->next) {
        status = imply_filling(reader, root, body);
        if (status == PEL_OK)
            status = imply_body(reader, body, &has_material);
        if (status == PEL_OK)
            status = imply_bending(reader, root, body);
    }
    if (status == PEL_OK)
        status = imply_static(reader, root);
    if (status == PEL_OK && has_material)
        status = imply_method(reader, root);
    if (status == PEL_OK)
        status = imply_contact(reader, root, bodies);
    return status == PEL_OK ? imply_duration(reader, root) : status;
}
