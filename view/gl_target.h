/* OpenGL without a display: one drawing surface in memory, lit triangles on it, the result as an image. */
#ifndef PELLICLE_VIEW_GL_TARGET_H
#define PELLICLE_VIEW_GL_TARGET_H

#include "view/camera.h"
#include "view/image.h"
#include "view/triangle_list.h"

typedef struct view_gl_target view_gl_target;

/* How triangles look. Colors are sRGB. */
typedef struct view_look {
    bool colored;         /* by the value of the corners along the color map, otherwise plain */
    view_color plain;     /* with alpha below 255 drawn see-through, nearest side only */
    double edge_width;    /* pixels; 0 = no edges */
    double edge_strength; /* 0 .. 1 */
    double outline_width; /* pixels beyond the silhouette, drawn instead of the surface; 0 = the surface itself */
    double highlight;     /* strength of the gloss */
    double occlusion;     /* strength of shadows, 0 .. 1 */
    bool ground;          /* draw shadows only, faded by the value of the corners */
} view_look;

/* Errors: PEL_BAD_ARGUMENT (no OpenGL; too large), PEL_OUT_OF_MEMORY. On failure *canvas is null. A canvas belongs to
   the thread that made it; one at a time. */
pel_status view_gl_target_create(int32_t width, int32_t height, view_gl_target **canvas, pel_error *error);
void view_gl_target_destroy(view_gl_target *canvas);

const char *view_gl_target_renderer(const view_gl_target *canvas);
/* The colors of values from 0 to 1: a map, or `count` colors side by side, up to 64. */
void view_gl_target_set_color_map(view_gl_target *canvas, pel_color_map map);
void view_gl_target_set_palette(view_gl_target *canvas, const uint8_t (*colors)[3], int32_t count);
/* Calls `wanted` (nullable) while many triangles are drawn. After it returns false nothing is drawn, and
   view_gl_target_read returns PEL_STOPPED. */
void view_gl_target_watch(view_gl_target *canvas, bool (*wanted)(void *user), void *user);

/* Clears the canvas and sets the camera until view_gl_target_read. */
void view_gl_target_begin(view_gl_target *canvas, const view_camera *camera, view_color background);
/* Takes over the triangles and lights them. The first occluder_count corners cast shadows if they lie in a ball, which
   is the same for all pictures of a film to avoid flicker. */
void view_gl_target_load(view_gl_target *canvas, const view_triangle_list *soup, size_t occluder_count,
                         const double center[3], double radius);
/* Draws `count` corners from `first` of the list that was loaded. */
void view_gl_target_draw(view_gl_target *canvas, const view_triangle_list *soup, size_t first, size_t count,
                         const view_look *look);
/* Copies the canvas into the image with its upper left corner at x, y; it must fit in. Errors: PEL_STOPPED,
   PEL_OUT_OF_MEMORY. */
pel_status view_gl_target_read(view_gl_target *canvas, view_image *image, int32_t x, int32_t y, pel_error *error);

#endif
