/* The calls for JavaScript, compiled for this machine: the state is that of the library, errors come as JSON, and
   memory that runs out is told and leaks nothing. web/test/pellicle.mjs tests them as WebAssembly. */
#include "check.h"
#include "failing_malloc.h"

#include "math/vec3.h"
#include "wasm/calls.h"

#include <pellicle/error.h>
#include <pellicle/live.h>
#include <pellicle/observe.h>
#include <pellicle/scene.h>
#include <pellicle/sim_surface.h>

#include <stdio.h>
#include <string.h>
#include <time.h>

static const char ball[] =
    "version: 1\ntitle: a ball\nbodies:\n"
    "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 3 }, mass: { total: 1 },\n"
    "      springs: { stiffness: 3, damping: 0.01 }, volumetric: { stiffness: 1.5, damping: 0.01 } }\n"
    "solver: { method: quasi-static, dt: 0.01 }\nduration: 1\n";
enum { BALL_VERTICES = 92, BALL_TRIANGLES = 180 };

static pel_wasm_sim *create(const char *text)
{
    pel_wasm_sim *sim = pel_wasm_sim_create("scene.yaml", text, (int32_t)strlen(text), NULL, 0);
    assert_non_null(sim);
    return sim;
}

/* whether a text of JSON holds the words */
static bool holds(const pel_wasm_text *text, const char *words)
{
    char copy[20000];
    assert_non_null(text->text);
    snprintf(copy, sizeof copy, "%.*s", (int)text->size, text->text);
    return strstr(copy, words) != NULL;
}

static void test_steps(void **unused)
{
    (void)unused;
    char words[64];
    pel_wasm_sim *sim = create(ball);
    assert_int_equal(pel_wasm_sim_status(sim), PEL_OK);
    assert_true(holds(pel_wasm_sim_hello(sim), "\"title\":\"a ball\""));
    assert_int_equal(pel_wasm_sim_apply(sim, "grab 0 -5 0  0 1 0  20 0.3"), PEL_OK);
    assert_int_equal(pel_wasm_sim_apply(sim, "move 0 -1.5 0"), PEL_OK);
    assert_int_equal(pel_wasm_sim_step(sim, 10), PEL_OK);
    assert_true(pel_wasm_sim_step_count(sim) == 10 && fabs(pel_wasm_sim_time(sim) - 0.1) < 1e-12);
    assert_true(holds(pel_wasm_sim_summary(sim), "\"kind\":\"grab\""));
    assert_true(holds(pel_wasm_sim_scene(sim), "0 grab 0 -5 0 0 1 0 20 0.3"));

    /* the same by the library */
    pel_scene *scene;
    pel_model *model;
    pel_sim *other;
    pel_drag *drag;
    pel_pick_hit hit;
    const double eye[3] = {0, -5, 0}, way[3] = {0, 1, 0}, target[3] = {0, -1.5, 0};
    assert_int_equal(pel_scene_parse("scene.yaml", ball, strlen(ball), NULL, 0, NULL, &scene, NULL), PEL_OK);
    assert_int_equal(pel_model_create(&scene->model, &model, NULL), PEL_OK);
    scene->sim.model = model;
    assert_int_equal(pel_sim_create(&scene->sim, &other, NULL), PEL_OK);
    assert_int_equal(pel_pick(other, eye, way, &hit, NULL), PEL_OK);
    assert_int_equal(pel_drag_begin(other, &hit, 20, 0.3, &drag, NULL), PEL_OK);
    for (int i = 0; i < 10; i++) {
        assert_int_equal(pel_drag_move(drag, target, NULL), PEL_OK);
        assert_int_equal(pel_sim_step(other, NULL), PEL_OK);
    }
    snprintf(words, sizeof words, "\"hash\":\"%016llx\"", (unsigned long long)pel_sim_hash(other));
    assert_true(holds(pel_wasm_sim_summary(sim), words));
    double positions[BALL_VERTICES][3];
    pel_sim_get_positions(other, 0, &positions[0][0]);
    const float *seen = pel_wasm_sim_positions(sim, 0);
    assert_non_null(seen);
    for (int i = 0; i < 3 * BALL_VERTICES; i++)
        assert_true(seen[i] == (float)(&positions[0][0])[i]);
    (void)pel_drag_end(drag, NULL);
    pel_sim_destroy(other);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
    pel_wasm_sim_destroy(sim);
}

