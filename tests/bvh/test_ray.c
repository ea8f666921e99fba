/* Rays at a tree against all triangles, one by one; through edges and vertices as well. */
#include "bvh/ray.h"
#include "check.h"
#include "pellicle/shape.h"
#include "random.h"

#include <stdlib.h>

typedef struct surface {
    pel_mesh *mesh;
    pel_tree *tree;
    double center[3];
} surface;

static surface make_surface(int32_t frequency, double shift)
{
    surface s = {.center = {shift, 0, 0}};
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = frequency;
    assert_int_equal(pel_shape_create(&def, &s.mesh, NULL), PEL_OK);
    for (int32_t v = 0; v < s.mesh->vertex_count; v++)
        s.mesh->positions[v][0] += shift;
    pel_box *boxes = aligned_alloc(32, (size_t)s.mesh->vertex_count * sizeof *boxes);
    assert_non_null(boxes);
    for (int32_t v = 0; v < s.mesh->vertex_count; v++)
        for (int k = 0; k < 4; k++) {
            float x = k < 3 ? (float)(s.mesh->positions[v][k] - s.center[k]) : 0;
            boxes[v].low[k] = k < 3 ? nextafterf(x, -HUGE_VALF) : 0;
            boxes[v].high[k] = k < 3 ? nextafterf(x, HUGE_VALF) : 0;
        }
    assert_int_equal(pel_tree_create((const double(*)[3])s.mesh->positions, s.mesh->vertex_count,
                                     (const int32_t(*)[3])s.mesh->triangles, s.mesh->triangle_count, PEL_TREE_TRIANGLES,
                                     &s.tree, NULL),
                     PEL_OK);
    pel_tree_refit(s.tree, boxes, NULL);
    free(boxes);
    return s;
}

static void free_surface(surface *s)
{
    pel_tree_destroy(s->tree);
    pel_mesh_destroy(s->mesh);
}

static pel_ray_hit try_all(const surface *s, const pel_ray *ray)
{
    pel_ray_hit nearest = {.triangle = -1, .distance = HUGE_VAL};
    for (int32_t t = 0; t < s->mesh->triangle_count; t++) {
        const int32_t *v = s->mesh->triangles[t];
        pel_ray_hit hit = {.triangle = t};
        if (pel_ray_triangle(ray, s->mesh->positions[v[0]], s->mesh->positions[v[1]], s->mesh->positions[v[2]], &hit) &&
            hit.distance < nearest.distance)
            nearest = hit;
    }
    return nearest;
}

static void check_ray(const surface *s, const pel_ray *ray, bool must_hit, long *hits)
{
    pel_ray_hit expected = try_all(s, ray);
    pel_ray_hit found = pel_tree_cast(s->tree, (const double(*)[3])s->mesh->positions, s->center, ray);
    assert_int_equal(found.triangle, expected.triangle);
    assert_true(found.distance == expected.distance);
    assert_true(!must_hit || found.triangle >= 0);
    if (found.triangle < 0)
        return;
    double x[3] = {0};
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            x[k] += found.weights[c] * s->mesh->positions[s->mesh->triangles[found.triangle][c]][k];
    for (int k = 0; k < 3; k++)
        assert_near(x[k], ray->origin[k] + found.distance * ray->direction[k], 1e-9 * (1 + fabs(ray->origin[k])));
    (*hits)++;
}

static void test_against_all(void **unused)
{
    (void)unused;
    long hits = 0;
    for (int32_t frequency = 1; frequency <= 9; frequency += 4) {
        surface s = make_surface(frequency, frequency == 5 ? 1000 : 0);
        random_state random = {7};
        for (int i = 0; i < ROUNDS(3000, 300); i++) {
            pel_ray ray;
            for (int k = 0; k < 3; k++) {
                ray.origin[k] = s.center[k] + random_between(&random, -2, 2);
                ray.direction[k] = random_between(&random, -1, 1);
            }
            if (i % 7 == 0)
                ray.direction[i % 3] = 0;
            check_ray(&s, &ray, false, &hits);
        }
        free_surface(&s);
    }
    assert_true(hits > ROUNDS(100, 20));
}

/* from inside a closed surface every ray meets it, also exactly through edges and vertices */
static void test_watertight(void **unused)
{
    (void)unused;
    surface s = make_surface(6, 0);
    long hits = 0;
    for (int32_t t = 0; t < s.mesh->triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            const double *a = s.mesh->positions[s.mesh->triangles[t][c]];
            const double *b = s.mesh->positions[s.mesh->triangles[t][(c + 1) % 3]];
            const double origin[3] = {0.1, -0.05, 0.02};
            for (int at = 0; at <= 4; at++) {
                pel_ray ray;
                for (int k = 0; k < 3; k++) {
                    ray.origin[k] = origin[k];
                    ray.direction[k] = a[k] + 0.25 * at * (b[k] - a[k]) - origin[k];
                }
                check_ray(&s, &ray, true, &hits);
            }
        }
    assert_true(hits > 0);
    free_surface(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_all),
        cmocka_unit_test(test_watertight),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
