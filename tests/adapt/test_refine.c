/* Bodies that refine: invariants of events, the criterion, and that a body without events equals the plain body. */
#include "boundary/loads.h"
#include "failing_malloc.h"
#include "pellicle/live.h"
#include "pellicle/shape.h"
#include "pellicle/sim_forces.h"
#include "random.h"
#include "sim/refine_fixture.h"
#include "tool/tool.h"

/* ---- the plain body ---- */

static uint64_t pressed_hash(int32_t levels, int method, int threads)
{
    const pel_pose_key keys[2] = {{0, {0, 0, 1.5}, {0, 0, 0, 1}, {0}}, {1, {0, 0, 1.0}, {0, 0, 0, 1}, {0}}};
    const int32_t pulled[3] = {7, 100, 211};
    pel_mesh *mesh = make_sphere(8);
    pel_body_def body = ball(mesh, levels);
    pel_load_def load = pel_load_def_default();
    load.force[0] = 0.5;
    load.vertices = pulled;
    load.vertex_count = 3;
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "probe";
    tool.radius = 0.4;
    tool.keys = keys;
    tool.key_count = 2;
    pel_sim_def def = method == 0 ? pel_sim_def_default() : explicit_def(0.005);
    if (method == 0)
        def.solver.alpha = 30;
    if (method == 2) {
        def.solver = pel_sim_def_default().solver;
        def.solver.alpha = 5;
        def.solver.keep_velocity = true;
    }
    def.loads = &load;
    def.load_count = 1;
    def.tools = &tool;
    def.tool_count = 1;
    def.thread_count = threads;
    bench made = begin(mesh, &body, &def);
    run_steps(made.sim, 150);
    uint64_t hash = pel_sim_hash(made.sim);
    end(&made);
    return hash;
}

static void test_unrefined_is_plain(void **unused)
{
    (void)unused;
    for (int method = 0; method < 3; method++)
        assert_true(pressed_hash(0, method, 1) == pressed_hash(2, method, 1));
}

/* ---- counts ---- */

static void test_paper_numbers(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(5);
    pel_body_def body = ball(mesh, 1);
    pel_sim_def def = pel_sim_def_default();
    bench made = begin(mesh, &body, &def);
    int count_294 = 0;
    for (int32_t v = 0; v < 252; v++) {
        refine(&made, v, 1);
        count_294 += pel_sim_vertex_count(made.sim, 0) == 294 && pel_sim_triangle_count(made.sim, 0) == 584;
        refine(&made, v, 0);
        assert_int_equal(pel_sim_vertex_count(made.sim, 0), 252);
    }
    assert_int_equal(count_294, 180);
    end(&made);
    mesh = make_sphere(5);
    body = ball(mesh, 1);
    body.refine.everywhere = true;
    made = begin(mesh, &body, &def);
    pel_sim_measures measures;
    pel_sim_measure(made.sim, &measures);
    assert_int_equal(measures.vertex_count, 1002);
    assert_int_equal(measures.triangle_count, 2000);
    assert_near(measures.area_ratio, 1, rounding(1e-14, 1e-6));
    assert_near(measures.volume_ratio, 1, rounding(1e-14, 1e-6));
    assert_near(measures.elastic_energy, 0, rounding(1e-25, 1e-9));
    end(&made);
}

/* ---- invariants of events ---- */

/* hash of all that the loops read of a body, in the order of its rows */
static uint64_t hash_numbers(const bench *made)
{
    const pel_model *model = made->sim->model;
    uint64_t hash = 0;
    for (int32_t v = 0; v < made->mesh->vertex_count; v++) {
        int32_t i = model->bodies[0].model_index[v], slice = i / PEL_WIDTH, lane = i % PEL_WIDTH;
        const pel_real numbers[9] = {model->rest[i][0],
                                     model->rest[i][1],
                                     model->rest[i][2],
                                     model->rest[i][3],
                                     model->mass[i],
                                     model->inverse_mass[i],
                                     model->damping[i],
                                     model->volumetric_damping[i],
                                     made->sim->state->position[i][3]};
        for (int k = 0; k < 9; k++) {
            uint64_t bits = 0;
            memcpy(&bits, &numbers[k], sizeof numbers[k]);
            hash = hash * 31 + bits;
        }
        for (int32_t s = model->slot_begin[slice]; s < model->slot_end[slice]; s++) {
            uint64_t bits[2] = {0, 0};
            pel_real length = model->rest_lengths[s][lane], stiffness = model->stiffnesses[s][lane];
            memcpy(&bits[0], &length, sizeof length);
            memcpy(&bits[1], &stiffness, sizeof stiffness);
            hash = (hash * 31 + bits[0]) * 31 + bits[1] + (uint64_t)model->neighbours[s][lane];
        }
    }
    return hash;
}

