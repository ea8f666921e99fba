/* The lists of elements. They are not the blocks of `batch`, which forces and sweeps share, for three reasons: the rows
   at a node are added by rising element, and colors give another order, so other bits of every gradient, energy and
   matrix; numbers of blocks are pel_real, and these are double in both precisions; blocks leave out triangles without
   area, and have neither mid-edge bending nor inertia. */
#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "force/pressure.h"
#include "force/tangent_body.h"

#include <string.h>

/* ---- room ---- */

/* fibres that give forces */
static bool has_force(const pel_shell_region *region)
{
    return pel_shell_region_is_elastic(region) || region->def.mode == PEL_FIBRE_NORMAL;
}

static bool has_springs(const pel_model *model, int32_t body)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    return model->bodies[body].plain_spring != 0; /* the same on a refined surface */
}

static bool depends_on_volume(const pel_shell *shell)
{
    return shell->pressure.kind == PEL_PRESSURE_GAS || shell->pressure.kind == PEL_PRESSURE_VOLUME;
}

/* most edges that a surface of a shell can have */
static int32_t edge_limit(const pel_shell *shell)
{
    return shell->bending->turns_edges ? 3 * shell->triangle_limit : 0;
}

static size_t fibre_limit(const pel_shell *shell)
{
    size_t count = 0;
    for (int32_t r = 0; r < shell->region_count; r++)
        if (has_force(&shell->regions[r]))
            count += (size_t)shell->regions[r].fibre_limit;
    return count;
}

/* tetrahedra that are elements by themselves */
static int32_t linear_tetras(const pel_shell *shell)
{
    return shell->stars == NULL ? shell->tetrahedron_count : 0;
}

static bool allocate_shell(pel_tangent *tangent, pel_tangent_shell *own)
{
    const pel_shell *shell = own->shell;
    int32_t first = tangent->model->bodies[own->body].slice_begin * PEL_WIDTH, triangles = shell->triangle_limit;
    int32_t places = pel_body_place_end(tangent->model, own->body) - first;
    size_t fibres = fibre_limit(shell);
    const int32_t tetras = linear_tetras(shell);
    bool is_midedge = shell->bending->turns_edges,
         has_normals = shell->pressure.kind != PEL_PRESSURE_NONE && shell->pressure.form == PEL_PRESSURE_VERTEX_NORMAL;
    double **normal = own->normal_pressure;
    bool all = PEL_ALLOCATE_ALL(
        PEL_ROOM_IF(fibres > 0, own->fibre_begin, (size_t)triangles + 2), PEL_ROOM_IF(fibres > 0, own->fibres, fibres),
        PEL_ROOM(own->rests, triangles), PEL_ROOM_IF(is_midedge, own->edges, triangles),
        PEL_ROOM_IF(is_midedge, own->midedges, triangles),
        PEL_ROOM_IF(shell->bending->is_angle, own->hinges, shell->hinge_limit),
        PEL_ROOM_IF(tetras > 0, own->tetras, tetras), PEL_ROOM_IF(tetras > 0, own->tetra_scales, tetras),
        PEL_ROOM_IF(has_normals, normal[0], places), PEL_ROOM_IF(has_normals, normal[1], places),
        PEL_ROOM_IF(has_normals, normal[2], places), PEL_ROOM_IF(has_normals, normal[3], places));
    if (!all || !depends_on_volume(shell))
        return all;
    own->rank_one = &tangent->rank_ones[tangent->pattern.rank_one_count++];
    own->rank_one->first_vertex = first;
    own->rank_one->vertex_count = places;
    own->rank_one->gradient = pel_allocate(3 * (size_t)places, sizeof(double));
    return own->rank_one->gradient != NULL;
}

/* upper bounds over all elements */
typedef struct pel_tangent_room {
    size_t elements, nodes, rows, edges, springs, chunks, stresses;
} pel_tangent_room;

