#include "tool/search.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/sort.h"
#include "base/status.h"

#include <string.h>

/* vertices of a block: 8 give twice as many boxes, 32 twice as many triangles in the boxes near a tool */
enum { BLOCK = 16 };
/* vertices of a body up to which blocks are rings, in the model's breadth-first order: on a ball of 252 vertices a tool
   is near 5 of 16, else 10 */
enum { SMALL = 1024 };
/* blocks that a list names at most; where triangles reach to more, the box is made from them */
enum { BESIDE_LIMIT = 16 };

static int32_t block_count_of(int32_t vertex_count)
{
    return (vertex_count + BLOCK - 1) / BLOCK;
}

/* ---- lists ---- */

static void link_triangle(pel_tool_search *search, int32_t t)
{
    const int32_t *v = search->model->triangles[t];
    int32_t owner = v[0] > v[1] ? v[0] : v[1];
    owner = v[2] > owner ? v[2] : owner;
    search->owner[t] = owner;
    search->next[t] = search->first[owner];
    search->first[owner] = t;
    search->is_stale[search->block[owner]] = 1;
}

static void unlink_triangle(pel_tool_search *search, int32_t t)
{
    int32_t *at = &search->first[search->owner[t]];
    while (*at != t)
        at = &search->next[*at];
    *at = search->next[t];
    search->owner[t] = -1;
}

void pel_tool_search_update(pel_tool_search *search, int32_t body)
{
    if (search == NULL)
        return;
    const pel_front *front = search->model->bodies[body].front;
    for (int32_t c = 0; c < front->change_count; c++)
        for (int32_t half = 0; half < 2; half++) {
            int32_t node = front->changes[c].node, t = search->model->triangle_begin[body] + 2 * node + half;
            if (search->owner[t] >= 0)
                unlink_triangle(search, t);
            if (front->place_of_node[node][half] >= 0)
                link_triangle(search, t);
        }
    search->is_fitted = false;
}

void pel_tool_search_rebuild(pel_tool_search *search, int32_t body)
{
    if (search == NULL)
        return;
    const pel_model *model = search->model;
    int32_t first = search->bodies[body].first_place, end = pel_body_place_end(model, body);
    for (int32_t t = model->triangle_begin[body]; t < model->triangle_begin[body + 1]; t++)
        search->owner[t] = -1;
    for (int32_t v = first; v < end; v++)
        search->first[v] = -1;
    for (int32_t i = 0; i < pel_surface_count(model, body); i++)
        link_triangle(search, pel_surface_triangle(model, body, i));
    search->is_fitted = false;
}

/* ---- boxes ---- */

static pel_search_box empty_box(void)
{
    const pel_real far = (pel_real)HUGE_VAL;
    const pel_record none = {far, far, far, far};
    return (pel_search_box){none, -none};
}

static void add_point(pel_search_box *box, pel_record x)
{
    box->low = pel_record_min(x, box->low);
    box->high = pel_record_max(x, box->high);
}

/* ---- creation ---- */

static void lay_out(pel_tool_search *search)
{
    const pel_model *model = search->model;
    int32_t count = 0;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b];
        pel_search_body *own = &search->bodies[b];
        int32_t base_slices = (body->mesh->vertex_count + PEL_WIDTH - 1) / PEL_WIDTH;
        own->first_place = body->slice_begin * PEL_WIDTH;
        own->fine_place = own->first_place + base_slices * PEL_WIDTH;
        own->block_begin = count;
        own->block_fine = count += block_count_of(body->mesh->vertex_count);
        own->block_end = count += block_count_of(pel_body_place_end(model, b) - own->fine_place);
    }
    search->block_count = count;
}

/* puts the `rank` least of the keys, which differ, before the others */
static void divide_keys(uint64_t *keys, int32_t count, int32_t rank)
{
    int32_t low = 0, high = count - 1;
    while (low < high) {
        uint64_t pivot = keys[low + (high - low) / 2];
        int32_t i = low, k = high;
        while (i <= k) {
            while (keys[i] < pivot)
                i++;
            while (keys[k] > pivot)
                k--;
            if (i <= k) {
                uint64_t swap = keys[i];
                keys[i++] = keys[k];
                keys[k--] = swap;
            }
        }
        if (rank <= k)
            high = k;
        else if (rank >= i)
            low = i;
        else
            return;
    }
}

/* Orders vertices, the low halves of the keys, so that each block of them is compact: halves them across the longest
   side of their box until a block is left. */
