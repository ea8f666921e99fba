#include "keys/yaml.h"

#include "base/text.h"
#include "keys/scalar.h"

#include <errno.h>
#include <libfyaml.h>
#include <string.h>

/* aliases copy their values: limit the growth of documents, and of the list in which each looks for its anchor */
enum { MOST_VALUES = 1000000, MOST_ANCHORS = 1000, DEEPEST = 100, DEEPEST_FLOW = 1000 };
static const char too_deep[] = "lists and maps are nested too deeply";
static const char deep_remedy[] = "a scene needs no more than ten levels";

typedef struct yaml_anchor {
    const char *name;
    const pel_scene_value *value;
    struct yaml_anchor *next;
} yaml_anchor;

typedef struct yaml_parser {
    pel_scene_reader *reader;
    struct fy_parser *inner;
    struct fy_diag *diagnostics;
    const char *source, *text;
    bool with_lines;
    pel_scene_place place; /* of the present event */
    yaml_anchor *anchors;
    int32_t value_count, anchor_count, depth;
} yaml_parser;

/* report the first message of libfyaml, or the usual cause if it has none */
static void fail_syntax(yaml_parser *parser)
{
    void *position = NULL;
    const struct fy_diag_error *message = fy_diag_errors_iterate(parser->diagnostics, &position);
    pel_scene_place place = parser->place;
    if (message == NULL && errno == ENOMEM) {
        pel_fail_memory(parser->reader->error);
        return;
    }
    /* it says nothing of a directive that it does not know */
    if (message == NULL) {
        pel_scene_fail(parser->reader, &place, "this is not YAML 1.2");
        pel_fail_remedy(parser->reader->error, "remove lines that begin with %%, such as %%YAML 1.1");
        return;
    }
    if (parser->with_lines && message->line > 0) {
        place.line = message->line;
        place.column = message->column;
    }
    pel_scene_fail(parser->reader, &place, "this is not YAML: %s", message->msg);
    pel_fail_remedy(parser->reader->error, "check indentation, brackets and quotes here and just before");
}

/* null, so that a failure is one line */
static pel_scene_value *fail(yaml_parser *parser, const char *what, const char *remedy)
{
    pel_scene_fail(parser->reader, &parser->place, "%s", what);
    pel_fail_remedy(parser->reader->error, "%s", remedy);
    return NULL;
}

/* keeps the place of an event; the marks of quoted scalars and of aliases point after the quote and the star */
static void set_place(yaml_parser *parser, struct fy_event *event)
{
    const struct fy_mark *mark = fy_event_start_mark(event);
    if (mark == NULL || !parser->with_lines)
        return;
    parser->place.line = mark->line + 1;
    parser->place.column = mark->column + 1;
    bool behind = event->type == FYET_ALIAS;
    if (event->type == FYET_SCALAR && event->scalar.value != NULL) {
        enum fy_scalar_style style = fy_token_scalar_style(event->scalar.value);
        behind = style == FYSS_SINGLE_QUOTED || style == FYSS_DOUBLE_QUOTED;
    }
    if (behind && mark->column > 0)
        parser->place.column--;
}

static struct fy_event *next_event(yaml_parser *parser)
{
    errno = 0;
    struct fy_event *event = fy_parser_parse(parser->inner);
    if (event != NULL)
        set_place(parser, event);
    else
        fail_syntax(parser);
    return event;
}

static pel_scene_value *create(yaml_parser *parser, pel_scene_value_kind kind)
{
    if (++parser->value_count > MOST_VALUES)
        return fail(parser, "there are too many values", "put large lists into a field of the mesh file");
    return pel_scene_value_create(parser->reader, kind, parser->place);
}

/* the text of a scalar, an anchor or an alias, from its place in the source */
static const char *token_text(yaml_parser *parser, struct fy_token *token, char quote, size_t *length)
{
    size_t start = fy_token_start_mark(token)->input_pos, end = fy_token_end_mark(token)->input_pos;
    const char *text = pel_scene_decode_scalar(parser->reader->arena, parser->text + start, end - start, quote, length);
    if (text == NULL)
        pel_fail_memory(parser->reader->error);
    return text;
}

static pel_scene_value *read_scalar(yaml_parser *parser, struct fy_event *event)
{
    pel_scene_value *value = create(parser, PEL_SCENE_SCALAR);
    struct fy_token *token = event->scalar.value;
    if (value == NULL || token == NULL)
        return value;
    enum fy_scalar_style style = fy_token_scalar_style(token);
    if (style == FYSS_LITERAL || style == FYSS_FOLDED)
        return fail(parser, "block text (| or >) is not used in scenes", "write the text in quotes");
    char quote = style == FYSS_SINGLE_QUOTED ? '\'' : style == FYSS_DOUBLE_QUOTED ? '"' : '\0';
    size_t length;
    value->text = token_text(parser, token, quote, &length);
    if (value->text == NULL)
        return NULL;
    if (strlen(value->text) != length)
        return fail(parser, "the text has a zero byte", "remove it");
    value->quoted = quote != '\0';
    return value;
}

