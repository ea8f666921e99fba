/* Parameters by path: list, read, change. A path is made from the row of the table and the names of its owners; a
   search builds one path after the other, which takes some 10 us. */
#include "sim/parameter.h"

#include "base/number.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "sim/change.h"
#include "sim/own_def.h"
#include "tool/create.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* the defs that a parameter may be in */
typedef struct defs {
    const pel_model_def *model;
    const pel_sim_def *sim;
} defs;

/* ---- defs ---- */

static int32_t element_count(defs all, pel_def_kind kind)
{
    int32_t count = 0;
    switch (kind) {
    case PEL_DEF_BODY:
        return all.model->body_count;
    case PEL_DEF_FIBRES:
        for (int32_t b = 0; b < all.model->body_count; b++)
            count += all.model->bodies[b].shell.anisotropy_count;
        return count;
    case PEL_DEF_SUPPORT:
        return all.sim->support_count;
    case PEL_DEF_LOAD:
        return all.sim->load_count;
    case PEL_DEF_TOOL:
        return all.sim->tool_count;
    default:
        return 1;
    }
}

/* the body of a region, whose number in it replaces that among all */
static int32_t region_body(defs all, int32_t *region)
{
    int32_t b = 0;
    while (*region >= all.model->bodies[b].shell.anisotropy_count)
        *region -= all.model->bodies[b++].shell.anisotropy_count;
    return b;
}

static const void *def_of(defs all, pel_def_kind kind, int32_t element)
{
    switch (kind) {
    case PEL_DEF_BODY:
        return &all.model->bodies[element];
    case PEL_DEF_FIBRES:
        return &all.model->bodies[region_body(all, &element)].shell.anisotropies[element];
    case PEL_DEF_SUPPORT:
        return &all.sim->supports[element];
    case PEL_DEF_MODEL:
        return all.model;
    case PEL_DEF_LOAD:
        return &all.sim->loads[element];
    case PEL_DEF_TOOL:
        return &all.sim->tools[element];
    case PEL_DEF_CONTACT:
        return &all.sim->contact;
    default:
        return &all.sim->solver;
    }
}

static defs defs_of(const pel_sim *sim)
{
    return (defs){&sim->given->def, &sim->def};
}

static bool next_place(defs all, pel_parameter_place *at)
{
    for (; at->row >= 0; at->row = pel_def_parameter_after(at->row), at->element = -1) {
        const pel_def_row *row = pel_def_row_at(at->row);
        while (++at->element < element_count(all, row->def))
            if (row->applies == NULL || row->applies(def_of(all, row->def, at->element)))
                return true;
    }
    return false;
}

static pel_parameter_place before_first(void)
{
    return (pel_parameter_place){pel_def_parameter_after(-1), -1};
}

static const char *path_of(const pel_def_row *row)
{
    return row->parameter_path != NULL ? row->parameter_path : row->path;
}

/* ---- paths ---- */

/* names for the first and second [] of a path; null = use the number */
typedef struct path_names {
    const char *names[2];
    int32_t numbers[2];
} path_names;

static path_names names_of(defs all, const pel_def_row *row, int32_t element)
{
    path_names made = {{NULL, NULL}, {element, 0}};
    int32_t region = element;
    switch (row->def) {
    case PEL_DEF_BODY:
        made.names[0] = all.model->bodies[element].name;
        break;
    case PEL_DEF_FIBRES:
        made.numbers[0] = region_body(all, &region);
        made.names[0] = all.model->bodies[made.numbers[0]].name;
        made.numbers[1] = region;
        break;
    case PEL_DEF_SUPPORT:
        made.numbers[0] = all.sim->supports[element].body;
        made.names[0] = all.model->bodies[made.numbers[0]].name;
        made.names[1] = all.sim->supports[element].name;
        for (int32_t s = 0; s < element; s++)
            made.numbers[1] += all.sim->supports[s].body == made.numbers[0];
        break;
    case PEL_DEF_LOAD:
        made.names[0] = all.sim->loads[element].name;
        break;
    case PEL_DEF_TOOL:
        made.names[0] = all.sim->tools[element].name;
        break;
    default:
        break;
    }
    return made;
}

