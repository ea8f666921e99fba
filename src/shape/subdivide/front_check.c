/* The whole of a front checked from scratch: its rules by plain iteration over all nodes, its lists by counting. */
#include "subdivide/front.h"

#include "base/memory.h"
#include "base/room.h"

#include <string.h>

typedef struct check {
    const pel_front *front;
    const pel_lod_forest *forest;
    uint8_t *red;         /* (node_count) */
    uint8_t *vertex_used; /* (vertices of the finest level) */
    int32_t *edge_uses;   /* (edges of all levels and bisectors) triangles of the surface next to it */
} check;

static bool is_red(const check *c, int32_t level, int32_t t)
{
    return t >= 0 && level < c->forest->depth && c->red[c->front->node_begin[level] + t] != 0;
}

static int32_t neighbour(const check *c, int32_t level, int32_t t, int k)
{
    int32_t twin = c->forest->levels[level]->twin[3 * t + k];
    return twin < 0 ? -1 : twin / 3;
}

static int32_t red_neighbour_count(const check *c, int32_t level, int32_t t)
{
    int32_t count = 0;
    for (int k = 0; k < 3; k++)
        count += is_red(c, level, neighbour(c, level, t, k));
    return count;
}

static bool add_red(check *c, int32_t level, int32_t t)
{
    uint8_t *red = &c->red[c->front->node_begin[level] + t];
    bool added = *red == 0;
    *red = 1;
    return added;
}

static bool apply_rules(check *c, int32_t level, int32_t t)
{
    bool changed = false;
    if (!is_red(c, level, t)) {
        if (red_neighbour_count(c, level, t) < 2)
            return false;
        changed = add_red(c, level, t);
    }
    if (level == 0)
        return changed;
    changed |= add_red(c, level - 1, pel_lod_parent(t));
    for (int k = 0; k < 3; k++)
        if (neighbour(c, level, t, k) >= 0)
            changed |= add_red(c, level - 1, pel_lod_parent(neighbour(c, level, t, k)));
    return changed;
}

/* the least set that holds the marks and obeys the rules, and the red nodes of the front are just these */
static bool check_closure(check *c)
{
    const pel_front *front = c->front;
    int32_t red_count = 0, marked_count = 0;
    for (int32_t n = 0; n < front->red_limit; n++) {
        c->red[n] = pel_front_is_marked(front, n);
        marked_count += c->red[n];
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (int32_t level = c->forest->depth - 1; level >= 0; level--)
            for (int32_t t = 0; t < c->forest->levels[level]->triangle_count; t++)
                changed |= apply_rules(c, level, t);
    }
    for (int32_t n = 0; n < front->node_count; n++) {
        red_count += c->red[n];
        if ((front->shapes[n] == PEL_FRONT_RED) != (c->red[n] != 0))
            return false;
    }
    return red_count == front->red_count && marked_count == front->marked_count;
}

static bool check_node(const check *c, int32_t level, int32_t t)
{
    const pel_front *front = c->front;
    int32_t node = front->node_begin[level] + t, split = -1, split_count = 0;
    uint8_t shape = front->shapes[node];
    for (int k = 0; k < 3 && level < c->forest->depth; k++) {
        int32_t edge = pel_lod_midpoint(c->forest->levels[level], 3 * t + k) - c->forest->levels[0]->vertex_count;
        int32_t count = is_red(c, level, t) + is_red(c, level, neighbour(c, level, t, k));
        if (front->red_counts[edge] != count)
            return false;
        if (count > 0) {
            split = k;
            split_count++;
        }
    }
    int32_t expected = PEL_FRONT_WHOLE;
    if (is_red(c, level, t))
        expected = PEL_FRONT_RED;
    else if (level > 0 && !is_red(c, level - 1, pel_lod_parent(t)))
        return shape == PEL_FRONT_ABSENT && front->place_of_node[node][0] < 0 && front->place_of_node[node][1] < 0;
    else if (split >= 0)
        expected = PEL_FRONT_BISECTED + split;
    bool leaf = expected != PEL_FRONT_RED;
    return shape == expected && (!leaf || split_count <= 1) && (front->place_of_node[node][0] >= 0) == leaf &&
           (front->place_of_node[node][1] >= 0) == pel_front_is_green(shape);
}

static bool check_nodes(const check *c)
{
    for (int32_t level = 0; level <= c->forest->depth; level++)
        for (int32_t t = 0; t < c->forest->levels[level]->triangle_count; t++)
            if (!check_node(c, level, t))
                return false;
    return true;
}

/* counts the uses of vertices and edges by the triangles, and the area: whole levels of 1 / 4 each */
static bool check_triangles(check *c)
{
    const pel_front *front = c->front;
    double area = 0;
    for (int32_t i = 0; i < front->triangle_count; i++) {
        const pel_front_triangle *triangle = &front->triangles[i];
        if (front->place_of_node[triangle->node][triangle->half] != i)
            return false;
        int32_t level = pel_front_level(front, triangle->node);
        area += (pel_front_is_green(front->shapes[triangle->node]) ? 0.5 : 1.0) / (double)(1 << (2 * level));
        for (int k = 0; k < 3; k++)
            c->vertex_used[triangle->vertices[k]] = 1;
    }
    return area == c->forest->levels[0]->triangle_count && front->triangle_count == front->next_triangle_count;
}

