/* The table and its outputs: every row is documented, in the schema, on the reference page and settable. */
#include "check.h"
#include "comma_locale.h"
#include "failing_malloc.h"

#include "keys/override.h"
#include "keys/table.h"
#include "keys/validate.h"
#include "keys/yaml.h"
#include "pellicle/scene.h"

#include <stdlib.h>

typedef pel_status write_document(FILE *file, pel_error *error);

/* output of a writer; to be freed */
static char *document(write_document *write)
{
    FILE *file = tmpfile();
    assert_non_null(file);
    assert_int_equal(write(file, NULL), PEL_OK);
    size_t size = (size_t)ftell(file);
    char *text = calloc(size + 1, 1);
    rewind(file);
    assert_int_equal(fread(text, 1, size, file), size);
    fclose(file);
    return text;
}

static const char *last_name(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot != NULL ? dot + 1 : path;
}

static void test_rows_are_whole(void **unused)
{
    (void)unused;
    pel_arena arena = {0};
    const pel_scene_table *table = pel_scene_table_create(&arena);
    for (size_t i = 0; i < table->row_count; i++) {
        const pel_def_row *row = &table->rows[i];
        assert_true(row->doc != NULL && strlen(row->doc) > 4 && row->doc[strlen(row->doc) - 1] != '.');
        assert_true(row->forms != 0);
        assert_true(((row->forms & PEL_FORM_WORD) != 0) == (row->words != NULL));
        assert_false(row->required && row->preset != NULL);
        if ((row->forms & PEL_FORM_LIST) != 0)
            assert_non_null(pel_scene_row_find(table, row->path, "[]"));
        if (row->like != NULL)
            assert_non_null(pel_scene_row_next(table, row->like, NULL));
        /* the key that a row requires is given with it */
        char prefix[200];
        snprintf(prefix, sizeof prefix, "%s", row->path);
        if (strrchr(prefix, '.') != NULL)
            *strrchr(prefix, '.') = '\0';
        bool found = row->needs == NULL;
        for (const pel_def_row *beside = NULL; (beside = pel_scene_row_next(table, prefix, beside)) != NULL;)
            found = found || pel_scene_row_needs(row, pel_scene_row_name(beside, prefix));
        assert_true(found);
        for (size_t j = 0; row->needs == NULL && j < i; j++)
            assert_string_not_equal(table->rows[j].path, row->path);
    }
    pel_arena_free(&arena);
}

static void test_documents_have_every_row(void **unused)
{
    (void)unused;
    char *schema = document(pel_scene_write_schema), *reference = document(pel_scene_write_reference);
    pel_arena arena = {0};
    const pel_scene_table *table = pel_scene_table_create(&arena);
    for (size_t i = 0; i < table->row_count; i++) {
        const pel_def_row *row = &table->rows[i];
        if (strchr(row->path, '.') == NULL && row->path[0] == '<')
            continue;
        assert_non_null(strstr(schema, row->doc));
        if (strcmp(row->path + strlen(row->path) - 2, "[]") == 0)
            continue;
        char cell[100];
        snprintf(cell, sizeof cell, "| `%s` |", last_name(row->path));
        assert_non_null(strstr(reference, cell));
        assert_non_null(strstr(reference, row->doc));
    }
    pel_arena_free(&arena);
    free(schema);
    free(reference);
}

/* a default that other keys may change is given in words only */
static void test_default_by_the_scene(void **unused)
{
    (void)unused;
    char *schema = document(pel_scene_write_schema), *reference = document(pel_scene_write_reference);
    const char *row = strstr(reference, "| `method` | `quasi-static`");
    assert_non_null(row);
    assert_memory_equal(strstr(row, "|  |  | "), "|  |  | by the scene |", strlen("|  |  | by the scene |"));
    assert_null(strstr(schema, "\"default\":\"quasi-static\""));
    free(schema);
    free(reference);
}

