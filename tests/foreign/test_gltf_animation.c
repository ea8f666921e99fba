/* Animations of glTF: nodes, bones, targets; closed forms of their places. */
#include "check.h"
#include "failing_malloc.h"
#include "foreign/gltf.h"
#include "gltf_text.h"
#include "pellicle/import.h"
#include "sequence/sequence.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define PI 3.14159265358979323846
/* the numbers of the files are floats */
#define FLOAT_ERROR 1e-6

enum { VERTICES = 4, MOST_VIEWS = 12 };

/* a file whose accessors are put one after the other, and what stands before them */
typedef struct animated {
    gltf_text file;
    char views[2000], accessors[3000];
    int count;
} animated;

static int put(animated *a, const char *type, int component, const double *numbers, size_t count, size_t width)
{
    char *views = a->views + strlen(a->views), *accessors = a->accessors + strlen(a->accessors);
    const size_t begin = a->file.size, size = component == 5126 ? 4 : 1;
    for (size_t i = 0; i < count * width; i++, a->file.size += size) {
        if (component == 5126)
            pel_store_float(a->file.bytes + a->file.size, false, (float)numbers[i]);
        else
            pel_store_bytes(a->file.bytes + a->file.size, 1, false, (uint64_t)numbers[i]);
    }
    a->file.size = (a->file.size + 3) / 4 * 4;
    assert_true(a->file.size < sizeof a->file.bytes && a->count < MOST_VIEWS);
    snprintf(views, 200, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", a->count > 0 ? "," : "", begin,
             count * width * size);
    snprintf(accessors, 200, "%s{\"bufferView\":%d,\"componentType\":%d,\"count\":%zu,\"type\":\"%s\"}",
             a->count > 0 ? "," : "", a->count, component, count, type);
    return a->count++;
}

/* `head` has all but accessors, views and buffer */
static const char *finish(animated *a, const char *head)
{
    static char middle[12000];
    snprintf(middle, sizeof middle, "{\"asset\":{\"version\":\"2.0\"},%s,\"accessors\":[%s],\"bufferViews\":[%s]", head,
             a->accessors, a->views);
    return gltf_text_end(&a->file, middle);
}

/* an arm of two triangles along x, in the file's accessors 0 and 1 */
static const double arm[VERTICES][3] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {2, 0, 0}};
static const double corners[6] = {0, 1, 2, 1, 3, 2};

static animated begin(void)
{
    animated a = {.count = 0};
    put(&a, "VEC3", 5126, arm[0], VERTICES, 3);
    put(&a, "SCALAR", 5121, corners, 6, 1);
    return a;
}

#define MESH(more) "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0" more "},\"indices\":1}]}]"
#define ONE_NODE "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
#define ONE_CHANNEL(path, more)                                                                                        \
    "\"animations\":[{\"name\":\"go\",\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"" path            \
    "\"}}],\"samplers\":[{\"input\":2,\"output\":3" more "}]}]"

#define ONE_MOVE(name, path)                                                                                           \
    "{\"name\":\"" name "\",\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"" path                      \
    "\"}}],\"samplers\":[{\"input\":2,\"output\":3}]}"

static pel_sequence *parse(const char *text, const char *animation, double fps)
{
    pel_sequence *sequence;
    pel_error error;
    char words[700];
    if (pel_gltf_parse_sequence("a.gltf", text, strlen(text), animation, fps, &sequence, &error) != PEL_OK)
        fail_msg("%s\n%.1500s", pel_error_text(&error, words, sizeof words), text);
    return sequence;
}

static void refuse(const char *text, const char *animation, double fps, const char *words)
{
    pel_sequence *sequence = (pel_sequence *)(uintptr_t)1;
    pel_error error = {0};
    char said[700] = "";
    pel_status status = pel_gltf_parse_sequence("a.gltf", text, strlen(text), animation, fps, &sequence, &error);
    if (status != PEL_OK)
        pel_error_text(&error, said, sizeof said);
    if (status != PEL_BAD_FORMAT || sequence != NULL || strstr(said, words) == NULL || error.remedy[0] == '\0')
        fail_msg("expected '%s', got '%s' for\n%.1500s", words, said, text);
}

