/* Whole pictures. The golden ones in tests/view/golden were looked at; PELLICLE_UPDATE_GOLDEN=1 writes them anew.
   Skipped where there is no OpenGL. */
#include "check.h"
#include "failing_malloc.h"

#include "pellicle/mesh_io.h"
#include "pellicle/render.h"
#include "pellicle/results.h"
#include "pellicle/shape.h"
#include "source_dir.h"

#include <png.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* other versions of Mesa and FreeType round differently: mean difference of a byte, and share of bytes that may differ
   by more than a quarter of the range (borders of triangles and letters) */
static const double mean_tolerance = 1.5, share_tolerance = 0.01;
enum { WIDTH = 160, HEIGHT = 120, FRAMES = 3, FAR_OFF = 64 };

static bool can_draw;

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

/* three frames of a ball that is pressed, with a tool above it; made in the folder of the tests */
static void make_run(void)
{
    static const char scene[] =
        "version: 1\n"
        "bodies:\n"
        "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 3 }, springs: { stiffness: "
        "3 } }\n"
        "tools:\n"
        "  - name: probe\n"
        "    shape: sphere\n"
        "    radius: 0.4\n"
        "    motion: [{ time: 0, position: [0, 0, 1.5] }]\n"
        "duration: 1\n";
    const char *names[FRAMES] = {"f0.vtp", "f1.vtp", "f2.vtp"};
    const double times[FRAMES] = {0, 0.5, 1};
    pel_mesh *mesh;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    mkdir("render-run", 0777);
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    size_t count = (size_t)mesh->vertex_count;
    double(*move)[3] = calloc(count, sizeof *move), (*moved)[3] = calloc(count, sizeof *moved);
    for (int f = 0; f < FRAMES; ++f) {
        char path[64];
        for (size_t v = 0; v < count; ++v) {
            const double *at = mesh->positions[v];
            move[v][2] = -0.2 * f * exp(-4 * (at[0] * at[0] + at[1] * at[1])) * (at[2] > 0);
            for (int i = 0; i < 3; ++i)
                moved[v][i] = at[i] + move[v][i];
        }
        pel_vtp_field field = {"displacement", 3, move[0]};
        pel_vtp vtp = {.vertex_count = mesh->vertex_count,
                       .triangle_count = mesh->triangle_count,
                       .positions = moved[0],
                       .triangles = mesh->triangles[0],
                       .fields = &field,
                       .field_count = 1,
                       .time = times[f]};
        snprintf(path, sizeof path, "render-run/%s", names[f]);
        assert_int_equal(pel_vtp_write(path, &vtp, NULL), PEL_OK);
    }
    assert_int_equal(pel_pvd_write("render-run/frames.pvd", names, times, FRAMES, NULL), PEL_OK);
    write_text("render-run/scene.yaml", scene);
    write_text(
        "render-run/series.csv",
        "frame,time,max_displacement,probe_x,probe_y,probe_z\n0,0,0,0,0,1.5\n1,0.5,0.2,0,0,1.3\n2,1,0.4,0,0,1.1\n");
    assert_int_equal(pel_mesh_write("render-ball.ply", PEL_FORMAT_AUTO, mesh, NULL, NULL), PEL_OK);
    free(move);
    free(moved);
    pel_mesh_destroy(mesh);
}

static pel_render_def make_def(const char *const *inputs, int32_t input_count, const char *output)
{
    pel_render_def def = pel_render_def_default();
    def.inputs = inputs;
    def.input_count = input_count;
    def.output = output;
    def.width = WIDTH;
    def.height = HEIGHT;
    return def;
}

static uint8_t *read_png(const char *path, size_t *size)
{
    png_image png = {.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_file(&png, path))
        return NULL;
    png.format = PNG_FORMAT_RGBA;
    *size = PNG_IMAGE_SIZE(png);
    uint8_t *pixels = malloc(*size);
    assert_true(png_image_finish_read(&png, NULL, pixels, 0, NULL));
    return pixels;
}

