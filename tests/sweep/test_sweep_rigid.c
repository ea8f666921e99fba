/* Rigid bodies that press light surfaces on something: no energy appears, and the load goes through. */
#include "../rigid/rigid_scene.h"

#include "random.h"

#include "math/pose.h"
#include "sweep/sweep.h"
#include "sweep/sweep_rigid.h"

#define GRAVITY 9.81

static pel_body_def *add_cloth(rigid_scene *scene, double height)
{
    pel_mesh *mesh;
    pel_shape_def grid = pel_shape_def_default(PEL_SHAPE_GRID);
    grid.nx = grid.ny = 20;
    grid.size_x = grid.size_y = 0.3;
    assert_int_equal(pel_shape_create(&grid, &mesh, NULL), PEL_OK);
    pel_transform transform = pel_transform_default();
    transform.translation[2] = height;
    assert_int_equal(pel_mesh_transform(mesh, &transform, NULL), PEL_OK);
    pel_body_def *cloth = rigid_scene_add(scene, mesh, 1);
    *cloth = pel_body_def_sheet(cloth->name, mesh, 1e6, 4e-4, 750);
    return cloth;
}

/* how much energy appears in the steps up to a time */
static double run_and_sum_gains(rigid_scene *scene, double time)
{
    double gains = 0, last = 0;
    while (pel_sim_time(scene->sim) < time - 1e-9) {
        rigid_scene_run(scene, pel_sim_time(scene->sim) + 0.01);
        pel_sim_ledger ledger;
        pel_sim_get_ledger(scene->sim, &ledger);
        double lost = ledger.dissipated_solver - ledger.energy_error;
        gains += fmax(0, last - lost);
        last = lost;
    }
    return gains;
}

/* a pot of 1.2 kg falls by 10 mm on a cloth of 27 g over a table */
static void test_pot(void **state)
{
    (void)state;
    static const double center[3] = {0.004, 0.003, 0.0615};
    rigid_scene scene;
    rigid_scene_begin(&scene);
    scene.gravity = -GRAVITY;
    scene.def.contact.friction = 0.3;
    scene.def.contact.sleep = false;
    rigid_scene_add(&scene, make_box(0.12, 0.1, 0.1, center), 1000);
    add_cloth(&scene, 1e-3);
    rigid_scene_floor(&scene, 0);
    rigid_scene_make(&scene);
    double fallen = 1.2 * GRAVITY * 0.01, gains = run_and_sum_gains(&scene, 0.2);
    assert_true(gains < 0.01 * fallen);
    pel_tool_reading reading;
    pel_sim_get_tool(scene.sim, 0, &reading);
    assert_near(-reading.force[2], 1.227 * GRAVITY, 1e-3 * 1.227 * GRAVITY);
    pel_rigid_reading pot = rigid_scene_read(&scene, 0);
    assert_near(pot.center[2], 0.05, 5e-4);
    assert_true(pot.kinetic_energy < 1e-6);
    rigid_scene_end(&scene);
}

/* by a push, of a body of 1 kg */
static void lift(pel_rigid *body, double way)
{
    const double push[3] = {0, 0, way}, moment[3] = {0};
    pel_rigid_shift(body, push, moment, 0);
    body->unrest += fabs(way);
}

/* a body of 1 kg in one point, at the start of a substep, and a contact that pushes it up by a millimetre */
typedef struct lone {
    pel_record rest[PEL_WIDTH], now[PEL_WIDTH];
    pel_real inverse_mass[PEL_WIDTH];
    int32_t of_slice[1];
    pel_rigid_shape shape;
    pel_rigid body;
    pel_rigids rigids;
    pel_contact contact;
    pel_contact_list list;
} lone;

static void make_lone(lone *l)
{
    const double still[3] = {0};
    pel_rigid_state begin;
    memset(l, 0, sizeof *l);
    l->shape = (pel_rigid_shape){.mass = 1, .inverse_mass = 1, .is_free = true, .roundness = 1};
    l->body = (pel_rigid){.shape = &l->shape, .end = PEL_WIDTH};
    l->rigids = (pel_rigids){
        .count = 1, .items = &l->body, .of_slice = l->of_slice, .rest = l->rest, .inverse_mass = l->inverse_mass};
    l->contact = (pel_contact){.weights = {1}, .normal = {0, 0, 1}, .separation = (pel_real)1e-3};
    l->list = (pel_contact_list){.contacts = &l->contact, .count = 1, .substep = 1, .rigids = &l->rigids};
    pel_rigid_state_start(&l->shape, still, still, &begin);
    pel_rigid_begin(&l->body, &begin);
    for (int v = 0; v < PEL_WIDTH; v++)
        l->inverse_mass[v] = l->now[v][3] = 1;
}

