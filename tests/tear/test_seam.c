/* Seams: the load of an edge against closed forms, the force at which a strip opens, the time, and refusals. */
#include "shell_fixture.h"

#include "failing_malloc.h"
#include "pellicle/sim.h"
#include "pellicle/tear.h"
#include "tear/growth.h"

#define LENGTH 0.4
#define WIDTH 0.1
#define YOUNG 1e6
#define THICKNESS 1e-3
#define STRENGTH 50.0

typedef struct strip {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
} strip;

/* vertices with x from `low` to `high`, by y */
static int32_t column(const pel_mesh *mesh, double low, double high, int32_t *list)
{
    int32_t count = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (mesh->positions[v][0] >= low - 1e-9 && mesh->positions[v][0] <= high + 1e-9)
            list[count++] = v;
    for (int32_t i = 0; i < count; i++)
        for (int32_t j = i + 1; j < count; j++)
            if (mesh->positions[list[j]][1] < mesh->positions[list[i]][1]) {
                int32_t other = list[i];
                list[i] = list[j];
                list[j] = other;
            }
    return count;
}

static pel_body_def body_of(const pel_mesh *mesh, bool has_membrane)
{
    pel_body_def body = pel_body_def_sheet("shell", mesh, YOUNG, THICKNESS, 1000);
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    body.shell.membrane.poisson = 0;
    if (!has_membrane) {
        body.shell.membrane.on = false;
        body.spring_stiffness.value = 1e3;
        body.spring_damping.value = 20;
    }
    return body;
}

/* drawn along x by a load on one end that grows to `force` in `duration`; the other end is pinned */
static strip make_strip(pel_method method, double dt, double force, double duration, const pel_seam_def *seam)
{
    strip s = {.mesh = make_grid(16, 4, LENGTH, WIDTH, PEL_GRID_UNION_JACK)};
    int32_t pins[16], end[16];
    pel_body_def body = body_of(s.mesh, method != PEL_METHOD_QUASI_STATIC);
    body.pinned = pins;
    body.pinned_count = column(s.mesh, -LENGTH, -LENGTH / 2, pins);
    s.model = make_model(&body);
    pel_sim_def def = lone_sim(s.model, method, dt);
    pel_load_def load = pel_load_def_default();
    pel_key keys[2] = {{0, 0}, {duration, 1}};
    load.vertices = end;
    load.vertex_count = column(s.mesh, LENGTH / 2, LENGTH, end);
    load.force[0] = force;
    load.keys = keys;
    load.key_count = 2;
    def.loads = &load;
    def.load_count = 1;
    def.seams = seam;
    def.seam_count = seam != NULL;
    s.sim = make_sim(&def);
    return s;
}

static void end_strip(strip *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
}

static double length_of(const pel_sim *sim)
{
    pel_cut_reading reading;
    assert_int_equal(pel_sim_get_cuts(sim, 0, &reading, NULL), PEL_OK);
    return reading.length;
}

/* ---- the load ---- */

/* Stretched along x by s a sheet carries E h s (s^2 - 1) / 2 per width at rest, which an edge takes by the cosine of
   its normal; compressed, what is left is the part along the edge. */
