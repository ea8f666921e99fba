/* Cuts: what stays, what parts, snapshots, refusals. */
#include "sim/cut_fixture.h"

#include "boundary/loads.h"
#include "failing_malloc.h"
#include "model/model.h"
#include "pellicle/live.h"

static const pel_method methods[] = {PEL_METHOD_EXPLICIT, PEL_METHOD_QUASI_STATIC, PEL_METHOD_PBD,
                                     PEL_METHOD_XPBD,     PEL_METHOD_IMPLICIT,     PEL_METHOD_STATIC,
                                     PEL_METHOD_DESCENT,  PEL_METHOD_PBD_DISTANCE};
enum { METHOD_COUNT = sizeof methods / sizeof methods[0] };

static bool has_velocity(pel_method method)
{
    return pel_stepper_of(method)->has_velocity;
}

/* ---- scenes ---- */

/* springs, filling, membrane and hinges at once, in whatever the method takes */
static pel_body_def full_body(const pel_mesh *mesh, pel_method method, int variant)
{
    pel_body_def body = pel_body_def_default();
    body.name = "sheet";
    body.mesh = mesh;
    body.mass_kind = (pel_mass_kind)(variant % 3);
    body.mass = variant % 3 == PEL_MASS_DENSITY ? 1000 : 0.3;
    body.thickness.value = 0.01;
    body.spring_stiffness.value = 20;
    body.volumetric_stiffness.value = 0.5;
    body.volumetric_by_area = variant % 2 == 1;
    bool has_shell = method != PEL_METHOD_QUASI_STATIC && method != PEL_METHOD_PBD_DISTANCE && variant % 4 != 3;
    if (has_shell) {
        body.shell.membrane.on = true;
        body.shell.membrane.young.value = 100;
        body.shell.membrane.thickness.value = 0.01;
        body.shell.membrane.poisson = 0.3;
    }
    return body;
}

static void disturb(pel_sim *sim, random_state *random)
{
    int32_t count = pel_sim_vertex_count(sim, 0);
    double *x = calloc((size_t)count, 24);
    pel_sim_get_positions(sim, 0, x);
    for (int32_t i = 0; i < 3 * count; i++)
        x[i] += random_between(random, -0.01, 0.01);
    assert_int_equal(pel_sim_set_positions(sim, 0, x, NULL), PEL_OK);
    for (int32_t i = 0; i < 3 * count; i++)
        x[i] = random_between(random, -1, 1);
    assert_int_equal(pel_sim_set_velocities(sim, 0, x, NULL), PEL_OK);
    free(x);
}

static void check_surface(const pel_sim *sim, const pel_mesh *before)
{
    const pel_mesh *mesh = pel_sim_model(sim)->bodies[0].mesh;
    int32_t *origins = calloc((size_t)mesh->vertex_count, 4);
    pel_topology *topology;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    pel_topology_destroy(topology);
    pel_sim_get_origins(sim, 0, origins);
    assert_int_equal(mesh->triangle_count, before->triangle_count);
    for (int32_t c = 0; c < 3 * mesh->triangle_count; c++)
        assert_int_equal(origins[mesh->triangles[c / 3][c % 3]], before->triangles[c / 3][c % 3]);
    free(origins);
}

/* ---- tests ---- */

