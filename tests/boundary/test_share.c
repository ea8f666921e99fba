/* Parts of a load in total: closed forms on each kind of region, cuts, and answers of whole bodies. */
#include "boundary/share.h"
#include "failing_malloc.h"
#include "random.h"
#include "shell_fixture.h"
#include "sim/solid_fixture.h"

#include "boundary/loads.h"
#include "math/vec3.h"
#include "pellicle/tear.h"

/* an uneven plate of 1 x 1 */
static pel_mesh *make_plate(uint64_t seed)
{
    random_state random = {seed};
    pel_mesh *mesh = make_irregular_patch(6, &random);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double *x = mesh->positions[v];
        /* along its border too */
        for (int c = 0; c < 2; c++)
            x[c] += 0.12 * (x[c] + 0.5) * (0.5 - x[c]) * (1 + x[1 - c]);
    }
    return mesh;
}

static double *shares_of(const pel_model *model, int32_t *vertices, int32_t count)
{
    pel_load_def load = pel_load_def_default();
    double *shares = malloc(sizeof *shares * (size_t)count), sum = 0;
    load.vertices = vertices;
    load.vertex_count = count;
    for (int32_t i = 0; i < count; i++)
        shares[i] = 1;
    assert_int_equal(pel_load_share(model, &load, shares, NULL), PEL_OK);
    for (int32_t i = 0; i < count; i++)
        sum += shares[i];
    assert_near(sum, 1, 1e-12);
    return shares;
}

/* the numbers of vertices that lie in a box */
static int32_t find_box(const pel_mesh *mesh, const double low[3], const double high[3], int32_t *vertices)
{
    int32_t count = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        bool is_in = true;
        for (int c = 0; c < 3; c++)
            is_in &= mesh->positions[v][c] > low[c] - 1e-9 && mesh->positions[v][c] < high[c] + 1e-9;
        if (is_in)
            vertices[count++] = v;
    }
    return count;
}

/* The moments of the parts are those of an even force: of a whole plate, of one side, of a line across. */
static void test_regions(void **unused)
{
    (void)unused;
    static const struct {
        double low[3], high[3];
    } rows[] = {{{-1, -1, 0}, {1, 1, 0}}, {{0.5, -1, 0}, {1, 1, 0}}, {{-1, -0.5, 0}, {1, -0.5, 0}}};
    pel_mesh *mesh = make_plate(3);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    pel_model *model = make_model(&body);
    int32_t *region = calloc((size_t)mesh->vertex_count, sizeof *region);
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        int32_t count = find_box(mesh, rows[r].low, rows[r].high, region);
        assert_true(count > 6);
        double *shares = shares_of(model, region, count), center[3] = {0, 0, 0};
        for (int32_t i = 0; i < count; i++)
            pel_vec3_along(center, shares[i], mesh->positions[region[i]], center);
        for (int c = 0; c < 2; c++)
            assert_near(center[c], fabs(rows[r].low[c]) < 1 ? rows[r].low[c] : 0, 1e-12);
        free(shares);
    }
    free(region);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* Half an edge to each of its ends, on a line inside; a triangle and a vertex that no triangle of the region has take
   the triangles around; without edges the parts are equal, however long the edges around are. */
