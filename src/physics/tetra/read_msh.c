/* Files of Gmsh in the formats 2 and 4.1, as text or binary (Gmsh manual, "MSH file format"). Nodes have tags, which
   need not be in order or without gaps. Triangles, lines and points describe the geometry and are skipped. In binary
   files of either format the names of sections are text; in those of format 2 the counts of a section are too. */
#include "tetra/read.h"

#include "base/memory.h"
#include "base/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* types of elements */
enum { TETRAHEDRON = 4, TETRAHEDRON_10 = 11 };

/* nodes and shape of the types that are no surface; null: of a surface, a line or a point */
static const struct {
    int64_t type, nodes;
    const char *shape;
} elements[] = {{1, 2, NULL},    {2, 3, NULL},           {3, 4, NULL},      {4, 4, NULL},        {5, 8, "hexahedron"},
                {6, 6, "prism"}, {7, 5, "pyramid"},      {8, 3, NULL},      {9, 6, NULL},        {10, 9, NULL},
                {11, 10, NULL},  {12, 27, "hexahedron"}, {13, 18, "prism"}, {14, 14, "pyramid"}, {15, 1, NULL},
                {16, 8, NULL},   {17, 20, "hexahedron"}, {18, 15, "prism"}, {19, 13, "pyramid"}};

typedef struct node {
    int64_t tag;
    int32_t number;
} node;

typedef struct msh_reader {
    pel_text_cursor *scan;
    pel_tetra_soup *soup;
    pel_error *error;
    node *nodes; /* by tag once all are there */
    size_t node_count, node_limit;
    bool is_new, has_nodes; /* format 4.1 */
    bool is_binary;
} msh_reader;

static pel_status add_node(msh_reader *reader, int64_t tag)
{
    void *nodes = reader->nodes;
    if (!pel_reserve(&nodes, &reader->node_limit, reader->node_count + 1, sizeof *reader->nodes))
        return pel_fail_memory(reader->error);
    reader->nodes = nodes;
    reader->nodes[reader->node_count] = (node){tag, (int32_t)reader->node_count};
    reader->node_count++;
    return PEL_OK;
}

static int compare(const void *a, const void *b)
{
    const node *first = a, *second = b;
    return first->tag < second->tag ? -1 : first->tag > second->tag;
}

/* sorts the nodes; no tag may stand twice */
static pel_status sort_nodes(msh_reader *reader)
{
    if (reader->node_count > 0)
        qsort(reader->nodes, reader->node_count, sizeof *reader->nodes, compare);
    for (size_t i = 1; i < reader->node_count; i++)
        if (reader->nodes[i].tag == reader->nodes[i - 1].tag)
            return pel_text_cursor_fail(reader->scan, reader->scan->at, reader->error, "save the mesh again from Gmsh",
                                        "two nodes have the tag %lld", (long long)reader->nodes[i].tag);
    reader->has_nodes = true;
    return PEL_OK;
}

/* ---- numbers ---- */

/* bytes of a binary file, in the order of this machine */
static pel_status read_bytes(msh_reader *reader, void *data, size_t size)
{
    pel_text_cursor *scan = reader->scan;
    if (size > (size_t)(scan->end - scan->at))
        return pel_text_cursor_fail(scan, scan->at, reader->error, "save the mesh again from Gmsh",
                                    "the file ends too early");
    memcpy(data, scan->at, size);
    scan->at += size;
    return PEL_OK;
}

/* an int of Gmsh */
static pel_status read_int(msh_reader *reader, const char *what, int64_t *value)
{
    int32_t number = 0;
    if (!reader->is_binary)
        return pel_tetra_read_integer(reader->scan, what, value, reader->error);
    pel_status status = read_bytes(reader, &number, sizeof number);
    *value = number;
    return status;
}

/* a size_t of Gmsh, in format 4.1: tags and counts; in format 2 these are ints */
static pel_status read_size(msh_reader *reader, const char *what, int64_t *value)
{
    uint64_t number = 0;
    if (!reader->is_binary || !reader->is_new)
        return read_int(reader, what, value);
    pel_status status = read_bytes(reader, &number, sizeof number);
    *value = number > INT64_MAX ? -1 : (int64_t)number;
    return status;
}

