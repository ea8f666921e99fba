/* The pressure on a shell as one number, and its potential. */
#ifndef PEL_FORCE_PRESSURE_H
#define PEL_FORCE_PRESSURE_H

#include "model/shell.h"

/* Inside minus outside pressure [Pa]: positive inflates; a positive outside pressure gives a negative number. Triangles
   multiply it by their weight. The load factor multiplies a given pressure; volume is read by gas and target volume. A
   given pressure has its mean over the span, a target volume is that of its time. */
double pel_pressure_difference(const pel_shell *shell, pel_span span, double load_factor, double volume,
                               double rest_volume);

/* Its derivative by the volume [Pa/m3], <= 0. */
double pel_pressure_slope(const pel_shell *shell, double volume, double rest_volume);

/* True when the pressure is the negative gradient of a potential: consistent form, all of a closed body. */
bool pel_pressure_is_conservative(const pel_body *body);

/* True when all forces of the body's shell, if it has one, have a potential: such a pressure, no push of
   PEL_FIBRE_NORMAL. */
bool pel_shell_has_potential(const pel_body *body);

/* That potential [J] at a volume: minus the integral of the difference over the volume, 0 at the rest volume. */
double pel_pressure_potential(const pel_shell *shell, pel_span span, double load_factor, double volume,
                              double rest_volume);

/* The largest pressure from inside that a closed membrane balances when it grows alike in all directions, as a sphere
   does exactly: the largest dU/dV of its elastic energy. HUGE_VAL where the pressure rises without end, or where
   something else resists: springs, fibres. *ratio = volume there over that at rest. */
double pel_pressure_largest(const pel_model *model, int32_t body, double *ratio);
/* The first maximum of the pressure as it grows so, beyond which it jumps to a far larger size, or grows without end.
 */
double pel_pressure_peak(const pel_model *model, int32_t body, double *ratio);
/* The largest given pressure from inside over time, as far as it is the same everywhere; 0 = none. */
double pel_pressure_given(const pel_shell *shell);

/* Signed volume of a body at some positions, about its first vertex. */
double pel_body_volume(const pel_model *model, int32_t body, const pel_record *position);
double pel_body_area(const pel_model *model, int32_t body, const pel_record *position);

#endif