static void add_room(pel_tangent_room *room, size_t elements, size_t vertices, size_t edges)
{
    room->elements += elements;
    room->nodes += elements * (vertices + edges);
    room->rows += elements * (3 * vertices + edges);
    room->chunks += elements / PEL_TANGENT_CHUNK + 1;
}

static pel_tangent_room room_of(const pel_tangent *tangent)
{
    const pel_model *model = tangent->model;
    pel_tangent_room room = {0};
    for (int32_t i = 0; i < tangent->shell_count; i++) {
        const pel_shell *shell = tangent->shells[i].shell;
        add_room(&room, (size_t)shell->triangle_limit, 3, shell->bending->turns_edges ? 3 : 0);
        if (shell->bending->has_hinges)
            add_room(&room, (size_t)shell->hinge_limit, 4, 0);
        add_room(&room, (size_t)linear_tetras(shell), 4, 0);
        if (shell->stars != NULL) {
            const size_t stars = (size_t)shell->stars->count, nodes = (size_t)shell->stars->begin[stars];
            room.elements += stars;
            room.nodes += nodes;
            room.rows += 3 * nodes;
            room.chunks += stars / PEL_TANGENT_CHUNK + PEL_STAR_NODES;
        }
        room.edges += (size_t)edge_limit(shell);
        room.stresses += (size_t)shell->triangle_limit *
                         (shell->bending->turns_edges ? PEL_MEMBRANE_STRAINS + 3 : PEL_MEMBRANE_STRAINS);
        room.stresses += (size_t)shell->hinge_limit * PEL_HINGE_STRAINS + fibre_limit(shell);
    }
    /* a spring is stored at both of its ends */
    for (int32_t b = 0; b < model->body_count; b++)
        if (has_springs(model, b)) {
            size_t slots = (size_t)(model->slot_begin[pel_body_place_end(model, b) / PEL_WIDTH] -
                                    model->slot_begin[model->bodies[b].slice_begin]);
            room.springs += slots * PEL_WIDTH / 2 + 1;
        }
    add_room(&room, room.springs, 2, 0);
    room.stresses += room.springs * PEL_LINE_STRAINS;
    add_room(&room, (size_t)model->vertex_count, 1, 0);
    return room;
}

static bool allocate_lists(pel_tangent *tangent)
{
    const pel_tangent_room room = room_of(tangent);
    tangent->pattern.edge_limit = (int32_t)room.edges;
    tangent->pattern.unknown_limit = 3 * tangent->model->vertex_count + (int32_t)room.edges;
    tangent->pattern.stress_limit = (int32_t)room.stresses;
    int32_t vertices = tangent->model->vertex_count;
    return PEL_ALLOCATE_ALL(PEL_ROOM(tangent->edges, room.edges), PEL_ROOM(tangent->half_angles, room.edges),
                            PEL_ROOM(tangent->first_half_angles, room.edges), PEL_ROOM(tangent->settle[0], room.edges),
                            PEL_ROOM(tangent->settle[1], room.edges), PEL_ROOM(tangent->settle[2], room.edges),
                            PEL_ROOM(tangent->settle[3], room.edges), PEL_ROOM(tangent->springs, room.springs),
                            PEL_ROOM(tangent->points, vertices), PEL_ROOM(tangent->node_begin, room.elements + 1),
                            PEL_ROOM(tangent->nodes, room.nodes), PEL_ROOM(tangent->element_kind, room.elements),
                            PEL_ROOM(tangent->rows, room.rows),
                            PEL_ROOM(tangent->gather_begin, (size_t)vertices + room.edges + 2),
                            PEL_ROOM(tangent->gather, room.nodes), PEL_ROOM(tangent->energies, room.chunks));
}

/* ---- shells ---- */

/* Lists by owner: counts stand two places after their owner's number, sums make them begins one place after; filling
   moves each up to the start of the next owner, so that begin[owner] .. begin[owner + 1] is right at the end. */
