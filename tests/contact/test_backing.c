/* A light vertex between a tool and a heavy one: a sweep that knows its support finds both loads at once. */
#include "check.h"

#include "contact/backing.h"
#include "contact/sweep.h"

#define IN_FLOAT(in_double, in_float) (sizeof(pel_real) == 8 ? (in_double) : (in_float))

/* 1/kg of the heavy vertex and of the light ones, m/N of the layers times the rate, s */
static const double heavy = 0.5, light = 400, soft = 1.5, step = 0.1;

/* a heavy vertex above a triangle whose corners lie on a tool, the layer of the first tilted by an angle */
typedef struct scene {
    pel_record start[4], x[4];
    pel_contact press, layers[3];
    pel_contact_list pairs, solids;
    pel_contact *supports[4];
} scene;

static void begin(scene *s, double angle, double compliance)
{
    *s = (scene){0};
    pel_real c = (pel_real)(compliance * step * step);
    s->press = (pel_contact){.vertices = {0, 1, 2, 3},
                             .weights = {1, (pel_real)-0.5, (pel_real)-0.25, (pel_real)-0.25},
                             .normal = {0, 0, 1},
                             .separation = (pel_real)0.1,
                             .compliance = c};
    s->start[0] = (pel_record){0, 0, (pel_real)0.15, (pel_real)heavy};
    s->x[0] = (pel_record){0, 0, (pel_real)0.08, (pel_real)heavy};
    for (int i = 0; i < 3; i++) {
        s->start[1 + i] = s->x[1 + i] = (pel_record){i == 1, i == 2, 0, (pel_real)light};
        double turn = i == 0 ? angle : 0;
        s->layers[i] = (pel_contact){.vertices = {1 + i, 1 + i, 1 + i, 1 + i},
                                     .weights = {1},
                                     .normal = {(pel_real)sin(turn), 0, (pel_real)cos(turn)},
                                     .compliance = c,
                                     .multiplier = (pel_real)1e-6};
    }
    s->pairs = (pel_contact_list){.contacts = &s->press, .count = 1, .substep = step};
    s->solids = (pel_contact_list){.contacts = s->layers, .count = 3, .substep = step};
}

static double sweep(scene *s, bool is_known)
{
    memset(s->supports, 0, sizeof s->supports);
    pel_contacts_find_supports(&s->pairs, s->x, s->supports);
    pel_contacts_find_supports(&s->solids, s->x, s->supports);
    s->pairs.supports = s->solids.supports = is_known ? s->supports : NULL;
    double moved = pel_contacts_project(&s->pairs, s->x, s->start);
    pel_contacts_project(&s->solids, s->x, s->start);
    return moved;
}

/* what is left of the equation of a layer, gap + compliance * multiplier = 0 [m] */
static double rest_of(const scene *s, const pel_contact *contact)
{
    double gap = -(double)contact->separation;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            gap += (double)contact->weights[i] * (double)s->x[contact->vertices[i]][k] * (double)contact->normal[k];
    return gap + (double)contact->compliance / (step * step) * (double)contact->multiplier;
}

/* one sweep solves all four layers; without supports hundreds of them are needed */
static void test_one_sweep(void **unused)
{
    (void)unused;
    const double exact = IN_FLOAT(1e-9, 1e-5);
    for (int tilted = 0; tilted < 2; tilted++) {
        scene s, blind;
        begin(&s, tilted ? 0.4 : 0, soft);
        begin(&blind, tilted ? 0.4 : 0, soft);
        sweep(&s, true);
        assert_near(rest_of(&s, &s.press), 0, exact);
        for (int i = 0; i < 3; i++) {
            assert_near(rest_of(&s, &s.layers[i]), 0, exact);
            assert_true(s.layers[i].multiplier > 0);
        }
        /* the same answer, found by many sweeps */
        int sweeps = 1;
        for (sweep(&blind, false); fabs(rest_of(&blind, &blind.press)) > 1e-3 * 0.02; sweeps++)
            sweep(&blind, false);
        print_message("%d sweeps without supports\n", sweeps);
        assert_true(sweeps > 20);
        for (int n = 0; n < 20 * sweeps; n++)
            sweep(&blind, false);
        assert_near((double)s.press.multiplier, (double)blind.press.multiplier, 1e-4 * (double)s.press.multiplier);
        assert_near((double)s.x[0][2], (double)blind.x[0][2], IN_FLOAT(1e-8, 1e-5));
    }
}