static void test_back_to_base(void **unused)
{
    (void)unused;
    random_state random = {3};
    pel_mesh *mesh = make_sphere(4);
    pel_body_def body = ball(mesh, 3);
    body.mass_kind = PEL_MASS_DENSITY;
    body.thickness.value = 0.1;
    pel_sim_def def = pel_sim_def_default();
    bench made = begin(mesh, &body, &def);
    uint64_t start = hash_numbers(&made), shape = pel_sim_hash(made.sim);
    int32_t asked[12];
    for (int round = 0; round < 5; round++) {
        for (int i = 0; i < 12; i++) {
            asked[i] = (int32_t)random_integer(&random, 0, mesh->vertex_count - 1);
            refine(&made, asked[i], (int32_t)random_integer(&random, 1, 3));
        }
        assert_true(hash_numbers(&made) != start);
        for (int i = 0; i < 12; i++)
            refine(&made, asked[i], 0);
        assert_int_equal(pel_sim_vertex_count(made.sim, 0), mesh->vertex_count);
        assert_true(hash_numbers(&made) == start);
        assert_true(pel_sim_hash(made.sim) == shape);
    }
    end(&made);
}

typedef struct sums {
    double mass, momentum[3], kinetic, scale;
} sums;

static sums add_up(const bench *made)
{
    static double masses[200000], velocities[600000];
    int32_t n = pel_sim_vertex_count(made->sim, 0);
    sums s = {0};
    assert_true(n <= 200000);
    pel_sim_get_masses(made->sim, 0, masses);
    pel_sim_get_velocities(made->sim, 0, velocities);
    for (int32_t r = 0; r < n; r++) {
        s.mass += masses[r];
        for (int c = 0; c < 3; c++) {
            s.momentum[c] += masses[r] * velocities[3 * r + c];
            s.kinetic += 0.5 * masses[r] * velocities[3 * r + c] * velocities[3 * r + c];
            s.scale += masses[r] * fabs(velocities[3 * r + c]);
        }
    }
    return s;
}

static void assert_kept(const sums *before, const sums *after)
{
    assert_near(after->mass, before->mass, rounding(1e-14, 1e-6) * before->mass);
    for (int c = 0; c < 3; c++)
        assert_near(after->momentum[c], before->momentum[c], rounding(1e-12, 1e-4) * before->scale);
    assert_true(after->kinetic <= before->kinetic * (1 + rounding(1e-12, 1e-3)));
}

/* mass, momentum and kinetic energy over random events, on a mesh of uneven triangles and masses */
static void test_conservation(void **unused)
{
    (void)unused;
    for (int method = 0; method < 2; method++) {
        random_state random = {17};
        pel_mesh *mesh = make_sphere(4);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            for (int c = 0; c < 3; c++)
                mesh->positions[v][c] *= random_between(&random, 0.9, 1.1);
        pel_body_def body = ball(mesh, 3);
        pel_sim_def def = method == 0 ? explicit_def(1e-4) : pel_sim_def_default();
        if (method == 1) {
            def.solver.keep_velocity = true;
            def.solver.alpha = 5;
        }
        bench made = begin(mesh, &body, &def);
        double *velocities = calloc(600000, sizeof *velocities);
        for (int event = 0; event < 60; event++) {
            int32_t n = pel_sim_vertex_count(made.sim, 0);
            for (int32_t i = 0; i < 3 * n; i++)
                velocities[i] = random_normal(&random);
            assert_int_equal(pel_sim_set_velocities(made.sim, 0, velocities, NULL), PEL_OK);
            sums before = add_up(&made);
            int32_t v = (int32_t)random_integer(&random, 0, mesh->vertex_count - 1);
            refine(&made, v, (int32_t)random_integer(&random, 0, 3));
            sums after = add_up(&made);
            assert_kept(&before, &after);
        }
        /* a translation stays one */
        int32_t n = pel_sim_vertex_count(made.sim, 0);
        for (int32_t i = 0; i < 3 * n; i++)
            velocities[i] = 1;
        assert_int_equal(pel_sim_set_velocities(made.sim, 0, velocities, NULL), PEL_OK);
        for (int event = 0; event < 20; event++)
            refine(&made, event, event % 3);
        n = pel_sim_vertex_count(made.sim, 0);
        pel_sim_get_velocities(made.sim, 0, velocities);
        for (int32_t i = 0; i < 3 * n; i++)
            assert_near(velocities[i], 1, method == 0 ? rounding(1e-12, 1e-5) : rounding(1e-11, 1e-3));
        free(velocities);
        end(&made);
    }
}

