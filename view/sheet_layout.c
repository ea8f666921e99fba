#include "view/sheet_layout.h"

#include "view/support.h"

#include <stdio.h>

enum { LEAST_CELL = 16, MOST_PIXELS = 16384 };

static int32_t clamp(int32_t value, int32_t low, int32_t high)
{
    return value < low ? low : value > high ? high : value;
}

/* in hundredths of the height of the text */
static int32_t ems(const view_sheet *page, int32_t hundredths)
{
    return (page->text_size * hundredths + 50) / 100;
}

static pel_status fail_size(const view_sheet *page, pel_error *error)
{
    pel_fail(error, PEL_BAD_ARGUMENT, "a picture of %d x %d pixels has no room for %d x %d cells", (int)page->width,
             (int)page->height, (int)page->columns, (int)page->rows);
    pel_fail_remedy(error, "choose a larger size (at most %d pixels a side) or fewer frames", MOST_PIXELS);
    return PEL_BAD_ARGUMENT;
}

/* sizes of all parts; cells fill the space left by title, labels and bar */
static void lay_out(view_sheet *page, const view_sheet_def *def)
{
    page->top = page->title != NULL ? ems(page, 240) : ems(page, 40);
    page->label_height = def->labels ? ems(page, 190) : 0;
    page->bar_rows = clamp(def->bar_count, 1, page->rows);
    page->bar_columns = (def->bar_count + page->bar_rows - 1) / page->bar_rows;
    page->bar_width = ems(page, 560);
    for (int32_t bar = 0; bar < def->bar_count; ++bar) {
        int32_t title = view_font_width(page->font, def->bar_titles[bar]) + ems(page, 100);
        page->bar_width = title > page->bar_width ? title : page->bar_width;
    }
    int32_t bars_width = page->bar_columns * page->bar_width;
    if (def->width == 0 && page->columns * page->rows > 1)
        page->width = page->columns * page->cell_width + bars_width;
    if (def->height == 0 && page->columns * page->rows > 1)
        page->height = page->rows * page->cell_height + page->top;
    page->cell_width = (page->width - bars_width) / page->columns;
    page->cell_height = (page->height - page->top) / page->rows - page->label_height;
}

pel_status view_sheet_create(view_sheet *page, const view_sheet_def *def, pel_error *error)
{
    static const view_color backgrounds[] = {{{255, 255, 255, 255}}, {{24, 27, 32, 255}}, {{255, 255, 255, 0}}};
    static const view_color inks[] = {{{34, 36, 40, 255}}, {{226, 229, 233, 255}}, {{34, 36, 40, 255}}};
    bool alone = def->columns * def->rows == 1;
    *page = (view_sheet){.columns = def->columns, .rows = def->rows, .width = def->width, .height = def->height};
    page->background = backgrounds[def->background];
    page->ink = inks[def->background];
    page->title = def->title != NULL && def->title[0] != '\0' ? def->title : NULL;
    if (alone && def->width == 0) {
        page->width = 1280;
        page->height = 720;
    }
    page->cell_width = def->width > 0 ? def->width / def->columns : alone ? 1280 : 480;
    page->cell_height = def->height > 0 ? def->height / def->rows : alone ? 720 : 400;
    int32_t shorter = page->cell_width < page->cell_height ? page->cell_width : page->cell_height;
    page->text_size = clamp(5 + shorter / 36, 9, 40);
    pel_status status = view_font_create(page->text_size, &page->font, error);
    if (status != PEL_OK)
        return status;
    lay_out(page, def);
    if (page->cell_width < LEAST_CELL || page->cell_height < LEAST_CELL || page->width > MOST_PIXELS ||
        page->height > MOST_PIXELS)
        status = fail_size(page, error);
    if (status != PEL_OK)
        view_sheet_destroy(page);
    return status;
}

void view_sheet_destroy(view_sheet *page)
{
    view_font_destroy(page->font);
    *page = (view_sheet){0};
}

void view_sheet_cell(const view_sheet *page, int32_t cell, int32_t *x, int32_t *y)
{
    *x = cell % page->columns * page->cell_width;
    *y = page->top + cell / page->columns * (page->cell_height + page->label_height);
}

/* text centered between two columns of pixels, or begun at the first when it is too long */
static void draw_centered(const view_sheet *page, view_image *image, int32_t x, int32_t width, int32_t line,
                          const char *text)
{
    int32_t spare = width - view_font_width(page->font, text);
    view_font_draw(page->font, image, x + (spare > 0 ? spare / 2 : 0), line, text, page->ink);
}

void view_sheet_begin(const view_sheet *page, view_image *image)
{
    view_image_fill(image, 0, 0, page->width, page->height, page->background);
    if (page->title != NULL)
        draw_centered(page, image, 0, page->width, ems(page, 160), page->title);
}

void view_sheet_label(const view_sheet *page, view_image *image, int32_t cell, const char *text)
{
    int32_t x, y;
    view_sheet_cell(page, cell, &x, &y);
    draw_centered(page, image, x, page->cell_width, y + page->cell_height + ems(page, 115), text);
}

/* one pixel wide, half as strong as the text */
static void draw_frame(const view_sheet *page, view_image *image, int32_t x, int32_t y, int32_t width, int32_t height)
{
    for (int32_t i = 0; i < width; ++i) {
        view_image_blend(image, x + i, y, page->ink, 128);
        view_image_blend(image, x + i, y + height - 1, page->ink, 128);
    }
    for (int32_t i = 1; i + 1 < height; ++i) {
        view_image_blend(image, x, y + i, page->ink, 128);
        view_image_blend(image, x + width - 1, y + i, page->ink, 128);
    }
}

void view_sheet_bar(const view_sheet *page, view_image *image, int32_t bar, pel_color_map map, const view_scale *scale)
{
    int32_t area = (page->height - page->top) / page->bar_rows, title_lines = scale->unit[0] != '\0' ? 2 : 1;
    int32_t column = bar % page->bar_columns, top = page->top + bar / page->bar_columns * area;
    int32_t head = ems(page, 60 + 130 * title_lines), tall = area - head - ems(page, 150);
    int32_t height = clamp(tall, 2, ems(page, 1700)), width = ems(page, 90);
    int32_t x = page->width - (page->bar_columns - column) * page->bar_width + ems(page, 40);
    int32_t y = top + head + (tall > height ? (tall - height) / 2 : 0);
    for (int32_t row = 0; row < height; ++row) {
        view_color color = {{0, 0, 0, 255}};
        pel_color_map_sample(map, (height - 1 - row) / (double)(height > 1 ? height - 1 : 1), color.rgba);
        view_image_fill(image, x, y + row, width, 1, color);
    }
    draw_frame(page, image, x, y, width, height);
    int32_t half = view_font_cap_height(page->font) / 2, tick = ems(page, 30);
    for (int i = 0; i < scale->count; ++i) {
        int32_t line = y + (int32_t)((1 - scale->at[i]) * (height - 1) + 0.5);
        for (int32_t k = 0; k < tick; ++k)
            view_image_blend(image, x + width + k, line, page->ink, 200);
        view_font_draw(page->font, image, x + width + tick + ems(page, 25), line + half, scale->text[i], page->ink);
    }
    int32_t line = y - ems(page, 80);
    if (scale->unit[0] != '\0') {
        char unit[VIEW_TEXT_SIZE + 2];
        snprintf(unit, sizeof unit, "(%s)", scale->unit);
        view_font_draw(page->font, image, x, line, unit, page->ink);
        line -= ems(page, 125);
    }
    view_font_draw(page->font, image, x, line, scale->title, page->ink);
}
