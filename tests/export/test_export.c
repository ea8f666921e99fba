/* PC2, GLB and numbered files; the glTF validator looks at GLB files in web/test/exports.mjs, check_glb.py here. */
#include "check.h"

#include "base/memory.h"
#include "export/export.h"
#include "export_folder.h"
#include "failing_malloc.h"
#include "io/file.h"
#include "pellicle/export.h"
#include "source_dir.h"

static int32_t word(const char *bytes)
{
    int32_t value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

static double real(const char *bytes)
{
    float value;
    memcpy(&value, bytes, sizeof value);
    return (double)value;
}

static void test_pc2(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH], *bytes;
    size_t size;
    assert_int_equal(pel_export_pc2(folder_path(path, folder, "a.pc2"), frames, NULL), PEL_OK);
    assert_int_equal(pel_file_read(path, &bytes, &size, NULL), PEL_OK);
    assert_int_equal(size, 32 + FOLDER_FRAMES * FOLDER_VERTICES * 12);
    assert_memory_equal(bytes, "POINTCACHE2\0", 12);
    assert_int_equal(word(bytes + 12), 1);
    assert_int_equal(word(bytes + 16), FOLDER_VERTICES);
    assert_near(real(bytes + 20), 0, 0);
    assert_near(real(bytes + 24), 1, 0);
    assert_int_equal(word(bytes + 28), FOLDER_FRAMES);
    for (int f = 0; f < FOLDER_FRAMES; f++) {
        double positions[12], scalar[4], vector[12];
        folder_values(f, positions, scalar, vector);
        for (int i = 0; i < 12; i++)
            assert_near(real(bytes + 32 + 48 * f + 4 * i), (double)(float)positions[i], 0);
    }
    pel_free(bytes);
}

/* three numbers of the JSON behind a word, which must come */
static const char *next_numbers(const char *json, const char *word, double numbers[3])
{
    json = strstr(json, word);
    assert_non_null(json);
    assert_int_equal(sscanf(json + strlen(word), "[%lf,%lf,%lf]", &numbers[0], &numbers[1], &numbers[2]), 3);
    return json + 1;
}

/* output of an independent reader of the file */
static void check_by_python(const char *path, const char *expected)
{
    char command[300], said[200] = "";
    snprintf(command, sizeof command, "python3 " PEL_SOURCE_DIR "/tests/export/check_glb.py %s", path);
    FILE *stream = popen(command, "r");
    assert_non_null(stream);
    assert_non_null(fgets(said, sizeof said, stream));
    assert_int_equal(pclose(stream), 0);
    assert_string_equal(said, expected);
}

/* normals of the tetrahedron with right angles at vertex 0: at a corner, triangles weighted by their area */
static void expected_normal(size_t v, double normal[3])
{
    /* twice the areas times the outward normals of the triangles, in the order of folder_triangles */
    static const double areas[4][3] = {{0, 0, -1}, {0, -1, 0}, {1, 1, 1}, {-1, 0, 0}};
    double square = 0;
    for (size_t i = 0; i < 3; i++) {
        normal[i] = 0;
        for (size_t t = 0; t < 4; t++)
            for (size_t c = 0; c < 3; c++)
                normal[i] += folder_triangles[3 * t + c] == (int32_t)v ? areas[t][i] : 0;
        square += normal[i] * normal[i];
    }
    for (size_t i = 0; i < 3; i++)
        normal[i] /= sqrt(square);
}

/* the bounds of each frame in the JSON are those of its numbers, and normals are right in every frame */
static void check_glb_frames(const char *json, const char *vertices, size_t frame_size)
{
    for (size_t f = 0; f < FOLDER_FRAMES; f++) {
        const char *positions = vertices + f * frame_size, *normals = positions + frame_size / 2;
        double low[3], high[3];
        next_numbers(json, "\"min\":", low);
        json = next_numbers(json, "\"max\":", high);
        for (size_t i = 0; i < 3; i++) {
            double least = HUGE_VAL, most = -HUGE_VAL;
            for (size_t v = 0; v < FOLDER_VERTICES; v++) {
                least = fmin(least, real(positions + 12 * v + 4 * i));
                most = fmax(most, real(positions + 12 * v + 4 * i));
            }
            assert_near(low[i], least, 0);
            assert_near(high[i], most, 0);
        }
        for (size_t v = 0; v < FOLDER_VERTICES; v++) {
            double normal[3];
            expected_normal(v, normal);
            for (size_t i = 0; i < 3; i++) {
                double base = real(vertices + frame_size / 2 + 12 * v + 4 * i);
                assert_near(base + (f > 0 ? real(normals + 12 * v + 4 * i) : 0), normal[i], 1e-6);
            }
        }
    }
}