/* turns, moves and pokes the present shape */
static void deform(const bench *made, double angle, double poke)
{
    static double x[60000];
    int32_t n = pel_sim_vertex_count(made->sim, 0);
    pel_sim_get_rest_positions(made->sim, 0, x);
    for (int32_t v = 0; v < n; v++) {
        double *p = &x[3 * v], z = p[2] - poke * exp(-4 * (p[0] * p[0] + p[1] * p[1])) * (p[2] > 0);
        double turned[3] = {cos(angle) * p[0] - sin(angle) * z + 0.3, p[1] - 0.2, sin(angle) * p[0] + cos(angle) * z};
        memcpy(p, turned, sizeof turned);
    }
    assert_int_equal(pel_sim_set_positions(made->sim, 0, x, NULL), PEL_OK);
}

static void test_rigid_motion(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(5);
    pel_body_def body = ball(mesh, 3);
    pel_sim_def def = pel_sim_def_default();
    bench made = begin(mesh, &body, &def);
    deform(&made, 0.7, 0);
    refine(&made, 100, 3);
    assert_true(spring_energy(&made) < rounding(1e-20, 1e-6));
    refine(&made, 100, 1);
    refine(&made, 101, 2);
    assert_true(spring_energy(&made) < rounding(1e-20, 1e-6));
    end(&made);
}

