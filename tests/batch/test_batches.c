/* The layout of elements: each once, colours and bundles without conflicts, numbers at rest; after refinement the same
   as a new layout. */
#include "failing_malloc.h"
#include "shell_fixture.h"

#include "batch/batches.h"
#include "refined/refined_model.h"

#include <stdlib.h>

static const pel_method methods[4] = {PEL_METHOD_EXPLICIT, PEL_METHOD_PBD, PEL_METHOD_PBD_DISTANCE, PEL_METHOD_XPBD};

/* everything that a shell can have; weights: of the pressure and of one region, or null */
static pel_body_def full_body(const pel_mesh *mesh, pel_anisotropy_def regions[2], const double *weights)
{
    regions[0] = regions[1] = pel_anisotropy_def_default();
    regions[0].mode = PEL_FIBRE_STRAIN;
    regions[0].weights = weights;
    regions[1].mode = PEL_FIBRE_ACTIVE;
    regions[1].direction = PEL_FIBRE_PRINCIPAL;
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.anisotropies = regions;
    body.shell.anisotropy_count = 2;
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body.shell.pressure.outside.value = 1;
    body.shell.pressure.weights = weights;
    return body;
}

static pel_batches *make_batches(const pel_model *model, pel_method method)
{
    pel_batches *batches;
    assert_int_equal(pel_batches_create(model, method, &batches, NULL), PEL_OK);
    return batches;
}

static int32_t place_at(const pel_batch *batch, int32_t block, int k, int32_t lane)
{
    return batch->steps[(block * batch->arity + k) * PEL_BLOCK + lane] / PEL_STEP;
}

/* ---- every element once ---- */

static int compare_places(const void *a, const void *b)
{
    return memcmp(a, b, 4 * sizeof(int32_t));
}

/* adds a list of vertices, as it stands, to a sorted set of rows of four */
static void add_row(int32_t (*rows)[4], int32_t *count, const int32_t *vertices, int arity)
{
    for (int k = 0; k < 4; k++)
        rows[*count][k] = k < arity ? vertices[k] : -1;
    (*count)++;
}

/* the used lanes of a batch are exactly the expected rows, and other lanes repeat one of their block */
static void check_elements(const pel_batch *batch, int32_t (*expected)[4], int32_t expected_count)
{
    int32_t count = 0, (*rows)[4] = calloc((size_t)batch->block_count * PEL_BLOCK + 1, sizeof *rows);
    for (int32_t block = 0; block < batch->block_count; block++) {
        int32_t used = batch->lane_counts[block];
        assert_true(used > 0 && used <= PEL_BLOCK);
        for (int32_t lane = 0; lane < PEL_BLOCK; lane++) {
            int32_t vertices[4];
            bool repeats = false;
            for (int k = 0; k < batch->arity; k++)
                vertices[k] = place_at(batch, block, k, lane);
            for (int32_t other = 0; other < used; other++) {
                bool same = true;
                for (int k = 0; k < batch->arity; k++)
                    same &= place_at(batch, block, k, other) == vertices[k];
                repeats |= same;
            }
            assert_true(repeats);
            if (lane < used)
                add_row(rows, &count, vertices, batch->arity);
        }
    }
    assert_int_equal(count, expected_count);
    qsort(rows, (size_t)count, sizeof *rows, compare_places);
    qsort(expected, (size_t)count, sizeof *expected, compare_places);
    assert_memory_equal(rows, expected, (size_t)count * sizeof *rows);
    free(rows);
}

static bool may_move(const pel_model *model, const int32_t *vertices, int arity)
{
    for (int k = 0; k < arity; k++)
        if (model->inverse_mass[vertices[k]] > 0)
            return true;
    return false;
}

