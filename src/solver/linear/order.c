#include "linear/order.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/patience.h"
#include "base/room.h"
#include "base/sort.h"
#include "base/status.h"

#include <math.h>
#include <string.h>

/* A leaf has at most LEAF_LIMIT nodes. Minimum degree looks at them and at up to SEEN_LIMIT nodes together with those
   around the leaf, in bit sets. */
enum { LEAF_LIMIT = 64, SEEN_LIMIT = 256, WORDS = SEEN_LIMIT / 64 };

/* a node and the number it is ranked by */
typedef struct ranked {
    double value;
    int32_t node;
} ranked;

static inline int ranks_before(const ranked *a, const ranked *b)
{
    return a->value < b->value || (a->value == b->value && a->node < b->node);
}

PEL_DEFINE_SORT(sort_ranked, ranked, ranks_before)

typedef struct dissection {
    const pel_matrix *matrix;
    const double (*coordinates)[3]; /* null: graph distances */
    int32_t *order;                 /* (node_count) nodes; a part is a range of it */
    int32_t *part;                  /* (node_count) which part a node is in */
    int32_t part_count;             /* parts named so far */
    ranked *ranks;                  /* (node_count) scratch of one part, like all below */
    uint8_t *side;                  /* 0 left, 1 right, 2 separator */
    int32_t *match, *stamp, *queue; /* matching of the cut; marks of one search; nodes to visit */
    int32_t *distance[2];           /* graph distances from two ends of a part */
    int32_t searches;               /* marks used so far */
} dissection;

static bool is_inside(const dissection *d, int32_t node, int32_t part)
{
    PEL_ASSERT_INDEX(node, d->matrix->node_count);
    return d->part[node] == part;
}

/* puts the `middle` smallest first (quickselect; no two ranks are equal) */
static void select_smallest(ranked *ranks, int32_t count, int32_t middle)
{
    PEL_ASSERT(middle >= 0 && middle <= count);
    int32_t low = 0, high = count - 1;
    while (low < high) {
        ranked pivot = ranks[low + (high - low) / 2];
        int32_t i = low, j = high;
        while (i <= j) {
            while (ranks_before(&ranks[i], &pivot))
                i++;
            while (ranks_before(&pivot, &ranks[j]))
                j--;
            if (i <= j) {
                ranked swapped = ranks[i];
                ranks[i++] = ranks[j];
                ranks[j--] = swapped;
            }
        }
        if (middle <= j)
            high = j;
        else if (middle >= i)
            low = i;
        else
            return;
    }
}

/* graph distances within a part from a node; returns a farthest one. Nodes that are not reached are far. */
static int32_t search_breadth(dissection *d, int32_t begin, int32_t end, int32_t from, int32_t *distance)
{
    PEL_ASSERT(begin < end && end <= d->matrix->node_count);
    PEL_ASSERT_INDEX(from, d->matrix->node_count);
    const pel_matrix *m = d->matrix;
    int32_t head = 0, tail = 0, part = d->part[from];
    for (int32_t i = begin; i < end; i++)
        distance[d->order[i]] = m->node_count;
    distance[from] = 0;
    d->queue[tail++] = from;
    while (head < tail) {
        int32_t node = d->queue[head++];
        for (int32_t block = m->row_start[node]; block < m->row_start[node + 1]; block++) {
            int32_t other = m->column[block];
            if (!is_inside(d, other, part) || distance[other] < m->node_count)
                continue;
            distance[other] = distance[node] + 1;
            d->queue[tail++] = other;
        }
    }
    return d->queue[tail - 1];
}

/* direction of the largest extent (power iteration on the covariance) */
static void principal_axis(const dissection *d, int32_t begin, int32_t end, double axis[3])
{
    PEL_ASSERT(begin >= 0 && begin <= end && end <= d->matrix->node_count);
    double mean[3] = {0}, c[3][3] = {{0}};
    for (int32_t i = begin; i < end; i++)
        for (int k = 0; k < 3; k++)
            mean[k] += d->coordinates[d->order[i]][k] / (end - begin);
    for (int32_t i = begin; i < end; i++)
        for (int k = 0; k < 3; k++)
            for (int l = 0; l < 3; l++)
                c[k][l] += (d->coordinates[d->order[i]][k] - mean[k]) * (d->coordinates[d->order[i]][l] - mean[l]);
    axis[0] = 1;
    axis[1] = 0.7;
    axis[2] = 0.4;
    for (int round = 0; round < 20; round++) {
        double next[3], length = 0;
        for (int k = 0; k < 3; k++) {
            next[k] = c[k][0] * axis[0] + c[k][1] * axis[1] + c[k][2] * axis[2];
            length += next[k] * next[k];
        }
        if (!(length > 0))
            return;
        for (int k = 0; k < 3; k++)
            axis[k] = next[k] / sqrt(length);
    }
}

