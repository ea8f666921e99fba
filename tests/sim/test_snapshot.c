/* Snapshots: one made with any other member of a def is refused with the name of the difference; so are other versions,
   other precisions and damage, and a refusal changes nothing. */
#include "contact/set.h"
#include "failing_malloc.h"
#include "sim/fixture.h"
#include "sim/snapshot.h"

/* all that a sim is made from; addresses are taken of the members, so it lies still */
typedef struct setup {
    pel_mesh *mesh, *other_mesh;
    int32_t pinned[2], region[2], pressed[3];
    double field[1000], weights[1000];
    pel_key keys[3];
    pel_pose_key poses[3];
    pel_anisotropy_def fibres[2];
    pel_body_def body;
    pel_load_def loads[2];
    pel_tool_def tools[2];
    pel_model_def model;
    pel_sim_def sim;
} setup;

static setup *make_setup(void)
{
    setup *s = calloc(1, sizeof *s);
    assert_non_null(s);
    s->mesh = make_sphere(4);
    s->other_mesh = make_sphere(4);
    s->other_mesh->positions[7][1] += 1e-9;
    assert_true(s->mesh->vertex_count <= 1000);
    for (int i = 0; i < 1000; i++)
        s->field[i] = s->weights[i] = 0.5;
    for (int i = 0; i < 2; i++) {
        s->region[i] = 3 + i;
        s->pinned[i] = nearest_vertex(s->mesh, 0, 0.1 * i, -1);
        s->loads[i] = pel_load_def_default();
        s->tools[i] = pel_tool_def_default();
        s->tools[i].name = i == 0 ? "probe" : "clamp";
        s->tools[i].keys = s->poses;
        s->tools[i].key_count = 2;
        s->tools[i].radius = 0.2;
    }
    for (int i = 0; i < 3; i++) {
        s->pressed[i] = 10 + i;
        s->keys[i] = (pel_key){i, 1 - 0.1 * i};
        s->poses[i] = (pel_pose_key){.time = 0.1 * i, .position = {0, 0, 1.3 - 0.1 * i}, .rotation = {0, 0, 0, 1}};
    }
    s->body = pel_body_def_default();
    s->body.name = "ball";
    s->body.mesh = s->mesh;
    s->body.pinned = s->pinned;
    s->body.pinned_count = 1;
    s->loads[0].force[0] = 0.1;
    s->loads[0].weights = s->weights;
    s->model = pel_model_def_default();
    s->model.bodies = &s->body;
    s->model.body_count = 1;
    s->sim = pel_sim_def_default();
    s->sim.solver.method = PEL_METHOD_EXPLICIT;
    s->sim.solver.dt = 1e-3;
    s->sim.loads = s->loads;
    s->sim.load_count = 1;
    s->sim.tools = s->tools;
    s->sim.tool_count = 1;
    s->sim.thread_count = 1;
    return s;
}

static void free_setup(setup *s)
{
    pel_mesh_destroy(s->mesh);
    pel_mesh_destroy(s->other_mesh);
    free(s);
}

/* springs that refine, with contact */
static setup *make_springs(void)
{
    setup *s = make_setup();
    pel_refine_def *refine = &s->body.refine;
    *refine = (pel_refine_def){.levels = 2,
                               .above = 4,
                               .below = 2,
                               .curvature_above = 1,
                               .curvature_below = 0.5,
                               .near_tools = 0.1,
                               .region = s->region,
                               .region_count = 2,
                               .rings = 2,
                               .dwell = 50,
                               .interval = 10,
                               .budget = 50000};
    s->sim.contact.enabled = true;
    s->sim.contact.thickness = 1e-3;
    s->sim.contact.friction = 0.5;
    s->sim.contact.sweeps = 10;
    s->sim.contact.limit = 1000;
    s->tools[0].grasp = true;
    s->tools[0].reach = 0.1;
    s->tools[0].grasp_until = 2;
    return s;
}

