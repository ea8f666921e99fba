/* Sessions: an interactive simulation with undo, by commands between two steps that are recorded (record.h). */
#include "pellicle/session.h"
#include "base/assert.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/bounds.h"
#include "math/extremes.h"
#include "mesh/figures.h"
#include "pellicle/sim_reading.h"
#include "pellicle/sim_surface.h"
#include "pellicle/tear.h"
#include "scene/word_mesh.h"
#include "session/blade.h"
#include "session/command.h"
#include "session/grasp.h"
#include "session/record.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* marks that are kept */
enum { MARK_LIMIT = 16 };
/* sizes of all bodies that a tool of the hand may have */
enum { MOST_SIZES = 1000 };
/* diagonals of the bodies in a second: how fast a tool follows the hand */
#define TOOL_SPEED 1.5
/* likewise forceps, which come nearer to their target by a factor of e in these seconds: the force would jump with the
   pointer */
#define GRASP_SPEED 0.4
#define GRASP_SECONDS 0.02

/* the pressure and pins of a body */
typedef struct body_grip {
    int32_t vertex_count; /* of its mesh */
    unsigned char *pins;  /* (vertex_count) */
    double pressure;      /* Pa */
} body_grip;

/* a state that undo returns to */
typedef struct mark {
    pel_snapshot *snapshot;
    size_t record_length;
    int32_t next_line;
    int32_t *counts;     /* (body_count) vertices of their meshes */
    unsigned char *pins; /* of all bodies, one after the other */
    double *pressures;   /* (body_count) */
} mark;

struct pel_session {
    const pel_scene *scene;
    pel_sim *sim;
    int32_t body_count;
    body_grip *bodies;
    double size; /* m, diagonal of the box about all bodies at rest */
    /* the hand */
    pel_hand_kind hand;
    pel_drag *drag;
    pel_blade blade;
    char tool[PEL_NAME_SIZE];
    pel_tool_shape shape;
    pel_mesh *mesh; /* of a tool that is one, in its size; else null */
    double radius, place[3], rotation[4], target[3];
    double closed_at; /* s, of scissors */
    pel_session_events record;
    mark start, marks[MARK_LIMIT];
    int32_t mark_count;
    int32_t next_line; /* of the scene's session */
    /* scratch of inflate, for the largest body */
    double *positions, *forces;
};

/* ---- creation ---- */

static const pel_mesh *mesh_of(const pel_session *session, int32_t body)
{
    return pel_model_mesh(pel_sim_model(session->sim), body);
}

static bool take_body(body_grip *grip, const pel_body_def *def)
{
    grip->vertex_count = def->mesh->vertex_count;
    grip->pins = pel_allocate((size_t)grip->vertex_count, 1);
    for (int32_t i = 0; grip->pins != NULL && i < def->pinned_count; i++)
        grip->pins[def->pinned[i]] = 1;
    return grip->pins != NULL;
}

static bool make_forces(pel_session *session)
{
    int32_t most = 0;
    for (int32_t b = 0; b < session->body_count; b++)
        most = session->bodies[b].vertex_count > most ? session->bodies[b].vertex_count : most;
    pel_free(session->forces);
    session->forces = pel_allocate(3 * (size_t)most, sizeof(double));
    return session->forces != NULL;
}

static double diagonal(const pel_model_def *model)
{
    double low[3], high[3];
    pel_bounds_clear(low, high);
    for (int32_t b = 0; b < model->body_count; b++)
        pel_mesh_add_box(model->bodies[b].mesh, low, high);
    return pel_vec3_distance(low, high);
}

static bool take_bodies(pel_session *session)
{
    const pel_model_def *model = &session->scene->model;
    session->size = diagonal(model);
    session->body_count = model->body_count;
    session->bodies = pel_allocate((size_t)model->body_count, sizeof *session->bodies);
    for (int32_t b = 0; b < model->body_count; b++)
        if (session->bodies == NULL || !take_body(&session->bodies[b], &model->bodies[b]))
            return false;
    return make_forces(session);
}

static bool set_count(pel_session *session, int32_t body, int32_t count)
{
    body_grip *grip = &session->bodies[body];
    unsigned char *pins = pel_reallocate(grip->pins, (size_t)count, 1);
    if (pins == NULL)
        return false;
    grip->pins = pins;
    grip->vertex_count = count;
    return make_forces(session);
}

