/* Newton's method on forces of a body and of terms that the caller adds: couplings, kinks, a clock, surfaces. */
#include "failing_malloc.h"
#include "shell_fixture.h"

#include "newton/newton.h"

#include <stdlib.h>

/* a sheet of 3 x 3 vertices whose vertices springs tie to points */
typedef struct sheet {
    pel_mesh *mesh;
    pel_model *model;
    pel_newton *newton;
    int32_t count; /* unknowns */
    double *unknowns, (*points)[3], *stiffness;
} sheet;

enum { SIDE = 3, VERTICES = SIDE * SIDE, WALLS = 30 };

/* nearly without a membrane; a body of a mesh with a pressure */
static sheet make_body(pel_mesh *mesh, double young, double tie, const pel_pressure_def *pressure)
{
    sheet s = {.mesh = mesh};
    pel_body_def body = shell_body(s.mesh, PEL_MEMBRANE_STVK);
    body.shell.membrane.young.value = young;
    body.shell.pressure = *pressure;
    s.model = make_model(&body);
    assert_int_equal(pel_newton_create(s.model, NULL, &s.newton, NULL), PEL_OK);
    s.count = pel_newton_pattern(s.newton)->unknown_count;
    s.unknowns = calloc((size_t)s.count, sizeof *s.unknowns);
    s.stiffness = calloc((size_t)s.model->vertex_count, sizeof *s.stiffness);
    s.points = calloc((size_t)s.model->vertex_count, sizeof *s.points);
    for (int32_t v = 0; v < s.model->vertex_count; v++) {
        pel_vertex_position(s.model->rest, v, s.points[v]);
        pel_vec3_copy(s.points[v], s.unknowns + 3 * v);
        s.stiffness[v] = s.model->mass[v] > 0 ? tie : 0;
    }
    return s;
}

static sheet make_sheet_of(double young, double tie, double pressure)
{
    pel_pressure_def def = pel_body_def_default().shell.pressure;
    def.kind = pressure != 0 ? PEL_PRESSURE_GIVEN : PEL_PRESSURE_NONE;
    def.outside.value = pressure;
    return make_body(make_grid(SIDE - 1, SIDE - 1, 1, 1, PEL_GRID_ONE_DIAGONAL), young, tie, &def);
}

/* 42 vertices; bulk [Pa] of the volume, 0 = none */
static sheet make_ball_of(double bulk)
{
    pel_pressure_def def = pel_body_def_default().shell.pressure;
    def.kind = bulk > 0 ? PEL_PRESSURE_VOLUME : PEL_PRESSURE_NONE;
    def.bulk = bulk;
    def.target.value = 1;
    return make_body(make_sphere(2), 1e-6, 1, &def);
}

static void free_sheet(sheet *s)
{
    pel_newton_destroy(s->newton);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
    free(s->unknowns);
    free(s->points);
    free(s->stiffness);
}

static pel_newton_problem problem_of(const sheet *s, const pel_newton_terms *terms)
{
    return (pel_newton_problem){
        .point_stiffness = s->stiffness,
        .points = (const double(*)[3])s->points,
        .terms = terms,
        .tolerance = sizeof(pel_real) == 8 ? 1e-9 : 1e-5,
        .iterations = 40,
        .is_dynamic = true,
    };
}

/* Walls: a vertex and the one opposite to it keep a distance along z, k / 2 max(0, floor - sum of z)^2 for each pair.
 */
typedef struct walls {
    int32_t pairs[WALLS][4];
    double floors[WALLS], stiffness;
    int count;
    double at[WALLS]; /* depth at the last evaluation */
    pel_newton_kink kinks[WALLS];
    bool is_listed;                    /* kinks say which of them act */
    int systems;                       /* matrices asked for */
    int evaluations, most_evaluations; /* after which a stop is wanted */
} walls;

static double depth_of(const walls *w, int i, const double *unknowns)
{
    return w->floors[i] - unknowns[3 * w->pairs[i][0] + 2] - unknowns[3 * w->pairs[i][1] + 2];
}

static double evaluate_walls(void *context, const double *unknowns, double *gradient)
{
    walls *w = context;
    double energy = 0;
    w->evaluations++;
    w->is_listed = false;
    for (int i = 0; i < w->count; i++) {
        w->at[i] = depth_of(w, i, unknowns);
        if (!(w->at[i] > 0))
            continue;
        energy += 0.5 * w->stiffness * w->at[i] * w->at[i];
        for (int k = 0; k < 2; k++)
            gradient[3 * w->pairs[i][k] + 2] -= w->stiffness * w->at[i];
    }
    return energy;
}