/* momentum: what the heavy one gets, the layers got from the tool and the corners kept */
static void test_momentum(void **unused)
{
    (void)unused;
    scene s;
    begin(&s, 0.4, soft);
    sweep(&s, true);
    double momentum = 0, from_tool = 0;
    const double start[4] = {0.08, 0, 0, 0};
    for (int v = 0; v < 4; v++)
        momentum += ((double)s.x[v][2] - start[v]) / (double)s.x[v][3];
    for (int i = 0; i < 3; i++)
        from_tool += ((double)s.layers[i].multiplier - 1e-6) * (double)s.layers[i].normal[2];
    assert_near(momentum, from_tool, IN_FLOAT(1e-9, 1e-5) * from_tool);
}

/* supports do not pull, hold nothing where the tool pushes the other way, and are none of their own */
static void test_limits(void **unused)
{
    (void)unused;
    scene s;
    pel_backing back;
    begin(&s, 0, soft);
    sweep(&s, true);
    assert_true(pel_contact_find_backing(&s.pairs, &s.press, s.x, &back));
    assert_false(pel_contact_find_backing(&s.solids, &s.layers[0], s.x, &back));
    /* the press lets go of all that it has: layers keep at least nothing */
    pel_contact_find_backing(&s.pairs, &s.press, s.x, &back);
    pel_contact_answer(&back, s.x, -100 * (double)s.press.multiplier);
    for (int i = 0; i < 3; i++)
        assert_near((double)s.layers[i].multiplier, 0, 0);
    assert_false(pel_contact_find_backing(&s.pairs, &s.press, s.x, &back));
    /* held by nobody, or fixed */
    begin(&s, 0, soft);
    s.x[1][3] = s.x[2][3] = s.x[3][3] = 0;
    pel_contacts_find_supports(&s.solids, s.x, s.supports);
    for (int v = 0; v < 4; v++)
        assert_null(s.supports[v]);
}

/* of two layers at one vertex the one that carries more is the support; the other one knows it if they push against
   each other, and shares with it if they push to one side */
static void test_corner(void **unused)
{
    (void)unused;
    for (int opposite = 0; opposite < 2; opposite++) {
        scene s;
        begin(&s, 0.4, soft);
        s.layers[1].vertices[0] = 1;
        s.layers[0].multiplier = (pel_real)2e-3;
        s.layers[1].multiplier = (pel_real)1e-3;
        s.layers[0].separation = (pel_real)0.02;
        s.layers[1].separation = (pel_real)0.01;
        if (opposite)
            s.layers[1].normal[2] = -1;
        pel_contacts_find_supports(&s.solids, s.x, s.supports);
        s.solids.supports = s.supports;
        const bool first = s.layers[0].multiplier > s.layers[1].multiplier;
        assert_ptr_equal(s.supports[1], &s.layers[first ? 0 : 1]);
        pel_backing back;
        assert_int_equal(pel_contact_find_backing(&s.solids, &s.layers[first ? 1 : 0], s.x, &back), opposite);
        assert_false(pel_contact_find_backing(&s.solids, &s.layers[first ? 0 : 1], s.x, &back));
    }
}

/* what has gone through its layer, and what two tools hold, is solved contact by contact */
static void test_jam(void **unused)
{
    (void)unused;
    scene s, blind;
    begin(&s, 0, soft);
    begin(&blind, 0, soft);
    s.x[0][2] = blind.x[0][2] = (pel_real)-0.01;
    sweep(&s, true);
    sweep(&blind, false);
    assert_true(s.press.multiplier == blind.press.multiplier);
    /* a tool above holds the heavy one too */
    pel_backing back;
    pel_contact above = {.vertices = {0}, .weights = {1}, .normal = {0, 0, -1}, .separation = (pel_real)-0.05};
    pel_contact_list roof = {.contacts = &above, .count = 1, .substep = step};
    begin(&s, 0, soft);
    sweep(&s, true);
    assert_true(pel_contact_find_backing(&s.pairs, &s.press, s.x, &back));
    pel_contacts_find_supports(&roof, s.x, s.supports);
    assert_ptr_equal(s.supports[0], &above);
    assert_false(pel_contact_find_backing(&s.pairs, &s.press, s.x, &back));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_sweep), cmocka_unit_test(test_momentum), cmocka_unit_test(test_limits),
        cmocka_unit_test(test_corner),    cmocka_unit_test(test_jam),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
