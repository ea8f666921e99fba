/* Positions of vertices over time, and one moment of them. */
#ifndef PEL_SEQUENCE_SEQUENCE_H
#define PEL_SEQUENCE_SEQUENCE_H

#include "pellicle/sequence.h"

#include <stddef.h>
#include <stdint.h>

struct pel_sequence {
    double *times;          /* (frame_count) s, rising */
    double (*positions)[3]; /* (frame_count vertex_count) m */
    int32_t frame_count, vertex_count;
    double speed;         /* m/s, the largest of a vertex */
    uint64_t fingerprint; /* of all numbers */
    _Atomic int32_t owner_count;
};

/* Two frames and the share of the second one. */
typedef struct pel_sequence_moment {
    const double (*before)[3], (*after)[3];
    double share;
} pel_sequence_moment;

pel_sequence_moment pel_sequence_find(const pel_sequence *sequence, double time);

static inline void pel_sequence_point(const pel_sequence_moment *moment, int32_t v, double point[3])
{
    const double *a = moment->before[v], *b = moment->after[v];
    for (int k = 0; k < 3; k++)
        point[k] = a[k] + moment->share * (b[k] - a[k]);
}

/* within the times of the frames */
double pel_sequence_clamp(const pel_sequence *sequence, double time);

/* One owner more of the same sequence; each destroys it once. From any thread. */
const pel_sequence *pel_sequence_share(const pel_sequence *sequence);

/* Zeroed frames with their times; speed and fingerprint are those of pel_sequence_finish. PEL_OUT_OF_MEMORY. */
pel_status pel_sequence_allocate(int32_t frame_count, int32_t vertex_count, pel_sequence **sequence, pel_error *error);
void pel_sequence_finish(pel_sequence *sequence);

#endif
