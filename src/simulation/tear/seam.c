/* A triangle pulls at each of its sides. With the gradients g of its energy on the corners, the force per length at
   rest on the side opposite to corner a is the first Piola-Kirchhoff stress times the normal of the side and the
   thickness,

       P N h = -2 g_a / L          since g_a = A h P grad q_a and grad q_a = -N L / 2 A

   with the length L at rest, for membranes of all laws, fibres and springs alike. Across an edge acts the mean of what
   its two triangles carry. Its part along the edge and out of the surface is shear; pressure does not count.

   The energy of the separation is the integral of crack closure (Irwin 1957; at vertices Rybicki and Kanninen 1977):
   what the sides carried at the moment times half of what they part by until they are in balance again. */
#include "tear/seam.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "def/row.h"
#include "math/vec3.h"
#include "mesh/opening.h"
#include "model/origin.h"
#include "stage/accessors.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

pel_seam_def pel_seam_def_default(void)
{
    pel_seam_def def = {0};
    pel_def_reset(PEL_DEF_SEAM, &def);
    return def;
}

bool pel_body_has_seam(const pel_sim *sim, int32_t body)
{
    for (int32_t s = 0; s < sim->def.seam_count; s++)
        if (sim->def.seams[s].body == body)
            return true;
    return false;
}

/* ---- edges ---- */

/* the edges of one seam: pairs of vertices of a path, or flags of a region */
typedef struct edge_names {
    uint64_t *pairs; /* (pair_count) rising */
    int32_t pair_count;
    uint8_t *is_in; /* (vertices before all cuts) */
} edge_names;

static uint64_t pair_of(int32_t a, int32_t b)
{
    uint64_t low = (uint64_t)(a < b ? a : b), high = (uint64_t)(a < b ? b : a);
    return low << 32 | high;
}

static int by_value(const void *a, const void *b)
{
    const uint64_t *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

static pel_status name_edges(const pel_seam_def *def, int32_t base_count, edge_names *names, pel_error *error)
{
    *names = (edge_names){.pair_count = def->path != NULL ? def->path_count - 1 : 0};
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(names->pairs, names->pair_count), PEL_ROOM(names->is_in, base_count)))
        return pel_fail_memory(error);
    for (int32_t i = 0; i < names->pair_count; i++)
        names->pairs[i] = pair_of(def->path[i], def->path[i + 1]);
    qsort(names->pairs, (size_t)names->pair_count, sizeof *names->pairs, by_value);
    for (int32_t i = 0; def->path == NULL && i < def->vertex_count; i++)
        names->is_in[def->vertices[i]] = 1;
    return PEL_OK;
}

static bool is_named(const edge_names *names, int32_t a, int32_t b)
{
    uint64_t pair = pair_of(a, b);
    if (names->is_in[a] && names->is_in[b])
        return true;
    return names->pair_count > 0 &&
           bsearch(&pair, names->pairs, (size_t)names->pair_count, sizeof pair, by_value) != NULL;
}

/* a path through edges of the mesh, before anything is cut */
static pel_status check_path(const pel_seams *seams, int32_t seam, pel_error *error)
{
    const pel_topology *topology = seams->survey.topology;
    const pel_seam_def *def = &seams->survey.sim->def.seams[seam];
    for (int32_t i = 0; def->path != NULL && i + 1 < def->path_count; i++) {
        int32_t a = def->path[i], b = def->path[i + 1];
        int32_t e = a != b && topology->corner_of_vertex[a] >= 0 ? pel_topology_edge_between(topology, a, b) : -1;
        if (e < 0)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "vertex", a,
                                      "name all vertices along the path, or give it in points (`path` of a scene)",
                                      "seam %d goes from vertex %d to %d, which no edge joins", (int)seam + 1, (int)a,
                                      (int)b);
        if (topology->twin[topology->half_edge_of_edge[e]] < 0)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "vertex", a,
                                      "lead the path through the surface; only its ends may be on the border",
                                      "seam %d runs along the border from vertex %d to %d", (int)seam + 1, (int)a,
                                      (int)b);
    }
    return PEL_OK;
}

static void count_mark(pel_seams *seams, int32_t edge, int32_t by)
{
    const pel_topology *topology = seams->survey.topology;
    int32_t h = topology->half_edge_of_edge[edge];
    seams->mark_counts[pel_half_edge_origin(topology, h)] += by;
    seams->mark_counts[pel_half_edge_target(topology, h)] += by;
}

/* a marked edge with another one or a border at an end; a single one inside the surface stays shut */
static bool can_open(const pel_seams *seams, int32_t edge)
{
    const pel_topology *topology = seams->survey.topology;
    int32_t h = topology->half_edge_of_edge[edge];
    const int32_t ends[2] = {pel_half_edge_origin(topology, h), pel_half_edge_target(topology, h)};
    for (int i = 0; i < 2; i++)
        if (seams->mark_counts[ends[i]] > 1 || topology->twin[topology->corner_of_vertex[ends[i]]] < 0)
            return true;
    return false;
}