static void check_place(const pel_sequence *sequence, double time, int v, double x, double y, double z)
{
    double places[VERTICES][3];
    pel_sequence_at(sequence, time, places[0]);
    const double expected[3] = {x, y, z};
    for (int k = 0; k < 3; k++)
        assert_near(places[v][k], expected[k], FLOAT_ERROR);
}

/* ---- nodes ---- */

static const double times[3] = {0, 1, 3};

/* a node that moves: linear, constant and cubic between its keys */
static void test_translation(void **unused)
{
    (void)unused;
    static const double places[3][3] = {{0, 0, 0}, {0, 0, 2}, {0, 0, 6}};
    animated a = begin();
    put(&a, "SCALAR", 5126, times, 3, 1);
    put(&a, "VEC3", 5126, places[0], 3, 3);
    const animated keys = a;
    pel_sequence *sequence = parse(finish(&a, ONE_NODE MESH("") "," ONE_CHANNEL("translation", "")), NULL, 4);
    assert_int_equal(pel_sequence_frame_count(sequence), 13);
    check_place(sequence, 0.5, 3, 2, 0, 1);
    check_place(sequence, 2, 3, 2, 0, 4);
    check_place(sequence, 9, 0, 0, 0, 6);
    pel_sequence_destroy(sequence);
    a = keys;
    sequence =
        parse(finish(&a, ONE_NODE MESH("") "," ONE_CHANNEL("translation", ",\"interpolation\":\"STEP\"")), "0", 1);
    check_place(sequence, 2, 0, 0, 0, 2);
    check_place(sequence, 3, 0, 0, 0, 6);
    pel_sequence_destroy(sequence);
    /* 2.4 frames: the last one is at the end */
    a = keys;
    sequence = parse(finish(&a, ONE_NODE MESH("") "," ONE_CHANNEL("translation", "")), "go", 0.8);
    assert_int_equal(pel_sequence_frame_count(sequence), 4);
    assert_near(pel_sequence_time(sequence, 2), 2.5, 1e-15);
    assert_near(pel_sequence_time(sequence, 3), 3, 1e-15);
    pel_sequence_destroy(sequence);
    /* tangent in, value, tangent out of each key */
    static const double cubic[9][3] = {{0},       {0, 0, 0}, {0, 0, 3}, {0, 0, -1}, {0, 0, 2},
                                       {0, 0, 5}, {0, 0, 4}, {0, 0, 6}, {0}};
    a = begin();
    put(&a, "SCALAR", 5126, times, 3, 1);
    put(&a, "VEC3", 5126, cubic[0], 9, 3);
    sequence = parse(finish(&a, ONE_NODE MESH("") "," ONE_CHANNEL("translation", ",\"interpolation\":\"CUBICSPLINE\"")),
                     NULL, 2);
    /* half way: the mean of the values and an eighth of seconds times the difference of the tangents */
    check_place(sequence, 0.5, 0, 0, 0, 1 + (3 + 1) / 8.0);
    check_place(sequence, 2, 0, 0, 0, 4 + 2 * (5 - 4) / 8.0);
    check_place(sequence, 1, 0, 0, 0, 2);
    pel_sequence_destroy(sequence);
}

