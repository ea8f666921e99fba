/* Contact: after every step of every scene the exact test finds no two triangles that cut each other; tools are stopped
   by trapped bodies; the same bits for any number of threads and after a snapshot; bad input is refused. */
#include "failing_malloc.h"
#include "pellicle/live.h"
#include "pellicle/shape.h"
#include "sim/contact_scene.h"
#include "tool/pose.h"

/* ---- scenes ---- */

static void test_folded_sheet(void **unused)
{
    (void)unused;
    skip_if_long();
    contact_scene scene;
    pel_sim *sim = folded_sheet(&scene, 14);
    assert_true(run_free(sim, 700) > 50);
    /* the upper leg lies on the lower one, about the thickness above it */
    double positions[3 * 15 * 15], lowest = 1;
    pel_sim_get_positions(sim, 0, positions);
    for (int v = 0; v < 15 * 15; v++)
        if (v % 15 > 10)
            lowest = fmin(lowest, positions[3 * v + 2]);
    assert_true(lowest > 0.25 * pel_sim_contact_thickness(sim));
    assert_true(lowest < 3 * pel_sim_contact_thickness(sim));
    scene_end(&scene, sim);
}

static void test_ring(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = tight_ring(&scene, 1);
    assert_true(run_free(sim, 320) > 300);
    pel_sim_measures measures;
    pel_sim_measure(sim, &measures);
    assert_true(measures.volume_ratio < 0.05);
    scene_end(&scene, sim);
}

/* momentum of all bodies along x */
static double momentum_of(const pel_sim *sim, int body_count)
{
    double momentum = 0, velocities[3 * 1000], masses[1000];
    for (int b = 0; b < body_count; b++) {
        int32_t count = pel_sim_vertex_count(sim, b);
        assert_true(count <= 1000);
        pel_sim_get_velocities(sim, b, velocities);
        pel_sim_get_masses(sim, b, masses);
        for (int32_t v = 0; v < count; v++)
            momentum += masses[v] * velocities[3 * v];
    }
    return momentum;
}

/* without drag, touching bodies share their motion: momentum is conserved */
static void test_two_bodies(void **unused)
{
    (void)unused;
    for (int self = 0; self < 2; self++) {
        contact_scene scene;
        scene_begin(&scene, PEL_METHOD_EXPLICIT);
        scene_body(&scene, make_sphere(5));
        scene_body(&scene, make_moved_sphere(4, 2.05, 0.1, 0.05));
        for (int b = 0; b < 2; b++)
            scene.bodies[b].spring_damping.value = scene.bodies[b].volumetric_damping.value = 0;
        scene.def.contact.self = self == 1;
        pel_sim *sim = scene_create(&scene);
        shoot(sim, 0, 4, 0, 0);
        shoot(sim, 1, -4, 0, 0);
        double before = momentum_of(sim, 2);
        int64_t most = run_free(sim, 150);
        assert_near(momentum_of(sim, 2), before, sizeof(pel_real) == 8 ? 1e-12 : 1e-4);
        assert_true(most > 10);
        scene_end(&scene, sim);
    }
}

/* two free shells run into each other, fast enough that the guard has to act too: momentum stays under every method,
   and no energy appears */
