/* Where a body refines: curvature, tools, regions, and who wins within a budget. */
#include "adapt/criterion.h"
#include "adapt/refine.h"
#include "pellicle/shape.h"
#include "random.h"
#include "sim/refine_fixture.h"
#include "stage/surface_view.h"
#include "tool/tool.h"

static double present[3 * 20000];
static int32_t levels_of[20000];

/* the finest level that a row within `near` of a point has, and the finest of all others */
static void finest_levels(const bench *made, const double at[3], double near, int32_t *inside, int32_t *outside)
{
    int32_t count = pel_sim_vertex_count(made->sim, 0);
    assert_true(count <= 20000);
    pel_sim_get_rest_positions(made->sim, 0, present);
    pel_sim_get_levels(made->sim, 0, levels_of);
    *inside = *outside = 0;
    for (int32_t r = 0; r < count; r++) {
        double square = 0;
        for (int c = 0; c < 3; c++)
            square += pow(present[3 * r + c] - at[c], 2);
        int32_t *finest = sqrt(square) < near ? inside : outside;
        *finest = levels_of[r] > *finest ? levels_of[r] : *finest;
    }
}

static void assert_valid(const bench *made)
{
    assert_true(pel_front_is_valid(made->sim->model->bodies[0].front));
}

/* ---- curvature ---- */

/* the measure itself on a ball blown up: H goes from 1 to 1 / s, on every level */
static void test_curvature_measure(void **unused)
{
    (void)unused;
    for (int32_t level = 0; level < 3; level++) {
        pel_mesh *mesh = make_sphere(6);
        pel_body_def body = ball(mesh, 2);
        body.refine.curvature_above = 100;
        body.refine.curvature_below = 50;
        pel_sim_def def = pel_sim_def_default();
        bench made = begin(mesh, &body, &def);
        const int32_t v = nearest_vertex(mesh, 0.3, 0.5, 0.8);
        refine(&made, v, level);
        int32_t count = pel_sim_vertex_count(made.sim, 0);
        for (int sign = -1; sign < 2; sign += 2) {
            /* 1.25 times as large, or turned inside out as well: then H becomes -0.8 */
            pel_sim_get_rest_positions(made.sim, 0, present);
            for (int32_t i = 0; i < 3 * count; i++)
                present[i] *= 1.25 * sign;
            assert_int_equal(pel_sim_set_positions(made.sim, 0, present, NULL), PEL_OK);
            int32_t place = pel_output_model_index(made.sim, 0, v);
            pel_verdict verdicts[PEL_WIDTH];
            pel_body_force numbers = pel_body_force_of(made.sim->model, made.sim->state, 0);
            pel_refine_criterion_slice(made.sim, 0, place / PEL_WIDTH, &numbers, verdicts);
            /* H of a vertex differs from that of the ball by some percent on triangles that are not equilateral */
            double change = sign > 0 ? 0.2 : 1.8;
            assert_near(100 * verdicts[place % PEL_WIDTH].strength, change, 0.07 * change);
        }
        end(&made);
    }
}

