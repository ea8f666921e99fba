/* Forces of shells: against differences of the energy, closed forms, invariants, threads. */
#include "failing_malloc.h"
#include "law_forms.h"
#include "shell_fixture.h"

#include "force/shell_force.h"
#include "pellicle/measure.h"
#include "pellicle/topology.h"

#ifdef PEL_SINGLE
/* positions have 24 bits */
#define GRADIENT_STEP 1e-2
#define GRADIENT_TOLERANCE 2e-2
#define BALANCE_TOLERANCE 1e-4
#define PATCH_TOLERANCE 1e-4
#define ENERGY_TOLERANCE 1e-4 /* lanes in float compared with elements in double */
#else
#define GRADIENT_STEP 1e-3
#define GRADIENT_TOLERANCE 1e-7
#define BALANCE_TOLERANCE 1e-12
#define PATCH_TOLERANCE 1e-9
#define ENERGY_TOLERANCE 1e-12
#endif

typedef struct forces {
    pel_model *model;
    pel_state *state;
    pel_batches *batches;
    pel_shell_forces *shells;
    pel_record *force;
} forces;

static forces make_forces_of(const pel_body_def *body, pel_method method)
{
    forces made = {.model = make_model(body)};
    made.state = make_state(made.model);
    made.force = make_records(made.model);
    assert_int_equal(pel_batches_create(made.model, method, &made.batches, NULL), PEL_OK);
    assert_int_equal(pel_shell_forces_create(made.batches, &made.shells, NULL), PEL_OK);
    return made;
}

static forces make_forces(const pel_body_def *body)
{
    return make_forces_of(body, PEL_METHOD_EXPLICIT);
}

static void free_forces(forces *made)
{
    pel_shell_forces_destroy(made->shells);
    pel_batches_destroy(made->batches);
    free(made->force);
    pel_state_destroy(made->state);
    pel_model_destroy(made->model);
}

static pel_shell_energy evaluate(forces *on, double time, int parts)
{
    memset(on->force, 0, (size_t)on->model->vertex_count * sizeof *on->force);
    return pel_shell_forces_add(on->shells, on->state->position, pel_instant(time), parts, NULL, on->force);
}

static double total(const pel_shell_energy *energy)
{
    return energy->membrane + energy->bending + energy->fibres + energy->pressure;
}