/* frame 0 plus the morph target of frame f is frame f */
static void test_glb(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH], *bytes;
    size_t size;
    assert_int_equal(pel_export_glb(folder_path(path, folder, "a.glb"), frames, NULL), PEL_OK);
    assert_int_equal(pel_file_read(path, &bytes, &size, NULL), PEL_OK);
    assert_memory_equal(bytes, "glTF\2\0\0\0", 8);
    assert_int_equal(word(bytes + 8), size);
    const int32_t json_size = word(bytes + 12);
    assert_int_equal(json_size % 4, 0);
    assert_non_null(strstr(bytes + 20, "\"targets\":[{\"POSITION\":3,\"NORMAL\":4},"));
    const char *numbers = bytes + 20 + json_size + 8, *vertices = numbers + 48;
    const size_t frame_size = 24 * FOLDER_VERTICES;
    for (int i = 0; i < 12; i++)
        assert_int_equal(word(numbers + 4 * i), folder_triangles[i]);
    for (int f = 0; f < FOLDER_FRAMES; f++) {
        double positions[12], scalar[4], vector[12];
        folder_values(f, positions, scalar, vector);
        for (int i = 0; i < 12; i++) {
            double delta = f > 0 ? real(vertices + (size_t)f * frame_size + 4 * (size_t)i) : 0;
            assert_near(real(vertices + 4 * i) + delta, positions[i], 1e-6 * 12);
        }
    }
    check_glb_frames(bytes + 20, vertices, frame_size);
    const char *times = vertices + FOLDER_FRAMES * frame_size, *weights = times + 4 * FOLDER_FRAMES;
    for (int f = 0; f < FOLDER_FRAMES; f++) {
        assert_near(real(times + 4 * f), 0.5 * f, 0);
        for (int k = 1; k < FOLDER_FRAMES; k++)
            assert_near(real(weights + 4 * (f * (FOLDER_FRAMES - 1) + k - 1)), k == f, 0);
    }
    assert_ptr_equal(weights + 4 * FOLDER_FRAMES * (FOLDER_FRAMES - 1), bytes + size);
    check_by_python(path, "4 vertices, 4 triangles, 4 frames\n");
    pel_free(bytes);
}

