#include "model/quantity.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"

#include <math.h>
#include <string.h>

/* of a span: shorter times are rounding */
#define SAME_TIME 1e-9

double pel_curve_value(const pel_key *keys, int32_t key_count, double time)
{
    if (keys == NULL || key_count == 0)
        return 1;
    if (time <= keys[0].time)
        return keys[0].value;
    for (int32_t k = 1; k < key_count; k++)
        if (time < keys[k].time) {
            double s = (time - keys[k - 1].time) / (keys[k].time - keys[k - 1].time);
            return keys[k - 1].value + s * (keys[k].value - keys[k - 1].value);
        }
    return keys[key_count - 1].value;
}

/* integral of a curve from one time to a later one: trapezoids between the keys */
static double integrate(const pel_key *keys, int32_t key_count, double from, double to)
{
    double sum = 0, at = from, value = pel_curve_value(keys, key_count, from);
    for (int32_t k = 0; k < key_count && keys[k].time < to; k++) {
        if (!(keys[k].time > at))
            continue;
        sum += 0.5 * (keys[k].time - at) * (value + keys[k].value);
        at = keys[k].time;
        value = keys[k].value;
    }
    return sum + 0.5 * (to - at) * (value + pel_curve_value(keys, key_count, to));
}

/* The same over its length; ends that differ by rounding are the same time. */
static double mean_between(const pel_key *keys, int32_t key_count, const double span[2], const double acts[2])
{
    double length = span[1] - span[0], shortest = SAME_TIME * length;
    if (!(length > 0))
        return span[0] >= acts[0] && span[0] < acts[1] ? pel_curve_value(keys, key_count, span[0]) : 0;
    double from = acts[0] > span[0] + shortest ? acts[0] : span[0];
    double to = acts[1] < span[1] - shortest ? acts[1] : span[1];
    if (!(to - from > shortest))
        return 0;
    if (key_count == 0 && from == span[0] && to == span[1])
        return 1;
    return integrate(keys, key_count, from, to) / length;
}

double pel_curve_mean(const pel_key *keys, int32_t key_count, pel_span span, double from, double until)
{
    const double acts[2] = {from, until}, whole[2] = {span.time - span.back, span.time + span.ahead};
    double mean = mean_between(keys, key_count, whole, acts);
    if (!span.extrapolates)
        return mean;
    const double before[2] = {2 * whole[0] - whole[1], whole[0]};
    return mean + 0.5 * (mean - mean_between(keys, key_count, before, acts));
}

double pel_curve_largest(const pel_curve *curve)
{
    double largest = curve->key_count > 0 ? 0 : 1;
    for (int32_t k = 0; k < curve->key_count; k++)
        largest = pel_max(largest, curve->keys[k].value);
    return largest;
}

bool pel_keys_are_ordered(const pel_key *keys, int32_t count)
{
    for (int32_t k = 0; k < count; k++)
        if (!isfinite(keys[k].time) || !isfinite(keys[k].value) || (k > 0 && !(keys[k].time > keys[k - 1].time)))
            return false;
    return true;
}

pel_status pel_body_refuse(pel_error *error, int32_t body, const char *name, double value, const char *remedy)
{
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, remedy, "%s is %g", name, value);
}

static bool is_allowed(double value, bool is_signed)
{
    return isfinite(value) && (is_signed || value >= 0);
}

