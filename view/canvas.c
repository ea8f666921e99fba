/* Lines and text on a picture: coverage of a pixel by its distance from the line. */
#include "pellicle/render.h"

#include "view/font.h"
#include "view/image.h"
#include "view/support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LARGEST = 16384, FONT_SIZE = 13 };

struct pel_canvas {
    view_image image;
    view_image label; /* text before it is turned: the larger side x 3 heights of the font */
    uint8_t *cover;   /* (height x width) of the line at hand, 0 to 255 */
    view_font *font;
    int32_t font_size; /* pixels */
    double scale;
};

static const view_color white = {{255, 255, 255, 255}}, black = {{0, 0, 0, 255}};

static pel_status make(pel_canvas *c, int32_t width, int32_t height, pel_error *error)
{
    pel_status status = view_image_create(&c->image, width, height, error);
    if (status == PEL_OK)
        status = view_image_create(&c->label, width > height ? width : height, 3 * c->font_size, error);
    if (status != PEL_OK)
        return status;
    c->cover = view_allocate((size_t)width * (size_t)height, 1);
    if (c->cover == NULL)
        return pel_fail_memory(error);
    view_image_fill(&c->image, 0, 0, width, height, white);
    return view_font_create(c->font_size, &c->font, error);
}

pel_status pel_canvas_create(double width, double height, double scale, pel_canvas **canvas, pel_error *error)
{
    if (canvas == NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "canvas must not be null");
    *canvas = NULL;
    const double right = width * scale, bottom = height * scale;
    if (!(right >= 1 && right <= LARGEST && bottom >= 1 && bottom <= LARGEST && scale >= 0.25 && scale <= 8))
        return pel_fail(error, PEL_BAD_ARGUMENT, "a picture of %g x %g units of %g pixels cannot be drawn", width,
                        height, scale);
    pel_canvas *made = view_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->scale = scale;
    made->font_size = (int32_t)(FONT_SIZE * scale + 0.5);
    pel_status status = make(made, (int32_t)(right + 0.5), (int32_t)(bottom + 0.5), error);
    if (status == PEL_OK)
        *canvas = made;
    else
        pel_canvas_destroy(made);
    return status;
}

void pel_canvas_destroy(pel_canvas *canvas)
{
    if (canvas == NULL)
        return;
    view_font_destroy(canvas->font);
    free(canvas->cover);
    view_image_destroy(&canvas->label);
    view_image_destroy(&canvas->image);
    free(canvas);
}

/* the whole number at or below x, within 0 and limit */
static int32_t clamp_pixel(double x, int32_t limit)
{
    return x > 0 ? x < limit ? (int32_t)x : limit : 0;
}

static double distance_to_segment(double x, double y, const double a[2], const double b[2])
{
    const double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
    double t = square > 0 ? ((x - a[0]) * dx + (y - a[1]) * dy) / square : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return sqrt((x - a[0] - t * dx) * (x - a[0] - t * dx) + (y - a[1] - t * dy) * (y - a[1] - t * dy));
}

/* raises the coverage of pixels near a segment, in pixels */
static void cover_segment(pel_canvas *c, const double a[2], const double b[2], double width)
{
    const double reach = 0.5 * width + 1;
    const double low[2] = {a[0] < b[0] ? a[0] : b[0], a[1] < b[1] ? a[1] : b[1]};
    const double high[2] = {a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1]};
    const int32_t left = clamp_pixel(low[0] - reach, c->image.width),
                  right = clamp_pixel(high[0] + reach + 1, c->image.width);
    const int32_t top = clamp_pixel(low[1] - reach, c->image.height),
                  end = clamp_pixel(high[1] + reach + 1, c->image.height);
    for (int32_t y = top; y < end; ++y)
        for (int32_t x = left; x < right; ++x) {
            double part = 0.5 * width + 0.5 - distance_to_segment(x + 0.5, y + 0.5, a, b);
            /* lines thinner than a pixel are pale */
            part = part > 1 ? 1 : part;
            part = part > width ? width : part;
            uint8_t *cover = &c->cover[(size_t)y * (size_t)c->image.width + (size_t)x];
            if (part > 0 && (uint8_t)(255 * part) > *cover)
                *cover = (uint8_t)(255 * part);
        }
}

