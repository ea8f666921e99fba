#include "law_forms.h"
#include "stencil.h"

#include "measure/element.h"
#include "pellicle/shape.h"

enum { TRIALS = 200, KIND_COUNT = PEL_MEMBRANE_COUNT };

typedef struct membrane {
    pel_rest_triangle triangle;
    pel_membrane_material material;
    int fibre; /* 0 = membrane, 1 .. 3 = a fibre kind, 4 = active */
    double direction[2];
} membrane;

static double energy_of(const membrane *one, const double x[3][3], double gradient[3][3])
{
    if (one->fibre == 0)
        return pel_membrane_energy(&one->triangle, &one->material, x, gradient);
    if (one->fibre == 4)
        return pel_fibre_active_energy(&one->triangle, 2, 0.7, one->direction, x, gradient);
    return pel_fibre_energy(&one->triangle, (pel_fibre_kind)(one->fibre - 1), 2, one->direction, x, gradient);
}

static double energy_only(const void *context, const double *x)
{
    return energy_of(context, (const double(*)[3])x, NULL);
}

static void random_triangle(random_state *random, double x[3][3])
{
    double normal[3], least, greatest;
    do {
        greatest = 0;
        for (int a = 0; a < 3; a++)
            for (int i = 0; i < 3; i++)
                x[a][i] = random_normal(random);
        for (int a = 0; a < 3; a++)
            greatest = fmax(greatest, pel_vec3_distance(x[a], x[(a + 1) % 3]));
        pel_vec3_triangle_normal(x[0], x[1], x[2], normal);
        least = pel_vec3_length(normal) / greatest;
    } while (least < 0.4);
}

static membrane random_membrane(random_state *random, int variant, double rest[3][3], double x[3][3])
{
    membrane one = {.fibre = variant < KIND_COUNT ? 0 : variant - KIND_COUNT + 1};
    one.material = law_material(variant < KIND_COUNT ? variant : 0, 4, 0.3, 0.5);
    random_triangle(random, rest);
    assert_true(pel_rest_triangle_setup((const double(*)[3])rest, &one.triangle));
    const double vector[3] = {random_normal(random), random_normal(random), random_normal(random)};
    assert_true(pel_rest_triangle_direction((const double(*)[3])rest, vector, one.direction));
    double normal[3], area;
    do {
        stencil_move(random, 3, (const double(*)[3])rest, x);
        for (int a = 0; a < 3; a++)
            for (int i = 0; i < 3; i++)
                x[a][i] += 0.15 * random_normal(random);
        pel_vec3_triangle_normal(x[0], x[1], x[2], normal);
        area = 0.5 * pel_vec3_length(normal);
    } while (area < 0.4 * one.triangle.area || area > 2.5 * one.triangle.area);
    return one;
}

static bool is_near_kink(const membrane *one, const double x[3][3])
{
    double f[6], strain[3] = {-0.5, -0.5, 0};
    pel_deformation_gradient(&one->triangle, x, f);
    for (int i = 0; i < 3; i++) {
        strain[0] += 0.5 * f[2 * i] * f[2 * i];
        strain[1] += 0.5 * f[2 * i + 1] * f[2 * i + 1];
        strain[2] += f[2 * i] * f[2 * i + 1];
    }
    return law_is_near_kink(&one->material, strain, 0.03);
}

static void test_gradients(void **unused)
{
    (void)unused;
    random_state random = {41};
    for (int variant = 0; variant < KIND_COUNT + 4; variant++) {
        double worst = 0, load = 0;
        for (int trial = 0; trial < TRIALS; trial++) {
            double rest[3][3], x[3][3], gradient[3][3];
            membrane one = random_membrane(&random, variant, rest, x);
            const double(*points)[3] = (const double(*)[3])x;
            if (variant < KIND_COUNT && is_near_kink(&one, points))
                continue;
            double energy = energy_of(&one, points, gradient);
            assert_near(energy, energy_of(&one, points, NULL), 0);
            const double(*rows)[3] = (const double(*)[3])gradient;
            worst = fmax(worst, stencil_gradient_error(energy_only, &one, 3, points, rows, 2e-3));
            load = fmax(load, stencil_net_load(3, points, rows));
        }
        print_message("variant %d: gradient error %.1e, net load %.1e\n", variant, worst, load);
        assert_true(worst < 1e-8);
        assert_true(load < 1e-13);
    }
}

