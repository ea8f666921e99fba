/* Each triangle of the bodies' meshes is the root of a tree whose nodes have four children: i at corner i, and 3 in the
   middle, whose corner i lies on the edge across from corner i. A frame is made of nodes of these trees and of halves
   of nodes, cut from a corner to the middle of the edge across: a median. The common mesh is the overlay of all frames:

       a node is split if any frame is finer there, and has the medians of all frames; the median from corner i of a
       node that is split is a median of its child i and of its middle child, both from their corner i; finally there
       are nodes with 0 to 3 medians, which meet in the node's centre.

           c              The children of a node with the median from a:
          / \             the median of child a and that of the middle child make it up.
         y---x
        / \ / \           x, y, z are the middles of bc, ca, ab; child 3 is x y z.
       a---z---b

   A frame is conforming, and so is the overlay of frames: a point on an edge belongs to both sides. Every triangle of
   the common mesh lies in one triangle of each frame, so linear interpolation there gives the frame's own surface.

   Points of a node are three whole numbers of sum UNIT, their shares of the corners. UNIT holds the middles and centres
   of all depths, so nothing is rounded. Points of the whole mesh are the shares of at most three vertices of the mesh.
 */
#include "results/common_mesh.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"

#include <math.h>
#include <string.h>

enum { UNIT = 3 << 16, DEPTH_LIMIT = 14, BODY_LIMIT = 1 << 20, NO_NODE = -1 };

/* up to three vertices of the meshes by number, and their shares; a root is its three corners with shares 0 */
typedef struct key {
    int32_t vertices[3], shares[3];
} key;

/* numbers keys in the order of their coming */
typedef struct key_table {
    key *keys;
    size_t key_room;
    int32_t *slots; /* (slot_count) number plus 1, 0 = empty */
    int32_t slot_count, count;
} key_table;

typedef struct node {
    int32_t children; /* the first of four; NO_NODE */
    uint8_t medians;  /* bit i: from corner i */
} node;

/* a frame's part of a node, valid if stamp is that of the frame */
typedef struct frame_node {
    int32_t stamp;
    int32_t rows[3]; /* vertices of the frame at the corners */
    int32_t middle;  /* the vertex where its median ends; -1 = no median */
    int8_t apex;     /* where the median begins */
} frame_node;

/* a vertex of the common mesh: a point of a root */
typedef struct place {
    int32_t root, shares[3];
} place;

struct pel_common_mesh {
    const pel_frames *frames;
    int32_t body_count;
    int32_t *body_begin; /* (body_count + 1) number of a body's first mesh vertex */
    key_table roots;
    int32_t *root_nodes; /* (roots.count) */
    node *nodes;
    frame_node *frame_nodes; /* (node_count) */
    int32_t stamp;
    key_table vertices;
    place *places; /* (vertices.count) root -1: no triangle has it */
    size_t root_room, node_room, place_room;
    int32_t node_count;
    int32_t (*triangles)[3];
    size_t triangle_room;
    int32_t triangle_count;
};

/* the frame at hand */
typedef struct frame_view {
    const pel_mesh *mesh;
    const double *corners, *weights, *bodies; /* bodies nullable */
    const char *path;
} frame_view;

/* ---- numbering ---- */

static uint32_t hash_key(const key *k)
{
    uint32_t hash = 2166136261u;
    for (int i = 0; i < 3; i++)
        hash = ((hash ^ (uint32_t)k->vertices[i]) * 16777619u ^ (uint32_t)k->shares[i]) * 2654435769u;
    return hash ^ (hash >> 15);
}

/* the slot that holds the key or where it belongs */
static int32_t find_slot(const key_table *table, const key *k)
{
    uint32_t mask = (uint32_t)table->slot_count - 1, slot = hash_key(k) & mask;
    while (table->slots[slot] != 0 && memcmp(&table->keys[table->slots[slot] - 1], k, sizeof *k) != 0)
        slot = (slot + 1) & mask;
    return (int32_t)slot;
}