/* rotations go the shorter way at a constant speed, under a node above that is scaled */
static void test_rotation(void **unused)
{
    (void)unused;
    /* 0 and 120 degrees about z; the second one with the other sign, which is the same rotation */
    static const double turns[2][4] = {{0, 0, 0, 2}, {0, 0, -0.86602540378, -0.5}};
    animated a = begin();
    put(&a, "SCALAR", 5126, times, 2, 1);
    put(&a, "VEC4", 5126, turns[0], 2, 4);
    pel_sequence *sequence = parse(
        finish(&a, "\"scenes\":[{\"nodes\":[1]}],\"nodes\":[{\"mesh\":0},{\"scale\":[2,2,2],\"translation\":[0,0,1],"
                   "\"children\":[0]}]," MESH("") "," ONE_CHANNEL("rotation", "")),
        NULL, 12);
    for (int i = 0; i <= 12; i++) {
        const double angle = i / 12.0 * PI * 2 / 3;
        check_place(sequence, i / 12.0, 3, 4 * cos(angle), 4 * sin(angle), 1);
        check_place(sequence, i / 12.0, 2, 2 * cos(angle), 2 * sin(angle), 3);
    }
    pel_sequence_destroy(sequence);
}

/* two that move different things are one; by name it is one of them */
static void test_together(void **unused)
{
    (void)unused;
    static const double places[3][3] = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
    static const char both[] =
        ONE_NODE MESH("") ",\"animations\":[" ONE_MOVE("go", "translation") "," ONE_MOVE("grow", "scale") "]";
    const struct {
        const char *animation;
        double place[3];
    } cases[] = {{NULL, {6, 2, 2}}, {"go", {4, 2, 2}}, {"1", {4, 0, 0}}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        animated a = begin();
        put(&a, "SCALAR", 5126, times, 3, 1);
        put(&a, "VEC3", 5126, places[0], 3, 3);
        pel_sequence *sequence = parse(finish(&a, both), cases[c].animation, 1);
        const double *place = cases[c].place;
        check_place(sequence, 1, 3, place[0], place[1], place[2]);
        pel_sequence_destroy(sequence);
    }
}

/* ---- targets ---- */

static void test_weights(void **unused)
{
    (void)unused;
    static const double up[VERTICES][3] = {{0}, {0}, {0}, {0, 0, 4}}, aside[VERTICES][3] = {{0}, {0}, {0}, {0, 2, 0}};
    /* two weights for each of three keys */
    static const double weights[6] = {0, 0, 1, 0, 0.5, 1};
    animated a = begin();
    put(&a, "SCALAR", 5126, times, 3, 1);
    put(&a, "SCALAR", 5126, weights, 6, 1);
    put(&a, "VEC3", 5126, up[0], VERTICES, 3);
    put(&a, "VEC3", 5126, aside[0], VERTICES, 3);
    pel_sequence *sequence =
        parse(finish(&a, ONE_NODE
                     "\"meshes\":[{\"weights\":[7,7],\"primitives\":[{\"attributes\":{\"POSITION\":0},"
                     "\"indices\":1,\"targets\":[{\"POSITION\":4},{\"POSITION\":5}]}]}]," ONE_CHANNEL("weights", "")),
              NULL, 4);
    check_place(sequence, 0, 3, 2, 0, 0);
    check_place(sequence, 0.5, 3, 2, 0, 2);
    check_place(sequence, 2, 3, 2, 1, 3);
    check_place(sequence, 3, 3, 2, 2, 2);
    check_place(sequence, 3, 0, 0, 0, 0);
    pel_sequence_destroy(sequence);
}

/* ---- bones ---- */

#define SKINNED(node, joints, more)                                                                                    \
    "\"scenes\":[{\"nodes\":[1,0]}],\"nodes\":[{\"mesh\":0,\"skin\":0" node "},{\"children\":[2]},"                    \
    "{\"translation\":[1,0,0]}],\"skins\":[{\"joints\":" joints ",\"inverseBindMatrices\":4}]," MESH(                  \
        ",\"JOINTS_0\":5,\"WEIGHTS_0\":6") ",\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":2,"    \
                                           "\"path\":\"rotation\"}}],\"samplers\":[{\"input\":2,\"output\":3}]}]" more

