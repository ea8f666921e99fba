/* Displayed numbers: selection, names and formats. */
#ifndef PELLICLE_VIEW_FIELD_H
#define PELLICLE_VIEW_FIELD_H

#include "pellicle/mesh.h"

/* Takes the field apart: values (vertex_count) gets the numbers, or magnitudes when component is -1 and there are
   several components. The range (low, high) is widened by them. place names the frame in messages. Errors:
   PEL_BAD_ARGUMENT (no such field, with the nearest name; no such component), PEL_BAD_FORMAT (NaN or infinity, with the
   vertex). */
pel_status view_field_take(const pel_mesh *mesh, const char *name, int32_t component, const char *place, double *values,
                           double range[2], pel_error *error);

/* the field of that name; PEL_BAD_ARGUMENT with the nearest name if there is none */
pel_status view_field_find(const pel_mesh *mesh, const char *name, const char *place, const pel_field **field,
                           pel_error *error);

/* SI unit of a quantity that is known by its name, "" otherwise */
const char *view_field_unit(const char *name);

enum { VIEW_TEXT_SIZE = 128, VIEW_TICKS = 12 };

/* The numbers of a color bar. */
typedef struct view_scale {
    char title[VIEW_TEXT_SIZE]; /* "mean curvature", "force z" */
    char unit[VIEW_TEXT_SIZE];  /* "mm", "×10⁻⁶"; may be empty */
    int count;
    double at[VIEW_TICKS];     /* (count) 0 .. 1 from low to high */
    char text[VIEW_TICKS][32]; /* (count) */
} view_scale;

/* Round numbers between range[0] and range[1], about five; unit null = the unit of the field's name. */
void view_scale_make(view_scale *scale, const char *name, int32_t component, int32_t component_count, const char *unit,
                     const double range[2]);

#endif
