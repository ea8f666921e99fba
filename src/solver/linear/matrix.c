#include "linear/matrix.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/sort.h"
#include "base/status.h"

#include <string.h>

/* sizes of chunks: some 20 microseconds each */
enum { ROWS_PER_CHUNK = 64, ELEMENTS_PER_PIECE = 64 };
enum { COLORS_PER_ROUND = 64, CLASS_COUNT = 256 * (PEL_ELEMENT_SIZE_LIMIT + 1) };
/* values behind the last one that a product may load */
enum { OVERHANG = 4 };

/* four doubles at any address */
typedef double quad __attribute__((vector_size(32), aligned(8), may_alias));

/* incidence of nodes and elements, and scratch, while a pattern is built */
typedef struct builder {
    const pel_matrix_def *def;
    pel_matrix *matrix;
    int32_t *use_start, *use_element, *use_corner; /* elements at each node, and as which of their nodes */
    int32_t *meet_start, *meet_coupling;           /* couplings at each node */
    int32_t *stamp;                                /* (node_count) last row that has seen a node, later its block */
    int32_t *key, *sorted;                         /* (element_count) of elements or pieces */
    int32_t *piece;                                /* (element_count + 1) first elements of pieces, in sorted */
    uint64_t *used;                                /* (node_count) colors of one round */
    int32_t *counts;                               /* for counting sorts */
} builder;

void pel_matrix_destroy(pel_matrix *matrix)
{
    if (matrix == NULL)
        return;
    PEL_FREE_ALL(matrix->first_unknown, matrix->row_start, matrix->column, matrix->block_start, matrix->values,
                 matrix->element_start, matrix->element_place, matrix->element_node, matrix->node_start,
                 matrix->ordered, matrix->group_start, matrix->piece_start, matrix->color_start);
    pel_free(matrix);
}

static void release_builder(builder *b)
{
    PEL_FREE_ALL(b->use_start, b->use_element, b->use_corner, b->stamp, b->key, b->sorted, b->meet_start,
                 b->meet_coupling, b->piece, b->used, b->counts);
}

static int32_t size_of(const pel_matrix *matrix, int32_t node)
{
    PEL_ASSERT_INDEX(node, matrix->node_count);
    return matrix->first_unknown[node + 1] - matrix->first_unknown[node];
}

/* unknowns of an element */
static int32_t element_size(const pel_matrix *matrix, int32_t element)
{
    PEL_ASSERT_INDEX(element, matrix->element_count);
    int32_t size = 0;
    for (int32_t i = matrix->node_start[element]; i < matrix->node_start[element + 1]; i++)
        size += size_of(matrix, matrix->element_node[i]);
    return size;
}

static pel_status refuse(pel_error *error, const char *kind, int64_t number, const char *what)
{
    pel_fail(error, PEL_BAD_ARGUMENT, "%s", what);
    pel_fail_element(error, kind, number);
    return PEL_BAD_ARGUMENT;
}

static pel_status check_def(const pel_matrix_def *def, pel_error *error)
{
    if (def->node_count < 1 || def->element_count < 0)
        return pel_fail(error, PEL_BAD_ARGUMENT, "a matrix needs nodes, not %d", (int)def->node_count);
    int64_t unknowns = 0, places = 0;
    for (int32_t i = 0; i < def->node_count; i++) {
        int32_t size = def->node_size == NULL ? 3 : def->node_size[i];
        if (size < 1 || size > PEL_NODE_SIZE_LIMIT)
            return refuse(error, "node", i, "a node needs 1 to 6 unknowns");
        unknowns += size;
    }
    for (int32_t e = 0; e < def->element_count; e++) {
        int32_t begin = def->element_start[e], end = def->element_start[e + 1], size = 0;
        if (begin >= end || (e == 0 && begin != 0))
            return refuse(error, "element", e, "an element needs nodes, and starts of elements ascend from 0");
        for (int32_t i = begin; i < end; i++) {
            if (def->element_node[i] < 0 || def->element_node[i] >= def->node_count)
                return refuse(error, "element", e, "an element has a node out of range");
            size += def->node_size == NULL ? 3 : def->node_size[def->element_node[i]];
            if (size > PEL_ELEMENT_SIZE_LIMIT)
                return refuse(error, "element", e, "an element may have 24 unknowns at most");
        }
        places += (int64_t)(end - begin) * (end - begin);
    }
    for (int32_t c = 0; c < def->coupling_count; c++)
        for (int i = 0; i < 4; i++)
            if (def->couplings[c][i] < 0 || def->couplings[c][i] >= def->node_count)
                return refuse(error, "coupling", c, "a coupling has a node out of range");
    if (unknowns > INT32_MAX / 2 || places > INT32_MAX || def->coupling_count > INT32_MAX / 4)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the matrix is too large: more than 2^31 values");
    return PEL_OK;
}

