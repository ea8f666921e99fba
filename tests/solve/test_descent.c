/* Minimisation: quadratic and curved valleys, fixed vertices, monotony, what cannot be minimised. */
#include "check.h"
#include "failing_malloc.h"
#include "random.h"

#include "solve/descent.h"

#include <stdlib.h>

enum { COUNT = 12 };

typedef struct problem {
    double stiffness[COUNT][3], target[COUNT][3];
    int evaluations;
    double highest_rise, last; /* of the energies of accepted points, by the caller */
} problem;

static double quadratic(void *context, const double *position, double *force)
{
    problem *p = context;
    double energy = 0;
    p->evaluations++;
    for (int v = 0; v < COUNT; v++)
        for (int c = 0; c < 3; c++) {
            double d = position[3 * v + c] - p->target[v][c];
            energy += 0.5 * p->stiffness[v][c] * d * d;
            force[3 * v + c] = -p->stiffness[v][c] * d;
        }
    return energy;
}

/* Rosenbrock's valley in x and y of each vertex */
static double valley(void *context, const double *position, double *force)
{
    (void)context;
    double energy = 0;
    for (int v = 0; v < COUNT; v++) {
        double x = position[3 * v], y = position[3 * v + 1], z = position[3 * v + 2], d = y - x * x;
        energy += (1 - x) * (1 - x) + 100 * d * d + z * z;
        force[3 * v] = 2 * (1 - x) + 400 * x * d;
        force[3 * v + 1] = -200 * d;
        force[3 * v + 2] = -2 * z;
    }
    return energy;
}

static double slope_without_end(void *context, const double *position, double *force)
{
    (void)context;
    for (int v = 0; v < COUNT; v++) {
        force[3 * v] = 1;
        force[3 * v + 1] = force[3 * v + 2] = 0;
    }
    return -position[0] * COUNT;
}

/* the force lies */
static double against_the_slope(void *context, const double *position, double *force)
{
    double energy = quadratic(context, position, force);
    for (int i = 0; i < 3 * COUNT; i++)
        force[i] = -force[i];
    return energy;
}

static void fill(problem *p, double condition, random_state *random)
{
    *p = (problem){0};
    for (int v = 0; v < COUNT; v++)
        for (int c = 0; c < 3; c++) {
            p->stiffness[v][c] = pow(condition, random_between(random, 0, 1));
            p->target[v][c] = random_normal(random);
        }
}

static pel_descent_result run(pel_descent_energy *energy, void *context, bool gradient_only, int32_t iterations,
                              double longest_move, double *position)
{
    pel_real inverse_mass[COUNT];
    for (int v = 0; v < COUNT; v++)
        inverse_mass[v] = v % 4 != 3; /* every fourth vertex is fixed */
    const pel_descent_problem what = {
        .inverse_mass = inverse_mass,
        .energy = energy,
        .context = context,
        .longest_move = longest_move,
        .tolerance = 1e-9,
        .iterations = iterations,
        .gradient_only = gradient_only,
    };
    pel_descent *descent;
    pel_descent_result result;
    assert_int_equal(pel_descent_create(COUNT, &descent, NULL), PEL_OK);
    failing_malloc_begin(0);
    pel_descent_run(descent, &what, position, &result);
    assert_int_equal(failing_malloc_end().calls, 0);
    pel_descent_destroy(descent);
    return result;
}

static void test_quadratic(void **unused)
{
    (void)unused;
    random_state random = {1};
    for (int gradient = 0; gradient < 2; gradient++) {
        problem p;
        fill(&p, 10, &random);
        double position[3 * COUNT] = {0};
        pel_descent_result result = run(quadratic, &p, gradient == 1, 300, 10, position);
        assert_true(result.converged && result.iterations > 3 && result.iterations < 120);
        assert_int_equal(result.evaluations, p.evaluations);
        for (int v = 0; v < COUNT; v++)
            for (int c = 0; c < 3; c++)
                assert_near(position[3 * v + c], v % 4 == 3 ? 0 : p.target[v][c], 1e-3);
    }
}

/* bad conditioning costs gradient descent many times what it costs L-BFGS */
static void test_conditioning(void **unused)
{
    (void)unused;
    random_state random = {2};
    problem p;
    fill(&p, 1e3, &random);
    double position[3 * COUNT] = {0}, other[3 * COUNT] = {0};
    pel_descent_result quasi_newton = run(quadratic, &p, false, 2000, 10, position);
    pel_descent_result gradient = run(quadratic, &p, true, quasi_newton.iterations, 10, other);
    assert_true(quasi_newton.converged && !gradient.converged);
    assert_true(gradient.residual > 100 * quasi_newton.residual);
}