/* a sheet folded along its middle refines along the fold alone, to the finest level, and not where it was turned */
static void test_fold(void **unused)
{
    (void)unused;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GRID);
    shape.nx = shape.ny = 8;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&shape, &mesh, NULL), PEL_OK);
    int32_t *all = calloc((size_t)mesh->vertex_count, sizeof *all);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        all[v] = v;
    pel_body_def body = ball(mesh, 2);
    body.refine.curvature_above = 1;
    body.refine.curvature_below = 0.5;
    body.refine.rings = 1;
    body.pinned = all;
    body.pinned_count = mesh->vertex_count;
    pel_sim_def def = pel_sim_def_default();
    bench made = begin(mesh, &body, &def);
    run_steps(made.sim, 30);
    assert_int_equal(pel_sim_surface_revision(made.sim, 0), 0);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->positions[v];
        double angle = p[0] > 1e-9 ? 0.8 : 0;
        present[3 * v] = cos(angle) * p[0];
        present[3 * v + 1] = p[1];
        present[3 * v + 2] = sin(angle) * p[0];
    }
    assert_int_equal(pel_sim_set_positions(made.sim, 0, present, NULL), PEL_OK);
    run_steps(made.sim, 40);
    assert_valid(&made);
    assert_true(pel_sim_triangle_count(made.sim, 0) > mesh->triangle_count);
    int32_t count = pel_sim_vertex_count(made.sim, 0), finest = 0;
    pel_sim_get_rest_positions(made.sim, 0, present);
    pel_sim_get_levels(made.sim, 0, levels_of);
    for (int32_t r = 0; r < count; r++) {
        finest = levels_of[r] > finest ? levels_of[r] : finest;
        /* one ring on the base, and the band of bisected triangles behind it */
        if (levels_of[r] > 0)
            assert_true(fabs(present[3 * r]) < 2.01 / 8);
    }
    assert_int_equal(finest, 2);
    /* flat again: all of it goes */
    for (int32_t r = 0; r < count; r++)
        for (int c = 0; c < 3; c++)
            present[3 * r + c] = present[3 * r + c];
    assert_int_equal(pel_sim_set_positions(made.sim, 0, present, NULL), PEL_OK);
    run_steps(made.sim, 200);
    assert_int_equal(pel_sim_triangle_count(made.sim, 0), mesh->triangle_count);
    free(all);
    end(&made);
}

/* ---- tools ---- */

static bench beside_tool(pel_tool_shape shape, double near)
{
    static const pel_pose_key keys[3] = {
        {0, {0, 0, 2}, {0, 0, 0, 1}, {0}}, {1, {0, 0, 1.35}, {0, 0, 0, 1}, {0}}, {2, {0, 0, 3}, {0, 0, 0, 1}, {0}}};
    static pel_tool_def tool;
    tool = pel_tool_def_default();
    tool.name = "probe";
    tool.shape = shape;
    tool.radius = 0.2;
    tool.half_length = 0.05;
    tool.half_extents[0] = tool.half_extents[1] = tool.half_extents[2] = 0.2;
    tool.keys = keys;
    tool.key_count = 3;
    pel_mesh *mesh = make_sphere(6);
    pel_body_def body = ball(mesh, 2);
    body.refine.near_tools = near;
    body.refine.above = near > 0 ? 0 : 1e9;
    body.refine.dwell = 10;
    pel_sim_def def = pel_sim_def_default();
    def.tools = &tool;
    def.tool_count = 1;
    return begin(mesh, &body, &def);
}

/* the box about a tool leaves out no vertex that has triangles near it: beside a look at all */
static void test_box_of_tool(void **unused)
{
    (void)unused;
    const pel_tool_shape shapes[] = {PEL_TOOL_SPHERE, PEL_TOOL_CAPSULE, PEL_TOOL_BOX};
    random_state random = {7};
    int near_count = 0, far_count = 0;
    for (int n = 0; n < 60; n++) {
        bench made = beside_tool(shapes[n % 3], 0.15);
        pel_tool *tool = &made.sim->tools->items[0];
        double turn = random_between(&random, 0, 3);
        tool->pose.rotation[0] = sin(turn / 2);
        tool->pose.rotation[3] = cos(turn / 2);
        for (int i = 0; i < 3; i++)
            tool->pose.position[i] = random_between(&random, -1.2, 1.2);
        pel_refine_criterion_begin(made.sim, 0);
        const pel_real far = (pel_real)HUGE_VAL, all[2][3] = {{-far, -far, -far}, {far, far, far}};
        pel_real box[2][3];
        memcpy(box, tool->look_box, sizeof box);
        for (int32_t slice = 0; slice < made.sim->model->bodies[0].slice_end; slice++) {
            pel_verdict verdicts[PEL_WIDTH], expected[PEL_WIDTH];
            pel_body_force numbers = pel_slice_force_of(made.sim->model, made.sim->state, slice);
            memcpy(tool->look_box, box, sizeof box);
            pel_refine_criterion_slice(made.sim, 0, slice, &numbers, verdicts);
            memcpy(tool->look_box, all, sizeof box);
            pel_refine_criterion_slice(made.sim, 0, slice, &numbers, expected);
            for (int lane = 0; lane < PEL_WIDTH; lane++) {
                assert_true(verdicts[lane].strength == expected[lane].strength);
                assert_true(verdicts[lane].warm == expected[lane].warm);
                near_count += expected[lane].strength > 0;
                far_count += expected[lane].strength == 0;
            }
        }
        end(&made);
    }
    assert_true(near_count > 100 && far_count > near_count);
}

