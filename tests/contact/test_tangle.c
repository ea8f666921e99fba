/* Intersections from the start on: the pairs against a test of all pairs of triangles. */
#include "set_fixture.h"

#include "pellicle/geometry.h"

/* two sheets of one height whose vertices are moved about, so that each cuts itself and the other */
static void make_tangled(arrays *a)
{
    random_state random = {17};
    make_sheets(a, 17, 6, 7, 0, 0.1);
    for (int32_t v = 0; v < a->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            a->rest[v][k] += (pel_real)random_between(&random, -0.15, 0.15);
    memcpy(a->next, a->rest, sizeof a->next);
}

static bool intersect(const arrays *a, const int32_t *s, const int32_t *t)
{
    double x[2][3][3];
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            if (s[i] == t[k])
                return false; /* neighbours: of no interest here */
        pel_vertex_position(a->rest, s[i], x[0][i]);
        pel_vertex_position(a->rest, t[i], x[1][i]);
    }
    return pel_triangles_intersect((const double(*)[3])x[0], (const double(*)[3])x[1]);
}

static int body_of(const arrays *a, const int32_t *triangle)
{
    return a->body_of_slice[triangle[0] / PEL_WIDTH];
}

static bool is_listed(const pel_contact_set *set, int32_t s, int32_t t)
{
    for (int64_t i = 0; i < set->tangles.count; i++)
        if ((set->tangles.pairs[i].first == s && set->tangles.pairs[i].second == t) ||
            (set->tangles.pairs[i].first == t && set->tangles.pairs[i].second == s))
            return true;
    return false;
}

static pel_contact_set *create_tangled(const arrays *a, bool self, bool between)
{
    pel_contact_set *set = create(a);
    int32_t groups = a->body_count;
    for (int32_t i = 0; i < groups * groups; i++)
        set->may_meet[i] = i / groups == i % groups ? self : between;
    assert_int_equal(pel_tangles_find(set, NULL), PEL_OK);
    assert_true(set->tangles.is_known && set->statistics.tangled == set->tangles.count);
    return set;
}

/* all pairs that meet, and none of bodies that do not */
static void test_pairs(void **unused)
{
    (void)unused;
    static arrays a;
    make_tangled(&a);
    for (int kinds = 0; kinds < 4; kinds++) {
        const bool self = kinds & 1, between = kinds & 2;
        pel_contact_set *set = create_tangled(&a, self, between);
        int64_t counts[2] = {0, 0};
        for (int32_t s = 0; s < a.triangle_count; s++)
            for (int32_t t = 0; t < s; t++) {
                if (!intersect(&a, a.triangles[s], a.triangles[t]))
                    continue;
                bool is_self = body_of(&a, a.triangles[s]) == body_of(&a, a.triangles[t]);
                counts[is_self]++;
                assert_int_equal(is_listed(set, s, t), is_self ? self : between);
            }
        /* more than the first room of the list */
        assert_true(counts[0] > 100 && counts[1] > 5);
        for (int64_t i = 0; i < set->tangles.count; i++) {
            const int32_t *s = a.triangles[set->tangles.pairs[i].first], *t = a.triangles[set->tangles.pairs[i].second];
            assert_true(body_of(&a, s) == body_of(&a, t) ? self : between);
        }
        if (kinds == 0)
            assert_int_equal(set->tangles.count, 0);
        pel_contact_set_destroy(set);
    }
}

static bool has_both(const pel_contact_set *set, int32_t p, int32_t q)
{
    for (int64_t i = 0; i < set->tangles.count; i++) {
        const int32_t *s = set->triangles[set->tangles.pairs[i].first],
                      *t = set->triangles[set->tangles.pairs[i].second];
        bool has[2][2] = {{false}};
        for (int k = 0; k < 3; k++) {
            has[0][0] |= s[k] == p;
            has[0][1] |= s[k] == q;
            has[1][0] |= t[k] == p;
            has[1][1] |= t[k] == q;
        }
        if ((has[0][0] && has[1][1]) || (has[0][1] && has[1][0]))
            return true;
    }
    return false;
}

/* a vertex and a triangle, or two edges, are left alone if each point of the one is in a pair with each of the other */
static void test_have(void **unused)
{
    (void)unused;
    static arrays a;
    random_state random = {23};
    int counts[2][2] = {{0}};
    make_tangled(&a);
    pel_contact_set *set = create_tangled(&a, false, true);
    for (int n = 0; n < 4000; n++) {
        pel_collision collision = {.edge_edge = n % 2 == 1};
        const int first_count = collision.edge_edge ? 2 : 1;
        /* mostly of a pair */
        const pel_pair pair = set->tangles.pairs[random_integer(&random, 0, set->tangles.count - 1)];
        const int32_t *s = set->triangles[pair.first], *t = set->triangles[pair.second];
        if (n % 3 == 0)
            t = set->triangles[random_integer(&random, 0, a.triangle_count - 1)];
        const int turn = (int)random_integer(&random, 0, 2);
        for (int i = 0; i < 4; i++)
            collision.vertices[i] = i < first_count ? s[(i + turn) % 3] : t[(i - first_count + turn) % 3];
        bool expected = true;
        for (int i = 0; i < first_count; i++)
            for (int k = first_count; k < 4; k++)
                expected = expected && has_both(set, collision.vertices[i], collision.vertices[k]);
        assert_int_equal(pel_tangles_have(set, &collision), expected);
        counts[collision.edge_edge][expected]++;
    }
    for (int i = 0; i < 4; i++)
        assert_true(counts[i / 2][i % 2] > 100);
    pel_contact_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_pairs), cmocka_unit_test(test_have)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