static void test_schema_is_json(void **unused)
{
    (void)unused;
    char *schema = document(pel_scene_write_schema);
    FILE *tool = popen("python3 -m json.tool >/dev/null", "w");
    fputs(schema, tool);
    assert_int_equal(pclose(tool), 0);
    /* and, as JSON is YAML, for the scene reader too */
    pel_arena arena = {0};
    pel_error error;
    pel_scene_reader reader = {.arena = &arena, .error = &error};
    assert_non_null(pel_scene_yaml_parse(&reader, "schema", schema, strlen(schema), true));
    pel_arena_free(&arena);
    free(schema);
}

/* in a program that has a locale with a decimal comma, too */
static void test_locale(void **unused)
{
    (void)unused;
    static const char text[] = "version: 1\nduration: 0.5\nbodies: [{mesh: {shape: torus, minor_radius: 0.375}}]\n";
    pel_scene *scenes[2] = {NULL, NULL};
    char *schemas[2];
    for (int i = 0; i < 2; i++) {
        if (i == 1 && !set_comma_locale())
            skip();
        schemas[i] = document(pel_scene_write_schema);
        assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scenes[i], NULL), PEL_OK);
    }
    setlocale(LC_NUMERIC, "C");
    assert_string_equal(schemas[0], schemas[1]);
    assert_string_equal(pel_scene_text(scenes[0]), pel_scene_text(scenes[1]));
    for (int i = 0; i < 2; i++) {
        pel_scene_destroy(scenes[i]);
        free(schemas[i]);
    }
}

/* every path of the completion can be set, and every scene in scenes/ uses no other */
static void test_parameter_paths(void **unused)
{
    (void)unused;
    static const char base[] = "version: 1\nduration: 1\nbodies: [{mesh: {shape: grid}}]\n";
    char *paths = document(pel_scene_write_parameters);
    int count = 0;
    for (char *path = strtok(paths, "\n"); path != NULL; path = strtok(NULL, "\n"), count++) {
        pel_arena arena = {0};
        pel_error error;
        pel_scene_reader reader = {.arena = &arena, .table = pel_scene_table_create(&arena), .error = &error};
        pel_scene_value *root = pel_scene_yaml_parse(&reader, "base", base, sizeof base - 1, true);
        char override[200];
        snprintf(override, sizeof override, "%s=3", path);
        if (pel_scene_override(&reader, root, override) != PEL_OK)
            fail_msg("%s: %s", override, error.what);
        pel_arena_free(&arena);
    }
    assert_true(count > 90);
    free(paths);
}

/* elements of lists by number, of more than one digit too */
static void test_numbered_elements(void **unused)
{
    (void)unused;
    char text[1200] = "version: 1\nduration: 1\nbodies: [{mesh: {shape: grid}}]\nloads:\n";
    for (int i = 0; i < 12; i++)
        strcat(text, "  - {force: [0, 0, 1], from: 0.25}\n");
    const char *const overrides[] = {"loads.10.from=0.5", "loads.9.from=0.75", "loads.0011.from=0.125"};
    pel_scene *scene;
    pel_error error;
    assert_int_equal(pel_scene_parse("t", text, strlen(text), overrides, 3, NULL, &scene, NULL), PEL_OK);
    for (int i = 0; i < 12; i++)
        assert_near(scene->sim.loads[i].from, i == 10 ? 0.5 : i == 9 ? 0.75 : i == 11 ? 0.125 : 0.25, 0);
    pel_scene_destroy(scene);
    const char *const beyond = "loads.13.from=1";
    assert_int_equal(pel_scene_parse("t", text, strlen(text), &beyond, 1, NULL, &scene, &error), PEL_BAD_SCENE);
    assert_non_null(strstr(error.what, "no element '13'"));
    assert_non_null(strstr(error.remedy, "it has 12, numbered from 0"));
}

