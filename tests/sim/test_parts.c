/* Contact under violence: steps in parts, energy that must not appear, triangles that must not collapse. */
#include "sim/contact_scene.h"
#include "sim/parts.h"
#include "sim/sim.h"
#include "tool/tool.h"

static void make_shell(pel_body_def *body, double young)
{
    body->spring_stiffness.value = body->spring_damping.value = body->volumetric_damping.value = 0;
    body->shell.membrane.on = true;
    body->shell.membrane.young.value = young;
    body->shell.membrane.poisson = 0.3;
    body->shell.membrane.thickness.value = 0.01;
}

/* a heavy ball meets a sheet; it flies 10 edges in a step */
static pel_sim *bullet(contact_scene *scene, pel_method method)
{
    scene_begin(scene, method);
    scene_body(scene, make_sheet(10, 0));
    scene_body(scene, make_moved_sphere(2, 0, 0, 1.3));
    make_shell(&scene->bodies[0], 1e5);
    make_shell(&scene->bodies[1], 1e6);
    scene->bodies[1].mass = 0.1;
    /* implicit steps through the whole thickness of the sheet need no parts */
    scene->def.contact.relative_thickness = 1e-4;
    pel_sim *sim = scene_create(scene);
    shoot(sim, 1, 0, 0, -100);
    return sim;
}

static double energy_of(pel_sim *sim)
{
    pel_sim_measures measures;
    pel_sim_measure(sim, &measures);
    return measures.kinetic_energy + measures.elastic_energy;
}

static void check_bullet(pel_method method)
{
    contact_scene scene;
    pel_sim *sim = bullet(&scene, method);
    double before = energy_of(sim), most = 0;
    bool was_divided = false;
    for (int n = 0; n < 12; n++) {
        run_free(sim, 1);
        most = fmax(most, energy_of(sim));
        was_divided |= pel_house_of(sim)->parts.now.size < PEL_PART_LIMIT;
        /* between steps everything is whole */
        assert_near(pel_sim_time(sim), (n + 1) * 0.01, 1e-12);
        assert_near(sim->step.dt, 0.01, 0);
    }
    print_message("most energy %g of %g\n", most, before);
    assert_true(was_divided && statistics_of(sim).steps_divided > 0);
    assert_true(most < 1.02 * before);
    scene_end(&scene, sim);
}

static void test_bullet(void **unused)
{
    (void)unused;
    check_bullet(PEL_METHOD_XPBD);
}

static void test_bullet_implicit(void **unused)
{
    (void)unused;
    skip_if_slow();
    check_bullet(PEL_METHOD_IMPLICIT);
}

/* a step that is halved several times at once doubles the patience once; parts that grew too early do it again */
static void test_halved_at_once(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = bullet(&scene, PEL_METHOD_XPBD);
    const pel_parts_now *now = &pel_house_of(sim)->parts.now;
    assert_int_equal(pel_parts_begin(sim, NULL), PEL_OK);
    for (int n = 0; n < 4; n++)
        assert_int_equal(pel_parts_halve(sim, NULL), PEL_OK);
    assert_int_equal(now->size, PEL_PART_LIMIT / 16);
    assert_int_equal(now->patience, 2 * PEL_LEAST_PATIENCE);
    while (now->size == PEL_PART_LIMIT / 16)
        pel_parts_accept(sim);
    assert_int_equal(pel_parts_halve(sim, NULL), PEL_OK);
    assert_int_equal(now->patience, 4 * PEL_LEAST_PATIENCE);
    pel_parts_end(sim, PEL_DIVERGED);
    scene_end(&scene, sim);
}

/* a snapshot knows how long parts are */
static void check_snapshot(pel_method method)
{
    contact_scene scene;
    pel_sim *sim = bullet(&scene, method), *other;
    run_free(sim, 3);
    assert_true(pel_house_of(sim)->parts.now.size < PEL_PART_LIMIT);
    size_t size = pel_sim_save_size(sim);
    void *bytes = malloc(size);
    pel_sim_save(sim, bytes);
    assert_int_equal(pel_sim_create(&scene.def, &other, NULL), PEL_OK);
    assert_int_equal(pel_sim_load(other, bytes, size, NULL), PEL_OK);
    run_free(sim, 3);
    run_free(other, 3);
    assert_true(pel_sim_hash(sim) == pel_sim_hash(other));
    /* sizes that cannot be are refused */
    pel_house_of(sim)->parts.now.size = 3;
    free(bytes);
    size = pel_sim_save_size(sim);
    bytes = malloc(size);
    pel_sim_save(sim, bytes);
    assert_int_equal(pel_sim_load(other, bytes, size, NULL), PEL_BAD_FORMAT);
    free(bytes);
    pel_sim_destroy(other);
    scene_end(&scene, sim);
}