static pel_scene_value *copy_value(yaml_parser *parser, const pel_scene_value *original)
{
    pel_scene_value *value = create(parser, original->kind);
    if (value == NULL)
        return NULL;
    value->quoted = original->quoted;
    value->text = original->text;
    value->place = original->place;
    for (const pel_scene_value *child = original->first; child != NULL; child = child->next) {
        pel_scene_value *copy = copy_value(parser, child);
        if (copy == NULL)
            return NULL;
        copy->key_place = child->key_place;
        pel_scene_value_append(value, child->key, copy);
    }
    return value;
}

static pel_scene_value *read_alias(yaml_parser *parser, struct fy_event *event)
{
    size_t length;
    const char *name = token_text(parser, event->alias.anchor, '\0', &length);
    if (name == NULL)
        return NULL;
    for (const yaml_anchor *known = parser->anchors; known != NULL; known = known->next)
        if (strcmp(known->name, name) == 0)
            return copy_value(parser, known->value);
    return fail(parser, "the alias has no anchor before it", "write &name before the first use of *name");
}

/* remembers a value that is complete, so that an alias can never contain itself */
static bool keep_anchor(yaml_parser *parser, const char *name, const pel_scene_value *value)
{
    if (++parser->anchor_count > MOST_ANCHORS)
        return fail(parser, "there are more than 1000 anchors", "write values that are used once without &name") !=
               NULL;
    yaml_anchor *added = pel_arena_take(parser->reader->arena, 1, sizeof *added);
    if (added == NULL) {
        pel_fail_memory(parser->reader->error);
        return false;
    }
    *added = (yaml_anchor){name, value, parser->anchors};
    parser->anchors = added;
    return true;
}

static pel_scene_value *read_value(yaml_parser *parser, struct fy_event *event);

/* the elements up to the end of the list */
static bool read_list(yaml_parser *parser, pel_scene_value *list)
{
    for (;;) {
        struct fy_event *event = next_event(parser);
        if (event == NULL)
            return false;
        if (event->type == FYET_SEQUENCE_END) {
            fy_parser_event_free(parser->inner, event);
            return true;
        }
        pel_scene_value *element = read_value(parser, event);
        if (element == NULL)
            return false;
        pel_scene_value_append(list, NULL, element);
    }
}

/* the entries up to the end of the map */
static bool read_map(yaml_parser *parser, pel_scene_value *map)
{
    for (;;) {
        struct fy_event *event = next_event(parser);
        if (event == NULL)
            return false;
        if (event->type == FYET_MAPPING_END) {
            fy_parser_event_free(parser->inner, event);
            return true;
        }
        pel_scene_value *key = read_value(parser, event);
        if (key == NULL)
            return false;
        if (key->kind != PEL_SCENE_SCALAR) {
            parser->place = key->place;
            fail(parser, "a key must be text", "write key: value");
            return false;
        }
        event = next_event(parser);
        pel_scene_value *value = event != NULL ? read_value(parser, event) : NULL;
        if (value == NULL)
            return false;
        pel_scene_value_append(map, key->text, value);
        value->key_place = key->place;
    }
}

/* attributes of events other than aliases */
static void decorations(const struct fy_event *event, struct fy_token **anchor_token, struct fy_token **tag)
{
    *anchor_token = *tag = NULL;
    if (event->type == FYET_SCALAR) {
        *anchor_token = event->scalar.anchor;
        *tag = event->scalar.tag;
    } else if (event->type == FYET_SEQUENCE_START) {
        *anchor_token = event->sequence_start.anchor;
        *tag = event->sequence_start.tag;
    } else if (event->type == FYET_MAPPING_START) {
        *anchor_token = event->mapping_start.anchor;
        *tag = event->mapping_start.tag;
    }
}

/* the value that begins with an event, which is freed */
static pel_scene_value *read_value(yaml_parser *parser, struct fy_event *event)
{
    struct fy_token *anchor_token, *tag;
    decorations(event, &anchor_token, &tag);
    size_t length;
    const char *name = anchor_token != NULL ? token_text(parser, anchor_token, '\0', &length) : NULL;
    bool name_failed = anchor_token != NULL && name == NULL;
    enum fy_event_type type = event->type;
    pel_scene_value *value = NULL;
    if (tag != NULL)
        fail(parser, "tags are not used in scenes", "remove the word with the exclamation mark");
    else if (name_failed)
        ;
    else if (type == FYET_SCALAR)
        value = read_scalar(parser, event);
    else if (type == FYET_ALIAS)
        value = read_alias(parser, event);
    else
        value = create(parser, type == FYET_MAPPING_START ? PEL_SCENE_MAP : PEL_SCENE_LIST);
    fy_parser_event_free(parser->inner, event);
    if (value == NULL)
        return NULL;
    if (++parser->depth > DEEPEST)
        return fail(parser, too_deep, deep_remedy);
    if (type == FYET_MAPPING_START && !read_map(parser, value))
        return NULL;
    if (type == FYET_SEQUENCE_START && !read_list(parser, value))
        return NULL;
    parser->depth--;
    return name == NULL || keep_anchor(parser, name, value) ? value : NULL;
}