static void test_arrays(void **unused)
{
    (void)unused;
    pel_wasm_sim *sim = create(ball);
    assert_int_equal(pel_wasm_sim_vertex_count(sim, 0), BALL_VERTICES);
    assert_int_equal(pel_wasm_sim_triangle_count(sim, 0), BALL_TRIANGLES);
    const float *positions = pel_wasm_sim_positions(sim, 0);
    const int32_t *triangles = pel_wasm_sim_triangles(sim, 0);
    for (int i = 0; i < 3 * BALL_TRIANGLES; i++)
        assert_in_range(triangles[i], 0, BALL_VERTICES - 1);
    assert_int_equal(pel_wasm_sim_step(sim, 1), PEL_OK);
    assert_ptr_equal(pel_wasm_sim_positions(sim, 0), positions);
    int32_t field = pel_field_find("displacement");
    assert_non_null(pel_wasm_sim_field(sim, field, 0));
    for (int32_t body = -1; body <= 1; body += 2) {
        assert_int_equal(pel_wasm_sim_vertex_count(sim, body), 0);
        assert_int_equal(pel_wasm_sim_triangle_count(sim, body), 0);
        assert_true(pel_wasm_sim_revision(sim, body) <= 0);
        assert_null(pel_wasm_sim_positions(sim, body));
        assert_null(pel_wasm_sim_triangles(sim, body));
        assert_null(pel_wasm_sim_field(sim, field, body));
        assert_int_equal(pel_wasm_sim_status(sim), PEL_BAD_ARGUMENT);
    }
    assert_null(pel_wasm_sim_field(sim, -1, 0));
    assert_true(holds(pel_wasm_sim_error(sim), "there is no field -1"));
    const double *hit = pel_wasm_sim_pick(sim, 0, 0, 5, 0, 0, -1);
    assert_true(hit[0] == 1 && hit[1] == 0 && fabs(hit[7] - 1) < 0.1 && hit[10] > 0.9);
    assert_true(pel_wasm_sim_pick(sim, 0, 0, 5, 0, 0, 1)[0] == 0);
    assert_null(pel_wasm_sim_pick(sim, 0, 0, 5, 0, 0, 0));
    pel_wasm_sim_destroy(sim);
    pel_wasm_sim_destroy(NULL);
}

/* every number of a hit is that of the library, and so are fields and triangles */
static void test_queries(void **unused)
{
    (void)unused;
    pel_scene *scene;
    pel_model *model;
    pel_sim *other;
    pel_pick_hit hit;
    const double eye[3] = {0.2, 0.1, 5}, way[3] = {0, 0, -1};
    assert_int_equal(pel_scene_parse("scene.yaml", ball, strlen(ball), NULL, 0, NULL, &scene, NULL), PEL_OK);
    assert_int_equal(pel_model_create(&scene->model, &model, NULL), PEL_OK);
    scene->sim.model = model;
    assert_int_equal(pel_sim_create(&scene->sim, &other, NULL), PEL_OK);
    pel_wasm_sim *sim = create(ball);
    const double *found = pel_wasm_sim_pick(sim, eye[0], eye[1], eye[2], way[0], way[1], way[2]);
    assert_non_null(found);
    assert_int_equal(pel_pick(other, eye, way, &hit, NULL), PEL_OK);
    const double expected[17] = {hit.is_hit,     hit.body,        hit.triangle,    hit.mesh_vertex, hit.distance,
                                 hit.point[0],   hit.point[1],    hit.point[2],    hit.normal[0],   hit.normal[1],
                                 hit.normal[2],  hit.vertices[0], hit.vertices[1], hit.vertices[2], hit.weights[0],
                                 hit.weights[1], hit.weights[2]};
    assert_true(hit.distance > 4 && hit.distance < 4.2);
    for (int i = 0; i < 17; i++)
        assert_near(found[i], expected[i], 0);
    int32_t triangles[BALL_TRIANGLES][3];
    pel_sim_get_triangles(other, 0, triangles[0]);
    assert_memory_equal(pel_wasm_sim_triangles(sim, 0), triangles, sizeof triangles);
    for (int32_t field = 0; field < pel_field_count(); field++) {
        double values[BALL_VERTICES * 9];
        pel_status status = pel_observe(other, field, 0, values, NULL);
        const float *seen = pel_wasm_sim_field(sim, field, 0);
        assert_int_equal(pel_wasm_sim_status(sim), status);
        assert_true((seen != NULL) == (status == PEL_OK));
        for (int32_t i = 0; seen != NULL && i < BALL_VERTICES * pel_field_at(field)->component_count; i++)
            assert_true(seen[i] == (float)values[i] || (isnan(seen[i]) && isnan(values[i])));
    }
    assert_null(pel_wasm_sim_field(sim, pel_field_count(), 0));
    assert_int_equal(pel_wasm_sim_status(sim), PEL_BAD_ARGUMENT);
    pel_sim_destroy(other);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
    pel_wasm_sim_destroy(sim);
}

