/* The set of contacts over arrays alone: its pairs against all pairs, its effects against closed forms. */
#include "base/memory.h"
#include "failing_malloc.h"
#include "set_fixture.h"
#include "sweep/sweep.h"

/* ---- pairs ---- */

static void position(const arrays *a, int32_t v, double x[3])
{
    pel_vertex_position(a->rest, v, x);
}

static bool share_vertex(const int32_t *a, int a_count, const int32_t *b, int b_count)
{
    for (int i = 0; i < a_count; i++)
        for (int k = 0; k < b_count; k++)
            if (a[i] == b[k])
                return true;
    return false;
}

static int32_t list_edges(const arrays *a, int32_t edges[MOST_EDGES][2])
{
    int32_t count = 0;
    for (int32_t t = 0; t < a->triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            int32_t p = a->triangles[t][i], q = a->triangles[t][(i + 1) % 3];
            int32_t low = p < q ? p : q, high = p < q ? q : p, e = 0;
            while (e < count && !(edges[e][0] == low && edges[e][1] == high))
                e++;
            if (e == count) {
                edges[count][0] = low;
                edges[count++][1] = high;
            }
        }
    return count;
}

/* whether the list has a contact with these points, each side in any order */
static bool has_contact(const pel_contact_set *set, const int32_t *a, int a_count, const int32_t *b, int b_count)
{
    for (int32_t c = 0; c < set->list.count; c++) {
        const int32_t *points = set->keys[c].points;
        int found[2] = {0, 0};
        if (set->keys[c].edge_edge != (a_count == 2))
            continue;
        for (int side = 0; side < 2; side++) {
            const int32_t *first = side == 0 ? points : points + a_count,
                          *second = side == 0 ? points + a_count : points;
            if (a_count == 1 && side == 1)
                break;
            for (int i = 0; i < a_count; i++)
                found[side] += share_vertex(a + i, 1, first, a_count);
            for (int i = 0; i < b_count; i++)
                found[side] += share_vertex(b + i, 1, second, b_count);
        }
        if (found[0] == 4 || found[1] == 4)
            return true;
    }
    return false;
}

/* Every pair nearer than `near` is in the list, none beyond `far`; returns how many are near. */
static int32_t check_pairs(const arrays *a, const pel_contact_set *set, double near, double far)
{
    static int32_t edges[MOST_EDGES][2];
    int32_t edge_count = list_edges(a, edges), count = 0, unsure = 0;
    double x[4][3], weights[4];
    for (int32_t t = 0; t < a->triangle_count; t++)
        for (int32_t v = 0; v < a->vertex_count; v++) {
            const int32_t *corners = a->triangles[t];
            if (!(a->mass[v] > 0) || share_vertex(&v, 1, corners, 3))
                continue;
            position(a, v, x[0]);
            for (int i = 0; i < 3; i++)
                position(a, corners[i], x[i + 1]);
            double distance = sqrt(pel_closest_point_triangle(x[0], x[1], x[2], x[3], weights));
            count += distance < near;
            unsure += distance >= near && distance <= far;
            if (distance < near || distance > far)
                assert_int_equal(has_contact(set, &v, 1, corners, 3), distance < near);
        }
    for (int32_t e = 0; e < edge_count; e++)
        for (int32_t f = 0; f < e; f++) {
            if (share_vertex(edges[e], 2, edges[f], 2))
                continue;
            for (int i = 0; i < 2; i++) {
                position(a, edges[e][i], x[i]);
                position(a, edges[f][i], x[i + 2]);
            }
            double distance = sqrt(pel_closest_segment_segment(x[0], x[1], x[2], x[3], weights));
            count += distance < near;
            unsure += distance >= near && distance <= far;
            if (distance < near || distance > far)
                assert_int_equal(has_contact(set, edges[e], 2, edges[f], 2), distance < near);
        }
    assert_true(set->list.count >= count && set->list.count <= count + unsure);
    return count;
}

/* noisy sheets at rest: contacts are the pairs of features that are near, by all pairs */
static void test_pairs(void **unused)
{
    (void)unused;
    random_state random = {3};
    int32_t most = 0;
    for (int round = 0; round < ROUNDS(6, 1); round++) {
        static arrays a;
        a = (arrays){0};
        add_sheet(&a, 7, 0, 0.01, &random);
        add_sheet(&a, 6, 0.025, 0.01, &random);
        pel_contact_set *set = create(&a);
        assert_int_equal(pel_contact_set_find(set, 0, 0.01, NULL), PEL_OK);
        /* half more than the thickness, and the tolerance of the search */
        int32_t count = check_pairs(&a, set, 1.5 * THICKNESS, 1.5 * THICKNESS + 0.02 * THICKNESS);
        most = count > most ? count : most;
        pel_contact_set_destroy(set);
    }
    assert_true(most > 50);
}

/* points anywhere within `way` of a place */
static void shake(const double (*about)[3], int32_t count, double way, random_state *random, double (*x)[3])
{
    for (int32_t p = 0; p < count; p++) {
        double step[3];
        for (int k = 0; k < 3; k++)
            step[k] = random_between(random, -1, 1);
        pel_vec3_along(about[p], way / pel_vec3_length(step), step, x[p]);
    }
}

/* every vertex nearer to a triangle than the thickness has a pair with that or one beside it, or a corner has one with
   a triangle of the vertex; returns how many */