/* a body that refines by force alone is not refined by a tool on it, also if another body left the tool's box */
static void test_tool_without_near(void **unused)
{
    (void)unused;
    bench made = beside_tool(PEL_TOOL_SPHERE, 0);
    pel_tool *tool = &made.sim->tools->items[0];
    const pel_real far = (pel_real)HUGE_VAL, all[2][3] = {{-far, -far, -far}, {far, far, far}};
    pel_vec3_set(tool->pose.position, 0, 0, 1);
    pel_refine_criterion_begin(made.sim, 0);
    memcpy(tool->look_box, all, sizeof all);
    for (int32_t slice = 0; slice < made.sim->model->bodies[0].slice_end; slice++) {
        pel_verdict verdicts[PEL_WIDTH];
        pel_body_force numbers = pel_slice_force_of(made.sim->model, made.sim->state, slice);
        pel_refine_criterion_slice(made.sim, 0, slice, &numbers, verdicts);
        for (int lane = 0; lane < PEL_WIDTH; lane++)
            assert_near(verdicts[lane].strength, 0, 1e-6);
    }
    end(&made);
}

/* refined before it touches, only near it, and coarsened after it has left */
static void test_near_tools(void **unused)
{
    (void)unused;
    const double top[3] = {0, 0, 1};
    for (int shape = PEL_TOOL_SPHERE; shape <= PEL_TOOL_BOX; shape++) {
        bench made = beside_tool((pel_tool_shape)shape, 0.25);
        double below = shape == PEL_TOOL_CAPSULE ? 0.25 : 0.2;
        for (int n = 0; n < 210; n++) {
            run_steps(made.sim, 1);
            pel_tool_reading reading;
            pel_sim_get_tool(made.sim, 0, &reading);
            assert_int_equal(reading.contact_count, 0);
            /* before anything is near nothing happens; two rounds are 20 steps of 6.5 mm */
            double gap = reading.position[2] - below - 1;
            if (n < 100 && gap > 0.25)
                assert_int_equal(pel_sim_surface_revision(made.sim, 0), 0);
            if (n < 100 && gap < 0.25 - 0.14) {
                int32_t inside, outside;
                finest_levels(&made, top, 0.9, &inside, &outside);
                assert_int_equal(inside, 2);
                assert_int_equal(outside, 0);
            }
        }
        assert_valid(&made);
        assert_int_equal(pel_sim_triangle_count(made.sim, 0), made.mesh->triangle_count);
        end(&made);
    }
}

/* a tool that is smaller than a triangle is seen from its middle */
static void test_small_tool(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(2);
    const int32_t *t = mesh->triangles[20];
    pel_pose_key key = {.rotation = {0, 0, 0, 1}};
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < 3; i++)
            key.position[c] += mesh->positions[t[i]][c] / 3 * 1.12;
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "needle";
    tool.radius = 0.02;
    tool.keys = &key;
    tool.key_count = 1;
    pel_body_def body = ball(mesh, 1);
    body.refine.near_tools = 0.12;
    pel_sim_def def = pel_sim_def_default();
    def.tools = &tool;
    def.tool_count = 1;
    bench made = begin(mesh, &body, &def);
    run_steps(made.sim, 12);
    assert_int_equal(made.sim->model->bodies[0].front->shapes[20], PEL_FRONT_RED);
    end(&made);
}

/* ---- regions ---- */

