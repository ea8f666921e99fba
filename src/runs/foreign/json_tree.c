#include "foreign/json_tree.h"

#include "base/memory.h"
#include "base/number.h"

#include <string.h>

enum { MOST_DEPTH = 64 };

static pel_status read_value(pel_json_tree *tree, int depth, int32_t *made, pel_error *error);

static pel_status fail_json(const pel_json_tree *tree, const char *what, pel_error *error)
{
    return pel_text_cursor_fail(&tree->scan, tree->scan.at, error, "copy or export the file again",
                                "the JSON is damaged: %s", what);
}

/* JSON knows four blanks only, but more do no harm */
static bool accept(pel_json_tree *tree, char letter)
{
    pel_text_cursor_skip_spaces(&tree->scan);
    if (tree->scan.at == tree->scan.end || *tree->scan.at != letter)
        return false;
    tree->scan.at++;
    return true;
}

/* a text from its first quote to behind its last one */
static bool read_text(pel_json_tree *tree, const char **text, size_t *length)
{
    pel_text_cursor *scan = &tree->scan;
    if (!accept(tree, '"'))
        return false;
    *text = scan->at;
    while (scan->at < scan->end && *scan->at != '"')
        scan->at += *scan->at == '\\' && scan->end - scan->at > 1 ? 2 : 1;
    *length = (size_t)(scan->at - *text);
    if (scan->at >= scan->end)
        return false;
    scan->at++;
    return true;
}

static pel_status add_node(pel_json_tree *tree, int32_t *made, pel_error *error)
{
    void *nodes = tree->nodes;
    if (tree->count >= INT32_MAX || !pel_reserve(&nodes, &tree->capacity, tree->count + 1, sizeof *tree->nodes))
        return pel_fail_memory(error);
    tree->nodes = nodes;
    *made = (int32_t)tree->count;
    tree->nodes[tree->count++] = (pel_json_node){.first = -1, .next = -1, .text = tree->scan.at};
    return PEL_OK;
}

static pel_status read_member(pel_json_tree *tree, int depth, int32_t *child, pel_error *error)
{
    const char *key;
    size_t length;
    if (!read_text(tree, &key, &length))
        return fail_json(tree, "a name in quotes is missing", error);
    if (!accept(tree, ':'))
        return fail_json(tree, "a colon is missing", error);
    pel_status status = read_value(tree, depth, child, error);
    if (status == PEL_OK) {
        tree->nodes[*child].key = key;
        tree->nodes[*child].key_length = length;
    }
    return status;
}

/* what stands between two brackets, the first of which is behind us */
static pel_status read_children(pel_json_tree *tree, int32_t parent, char close, int depth, pel_error *error)
{
    int32_t last = -1;
    if (depth >= MOST_DEPTH)
        return fail_json(tree, "brackets are nested deeper than 64", error);
    if (accept(tree, close))
        return PEL_OK;
    do {
        int32_t child = -1;
        pel_status status =
            close == '}' ? read_member(tree, depth + 1, &child, error) : read_value(tree, depth + 1, &child, error);
        if (status != PEL_OK)
            return status;
        if (last < 0)
            tree->nodes[parent].first = child;
        else
            tree->nodes[last].next = child;
        last = child;
        tree->nodes[parent].count++;
    } while (accept(tree, ','));
    return accept(tree, close) ? PEL_OK : fail_json(tree, "a comma or a bracket is missing", error);
}

static bool accept_word(pel_json_tree *tree, const char *word)
{
    const size_t length = strlen(word);
    if ((size_t)(tree->scan.end - tree->scan.at) < length || memcmp(tree->scan.at, word, length) != 0)
        return false;
    tree->scan.at += length;
    return true;
}

/* numbers, true, false and null */
static bool read_word(pel_json_tree *tree, pel_json_node *node)
{
    const char *behind = pel_number_parse(tree->scan.at, tree->scan.end, &node->number);
    const bool is_number = behind != NULL && (pel_is_digit(*tree->scan.at) || *tree->scan.at == '-');
    if (is_number) {
        node->kind = PEL_JSON_IS_NUMBER;
        tree->scan.at = behind;
        return true;
    }
    node->number = 0;
    if (accept_word(tree, "null"))
        return true;
    node->kind = PEL_JSON_IS_BOOL;
    if (accept_word(tree, "false"))
        return true;
    node->number = 1;
    return accept_word(tree, "true");
}

