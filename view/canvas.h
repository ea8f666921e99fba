/* OpenGL without a display: one drawing surface in memory, lit triangles on it, the result as an image. */
#ifndef PELLICLE_VIEW_CANVAS_H
#define PELLICLE_VIEW_CANVAS_H

#include "view/camera.h"
#include "view/image.h"
#include "view/soup.h"

typedef struct view_canvas view_canvas;

/* How triangles look. Colors are sRGB. */
typedef struct view_look {
    bool colored;         /* by the value of the corners along the color map, otherwise plain */
    view_color plain;     /* with alpha below 255 drawn see-through, nearest side only */
    double edge_width;    /* pixels; 0 = no edges */
    double edge_strength; /* 0 .. 1 */
    double highlight;     /* strength of the gloss */
} view_look;

/* Errors: PEL_BAD_ARGUMENT (no OpenGL; too large), PEL_OUT_OF_MEMORY. On failure *canvas is null. A canvas belongs to
   the thread that made it; one at a time. */
pel_status view_canvas_create(int32_t width, int32_t height, view_canvas **canvas, pel_error *error);
void view_canvas_destroy(view_canvas *canvas);

const char *view_canvas_renderer(const view_canvas *canvas);
void view_canvas_set_color_map(view_canvas *canvas, pel_color_map map);

/* Empties the canvas and sets the camera for what is drawn until view_canvas_read. */
void view_canvas_begin(view_canvas *canvas, const view_camera *camera, view_color background);
void view_canvas_draw(view_canvas *canvas, const view_soup *soup, const view_look *look);
/* Copies the canvas into the image with its upper left corner at x, y; it must fit in. */
pel_status view_canvas_read(view_canvas *canvas, view_image *image, int32_t x, int32_t y, pel_error *error);

#endif