/* the expected content of a batch, element by element from the model */
static int32_t expect(const pel_batches *batches, const pel_batch *batch, int32_t (*rows)[4])
{
    const pel_model *model = batches->model;
    const pel_shell *shell = model->bodies[0].shell;
    bool fibres = batch->region >= 0, hinges = batch->arity == 4, pressure = batch->kind == PEL_CONSTRAINT_PRESSURE;
    int32_t count = 0;
    int32_t total = fibres   ? shell->regions[batch->region].fibre_count
                    : hinges ? shell->hinge_count
                             : shell->triangle_count;
    for (int32_t i = 0; i < total; i++) {
        int32_t t = fibres ? pel_shell_fibre_triangle(&shell->regions[batch->region], i) : i;
        const pel_shell_hinge hinge = hinges ? pel_shell_hinge_of(shell, i) : (pel_shell_hinge){0};
        const int32_t *vertices = hinges ? hinge.vertices : shell->corners[t];
        bool pressed = !pressure || shell->pressure_weights == NULL || shell->pressure_weights[t] != 0;
        bool moves = may_move(model, vertices, batch->arity) || !batches->is_projected;
        if (pressure ? pressed : moves)
            add_row(rows, &count, vertices, batch->arity);
    }
    return count;
}

/* blocks that are computed together share no vertex */
static void check_groups(const pel_batch *batch, int32_t begin, int32_t end)
{
    for (int32_t block = begin; block < end;) {
        int32_t places[PEL_BATCH_GROUP * 4 * PEL_BLOCK], count = 0;
        /* a batch that shares its elements has no own groups */
        int32_t last = block + (batch->followers != NULL ? batch->followers[block] : 0);
        assert_true(last - block < PEL_BATCH_GROUP && last < end);
        for (; block <= last; block++)
            for (int32_t lane = 0; lane < batch->lane_counts[block]; lane++)
                for (int k = 0; k < batch->arity; k++)
                    places[count++] = place_at(batch, block, k, lane);
        for (int32_t a = 0; a < count; a++)
            for (int32_t b = 0; b < a; b++)
                assert_int_not_equal(places[a], places[b]);
    }
}

/* no vertex is in two bundles of a phase, over all batches */
static void check_phases(const pel_batches *batches)
{
    int32_t *owner = calloc((size_t)batches->model->vertex_count, sizeof *owner);
    for (int phase = 0; phase < PEL_PHASE_COUNT; phase++) {
        memset(owner, 0, (size_t)batches->model->vertex_count * sizeof *owner);
        for (int32_t n = batches->phase_begin[phase]; n < batches->phase_begin[phase + 1]; n++) {
            const pel_body_batches *body = &batches->bodies[batches->bundles[n].body];
            int32_t number = batches->bundles[n].number;
            for (int32_t i = 0; i < body->batch_count; i++) {
                const pel_batch *batch = &body->batches[i];
                int32_t width = batch->arity * PEL_BLOCK, end = batch->bundle_begin[number + 1];
                check_groups(batch, batch->bundle_begin[number], end);
                for (int32_t at = batch->bundle_begin[number] * width; at < end * width; at++) {
                    int32_t v = batch->steps[at] / PEL_STEP;
                    assert_true(owner[v] == 0 || owner[v] == n + 1);
                    owner[v] = n + 1;
                }
            }
        }
    }
    free(owner);
}

static void check_layout(const pel_model *model, pel_method method)
{
    pel_batches *batches = make_batches(model, method);
    const pel_body_batches *body = &batches->bodies[0];
    int32_t(*rows)[4] = calloc(2 * (size_t)model->triangle_count, sizeof *rows), kinds = 0;
    for (int32_t i = 0; i < body->batch_count; i++) {
        const pel_batch *batch = &body->batches[i];
        bool is_moved = method == PEL_METHOD_PBD || method == PEL_METHOD_XPBD;
        if (batch->arity == 2)
            continue;
        check_elements(batch, rows, expect(batches, batch, rows));
        assert_true(batch->is_projected == (is_moved && batch->kind != PEL_CONSTRAINT_PRESSURE));
        kinds++;
    }
    assert_int_equal(kinds, 5);
    check_phases(batches);
    free(rows);
    pel_batches_destroy(batches);
}

