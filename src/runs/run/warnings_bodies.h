/* Warnings about bodies: what they are made of, what fills them, and whether anything acts on them. */
#ifndef PEL_RUN_WARNINGS_BODIES_H
#define PEL_RUN_WARNINGS_BODIES_H

#include "run/state.h"

/* where the text of a warning goes */
typedef struct pel_warning_text {
    const pel_run_state *run;
    const pel_warning_tally *tally;
    char *text;
    size_t size;
} pel_warning_text;

/* Counts one more of a body before the first step; remembers the first for the text. */
void pel_warn_body(pel_run_state *run, pel_warning_kind kind, int32_t body, double value, double limit);

/* Before the first step: size, Poisson's ratio and filling of a body. */
void pel_warnings_check_body(pel_run_state *run, int32_t body);
/* At the end: bodies that fell away, and scenes in which nothing acts. */
void pel_warnings_check_bodies_end(pel_run_state *run, int64_t frame);

void pel_tell_millimetres(const pel_warning_text *at);
void pel_tell_poisson(const pel_warning_text *at);
void pel_tell_weightless(const pel_warning_text *at);
void pel_tell_hollow(const pel_warning_text *at);
void pel_tell_falls(const pel_warning_text *at);
void pel_tell_nothing(const pel_warning_text *at);

#endif
