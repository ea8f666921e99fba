/* Steps in time by Newton's method: order, what is kept, and what touches. */
#include "sim/contact_scene.h"
#include "sim/descent_fixture.h"

/* ---- free motion ---- */

/* a thick shell, as a sphere */
static void make_shell(stage *s, pel_body_def *body, double drag, double dt, pel_sim_def *def)
{
    s->mesh = make_sphere(2);
    *body = pel_body_def_default();
    body->name = "shell";
    body->mesh = s->mesh;
    body->mass_kind = PEL_MASS_DENSITY;
    body->mass = 1000;
    body->thickness.value = 0.1;
    body->spring_stiffness.value = body->spring_damping.value = 0;
    body->volumetric_stiffness.value = body->volumetric_damping.value = 0;
    body->shell.membrane.on = true;
    body->shell.membrane.kind = PEL_MEMBRANE_STVK;
    body->shell.membrane.young.value = 1e4;
    body->shell.membrane.thickness.value = 0.1;
    body->shell.bending.model = PEL_BENDING_HINGE;
    s->model = make_model(body);
    *def = lone_sim(s->model, PEL_METHOD_IMPLICIT, dt);
    def->solver.drag = drag;
    s->sim = make_sim(def);
}

/* velocities of an oval motion, m/s, plus a common one */
static void set_oval(const stage *s, double speed, double common)
{
    double *v = malloc(3 * (size_t)s->mesh->vertex_count * sizeof *v);
    for (int32_t i = 0; i < s->mesh->vertex_count; i++) {
        const double *x = s->mesh->positions[i];
        v[3 * i] = speed * x[0] + common;
        v[3 * i + 1] = -speed * x[1];
        v[3 * i + 2] = 0.3 * speed * x[0];
    }
    assert_int_equal(pel_sim_set_velocities(s->sim, 0, v, NULL), PEL_OK);
    free(v);
}

/* kg over density and thickness: a third of the triangles around */
static double mass_of(const stage *s, int32_t vertex)
{
    double sum = 0;
    for (int32_t t = 0; t < s->mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            const int32_t *corner = s->mesh->triangles[t];
            double u[3], v[3], normal[3];
            if (corner[i] != vertex)
                continue;
            pel_vec3_subtract(s->mesh->positions[corner[1]], s->mesh->positions[corner[0]], u);
            pel_vec3_subtract(s->mesh->positions[corner[2]], s->mesh->positions[corner[0]], v);
            pel_vec3_cross(u, v, normal);
            sum += pel_vec3_length(normal) / 6;
        }
    return sum;
}

/* where the vertices are after a time in so many steps */
static void vibrate(double drag, int steps, double x[3 * 100])
{
    stage s;
    pel_body_def body;
    pel_sim_def def;
    make_shell(&s, &body, drag, 0.4 / steps, &def);
    assert_true(s.mesh->vertex_count <= 100);
    set_oval(&s, 0.3, 0);
    run_steps(s.sim, steps);
    pel_sim_get_positions(s.sim, 0, x);
    end_stage(&s);
}

static double distance_of(const double *a, const double *b)
{
    double square = 0;
    for (int i = 0; i < 3 * 42; i++)
        square += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(square);
}

/* midpoint rule without drag, BDF2 with it: a quarter of the error at half the step */
static void test_order(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == 4)
        skip();
    for (int i = 0; i < 2; i++) {
        double drag = i, exact[300], coarse[300], fine[300];
        vibrate(drag, 640, exact);
        vibrate(drag, 40, coarse);
        vibrate(drag, 80, fine);
        double order = log2(distance_of(coarse, exact) / distance_of(fine, exact));
        assert_true(distance_of(coarse, exact) > 1e-6);
        assert_near(order, 2, 0.25);
    }
}

/* J, over many periods of large strains */
static void test_energy(void **unused)
{
    (void)unused;
    stage s;
    pel_body_def body;
    pel_sim_def def;
    pel_sim_measures measures;
    make_shell(&s, &body, 0, 0.01, &def);
    set_oval(&s, 0.5, 0);
    pel_sim_measure(s.sim, &measures);
    double start = measures.kinetic_energy + measures.elastic_energy, most = 0, elastic = 0;
    for (int n = 0; n < ROUNDS(1000, 100); n++) {
        run_steps(s.sim, 1);
        pel_sim_measure(s.sim, &measures);
        most = fmax(most, fabs(measures.kinetic_energy + measures.elastic_energy - start));
        elastic = fmax(elastic, measures.elastic_energy);
    }
    assert_true(elastic > 0.3 * start);
    assert_true(most < 0.01 * start);
    end_stage(&s);
}

