/* Balls that collide as spheres: impacts and searches against brute force, and whole simulations against closed forms.
 */
#include "../rigid/rigid_scene.h"
#include "contact/set.h"
#include "failing_malloc.h"
#include "math/extremes.h"
#include "pellicle/sim_contact.h"
#include "pellicle/sim_reading.h"
#include "random.h"
#include "stage/stage.h"

#define GRAVITY 9.81
#define PI 3.14159265358979323846
/* relative; positions of the preset `single` have 7 digits */
#define TIGHT (sizeof(pel_real) == sizeof(double) ? 1e-9 : 1e-4)
/* of an overlap, as share of the radius */
#define ROUNDING (sizeof(pel_real) == sizeof(double) ? 1e-12 : 1e-6)

static pel_body_def *add_ball(rigid_scene *scene, double radius, int frequency, double x, double y, double z)
{
    pel_body_def *body = rigid_scene_add(scene, make_ball(radius, frequency, x, y, z), 2500);
    body->rigid.sphere = true;
    return body;
}

/* ---- impacts and searches ---- */

enum { MANY = 20 };

/* balls, a box of triangles among them, and their middles and corners at random places at both ends of a step */
static void make_cloud(rigid_scene *scene, random_state *random)
{
    static const double center[3] = {0, 0, 0};
    rigid_scene_begin(scene);
    rigid_scene_add(scene, make_box(0.1, 0.1, 0.1, center), 1000);
    for (int i = 1; i < MANY; i++)
        add_ball(scene, 0.01 + 0.002 * i, 1, i, 0, 0);
    rigid_scene_make(scene);
    pel_contact_set *set = scene->sim->contacts;
    for (int32_t p = 0; p < set->point_count; p++)
        for (int k = 0; k < 3; k++) {
            set->start[p][k] = random_between(random, -0.2, 0.2);
            set->end[p][k] = set->start[p][k] + random_between(random, -0.1, 0.1);
        }
    for (int32_t i = 0; i < set->def.rigids->count; i++)
        set->def.rigids->items[i].path_count = 0;
}

/* m, between the surfaces of a pair after a share of the straight way */
static double gap_at(const pel_contact_set *set, const int32_t points[4], double share)
{
    double x[4][3], w[3], radius = pel_contact_pair_radius(set, points);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            x[i][k] = set->start[points[i]][k] + share * (set->end[points[i]][k] - set->start[points[i]][k]);
    double distance = pel_contact_are_balls(points) ? pel_vec3_distance(x[0], x[1])
                                                    : sqrt(pel_closest_point_triangle(x[0], x[1], x[2], x[3], w));
    return distance - radius;
}

/* first of many shares at which a pair is nearer than a distance, above 1 = none is */
static double first_share(const pel_contact_set *set, const int32_t points[4], double distance)
{
    enum { SAMPLES = 2000 };
    for (int i = 0; i <= SAMPLES; i++)
        if (gap_at(set, points, (double)i / SAMPLES) <= distance)
            return (double)i / SAMPLES;
    return 2;
}

static void check_impact(const pel_contact_set *set, const int32_t points[4], int counts[2])
{
    pel_collision pair = {.first = points[0], .vertices = {points[0], points[1], points[2], points[3]}};
    const double guarded = 1e-3;
    double gap = gap_at(set, points, 0), reach = gap < guarded ? 0.99 * gap : guarded;
    if (gap < 0.02 * guarded)
        return;
    pel_timed_hit impact = pel_contact_ball_impact(set, &pair, guarded);
    double first = first_share(set, points, reach);
    if (first > 1) {
        /* between two samples a pair may come a little nearer */
        assert_true(impact.hit.time_of_impact > 1 ||
                    gap_at(set, points, impact.hit.time_of_impact) < reach * (1 + 1e-2));
        counts[0]++;
        return;
    }
    assert_true(impact.hit.time_of_impact <= first + 1e-9);
    assert_near(gap_at(set, points, impact.hit.time_of_impact), reach, 2e-3 * reach);
    double along = 0, sum = 0;
    for (int i = 0; i < 4; i++) {
        sum += impact.hit.weight[i];
        for (int k = 0; k < 3; k++)
            along += impact.hit.weight[i] * impact.hit.normal[k] *
                     (set->start[points[i]][k] +
                      impact.hit.time_of_impact * (set->end[points[i]][k] - set->start[points[i]][k]));
    }
    assert_near(sum, 0, 1e-12);
    assert_near(along - pel_contact_pair_radius(set, points), reach, 2e-3 * reach);
    counts[1]++;
}

