/* Restitution against Newton's law for rigid bodies. */
#include "math/vec3.h"
#include "pellicle/shape.h"
#include "sim/contact_scene.h"
#include "stage/stage.h"

static void make_shell(contact_scene *scene, pel_mesh *mesh, double young)
{
    scene_body(scene, mesh);
    pel_body_def *body = &scene->bodies[scene->body_count - 1];
    *body = pel_body_def_sheet(body->name, mesh, young, 1e-3, 1000);
    body->shell.bending.model = PEL_BENDING_HINGE;
}

static pel_mesh *make_ball(double radius, double x, double y, double z)
{
    pel_mesh *mesh = make_sphere(3);
    pel_transform transform = pel_transform_default();
    pel_vec3_set(transform.scale, radius, radius, radius);
    pel_vec3_set(transform.translation, x, y, z);
    assert_int_equal(pel_mesh_transform(mesh, &transform, NULL), PEL_OK);
    return mesh;
}

static pel_mesh *make_plate(double z)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    def.nx = def.ny = 4;
    def.size_x = def.size_y = 0.04;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    pel_transform transform = pel_transform_default();
    transform.translation[2] = z;
    assert_int_equal(pel_mesh_transform(mesh, &transform, NULL), PEL_OK);
    return mesh;
}

/* sums over a body: mass, center, momentum and angular momentum about the origin */
typedef struct motion {
    double mass, center[3], momentum[3], angular[3];
} motion;

static motion motion_of(const pel_sim *sim, int32_t body)
{
    int32_t count = pel_sim_vertex_count(sim, body);
    double *x = malloc(3 * (size_t)count * sizeof *x), *v = malloc(3 * (size_t)count * sizeof *v);
    double *mass = malloc((size_t)count * sizeof *mass), turn[3];
    motion sum = {0};
    pel_sim_get_positions(sim, body, x);
    pel_sim_get_velocities(sim, body, v);
    pel_sim_get_masses(sim, body, mass);
    for (int32_t i = 0; i < count; i++) {
        const double *at = x + 3 * (size_t)i, *speed = v + 3 * (size_t)i;
        pel_vec3_cross(at, speed, turn);
        pel_vec3_along(sum.center, mass[i], at, sum.center);
        pel_vec3_along(sum.momentum, mass[i], speed, sum.momentum);
        pel_vec3_along(sum.angular, mass[i], turn, sum.angular);
        sum.mass += mass[i];
    }
    pel_vec3_scale(sum.center, 1 / sum.mass, sum.center);
    free(x);
    free(v);
    free(mass);
    return sum;
}

/* share of the height from which a shell came that it comes back to */
static double rebound(pel_method method, double dt, double young, bool is_ball, double restitution)
{
    contact_scene scene;
    const double height = 0.1, start = is_ball ? 0.02 + height : height;
    scene_begin(&scene, method);
    make_shell(&scene, is_ball ? make_ball(0.02, 0, 0, start) : make_plate(start), young);
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 1, 1, 0.01);
    scene_move(&scene, 0, 0, 0, -0.01, -0.01, 1);
    scene.gravity = -9.81;
    scene.def.solver.dt = dt;
    scene.def.contact.restitution = restitution;
    pel_sim *sim = scene_create(&scene);
    double least = start, most = 0, energy_error = 0;
    for (int step = 0; step < (int)(0.4 / dt); step++) {
        run_steps(sim, 1);
        double z = motion_of(sim, 0).center[2];
        bool falls = z < least && most == 0;
        least = falls ? z : least;
        most = !falls && z > most ? z : most;
        pel_sim_ledger ledger;
        pel_sim_get_ledger(sim, &ledger);
        energy_error = fmax(energy_error, ledger.energy_error - ledger.tolerance);
    }
    if (energy_error > 0)
        print_error("method %d, e %g: %g J appeared\n", (int)method, restitution, energy_error);
    assert_true(energy_error <= 0);
    scene_end(&scene, sim);
    /* the way within the step of a bounce is not seen */
    return (most - least) / (start - least);
}

