/* From a pattern to fronts: order, elimination tree (Liu 1990), counts of the columns by the paths of rows in the tree,
   supernodes, merging of those where a model of the time says that zeros cost less than another front, borders, places.
 */
#include "linear/factor_plan.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/sort.h"
#include "base/status.h"
#include "linear/order.h"

#include <string.h>

/* Model of the time [ns], one thread, float: a multiplication with addition in a front, an entry that a child adds, an
   entry of a panel, a front. Measured on Zen 4; only ratios count. */
static const double TIME_OF_OPERATION = 0.04, TIME_OF_ADDITION = 0.7, TIME_OF_ENTRY = 0.4, TIME_OF_FRONT = 250;

/* a task should be a small share of all work, so that threads end together */
enum { TASK_LIMIT = 96, TASK_SHARE = 16 };

typedef struct planner {
    const pel_matrix *matrix;
    pel_factor_plan *plan;
    int32_t *position;              /* (node_count) of each node in the order */
    int32_t *parent, *count;        /* (node_count) elimination tree; nodes below the diagonal; by position */
    int32_t *mark, *stack, *place;  /* (node_count) scratch */
    int32_t *front_of;              /* (node_count) supernode of a position, while they merge */
    int32_t *pivots, *borders;      /* (node_count) unknowns of each supernode */
    int32_t *first_child, *sibling; /* (node_count) trees as lists */
    int32_t *border_node;           /* positions in borders of all fronts */
    size_t border_capacity;         /* of border_node */
    int32_t *border_first;          /* (front_count + 1) in border_node */
    double *work;                   /* (front_count) of each subtree */
} planner;

static void release_planner(planner *p)
{
    PEL_FREE_ALL(p->position, p->border_node, p->border_first, p->work);
}

void pel_factor_plan_destroy(pel_factor_plan *plan)
{
    if (plan == NULL)
        return;
    PEL_FREE_ALL(plan->fronts, plan->tasks, plan->upper, plan->runs, plan->border_unknown, plan->order,
                 plan->pivot_start, plan->front_unknown, plan->block_row);
    pel_free(plan);
}

pel_factor_cost pel_factor_plan_cost(const pel_factor_plan *plan)
{
    return plan->cost;
}

static int32_t size_at(const planner *p, int32_t position)
{
    int32_t node = p->plan->order[position];
    return p->matrix->first_unknown[node + 1] - p->matrix->first_unknown[node];
}

static void invert_order(planner *p)
{
    for (int32_t i = 0; i < p->matrix->node_count; i++)
        p->position[p->plan->order[i]] = i;
}

/* parents in the elimination tree, by position; place holds ancestors on compressed paths */
static void build_tree(planner *p)
{
    const pel_matrix *m = p->matrix;
    for (int32_t i = 0; i < m->node_count; i++) {
        int32_t node = p->plan->order[i];
        p->parent[i] = p->place[i] = -1;
        for (int32_t block = m->row_start[node]; block < m->row_start[node + 1]; block++)
            for (int32_t j = p->position[m->column[block]], next; j >= 0 && j < i; j = next) {
                next = p->place[j];
                p->place[j] = i;
                if (next < 0)
                    p->parent[j] = i;
            }
    }
}

/* lists of children, ascending, from parents of `count` things; the roots are the children of -1: first is returned */
static int32_t list_children(const int32_t *parent, int32_t count, int32_t *first_child, int32_t *sibling)
{
    int32_t first_root = -1;
    for (int32_t i = 0; i < count; i++)
        first_child[i] = -1;
    for (int32_t i = count - 1; i >= 0; i--) {
        int32_t *first = parent[i] < 0 ? &first_root : &first_child[parent[i]];
        sibling[i] = *first;
        *first = i;
    }
    return first_root;
}

/* writes things in postorder; eats first_child */
static void list_postorder(int32_t first_root, int32_t *first_child, const int32_t *sibling, int32_t *stack,
                           int32_t *listed)
{
    int32_t count = 0;
    for (int32_t root = first_root; root >= 0; root = sibling[root]) {
        int32_t depth = 0;
        stack[depth++] = root;
        while (depth > 0) {
            int32_t top = stack[depth - 1], child = first_child[top];
            if (child < 0) {
                listed[count++] = top;
                depth--;
            } else {
                first_child[top] = sibling[child];
                stack[depth++] = child;
            }
        }
    }
}