/* after cuts: copies are pinned as their vertex was */
static pel_status follow_surfaces(pel_session *session, pel_error *error)
{
    for (int32_t b = 0; b < session->body_count; b++) {
        int32_t before = session->bodies[b].vertex_count, count = mesh_of(session, b)->vertex_count;
        if (count == before)
            continue;
        int32_t *origins = pel_allocate((size_t)count, sizeof *origins);
        bool is_made = origins != NULL && set_count(session, b, count);
        if (is_made)
            pel_sim_get_origins(session->sim, b, origins);
        for (int32_t v = before; is_made && v < count; v++)
            session->bodies[b].pins[v] = session->bodies[b].pins[origins[v]];
        pel_free(origins);
        if (!is_made)
            return pel_fail_memory(error);
    }
    return PEL_OK;
}

static void drop_mark(mark *at)
{
    pel_snapshot_destroy(at->snapshot);
    PEL_FREE_ALL(at->counts, at->pins, at->pressures);
    *at = (mark){0};
}

static pel_status make_mark(const pel_session *session, mark *at, pel_error *error)
{
    *at = (mark){.record_length = session->record.length, .next_line = session->next_line};
    size_t pin_count = 0;
    for (int32_t b = 0; b < session->body_count; b++)
        pin_count += (size_t)session->bodies[b].vertex_count;
    bool is_made = PEL_ALLOCATE_ALL(PEL_ROOM(at->pins, pin_count), PEL_ROOM(at->pressures, session->body_count),
                                    PEL_ROOM(at->counts, session->body_count));
    pel_status status = is_made ? PEL_OK : pel_fail_memory(error);
    if (status == PEL_OK)
        status = pel_snapshot_create(session->sim, &at->snapshot, error);
    if (status != PEL_OK) {
        drop_mark(at);
        return status;
    }
    unsigned char *pins = at->pins;
    for (int32_t b = 0; b < session->body_count; b++) {
        const body_grip *body = &session->bodies[b];
        memcpy(pins, body->pins, (size_t)body->vertex_count);
        pins += body->vertex_count;
        at->counts[b] = body->vertex_count;
        at->pressures[b] = body->pressure;
    }
    return PEL_OK;
}

static pel_status fail_line(const pel_session *session, const pel_scene_command *line, const pel_error *cause,
                            pel_error *error)
{
    pel_fail(error, PEL_BAD_SCENE, "session: \"%" PRId64 " %.100s\": %.180s", line->step, line->line, cause->what);
    pel_fail_remedy(error, "%s", cause->remedy);
    pel_fail_place(error, session->scene->path, line->at_line, line->at_column);
    return PEL_BAD_SCENE;
}

/* the words of the scene's own session, so that a bad one is told before the first step */
static pel_status check_lines(const pel_session *session, pel_error *error)
{
    const pel_scene *scene = session->scene;
    pel_command command;
    pel_error cause;
    for (int32_t i = 0; i < scene->session_count; i++)
        if (pel_command_parse(scene->session[i].line, &command, &cause) != PEL_OK)
            return fail_line(session, &scene->session[i], &cause, error);
    return PEL_OK;
}

pel_status pel_session_create(const pel_scene *scene, pel_sim *sim, pel_session **session, pel_error *error)
{
    PEL_REFUSE_NULL(scene, error);
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(session, error);
    *session = NULL;
    pel_session *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->scene = scene;
    made->sim = sim;
    pel_status status = check_lines(made, error);
    if (status == PEL_OK)
        status = take_bodies(made) ? make_mark(made, &made->start, error) : pel_fail_memory(error);
    if (status != PEL_OK) {
        pel_session_destroy(made);
        return status;
    }
    *session = made;
    return PEL_OK;
}

void pel_session_destroy(pel_session *session)
{
    if (session == NULL)
        return;
    if (session->drag != NULL)
        (void)pel_drag_end(session->drag, NULL);
    pel_session_events_clear(&session->record);
    drop_mark(&session->start);
    for (int32_t m = 0; m < session->mark_count; m++)
        drop_mark(&session->marks[m]);
    for (int32_t b = 0; session->bodies != NULL && b < session->body_count; b++)
        pel_free(session->bodies[b].pins);
    pel_mesh_destroy(session->mesh);
    pel_blade_end(&session->blade);
    PEL_FREE_ALL(session->bodies, session->positions, session->forces, session);
}