/* a number of items of at least so many bytes */
static pel_status read_count(msh_reader *reader, const char *what, int64_t smallest, bool is_size, int64_t *count)
{
    pel_text_cursor *scan = reader->scan;
    const char *at = scan->at;
    if (!reader->is_binary)
        return pel_tetra_read_count(scan, what, smallest, count, reader->error);
    pel_status status = is_size ? read_size(reader, what, count) : read_int(reader, what, count);
    if (status == PEL_OK && (*count < 0 || *count > (scan->end - scan->at) / smallest))
        return pel_text_cursor_fail(scan, at, reader->error, "save the mesh again from Gmsh",
                                    "%s is %lld, more than the file can hold", what, (long long)*count);
    return status;
}

static void skip_line_end(pel_text_cursor *scan)
{
    pel_text_cursor_skip_line(scan);
    scan->at += scan->at < scan->end;
}

/* the count with which a section begins, after its name */
static pel_status read_section_count(msh_reader *reader, const char *what, int64_t *count)
{
    int64_t unused;
    if (reader->is_binary)
        skip_line_end(reader->scan);
    if (!reader->is_binary || !reader->is_new) {
        pel_status status = pel_tetra_read_count(reader->scan, what, 4, count, reader->error);
        if (reader->is_binary)
            skip_line_end(reader->scan);
        return status;
    }
    pel_status status = read_count(reader, what, 4, true, count);
    for (int i = 0; status == PEL_OK && i < 3; i++)
        status = read_size(reader, what, &unused);
    return status;
}

/* ---- sections ---- */

static pel_status read_order(msh_reader *reader)
{
    int32_t one = 0;
    const char *at = reader->scan->at;
    skip_line_end(reader->scan);
    pel_status status = read_bytes(reader, &one, sizeof one);
    if (status == PEL_OK && one != 1)
        return pel_text_cursor_fail(reader->scan, at, reader->error, "save it as text: Mesh.Binary = 0",
                                    "the bytes of the file have another order than those of this machine");
    return status;
}

static pel_status read_format(msh_reader *reader)
{
    pel_text_cursor *scan = reader->scan;
    double version;
    int64_t binary, size;
    pel_text_cursor_skip_spaces(scan);
    const char *at = scan->at;
    if (!pel_text_cursor_number(scan, &version))
        return pel_text_cursor_fail_number(scan, reader->error, "a version of the format");
    pel_status status = pel_tetra_read_integer(scan, "0 for text or 1 for binary", &binary, reader->error);
    if (status != PEL_OK)
        return status;
    reader->is_new = version >= 4.1;
    if ((version >= 2 && version < 3) || (version >= 4.1 && version < 5)) {
        if (binary == 0)
            return PEL_OK;
        reader->is_binary = scan->binary = true;
        status = pel_tetra_read_integer(scan, "the size of a number", &size, reader->error);
        return status == PEL_OK ? read_order(reader) : status;
    }
    return pel_text_cursor_fail(scan, at, reader->error, "save it in the format 2.2 or 4.1: gmsh -format msh22 -save",
                                "the version of the format is %g", version);
}

static pel_status read_node_tag(msh_reader *reader)
{
    int64_t tag;
    pel_status status = read_size(reader, "the tag of a node", &tag);
    return status == PEL_OK ? add_node(reader, tag) : status;
}

/* parameters on a curve or surface may follow */
static pel_status read_position(msh_reader *reader, int64_t parameters)
{
    double x[6];
    pel_status status;
    if (reader->is_binary) {
        status = read_bytes(reader, x, (size_t)(3 + parameters) * sizeof *x);
        for (int c = 0; status == PEL_OK && c < 3; c++)
            if (!isfinite(x[c]))
                return pel_text_cursor_fail(reader->scan, reader->scan->at, reader->error,
                                            "save the mesh again from Gmsh", "a node has the coordinate %g", x[c]);
    } else {
        status = pel_tetra_read_point(reader->scan, x, reader->error);
        pel_text_cursor_skip_line(reader->scan);
    }
    return status == PEL_OK ? pel_tetra_soup_add_point(reader->soup, x, reader->error) : status;
}

