#include "sim/cut.h"

#include "attach/tie.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "blade/hold.h"
#include "blade/incision.h"
#include "math/vec3.h"
#include "mesh/opening.h"
#include "mesh/union_find.h"
#include "model/origin.h"
#include "observe/ledger.h"
#include "pellicle/geometry.h"
#include "pellicle/tear.h"
#include "sim/change.h"
#include "stage/accessors.h"
#include "tear/growth.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- the edges of a path ---- */

typedef struct cut {
    const pel_sim *sim;
    int32_t body;
    const int32_t *origins; /* null = no cuts yet */
    int32_t base_count;
    pel_topology *topology;
    uint8_t *marks; /* (edge_count) */
} cut;

static int32_t origin_of(const cut *c, int32_t v)
{
    return c->origins != NULL ? c->origins[v] : v;
}

/* the next vertex with this origin from `v` on; -1 = none */
static int32_t next_copy(const cut *c, int32_t origin, int32_t v)
{
    if (v <= origin)
        return origin;
    for (v = v > c->base_count ? v : c->base_count; v < c->topology->vertex_count; v++)
        if (origin_of(c, v) == origin)
            return v;
    return -1;
}

typedef enum found { NO_EDGE, BORDER, OPENED, CLOSED } found;

/* the edge between copies of two vertices; of several that is no border, which there is one of at most */
static found find_edge(const cut *c, int32_t a, int32_t b, int32_t *edge)
{
    int32_t from = origin_of(c, a), to = origin_of(c, b);
    found best = NO_EDGE;
    for (int32_t i = next_copy(c, from, 0); i >= 0; i = next_copy(c, from, i + 1))
        for (int32_t j = next_copy(c, to, 0); j >= 0; j = next_copy(c, to, j + 1)) {
            int32_t e = i != j ? pel_topology_edge_between(c->topology, i, j) : -1;
            if (e < 0)
                continue;
            int32_t h = c->topology->half_edge_of_edge[e];
            *edge = e;
            if (c->topology->twin[h] >= 0)
                return CLOSED;
            best = pel_is_lip(&c->sim->given->bodies[c->body], h) ? OPENED : BORDER;
        }
    return best;
}

static pel_status mark_edges(const cut *c, const int32_t *vertices, int32_t vertex_count, pel_error *error)
{
    const char *name = c->sim->given->bodies[c->body].name;
    for (int32_t i = 0; i + 1 < vertex_count; i++) {
        int32_t e, a = vertices[i], b = vertices[i + 1];
        found there = find_edge(c, a, b, &e);
        if (there == NO_EDGE)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "vertex", a,
                                      "name all vertices along the path, or give it in points (`path` of a scene)",
                                      "a cut of body '%s' goes from vertex %d to %d, which no edge joins", name, (int)a,
                                      (int)b);
        if (there == BORDER)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "vertex", a,
                                      "lead the path through the surface; only its ends may be on the border",
                                      "a cut of body '%s' runs along the border from vertex %d to %d", name, (int)a,
                                      (int)b);
        if (there == CLOSED)
            c->marks[e] = 1;
    }
    return PEL_OK;
}

/* an edge inside the surface without another one at its ends stays shut */
static pel_status check_opening(const cut *c, const pel_opening *opening, const int32_t *vertices, pel_error *error)
{
    int32_t marked = 0;
    for (int32_t e = 0; e < c->topology->edge_count; e++)
        marked += c->marks[e];
    if (marked > 0 && opening->edge_count == marked)
        return PEL_OK;
    const char *name = c->sim->given->bodies[c->body].name;
    if (marked == 0)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "vertex", vertices[0],
                                  "leave the cut out, or lead it through the surface",
                                  "a cut of body '%s' opens nothing: its path is open already", name);
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "vertex", vertices[0],
                              "make the path longer, or begin at a border or at another cut",
                              "a cut of body '%s' opens nothing: a single edge inside the surface", name);
}

/* ---- vertices that move ---- */

/* the nearest place to x on the triangles around a vertex, as long as it is nearer than `least` */
static void look_around(const cut *c, int32_t v, const double x[3], double *least, pel_vertex_move *move)
{
    const pel_mesh *mesh = c->sim->given->def.bodies[c->body].mesh;
    int32_t first = c->topology->corner_of_vertex[v], h = first;
    do {
        const int32_t *corners = mesh->triangles[h / 3];
        double weights[3],
            distance = pel_closest_point_triangle(x, mesh->positions[corners[0]], mesh->positions[corners[1]],
                                                  mesh->positions[corners[2]], weights);
        if (distance < *least) {
            *least = distance;
            memcpy(move->corners, corners, sizeof move->corners);
            memcpy(move->weights, weights, sizeof move->weights);
        }
        h = pel_half_edge_turn(c->topology, h);
    } while (h >= 0 && h != first);
}

