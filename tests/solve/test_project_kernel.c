/* Projections of single constraints: wide against plain (the same bits), plain against the pure functions of elements
   and materials in double, conservation of momentum, and guards where a triangle has collapsed. */
#include "check.h"
#include "law_forms.h"
#include "random.h"

#include "base/lane.h"
#include "law/membrane.h"
#include "math/vec3.h"
#include "pellicle/bending.h"
#include "pellicle/element.h"
#include "solve/project.h"

enum { POINTS = 4 * PEL_BLOCK, ROUNDS = 200 };

/* relative to the size of the triangles */
static const double tolerance = sizeof(pel_real) == 8 ? 1e-12 : 2e-4;

/* one block with points of its own for each lane */
typedef struct sample {
    pel_batch batch;
    int32_t steps[4 * PEL_BLOCK], sources[PEL_BLOCK], bundle_begin[2];
    _Alignas(64) pel_real numbers[PEL_CAVE_NUMBERS * PEL_BLOCK];
    _Alignas(64) pel_real multipliers[3 * PEL_BLOCK];
    uint8_t lanes[1], followers[1];
    double rest[PEL_BLOCK][4][3];
    pel_record x[POINTS], before[POINTS];
} sample;

static void random_points(random_state *random, sample *s, double strain, bool pinned)
{
    static const double corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0.5, 0.9, 0}, {0.5, -0.9, 0}};
    for (int lane = 0; lane < PEL_BLOCK; lane++) {
        double rotation[9];
        random_rotation(random, rotation);
        for (int k = 0; k < 4; k++) {
            double at[3];
            for (int i = 0; i < 3; i++) {
                s->rest[lane][k][i] = corner[k][i] + 0.2 * random_between(random, -1, 1);
                at[i] = s->rest[lane][k][i] + strain * random_between(random, -1, 1);
            }
            double w = pinned && (k + lane) % 4 == 0 ? 0 : random_between(random, 0.5, 2);
            pel_record *x = &s->x[k * PEL_BLOCK + lane];
            for (int i = 0; i < 3; i++)
                (*x)[i] =
                    (pel_real)(rotation[3 * i] * at[0] + rotation[3 * i + 1] * at[1] + rotation[3 * i + 2] * at[2]);
            (*x)[3] = (pel_real)w;
        }
    }
    memcpy(s->before, s->x, sizeof s->x);
}

static void make_batch(sample *s, pel_constraint kind, int arity, int number_count, int multiplier_count)
{
    s->batch = (pel_batch){
        .kind = kind,
        .law.share = 1,
        .arity = arity,
        .number_count = number_count,
        .multiplier_count = multiplier_count,
        .region = -1,
        .capacity = 1,
        .block_count = 1,
        .bundle_begin = s->bundle_begin,
        .steps = s->steps,
        .numbers = s->numbers,
        .sources = s->sources,
        .lane_counts = s->lanes,
        .followers = s->followers,
    };
    s->lanes[0] = PEL_BLOCK;
    s->followers[0] = 0;
    for (int k = 0; k < arity; k++)
        for (int lane = 0; lane < PEL_BLOCK; lane++)
            s->steps[k * PEL_BLOCK + lane] = PEL_STEP * (k * PEL_BLOCK + lane);
}

/* runs the wide kernel, and checks that the plain one gives the same bits */
static void project(sample *s)
{
    pel_record plain[POINTS];
    pel_real kept[3 * PEL_BLOCK];
    memcpy(plain, s->x, sizeof plain);
    memcpy(kept, s->multipliers, sizeof kept);
    pel_project_plain[s->batch.kind](&s->batch, 0, 1, plain);
    pel_real after[3 * PEL_BLOCK];
    memcpy(after, s->multipliers, sizeof after);
    memcpy(s->multipliers, kept, sizeof kept);
    pel_project_wide[s->batch.kind](&s->batch, 0, 1, s->x);
    assert_memory_equal(plain, s->x, sizeof plain);
    assert_memory_equal(after, s->multipliers, sizeof after);
}