static void test_momentum_of_shells(void **unused)
{
    (void)unused;
    static const pel_method methods[] = {PEL_METHOD_EXPLICIT, PEL_METHOD_PBD, PEL_METHOD_XPBD, PEL_METHOD_XPBD};
    for (int i = 0; i < 8; i += ROUNDS(1, 3)) {
        contact_scene scene;
        scene_begin(&scene, methods[i / 2]);
        scene_body(&scene, make_sphere(5));
        scene_body(&scene, make_moved_sphere(4, 2.05, 0.3, 0.1));
        for (int b = 0; b < 2; b++) {
            pel_body_def *body = &scene.bodies[b];
            body->spring_stiffness.value = 0;
            body->spring_damping.value = body->volumetric_damping.value = 0;
            body->shell.membrane.on = true;
            body->shell.membrane.young.value = 2e4;
            body->shell.membrane.poisson = 0.3;
            body->shell.membrane.thickness.value = 0.01;
        }
        scene.def.solver.second_order = i / 2 == 3;
        scene.def.contact.friction = i % 2 == 0 ? 0 : 0.5;
        pel_sim *sim = scene_create(&scene);
        shoot(sim, 0, 4, 0, 0);
        shoot(sim, 1, -4, 0, 0);
        double before = momentum_of(sim, 2), scale = 4 * 0.01 * scene.meshes[0]->vertex_count, most_energy = 0;
        pel_sim_measures measures;
        pel_sim_measure(sim, &measures);
        double energy = measures.kinetic_energy;
        for (int n = 0; n < LONG(60, 40); n++) {
            run_free(sim, 1);
            pel_sim_measure(sim, &measures);
            most_energy = fmax(most_energy, measures.kinetic_energy + measures.elastic_energy);
        }
        /* in float velocities of second order are differences of positions over a short substep */
        double rounding = sizeof(pel_real) == 8 ? 1e-9 : i / 2 == 3 ? 3e-2 : 1e-3;
        assert_true(fabs(momentum_of(sim, 2) - before) < rounding * scale);
        assert_true(most_energy < 1.05 * energy);
        scene_end(&scene, sim);
    }
}

/* velocities that no contact can answer: the guard alone keeps the surfaces free */
static void test_shaken(void **unused)
{
    (void)unused;
    const double speeds[] = {5, 40, 300};
    uint64_t random = 88172645463325252;
    for (int i = 0; i < 3; i++) {
        contact_scene scene;
        pel_sim *sim = two_spheres(&scene);
        for (int n = 0; n < LONG(8, 3); n++) {
            shake(sim, 0, speeds[i], &random);
            shake(sim, 1, speeds[i], &random);
            run_free(sim, 10);
        }
        assert_true(i < 2 || statistics_of(sim).fall_backs > 0);
        scene_end(&scene, sim);
    }
}

/* refined and coarsened while it is pressed */
static void test_refinement(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_QUASI_STATIC);
    scene_body(&scene, make_sphere(4));
    scene.bodies[0].refine.levels = 2;
    scene.bodies[0].refine.above = 30;
    scene.bodies[0].refine.below = 25;
    scene.bodies[0].refine.dwell = 5;
    scene.bodies[0].refine.interval = 4;
    for (int i = 0; i < 2; i++) {
        pel_tool_def *tool = scene_tool(&scene, PEL_TOOL_BOX);
        tool->half_extents[0] = tool->half_extents[1] = 2;
        tool->half_extents[2] = 0.1;
        double side = i == 0 ? 1 : -1;
        scene_move(&scene, i, 0, 0, 1.15 * side, 0.3 * side, 0.6);
        scene.keys[i][2] = (pel_pose_key){1, {0, 0, 1.15 * side}, {0, 0, 0, 1}, {0}};
        scene.tools[i].key_count = 3;
    }
    pel_sim *sim = scene_create(&scene);
    int32_t most = 0;
    /* forces of the caller make snapshots larger, that before an event of refinement too */
    double *forces = calloc(3 * (size_t)pel_sim_vertex_count(sim, 0), sizeof *forces);
    assert_int_equal(pel_sim_set_forces(sim, 0, forces, NULL), PEL_OK);
    free(forces);
    for (int n = 0; n < 26; n++) {
        run_free(sim, 5);
        int32_t count = pel_sim_triangle_count(sim, 0);
        most = count > most ? count : most;
    }
    assert_true(most > scene.meshes[0]->triangle_count);
    assert_true(pel_sim_triangle_count(sim, 0) < most);
    scene_end(&scene, sim);
}

/* ---- tangled starts ---- */

static pel_sim *tangled(contact_scene *scene)
{
    scene_begin(scene, PEL_METHOD_EXPLICIT);
    scene_body(scene, make_sphere(4));
    scene_body(scene, make_moved_sphere(4, 1.9, 0.1, 0.05));
    scene->def.contact.allow_tangled = true;
    return scene_create(scene);
}

