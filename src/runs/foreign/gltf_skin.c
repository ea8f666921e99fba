#include "foreign/gltf.h"

#include "base/memory.h"
#include "base/room.h"

#include <math.h>
#include <stdio.h>

static const char *const again = "export the file again, or as PLY or OBJ";

/* ---- bones ---- */

static pel_status read_inverses(pel_gltf *g, const pel_json_node *accessor, pel_gltf_skin *made, pel_error *error)
{
    double *numbers = NULL;
    size_t count;
    pel_status status = pel_gltf_numbers(g, accessor, 16, &numbers, &count, error);
    if (status == PEL_OK && count < (size_t)made->joint_count)
        status = pel_gltf_fail(g, accessor, error, again, "%zu matrices for %d bones", count, (int)made->joint_count);
    for (int32_t j = 0; j < made->joint_count && status == PEL_OK; j++)
        for (int i = 0; i < 3; i++) {
            const double *m = numbers + 16 * (size_t)j;
            for (int k = 0; k < 3; k++)
                made->inverses[j].linear[i][k] = m[4 * k + i];
            made->inverses[j].shift[i] = m[12 + i];
        }
    pel_free(numbers);
    return status;
}

static pel_status read_joint(const pel_gltf *g, const pel_gltf_nodes *nodes, const pel_json_node *at, int32_t *joint,
                             pel_error *error)
{
    const double number = at->kind == PEL_JSON_IS_NUMBER ? at->number : -1;
    if (!(number >= 0 && number < (double)g->counts[PEL_GLTF_NODES] && number == floor(number)))
        return pel_gltf_fail(g, at, error, again, "there is no such node");
    if (!nodes->nodes[(size_t)number].is_in_scene)
        return pel_gltf_fail(g, at, error, again, "bone %.0f stands outside the scene", number);
    *joint = (int32_t)number;
    return PEL_OK;
}

pel_status pel_gltf_skin_read(pel_gltf *g, const pel_gltf_nodes *nodes, const pel_json_node *skin, pel_gltf_skin *made,
                              pel_error *error)
{
    const pel_json_node *joints = pel_json_member(&g->tree, skin, "joints"), *inverses;
    *made = (pel_gltf_skin){0};
    if (joints == NULL || joints->kind != PEL_JSON_IS_ARRAY || joints->count == 0)
        return pel_gltf_fail(g, skin, error, again, "a skin has no joints");
    const int32_t count = joints->count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(made->joints, count), PEL_ROOM(made->inverses, count), PEL_ROOM(made->bones, count)))
        return pel_fail_memory(error);
    pel_status status = pel_gltf_named(g, skin, "inverseBindMatrices", PEL_GLTF_ACCESSORS, &inverses, error);
    for (const pel_json_node *at = pel_json_first(&g->tree, joints); at != NULL && status == PEL_OK;
         at = pel_json_after(&g->tree, at)) {
        const int32_t j = made->joint_count++;
        for (int i = 0; i < 3; i++)
            made->inverses[j].linear[i][i] = 1;
        status = read_joint(g, nodes, at, &made->joints[j], error);
    }
    return status == PEL_OK && inverses != NULL ? read_inverses(g, inverses, made, error) : status;
}

void pel_gltf_skin_free(pel_gltf_skin *skin)
{
    PEL_FREE_ALL(skin->joints, skin->inverses, skin->bones);
    *skin = (pel_gltf_skin){0};
}

void pel_gltf_skin_pose(pel_gltf_skin *skin, const pel_gltf_nodes *nodes)
{
    for (int32_t j = 0; j < skin->joint_count; j++)
        skin->bones[j] = pel_place_product(&nodes->nodes[skin->joints[j]].world, &skin->inverses[j]);
}

/* ---- vertices ---- */

enum { MOST_SETS = 8 };

static pel_status read_set(pel_gltf *g, const pel_json_node *attributes, int32_t set, const char *word, size_t count,
                           double *numbers, pel_error *error)
{
    char key[24];
    const pel_json_node *accessor;
    double *read = NULL;
    size_t read_count = 0;
    snprintf(key, sizeof key, "%s_%d", word, (int)set);
    pel_status status = pel_gltf_named(g, attributes, key, PEL_GLTF_ACCESSORS, &accessor, error);
    if (status == PEL_OK && accessor == NULL)
        return pel_gltf_fail(g, attributes, error, again, "the mesh has no %s", key);
    if (status == PEL_OK)
        status = pel_gltf_numbers(g, accessor, 4, &read, &read_count, error);
    if (status == PEL_OK && read_count != count)
        status = pel_gltf_fail(g, accessor, error, again, "%s has %zu vertices, the mesh %zu", key, read_count, count);
    for (size_t i = 0; i < 4 * count && status == PEL_OK; i++)
        numbers[i] = read[i];
    pel_free(read);
    return status;
}