static void sum_counts(int32_t *begin, int32_t owner_count)
{
    for (int32_t i = 0; i < owner_count; i++)
        begin[i + 2] += begin[i + 1];
}

static void fill_fibres(pel_tangent_shell *own)
{
    const pel_shell *shell = own->shell;
    if (own->fibre_begin == NULL)
        return;
    memset(own->fibre_begin, 0, ((size_t)shell->triangle_count + 2) * sizeof *own->fibre_begin);
    for (int32_t r = 0; r < shell->region_count; r++)
        for (int32_t i = 0; has_force(&shell->regions[r]) && i < shell->regions[r].fibre_count; i++)
            own->fibre_begin[pel_shell_fibre_triangle(&shell->regions[r], i) + 2]++;
    sum_counts(own->fibre_begin, shell->triangle_count);
    for (int32_t r = 0; r < shell->region_count; r++)
        for (int32_t i = 0; has_force(&shell->regions[r]) && i < shell->regions[r].fibre_count; i++) {
            const pel_shell_fibre fibre = pel_shell_fibre_of(shell, &shell->regions[r], i);
            own->fibres[own->fibre_begin[fibre.triangle + 1]++] =
                (pel_tangent_fibre){.region = r,
                                    .stiffness = shell->regions[r].def.stiffness * fibre.weight,
                                    .direction = {fibre.direction[0], fibre.direction[1]}};
        }
}

/* the side of a triangle that begins at a vertex */
static int side_from(const int32_t corners[3], int32_t vertex)
{
    return corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
}

static void add_edge(pel_tangent *tangent, const pel_tangent_edge *edge)
{
    tangent->edges[tangent->pattern.edge_count++] = *edge;
}

static void fill_edges(pel_tangent *tangent, pel_tangent_shell *own)
{
    const pel_shell *shell = own->shell;
    enum { NONE = INT32_MAX };
    for (int32_t t = 0; t < shell->triangle_count; t++)
        for (int k = 0; k < 3; k++)
            own->edges[t][k] = NONE;
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
        pel_tangent_edge edge = {.body = own->body, .rest_angle = pel_shell_rest_angle(shell, i)};
        memcpy(edge.vertices, hinge.vertices, sizeof edge.vertices);
        memcpy(edge.triangles, hinge.triangles, sizeof edge.triangles);
        for (int side = 0; side < 2; side++) {
            int32_t t = hinge.triangles[side], e = tangent->pattern.edge_count;
            own->edges[t][side_from(shell->corners[t], hinge.vertices[side])] = side == 0 ? e : ~e;
        }
        add_edge(tangent, &edge);
    }
    for (int32_t t = 0; t < shell->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            const int32_t *v = shell->corners[t];
            if (own->edges[t][k] != NONE)
                continue;
            const pel_tangent_edge edge = {
                .vertices = {v[k], v[(k + 1) % 3], v[(k + 2) % 3], -1}, .triangles = {t, -1}, .body = own->body};
            own->edges[t][k] = tangent->pattern.edge_count;
            add_edge(tangent, &edge);
        }
}

static void fill_shell(pel_tangent *tangent, pel_tangent_shell *own)
{
    const pel_shell *shell = own->shell;
    fill_fibres(own);
    for (int32_t t = 0; t < shell->triangle_count; t++)
        own->rests[t] = pel_shell_rest(shell, t);
    for (int32_t t = 0; t < linear_tetras(shell); t++)
        own->tetra_scales[t] = pel_filled_rest(shell, tangent->model->rest, t, &own->tetras[t]);
    for (int32_t i = 0; own->hinges != NULL && i < shell->hinge_count; i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
        own->hinges[i] = pel_shell_angle(shell, tangent->model->rest, &hinge);
    }
    if (!shell->bending->turns_edges)
        return;
    fill_edges(tangent, own);
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        const pel_plate plate = pel_shell_plate(shell, t);
        own->midedges[t] = pel_midedge_setup(&own->rests[t], shell->parts[t].stiffness, &plate);
    }
}

