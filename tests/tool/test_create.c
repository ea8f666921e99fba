/* Tools that are refused, each with its number and what is wrong. */
#include "model/model.h"
#include "pellicle/base.h"
#include "pellicle/mesh.h"
#include "pellicle/model.h"
#include "sim/fixture.h"

typedef enum fault {
    FAULT_NONE,
    NO_NAME,
    EMPTY_NAME,
    LONG_NAME,
    SAME_NAME,
    BODY_BELOW,
    BODY_BEYOND,
    SHAPE_UNKNOWN,
    NO_KEYS,
    KEYS_NULL,
    KEY_FAR,
    KEY_NOT_TURNED,
    KEYS_AT_ONCE,
    FRICTION_NAN,
    RESTITUTION_NAN,
    THICKNESS_NAN,
    GRASP_ENDS,
    REACH_BELOW,
    REACH_ENDLESS,
    GRASP_FORCE_BELOW,
    NO_RADIUS,
    NO_SIZE_X,
    NO_SIZE_Y,
    NO_SIZE_Z,
    LENGTH_BELOW,
    LENGTH_ENDLESS,
    NO_MESH,
    SUPPORT_WITHOUT_BODY,
    SUPPORT_WITHOUT_VERTICES,
    SUPPORT_OF_NONE,
    CENTER_X,
    CENTER_Y,
    CENTER_Z,
    SUPPORT_BELOW,
    SUPPORT_BEYOND,
    SUPPORT_PINNED,
    FAULT_COUNT
} fault;

static const char *const messages[FAULT_COUNT] = {
    [NO_NAME] = "has no name",
    [EMPTY_NAME] = "has no name",
    [LONG_NAME] = "very long one",
    [SAME_NAME] = "the same name",
    [BODY_BELOW] = "names a body",
    [BODY_BEYOND] = "names a body",
    [SHAPE_UNKNOWN] = "shape of the tool",
    [NO_KEYS] = "no keys",
    [KEYS_NULL] = "no keys",
    [KEY_FAR] = "not finite",
    [KEY_NOT_TURNED] = "unit quaternion",
    [KEYS_AT_ONCE] = "not in order",
    [FRICTION_NAN] = "friction",
    [RESTITUTION_NAN] = "restitution",
    [THICKNESS_NAN] = "thickness",
    [GRASP_ENDS] = "grasp ends",
    [REACH_BELOW] = "reach is below 0",
    [REACH_ENDLESS] = "reach is below 0",
    [GRASP_FORCE_BELOW] = "largest force",
    [NO_RADIUS] = "radius is not above 0",
    [NO_SIZE_X] = "box has no size",
    [NO_SIZE_Y] = "box has no size",
    [NO_SIZE_Z] = "box has no size",
    [LENGTH_BELOW] = "capsule length",
    [LENGTH_ENDLESS] = "capsule length",
    [NO_MESH] = "has no mesh",
    [SUPPORT_WITHOUT_BODY] = "no body or no vertices",
    [SUPPORT_WITHOUT_VERTICES] = "no body or no vertices",
    [SUPPORT_OF_NONE] = "no body or no vertices",
    [CENTER_X] = "center of the support",
    [CENTER_Y] = "center of the support",
    [CENTER_Z] = "center of the support",
    [SUPPORT_BELOW] = "names a vertex",
    [SUPPORT_BEYOND] = "names a vertex",
    [SUPPORT_PINNED] = "is pinned",
};

/* what a tool points to */
typedef struct arrays {
    pel_pose_key keys[2];
    int32_t vertices[2];
    char name[PEL_NAME_SIZE + 1];
    int32_t vertex_count, pinned; /* of the body */
} arrays;

static void break_name_or_body(fault what, pel_tool_def *tool, arrays *a)
{
    switch (what) {
    case NO_NAME:
        tool->name = NULL;
        break;
    case EMPTY_NAME:
        tool->name = "";
        break;
    case LONG_NAME:
        memset(a->name, 'x', PEL_NAME_SIZE);
        tool->name = a->name;
        break;
    case SAME_NAME:
        tool->name = "first";
        break;
    case BODY_BELOW:
        tool->body = -2;
        break;
    case BODY_BEYOND:
        tool->body = 1;
        break;
    default:
        break;
    }
}

