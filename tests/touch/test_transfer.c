/* What contact keeps from step to step is in snapshots: a run that goes on from one has the bits of a run that was
   never saved, whatever the loading simulation had in contact before. */
#include "failing_malloc.h"
#include "pellicle/live.h"
#include "sim/contact_scene.h"
#include "sim/snapshot.h"
#include "tool/solid.h"
#include "tool/tool.h"
#include "touch/contact.h"

typedef struct press_kind {
    const char *name;
    pel_method method;
    pel_tool_shape shape; /* of the tool that presses */
    bool is_held_back;    /* there is no way for it to its end */
    int32_t body_count;
    double friction;
} press_kind;

static const press_kind kinds[] = {
    {"sphere", PEL_METHOD_XPBD, PEL_TOOL_SPHERE, false, 1, 0},
    {"box, friction", PEL_METHOD_XPBD, PEL_TOOL_BOX, false, 1, 0.4},
    {"mesh, friction", PEL_METHOD_XPBD, PEL_TOOL_MESH, false, 1, 0.4},
    {"layers", PEL_METHOD_XPBD, PEL_TOOL_BOX, false, 2, 0.3},
    {"held back", PEL_METHOD_XPBD, PEL_TOOL_SPHERE, true, 1, 0},
    {"layers, pbd", PEL_METHOD_PBD, PEL_TOOL_SPHERE, false, 2, 0.3},
    {"layers, pbd-distance", PEL_METHOD_PBD_DISTANCE, PEL_TOOL_BOX, false, 2, 0},
};
enum { KIND_COUNT = sizeof kinds / sizeof *kinds, LAYERS = 3, PRESSED = 14, MORE = 20 };

/* a ball, in a second one or alone, over a box, and a tool that presses from above */
static pel_sim *begin(contact_scene *scene, const press_kind *kind)
{
    scene_begin(scene, kind->method);
    double top = kind->body_count == 1 ? 1 : 1.02, way = kind->is_held_back ? 2 : 0.3;
    scene_body(scene, make_sphere(kind->body_count == 2 ? 3 : 4));
    if (kind->body_count == 2)
        scene_body(scene, make_sphere(4));
    for (int32_t v = 0; kind->body_count == 2 && v < scene->meshes[1]->vertex_count; v++)
        pel_vec3_scale(scene->meshes[1]->positions[v], 1.02, scene->meshes[1]->positions[v]);
    /* they are drawn home, so that what presses them has to go on */
    for (int32_t b = 0; b < kind->body_count; b++)
        scene->bodies[b].volumetric_stiffness.value = 5;
    scene->def.solver.drag = 30;
    scene->def.contact.friction = kind->friction;
    scene->def.solver.substeps = 4;
    pel_tool_def *upper = scene_tool(scene, kind->shape);
    upper->radius = 0.4;
    upper->half_extents[0] = upper->half_extents[1] = upper->half_extents[2] = 0.4;
    if (kind->shape == PEL_TOOL_MESH) {
        scene->tool_mesh = make_sphere(2);
        for (int32_t v = 0; v < scene->tool_mesh->vertex_count; v++)
            pel_vec3_scale(scene->tool_mesh->positions[v], 0.4, scene->tool_mesh->positions[v]);
        upper->mesh = scene->tool_mesh;
    }
    scene_move(scene, 0, 0, 0, top + 0.42, top + 0.42 - way, 0.2);
    scene->keys[0][2] = (pel_pose_key){0.5, {0.2, 0, top + 0.42 - way}, {0, 0, 0, 1}, {0}};
    scene->tools[0].key_count = 3;
    pel_tool_def *lower = scene_tool(scene, PEL_TOOL_BOX);
    lower->half_extents[0] = lower->half_extents[1] = lower->half_extents[2] = 0.5;
    scene_move(scene, 1, 0, 0, -1.54, -1.54, 1);
    return scene_create(scene);
}

typedef struct bytes {
    unsigned char *at;
    size_t size;
} bytes;

static bytes save(const pel_sim *sim)
{
    bytes saved = {.size = pel_sim_save_size(sim)};
    saved.at = malloc(saved.size);
    assert_non_null(saved.at);
    pel_sim_save(sim, saved.at);
    return saved;
}