/* ---- springs and points ---- */

static void fill_slice(pel_tangent *tangent, int32_t body, int32_t slice)
{
    const pel_model *model = tangent->model;
    double uniform = model->bodies[body].uniform_spring;
    for (int32_t slot = model->slot_begin[slice]; slot < model->slot_end[slice]; slot++)
        for (int32_t lane = 0; lane < PEL_WIDTH; lane++) {
            int32_t v = slice * PEL_WIDTH + lane, other = model->neighbours[slot][lane];
            if (other <= v) /* padding, or the spring of the other end */
                continue;
            double stiffness = uniform >= 0 ? uniform : (double)model->stiffnesses[slot][lane];
            tangent->springs[tangent->spring_count++] =
                (pel_tangent_spring){{v, other}, body, stiffness, (double)model->rest_lengths[slot][lane]};
        }
}

static void fill_springs(pel_tangent *tangent)
{
    const pel_model *model = tangent->model;
    tangent->spring_count = tangent->point_count = 0;
    for (int32_t b = 0; b < model->body_count; b++)
        for (int32_t slice = model->bodies[b].slice_begin; has_springs(model, b) && slice < model->bodies[b].slice_end;
             slice++)
            fill_slice(tangent, b, slice);
    for (int32_t v = 0; v < model->vertex_count; v++)
        if (model->mass[v] > 0)
            tangent->points[tangent->point_count++] = v;
}

/* ---- parts ---- */

static pel_tangent_part *add_part(pel_tangent *tangent, pel_part_kind kind, int32_t shell, int32_t count, int vertices,
                                  int edges, int strains)
{
    const pel_tangent_part *last = tangent->part_count > 0 ? &tangent->parts[tangent->part_count - 1] : NULL;
    pel_tangent_part *part = &tangent->parts[tangent->part_count++];
    *part = (pel_tangent_part){.kind = kind,
                               .shell = shell,
                               .count = count,
                               .nodes = vertices + edges,
                               .unknowns = 3 * vertices + edges,
                               .strains = strains};
    if (last != NULL) {
        part->first = last->first + last->count;
        part->first_row = last->first_row + (size_t)last->count * (size_t)last->unknowns;
    }
    part->first_stress = tangent->pattern.stress_count;
    part->first_chunk = tangent->chunk_count;
    tangent->chunk_count += pel_tangent_chunk_count(count);
    tangent->pattern.stress_count += count * strains;
    tangent->pattern.element_count = part->first + count;
    return part;
}

/* a part for each number of nodes */
static void add_star_parts(pel_tangent *tangent, int32_t shell, const pel_stars *stars)
{
    for (int32_t first = 0, end; first < stars->count; first = end) {
        const int32_t nodes = stars->begin[first + 1] - stars->begin[first];
        for (end = first + 1; end < stars->count && stars->begin[end + 1] - stars->begin[end] == nodes;)
            end++;
        add_part(tangent, PEL_TANGENT_PART_STARS, shell, end - first, nodes, 0, 0)->first_star = first;
    }
}

