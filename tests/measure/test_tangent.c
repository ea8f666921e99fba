/* Tangents of single elements: gradients and Hessians against finite differences, invariance, mixed stresses, and the
   positive parts, in one loop over all elements and laws. */
#define PEL_LANE_DOUBLE
#include "check.h"
#include "dense.h"
#include "gradient.h"
#include "random.h"

#include "law_forms.h"
#include "math/vec3.h"
#include "measure/face_turn.h"
#include "measure/midedge.h"
#include "measure/tangent.h"

/* an element with its unknowns: vertices, and rotations of edges for mid-edge bending */
typedef struct element {
    const char *name;
    int vertices, unknowns, strains;
    pel_rest_triangle rest;
    pel_membrane_law law;
    pel_line line;
    pel_hinge hinge;
    pel_yield yield;
    pel_midedge midedge;
    double reference[9], alpha[3], sign[3]; /* of mid-edge bending */
    double pressure;
    double (*tangent)(const struct element *e, const double *x, const pel_tangent_request *request,
                      const pel_tangent_sum *sum);
    double rest_shape[12];
    bool symmetric_part; /* the Hessian is the symmetric part of the derivative of the gradient */
    bool is_viscous;
    double viscous[3 * PEL_VISCOUS_NUMBERS];
} element;

static pel_tangent_request request_of(const element *e)
{
    return (pel_tangent_request){.viscous = e->is_viscous ? e->viscous : NULL, .rate = 1.6};
}

static double tangent_membrane(const element *e, const double *x, const pel_tangent_request *request,
                               const pel_tangent_sum *sum)
{
    return pel_membrane_tangent(&e->rest, &e->law, x, request, sum);
}

static double tangent_line(const element *e, const double *x, const pel_tangent_request *request,
                           const pel_tangent_sum *sum)
{
    return pel_line_tangent(&e->line, x, request, sum);
}

static double tangent_hinge(const element *e, const double *x, const pel_tangent_request *request,
                            const pel_tangent_sum *sum)
{
    return pel_hinge_tangent(&e->hinge, 0.7, x, request, sum);
}

static double tangent_fold(const element *e, const double *x, const pel_tangent_request *request,
                           const pel_tangent_sum *sum)
{
    return pel_fold_tangent(&e->hinge, &e->yield, 0.7, x, request, sum);
}

static double tangent_pressure(const element *e, const double *x, const pel_tangent_request *request,
                               const pel_tangent_sum *sum)
{
    return pel_pressure_tangent(e->pressure, x, request, sum);
}

static double tangent_push(const element *e, const double *x, const pel_tangent_request *request,
                           const pel_tangent_sum *sum)
{
    return pel_push_tangent(&e->line, e->pressure, x, request, sum);
}

/* without a potential that the energy tells */
static bool has_potential(const element *e)
{
    return e->tangent != tangent_pressure && e->tangent != tangent_push;
}

/* strains at x as reached from the reference in one finite step */
static pel_face_turn turn_of(const double x[3][3])
{
    return pel_face_turn_of((pel_lane3){x[0][0], x[0][1], x[0][2]}, (pel_lane3){x[1][0], x[1][1], x[1][2]},
                            (pel_lane3){x[2][0], x[2][1], x[2][2]});
}

static double finite_turn(const double before[3][3], const double after[3][3])
{
    const pel_face_turn first = turn_of(before), last = turn_of(after);
    return pel_face_turn_between(&first, &last);
}

static double tangent_midedge(const element *e, const double *x, const pel_tangent_request *request,
                              const pel_tangent_sum *sum)
{
    double alpha[3];
    for (int l = 0; l < 3; l++) {
        double before[3][3], after[3][3];
        for (int k = 0; k < 3; k++)
            for (int c = 0; c < 3; c++) {
                before[k][c] = e->reference[3 * ((l + k) % 3) + c];
                after[k][c] = x[3 * ((l + k) % 3) + c];
            }
        alpha[l] =
            e->alpha[l] + finite_turn((const double(*)[3])before, (const double(*)[3])after) + e->sign[l] * x[9 + l];
    }
    return pel_midedge_tangent(&e->midedge, alpha, e->sign, x, request, sum);
}