static void test_region(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(6);
    const double top[3] = {0, 0, 1};
    int32_t region[2] = {nearest_vertex(mesh, 0, 0, 1), nearest_vertex(mesh, 0, 0, 1)};
    pel_body_def body = ball(mesh, 3);
    body.refine.region = region;
    body.refine.region_count = 2;
    for (int32_t level = 0; level <= 3; level++) {
        body.refine.region_levels = level;
        pel_sim_def def = pel_sim_def_default();
        bench made = {.mesh = mesh, .model = make_model(&body)};
        def.model = made.model;
        made.sim = make_sim(&def);
        int32_t inside, outside, expected = level == 0 ? 3 : level;
        finest_levels(&made, top, 0.6, &inside, &outside);
        assert_int_equal(inside, expected);
        assert_int_equal(outside, 0);
        assert_valid(&made);
        /* every triangle at the vertex is refined to that level, and stays so */
        run_steps(made.sim, 100);
        const pel_front *front = made.sim->model->bodies[0].front;
        const pel_topology *base = front->forest->levels[0];
        for (int32_t t = 0; t < base->triangle_count; t++) {
            bool at = false;
            for (int c = 0; c < 3; c++)
                at |= base->triangles[t][c] == region[0];
            for (int32_t l = 0; at && l < expected; l++)
                for (int32_t i = 0; i < 1 << (2 * l); i++)
                    assert_int_equal(front->shapes[front->node_begin[l] + (t << (2 * l)) + i], PEL_FRONT_RED);
        }
        /* pel_sim_refine adds to it and leaves it */
        refine(&made, region[0], 1);
        refine(&made, region[0], 0);
        finest_levels(&made, top, 0.6, &inside, &outside);
        assert_int_equal(inside, expected);
        pel_sim_destroy(made.sim);
        pel_model_destroy(made.model);
    }
    pel_mesh_destroy(mesh);
}

/* ---- budget ---- */

/* two places are pressed, the second one later, alike or harder: the surface settles, and is fine where it counts */
static void test_stronger_displaces(void **unused)
{
    (void)unused;
    for (int stronger = 0; stronger < 2; stronger++) {
        pel_mesh *mesh = make_sphere(8);
        pel_body_def body = ball(mesh, 2);
        body.refine.above = 1;
        body.refine.below = 0.5;
        body.refine.rings = 1;
        body.refine.dwell = 1000;
        int32_t places[2] = {nearest_vertex(mesh, 0, 0, 1), nearest_vertex(mesh, 0, 0, -1)};
        pel_load_def loads[2] = {pel_load_def_default(), pel_load_def_default()};
        for (int i = 0; i < 2; i++) {
            loads[i].force[2] = i == 0 ? -0.3 : stronger ? 1.2 : 0.3;
            loads[i].vertices = &places[i];
            loads[i].vertex_count = 1;
            loads[i].from = i;
        }
        pel_sim_def def = pel_sim_def_default();
        def.loads = loads;
        def.load_count = 2;
        /* room for one of them */
        bench made = begin(mesh, &body, &def);
        run_steps(made.sim, 95);
        int32_t one = pel_sim_triangle_count(made.sim, 0);
        assert_true(one > mesh->triangle_count);
        pel_sim_destroy(made.sim);
        pel_model_destroy(made.model);
        body.refine.budget = one + 8;
        made = begin(mesh, &body, &def);
        int32_t top_level = 0, bottom_level = 0, other;
        const double top[3] = {0, 0, 1}, bottom[3] = {0, 0, -1};
        for (int n = 0; n < 400; n++) {
            run_steps(made.sim, 1);
            assert_true(pel_sim_triangle_count(made.sim, 0) <= body.refine.budget);
        }
        int64_t events = pel_sim_surface_revision(made.sim, 0);
        run_steps(made.sim, 300);
        /* settled: nobody takes it from the other */
        assert_int_equal(pel_sim_surface_revision(made.sim, 0), events);
        finest_levels(&made, top, 0.5, &top_level, &other);
        finest_levels(&made, bottom, 0.5, &bottom_level, &other);
        /* equally pressed places keep their refinement, harder pressed ones get it */
        assert_int_equal(stronger ? bottom_level : top_level, 2);
        assert_valid(&made);
        end(&made);
    }
}

typedef struct pushed_ball {
    pel_body_def body;
    pel_load_def loads[3];
    int32_t places[3];
    bench made;
} pushed_ball;