static int by_size(const void *a, const void *b)
{
    double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

/* the median over 20 centres in the poked part */
static void test_energy_jump(void **unused)
{
    (void)unused;
    const double pokes[3] = {0.05, 0.15, 0.3};
    for (int p = 0; p < 3; p++) {
        pel_mesh *mesh = make_sphere(5);
        pel_body_def body = ball(mesh, 1);
        pel_sim_def def = pel_sim_def_default();
        bench made = begin(mesh, &body, &def);
        double jumps[252];
        int count = 0;
        deform(&made, 0.7, pokes[p]);
        double before = spring_energy(&made);
        for (int32_t v = 0; v < 252 && count < 20; v++) {
            if (mesh->positions[v][2] < 0.6)
                continue;
            /* a fresh deformation each time: coarsening changes no position that is left */
            refine(&made, v, 1);
            jumps[count++] = fabs(spring_energy(&made) / before - 1);
            refine(&made, v, 0);
            assert_near(spring_energy(&made), before, 0.01 * before);
        }
        qsort(jumps, (size_t)count, sizeof *jumps, by_size);
        print_message("poke %.2f: energy jump median %.2f %%, worst %.2f %%\n", pokes[p], 100 * jumps[count / 2],
                      100 * jumps[count - 1]);
        assert_true(jumps[count - 1] < 0.01);
        end(&made);
    }
}

/* ---- stiffness ---- */

/* mean displacement of the mesh's vertices on a cap under a smooth or a uniform load, settled; refined: -1 locally */
static double settled(int32_t levels, bool local, bool uniform)
{
    pel_mesh *mesh = make_sphere(5);
    pel_body_def body = ball(mesh, levels);
    body.refine.everywhere = levels > 0 && !local;
    double weights[252], x[3 * 5000], sum = 0;
    for (int32_t v = 0; v < 252; v++) {
        double z = mesh->positions[v][2];
        weights[v] = uniform ? 1 : exp(-2 * (2 - 2 * z));
    }
    pel_load_def load = pel_load_def_default();
    load.force[2] = -0.2;
    load.weights = weights;
    pel_sim_def def = pel_sim_def_default();
    def.loads = &load;
    def.load_count = 1;
    bench made = begin(mesh, &body, &def);
    if (local)
        refine(&made, nearest_vertex(mesh, 0.3, 0.2, 0.9), 1);
    run_steps(made.sim, LONG(6000, 2000));
    pel_sim_get_positions(made.sim, 0, x);
    int count = 0;
    for (int32_t v = 0; v < 252; v++)
        if (mesh->positions[v][2] > 0.7) {
            double d = 0;
            for (int c = 0; c < 3; c++)
                d += pow(x[3 * v + c] - mesh->positions[v][c], 2);
            sum += sqrt(d);
            count++;
        }
    end(&made);
    return sum / count;
}

static void test_stiffness(void **unused)
{
    (void)unused;
    skip_if_slow();
    for (int uniform = 0; uniform < 2; uniform++) {
        double base = settled(0, false, uniform);
        double local = settled(1, true, uniform) / base, global = settled(1, false, uniform) / base;
        double finer = is_all() ? settled(2, false, uniform) / base : 1;
        print_message("%s load: 252 gives %.6f, 294 %.4f, 1002 %.4f, 4002 %.4f of it\n", uniform ? "uniform" : "smooth",
                      base, local, global, finer);
        assert_near(local, 1, 0.03);
        assert_near(global, 1, 0.03);
        assert_near(finer, 1, 0.03);
    }
}

/* ---- the criterion ---- */

static void test_criterion(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(8);
    pel_body_def body = ball(mesh, 2);
    body.refine.above = 5;
    body.refine.below = 2.5;
    int32_t pole;
    pel_load_def load = pole_load(mesh, &pole, 0.5);
    load.until = 3;
    pel_sim_def def = pel_sim_def_default();
    def.loads = &load;
    def.load_count = 1;
    bench made = begin(mesh, &body, &def);
    run_steps(made.sim, 290);
    assert_true(pel_sim_triangle_count(made.sim, 0) > mesh->triangle_count + 100);
    assert_true(pel_front_is_valid(made.sim->model->bodies[0].front));
    int32_t levels[20000], finest = 0;
    assert_true(pel_sim_vertex_count(made.sim, 0) < 20000);
    pel_sim_get_levels(made.sim, 0, levels);
    for (int32_t r = 0; r < pel_sim_vertex_count(made.sim, 0); r++)
        finest = levels[r] > finest ? levels[r] : finest;
    assert_int_equal(finest, 2);
    /* without the load: back to the base */
    run_steps(made.sim, 1500);
    assert_int_equal(pel_sim_triangle_count(made.sim, 0), mesh->triangle_count);
    end(&made);
}

/* a load that hovers about the threshold makes one event */
static void test_hysteresis(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(5);
    int32_t pole;
    pel_load_def load = pole_load(mesh, &pole, 0.1);
    pel_key keys[41];
    for (int k = 0; k < 41; k++)
        keys[k] = (pel_key){k < 2 ? 5 * k : 10 + 0.5 * k, k == 0 ? 0 : k % 2 ? 1.05 : 0.95};
    load.keys = keys;
    load.key_count = 41;
    pel_sim_def def = pel_sim_def_default();
    def.loads = &load;
    def.load_count = 1;
    /* the measure at the vertex in question under the whole load */
    pel_body_def body = ball(mesh, 1);
    body.refine.above = 0.1 * 252 / 12.4;
    body.refine.below = 0.6 * body.refine.above;
    bench made = begin(mesh, &body, &def);
    run_steps(made.sim, 3000);
    assert_int_equal(pel_sim_surface_revision(made.sim, 0), 1);
    end(&made);
}

static void test_budget(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(8);
    pel_body_def body = ball(mesh, 3);
    body.refine.above = 1;
    body.refine.below = 0.2;
    body.refine.budget = mesh->triangle_count + 400;
    const pel_pose_key keys[3] = {{0, {0, 0, 1.5}, {0, 0, 0, 1}, {0}},
                                  {1, {0, 0, 1.1}, {0, 0, 0, 1}, {0}},
                                  {3, {0.8, 0, 1.1}, {0, 0, 0, 1}, {0}}};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "probe";
    tool.radius = 0.3;
    tool.keys = keys;
    tool.key_count = 3;
    pel_sim_def def = pel_sim_def_default();
    def.tools = &tool;
    def.tool_count = 1;
    bench made = begin(mesh, &body, &def);
    int32_t most = 0;
    for (int n = 0; n < 300; n++) {
        run_steps(made.sim, 1);
        int32_t count = pel_sim_triangle_count(made.sim, 0);
        most = count > most ? count : most;
    }
    assert_true(most > body.refine.budget - 100 && most <= body.refine.budget);
    assert_true(pel_front_is_valid(made.sim->model->bodies[0].front));
    pel_error error;
    /* while it runs the room stays: no other small budget, told with what helps */
    const int32_t count = pel_sim_triangle_count(made.sim, 0);
    const int32_t others[] = {count - 40, 4 * count, 0};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        assert_int_equal(pel_set_parameter(made.sim, "bodies.0.refine.budget", others[i], &error), PEL_BAD_ARGUMENT);
        assert_string_equal(error.element_kind, "body");
        assert_non_null(strstr(error.what, "room"));
        assert_non_null(strstr(error.remedy, "or with 0 (no limit), from which it can change down to"));
    }
    assert_int_equal(pel_sim_triangle_count(made.sim, 0), count);
    assert_int_equal(pel_sim_refine(made.sim, 0, 600, 3, &error), PEL_BAD_ARGUMENT);
    assert_true(pel_front_is_valid(made.sim->model->bodies[0].front));
    end(&made);
}

