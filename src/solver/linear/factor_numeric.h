/* The numeric half of a factor over `number`; included once for each precision, by sources that define number,
   square_root and the names of the three functions.

   A front: its panel takes the entries of the matrix and what children add to pivots, is factored, and gives the update
   matrix -L L^T; what children add beyond the pivots comes on top. So an update matrix is written once and never
   cleared. Upper fronts do the same steps in chunks of columns and rows: each number takes its terms in the same order
   as in one piece. */
#include "linear/factor_kernel.h"
#include "linear/factor_kinds.h"

/* nodes and columns of one chunk where a front is filled and children are added */
enum { NODES = 8, COLUMNS = 24 };

/* a front at work */
typedef struct job {
    pel_factor *factor;
    const pel_matrix *matrix;
    double shift;
    const pel_front *front;
    number *panel, *update;
    ptrdiff_t stride, update_stride;
    int32_t pad, last_row; /* first row of the border; end of the rows, padding included */
    int32_t first, last;   /* pivots of a block */
} job;

static job job_of(pel_factor *factor, const pel_matrix *matrix, double shift, const pel_front *front)
{
    int32_t pad = pel_front_pad(front->pivot_count), update_stride = pel_front_update_stride(front);
    return (job){.factor = factor,
                 .matrix = matrix,
                 .shift = shift,
                 .front = front,
                 .panel = (number *)factor->entries + front->panel,
                 .update = (number *)factor->work + front->update,
                 .stride = front->stride,
                 .update_stride = update_stride,
                 .pad = pad,
                 .last_row = pad + update_stride};
}

/* number of chunks of some size */
static int32_t chunks_of(int32_t count, int32_t size)
{
    return (count + size - 1) / size;
}

/* writes the scaled entries of the matrix of one node to its columns of the panel */
static void load_node(const job *w, int32_t position, int32_t column)
{
    const pel_factor_plan *plan = w->factor->plan;
    const pel_matrix *m = w->matrix;
    const double *scale = w->factor->scale;
    int32_t node = plan->order[position], first = m->first_unknown[node], size = m->first_unknown[node + 1] - first;
    for (int32_t block = m->row_start[node]; block < m->row_start[node + 1]; block++) {
        int32_t row = plan->block_row[block], other = m->first_unknown[m->column[block]];
        if (row < 0)
            continue;
        /* rows of the block are columns of the panel: the matrix is symmetric */
        int32_t rows = m->first_unknown[m->column[block] + 1] - other;
        const double *values = &m->values[m->block_start[block]];
        for (int32_t a = 0; a < size; a++)
            for (int32_t b = 0; b < rows; b++)
                w->panel[row + b + (column + a) * w->stride] =
                    (number)(values[a + size * b] * (scale[first + a] * scale[other + b]));
    }
    for (int32_t a = 0; a < size; a++)
        w->panel[column + a + (column + a) * w->stride] = (number)(1 + w->shift);
}

/* adds column j of a child's update matrix, which lies in its run r, to a column of the front: rows of `to` count from
   `offset` */
static void add_column(const pel_front_run *runs, int32_t run_count, int32_t r, int32_t j, const number *from,
                       number *to, int32_t offset)
{
    int32_t begin = j - runs[r].from;
    for (; r < run_count; r++, begin = 0) {
        const number *restrict source = from + runs[r].from;
        number *restrict target = to + runs[r].to - offset;
        for (int32_t i = begin; i < runs[r].count; i++)
            target[i] += source[i];
    }
}

/* adds the columns of the children that lie in rows first to last of the front: to the panel, or, from the border on,
   to the update matrix */
static void add_children(const job *w, int32_t first, int32_t last)
{
    const pel_factor_plan *plan = w->factor->plan;
    for (int32_t child = w->front->first_child; child >= 0; child = plan->fronts[child].next_sibling) {
        const pel_front *c = &plan->fronts[child];
        const pel_front_run *runs = &plan->runs[c->run_start];
        const number *from = (const number *)w->factor->work + c->update;
        ptrdiff_t stride = pel_front_update_stride(c);
        for (int32_t r = 0; r < c->run_count; r++) {
            int32_t begin = runs[r].to > first ? 0 : first - runs[r].to, room = last - runs[r].to;
            for (int32_t i = begin; i < (runs[r].count < room ? runs[r].count : room); i++) {
                int32_t row = runs[r].to + i, j = runs[r].from + i;
                if (row < w->pad)
                    add_column(runs, c->run_count, r, j, from + j * stride, w->panel + row * w->stride, 0);
                else
                    add_column(runs, c->run_count, r, j, from + j * stride,
                               w->update + (row - w->pad) * w->update_stride, w->pad);
            }
        }
    }
}