/* a shell with all that one may have */
static setup *make_shell(void)
{
    setup *s = make_setup();
    pel_shell_def *shell = &s->body.shell;
    s->sim.solver.method = PEL_METHOD_XPBD;
    s->sim.solver.substeps = 20;
    shell->membrane.on = true;
    shell->membrane.young = (pel_quantity){.value = 1000};
    shell->membrane.thickness = (pel_quantity){.value = 0.01};
    shell->bending.model = PEL_BENDING_HINGE;
    s->fibres[0] = s->fibres[1] = pel_anisotropy_def_default();
    s->fibres[0].mode = PEL_FIBRE_ACTIVE;
    s->fibres[0].stiffness = 1;
    s->fibres[0].rest_length.value = 0.9;
    s->fibres[0].direction = PEL_FIBRE_ALONG;
    s->fibres[0].axis[0] = 1;
    s->fibres[1].mode = PEL_FIBRE_STRAIN;
    s->fibres[1].stiffness = 0.1;
    shell->anisotropies = s->fibres;
    shell->anisotropy_count = 2;
    shell->pressure.kind = PEL_PRESSURE_GIVEN;
    shell->pressure.outside = (pel_quantity){.value = 1};
    return s;
}

/* ---- one change each; the part that it is of, null = there are no more ---- */

static const char *change_model(setup *s, int change)
{
    pel_body_def *body = &s->body;
    switch (change) {
    case 0:
        return body->mesh = s->other_mesh, "mesh";
    case 1:
        return body->mass *= 1.01, "mass";
    case 2:
        return body->mass_kind = PEL_MASS_TOTAL, "mass";
    case 3:
        return body->thickness.value = 2, "mass";
    case 4:
        return body->spring_stiffness.value += 1e-9, "springs";
    case 5:
        return body->spring_stiffness.field = s->field, "springs";
    case 6:
        return body->spring_damping.value = 0.4, "springs";
    case 7:
        return body->spring_damping.keys = s->keys, body->spring_damping.key_count = 2, "springs";
    case 8:
        return body->volumetric_stiffness.value = 1, "volumetric springs";
    case 9:
        return body->volumetric_damping.value = 1, "volumetric springs";
    case 10:
        return body->volumetric_by_area = true, "volumetric springs";
    case 11:
        return body->reference_count = 100, "volumetric springs";
    case 12:
        return body->pinned_count = 2, "pinned vertices";
    case 13:
        return s->pinned[0]++, "pinned vertices";
    case 14:
        return body->friction = 0.1, "contact of a body";
    case 15:
        return s->model.gravity[2] = -9.81, "gravity";
    default:
        return NULL;
    }
}

static const char *change_sim(setup *s, int change)
{
    pel_load_def *load = s->loads;
    pel_tool_def *tool = s->tools;
    pel_solver_def *solver = &s->sim.solver;
    switch (change) {
    case 0:
        return load->force[0] += 0.1, "loads";
    case 1:
        return load->kind = PEL_LOAD_PER_VERTEX, "loads";
    case 2:
        return s->weights[40] = 0.75, "loads";
    case 3:
        return load->vertices = s->pressed, load->vertex_count = 3, "loads";
    case 4:
        return load->until = 1, "loads";
    case 5:
        return load->keys = s->keys, load->key_count = 2, "loads";
    case 6:
        return s->sim.load_count = 2, "loads";
    case 7:
        return s->sim.load_count = 0, "loads";
    case 8:
        return tool->radius = 0.21, "tools";
    case 9:
        return tool->shape = PEL_TOOL_BOX, tool->half_extents[0] = tool->half_extents[1] = 0.1,
               tool->half_extents[2] = 0.1, "tools";
    case 10:
        return s->poses[1].position[0] = 0.1, "tools";
    case 11:
        return s->poses[1].rotation_vector[0] = 0.1, "tools";
    case 12:
        return tool->key_count = 3, "tools";
    case 13:
        return tool->body = 0, "tools";
    case 14:
        return tool->press = false, "tools";
    case 15:
        return tool->friction = 0.3, "tools";
    case 16:
        return s->sim.tool_count = 2, "tools";
    case 17:
        return s->sim.tool_count = 0, "tools";
    case 18:
        return solver->dt *= 0.5, "solver";
    case 19:
        return solver->drag = 0.1, "solver";
    case 20:
        return solver->method = PEL_METHOD_PBD, "solver";
    default:
        return NULL;
    }
}