static bool acts(const walls *w, int i)
{
    return w->is_listed ? w->kinks[i].acts : w->at[i] > 0;
}

static void add_walls(void *context, pel_matrix *matrix)
{
    walls *w = context;
    w->systems++;
    for (int i = 0; i < w->count; i++)
        for (int a = 0; a < 2 && acts(w, i); a++)
            for (int b = 0; b < 2; b++) {
                int32_t block = pel_matrix_block(matrix, w->pairs[i][a], w->pairs[i][b]);
                assert_true(block >= 0);
                matrix->values[matrix->block_start[block] + 8] += w->stiffness;
            }
}

static int32_t list_walls(void *context, const int32_t (**vertices)[4], int32_t *acting)
{
    static int32_t list[WALLS][4];
    walls *w = context;
    *acting = 0;
    for (int i = 0; i < w->count; i++)
        if (acts(w, i))
            memcpy(list[(*acting)++], w->pairs[i], sizeof *list);
    *vertices = (const int32_t(*)[4])list;
    return *acting;
}

static pel_newton_kink *list_kinks(void *context, int32_t *count)
{
    walls *w = context;
    for (int i = 0; i < w->count; i++) {
        w->kinks[i] = (pel_newton_kink){
            .weights = {1, 1}, .normal = {0, 0, 1}, .gap = -w->at[i], .stiffness = w->stiffness, .acts = w->at[i] > 0};
        memcpy(w->kinks[i].vertices, w->pairs[i], sizeof w->pairs[i]);
    }
    w->is_listed = true;
    *count = w->count;
    return w->kinks;
}

static pel_newton_terms terms_of(walls *w)
{
    return (pel_newton_terms){.context = w,
                              .evaluate = evaluate_walls,
                              .add_matrix = add_walls,
                              .list_couplings = list_walls,
                              .has_kinks = true};
}

/* vertices that share no element: opposite ones */
static walls make_walls(const sheet *s, double stiffness)
{
    walls w = {.stiffness = stiffness, .count = VERTICES / 2};
    const int32_t *index = s->model->bodies[0].model_index;
    for (int i = 0; i < w.count; i++) {
        const int32_t pair[4] = {index[i], index[VERTICES - 1 - i], index[i], index[i]};
        memcpy(w.pairs[i], pair, sizeof pair);
        w.floors[i] = 0.1 * (i + 1);
    }
    return w;
}

/* Far vertices that stiff terms couple: the sum of z of a pair goes up to its floor, the difference stays. The body is
   weak: nearly a linear problem, which takes few systems only if the matrix has these blocks. */
static void test_couplings(void **unused)
{
    (void)unused;
    sheet s = make_sheet_of(1e-6, 1, 0);
    walls w = make_walls(&s, 1e4);
    const pel_newton_terms terms = terms_of(&w);
    pel_newton_problem problem = problem_of(&s, &terms);
    pel_newton_result result;
    pel_newton_forget(s.newton);
    assert_int_equal(pel_newton_run(s.newton, &problem, s.unknowns, &result, NULL), PEL_OK);
    assert_true(result.converged);
    assert_true(result.iterations <= 4);
    for (int i = 0; i < w.count; i++) {
        /* tie (z - 0) = stiffness (floor - 2 z) */
        double z = 1e4 * w.floors[i] / (1 + 2e4);
        for (int k = 0; k < 2; k++)
            assert_near(s.unknowns[3 * w.pairs[i][k] + 2], z, 1e-5);
    }
    free_sheet(&s);
}

/* random pairs, floors and signs of the ties: some of them send full steps round in a circle */
static void random_walls(const sheet *s, random_state *random, walls *w)
{
    const int32_t *index = s->model->bodies[0].model_index;
    *w = (walls){.stiffness = 1e4, .count = WALLS};
    for (int i = 0; i < w->count; i++) {
        int a = (int)random_integer(random, 0, VERTICES - 1), b = (int)random_integer(random, 0, VERTICES - 2);
        const int32_t pair[4] = {index[a], index[b < a ? b : b + 1], index[a], index[a]};
        memcpy(w->pairs[i], pair, sizeof pair);
        w->floors[i] = random_between(random, -0.2, 0.1);
    }
    for (int32_t v = 0; v < s->model->vertex_count; v++) {
        s->points[v][2] = random_between(random, -0.3, 0.1);
        s->stiffness[v] = s->model->mass[v] > 0 ? pow(10, random_between(random, 0, 4)) : 0;
    }
}

