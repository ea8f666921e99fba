#include "misuse.h"

#include <pellicle/pellicle.h>

#include <pellicle/export.h>
#include <pellicle/frames.h>
#include <pellicle/import.h>
#include <pellicle/live.h>
#include <pellicle/mesh_io.h>
#include <pellicle/observe.h>
#include <pellicle/potential.h>
#include <pellicle/report.h>
#include <pellicle/results.h>
#include <pellicle/run.h>
#include <pellicle/session.h>
#include <pellicle/shape.h>

#include <math.h>
#include <stddef.h>

static const char scene_text[] = "version: 1\n"
                                 "bodies: [{ name: ball, mesh: { shape: geodesic-sphere, frequency: 2 } }]\n"
                                 "duration: 0.02\n";
static const double nan_value = (double)NAN, zero3[3];

/* start of most cases */
static pel_mesh *mesh;
static pel_topology *topology;
static pel_model *model;
static pel_sim *sim;
static pel_scene *scene;
static const pel_pose_key still = {.position = {0, 0, 2}, .rotation = {0, 0, 0, 1}};

static pel_body_def make_body(void)
{
    pel_body_def body = pel_body_def_default();
    body.name = "ball";
    body.mesh = mesh;
    return body;
}

static pel_tool_def make_tool(void)
{
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "probe";
    tool.radius = 0.1;
    tool.keys = &still;
    tool.key_count = 1;
    tool.body = 0;
    return tool;
}

static int set_up(void **unused)
{
    (void)unused;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    shape.frequency = 2;
    if (pel_shape_create(&shape, &mesh, NULL) != PEL_OK || pel_topology_create(mesh, &topology, NULL) != PEL_OK)
        return -1;
    pel_body_def body = make_body();
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    if (pel_model_create(&def, &model, NULL) != PEL_OK)
        return -1;
    pel_tool_def tool = make_tool();
    pel_sim_def sim_def = pel_sim_def_default();
    sim_def.model = model;
    sim_def.tools = &tool;
    sim_def.tool_count = 1;
    return pel_sim_create(&sim_def, &sim, NULL) == PEL_OK &&
                   pel_scene_parse("a.yaml", scene_text, strlen(scene_text), NULL, 0, NULL, &scene, NULL) == PEL_OK
               ? 0
               : -1;
}

static int tear_down(void **unused)
{
    (void)unused;
    pel_scene_destroy(scene);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_topology_destroy(topology);
    pel_mesh_destroy(mesh);
    return 0;
}

/* all cases of this test were refused; the next one counts anew */
static void finish(void)
{
    int failures = misuse_failures;
    misuse_failures = 0;
    assert_int_equal(failures, 0);
}

/* ---- pure functions: numbers out of range, enums that do not exist ---- */

/* ---- runs, read back ---- */

static void test_results(void **unused)
{
    (void)unused;
    pel_frames *frames, none = {.folder = NULL};
    pel_frames_outline outline;
    pel_mesh *made;
    char text[PEL_EXPORT_PATH_SIZE];
    GIVES(pel_run_file_name((pel_run_file)-1) == NULL && pel_run_file_name((pel_run_file)99) == NULL);
    REFUSED("folder", pel_frames_open(NULL, &frames, &error));
    REFUSED("frames", pel_frames_open(".", NULL, &error));
    SURVIVES(pel_frames_close(NULL));
    REFUSED("frames", pel_frames_read(NULL, 0, &made, &error));
    REFUSED("frame", pel_frames_read(&none, 0, &made, &error));
    REFUSED("frame", pel_frames_read(&none, -1, &made, &error));
    REFUSED("mesh", pel_frames_read(&none, 0, NULL, &error));
    REFUSED("frames", pel_frames_check(NULL, &outline, &error));
    REFUSED("outline", pel_frames_check(&none, NULL, &error));
    REFUSED("frame", pel_frames_check(&none, &outline, &error));
    pel_series *series;
    const char *names[2] = {"time", NULL};
    REFUSED("path", pel_series_read(NULL, names, 1, &series, &error));
    REFUSED("names", pel_series_read("a.csv", NULL, 1, &series, &error));
    REFUSED("names", pel_series_read("a.csv", names, 2, &series, &error));
    REFUSED("names", pel_series_read("a.csv", names, -1, &series, &error));
    REFUSED("series", pel_series_read("a.csv", names, 1, NULL, &error));
    SURVIVES(pel_series_destroy(NULL));
    GIVES(isnan(pel_series_value(NULL, 0, 0)));
    GIVES(isnan(pel_series_value(&(pel_series){.column_count = 0}, -1, INT64_MIN)));
    REFUSED("frames", pel_frames_read_tool(NULL, 0, 0, &made, &error));
    REFUSED("mesh", pel_frames_read_tool(&none, 0, 0, NULL, &error));
    REFUSED("tool", pel_frames_read_tool(&none, 0, 0, &made, &error));
    REFUSED("path", pel_export_pc2(NULL, &none, &error));
    REFUSED("frames", pel_export_pc2("misuse.pc2", NULL, &error));
    REFUSED("frame", pel_export_pc2("misuse.pc2", &none, &error));
    REFUSED("path", pel_export_glb(NULL, &none, &error));
    REFUSED("frames", pel_export_glb("misuse.glb", NULL, &error));
    REFUSED("frame", pel_export_glb("misuse.glb", &none, &error));
    REFUSED("path", pel_export_glb_mesh(NULL, mesh, &error));
    REFUSED("mesh", pel_export_glb_mesh("misuse.glb", NULL, &error));
    REFUSED("path", pel_export_usd(NULL, &none, &error));
    REFUSED("path", pel_export_usd_mesh(NULL, mesh, &error));
    REFUSED("mesh", pel_export_usd_mesh("misuse.usda", NULL, &error));
    REFUSED("frames", pel_export_usd("misuse.usda", NULL, &error));
    REFUSED("frame", pel_export_usd("misuse.usda", &none, &error));
    REFUSED("path", pel_export_sequence(NULL, PEL_FORMAT_OBJ, &none, NULL, &error));
    REFUSED("frames", pel_export_sequence("misuse.obj", PEL_FORMAT_OBJ, NULL, NULL, &error));
    FAILS(pel_export_sequence("misuse.obj", (pel_mesh_format)77, &none, NULL, &error));
    SURVIVES(pel_export_numbered_path(text, "", -1));
    pel_report_def report = pel_report_def_default();
    REFUSED("path", pel_report_write(NULL, &report, NULL, &error));
    REFUSED("def", pel_report_write("misuse.html", NULL, NULL, &error));
    FAILS(pel_report_write("misuse.html", &(pel_report_def){.page = "x"}, NULL, &error));
    report.page = "x", report.folder_count = 1;
    REFUSED("folder", pel_report_write("misuse.html", &report, NULL, &error));
    report.folder_count = -1;
    REFUSED("folder", pel_report_write("misuse.html", &report, NULL, &error));
    report.folders = names, report.folder_count = 1, report.field_count = 3;
    REFUSED("fields", pel_report_write("misuse.html", &report, NULL, &error));
    finish();
}

