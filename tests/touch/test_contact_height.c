/* Triangles that nearly collapse: those that are watched against heights by their definition. */
#include "contact/set.h"
#include "random.h"
#include "sim/contact_scene.h"
#include "stage/stage.h"

/* twice the area over the longest edge */
static double triangle_height(const int32_t *v, const pel_record *positions)
{
    double x[3][3], longest = 0, a[3], b[3], normal[3];
    for (int i = 0; i < 3; i++)
        pel_vertex_position(positions, v[i], x[i]);
    for (int i = 0; i < 3; i++) {
        pel_vec3_subtract(x[(i + 1) % 3], x[i], a);
        longest = fmax(longest, pel_vec3_length(a));
    }
    pel_vec3_subtract(x[1], x[0], a);
    pel_vec3_subtract(x[2], x[0], b);
    pel_vec3_cross(a, b, normal);
    return pel_vec3_length(normal) / longest;
}

/* a sheet squeezed along one axis, more and more, with noise; watched below 0.2 of the height at rest */
static void test_watched(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene_body(&scene, make_sheet(10, 0));
    pel_sim *sim = scene_create(&scene);
    const pel_contact_set *contacts = sim->contacts;
    random_state random = {7};
    int32_t fewest = INT32_MAX, most = 0;
    for (int trial = 0; trial < 40; trial++) {
        double squeeze = 0.6 - 0.015 * trial;
        for (int32_t v = 0; v < sim->model->vertex_count; v++)
            for (int k = 0; k < 2; k++) {
                double noise = random_between(&random, -0.01, 0.01);
                sim->state->position[v][k] =
                    (pel_real)(((double)sim->model->rest[v][k] + noise) * (k == 0 ? squeeze : 1));
            }
        assert_int_equal(pel_contact_heights_find(sim->contacts, sim->state->position, NULL), PEL_OK);
        const pel_contact_heights *heights = &contacts->heights;
        int32_t found = 0;
        for (int32_t t = 0; t < contacts->triangle_count; t++) {
            const int32_t *v = contacts->triangles[t];
            double share = triangle_height(v, sim->state->position) / triangle_height(v, sim->model->rest);
            bool is_watched = found < heights->list.count && heights->triangles[found] == t;
            /* not those on the edge of being watched */
            if (fabs(share - 0.2) > 1e-5)
                assert_int_equal(is_watched, share < 0.2);
            found += is_watched;
        }
        assert_int_equal(found, heights->list.count);
        fewest = found < fewest ? found : fewest;
        most = found > most ? found : most;
    }
    assert_int_equal(fewest, 0);
    assert_int_equal(most, contacts->triangle_count);
    scene_end(&scene, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_watched)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