static const char *change_springs(setup *s, int change)
{
    pel_refine_def *refine = &s->body.refine;
    pel_contact_def *contact = &s->sim.contact;
    pel_tool_def *tool = s->tools;
    switch (change) {
    case 0:
        return refine->levels = 1, "refinement";
    case 1:
        return refine->above = 5, "refinement";
    case 2:
        return refine->below = 1, "refinement";
    case 3:
        return refine->curvature_above = 2, "refinement";
    case 4:
        return refine->curvature_below = 0.4, "refinement";
    case 5:
        return refine->near_tools = 0.2, "refinement";
    case 6:
        return s->region[1] = 6, "refinement";
    case 7:
        return refine->region_count = 1, "refinement";
    case 8:
        return refine->region_levels = 1, "refinement";
    case 9:
        return refine->rings = 1, "refinement";
    case 10:
        return refine->dwell++, "refinement";
    case 11:
        return refine->interval++, "refinement";
    case 12:
        return refine->budget++, "refinement";
    case 13:
        return refine->springs = PEL_REFINE_UNCHANGED, "refinement";
    case 14:
        return contact->self = false, "contact";
    case 15:
        return contact->between = false, "contact";
    case 16:
        return contact->thickness *= 0.875, "contact";
    case 17:
        return contact->relative_thickness = 2e-4, "contact";
    case 18:
        return contact->friction = 0.25, "contact";
    case 19:
        return contact->method = PEL_CCD_BRIDSON, "contact";
    case 20:
        return contact->response = PEL_CONTACT_AFTER, "contact";
    case 21:
        return contact->allow_tangled = true, "contact";
    case 22:
        return contact->sweeps++, "contact";
    case 23:
        return contact->limit++, "contact";
    case 24:
        return contact->memory_limit = 1 << 29, "contact";
    case 25:
        return contact->enabled = false, "contact";
    case 26:
        return tool->grasp = false, "tools";
    case 27:
        return tool->grasp_from = 0.1, "tools";
    case 28:
        return tool->grasp_until = 3, "tools";
    case 29:
        return tool->reach = 0.2, "tools";
    case 30:
        return tool->grasp_max_force = 3, "tools";
    case 31:
        return s->sim.solver.symplectic = false, "solver";
    case 32:
        return s->body.restitution = 0.5, "contact of a body";
    case 33:
        return s->body.contact_thickness = 5e-4, "contact of a body";
    case 34:
        return tool->restitution = 0.5, "tools";
    case 35:
        return tool->thickness = 5e-4, "tools";
    case 36:
        return contact->restitution = 0.5, "contact";
    default:
        return NULL;
    }
}

static const char *change_shell(setup *s, int change)
{
    pel_shell_def *shell = &s->body.shell;
    pel_membrane_def *membrane = &shell->membrane;
    pel_anisotropy_def *fibres = s->fibres;
    pel_pressure_def *pressure = &shell->pressure;
    pel_solver_def *solver = &s->sim.solver;
    switch (change) {
    case 0:
        return membrane->young.value += 1, "membrane";
    case 1:
        return membrane->young.field = s->field, "membrane";
    case 2:
        return membrane->poisson = 0.2, "membrane";
    case 3:
        return membrane->thickness.value *= 1.01, "membrane";
    case 4:
        return membrane->kind = PEL_MEMBRANE_GENT, "membrane";
    case 5:
        return membrane->mooney_ratio = 0.3, "membrane";
    case 6:
        return membrane->extension_limit = 30, "membrane";
    case 7:
        return membrane->stiffening = 5, "membrane";
    case 8:
        return membrane->strain_limit = 0.1, "membrane";
    case 9:
        return shell->bending.model = PEL_BENDING_ISOMETRIC, "bending";
    case 10:
        return shell->bending.weight = 0.5, "bending";
    case 11:
        return shell->bending.stiffness.value = 1e-3, "bending";
    case 12:
        return fibres->stiffness = 2, "anisotropy";
    case 13:
        return fibres->rest_length.value = 0.8, "anisotropy";
    case 14:
        return fibres->rest_length.keys = s->keys, fibres->rest_length.key_count = 2, "anisotropy";
    case 15:
        return fibres->axis[1] = 1, "anisotropy";
    case 16:
        return fibres->weights = s->field, "anisotropy";
    case 17:
        return fibres[1].curvature = 0.8, "anisotropy";
    case 18:
        return fibres->direction = PEL_FIBRE_TO_CENTER, "anisotropy";
    case 19:
        return fibres->kind = PEL_FIBRE_SQRT, "anisotropy";
    case 20:
        return shell->anisotropy_count = 1, "anisotropy";
    case 21:
        return pressure->outside.value = 2, "pressure";
    case 22:
        return pressure->outside.field = s->field, "pressure";
    case 23:
        return pressure->weights = s->field, "pressure";
    case 24:
        return pressure->kind = PEL_PRESSURE_GAS, pressure->value = 100, "pressure";
    case 25:
        return pressure->gamma = 1.2, "pressure";
    case 26:
        return solver->iterations = 3, "solver";
    case 27:
        return solver->substeps = 21, "solver";
    case 28:
        return solver->max_substeps = 300, "solver";
    case 29:
        return solver->second_order = PEL_NO, "solver";
    default:
        return NULL;
    }
}

