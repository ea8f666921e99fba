/* The copies of a vertex that a cut has divided lie on each other. Contact knows the side of a pair from where it is,
   so lips need a gap from the start on: each copy moves away from its lips, in the planes of their triangles, by half
   of the gap of kin. What the copies of a vertex have in common of that is left out, so that their mean
   place, weighted with mass, stays; as their velocities are equal, both momenta stay too. */
#include "touch/lips.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "model/origin.h"
#include "tool/follow.h"
#include "tool/tools.h"
#include "touch/contact.h"

/* of the distance that kin keep: methods that minimise keep a little more than that */
#define ROOM (1 + 2 * PEL_SLACK_SHARE)
/* of the way of a straight lip: the most that a copy in an acute corner moves */
#define MOST_WAY 10.0

static bool is_cut(const pel_sim *sim, int32_t body)
{
    return sim->given->def.bodies[body].origins != NULL;
}

pel_status pel_lips_find_origins(pel_sim *sim, pel_error *error)
{
    bool any = false;
    for (int32_t b = 0; b < sim->given->body_count; b++)
        any |= is_cut(sim, b);
    if (!any)
        return PEL_OK;
    int32_t *origins = sim->touch->origins = pel_allocate((size_t)sim->model->vertex_count, sizeof *origins);
    if (origins == NULL)
        return pel_fail_memory(error);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        origins[v] = v;
    for (int32_t b = 0; b < sim->given->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        for (int32_t v = 0; is_cut(sim, b) && v < body->mesh->vertex_count; v++)
            origins[body->model_index[v]] = body->model_index[sim->given->def.bodies[b].origins[v]];
    }
    return PEL_OK;
}

/* ---- ways ---- */

typedef struct parting {
    pel_sim *sim;
    const pel_body *body;
    const int32_t *origins; /* (vertices of the mesh) */
    double (*ways)[3];      /* (same) at first sums of the normals of its lips, then m */
    int32_t *lip_counts;    /* (same) */
    int32_t *leaders;       /* (same) the first of the copies that lie on it; itself = alone */
    int32_t *chain;         /* (same) the copy of the same vertex before it, or the last one of an origin */
    int32_t *crowds;        /* (same) of a leader: number of copies that lie there */
    double (*moments)[3];   /* (same) of a leader: sum of mass times way of those that lie on it [kg m] */
    double *masses;         /* (same) of a leader: sum of their masses [kg] */
} parting;

/* unit vector from the edge of a half-edge into its triangle, in its plane; zero where that is flat */
static void find_inward(const parting *p, int32_t h, double inward[3])
{
    const int32_t *corners = p->body->mesh->triangles[h / 3];
    double x[3][3], along[3];
    for (int i = 0; i < 3; i++)
        pel_vertex_position(p->sim->state->position, p->body->model_index[corners[(h % 3 + i) % 3]], x[i]);
    pel_vec3_subtract(x[1], x[0], along);
    pel_vec3_subtract(x[2], x[0], inward);
    double square = pel_vec3_squared_length(along);
    pel_vec3_along(inward, square > 0 ? -pel_vec3_dot(inward, along) / square : 0, along, inward);
    pel_vec3_normalize(inward);
}

static void add_normals(const parting *p)
{
    for (int32_t h = 0; h < 3 * p->body->mesh->triangle_count; h++) {
        const int32_t *corners = p->body->mesh->triangles[h / 3];
        int32_t ends[2] = {corners[h % 3], corners[(h + 1) % 3]};
        double inward[3];
        if (!pel_is_lip(p->body, h))
            continue;
        find_inward(p, h, inward);
        for (int i = 0; i < 2; i++) {
            pel_vec3_add(p->ways[ends[i]], inward, p->ways[ends[i]]);
            p->lip_counts[ends[i]]++;
        }
    }
}

/* From the sum s of the normals of its lips to a way whose part along each of them is `half`: of two lips 2 half s /
   |s|^2. */
static void set_ways(const parting *p, double half)
{
    for (int32_t v = 0; v < p->body->mesh->vertex_count; v++) {
        double *way = p->ways[v], length = pel_vec3_length(way);
        if (length > 0)
            pel_vec3_scale(way, half * pel_min(p->lip_counts[v] / length, MOST_WAY) / length, way);
    }
}