static void fill_parts(pel_tangent *tangent)
{
    tangent->part_count = tangent->chunk_count = tangent->pattern.stress_count = tangent->pattern.element_count = 0;
    for (int32_t i = 0; i < tangent->shell_count; i++) {
        const pel_tangent_shell *own = &tangent->shells[i];
        const pel_shell *shell = own->shell;
        int edges = shell->bending->turns_edges ? 3 : 0;
        add_part(tangent, PEL_TANGENT_PART_TRIANGLES, i, shell->triangle_count, 3, edges, PEL_MEMBRANE_STRAINS + edges);
        if (own->fibre_begin != NULL)
            tangent->pattern.stress_count += own->fibre_begin[shell->triangle_count];
        if (shell->bending->has_hinges)
            add_part(tangent, PEL_TANGENT_PART_HINGES, i, shell->hinge_count, 4, 0, PEL_HINGE_STRAINS);
        if (linear_tetras(shell) > 0)
            add_part(tangent, PEL_TANGENT_PART_TETRAHEDRA, i, shell->tetrahedron_count, 4, 0, 0);
        if (shell->stars != NULL)
            add_star_parts(tangent, i, shell->stars);
    }
    add_part(tangent, PEL_TANGENT_PART_SPRINGS, -1, tangent->spring_count, 2, 0, PEL_LINE_STRAINS);
    add_part(tangent, PEL_TANGENT_PART_POINTS, -1, tangent->point_count, 1, 0, 0);
}

static void fill_nodes_of(pel_tangent *tangent, const pel_tangent_part *part, int32_t i, int32_t *nodes)
{
    PEL_ASSERT_INDEX(i, part->count);
    const pel_tangent_shell *own = part->shell >= 0 ? &tangent->shells[part->shell] : NULL;
    switch (part->kind) {
    case PEL_TANGENT_PART_TRIANGLES:
        memcpy(nodes, own->shell->corners[i], 3 * sizeof *nodes);
        for (int k = 3; k < part->nodes; k++) {
            double sign;
            nodes[k] = tangent->pattern.vertex_count + pel_tangent_edge_of(own->edges[i][k - 3], &sign);
        }
        return;
    case PEL_TANGENT_PART_TETRAHEDRA:
        memcpy(nodes, own->shell->tetrahedra[i], 4 * sizeof *nodes);
        return;
    case PEL_TANGENT_PART_STARS:
        memcpy(nodes, own->shell->stars->nodes + own->shell->stars->begin[part->first_star + i],
               (size_t)part->nodes * sizeof *nodes);
        return;
    case PEL_TANGENT_PART_HINGES:
        memcpy(nodes, pel_shell_hinge_of(own->shell, i).vertices, 4 * sizeof *nodes);
        return;
    case PEL_TANGENT_PART_SPRINGS:
        memcpy(nodes, tangent->springs[i].vertices, 2 * sizeof *nodes);
        return;
    case PEL_TANGENT_PART_POINTS:
        nodes[0] = tangent->points[i];
    }
}

static void fill_nodes(pel_tangent *tangent)
{
    int32_t count = 0;
    for (int32_t p = 0; p < tangent->part_count; p++) {
        const pel_tangent_part *part = &tangent->parts[p];
        for (int32_t i = 0; i < part->count; i++) {
            tangent->node_begin[part->first + i] = count;
            tangent->element_kind[part->first + i] = (uint8_t)(2 * part->kind + (part->nodes > 3));
            fill_nodes_of(tangent, part, i, tangent->nodes + count);
            count += part->nodes;
        }
    }
    tangent->node_begin[tangent->pattern.element_count] = count;
}

/* counts the rows of each node, or lists them by rising element */
static void visit_rows(pel_tangent *tangent, bool list)
{
    int32_t vertices = tangent->pattern.vertex_count;
    for (int32_t p = 0; p < tangent->part_count; p++) {
        const pel_tangent_part *part = &tangent->parts[p];
        size_t row = part->first_row;
        for (int32_t i = 0; i < part->count; i++)
            for (int k = 0; k < part->nodes; k++) {
                int32_t node = tangent->nodes[tangent->node_begin[part->first + i] + k];
                if (list)
                    tangent->gather[tangent->gather_begin[node + 1]++] = (int32_t)row;
                else
                    tangent->gather_begin[node + 2]++;
                row += node < vertices ? 3 : 1;
            }
    }
}