/* reorders the nodes to a postorder of the elimination tree: columns of one supernode are then consecutive */
static void postorder_tree(planner *p)
{
    int32_t count = p->matrix->node_count, *order = p->plan->order;
    int32_t root = list_children(p->parent, count, p->first_child, p->sibling);
    list_postorder(root, p->first_child, p->sibling, p->stack, p->place);
    for (int32_t i = 0; i < count; i++) {
        p->mark[i] = order[p->place[i]];
        p->stack[p->place[i]] = i;
    }
    for (int32_t i = 0; i < count; i++)
        p->count[i] = p->parent[p->place[i]] < 0 ? -1 : p->stack[p->parent[p->place[i]]];
    memcpy(p->parent, p->count, (size_t)count * sizeof *p->parent);
    memcpy(order, p->mark, (size_t)count * sizeof *order);
    invert_order(p);
}

/* nodes, and unknowns (borders), below the diagonal in each column: each row is a subtree with its entries as leaves */
static void count_columns(planner *p)
{
    const pel_matrix *m = p->matrix;
    memset(p->count, 0, (size_t)m->node_count * sizeof *p->count);
    memset(p->borders, 0, (size_t)m->node_count * sizeof *p->borders);
    for (int32_t i = 0; i < m->node_count; i++) {
        int32_t node = p->plan->order[i], size = size_at(p, i);
        p->mark[i] = i;
        for (int32_t block = m->row_start[node]; block < m->row_start[node + 1]; block++)
            for (int32_t j = p->position[m->column[block]]; j < i && p->mark[j] != i; j = p->parent[j]) {
                p->mark[j] = i;
                p->count[j]++;
                p->borders[j] += size;
            }
    }
}

static double operations_of(double pivots, double border)
{
    return pivots * (pivots * pivots / 3 + pivots * border + border * border);
}

static double time_of(double pivots, double border)
{
    return TIME_OF_FRONT + TIME_OF_OPERATION * operations_of(pivots, border) + TIME_OF_ADDITION * border * border / 2 +
           TIME_OF_ENTRY * pivots * (pivots + border);
}

/* Supernodes: chains of columns with the same structure below. A supernode is named by its last position. Returns the
   parents of supernodes in place[last], and the first of each in stack[last]. */
static void find_supernodes(planner *p)
{
    int32_t count = p->matrix->node_count;
    memset(p->mark, 0, (size_t)count * sizeof *p->mark);
    for (int32_t i = 0; i < count; i++)
        if (p->parent[i] >= 0)
            p->mark[p->parent[i]]++;
    for (int32_t first = 0, last; first < count; first = last + 1) {
        int32_t pivots = size_at(p, first);
        for (last = first; last + 1 < count && p->parent[last] == last + 1 &&
                           p->count[last] == p->count[last + 1] + 1 && p->mark[last + 1] == 1;
             last++)
            pivots += size_at(p, last + 1);
        for (int32_t i = first; i <= last; i++)
            p->front_of[i] = last;
        p->pivots[last] = pivots;
    }
}

/* Merges a supernode into its parent where the model says that this saves time, children before parents. A merged one
   keeps its columns; front_of leads to what it was merged into. */
static void merge_supernodes(planner *p)
{
    for (int32_t i = 0; i < p->matrix->node_count; i++) {
        if (p->front_of[i] != i || p->parent[i] < 0)
            continue;
        int32_t up = p->front_of[p->parent[i]];
        double apart = time_of(p->pivots[i], p->borders[i]) + time_of(p->pivots[up], p->borders[up]);
        if (time_of(p->pivots[i] + p->pivots[up], p->borders[up]) < apart) {
            p->front_of[i] = up;
            p->pivots[up] += p->pivots[i];
        }
    }
    /* a parent may have been merged after its child: follow to the top, from above */
    for (int32_t i = p->matrix->node_count - 1; i >= 0; i--)
        p->front_of[i] = p->front_of[p->front_of[i]];
}