static int32_t find_key(const key_table *table, const key *k)
{
    return table->count > 0 ? table->slots[find_slot(table, k)] - 1 : -1;
}

static bool grow_slots(key_table *table)
{
    int32_t count = table->slot_count > 0 ? 2 * table->slot_count : 1024;
    int32_t *slots = pel_allocate((size_t)count, sizeof *slots);
    if (slots == NULL)
        return false;
    pel_free(table->slots);
    table->slots = slots;
    table->slot_count = count;
    for (int32_t n = 0; n < table->count; n++)
        slots[find_slot(table, &table->keys[n])] = n + 1;
    return true;
}

/* the key's number, new if necessary; -1 if out of memory */
static int32_t number_key(key_table *table, const key *k)
{
    if (2 * (table->count + 1) > table->slot_count && !grow_slots(table))
        return -1;
    int32_t slot = find_slot(table, k);
    if (table->slots[slot] != 0)
        return table->slots[slot] - 1;
    void *keys = table->keys;
    bool grown = pel_reserve(&keys, &table->key_room, (size_t)table->count + 1, sizeof *table->keys);
    table->keys = keys;
    if (!grown)
        return -1;
    table->keys[table->count++] = *k;
    return table->slots[slot] = table->count, table->count - 1;
}

static void free_table(key_table *table)
{
    pel_free(table->keys);
    pel_free(table->slots);
}

/* removes vertices without a share and sorts the others */
static key normal_key(const int32_t vertices[3], const int32_t shares[3])
{
    key k = {{-1, -1, -1}, {0, 0, 0}};
    int count = 0;
    for (int i = 0; i < 3; i++) {
        if (shares[i] == 0)
            continue;
        int at = count++;
        for (; at > 0 && k.vertices[at - 1] > vertices[i]; at--) {
            k.vertices[at] = k.vertices[at - 1];
            k.shares[at] = k.shares[at - 1];
        }
        k.vertices[at] = vertices[i];
        k.shares[at] = shares[i];
    }
    return k;
}

/* ---- reading a frame ---- */

bool pel_common_mesh_is_place(const char *field_name)
{
    return strcmp(field_name, "mesh_vertices") == 0 || strcmp(field_name, "mesh_weights") == 0;
}

static pel_status fail_frame(const frame_view *view, const char *what, pel_error *error)
{
    pel_fail(error, PEL_BAD_FORMAT, "%s", what);
    pel_fail_remedy(error, "convert the frames of a run one by one");
    pel_fail_place(error, view->path, 0, 0);
    return PEL_BAD_FORMAT;
}

static const double *find_values(const pel_mesh *mesh, const char *name, int32_t component_count)
{
    const pel_field *field = pel_mesh_field(mesh, name);
    return field != NULL && field->component_count == component_count ? field->values : NULL;
}

static pel_status open_frame(const pel_frames *frames, int32_t frame, pel_mesh **mesh, frame_view *view,
                             pel_error *error)
{
    PEL_ASSERT_INDEX(frame, frames->frame_count);
    pel_status status = pel_frames_read(frames, frame, mesh, error);
    if (status != PEL_OK)
        return status;
    *view = (frame_view){
        .mesh = *mesh,
        .corners = find_values(*mesh, "mesh_vertices", 3),
        .weights = find_values(*mesh, "mesh_weights", 3),
        .bodies = find_values(*mesh, "body", 1),
        .path = frames->paths[frame],
    };
    if (view->corners != NULL && view->weights != NULL)
        return PEL_OK;
    status = fail_frame(view,
                        "the triangles change and the frame has no fields mesh_vertices and mesh_weights, which tell "
                        "where its vertices lie in the mesh",
                        error);
    pel_mesh_destroy(*mesh);
    *mesh = NULL;
    return status;
}

