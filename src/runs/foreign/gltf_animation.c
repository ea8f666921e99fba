/* Animations (glTF 2.0, section 3.11 and appendix C): keys of each channel, between them constant, linear (rotations
   along the great circle) or cubic. */
#include "foreign/gltf.h"

#include "base/memory.h"
#include "base/room.h"
#include "math/functions.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const again = "export the animation again";

typedef enum channel_path { TRANSLATION, ROTATION, SCALE, WEIGHTS, PATH_COUNT } channel_path;
typedef enum key_shape { LINEAR, STEP, CUBIC } key_shape;

struct pel_gltf_channel {
    int32_t animation, node;
    channel_path path;
    key_shape shape;
    double *times, *values; /* (key_count), (key_count x [3 x] width): of cubic ones tangent in, value, tangent out */
    size_t key_count, width;
    double *now; /* (width) of pel_gltf_animation_pose */
};

/* ---- values ---- */

static void mix(const double *a, const double *b, double share, size_t width, double *now)
{
    for (size_t k = 0; k < width; k++)
        now[k] = a[k] + share * (b[k] - a[k]);
}

/* the shorter way between two unit quaternions */
static void mix_rotation(const double *a, const double *b, double share, double *now)
{
    double product = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    const double sign = product < 0 ? -1 : 1;
    product *= sign;
    double of_a = 1 - share, of_b = share;
    /* nearly equal ones: the chord, which is normalised where it is used */
    if (product < 1 - 1e-9) {
        const double angle = pel_acos(product);
        of_a = pel_sin((1 - share) * angle) / pel_sin(angle);
        of_b = pel_sin(share * angle) / pel_sin(angle);
    }
    for (int k = 0; k < 4; k++)
        now[k] = of_a * a[k] + of_b * sign * b[k];
}

/* Hermite's cubic; tangents are per second */
static void mix_cubic(const double *before, const double *after, double share, double seconds, size_t width,
                      double *now)
{
    const double *a = before + width, *out = before + 2 * width, *in = after, *b = after + width;
    const double s = share, s2 = s * s, s3 = s2 * s;
    for (size_t k = 0; k < width; k++)
        now[k] = (2 * s3 - 3 * s2 + 1) * a[k] + seconds * (s3 - 2 * s2 + s) * out[k] + (3 * s2 - 2 * s3) * b[k] +
                 seconds * (s3 - s2) * in[k];
}