/* tools are separate parts in every format, and rest before they appear */
static void test_tools(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH], *bytes;
    size_t size;
    pel_mesh *mesh;
    pel_frames_close(frames);
    folder_add_tool(folder);
    assert_int_equal(pel_frames_open(folder, &frames, NULL), PEL_OK);
    assert_int_equal(frames->frame_count, FOLDER_FRAMES);
    assert_int_equal(frames->tool_count, 1);
    assert_string_equal(frames->tool_names[0], "tip/1");
    assert_int_equal(pel_frames_read_tool(frames, 0, 0, &mesh, NULL), PEL_OK);
    assert_null(mesh);
    assert_int_equal(pel_frames_read_tool(frames, 3, 0, &mesh, NULL), PEL_OK);
    assert_near(mesh->positions[7][2], 4, 0);
    pel_mesh_destroy(mesh);

    assert_int_equal(pel_export_glb(folder_path(path, folder, "a.glb"), frames, NULL), PEL_OK);
    check_by_python(path, "body 0: 4 vertices, 4 triangles; tip/1: 8 vertices, 12 triangles, 4 frames\n");

    /* the cache of the bodies is as without tools; the tool has a mesh and a cache of its own */
    assert_int_equal(pel_export_pc2(folder_path(path, folder, "a.pc2"), frames, NULL), PEL_OK);
    assert_int_equal(pel_file_read(path, &bytes, &size, NULL), PEL_OK);
    assert_int_equal(size, 32 + FOLDER_FRAMES * FOLDER_VERTICES * 12);
    pel_free(bytes);
    assert_int_equal(pel_file_read(folder_path(path, folder, "a-tip_1_0.pc2"), &bytes, &size, NULL), PEL_OK);
    assert_int_equal(size, 32 + FOLDER_FRAMES * 8 * 12);
    for (int f = 0; f < FOLDER_FRAMES; f++)
        assert_near(real(bytes + 32 + f * 96 + 92), f > 0 ? 1 + f : 2, 0);
    pel_free(bytes);
    assert_int_equal(pel_mesh_read(folder_path(path, folder, "a-tip_1_0.obj"), PEL_FORMAT_AUTO, NULL, &mesh, NULL),
                     PEL_OK);
    assert_int_equal(mesh->vertex_count, 8);
    pel_mesh_destroy(mesh);

    assert_int_equal(pel_mesh_read(folder_path(path, folder, "a-bodies.obj"), PEL_FORMAT_AUTO, NULL, &mesh, NULL),
                     PEL_OK);
    assert_int_equal(mesh->vertex_count, FOLDER_VERTICES);
    pel_mesh_destroy(mesh);

    /* numbered files: two objects in one mesh, with the numbers of the parts where the format holds fields */
    assert_int_equal(pel_export_sequence(folder_path(path, folder, "s.obj"), PEL_FORMAT_OBJ, frames, NULL, NULL),
                     PEL_OK);
    assert_int_equal(pel_file_read(folder_path(path, folder, "s_00002.obj"), &bytes, &size, NULL), PEL_OK);
    assert_non_null(strstr(bytes, "\no body_0\nf 1 3 2\n"));
    assert_non_null(strstr(bytes, "\no body_1\nf 5 9 11\n"));
    pel_free(bytes);
    assert_int_equal(pel_export_sequence(folder_path(path, folder, "s.ply"), PEL_FORMAT_PLY, frames, NULL, NULL),
                     PEL_OK);
    assert_int_equal(pel_mesh_read(folder_path(path, folder, "s_00003.ply"), PEL_FORMAT_AUTO, NULL, &mesh, NULL),
                     PEL_OK);
    assert_int_equal(mesh->vertex_count, 12);
    assert_near(mesh->positions[11][2], 4, 0);
    for (int32_t v = 0; v < 12; v++) {
        assert_near(pel_mesh_field(mesh, "body")->values[v], v >= 4, 0);
        if (v >= 4)
            assert_near(pel_mesh_field(mesh, "energy")->values[v], 0, 0);
    }
    pel_mesh_destroy(mesh);
}

static void test_glb_mesh(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH], *bytes;
    size_t size;
    pel_mesh *mesh;
    assert_int_equal(pel_frames_read(frames, 0, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_export_glb_mesh(folder_path(path, folder, "a.glb"), mesh, NULL), PEL_OK);
    assert_int_equal(pel_file_read(path, &bytes, &size, NULL), PEL_OK);
    assert_null(strstr(bytes + 20, "animations"));
    check_by_python(path, "4 vertices, 4 triangles, 1 frames\n");
    /* bodies that share triangles cannot be separate nodes */
    const double labels[4] = {0, 0, 1, 1};
    assert_int_equal(pel_mesh_add_field(mesh, "body", 1, labels, NULL), PEL_OK);
    assert_int_equal(pel_export_glb_mesh(path, mesh, NULL), PEL_OK);
    check_by_python(path, "4 vertices, 4 triangles, 1 frames\n");
    mesh->positions[1][2] = 1e300;
    assert_int_equal(pel_export_glb_mesh(path, mesh, NULL), PEL_BAD_ARGUMENT);
    pel_mesh_destroy(mesh);
    pel_free(bytes);
}

/* a coordinate that no float holds, on any axis and either side of zero */
static void test_too_large(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH], frame[FOLDER_PATH];
    for (int i = 0; i < 6; i++) {
        double positions[12], scalar[4], vector[12];
        folder_values(1, positions, scalar, vector);
        positions[6 + i % 3] = i < 3 ? 1e39 : -1e39;
        const pel_vtp vtp = {.vertex_count = FOLDER_VERTICES,
                             .triangle_count = 4,
                             .positions = positions,
                             .triangles = folder_triangles,
                             .time = 0.5,
                             .float64 = true};
        assert_int_equal(pel_vtp_write(folder_path(frame, folder, "frames/f00001.vtp"), &vtp, NULL), PEL_OK);
        pel_error error;
        assert_int_equal(pel_export_pc2(folder_path(path, folder, "e.pc2"), frames, &error), PEL_BAD_FORMAT);
        assert_non_null(strstr(error.what, "too large"));
        assert_int_equal(pel_export_glb(folder_path(path, folder, "e.glb"), frames, &error), PEL_BAD_FORMAT);
        assert_non_null(strstr(error.what, "too large"));
        assert_non_null(strstr(error.file, "f00001.vtp"));
        assert_int_equal(access(path, F_OK), -1);
        assert_int_equal(access(folder_path(path, folder, "e.pc2"), F_OK), -1);
    }
}

