#include "foreign/usd.h"

#include "base/memory.h"
#include "math/functions.h"

#include <string.h>

static const char *const again = "export the file again, or as OBJ, PLY or glTF";

#define OP "xformOp:"
#define INVERSE "!invert!"
#define RESET "!resetXformStack!"

void pel_usd_ops_free(pel_usd_ops *ops)
{
    for (size_t i = 0; i < ops->count; i++)
        pel_usd_samples_free(&ops->ops[i].samples);
    pel_free(ops->ops);
    *ops = (pel_usd_ops){0};
}

/* ---- one operation ---- */

/* exactly `width` numbers at that code; a quaternion w, x, y, z goes the shorter way */
static bool numbers_at(const pel_usd_samples *samples, double code, size_t width, bool is_quaternion, double *numbers)
{
    double share, sign = 1, dot = 0;
    size_t count;
    if (samples->count == 0)
        return false;
    const size_t i = pel_usd_sample_at(samples, code, &share);
    const double *here = pel_usd_sample(samples, i, &count);
    if (count != width)
        return false;
    const double *next = share > 0 ? here + width : here;
    for (size_t k = 0; k < width; k++)
        dot += here[k] * next[k];
    if (is_quaternion && dot < 0)
        sign = -1;
    for (size_t k = 0; k < width; k++)
        numbers[k] = (1 - share) * here[k] + share * sign * next[k];
    return true;
}

static pel_place turn(int axis, double degrees)
{
    const double angle = degrees * (3.14159265358979323846 / 180), c = pel_cos(angle), s = pel_sin(angle);
    const int i = (axis + 1) % 3, k = (axis + 2) % 3;
    pel_place place = pel_place_identity();
    place.linear[i][i] = place.linear[k][k] = c;
    place.linear[i][k] = -s;
    place.linear[k][i] = s;
    return place;
}

/* rotateXYZ turns about x first */
static bool place_by_angles(const char *axes, const double angles[3], pel_place *place)
{
    *place = pel_place_identity();
    for (int i = 0; i < 3; i++) {
        const int axis = axes[i] - 'X';
        if (axis < 0 || axis > 2)
            return false;
        const pel_place one = turn(axis, angles[axis]);
        *place = pel_place_product(&one, place);
    }
    return true;
}

/* The matrix multiplies rows from the right: x -> x M, with the translation in its last row. */
static void place_by_matrix(const double m[16], pel_place *place)
{
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            place->linear[i][k] = m[4 * k + i];
        place->shift[i] = m[12 + i];
    }
}

static bool place_by_op(const char *kind, size_t length, const pel_usd_samples *samples, double code, pel_place *place)
{
    double m[16];
    *place = pel_place_identity();
    if (pel_usd_is(kind, length, "translate"))
        return numbers_at(samples, code, 3, false, place->shift);
    if (pel_usd_is(kind, length, "scale") && numbers_at(samples, code, 3, false, m)) {
        for (int i = 0; i < 3; i++)
            place->linear[i][i] = m[i];
        return true;
    }
    if (pel_usd_is(kind, length, "orient"))
        return numbers_at(samples, code, 4, true, m) &&
               pel_place_by_parts((double[3]){0}, (double[4]){m[1], m[2], m[3], m[0]}, (double[3]){1, 1, 1}, place);
    if (pel_usd_is(kind, length, "transform") && numbers_at(samples, code, 16, false, m)) {
        place_by_matrix(m, place);
        return true;
    }
    if (length == 7 && memcmp(kind, "rotate", 6) == 0 && kind[6] >= 'X' && kind[6] <= 'Z' &&
        numbers_at(samples, code, 1, false, m)) {
        *place = turn(kind[6] - 'X', m[0]);
        return true;
    }
    return length == 9 && memcmp(kind, "rotate", 6) == 0 && numbers_at(samples, code, 3, false, m) &&
           place_by_angles(kind + 6, m, place);
}

/* ---- the order ---- */

static pel_status place_by_name(const pel_usd_ops *ops, const pel_text_cursor *scan, const char *name, size_t length,
                                double code, pel_place *place, pel_error *error)
{
    const size_t head = sizeof OP - 1, word = sizeof INVERSE - 1;
    const bool is_inverse = length > word && memcmp(name, INVERSE, word) == 0;
    const char *own = is_inverse ? name + word : name;
    const size_t own_length = is_inverse ? length - word : length;
    for (size_t i = 0; i < ops->count; i++) {
        const pel_usd_op *op = &ops->ops[i];
        if (op->length != own_length || memcmp(op->name, own, own_length) != 0)
            continue;
        const char *colon = memchr(own + head, ':', own_length - head);
        const size_t kind_length = colon != NULL ? (size_t)(colon - own) - head : own_length - head;
        pel_place made;
        if (!place_by_op(own + head, kind_length, &op->samples, code, &made))
            return pel_text_cursor_fail(scan, op->name, error,
                                        "export the prim with translate, rotate and scale, or "
                                        "with its points in place",
                                        "'%.*s' is no operation with the numbers that it needs", (int)own_length, own);
        *place = made;
        if (is_inverse && !pel_place_inverse(&made, place))
            return pel_text_cursor_fail(scan, name, error, again, "'%.*s' cannot be inverted", (int)own_length, own);
        return PEL_OK;
    }
    return pel_text_cursor_fail(scan, name, error, again, "the prim has no '%.*s'", (int)own_length, own);
}

pel_status pel_usd_ops_place(const pel_usd_ops *ops, const pel_text_cursor *scan, double code, pel_place *place,
                             bool *is_reset, pel_error *error)
{
    pel_text_cursor order = *scan;
    int count = 0;
    *place = pel_place_identity();
    *is_reset = false;
    order.at = ops->order;
    order.end = ops->order_end;
    while (order.at < order.end) {
        const char *name;
        size_t length;
        if (*order.at != '"' && *order.at != '\'') {
            order.at++;
            continue;
        }
        pel_place one;
        pel_status status = pel_usd_read_string(&order, &name, &length, error);
        if (status == PEL_OK && pel_usd_is(name, length, RESET)) {
            *is_reset = true;
            continue;
        }
        if (status == PEL_OK && count++ == PEL_USD_OPS)
            status = pel_text_cursor_fail(scan, name, error, again, "a prim has more than %d operations in its order",
                                          (int)PEL_USD_OPS);
        if (status == PEL_OK)
            status = place_by_name(ops, scan, name, length, code, &one, error);
        if (status != PEL_OK)
            return status;
        *place = pel_place_product(place, &one);
    }
    return PEL_OK;
}