static double largest_force(const forces *on)
{
    double largest = 0;
    for (int32_t v = 0; v < on->model->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            largest = fmax(largest, fabs((double)on->force[v][c]));
    return largest;
}

/* the energy with one coordinate of one vertex moved; `moved` receives the actual displacement */
static double energy_at(forces *on, int32_t v, int c, double step, double *moved)
{
    pel_record *x = &on->state->position[v];
    pel_real kept = (*x)[c];
    (*x)[c] = (pel_real)((double)kept + step);
    *moved = (double)(*x)[c];
    pel_shell_energy energy =
        pel_shell_forces_add(on->shells, on->state->position, pel_instant(0.5), PEL_SHELL_ALL, NULL, NULL);
    (*x)[c] = kept;
    return total(&energy);
}

static double difference(forces *on, int32_t v, int c, double step)
{
    double above, below, high = energy_at(on, v, c, step, &above), low = energy_at(on, v, c, -step, &below);
    return (high - low) / (above - below);
}

/* forces are minus the derivatives of the energy, and neither move nor turn the body */
static void check_forces(const pel_body_def *body, double shaken, random_state *random)
{
    forces on = make_forces(body);
    shake(on.model, on.state->position, shaken, random);
    pel_shell_forces_follow(on.shells, on.state->position);
    evaluate(&on, 0.5, PEL_SHELL_ALL);
    double scale = largest_force(&on), force[3] = {0}, torque[3] = {0};
    assert_true(scale > 0);
    for (int32_t v = 0; v < on.model->vertex_count; v++) {
        double x[3], f[3], moment[3];
        for (int c = 0; c < 3; c++) {
            x[c] = (double)on.state->position[v][c];
            f[c] = (double)on.force[v][c];
        }
        pel_vec3_cross(x, f, moment);
        pel_vec3_add(force, f, force);
        pel_vec3_add(torque, moment, torque);
    }
    assert_near(pel_vec3_length(force) / scale, 0, BALANCE_TOLERANCE);
    assert_near(pel_vec3_length(torque) / scale, 0, BALANCE_TOLERANCE);
    for (int i = 0; i < 40; i++) {
        int32_t v = (int32_t)random_integer(random, 0, on.model->vertex_count - 1);
        int c = (int)random_integer(random, 0, 2);
        if (on.model->mesh_vertex[v] < 0)
            continue;
        double coarse = difference(&on, v, c, GRADIENT_STEP), fine = difference(&on, v, c, GRADIENT_STEP / 2),
               finest = difference(&on, v, c, GRADIENT_STEP / 4);
        double first = (4 * fine - coarse) / 3, second = (4 * finest - fine) / 3;
        /* differences over a change from taut to wrinkled, where the tangent jumps */
        double tolerance = body->shell.membrane.kind == PEL_MEMBRANE_TENSION_FIELD ? 1e-5 : GRADIENT_TOLERANCE;
        assert_near(-(16 * second - first) / 15 / scale, (double)on.force[v][c] / scale, tolerance);
    }
    free_forces(&on);
}

static void test_materials(void **unused)
{
    (void)unused;
    random_state random = {3};
    pel_mesh *mesh = make_irregular_ball(2, &random);
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++) {
        pel_body_def body = shell_body(mesh, (pel_membrane_kind)kind);
        /* differences want no kinks */
        body.shell.membrane.warp_curve[1][0] = body.shell.membrane.weft_curve[1][0] = 0;
        check_forces(&body, 0.05, &random);
    }
    /* of a material that varies */
    double young[42];
    for (int v = 0; v < 42; v++)
        young[v] = 1e4 * (1 + v);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_COROTATED);
    body.shell.membrane.young.field = young;
    check_forces(&body, 0.05, &random);
    pel_mesh_destroy(mesh);
}

static void test_bending(void **unused)
{
    (void)unused;
    random_state random = {4};
    pel_mesh *mesh = make_irregular_ball(2, &random);
    for (int model = PEL_BENDING_ISOMETRIC; model <= PEL_BENDING_HINGE; model++) {
        pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
        body.shell.membrane.on = false;
        body.shell.bending.model = (pel_bending_model)model;
        body.shell.bending.stiffness.value = 2;
        check_forces(&body, 0.05, &random);
    }
    pel_mesh_destroy(mesh);
}

static void test_fibres(void **unused)
{
    (void)unused;
    static const pel_key keys[2] = {{0, 1}, {1, 0.6}};
    random_state random = {5};
    pel_mesh *mesh = make_irregular_ball(2, &random);
    double weights[42];
    for (int32_t v = 0; v < 42; v++)
        weights[v] = mesh->positions[v][2] > 0 ? 0.7 : 0;
    for (int kind = 0; kind <= PEL_FIBRE_SQRT + 2; kind++) {
        pel_anisotropy_def regions[2] = {pel_anisotropy_def_default(), pel_anisotropy_def_default()};
        regions[0].mode = regions[1].mode = PEL_FIBRE_STRAIN;
        regions[0].kind = regions[1].kind = (pel_fibre_kind)(kind % 3);
        regions[0].weights = weights;
        regions[1].direction = PEL_FIBRE_ALONG;
        if (kind > PEL_FIBRE_SQRT) {
            regions[0].mode = PEL_FIBRE_ACTIVE;
            regions[0].rest_length = (pel_quantity){.keys = keys, .key_count = 2};
        }
        if (kind > PEL_FIBRE_SQRT + 1) {
            regions[0].mode = PEL_FIBRE_MUSCLE;
            regions[0].tension = 3;
            regions[0].activation = regions[0].rest_length;
        }
        pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
        body.shell.membrane.on = false;
        body.shell.anisotropies = regions;
        body.shell.anisotropy_count = 2;
        check_forces(&body, 0.05, &random);
    }
    pel_mesh_destroy(mesh);
}