static void points_of(const sample *s, const pel_record *records, int lane, double x[4][3])
{
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++)
            x[k][i] = (double)records[k * PEL_BLOCK + lane][i];
    (void)s;
}

/* what the plain rule -k w g C / sum w g^2 makes of a lane, against what the kernel made */
static void check_rule(const sample *s, int lane, int count, double value, double gradient[][3], double factor)
{
    double bottom = 0;
    for (int k = 0; k < count; k++)
        for (int i = 0; i < 3; i++)
            bottom += (double)s->before[k * PEL_BLOCK + lane][3] * gradient[k][i] * gradient[k][i];
    for (int k = 0; k < count; k++)
        for (int i = 0; i < 3; i++) {
            double w = (double)s->before[k * PEL_BLOCK + lane][3];
            double expected = (double)s->before[k * PEL_BLOCK + lane][i] - factor * w * gradient[k][i] * value / bottom;
            assert_near((double)s->x[k * PEL_BLOCK + lane][i], expected, tolerance);
        }
}

/* momentum and angular momentum of each lane stay, when nothing is pinned */
static void check_momentum(const sample *s, int count)
{
    for (int lane = 0; lane < PEL_BLOCK; lane++) {
        double linear[3] = {0}, angular[3] = {0};
        for (int k = 0; k < count; k++) {
            const pel_record *a = &s->before[k * PEL_BLOCK + lane], *b = &s->x[k * PEL_BLOCK + lane];
            double d[3], x[3], mass = 1 / (double)(*a)[3];
            for (int i = 0; i < 3; i++) {
                x[i] = (double)(*a)[i];
                d[i] = mass * ((double)(*b)[i] - x[i]);
                linear[i] += d[i];
            }
            for (int i = 0; i < 3; i++)
                angular[i] += x[(i + 1) % 3] * d[(i + 2) % 3] - x[(i + 2) % 3] * d[(i + 1) % 3];
        }
        for (int i = 0; i < 3; i++) {
            assert_near(linear[i], 0, 30 * (double)PEL_REAL_EPSILON);
            assert_near(angular[i], 0, 100 * (double)PEL_REAL_EPSILON);
        }
    }
}

static pel_membrane_material material_of(pel_membrane_kind kind)
{
    return law_material((int)kind, 1, 0.3, 1);
}

static int numbers_of(int kind)
{
    return pel_triangle_numbers(pel_membrane_law_traits((pel_membrane_kind)kind));
}

static void set_law(pel_batch *batch, pel_membrane_kind kind)
{
    pel_membrane_material material = material_of(kind);
    pel_membrane_law law = pel_membrane_law_of(&material);
    batch->law.modulus = law.modulus;
    batch->law.poisson = (pel_real)law.poisson;
    for (int i = 0; i < PEL_LAW_NUMBERS; i++)
        batch->law.numbers[i] = (pel_real)law.numbers[i];
}

static void set_rest_triangles(sample *s, pel_rest_triangle *rest)
{
    for (int lane = 0; lane < PEL_BLOCK; lane++) {
        assert_true(pel_rest_triangle_setup((const double(*)[3])s->rest[lane], &rest[lane]));
        for (int j = 0; j < 3; j++)
            s->numbers[j * PEL_BLOCK + lane] = (pel_real)rest[lane].inverse[j];
        /* of laws with numbers of each triangle: the first axis, no slip */
        for (int j = 0; j < PEL_LAW_AXIS; j++)
            s->numbers[(PEL_TRIANGLE_NUMBERS + j) * PEL_BLOCK + lane] = s->batch.law.numbers[j];
    }
}