static void write_path(defs all, pel_parameter_place at, bool by_number, char path[PEL_PARAMETER_PATH_SIZE])
{
    const pel_def_row *row = pel_def_row_at(at.row);
    path_names names = names_of(all, row, at.element);
    size_t length = 0;
    int list = 0;
    for (const char *c = path_of(row); *c != '\0' && length + 1 < PEL_PARAMETER_PATH_SIZE; c++) {
        size_t room = PEL_PARAMETER_PATH_SIZE - length;
        if (*c != '[') {
            path[length++] = *c;
            continue;
        }
        const char *name = names.names[list];
        int written = by_number || name == NULL || name[0] == '\0'
                          ? snprintf(path + length, room, ".%d", (int)names.numbers[list])
                          : snprintf(path + length, room, ".%s", name);
        length += (size_t)written < room ? (size_t)written : room - 1;
        list++;
        c++;
    }
    path[length] = '\0';
}

static pel_status find_place(defs all, const char *path, pel_parameter_place *found, pel_error *error)
{
    char candidate[PEL_PARAMETER_PATH_SIZE], nearest[PEL_PARAMETER_PATH_SIZE] = "";
    for (int by_number = 0; by_number < 2; by_number++)
        for (pel_parameter_place at = before_first(); next_place(all, &at);) {
            write_path(all, at, by_number, candidate);
            *found = at;
            if (strcmp(candidate, path) == 0)
                return PEL_OK;
            const char *names[] = {nearest, candidate};
            if (pel_nearest_name(path, names, 2) == candidate)
                memcpy(nearest, candidate, sizeof nearest);
        }
    pel_fail(error, PEL_BAD_ARGUMENT, "'%.150s' is not a parameter of this simulation", path);
    if (nearest[0] != '\0')
        pel_fail_remedy(error, "did you mean '%s'?", nearest);
    else
        pel_fail_remedy(error,
                        "use a path of pel_parameter_at; meshes and parts that the scene omits have no parameters");
    return PEL_BAD_ARGUMENT;
}

/* ---- values in defs ---- */

/* the value of a parameter from the value in a def */
static double value_of(const pel_def_row *row, double raw)
{
    return row->may_be_auto && raw == row->automatic ? (double)NAN : pel_def_row_factor(row) * raw;
}

static double read_quantity(const pel_quantity *quantity)
{
    return quantity->field != NULL ? quantity->field[0] : quantity->value;
}

/* three values for a vector, else one */
static void read_values(const pel_def_row *row, const void *def, double time, double values[3])
{
    const char *at = (const char *)def + row->offset;
    int32_t count, number;
    const pel_key *keys = pel_member_keys(row, def, &count);
    values[0] = values[1] = values[2] = 0;
    if (count > 0 || row->store == PEL_STORE_KEYS)
        values[0] = pel_def_row_factor(row) * pel_curve_value(keys, count, time);
    else if (row->store == PEL_STORE_QUANTITY)
        values[0] = value_of(row, read_quantity((const pel_quantity *)(const void *)at));
    else if (row->store == PEL_STORE_BOOL)
        values[0] = *(const bool *)at;
    else if (row->store == PEL_STORE_INT)
        memcpy(&number, at, sizeof number), values[0] = value_of(row, number);
    else
        for (int i = 0; i < (pel_def_row_kind(row) == PEL_PARAMETER_VECTOR ? 3 : 1); i++) {
            double raw;
            memcpy(&raw, at + (size_t)i * sizeof raw, sizeof raw);
            values[i] = value_of(row, raw);
        }
}

/* ---- questions ---- */

/* the value in a new def */
static void read_preset(const pel_def_row *row, double values[3])
{
    union {
        pel_body_def body;
        pel_anisotropy_def fibres;
        pel_support_def support;
        pel_model_def model;
        pel_load_def load;
        pel_tool_def tool;
        pel_contact_def contact;
        pel_solver_def solver;
    } def;
    memset(&def, 0, sizeof def);
    pel_def_reset(row->def, &def);
    read_values(row, &def, 0, values);
}

