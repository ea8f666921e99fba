#include "view/font.h"

#include "view/support.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include <stdlib.h>

struct view_font {
    FT_Library library;
    FT_Face face;
    int32_t cap_height;
};

static pel_status open_face(view_font *font, int32_t size, pel_error *error)
{
    const char *path = getenv("PELLICLE_FONT");
    if (path == NULL || path[0] == '\0')
        path = PELLICLE_VIEW_FONT;
    if (FT_Init_FreeType(&font->library) != 0)
        return pel_fail_memory(error);
    if (FT_New_Face(font->library, path, 0, &font->face) != 0 ||
        FT_Set_Pixel_Sizes(font->face, 0, (FT_UInt)size) != 0) {
        pel_fail(error, PEL_BAD_FILE, "the font for the labels cannot be read");
        pel_fail_place(error, path, 0, 0);
        pel_fail_remedy(error, "install the Debian package fonts-dejavu-core or set PELLICLE_FONT to a TrueType font");
        return PEL_BAD_FILE;
    }
    if (FT_Load_Char(font->face, 'A', FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT) == 0)
        font->cap_height = font->face->glyph->bitmap_top;
    return PEL_OK;
}

pel_status view_font_create(int32_t size, view_font **font, pel_error *error)
{
    *font = NULL;
    view_font *made = view_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    pel_status status = open_face(made, size, error);
    if (status == PEL_OK)
        *font = made;
    else
        view_font_destroy(made);
    return status;
}

void view_font_destroy(view_font *font)
{
    if (font == NULL)
        return;
    if (font->face != NULL)
        FT_Done_Face(font->face);
    if (font->library != NULL)
        FT_Done_FreeType(font->library);
    free(font);
}

int32_t view_font_cap_height(const view_font *font)
{
    return font->cap_height;
}

/* the next character of UTF-8 text; invalid bytes are returned as characters; 0 at the end */
static FT_ULong next_character(const char **text)
{
    const unsigned char *at = (const unsigned char *)*text;
    int more = at[0] >= 0xf0 ? 3 : at[0] >= 0xe0 ? 2 : at[0] >= 0xc0 ? 1 : 0;
    FT_ULong character = more > 0 ? at[0] & (0x3fu >> more) : at[0];
    for (int i = 1; i <= more; ++i) {
        if ((at[i] & 0xc0) != 0x80) {
            *text += 1;
            return at[0];
        }
        character = character << 6 | (at[i] & 0x3f);
    }
    *text += at[0] != 0 ? 1 + more : 0;
    return character;
}

int32_t view_font_width(view_font *font, const char *text)
{
    FT_Pos width = 0;
    for (FT_ULong c; (c = next_character(&text)) != 0;) {
        if (FT_Load_Char(font->face, c, FT_LOAD_TARGET_LIGHT) == 0)
            width += font->face->glyph->advance.x;
    }
    return (int32_t)((width + 32) / 64);
}

static void draw_glyph(FT_GlyphSlot glyph, view_image *image, int32_t x, int32_t y, view_color color)
{
    const FT_Bitmap *bitmap = &glyph->bitmap;
    for (unsigned row = 0; row < bitmap->rows; ++row) {
        const unsigned char *line = bitmap->buffer + (ptrdiff_t)row * bitmap->pitch;
        for (unsigned column = 0; column < bitmap->width; ++column)
            view_image_blend(image, x + glyph->bitmap_left + (int32_t)column, y - glyph->bitmap_top + (int32_t)row,
                             color, line[column]);
    }
}

void view_font_draw(view_font *font, view_image *image, int32_t x, int32_t y, const char *text, view_color color)
{
    FT_Pos pen = (FT_Pos)x * 64;
    for (FT_ULong c; (c = next_character(&text)) != 0;) {
        if (FT_Load_Char(font->face, c, FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT) != 0)
            continue;
        draw_glyph(font->face->glyph, image, (int32_t)((pen + 32) / 64), y, color);
        pen += font->face->glyph->advance.x;
    }
}