/* Walls that begin and cease to act from step to step. Where each run ends does not depend on the patterns before. */
static void test_kinks(void **unused)
{
    (void)unused;
    for (uint32_t seed = 1; seed <= 200; seed++) {
        double ends[2][3 * 64];
        for (int again = 0; again < 2; again++) {
            sheet s = make_sheet_of(1e-6, 1, 0);
            random_state random = {seed};
            walls w, other = make_walls(&s, 1);
            random_walls(&s, &random, &w);
            const pel_newton_terms terms = terms_of(&w), other_terms = terms_of(&other);
            pel_newton_problem problem = problem_of(&s, &terms), before = problem_of(&s, &other_terms);
            pel_newton_result result;
            double unknowns[3 * 64];
            assert_true(s.count <= 3 * 64);
            memcpy(unknowns, s.unknowns, (size_t)s.count * sizeof *unknowns);
            if (again == 1)
                assert_int_equal(pel_newton_run(s.newton, &before, unknowns, &result, NULL), PEL_OK);
            pel_newton_forget(s.newton);
            assert_int_equal(pel_newton_run(s.newton, &problem, s.unknowns, &result, NULL), PEL_OK);
            assert_true(result.converged);
            assert_true(result.iterations <= 20);
            memcpy(ends[again], s.unknowns, (size_t)s.count * sizeof(double));
            if (again == 1)
                assert_memory_equal(ends[0], ends[1], (size_t)s.count * sizeof(double));
            free_sheet(&s);
        }
    }
}

/* A ball whose volume is driven to its own, with nearly linear forces, whose vertices random ties pull against walls.
   Told of the kinks the method finds the minimum of the quadratic pieces in few systems; it is that without. */
static void test_crossed_kinks(void **unused)
{
    (void)unused;
    int systems[2] = {0, 0};
    for (uint32_t seed = 1; seed <= 20; seed++)
        for (int has_volume = 0; has_volume < 2; has_volume++) {
            double ends[2][3 * 64];
            for (int told = 0; told < 2; told++) {
                sheet s = make_ball_of(has_volume ? 1e5 : 0);
                random_state random = {seed};
                walls w;
                random_walls(&s, &random, &w);
                /* about the ball, and small */
                for (int32_t v = 0; v < s.model->vertex_count; v++)
                    s.points[v][2] = (double)s.model->rest[v][2] + 0.01 * s.points[v][2];
                for (int i = 0; i < w.count; i++)
                    w.floors[i] = 0.01 * w.floors[i] + (double)s.model->rest[w.pairs[i][0]][2] +
                                  (double)s.model->rest[w.pairs[i][1]][2];
                pel_newton_terms terms = terms_of(&w);
                terms.list_kinks = told ? list_kinks : NULL;
                pel_newton_problem problem = problem_of(&s, &terms);
                pel_newton_result result;
                assert_true(s.count <= 3 * 64);
                assert_int_equal(pel_newton_run(s.newton, &problem, s.unknowns, &result, NULL), PEL_OK);
                assert_true(result.converged);
                assert_true(!told || result.iterations <= 5);
                systems[told] += w.systems;
                memcpy(ends[told], s.unknowns, (size_t)s.count * sizeof(double));
                free_sheet(&s);
            }
            for (int i = 0; i < 3 * 42; i++)
                assert_near(ends[1][i], ends[0][i], sizeof(pel_real) == 8 ? 1e-6 : 1e-3);
        }
    assert_true(systems[1] < systems[0] / 2);
}

/* L-BFGS between systems ends where Newton's method alone does, with fewer matrices; with a volume, which the factor
   lacks. */
