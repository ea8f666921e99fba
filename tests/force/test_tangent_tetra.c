/* Tetrahedra in lanes against single ones: energies and forces of all laws, strained and turned inside out. */
#include "sim/solid_fixture.h"

#include "force/tangent.h"
#include "measure/tetra.h"
#include "model/shell.h"

/* a block whose vertices have moved by up to a share of an edge, and scales of its tetrahedra (young times volume) */
enum { MOST = 4000 };
static const double edge = 0.25;

static void move(const pel_model *model, double share, double *unknowns)
{
    uint32_t random = 7;
    for (int32_t u = 0; u < 3 * model->vertex_count; u++) {
        random = random * 1664525u + 1013904223u;
        unknowns[u] = (double)model->rest[u / 3][u % 3] + share * edge * ((double)random / 4294967296.0 - 0.5);
    }
}

/* J; gradient (vertex_count x 3) */
static double sum_singly(const pel_model *model, const double *unknowns, double *gradient)
{
    const pel_shell *shell = model->bodies[0].shell;
    double energy = 0;
    memset(gradient, 0, 3 * (size_t)model->vertex_count * sizeof *gradient);
    for (int32_t t = 0; t < shell->tetrahedron_count; t++) {
        pel_rest_tetra rest;
        double at_rest[4][3], x[12], own[12] = {0};
        for (int k = 0; k < 4; k++) {
            pel_vertex_position(model->rest, shell->tetrahedra[t][k], at_rest[k]);
            pel_vec3_copy(unknowns + 3 * shell->tetrahedra[t][k], x + 3 * k);
        }
        assert_true(pel_rest_tetra_setup((const double(*)[3])at_rest, &rest));
        const pel_tangent_sum sum = {own, NULL, 12};
        energy += pel_tetra_tangent(&rest, &shell->solid, 1e4 * rest.volume, x, PEL_TANGENT_EXACT, &sum);
        for (int i = 0; i < 12; i++)
            gradient[3 * shell->tetrahedra[t][i / 3] + i % 3] += own[i];
    }
    return energy;
}

static void check_law(int kind, double share)
{
    pel_mesh *mesh = make_block(1, 1, 0.6, edge);
    const pel_body_def body = solid_body(mesh, kind, 1e4, 0.4);
    pel_model *model = make_model(&body);
    pel_tangent *tangent;
    double unknowns[MOST], single[MOST], together[MOST];
    assert_true(3 * model->vertex_count <= MOST);
    assert_int_equal(pel_tangent_create(model, &tangent, NULL), PEL_OK);
    memset(unknowns, 0, sizeof unknowns);
    move(model, share, unknowns);
    const pel_tangent_input input = {.unknowns = unknowns, .kind = PEL_TANGENT_EXACT};
    const double energy = sum_singly(model, unknowns, single);
    const pel_tangent_energy sum = pel_tangent_evaluate(tangent, &input, NULL, together);
    assert_near(sum.volume, energy, 1e-12 * energy);
    double largest = 0;
    for (int32_t u = 0; u < 3 * model->vertex_count; u++)
        largest = fabs(single[u]) > largest ? fabs(single[u]) : largest;
    for (int32_t u = 0; u < 3 * model->vertex_count; u++)
        assert_near(together[u], single[u], 1e-11 * largest);
    pel_tangent_destroy(tangent);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void test_laws(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < PEL_VOLUME_COUNT; kind++)
        for (int i = 0; i < 2; i++)
            check_law(kind, i == 0 ? 0.3 : 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_laws)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
