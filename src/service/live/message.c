#include "live/message.h"

#include "base/memory.h"
#include "geom/solid.h"
#include "io/json.h"
#include "math/bounds.h"
#include "mesh/figures.h"
#include "pellicle/observe.h"
#include "pellicle/sim_contact.h"
#include "pellicle/sim_ledger.h"
#include "pellicle/sim_reading.h"
#include "pellicle/sim_surface.h"
#include "pellicle/tear.h"
#include "results/summary.h"
#include "scene/word_mesh.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static unsigned char *text_message(pel_json *json, size_t *size)
{
    if (json->failed) {
        pel_json_free(json);
        return NULL;
    }
    *size = json->length;
    return (unsigned char *)json->text;
}

/* ---- hello ---- */

static void put_mesh(pel_json *json, const pel_mesh *mesh)
{
    pel_json_numbers(json, "positions", &mesh->positions[0][0], 3 * mesh->vertex_count);
    pel_json_open(json, "triangles", '[');
    for (int32_t c = 0; c < 3 * mesh->triangle_count; c++)
        pel_json_integer(json, NULL, mesh->triangles[c / 3][c % 3]);
    pel_json_close(json, ']');
}

/* the circle that forceps lead a tear on, and the height at which they do */
static void put_circle(pel_json *json, const pel_tool_def *tool)
{
    pel_json_open(json, "circle", '{');
    pel_json_numbers(json, "center", tool->lead_center, 3);
    pel_json_numbers(json, "axis", tool->lead_axis, 3);
    pel_json_number(json, "radius", tool->lead_radius);
    pel_json_number(json, "regrasp", tool->lead_regrasp);
    pel_json_numbers(json, "place", tool->keys[0].position, 3);
    pel_json_close(json, '}');
}

static void put_tools(pel_json *json, const pel_scene *scene)
{
    pel_json_open(json, "tools", '[');
    for (int32_t t = 0; t < scene->sim.tool_count; t++) {
        const pel_tool_def *tool = &scene->sim.tools[t];
        pel_json_open(json, NULL, '{');
        pel_json_text(json, "name", tool->name);
        pel_json_text(json, "shape", pel_solid_rows[tool->shape].word);
        pel_json_number(json, "radius", tool->radius);
        if (tool->leads)
            put_circle(json, tool);
        pel_json_number(json, "half_length", tool->half_length);
        pel_json_numbers(json, "half_extents", tool->half_extents, 3);
        if (pel_solid_rows[tool->shape].has_edge)
            pel_json_numbers(json, "edge", tool->edge[0], 6);
        if (tool->shape == PEL_TOOL_MESH && tool->mesh != NULL)
            put_mesh(json, tool->mesh);
        pel_json_close(json, '}');
    }
    pel_json_close(json, ']');
}

static void put_word(void *json, const char *word)
{
    pel_json_text(json, NULL, word);
}

/* additional shapes of a pressing hand if there is contact */
static void put_presses(pel_json *json, const pel_scene *scene)
{
    pel_json_bool(json, "contact", scene->sim.contact.enabled);
    pel_json_open(json, "presses", '[');
    pel_word_mesh_list(scene, put_word, json);
    pel_json_close(json, ']');
}

static void put_fields(pel_json *json)
{
    pel_json_open(json, "fields", '[');
    for (int32_t f = 0; f < pel_field_count(); f++) {
        const pel_field_info *field = pel_field_at(f);
        pel_json_open(json, NULL, '{');
        pel_json_text(json, "name", field->name);
        pel_json_text(json, "unit", field->unit);
        pel_json_number(json, "components", field->component_count);
        pel_json_text(json, "doc", field->doc);
        pel_json_close(json, '}');
    }
    pel_json_close(json, ']');
}

/* the box about all bodies at rest */
static void put_box(pel_json *json, const pel_model_def *model)
{
    double low[3], high[3];
    pel_bounds_clear(low, high);
    for (int32_t b = 0; b < model->body_count; b++)
        pel_mesh_add_box(model->bodies[b].mesh, low, high);
    pel_json_numbers(json, "low", low, 3);
    pel_json_numbers(json, "high", high, 3);
}