static void copy_elements(builder *b)
{
    const pel_matrix_def *def = b->def;
    pel_matrix *m = b->matrix;
    for (int32_t i = 0; i < def->node_count; i++)
        m->first_unknown[i + 1] = m->first_unknown[i] + (def->node_size == NULL ? 3 : def->node_size[i]);
    m->unknown_count = m->first_unknown[def->node_count];
    for (int32_t e = 0; e < def->element_count; e++) {
        int32_t begin = def->element_start[e], end = def->element_start[e + 1];
        m->node_start[e + 1] = end;
        m->element_start[e + 1] = m->element_start[e] + (end - begin) * (end - begin);
        for (int32_t i = begin; i < end; i++) {
            m->element_node[i] = def->element_node[i];
            b->use_start[def->element_node[i] + 1]++;
        }
    }
}

static pel_status allocate_builder(builder *b, pel_error *error)
{
    const pel_matrix_def *def = b->def;
    pel_matrix *m = b->matrix;
    size_t nodes = (size_t)def->node_count, elements = (size_t)def->element_count;
    size_t corners = elements > 0 ? (size_t)def->element_start[elements] : 0;
    m->node_count = def->node_count;
    m->element_count = def->element_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(m->first_unknown, nodes + 1), PEL_ROOM(m->row_start, nodes + 1),
                          PEL_ROOM(m->node_start, elements + 1), PEL_ROOM(m->element_start, elements + 1),
                          PEL_ROOM(m->element_node, corners), PEL_ROOM(m->ordered, elements),
                          PEL_ROOM(b->use_start, nodes + 1), PEL_ROOM(b->use_element, corners),
                          PEL_ROOM(b->use_corner, corners), PEL_ROOM(b->meet_start, nodes + 1),
                          PEL_ROOM(b->meet_coupling, 4 * (size_t)def->coupling_count), PEL_ROOM(b->stamp, nodes),
                          PEL_ROOM(b->key, elements), PEL_ROOM(b->sorted, elements), PEL_ROOM(b->piece, elements + 1),
                          PEL_ROOM(b->used, nodes), PEL_ROOM(b->counts, nodes + elements + CLASS_COUNT + 1)))
        return pel_fail_memory(error);
    return PEL_OK;
}

/* lists the elements at each node, ascending */
static void list_uses(builder *b)
{
    const pel_matrix *m = b->matrix;
    for (int32_t i = 0; i < m->node_count; i++) {
        b->use_start[i + 1] += b->use_start[i];
        b->stamp[i] = b->use_start[i];
    }
    for (int32_t e = 0; e < m->element_count; e++)
        for (int32_t i = m->node_start[e]; i < m->node_start[e + 1]; i++) {
            int32_t use = b->stamp[m->element_node[i]]++;
            b->use_element[use] = e;
            b->use_corner[use] = i - m->node_start[e];
        }
}

/* lists the couplings at each node */
static void list_meetings(builder *b)
{
    const pel_matrix_def *def = b->def;
    for (int32_t c = 0; c < def->coupling_count; c++)
        for (int i = 0; i < 4; i++)
            b->meet_start[def->couplings[c][i] + 1]++;
    for (int32_t i = 0; i < def->node_count; i++) {
        b->meet_start[i + 1] += b->meet_start[i];
        b->stamp[i] = b->meet_start[i];
    }
    for (int32_t c = 0; c < def->coupling_count; c++)
        for (int i = 0; i < 4; i++)
            b->meet_coupling[b->stamp[def->couplings[c][i]]++] = c;
}

/* adds those of some nodes to the columns of a row that are not there yet */
static int32_t add_columns(builder *b, const int32_t *nodes, int32_t node_count, int32_t mark, int32_t count,
                           int32_t *columns)
{
    for (int32_t i = 0; i < node_count; i++) {
        if (b->stamp[nodes[i]] == mark)
            continue;
        b->stamp[nodes[i]] = mark;
        if (columns != NULL)
            columns[count] = nodes[i];
        count++;
    }
    return count;
}