/* where they were: within two rings, which they cannot leave */
static pel_status find_moves(const cut *c, const pel_growth *growth, pel_surfaces *surfaces, pel_error *error)
{
    int32_t count = 0;
    for (int32_t v = 0; v < c->topology->vertex_count; v++)
        count += growth->is_moved[v];
    if (count == 0)
        return PEL_OK;
    surfaces->moves[c->body] = pel_allocate((size_t)count, sizeof **surfaces->moves);
    if (surfaces->moves[c->body] == NULL)
        return pel_fail_memory(error);
    for (int32_t v = 0; v < c->topology->vertex_count; v++) {
        double least = HUGE_VAL, *x = growth->mesh->positions[v];
        if (!growth->is_moved[v])
            continue;
        pel_vertex_move *move = &surfaces->moves[c->body][surfaces->move_counts[c->body]++];
        move->vertex = v;
        look_around(c, v, x, &least, move);
        int32_t first = c->topology->corner_of_vertex[v];
        for (int32_t h = first; h >= 0;) {
            look_around(c, pel_half_edge_target(c->topology, h), x, &least, move);
            h = pel_half_edge_turn(c->topology, h);
            h = h == first ? -1 : h;
        }
        move->own = growth->left_behind;
        for (int i = 0; i < 3; i++)
            move->weights[i] *= 1 - move->own;
    }
    return PEL_OK;
}

/* ---- the cut ---- */

static pel_status apply(pel_sim *sim, const cut *c, const pel_opening *opening, int32_t cuts_done,
                        const pel_growth *growth, pel_error *error)
{
    pel_surfaces surfaces;
    pel_change change = {0};
    pel_status status = pel_surfaces_begin(sim, &surfaces, error);
    if (status == PEL_OK) {
        size_t size = (size_t)opening->vertex_count * sizeof *opening->parents;
        surfaces.cuts_done = cuts_done;
        surfaces.is_tear = growth != NULL;
        surfaces.sources[c->body] = pel_allocate(size, 1);
        if (surfaces.sources[c->body] == NULL)
            status = pel_fail_memory(error);
        else
            memcpy(surfaces.sources[c->body], opening->parents, size);
    }
    if (status == PEL_OK)
        status = pel_surfaces_set(&surfaces, sim, c->body, opening->vertex_count,
                                  (const int32_t(*)[3])(void *)opening->triangles,
                                  growth != NULL ? (const double(*)[3])growth->mesh->positions : NULL, error);
    if (status == PEL_OK && growth != NULL)
        status = find_moves(c, growth, &surfaces, error);
    if (status == PEL_OK)
        status = pel_change_begin(sim, &change, error);
    if (status == PEL_OK)
        status = pel_change_surfaces(&change, &surfaces, error);
    if (status == PEL_OK)
        status = pel_change_apply(sim, &change, error);
    pel_change_end(&change);
    pel_surfaces_end(&surfaces);
    return status;
}

static pel_status open_path(pel_sim *sim, int32_t body, const int32_t *vertices, int32_t vertex_count,
                            int32_t cuts_done, pel_error *error)
{
    const pel_body_def *def = &sim->given->def.bodies[body];
    if (sim->ties != NULL)
        return pel_ties_refuse("a cut", error);
    sim->cut_is_held = false;
    cut c = {.sim = sim, .body = body, .origins = def->origins, .base_count = pel_origins_base_count(def)};
    pel_opening opening = {0};
    pel_status status = pel_topology_create(def->mesh, &c.topology, error);
    if (status == PEL_OK) {
        c.marks = pel_allocate((size_t)c.topology->edge_count, 1);
        status = c.marks != NULL ? mark_edges(&c, vertices, vertex_count, error) : pel_fail_memory(error);
    }
    if (status == PEL_OK)
        status = pel_opening_find(c.topology, c.marks, &opening, error);
    if (status == PEL_OK)
        status = check_opening(&c, &opening, vertices, error);
    if (status == PEL_OK)
        status = apply(sim, &c, &opening, cuts_done, NULL, error);
    pel_opening_clear(&opening);
    pel_topology_destroy(c.topology);
    pel_free(c.marks);
    return status;
}