/* arrays follow a surface that refines */
static void test_refined(void **unused)
{
    (void)unused;
    static const char finer[] =
        "version: 1\nbodies:\n"
        "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 3 }, mass: { total: 1 },\n"
        "      springs: { stiffness: 3, damping: 0.01 }, volumetric: { stiffness: 1.5, damping: 0.01 },\n"
        "      refine: { levels: 1, above: 0.01 } }\n"
        "solver: { method: quasi-static, dt: 0.01 }\nduration: 1\n";
    pel_wasm_sim *sim = create(finer);
    assert_int_equal(pel_wasm_sim_status(sim), PEL_OK);
    assert_non_null(pel_wasm_sim_positions(sim, 0));
    assert_non_null(pel_wasm_sim_triangles(sim, 0));
    assert_int_equal(pel_wasm_sim_apply(sim, "grab 0 -5 0  0 1 0  20 0.3"), PEL_OK);
    assert_int_equal(pel_wasm_sim_apply(sim, "move 0 -1.8 0"), PEL_OK);
    assert_int_equal(pel_wasm_sim_step(sim, 20), PEL_OK);
    int32_t count = pel_wasm_sim_vertex_count(sim, 0), triangle_count = pel_wasm_sim_triangle_count(sim, 0);
    assert_true(count > BALL_VERTICES && triangle_count - 2 * count == BALL_TRIANGLES - 2 * BALL_VERTICES);
    const float *positions = pel_wasm_sim_positions(sim, 0);
    const int32_t *triangles = pel_wasm_sim_triangles(sim, 0);
    int32_t last = 0;
    for (int32_t i = 0; i < 3 * triangle_count; i++)
        last = triangles[i] > last ? triangles[i] : last;
    assert_int_equal(last, count - 1);
    for (int32_t i = 0; i < 3 * count; i++)
        assert_true(fabsf(positions[i]) < 3);
    pel_wasm_sim_destroy(sim);
}

/* notes of the mesh reader are an array of texts */
static void test_notes(void **unused)
{
    (void)unused;
    static const char path[] = "wasm-notes.obj",
                      two[] = "version: 1\nbodies:\n"
                              "  - { name: a, mesh: { file: wasm-notes.obj }, mass: { total: "
                              "1 }, springs: { stiffness: 3 } }\n"
                              "  - { name: b, mesh: { file: wasm-notes.obj }, mass: { total: "
                              "1 }, springs: { stiffness: 3 } }\n"
                              "contact: none\nsolver: { method: explicit, dt: 0.001 }\nduration: 1\n";
    pel_wasm_sim *sim = create(ball);
    const pel_wasm_text *notes = pel_wasm_sim_notes(sim);
    assert_int_equal(notes->size, 2);
    assert_memory_equal(notes->text, "[]", 2);
    pel_wasm_sim_destroy(sim);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "vn 0 0 1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n");
    fclose(file);
    sim = create(two);
    assert_int_equal(pel_wasm_sim_status(sim), PEL_OK);
    assert_true(holds(pel_wasm_sim_notes(sim), "[\"") && holds(pel_wasm_sim_notes(sim), "normals ignored\",\""));
    assert_true(holds(pel_wasm_sim_notes(sim), "normals ignored\"]"));
    pel_wasm_sim_destroy(sim);
    remove(path);
}