static void test_loads_of_edges(void **unused)
{
    (void)unused;
    const double stretches[] = {1.3, 0.9};
    random_state random = {5};
    pel_mesh *mesh = make_irregular_patch(8, &random);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        mesh->positions[v][2] = 0;
    pel_body_def body = body_of(mesh, true);
    pel_model *model = make_model(&body);
    pel_sim_def def = lone_sim(model, PEL_METHOD_STATIC, 1);
    int32_t *all = calloc((size_t)mesh->vertex_count, 4);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        all[v] = v;
    pel_seam_def seam = pel_seam_def_default();
    seam.vertices = all;
    seam.vertex_count = mesh->vertex_count;
    seam.strength = 1e30;
    def.seams = &seam;
    def.seam_count = 1;
    pel_sim *sim = make_sim(&def);
    double *x = calloc((size_t)mesh->vertex_count, 24);
    for (size_t i = 0; i < 2; i++) {
        double s = stretches[i], force = YOUNG * THICKNESS * s * (s * s - 1) / 2;
        for (int32_t v = 0; v < mesh->vertex_count; v++) {
            pel_vec3_copy(mesh->positions[v], x + 3 * v);
            x[3 * v] *= s;
        }
        assert_int_equal(pel_sim_set_positions(sim, 0, x, NULL), PEL_OK);
        pel_seams *seams = &sim->tear->seams[0];
        const pel_topology *topology = seams->survey.topology;
        pel_shell_forces_follow(sim->shells, sim->state->position);
        assert_int_equal(seams->edge_count, topology->edge_count - topology->boundary_edge_count);
        for (int32_t k = 0; k < seams->edge_count; k++) {
            int32_t e = seams->edges[k].edge, h = topology->half_edge_of_edge[e];
            double a[3], now[3], expected;
            pel_vec3_subtract(mesh->positions[pel_half_edge_target(topology, h)],
                              mesh->positions[pel_half_edge_origin(topology, h)], a);
            pel_vec3_copy(a, now);
            now[0] *= s;
            expected = fabs(force) * fabs(a[1]) / pel_vec3_length(a);
            if (s < 1)
                expected *= fabs(now[0]) / pel_vec3_length(now);
            assert_near(pel_seams_load(seams, e), expected, IN_FLOAT(1e-9, 1e-3) * fabs(force));
        }
    }
    free(x);
    free(all);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* ---- strength ---- */

/* a strip opens at strength times width; the rest of it keeps what it carries, and the far part is free */
static void test_strip(void **unused)
{
    (void)unused;
    static const struct {
        pel_method method;
        double dt, duration, slack;
    } rows[] = {{PEL_METHOD_STATIC, 0.01, 1, 0.025},
                {PEL_METHOD_IMPLICIT, 0.02, 4, 0.05},
                {PEL_METHOD_XPBD, 0.01, 2, 0.03},
                {PEL_METHOD_QUASI_STATIC, 1e-3, 60, 0.2}};
    int32_t path[16];
    pel_mesh *mesh = make_grid(16, 4, LENGTH, WIDTH, PEL_GRID_UNION_JACK);
    pel_seam_def seam = pel_seam_def_default();
    seam.path = path;
    seam.path_count = column(mesh, 0, 0, path);
    seam.strength = STRENGTH;
    pel_mesh_destroy(mesh);
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        const double most = 2 * STRENGTH * WIDTH;
        strip s = make_strip(rows[r].method, rows[r].dt, most, rows[r].duration, &seam);
        double force = 0, before = 0;
        while (length_of(s.sim) == 0 && pel_sim_time(s.sim) < rows[r].duration) {
            pel_sim_ledger ledger;
            pel_sim_get_ledger(s.sim, &ledger);
            before = ledger.elastic + ledger.kinetic;
            run_steps(s.sim, 1);
            force = most * pel_sim_time(s.sim) / rows[r].duration;
        }
        /* in steps of the load; equal springs are a sheet with uneven stresses */
        assert_near(force / (STRENGTH * WIDTH), 1, rows[r].slack);
        while (length_of(s.sim) < WIDTH - 1e-9 && pel_sim_time(s.sim) < rows[r].duration)
            run_steps(s.sim, 1);
        if (rows[r].method == PEL_METHOD_STATIC) {
            pel_sim_ledger ledger;
            pel_sim_get_ledger(s.sim, &ledger);
            /* the far part is free: load and energy leave it with its motion, the rest keeps half the energy */
            assert_true(ledger.energy_error <= 0.02 * before + ledger.tolerance);
        }
        assert_near(length_of(s.sim), WIDTH, 1e-12);
        end_strip(&s);
    }
}

/* ---- time ---- */