static void check_golden(const char *drawn, const char *name)
{
    char path[512];
    size_t size = 0, golden_size = 0, far = 0;
    uint64_t sum = 0;
    uint8_t *pixels = read_png(drawn, &size);
    assert_non_null(pixels);
    snprintf(path, sizeof path, PEL_SOURCE_DIR "/tests/view/golden/%s.png", name);
    if (getenv("PELLICLE_UPDATE_GOLDEN") != NULL) {
        char command[1200];
        snprintf(command, sizeof command, "cp '%s' '%s'", drawn, path);
        assert_int_equal(system(command), 0);
    }
    uint8_t *golden = read_png(path, &golden_size);
    assert_non_null(golden);
    assert_int_equal(size, golden_size);
    for (size_t i = 0; i < size; ++i) {
        unsigned difference = (unsigned)abs(pixels[i] - golden[i]);
        sum += difference;
        far += difference > FAR_OFF;
    }
    assert_near((double)sum / (double)size, 0, mean_tolerance);
    assert_near((double)far / (double)size, 0, share_tolerance);
    free(pixels);
    free(golden);
}

static void draw(const pel_render_def *def)
{
    pel_error error;
    char text[1200];
    if (pel_render(def, NULL, NULL, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, text, sizeof text));
}

static void test_golden(void **unused)
{
    (void)unused;
    if (!can_draw)
        skip();
    const char *run = "render-run", *ball = "render-ball.ply", *two[] = {"render-run", "render-run/"};
    pel_render_def def = make_def(&run, 1, "render-plain.png");
    draw(&def);
    check_golden("render-plain.png", "run");
    def = make_def(&ball, 1, "render-ball.png");
    def.edges = def.flat = true;
    def.background = PEL_BACKGROUND_TRANSPARENT;
    draw(&def);
    check_golden("render-ball.png", "ball");
    const pel_frame_range frames = {0, 2, 2};
    def = make_def(two, 2, "render-sheet.png");
    def.width = 2 * WIDTH;
    def.height = 2 * HEIGHT;
    def.frames = &frames;
    def.frame_range_count = 1;
    def.component = 2;
    def.arrows = "displacement";
    def.background = PEL_BACKGROUND_DARK;
    def.title = "two runs";
    draw(&def);
    check_golden("render-sheet.png", "sheet");
}