unsigned char *pel_message_hello(const pel_scene *scene, const char *path, pel_sim *sim, size_t *size)
{
    pel_json json = {0};
    pel_json_open(&json, NULL, '{');
    pel_json_text(&json, "type", "hello");
    pel_json_text(&json, "title", scene->title);
    pel_json_text(&json, "up", scene->up == 0 ? "x" : scene->up == 1 ? "y" : "z");
    pel_json_text(&json, "path", path);
    pel_json_number(&json, "dt", scene->sim.solver.dt);
    pel_json_number(&json, "stiffness", pel_drag_suit_stiffness(sim));
    put_box(&json, &scene->model);
    pel_json_open(&json, "bodies", '[');
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        pel_json_open(&json, NULL, '{');
        pel_json_text(&json, "name", scene->model.bodies[b].name);
        pel_json_bool(&json, "closed", pel_model_is_closed(pel_sim_model(sim), b));
        pel_json_close(&json, '}');
    }
    pel_json_close(&json, ']');
    put_tools(&json, scene);
    put_presses(&json, scene);
    put_fields(&json);
    pel_json_close(&json, '}');
    return text_message(&json, size);
}

/* ---- parameters ---- */

/* factors over time have no number to set: pages show them */
static bool is_curve(const pel_parameter_info *info)
{
    const char *last = strrchr(info->row, '.');
    return last != NULL && strcmp(last, ".keys") == 0;
}

static void put_parameter(pel_json *json, const pel_parameter_info *info)
{
    bool is_shown_only = info->is_live && is_curve(info);
    static const char *const kinds[] = {"number", "integer", "switch", "word", "vector"};
    pel_json_text(json, "path", info->path);
    pel_json_text(json, "row", info->row);
    pel_json_text(json, "kind", kinds[info->kind]);
    pel_json_text(json, "unit", info->unit);
    pel_json_number(json, "least", info->least);
    pel_json_number(json, "most", info->most);
    pel_json_bool(json, "open", info->is_open);
    pel_json_bool(json, "auto", info->may_be_auto);
    pel_json_bool(json, "keyed", info->is_keyed);
    pel_json_bool(json, "field", info->is_field);
    pel_json_bool(json, "live", info->is_live && !is_shown_only);
    pel_json_text(json, "refusal", is_shown_only ? "it is a factor over time" : info->refusal);
    pel_json_text(json, "remedy", is_shown_only ? "change the keys in the scene" : info->remedy);
    pel_json_numbers(json, "preset", info->preset, info->kind == PEL_PARAMETER_VECTOR ? 3 : 1);
    pel_json_numbers(json, "value", info->value, info->kind == PEL_PARAMETER_VECTOR ? 3 : 1);
    if (info->words == NULL)
        return;
    pel_json_open(json, "words", '[');
    for (int w = 0; info->words[w] != NULL; w++)
        pel_json_text(json, NULL, info->words[w]);
    pel_json_close(json, ']');
}

unsigned char *pel_message_parameters(const pel_sim *sim, const pel_session *session, const pel_scene *scene,
                                      size_t *size)
{
    pel_json json = {0};
    pel_json_open(&json, NULL, '{');
    pel_json_text(&json, "type", "parameters");
    pel_json_open(&json, "list", '[');
    for (int32_t p = 0; p < pel_parameter_count(sim); p++) {
        pel_parameter_info info;
        pel_parameter_at(sim, p, &info);
        pel_json_open(&json, NULL, '{');
        put_parameter(&json, &info);
        pel_json_close(&json, '}');
    }
    pel_json_close(&json, ']');
    pel_json_open(&json, "inflate", '{');
    for (int32_t b = 0; b < scene->model.body_count; b++)
        pel_json_number(&json, scene->model.bodies[b].name, pel_session_pressure(session, b));
    pel_json_close(&json, '}');
    pel_json_close(&json, '}');
    return text_message(&json, size);
}

/* ---- binary messages ---- */

/* closes the head; arrays of `tail` bytes follow at *arrays */
static unsigned char *binary_message(pel_json *json, size_t tail, unsigned char **arrays, size_t *size)
{
    pel_json_close(json, '}');
    size_t head = (json->length + 3) / 4 * 4;
    unsigned char *bytes = json->failed ? NULL : pel_allocate(4 + head + tail, 1);
    if (bytes != NULL) {
        uint32_t length = (uint32_t)head;
        for (int i = 0; i < 4; i++)
            bytes[i] = (unsigned char)(length >> (8 * i));
        memcpy(bytes + 4, json->text, json->length);
        memset(bytes + 4 + json->length, ' ', head - json->length);
        *arrays = bytes + 4 + head;
        *size = 4 + head + tail;
    }
    pel_json_free(json);
    return bytes;
}

