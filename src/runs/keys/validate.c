#include "keys/validate.h"

#include "base/number.h"
#include "base/text.h"
#include "keys/everyday.h"
#include "keys/yaml.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PATH_SIZE = 160, MOST_NAMES = 64, MOST_LISTED = 14 };

static pel_status check_value(pel_scene_reader *reader, const pel_def_row *row, const pel_def_row *limits,
                              pel_scene_value *value);

static bool is_one_of(const char *text, const char *const *words)
{
    while (*words != NULL && strcmp(*words, text) != 0)
        words++;
    return *words != NULL;
}

pel_status pel_scene_value_set_number(pel_scene_reader *reader, pel_scene_value *value, double number)
{
    char text[PEL_NUMBER_SIZE];
    pel_number_print(text, number);
    value->kind = PEL_SCENE_SCALAR;
    value->form = PEL_FORM_NUMBER;
    value->quoted = false;
    value->number = number;
    value->text = pel_arena_text(reader->arena, text, strlen(text));
    return value->text != NULL ? PEL_OK : pel_fail_memory(reader->error);
}

pel_status pel_scene_value_set_vector(pel_scene_reader *reader, pel_scene_value *value, const double vector[3])
{
    value->kind = PEL_SCENE_LIST;
    value->form = PEL_FORM_VECTOR;
    value->first = value->last = NULL;
    for (int i = 0; i < 3; i++) {
        pel_scene_value *number = pel_scene_value_create(reader, PEL_SCENE_SCALAR, value->place);
        if (number == NULL || pel_scene_value_set_number(reader, number, vector[i]) != PEL_OK)
            return PEL_OUT_OF_MEMORY;
        pel_scene_value_append(value, NULL, number);
    }
    return PEL_OK;
}

bool pel_scene_value_is_null(const pel_scene_value *value)
{
    static const char *const nulls[] = {"", "~", "null", "Null", "NULL", NULL};
    return value->kind == PEL_SCENE_SCALAR && !value->quoted && is_one_of(value->text, nulls);
}

/* ---- messages ---- */

/* "a list", "'soft'": description of a value for a message */
static const char *describe(const pel_scene_value *value, char *text, size_t size)
{
    if (value->kind == PEL_SCENE_SCALAR && !pel_scene_value_is_null(value))
        snprintf(text, size, "'%.80s'", value->text);
    else
        snprintf(text, size, "%s",
                 value->kind == PEL_SCENE_MAP    ? "a map"
                 : value->kind == PEL_SCENE_LIST ? "a list"
                                                 : "nothing");
    return text;
}

/* appends ", name" while there is room, then dots */
static void add_name(char *text, size_t size, const char *name)
{
    size_t length = strlen(text);
    const char *comma = length > 0 ? ", " : "";
    if (length >= 3 && strcmp(text + length - 3, "...") == 0)
        return;
    bool fits = length + strlen(name) + sizeof ", , ..." <= size;
    snprintf(text + length, size - length, "%s%s", comma, fits ? name : "...");
}

/* whether a text is a number and a unit */
static bool has_unit(const char *text)
{
    double number;
    const char *end = pel_number_parse(text, text + strlen(text), &number);
    return end != NULL && isfinite(number) && (*end == ' ' || isalpha((unsigned char)*end));
}

static bool is_number(const char *text)
{
    double number;
    const char *end = pel_number_parse(text, text + strlen(text), &number);
    return end != NULL && *end == '\0';
}

/* the key of a map that has a scalar as its word; null if there is none */
static const char *key_of_word(const pel_scene_reader *reader, const pel_def_row *row, const pel_scene_value *value)
{
    const char *prefix = pel_scene_row_prefix(row);
    for (const pel_def_row *child = NULL; (child = pel_scene_row_next(reader->table, prefix, child)) != NULL;)
        if (value->kind == PEL_SCENE_SCALAR && child->words != NULL && is_one_of(value->text, child->words))
            return pel_scene_row_name(child, prefix);
    return NULL;
}

/* the key of a map that has a list in its place; null if there is none */
static const char *key_of_list(const pel_scene_reader *reader, const pel_def_row *row, const pel_scene_value *value)
{
    const char *prefix = pel_scene_row_prefix(row);
    const pel_scene_value *first = value->kind == PEL_SCENE_LIST ? value->first : NULL;
    const bool has_numbers = first != NULL && first->kind == PEL_SCENE_SCALAR;
    const pel_def_row *found = NULL;
    for (const pel_def_row *child = NULL;
         first != NULL && (child = pel_scene_row_next(reader->table, prefix, child)) != NULL;) {
        const pel_def_row *element = pel_scene_row_find(reader->table, child->path, "[]");
        const bool is_list =
            child->forms == PEL_FORM_LIST && element != NULL && ((element->forms & PEL_FORM_MAP) != 0) == !has_numbers;
        if (is_list && (!has_numbers || element->forms == PEL_FORM_INTEGER))
            return pel_scene_row_name(child, prefix);
        if (found == NULL && has_numbers && child->forms == PEL_FORM_VECTOR)
            found = child;
    }
    return found != NULL ? pel_scene_row_name(found, prefix) : NULL;
}