/* of the numbers of a parameter; that of a list of keys is for their count */
static pel_range range_of(const pel_def_row *row)
{
    if (row->range.given && row->store != PEL_STORE_KEYS)
        return row->range;
    if (pel_def_row_kind(row) == PEL_PARAMETER_WORD)
        return (pel_range){0};
    if (pel_def_row_kind(row) == PEL_PARAMETER_SWITCH)
        return (pel_range){true, false, 0, 1};
    return (pel_range){false, false, -(double)HUGE_VAL, (double)HUGE_VAL};
}

static void fill_info(const pel_sim *sim, pel_parameter_place at, pel_parameter_info *info)
{
    defs all = defs_of(sim);
    const pel_def_row *row = pel_def_row_at(at.row);
    const void *def = def_of(all, row->def, at.element);
    int32_t key_count;
    pel_member_keys(row, def, &key_count);
    *info = (pel_parameter_info){
        .row = path_of(row),
        .kind = pel_def_row_kind(row),
        .unit = row->unit != NULL ? row->unit : "",
        .may_be_auto = row->may_be_auto,
        .may_be_keyed = pel_def_row_may_be_keyed(row),
        .is_keyed = key_count > 0,
        .words = pel_def_row_words(row),
        .is_live = row->refusal == NULL,
        .refusal = row->refusal != NULL ? row->refusal : "",
        .remedy = row->remedy != NULL ? row->remedy : "",
    };
    const pel_range range = range_of(row);
    info->least = range.least;
    info->most = range.most;
    info->is_open = range.open;
    if (row->store == PEL_STORE_QUANTITY)
        info->is_field = ((const pel_quantity *)(const void *)((const char *)def + row->offset))->field != NULL;
    write_path(all, at, false, info->path);
    read_preset(row, info->preset);
    read_values(row, def, pel_sim_time(sim), info->value);
}

int32_t pel_parameter_count(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    int32_t count = 0;
    for (pel_parameter_place at = before_first(); next_place(defs_of(sim), &at);)
        count++;
    return count;
}

void pel_parameter_at(const pel_sim *sim, int32_t index, pel_parameter_info *info)
{
    if (info == NULL)
        return;
    pel_parameter_place at = before_first();
    bool is_there = sim != NULL && next_place(defs_of(sim), &at);
    for (int32_t i = 0; is_there && i < index; i++)
        is_there = next_place(defs_of(sim), &at);
    if (is_there)
        fill_info(sim, at, info);
    else
        *info = (pel_parameter_info){.row = "", .unit = "", .refusal = "", .remedy = ""};
}

pel_status pel_parameter_find(const pel_sim *sim, const char *path, pel_parameter_info *info, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(info, error);
    pel_parameter_place at;
    pel_status status = find_place(defs_of(sim), path, &at, error);
    if (status == PEL_OK)
        fill_info(sim, at, info);
    return status;
}

/* ---- changes ---- */

/* a value to set: numbers, or keys */
typedef struct setting {
    const double *values;
    int32_t value_count;
    const pel_key *keys;
    int32_t key_count;
} setting;

static pel_status refuse_value(const char *path, const pel_def_row *row, double value, pel_error *error)
{
    char text[80];
    const pel_range range = range_of(row);
    const pel_parameter_kind kind = pel_def_row_kind(row);
    const char *unit = row->unit != NULL ? row->unit : "";
    if (range.given)
        pel_range_text(range, text, sizeof text);
    else
        snprintf(text, sizeof text, "finite%s", row->unit != NULL ? ", in" : "");
    pel_fail(error, PEL_BAD_ARGUMENT, "%s cannot be %g", path, value);
    pel_fail_remedy(error, "give %s: %s%s%s",
                    kind == PEL_PARAMETER_VECTOR   ? "three numbers"
                    : kind == PEL_PARAMETER_NUMBER ? "a number"
                                                   : "an integer",
                    text, row->unit != NULL ? " " : "", unit);
    return PEL_BAD_ARGUMENT;
}

