/* Energy and forces of the springs at any places, against the sum over all pairs of vertices. */
#include "random.h"
#include "refined/event_energy.h"
#include "sim/refine_fixture.h"

#include <stdlib.h>

/* J; forces (vertex_count) are those of springs that have a chosen end, on the chosen ones */
static double sum_of(const pel_model *model, const pel_state *state, const bool *chosen, double (*forces)[3])
{
    double sum = 0;
    for (int32_t i = 0; i < model->vertex_count; i++)
        for (int32_t slot = model->slot_begin[i / PEL_WIDTH]; slot < model->slot_end[i / PEL_WIDTH]; slot++) {
            int32_t j = model->neighbours[slot][i % PEL_WIDTH];
            if (j == i || !(chosen[i] || chosen[j]))
                continue;
            double x[3], y[3], k = (double)model->stiffnesses[slot][i % PEL_WIDTH];
            pel_vertex_position(state->position, i, x);
            pel_vertex_position(state->position, j, y);
            double length = pel_vec3_distance(x, y);
            double stretch = length - (double)model->rest_lengths[slot][i % PEL_WIDTH];
            /* seen from both ends */
            sum += 0.25 * k * stretch * stretch;
            for (int c = 0; chosen[i] && c < 3; c++)
                forces[i][c] += k * stretch * (y[c] - x[c]) / length;
        }
    return sum;
}

static void test_sums(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(4);
    pel_body_def body = ball(mesh, 1);
    pel_sim_def def = pel_sim_def_default();
    bench made = begin(mesh, &body, &def);
    refine(&made, 13, 1);
    const pel_model *model = made.sim->model;
    const size_t count = (size_t)model->vertex_count;
    random_state random = {49};
    bool *chosen = malloc(count * sizeof *chosen);
    int32_t *places = malloc(count * sizeof *places);
    double(*expected)[3] = malloc(count * sizeof *expected);
    pel_record *forces = calloc(count, sizeof *forces);
    assert_true(chosen != NULL && places != NULL && expected != NULL && forces != NULL);
    for (size_t v = 0; v < count; v++)
        for (int c = 0; c < 3; c++)
            made.sim->state->position[v][c] += (pel_real)random_between(&random, -0.05, 0.05);
    for (int round = 0; round < 20; round++) {
        int32_t place_count = 0;
        /* none, one, some, all */
        for (int32_t v = 0; v < model->vertex_count; v++) {
            chosen[v] = round == 1 ? v == 7 : round == 19 || (round > 0 && random_between(&random, 0, 20) < round);
            if (chosen[v])
                places[place_count++] = v;
        }
        memset(forces, 0, count * sizeof *forces);
        memset(expected, 0, count * sizeof *expected);
        double sum = sum_of(model, made.sim->state, chosen, expected), size = sum + 1;
        assert_near(pel_event_energy(made.sim->active, 0, made.sim->state, places, place_count, NULL), sum,
                    rounding(1e-12, 1e-4) * size);
        assert_near(pel_event_energy(made.sim->active, 0, made.sim->state, places, place_count, forces), sum,
                    rounding(1e-12, 1e-4) * size);
        for (size_t v = 0; v < count; v++)
            for (int c = 0; c < 3; c++)
                assert_near((double)forces[v][c], expected[v][c], rounding(1e-12, 1e-4));
        /* no mark is left */
        for (size_t v = 0; v < count; v++)
            assert_false(made.sim->active->is_dirty[v]);
        assert_true((sum > 0) == (place_count > 0));
    }
    free(chosen);
    free(places);
    free(expected);
    free(forces);
    end(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_sums)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