/* a block of 4.1: tags, then positions */
static pel_status read_node_block(msh_reader *reader)
{
    int64_t head[3], count;
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < 3; i++)
        status = read_int(reader, "the head of a block of nodes", &head[i]);
    if (status == PEL_OK)
        status = read_count(reader, "a number of nodes", 8, true, &count);
    /* of the dimension of the block, where it has any */
    const int64_t parameters = status == PEL_OK && head[2] != 0 && head[0] >= 0 && head[0] <= 3 ? head[0] : 0;
    for (int64_t i = 0; status == PEL_OK && i < count; i++)
        status = read_node_tag(reader);
    for (int64_t i = 0; status == PEL_OK && i < count; i++)
        status = read_position(reader, parameters);
    return status;
}

static pel_status read_nodes(msh_reader *reader)
{
    int64_t count;
    pel_status status = read_section_count(reader, "a number of nodes", &count);
    if (status == PEL_OK && reader->is_new) {
        if (!reader->is_binary)
            pel_text_cursor_skip_line(reader->scan);
        for (int64_t b = 0; status == PEL_OK && b < count; b++)
            status = read_node_block(reader);
    }
    for (int64_t i = 0; status == PEL_OK && !reader->is_new && i < count; i++) {
        status = read_node_tag(reader);
        if (status == PEL_OK)
            status = read_position(reader, 0);
    }
    return status == PEL_OK ? sort_nodes(reader) : status;
}

/* the nodes of an element, whose first four are the corners */
static pel_status read_corners(msh_reader *reader, int64_t type, const char *place)
{
    int64_t corners[4];
    for (int k = 0; k < 4; k++) {
        const node wanted = {.number = 0};
        node key = wanted;
        pel_status status = read_size(reader, "the tag of a node", &key.tag);
        if (status != PEL_OK)
            return status;
        const node *found =
            reader->node_count == 0 ? NULL : bsearch(&key, reader->nodes, reader->node_count, sizeof key, compare);
        if (found == NULL)
            return pel_text_cursor_fail(reader->scan, place, reader->error, "save the mesh again with all its nodes",
                                        "a tetrahedron has the node %lld, which does not exist", (long long)key.tag);
        corners[k] = found->number;
    }
    reader->soup->quadratic_count += type == TETRAHEDRON_10;
    return pel_tetra_soup_add(reader->soup, corners, place, reader->error);
}

/* the nodes of a binary element that have not been read */
static pel_status skip_nodes(msh_reader *reader, int64_t type, int64_t nodes)
{
    int64_t unused;
    pel_status status = PEL_OK;
    for (int64_t k = type == TETRAHEDRON || type == TETRAHEDRON_10 ? 4 : 0; status == PEL_OK && k < nodes; k++)
        status = read_size(reader, "the tag of a node", &unused);
    return status;
}

static pel_status read_element(msh_reader *reader, int64_t type, const char *place)
{
    pel_status status = PEL_OK;
    const char *shape = "cell of an unknown type";
    int64_t nodes = 0;
    for (size_t i = 0; i < sizeof elements / sizeof *elements; i++)
        if (elements[i].type == type) {
            shape = elements[i].shape;
            nodes = elements[i].nodes;
        }
    if (type == TETRAHEDRON || type == TETRAHEDRON_10)
        status = read_corners(reader, type, place);
    else if (shape != NULL)
        return pel_tetra_refuse_cell(reader->scan, place, shape, reader->error);
    if (!reader->is_binary)
        pel_text_cursor_skip_line(reader->scan);
    return status == PEL_OK && reader->is_binary ? skip_nodes(reader, type, nodes) : status;
}

/* a line of format 2: tag, type, tags of the geometry, nodes */
static pel_status read_old_element(msh_reader *reader)
{
    int64_t unused, type, tags;
    pel_text_cursor_skip_spaces(reader->scan);
    const char *place = reader->scan->at;
    pel_status status = pel_tetra_read_integer(reader->scan, "the number of an element", &unused, reader->error);
    if (status == PEL_OK)
        status = pel_tetra_read_integer(reader->scan, "the type of an element", &type, reader->error);
    if (status == PEL_OK)
        status = pel_tetra_read_count(reader->scan, "a number of tags", 2, &tags, reader->error);
    for (int64_t i = 0; status == PEL_OK && i < tags; i++)
        status = pel_tetra_read_integer(reader->scan, "a tag", &unused, reader->error);
    return status == PEL_OK ? read_element(reader, type, place) : status;
}

