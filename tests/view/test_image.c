#include "check.h"
#include "failing_malloc.h"

#include "view/font.h"
#include "view/image.h"

#include <png.h>
#include <stdlib.h>
#include <unistd.h>

static void test_blend(void **unused)
{
    (void)unused;
    view_image image;
    assert_int_equal(view_image_create(&image, 4, 3, NULL), PEL_OK);
    view_color white = {{255, 255, 255, 255}}, half = {{200, 100, 0, 128}};
    view_image_fill(&image, -5, -5, 7, 7, white);
    assert_int_equal(image.pixels[4 * (1 * 4 + 1) + 3], 255);
    assert_int_equal(image.pixels[4 * (1 * 4 + 2) + 3], 0);
    /* over white: half way; over nothing: the color itself with its alpha */
    view_image_blend(&image, 0, 0, half, 255);
    assert_near(image.pixels[0], 227, 1);
    assert_near(image.pixels[1], 177, 1);
    assert_int_equal(image.pixels[3], 255);
    view_image_blend(&image, 3, 2, half, 255);
    assert_int_equal(image.pixels[4 * 11], 200);
    assert_int_equal(image.pixels[4 * 11 + 3], 128);
    view_image_blend(&image, 4, 0, half, 255);
    view_image_blend(&image, 0, -1, half, 255);
    view_image_destroy(&image);
}

/* what is written is read back the same, and a picture that cannot be written leaves nothing */
static void test_png(void **unused)
{
    (void)unused;
    view_image image;
    assert_int_equal(view_image_create(&image, 33, 7, NULL), PEL_OK);
    for (int i = 0; i < 33 * 7 * 4; ++i)
        image.pixels[i] = (uint8_t)(i * 37);
    assert_int_equal(view_image_write(&image, "image-test.png", false, NULL), PEL_OK);
    png_image png = {.version = PNG_IMAGE_VERSION};
    uint8_t back[33 * 7 * 4];
    assert_true(png_image_begin_read_from_file(&png, "image-test.png"));
    assert_true(png.width == 33 && png.height == 7);
    png.format = PNG_FORMAT_RGBA;
    assert_true(png_image_finish_read(&png, NULL, back, 0, NULL));
    assert_memory_equal(back, image.pixels, sizeof back);
    unlink("image-test.png");
    pel_error error;
    assert_int_equal(view_image_write(&image, "no-such-folder/a.png", true, &error), PEL_BAD_FILE);
    assert_string_equal(error.file, "no-such-folder/a.png");
    view_image_destroy(&image);
}

static void test_font(void **unused)
{
    (void)unused;
    view_font *font;
    view_image image;
    assert_int_equal(view_font_create(20, &font, NULL), PEL_OK);
    assert_int_equal(view_image_create(&image, 100, 30, NULL), PEL_OK);
    assert_near(view_font_cap_height(font), 14.5, 1.5);
    assert_int_equal(view_font_width(font, ""), 0);
    int32_t width = view_font_width(font, "Ag 1µm");
    assert_true(width > 50 && width < 90);
    /* bytes that are no UTF-8 are drawn one by one, also at the end */
    assert_true(view_font_width(font, "\xff\xe2\x82") > 0);
    view_font_draw(font, &image, 5, 20, "Ag 1µm", (view_color){{0, 0, 0, 255}});
    int dark = 0;
    for (int i = 0; i < 100 * 30; ++i) {
        bool outside = i % 100 < 4 || i % 100 > width + 6;
        assert_false(outside && image.pixels[4 * i + 3] > 0);
        dark += image.pixels[4 * i + 3] > 200;
    }
    assert_true(dark > 100);
    view_font_destroy(font);
    view_image_destroy(&image);
}

static void test_no_font(void **unused)
{
    (void)unused;
    view_font *font;
    pel_error error;
    setenv("PELLICLE_FONT", "no-such.ttf", 1);
    assert_int_equal(view_font_create(20, &font, &error), PEL_BAD_FILE);
    unsetenv("PELLICLE_FONT");
    assert_null(font);
    assert_string_equal(error.file, "no-such.ttf");
    assert_non_null(strstr(error.remedy, "fonts-dejavu-core"));
}

static pel_status create_case(const void *data, pel_error *error)
{
    (void)data;
    view_image image;
    view_font *font;
    pel_status status = view_image_create(&image, 8, 8, error);
    if (status == PEL_OK)
        status = view_font_create(12, &font, error);
    if (status == PEL_OK)
        view_font_destroy(font);
    view_image_destroy(&image);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    assert_int_equal(for_every_allocation_failure(create_case, NULL), 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_blend), cmocka_unit_test(test_png),
                                       cmocka_unit_test(test_font), cmocka_unit_test(test_no_font),
                                       cmocka_unit_test(test_out_of_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
