/* The fingerprint: a change of any byte of a member of a def, or of its array, changes the hash of its part, and no
   other. */
#include "check.h"

#include "def/fingerprint.h"
#include "sequence/sequence.h"

#include <stdlib.h>

/* a def with everything in it; addresses are taken of the members, so it lies still */
typedef struct all_defs {
    double positions[4][3];
    int32_t triangles[2][3], vertices[3];
    pel_mesh mesh;
    pel_sequence sequence; /* of which only its own fingerprint counts */
    double field[4];
    pel_key keys[2];
    pel_pose_key poses[2];
    pel_anisotropy_def anisotropies[2];
    pel_body_def bodies[2];
    pel_load_def loads[2];
    pel_tool_def tools[2];
    pel_support_def supports[2];
    pel_cut_def cuts[2];
    pel_tie_def ties[2];
    pel_joint_def joints[2];
    pel_seam_def seams[2];
    pel_model_def model;
    pel_sim_def sim;
} all_defs;

static void fill_quantity(all_defs *all, pel_quantity *quantity)
{
    *quantity = (pel_quantity){.value = 1, .field = all->field, .keys = all->keys, .key_count = 2};
}

static void fill_body(all_defs *all, pel_body_def *body)
{
    pel_shell_def *shell = &body->shell;
    pel_quantity *const quantities[] = {
        &body->thickness,          &body->spring_stiffness, &body->spring_damping,      &body->volumetric_stiffness,
        &body->volumetric_damping, &shell->membrane.young,  &shell->membrane.thickness, &shell->bending.stiffness,
        &shell->pressure.outside,  &shell->pressure.target, &shell->membrane.toughness, &body->spring_toughness,
        &shell->membrane.strength, &body->spring_strength,  &body->volume.young,        &shell->membrane.rest_scale};
    *body = pel_body_def_default();
    for (size_t i = 0; i < sizeof quantities / sizeof *quantities; i++)
        fill_quantity(all, quantities[i]);
    body->mesh = body->rest = &all->mesh;
    body->pinned = body->refine.region = body->origins = all->vertices;
    body->pinned_count = body->refine.region_count = body->origin_count = 3;
    shell->anisotropies = all->anisotropies;
    shell->anisotropy_count = 2;
    shell->membrane.rest_keys = all->keys;
    shell->membrane.rest_key_count = 2;
    shell->pressure.weights = shell->membrane.coordinate = all->field;
}

static all_defs *make_defs(void)
{
    all_defs *all = calloc(1, sizeof *all);
    assert_non_null(all);
    all->mesh = (pel_mesh){4, 2, 0, all->positions, all->triangles, NULL, 0, NULL};
    for (int i = 0; i < 2; i++) {
        all->anisotropies[i] = pel_anisotropy_def_default();
        fill_quantity(all, &all->anisotropies[i].rest_length);
        fill_quantity(all, &all->anisotropies[i].activation);
        all->anisotropies[i].weights = all->field;
        fill_body(all, &all->bodies[i]);
        all->loads[i] = pel_load_def_default();
        all->loads[i].vertices = all->vertices;
        all->loads[i].vertex_count = 3;
        all->loads[i].keys = all->keys;
        all->loads[i].key_count = 2;
        all->tools[i] = pel_tool_def_default();
        all->tools[i].mesh = &all->mesh;
        all->tools[i].sequence = &all->sequence;
        all->tools[i].keys = all->poses;
        all->tools[i].key_count = 2;
        all->tools[i].closing = all->keys;
        all->tools[i].closing_count = 2;
        all->tools[i].vertices = all->vertices;
        all->tools[i].vertex_count = 3;
        all->supports[i] = pel_support_def_default();
        all->supports[i].vertices = all->vertices;
        all->supports[i].vertex_count = 3;
        all->supports[i].keys = all->keys;
        all->supports[i].key_count = 2;
    }
    for (int i = 0; i < 2; i++) {
        all->cuts[i] = (pel_cut_def){.vertices = all->vertices, .vertex_count = 3};
        all->ties[i] = pel_tie_def_default();
        all->ties[i].vertices = all->ties[i].to_vertices = all->vertices;
        all->ties[i].vertex_count = 3;
        all->ties[i].sequence = &all->sequence;
        all->joints[i] = pel_joint_def_default();
        all->seams[i] = (pel_seam_def){
            .path = all->vertices, .path_count = 3, .vertices = all->vertices, .vertex_count = 3, .strength = 5};
    }
    all->model = pel_model_def_default();
    all->model.bodies = all->bodies;
    all->model.body_count = 2;
    all->sim = pel_sim_def_default();
    all->sim.joints = all->joints;
    all->sim.joint_count = 2;
    all->sim.loads = all->loads;
    all->sim.load_count = 2;
    all->sim.tools = all->tools;
    all->sim.tool_count = 2;
    all->sim.supports = all->supports;
    all->sim.support_count = 2;
    all->sim.ties = all->ties;
    all->sim.tie_count = 2;
    all->sim.cuts = all->cuts;
    all->sim.cut_count = 2;
    all->sim.seams = all->seams;
    all->sim.seam_count = 2;
    all->sim.wind.keys = all->keys;
    all->sim.wind.key_count = 2;
    return all;
}

