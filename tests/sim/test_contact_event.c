/* Refinement beside another surface: new vertices that would cut it move to the middles of their edges, and events that
   still cut it are reverted. */
#include "sim/contact_scene.h"
#include "stage/stage.h"

/* a coarse ball that refines, and a thorn whose tip points at the middle of one of its edges */
typedef struct thorn_scene {
    contact_scene scene;
    pel_sim *sim;
    int32_t vertex;   /* an end of the edge */
    double middle[3]; /* of the edge */
} thorn_scene;

/* how far the ball bulges out of the middle of an edge that is refined: 0.0096 and more for this one */
static const double bulge = 0.005;

/* a tetrahedron from its tip outward, for side -1 inward */
static pel_mesh *make_thorn(const double tip[3], double side)
{
    static const int32_t faces[12] = {0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3};
    double x[12], axes[2][3], outward[3];
    int32_t turned[12];
    pel_vec3_copy(tip, outward);
    pel_vec3_normalize(outward);
    const double any[3] = {outward[1], outward[2], -outward[0]};
    pel_vec3_cross(outward, any, axes[0]);
    pel_vec3_normalize(axes[0]);
    pel_vec3_cross(outward, axes[0], axes[1]);
    for (int v = 0; v < 4; v++)
        for (int k = 0; k < 3; k++) {
            double along = v == 0 ? 0 : 0.1 * side;
            double across = v == 0 ? 0 : 0.02 * cos(2.1 * v) * axes[0][k] + 0.02 * sin(2.1 * v) * axes[1][k];
            x[3 * v + k] = tip[k] + along * outward[k] + across;
        }
    for (int i = 0; i < 12; i++)
        turned[i] = faces[side > 0 ? i : 11 - i];
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(x, 4, turned, 4, &mesh, NULL), PEL_OK);
    return mesh;
}

/* the tip lies `above` the middle of the edge */
static void begin_thorn(thorn_scene *s, double above, double side)
{
    scene_begin(&s->scene, PEL_METHOD_QUASI_STATIC);
    pel_mesh *ball = make_sphere(4);
    const int32_t *ends = ball->triangles[ball->triangle_count / 2];
    double tip[3];
    s->vertex = ends[0];
    for (int k = 0; k < 3; k++)
        s->middle[k] = (ball->positions[ends[0]][k] + ball->positions[ends[1]][k]) / 2;
    pel_vec3_scale(s->middle, 1 + above / pel_vec3_length(s->middle), tip);
    scene_body(&s->scene, ball);
    scene_body(&s->scene, make_thorn(tip, side));
    s->scene.bodies[0].refine.levels = 1;
    s->scene.def.contact.thickness = 1e-4;
    s->sim = scene_create(&s->scene);
}

static int64_t count_cuts(pel_sim *sim)
{
    int64_t pairs = -1;
    assert_int_equal(pel_sim_intersections(sim, &pairs, NULL), PEL_OK);
    return pairs;
}

/* distance of the ball's nearest vertex from the middle of the edge */
static double nearest_to_middle(const thorn_scene *s)
{
    int32_t count = pel_sim_vertex_count(s->sim, 0);
    double *x = malloc(3 * (size_t)count * sizeof *x), nearest = 1;
    pel_sim_get_positions(s->sim, 0, x);
    for (int32_t v = 0; v < count; v++)
        nearest = fmin(nearest, pel_vec3_distance(x + 3 * (size_t)v, s->middle));
    free(x);
    return nearest;
}

static void test_bulge_where_there_is_room(void **unused)
{
    (void)unused;
    thorn_scene s;
    begin_thorn(&s, 0.1, 1);
    assert_int_equal(pel_sim_refine(s.sim, 0, s.vertex, 1, NULL), PEL_OK);
    assert_true(nearest_to_middle(&s) > 1.5 * bulge && nearest_to_middle(&s) < 0.05);
    scene_end(&s.scene, s.sim);
}

/* at the middle of the edge, and at rest there */
static void test_middle_where_there_is_none(void **unused)
{
    (void)unused;
    thorn_scene s;
    begin_thorn(&s, bulge, 1);
    assert_int_equal(count_cuts(s.sim), 0);
    int32_t before = pel_sim_vertex_count(s.sim, 0);
    assert_int_equal(pel_sim_refine(s.sim, 0, s.vertex, 1, NULL), PEL_OK);
    assert_true(pel_sim_vertex_count(s.sim, 0) > before);
    assert_int_equal(count_cuts(s.sim), 0);
    assert_true(nearest_to_middle(&s) < (sizeof(pel_real) == 8 ? 1e-12 : 1e-6));
    const pel_state *state = s.sim->state;
    for (int32_t v = 0; v < s.sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            assert_near((double)state->position_before[v][k], (double)state->position[v][k],
                        sizeof(pel_real) == 8 ? 1e-12 : 1e-6);
    scene_end(&s.scene, s.sim);
}

/* coarsened, the ball would cut a surface inside the bulge: refused by name, without a change */
static void test_taken_back(void **unused)
{
    (void)unused;
    thorn_scene s;
    pel_error error;
    begin_thorn(&s, -0.2, -1);
    assert_int_equal(pel_sim_refine(s.sim, 0, s.vertex, 1, NULL), PEL_OK);
    int32_t refined = pel_sim_vertex_count(s.sim, 0);
    double length = pel_vec3_length(s.middle);
    const pel_body *thorn = &s.sim->model->bodies[1];
    for (int32_t i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            pel_real move = (pel_real)((0.2 + bulge) * s.middle[k] / length);
            s.sim->state->position[thorn->model_index[i]][k] += move;
            s.sim->state->position_before[thorn->model_index[i]][k] += move;
        }
    assert_int_equal(count_cuts(s.sim), 0);
    uint64_t hash = pel_sim_hash(s.sim);
    assert_int_equal(pel_sim_refine(s.sim, 0, s.vertex, 0, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "would intersect"));
    assert_int_equal(pel_sim_vertex_count(s.sim, 0), refined);
    assert_true(pel_sim_hash(s.sim) == hash);
    scene_end(&s.scene, s.sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bulge_where_there_is_room),
                                       cmocka_unit_test(test_middle_where_there_is_none),
                                       cmocka_unit_test(test_taken_back)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