/* ---- shapes, regions, presets ---- */

/* ---- model: every member of the defs ---- */

static pel_status try_body(const pel_body_def *body, pel_error *error)
{
    pel_model *made;
    pel_model_def def = pel_model_def_default();
    def.bodies = body;
    def.body_count = 1;
    return pel_model_create(&def, &made, error);
}

static void test_model(void **unused)
{
    (void)unused;
    pel_model *made;
    pel_model_def def = pel_model_def_default();
    REFUSED("def", pel_model_create(NULL, &made, &error));
    REFUSED("model", pel_model_create(&def, NULL, &error));
    def.body_count = 1;
    REFUSED("bodies", pel_model_create(&def, &made, &error));
    def.body_count = -1;
    FAILS(pel_model_create(&def, &made, &error));
    pel_body_def body = make_body(), wrong;
    def.bodies = &body, def.body_count = 1, def.gravity[1] = nan_value;
    REFUSED("gravity", pel_model_create(&def, &made, &error));
    wrong = body, wrong.name = NULL;
    REFUSED("name", try_body(&wrong, &error));
    wrong = body, wrong.mesh = NULL;
    REFUSED("mesh", try_body(&wrong, &error));
    wrong = pel_body_def_sheet("sheet", NULL, 1e6, 1e-3, 900);
    REFUSED("mesh", try_body(&wrong, &error));
    wrong = pel_body_def_sheet("sheet", mesh, nan_value, 1e-3, 900);
    FAILS(try_body(&wrong, &error));
    wrong = body, wrong.mass_kind = (pel_mass_kind)9;
    REFUSED("mass", try_body(&wrong, &error));
    wrong = body, wrong.mass = nan_value;
    REFUSED("mass", try_body(&wrong, &error));
    wrong = body, wrong.spring_stiffness.value = nan_value;
    REFUSED("stiffness", try_body(&wrong, &error));
    wrong = body, wrong.spring_stiffness.key_count = 3;
    REFUSED("keys", try_body(&wrong, &error));
    wrong = body, wrong.spring_damping.value = -1;
    REFUSED("damping", try_body(&wrong, &error));
    wrong = body, wrong.volumetric_stiffness.value = nan_value;
    REFUSED("volumetric", try_body(&wrong, &error));
    wrong = body, wrong.pinned_count = 2;
    REFUSED("pinned", try_body(&wrong, &error));
    wrong = body, wrong.pinned = (const int32_t[]){-1}, wrong.pinned_count = 1;
    REFUSED("pinned", try_body(&wrong, &error));
    wrong = body, wrong.pinned = (const int32_t[]){INT32_MAX}, wrong.pinned_count = 1;
    REFUSED("pinned", try_body(&wrong, &error));
    wrong = body, wrong.pinned = (const int32_t[]){1}, wrong.pinned_count = -1;
    REFUSED("pinned", try_body(&wrong, &error));
    wrong = body, wrong.friction = nan_value;
    REFUSED("friction", try_body(&wrong, &error));
    wrong = body, wrong.restitution = nan_value;
    REFUSED("restitution", try_body(&wrong, &error));
    wrong = body, wrong.contact_thickness = nan_value;
    REFUSED("thickness", try_body(&wrong, &error));
    wrong = body, wrong.reference_count = -1, wrong.volumetric_by_area = true;
    REFUSED("reference", try_body(&wrong, &error));
    wrong = body, wrong.refine.levels = INT32_MAX;
    FAILS(try_body(&wrong, &error));
    wrong = body, wrong.refine.levels = -1;
    REFUSED("levels", try_body(&wrong, &error));
    body.refine.levels = 1;
    wrong = body, wrong.refine.above = nan_value;
    REFUSED("above", try_body(&wrong, &error));
    wrong = body, wrong.refine.region_count = 2;
    REFUSED("region", try_body(&wrong, &error));
    wrong = body, wrong.refine.region = (const int32_t[]){9999}, wrong.refine.region_count = 1;
    REFUSED("region", try_body(&wrong, &error));
    wrong = body, wrong.refine.rings = 99;
    REFUSED("rings", try_body(&wrong, &error));
    wrong = body, wrong.refine.springs = (pel_refine_springs)9;
    REFUSED("springs", try_body(&wrong, &error));
    wrong = body, wrong.refine.near_tools = nan_value;
    REFUSED("near_tools", try_body(&wrong, &error));
    wrong = body, wrong.refine.budget = -1;
    REFUSED("budget", try_body(&wrong, &error));
    wrong = body, wrong.refine.dwell = -1;
    REFUSED("dwell", try_body(&wrong, &error));
    wrong = body, wrong.refine.interval = -1;
    REFUSED("interval", try_body(&wrong, &error));
    SURVIVES(pel_model_destroy(NULL));
    GIVES(pel_model_body_count(NULL) == 0);
    GIVES(pel_model_find_body(NULL, "x") == -1 && pel_model_find_body(model, NULL) == -1);
    GIVES(pel_model_mesh(NULL, 0) == NULL && pel_model_mesh(model, -1) == NULL && pel_model_mesh(model, 7) == NULL);
    GIVES(pel_model_turned_count(model, 7) == 0 && pel_model_pinned_count(model, -7) == 0);
    GIVES(!pel_model_is_closed(model, INT32_MAX) && pel_model_body_name(model, 1)[0] == '\0');
    finish();
}

