/* Reports are unpacked here by an own slow reader, and in a browser by web/test/report.mjs. */
#include "check.h"

#include "base/memory.h"
#include "failing_malloc.h"
#include "io/file.h"
#include "math/vec3.h"
#include "pellicle/report.h"
#include "pellicle/shape.h"
#include "report/report_pack.h"
#include "results/run_folder.h"

#include <zlib.h>

static char folder[FOLDER_SIZE], page[FOLDER_PATH], out[FOLDER_PATH];
static const char *folders[2] = {folder, folder};
static pel_report_def def;

static int set_up(void **unused)
{
    (void)unused;
    strcpy(folder, "report_XXXXXX");
    folder_make(folder);
    folder_write_text(folder, "page.html", "<html><!--pellicle runs, format 1--></html>\n");
    folder_path(page, folder, "page.html");
    folder_path(out, folder, "report.html");
    def = pel_report_def_default();
    def.page = page;
    def.folders = folders;
    def.folder_count = 1;
    return 0;
}

static int tear_down(void **unused)
{
    (void)unused;
    folder_remove(folder);
    return 0;
}

static char *read_report(void)
{
    static char *text;
    size_t size;
    assert_int_equal(pel_file_read(out, &text, &size, NULL), PEL_OK);
    return text;
}

/* bytes of base64 up to its end or a tag; a group of four letters has at most two signs of padding */
static size_t decode(const char *at, unsigned char *bytes)
{
    static const char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t size = 0, letters = strcspn(at, "<"), padding = 0;
    unsigned bits = 0, bit_count = 0;
    assert_int_equal(letters % 4, 0);
    while (padding < 2 && padding < letters && at[letters - 1 - padding] == '=')
        padding++;
    for (size_t i = 0; i < letters - padding; i++) {
        const char *letter = strchr(alphabet, at[i]);
        assert_non_null(letter);
        bits = bits << 6 | (unsigned)(letter - alphabet);
        bit_count += 6;
        if (bit_count >= 8) {
            bit_count -= 8;
            bytes[size++] = (unsigned char)(bits >> bit_count);
        }
    }
    return size;
}

/* the frames of the first run as bytes */
static size_t unpack(const char *text, unsigned char *bytes, size_t room)
{
    static const char tag[] = "class=\"run-frames\">";
    const char *at = strstr(text, tag);
    assert_non_null(at);
    at += strlen(tag);
    unsigned char *packed = pel_allocate(strlen(at), 1);
    assert_non_null(packed);
    size_t size = decode(at, packed);
    uLongf length = (uLongf)room;
    assert_int_equal(uncompress(bytes, &length, packed, (uLong)size), Z_OK);
    pel_free(packed);
    return length;
}

static unsigned read_list(const unsigned char *bytes, size_t width, size_t count, size_t index)
{
    unsigned folded = 0;
    for (size_t b = 0; b < width; b++)
        folded |= (unsigned)bytes[b * count + index] << 8 * b;
    return folded >> 1 ^ (0u - (folded & 1));
}

/* one list of four numbers, added to what the frame before left in `last` */
static const unsigned char *check_list(const unsigned char *at, size_t width, unsigned last[4], const double *values,
                                       size_t step, double low, double high)
{
    const double steps = width == 2 ? 65535 : 255;
    for (size_t v = 0; v < 4; v++) {
        last[v] = (last[v] + read_list(at, width, 4, v)) & (unsigned)steps;
        assert_near(low + (high - low) * last[v] / steps, values[v * step], 0.5001 * (high - low) / steps);
    }
    return at + 4 * width;
}

static void test_frames(void **unused)
{
    (void)unused;
    pel_report_summary summary;
    unsigned char bytes[4096];
    unsigned last[7][4] = {{0}};
    assert_int_equal(pel_report_write(out, &def, &summary, NULL), PEL_OK);
    char *text = read_report();
    assert_int_equal(summary.size, strlen(text));
    assert_int_equal(summary.frame_count, FOLDER_FRAMES);
    size_t size = unpack(text, bytes, sizeof bytes);
    const unsigned char *at = bytes;
    unsigned corner = 0;
    for (size_t i = 0; i < 12; i++) {
        corner += read_list(at, 4, 12, i);
        assert_int_equal(corner, folder_triangles[i]);
    }
    at += 48;
    for (int f = 0; f < FOLDER_FRAMES; f++) {
        double positions[12], scalar[4], vector[12];
        folder_values(f, positions, scalar, vector);
        for (size_t i = 0; i < 3; i++)
            at = check_list(at, 2, last[i], positions + i, 3, 10, 11.3);
        at = check_list(at, 2, last[3], scalar, 1, -3, 0.75);
        for (size_t i = 0; i < 3; i++)
            at = check_list(at, 2, last[4 + i], vector + i, 3, 0, 0.3);
    }
    assert_ptr_equal(at, bytes + size);
    pel_free(text);
}