/* pairs of surfaces that carry a load */
static int32_t count_layers(const pel_sim *sim)
{
    int32_t count = 0;
    for (int32_t c = 0; c < sim->contacts->list.count; c++)
        count += sim->contacts->keys[c].load > 0;
    return count;
}

/* those of tools */
static int32_t count_solids(const pel_sim *sim)
{
    int32_t count = 0;
    const pel_sim_solids *solids = sim->tools->solids;
    for (int32_t c = 0; c < solids->list.count; c++)
        count += solids->pairs[c].load > 0;
    return count;
}

static void test_goes_on(void **unused)
{
    (void)unused;
    for (int k = 0; k < KIND_COUNT; k++) {
        contact_scene scene;
        print_message("%s\n", kinds[k].name);
        pel_sim *sim = begin(&scene, &kinds[k]);
        run_steps(sim, PRESSED);
        assert_true(count_solids(sim) > 0 || kinds[k].shape == PEL_TOOL_MESH);
        assert_true(count_layers(sim) > 0 || (kinds[k].shape != PEL_TOOL_MESH && kinds[k].body_count == 1));
        for (int i = 0; kinds[k].is_held_back && !sim->tools->items[0].is_held_back; i++) {
            assert_true(i < 100);
            run_steps(sim, 1);
        }
        bytes saved = save(sim);
        run_steps(sim, MORE);
        /* one that is fresh, and one that has pressed further */
        for (int32_t threads = 1; threads <= 2; threads++) {
            scene.def.thread_count = threads;
            pel_sim *other = make_sim(&scene.def);
            run_steps(other, threads == 1 ? 0 : PRESSED + 5);
            assert_int_equal(pel_sim_load(other, saved.at, saved.size, NULL), PEL_OK);
            assert_int_equal(pel_sim_save_size(other), saved.size);
            run_steps(other, MORE);
            assert_true(pel_sim_hash(other) == pel_sim_hash(sim));
            assert_int_equal(pel_sim_save_size(other), pel_sim_save_size(sim));
            pel_sim_destroy(other);
        }
        free(saved.at);
        scene_end(&scene, sim);
    }
}

/* any state can be loaded where another one is larger or smaller */
static void test_size(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = begin(&scene, &kinds[LAYERS]);
    bytes small = save(sim);
    run_steps(sim, PRESSED);
    bytes large = save(sim);
    uint64_t hash = pel_sim_hash(sim);
    assert_true(large.size > small.size);
    assert_int_equal(pel_sim_load(sim, small.at, small.size, NULL), PEL_OK);
    assert_int_equal(pel_sim_save_size(sim), small.size);
    assert_int_equal(pel_sim_load(sim, large.at, large.size, NULL), PEL_OK);
    assert_int_equal(pel_sim_save_size(sim), large.size);
    assert_int_equal(pel_sim_load(sim, small.at, small.size, NULL), PEL_OK);
    run_steps(sim, PRESSED);
    assert_true(pel_sim_hash(sim) == hash);
    free(small.at);
    free(large.at);
    scene_end(&scene, sim);
}

/* ---- damage ---- */

static void check_forged(pel_sim *sim, const bytes *good, size_t at, const void *word, size_t size)
{
    pel_error error;
    unsigned char *bad = malloc(good->size);
    memcpy(bad, good->at, good->size);
    memcpy(bad + at, word, size);
    pel_snapshot_seal(bad, good->size);
    assert_int_equal(pel_sim_load(sim, bad, good->size, &error), PEL_BAD_FORMAT);
    assert_non_null(strstr(error.what, "damaged"));
    (void)pel_sim_step(sim, NULL);
    free(bad);
}