static void test_tangled_start(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = tangled(&scene), *refused;
    int64_t first = statistics_of(sim).tangled, pairs;
    assert_true(first > 5);
    assert_int_equal(pel_sim_intersections(sim, &pairs, NULL), PEL_OK);
    assert_int_equal(pairs, first);
    scene.def.contact.allow_tangled = false;
    pel_error error;
    assert_int_equal(pel_sim_create(&scene.def, &refused, &error), PEL_BAD_ARGUMENT);
    assert_null(refused);
    assert_non_null(strstr(error.what, "pairs of triangles intersect at the start: body 'first'"));
    assert_non_null(strstr(error.remedy, "start: tangled"));
    /* pulled apart they become free, and stay so when they meet again */
    shoot(sim, 0, -3, 0, 0);
    shoot(sim, 1, 3, 0, 0);
    run_steps(sim, 150);
    assert_int_equal(statistics_of(sim).tangled, 0);
    shoot(sim, 0, 4, 0, 0);
    shoot(sim, 1, -4, 0, 0);
    run_free(sim, 300);
    scene_end(&scene, sim);
}

/* ---- the same bits ---- */

static uint64_t hash_of_run(int threads, int save_at)
{
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_EXPLICIT);
    scene_body(&scene, make_sphere(8));
    scene_body(&scene, make_moved_sphere(5, 1.9, 0.1, 0.05));
    scene.def.contact.allow_tangled = true;
    scene.def.contact.friction = 0.3;
    scene.def.thread_count = threads;
    pel_tool_def *tool = scene_tool(&scene, PEL_TOOL_BOX);
    tool->half_extents[0] = tool->half_extents[1] = tool->half_extents[2] = 0.5;
    scene_move(&scene, 0, 0, 0, 1.51, 0.5, 0.1);
    pel_sim *sim = scene_create(&scene);
    uint64_t random = 123456789;
    shake(sim, 0, 10, &random);
    shake(sim, 1, 10, &random);
    run_steps(sim, save_at);
    size_t size = pel_sim_save_size(sim);
    void *snapshot = malloc(size);
    if (save_at > 0) {
        pel_sim_save(sim, snapshot);
        pel_sim *other = make_sim(&scene.def);
        assert_int_equal(pel_sim_load(other, snapshot, size, NULL), PEL_OK);
        pel_sim_destroy(sim);
        sim = other;
    }
    free(snapshot);
    run_steps(sim, 40 - save_at);
    uint64_t hash = pel_sim_hash(sim);
    scene_end(&scene, sim);
    return hash;
}

static void test_same_bits(void **unused)
{
    (void)unused;
    skip_if_slow();
    uint64_t hash = hash_of_run(1, 0);
    assert_true(hash_of_run(2, 0) == hash);
    assert_true(hash_of_run(1, 13) == hash);
    assert_true(hash_of_run(4, 0) == hash);
    assert_true(hash_of_run(2, 30) == hash);
}

/* ---- bad input and limits ---- */

static void assert_refused(contact_scene *scene, const char *what)
{
    pel_sim *sim;
    pel_error error;
    pel_status status = pel_sim_create(&scene->def, &sim, &error);
    if (status != PEL_BAD_ARGUMENT || strstr(error.what, what) == NULL)
        print_error("%d: %s\n", (int)status, error.what);
    assert_int_equal(status, PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, what));
    assert_true(error.remedy[0] != '\0');
    assert_null(sim);
}

/* a body has the thickness of its membrane, or its own; a filled one the relative one; refused beyond the edges */
static void test_shell_thickness(void **unused)
{
    (void)unused;
    for (int own = 0; own < 2; own++) {
        contact_scene scene;
        scene_begin(&scene, PEL_METHOD_XPBD);
        scene_body(&scene, make_sphere(4));
        scene_body(&scene, make_moved_sphere(4, 2.5, 0, 0));
        scene.bodies[0].shell.membrane.on = true;
        scene.bodies[0].shell.membrane.young.value = 1e4;
        scene.bodies[0].shell.membrane.thickness.value = 0.02;
        scene.bodies[0].contact_thickness = own ? 0.03 : -1;
        scene.def.contact.shell_thickness = true;
        pel_sim *sim = scene_create(&scene);
        assert_near(pel_sim_body_contact_thickness(sim, 0), own ? 0.03 : 0.02, 0);
        assert_true(pel_sim_body_contact_thickness(sim, 1) == pel_sim_contact_thickness(sim));
        assert_true(pel_sim_body_contact_thickness(sim, 2) == 0 && pel_sim_body_contact_thickness(sim, -1) == 0);
        scene_end(&scene, sim);
    }
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene_body(&scene, make_sphere(4));
    scene.bodies[0].shell.membrane.on = true;
    scene.bodies[0].shell.membrane.young.value = 1e4;
    scene.bodies[0].shell.membrane.thickness.value = 1;
    pel_sim *sim = scene_create(&scene);
    scene.def.contact.shell_thickness = true;
    assert_refused(&scene, "of the shell is more than the shortest edge");
    scene_end(&scene, sim);
}