/* a block of binary format 2: type, count and number of tags, then tag, tags of the geometry and nodes of each */
static pel_status read_old_block(msh_reader *reader, int64_t *count)
{
    int64_t type = 0, tags = 0, unused;
    pel_status status = read_int(reader, "the type of elements", &type);
    if (status == PEL_OK)
        status = read_count(reader, "a number of elements", 8, false, count);
    if (status == PEL_OK)
        status = read_count(reader, "a number of tags", 4, false, &tags);
    for (int64_t i = 0; status == PEL_OK && i < *count; i++) {
        const char *place = reader->scan->at;
        for (int64_t k = 0; status == PEL_OK && k < 1 + tags; k++)
            status = read_int(reader, "a tag", &unused);
        if (status == PEL_OK)
            status = read_element(reader, type, place);
    }
    if (status == PEL_OK && *count == 0)
        return pel_text_cursor_fail(reader->scan, reader->scan->at, reader->error, "save the mesh again from Gmsh",
                                    "a block has no elements");
    return status;
}

static pel_status read_element_block(msh_reader *reader)
{
    int64_t unused, type, count;
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < 2; i++)
        status = read_int(reader, "the head of a block of elements", &unused);
    if (status == PEL_OK)
        status = read_int(reader, "the type of elements", &type);
    if (status == PEL_OK)
        status = read_count(reader, "a number of elements", 4, true, &count);
    for (int64_t i = 0; status == PEL_OK && i < count; i++) {
        if (!reader->is_binary)
            pel_text_cursor_skip_spaces(reader->scan);
        const char *place = reader->scan->at;
        status = read_size(reader, "the number of an element", &unused);
        if (status == PEL_OK)
            status = read_element(reader, type, place);
    }
    return status;
}

static pel_status read_elements(msh_reader *reader)
{
    int64_t count;
    if (!reader->has_nodes)
        return pel_text_cursor_fail(reader->scan, reader->scan->at, reader->error, "save the mesh again from Gmsh",
                                    "the elements stand before the nodes");
    pel_status status = read_section_count(reader, "a number of elements", &count);
    if (status == PEL_OK && reader->is_new && !reader->is_binary)
        pel_text_cursor_skip_line(reader->scan);
    for (int64_t i = 0, block; status == PEL_OK && i < count; i += block) {
        block = 1;
        if (reader->is_new)
            status = read_element_block(reader);
        else
            status = reader->is_binary ? read_old_block(reader, &block) : read_old_element(reader);
    }
    return status;
}

/* skips to the next section; its name, or length 0 at the end of the file */
static const char *next_section(pel_text_cursor *scan, size_t *length)
{
    for (; scan->at < scan->end; pel_text_cursor_skip_line(scan)) {
        pel_text_cursor_skip_spaces(scan);
        if (scan->at < scan->end && *scan->at == '$')
            return pel_text_cursor_word(scan, length);
    }
    *length = 0;
    return scan->at;
}

static bool is_section(const char *word, size_t length, const char *name)
{
    return length == strlen(name) && memcmp(word, name, length) == 0;
}

static pel_status read_sections(msh_reader *reader)
{
    size_t length;
    bool has_format = false;
    for (;;) {
        const char *word = next_section(reader->scan, &length);
        pel_status status = PEL_OK;
        if (length == 0)
            return PEL_OK;
        if (is_section(word, length, "$MeshFormat")) {
            has_format = true;
            status = read_format(reader);
        } else if (!has_format) {
            status = pel_text_cursor_fail(reader->scan, word, reader->error,
                                          "save it in the format 2.2 or 4.1: gmsh -format msh22 -save",
                                          "the file does not begin with $MeshFormat, as files of Gmsh do");
        } else if (is_section(word, length, "$Nodes")) {
            status = reader->has_nodes
                         ? pel_text_cursor_fail(reader->scan, word, reader->error, "save the mesh again from Gmsh",
                                                "there are two lists of nodes")
                         : read_nodes(reader);
        } else if (is_section(word, length, "$Elements")) {
            status = read_elements(reader);
        }
        if (status != PEL_OK)
            return status;
    }
}

pel_status pel_msh_read(pel_text_cursor *scan, pel_tetra_soup *soup, pel_error *error)
{
    msh_reader reader = {.scan = scan, .soup = soup, .error = error};
    pel_status status = read_sections(&reader);
    pel_free(reader.nodes);
    return status;
}
