/* The design of a study: which values the parameters take together. */
#include "study/study.h"

#include "base/number.h"
#include "math/functions.h"
#include "study/sobol.h"

#include <math.h>
#include <string.h>

static const char *const range_keys[] = {"from", "to", "count", "scale", "sobol", "latin", "seed"};
static const char *const scale_words[] = {"linear", "log"};

typedef enum sample_kind { SAMPLE_LIST, SAMPLE_EVEN, SAMPLE_SOBOL, SAMPLE_LATIN, SAMPLE_KINDS } sample_kind;

/* what one entry of `vary` says */
typedef struct sample {
    sample_kind kind;
    double from, to;
    bool is_log;
    int64_t count, seed;
} sample;

/* while `vary` is read */
typedef struct design {
    pel_scene_reader *reader;
    pel_study *study;
    int32_t groups[SAMPLE_KINDS];     /* of all sampled axes of a kind; -1 = none yet */
    int32_t dimensions[SAMPLE_KINDS]; /* taken by now */
} design;

static pel_status fail_at(pel_scene_reader *reader, const pel_scene_value *value, const char *what, const char *remedy)
{
    pel_scene_fail(reader, &value->place, "%s", what);
    pel_fail_remedy(reader->error, "%s", remedy);
    return PEL_BAD_SCENE;
}

/* ---- values as YAML ---- */

/* as it was written, for --set */
static void put_as_written(pel_json *json, const pel_scene_value *scalar)
{
    if (scalar->quoted)
        pel_json_put_text(json, scalar->text);
    else
        pel_json_print(json, "%s", scalar->text);
}

static const char *value_text(pel_scene_reader *reader, const pel_scene_value *value)
{
    pel_json json = {0};
    pel_study_put_value(&json, value, put_as_written);
    const char *kept = json.failed ? NULL : pel_arena_text(reader->arena, json.text, json.length);
    pel_json_free(&json);
    if (kept == NULL)
        pel_fail_memory(reader->error);
    return kept;
}

static const char *number_text(pel_scene_reader *reader, double number)
{
    char text[PEL_NUMBER_SIZE];
    size_t length = pel_number_print(text, number);
    const char *kept = pel_arena_text(reader->arena, text, length);
    if (kept == NULL)
        pel_fail_memory(reader->error);
    return kept;
}

/* ---- samples ---- */