/* the expected form, for a value of the wrong form */
static void advise_form(pel_scene_reader *reader, const pel_def_row *row, const pel_scene_value *value)
{
    const char *prefix = pel_scene_row_prefix(row);
    if (value->kind == PEL_SCENE_SCALAR && has_unit(value->text) && row->unit != NULL) {
        pel_fail_remedy(reader->error, "write the number without a unit; it is in %s", row->unit);
        return;
    }
    char names[200] = "";
    bool takes_file = false;
    const char *key = row->forms == PEL_FORM_MAP ? key_of_word(reader, row, value) : NULL;
    const char *list_key = row->forms & PEL_FORM_MAP ? key_of_list(reader, row, value) : NULL;
    for (const pel_def_row *child = NULL;
         row->forms == PEL_FORM_MAP && (child = pel_scene_row_next(reader->table, prefix, child)) != NULL;) {
        const char *name = pel_scene_row_name(child, prefix);
        add_name(names, sizeof names, name);
        takes_file |= strcmp(name, "file") == 0;
    }
    const pel_scene_value *first = value->kind == PEL_SCENE_MAP ? value->first : NULL;
    if (row->forms == PEL_FORM_LIST && first != NULL && first->kind == PEL_SCENE_MAP)
        pel_fail_remedy(reader->error, "write the keys of '%.100s' as an element, after '- '", first->key);
    else if (row->forms == PEL_FORM_LIST && first != NULL)
        pel_fail_remedy(reader->error, "begin each element with '- %.100s'", first->key);
    else if (takes_file && value->kind == PEL_SCENE_SCALAR && strchr(value->text, '.') != NULL)
        pel_fail_remedy(reader->error, "write { file: %.150s }", value->text);
    else if (key != NULL)
        pel_fail_remedy(reader->error, "write { %s: %s }", key, value->text);
    else if (list_key != NULL)
        pel_fail_remedy(reader->error, "write { %s: [...] }", list_key);
    else if (row->forms == PEL_FORM_VECTOR && value->kind == PEL_SCENE_SCALAR && is_number(value->text))
        pel_fail_remedy(reader->error, "write [0, 0, %s] for one along z", value->text);
    else if (value->kind == PEL_SCENE_SCALAR && value->parent != NULL && names[0] != '\0')
        pel_fail_remedy(reader->error, "write { key: value } with keys of: %s", names);
    else
        pel_fail_remedy(reader->error, "it means: %s", row->doc);
}

static pel_status fail_form(pel_scene_reader *reader, const pel_def_row *row, const pel_scene_value *value)
{
    static const char *const not_finite[] = {".inf",  ".Inf",  ".INF", "+.inf", "-.inf", "+.Inf", "-.Inf",
                                             "+.INF", "-.INF", ".nan", ".NaN",  ".NAN",  NULL};
    char path[PATH_SIZE], form[200], found[100];
    pel_scene_fail(reader, &value->place, "%s is %s, it must be: %s",
                   value->parent != NULL ? pel_scene_value_path(value, path, sizeof path) : "the scene",
                   /* a file that is no scene, and may hold secrets, is one text */
                   value->parent == NULL && value->kind == PEL_SCENE_SCALAR ? "a text"
                                                                            : describe(value, found, sizeof found),
                   pel_scene_form_text(row, form, sizeof form));
    if (value->kind == PEL_SCENE_SCALAR && is_one_of(value->text, not_finite))
        pel_fail_remedy(reader->error, "infinite numbers and NaN are refused");
    else
        advise_form(reader, row, value);
    return PEL_BAD_SCENE;
}

static pel_status fail_range(pel_scene_reader *reader, const pel_def_row *limits, const pel_scene_value *value)
{
    char path[PATH_SIZE], range[80];
    const char *unit = limits->unit != NULL ? limits->unit : "";
    const char *space = limits->unit != NULL ? " " : "";
    pel_scene_fail(reader, &value->place, "%s is out of range: %.80s%s%s",
                   pel_scene_value_path(value, path, sizeof path), value->text, space, unit);
    pel_fail_remedy(reader->error, "it must be %s%s%s",
                    limits->range.given ? pel_range_text(limits->range, range, sizeof range) : "finite", space, unit);
    return PEL_BAD_SCENE;
}