/* friction has nothing to hold where nothing slides, and nothing moves what is held */
static void test_straight(void **state)
{
    (void)state;
    lone l;
    make_lone(&l);
    l.contact.friction = 1;
    assert_near(pel_contacts_project(&l.list, l.now, l.now), 1e-3, 1e-9);
    assert_true(l.body.way[0] == 0 && l.body.way[1] == 0);
    assert_near(l.body.way[2], 1e-3, 1e-9);
    assert_near(l.body.unrest, 1e-3, 1e-9);
    for (int k = 0; k < 3; k++)
        assert_true(l.contact.drag[k] == 0);
    make_lone(&l);
    l.body.is_fixed = true;
    assert_true(pel_contacts_project(&l.list, l.now, l.now) == 0);
    assert_true(l.contact.multiplier == 0);
}

/* A contact that a sweep leaves as it is rests until its body has moved by more than what counts as calm; one with a
   gap, by half of that. */
static void test_rest(void **state)
{
    (void)state;
    lone l;
    make_lone(&l);
    pel_record *now = l.now;
    pel_rigid *body = &l.body;
    pel_contacts_rouse(&l.list, 1e-5);
    assert_near(pel_contacts_project(&l.list, now, now), 1e-3, 1e-9);
    assert_near(body->unrest, 1e-3, 1e-9);
    assert_false(pel_rigid_contact_rests(&l.list, &l.contact, now));
    assert_near(pel_contacts_project(&l.list, now, now), 0, 1e-9);
    assert_true(pel_rigid_contact_rests(&l.list, &l.contact, now));
    lift(body, -0.9e-5);
    assert_true(pel_contacts_project(&l.list, now, now) == 0);
    lift(body, -0.2e-5);
    assert_near(pel_contacts_project(&l.list, now, now), 1.1e-5, 1e-9);
    /* loads stay the largest of the substep while what carries them rests */
    assert_near(l.list.carried, 1e-3, 1e-4);
    pel_contacts_rouse(&l.list, 1e-5);
    assert_false(pel_rigid_contact_rests(&l.list, &l.contact, now));
    lift(body, 1e-3);
    body->unrest -= 1e-3;
    l.contact.multiplier = 0;
    pel_contacts_project(&l.list, now, now);
    body->unrest += 0.4e-3;
    assert_true(pel_rigid_contact_rests(&l.list, &l.contact, now));
    body->unrest += 0.2e-3;
    assert_false(pel_rigid_contact_rests(&l.list, &l.contact, now));
}

/* Boxes that fall on each other at random squeeze some between them: corrections after the solver end only when these
   are apart, and the guard stops none. */
static void test_falling_boxes(void **state)
{
    (void)state;
    skip_if_slow();
    enum { BOXES = 30 };
    random_state random = {7};
    rigid_scene scene;
    rigid_scene_begin(&scene);
    scene.gravity = -GRAVITY;
    scene.def.contact.friction = 0.4;
    for (int i = 0; i < BOXES; i++) {
        const double center[3] = {0};
        pel_mesh *mesh = make_box(0.1, 0.1, 0.1, center);
        pel_transform transform = pel_transform_default();
        double axis[3] = {random_between(&random, -1, 1), random_between(&random, -1, 1),
                          random_between(&random, 0, 1)};
        pel_vec3_scale(axis, random_between(&random, 0, 0.7) / pel_vec3_length(axis), axis);
        pel_rotation_exp(axis, transform.rotation);
        transform.translation[0] = 0.2 * (i % 3 - 1) + random_between(&random, -0.01, 0.01);
        transform.translation[1] = 0.2 * (i / 3 % 2) + random_between(&random, -0.01, 0.01);
        transform.translation[2] = 0.15 + 0.2 * (i / 6);
        assert_int_equal(pel_mesh_transform(mesh, &transform, NULL), PEL_OK);
        rigid_scene_add(&scene, mesh, 500);
    }
    rigid_scene_floor(&scene, 0);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 1);
    pel_contact_statistics statistics;
    pel_sim_get_contact_statistics(scene.sim, &statistics);
    assert_int_equal(statistics.fall_backs, 0);
    rigid_scene_end(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_pot), cmocka_unit_test(test_rest),
                                       cmocka_unit_test(test_straight), cmocka_unit_test(test_falling_boxes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