static void test_quasi(void **unused)
{
    (void)unused;
    int systems[2] = {0, 0};
    for (int has_volume = 0; has_volume < 2; has_volume++) {
        double ends[2][3 * 64];
        for (int quasi = 0; quasi < 2; quasi++) {
            sheet s = make_ball_of(has_volume ? 1e3 : 0);
            walls w = {0};
            pel_newton_terms terms = terms_of(&w);
            pel_newton_problem problem = problem_of(&s, &terms);
            pel_newton_result result;
            for (int32_t v = 0; v < s.model->vertex_count; v++)
                s.points[v][2] += 0.3 * sin(5 * s.points[v][0]);
            problem.is_quasi = problem.is_in_motion = quasi == 1;
            problem.keeps_factor = true;
            assert_int_equal(pel_newton_run(s.newton, &problem, s.unknowns, &result, NULL), PEL_OK);
            assert_true(result.converged && s.count <= 3 * 64);
            systems[quasi] += w.systems;
            memcpy(ends[quasi], s.unknowns, (size_t)s.count * sizeof(double));
            free_sheet(&s);
        }
        for (int i = 0; i < 3 * 42; i++)
            assert_near(ends[1][i], ends[0][i], sizeof(pel_real) == 8 ? 1e-7 : 1e-3);
    }
    assert_true(systems[1] < systems[0]);
}

/* A body that rests needs no system; a light one beside it that does not rest gets one. */
static void test_rest(void **unused)
{
    (void)unused;
    for (int moves = 0; moves < 2; moves++) {
        sheet s = make_ball_of(0);
        walls w = {0};
        pel_newton_terms terms = terms_of(&w);
        pel_newton_problem problem = problem_of(&s, &terms);
        pel_newton_result result;
        /* below the tolerance, but all that acts */
        for (int32_t v = 0; moves == 1 && v < s.model->vertex_count; v++)
            s.points[v][2] += s.stiffness[v] > 0 ? 1e-3 * problem.tolerance : 0;
        problem.rest_share = 1e-4;
        problem.rounding = 1e-6 * problem.tolerance;
        assert_int_equal(pel_newton_run(s.newton, &problem, s.unknowns, &result, NULL), PEL_OK);
        assert_true(result.converged);
        assert_int_equal(result.iterations, moves);
        free_sheet(&s);
    }
}

/* A pressure on an open sheet has no potential: steps that go by an energy would see one that does not fall. */
static void test_open_pressure(void **unused)
{
    (void)unused;
    sheet s = make_sheet_of(1e3, 1, 0.5);
    walls w = {0};
    const pel_newton_terms terms = terms_of(&w);
    pel_newton_problem problem = problem_of(&s, &terms);
    pel_newton_result result;
    assert_int_equal(pel_newton_run(s.newton, &problem, s.unknowns, &result, NULL), PEL_OK);
    assert_true(result.converged);
    assert_true(result.iterations <= 12);
    free_sheet(&s);
}

/* ---- time ---- */

static int ticks;

static double count_ticks(void)
{
    return ticks++;
}

/* A run ends after the system at which the clock has passed the deadline, at the state of the least residual: that
   never rises with more time, though from step to step it does. */
static void test_deadline(void **unused)
{
    (void)unused;
    int longest = 0;
    for (uint32_t seed = 1; seed <= 20; seed++) {
        double before = HUGE_VAL;
        bool converged = false;
        for (int most = 1; !converged; most++) {
            sheet s = make_sheet_of(1e-6, 1, 0);
            random_state random = {seed};
            walls w;
            random_walls(&s, &random, &w);
            const pel_newton_terms terms = terms_of(&w);
            pel_newton_problem problem = problem_of(&s, &terms);
            pel_newton_result result;
            ticks = 0;
            problem.clock = count_ticks;
            problem.deadline = most - 1;
            assert_int_equal(pel_newton_run(s.newton, &problem, s.unknowns, &result, NULL), PEL_OK);
            assert_int_equal(result.iterations, most);
            assert_true(result.is_late == !result.converged);
            /* the first step is taken in any case: fixed unknowns are at their targets after it */
            assert_true(most <= 2 || result.residual <= before);
            before = result.residual;
            converged = result.converged;
            longest = most > longest ? most : longest;
            assert_true(most < 25);
            free_sheet(&s);
        }
    }
    assert_true(longest > 5);
}

static bool wants_more(void *context)
{
    const walls *w = context;
    return w->evaluations < w->most_evaluations;
}