static void test_energy_constraints(void **unused)
{
    (void)unused;
    random_state random = {3};
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++)
        for (int n = 0; n < ROUNDS; n++) {
            static sample s;
            pel_rest_triangle rest[PEL_BLOCK];
            make_batch(&s, (pel_constraint)(PEL_CONSTRAINT_MEMBRANE + kind), 3, numbers_of(kind), 3);
            random_points(&random, &s, 0.2, n % 2 == 1);
            set_law(&s.batch, (pel_membrane_kind)kind);
            set_rest_triangles(&s, rest);
            project(&s);
            pel_membrane_material material = material_of((pel_membrane_kind)kind);
            for (int lane = 0; lane < PEL_BLOCK; lane++) {
                double x[4][3], gradient[3][3];
                points_of(&s, s.before, lane, x);
                double energy = pel_membrane_energy(&rest[lane], &material, (const double(*)[3])x, gradient);
                check_rule(&s, lane, 3, energy, gradient, 1);
            }
            if (n % 2 == 0)
                check_momentum(&s, 3);
        }
}

/* a quarter of a quadratic energy is left (theory page, finding 4) */
static void test_energy_falls_to_a_quarter(void **unused)
{
    (void)unused;
    random_state random = {4};
    double least = 1, most = 0;
    for (int n = 0; n < ROUNDS; n++) {
        static sample s;
        pel_rest_triangle rest[PEL_BLOCK];
        make_batch(&s, PEL_CONSTRAINT_MEMBRANE, 3, PEL_TRIANGLE_NUMBERS, 3);
        random_points(&random, &s, 0.005, false);
        set_law(&s.batch, PEL_MEMBRANE_STVK);
        set_rest_triangles(&s, rest);
        project(&s);
        pel_membrane_material material = material_of(PEL_MEMBRANE_STVK);
        for (int lane = 0; lane < PEL_BLOCK; lane++) {
            double x[4][3], y[4][3];
            points_of(&s, s.before, lane, x);
            points_of(&s, s.x, lane, y);
            double ratio = pel_membrane_energy(&rest[lane], &material, (const double(*)[3])y, NULL) /
                           pel_membrane_energy(&rest[lane], &material, (const double(*)[3])x, NULL);
            least = fmin(least, ratio);
            most = fmax(most, ratio);
        }
    }
    /* 1/4 along the gradient of one quadratic form; more where the form is far from round */
    assert_true(least > 0.2 && least < 0.26);
    assert_true(most < 0.85);
}

/* The strain form with one multiplier from zero is one Newton step on |dx|^2 / (2 w) + dt^2 energy: repeated with its
   multipliers it ends where l = -area dt^2 S, whatever the material. */
static void test_strain_forms_reach_the_stress(void **unused)
{
    (void)unused;
    random_state random = {5};
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++)
        for (int n = 0; n < 20; n++) {
            static sample s;
            pel_rest_triangle rest[PEL_BLOCK];
            make_batch(&s, (pel_constraint)(PEL_CONSTRAINT_STRAIN + kind), 3, numbers_of(kind), 3);
            s.batch.multipliers = s.multipliers;
            memset(s.multipliers, 0, sizeof s.multipliers);
            random_points(&random, &s, 0.12, n % 2 == 1);
            set_law(&s.batch, (pel_membrane_kind)kind);
            set_rest_triangles(&s, rest);
            const int traits = pel_membrane_law_traits((pel_membrane_kind)kind);
            double square_time = random_between(&random, 0.1, 1);
            s.batch.law.square_time = (pel_real)square_time;
            s.batch.law.inverse_square = (pel_real)(1 / square_time);
            for (int lane = 0; lane < PEL_BLOCK; lane++) {
                double stiffness = rest[lane].area;
                if ((traits & PEL_LAW_CONSTANT_TANGENT) == 0)
                    stiffness *= s.batch.law.modulus;
                s.numbers[3 * PEL_BLOCK + lane] =
                    (pel_real)(pel_law_has_compliance(traits) ? 1 / stiffness : stiffness);
            }
            for (int i = 0; i < 60; i++)
                project(&s);
            pel_membrane_material material = material_of((pel_membrane_kind)kind);
            /* sum of w g g^T is not what we test: force of the end shape must equal the push, with the gradients of
               the last shape; they agree when the iteration has come to rest */
            for (int lane = 0; lane < PEL_BLOCK; lane++) {
                double x[4][3], gradient[3][3];
                points_of(&s, s.x, lane, x);
                pel_membrane_energy(&rest[lane], &material, (const double(*)[3])x, gradient);
                pel_rest_triangle *t = &rest[lane];
                double f[6], stress[3];
                pel_deformation_gradient(t, (const double(*)[3])x, f);
                const double l[3] = {(double)s.multipliers[lane], (double)s.multipliers[PEL_BLOCK + lane],
                                     (double)s.multipliers[2 * PEL_BLOCK + lane]};
                for (int i = 0; i < 3; i++)
                    stress[i] = -l[i] / (square_time * t->area);
                double piola[6], p[6];
                pel_membrane_density(&material, f, piola);
                if (kind == PEL_MEMBRANE_LINEAR)
                    continue; /* its multipliers belong to other strains: tested by the sheet in test_project.c */
                for (int i = 0; i < 3; i++) {
                    p[2 * i] = f[2 * i] * stress[0] + f[2 * i + 1] * stress[2];
                    p[2 * i + 1] = f[2 * i] * stress[2] + f[2 * i + 1] * stress[1];
                }
                for (int i = 0; i < 6; i++)
                    assert_near(p[i], piola[i], sizeof(pel_real) == 8 ? 1e-9 : 1e-4);
            }
        }
}

