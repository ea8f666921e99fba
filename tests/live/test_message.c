/* What the first message to a page proposes. */
#include "check.h"
#include "live/message.h"

#include "base/memory.h"
#include "pellicle/observe.h"
#include "pellicle/sim_ledger.h"
#include "pellicle/sim_reading.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* the end of the JSON value at `at`, null if it is none; a text, a number or a word is as long as it goes */
static const char *skip_value(const char *at)
{
    const char *first = at;
    if (*at == '"') {
        for (at++; *at != '"'; at++)
            if (*at == '\0' || (*at == '\\' && *++at == '\0'))
                return NULL;
        return at + 1;
    }
    if (*at != '{' && *at != '[') {
        at += strcspn(at, ",]}");
        return at > first ? at : NULL;
    }
    const char end = *at == '{' ? '}' : ']';
    at++;
    if (*at == end)
        return at + 1;
    for (;; at++) {
        if (end == '}') {
            at = *at == '"' ? skip_value(at) : NULL;
            if (at == NULL || *at++ != ':')
                return NULL;
        }
        at = skip_value(at);
        if (at == NULL || (*at != ',' && *at != end))
            return NULL;
        if (*at == end)
            return at + 1;
    }
}

static int32_t count_words(const char *text, const char *words)
{
    int32_t count = 0;
    for (const char *at = text; (at = strstr(at, words)) != NULL; at++)
        count++;
    return count;
}

/* a whole JSON object, whose fields have all that the page shows of them */
static void check_hello(const char *text)
{
    const char *end = skip_value(text);
    assert_true(text[0] == '{' && end != NULL && *end == '\0');
    const char *fields = strstr(text, "\"fields\":[");
    assert_non_null(fields);
    end = skip_value(strchr(fields, '['));
    char *list = malloc((size_t)(end - fields) + 1);
    assert_non_null(list);
    snprintf(list, (size_t)(end - fields) + 1, "%s", fields);
    static const char *const keys[] = {"\"name\":\"", "\"unit\":\"", "\"doc\":\""};
    for (int k = 0; k < 3; k++)
        assert_int_equal(count_words(list, keys[k]), pel_field_count());
    free(list);
}

/* the first message of a scene; to be freed */
static char *hello_of(const char *text)
{
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
    size_t size;
    assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, NULL), PEL_OK);
    assert_int_equal(pel_model_create(&scene->model, &model, NULL), PEL_OK);
    scene->sim.model = model;
    assert_int_equal(pel_sim_create(&scene->sim, &sim, NULL), PEL_OK);
    unsigned char *message = pel_message_hello(scene, "", sim, &size);
    assert_non_null(message);
    char *head = malloc(size + 1);
    memcpy(head, message, size);
    head[size] = 0;
    check_hello(head);
    pel_free(message);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
    return head;
}

/* the spring of the hand in a scene with one body [N/m] */
static double proposed(const char *body)
{
    char text[600];
    snprintf(text, sizeof text, "version: 1\nbodies:\n  - { name: a, %s }\nduration: 1\n", body);
    char *head = hello_of(text);
    const char *found = strstr(head, "\"stiffness\":");
    assert_non_null(found);
    double stiffness = strtod(found + strlen("\"stiffness\":"), NULL);
    free(head);
    return stiffness;
}

/* the page draws blades and hooks between the ends of their edges */
static void test_edges(void **unused)
{
    (void)unused;
    char *head = hello_of("version: 1\nbodies:\n  - { name: a, mesh: { shape: grid }, membrane: { preset: rubber } }\n"
                          "tools:\n  - { name: knife, shape: blade, edge: [[0, 0.5, -0.25], [0.125, 0, 0.75]], motion: "
                          "[{ position: [3, 0, 0] }] }\nduration: 1\n");
    assert_non_null(strstr(head, "\"edge\":[0,0.5,-0.25,0.125,0,0.75]"));
    free(head);
}

static double of_tissue(double radius, double young)
{
    char text[300];
    snprintf(
        text, sizeof text,
        "mesh: { shape: geodesic-sphere, frequency: 4, radius: %g }, mass: { density: 1000 }, springs: { young: %g }, "
        "volumetric: { young: %g }",
        radius, 10 * young, young);
    return proposed(text);
}

/* of moduli it is proportional to them and to the size, and pulls about as hard as the tissue, E times the size */
static void test_moduli(void **unused)
{
    (void)unused;
    double one = of_tissue(0.1, 5000);
    assert_near(of_tissue(0.1, 10000), 2 * one, 1e-9 * one);
    assert_near(of_tissue(0.4, 5000), 4 * one, 1e-9 * one);
    assert_true(one > 0.02 * 5000 * 0.2 && one < 5000 * 0.2);
}

static void test_stiffnesses(void **unused)
{
    (void)unused;
    const char *springs = "mesh: { shape: geodesic-sphere, frequency: 4 }, springs: { stiffness: 3 }, "
                          "volumetric: { stiffness: 1.5 }";
    assert_near(proposed(springs), 18, 1e-9);
    const char *shell = "mesh: { shape: geodesic-sphere, frequency: 4 }, mass: { density: 1000, thickness: 0.002 }, "
                        "membrane: { young: 1e5, thickness: 0.002 }";
    assert_near(proposed(shell), 60, 1e-9);
}

