/* What position-based methods converge to: closed forms of materials, the pressurised sphere, leapfrog, and exact
   solutions of single vertices. */
#include "law_forms.h"
#include "math/vec3.h"
#include "pellicle/sim_ledger.h"
#include "random.h"
#include "sim/fixture.h"
#include "stage/stage.h"

#include <stdlib.h>

static const bool is_double = sizeof(pel_real) == 8;

static pel_body_def bare_body(const pel_mesh *mesh)
{
    pel_body_def body = pel_body_def_default();
    body.name = "body";
    body.mesh = mesh;
    body.spring_stiffness.value = body.spring_damping.value = 0;
    body.volumetric_stiffness.value = body.volumetric_damping.value = 0;
    return body;
}

/* a shell that bends, under a pressure that is still to be given */
static pel_body_def pressed_body(const pel_mesh *mesh, double young, double thickness)
{
    pel_body_def body = pel_body_def_sheet("body", mesh, young, thickness, 1000);
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    return body;
}

static pel_sim_def sim_of(const pel_model *model, pel_method method, double dt, int32_t substeps)
{
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver = (pel_solver_def){.method = method, .dt = dt, .substeps = substeps, .symplectic = true};
    def.thread_count = 1;
    return def;
}

static const pel_method methods[3] = {PEL_METHOD_PBD, PEL_METHOD_PBD_DISTANCE, PEL_METHOD_XPBD};

/* ---- a sheet under tension ---- */

enum { CELLS = 4, SIDE = CELLS + 1, SHEET = SIDE * SIDE };

/* the unit square, inner vertices moved at random */
static pel_mesh *make_sheet(void)
{
    static double positions[SHEET][3];
    static int32_t triangles[2 * CELLS * CELLS][3];
    random_state random = {11};
    for (int i = 0; i < SHEET; i++) {
        int column = i % SIDE, row = i / SIDE;
        bool inner = column > 0 && column < CELLS && row > 0 && row < CELLS;
        positions[i][0] = (column + (inner ? 0.3 * random_between(&random, -1, 1) : 0)) / CELLS;
        positions[i][1] = (row + (inner ? 0.3 * random_between(&random, -1, 1) : 0)) / CELLS;
    }
    for (int c = 0; c < CELLS * CELLS; c++) {
        int32_t a = c / CELLS * SIDE + c % CELLS;
        const int32_t two[2][3] = {{a, a + 1, a + SIDE + 1}, {a, a + SIDE + 1, a + SIDE}};
        memcpy(triangles[2 * c], two, sizeof two);
    }
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions[0], SHEET, triangles[0], 2 * CELLS * CELLS, &mesh, NULL), PEL_OK);
    return mesh;
}

/* force per width of the pull on opposite sides: weights of the vertices for the x (0) or y (1) direction */
static void side_weights(int direction, double weights[SHEET])
{
    for (int i = 0; i < SHEET; i++) {
        int along = direction == 0 ? i / SIDE : i % SIDE, across = direction == 0 ? i % SIDE : i / SIDE;
        double share = (along == 0 || along == CELLS ? 0.5 : 1.0) / CELLS;
        weights[i] = across == 0 ? -share : across == CELLS ? share : 0;
    }
}