/* Writes the neighbours of a node and itself to columns (null: counts only); returns their number. The stamps of this
   round are round + node. */
static int32_t list_columns(builder *b, int32_t node, int32_t mark, int32_t *columns)
{
    const pel_matrix *m = b->matrix;
    int32_t count = add_columns(b, &node, 1, mark, 0, columns);
    for (int32_t use = b->use_start[node]; use < b->use_start[node + 1]; use++) {
        int32_t begin = m->node_start[b->use_element[use]], end = m->node_start[b->use_element[use] + 1];
        count = add_columns(b, &m->element_node[begin], end - begin, mark, count, columns);
    }
    for (int32_t k = b->meet_start[node]; k < b->meet_start[node + 1]; k++)
        count = add_columns(b, b->def->couplings[b->meet_coupling[k]], 4, mark, count, columns);
    return count;
}

/* places of the blocks of one row in the elements around its node */
static void place_row(builder *b, int32_t node)
{
    pel_matrix *m = b->matrix;
    for (int32_t block = m->row_start[node]; block < m->row_start[node + 1]; block++)
        b->stamp[m->column[block]] = m->block_start[block];
    for (int32_t use = b->use_start[node]; use < b->use_start[node + 1]; use++) {
        int32_t element = b->use_element[use], begin = m->node_start[element];
        int32_t count = m->node_start[element + 1] - begin;
        int32_t *places = &m->element_place[m->element_start[element] + b->use_corner[use] * count];
        for (int32_t i = 0; i < count; i++)
            places[i] = b->stamp[m->element_node[begin + i]];
    }
}

static pel_status build_rows(builder *b, pel_error *error)
{
    pel_matrix *m = b->matrix;
    int64_t block_count = 0;
    for (int32_t i = 0; i < m->node_count; i++)
        b->stamp[i] = -1;
    for (int32_t i = 0; i < m->node_count; i++) {
        block_count += list_columns(b, i, i, NULL);
        if (block_count * PEL_NODE_SIZE_LIMIT > INT32_MAX)
            return pel_fail(error, PEL_BAD_ARGUMENT, "the matrix is too large: more than 2^31 values");
        m->row_start[i + 1] = (int32_t)block_count;
    }
    m->block_count = (int32_t)block_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(m->column, block_count), PEL_ROOM(m->block_start, (size_t)block_count + 1),
                          PEL_ROOM(m->element_place, m->element_start[m->element_count])))
        return pel_fail_memory(error);
    int64_t values = 0;
    for (int32_t i = 0; i < m->node_count; i++) {
        int32_t *columns = &m->column[m->row_start[i]], count = list_columns(b, i, m->node_count + i, columns);
        pel_sort_int32(columns, count);
        for (int32_t k = 0; k < count; k++) {
            m->block_start[m->row_start[i] + k] = (int32_t)values;
            values += size_of(m, i) * size_of(m, columns[k]);
            if (values > INT32_MAX - OVERHANG)
                return pel_fail(error, PEL_BAD_ARGUMENT, "the matrix is too large: more than 2^31 values");
        }
    }
    m->block_start[block_count] = (int32_t)values;
    m->values = pel_allocate_aligned((size_t)values + OVERHANG, sizeof *m->values);
    if (m->values == NULL)
        return pel_fail_memory(error);
    for (int32_t i = 0; i < m->node_count; i++)
        place_row(b, i);
    return PEL_OK;
}

/* stable counting sort: writes items (null: 0, 1, ...) to sorted by ascending key (0 .. key_count - 1) of the item */
static void sort_by_key(const int32_t *items, int32_t count, const int32_t *key, int32_t key_count, int32_t *starts,
                        int32_t *sorted)
{
    memset(starts, 0, ((size_t)key_count + 1) * sizeof *starts);
    for (int32_t i = 0; i < count; i++)
        starts[key[i] + 1]++;
    for (int32_t k = 0; k < key_count; k++)
        starts[k + 1] += starts[k];
    for (int32_t i = 0; i < count; i++) {
        int32_t item = items == NULL ? i : items[i];
        sorted[starts[key[item]]++] = item;
    }
}

/* nodes of an element of the matrix under work, by its place in the sorted list */
static const int32_t *nodes_of(const builder *b, int32_t place, int32_t *count)
{
    const pel_matrix *m = b->matrix;
    int32_t element = b->sorted[place];
    *count = m->node_start[element + 1] - m->node_start[element];
    return &m->element_node[m->node_start[element]];
}