/* sides of the halves of a part along an axis, or by graph distance when it is null */
static void halve(dissection *d, int32_t begin, int32_t end, const double axis[3])
{
    PEL_ASSERT(begin >= 0 && begin <= end && end <= d->matrix->node_count);
    int32_t count = end - begin;
    for (int32_t i = 0; i < count; i++) {
        int32_t node = d->order[begin + i];
        d->ranks[i].node = node;
        if (axis == NULL)
            d->ranks[i].value = d->distance[0][node] - d->distance[1][node];
        else
            d->ranks[i].value = d->coordinates[node][0] * axis[0] + d->coordinates[node][1] * axis[1] +
                                d->coordinates[node][2] * axis[2];
    }
    select_smallest(d->ranks, count, count / 2);
    for (int32_t i = 0; i < count; i++)
        d->side[d->ranks[i].node] = i >= count / 2;
}

/* unknowns on the smaller bank of the cut */
static int32_t bank_size(const dissection *d, int32_t begin, int32_t end)
{
    const pel_matrix *m = d->matrix;
    int32_t part = d->part[d->order[begin]], sizes[2] = {0, 0};
    for (int32_t i = begin; i < end; i++) {
        int32_t node = d->order[i], side = d->side[node];
        for (int32_t block = m->row_start[node]; block < m->row_start[node + 1]; block++) {
            int32_t other = m->column[block];
            if (is_inside(d, other, part) && d->side[other] != side) {
                sizes[side] += m->first_unknown[node + 1] - m->first_unknown[node];
                break;
            }
        }
    }
    return sizes[0] < sizes[1] ? sizes[0] : sizes[1];
}

/* Looks for an augmenting path of the matching across the cut from a left node, and flips it (breadth first: match of
   right nodes; queue holds left nodes, parents in distance[1] of right nodes). False when there is none; then all
   nodes on alternating paths are stamped. */
static bool augment(dissection *d, int32_t from, int32_t mark)
{
    const pel_matrix *m = d->matrix;
    int32_t head = 0, tail = 0, part = d->part[from], *parent = d->distance[1];
    d->stamp[from] = mark;
    d->queue[tail++] = from;
    while (head < tail) {
        int32_t left = d->queue[head++];
        for (int32_t block = m->row_start[left]; block < m->row_start[left + 1]; block++) {
            int32_t right = m->column[block];
            if (!is_inside(d, right, part) || d->side[right] != 1 || d->stamp[right] == mark)
                continue;
            d->stamp[right] = mark;
            parent[right] = left;
            if (d->match[right] >= 0) {
                d->stamp[d->match[right]] = mark;
                d->queue[tail++] = d->match[right];
                continue;
            }
            for (int32_t node = right; node >= 0;) {
                int32_t l = parent[node], next = d->match[l];
                d->match[node] = l;
                d->match[l] = node;
                node = next;
            }
            return true;
        }
    }
    return false;
}

/* matches each left node to a free right neighbour, if it has one */
static void match_greedily(dissection *d, int32_t begin, int32_t end)
{
    PEL_ASSERT(begin >= 0 && begin <= end && end <= d->matrix->node_count);
    const pel_matrix *m = d->matrix;
    int32_t part = d->part[d->order[begin]];
    for (int32_t i = begin; i < end; i++)
        d->match[d->order[i]] = -1;
    for (int32_t i = begin; i < end; i++) {
        int32_t node = d->order[i];
        for (int32_t block = m->row_start[node]; block < m->row_start[node + 1] && d->side[node] == 0; block++) {
            int32_t other = m->column[block];
            if (!is_inside(d, other, part) || d->side[other] != 1 || d->match[other] >= 0)
                continue;
            d->match[node] = other;
            d->match[other] = node;
            break;
        }
    }
}

/* true when a left node has a neighbour on the right */
static bool is_on_cut(const dissection *d, int32_t node)
{
    PEL_ASSERT_INDEX(node, d->matrix->node_count);
    const pel_matrix *m = d->matrix;
    for (int32_t block = m->row_start[node]; block < m->row_start[node + 1]; block++)
        if (d->part[m->column[block]] == d->part[node] && d->side[m->column[block]] == 1)
            return true;
    return false;
}