/* Numbers the merged supernodes in a postorder of their tree, and the nodes by supernode and former position. */
static pel_status create_fronts(planner *p, pel_error *error)
{
    pel_factor_plan *plan = p->plan;
    int32_t count = p->matrix->node_count, front_count = 0;
    for (int32_t i = 0; i < count; i++)
        if (p->front_of[i] == i) {
            p->place[i] = front_count;
            p->pivots[front_count++] = i;
        }
    plan->front_count = front_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(plan->fronts, front_count), PEL_ROOM(p->border_first, (size_t)front_count + 1),
                          PEL_ROOM(p->work, front_count)))
        return pel_fail_memory(error);
    /* parents of fronts by number: that of the last column (count is free now) */
    for (int32_t f = 0; f < front_count; f++) {
        int32_t above = p->parent[p->pivots[f]];
        p->count[f] = above < 0 ? -1 : p->place[p->front_of[above]];
    }
    int32_t root = list_children(p->count, front_count, p->first_child, p->sibling);
    list_postorder(root, p->first_child, p->sibling, p->stack, p->borders);
    for (int32_t k = 0; k < front_count; k++)
        p->stack[p->borders[k]] = k;
    for (int32_t f = 0; f < front_count; f++)
        plan->fronts[p->stack[f]].parent = p->count[f] < 0 ? -1 : p->stack[p->count[f]];
    /* counting sort of the nodes by front */
    for (int32_t i = 0; i < count; i++) {
        p->mark[i] = p->stack[p->place[p->front_of[i]]];
        plan->fronts[p->mark[i]].last_node++;
    }
    for (int32_t f = 0, first = 0; f < front_count; f++) {
        plan->fronts[f].first_node = first;
        first += plan->fronts[f].last_node;
        plan->fronts[f].last_node = plan->fronts[f].first_node;
    }
    memcpy(p->parent, plan->order, (size_t)count * sizeof *plan->order);
    for (int32_t i = 0; i < count; i++)
        plan->order[plan->fronts[p->mark[i]].last_node++] = p->parent[i];
    invert_order(p);
    for (int32_t f = 0; f < front_count; f++) {
        plan->fronts[f].first_child = plan->fronts[f].next_sibling = -1;
        for (int32_t i = plan->fronts[f].first_node; i < plan->fronts[f].last_node; i++)
            p->front_of[i] = f;
    }
    for (int32_t f = front_count - 1; f >= 0; f--)
        if (plan->fronts[f].parent >= 0) {
            plan->fronts[f].next_sibling = plan->fronts[plan->fronts[f].parent].first_child;
            plan->fronts[plan->fronts[f].parent].first_child = f;
        }
    return PEL_OK;
}

/* adds a position to the border that is being made */
static bool touch(planner *p, int32_t position, int32_t front, size_t *count)
{
    if (position < p->plan->fronts[front].last_node || p->mark[position] == front)
        return true;
    p->mark[position] = front;
    if (!pel_reserve((void **)&p->border_node, &p->border_capacity, *count + 1, sizeof *p->border_node))
        return false;
    p->border_node[(*count)++] = position;
    return true;
}

/* border of each front: what its pivots touch in the matrix, and the borders of its children */
static pel_status find_borders(planner *p, pel_error *error)
{
    const pel_matrix *m = p->matrix;
    pel_factor_plan *plan = p->plan;
    size_t count = 0;
    for (int32_t i = 0; i < m->node_count; i++)
        p->mark[i] = -1;
    for (int32_t f = 0; f < plan->front_count; f++) {
        const pel_front *front = &plan->fronts[f];
        bool has_memory = true;
        p->border_first[f] = (int32_t)count;
        for (int32_t i = front->first_node; i < front->last_node; i++)
            for (int32_t block = m->row_start[plan->order[i]]; block < m->row_start[plan->order[i] + 1]; block++)
                has_memory = has_memory && touch(p, p->position[m->column[block]], f, &count);
        for (int32_t child = front->first_child; child >= 0; child = plan->fronts[child].next_sibling)
            for (int32_t k = p->border_first[child]; k < p->border_first[child + 1]; k++)
                has_memory = has_memory && touch(p, p->border_node[k], f, &count);
        if (!has_memory || count > INT32_MAX / PEL_NODE_SIZE_LIMIT)
            return pel_fail_memory(error);
        if ((int32_t)count > p->border_first[f])
            pel_sort_int32(&p->border_node[p->border_first[f]], (int32_t)count - p->border_first[f]);
        p->border_first[f + 1] = (int32_t)count;
    }
    return PEL_OK;
}