static void test_undo(void **unused)
{
    (void)unused;
    char start[400];
    pel_wasm_sim *sim = create(ball);
    const pel_wasm_text *text = pel_wasm_sim_summary(sim);
    snprintf(start, sizeof start, "%.*s", (int)(strcspn(strstr(text->text, "\"hash\""), ",")),
             strstr(text->text, "\"hash\""));
    assert_int_equal(pel_wasm_sim_undo(sim), 0);
    assert_int_equal(pel_wasm_sim_apply(sim, "mark"), PEL_OK);
    assert_int_equal(pel_wasm_sim_apply(sim, "inflate ball 50"), PEL_OK);
    assert_int_equal(pel_wasm_sim_apply(sim, "set bodies.ball.springs.stiffness 5"), PEL_OK);
    assert_true(holds(pel_wasm_sim_parameters(sim), "\"value\":[5]"));
    assert_int_equal(pel_wasm_sim_step(sim, 5), PEL_OK);
    assert_false(holds(pel_wasm_sim_summary(sim), start));
    assert_int_equal(pel_wasm_sim_undo(sim), 1);
    assert_true(holds(pel_wasm_sim_summary(sim), start));
    assert_int_equal(pel_wasm_sim_step(sim, 2), PEL_OK);
    assert_int_equal(pel_wasm_sim_reset(sim), PEL_OK);
    assert_true(holds(pel_wasm_sim_summary(sim), start));
    assert_int_equal(pel_wasm_sim_apply(sim, "set bodies.ball.springs.stiffness -5"), PEL_BAD_ARGUMENT);
    assert_true(holds(pel_wasm_sim_error(sim), "\"status\":\"bad argument\""));
    assert_true(holds(pel_wasm_sim_error(sim), "stiffness"));
    pel_wasm_sim_destroy(sim);
}

/* a blade from the pole down one side: arrays have the copies, and lose them with undo */
static void test_cut(void **unused)
{
    (void)unused;
    pel_wasm_sim *sim = create(ball);
    assert_int_equal(pel_wasm_sim_apply(sim, "mark"), PEL_OK);
    assert_int_equal(pel_wasm_sim_apply(sim, "cut 0 0.05 3  0 0 -1"), PEL_OK);
    assert_int_equal(pel_wasm_sim_apply(sim, "cut 0.95 0.05 3  0 0 -1"), PEL_OK);
    assert_true(holds(pel_wasm_sim_summary(sim), "\"kind\":\"cut\""));
    assert_int_equal(pel_wasm_sim_apply(sim, "release"), PEL_OK);
    int32_t count = pel_wasm_sim_vertex_count(sim, 0), most = 0;
    assert_true(count > BALL_VERTICES);
    const int32_t *triangles = pel_wasm_sim_triangles(sim, 0);
    for (int32_t c = 0; c < 3 * BALL_TRIANGLES; c++)
        most = triangles[c] > most ? triangles[c] : most;
    assert_int_equal(most, count - 1);
    assert_true(isfinite(pel_wasm_sim_positions(sim, 0)[3 * count - 1]));
    assert_int_equal(pel_wasm_sim_step(sim, 5), PEL_OK);
    /* its two ends, which are no copies and lie on the surface */
    const double *tips = pel_wasm_sim_tips(sim, 0);
    assert_true(tips[0] == 2);
    for (int t = 0; t < 2; t++) {
        const double *tip = tips + 1 + 12 * t;
        assert_true(tip[0] >= 0 && tip[0] < BALL_VERTICES);
        for (int c = 0; c < 3; c++)
            assert_near(tip[1 + c], (double)pel_wasm_sim_positions(sim, 0)[3 * (int32_t)tip[0] + c], 1e-6);
        assert_near(pel_vec3_length(tip + 4), 1, 1e-12);
        assert_near(tip[10], pel_vec3_length(tip + 7), 1e-12);
    }
    assert_null(pel_wasm_sim_tips(sim, 5));
    assert_null(pel_wasm_sim_rigid(sim, 0));
    assert_int_equal(pel_wasm_sim_undo(sim), 1);
    assert_true(pel_wasm_sim_tips(sim, 0)[0] == 0);
    assert_int_equal(pel_wasm_sim_vertex_count(sim, 0), BALL_VERTICES);
    pel_wasm_sim_destroy(sim);
}

