/* The rows of the table of members: each is whole, fits its member, and says what a parameter is. */
#include "check.h"

#include "def/row.h"

/* bytes of the defs; 0 = no rows in the core */
static const size_t def_sizes[PEL_DEF_COUNT] = {
    [PEL_DEF_BODY] = sizeof(pel_body_def),       [PEL_DEF_FIBRES] = sizeof(pel_anisotropy_def),
    [PEL_DEF_SUPPORT] = sizeof(pel_support_def), [PEL_DEF_MODEL] = sizeof(pel_model_def),
    [PEL_DEF_LOAD] = sizeof(pel_load_def),       [PEL_DEF_TOOL] = sizeof(pel_tool_def),
    [PEL_DEF_CONTACT] = sizeof(pel_contact_def), [PEL_DEF_SOLVER] = sizeof(pel_solver_def),
    [PEL_DEF_SIM] = sizeof(pel_sim_def),         [PEL_DEF_CUT] = sizeof(pel_cut_def),
    [PEL_DEF_JOINT] = sizeof(pel_joint_def),     [PEL_DEF_TIE] = sizeof(pel_tie_def),
    [PEL_DEF_SEAM] = sizeof(pel_seam_def),
};

static bool has_count(const pel_def_row *row)
{
    return row->store == PEL_STORE_KEYS || row->store == PEL_STORE_LIST || row->store == PEL_STORE_DEFS;
}

static void test_members(void **unused)
{
    (void)unused;
    int count = 0;
    for (int32_t i = 0; i < pel_def_row_count(); i++) {
        const pel_def_row *row = pel_def_row_at(i);
        assert_true(row->path != NULL || row->def != PEL_DEF_NONE);
        if (row->def == PEL_DEF_NONE)
            continue;
        count++;
        size_t bytes = has_count(row) ? sizeof(void *) : row->size;
        assert_true(row->offset + bytes <= def_sizes[row->def]);
        assert_int_equal(row->count_offset > 0, has_count(row));
        assert_int_equal(row->element != PEL_DEF_NONE, row->store == PEL_STORE_DEF || row->store == PEL_STORE_DEFS);
        assert_int_equal(row->refusal == NULL, row->remedy == NULL);
        assert_true(row->automatic == 0 || row->may_be_auto);
        /* rows that share a member agree on what it is */
        const pel_def_row *first = pel_def_row_of(row->def, row->offset);
        assert_true(first->store == row->store && first->part == row->part && first->size == row->size);
    }
    assert_true(count > 120);
    assert_null(pel_def_row_at(-1));
    assert_null(pel_def_row_at(pel_def_row_count()));
}

/* every member once, in the order of the struct */
static void test_order(void **unused)
{
    (void)unused;
    for (int kind = PEL_DEF_BODY; kind < PEL_DEF_COUNT; kind++) {
        size_t end = 0;
        const pel_def_row *members[PEL_MOST_MEMBERS];
        int32_t count = pel_def_members((pel_def_kind)kind, members);
        for (int32_t i = 0; i < count; i++) {
            assert_true(members[i]->offset >= end);
            end = members[i]->offset + (has_count(members[i]) ? sizeof(void *) : members[i]->size);
        }
        assert_int_equal(count > 0, def_sizes[kind] > 0);
        assert_true(count < PEL_MOST_MEMBERS);
    }
}

static void test_parameters(void **unused)
{
    (void)unused;
    int count = 0, kind = PEL_DEF_NONE;
    for (int32_t i = -1; (i = pel_def_parameter_after(i)) >= 0; count++) {
        const pel_def_row *row = pel_def_row_at(i);
        assert_true((int)row->def >= kind);
        kind = (int)row->def;
        const char *const *words = pel_def_row_words(row);
        assert_int_equal(words != NULL, pel_def_row_kind(row) == PEL_PARAMETER_WORD);
        assert_true(words == NULL || (words[0] != NULL && words[1] != NULL));
        assert_true(row->parameter_path == NULL || row->path[0] == '<');
    }
    assert_true(count > 80);
    /* these decide what a simulation is */
    for (int32_t i = -1; (i = pel_def_parameter_after(i)) >= 0;) {
        const char *path = pel_def_row_at(i)->path;
        assert_true(strcmp(path, "tools[].shape") != 0 && strcmp(path, "bodies[].pinned") != 0);
        assert_true(strcmp(path, "bodies[].name") != 0 && strcmp(path, "solver.path") != 0);
    }
}