/* without a budget at first: the number of the remedy is taken */
static void test_budget_changes(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(8);
    pel_body_def body = ball(mesh, 2);
    body.refine.above = 1e-9;
    body.refine.below = 0;
    pel_sim_def def = pel_sim_def_default();
    bench made = begin(mesh, &body, &def);
    pel_error error;
    assert_int_equal(pel_set_parameter(made.sim, "bodies.0.refine.budget", mesh->triangle_count, &error),
                     PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "fewer"));
    int least = 0;
    assert_int_equal(sscanf(error.remedy, "give at least %d, or 0", &least), 1);
    assert_int_equal(pel_set_parameter(made.sim, "bodies.0.refine.budget", least, &error), PEL_OK);
    assert_int_equal(pel_set_parameter(made.sim, "bodies.0.refine.budget", 0, &error), PEL_OK);
    assert_int_equal(pel_sim_refine(made.sim, 0, 0, 2, &error), PEL_OK);
    const int32_t fine = pel_sim_triangle_count(made.sim, 0);
    assert_true(fine > mesh->triangle_count);
    assert_int_equal(pel_set_parameter(made.sim, "bodies.0.refine.budget", least, &error), PEL_OK);
    run_steps(made.sim, 5);
    end(&made);
}

/* ---- tools, snapshots, threads ---- */

static bench sliding(int method, int threads, bool two_bodies)
{
    static const pel_pose_key keys[4] = {{0, {0, 0, 1.45}, {0, 0, 0, 1}, {0}},
                                         {0.5, {0, 0, 1.05}, {0, 0, 0, 1}, {0}},
                                         {1.5, {0.6, 0, 0.95}, {0, 0, 0, 1}, {0}},
                                         {2, {0.9, 0, 1.5}, {0, 0, 0, 1}, {0}}};
    static pel_tool_def tools[2];
    pel_mesh *mesh = make_sphere(8);
    tools[0] = tools[1] = pel_tool_def_default();
    tools[0].name = "probe";
    tools[0].radius = 0.2;
    tools[0].keys = keys;
    tools[0].key_count = 4;
    tools[1].name = "forceps";
    tools[1].radius = 0.1;
    static const pel_pose_key still[2] = {{0, {-1.1, 0, 0}, {0, 0, 0, 1}, {0}}, {2, {-1.4, 0.2, 0}, {0, 0, 0, 1}, {0}}};
    tools[1].keys = still;
    tools[1].key_count = 2;
    tools[1].grasp = true;
    tools[1].grasp_from = 0.2;
    tools[1].grasp_until = 1.6;
    tools[1].reach = 0.15;
    pel_body_def bodies[2] = {ball(mesh, 2), ball(mesh, 2)};
    bodies[0].refine.above = 4;
    bodies[0].refine.below = 2;
    bodies[0].refine.dwell = 20;
    bodies[1].name = "other";
    bodies[1].refine.levels = 0;
    if (two_bodies) {
        pel_body_def kept = bodies[0];
        bodies[0] = bodies[1];
        bodies[1] = kept;
    }
    pel_model_def model = pel_model_def_default();
    model.bodies = bodies;
    model.body_count = two_bodies ? 2 : 1;
    bench made = {.mesh = mesh};
    assert_int_equal(pel_model_create(&model, &made.model, NULL), PEL_OK);
    pel_sim_def def = method == 0 ? pel_sim_def_default() : explicit_def(0.004);
    def.model = made.model;
    def.tools = tools;
    def.tool_count = 2;
    def.thread_count = threads;
    made.sim = make_sim(&def);
    return made;
}