/* ---- the test of them all ---- */

typedef struct made_sim {
    pel_model *model;
    pel_sim *sim;
} made_sim;

static made_sim make(setup *s)
{
    made_sim made;
    pel_error error;
    char text[800];
    pel_status status = pel_model_create(&s->model, &made.model, &error);
    s->sim.model = made.model;
    if (status == PEL_OK)
        status = pel_sim_create(&s->sim, &made.sim, &error);
    if (status != PEL_OK)
        print_error("%s\n", pel_error_text(&error, text, sizeof text));
    assert_int_equal(status, PEL_OK);
    return made;
}

static void destroy(made_sim made)
{
    pel_sim_destroy(made.sim);
    pel_model_destroy(made.model);
}

/* a snapshot after some steps of an unchanged setup, which is freed */
static void *snapshot_of(setup *s, size_t *size)
{
    made_sim made = make(s);
    run_steps(made.sim, 5);
    *size = pel_sim_save_size(made.sim);
    void *bytes = malloc(*size);
    assert_non_null(bytes);
    pel_sim_save(made.sim, bytes);
    destroy(made);
    free_setup(s);
    return bytes;
}

static void check_refused(pel_sim *sim, const void *bytes, size_t size, const char *what)
{
    pel_error error;
    uint64_t hash = pel_sim_hash(sim);
    assert_int_equal(pel_sim_load(sim, bytes, size, &error), PEL_BAD_FORMAT);
    assert_string_equal(error.what, what);
    assert_true(error.remedy[0] != '\0');
    assert_true(pel_sim_hash(sim) == hash);
}

typedef const char *(*changer)(setup *s, int change);

static void check_changes(setup *(*begin)(void), changer change_defs, int least)
{
    size_t size;
    void *bytes = snapshot_of(begin(), &size);
    char what[200];
    int change = 0;
    for (const char *part = ""; part != NULL; change++) {
        setup *s = begin();
        part = change_defs(s, change);
        made_sim made = make(s);
        if (part != NULL) {
            snprintf(what, sizeof what, "the snapshot was made with other: %s", part);
            check_refused(made.sim, bytes, size, what);
        } else {
            assert_int_equal(pel_sim_load(made.sim, bytes, size, NULL), PEL_OK);
        }
        destroy(made);
        free_setup(s);
    }
    assert_true(change > least);
    free(bytes);
}

static void test_changes(void **unused)
{
    (void)unused;
    setup *(*const begins[])(void) = {make_setup, make_springs, make_shell};
    for (int i = 0; i < 3; i++) {
        check_changes(begins[i], change_model, 16);
        check_changes(begins[i], change_sim, 21);
    }
    check_changes(make_springs, change_springs, 37);
    check_changes(make_shell, change_shell, 30);
}

/* a snapshot of fewer or more vertices, whose surfaces cannot be those of the simulation */
static void test_other_sizes(void **unused)
{
    (void)unused;
    size_t size;
    void *bytes = snapshot_of(make_setup(), &size);
    for (int frequency = 3; frequency <= 5; frequency += 2) {
        setup *s = make_setup();
        pel_mesh_destroy(s->mesh);
        s->body.mesh = s->mesh = make_sphere(frequency);
        s->pinned[0] = nearest_vertex(s->mesh, 0, 0, -1);
        made_sim made = make(s);
        pel_error error;
        assert_int_equal(pel_sim_load(made.sim, bytes, size, &error), PEL_BAD_FORMAT);
        assert_non_null(strstr(error.what, "the snapshot was made with other: mesh"));
        destroy(made);
        free_setup(s);
    }
    free(bytes);
}

