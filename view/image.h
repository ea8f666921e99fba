/* Pictures in memory: sRGB with alpha, and drawing on them without OpenGL. */
#ifndef PELLICLE_VIEW_IMAGE_H
#define PELLICLE_VIEW_IMAGE_H

#include "pellicle/base.h"

/* (height x width x 4) bytes RGBA, top row first; alpha is not multiplied in */
typedef struct view_image {
    int32_t width, height;
    uint8_t *pixels;
} view_image;

typedef struct view_color {
    uint8_t rgba[4];
} view_color;

/* transparent black; PEL_OUT_OF_MEMORY leaves an empty image */
pel_status view_image_create(view_image *image, int32_t width, int32_t height, pel_error *error);
void view_image_destroy(view_image *image);

/* rectangles are cut at the border of the image */
void view_image_fill(view_image *image, int32_t x, int32_t y, int32_t width, int32_t height, view_color color);
/* lays the color over a pixel that covers / 255 of it; outside the image nothing happens */
void view_image_blend(view_image *image, int32_t x, int32_t y, view_color color, uint8_t cover);

/* Writes a PNG, without alpha when all is opaque, to a temporary file that is renamed at the end; fast ones are larger
   by a fifth. Errors: PEL_BAD_FILE. */
pel_status view_image_write(const view_image *image, const char *path, bool fast, pel_error *error);

#endif