pel_status pel_cut(pel_sim *sim, int32_t body, const int32_t *vertices, int32_t vertex_count, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    pel_status status = pel_cut_check_path(sim, body, vertices, vertex_count, error);
    if (status == PEL_OK)
        status = pel_cut_check_sim(sim, error);
    return status == PEL_OK ? open_path(sim, body, vertices, vertex_count, sim->cuts_done, error) : status;
}

/* names the cut in front of an error */
static void name_cut(int32_t number, double at, pel_error *error)
{
    char what[sizeof error->what];
    if (error == NULL)
        return;
    memcpy(what, error->what, sizeof what);
    snprintf(error->what, sizeof error->what, "cut %d at %g s: %.*s", (int)number + 1, at, (int)sizeof what - 40, what);
}

pel_status pel_cuts_make(pel_sim *sim, pel_error *error)
{
    pel_status status = PEL_OK;
    while (status == PEL_OK && sim->cuts_done < sim->def.cut_count) {
        /* the change makes another copy of the def */
        int32_t number = sim->cuts_done;
        const pel_cut_def *next = &sim->def.cuts[number];
        double at = next->at;
        if (!pel_sim_has_come(sim, at))
            return PEL_OK;
        status = open_path(sim, next->body, next->vertices, next->vertex_count, number + 1, error);
        /* once more before the next step */
        if (status == PEL_BAD_ARGUMENT && sim->cut_is_held)
            return PEL_OK;
        if (status != PEL_OK && status != PEL_OUT_OF_MEMORY)
            name_cut(number, at, error);
    }
    return status;
}

/* ---- seams ---- */

pel_status pel_seams_open(pel_sim *sim, pel_seam_ends *ends, pel_error *error)
{
    pel_status status = PEL_OK;
    /* a body that opens makes the seams anew */
    for (int32_t i = 0; status == PEL_OK && sim->tear != NULL && i < sim->tear->seam_count; i++) {
        pel_seams *seams = &sim->tear->seams[i];
        pel_opening opening = {0};
        if (sim->shells != NULL)
            pel_shell_forces_follow(sim->shells, sim->state->position);
        if (pel_seams_look(seams) == 0)
            continue;
        cut c = {.sim = sim, .body = seams->body, .topology = seams->survey.topology, .marks = seams->marks};
        const int32_t first = c.topology->vertex_count;
        sim->cut_is_held = false;
        status = pel_opening_find(c.topology, c.marks, &opening, error);
        if (status == PEL_OK)
            status = apply(sim, &c, &opening, sim->cuts_done, NULL, error);
        if (status == PEL_OK && sim->shells != NULL)
            pel_shell_forces_follow(sim->shells, sim->state->position);
        if (status == PEL_OK)
            status = pel_seam_ends_add(ends, &sim->tear->seams[i], first, opening.parents, error);
        /* once more before the next step */
        if (status == PEL_BAD_ARGUMENT && sim->cut_is_held)
            status = PEL_OK;
        pel_opening_clear(&opening);
    }
    return status;
}

/* ---- tears ---- */

/* that vertices try where a way is refused, each by half */
enum { SHORTER_WAYS = 3 };

static bool is_refused(const pel_sim *sim, pel_status status)
{
    return status == PEL_UNSTABLE || (status == PEL_BAD_ARGUMENT && sim->cut_is_held);
}

/* opens the growing edges of a body, after its vertices have moved */
static pel_status open_growth(pel_sim *sim, int32_t survey, pel_growth *growth, bool *is_open, pel_error *error)
{
    int32_t body = sim->tear->surveys[survey].body;
    cut c = {.sim = sim, .body = body, .marks = growth->marks};
    pel_opening opening = {0};
    sim->cut_is_held = false;
    pel_status status = pel_topology_create(sim->given->def.bodies[body].mesh, &c.topology, error);
    if (status == PEL_OK)
        status = pel_opening_find(c.topology, c.marks, &opening, error);
    *is_open = status == PEL_OK && opening.edge_count > 0;
    if (*is_open)
        status = apply(sim, &c, &opening, sim->cuts_done, growth, error);
    /* Shorter edges may need shorter steps than the given ones: vertices then move less in the rest shape, at last not
       at all. In a fold they may run into the surface: the tear goes where it shall, but they follow less in space, and
       balance is found from there. */
    for (int left = SHORTER_WAYS; left >= 0 && is_refused(sim, status); left--) {
        double share = left > 0 ? 0.5 : 0;
        if (sim->cut_is_held)
            growth->left_behind = 1 - share * (1 - growth->left_behind);
        else
            pel_growth_shorten(sim->tear, survey, growth, share);
        sim->cut_is_held = false;
        status = apply(sim, &c, &opening, sim->cuts_done, growth, error);
    }
    /* once more before the next step */
    if (status == PEL_BAD_ARGUMENT && sim->cut_is_held) {
        status = PEL_OK;
        *is_open = false;
    }
    pel_opening_clear(&opening);
    pel_topology_destroy(c.topology);
    return status;
}