/* Sorts the elements by class (kind and size), then by their first node, and cuts each class into pieces: elements of a
   piece lie together as far as nodes with near numbers do. Leaves the classes in key. */
static int32_t cut_pieces(builder *b)
{
    pel_matrix *m = b->matrix;
    int32_t piece_count = 0;
    for (int32_t e = 0; e < m->element_count; e++) {
        b->key[e] = m->node_count - 1;
        for (int32_t i = m->node_start[e]; i < m->node_start[e + 1]; i++)
            b->key[e] = m->element_node[i] < b->key[e] ? m->element_node[i] : b->key[e];
    }
    sort_by_key(NULL, m->element_count, b->key, m->node_count, b->counts, m->ordered);
    for (int32_t e = 0; e < m->element_count; e++) {
        int32_t kind = b->def->element_kind == NULL ? 0 : b->def->element_kind[e];
        b->key[e] = kind * (PEL_ELEMENT_SIZE_LIMIT + 1) + element_size(m, e);
    }
    sort_by_key(m->ordered, m->element_count, b->key, CLASS_COUNT, b->counts, b->sorted);
    for (int32_t i = 0; i < m->element_count; i++)
        if (i == 0 || b->key[b->sorted[i]] != b->key[b->sorted[i - 1]] ||
            i - b->piece[piece_count - 1] == ELEMENTS_PER_PIECE)
            b->piece[piece_count++] = i;
    b->piece[piece_count] = m->element_count;
    return piece_count;
}

/* colors for as many of the pieces that have none (-1) as 64 colors allow; returns the number of those left */
static int32_t color_round(builder *b, int32_t piece_count, int32_t *colors)
{
    pel_matrix *m = b->matrix;
    int32_t left = 0, first_color = m->color_count, count;
    memset(b->used, 0, (size_t)m->node_count * sizeof *b->used);
    for (int32_t p = 0; p < piece_count; p++) {
        uint64_t used = 0;
        if (colors[p] >= 0)
            continue;
        for (int32_t i = b->piece[p]; i < b->piece[p + 1]; i++) {
            const int32_t *nodes = nodes_of(b, i, &count);
            for (int32_t k = 0; k < count; k++)
                used |= b->used[nodes[k]];
        }
        if (used == UINT64_MAX) {
            left++;
            continue;
        }
        int32_t color = __builtin_ctzll(~used);
        colors[p] = first_color + color;
        m->color_count = colors[p] + 1 > m->color_count ? colors[p] + 1 : m->color_count;
        for (int32_t i = b->piece[p]; i < b->piece[p + 1]; i++) {
            const int32_t *nodes = nodes_of(b, i, &count);
            for (int32_t k = 0; k < count; k++)
                b->used[nodes[k]] |= (uint64_t)1 << color;
        }
    }
    return left;
}

/* writes the pieces in the order of their colors, and the groups of each */
static pel_status group_elements(builder *b, pel_error *error)
{
    pel_matrix *m = b->matrix;
    m->piece_count = cut_pieces(b);
    int32_t *colors = b->key, *order = b->use_element;
    memset(colors, 0xff, (size_t)m->piece_count * sizeof *colors);
    while (color_round(b, m->piece_count, colors) > 0)
        ;
    sort_by_key(NULL, m->piece_count, colors, m->color_count, b->counts, order);
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(m->color_start, (size_t)m->color_count + 1),
                          PEL_ROOM(m->piece_start, (size_t)m->piece_count + 1),
                          PEL_ROOM(m->group_start, (size_t)m->element_count + 1)))
        return pel_fail_memory(error);
    int32_t count = 0;
    for (int32_t k = 0; k < m->piece_count; k++) {
        int32_t p = order[k];
        m->color_start[colors[p] + 1] = k + 1;
        m->piece_start[k] = m->group_count;
        for (int32_t i = b->piece[p]; i < b->piece[p + 1]; i++) {
            if ((i - b->piece[p]) % PEL_MATRIX_GROUP == 0)
                m->group_start[m->group_count++] = count;
            m->ordered[count++] = b->sorted[i];
        }
    }
    m->piece_start[m->piece_count] = m->group_count;
    m->group_start[m->group_count] = count;
    return PEL_OK;
}

