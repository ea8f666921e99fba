#include "foreign/gltf.h"

#include "base/memory.h"
#include "base/room.h"

#include <math.h>
#include <string.h>

static const char *const again = "export the file again, or as PLY or OBJ";

pel_status pel_gltf_nodes_place(const pel_gltf *g, pel_gltf_nodes *nodes, pel_error *error)
{
    for (int32_t i = 0; i < nodes->order_count; i++) {
        pel_gltf_node *node = &nodes->nodes[nodes->order[i]];
        pel_place local = node->matrix;
        if (!node->has_matrix && !pel_place_by_parts(node->translation, node->rotation, node->scale, &local))
            return pel_gltf_fail(g, node->node, error, again, "the rotation of a node has no length");
        node->world = node->parent < 0 ? local : pel_place_product(&nodes->nodes[node->parent].world, &local);
    }
    return PEL_OK;
}

/* ---- the tree ---- */

/* a member with exactly `most` numbers, or as it is when there is none */
static pel_status read_vector(const pel_gltf *g, const pel_json_node *node, const char *key, double *numbers,
                              int32_t most, pel_error *error)
{
    int32_t count;
    const pel_json_node *list = pel_json_member(&g->tree, node, key);
    if (list == NULL)
        return PEL_OK;
    pel_status status = pel_gltf_list_numbers(g, list, numbers, most, &count, error);
    if (status == PEL_OK && count != most)
        return pel_gltf_fail(g, list, error, again, "'%s' of a node has not %d numbers", key, (int)most);
    return status;
}

static pel_status read_parts(const pel_gltf *g, pel_gltf_node *node, pel_error *error)
{
    double m[16];
    node->rotation[3] = node->scale[0] = node->scale[1] = node->scale[2] = 1;
    node->has_matrix = pel_json_member(&g->tree, node->node, "matrix") != NULL;
    pel_status status = read_vector(g, node->node, "matrix", m, 16, error);
    if (status == PEL_OK)
        status = read_vector(g, node->node, "translation", node->translation, 3, error);
    if (status == PEL_OK)
        status = read_vector(g, node->node, "rotation", node->rotation, 4, error);
    if (status == PEL_OK)
        status = read_vector(g, node->node, "scale", node->scale, 3, error);
    for (int i = 0; status == PEL_OK && node->has_matrix && i < 3; i++) {
        for (int k = 0; k < 3; k++)
            node->matrix.linear[i][k] = m[4 * k + i];
        node->matrix.shift[i] = m[12 + i];
    }
    return status;
}

/* nodes still to visit, the next one last */
typedef struct node_stack {
    int32_t *nodes;
    size_t count, capacity;
} node_stack;

/* a child of the parent, or a root */
static pel_status push_node(pel_gltf *g, pel_gltf_nodes *nodes, node_stack *stack, int32_t parent,
                            const pel_json_node *number, pel_error *error)
{
    const double index = number->kind == PEL_JSON_IS_NUMBER ? number->number : -1;
    if (!(index >= 0 && index < (double)g->counts[PEL_GLTF_NODES] && index == floor(index)))
        return pel_gltf_fail(g, number, error, again, "there is no such node");
    pel_gltf_node *node = &nodes->nodes[(size_t)index];
    if (node->is_in_scene)
        return pel_gltf_fail(g, number, error, again, "node %.0f stands twice in the tree of nodes", index);
    node->is_in_scene = true;
    node->parent = parent;
    if (!pel_reserve((void **)&stack->nodes, &stack->capacity, stack->count + 1, sizeof *stack->nodes))
        return pel_fail_memory(error);
    stack->nodes[stack->count++] = (int32_t)index;
    return read_parts(g, node, error);
}

static pel_status push_nodes(pel_gltf *g, pel_gltf_nodes *nodes, node_stack *stack, int32_t parent,
                             const pel_json_node *list, pel_error *error)
{
    const size_t first = stack->count;
    pel_status status = PEL_OK;
    for (const pel_json_node *at = pel_json_first(&g->tree, list); at != NULL && status == PEL_OK;
         at = pel_json_after(&g->tree, at))
        status = push_node(g, nodes, stack, parent, at, error);
    /* the first one is visited first */
    for (size_t i = first, k = stack->count; status == PEL_OK && i + 1 < k; i++, k--) {
        const int32_t one = stack->nodes[i];
        stack->nodes[i] = stack->nodes[k - 1];
        stack->nodes[k - 1] = one;
    }
    return status;
}

static pel_status visit_node(pel_gltf *g, pel_gltf_nodes *nodes, node_stack *stack, int32_t number, pel_error *error)
{
    const pel_json_node *node = nodes->nodes[number].node;
    const pel_json_node *extensions = pel_json_member(&g->tree, node, "extensions");
    const pel_json_node *copies = pel_json_member(&g->tree, extensions, "EXT_mesh_gpu_instancing");
    if (copies != NULL)
        return pel_gltf_fail(g, copies, error, "export the copies as nodes",
                             "a node has copies by the extension EXT_mesh_gpu_instancing, which is not read");
    nodes->order[nodes->order_count++] = number;
    return push_nodes(g, nodes, stack, number, pel_json_member(&g->tree, node, "children"), error);
}

static pel_status visit_scene(pel_gltf *g, const pel_json_node *scene, pel_gltf_nodes *nodes, pel_error *error)
{
    node_stack stack = {0};
    pel_status status = push_nodes(g, nodes, &stack, -1, pel_json_member(&g->tree, scene, "nodes"), error);
    while (stack.count > 0 && status == PEL_OK) {
        stack.count--;
        status = visit_node(g, nodes, &stack, stack.nodes[stack.count], error);
    }
    pel_free(stack.nodes);
    return status;
}

pel_status pel_gltf_nodes_read(pel_gltf *g, pel_gltf_nodes *nodes, pel_error *error)
{
    const size_t count = (size_t)g->counts[PEL_GLTF_NODES];
    const pel_json_node *scene;
    *nodes = (pel_gltf_nodes){0};
    pel_status status = pel_gltf_named(g, g->tree.nodes, "scene", PEL_GLTF_SCENES, &scene, error);
    if (status != PEL_OK)
        return status;
    if (scene == NULL && g->counts[PEL_GLTF_SCENES] > 0)
        scene = g->lists[PEL_GLTF_SCENES][0];
    nodes->has_scene = scene != NULL;
    nodes->nodes = pel_allocate(count, sizeof *nodes->nodes);
    nodes->order = pel_allocate(count, sizeof *nodes->order);
    if (nodes->nodes == NULL || nodes->order == NULL)
        return pel_fail_memory(error);
    for (size_t n = 0; n < count; n++)
        nodes->nodes[n].node = g->lists[PEL_GLTF_NODES][n];
    return scene != NULL ? visit_scene(g, scene, nodes, error) : PEL_OK;
}

void pel_gltf_nodes_free(pel_gltf_nodes *nodes)
{
    PEL_FREE_ALL(nodes->nodes, nodes->order);
    *nodes = (pel_gltf_nodes){0};
}