static void test_bad_input(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_QUASI_STATIC);
    scene_body(&scene, make_sphere(4));
    pel_sim *sim = scene_create(&scene);
    pel_contact_def good = scene.def.contact, *contact = &scene.def.contact;
    assert_near(pel_sim_contact_thickness(sim), 1e-4 * sqrt(12), 2e-5);
    contact->thickness = 1;
    assert_refused(&scene, "more than the shortest edge");
    contact->thickness = (double)NAN;
    assert_refused(&scene, "thickness");
    contact->thickness = 0;
    contact->relative_thickness = -1;
    assert_refused(&scene, "relative thickness is -1");
    *contact = good;
    contact->friction = -1;
    assert_refused(&scene, "friction");
    *contact = good;
    /* the relative thickness is reduced for short edges */
    contact->relative_thickness = 1;
    pel_sim *clamped = make_sim(&scene.def);
    assert_true(pel_sim_contact_thickness(clamped) < 0.3);
    pel_sim_destroy(clamped);
    *contact = good;
    /* a tool that cuts the body, one that is inside, one that needs contact */
    scene.tool_mesh = make_sphere(3);
    scene_tool(&scene, PEL_TOOL_MESH)->mesh = scene.tool_mesh;
    scene_move(&scene, 0, 0.5, 0, 0.5, 0, 1);
    assert_refused(&scene, "starts inside body 'first'");
    pel_transform transform = pel_transform_default();
    transform.scale[0] = transform.scale[1] = transform.scale[2] = 0.3;
    assert_int_equal(pel_mesh_transform(scene.tool_mesh, &transform, NULL), PEL_OK);
    scene_move(&scene, 0, 0, 0, 0, 0, 1);
    assert_refused(&scene, "starts inside body 'first'");
    contact->enabled = false;
    assert_refused(&scene, "needs contact");
    scene.tools[0].mesh = NULL;
    assert_refused(&scene, "has no mesh");
    scene_end(&scene, sim);
}

/* a single contact fits: the guard does the rest */
static void test_limit(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_EXPLICIT);
    scene_body(&scene, make_sphere(5));
    scene_body(&scene, make_moved_sphere(4, 2.05, 0.1, 0.05));
    scene.def.contact.limit = 1;
    pel_sim *sim = scene_create(&scene);
    shoot(sim, 0, 4, 0, 0);
    shoot(sim, 1, -4, 0, 0);
    run_free(sim, 150);
    assert_true(statistics_of(sim).dropped > 0);
    scene_end(&scene, sim);
}

/* steps of a sheet that crumples; the hash of the state at the end, 0 if the memory did not do */
static uint64_t crumple(int64_t memory_limit, pel_error *error)
{
    contact_scene scene;
    uint64_t random = 5;
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene_body(&scene, make_sheet(12, 0.06));
    scene.def.contact.memory_limit = memory_limit;
    pel_sim *sim = scene_create(&scene);
    shake(sim, 0, 4, &random);
    pel_status status = PEL_OK;
    for (int n = 0; n < 10 && status == PEL_OK; n++)
        status = pel_sim_step(sim, error);
    uint64_t hash = status == PEL_OK ? pel_sim_hash(sim) : 0;
    if (status != PEL_OK)
        assert_int_equal(status, PEL_BAD_ARGUMENT);
    scene_end(&scene, sim);
    return hash;
}

/* less memory costs time; where the pairs of a step do not fit, it goes in parts, until the smallest does not fit */
static void test_memory_limit(void **unused)
{
    (void)unused;
    pel_error error;
    uint64_t expected = crumple(0, &error), hash = expected;
    int divided = 0;
    assert_true(expected != 0);
    for (int64_t memory = 1 << 24; hash != 0; memory = memory * 4 / 5) {
        hash = crumple(memory, &error);
        divided += hash != 0 && hash != expected;
        assert_true(divided > 0 || hash == expected);
        assert_true(memory > 1 << 11);
    }
    assert_true(divided > 0);
    assert_non_null(strstr(error.what, "memory limit"));
    assert_non_null(strstr(error.remedy, "smaller dt"));
}