pel_status pel_matrix_create(const pel_matrix_def *def, pel_matrix **matrix, pel_error *error)
{
    *matrix = NULL;
    pel_status status = check_def(def, error);
    if (status != PEL_OK)
        return status;
    builder b = {.def = def, .matrix = pel_allocate(1, sizeof(pel_matrix))};
    if (b.matrix == NULL)
        return pel_fail_memory(error);
    status = allocate_builder(&b, error);
    if (status == PEL_OK) {
        copy_elements(&b);
        list_uses(&b);
        list_meetings(&b);
        status = build_rows(&b, error);
    }
    if (status == PEL_OK)
        status = group_elements(&b, error);
    release_builder(&b);
    if (status != PEL_OK) {
        pel_matrix_destroy(b.matrix);
        return status;
    }
    PEL_ASSERT_WHOLE(pel_matrix_is_valid(b.matrix));
    *matrix = b.matrix;
    return PEL_OK;
}

/* one color of pieces on its way into the matrix */
typedef struct assembly {
    pel_matrix *matrix;
    pel_matrix_function *function;
    void *context;
    int32_t first_piece;
} assembly;

/* a block of 3 x 3 as two quads and its last number: most blocks are of this size */
static void add_three_by_three(double *block, const double *from, int32_t size)
{
    const double *next = from + size, *last = next + size;
    quad first = {from[0], from[1], from[2], next[0]}, second = {next[1], next[2], last[0], last[1]};
    *(quad *)block += first;
    *(quad *)(block + 4) += second;
    block[8] += last[2];
}

/* a block of one row or column */
static void add_line(double *block, const double *from, int32_t count)
{
    if (count == 3) {
        block[0] += from[0];
        block[1] += from[1];
        block[2] += from[2];
        return;
    }
    for (int32_t a = 0; a < count; a++)
        block[a] += from[a];
}

/* adds a block of a dense matrix, which is symmetric: a column of the block is a piece of one of its rows, and so is
   a block of one row */
static void add_block(double *block, const double *dense, int32_t size, int32_t row, int32_t column, int32_t rows,
                      int32_t columns)
{
    const double *from = dense + column * size + row;
    if (rows == 3 && columns == 3)
        add_three_by_three(block, from, size);
    else if (columns == 1)
        add_line(block, from, rows);
    else if (rows == 1)
        add_line(block, dense + row * size + column, columns);
    else
        for (int32_t b = 0; b < columns; b++)
            add_line(block + b * rows, from + b * size, rows);
}

/* adds a dense matrix (row-major, size x size) of one element at its places */
static void add_element(pel_matrix *m, int32_t element, int32_t size, const double *dense)
{
    PEL_ASSERT_INDEX(element, m->element_count);
    const int32_t *nodes = &m->element_node[m->node_start[element]],
                  *place = &m->element_place[m->element_start[element]];
    int32_t count = m->node_start[element + 1] - m->node_start[element], sizes[PEL_ELEMENT_SIZE_LIMIT];
    for (int32_t i = 0; i < count; i++)
        sizes[i] = size_of(m, nodes[i]);
    for (int32_t i = 0, row = 0; i < count; row += sizes[i], i++)
        for (int32_t j = 0, column = 0; j < count; column += sizes[j], j++)
            add_block(&m->values[*place++], dense, size, row, column, sizes[i], sizes[j]);
}

static void assemble_chunk(void *context, int32_t chunk)
{
    const assembly *a = context;
    pel_matrix *m = a->matrix;
    double blocks[PEL_MATRIX_GROUP * PEL_ELEMENT_SIZE_LIMIT * PEL_ELEMENT_SIZE_LIMIT];
    const int32_t *groups = &m->piece_start[a->first_piece + chunk];
    for (int32_t group = groups[0]; group < groups[1]; group++) {
        const int32_t *elements = &m->ordered[m->group_start[group]];
        int32_t count = m->group_start[group + 1] - m->group_start[group], size = element_size(m, elements[0]);
        a->function(a->context, elements, count, blocks);
        for (int32_t i = 0; i < count; i++)
            add_element(m, elements[i], size, &blocks[i * size * size]);
    }
}

void pel_matrix_assemble(pel_matrix *matrix, pel_pool *pool, pel_matrix_function *function, void *context)
{
    memset(matrix->values, 0, (size_t)matrix->block_start[matrix->block_count] * sizeof *matrix->values);
    for (int32_t color = 0; color < matrix->color_count; color++) {
        assembly a = {matrix, function, context, matrix->color_start[color]};
        pel_pool_run(pool, matrix->color_start[color + 1] - a.first_piece, assemble_chunk, &a);
    }
}

