/* Steps of `implicit` with a factor that many of them share: forces, cost, bits. */
#include "constraint/constraint.h"
#include "minimise/prepared.h"
#include "sim/descent_fixture.h"
#include "sim/solid_fixture.h"
#include "stage/stage.h"

/* a ball on pins that a grasp draws up and aside, so that it wrinkles; the steps go one way */
typedef struct pull {
    press_scene scene;
    pel_sim *sim;
} pull;

static void pull_begin(pull *p, double thickness, pel_bending_model bending)
{
    press_begin(&p->scene, 8, 1e5);
    press_move(&p->scene, 1, 0);
    p->scene.keys[1].position[0] = 0.5;
    p->scene.keys[1].position[2] = 1.5;
    p->scene.body.thickness.value = p->scene.body.shell.membrane.thickness.value = thickness;
    p->scene.body.shell.bending.model = bending;
    p->scene.tool.grasp = true;
    p->scene.tool.press = false;
    p->scene.tool.radius = 0.3;
    p->scene.def.solver.method = PEL_METHOD_IMPLICIT;
    p->scene.def.solver.dt = 0.02;
    p->scene.def.solver.iterations = 0;
    p->sim = press_create(&p->scene);
}

static void pull_end(pull *p)
{
    press_end(&p->scene, p->sim);
}

static void step_by(pel_sim *sim, pel_newton_way way)
{
    sim->minimise->newton->choice.way = way;
    run_steps(sim, 1);
    assert_true(solver_of(sim).converged);
}

/* a filling whose springs resist their rate more than their length */
static void fill(pull *p)
{
    p->scene.body.volumetric_stiffness.value = 2;
    p->scene.body.volumetric_damping.value = 1;
    pel_sim_destroy(p->sim);
    pel_model_destroy(p->scene.model);
    p->sim = press_create(&p->scene);
}

/* the force is that of systems alone, at a fraction of the work */
static void check_force(bool is_filled)
{
    enum { STEPS = 20 };
    double force[2][STEPS];
    int64_t work[2];
    for (int i = 0; i < 2; i++) {
        pull p;
        pull_begin(&p, 0.02, PEL_BENDING_HINGE);
        if (is_filled)
            fill(&p);
        for (int n = 0; n < STEPS; n++) {
            step_by(p.sim, i == 0 ? PEL_PREPARED : PEL_SYSTEMS);
            force[i][n] = reading_of(p.sim, 0).force[2];
        }
        work[i] = pel_newton_work(p.sim->newton);
        pull_end(&p);
    }
    for (int n = 0; n < STEPS; n++)
        assert_near(force[0][n] / force[1][n], 1, 0.01);
    assert_true(2 * work[0] < work[1]);
}

static void test_force(void **unused)
{
    (void)unused;
    check_force(false);
    check_force(true);
}

/* The same bits for any number of threads, and after a snapshot that lies between two factors: of hinges, and with
   unknowns on edges. */
static void check_bits(pel_bending_model bending, bool is_filled)
{
    uint64_t hash[3];
    for (int i = 0; i < 3; i++) {
        pull p;
        int32_t kept = 0;
        press_scene *scene = &p.scene;
        pull_begin(&p, 0.02, bending);
        scene->def.thread_count = i == 1 ? 4 : 1;
        if (is_filled)
            fill(&p);
        p.sim = resume_sim(p.sim, &scene->def);
        for (int n = 0; n < 12; n++) {
            step_by(p.sim, PEL_PREPARED);
            kept += !p.sim->minimise->newton->base->is_due;
            if (i == 2)
                p.sim = resume_sim(p.sim, &scene->def);
        }
        assert_true(kept > 6);
        hash[i] = pel_sim_hash(p.sim);
        assert_true(hash[i] == hash[0]);
        pull_end(&p);
    }
}

static void test_bits(void **unused)
{
    (void)unused;
    check_bits(PEL_BENDING_HINGE, false);
    check_bits(PEL_BENDING_MIDEDGE, false);
    check_bits(PEL_BENDING_HINGE, true);
}