static void test_snapshot(void **unused)
{
    (void)unused;
    check_snapshot(PEL_METHOD_XPBD);
}

static void test_snapshot_implicit(void **unused)
{
    (void)unused;
    check_snapshot(PEL_METHOD_IMPLICIT);
}

typedef struct patience {
    int64_t asked, last;
} patience;

static bool is_wanted(void *user)
{
    patience *p = user;
    return p->asked++ < p->last;
}

/* The caller is asked in steps that are divided, though they are short as a rule: they stop at any question, leave the
   state before them to the bit, and go on to the same bits. */
static void test_stops(void **unused)
{
    (void)unused;
    contact_scene scene, other;
    patience p = {0, INT64_MAX};
    pel_sim *sim = bullet(&scene, PEL_METHOD_XPBD), *wanted = bullet(&other, PEL_METHOD_XPBD);
    pel_sim_destroy(sim);
    scene.def.wanted = is_wanted;
    scene.def.user = &p;
    sim = make_sim(&scene.def);
    shoot(sim, 1, 0, 0, -100);
    int stops = 0;
    for (int n = 0; n < 5; n++) {
        pel_status status = PEL_STOPPED;
        uint64_t before = pel_sim_hash(sim);
        for (int64_t last = 0; status == PEL_STOPPED; last = 2 * last + 1) {
            p = (patience){0, last};
            status = pel_sim_step(sim, NULL);
            stops += status == PEL_STOPPED;
            if (status == PEL_STOPPED)
                assert_true(pel_sim_hash(sim) == before);
        }
        assert_int_equal(status, PEL_OK);
        run_steps(wanted, 1);
        assert_true(pel_sim_hash(sim) == pel_sim_hash(wanted));
    }
    assert_true(stops > 3);
    scene_end(&other, wanted);
    scene_end(&scene, sim);
}

/* a part that fails takes the state back to the start of the step */
static void test_failure(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = bullet(&scene, PEL_METHOD_XPBD);
    run_free(sim, 3);
    uint64_t before = pel_sim_hash(sim);
    assert_int_equal(pel_parts_begin(sim, NULL), PEL_OK);
    assert_true(sim->step.dt < 0.01);
    sim->state->position[0][2] += 1;
    sim->part.at += sim->part.step_size;
    pel_parts_end(sim, PEL_DIVERGED);
    assert_true(pel_sim_hash(sim) == before);
    assert_near(sim->step.dt, 0.01, 0);
    scene_end(&scene, sim);
}

/* height over the longest edge, against that at rest, of the flattest triangle of a sheet of 2 triangles */
static double least_height(const pel_sim *sim)
{
    static const int corners[2][3] = {{0, 1, 3}, {0, 3, 2}};
    double x[12], least = HUGE_VAL;
    pel_sim_get_positions(sim, 0, x);
    for (int t = 0; t < 2; t++) {
        double a[3], b[3], c[3], normal[3];
        pel_vec3_subtract(&x[3 * corners[t][1]], &x[3 * corners[t][0]], a);
        pel_vec3_subtract(&x[3 * corners[t][2]], &x[3 * corners[t][0]], b);
        pel_vec3_subtract(a, b, c);
        pel_vec3_cross(a, b, normal);
        double longest = fmax(pel_vec3_length(a), fmax(pel_vec3_length(b), pel_vec3_length(c)));
        least = fmin(least, pel_vec3_length(normal) / longest);
    }
    return least;
}

/* a sheet of two triangles is folded in its own plane, by two corners that fly at each other along a diagonal: with
   contact its triangles keep a height, although the law hardly resists */