/* random cuts, one after the other, in random states of random bodies */
static void test_sums_stay(void **unused)
{
    (void)unused;
    random_state random = {11};
    for (int round = 0; round < ROUNDS(6, 1) * METHOD_COUNT; round++) {
        pel_method method = methods[round % METHOD_COUNT];
        pel_mesh *mesh = round % 2 == 0 ? make_irregular_patch(6, &random) : make_irregular_ball(3, &random);
        pel_body_def body = full_body(mesh, method, (int)random_below(&random, 12));
        int32_t pins[2] = {3, 9}, path[12], made = 0;
        body.pinned = pins;
        body.pinned_count = round % 3 == 0 ? 2 : 0;
        pel_model *model = make_model(&body);
        pel_sim_def def = lone_sim(model, method, 1e-3);
        pel_load_def load = pel_load_def_default();
        load.force[2] = 0.1;
        def.loads = &load;
        def.load_count = 1;
        pel_sim *sim = make_sim(&def);
        run_steps(sim, 1);
        disturb(sim, &random);
        for (int cuts = 0; cuts < 4; cuts++) {
            const sums before = sums_of(sim);
            int32_t count = random_path(mesh, &random, 4 + (int32_t)random_below(&random, 9), path);
            pel_error error;
            if (count < 3 || pel_cut(sim, 0, path, count, &error) != PEL_OK)
                continue;
            made++;
            check_surface(sim, mesh);
            const sums after = sums_of(sim);
            compare(&before, &after);
        }
        assert_true(made > 0);
        run_steps(sim, 3);
        pel_sim_destroy(sim);
        pel_model_destroy(model);
        pel_mesh_destroy(mesh);
    }
}

/* a sheet that hangs by its upper edge, cut in two */
static stage make_sheet(pel_method method, int32_t n, const pel_cut_def *cuts, int32_t cut_count)
{
    static int32_t pins[64];
    stage s = {.mesh = make_grid(n, n, 1, 1, PEL_GRID_UNION_JACK)};
    pel_body_def body = full_body(s.mesh, method, PEL_MASS_DENSITY);
    pel_model_def model_def = pel_model_def_default();
    body.pinned_count = 0;
    for (int32_t v = 0; v < s.mesh->vertex_count; v++)
        if (s.mesh->positions[v][1] > 0.5 - 1e-9)
            pins[body.pinned_count++] = v;
    body.pinned = pins;
    body.volumetric_stiffness.value = body.spring_damping.value = body.volumetric_damping.value = 0;
    model_def.bodies = &body;
    model_def.body_count = 1;
    model_def.gravity[1] = -1;
    assert_int_equal(pel_model_create(&model_def, &s.model, NULL), PEL_OK);
    pel_sim_def def = lone_sim(s.model, method, 1e-3);
    def.cuts = cuts;
    def.cut_count = cut_count;
    s.sim = make_sim(&def);
    return s;
}

static void test_a_piece_falls(void **unused)
{
    (void)unused;
    for (int m = 0; m < METHOD_COUNT; m++) {
        int32_t path[16], count = 0;
        stage s = make_sheet(methods[m], 8, NULL, 0);
        pel_cut_reading reading;
        for (int32_t v = 0; v < s.mesh->vertex_count; v++)
            if (fabs(s.mesh->positions[v][1]) < 1e-9)
                path[count++] = v;
        assert_int_equal(count, 9);
        assert_int_equal(pel_cut(s.sim, 0, path, count, NULL), PEL_OK);
        assert_int_equal(pel_sim_get_cuts(s.sim, 0, &reading, NULL), PEL_OK);
        assert_near(reading.length, 1, 1e-14);
        assert_int_equal(reading.island_count, 1);
        assert_int_equal(reading.copy_count, 9);
        if (has_velocity(methods[m]) && methods[m] != PEL_METHOD_PBD_DISTANCE) {
            double *x = calloc((size_t)pel_sim_vertex_count(s.sim, 0), 24);
            run_steps(s.sim, 100);
            pel_sim_get_positions(s.sim, 0, x);
            int32_t v = nearest_vertex(s.mesh, 0, -0.5, 0);
            /* free fall */
            assert_near(x[3 * v + 1], -0.5 - 0.5 * 0.01, methods[m] == PEL_METHOD_PBD ? 1e-3 : 2e-4);
            free(x);
        }
        end_stage(&s);
    }
}