/* a ball that refines by one level where it is pushed outward, by up to three forces, the last one from time `late` */
static void begin_pushed(pushed_ball *b, const double forces[3], double late, double above, int32_t budget)
{
    pel_mesh *mesh = make_sphere(8);
    b->body = ball(mesh, 1);
    b->body.refine.above = above;
    b->body.refine.below = above / 2;
    b->body.refine.rings = 1;
    b->body.refine.dwell = 1000;
    b->body.refine.interval = late > 0 ? 20 : 1;
    b->body.refine.budget = budget;
    for (int i = 0; i < 3; i++) {
        const double axis[3] = {i == 0, i == 1, i == 2};
        b->places[i] = nearest_vertex(mesh, axis[0], axis[1], axis[2]);
        b->loads[i] = pel_load_def_default();
        for (int k = 0; k < 3; k++)
            b->loads[i].force[k] = forces[i] * axis[k];
        b->loads[i].vertices = &b->places[i];
        b->loads[i].vertex_count = 1;
        b->loads[i].from = i < 2 ? 0 : late;
    }
    pel_sim_def def = pel_sim_def_default();
    def.loads = b->loads;
    def.load_count = 3;
    b->made = begin(mesh, &b->body, &def);
}

static bool is_hot(const pushed_ball *b, int place)
{
    return b->made.sim->refine[0].requests[b->places[place]] == PEL_REQUEST_MADE;
}

/* of candidates of one round the strongest gets the room, wherever it stands in the list */
static void test_strongest_first(void **unused)
{
    (void)unused;
    for (int strong = 0; strong < 3; strong++) {
        pushed_ball b;
        double forces[3] = {0.3, 0.3, 0.3};
        forces[strong] = 0.5;
        begin_pushed(&b, forces, 0, 1e-3, 20 * 64 + 40);
        int steps = 0;
        while (b.made.sim->refine[0].hot_count == 0 && steps++ < 10)
            run_steps(b.made.sim, 1);
        for (int i = 0; i < 3; i++)
            assert_int_equal(is_hot(&b, i), i == strong);
        end(&b.made);
    }
}

/* the third force comes at 1 s, when the two others have taken all the room */
static void begin_late(pushed_ball *b, const double forces[3])
{
    const double early[3] = {forces[0], forces[1], 0};
    begin_pushed(b, early, 1, 10, 0);
    run_steps(b->made.sim, 95);
    int32_t both = pel_sim_triangle_count(b->made.sim, 0);
    assert_true(both > 20 * 64);
    end(&b->made);
    begin_pushed(b, forces, 1, 10, both + 8);
    run_steps(b->made.sim, 95);
    assert_true(is_hot(b, 0) && !is_hot(b, 2));
    assert_true(forces[1] == 0 || is_hot(b, 1));
}

/* a late candidate that is more than twice as strong replaces the weakest */
static void test_weakest_goes(void **unused)
{
    (void)unused;
    pushed_ball b;
    begin_late(&b, (const double[3]){0.3, 0.6, 6});
    int steps = 0;
    while (!is_hot(&b, 2) && steps++ < 50)
        run_steps(b.made.sim, 1);
    assert_true(is_hot(&b, 2) && is_hot(&b, 1) && !is_hot(&b, 0));
    end(&b.made);
}

/* a candidate that is stronger, but not twice as strong, has to wait */
static void test_little_stronger_waits(void **unused)
{
    (void)unused;
    pushed_ball b;
    begin_late(&b, (const double[3]){0.3, 0, 0.45});
    run_steps(b.made.sim, 100);
    assert_true(is_hot(&b, 0) && !is_hot(&b, 2));
    end(&b.made);
}

static int32_t vertex_of_valence(const pel_mesh *mesh, int32_t valence)
{
    int32_t *counts = calloc((size_t)mesh->vertex_count, sizeof *counts), found = 0;
    for (int32_t i = 0; i < 3 * mesh->triangle_count; i++)
        counts[mesh->triangles[i / 3][i % 3]]++;
    while (counts[found] != valence)
        found++;
    free(counts);
    return found;
}

/* What is cold and gives its room to a stronger candidate, for which that is not enough, gets it back; its dwell time
   goes on: it leaves as soon as without the candidate, which comes at each look. */