static void put_hand(pel_json *json, const pel_session *session)
{
    static const char *const kinds[] = {"free", "grab", "press", "cut", "grasp"};
    pel_hand_reading hand;
    pel_session_get_hand(session, &hand);
    pel_json_open(json, "hand", '{');
    pel_json_text(json, "kind", kinds[hand.kind]);
    pel_json_text(json, "shape", pel_solid_rows[hand.shape].word);
    pel_json_number(json, "radius", hand.radius);
    pel_json_numbers(json, "point", hand.point, 3);
    pel_json_numbers(json, "rotation", hand.rotation, 4);
    pel_json_numbers(json, "target", hand.target, 3);
    pel_json_numbers(json, "force", hand.force, 3);
    pel_json_close(json, '}');
}

static void put_poses(pel_json *json, const pel_sim *sim)
{
    pel_json_open(json, "tools", '[');
    for (int32_t t = 0; t < pel_sim_tool_count(sim); t++) {
        pel_tool_reading tool;
        pel_sim_get_tool(sim, t, &tool);
        pel_json_open(json, NULL, '{');
        pel_json_text(json, "name", pel_sim_tool_name(sim, t));
        pel_json_numbers(json, "position", tool.position, 3);
        pel_json_numbers(json, "rotation", tool.rotation, 4);
        pel_json_numbers(json, "force", tool.force, 3);
        pel_json_close(json, '}');
    }
    pel_json_close(json, ']');
}

/* the tear: its length, what it took, and its tips */
static void put_tear(pel_json *json, pel_sim *sim, double fracture_energy)
{
    enum { MOST = 8 };
    pel_cut_reading cuts;
    pel_tip tips[MOST];
    if (!pel_sim_can_tear(sim) || pel_sim_get_cuts(sim, -1, &cuts, NULL) != PEL_OK)
        return;
    pel_json_open(json, "tear", '{');
    pel_json_number(json, "length", cuts.length);
    pel_json_number(json, "fracture_energy", fracture_energy);
    pel_json_integer(json, "islands", cuts.island_count);
    pel_json_open(json, "tips", '[');
    for (int32_t b = 0; b < pel_model_body_count(pel_sim_model(sim)); b++) {
        int32_t count = 0;
        if (pel_sim_tips(sim, b, tips, MOST, &count, NULL) != PEL_OK)
            continue;
        for (int32_t t = 0; t < count && t < MOST; t++) {
            pel_json_open(json, NULL, '{');
            pel_json_numbers(json, "position", tips[t].position, 3);
            pel_json_number(json, "release", tips[t].release);
            pel_json_number(json, "rate", tips[t].rate);
            pel_json_close(json, '}');
        }
    }
    pel_json_close(json, ']');
    pel_json_close(json, '}');
}

static void put_score(pel_json *json, const pel_sim *sim)
{
    pel_score score;
    const pel_hole_reading *hole = &score.hole;
    if (!pel_sim_get_score(sim, &score))
        return;
    pel_json_open(json, "score", '{');
    pel_results_put_hole(json, hole);
    pel_json_number(json, "aim", hole->aim);
    pel_json_numbers(json, "along", hole->along, 3);
    pel_json_numbers(json, "across", hole->across, 3);
    pel_json_numbers(json, "radius", hole->radius, PEL_HOLE_SECTORS);
    pel_results_put_forces(json, &score);
    pel_json_close(json, '}');
}

static void put_measures(pel_json *json, pel_sim *sim)
{
    pel_sim_measures m;
    pel_sim_ledger ledger;
    pel_sim_measure(sim, &m);
    pel_sim_get_ledger(sim, &ledger);
    pel_json_open(json, "measures", '{');
    pel_json_number(json, "volume", m.volume);
    pel_json_number(json, "volume_ratio", m.volume_ratio);
    pel_json_number(json, "area_ratio", m.area_ratio);
    pel_json_number(json, "elastic_energy", m.elastic_energy);
    pel_json_number(json, "kinetic_energy", m.kinetic_energy);
    pel_json_number(json, "max_displacement", m.max_displacement);
    pel_json_number(json, "contacts", (double)m.contact_count);
    pel_json_number(json, "work_hand", ledger.work_tools);
    pel_json_number(json, "dissipated", ledger.dissipated_drag + ledger.dissipated_solver);
    pel_json_number(json, "energy_error", ledger.energy_error);
    pel_json_close(json, '}');
    put_tear(json, sim, ledger.dissipated_fracture);
    put_score(json, sim);
}

