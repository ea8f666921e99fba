/* Triangles in lanes against the single element: the same bits, whatever the number of triangles and their order. */
#include "random.h"
#include "tangent_fixture.h"

#include "force/tangent_body.h"

enum { STRAINS = PEL_MEMBRANE_STRAINS + PEL_MIDEDGE_STRAINS, MOST = 7 };

/* a ball that is shaken, with stresses of its own and a step */
static tangents make_shaken(pel_membrane_kind kind, pel_bending_model bending, random_state *random, double **step)
{
    pel_mesh *mesh = make_irregular_ball(2, random);
    pel_body_def body = shell_body(mesh, kind);
    body.shell.bending.model = bending;
    body.shell.bending.stiffness.value = 2;
    tangents on = make_tangents(&body);
    pel_mesh_destroy(mesh);
    *step = calloc((size_t)on.count, sizeof **step);
    for (int32_t u = 0; u < on.count; u++)
        if (u >= 3 * on.pattern->vertex_count || on.model->mass[u / 3] > 0)
            (*step)[u] = random_between(random, -0.05, 0.05);
    pel_tangent_advance(on.tangent, on.unknowns, *step, 1, NULL);
    for (int32_t i = 0; i < on.pattern->stress_count; i++)
        on.stresses[i] = random_between(random, -300, 300);
    return on;
}

/* the same by the elements of one triangle */
static void evaluate_single(const pel_tangent_loop *loop, const pel_tangent_part *part, int32_t t, double *gradient,
                            double *matrix, double *extrapolated, pel_tangent_energy *energy)
{
    const pel_tangent *tangent = loop->tangent;
    const pel_tangent_shell *own = &tangent->shells[part->shell];
    const int32_t *nodes = tangent->nodes + tangent->node_begin[part->first + t];
    const int vertices = tangent->pattern.vertex_count, place = part->first_stress + t * part->strains;
    double x[9], step[PEL_TANGENT_UNKNOWNS] = {0}, alpha[3], sign[3];
    pel_tangent_points(loop->input->unknowns, nodes, 3, x);
    if (loop->step != NULL)
        pel_tangent_points(loop->step, nodes, 3, step);
    const pel_tangent_sum sum = {gradient, matrix, part->unknowns};
    pel_tangent_request request = {.kind = loop->input->kind, .step = loop->step != NULL ? step : NULL};
    for (int k = 0; own->midedges != NULL && k < 3; k++) {
        const int32_t e = pel_tangent_edge_of(own->edges[t][k], &sign[k]);
        alpha[k] = tangent->half_angles[e] + sign[k] * loop->input->unknowns[3 * vertices + e];
        step[9 + k] = loop->step != NULL ? loop->step[3 * vertices + e] : 0;
    }
    request.stress = loop->input->stresses != NULL ? loop->input->stresses + place : NULL;
    request.extrapolated = extrapolated;
    if (own->shell->has_membrane) {
        const pel_membrane_law law = pel_shell_law(own->shell, t);
        energy->membrane += pel_membrane_tangent(&own->rests[t], &law, x, &request, &sum);
    }
    request.stress = request.stress != NULL ? request.stress + PEL_MEMBRANE_STRAINS : NULL;
    request.extrapolated = extrapolated != NULL ? extrapolated + PEL_MEMBRANE_STRAINS : NULL;
    if (own->midedges != NULL)
        energy->edges += pel_midedge_tangent(&own->midedges[t], alpha, sign, x, &request, &sum);
}

static void compare(const pel_tangent_loop *loop, const int32_t *triangles, int32_t count, double *gradients,
                    double *matrices)
{
    const pel_tangent_part *part = loop->tangent->parts;
    const int n = part->unknowns;
    pel_tangent_energy all = {0}, single = {0};
    assert_int_equal(part->kind, PEL_TANGENT_PART_TRIANGLES);
    pel_tangent_triangles(loop, part, triangles, count, gradients, matrices, &all);
    for (int32_t k = 0; k < count; k++) {
        double gradient[PEL_TANGENT_UNKNOWNS] = {0}, matrix[PEL_TANGENT_UNKNOWNS * PEL_TANGENT_UNKNOWNS] = {0};
        double extrapolated[STRAINS] = {0};
        evaluate_single(loop, part, triangles[k], gradients != NULL ? gradient : NULL, matrices != NULL ? matrix : NULL,
                        loop->stresses != NULL ? extrapolated : NULL, &single);
        if (gradients != NULL)
            assert_memory_equal(gradients + k * n, gradient, (size_t)n * sizeof *gradient);
        if (matrices != NULL)
            assert_memory_equal(matrices + k * n * n, matrix, (size_t)(n * n) * sizeof *matrix);
        const int32_t place = part->first_stress + triangles[k] * part->strains;
        for (int i = 0; loop->stresses != NULL && i < part->strains; i++)
            assert_true(loop->stresses[place + i] == extrapolated[i]);
    }
    assert_true(all.membrane == single.membrane && all.edges == single.edges);
}

static void compare_all(const tangents *on, const double *step, random_state *random)
{
    double gradients[MOST * PEL_TANGENT_UNKNOWNS], matrices[MOST * PEL_TANGENT_UNKNOWNS * PEL_TANGENT_UNKNOWNS];
    double *stresses = calloc((size_t)on->pattern->stress_count + 1, sizeof *stresses);
    for (int32_t count = 1; count <= MOST; count++)
        for (int form = 0; form < 4; form++) {
            int32_t triangles[MOST];
            const pel_tangent_input input = {.unknowns = on->unknowns,
                                             .kind = form & 1 ? PEL_TANGENT_POSITIVE : PEL_TANGENT_EXACT,
                                             .stresses = form & 2 ? on->stresses : NULL};
            pel_tangent_evaluate(on->tangent, &input, NULL, NULL);
            for (int32_t k = 0; k < count; k++)
                triangles[k] = (int32_t)random_integer(random, 0, on->tangent->parts->count - 1);
            pel_tangent_loop loop = {.tangent = on->tangent, .input = &input};
            compare(&loop, triangles, count, NULL, NULL);
            compare(&loop, triangles, count, gradients, NULL);
            compare(&loop, triangles, count, NULL, matrices);
            loop.step = step;
            loop.stresses = stresses;
            compare(&loop, triangles, count, NULL, NULL);
        }
    free(stresses);
}

static void lanes_have_the_bits_of_single_triangles(void **unused)
{
    (void)unused;
    random_state random = {3};
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++)
        for (int has_bending = 0; has_bending < 2; has_bending++) {
            double *step;
            tangents on = make_shaken((pel_membrane_kind)kind, has_bending ? PEL_BENDING_MIDEDGE : PEL_BENDING_NONE,
                                      &random, &step);
            compare_all(&on, step, &random);
            free(step);
            free_tangents(&on);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(lanes_have_the_bits_of_single_triangles)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