/* members that do not affect results may differ */
static void test_no_change(void **unused)
{
    (void)unused;
    size_t size;
    void *bytes = snapshot_of(make_springs(), &size);
    setup *s = make_springs();
    s->body.name = "another";
    s->tools[0].name = "another";
    s->sim.thread_count = 2;
    s->body.refine.memory_limit = 1 << 28;
    made_sim made = make(s);
    assert_int_equal(pel_sim_load(made.sim, bytes, size, NULL), PEL_OK);
    run_steps(made.sim, 5);
    destroy(made);
    free_setup(s);
    free(bytes);
}

/* ---- versions and damage ---- */

static void test_versions(void **unused)
{
    (void)unused;
    setup *s = make_setup();
    made_sim made = make(s);
    size_t size = pel_sim_save_size(made.sim);
    unsigned char *bytes = malloc(size);
    uint32_t version, old;
    assert_non_null(bytes);
    pel_sim_save(made.sim, bytes);
    memcpy(&version, bytes + 8, sizeof version);
    /* those before 5 had neither checksum nor fingerprint */
    for (old = 1; old < version; old++) {
        char what[200];
        memcpy(bytes + 8, &old, sizeof old);
        snprintf(what, sizeof what, "the snapshot has version %u of the format, not %u", old, version);
        check_refused(made.sim, bytes, size, what);
        check_refused(made.sim, bytes, 40, what);
    }
    memcpy(bytes + 8, &version, sizeof version);
    bytes[12] = sizeof(pel_real) == 8 ? 4 : 8;
    pel_snapshot_seal(bytes, size);
    check_refused(made.sim, bytes, size,
                  sizeof(pel_real) == 8 ? "the snapshot is of single precision"
                                        : "the snapshot is of double precision");
    bytes[0] = 'Q';
    check_refused(made.sim, bytes, size, "not a snapshot");
    check_refused(made.sim, bytes, 0, "not a snapshot");
    free(bytes);
    destroy(made);
    free_setup(s);
}

/* any byte that differs is seen before anything is touched */
static void test_damage(void **unused)
{
    (void)unused;
    setup *s = make_springs();
    made_sim made = make(s);
    run_steps(made.sim, 20);
    size_t size = pel_sim_save_size(made.sim);
    unsigned char *bytes = malloc(size);
    assert_non_null(bytes);
    pel_sim_save(made.sim, bytes);
    run_steps(made.sim, 1);
    for (size_t at = 16; at < size; at += 1 + at / 50) {
        bytes[at] ^= (unsigned char)(1 << at % 8);
        pel_error error;
        uint64_t hash = pel_sim_hash(made.sim);
        assert_int_equal(pel_sim_load(made.sim, bytes, size, &error), PEL_BAD_FORMAT);
        assert_true(pel_sim_hash(made.sim) == hash);
        assert_false(pel_snapshot_is_valid(made.sim, bytes));
        bytes[at] ^= (unsigned char)(1 << at % 8);
    }
    assert_true(pel_snapshot_is_valid(made.sim, bytes));
    for (size_t cut = 16; cut < size; cut += 1 + cut / 3)
        check_refused(made.sim, bytes, cut, "the snapshot is cut short");
    assert_int_equal(pel_sim_load(made.sim, bytes, size, NULL), PEL_OK);
    free(bytes);
    destroy(made);
    free_setup(s);
}

/* deliberately changed bytes with the right checksum are loaded or refused; steps may fail or not */
static void test_forged(void **unused)
{
    (void)unused;
    for (int i = 0; i < 2; i++) {
        setup *s = i == 0 ? make_springs() : make_shell();
        s->sim.contact.enabled = true;
        s->sim.contact.memory_limit = 1 << 22;
        made_sim made = make(s);
        run_steps(made.sim, 20);
        size_t size = pel_sim_save_size(made.sim);
        unsigned char *good = malloc(size), *bad = malloc(size);
        assert_true(good != NULL && bad != NULL);
        pel_sim_save(made.sim, good);
        const uint32_t words[3] = {UINT32_MAX, INT32_MAX, 0x01010101};
        int refused = 0;
        size_t stride = 4 * (1 + size / LONG(1000, ROUNDS(400, 200)));
        for (size_t at = 16; at + 4 <= size; at += stride)
            for (int w = 0; w < 3; w++) {
                memcpy(bad, good, size);
                memcpy(bad + at, &words[w], 4);
                pel_snapshot_seal(bad, size);
                refused += pel_sim_load(made.sim, bad, size, NULL) != PEL_OK;
                (void)pel_sim_step(made.sim, NULL);
            }
        assert_true(refused > 0);
        assert_int_equal(pel_sim_load(made.sim, good, size, NULL), PEL_OK);
        run_steps(made.sim, 5);
        free(good);
        free(bad);
        destroy(made);
        free_setup(s);
    }
}