/* a slit in a sheet under tension opens, and its ends do not move apart by more than the sheet stretches */
static void test_scripted_cuts_are_cuts(void **unused)
{
    (void)unused;
    for (int m = 0; m < METHOD_COUNT; m++) {
        int32_t path[2][16];
        pel_mesh *mesh = make_grid(8, 8, 1, 1, PEL_GRID_UNION_JACK);
        pel_cut_def cuts[2] = {{.at = 0, .vertices = path[0]}, {.at = 5e-3, .vertices = path[1]}};
        cuts[0].vertex_count = column(mesh, 0, -0.25, 0.25, path[0]);
        cuts[1].vertex_count = column(mesh, 0.25, -0.5, 0.25, path[1]);
        pel_mesh_destroy(mesh);
        stage s = make_sheet(methods[m], 8, cuts, 2), by_hand = make_sheet(methods[m], 8, NULL, 0);
        run_steps(s.sim, 10);
        assert_int_equal(pel_cut(by_hand.sim, 0, path[0], cuts[0].vertex_count, NULL), PEL_OK);
        run_steps(by_hand.sim, 5);
        assert_int_equal(pel_cut(by_hand.sim, 0, path[1], cuts[1].vertex_count, NULL), PEL_OK);
        run_steps(by_hand.sim, 5);
        assert_true(pel_sim_hash(s.sim) == pel_sim_hash(by_hand.sim));
        assert_int_equal(pel_sim_surface_revision(s.sim, 0), 2);
        end_stage(&s);
        end_stage(&by_hand);
    }
}

/* resume in a new simulation, back to a state before the cut, and undo with parameters */
static void test_snapshots(void **unused)
{
    (void)unused;
    for (int m = 0; m < METHOD_COUNT; m++) {
        int32_t path[16];
        pel_mesh *mesh = make_grid(8, 8, 1, 1, PEL_GRID_UNION_JACK);
        const pel_cut_def cut = {.at = 3e-3, .vertices = path, .vertex_count = column(mesh, 0, -0.5, 0, path)};
        pel_mesh_destroy(mesh);
        stage s = make_sheet(methods[m], 8, &cut, 1), other = make_sheet(methods[m], 8, &cut, 1);
        pel_snapshot *undo;
        run_steps(s.sim, 2);
        size_t size = pel_sim_save_size(s.sim);
        void *before = malloc(size);
        pel_sim_save(s.sim, before);
        assert_int_equal(pel_snapshot_create(s.sim, &undo, NULL), PEL_OK);
        run_steps(s.sim, 4);
        size_t cut_size = pel_sim_save_size(s.sim);
        void *after = malloc(cut_size);
        assert_true(cut_size > size);
        pel_sim_save(s.sim, after);
        run_steps(s.sim, 3);
        uint64_t end = pel_sim_hash(s.sim);

        assert_int_equal(pel_sim_load(other.sim, after, cut_size, NULL), PEL_OK);
        run_steps(other.sim, 3);
        assert_true(pel_sim_hash(other.sim) == end);
        assert_int_equal(pel_sim_load(other.sim, before, size, NULL), PEL_OK);
        run_steps(other.sim, 7);
        assert_true(pel_sim_hash(other.sim) == end);

        /* pins that differ: the snapshot's defs are taken */
        assert_int_equal(pel_sim_set_pins(s.sim, 0, path, 1, NULL), PEL_OK);
        run_steps(s.sim, 1);
        assert_int_equal(pel_snapshot_restore(s.sim, undo, NULL), PEL_OK);
        assert_int_equal(pel_sim_vertex_count(s.sim, 0), s.mesh->vertex_count);
        run_steps(s.sim, 7);
        assert_true(pel_sim_hash(s.sim) == end);
        pel_snapshot_destroy(undo);
        free(before);
        free(after);
        end_stage(&s);
        end_stage(&other);
    }
}

