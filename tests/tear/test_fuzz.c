/* Random cuts and tears, one after the other, on surfaces of all kinds under methods with and without contact: what a
   cut leaves as it is, a surface without branches, and no intersection. */
#include "sim/cut_fixture.h"

enum { MOST_PATH = 12, ACTIONS = 10 };

static const pel_method methods[] = {PEL_METHOD_XPBD, PEL_METHOD_IMPLICIT, PEL_METHOD_EXPLICIT, PEL_METHOD_QUASI_STATIC,
                                     PEL_METHOD_PBD_DISTANCE};
enum { METHOD_COUNT = sizeof methods / sizeof methods[0] };

typedef struct surface {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
    pel_method method;
    bool has_contact;
} surface;

static surface make_body(random_state *random)
{
    surface s = {.mesh = random_surface(random), .method = methods[random_below(random, METHOD_COUNT)]};
    bool is_shell = s.method != PEL_METHOD_QUASI_STATIC && s.method != PEL_METHOD_PBD_DISTANCE, tears;
    pel_body_def body = pel_body_def_default();
    body.name = "surface";
    body.mesh = s.mesh;
    body.mass_kind = PEL_MASS_DENSITY;
    body.mass = 1000;
    body.thickness.value = 0.01;
    body.volumetric_stiffness.value = 0;
    s.has_contact = is_shell && random_below(random, 2) == 0;
    tears = random_below(random, 2) == 0;
    if (is_shell) {
        body.spring_stiffness.value = 0;
        body.shell.membrane.on = true;
        body.shell.membrane.young.value = 1e4;
        body.shell.membrane.poisson = 0.3;
        body.shell.membrane.thickness.value = 0.01;
        body.shell.membrane.toughness.value = tears ? random_between(random, 1, 30) : 0;
    } else {
        body.spring_stiffness.value = 1e4;
        body.spring_thickness = 0.01;
        body.spring_toughness.value = tears ? random_between(random, 1, 30) : 0;
    }
    s.model = make_model(&body);
    pel_sim_def def = lone_sim(s.model, s.method, s.method == PEL_METHOD_EXPLICIT ? 1e-4 : 2e-3);
    def.contact.enabled = s.has_contact;
    def.contact.self = s.has_contact;
    def.contact.thickness = 0.004;
    s.sim = make_sim(&def);
    return s;
}

static void end_body(surface *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
}

/* along edges from anywhere, at times over edges that are open already, or from a vertex to any other */
static int32_t find_path(const pel_mesh *mesh, random_state *random, int32_t *path)
{
    pel_topology *topology;
    int32_t length = (int32_t)random_integer(random, 2, MOST_PATH), count = 0;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    int32_t v = (int32_t)random_below(random, (uint32_t)mesh->vertex_count);
    while (count < length && topology->corner_of_vertex[v] >= 0) {
        path[count++] = v;
        int32_t turns = (int32_t)random_below(random, 6), h = topology->corner_of_vertex[v];
        for (int32_t i = 0; i < turns; i++) {
            int32_t next = pel_half_edge_turn(topology, h);
            if (next < 0)
                break;
            h = next;
        }
        v = random_below(random, 40) == 0 ? (int32_t)random_below(random, (uint32_t)mesh->vertex_count)
                                          : pel_half_edge_target(topology, h);
    }
    pel_topology_destroy(topology);
    return count;
}

static void check_surface(const surface *s)
{
    check_opened(s->sim, s->mesh->triangle_count, s->has_contact);
}

/* a cut changes no motion; one that is refused changes nothing */
static bool cut(const surface *s, random_state *random)
{
    int32_t path[MOST_PATH], count = find_path(pel_model_mesh(pel_sim_model(s->sim), 0), random, path);
    sums before = sums_of(s->sim);
    uint64_t hash = pel_sim_hash(s->sim);
    pel_error error;
    pel_status status = pel_cut(s->sim, 0, path, count, &error);
    sums after = sums_of(s->sim);
    if (status == PEL_OK) {
        assert_near(after.mass / before.mass, 1, IN_FLOAT(1e-14, 1e-6));
        if (s->method != PEL_METHOD_QUASI_STATIC && before.kinetic > 0)
            compare_motion(&before, &after);
        return true;
    }
    assert_int_equal(status, PEL_BAD_ARGUMENT);
    assert_true(error.remedy[0] != '\0');
    assert_true(pel_sim_hash(s->sim) == hash);
    return false;
}

typedef struct tally {
    int64_t cut_count, refused_count, tear_count, step_count, failed_count;
} tally;

static void fuzz(random_state *random, tally *all)
{
    surface s = make_body(random);
    for (int i = 0; i < ACTIONS; i++) {
        pel_cut_reading before = {0}, after = {0};
        pel_error error;
        if (cut(&s, random))
            all->cut_count++;
        else
            all->refused_count++;
        check_surface(&s);
        if (s.method != PEL_METHOD_QUASI_STATIC && random_below(random, 3) == 0)
            push(s.sim, random);
        pel_sim_get_cuts(s.sim, 0, &before, NULL);
        /* a surface that is pushed too hard may have no next step, which is told */
        if (pel_sim_step(s.sim, &error) != PEL_OK) {
            assert_true(error.what[0] != '\0');
            all->failed_count++;
            break;
        }
        pel_sim_get_cuts(s.sim, 0, &after, NULL);
        all->step_count++;
        all->tear_count += after.length > before.length;
        check_surface(&s);
    }
    end_body(&s);
}

static void test_cuts_and_tears(void **unused)
{
    (void)unused;
    random_state random = {34};
    tally all = {0};
    int64_t wanted = LONG(100000, ROUNDS(600, 100));
    while (all.cut_count + all.tear_count < wanted)
        fuzz(&random, &all);
    print_message("%d cuts, %d refused, %d steps with tears, %d steps, %d without a next one\n", (int)all.cut_count,
                  (int)all.refused_count, (int)all.tear_count, (int)all.step_count, (int)all.failed_count);
    assert_true(all.tear_count > wanted / 50 && all.refused_count > 0);
    assert_true(all.failed_count < all.step_count / 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cuts_and_tears),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