/* a scene that has every list and map: its resolved text agrees with the defaults of the table */
static void test_presets_are_valid(void **unused)
{
    (void)unused;
    pel_arena arena = {0};
    const pel_scene_table *table = pel_scene_table_create(&arena);
    const pel_def_row *shape = pel_scene_row_find(table, "<mesh>", "shape");
    for (size_t i = 0; shape->words[i] != NULL; i++) {
        char text[300];
        snprintf(text, sizeof text,
                 "version: 1\nduration: 1\nbodies: [{mesh: {shape: %s}, volumetric: {}}]\n"
                 "loads: [{force: [0, 0, 1]}]\n"
                 "tools: [{shape: sphere, radius: 1, grasp: {reach: 1}, motion: [{position: [0, 0, 99]}]}]\n",
                 shape->words[i]);
        pel_scene *scene;
        pel_error error;
        char message[1000];
        if (pel_scene_parse("t", text, strlen(text), NULL, 0, NULL, &scene, &error) != PEL_OK)
            fail_msg("%s", pel_error_text(&error, message, sizeof message));
        pel_scene_destroy(scene);
    }
    pel_arena_free(&arena);
}

static void test_numbers(void **unused)
{
    (void)unused;
    static const struct {
        const char *text;
        double number;
        bool is_number, is_integer;
    } cases[] = {
        {"0", 0, true, true},          {"-12", -12, true, true},     {"+7", 7, true, true},
        {"0x1F", 31, true, true},      {"0o17", 15, true, true},     {"1.5", 1.5, true, false},
        {".5", 0.5, true, false},      {"5.", 5, true, false},       {"1.0e5", 1e5, true, false},
        {"1e-3", 1e-3, true, false},   {"-.5E+2", -50, true, false}, {"1e999", (double)HUGE_VAL, true, false},
        {"", 0, false, false},         {".", 0, false, false},       {"-", 0, false, false},
        {"1e", 0, false, false},       {"1e+", 0, false, false},     {"1_000", 0, false, false},
        {"0x", 0, false, false},       {"0b1", 0, false, false},     {"0o8", 0, false, false},
        {"1.5.2", 0, false, false},    {"nan", 0, false, false},     {"inf", 0, false, false},
        {"infinity", 0, false, false}, {".inf", 0, false, false},    {"1 ", 0, false, false},
        {"0x1p3", 0, false, false},    {"e5", 0, false, false},      {".e5", 0, false, false},
        {"--1", 0, false, false},      {"1,5", 0, false, false},     {"1f", 0, false, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double number = 0;
        assert_int_equal(pel_scene_parse_number(cases[i].text, &number), cases[i].is_number);
        if (cases[i].is_number)
            assert_true(number == cases[i].number);
        assert_int_equal(pel_scene_parse_integer(cases[i].text, &number), cases[i].is_integer);
    }
}

static pel_status write_one(const void *writer, pel_error *error)
{
    FILE *file = fopen("/dev/null", "w");
    pel_status status = (*(write_document *const *)writer)(file, error);
    fclose(file);
    return status;
}

static void test_write_failures(void **unused)
{
    (void)unused;
    write_document *const writers[] = {pel_scene_write_schema, pel_scene_write_reference, pel_scene_write_parameters};
    for (size_t i = 0; i < sizeof writers / sizeof *writers; i++)
        for_allocation_failures(write_one, &writers[i], LONG(1, ROUNDS(5, 11)));
    FILE *file = fopen("/dev/full", "w");
    if (file == NULL)
        return;
    pel_error error;
    assert_int_equal(pel_scene_write_reference(file, &error), PEL_BAD_FILE);
    assert_true(error.remedy[0] != '\0');
    fclose(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rows_are_whole),
        cmocka_unit_test(test_documents_have_every_row),
        cmocka_unit_test(test_default_by_the_scene),
        cmocka_unit_test(test_schema_is_json),
        cmocka_unit_test(test_locale),
        cmocka_unit_test(test_parameter_paths),
        cmocka_unit_test(test_numbered_elements),
        cmocka_unit_test(test_presets_are_valid),
        cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_write_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