/* a weld bears weight and torque of a bar that sticks out by 0.5 m */
static void test_joint(void **unused)
{
    (void)unused;
    pel_wasm_sim *sim =
        create("version: 1\nbodies:\n  - name: bar\n    mesh: { shape: box, size_x: 1, size_y: 0.1, size_z: 0.1 }\n"
               "    rigid: { mass: 2 }\njoints: [{ name: wall, body: bar, kind: weld, point: [-0.5, 0, 0] }]\n"
               "gravity: [0, 0, -10]\nduration: 1\n");
    assert_int_equal(pel_wasm_sim_step(sim, 3), PEL_OK);
    assert_null(pel_wasm_sim_joint(sim, "bar"));
    const double *joint = pel_wasm_sim_joint(sim, "wall");
    assert_non_null(joint);
    assert_near(joint[0], 0, 0);
    assert_near(joint[4], 20, 1e-6);
    assert_near(joint[6], -10, 1e-6); /* about the wall: 0.5 m times 20 N */
    assert_near(joint[9], 0, 0);
    pel_wasm_sim_destroy(sim);
}

/* commands of the scene's session are done at their steps */
static void test_session_of_scene(void **unused)
{
    (void)unused;
    char played[1000], words[1000];
    snprintf(played, sizeof played, "%ssession: [\"0 inflate ball 50\", \"2 inflate ball 0\"]\n", ball);
    pel_wasm_sim *by_hand = create(ball), *by_scene = create(played);
    assert_int_equal(pel_wasm_sim_apply(by_hand, "inflate ball 50"), PEL_OK);
    assert_int_equal(pel_wasm_sim_step(by_hand, 2), PEL_OK);
    assert_int_equal(pel_wasm_sim_apply(by_hand, "inflate ball 0"), PEL_OK);
    assert_int_equal(pel_wasm_sim_step(by_hand, 3), PEL_OK);
    assert_int_equal(pel_wasm_sim_step(by_scene, 5), PEL_OK);
    const char *hash = strstr(pel_wasm_sim_summary(by_hand)->text, "\"hash\"");
    assert_non_null(hash);
    snprintf(words, sizeof words, "%.*s", (int)strcspn(hash, ","), hash);
    assert_true(holds(pel_wasm_sim_summary(by_scene), words));
    pel_wasm_sim_destroy(by_hand);
    pel_wasm_sim_destroy(by_scene);
}