pel_status pel_common_mesh_check(const pel_frames *frames, int32_t frame, pel_error *error)
{
    PEL_ASSERT_INDEX(frame, frames->frame_count);
    pel_mesh *mesh;
    frame_view view;
    pel_status status = open_frame(frames, frame, &mesh, &view, error);
    pel_mesh_destroy(mesh);
    return status;
}

/* where a row lies; false when the fields make no sense */
static bool read_key(const pel_common_mesh *common, const frame_view *view, int32_t row, key *k)
{
    int32_t vertices[3], shares[3], sum = 0;
    const double *corners = view->corners + 3 * (size_t)row, *weights = view->weights + 3 * (size_t)row;
    double body = view->bodies != NULL ? view->bodies[row] : 0;
    if (!(body >= 0 && body < common->body_count))
        return false;
    const int32_t *begin = &common->body_begin[(int32_t)body];
    for (int i = 0; i < 3; i++) {
        if (!(weights[i] >= 0 && weights[i] <= 1) || weights[i] * UNIT != floor(weights[i] * UNIT) ||
            !(corners[i] >= 0 && corners[i] < begin[1] - begin[0]))
            return false;
        vertices[i] = begin[0] + (int32_t)corners[i];
        shares[i] = (int32_t)(weights[i] * UNIT);
        sum += shares[i];
    }
    *k = normal_key(vertices, shares);
    return sum == UNIT;
}

/* the share of a vertex in a key */
static int32_t share_of(const key *k, int32_t vertex)
{
    for (int i = 0; i < 3; i++)
        if (k->vertices[i] == vertex && k->shares[i] > 0)
            return k->shares[i];
    return 0;
}

/* the vertices that three keys name together; false when these are not three */
static bool join_vertices(const key keys[3], int32_t vertices[3])
{
    int count = 0;
    for (int i = 0; i < 9; i++) {
        int32_t v = keys[i / 3].vertices[i % 3];
        bool known = keys[i / 3].shares[i % 3] == 0;
        for (int j = 0; j < count; j++)
            known = known || vertices[j] == v;
        if (known)
            continue;
        if (count == 3)
            return false;
        vertices[count++] = v;
    }
    return count == 3;
}

static int64_t determinant(const int32_t m[3][3])
{
    int64_t sum = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        sum += (int64_t)m[0][i] * ((int64_t)m[1][j] * m[2][k] - (int64_t)m[1][k] * m[2][j]);
    }
    return sum;
}

/* the root that a triangle lies in, its corners oriented like the triangle and the least first, and the triangle's
   points in it; false if there is none */
static bool find_root(const key keys[3], key *root, int32_t points[3][3])
{
    int32_t vertices[3];
    if (!join_vertices(keys, vertices))
        return false;
    for (int i = 0; i < 9; i++)
        points[i / 3][i % 3] = share_of(&keys[i / 3], vertices[i % 3]);
    int64_t orientation = determinant((const int32_t(*)[3])points);
    int least = 0;
    for (int i = 1; i < 3; i++)
        least = vertices[i] < vertices[least] ? i : least;
    int step = orientation > 0 ? 1 : 2;
    const int order[3] = {least, (least + step) % 3, (least + 2 * step) % 3};
    *root = (key){{0, 0, 0}, {0, 0, 0}};
    for (int i = 0; i < 3; i++) {
        root->vertices[i] = vertices[order[i]];
        for (int p = 0; p < 3; p++)
            points[p][i] = share_of(&keys[p], root->vertices[i]);
    }
    return orientation != 0;
}

/* ---- descending ---- */

/* the child that a point is in; ties go to the corners */
static int choose_child(const int64_t shares[3])
{
    int64_t sum = shares[0] + shares[1] + shares[2];
    for (int i = 0; i < 3; i++)
        if (2 * shares[i] >= sum)
            return i;
    return 3;
}