static void test_impacts(void **state)
{
    (void)state;
    random_state random = {3};
    int counts[2] = {0};
    for (int round = 0; round < 10; round++) {
        rigid_scene scene;
        make_cloud(&scene, &random);
        const pel_contact_set *set = scene.sim->contacts;
        for (int32_t i = 0; i < set->ball_count; i++) {
            int32_t c = set->balls[i].point;
            for (int32_t j = i + 1; j < set->ball_count; j++) {
                int32_t other = set->balls[j].point;
                check_impact(set, (const int32_t[4]){c, other, other, other}, counts);
            }
            for (int32_t t = 0; t < set->triangle_count; t++) {
                const int32_t *v = set->triangles[t];
                check_impact(set, (const int32_t[4]){c, v[0], v[1], v[2]}, counts);
            }
        }
        rigid_scene_end(&scene);
    }
    assert_true(counts[0] > 100 && counts[1] > 100);
}

static bool is_found(const pel_collision_result *found, int32_t first, int32_t second)
{
    bool any = false;
    for (int64_t i = 0; i < found->collision_count; i++)
        any |= !found->collisions[i].edge_edge && found->collisions[i].first == first &&
               found->collisions[i].second == second;
    return any;
}

/* nothing that comes within the distance is missing, and pairs are in order among those of the collider */
static void test_search(void **state)
{
    (void)state;
    random_state random = {4};
    int near = 0;
    for (int round = 0; round < 20; round++) {
        rigid_scene scene;
        make_cloud(&scene, &random);
        pel_contact_set *set = scene.sim->contacts;
        const double distance = 5e-3;
        const pel_collision others[3] = {{.first = 2, .second = 3}, {.first = 90, .second = 0}, {.edge_edge = true}};
        pel_collision_result found = {.collisions = others, .collision_count = 3};
        assert_int_equal(pel_contact_balls_join(set, distance, false, &found, NULL), PEL_OK);
        for (int64_t i = 1; i < found.collision_count; i++) {
            const pel_collision *a = &found.collisions[i - 1], *b = &found.collisions[i];
            assert_true(a->edge_edge < b->edge_edge || a->first < b->first ||
                        (a->first == b->first && a->second < b->second));
        }
        assert_true(is_found(&found, 2, 3) && is_found(&found, 90, 0));
        assert_true(found.collisions[found.collision_count - 1].edge_edge);
        for (int32_t i = 0; i < set->ball_count; i++) {
            int32_t c = set->balls[i].point;
            for (int32_t j = 0; j < set->triangle_count + set->ball_count; j++) {
                int32_t other = j < set->triangle_count ? 0 : pel_contact_ball_point(set, j);
                const int32_t *v = j < set->triangle_count ? set->triangles[j] : (const int32_t[]){other, other, other};
                const int32_t points[4] = {c, v[0], v[1], v[2]};
                if (j >= set->triangle_count && j - set->triangle_count <= i)
                    continue;
                if (first_share(set, points, distance) > 1)
                    continue;
                assert_true(is_found(&found, c, j));
                near++;
            }
        }
        rigid_scene_end(&scene);
    }
    assert_true(near > 100);
}

/* m, between a ball and a sphere or capsule after a share of the straight way */
static double round_gap(const pel_contact_set *set, const pel_contact_ball *ball, const pel_obstacle *obstacle,
                        double share)
{
    double x[3], ends[2][3], w[4];
    for (int k = 0; k < 3; k++)
        x[k] = set->start[ball->point][k] + share * (set->end[ball->point][k] - set->start[ball->point][k]);
    for (int i = 0; i < 2; i++) {
        double half = obstacle->solid.shape == PEL_TOOL_CAPSULE ? obstacle->solid.half_length : 0, to[3];
        const double local[3] = {0, 0, i == 0 ? -half : half};
        pel_pose_to_world(&obstacle->before, local, ends[i]);
        pel_pose_to_world(&obstacle->pose, local, to);
        for (int k = 0; k < 3; k++)
            ends[i][k] += share * (to[k] - ends[i][k]);
    }
    return sqrt(pel_closest_segment_segment(x, x, ends[0], ends[1], w)) - ball->radius - obstacle->solid.radius;
}