/* one number for each value of the field: its own, its first one, or its length */
static void reduce(const double *values, int32_t components, size_t count, float *out)
{
    for (size_t v = 0; v < count; v++) {
        const double *x = values + v * (size_t)components;
        double number = x[0];
        if (components == 3)
            number = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        if (components == 6) {
            double off = x[3] * x[3] + x[4] * x[4] + x[5] * x[5];
            number = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2] + 2 * off);
        }
        out[v] = (float)number;
    }
}

/* positions, values of the field where there is one, and a byte a vertex for contact, of all bodies */
static bool fill_frame(pel_sim *sim, int32_t field, unsigned char *at)
{
    int32_t components = field >= 0 ? pel_field_at(field)->component_count : 0;
    bool done = true;
    for (int32_t b = 0; done && b < pel_model_body_count(pel_sim_model(sim)); b++) {
        size_t count = (size_t)pel_sim_vertex_count(sim, b);
        size_t room = count * (size_t)(components > 3 ? components : 3);
        double *numbers = pel_allocate(room, sizeof *numbers);
        float *floats = pel_allocate(3 * count, sizeof *floats);
        done = numbers != NULL && floats != NULL;
        if (done) {
            pel_sim_get_positions(sim, b, numbers);
            for (size_t i = 0; i < 3 * count; i++)
                floats[i] = (float)numbers[i];
            memcpy(at, floats, 3 * count * sizeof *floats);
            at += 3 * count * sizeof *floats;
        }
        if (done && field >= 0) {
            memset(floats, 0, count * sizeof *floats);
            if (pel_observe(sim, field, b, numbers, NULL) == PEL_OK)
                reduce(numbers, components, count, floats);
            memcpy(at, floats, count * sizeof *floats);
            at += count * sizeof *floats;
        }
        if (done) {
            pel_sim_get_contacts(sim, b, numbers);
            for (size_t v = 0; v < count; v++)
                at[v] = numbers[v] > 0;
            memset(at + count, 0, (4 - count % 4) % 4);
            at += (count + 3) / 4 * 4;
        }
        pel_free(numbers);
        pel_free(floats);
    }
    return done;
}

static void put_hash(pel_json *json, const pel_sim *sim)
{
    char hash[17];
    snprintf(hash, sizeof hash, "%016" PRIx64, pel_sim_hash(sim));
    pel_json_text(json, "hash", hash);
}

static void put_counts(pel_json *json, const pel_sim *sim)
{
    pel_json_open(json, "bodies", '[');
    for (int32_t b = 0; b < pel_model_body_count(pel_sim_model(sim)); b++)
        pel_json_integer(json, NULL, pel_sim_vertex_count(sim, b));
    pel_json_close(json, ']');
}

unsigned char *pel_message_frame(pel_sim *sim, const pel_session *session, int32_t field, const pel_pace *pace,
                                 size_t *size)
{
    pel_json json = {0};
    size_t tail = 0;
    for (int32_t b = 0; b < pel_model_body_count(pel_sim_model(sim)); b++) {
        size_t count = (size_t)pel_sim_vertex_count(sim, b);
        tail += count * (field >= 0 ? 4 : 3) * sizeof(float) + (count + 3) / 4 * 4;
    }
    pel_json_open(&json, NULL, '{');
    pel_json_text(&json, "type", "frame");
    pel_json_number(&json, "time", pel_sim_time(sim));
    pel_json_number(&json, "step", (double)pel_sim_step_count(sim));
    pel_json_bool(&json, "playing", pace->playing);
    pel_json_number(&json, "pace", pace->pace);
    pel_json_number(&json, "step_ms", pace->step_ms);
    pel_json_number(&json, "serving", pace->serving);
    pel_json_number(&json, "echo", pace->echo);
    pel_json_number(&json, "undo", pel_session_undo_count(session));
    pel_json_text(&json, "field", field >= 0 ? pel_field_at(field)->name : "");
    if (!pace->playing)
        put_hash(&json, sim);
    put_hand(&json, session);
    put_poses(&json, sim);
    put_counts(&json, sim);
    if (pace->measures)
        put_measures(&json, sim);
    unsigned char *arrays = NULL, *bytes = binary_message(&json, tail, &arrays, size);
    if (bytes != NULL && !fill_frame(sim, field, arrays)) {
        pel_free(bytes);
        return NULL;
    }
    return bytes;
}