/* the same point in the shares of a child */
static void enter_child(int child, int32_t shares[3])
{
    for (int i = 0; i < 3; i++)
        shares[i] = child == 3 ? UNIT - 2 * shares[i] : 2 * shares[i] - (i == child ? UNIT : 0);
}

/* i when the point is corner i, 3 + i when it is the middle of the edge across from corner i, else -1 */
static int name_point(const int32_t shares[3])
{
    for (int i = 0; i < 3; i++) {
        if (shares[i] == UNIT)
            return i;
        if (shares[i] == 0 && shares[(i + 1) % 3] == UNIT / 2)
            return 3 + i;
    }
    return -1;
}

/* fits a triangle to the node that its points are given in: all of it, or a half; false when it is smaller */
static bool fit_node(const int32_t points[3][3], const int32_t rows[3], frame_node *fit)
{
    *fit = (frame_node){.rows = {-1, -1, -1}, .middle = -1, .apex = -1};
    for (int p = 0; p < 3; p++) {
        int name = name_point(points[p]);
        if (name < 0 || (name >= 3 && fit->middle >= 0))
            return false;
        if (name < 3) {
            fit->rows[name] = rows[p];
        } else {
            fit->middle = rows[p];
            fit->apex = (int8_t)(name - 3);
        }
    }
    /* the middle of an edge is numbered as the corner opposite to it */
    return fit->middle < 0 || fit->rows[fit->apex] >= 0;
}

/* the first of `count` new nodes; NO_NODE when out of memory */
static int32_t add_nodes(pel_common_mesh *common, int32_t count)
{
    void *nodes = common->nodes;
    int32_t first = common->node_count;
    bool grown = pel_reserve(&nodes, &common->node_room, (size_t)(first + count), sizeof *common->nodes);
    common->nodes = nodes;
    if (!grown)
        return NO_NODE;
    for (int i = 0; i < count; i++)
        common->nodes[common->node_count++] = (node){.children = NO_NODE};
    return first;
}

static bool split_node(pel_common_mesh *common, int32_t n)
{
    int32_t children = add_nodes(common, 4);
    common->nodes[n].children = children;
    return children != NO_NODE;
}

/* the node that a triangle equals or halves, and how; with `make` nodes are split as needed. PEL_BAD_FORMAT if there is
   none. */
static pel_status find_node(pel_common_mesh *common, int32_t n, bool make, int32_t points[3][3], const int32_t rows[3],
                            int32_t *found, frame_node *fit)
{
    for (int depth = 0; depth <= DEPTH_LIMIT; depth++) {
        *found = n;
        if (fit_node((const int32_t(*)[3])points, rows, fit))
            return PEL_OK;
        const int64_t centre[3] = {(int64_t)points[0][0] + points[1][0] + points[2][0],
                                   (int64_t)points[0][1] + points[1][1] + points[2][1],
                                   (int64_t)points[0][2] + points[1][2] + points[2][2]};
        int child = choose_child(centre);
        for (int p = 0; p < 3; p++) {
            enter_child(child, points[p]);
            if (points[p][0] < 0 || points[p][1] < 0 || points[p][2] < 0)
                return PEL_BAD_FORMAT;
        }
        if (common->nodes[n].children == NO_NODE && !(make && split_node(common, n)))
            return make ? PEL_OUT_OF_MEMORY : PEL_BAD_FORMAT;
        n = common->nodes[n].children + child;
    }
    return PEL_BAD_FORMAT;
}

/* ---- the overlay ---- */

/* the node of a root, new if necessary; NO_NODE if out of memory */
static int32_t root_node(pel_common_mesh *common, const key *root)
{
    void *nodes = common->root_nodes;
    int32_t before = common->roots.count, number = number_key(&common->roots, root);
    if (number < before)
        return number >= 0 ? common->root_nodes[number] : NO_NODE;
    bool grown = pel_reserve(&nodes, &common->root_room, (size_t)number + 1, sizeof *common->root_nodes);
    common->root_nodes = nodes;
    if (!grown)
        return NO_NODE;
    return common->root_nodes[number] = add_nodes(common, 1);
}

