/* The fingerprint: a change of any byte of a member of a def, or of its array, changes the hash of its part, and no
   other. */
#include "check.h"

#include "model/fingerprint.h"
#include "pellicle/sim_step.h"

#include <stdlib.h>

/* a def with everything in it; addresses are taken of the members, so it lies still */
typedef struct all_defs {
    double positions[4][3];
    int32_t triangles[2][3], vertices[3];
    pel_mesh mesh;
    double field[4];
    pel_key keys[2];
    pel_pose_key poses[2];
    pel_anisotropy_def anisotropies[2];
    pel_body_def bodies[2];
    pel_load_def loads[2];
    pel_tool_def tools[2];
    pel_support_def supports[2];
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
        &shell->pressure.outside,  &shell->pressure.target};
    *body = pel_body_def_default();
    for (size_t i = 0; i < sizeof quantities / sizeof *quantities; i++)
        fill_quantity(all, quantities[i]);
    body->mesh = &all->mesh;
    body->pinned = body->refine.region = all->vertices;
    body->pinned_count = body->refine.region_count = 3;
    shell->anisotropies = all->anisotropies;
    shell->anisotropy_count = 2;
    shell->pressure.weights = all->field;
}

static all_defs *make_defs(void)
{
    all_defs *all = calloc(1, sizeof *all);
    assert_non_null(all);
    all->mesh = (pel_mesh){4, 2, 0, all->positions, all->triangles, NULL};
    for (int i = 0; i < 2; i++) {
        all->anisotropies[i] = pel_anisotropy_def_default();
        fill_quantity(all, &all->anisotropies[i].rest_length);
        all->anisotropies[i].weights = all->field;
        fill_body(all, &all->bodies[i]);
        all->loads[i] = pel_load_def_default();
        all->loads[i].vertices = all->vertices;
        all->loads[i].vertex_count = 3;
        all->loads[i].keys = all->keys;
        all->loads[i].key_count = 2;
        all->tools[i] = pel_tool_def_default();
        all->tools[i].mesh = &all->mesh;
        all->tools[i].keys = all->poses;
        all->tools[i].key_count = 2;
        all->tools[i].vertices = all->vertices;
        all->tools[i].vertex_count = 3;
        all->supports[i] = pel_support_def_default();
        all->supports[i].vertices = all->vertices;
        all->supports[i].vertex_count = 3;
        all->supports[i].keys = all->keys;
        all->supports[i].key_count = 2;
    }
    all->model = pel_model_def_default();
    all->model.bodies = all->bodies;
    all->model.body_count = 2;
    all->sim = pel_sim_def_default();
    all->sim.loads = all->loads;
    all->sim.load_count = 2;
    all->sim.tools = all->tools;
    all->sim.tool_count = 2;
    all->sim.supports = all->supports;
    all->sim.support_count = 2;
    return all;
}

static pel_fingerprint fingerprint_of(const all_defs *all)
{
    pel_fingerprint made = {{0}};
    pel_fingerprint_add(&made, pel_model_members, &all->model);
    pel_fingerprint_add(&made, pel_sim_members, &all->sim);
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

static void change_members(walk *w, const pel_member *members, char *def, pel_part outer);

static void change_behind(walk *w, const pel_member *member, char *def, pel_part part)
{
    char *pointer, *none = NULL;
    int32_t count = 0, fewer;
    memcpy(&pointer, def + member->offset, sizeof pointer);
    assert_non_null(pointer);
    memcpy(def + member->offset, &none, sizeof none);
    /* nothing else can be without a mesh */
    if (member->form != PEL_MEMBER_MESH || part != PEL_PART_MESH)
        check_seen(w, part, member->members != NULL);
    memcpy(def + member->offset, &pointer, sizeof pointer);
    if (member->form == PEL_MEMBER_LIST) {
        memcpy(&count, def + member->count_offset, sizeof count);
        fewer = count - 1;
        memcpy(def + member->count_offset, &fewer, sizeof fewer);
        check_seen(w, part, true);
        memcpy(def + member->count_offset, &count, sizeof count);
    }
    if (member->form == PEL_MEMBER_MESH) {
        change_bytes(w, part, w->all->positions, sizeof w->all->positions, true);
        change_bytes(w, part, w->all->triangles, sizeof w->all->triangles, true);
    } else if (member->form == PEL_MEMBER_FIELD) {
        change_bytes(w, part, pointer, sizeof w->all->field, true);
    } else if (member->members == NULL) {
        change_bytes(w, part, pointer, (size_t)count * member->size, true);
    }
    for (int32_t i = 0; member->members != NULL && i < count; i++)
        change_members(w, member->members, pointer + (size_t)i * member->size, part);
}

static void change_members(walk *w, const pel_member *members, char *def, pel_part outer)
{
    for (const pel_member *member = members; member->form != PEL_MEMBER_END; member++) {
        pel_part part = member->part == PEL_PART_SAME ? outer : member->part;
        if (member->form == PEL_MEMBER_PLAIN)
            change_bytes(w, part, def + member->offset, member->size, false);
        else if (member->form == PEL_MEMBER_DEF)
            change_members(w, member->members, def + member->offset, part);
        else if (member->form != PEL_MEMBER_OTHER && member->form != PEL_MEMBER_TEXT)
            change_behind(w, member, def, part);
    }
}

static void test_every_member(void **unused)
{
    (void)unused;
    all_defs *all = make_defs();
    walk w = {.all = all, .before = fingerprint_of(all)};
    change_members(&w, pel_model_members, (char *)&all->model, PEL_PART_COUNT);
    change_members(&w, pel_sim_members, (char *)&all->sim, PEL_PART_COUNT);
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