/* Makes the smallest set of nodes that covers the cut edges the separator: of a maximum matching, the left nodes that
   no alternating path from a free left node reaches, and the right nodes that one reaches. */
static void cover_cut(dissection *d, int32_t begin, int32_t end)
{
    PEL_ASSERT(begin >= 0 && begin <= end && end <= d->matrix->node_count);
    match_greedily(d, begin, end);
    for (int32_t i = begin; i < end; i++) {
        int32_t node = d->order[i];
        if (d->side[node] == 0 && d->match[node] < 0 && is_on_cut(d, node))
            augment(d, node, ++d->searches);
    }
    /* free left nodes that are left have no augmenting path: one mark for all of them */
    int32_t mark = ++d->searches;
    for (int32_t i = begin; i < end; i++) {
        int32_t node = d->order[i];
        if (d->side[node] == 0 && d->match[node] < 0 && d->stamp[node] != mark)
            augment(d, node, mark);
    }
    for (int32_t i = begin; i < end; i++) {
        int32_t node = d->order[i];
        if (d->match[node] >= 0 && (d->side[node] == 0) != (d->stamp[node] == mark))
            d->side[node] = (uint8_t)(d->side[node] | 2);
    }
}

/* sorts a separator along its largest extent, so that the borders of fronts below are contiguous pieces of it */
static void sort_separator(dissection *d, int32_t begin, int32_t end)
{
    PEL_ASSERT(begin >= 0 && begin <= end && end <= d->matrix->node_count);
    if (d->coordinates == NULL || end - begin < 3)
        return;
    double axis[3];
    principal_axis(d, begin, end, axis);
    for (int32_t i = begin; i < end; i++) {
        const double *x = d->coordinates[d->order[i]];
        d->ranks[i - begin] = (ranked){x[0] * axis[0] + x[1] * axis[1] + x[2] * axis[2], d->order[i]};
    }
    sort_ranked(d->ranks, (size_t)(end - begin));
    for (int32_t i = begin; i < end; i++)
        d->order[i] = d->ranks[i - begin].node;
}

/* minimum degree over a leaf and the nodes around it */
typedef struct leaf {
    int32_t count, seen_count;
    int32_t nodes[LEAF_LIMIT];
    uint64_t neighbors[LEAF_LIMIT][WORDS];
} leaf;

static int32_t degree_of(const uint64_t set[WORDS])
{
    int32_t degree = 0;
    for (int w = 0; w < WORDS; w++)
        degree += __builtin_popcountll(set[w]);
    return degree;
}

static void read_leaf(dissection *d, int32_t begin, int32_t end, leaf *l)
{
    const pel_matrix *m = d->matrix;
    int32_t mark = ++d->searches, *place = d->distance[0];
    l->count = l->seen_count = end - begin;
    memset(l->neighbors, 0, sizeof l->neighbors);
    for (int32_t i = 0; i < l->count; i++) {
        l->nodes[i] = d->order[begin + i];
        place[l->nodes[i]] = i;
        d->stamp[l->nodes[i]] = mark;
    }
    for (int32_t i = 0; i < l->count; i++)
        for (int32_t block = m->row_start[l->nodes[i]]; block < m->row_start[l->nodes[i] + 1]; block++) {
            int32_t other = m->column[block];
            if (d->stamp[other] != mark) {
                /* a separator around the leaf; other leaves do not touch this one */
                place[other] = l->seen_count < SEEN_LIMIT ? l->seen_count++ : SEEN_LIMIT;
                d->stamp[other] = mark;
            }
            if (place[other] < SEEN_LIMIT && place[other] != i)
                l->neighbors[i][place[other] / 64] |= (uint64_t)1 << place[other] % 64;
        }
}