/* whatever a run does when it is stopped, along a step as well, it evaluates once more at most */
static void test_stop(void **unused)
{
    (void)unused;
    int stops = 0;
    for (uint32_t seed = 1; seed <= 20; seed++) {
        pel_status status = PEL_STOPPED;
        for (int most = 1; status == PEL_STOPPED; most++) {
            sheet s = make_sheet_of(1e-6, 1, 0);
            random_state random = {seed};
            walls w;
            pel_pool *pool;
            pel_newton *newton;
            pel_newton_result result;
            random_walls(&s, &random, &w);
            w.most_evaluations = most;
            const pel_newton_terms terms = terms_of(&w);
            pel_newton_problem problem = problem_of(&s, &terms);
            assert_int_equal(pel_pool_create(1, &pool, NULL), PEL_OK);
            assert_int_equal(pel_newton_create(s.model, pool, &newton, NULL), PEL_OK);
            pel_pool_watch(pool, wants_more, &w);
            status = pel_newton_run(newton, &problem, s.unknowns, &result, NULL);
            assert_true(w.evaluations <= most + 1);
            stops += status == PEL_STOPPED;
            pel_newton_destroy(newton);
            pel_pool_destroy(pool);
            free_sheet(&s);
        }
        assert_int_equal(status, PEL_OK);
    }
    assert_true(stops > 100);
}

static pel_status create_newton(const void *data, pel_error *error)
{
    pel_newton *newton;
    pel_status status = pel_newton_create(data, NULL, &newton, error);
    pel_newton_destroy(newton);
    return status;
}

/* a run that has no memory for the pattern of its couplings fails, and the next one that has some does not */
static pel_status run_walls(const void *data, pel_error *error)
{
    pel_model *model = (pel_model *)(uintptr_t)data;
    sheet s = {.model = model};
    pel_status status = pel_newton_create(model, NULL, &s.newton, error);
    if (status != PEL_OK)
        return status;
    static double unknowns[3 * 64], stiffness[64], points[64][3];
    for (int32_t v = 0; v < model->vertex_count; v++) {
        pel_vertex_position(model->rest, v, points[v]);
        pel_vec3_copy(points[v], unknowns + 3 * v);
        stiffness[v] = model->mass[v] > 0;
    }
    s.stiffness = stiffness;
    s.points = points;
    walls w = make_walls(&s, 1e4);
    const pel_newton_terms terms = terms_of(&w);
    const pel_newton_problem problem = problem_of(&s, &terms);
    pel_newton_result result;
    pel_newton_forget(s.newton);
    status = pel_newton_run(s.newton, &problem, unknowns, &result, error);
    pel_newton_destroy(s.newton);
    return status;
}

static void test_allocation_failure(void **unused)
{
    (void)unused;
    sheet s = make_sheet_of(1e-6, 1, 0);
    for_every_allocation_failure(create_newton, s.model);
    for_every_allocation_failure(run_walls, s.model);
    free_sheet(&s);
}

/* N along z on each vertex, with a matrix that is too stiff, each vertex by another factor: a long tail */
static double evaluate_push(void *context, const double *unknowns, double *gradient)
{
    (void)context;
    for (int v = 0; v < VERTICES; v++)
        gradient[3 * v + 2] -= v + 1;
    double energy = 0;
    for (int v = 0; v < VERTICES; v++)
        energy -= (v + 1) * unknowns[3 * v + 2];
    return energy;
}

static void add_stiff(void *context, pel_matrix *matrix)
{
    (void)context;
    for (int v = 0; v < VERTICES; v++)
        matrix->values[matrix->block_start[pel_matrix_block(matrix, v, v)] + 8] += v;
}

/* systems until a run in time has settled whose sheet as a whole goes by `way` in the step; the largest error [m] */
static int settle(bool settles, double way, double *error)
{
    sheet s = make_sheet_of(1e-6, 1, 0);
    const pel_newton_terms terms = {.evaluate = evaluate_push, .add_matrix = add_stiff, .has_kinks = true};
    pel_newton_problem problem = problem_of(&s, &terms);
    pel_newton_result result;
    pel_state *state;
    assert_int_equal(pel_state_create(s.model, true, &state, NULL), PEL_OK);
    problem.state = state;
    problem.settles = settles;
    problem.iterations = 200;
    for (int v = 0; v < VERTICES; v++) {
        s.points[v][2] += way;
        s.unknowns[3 * v + 2] += way;
    }
    assert_int_equal(pel_newton_run(s.newton, &problem, s.unknowns, &result, NULL), PEL_OK);
    assert_true(result.converged);
    *error = 0;
    for (int v = 0; v < VERTICES; v++) {
        double off = fabs(s.unknowns[3 * v + 2] - s.points[v][2] - (v + 1));
        *error = off > *error ? off : *error;
    }
    pel_state_destroy(state);
    free_sheet(&s);
    return result.iterations;
}