static void test_collapse(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene_body(&scene, make_sheet(1, 0));
    make_shell(&scene.bodies[0], 1);
    pel_sim *sim = scene_create(&scene);
    double velocities[12] = {0}, x[12], rest = least_height(sim), least = HUGE_VAL;
    pel_sim_get_positions(sim, 0, x);
    /* the corners that are not on the common edge */
    for (int v = 1; v <= 2; v++)
        for (int k = 0; k < 3; k++)
            velocities[3 * v + k] = -2 * (x[3 * v + k] - 0.5 * (x[k] + x[9 + k]));
    assert_int_equal(pel_sim_set_velocities(sim, 0, velocities, NULL), PEL_OK);
    for (int n = 0; n < 100; n++) {
        run_free(sim, 1);
        least = fmin(least, least_height(sim));
    }
    assert_true(least < 0.1 * rest);
    assert_true(least > 0.045 * rest);
    scene_end(&scene, sim);
}

/* volume ratio of a shell with a region that caves in, after steps in parts of a size */
static double caved_volume(pel_method method, int32_t size)
{
    contact_scene scene;
    scene_begin(&scene, method);
    scene.def.solver.substeps = method == PEL_METHOD_XPBD ? 4 : 1;
    scene_body(&scene, make_moved_sphere(4, 0, 0, 0));
    make_shell(&scene.bodies[0], 1e4);
    pel_anisotropy_def region = pel_anisotropy_def_default();
    region.mode = PEL_FIBRE_CAVE;
    region.strength = 0.02;
    scene.bodies[0].shell.anisotropies = &region;
    scene.bodies[0].shell.anisotropy_count = 1;
    scene.bodies[0].shell.pressure.kind = PEL_PRESSURE_GIVEN;
    scene.bodies[0].shell.pressure.outside.value = 30;
    pel_sim *sim = scene_create(&scene);
    for (int n = 0; n < 12; n++) {
        pel_house_of(sim)->parts.now = (pel_parts_now){.size = size, .patience = INT32_MAX};
        run_free(sim, 1);
    }
    double ratio = pel_sim_volume_ratio(sim);
    scene_end(&scene, sim);
    return ratio;
}

/* a region goes in as fast in parts of steps as in whole ones */
static void test_caving(void **unused)
{
    (void)unused;
    const pel_method methods[] = {PEL_METHOD_PBD, PEL_METHOD_XPBD};
    for (int m = 0; m < 2; m++) {
        double whole = 1 - caved_volume(methods[m], PEL_PART_LIMIT);
        double parts = 1 - caved_volume(methods[m], PEL_PART_LIMIT / 8);
        assert_true(whole > 0.02);
        assert_near(parts, whole, 0.3 * whole);
    }
}

/* ---- a sheet under steps of given parts ---- */

typedef struct sheet_scene {
    contact_scene scene;
    int32_t held[2];
    pel_support_def support;
} sheet_scene;

/* held at two corners by a support or pins; a small sphere may hold a third corner */
static pel_sim *hold_sheet(sheet_scene *s, pel_method method, bool has_support, bool has_grip, int32_t size)
{
    contact_scene *scene = &s->scene;
    scene_begin(scene, method);
    scene->def.contact.enabled = false;
    scene_body(scene, make_sheet(6, 0));
    make_shell(&scene->bodies[0], 1e5);
    s->held[0] = 42;
    s->held[1] = 48;
    if (has_support) {
        s->support = pel_support_def_default();
        s->support.name = "rim";
        s->support.vertices = s->held;
        s->support.vertex_count = 2;
        scene->def.supports = &s->support;
        scene->def.support_count = 1;
    } else {
        scene->bodies[0].pinned = s->held;
        scene->bodies[0].pinned_count = 2;
    }
    scene->gravity = has_grip ? 0 : -10;
    if (has_grip) {
        pel_tool_def *tool = scene_tool(scene, PEL_TOOL_SPHERE);
        tool->radius = 0.05;
        tool->press = false;
        tool->grasp = true;
        tool->reach = 0.02;
        const double *corner = scene->meshes[0]->positions[0];
        pel_vec3_copy(corner, tool->center);
        scene_move(scene, 0, corner[0], corner[1], corner[2], corner[2], 1);
    }
    pel_sim *sim = scene_create(scene);
    pel_house_of(sim)->parts.now = (pel_parts_now){.size = size, .patience = PEL_MOST_PATIENCE};
    return sim;
}

