#include "keys/print.h"

#include "base/memory.h"
#include "keys/table.h"

#include <string.h>

/* growing text; unchanged after memory ran out */
typedef struct printer {
    char *text;
    size_t length, capacity;
    bool failed;
    const pel_scene_names *names; /* of mesh files, null = their own */
} printer;

static void put(printer *out, const char *text)
{
    size_t length = strlen(text);
    if (out->failed || !pel_reserve((void **)&out->text, &out->capacity, out->length + length + 1, 1)) {
        out->failed = true;
        return;
    }
    memcpy(out->text + out->length, text, length + 1);
    out->length += length;
}

static void put_indent(printer *out, int depth)
{
    while (depth-- > 0)
        put(out, "  ");
}

/* text that YAML takes for text without quotes: letters first and no word with a meaning */
static bool is_plain_text(const char *text)
{
    static const char *const meanings[] = {"true", "false", "null", "yes", "no", "on", "off", "y", "n"};
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz/";
    if (text[0] == '\0' || strchr(letters, text[0]) == NULL)
        return false;
    if (text[strspn(text, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_./-")] != '\0')
        return false;
    for (size_t i = 0; i < sizeof meanings / sizeof meanings[0]; i++)
        if (strlen(text) == strlen(meanings[i]))
            for (size_t j = 0; (text[j] | 0x20) == meanings[i][j]; j++)
                if (meanings[i][j + 1] == '\0')
                    return false;
    return true;
}

/* text in double quotes; bytes of UTF-8 stay, control characters become \xNN */
static void put_quoted(printer *out, const char *text)
{
    static const char digits[] = "0123456789ABCDEF";
    put(out, "\"");
    for (; *text != '\0'; text++) {
        unsigned char byte = (unsigned char)*text;
        char one[5] = {*text, '\0'};
        if (byte == '"' || byte == '\\')
            put(out, "\\");
        if (byte < 0x20 || byte == 0x7f) {
            one[0] = '\\';
            one[1] = 'x';
            one[2] = digits[byte >> 4];
            one[3] = digits[byte & 15];
        }
        put(out, one);
    }
    put(out, "\"");
}

/* the text of a scalar: of the file of a mesh its new name */
static const char *text_of(const printer *out, const pel_scene_value *value)
{
    bool is_file = value->key != NULL && strcmp(value->key, "file") == 0;
    for (int32_t i = 0; is_file && out->names != NULL && i < out->names->count; i++)
        if (strcmp(value->text, out->names->from[i]) == 0)
            return out->names->to[i];
    return value->text;
}

static void put_scalar(printer *out, const pel_scene_value *value)
{
    const char *text = text_of(out, value);
    if (value->form == PEL_FORM_TEXT && !is_plain_text(text))
        put_quoted(out, text);
    else
        put(out, text);
}

/* a list without maps, in one line */
static void put_flow(printer *out, const pel_scene_value *value)
{
    if (value->kind == PEL_SCENE_SCALAR) {
        put_scalar(out, value);
        return;
    }
    put(out, "[");
    for (const pel_scene_value *child = value->first; child != NULL; child = child->next) {
        put_flow(out, child);
        put(out, child->next != NULL ? ", " : "");
    }
    put(out, "]");
}

static bool is_flow(const pel_scene_value *value)
{
    return value->kind == PEL_SCENE_SCALAR ||
           (value->kind == PEL_SCENE_LIST && (value->first == NULL || value->first->kind != PEL_SCENE_MAP));
}

static void put_block(printer *out, const pel_scene_value *value, int depth);

/* "key: value", the first line without indentation */
static void put_entry(printer *out, const pel_scene_value *entry, int depth)
{
    put(out, entry->key);
    put(out, ":");
    if (is_flow(entry)) {
        put(out, " ");
        put_flow(out, entry);
        put(out, "\n");
    } else if (entry->first == NULL) {
        put(out, " {}\n");
    } else {
        put(out, "\n");
        put_block(out, entry, depth + 1);
    }
}

/* a map, or a list of maps */
static void put_block(printer *out, const pel_scene_value *value, int depth)
{
    for (const pel_scene_value *child = value->first; child != NULL; child = child->next) {
        put_indent(out, depth);
        if (value->kind == PEL_SCENE_MAP) {
            put_entry(out, child, depth);
            continue;
        }
        put(out, "- ");
        for (const pel_scene_value *entry = child->first; entry != NULL; entry = entry->next) {
            if (entry != child->first)
                put_indent(out, depth + 1);
            put_entry(out, entry, depth + 1);
        }
    }
}

char *pel_scene_print_renamed(const pel_scene_value *root, const pel_scene_names *names)
{
    printer out = {.names = names};
    put(&out, "# a scene of pellicle " PEL_VERSION " with all defaults filled in\n");
    put_block(&out, root, 0);
    if (!out.failed)
        return out.text;
    pel_free(out.text);
    return NULL;
}

const char *pel_scene_print(pel_scene_reader *reader, const pel_scene_value *root)
{
    char *printed = pel_scene_print_renamed(root, NULL);
    const char *text = printed != NULL ? pel_arena_text(reader->arena, printed, strlen(printed)) : NULL;
    pel_free(printed);
    if (text == NULL)
        pel_fail_memory(reader->error);
    return text;
}