/* conflicts of balls with moving spheres and capsules against samples of the way */
static void test_round(void **state)
{
    (void)state;
    random_state random = {6};
    int counts[2] = {0};
    for (int round = 0; round < 300; round++) {
        rigid_scene scene;
        rigid_scene_begin(&scene);
        add_ball(&scene, 0.02, 1, 0, 0, 1);
        for (int i = 0; i < 2; i++) {
            rigid_scene_floor(&scene, 0);
            scene.tools[i].shape = i == 0 ? PEL_TOOL_SPHERE : PEL_TOOL_CAPSULE;
            scene.tools[i].name = i == 0 ? "sphere" : "capsule";
            scene.tools[i].radius = 0.015;
            scene.tools[i].half_length = 0.03;
        }
        rigid_scene_make(&scene);
        pel_contact_set *set = scene.sim->contacts;
        const pel_contact_ball *ball = &set->balls[0];
        set->def.rigids->items[0].path_count = 0;
        bool found[2] = {false, false};
        for (int k = 0; k < 3; k++) {
            set->start[ball->point][k] = random_between(&random, -0.06, 0.06);
            set->end[ball->point][k] = set->start[ball->point][k] + random_between(&random, -0.1, 0.1);
            for (int i = 0; i < 2; i++) {
                set->obstacles[i].before.position[k] = random_between(&random, -0.06, 0.06);
                set->obstacles[i].pose.position[k] =
                    set->obstacles[i].before.position[k] + random_between(&random, -0.1, 0.1);
            }
        }
        set->conflict_count = 0;
        assert_int_equal(pel_contact_ball_conflicts(set, NULL), PEL_OK);
        for (size_t c = 0; c < set->conflict_count; c++) {
            const pel_conflict *conflict = &set->conflicts[c];
            found[conflict->obstacle] = true;
            if (conflict->time > 0)
                assert_near(round_gap(set, ball, &set->obstacles[conflict->obstacle], conflict->time), set->guarded,
                            0.02 * set->guarded);
        }
        for (int i = 0; i < 2; i++) {
            double least = HUGE_VAL;
            for (int n = 0; n <= 1000; n++)
                least = pel_min(least, round_gap(set, ball, &set->obstacles[i], n / 1000.0));
            if (!(round_gap(set, ball, &set->obstacles[i], 0) > 2 * set->guarded) || fabs(least - set->guarded) < 1e-5)
                continue;
            assert_int_equal(found[i], least < set->guarded);
            counts[found[i]]++;
        }
        rigid_scene_end(&scene);
    }
    assert_true(counts[0] > 20 && counts[1] > 20);
}

/* ---- motion ---- */

static void test_shape(void **state)
{
    (void)state;
    rigid_scene scene;
    const double r = 0.05, full = 2500 * 4 * PI / 3 * r * r * r, hollow = 2500 * 4 * PI * r * r * 1e-3;
    rigid_scene_begin(&scene);
    scene.def.contact.enabled = false;
    pel_vec3_set(add_ball(&scene, r, 2, 0.3, 0.1, 7)->angular_velocity, 0, 0, 2);
    pel_body_def *shell = add_ball(&scene, r, 2, 0, 0, 0);
    pel_vec3_set(shell->angular_velocity, 0, 2, 0);
    shell->rigid.thickness = 1e-3;
    rigid_scene_make(&scene);
    pel_rigid_reading a = rigid_scene_read(&scene, 0), b = rigid_scene_read(&scene, 1);
    assert_near(a.mass / full, 1, TIGHT);
    assert_near(b.mass / hollow, 1, TIGHT);
    assert_near(a.center[2], 7, TIGHT);
    assert_near(a.angular_momentum[2] / (0.4 * full * r * r * 2), 1, TIGHT);
    assert_near(b.angular_momentum[1] / (2.0 / 3 * hollow * r * r * 2), 1, TIGHT);
    rigid_scene_end(&scene);
}