static bool is_in_range(const pel_def_row *row, double value)
{
    const pel_parameter_kind kind = pel_def_row_kind(row);
    bool is_whole = kind == PEL_PARAMETER_NUMBER || kind == PEL_PARAMETER_VECTOR || value == floor(value);
    return isfinite(value) && is_whole && pel_range_has(range_of(row), value);
}

static pel_status refuse_word(const char *path, const pel_def_row *row, pel_error *error)
{
    const char *const *known = pel_def_row_words(row);
    char words[160] = "";
    size_t length = 0;
    for (int i = 0; known[i] != NULL && length < sizeof words; i++)
        length += (size_t)snprintf(words + length, sizeof words - length, "%s%s", i > 0 ? ", " : "", known[i]);
    pel_fail(error, PEL_BAD_ARGUMENT, "%s has no such word", path);
    pel_fail_remedy(error, "give one of: %s", words);
    return PEL_BAD_ARGUMENT;
}

static pel_status check_number(const char *path, const pel_def_row *row, double value, pel_error *error)
{
    const char *const *words = pel_def_row_words(row);
    int32_t word_count = 0;
    if (isnan(value) && row->may_be_auto)
        return PEL_OK;
    if (words == NULL)
        return is_in_range(row, value) ? PEL_OK : refuse_value(path, row, value, error);
    while (words[word_count] != NULL)
        word_count++;
    return value >= 0 && value < word_count && value == floor(value) ? PEL_OK : refuse_word(path, row, error);
}

static pel_status check_keys(const char *path, const pel_def_row *row, const setting *set, pel_error *error)
{
    pel_status status = PEL_OK;
    if (!pel_def_row_may_be_keyed(row))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "set a number between steps", "%s cannot vary over time", path);
    if (set->key_count < 1)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give one or more keys, or set a number", "%s gets no key", path);
    for (int32_t k = 0; status == PEL_OK && k < set->key_count; k++) {
        if (!isfinite(set->keys[k].time) || (k > 0 && !(set->keys[k].time > set->keys[k - 1].time)))
            return pel_refuse(error, PEL_BAD_ARGUMENT, "give keys with increasing times", "keys of %s are not in order",
                              path);
        status = isfinite(set->keys[k].value) ? check_number(path, row, set->keys[k].value, error)
                                              : refuse_value(path, row, set->keys[k].value, error);
    }
    return status;
}

static pel_status check_setting(const char *path, const pel_def_row *row, const setting *set, pel_error *error)
{
    static const char *const forms[] = {"one number", "one number", "0 or 1", "the index of a word", "three numbers"};
    const pel_parameter_kind kind = pel_def_row_kind(row);
    if (row->refusal != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, row->remedy, "%s cannot change while the simulation runs: %s", path,
                          row->refusal);
    if (set->keys != NULL)
        return check_keys(path, row, set, error);
    if (row->store == PEL_STORE_KEYS || set->value_count != (kind == PEL_PARAMETER_VECTOR ? 3 : 1)) {
        pel_fail(error, PEL_BAD_ARGUMENT, "%s does not take that kind of value", path);
        pel_fail_remedy(error, "give %s", row->store == PEL_STORE_KEYS ? "keys" : forms[kind]);
        return PEL_BAD_ARGUMENT;
    }
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < set->value_count; i++)
        status = check_number(path, row, set->values[i], error);
    return status;
}

static bool is_same(const pel_def_row *row, const void *def, const setting *set)
{
    double values[3];
    int32_t key_count;
    pel_member_keys(row, def, &key_count);
    bool is_field = row->store == PEL_STORE_QUANTITY &&
                    ((const pel_quantity *)(const void *)((const char *)def + row->offset))->field != NULL;
    if (set->keys != NULL || key_count > 0 || is_field)
        return false;
    read_values(row, def, 0, values);
    for (int32_t i = 0; i < set->value_count; i++)
        if (!(values[i] == set->values[i] || (isnan(values[i]) && isnan(set->values[i]))))
            return false;
    return true;
}