static double energy_of(const void *context, const double *x)
{
    const element *e = context;
    const pel_tangent_request request = request_of(e);
    const pel_tangent_sum none = {0};
    return e->tangent(e, x, &request, &none);
}

typedef struct component {
    const element *e;
    int number;
} component;

static double gradient_component(const void *context, const double *x)
{
    const component *of = context;
    const pel_tangent_request request = request_of(of->e);
    double gradient[PEL_TANGENT_UNKNOWNS] = {0};
    const pel_tangent_sum sum = {.gradient = gradient};
    of->e->tangent(of->e, x, &request, &sum);
    return gradient[of->number];
}

static void evaluate(const element *e, const double *x, const pel_tangent_request *request, double *gradient,
                     double hessian[12][12])
{
    const pel_tangent_sum sum = {gradient, &hessian[0][0], 12};
    memset(gradient, 0, 12 * sizeof *gradient);
    memset(hessian, 0, 144 * sizeof(double));
    e->tangent(e, x, request, &sum);
}

static double largest(const double *a, int n)
{
    double size = 0;
    for (int i = 0; i < n; i++)
        size = fmax(size, fabs(a[i]));
    return size;
}

/* ---- elements ---- */

static void random_triangle(random_state *random, double x[9])
{
    static const double corner[9] = {0, 0, 0, 1, 0, 0, 0.3, 0.9, 0};
    double rotation[9];
    random_rotation(random, rotation);
    for (int a = 0; a < 3; a++)
        for (int c = 0; c < 3; c++)
            x[3 * a + c] = 0.5 + rotation[3 * c] * corner[3 * a] + rotation[3 * c + 1] * corner[3 * a + 1] +
                           random_between(random, -0.15, 0.15);
}

static void set_rest(element *e, random_state *random)
{
    double rest[3][3];
    random_triangle(random, e->rest_shape);
    memcpy(rest, e->rest_shape, sizeof rest);
    assert_true(pel_rest_triangle_setup((const double(*)[3])rest, &e->rest));
}

static element membrane_element(int kind, random_state *random)
{
    element e = {.vertices = 3, .unknowns = 9, .strains = 3, .tangent = tangent_membrane};
    pel_membrane_material material = law_material(kind, 2, 0.35, 0.5);
    /* differences want no kinks of a curve */
    material.warp_curve[1][0] = material.weft_curve[1][0] = 0;
    e.name = pel_membrane_kind_name(material.kind);
    e.law = pel_membrane_law_of(&material);
    set_rest(&e, random);
    return e;
}

static element fibre_element(bool squared, double rest_length, random_state *random)
{
    element e = {.name = squared ? "fibre squared" : "fibre", .vertices = 3, .unknowns = 9, .strains = 1};
    double angle = random_between(random, 0, 6);
    const double direction[2] = {cos(angle), sin(angle)};
    set_rest(&e, random);
    e.tangent = tangent_line;
    e.line = pel_line_of_fibre(&e.rest, squared, 1.7, rest_length, direction);
    return e;
}

static element spring_element(random_state *random)
{
    element e = {.name = "spring", .vertices = 2, .unknowns = 6, .strains = 1, .tangent = tangent_line};
    double square = 0;
    for (int i = 0; i < 6; i++)
        e.rest_shape[i] = random_between(random, 0.5, 2);
    for (int c = 0; c < 3; c++)
        square += (e.rest_shape[3 + c] - e.rest_shape[c]) * (e.rest_shape[3 + c] - e.rest_shape[c]);
    e.line = pel_line_of_spring(3, sqrt(square));
    return e;
}

/* two triangles with an angle between them */
static void set_pair(element *e, double rest[4][3], random_state *random)
{
    static const double corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0.4, 0.8, 0.1}, {0.6, -0.7, 0.2}};
    e->vertices = 4;
    e->unknowns = 12;
    for (int a = 0; a < 4; a++)
        for (int c = 0; c < 3; c++)
            e->rest_shape[3 * a + c] = rest[a][c] = corner[a][c] + random_between(random, -0.1, 0.1);
}