/* all that lives by vertex goes to both lips */
static void test_defs_follow(void **unused)
{
    (void)unused;
    random_state random = {5};
    pel_mesh *mesh = make_irregular_patch(6, &random);
    int32_t path[16], count = 0, *origins;
    while (count < 6)
        count = random_path(mesh, &random, 8, path);
    double *field = calloc((size_t)mesh->vertex_count, 8), weights[2] = {0.5, 2}, sum = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        field[v] = 1 + v;
    assert_int_equal(pel_mesh_add_field(mesh, "number", 1, field, NULL), PEL_OK);
    pel_body_def body = full_body(mesh, PEL_METHOD_IMPLICIT, 0);
    body.spring_stiffness.value = 0;
    body.spring_stiffness.field = field;
    body.pinned = path + 1;
    body.pinned_count = 1;
    pel_model *model = make_model(&body);
    pel_sim_def def = lone_sim(model, PEL_METHOD_IMPLICIT, 1e-3);
    pel_load_def loads[2] = {pel_load_def_default(), pel_load_def_default()};
    loads[0].vertices = path + 2;
    loads[0].vertex_count = 2;
    loads[0].weights = weights;
    loads[0].force[0] = 6;
    loads[1].kind = PEL_LOAD_PER_VERTEX;
    loads[1].force[1] = 1;
    pel_support_def support = pel_support_def_default();
    support.name = "spring";
    support.vertices = path + 2;
    support.vertex_count = 3;
    support.stiffness = 7;
    def.loads = loads;
    def.load_count = 2;
    def.supports = &support;
    def.support_count = 1;
    pel_sim *sim = make_sim(&def);
    double *given = calloc(3 * (size_t)mesh->vertex_count, 8);
    for (int32_t v = 0; v < 3 * mesh->vertex_count; v++)
        given[v] = v % 7;
    assert_int_equal(pel_sim_set_forces(sim, 0, given, NULL), PEL_OK);
    assert_int_equal(pel_cut(sim, 0, path, count, NULL), PEL_OK);
    const pel_body_def *now = &pel_sim_model(sim)->def.bodies[0];
    int32_t now_count = now->mesh->vertex_count;
    origins = calloc((size_t)now_count, 4);
    pel_sim_get_origins(sim, 0, origins);
    assert_true(now_count > mesh->vertex_count);
    for (int32_t v = 0; v < now_count; v++) {
        assert_true(now->spring_stiffness.field[v] == field[origins[v]]);
        assert_true(pel_mesh_field(now->mesh, "number")->values[v] == field[origins[v]]);
        bool is_pinned = pel_sim_model(sim)->inverse_mass[pel_sim_model(sim)->bodies[0].model_index[v]] == 0;
        assert_true(is_pinned == (origins[v] == path[1]));
    }
    /* loads act with their sums */
    for (int l = 0; l < 2; l++) {
        const pel_load *load = &sim->loads->items[l];
        sum = 0;
        for (int32_t i = 0; i < load->vertex_count; i++)
            sum += load->weights[i];
        assert_near(sum, l == 0 ? 2.5 / 2 : mesh->vertex_count, 1e-12);
    }
    for (int c = 0; c < 3; c++) {
        double wanted = 0;
        sum = 0;
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            wanted += given[3 * v + c];
        for (int32_t v = 0; v < pel_sim_model(sim)->vertex_count; v++)
            sum += (double)sim->loads->external[v][c];
        assert_near(sum, wanted, IN_FLOAT(1e-12, 1e-5) * wanted);
    }
    run_steps(sim, 2);
    free(field);
    free(given);
    free(origins);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* loads per length act on the border as before, not on lips */
static void test_lips_are_no_border(void **unused)
{
    (void)unused;
    for (int variant = 0; variant < 3; variant++) {
        int32_t path[16], count;
        pel_mesh *mesh = make_grid(8, 8, 1, 1, PEL_GRID_UNION_JACK);
        pel_body_def body = full_body(mesh, PEL_METHOD_IMPLICIT, PEL_MASS_DENSITY);
        body.shell.bending.model = PEL_BENDING_MIDEDGE;
        body.shell.bending.stiffness.value = 1e-3;
        pel_model *model = make_model(&body);
        pel_sim_def def = lone_sim(model, PEL_METHOD_IMPLICIT, 1e-3);
        pel_load_def load = pel_load_def_default();
        load.kind = variant == 2 ? PEL_LOAD_MOMENT : PEL_LOAD_PER_LENGTH;
        load.follower = variant == 1;
        load.force[0] = 1;
        def.loads = &load;
        def.load_count = 1;
        pel_sim *sim = make_sim(&def);
        count = column(mesh, 0, -0.5, 0.25, path);
        assert_int_equal(pel_cut(sim, 0, path, count, NULL), PEL_OK);
        double length = 0;
        for (int32_t i = 0; i < sim->loads->items[0].vertex_count; i++)
            length += sim->loads->items[0].weights[i];
        for (int32_t i = 0; i < sim->loads->follower_count; i++)
            length += sim->loads->followers[i].length;
        if (variant < 2)
            assert_near(length, 4, 1e-12);
        else
            assert_int_equal(sim->loads->edge_load_count, 32);
        run_steps(sim, 2);
        pel_sim_destroy(sim);
        pel_model_destroy(model);
        pel_mesh_destroy(mesh);
    }
}

/* the energy of the hinges across the cut is booked, and the balance holds */
static void test_ledger(void **unused)
{
    (void)unused;
    int32_t path[16], count;
    pel_mesh *mesh = make_grid(8, 8, 1, 1, PEL_GRID_UNION_JACK);
    pel_body_def body = full_body(mesh, PEL_METHOD_IMPLICIT, PEL_MASS_DENSITY);
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.bending.stiffness.value = 1;
    pel_model *model = make_model(&body);
    pel_sim_def def = lone_sim(model, PEL_METHOD_IMPLICIT, 1e-3);
    pel_sim *sim = make_sim(&def);
    pel_sim_ledger ledger;
    run_steps(sim, 1);
    double *x = calloc(3 * (size_t)mesh->vertex_count, 8);
    pel_sim_get_positions(sim, 0, x);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        x[3 * v + 2] = 0.3 * fabs(x[3 * v]);
    assert_int_equal(pel_sim_set_positions(sim, 0, x, NULL), PEL_OK);
    const sums before = sums_of(sim);
    count = column(mesh, 0, -0.5, 0.5, path);
    assert_int_equal(pel_cut(sim, 0, path, count, NULL), PEL_OK);
    const sums after = sums_of(sim);
    pel_sim_get_ledger(sim, &ledger);
    assert_true(before.bending > 1e-3);
    assert_near(after.bending, 0, 1e-9 * before.bending);
    assert_near(ledger.dissipated_fracture, before.bending, 1e-9 * before.bending);
    assert_near(ledger.dissipated_solver, 0, 1e-9 * ledger.work_setters);
    free(x);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* a grasp holds both lips, where they were */
static void test_grasps_hold_copies(void **unused)
{
    (void)unused;
    int32_t path[16], count;
    pel_mesh *mesh = make_grid(8, 8, 1, 1, PEL_GRID_UNION_JACK);
    for (int m = 0; m < METHOD_COUNT; m++) {
        pel_body_def body = full_body(mesh, methods[m], PEL_MASS_DENSITY);
        pel_model *model = make_model(&body);
        pel_sim_def def = lone_sim(model, methods[m], 1e-3);
        pel_pose_key key = {.rotation = {0, 0, 0, 1}};
        pel_tool_def tool = pel_tool_def_default();
        tool.name = "hand";
        tool.shape = PEL_TOOL_SPHERE;
        tool.radius = 0.01;
        tool.grasp = true;
        tool.press = false;
        tool.reach = 0.2;
        tool.grasp_until = HUGE_VAL;
        tool.keys = &key;
        tool.key_count = 1;
        def.tools = &tool;
        def.tool_count = 1;
        pel_sim *sim = make_sim(&def);
        pel_tool_reading before, after;
        run_steps(sim, 2);
        pel_sim_get_tool(sim, 0, &before);
        count = column(mesh, 0, -0.5, 0.5, path);
        assert_int_equal(pel_cut(sim, 0, path, count, NULL), PEL_OK);
        run_steps(sim, 2);
        pel_sim_get_tool(sim, 0, &after);
        assert_int_equal(before.held_count, 9);
        assert_int_equal(after.held_count, 9 + 3);
        pel_sim_destroy(sim);
        pel_model_destroy(model);
    }
    pel_mesh_destroy(mesh);
}

static void check_fault(pel_sim *sim, const int32_t *path, int32_t count, const char *words)
{
    pel_error error = {0};
    uint64_t hash = pel_sim_hash(sim);
    int64_t revision = pel_sim_surface_revision(sim, 0);
    pel_status status = pel_cut(sim, 0, path, count, &error);
    if (status != PEL_BAD_ARGUMENT || strstr(error.what, words) == NULL)
        fail_msg("%d: %s", (int)status, error.what);
    assert_true(error.remedy[0] != '\0' && pel_sim_hash(sim) == hash);
    assert_int_equal(pel_sim_surface_revision(sim, 0), revision);
}

static void test_refusals(void **unused)
{
    (void)unused;
    stage s = make_sheet(PEL_METHOD_XPBD, 8, NULL, 0);
    int32_t inner = nearest_vertex(s.mesh, 0, 0, 0), next = nearest_vertex(s.mesh, 0, 0.125, 0),
            corner = nearest_vertex(s.mesh, -0.5, -0.5, 0), beside = nearest_vertex(s.mesh, -0.375, -0.5, 0),
            border = nearest_vertex(s.mesh, 0, -0.5, 0), path[16];
    check_fault(s.sim, (int32_t[]){inner, next}, 2, "a single edge");
    check_fault(s.sim, (int32_t[]){inner}, 1, "1 vertices");
    check_fault(s.sim, (int32_t[]){inner, 1000}, 2, "does not exist");
    check_fault(s.sim, (int32_t[]){inner, -1}, 2, "does not exist");
    check_fault(s.sim, (int32_t[]){inner, corner}, 2, "no edge joins");
    check_fault(s.sim, (int32_t[]){inner, inner}, 2, "no edge joins");
    check_fault(s.sim, (int32_t[]){corner, beside}, 2, "along the border");
    int32_t count = column(s.mesh, 0, -0.5, 0, path);
    assert_int_equal(path[0], border);
    assert_int_equal(pel_cut(s.sim, 0, path, count, NULL), PEL_OK);
    check_fault(s.sim, path, count, "open already");
    /* from the tip on, over the part that is open */
    count = column(s.mesh, 0, -0.5, 0.25, path);
    assert_int_equal(pel_cut(s.sim, 0, path, count, NULL), PEL_OK);
    end_stage(&s);

    pel_cut_def cuts[2] = {{.at = 1, .vertices = path, .vertex_count = count},
                           {.at = 0.5, .vertices = path, .vertex_count = count}};
    s = make_sheet(PEL_METHOD_XPBD, 8, NULL, 0);
    pel_sim_def def = lone_sim(s.model, PEL_METHOD_XPBD, 1e-3);
    def.cuts = cuts;
    def.cut_count = 2;
    check_refusal(&def, 0, "time of the cut", "cut");
    cuts[1].at = (double)NAN;
    check_refusal(&def, 1, "time of the cut", "cut");
    end_stage(&s);
}

static void test_closed_needs(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(4);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_NEO_HOOKEAN);
    body.shell.pressure.kind = PEL_PRESSURE_GAS;
    body.shell.pressure.value = 100;
    pel_model *model = make_model(&body);
    pel_sim_def def = lone_sim(model, PEL_METHOD_XPBD, 1e-3);
    pel_sim *sim = make_sim(&def);
    random_state random = {3};
    int32_t path[8], count = random_path(mesh, &random, 5, path);
    pel_error error;
    run_steps(sim, 1);
    assert_int_equal(pel_cut(sim, 0, path, count, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "encloses no volume"));
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    body.refine.levels = 1;
    body.refine.everywhere = true;
    body.shell.pressure.kind = PEL_PRESSURE_NONE;
    model = make_model(&body);
    def.model = model;
    sim = make_sim(&def);
    assert_int_equal(pel_cut(sim, 0, path, count, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "refines"));
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* a shut path cuts a piece out; a cross parts four */
static void test_islands(void **unused)
{
    (void)unused;
    stage s = make_sheet(PEL_METHOD_XPBD, 8, NULL, 0);
    int32_t path[16], count = 0;
    pel_cut_reading reading;
    const double ring[9][2] = {{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}};
    for (int i = 0; i < 9; i++)
        path[count++] = nearest_vertex(s.mesh, ring[i][0] / 8, ring[i][1] / 8, 0);
    assert_int_equal(pel_cut(s.sim, 0, path, count, NULL), PEL_OK);
    assert_int_equal(pel_sim_get_cuts(s.sim, 0, &reading, NULL), PEL_OK);
    assert_int_equal(reading.island_count, 1);
    assert_int_equal(reading.copy_count, 8);
    assert_near(reading.length, 1, 1e-14);
    count = column(s.mesh, 0, -0.5, 0.5, path);
    assert_int_equal(pel_cut(s.sim, 0, path, count, NULL), PEL_OK);
    assert_int_equal(pel_sim_get_cuts(s.sim, 0, &reading, NULL), PEL_OK);
    assert_int_equal(reading.island_count, 3);
    run_steps(s.sim, 5);
    end_stage(&s);
}

/* the case of a def whose model is cut and uncut again; the simulation is as before where a part of that fails */
static pel_status cut_and_return(const void *context, pel_error *error)
{
    const pel_sim_def *def = context;
    int32_t path[16], count = column(def->model->bodies[0].mesh, 0, -0.5, 0.25, path);
    unsigned char start[1 << 16];
    pel_sim *sim;
    pel_status status = pel_sim_create(def, &sim, error);
    if (status != PEL_OK)
        return status;
    size_t size = pel_sim_save_size(sim);
    assert_true(size <= sizeof start);
    pel_sim_save(sim, start);
    uint64_t before = pel_sim_hash(sim);
    status = pel_cut(sim, 0, path, count, error);
    assert_true((pel_sim_hash(sim) == before) == (status != PEL_OK));
    uint64_t cut = pel_sim_hash(sim);
    if (status == PEL_OK) {
        status = pel_sim_load(sim, start, size, error);
        assert_true(pel_sim_hash(sim) == (status == PEL_OK ? before : cut));
    }
    pel_sim_destroy(sim);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    stage s = make_sheet(PEL_METHOD_XPBD, 4, NULL, 0);
    pel_sim_def def = lone_sim(s.model, PEL_METHOD_XPBD, 1e-3);
    assert_true(for_every_allocation_failure(cut_and_return, &def) > 40);
    end_stage(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sums_stay),
        cmocka_unit_test(test_a_piece_falls),
        cmocka_unit_test(test_scripted_cuts_are_cuts),
        cmocka_unit_test(test_snapshots),
        cmocka_unit_test(test_defs_follow),
        cmocka_unit_test(test_lips_are_no_border),
        cmocka_unit_test(test_ledger),
        cmocka_unit_test(test_grasps_hold_copies),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_closed_needs),
        cmocka_unit_test(test_islands),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