static void test_bending(void **unused)
{
    (void)unused;
    random_state random = {6};
    for (int n = 0; n < ROUNDS; n++)
        for (int form = 0; form < 3; form++) {
            static sample s;
            bool hinge = form == 2;
            make_batch(&s, hinge ? PEL_CONSTRAINT_ANGLE : PEL_CONSTRAINT_ISOMETRIC, 4,
                       hinge ? PEL_ANGLE_NUMBERS : PEL_ISOMETRIC_NUMBERS, 3);
            random_points(&random, &s, 0.3, n % 2 == 1);
            s.batch.law.weight = (pel_real)0.4;
            pel_bending_isometric stencils[PEL_BLOCK];
            pel_hinge hinges[PEL_BLOCK];
            for (int lane = 0; lane < PEL_BLOCK; lane++) {
                assert_true(pel_bending_isometric_setup((const double(*)[3])s.rest[lane], &stencils[lane]));
                assert_true(pel_hinge_setup((const double(*)[3])s.rest[lane], &hinges[lane]));
                for (int j = 0; j < 3; j++)
                    s.numbers[j * PEL_BLOCK + lane] = (pel_real)stencils[lane].weight[j + 1];
                s.numbers[4 * PEL_BLOCK + lane] =
                    (pel_real)(form == 1 ? 2 * stencils[lane].rest_energy / stencils[lane].factor : 0);
                if (hinge) {
                    s.numbers[lane] = (pel_real)cos(hinges[lane].rest_angle);
                    s.numbers[PEL_BLOCK + lane] = (pel_real)sin(hinges[lane].rest_angle);
                }
            }
            project(&s);
            for (int lane = 0; lane < PEL_BLOCK; lane++) {
                double x[4][3], gradient[4][3];
                points_of(&s, s.before, lane, x);
                double energy =
                    hinge ? pel_hinge_energy(&hinges[lane], (const double(*)[3])x, gradient)
                          : pel_bending_isometric_energy(&stencils[lane],
                                                         form == 1 ? PEL_BENDING_REST_SUBTRACTED : PEL_BENDING_LITERAL,
                                                         (const double(*)[3])x, gradient);
                double literal =
                    pel_bending_isometric_energy(&stencils[lane], PEL_BENDING_LITERAL, (const double(*)[3])x, NULL);
                /* the guard of a stencil that is much flatter than at rest */
                if (form == 1 && literal < 0.25 * stencils[lane].rest_energy)
                    continue;
                check_rule(&s, lane, 4, energy, gradient, (double)s.batch.law.weight);
            }
            if (n % 2 == 0)
                check_momentum(&s, 4);
        }
}