static pel_status read_value(pel_json_tree *tree, int depth, int32_t *made, pel_error *error)
{
    pel_text_cursor_skip_spaces(&tree->scan);
    pel_status status = add_node(tree, made, error);
    if (status != PEL_OK)
        return status;
    pel_json_node *node = &tree->nodes[*made];
    if (accept(tree, '{') || accept(tree, '[')) {
        const char open = tree->scan.at[-1];
        node->kind = open == '{' ? PEL_JSON_IS_OBJECT : PEL_JSON_IS_ARRAY;
        status = read_children(tree, *made, open == '{' ? '}' : ']', depth, error);
    } else if (tree->scan.at < tree->scan.end && *tree->scan.at == '"') {
        node->kind = PEL_JSON_IS_TEXT;
        return read_text(tree, &node->text, &node->length) ? PEL_OK : fail_json(tree, "a text does not end", error);
    } else if (!read_word(tree, node)) {
        return fail_json(tree, "a value is missing", error);
    }
    if (status == PEL_OK)
        tree->nodes[*made].length = (size_t)(tree->scan.at - tree->nodes[*made].text);
    return status;
}

pel_status pel_json_tree_read(pel_json_tree *tree, const pel_text_cursor *scan, pel_error *error)
{
    int32_t made;
    *tree = (pel_json_tree){.scan = *scan};
    pel_status status = read_value(tree, 0, &made, error);
    pel_text_cursor_skip_spaces(&tree->scan);
    if (status == PEL_OK && tree->scan.at != tree->scan.end)
        status = fail_json(tree, "text stands behind its end", error);
    return status;
}

void pel_json_tree_free(pel_json_tree *tree)
{
    pel_free(tree->nodes);
    *tree = (pel_json_tree){.count = 0};
}

const pel_json_node *pel_json_first(const pel_json_tree *tree, const pel_json_node *parent)
{
    return parent != NULL && parent->first >= 0 ? &tree->nodes[parent->first] : NULL;
}

const pel_json_node *pel_json_after(const pel_json_tree *tree, const pel_json_node *child)
{
    return child->next >= 0 ? &tree->nodes[child->next] : NULL;
}

const pel_json_node *pel_json_member(const pel_json_tree *tree, const pel_json_node *object, const char *key)
{
    if (object == NULL || object->kind != PEL_JSON_IS_OBJECT)
        return NULL;
    for (const pel_json_node *child = pel_json_first(tree, object); child != NULL; child = pel_json_after(tree, child))
        if (child->key_length == strlen(key) && memcmp(child->key, key, child->key_length) == 0)
            return child;
    return NULL;
}

bool pel_json_is(const pel_json_node *node, const char *text)
{
    return node != NULL && node->kind == PEL_JSON_IS_TEXT && node->length == strlen(text) &&
           memcmp(node->text, text, node->length) == 0;
}

static int32_t hex_value(const char *at, const char *end)
{
    int32_t value = 0;
    if (end - at < 4)
        return -1;
    for (int i = 0; i < 4; i++) {
        const char c = at[i];
        const int digit = pel_is_digit(c)        ? c - '0'
                          : c >= 'a' && c <= 'f' ? c - 'a' + 10
                          : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                                 : -1;
        if (digit < 0)
            return -1;
        value = 16 * value + digit;
    }
    return value;
}

/* the letter of \uXXXX as UTF-8; returns how many bytes, 0 for none (no pairs of surrogates: paths do without) */
static size_t put_code(int32_t code, char bytes[3])
{
    if (code <= 0 || (code >= 0xd800 && code < 0xe000))
        return 0;
    if (code < 0x80) {
        bytes[0] = (char)code;
        return 1;
    }
    const size_t size = code < 0x800 ? 2 : 3;
    bytes[0] = (char)(size == 2 ? 0xc0 | code >> 6 : 0xe0 | code >> 12);
    bytes[size - 2] = (char)(size == 2 ? bytes[0] : (char)(0x80 | (code >> 6 & 63)));
    bytes[size - 1] = (char)(0x80 | (code & 63));
    return size;
}

bool pel_json_unescape(const pel_json_node *node, char *text, size_t size)
{
    static const char codes[] = "\"\\/bfnrt", letters[] = "\"\\/\b\f\n\r\t";
    size_t length = 0;
    if (node == NULL || node->kind != PEL_JSON_IS_TEXT)
        return false;
    for (const char *at = node->text, *end = at + node->length; at < end; at++) {
        char bytes[3] = {*at};
        size_t count = *at != '\0';
        if (*at == '\\') {
            at++;
            const char *code = at < end && *at != '\0' ? strchr(codes, *at) : NULL;
            if (code != NULL) {
                bytes[0] = letters[code - codes];
            } else {
                count = at < end && *at == 'u' ? put_code(hex_value(at + 1, end), bytes) : 0;
                at += 4;
            }
        }
        if (count == 0 || length + count >= size)
            return false;
        memcpy(text + length, bytes, count);
        length += count;
    }
    text[length] = '\0';
    return true;
}