static pel_status fail_count(pel_scene_reader *reader, const pel_scene_value *value, int32_t count, const char *remedy)
{
    char path[PATH_SIZE];
    pel_scene_fail(reader, &value->place, "%s has %d element%s", pel_scene_value_path(value, path, sizeof path),
                   (int)count, count == 1 ? "" : "s");
    pel_fail_remedy(reader->error, "%s", remedy);
    return PEL_BAD_SCENE;
}

pel_status pel_scene_fail_name(pel_scene_reader *reader, const pel_scene_place *place, const char *what,
                               const char *name, const char *const *known, size_t known_count)
{
    pel_scene_fail(reader, place, "unknown %s '%.100s'", what, name);
    const char *nearest = pel_nearest_name(name, known, known_count);
    char list[250] = "";
    for (size_t i = 0; i < known_count; i++)
        add_name(list, sizeof list, known[i]);
    if (nearest != NULL)
        pel_fail_remedy(reader->error, "did you mean '%s'?", nearest);
    else if (known_count > 0)
        pel_fail_remedy(reader->error, "known are: %s", list);
    else
        pel_fail_remedy(reader->error, "there is none to name here");
    return PEL_BAD_SCENE;
}

static size_t word_count(const pel_def_row *row)
{
    size_t count = 0;
    while (row->words[count] != NULL)
        count++;
    return count;
}

/* The row of another key of this name that has the word, or a longer one, `found`; null if there is none. */
static const pel_def_row *row_of_word(const pel_scene_table *table, const char *key, const char *word,
                                      const char **found)
{
    const pel_def_row *nearest = NULL;
    for (size_t i = 0; i < table->row_count; i++) {
        const pel_def_row *row = &table->rows[i];
        const char *last = strrchr(row->path, '.');
        if (row->words == NULL || last == NULL || strcmp(last + 1, key) != 0)
            continue;
        if (is_one_of(word, row->words)) {
            *found = word;
            return row;
        }
        const char *longer = nearest == NULL ? pel_longer_name(word, row->words, word_count(row)) : NULL;
        if (longer != NULL) {
            *found = longer;
            nearest = row;
        }
    }
    return nearest;
}

pel_status pel_scene_fail_word(pel_scene_reader *reader, const pel_scene_value *value, const char *const *known,
                               size_t known_count)
{
    const char *key = value->key != NULL ? value->key : "word";
    const char *found = value->text;
    const pel_def_row *row = row_of_word(reader->table, key, value->text, &found);
    const char *longer = pel_longer_name(value->text, known, known_count);
    /* a geodesic-sphere is a sphere, but a paper-a is no paper */
    bool is_kind = longer != NULL && strcmp(longer + strlen(longer) - strlen(value->text), value->text) == 0;
    const char *everyday = pel_everyday_word(value->text, known, known_count);
    pel_scene_fail_name(reader, &value->place, key, value->text, known, known_count);
    if (everyday != NULL)
        pel_fail_remedy(reader->error, "%s", everyday);
    else if (row != NULL && !is_kind && (found == value->text || longer == NULL))
        pel_fail_remedy(reader->error, "'%s' is a word of %s", found, row->path);
    else if (longer != NULL)
        pel_fail_remedy(reader->error, "did you mean '%s'?", longer);
    return PEL_BAD_SCENE;
}

/* the names of the rows that apply in a map */
static size_t applying_names(pel_scene_reader *reader, const char *prefix, const pel_scene_value *map,
                             const char *names[MOST_NAMES])
{
    size_t count = 0;
    const pel_def_row *row = NULL;
    while ((row = pel_scene_row_next(reader->table, prefix, row)) != NULL)
        if (count < MOST_NAMES && pel_scene_row_applies(row, map))
            names[count++] = pel_scene_row_name(row, prefix);
    return count;
}

/* whether a name stands in a list that add_name made */
static bool has_name(const char *list, const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = strstr(list, name); at != NULL; at = strstr(at + 1, name))
        if ((at == list || at[-1] == ' ') && (at[length] == '\0' || at[length] == ','))
            return true;
    return false;
}

/* Adds the maps that have a key to `places`: those below a prefix that begins with the first `length` letters of
   `near`, or the others. */