static element hinge_element(random_state *random)
{
    element e = {.name = "hinge", .strains = 1, .tangent = tangent_hinge};
    double rest[4][3];
    set_pair(&e, rest, random);
    assert_true(pel_hinge_setup((const double(*)[3])rest, &e.hinge));
    return e;
}

/* yields at once, or never */
static element fold_element(double angle, random_state *random)
{
    element e = hinge_element(random);
    e.name = angle > 1 ? "fold that stands" : "fold that yields";
    e.tangent = tangent_fold;
    e.yield = (pel_yield){angle, pel_fold_share(0.3)};
    return e;
}

static element isometric_element(random_state *random)
{
    element e = {.name = "isometric", .strains = 0, .tangent = tangent_line};
    double rest[4][3];
    pel_bending_isometric stencil;
    set_pair(&e, rest, random);
    assert_true(pel_bending_isometric_setup((const double(*)[3])rest, &stencil));
    e.line = pel_line_of_isometric(&stencil, 0.9);
    return e;
}

static element pressure_element(random_state *random)
{
    element e = {.name = "pressure", .vertices = 3, .unknowns = 9, .tangent = tangent_pressure, .pressure = 1.3};
    set_rest(&e, random);
    e.symmetric_part = true;
    return e;
}

static element push_element(bool squared, random_state *random)
{
    element e = fibre_element(squared, 1, random);
    e.name = squared ? "push, squared" : "push";
    e.strains = 0;
    e.tangent = tangent_push;
    e.pressure = 0.8;
    e.symmetric_part = true;
    return e;
}

static element midedge_element(random_state *random)
{
    element e = {.name = "midedge", .vertices = 3, .unknowns = 12, .strains = 3, .tangent = tangent_midedge};
    set_rest(&e, random);
    /* an orthotropic plate, turned in the frame of the triangle */
    const pel_plate plate = {0.4, 0.2, 0.3, {0.6, 0.8}};
    e.midedge = pel_midedge_setup(&e.rest, 0.8, &plate);
    for (int l = 0; l < 3; l++)
        e.sign[l] = random_bits(random) & 1 ? 1 : -1;
    memcpy(e.reference, e.rest_shape, sizeof e.reference);
    e.symmetric_part = true;
    return e;
}

enum { ELEMENT_COUNT = PEL_MEMBRANE_COUNT + 12 };

static element make_element(int number, random_state *random)
{
    switch (number - PEL_MEMBRANE_COUNT) {
    case 0:
        return fibre_element(false, 1, random);
    case 1:
        return fibre_element(false, 0.7, random);
    case 2:
        return fibre_element(true, 1, random);
    case 3:
        return spring_element(random);
    case 4:
        return hinge_element(random);
    case 5:
        return isometric_element(random);
    case 6:
        return pressure_element(random);
    case 7:
        return midedge_element(random);
    case 8:
        return push_element(false, random);
    case 9:
        return push_element(true, random);
    case 10:
        return fold_element(1e-3, random);
    case 11:
        return fold_element(3, random);
    default:
        return membrane_element(number, random);
    }
}

/* a strained, turned state: stretched or squeezed to between 0.6 and 1.5, and moved about */
static void deform(element *e, random_state *random, double *x)
{
    double r[9], stretch = random_between(random, 0.6, 1.5);
    random_rotation(random, r);
    memset(x, 0, 12 * sizeof *x);
    for (int a = 0; a < e->vertices; a++)
        for (int c = 0; c < 3; c++) {
            const double *p = e->rest_shape + 3 * a;
            x[3 * a + c] = 0.3 * c + stretch * (r[3 * c] * p[0] + r[3 * c + 1] * p[1] + r[3 * c + 2] * p[2]) +
                           random_between(random, -0.12, 0.12);
        }
    memcpy(e->reference, x, sizeof e->reference);
    for (int l = 0; l < 3; l++)
        e->alpha[l] = random_between(random, -0.6, 0.6);
}