static void order_by_place(const pel_record *x, uint64_t *keys, int32_t count)
{
    while (count > BLOCK) {
        pel_search_box box = empty_box();
        for (int32_t i = 0; i < count; i++)
            add_point(&box, x[keys[i] & UINT32_MAX]);
        pel_record size = box.high - box.low;
        int axis = size[0] > size[1] ? 0 : 1;
        axis = size[2] > size[axis] ? 2 : axis;
        const double scale = size[axis] > 0 ? INT32_MAX / (double)size[axis] : 0;
        for (int32_t i = 0; i < count; i++) {
            uint64_t v = keys[i] & UINT32_MAX;
            keys[i] = (uint64_t)(scale * (double)(x[v][axis] - box.low[axis])) << 32 | v;
        }
        int32_t half = block_count_of(count) / 2 * BLOCK;
        divide_keys(keys, count, half);
        order_by_place(x, keys + half, count - half);
        count = half;
    }
}

/* base vertices in compact blocks, finer ones as they stand in the model */
static void share_out(pel_tool_search *search, uint64_t *keys)
{
    const pel_model *model = search->model;
    for (int32_t v = 0; v < model->vertex_count; v++)
        search->member[v] = v;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_search_body *own = &search->bodies[b];
        int32_t count = model->bodies[b].mesh->vertex_count, end = pel_body_place_end(model, b);
        for (int32_t i = 0; i < count; i++)
            keys[i] = (uint64_t)(own->first_place + i);
        if (count > SMALL)
            order_by_place(model->rest, keys, count);
        for (int32_t i = 0; i < count; i++) {
            int32_t v = (int32_t)(keys[i] & UINT32_MAX);
            search->member[own->first_place + i] = v;
            search->block[v] = own->block_begin + i / BLOCK;
        }
        for (int32_t v = own->fine_place; v < end; v++)
            search->block[v] = own->block_fine + (v - own->fine_place) / BLOCK;
    }
}

static bool allocate(pel_tool_search *search)
{
    const pel_model *model = search->model;
    size_t triangles = (size_t)model->triangle_begin[model->body_count], vertices = (size_t)model->vertex_count;
    uint64_t *keys = pel_allocate(vertices, sizeof *keys);
    search->member = pel_allocate(vertices, sizeof *search->member);
    search->block = pel_allocate(vertices, sizeof *search->block);
    search->owner = pel_allocate(triangles, sizeof *search->owner);
    search->next = pel_allocate(triangles, sizeof *search->next);
    search->first = pel_allocate(vertices, sizeof *search->first);
    search->bodies = pel_allocate((size_t)model->body_count, sizeof *search->bodies);
    bool is_short = search->owner == NULL || search->next == NULL || search->first == NULL || search->bodies == NULL ||
                    search->member == NULL || search->block == NULL || keys == NULL;
    if (!is_short) {
        lay_out(search);
        share_out(search, keys);
    }
    pel_free(keys);
    if (is_short)
        return false;
    size_t blocks = (size_t)search->block_count;
    return PEL_ALLOCATE_ALL(PEL_ROOM_ALIGNED(search->own, blocks), PEL_ROOM_ALIGNED(search->boxes, blocks),
                            PEL_ROOM(search->beside, blocks * BESIDE_LIMIT), PEL_ROOM(search->beside_count, blocks),
                            PEL_ROOM(search->is_stale, blocks), PEL_ROOM(search->sorted, triangles),
                            PEL_ROOM(search->set, triangles / 64 + 1), PEL_ROOM_ALIGNED(search->copy, vertices));
}

pel_status pel_tool_search_create(const pel_model *model, pel_tool_search **search, pel_error *error)
{
    *search = NULL;
    pel_tool_search *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->model = model;
    if (!allocate(made)) {
        pel_tool_search_destroy(made);
        return pel_fail_memory(error);
    }
    for (int32_t b = 0; b < model->body_count; b++)
        pel_tool_search_rebuild(made, b);
    /* all lists of blocks */
    pel_tool_search_fit(made, model->rest, true);
    *search = made;
    return PEL_OK;
}

void pel_tool_search_destroy(pel_tool_search *search)
{
    if (search == NULL)
        return;
    PEL_FREE_ALL(search->member, search->block, search->owner, search->next, search->first, search->bodies, search->own,
                 search->boxes, search->beside, search->beside_count, search->is_stale, search->sorted, search->set,
                 search->copy);
    pel_free(search);
}

/* ---- boxes of blocks ---- */

static void add_box(pel_search_box *box, const pel_search_box *other)
{
    box->low = pel_record_min(other->low, box->low);
    box->high = pel_record_max(other->high, box->high);
}

/* vertices of a block: members from begin to end - 1 */
typedef struct span {
    int32_t begin, end;
} span;