pel_status pel_tears_grow(pel_sim *sim, bool *has_grown, pel_error *error)
{
    pel_status status = PEL_OK;
    *has_grown = false;
    /* a body that opens makes the surveys anew */
    for (int32_t i = 0; status == PEL_OK && sim->tear != NULL && i < sim->tear->survey_count; i++) {
        pel_growth growth;
        bool is_open = false;
        status = pel_growth_find(sim->tear, i, &growth, error);
        if (status == PEL_OK && growth.edge_count > 0)
            status = open_growth(sim, i, &growth, &is_open, error);
        if (status == PEL_OK && is_open) {
            pel_ledger_book_tear(sim, growth.energy);
            *has_grown = true;
        }
        pel_growth_clear(&growth);
    }
    return status;
}

/* ---- blades ---- */

/* opens what a blade has gone through; false if it is held back */
static pel_status open_incision(pel_sim *sim, int32_t body, pel_incision *incision, bool *is_open, pel_error *error)
{
    const pel_mesh *mesh = sim->given->def.bodies[body].mesh;
    cut c = {.sim = sim, .body = body, .marks = incision->growth.marks};
    pel_opening opening = {0};
    sim->cut_is_held = false;
    pel_status status = pel_cut_check_sim(sim, error);
    if (status == PEL_OK)
        status = pel_topology_create(mesh, &c.topology, error);
    if (status == PEL_OK)
        status = pel_opening_find(c.topology, c.marks, &opening, error);
    *is_open = status == PEL_OK && opening.edge_count > 0;
    if (*is_open)
        status = apply(sim, &c, &opening, sim->cuts_done, &incision->growth, error);
    /* shorter edges may need shorter steps than the given ones, and vertices that move may run into the surface: the
       edges then open as they are */
    if (is_refused(sim, status)) {
        sim->cut_is_held = false;
        memcpy(incision->growth.mesh->positions, mesh->positions, (size_t)mesh->vertex_count * sizeof *mesh->positions);
        memset(incision->growth.is_moved, 0, (size_t)mesh->vertex_count);
        status = apply(sim, &c, &opening, sim->cuts_done, &incision->growth, error);
    }
    /* once more after the next step */
    if (status == PEL_BAD_ARGUMENT && sim->cut_is_held) {
        status = PEL_OK;
        *is_open = false;
    }
    pel_opening_clear(&opening);
    pel_topology_destroy(c.topology);
    return status;
}

static bool is_tip_of(const pel_blade_tip *tips, int32_t count, const pel_blade_tip *tip)
{
    for (int32_t i = 0; i < count; i++)
        if (tips[i].body == tip->body && tips[i].vertex == tip->vertex)
            return true;
    return false;
}

/* a vertex that opens is let go before, so that its copies are free */
static void let_go_tips(pel_sim *sim, pel_tool *tool, const pel_incision *incision)
{
    for (int32_t i = 0; i < tool->blade->tip_count; i++)
        if (!is_tip_of(incision->tips, incision->tip_count, &tool->blade->tips[i]))
            pel_blade_let_go(sim, tool, tool->blade->tips[i].body, tool->blade->tips[i].vertex);
}

static void take_tips(pel_sim *sim, pel_tool *tool)
{
    for (int32_t i = 0; i < tool->blade->tip_count; i++)
        if (!tool->blade->tips[i].is_pressing && pel_blade_resists(sim, tool))
            pel_blade_take_on(sim, tool, &tool->blade->tips[i]);
}

/* a blade in one body after a step; the simulation may be made anew */
static pel_status cut_body(pel_sim *sim, int32_t tool, int32_t body, bool *has_cut, pel_error *error)
{
    pel_incision incision;
    bool is_open = true;
    pel_status status = pel_incision_find(sim, tool, body, &incision, error);
    bool opens = status == PEL_OK && incision.growth.edge_count > 0;
    if (opens) {
        let_go_tips(sim, &sim->tools->items[tool], &incision);
        status = open_incision(sim, body, &incision, &is_open, error);
    }
    if (status == PEL_OK && is_open) {
        pel_tool *own = &sim->tools->items[tool];
        own->blade->tip_count = incision.tip_count;
        memcpy(own->blade->tips, incision.tips, sizeof incision.tips);
        *has_cut |= opens;
        pel_ledger_book_tear(sim, incision.growth.energy);
    }
    if (status == PEL_OK && opens)
        take_tips(sim, &sim->tools->items[tool]);
    pel_incision_clear(&incision);
    return status;
}