static void test_pressures(void **unused)
{
    (void)unused;
    random_state random = {6};
    pel_mesh *mesh = make_irregular_ball(2, &random);
    for (int kind = PEL_PRESSURE_GIVEN; kind <= PEL_PRESSURE_VOLUME; kind++) {
        pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
        body.shell.membrane.on = false;
        body.shell.pressure.kind = (pel_pressure_kind)kind;
        body.shell.pressure.outside.value = -7;
        body.shell.pressure.value = 1e4;
        body.shell.pressure.bulk = 50;
        body.shell.pressure.target.value = 0.8;
        check_forces(&body, 0.1, &random);
        body.shell.pressure.gamma = 1;
        check_forces(&body, 0.1, &random);
    }
    pel_mesh_destroy(mesh);
}

/* ---- a patch in homogeneous stretch: closed forms of theory page section 3 ---- */

/* length of the boundary that a vertex carries on the side where coordinate c is at its largest */
static double side_length(const pel_mesh *mesh, int32_t v, int c)
{
    double length = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            int32_t a = mesh->triangles[t][i], b = mesh->triangles[t][(i + 1) % 3];
            bool on_side = mesh->positions[a][c] > 0.499 && mesh->positions[b][c] > 0.499;
            if (on_side && (a == v || b == v))
                length += 0.5 * pel_vec3_distance(mesh->positions[a], mesh->positions[b]);
        }
    return length;
}

static void check_patch(const pel_mesh *mesh, pel_membrane_kind kind, double l, double m)
{
    pel_body_def body = shell_body(mesh, kind);
    forces on = make_forces(&body);
    const pel_membrane_material material = on.model->bodies[0].shell->material;
    for (int32_t i = 0; i < on.model->vertex_count; i++) {
        on.state->position[i][0] = (pel_real)(l * (double)on.state->position[i][0]);
        on.state->position[i][1] = (pel_real)(m * (double)on.state->position[i][1]);
    }
    evaluate(&on, 0, PEL_SHELL_ALL);
    double tension[2] = {law_tension(&material, l, m), law_tension(&material, m, l)};
    double scale = fmax(fabs(tension[0]), fabs(tension[1]));
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const pel_record *force = &on.force[on.model->bodies[0].model_index[v]];
        bool low[2] = {mesh->positions[v][0] < -0.499, mesh->positions[v][1] < -0.499};
        for (int c = 0; c < 2 && !low[0] && !low[1]; c++)
            assert_near((double)(*force)[c] / scale, -tension[c] * side_length(mesh, v, c) / scale, PATCH_TOLERANCE);
        assert_near((double)(*force)[2] / scale, 0, PATCH_TOLERANCE);
    }
    free_forces(&on);
}

static void test_homogeneous_stretch(void **unused)
{
    (void)unused;
    random_state random = {7};
    pel_mesh *patch = make_irregular_patch(6, &random);
    static const double stretches[][2] = {{1.2, 0.9}, {0.8, 1.1}, {1.3, 1.3}, {0.9, 0.9}};
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++)
        for (int i = 0; i < 4; i++) {
            /* the frame of the linear law turns with edges that turn: closed forms hold for equal stretch */
            if (kind != PEL_MEMBRANE_LINEAR || i >= 2)
                check_patch(patch, (pel_membrane_kind)kind, stretches[i][0], stretches[i][1]);
        }
    pel_mesh_destroy(patch);
    /* and for any stretch where the frames' edges lie along it */
    pel_mesh *sheet = make_grid(4, 4, 1, 1, PEL_GRID_ONE_DIAGONAL);
    for (int32_t t = 0; t < sheet->triangle_count; t++)
        for (int turn = 0; turn < 3; turn++) {
            int32_t *v = sheet->triangles[t], first = v[0];
            if (fabs(sheet->positions[v[0]][1] - sheet->positions[v[2]][1]) < 1e-9)
                break;
            v[0] = v[1];
            v[1] = v[2];
            v[2] = first;
        }
    for (int i = 0; i < 4; i++)
        check_patch(sheet, PEL_MEMBRANE_LINEAR, stretches[i][0], stretches[i][1]);
    pel_mesh_destroy(sheet);
}

