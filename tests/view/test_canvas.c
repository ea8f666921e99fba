#include "check.h"
#include "failing_malloc.h"

#include <pellicle/render.h>

#include <png.h>
#include <stdlib.h>
#include <unistd.h>

enum { SIDE = 120 };

typedef struct picture {
    int width, height;
    uint8_t *rgb; /* (height x width x 3) */
} picture;

/* the written picture, read by libpng */
static picture read_back(pel_canvas *canvas)
{
    png_image image = {.version = PNG_IMAGE_VERSION};
    assert_int_equal(pel_canvas_write(canvas, "canvas.png", NULL), PEL_OK);
    assert_true(png_image_begin_read_from_file(&image, "canvas.png"));
    image.format = PNG_FORMAT_RGB;
    picture made = {(int)image.width, (int)image.height, malloc(PNG_IMAGE_SIZE(image))};
    assert_non_null(made.rgb);
    assert_true(png_image_finish_read(&image, NULL, made.rgb, 0, NULL));
    unlink("canvas.png");
    return made;
}

static int at(const picture *p, int x, int y, int channel)
{
    return p->rgb[3 * (y * p->width + x) + channel];
}

/* sum of the darkness of a channel, in pixels */
static double ink(const picture *p, int channel)
{
    double sum = 0;
    for (int i = channel; i < 3 * p->width * p->height; i += 3)
        sum += (255 - p->rgb[i]) / 255.0;
    return sum;
}

static pel_canvas *make(double scale)
{
    pel_canvas *canvas;
    assert_int_equal(pel_canvas_create(SIDE, SIDE, scale, &canvas, NULL), PEL_OK);
    return canvas;
}

/* the ink of lines is their area with round ends; inside it is whole, and colours are those that were asked for */
static void test_lines(void **unused)
{
    (void)unused;
    static const uint8_t blue[3] = {0, 114, 178};
    for (int scale = 1; scale <= 2; scale++) {
        pel_canvas *canvas = make(scale);
        const double points[8] = {20, 30, 90, 30, 90, 100, 90, 100},
                     area = 140 * 6 + acos(-1) * 9 - 9 * (1 - acos(-1) / 4);
        pel_canvas_line(canvas, points, 4, 6, blue);
        picture p = read_back(canvas);
        assert_int_equal(p.width, scale * SIDE);
        for (int i = 0; i < 3; i++) {
            assert_int_equal(at(&p, 50 * scale, 30 * scale, i), blue[i]);
            assert_int_equal(at(&p, 50 * scale, 34 * scale, i), 255);
            assert_near(ink(&p, i) / ((255 - blue[i]) / 255.0) / scale / scale, area, 0.01 * area);
        }
        free(p.rgb);
        pel_canvas_destroy(canvas);
    }
}

static void test_dots_breaks_and_thin_lines(void **unused)
{
    (void)unused;
    static const uint8_t black[3] = {0, 0, 0};
    const double dot[2] = {60.3, 59.8}, broken[8] = {10, 10, 10, (double)NAN, 110, 10, 110, 110};
    const double outside[4] = {-1e300, 60, 1e300, 60}, thin[4] = {10, 20.5, 110, 20.5};
    pel_canvas *canvas = make(1);
    pel_canvas_line(canvas, dot, 1, 20, black);
    picture p = read_back(canvas);
    assert_near(ink(&p, 0), acos(-1) * 100, 2);
    free(p.rgb);
    /* only the last two points are joined */
    canvas = (pel_canvas_destroy(canvas), make(1));
    pel_canvas_line(canvas, broken, 4, 2, black);
    p = read_back(canvas);
    assert_int_equal(at(&p, 60, 10, 0), 255);
    assert_int_equal(at(&p, 109, 60, 0), 0);
    free(p.rgb);
    /* a quarter of a pixel is a quarter as dark */
    canvas = (pel_canvas_destroy(canvas), make(1));
    pel_canvas_line(canvas, thin, 2, 0.25, black);
    p = read_back(canvas);
    assert_near(at(&p, 60, 20, 0), 255 * 0.75, 1);
    free(p.rgb);
    pel_canvas_line(canvas, outside, 2, 4, black);
    pel_canvas_destroy(canvas);
}

