#include "foreign/usd.h"

#include "base/memory.h"
#include "base/number.h"

#include <string.h>

static const char *const again = "export the file again, or as OBJ, PLY or glTF";

/* ---- words ---- */

void pel_usd_pass_space(pel_text_cursor *scan)
{
    for (;;) {
        pel_text_cursor_skip_comments(scan);
        if (scan->at == scan->end || *scan->at != ';')
            return;
        scan->at++;
    }
}

static bool is_word_byte(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || pel_is_digit(c) || (unsigned char)c >= 0x80 ||
           (c != '\0' && strchr("_:.-![]", c) != NULL);
}

const char *pel_usd_word(pel_text_cursor *scan, size_t *length)
{
    const char *word = scan->at;
    while (scan->at < scan->end && is_word_byte(*scan->at))
        scan->at++;
    *length = (size_t)(scan->at - word);
    return word;
}

bool pel_usd_is(const char *word, size_t length, const char *other)
{
    return strlen(other) == length && memcmp(word, other, length) == 0;
}

/* ---- what is passed over ---- */

static pel_status fail_open(const pel_text_cursor *scan, const char *at, const char *what, pel_error *error)
{
    return pel_text_cursor_fail(scan, at, error, again, "%s is not closed: the file is cut off or damaged", what);
}

/* how many times the byte here repeats: 3 opens a text of several lines */
static size_t count_marks(const pel_text_cursor *scan, char mark)
{
    size_t count = 0;
    while (count < 3 && scan->at + count < scan->end && scan->at[count] == mark)
        count++;
    return count;
}

pel_status pel_usd_read_string(pel_text_cursor *scan, const char **text, size_t *length, pel_error *error)
{
    const char *begin = scan->at, mark = *begin;
    const size_t marks = count_marks(scan, mark) == 3 ? 3 : 1;
    scan->at += marks;
    *text = scan->at;
    while (scan->at < scan->end && count_marks(scan, mark) < marks) {
        if (marks == 1 && pel_is_line_end(*scan->at))
            break;
        scan->at += *scan->at == '\\' && mark != '@' && scan->end - scan->at > 1 ? 2 : 1;
    }
    if (scan->at == scan->end || count_marks(scan, mark) < marks)
        return fail_open(scan, begin, "a text in quotes", error);
    *length = (size_t)(scan->at - *text);
    scan->at += marks;
    return PEL_OK;
}

/* </a/path> */
static pel_status pass_path(pel_text_cursor *scan, pel_error *error)
{
    const char *begin = scan->at;
    while (scan->at < scan->end && *scan->at != '>' && !pel_is_line_end(*scan->at))
        scan->at++;
    if (scan->at == scan->end || *scan->at != '>')
        return fail_open(scan, begin, "a path", error);
    scan->at++;
    return PEL_OK;
}

pel_status pel_usd_pass_group(pel_text_cursor *scan, pel_error *error)
{
    const char *begin = scan->at, *text;
    size_t depth = 0, length;
    pel_status status = PEL_OK;
    do {
        pel_text_cursor_skip_comments(scan);
        if (scan->at == scan->end)
            return fail_open(scan, begin, "a bracket", error);
        const char c = *scan->at;
        depth += c == '(' || c == '[' || c == '{';
        depth -= c == ')' || c == ']' || c == '}';
        if (c == '"' || c == '\'' || c == '@')
            status = pel_usd_read_string(scan, &text, &length, error);
        else if (c == '<')
            status = pass_path(scan, error);
        else
            scan->at++;
    } while (status == PEL_OK && depth > 0);
    return status;
}

/* a file @a.usda@ with a prim </Ball> of it and its shift in time (offset = 1) */
static pel_status pass_asset(pel_text_cursor *scan, pel_error *error)
{
    const char *text;
    size_t length;
    pel_status status = pel_usd_read_string(scan, &text, &length, error);
    if (status == PEL_OK && scan->at < scan->end && *scan->at == '<')
        status = pass_path(scan, error);
    pel_text_cursor_skip_blanks(scan);
    if (status == PEL_OK && scan->at < scan->end && *scan->at == '(')
        status = pel_usd_pass_group(scan, error);
    return status;
}

pel_status pel_usd_pass_value(pel_text_cursor *scan, pel_error *error)
{
    const char *text;
    size_t length;
    pel_text_cursor_skip_comments(scan);
    const char c = scan->at < scan->end ? *scan->at : '\0';
    if (c == '(' || c == '[' || c == '{')
        return pel_usd_pass_group(scan, error);
    if (c == '"' || c == '\'')
        return pel_usd_read_string(scan, &text, &length, error);
    if (c == '@')
        return pass_asset(scan, error);
    if (c == '<')
        return pass_path(scan, error);
    /* a word or a number, such as 1e+20 */
    const char *begin = scan->at;
    do
        pel_usd_word(scan, &length);
    while (scan->at < scan->end && *scan->at == '+' && scan->at++ != NULL);
    if (scan->at > begin)
        return PEL_OK;
    return pel_text_cursor_fail(scan, scan->at, error, again, "a value is missing");
}

/* ---- numbers ---- */