/* to the bit; a step at rest is solved again with the seam open, which a cut after it is not */
static void check_same_motion(const strip *a, const strip *b, pel_method method)
{
    int32_t count = 3 * pel_sim_vertex_count(a->sim, 0);
    double *places = calloc(2 * (size_t)count, sizeof *places), *others = places + count;
    pel_sim_get_positions(a->sim, 0, places);
    pel_sim_get_positions(b->sim, 0, others);
    assert_int_equal(pel_sim_vertex_count(b->sim, 0), count / 3);
    for (int32_t i = 0; i < count; i++)
        assert_near(places[i], others[i], method == PEL_METHOD_STATIC ? IN_FLOAT(1e-10, 1e-6) : 0);
    assert_true(method == PEL_METHOD_STATIC || pel_sim_hash(a->sim) == pel_sim_hash(b->sim));
    free(places);
}

/* the same motion as with a cut at that time, and the same bits as a simulation that goes on from a snapshot or comes
 * back to one */
static void test_time(void **unused)
{
    (void)unused;
    const pel_method methods[] = {PEL_METHOD_STATIC, PEL_METHOD_IMPLICIT, PEL_METHOD_XPBD, PEL_METHOD_QUASI_STATIC};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        int32_t path[16], count;
        strip by_hand = make_strip(methods[m], 1e-3, 0.1, 1, NULL);
        count = column(by_hand.mesh, 0, 0, path);
        pel_seam_def seam = pel_seam_def_default();
        seam.path = path;
        seam.path_count = count - 1; /* its end is a tip */
        seam.opens_at = 3e-3;
        strip s = make_strip(methods[m], 1e-3, 0.1, 1, &seam), other = make_strip(methods[m], 1e-3, 0.1, 1, &seam);
        run_steps(s.sim, 2);
        assert_true(length_of(s.sim) == 0);
        size_t size = pel_sim_save_size(s.sim);
        void *early = malloc(size);
        pel_sim_save(s.sim, early);
        run_steps(s.sim, 2);
        assert_near(length_of(s.sim), WIDTH * 3 / 4, 1e-12);
        run_steps(by_hand.sim, 3);
        assert_int_equal(pel_cut(by_hand.sim, 0, path, count - 1, NULL), PEL_OK);
        run_steps(by_hand.sim, 1);
        check_same_motion(&by_hand, &s, methods[m]);
        uint64_t hash = pel_sim_hash(s.sim);
        size_t late_size = pel_sim_save_size(s.sim);
        void *late = malloc(late_size);
        pel_sim_save(s.sim, late);
        assert_int_equal(pel_sim_load(other.sim, early, size, NULL), PEL_OK);
        run_steps(other.sim, 2);
        assert_true(pel_sim_hash(other.sim) == hash);
        assert_int_equal(pel_sim_load(s.sim, early, size, NULL), PEL_OK);
        assert_true(length_of(s.sim) == 0);
        run_steps(s.sim, 2);
        assert_true(pel_sim_hash(s.sim) == hash);
        assert_int_equal(pel_sim_load(other.sim, late, late_size, NULL), PEL_OK);
        assert_true(pel_sim_hash(other.sim) == hash);
        free(early);
        free(late);
        end_strip(&s);
        end_strip(&other);
        end_strip(&by_hand);
    }
}

/* every edge of a sheet is a seam: it falls into its triangles */
static void test_every_edge(void **unused)
{
    (void)unused;
    pel_seam_def seam = pel_seam_def_default();
    strip first = make_strip(PEL_METHOD_XPBD, 1e-3, 0, 1, NULL);
    int32_t *all = calloc((size_t)first.mesh->vertex_count, 4);
    for (int32_t v = 0; v < first.mesh->vertex_count; v++)
        all[v] = v;
    seam.vertices = all;
    seam.vertex_count = first.mesh->vertex_count;
    seam.opens_at = 0;
    strip s = make_strip(PEL_METHOD_XPBD, 1e-3, 0, 1, &seam);
    pel_cut_reading reading;
    run_steps(s.sim, 1);
    assert_int_equal(pel_sim_vertex_count(s.sim, 0), 3 * s.mesh->triangle_count);
    assert_int_equal(pel_sim_get_cuts(s.sim, 0, &reading, NULL), PEL_OK);
    assert_int_equal(reading.island_count, s.mesh->triangle_count - 1);
    free(all);
    end_strip(&first);
    end_strip(&s);
}

