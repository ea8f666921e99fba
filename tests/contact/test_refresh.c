/* Pairs of a search while features slide over each other in substeps: what is near acts, by all pairs. */
#include "set_fixture.h"
#include "sweep/sweep.h"

/* they turn after some, so that they get past where they began */
enum { SUBSTEPS = 17, TURN = 7 };
#define ANGLE 2.5
/* a pair may stand for triangles that are as near */
#define NEARLY 1.1
#define SUBSTEP 1e-3

static void position(const pel_record *positions, int32_t v, double x[3])
{
    pel_vertex_position(positions, v, x);
}

/* of a vertex from a triangle [m] */
static double distance_to(const pel_record *positions, int32_t v, const int32_t corners[3])
{
    double x[4][3], weights[3];
    position(positions, v, x[0]);
    for (int i = 0; i < 3; i++)
        position(positions, corners[i], x[i + 1]);
    return sqrt(pel_closest_point_triangle(x[0], x[1], x[2], x[3], weights));
}

/* the least gap of the pairs that act at a vertex before triangles [m] */
static double least_gap(const pel_contact_set *set, int32_t v)
{
    double least = HUGE_VAL;
    for (int32_t i = 0; i < pel_contact_list_length(&set->list); i++) {
        int32_t c = set->list.active != NULL ? set->list.active[i] : i;
        if (!set->keys[c].edge_edge && set->keys[c].first == v && set->keys[c].gap < least)
            least = set->keys[c].gap;
    }
    return least;
}

/* vertices from `begin` on that are within the layer of a triangle of the lower sheet have a pair that acts with it or
   with one as near; returns how many */
static int32_t check_vertices(const pel_contact_set *set, const arrays *a, const pel_record *positions, int32_t begin)
{
    int32_t count = 0;
    for (int32_t v = begin; v < a->vertex_count; v++) {
        double least = HUGE_VAL;
        for (int32_t t = 0; t < a->triangle_count; t++)
            if (a->mass[v] > 0 && a->triangles[t][0] < begin)
                least = fmin(least, distance_to(positions, v, a->triangles[t]));
        if (!(least < THICKNESS))
            continue;
        assert_true(least_gap(set, v) <= least * NEARLY);
        count++;
    }
    return count;
}

/* whether the angle between two edges has a sine above 0.2: vertices keep others apart */
static bool cross_clearly(double x[4][3])
{
    double u[3], v[3], cross[3];
    pel_vec3_subtract(x[1], x[0], u);
    pel_vec3_subtract(x[3], x[2], v);
    pel_vec3_cross(u, v, cross);
    return pel_vec3_length(cross) > 0.2 * pel_vec3_length(u) * pel_vec3_length(v);
}

/* edges of the upper sheet that cross one of the lower sheet well inside its layer are in the list; returns how many */
static int32_t check_edges(const pel_contact_set *set, const arrays *a, const pel_record *positions, int32_t begin)
{
    int32_t count = 0;
    for (int32_t i = 0; i < 3 * a->triangle_count; i++)
        for (int32_t k = 0; k < 3 * a->triangle_count; k++) {
            const int32_t *s = a->triangles[i / 3], *t = a->triangles[k / 3];
            const int32_t p[4] = {s[i % 3], s[(i + 1) % 3], t[k % 3], t[(k + 1) % 3]};
            double x[4][3], w[4];
            if (s[0] >= begin || t[0] < begin)
                continue;
            for (int n = 0; n < 4; n++)
                position(positions, p[n], x[n]);
            double square = pel_closest_segment_segment(x[0], x[1], x[2], x[3], w);
            if (!cross_clearly(x) || !(square < 0.7 * 0.7 * THICKNESS * THICKNESS) ||
                !(fmin(fmin(w[0], w[1]), fmin(w[2], w[3])) > 0.01))
                continue;
            bool is_listed = false;
            for (int32_t c = 0; c < set->list.count && !is_listed; c++) {
                int same = 0;
                for (int n = 0; n < 16; n++)
                    same += set->keys[c].edge_edge && set->keys[c].points[n / 4] == p[n % 4];
                is_listed = same == 4;
            }
            assert_true(is_listed);
            count++;
        }
    return count;
}

/* Sheets whose vertices lie over each other, flat and hilly ones; each vertex of the upper one slides its own way,
   nowhere farther than half of the margin */