/* another factor where the springs of inertia are others, after the first step, and where the grasp opens */
static void test_due(void **unused)
{
    (void)unused;
    pull p;
    pull_begin(&p, 0.02, PEL_BENDING_HINGE);
    p.scene.tool.grasp_until = 0.05;
    pel_sim_destroy(p.sim);
    p.sim = make_sim(&p.scene.def);
    const pel_newton_base *base = p.sim->minimise->newton->base;
    step_by(p.sim, PEL_PREPARED);
    double rate = base->rate;
    uint64_t fixed = base->fixed;
    step_by(p.sim, PEL_PREPARED);
    assert_near(base->rate, 1.5 * rate, 1e-9 * rate);
    assert_true(base->fixed == fixed);
    run_steps(p.sim, 2);
    assert_int_equal(reading_of(p.sim, 0).held_count, 0);
    step_by(p.sim, PEL_PREPARED);
    assert_true(base->fixed != fixed);
    pull_end(&p);
}

/* Contacts that are near and do not press leave the factor as it is; those that press take its place. */
static void test_near(void **unused)
{
    (void)unused;
    uint64_t hash[2];
    for (int i = 0; i < 2; i++) {
        pull p;
        pull_begin(&p, 0.02, PEL_BENDING_HINGE);
        const pel_pose_key at[2] = {{0, {-1.03, 0, 0}, {0, 0, 0, 1}, {0}}, {1, {-0.53, 0, 0}, {0, 0, 0, 1}, {0}}};
        pel_tool_def tools[2] = {p.scene.tool, pel_tool_def_default()};
        tools[1].name = "wall";
        tools[1].shape = PEL_TOOL_BOX;
        pel_vec3_set(tools[1].half_extents, 0.005, 1, 1);
        tools[1].keys = at;
        tools[1].key_count = 2;
        p.scene.def.tools = tools;
        p.scene.def.tool_count = 2;
        p.scene.def.contact.enabled = true;
        pel_sim_destroy(p.sim);
        p.sim = make_sim(&p.scene.def);
        int32_t near = 0, pressed = 0;
        for (int n = 0; n < 10; n++) {
            step_by(p.sim, PEL_PREPARED);
            const pel_minimise *minimise = p.sim->minimise;
            bool presses = pel_minimise_contacts_sum(p.sim) > 0;
            near += minimise->count > 0 && !presses && minimise->newton->way == PEL_PREPARED;
            pressed += presses && minimise->newton->way != PEL_PREPARED;
            if (i == 1)
                p.sim = resume_sim(p.sim, &p.scene.def);
        }
        assert_true(near > 0 && pressed > 0);
        hash[i] = pel_sim_hash(p.sim);
        pull_end(&p);
    }
    assert_true(hash[0] == hash[1]);
}

/* A soft block of tetrahedra that hangs from one face and swings by as much as it is long: another factor is made
   before steps by an old one cost more than it. */
static void test_worn(void **unused)
{
    (void)unused;
    enum { STEPS = 60, MOST_WORK = 530 };
    pel_mesh *mesh = make_block(0.3, 0.1, 0.1, 0.03);
    pel_body_def body = solid_body(mesh, PEL_VOLUME_NEO_HOOKEAN, 3e4, 0.4);
    int32_t pinned[100];
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (mesh->positions[v][0] < 1e-9)
            pinned[body.pinned_count++] = v;
    body.pinned = pinned;
    pel_model_def model_def = pel_model_def_default();
    model_def.bodies = &body;
    model_def.body_count = 1;
    model_def.gravity[2] = -9.81;
    pel_model *model;
    assert_int_equal(pel_model_create(&model_def, &model, NULL), PEL_OK);
    pel_sim_def def = lone_sim(model, PEL_METHOD_IMPLICIT, 0.01);
    pel_sim *sim = make_sim(&def);
    int worn = 0;
    for (int n = 0; n < STEPS; n++) {
        step_by(sim, PEL_PREPARED);
        worn += sim->minimise->newton->base->is_due;
    }
    assert_true(worn > 0 && pel_newton_work(sim->newton) < MOST_WORK);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_force), cmocka_unit_test(test_bits), cmocka_unit_test(test_due),
        cmocka_unit_test(test_near),  cmocka_unit_test(test_worn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