static void test_rectangles(void **unused)
{
    (void)unused;
    static const uint8_t red[3] = {200, 10, 20};
    pel_canvas *canvas = make(2);
    pel_canvas_fill(canvas, 10, 20, 30.2, 5, red);
    pel_canvas_fill(canvas, 110, 110, 1e9, 1e9, red);
    picture p = read_back(canvas);
    for (int y = 0; y < p.height; y++)
        for (int x = 0; x < p.width; x++) {
            bool inside = (x >= 20 && x < 80 && y >= 40 && y < 50) || (x >= 220 && y >= 220);
            assert_int_equal(at(&p, x, y, 0), inside ? 200 : 255);
        }
    free(p.rgb);
    pel_canvas_destroy(canvas);
}

/* anchors move text by its width; upward text is the same pixels, turned by a quarter */
static void test_text(void **unused)
{
    (void)unused;
    picture parts[4];
    static const pel_canvas_anchor anchors[3] = {PEL_CANVAS_START, PEL_CANVAS_MIDDLE, PEL_CANVAS_END};
    int left[3], right[3];
    for (int i = 0; i < 4; i++) {
        pel_canvas *canvas = make(1);
        pel_canvas_text(canvas, 60, 60, i < 3 ? anchors[i] : PEL_CANVAS_START, i == 3, "Force g");
        parts[i] = read_back(canvas);
        pel_canvas_destroy(canvas);
    }
    for (int i = 0; i < 3; i++) {
        left[i] = SIDE, right[i] = 0;
        for (int k = 0; k < SIDE * SIDE; k++)
            if (parts[i].rgb[3 * k] < 128) {
                left[i] = k % SIDE < left[i] ? k % SIDE : left[i];
                right[i] = k % SIDE > right[i] ? k % SIDE : right[i];
            }
    }
    assert_true(left[0] >= 60 && left[0] <= 63 && right[2] <= 60 && right[2] >= 56);
    assert_near(left[1] + right[1], 120, 3);
    assert_int_equal(right[0] - left[0], right[2] - left[2]);
    assert_true(right[0] - left[0] > 30);
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            /* (x, y) from the anchor goes to (y, -x) */
            int column = 60 + (y - 60), row = 60 - (x - 60);
            if (row >= 0 && row < SIDE)
                assert_int_equal(at(&parts[0], x, y, 0), at(&parts[3], column, row, 0));
        }
    for (int i = 0; i < 4; i++)
        free(parts[i].rgb);
}

static void test_refused(void **unused)
{
    (void)unused;
    const double wrong[][3] = {{0, 10, 1},    {10, -1, 1}, {(double)NAN, 10, 1},  {20000, 10, 1},
                               {10, 10, 0.1}, {10, 10, 9}, {10, 10, (double)NAN}, {5000, 10, 4}};
    pel_canvas *canvas;
    pel_error error;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(pel_canvas_create(wrong[i][0], wrong[i][1], wrong[i][2], &canvas, &error), PEL_BAD_ARGUMENT);
        assert_null(canvas);
    }
    canvas = make(1);
    assert_int_equal(pel_canvas_write(canvas, "no/such/folder.png", &error), PEL_BAD_FILE);
    pel_canvas_destroy(canvas);
    pel_canvas_destroy(NULL);
}

static pel_status create(const void *unused, pel_error *error)
{
    (void)unused;
    pel_canvas *canvas;
    pel_status status = pel_canvas_create(20, 10, 1, &canvas, error);
    pel_canvas_destroy(canvas);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    assert_true(for_every_allocation_failure(create, NULL) > 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lines),      cmocka_unit_test(test_dots_breaks_and_thin_lines),
        cmocka_unit_test(test_rectangles), cmocka_unit_test(test_text),
        cmocka_unit_test(test_refused),    cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