static void test_shell(void **unused)
{
    (void)unused;
    pel_body_def body = make_body(), wrong;
    body.shell.membrane.on = true;
    body.shell.membrane.young.value = 1e5;
    body.shell.membrane.thickness.value = 0.01;
    body.shell.membrane.poisson = 0.3;
    wrong = body, wrong.shell.membrane.kind = (pel_membrane_kind)50;
    FAILS(try_body(&wrong, &error));
    wrong = body, wrong.shell.membrane.young.value = nan_value;
    REFUSED("young", try_body(&wrong, &error));
    wrong = body, wrong.shell.membrane.poisson = nan_value;
    REFUSED("poisson", try_body(&wrong, &error));
    wrong = body, wrong.shell.membrane.thickness.value = nan_value;
    REFUSED("thickness", try_body(&wrong, &error));
    wrong = body, wrong.shell.membrane.strain_limit = nan_value;
    REFUSED("strain limit", try_body(&wrong, &error));
    wrong = body, wrong.shell.bending.model = (pel_bending_model)50;
    REFUSED("bending", try_body(&wrong, &error));
    wrong = body, wrong.shell.bending.model = PEL_BENDING_HINGE, wrong.shell.bending.weight = nan_value;
    REFUSED("weight", try_body(&wrong, &error));
    wrong = body, wrong.shell.anisotropy_count = 1;
    REFUSED("anisotropies", try_body(&wrong, &error));
    wrong = body, wrong.shell.anisotropy_count = -1;
    REFUSED("anisotrop", try_body(&wrong, &error));
    pel_anisotropy_def fibres = pel_anisotropy_def_default();
    fibres.stiffness = 10, fibres.axis[0] = 1, fibres.direction = PEL_FIBRE_ALONG;
    wrong = body, wrong.shell.anisotropies = &fibres, wrong.shell.anisotropy_count = 1;
    fibres.mode = (pel_fibre_mode)50;
    REFUSED("mode", try_body(&wrong, &error));
    fibres.mode = PEL_FIBRE_STRAIN, fibres.kind = (pel_fibre_kind)50;
    REFUSED("kind", try_body(&wrong, &error));
    fibres.kind = PEL_FIBRE_ARAP, fibres.direction = (pel_fibre_direction)50;
    REFUSED("direction", try_body(&wrong, &error));
    fibres.direction = PEL_FIBRE_ALONG, fibres.stiffness = nan_value;
    REFUSED("stiffness", try_body(&wrong, &error));
    wrong = body, wrong.shell.pressure.kind = (pel_pressure_kind)50;
    REFUSED("pressure", try_body(&wrong, &error));
    wrong = body, wrong.shell.pressure.kind = PEL_PRESSURE_GIVEN, wrong.shell.pressure.form = (pel_pressure_form)50;
    REFUSED("pressure", try_body(&wrong, &error));
    wrong = body, wrong.shell.pressure.kind = PEL_PRESSURE_GIVEN, wrong.shell.pressure.outside.value = nan_value;
    REFUSED("pressure", try_body(&wrong, &error));
    wrong = body, wrong.shell.pressure.kind = PEL_PRESSURE_GAS, wrong.shell.pressure.gamma = nan_value;
    FAILS(try_body(&wrong, &error));
    finish();
}

/* ---- simulation: every member of the defs ---- */

static pel_sim_def make_sim(void)
{
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    return def;
}

static pel_status try_tool(const pel_tool_def *tool, pel_error *error)
{
    pel_sim *made;
    pel_sim_def def = make_sim();
    def.tools = tool;
    def.tool_count = 1;
    return pel_sim_create(&def, &made, error);
}

static pel_status try_load(const pel_load_def *load, pel_error *error)
{
    pel_sim *made;
    pel_sim_def def = make_sim();
    def.loads = load;
    def.load_count = 1;
    return pel_sim_create(&def, &made, error);
}

static pel_status try_support(const pel_support_def *support, pel_error *error)
{
    pel_sim *made;
    pel_sim_def def = make_sim();
    def.solver.method = PEL_METHOD_IMPLICIT;
    def.supports = support;
    def.support_count = 1;
    return pel_sim_create(&def, &made, error);
}