static void test_dwell_of_displaced(void **unused)
{
    (void)unused;
    int leaves[2];
    for (int disturbed = 0; disturbed < 2; disturbed++) {
        pel_mesh *mesh = make_sphere(8);
        /* the triangles of five around a vertex and half of their neighbours, less than those of six */
        int32_t places[2] = {vertex_of_valence(mesh, 5), nearest_vertex(mesh, 0, 0, 1)};
        const double *x = mesh->positions[places[0]];
        if (x[2] > 0)
            places[1] = nearest_vertex(mesh, 0, 0, -1);
        pel_body_def body = ball(mesh, 1);
        body.refine.above = 10;
        body.refine.below = 5;
        body.refine.rings = 1;
        body.refine.dwell = 60;
        body.refine.interval = 20;
        body.refine.budget = mesh->triangle_count + 22;
        pel_load_def loads[2] = {pel_load_def_default(), pel_load_def_default()};
        for (int i = 0; i < 2; i++) {
            loads[i].vertices = &places[i];
            loads[i].vertex_count = 1;
            for (int k = 0; k < 3; k++)
                loads[i].force[k] = (i == 0 ? 0.3 : 3) * mesh->positions[places[i]][k];
        }
        loads[0].until = 1;
        loads[1].from = 1;
        pel_sim_def def = pel_sim_def_default();
        def.loads = loads;
        def.load_count = 1 + disturbed;
        bench made = begin(mesh, &body, &def);
        const uint8_t *requests = made.sim->refine[0].requests;
        run_steps(made.sim, 95);
        assert_int_equal(requests[places[0]], PEL_REQUEST_MADE);
        int steps = 0;
        for (; requests[places[0]] == PEL_REQUEST_MADE && steps < 400; steps++)
            run_steps(made.sim, 1);
        leaves[disturbed] = steps;
        end(&made);
    }
    assert_in_range(leaves[0], 60, 200);
    assert_in_range(leaves[1], 60, leaves[0] + 20);
}

/* ---- time ---- */

/* a ball and a tool that is near it from time `from` to `until`, and touches nothing */
static bench beside_visitor(int32_t interval, double from, double until)
{
    const double step = 0.001;
    pel_mesh *mesh = make_sphere(8);
    pel_pose_key keys[4] = {{from - step, {0, 0, 5}, {0, 0, 0, 1}, {0}},
                            {from, {0, 0, 1.3}, {0, 0, 0, 1}, {0}},
                            {until, {0, 0, 1.3}, {0, 0, 0, 1}, {0}},
                            {until + step, {0, 0, 5}, {0, 0, 0, 1}, {0}}};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "visitor";
    tool.radius = 0.2;
    tool.keys = keys;
    tool.key_count = 4;
    pel_body_def body = ball(mesh, 1);
    body.refine.near_tools = 0.25;
    body.refine.interval = interval;
    body.refine.dwell = 30;
    pel_sim_def def = pel_sim_def_default();
    def.tools = &tool;
    def.tool_count = 1;
    return begin(mesh, &body, &def);
}

/* steps until the number of triangles is another one */
static int steps_until_change(bench *made)
{
    int32_t before = pel_sim_triangle_count(made->sim, 0);
    for (int n = 1; n <= 200; n++) {
        run_steps(made->sim, 1);
        if (pel_sim_triangle_count(made->sim, 0) != before)
            return n;
    }
    return 0;
}

/* the clock of the dwell time starts when it has become cold, however long it was warm */
static void test_dwell(void **unused)
{
    (void)unused;
    bench made = beside_visitor(1, -1, 0.605);
    assert_in_range(steps_until_change(&made), 1, 3);
    run_steps(made.sim, 62 - (int)pel_sim_step_count(made.sim));
    assert_true(pel_sim_triangle_count(made.sim, 0) > made.mesh->triangle_count);
    assert_in_range(steps_until_change(&made), 27, 30);
    end(&made);
}