/* a gentle bend of a flat sheet costs the same in all models of one D; the literal one keeps a flat sheet flat */
static void test_bending_models_agree(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(12, 4, 1, 0.3, PEL_GRID_EQUILATERAL);
    double energies[PEL_BENDING_HINGE + 1];
    for (int model = PEL_BENDING_ISOMETRIC; model <= PEL_BENDING_HINGE; model++) {
        pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
        body.shell.bending.model = (pel_bending_model)model;
        forces on = make_forces(&body);
        pel_shell_energy flat = evaluate(&on, 0, PEL_SHELL_BENDING);
        assert_near(flat.bending, 0, 1e-10);
        for (int32_t i = 0; i < on.model->vertex_count; i++) {
            pel_real x = on.state->position[i][0];
            on.state->position[i][2] = (pel_real)0.02 * x * x;
        }
        energies[model] = evaluate(&on, 0, PEL_SHELL_BENDING).bending;
        free_forces(&on);
    }
    /* D/2 curvature^2 area, less the strips at the boundary that have no hinges */
    double expected = 0.5 * 1e5 * 1e-6 / (12 * 0.91) * 0.04 * 0.04 * 0.3;
    assert_near(energies[PEL_BENDING_HINGE] / expected, 0.9, 0.1);
    assert_near(energies[PEL_BENDING_ISOMETRIC] / energies[PEL_BENDING_HINGE], 1, 1e-3);
    assert_near(energies[PEL_BENDING_ISOMETRIC_REST] / energies[PEL_BENDING_ISOMETRIC], 1, 1e-6);
    pel_mesh_destroy(mesh);
}

/* both forms, whole and in a region, are those of pel_surface_pressure */
static void test_pressure_forms(void **unused)
{
    (void)unused;
    random_state random = {8};
    pel_mesh *mesh = make_irregular_ball(4, &random);
    pel_topology *topology;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    double *expected = calloc((size_t)mesh->vertex_count * 3, sizeof *expected);
    for (int form = 0; form < 2; form++) {
        pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
        body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
        body.shell.pressure.form = (pel_pressure_form)form;
        body.shell.pressure.outside.value = 3;
        forces on = make_forces(&body);
        evaluate(&on, 0, PEL_SHELL_PRESSURE);
        pel_surface_pressure(topology, mesh->positions[0], 3, (pel_pressure_form)form, expected, NULL, NULL);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            for (int c = 0; c < 3; c++)
                assert_near((double)on.force[on.model->bodies[0].model_index[v]][c], expected[3 * v + c],
                            BALANCE_TOLERANCE);
        free_forces(&on);
    }
    free(expected);
    pel_topology_destroy(topology);
    pel_mesh_destroy(mesh);
}

/* energies of the vertices add up to that of the body */
static void test_vertex_energies(void **unused)
{
    (void)unused;
    random_state random = {9};
    pel_mesh *mesh = make_irregular_ball(3, &random);
    pel_anisotropy_def fibres = pel_anisotropy_def_default();
    fibres.mode = PEL_FIBRE_STRAIN;
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_NEO_HOOKEAN);
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.anisotropies = &fibres;
    body.shell.anisotropy_count = 1;
    forces on = make_forces(&body);
    shake(on.model, on.state->position, 0.03, &random);
    pel_shell_energy energy = evaluate(&on, 0, PEL_SHELL_ALL);
    double lists[3][92], sums[3] = {0};
    assert_int_equal(mesh->vertex_count, 92);
    pel_shell_vertex_energies(on.shells, 0, 92, NULL, on.state->position, 0, lists[0], lists[1], lists[2]);
    for (int i = 0; i < 3; i++)
        for (int v = 0; v < 92; v++)
            sums[i] += lists[i][v];
    assert_near(sums[0] / energy.membrane, 1, ENERGY_TOLERANCE);
    assert_near(sums[1] / energy.bending, 1, ENERGY_TOLERANCE);
    assert_near(sums[2] / energy.fibres, 1, ENERGY_TOLERANCE);
    pel_shell_vertex_energies(NULL, 0, 92, NULL, on.state->position, 0, lists[0], lists[1], lists[2]);
    assert_true(lists[0][5] == 0 && lists[2][91] == 0);
    free_forces(&on);
    pel_mesh_destroy(mesh);
}

