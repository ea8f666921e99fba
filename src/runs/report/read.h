/* One run as a report holds it. */
#ifndef PEL_REPORT_READ_H
#define PEL_REPORT_READ_H

#include "io/json.h"
#include "pellicle/frames.h"
#include "pellicle/report.h"
#include "report/report_pack.h"

/* a field that all frames have */
typedef struct pel_report_field {
    char name[PEL_NAME_SIZE];
    int32_t component_count;
    int32_t frame_count;                  /* frames that have it */
    double low, high;                     /* of the components */
    double magnitude_low, magnitude_high; /* of the lengths; of the values of a scalar */
    int32_t place;                        /* in the user's list */
} pel_report_field;

/* the triangles of some frames */
typedef struct pel_report_topology {
    uint64_t hash;
    int32_t vertex_count, triangle_count;
    bool written;
} pel_report_topology;

/* how much of the run is kept */
typedef struct pel_report_plan {
    bool components; /* vectors with their components; else their lengths */
    int32_t bits;    /* 16 or 8, of fields */
    int32_t stride;  /* every stride-th frame and the last */
} pel_report_plan;

typedef struct pel_report_run {
    const char *folder;
    pel_frames *frames;
    pel_report_field *fields;
    int32_t field_count;
    pel_report_topology *topologies;
    int32_t topology_count;
    int32_t *frame_topology;              /* (frame_count) */
    int32_t vertex_limit, triangle_limit; /* largest counts of all frames */
    double low[3], high[3];               /* m, box around all frames */
    pel_report_plan plan;
    int32_t frames_kept;
    pel_report_pack pack;
    pel_json json;
} pel_report_run;

/* Reads all frames of the run: box, fields, topologies. Fill `folder` first, everything else zero. */
pel_status pel_report_run_survey(pel_report_run *run, const pel_report_def *def, pel_error *error);

/* Packs the frames into at most `limit` bytes, choosing the plan. */
pel_status pel_report_run_pack(pel_report_run *run, size_t limit, pel_error *error);

/* whether the plan keeps the frame */
bool pel_report_run_keeps(const pel_report_run *run, int32_t frame);

/* Fills `json` with everything except the packed frames; log (nullable) receives notes on omitted data. */
pel_status pel_report_run_describe(pel_report_run *run, const pel_log *log, pel_error *error);

/* Adds the member `tools` to `json`: surfaces, and their poses in the kept frames. Errors: those of
   pel_frames_read_tool. */
pel_status pel_report_run_put_tools(pel_report_run *run, pel_error *error);

/* largest size of the files that pel_report_run_describe includes */
enum { PEL_REPORT_TEXT_LIMIT = 1 << 21 };

void pel_report_run_free(pel_report_run *run);

#endif