static pel_status check(const pel_quantity *quantity, int32_t vertex_count, int32_t body, const char *name,
                        bool keys_allowed, bool is_signed, pel_error *error)
{
    const char *rule = is_signed ? "give finite numbers" : "give finite numbers of at least 0";
    if (quantity->field != NULL && quantity->key_count > 0)
        return pel_body_refuse(error, body, name, quantity->value, "give either a field or keys, not both");
    if (quantity->key_count > 0 && !keys_allowed)
        return pel_body_refuse(error, body, name, quantity->value, "this number cannot vary over time");
    if (quantity->field == NULL && quantity->key_count == 0 && !is_allowed(quantity->value, is_signed))
        return pel_body_refuse(error, body, name, quantity->value, rule);
    if (quantity->key_count < 0 || (quantity->key_count > 0 && quantity->keys == NULL)) {
        pel_fail(error, PEL_BAD_ARGUMENT, "%s has %d keys, but `keys` is null or the count below 0", name,
                 (int)quantity->key_count);
        pel_fail_element(error, "body", body);
        return PEL_BAD_ARGUMENT;
    }
    for (int32_t v = 0; quantity->field != NULL && v < vertex_count; v++)
        if (!is_allowed(quantity->field[v], is_signed))
            return pel_body_refuse(error, body, name, quantity->field[v], rule);
    for (int32_t k = 0; k < quantity->key_count; k++) {
        const pel_key *key = &quantity->keys[k];
        if (!(is_allowed(key->value, is_signed) && isfinite(key->time)))
            return pel_body_refuse(error, body, name, key->value, rule);
        if (k > 0 && !(key->time > key[-1].time))
            return pel_body_refuse(error, body, name, key->time, "give keys with increasing times");
    }
    return PEL_OK;
}

pel_status pel_quantity_check(const pel_quantity *quantity, int32_t vertex_count, int32_t body, const char *name,
                              bool keys_allowed, pel_error *error)
{
    return check(quantity, vertex_count, body, name, keys_allowed, false, error);
}

pel_status pel_quantity_check_signed(const pel_quantity *quantity, int32_t vertex_count, int32_t body, const char *name,
                                     bool keys_allowed, pel_error *error)
{
    return check(quantity, vertex_count, body, name, keys_allowed, true, error);
}

static bool is_given(const pel_quantity *quantity)
{
    return quantity->field != NULL || quantity->value > 0;
}

/* a quantity that is 0, or above 0 at all vertices */
static pel_status check_positive(const pel_quantity *quantity, const pel_body_def *def, int32_t body, const char *name,
                                 pel_error *error)
{
    int32_t count = def->mesh->vertex_count;
    pel_status status = pel_quantity_check(quantity, count, body, name, false, error);
    for (int32_t v = 0; status == PEL_OK && quantity->field != NULL && v < count; v++)
        if (!(quantity->field[v] > 0))
            status = pel_body_refuse(error, body, name, quantity->field[v],
                                     "give values above 0 at all vertices, small ones where it tears easily");
    return status;
}

pel_status pel_toughness_check(const pel_quantity *toughness, const pel_body_def *def, int32_t body, pel_error *error)
{
    pel_status status = check_positive(toughness, def, body, "toughness", error);
    if (status == PEL_OK && is_given(toughness) && def->refine.levels > 0)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body,
                                  "subdivide the mesh before (`pellicle subdivide`), and leave out `refine`",
                                  "a body that refines cannot tear");
    return status;
}

pel_status pel_strength_check(const pel_quantity *strength, const pel_quantity *toughness, const pel_body_def *def,
                              int32_t body, pel_error *error)
{
    pel_status status = check_positive(strength, def, body, "strength", error);
    if (status == PEL_OK && is_given(strength) && !is_given(toughness))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body,
                                  "give a `toughness` too: the energy per area that the tear takes",
                                  "a body with a strength has no toughness");
    return status;
}

double pel_quantity_at(const pel_quantity *quantity, int32_t v)
{
    if (quantity->key_count > 0)
        return 1;
    return quantity->field != NULL ? quantity->field[v] : quantity->value;
}

pel_status pel_curve_copy(const pel_quantity *quantity, pel_curve *curve, pel_error *error)
{
    if (quantity->key_count == 0)
        return PEL_OK;
    size_t count = (size_t)quantity->key_count;
    curve->keys = pel_allocate(count, sizeof *curve->keys);
    if (curve->keys == NULL)
        return pel_fail_memory(error);
    memcpy(curve->keys, quantity->keys, count * sizeof *curve->keys);
    curve->key_count = quantity->key_count;
    return PEL_OK;
}

double pel_quantity_mean(const pel_quantity *quantity, int32_t vertex_count)
{
    double sum = 0;
    for (int32_t v = 0; quantity->field != NULL && v < vertex_count; v++)
        sum += quantity->field[v] / vertex_count;
    return quantity->field != NULL ? sum : quantity->value;
}