/* moved rigidly: same energy; at rest, wherever it lies: none and no force */
static void test_invariance(void **unused)
{
    (void)unused;
    random_state random = {42};
    for (int variant = 0; variant < KIND_COUNT + 4; variant++)
        for (int trial = 0; trial < TRIALS; trial++) {
            double rest[3][3], x[3][3], moved[3][3], gradient[3][3];
            membrane one = random_membrane(&random, variant, rest, x);
            stencil_move(&random, 3, (const double(*)[3])x, moved);
            double energy = energy_of(&one, (const double(*)[3])x, NULL);
            assert_near(energy_of(&one, (const double(*)[3])moved, NULL), energy, 1e-13 * (1 + energy));
            if (one.fibre == 4)
                continue;
            stencil_move(&random, 3, (const double(*)[3])rest, moved);
            assert_near(energy_of(&one, (const double(*)[3])moved, gradient), 0, 1e-27);
            assert_true(stencil_scale(3, (const double(*)[3])gradient) < 1e-13);
        }
}

/* no direction is stretched more than the principal one */
static void test_principal_direction(void **unused)
{
    (void)unused;
    random_state random = {46};
    for (int trial = 0; trial < TRIALS; trial++) {
        double rest[3][3], x[3][3], f[6], direction[2], most = 0;
        pel_rest_triangle triangle;
        random_triangle(&random, rest);
        random_triangle(&random, x);
        assert_true(pel_rest_triangle_setup((const double(*)[3])rest, &triangle));
        pel_deformation_gradient(&triangle, (const double(*)[3])x, f);
        pel_principal_direction(&triangle, (const double(*)[3])x, direction);
        assert_near(hypot(direction[0], direction[1]), 1, 1e-14);
        for (int i = 0; i <= 360; i++) {
            double angle = i * 3.14159265358979 / 360, square = 0;
            const double along[2] = {i < 360 ? cos(angle) : direction[0], i < 360 ? sin(angle) : direction[1]};
            for (int c = 0; c < 3; c++)
                square += pow(f[2 * c] * along[0] + f[2 * c + 1] * along[1], 2);
            /* the last one is the one found */
            assert_true(i < 360 || square >= most * (1 - 1e-12));
            most = fmax(most, square);
        }
        pel_principal_direction(&triangle, (const double(*)[3])rest, direction);
        assert_true(direction[0] == 1 && direction[1] == 0);
    }
}

static void test_rest_triangle(void **unused)
{
    (void)unused;
    random_state random = {43};
    for (int trial = 0; trial < TRIALS; trial++) {
        double rest[3][3], f[6], direction[2], normal[3], along[3];
        pel_rest_triangle triangle;
        random_triangle(&random, rest);
        assert_true(pel_rest_triangle_setup((const double(*)[3])rest, &triangle));
        pel_vec3_triangle_normal(rest[0], rest[1], rest[2], normal);
        assert_near(triangle.area, 0.5 * pel_vec3_length(normal), 1e-14);
        /* F of the rest shape is the frame: orthonormal columns, the first along x0 - x2, right-handed with n */
        pel_deformation_gradient(&triangle, (const double(*)[3])rest, f);
        const double first[3] = {f[0], f[2], f[4]}, second[3] = {f[1], f[3], f[5]};
        double cross[3];
        pel_vec3_cross(first, second, cross);
        assert_near(pel_vec3_dot(first, second), 0, 1e-14);
        assert_near(pel_vec3_dot(cross, normal), pel_vec3_length(normal), 1e-13);
        /* a vector in the plane is its frame coordinates; the normal has no direction */
        for (int i = 0; i < 3; i++)
            along[i] = 3 * (0.6 * first[i] - 0.8 * second[i]) + 5 * normal[i];
        assert_true(pel_rest_triangle_direction((const double(*)[3])rest, along, direction));
        assert_near(direction[0], 0.6, 1e-13);
        assert_near(direction[1], -0.8, 1e-13);
    }
    const double line[3][3] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, flat[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const double up[3] = {0, 0, 1};
    double direction[2];
    pel_rest_triangle triangle;
    assert_false(pel_rest_triangle_setup(line, &triangle));
    assert_near(triangle.area, 0, 0);
    assert_false(pel_rest_triangle_direction(flat, up, direction));
    assert_near(direction[0], 1, 0);
}

/* closed: the forces of a pressure are pressure times the gradient of the volume, and have no sum and no torque */
static void test_pressure_is_volume_gradient(void **unused)
{
    (void)unused;
    random_state random = {44};
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = 4;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    assert_int_equal(mesh->vertex_count, 162);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            mesh->positions[v][i] += 5 + 0.1 * random_normal(&random);
    static double force[162][3], gradient[162][3];
    double net[3] = {0}, torque[3] = {0}, x[3][3], row[3][3], share[3], moment[3];
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        for (int a = 0; a < 3; a++)
            pel_vec3_copy(mesh->positions[mesh->triangles[t][a]], x[a]);
        pel_triangle_volume((const double(*)[3])x, row);
        pel_triangle_pressure_force((const double(*)[3])x, 2, share);
        for (int a = 0; a < 3; a++) {
            int32_t v = mesh->triangles[t][a];
            pel_vec3_add(gradient[v], row[a], gradient[v]);
            pel_vec3_add(force[v], share, force[v]);
        }
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        for (int i = 0; i < 3; i++)
            assert_near(force[v][i], 2 * gradient[v][i], 1e-13);
        pel_vec3_cross(mesh->positions[v], force[v], moment);
        pel_vec3_add(net, force[v], net);
        pel_vec3_add(torque, moment, torque);
    }
    assert_near(pel_vec3_length(net), 0, 1e-13);
    assert_near(pel_vec3_length(torque), 0, 1e-12);
    pel_mesh_destroy(mesh);
}