static void test_bad_scenes(void **unused)
{
    (void)unused;
    const struct {
        const char *text, *words;
    } cases[] = {
        {"version: 1\nbodys: []\n", "\"file\":\"scene.yaml\",\"line\":2,\"column\":1}"},
        {"a: [", "this is not YAML"},
        {"version: 1\nbodies: [ { mesh: { file: nothing.ply } } ]\nduration: 1\n", "nothing.ply"},
        {"version: 1\nbodies:\n  - { mesh: { shape: geodesic-sphere }, mass: { total: 1 }, springs: { stiffness: 3e9 } "
         "}\n"
         "solver: { method: explicit, dt: 0.01 }\nduration: 1\n",
         "\"line\":4,\"column\":33}"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pel_wasm_sim *sim = create(cases[i].text);
        assert_int_not_equal(pel_wasm_sim_status(sim), PEL_OK);
        if (!holds(pel_wasm_sim_error(sim), cases[i].words))
            fail_msg("%s", pel_wasm_sim_error(sim)->text);
        pel_wasm_sim_destroy(sim);
        pel_wasm_live *live =
            pel_wasm_live_create("scene.yaml", cases[i].text, (int32_t)strlen(cases[i].text), NULL, 0);
        assert_int_not_equal(pel_wasm_live_status(live), PEL_OK);
        assert_true(holds(pel_wasm_live_error(live), cases[i].words));
        pel_wasm_live_destroy(live);
    }
}

/* takes all messages; returns whether one of them holds the words, and draws frames */
static bool listen(pel_wasm_live *live, const char *words, int *frame_count)
{
    bool found = false;
    for (;;) {
        const pel_wasm_text *message = pel_wasm_live_take(live);
        if (message->size == 0)
            return found;
        char head[20000];
        size_t skip = pel_wasm_live_is_binary(live) ? 4 : 0;
        snprintf(head, sizeof head, "%.*s", (int)(message->size - (int32_t)skip), message->text + skip);
        found |= strstr(head, words) != NULL;
        bool is_frame = strstr(head, "\"type\":\"frame\"") != NULL;
        *frame_count += is_frame;
        if (is_frame)
            pel_wasm_live_line(live, "received");
    }
}

static void test_live(void **unused)
{
    (void)unused;
    int frames = 0;
    pel_wasm_live *live = pel_wasm_live_create("scene.yaml", ball, (int32_t)strlen(ball), NULL, 0);
    assert_int_equal(pel_wasm_live_status(live), PEL_OK);
    assert_true(listen(live, "\"type\":\"hello\"", &frames));
    assert_true(frames == 1);
    /* frames go on while the page receives them */
    for (int step = 1; step <= 8; step++) {
        char words[32];
        snprintf(words, sizeof words, "\"step\":%d,", step);
        pel_wasm_live_line(live, "step");
        bool stepped = false;
        for (int turn = 0; turn < 1000 && !stepped; turn++) {
            double rest = fmax(pel_wasm_live_turn(live), 0);
            assert_true(rest <= 0.1);
            const struct timespec pause = {0, (long)(1e9 * rest)};
            nanosleep(&pause, NULL);
            stepped = listen(live, words, &frames);
        }
        assert_true(stepped);
    }
    assert_true(frames >= 9);
    pel_wasm_live_line(live, "nonsense");
    (void)pel_wasm_live_turn(live);
    assert_true(listen(live, "\"type\":\"notice\"", &frames));
    /* at its pace: playing, the next turn is never later than the next step */
    pel_wasm_live_line(live, "play");
    (void)pel_wasm_live_turn(live);
    assert_true(pel_wasm_live_turn(live) <= 0.01);
    pel_wasm_live_destroy(live);
    pel_wasm_live_destroy(NULL);
}

static pel_status run_sim(const void *text, pel_error *error)
{
    pel_wasm_sim *sim = pel_wasm_sim_create("scene.yaml", text, (int32_t)strlen(text), NULL, 0);
    pel_status status = sim != NULL ? (pel_status)pel_wasm_sim_status(sim) : PEL_OUT_OF_MEMORY;
    if (status == PEL_OK && (pel_wasm_sim_positions(sim, 0) == NULL || pel_wasm_sim_triangles(sim, 0) == NULL ||
                             pel_wasm_sim_hello(sim)->text == NULL || pel_wasm_sim_summary(sim)->text == NULL))
        status = PEL_OUT_OF_MEMORY;
    if (status == PEL_OK && pel_wasm_sim_field(sim, 0, 0) == NULL)
        status = (pel_status)pel_wasm_sim_status(sim);
    if (status == PEL_OK)
        status = (pel_status)pel_wasm_sim_step(sim, 1);
    pel_wasm_sim_destroy(sim);
    return status == PEL_OUT_OF_MEMORY ? pel_fail_memory(error) : status;
}

static pel_status run_live(const void *text, pel_error *error)
{
    pel_wasm_live *live = pel_wasm_live_create("scene.yaml", text, (int32_t)strlen(text), NULL, 0);
    pel_status status = live != NULL ? (pel_status)pel_wasm_live_status(live) : PEL_OUT_OF_MEMORY;
    pel_wasm_live_destroy(live);
    return status == PEL_OUT_OF_MEMORY ? pel_fail_memory(error) : status;
}

static void test_allocations(void **unused)
{
    (void)unused;
    assert_true(for_every_allocation_failure(run_sim, ball) > 50);
    /* a message that memory does not suffice for is left out */
    pel_error error;
    for (long n = 1;; n++) {
        failing_malloc_begin(n);
        pel_status status = run_live(ball, &error);
        allocation_count count = failing_malloc_end();
        assert_true(status == PEL_OK || status == PEL_OUT_OF_MEMORY);
        assert_int_equal(count.live, 0);
        if (count.failed == 0)
            break;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_steps),      cmocka_unit_test(test_arrays),
        cmocka_unit_test(test_queries),    cmocka_unit_test(test_refined),
        cmocka_unit_test(test_notes),      cmocka_unit_test(test_undo),
        cmocka_unit_test(test_cut),        cmocka_unit_test(test_session_of_scene),
        cmocka_unit_test(test_bad_scenes), cmocka_unit_test(test_live),
        cmocka_unit_test(test_joint),      cmocka_unit_test(test_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