typedef pel_status triangle_visit(pel_common_mesh *common, const key *root, int32_t points[3][3],
                                  const int32_t rows[3]);

static pel_status visit_triangles(pel_common_mesh *common, const frame_view *view, triangle_visit *visit,
                                  pel_error *error)
{
    for (int32_t t = 0; t < view->mesh->triangle_count; t++) {
        const int32_t *rows = view->mesh->triangles[t];
        key keys[3], root;
        int32_t points[3][3];
        bool good = true;
        for (int i = 0; i < 3 && good; i++)
            good = read_key(common, view, rows[i], &keys[i]);
        pel_status status =
            good && find_root(keys, &root, points) ? visit(common, &root, points, rows) : PEL_BAD_FORMAT;
        if (status == PEL_OUT_OF_MEMORY)
            return pel_fail_memory(error);
        if (status != PEL_OK) {
            fail_frame(view, "the triangle does not belong to a refined mesh", error);
            pel_fail_element(error, "triangle", t);
            return status;
        }
    }
    return PEL_OK;
}

static pel_status add_triangle(pel_common_mesh *common, const key *root, int32_t points[3][3], const int32_t rows[3])
{
    int32_t n = root_node(common, root), found;
    frame_node fit;
    if (n == NO_NODE)
        return PEL_OUT_OF_MEMORY;
    pel_status status = find_node(common, n, true, points, rows, &found, &fit);
    if (status == PEL_OK && fit.middle >= 0)
        common->nodes[found].medians = (uint8_t)(common->nodes[found].medians | 1 << fit.apex);
    return status;
}

static pel_status add_frames(pel_common_mesh *common, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t f = 0; status == PEL_OK && f < common->frames->frame_count; f++) {
        pel_mesh *mesh;
        frame_view view;
        status = open_frame(common->frames, f, &mesh, &view, error);
        if (status != PEL_OK)
            break;
        status = visit_triangles(common, &view, add_triangle, error);
        pel_mesh_destroy(mesh);
    }
    return status;
}

/* ---- bodies ---- */

static pel_status count_body_vertices(pel_common_mesh *common, const frame_view *view, pel_error *error)
{
    for (int32_t row = 0; row < view->mesh->vertex_count; row++) {
        double body = view->bodies != NULL ? view->bodies[row] : 0;
        if (!(body >= 0 && body < common->body_count))
            return fail_frame(view, "the field body names a body that has no vertex in the first frame", error);
        for (int i = 0; i < 3; i++) {
            double corner = view->corners[3 * (size_t)row + (size_t)i];
            if (!(corner >= 0 && corner < (1 << 24)))
                return fail_frame(view, "a value of the field mesh_vertices is not the number of a vertex", error);
            int32_t *count = &common->body_begin[(int32_t)body + 1];
            *count = (int32_t)corner + 1 > *count ? (int32_t)corner + 1 : *count;
        }
    }
    return PEL_OK;
}

/* the numbers of the bodies' mesh vertices, from the first frame, which names all of them */
static pel_status lay_out_bodies(pel_common_mesh *common, pel_error *error)
{
    pel_mesh *mesh;
    frame_view view;
    pel_status status = open_frame(common->frames, 0, &mesh, &view, error);
    if (status != PEL_OK)
        return status;
    double last = 0;
    for (int32_t row = 0; view.bodies != NULL && row < mesh->vertex_count; row++)
        last = pel_max(last, view.bodies[row]);
    common->body_count = last < BODY_LIMIT ? (int32_t)last + 1 : 0;
    common->body_begin = pel_allocate((size_t)common->body_count + 1, sizeof *common->body_begin);
    status = common->body_begin != NULL ? count_body_vertices(common, &view, error) : pel_fail_memory(error);
    int64_t sum = 0;
    for (int32_t b = 0; status == PEL_OK && b < common->body_count; b++) {
        sum += common->body_begin[b + 1];
        if (sum > INT32_MAX)
            status = fail_frame(&view, "the bodies have too many vertices for one file", error);
        else
            common->body_begin[b + 1] = (int32_t)sum;
    }
    pel_mesh_destroy(mesh);
    return status;
}