/* a round takes `interval` steps, in each of which its share of the vertices is looked at */
static void test_interval(void **unused)
{
    (void)unused;
    bench made = beside_visitor(20, -1, 10), brief = beside_visitor(20, 0.055, 0.135);
    run_steps(made.sim, 19);
    run_steps(brief.sim, 19);
    int32_t all = made.sim->refine[0].candidate_count, some = brief.sim->refine[0].candidate_count, waiting = 0;
    assert_true(all >= 10 && some > 0 && some < 3 * all / 4);
    for (int32_t i = 0; i < some; i++)
        waiting += brief.sim->refine[0].strengths[brief.sim->refine[0].candidates[i]] > 1;
    assert_int_equal(waiting, some);
    assert_int_equal(steps_until_change(&made), 1);
    end(&made);
    end(&brief);
}

/* a wide load makes many candidates at once: they come in portions, and all of them come */
static void test_portions(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(20);
    pel_body_def body = ball(mesh, 1);
    body.refine.above = 1e-6;
    body.refine.below = 1e-7;
    pel_load_def load = pel_load_def_default();
    load.force[2] = -5;
    pel_sim_def def = pel_sim_def_default();
    def.loads = &load;
    def.load_count = 1;
    bench made = begin(mesh, &body, &def);
    int32_t before = pel_sim_triangle_count(made.sim, 0), most = 0;
    for (int n = 0; n < 200; n++) {
        run_steps(made.sim, 1);
        int32_t count = pel_sim_triangle_count(made.sim, 0);
        most = count - before > most ? count - before : most;
        before = count;
    }
    assert_int_equal(pel_sim_triangle_count(made.sim, 0), 4 * mesh->triangle_count);
    assert_true(most < 1200);
    end(&made);
}

/* The whole ball is pushed aside and back: a candidate that has to wait for its portion and becomes weak meanwhile is
   not refined. */
static void test_weak_while_waiting(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(20);
    pel_body_def body = ball(mesh, 1);
    body.refine.above = 5e-3;
    body.refine.below = 2.5e-3;
    body.refine.interval = 1;
    pel_load_def loads[2] = {pel_load_def_default(), pel_load_def_default()};
    loads[0].force[2] = -5;
    loads[1].force[2] = 5;
    loads[0].until = loads[1].from = 0.055;
    loads[1].until = 0.115;
    pel_sim_def def = pel_sim_def_default();
    def.loads = loads;
    def.load_count = 2;
    bench made = begin(mesh, &body, &def);
    const pel_refine_body *refine = &made.sim->refine[0];
    uint8_t *before = malloc((size_t)mesh->vertex_count);
    int refined = 0, dropped = 0;
    for (int n = 0; n < 15; n++) {
        memcpy(before, refine->requests, (size_t)mesh->vertex_count);
        run_steps(made.sim, 1);
        for (int32_t v = 0; v < mesh->vertex_count; v++) {
            bool is_new = before[v] != PEL_REQUEST_MADE && refine->requests[v] == PEL_REQUEST_MADE;
            assert_true(!is_new || refine->strengths[v] > 1);
            refined += is_new;
            dropped += before[v] == PEL_REQUEST_WAITING && refine->requests[v] == PEL_REQUEST_NONE;
        }
    }
    assert_true(refined > 0 && dropped > 0);
    free(before);
    end(&made);
}

/* ---- all together, saved and restored ---- */

static bench busy_body(const int32_t *region)
{
    static const pel_pose_key keys[3] = {{0, {-0.8, 0, 1.5}, {0, 0, 0, 1}, {0}},
                                         {0.8, {0, 0, 1.1}, {0, 0, 0, 1}, {0}},
                                         {2, {0.8, 0, 1.2}, {0, 0, 0, 1}, {0}}};
    static pel_tool_def tool;
    tool = pel_tool_def_default();
    tool.name = "probe";
    tool.radius = 0.25;
    tool.keys = keys;
    tool.key_count = 3;
    pel_mesh *mesh = make_sphere(7);
    pel_body_def body = ball(mesh, 2);
    body.refine.above = 3;
    body.refine.below = 1;
    body.refine.curvature_above = 0.8;
    body.refine.curvature_below = 0.4;
    body.refine.near_tools = 0.2;
    body.refine.region = region;
    body.refine.region_count = 1;
    body.refine.region_levels = 1;
    body.refine.dwell = 15;
    body.refine.budget = mesh->triangle_count + 900;
    pel_sim_def def = pel_sim_def_default();
    def.tools = &tool;
    def.tool_count = 1;
    return begin(mesh, &body, &def);
}