/* ---- the hand ---- */

static int32_t find_tool(const pel_sim *sim, const char *name)
{
    for (int32_t t = 0; t < pel_sim_tool_count(sim); t++)
        if (strcmp(pel_sim_tool_name(sim, t), name) == 0)
            return t;
    return -1;
}

static bool has_tool(const pel_session *session)
{
    return session->hand == PEL_HAND_PRESS || session->hand == PEL_HAND_GRASP;
}

static pel_status release(pel_session *session, pel_error *error)
{
    pel_status status = PEL_OK;
    if (session->hand == PEL_HAND_GRAB) {
        status = pel_drag_end(session->drag, error);
        session->drag = NULL;
    }
    pel_blade_end(&session->blade);
    int32_t tool = has_tool(session) ? find_tool(session->sim, session->tool) : -1;
    if (tool >= 0)
        status = pel_sim_remove_tool(session->sim, tool, error);
    if (status == PEL_OK || session->hand == PEL_HAND_GRAB) {
        session->hand = PEL_HAND_FREE;
        pel_mesh_destroy(session->mesh);
        session->mesh = NULL;
    }
    return status;
}

static pel_status pick(pel_session *session, const pel_command *command, pel_pick_hit *hit, pel_error *error)
{
    const double *n = command->numbers;
    if (!(n[3] * n[3] + n[4] * n[4] + n[5] * n[5] > 0))
        return pel_fail(error, PEL_BAD_ARGUMENT, "the direction of the ray is 0");
    return pel_pick(session->sim, n, n + 3, hit, error);
}

static pel_status refuse_busy(const pel_session *session, pel_error *error)
{
    if (session->hand == PEL_HAND_FREE)
        return PEL_OK;
    return pel_fail(error, PEL_BAD_ARGUMENT, "the hand is not free: release first");
}

static pel_status grab(pel_session *session, const pel_command *command, bool *done, pel_error *error)
{
    pel_pick_hit hit;
    pel_status status = refuse_busy(session, error);
    if (status == PEL_OK)
        status = pick(session, command, &hit, error);
    *done = status == PEL_OK && hit.is_hit;
    if (!*done)
        return status;
    status = pel_drag_begin(session->sim, &hit, command->numbers[6], command->numbers[7], &session->drag, error);
    if (status != PEL_OK)
        return status;
    session->hand = PEL_HAND_GRAB;
    memcpy(session->target, hit.point, sizeof session->target);
    return PEL_OK;
}

/* moves the middle of the mesh's box to 0 and its farthest vertex to the radius */
static void fit_mesh(pel_mesh *mesh, double radius)
{
    double low[3], high[3], most = 0;
    pel_mesh_box(mesh, low, high);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double squared = 0;
        for (int i = 0; i < 3; i++) {
            mesh->positions[v][i] -= low[i] / 2 + high[i] / 2;
            squared += mesh->positions[v][i] * mesh->positions[v][i];
        }
        most = pel_max(most, sqrt(squared));
    }
    for (int32_t v = 0; most > 0 && v < mesh->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            mesh->positions[v][i] *= radius / most;
}

/* Reads the mesh of a tool. The command names it from everywhere then, so that the record can go elsewhere. */
static pel_status read_mesh(pel_session *session, pel_command *command, pel_mesh **mesh, pel_error *error)
{
    char word[PEL_SESSION_LINE], rest[PEL_SESSION_LINE];
    pel_status status = pel_word_mesh_create(session->scene, command->name, mesh, word, sizeof word, error);
    if (status != PEL_OK)
        return status;
    fit_mesh(*mesh, command->numbers[0]);
    snprintf(rest, sizeof rest, "%s", command->line + strlen("press ") + strlen(command->name));
    if (snprintf(command->line, sizeof command->line, "press %s%s", word, rest) < (int)sizeof command->line)
        return PEL_OK;
    pel_mesh_destroy(*mesh);
    *mesh = NULL;
    return pel_fail(error, PEL_BAD_ARGUMENT, "the path of the mesh '%.150s' is too long for a command", word);
}