static void test_snapshot(void **unused)
{
    (void)unused;
    for (int method = 0; method < 2; method++) {
        int steps = method == 0 ? 110 : 260;
        bench made = sliding(method, 1, false), fresh = sliding(method, 1, false);
        run_steps(made.sim, steps);
        assert_true(pel_sim_triangle_count(made.sim, 0) > made.mesh->triangle_count);
        size_t size = pel_sim_save_size(made.sim);
        assert_int_equal(size, pel_sim_save_size(fresh.sim));
        void *bytes = malloc(size);
        pel_sim_save(made.sim, bytes);
        run_steps(fresh.sim, 30);
        pel_error error;
        assert_int_equal(pel_sim_load(fresh.sim, bytes, size, &error), PEL_OK);
        assert_true(pel_sim_hash(made.sim) == pel_sim_hash(fresh.sim));
        for (int n = 0; n < 10; n++) {
            run_steps(made.sim, 20);
            run_steps(fresh.sim, 20);
            assert_true(pel_sim_hash(made.sim) == pel_sim_hash(fresh.sim));
        }
        free(bytes);
        end(&made);
        end(&fresh);
    }
}

/* a body that refines beside one that does not: each as if it were alone, for any number of threads */
static void test_two_bodies(void **unused)
{
    (void)unused;
    bench one = sliding(0, 1, true), other = sliding(0, 3, true);
    run_steps(one.sim, 150);
    run_steps(other.sim, 150);
    assert_true(pel_sim_hash(one.sim) == pel_sim_hash(other.sim));
    assert_true(pel_sim_triangle_count(one.sim, 1) > pel_sim_triangle_count(one.sim, 0));
    end(&one);
    end(&other);
}

/* the tool never lies deeper in the surface than it may, at whatever level */
static void test_tool_stays_outside(void **unused)
{
    (void)unused;
    for (int method = 0; method < 2; method++) {
        bench made = sliding(method, 1, false);
        int64_t events = 0;
        for (int n = 0; n < (method == 0 ? 200 : 500); n++) {
            run_steps(made.sim, 1);
            pel_tool_reading reading;
            pel_sim_get_tool(made.sim, 0, &reading);
            static double x[60000];
            int32_t count = pel_sim_vertex_count(made.sim, 0);
            pel_sim_get_positions(made.sim, 0, x);
            for (int32_t v = 0; v < count; v++) {
                double d[3];
                for (int c = 0; c < 3; c++)
                    d[c] = x[3 * v + c] - reading.position[c];
                assert_true(sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) > 0.2 * 0.995);
            }
            events = pel_sim_surface_revision(made.sim, 0);
        }
        assert_true(events > 3);
        end(&made);
    }
}

/* for any order of requested vertices the results have the same bits */
static void test_order(void **unused)
{
    (void)unused;
    uint64_t hashes[2];
    for (int turn = 0; turn < 2; turn++) {
        pel_mesh *mesh = make_sphere(6);
        pel_body_def body = ball(mesh, 2);
        pel_load_def load = pel_load_def_default();
        load.force[1] = 0.5;
        pel_sim_def def = pel_sim_def_default();
        def.loads = &load;
        def.load_count = 1;
        bench made = begin(mesh, &body, &def);
        const int32_t asked[3] = {40, 200, 44};
        for (int i = 0; i < 3; i++)
            refine(&made, asked[turn == 0 ? i : 2 - i], 2);
        if (turn == 1) {
            refine(&made, 300, 2);
            refine(&made, 300, 0);
        }
        run_steps(made.sim, 50);
        hashes[turn] = pel_sim_hash(made.sim);
        end(&made);
    }
    assert_true(hashes[0] == hashes[1]);
}

/* forces of all rows; the loads alone, as the body is at rest */
static double *forces_of(const bench *made, int32_t *count)
{
    *count = pel_sim_vertex_count(made->sim, 0);
    double *forces = calloc((size_t)*count * 3, sizeof *forces);
    assert_non_null(forces);
    pel_sim_get_forces(made->sim, 0, forces);
    return forces;
}

/* a load on a part of the body after any history of events is that of a sim that was refined once: vertices come into
   the load and leave it, and their places are taken by others that it does not act on */