static int32_t check_listed(const arrays *a, const pel_contact_set *set)
{
    int32_t count = 0;
    for (int32_t t = 0; t < a->triangle_count; t++)
        for (int32_t v = 0; v < a->vertex_count; v++) {
            double x[4][3], weights[4];
            const int32_t *corners = a->triangles[t];
            bool is_listed = false;
            if (!(a->mass[v] > 0) || share_vertex(&v, 1, corners, 3))
                continue;
            position(a, v, x[0]);
            for (int i = 0; i < 3; i++)
                position(a, corners[i], x[i + 1]);
            if (!(pel_closest_point_triangle(x[0], x[1], x[2], x[3], weights) < THICKNESS * THICKNESS))
                continue;
            for (int32_t c = 0; c < set->list.count && !is_listed; c++) {
                const int32_t *points = set->keys[c].points;
                bool is_own = points[0] == v && share_vertex(points + 1, 3, corners, 3);
                bool is_mirrored = share_vertex(points, 1, corners, 3) && share_vertex(points + 1, 3, &v, 1);
                is_listed = !set->keys[c].edge_edge && (is_own || is_mirrored);
            }
            assert_true(is_listed);
            count++;
        }
    return count;
}

/* While all is near the home of a search with layers, its list has all pairs that touch; loads and slacks stay with
   their pairs. */
static void test_serves(void **unused)
{
    (void)unused;
    random_state random = {5};
    static arrays a;
    a = (arrays){0};
    add_sheet(&a, 7, 0, 0.01, &random);
    add_sheet(&a, 6, 0.025, 0.01, &random);
    a.has_layers = true;
    pel_contact_set *set = create(&a);
    assert_false(pel_contact_set_serves(set));
    assert_int_equal(pel_contact_set_find(set, 0, 0.01, NULL), PEL_OK);
    assert_true(pel_contact_set_serves(set));
    int32_t near = 0, first = set->list.count;
    set->keys[3].load = 7;
    const pel_contact_key loaded = set->keys[3];
    for (int round = 0; round < ROUNDS(20, 5); round++) {
        shake((const double(*)[3])set->home, set->vertex_count, 0.019 * THICKNESS, &random, set->start);
        memcpy(set->end, set->start, (size_t)set->vertex_count * sizeof *set->end);
        for (int32_t v = 0; v < a.vertex_count; v++)
            for (int k = 0; k < 3; k++)
                a.rest[v][k] = (pel_real)set->start[v][k];
        assert_true(pel_contact_set_serves(set));
        assert_int_equal(pel_contact_set_find_same(set, 0.01, NULL), PEL_OK);
        assert_true(set->list.count > 0 && set->list.count <= first);
        near += check_listed(&a, set);
        double sum = 0;
        for (int32_t c = 0; c < set->list.count; c++) {
            sum += set->keys[c].load;
            assert_true(!(set->keys[c].load > 0) || set->keys[c].first == loaded.first);
        }
        assert_true(sum == 7);
    }
    assert_true(near > 100);
    shake((const double(*)[3])set->home, set->vertex_count, 0.021 * THICKNESS, &random, set->end);
    assert_false(pel_contact_set_serves(set));
    memcpy(set->end, set->home, (size_t)set->vertex_count * sizeof *set->end);
    memcpy(set->start, set->home, (size_t)set->vertex_count * sizeof *set->end);
    assert_true(pel_contact_set_serves(set));
    /* a number that no feature has, as a snapshot may contain */
    set->keys[0].second = set->triangle_count;
    assert_false(pel_contact_set_serves(set));
    set->keys[0].second = 0;
    pel_contact_set_widen(set);
    assert_false(pel_contact_set_serves(set));
    /* a list for more motion than there is */
    set->margin *= 2;
    assert_int_equal(pel_contact_set_find(set, 0, 0.01, NULL), PEL_OK);
    assert_false(pel_contact_set_serves(set));
    pel_contact_set_destroy(set);
}

/* ---- closed forms ---- */

/* the gap of a contact at positions, over all its points */
static double gap_of(const pel_contact *contact, const pel_record *positions)
{
    double gap = -(double)contact->separation;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            gap += (double)(contact->weights[i] * positions[contact->vertices[i]][k] * contact->normal[k]);
    return gap;
}