static void test_slide(void **unused)
{
    (void)unused;
    int32_t vertices = 0, edges = 0;
    for (uint64_t seed = 1; seed <= ROUNDS(12, 3); seed++) {
        static arrays a;
        static pel_record now[MOST_VERTICES], start[MOST_VERTICES];
        random_state random = {seed};
        make_sheets(&a, seed, 6, 6, 0.022, seed % 3 == 0 ? 0.06 : 0.008);
        for (int32_t v = 0; v < 36 && seed % 3 == 0; v++)
            a.rest[a.vertex_count / 2 + v][2] = a.next[a.vertex_count / 2 + v][2] = a.rest[v][2] + (pel_real)0.019;
        a.has_layers = true;
        pel_contact_set *set = create(&a);
        assert_int_equal(pel_contact_set_find(set, 0, SUBSTEP, NULL), PEL_OK);
        pel_contact_set_recall_loads(set, SUBSTEP);
        double way[2][MOST_VERTICES][3];
        int32_t begin = a.vertex_count / 2;
        for (int32_t v = 0; v < a.vertex_count; v++) {
            double angle = random_between(&random, 0, 6.28), length = v < begin ? 0 : 0.48 * set->margin / TURN;
            for (int i = 0; i < 2; i++)
                pel_vec3_set(way[i][v], length * cos(angle + i * ANGLE), length * sin(angle + i * ANGLE), 0);
        }
        memcpy(now, a.rest, sizeof now);
        for (int32_t s = 0; s < SUBSTEPS; s++) {
            memcpy(start, now, sizeof start);
            for (int32_t v = 0; v < a.vertex_count; v++)
                for (int k = 0; k < 3; k++)
                    now[v][k] += (pel_real)way[s < TURN ? 0 : 1][v][k];
            pel_contact_set_begin_substep(set, SUBSTEP);
            if (pel_contact_set_needs_look(set, now, true))
                pel_contact_set_refresh(set, now, start, false, true);
            vertices += check_vertices(set, &a, now, begin);
            edges += check_edges(set, &a, now, begin);
        }
        pel_contact_set_destroy(set);
    }
    assert_true(vertices > 500);
    assert_true(edges > 100);
}

/* the pair of the list with this key, -1 = none */
static int32_t find_key(const pel_contact_key *keys, int32_t count, const pel_contact_key *key)
{
    for (int32_t c = 0; c < count; c++)
        if (keys[c].edge_edge == key->edge_edge && keys[c].first == key->first && keys[c].second == key->second)
            return c;
    return -1;
}

/* A search within a step, after one corner of the upper sheet has gone up and another one has come down: pairs that
   were known have the loads, the looks and the normals that they had; others are to be looked at. */
static void test_search_again(void **unused)
{
    (void)unused;
    static arrays a;
    static pel_record now[MOST_VERTICES];
    static pel_contact_key keys[4096];
    static pel_contact contacts[4096];
    static double calm[4096];
    make_sheets(&a, 5, 6, 6, 0.03, 0.004);
    a.has_layers = true;
    pel_contact_set *set = create(&a);
    int32_t upper = a.vertex_count / 2, known = 0, fresh = 0;
    for (int k = 0; k < 36; k++)
        set->start[upper + k][2] = set->end[upper + k][2] += 0.2 * (k % 6 - 1 > 0 ? 0.1 * (k % 6 - 1) : 0);
    assert_int_equal(pel_contact_set_find(set, 0, SUBSTEP, NULL), PEL_OK);
    pel_contact_set_recall_loads(set, SUBSTEP);
    memcpy(now, a.rest, sizeof now);
    for (int32_t v = 0; v < a.vertex_count; v++)
        for (int k = 0; k < 3; k++)
            now[v][k] = (pel_real)set->start[v][k];
    pel_contact_set_begin_substep(set, SUBSTEP);
    pel_contact_set_refresh(set, now, now, false, true);
    for (int32_t c = 0; c < set->list.count; c++)
        set->list.contacts[c].multiplier = set->acts[c] ? (pel_real)(1e-6 * (1 + c)) : 0;
    pel_contact_set_keep_loads(set);
    int32_t count = set->list.count;
    assert_true(count > 20 && count < 4096);
    memcpy(keys, set->keys, (size_t)count * sizeof *keys);
    memcpy(contacts, set->list.contacts, (size_t)count * sizeof *contacts);
    memcpy(calm, set->calm, (size_t)count * sizeof *calm);
    for (int i = 0; i < 6; i++) {
        set->start[upper + 6 * i][2] += 0.3;
        set->start[upper + 6 * i + 5][2] = set->end[upper + 6 * i + 5][2] = 0.03;
        set->end[upper + 6 * i][2] = set->start[upper + 6 * i][2];
    }
    assert_int_equal(pel_contact_set_find_again(set, NULL, SUBSTEP, NULL), PEL_OK);
    pel_contact_set_recall_again(set, SUBSTEP, true);
    for (int32_t c = 0; c < set->list.count; c++) {
        int32_t old = find_key(keys, count, &set->keys[c]);
        if (old < 0) {
            assert_true(set->calm[c] == 0 && set->acts[c]);
            fresh++;
            continue;
        }
        const pel_contact *contact = &set->list.contacts[c];
        assert_true(set->calm[c] == calm[old]);
        assert_memory_equal(contact->normal, contacts[old].normal, sizeof contact->normal);
        assert_memory_equal(set->watches[c].points, set->keys[c].points, sizeof set->keys[c].points);
        assert_true(fabs((double)(contact->multiplier - contacts[old].multiplier)) <
                    1e-5 * (double)contacts[old].multiplier + 1e-30);
        known++;
    }
    assert_true(known == count && fresh > 5);
    pel_contact_set_destroy(set);
}