static pel_fingerprint fingerprint_of(const all_defs *all)
{
    pel_fingerprint made = {{0}};
    pel_fingerprint_add(&made, PEL_DEF_MODEL, &all->model);
    pel_fingerprint_add(&made, PEL_DEF_SIM, &all->sim);
    return made;
}

typedef struct walk {
    all_defs *all;
    pel_fingerprint before;
    long changes;
} walk;

/* the fingerprint differs in this part, and in others where the arrays of this test are shared */
static void check_seen(walk *w, pel_part part, bool is_shared)
{
    pel_fingerprint now = fingerprint_of(w->all);
    for (int p = 0; p < PEL_PART_COUNT; p++)
        if (p == (int)part || !is_shared)
            assert_true((now.parts[p] != w->before.parts[p]) == (p == (int)part));
    w->changes++;
}

static void change_bytes(walk *w, pel_part part, void *data, size_t size, bool is_shared)
{
    unsigned char *bytes = data;
    for (size_t i = 0; i < size; i++) {
        unsigned char bit = (unsigned char)(1 << i % 8);
        bytes[i] ^= bit;
        check_seen(w, part, is_shared);
        bytes[i] ^= bit;
    }
    /* signs of two numbers together */
    for (size_t i = 15; i < size; i += 8) {
        bytes[i] ^= 0x80;
        bytes[i - 8] ^= 0x80;
        check_seen(w, part, is_shared);
        bytes[i] ^= 0x80;
        bytes[i - 8] ^= 0x80;
    }
}

static void change_members(walk *w, pel_def_kind kind, char *def);

/* a pointer becomes null; nothing else can be without a mesh */
static char *change_pointer(walk *w, pel_part part, void *at, bool is_shared)
{
    char *pointer, *none = NULL;
    memcpy(&pointer, at, sizeof pointer);
    assert_non_null(pointer);
    memcpy(at, &none, sizeof none);
    if (part != PEL_PART_MESH || is_shared)
        check_seen(w, part, is_shared);
    memcpy(at, &pointer, sizeof pointer);
    return pointer;
}

static void change_list(walk *w, pel_part part, void *at, int32_t *count, size_t size)
{
    char *list = change_pointer(w, part, at, false);
    --*count;
    check_seen(w, part, true);
    ++*count;
    change_bytes(w, part, list, (size_t)*count * size, true);
}

static void change_quantity(walk *w, pel_part part, pel_quantity *quantity)
{
    change_bytes(w, part, &quantity->value, sizeof quantity->value, false);
    change_bytes(w, part, change_pointer(w, part, &quantity->field, false), sizeof w->all->field, true);
    change_list(w, part, &quantity->keys, &quantity->key_count, sizeof(pel_key));
}