static view_color color_of(const uint8_t rgb[3])
{
    return (view_color){{rgb[0], rgb[1], rgb[2], 255}};
}

void pel_canvas_line(pel_canvas *canvas, const double *points, int32_t count, double width, const uint8_t rgb[3])
{
    if (canvas == NULL || points == NULL || rgb == NULL || !(width > 0))
        return;
    const double s = canvas->scale;
    memset(canvas->cover, 0, (size_t)canvas->image.width * (size_t)canvas->image.height);
    for (int32_t i = 0; i < count; ++i) {
        const double *from = points + 2 * (i > 0 ? i - 1 : 0), *to = points + 2 * i;
        const double a[2] = {s * from[0], s * from[1]}, b[2] = {s * to[0], s * to[1]};
        if (isfinite(a[0]) && isfinite(a[1]) && isfinite(b[0]) && isfinite(b[1]))
            cover_segment(canvas, a, b, s * width);
    }
    for (int32_t y = 0; y < canvas->image.height; ++y)
        for (int32_t x = 0; x < canvas->image.width; ++x)
            view_image_blend(&canvas->image, x, y, color_of(rgb),
                             canvas->cover[(size_t)y * (size_t)canvas->image.width + (size_t)x]);
}

void pel_canvas_fill(pel_canvas *canvas, double x, double y, double width, double height, const uint8_t rgb[3])
{
    if (canvas == NULL || rgb == NULL || !isfinite(x + y + width + height))
        return;
    const double s = canvas->scale;
    const int32_t left = clamp_pixel(s * x + 0.5, canvas->image.width);
    const int32_t top = clamp_pixel(s * y + 0.5, canvas->image.height);
    const int32_t right = clamp_pixel(s * (x + width) + 0.5, canvas->image.width);
    const int32_t bottom = clamp_pixel(s * (y + height) + 0.5, canvas->image.height);
    view_image_fill(&canvas->image, left, top, right - left, bottom - top, color_of(rgb));
}

/* text on its side: drawn on the label, then turned */
static void draw_upward(pel_canvas *c, int32_t x, int32_t y, int32_t width, const char *text)
{
    const int32_t base = 2 * c->font_size;
    memset(c->label.pixels, 0, 4 * (size_t)c->label.width * (size_t)c->label.height);
    view_font_draw(c->font, &c->label, 0, base, text, black);
    for (int32_t row = 0; row < c->label.height; ++row)
        for (int32_t column = 0; column < c->label.width && column <= width; ++column) {
            const uint8_t cover = c->label.pixels[4 * ((size_t)row * (size_t)c->label.width + (size_t)column) + 3];
            view_image_blend(&c->image, x + row - base, y - column, black, cover);
        }
}

void pel_canvas_text(pel_canvas *canvas, double x, double y, pel_canvas_anchor anchor, bool upward, const char *text)
{
    if (canvas == NULL || text == NULL || !(fabs(x) < LARGEST && fabs(y) < LARGEST))
        return;
    const int32_t width = view_font_width(canvas->font, text);
    const int32_t before = anchor == PEL_CANVAS_MIDDLE ? width / 2 : anchor == PEL_CANVAS_END ? width : 0;
    const int32_t column = (int32_t)floor(x * canvas->scale + 0.5), row = (int32_t)floor(y * canvas->scale + 0.5);
    if (upward)
        draw_upward(canvas, column, row + before, width, text);
    else
        view_font_draw(canvas->font, &canvas->image, column - before, row, text, black);
}

pel_status pel_canvas_write(const pel_canvas *canvas, const char *path, pel_error *error)
{
    if (canvas == NULL || path == NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "%s must not be null", canvas == NULL ? "canvas" : "path");
    return view_image_write(&canvas->image, path, false, error);
}