/* A sum of 1; without any weight the first bone has all, as in viewers. */
static void normalise(pel_gltf_influences *influences, size_t count)
{
    const size_t rows = (size_t)influences->sets * 4;
    for (size_t v = 0; v < count; v++) {
        double sum = 0;
        for (size_t i = 0; i < rows; i++)
            sum += influences->weights[(i / 4 * count + v) * 4 + i % 4];
        for (size_t i = 0; i < rows && sum > 0; i++)
            influences->weights[(i / 4 * count + v) * 4 + i % 4] /= sum;
        if (!(sum > 0)) {
            influences->joints[4 * v] = 0;
            influences->weights[4 * v] = 1;
        }
    }
}

static pel_status check_influences(const pel_gltf *g, const pel_json_node *attributes, size_t count,
                                   int32_t joint_count, const pel_gltf_influences *influences, pel_error *error)
{
    const size_t all = (size_t)influences->sets * count * 4;
    for (size_t i = 0; i < all; i++) {
        const double joint = influences->joints[i], weight = influences->weights[i];
        if (!(weight >= 0))
            return pel_gltf_fail(g, attributes, error, again, "vertex %zu has a weight of %g", i / 4 % count, weight);
        if (weight > 0 && !(joint >= 0 && joint < (double)joint_count && joint == floor(joint)))
            return pel_gltf_fail(g, attributes, error, again, "vertex %zu is moved by bone %g of %d", i / 4 % count,
                                 joint, (int)joint_count);
    }
    return PEL_OK;
}

pel_status pel_gltf_influences_read(pel_gltf *g, const pel_json_node *attributes, size_t count, int32_t joint_count,
                                    pel_gltf_influences *influences, pel_error *error)
{
    char key[24] = "JOINTS_0";
    *influences = (pel_gltf_influences){0};
    while (influences->sets < MOST_SETS && pel_json_member(&g->tree, attributes, key) != NULL)
        snprintf(key, sizeof key, "JOINTS_%d", (int)++influences->sets);
    const size_t all = (size_t)influences->sets * count * 4;
    if (influences->sets == 0)
        return PEL_OK;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(influences->joints, all), PEL_ROOM(influences->weights, all)))
        return pel_fail_memory(error);
    pel_status status = PEL_OK;
    for (int32_t set = 0; set < influences->sets && status == PEL_OK; set++) {
        const size_t begin = (size_t)set * count * 4;
        status = read_set(g, attributes, set, "JOINTS", count, influences->joints + begin, error);
        if (status == PEL_OK)
            status = read_set(g, attributes, set, "WEIGHTS", count, influences->weights + begin, error);
    }
    if (status == PEL_OK)
        status = check_influences(g, attributes, count, joint_count, influences, error);
    if (status == PEL_OK)
        normalise(influences, count);
    /* without a weight any number may stand there */
    for (size_t i = 0; i < all && status == PEL_OK; i++)
        influences->joints[i] = influences->weights[i] > 0 ? influences->joints[i] : 0;
    return status;
}

void pel_gltf_influences_free(pel_gltf_influences *influences)
{
    PEL_FREE_ALL(influences->joints, influences->weights);
    *influences = (pel_gltf_influences){0};
}

void pel_gltf_skin_point(const pel_gltf_skin *skin, const pel_gltf_influences *influences, size_t count, size_t v,
                         const double point[3], double placed[3])
{
    placed[0] = placed[1] = placed[2] = 0;
    for (size_t i = 0; i < (size_t)influences->sets * 4; i++) {
        const size_t at = (i / 4 * count + v) * 4 + i % 4;
        const double weight = influences->weights[at];
        double moved[3];
        if (!(weight > 0))
            continue;
        pel_place_point(&skin->bones[(size_t)influences->joints[at]], point, moved);
        for (int k = 0; k < 3; k++)
            placed[k] += weight * moved[k];
    }
}