/* columns of the nodes first to last of the front (counted from its first one) from the matrix and the children */
static void fill_nodes(const job *w, int32_t first, int32_t last)
{
    const int32_t *pivot_start = &w->factor->plan->pivot_start[w->front->first_node];
    int32_t begin = pivot_start[first] - pivot_start[0], end = pivot_start[last] - pivot_start[0];
    memset(w->panel + begin * w->stride, 0, (size_t)((end - begin) * w->stride) * sizeof *w->panel);
    for (int32_t i = first; i < last; i++)
        load_node(w, w->front->first_node + i, pivot_start[i] - pivot_start[0]);
    add_children(w, begin, end);
}

/* the block of pivots first to last in one thread; false when a pivot fails */
static bool factor_block(const job *w, pel_factor_pivot *pivot)
{
    int32_t below = pel_front_pad(w->last);
    number smallest = (number)pivot->value;
    int32_t done = factor_pivots(w->panel, w->stride, w->first, w->last, below, LEAST_PIVOT, &smallest);
    pivot->value = (double)smallest;
    if (done < w->last)
        pivot->failed = w->front->first_pivot + done;
    return done == w->last;
}

/* one front in one thread; false when a pivot fails */
static bool factor_front(job *w, pel_factor_pivot *pivot)
{
    int32_t pivots = w->front->pivot_count, border = w->front->border_count;
    fill_nodes(w, 0, w->front->last_node - w->front->first_node);
    for (w->first = 0; w->first < pivots; w->first = w->last) {
        w->last = pivots - w->first < BLOCK ? pivots : w->first + BLOCK;
        if (!factor_block(w, pivot))
            return false;
        const number *block = w->panel + w->first * w->stride;
        solve_rows(w->panel, w->stride, w->first, w->last, pel_front_pad(w->last), w->last_row);
        for (int32_t j = w->last; j < pivots; j += STRIP)
            update_rows(block, block, w->stride, w->last - w->first, w->panel, w->stride, j,
                        j + STRIP < pivots ? j + STRIP : pivots, 0, w->last_row, false);
    }
    for (int32_t k = 0; k < pivots; k += BLOCK)
        for (int32_t j = 0; j < border; j += STRIP) {
            const number *block = w->panel + k * w->stride + w->pad;
            update_rows(block, block, w->stride, pivots - k < BLOCK ? pivots - k : BLOCK, w->update, w->update_stride,
                        j, j + STRIP < border ? j + STRIP : border, 0, w->last_row - w->pad, k == 0);
        }
    add_children(w, w->pad, w->pad + border);
    return true;
}

static void fill_chunk(void *context, int32_t chunk)
{
    const job *w = context;
    int32_t count = w->front->last_node - w->front->first_node, end = (chunk + 1) * NODES;
    fill_nodes(w, chunk * NODES, end < count ? end : count);
}

static void add_chunk(void *context, int32_t chunk)
{
    const job *w = context;
    add_children(w, w->pad + chunk * COLUMNS, w->pad + (chunk + 1) * COLUMNS);
}

static void solve_chunk(void *context, int32_t chunk)
{
    const job *w = context;
    int32_t row = pel_front_pad(w->last) + chunk * PEL_FRONT_PAD * 4, end = row + PEL_FRONT_PAD * 4;
    solve_rows(w->panel, w->stride, w->first, w->last, row, end < w->last_row ? end : w->last_row);
}

