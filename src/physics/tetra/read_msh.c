/* Files of Gmsh in the formats 2 and 4.1 as text (Gmsh manual, "MSH file format"). Nodes have tags, which need not be
   in order or without gaps. Triangles, lines and points describe the geometry and are skipped. */
#include "tetra/read.h"

#include "base/memory.h"
#include "base/status.h"

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

static pel_status read_format(msh_reader *reader)
{
    pel_text_cursor *scan = reader->scan;
    double version;
    int64_t binary;
    pel_text_cursor_skip_spaces(scan);
    const char *at = scan->at;
    if (!pel_text_cursor_number(scan, &version))
        return pel_text_cursor_fail_number(scan, reader->error, "a version of the format");
    pel_status status = pel_tetra_read_integer(scan, "0 for text or 1 for binary", &binary, reader->error);
    if (status != PEL_OK)
        return status;
    if (binary != 0)
        return pel_text_cursor_fail(scan, at, reader->error,
                                    "save it as text: gmsh -format msh22 -save, Mesh.Binary = 0",
                                    "binary files of Gmsh are not read");
    reader->is_new = version >= 4.1;
    if ((version >= 2 && version < 3) || (version >= 4.1 && version < 5))
        return PEL_OK;
    return pel_text_cursor_fail(scan, at, reader->error, "save it in the format 2.2 or 4.1: gmsh -format msh22 -save",
                                "the version of the format is %g", version);
}

static pel_status read_node_tag(msh_reader *reader)
{
    int64_t tag;
    pel_status status = pel_tetra_read_integer(reader->scan, "the tag of a node", &tag, reader->error);
    return status == PEL_OK ? add_node(reader, tag) : status;
}

static pel_status read_position(msh_reader *reader)
{
    double x[3];
    pel_status status = pel_tetra_read_point(reader->scan, x, reader->error);
    /* parameters on a curve or surface may follow */
    pel_text_cursor_skip_line(reader->scan);
    return status == PEL_OK ? pel_tetra_soup_add_point(reader->soup, x, reader->error) : status;
}

/* a block of 4.1: tags, then positions */
static pel_status read_node_block(msh_reader *reader)
{
    int64_t unused, count;
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < 3; i++)
        status = pel_tetra_read_integer(reader->scan, "the head of a block of nodes", &unused, reader->error);
    if (status == PEL_OK)
        status = pel_tetra_read_count(reader->scan, "a number of nodes", 8, &count, reader->error);
    for (int64_t i = 0; status == PEL_OK && i < count; i++)
        status = read_node_tag(reader);
    for (int64_t i = 0; status == PEL_OK && i < count; i++)
        status = read_position(reader);
    return status;
}

static pel_status read_nodes(msh_reader *reader)
{
    int64_t count;
    pel_status status = pel_tetra_read_count(reader->scan, "a number of nodes", 4, &count, reader->error);
    if (status == PEL_OK && reader->is_new) {
        pel_text_cursor_skip_line(reader->scan);
        for (int64_t b = 0; status == PEL_OK && b < count; b++)
            status = read_node_block(reader);
    }
    for (int64_t i = 0; status == PEL_OK && !reader->is_new && i < count; i++) {
        status = read_node_tag(reader);
        if (status == PEL_OK)
            status = read_position(reader);
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
        pel_status status = pel_tetra_read_integer(reader->scan, "the tag of a node", &key.tag, reader->error);
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

static pel_status read_element(msh_reader *reader, int64_t type, const char *place)
{
    pel_status status = PEL_OK;
    const char *shape = "cell of an unknown type";
    for (size_t i = 0; i < sizeof elements / sizeof *elements; i++)
        if (elements[i].type == type)
            shape = elements[i].shape;
    if (type == TETRAHEDRON || type == TETRAHEDRON_10)
        status = read_corners(reader, type, place);
    else if (shape != NULL)
        return pel_tetra_refuse_cell(reader->scan, place, shape, reader->error);
    else
        reader->soup->other_count++;
    pel_text_cursor_skip_line(reader->scan);
    return status;
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

static pel_status read_element_block(msh_reader *reader)
{
    int64_t unused, type, count;
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < 2; i++)
        status = pel_tetra_read_integer(reader->scan, "the head of a block of elements", &unused, reader->error);
    if (status == PEL_OK)
        status = pel_tetra_read_integer(reader->scan, "the type of elements", &type, reader->error);
    if (status == PEL_OK)
        status = pel_tetra_read_count(reader->scan, "a number of elements", 4, &count, reader->error);
    for (int64_t i = 0; status == PEL_OK && i < count; i++) {
        pel_text_cursor_skip_spaces(reader->scan);
        const char *place = reader->scan->at;
        status = pel_tetra_read_integer(reader->scan, "the number of an element", &unused, reader->error);
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
    pel_status status = pel_tetra_read_count(reader->scan, "a number of elements", 4, &count, reader->error);
    if (status == PEL_OK && reader->is_new)
        pel_text_cursor_skip_line(reader->scan);
    for (int64_t i = 0; status == PEL_OK && i < count; i++)
        status = reader->is_new ? read_element_block(reader) : read_old_element(reader);
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