/* a lower arm that turns by 90 degrees about the elbow at (1, 0, 0) */
static animated skinned(double third_weight)
{
    static const double turns[2][4] = {{0, 0, 0, 1}, {0, 0, 0.70710678118, 0.70710678118}};
    static const double inverses[2][16] = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                                           {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1}};
    static const double joints[VERTICES][4] = {{0}, {0, 1}, {0, 1}, {1}};
    /* they have the sum 2, and are halved */
    const double weights[VERTICES][4] = {{2}, {1, 1}, {third_weight, 0.5}, {2}};
    animated a = begin();
    put(&a, "SCALAR", 5126, times, 2, 1);
    put(&a, "VEC4", 5126, turns[0], 2, 4);
    put(&a, "MAT4", 5126, inverses[0], 2, 16);
    put(&a, "VEC4", 5121, joints[0], VERTICES, 4);
    put(&a, "VEC4", 5126, weights[0], VERTICES, 4);
    return a;
}

static void test_bones(void **unused)
{
    (void)unused;
    animated a = skinned(1.5);
    /* the place of the node of a mesh with bones has no effect (glTF 2.0, section 3.7.3.3) */
    const char *text = finish(&a, SKINNED(",\"translation\":[5,5,5]", "[1,2]", ""));
    pel_sequence *sequence = parse(text, NULL, 8);
    for (int i = 0; i <= 8; i++) {
        const double angle = i / 8.0 * PI / 2;
        check_place(sequence, i / 8.0, 0, 0, 0, 0);
        check_place(sequence, i / 8.0, 1, 1, 0, 0);
        check_place(sequence, i / 8.0, 2, 1, 0, 1);
        check_place(sequence, i / 8.0, 3, 1 + cos(angle), sin(angle), 0);
    }
    pel_sequence_destroy(sequence);
    /* the mesh itself stands as the bones do in the file */
    pel_mesh *mesh;
    assert_int_equal(pel_gltf_parse("a.gltf", text, strlen(text), NULL, &mesh, NULL), PEL_OK);
    assert_near(mesh->positions[3][0], 2, FLOAT_ERROR);
    assert_near(mesh->positions[3][1], 0, FLOAT_ERROR);
    pel_mesh_destroy(mesh);
    a = skinned(-0.5);
    refuse(finish(&a, SKINNED("", "[1,2]", "")), NULL, 8, "vertex 2 has a weight of -0.5");
    a = skinned(1);
    refuse(finish(&a, SKINNED("", "[1]", "")), NULL, 8, "is moved by bone 1 of 1");
    a = skinned(1);
    refuse(finish(&a, SKINNED("", "[1,7]", "")), NULL, 8, "there is no such node");
    a = skinned(1);
    refuse(finish(&a, SKINNED("", "[]", "")), NULL, 8, "a skin has no joints");
    a = skinned(1);
    refuse(finish(&a, SKINNED("", "[1,2,0]", "")), NULL, 8, "2 matrices for 3 bones");
}

/* ---- bad files ---- */