static span span_of(const pel_tool_search *search, int32_t body, int32_t block)
{
    PEL_ASSERT_INDEX(body, search->model->body_count);
    const pel_search_body *own = &search->bodies[body];
    bool fine = block >= own->block_fine;
    int32_t begin = fine ? own->fine_place + (block - own->block_fine) * BLOCK
                         : own->first_place + (block - own->block_begin) * BLOCK;
    int32_t limit = fine ? search->model->bodies[body].slice_end * PEL_WIDTH
                         : own->first_place + search->model->bodies[body].mesh->vertex_count;
    return (span){begin, begin + BLOCK < limit ? begin + BLOCK : limit};
}

/* past the last block in use */
static int32_t block_end(const pel_tool_search *search, int32_t body)
{
    PEL_ASSERT_INDEX(body, search->model->body_count);
    const pel_search_body *own = &search->bodies[body];
    int32_t used = search->model->bodies[body].slice_end * PEL_WIDTH - own->fine_place;
    return own->block_fine + block_count_of(used);
}

static void list_beside(pel_tool_search *search, int32_t body, int32_t block)
{
    PEL_ASSERT_INDEX(body, search->model->body_count);
    int32_t *list = search->beside + (size_t)block * BESIDE_LIMIT, count = 0;
    span own = span_of(search, body, block);
    for (int32_t k = own.begin; k < own.end; k++)
        for (int32_t t = search->first[search->member[k]]; t >= 0; t = search->next[t])
            for (int c = 0; c < 3 && count <= BESIDE_LIMIT; c++) {
                int32_t other = search->block[search->model->triangles[t][c]], i = 0;
                while (i < count && list[i] != other)
                    i++;
                if (i < count || other == block)
                    continue;
                if (count < BESIDE_LIMIT)
                    list[count] = other;
                count++;
            }
    search->beside_count[block] = (uint8_t)count;
    search->is_stale[block] = 0;
}

static pel_search_box box_of_members(const int32_t *member, int32_t count, const pel_record *x)
{
    pel_search_box box = empty_box();
    int32_t i = 0;
    /* four at a time, so that they do not wait for each other */
    for (; i + 4 <= count; i += 4) {
        pel_record a = x[member[i]], b = x[member[i + 1]], c = x[member[i + 2]], d = x[member[i + 3]];
        box.high = pel_record_max(pel_record_max(pel_record_max(a, b), pel_record_max(c, d)), box.high);
        box.low = pel_record_min(pel_record_min(pel_record_min(a, b), pel_record_min(c, d)), box.low);
    }
    for (; i < count; i++)
        add_point(&box, x[member[i]]);
    return box;
}

static pel_search_box box_of_triangles(const pel_tool_search *search, span own, const pel_record *positions)
{
    pel_search_box box = empty_box();
    for (int32_t i = own.begin; i < own.end; i++)
        for (int32_t t = search->first[search->member[i]]; t >= 0; t = search->next[t])
            for (int c = 0; c < 3; c++)
                add_point(&box, positions[search->model->triangles[t][c]]);
    return box;
}

static void fit_body(pel_tool_search *search, int32_t body, const pel_record *positions)
{
    PEL_ASSERT_INDEX(body, search->model->body_count);
    int32_t begin = search->bodies[body].block_begin, end = block_end(search, body);
    for (int32_t block = begin; block < end; block++) {
        span own = span_of(search, body, block);
        search->own[block] = box_of_members(search->member + own.begin, own.end - own.begin, positions);
        if (search->is_stale[block])
            list_beside(search, body, block);
    }
    for (int32_t block = begin; block < end; block++) {
        const int32_t *beside = search->beside + (size_t)block * BESIDE_LIMIT;
        if (search->beside_count[block] > BESIDE_LIMIT) {
            search->boxes[block] = box_of_triangles(search, span_of(search, body, block), positions);
            continue;
        }
        search->boxes[block] = search->own[block];
        for (int32_t i = 0; i < search->beside_count[block]; i++)
            add_box(&search->boxes[block], &search->own[beside[i]]);
    }
}

void pel_tool_search_fit(pel_tool_search *search, const pel_record *positions, bool keeps)
{
    search->fitted = keeps ? search->copy : positions;
    for (int32_t b = 0; b < search->model->body_count; b++) {
        int32_t first = search->bodies[b].first_place, end = search->model->bodies[b].slice_end * PEL_WIDTH;
        if (keeps)
            memcpy(search->copy + first, positions + first, (size_t)(end - first) * sizeof *positions);
        fit_body(search, b, positions);
    }
    search->fit_count++;
    search->is_fitted = true;
}