/* every other element: a positive viscosity, and strains that rates refer to */
static void make_viscous(element *e, int round)
{
    random_state random = {(uint64_t)round};
    e->is_viscous = round % 2 == 1;
    for (int i = 0; i < e->strains; i++) {
        double *row = e->viscous + PEL_VISCOUS_NUMBERS * i;
        row[0] = random_between(&random, -0.3, 0.3);
        for (int j = 0; j < 3; j++)
            row[1 + j] = i == j ? 1.1 + i : 0.2 * (i + j);
    }
}

/* the strains and stiffnesses that an element writes are what a viscous one refers to: without a rate of strain it is
   elastic, and its viscous stress is the retardation times the change of the stress by the same strain again */
static void rates_refer_to_written_strains(void **unused)
{
    (void)unused;
    random_state random = {9};
    for (int number = 0; number < ELEMENT_COUNT; number++) {
        element e = make_element(number, &random);
        double x[12], elastic[12], viscous[12], hessian[2][12][12], written[12] = {0};
        deform(&e, &random, x);
        if (!has_potential(&e) || e.strains == 0)
            continue;
        pel_tangent_request request = {.kind = PEL_TANGENT_POSITIVE, .strain = written};
        evaluate(&e, x, &request, elastic, hessian[0]);
        request = (pel_tangent_request){.viscous = written, .rate = 3};
        evaluate(&e, x, &request, viscous, hessian[1]);
        for (int i = 0; i < e.unknowns; i++)
            assert_near(viscous[i], elastic[i], 1e-13 * (largest(elastic, 12) + 1));
        for (int i = 0; i < e.strains; i++) {
            assert_true(written[PEL_VISCOUS_NUMBERS * i + 1 + i] > 0);
            written[PEL_VISCOUS_NUMBERS * i] -= 0.01;
        }
        const pel_tangent_sum none = {0};
        const pel_tangent_request plain = {0};
        double expected = 0;
        for (int i = 0; i < e.strains; i++)
            for (int j = 0; j < e.strains; j++)
                expected += 0.5 * 3 * 1e-4 * written[PEL_VISCOUS_NUMBERS * i + 1 + j];
        assert_near(e.tangent(&e, x, &request, &none) - e.tangent(&e, x, &plain, &none), expected, 1e-12);
    }
}

/* ---- tests ---- */

static void gradients_are_those_of_energies(void **unused)
{
    (void)unused;
    random_state random = {1};
    for (int number = 0; number < ELEMENT_COUNT; number++)
        for (int round = 0; round < ROUNDS(30, 3); round++) {
            element e = make_element(number, &random);
            double x[12], gradient[12], hessian[12][12];
            deform(&e, &random, x);
            if (!has_potential(&e))
                continue; /* its gradient is that of a closed surface: see below */
            make_viscous(&e, round);
            const pel_tangent_request request = request_of(&e);
            evaluate(&e, x, &request, gradient, hessian);
            double size = largest(gradient, e.unknowns) + 1e-3;
            for (int i = 0; i < e.unknowns; i++) {
                double expected = numeric_derivative(energy_of, &e, x, i, 1e-3);
                if (!(fabs(gradient[i] - expected) <= 1e-8 * size))
                    print_error("%s round %d unknown %d\n", e.name, round, i);
                assert_near(gradient[i], expected, 1e-8 * size);
            }
        }
}