static void choose_name(pel_session *session)
{
    snprintf(session->tool, sizeof session->tool, "hand");
    for (int i = 2; find_tool(session->sim, session->tool) >= 0; i++)
        snprintf(session->tool, sizeof session->tool, "hand-%d", i);
}

/* the hand has the tool, which the simulation has now */
static void take_tool(pel_session *session, pel_hand_kind kind, const pel_tool_def *def)
{
    session->hand = kind;
    session->shape = def->shape;
    session->radius = def->radius;
    memcpy(session->place, def->keys[0].position, sizeof session->place);
    memcpy(session->target, def->keys[0].position, sizeof session->target);
    memcpy(session->rotation, def->keys[0].rotation, sizeof session->rotation);
}

/* s, in which scissors of the hand close */
#define SNIP_SECONDS 0.25

/* both ends of the edge along z; scissors point along x, open along z, and close from now on */
static void set_edge(pel_session *session, double radius, pel_key closing[2], pel_tool_def *def)
{
    double time = pel_sim_time(session->sim);
    def->edge[0][2] = -radius;
    def->edge[1][2] = radius;
    if (def->shape != PEL_TOOL_SCISSORS)
        return;
    def->edge[0][0] = def->edge[1][0] = 2 * radius;
    session->closed_at = time + SNIP_SECONDS;
    closing[0] = (pel_key){time, 0};
    closing[1] = (pel_key){session->closed_at, 1};
    def->closing = closing;
    def->closing_count = 2;
}

static pel_status press(pel_session *session, pel_command *command, pel_error *error)
{
    const double *n = command->numbers;
    pel_status status = refuse_busy(session, error);
    if (status != PEL_OK)
        return status;
    double length = sqrt(n[4] * n[4] + n[5] * n[5] + n[6] * n[6] + n[7] * n[7]);
    if (!(n[0] > 0) || !(length > 0))
        return pel_fail(error, PEL_BAD_ARGUMENT, "the tool has the radius %g m and a quaternion of length %g", n[0],
                        length);
    if (n[0] > MOST_SIZES * session->size)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "use a smaller radius",
                          "the tool has the radius %g m, more than %d times the size of all bodies (%g m)", n[0],
                          (int)MOST_SIZES, session->size);
    choose_name(session);
    pel_pose_key key = {.position = {n[1], n[2], n[3]}};
    pel_key closing[2];
    for (int i = 0; i < 4; i++)
        key.rotation[i] = n[4 + i] / length;
    pel_tool_def def = pel_tool_def_default();
    def.name = session->tool;
    pel_mesh *mesh = NULL;
    if (command->shape == PEL_TOOL_MESH)
        status = read_mesh(session, command, &mesh, error);
    if (status != PEL_OK)
        return status;
    def.shape = command->shape;
    def.mesh = mesh;
    def.radius = n[0];
    def.half_length = 2 * n[0];
    set_edge(session, n[0], closing, &def);
    for (int i = 0; i < 3; i++)
        def.half_extents[i] = n[0];
    def.keys = &key;
    def.key_count = 1;
    status = pel_sim_add_tool(session->sim, &def, error);
    if (status != PEL_OK) {
        pel_mesh_destroy(mesh);
        return status;
    }
    session->mesh = mesh;
    take_tool(session, PEL_HAND_PRESS, &def);
    return PEL_OK;
}

static pel_status grasp(pel_session *session, const pel_command *command, bool *done, pel_error *error)
{
    pel_pick_hit hit;
    pel_pose_key key = {.rotation = {0, 0, 0, 1}};
    pel_tool_def def = pel_tool_def_default();
    if (!(command->numbers[6] >= 0))
        return pel_fail(error, PEL_BAD_ARGUMENT, "the reach %g m is below 0", command->numbers[6]);
    pel_status status = refuse_busy(session, error);
    if (status == PEL_OK)
        status = pick(session, command, &hit, error);
    *done = status == PEL_OK && hit.is_hit;
    if (!*done)
        return status;
    choose_name(session);
    memcpy(key.position, hit.point, sizeof key.position);
    def.name = session->tool;
    def.radius = command->numbers[6];
    status = pel_grasp_begin(session->sim, session->scene, &hit, command->numbers[7] != 0, &def, &key, error);
    if (status == PEL_OK)
        take_tool(session, PEL_HAND_GRASP, &def);
    return status;
}