/* ---- vertices and triangles of the common mesh ---- */

/* a node with its corners in the root */
typedef struct piece {
    int32_t root, node;
    int32_t corners[3][3];
} piece;

/* number of a point of a root; -1 when out of memory */
static int32_t number_point(pel_common_mesh *common, int32_t root, const int32_t shares[3])
{
    key k = normal_key(common->roots.keys[root].vertices, shares);
    /* corners have the numbers of the mesh vertices */
    int32_t number = k.shares[0] == UNIT ? k.vertices[0] : number_key(&common->vertices, &k);
    if (number < 0)
        return -1;
    number += k.shares[0] == UNIT ? 0 : common->body_begin[common->body_count];
    void *places = common->places;
    bool grown = pel_reserve(&places, &common->place_room, (size_t)number + 1, sizeof *common->places);
    common->places = places;
    if (!grown)
        return -1;
    common->places[number] = (place){root, {shares[0], shares[1], shares[2]}};
    return number;
}

static bool add_face(pel_common_mesh *common, int32_t a, int32_t b, int32_t c)
{
    void *triangles = common->triangles;
    bool grown =
        pel_reserve(&triangles, &common->triangle_room, (size_t)common->triangle_count + 1, sizeof *common->triangles);
    common->triangles = triangles;
    if (!grown || a < 0 || b < 0 || c < 0)
        return false;
    int32_t *face = common->triangles[common->triangle_count++];
    face[0] = a;
    face[1] = b;
    face[2] = c;
    return true;
}

static void middle_of(const int32_t a[3], const int32_t b[3], int32_t middle[3])
{
    for (int i = 0; i < 3; i++)
        middle[i] = (a[i] + b[i]) / 2;
}

/* the faces of a node that is not split, cut by its medians */
static bool add_leaf(pel_common_mesh *common, const piece *p)
{
    int medians = common->nodes[p->node].medians;
    int32_t corners[3], middles[3] = {-1, -1, -1}, shares[3];
    for (int i = 0; i < 3; i++) {
        corners[i] = number_point(common, p->root, p->corners[i]);
        middle_of(p->corners[(i + 1) % 3], p->corners[(i + 2) % 3], shares);
        if (medians & (1 << i))
            middles[i] = number_point(common, p->root, shares);
    }
    if (medians == 0)
        return add_face(common, corners[0], corners[1], corners[2]);
    /* one median joins its middle and its apex; more of them meet in the centre */
    int apex = medians == 1 ? 0 : medians == 2 ? 1 : medians == 4 ? 2 : -1;
    for (int i = 0; i < 3; i++)
        shares[i] = (p->corners[0][i] + p->corners[1][i] + p->corners[2][i]) / 3;
    int32_t centre = apex >= 0 ? corners[apex] : number_point(common, p->root, shares);
    bool good = true;
    for (int i = 0; i < 3; i++) {
        int32_t from = corners[(i + 1) % 3], to = corners[(i + 2) % 3];
        if (apex >= 0 && i != apex)
            continue;
        if (medians & (1 << i))
            good = good && add_face(common, from, middles[i], centre) && add_face(common, middles[i], to, centre);
        else
            good = good && add_face(common, from, to, centre);
    }
    return good;
}

static void child_piece(const pel_common_mesh *common, const piece *p, int child, piece *in)
{
    *in = (piece){.root = p->root, .node = common->nodes[p->node].children + child};
    for (int i = 0; i < 3; i++) {
        if (i == child)
            memcpy(in->corners[i], p->corners[i], sizeof in->corners[i]);
        else if (child == 3)
            middle_of(p->corners[(i + 1) % 3], p->corners[(i + 2) % 3], in->corners[i]);
        else
            middle_of(p->corners[i], p->corners[child], in->corners[i]);
    }
}