/* A sheet falls on a box that rises: its vertices end where the thickness has them, with the velocity of the box. */
static void test_box(void **unused)
{
    (void)unused;
    random_state random = {5};
    const double dt = 0.01, rise = 0.004, top = 0.1;
    static arrays a;
    a = (arrays){0};
    add_sheet(&a, 5, top + THICKNESS + 0.002, 0, &random);
    pel_obstacle box = {.solid = {.shape = PEL_TOOL_BOX, .half_extents = {2, 2, top}}, .presses = true, .body = -1};
    add_obstacle(&a, &box, 0);
    for (int32_t v = 0; v < 25; v++) {
        a.next[v][2] -= (pel_real)0.01;
        a.velocity[v][2] = (pel_real)(-0.01 / dt);
    }
    pel_contact_set *set = create(&a);
    set->obstacles[0].before = pose_at(0, 0, 0);
    set->obstacles[0].pose = pose_at(0, 0, rise);
    pel_contact_set_place(set, a.rest, a.next);
    assert_int_equal(pel_contact_set_find(set, 0, 0.01, NULL), PEL_OK);
    assert_true(set->list.count >= 25);
    const pel_contact_motion motion = {a.rest, a.next, a.velocity, dt};
    pel_contacts_begin(&set->list, 0.01);
    pel_contact_set_correct(set, &motion, 20);
    double least = HUGE_VAL;
    for (int32_t c = 0; c < set->list.count; c++)
        least = fmin(least, gap_of(&set->list.contacts[c], a.next));
    assert_true(least > -1e-2 * THICKNESS);
    for (int32_t v = 0; v < 25; v++) {
        /* the distance at the start is more than the thickness, so all of it is kept */
        assert_near((double)a.next[v][2], rise + top + THICKNESS, 1e-2 * THICKNESS);
        assert_near((double)a.velocity[v][2], rise / dt, 1e-3 * rise / dt);
        assert_near(set->end[v][2], (double)a.next[v][2], 0);
    }
    uint8_t flags[MOST_VERTICES] = {0};
    pel_contact_set_mark(set, flags);
    for (int32_t v = 0; v < a.vertex_count; v++)
        assert_int_equal(flags[v], v < 25);
    pel_contact_set_destroy(set);
}