int32_t pel_matrix_block(const pel_matrix *matrix, int32_t row, int32_t column)
{
    PEL_ASSERT_INDEX(column, matrix->node_count);
    PEL_ASSERT_INDEX(row, matrix->node_count);
    int32_t low = matrix->row_start[row], high = matrix->row_start[row + 1] - 1;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (matrix->column[middle] < column)
            low = middle + 1;
        else
            high = middle;
    }
    return matrix->column[low] == column ? low : -1;
}

void pel_matrix_add_diagonal(pel_matrix *matrix, double factor, const double *diagonal)
{
    for (int32_t i = 0; i < matrix->node_count; i++) {
        int32_t first = matrix->first_unknown[i], size = size_of(matrix, i);
        double *block = &matrix->values[matrix->block_start[pel_matrix_block(matrix, i, i)]];
        for (int32_t a = 0; a < size; a++)
            block[a * (size + 1)] += factor * (diagonal == NULL ? 1 : diagonal[first + a]);
    }
}

static int32_t chunks_of(const pel_matrix *matrix)
{
    return (matrix->node_count + ROWS_PER_CHUNK - 1) / ROWS_PER_CHUNK;
}

static int32_t end_of_chunk(const pel_matrix *matrix, int32_t chunk)
{
    int32_t end = (chunk + 1) * ROWS_PER_CHUNK;
    return end < matrix->node_count ? end : matrix->node_count;
}

typedef struct fixing {
    pel_matrix *matrix;
    const uint8_t *fixed;
    const double *value;
    double *right;
} fixing;

/* zeroes what is fixed of one entry, and moves its share of known unknowns to the right side */
static void fix_entry(const fixing *f, int32_t row, int32_t column, double *entry)
{
    if (!f->fixed[row] && !f->fixed[column])
        return;
    if (row == column) {
        *entry = *entry > 0 ? *entry : 1;
        if (f->value != NULL)
            f->right[row] = *entry * f->value[row];
        return;
    }
    if (f->value != NULL && !f->fixed[row])
        f->right[row] -= *entry * f->value[column];
    *entry = 0;
}

static bool has_fixed(const fixing *f, int32_t node)
{
    uint8_t any = 0;
    for (int32_t u = f->matrix->first_unknown[node]; u < f->matrix->first_unknown[node + 1]; u++)
        any |= f->fixed[u];
    return any != 0;
}

static void fix_chunk(void *context, int32_t chunk)
{
    const fixing *f = context;
    const pel_matrix *m = f->matrix;
    int32_t end = end_of_chunk(m, chunk);
    for (int32_t i = chunk * ROWS_PER_CHUNK; i < end; i++) {
        bool is_fixed = has_fixed(f, i);
        for (int32_t block = m->row_start[i]; block < m->row_start[i + 1]; block++) {
            int32_t j = m->column[block], rows = size_of(m, i), columns = size_of(m, j);
            double *entry = &m->values[m->block_start[block]];
            if (!is_fixed && !has_fixed(f, j))
                continue;
            for (int32_t b = 0; b < columns; b++)
                for (int32_t a = 0; a < rows; a++)
                    fix_entry(f, m->first_unknown[i] + a, m->first_unknown[j] + b, entry++);
        }
    }
}

void pel_matrix_fix(pel_matrix *matrix, pel_pool *pool, const uint8_t *fixed, const double *value, double *right)
{
    PEL_ASSERT((value == NULL) == (right == NULL));
    fixing f = {matrix, fixed, value, right};
    pel_pool_run(pool, chunks_of(matrix), fix_chunk, &f);
}

typedef struct turning {
    pel_matrix *matrix;
    const int32_t *frame;
    const double (*axes)[3][3];
} turning;

/* three numbers, `stride` apart, along the axes */
static void turn_triple(const double axes[3][3], double *x, int32_t stride)
{
    const double a = x[0], b = x[stride], c = x[2 * (size_t)stride];
    for (int k = 0; k < 3; k++)
        x[k * stride] = axes[k][0] * a + axes[k][1] * b + axes[k][2] * c;
}

