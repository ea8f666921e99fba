/* A light vertex between a tool and a heavy one: a sweep that knows its support finds both loads at once. */
#include "check.h"

#include "sweep/backing.h"
#include "sweep/sweep.h"

#define IN_FLOAT(in_double, in_float) (sizeof(pel_real) == 8 ? (in_double) : (in_float))

/* 1/kg of the heavy vertex and of the light ones, m/N of the layers times the rate, s */
static const double heavy = 0.5, light = 400, soft = 1.5, step = 0.1;

/* a heavy vertex above a triangle whose corners lie on a tool, the layer of the first tilted by an angle */
typedef struct scene {
    pel_record start[4], x[4];
    pel_contact press, layers[3];
    pel_contact_list pairs, solids;
    pel_contact *supports[2 * 4];
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
    for (int v = 0; v < 2 * 4; v++)
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
        assert_ptr_equal(s.supports[2 * 1], &s.layers[first ? 0 : 1]);
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
    assert_ptr_equal(s.supports[2 * 0], &above);
    assert_false(pel_contact_find_backing(&s.pairs, &s.press, s.x, &back));
}

/* A heavy vertex over triangles, each with its corners before the triangle below, the last ones on a tool. */
enum { MOST_LEVELS = 4, MOST_POINTS = 1 + 3 * MOST_LEVELS };

typedef struct column {
    int levels;
    pel_record start[MOST_POINTS], x[MOST_POINTS];
    pel_contact pairs[MOST_POINTS], layers[3];
    pel_contact_list lists[2];
    pel_contact *supports[2 * MOST_POINTS];
} column;

static void begin_column(column *s, int levels, double ratio)
{
    *s = (column){.levels = levels};
    const double thick = 0.1;
    for (int v = 0; v <= 3 * levels; v++) {
        int level = (v + 2) / 3, below = 3 * level + 1;
        double mass = v == 0 ? 1 / ratio : 1, fallen = v == 0 ? 0.02 : 0.001;
        s->x[v] = (pel_record){v % 2, v % 3, (pel_real)((levels - level) * thick - fallen), (pel_real)(light * mass)};
        s->start[v] = s->x[v];
        pel_contact *pair = v > 3 * (levels - 1) ? &s->layers[(v + 2) % 3] : &s->pairs[v];
        *pair = (pel_contact){.vertices = {v, v, v, v},
                              .weights = {1},
                              .normal = {0, 0, 1},
                              .compliance = (pel_real)(1e-4 * light * step * step)};
        for (int i = 0; i < 3 && level < levels; i++) {
            pair->vertices[1 + i] = below + (v + i) % 3;
            pair->weights[1 + i] = (pel_real)(i == 0 ? -0.5 : -0.25);
            pair->separation = (pel_real)thick;
        }
    }
    s->lists[0] = (pel_contact_list){.contacts = s->pairs, .count = 3 * levels - 2, .substep = step};
    s->lists[1] = (pel_contact_list){.contacts = s->layers, .count = 3, .substep = step};
}

static void sweep_column(column *s, bool is_known)
{
    memset(s->supports, 0, sizeof s->supports);
    for (int k = 0; k < 2; k++)
        pel_contacts_find_supports(&s->lists[k], s->x, s->supports);
    for (int k = 0; k < 2; k++) {
        s->lists[k].supports = is_known ? s->supports : NULL;
        pel_contacts_project(&s->lists[k], s->x, s->start);
    }
}

/* the sweeps until the heavy vertex is where it has to be, to a share of its way */
static int count_sweeps(const column *from, bool is_known, double place, double share, int most)
{
    column s = *from;
    int sweeps = 0;
    for (int k = 0; k < 2; k++)
        s.lists[k].contacts = k == 0 ? s.pairs : s.layers;
    double way = fabs((double)s.x[0][2] - place);
    while (sweeps < most && fabs((double)s.x[0][2] - place) > share * way) {
        sweep_column(&s, is_known);
        sweeps++;
    }
    return sweeps;
}

/* Under something a thousand times heavier, through sheets on sheets, the answer of very many sweeps is found in some.
 */
static void test_column(void **unused)
{
    (void)unused;
    for (int levels = 1; levels <= MOST_LEVELS; levels++) {
        column s, exact;
        begin_column(&s, levels, 1000);
        begin_column(&exact, levels, 1000);
        for (int n = 0; n < 200000; n++)
            sweep_column(&exact, false);
        double place = (double)exact.x[0][2];
        const double shares[] = {1e-3, IN_FLOAT(1e-6, 1e-4)};
        for (int i = 0; i < 2; i++) {
            int chained = count_sweeps(&s, true, place, shares[i], 10000);
            int blind = count_sweeps(&s, false, place, shares[i], 10000);
            print_message("%d levels, to %g: %d sweeps along chains, %d contact by contact\n", levels, shares[i],
                          chained, blind);
            assert_true(blind > 1000);
            assert_in_range(chained, 1, i == 0 ? 20 : 60);
        }
        double momentum = 0, from_tool = 0, from_exact = 0;
        for (int n = 0; n < 60; n++)
            sweep_column(&s, true);
        for (int v = 0; v <= 3 * levels; v++)
            momentum += (double)(s.x[v][2] - s.start[v][2]) / (double)s.x[v][3];
        for (int i = 0; i < 3; i++) {
            from_tool += (double)s.layers[i].multiplier;
            from_exact += (double)exact.layers[i].multiplier;
        }
        assert_near(momentum, from_tool, IN_FLOAT(1e-9, 1e-3) * from_tool);
        assert_near(from_tool, from_exact, IN_FLOAT(1e-6, 1e-3) * from_tool);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_sweep), cmocka_unit_test(test_momentum), cmocka_unit_test(test_limits),
        cmocka_unit_test(test_corner),    cmocka_unit_test(test_jam),      cmocka_unit_test(test_column),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