/* stretches of the sheet in x and y when it has come to rest under these pulls [force per width] */
static void rest_stretches(const pel_membrane_material *material, const double pulls[2], double dt, int32_t iterations,
                           double stretch[2])
{
    pel_mesh *mesh = make_sheet();
    pel_body_def body = bare_body(mesh);
    body.mass = 1.0 / SHEET;
    body.shell.membrane = (pel_membrane_def){.on = true,
                                             .direction = {1},
                                             .weft = material->weft,
                                             .shear = material->shear,
                                             .kind = material->kind,
                                             .young.value = material->young,
                                             .poisson = material->poisson,
                                             .thickness.value = material->thickness,
                                             .mooney_ratio = material->mooney_ratio,
                                             .extension_limit = material->extension_limit,
                                             .stiffening = material->stiffening,
                                             .yield = 2 * material->young};
    memcpy(body.shell.membrane.warp_curve, material->warp_curve, sizeof material->warp_curve);
    memcpy(body.shell.membrane.weft_curve, material->weft_curve, sizeof material->weft_curve);
    pel_model *model = make_model(&body);
    static double weights[2][SHEET];
    pel_load_def loads[2] = {pel_load_def_default(), pel_load_def_default()};
    for (int d = 0; d < 2; d++) {
        side_weights(d, weights[d]);
        loads[d].kind = PEL_LOAD_PER_VERTEX;
        loads[d].force[d] = pulls[d];
        loads[d].weights = weights[d];
    }
    pel_sim_def def = sim_of(model, PEL_METHOD_XPBD, dt, 1);
    def.solver.iterations = iterations;
    def.solver.drag = 2;
    def.loads = loads;
    def.load_count = 2;
    pel_sim *sim = make_sim(&def);
    run_steps(sim, (int)(60 / dt));
    static double x[SHEET][3];
    pel_sim_get_positions(sim, 0, x[0]);
    /* the sheet may have turned */
    stretch[0] = hypot(x[SIDE - 1][0] - x[0][0], x[SIDE - 1][1] - x[0][1]);
    stretch[1] = hypot(x[SHEET - SIDE][0] - x[0][0], x[SHEET - SIDE][1] - x[0][1]);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* The answer of xpbd is the material's own, whatever the tangent that it uses: it differs by what the positions move
   within a sweep, which falls with dt^2. */
static void test_sheet_reaches_closed_forms(void **unused)
{
    (void)unused;
    double tolerance = is_double ? 2e-4 : 1e-3;
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++) {
        pel_membrane_material material = law_material(kind, 100, 0.3, 0.01);
        material.yield = 200;
        double l = 1.3, stretch[2], width = law_width(&material, l);
        double pull = law_tension(&material, l, l);
        rest_stretches(&material, (const double[2]){pull, pull}, 0.01, 4, stretch);
        print_message("material %d: biaxial %.6f %.6f", kind, stretch[0] - l, stretch[1] - l);
        assert_near(stretch[0], l, tolerance);
        assert_near(stretch[1], l, tolerance);
        if (kind == PEL_MEMBRANE_LINEAR)
            continue; /* its answer depends on the frames of the triangles */
        pull = law_tension(&material, l, width);
        rest_stretches(&material, (const double[2]){pull, 0}, 0.01, 4, stretch);
        print_message(", uniaxial %.6f %.6f\n", stretch[0] - l, stretch[1] - width);
        assert_near(stretch[0], l, tolerance);
        /* narrower than a pulled strip a tension field resists by a thousandth */
        assert_true(stretch[1] < width + tolerance);
        if (kind != PEL_MEMBRANE_TENSION_FIELD)
            assert_near(stretch[1], width, tolerance);
    }
}

/* ---- the pressurised sphere, theory page section 11 a ---- */