/* pass the medians of a split node to its children, and continue there */
static bool add_piece(pel_common_mesh *common, const piece *p)
{
    const node n = common->nodes[p->node];
    if (n.children == NO_NODE)
        return add_leaf(common, p);
    bool good = true;
    for (int child = 0; child < 4; child++) {
        piece in;
        int medians = child == 3 ? n.medians : n.medians & (1 << child);
        node *below = &common->nodes[n.children + child];
        below->medians = (uint8_t)(below->medians | medians);
        child_piece(common, p, child, &in);
        good = good && add_piece(common, &in);
    }
    return good;
}

static pel_status build(pel_common_mesh *common, pel_error *error)
{
    int32_t mesh_count = common->body_begin[common->body_count];
    common->place_room = (size_t)mesh_count;
    common->places = pel_allocate((size_t)mesh_count, sizeof *common->places);
    bool good = common->places != NULL;
    for (int32_t v = 0; good && v < mesh_count; v++)
        common->places[v].root = -1;
    for (int32_t r = 0; good && r < common->roots.count; r++)
        good = add_piece(common, &(piece){r, common->root_nodes[r], {{UNIT, 0, 0}, {0, UNIT, 0}, {0, 0, UNIT}}});
    common->frame_nodes = pel_allocate((size_t)common->node_count, sizeof *common->frame_nodes);
    return good && common->frame_nodes != NULL ? PEL_OK : pel_fail_memory(error);
}

pel_status pel_common_mesh_create(const pel_frames *frames, pel_common_mesh **common, pel_error *error)
{
    *common = NULL;
    pel_common_mesh *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->frames = frames;
    pel_status status = lay_out_bodies(made, error);
    if (status == PEL_OK)
        status = add_frames(made, error);
    if (status == PEL_OK)
        status = build(made, error);
    if (status == PEL_OK)
        *common = made;
    else
        pel_common_mesh_destroy(made);
    return status;
}

void pel_common_mesh_destroy(pel_common_mesh *common)
{
    if (common == NULL)
        return;
    pel_free(common->triangles);
    pel_free(common->places);
    free_table(&common->vertices);
    PEL_FREE_ALL(common->frame_nodes, common->nodes, common->root_nodes);
    free_table(&common->roots);
    pel_free(common->body_begin);
    pel_free(common);
}

int32_t pel_common_mesh_vertex_count(const pel_common_mesh *common)
{
    return common->body_begin[common->body_count] + common->vertices.count;
}

/* ---- a frame on the common mesh ---- */

static pel_status note_triangle(pel_common_mesh *common, const key *root, int32_t points[3][3], const int32_t rows[3])
{
    int32_t number = find_key(&common->roots, root), found;
    frame_node fit;
    if (number < 0 || find_node(common, common->root_nodes[number], false, points, rows, &found, &fit) != PEL_OK)
        return PEL_BAD_FORMAT;
    frame_node *noted = &common->frame_nodes[found];
    fit.stamp = common->stamp;
    /* the other half is there already */
    for (int i = 0; noted->stamp == fit.stamp && i < 3; i++)
        fit.rows[i] = fit.rows[i] >= 0 ? fit.rows[i] : noted->rows[i];
    *noted = fit;
    return PEL_OK;
}