static void hessians_are_those_of_gradients(void **unused)
{
    (void)unused;
    random_state random = {3}; /* no difference meets the kink of a push */
    for (int number = 0; number < ELEMENT_COUNT; number++)
        for (int round = 0; round < ROUNDS(30, 3); round++) {
            element e = make_element(number, &random);
            double x[12], gradient[12], hessian[12][12], numeric[12][12];
            deform(&e, &random, x);
            make_viscous(&e, round);
            const pel_tangent_request request = request_of(&e);
            evaluate(&e, x, &request, gradient, hessian);
            double size = largest(&hessian[0][0], 144);
            for (int i = 0; i < e.unknowns; i++)
                for (int j = 0; j < e.unknowns; j++) {
                    const component of = {&e, i};
                    numeric[i][j] = numeric_derivative(gradient_component, &of, x, j, 1e-3);
                }
            for (int i = 0; i < e.unknowns; i++)
                for (int j = 0; j < e.unknowns; j++) {
                    double expected = e.symmetric_part ? 0.5 * (numeric[i][j] + numeric[j][i]) : numeric[i][j];
                    if (!(fabs(hessian[i][j] - expected) <= 1e-8 * size))
                        print_error("%s round %d entry %d %d\n", e.name, round, i, j);
                    assert_near(hessian[i][j], expected, 1e-8 * size);
                }
        }
}

/* second differences of the energy along a line: the Hessian is also that of finite steps in psi */
static void midedge_hessian_is_that_of_finite_steps(void **unused)
{
    (void)unused;
    random_state random = {3};
    for (int round = 0; round < 50; round++) {
        element e = midedge_element(&random);
        double x[12], gradient[12], hessian[12][12], direction[12], expected = 0, values[3];
        deform(&e, &random, x);
        const pel_tangent_request request = {0};
        evaluate(&e, x, &request, gradient, hessian);
        for (int i = 0; i < 12; i++)
            direction[i] = random_normal(&random);
        for (int i = 0; i < 12; i++)
            for (int j = 0; j < 12; j++)
                expected += direction[i] * hessian[i][j] * direction[j];
        for (int k = 0; k < 3; k++) {
            double step = 4e-3 / (1 << k), sum = -2 * energy_of(&e, x);
            for (int side = -1; side <= 1; side += 2) {
                double moved[12];
                for (int i = 0; i < 12; i++)
                    moved[i] = x[i] + side * step * direction[i];
                sum += energy_of(&e, moved);
            }
            values[k] = sum / (step * step);
        }
        double first = (4 * values[1] - values[0]) / 3, second = (4 * values[2] - values[1]) / 3;
        assert_near((16 * second - first) / 15, expected, 1e-6 * largest(&hessian[0][0], 144) * 12);
    }
}

/* over any step, however large, both triangles of an edge together turn by the change of the dihedral angle, and the
   angle to a normal that goes with the edge changes by the turn */
static void finite_turns_add_up(void **unused)
{
    (void)unused;
    random_state random = {10};
    const double turn = 2 * acos(-1.0);
    for (int round = 0; round < 200; round++) {
        double x[2][4][3], triangle[2][2][3][3], normal[3];
        for (int time = 0; time < 2; time++) {
            for (int i = 0; i < 12; i++)
                x[time][i / 3][i % 3] = random_normal(&random);
            static const int corners[2][3] = {{0, 1, 2}, {1, 0, 3}};
            for (int side = 0; side < 2; side++)
                for (int k = 0; k < 3; k++)
                    pel_vec3_copy(x[time][corners[side][k]], triangle[time][side][k]);
        }
        double sum = 0;
        for (int side = 0; side < 2; side++)
            sum += finite_turn((const double(*)[3])triangle[0][side], (const double(*)[3])triangle[1][side]);
        double change =
            pel_dihedral_angle((const double(*)[3])x[1], NULL) - pel_dihedral_angle((const double(*)[3])x[0], NULL);
        assert_near(remainder(sum - change, turn), 0, 1e-11);
        /* the edge stays: its frame does too */
        pel_vec3_copy(x[0][0], triangle[1][0][0]);
        pel_vec3_copy(x[0][1], triangle[1][0][1]);
        pel_vec3_triangle_normal(x[0][0], x[0][1], x[1][3], normal);
        double angle[2];
        for (int time = 0; time < 2; time++)
            angle[time] = pel_midedge_angle((const double(*)[3])triangle[time][0], normal);
        double turned = finite_turn((const double(*)[3])triangle[0][0], (const double(*)[3])triangle[1][0]);
        assert_near(remainder(angle[1] - angle[0] - turned, turn), 0, 1e-11);
    }
}