/* Runs in time end before their tail, and as early where the body moves as a whole. */
static void test_settled(void **unused)
{
    (void)unused;
    double still, moving, whole;
    int count = settle(true, 0, &still), last = settle(false, 0, &whole);
    print_message("%d systems of %d, %g m are left\n", count, last, still);
    assert_true(count > 3 && count < last);
    for (int sign = -1; sign <= 1; sign += 2) {
        assert_int_equal(settle(true, 10 * sign, &moving), count);
        assert_near(moving, still, 1e-6);
    }
}

/* of a run from a ball as it is at rest, turned by an angle about (1, 2, 2) / 3, to points that lie a little aside, by
   the factor that was prepared at rest; the unknowns in the end turned back. Returns what it cost. */
static int64_t run_turned(sheet *s, double angle, double *unknowns)
{
    const double axis[3] = {1.0 / 3, 2.0 / 3, 2.0 / 3};
    double turn[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const double skew = i == j ? 0 : (j - i + 3) % 3 == 1 ? -axis[3 - i - j] : axis[3 - i - j];
            turn[i][j] = (1 - cos(angle)) * axis[i] * axis[j] + sin(angle) * skew + (i == j ? cos(angle) : 0);
        }
    pel_newton_problem problem = problem_of(s, NULL);
    problem.tolerance = 1e-6;
    for (int32_t v = 0; v < s->model->vertex_count; v++)
        pel_vertex_position(s->model->rest, v, s->unknowns + 3 * v);
    assert_int_equal(pel_newton_prepare(s->newton, &problem, s->unknowns, NULL), PEL_OK);
    for (int32_t v = 0; v < s->model->vertex_count; v++) {
        double x[3], aside[3];
        pel_vertex_position(s->model->rest, v, x);
        for (int k = 0; k < 3; k++)
            aside[k] = x[k] + 0.01 * sin(3 * x[(k + 1) % 3]);
        for (int k = 0; k < 3; k++) {
            s->unknowns[3 * v + k] = pel_vec3_dot(turn[k], x);
            s->points[v][k] = pel_vec3_dot(turn[k], aside);
        }
    }
    pel_newton_result result;
    int64_t before = pel_newton_work(s->newton);
    problem.is_prepared = problem.is_in_motion = true;
    assert_int_equal(pel_newton_run(s->newton, &problem, s->unknowns, &result, NULL), PEL_OK);
    assert_true(result.converged && pel_newton_is_prepared(s->newton));
    for (int32_t v = 0; v < s->model->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            unknowns[3 * v + k] = turn[0][k] * s->unknowns[3 * v] + turn[1][k] * s->unknowns[3 * v + 1] +
                                  turn[2][k] * s->unknowns[3 * v + 2];
    return pel_newton_work(s->newton) - before;
}

/* The prepared factor serves as well where the body has turned: the same steps lead to the same place. */
static void test_turned(void **unused)
{
    (void)unused;
    const pel_pressure_def none = pel_body_def_default().shell.pressure;
    sheet s = make_body(make_sphere(6), 1e3, 1, &none);
    double *first = malloc((size_t)s.count * sizeof *first), *second = malloc((size_t)s.count * sizeof *second);
    const int64_t work = run_turned(&s, 0, first);
    for (int i = 1; i <= 3; i++) {
        assert_true(llabs(run_turned(&s, i, second) - work) <= 1);
        for (int32_t u = 0; u < 3 * s.model->vertex_count; u++)
            assert_near(second[u], first[u], 1e-5);
    }
    free(first);
    free(second);
    free_sheet(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_couplings),     cmocka_unit_test(test_kinks),
        cmocka_unit_test(test_crossed_kinks), cmocka_unit_test(test_open_pressure),
        cmocka_unit_test(test_deadline),      cmocka_unit_test(test_stop),
        cmocka_unit_test(test_quasi),         cmocka_unit_test(test_rest),
        cmocka_unit_test(test_settled),       cmocka_unit_test(test_allocation_failure),
        cmocka_unit_test(test_turned),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