pel_status pel_blades_cut(pel_sim *sim, bool *has_cut, pel_error *error)
{
    pel_status status = PEL_OK;
    *has_cut = false;
    if (sim->tools->blade_before == NULL)
        return PEL_OK;
    for (int32_t t = 0; status == PEL_OK && t < sim->tools->count; t++) {
        pel_tool *tool = &sim->tools->items[t];
        if (tool->blade == NULL)
            continue;
        bool closes = pel_blade_close(sim, tool);
        pel_blade_slide(sim, tool, pel_incision_limit);
        for (int32_t b = 0; status == PEL_OK && closes && b < sim->given->body_count; b++)
            if (pel_tool_acts_on(&sim->tools->items[t], b))
                status = cut_body(sim, t, b, has_cut, error);
    }
    return status;
}

/* ---- readings ---- */

/* pieces that are joined by edges, or were by edges that are lips now */
static int32_t count_pieces(const pel_mesh *mesh, const int32_t *origins, int32_t *parents)
{
    int32_t count = 0;
    pel_union_find_reset(parents, mesh->vertex_count);
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int k = 1; k < 3; k++)
            pel_union_find_join(parents, mesh->triangles[t][0], mesh->triangles[t][k]);
    for (int32_t v = 0; origins != NULL && v < mesh->vertex_count; v++)
        pel_union_find_join(parents, v, origins[v]);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        count += pel_union_find_root(parents, v) == v;
    return count;
}

static pel_status add_body(const pel_sim *sim, int32_t body, pel_cut_reading *reading, pel_error *error)
{
    const pel_body *own = &sim->given->bodies[body];
    const pel_body_def *def = &sim->given->def.bodies[body];
    const pel_mesh *mesh = own->mesh;
    reading->released_count += def->released_count;
    if (def->origins == NULL)
        return PEL_OK;
    int32_t *parents = pel_allocate((size_t)mesh->vertex_count, sizeof *parents);
    if (parents == NULL)
        return pel_fail_memory(error);
    for (int32_t h = 0; h < 3 * mesh->triangle_count; h++) {
        const int32_t *v = mesh->triangles[h / 3];
        if (pel_is_lip(own, h))
            reading->length += 0.5 * pel_vec3_distance(mesh->positions[v[h % 3]], mesh->positions[v[(h + 1) % 3]]);
    }
    reading->copy_count += mesh->vertex_count - pel_origins_base_count(def);
    reading->island_count += count_pieces(mesh, NULL, parents) - count_pieces(mesh, def->origins, parents);
    pel_free(parents);
    return PEL_OK;
}

pel_status pel_sim_get_cuts(const pel_sim *sim, int32_t body, pel_cut_reading *reading, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(reading, error);
    *reading = (pel_cut_reading){0};
    if (body < -1 || body >= sim->given->body_count)
        return pel_fail(error, PEL_BAD_ARGUMENT, "body %d does not exist", (int)body);
    pel_status status = PEL_OK;
    for (int32_t b = 0; status == PEL_OK && b < sim->given->body_count; b++)
        if (body < 0 || body == b)
            status = add_body(sim, b, reading, error);
    return status;
}

int32_t pel_sim_cut_count(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    return sim->def.cut_count;
}

bool pel_sim_can_tear(const pel_sim *sim)
{
    return sim != NULL && (sim->def.cut_count > 0 || sim->tear != NULL || sim->tools->blade_before != NULL);
}

int32_t pel_sim_cuts_done(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    return sim->cuts_done;
}

bool pel_sim_cut_is_held(const pel_sim *sim)
{
    return sim != NULL && sim->cut_is_held;
}

void pel_sim_get_origins(const pel_sim *sim, int32_t body, int32_t *origins)
{
    if (!pel_sim_has_body(sim, body) || origins == NULL)
        return;
    const pel_body_def *def = &sim->given->def.bodies[body];
    for (int32_t v = 0; v < def->mesh->vertex_count; v++)
        origins[v] = pel_origin_of(def, v);
}