void pel_usd_samples_free(pel_usd_samples *samples)
{
    pel_free(samples->codes);
    pel_free(samples->ends);
    pel_free(samples->values);
    *samples = (pel_usd_samples){0};
}

const double *pel_usd_sample(const pel_usd_samples *samples, size_t i, size_t *count)
{
    const size_t begin = i > 0 ? samples->ends[i - 1] : 0;
    *count = samples->ends[i] - begin;
    /* samples that are all empty have no block */
    return *count > 0 ? samples->values + begin : NULL;
}

size_t pel_usd_sample_at(const pel_usd_samples *samples, double code, double *share)
{
    size_t low = 0, high = samples->count;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (samples->codes[middle] <= code)
            low = middle;
        else
            high = middle;
    }
    *share = 0;
    if (low + 1 < samples->count && code > samples->codes[low]) {
        size_t here, next;
        pel_usd_sample(samples, low, &here);
        pel_usd_sample(samples, low + 1, &next);
        if (here == next)
            *share = (code - samples->codes[low]) / (samples->codes[low + 1] - samples->codes[low]);
    }
    return low;
}

static pel_status add_number(pel_text_cursor *scan, pel_usd_samples *samples, pel_error *error)
{
    double value;
    const char *after = pel_number_parse(scan->at, scan->end, &value);
    if (after == NULL)
        return pel_text_cursor_fail_number(scan, error, "a number");
    if (!pel_reserve((void **)&samples->values, &samples->value_capacity, samples->value_count + 1,
                     sizeof *samples->values))
        return pel_fail_memory(error);
    samples->values[samples->value_count++] = value;
    scan->at = after;
    return PEL_OK;
}

/* the numbers of one value: 1, (1, 2), [(1, 2), (3, 4)] or None */
static pel_status add_numbers(pel_text_cursor *scan, pel_usd_samples *samples, pel_error *error)
{
    const char *begin = scan->at;
    size_t depth = 0, length;
    pel_status status = PEL_OK;
    do {
        pel_text_cursor_skip_comments(scan);
        if (scan->at == scan->end)
            return fail_open(scan, begin, "a bracket", error);
        const char c = *scan->at;
        if (depth == 0 && c == 'N') {
            const char *word = pel_usd_word(scan, &length);
            if (pel_usd_is(word, length, "None"))
                return PEL_OK;
            scan->at = word;
        }
        const bool is_opened = c == '(' || c == '[', is_closed = depth > 0 && (c == ')' || c == ']');
        depth += is_opened;
        depth -= is_closed;
        if (is_opened || is_closed || (depth > 0 && c == ','))
            scan->at++;
        else
            status = add_number(scan, samples, error);
    } while (status == PEL_OK && depth > 0);
    return status;
}

static pel_status add_sample(pel_text_cursor *scan, double code, pel_usd_samples *samples, pel_error *error)
{
    if (!pel_reserve((void **)&samples->codes, &samples->code_capacity, samples->count + 1, sizeof *samples->codes) ||
        !pel_reserve((void **)&samples->ends, &samples->end_capacity, samples->count + 1, sizeof *samples->ends))
        return pel_fail_memory(error);
    pel_status status = add_numbers(scan, samples, error);
    samples->codes[samples->count] = code;
    samples->ends[samples->count++] = samples->value_count;
    return status;
}

pel_status pel_usd_read_value(pel_text_cursor *scan, pel_usd_samples *samples, pel_error *error)
{
    /* samples over time are stronger than a value without a time */
    if (samples->is_timed)
        return pel_usd_pass_value(scan, error);
    samples->count = samples->value_count = 0;
    return add_sample(scan, 0, samples, error);
}

pel_status pel_usd_read_samples(pel_text_cursor *scan, pel_usd_samples *samples, pel_error *error)
{
    pel_text_cursor_skip_comments(scan);
    const char *begin = scan->at;
    if (scan->at == scan->end || *scan->at != '{')
        return pel_text_cursor_fail(scan, scan->at, error, again, "samples over time begin with '{'");
    scan->at++;
    samples->count = samples->value_count = 0;
    samples->is_timed = true;
    for (;;) {
        double code;
        do
            pel_text_cursor_skip_comments(scan);
        while (scan->at < scan->end && *scan->at == ',' && scan->at++ != NULL);
        if (scan->at == scan->end)
            return fail_open(scan, begin, "a bracket", error);
        if (*scan->at == '}')
            break;
        const char *at = scan->at, *after = pel_number_parse(at, scan->end, &code);
        if (after == NULL || (samples->count > 0 && !(code > samples->codes[samples->count - 1])))
            return pel_text_cursor_fail(scan, at, error, again, "time codes of samples must be numbers that rise");
        scan->at = after;
        pel_text_cursor_skip_comments(scan);
        if (scan->at == scan->end || *scan->at != ':')
            return pel_text_cursor_fail(scan, scan->at, error, again, "':' is missing after a time code");
        scan->at++;
        pel_status status = add_sample(scan, code, samples, error);
        if (status != PEL_OK)
            return status;
    }
    scan->at++;
    return PEL_OK;
}