/* oblique, spinning, with and without friction and restitution: momenta stay, and energy does not grow */
static void test_collision(void **state)
{
    (void)state;
    static const double frictions[3] = {0, 0.4, 0.3}, restitutions[3] = {0, 0, 0.6};
    for (int i = 0; i < 3; i++)
        for (int method = 0; method < 2; method++) {
            rigid_scene scene;
            double before[2][3], after[2][3];
            rigid_scene_begin(&scene);
            scene.def.solver.method = method == 0 ? PEL_METHOD_XPBD : PEL_METHOD_EXPLICIT;
            scene.def.solver.dt = method == 0 ? 5e-3 : 5e-4;
            scene.def.contact.friction = frictions[i];
            scene.def.contact.restitution = restitutions[i];
            pel_body_def *a = add_ball(&scene, 0.01, 2, 0, 0, 0);
            pel_body_def *b = add_ball(&scene, 0.012, 4, 0.03, 0.008, 0.002);
            pel_vec3_set(a->velocity, 1, 0, 0);
            pel_vec3_set(a->angular_velocity, 0, 5, 20);
            pel_vec3_set(b->velocity, -0.5, 0.1, 0);
            pel_vec3_set(b->angular_velocity, 3, 0, -10);
            rigid_scene_make(&scene);
            rigid_scene_momenta(&scene, before[0], before[1]);
            double energy = rigid_scene_read(&scene, 0).kinetic_energy + rigid_scene_read(&scene, 1).kinetic_energy;
            double spin = rigid_scene_read(&scene, 0).spin[2];
            rigid_scene_run(&scene, 0.1);
            rigid_scene_momenta(&scene, after[0], after[1]);
            for (int k = 0; k < 2; k++)
                assert_true(pel_vec3_distance(before[k], after[k]) < TIGHT * pel_vec3_length(before[k]));
            double left = rigid_scene_read(&scene, 0).kinetic_energy + rigid_scene_read(&scene, 1).kinetic_energy;
            assert_true(left < 0.9 * energy);
            /* only friction turns a ball, but for a torque of half of the sliding way of a substep times the load */
            assert_int_equal(fabs(rigid_scene_read(&scene, 0).spin[2] - spin) < 0.3 * spin, frictions[i] == 0);
            rigid_scene_end(&scene);
        }
}

/* rolls with 5/7 g sin a over a tool, a rigid body of few triangles and its own kind of mesh, however coarse it is */
static void test_roll(void **state)
{
    (void)state;
    static const double half[3] = {0, 0, -0.05}, axis[3] = {0, 1, 0};
    const double angle = 0.2, r = 0.05;
    for (int i = 0; i < 2; i++) {
        rigid_scene scene;
        static const int32_t pins[3] = {0, 1, 2};
        rigid_scene_begin(&scene);
        scene.gravity = -GRAVITY;
        scene.def.contact.friction = 0.8;
        add_ball(&scene, r, 2, (r + 5e-5) * sin(angle), 0, (r + 5e-5) * cos(angle));
        if (i == 0)
            rigid_scene_floor(&scene, angle);
        else {
            pel_mesh *slab = make_box(3, 3, 0.1, half);
            turn_mesh(slab, axis, angle * 180 / PI);
            pel_body_def *body = rigid_scene_add(&scene, slab, 1000);
            body->pinned = pins;
            body->pinned_count = 3;
        }
        rigid_scene_make(&scene);
        rigid_scene_run(&scene, 0.2);
        double early = pel_vec3_length(rigid_scene_read(&scene, 0).velocity);
        rigid_scene_run(&scene, 0.6);
        pel_rigid_reading end = rigid_scene_read(&scene, 0);
        double speed = pel_vec3_length(end.velocity);
        assert_near((speed - early) / (5.0 / 7 * GRAVITY * sin(angle) * 0.4), 1, 2e-3);
        assert_near(end.spin[1] * r / speed, 1, 2e-3);
        rigid_scene_end(&scene);
    }
}

/* A heap in a corner: no balls overlap after any step, none goes into the floor, the floor carries them, and no energy
   appears. */
static void make_heap(rigid_scene *scene)
{
    random_state random = {8};
    rigid_scene_begin(scene);
    scene->gravity = -GRAVITY;
    scene->def.contact.friction = 0.3;
    scene->def.solver.dt = 1.0 / 60;
    scene->def.contact.sleep = false;
    for (int i = 0; i < 18; i++)
        add_ball(scene, 0.008 + 0.0002 * i, 2, 0.024 * (i % 3) + random_between(&random, 0, 1e-3),
                 0.024 * (i / 3 % 2) + random_between(&random, 0, 1e-3), 0.02 + 0.025 * (i / 6));
    rigid_scene_floor(scene, 0);
    for (int i = 0; i < 2; i++) {
        rigid_scene_floor(scene, 0);
        pel_vec3_set(scene->keys[1 + i].position, i == 0 ? -0.065 : 0, i == 0 ? 0 : -0.065, 0);
        pel_vec3_set(scene->tools[1 + i].half_extents, i == 0 ? 0.05 : 1, i == 0 ? 1 : 0.05, 1);
        scene->tools[1 + i].name = i == 0 ? "left" : "front";
    }
}