static pel_body_def full_body(const pel_mesh *mesh)
{
    static pel_anisotropy_def fibres;
    fibres = pel_anisotropy_def_default();
    fibres.mode = PEL_FIBRE_STRAIN;
    fibres.direction = PEL_FIBRE_PRINCIPAL;
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.anisotropies = &fibres;
    body.shell.anisotropy_count = 1;
    body.shell.pressure.kind = PEL_PRESSURE_GAS;
    body.shell.pressure.value = 100;
    return body;
}

/* the same bits for any number of threads, without allocation */
static void test_threads(void **unused)
{
    (void)unused;
    random_state random = {10};
    pel_mesh *mesh = make_sphere(12);
    pel_body_def body = full_body(mesh);
    forces on = make_forces(&body);
    size_t size = (size_t)on.model->vertex_count * sizeof *on.force;
    shake(on.model, on.state->position, 0.01, &random);
    pel_shell_forces_follow(on.shells, on.state->position);
    pel_shell_energy alone = evaluate(&on, 0, PEL_SHELL_ALL), together;
    pel_record *kept = make_records(on.model);
    memcpy(kept, on.force, size);
    pel_pool *pool;
    assert_int_equal(pel_pool_create(4, &pool, NULL), PEL_OK);
    memset(on.force, 0, size);
    failing_malloc_begin(0);
    together = pel_shell_forces_add(on.shells, on.state->position, pel_instant(0), PEL_SHELL_ALL, pool, on.force);
    assert_int_equal(failing_malloc_end().calls, 0);
    assert_memory_equal(kept, on.force, size);
    assert_true(total(&alone) == total(&together));
    pel_pool_destroy(pool);
    free(kept);
    free_forces(&on);
    pel_mesh_destroy(mesh);
}

/* the layouts of all methods give the same forces and energies */
static void test_methods(void **unused)
{
    (void)unused;
    static const pel_method methods[4] = {PEL_METHOD_EXPLICIT, PEL_METHOD_PBD, PEL_METHOD_PBD_DISTANCE,
                                          PEL_METHOD_XPBD};
    static const pel_bending_model models[] = {PEL_BENDING_HINGE, PEL_BENDING_ISOMETRIC, PEL_BENDING_ISOMETRIC_REST};
    pel_mesh *mesh = make_sphere(6);
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++)
        for (int bending = 0; bending < 3; bending++) {
            pel_body_def body = full_body(mesh);
            shell_set_kind(&body, (pel_membrane_kind)kind);
            body.shell.bending.model = models[bending];
            body.shell.bending.stiffness.value = 5;
            body.shell.pressure.form = bending == 0 ? PEL_PRESSURE_CONSISTENT : PEL_PRESSURE_VERTEX_NORMAL;
            pel_record *first = NULL;
            pel_shell_energy first_energy = {0};
            for (int m = 0; m < 4; m++) {
                random_state random = {13};
                forces on = make_forces_of(&body, methods[m]);
                shake(on.model, on.state->position, 0.02, &random);
                pel_shell_energy energy = evaluate(&on, 0, PEL_SHELL_ALL);
                if (m == 0) {
                    first = make_records(on.model);
                    memcpy(first, on.force, (size_t)on.model->vertex_count * sizeof *first);
                    first_energy = energy;
                }
                double scale = largest_force(&on);
                for (int32_t v = 0; v < on.model->vertex_count; v++)
                    for (int c = 0; c < 3; c++)
                        assert_near((double)on.force[v][c] / scale, (double)first[v][c] / scale,
                                    10 * BALANCE_TOLERANCE);
                assert_near(energy.membrane / first_energy.membrane, 1, ENERGY_TOLERANCE);
                assert_near(energy.bending / first_energy.bending, 1, ENERGY_TOLERANCE);
                assert_near(energy.fibres / first_energy.fibres, 1, ENERGY_TOLERANCE);
                assert_near(energy.pressure, first_energy.pressure, ENERGY_TOLERANCE * fabs(energy.pressure));
                free_forces(&on);
            }
            free(first);
        }
    pel_mesh_destroy(mesh);
}