static void test_fibres(void **unused)
{
    (void)unused;
    random_state random = {7};
    for (int n = 0; n < ROUNDS; n++)
        for (int squared = 0; squared < 2; squared++) {
            static sample s;
            pel_rest_triangle rest[PEL_BLOCK];
            make_batch(&s, squared ? PEL_CONSTRAINT_FIBRE_SQUARE : PEL_CONSTRAINT_FIBRE, 3, PEL_FIBRE_WEIGHTED_NUMBERS,
                       1);
            random_points(&random, &s, 0.2, n % 2 == 1);
            double length = squared ? 1 : 0.8, direction[PEL_BLOCK][2];
            s.batch.law.rest_length = (pel_real)length;
            for (int lane = 0; lane < PEL_BLOCK; lane++) {
                double angle = random_between(&random, 0, 6.3);
                direction[lane][0] = cos(angle);
                direction[lane][1] = sin(angle);
                assert_true(pel_rest_triangle_setup((const double(*)[3])s.rest[lane], &rest[lane]));
                const double *i = rest[lane].inverse;
                s.numbers[lane] = (pel_real)(i[0] * direction[lane][0] + i[1] * direction[lane][1]);
                s.numbers[PEL_BLOCK + lane] = (pel_real)(i[2] * direction[lane][1]);
                s.numbers[3 * PEL_BLOCK + lane] = (pel_real)0.7;
            }
            project(&s);
            for (int lane = 0; lane < PEL_BLOCK; lane++) {
                double x[4][3], gradient[3][3], energy;
                points_of(&s, s.before, lane, x);
                if (squared)
                    energy = pel_fibre_energy(&rest[lane], PEL_FIBRE_STVK, 1, direction[lane], (const double(*)[3])x,
                                              gradient);
                else
                    energy = pel_fibre_active_energy(&rest[lane], 1, length, direction[lane], (const double(*)[3])x,
                                                     gradient);
                check_rule(&s, lane, 3, energy, gradient, (double)(pel_real)0.7);
            }
            if (n % 2 == 0)
                check_momentum(&s, 3);
        }
}

/* each corner goes inward by its number, whatever its mass; one that cannot move stays */
static void test_cave(void **unused)
{
    (void)unused;
    static sample s;
    random_state random = {8};
    make_batch(&s, PEL_CONSTRAINT_CAVE, 3, PEL_CAVE_NUMBERS, 0);
    random_points(&random, &s, 0.2, true);
    for (int lane = 0; lane < PEL_BLOCK; lane++)
        for (int j = 0; j < PEL_CAVE_NUMBERS; j++)
            s.numbers[j * PEL_BLOCK + lane] = (pel_real)random_between(&random, 0, 1);
    project(&s);
    for (int lane = 0; lane < PEL_BLOCK; lane++) {
        double x[4][3], y[4][3], n[3];
        points_of(&s, s.before, lane, x);
        points_of(&s, s.x, lane, y);
        pel_vec3_triangle_normal(x[0], x[1], x[2], n);
        pel_vec3_normalize(n);
        for (int k = 0; k < 3; k++) {
            double way = (double)s.numbers[(PEL_CAVE_WAY + k) * PEL_BLOCK + lane];
            bool moves = s.before[k * PEL_BLOCK + lane][3] > 0;
            for (int i = 0; i < 3; i++)
                assert_near(y[k][i] - x[k][i], moves ? -way * n[i] : 0, sizeof(pel_real) == 8 ? 1e-14 : 1e-6);
        }
    }
}

/* -w n E_A / (k_A sum w) for any masses, at most the bound, counted (by the wide and the plain kernel); nothing where a
   fibre is longer than at rest */