static void break_motion(fault what, pel_tool_def *tool, arrays *a)
{
    switch (what) {
    case NO_KEYS:
        tool->key_count = 0;
        break;
    case KEYS_NULL:
        tool->keys = NULL;
        break;
    case KEY_FAR:
        a->keys[1].position[2] = (double)INFINITY;
        break;
    case KEY_NOT_TURNED:
        a->keys[1].rotation[3] = 2;
        break;
    case KEYS_AT_ONCE:
        a->keys[1].time = a->keys[0].time;
        break;
    default:
        break;
    }
}

static void break_touch(fault what, pel_tool_def *tool)
{
    const double nothing = (double)NAN;
    switch (what) {
    case FRICTION_NAN:
        tool->friction = nothing;
        break;
    case RESTITUTION_NAN:
        tool->restitution = nothing;
        break;
    case THICKNESS_NAN:
        tool->thickness = nothing;
        break;
    case GRASP_ENDS:
        tool->grasp_until = tool->grasp_from;
        break;
    case REACH_BELOW:
        tool->reach = -1;
        break;
    case REACH_ENDLESS:
        tool->reach = (double)INFINITY;
        break;
    case GRASP_FORCE_BELOW:
        tool->grasp_max_force = -1;
        break;
    default:
        break;
    }
}

static void break_shape(fault what, pel_tool_def *tool)
{
    switch (what) {
    case SHAPE_UNKNOWN:
        tool->shape = (pel_tool_shape)99;
        break;
    case NO_RADIUS:
        tool->radius = 0;
        break;
    case NO_SIZE_X:
    case NO_SIZE_Y:
    case NO_SIZE_Z:
        tool->shape = PEL_TOOL_BOX;
        for (int k = 0; k < 3; k++)
            tool->half_extents[k] = (int)what == NO_SIZE_X + k ? 0 : 0.1;
        break;
    case LENGTH_BELOW:
        tool->shape = PEL_TOOL_CAPSULE;
        tool->half_length = -1;
        break;
    case LENGTH_ENDLESS:
        tool->shape = PEL_TOOL_CAPSULE;
        tool->half_length = (double)INFINITY;
        break;
    case NO_MESH:
        tool->shape = PEL_TOOL_MESH;
        break;
    default:
        break;
    }
}

static void break_support(fault what, pel_tool_def *tool, arrays *a)
{
    if (what < SUPPORT_WITHOUT_BODY)
        return;
    tool->shape = PEL_TOOL_SUPPORT;
    tool->press = false;
    tool->body = what == SUPPORT_WITHOUT_BODY ? -1 : 0;
    tool->vertices = what == SUPPORT_WITHOUT_VERTICES ? NULL : a->vertices;
    tool->vertex_count = what == SUPPORT_OF_NONE ? 0 : 2;
    if (what >= CENTER_X && what <= CENTER_Z)
        tool->center[what - CENTER_X] = (double)NAN;
    a->vertices[1] = what == SUPPORT_BELOW    ? -1
                     : what == SUPPORT_BEYOND ? a->vertex_count
                     : what == SUPPORT_PINNED ? a->pinned
                                              : 1;
}

static void check_tools(const pel_model *model, fault what, arrays *a)
{
    pel_tool_def tools[2] = {pel_tool_def_default(), pel_tool_def_default()};
    for (int i = 0; i < 2; i++) {
        tools[i].name = i == 0 ? "first" : "second";
        tools[i].radius = 0.1;
        tools[i].keys = a->keys;
        tools[i].key_count = 2 * i;
    }
    static const pel_pose_key away = {0, {9, 0, 0}, {0, 0, 0, 1}, {0}};
    tools[0].keys = &away;
    tools[0].key_count = 1;
    tools[1].grasp = true;
    break_name_or_body(what, &tools[1], a);
    break_motion(what, &tools[1], a);
    break_touch(what, &tools[1]);
    break_shape(what, &tools[1]);
    break_support(what, &tools[1], a);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.tools = tools;
    def.tool_count = 2;
    check_refusal(&def, (int)what, messages[what], "tool");
}

/* the second of two tools is at fault: it is named */
static void test_refusals(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(3);
    const int32_t pinned = 5;
    pel_body_def body = ball_body(mesh);
    body.pinned = &pinned;
    body.pinned_count = 1;
    pel_model *model = make_model(&body);
    for (int f = FAULT_NONE; f < FAULT_COUNT; f++) {
        arrays a = {.keys = {{0, {0, 0, 3}, {0, 0, 0, 1}, {0}}, {1, {0, 0, 3}, {0, 0, 0, 1}, {0}}},
                    .vertices = {0, 1},
                    .vertex_count = mesh->vertex_count,
                    .pinned = pinned};
        check_tools(model, (fault)f, &a);
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
