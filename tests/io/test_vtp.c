#include "check.h"

#include "../fuzz/fuzz_vtp.h"
#include "base/memory.h"
#include "failing_malloc.h"
#include "io/file.h"
#include "io/vtk_blocks.h"
#include "pellicle/results.h"
#include "pellicle/shape.h"
#include "random.h"
#include "source_dir.h"

#include <dirent.h>
#include <stdlib.h>
#include <unistd.h>

#define PATH "vtp-test.vtp"

/* a sphere with a scalar and a vector field; large enough for several packed blocks when fine */
typedef struct sample_data {
    pel_mesh *mesh;
    double *scalar, *vector;
    pel_vtp_field fields[2];
    pel_vtp vtp;
} sample_data;

static void make_sample(sample_data *made, int32_t frequency)
{
    *made = (sample_data){0};
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = frequency;
    assert_int_equal(pel_shape_create(&def, &made->mesh, NULL), PEL_OK);
    size_t count = (size_t)made->mesh->vertex_count;
    made->scalar = pel_allocate(count, sizeof(double));
    made->vector = pel_allocate(3 * count, sizeof(double));
    random_state random = {7};
    for (size_t i = 0; i < count; i++)
        made->scalar[i] = random_between(&random, -1, 1);
    for (size_t i = 0; i < 3 * count; i++)
        made->vector[i] = (double)i / 3;
    made->fields[0] = (pel_vtp_field){"energy", 1, made->scalar};
    made->fields[1] = (pel_vtp_field){"a < \"b\" & c", 3, made->vector};
    made->vtp = (pel_vtp){
        .vertex_count = made->mesh->vertex_count,
        .triangle_count = made->mesh->triangle_count,
        .positions = made->mesh->positions[0],
        .triangles = made->mesh->triangles[0],
        .fields = made->fields,
        .field_count = 2,
        .time = 0.1,
    };
}

static void free_sample(sample_data *sample)
{
    pel_mesh_destroy(sample->mesh);
    pel_free(sample->scalar);
    pel_free(sample->vector);
}

static void check_values(const double *read, const double *written, size_t count, bool float64)
{
    for (size_t i = 0; i < count; i++)
        assert_true(read[i] == (float64 ? written[i] : (double)(float)written[i]));
}

static void test_round_trip(void **unused)
{
    (void)unused;
    const int32_t frequencies[2] = {2, 40};
    for (int kind = 0; kind < 8; kind++) {
        sample_data sample;
        make_sample(&sample, frequencies[kind >> 2]);
        pel_mesh *mesh;
        double time;
        sample.vtp.compress = (kind & 1) != 0;
        sample.vtp.float64 = (kind & 2) != 0;
        assert_int_equal(pel_vtp_write(PATH, &sample.vtp, NULL), PEL_OK);
        assert_int_equal(pel_vtp_read(PATH, &mesh, &time, NULL), PEL_OK);
        size_t count = (size_t)sample.vtp.vertex_count;
        assert_true(time == 0.1);
        assert_int_equal(mesh->vertex_count, sample.vtp.vertex_count);
        assert_int_equal(mesh->triangle_count, sample.vtp.triangle_count);
        assert_memory_equal(mesh->triangles, sample.vtp.triangles, 12 * (size_t)mesh->triangle_count);
        check_values(mesh->positions[0], sample.vtp.positions, 3 * count, sample.vtp.float64);
        assert_int_equal(mesh->field_count, 2);
        check_values(pel_mesh_field(mesh, "energy")->values, sample.scalar, count, sample.vtp.float64);
        check_values(pel_mesh_field(mesh, "a < \"b\" & c")->values, sample.vector, 3 * count, sample.vtp.float64);
        pel_mesh_destroy(mesh);
        free_sample(&sample);
    }
    unlink(PATH);
}

