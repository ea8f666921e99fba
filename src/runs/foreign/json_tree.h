/* JSON (RFC 8259) as a tree of nodes that point into the text. */
#ifndef PEL_FOREIGN_JSON_TREE_H
#define PEL_FOREIGN_JSON_TREE_H

#include "io/text_cursor.h"

typedef enum pel_json_kind {
    PEL_JSON_IS_NULL,
    PEL_JSON_IS_BOOL,
    PEL_JSON_IS_NUMBER,
    PEL_JSON_IS_TEXT,
    PEL_JSON_IS_ARRAY,
    PEL_JSON_IS_OBJECT
} pel_json_kind;

typedef struct pel_json_node {
    pel_json_kind kind;
    int32_t first, next; /* child, sibling; -1 = none */
    int32_t count;       /* children */
    const char *key;     /* (key_length) of a member, without quotes, as it stands in the file */
    size_t key_length;
    const char *text; /* (length) the value as it stands in the file: of a text without quotes */
    size_t length;
    double number; /* also 1 for true */
} pel_json_node;

typedef struct pel_json_tree {
    pel_text_cursor scan;
    pel_json_node *nodes; /* (count) node 0 is the outermost value */
    size_t count, capacity;
} pel_json_tree;

/* Reads scan->at..end, one value with blanks around it. PEL_BAD_FORMAT with the place (also deeper than 64 brackets);
   PEL_OUT_OF_MEMORY. Free the tree in any case. */
pel_status pel_json_tree_read(pel_json_tree *tree, const pel_text_cursor *scan, pel_error *error);
void pel_json_tree_free(pel_json_tree *tree);

/* The member of an object; null if it has none of that name, or is null or no object. */
const pel_json_node *pel_json_member(const pel_json_tree *tree, const pel_json_node *object, const char *key);
/* The first child, and the one after a child; null at the end. */
const pel_json_node *pel_json_first(const pel_json_tree *tree, const pel_json_node *parent);
const pel_json_node *pel_json_after(const pel_json_tree *tree, const pel_json_node *child);

/* Whether a node, nullable, is this text. */
bool pel_json_is(const pel_json_node *node, const char *text);
/* Copies a text without its escapes; false if it does not fit, or is no text. Zero bytes and lone surrogates count as
   not fitting. */
bool pel_json_unescape(const pel_json_node *node, char *text, size_t size);

#endif