/* a rigid motion turns the gradient with the element: H (omega x x) = omega x gradient, and H applied to a shift is 0;
   at rest without stress both are 0 */
static void check_rigid(element *e, const double *x, random_state *random)
{
    double gradient[12], hessian[12][12], omega[3], mode[12] = {0}, turned[12] = {0};
    const pel_tangent_request request = {0};
    evaluate(e, x, &request, gradient, hessian);
    double size = largest(&hessian[0][0], 144);
    for (int c = 0; c < 3; c++)
        omega[c] = random_normal(random);
    for (int a = 0; a < e->vertices; a++) {
        pel_vec3_cross(omega, x + 3 * a, mode + 3 * a);
        pel_vec3_cross(omega, gradient + 3 * a, turned + 3 * a);
    }
    for (int i = 0; i < e->unknowns; i++) {
        double sum = 0, shift[3] = {0, 0, 0};
        for (int j = 0; j < e->unknowns; j++)
            sum += hessian[i][j] * mode[j];
        for (int j = 0; j < 3 * e->vertices; j++)
            shift[j % 3] += hessian[i][j];
        double tolerance = 1e-12 * size * 20;
        if (e->tangent != tangent_midedge) /* whose frames turn with the edges */
            assert_near(sum, turned[i], tolerance);
        for (int c = 0; c < 3; c++)
            assert_near(shift[c], 0, tolerance);
    }
}

static void rigid_motions_change_nothing(void **unused)
{
    (void)unused;
    random_state random = {4};
    for (int number = 0; number < ELEMENT_COUNT; number++)
        for (int round = 0; round < 20; round++) {
            element e = make_element(number, &random);
            double x[12];
            deform(&e, &random, x);
            make_viscous(&e, round);
            if (has_potential(&e))
                check_rigid(&e, x, &random);
        }
}

/* at rest the Hessian is positive semi-definite, the kinds agree, and rigid modes have no energy */
static void rest_shapes_are_free_of_stress(void **unused)
{
    (void)unused;
    random_state random = {5};
    for (int number = 0; number < ELEMENT_COUNT; number++) {
        element e = make_element(number, &random);
        if (!has_potential(&e) || e.strains == 0 || (e.line.kind == PEL_LINE_LENGTH && e.line.rest == 0.7))
            continue; /* not at rest there */
        double gradient[12], hessian[12][12], positive[12][12], x[12] = {0}, omega[3], mode[12] = {0};
        memcpy(x, e.rest_shape, sizeof(double) * 3 * (size_t)e.vertices);
        pel_tangent_request request = {0};
        evaluate(&e, x, &request, gradient, hessian);
        double size = largest(&hessian[0][0], 144);
        assert_near(largest(gradient, 12), 0, 1e-13 * size);
        request.kind = PEL_TANGENT_POSITIVE;
        evaluate(&e, x, &request, gradient, positive);
        for (int c = 0; c < 3; c++)
            omega[c] = random_normal(&random);
        for (int a = 0; a < e.vertices; a++)
            pel_vec3_cross(omega, x + 3 * a, mode + 3 * a);
        for (int l = 0; e.tangent == tangent_midedge && l < 3; l++) {
            double along[3];
            pel_vec3_subtract(x + 3 * ((l + 1) % 3), x + 3 * l, along);
            pel_vec3_normalize(along);
            mode[9 + l] = e.sign[l] * pel_vec3_dot(omega, along);
        }
        for (int i = 0; i < e.unknowns; i++) {
            double sum = 0;
            for (int j = 0; j < e.unknowns; j++) {
                assert_near(positive[i][j], hessian[i][j], 1e-12 * size);
                sum += hessian[i][j] * mode[j];
            }
            assert_near(sum, 0, 1e-12 * size * 20);
        }
    }
}