unsigned char *pel_message_summary(pel_sim *sim, const pel_session *session, size_t *size)
{
    pel_json json = {0};
    pel_json_open(&json, NULL, '{');
    pel_json_number(&json, "time", pel_sim_time(sim));
    pel_json_number(&json, "step", (double)pel_sim_step_count(sim));
    put_hash(&json, sim);
    put_hand(&json, session);
    put_poses(&json, sim);
    put_measures(&json, sim);
    pel_json_close(&json, '}');
    return text_message(&json, size);
}

/* the mesh of the tool under the hand, about its own origin */
static unsigned char *fill_tool(const pel_mesh *mesh, unsigned char *at)
{
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *x = mesh->positions[v];
        const float place[3] = {(float)x[0], (float)x[1], (float)x[2]};
        memcpy(at, place, sizeof place);
        at += sizeof place;
    }
    size_t length = (size_t)mesh->triangle_count * sizeof *mesh->triangles;
    memcpy(at, mesh->triangles, length);
    return at + length;
}

unsigned char *pel_message_surface(const pel_sim *sim, const pel_session *session, size_t *size)
{
    pel_json json = {0};
    const pel_mesh *tool = pel_session_tool_mesh(session);
    size_t tail = 0;
    pel_json_open(&json, NULL, '{');
    pel_json_text(&json, "type", "surface");
    pel_json_open(&json, "bodies", '[');
    for (int32_t b = 0; b < pel_model_body_count(pel_sim_model(sim)); b++) {
        int32_t triangles = pel_sim_triangle_count(sim, b), pins = 0;
        pel_session_pins(session, b, &pins);
        pel_json_open(&json, NULL, '{');
        pel_json_number(&json, "vertices", pel_sim_vertex_count(sim, b));
        pel_json_number(&json, "triangles", triangles);
        pel_json_number(&json, "pins", pins);
        pel_json_close(&json, '}');
        tail += 3 * sizeof(int32_t) * (size_t)triangles + ((size_t)pins + 3) / 4 * 4;
    }
    pel_json_close(&json, ']');
    if (tool != NULL) {
        pel_json_open(&json, "tool", '{');
        pel_json_number(&json, "vertices", tool->vertex_count);
        pel_json_number(&json, "triangles", tool->triangle_count);
        pel_json_close(&json, '}');
        tail += (size_t)tool->vertex_count * 3 * sizeof(float) + (size_t)tool->triangle_count * sizeof *tool->triangles;
    }
    unsigned char *at = NULL, *bytes = binary_message(&json, tail, &at, size);
    if (bytes != NULL && tool != NULL)
        at = fill_tool(tool, at);
    for (int32_t b = 0; bytes != NULL && b < pel_model_body_count(pel_sim_model(sim)); b++) {
        int32_t count = 0, *triangles = pel_allocate(3 * (size_t)pel_sim_triangle_count(sim, b), sizeof *triangles);
        if (triangles == NULL) {
            pel_free(bytes);
            return NULL;
        }
        pel_sim_get_triangles(sim, b, triangles);
        size_t length = 3 * sizeof *triangles * (size_t)pel_sim_triangle_count(sim, b);
        memcpy(at, triangles, length);
        pel_free(triangles);
        const unsigned char *pins = pel_session_pins(session, b, &count);
        memcpy(at + length, pins, (size_t)count);
        at += length + ((size_t)count + 3) / 4 * 4;
    }
    return bytes;
}

/* ---- short ones ---- */

unsigned char *pel_message_scene(const char *text, size_t *size)
{
    pel_json json = {0};
    pel_json_open(&json, NULL, '{');
    pel_json_text(&json, "type", "scene");
    pel_json_text(&json, "text", text);
    pel_json_close(&json, '}');
    return text_message(&json, size);
}

unsigned char *pel_message_notice(const char *kind, const char *text, size_t *size)
{
    pel_json json = {0};
    pel_json_open(&json, NULL, '{');
    pel_json_text(&json, "type", "notice");
    pel_json_text(&json, "kind", kind);
    pel_json_text(&json, "text", text);
    pel_json_close(&json, '}');
    return text_message(&json, size);
}