static void test_heap(void **state)
{
    (void)state;
    rigid_scene scene;
    make_heap(&scene);
    rigid_scene_make(&scene);
    double weight = 0;
    for (int step = 0; step < 90; step++) {
        assert_int_equal(pel_sim_step(scene.sim, NULL), PEL_OK);
        weight = 0;
        for (int32_t i = 0; i < scene.body_count; i++) {
            pel_rigid_reading a = rigid_scene_read(&scene, i);
            double radius = 0.008 + 0.0002 * i;
            weight += GRAVITY * a.mass;
            assert_true(a.center[2] > radius * (1 - ROUNDING));
            for (int32_t j = 0; j < i; j++)
                assert_true(pel_vec3_distance(a.center, rigid_scene_read(&scene, j).center) >
                            (radius + 0.008 + 0.0002 * j) * (1 - ROUNDING));
        }
    }
    pel_sim_ledger ledger;
    pel_contact_statistics statistics;
    pel_sim_get_ledger(scene.sim, &ledger);
    pel_sim_get_contact_statistics(scene.sim, &statistics);
    assert_near(ledger.energy_error, 0, 1e-9);
    assert_int_equal(statistics.fall_backs, 0);
    double carried = 0;
    for (int32_t t = 0; t < 3; t++) {
        pel_tool_reading reading;
        pel_sim_get_tool(scene.sim, t, &reading);
        carried -= reading.force[2];
    }
    assert_near(carried / weight, 1, 0.02);
    rigid_scene_end(&scene);
}

/* Thrown at each shape of tool so fast that a step takes it to the other side: it stays on its own. */
static void test_tools(void **state)
{
    (void)state;
    static const pel_tool_shape shapes[3] = {PEL_TOOL_SPHERE, PEL_TOOL_CAPSULE, PEL_TOOL_BOX};
    for (int i = 0; i < 3; i++) {
        rigid_scene scene;
        rigid_scene_begin(&scene);
        scene.def.solver.substeps = 4;
        pel_vec3_set(add_ball(&scene, 0.01, 2, -0.06, 0.004, 0.002)->velocity, 12, 0, 0);
        rigid_scene_floor(&scene, 0);
        pel_tool_def *tool = &scene.tools[0];
        tool->shape = shapes[i];
        tool->radius = 0.02;
        tool->half_length = 0.03;
        pel_vec3_set(tool->half_extents, 0.02, 0.02, 0.02);
        pel_vec3_set(scene.keys[0].position, 0, 0, 0);
        rigid_scene_make(&scene);
        for (int step = 0; step < 6; step++) {
            assert_int_equal(pel_sim_step(scene.sim, NULL), PEL_OK);
            pel_rigid_reading ball = rigid_scene_read(&scene, 0);
            double way = i == 2 ? pel_max(fabs(ball.center[0]), fabs(ball.center[1]))
                                : sqrt(ball.center[0] * ball.center[0] + ball.center[1] * ball.center[1]);
            assert_true(way > 0.03 * (1 - ROUNDING) || fabs(ball.center[2]) > 0.02);
            assert_true(ball.center[0] < 0 || fabs(ball.center[1]) > 0.0299);
        }
        rigid_scene_end(&scene);
    }
}

/* the same bits for any number of threads, and from a snapshot on */
static void test_bits(void **state)
{
    (void)state;
    rigid_scene scenes[3];
    for (int i = 0; i < 3; i++) {
        make_heap(&scenes[i]);
        scenes[i].def.thread_count = i == 1 ? 4 : 1;
        rigid_scene_make(&scenes[i]);
    }
    rigid_scene_run(&scenes[0], 0.3);
    rigid_scene_run(&scenes[1], 0.3);
    assert_true(pel_sim_hash(scenes[0].sim) == pel_sim_hash(scenes[1].sim));
    size_t size = pel_sim_save_size(scenes[0].sim);
    void *bytes = malloc(size);
    pel_sim_save(scenes[0].sim, bytes);
    assert_int_equal(pel_sim_load(scenes[2].sim, bytes, size, NULL), PEL_OK);
    free(bytes);
    rigid_scene_run(&scenes[0], 0.6);
    rigid_scene_run(&scenes[2], 0.6);
    assert_true(pel_sim_hash(scenes[0].sim) == pel_sim_hash(scenes[2].sim));
    for (int i = 0; i < 3; i++)
        rigid_scene_end(&scenes[i]);
}