static pel_status put(pel_change *change, const pel_def_row *row, void *def, const setting *set, pel_error *error)
{
    if (set->keys == NULL) {
        pel_member_set(row, def, set->values);
        return PEL_OK;
    }
    pel_key *keys = pel_copies_take(&change->copies, set->keys, (size_t)set->key_count * sizeof *keys);
    if (keys == NULL)
        return pel_fail_memory(error);
    for (int32_t k = 0; k < set->key_count; k++)
        keys[k].value /= pel_def_row_factor(row);
    pel_member_set_keys(row, def, keys, set->key_count);
    return PEL_OK;
}

static pel_status change_by_def(pel_sim *sim, pel_parameter_place at, const setting *set, pel_error *error)
{
    const pel_def_row *row = pel_def_row_at(at.row);
    pel_change change;
    pel_status status = pel_change_begin(sim, &change, error);
    change.changes_model = row->def == PEL_DEF_BODY || row->def == PEL_DEF_FIBRES || row->def == PEL_DEF_MODEL;
    if (status == PEL_OK) {
        /* the defs of a change may be written to */
        void *def = (void *)(uintptr_t)def_of((defs){&change.model, &change.sim}, row->def, at.element);
        status = put(&change, row, def, set, error);
    }
    if (status == PEL_OK)
        status = pel_change_apply(sim, &change, error);
    pel_change_end(&change);
    return status;
}

/* numbers that the next step reads from the copies in loads and tools */
static pel_status change_directly(pel_sim *sim, pel_parameter_place at, const double *values, pel_error *error)
{
    const pel_def_row *row = pel_def_row_at(at.row);
    union {
        pel_load_def load;
        pel_tool_def tool;
    } def;
    pel_status status;
    if (row->def == PEL_DEF_LOAD) {
        def.load = sim->def.loads[at.element];
        pel_member_set(row, &def.load, values);
        status = pel_load_retime(sim, at.element, &def.load, error);
    } else {
        def.tool = sim->def.tools[at.element];
        pel_member_set(row, &def.tool, values);
        status = pel_tool_regrasp(sim, at.element, &def.tool, error);
    }
    if (status == PEL_OK)
        pel_sim_take_fingerprint(sim);
    return status;
}

static pel_status change(pel_sim *sim, const char *path, const setting *set, pel_error *error)
{
    pel_parameter_place at;
    pel_status status = find_place(defs_of(sim), path, &at, error);
    if (status != PEL_OK)
        return status;
    const pel_def_row *row = pel_def_row_at(at.row);
    status = check_setting(path, row, set, error);
    if (status != PEL_OK || is_same(row, def_of(defs_of(sim), row->def, at.element), set))
        return status;
    return row->is_direct ? change_directly(sim, at, set->values, error) : change_by_def(sim, at, set, error);
}

pel_status pel_set_parameter(pel_sim *sim, const char *path, double value, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(path, error);
    return change(sim, path, &(setting){.values = &value, .value_count = 1}, error);
}

pel_status pel_set_parameter_vector(pel_sim *sim, const char *path, const double value[3], pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(value, error);
    return change(sim, path, &(setting){.values = value, .value_count = 3}, error);
}

pel_status pel_set_parameter_keys(pel_sim *sim, const char *path, const pel_key *keys, int32_t key_count,
                                  pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(path, error);
    if (key_count < 0 || (key_count > 0 && keys == NULL))
        return pel_fail(error, PEL_BAD_ARGUMENT, "key_count is %d, and keys is null or the count below 0",
                        (int)key_count);
    static const pel_key none;
    return change(sim, path, &(setting){.keys = keys != NULL ? keys : &none, .key_count = key_count}, error);
}

/* ---- text ---- */

static const char *skip_blanks(const char *text)
{
    return text + strspn(text, " \t");
}