static void test_normal(void **unused)
{
    (void)unused;
    random_state random = {12};
    int cut = 0, free = 0, still = 0;
    for (int n = 0; n < 100; n++) {
        static sample s;
        bool squared = n & 1;
        make_batch(&s, squared ? PEL_CONSTRAINT_NORMAL_SQUARE : PEL_CONSTRAINT_NORMAL, 3, PEL_NORMAL_NUMBERS, 0);
        random_points(&random, &s, 0.2, n % 3 == 0);
        s.batch.law.share = (pel_real)0.7;
        for (int i = 0; i < PEL_BLOCK; i++) {
            const double numbers[PEL_NORMAL_NUMBERS] = {random_between(&random, -1, 1), random_between(&random, -1, 1),
                                                        0.5, 0.03, 2};
            for (int j = 0; j < PEL_NORMAL_NUMBERS; j++)
                s.numbers[j * PEL_BLOCK + i] = (pel_real)numbers[j];
        }
        project(&s);
        for (int lane = 0; lane < PEL_BLOCK; lane++) {
            double x[4][3], y[4][3], normal[3], square = 0, sum = 0, most = 0;
            points_of(&s, s.before, lane, x);
            points_of(&s, s.x, lane, y);
            for (int i = 0; i < 3; i++) {
                double c0 = (double)s.numbers[lane], c1 = (double)s.numbers[PEL_BLOCK + lane];
                square += pow(c0 * (x[0][i] - x[2][i]) + c1 * (x[1][i] - x[2][i]), 2);
            }
            double strain = squared ? square - 1 : sqrt(square) - 1;
            double ratio = strain < 0 ? 0.5 * 0.5 * strain * strain : 0;
            pel_vec3_triangle_normal(x[0], x[1], x[2], normal);
            pel_vec3_normalize(normal);
            for (int k = 0; k < 3; k++)
                sum += (double)s.before[k * PEL_BLOCK + lane][3];
            for (int k = 0; k < 3; k++) {
                double way = sum > 0 ? ratio * (double)s.before[k * PEL_BLOCK + lane][3] / sum : 0;
                most = fmax(most, way);
                for (int i = 0; i < 3; i++)
                    assert_near(y[k][i] - x[k][i], -0.7 * fmin(way, 0.03) * normal[i],
                                sizeof(pel_real) == 8 ? 1e-14 : 1e-6);
            }
            assert_near((double)s.numbers[PEL_NORMAL_LIMITED * PEL_BLOCK + lane], most > 0.03 ? 4 : 2, 0);
            cut += most > 0.03;
            free += most > 0 && most < 0.03;
            still += strain > 0;
        }
    }
    assert_true(cut > 20 && free > 20 && still > 20);
}

static void check_linear_momentum(const sample *s, int count)
{
    for (int lane = 0; lane < PEL_BLOCK; lane++)
        for (int i = 0; i < 3; i++) {
            double sum = 0;
            for (int k = 0; k < count; k++) {
                const pel_record *a = &s->before[k * PEL_BLOCK + lane], *b = &s->x[k * PEL_BLOCK + lane];
                sum += ((double)(*b)[i] - (double)(*a)[i]) / (double)(*a)[3];
            }
            assert_near(sum, 0, 100 * (double)PEL_REAL_EPSILON);
        }
}

/* sweeps bring the principal stretches within the limits, keep momentum and leave what is within them alone */
static void test_limit(void **unused)
{
    (void)unused;
    static sample s;
    random_state random = {12};
    const double least = 0.9, most = 1.1;
    for (int n = 0; n < ROUNDS; n++) {
        pel_rest_triangle rest[PEL_BLOCK];
        make_batch(&s, PEL_CONSTRAINT_LIMIT, 3, 3, 0);
        s.batch.law.least_strain = (pel_real)(0.5 * (least * least - 1));
        s.batch.law.most_strain = (pel_real)(0.5 * (most * most - 1));
        random_points(&random, &s, n % 2 == 0 ? 0.4 : 0.02, false);
        set_rest_triangles(&s, rest);
        project(&s);
        check_linear_momentum(&s, 3);
        if (n % 2 == 1)
            assert_memory_equal(s.before, s.x, sizeof s.x);
        for (int i = 0; i < 40; i++)
            project(&s);
        for (int lane = 0; lane < PEL_BLOCK; lane++) {
            double x[4][3], f[2][3], c[3];
            points_of(&s, s.x, lane, x);
            for (int k = 0; k < 3; k++) {
                double a = x[0][k] - x[2][k], b = x[1][k] - x[2][k];
                f[0][k] = (double)s.numbers[lane] * a;
                f[1][k] = (double)s.numbers[PEL_BLOCK + lane] * a + (double)s.numbers[2 * PEL_BLOCK + lane] * b;
            }
            c[0] = pel_vec3_dot(f[0], f[0]);
            c[1] = pel_vec3_dot(f[1], f[1]);
            c[2] = pel_vec3_dot(f[0], f[1]);
            double radius = hypot((c[0] - c[1]) / 2, c[2]), mean = (c[0] + c[1]) / 2;
            double close = sizeof(pel_real) == 8 ? 1e-6 : 1e-5;
            assert_true(sqrt(mean + radius) < most + close && sqrt(mean - radius) > least - close);
        }
    }
}