static bool has_half_edge(const pel_front_triangle *triangle, int32_t a, int32_t b)
{
    for (int k = 0; k < 3; k++)
        if (triangle->vertices[k] == a && triangle->vertices[(k + 1) % 3] == b)
            return true;
    return false;
}

/* the fan of a vertex is one closed or open ring of triangles, all in the list */
static bool check_fan(check *c, int32_t v, pel_front_corner *fan)
{
    const pel_front *front = c->front;
    int32_t count = pel_front_fan(front, v, fan);
    for (int32_t i = 0; i < count; i++) {
        int32_t ends[2], place = front->place_of_node[fan[i].node][fan[i].half];
        if (place < 0 || !has_half_edge(&front->triangles[place], v, fan[i].next) ||
            !has_half_edge(&front->triangles[place], fan[i].next, fan[i].previous))
            return false;
        if (front->place_of_edge[fan[i].next_edge] < 0 || front->place_of_edge[fan[i].previous_edge] < 0)
            return false;
        pel_front_edge_ends(front, fan[i].next_edge, ends);
        if (!((ends[0] == v && ends[1] == fan[i].next) || (ends[1] == v && ends[0] == fan[i].next)))
            return false;
        if (i > 0 && (fan[i - 1].previous != fan[i].next || fan[i - 1].previous_edge != fan[i].next_edge))
            return false;
        c->edge_uses[fan[i].next_edge]++;
    }
    const pel_topology *own = c->forest->levels[pel_lod_forest_vertex_level(c->forest, v)];
    int32_t corner = own->corner_of_vertex[v];
    if (corner < 0)
        return count == 0;
    bool boundary = own->twin[corner] < 0;
    return count > 0 && boundary == (fan[count - 1].previous != fan[0].next);
}

static bool check_vertices(check *c)
{
    const pel_front *front = c->front;
    int32_t fine_count = c->forest->levels[c->forest->depth]->vertex_count, count = 0, corner_count = 0, longest = 0;
    const pel_topology *base = c->forest->levels[0];
    int32_t *valence = pel_allocate((size_t)base->vertex_count, sizeof *valence);
    for (int32_t t = 0; valence != NULL && t < base->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            int32_t own = ++valence[base->triangles[t][k]];
            longest = own > longest ? own : longest;
        }
    pel_front_corner *fan = pel_allocate(2 * (size_t)longest + 12, sizeof *fan);
    bool has_room = fan != NULL && valence != NULL, good = true;
    pel_free(valence);
    for (int32_t v = 0; has_room && good && v < fine_count; v++) {
        bool active = pel_front_has_vertex(front, v);
        bool used = c->vertex_used[v] != 0 || (v < base->vertex_count && base->corner_of_vertex[v] < 0);
        good = active == used && (!active || front->vertices[front->index_in_front[v]] == v) &&
               (!active || check_fan(c, v, fan));
        count += active;
        corner_count += good && active ? pel_front_fan(front, v, fan) : 0;
    }
    pel_free(fan);
    return !has_room || (good && count == front->vertex_count && corner_count == 3 * front->triangle_count);
}

/* each edge is used once by each of its triangles, and the Euler number equals the base's */
static bool check_edges(const check *c)
{
    const pel_front *front = c->front;
    const pel_topology *base = c->forest->levels[0];
    int32_t count = 0, total = front->bisector_begin + front->node_count;
    for (int32_t e = 0; e < total; e++) {
        bool active = front->place_of_edge[e] >= 0;
        if (active && front->edges[front->place_of_edge[e]] != e)
            return false;
        /* an edge is the next one of one corner of each of its triangles */
        if ((c->edge_uses[e] > 0) != active || c->edge_uses[e] > 2)
            return false;
        count += active;
    }
    return count == front->edge_count && front->vertex_count - front->edge_count + front->triangle_count ==
                                             base->vertex_count - base->edge_count + base->triangle_count;
}

bool pel_front_is_valid(const pel_front *front)
{
    const pel_lod_forest *forest = front->forest;
    check c = {.front = front, .forest = forest};
    bool has_room = PEL_ALLOCATE_ALL(PEL_ROOM(c.red, front->node_count),
                                     PEL_ROOM(c.vertex_used, forest->levels[forest->depth]->vertex_count),
                                     PEL_ROOM(c.edge_uses, (size_t)front->bisector_begin + (size_t)front->node_count));
    bool good = !has_room ||
                (check_closure(&c) && check_nodes(&c) && check_triangles(&c) && check_vertices(&c) && check_edges(&c));
    PEL_FREE_ALL(c.red, c.vertex_used, c.edge_uses);
    return good;
}