static void change_defs(walk *w, const pel_def_row *row, char *def)
{
    char *defs = change_pointer(w, row->part, def + row->offset, true);
    int32_t *count = (int32_t *)(void *)(def + row->count_offset);
    --*count;
    check_seen(w, row->part, true);
    ++*count;
    for (int32_t i = 0; i < *count; i++)
        change_members(w, row->element, defs + (size_t)i * row->size);
}

static void change_member(walk *w, const pel_def_row *row, char *def)
{
    void *at = def + row->offset;
    switch (row->store) {
    case PEL_STORE_QUANTITY:
        change_quantity(w, row->part, at);
        break;
    case PEL_STORE_KEYS:
    case PEL_STORE_LIST:
        change_list(w, row->part, at, (int32_t *)(void *)(def + row->count_offset), row->size);
        break;
    case PEL_STORE_FIELD:
        change_bytes(w, row->part, change_pointer(w, row->part, at, false), sizeof w->all->field, true);
        break;
    case PEL_STORE_MESH:
        change_pointer(w, row->part, at, false);
        change_bytes(w, row->part, w->all->positions, sizeof w->all->positions, true);
        change_bytes(w, row->part, w->all->triangles, sizeof w->all->triangles, true);
        break;
    case PEL_STORE_SEQUENCE:
        change_pointer(w, row->part, at, false);
        change_bytes(w, row->part, &w->all->sequence.fingerprint, sizeof w->all->sequence.fingerprint, true);
        break;
    case PEL_STORE_DEF:
        change_members(w, row->element, at);
        break;
    case PEL_STORE_DEFS:
        change_defs(w, row, def);
        break;
    default:
        change_bytes(w, row->part, at, row->size, false);
    }
}

static void change_members(walk *w, pel_def_kind kind, char *def)
{
    const pel_def_row *members[PEL_MOST_MEMBERS];
    int32_t count = pel_def_members(kind, members);
    for (int32_t i = 0; i < count; i++)
        if (members[i]->part != PEL_PART_NONE)
            change_member(w, members[i], def);
}

static void test_every_member(void **unused)
{
    (void)unused;
    all_defs *all = make_defs();
    walk w = {.all = all, .before = fingerprint_of(all)};
    change_members(&w, PEL_DEF_MODEL, (char *)&all->model);
    change_members(&w, PEL_DEF_SIM, (char *)&all->sim);
    assert_true(w.changes > 3000);
    pel_fingerprint after = fingerprint_of(all);
    assert_memory_equal(&after, &w.before, sizeof after);
    free(all);
}

/* the fingerprint does not look at names, threads and where things lie in memory */
static void test_same(void **unused)
{
    (void)unused;
    all_defs *a = make_defs(), *b = make_defs();
    char text[400];
    b->bodies[0].name = "another";
    b->tools[1].name = "another";
    b->sim.thread_count = 7;
    pel_fingerprint first = fingerprint_of(a), second = fingerprint_of(b);
    assert_memory_equal(&first, &second, sizeof first);
    assert_string_equal(pel_fingerprint_compare(&first, &second, text, sizeof text), "");
    free(a);
    free(b);
}

static void test_names(void **unused)
{
    (void)unused;
    all_defs *all = make_defs();
    char text[400], cut[12];
    pel_fingerprint before = fingerprint_of(all);
    all->model.gravity[2] = -9.81;
    all->sim.solver.dt = 0.5;
    all->bodies[1].friction = 0.5;
    pel_fingerprint after = fingerprint_of(all);
    assert_string_equal(pel_fingerprint_compare(&before, &after, text, sizeof text),
                        "gravity, contact of a body, solver");
    assert_string_equal(pel_fingerprint_compare(&before, &after, cut, sizeof cut), "gravity, co");
    free(all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_member),
        cmocka_unit_test(test_same),
        cmocka_unit_test(test_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