/* Counts of unknowns, where panels lie, and unknowns in the order of elimination. */
static pel_status measure_fronts(planner *p, pel_error *error)
{
    pel_factor_plan *plan = p->plan;
    const pel_matrix *m = p->matrix;
    int64_t border = 0;
    for (int32_t f = 0, pivot = 0; f < plan->front_count; f++) {
        pel_front *front = &plan->fronts[f];
        front->first_pivot = pivot;
        for (int32_t i = front->first_node; i < front->last_node; i++) {
            plan->pivot_start[i] = pivot;
            for (int32_t u = m->first_unknown[plan->order[i]]; u < m->first_unknown[plan->order[i] + 1]; u++)
                plan->front_unknown[pivot++] = u;
        }
        front->pivot_count = pivot - front->first_pivot;
        for (int32_t k = p->border_first[f]; k < p->border_first[f + 1]; k++)
            front->border_count += size_at(p, p->border_node[k]);
        if (border + front->border_count > INT32_MAX)
            return pel_fail_memory(error);
        front->border_start = (int32_t)border;
        border += front->border_count;
        /* columns that lie a power of two apart would share sets of the cache */
        front->stride = pel_front_pad(front->pivot_count) + pel_front_pad(front->border_count);
        if (front->stride % (2 * PEL_FRONT_PAD) == 0)
            front->stride += PEL_FRONT_PAD;
        front->panel = plan->entry_count;
        plan->entry_count += (int64_t)front->stride * front->pivot_count;
        plan->cost.operations += operations_of(front->pivot_count, front->border_count);
        int32_t size = front->pivot_count + front->border_count;
        plan->cost.largest_front = size > plan->cost.largest_front ? size : plan->cost.largest_front;
    }
    plan->pivot_start[plan->node_count] = plan->unknown_count;
    plan->border_count = (int32_t)border;
    plan->border_unknown = pel_allocate((size_t)border, sizeof *plan->border_unknown);
    if (plan->border_unknown == NULL)
        return pel_fail_memory(error);
    for (int32_t f = 0, next = 0; f < plan->front_count; f++)
        for (int32_t k = p->border_first[f]; k < p->border_first[f + 1]; k++)
            for (int32_t a = 0; a < size_at(p, p->border_node[k]); a++)
                plan->border_unknown[next++] = plan->pivot_start[p->border_node[k]] + a;
    return PEL_OK;
}

/* rows of the nodes of a front, by position, in place (pivots and border only) */
static void place_rows(planner *p, int32_t f)
{
    const pel_front *front = &p->plan->fronts[f];
    int32_t row = 0;
    for (int32_t i = front->first_node; i < front->last_node; row += size_at(p, i), i++)
        p->place[i] = row;
    row = pel_front_pad(front->pivot_count);
    for (int32_t k = p->border_first[f]; k < p->border_first[f + 1]; k++) {
        p->place[p->border_node[k]] = row;
        row += size_at(p, p->border_node[k]);
    }
}

/* runs of the border of a front in its parent, whose rows are in place; with null runs only counts them */
static int32_t list_runs(const planner *p, int32_t f, pel_front_run *runs)
{
    int32_t count = 0, from = 0, next = -1;
    for (int32_t k = p->border_first[f]; k < p->border_first[f + 1]; k++) {
        int32_t to = p->place[p->border_node[k]], size = size_at(p, p->border_node[k]);
        if (to != next)
            count++;
        if (runs != NULL && to != next)
            runs[count - 1] = (pel_front_run){from, to, 0};
        if (runs != NULL)
            runs[count - 1].count += size;
        from += size;
        next = to + size;
    }
    return count;
}

/* where blocks of the matrix and borders of children go in each front */
static void place_parts(planner *p, bool count_only)
{
    const pel_matrix *m = p->matrix;
    pel_factor_plan *plan = p->plan;
    for (int32_t f = 0; f < plan->front_count; f++) {
        const pel_front *front = &plan->fronts[f];
        place_rows(p, f);
        for (int32_t child = front->first_child; child >= 0; child = plan->fronts[child].next_sibling) {
            pel_front *c = &plan->fronts[child];
            if (count_only) {
                c->run_count = list_runs(p, child, NULL);
                c->run_start = plan->run_count;
                plan->run_count += c->run_count;
            } else {
                list_runs(p, child, &plan->runs[c->run_start]);
            }
        }
        for (int32_t i = front->first_node; i < front->last_node; i++)
            for (int32_t block = m->row_start[plan->order[i]]; block < m->row_start[plan->order[i] + 1]; block++) {
                int32_t other = p->position[m->column[block]];
                plan->block_row[block] = other < i ? -1 : p->place[other];
            }
    }
}

