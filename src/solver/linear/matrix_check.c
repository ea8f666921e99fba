/* The whole of a pattern, checked. */
#include "base/memory.h"
#include "base/room.h"
#include "linear/matrix.h"

typedef struct check {
    const pel_matrix *matrix;
    uint8_t *is_summed; /* (element_count) */
    int32_t *piece;     /* (node_count) the piece that had a node last, plus 1 */
} check;

/* starts of what has one member at least rise from 0 to `end` */
static bool check_starts(const int32_t *starts, int32_t count, int32_t end)
{
    for (int32_t i = 0; i < count; i++)
        if (starts[i + 1] <= starts[i])
            return false;
    return starts[0] == 0 && starts[count] == end;
}

static int32_t size_of(const pel_matrix *m, int32_t node)
{
    return m->first_unknown[node + 1] - m->first_unknown[node];
}

static bool check_row(const pel_matrix *m, int32_t row)
{
    bool has_diagonal = false;
    for (int32_t block = m->row_start[row]; block < m->row_start[row + 1]; block++) {
        int32_t column = m->column[block];
        if (column < 0 || column >= m->node_count || (block > m->row_start[row] && column <= m->column[block - 1]))
            return false;
        if (m->block_start[block + 1] != (int64_t)m->block_start[block] + size_of(m, row) * size_of(m, column))
            return false;
        has_diagonal |= column == row;
    }
    return has_diagonal;
}

static bool check_rows(const pel_matrix *m)
{
    if (!check_starts(m->first_unknown, m->node_count, m->unknown_count) ||
        !check_starts(m->row_start, m->node_count, m->block_count) || m->block_start[0] != 0)
        return false;
    for (int32_t i = 0; i < m->node_count; i++)
        if (size_of(m, i) > PEL_NODE_SIZE_LIMIT || !check_row(m, i))
            return false;
    for (int32_t i = 0; i < m->node_count; i++)
        for (int32_t block = m->row_start[i]; block < m->row_start[i + 1]; block++)
            if (pel_matrix_block(m, m->column[block], i) < 0)
                return false;
    return true;
}

static bool check_element(const pel_matrix *m, int32_t e)
{
    const int32_t *nodes = m->element_node + m->node_start[e], *places = m->element_place + m->element_start[e];
    int64_t count = (int64_t)m->node_start[e + 1] - m->node_start[e];
    if (count < 1 || count > PEL_ELEMENT_SIZE_LIMIT || m->element_start[e + 1] != m->element_start[e] + count * count)
        return false;
    for (int64_t i = 0; i < count; i++)
        if (nodes[i] < 0 || nodes[i] >= m->node_count)
            return false;
    for (int64_t i = 0; i < count; i++)
        for (int64_t k = 0; k < count; k++) {
            int32_t block = pel_matrix_block(m, nodes[i], nodes[k]);
            if (block < 0 || places[i * count + k] != m->block_start[block])
                return false;
        }
    return true;
}

/* the elements of a piece: none was summed before, and no other piece from `first` on has their nodes */
static bool check_piece(const check *c, int32_t piece, int32_t first)
{
    const pel_matrix *m = c->matrix;
    int32_t end = m->group_start[m->piece_start[piece + 1]];
    for (int32_t i = m->group_start[m->piece_start[piece]]; i < end; i++) {
        int32_t e = m->ordered[i];
        if (e < 0 || e >= m->element_count || c->is_summed[e] != 0)
            return false;
        c->is_summed[e] = 1;
        for (int32_t k = m->node_start[e]; k < m->node_start[e + 1]; k++) {
            int32_t *seen = &c->piece[m->element_node[k]];
            if (*seen > first && *seen != piece + 1)
                return false;
            *seen = piece + 1;
        }
    }
    return true;
}

static bool check_sums(const check *c)
{
    const pel_matrix *m = c->matrix;
    if (!check_starts(m->color_start, m->color_count, m->piece_count) ||
        !check_starts(m->piece_start, m->piece_count, m->group_count) ||
        !check_starts(m->group_start, m->group_count, m->element_count))
        return false;
    for (int32_t g = 0; g < m->group_count; g++)
        if (m->group_start[g + 1] - m->group_start[g] > PEL_MATRIX_GROUP)
            return false;
    for (int32_t color = 0; color < m->color_count; color++)
        for (int32_t p = m->color_start[color]; p < m->color_start[color + 1]; p++)
            if (!check_piece(c, p, m->color_start[color]))
                return false;
    return true;
}

static bool check_elements(const pel_matrix *m)
{
    if (m->node_start[0] != 0 || m->element_start[0] != 0)
        return false;
    for (int32_t e = 0; e < m->element_count; e++)
        if (!check_element(m, e))
            return false;
    return true;
}

bool pel_matrix_is_valid(const pel_matrix *matrix)
{
    check c = {.matrix = matrix};
    bool has_room =
        PEL_ALLOCATE_ALL(PEL_ROOM(c.is_summed, matrix->element_count), PEL_ROOM(c.piece, matrix->node_count));
    bool good = !has_room || (check_rows(matrix) && check_elements(matrix) && check_sums(&c));
    PEL_FREE_ALL(c.is_summed, c.piece);
    return good;
}