static void test_curved_valley(void **unused)
{
    (void)unused;
    double position[3 * COUNT];
    for (int v = 0; v < COUNT; v++)
        memcpy(position + 3 * v, (const double[]){-1.2, 1, 1}, 3 * sizeof(double));
    pel_descent_result result = run(valley, NULL, false, 500, 0.5, position);
    assert_true(result.converged);
    for (int v = 0; v < COUNT; v++)
        assert_near(position[3 * v], v % 4 == 3 ? -1.2 : 1, 1e-2);
}

/* one iteration at a time the energy only falls */
static void test_energy_falls(void **unused)
{
    (void)unused;
    for (int gradient = 0; gradient < 2; gradient++) {
        double position[3 * COUNT];
        for (int v = 0; v < COUNT; v++)
            memcpy(position + 3 * v, (const double[]){-1.2, 1, 1}, 3 * sizeof(double));
        double before = HUGE_VAL;
        for (int i = 0; i < 60; i++) {
            pel_descent_result result = run(valley, NULL, gradient == 1, 1, 0.5, position);
            assert_true(result.energy <= before * (1 + 1e-6));
            before = result.energy;
        }
        assert_true(before < 3 * 0.75 * 100);
    }
}

/* no vertex goes farther than it may in one iteration */
static void test_longest_move(void **unused)
{
    (void)unused;
    double position[3 * COUNT] = {0};
    pel_descent_result result = run(slope_without_end, NULL, false, 5, 0.25, position);
    assert_true(!result.converged && result.iterations == 5);
    assert_true(position[0] > 0.25 && position[0] <= 5 * 0.25 + 1e-6);
    assert_true(position[9] == 0);
}

static void test_wrong_forces(void **unused)
{
    (void)unused;
    random_state random = {3};
    problem p;
    fill(&p, 10, &random);
    double position[3 * COUNT] = {0}, start[3 * COUNT] = {0};
    pel_descent_result result = run(against_the_slope, &p, false, 100, 10, position);
    assert_true(result.stuck && !result.converged && result.iterations == 0);
    assert_memory_equal(position, start, sizeof start);
}

static pel_status create(const void *unused, pel_error *error)
{
    (void)unused;
    pel_descent *descent;
    pel_status status = pel_descent_create(COUNT, &descent, error);
    assert_true((descent == NULL) == (status != PEL_OK));
    pel_descent_destroy(descent);
    return status;
}

static void test_allocation_failure(void **unused)
{
    (void)unused;
    assert_int_equal(for_every_allocation_failure(create, NULL), 12);
}

/* vertices that are held stay; an end at a share of the gradient; what goes on has learnt */
static void test_rounds(void **unused)
{
    (void)unused;
    random_state random = {7};
    problem p;
    fill(&p, 1e3, &random);
    pel_real inverse_mass[COUNT];
    uint8_t held[COUNT] = {0};
    held[2] = 1;
    for (int v = 0; v < COUNT; v++)
        inverse_mass[v] = 1;
    pel_descent_problem what = {
        .inverse_mass = inverse_mass,
        .held = held,
        .energy = quadratic,
        .context = &p,
        .longest_move = 10,
        .tolerance = 1e-3,
        .reduction = 0.1,
        .enough = HUGE_VAL,
        .iterations = 300,
    };
    pel_descent *descent;
    pel_descent_result first, second, anew;
    double position[3 * COUNT] = {0}, other[3 * COUNT];
    assert_int_equal(pel_descent_create(COUNT, &descent, NULL), PEL_OK);
    what.iterations = 0;
    pel_descent_run(descent, &what, position, &first);
    double begin = first.residual;
    what.iterations = 300;
    pel_descent_run(descent, &what, position, &first);
    assert_true(first.converged && first.residual <= 0.1 * begin && first.residual > 1e-3 * begin);
    /* to the end: the curvature that the first run saw saves iterations */
    what.reduction = 0;
    memcpy(other, position, sizeof other);
    what.goes_on = true;
    pel_descent_run(descent, &what, position, &second);
    what.goes_on = false;
    pel_descent_run(descent, &what, other, &anew);
    pel_descent_destroy(descent);
    assert_true(second.converged && anew.converged && second.residual <= 1e-3);
    assert_true(second.iterations < anew.iterations);
    for (int v = 0; v < COUNT; v++)
        for (int c = 0; c < 3; c++)
            assert_near(position[3 * v + c], held[v] ? 0 : p.target[v][c], 1e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quadratic),    cmocka_unit_test(test_conditioning),
        cmocka_unit_test(test_rounds),       cmocka_unit_test(test_curved_valley),
        cmocka_unit_test(test_energy_falls), cmocka_unit_test(test_longest_move),
        cmocka_unit_test(test_wrong_forces), cmocka_unit_test(test_allocation_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