/* work of subtrees; the fronts of a subtree are consecutive and end at its root */
static double sum_work(planner *p)
{
    const pel_factor_plan *plan = p->plan;
    double all = 0;
    for (int32_t f = 0; f < plan->front_count; f++) {
        const pel_front *front = &plan->fronts[f];
        p->work[f] += time_of(front->pivot_count, front->border_count);
        if (front->parent >= 0)
            p->work[front->parent] += p->work[f];
        else
            all += p->work[f];
    }
    return all;
}

static void insert_task(planner *p, pel_front_task *tasks, int32_t *count, int32_t root)
{
    int32_t k = (*count)++;
    for (; k > 0 && p->work[tasks[k - 1].last_front - 1] < p->work[root]; k--)
        tasks[k] = tasks[k - 1];
    tasks[k].last_front = root + 1;
}

/* Opens the largest subtree until all are small: its root joins the upper fronts, its children become tasks. */
static pel_status choose_tasks(planner *p, pel_error *error)
{
    pel_factor_plan *plan = p->plan;
    double all = sum_work(p);
    /* subtrees grow in number with children that are opened: there is room for all */
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(plan->tasks, plan->front_count), PEL_ROOM(plan->upper, plan->front_count)))
        return pel_fail_memory(error);
    for (int32_t f = 0; f < plan->front_count; f++)
        if (plan->fronts[f].parent < 0)
            insert_task(p, plan->tasks, &plan->task_count, f);
    while (plan->task_count > 0 && plan->upper_count < TASK_LIMIT) {
        int32_t root = plan->tasks[0].last_front - 1;
        if (p->work[root] * TASK_SHARE < all)
            break;
        plan->task_count--;
        memmove(plan->tasks, plan->tasks + 1, (size_t)plan->task_count * sizeof *plan->tasks);
        plan->upper[plan->upper_count++] = root;
        for (int32_t child = plan->fronts[root].first_child; child >= 0; child = plan->fronts[child].next_sibling)
            insert_task(p, plan->tasks, &plan->task_count, child);
    }
    pel_sort_int32(plan->upper, plan->upper_count);
    for (int32_t t = 0; t < plan->task_count; t++) {
        int32_t leaf = plan->tasks[t].last_front - 1;
        while (plan->fronts[leaf].first_child >= 0)
            leaf = plan->fronts[leaf].first_child;
        plan->tasks[t].first_front = leaf;
    }
    return PEL_OK;
}

/* update matrices that are alive, by place: gaps between them are taken first */
typedef struct arena {
    int64_t base, end; /* where it begins; where its largest use ends */
    int32_t *live;     /* fronts by ascending place */
    int32_t count;
} arena;

static int64_t update_size(const pel_front *front)
{
    return (int64_t)pel_front_update_stride(front) * front->border_count;
}

static void place_update(pel_factor_plan *plan, arena *a, int32_t f)
{
    int64_t size = update_size(&plan->fronts[f]), at = a->base;
    if (size == 0)
        return;
    int32_t k = 0;
    for (; k < a->count && plan->fronts[a->live[k]].update - at < size; k++)
        at = plan->fronts[a->live[k]].update + update_size(&plan->fronts[a->live[k]]);
    memmove(&a->live[k + 1], &a->live[k], (size_t)(a->count - k) * sizeof *a->live);
    a->live[k] = f;
    a->count++;
    plan->fronts[f].update = at;
    a->end = at + size > a->end ? at + size : a->end;
}

/* takes the children of a front out; those of tasks below an upper front are not in its arena */
static void free_children(const pel_factor_plan *plan, arena *a, int32_t f)
{
    int32_t kept = 0;
    for (int32_t k = 0; k < a->count; k++)
        if (plan->fronts[a->live[k]].parent != f)
            a->live[kept++] = a->live[k];
    a->count = kept;
}