static void test_texts(void **unused)
{
    (void)unused;
    def.folder_count = 2;
    assert_int_equal(pel_report_write(out, &def, NULL, NULL), PEL_OK);
    char *text = read_report();
    assert_non_null(strstr(text, "\"frames\":[[0,0,0],[1,0.5,0],[2,1,0],[3,1.5,0]]"));
    assert_non_null(strstr(text, "\"series\":\"frame,time,max_force\\n0,0,1\\n1,0.5,2\\n\""));
    /* a text cannot end the script that holds it */
    assert_non_null(strstr(text, "title: \\\"\\u003c/script>\\\""));
    assert_memory_equal(text, "<html>\n<script", 14);
    assert_non_null(strstr(text, "</script>\n</html>\n"));
    pel_free(text);
}

/* a row of twelve numbers in brackets; returns what is behind it */
static const char *check_pose(const char *row, const double expected[12])
{
    for (int i = 0; i < 12; i++) {
        double number;
        assert_int_equal(sscanf(row, i == 0 ? "[%lf" : ",%lf", &number), 1);
        row += strcspn(row + 1, ",]") + 1;
        assert_near(number, expected[i], 1e-6);
    }
    assert_int_equal(*row, ']');
    return row + 1;
}

/* a tool is a surface about its middle and its motion: the unit box, not there at first, rises by 1 a frame */
static void test_tools(void **unused)
{
    (void)unused;
    folder_add_tool(folder);
    assert_int_equal(pel_report_write(out, &def, NULL, NULL), PEL_OK);
    char *text = read_report();
    assert_non_null(strstr(text, "\"frame_total\":4"));
    assert_non_null(strstr(text, "\"tools\":[{\"name\":\"tip/1\",\"positions\":[-0.5,-0.5,-0.5,0.5,-0.5,-0.5,"));
    assert_non_null(strstr(text, "\"triangles\":[0,4,6,0,6,2,"));
    assert_non_null(strstr(text, "\"poses\":[null,["));
    const char *row = strstr(text, "null,[") + 4;
    for (int f = 1; f < FOLDER_FRAMES; f++) {
        const double expected[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0.5, 0.5 + f};
        row = check_pose(row + 1, expected);
    }
    assert_int_equal(*row, ']');
    pel_free(text);
}