static void positive_parts_are_positive(void **unused)
{
    (void)unused;
    random_state random = {6};
    int indefinite = 0;
    for (int number = 0; number < ELEMENT_COUNT; number++)
        for (int round = 0; round < ROUNDS(50, 5); round++) {
            element e = make_element(number, &random);
            double x[12], gradient[12], hessian[12][12], dense[144];
            deform(&e, &random, x);
            for (int kind = 0; kind < 2; kind++) {
                const pel_tangent_request request = {.kind = kind == 0 ? PEL_TANGENT_POSITIVE : PEL_TANGENT_EXACT};
                evaluate(&e, x, &request, gradient, hessian);
                double shift = 1e-9 * (largest(&hessian[0][0], 144) + 1e-30);
                for (int i = 0; i < e.unknowns; i++)
                    for (int j = 0; j < e.unknowns; j++)
                        dense[i * e.unknowns + j] = hessian[i][j] + (i == j ? shift : 0);
                bool definite = dense_factor(dense, e.unknowns);
                if (kind == 0)
                    assert_true(definite);
                indefinite += !definite;
            }
        }
    assert_true(indefinite > ROUNDS(100, 10)); /* squeezed and bent states are among them */
}

/* stresses over a step: exact to first order, those of x without a step, and linear in the geometric part */
static void stresses_extrapolate(void **unused)
{
    (void)unused;
    random_state random = {7};
    for (int number = 0; number < ELEMENT_COUNT; number++) {
        element e = make_element(number, &random);
        if (e.strains == 0)
            continue;
        double x[12], gradient[12], own[12][12], mixed[12][12], twice[12][12], step[12], stress[3][3], ahead[3];
        const double zero[12] = {0}, h = 1e-4;
        deform(&e, &random, x);
        for (int i = 0; i < 12; i++)
            step[i] = random_between(&random, -1, 1);
        pel_tangent_request request = {.step = zero, .extrapolated = stress[0]};
        evaluate(&e, x, &request, gradient, own);
        request.step = step;
        request.extrapolated = ahead;
        evaluate(&e, x, &request, gradient, own);
        for (int side = 0; side < 2; side++) {
            double moved[12];
            for (int i = 0; i < 12; i++)
                moved[i] = x[i] + (side == 0 ? h : -h) * step[i];
            const pel_tangent_request there = {.step = zero, .extrapolated = stress[1 + side]};
            evaluate(&e, moved, &there, gradient, mixed);
        }
        double size = largest(ahead, e.strains) + largest(stress[0], e.strains);
        for (int i = 0; i < e.strains; i++)
            assert_near(ahead[i] - stress[0][i], (stress[1][i] - stress[2][i]) / (2 * h), 1e-5 * size);
        const pel_tangent_request with_own = {.stress = stress[0]};
        evaluate(&e, x, &with_own, gradient, mixed);
        for (int i = 0; i < e.strains; i++)
            stress[1][i] = 2 * stress[0][i];
        const pel_tangent_request with_twice = {.stress = stress[1]};
        evaluate(&e, x, &with_twice, gradient, twice);
        for (int i = 0; i < e.strains; i++)
            stress[2][i] = 0;
        const pel_tangent_request without = {.stress = stress[2]};
        double none[12][12];
        evaluate(&e, x, &without, gradient, none);
        double scale = largest(&twice[0][0], 144);
        for (int i = 0; i < 144; i++) {
            assert_near((&mixed[0][0])[i], (&own[0][0])[i], 1e-13 * scale);
            assert_near((&twice[0][0])[i] - (&own[0][0])[i], (&own[0][0])[i] - (&none[0][0])[i], 1e-12 * scale);
        }
        double geometric = 0;
        for (int i = 0; i < 144; i++)
            geometric = fmax(geometric, fabs((&own[0][0])[i] - (&none[0][0])[i]));
        assert_true(geometric > 1e-3 * scale);
    }
}

/* the surface of a tetrahedron: the sum of the triangles is the volume's gradient and Hessian */
typedef struct tetrahedron {
    double pressure;
} tetrahedron;