/* the only document of the stream */
static pel_scene_value *read_stream(yaml_parser *parser)
{
    pel_scene_value *root = NULL;
    for (;;) {
        struct fy_event *event = next_event(parser);
        if (event == NULL)
            return NULL;
        enum fy_event_type type = event->type;
        bool is_value =
            type == FYET_SCALAR || type == FYET_ALIAS || type == FYET_MAPPING_START || type == FYET_SEQUENCE_START;
        if (is_value && root == NULL) {
            root = read_value(parser, event);
            if (root == NULL)
                return NULL;
            continue;
        }
        fy_parser_event_free(parser->inner, event);
        if (is_value)
            return fail(parser, "a second document begins", "keep one scene in one file");
        if (type == FYET_STREAM_END)
            return root != NULL ? root : create(parser, PEL_SCENE_MAP);
    }
}

/* libfyaml passes over bytes that are not UTF-8: name the first one */
static bool is_utf8(yaml_parser *parser, const char *text, size_t size)
{
    pel_scene_place place = {parser->source, 1, 1};
    for (size_t i = 0; i < size;) {
        size_t length = text[i] == '\0' ? 0 : pel_utf8_length(text + i, size - i);
        if (length == 0) {
            parser->place = parser->with_lines ? place : parser->place;
            fail(parser, "this byte is not UTF-8 text", "save the file as UTF-8");
            return false;
        }
        place.column = text[i] == '\n' ? 1 : place.column + 1;
        place.line += text[i] == '\n';
        i += length;
    }
    return true;
}

/* where a text in quotes that begins here ends */
static size_t skip_quoted(const char *text, size_t size, size_t at)
{
    const char quote = text[at++];
    while (at < size && text[at] != quote)
        at += text[at] == '\\' && quote == '"' ? 2 : 1;
    return at;
}

/* libfyaml reads a list in brackets to its end before it hands out the first element, in gigabytes of memory where
   brackets are nested without end. Brackets count where a value may begin, outside of quotes and comments: that may
   miss some, and `depth` in read_value misses none. */
static bool is_shallow(yaml_parser *parser, const char *text, size_t size)
{
    int32_t depth = 0;
    char before = '\n';
    for (size_t i = 0; i < size; i++) {
        const char c = text[i];
        const bool begins = strchr("\n[{,:-?", before) != NULL;
        if (c == '#' && (i == 0 || strchr(" \t\r\n", text[i - 1]) != NULL))
            while (i + 1 < size && text[i + 1] != '\n')
                i++;
        else if (begins && (c == '\'' || c == '"'))
            i = skip_quoted(text, size, i);
        else if (begins && (c == '&' || c == '!'))
            while (i + 1 < size && strchr(" \t\r\n", text[i + 1]) == NULL)
                i++;
        else if (begins && (c == '[' || c == '{'))
            depth++;
        else if (c == ']' || c == '}')
            depth -= depth > 0;
        if (depth > DEEPEST_FLOW)
            return fail(parser, too_deep, deep_remedy) != NULL;
        if (strchr(" \t\r#&!", c) == NULL)
            before = c;
    }
    return true;
}

static bool open_parser(yaml_parser *parser, const char *text, size_t size)
{
    struct fy_diag_cfg diagnostics;
    fy_diag_cfg_default(&diagnostics);
    diagnostics.fp = NULL;
    parser->diagnostics = fy_diag_create(&diagnostics);
    if (parser->diagnostics == NULL)
        return false;
    fy_diag_set_collect_errors(parser->diagnostics, true);
    struct fy_parse_cfg settings = {.flags = FYPCF_JSON_NONE | FYPCF_DEFAULT_VERSION_1_2, .diag = parser->diagnostics};
    parser->inner = fy_parser_create(&settings);
    return parser->inner != NULL && fy_parser_set_string(parser->inner, text, size) == 0;
}

pel_scene_value *pel_scene_yaml_parse(pel_scene_reader *reader, const char *source, const char *text, size_t size,
                                      bool with_lines)
{
    yaml_parser parser = {.reader = reader, .source = source, .text = text, .with_lines = with_lines};
    parser.place = (pel_scene_place){source, with_lines ? 1 : 0, with_lines ? 1 : 0};
    if (!is_utf8(&parser, text, size) || !is_shallow(&parser, text, size))
        return NULL;
    pel_scene_value *root = NULL;
    if (open_parser(&parser, text, size))
        root = read_stream(&parser);
    else
        pel_fail_memory(reader->error);
    fy_parser_destroy(parser.inner);
    fy_diag_destroy(parser.diagnostics);
    return root;
}