/* splitmix64 (Steele, Lea, Flood, 2014) */
static uint64_t next_random(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static double next_uniform(uint64_t *state)
{
    return (double)(next_random(state) >> 11) / 9007199254740992.0;
}

/* Latin hypercube (McKay, Beckman, Conover, Technometrics 21, 1979): one point in each of n strips of a dimension */
static void fill_latin(double *unit, int64_t count, int64_t seed, int32_t dimension)
{
    uint64_t state = (uint64_t)seed * 1000003U + (uint64_t)dimension;
    for (int64_t i = 0; i < count; i++)
        unit[i] = (double)i;
    /* Fisher and Yates */
    for (int64_t i = count - 1; i > 0; i--) {
        int64_t j = (int64_t)(next_random(&state) % (uint64_t)(i + 1));
        double held = unit[i];
        unit[i] = unit[j];
        unit[j] = held;
    }
    for (int64_t i = 0; i < count; i++)
        unit[i] = (unit[i] + next_uniform(&state)) / (double)count;
}

static void fill_unit(double *unit, const sample *s, int32_t dimension)
{
    if (s->kind == SAMPLE_LATIN) {
        fill_latin(unit, s->count, s->seed, dimension);
        return;
    }
    for (int64_t i = 0; i < s->count; i++)
        unit[i] = s->kind == SAMPLE_SOBOL ? pel_sobol(dimension, (uint32_t)i)
                                          : (s->count > 1 ? (double)i / (double)(s->count - 1) : 0);
}

/* both ends as they were written */
static double place_number(const sample *s, double unit)
{
    if (unit <= 0)
        return s->from;
    if (unit >= 1)
        return s->to;
    return s->is_log ? s->from * pel_pow(s->to / s->from, unit) : s->from + (s->to - s->from) * unit;
}

static const char *const *sample_values(pel_scene_reader *reader, const sample *s, int32_t dimension)
{
    double *unit = pel_arena_take(reader->arena, (size_t)s->count, sizeof *unit);
    const char **values = pel_arena_take(reader->arena, (size_t)s->count, sizeof *values);
    if (unit == NULL || values == NULL) {
        pel_fail_memory(reader->error);
        return NULL;
    }
    fill_unit(unit, s, dimension);
    for (int64_t i = 0; i < s->count; i++) {
        values[i] = number_text(reader, place_number(s, unit[i]));
        if (values[i] == NULL)
            return NULL;
    }
    return values;
}

/* ---- entries ---- */

static pel_status read_ends(pel_scene_reader *reader, const pel_scene_value *map, sample *s)
{
    const pel_scene_value *from = pel_scene_value_entry(map, "from"), *to = pel_scene_value_entry(map, "to");
    const pel_scene_value *scale = pel_scene_value_entry(map, "scale");
    int32_t word = 0;
    if (from == NULL || to == NULL)
        return fail_at(reader, map, "a range needs both ends", "write { from: 1, to: 5, count: 10 }");
    pel_status status = pel_study_need_number(reader, from, &s->from);
    if (status == PEL_OK)
        status = pel_study_need_number(reader, to, &s->to);
    if (status == PEL_OK && scale != NULL)
        status = pel_study_need_word(reader, scale, scale_words, 2, &word);
    s->is_log = word == 1;
    if (status == PEL_OK && s->is_log && !(s->from > 0 && s->to > 0))
        return fail_at(reader, map, "a log scale needs two ends above 0", "write from and to above 0");
    return status;
}

/* { from, to } with one of count, sobol and latin */
static pel_status read_range(pel_scene_reader *reader, const pel_scene_value *map, sample *s)
{
    static const char *const count_keys[SAMPLE_KINDS] = {NULL, "count", "sobol", "latin"};
    pel_status status =
        pel_study_check_keys(reader, map, "a range", range_keys, sizeof range_keys / sizeof *range_keys);
    if (status == PEL_OK)
        status = read_ends(reader, map, s);
    int given = 0;
    for (int k = SAMPLE_EVEN; k < SAMPLE_KINDS && status == PEL_OK; k++) {
        const pel_scene_value *count = pel_scene_value_entry(map, count_keys[k]);
        if (count == NULL)
            continue;
        given++;
        s->kind = (sample_kind)k;
        status = pel_study_need_integer(reader, count, 1, PEL_STUDY_MOST_RUNS, &s->count);
    }
    if (status == PEL_OK && given != 1)
        return fail_at(reader, map, "a range needs one of count, sobol and latin",
                       "write count: 10 for even steps, sobol: 64 or latin: 64 for samples");
    const pel_scene_value *seed = pel_scene_value_entry(map, "seed");
    if (status == PEL_OK && seed != NULL && s->kind != SAMPLE_LATIN)
        return fail_at(reader, seed, "seed is allowed only with latin", "remove it");
    if (status == PEL_OK && seed != NULL)
        status = pel_study_need_integer(reader, seed, 0, 4294967295.0, &s->seed);
    return status;
}

static pel_status read_list(pel_scene_reader *reader, const pel_scene_value *list, pel_study_axis *axis)
{
    axis->count = pel_scene_value_count(list);
    if (axis->count == 0)
        return fail_at(reader, list, "the list is empty", "write at least one value, such as [1, 2, 5]");
    const char **values = pel_arena_take(reader->arena, (size_t)axis->count, sizeof *values);
    if (values == NULL)
        return pel_fail_memory(reader->error);
    int64_t i = 0;
    for (const pel_scene_value *child = list->first; child != NULL; child = child->next, i++)
        if ((values[i] = value_text(reader, child)) == NULL)
            return reader->error->status;
    axis->values = values;
    return PEL_OK;
}

/* the group of an axis: `together`, else that of its kind of samples, else a new one */
static pel_status join_group(design *d, const pel_scene_value *entry, sample_kind kind, int32_t together,
                             pel_study_axis *axis)
{
    pel_study *study = d->study;
    bool is_sampled = kind == SAMPLE_SOBOL || kind == SAMPLE_LATIN;
    int32_t group = together >= 0 ? together : is_sampled ? d->groups[kind] : -1;
    if (group < 0) {
        group = study->group_count++;
        study->group_sizes[group] = 0;
        if (is_sampled)
            d->groups[kind] = group;
    }
    axis->group = group;
    if (study->group_sizes[group] == 0)
        study->group_sizes[group] = axis->count;
    if (study->group_sizes[group] == axis->count)
        return PEL_OK;
    pel_scene_fail(d->reader, &entry->place, "%lld values vary together with %lld values of other keys",
                   (long long)axis->count, (long long)study->group_sizes[group]);
    pel_fail_remedy(d->reader->error, "give the same number of values to each key");
    return PEL_BAD_SCENE;
}

static pel_status read_axis(design *d, const pel_scene_value *entry, int32_t together)
{
    pel_study *study = d->study;
    pel_scene_reader *reader = d->reader;
    pel_study_axis *axis = &study->axes[study->axis_count];
    sample s = {.kind = SAMPLE_LIST, .seed = 1};
    *axis = (pel_study_axis){.path = entry->key, .place = entry->key_place};
    pel_status status = PEL_OK;
    if (entry->kind == PEL_SCENE_SCALAR)
        return fail_at(reader, entry, "a key that varies needs several values",
                       "write a list such as [1, 2, 5], or { from: 1, to: 5, count: 10 }");
    if (entry->kind == PEL_SCENE_LIST) {
        status = read_list(reader, entry, axis);
    } else {
        status = read_range(reader, entry, &s);
        int32_t dimension = d->dimensions[s.kind]++;
        if (status == PEL_OK && s.kind == SAMPLE_SOBOL && dimension >= PEL_SOBOL_DIMENSIONS)
            return fail_at(reader, entry, "sobol has 21 dimensions at most", "use latin for the other keys");
        if (status == PEL_OK && (axis->values = sample_values(reader, &s, dimension)) == NULL)
            status = reader->error->status;
        axis->count = s.count;
    }
    if (status == PEL_OK)
        status = join_group(d, entry, s.kind, together, axis);
    study->axis_count++;
    return status;
}

static pel_status check_paths(pel_scene_reader *reader, const pel_study *study)
{
    for (int32_t a = 0; a < study->axis_count; a++)
        for (int32_t b = 0; b < a; b++)
            if (strcmp(study->axes[a].path, study->axes[b].path) == 0) {
                pel_scene_fail(reader, &study->axes[a].place, "the key '%.100s' varies twice", study->axes[a].path);
                pel_fail_remedy(reader->error, "keep one of them");
                return PEL_BAD_SCENE;
            }
    return PEL_OK;
}

static pel_status count_runs(pel_scene_reader *reader, const pel_scene_value *vary, pel_study *study)
{
    study->run_count = 1;
    for (int32_t g = 0; g < study->group_count; g++) {
        if (study->group_sizes[g] > PEL_STUDY_MOST_RUNS / study->run_count) {
            pel_scene_fail(reader, &vary->place, "the study has more than %d runs", PEL_STUDY_MOST_RUNS);
            pel_fail_remedy(reader->error, "sample with sobol: n or latin: n instead of combining all values");
            return PEL_BAD_SCENE;
        }
        study->run_count *= study->group_sizes[g];
    }
    return PEL_OK;
}

/* a list of maps: the entries of one map go together */
static pel_status read_maps(design *d, const pel_scene_value *list)
{
    pel_status status = PEL_OK;
    for (const pel_scene_value *map = list->first; map != NULL && status == PEL_OK; map = map->next) {
        status = pel_study_check_keys(d->reader, map, "vary", NULL, 0);
        if (status == PEL_OK && map->first == NULL)
            return fail_at(d->reader, map, "nothing varies here", "name a key of the scene with its values");
        int32_t group = d->study->group_count;
        d->study->group_sizes[d->study->group_count++] = 0;
        for (const pel_scene_value *entry = map->first; entry != NULL && status == PEL_OK; entry = entry->next)
            status = read_axis(d, entry, group);
    }
    return status;
}

pel_status pel_study_read_vary(pel_scene_reader *reader, const pel_scene_value *vary, pel_study *study)
{
    design d = {.reader = reader, .study = study};
    for (int k = 0; k < SAMPLE_KINDS; k++)
        d.groups[k] = -1;
    /* at most one axis for each entry, and one group for each axis */
    size_t most = 1;
    for (const pel_scene_value *child = vary->first; child != NULL; child = child->next)
        most += 1 + (size_t)pel_scene_value_count(child);
    study->axes = pel_arena_take(reader->arena, most, sizeof *study->axes);
    study->group_sizes = pel_arena_take(reader->arena, most, sizeof *study->group_sizes);
    if (study->axes == NULL || study->group_sizes == NULL)
        return pel_fail_memory(reader->error);
    pel_status status = PEL_OK;
    if (vary->kind == PEL_SCENE_LIST) {
        status = read_maps(&d, vary);
    } else {
        status = pel_study_check_keys(reader, vary, "vary", NULL, 0);
        for (const pel_scene_value *entry = vary->first; entry != NULL && status == PEL_OK; entry = entry->next)
            status = read_axis(&d, entry, -1);
    }
    if (status == PEL_OK && study->axis_count == 0)
        return fail_at(reader, vary, "nothing varies", "name a key of the scene with its values");
    if (status == PEL_OK)
        status = check_paths(reader, study);
    return status == PEL_OK ? count_runs(reader, vary, study) : status;
}