static void test_nothing_moves(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_EXPLICIT);
    scene_body(&scene, make_sphere(3));
    pel_sim *sim = scene_create(&scene);
    double before[3 * 92], after[3 * 92];
    pel_sim_get_positions(sim, 0, before);
    run_free(sim, 20);
    pel_sim_get_positions(sim, 0, after);
    for (int i = 0; i < 3 * 92; i++)
        assert_near(after[i], before[i], 1e-6);
    assert_int_equal(statistics_of(sim).fall_backs, 0);
    scene_end(&scene, sim);
}

/* paper B's cubic, and its single correction after the step */
/* bodies at rest whose surfaces were found to be far apart, then brought together from outside */
static void test_brought_together(void **unused)
{
    (void)unused;
    const pel_method methods[] = {PEL_METHOD_QUASI_STATIC, PEL_METHOD_EXPLICIT, PEL_METHOD_PBD};
    for (int m = 0; m < 3; m++) {
        contact_scene scene;
        scene_begin(&scene, methods[m]);
        scene.def.contact.thickness = 0.06;
        scene_body(&scene, make_sphere(5));
        scene_body(&scene, make_moved_sphere(5, 3, 0, 0));
        pel_sim *sim = scene_create(&scene);
        run_free(sim, 20);
        assert_int_equal(statistics_of(sim).contacts, 0);
        double x[3 * 252];
        pel_sim_get_positions(sim, 1, x);
        for (int v = 0; v < 252; v++)
            x[3 * v] -= 0.98;
        assert_int_equal(pel_sim_set_positions(sim, 1, x, NULL), PEL_OK);
        run_free(sim, 1);
        assert_true(statistics_of(sim).contacts > 0);
        scene_end(&scene, sim);
    }
}

static void test_paper_method(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_EXPLICIT);
    scene_body(&scene, make_sphere(5));
    scene_body(&scene, make_moved_sphere(4, 2.05, 0.1, 0.05));
    scene.def.contact.method = PEL_CCD_BRIDSON;
    scene.def.contact.response = PEL_CONTACT_AFTER;
    pel_sim *sim = scene_create(&scene);
    shoot(sim, 0, 4, 0, 0);
    run_free(sim, 150);
    assert_true(statistics_of(sim).contacts > 0);
    scene_end(&scene, sim);
}

/* a sheet is shot through another in their common plane: the cubic is zero all the way and finds nothing, the guard
 * does */
static void test_paper_method_is_guarded(void **unused)
{
    (void)unused;
    for (int method = 0; method < 2; method++) {
        contact_scene scene;
        scene_begin(&scene, PEL_METHOD_EXPLICIT);
        for (int i = 0; i < 2; i++) {
            pel_transform transform = pel_transform_default();
            transform.translation[0] = 1.1 * i;
            scene_body(&scene, make_sheet(3, 0));
            assert_int_equal(pel_mesh_transform(scene.meshes[i], &transform, NULL), PEL_OK);
        }
        scene.def.contact.method = method == 0 ? PEL_CCD_CONSERVATIVE : PEL_CCD_BRIDSON;
        pel_sim *sim = scene_create(&scene);
        shoot(sim, 0, 1500, 0, 0);
        run_free(sim, 1);
        double first[3 * 16], second[3 * 16];
        pel_sim_get_positions(sim, 0, first);
        pel_sim_get_positions(sim, 1, second);
        double between = 0;
        for (int v = 0; v < 16; v++)
            between += (second[3 * v] - first[3 * v]) / 16;
        assert_true(between > 0.5);
        scene_end(&scene, sim);
    }
}

/* ---- memory ---- */

static pel_status create_and_step(const void *data, pel_error *error)
{
    const contact_scene *scene = data;
    pel_sim *sim;
    pel_status status = pel_sim_create(&scene->def, &sim, error);
    assert_true((sim == NULL) == (status != PEL_OK));
    for (int n = 0; n < 3 && status == PEL_OK; n++) {
        uint64_t before = pel_sim_hash(sim);
        status = pel_sim_step(sim, error);
        assert_true(status == PEL_OK || pel_sim_hash(sim) == before);
    }
    pel_sim_destroy(sim);
    return status;
}

