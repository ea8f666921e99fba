/* Poses of tools: between their keys, between two poses, and the return to the keys after a tool was held back. */
#include "tool/pose.h"

#include "math/extremes.h"
#include "tool/follow.h"

#include <string.h>

/* turns of a key at most: angles of more lose their digits */
enum { MOST_TURNS = 1000000 };
/* of a tool's size */
#define CAUGHT_UP 1e-6
static const double FULL_TURN = 6.283185307179586476925;

/* ---- keys ---- */

/* whole turns of a key, and the quaternion of all that is left of it */
static void split_turns(const pel_pose_key *key, double whole[3], double left[3], double rotation[4])
{
    double turns = trunc(pel_vec3_length(key->rotation_vector) / FULL_TURN);
    pel_vec3_set(whole, 0, 0, 0);
    pel_vec3_copy(key->rotation_vector, left);
    if (turns > 0) {
        pel_vec3_scale(left, turns * FULL_TURN / pel_vec3_length(left), whole);
        pel_vec3_subtract(left, whole, left);
    }
    pel_rotation_turn(key->rotation, left, 1, rotation);
}

/* whether a key has no rotation at all */
static bool is_upright(const pel_pose_key *key)
{
    const double *q = key->rotation, *v = key->rotation_vector;
    return q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 1 && v[0] == 0 && v[1] == 0 && v[2] == 0;
}

/* The pose between two keys at s in 0 .. 1, with the rotation from the first key as its spin. With the whole turns A, B
   of the keys and the quaternions a, b of all else it is exp(s B) exp((1 - s) A) exp(s d) a, where d leads from a to b:
   of all such d the one nearest to the difference of the rotation vectors and the shorter arc of the quaternions. */
static pel_pose pose_between_keys(const pel_pose_key *a, const pel_pose_key *b, double s)
{
    static const double none[3] = {0};
    double whole[2][3], left[2][3], rotation[2][4], remains[3], expected[3];
    pel_pose pose = {.rotation = {0, 0, 0, 1}};
    for (int i = 0; i < 3; i++)
        pose.position[i] = a->position[i] + s * (b->position[i] - a->position[i]);
    /* the same bits, in a tenth of the time */
    if (is_upright(a) && is_upright(b))
        return pose;
    split_turns(a, whole[0], left[0], rotation[0]);
    split_turns(b, whole[1], left[1], rotation[1]);
    pel_rotation_between(a->rotation, b->rotation, none, expected);
    for (int i = 0; i < 3; i++)
        expected[i] += left[1][i] - left[0][i];
    pel_rotation_between(rotation[0], rotation[1], expected, remains);
    for (int i = 0; i < 3; i++)
        pose.spin[i] = s * (whole[1][i] - whole[0][i] + remains[i]);
    pel_rotation_turn(rotation[0], remains, s, pose.rotation);
    pel_rotation_turn(pose.rotation, whole[0], 1 - s, pose.rotation);
    pel_rotation_turn(pose.rotation, whole[1], s, pose.rotation);
    return pose;
}

/* the number of the key at or before a time, the first before all */
static int32_t find_key(const pel_pose_key *keys, int32_t count, double time)
{
    int32_t k = 0;
    while (k + 1 < count && keys[k + 1].time <= time)
        k++;
    return k;
}

static pel_pose pose_of_keys(const pel_pose_key *keys, int32_t count, double time)
{
    int32_t k = find_key(keys, count, time);
    const pel_pose_key *a = &keys[k], *b = k + 1 < count ? a + 1 : a;
    return pose_between_keys(a, b, time > a->time && b > a ? (time - a->time) / (b->time - a->time) : 0);
}

bool pel_tool_is_key(const pel_pose_key *key)
{
    const double *position = key->position, *q = key->rotation;
    double square = pel_vec3_dot(q, q) + q[3] * q[3];
    return isfinite(key->time) && isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2]) &&
           fabs(square - 1) < 1e-6 && pel_vec3_length(key->rotation_vector) <= MOST_TURNS * FULL_TURN;
}

void pel_tool_sum_spins(pel_tool *tool)
{
    pel_vec3_set(tool->key_spins[0], 0, 0, 0);
    for (int32_t k = 1; k < tool->key_count; k++) {
        pel_pose pose = pose_between_keys(&tool->keys[k - 1], &tool->keys[k], 1);
        pel_vec3_add(tool->key_spins[k - 1], pose.spin, tool->key_spins[k]);
    }
}

void pel_tool_def_pose(const pel_tool_def *def, double time, double position[3], double rotation[4])
{
    if (def == NULL || position == NULL || rotation == NULL)
        return;
    pel_pose pose = pose_of_keys(def->keys, def->key_count, time);
    memcpy(position, pose.position, sizeof pose.position);
    memcpy(rotation, pose.rotation, sizeof pose.rotation);
}

pel_pose pel_tool_pose_at(const pel_tool *tool, double time)
{
    if (tool->driven)
        return tool->driven_pose;
    pel_pose pose = pose_of_keys(tool->keys, tool->key_count, time);
    pel_vec3_add(pose.spin, tool->key_spins[find_key(tool->keys, tool->key_count, time)], pose.spin);
    pose.along = pel_tool_along(tool, time);
    return pose;
}

/* ---- the step ---- */

/* a tool that was held back catches up at twice its keyed speed, or by an eighth of the lag per step if that is more; a
   lag below CAUGHT_UP of its size is closed in one step */
static pel_pose catch_up(const pel_tool *tool, double time, double dt)
{
    pel_pose wanted = pel_tool_pose_at(tool, time), last = pel_tool_pose_at(tool, time - dt), pose;
    double behind = pel_tool_way(tool, &tool->pose, &wanted), stride = 2 * pel_tool_way(tool, &last, &wanted);
    double share = behind > CAUGHT_UP * pel_tool_size(tool) ? pel_max(stride / behind, 0.125) : 1;
    pel_pose_between(&tool->pose, &wanted, pel_min(share, 1), &pose);
    return pose;
}

pel_pose pel_tool_next_pose(const pel_sim *sim, const pel_tool *tool, double time)
{
    if (tool->blocked)
        return catch_up(tool, time, sim->step.dt);
    pel_pose wanted = pel_tool_pose_at(tool, time), pose = wanted;
    /* a driven tool has its pose of the end of the step: parts interpolate */
    if (tool->driven)
        pel_pose_between(&tool->pose, &wanted, pel_part_share_left(sim), &pose);
    return pose;
}
