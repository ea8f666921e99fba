#include "misuse.h"

#include <pellicle/render.h>

#include <math.h>

static void test_render(void **unused)
{
    (void)unused;
    const char *inputs[2] = {"a.vtp", NULL};
    pel_color_map map;
    pel_camera_angle angle;
    uint8_t rgb[3];
    GIVES(pel_color_map_name(-1) == NULL && pel_color_map_name(1000) == NULL);
    GIVES(!pel_color_map_find(NULL, &map) && !pel_color_map_find("viridis", NULL));
    SURVIVES(pel_color_map_sample((pel_color_map)99, 0.5, rgb));
    SURVIVES(pel_color_map_sample(PEL_COLORS_VIRIDIS, (double)NAN, rgb));
    SURVIVES(pel_color_map_sample(PEL_COLORS_VIRIDIS, 1e300, rgb));
    GIVES(pel_camera_preset_name(-1) == NULL && pel_camera_preset_name(1000) == NULL);
    GIVES(!pel_camera_preset_find(NULL, &angle) && !pel_camera_preset_find("iso", NULL));
    const double points[4] = {0, 0, (double)NAN, 1e300};
    pel_canvas *canvas;
    REFUSED("canvas", pel_canvas_create(10, 10, 1, NULL, &error));
    REFUSED("drawn", pel_canvas_create((double)NAN, 10, 1, &canvas, &error));
    REFUSED("canvas", pel_canvas_write(NULL, "misuse.png", &error));
    SURVIVES(pel_canvas_destroy(NULL));
    SURVIVES(pel_canvas_line(NULL, points, 2, 1, rgb));
    SURVIVES(pel_canvas_fill(NULL, 0, 0, 1, 1, rgb));
    SURVIVES(pel_canvas_text(NULL, 0, 0, PEL_CANVAS_START, false, "text"));
    if (pel_canvas_create(10, 10, 1, &canvas, NULL) == PEL_OK) {
        REFUSED("path", pel_canvas_write(canvas, NULL, &error));
        SURVIVES(pel_canvas_line(canvas, NULL, 2, 1, rgb));
        SURVIVES(pel_canvas_line(canvas, points, -2, (double)NAN, rgb));
        SURVIVES(pel_canvas_fill(canvas, (double)NAN, 0, -5, 1e300, rgb));
        SURVIVES(pel_canvas_text(canvas, 1e300, (double)NAN, (pel_canvas_anchor)77, true, "\xff\xfe"));
        SURVIVES(pel_canvas_text(canvas, 0, 0, PEL_CANVAS_END, false, NULL));
        pel_canvas_destroy(canvas);
    }
    pel_render_def def = pel_render_def_default(), wrong;
    def.inputs = inputs, def.input_count = 1, def.output = "misuse.png";
    REFUSED("def", pel_render(NULL, NULL, NULL, &error));
    wrong = def, wrong.cookie = 0;
    REFUSED("def", pel_render(&wrong, NULL, NULL, &error));
    wrong = def, wrong.inputs = NULL;
    REFUSED("inputs", pel_render(&wrong, NULL, NULL, &error));
    wrong = def, wrong.inputs = &inputs[1];
    REFUSED("inputs", pel_render(&wrong, NULL, NULL, &error));
    wrong = def, wrong.input_count = -1;
    REFUSED("runs", pel_render(&wrong, NULL, NULL, &error));
    wrong = def, wrong.output = NULL;
    REFUSED("output", pel_render(&wrong, NULL, NULL, &error));
    wrong = def, wrong.frame_range_count = 3;
    REFUSED("frames", pel_render(&wrong, NULL, NULL, &error));
    wrong = def, wrong.frame_range_count = -3;
    REFUSED("frames", pel_render(&wrong, NULL, NULL, &error));
    wrong = def, wrong.width = wrong.height = INT32_MIN;
    REFUSED("size", pel_render(&wrong, NULL, NULL, &error));
    wrong = def, wrong.angle.zoom = (double)NAN;
    REFUSED("angle", pel_render(&wrong, NULL, NULL, &error));
    wrong = def, wrong.color_map = (pel_color_map)77;
    REFUSED("choice", pel_render(&wrong, NULL, NULL, &error));
    wrong = def, wrong.background = (pel_background)-3;
    REFUSED("choice", pel_render(&wrong, NULL, NULL, &error));
    wrong = def, wrong.up = 9;
    REFUSED("choice", pel_render(&wrong, NULL, NULL, &error));
    wrong = def, wrong.fixed_range = true, wrong.range[0] = (double)NAN;
    REFUSED("range", pel_render(&wrong, NULL, NULL, &error));
    wrong = def, wrong.frame_rate = (double)NAN;
    REFUSED("rate", pel_render(&wrong, NULL, NULL, &error));
    assert_int_equal(misuse_failures, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_render)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