static void test_sequence(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH], name[PEL_EXPORT_PATH_SIZE];
    folder_path(path, folder, "b.ply");
    assert_int_equal(pel_export_sequence(path, PEL_FORMAT_PLY, frames, NULL, NULL), PEL_OK);
    for (int f = 0; f < FOLDER_FRAMES; f++) {
        double positions[12], scalar[4], vector[12];
        folder_values(f, positions, scalar, vector);
        pel_mesh *mesh;
        assert_int_equal(pel_mesh_read(pel_export_numbered_path(name, path, f), PEL_FORMAT_AUTO, NULL, &mesh, NULL),
                         PEL_OK);
        assert_memory_equal(mesh->positions, positions, sizeof positions);
        pel_mesh_destroy(mesh);
    }
    assert_string_equal(pel_export_numbered_path(name, "a.b/ball", 7), "a.b/ball_00007");
    assert_string_equal(pel_export_numbered_path(name, "a.b/ball.x.obj", 123456), "a.b/ball.x_123456.obj");
}

static void remove_frame(void *user, const char *text)
{
    (void)text;
    unlink(user);
}

/* a frame that is removed during the export: the files that were written go, one of before with the number that failed
   stays */
static void test_frame_lost_meanwhile(void **unused)
{
    (void)unused;
    char obj[FOLDER_PATH], path[FOLDER_PATH], lost[FOLDER_PATH];
    pel_error error;
    const pel_log log = {remove_frame, lost};
    folder_path(lost, folder, "frames/f00002.vtp");
    FILE *file = fopen(folder_path(path, folder, "e_00002.obj"), "w");
    assert_non_null(file);
    fclose(file);
    folder_path(obj, folder, "e.obj");
    assert_int_equal(pel_export_sequence(obj, PEL_FORMAT_OBJ, frames, &log, &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.file, "f00002.vtp"));
    assert_int_equal(unlink(path), 0);
    assert_int_equal(access(folder_path(path, folder, "e_00000.obj"), F_OK), -1);
    assert_int_equal(access(folder_path(path, folder, "e_00001.obj"), F_OK), -1);
}

/* a bad frame leaves nothing, not even the files before it */
static void test_nothing_half_written(void **unused)
{
    (void)unused;
    char pc2[FOLDER_PATH], glb[FOLDER_PATH], obj[FOLDER_PATH], first[FOLDER_PATH];
    pel_error error;
    folder_path(pc2, folder, "c.pc2");
    folder_path(glb, folder, "c.glb");
    folder_path(obj, folder, "c.obj");
    folder_path(first, folder, "c_00000.obj");
    folder_write_frame(folder, 2, 3, 0);
    assert_int_equal(pel_export_pc2(pc2, frames, &error), PEL_BAD_FORMAT);
    assert_non_null(strstr(error.file, "f00002.vtp"));
    assert_int_equal(pel_export_glb(glb, frames, &error), PEL_BAD_FORMAT);
    assert_non_null(strstr(error.file, "f00002.vtp"));
    folder_write_frame(folder, 2, 4, (double)HUGE_VAL);
    assert_int_equal(pel_export_sequence(obj, PEL_FORMAT_OBJ, frames, NULL, &error), PEL_BAD_FORMAT);
    assert_int_equal(access(pc2, F_OK), -1);
    assert_int_equal(access(glb, F_OK), -1);
    assert_int_equal(access(first, F_OK), -1);
    folder_write_frame(folder, 2, 4, 0);
    frames->times[2] = frames->times[1];
    assert_int_equal(pel_export_glb(glb, frames, &error), PEL_BAD_FORMAT);
    assert_non_null(strstr(error.what, "not later"));
    /* the third file cannot be written: a folder stands there */
    char blocked[FOLDER_PATH];
    assert_int_equal(mkdir(folder_path(blocked, folder, "c_00002.obj"), 0777), 0);
    assert_int_equal(pel_export_sequence(obj, PEL_FORMAT_OBJ, frames, NULL, &error), PEL_BAD_FILE);
    assert_int_equal(access(first, F_OK), -1);
    assert_int_equal(access(folder_path(first, folder, "c_00001.obj"), F_OK), -1);
}