/* whether a pair is in the list, or in the triangles around the corner of one */
static bool is_listed(const pel_contact_set *set, const pel_contact_key *key)
{
    int32_t ring[PEL_RING_LIMIT];
    for (int32_t c = 0; c < set->list.count; c++) {
        const pel_contact_key *own = &set->keys[c];
        if (own->edge_edge != key->edge_edge || own->first != key->first)
            continue;
        if (own->second == key->second)
            return true;
        int count = own->ring == 0
                        ? 0
                        : pel_contact_ring(pel_collider_tree(set->collider), own->second, own->points[own->ring], ring);
        for (int i = 0; i < count; i++)
            if (ring[i] == key->second)
                return true;
    }
    return false;
}

/* Searches within a step that keep what is known, after points went astray: with it they have each pair that a search
   of all has. Once so many are kept, one goes through all again and drops what is far. */
static void test_search_keeps(void **unused)
{
    (void)unused;
    int32_t pairs = 0, dropped = 0;
    for (uint64_t seed = 1; seed <= ROUNDS(24, 6); seed++) {
        static arrays a;
        random_state random = {seed};
        make_sheets(&a, seed, 7, 7, 0.03, 0.006);
        a.has_layers = true;
        pel_contact_set *set = create(&a), *all = create(&a);
        int32_t upper = a.vertex_count / 2;
        assert_int_equal(pel_contact_set_find(set, 0, SUBSTEP, NULL), PEL_OK);
        for (int search = 0; search < 4; search++) {
            int32_t count = set->list.count;
            for (int k = 0; k < 49; k++)
                for (int i = 0; i < 3; i++) {
                    double way = random_between(&random, -0.02, 0.02) + (i == 2 ? 0.012 * (search - 1.5) : 0);
                    set->start[upper + k][i] += way;
                    set->end[upper + k][i] = set->start[upper + k][i] + random_between(&random, -0.01, 0.01);
                }
            memcpy(all->start, set->start, (size_t)set->point_count * sizeof *set->start);
            memcpy(all->end, set->end, (size_t)set->point_count * sizeof *set->end);
            assert_int_equal(pel_contact_set_find(all, 0, SUBSTEP, NULL), PEL_OK);
            assert_int_equal(pel_contact_set_find_again(set, NULL, SUBSTEP, NULL), PEL_OK);
            for (int32_t c = 0; c < all->list.count; c++)
                assert_true(is_listed(set, &all->keys[c]));
            pairs += all->list.count;
            dropped += set->list.count < count;
        }
        pel_contact_set_destroy(set);
        pel_contact_set_destroy(all);
    }
    assert_true(pairs > 1000 && dropped > 0);
}

/* a search for some bodies drops only pairs of theirs, and adds none of others */
static void test_search_some(void **unused)
{
    (void)unused;
    static arrays a;
    const uint8_t none[2] = {0, 0}, upper_one[2] = {0, 1};
    make_sheets(&a, 2, 6, 6, 0.03, 0.004);
    a.has_layers = true;
    pel_contact_set *set = create(&a);
    int32_t upper = a.vertex_count / 2;
    assert_int_equal(pel_contact_set_find(set, 0, SUBSTEP, NULL), PEL_OK);
    int32_t count = set->list.count;
    assert_true(count > 20);
    pel_contact_set_recall_loads(set, SUBSTEP);
    for (int k = 0; k < 36; k++)
        set->start[upper + k][2] = set->end[upper + k][2] += 0.3;
    assert_int_equal(pel_contact_set_find_again(set, none, SUBSTEP, NULL), PEL_OK);
    assert_int_equal(set->list.count, count);
    assert_int_equal(pel_contact_set_find_again(set, upper_one, SUBSTEP, NULL), PEL_OK);
    assert_int_equal(set->list.count, 0);
    for (int k = 0; k < 36; k++)
        set->start[upper + k][2] = set->end[upper + k][2] -= 0.3;
    assert_int_equal(pel_contact_set_find_again(set, none, SUBSTEP, NULL), PEL_OK);
    assert_int_equal(set->list.count, 0);
    assert_int_equal(pel_contact_set_find_again(set, upper_one, SUBSTEP, NULL), PEL_OK);
    assert_int_equal(set->list.count, count);
    pel_contact_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_slide), cmocka_unit_test(test_search_again),
                                       cmocka_unit_test(test_search_keeps), cmocka_unit_test(test_search_some)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