/* "[x, y, z]" */
static bool parse_vector(const char *text, double values[3])
{
    const char *end = text + strlen(text);
    text = skip_blanks(text);
    for (int i = 0; i < 3; i++) {
        if (*text != (i == 0 ? '[' : ','))
            return false;
        text = pel_number_parse(skip_blanks(text + 1), end, &values[i]);
        if (text == NULL)
            return false;
        text = skip_blanks(text);
    }
    return text[0] == ']' && skip_blanks(text + 1)[0] == '\0';
}

static bool parse_word(const char *const *words, const char *text, double *value)
{
    for (int i = 0; words[i] != NULL; i++)
        if (strcmp(words[i], text) == 0) {
            *value = i;
            return true;
        }
    return false;
}

static bool parse_value(const pel_def_row *row, const char *text, double *value)
{
    static const char *const flags[] = {"false", "true", NULL};
    if (row->may_be_auto && (strcmp(text, "auto") == 0 || strcmp(text, "end") == 0)) {
        *value = (double)NAN;
        return true;
    }
    if (pel_def_row_words(row) != NULL)
        return parse_word(pel_def_row_words(row), text, value);
    if (pel_def_row_kind(row) == PEL_PARAMETER_SWITCH)
        return parse_word(flags, text, value);
    const char *end = pel_number_parse(skip_blanks(text), text + strlen(text), value);
    return end != NULL && skip_blanks(end)[0] == '\0' && isfinite(*value);
}

pel_status pel_set_parameter_text(pel_sim *sim, const char *path, const char *text, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(text, error);
    pel_parameter_place at;
    double values[3];
    pel_status status = find_place(defs_of(sim), path, &at, error);
    if (status != PEL_OK)
        return status;
    const pel_def_row *row = pel_def_row_at(at.row);
    const pel_parameter_kind kind = pel_def_row_kind(row);
    bool is_vector = kind == PEL_PARAMETER_VECTOR;
    if (is_vector ? parse_vector(text, values) : parse_value(row, text, values))
        return change(sim, path, &(setting){.values = values, .value_count = is_vector ? 3 : 1}, error);
    if (kind == PEL_PARAMETER_WORD)
        return refuse_word(path, row, error);
    pel_fail(error, PEL_BAD_ARGUMENT, "%s cannot be '%.100s'", path, text);
    pel_fail_remedy(error, "give %s",
                    is_vector                      ? "[x, y, z]"
                    : kind == PEL_PARAMETER_SWITCH ? "true or false"
                                                   : "a number");
    return PEL_BAD_ARGUMENT;
}

/* ---- in defs, without a simulation ---- */

pel_status pel_parameter_find_place(const pel_model_def *model, const pel_sim_def *sim, const char *path,
                                    pel_parameter_place *found, pel_error *error)
{
    return find_place((defs){model, sim}, path, found, error);
}

bool pel_parameter_write(const pel_model_def *model, const pel_sim_def *sim, pel_parameter_place at, const char *text)
{
    const pel_def_row *row = pel_def_row_at(at.row);
    const defs all = {model, sim};
    double values[3];
    bool is_vector = pel_def_row_kind(row) == PEL_PARAMETER_VECTOR;
    if (row->store == PEL_STORE_KEYS || !(is_vector ? parse_vector(text, values) : parse_value(row, text, values)))
        return false;
    for (int i = 0; i < (is_vector ? 3 : 1); i++)
        if (isnan(values[i]) || check_number(path_of(row), row, values[i], NULL) != PEL_OK)
            return false;
    /* the caller owns the defs */
    pel_member_set(row, (void *)(uintptr_t)def_of(all, row->def, at.element), values);
    return true;
}

pel_status pel_parameter_copy(pel_sim *sim, const pel_sim_def *def, pel_parameter_place at, pel_error *error)
{
    const pel_def_row *row = pel_def_row_at(at.row);
    const defs all = {&sim->given->def, def};
    double values[3];
    read_values(row, def_of(all, row->def, at.element), 0, values);
    return change_directly(sim, at, values, error);
}