static void test_few(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(4, 2, 4, 2, PEL_GRID_ONE_DIAGONAL);
    int32_t line[3], apart[4], four[4];
    for (int k = 0; k < 3; k++)
        line[k] = nearest_vertex(mesh, -1 + k, 0, 0);
    mesh->positions[line[1]][0] -= 0.4;
    apart[0] = apart[3] = line[0];
    apart[1] = nearest_vertex(mesh, 2, 1, 0);
    apart[2] = nearest_vertex(mesh, 1, -1, 0);
    memcpy(four, line, sizeof line);
    four[3] = nearest_vertex(mesh, 1, 1, 0);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    pel_model *model = make_model(&body);
    double *shares = shares_of(model, line, 3);
    assert_near(shares[0], 0.15, 1e-12);
    assert_near(shares[1], 0.5, 1e-12);
    assert_near(shares[2], 0.35, 1e-12);
    free(shares);
    shares = shares_of(model, apart, 4);
    for (int k = 0; k < 4; k++)
        assert_near(shares[k], k % 3 == 0 ? 1.0 / 6 : 1.0 / 3, 1e-12);
    free(shares);
    shares = shares_of(model, line, 1);
    assert_near(shares[0], 1, 0);
    free(shares);
    shares = shares_of(model, four, 4);
    assert_true(shares[3] < shares[2]);
    free(shares);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* A plate drawn by one side moves evenly, by the stretch s with F / (E t) = s (s^2 - 1) / 2. */
static void test_pull(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_plate(5);
    int32_t pull[32], count = find_box(mesh, (double[]){0.5, -1, 0}, (double[]){1, 1, 0}, pull);
    int32_t hold[32], held = find_box(mesh, (double[]){-1, -1, 0}, (double[]){-0.5, 1, 0}, hold);
    pel_body_def body = pel_body_def_sheet("plate", mesh, 1e5, 0.01, 1000);
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    body.shell.membrane.poisson = 0;
    stage s = {.mesh = mesh, .model = make_model(&body)};
    pel_sim_def def = lone_sim(s.model, PEL_METHOD_STATIC, 1);
    pel_load_def load = pel_load_def_default();
    pel_support_def supports[3] = {pel_support_def_default(), pel_support_def_default(), pel_support_def_default()};
    supports[0].vertices = supports[1].vertices = hold;
    supports[0].vertex_count = held;
    supports[1].vertex_count = 1;
    supports[0].fix[1] = supports[1].fix[0] = supports[1].fix[2] = false;
    supports[2].vertices = pull;
    supports[2].vertex_count = count;
    supports[2].fix[0] = supports[2].fix[1] = false;
    load.vertices = pull;
    load.vertex_count = count;
    load.force[0] = 100;
    def.loads = &load;
    def.load_count = 1;
    def.supports = supports;
    def.support_count = 3;
    s.sim = make_sim(&def);
    run_steps(s.sim, 2);
    double *x = positions_of(&s), stretch = x[3 * pull[0]] + 0.5;
    assert_near(stretch * (stretch * stretch - 1) / 2, 0.1, IN_FLOAT(1e-6, 1e-3));
    for (int32_t i = 0; i < count; i++)
        assert_near(x[3 * pull[i]] + 0.5, stretch, IN_FLOAT(1e-6, 1e-3));
    free(x);
    end_stage(&s);
}

/* A cut leaves the place of the force: copies have together what the vertex had, by the areas around them. */
static void test_copies(void **unused)
{
    (void)unused;
    stage s = {.mesh = make_plate(7)};
    int32_t path[16], lines = 0, end[16];
    int32_t count = find_box(s.mesh, (double[]){-1, 0.5, 0}, (double[]){1, 1, 0}, end);
    pel_body_def body = shell_body(s.mesh, PEL_MEMBRANE_STVK);
    static const int32_t pins[3] = {0, 1, 2};
    body.pinned = pins;
    body.pinned_count = 3;
    s.model = make_model(&body);
    /* from the loaded side into the plate: along the middle column of the grid that it was */
    for (int j = 6; j >= 2; j--)
        path[lines++] = j * 7 + 3;
    for (int whole = 0; whole < 2; whole++) {
        pel_sim_def def = lone_sim(s.model, PEL_METHOD_STATIC, 1);
        pel_load_def load = pel_load_def_default();
        load.vertices = whole ? NULL : end;
        load.vertex_count = whole ? 0 : count;
        load.force[2] = 1;
        def.loads = &load;
        def.load_count = 1;
        s.sim = make_sim(&def);
        const pel_load *at = &s.sim->loads->items[0];
        double *before = calloc((size_t)s.mesh->vertex_count, sizeof *before);
        for (int32_t i = 0; i < at->vertex_count; i++)
            before[whole ? i : end[i]] = at->weights[i];
        assert_int_equal(pel_cut(s.sim, 0, path, lines, NULL), PEL_OK);
        at = &s.sim->loads->items[0];
        const pel_body *cut = &s.sim->given->bodies[0];
        const int32_t *origins = s.sim->given->def.bodies[0].origins;
        assert_int_equal(at->vertex_count, whole ? s.mesh->vertex_count + lines - 1 : count + 1);
        for (int32_t i = 0; i < at->vertex_count; i++) {
            int32_t v = whole ? i : i < count ? end[i] : s.mesh->vertex_count;
            while (!whole && i >= count && origins[v] != path[0])
                v++;
            assert_near(at->weights[i], before[origins[v]] * cut->shares[v], 1e-12);
        }
        free(before);
        pel_sim_destroy(s.sim);
    }
    s.sim = NULL;
    end_stage(&s);
}

/* the end of a bar: its triangles; the whole of it: its tetrahedra; a point inside: all */
/* of all vertices of a solid: a quarter of each tetrahedron */
static void check_quarters(const pel_mesh *mesh, const double *shares)
{
    double *parts = calloc((size_t)mesh->vertex_count, sizeof *parts), sum = 0;
    for (int32_t t = 0; t < mesh->tetrahedron_count; t++) {
        const int32_t *v = mesh->tetrahedra[t];
        double sides[3][3], normal[3];
        for (int k = 0; k < 3; k++)
            pel_vec3_subtract(mesh->positions[v[k + 1]], mesh->positions[v[0]], sides[k]);
        pel_vec3_cross(sides[0], sides[1], normal);
        const double volume = fabs(pel_vec3_dot(normal, sides[2]));
        sum += volume;
        for (int k = 0; k < 4; k++)
            parts[v[k]] += 0.25 * volume;
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        assert_near(shares[v], parts[v] / sum, 1e-12);
    free(parts);
}

static void test_solid(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_block(1, 1, 2, 0.4);
    int32_t *region = calloc((size_t)mesh->vertex_count, sizeof *region);
    pel_body_def body = solid_body(mesh, PEL_VOLUME_NEO_HOOKEAN, 1e5, 0.3);
    pel_model *model = make_model(&body);
    const double lows[2][3] = {{0, 0, 2}, {0, 0, 0}}, high[3] = {1, 1, 2};
    for (int r = 0; r < 2; r++) {
        int32_t count = find_box(mesh, lows[r], high, region);
        double *shares = shares_of(model, region, count), center[3] = {0, 0, 0};
        for (int32_t i = 0; i < count; i++)
            pel_vec3_along(center, shares[i], mesh->positions[region[i]], center);
        assert_near(center[0], 0.5, 1e-9);
        assert_near(center[1], 0.5, 1e-9);
        assert_near(center[2], r == 0 ? 2 : 1, 1e-9);
        if (count == mesh->vertex_count)
            check_quarters(mesh, shares);
        free(shares);
    }
    region[0] = nearest_vertex(mesh, 0.5, 0.5, 1);
    double *shares = shares_of(model, region, 1);
    assert_near(shares[0], 1, 0);
    free(shares);
    free(region);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static pel_status share(const void *data, pel_error *error)
{
    const pel_model *model = data;
    pel_load_def load = pel_load_def_default();
    double shares[49] = {0};
    return pel_load_share(model, &load, shares, error);
}

static void test_memory(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_plate(1);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    pel_model *model = make_model(&body);
    assert_true(for_every_allocation_failure(share, model) >= 4);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_regions), cmocka_unit_test(test_few),   cmocka_unit_test(test_pull),
        cmocka_unit_test(test_copies),  cmocka_unit_test(test_solid), cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
