/* Random ways of blades and scissors through surfaces of all kinds, at any speed and under methods with and without
   contact: a surface without branches, no intersection, copies where the surface opened, and a mass that only the areas
   of coarse curved surfaces change. */
#include "sim/cut_fixture.h"

enum { KEYS = 5, STEPS = 25 };

static const pel_method methods[] = {PEL_METHOD_XPBD, PEL_METHOD_IMPLICIT, PEL_METHOD_EXPLICIT, PEL_METHOD_DESCENT};
enum { METHOD_COUNT = sizeof methods / sizeof methods[0] };

typedef struct surface {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
    pel_method method;
    bool has_contact, tears;
} surface;

static pel_model *model_of(const pel_mesh *mesh, bool tears, random_state *random)
{
    int32_t pins[8];
    pel_body_def body = pel_body_def_sheet("surface", mesh, 1e4, 0.01, 1000);
    body.shell.membrane.poisson = 0.3;
    body.shell.membrane.toughness.value = tears ? random_between(random, 1, 30) : 0;
    for (int i = 0; i < 8; i++)
        pins[i] = (int32_t)random_below(random, (uint32_t)mesh->vertex_count);
    body.pinned = pins;
    body.pinned_count = random_below(random, 2) == 0 ? 8 : 3;
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    def.gravity[2] = random_between(random, -5, 5);
    pel_model *model;
    assert_int_equal(pel_model_create(&def, &model, NULL), PEL_OK);
    return model;
}

/* keys around the surface; some tools are so fast that they pass it in a step */
static pel_tool_def make_tool(pel_pose_key keys[KEYS], pel_key closing[KEYS], double duration, random_state *random)
{
    pel_tool_def tool = pel_tool_def_default();
    double time = 0;
    tool.name = "tool";
    tool.shape = random_below(random, 3) == 0 ? PEL_TOOL_SCISSORS : PEL_TOOL_BLADE;
    for (int i = 0; i < KEYS; i++) {
        double axis[3], angle = random_between(random, 0, 1.5);
        for (int k = 0; k < 3; k++) {
            axis[k] = random_between(random, -1, 1);
            keys[i].position[k] = random_between(random, -1.1, 1.1);
            tool.edge[i % 2][k] = i < 2 ? random_between(random, -1, 1) : tool.edge[i % 2][k];
        }
        pel_vec3_normalize(axis);
        pel_vec3_scale(axis, sin(angle), keys[i].rotation);
        keys[i].rotation[3] = cos(angle);
        keys[i].time = closing[i].time = time;
        closing[i].value = i == 0 ? 0 : random_between(random, 0, 1);
        time += duration * random_between(random, 0.02, 0.5);
    }
    tool.keys = keys;
    tool.key_count = KEYS;
    tool.closing = tool.shape == PEL_TOOL_SCISSORS ? closing : NULL;
    tool.closing_count = tool.shape == PEL_TOOL_SCISSORS ? KEYS : 0;
    tool.sharpness = tool.shape == PEL_TOOL_BLADE && random_below(random, 3) == 0 ? random_between(random, 1, 100) : 0;
    return tool;
}

/* false if the tool starts in the surface, which is refused */
static bool make_body(surface *s, random_state *random)
{
    *s = (surface){.mesh = random_surface(random), .method = methods[random_below(random, METHOD_COUNT)]};
    double dt = s->method == PEL_METHOD_EXPLICIT ? 1e-4 : random_between(random, 1e-3, 1e-2);
    pel_pose_key keys[KEYS];
    pel_key closing[KEYS];
    pel_error error;
    pel_tool_def tool = make_tool(keys, closing, STEPS * dt, random);
    tool.sharpness = s->method == PEL_METHOD_EXPLICIT ? 0 : tool.sharpness;
    s->tears = random_below(random, 3) == 0;
    s->model = model_of(s->mesh, s->tears, random);
    pel_sim_def def = lone_sim(s->model, s->method, dt);
    s->has_contact = random_below(random, 2) == 0;
    def.contact.enabled = def.contact.self = s->has_contact;
    def.contact.thickness = random_between(random, 1e-4, 4e-3);
    def.tools = &tool;
    def.tool_count = 1;
    pel_status status = pel_sim_create(&def, &s->sim, &error);
    if (status == PEL_OK)
        return true;
    assert_int_equal(status, PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "starts in the surface"));
    return false;
}

static void end_body(surface *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
}

typedef struct tally {
    int64_t cut_count, step_count, failed_count, refused_count;
} tally;

static void check_step(const surface *s, int32_t count, double mass)
{
    check_opened(s->sim, s->mesh->triangle_count, s->has_contact);
    /* blades cut after the step, tears before it */
    if (!s->tears)
        assert_near(farthest_new_copy(s->sim, count), 0, s->has_contact ? 0.02 : 0);
    assert_near(sums_of(s->sim).mass / mass, 1, 0.3);
}

static void fuzz(random_state *random, tally *all)
{
    surface s;
    if (!make_body(&s, random)) {
        all->refused_count++;
        end_body(&s);
        return;
    }
    double mass = sums_of(s.sim).mass;
    for (int i = 0; i < STEPS; i++) {
        int32_t count = pel_sim_vertex_count(s.sim, 0);
        pel_error error;
        if (random_below(random, 8) == 0)
            push(s.sim, random);
        /* a surface that is pushed too hard may have no next step, which is told */
        if (pel_sim_step(s.sim, &error) != PEL_OK) {
            assert_true(error.what[0] != '\0');
            all->failed_count++;
            break;
        }
        all->step_count++;
        all->cut_count += pel_sim_vertex_count(s.sim, 0) > count;
        check_step(&s, count, mass);
    }
    end_body(&s);
}

static void test_ways(void **unused)
{
    (void)unused;
    random_state random = {35};
    tally all = {0};
    int64_t wanted = LONG(30000, ROUNDS(200, 40));
    while (all.cut_count < wanted)
        fuzz(&random, &all);
    print_message("%d steps that cut, %d steps, %d without a next one, %d tools that start in a surface\n",
                  (int)all.cut_count, (int)all.step_count, (int)all.failed_count, (int)all.refused_count);
    assert_true(all.failed_count < all.step_count / 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ways),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