/* the page draws a tool that is a mesh from its corners, and the scene with its axis upwards */
static void test_mesh_and_axis(void **unused)
{
    (void)unused;
    static const char *const axes[] = {"x", "y", "z"};
    char text[500], wanted[100];
    for (int k = 0; k < 3; k++) {
        snprintf(text, sizeof text,
                 "version: 1\nup: %s\nbodies:\n  - { name: a, mesh: { shape: grid }, membrane: { preset: rubber } }\n"
                 "tools:\n  - { name: t, mesh: { shape: geodesic-sphere, frequency: 1 }, motion: [{ position: [0, 0, "
                 "9] }] }\n"
                 "duration: 1\n",
                 axes[k]);
        char *head = hello_of(text);
        snprintf(wanted, sizeof wanted, "\"up\":\"%s\"", axes[k]);
        assert_non_null(strstr(head, wanted));
        const char *at = strstr(head, "\"triangles\":[");
        assert_non_null(at);
        int32_t uses[12] = {0}, count = 0;
        for (at = strchr(at, '[') + 1; *at != ']'; count++, at += strspn(at, ", ")) {
            long corner = strtol(at, (char **)&at, 10);
            assert_true(corner >= 0 && corner < 12);
            uses[corner]++;
        }
        /* an icosahedron */
        assert_int_equal(count, 60);
        for (int v = 0; v < 12; v++)
            assert_int_equal(uses[v], 5);
        free(head);
    }
}

/* the number of a key behind a place of a message */
static double number_of(const char *text, const char *key)
{
    char words[64];
    snprintf(words, sizeof words, "\"%s\":", key);
    const char *found = strstr(text, words);
    if (found == NULL)
        fail_msg("no %s in %s", key, text);
    return strtod(found + strlen(words), NULL);
}

/* The measures are those of the library, of a ball that a tool dents while it swings in drag. */
static void test_measures(void **unused)
{
    (void)unused;
    static const char text[] =
        "version: 1\nbodies:\n  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 3 }, membrane: { young: "
        "1e4, "
        "thickness: 0.01 }, mass: { density: 1000 } }\ntools: [ { shape: sphere, radius: 0.5, motion: [ { position: "
        "[0, 0, "
        "1.51] }, { time: 0.1, position: [0, 0, 1.3] } ] } ]\nsolver: { method: xpbd, dt: 0.01, drag: 1 }\n"
        "contact: {}\nduration: 1\n";
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
    pel_session *session;
    size_t size;
    assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, NULL), PEL_OK);
    assert_int_equal(pel_model_create(&scene->model, &model, NULL), PEL_OK);
    scene->sim.model = model;
    assert_int_equal(pel_sim_create(&scene->sim, &sim, NULL), PEL_OK);
    assert_int_equal(pel_session_create(scene, sim, &session, NULL), PEL_OK);
    for (int i = 0; i < 15; i++)
        assert_int_equal(pel_session_step(session, NULL), PEL_OK);
    char *message = (char *)pel_message_summary(sim, session, &size);
    assert_non_null(message);
    char *all = malloc(size + 1);
    memcpy(all, message, size);
    all[size] = 0;
    const char *own = strstr(all, "\"measures\":{");
    assert_non_null(own);
    pel_sim_measures m;
    pel_sim_ledger ledger;
    pel_sim_measure(sim, &m);
    pel_sim_get_ledger(sim, &ledger);
    const struct {
        const char *key;
        double number;
    } cases[] = {{"volume", m.volume},
                 {"volume_ratio", m.volume_ratio},
                 {"area_ratio", m.area_ratio},
                 {"elastic_energy", m.elastic_energy},
                 {"kinetic_energy", m.kinetic_energy},
                 {"max_displacement", m.max_displacement},
                 {"contacts", (double)m.contact_count},
                 {"work_hand", ledger.work_tools},
                 {"dissipated", ledger.dissipated_drag + ledger.dissipated_solver},
                 {"energy_error", ledger.energy_error}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double number = number_of(own, cases[i].key);
        if (!(fabs(number - cases[i].number) <= 1e-5 * fabs(cases[i].number) + 1e-300))
            fail_msg("%s: %g for %g", cases[i].key, number, cases[i].number);
        /* contacts and the error of the energy may be 0 here */
        if (cases[i].number == 0 && strcmp(cases[i].key, "contacts") != 0 && strcmp(cases[i].key, "energy_error") != 0)
            fail_msg("%s is 0", cases[i].key);
    }
    free(all);
    pel_free(message);
    pel_session_destroy(session);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_measures), cmocka_unit_test(test_edges),
                                       cmocka_unit_test(test_moduli), cmocka_unit_test(test_stiffnesses),
                                       cmocka_unit_test(test_mesh_and_axis)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