/* with one piece and several, weights that leave triangles out, and a cap that cannot move */
static void test_layout(void **unused)
{
    (void)unused;
    for (int32_t frequency = 1; frequency <= 32; frequency *= 4) {
        pel_mesh *mesh = make_sphere(frequency);
        size_t count = (size_t)mesh->vertex_count;
        double *weights = calloc(count, sizeof *weights);
        int32_t *pinned = calloc(count, sizeof *pinned);
        pel_anisotropy_def regions[2];
        for (int form = 0; form < 2; form++) {
            pel_body_def body = full_body(mesh, regions, form == 1 ? weights : NULL);
            for (int32_t v = 0; v < mesh->vertex_count; v++) {
                weights[v] = fmax(0, mesh->positions[v][2]);
                if (form == 1 && mesh->positions[v][0] > 0.5)
                    pinned[body.pinned_count++] = v;
            }
            body.pinned = pinned;
            pel_model *model = make_model(&body);
            for (int m = 0; m < 4; m++)
                check_layout(model, methods[m]);
            pel_model_destroy(model);
        }
        free(pinned);
        free(weights);
        pel_mesh_destroy(mesh);
    }
}

/* an unweighted pressure on all triangles shares the triangles of the membrane */
static void test_sharing(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(4);
    pel_anisotropy_def regions[2];
    pel_body_def body = full_body(mesh, regions, NULL);
    for (int on = 0; on < 2; on++) {
        body.shell.membrane.on = on == 1;
        body.shell.bending.stiffness.value = 1;
        regions[0].stiffness = regions[1].stiffness = 1;
        pel_model *model = make_model(&body);
        pel_batches *batches = make_batches(model, PEL_METHOD_XPBD);
        const pel_body_batches *own = &batches->bodies[0];
        const pel_batch *pressure = &own->batches[own->batch_count - 1];
        assert_int_equal(pressure->kind, PEL_CONSTRAINT_PRESSURE);
        assert_true(pressure->is_shared == (on == 1));
        assert_true((pressure->steps == own->batches[0].steps) == (on == 1));
        pel_batches_destroy(batches);
        pel_model_destroy(model);
    }
    pel_mesh_destroy(mesh);
}

/* ---- numbers ---- */