static void test_loads_follow(void **unused)
{
    (void)unused;
    enum { FREQUENCY = 5, COUNT = 10 * FREQUENCY * FREQUENCY + 2, ROUNDS_OF_EVENTS = 80 };
    random_state random = {11};
    int32_t asked[COUNT] = {0}, loaded[COUNT], count = 0;
    double weights[COUNT];
    pel_mesh *mesh = make_sphere(FREQUENCY);
    for (int32_t v = 0; v < COUNT; v++)
        if (mesh->positions[v][2] > 0.5) {
            weights[count] = random_between(&random, -1, 1);
            loaded[count++] = v;
        }
    pel_body_def body = ball(mesh, 2);
    pel_load_def load = pel_load_def_default();
    load.kind = PEL_LOAD_PER_VERTEX;
    load.force[1] = 0.5;
    load.vertices = loaded;
    load.weights = weights;
    load.vertex_count = count;
    pel_sim_def def = pel_sim_def_default();
    def.loads = &load;
    def.load_count = 1;
    bench made = begin(mesh, &body, &def);
    for (int i = 0; i < ROUNDS_OF_EVENTS; i++) {
        int32_t v = (int32_t)random_integer(&random, 0, COUNT - 1), row_count, expected_count;
        /* half of the events give all up again, so that places become free */
        for (int32_t u = 0; i % 2 == 1 && u < COUNT; u++)
            if (asked[u] > 0 && random_between(&random, 0, 1) < 0.7) {
                asked[u] = 0;
                refine(&made, u, 0);
            }
        asked[v] = (int32_t)random_integer(&random, 1, 2);
        refine(&made, v, asked[v]);
        bench once = begin(make_sphere(FREQUENCY), &body, &def);
        for (int32_t u = 0; u < COUNT; u++)
            if (asked[u] > 0)
                refine(&once, u, asked[u]);
        double *forces = forces_of(&made, &row_count), *expected = forces_of(&once, &expected_count);
        assert_int_equal(row_count, expected_count);
        assert_memory_equal(forces, expected, (size_t)row_count * 3 * sizeof *forces);
        /* what the sim steps with: each vertex once */
        assert_int_equal(made.sim->loads->items[0].vertex_count, once.sim->loads->items[0].vertex_count);
        free(forces);
        free(expected);
        end(&once);
    }
    end(&made);
}

/* a plane that a tool remembers stays at its point: with the triangle, or with the child that the point lies in */
static void test_planes_follow(void **unused)
{
    (void)unused;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GRID);
    shape.nx = shape.ny = 8;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&shape, &mesh, NULL), PEL_OK);
    const pel_pose_key key = {0, {0, 0, 5}, {0, 0, 0, 1}, {0}};
    pel_tool_def tool_def = pel_tool_def_default();
    tool_def.name = "far";
    tool_def.radius = 0.1;
    tool_def.keys = &key;
    tool_def.key_count = 1;
    pel_body_def body = ball(mesh, 2);
    pel_sim_def def = pel_sim_def_default();
    def.tools = &tool_def;
    def.tool_count = 1;
    random_state random = {5};
    int followed = 0;
    for (int i = 0; i < 200; i++) {
        pel_model *model = make_model(&body);
        def.model = model;
        pel_sim *sim = make_sim(&def);
        pel_tool *tool = &sim->tools->items[0];
        pel_contact_plane plane = {.triangle = 0};
        /* a triangle at the vertex in the middle, far from the rim: there butterfly keeps the grid */
        int32_t middle = 4 * 9 + 4, t = 0;
        do
            t = (int32_t)random_integer(&random, 0, mesh->triangle_count - 1);
        while (mesh->triangles[t][0] != middle && mesh->triangles[t][1] != middle && mesh->triangles[t][2] != middle);
        double a = random_between(&random, 0, 1), b = random_between(&random, 0, 1), before[3] = {0, 0, 0};
        plane.weights[0] = a + b > 1 ? 1 - a : a;
        plane.weights[1] = a + b > 1 ? 1 - b : b;
        plane.weights[2] = 1 - plane.weights[0] - plane.weights[1];
        plane.triangle = sim->model->triangle_begin[0] + 2 * t;
        for (int c = 0; c < 3; c++)
            pel_vec3_along(before, plane.weights[c], mesh->positions[mesh->triangles[t][c]], before);
        tool->planes[0] = plane;
        tool->plane_count = 1;
        assert_int_equal(pel_sim_refine(sim, 0, middle, 1 + i % 2, NULL), PEL_OK);
        assert_true(tool->plane_count <= 1);
        if (tool->plane_count == 1) {
            double after[3] = {0, 0, 0}, x[3];
            for (int c = 0; c < 3; c++) {
                pel_vertex_position(sim->state->position, sim->model->triangles[tool->planes[0].triangle][c], x);
                pel_vec3_along(after, tool->planes[0].weights[c], x, after);
                assert_true(tool->planes[0].weights[c] >= -1e-12);
            }
            assert_near(pel_vec3_distance(before, after), 0, rounding(1e-14, 1e-6));
            assert_true(tool->planes[0].triangle != plane.triangle);
            followed++;
        }
        pel_sim_destroy(sim);
        pel_model_destroy(model);
    }
    assert_true(followed > 150);
    pel_mesh_destroy(mesh);
}

