#include "def/row.h"

#include "math/extremes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- rows ---- */

const pel_def_row *pel_def_row_of(pel_def_kind kind, size_t offset)
{
    const pel_def_row *row;
    for (int32_t i = 0; (row = pel_def_row_at(i)) != NULL; i++)
        if (row->def == kind && row->offset == offset)
            return row;
    return NULL;
}

int32_t pel_def_members(pel_def_kind kind, const pel_def_row *members[PEL_MOST_MEMBERS])
{
    int32_t count = 0;
    const pel_def_row *row;
    for (int32_t i = 0; count < PEL_MOST_MEMBERS && (row = pel_def_row_at(i)) != NULL; i++) {
        int32_t at = count;
        while (row->def == kind && at > 0 && members[at - 1]->offset > row->offset)
            at--;
        if (row->def != kind || (at > 0 && members[at - 1]->offset == row->offset))
            continue;
        memmove(members + at + 1, members + at, (size_t)(count - at) * sizeof *members);
        members[at] = row;
        count++;
    }
    return count;
}

/* a number, switch, word or vector that a simulation can be asked for */
static bool is_parameter(const pel_def_row *row)
{
    const unsigned scalars = PEL_FORM_NUMBER | PEL_FORM_INTEGER | PEL_FORM_BOOLEAN | PEL_FORM_WORD | PEL_FORM_VECTOR;
    return row->path != NULL && !row->is_fixed &&
           (row->store == PEL_STORE_KEYS || (row->store < PEL_STORE_KEYS && (row->forms & scalars) != 0));
}

int32_t pel_def_parameter_after(int32_t index)
{
    int kind = index >= 0 ? (int)pel_def_row_at(index)->def : PEL_DEF_BODY;
    const pel_def_row *row;
    for (; kind < PEL_DEF_COUNT; kind++, index = -1)
        while ((row = pel_def_row_at(++index)) != NULL)
            if ((int)row->def == kind && is_parameter(row))
                return index;
    return -1;
}

pel_parameter_kind pel_def_row_kind(const pel_def_row *row)
{
    if ((row->forms & PEL_FORM_VECTOR) != 0)
        return PEL_PARAMETER_VECTOR;
    if (row->forms == PEL_FORM_WORD || row->forms == (PEL_FORM_WORD | PEL_FORM_BOOLEAN))
        return PEL_PARAMETER_WORD;
    if (row->forms == PEL_FORM_BOOLEAN)
        return PEL_PARAMETER_SWITCH;
    return (row->forms & PEL_FORM_INTEGER) != 0 ? PEL_PARAMETER_INTEGER : PEL_PARAMETER_NUMBER;
}

const char *const *pel_def_row_words(const pel_def_row *row)
{
    static const char *const switches[] = {"false", "true", NULL};
    if (pel_def_row_kind(row) != PEL_PARAMETER_WORD)
        return NULL;
    if ((row->forms & PEL_FORM_BOOLEAN) != 0)
        return switches;
    return row->values != NULL ? row->values : row->words;
}

bool pel_def_row_may_be_keyed(const pel_def_row *row)
{
    return row->store == PEL_STORE_KEYS || (row->store == PEL_STORE_QUANTITY && strcmp(row->like, "<field>") != 0);
}

/* ---- values ---- */

double pel_def_row_factor(const pel_def_row *row)
{
    return row->factor != 0 ? row->factor : 1;
}

/* the number of a member of any type */
static void write_number(const pel_def_row *row, char *at, double raw)
{
    if (row->store == PEL_STORE_DOUBLE) {
        memcpy(at, &raw, sizeof raw);
    } else if (row->store == PEL_STORE_INT) {
        int32_t number = (int32_t)raw;
        memcpy(at, &number, sizeof number);
    } else if (row->store == PEL_STORE_INT64) {
        /* 0 has a meaning of its own */
        int64_t number = (int64_t)pel_min(pel_max(1, raw), 0x1p62);
        memcpy(at, &number, sizeof number);
    } else if (row->store == PEL_STORE_BOOL) {
        *(bool *)at = raw != 0;
    } else if (row->store == PEL_STORE_QUANTITY) {
        *(pel_quantity *)(void *)at = (pel_quantity){.value = raw};
    }
}

void pel_def_reset(pel_def_kind kind, void *def)
{
    const pel_def_row *row;
    for (int32_t i = 0; (row = pel_def_row_at(i)) != NULL; i++) {
        double value = row->initial != 0 ? row->initial : row->automatic;
        if (row->def == kind && value != 0)
            write_number(row, (char *)def + row->offset, value);
    }
}

void pel_member_set(const pel_def_row *row, void *def, const double *values)
{
    size_t count = row->store == PEL_STORE_DOUBLE ? row->size / sizeof *values : 1;
    for (size_t i = 0; i < count; i++)
        write_number(row, (char *)def + row->offset + i * sizeof *values,
                     isnan(values[i]) ? row->automatic : values[i] / pel_def_row_factor(row));
}

void pel_member_set_keys(const pel_def_row *row, void *def, const pel_key *keys, int32_t count)
{
    char *at = (char *)def + row->offset;
    if (row->store == PEL_STORE_QUANTITY) {
        const double none = 0;
        pel_member_set(row, def, &none); /* fingerprints tell 0 from -0 */
        ((pel_quantity *)(void *)at)->keys = keys;
        ((pel_quantity *)(void *)at)->key_count = count;
        return;
    }
    memcpy(at, &keys, sizeof keys);
    memcpy((char *)def + row->count_offset, &count, sizeof count);
}

const pel_key *pel_member_keys(const pel_def_row *row, const void *def, int32_t *count)
{
    const char *at = (const char *)def + row->offset;
    const pel_key *keys = NULL;
    *count = 0;
    if (row->store == PEL_STORE_QUANTITY) {
        const pel_quantity *quantity = (const void *)at;
        *count = quantity->key_count;
        return quantity->keys;
    }
    if (row->store == PEL_STORE_KEYS) {
        memcpy(count, (const char *)def + row->count_offset, sizeof *count);
        memcpy(&keys, at, sizeof keys);
    }
    return keys;
}

/* ---- ranges ---- */

const char *pel_range_text(pel_range range, char *text, size_t size)
{
    if (!range.given)
        text[0] = '\0';
    else if (range.least == range.most)
        snprintf(text, size, "%g", range.least);
    else if (range.most < INT32_MAX)
        snprintf(text, size, "%s%g to %g", range.open ? "above " : "", range.least, range.most);
    else
        snprintf(text, size, "%s %g", range.open ? ">" : ">=", range.least);
    return text;
}

bool pel_range_has(pel_range range, double number)
{
    if (!range.given)
        return true;
    return (range.open ? number > range.least : number >= range.least) && number <= range.most;
}