/* some edge of a seam opens once all of them are marked */
static bool any_can_open(pel_seams *seams, int32_t first)
{
    bool any = false;
    for (int32_t i = first; i < seams->edge_count; i++)
        count_mark(seams, seams->edges[i].edge, 1);
    for (int32_t i = first; i < seams->edge_count; i++)
        any |= can_open(seams, seams->edges[i].edge);
    for (int32_t i = first; i < seams->edge_count; i++)
        count_mark(seams, seams->edges[i].edge, -1);
    return any;
}

static bool add_edge(pel_seams *seams, size_t *room, int32_t edge, int32_t seam)
{
    if (!pel_reserve((void **)&seams->edges, room, (size_t)seams->edge_count + 1, sizeof *seams->edges))
        return false;
    seams->edges[seams->edge_count++] = (pel_seam_edge){edge, seam};
    return true;
}

static pel_status add_seam(pel_seams *seams, int32_t seam, size_t *room, pel_error *error)
{
    const pel_sim *sim = seams->survey.sim;
    const pel_body_def *body = &sim->given->def.bodies[seams->body];
    const pel_topology *topology = seams->survey.topology;
    int32_t first = seams->edge_count;
    edge_names names;
    pel_status status = body->origins == NULL ? check_path(seams, seam, error) : PEL_OK;
    if (status != PEL_OK)
        return status;
    status = name_edges(&sim->def.seams[seam], pel_origins_base_count(body), &names, error);
    for (int32_t e = 0; status == PEL_OK && e < topology->edge_count; e++) {
        int32_t h = topology->half_edge_of_edge[e];
        if (topology->twin[h] >= 0 &&
            is_named(&names, pel_origin_of(body, pel_half_edge_origin(topology, h)),
                     pel_origin_of(body, pel_half_edge_target(topology, h))) &&
            !add_edge(seams, room, e, seam))
            status = pel_fail_memory(error);
    }
    PEL_FREE_ALL(names.pairs, names.is_in);
    if (status == PEL_OK && body->origins == NULL && !any_can_open(seams, first))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "seam", seam,
                                  "give two or more edges that meet in a vertex, or one that begins at a border",
                                  "seam %d of body '%s' has no edge that can open", (int)seam + 1,
                                  sim->given->bodies[seams->body].name);
    return status;
}

pel_status pel_seams_begin(pel_seams *seams, pel_sim *sim, int32_t body, pel_error *error)
{
    size_t room = 0;
    *seams = (pel_seams){.body = body};
    pel_status status = pel_survey_begin(&seams->survey, sim, body, error);
    if (status != PEL_OK)
        return status;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(seams->marks, seams->survey.topology->edge_count),
                          PEL_ROOM(seams->mark_counts, seams->survey.topology->vertex_count)))
        return pel_fail_memory(error);
    for (int32_t s = 0; status == PEL_OK && s < sim->def.seam_count; s++)
        if (sim->def.seams[s].body == body)
            status = add_seam(seams, s, &room, error);
    return status;
}

void pel_seams_end(pel_seams *seams)
{
    pel_survey_end(&seams->survey);
    PEL_FREE_ALL(seams->edges, seams->marks, seams->mark_counts);
    *seams = (pel_seams){0};
}

/* ---- the load ---- */

/* N/m, force per length at rest on the side of a triangle, and the present direction out of the triangle across it */
static void pull_of(const pel_seams *seams, int32_t half_edge, double pull[3], double out[3])
{
    const pel_survey *s = &seams->survey;
    const pel_body *body = &s->sim->model->bodies[s->body];
    const int32_t *v = body->mesh->triangles[half_edge / 3];
    int from = half_edge % 3, to = (from + 1) % 3, apex = (from + 2) % 3;
    double gradient[3][3] = {{0}}, x[3][3], along[3];
    pel_survey_triangle(s, half_edge / 3, gradient);
    double length = pel_vec3_distance(body->mesh->positions[v[from]], body->mesh->positions[v[to]]);
    pel_vec3_scale(gradient[apex], -2 / length, pull);
    for (int c = 0; c < 3; c++)
        pel_vertex_position(s->sim->state->position, body->model_index[v[c]], x[c]);
    pel_vec3_subtract(x[to], x[from], along);
    pel_vec3_normalize(along);
    pel_vec3_subtract(x[from], x[apex], out);
    pel_vec3_along(out, -pel_vec3_dot(out, along), along, out);
    pel_vec3_normalize(out);
}