static void add_places(const pel_scene_reader *reader, const char *key, const char *near, size_t length, bool others,
                       char *places, size_t size)
{
    const pel_scene_table *table = reader->table;
    for (size_t i = 0; i < table->row_count; i++) {
        const char *path = table->rows[i].path;
        const bool is_near = strncmp(path, near, length) == 0;
        if (table->names[i] == NULL || strcmp(table->names[i], key) != 0 || is_near == others)
            continue;
        char place[PATH_SIZE];
        const size_t parent = table->parent_lengths[i];
        const char *end = path[0] == '<' ? strchr(path, '>') : NULL;
        if (end != NULL)
            snprintf(place, sizeof place, "%.*s%.*s", (int)(end - path) - 1, path + 1, (int)(path + parent - end) - 1,
                     end + 1);
        else
            snprintf(place, sizeof place, "%.*s", parent > 0 ? (int)parent : PATH_SIZE,
                     parent > 0 ? path : "the scene");
        /* several rows are one key with several shapes */
        if (!has_name(places, place))
            add_name(places, size, place);
    }
}

/* the maps elsewhere that have a key, the near ones first; "" if there are none */
static const char *find_places(const pel_scene_reader *reader, const char *prefix, const char *key, char *places,
                               size_t size)
{
    const size_t whole = strlen(prefix), top = strcspn(prefix, ".");
    places[0] = '\0';
    if (whole > 0) {
        add_places(reader, key, prefix, whole, false, places, size);
        if (places[0] == '\0')
            add_places(reader, key, prefix, top, false, places, size);
    }
    add_places(reader, key, "\n", 1, true, places, size);
    return places;
}

pel_status pel_scene_fail_key(pel_scene_reader *reader, const pel_scene_place *place, const char *prefix,
                              const char *key, const char *const *known, size_t known_count)
{
    char places[120];
    const char *everyday = pel_everyday_key(key, known, known_count), *thing = pel_everyday_thing(key);
    const bool is_short = known_count > 0 && known_count <= MOST_LISTED;
    char list[250] = "";
    for (size_t i = 0; is_short && i < known_count; i++)
        add_name(list, sizeof list, known[i]);
    pel_scene_fail_name(reader, place, "key", key, known, known_count);
    if (strspn(key, "0123456789") == strlen(key))
        pel_fail_remedy(reader->error, "numbers have a point and no commas: 0.5, 100000");
    else if (everyday != NULL && pel_is_among(everyday, known, known_count))
        pel_fail_remedy(reader->error, "did you mean '%s'?", everyday);
    else if (find_places(reader, prefix, key, places, sizeof places)[0] != '\0')
        pel_fail_remedy(reader->error, "it is a key of %s%s%s", places, is_short ? "; known here are: " : "", list);
    else if (thing != NULL)
        pel_fail_remedy(reader->error, "%s", thing);
    else if (everyday != NULL && find_places(reader, prefix, everyday, places, sizeof places)[0] != '\0')
        pel_fail_remedy(reader->error, "did you mean '%s'? it is a key of %s", everyday, places);
    return PEL_BAD_SCENE;
}

/* the key beside a map that has its course over time, such as rest_keys of rest_scale; null if there is none */
static const pel_def_row *row_over_time(const pel_scene_table *table, const pel_scene_value *map)
{
    for (size_t i = 0; map->key != NULL && i < table->row_count; i++) {
        const pel_def_row *row = &table->rows[i];
        const char *ending = table->names[i] != NULL ? strrchr(table->names[i], '_') : NULL;
        if (ending != NULL && strcmp(ending, "_keys") == 0 && row->needs != NULL && strcmp(row->needs, map->key) == 0)
            return row;
    }
    return NULL;
}

static pel_status fail_key(pel_scene_reader *reader, const char *prefix, const pel_scene_value *entry)
{
    const pel_def_row *course = strcmp(entry->key, "keys") == 0 ? row_over_time(reader->table, entry->parent) : NULL;
    const pel_def_row *row = pel_scene_row_find(reader->table, prefix, entry->key);
    if (row != NULL && pel_scene_value_entry(entry->parent, row->needs) == NULL) {
        pel_scene_fail(reader, &entry->key_place, "key '%s' is allowed only with: %s", entry->key, row->needs);
        pel_fail_remedy(reader->error, "add that key, or remove this one");
        return PEL_BAD_SCENE;
    }
    const char *names[MOST_NAMES];
    size_t count = applying_names(reader, prefix, entry->parent, names);
    const pel_scene_value *selector = row != NULL ? pel_scene_value_entry(entry->parent, row->needs) : NULL;
    char what[80] = "key";
    if (selector != NULL)
        snprintf(what, sizeof what, "key of %s %.40s:", selector->key, selector->text);
    if (row == NULL)
        pel_scene_fail_key(reader, &entry->key_place, prefix, entry->key, names, count);
    if (row == NULL && course != NULL)
        pel_fail_remedy(reader->error, "its course over time is the key '%s' beside '%s': %s",
                        strrchr(course->path, '.') + 1, entry->parent->key, course->doc);
    if (row == NULL)
        return PEL_BAD_SCENE;
    return pel_scene_fail_name(reader, &entry->key_place, what, entry->key, names, count);
}