/* triangles that are a point, a line, folded over, or all pinned: finite, and no vertex flies away */
static void test_collapsed(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < PEL_CONSTRAINT_PRESSURE; kind++) {
        if (pel_project_wide[kind] == NULL)
            continue;
        for (int shape = 0; shape < 5; shape++) {
            static sample s;
            random_state random = {9};
            bool edge = kind < PEL_CONSTRAINT_MEMBRANE;
            bool hinge = kind >= PEL_CONSTRAINT_ISOMETRIC && kind <= PEL_CONSTRAINT_ANGLE_COMPLIANT;
            bool angle = kind == PEL_CONSTRAINT_ANGLE || kind == PEL_CONSTRAINT_ANGLE_COMPLIANT;
            bool strain = kind >= PEL_CONSTRAINT_STRAIN && kind < PEL_CONSTRAINT_ISOMETRIC;
            bool fibre = kind >= PEL_CONSTRAINT_FIBRE;
            int count = PEL_TRIANGLE_NUMBERS; /* or as many as of a fibre of pbd */
            if (kind >= PEL_CONSTRAINT_MEMBRANE && kind < PEL_CONSTRAINT_ISOMETRIC)
                count = numbers_of((kind - PEL_CONSTRAINT_MEMBRANE) % PEL_MEMBRANE_COUNT);
            if (edge)
                count = 1 + (kind == PEL_CONSTRAINT_SPRING);
            else if (hinge)
                count = angle ? PEL_ANGLE_NUMBERS : PEL_ISOMETRIC_NUMBERS;
            else if (kind == PEL_CONSTRAINT_CAVE)
                count = PEL_CAVE_NUMBERS;
            else if (kind == PEL_CONSTRAINT_NORMAL || kind == PEL_CONSTRAINT_NORMAL_SQUARE)
                count = PEL_NORMAL_NUMBERS;
            else if (kind == PEL_CONSTRAINT_LIMIT || kind >= PEL_CONSTRAINT_FIBRE_COMPLIANT)
                count = 3;
            make_batch(&s, (pel_constraint)kind, edge ? 2 : hinge ? 4 : 3, count, 3);
            random_points(&random, &s, 0, false);
            int material = strain ? kind - PEL_CONSTRAINT_STRAIN : kind - PEL_CONSTRAINT_MEMBRANE;
            if (!edge && !hinge && !fibre)
                set_law(&s.batch, (pel_membrane_kind)material);
            s.batch.law.weight = s.batch.law.square_time = s.batch.law.inverse_square = 1;
            s.batch.law.rest_length = (pel_real)0.1;
            for (int i = 0; i < PEL_CAVE_NUMBERS * PEL_BLOCK; i++)
                s.numbers[i] = (pel_real)(i < PEL_BLOCK || i >= 2 * PEL_BLOCK ? 1 : -0.3);
            for (int i = 0; i < POINTS; i++) {
                int k = i / PEL_BLOCK;
                if (shape == 0)
                    s.x[i] = (pel_record){1, 2, 3, 1};
                else if (shape == 1)
                    s.x[i] = (pel_record){(pel_real)k, 0, 0, 1};
                else if (shape == 2)
                    s.x[i] = (pel_record){(pel_real)(k & 1), (pel_real)(k >> 1), 0, 0};
                else if (shape == 3)
                    s.x[i] = (pel_record){(pel_real)(k & 1), (pel_real)1e-12 * (pel_real)(k >> 1), 0, 1};
                else
                    s.x[i] = (pel_record){(pel_real)(1e-3 * (k & 1)), (pel_real)(2e-3 * (k >> 1)), 0, 1};
            }
            project(&s);
            for (int i = 0; i < POINTS; i++)
                for (int c = 0; c < 3; c++) {
                    if (!(fabs((double)s.x[i][c]) < 30))
                        print_error("kind %d shape %d: %g\n", kind, shape, (double)s.x[i][c]);
                    assert_true(fabs((double)s.x[i][c]) < 30);
                }
        }
    }
}