/* pieces of the rest of the panel: strips of columns by blocks of rows */
static void panel_chunk(void *context, int32_t chunk)
{
    const job *w = context;
    int32_t heights = chunks_of(w->last_row, ROWS), j = w->last + chunk / heights * STRIP, row = chunk % heights * ROWS;
    int32_t last = j + STRIP < w->front->pivot_count ? j + STRIP : w->front->pivot_count;
    const number *block = w->panel + w->first * w->stride;
    update_rows(block, block, w->stride, w->last - w->first, w->panel, w->stride, j, last, row,
                row + ROWS < w->last_row ? row + ROWS : w->last_row, false);
}

/* pieces of the update matrix, over all pivots */
static void update_chunk(void *context, int32_t chunk)
{
    const job *w = context;
    int32_t border = w->front->border_count, pivots = w->front->pivot_count, rows = (int32_t)w->update_stride;
    int32_t heights = chunks_of(rows, ROWS), j = chunk / heights * STRIP, row = chunk % heights * ROWS;
    for (int32_t k = 0; k < pivots; k += BLOCK) {
        const number *block = w->panel + k * w->stride + w->pad;
        update_rows(block, block, w->stride, pivots - k < BLOCK ? pivots - k : BLOCK, w->update, w->update_stride, j,
                    j + STRIP < border ? j + STRIP : border, row, row + ROWS < rows ? row + ROWS : rows, k == 0);
    }
}

/* true in a pool that is stopped: the front counts as one that failed */
static bool is_given_up(const pel_front *front, pel_pool *pool, pel_factor_pivot *pivot)
{
    if (!pel_pool_is_stopped_now(pool))
        return false;
    *pivot = (pel_factor_pivot){front->first_pivot, 0};
    return true;
}

/* one front by all threads */
static bool factor_upper(job *w, pel_pool *pool, pel_factor_pivot *pivot)
{
    int32_t pivots = w->front->pivot_count, border = w->front->border_count;
    pel_pool_run(pool, chunks_of(w->front->last_node - w->front->first_node, NODES), fill_chunk, w);
    for (w->first = 0; w->first < pivots; w->first = w->last) {
        w->last = pivots - w->first < BLOCK ? pivots : w->first + BLOCK;
        if (is_given_up(w->front, pool, pivot) || !factor_block(w, pivot))
            return false;
        pel_pool_run(pool, chunks_of(w->last_row - pel_front_pad(w->last), PEL_FRONT_PAD * 4), solve_chunk, w);
        pel_pool_run(pool, chunks_of(pivots - w->last, STRIP) * chunks_of(w->last_row, ROWS), panel_chunk, w);
    }
    pel_pool_run(pool, chunks_of(border, STRIP) * chunks_of((int32_t)w->update_stride, ROWS), update_chunk, w);
    pel_pool_run(pool, chunks_of(border, COLUMNS), add_chunk, w);
    return true;
}

/* the whole factorization, as the tasks see it */
typedef struct run {
    pel_factor *factor;
    const pel_matrix *matrix;
    double shift;
    pel_pool *pool;
} run;

static void factor_task(void *context, int32_t chunk)
{
    const run *r = context;
    const pel_factor_plan *plan = r->factor->plan;
    const pel_front_task *task = &plan->tasks[chunk];
    pel_factor_pivot *pivot = &r->factor->pivots[chunk];
    *pivot = (pel_factor_pivot){-1, (double)HUGE_VAL};
    for (int32_t f = task->first_front; f < task->last_front && pivot->failed < 0; f++) {
        job w = job_of(r->factor, r->matrix, r->shift, &plan->fronts[f]);
        if (!is_given_up(&plan->fronts[f], r->pool, pivot))
            factor_front(&w, pivot);
    }
}

void PEL_FACTOR_COMPUTE(pel_factor *factor, const pel_matrix *matrix, double shift, pel_pool *pool)
{
    const pel_factor_plan *plan = factor->plan;
    run r = {factor, matrix, shift, pool};
    pel_pool_run(pool, plan->task_count, factor_task, &r);
    pel_factor_pivot *upper = &factor->pivots[plan->task_count];
    *upper = (pel_factor_pivot){-1, (double)HUGE_VAL};
    /* fronts before the first failure have all below them, and one of them may fail earlier still */
    int32_t last_pivot = plan->unknown_count;
    for (int32_t t = 0; t < plan->task_count; t++)
        if (factor->pivots[t].failed >= 0 && factor->pivots[t].failed < last_pivot)
            last_pivot = factor->pivots[t].failed;
    for (int32_t k = 0; k < plan->upper_count && upper->failed < 0; k++) {
        const pel_front *front = &plan->fronts[plan->upper[k]];
        if (front->first_pivot > last_pivot)
            break;
        job w = job_of(factor, matrix, shift, front);
        factor_upper(&w, pool, upper);
    }
}