/* momentum stays without drag and falls as exp(-drag t) with it */
static void test_momentum(void **unused)
{
    (void)unused;
    for (int i = 0; i < 2; i++) {
        stage s;
        pel_body_def body;
        pel_sim_def def;
        double v[300], sum = 0, before = 0, drag = 2.0 * i;
        make_shell(&s, &body, drag, 0.01, &def);
        set_oval(&s, 0.2, 1);
        pel_sim_get_velocities(s.sim, 0, v);
        for (int k = 0; k < s.mesh->vertex_count; k++)
            before += v[3 * k] * mass_of(&s, k);
        run_steps(s.sim, 100);
        pel_sim_get_velocities(s.sim, 0, v);
        for (int k = 0; k < s.mesh->vertex_count; k++)
            sum += v[3 * k] * mass_of(&s, k);
        assert_near(sum / before, exp(-drag), i == 1 ? 1e-4 : sizeof(pel_real) == 4 ? 1e-4 : 1e-6);
        end_stage(&s);
    }
}

/* A load that grows with time gives a speed of f t^2 / 2 m, exactly so under the midpoint rule. */
static void test_load_in_time(void **unused)
{
    (void)unused;
    const pel_key keys[] = {{0, 0}, {1, 1}};
    stage s;
    pel_body_def body;
    pel_sim_def def;
    double v[300], momentum = 0, force = 0.5;
    pel_load_def load = pel_load_def_default();
    make_shell(&s, &body, 0, 0.02, &def);
    pel_sim_destroy(s.sim);
    load.force[1] = force;
    load.keys = keys;
    load.key_count = 2;
    def.loads = &load;
    def.load_count = 1;
    s.sim = make_sim(&def);
    run_steps(s.sim, 20);
    pel_sim_get_velocities(s.sim, 0, v);
    for (int k = 0; k < s.mesh->vertex_count; k++)
        momentum += v[3 * k + 1] * mass_of(&s, k);
    /* 100 kg/m2, and the force is that on all vertices together */
    assert_near(100 * momentum / (0.5 * force * 0.4 * 0.4), 1, sizeof(pel_real) == 4 ? 1e-4 : 1e-6);
    end_stage(&s);
}

/* A target volume that grows: the volume follows, and the ledger closes. */
static void test_driven_volume(void **unused)
{
    (void)unused;
    const pel_key keys[] = {{0, 1}, {0.4, 1.4}};
    stage s;
    pel_body_def body;
    pel_sim_def def;
    pel_sim_ledger ledger;
    pel_sim_measures measures;
    make_shell(&s, &body, 0, 0.02, &def);
    end_stage(&s);
    s.mesh = make_sphere(2);
    body.mesh = s.mesh;
    body.shell.pressure.kind = PEL_PRESSURE_VOLUME;
    body.shell.pressure.target = (pel_quantity){.value = 1, .keys = keys, .key_count = 2};
    body.shell.pressure.bulk = 1e6;
    s.model = make_model(&body);
    def.model = s.model;
    s.sim = make_sim(&def);
    for (int n = 1; n <= 20; n++) {
        run_steps(s.sim, 1);
        pel_sim_measure(s.sim, &measures);
        assert_near(measures.volume_ratio, 1 + 0.02 * n, 0.002);
    }
    pel_sim_get_ledger(s.sim, &ledger);
    assert_true(ledger.work_pressure > 100);
    assert_near((ledger.energy_error + ledger.dissipated_solver) / ledger.supplied, 0, 0.02);
    end_stage(&s);
}

/* ---- what touches ---- */

