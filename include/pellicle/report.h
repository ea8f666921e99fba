/* Pellicle: reports. A report is one HTML file that contains one or several runs and shows them in a browser, without a
   network. */
#ifndef PELLICLE_REPORT_H
#define PELLICLE_REPORT_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pel_report_def {
    const char *page;           /* path of the page without data, report.html, which `make web` builds */
    const char *const *folders; /* (folder_count) folders of runs */
    int32_t folder_count;       /* >= 1 */
    const char *const *fields;  /* (field_count) fields of the report; the page shows the first one first; null = all */
    int32_t field_count;
    int64_t size_limit; /* bytes; larger reports are thinned as pel_report_write describes */
    const pel_log *log; /* receives notes on thinning; nullable */
    uint32_t cookie;    /* set by pel_report_def_default */
} pel_report_def;

/* No page and no folders, all fields, 25,000,000 bytes. */
PEL_API pel_report_def pel_report_def_default(void);

typedef struct pel_report_summary {
    int64_t size;        /* bytes written */
    int64_t frame_count; /* of all runs, in the report */
    int64_t frame_total; /* of all runs, in their folders */
} pel_report_summary;

/* Writes a report. Positions are rounded to 1/65535 of the bounding box of the run, fields to 1/65535 of their range.
   If the report exceeds size_limit, it is thinned in this order: only the magnitudes of vectors are kept, fields are
   rounded to 1/255 of their range, frames are omitted at regular intervals. The page lists these changes. summary is
   nullable. Errors: PEL_BAD_ARGUMENT (no folder; a field that a run does not have; a single frame exceeds the limit),
   PEL_BAD_FILE (the page is missing; the report cannot be written), PEL_BAD_FORMAT (the page is of another version),
   and those of pel_frames_open and pel_frames_read. After an error nothing is written. */
PEL_API pel_status pel_report_write(const char *path, const pel_report_def *def, pel_report_summary *summary,
                                    pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