/* forceps may have grasped anew elsewhere */
static void find_place(pel_session *session, int32_t tool)
{
    pel_tool_reading reading;
    pel_sim_get_tool(session->sim, tool, &reading);
    memcpy(session->place, reading.position, sizeof session->place);
}

/* The tool moves to its target no faster than TOOL_SPEED: pointers jump, and the tool must not jump into a body. */
static pel_status move_tool(pel_session *session, pel_error *error)
{
    double dt = session->scene->sim.solver.dt, way[3], length = 0;
    bool grasps = session->hand == PEL_HAND_GRASP;
    int32_t tool = find_tool(session->sim, session->tool);
    if (grasps)
        find_place(session, tool);
    for (int i = 0; i < 3; i++) {
        way[i] = session->target[i] - session->place[i];
        length += way[i] * way[i];
    }
    length = sqrt(length);
    double most = (grasps ? GRASP_SPEED : TOOL_SPEED) * session->size * dt, share = length > most ? most / length : 1;
    if (grasps)
        share = pel_min(share, dt / (dt + GRASP_SECONDS));
    for (int i = 0; i < 3; i++)
        session->place[i] = share < 1 ? session->place[i] + share * way[i] : session->target[i];
    return pel_sim_set_tool_pose(session->sim, tool, session->place, session->rotation, error);
}

static pel_status move_hand(pel_session *session, pel_error *error)
{
    switch (session->hand) {
    case PEL_HAND_GRAB:
        return pel_drag_move(session->drag, session->target, error);
    case PEL_HAND_PRESS:
    case PEL_HAND_GRASP:
        return move_tool(session, error);
    case PEL_HAND_CUT:
    case PEL_HAND_FREE:
        break;
    }
    return PEL_OK;
}

void pel_session_get_hand(const pel_session *session, pel_hand_reading *reading)
{
    if (session == NULL || reading == NULL)
        return;
    *reading = (pel_hand_reading){.kind = session->hand, .shape = session->shape, .radius = session->radius};
    memcpy(reading->target, session->target, sizeof reading->target);
    memcpy(reading->rotation, session->rotation, sizeof reading->rotation);
    if (session->hand == PEL_HAND_GRAB) {
        pel_drag_reading drag;
        pel_drag_get(session->drag, &drag);
        memcpy(reading->point, drag.point, sizeof reading->point);
        memcpy(reading->force, drag.force, sizeof reading->force);
    } else if (has_tool(session)) {
        pel_tool_reading tool;
        pel_sim_get_tool(session->sim, find_tool(session->sim, session->tool), &tool);
        memcpy(reading->point, tool.position, sizeof reading->point);
        for (int i = 0; i < 3; i++)
            reading->force[i] = 0 - tool.force[i];
    } else if (session->hand == PEL_HAND_CUT)
        memcpy(reading->point, session->target, sizeof reading->point);
}

const pel_mesh *pel_session_tool_mesh(const pel_session *session)
{
    return session != NULL ? session->mesh : NULL;
}

/* ---- pins and pressure ---- */

static pel_status read_positions(pel_session *session, int32_t body, pel_error *error)
{
    PEL_ASSERT_INDEX(body, session->body_count);
    size_t count = (size_t)pel_sim_vertex_count(session->sim, body);
    void *room = pel_reallocate(session->positions, 3 * count, sizeof(double));
    if (room == NULL)
        return pel_fail_memory(error);
    session->positions = room;
    pel_sim_get_positions(session->sim, body, session->positions);
    return PEL_OK;
}

static pel_status set_pins(pel_session *session, int32_t body, const unsigned char *pins, pel_error *error)
{
    PEL_ASSERT_INDEX(body, session->body_count);
    const body_grip *grip = &session->bodies[body];
    int32_t count = 0, *vertices = pel_allocate((size_t)grip->vertex_count, sizeof *vertices);
    if (vertices == NULL)
        return pel_fail_memory(error);
    for (int32_t v = 0; v < grip->vertex_count; v++)
        if (pins[v] != 0)
            vertices[count++] = v;
    pel_status status = pel_sim_set_pins(session->sim, body, vertices, count, error);
    pel_free(vertices);
    return status;
}

