/* Warnings about nets of springs. */
#ifndef PEL_RUN_WARNINGS_SPRINGS_H
#define PEL_RUN_WARNINGS_SPRINGS_H

#include "run/warnings_bodies.h"

/* Two axes of the plane of a flat mesh; false where it is not flat. */
bool pel_warnings_find_plane(const pel_mesh *mesh, double axes[2][3]);
/* At the end: flat nets that are stretched or sheared, and are stiffer or softer than their Young's modulus. */
void pel_warnings_check_springs(pel_run_state *run, int64_t frame);
void pel_tell_springs(const pel_warning_text *at);

#endif