static void test_defaults(void **unused)
{
    (void)unused;
    const pel_body_def body = pel_body_def_default();
    const pel_load_def load = pel_load_def_default();
    const pel_tool_def tool = pel_tool_def_default();
    const pel_sim_def sim = pel_sim_def_default();
    /* paper A */
    assert_true(body.mass_kind == PEL_MASS_PER_VERTEX && body.mass == 1 && body.reference_count == 252);
    assert_true(body.spring_stiffness.value == 3 && body.spring_damping.value == 0.5);
    assert_true(body.volumetric_stiffness.value == 1.5 && body.volumetric_damping.value == 0.5);
    assert_true(body.friction == -1 && body.refine.dwell == 50 && body.refine.levels == 0);
    assert_true(body.shell.bending.weight == 0.01 && body.shell.bending.stiffness.value == -1);
    assert_true(body.shell.membrane.poisson == 0.3 && !body.shell.membrane.on);
    assert_true(isinf(load.until) && load.from == 0);
    assert_true(tool.body == -1 && tool.press && !tool.grasp && isinf(tool.grasp_until));
    assert_true(sim.solver.dt == 0.01 && sim.solver.symplectic && sim.solver.second_order == PEL_AUTO);
    assert_true(sim.contact.self && !sim.contact.enabled && sim.contact.relative_thickness == 0);
}

static const pel_def_row *row_of_path(const char *path)
{
    for (int32_t i = 0; i < pel_def_row_count(); i++)
        if (pel_def_row_at(i)->path != NULL && strcmp(pel_def_row_at(i)->path, path) == 0)
            return pel_def_row_at(i);
    fail_msg("no row %s", path);
    return NULL;
}

static void test_values(void **unused)
{
    (void)unused;
    pel_tool_def tool = pel_tool_def_default();
    pel_body_def body = pel_body_def_default();
    pel_contact_def contact = pel_sim_def_default().contact;
    const double size[3] = {2, 4, 6}, nan = (double)NAN, tiny = 0.25, five = 5;
    pel_member_set(row_of_path("tools[].size"), &tool, size);
    assert_true(tool.half_extents[0] == 1 && tool.half_extents[1] == 2 && tool.half_extents[2] == 3);
    pel_member_set(row_of_path("tools[].friction"), &tool, &five);
    assert_true(tool.friction == 5);
    pel_member_set(row_of_path("tools[].friction"), &tool, &nan);
    assert_true(tool.friction == -1);
    pel_member_set(row_of_path("bodies[].pressure.inside"), &body, &five);
    assert_true(body.shell.pressure.outside.value == -5);
    /* a number of bytes that is given is at least 1 */
    pel_member_set(row_of_path("contact.memory_limit"), &contact, &tiny);
    assert_int_equal(contact.memory_limit, 1);

    const pel_def_row *row = row_of_path("bodies[].pressure.outside");
    const pel_key keys[2] = {{0, 1}, {1, 2}};
    int32_t count;
    assert_null(pel_member_keys(row, &body, &count));
    pel_member_set_keys(row, &body, keys, 2);
    assert_ptr_equal(pel_member_keys(row, &body, &count), keys);
    assert_int_equal(count, 2);
    assert_true(body.shell.pressure.outside.value == 0);
    pel_load_def load = pel_load_def_default();
    pel_member_set_keys(row_of_path("loads[].keys"), &load, keys, 1);
    assert_ptr_equal(load.keys, keys);
    assert_int_equal(load.key_count, 1);
    assert_true(pel_def_row_may_be_keyed(row) && !pel_def_row_may_be_keyed(row_of_path("solver.drag")));
}

static void test_ranges(void **unused)
{
    (void)unused;
    char text[40];
    const pel_range above = {true, true, 0, HUGE_VAL}, between = {true, false, 1, 6}, none = {0};
    assert_string_equal(pel_range_text(above, text, sizeof text), "> 0");
    assert_string_equal(pel_range_text(between, text, sizeof text), "1 to 6");
    assert_string_equal(pel_range_text(none, text, sizeof text), "");
    assert_true(pel_range_has(above, 1e-300) && !pel_range_has(above, 0) && pel_range_has(none, -1));
    assert_true(pel_range_has(between, 1) && pel_range_has(between, 6) && !pel_range_has(between, 6.5));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_members),  cmocka_unit_test(test_order),  cmocka_unit_test(test_parameters),
        cmocka_unit_test(test_defaults), cmocka_unit_test(test_values), cmocka_unit_test(test_ranges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