/* e^2 of the height: a plate that falls flat and a ball, stiff and soft, under every method with velocities */
static void test_drop(void **unused)
{
    (void)unused;
    skip_if_slow();
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* momentum and energy of contacts in float are not good enough to tell */
    static const double e[] = {0, 0.5, 0.8, 1};
    for (int i = 0; i < 4; i++) {
        assert_near(rebound(PEL_METHOD_XPBD, 2e-3, 1e6, false, e[i]), e[i] * e[i], 0.02);
        assert_near(rebound(PEL_METHOD_PBD, 2e-3, 1e6, false, e[i]), e[i] * e[i], 0.03);
        assert_near(rebound(PEL_METHOD_EXPLICIT, 4e-5, 1e5, false, e[i]), e[i] * e[i], 0.02);
    }
    assert_near(rebound(PEL_METHOD_XPBD, 2e-3, 1e7, true, 0.5), 0.25, 0.02);
    assert_near(rebound(PEL_METHOD_XPBD, 2e-3, 1e7, true, 0.8), 0.64, 0.03);
    /* excluded: the elastic rebound */
    assert_true(rebound(PEL_METHOD_XPBD, 2e-3, 1e7, true, -1) > 0.4);
}

/* two free shells: momentum and angular momentum stay, and the centers part with e times the speed of approach */
static void test_free_pair(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* momentum and energy of contacts in float are not good enough to tell */
    static const pel_method methods[] = {PEL_METHOD_XPBD, PEL_METHOD_PBD, PEL_METHOD_EXPLICIT};
    for (int m = 0; m < 3; m++)
        for (int off = 0; off < 2; off++) {
            contact_scene scene;
            bool is_explicit = methods[m] == PEL_METHOD_EXPLICIT;
            scene_begin(&scene, methods[m]);
            scene.def.solver.dt = is_explicit ? 2e-5 : 2e-3;
            make_shell(&scene, make_ball(0.02, 0, 0, 0), is_explicit ? 1e6 : 1e7);
            make_shell(&scene, make_ball(0.03, 0.06, off * 0.02, 0), is_explicit ? 1e6 : 1e7);
            scene.def.contact.restitution = 0.2;
            /* the pair has the larger one */
            scene.bodies[1].restitution = 0.6;
            pel_sim *sim = scene_create(&scene);
            int32_t count = pel_sim_vertex_count(sim, 0);
            double *v = calloc(3 * (size_t)count, sizeof *v), drift[3];
            for (int32_t i = 0; i < count; i++)
                v[3 * (size_t)i] = 1;
            assert_int_equal(pel_sim_set_velocities(sim, 0, v, NULL), PEL_OK);
            free(v);
            motion start = motion_of(sim, 0);
            run_steps(sim, is_explicit ? 2500 : 25);
            motion a = motion_of(sim, 0), b = motion_of(sim, 1);
            double share = 1e-9, size = pel_vec3_length(start.momentum);
            pel_vec3_add(a.momentum, b.momentum, drift);
            pel_vec3_subtract(drift, start.momentum, drift);
            assert_true(pel_vec3_length(drift) < share * size);
            pel_vec3_add(a.angular, b.angular, drift);
            pel_vec3_subtract(drift, start.angular, drift);
            /* where contacts act the substeps themselves keep angular momentum less well, the more so the longer they
             * are */
            assert_true(pel_vec3_length(drift) < (methods[m] == PEL_METHOD_PBD ? 2e-2 : 2e-3) * 0.05 * size);
            double parting = b.momentum[0] / b.mass - a.momentum[0] / a.mass;
            /* the normal of two polyhedra leans a little; what vibrates in the shells of the leapfrog is not lost, and
               may not be given back; pbd has one substep in a step, in which its shells are rigid */
            if (off == 0)
                assert_near(parting, 0.6, methods[m] == PEL_METHOD_XPBD ? 0.03 : 0.05);
            scene_end(&scene, sim);
        }
}

