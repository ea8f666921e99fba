/* Text from a TrueType font through FreeType. */
#ifndef PELLICLE_VIEW_FONT_H
#define PELLICLE_VIEW_FONT_H

#include "view/image.h"

typedef struct view_font view_font;

/* The font of the environment variable PELLICLE_FONT or the one found at build time, `size` pixels high.
   Errors: PEL_BAD_FILE (no font), PEL_OUT_OF_MEMORY; *font is null then. */
pel_status view_font_create(int32_t size, view_font **font, pel_error *error);
void view_font_destroy(view_font *font);

/* pixels from the top of an A to the baseline */
int32_t view_font_cap_height(const view_font *font);
/* pixels that the UTF-8 text takes */
int32_t view_font_width(view_font *font, const char *text);
/* draws text that begins at x on the baseline y */
void view_font_draw(view_font *font, view_image *image, int32_t x, int32_t y, const char *text, view_color color);

#endif