/* two fields and a plain surface side by side, each with a scale of its own */
static void test_fields(void **unused)
{
    (void)unused;
    if (!can_draw)
        skip();
    const char *path = "render-fields.vtp", *both = "low,none,height";
    const double positions[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, low[4] = {0, 1, 2, 3}, high[4] = {7, 8, 9, 10};
    const int32_t triangles[6] = {0, 1, 2, 1, 3, 2};
    const pel_vtp_field fields[2] = {{"low", 1, low}, {"height", 1, high}};
    const pel_vtp vtp = {.vertex_count = 4,
                         .triangle_count = 2,
                         .positions = positions,
                         .triangles = triangles,
                         .fields = fields,
                         .field_count = 2};
    assert_int_equal(pel_vtp_write(path, &vtp, NULL), PEL_OK);
    pel_render_summary summary;
    pel_render_def def = make_def(&path, 1, "render-fields.png");
    def.width = 5 * WIDTH;
    def.field = both;
    def.angle = (pel_camera_angle){0, 90, 1};
    assert_int_equal(pel_render(&def, NULL, &summary, NULL), PEL_OK);
    assert_string_equal(summary.field, "low");
    assert_near(summary.range[1], 3, 0);
    check_golden("render-fields.png", "fields");
    /* the outline adds dark pixels around the surface */
    int dark[2] = {0};
    for (int outlined = 0; outlined < 2; ++outlined) {
        size_t size = 0;
        def = make_def((const char *[]){"render-ball.ply"}, 1, "render-outline.png");
        def.hide_ground = true;
        def.outline = outlined != 0;
        draw(&def);
        uint8_t *pixels = read_png("render-outline.png", &size);
        for (size_t i = 0; i < size; i += 4)
            dark[outlined] += pixels[i] < 80;
        free(pixels);
    }
    assert_int_equal(dark[0], 0);
    assert_true(dark[1] > 50);
}

/* the pixel in the middle of a half of the picture: 0 left, 1 right */
static void check_half(const char *path, int half, int red, int green, int blue)
{
    size_t size = 0;
    uint8_t *pixels = read_png(path, &size);
    const uint8_t *at = pixels + 4 * (size_t)(HEIGHT / 2 * WIDTH + WIDTH / 4 + half * WIDTH / 2);
    const int wanted[3] = {red, green, blue};
    /* the light from above changes the brightness, not the hue */
    for (int i = 0; i < 3; ++i)
        assert_true(abs(at[i] * wanted[0] - wanted[i] * at[0]) < 12 * 255);
    free(pixels);
}

/* bodies that no field colors have a color each; a single one may have a given color */
static void test_body_colors(void **unused)
{
    (void)unused;
    if (!can_draw)
        skip();
    static const uint8_t green_and_blue[2][3] = {{40, 160, 40}, {40, 40, 160}};
    const char *path = "render-bodies.vtp";
    const double positions[24] = {-2.1, -1, 0, -0.1, -1, 0, -2.1, 1, 0, -0.1, 1, 0,
                                  0.1,  -1, 0, 2.1,  -1, 0, 0.1,  1, 0, 2.1,  1, 0};
    const double numbers[8] = {0, 0, 0, 0, 9, 9, 9, 9};
    const int32_t triangles[12] = {0, 1, 2, 1, 3, 2, 4, 5, 6, 5, 7, 6};
    const pel_vtp_field body = {"body", 1, numbers};
    pel_vtp vtp = {.vertex_count = 8,
                   .triangle_count = 4,
                   .positions = positions,
                   .triangles = triangles,
                   .fields = &body,
                   .field_count = 1};
    assert_int_equal(pel_vtp_write(path, &vtp, NULL), PEL_OK);
    pel_render_def def = make_def(&path, 1, "render-bodies.png");
    def.field = "none";
    def.angle = (pel_camera_angle){0, 90, 1};
    draw(&def);
    check_half("render-bodies.png", 0, 217, 180, 160);
    /* after the eighth color comes the first one: body 9 has the second */
    check_half("render-bodies.png", 1, 74, 124, 178);
    def.body_colors = green_and_blue;
    def.body_color_count = 2;
    draw(&def);
    check_half("render-bodies.png", 0, 40, 160, 40);
    check_half("render-bodies.png", 1, 40, 40, 160);
    /* one body */
    vtp.field_count = 0;
    assert_int_equal(pel_vtp_write(path, &vtp, NULL), PEL_OK);
    draw(&def);
    check_half("render-bodies.png", 1, 40, 160, 40);
}

/* a field that is 0 everywhere is grey, as zero is in every other picture */
static void test_zero_field(void **unused)
{
    (void)unused;
    if (!can_draw)
        skip();
    const char *path = "render-zero.vtp";
    const double positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, zero[3] = {0};
    const int32_t triangles[3] = {0, 1, 2};
    const pel_vtp_field field = {"nothing", 1, zero};
    const pel_vtp vtp = {.vertex_count = 3,
                         .triangle_count = 1,
                         .positions = positions,
                         .triangles = triangles,
                         .fields = &field,
                         .field_count = 1};
    assert_int_equal(pel_vtp_write(path, &vtp, NULL), PEL_OK);
    pel_render_def def = make_def(&path, 1, "render-zero.png");
    def.field = field.name;
    def.hide_bar = true;
    def.hide_ground = true;
    def.angle = (pel_camera_angle){0, 90, 1};
    draw(&def);
    size_t size = 0;
    int dark = 0;
    uint8_t *pixels = read_png("render-zero.png", &size);
    for (size_t i = 0; i < size; i += 4) {
        assert_true(abs(pixels[i] - pixels[i + 1]) < 8 && abs(pixels[i + 1] - pixels[i + 2]) < 8);
        dark += pixels[i] < 240;
    }
    assert_true(dark > 1000);
    free(pixels);
}

/* a picture of a run shows the frame with the largest displacement, the last one where series.csv does not tell */
static void test_peak(void **unused)
{
    (void)unused;
    if (!can_draw)
        skip();
    static const char *const tables[2] = {"frame,time,max_displacement\n0,0,0\n1,0.5,0.2\n2,1,0.1\n",
                                          "frame,time\n0,0\n1,0.5\n2,1\n"};
    const char *run = "render-peak";
    pel_render_def def = make_def(&run, 1, "render-peak.png");
    assert_int_equal(system("rm -rf render-peak && cp -r render-run render-peak && rm render-peak/scene.yaml"), 0);
    for (int i = 0; i < 2; ++i) {
        size_t sizes[2];
        const pel_frame_range named = {1 + i, 1 + i, 1};
        FILE *file = fopen("render-peak/series.csv", "w");
        fputs(tables[i], file);
        fclose(file);
        def.frames = NULL;
        def.frame_range_count = 0;
        draw(&def);
        uint8_t *drawn = read_png("render-peak.png", &sizes[0]);
        def.frames = &named;
        def.frame_range_count = 1;
        draw(&def);
        uint8_t *expected = read_png("render-peak.png", &sizes[1]);
        assert_int_equal(sizes[0], sizes[1]);
        assert_memory_equal(drawn, expected, sizes[0]);
        free(drawn);
        free(expected);
    }
}

/* the same bits again, whatever the number of threads that draw */
static void test_deterministic(void **unused)
{
    (void)unused;
    if (!can_draw)
        skip();
    const char *run = "render-run";
    size_t size, other_size;
    pel_render_def def = make_def(&run, 1, "render-first.png");
    draw(&def);
    uint8_t *first = read_png("render-first.png", &size);
    for (int threads = 0; threads < LONG(3, 1); ++threads) {
        char number[16];
        snprintf(number, sizeof number, "%d", threads);
        setenv("LP_NUM_THREADS", number, 1);
        draw(&def);
        uint8_t *other = read_png("render-first.png", &other_size);
        assert_int_equal(size, other_size);
        assert_memory_equal(first, other, size);
        free(other);
    }
    unsetenv("LP_NUM_THREADS");
    free(first);
}

/* the camera and the colors are those of all frames, so what does not move looks the same in each */
static void test_folder(void **unused)
{
    (void)unused;
    if (!can_draw)
        skip();
    const char *run = "render-run";
    pel_render_summary summary;
    pel_render_def def = make_def(&run, 1, "render-out/deep");
    def.hide_tools = true;
    assert_int_equal(pel_render(&def, NULL, &summary, NULL), PEL_OK);
    assert_int_equal(summary.picture_count, FRAMES);
    assert_int_equal(summary.width, WIDTH);
    assert_string_equal(summary.field, "displacement");
    assert_near(summary.range[0], 0, 0);
    assert_near(summary.range[1], 0.4, 0.03);
    size_t size[2] = {0};
    uint8_t *pixels[2] = {read_png("render-out/deep/f00000.png", &size[0]),
                          read_png("render-out/deep/f00002.png", &size[1])};
    size_t row = 4 * WIDTH;
    assert_memory_equal(pixels[0] + 91 * row, pixels[1] + 91 * row, 11 * row);
    assert_true(memcmp(pixels[0], pixels[1], 60 * row) != 0);
    free(pixels[0]);
    free(pixels[1]);
}

/* a plate that covers the picture is seen, but hides little: white behind it keeps nine tenths of its light */
static void test_plate(void **unused)
{
    (void)unused;
    if (!can_draw)
        skip();
    const char *run = "plate-run", *frame = "f0.vtp";
    double time = 0;
    mkdir(run, 0777);
    remove("plate-run/f0.vtp");
    assert_int_equal(link("render-run/f0.vtp", "plate-run/f0.vtp"), 0);
    assert_int_equal(pel_pvd_write("plate-run/frames.pvd", &frame, &time, 1, NULL), PEL_OK);
    write_text("plate-run/scene.yaml", "version: 1\n"
                                       "bodies: [{ name: ball, mesh: { shape: geodesic-sphere }, springs: {} }]\n"
                                       "tools:\n"
                                       "  - name: plate\n"
                                       "    shape: box\n"
                                       "    size: [40, 40, 0.1]\n"
                                       "    motion: [{ time: 0, position: [0, 0, 1.1] }]\n"
                                       "duration: 1\n");
    write_text("plate-run/series.csv", "frame,time,plate_x,plate_y,plate_z\n0,0,0,0,1.1\n");
    pel_render_def def = make_def(&run, 1, "render-plate.png");
    def.field = "none";
    def.angle.elevation = 60;
    assert_int_equal(pel_render(&def, NULL, NULL, NULL), PEL_OK);
    size_t size;
    uint8_t *pixels = read_png("render-plate.png", &size);
    const uint8_t *corner = pixels + 4 * ((size_t)WIDTH * 20 + 20);
    print_message("%d\n", corner[0]);
    assert_in_range(corner[0], 225, 250);
    free(pixels);
}

static void check_refused(const pel_render_def *def, pel_status expected, const char *what)
{
    pel_error error;
    assert_int_equal(pel_render(def, NULL, NULL, &error), expected);
    if (strstr(error.what, what) == NULL)
        fail_msg("'%s' is not in '%s'", what, error.what);
    assert_true(error.remedy[0] != '\0');
    assert_true(access(def->output, F_OK) != 0);
}

static void test_bad_defs(void **unused)
{
    (void)unused;
    const char *run = "render-run";
    pel_render_def def = make_def(&run, 1, "render-bad.png"), bad = def;
    bad.cookie = 0;
    check_refused(&bad, PEL_BAD_ARGUMENT, "was not made by");
    bad = def;
    bad.input_count = 0;
    check_refused(&bad, PEL_BAD_ARGUMENT, "number of runs");
    bad = def;
    bad.angle.elevation = (double)NAN;
    check_refused(&bad, PEL_BAD_ARGUMENT, "angle");
    bad = def;
    bad.fixed_range = true;
    check_refused(&bad, PEL_BAD_ARGUMENT, "range");
    bad = def;
    bad.body_colors = (const uint8_t[17][3]){{0}};
    bad.body_color_count = 17;
    check_refused(&bad, PEL_BAD_ARGUMENT, "number of colors");
    bad = def;
    bad.width = 0;
    check_refused(&bad, PEL_BAD_ARGUMENT, "size");
    bad = def;
    bad.width = bad.height = 12;
    check_refused(&bad, PEL_BAD_ARGUMENT, "no room");
    bad = def;
    bad.field = "displacment";
    check_refused(&bad, PEL_BAD_ARGUMENT, "there is no field");
    bad.field = "displacement,,none";
    check_refused(&bad, PEL_BAD_ARGUMENT, "empty or too long");
    bad.field = "a,b,c,d,e,f,g,h,i";
    check_refused(&bad, PEL_BAD_ARGUMENT, "more than 8 fields");
    bad.field = "displacement,force";
    bad.unit = "mm";
    check_refused(&bad, PEL_BAD_ARGUMENT, "range and unit");
    bad = def;
    bad.turn = 360;
    check_refused(&bad, PEL_BAD_ARGUMENT, "turns in films alone");
    if (!can_draw)
        return;
    bad = def;
    bad.output = "render-bad.mp4";
    bad.program = "./no-such-ffmpeg";
    check_refused(&bad, PEL_BAD_ARGUMENT, "no-such-ffmpeg does not start");
    /* a program that goes away */
    bad.program = "true";
    check_refused(&bad, PEL_BAD_FILE, "cannot write the film");
    bad.program = "false";
    check_refused(&bad, PEL_BAD_FILE, "cannot write the film");
}

/* NaN in the field that is drawn is told with its frame and vertex; in another one it does no harm */
static void test_not_finite(void **unused)
{
    (void)unused;
    const char *path = "render-nan.vtp";
    const double positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, values[3] = {0, (double)NAN, 1}, fine[3] = {0, 1, 2};
    const int32_t triangle[3] = {0, 1, 2};
    const pel_vtp_field fields[2] = {{"energy", 1, values}, {"level", 1, fine}};
    const pel_vtp vtp = {.vertex_count = 3,
                         .triangle_count = 1,
                         .positions = positions,
                         .triangles = triangle,
                         .fields = fields,
                         .field_count = 2};
    assert_int_equal(pel_vtp_write(path, &vtp, NULL), PEL_OK);
    pel_render_def def = make_def(&path, 1, "render-bad.png");
    def.field = "energy";
    check_refused(&def, PEL_BAD_FORMAT, "field 'energy' is not a number (NaN)");
    def.output = "render-level.png";
    def.field = "level";
    if (can_draw)
        draw(&def);
}

static pel_status render_case(const void *data, pel_error *error)
{
    pel_render_def def = make_def(data, 1, "render-memory.png");
    def.width = def.height = 120;
    def.arrows = "displacement";
    return pel_render(&def, NULL, NULL, error);
}

/* also shows that nothing of ours stays behind: Mesa keeps a little, so that a leak checker is no help here */
static void test_out_of_memory(void **unused)
{
    (void)unused;
    if (!can_draw)
        skip();
    const char *frame = "render-run/f2.vtp";
    assert_true(for_allocation_failures(render_case, &frame, LONG(1, 8)) > 20);
}

static bool has_ffmpeg(void)
{
    return system("ffmpeg -version >/dev/null 2>&1") == 0;
}

static void test_film(void **unused)
{
    (void)unused;
    if (!can_draw || !has_ffmpeg())
        skip();
    const char *run = "render-run";
    pel_render_def def = make_def(&run, 1, "render-film.mp4");
    def.width = WIDTH + 1;
    draw(&def);
    FILE *probe = popen("ffprobe -v error -count_frames -select_streams v -show_entries "
                        "stream=width,height,nb_read_frames,r_frame_rate -of csv=p=0 render-film.mp4",
                        "r");
    char line[80] = "";
    assert_non_null(fgets(line, sizeof line, probe));
    pclose(probe);
    assert_string_equal(line, "162,120,10/1,3\n");
    def.output = "render-film.gif";
    draw(&def);
    char head[6] = "";
    FILE *gif = fopen("render-film.gif", "rb");
    assert_int_equal(fread(head, 1, sizeof head, gif), sizeof head);
    fclose(gif);
    assert_memory_equal(head, "GIF89a", sizeof head);
}

/* the shadow of the ball darkens the ground, and only when there is one */
static void test_ground(void **unused)
{
    (void)unused;
    if (!can_draw)
        skip();
    const char *ball = "render-ball.ply";
    pel_render_def def = make_def(&ball, 1, "render-ground.png");
    int dark[2] = {0};
    for (int hidden = 0; hidden < 2; ++hidden) {
        size_t size;
        def.hide_ground = hidden != 0;
        draw(&def);
        uint8_t *pixels = read_png("render-ground.png", &size);
        /* in the lowest tenth and the right quarter, where the ball is not */
        for (int y = HEIGHT - HEIGHT / 10; y < HEIGHT; ++y)
            for (int x = WIDTH / 2 + HEIGHT / 3; x < WIDTH; ++x)
                dark[hidden] += pixels[4 * (y * WIDTH + x)] < 250;
        free(pixels);
    }
    assert_true(dark[0] > 50);
    assert_int_equal(dark[1], 0);
}

/* what a body stands on is seen below the ground too, down to its foot */
static void test_foot_of_table(void **unused)
{
    (void)unused;
    if (!can_draw)
        skip();
    const char *frame = "f0.vtp", *run = "render-table";
    const double time = 0;
    mkdir(run, 0777);
    assert_int_equal(system("cp render-run/f0.vtp render-table"), 0);
    assert_int_equal(pel_pvd_write("render-table/frames.pvd", &frame, &time, 1, NULL), PEL_OK);
    write_text("render-table/scene.yaml",
               "version: 1\n"
               "bodies: [{ name: ball, mesh: { shape: geodesic-sphere }, springs: { stiffness: 3 } }]\n"
               "tools: [{ name: table, shape: box, size: [0.8, 0.8, 3], motion: [{ position: [0, 0, -2.5] }] }]\n"
               "duration: 1\n");
    write_text("render-table/series.csv", "frame,time,table_x,table_y,table_z\n0,0,0,0,-2.5\n");
    pel_render_def def = make_def(&run, 1, "render-table.png");
    size_t size;
    def.hide_labels = def.hide_bar = true;
    draw(&def);
    uint8_t *pixels = read_png("render-table.png", &size);
    int foot = HEIGHT - 1, white = 0;
    while (foot > 0 && pixels[4 * (foot * WIDTH + WIDTH / 2)] == 255)
        foot--;
    for (int y = HEIGHT / 2; y < foot; ++y)
        white += pixels[4 * (y * WIDTH + WIDTH / 2)] == 255;
    assert_in_range(foot, HEIGHT / 2, HEIGHT - 1);
    assert_int_equal(white, 0);
    free(pixels);
}

/* in a narrow picture, whose border the shadow reaches, no step of brightness is seen on the ground */
static void test_ground_of_narrow_picture(void **unused)
{
    (void)unused;
    if (!can_draw)
        skip();
    enum { NARROW = 120, TALL = 240 };
    const char *ball = "render-ball.ply";
    pel_render_def def = make_def(&ball, 1, "render-narrow.png");
    uint8_t *pixels[2];
    int steepest = 0, darkest = 255;
    def.width = NARROW;
    def.height = TALL;
    for (int hidden = 0; hidden < 2; ++hidden) {
        size_t size;
        def.hide_ground = hidden != 0;
        draw(&def);
        pixels[hidden] = read_png("render-narrow.png", &size);
        assert_int_equal(size, 4 * NARROW * TALL);
    }
    for (int y = 0; y < TALL; ++y)
        for (int x = 4 * NARROW / 5; x + 1 < NARROW; ++x) {
            const uint8_t *at = pixels[0] + 4 * (y * NARROW + x), *alone = pixels[1] + 4 * (y * NARROW + x);
            if (alone[0] < 255 || alone[4] < 255)
                continue;
            steepest = abs(at[4] - at[0]) > steepest ? abs(at[4] - at[0]) : steepest;
            darkest = at[0] < darkest ? at[0] : darkest;
        }
    print_message("darkest %d, steepest %d\n", darkest, steepest);
    assert_in_range(darkest, 0, 250);
    assert_in_range(steepest, 0, 6);
    free(pixels[0]);
    free(pixels[1]);
}

/* ---- stops ---- */

typedef struct patience {
    int asked, most;
} patience;

static bool is_patient(void *user)
{
    patience *p = user;
    return p->asked++ < p->most;
}

/* many triangles are drawn in portions, between which a stop is heard; nothing is written then, and the portions are
   the same picture */
static void test_stops(void **unused)
{
    (void)unused;
    if (!can_draw)
        skip();
    const char *ball = "render-many.ply";
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    pel_mesh *mesh;
    size_t sizes[2];
    shape.frequency = 51;
    assert_int_equal(pel_shape_create(&shape, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_mesh_write(ball, PEL_FORMAT_AUTO, mesh, NULL, NULL), PEL_OK);
    pel_mesh_destroy(mesh);
    pel_render_def def = make_def(&ball, 1, "render-whole.png");
    draw(&def);
    patience all = {0, INT32_MAX};
    def.output = "render-stopped.png";
    def.progress = is_patient;
    def.user = &all;
    draw(&def);
    /* some 25 maps of shadows and the surface, in two portions each */
    assert_true(all.asked > 50);
    uint8_t *whole = read_png("render-whole.png", &sizes[0]), *portions = read_png("render-stopped.png", &sizes[1]);
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(whole, portions, sizes[0]);
    free(whole);
    free(portions);
    unlink("render-stopped.png");
    for (int most = 0; most < all.asked; most += LONG(9, 1000)) {
        pel_error error;
        patience some = {0, most};
        def.user = &some;
        assert_int_equal(pel_render(&def, NULL, NULL, &error), PEL_STOPPED);
        assert_int_equal(some.asked, most + 1);
        assert_int_equal(access("render-stopped.png", F_OK), -1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_golden),        cmocka_unit_test(test_fields),
        cmocka_unit_test(test_peak),          cmocka_unit_test(test_zero_field),
        cmocka_unit_test(test_body_colors),   cmocka_unit_test(test_deterministic),
        cmocka_unit_test(test_folder),        cmocka_unit_test(test_bad_defs),
        cmocka_unit_test(test_film),          cmocka_unit_test(test_ground),
        cmocka_unit_test(test_foot_of_table), cmocka_unit_test(test_ground_of_narrow_picture),
        cmocka_unit_test(test_plate),         cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_out_of_memory), cmocka_unit_test(test_stops)};
    make_run();
    const char *ball = "render-ball.ply";
    pel_render_def def = make_def(&ball, 1, "render-probe.png");
    pel_error error;
    can_draw = pel_render(&def, NULL, NULL, &error) == PEL_OK;
    if (!can_draw)
        print_message("skipped: %s\n", error.what);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