static pel_status fail_missing(pel_scene_reader *reader, const pel_scene_value *map, const char *what)
{
    char path[PATH_SIZE];
    const char *name = map->parent != NULL ? pel_scene_value_path(map, path, sizeof path) : "the scene";
    return pel_scene_fail(reader, &map->place, "%s lacks %s", name, what);
}

/* the remedy has the value of a key that may have only one */
static pel_status fail_missing_key(pel_scene_reader *reader, const pel_scene_value *map, const pel_def_row *row,
                                   const char *key, const char *doc)
{
    char quoted[212], only[32] = "";
    snprintf(quoted, sizeof quoted, "'%s'", key);
    fail_missing(reader, map, quoted);
    if (row->range.given && !(row->range.most > row->range.least))
        snprintf(only, sizeof only, " %g", row->range.least);
    const char *end = strstr(doc, "; left out");
    pel_fail_remedy(reader->error, "add '%s:%s': %.*s", key, only, end != NULL ? (int)(end - doc) : (int)strlen(doc),
                    doc);
    return PEL_BAD_SCENE;
}

/* ---- scalars ---- */

static pel_status accept(pel_scene_value *value, pel_form form, double number)
{
    value->form = form;
    value->number = number;
    return PEL_OK;
}

static bool parse_boolean(const char *text, double *number)
{
    static const char *const yes[] = {"true", "True", "TRUE", NULL}, *const no[] = {"false", "False", "FALSE", NULL};
    *number = is_one_of(text, yes) ? 1 : 0;
    return *number > 0 || is_one_of(text, no);
}

static pel_status check_number(pel_scene_reader *reader, const pel_def_row *limits, pel_scene_value *value,
                               pel_form form, double number)
{
    if (!pel_range_has(limits->range, number))
        return fail_range(reader, limits, value);
    if (!isfinite(number)) {
        fail_range(reader, limits, value);
        pel_fail_remedy(reader->error, "it must be finite");
        return PEL_BAD_SCENE;
    }
    return accept(value, form, number);
}

/* a word of the row */
static pel_status check_word(pel_scene_reader *reader, const pel_def_row *row, pel_scene_value *value)
{
    size_t count = 0;
    for (; row->words[count] != NULL; count++)
        if (strcmp(row->words[count], value->text) == 0)
            return accept(value, PEL_FORM_WORD, (double)count);
    if (row->forms != PEL_FORM_WORD)
        return fail_form(reader, row, value);
    return pel_scene_fail_word(reader, value, row->words, count);
}

static pel_status check_scalar(pel_scene_reader *reader, const pel_def_row *row, const pel_def_row *limits,
                               pel_scene_value *value)
{
    double number;
    if ((row->forms & PEL_FORM_NUMBER) != 0 && !value->quoted && pel_scene_parse_number(value->text, &number))
        return check_number(reader, limits, value, PEL_FORM_NUMBER, number);
    if ((row->forms & PEL_FORM_INTEGER) != 0 && !value->quoted && pel_scene_parse_integer(value->text, &number))
        return check_number(reader, limits, value, PEL_FORM_INTEGER, number);
    if ((row->forms & PEL_FORM_BOOLEAN) != 0 && !value->quoted && parse_boolean(value->text, &number))
        return accept(value, PEL_FORM_BOOLEAN, number);
    if (pel_scene_value_is_null(value) || (row->forms & (PEL_FORM_WORD | PEL_FORM_TEXT)) == 0)
        return fail_form(reader, row, value);
    if ((row->forms & PEL_FORM_WORD) != 0)
        return check_word(reader, row, value);
    if (value->text[0] == '\0') {
        char path[PATH_SIZE];
        pel_scene_fail(reader, &value->place, "%s is empty", pel_scene_value_path(value, path, sizeof path));
        pel_fail_remedy(reader->error, "give a text, or leave the key out");
        return PEL_BAD_SCENE;
    }
    /* the range of a text applies to its length */
    if (!pel_range_has(row->range, (double)strlen(value->text)))
        return fail_range(reader, row, value);
    return accept(value, PEL_FORM_TEXT, 0);
}

/* ---- lists ---- */