/* the rows that give a place, and their weights; false when the frame has nothing there */
static bool weigh_rows(const pel_common_mesh *common, const place *at, int32_t rows[3], double weights[3])
{
    int32_t shares[3] = {at->shares[0], at->shares[1], at->shares[2]}, n = common->root_nodes[at->root];
    while (common->frame_nodes[n].stamp != common->stamp) {
        const int64_t point[3] = {shares[0], shares[1], shares[2]};
        int child = choose_child(point);
        if (common->nodes[n].children == NO_NODE)
            return false;
        enter_child(child, shares);
        n = common->nodes[n].children + child;
    }
    const frame_node *fit = &common->frame_nodes[n];
    memcpy(rows, fit->rows, sizeof fit->rows);
    if (fit->middle >= 0) {
        /* of the corners beside the median, the nearer one and the middle make up the other */
        int i = (fit->apex + 1) % 3, j = (fit->apex + 2) % 3;
        int near = shares[i] >= shares[j] ? i : j, far = i + j - near;
        rows[far] = fit->middle;
        shares[near] -= shares[far];
        shares[far] *= 2;
    }
    for (int i = 0; i < 3; i++) {
        weights[i] = (double)shares[i] / UNIT;
        rows[i] = shares[i] == 0 ? 0 : rows[i];
        if (rows[i] < 0)
            return false;
    }
    return true;
}

static void mix(const double *values, int32_t component_count, const int32_t rows[3], const double weights[3],
                double *out)
{
    size_t components = (size_t)component_count;
    for (size_t c = 0; c < components; c++) {
        double sum = 0;
        for (int i = 0; i < 3; i++)
            sum += weights[i] != 0 ? weights[i] * values[components * (size_t)rows[i] + c] : 0;
        out[c] = sum;
    }
}

static pel_status add_fields(const pel_mesh *from, pel_mesh *mesh, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t f = 0; status == PEL_OK && f < from->field_count; f++)
        if (!pel_common_mesh_is_place(from->fields[f].name) && strcmp(from->fields[f].name, "level") != 0)
            status = pel_mesh_add_field(mesh, from->fields[f].name, from->fields[f].component_count, NULL, error);
    return status;
}

/* values of the frame at every vertex of mesh; a vertex without triangles stays at the origin */
static pel_status evaluate(const pel_common_mesh *common, const frame_view *view, pel_mesh *mesh, pel_error *error)
{
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        int32_t rows[3];
        double weights[3];
        if (common->places[v].root < 0)
            continue;
        if (!weigh_rows(common, &common->places[v], rows, weights))
            return fail_frame(view, "the frame does not cover the mesh", error);
        mix(view->mesh->positions[0], 3, rows, weights, mesh->positions[v]);
        for (int32_t f = 0; f < mesh->field_count; f++) {
            pel_field *field = &mesh->fields[f];
            const pel_field *from = pel_mesh_field(view->mesh, field->name);
            mix(from->values, field->component_count, rows, weights,
                field->values + (size_t)v * (size_t)field->component_count);
        }
    }
    return PEL_OK;
}

static pel_status make_mesh(const pel_common_mesh *common, const frame_view *view, pel_mesh **mesh, pel_error *error)
{
    int32_t count = pel_common_mesh_vertex_count(common);
    double *zeros = pel_allocate(3 * (size_t)count, sizeof *zeros);
    if (zeros == NULL)
        return pel_fail_memory(error);
    pel_status status = pel_mesh_create(zeros, count, common->triangles[0], common->triangle_count, mesh, error);
    pel_free(zeros);
    if (status == PEL_OK)
        status = add_fields(view->mesh, *mesh, error);
    return status == PEL_OK ? evaluate(common, view, *mesh, error) : status;
}

pel_status pel_common_mesh_read(pel_common_mesh *common, int32_t frame, pel_mesh **mesh, pel_error *error)
{
    pel_mesh *own;
    frame_view view;
    *mesh = NULL;
    pel_status status = open_frame(common->frames, frame, &own, &view, error);
    if (status != PEL_OK)
        return status;
    common->stamp++;
    status = visit_triangles(common, &view, note_triangle, error);
    if (status == PEL_OK)
        status = make_mesh(common, &view, mesh, error);
    if (status != PEL_OK) {
        pel_mesh_destroy(*mesh);
        *mesh = NULL;
    }
    pel_mesh_destroy(own);
    return status;
}
