/* Contacts in a sweep: pairs too near are moved to their distance, momentum is conserved, friction obeys Coulomb's
   limit. */
#include "check.h"

#include "sweep/sweep.h"

static pel_contact vertex_on_face(double friction)
{
    return (pel_contact){.vertices = {0, 1, 2, 3},
                         .weights = {1, (pel_real)-0.5, (pel_real)-0.25, (pel_real)-0.25},
                         .normal = {0, 0, 1},
                         .separation = (pel_real)0.1,
                         .friction = (pel_real)friction};
}

static void place(pel_record x[4], double height)
{
    x[0] = (pel_record){0, 0, (pel_real)height, 2};
    x[1] = (pel_record){-1, 0, 0, 1};
    x[2] = (pel_record){1, 1, 0, 1};
    x[3] = (pel_record){1, -1, 0, 0};
}

static double gap_of(const pel_record x[4])
{
    return (double)(x[0][2] - (pel_real)0.5 * x[1][2] - (pel_real)0.25 * (x[2][2] + x[3][2]));
}

/* sum of inverse mass times squared weight */
#define FREE (2 + 0.25 + 0.0625)

static void test_moves_apart(void **unused)
{
    (void)unused;
    pel_record start[4], x[4];
    place(start, 0.2);
    place(x, -0.05);
    pel_contact contact = vertex_on_face(0);
    pel_contact_list list = {.contacts = &contact, .count = 1, .substep = 0.1};
    assert_near(pel_contacts_project(&list, x, start), 0.15, 1e-6);
    assert_near(gap_of(x), 0.1, 1e-6);
    assert_near((double)contact.multiplier, 0.15 / FREE, 1e-6);
    assert_near(list.carried, 0.15, 1e-6);
    /* each moves by inverse mass times weight; the fourth stays */
    double share = 0.15 / FREE;
    assert_near((double)x[0][2], -0.05 + 2 * share, 1e-6);
    assert_near((double)x[1][2], -0.5 * share, 1e-6);
    assert_near((double)x[2][2], -0.25 * share, 1e-6);
    assert_true(x[3][2] == 0);
    /* satisfied: nothing more to do */
    pel_record again[4];
    memcpy(again, x, sizeof x);
    assert_true(pel_contacts_project(&list, x, start) < 1e-6);
    assert_near(gap_of(x), gap_of(again), 1e-6);
    pel_contacts_begin(&list, 0.2);
    assert_true(contact.multiplier == 0 && list.substep == 0.2);
}

/* multiplier and drag are all that has pushed, also where the normal turns within a step; friction keeps its own */
static void test_turned(void **unused)
{
    (void)unused;
    const pel_real before[3] = {0, 0, 1};
    pel_record start[4], x[4];
    place(start, 0.2);
    place(x, -0.05);
    pel_contact contact = vertex_on_face(0);
    pel_contact_list list = {.contacts = &contact, .count = 1, .substep = 0.1};
    pel_contacts_project(&list, x, start);
    contact.normal[0] = (pel_real)0.6;
    contact.normal[2] = (pel_real)0.8;
    pel_contact rubbed = contact;
    rubbed.friction = (pel_real)0.3;
    pel_contact_keep_push(&rubbed, before);
    assert_true(rubbed.drag[0] == 0 && rubbed.drag[2] == 0);
    pel_contact_keep_push(&contact, before);
    x[0][0] -= (pel_real)0.3;
    pel_contacts_project(&list, x, start);
    assert_true((double)contact.multiplier > 0.15 / FREE);
    const double from[3] = {-0.3, 0, -0.05};
    for (int k = 0; k < 3; k++)
        assert_near(2 * (double)(contact.multiplier * contact.normal[k] + contact.drag[k]), (double)x[0][k] - from[k],
                    1e-6);
}

/* A layer of compliance c takes the load f = depth / c in a substep h: the gap -0.15 opens by FREE f h^2. */
static void test_layer(void **unused)
{
    (void)unused;
    const double substep = 0.1, compliance = 0.05;
    pel_record start[4], x[4];
    place(start, -0.05);
    place(x, -0.05);
    pel_contact contact = vertex_on_face(0);
    contact.compliance = (pel_real)compliance;
    pel_contact_list list = {.contacts = &contact, .count = 1, .substep = substep};
    double load = 0.15 / (compliance + FREE * substep * substep);
    for (int sweep = 0; sweep < 3; sweep++) {
        pel_contacts_project(&list, x, start);
        assert_near((double)contact.multiplier, load * substep * substep, 1e-6);
        assert_near(gap_of(x), 0.1 - load * compliance, 1e-6);
    }
}

/* Half of a load acts first in the next substep, or more where the rest would move the gap by more than it may; it is
   taken back where it is not needed. */
static void test_left_load(void **unused)
{
    (void)unused;
    const double load = 0.04, most[] = {1, 0.5 * load * FREE, 0.1 * load * FREE, 0}, kept[] = {0.5, 0.5, 0.9, 1};
    for (int i = 0; i < 4; i++) {
        pel_record start[4], x[4];
        place(start, 0.1);
        place(x, 0.1);
        pel_contact contact = vertex_on_face(0.5);
        contact.multiplier = (pel_real)load;
        contact.drag[0] = (pel_real)(0.2 * load);
        pel_contact_list list = {.contacts = &contact, .count = 1, .substep = 0.1};
        pel_contacts_load(&list, x, most[i]);
        assert_false(list.is_rubbed);
        assert_near((double)contact.multiplier, kept[i] * load, 1e-6);
        assert_near((double)contact.drag[0], 0.2 * kept[i] * load, 1e-6);
        assert_near(gap_of(x), 0.1 + kept[i] * load * FREE, 1e-6);
        pel_contacts_project(&list, x, start);
        assert_near(gap_of(x), 0.1, 1e-6);
        assert_near((double)contact.multiplier, 0, 1e-6);
    }
}