static void test_pressurised_sphere(void **unused)
{
    (void)unused;
#ifdef PEL_SINGLE
    /* a way of 3.5e-4 of the radius in 64 substeps is lost in the rounding of positions: 15 % too far */
    skip();
#endif
    const double young = 1e6, thickness = 0.01, poisson = 0.3, pressure = 10;
    pel_mesh *mesh = make_sphere(8);
    pel_body_def body = pressed_body(mesh, young, thickness);
    body.shell.pressure.outside.value = -pressure;
    pel_model *model = make_model(&body);
    pel_sim_def def = sim_of(model, PEL_METHOD_XPBD, 1.0 / 60, 64);
    def.solver.drag = 20;
    pel_sim *sim = make_sim(&def);
    run_steps(sim, 60);
    double *x = malloc(3 * (size_t)mesh->vertex_count * sizeof *x), sum = 0;
    pel_sim_get_positions(sim, 0, x);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        sum += sqrt(x[3 * v] * x[3 * v] + x[3 * v + 1] * x[3 * v + 1] + x[3 * v + 2] * x[3 * v + 2]) - 1;
    double exact = pressure * (1 - poisson) / (2 * young * thickness);
    print_message("mean displacement over exact: %.5f\n", sum / mesh->vertex_count / exact);
    /* 0.9941 is that of constant-strain triangles on 1280 of them */
    assert_near(sum / mesh->vertex_count / exact, 0.9941, 3e-3);
    free(x);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* ---- order in time ---- */

/* positions after 10 frames of 1/60 s of a sphere pressed to half the classical buckling pressure */
static void pressed_sphere(pel_method method, int32_t substeps, bool second_order, double *x)
{
    pel_mesh *mesh = make_sphere(4);
    const double young = 1e6, thickness = 0.01, critical = 2 * young * thickness * thickness / sqrt(3 * 0.91);
    const pel_key keys[2] = {{0, 0}, {5.0 / 60, 1}};
    pel_body_def body = pressed_body(mesh, young, thickness);
    body.shell.pressure.outside = (pel_quantity){.value = 0.5 * critical, .keys = keys, .key_count = 2};
    pel_model *model = make_model(&body);
    bool leapfrog = method == PEL_METHOD_EXPLICIT;
    pel_sim_def def = sim_of(model, method, leapfrog ? 1.0 / 60 / substeps : 1.0 / 60, leapfrog ? 0 : substeps);
    def.solver.second_order = second_order;
    pel_sim *sim = make_sim(&def);
    run_steps(sim, leapfrog ? 10 * substeps : 10);
    pel_sim_get_positions(sim, 0, x);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

enum { SPHERE_VERTICES = 162 };

static double trajectory_error(const double *x, const double *reference)
{
    pel_mesh *mesh = make_sphere(4);
    double error = 0, motion = 0;
    for (int i = 0; i < 3 * SPHERE_VERTICES; i++) {
        error += (x[i] - reference[i]) * (x[i] - reference[i]);
        motion += (reference[i] - mesh->positions[i / 3][i % 3]) * (reference[i] - mesh->positions[i / 3][i % 3]);
    }
    pel_mesh_destroy(mesh);
    return sqrt(error / motion);
}

/* theory page, section 11 g: a load that acts twice, or not at all, would leave an error that does not fall */
static void test_error_falls_with_dt(void **unused)
{
    (void)unused;
    static double reference[3 * SPHERE_VERTICES], x[3 * SPHERE_VERTICES];
    double errors[2][3];
    pressed_sphere(PEL_METHOD_EXPLICIT, 512, false, reference);
    for (int second = 0; second < 2; second++)
        for (int i = 0; i < 3; i++) {
            pressed_sphere(PEL_METHOD_XPBD, 16 << i, second == 1, x);
            errors[second][i] = trajectory_error(x, reference);
        }
    print_message("first order %.4f %.4f %.4f, second %.5f %.5f %.5f\n", errors[0][0], errors[0][1], errors[0][2],
                  errors[1][0], errors[1][1], errors[1][2]);
    if (!is_double)
        return; /* the displacement is 1e-3: float keeps four digits of it */
    for (int i = 0; i < 2; i++) {
        double ratio = errors[0][i] / errors[0][i + 1];
        assert_true(ratio > 1.7 && ratio < 2.6);
        ratio = errors[1][i] / errors[1][i + 1];
        assert_true(ratio > 3.3 && ratio < 4.7);
    }
    assert_true(errors[0][2] < 0.025 && errors[1][2] < 0.001);
}

/* ---- single vertices ---- */

/* gravity alone, both orders: position after n substeps of a fall from rest and with a start velocity */
static void test_free_fall(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(1);
    pel_body_def body = bare_body(mesh);
    pel_model_def model_def = pel_model_def_default();
    model_def.bodies = &body;
    model_def.body_count = 1;
    model_def.gravity[2] = -10;
    pel_model *model;
    assert_int_equal(pel_model_create(&model_def, &model, NULL), PEL_OK);
    double start[3 * 12], velocity[3 * 12], x[3 * 12];
    for (int m = 0; m < 3; m++)
        for (int second = 0; second < 2; second++) {
            pel_sim_def def = sim_of(model, methods[m], 0.01, 2);
            def.solver.second_order = second;
            pel_sim *sim = make_sim(&def);
            pel_sim_get_positions(sim, 0, start);
            for (int i = 0; i < 36; i++)
                velocity[i] = i % 3 == 2 ? 1 : 0.5;
            assert_int_equal(pel_sim_set_velocities(sim, 0, velocity, NULL), PEL_OK);
            run_steps(sim, 100);
            pel_sim_get_positions(sim, 0, x);
            pel_sim_get_velocities(sim, 0, velocity);
            for (int i = 0; i < 36; i++) {
                bool falls = i % 3 == 2;
                /* first order is g t h / 2 below */
                double expected = start[i] + (falls ? 1 - 5 : 0.5);
                assert_near(velocity[i], falls ? 1 - 10 : 0.5, is_double ? 1e-9 : 2e-3);
                assert_near(x[i], expected, !second ? 0.03 : is_double ? 1e-9 : 1e-3);
            }
            pel_sim_destroy(sim);
        }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* velocity after half a second of drag, in second order, less the exact one */
static double drag_error(const pel_model *model, int steps)
{
    pel_sim_def def = sim_of(model, PEL_METHOD_XPBD, 0.5 / steps, 1);
    def.solver.drag = 3;
    def.solver.second_order = true;
    pel_sim *sim = make_sim(&def);
    double velocity[3 * 92];
    for (int i = 0; i < 3 * 92; i++)
        velocity[i] = 1;
    assert_int_equal(pel_sim_set_velocities(sim, 0, velocity, NULL), PEL_OK);
    run_steps(sim, steps);
    pel_sim_get_velocities(sim, 0, velocity);
    pel_sim_destroy(sim);
    for (int i = 1; i < 3 * 92; i++)
        assert_near(velocity[i], velocity[0], is_double ? 1e-10 : 1e-3);
    return fabs(velocity[0] - exp(-1.5));
}

/* it slows what moves as in first order, and the error quarters with the step */
static void test_drag_in_second_order(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(3);
    pel_body_def body = bare_body(mesh);
    pel_model *model = make_model(&body);
    assert_true(drag_error(model, 10) < 0.01);
    if (is_double)
        assert_near(drag_error(model, 40) / drag_error(model, 80), 4, 0.4);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* theory page, section 11 e: a uniform load moves a body by f / k' exactly; pins stay; drag slows as it says */
static void test_volumetric_springs_pins_and_drag(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(3);
    pel_body_def body = bare_body(mesh);
    body.volumetric_stiffness.value = 4;
    body.volumetric_damping.value = 0.5;
    body.spring_damping.value = 1;
    pel_model *model = make_model(&body);
    pel_load_def load = pel_load_def_default();
    load.kind = PEL_LOAD_PER_VERTEX;
    load.force[0] = 0.8;
    double x[3 * 92];
    for (int m = 0; m < 3; m++) {
        pel_sim_def def = sim_of(model, methods[m], 0.05, 2);
        def.loads = &load;
        def.load_count = 1;
        pel_sim *sim = make_sim(&def);
        run_steps(sim, 800);
        pel_sim_get_positions(sim, 0, x);
        for (int i = 0; i < 3 * 92; i++)
            assert_near(x[i] - mesh->positions[i / 3][i % 3], i % 3 == 0 ? 0.2 : 0, is_double ? 1e-9 : 2e-4);
        pel_sim_destroy(sim);
    }
    pel_model_destroy(model);
    const int32_t pinned[1] = {5};
    body = bare_body(mesh);
    body.pinned = pinned;
    body.pinned_count = 1;
    model = make_model(&body);
    for (int m = 0; m < 3; m += 2) { /* without springs or membrane every vertex is alone */
        pel_sim_def def = sim_of(model, methods[m], 0.05, 2);
        def.solver.drag = 3;
        pel_sim *sim = make_sim(&def);
        double velocity[3 * 92];
        for (int i = 0; i < 3 * 92; i++)
            velocity[i] = 1;
        assert_int_equal(pel_sim_set_velocities(sim, 0, velocity, NULL), PEL_OK);
        run_steps(sim, 10);
        pel_sim_get_velocities(sim, 0, velocity);
        pel_sim_get_positions(sim, 0, x);
        for (int i = 0; i < 3 * 92; i++)
            assert_near(velocity[i], i / 3 == 5 ? 0 : exp(-1.5), is_double ? 1e-12 : 1e-5);
        for (int c = 0; c < 3; c++)
            assert_near(x[15 + c], mesh->positions[5][c], 1e-7);
        pel_sim_destroy(sim);
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* paper A's springs by compliance come to rest where the explicit method does */
static void test_springs_come_to_the_same_rest(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(5);
    pel_body_def body = ball_body(mesh);
    pel_model *model = make_model(&body);
    const int32_t pole[1] = {nearest_vertex(mesh, 0, 0, 1)};
    pel_load_def load = pel_load_def_default();
    load.force[2] = -1;
    load.vertices = pole;
    load.vertex_count = 1;
    double heights[2];
    for (int m = 0; m < 2; m++) {
        pel_sim_def def = sim_of(model, m == 0 ? PEL_METHOD_EXPLICIT : PEL_METHOD_XPBD, 0.02, m == 0 ? 0 : 2);
        def.loads = &load;
        def.load_count = 1;
        pel_sim *sim = make_sim(&def);
        run_steps(sim, 3000);
        heights[m] = height_of(sim, pole[0]);
        pel_sim_destroy(sim);
    }
    print_message("pole at %.6f (explicit) and %.6f (xpbd)\n", heights[0], heights[1]);
    assert_true(heights[0] < 0.8);
    assert_near(heights[1], heights[0], 1e-3);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* ---- regions ---- */

/* mean radius of the cap around +z and of the rest after some steps with a region there */
static void region_radii(pel_fibre_mode mode, pel_method method, double pressure, double radii[2])
{
    pel_mesh *mesh = make_sphere(8);
    double *weights = calloc((size_t)mesh->vertex_count, sizeof *weights);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        weights[v] = mesh->positions[v][2] > 0.8;
    pel_anisotropy_def region = pel_anisotropy_def_default();
    region.mode = mode;
    region.weights = weights;
    region.stiffness = 1e4;
    region.strength = 0.2;
    region.max_step = 0.02;
    region.rest_length.value = 0.5;
    region.center[2] = 1;
    pel_body_def body = pel_body_def_sheet("body", mesh, 1e5, 0.01, 1000);
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.anisotropies = &region;
    body.shell.anisotropy_count = 1;
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body.shell.pressure.outside.value = pressure;
    pel_model *model = make_model(&body);
    pel_sim_def def = sim_of(model, method, 1.0 / 60, 0);
    def.solver.drag = 1;
    pel_sim *sim = make_sim(&def);
    run_steps(sim, 8);
    double *x = malloc(3 * (size_t)mesh->vertex_count * sizeof *x), counts[2] = {0, 0};
    pel_sim_get_positions(sim, 0, x);
    radii[0] = radii[1] = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        int part = mesh->positions[v][2] > 0.8 ? 0 : 1;
        radii[part] += sqrt(x[3 * v] * x[3 * v] + x[3 * v + 1] * x[3 * v + 1] + x[3 * v + 2] * x[3 * v + 2]);
        counts[part]++;
    }
    for (int part = 0; part < 2; part++)
        radii[part] /= counts[part];
    free(x);
    free(weights);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* fibres that shorten press the cap flat; a cap that caves in needs strain from elsewhere, and then goes deeper */
static void test_regions(void **unused)
{
    (void)unused;
    double radii[2], without[2];
    for (int m = 0; m < 3; m += 2) {
        region_radii(PEL_FIBRE_ACTIVE, methods[m], 0, radii);
        assert_true(radii[0] < radii[1] - 0.01);
        region_radii(PEL_FIBRE_CAVE, methods[m], 0, radii);
        assert_near(radii[0], 1, 1e-6);
        region_radii(PEL_FIBRE_STRAIN, methods[m], 0, radii);
        assert_near(radii[0], 1, 1e-6);
        region_radii(PEL_FIBRE_CAVE, methods[m], 40, radii);
        region_radii(PEL_FIBRE_STRAIN, methods[m], 40, without);
        assert_true(radii[0] < without[0] - 0.005);
        region_radii(PEL_FIBRE_CURL, methods[m], 0, radii);
        assert_true(radii[0] < radii[1]);
    }
}

/* the farthest that a vertex goes in each of some steps from a ball of another radius, over max_step of its edges; no
   membrane holds it */
static double longest_cave(const pel_solver_def *solver, double strength, double radius)
{
    enum { STEPS = 12 };
    pel_mesh *mesh = make_sphere(6);
    pel_anisotropy_def region = pel_anisotropy_def_default();
    region.strength = strength;
    region.center[2] = 3;
    pel_body_def body = bare_body(mesh);
    body.shell.anisotropies = &region;
    body.shell.anisotropy_count = 1;
    pel_model *model = make_model(&body);
    pel_sim_def def = sim_of(model, solver->method, solver->dt, solver->substeps);
    def.solver.iterations = solver->iterations;
    pel_sim *sim = make_sim(&def);
    size_t count = 3 * (size_t)mesh->vertex_count;
    double *x = malloc(count * sizeof *x), *y = malloc(count * sizeof *y), edge = 0, farthest = 0;
    for (size_t i = 0; i < count; i++)
        x[i] = radius * mesh->positions[i / 3][i % 3];
    assert_int_equal(pel_sim_set_positions(sim, 0, x, NULL), PEL_OK);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        double area = pel_vec3_triangle_area(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]]);
        edge = fmax(edge, sqrt(4 / sqrt(3.0) * area));
    }
    for (int n = 0; n < STEPS; n++) {
        run_steps(sim, 1);
        pel_sim_get_positions(sim, 0, y);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            farthest = fmax(farthest, pel_vec3_distance(x + 3 * v, y + 3 * v));
        memcpy(x, y, count * sizeof *x);
    }
    free(x);
    free(y);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
    return farthest / (region.max_step * edge);
}

/* going in is bounded by max_step of an edge in a step, whatever the strength, sweeps, substeps and steps before */
static void test_cave_is_bounded(void **unused)
{
    (void)unused;
    static const pel_solver_def runs[] = {
        {.method = PEL_METHOD_PBD, .iterations = 1, .substeps = 1, .dt = 1.0 / 60},
        {.method = PEL_METHOD_PBD, .iterations = 50, .substeps = 1, .dt = 1.0 / 60},
        {.method = PEL_METHOD_PBD, .iterations = 5, .substeps = 4, .dt = 1e-3},
        {.method = PEL_METHOD_XPBD, .iterations = 1, .substeps = 16, .dt = 1.0 / 60},
        {.method = PEL_METHOD_XPBD, .iterations = 4, .substeps = 8, .dt = 1e-3},
    };
    for (size_t r = 0; r < sizeof runs / sizeof *runs; r++) {
        double full = longest_cave(&runs[r], 1e6, 0.9);
        assert_true(full > 0.7 && full < 1.02);
        assert_true(longest_cave(&runs[r], 1e-9, 0.9) < (is_double ? 1e-4 : 1e-3));
        /* stretch does not drive */
        assert_true(longest_cave(&runs[r], 1e6, 1.1) < (is_double ? 1e-12 : 1e-3));
    }
}

/* paper B's shell with a region: it caves in, and neither it nor the rest grows */
static void test_cave_keeps_area(void **unused)
{
    (void)unused;
    double volumes[2];
    for (int kind = 0; kind <= PEL_FIBRE_SQRT; kind++)
        for (int on = 0; on < 2; on++) {
            pel_mesh *mesh = make_sphere(8);
            pel_anisotropy_def region = pel_anisotropy_def_default();
            double *weights = calloc((size_t)mesh->vertex_count, sizeof *weights);
            for (int32_t v = 0; v < mesh->vertex_count; v++)
                weights[v] = mesh->positions[v][2] > 0.8;
            region.kind = (pel_fibre_kind)kind;
            region.weights = weights;
            region.strength = 0.3;
            region.center[2] = 1;
            pel_body_def body = pressed_body(mesh, 1e5, 0.01);
            body.shell.bending.model = PEL_BENDING_ISOMETRIC;
            body.shell.bending.weight = 0.01;
            body.shell.pressure.outside.value = 24;
            body.shell.anisotropies = &region;
            body.shell.anisotropy_count = on;
            pel_model *model = make_model(&body);
            pel_sim_def def = sim_of(model, PEL_METHOD_PBD, 1.0 / 60, 0);
            pel_sim *sim = make_sim(&def);
            pel_sim_measures measures;
            run_steps(sim, 50);
            pel_sim_measure(sim, &measures);
            volumes[on] = measures.volume_ratio;
            assert_near(measures.area_ratio, 1, 0.03);
            print_message("fibres %d: volume %.4f, area %.4f\n", on ? kind : -1, volumes[on], measures.area_ratio);
            pel_sim_destroy(sim);
            pel_model_destroy(model);
            pel_mesh_destroy(mesh);
            free(weights);
            if (on)
                assert_true(volumes[1] < volumes[0] - 0.03 && volumes[1] > 0.3);
        }
}

/* ---- the energy with its gradient along the normal ---- */

typedef struct pushed_run {
    pel_method method;
    pel_fibre_kind kind;
    int32_t iterations, substeps;
    double gradient, pressure;
    const double *axis; /* of the fibres; null = towards the pole */
} pushed_run;

typedef struct pushed_shape {
    double depth; /* m, mean way inward of the cap */
    double area;  /* over that at rest */
    double
        across[2];  /* m, mean square distance from the plane x = 0, and y = 0, of what went in, weighted by the way */
    double limited; /* largest share of a step's corrections that the bound cut, over a frame's mean */
} pushed_shape;

/* a ball that is alike along x and y */
static pel_mesh *make_even_sphere(void)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_UV_SPHERE);
    pel_mesh *mesh;
    def.slices = 24;
    def.rings = 16;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

/* a ball with fibres at its pole under a pressure that shortens them, after some steps */
static pushed_shape run_pushed(const pushed_run *run)
{
    enum { STEPS = 40 };
    pel_mesh *mesh = run->axis != NULL ? make_even_sphere() : make_sphere(8);
    pel_anisotropy_def region = pel_anisotropy_def_default();
    double *weights = calloc((size_t)mesh->vertex_count, sizeof *weights);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        weights[v] = mesh->positions[v][2] > 0.87;
    region.mode = PEL_FIBRE_NORMAL;
    region.kind = run->kind;
    region.weights = weights;
    region.stiffness = 1e3;
    region.gradient = run->gradient;
    region.center[2] = 1;
    if (run->axis != NULL) {
        region.direction = PEL_FIBRE_ALONG;
        memcpy(region.axis, run->axis, sizeof region.axis);
    }
    pel_body_def body = pressed_body(mesh, 1e5, 0.01);
    bool literal = run->method == PEL_METHOD_PBD;
    body.shell.bending.model = literal ? PEL_BENDING_ISOMETRIC : PEL_BENDING_HINGE;
    body.shell.bending.weight = 0.01;
    body.shell.pressure.outside.value = run->pressure;
    body.shell.anisotropies = &region;
    body.shell.anisotropy_count = run->gradient > 0;
    pel_model *model = make_model(&body);
    pel_sim_def def = sim_of(model, run->method, 1.0 / 60, run->substeps);
    def.solver.iterations = run->iterations > 0 ? run->iterations : def.solver.iterations;
    def.solver.drag = literal ? 0 : 5;
    pel_sim *sim = make_sim(&def);
    pushed_shape shape = {0};
    for (int n = 0; n < STEPS; n++) {
        pel_solver_reading reading;
        run_steps(sim, 1);
        pel_sim_get_solver(sim, &reading);
        assert_true(reading.has_caving == (literal && run->gradient > 0));
        shape.limited += reading.has_caving ? reading.caving_limited / STEPS : 0;
    }
    pel_sim_measures measures;
    pel_sim_measure(sim, &measures);
    shape.area = measures.area_ratio;
    double *x = malloc(3 * (size_t)mesh->vertex_count * sizeof *x), count = 0, sum = 0;
    pel_sim_get_positions(sim, 0, x);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        if (mesh->positions[v][2] < 0.5)
            continue;
        double way = 1 - pel_vec3_dot(x + 3 * v, mesh->positions[v]);
        if (weights[v] > 0) {
            shape.depth += way;
            count++;
        }
        sum += way;
        for (int c = 0; c < 2; c++)
            shape.across[c] += way * mesh->positions[v][c] * mesh->positions[v][c];
    }
    shape.depth /= count;
    for (int c = 0; c < 2; c++)
        shape.across[c] /= sum;
    free(x);
    free(weights);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
    return shape;
}

/* over three decades of k_A the cap goes in deeper and deeper, the area stays, and the bound hardly acts */
static void test_depth_follows_the_gradient(void **unused)
{
    (void)unused;
    static const struct {
        pushed_run run;
        double first, factor;
        int count;
    } cases[] = {{{.method = PEL_METHOD_PBD, .pressure = 10}, 1000, 1 / 3.17, 7},
                 {{.method = PEL_METHOD_PBD, .pressure = 10, .kind = PEL_FIBRE_STVK}, 4000, 1 / 3.17, 7},
                 {{.method = PEL_METHOD_XPBD, .substeps = 20, .pressure = 6}, 1000, 0.1, 4}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        pushed_run run = cases[c].run;
        double before = run_pushed(&run).depth;
        run.gradient = cases[c].first;
        for (int i = 0; i < cases[c].count; i++) {
            pushed_shape shape = run_pushed(&run);
            print_message("method %d, kind %d, k_A %g: depth %.5f, area %.4f, limited %.4f\n", (int)run.method,
                          (int)run.kind, run.gradient, shape.depth, shape.area, shape.limited);
            assert_true(shape.depth > before * (1 + 1e-6));
            assert_near(shape.area, 1, 0.05);
            assert_true(shape.limited < 0.05);
            before = shape.depth;
            run.gradient *= cases[c].factor;
        }
    }
}

/* the dent is narrower along the fibres, or longer, and turns with them */
static void test_fibres_turn_the_dent(void **unused)
{
    (void)unused;
    static const double axes[2][3] = {{1, 0, 0}, {0, 1, 0}};
    static const pel_method two[] = {PEL_METHOD_PBD, PEL_METHOD_XPBD};
    for (int m = 0; m < 2; m++) {
        pushed_shape shapes[2];
        for (int a = 0; a < 2; a++)
            shapes[a] = run_pushed(&(pushed_run){.method = two[m],
                                                 .substeps = m == 0 ? 0 : 20,
                                                 .gradient = m == 0 ? 5 : 2,
                                                 .pressure = m == 0 ? 10 : 6,
                                                 .axis = axes[a]});
        double first = shapes[0].across[0] - shapes[0].across[1], second = shapes[1].across[0] - shapes[1].across[1];
        print_message("method %d: %g along x, %g along y\n", (int)two[m], first, second);
        assert_true(first * second < 0 && fabs(first) > 2e-4);
        assert_near(second, -first, 0.1 * fabs(first));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sheet_reaches_closed_forms),
        cmocka_unit_test(test_pressurised_sphere),
        cmocka_unit_test(test_error_falls_with_dt),
        cmocka_unit_test(test_free_fall),
        cmocka_unit_test(test_drag_in_second_order),
        cmocka_unit_test(test_volumetric_springs_pins_and_drag),
        cmocka_unit_test(test_springs_come_to_the_same_rest),
        cmocka_unit_test(test_regions),
        cmocka_unit_test(test_cave_is_bounded),
        cmocka_unit_test(test_cave_keeps_area),
        cmocka_unit_test(test_depth_follows_the_gradient),
        cmocka_unit_test(test_fibres_turn_the_dent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
