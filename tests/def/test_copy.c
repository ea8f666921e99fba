/* Deep copies of defs: the copy has the fingerprint of the original, and keeps it when the original is freed. */
#include "check.h"
#include "def/copy.h"
#include "def/fingerprint.h"
#include "failing_malloc.h"

#include <stdlib.h>

typedef struct original {
    pel_mesh mesh;
    double positions[3][3], field[3], weights[3];
    int32_t triangles[1][3], pinned[2];
    pel_key keys[2];
    char name[8];
    pel_anisotropy_def fibres[2];
    pel_body_def body;
    pel_model_def model;
} original;

static original *make_original(void)
{
    original *o = calloc(1, sizeof *o);
    assert_non_null(o);
    o->mesh = (pel_mesh){.vertex_count = 3, .triangle_count = 1, .positions = o->positions, .triangles = o->triangles};
    for (int i = 0; i < 3; i++)
        o->field[i] = o->weights[i] = 1 + i;
    o->keys[1] = (pel_key){1, 2};
    o->pinned[1] = 2;
    snprintf(o->name, sizeof o->name, "ball");
    o->body = pel_body_def_default();
    o->body.name = o->name;
    o->body.mesh = &o->mesh;
    o->body.pinned = o->pinned;
    o->body.pinned_count = 2;
    o->body.spring_stiffness.field = o->field;
    o->body.spring_damping = (pel_quantity){.keys = o->keys, .key_count = 2};
    o->fibres[0] = o->fibres[1] = pel_anisotropy_def_default();
    o->fibres[1].weights = o->weights;
    o->body.shell.anisotropies = o->fibres;
    o->body.shell.anisotropy_count = 2;
    o->model = pel_model_def_default();
    o->model.bodies = &o->body;
    o->model.body_count = 1;
    return o;
}

static pel_fingerprint fingerprint_of(const pel_model_def *def)
{
    pel_fingerprint made = {{0}};
    pel_fingerprint_add(&made, PEL_DEF_MODEL, def);
    return made;
}

static void test_stands_alone(void **unused)
{
    (void)unused;
    original *o = make_original();
    pel_copies copies = {NULL};
    pel_model_def copy = o->model;
    pel_fingerprint before = fingerprint_of(&o->model);
    assert_int_equal(pel_def_copy(&copies, PEL_DEF_MODEL, &copy, NULL), PEL_OK);
    assert_ptr_not_equal(copy.bodies, o->model.bodies);
    assert_ptr_equal(copy.bodies->mesh, &o->mesh);
    /* the original changes: all but its mesh */
    memset(o->field, 7, sizeof o->field);
    memset(o->weights, 7, sizeof o->weights);
    memset(o->keys, 7, sizeof o->keys);
    memset(o->pinned, 7, sizeof o->pinned);
    memset(o->name, 7, sizeof o->name);
    memset(o->fibres, 0, sizeof o->fibres);
    o->body.mass = 99;
    pel_fingerprint after = fingerprint_of(&copy);
    assert_memory_equal(&before, &after, sizeof after);
    assert_string_equal(copy.bodies->name, "ball");
    pel_copies_free(&copies);
    assert_null(copies.first);
    free(o);
}

static pel_status copy_once(const void *data, pel_error *error)
{
    pel_copies copies = {NULL};
    pel_model_def copy = *(const pel_model_def *)data;
    pel_status status = pel_def_copy(&copies, PEL_DEF_MODEL, &copy, error);
    pel_copies_free(&copies);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    original *o = make_original();
    assert_true(for_every_allocation_failure(copy_once, &o->model) > 6);
    free(o);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stands_alone),
        cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