/* ---- refusals ---- */

static void test_refusals(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(5);
    pel_model_def def = pel_model_def_default();
    def.body_count = 1;
    pel_model *model;
    pel_error error;
    for (int wrong = 0; wrong < 8; wrong++) {
        pel_body_def body = ball(mesh, 2);
        pel_refine_def *r = &body.refine;
        r->above = 1;
        r->below = 0.5;
        if (wrong == 0)
            r->levels = 13;
        else if (wrong == 1)
            r->below = 1;
        else if (wrong == 2)
            r->rings = 4;
        else if (wrong == 3)
            r->interval = 0;
        else if (wrong == 4)
            r->memory_limit = 100000;
        else if (wrong == 5)
            r->dwell = -1;
        else if (wrong == 6)
            r->budget = -1;
        else
            r->above = (double)NAN;
        def.bodies = &body;
        assert_int_equal(pel_model_create(&def, &model, &error), PEL_BAD_ARGUMENT);
        assert_null(model);
        assert_true(error.remedy[0] != '\0');
    }
    pel_body_def body = ball(mesh, 2);
    body.refine.budget = 100;
    bench made = {.mesh = mesh, .model = make_model(&body)};
    pel_sim_def sim = pel_sim_def_default();
    sim.model = made.model;
    assert_int_equal(pel_sim_create(&sim, &made.sim, &error), PEL_BAD_ARGUMENT);
    pel_model_destroy(made.model);
    /* the finest level needs a smaller dt */
    body.refine.budget = 0;
    made.model = make_model(&body);
    sim = explicit_def(0.4);
    sim.model = made.model;
    assert_int_equal(pel_sim_create(&sim, &made.sim, &error), PEL_UNSTABLE);
    pel_model_destroy(made.model);
    body.refine.levels = 0;
    made.model = make_model(&body);
    sim.model = made.model;
    assert_int_equal(pel_sim_create(&sim, &made.sim, &error), PEL_OK);
    assert_int_equal(pel_sim_refine(made.sim, 0, 3, 1, &error), PEL_BAD_ARGUMENT);
    end(&made);
}

static pel_status create_both(const void *mesh, pel_error *error)
{
    pel_body_def body = ball(mesh, 2);
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    pel_model *model;
    pel_status status = pel_model_create(&def, &model, error);
    assert_true((model == NULL) == (status != PEL_OK));
    if (status != PEL_OK)
        return status;
    pel_load_def load = pel_load_def_default();
    pel_sim_def sim_def = pel_sim_def_default();
    sim_def.model = model;
    sim_def.loads = &load;
    sim_def.load_count = 1;
    sim_def.thread_count = 1;
    pel_sim *sim;
    status = pel_sim_create(&sim_def, &sim, error);
    assert_true((sim == NULL) == (status != PEL_OK));
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    return status;
}

static void test_allocations(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(3);
    assert_true(for_every_allocation_failure(create_both, mesh) > 80);
    pel_mesh_destroy(mesh);
    bench made = sliding(0, 1, false);
    failing_malloc_begin(0);
    for (int n = 0; n < 150; n++)
        assert_int_equal(pel_sim_step(made.sim, NULL), PEL_OK);
    allocation_count count = failing_malloc_end();
    assert_true(pel_sim_surface_revision(made.sim, 0) > 3);
    assert_int_equal(count.calls, 0);
    end(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_unrefined_is_plain),
        cmocka_unit_test(test_paper_numbers),

        cmocka_unit_test(test_back_to_base),
        cmocka_unit_test(test_conservation),
        cmocka_unit_test(test_rigid_motion),
        cmocka_unit_test(test_energy_jump),
        cmocka_unit_test(test_stiffness),
        cmocka_unit_test(test_criterion),
        cmocka_unit_test(test_hysteresis),
        cmocka_unit_test(test_budget),
        cmocka_unit_test(test_budget_changes),
        cmocka_unit_test(test_snapshot),
        cmocka_unit_test(test_two_bodies),
        cmocka_unit_test(test_tool_stays_outside),
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_loads_follow),
        cmocka_unit_test(test_planes_follow),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