static void turn_chunk(void *context, int32_t chunk)
{
    const turning *t = context;
    const pel_matrix *m = t->matrix;
    int32_t end = end_of_chunk(m, chunk);
    for (int32_t i = chunk * ROWS_PER_CHUNK; i < end; i++)
        for (int32_t block = m->row_start[i]; block < m->row_start[i + 1]; block++) {
            int32_t j = m->column[block], rows = size_of(m, i), columns = size_of(m, j);
            double *values = &m->values[m->block_start[block]];
            for (int32_t b = 0; t->frame[i] >= 0 && b < columns; b++)
                turn_triple(t->axes[t->frame[i]], values + rows * b, 1);
            for (int32_t a = 0; t->frame[j] >= 0 && a < rows; a++)
                turn_triple(t->axes[t->frame[j]], values + a, rows);
        }
}

void pel_matrix_turn(pel_matrix *matrix, pel_pool *pool, const int32_t *frame, const double (*axes)[3][3])
{
    turning t = {matrix, frame, axes};
    pel_pool_run(pool, chunks_of(matrix), turn_chunk, &t);
}

typedef struct product {
    const pel_matrix *matrix;
    const double *x;
    double *y;
} product;

/* a row of nodes of three unknowns: its values are columns of three, loaded four at a time */
static void multiply_row3(const pel_matrix *m, int32_t row, const double *x, double *y)
{
    PEL_ASSERT_INDEX(row, m->node_count);
    quad even = {0}, odd = {0}, third = {0};
    const double *values = &m->values[m->block_start[m->row_start[row]]];
    for (int32_t block = m->row_start[row]; block < m->row_start[row + 1]; block++) {
        int32_t first = m->first_unknown[m->column[block]], end = m->first_unknown[m->column[block] + 1];
        if (end - first == 3) {
            even += *(const quad *)values * x[first];
            odd += *(const quad *)(values + 3) * x[first + 1];
            third += *(const quad *)(values + 6) * x[first + 2];
            values += 9;
            continue;
        }
        for (int32_t u = first; u < end; u++, values += 3)
            even += *(const quad *)values * x[u];
    }
    even += odd + third;
    y[0] = even[0];
    y[1] = even[1];
    y[2] = even[2];
}

/* a row of one unknown: its values lie as its columns do */
static double multiply_row1(const pel_matrix *m, int32_t row, const double *x)
{
    PEL_ASSERT_INDEX(row, m->node_count);
    double sum = 0;
    const double *values = &m->values[m->block_start[m->row_start[row]]];
    for (int32_t block = m->row_start[row]; block < m->row_start[row + 1]; block++) {
        const double *part = &x[m->first_unknown[m->column[block]]];
        int32_t size = size_of(m, m->column[block]);
        if (size == 3)
            sum += (values[0] * part[0] + values[1] * part[1]) + values[2] * part[2];
        else
            for (int32_t b = 0; b < size; b++)
                sum += values[b] * part[b];
        values += size;
    }
    return sum;
}

static void multiply_row(const pel_matrix *m, int32_t row, int32_t size, const double *x, double *y)
{
    PEL_ASSERT_INDEX(row, m->node_count);
    double sum[PEL_NODE_SIZE_LIMIT] = {0};
    const double *values = &m->values[m->block_start[m->row_start[row]]];
    for (int32_t block = m->row_start[row]; block < m->row_start[row + 1]; block++)
        for (int32_t u = m->first_unknown[m->column[block]]; u < m->first_unknown[m->column[block] + 1]; u++)
            for (int32_t a = 0; a < size; a++)
                sum[a] += *values++ * x[u];
    memcpy(y, sum, (size_t)size * sizeof *y);
}

static void multiply_chunk(void *context, int32_t chunk)
{
    const product *p = context;
    const pel_matrix *m = p->matrix;
    int32_t end = end_of_chunk(m, chunk);
    for (int32_t i = chunk * ROWS_PER_CHUNK; i < end; i++) {
        int32_t size = size_of(m, i);
        if (size == 3)
            multiply_row3(m, i, p->x, &p->y[m->first_unknown[i]]);
        else if (size == 1)
            p->y[m->first_unknown[i]] = multiply_row1(m, i, p->x);
        else
            multiply_row(m, i, size, p->x, &p->y[m->first_unknown[i]]);
    }
}

void pel_matrix_multiply(const pel_matrix *matrix, pel_pool *pool, const double *x, double *y)
{
    PEL_ASSERT(x != y);
    product p = {matrix, x, y};
    pel_pool_run(pool, chunks_of(matrix), multiply_chunk, &p);
}