static void write_bytes(const char *bytes, size_t size)
{
    FILE *stream = fopen(PATH, "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(bytes, 1, size, stream), size);
    fclose(stream);
}

/* a file cut off anywhere is refused with its name and place */
static void check_same_file(const char *a, const char *b)
{
    char *a_bytes, *b_bytes;
    size_t a_size, b_size;
    assert_int_equal(pel_file_read(a, &a_bytes, &a_size, NULL), PEL_OK);
    assert_int_equal(pel_file_read(b, &b_bytes, &b_size, NULL), PEL_OK);
    assert_int_equal(a_size, b_size);
    assert_memory_equal(a_bytes, b_bytes, a_size);
    pel_free(a_bytes);
    pel_free(b_bytes);
}

/* a writer that has written other files gives the same bytes as a new one, for any changes in between */
static void test_series(void **unused)
{
    (void)unused;
    enum { CHANGES = 9 };
    sample_data samples[2];
    pel_vtp_writer *writer;
    make_sample(&samples[0], 2);
    make_sample(&samples[1], 40);
    assert_int_equal(pel_vtp_writer_create(&writer, NULL), PEL_OK);
    for (int i = 0; i < CHANGES; i++) {
        static const int sizes[CHANGES] = {1, 1, 1, 0, 0, 1, 1, 1, 1}, packed[CHANGES] = {0, 0, 1, 1, 0, 1, 1, 1, 0};
        sample_data *sample = &samples[sizes[i]];
        sample->vtp.compress = packed[i] != 0;
        sample->vtp.float64 = i == 4;
        sample->vtp.field_count = i == 5 ? 1 : 2;
        sample->mesh->positions[3][1] = 0.125 * i;
        /* other triangles, as many as before */
        int32_t *first = sample->mesh->triangles[0], corner = first[0];
        if (i == 7)
            first[0] = first[1], first[1] = first[2], first[2] = corner;
        assert_int_equal(pel_vtp_writer_write(writer, PATH, &sample->vtp, NULL), PEL_OK);
        assert_int_equal(pel_vtp_write("again.vtp", &sample->vtp, NULL), PEL_OK);
        check_same_file(PATH, "again.vtp");
        /* a failure in between changes nothing */
        if (i == 2)
            assert_int_equal(pel_vtp_writer_write(writer, "no/such/folder.vtp", &samples[0].vtp, NULL), PEL_BAD_FILE);
    }
    pel_vtp_writer_destroy(writer);
    pel_vtp_writer_destroy(NULL);
    unlink("again.vtp");
    unlink(PATH);
    free_sample(&samples[0]);
    free_sample(&samples[1]);
}

static void test_cut_off(void **unused)
{
    (void)unused;
    for (int compress = 0; compress < 2; compress++) {
        sample_data sample;
        make_sample(&sample, 1);
        char *bytes;
        size_t size;
        sample.vtp.compress = compress != 0;
        assert_int_equal(pel_vtp_write(PATH, &sample.vtp, NULL), PEL_OK);
        assert_int_equal(pel_file_read(PATH, &bytes, &size, NULL), PEL_OK);
        for (size_t length = 0; length + 1 < size; length++) {
            pel_mesh *mesh;
            pel_error error;
            write_bytes(bytes, length);
            assert_int_equal(pel_vtp_read(PATH, &mesh, NULL, &error), PEL_BAD_FORMAT);
            assert_null(mesh);
            assert_string_equal(error.file, PATH);
            assert_true(error.remedy[0] != '\0');
        }
        pel_free(bytes);
        free_sample(&sample);
    }
    unlink(PATH);
}

/* every file of the fuzz target's corpus, whole and cut off */
static void test_corpus(void **unused)
{
    (void)unused;
    const char *folder = PEL_SOURCE_DIR "/tests/fuzz/corpus/vtp";
    DIR *stream = opendir(folder);
    int count = 0;
    assert_non_null(stream);
    for (struct dirent *entry = readdir(stream); entry != NULL; entry = readdir(stream)) {
        char path[1000], *bytes;
        size_t size;
        if (entry->d_name[0] == '.')
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        assert_int_equal(pel_file_read(path, &bytes, &size, NULL), PEL_OK);
        pel_mesh *mesh;
        bool sound = strstr(path, "/raw_") != NULL || strstr(path, "/zlib_") != NULL || strstr(path, "/other_") != NULL;
        assert_int_equal(pel_vtp_read(path, &mesh, NULL, NULL), sound ? PEL_OK : PEL_BAD_FORMAT);
        pel_mesh_destroy(mesh);
        for (size_t length = 0; length <= size; length++) {
            /* a block of just this size shows every read beyond its end */
            uint8_t *cut = pel_allocate(length, 1);
            memcpy(cut, bytes, length);
            fuzz_parse_vtp(cut, length);
            pel_free(cut);
        }
        pel_free(bytes);
        count++;
    }
    closedir(stream);
    assert_true(count >= 8);
}

/* changed bytes give an error or a mesh, never a crash */
static void test_damaged(void **unused)
{
    (void)unused;
    random_state random = {11};
    for (int kind = 0; kind < 400; kind++) {
        sample_data sample;
        make_sample(&sample, 1);
        char *bytes;
        size_t size;
        pel_mesh *mesh;
        sample.vtp.compress = kind % 2 != 0;
        assert_int_equal(pel_vtp_write(PATH, &sample.vtp, NULL), PEL_OK);
        assert_int_equal(pel_file_read(PATH, &bytes, &size, NULL), PEL_OK);
        for (int i = 0; i < 3; i++)
            bytes[random_integer(&random, 0, (int64_t)size - 1)] = (char)random_bits(&random);
        write_bytes(bytes, size);
        pel_status status = pel_vtp_read(PATH, &mesh, NULL, NULL);
        assert_true(status == PEL_OK || status == PEL_BAD_FORMAT);
        assert_true((status == PEL_OK) == (mesh != NULL));
        pel_mesh_destroy(mesh);
        pel_free(bytes);
        free_sample(&sample);
    }
    unlink(PATH);
}

/* counts that a small file cannot hold are refused before memory is asked for */
static void test_lying_head(void **unused)
{
    (void)unused;
    static const char text[] =
        "<VTKFile type=\"PolyData\" header_type=\"UInt64\"%s><Piece NumberOfPoints=\"2000000000\" NumberOfPolys=\"1\">"
        "<Points><DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"appended\" "
        "offset=\"0\"/>"
        "</Points></Piece><AppendedData encoding=\"raw\">_xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx</AppendedData></VTKFile>";
    const char *const compressors[2] = {"", " compressor=\"vtkZLibDataCompressor\""};
    for (int i = 0; i < 2; i++) {
        char bytes[1000];
        pel_mesh *mesh;
        pel_error error;
        snprintf(bytes, sizeof bytes, text, compressors[i]);
        write_bytes(bytes, strlen(bytes));
        assert_int_equal(pel_vtp_read(PATH, &mesh, NULL, &error), PEL_BAD_FORMAT);
        assert_true(error.byte_offset > 0);
    }
    unlink(PATH);
}

/* one word of the head is another: each is refused with its reason, at its place */
static void test_bad_heads(void **unused)
{
    (void)unused;
    static const struct {
        const char *word, *other, *what;
    } cases[] = {
        {"type=\"PolyData\"", "type=\"ImageData\"", "not a VTK PolyData file"},
        {"LittleEndian", "BigEndian", "the size of an array differs from that in its header"},
        {"vtkZLibDataCompressor", "vtkLZ4DataCompressor", "not packed by zlib"},
        {"<VTKFile", "<VTKfile", "not a VTK file"},
        {"NumberOfPoints=\"", "NumberOfPoints=\"-", "the number of points or polygons is missing or out of range"},
        {"NumberOfPoints=\"", "NumberOfPoints=\"99", "an array "},
        {"NumberOfPolys=\"", "NumberOfPolys=\"99", "the size of an array differs from that in its header"},
        {"NumberOfPolys=\"", "NumberOfPolys=\"0\" a=\"", "the number of points or polygons is missing"},
        {"<Piece ", "<Piece NumberOfStrips=\"1\" ", "the polygons are missing"},
        {"<Piece ", "<Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\"/><Piece ", "more than one piece"},
        {"NumberOfComponents=\"3\"", "NumberOfComponents=\"0\"", "no components or very many"},
        {"NumberOfComponents=\"3\"", "NumberOfComponents=\"32768\"", "no components or very many"},
        {"NumberOfComponents=\"3\"", "NumberOfComponents=\"4\"",
         "the size of an array differs from that in its header"},
        {"type=\"Float64\" Name=\"energy\"", "type=\"Float65\" Name=\"energy\"", "an array has an unknown type"},
        {"Name=\"energy\"", "Name=\"\"", "an array has no name"},
        {"Name=\"connectivity\"", "Name=\"connections\"", "the polygons are missing"},
        {"Name=\"offsets\"", "Name=\"offset\"", "the polygons are missing"},
        {"<Points>", "<Pointz>", "the points are missing"},
        {"format=\"appended\"", "format=\"ascii\"", "an array has fewer numbers than its header says"},
        {"offset=\"0\"", "offset=\"999999999999999999\"", "an array has fewer numbers than its header says"},
        {"encoding=\"raw\"", "encoding=\"base64\"", "the size of an array differs from that in its header"},
        {"</VTKFile>", "", "the file is cut off"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (int compress = 0; compress < 2; compress++) {
            sample_data sample;
            make_sample(&sample, 1);
            sample.vtp.compress = compress != 0;
            sample.vtp.float64 = true;
            char *bytes;
            size_t size;
            pel_mesh *mesh;
            pel_error error;
            assert_int_equal(pel_vtp_write(PATH, &sample.vtp, NULL), PEL_OK);
            assert_int_equal(pel_file_read(PATH, &bytes, &size, NULL), PEL_OK);
            const char *word = cases[i].word, *place = bytes;
            while (place + strlen(word) <= bytes + size && memcmp(place, word, strlen(word)) != 0)
                place++;
            if (place + strlen(word) <= bytes + size) {
                FILE *stream = fopen(PATH, "wb");
                assert_non_null(stream);
                fwrite(bytes, 1, (size_t)(place - bytes), stream);
                fputs(cases[i].other, stream);
                place += strlen(word);
                fwrite(place, 1, size - (size_t)(place - bytes), stream);
                fclose(stream);
                assert_int_equal(pel_vtp_read(PATH, &mesh, NULL, &error), PEL_BAD_FORMAT);
                assert_null(mesh);
                if (strstr(error.what, cases[i].what) == NULL)
                    fail_msg("%s instead of %s: %s", cases[i].other, word, error.what);
                assert_true(error.byte_offset >= 0 && error.remedy[0] != '\0');
            } else {
                /* only packed files name their compressor */
                assert_true(compress == 0 && strcmp(word, "vtkZLibDataCompressor") == 0);
            }
            pel_free(bytes);
            free_sample(&sample);
        }
    unlink(PATH);
}

/* arrays that claim the same bytes could ask for far more memory than the file has */
static void test_shared_bytes(void **unused)
{
    (void)unused;
    sample_data sample;
    make_sample(&sample, 1);
    char *bytes;
    size_t size;
    pel_mesh *mesh;
    pel_error error;
    assert_int_equal(pel_vtp_write(PATH, &sample.vtp, NULL), PEL_OK);
    assert_int_equal(pel_file_read(PATH, &bytes, &size, NULL), PEL_OK);
    const char *place = strstr(bytes, "</PointData>");
    for (int copies = 0; copies < 20; copies += 19) {
        FILE *stream = fopen(PATH, "wb");
        assert_non_null(stream);
        fwrite(bytes, 1, (size_t)(place - bytes), stream);
        for (int i = 0; i < copies; i++)
            fprintf(stream, "<DataArray type=\"Float32\" Name=\"copy %d\" format=\"appended\" offset=\"16\"/>\n", i);
        fwrite(place, 1, size - (size_t)(place - bytes), stream);
        fclose(stream);
        assert_int_equal(pel_vtp_read(PATH, &mesh, NULL, &error), copies > 0 ? PEL_BAD_FORMAT : PEL_OK);
        pel_mesh_destroy(mesh);
    }
    pel_free(bytes);
    free_sample(&sample);
    unlink(PATH);
}

/* further forms that VTK writes, by hand: text, base64 in pieces, numbers of the other byte order */
static void test_inline(void **unused)
{
    (void)unused;
    static const char head[] =
        "<?xml version=\"1.0\"?>\n<!-- it's > one -->\n"
        "<VTKFile type=\"PolyData\" byte_order=\"%s\"><PolyData>\n"
        "<Piece NumberOfPoints=\"4\" NumberOfVerts=\"1\" NumberOfPolys=\"%d\" NumberOfStrips=\"%d\">\n"
        "<PointData><DataArray type=\"UInt8\" Name=\"level\" format=\"%s\">%s</DataArray></PointData>\n"
        "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">\n"
        "<InformationKey name=\"L2\"> 7 </InformationKey>\n"
        "0 0 0 1 0 0  1 1 0 0 1e0 0</DataArray></Points>\n"
        "<%s><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\"> %s </DataArray>\n"
        "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray></%s>\n"
        "</Piece></PolyData></VTKFile>\n";
    static const struct {
        const char *order, *format, *level, *section, *corners;
        int32_t first[3], second[3];
    } cases[] = {
        {"LittleEndian", "ascii", "1 2 3 4", "Polys", "0 1 2 3", {0, 1, 2}, {0, 2, 3}},
        {"LittleEndian", "binary", "BAAAAAECAwQ=", "Polys", "0 1 2 3", {0, 1, 2}, {0, 2, 3}},
        {"LittleEndian", "binary", "BAAAAA==AQID BA==", "Strips", "0 1 3 2", {0, 1, 3}, {1, 2, 3}},
        {"BigEndian", "binary", "AAAABAECAwQ=", "Polys", "0 1 2 3", {0, 1, 2}, {0, 2, 3}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[2000];
        bool strips = strcmp(cases[i].section, "Strips") == 0;
        int length = snprintf(text, sizeof text, head, cases[i].order, !strips, strips, cases[i].format, cases[i].level,
                              cases[i].section, cases[i].corners, cases[i].section);
        pel_mesh *mesh;
        pel_error error;
        if (pel_vtp_parse("a.vtp", text, (size_t)length, &mesh, NULL, &error) != PEL_OK)
            fail_msg("case %d: %s", (int)i, error.what);
        assert_int_equal(mesh->triangle_count, 2);
        assert_memory_equal(mesh->triangles[0], cases[i].first, sizeof cases[i].first);
        assert_memory_equal(mesh->triangles[1], cases[i].second, sizeof cases[i].second);
        assert_true(mesh->positions[3][1] == 1);
        for (int v = 0; v < 4; v++)
            assert_true(pel_mesh_field(mesh, "level")->values[v] == v + 1);
        pel_mesh_destroy(mesh);
        /* cut off anywhere it is refused, and so is one number too few */
        for (size_t cut = 0; cut + 11 < (size_t)length; cut += 7)
            assert_int_equal(pel_vtp_parse("a.vtp", text, cut, &mesh, NULL, &error), PEL_BAD_FORMAT);
    }
}

/* ends of polygons are whole, in order, and as many corners as there are; empty polygons are none */
static void test_offsets(void **unused)
{
    (void)unused;
    static const char head[] =
        "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\"><PolyData><Piece NumberOfPoints=\"4\" "
        "NumberOfPolys=\"2\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">"
        "0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points>\n"
        "<Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 0 2 3</DataArray>\n"
        "<DataArray type=\"Float64\" Name=\"offsets\" format=\"ascii\">%s</DataArray></Polys></Piece></PolyData>"
        "</VTKFile>\n";
    static const char order[] = "do not increase", size[] = "fewer numbers than its header says";
    static const struct {
        const char *offsets, *words;
    } cases[] = {{"3 6", NULL},    {"6 6", NULL},           {"0 6", NULL},      {"6 3", order},         {"-1 6", order},
                 {"3.5 6", order}, {"3 2147483648", order}, {"3 1e300", order}, {"3 2147483647", size}, {"3 7", size}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1000];
        int length = snprintf(text, sizeof text, head, cases[i].offsets);
        pel_mesh *mesh;
        pel_error error = {0};
        pel_status status = pel_vtp_parse("a.vtp", text, (size_t)length, &mesh, NULL, &error);
        if ((status == PEL_OK) != (cases[i].words == NULL) ||
            (cases[i].words != NULL && strstr(error.what, cases[i].words) == NULL))
            fail_msg("%s: %s", cases[i].offsets, error.what);
        assert_true(mesh == NULL || mesh->triangle_count == (i == 0 ? 2 : 4));
        pel_mesh_destroy(mesh);
    }
}

/* zeros that are packed 1000 to 1 are not unpacked without end */
static void test_bomb(void **unused)
{
    (void)unused;
    sample_data sample;
    make_sample(&sample, 3);
    enum { TUPLES = 1 << 14 };
    double *zeros = calloc((size_t)sample.vtp.vertex_count, TUPLES * sizeof *zeros);
    assert_non_null(zeros);
    const pel_vtp_field field = {"zeros", TUPLES, zeros};
    sample.vtp.fields = &field;
    sample.vtp.field_count = 1;
    sample.vtp.compress = true;
    pel_mesh *mesh;
    pel_error error;
    assert_int_equal(pel_vtp_write(PATH, &sample.vtp, NULL), PEL_OK);
    assert_int_equal(pel_vtp_read(PATH, &mesh, NULL, &error), PEL_BAD_FORMAT);
    assert_non_null(strstr(error.what, "than fit into the file"));
    unlink(PATH);
    free(zeros);
    free_sample(&sample);
}

static void test_refuses(void **unused)
{
    (void)unused;
    sample_data sample;
    make_sample(&sample, 1);
    pel_error error;
    pel_mesh *mesh;
    sample.fields[0].name = "";
    assert_int_equal(pel_vtp_write(PATH, &sample.vtp, &error), PEL_BAD_ARGUMENT);
    sample.fields[0].name = "a-name-of-64-characters-----------------------------------------";
    assert_int_equal(pel_vtp_write(PATH, &sample.vtp, &error), PEL_BAD_ARGUMENT);
    sample.fields[0].name = "energy";
    pel_vtp huge = sample.vtp;
    huge.triangle_count = INT32_MAX / 3 + 1;
    assert_int_equal(pel_vtp_write(PATH, &huge, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "715827883 triangles"));
    assert_int_equal(pel_vtp_write("no-such-folder/a.vtp", &sample.vtp, &error), PEL_BAD_FILE);
    assert_string_equal(error.file, "no-such-folder/a.vtp");
    assert_int_equal(pel_vtp_read("no-such-folder/a.vtp", &mesh, NULL, &error), PEL_BAD_FILE);
    assert_int_equal(access(PATH, F_OK), -1);
    free_sample(&sample);
}

static pel_status write_and_read(const void *data, pel_error *error)
{
    pel_mesh *mesh;
    pel_status status = pel_vtp_write(PATH, data, error);
    if (status == PEL_OK)
        status = pel_vtp_read(PATH, &mesh, NULL, error);
    if (status == PEL_OK)
        pel_mesh_destroy(mesh);
    return status;
}

typedef struct file_bytes {
    char *bytes;
    size_t size;
} file_bytes;

static pel_status parse(const void *data, pel_error *error)
{
    const file_bytes *file = data;
    pel_mesh *mesh;
    pel_status status = pel_vtp_parse("a.vtp", file->bytes, file->size, &mesh, NULL, error);
    assert_true((mesh == NULL) == (status != PEL_OK));
    pel_mesh_destroy(mesh);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    for (int compress = 0; compress < 2; compress++) {
        sample_data sample;
        make_sample(&sample, 1);
        sample.vtp.compress = compress != 0;
        assert_true(for_every_allocation_failure(write_and_read, &sample.vtp) > 10);
        file_bytes file;
        assert_int_equal(pel_file_read(PATH, &file.bytes, &file.size, NULL), PEL_OK);
        assert_true(for_every_allocation_failure(parse, &file) > 5);
        pel_free(file.bytes);
        free_sample(&sample);
    }
    unlink(PATH);
}

/* a reader that knows only the description of the format sees the same numbers */
static void test_other_reader(void **unused)
{
    (void)unused;
    if (system("python3 -c pass") != 0)
        skip();
    for (int kind = 0; kind < 4; kind++) {
        sample_data sample;
        make_sample(&sample, 20);
        double sum = 0;
        char line[200], expected[200];
        sample.vtp.compress = (kind & 1) != 0;
        sample.vtp.float64 = (kind & 2) != 0;
        assert_int_equal(pel_vtp_write(PATH, &sample.vtp, NULL), PEL_OK);
        for (int32_t i = 0; i < sample.vtp.vertex_count; i++)
            sum += sample.vtp.float64 ? sample.scalar[i] : (double)(float)sample.scalar[i];
        FILE *stream = popen("python3 " PEL_SOURCE_DIR "/tests/io/check_vtp.py " PATH, "r");
        assert_non_null(fgets(line, sizeof line, stream));
        assert_string_equal(line, "TimeValue 1 1 0.100000\n");
        assert_non_null(fgets(line, sizeof line, stream));
        snprintf(expected, sizeof expected, "energy 1 %d %.6f\n", (int)sample.vtp.vertex_count, sum);
        assert_string_equal(line, expected);
        while (fgets(line, sizeof line, stream) != NULL) {
        }
        snprintf(expected, sizeof expected, "offsets 1 %d ", (int)sample.vtp.triangle_count);
        assert_memory_equal(line, expected, strlen(expected));
        assert_int_equal(pclose(stream), 0);
        free_sample(&sample);
    }
    unlink(PATH);
}

static void test_blocks(void **unused)
{
    (void)unused;
    random_state random = {3};
    const size_t sizes[] = {0, 1, 65535, 65536, 65537, 200000};
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
        unsigned char *bytes = pel_allocate(sizes[s], 1), *back = pel_allocate(sizes[s], 1);
        unsigned char *packed = pel_allocate(pel_vtk_blocks_bound(sizes[s]), 1);
        size_t packed_size;
        for (size_t i = 0; i < sizes[s]; i++)
            bytes[i] = (unsigned char)random_bits(&random);
        assert_int_equal(pel_vtk_blocks_pack(bytes, sizes[s], packed, &packed_size, NULL), PEL_OK);
        assert_true(packed_size <= pel_vtk_blocks_bound(sizes[s]));
        assert_int_equal(pel_vtk_blocks_check(packed, packed_size, 8, sizes[s]), packed_size);
        assert_int_equal(pel_vtk_blocks_check(packed, packed_size, 8, sizes[s] + 1), 0);
        assert_int_equal(pel_vtk_blocks_check(packed, packed_size - 1, 8, sizes[s]), 0);
        assert_int_equal(pel_vtk_blocks_unpack(packed, 8, back, sizes[s], NULL), PEL_OK);
        assert_memory_equal(bytes, back, sizes[s] > 0 ? sizes[s] : 1);
        pel_free(packed);
        pel_free(back);
        pel_free(bytes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),   cmocka_unit_test(test_cut_off),
        cmocka_unit_test(test_corpus),       cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_lying_head),   cmocka_unit_test(test_shared_bytes),
        cmocka_unit_test(test_bad_heads),    cmocka_unit_test(test_series),
        cmocka_unit_test(test_inline),       cmocka_unit_test(test_bomb),
        cmocka_unit_test(test_refuses),      cmocka_unit_test(test_allocation_failures),
        cmocka_unit_test(test_other_reader), cmocka_unit_test(test_blocks),
        cmocka_unit_test(test_offsets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