static bool lies_on(const parting *p, int32_t a, int32_t b)
{
    const pel_record *x = p->sim->state->position;
    for (int k = 0; k < 3; k++)
        if (x[p->body->model_index[a]][k] != x[p->body->model_index[b]][k])
            return false;
    return true;
}

/* copies come after their origins, and end with the one that was made last */
static void find_leaders(const parting *p)
{
    for (int32_t v = 0; v < p->body->mesh->vertex_count; v++) {
        int32_t origin = p->origins[v];
        p->leaders[v] = v;
        p->chain[v] = v != origin ? p->chain[origin] : v;
        for (int32_t other = p->chain[v]; v != origin; other = p->chain[other]) {
            if (lies_on(p, other, v))
                p->leaders[v] = other;
            if (other == origin)
                break;
        }
        p->chain[origin] = v;
    }
}

static void add_moments(const parting *p)
{
    for (int32_t v = 0; v < p->body->mesh->vertex_count; v++) {
        int32_t leader = p->leaders[v];
        double mass = (double)p->sim->model->mass[p->body->model_index[v]];
        p->crowds[leader]++;
        p->masses[leader] += mass;
        pel_vec3_along(p->moments[leader], mass, p->ways[v], p->moments[leader]);
    }
}

static void shift(pel_record *positions, int32_t v, const double way[3])
{
    for (int k = 0; positions != NULL && k < 3; k++)
        positions[v][k] += (pel_real)way[k];
}

static void move_copies(const parting *p)
{
    const pel_state *state = p->sim->state;
    for (int32_t v = 0; v < p->body->mesh->vertex_count; v++) {
        int32_t leader = p->leaders[v], place = p->body->model_index[v];
        double way[3];
        if (p->crowds[leader] < 2)
            continue;
        pel_vec3_along(p->ways[v], -1 / p->masses[leader], p->moments[leader], way);
        shift(state->position, place, way);
        shift(state->position_before, place, way);
        shift(state->older_position, place, way);
    }
}

static void part_body(parting *p, double gap)
{
    add_normals(p);
    set_ways(p, 0.5 * gap);
    find_leaders(p);
    add_moments(p);
    move_copies(p);
}

static pel_status part(pel_sim *sim, int32_t body, pel_error *error)
{
    const pel_body *own = &sim->model->bodies[body];
    size_t count = (size_t)own->mesh->vertex_count;
    double gap = ROOM * pel_contact_kin_share(sim->contacts, body) * sim->contacts->groups[body].thickness;
    parting p = {.sim = sim, .body = own, .origins = sim->given->def.bodies[body].origins};
    pel_status status = PEL_OK;
    if (PEL_ALLOCATE_ALL(PEL_ROOM(p.ways, count), PEL_ROOM(p.lip_counts, count), PEL_ROOM(p.leaders, count),
                         PEL_ROOM(p.chain, count), PEL_ROOM(p.crowds, count), PEL_ROOM(p.moments, count),
                         PEL_ROOM(p.masses, count)))
        part_body(&p, gap);
    else
        status = pel_fail_memory(error);
    PEL_FREE_ALL(p.ways, p.lip_counts, p.leaders, p.chain, p.crowds, p.moments, p.masses);
    return status;
}

/* moves the anchors of held vertices to their new places */
static void move_anchors(const pel_sim *sim)
{
    for (int32_t t = 0; t < sim->tools->count; t++) {
        pel_tool *tool = &sim->tools->items[t];
        const pel_tool_path path = pel_tool_path_at(tool, &tool->pose);
        for (int32_t i = 0; i < tool->held_count; i++) {
            int32_t v = tool->held[i];
            double x[3];
            if (!(pel_vertex_share(&sim->model->bodies[sim->model->body_of_slice[v / PEL_WIDTH]],
                                   sim->model->mesh_vertex[v]) < 1))
                continue;
            pel_vertex_position(sim->state->position, v, x);
            pel_tool_path_anchor(&path, v, x, tool->anchors[i]);
        }
    }
}

pel_status pel_lips_part(pel_sim *sim, pel_error *error)
{
    pel_status status = PEL_OK;
    if (sim->contacts == NULL || !sim->touch->def.self || sim->touch->origins == NULL)
        return PEL_OK;
    for (int32_t b = 0; status == PEL_OK && b < sim->model->body_count; b++)
        if (is_cut(sim, b))
            status = part(sim, b, error);
    if (status == PEL_OK)
        move_anchors(sim);
    return status;
}