static pel_status pin(pel_session *session, const pel_command *command, bool *done, pel_error *error)
{
    pel_pick_hit hit;
    double reach = command->numbers[6];
    unsigned char value = command->word == PEL_COMMAND_PIN;
    *done = false;
    if (!(reach >= 0))
        return pel_fail(error, PEL_BAD_ARGUMENT, "the reach %g m is below 0", reach);
    pel_status status = pick(session, command, &hit, error);
    if (status != PEL_OK || !hit.is_hit)
        return status;
    status = read_positions(session, hit.body, error);
    if (status != PEL_OK)
        return status;
    body_grip *grip = &session->bodies[hit.body];
    unsigned char *pins = pel_allocate((size_t)grip->vertex_count, 1);
    if (pins == NULL)
        return pel_fail_memory(error);
    memcpy(pins, grip->pins, (size_t)grip->vertex_count);
    pins[hit.mesh_vertex] = value;
    for (int32_t v = 0; v < grip->vertex_count; v++) {
        const double *x = session->positions + 3 * (size_t)v;
        double to[3] = {x[0] - hit.point[0], x[1] - hit.point[1], x[2] - hit.point[2]};
        if (to[0] * to[0] + to[1] * to[1] + to[2] * to[2] <= reach * reach)
            pins[v] = value;
    }
    if (memcmp(pins, grip->pins, (size_t)grip->vertex_count) != 0) {
        status = set_pins(session, hit.body, pins, error);
        *done = status == PEL_OK;
    }
    if (*done)
        memcpy(grip->pins, pins, (size_t)grip->vertex_count);
    pel_free(pins);
    return status;
}

const unsigned char *pel_session_pins(const pel_session *session, int32_t body, int32_t *count)
{
    if (count != NULL)
        *count = 0;
    if (session == NULL || count == NULL || body < 0 || body >= session->body_count)
        return NULL;
    *count = session->bodies[body].vertex_count;
    return session->bodies[body].pins;
}

double pel_session_pressure(const pel_session *session, int32_t body)
{
    return session != NULL && body >= 0 && body < session->body_count ? session->bodies[body].pressure : 0;
}

static pel_status inflate(pel_session *session, const pel_command *command, pel_error *error)
{
    for (int32_t b = 0; b < session->body_count; b++)
        if (strcmp(session->scene->model.bodies[b].name, command->name) == 0) {
            session->bodies[b].pressure = command->numbers[0];
            return command->numbers[0] != 0 ? PEL_OK : pel_sim_set_forces(session->sim, b, NULL, error);
        }
    return pel_fail(error, PEL_BAD_ARGUMENT, "there is no body '%.60s'", command->name);
}

/* p A n / 3 at each corner of the mesh's triangles as they are now: the force on a vertex is that of its own part of
   the surface */
static pel_status push_body(pel_session *session, int32_t body, pel_error *error)
{
    PEL_ASSERT_INDEX(body, session->body_count);
    const pel_mesh *mesh = mesh_of(session, body);
    pel_status status = read_positions(session, body, error);
    if (status != PEL_OK)
        return status;
    memset(session->forces, 0, 3 * (size_t)mesh->vertex_count * sizeof(double));
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const double *x[3];
        for (int c = 0; c < 3; c++)
            x[c] = session->positions + 3 * (size_t)mesh->triangles[t][c];
        double u[3], w[3];
        for (int i = 0; i < 3; i++) {
            u[i] = x[1][i] - x[0][i];
            w[i] = x[2][i] - x[0][i];
        }
        double share = session->bodies[body].pressure / 6;
        const double force[3] = {share * (u[1] * w[2] - u[2] * w[1]), share * (u[2] * w[0] - u[0] * w[2]),
                                 share * (u[0] * w[1] - u[1] * w[0])};
        for (int c = 0; c < 3; c++)
            for (int i = 0; i < 3; i++)
                session->forces[3 * (size_t)mesh->triangles[t][c] + (size_t)i] += force[i];
    }
    return pel_sim_set_forces(session->sim, body, session->forces, error);
}