static void test_chosen_fields(void **unused)
{
    (void)unused;
    const char *wanted[2] = {"force", "energy"};
    def.fields = wanted;
    def.field_count = 2;
    assert_int_equal(pel_report_write(out, &def, NULL, NULL), PEL_OK);
    char *text = read_report();
    assert_true(strstr(text, "\"name\":\"force\"") < strstr(text, "\"name\":\"energy\""));
    pel_free(text);
    pel_error error;
    wanted[1] = "energi";
    assert_int_equal(pel_report_write(out, &def, NULL, &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.what, "the run has no field 'energi'");
    assert_string_equal(error.remedy, "did you mean 'energy'?");
}

/* other triangles in the middle: written once each, and taken up again */
static void test_changing_triangles(void **unused)
{
    (void)unused;
    unsigned char bytes[4096];
    folder_write_frame(folder, 1, 3, 0);
    assert_int_equal(pel_report_write(out, &def, NULL, NULL), PEL_OK);
    char *text = read_report();
    assert_non_null(strstr(text, "\"topologies\":[[4,4],[4,3]]"));
    assert_non_null(strstr(text, "[[0,0,0],[1,0.5,1],[2,1,0],[3,1.5,0]]"));
    assert_int_equal(unpack(text, bytes, sizeof bytes), 4 * 12 + 3 * 12 + FOLDER_FRAMES * 7 * 8);
    pel_free(text);
    /* a frame with other triangles than the previous one starts a new sequence, the last one continues */
    const size_t heads[FOLDER_FRAMES] = {48, 36, 0, 0};
    const unsigned char *at = bytes;
    unsigned last[7][4] = {{0}};
    for (int f = 0; f < FOLDER_FRAMES; f++) {
        double positions[12], scalar[4], vector[12];
        folder_values(f, positions, scalar, vector);
        at += heads[f];
        if (f < 3)
            memset(last, 0, sizeof last);
        for (size_t i = 0; i < 3; i++)
            at = check_list(at, 2, last[i], positions + i, 3, 10, 11.3);
        at = check_list(at, 2, last[3], scalar, 1, -3, 0.75);
        for (size_t i = 0; i < 3; i++)
            at = check_list(at, 2, last[4 + i], vector + i, 3, 0, 0.3);
    }
}

/* a table that is too long keeps its header, some rows and the last one */
static void test_long_series(void **unused)
{
    (void)unused;
    enum { ROWS = 300000 };
    char path[FOLDER_PATH];
    FILE *file = fopen(folder_path(path, folder, "series.csv"), "w");
    assert_non_null(file);
    fputs("frame,time\n", file);
    for (int row = 0; row < ROWS; row++)
        fprintf(file, "%d,%d.5\n", row, row);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(pel_report_write(out, &def, NULL, NULL), PEL_OK);
    char *text = read_report();
    assert_non_null(strstr(text, "\"series\":\"frame,time\\n0,0.5\\n"));
    assert_non_null(strstr(text, "\\n299999,299999.5\\n\",\n\"series_thinned\":true"));
    assert_null(strstr(text, "\\n1,1.5\\n"));
    pel_free(text);
    /* a page of 2 MB of text at most: of a long series every n-th row, of a long scene the first 2 MB */
    enum { LONG_SIZE = 5 << 20, LIMIT = 2 << 20 };
    file = fopen(folder_path(path, folder, "scene.yaml"), "a");
    assert_non_null(file);
    for (int i = 0; i < LONG_SIZE; i++)
        fputc(i % 64 == 0 ? '\n' : '#', file);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(pel_report_write(out, &def, NULL, NULL), PEL_OK);
    text = read_report();
    assert_non_null(strstr(text, "\"scene_thinned\":true"));
    const char *series = strstr(text, "\"series\":\""), *behind = strstr(text, "\"series_thinned\"");
    assert_true(series != NULL && behind - series < LIMIT + LIMIT / 4);
    assert_true(strlen(text) < 3 * LIMIT);
    pel_free(text);
}

enum { NOTES_SIZE = 1 << 16 };

static void write_note(void *user, const char *text)
{
    char *notes = user;
    strncat(notes, text, NOTES_SIZE - 1 - strlen(notes));
}

/* lengths of the vectors of each frame */
static double lengths[FOLDER_FRAMES][252];

/* frames of a ball whose vertices and two fields jump about, which packs badly */
static void write_noisy_frames(int32_t frequency)
{
    pel_mesh *ball;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    shape.frequency = frequency;
    uint32_t noise = 1;
    assert_int_equal(pel_shape_create(&shape, &ball, NULL), PEL_OK);
    assert_int_equal(pel_mesh_add_field(ball, "energy", 1, NULL, NULL), PEL_OK);
    assert_int_equal(pel_mesh_add_field(ball, "force", 3, NULL, NULL), PEL_OK);
    for (int f = 0; f < FOLDER_FRAMES; f++) {
        char path[FOLDER_PATH], name[32];
        for (int32_t i = 0; i < 4 * ball->vertex_count; i++) {
            noise = noise * 1664525 + 1013904223;
            double value = noise * 0x1p-32;
            ball->fields[i % 4 > 0].values[i % 4 > 0 ? i / 4 * 3 + i % 4 - 1 : i / 4] = value;
            ball->positions[i / 4][i % 3] += 0.1 * value;
        }
        const pel_vtp_field fields[2] = {{"energy", 1, ball->fields[0].values}, {"force", 3, ball->fields[1].values}};
        const pel_vtp vtp = {.vertex_count = ball->vertex_count,
                             .triangle_count = ball->triangle_count,
                             .positions = ball->positions[0],
                             .triangles = ball->triangles[0],
                             .fields = fields,
                             .field_count = 2};
        snprintf(name, sizeof name, "frames/f%05d.vtp", f);
        assert_int_equal(pel_vtp_write(folder_path(path, folder, name), &vtp, NULL), PEL_OK);
        for (int32_t v = 0; v < ball->vertex_count && v < 252; v++)
            lengths[f][v] = pel_vec3_length(ball->fields[1].values + 3 * (size_t)v);
    }
    pel_mesh_destroy(ball);
}

/* a report that has no room for vectors shows their lengths */
static void test_magnitudes(void **unused)
{
    (void)unused;
    enum { VERTICES = 252, CORNERS = 3 * 500, LISTS = 5, SIZE = 4 * CORNERS + FOLDER_FRAMES * LISTS * 2 * VERTICES };
    static unsigned char bytes[SIZE + 1];
    unsigned last[VERTICES] = {0};
    double low = HUGE_VAL, high = 0;
    pel_report_summary whole;
    write_noisy_frames(5);
    assert_int_equal(pel_report_write(out, &def, &whole, NULL), PEL_OK);
    def.size_limit = whole.size - 1;
    assert_int_equal(pel_report_write(out, &def, NULL, NULL), PEL_OK);
    char *text = read_report();
    assert_int_equal(unpack(text, bytes, sizeof bytes), SIZE);
    for (int i = 0; i < FOLDER_FRAMES * VERTICES; i++) {
        low = fmin(low, lengths[i / VERTICES][i % VERTICES]);
        high = fmax(high, lengths[i / VERTICES][i % VERTICES]);
    }
    for (int f = 0; f < FOLDER_FRAMES; f++)
        for (size_t v = 0; v < VERTICES; v++) {
            const unsigned char *list = bytes + 4 * CORNERS + (size_t)(f * LISTS + LISTS - 1) * 2 * VERTICES;
            last[v] = (last[v] + read_list(list, 2, VERTICES, v)) & 65535;
            assert_near(low + (high - low) * last[v] / 65535, lengths[f][v], 0.51 * (high - low) / 65535);
        }
    pel_free(text);
}

static void test_thinned(void **unused)
{
    (void)unused;
    write_noisy_frames(5);
    char notes[NOTES_SIZE] = "";
    const pel_log log = {write_note, notes};
    pel_report_summary summary, whole;
    assert_int_equal(pel_report_write(out, &def, &whole, NULL), PEL_OK);
    def.log = &log;
    /* from where all fits to where nothing does */
    pel_status status = PEL_OK;
    int64_t least = FOLDER_FRAMES;
    for (def.size_limit = whole.size + 300; status == PEL_OK; def.size_limit -= 100) {
        pel_error error;
        status = pel_report_write(out, &def, &summary, &error);
        if (status != PEL_OK) {
            assert_int_equal(status, PEL_BAD_ARGUMENT);
            assert_non_null(strstr(error.remedy, "--limit"));
            break;
        }
        assert_true(summary.size <= def.size_limit);
        assert_true(summary.frame_count <= least);
        least = summary.frame_count;
    }
    assert_int_equal(least, 2);
    assert_non_null(strstr(notes, "vectors are kept as magnitudes only"));
    assert_non_null(strstr(notes, "fields are rounded to 1/255 of their range"));
    assert_non_null(strstr(notes, "2 of 4 frames are kept"));
}

/* differences of corners that take more than a byte */
static void test_many_vertices(void **unused)
{
    (void)unused;
    enum { FREQUENCY = 30, TRIANGLES = 20 * FREQUENCY * FREQUENCY, CORNERS = 3 * TRIANGLES };
    pel_mesh *ball;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    shape.frequency = FREQUENCY;
    assert_int_equal(pel_shape_create(&shape, &ball, NULL), PEL_OK);
    write_noisy_frames(FREQUENCY);
    assert_int_equal(pel_report_write(out, &def, NULL, NULL), PEL_OK);
    size_t room = 4 * CORNERS + (size_t)FOLDER_FRAMES * 7 * 2 * (size_t)ball->vertex_count;
    unsigned char *bytes = pel_allocate(room + 1, 1);
    assert_non_null(bytes);
    char *text = read_report();
    assert_int_equal(unpack(text, bytes, room + 1), room);
    const int32_t *corners = ball->triangles[0];
    unsigned corner = 0;
    for (size_t i = 0; i < CORNERS; i++) {
        corner += read_list(bytes, 4, CORNERS, i);
        assert_int_equal(corner, corners[i]);
    }
    pel_free(text);
    pel_free(bytes);
    pel_mesh_destroy(ball);
}

/* noise of any length is restored, also if longer than a buffer */
static void test_base64(void **unused)
{
    (void)unused;
    static unsigned char noise[10000], packed[20000], back[10001];
    char path[FOLDER_PATH], *text;
    size_t text_size, remainders[3] = {0};
    uint32_t state = 7;
    for (size_t i = 0; i < sizeof noise; i++)
        noise[i] = (unsigned char)((state = state * 1664525 + 1013904223) >> 24);
    for (size_t size = 0; size <= sizeof noise; size += size < 12 ? 1 : 1427) {
        pel_report_pack pack = {0};
        pel_file_writer writer;
        assert_int_equal(pel_report_pack_open(&pack, SIZE_MAX, NULL), PEL_OK);
        assert_int_equal(pel_report_pack_add(&pack, noise, size, NULL), PEL_OK);
        assert_int_equal(pel_report_pack_close(&pack, NULL), PEL_OK);
        assert_int_equal(pel_file_writer_open(&writer, folder_path(path, folder, "base64"), NULL), PEL_OK);
        pel_report_pack_write_base64(&pack, &writer);
        assert_int_equal(pel_file_writer_commit(&writer, NULL), PEL_OK);
        assert_int_equal(pel_file_read(path, &text, &text_size, NULL), PEL_OK);
        assert_int_equal(text_size, (pack.size + 2) / 3 * 4);
        assert_int_equal(decode(text, packed), pack.size);
        assert_memory_equal(packed, pack.bytes, pack.size);
        uLongf length = sizeof back;
        assert_int_equal(uncompress(back, &length, packed, (uLong)pack.size), Z_OK);
        assert_int_equal(length, size);
        assert_memory_equal(back, noise, size);
        remainders[pack.size % 3]++;
        pel_report_pack_free(&pack);
        pel_free(text);
    }
    assert_true(remainders[0] > 0 && remainders[1] > 0 && remainders[2] > 0);
}

static void test_refuses(void **unused)
{
    (void)unused;
    pel_error error;
    pel_report_def forgotten = {.page = page};
    assert_int_equal(pel_report_write(out, &forgotten, NULL, &error), PEL_BAD_ARGUMENT);
    folder_write_frame(folder, 3, 4, (double)NAN);
    assert_int_equal(pel_report_write(out, &def, NULL, &error), PEL_BAD_FORMAT);
    assert_int_equal(access(out, F_OK), -1);
    folder_write_text(folder, "page.html", "<!--pellicle runs, format 0-->");
    assert_int_equal(pel_report_write(out, &def, NULL, &error), PEL_BAD_FORMAT);
    assert_string_equal(error.what, "the page is of another version of pellicle");
    folder_write_text(folder, "page.html", "<html>");
    assert_int_equal(pel_report_write(out, &def, NULL, &error), PEL_BAD_FORMAT);
    assert_string_equal(error.what, "this is not a report page");
    remove(page);
    assert_int_equal(pel_report_write(out, &def, NULL, &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.remedy, "make web"));
}

/* a run that has just begun has frames and nothing else */
static void test_frames_alone(void **unused)
{
    (void)unused;
    static const char *const names[] = {"series.csv", "summary.json", "scene.yaml"};
    char path[FOLDER_PATH];
    for (int i = 0; i < 3; i++)
        remove(folder_path(path, folder, names[i]));
    assert_int_equal(pel_report_write(out, &def, NULL, NULL), PEL_OK);
}

static pel_status write_report(const void *data, pel_error *error)
{
    (void)data;
    return pel_report_write(out, &def, NULL, error);
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    folder_add_tool(folder);
    assert_true(for_every_allocation_failure(write_report, NULL) > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_frames, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_texts, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_tools, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_chosen_fields, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_changing_triangles, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_magnitudes, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_thinned, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_many_vertices, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_base64, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_long_series, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_refuses, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_frames_alone, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_allocation_failures, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
