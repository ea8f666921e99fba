/* Which contacts of rigid bodies the sweeps keep. */
#include "../rigid/rigid_scene.h"
#include "contact/set.h"
#include "stage/stage.h"
#include "sweep/patch.h"

enum { SIDE = 5, COUNT = SIDE * SIDE };

/* a face of 5 x 5 vertices of a rigid body over an obstacle, tilted a little, and a vertex that is loose */
typedef struct face {
    pel_record positions[2 * PEL_WIDTH * COUNT];
    pel_contact contacts[COUNT + 1];
    int32_t of_slice[2 * COUNT], active[COUNT + 1];
    pel_rigids rigids;
    pel_contact_list list;
    pel_contact_patches patches;
} face;

static void make_face(face *f, double tilt)
{
    memset(f, 0, sizeof *f);
    for (int i = 0; i < 2 * COUNT; i++)
        f->of_slice[i] = i * PEL_WIDTH < COUNT ? 0 : -1;
    for (int c = 0; c <= COUNT; c++) {
        int32_t v = c < COUNT ? c : PEL_WIDTH * COUNT;
        double x = 0.1 * (c % SIDE), y = 0.1 * (c / SIDE);
        f->positions[v] = (pel_record){(pel_real)x, (pel_real)y, (pel_real)(0.01 + tilt * (x + 2 * y)), 1};
        f->contacts[c] =
            (pel_contact){.vertices = {v, v, v, v}, .weights = {1}, .normal = {0, 0, 1}, .separation = (pel_real)0.01};
        f->active[c] = c;
    }
    f->rigids = (pel_rigids){.of_slice = f->of_slice};
    f->list = (pel_contact_list){.contacts = f->contacts,
                                 .count = COUNT + 1,
                                 .active = f->active,
                                 .active_count = COUNT + 1,
                                 .rigids = &f->rigids};
    assert_true(pel_contact_patches_expect(&f->patches, &f->list, COUNT + 1));
}

static bool is_active(const face *f, int32_t c)
{
    bool is_one = false;
    for (int32_t i = 0; i < f->list.active_count; i++)
        is_one |= f->active[i] == c;
    return is_one;
}

/* corners, loads and what is loose stay, in their order; the rest of the face does not */
static void test_face(void **state)
{
    (void)state;
    face f;
    make_face(&f, 1e-5);
    f.contacts[7].multiplier = 1;
    pel_contact_patches_thin(&f.patches, &f.list, f.active, f.positions);
    const int32_t corners[] = {0, SIDE - 1, COUNT - SIDE, COUNT - 1};
    for (int i = 0; i < 4; i++)
        assert_true(is_active(&f, corners[i]));
    assert_true(is_active(&f, 7) && is_active(&f, COUNT));
    assert_true(f.list.active_count <= PEL_PATCH_DIRECTIONS + 3);
    for (int32_t i = 1; i < f.list.active_count; i++)
        assert_true(f.active[i - 1] < f.active[i]);
    pel_contact_patches_clear(&f.patches);
}

/* the nearest contact stays where it is inside, and others of another normal are another patch */
static void test_nearest(void **state)
{
    (void)state;
    face f;
    make_face(&f, 0);
    f.positions[12][2] = (pel_real)0.009;
    f.contacts[13].normal[0] = (pel_real)0.6;
    f.contacts[13].normal[2] = (pel_real)0.8;
    pel_contact_patches_thin(&f.patches, &f.list, f.active, f.positions);
    assert_true(is_active(&f, 12) && is_active(&f, 13));
    assert_false(is_active(&f, 6) || is_active(&f, 8) || is_active(&f, 11));
    pel_contact_patches_clear(&f.patches);
}

static pel_mesh *make_fine_box(const double center[3])
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_BOX);
    pel_mesh *mesh;
    pel_error error;
    def.size_x = def.size_y = def.size_z = 0.1;
    def.nx = def.ny = def.nz = 6;
    assert_int_equal(pel_shape_create(&def, &mesh, &error), PEL_OK);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        pel_vec3_add(mesh->positions[v], center, mesh->positions[v]);
    return mesh;
}

/* a pile of three boxes of fine triangles lies still on few contacts, which carry its weight */
static void test_pile(void **state)
{
    (void)state;
    rigid_scene scene;
    rigid_scene_begin(&scene);
    scene.gravity = -9.81;
    scene.def.contact.friction = 0.3;
    scene.def.contact.sleep = false;
    for (int i = 0; i < 3; i++) {
        const double center[3] = {0.004 * i, 0, 0.0505 + 0.101 * i};
        rigid_scene_add(&scene, make_fine_box(center), 1000);
    }
    rigid_scene_floor(&scene, 0);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 0.4);
    pel_tool_reading reading;
    pel_sim_get_tool(scene.sim, 0, &reading);
    assert_near(-reading.force[2], 3 * 9.81, 5e-3 * 3 * 9.81);
    for (int32_t b = 0; b < 3; b++)
        assert_true(rigid_scene_read(&scene, b).kinetic_energy < 1e-6);
    const pel_contact_set *set = scene.sim->contacts;
    int32_t near = 0;
    for (int32_t c = 0; c < set->list.count; c++)
        near += set->acts[c];
    assert_true(near > 60);
    assert_true(set->list.active_count < near / 2);
    rigid_scene_end(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_face), cmocka_unit_test(test_nearest),
                                       cmocka_unit_test(test_pile)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
