/* The proof that contact lets nothing through: frames of all kinds of scenes, tested exactly. A few hundred frames in
   `make test`, of which it tests some; `make nightly` runs 10,000 and tests each, in some minutes. */
#include "pellicle/mesh_io.h"
#include "pellicle/shape.h"
#include "sim/contact_scene.h"
#include "source_dir.h"
#include "stage/stage.h"

static int64_t frame_total;

static int wanted_frames(void)
{
    return LONG(10000, 250);
}

/* runs a share of the wanted frames and frees everything */
static void prove(const char *name, contact_scene *scene, pel_sim *sim, double share)
{
    int count = (int)(share * wanted_frames());
    int64_t most = run_free(sim, count);
    pel_contact_statistics s = statistics_of(sim);
    print_message("%-24s %5d frames, at most %4lld vertices in contact, %7lld fall-backs, 0 intersections\n", name,
                  count, (long long)most, (long long)s.fall_backs);
    frame_total += count;
    scene_end(scene, sim);
}

static void test_mass_spring(void **unused)
{
    (void)unused;
    contact_scene scene;
    prove("sheet folded over itself", &scene, folded_sheet(&scene, is_all() ? 20 : 10), 0.2);
    prove("ring pulled tight", &scene, tight_ring(&scene, 1), 0.032);
    int count = (int)(0.2 * wanted_frames());
    prove("pressed flat, quasi-static", &scene, pressed_flat(&scene, PEL_METHOD_QUASI_STATIC, 5, 0.02, count), 0.2);
    prove("pressed flat, explicit", &scene, pressed_flat(&scene, PEL_METHOD_EXPLICIT, 5, 0.02, count), 0.2);
    pel_sim *sim = two_spheres(&scene);
    shoot(sim, 0, 4, 0, 0);
    shoot(sim, 1, -4, 0, 0);
    prove("two balls", &scene, sim, 0.15);
}

static void test_tool(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_QUASI_STATIC);
    scene_body(&scene, make_sphere(5));
    scene.bodies[0].volumetric_stiffness.value = 1;
    scene.tool_mesh = make_shape(PEL_SHAPE_TORUS);
    scene_tool(&scene, PEL_TOOL_MESH)->mesh = scene.tool_mesh;
    int count = (int)(0.1 * wanted_frames());
    scene_move(&scene, 0, 0.1, 0, 1.3, -1.5, 0.01 * count);
    prove("ring through a ball", &scene, scene_create(&scene), 0.1);
}

/* ---- shells ---- */

static void make_shell(pel_body_def *body, double pressure)
{
    *body = pel_body_def_sheet(body->name, body->mesh, 1e5, 0.01, 1000);
    body->shell.membrane.kind = PEL_MEMBRANE_STVK;
    body->shell.membrane.poisson = 0.3;
    body->shell.bending.model = PEL_BENDING_HINGE;
    body->shell.pressure.kind = pressure > 0 ? PEL_PRESSURE_GIVEN : PEL_PRESSURE_NONE;
    body->shell.pressure.outside.value = pressure;
}

/* outside pressure until a fifth of the volume is left */
static void contract(const char *name, pel_mesh *mesh, pel_method method)
{
    contact_scene scene;
    scene_begin(&scene, method);
    scene.def.solver.dt = 1.0 / 60;
    scene_body(&scene, mesh);
    make_shell(&scene.bodies[0], 100);
    pel_sim *sim = scene_create(&scene);
    pel_sim_measures measures = {.volume_ratio = 1};
    int frames = 0;
    for (; measures.volume_ratio > 0.2 && frames < 200; frames++) {
        run_free(sim, 1);
        pel_sim_measure(sim, &measures);
    }
    pel_contact_statistics s = statistics_of(sim);
    print_message("%-14s %-4s %3d frames, volume %.3f, cubics %lld of %lld pairs, %lld fall-backs, 0 intersections\n",
                  name, method == PEL_METHOD_PBD ? "pbd" : "xpbd", frames, measures.volume_ratio, (long long)s.cubics,
                  (long long)s.candidates, (long long)s.fall_backs);
    assert_true(measures.volume_ratio <= 0.2);
    assert_true(20 * s.cubics < s.candidates);
    frame_total += frames;
    scene_end(&scene, sim);
}

static pel_mesh *read_scaled(const char *name, double scale)
{
    char path[400];
    pel_mesh *mesh;
    snprintf(path, sizeof path, "%s/../shared/data/%s.obj", PEL_SOURCE_DIR, name);
    if (pel_mesh_read(path, PEL_FORMAT_AUTO, NULL, &mesh, NULL) != PEL_OK)
        return NULL;
    pel_transform transform = pel_transform_default();
    transform.scale[0] = transform.scale[1] = transform.scale[2] = scale;
    assert_int_equal(pel_mesh_transform(mesh, &transform, NULL), PEL_OK);
    return mesh;
}

static void test_contraction(void **unused)
{
    (void)unused;
    static const pel_method methods[] = {PEL_METHOD_PBD, PEL_METHOD_XPBD};
    static const struct {
        const char *name;
        double scale;
    } scans[] = {{"spot", 1},         {"gallbladder", 30}, {"goat-head", 0.12},
                 {"liver-coarse", 8}, {"spleen", 25},      {"koala", 0.2}};
    for (int m = 0; m < 2; m++) {
        contract("ball", make_sphere(8), methods[m]);
        contract("ring", make_shape(PEL_SHAPE_TORUS), methods[m]);
        for (size_t i = 0; is_all() && i < sizeof scans / sizeof *scans; i++) {
            pel_mesh *mesh = read_scaled(scans[i].name, scans[i].scale);
            if (mesh != NULL)
                contract(scans[i].name, mesh, methods[m]);
        }
    }
}

static void test_pressed_shell(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene.def.solver.dt = 1.0 / 60;
    scene_body(&scene, make_sphere(6));
    make_shell(&scene.bodies[0], 0);
    int count = (int)(0.1 * wanted_frames());
    for (int i = 0; i < 2; i++) {
        pel_tool_def *tool = scene_tool(&scene, PEL_TOOL_BOX);
        tool->half_extents[0] = tool->half_extents[1] = 2;
        tool->half_extents[2] = 0.1;
        double side = i == 0 ? 1 : -1;
        scene_move(&scene, i, 0, 0, 1.15 * side, 0.11 * side, 0.8 * count / 60);
    }
    prove("shell pressed flat, xpbd", &scene, scene_create(&scene), 0.1);
}

static void test_total(void **unused)
{
    (void)unused;
    print_message("%lld frames without an intersection\n", (long long)frame_total);
    assert_true(100 * frame_total >= 98 * (int64_t)wanted_frames());
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mass_spring),   cmocka_unit_test(test_tool),  cmocka_unit_test(test_contraction),
        cmocka_unit_test(test_pressed_shell), cmocka_unit_test(test_total),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