static void test_sim(void **unused)
{
    (void)unused;
    pel_sim *made;
    pel_sim_def def = make_sim(), wrong;
    double stable;
    int32_t count;
    REFUSED("def", pel_sim_create(NULL, &made, &error));
    REFUSED("sim", pel_sim_create(&def, NULL, &error));
    REFUSED("def", pel_sim_needed_substeps(NULL, &count, &error));
    REFUSED("count", pel_sim_needed_substeps(&def, NULL, &error));
    REFUSED("def", pel_sim_stable_dt(NULL, &stable, &error));
    REFUSED("dt", pel_sim_stable_dt(&def, NULL, &error));
    wrong = def, wrong.model = NULL;
    REFUSED("model", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.loads = NULL, wrong.load_count = 1;
    REFUSED("loads", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.load_count = -1;
    REFUSED("load", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.tool_count = 1;
    REFUSED("tools", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.tool_count = -1;
    REFUSED("tool", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.support_count = 1;
    REFUSED("supports", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.support_count = -1;
    REFUSED("support", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.thread_count = -1;
    REFUSED("thread", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.thread_count = INT32_MAX;
    REFUSED("thread", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.solver.method = (pel_method)50;
    REFUSED("method", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.solver.method = (pel_method)-1;
    REFUSED("method", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.solver.dt = nan_value;
    REFUSED("dt", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.solver.alpha = nan_value;
    REFUSED("alpha", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.solver.drag = nan_value;
    REFUSED("drag", pel_sim_create(&wrong, &made, &error));
    for (int i = 0; i < 2; i++) {
        int32_t absurd = i == 0 ? -1 : INT32_MAX;
        wrong = def, wrong.solver.method = PEL_METHOD_XPBD, wrong.solver.iterations = absurd;
        REFUSED("iterations", pel_sim_create(&wrong, &made, &error));
        wrong = def, wrong.solver.method = PEL_METHOD_XPBD, wrong.solver.substeps = absurd;
        REFUSED("substeps", pel_sim_create(&wrong, &made, &error));
        wrong = def, wrong.solver.method = PEL_METHOD_XPBD, wrong.solver.max_substeps = absurd;
        REFUSED("substeps", pel_sim_create(&wrong, &made, &error));
        wrong = def, wrong.solver.method = PEL_METHOD_DESCENT, wrong.solver.iterations = absurd;
        REFUSED("iterations", pel_sim_create(&wrong, &made, &error));
        wrong = def, wrong.solver.method = PEL_METHOD_STATIC, wrong.solver.analysis = PEL_ANALYSIS_MODAL,
        wrong.solver.mode_count = absurd;
        REFUSED("mode", pel_sim_create(&wrong, &made, &error));
    }
    wrong = def, wrong.solver.method = PEL_METHOD_STATIC, wrong.solver.analysis = (pel_analysis)50;
    REFUSED("analysis", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.solver.second_order = (pel_choice)50, wrong.solver.method = PEL_METHOD_XPBD;
    REFUSED("second_order", pel_sim_create(&wrong, &made, &error));
    def.contact.enabled = true, def.solver.method = PEL_METHOD_XPBD;
    wrong = def, wrong.contact.method = (pel_ccd_method)50;
    REFUSED("method", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.contact.response = (pel_contact_response)50;
    REFUSED("response", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.contact.thickness = nan_value;
    REFUSED("thickness", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.contact.friction = nan_value;
    REFUSED("friction", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.contact.sweeps = -1;
    REFUSED("sweeps", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.contact.sweeps = INT32_MAX;
    REFUSED("sweeps", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.contact.limit = -1;
    REFUSED("limit", pel_sim_create(&wrong, &made, &error));
    wrong = def, wrong.contact.memory_limit = -1;
    REFUSED("memory_limit", pel_sim_create(&wrong, &made, &error));
    finish();
}

static void test_loads_and_tools(void **unused)
{
    (void)unused;
    pel_tool_def tool = make_tool(), wrong;
    for (int i = 0; i < 2; i++) {
        wrong = tool, wrong.shape = (pel_tool_shape)(i == 0 ? -1 : 9);
        REFUSED("shape", try_tool(&wrong, &error));
        wrong = tool, wrong.body = i == 0 ? -2 : 7;
        REFUSED("body", try_tool(&wrong, &error));
    }
    wrong = tool, wrong.name = NULL;
    REFUSED("name", try_tool(&wrong, &error));
    wrong = tool, wrong.keys = NULL;
    REFUSED("keys", try_tool(&wrong, &error));
    wrong = tool, wrong.key_count = 0;
    REFUSED("key", try_tool(&wrong, &error));
    wrong = tool, wrong.key_count = -1;
    REFUSED("key", try_tool(&wrong, &error));
    wrong = tool, wrong.radius = nan_value;
    REFUSED("radius", try_tool(&wrong, &error));
    wrong = tool, wrong.shape = PEL_TOOL_MESH;
    REFUSED("mesh", try_tool(&wrong, &error));
    wrong = tool, wrong.shape = PEL_TOOL_SUPPORT, wrong.vertex_count = 3;
    REFUSED("vertices", try_tool(&wrong, &error));
    wrong = tool, wrong.friction = nan_value;
    REFUSED("friction", try_tool(&wrong, &error));
    wrong = tool, wrong.grasp = true, wrong.reach = nan_value;
    REFUSED("reach", try_tool(&wrong, &error));
    wrong = tool, wrong.grasp = true, wrong.grasp_max_force = nan_value;
    REFUSED("force", try_tool(&wrong, &error));
    pel_pose_key bad = still;
    bad.position[0] = nan_value;
    wrong = tool, wrong.keys = &bad;
    REFUSED("position", try_tool(&wrong, &error));
    bad = still, bad.rotation[3] = 0, wrong.keys = &bad;
    REFUSED("rotation", try_tool(&wrong, &error));
    bad = still, bad.rotation_vector[2] = 7e6, wrong.keys = &bad;
    REFUSED("turns too often", try_tool(&wrong, &error));
    double position[3], rotation[4];
    SURVIVES(pel_tool_def_pose(NULL, 0, position, rotation));
    SURVIVES(pel_tool_def_pose(&tool, nan_value, position, rotation));
    SURVIVES(pel_tool_def_pose(&tool, 0, NULL, rotation));
    wrong = tool, wrong.key_count = 0;
    SURVIVES(pel_tool_def_pose(&wrong, 0, position, rotation));
    pel_mesh *surface;
    const pel_tool_def shapeless = {.shape = (pel_tool_shape)77}, infinite = {.radius = (double)HUGE_VAL};
    REFUSED("def", pel_tool_def_surface(NULL, &surface, &error));
    REFUSED("mesh", pel_tool_def_surface(&tool, NULL, &error));
    REFUSED("surface", pel_tool_def_surface(&shapeless, &surface, &error));
    REFUSED("finite", pel_tool_def_surface(&infinite, &surface, &error));
    pel_load_def load = pel_load_def_default(), other;
    load.force[2] = 1;
    other = load, other.body = -1;
    REFUSED("body", try_load(&other, &error));
    other = load, other.body = INT32_MAX;
    REFUSED("body", try_load(&other, &error));
    other = load, other.kind = (pel_load_kind)50;
    REFUSED("kind", try_load(&other, &error));
    other = load, other.force[0] = nan_value;
    REFUSED("force", try_load(&other, &error));
    other = load, other.vertex_count = -1;
    REFUSED("vert", try_load(&other, &error));
    other = load, other.vertices = (const int32_t[]){-1}, other.vertex_count = 1;
    REFUSED("vertex", try_load(&other, &error));
    other = load, other.vertices = (const int32_t[]){99999}, other.vertex_count = 1;
    REFUSED("vertex", try_load(&other, &error));
    other = load, other.key_count = 2;
    REFUSED("keys", try_load(&other, &error));
    other = load, other.from = nan_value;
    REFUSED("from", try_load(&other, &error));
    pel_support_def support = pel_support_def_default(), held;
    support.name = "rim", support.vertices = (const int32_t[]){0, 1, 2}, support.vertex_count = 3;
    held = support, held.body = 9;
    REFUSED("body", try_support(&held, &error));
    held = support, held.vertices = NULL;
    REFUSED("vertices", try_support(&held, &error));
    held = support, held.vertices = (const int32_t[]){-4}, held.vertex_count = 1;
    REFUSED("vertex", try_support(&held, &error));
    held = support, held.vertex_count = -1;
    REFUSED("vert", try_support(&held, &error));
    held = support, held.stiffness = nan_value;
    REFUSED("stiffness", try_support(&held, &error));
    held = support, held.axes[0][0] = nan_value;
    REFUSED("ax", try_support(&held, &error));
    held = support, held.displacement[0] = nan_value;
    REFUSED("displacement", try_support(&held, &error));
    held = support, held.key_count = 3;
    REFUSED("keys", try_support(&held, &error));
    finish();
}

static void test_cuts(void **unused)
{
    (void)unused;
    const int32_t path[2] = {0, 100000};
    pel_cut_reading cuts;
    REFUSED("sim", pel_cut(NULL, 0, path, 2, &error));
    FAILS(pel_cut(sim, 5, path, 2, &error));
    FAILS(pel_cut(sim, 0, NULL, 2, &error));
    FAILS(pel_cut(sim, 0, path, 2, &error));
    FAILS(pel_sim_get_cuts(NULL, 0, &cuts, &error));
    FAILS(pel_sim_get_cuts(sim, -2, &cuts, &error));
    FAILS(pel_sim_get_cuts(sim, 50, &cuts, &error));
    int32_t tip_count;
    REFUSED("sim", pel_sim_tips(NULL, 0, NULL, 0, &tip_count, &error));
    REFUSED("count", pel_sim_tips(sim, 0, NULL, 0, NULL, &error));
    FAILS(pel_sim_tips(sim, -1, NULL, 0, &tip_count, &error));
    FAILS(pel_sim_tips(sim, 0, NULL, 3, &tip_count, &error));
    SURVIVES(pel_sim_cut_count(NULL));
    SURVIVES(pel_sim_cuts_done(NULL));
    SURVIVES(pel_sim_cut_is_held(NULL));
    SURVIVES(pel_sim_can_tear(NULL));
    SURVIVES(pel_sim_get_hole(NULL, NULL));
    SURVIVES(pel_sim_get_hole(sim, NULL));
    SURVIVES(pel_sim_get_score(NULL, NULL));
    SURVIVES(pel_sim_get_score(sim, NULL));
    SURVIVES(pel_seam_def_default());
    REFUSED("reading", pel_sim_get_cuts(sim, 0, NULL, &error));
    SURVIVES(pel_sim_get_origins(NULL, 0, NULL));
    SURVIVES(pel_sim_get_origins(sim, 0, NULL));
    finish();
}

static void test_sim_calls(void **unused)
{
    (void)unused;
    double nan9[9] = {nan_value, nan_value, nan_value}, quaternion[4] = {0};
    const double upright[4] = {0, 0, 0, 1};
    size_t size = pel_sim_save_size(sim);
    void *bytes = calloc(1, size);
    int64_t count;
    double *some = calloc(10000, sizeof *some);
    SURVIVES(pel_sim_destroy(NULL));
    REFUSED("sim", pel_sim_step(NULL, &error));
    REFUSED("sim", pel_sim_step_beside(NULL, NULL, 0, &error));
    FAILS(pel_sim_step_beside(sim, &sim, 1, &error));
    REFUSED("sim", pel_sim_refine(NULL, 0, 0, 1, &error));
    FAILS(pel_sim_refine(sim, 5, 0, 1, &error));
    FAILS(pel_sim_refine(sim, 0, -1, 1, &error));
    REFUSED("sim", pel_sim_set_positions(NULL, 0, some, &error));
    REFUSED("positions", pel_sim_set_positions(sim, 0, NULL, &error));
    REFUSED("body", pel_sim_set_positions(sim, -1, some, &error));
    REFUSED("body", pel_sim_set_velocities(sim, 4, some, &error));
    REFUSED("velocities", pel_sim_set_velocities(sim, 0, NULL, &error));
    REFUSED("load", pel_sim_set_load_force(sim, 4, zero3, &error));
    REFUSED("force", pel_sim_set_load_force(sim, 0, NULL, &error));
    REFUSED("tool", pel_sim_set_tool_pose(sim, -1, zero3, quaternion, &error));
    REFUSED("position", pel_sim_set_tool_pose(sim, 0, NULL, quaternion, &error));
    REFUSED("position", pel_sim_set_tool_pose(sim, 0, nan9, upright, &error));
    REFUSED("rotation", pel_sim_set_tool_pose(sim, 0, zero3, quaternion, &error));
    REFUSED("count", pel_sim_intersections(sim, NULL, &error));
    REFUSED("sim", pel_sim_intersections(NULL, &count, &error));
    REFUSED("sim", pel_sim_load(NULL, bytes, size, &error));
    REFUSED("bytes", pel_sim_load(sim, NULL, size, &error));
    FAILS(pel_sim_load(sim, bytes, 0, &error));
    FAILS(pel_sim_load(sim, bytes, size, &error));
    SURVIVES(pel_sim_save(sim, NULL));
    GIVES(pel_sim_time(NULL) == 0 && pel_sim_step_count(NULL) == 0 && pel_sim_step_bytes(NULL) == 0);
    GIVES(pel_sim_model(NULL) == NULL && pel_sim_alpha(NULL) == 0 && pel_sim_alpha_limit(NULL) == 0);
    GIVES(pel_sim_hash(NULL) == 0 && pel_sim_save_size(NULL) == 0 && pel_sim_max_speed(NULL) == 0);
    GIVES(pel_sim_tie_count(NULL) == 0 && pel_sim_tie_name(NULL, 0)[0] == '\0' && pel_sim_tie_name(sim, 0)[0] == '\0');
    SURVIVES(pel_sim_get_tie(NULL, 0, NULL));
    SURVIVES(pel_sim_get_tie(sim, 0, NULL));
    GIVES(isinf(pel_tie_def_default().until));
    GIVES(pel_sim_joint_count(NULL) == 0 && pel_sim_joint_name(NULL, 0)[0] == '\0');
    GIVES(!pel_sim_get_joint(NULL, 0, NULL) && !pel_sim_get_joint(sim, 0, NULL));
    GIVES(isinf(pel_joint_def_default().most) && pel_joint_def_default().to_body == -1);
    GIVES(pel_sim_tool_count(NULL) == 0 && pel_sim_support_count(NULL) == 0 && !pel_sim_has_shells(NULL));
    GIVES(pel_sim_body_contact_thickness(NULL, 0) == 0);
    GIVES(pel_sim_contact_thickness(NULL) == 0 && pel_sim_softness(NULL) == 0 && pel_sim_volume_ratio(NULL) == 0);
    GIVES(pel_sim_get_modes(NULL, some) == 0 && pel_sim_analysis(NULL) == PEL_ANALYSIS_NONE);
    GIVES(pel_sim_mode_value(NULL) == 0);
    pel_tool_reading tool;
    pel_support_reading support;
    for (int32_t wrong = -1; wrong < 5; wrong += 5) {
        GIVES(pel_sim_vertex_count(sim, wrong) == 0 && pel_sim_triangle_count(sim, wrong) == 0);
        GIVES(!pel_sim_refines(sim, wrong) && pel_sim_surface_revision(sim, wrong) == 0);
        SURVIVES(pel_sim_get_triangles(sim, wrong, (int32_t *)some));
        SURVIVES(pel_sim_get_rest_positions(sim, wrong, some));
        SURVIVES(pel_sim_get_levels(sim, wrong, (int32_t *)some));
        SURVIVES(pel_sim_get_mesh_places(sim, wrong, (int32_t *)some, some));
        SURVIVES(pel_sim_get_masses(sim, wrong, some));
        SURVIVES(pel_sim_get_positions(sim, wrong, some));
        SURVIVES(pel_sim_get_velocities(sim, wrong, some));
        SURVIVES(pel_sim_get_forces(sim, wrong, some));
        SURVIVES(pel_sim_get_energies(sim, wrong, some, some));
        SURVIVES(pel_sim_get_shell_energies(sim, wrong, some, some, some));
        SURVIVES(pel_sim_get_pressure_forces(sim, wrong, some));
        SURVIVES(pel_sim_get_spring_virials(sim, wrong, some));
        SURVIVES(pel_sim_get_mechanics(sim, wrong, (pel_triangle_mechanics *)(void *)some));
        SURVIVES(pel_sim_get_contact_forces(sim, wrong, some));
        SURVIVES(pel_sim_get_body_contact(sim, wrong, some));
        SURVIVES(pel_sim_get_contacts(sim, wrong, some));
        SURVIVES(pel_sim_get_support(sim, wrong, &support));
        pel_rigid_reading rigid;
        SURVIVES(pel_sim_get_rigid(sim, wrong, &rigid));
        GIVES(pel_sim_tool_name(sim, wrong)[0] == '\0' && pel_sim_support_name(sim, wrong)[0] == '\0');
        SURVIVES(pel_sim_get_tool(sim, wrong, &tool));
        SURVIVES(pel_sim_get_support_part(sim, wrong, &support));
    }
    SURVIVES(pel_sim_get_positions(sim, 0, NULL));
    SURVIVES(pel_sim_get_tool(sim, 0, NULL));
    SURVIVES(pel_sim_get_contact_statistics(sim, NULL));
    GIVES(pel_sim_contact_record_count(NULL) == 0 && pel_sim_contact_record_count(sim) == 0);
    REFUSED("sim", pel_sim_get_contact_records(NULL, NULL, &error));
    SURVIVES(pel_sim_get_contact_records(sim, NULL, NULL));
    SURVIVES(pel_sim_get_solver(sim, NULL));
    SURVIVES(pel_sim_measure(sim, NULL));
    SURVIVES(pel_sim_get_ledger(sim, NULL));
    free(some);
    free(bytes);
    finish();
}

/* ---- changes of a running simulation, and readings ---- */

static void test_parameters(void **unused)
{
    (void)unused;
    pel_parameter_info info;
    const pel_key nan_key = {nan_value, nan_value};
    const double nan3[3] = {nan_value, 0, 0};
    GIVES(pel_parameter_count(NULL) == 0);
    SURVIVES(pel_parameter_at(NULL, 0, &info));
    SURVIVES(pel_parameter_at(sim, 0, NULL));
    SURVIVES(pel_parameter_at(sim, INT32_MIN, &info));
    SURVIVES(pel_parameter_at(sim, INT32_MAX, &info));
    REFUSED("sim", pel_parameter_find(NULL, "x", &info, &error));
    REFUSED("path", pel_parameter_find(sim, NULL, &info, &error));
    REFUSED("info", pel_parameter_find(sim, "x", NULL, &error));
    FAILS(pel_parameter_find(sim, "nonsense[7].x", &info, &error));
    REFUSED("sim", pel_set_parameter(NULL, "x", 1, &error));
    REFUSED("path", pel_set_parameter(sim, NULL, 1, &error));
    FAILS(pel_set_parameter(sim, "solver.dt", nan_value, &error));
    FAILS(pel_set_parameter(sim, "solver.dt", -1, &error));
    REFUSED("sim", pel_set_parameter_vector(NULL, "x", zero3, &error));
    REFUSED("value", pel_set_parameter_vector(sim, "x", NULL, &error));
    FAILS(pel_set_parameter_vector(sim, "gravity", nan3, &error));
    REFUSED("path", pel_set_parameter_keys(sim, NULL, &nan_key, 1, &error));
    REFUSED("keys", pel_set_parameter_keys(sim, "bodies.ball.springs.stiffness", NULL, 2, &error));
    REFUSED("key_count", pel_set_parameter_keys(sim, "bodies.ball.springs.stiffness", &nan_key, -1, &error));
    FAILS(pel_set_parameter_keys(sim, "bodies.ball.springs.stiffness", &nan_key, 1, &error));
    REFUSED("text", pel_set_parameter_text(sim, "x", NULL, &error));
    FAILS(pel_set_parameter_text(sim, "solver.dt", "", &error));
    finish();
}

static void test_live(void **unused)
{
    (void)unused;
    const double nan3[3] = {nan_value, 0, 0};
    double *some = calloc(10000, sizeof *some);
    pel_load_def load = pel_load_def_default();
    pel_tool_def tool = make_tool();
    REFUSED("def", pel_sim_add_load(sim, NULL, &error));
    REFUSED("sim", pel_sim_add_load(NULL, &load, &error));
    load.body = 7;
    FAILS(pel_sim_add_load(sim, &load, &error));
    REFUSED("def", pel_sim_add_tool(sim, NULL, &error));
    tool.shape = (pel_tool_shape)50;
    FAILS(pel_sim_add_tool(sim, &tool, &error));
    FAILS(pel_sim_remove_load(sim, -1, &error));
    REFUSED("sim", pel_sim_remove_load(NULL, 0, &error));
    FAILS(pel_sim_remove_tool(sim, 99, &error));
    REFUSED("sim", pel_sim_remove_tool(NULL, 0, &error));
    GIVES(pel_sim_load_count(NULL) == 0 && pel_sim_load_name(NULL, 0)[0] == '\0' &&
          pel_sim_load_name(sim, -1)[0] == '\0');
    REFUSED("keys", pel_sim_set_tool_keys(sim, 0, NULL, 1, &error));
    FAILS(pel_sim_set_tool_keys(sim, 0, &still, -1, &error));
    FAILS(pel_sim_set_tool_keys(sim, -1, &still, 1, &error));
    REFUSED("sim", pel_sim_set_pins(NULL, 0, NULL, 0, &error));
    FAILS(pel_sim_set_pins(sim, 9, NULL, 0, &error));
    FAILS(pel_sim_set_pins(sim, 0, NULL, 3, &error));
    FAILS(pel_sim_set_pins(sim, 0, (const int32_t[]){-1}, 1, &error));
    FAILS(pel_sim_set_pins(sim, 0, (const int32_t[]){1}, -1, &error));
    REFUSED("sim", pel_sim_set_forces(NULL, 0, some, &error));
    FAILS(pel_sim_set_forces(sim, 9, some, &error));
    pel_pick_hit hit = {.is_hit = true, .body = 7, .triangle = -4};
    pel_drag *drag;
    REFUSED("origin", pel_pick(sim, NULL, zero3, &hit, &error));
    REFUSED("hit", pel_pick(sim, zero3, zero3, NULL, &error));
    FAILS(pel_pick(sim, nan3, nan3, &hit, &error));
    assert_true(pel_drag_suit_stiffness(NULL) == 0);
    REFUSED("hit", pel_drag_begin(sim, NULL, 1, 1, &drag, &error));
    REFUSED("drag", pel_drag_begin(sim, &hit, 1, 1, NULL, &error));
    FAILS(pel_drag_begin(sim, &hit, nan_value, nan_value, &drag, &error));
    REFUSED("drag", pel_drag_move(NULL, zero3, &error));
    SURVIVES(pel_drag_get(NULL, NULL));
    GIVES(pel_drag_end(NULL, NULL) == PEL_OK);
    free(some);
    finish();
}

static void test_observations(void **unused)
{
    (void)unused;
    double *some = calloc(10000, sizeof *some);
    pel_snapshot *snapshot;
    REFUSED("sim", pel_snapshot_create(NULL, &snapshot, &error));
    REFUSED("snapshot", pel_snapshot_create(sim, NULL, &error));
    SURVIVES(pel_snapshot_destroy(NULL));
    REFUSED("snapshot", pel_snapshot_restore(sim, NULL, &error));
    GIVES(pel_snapshot_size(NULL) == 0);
    GIVES(pel_field_count() > 0 && pel_field_at(-1) == NULL && pel_field_at(INT32_MAX) == NULL);
    GIVES(pel_field_find(NULL) < 0);
    REFUSED("sim", pel_observe(NULL, 0, 0, some, &error));
    REFUSED("values", pel_observe(sim, 0, 0, NULL, &error));
    FAILS(pel_observe(sim, -1, 0, some, &error));
    FAILS(pel_observe(sim, 0, 7, some, &error));
    REFUSED("values", pel_observe_triangles(sim, 0, 0, NULL, &error));
    FAILS(pel_observe_triangles(sim, INT32_MAX, 0, some, &error));
    pel_potential *potential;
    pel_hessian *hessian;
    REFUSED("sim", pel_potential_create(NULL, &potential, &error));
    REFUSED("potential", pel_potential_create(sim, NULL, &error));
    SURVIVES(pel_potential_destroy(NULL));
    GIVES(pel_potential_vertex_count(NULL) == 0);
    REFUSED("potential", pel_potential_evaluate(NULL, some, some, NULL, &error));
    REFUSED("potential", pel_potential_hessian(NULL, some, &hessian, &error));
    SURVIVES(pel_hessian_destroy(NULL));
    pel_adjoint adjoint = {.positions = NULL};
    REFUSED("sim", pel_sim_adjoint(NULL, &adjoint, &error));
    REFUSED("def", pel_sim_adjoint(sim, NULL, &error));
    FAILS(pel_sim_adjoint(sim, &adjoint, &error));
    const pel_adjoint_steps adjoint_steps = {.step_count = 1};
    REFUSED("sim", pel_sim_adjoint_steps(NULL, &adjoint_steps, &error));
    REFUSED("def", pel_sim_adjoint_steps(sim, NULL, &error));
    FAILS(pel_sim_adjoint_steps(sim, &adjoint_steps, &error));
    SURVIVES(pel_sim_load_factor(NULL));
    SURVIVES(pel_sim_path_kind(NULL));
    SURVIVES(pel_sim_get_path_end(NULL));
    SURVIVES(pel_sim_get_limit_points(NULL, NULL));
    GIVES(strlen(pel_version()) > 0 && strlen(pel_kernels()) > 0);
    free(some);
    finish();
}

/* ---- scenes and runs ---- */

static void test_scenes(void **unused)
{
    (void)unused;
    pel_mesh *read;
    REFUSED("path", pel_mesh_import(NULL, NULL, &read, &error));
    REFUSED("mesh", pel_mesh_import("a.obj", NULL, NULL, &error));
    pel_sequence *sequence;
    const int32_t row = 0;
    REFUSED("path", pel_sequence_read(NULL, NULL, 24, &sequence, &error));
    REFUSED("sequence", pel_sequence_read("a", NULL, 24, NULL, &error));
    REFUSED("fps", pel_sequence_read("a", NULL, -1, &sequence, &error));
    REFUSED("positions", pel_sequence_create(NULL, zero3, 1, 1, &sequence, &error));
    REFUSED("times", pel_sequence_create(zero3, NULL, 1, 1, &sequence, &error));
    REFUSED("sequence", pel_sequence_create(zero3, zero3, 1, 1, NULL, &error));
    REFUSED("frames", pel_sequence_create(zero3, zero3, -1, 1, &sequence, &error));
    REFUSED("sequence", pel_sequence_map(NULL, &row, 1, NULL, 0, &sequence, &error));
    assert_int_equal(pel_sequence_create(zero3, zero3, 1, 1, &sequence, NULL), PEL_OK);
    pel_sequence *mapped;
    REFUSED("rows", pel_sequence_map(sequence, NULL, 1, NULL, 0, &mapped, &error));
    REFUSED("mapped", pel_sequence_map(sequence, &row, 1, NULL, 0, NULL, &error));
    REFUSED("shift", pel_sequence_map(sequence, &row, 1, NULL, nan_value, &mapped, &error));
    REFUSED("rows", pel_sequence_map(sequence, &row, 0, NULL, 0, &mapped, &error));
    SURVIVES(pel_sequence_at(NULL, 0, NULL));
    SURVIVES(pel_sequence_at(sequence, nan_value, NULL));
    SURVIVES(pel_sequence_destroy(NULL));
    GIVES(pel_sequence_frame_count(NULL) == 0 && pel_sequence_vertex_count(NULL) == 0);
    GIVES(pel_sequence_time(NULL, 0) == 0 && pel_sequence_time(sequence, -1) == 0 &&
          pel_sequence_time(sequence, 1) == 0);
    pel_sequence_destroy(sequence);
    assert_int_equal(pel_mesh_import_child(NULL), 1);
    assert_int_equal(pel_mesh_import_child("a.obj"), 1);
    pel_scene *made;
    pel_error place = {.status = PEL_OK};
    size_t size = strlen(scene_text);
    REFUSED("path", pel_scene_load(NULL, NULL, 0, NULL, &made, &error));
    REFUSED("scene", pel_scene_load("a.yaml", NULL, 0, NULL, NULL, &error));
    REFUSED("path", pel_scene_parse(NULL, scene_text, size, NULL, 0, NULL, &made, &error));
    REFUSED("text", pel_scene_parse("a.yaml", NULL, size, NULL, 0, NULL, &made, &error));
    REFUSED("scene", pel_scene_parse("a.yaml", scene_text, size, NULL, 0, NULL, NULL, &error));
    REFUSED("overrides", pel_scene_parse("a.yaml", scene_text, size, NULL, 2, NULL, &made, &error));
    REFUSED("overrides", pel_scene_parse("a.yaml", scene_text, size, (const char *[]){NULL}, 1, NULL, &made, &error));
    REFUSED("override_count", pel_scene_parse("a.yaml", scene_text, size, NULL, -2, NULL, &made, &error));
    SURVIVES(pel_scene_destroy(NULL));
    GIVES(pel_scene_text(NULL)[0] == '\0');
    SURVIVES(pel_scene_locate(NULL, &place));
    SURVIVES(pel_scene_locate(scene, NULL));
    double frequency;
    GIVES(pel_scene_frequency(NULL, 0, &frequency) == PEL_BAD_ARGUMENT);
    GIVES(pel_scene_frequency(scene, 0, NULL) == PEL_BAD_ARGUMENT);
    GIVES(pel_scene_frequency(scene, -1, &frequency) == PEL_BAD_ARGUMENT);
    GIVES(pel_scene_frequency(scene, scene->model.body_count, &frequency) == PEL_BAD_ARGUMENT);
    REFUSED("file", pel_scene_write_schema(NULL, &error));
    REFUSED("file", pel_scene_write_reference(NULL, &error));
    REFUSED("file", pel_scene_write_parameters(NULL, &error));
    pel_run_def def = pel_run_def_default(), wrong;
    pel_run_summary summary;
    REFUSED("scene", pel_run(NULL, &def, &summary, &error));
    REFUSED("def", pel_run(scene, NULL, &summary, &error));
    REFUSED("summary", pel_run(scene, &def, NULL, &error));
    REFUSED("folder", pel_run_take_folder(NULL, false, NULL, &error));
    const char *const field = "area";
    REFUSED("folder", pel_run_add_fields(NULL, &field, 1, &error));
    REFUSED("names", pel_run_add_fields("misuse", NULL, 1, &error));
    FAILS(pel_run_add_fields("misuse", &field, 0, &error));
    def.folder = "";
    REFUSED("folder", pel_run(scene, &def, &summary, &error));
    def.folder = NULL, def.resume = "checkpoint";
    REFUSED("resume", pel_run(scene, &def, &summary, &error));
    def.folder = "misuse", def.resume = NULL;
    wrong = def, wrong.max_frames = -1;
    FAILS(pel_run(scene, &wrong, &summary, &error));
    wrong = def, wrong.keep_seconds = nan_value;
    FAILS(pel_run(scene, &wrong, &summary, &error));
    wrong = def, wrong.cookie = 0;
    FAILS(pel_run(scene, &wrong, &summary, &error));
    finish();
}

static void test_session(void **unused)
{
    (void)unused;
    pel_session *session = NULL;
    pel_hand_reading hand;
    bool done;
    char *words;
    int32_t count;
    REFUSED("scene", pel_session_create(NULL, sim, &session, &error));
    REFUSED("sim", pel_session_create(scene, NULL, &session, &error));
    REFUSED("session", pel_session_create(scene, sim, NULL, &error));
    assert_int_equal(pel_session_create(scene, sim, &session, NULL), PEL_OK);
    REFUSED("session", pel_session_apply(NULL, "mark", &error));
    REFUSED("line", pel_session_apply(session, NULL, &error));
    REFUSED("session", pel_session_step(NULL, &error));
    REFUSED("session", pel_session_undo(NULL, &done, &error));
    REFUSED("done", pel_session_undo(session, NULL, &error));
    REFUSED("session", pel_session_reset(NULL, &error));
    REFUSED("session", pel_session_record(NULL, &words, &error));
    REFUSED("text", pel_session_record(session, NULL, &error));
    REFUSED("session", pel_session_scene(NULL, &words, &error));
    REFUSED("text", pel_session_scene(session, NULL, &error));
    REFUSED("session", pel_session_repeat(NULL, &error));
    SURVIVES(pel_session_get_hand(NULL, &hand));
    SURVIVES(pel_session_get_hand(session, NULL));
    SURVIVES(pel_session_free_text(NULL));
    SURVIVES(pel_session_destroy(NULL));
    GIVES(pel_session_undo_count(NULL) == 0);
    GIVES(pel_session_pins(NULL, 0, &count) == NULL && pel_session_pins(session, 9, &count) == NULL);
    GIVES(pel_session_pins(session, 0, NULL) == NULL && pel_session_pins(session, 0, &count) != NULL && count > 0);
    GIVES(pel_session_pressure(NULL, 0) == 0 && pel_session_pressure(session, -1) == 0);
    GIVES(pel_session_tool_mesh(NULL) == NULL && pel_session_tool_mesh(session) == NULL);
    pel_session_destroy(session);
    finish();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_results),      cmocka_unit_test(test_model),           cmocka_unit_test(test_shell),
        cmocka_unit_test(test_sim),          cmocka_unit_test(test_loads_and_tools), cmocka_unit_test(test_cuts),
        cmocka_unit_test(test_sim_calls),    cmocka_unit_test(test_parameters),      cmocka_unit_test(test_live),
        cmocka_unit_test(test_observations), cmocka_unit_test(test_scenes),          cmocka_unit_test(test_session),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