/* parts add up, and nothing acts at rest */
static void test_parts(void **unused)
{
    (void)unused;
    random_state random = {11};
    pel_mesh *mesh = make_sphere(4);
    pel_body_def body = full_body(mesh);
    forces on = make_forces(&body);
    evaluate(&on, 0, PEL_SHELL_ELASTIC);
    assert_near(largest_force(&on), 0, PATCH_TOLERANCE * 1e3);
    shake(on.model, on.state->position, 0.01, &random);
    pel_record *sum = make_records(on.model);
    size_t count = (size_t)on.model->vertex_count;
    memset(sum, 0, count * sizeof *sum);
    static const int parts[4] = {PEL_SHELL_MEMBRANE, PEL_SHELL_BENDING, PEL_SHELL_FIBRES, PEL_SHELL_PRESSURE};
    for (int i = 0; i < 4; i++) {
        evaluate(&on, 0, parts[i]);
        assert_true(largest_force(&on) > 0);
        for (size_t v = 0; v < count; v++)
            sum[v] += on.force[v];
    }
    evaluate(&on, 0, PEL_SHELL_ALL);
    for (size_t v = 0; v < count; v++)
        for (int c = 0; c < 3; c++)
            assert_near((double)sum[v][c], (double)on.force[v][c], BALANCE_TOLERANCE * 100 * largest_force(&on));
    free(sum);
    free_forces(&on);
    pel_mesh_destroy(mesh);
}

/* the elements at single vertices, one by one, against the loops over lanes */
static void check_force_at(const pel_body_def *body, double flatness, random_state *random)
{
    forces on = make_forces(body);
    shake(on.model, on.state->position, 0.02, random);
    for (int32_t v = 0; v < on.model->vertex_count; v++)
        on.state->position[v][2] *= (pel_real)flatness;
    pel_shell_forces_follow(on.shells, on.state->position);
    assert_int_equal(pel_shell_forces_list(on.shells, 0, NULL), PEL_OK);
    evaluate(&on, 0, PEL_SHELL_ELASTIC);
    double force[3], scale = largest_force(&on);
    for (int32_t v = 0; v < on.model->vertex_count; v++) {
        if (on.model->mesh_vertex[v] < 0)
            continue;
        pel_shell_elastic_force_at(on.shells, 0, on.state->position, 0, v, force);
        for (int c = 0; c < 3; c++)
            assert_near(force[c] / scale, (double)on.force[v][c] / scale, 10 * BALANCE_TOLERANCE);
    }
    free_forces(&on);
}

static void test_force_at(void **unused)
{
    (void)unused;
    random_state random = {12};
    pel_mesh *mesh = make_irregular_ball(3, &random);
    static const pel_bending_model models[] = {PEL_BENDING_HINGE, PEL_BENDING_ISOMETRIC};
    for (int kind = PEL_MEMBRANE_STVK; kind < PEL_MEMBRANE_COUNT; kind++) {
        pel_body_def body = full_body(mesh);
        shell_set_kind(&body, (pel_membrane_kind)kind);
        for (int i = 0; i < 2; i++) {
            body.shell.bending.model = models[i];
            body.shell.bending.stiffness.value = 5; /* as important as the membrane */
            check_force_at(&body, 1, &random);
        }
        /* triangles on edge collapse to less than a hundredth of their area */
        body.shell.bending.model = PEL_BENDING_NONE;
        check_force_at(&body, 1e-3, &random);
    }
    pel_mesh_destroy(mesh);
}