static pel_record absolute(pel_record a)
{
    return pel_record_max(a, -a);
}

pel_record pel_tool_search_drift(const pel_tool_search *search, const pel_record *positions)
{
    const pel_record *fitted = search->fitted;
    pel_record even = {0}, odd = {0};
    for (int32_t b = 0; b < search->model->body_count; b++) {
        int32_t end = search->model->bodies[b].slice_end * PEL_WIDTH;
        /* two at a time, so that they do not wait for each other; slices have an even number of vertices */
        for (int32_t v = search->bodies[b].first_place; v < end; v += 2) {
            even = pel_record_max(absolute(positions[v] - fitted[v]), even);
            odd = pel_record_max(absolute(positions[v + 1] - fitted[v + 1]), odd);
        }
    }
    return pel_record_max(even, odd);
}

/* ---- search ---- */

/* The triangles of a block, the first of each vertex, then the second ones and so on: triangles lie far apart in
   memory, and none of these reads waits for another. */
static int32_t find_in_block(const pel_tool_search *search, span own, const pel_search_box *box, int32_t *triangles,
                             int32_t count)
{
    int32_t heads[BLOCK], head_count = 0;
    for (int32_t i = own.begin; i < own.end; i++) {
        heads[head_count] = search->first[search->member[i]];
        head_count += heads[head_count] >= 0;
    }
    while (head_count > 0) {
        int32_t kept = 0;
        for (int32_t i = 0; i < head_count; i++) {
            int32_t t = heads[i], next = search->next[t];
            pel_search_box around = pel_search_triangle(search->fitted, search->model->triangles[t]);
            triangles[count] = t;
            count += !pel_search_apart(&around, box);
            heads[kept] = next;
            kept += next >= 0;
        }
        head_count = kept;
    }
    return count;
}

int32_t pel_tool_search_find(const pel_tool_search *search, int32_t body, const pel_search_box *box, int32_t *triangles,
                             int32_t count)
{
    PEL_ASSERT_INDEX(body, search->model->body_count);
    for (int32_t block = search->bodies[body].block_begin, end = block_end(search, body); block < end; block++)
        if (!pel_search_apart(&search->boxes[block], box))
            count = find_in_block(search, span_of(search, body, block), box, triangles, count);
    return count;
}

/* ---- order ---- */

/* bits of a digit, and numbers from which on digits are faster than comparisons */
enum { DIGIT = 11, RADIX_LEAST = 256 };
/* words of the set for a number of the list, up to which the set is faster than both */
enum { SET_SHARE = 4 };

/* Numbers from a range that is not much longer than their list, none twice: as a set of bits, read in order. */
static void sort_by_set(uint64_t *set, int32_t *values, int32_t count)
{
    int32_t low = INT32_MAX, high = 0, place = 0;
    for (int32_t i = 0; i < count; i++) {
        int32_t word = values[i] >> 6;
        set[word] |= UINT64_C(1) << (values[i] & 63);
        low = word < low ? word : low;
        high = word > high ? word : high;
    }
    for (int32_t word = low; word <= high; word++) {
        for (uint64_t bits = set[word]; bits != 0; bits &= bits - 1)
            values[place++] = (word << 6) + __builtin_ctzll(bits);
        set[word] = 0;
    }
}

/* one pass of a sort by digits, stable */
static void sort_digit(const int32_t *from, int32_t *to, int32_t count, int shift)
{
    int32_t places[1 << DIGIT] = {0}, sum = 0;
    for (int32_t i = 0; i < count; i++)
        places[from[i] >> shift & ((1 << DIGIT) - 1)]++;
    for (int32_t d = 0; d < 1 << DIGIT; d++) {
        int32_t own = places[d];
        places[d] = sum;
        sum += own;
    }
    for (int32_t i = 0; i < count; i++)
        to[places[from[i] >> shift & ((1 << DIGIT) - 1)]++] = from[i];
}

void pel_tool_search_sort(pel_tool_search *search, int32_t *triangles, int32_t count)
{
    int32_t *from = triangles, *to = search->sorted, limit = search->model->triangle_begin[search->model->body_count];
    if (limit >> 6 <= SET_SHARE * count) {
        sort_by_set(search->set, triangles, count);
        return;
    }
    if (count < RADIX_LEAST) {
        pel_sort_int32(triangles, count);
        return;
    }
    for (int shift = 0; shift < 31 && limit >> shift > 0; shift += DIGIT) {
        sort_digit(from, to, count, shift);
        int32_t *swap = from;
        from = to;
        to = swap;
    }
    if (from != triangles)
        memcpy(triangles, from, (size_t)count * sizeof *triangles);
}