static pel_status push_bodies(pel_session *session, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t b = 0; status == PEL_OK && b < session->body_count; b++)
        if (session->bodies[b].pressure != 0)
            status = push_body(session, b, error);
    return status;
}

/* ---- cuts ---- */

static pel_status lead(pel_session *session, const pel_pick_hit *hit, bool *done, pel_error *error)
{
    pel_status status = pel_blade_lead(&session->blade, session->sim, hit, done, error);
    memcpy(session->target, hit->point, sizeof session->target);
    return status == PEL_OK && *done ? follow_surfaces(session, error) : status;
}

static pel_status cut(pel_session *session, const pel_command *command, bool *done, pel_error *error)
{
    pel_pick_hit hit;
    pel_status status = session->hand == PEL_HAND_CUT ? PEL_OK : refuse_busy(session, error);
    if (status == PEL_OK)
        status = pick(session, command, &hit, error);
    *done = status == PEL_OK && hit.is_hit;
    if (!*done)
        return status;
    if (session->hand == PEL_HAND_CUT)
        return lead(session, &hit, done, error);
    status = pel_blade_begin(&session->blade, &hit, error);
    if (status == PEL_OK)
        session->hand = PEL_HAND_CUT;
    memcpy(session->target, hit.point, sizeof session->target);
    return status;
}

/* ---- marks ---- */

static pel_status add_mark(pel_session *session, pel_error *error)
{
    mark made;
    pel_status status = make_mark(session, &made, error);
    if (status != PEL_OK)
        return status;
    if (session->mark_count == MARK_LIMIT) {
        drop_mark(&session->marks[0]);
        memmove(session->marks, session->marks + 1, (MARK_LIMIT - 1) * sizeof *session->marks);
        session->mark_count--;
    }
    session->marks[session->mark_count++] = made;
    return PEL_OK;
}

static pel_status go_back(pel_session *session, const mark *to, pel_error *error)
{
    pel_status status = release(session, error);
    if (status == PEL_OK)
        status = pel_snapshot_restore(session->sim, to->snapshot, error);
    if (status != PEL_OK)
        return status;
    pel_session_events_cut(&session->record, to->record_length);
    session->next_line = to->next_line;
    const unsigned char *pins = to->pins;
    for (int32_t b = 0; b < session->body_count; b++) {
        body_grip *body = &session->bodies[b];
        if (body->vertex_count != to->counts[b] && !set_count(session, b, to->counts[b]))
            return pel_fail_memory(error);
        memcpy(body->pins, pins, (size_t)body->vertex_count);
        pins += body->vertex_count;
        body->pressure = to->pressures[b];
    }
    return PEL_OK;
}

pel_status pel_session_undo(pel_session *session, bool *done, pel_error *error)
{
    PEL_REFUSE_NULL(session, error);
    PEL_REFUSE_NULL(done, error);
    *done = session->mark_count > 0;
    if (!*done)
        return PEL_OK;
    mark *last = &session->marks[session->mark_count - 1];
    pel_status status = go_back(session, last, error);
    if (status != PEL_OK)
        return status;
    drop_mark(last);
    session->mark_count--;
    return PEL_OK;
}

pel_status pel_session_reset(pel_session *session, pel_error *error)
{
    PEL_REFUSE_NULL(session, error);
    pel_status status = go_back(session, &session->start, error);
    for (int32_t m = 0; status == PEL_OK && m < session->mark_count; m++)
        drop_mark(&session->marks[m]);
    if (status == PEL_OK)
        session->mark_count = 0;
    return status;
}

int32_t pel_session_undo_count(const pel_session *session)
{
    return session != NULL ? session->mark_count : 0;
}

/* ---- commands ---- */