static pel_status create_forces(const void *model, pel_error *error)
{
    pel_batches *batches;
    pel_shell_forces *shells = NULL;
    pel_status status = pel_batches_create(model, PEL_METHOD_EXPLICIT, &batches, error);
    assert_true((batches == NULL) == (status != PEL_OK));
    if (status == PEL_OK) {
        status = pel_shell_forces_create(batches, &shells, error);
        assert_true((shells == NULL) == (status != PEL_OK));
    }
    if (status == PEL_OK)
        status = pel_shell_forces_list(shells, 0, error);
    pel_shell_forces_destroy(shells);
    pel_batches_destroy(batches);
    return status;
}

static void test_creation(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(2);
    pel_body_def body = full_body(mesh);
    body.shell.pressure.form = PEL_PRESSURE_VERTEX_NORMAL;
    pel_model *model = make_model(&body);
    assert_true(for_every_allocation_failure(create_forces, model) >= 10);
    pel_model_destroy(model);
    /* bending that no one gave a stiffness */
    pel_error error;
    pel_batches *batches;
    pel_shell_forces *shells;
    body.shell.membrane.on = false;
    model = make_model(&body);
    assert_int_equal(pel_batches_create(model, PEL_METHOD_PBD, &batches, NULL), PEL_OK);
    assert_int_equal(pel_shell_forces_create(batches, &shells, &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.what, "bending has no stiffness");
    pel_batches_destroy(batches);
    pel_model_destroy(model);
    pel_body_def plain = pel_body_def_default();
    plain.name = "ball";
    plain.mesh = mesh;
    model = make_model(&plain);
    assert_int_equal(pel_batches_create(model, PEL_METHOD_EXPLICIT, &batches, NULL), PEL_OK);
    assert_int_equal(pel_shell_forces_create(batches, &shells, &error), PEL_OK);
    assert_null(shells);
    pel_batches_destroy(batches);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* a body of springs next to a shell does not change the shell's forces */
static void test_beside_springs(void **unused)
{
    (void)unused;
    random_state random = {4};
    pel_mesh *mesh = make_irregular_ball(3, &random);
    pel_body_def bodies[2] = {shell_body(mesh, PEL_MEMBRANE_STVK), ball_body(mesh)};
    pel_model_def def = pel_model_def_default();
    def.bodies = bodies;
    def.body_count = 2;
    forces alone = make_forces(&bodies[0]), both = {0};
    assert_int_equal(pel_model_create(&def, &both.model, NULL), PEL_OK);
    both.state = make_state(both.model);
    both.force = make_records(both.model);
    assert_int_equal(pel_batches_create(both.model, PEL_METHOD_EXPLICIT, &both.batches, NULL), PEL_OK);
    assert_int_equal(pel_shell_forces_create(both.batches, &both.shells, NULL), PEL_OK);
    random_state first = {5}, second = {5};
    shake(alone.model, alone.state->position, 0.1, &first);
    shake(both.model, both.state->position, 0.1, &second);
    evaluate(&alone, 0, PEL_SHELL_ALL);
    evaluate(&both, 0, PEL_SHELL_ALL);
    assert_true(largest_force(&alone) > 0);
    for (int32_t v = 0; v < both.model->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            assert_true(both.force[v][c] == (v < alone.model->vertex_count ? alone.force[v][c] : 0));
    free_forces(&alone);
    free_forces(&both);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_beside_springs),
        cmocka_unit_test(test_materials),
        cmocka_unit_test(test_bending),
        cmocka_unit_test(test_fibres),
        cmocka_unit_test(test_pressures),
        cmocka_unit_test(test_homogeneous_stretch),
        cmocka_unit_test(test_bending_models_agree),
        cmocka_unit_test(test_pressure_forms),
        cmocka_unit_test(test_vertex_energies),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_methods),
        cmocka_unit_test(test_parts),
        cmocka_unit_test(test_force_at),
        cmocka_unit_test(test_creation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
