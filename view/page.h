/* The layout of one picture: a title, cells in rows and columns with a label under each, a color bar at the right. */
#ifndef PELLICLE_VIEW_PAGE_H
#define PELLICLE_VIEW_PAGE_H

#include "view/field.h"
#include "view/font.h"
#include "view/image.h"

#include "pellicle/render.h"

typedef struct view_page_def {
    int32_t columns, rows;
    int32_t width, height; /* 0 = 1280 x 720 for one cell, 480 x 400 for each of several */
    pel_background background;
    const char *title;     /* null or empty = none */
    const char *bar_title; /* null = no bar */
    bool labels;
} view_page_def;

typedef struct view_page {
    int32_t width, height, columns, rows;
    int32_t cell_width, cell_height; /* of the drawing, its label not counted */
    int32_t label_height;            /* below each cell */
    int32_t top, bar_width, text_size;
    view_color background, ink;
    const char *title;
    view_font *font;
} view_page;

/* Errors: PEL_BAD_ARGUMENT (too small), those of the font. The page is empty then. */
pel_status view_page_create(view_page *page, const view_page_def *def, pel_error *error);
void view_page_destroy(view_page *page);

/* upper left corner of a cell */
void view_page_cell(const view_page *page, int32_t cell, int32_t *x, int32_t *y);

/* background and title; the cells are drawn after it */
void view_page_begin(const view_page *page, view_image *image);
void view_page_label(const view_page *page, view_image *image, int32_t cell, const char *text);
void view_page_bar(const view_page *page, view_image *image, pel_color_map map, const view_scale *scale);

#endif