/* sums over the columns of a front from row `row` on: t -= L t[first .. first + 3], rows beyond are padding or border,
   up to last_row, a multiple of LANES. Four columns at once. */
static void subtract_columns(const number *column, ptrdiff_t stride, int32_t count, int32_t row, int32_t last_row,
                             const number *x, number *t)
{
    for (; row % LANES != 0; row++)
        for (int32_t j = 0; j < count; j++)
            t[row] -= column[row + j * stride] * x[j];
    if (count == 4) {
        for (; row < last_row; row += LANES)
            store(t + row, (((load(t + row) - load(column + row) * x[0]) - load(column + row + stride) * x[1]) -
                            load(column + row + 2 * stride) * x[2]) -
                               load(column + row + 3 * stride) * x[3]);
        return;
    }
    for (; row < last_row; row += LANES)
        for (int32_t j = 0; j < count; j++)
            store(t + row, load(t + row) - load(column + row + j * stride) * x[j]);
}

/* t (a column of the front) = L^-1 t: pivots are solved, the border takes what they subtract */
static void solve_forward(const pel_front *front, const number *panel, int32_t last_row, number *t)
{
    ptrdiff_t stride = front->stride;
    for (int32_t j = 0; j < front->pivot_count; j += 4) {
        int32_t count = front->pivot_count - j < 4 ? front->pivot_count - j : 4;
        const number *column = panel + j * stride;
        for (int32_t k = 0; k < count; k++) {
            t[j + k] *= column[j + k + k * stride];
            for (int32_t i = k + 1; i < count; i++)
                t[j + i] -= column[j + i + k * stride] * t[j + k];
        }
        subtract_columns(column, stride, count, j + count, last_row, &t[j], t);
    }
}

/* pivots of t = L^-T t, with the border known */
static void solve_backward(const pel_front *front, const number *panel, int32_t last_row, number *t)
{
    ptrdiff_t stride = front->stride;
    for (int32_t j = (front->pivot_count - 1) / 4 * 4; j >= 0; j -= 4) {
        int32_t count = front->pivot_count - j < 4 ? front->pivot_count - j : 4, row = j + count;
        const number *column = panel + j * stride;
        number sum[4] = {0};
        lanes sums[4] = {{0}};
        for (; row % LANES != 0; row++)
            for (int32_t k = 0; k < count; k++)
                sum[k] += column[row + k * stride] * t[row];
        if (count == 4) {
            for (; row < last_row; row += LANES)
                for (int32_t k = 0; k < 4; k++)
                    sums[k] += load(column + row + k * stride) * load(t + row);
        } else {
            for (; row < last_row; row += LANES)
                for (int32_t k = 0; k < count; k++)
                    sums[k] += load(column + row + k * stride) * load(t + row);
        }
        for (int32_t k = count - 1; k >= 0; k--) {
            for (int32_t l = 0; l < LANES; l++)
                sum[k] += sums[k][l];
            for (int32_t i = k + 1; i < count; i++)
                sum[k] += column[j + i + k * stride] * t[j + i];
            t[j + k] = (t[j + k] - sum[k]) * column[j + k + k * stride];
        }
    }
}

/* a solve, as the tasks see it */
typedef struct solving {
    pel_factor *factor;
    const double *right;
    double *result;
    double unit; /* power of two near the largest scaled entry of the right side */
} solving;

static bool is_zero(const number *t, int32_t count)
{
    bool is = true;
    for (int32_t i = 0; i < count && is; i++)
        is = t[i] == 0;
    return is;
}