/* ---- refusals ---- */

static void refuse(strip *s, const pel_seam_def *seam, const char *words)
{
    pel_sim_def def = lone_sim(s->model, PEL_METHOD_XPBD, 1e-3);
    pel_sim *sim = NULL;
    pel_error error = {0};
    def.seams = seam;
    def.seam_count = 1;
    assert_int_equal(pel_sim_create(&def, &sim, &error), PEL_BAD_ARGUMENT);
    assert_null(sim);
    if (strstr(error.what, words) == NULL || error.remedy[0] == '\0')
        fail_msg("%s: %s", words, error.what);
}

static pel_status create(const void *context, pel_error *error)
{
    pel_sim *sim = NULL;
    pel_status status = pel_sim_create(context, &sim, error);
    if (status == PEL_OK)
        status = pel_sim_step(sim, error);
    pel_sim_destroy(sim);
    return status;
}

static void test_refusals(void **unused)
{
    (void)unused;
    strip s = make_strip(PEL_METHOD_XPBD, 1e-3, 0, 1, NULL);
    int32_t path[16], count = column(s.mesh, 0, 0, path), missing[2] = {path[0], s.mesh->vertex_count};
    int32_t apart[2] = {path[0], path[2]}, inside[2] = {path[1], path[2]}, border[2];
    const pel_seam_def good = {.path = path, .path_count = count, .strength = STRENGTH, .opens_at = 0};
    border[0] = nearest_vertex(s.mesh, 0, WIDTH / 2, 0);
    border[1] = nearest_vertex(s.mesh, LENGTH / 16, WIDTH / 2, 0);
    pel_seam_def seam = good;
    seam.body = 1;
    refuse(&s, &seam, "body 1 does not exist");
    seam = good;
    seam.vertices = path;
    seam.vertex_count = count;
    refuse(&s, &seam, "both a path and vertices");
    seam.path = seam.vertices = NULL;
    refuse(&s, &seam, "or none");
    seam = good;
    seam.path_count = 1;
    refuse(&s, &seam, "less than two");
    seam.path = missing;
    seam.path_count = 2;
    refuse(&s, &seam, "does not exist");
    seam.path = apart;
    refuse(&s, &seam, "no edge joins");
    seam.path = border;
    refuse(&s, &seam, "along the border");
    seam.path = inside;
    refuse(&s, &seam, "no edge that can open");
    seam = good;
    seam.strength = -1;
    refuse(&s, &seam, "strength below 0");
    seam.strength = 0;
    seam.opens_at = (double)NAN;
    refuse(&s, &seam, "not finite");
    seam.opens_at = -1;
    refuse(&s, &seam, "never opens");
    seam = pel_seam_def_default();
    assert_true(seam.strength == 0 && seam.opens_at < 0);
    pel_sim_def def = lone_sim(s.model, PEL_METHOD_XPBD, 1e-3);
    def.seams = &good;
    def.seam_count = 1;
    assert_true(for_every_allocation_failure(create, &def) > 10);
    end_strip(&s);
    pel_mesh *ball = make_sphere(4);
    pel_body_def body = shell_body(ball, PEL_MEMBRANE_STVK);
    body.shell.pressure.kind = PEL_PRESSURE_GAS;
    body.shell.pressure.value = 100;
    strip closed = {.model = make_model(&body)};
    refuse(&closed, &good, "encloses a gas");
    pel_model_destroy(closed.model);
    pel_mesh_destroy(ball);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_loads_of_edges), cmocka_unit_test(test_strip),    cmocka_unit_test(test_time),
        cmocka_unit_test(test_every_edge),     cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