/* [x, y], [time, value] or [x, y, z] */
static pel_status check_tuple(pel_scene_reader *reader, const pel_def_row *row, const pel_def_row *limits,
                              pel_scene_value *value, pel_form form, int32_t needed)
{
    static const pel_def_row time = {
        .forms = PEL_FORM_NUMBER, .unit = "s", .range = {true, false, 0, (double)HUGE_VAL}, .doc = "a time"};
    pel_def_row part = {.forms = PEL_FORM_NUMBER, .unit = limits->unit, .range = limits->range, .doc = row->doc};
    if (pel_scene_value_count(value) != needed)
        return fail_count(reader, value, pel_scene_value_count(value),
                          form == PEL_FORM_VECTOR ? "give three numbers [x, y, z]"
                          : form == PEL_FORM_KEY  ? "give a time and a value [t, value]"
                                                  : "give two numbers [a, b]");
    for (pel_scene_value *child = value->first; child != NULL; child = child->next) {
        bool is_time = form == PEL_FORM_KEY && child == value->first;
        const pel_def_row *child_row = is_time ? &time : &part;
        pel_status status = check_value(reader, child_row, child_row, child);
        if (status != PEL_OK)
            return status;
    }
    return accept(value, form, 0);
}

static pel_status check_elements(pel_scene_reader *reader, const pel_def_row *row, const pel_def_row *limits,
                                 pel_scene_value *value)
{
    const pel_def_row *element = pel_scene_row_find(reader->table, row->path, "[]");
    int32_t count = pel_scene_value_count(value);
    char range[80], remedy[100];
    if (!pel_range_has(row->range, count)) {
        snprintf(remedy, sizeof remedy, "it must have %s elements", pel_range_text(row->range, range, sizeof range));
        return fail_count(reader, value, count, remedy);
    }
    for (pel_scene_value *child = value->first; child != NULL; child = child->next) {
        pel_status status = check_value(reader, element, element->scoped ? limits : element, child);
        if (status != PEL_OK)
            return status;
    }
    return accept(value, PEL_FORM_LIST, 0);
}

static pel_status check_list(pel_scene_reader *reader, const pel_def_row *row, const pel_def_row *limits,
                             pel_scene_value *value)
{
    if ((row->forms & PEL_FORM_PAIR) != 0)
        return check_tuple(reader, row, limits, value, PEL_FORM_PAIR, 2);
    if ((row->forms & PEL_FORM_KEY) != 0)
        return check_tuple(reader, row, limits, value, PEL_FORM_KEY, 2);
    if ((row->forms & PEL_FORM_VECTOR) != 0)
        return check_tuple(reader, row, limits, value, PEL_FORM_VECTOR, 3);
    if ((row->forms & PEL_FORM_LIST) != 0)
        return check_elements(reader, row, limits, value);
    return fail_form(reader, row, value);
}

/* ---- maps ---- */

bool pel_scene_row_applies(const pel_def_row *row, const pel_scene_value *map)
{
    if (row->needs == NULL)
        return true;
    for (const pel_scene_value *entry = map->first; entry != NULL; entry = entry->next)
        if (pel_scene_row_needs(row, entry->key))
            return row->needs_word == NULL || strcmp(row->needs_word, entry->text) == 0;
    return false;
}

/* the row of an entry, null when the map has no such key */
static const pel_def_row *row_of_entry(pel_scene_reader *reader, const char *prefix, const pel_scene_value *entry)
{
    const pel_def_row *row = NULL;
    while ((row = pel_scene_row_next(reader->table, prefix, row)) != NULL)
        if (strcmp(pel_scene_row_name(row, prefix), entry->key) == 0 && pel_scene_row_applies(row, entry->parent))
            return row;
    return NULL;
}

/* every key has a name that the table knows and stands once */
static pel_status check_names(pel_scene_reader *reader, const char *prefix, const pel_scene_value *map)
{
    for (const pel_scene_value *entry = map->first; entry != NULL; entry = entry->next) {
        if (pel_scene_row_find(reader->table, prefix, entry->key) == NULL)
            return fail_key(reader, prefix, entry);
        const pel_scene_value *before = pel_scene_value_entry(map, entry->key);
        if (before == entry)
            continue;
        pel_scene_fail(reader, &entry->key_place, "key '%s' is given twice", entry->key);
        pel_fail_remedy(reader->error, "keep one of them; the other is in line %d", (int)before->key_place.line);
        return PEL_BAD_SCENE;
    }
    return PEL_OK;
}

/* a key without value counts as missing */
static void remove_nulls(pel_scene_value *map)
{
    for (pel_scene_value *entry = map->first, *next; entry != NULL; entry = next) {
        next = entry->next;
        if (pel_scene_value_is_null(entry))
            pel_scene_value_remove(entry);
    }
}