/* counts beyond the end, pairs out of order, and numbers out of range are refused */
static void test_forged_lists(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = begin(&scene, &kinds[LAYERS]);
    run_steps(sim, PRESSED);
    bytes good = save(sim);
    size_t lists = good.size - pel_snapshot_lists_size(sim);
    /* tangles: whether they are known, their count; layers: margin, horizon, whether the margin was widened and the
       pairs serve on, count, then the first */
    size_t margin = lists + 1 + 8, horizon = margin + 8, count = horizon + 8 + 2, first = count + 8;
    const int64_t counts[] = {-1, 1 << 20, INT64_MAX, INT64_MIN};
    for (int i = 0; i < 4; i++) {
        check_forged(sim, &good, lists + 1, &counts[i], 8);
        check_forged(sim, &good, count, &counts[i], 8);
    }
    const double margins[] = {0, -1, 1e9, (double)NAN};
    for (int i = 0; i < 4; i++)
        check_forged(sim, &good, margin, &margins[i], 8);
    for (int i = 0; i < 4; i++)
        check_forged(sim, &good, horizon, &margins[i], 8);
    const int32_t last = INT32_MAX;
    check_forged(sim, &good, first, &last, 4);
    /* the last pair of a tool: tool, triangle, vertex, -, slack, load, earlier, approach, drag */
    size_t pair = good.size - 16 - 7 * 8;
    const int32_t tools[] = {-1, 2, INT32_MAX};
    for (int i = 0; i < 3; i++)
        check_forged(sim, &good, pair, &tools[i], 4);
    for (int i = 0; i < 3; i++)
        check_forged(sim, &good, pair + 4, &last, 4);
    const double nan = (double)NAN;
    for (size_t i = 0; i < 7; i++)
        check_forged(sim, &good, pair + 16 + 8 * i, &nan, 8);
    /* any word */
    const uint32_t words[3] = {UINT32_MAX, INT32_MAX, 0x01010101};
    unsigned char *bad = malloc(good.size);
    for (size_t at = lists; at + 4 <= good.size; at += ROUNDS(36, 180)) {
        memcpy(bad, good.at, good.size);
        memcpy(bad + at, &words[at % 3], 4);
        pel_snapshot_seal(bad, good.size);
        (void)pel_sim_load(sim, bad, good.size, NULL);
    }
    free(bad);
    assert_int_equal(pel_sim_load(sim, good.at, good.size, NULL), PEL_OK);
    run_steps(sim, 2);
    free(good.at);
    scene_end(&scene, sim);
}

/* a load that finds no memory says so, and the next one works */
static void test_memory_runs_out(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = begin(&scene, &kinds[LAYERS]);
    run_steps(sim, PRESSED);
    bytes saved = save(sim);
    run_steps(sim, 1);
    pel_sim *other = make_sim(&scene.def);
    pel_status status = PEL_OUT_OF_MEMORY;
    long n = 1;
    for (; status != PEL_OK; n++) {
        failing_malloc_begin(n);
        status = pel_sim_load(other, saved.at, saved.size, NULL);
        failing_malloc_end();
        assert_true(status == PEL_OK || status == PEL_OUT_OF_MEMORY);
        assert_true(n < 1000);
    }
    assert_true(n > 2);
    run_steps(other, 1);
    assert_true(pel_sim_hash(other) == pel_sim_hash(sim));
    pel_sim_destroy(other);
    free(saved.at);
    scene_end(&scene, sim);
}

/* ---- where loads stay and where they do not ---- */

static bool goes_on(void *user)
{
    (void)user;
    return true;
}

/* long steps keep the state before them: in room that is there after some steps */
static void test_steps_allocate_nothing(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *first = begin(&scene, &kinds[LAYERS]);
    pel_sim_destroy(first);
    scene.def.solver.substeps = 32;
    scene.def.wanted = goes_on;
    scene.keys[0][2].position[0] = 0;
    pel_sim *sim = make_sim(&scene.def);
    run_steps(sim, 80);
    failing_malloc_begin(0);
    run_steps(sim, 5);
    assert_int_equal(failing_malloc_end().calls, 0);
    scene_end(&scene, sim);
}