/* repeated with its multiplier, a compliant constraint ends where the multiplier is -stiffness dt^2 C */
static void test_compliance(void **unused)
{
    (void)unused;
    random_state random = {10};
    const pel_constraint kinds[4] = {PEL_CONSTRAINT_SPRING, PEL_CONSTRAINT_ANGLE_COMPLIANT,
                                     PEL_CONSTRAINT_FIBRE_COMPLIANT, PEL_CONSTRAINT_FIBRE_SQUARE_COMPLIANT};
    const int arities[4] = {2, 4, 3, 3}, counts[4] = {2, 3, 3, 3};
    for (int n = 0; n < ROUNDS; n++)
        for (int c = 0; c < 4; c++) {
            static sample s;
            double stiffness = random_between(&random, 0.1, 2), square_time = random_between(&random, 0.1, 0.5);
            make_batch(&s, kinds[c], arities[c], counts[c], 1);
            s.batch.multipliers = s.multipliers;
            memset(s.multipliers, 0, sizeof s.multipliers);
            random_points(&random, &s, 0.2, false);
            s.batch.law.inverse_square = (pel_real)(1 / square_time);
            s.batch.law.rest_length = (pel_real)0.8;
            for (int lane = 0; lane < PEL_BLOCK; lane++) {
                s.numbers[lane] = (pel_real)(c == 0 ? 0.9 : c == 1 ? cos(0.3) : 1.1);
                s.numbers[PEL_BLOCK + lane] = (pel_real)(c == 0 ? 1 / stiffness : c == 1 ? sin(0.3) : 0.2);
                s.numbers[2 * PEL_BLOCK + lane] = (pel_real)(1 / stiffness);
            }
            for (int i = 0; i < 100; i++)
                project(&s);
            for (int lane = 0; lane < PEL_BLOCK; lane++) {
                double x[4][3], value, square = 0, edge = 0;
                points_of(&s, s.x, lane, x);
                for (int i = 0; i < 3; i++) {
                    double image = (double)s.numbers[lane] * (x[0][i] - x[2][i]) +
                                   (double)s.numbers[PEL_BLOCK + lane] * (x[1][i] - x[2][i]);
                    square += image * image;
                    edge += (x[1][i] - x[0][i]) * (x[1][i] - x[0][i]);
                }
                value = c == 0   ? sqrt(edge) - 0.9
                        : c == 1 ? pel_dihedral_angle((const double(*)[3])x, NULL) - 0.3
                        : c == 2 ? sqrt(square) - 0.8
                                 : square - 1;
                assert_near((double)s.multipliers[lane], -stiffness * square_time * value,
                            sizeof(pel_real) == 8 ? 1e-7 : 1e-4);
            }
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_energy_constraints),
        cmocka_unit_test(test_energy_falls_to_a_quarter),
        cmocka_unit_test(test_strain_forms_reach_the_stress),
        cmocka_unit_test(test_bending),
        cmocka_unit_test(test_fibres),
        cmocka_unit_test(test_limit),
        cmocka_unit_test(test_cave),
        cmocka_unit_test(test_normal),
        cmocka_unit_test(test_compliance),
        cmocka_unit_test(test_collapsed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