static void test_numbers(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(3);
    pel_anisotropy_def regions[2];
    pel_body_def def = full_body(mesh, regions, NULL);
    pel_model *model = make_model(&def);
    pel_batches *batches = make_batches(model, PEL_METHOD_XPBD);
    double tolerance = sizeof(pel_real) == 8 ? 1e-11 : 1e-3;
    for (int32_t i = 0; i < batches->bodies[0].batch_count; i++) {
        const pel_batch *batch = &batches->bodies[0].batches[i];
        for (int32_t e = 0; e < batch->block_count * PEL_BLOCK; e++) {
            double x[4][3], f[2][3];
            int32_t vertices[4];
            for (int k = 0; k < batch->arity; k++)
                vertices[k] = place_at(batch, e / PEL_BLOCK, k, e % PEL_BLOCK);
            pel_load_points(model->rest, vertices, batch->arity, x);
            if (batch->kind == PEL_CONSTRAINT_STRAIN + PEL_MEMBRANE_STVK) {
                /* F of the rest shape is a rotation */
                for (int c = 0; c < 3; c++) {
                    double a = x[0][c] - x[2][c], b = x[1][c] - x[2][c];
                    f[0][c] = (double)*pel_batch_number(batch, e, 0) * a;
                    f[1][c] = (double)*pel_batch_number(batch, e, 1) * a + (double)*pel_batch_number(batch, e, 2) * b;
                }
                assert_near(pel_vec3_dot(f[0], f[0]), 1, tolerance);
                assert_near(pel_vec3_dot(f[1], f[1]), 1, tolerance);
                assert_near(pel_vec3_dot(f[0], f[1]), 0, tolerance);
                double stiffness = 1e5 * 0.01 * pel_vec3_triangle_area(x[0], x[1], x[2]);
                assert_near((double)*pel_batch_number(batch, e, 3) * stiffness, 1, tolerance);
            }
            if (batch->arity == 4) {
                double angle = pel_dihedral_angle((const double(*)[3])x, NULL);
                assert_near((double)*pel_batch_number(batch, e, 0), cos(angle), tolerance);
                assert_near((double)*pel_batch_number(batch, e, 1), sin(angle), tolerance);
                double area = pel_vec3_triangle_area(x[0], x[1], x[2]) + pel_vec3_triangle_area(x[1], x[0], x[3]);
                double length = pel_vec3_distance(x[0], x[1]), stiffness = 1e5 * 1e-6 / (12 * 0.91) * length * length;
                assert_near((double)*pel_batch_number(batch, e, 2) * stiffness / area, 1, tolerance);
            }
        }
    }
    pel_batches_destroy(batches);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* each vertex of a surface that caves in goes by the mean of its triangles, weighted by area: their shares of it sum to
   1. A body that does not refine keeps nothing of what laid out its elements. */
static void test_shares(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(4);
    pel_anisotropy_def regions[2];
    pel_body_def def = full_body(mesh, regions, NULL);
    regions[1].mode = PEL_FIBRE_CAVE;
    regions[1].strength = 0.1;
    pel_model *model = make_model(&def);
    pel_batches *batches = make_batches(model, PEL_METHOD_XPBD);
    const pel_body_batches *own = &batches->bodies[0];
    double *sums = calloc((size_t)model->vertex_count, sizeof *sums);
    assert_null(own->scratch);
    int32_t triangles = 0;
    for (int32_t i = 0; i < own->batch_count; i++) {
        const pel_batch *batch = &own->batches[i];
        for (int32_t b = 0; batch->kind == PEL_CONSTRAINT_CAVE && b < batch->block_count; b++)
            for (int32_t lane = 0; lane < batch->lane_counts[b]; lane++, triangles++)
                for (int k = 0; k < 3; k++)
                    sums[place_at(batch, b, k, lane)] +=
                        (double)*pel_batch_number(batch, b * PEL_BLOCK + lane, PEL_CAVE_SHARE + k);
    }
    assert_int_equal(triangles, mesh->triangle_count);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        assert_near(sums[model->bodies[0].model_index[v]], 1, sizeof(pel_real) == 8 ? 1e-12 : 1e-5);
    free(sums);
    pel_batches_destroy(batches);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* ---- refinement ---- */

static void compare_batches(const pel_batch *a, const pel_batch *b, int32_t bundles)
{
    size_t lanes = (size_t)a->block_count * PEL_BLOCK;
    assert_int_equal(a->kind, b->kind);
    assert_int_equal(a->block_count, b->block_count);
    assert_true(a->block_count <= a->capacity);
    assert_memory_equal(a->bundle_begin, b->bundle_begin, ((size_t)bundles + 1) * sizeof *a->bundle_begin);
    assert_memory_equal(a->lane_counts, b->lane_counts, (size_t)a->block_count);
    assert_memory_equal(a->followers, b->followers, (size_t)a->block_count);
    assert_memory_equal(a->steps, b->steps, lanes * (size_t)a->arity * sizeof *a->steps);
    if (a->number_count > 0)
        assert_memory_equal(a->numbers, b->numbers, lanes * (size_t)a->number_count * sizeof *a->numbers);
}

/* after events of refinement a layout equals a new one, and no memory was allocated */
static void test_rebuild(void **unused)
{
    (void)unused;
    random_state random = {3};
    pel_mesh *mesh = make_sphere(6);
    pel_anisotropy_def regions[2];
    pel_body_def def = full_body(mesh, regions, NULL);
    def.spring_stiffness.value = 1;
    def.refine.levels = 2;
    pel_model *model = make_model(&def);
    for (int m = 0; m < 4; m++) {
        pel_refined_model *active;
        pel_state *state;
        assert_int_equal(pel_refined_create(model, &active, NULL), PEL_OK);
        assert_int_equal(pel_state_create(&active->model, false, &state, NULL), PEL_OK);
        pel_batches *kept = make_batches(&active->model, methods[m]);
        pel_front *front = active->bodies[0].front;
        for (int round = 0; round < 4; round++) {
            for (int n = 0; n < 20; n++)
                pel_front_mark(front, (int32_t)random_integer(&random, 0, front->node_begin[2] - 1), round < 3);
            pel_front_close(front);
            pel_refined_commit(active, 0, state);
            failing_malloc_begin(0);
            pel_batches_rebuild(kept, 0);
            assert_int_equal(failing_malloc_end().calls, 0);
            pel_batches *fresh = make_batches(&active->model, methods[m]);
            assert_int_equal(kept->bodies[0].batch_count, fresh->bodies[0].batch_count);
            for (int32_t i = 0; i < kept->bodies[0].batch_count; i++)
                compare_batches(&kept->bodies[0].batches[i], &fresh->bodies[0].batches[i],
                                pel_bundle_count(&kept->bodies[0].pieces));
            pel_batches_destroy(fresh);
        }
        assert_true(front->triangle_count > mesh->triangle_count);
        pel_batches_destroy(kept);
        pel_state_destroy(state);
        pel_refined_destroy(active);
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* ---- pieces ---- */

/* elements in the bundles from first on, by all elements of a batch */
static double share_from(const pel_batch *batch, int32_t first, int32_t bundle_count)
{
    int32_t some = 0, all = 0;
    for (int32_t block = 0; block < batch->bundle_begin[bundle_count]; block++) {
        all += batch->lane_counts[block];
        some += block >= batch->bundle_begin[first] ? batch->lane_counts[block] : 0;
    }
    return (double)some / all;
}

/* pieces of one size, as many as `expected`; next to nothing is left for the bundle that runs alone */
static void check_pieces(pel_mesh *mesh, int32_t expected)
{
    pel_anisotropy_def regions[2];
    pel_body_def def = full_body(mesh, regions, NULL);
    pel_model *model = make_model(&def);
    pel_batches *batches = make_batches(model, PEL_METHOD_PBD);
    const pel_body_batches *body = &batches->bodies[0];
    int32_t count = body->pieces.piece_count, *sizes = calloc((size_t)count, sizeof *sizes);
    assert_int_equal(count, expected);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        sizes[body->pieces.piece_of_place[model->bodies[0].model_index[v] - body->pieces.first_place]]++;
    for (int32_t i = 0; i < count; i++)
        assert_true(abs(sizes[i] - mesh->vertex_count / count) <= 1);
    for (int32_t i = 0; count > 1 && i < body->batch_count; i++)
        assert_true(share_from(&body->batches[i], 2 * count - 1, 2 * count) <= 0.02);
    free(sizes);
    pel_batches_destroy(batches);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* one piece below 1,024 vertices; a tenth of the mesh within 512 and 2,048, an even number; more where rings are wide
 */
static void test_pieces(void **unused)
{
    (void)unused;
    check_pieces(make_sphere(10), 1);                                   /* 1,002 vertices */
    check_pieces(make_sphere(11), 2);                                   /* 1,212 */
    check_pieces(make_sphere(16), 6);                                   /* 2,562: 427 each */
    check_pieces(make_sphere(32), 10);                                  /* 10,242: 1,024 each */
    check_pieces(make_grid(200, 200, 1, 1, PEL_GRID_ONE_DIAGONAL), 20); /* 40,401: 2,020 each */
    if (is_slow())
        return;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_CYLINDER);
    def.slices = 1500;
    def.segments = 5;
    check_pieces(make_shape(&def), 154); /* wide caps */
}

/* ---- creation ---- */

static pel_method created_method;

static pel_status create_batches(const void *model, pel_error *error)
{
    pel_batches *batches;
    pel_status status = pel_batches_create(model, created_method, &batches, error);
    assert_true((batches == NULL) == (status != PEL_OK));
    pel_batches_destroy(batches);
    return status;
}

static void test_every_allocation(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(2);
    pel_anisotropy_def regions[2];
    pel_body_def def = full_body(mesh, regions, NULL);
    regions[1].mode = PEL_FIBRE_CAVE;
    regions[1].strength = 0.1;
    pel_model *model = make_model(&def);
    for (int m = 0; m < 4; m++) {
        created_method = methods[m];
        assert_true(for_every_allocation_failure(create_batches, model) > 20);
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_layout),           cmocka_unit_test(test_sharing), cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_rebuild),          cmocka_unit_test(test_shares),  cmocka_unit_test(test_pieces),
        cmocka_unit_test(test_every_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