static const int sides[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

static double tetrahedron_sum(const tetrahedron *own, const double *x, double gradient[12], double hessian[12][12])
{
    const pel_tangent_request request = {0};
    double energy = 0;
    for (int s = 0; s < 4; s++) {
        double corner[9], g[9] = {0}, h[9][9];
        memset(h, 0, sizeof h);
        for (int i = 0; i < 9; i++)
            corner[i] = x[3 * sides[s][i / 3] + i % 3];
        const pel_tangent_sum sum = {g, &h[0][0], 9};
        energy += pel_pressure_tangent(own->pressure, corner, &request, &sum);
        for (int i = 0; i < 9; i++) {
            gradient[3 * sides[s][i / 3] + i % 3] += g[i];
            for (int j = 0; j < 9; j++)
                hessian[3 * sides[s][i / 3] + i % 3][3 * sides[s][j / 3] + j % 3] += h[i][j];
        }
    }
    return energy;
}

static double tetrahedron_energy(const void *context, const double *x)
{
    double gradient[12] = {0}, hessian[12][12] = {{0}};
    return tetrahedron_sum(context, x, gradient, hessian);
}

typedef struct tetrahedron_component {
    const tetrahedron *own;
    int number;
} tetrahedron_component;

static double tetrahedron_gradient(const void *context, const double *x)
{
    const tetrahedron_component *of = context;
    double gradient[12] = {0}, hessian[12][12] = {{0}};
    tetrahedron_sum(of->own, x, gradient, hessian);
    return gradient[of->number];
}

static void pressure_on_a_closed_surface_has_a_potential(void **unused)
{
    (void)unused;
    random_state random = {8};
    const tetrahedron own = {1.7};
    double x[12], gradient[12] = {0}, hessian[12][12] = {{0}};
    for (int i = 0; i < 12; i++)
        x[i] = random_between(&random, 2, 3);
    tetrahedron_sum(&own, x, gradient, hessian);
    for (int i = 0; i < 12; i++) {
        assert_near(gradient[i], numeric_derivative(tetrahedron_energy, &own, x, i, 1e-2), 1e-10);
        for (int j = 0; j < 12; j++) {
            const tetrahedron_component of = {&own, i};
            assert_near(hessian[i][j], numeric_derivative(tetrahedron_gradient, &of, x, j, 1e-2), 1e-10);
        }
    }
}

/* triangles squeezed to lines and points, and springs of no length give finite numbers */
static void collapsed_elements_are_finite(void **unused)
{
    (void)unused;
    random_state random = {9};
    for (int number = 0; number < ELEMENT_COUNT; number++)
        for (int shape = 0; shape < 3; shape++)
            for (int kind = 0; kind < 2; kind++) {
                element e = make_element(number, &random);
                double x[12] = {0}, gradient[12], hessian[12][12];
                for (int a = 0; a < e.vertices; a++) {
                    x[3 * a] = shape == 0 ? 0 : shape == 1 ? a : e.rest_shape[3 * a];
                    x[3 * a + 1] = shape == 2 ? 1e-9 * e.rest_shape[3 * a + 1] : 0;
                }
                memcpy(e.reference, x, sizeof e.reference);
                const pel_tangent_request request = {.kind = (pel_tangent_kind)kind};
                evaluate(&e, x, &request, gradient, hessian);
                for (int i = 0; i < 144; i++)
                    assert_true(isfinite((&hessian[0][0])[i]) && isfinite(gradient[i % 12]));
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gradients_are_those_of_energies),
        cmocka_unit_test(hessians_are_those_of_gradients),
        cmocka_unit_test(rates_refer_to_written_strains),
        cmocka_unit_test(midedge_hessian_is_that_of_finite_steps),
        cmocka_unit_test(finite_turns_add_up),
        cmocka_unit_test(rigid_motions_change_nothing),
        cmocka_unit_test(rest_shapes_are_free_of_stress),
        cmocka_unit_test(positive_parts_are_positive),
        cmocka_unit_test(stresses_extrapolate),
        cmocka_unit_test(pressure_on_a_closed_surface_has_a_potential),
        cmocka_unit_test(collapsed_elements_are_finite),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