static pel_status refuse_alternatives(pel_scene_reader *reader, const char *prefix, const pel_scene_value *first,
                                      const pel_scene_value *second)
{
    pel_scene_fail(reader, &second->key_place, "'%s' and '%s' exclude each other", first->key, second->key);
    pel_fail_remedy(reader->error, "remove one of them");
    /* one of them may contain the other */
    for (int i = 0; i < 2; i++) {
        const pel_scene_value *outer = i == 0 ? first : second, *inner = i == 0 ? second : first;
        const pel_def_row *row = row_of_entry(reader, prefix, outer);
        if (pel_scene_row_find(reader->table, pel_scene_row_prefix(row), inner->key) != NULL)
            pel_fail_remedy(reader->error, "remove one of them, or move '%s' into '%s'", inner->key, outer->key);
    }
    return PEL_BAD_SCENE;
}

/* Checks that at most one alternative is given, and its value. It comes first because other keys may depend on it. */
static pel_status check_alternatives(pel_scene_reader *reader, const char *prefix, const pel_def_row *limits,
                                     pel_scene_value *map)
{
    const pel_scene_value *found = NULL;
    for (pel_scene_value *entry = map->first; entry != NULL; entry = entry->next) {
        const pel_def_row *row = row_of_entry(reader, prefix, entry);
        if (row == NULL || !row->alternative)
            continue;
        if (found != NULL)
            return refuse_alternatives(reader, prefix, found, entry);
        found = entry;
        pel_status status = check_value(reader, row, row->scoped ? limits : row, entry);
        if (status != PEL_OK)
            return status;
    }
    return PEL_OK;
}

/* checks that the keys are allowed together */
static pel_status check_conditions(pel_scene_reader *reader, const char *prefix, const pel_scene_value *map)
{
    for (const pel_scene_value *entry = map->first; entry != NULL; entry = entry->next)
        if (row_of_entry(reader, prefix, entry) == NULL)
            return fail_key(reader, prefix, entry);
    return PEL_OK;
}

/* text with # replaced by the number of the list element that value is */
static const char *numbered(pel_scene_reader *reader, const char *preset, const pel_scene_value *value)
{
    size_t before = strcspn(preset, "#");
    if (preset[before] == '\0')
        return preset;
    int number = 1;
    for (const pel_scene_value *other = value->parent->first; other != value; other = other->next)
        number++;
    char text[PEL_NAME_SIZE];
    int length = snprintf(text, sizeof text, "%.*s%d%s", (int)before, preset, number, preset + before + 1);
    return pel_arena_text(reader->arena, text, (size_t)length);
}

/* the default of a row as a value in a map; null when out of memory */
static pel_scene_value *create_preset(pel_scene_reader *reader, const pel_def_row *row, const pel_scene_value *map)
{
    pel_scene_value *value;
    if (row->preset[0] == '[' || row->preset[0] == '{') {
        value = pel_scene_yaml_parse(reader, map->place.source, row->preset, strlen(row->preset), false);
    } else {
        value = pel_scene_value_create(reader, PEL_SCENE_SCALAR, map->place);
        if (value != NULL && (value->text = numbered(reader, row->preset, map)) == NULL) {
            pel_fail_memory(reader->error);
            return NULL;
        }
    }
    if (value != NULL)
        value->place = value->key_place = map->place;
    return value;
}

static pel_status add_preset(pel_scene_reader *reader, const pel_def_row *row, const char *name, pel_scene_value *map)
{
    pel_scene_value *value = create_preset(reader, row, map);
    if (value == NULL)
        return PEL_OUT_OF_MEMORY;
    value->is_implied = true;
    pel_scene_value_append(map, name, value);
    return PEL_OK;
}

/* if no alternative is given: fills in the default one, or fails if one is required and has no default */
static pel_status fill_alternative(pel_scene_reader *reader, const char *prefix, bool needed, pel_scene_value *map)
{
    const pel_def_row *last = NULL, *chosen = NULL;
    char names[200] = "";
    for (const pel_def_row *row = NULL; (row = pel_scene_row_next(reader->table, prefix, row)) != NULL;) {
        if (!row->alternative)
            continue;
        const char *name = pel_scene_row_name(row, prefix);
        if (pel_scene_value_entry(map, name) != NULL)
            return PEL_OK;
        add_name(names, sizeof names, name);
        last = row;
        if (row->preset != NULL)
            chosen = row;
    }
    if (chosen != NULL)
        return add_preset(reader, chosen, pel_scene_row_name(chosen, prefix), map);
    if (last == NULL || !needed)
        return PEL_OK;
    if (strchr(names, ',') == NULL)
        return fail_missing_key(reader, map, last, names, last->doc);
    fail_missing(reader, map, "one of its main keys");
    pel_fail_remedy(reader->error, "add one of: %s", names);
    return PEL_BAD_SCENE;
}