/* A sheet on a slope, across the edges of a flat mesh: g (sin - mu cos) t^2 / 2. */
static void test_slide(void **unused)
{
    (void)unused;
    for (int i = 0; i < 2; i++) {
        const double gravity = 10, sine = 0.6, cosine = 0.8, mu = i == 0 ? 0 : 0.4, time = 0.6;
        contact_scene scene;
        scene_begin(&scene, PEL_METHOD_IMPLICIT);
        scene_body(&scene, make_sheet(6, 0));
        scene.bodies[0].spring_damping.value = 0;
        pel_shape_def ground = pel_shape_def_default(PEL_SHAPE_GRID);
        ground.nx = ground.ny = 9;
        ground.size_x = ground.size_y = 8;
        assert_int_equal(pel_shape_create(&ground, &scene.tool_mesh, NULL), PEL_OK);
        scene_tool(&scene, PEL_TOOL_MESH)->mesh = scene.tool_mesh;
        scene_move(&scene, 0, 0.31, 0.17, -5e-4, -5e-4, 1);
        scene.gravity = -gravity * cosine;
        scene.gravity_along = gravity * sine;
        scene.def.contact.friction = mu;
        scene.def.contact.thickness = 5e-4;
        scene.def.solver.dt = 0.01;
        pel_sim *sim = scene_create(&scene);
        double before[3 * 49], after[3 * 49], way = 0;
        pel_sim_get_positions(sim, 0, before);
        run_steps(sim, (int)(time / 0.01 + 0.5));
        pel_sim_get_positions(sim, 0, after);
        for (int v = 0; v < 49; v++)
            way += (after[3 * v] - before[3 * v]) / 49;
        assert_near(way / (0.5 * gravity * (sine - mu * cosine) * time * time), 1, 0.04);
        scene_end(&scene, sim);
    }
}

/* a ball of which a round tool presses: few systems a step, for its tangent is right */
static void test_round_tool(void **unused)
{
    (void)unused;
    press_scene scene;
    press_begin(&scene, 5, 1e5);
    press_move(&scene, 1.5, 0.08);
    scene.def.solver.method = PEL_METHOD_IMPLICIT;
    scene.def.solver.dt = 0.02;
    scene.def.solver.drag = 1;
    scene.def.solver.iterations = 0;
    pel_sim *sim = press_create(&scene);
    int most = 0;
    for (int n = 0; n < 50; n++) {
        run_steps(sim, 1);
        assert_true(solver_of(sim).converged);
        most = solver_of(sim).iterations > most ? solver_of(sim).iterations : most;
    }
    assert_true(reading_of(sim, 0).force[2] > 0);
    assert_true(most < 60);
    press_end(&scene, sim);
}

/* the same bits for any number of threads, and after a snapshot */
static void check_bits(pel_method method, double drag)
{
    uint64_t hash[4];
    for (int i = 0; i < 4; i++) {
        press_scene scene;
        press_begin(&scene, 8, 1e5);
        press_move(&scene, 1.5, 0.08);
        scene.def.solver.method = method;
        scene.def.solver.dt = 0.05;
        scene.def.solver.drag = drag;
        scene.def.solver.iterations = 0;
        scene.def.thread_count = i == 1 ? 2 : i == 2 ? 4 : 1;
        pel_sim *sim = press_create(&scene);
        run_steps(sim, 4);
        if (i == 3)
            sim = resume_sim(sim, &scene.def);
        run_steps(sim, 4);
        hash[i] = pel_sim_hash(sim);
        assert_true(hash[i] == hash[0]);
        press_end(&scene, sim);
    }
}

static void test_bits(void **unused)
{
    (void)unused;
    check_bits(PEL_METHOD_IMPLICIT, 1);
    check_bits(PEL_METHOD_STATIC, 0);
}

static void test_refusal(void **unused)
{
    (void)unused;
    static const pel_method methods[] = {PEL_METHOD_STATIC, PEL_METHOD_IMPLICIT};
    stage s = {.mesh = make_sphere(2)};
    pel_body_def body = ball_body(s.mesh);
    body.refine.levels = 1;
    s.model = make_model(&body);
    for (int i = 0; i < 2; i++) {
        pel_sim_def def = lone_sim(s.model, methods[i], 0.01);
        pel_error error;
        char text[800];
        assert_int_equal(pel_sim_create(&def, &s.sim, &error), PEL_BAD_ARGUMENT);
        assert_non_null(strstr(pel_error_text(&error, text, sizeof text), "refine"));
    }
    end_stage(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_order),        cmocka_unit_test(test_energy),        cmocka_unit_test(test_momentum),
        cmocka_unit_test(test_load_in_time), cmocka_unit_test(test_driven_volume), cmocka_unit_test(test_slide),
        cmocka_unit_test(test_round_tool),   cmocka_unit_test(test_bits),          cmocka_unit_test(test_refusal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