static void sum_momentum(const arrays *a, const pel_record *from, const pel_record *to, double momentum[3])
{
    pel_vec3_set(momentum, 0, 0, 0);
    for (int32_t v = 0; v < a->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            momentum[k] += (double)(a->mass[v] * (to[v][k] - (from != NULL ? from[v][k] : 0)));
}

/* Corrections of free bodies keep momentum, and kinetic energy does not grow. */
static void test_momentum(void **unused)
{
    (void)unused;
    random_state random = {9};
    static arrays a;
    a = (arrays){0};
    add_sheet(&a, 7, 0, 0.005, &random);
    add_sheet(&a, 6, 0.05, 0.005, &random);
    for (int32_t v = 0; v < a.vertex_count; v++)
        if (a.mass[v] > 0)
            for (int k = 0; k < 3; k++) {
                double way = random_between(&random, -0.005, 0.005) - (v >= 49 && k == 2 ? 0.03 : 0);
                a.next[v][k] += (pel_real)way;
                a.velocity[v][k] = (pel_real)(100 * way);
            }
    pel_contact_set *set = create(&a);
    assert_int_equal(pel_contact_set_find(set, 0, 0.01, NULL), PEL_OK);
    double before[2][3], after[2][3], energy[2] = {0, 0}, most = 0;
    static pel_record start[MOST_VERTICES];
    memcpy(start, a.next, sizeof start);
    sum_momentum(&a, a.rest, a.next, before[0]);
    sum_momentum(&a, NULL, a.velocity, before[1]);
    for (int i = 0; i < 2; i++) {
        for (int32_t v = 0; v < a.vertex_count; v++)
            for (int k = 0; k < 3; k++)
                energy[i] += 0.5 * (double)(a.mass[v] * a.velocity[v][k] * a.velocity[v][k]);
        const pel_contact_motion motion = {a.rest, a.next, a.velocity, 0.01};
        pel_contacts_begin(&set->list, 0.01);
        if (i == 0)
            pel_contact_set_correct(set, &motion, 10);
    }
    sum_momentum(&a, a.rest, a.next, after[0]);
    sum_momentum(&a, NULL, a.velocity, after[1]);
    double rounding = sizeof(pel_real) == 8 ? 1e-12 : 1e-4;
    for (int k = 0; k < 3; k++) {
        assert_near(after[0][k], before[0][k], rounding);
        assert_near(after[1][k], before[1][k], 100 * rounding);
    }
    for (int32_t v = 0; v < a.vertex_count; v++)
        most = fmax(most, fabs((double)(a.next[v][2] - start[v][2])));
    assert_true(most > 1e-3);
    assert_true(energy[1] < energy[0]);
    pel_contact_set_destroy(set);
}

/* ---- round obstacles ---- */

/* first time at which a sphere or capsule of radius 0.1 under the sheet z = 0 that starts at a gap and rises comes too
   near; 2 = never */
static double rise(pel_tool_shape kind, double x, double gap_share, double gap, double way)
{
    random_state random = {5};
    static arrays a;
    a = (arrays){0};
    add_sheet(&a, 7, 0, 0, &random);
    const double half = kind == PEL_TOOL_CAPSULE ? 0.2 : 0;
    pel_obstacle obstacle = {.solid = {.shape = kind, .radius = 0.1, .half_length = half}, .presses = true, .body = -1};
    add_obstacle(&a, &obstacle, 0);
    pel_contact_set *set = create(&a);
    gap += gap_share * set->guarded;
    way *= gap_share > 0 ? set->guarded : 1;
    set->obstacles[0].before = pose_at(x, 0.52, -0.1 - half - gap);
    set->obstacles[0].pose = pose_at(x, 0.52, -0.1 - half - gap + way);
    pel_contact_set_place(set, a.rest, a.next);
    assert_int_equal(pel_contact_look(set, NULL), PEL_OK);
    double time = 2, expected = gap_share > 0 ? 0 : (gap - set->guarded) / way;
    for (size_t c = 0; c < set->conflict_count; c++)
        time = fmin(time, set->conflicts[c].time);
    pel_contact_set_destroy(set);
    return time > 1 ? 2 : time - expected;
}

/* impacts of a constant speed in closed form; features that touch from the start may reach zero distance, but not pass
   it */
static void test_round_obstacles(void **unused)
{
    (void)unused;
    static const pel_tool_shape kinds[] = {PEL_TOOL_SPHERE, PEL_TOOL_CAPSULE};
    for (int i = 0; i < 2; i++) {
        assert_near(rise(kinds[i], 0.55, 0, 0.05, 0.08), 0, 1e-5);
        assert_near(rise(kinds[i], 0.55, 0, 0.05, 0.02), 2, 0);
        assert_near(rise(kinds[i], 5, 0, 0.05, 0.08), 2, 0);
        if (sizeof(pel_real) == 8) {
            assert_near(rise(kinds[i], 0.55, 0.005, 0, 0.0025), 2, 0);
            assert_near(rise(kinds[i], 0.55, 0.005, 0, 0.5), 0, 0);
        }
    }
}

/* A vertex above the only triangles that it can meet goes down through them, or past their border: the end is free only
   if it is not right behind them, however deep. */
static bool ends_free_at(double x, double z)
{
    random_state random = {5};
    static arrays a;
    a = (arrays){0};
    add_sheet(&a, 4, 0, 0, &random);
    add_sheet(&a, 2, 0, 0, &random);
    for (int32_t v = 0; v < 4; v++) {
        pel_record *next = &a.next[16 + v], *rest = &a.rest[16 + v];
        const double low[3] = {0.9 + 0.01 * (double)(*rest)[0], 0.4 + 0.01 * (double)(*rest)[1], 0.05};
        for (int k = 0; k < 3; k++)
            (*rest)[k] = (pel_real)low[k];
        *next = *rest;
        (*next)[0] += (pel_real)(x - 0.9);
        (*next)[2] = (pel_real)z;
    }
    pel_contact_set *set = create(&a);
    pel_contact_set_place(set, a.rest, a.next);
    assert_int_equal(pel_contact_look(set, NULL), PEL_OK);
    assert_true(set->conflict_count > 0);
    bool is_free = false;
    for (size_t c = 0; c < set->conflict_count; c++)
        is_free |= set->conflicts[c].ends_free;
    pel_contact_set_destroy(set);
    return is_free;
}

static void test_free_ends(void **unused)
{
    (void)unused;
    assert_false(ends_free_at(0.9, -0.003));
    assert_false(ends_free_at(0.9, -0.5));
    assert_true(ends_free_at(1.05, -0.08));
}

/* ---- the guard ---- */

/* Sheets thrown through each other, and through a sphere or box: the guard leaves a way on which nothing meets. */
static void check_guard(pel_tool_shape kind, uint64_t seed)
{
    random_state random = {seed};
    static arrays a;
    a = (arrays){0};
    add_sheet(&a, 7, 0, 0.005, &random);
    add_sheet(&a, 6, 0.06, 0.005, &random);
    pel_obstacle obstacle = {
        .solid = {.shape = kind, .radius = 0.1, .half_extents = {0.1, 0.1, 0.1}}, .presses = true, .body = -1};
    add_obstacle(&a, &obstacle, 0);
    for (int32_t v = 0; v < a.vertex_count; v++)
        for (int k = 0; k < 3 && a.mass[v] > 0; k++) {
            double way = random_between(&random, -0.02, 0.02) - (v >= 49 && k == 2 ? 0.2 : 0);
            a.next[v][k] += (pel_real)way;
            a.velocity[v][k] = (pel_real)(100 * way);
        }
    pel_contact_set *set = create(&a);
    set->obstacles[0].before = pose_at(0.4, 0.4, -0.15);
    set->obstacles[0].pose = pose_at(0.4, 0.4, 0.2);
    pel_contact_set_place(set, a.rest, a.next);
    assert_int_equal(pel_contact_look(set, NULL), PEL_OK);
    assert_true(set->conflict_count > 0);
    const pel_contact_motion motion = {a.rest, a.next, a.velocity, 0.01};
    /* its six blocks, made when it first runs */
    for (int i = 0; i < 6; i++) {
        failing_malloc_begin(i == 0 ? 1 : 2);
        assert_int_equal(pel_contact_guard(set, &motion, NULL), PEL_OUT_OF_MEMORY);
        assert_int_equal(failing_malloc_end().failed, 1);
    }
    assert_int_equal(pel_contact_guard(set, &motion, NULL), PEL_OK);
    assert_true(set->obstacles[0].is_held_back);
    assert_true(set->obstacles[0].pose.position[2] < 0.2);
    pel_contact_set_place(set, a.rest, a.next);
    assert_int_equal(pel_contact_look(set, NULL), PEL_OK);
    assert_int_equal(set->conflict_count, 0);
    pel_tangles tangles = {0};
    pel_contact_set_place_start(set, a.next);
    assert_int_equal(pel_tangles_list(set, &tangles, NULL), PEL_OK);
    assert_int_equal(tangles.count, 0);
    pel_free(tangles.pairs);
    pel_contact_set_destroy(set);
}

static void test_guard(void **unused)
{
    (void)unused;
    for (uint64_t seed = 1; seed <= ROUNDS(8, 1); seed++) {
        check_guard(PEL_TOOL_SPHERE, seed);
        check_guard(PEL_TOOL_BOX, seed);
    }
}

/* Vertices held by an obstacle move its share of the displacement, and have that velocity; the free sheet before them
   is not affected. */
static void test_guard_of_held(void **unused)
{
    (void)unused;
    static const int32_t held[4] = {0, 1, 7, 8};
    static arrays a;
    make_sheets(&a, 4, 7, 6, 0.06, 0.005);
    pel_obstacle obstacle = {
        .solid = {.shape = PEL_TOOL_SPHERE, .radius = 0.1}, .body = -1, .held = held, .held_count = 4};
    add_obstacle(&a, &obstacle, 0);
    const double up = 0.12;
    for (int i = 0; i < 4; i++) {
        a.next[held[i]][2] += (pel_real)up;
        a.velocity[held[i]][2] = (pel_real)(100 * up);
    }
    pel_contact_set *set = create(&a);
    set->obstacles[0].before = pose_at(0.1, 0.1, 0);
    set->obstacles[0].pose = pose_at(0.1, 0.1, up);
    pel_contact_set_place(set, a.rest, a.next);
    assert_int_equal(pel_contact_look(set, NULL), PEL_OK);
    const pel_contact_motion motion = {a.rest, a.next, a.velocity, 0.01};
    assert_int_equal(pel_contact_guard(set, &motion, NULL), PEL_OK);
    double gone = set->obstacles[0].pose.position[2], rounding = sizeof(pel_real) == 8 ? 1e-12 : 1e-6;
    assert_true(set->obstacles[0].is_held_back && set->statistics.tools_held == 1);
    assert_true(gone > 0.01 && gone < 0.09);
    for (int i = 0; i < 4; i++) {
        assert_near(a.next[held[i]][2], a.rest[held[i]][2] + (pel_real)gone, rounding);
        assert_near(a.velocity[held[i]][2], 100 * gone, 1000 * rounding);
    }
    /* without a conflict nothing is stopped */
    memcpy(a.next, a.rest, sizeof a.next);
    set->obstacles[0].pose = set->obstacles[0].before;
    pel_contact_set_place(set, a.rest, a.next);
    assert_int_equal(pel_contact_look(set, NULL), PEL_OK);
    assert_int_equal(pel_contact_guard(set, &motion, NULL), PEL_OK);
    assert_true(!set->obstacles[0].is_held_back && set->statistics.tools_held == 1);
    pel_contact_set_destroy(set);
}

/* of two obstacles the one that runs into the sheet is held back; the other one goes all of its way */
static void test_guard_of_two(void **unused)
{
    (void)unused;
    for (int32_t blocked = 0; blocked < 2; blocked++) {
        static arrays a;
        make_sheets(&a, 4, 7, 6, 0.06, 0.005);
        const pel_obstacle ball = {.solid = {.shape = PEL_TOOL_SPHERE, .radius = 0.1}, .presses = true, .body = -1};
        add_obstacle(&a, &ball, 0);
        add_obstacle(&a, &ball, 0);
        pel_contact_set *set = create(&a);
        for (int32_t i = 0; i < 2; i++) {
            set->obstacles[i].before = pose_at(0.5, 0.5, i == blocked ? -0.15 : -5);
            set->obstacles[i].pose = pose_at(0.5, 0.5, i == blocked ? 0.3 : -4);
        }
        pel_contact_set_place(set, a.rest, a.next);
        assert_int_equal(pel_contact_look(set, NULL), PEL_OK);
        const pel_contact_motion motion = {a.rest, a.next, a.velocity, 0.01};
        assert_int_equal(pel_contact_guard(set, &motion, NULL), PEL_OK);
        assert_true(set->obstacles[blocked].is_held_back && !set->obstacles[1 - blocked].is_held_back);
        assert_int_equal(set->statistics.tools_held, 1);
        assert_true(set->obstacles[blocked].pose.position[2] < 0.3);
        assert_true(set->obstacles[blocked].pose.position[2] > -0.14);
        assert_true(set->obstacles[1 - blocked].pose.position[2] == -4);
        pel_contact_set_destroy(set);
    }
}

/* Free sheets keep their momentum; one that meets a fixed one (0 or 1, -1: none) has the velocity of its
   displacement. */
static void check_guard_momentum(int fixed)
{
    static arrays a;
    make_sheets(&a, 6, 7, 6, 0.05, 0.005);
    /* the other one is thrown */
    int still = fixed == 1 ? 1 : 0;
    for (int32_t v = 0; v < a.vertex_count; v++) {
        bool is_still = a.body_of_slice[v / PEL_WIDTH] == still;
        if (a.mass[v] > 0 && !is_still) {
            a.next[v][2] += (pel_real)(still == 0 ? -0.04 : 0.04);
            a.velocity[v][2] = (pel_real)(still == 0 ? -4 : 4);
        } else if (fixed >= 0) {
            a.inverse_mass[v] = 0;
        }
    }
    static pel_record thrown[MOST_VERTICES];
    memcpy(thrown, a.next, sizeof thrown);
    double before[2][3], after[2][3], rounding = sizeof(pel_real) == 8 ? 1e-10 : 1e-3;
    int moved = 0;
    sum_momentum(&a, a.rest, a.next, before[0]);
    sum_momentum(&a, NULL, a.velocity, before[1]);
    pel_contact_set *set = create(&a);
    assert_int_equal(pel_contact_look(set, NULL), PEL_OK);
    assert_true(set->conflict_count > 0);
    const pel_contact_motion motion = {a.rest, a.next, a.velocity, 0.01};
    assert_int_equal(pel_contact_guard(set, &motion, NULL), PEL_OK);
    sum_momentum(&a, a.rest, a.next, after[0]);
    sum_momentum(&a, NULL, a.velocity, after[1]);
    for (int k = 0; fixed < 0 && k < 3; k++) {
        /* the points of a zone have their own shares */
        assert_near(after[0][k], before[0][k], 0.01 * fabs(before[0][2]));
        assert_near(after[1][k], before[1][k], 100 * rounding);
    }
    for (int32_t v = 0; v < a.vertex_count; v++) {
        if (a.next[v][2] == thrown[v][2])
            continue;
        moved++;
        if (fixed >= 0)
            assert_near(a.velocity[v][2], 100 * (a.next[v][2] - a.rest[v][2]), rounding);
    }
    assert_int_equal(set->statistics.fall_backs, moved);
    assert_true(moved > 4);
    pel_contact_set_destroy(set);
}

static void test_guard_momentum(void **unused)
{
    (void)unused;
    for (int fixed = -1; fixed < 2; fixed++)
        check_guard_momentum(fixed);
}

/* A train of triangles falls on the fixed lowest one: each round of the guard reaches the next car or two. A triangle
   that no conflict reaches keeps its way if 22 rounds are enough; else the last one stops everything. */
static void drive_train(int32_t cars, bool stays)
{
    static arrays a;
    a = (arrays){.body_count = 1, .groups[0].thickness = THICKNESS, .triangle_count = cars + 2};
    a.vertex_count = (3 * (cars + 2) + PEL_WIDTH - 1) / PEL_WIDTH * PEL_WIDTH;
    assert_true(a.vertex_count <= MOST_VERTICES);
    for (int32_t i = 0; i < a.triangle_count; i++) {
        /* alternating plates and darts; the last one flies alone */
        static const double plate[3][3] = {{-1, -1, 0}, {2, -1, 0}, {-1, 2, 0}},
                            dart[3][3] = {{0, 0, 0}, {0.1, 0, 0.03}, {-0.1, 0, 0.03}};
        double z = i <= cars ? 0.13 * (i / 2) + 0.05 * (i % 2) : 100;
        for (int c = 0; c < 3; c++) {
            int32_t v = 3 * i + c;
            const double *x = i % 2 == 0 ? plate[c] : dart[c];
            a.mass[v] = 1;
            a.inverse_mass[v] = i > 0;
            a.rest[v] = a.next[v] = (pel_record){(pel_real)x[0], (pel_real)x[1], (pel_real)(x[2] + z), 1};
            a.next[v][2] -= (pel_real)(i > 0 ? 0.25 : 0);
            a.triangles[i][c] = v;
        }
    }
    pel_contact_set *set = create(&a);
    assert_int_equal(pel_contact_look(set, NULL), PEL_OK);
    assert_true(set->conflict_count > 0);
    const pel_contact_motion motion = {a.rest, a.next, NULL, 0.01};
    assert_int_equal(pel_contact_guard(set, &motion, NULL), PEL_OK);
    for (int32_t v = 0; v < 3 * (cars + 2); v++) {
        double way = (double)(a.rest[v][2] - a.next[v][2]);
        assert_true(way >= 0 && way <= 0.25 + 1e-6);
        if (stays || v / 3 > cars)
            assert_near(way, stays ? 0 : 0.25, stays ? 0 : 1e-5);
    }
    pel_contact_set_place(set, a.rest, a.next);
    assert_int_equal(pel_contact_look(set, NULL), PEL_OK);
    assert_int_equal(set->conflict_count, 0);
    pel_contact_set_destroy(set);
}

static void test_guard_of_train(void **unused)
{
    (void)unused;
    drive_train(8, false);
    drive_train(43, false);
    drive_train(44, true);
}

/* A body that flies far and meets another one keeps its shape: all of it goes the same share of its way. */
static void check_far_flight(int32_t flying)
{
    static arrays a;
    make_sheets(&a, 8, 7, 6, 0.3, 0.005);
    const double up = flying == 0 ? 2 : -2;
    for (int32_t v = 0; v < a.vertex_count; v++)
        if (a.mass[v] > 0 && a.body_of_slice[v / PEL_WIDTH] == flying)
            a.next[v][2] += (pel_real)up;
    pel_contact_set *set = create(&a);
    assert_int_equal(pel_contact_look(set, NULL), PEL_OK);
    const pel_contact_motion motion = {a.rest, a.next, NULL, 0.01};
    assert_int_equal(pel_contact_guard(set, &motion, NULL), PEL_OK);
    int32_t first = -1;
    for (int32_t v = 0; v < a.vertex_count; v++)
        if (a.mass[v] > 0 && a.body_of_slice[v / PEL_WIDTH] == flying) {
            first = first < 0 ? v : first;
            assert_near((double)(a.next[v][2] - a.rest[v][2]), (double)(a.next[first][2] - a.rest[first][2]), 1e-6);
        }
    double way = (double)(a.next[first][2] - a.rest[first][2]) / up;
    assert_true(way > 0.1 && way < 0.15);
    pel_contact_set_destroy(set);
}

static void test_far_flight(void **unused)
{
    (void)unused;
    check_far_flight(0);
    check_far_flight(1);
}

/* ---- the list ---- */

/* No more contacts than the limit; the others are counted. */
static void test_limit(void **unused)
{
    (void)unused;
    static arrays a;
    make_sheets(&a, 3, 7, 6, 0.025, 0.01);
    pel_contact_set *set = create(&a);
    assert_int_equal(pel_contact_set_find(set, 0, 0.01, NULL), PEL_OK);
    int32_t all = set->list.count;
    assert_true(all > 20);
    for (int32_t limit = all - 1; limit <= all + 1; limit++) {
        set->def.limit = limit;
        set->statistics.dropped = 0;
        assert_int_equal(pel_contact_set_find(set, 0, 0.01, NULL), PEL_OK);
        assert_int_equal(set->list.count, limit < all ? limit : all);
        assert_int_equal(set->statistics.dropped, all - set->list.count);
    }
    pel_contact_set_destroy(set);
}

/* Unchanged positions are not searched again; one changed coordinate of one vertex triggers a search. */
static void test_search_is_kept(void **unused)
{
    (void)unused;
    random_state random = {3};
    static arrays a;
    a = (arrays){0};
    add_sheet(&a, 7, 0, 0.01, &random);
    pel_contact_set *set = create(&a);
    pel_collision_result found;
    assert_int_equal(pel_contact_set_search_way(set, &found, NULL), PEL_OK);
    assert_true(set->way_is_searched);
    pel_contact_set_place(set, a.rest, a.next);
    assert_true(set->way_is_searched);
    for (int32_t v = 0; v < 49; v += 48)
        for (int k = 0; k < 3; k++) {
            a.next[v][k] += (pel_real)1e-3;
            pel_contact_set_place(set, a.rest, a.next);
            assert_false(set->way_is_searched);
            assert_near(set->end[v][k], (double)a.next[v][k], 0);
            assert_int_equal(pel_contact_set_search_way(set, &found, NULL), PEL_OK);
        }
    pel_contact_set_destroy(set);
}

/* Impacts act if the pair is slightly through; pairs far through are left to the guard. */
static void test_far_through(void **unused)
{
    (void)unused;
    int acting = 0, left = 0, off = 0;
    for (double down = 0.1; down < 1; down += 0.1) {
        static arrays a;
        make_sheets(&a, 3, 7, 6, 0.06, 0.005);
        for (int32_t v = 0; v < a.vertex_count; v++)
            if (a.mass[v] > 0 && a.body_of_slice[v / PEL_WIDTH] == 1)
                a.next[v][2] -= (pel_real)down;
        pel_contact_set *set = create(&a);
        pel_collision_result found;
        assert_int_equal(pel_contact_set_find(set, 0, 0.01, NULL), PEL_OK);
        assert_int_equal(pel_contact_set_search_way(set, &found, NULL), PEL_OK);
        assert_int_equal(pel_contact_set_add_way(set, &found, NULL), PEL_OK);
        pel_contact_set_begin_substep(set, 0.01);
        pel_contact_set_refresh(set, a.next, a.rest, true, true);
        for (int32_t c = 0; c < set->list.count; c++) {
            const pel_contact *contact = &set->list.contacts[c];
            double gap = 0;
            for (int i = 0; i < 4; i++)
                for (int k = 0; k < 3; k++)
                    gap += set->keys[c].place[i] * (double)(a.next[set->keys[c].points[i]][k] * contact->normal[k]);
            if (!set->keys[c].is_impact) {
                /* pairs that lean over a triangle do not act */
                assert_int_equal((double)contact->separation < -1e30, set->keys[c].is_off);
                off += set->keys[c].is_off;
                continue;
            }
            bool is_far = gap < -2 * set->mean_edge;
            assert_int_equal((double)contact->separation < -1e30, is_far);
            acting += !is_far;
            left += is_far;
        }
        pel_contact_set_destroy(set);
    }
    assert_true(acting > 10 && left > 10 && off > 10);
}

/* Times are wall times: above 0, and at most that of the whole call. */
static void test_seconds(void **unused)
{
    (void)unused;
    static arrays a;
    make_sheets(&a, 3, 9, 9, 0.025, 0.01);
    pel_contact_set *set = create(&a);
    double began = pel_seconds();
    for (int i = 0; i < 10; i++) {
        pel_collision_result found;
        assert_int_equal(pel_contact_set_find(set, 0, 0.01, NULL), PEL_OK);
        assert_int_equal(pel_contact_set_search_way(set, &found, NULL), PEL_OK);
    }
    double passed = pel_seconds() - began;
    assert_true(set->statistics.find_seconds > 0.1 * passed && set->statistics.guard_seconds > 0);
    assert_true(set->statistics.find_seconds + set->statistics.guard_seconds <= passed + 1e-6);
    pel_contact_set_destroy(set);
}

static bool same_pair(pel_pair a, pel_pair b)
{
    return a.first == b.first && a.second == b.second;
}

/* Of three crossing sheets, pairs of two that do not meet are removed, and no others. */
static void test_strangers(void **unused)
{
    (void)unused;
    random_state random = {2};
    static arrays a;
    a = (arrays){0};
    for (int i = 0; i < 3; i++)
        add_sheet(&a, 5, 0, 0.02, &random);
    pel_contact_set *set = create(&a);
    pel_tangles all = {0}, some = {0};
    assert_int_equal(pel_tangles_list(set, &all, NULL), PEL_OK);
    set->may_meet[0 * 3 + 1] = set->may_meet[1 * 3 + 0] = 0;
    assert_int_equal(pel_tangles_list(set, &some, NULL), PEL_OK);
    int64_t kept = 0, dropped = 0;
    for (int64_t i = 0; i < all.count; i++) {
        /* the third sheet has the last 32 triangles */
        bool meets = all.pairs[i].first >= 64 || all.pairs[i].second >= 64;
        dropped += !meets;
        if (meets)
            assert_true(kept < some.count && same_pair(all.pairs[i], some.pairs[kept++]));
    }
    assert_int_equal(kept, some.count);
    assert_true(kept > 10 && dropped > 10);
    pel_free(all.pairs);
    pel_free(some.pairs);
    pel_contact_set_destroy(set);
}

/* two sheets that cross: their pairs are known, and are no conflicts */
static void test_tangles(void **unused)
{
    (void)unused;
    static arrays a;
    make_sheets(&a, 2, 5, 5, 0, 0.02);
    pel_contact_set *set = create(&a);
    assert_int_equal(pel_tangles_find(set, NULL), PEL_OK);
    assert_true(set->tangles.is_known && set->tangles.count > 0);
    set->def.between = false;
    set->may_meet[1] = set->may_meet[2] = 0;
    pel_tangles none = {0};
    assert_int_equal(pel_tangles_list(set, &none, NULL), PEL_OK);
    assert_int_equal(none.count, 0);
    pel_free(none.pairs);
    pel_contact_set_destroy(set);
}

static pel_status create_case(const void *data, pel_error *error)
{
    pel_contact_set *set = NULL;
    pel_status status = make_set(data, &set, error);
    pel_contact_set_destroy(set);
    return status;
}

static void test_allocations(void **unused)
{
    (void)unused;
    random_state random = {1};
    static arrays a;
    a = (arrays){0};
    add_sheet(&a, 4, 0, 0.01, &random);
    add_sheet(&a, 4, 0.02, 0, &random);
    assert_true(for_every_allocation_failure(create_case, &a) > 20);
}

/* m, the least distance of a pair at many times of straight ways */
static double sampled_distance(const pel_contact_set *set, const pel_collision *pair, int count)
{
    double least = HUGE_VAL, x[4][3], w[4];
    for (int i = 0; i <= count; i++) {
        for (int p = 0; p < 4; p++)
            for (int k = 0; k < 3; k++) {
                double start = set->start[pair->vertices[p]][k], end = set->end[pair->vertices[p]][k];
                x[p][k] = start + i * (end - start) / count;
            }
        double square = pair->edge_edge ? pel_closest_segment_segment(x[0], x[1], x[2], x[3], w)
                                        : pel_closest_point_triangle(x[0], x[1], x[2], x[3], w);
        least = square < least ? square : least;
    }
    return sqrt(least);
}

/* Pairs may touch exactly when straight ways bring them near: random ones, against many positions on the way. */
static void test_ways(void **unused)
{
    (void)unused;
    enum { PAIRS = 4000, SAMPLES = 200 };
    random_state random = {11};
    static arrays a;
    make_sheets(&a, 3, 4, 4, 0.5, 0.01);
    a.has_layers = true;
    pel_contact_set *set = create(&a);
    double reach = THICKNESS + set->margin;
    int near_on_way = 0, apart = 0;
    for (int n = 0; n < PAIRS; n++) {
        pel_collision pair = {.edge_edge = n % 2 == 0, .vertices = {0, 1, a.vertex_count / 2, a.vertex_count / 2 + 1}};
        int middle = pair.edge_edge ? 2 : 1;
        if (!pair.edge_edge)
            pair.vertices[1] = a.vertex_count / 2 + 4;
        for (int p = 0; p < 4; p++)
            for (int k = 0; k < 3; k++) {
                double height = k == 2 && p < middle ? 0.15 : 0;
                set->start[pair.vertices[p]][k] = height + random_between(&random, -0.1, 0.1);
                set->end[pair.vertices[p]][k] = height * (n % 3 - 1) + random_between(&random, -0.1, 0.1);
            }
        double start = pel_contact_measure_start(set, &pair), least = sampled_distance(set, &pair, SAMPLES);
        bool may = pel_contact_may_meet(set, &pair);
        if (least <= reach) {
            assert_true(may);
            near_on_way += start > reach;
        } else if (least > reach + 0.005) {
            assert_false(may);
            apart++;
        }
    }
    assert_true(near_on_way > 200 && apart > 200);
    pel_contact_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pairs),          cmocka_unit_test(test_box),
        cmocka_unit_test(test_momentum),       cmocka_unit_test(test_guard),
        cmocka_unit_test(test_guard_of_held),  cmocka_unit_test(test_guard_of_two),
        cmocka_unit_test(test_guard_momentum), cmocka_unit_test(test_round_obstacles),
        cmocka_unit_test(test_free_ends),      cmocka_unit_test(test_tangles),
        cmocka_unit_test(test_guard_of_train), cmocka_unit_test(test_far_flight),
        cmocka_unit_test(test_limit),          cmocka_unit_test(test_search_is_kept),
        cmocka_unit_test(test_far_through),    cmocka_unit_test(test_seconds),
        cmocka_unit_test(test_strangers),      cmocka_unit_test(test_serves),
        cmocka_unit_test(test_ways),           cmocka_unit_test(test_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