/* a bouncing body comes to rest on the floor and stays, and the floor carries it */
static void test_rest(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    make_shell(&scene, make_plate(0.05), 1e6);
    pel_tool_def *tool = scene_tool(&scene, PEL_TOOL_BOX);
    pel_vec3_set(tool->half_extents, 1, 1, 0.01);
    tool->restitution = 0.7;
    scene_move(&scene, 0, 0, 0, -0.01, -0.01, 1);
    scene.gravity = -9.81;
    scene.def.solver.dt = 5e-3;
    pel_sim *sim = scene_create(&scene);
    run_steps(sim, 400);
    double weight = 9.81 * motion_of(sim, 0).mass;
    for (int step = 0; step < 100; step++) {
        run_steps(sim, 1);
        pel_tool_reading reading;
        pel_sim_get_tool(sim, 0, &reading);
        assert_near(reading.force[2], -weight, 1e-2 * weight);
        assert_true(pel_sim_max_speed(sim) < 1e-3);
    }
    scene_end(&scene, sim);
}

/* the impulse of a bounce is in the readings: force times time is the change of momentum */
static void test_impulse_is_read(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    make_shell(&scene, make_plate(0.02), 1e6);
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 1, 1, 0.01);
    scene_move(&scene, 0, 0, 0, -0.01, -0.01, 1);
    scene.gravity = -9.81;
    scene.def.solver.dt = 2e-3;
    scene.def.contact.restitution = 0.9;
    pel_sim *sim = scene_create(&scene);
    double impulse = 0, field = 0;
    for (int step = 0; step < 50; step++) {
        run_steps(sim, 1);
        pel_tool_reading reading;
        pel_sim_get_tool(sim, 0, &reading);
        impulse -= 2e-3 * reading.force[2];
        double forces[25 * 3];
        pel_sim_get_contact_forces(sim, 0, forces);
        for (int v = 0; v < 25; v++)
            field += 2e-3 * forces[3 * v + 2];
    }
    motion end = motion_of(sim, 0);
    double expected = end.momentum[2] + end.mass * 9.81 * 0.1;
    assert_near(impulse, expected, IN_FLOAT(2e-3, 1e-2) * expected);
    assert_near(field, expected, IN_FLOAT(2e-3, 1e-2) * expected);
    scene_end(&scene, sim);
}

static void test_resumes(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    make_shell(&scene, make_ball(0.02, 0, 0, 0.03), 1e6);
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 1, 1, 0.01);
    scene_move(&scene, 0, 0, 0, -0.01, -0.01, 1);
    scene.gravity = -9.81;
    scene.def.solver.dt = 1e-3;
    scene.def.contact.restitution = 0.7;
    pel_sim *sim = scene_create(&scene), *other = make_sim(&scene.def);
    /* in the collision, which takes from 0.043 s on some steps */
    for (int step = 0; step < 60; step++) {
        run_steps(sim, 1);
        run_steps(other, 1);
        if (step >= 42 && step <= 52)
            other = resume_sim(other, &scene.def);
        assert_true(pel_sim_hash(sim) == pel_sim_hash(other));
    }
    pel_sim_destroy(other);
    scene_end(&scene, sim);
}

static void expect_refused(contact_scene *scene, const char *words)
{
    pel_sim *sim;
    pel_error error;
    assert_int_equal(pel_sim_create(&scene->def, &sim, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, words));
    assert_true(error.remedy[0] != '\0');
}

static void test_refusals(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    make_shell(&scene, make_ball(0.02, 0, 0, 0.03), 1e6);
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 1, 1, 0.01);
    scene_move(&scene, 0, 0, 0, -0.01, -0.01, 1);
    pel_sim *sim = scene_create(&scene);
    scene.def.contact.restitution = 1.1;
    expect_refused(&scene, "restitution of contact is 1.1");
    scene.def.contact.restitution = 0.5;
    scene.tools[0].restitution = 2;
    expect_refused(&scene, "restitution of contact is 2");
    scene.tools[0].restitution = (double)NAN;
    expect_refused(&scene, "restitution of a tool is not finite");
    scene.tools[0].restitution = -1;
    scene.def.solver.method = PEL_METHOD_QUASI_STATIC;
    expect_refused(&scene, "needs velocities");
    scene_end(&scene, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_drop),    cmocka_unit_test(test_free_pair), cmocka_unit_test(test_rest),
        cmocka_unit_test(test_resumes), cmocka_unit_test(test_refusals),  cmocka_unit_test(test_impulse_is_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