/* Gives each update matrix its place; each task has an arena of its own, the upper fronts share one. */
static void place_updates(planner *p)
{
    pel_factor_plan *plan = p->plan;
    arena a = {.live = p->stack};
    int32_t widest = 0;
    for (int32_t t = 0; t < plan->task_count; t++, a.base = a.end, a.count = 0) {
        int32_t stride = 0;
        for (int32_t f = plan->tasks[t].first_front; f < plan->tasks[t].last_front; f++) {
            place_update(plan, &a, f);
            free_children(plan, &a, f);
            stride = plan->fronts[f].stride > stride ? plan->fronts[f].stride : stride;
        }
        plan->tasks[t].scratch = plan->scratch_count;
        plan->scratch_count += stride;
    }
    for (int32_t k = 0; k < plan->upper_count; k++) {
        place_update(plan, &a, plan->upper[k]);
        free_children(plan, &a, plan->upper[k]);
        widest = plan->fronts[plan->upper[k]].stride > widest ? plan->fronts[plan->upper[k]].stride : widest;
    }
    plan->work_count = a.end;
    plan->upper_scratch = plan->scratch_count;
    plan->scratch_count += widest;
}

static void sum_cost(pel_factor_plan *plan)
{
    pel_factor_cost *cost = &plan->cost;
    cost->entries = plan->entry_count;
    cost->fronts = plan->front_count;
    for (int k = 0; k < 2; k++) {
        size_t number = k == PEL_FACTOR_FLOAT ? sizeof(float) : sizeof(double);
        size_t numbers = (size_t)plan->entry_count + (size_t)plan->work_count + (size_t)plan->border_count +
                         (size_t)plan->unknown_count + (size_t)plan->scratch_count;
        cost->bytes[k] = numbers * number + (size_t)plan->unknown_count * sizeof(double);
    }
}

static pel_status allocate_planner(planner *p, pel_error *error)
{
    const pel_matrix *m = p->matrix;
    pel_factor_plan *plan = p->plan;
    size_t count = (size_t)m->node_count;
    plan->node_count = m->node_count;
    plan->unknown_count = m->unknown_count;
    plan->block_count = m->block_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(plan->order, count), PEL_ROOM(plan->front_unknown, m->unknown_count),
                          PEL_ROOM(plan->pivot_start, count + 1), PEL_ROOM(plan->block_row, m->block_count),
                          PEL_ROOM(p->position, 11 * count)))
        return pel_fail_memory(error);
    int32_t **arrays[] = {&p->parent,   &p->count,  &p->mark,    &p->stack,       &p->place,
                          &p->front_of, &p->pivots, &p->borders, &p->first_child, &p->sibling};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        *arrays[i] = p->position + (i + 1) * count;
    return PEL_OK;
}

static pel_status make_plan(planner *p, const double (*coordinates)[3], pel_error *error)
{
    pel_factor_plan *plan = p->plan;
    pel_status status = allocate_planner(p, error);
    if (status == PEL_OK)
        status = pel_vertex_order_nodes(p->matrix, coordinates, plan->order, error);
    if (status != PEL_OK)
        return status;
    invert_order(p);
    build_tree(p);
    postorder_tree(p);
    count_columns(p);
    find_supernodes(p);
    merge_supernodes(p);
    status = create_fronts(p, error);
    if (status == PEL_OK)
        status = find_borders(p, error);
    if (status == PEL_OK)
        status = measure_fronts(p, error);
    if (status != PEL_OK)
        return status;
    place_parts(p, true);
    plan->runs = pel_allocate((size_t)plan->run_count, sizeof *plan->runs);
    if (plan->runs == NULL)
        return pel_fail_memory(error);
    place_parts(p, false);
    status = choose_tasks(p, error);
    if (status != PEL_OK)
        return status;
    place_updates(p);
    sum_cost(plan);
    return PEL_OK;
}

pel_status pel_factor_plan_create(const pel_matrix *matrix, const double (*coordinates)[3], pel_factor_plan **plan,
                                  pel_error *error)
{
    *plan = NULL;
    planner p = {.matrix = matrix, .plan = pel_allocate(1, sizeof(pel_factor_plan))};
    if (p.plan == NULL)
        return pel_fail_memory(error);
    pel_status status = make_plan(&p, coordinates, error);
    release_planner(&p);
    if (status == PEL_OK)
        *plan = p.plan;
    else
        pel_factor_plan_destroy(p.plan);
    return status;
}
