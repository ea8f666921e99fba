/* The layout of one picture: a title, cells in rows and columns with a label under each, color bars at the right. */
#ifndef PELLICLE_VIEW_SHEET_LAYOUT_H
#define PELLICLE_VIEW_SHEET_LAYOUT_H

#include "view/field.h"
#include "view/font.h"
#include "view/image.h"

#include "pellicle/render.h"

typedef struct view_sheet_def {
    int32_t columns, rows;
    int32_t width, height; /* 0 = 1280 x 720 for one cell, 480 x 400 for each of several */
    pel_background background;
    const char *title;             /* null or empty = none */
    const char *const *bar_titles; /* (bar_count) */
    int32_t bar_count;
    bool labels;
} view_sheet_def;

typedef struct view_sheet {
    int32_t width, height, columns, rows;
    int32_t cell_width, cell_height; /* of the drawing, its label not counted */
    int32_t label_height;            /* below each cell */
    int32_t top, text_size;
    int32_t bar_columns, bar_rows, bar_width; /* number of rows of bars, and the width of each */
    view_color background, ink;
    const char *title;
    view_font *font;
} view_sheet;

/* Errors: PEL_BAD_ARGUMENT (too small), those of the font. The page is empty then. */
pel_status view_sheet_create(view_sheet *page, const view_sheet_def *def, pel_error *error);
void view_sheet_destroy(view_sheet *page);

/* upper left corner of a cell */
void view_sheet_cell(const view_sheet *page, int32_t cell, int32_t *x, int32_t *y);

/* background and title; the cells are drawn after it */
void view_sheet_begin(const view_sheet *page, view_image *image);
void view_sheet_label(const view_sheet *page, view_image *image, int32_t cell, const char *text);
void view_sheet_bar(const view_sheet *page, view_image *image, int32_t bar, pel_color_map map, const view_scale *scale);

#endif