/* the last key that is not after the time; the first one before all */
static size_t find_key(const pel_gltf_channel *channel, double time)
{
    size_t low = 0, high = channel->key_count;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (channel->times[middle] <= time)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static void set_now(const pel_gltf_channel *channel, double time)
{
    const size_t width = channel->width, key = find_key(channel, time),
                 each = channel->shape == CUBIC ? 3 * width : width;
    const double *before = channel->values + key * each, *after = before + each;
    const bool is_between = key + 1 < channel->key_count && time > channel->times[key];
    if (!is_between || channel->shape == STEP) {
        memcpy(channel->now, channel->shape == CUBIC ? before + width : before, width * sizeof *before);
        return;
    }
    const double seconds = channel->times[key + 1] - channel->times[key];
    const double share = (time - channel->times[key]) / seconds;
    if (channel->shape == CUBIC)
        mix_cubic(before, after, share, seconds, width, channel->now);
    else if (channel->path == ROTATION)
        mix_rotation(before, after, share, channel->now);
    else
        mix(before, after, share, width, channel->now);
}

void pel_gltf_animation_pose(pel_gltf_animation *animation, double time, pel_gltf_nodes *nodes)
{
    for (size_t c = 0; c < animation->channel_count; c++) {
        const pel_gltf_channel *channel = &animation->channels[c];
        pel_gltf_node *node = &nodes->nodes[channel->node];
        double *const parts[] = {node->translation, node->rotation, node->scale};
        set_now(channel, time);
        if (channel->path == WEIGHTS) {
            node->weights = channel->now;
            node->weight_count = (int32_t)channel->width;
        } else {
            memcpy(parts[channel->path], channel->now, channel->width * sizeof *channel->now);
        }
    }
}

/* ---- reading ---- */

/* member `key` of the object names one of the list's elements */
static pel_status find_element(const pel_gltf *g, const pel_json_node *object, const char *key,
                               const pel_json_node *list, const pel_json_node **element, pel_error *error)
{
    int64_t number;
    const int64_t count = list != NULL ? list->count : 0;
    pel_status status = pel_gltf_integer(g, object, key, -1, 0, count - 1, &number, error);
    if (status == PEL_OK && number < 0)
        return pel_gltf_fail(g, object, error, again, "a channel of an animation has no '%s'", key);
    *element = pel_json_first(&g->tree, list);
    while (status == PEL_OK && number-- > 0)
        *element = pel_json_after(&g->tree, *element);
    return status;
}

static pel_status check_times(const pel_gltf *g, const pel_json_node *sampler, const pel_gltf_channel *channel,
                              pel_error *error)
{
    for (size_t i = 0; i < channel->key_count; i++)
        if (!(channel->times[i] >= 0) || (i > 0 && !(channel->times[i] > channel->times[i - 1])))
            return pel_gltf_fail(g, sampler, error, again, "the time of key %zu is not above that of the key before",
                                 i);
    return PEL_OK;
}

static pel_status read_shape(const pel_gltf *g, const pel_json_node *sampler, key_shape *shape, pel_error *error)
{
    const pel_json_node *word = pel_json_member(&g->tree, sampler, "interpolation");
    *shape = pel_json_is(word, "STEP") ? STEP : pel_json_is(word, "CUBICSPLINE") ? CUBIC : LINEAR;
    if (word == NULL || *shape != LINEAR || pel_json_is(word, "LINEAR"))
        return PEL_OK;
    return pel_gltf_fail(g, word, error, again, "the keys have an interpolation that glTF does not have");
}

static pel_status normalise_rotations(const pel_gltf *g, const pel_json_node *sampler, pel_gltf_channel *channel,
                                      pel_error *error)
{
    for (size_t i = 0; channel->path == ROTATION && channel->shape != CUBIC && i < channel->key_count; i++) {
        double *q = channel->values + 4 * i;
        const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        if (!(length > 0))
            return pel_gltf_fail(g, sampler, error, again, "the rotation of key %zu has no length", i);
        for (int k = 0; k < 4; k++)
            q[k] /= length;
    }
    return PEL_OK;
}

static pel_status read_keys(pel_gltf *g, const pel_json_node *sampler, pel_gltf_channel *channel, pel_error *error)
{
    static const int32_t widths[PATH_COUNT] = {3, 4, 3, 1};
    const pel_json_node *input, *output;
    size_t count;
    pel_status status = pel_gltf_named(g, sampler, "input", PEL_GLTF_ACCESSORS, &input, error);
    if (status == PEL_OK)
        status = pel_gltf_named(g, sampler, "output", PEL_GLTF_ACCESSORS, &output, error);
    if (status == PEL_OK && (input == NULL || output == NULL))
        return pel_gltf_fail(g, sampler, error, again, "the keys of a channel have no times or no values");
    if (status == PEL_OK)
        status = read_shape(g, sampler, &channel->shape, error);
    if (status == PEL_OK)
        status = pel_gltf_numbers(g, input, 1, &channel->times, &channel->key_count, error);
    if (status == PEL_OK)
        status = check_times(g, sampler, channel, error);
    if (status == PEL_OK)
        status = pel_gltf_numbers(g, output, widths[channel->path], &channel->values, &count, error);
    if (status != PEL_OK)
        return status;
    const size_t keys = channel->key_count * (channel->shape == CUBIC ? 3 : 1);
    channel->width = channel->path == WEIGHTS ? count / keys : (size_t)widths[channel->path];
    if (channel->width == 0 || count != (channel->path == WEIGHTS ? keys * channel->width : keys))
        return pel_gltf_fail(g, sampler, error, again, "%zu keys of a channel have %zu values", channel->key_count,
                             count);
    channel->now = pel_allocate(channel->width, sizeof *channel->now);
    return channel->now != NULL ? normalise_rotations(g, sampler, channel, error) : pel_fail_memory(error);
}

/* PATH_COUNT for what moves no vertex */
static channel_path path_of(const pel_json_node *word)
{
    static const char *const words[PATH_COUNT] = {"translation", "rotation", "scale", "weights"};
    channel_path path = TRANSLATION;
    while (path < PATH_COUNT && !pel_json_is(word, words[path]))
        path++;
    return path;
}

static pel_status read_channel(pel_gltf *g, const pel_gltf_nodes *nodes, int32_t number, const pel_json_node *at,
                               pel_gltf_animation *animation, pel_error *error)
{
    const pel_json_tree *tree = &g->tree;
    const pel_json_node *whole = g->lists[PEL_GLTF_ANIMATIONS][number];
    const pel_json_node *target = pel_json_member(tree, at, "target"), *sampler = NULL;
    const channel_path path = path_of(pel_json_member(tree, target, "path"));
    int64_t node;
    pel_status status =
        pel_gltf_integer(g, target, "node", -1, 0, (int64_t)g->counts[PEL_GLTF_NODES] - 1, &node, error);
    if (status != PEL_OK || node < 0 || path == PATH_COUNT || !nodes->nodes[node].is_in_scene)
        return status;
    if (nodes->nodes[node].has_matrix && path != WEIGHTS)
        return pel_gltf_fail(g, target, error, again, "node %lld has both a matrix and an animation", (long long)node);
    status = find_element(g, at, "sampler", pel_json_member(tree, whole, "samplers"), &sampler, error);
    if (status != PEL_OK)
        return status;
    if (!pel_reserve((void **)&animation->channels, &animation->channel_capacity, animation->channel_count + 1,
                     sizeof *animation->channels))
        return pel_fail_memory(error);
    pel_gltf_channel *channel = &animation->channels[animation->channel_count++];
    *channel = (pel_gltf_channel){.animation = number, .node = (int32_t)node, .path = path};
    status = read_keys(g, sampler, channel, error);
    if (status == PEL_OK && channel->times[channel->key_count - 1] > animation->duration)
        animation->duration = channel->times[channel->key_count - 1];
    return status;
}

/* ---- choice ---- */

static void list_names(const pel_gltf *g, char *text, size_t size)
{
    size_t length = 0;
    text[0] = '\0';
    for (int32_t i = 0; i < g->counts[PEL_GLTF_ANIMATIONS] && length + 70 < size; i++) {
        char name[60];
        if (!pel_json_unescape(pel_json_member(&g->tree, g->lists[PEL_GLTF_ANIMATIONS][i], "name"), name, sizeof name))
            snprintf(name, sizeof name, "%d", (int)i);
        length += (size_t)snprintf(text + length, size - length, "%s%s", i > 0 ? ", " : "", name);
    }
}

/* by name, or by number where that is none's name; -1 = none */
static int32_t find_named(const pel_gltf *g, const char *name)
{
    const int32_t count = g->counts[PEL_GLTF_ANIMATIONS];
    char text[200];
    for (int32_t i = 0; i < count; i++)
        if (pel_json_unescape(pel_json_member(&g->tree, g->lists[PEL_GLTF_ANIMATIONS][i], "name"), text, sizeof text) &&
            strcmp(text, name) == 0)
            return i;
    for (int32_t i = 0; i < count; i++) {
        snprintf(text, sizeof text, "%d", (int)i);
        if (strcmp(text, name) == 0)
            return i;
    }
    return -1;
}

/* Whether one node is moved in one way by more than one animation, as of a figure that walks and runs. owners: (4 for
   each node) zeroed. */
static bool have_rivals(const pel_gltf_animation *animation, int32_t *owners)
{
    for (size_t c = 0; c < animation->channel_count; c++) {
        const pel_gltf_channel *channel = &animation->channels[c];
        int32_t *owner = &owners[(size_t)PATH_COUNT * (size_t)channel->node + (size_t)channel->path];
        if (*owner != 0 && *owner != channel->animation + 1)
            return true;
        *owner = channel->animation + 1;
    }
    return false;
}

static pel_status check_rivals(const pel_gltf *g, const pel_gltf_animation *animation, pel_error *error)
{
    char names[300];
    int32_t *owners = pel_allocate((size_t)PATH_COUNT * (size_t)g->counts[PEL_GLTF_NODES], sizeof *owners);
    if (owners == NULL)
        return pel_fail_memory(error);
    const bool are_rivals = have_rivals(animation, owners);
    pel_free(owners);
    if (!are_rivals)
        return PEL_OK;
    list_names(g, names, sizeof names);
    return pel_gltf_fail(g, NULL, error, "choose one with `animation: NAME`",
                         "the file has %d animations of the same nodes: %s", (int)g->counts[PEL_GLTF_ANIMATIONS],
                         names);
}

static pel_status read_channels(pel_gltf *g, const pel_gltf_nodes *nodes, int32_t number, pel_gltf_animation *animation,
                                pel_error *error)
{
    const pel_json_node *whole = g->lists[PEL_GLTF_ANIMATIONS][number];
    pel_status status = PEL_OK;
    for (const pel_json_node *at = pel_json_first(&g->tree, pel_json_member(&g->tree, whole, "channels"));
         at != NULL && status == PEL_OK; at = pel_json_after(&g->tree, at))
        status = read_channel(g, nodes, number, at, animation, error);
    return status;
}

pel_status pel_gltf_animation_read(pel_gltf *g, const pel_gltf_nodes *nodes, const char *name,
                                   pel_gltf_animation *animation, pel_error *error)
{
    char names[300];
    const int32_t count = g->counts[PEL_GLTF_ANIMATIONS], chosen = name != NULL ? find_named(g, name) : 0;
    *animation = (pel_gltf_animation){0};
    list_names(g, names, sizeof names);
    if (count == 0)
        return pel_gltf_fail(g, NULL, error, "export it with its animation, or give a point cache (.pc2)",
                             "the file has no animation");
    if (chosen < 0)
        return pel_gltf_fail(g, NULL, error, "choose one of these", "no animation is named '%.60s'; there are: %s",
                             name, names);
    pel_status status = PEL_OK;
    for (int32_t i = chosen; i < (name != NULL ? chosen + 1 : count) && status == PEL_OK; i++)
        status = read_channels(g, nodes, i, animation, error);
    if (status == PEL_OK && animation->channel_count == 0)
        return pel_gltf_fail(g, NULL, error, name != NULL ? "choose another animation" : "export it with its animation",
                             "the animation moves no node of the scene");
    return status == PEL_OK ? check_rivals(g, animation, error) : status;
}

void pel_gltf_animation_free(pel_gltf_animation *animation)
{
    for (size_t c = 0; c < animation->channel_count; c++)
        PEL_FREE_ALL(animation->channels[c].times, animation->channels[c].values, animation->channels[c].now);
    pel_free(animation->channels);
    *animation = (pel_gltf_animation){0};
}
