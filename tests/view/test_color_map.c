#include "check.h"
#include "source_dir.h"

#include "pellicle/render.h"

/* the formulas are fits; the published tables are met within this, of 255 */
enum { FIT_ERROR = 5 };

static void check_color(pel_color_map map, double at, int red, int green, int blue)
{
    uint8_t rgb[3];
    pel_color_map_sample(map, at, rgb);
    assert_near(rgb[0], red, FIT_ERROR);
    assert_near(rgb[1], green, FIT_ERROR);
    assert_near(rgb[2], blue, FIT_ERROR);
}

/* colors of the published maps */
static void test_known_colors(void **unused)
{
    (void)unused;
    check_color(PEL_COLORS_VIRIDIS, 0, 68, 1, 84);
    check_color(PEL_COLORS_VIRIDIS, 0.5, 33, 145, 140);
    check_color(PEL_COLORS_VIRIDIS, 1, 253, 231, 37);
    check_color(PEL_COLORS_CIVIDIS, 0, 0, 34, 78);
    check_color(PEL_COLORS_CIVIDIS, 0.5, 124, 123, 120);
    check_color(PEL_COLORS_COOL_WARM, 0, 59, 76, 192);
    check_color(PEL_COLORS_COOL_WARM, 0.5, 221, 221, 221);
    check_color(PEL_COLORS_COOL_WARM, 1, 180, 4, 38);
    check_color(PEL_COLORS_WARM, 0, 221, 221, 221);
    check_color(PEL_COLORS_WARM, 1, 180, 4, 38);
}

static double brightness(pel_color_map map, double at)
{
    uint8_t rgb[3];
    pel_color_map_sample(map, at, rgb);
    return 0.2126 * pow(rgb[0] / 255.0, 2.2) + 0.7152 * pow(rgb[1] / 255.0, 2.2) + 0.0722 * pow(rgb[2] / 255.0, 2.2);
}

/* viridis and cividis grow brighter all the way, cool-warm up to the middle and darker from there, warm
   darker all the way */
static void test_brightness(void **unused)
{
    (void)unused;
    const double rounding = 0.004;
    for (int i = 0; i < 100; ++i) {
        double at = i / 100.0, next = at + 0.01;
        assert_true(brightness(PEL_COLORS_VIRIDIS, next) > brightness(PEL_COLORS_VIRIDIS, at) - rounding);
        assert_true(brightness(PEL_COLORS_CIVIDIS, next) > brightness(PEL_COLORS_CIVIDIS, at) - rounding);
        double rise = brightness(PEL_COLORS_COOL_WARM, next) - brightness(PEL_COLORS_COOL_WARM, at);
        assert_true((at < 0.5 ? rise : -rise) > -rounding);
        assert_true(brightness(PEL_COLORS_WARM, next) < brightness(PEL_COLORS_WARM, at) + rounding);
    }
}

static void test_odd_values(void **unused)
{
    (void)unused;
    uint8_t rgb[3], end[3];
    for (int map = 0; map < PEL_COLORS_COUNT; ++map) {
        pel_color_map_sample((pel_color_map)map, 1, end);
        pel_color_map_sample((pel_color_map)map, 7, rgb);
        assert_memory_equal(rgb, end, 3);
        pel_color_map_sample((pel_color_map)map, 0, end);
        pel_color_map_sample((pel_color_map)map, -HUGE_VAL, rgb);
        assert_memory_equal(rgb, end, 3);
        pel_color_map_sample((pel_color_map)map, (double)NAN, rgb);
        assert_true(rgb[0] == 128 && rgb[1] == 128 && rgb[2] == 128);
    }
}

static void test_names(void **unused)
{
    (void)unused;
    pel_color_map map;
    for (int i = 0; i < PEL_COLORS_COUNT; ++i) {
        assert_true(pel_color_map_find(pel_color_map_name(i), &map));
        assert_int_equal(map, i);
    }
    assert_null(pel_color_map_name(PEL_COLORS_COUNT));
    assert_null(pel_color_map_name(-1));
    assert_false(pel_color_map_find("jet", &map));
}

/* the pages' maps are this file's: web/src/colour.js has them as anchors at equal distances, "warm" as a half of
 * another */
static void test_pages(void **unused)
{
    (void)unused;
    char text[4096];
    FILE *file = fopen(PEL_SOURCE_DIR "/web/src/colour.js", "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    for (int map = 0; map < PEL_COLORS_WARM; ++map) {
        const char *at = strstr(strstr(text, "const anchors"), pel_color_map_name(map));
        assert_non_null(at);
        at = strstr(at, ": \"") + strlen(": \"");
        int count = ((int)strcspn(at, "\"") + 1) / (int)strlen("rrggbb ");
        assert_true(count > 16);
        for (int i = 0; i < count; ++i) {
            uint8_t rgb[3];
            char drawn[8];
            pel_color_map_sample((pel_color_map)map, i / (count - 1.0), rgb);
            snprintf(drawn, sizeof drawn, "%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
            assert_memory_equal(at + 7 * (size_t)i, drawn, 6);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_known_colors), cmocka_unit_test(test_brightness),
                                       cmocka_unit_test(test_odd_values), cmocka_unit_test(test_names),
                                       cmocka_unit_test(test_pages)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