static void refuse(pel_mesh *mesh, pel_method method, const char *what)
{
    rigid_scene scene;
    pel_error error = {0};
    rigid_scene_begin(&scene);
    scene.def.solver.method = method;
    rigid_scene_add(&scene, mesh, 1000)->rigid.sphere = true;
    assert_int_equal(rigid_scene_try(&scene, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, what));
    assert_non_null(strstr(error.remedy, "leave rigid.sphere out"));
    rigid_scene_end(&scene);
}

static void test_refusals(void **state)
{
    (void)state;
    static const double origin[3] = {0};
    refuse(make_box(0.1, 0.1, 0.1, origin), PEL_METHOD_XPBD, "fills 0.37 of the sphere");
    pel_mesh *dented = make_ball(0.1, 3, 0, 0, 0);
    pel_vec3_scale(dented->positions[5], 0.99, dented->positions[5]);
    refuse(dented, PEL_METHOD_XPBD, "vertices up to 0.00");
    refuse(make_ball(0.1, 3, 0, 0, 0), PEL_METHOD_IMPLICIT, "is a rigid sphere, which this method does not know");
    refuse(make_ball(0.1, 3, 0, 0, 0), PEL_METHOD_STATIC, "is a rigid sphere, which this method does not know");
}

/* Spheres that overlap at the start are refused, whatever their meshes do; meshes that touch are not, though their
   spheres overlap a little, and part. */
static void test_start(void **state)
{
    (void)state;
    static const double center[3] = {0, 0, 0};
    for (int i = 0; i < 4; i++) {
        rigid_scene scene;
        pel_error error = {0};
        rigid_scene_begin(&scene);
        add_ball(&scene, 0.05, 6, 0, 0, 0.05 + (i < 2 ? 0.045 : 0.0999));
        if (i % 2 == 0)
            add_ball(&scene, 0.05, 6, 0, 0, 0);
        else
            rigid_scene_add(&scene, make_box(0.1, 0.1, i == 1 ? 0.1 : 0.1999, center), 1000);
        pel_status status = rigid_scene_try(&scene, &error);
        assert_int_equal(status, i < 2 ? PEL_BAD_ARGUMENT : PEL_OK);
        if (i < 2)
            assert_string_equal(error.what, "the sphere of body 'b0' overlaps body 'b1' by 0.005 m at the start");
        rigid_scene_end(&scene);
    }
}

/* two balls that touch, after a step */
static pel_status step_two(const void *meshes, pel_error *error)
{
    pel_mesh *const *given = meshes;
    pel_body_def bodies[2];
    pel_model_def model_def = pel_model_def_default();
    pel_sim_def def = pel_sim_def_default();
    pel_model *model;
    pel_sim *sim = NULL;
    for (int i = 0; i < 2; i++) {
        bodies[i] = pel_body_def_default();
        bodies[i].name = i == 0 ? "a" : "b";
        bodies[i].mesh = given[i];
        bodies[i].rigid.on = bodies[i].rigid.sphere = true;
    }
    model_def.bodies = bodies;
    model_def.body_count = 2;
    pel_status status = pel_model_create(&model_def, &model, error);
    def.solver.method = PEL_METHOD_XPBD;
    def.contact.enabled = true;
    def.model = model;
    if (status == PEL_OK)
        status = pel_sim_create(&def, &sim, error);
    if (status == PEL_OK)
        status = pel_sim_step(sim, error);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    return status;
}

static void test_memory(void **state)
{
    (void)state;
    pel_mesh *meshes[2] = {make_ball(0.01, 1, 0, 0, 0), make_ball(0.01, 1, 0.02001, 0, 0)};
    assert_true(for_allocation_failures(step_two, meshes, 1) > 0);
    for (int i = 0; i < 2; i++)
        pel_mesh_destroy(meshes[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_impacts),  cmocka_unit_test(test_search),    cmocka_unit_test(test_round),
        cmocka_unit_test(test_shape),    cmocka_unit_test(test_collision), cmocka_unit_test(test_roll),
        cmocka_unit_test(test_heap),     cmocka_unit_test(test_tools),     cmocka_unit_test(test_bits),
        cmocka_unit_test(test_refusals), cmocka_unit_test(test_memory),    cmocka_unit_test(test_start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