static double volume_only(const void *unused, const double *x)
{
    (void)unused;
    return pel_triangle_volume((const double(*)[3])x, NULL);
}

static void test_volume(void **unused)
{
    (void)unused;
    random_state random = {45};
    const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    assert_near(pel_triangle_volume(unit, NULL), 1.0 / 6, 1e-16);
    for (int trial = 0; trial < TRIALS; trial++) {
        double x[3][3], gradient[3][3];
        random_triangle(&random, x);
        pel_triangle_volume((const double(*)[3])x, gradient);
        assert_true(stencil_gradient_error(volume_only, NULL, 3, (const double(*)[3])x, (const double(*)[3])gradient,
                                           1e-2) < 1e-11);
    }
}

/* Irregular patch of the plane, stretched evenly: forces inside vanish, and those on the right side add up to tension
   times width. Linear is left to equal stretches: along other directions its frames make its stress uneven. */
static void check_patch(pel_membrane_material material, double stretch, double width, double tension)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    def.nx = def.ny = 6;
    def.size_x = def.size_y = 2;
    random_state random = {46};
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    assert_int_equal(mesh->vertex_count, 49);
    double force[49][3] = {{0}}, right = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double *p = mesh->positions[v];
        for (int i = 0; i < 2; i++)
            if (fabs(p[0]) < 0.99 && fabs(p[1]) < 0.99)
                p[i] += random_between(&random, -0.1, 0.1);
    }
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double rest[3][3], x[3][3] = {{0}}, gradient[3][3];
        for (int a = 0; a < 3; a++) {
            pel_vec3_copy(mesh->positions[mesh->triangles[t][a]], rest[a]);
            x[a][0] = stretch * rest[a][0];
            x[a][2] = width * rest[a][1]; /* upright in space */
        }
        pel_rest_triangle triangle;
        assert_true(pel_rest_triangle_setup((const double(*)[3])rest, &triangle));
        pel_membrane_energy(&triangle, &material, (const double(*)[3])x, gradient);
        for (int a = 0; a < 3; a++)
            pel_vec3_add(force[mesh->triangles[t][a]], gradient[a], force[mesh->triangles[t][a]]);
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->positions[v];
        if (p[0] > 0.99)
            right += force[v][0];
        if (fabs(p[0]) < 0.99 && fabs(p[1]) < 0.99)
            assert_near(pel_vec3_length(force[v]), 0, 1e-12);
    }
    assert_near(right, 2 * tension, 1e-12);
    pel_mesh_destroy(mesh);
}

static void test_patch(void **unused)
{
    (void)unused;
    const double stretch = 1.2;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        pel_membrane_material material = law_material(kind, 4, 0.3, 0.5);
        check_patch(material, stretch, stretch, law_tension(&material, stretch, stretch));
        if (kind == PEL_MEMBRANE_LINEAR || kind == PEL_MEMBRANE_WEAVE)
            continue;
        double width = law_width(&material, stretch);
        check_patch(material, stretch, width, law_tension(&material, stretch, width));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gradients),
        cmocka_unit_test(test_invariance),
        cmocka_unit_test(test_principal_direction),
        cmocka_unit_test(test_rest_triangle),
        cmocka_unit_test(test_pressure_is_volume_gradient),
        cmocka_unit_test(test_volume),
        cmocka_unit_test(test_patch),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