static void test_refusals(void **unused)
{
    (void)unused;
    static const double falling[3] = {0, 2, 1}, places[3][3] = {{0}};
    animated keys = begin();
    put(&keys, "SCALAR", 5126, times, 3, 1);
    put(&keys, "VEC3", 5126, places[0], 3, 3);
    put(&keys, "SCALAR", 5126, falling, 3, 1);
    static const struct {
        const char *head, *animation, *words;
        double fps;
    } cases[] = {
        {ONE_NODE MESH(""), NULL, "the file has no animation", 24},
        {ONE_NODE MESH("") ",\"animations\":[" ONE_MOVE("walk", "translation") "," ONE_MOVE("run", "translation") "]",
         NULL, "2 animations of the same nodes: walk, run", 24},
        {ONE_NODE MESH("") ",\"animations\":[{\"name\":\"walk\"},{}]", "swim", "'swim'; there are: walk, 1", 24},
        {ONE_NODE MESH("") ",\"animations\":[{\"channels\":[]}]", NULL, "moves no node", 24},
        {ONE_NODE MESH("") "," ONE_CHANNEL("translation", ""), NULL, "places of vertices", 1e7},
        {ONE_NODE MESH("") "," ONE_CHANNEL("rotation", ""), NULL, "does not have the type VEC4", 24},
        {ONE_NODE MESH("") "," ONE_CHANNEL("translation", ",\"interpolation\":\"WILD\""), NULL, "interpolation", 24},
        {ONE_NODE MESH("") "," ONE_CHANNEL("translation", ",\"interpolation\":\"CUBICSPLINE\""), NULL,
         "3 keys of a channel have 3 values", 24},
        {"\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}]," MESH(
             "") "," ONE_CHANNEL("translation", ""),
         NULL, "both a matrix and an animation", 24},
        {ONE_NODE MESH(
             "") ",\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"scale\"}}],"
                 "\"samplers\":[{\"input\":4,\"output\":3}]}]",
         NULL, "the time of key 2", 24},
        {ONE_NODE MESH(
             "") ",\"animations\":[{\"channels\":[{\"sampler\":1,\"target\":{\"node\":0,\"path\":\"scale\"}}],"
                 "\"samplers\":[{\"input\":2,\"output\":3}]}]",
         NULL, "'sampler' is no whole number from 0 to 0", 24},
        {ONE_NODE MESH(
             "") ",\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"scale\"}}],"
                 "\"samplers\":[{\"input\":2}]}]",
         NULL, "no times or no values", 24},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        animated a = keys;
        refuse(finish(&a, cases[i].head), cases[i].animation, cases[i].fps, cases[i].words);
    }
    /* a scale of 0 is no fault; other channels are left out */
    animated a = keys;
    pel_sequence_destroy(
        parse(finish(&a, ONE_NODE MESH("") ",\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{"
                                           "\"node\":0,\"path\":\"pointer\"}},{\"sampler\":0,\"target\":{\"node\":0,"
                                           "\"path\":\"scale\"}}],\"samplers\":[{\"input\":2,\"output\":3}]}]"),
              NULL, 1));
}

/* nodes that move nothing take time in each frame */
static void test_many_nodes(void **unused)
{
    (void)unused;
    enum { NODES = 60 };
    static const double places[3][3] = {{0}};
    char head[2000];
    int length = sprintf(head, "\"scenes\":[{\"nodes\":[0");
    for (int i = 1; i < NODES; i++)
        length += sprintf(head + length, ",%d", i);
    length += sprintf(head + length, "]}],\"nodes\":[{\"mesh\":0}");
    for (int i = 1; i < NODES; i++)
        length += sprintf(head + length, ",{}");
    sprintf(head + length, "]," MESH("") "," ONE_CHANNEL("translation", ""));
    animated a = begin();
    put(&a, "SCALAR", 5126, times, 3, 1);
    put(&a, "VEC3", 5126, places[0], 3, 3);
    refuse(finish(&a, head), NULL, 3e6, "places of vertices");
}

static pel_status parse_skinned(const void *text, pel_error *error)
{
    pel_sequence *sequence;
    pel_status status = pel_gltf_parse_sequence("a.gltf", text, strlen(text), NULL, 2, &sequence, error);
    assert_true((status == PEL_OK) == (sequence != NULL));
    pel_sequence_destroy(sequence);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    animated a = skinned(1);
    char text[sizeof a.file.text];
    memcpy(text, finish(&a, SKINNED("", "[1,2]", "")), sizeof text);
    assert_true(for_every_allocation_failure(parse_skinned, text) >= 30);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_translation), cmocka_unit_test(test_rotation),
        cmocka_unit_test(test_together),    cmocka_unit_test(test_weights),
        cmocka_unit_test(test_bones),       cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_many_nodes),  cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