static void test_every_allocation(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_QUASI_STATIC);
    scene_body(&scene, make_sphere(3));
    scene_body(&scene, make_moved_sphere(3, 1.9, 0.1, 0.05));
    scene.def.contact.allow_tangled = true;
    scene.tool_mesh = make_sphere(2);
    scene_tool(&scene, PEL_TOOL_MESH)->mesh = scene.tool_mesh;
    scene_move(&scene, 0, 0, 0, 2.02, 1.5, 0.02);
    pel_sim *sim = scene_create(&scene);
    assert_true(for_every_allocation_failure(create_and_step, &scene) > 40);
    scene_end(&scene, sim);
}

/* after the largest number of pairs */
static void test_steps_do_not_allocate(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = pressed_flat(&scene, PEL_METHOD_QUASI_STATIC, 4, 0.4, 100);
    run_steps(sim, sizeof(pel_real) == 8 ? 400 : 1200);
    failing_malloc_begin(0);
    run_steps(sim, 100);
    allocation_count count = failing_malloc_end();
    assert_int_equal(count.calls, 0);
    assert_true(statistics_of(sim).contacts > 1000);
    scene_end(&scene, sim);
}

/* a ball that outside pressure draws together within a step: parts of it are repeated with pairs that changed places */
static void test_implodes(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene.def.solver.dt = 0.01;
    scene_body(&scene, make_sphere(2));
    scene.bodies[0] = pel_body_def_sheet(scene.bodies[0].name, scene.bodies[0].mesh, 2e7, 0.02, 1000);
    scene.bodies[0].shell.pressure.kind = PEL_PRESSURE_GIVEN;
    scene.bodies[0].shell.pressure.outside.value = 3e6;
    pel_sim *sim = scene_create(&scene);
    run_free(sim, 2);
    pel_sim_measures measures;
    pel_sim_measure(sim, &measures);
    assert_true(measures.volume_ratio >= 0 && measures.volume_ratio < 0.3);
    scene_end(&scene, sim);
}

/* the edge of a descending box receives the force from below, independent of the order of the edges of a contact */
static void test_edge_reaction(void **unused)
{
    (void)unused;
    static const double turned[4] = {0, 0.38268343236508977, 0, 0.92387953251128674};
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene_body(&scene, make_sphere(4));
    scene.bodies[0].volumetric_stiffness.value = 10;
    pel_tool_def *tool = scene_tool(&scene, PEL_TOOL_BOX);
    tool->half_extents[0] = tool->half_extents[2] = 0.3;
    tool->half_extents[1] = 2;
    scene_move(&scene, 0, 0.02, 0, 1.43, 1.3, 0.1);
    for (int k = 0; k < 2; k++)
        memcpy(scene.keys[0][k].rotation, turned, sizeof turned);
    pel_sim *sim = scene_create(&scene);
    int touching = 0;
    for (int n = 0; n < 20; n++) {
        run_steps(sim, 1);
        pel_tool_reading reading;
        pel_sim_get_tool(sim, 0, &reading);
        touching += reading.force[2] != 0;
        assert_true(reading.force[2] >= 0);
    }
    assert_true(touching > 5);
    scene_end(&scene, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_edge_reaction),
        cmocka_unit_test(test_implodes),
        cmocka_unit_test(test_folded_sheet),
        cmocka_unit_test(test_ring),
        cmocka_unit_test(test_two_bodies),
        cmocka_unit_test(test_momentum_of_shells),
        cmocka_unit_test(test_shaken),
        cmocka_unit_test(test_refinement),
        cmocka_unit_test(test_tangled_start),
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_shell_thickness),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_limit),
        cmocka_unit_test(test_memory_limit),
        cmocka_unit_test(test_nothing_moves),
        cmocka_unit_test(test_brought_together),
        cmocka_unit_test(test_paper_method),
        cmocka_unit_test(test_paper_method_is_guarded),
        cmocka_unit_test(test_every_allocation),
        cmocka_unit_test(test_steps_do_not_allocate),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