/* *done false: nothing changed, so nothing is recorded */
static pel_status do_command(pel_session *session, pel_command *command, bool *done, pel_error *error)
{
    *done = true;
    switch (command->word) {
    case PEL_COMMAND_SET:
        return pel_set_parameter_text(session->sim, command->name, command->value, error);
    case PEL_COMMAND_GRAB:
        return grab(session, command, done, error);
    case PEL_COMMAND_GRASP:
        return grasp(session, command, done, error);
    case PEL_COMMAND_PRESS:
        return press(session, command, error);
    case PEL_COMMAND_MOVE:
        *done = session->hand != PEL_HAND_FREE;
        memcpy(session->target, command->numbers, sizeof session->target);
        return PEL_OK;
    case PEL_COMMAND_RELEASE:
        *done = session->hand != PEL_HAND_FREE;
        return release(session, error);
    case PEL_COMMAND_PIN:
    case PEL_COMMAND_UNPIN:
        return pin(session, command, done, error);
    case PEL_COMMAND_INFLATE:
        return inflate(session, command, error);
    case PEL_COMMAND_CUT:
        return cut(session, command, done, error);
    case PEL_COMMAND_MARK:
        *done = false;
        return add_mark(session, error);
    }
    return PEL_OK;
}

pel_status pel_session_apply(pel_session *session, const char *line, pel_error *error)
{
    PEL_REFUSE_NULL(session, error);
    PEL_REFUSE_NULL(line, error);
    pel_command command;
    bool done = false;
    pel_status status = pel_command_parse(line, &command, error);
    if (status == PEL_OK)
        status = pel_session_events_reserve(&session->record, &command, error);
    if (status != PEL_OK)
        return status;
    status = do_command(session, &command, &done, error);
    if (status == PEL_OK && done)
        pel_session_events_add(&session->record, pel_sim_step_count(session->sim), &command);
    return status;
}

static pel_status step_back(pel_session *session, pel_error *error)
{
    pel_error later;
    bool done = false;
    pel_status status = pel_session_undo(session, &done, &later);
    if (status == PEL_OK && !done)
        status = pel_session_reset(session, &later);
    if (status != PEL_OK && error != NULL)
        *error = later;
    return status;
}

/* scissors, which leave the surface then */
static bool has_closed(const pel_session *session)
{
    return session->hand == PEL_HAND_PRESS && session->shape == PEL_TOOL_SCISSORS &&
           pel_sim_time(session->sim) >= session->closed_at;
}

pel_status pel_session_step(pel_session *session, pel_error *error)
{
    PEL_REFUSE_NULL(session, error);
    pel_status status = move_hand(session, error);
    if (status == PEL_OK)
        status = push_bodies(session, error);
    if (status == PEL_BAD_ARGUMENT && session->hand == PEL_HAND_FREE)
        status = pel_fail(error, PEL_DIVERGED, "the inflating pressure gives forces that are not finite");
    if (status == PEL_OK)
        status = pel_sim_step(session->sim, error);
    if (status == PEL_OK)
        status = follow_surfaces(session, error);
    if (status == PEL_OK && has_closed(session))
        status = release(session, error);
    if (status != PEL_DIVERGED)
        return status;
    pel_status restored = step_back(session, error);
    return restored == PEL_OK ? status : restored;
}

/* ---- the record ---- */

pel_session_events *pel_session_record_of(pel_session *session)
{
    return &session->record;
}

pel_status pel_session_record(const pel_session *session, char **text, pel_error *error)
{
    PEL_REFUSE_NULL(session, error);
    PEL_REFUSE_NULL(text, error);
    return pel_session_events_lines(&session->record, text, error);
}

pel_status pel_session_scene(const pel_session *session, char **text, pel_error *error)
{
    PEL_REFUSE_NULL(session, error);
    PEL_REFUSE_NULL(text, error);
    int64_t steps = pel_sim_step_count(session->sim);
    double duration = (double)(steps > 0 ? steps : 1) * session->scene->sim.solver.dt;
    return pel_session_events_scene(&session->record, pel_scene_text(session->scene), duration, text, error);
}

void pel_session_free_text(char *text)
{
    pel_free(text);
}

/* ---- repeating ---- */

pel_status pel_session_repeat(pel_session *session, pel_error *error)
{
    PEL_REFUSE_NULL(session, error);
    const pel_scene *scene = session->scene;
    int64_t now = pel_sim_step_count(session->sim);
    pel_error cause;
    while (session->next_line < scene->session_count && scene->session[session->next_line].step <= now) {
        const pel_scene_command *next = &scene->session[session->next_line];
        if (pel_session_apply(session, next->line, &cause) != PEL_OK)
            return fail_line(session, next, &cause, error);
        session->next_line++;
    }
    return PEL_OK;
}