void pel_tangent_rebuild(pel_tangent *tangent)
{
    tangent->pattern.edge_count = 0;
    tangent->pattern.vertex_count = tangent->model->vertex_count;
    for (int32_t i = 0; i < tangent->shell_count; i++)
        fill_shell(tangent, &tangent->shells[i]);
    fill_springs(tangent);
    fill_parts(tangent);
    fill_nodes(tangent);
    int32_t node_count = tangent->pattern.vertex_count + tangent->pattern.edge_count;
    tangent->pattern.unknown_count = 3 * tangent->pattern.vertex_count + tangent->pattern.edge_count;
    memset(tangent->gather_begin, 0, ((size_t)node_count + 2) * sizeof *tangent->gather_begin);
    visit_rows(tangent, false);
    sum_counts(tangent->gather_begin, node_count);
    visit_rows(tangent, true);
}

/* ---- creation ---- */

static pel_status find_shells(pel_tangent *tangent, pel_error *error)
{
    const pel_model *model = tangent->model;
    size_t bodies = (size_t)model->body_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(tangent->shells, bodies), PEL_ROOM(tangent->rank_ones, bodies),
                          PEL_ROOM(tangent->parts, (3 + PEL_STAR_NODES) * bodies + 2)))
        return pel_fail_memory(error);
    for (int32_t b = 0; b < model->body_count; b++) {
        if (model->bodies[b].shell == NULL)
            continue;
        pel_status status = pel_shell_check_bending(model->bodies[b].shell, b, error);
        if (status != PEL_OK)
            return status;
        pel_tangent_shell *own = &tangent->shells[tangent->shell_count++];
        own->shell = model->bodies[b].shell;
        own->body = b;
        if (!allocate_shell(tangent, own))
            return pel_fail_memory(error);
    }
    return PEL_OK;
}

pel_status pel_tangent_create(const pel_model *model, pel_tangent **made, pel_error *error)
{
    *made = NULL;
    pel_tangent *tangent = pel_allocate(1, sizeof *tangent);
    if (tangent == NULL)
        return pel_fail_memory(error);
    tangent->model = model;
    pel_status status = find_shells(tangent, error);
    if (status == PEL_OK && !allocate_lists(tangent))
        status = pel_fail_memory(error);
    if (status != PEL_OK) {
        pel_tangent_destroy(tangent);
        return status;
    }
    tangent->pattern.node_begin = tangent->node_begin;
    tangent->pattern.nodes = tangent->nodes;
    tangent->pattern.element_kind = tangent->element_kind;
    tangent->pattern.rank_ones = tangent->rank_ones;
    pel_tangent_rebuild(tangent);
    *made = tangent;
    return PEL_OK;
}

void pel_tangent_destroy(pel_tangent *tangent)
{
    if (tangent == NULL)
        return;
    for (int32_t i = 0; i < tangent->shell_count; i++) {
        pel_tangent_shell *own = &tangent->shells[i];
        PEL_FREE_ALL(own->rests, own->fibre_begin, own->fibres, own->edges, own->midedges, own->hinges, own->tetras,
                     own->tetra_scales, own->normal_pressure[0], own->normal_pressure[1], own->normal_pressure[2],
                     own->normal_pressure[3], own->rank_one != NULL ? own->rank_one->gradient : NULL);
    }
    PEL_FREE_ALL(tangent->parts, tangent->shells, tangent->rank_ones, tangent->edges, tangent->springs, tangent->points,
                 tangent->node_begin, tangent->nodes, tangent->rows, tangent->gather_begin, tangent->gather,
                 tangent->half_angles, tangent->settle[0], tangent->settle[1], tangent->settle[2], tangent->settle[3],
                 tangent->energies, tangent->element_kind, tangent->first_half_angles);
    pel_free(tangent);
}

const pel_tangent_pattern *pel_tangent_pattern_of(const pel_tangent *tangent)
{
    return &tangent->pattern;
}

const pel_tangent_edge *pel_tangent_edges_of(const pel_tangent *tangent)
{
    return tangent->edges;
}
