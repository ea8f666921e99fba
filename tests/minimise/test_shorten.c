/* The way to a state that is no balance: it ends where energy would appear, and before surfaces meet. */
#include "../rigid/rigid_scene.h"
#include "math/vec3.h"
#include "minimise/shorten.h"
#include "minimise/step_newton.h"
#include "sim/contact_scene.h"
#include "stage/rigids.h"

/* a folded sheet after a step, of which all vertices touch something */
static pel_sim *begin(contact_scene *scene)
{
    scene_begin(scene, PEL_METHOD_IMPLICIT);
    scene_body(scene, make_sheet(8, 0.06));
    scene->def.contact.self = true;
    pel_sim *sim = scene_create(scene);
    run_free(sim, 1);
    sim->minimise->newton->collided[0] = 1;
    return sim;
}

/* a way for each vertex [m], and its velocity [m/s] */
static void set_way(const pel_sim *sim, int32_t v, const double way[3], const double velocity[3])
{
    for (int k = 0; k < 3; k++) {
        sim->minimise->newton->unknowns[3 * v + k] = (double)sim->state->position[v][k] + way[k];
        sim->state->velocity[v][k] = (pel_real)velocity[k];
    }
}

/* the share of the way that a vertex has gone, along one axis; its velocity is that of this way */
static double share_gone(const pel_sim *sim, int32_t v, int k)
{
    double way = (double)(sim->state->position_next[v][k] - sim->state->position[v][k]);
    double whole = sim->minimise->newton->unknowns[3 * v + k] - (double)sim->state->position[v][k];
    assert_near((double)sim->state->velocity_next[v][k], way / sim->step.dt, 1e-4 * fabs(whole) / sim->step.dt);
    return way / whole;
}

/* At rest each step that stretches makes energy: nothing moves. */
static void test_stretch(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = begin(&scene);
    for (int32_t v = 0; v < scene.meshes[0]->vertex_count; v++) {
        double way[3] = {0.2 * (double)sim->state->position[v][0] + 0.1, 0, 0};
        set_way(sim, v, way, (const double[3]){0, 0, 0});
    }
    assert_int_equal(pel_minimise_shorten(sim, NULL), PEL_OK);
    for (int32_t v = 0; v < scene.meshes[0]->vertex_count; v++)
        assert_near(share_gone(sim, v, 0), 0, 0);
    scene_end(&scene, sim);
}

/* What slows down goes all of its way; but if it does not touch, its state is left alone. */
static void test_leaves_alone(void **unused)
{
    (void)unused;
    for (int touches = 0; touches < 2; touches++) {
        contact_scene scene;
        pel_sim *sim = begin(&scene);
        sim->minimise->newton->collided[0] = (uint8_t)touches;
        for (int32_t v = 0; v < scene.meshes[0]->vertex_count; v++) {
            set_way(sim, v, (const double[3]){0.005, 0, 0}, (const double[3]){1, 0, 0});
            sim->state->position_next[v][0] = 7;
        }
        assert_int_equal(pel_minimise_shorten(sim, NULL), PEL_OK);
        for (int32_t v = 0; v < scene.meshes[0]->vertex_count; v++)
            if (touches)
                assert_near(share_gone(sim, v, 0), 1, 1e-4);
            else
                assert_near((double)sim->state->position_next[v][0], 7, 0);
        scene_end(&scene, sim);
    }
}

/* The upper leaf goes down by twice the gap, with energy enough: to nine tenths of the way to the impact. */
static void test_impact(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = begin(&scene);
    int32_t upper = -1;
    for (int32_t v = 0; v < scene.meshes[0]->vertex_count; v++) {
        bool is_upper = (double)sim->state->position[v][2] > 0.059;
        upper = is_upper ? v : upper;
        set_way(sim, v, (const double[3]){0, 0, is_upper ? -0.12 : 0}, (const double[3]){0, 0, is_upper ? -1e3 : 0});
    }
    assert_int_equal(pel_minimise_shorten(sim, NULL), PEL_OK);
    double share = share_gone(sim, upper, 2);
    assert_true(share > 0.2 && share < 0.45);
    scene_end(&scene, sim);
}

/* A rigid body that turns has the motion of its way, whatever the unfinished solve made of its momenta: half of its
   spin if the way is half as far, and none from rest. */
static void test_spin(void **unused)
{
    (void)unused;
    static const double origin[3] = {0};
    for (int spins = 0; spins < 2; spins++) {
        rigid_scene scene;
        rigid_scene_begin(&scene);
        scene.def.solver.method = PEL_METHOD_IMPLICIT;
        rigid_scene_add(&scene, make_box(0.1, 0.2, 0.4, origin), 700)->angular_velocity[2] = spins * 10;
        rigid_scene_make(&scene);
        rigid_scene_run(&scene, 0.01);
        const pel_rigid_reading before = rigid_scene_read(&scene, 0);
        pel_sim *sim = scene.sim;
        pel_rigid *rigid = &sim->rigids->items[0];
        pel_rigids_begin(sim);
        const double angle = 5 * sim->step.dt;
        for (int32_t v = rigid->begin; v < rigid->end; v++) {
            const double x = (double)sim->state->position[v][0], y = (double)sim->state->position[v][1];
            double *end = sim->minimise->newton->unknowns + 3 * (size_t)v;
            pel_vec3_set(end, cos(angle) * x - sin(angle) * y, sin(angle) * x + cos(angle) * y,
                         (double)sim->state->position[v][2]);
        }
        sim->minimise->newton->collided[0] = 1;
        pel_vec3_set(rigid->state.angular_momentum, 3e3, 1e3, 7e5);
        assert_int_equal(pel_minimise_shorten(sim, NULL), PEL_OK);
        const double *momentum = rigid->state.angular_momentum, most = spins * before.angular_momentum[2];
        assert_near(momentum[2], 0.5 * most, 1e-4 * most);
        assert_near(pel_vec3_length(momentum), momentum[2], 1e-6 * most);
        const int32_t v = rigid->begin;
        for (int k = 0; k < 2; k++) {
            double way = (double)(sim->state->position_next[v][k] - sim->state->position[v][k]);
            assert_near((double)sim->state->velocity_next[v][k] * sim->step.dt, way, 0.03 * angle * 0.1);
        }
        rigid_scene_end(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stretch),
        cmocka_unit_test(test_leaves_alone),
        cmocka_unit_test(test_impact),
        cmocka_unit_test(test_spin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