/* forces on supports in a step in parts are means, also in the field of reactions */
static void test_supports(void **unused)
{
    (void)unused;
    double whole = 0;
    for (int32_t size = PEL_PART_LIMIT; size >= 8; size /= 2) {
        sheet_scene s;
        double sum = 0;
        pel_support_reading reading;
        pel_sim *sim = hold_sheet(&s, PEL_METHOD_IMPLICIT, true, false, size);
        run_steps(sim, 3);
        pel_sim_get_support(sim, 0, &reading);
        for (int32_t v = 0; v < sim->model->vertex_count; v++)
            sum += sim->reactions[v][2];
        assert_near(sum, -reading.force[2], 1e-9 * fabs(sum) + (sizeof(pel_real) == 8 ? 0 : 1e-4));
        whole = size == PEL_PART_LIMIT ? sum : whole;
        assert_near(sum, whole, 0.2 * fabs(whole));
        scene_end(&s.scene, sim);
    }
}

/* a tool that the caller moves goes its way in a step at one speed */
static void test_driven_tool(void **unused)
{
    (void)unused;
    for (int32_t size = PEL_PART_LIMIT; size >= 4; size /= 4) {
        sheet_scene s;
        pel_sim *sim = hold_sheet(&s, PEL_METHOD_IMPLICIT, false, true, size);
        const double rotation[4] = {0, 0, 0, 1};
        double place[3];
        pel_vec3_copy(s.scene.tools[0].center, place);
        run_steps(sim, 1);
        for (int n = 0; n < 3; n++) {
            place[0] -= 0.002;
            assert_int_equal(pel_sim_set_tool_pose(sim, 0, place, rotation, NULL), PEL_OK);
            run_steps(sim, 1);
        }
        assert_int_equal(sim->tools->items[0].held_count, 1);
        assert_near((double)sim->state->velocity[sim->tools->items[0].held[0]][0], -0.2, 2e-3);
        scene_end(&s.scene, sim);
    }
}

/* a step that fails in its first part, however short that is, leaves everything as it was */
static void test_failed_first_part(void **unused)
{
    (void)unused;
    sheet_scene s;
    pel_sim *sim = hold_sheet(&s, PEL_METHOD_IMPLICIT, false, false, PEL_PART_LIMIT);
    run_steps(sim, 5);
    size_t size = pel_sim_save_size(sim);
    void *before = malloc(size), *after = malloc(size);
    pel_sim_save(sim, before);
    assert_int_equal(pel_parts_keep(sim, NULL), PEL_OK);
    assert_int_equal(pel_parts_begin(sim, NULL), PEL_OK);
    for (int i = 0; i < 6; i++)
        assert_int_equal(pel_parts_halve(sim, NULL), PEL_OK);
    pel_parts_end(sim, PEL_DIVERGED);
    pel_sim_save(sim, after);
    assert_memory_equal(before, after, size);
    free(before);
    free(after);
    scene_end(&s.scene, sim);
}

/* a state before a grasp holds nothing, also where it is loaded while the grasp holds */
static void test_load_before_grasp(void **unused)
{
    (void)unused;
    sheet_scene s;
    pel_sim *sim = hold_sheet(&s, PEL_METHOD_XPBD, false, true, PEL_PART_LIMIT);
    sim->tools->items[0].grasp_from = 0.025;
    size_t size = pel_sim_save_size(sim);
    void *before = malloc(size);
    pel_sim_save(sim, before);
    run_steps(sim, 1);
    uint64_t right = pel_sim_hash(sim);
    run_steps(sim, 4);
    assert_int_equal(sim->tools->items[0].held_count, 1);
    assert_int_equal(pel_sim_load(sim, before, size, NULL), PEL_OK);
    run_steps(sim, 1);
    assert_true(pel_sim_hash(sim) == right);
    free(before);
    scene_end(&s.scene, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bullet),
        cmocka_unit_test(test_halved_at_once),
        cmocka_unit_test(test_bullet_implicit),
        cmocka_unit_test(test_snapshot),
        cmocka_unit_test(test_snapshot_implicit),
        cmocka_unit_test(test_stops),
        cmocka_unit_test(test_failure),
        cmocka_unit_test(test_collapse),
        cmocka_unit_test(test_caving),
        cmocka_unit_test(test_supports),
        cmocka_unit_test(test_driven_tool),
        cmocka_unit_test(test_failed_first_part),
        cmocka_unit_test(test_load_before_grasp),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