/* forward through one front: right side and what the children hand on, solved; the border is handed on */
static void forward_front(const solving *s, const pel_front *front, number *t)
{
    pel_factor *factor = s->factor;
    const pel_factor_plan *plan = factor->plan;
    number *solution = factor->solution, *border = factor->border;
    int32_t pad = pel_front_pad(front->pivot_count), last_row = pad + pel_front_pad(front->border_count);
    memset(t, 0, (size_t)last_row * sizeof *t);
    for (int32_t j = 0; j < front->pivot_count; j++) {
        int32_t u = plan->front_unknown[front->first_pivot + j];
        t[j] = (number)(s->right[u] * factor->scale[u] / s->unit);
    }
    for (int32_t child = front->first_child; child >= 0; child = plan->fronts[child].next_sibling) {
        const pel_front *c = &plan->fronts[child];
        add_column(&plan->runs[c->run_start], c->run_count, 0, 0, border + c->border_start, t, 0);
    }
    /* a force on few vertices reaches few fronts */
    if (!is_zero(t, last_row))
        solve_forward(front, (const number *)factor->entries + front->panel, last_row, t);
    memcpy(solution + front->first_pivot, t, (size_t)front->pivot_count * sizeof *t);
    memcpy(border + front->border_start, t + pad, (size_t)front->border_count * sizeof *t);
}

static void backward_front(const solving *s, const pel_front *front, number *t)
{
    pel_factor *factor = s->factor;
    const pel_factor_plan *plan = factor->plan;
    number *solution = factor->solution;
    int32_t pad = pel_front_pad(front->pivot_count), last_row = pad + pel_front_pad(front->border_count);
    memset(t, 0, (size_t)last_row * sizeof *t);
    memcpy(t, solution + front->first_pivot, (size_t)front->pivot_count * sizeof *t);
    for (int32_t i = 0; i < front->border_count; i++)
        t[pad + i] = solution[plan->border_unknown[front->border_start + i]];
    solve_backward(front, (const number *)factor->entries + front->panel, last_row, t);
    memcpy(solution + front->first_pivot, t, (size_t)front->pivot_count * sizeof *t);
    for (int32_t j = 0; j < front->pivot_count; j++) {
        int32_t u = plan->front_unknown[front->first_pivot + j];
        s->result[u] = (double)t[j] * factor->scale[u] * s->unit;
    }
}

static void forward_task(void *context, int32_t chunk)
{
    const solving *s = context;
    const pel_factor_plan *plan = s->factor->plan;
    number *t = (number *)s->factor->scratch + plan->tasks[chunk].scratch;
    for (int32_t f = plan->tasks[chunk].first_front; f < plan->tasks[chunk].last_front; f++)
        forward_front(s, &plan->fronts[f], t);
}

static void backward_task(void *context, int32_t chunk)
{
    const solving *s = context;
    const pel_factor_plan *plan = s->factor->plan;
    number *t = (number *)s->factor->scratch + plan->tasks[chunk].scratch;
    for (int32_t f = plan->tasks[chunk].last_front - 1; f >= plan->tasks[chunk].first_front; f--)
        backward_front(s, &plan->fronts[f], t);
}

static void go_forward(solving *s, pel_pool *pool)
{
    const pel_factor_plan *plan = s->factor->plan;
    number *upper = (number *)s->factor->scratch + plan->upper_scratch;
    pel_pool_run(pool, plan->task_count, forward_task, s);
    for (int32_t k = 0; k < plan->upper_count; k++)
        forward_front(s, &plan->fronts[plan->upper[k]], upper);
}

void PEL_FACTOR_SOLVE(pel_factor *factor, double unit, pel_pool *pool, const double *right, double *result)
{
    const pel_factor_plan *plan = factor->plan;
    solving s = {factor, right, result, unit};
    number *upper = (number *)factor->scratch + plan->upper_scratch;
    go_forward(&s, pool);
    for (int32_t k = plan->upper_count - 1; k >= 0; k--)
        backward_front(&s, &plan->fronts[plan->upper[k]], upper);
    pel_pool_run(pool, plan->task_count, backward_task, &s);
}

void PEL_FACTOR_REDUCE(pel_factor *factor, double unit, pel_pool *pool, const double *right, double *result)
{
    const number *solution = factor->solution;
    solving s = {factor, right, NULL, unit};
    go_forward(&s, pool);
    for (int32_t p = 0; p < factor->plan->unknown_count; p++)
        result[p] = (double)solution[p] * unit;
}