static void order_leaf(dissection *d, int32_t begin, int32_t end)
{
    PEL_ASSERT(begin >= 0 && begin <= end && end <= d->matrix->node_count);
    leaf l;
    read_leaf(d, begin, end, &l);
    uint64_t left = l.count == 64 ? UINT64_MAX : ((uint64_t)1 << l.count) - 1;
    int32_t degrees[LEAF_LIMIT];
    for (int32_t i = 0; i < l.count; i++)
        degrees[i] = degree_of(l.neighbors[i]);
    for (int32_t k = begin; k < end; k++) {
        int32_t next = -1;
        for (uint64_t rest = left; rest != 0; rest &= rest - 1) {
            int32_t i = __builtin_ctzll(rest);
            if (next < 0 || degrees[i] < degrees[next])
                next = i;
        }
        d->order[k] = l.nodes[next];
        left &= ~((uint64_t)1 << next);
        /* what the node saw becomes a clique */
        for (uint64_t rest = l.neighbors[next][0] & left; rest != 0; rest &= rest - 1) {
            int32_t i = __builtin_ctzll(rest);
            for (int w = 0; w < WORDS; w++)
                l.neighbors[i][w] |= l.neighbors[next][w];
            l.neighbors[i][0] &= ~((uint64_t)1 << next) & ~((uint64_t)1 << i);
            degrees[i] = degree_of(l.neighbors[i]);
        }
    }
}

/* splits a part along the best of some directions */
static void split(dissection *d, int32_t begin, int32_t end)
{
    PEL_ASSERT(begin >= 0 && begin <= end && end <= d->matrix->node_count);
    if (d->coordinates == NULL) {
        int32_t first = search_breadth(d, begin, end, d->order[begin], d->distance[0]);
        int32_t last = search_breadth(d, begin, end, first, d->distance[0]);
        search_breadth(d, begin, end, last, d->distance[1]);
        halve(d, begin, end, NULL);
    } else {
        double axes[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        int best = 0, last = 3;
        int32_t least = INT32_MAX;
        principal_axis(d, begin, end, axes[3]);
        for (int k = 0; k < 4; k++) {
            halve(d, begin, end, axes[k]);
            int32_t size = bank_size(d, begin, end);
            if (size < least) {
                least = size;
                best = k;
            }
        }
        if (best != last)
            halve(d, begin, end, axes[best]);
    }
    cover_cut(d, begin, end);
}

/* writes left, right and separator one after the other; ends[0] and [1] are where the first two end */
static void part_sides(dissection *d, int32_t begin, int32_t end, int32_t ends[2])
{
    int32_t counts[3] = {0, 0, 0};
    for (int32_t i = begin; i < end; i++) {
        int32_t node = d->order[i];
        d->queue[i - begin] = node;
        counts[d->side[node] < 2 ? d->side[node] : 2]++;
    }
    ends[0] = begin + counts[0];
    ends[1] = ends[0] + counts[1];
    int32_t next[3] = {begin, ends[0], ends[1]}, first_part = d->part_count;
    d->part_count += 3;
    for (int32_t i = 0; i < end - begin; i++) {
        int32_t node = d->queue[i], side = d->side[node] < 2 ? d->side[node] : 2;
        d->order[next[side]++] = node;
        d->part[node] = first_part + side;
    }
}

static void dissect(dissection *d, int32_t begin, int32_t end)
{
    PEL_ASSERT(begin >= 0 && begin <= end && end <= d->matrix->node_count);
    if (end - begin <= LEAF_LIMIT) {
        order_leaf(d, begin, end);
        return;
    }
    int32_t ends[2];
    if (pel_patience_is_lost())
        return;
    split(d, begin, end);
    part_sides(d, begin, end, ends);
    sort_separator(d, ends[1], end);
    dissect(d, begin, ends[0]);
    dissect(d, ends[0], ends[1]);
}

pel_status pel_vertex_order_nodes(const pel_matrix *matrix, const double (*coordinates)[3], int32_t *order,
                                  pel_error *error)
{
    size_t count = (size_t)matrix->node_count;
    dissection d = {.matrix = matrix, .coordinates = coordinates, .order = order, .part_count = 1};
    d.ranks = pel_allocate(count, sizeof *d.ranks);
    d.side = pel_allocate(count, sizeof *d.side);
    int32_t *numbers = pel_allocate(6 * count, sizeof *numbers);
    bool has_memory = d.ranks != NULL && d.side != NULL && numbers != NULL;
    if (has_memory) {
        d.part = numbers;
        d.match = numbers + count;
        d.stamp = numbers + 2 * count;
        d.queue = numbers + 3 * count;
        d.distance[0] = numbers + 4 * count;
        d.distance[1] = numbers + 5 * count;
        for (int32_t i = 0; i < matrix->node_count; i++)
            order[i] = i;
        dissect(&d, 0, matrix->node_count);
    }
    PEL_FREE_ALL(d.ranks, d.side, numbers);
    return has_memory && !pel_patience_is_lost() ? PEL_OK : pel_fail_memory(error);
}
