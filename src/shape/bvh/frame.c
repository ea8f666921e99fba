/* Rounding. With u = 2^-53: a coordinate of x - origin has relative error u, of the product with a row of the matrix an
   error of at most 4u times |row| |x - origin|; FRAME_ERROR covers that 8 times. Turning a double into float has a
   relative error of 2^-24 in the normal range and an absolute one of 2^-150 below it; moving the result outward by
   FLOAT_ERROR = 2^-22 of itself and FLT_MIN, in float, covers both and the rounding of that move. A double beyond the
   range of float becomes infinite and infinity minus infinity NaN, which overlaps nothing, so coordinates are held in
   range first: points beyond FRAME_LIMIT all get the same end. */
#include "bvh/frame.h"

#include "geom/wide4.h"
#include "math/extremes.h"

#include <stdatomic.h>

#define FRAME_ERROR 0x1p-48
#define FLOAT_ERROR 0x1p-22f
#define FRAME_LIMIT 0x1p126

enum { FOLLOW_SAMPLES = 1024 };

pel_frame pel_frame_at(const double origin[3])
{
    return (pel_frame){{{origin[0], origin[1], origin[2]}, {origin[0], origin[1], origin[2]}},
                       {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

static int32_t sample_stride(int32_t vertex_count)
{
    return 1 + vertex_count / FOLLOW_SAMPLES;
}

int32_t pel_frame_sample_count(int32_t vertex_count)
{
    int32_t stride = sample_stride(vertex_count);
    return (vertex_count + stride - 1) / stride;
}

static void find_mean(const double (*points)[3], int32_t count, int32_t stride, double mean[3])
{
    int32_t samples = 0;
    mean[0] = mean[1] = mean[2] = 0;
    for (int32_t v = 0; v < count; v += stride, samples++)
        for (int k = 0; k < 3; k++)
            mean[k] += points[v][k];
    for (int k = 0; k < 3; k++)
        mean[k] = isfinite(mean[k]) && samples > 0 ? mean[k] / samples : 0;
}

pel_frame pel_frame_centre(const pel_motion *motion)
{
    pel_frame frame = pel_frame_at((const double[3]){0, 0, 0});
    int32_t stride = sample_stride(motion->vertex_count);
    find_mean(motion->start, motion->vertex_count, stride, frame.origin[0]);
    find_mean(motion->end, motion->vertex_count, stride, frame.origin[1]);
    return frame;
}

/* a point at mid-step in a frame without turning and stretch */
static void place_at_middle(const pel_frame *frame, const pel_motion *motion, int32_t v, double place[3])
{
    for (int k = 0; k < 3; k++)
        place[k] = 0.5 * (motion->start[v][k] - frame->origin[0][k]) + 0.5 * (motion->end[v][k] - frame->origin[1][k]);
}

void pel_frame_sample(const pel_frame *frame, const pel_motion *motion, double (*places)[3])
{
    int32_t stride = sample_stride(motion->vertex_count);
    for (int32_t v = 0; v < motion->vertex_count; v += stride)
        place_at_middle(frame, motion, v, places[v / stride]);
}

/* false when the matrix is singular */
static bool invert(const double a[3][3], double inverse[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int p = (j + 1) % 3, q = (j + 2) % 3, r = (i + 1) % 3, s = (i + 2) % 3;
            inverse[i][j] = a[p][r] * a[q][s] - a[p][s] * a[q][r];
        }
    double determinant = a[0][0] * inverse[0][0] + a[0][1] * inverse[1][0] + a[0][2] * inverse[2][0];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            inverse[i][j] /= determinant;
    return isfinite(1 / determinant);
}

static double squared_norm(const double a[3][3])
{
    double sum = 0;
    for (int i = 0; i < 9; i++)
        sum += a[i / 3][i % 3] * a[i / 3][i % 3];
    return sum;
}

static void multiply(const double a[3][3], const double b[3][3], double product[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            product[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
}

pel_frame pel_frame_follow(const pel_motion *motion, const double (*before)[3])
{
    /* now = stretch before: stretch = (sum now before^T + k 1) (sum before before^T + k 1)^-1, where the small k keeps
       directions in which a flat body has no extent as they are */
    const double regular = 1e-4, distortion_limit = 100;
    double mixed[3][3] = {{0}}, own[3][3] = {{0}}, inverse[3][3], stretch[3][3], now[3];
    pel_frame frame = pel_frame_centre(motion);
    int32_t stride = sample_stride(motion->vertex_count);
    for (int32_t v = 0; v < motion->vertex_count; v += stride) {
        const double *then = before[v / stride];
        place_at_middle(&frame, motion, v, now);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                mixed[i][j] += now[i] * then[j];
                own[i][j] += then[i] * then[j];
            }
    }
    double keep = regular * (own[0][0] + own[1][1] + own[2][2]);
    for (int i = 0; i < 3; i++) {
        mixed[i][i] += keep;
        own[i][i] += keep;
    }
    if (!invert((const double(*)[3])own, inverse))
        return frame;
    multiply((const double(*)[3])mixed, (const double(*)[3])inverse, stretch);
    if (!invert((const double(*)[3])stretch, inverse))
        return frame;
    double distortion = squared_norm((const double(*)[3])stretch) * squared_norm((const double(*)[3])inverse);
    if (distortion < distortion_limit * distortion_limit)
        memcpy(frame.matrix, inverse, sizeof inverse);
    return frame;
}

static pel_corner corner_abs(pel_corner a)
{
    return pel_corner_max(a, -a);
}

/* double to float, away from the inside */
static pel_box round_outward(wide4 low, wide4 high)
{
    const wide4 limit = wide4_set(FRAME_LIMIT);
    pel_corner a = __builtin_convertvector(wide4_max(wide4_min(low, limit), -limit), pel_corner);
    pel_corner b = __builtin_convertvector(wide4_max(wide4_min(high, limit), -limit), pel_corner);
    const pel_corner tiny = {FLT_MIN, FLT_MIN, FLT_MIN, 0};
    return (pel_box){a - (FLOAT_ERROR * corner_abs(a) + tiny), b + (FLOAT_ERROR * corner_abs(b) + tiny)};
}

/* a frame prepared for the loop over points */
typedef struct wide_frame {
    wide4 column[3], error, growth;
} wide_frame;

static wide_frame widen(const pel_frame *frame, double reach)
{
    wide_frame wide;
    double length[3], largest = 0;
    for (int k = 0; k < 3; k++) {
        const double *row = frame->matrix[k];
        wide.column[k] = (wide4){frame->matrix[0][k], frame->matrix[1][k], frame->matrix[2][k], 0};
        length[k] = sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
        largest = pel_max(largest, length[k]);
    }
    double half = 0.5 * reach * (1 + FRAME_ERROR);
    wide.error = FRAME_ERROR * largest * (wide4){1, 1, 1, 0};
    wide.growth = (wide4){half * length[0], half * length[1], half * length[2], 0};
    return wide;
}

/* the point in the frame, and how far it may be off */
static wide4 place(const wide_frame *frame, const double origin[3], const double x[3], wide4 *error)
{
    double dx = x[0] - origin[0], dy = x[1] - origin[1], dz = x[2] - origin[2];
    *error = frame->error * wide4_set(fabs(dx) + fabs(dy) + fabs(dz));
    return frame->column[0] * wide4_set(dx) + frame->column[1] * wide4_set(dy) + frame->column[2] * wide4_set(dz);
}

enum { POINTS_PER_CHUNK = 2048 };

/* a loop over points */
typedef struct box_loop {
    const pel_motion *motion;
    const pel_frame *frame;
    wide_frame wide;
    pel_box *boxes;
    _Atomic int32_t bad; /* lowest point that is not finite */
} box_loop;

static void note_bad(box_loop *loop, int32_t v)
{
    int32_t known = loop->bad;
    while (v < known && !atomic_compare_exchange_weak(&loop->bad, &known, v))
        ;
}

static void box_chunk(void *context, int32_t chunk)
{
    box_loop *loop = context;
    const pel_motion *motion = loop->motion;
    int32_t begin = chunk * POINTS_PER_CHUNK, end = begin + POINTS_PER_CHUNK;
    for (int32_t v = begin; v < end && v < motion->vertex_count; v++) {
        wide4 start_error, end_error;
        wide4 from = place(&loop->wide, loop->frame->origin[0], motion->start[v], &start_error);
        wide4 to = place(&loop->wide, loop->frame->origin[1], motion->end[v], &end_error);
        wide4 growth = loop->wide.growth + wide4_max(start_error, end_error);
        if (!isfinite(start_error[0] + end_error[0])) {
            note_bad(loop, v);
            return;
        }
        loop->boxes[v] = round_outward(wide4_min(from, to) - growth, wide4_max(from, to) + growth);
    }
}

int32_t pel_boxes_of_motion(const pel_frame *frame, const pel_motion *motion, double reach, pel_pool *pool,
                            pel_box *boxes)
{
    box_loop loop = {motion, frame, widen(frame, reach), boxes, INT32_MAX};
    pel_pool_run(pool, (motion->vertex_count + POINTS_PER_CHUNK - 1) / POINTS_PER_CHUNK, box_chunk, &loop);
    return loop.bad < INT32_MAX ? loop.bad : -1;
}