static void test_snapshot(void **unused)
{
    (void)unused;
    const int32_t region = 300, other_region = 301;
    bench made = busy_body(&region), fresh = busy_body(&region), other = busy_body(&other_region);
    for (int part = 0; part < 8; part++) {
        run_steps(made.sim, 23);
        assert_valid(&made);
        size_t size = pel_sim_save_size(made.sim);
        unsigned char *bytes = malloc(size);
        pel_sim_save(made.sim, bytes);
        assert_int_equal(pel_sim_load(fresh.sim, bytes, size, NULL), PEL_OK);
        assert_true(pel_sim_hash(made.sim) == pel_sim_hash(fresh.sim));
        /* of another region */
        assert_int_equal(pel_sim_load(other.sim, bytes, size, NULL), PEL_BAD_FORMAT);
        free(bytes);
        run_steps(made.sim, 7);
        run_steps(fresh.sim, 7);
        assert_true(pel_sim_hash(made.sim) == pel_sim_hash(fresh.sim));
        assert_true(pel_sim_triangle_count(made.sim, 0) > made.mesh->triangle_count);
    }
    end(&made);
    end(&fresh);
    end(&other);
}

/* ---- refusals ---- */

static void assert_refused(const pel_body_def *body, const char *what)
{
    pel_model_def def = pel_model_def_default();
    def.bodies = body;
    def.body_count = 1;
    pel_model *model;
    pel_error error;
    assert_int_equal(pel_model_create(&def, &model, &error), PEL_BAD_ARGUMENT);
    assert_null(model);
    if (strstr(error.what, what) == NULL)
        fail_msg("%s", error.what);
    assert_true(error.remedy[0] != '\0');
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(5);
    int32_t region[2] = {3, 252};
    pel_body_def body = ball(mesh, 2);
    body.refine.curvature_above = 1;
    body.refine.curvature_below = 1;
    assert_refused(&body, "curvature_below is 1");
    body.refine.curvature_below = -1;
    assert_refused(&body, "curvature_below is -1");
    body.refine.curvature_above = (double)HUGE_VAL;
    assert_refused(&body, "curvature_above is inf");
    body = ball(mesh, 2);
    body.refine.near_tools = (double)NAN;
    assert_refused(&body, "near_tools is");
    body = ball(mesh, 2);
    body.refine.region = region;
    body.refine.region_count = 2;
    assert_refused(&body, "vertex of the region is 252");
    body.refine.region_count = 1;
    body.refine.region_levels = 3;
    assert_refused(&body, "region_levels is 3");
    body.refine.region_levels = 0;
    body.refine.region = NULL;
    assert_refused(&body, "region_count is 1");
    /* the levels of detail need more memory than allowed: with the number */
    body = ball(mesh, 6);
    body.refine.memory_limit = 1000000;
    assert_refused(&body, "MB");
    /* a region that the budget has no room for */
    body = ball(mesh, 2);
    body.refine.region = region;
    body.refine.region_count = 1;
    body.refine.budget = mesh->triangle_count + 5;
    pel_model *model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    pel_sim *sim;
    pel_error error;
    assert_int_equal(pel_sim_create(&def, &sim, &error), PEL_BAD_ARGUMENT);
    assert_null(sim);
    assert_non_null(strstr(error.what, "the budget is 505"));
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_curvature_measure),
        cmocka_unit_test(test_fold),
        cmocka_unit_test(test_box_of_tool),
        cmocka_unit_test(test_tool_without_near),
        cmocka_unit_test(test_near_tools),
        cmocka_unit_test(test_small_tool),
        cmocka_unit_test(test_region),
        cmocka_unit_test(test_stronger_displaces),
        cmocka_unit_test(test_strongest_first),
        cmocka_unit_test(test_dwell_of_displaced),
        cmocka_unit_test(test_weakest_goes),
        cmocka_unit_test(test_little_stronger_waits),
        cmocka_unit_test(test_dwell),
        cmocka_unit_test(test_interval),
        cmocka_unit_test(test_portions),
        cmocka_unit_test(test_weak_while_waiting),
        cmocka_unit_test(test_snapshot),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