/* Where friction uses much of what it can hold, loads that acted in two substeps act first in the next one, and are
   taken back where they are not needed; what acted in one alone was an impact. */
static void test_kept_load(void **unused)
{
    (void)unused;
    const double loads[][2] = {{0.04, 0.03}, {0.03, 0.04}, {0.05, 0}};
    for (int i = 0; i < 3; i++) {
        pel_record start[4], x[4];
        place(start, 0.1);
        place(x, 0.1);
        pel_contact contact = vertex_on_face(0);
        contact.multiplier = (pel_real)loads[i][0];
        contact.earlier = (pel_real)loads[i][1];
        contact.drag[0] = (pel_real)(0.5 * loads[i][0]);
        pel_contact_list list = {.contacts = &contact, .count = 1, .substep = 0.1};
        double kept = fmin(loads[i][0], loads[i][1]);
        pel_contacts_load(&list, x, 1);
        assert_true(list.is_rubbed);
        assert_near((double)contact.multiplier, kept, 1e-6);
        assert_near((double)contact.earlier, loads[i][0], 1e-6);
        assert_near((double)contact.drag[0], 0.5 * kept, 1e-6);
        assert_near(gap_of(x), 0.1 + kept * FREE, 1e-6);
        assert_near((double)x[0][0], kept * 0.5 * 2, 1e-6);
        pel_contacts_project(&list, x, start);
        assert_near(gap_of(x), 0.1, 1e-6);
        assert_near((double)contact.multiplier, 0, 1e-6);
    }
}

/* only active contacts push */
static void test_active(void **unused)
{
    (void)unused;
    pel_record start[4], x[4];
    place(start, 0);
    place(x, 0);
    pel_contact contacts[2] = {vertex_on_face(0), vertex_on_face(0)};
    contacts[0].separation = 5;
    const int32_t active[] = {1};
    pel_contact_list list = {.contacts = contacts, .count = 2, .active = active, .active_count = 1, .substep = 0.1};
    pel_contacts_project(&list, x, start);
    assert_near(gap_of(x), 0.1, 1e-6);
    assert_true(contacts[0].multiplier == 0 && contacts[1].multiplier > 0);
}

/* a step sideways of 0.1 against a push of 0.15: friction 1 holds it, 0.2 leaves 0.07 */
static void test_friction(void **unused)
{
    (void)unused;
    const double coefficients[] = {1, 0.2}, slips[] = {0, 0.07};
    for (int i = 0; i < 2; i++) {
        pel_record start[4], x[4];
        place(start, 0.1);
        place(x, -0.05);
        x[0][0] += (pel_real)0.1;
        pel_contact contact = vertex_on_face(coefficients[i]);
        pel_contact_list list = {.contacts = &contact, .count = 1, .substep = 0.1};
        pel_contacts_project(&list, x, start);
        double slip = 0, before = 0;
        for (int k = 0; k < 4; k++) {
            slip += (double)(contact.weights[k] * x[k][0]);
            before += (double)(contact.weights[k] * start[k][0]);
        }
        assert_near(slip - before, slips[i], 1e-6);
    }
}

/* against a tool that moves tangentially, sticking means to move with it */
static void test_drift(void **unused)
{
    (void)unused;
    pel_record start[1] = {{0, 0, (pel_real)0.1, 1}}, x[1] = {{0, 0, 0, 1}};
    pel_contact contact = {.weights = {1, 0, 0, 0}, .normal = {0, 0, 1}, .separation = (pel_real)0.1, .friction = 1};
    contact.drift[0] = (pel_real)0.05;
    pel_contact_list list = {.contacts = &contact, .count = 1, .substep = 0.1};
    pel_contacts_project(&list, x, start);
    assert_near((double)x[0][0], 0.05, 1e-6);
    assert_near((double)x[0][2], 0.1, 1e-6);
}

static void test_nothing_moves(void **unused)
{
    (void)unused;
    pel_record x[4];
    place(x, -0.05);
    for (int i = 0; i < 4; i++)
        x[i][3] = 0;
    pel_contact contact = vertex_on_face(1);
    pel_contact_list list = {.contacts = &contact, .count = 1, .substep = 0.1}, none = {.substep = 0.1};
    pel_contacts_project(&list, x, x);
    pel_contacts_project(&none, x, x);
    assert_near((double)x[0][2], -0.05, 1e-6);
}

/* what is switched off has neither load nor friction, whatever its places */
static void test_off(void **unused)
{
    (void)unused;
    pel_record x[4], earlier[4];
    pel_contact contact = vertex_on_face(1);
    contact.multiplier = contact.earlier = 3;
    for (int k = 0; k < 3; k++)
        contact.drag[k] = (pel_real)(k + 1);
    pel_contact_switch_off(&contact);
    assert_true(contact.multiplier == 0 && contact.earlier == 0);
    for (int k = 0; k < 3; k++)
        assert_true(contact.drag[k] == 0);
    place(x, -0.05);
    memcpy(earlier, x, sizeof x);
    pel_contact_list list = {.contacts = &contact, .count = 1, .substep = 0.1};
    pel_contacts_project(&list, x, x);
    assert_memory_equal(x, earlier, sizeof x);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_moves_apart), cmocka_unit_test(test_turned),    cmocka_unit_test(test_layer),
        cmocka_unit_test(test_left_load),   cmocka_unit_test(test_kept_load), cmocka_unit_test(test_active),
        cmocka_unit_test(test_friction),    cmocka_unit_test(test_drift),     cmocka_unit_test(test_nothing_moves),
        cmocka_unit_test(test_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
