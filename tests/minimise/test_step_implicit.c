/* Steps in time by Newton's method: order, conservation, and contact. */
#include "constraint/constraint.h"
#include "pellicle/geometry.h"
#include "pellicle/shape.h"
#include "sim/contact_scene.h"
#include "sim/descent_fixture.h"
#include "stage/stage.h"

/* ---- free motion ---- */

/* a thick shell of the mesh of the stage */
static void make_shell_of_mesh(stage *s, pel_body_def *body, double young, double drag, double dt, pel_sim_def *def)
{
    *body = pel_body_def_sheet("shell", s->mesh, young, 0.1, 1000);
    body->shell.membrane.kind = PEL_MEMBRANE_STVK;
    body->shell.bending.model = PEL_BENDING_HINGE;
    s->model = make_model(body);
    *def = lone_sim(s->model, PEL_METHOD_IMPLICIT, dt);
    def->solver.drag = drag;
    s->sim = make_sim(def);
}

static void make_shell(stage *s, pel_body_def *body, double young, double drag, double dt, pel_sim_def *def)
{
    s->mesh = make_sphere(2);
    make_shell_of_mesh(s, body, young, drag, dt, def);
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
static void vibrate(double drag, bool in_stages, int steps, double x[3 * 100])
{
    stage s;
    pel_body_def body;
    pel_sim_def def;
    make_shell(&s, &body, 1e4, drag, 0.4 / steps, &def);
    assert_true(s.mesh->vertex_count <= 100);
    set_oval(&s, 0.3, 0);
    s.sim->state->unresolved = in_stages ? INT32_MAX : 0;
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

/* midpoint rule without drag, BDF2 with it, two stages, midpoint rule with light drag: a quarter of the error at half
   the step */
static void test_order(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == 4)
        skip();
    const double drags[] = {0, 4, 0, 0.4};
    for (int i = 0; i < 4; i++) {
        double drag = drags[i], exact[300], coarse[300], fine[300];
        vibrate(drag, i == 2, 640, exact);
        vibrate(drag, i == 2, i == 2 ? 20 : 40, coarse);
        vibrate(drag, i == 2, i == 2 ? 40 : 80, fine);
        double order = log2(distance_of(coarse, exact) / distance_of(fine, exact));
        assert_true(distance_of(coarse, exact) > 1e-6);
        assert_near(order, 2, 0.25);
    }
}

/* J, elastic and kinetic */
static double energy_of(const stage *s)
{
    pel_sim_measures measures;
    pel_sim_measure(s->sim, &measures);
    return measures.elastic_energy + measures.kinetic_energy;
}

/* What a step resolves keeps its energy in two stages; what it does not is damped at once, except for the rotation of
   the ball: 0.0215 of the energy. */
static void test_stages(void **unused)
{
    (void)unused;
    for (int fast = 0; fast < 2; fast++) {
        stage s;
        pel_body_def body;
        pel_sim_def def;
        make_shell(&s, &body, fast ? 1e12 : 1e4, 0, 0.01, &def);
        set_oval(&s, 0.01, 0);
        double start = energy_of(&s);
        s.sim->state->unresolved = INT32_MAX;
        run_steps(s.sim, fast ? 3 : 200);
        double left = energy_of(&s) / start;
        assert_true(fast ? fabs(left - 0.0215) < 0.002 : left > 0.9 && left < 1);
        end_stage(&s);
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
    make_shell(&s, &body, 1e4, 0, 0.01, &def);
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

/* light drag d leaves exp(-d t) of the energy, and the steps take nothing beside */
static void test_light_drag(void **unused)
{
    (void)unused;
    stage s;
    pel_body_def body;
    pel_sim_def def;
    pel_sim_ledger ledger;
    make_shell(&s, &body, 1e4, 0.2, 0.02, &def);
    set_oval(&s, 0.1, 0);
    double start = energy_of(&s);
    run_steps(s.sim, 200);
    assert_near(energy_of(&s) / start, exp(-0.2 * 4), 0.01);
    pel_sim_get_ledger(s.sim, &ledger);
    assert_near(ledger.dissipated_drag / start, 1 - exp(-0.2 * 4), 0.01);
    end_stage(&s);
}

/* most energy over that at the start, and the energy left, of an ellipsoid that spins for 300 steps of 0.01 s */
static void spin(double young, const double scale[3], const double speed[3], double *most, double *left)
{
    stage s = {.mesh = make_sphere(2)};
    pel_body_def body;
    pel_sim_def def;
    pel_sim_measures measures;
    double v[3 * 42];
    pel_transform transform = pel_transform_default();
    pel_vec3_copy(scale, transform.scale);
    assert_int_equal(pel_mesh_transform(s.mesh, &transform, NULL), PEL_OK);
    make_shell_of_mesh(&s, &body, young, 0, 0.01, &def);
    assert_int_equal(s.mesh->vertex_count, 42);
    for (int32_t i = 0; i < 42; i++)
        pel_vec3_cross(speed, s.mesh->positions[i], v + 3 * i);
    assert_int_equal(pel_sim_set_velocities(s.sim, 0, v, NULL), PEL_OK);
    pel_sim_measure(s.sim, &measures);
    double start = measures.kinetic_energy;
    *most = 0;
    for (int n = 0; n < 300; n++) {
        run_steps(s.sim, 1);
        pel_sim_measure(s.sim, &measures);
        *left = (measures.kinetic_energy + measures.elastic_energy) / start;
        *most = fmax(*most, *left);
    }
    end_stage(&s);
}

/* A shell that turns by 0.025 rad a step stops if the residual is relative to momentum over dt. One that is stiffer and
   turns by 0.1 rad a step gains energy under the midpoint rule alone; by 0.3 rad a step it loses half of it under BDF2
   alone, and more where it tumbles. */
static void test_spin(void **unused)
{
    (void)unused;
    const double ball[3] = {1, 1, 1}, long_and_flat[3] = {1, 0.6, 0.3};
    double most, left;
    spin(1e7, ball, (const double[3]){0, 0, 2.5}, &most, &left);
    assert_true(most < 1.001 && left > 0.99);
    spin(1e10, ball, (const double[3]){0, 0, 10}, &most, &left);
    assert_true(most < 1.001 && left > 0.99);
    spin(1e10, ball, (const double[3]){0, 0, 30}, &most, &left);
    assert_true(most < 1.001 && left > 0.99);
    spin(1e9, long_and_flat, (const double[3]){3, 25, 4}, &most, &left);
    assert_true(most < 1.01 && left > 0.95);
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
        make_shell(&s, &body, 1e4, drag, 0.01, &def);
        set_oval(&s, 0.2, 1);
        pel_sim_get_velocities(s.sim, 0, v);
        for (int k = 0; k < s.mesh->vertex_count; k++)
            before += v[3 * k] * mass_of(&s, k);
        run_steps(s.sim, 100);
        pel_sim_get_velocities(s.sim, 0, v);
        for (int k = 0; k < s.mesh->vertex_count; k++)
            sum += v[3 * k] * mass_of(&s, k);
        assert_near(sum / before, exp(-drag), i == 1 ? 1e-4 : sizeof(pel_real) == 4 ? 1e-4 : 1e-12);
        end_stage(&s);
    }
}

/* Velocities that the caller sets have no past: BDF2 would make four thirds of them. */
static void test_set_velocities(void **unused)
{
    (void)unused;
    stage s;
    pel_body_def body;
    pel_sim_def def;
    double v[300], sum = 0, mass = 0;
    make_shell(&s, &body, 1e4, 2, 0.01, &def);
    run_steps(s.sim, 3);
    for (int k = 0; k < s.mesh->vertex_count; k++)
        pel_vec3_set(v + 3 * (size_t)k, 1, 0, 0);
    assert_int_equal(pel_sim_set_velocities(s.sim, 0, v, NULL), PEL_OK);
    run_steps(s.sim, 1);
    pel_sim_get_velocities(s.sim, 0, v);
    for (int k = 0; k < s.mesh->vertex_count; k++) {
        sum += v[3 * k] * mass_of(&s, k);
        mass += mass_of(&s, k);
    }
    assert_near(sum / mass, 1 / 1.02, 1e-4);
    end_stage(&s);
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
    make_shell(&s, &body, 1e4, 0, 0.02, &def);
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
    make_shell(&s, &body, 1e4, 0, 0.02, &def);
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

/* ---- contact ---- */

/* A sheet on a slope, across the edges of a flat mesh: g (sin - mu cos) t^2 / 2. One of steel whose friction nearly
   holds it: what sticks is so stiff that the first steps of Newton's method are very short. */
static void test_slide(void **unused)
{
    (void)unused;
    /* in float the forces of steel drown in the rounding of positions */
    const int count = sizeof(pel_real) == 8 ? 3 : 2;
    for (int i = 0; i < count; i++) {
        const double gravity = 10, sine = 0.6, cosine = 0.8, time = 0.6;
        const double friction[3] = {0, 0.4, 0.735}, mu = friction[i];
        contact_scene scene;
        scene_begin(&scene, PEL_METHOD_IMPLICIT);
        scene_body(&scene, make_sheet(6, 0));
        scene.bodies[0].spring_damping.value = scene.bodies[0].volumetric_damping.value = 0;
        if (i == 2) {
            scene.bodies[0].spring_stiffness.value = 0;
            scene.bodies[0].shell.membrane.on = true;
            scene.bodies[0].shell.membrane.young.value = 2e11;
            scene.bodies[0].shell.membrane.thickness.value = 5e-4;
        }
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
        /* the slack of the contact is closed in the first steps, which are of first order */
        assert_near(way / (0.5 * gravity * (sine - mu * cosine) * time * time), 1, i == 2 ? 0.025 : 0.004);
        scene_end(&scene, sim);
    }
}

/* A sheet that lies on a box rests: its steps need no linear system, and it stays where it is. */
static void test_rests(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_solver_reading reading;
    double before[3 * 49], after[3 * 49];
    scene_begin(&scene, PEL_METHOD_IMPLICIT);
    scene_body(&scene, make_sheet(6, 0));
    scene_tool(&scene, PEL_TOOL_BOX);
    for (int k = 0; k < 3; k++)
        scene.tools[0].half_extents[k] = 4;
    scene_move(&scene, 0, 0, 0, -4.0005, -4.0005, 1);
    scene.gravity = -10;
    scene.def.contact.friction = 0.3;
    scene.def.contact.thickness = 5e-4;
    scene.def.solver.dt = 0.01;
    pel_sim *sim = scene_create(&scene);
    run_steps(sim, 1);
    /* the next step may begin with the loads of this one */
    double sum = pel_minimise_contacts_sum(sim);
    assert_true(sum > 0);
    assert_near(pel_minimise_contacts_sum_kept(sim) / sum, 1, 1e-12);
    pel_minimise_contacts_take_kept(sim);
    assert_near(pel_minimise_contacts_sum(sim) / sum, 1, 1e-12);
    run_steps(sim, 9);
    pel_sim_get_positions(sim, 0, before);
    for (int n = 0; n < 5; n++) {
        run_steps(sim, 1);
        pel_sim_get_solver(sim, &reading);
        assert_true(reading.converged);
        assert_int_equal(reading.iterations, 0);
    }
    pel_sim_get_positions(sim, 0, after);
    for (int i = 0; i < 3 * 49; i++)
        assert_near(after[i], before[i], 1e-9);
    scene_end(&scene, sim);
}

/* A stiff sheet that falls flat stays where it falls, wherever in a step it meets the ground. */
static void test_flat_fall(void **unused)
{
    (void)unused;
    for (int i = 0; i < 4; i++) {
        contact_scene scene;
        scene_begin(&scene, PEL_METHOD_IMPLICIT);
        pel_mesh *sheet = make_sheet(8, 0);
        for (int32_t v = 0; v < sheet->vertex_count; v++)
            sheet->positions[v][2] += 0.02 + 0.005 * i;
        scene_body(&scene, sheet);
        scene.bodies[0].spring_stiffness.value = 0;
        scene.bodies[0].spring_damping.value = scene.bodies[0].volumetric_damping.value = 0;
        scene.bodies[0].shell.membrane.on = true;
        scene.bodies[0].shell.membrane.young.value = 2e9;
        scene.bodies[0].shell.membrane.thickness.value = 5e-4;
        scene_tool(&scene, PEL_TOOL_BOX);
        for (int k = 0; k < 3; k++)
            scene.tools[0].half_extents[k] = 4;
        scene_move(&scene, 0, 0, 0, -4, -4, 1);
        scene.gravity = -10;
        scene.def.contact.thickness = 5e-4;
        scene.def.solver.dt = 0.01;
        pel_sim *sim = scene_create(&scene);
        pel_sim_measures measures;
        pel_tool_reading reading = {0};
        double before = 0;
        for (int step = 0; step < 30 && reading.contact_count == 0; step++) {
            pel_sim_measure(sim, &measures);
            before = measures.kinetic_energy;
            run_steps(sim, 1);
            pel_sim_get_tool(sim, 0, &reading);
        }
        assert_true(before > 0 && reading.contact_count > 0);
        run_steps(sim, 1);
        for (int step = 0; step < 10; step++) {
            run_steps(sim, 1);
            pel_sim_measure(sim, &measures);
            assert_true(measures.kinetic_energy < 1e-3 * before);
        }
        scene_end(&scene, sim);
    }
}

/* A sheet of steel at 2 m/s lands from a height: in every step the friction is Coulomb's, and all that slows it. */
static void land(double height)
{
    const double mu = 0.5, dt = 0.01, mass = 7.2e-3;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_IMPLICIT);
    scene_body(&scene, make_sheet(6, 0));
    for (int32_t v = 0; v < scene.meshes[0]->vertex_count; v++) {
        pel_vec3_scale(scene.meshes[0]->positions[v], 0.3, scene.meshes[0]->positions[v]);
        scene.meshes[0]->positions[v][2] += height;
    }
    pel_body_def *body = &scene.bodies[0];
    body->mass_kind = PEL_MASS_PER_VERTEX;
    body->mass = mass;
    body->spring_stiffness.value = body->spring_damping.value = body->volumetric_damping.value = 0;
    body->velocity[0] = -2;
    body->shell.membrane.on = true;
    body->shell.membrane.young.value = 2.1e11;
    body->shell.membrane.poisson = 0.3;
    body->shell.membrane.thickness.value = 5e-4;
    body->shell.bending.model = PEL_BENDING_MIDEDGE;
    scene_tool(&scene, PEL_TOOL_BOX);
    for (int k = 0; k < 3; k++)
        scene.tools[0].half_extents[k] = 4;
    scene_move(&scene, 0, 0, 0, -4, -4, 1);
    scene.gravity = -9.81;
    scene.def.contact.thickness = 4e-5;
    scene.def.contact.friction = mu;
    scene.def.solver.dt = dt;
    pel_sim *sim = scene_create(&scene);
    double before[3 * 49], after[3 * 49], speed = 0;
    for (int step = 0; step < 10; step++) {
        pel_tool_reading reading = {0};
        pel_sim_get_positions(sim, 0, before);
        run_steps(sim, 1);
        pel_sim_get_positions(sim, 0, after);
        pel_sim_get_tool(sim, 0, &reading);
        assert_true(solver_of(sim).converged);
        if (!(fabs(reading.force[0]) <= 1.06 * mu * fabs(reading.force[2]) + 1e-6))
            fail_msg("height %g: %g N across, %g N", height, reading.force[0], reading.force[2]);
        speed = 0;
        for (int v = 0; v < 49; v++)
            speed += (after[3 * v] - before[3 * v]) / (49 * dt);
    }
    assert_near(speed, -2 + mu * 9.81 * 0.095, 0.03);
    scene_end(&scene, sim);
}

static void test_landing(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* the forces of steel drown in the rounding of positions */
    for (int i = 1; i <= ROUNDS(16, 2); i++)
        land(1e-4 * i);
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

/* least distance of the triangles from the axis of a capsule along x */
static double axis_distance(const press_scene *scene, const pel_sim *sim)
{
    double least = HUGE_VAL, x[252][3], weights[5];
    const pel_tool_reading reading = reading_of(sim, 0);
    const double *middle = reading.position, half = scene->tool.half_length;
    const double ends[2][3] = {{middle[0] - half, middle[1], middle[2]}, {middle[0] + half, middle[1], middle[2]}};
    assert_true(scene->mesh->vertex_count <= 252);
    pel_sim_get_positions(sim, 0, *x);
    for (int32_t t = 0; t < scene->mesh->triangle_count; t++) {
        const int32_t *c = scene->mesh->triangles[t];
        least = fmin(least, pel_closest_segment_triangle(ends[0], ends[1], x[c[0]], x[c[1]], x[c[2]], weights));
    }
    return sqrt(least);
}

/* A capsule lies down on a ball along its triangles, in motion and at rest: few systems a step, and nothing goes into
   it. */
static void test_capsule(void **unused)
{
    (void)unused;
    for (int i = 0; i < 2; i++) {
        press_scene scene;
        press_begin(&scene, 5, 1e5);
        press_move(&scene, 1.1, 0.08);
        for (int k = 0; k < PRESS_KEYS; k++)
            scene.keys[k].rotation[1] = scene.keys[k].rotation[3] = sqrt(0.5);
        scene.tool.shape = PEL_TOOL_CAPSULE;
        scene.tool.radius = 0.1;
        scene.tool.half_length = 0.6;
        scene.def.solver.method = i == 0 ? PEL_METHOD_IMPLICIT : PEL_METHOD_STATIC;
        scene.def.solver.dt = 0.05;
        scene.def.solver.iterations = 0;
        pel_sim *sim = press_create(&scene);
        for (int n = 0; n < 20; n++) {
            run_steps(sim, 1);
            /* gaps in float round to more than the tolerance of forces */
            if (sizeof(pel_real) == 8) {
                assert_true(solver_of(sim).converged);
                assert_true(solver_of(sim).iterations < 20);
            }
            assert_true(axis_distance(&scene, sim) > 0.1 - (sizeof(pel_real) == 4 ? 1e-6 : 1e-9));
        }
        assert_true(reading_of(sim, 0).force[2] > 10);
        press_end(&scene, sim);
    }
}

/* a light body falls beside a heavy one that lies on a table: its forces are far below those of the contact */
static void test_light(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_IMPLICIT);
    scene_body(&scene, make_sheet(4, 0));
    pel_mesh *light = make_sheet(4, 0);
    for (int32_t v = 0; v < light->vertex_count; v++)
        light->positions[v][2] += 1;
    scene_body(&scene, light);
    for (int b = 0; b < 2; b++) {
        scene.bodies[b].mass_kind = PEL_MASS_PER_VERTEX;
        scene.bodies[b].mass = b == 0 ? 1e3 : 1e-3;
        scene.bodies[b].spring_damping.value = scene.bodies[b].volumetric_damping.value = 0;
    }
    pel_shape_def ground = pel_shape_def_default(PEL_SHAPE_GRID);
    ground.nx = ground.ny = 9;
    ground.size_x = ground.size_y = 8;
    assert_int_equal(pel_shape_create(&ground, &scene.tool_mesh, NULL), PEL_OK);
    scene_tool(&scene, PEL_TOOL_MESH)->mesh = scene.tool_mesh;
    scene_move(&scene, 0, 0.31, 0.17, -7e-4, -7e-4, 1);
    scene.gravity = -10;
    scene.def.contact.thickness = 5e-4;
    scene.def.solver.dt = 0.01;
    pel_sim *sim = scene_create(&scene);
    double before[3 * 25], after[3 * 25];
    pel_sim_get_positions(sim, 1, before);
    run_steps(sim, 20);
    pel_sim_get_positions(sim, 1, after);
    /* the first steps, in which the sheet comes to rest on the table, are of first order */
    assert_near((before[2] - after[2]) / (0.5 * 10 * 0.2 * 0.2), 1, 0.015);
    scene_end(&scene, sim);
}

/* the same bits for any number of threads, and after a snapshot */
static void check_bits(pel_method method, double drag)
{
    uint64_t hash[4];
    for (int i = 0; i < 4; i++) {
        press_scene scene;
        press_begin(&scene, 6, 1e5);
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
    skip_if_slow();
    check_bits(PEL_METHOD_IMPLICIT, 1);
    check_bits(PEL_METHOD_STATIC, 0);
}

/* ---- contact ---- */

/* two free shells that run into each other, with friction; sets their common momentum along x before and after */
static pel_sim *begin_collision(contact_scene *scene)
{
    scene_begin(scene, PEL_METHOD_IMPLICIT);
    scene_body(scene, make_moved_sphere(4, 0, 0, 0));
    scene_body(scene, make_moved_sphere(4, 2.05, 0.1, 0.05));
    for (int b = 0; b < 2; b++) {
        scene->bodies[b].spring_stiffness.value = scene->bodies[b].spring_damping.value = 0;
        scene->bodies[b].volumetric_damping.value = 0;
        scene->bodies[b].shell.membrane.on = true;
        scene->bodies[b].shell.membrane.young.value = 1e4;
        scene->bodies[b].shell.membrane.thickness.value = 0.1;
        scene->bodies[b].shell.bending.model = PEL_BENDING_HINGE;
    }
    scene->def.contact.friction = 0.3;
    scene->def.solver.dt = 0.005;
    pel_sim *sim = scene_create(scene);
    shoot(sim, 0, 1, 0, 0);
    shoot(sim, 1, -1, 0.2, 0);
    return sim;
}

static void sum_momentum(const pel_sim *sim, double sum[3])
{
    pel_vec3_set(sum, 0, 0, 0);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            sum[k] += (double)sim->model->mass[v] * (double)sim->state->velocity[v][k];
}

/* what contact couples moves together: few systems a step, momentum stays, and no energy comes from nothing */
static void test_collision(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = begin_collision(&scene);
    double before[3], after[3];
    pel_sim_measures measures;
    sum_momentum(sim, before);
    pel_sim_measure(sim, &measures);
    double energy = measures.kinetic_energy + measures.elastic_energy;
    int64_t touched = 0;
    int systems = 0, steps = ROUNDS(60, 40);
    for (int n = 0; n < steps; n++) {
        touched += run_free(sim, 1) > 0;
        assert_true(solver_of(sim).converged);
        systems += solver_of(sim).iterations;
        pel_sim_measure(sim, &measures);
        assert_true(measures.kinetic_energy + measures.elastic_energy < 1.01 * energy);
    }
    sum_momentum(sim, after);
    assert_true(touched > 5);
    assert_true(systems < 15 * steps);
    double size = scene.bodies[0].mass * scene.meshes[0]->vertex_count;
    for (int k = 0; k < 3; k++)
        assert_near(after[k], before[k], (sizeof(pel_real) == 8 ? 1e-9 : 1e-4) * size);
    scene_end(&scene, sim);
}

/* patterns with the blocks of contacts: a run that goes on from a snapshot has the same bits */
static void test_collision_bits(void **unused)
{
    (void)unused;
    uint64_t hash[2];
    for (int i = 0; i < 2; i++) {
        contact_scene scene;
        pel_sim *sim = begin_collision(&scene);
        run_steps(sim, 14);
        if (i == 1)
            sim = resume_sim(sim, &scene.def);
        run_steps(sim, 4);
        hash[i] = pel_sim_hash(sim);
        scene_end(&scene, sim);
    }
    assert_true(hash[0] == hash[1]);
}

/* ---- surfaces that refine ---- */

/* a thick shell that a round tool presses; refined at the top, everywhere, or not */
static pel_sim *begin_refined(press_scene *scene, pel_method method, bool everywhere)
{
    press_begin(scene, 4, 1e5);
    press_move(scene, 1.5, 0.08);
    scene->body.refine.levels = 1;
    scene->body.refine.everywhere = everywhere;
    scene->def.solver.method = method;
    scene->def.solver.dt = 0.1;
    scene->def.solver.drag = method == PEL_METHOD_IMPLICIT ? 4 : 0;
    scene->def.solver.iterations = 0;
    return press_create(scene);
}

static void refine_top(pel_sim *sim, const press_scene *scene, int32_t level)
{
    for (int32_t v = 0; v < scene->mesh->vertex_count; v++)
        if (scene->mesh->positions[v][2] > 0.5)
            assert_int_equal(pel_sim_refine(sim, 0, v, level, NULL), PEL_OK);
}

/* An event in the middle of a run leaves the energy as it is, within 1 %, and what comes then is as on a surface that
   is fine everywhere. */
static void check_refined(pel_method method)
{
    double force[2], depth[2];
    for (int fine = 0; fine < 2; fine++) {
        press_scene scene;
        pel_sim_measures measures;
        pel_sim *sim = begin_refined(&scene, method, fine == 1);
        run_steps(sim, 6);
        if (fine == 0) {
            pel_sim_measure(sim, &measures);
            double before = measures.elastic_energy;
            int32_t vertices = pel_sim_vertex_count(sim, 0);
            refine_top(sim, &scene, 1);
            assert_true(pel_sim_vertex_count(sim, 0) > vertices);
            pel_sim_measure(sim, &measures);
            assert_near(measures.elastic_energy, before, 0.01 * before);
        }
        for (int n = 0; n < 4; n++) {
            run_steps(sim, 1);
            assert_true(solver_of(sim).converged);
        }
        pel_sim_measure(sim, &measures);
        force[fine] = reading_of(sim, 0).force[2];
        depth[fine] = measures.max_displacement;
        /* back to the coarse surface */
        if (fine == 0)
            refine_top(sim, &scene, 0);
        run_steps(sim, 1);
        assert_true(solver_of(sim).converged);
        press_end(&scene, sim);
    }
    assert_near(force[0], force[1], 0.05 * force[1]);
    assert_near(depth[0], depth[1], 0.02 * depth[1]);
}

static void test_refined(void **unused)
{
    (void)unused;
    check_refined(PEL_METHOD_IMPLICIT);
    if (is_all())
        check_refined(PEL_METHOD_STATIC);
}

/* threads and snapshots, on a surface that was refined while it ran */
static void test_refined_bits(void **unused)
{
    (void)unused;
    uint64_t hash[3];
    for (int i = 0; i < 3; i++) {
        press_scene scene;
        press_begin(&scene, 4, 1e5);
        press_move(&scene, 1.5, 0.08);
        scene.body.refine.levels = 1;
        scene.def.solver.method = PEL_METHOD_IMPLICIT;
        scene.def.solver.drag = 1;
        scene.def.solver.iterations = 0;
        scene.def.thread_count = i == 1 ? 2 : 1;
        pel_sim *sim = press_create(&scene);
        run_steps(sim, 3);
        refine_top(sim, &scene, 1);
        run_steps(sim, 2);
        if (i == 2)
            sim = resume_sim(sim, &scene.def);
        run_steps(sim, 2);
        hash[i] = pel_sim_hash(sim);
        assert_true(hash[i] == hash[0]);
        press_end(&scene, sim);
    }
}

/* supports hold vertices and edges of one surface */
static void test_refusal(void **unused)
{
    (void)unused;
    stage s = {.mesh = make_sphere(2)};
    pel_body_def body = ball_body(s.mesh);
    body.refine.levels = 1;
    s.model = make_model(&body);
    pel_sim_def def = lone_sim(s.model, PEL_METHOD_IMPLICIT, 0.01);
    const int32_t vertex = 0;
    pel_support_def support = pel_support_def_default();
    support.vertices = &vertex;
    support.vertex_count = 1;
    support.fix[0] = true;
    def.supports = &support;
    def.support_count = 1;
    pel_error error;
    char text[800];
    assert_int_equal(pel_sim_create(&def, &s.sim, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(pel_error_text(&error, text, sizeof text), "refines"));
    end_stage(&s);
}

/* ---- damping of volumetric springs ---- */

/* A ball of volumetric springs alone, pulled out and let go: m x'' = -k x - c x' for each vertex along its spring, and
   undamped across it. */
static void test_radial_damping(void **unused)
{
    (void)unused;
    const double stiffness = 4, damping = 0.6, mass = 1, stretch = 0.2, dt = 0.01, time = 2;
    stage s = {.mesh = make_sphere(2)};
    pel_body_def body = ball_body(s.mesh);
    body.mass = mass;
    body.spring_stiffness.value = body.spring_damping.value = 0;
    body.volumetric_stiffness.value = stiffness;
    body.volumetric_damping.value = damping;
    s.model = make_model(&body);
    pel_sim_def def = lone_sim(s.model, PEL_METHOD_IMPLICIT, dt);
    s.sim = make_sim(&def);
    int32_t count = s.mesh->vertex_count;
    double *x = malloc(3 * (size_t)count * sizeof *x);
    for (int32_t i = 0; i < 3 * count; i++)
        x[i] = (1 + stretch) * s.mesh->positions[i / 3][i % 3];
    assert_int_equal(pel_sim_set_positions(s.sim, 0, x, NULL), PEL_OK);
    run_steps(s.sim, (int)(time / dt + 0.5));
    pel_sim_get_positions(s.sim, 0, x);
    double decay = 0.5 * damping / mass, rate = sqrt(stiffness / mass - decay * decay);
    double way = stretch * exp(-decay * time) * (cos(rate * time) + decay / rate * sin(rate * time));
    for (int32_t v = 0; v < count; v++)
        assert_near(pel_vec3_length(x + 3 * v), 1 + way, 0.02 * stretch);
    free(x);
    end_stage(&s);
}

/* ---- time ---- */

static int ticks;

static double count_ticks(void)
{
    return 1e-3 * ticks++;
}

/* systems of a thin ball that crumples on a floor */
static int64_t crumple(double friction)
{
    contact_scene scene;
    const int steps = 12;
    pel_mesh *mesh = make_sphere(6);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        pel_vec3_scale(mesh->positions[v], 0.03, mesh->positions[v]);
    scene_begin(&scene, PEL_METHOD_IMPLICIT);
    scene_body(&scene, mesh);
    pel_body_def *body = scene.bodies;
    *body = pel_body_def_sheet(body->name, mesh, 1e6, 5e-4, 1000);
    body->shell.membrane.kind = PEL_MEMBRANE_NEO_HOOKEAN;
    body->shell.membrane.poisson = 0.45;
    body->velocity[2] = -1;
    body->velocity[0] = friction > 0 ? 0.5 : 0;
    pel_tool_def *floor = scene_tool(&scene, PEL_TOOL_BOX);
    pel_vec3_set(floor->half_extents, 0.2, 0.2, 0.01);
    scene_move(&scene, 0, 0, 0, -0.041, -0.041, 1);
    scene.gravity = -9.81;
    scene.def.contact.friction = friction;
    pel_sim *sim = scene_create(&scene);
    int64_t systems = 0, pairs = 0;
    for (int n = 0; n < steps; n++) {
        pel_solver_reading reading;
        run_steps(sim, 1);
        pel_sim_get_solver(sim, &reading);
        systems += reading.iterations;
        assert_true(reading.converged);
        assert_int_equal(pel_sim_intersections(sim, &pairs, NULL), PEL_OK);
        assert_int_equal(pairs, 0);
    }
    pel_sim_ledger ledger;
    pel_sim_get_ledger(sim, &ledger);
    assert_true(ledger.energy_error < 0.01 * ledger.supplied);
    scene_end(&scene, sim);
    return systems;
}

/* Steps go across the constraints that begin and cease to act, many at once: if the first of them ends a step, it takes
   91 systems, 308 with friction. Friction has its limits from each system: with those of each round it takes 138. */
static void test_crumple(void **unused)
{
    (void)unused;
    skip_if_slow();
    assert_true(crumple(0) < 80);
    assert_true(crumple(0.3) < 120);
}

/* a budget that is over at once leaves a system for each round, the state is that of it, and the residual tells */
static void test_budget(void **unused)
{
    (void)unused;
    press_scene scene;
    press_begin(&scene, 5, 1e5);
    press_move(&scene, 1.5, 0.08);
    scene.def.solver.method = PEL_METHOD_IMPLICIT;
    scene.def.solver.dt = 0.1;
    scene.def.solver.iterations = 0;
    scene.def.solver.budget = 1e-4;
    pel_sim *sim = press_create(&scene);
    sim->clock = count_ticks;
    double worst = 0;
    for (int n = 0; n < 8; n++) {
        run_steps(sim, 1);
        pel_solver_reading reading = solver_of(sim);
        assert_true(reading.has_budget);
        assert_true(reading.iterations <= 1);
        assert_true(reading.converged || reading.residual > 0);
        worst = fmax(worst, reading.converged ? 0 : reading.residual);
    }
    assert_true(worst > 0);
    /* with time enough it comes to what a run without a budget does */
    scene.def.solver.budget = 1e3;
    pel_sim *rich = make_sim(&scene.def);
    rich->clock = count_ticks;
    scene.def.solver.budget = 0;
    pel_sim *free_of_it = make_sim(&scene.def);
    run_steps(rich, 4);
    run_steps(free_of_it, 4);
    assert_true(pel_sim_hash(rich) == pel_sim_hash(free_of_it));
    pel_sim_destroy(rich);
    pel_sim_destroy(free_of_it);
    pel_error error;
    scene.def.solver.budget = -1;
    assert_int_equal(pel_sim_create(&scene.def, &rich, &error), PEL_BAD_ARGUMENT);
    scene.def.solver.budget = 1;
    scene.def.solver.method = PEL_METHOD_DESCENT;
    assert_int_equal(pel_sim_create(&scene.def, &rich, &error), PEL_BAD_ARGUMENT);
    press_end(&scene, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_order),          cmocka_unit_test(test_stages),
        cmocka_unit_test(test_energy),         cmocka_unit_test(test_light_drag),
        cmocka_unit_test(test_spin),           cmocka_unit_test(test_set_velocities),
        cmocka_unit_test(test_momentum),       cmocka_unit_test(test_load_in_time),
        cmocka_unit_test(test_driven_volume),  cmocka_unit_test(test_slide),
        cmocka_unit_test(test_rests),          cmocka_unit_test(test_flat_fall),
        cmocka_unit_test(test_landing),        cmocka_unit_test(test_round_tool),
        cmocka_unit_test(test_capsule),        cmocka_unit_test(test_light),
        cmocka_unit_test(test_bits),           cmocka_unit_test(test_collision),
        cmocka_unit_test(test_collision_bits), cmocka_unit_test(test_refined),
        cmocka_unit_test(test_refined_bits),   cmocka_unit_test(test_refusal),
        cmocka_unit_test(test_radial_damping), cmocka_unit_test(test_budget),
        cmocka_unit_test(test_crumple),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