/* a frame that another program replaces between two readings is refused by name */
static void test_changed_meanwhile(void **unused)
{
    (void)unused;
    static const double positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const int32_t triangle[3] = {0, 1, 2};
    const pel_vtp other = {.vertex_count = 3, .triangle_count = 1, .positions = positions, .triangles = triangle};
    char path[FOLDER_PATH], text[600];
    pel_export_source source;
    pel_error error;
    pel_mesh *mesh;
    assert_int_equal(pel_export_open(&source, frames, &error), PEL_OK);
    assert_int_equal(pel_export_read_bodies(&source, 1, &mesh, &error), PEL_OK);
    pel_mesh_destroy(mesh);
    assert_int_equal(pel_vtp_write(folder_path(path, folder, "frames/f00001.vtp"), &other, NULL), PEL_OK);
    for (int with_tools = 0; with_tools < 2; with_tools++) {
        mesh = NULL;
        assert_int_equal((with_tools ? pel_export_read : pel_export_read_bodies)(&source, 1, &mesh, &error),
                         PEL_BAD_FORMAT);
        assert_null(mesh);
        assert_non_null(strstr(error.file, "f00001.vtp"));
        assert_non_null(strstr(pel_error_text(&error, text, sizeof text), "no other program"));
    }
    assert_int_equal(pel_export_read(&source, 2, &mesh, &error), PEL_OK);
    pel_mesh_destroy(mesh);
    pel_export_close(&source);
}

static pel_status export_pc2(const void *path, pel_error *error)
{
    return pel_export_pc2(path, frames, error);
}

static pel_status export_glb(const void *path, pel_error *error)
{
    return pel_export_glb(path, frames, error);
}

static pel_status export_sequence(const void *path, pel_error *error)
{
    return pel_export_sequence(path, PEL_FORMAT_OBJ, frames, NULL, error);
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH];
    pel_frames_close(frames);
    folder_add_tool(folder);
    assert_int_equal(pel_frames_open(folder, &frames, NULL), PEL_OK);
    assert_true(for_every_allocation_failure(export_pc2, folder_path(path, folder, "d.pc2")) > 10);
    assert_true(for_every_allocation_failure(export_glb, folder_path(path, folder, "d.glb")) > 10);
    assert_true(for_every_allocation_failure(export_sequence, folder_path(path, folder, "d.obj")) > 10);
}

/* parts are numbered by a field of one number each; what no body can have is no number of one */
static void test_parts(void **unused)
{
    (void)unused;
    char first[] = "probe", second[] = "clamp", *names[2] = {first, second};
    const pel_frames two = {.tool_count = 2, .tool_names = names};
    const pel_export_source source = {.frames = &two, .body_count = 3};
    assert_null(pel_export_tool_name(NULL, 0));
    assert_null(pel_export_tool_name(&source, 2));
    assert_string_equal(pel_export_tool_name(&source, 3), "probe");
    assert_string_equal(pel_export_tool_name(&source, 4), "clamp");
    static const double x[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const int32_t corners[3] = {0, 1, 2};
    const double bodies[4][3] = {{0, 0, 0}, {0, 4, 1}, {0, 65535, 0}, {0, 65536, 0}};
    const int32_t counts[4] = {1, 5, 65536, 1};
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(x, 3, corners, 1, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_export_part_count(mesh), 1);
    assert_int_equal(pel_mesh_add_field(mesh, "body", 1, NULL, NULL), PEL_OK);
    for (int i = 0; i < 4; i++) {
        memcpy(pel_mesh_field(mesh, "body")->values, bodies[i], sizeof bodies[i]);
        assert_int_equal(pel_export_part_count(mesh), counts[i]);
    }
    pel_mesh_destroy(mesh);
    const double vectors[9] = {7, 7, 7, 7, 7, 7, 7, 7, 7};
    assert_int_equal(pel_mesh_create(x, 3, corners, 1, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_mesh_add_field(mesh, "body", 3, vectors, NULL), PEL_OK);
    assert_int_equal(pel_export_part_count(mesh), 1);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_pc2, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_glb, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_tools, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_glb_mesh, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_too_large, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_sequence, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_frame_lost_meanwhile, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_nothing_half_written, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_changed_meanwhile, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_allocation_failures, set_up, tear_down),
        cmocka_unit_test(test_parts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