double pel_seams_load(const pel_seams *seams, int32_t edge)
{
    const pel_topology *topology = seams->survey.topology;
    int32_t h = topology->half_edge_of_edge[edge];
    double pulls[2][3], outs[2][3], pull[3], out[3];
    pull_of(seams, h, pulls[0], outs[0]);
    pull_of(seams, topology->twin[h], pulls[1], outs[1]);
    for (int c = 0; c < 3; c++) {
        pull[c] = 0.5 * (pulls[0][c] - pulls[1][c]);
        out[c] = outs[0][c] - outs[1][c];
    }
    pel_vec3_normalize(out);
    double tension = pel_vec3_dot(pull, out);
    if (tension < 0)
        pel_vec3_along(pull, -tension, out, pull);
    return pel_vec3_length(pull);
}

static bool is_due(const pel_seams *seams, const pel_seam_edge *edge)
{
    const pel_sim *sim = seams->survey.sim;
    const pel_seam_def *def = &sim->def.seams[edge->seam];
    if (def->opens_at >= 0 && pel_sim_has_come(sim, def->opens_at))
        return true;
    return def->strength > 0 && pel_seams_load(seams, edge->edge) >= def->strength;
}

int32_t pel_seams_look(pel_seams *seams)
{
    int32_t count = 0;
    bool any = false;
    memset(seams->marks, 0, (size_t)seams->survey.topology->edge_count);
    for (int32_t i = 0; i < seams->edge_count; i++) {
        int32_t e = seams->edges[i].edge;
        if (seams->marks[e] || !is_due(seams, &seams->edges[i]))
            continue;
        seams->marks[e] = 1;
        count_mark(seams, e, 1);
        any = true;
    }
    for (int32_t i = 0; any && i < seams->edge_count; i++) {
        int32_t e = seams->edges[i].edge;
        if (seams->marks[e] == 1)
            seams->marks[e] = can_open(seams, e) ? 2 : 3;
    }
    for (int32_t i = 0; any && i < seams->edge_count; i++) {
        int32_t e = seams->edges[i].edge;
        if (seams->marks[e] < 2)
            continue;
        count_mark(seams, e, -1);
        count += seams->marks[e] == 2;
        seams->marks[e] = seams->marks[e] == 2;
    }
    return count;
}

/* ---- the energy of the separation ---- */

/* places: of vertices in the list, + 1; sums (count of the list) are 0 */
static void subtract_means(pel_seam_ends *ends, size_t begin, const int32_t *places, double (*sums)[4])
{
    for (size_t i = begin; i < ends->count; i++) {
        double *sum = sums[places[ends->list[i].parent] - 1];
        pel_vec3_add(sum, ends->list[i].gradient, sum);
        sum[3]++;
    }
    for (size_t i = begin; i < ends->count; i++) {
        const double *sum = sums[places[ends->list[i].parent] - 1];
        pel_vec3_along(ends->list[i].gradient, -1 / sum[3], sum, ends->list[i].gradient);
    }
}

pel_status pel_seam_ends_add(pel_seam_ends *ends, pel_seams *seams, int32_t first, const int32_t *parents,
                             pel_error *error)
{
    const pel_survey *s = &seams->survey;
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    const size_t begin = ends->count, most = 2 * (size_t)(mesh->vertex_count - first);
    int32_t *places = NULL;
    double(*sums)[4] = NULL;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(places, mesh->vertex_count), PEL_ROOM(sums, begin + most)) ||
        !pel_reserve((void **)&ends->list, &ends->room, begin + most, sizeof *ends->list)) {
        PEL_FREE_ALL(places, sums);
        return pel_fail_memory(error);
    }
    for (int32_t v = first; v < mesh->vertex_count; v++) {
        const int32_t both[2] = {parents[v], v};
        for (int i = 0; i < 2; i++)
            if (places[both[i]] == 0) {
                ends->list[ends->count] = (pel_seam_end){.body = s->body, .vertex = both[i], .parent = parents[v]};
                places[both[i]] = (int32_t)++ends->count;
            }
    }
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        double gradient[3][3] = {{0}};
        if (places[v[0]] == 0 && places[v[1]] == 0 && places[v[2]] == 0)
            continue;
        pel_survey_triangle(s, t, gradient);
        for (int i = 0; i < 3; i++)
            if (places[v[i]] > 0) {
                double *sum = ends->list[places[v[i]] - 1].gradient;
                pel_vec3_add(sum, gradient[i], sum);
            }
    }
    subtract_means(ends, begin, places, sums);
    PEL_FREE_ALL(places, sums);
    return PEL_OK;
}

double pel_seam_ends_work(const pel_seam_ends *ends, const pel_sim *sim)
{
    double work = 0;
    for (size_t i = 0; i < ends->count; i++) {
        const pel_seam_end *end = &ends->list[i];
        const int32_t *index = sim->model->bodies[end->body].model_index;
        double x[3], parent[3];
        pel_vertex_position(sim->state->position, index[end->vertex], x);
        pel_vertex_position(sim->state->position, index[end->parent], parent);
        pel_vec3_subtract(x, parent, x);
        work -= 0.5 * pel_vec3_dot(end->gradient, x);
    }
    return work;
}