/* other numbers leave what presses under its load: with the old ones again, everything is as it was */
static void test_change(void **unused)
{
    (void)unused;
    for (int k = 0; k <= LAYERS; k++) {
        contact_scene scene;
        pel_sim *sim = begin(&scene, &kinds[k]);
        run_steps(sim, PRESSED);
        bytes saved = save(sim);
        int32_t layers = count_layers(sim), solids = count_solids(sim);
        const double dampings[] = {0.06, 0.05};
        for (int i = 0; i < 2; i++)
            assert_int_equal(pel_set_parameter(sim, "bodies.first.springs.damping", dampings[i], NULL), PEL_OK);
        assert_int_equal(count_layers(sim), layers);
        assert_int_equal(count_solids(sim), solids);
        run_steps(sim, MORE);
        pel_sim *other = make_sim(&scene.def);
        assert_int_equal(pel_sim_load(other, saved.at, saved.size, NULL), PEL_OK);
        run_steps(other, MORE);
        assert_true(pel_sim_hash(other) == pel_sim_hash(sim));
        pel_sim_destroy(other);
        free(saved.at);
        scene_end(&scene, sim);
    }
}

/* features of another surface have other numbers: loads of pairs are not taken for those of others */
static void check_refinement(bool is_changed)
{
    contact_scene scene;
    pel_sim *plain = begin(&scene, &kinds[LAYERS]);
    pel_sim_destroy(plain);
    pel_model_destroy(scene.model);
    scene.bodies[0].refine.levels = 1;
    pel_sim *sim = scene_create(&scene);
    run_steps(sim, PRESSED);
    if (is_changed)
        assert_int_equal(pel_set_parameter(sim, "bodies.first.springs.damping", 0.06, NULL), PEL_OK);
    assert_true(count_layers(sim) > 0);
    assert_int_equal(pel_sim_refine(sim, 0, nearest_vertex(scene.meshes[0], 0, 0, 1), 1, NULL), PEL_OK);
    assert_int_equal(sim->contacts->list.count, 0);
    /* tools name vertices and triangles, which stay */
    assert_true(count_solids(sim) > 0);
    bytes saved = save(sim);
    run_steps(sim, MORE);
    uint64_t hash = pel_sim_hash(sim);
    assert_int_equal(pel_sim_load(sim, saved.at, saved.size, NULL), PEL_OK);
    run_steps(sim, MORE);
    assert_true(pel_sim_hash(sim) == hash);
    free(saved.at);
    scene_end(&scene, sim);
}

static void test_refinement(void **unused)
{
    (void)unused;
    check_refinement(false);
    check_refinement(true);
}

/* pairs of triangles that intersect from the start on are known at once */
static void test_tangles(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_QUASI_STATIC);
    scene_body(&scene, make_sphere(4));
    scene_body(&scene, make_moved_sphere(4, 1.9, 0.1, 0.05));
    scene.def.contact.allow_tangled = true;
    pel_sim *sim = scene_create(&scene);
    run_steps(sim, 3);
    const pel_tangles *tangles = &sim->contacts->tangles;
    assert_true(tangles->is_known && tangles->count > 0);
    bytes saved = save(sim);
    scene.def.contact.allow_tangled = true;
    pel_sim *other = make_sim(&scene.def);
    assert_int_equal(pel_sim_load(other, saved.at, saved.size, NULL), PEL_OK);
    const pel_tangles *loaded = &other->contacts->tangles;
    assert_true(loaded->is_known);
    assert_int_equal(loaded->count, tangles->count);
    assert_memory_equal(loaded->pairs, tangles->pairs, (size_t)tangles->count * sizeof *tangles->pairs);
    run_steps(sim, 2);
    run_steps(other, 2);
    assert_true(pel_sim_hash(other) == pel_sim_hash(sim));
    /* pairs of triangles that are not there are searched anew */
    const int32_t none = INT32_MAX;
    memcpy(saved.at + saved.size - 4, &none, 4);
    pel_snapshot_seal(saved.at, saved.size);
    assert_int_equal(pel_sim_load(other, saved.at, saved.size, NULL), PEL_OK);
    run_steps(other, 2);
    assert_true(pel_sim_hash(other) == pel_sim_hash(sim));
    pel_sim_destroy(other);
    free(saved.at);
    scene_end(&scene, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_goes_on),      cmocka_unit_test(test_size),
        cmocka_unit_test(test_forged_lists), cmocka_unit_test(test_memory_runs_out),
        cmocka_unit_test(test_change),       cmocka_unit_test(test_steps_allocate_nothing),
        cmocka_unit_test(test_refinement),   cmocka_unit_test(test_tangles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