/* ---- steps after a load ---- */

/* the search for pairs continues its counts, for any surface of the loading sim */
static void test_statistics(void **unused)
{
    (void)unused;
    for (int steps = 1; steps < 200; steps += LONG(37, 100)) {
        setup *s = make_springs();
        made_sim made = make(s), other = make(s);
        pel_contact_statistics a, b;
        run_steps(made.sim, steps);
        run_steps(other.sim, 90);
        size_t size = pel_sim_save_size(made.sim);
        void *bytes = malloc(size);
        assert_non_null(bytes);
        pel_sim_save(made.sim, bytes);
        assert_int_equal(pel_sim_load(other.sim, bytes, size, NULL), PEL_OK);
        for (int i = 0; i < 60; i++) {
            run_steps(made.sim, 1);
            run_steps(other.sim, 1);
            pel_sim_get_contact_statistics(made.sim, &a);
            pel_sim_get_contact_statistics(other.sim, &b);
            assert_memory_equal(&a, &b, offsetof(pel_contact_statistics, find_seconds));
            assert_true(pel_sim_hash(made.sim) == pel_sim_hash(other.sim));
        }
        free(bytes);
        destroy(made);
        destroy(other);
        free_setup(s);
    }
}

/* which pairs a substep looks at goes by its number, which counts all steps */
static void test_substep_number(void **unused)
{
    (void)unused;
    setup *s = make_shell();
    s->sim.contact.enabled = true;
    s->sim.solver.method = PEL_METHOD_PBD;
    s->sim.solver.substeps = 3;
    made_sim made = make(s), other = make(s);
    run_steps(made.sim, 5);
    run_steps(other.sim, 2);
    size_t size = pel_sim_save_size(made.sim);
    void *bytes = malloc(size);
    assert_non_null(bytes);
    pel_sim_save(made.sim, bytes);
    assert_int_equal(pel_sim_load(other.sim, bytes, size, NULL), PEL_OK);
    assert_true(made.sim->contacts->substep > 0);
    assert_int_equal(other.sim->contacts->substep, made.sim->contacts->substep);
    free(bytes);
    destroy(made);
    destroy(other);
    free_setup(s);
}

/* the first step after a load allocates; it fails cleanly when it cannot, and works when it can again */
static void test_memory_runs_out(void **unused)
{
    (void)unused;
    setup *s = make_springs();
    made_sim made = make(s);
    run_steps(made.sim, 10);
    size_t size = pel_sim_save_size(made.sim);
    void *bytes = malloc(size);
    assert_non_null(bytes);
    pel_sim_save(made.sim, bytes);
    run_steps(made.sim, 1);
    uint64_t hash = pel_sim_hash(made.sim);
    pel_status status = PEL_OUT_OF_MEMORY;
    for (long n = 1; status != PEL_OK; n++) {
        assert_int_equal(pel_sim_load(made.sim, bytes, size, NULL), PEL_OK);
        failing_malloc_begin(n);
        status = pel_sim_step(made.sim, NULL);
        failing_malloc_end();
        assert_true(status == PEL_OK || status == PEL_OUT_OF_MEMORY);
        assert_true(n < 1000);
    }
    assert_int_equal(pel_sim_load(made.sim, bytes, size, NULL), PEL_OK);
    run_steps(made.sim, 1);
    assert_true(pel_sim_hash(made.sim) == hash);
    free(bytes);
    destroy(made);
    free_setup(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_changes),        cmocka_unit_test(test_other_sizes),
        cmocka_unit_test(test_no_change),      cmocka_unit_test(test_versions),
        cmocka_unit_test(test_damage),         cmocka_unit_test(test_forged),
        cmocka_unit_test(test_statistics),     cmocka_unit_test(test_memory_runs_out),
        cmocka_unit_test(test_substep_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