/* sort the entries into the order of the table and add missing ones */
static pel_status fill_entries(pel_scene_reader *reader, const char *prefix, pel_scene_value *map)
{
    for (const pel_def_row *row = NULL; (row = pel_scene_row_next(reader->table, prefix, row)) != NULL;) {
        const char *name = pel_scene_row_name(row, prefix);
        if (!pel_scene_row_applies(row, map))
            continue;
        pel_scene_value *entry = pel_scene_value_entry(map, name);
        if (entry != NULL) {
            pel_scene_value_remove(entry);
            pel_scene_value_append(map, name, entry);
        } else if (row->required) {
            return fail_missing_key(reader, map, row, name, row->doc);
        } else if (row->preset != NULL && !row->alternative) {
            pel_status status = add_preset(reader, row, name, map);
            if (status != PEL_OK)
                return status;
        }
    }
    return PEL_OK;
}

static pel_status check_map(pel_scene_reader *reader, const pel_def_row *row, const pel_def_row *limits,
                            pel_scene_value *map)
{
    if (row != NULL && (row->forms & PEL_FORM_MAP) == 0)
        return fail_form(reader, row, map);
    const char *prefix = pel_scene_row_prefix(row);
    pel_status status = check_names(reader, prefix, map);
    if (status != PEL_OK)
        return status;
    remove_nulls(map);
    status = check_alternatives(reader, prefix, limits, map);
    /* the default first: keys may depend on it */
    if (status == PEL_OK)
        status = fill_alternative(reader, prefix, false, map);
    if (status == PEL_OK)
        status = check_conditions(reader, prefix, map);
    if (status == PEL_OK)
        status = fill_alternative(reader, prefix, true, map);
    if (status == PEL_OK)
        status = fill_entries(reader, prefix, map);
    for (pel_scene_value *entry = map->first; status == PEL_OK && entry != NULL; entry = entry->next) {
        const pel_def_row *entry_row = row_of_entry(reader, prefix, entry);
        status = check_value(reader, entry_row, entry_row->scoped ? limits : entry_row, entry);
    }
    return status == PEL_OK ? accept(map, PEL_FORM_MAP, 0) : status;
}

/* limits: the row whose unit and range hold for numbers */
static pel_status check_value(pel_scene_reader *reader, const pel_def_row *row, const pel_def_row *limits,
                              pel_scene_value *value)
{
    if (value->kind == PEL_SCENE_MAP)
        return check_map(reader, row, limits, value);
    if (value->kind == PEL_SCENE_LIST)
        return check_list(reader, row, limits, value);
    return check_scalar(reader, row, limits, value);
}

pel_status pel_scene_check_kind(pel_scene_reader *reader, const pel_scene_value *root, const char *wanted)
{
    static const struct {
        const char *kind, *key, *command;
    } kinds[] = {{"scene", "bodies", "run"}, {"study", "vary", "sweep"}, {"fit", "parameters", "calibrate"}};
    size_t found = 0, count = sizeof kinds / sizeof *kinds;
    for (size_t i = 0; i < count; i++)
        if (strcmp(kinds[i].kind, wanted) == 0 && pel_scene_value_entry(root, kinds[i].key) != NULL)
            return PEL_OK;
    while (found < count && pel_scene_value_entry(root, kinds[found].key) == NULL)
        found++;
    if (found == count)
        return PEL_OK;
    pel_scene_fail(reader, &root->place, "the file is a %s, and a %s is needed here", kinds[found].kind, wanted);
    pel_fail_remedy(reader->error, "use it with pellicle %s", kinds[found].command);
    return PEL_BAD_SCENE;
}

pel_status pel_scene_check(pel_scene_reader *reader, pel_scene_value *root)
{
    static const pel_def_row scene = {.path = "", .forms = PEL_FORM_MAP, .doc = "the scene"};
    if (root->kind != PEL_SCENE_MAP)
        return fail_form(reader, &scene, root);
    if (pel_scene_check_kind(reader, root, "scene") != PEL_OK)
        return PEL_BAD_SCENE;
    /* report the version first */
    pel_scene_value *version = pel_scene_value_entry(root, "version");
    const pel_def_row *row = pel_scene_row_find(reader->table, "", "version");
    if (version != NULL && check_value(reader, row, row, version) != PEL_OK)
        return PEL_BAD_SCENE;
    return check_map(reader, NULL, NULL, root);
}
