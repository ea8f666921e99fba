#include "haptic/proxy.h"

#include "math/extremes.h"
#include "math/vec3.h"

/* rounds of Newton's method and halvings of a step at most; 2 to 5 and none are usual */
enum { ROUND_LIMIT = 30, HALVING_LIMIT = 20 };
/* of the search for how far planes are withdrawn: to a millionth of their depth */
enum { BISECTIONS = 20 };
/* share of the device's damping beyond the need of holding the force that may pay for changes of the local model */
#define RESERVE 0.5
/* planes below this share of the largest stiffness are dropped when a new model comes */
#define FADED 0.01
/* s, blending takes at most so long */
#define BLEND_LIMIT 0.1

/* J/m2: energy over the square of a displacement in a period that is counted as taken by the device's damping. Holding
   the force over a period generates K/2 + B/T; a share of the remaining damping is counted as well, the rest
   dissipates. */
static double taken_energy(const pel_haptic_def *def)
{
    double held = 0.5 * def->coupling_stiffness + def->coupling_damping * def->rate;
    return held + RESERVE * (def->device_damping * def->rate - held);
}

void pel_proxy_create(pel_proxy *proxy, const pel_haptic_def *def)
{
    *proxy = (pel_proxy){.period = 1 / def->rate,
                         .coupling_stiffness = def->coupling_stiffness,
                         .coupling_damping = def->coupling_damping,
                         .taken = taken_energy(def),
                         .max_force = def->max_force,
                         .max_growth = def->max_force_rate / def->rate,
                         .energy_budget = def->energy_budget,
                         .controls = def->passivity_control,
                         .blend_count = 1};
}

/* ---- the local model ---- */

/* share of the newest model, 0 .. 1 */
static double blend_share(const pel_proxy *proxy)
{
    double share = (double)(proxy->update_count - proxy->arrived_at) / (double)proxy->blend_count;
    return share < 1 ? share : 1;
}

/* all planes with their present share of stiffness; returns how many */
static int32_t blended_planes(const pel_proxy *proxy, double share, pel_haptic_plane planes[PEL_PROXY_PLANES])
{
    int32_t count = 0;
    for (int32_t i = 0; i < proxy->old_count && share < 1; i++) {
        planes[count] = proxy->old[i];
        planes[count++].stiffness *= 1 - share;
    }
    for (int32_t i = 0; i < proxy->model.plane_count && share > 0; i++) {
        planes[count] = proxy->model.planes[i];
        planes[count++].stiffness *= share;
    }
    return count;
}

void pel_proxy_set_model(pel_proxy *proxy, const pel_local_model *model)
{
    pel_haptic_plane planes[PEL_PROXY_PLANES];
    int32_t count = blended_planes(proxy, blend_share(proxy), planes);
    double most = 0;
    for (int32_t i = 0; i < count; i++)
        most = pel_max(most, planes[i].stiffness);
    proxy->old_count = 0;
    /* the stiffest ones; of equal ones the older */
    while (proxy->old_count < PEL_PROXY_OLD) {
        int32_t stiffest = -1;
        for (int32_t i = 0; i < count; i++)
            if (planes[i].stiffness > FADED * most &&
                (stiffest < 0 || planes[i].stiffness > planes[stiffest].stiffness))
                stiffest = i;
        if (stiffest < 0)
            break;
        proxy->old[proxy->old_count++] = planes[stiffest];
        planes[stiffest].stiffness = 0;
    }
    int64_t longest = (int64_t)ceil(BLEND_LIMIT / proxy->period), since = proxy->update_count - proxy->arrived_at;
    proxy->blend_count = since < 1 ? 1 : since > longest ? longest : since;
    proxy->arrived_at = proxy->update_count;
    proxy->model = *model;
}

/* ---- the proxy ---- */

static double plane_depth(const pel_haptic_plane *plane, const double p[3])
{
    double depth = plane->offset - pel_vec3_dot(plane->normal, p);
    return depth > 0 || plane->is_two_sided ? depth : 0;
}

static double energy_at(const pel_haptic_plane *planes, int32_t count, double stiffness, const double x[3],
                        const double p[3])
{
    double distance = pel_vec3_distance(p, x), energy = 0.5 * stiffness * distance * distance;
    for (int32_t i = 0; i < count; i++) {
        double depth = plane_depth(&planes[i], p);
        energy += 0.5 * planes[i].stiffness * depth * depth;
    }
    return energy;
}

/* solution (3) of a symmetric positive definite system, its matrix as xx, yy, zz, xy, yz, xz: Cramer's rule */
static void solve3(const double m[6], const double right[3], double solution[3])
{
    const double a[3] = {m[0], m[3], m[5]}, b[3] = {m[3], m[1], m[4]}, c[3] = {m[5], m[4], m[2]};
    double bc[3], ca[3], ab[3];
    pel_vec3_cross(b, c, bc);
    pel_vec3_cross(c, a, ca);
    pel_vec3_cross(a, b, ab);
    double determinant = pel_vec3_dot(a, bc);
    for (int i = 0; i < 3; i++)
        solution[i] = (right[0] * bc[i] + right[1] * ca[i] + right[2] * ab[i]) / determinant;
}

/* bit i: plane i pushes or pulls at p */
static uint32_t acting_planes(const pel_haptic_plane *planes, int32_t count, const double p[3])
{
    uint32_t acting = 0;
    for (int32_t i = 0; i < count; i++)
        if (planes[i].is_two_sided || plane_depth(&planes[i], p) > 0)
            acting |= (uint32_t)1 << i;
    return acting;
}

/* step of Newton's method from p: to the least energy of the coupling and the planes that act */
static void newton_step(const pel_haptic_plane *planes, uint32_t acting, double stiffness, const double x[3],
                        const double p[3], double step[3])
{
    double matrix[6] = {stiffness, stiffness, stiffness, 0, 0, 0}, right[3];
    pel_vec3_subtract(x, p, right);
    pel_vec3_scale(right, stiffness, right);
    for (int32_t i = 0; acting >> i != 0; i++) {
        if ((acting >> i & 1) == 0)
            continue;
        const double k = planes[i].stiffness, *n = planes[i].normal;
        pel_vec3_along(right, k * (planes[i].offset - pel_vec3_dot(n, p)), n, right);
        for (int c = 0; c < 3; c++) {
            matrix[c] += k * n[c] * n[c];
            matrix[3 + c] += k * n[c == 1 ? 1 : 0] * n[c == 0 ? 1 : 2];
        }
    }
    solve3(matrix, right, step);
}

bool pel_proxy_find(const pel_haptic_plane *planes, int32_t count, double coupling_stiffness, const double x[3],
                    double p[3])
{
    pel_vec3_copy(x, p);
    uint32_t acting = acting_planes(planes, count, p);
    if (acting == 0)
        return false;
    for (int round = 0; round < ROUND_LIMIT; round++) {
        double step[3], next[3], share = 1, energy = energy_at(planes, count, coupling_stiffness, x, p);
        newton_step(planes, acting, coupling_stiffness, x, p, step);
        pel_vec3_add(p, step, next);
        uint32_t acting_next = acting_planes(planes, count, next);
        /* the energy is quadratic where the same planes act: this is its least */
        bool is_found = acting_next == acting;
        for (int h = 0; !is_found && h < HALVING_LIMIT; h++) {
            if (energy_at(planes, count, coupling_stiffness, x, next) < energy)
                break;
            share /= 2;
            pel_vec3_along(p, share, step, next);
        }
        pel_vec3_copy(next, p);
        if (is_found)
            break;
        acting = acting_planes(planes, count, p);
    }
    return true;
}

/* ---- energy ---- */

/* Books the interval that ends now: the force held over it did work on the device, whose damping took its part.
 * Intervals count in which a plane pushed at the start or at the end, and others while there is energy to take. */
static void observe(pel_proxy *proxy, const double move[3], bool touches)
{
    bool is_free = !proxy->touches && !touches;
    if (!is_free || proxy->energy > 0)
        proxy->energy += pel_vec3_dot(proxy->force, move) - proxy->taken * pel_vec3_squared_length(move);
    proxy->most_energy = pel_max(proxy->most_energy, proxy->energy);
    /* energy taken by a contact is no credit for the next one */
    if (is_free)
        proxy->energy = pel_max(proxy->energy, 0);
}

/* planes moved towards the point x by a distance, at most until x is on them */
static void ease(const pel_haptic_plane *planes, int32_t count, const double x[3], double distance,
                 pel_haptic_plane *eased)
{
    for (int32_t i = 0; i < count; i++) {
        double depth = plane_depth(&planes[i], x);
        eased[i] = planes[i];
        if (depth != 0)
            eased[i].offset -= copysign(pel_min(distance, fabs(depth)), depth);
    }
}

/* Withdraws the planes until the energy stored in them is at most `most`: if a new model would add more energy than the
   device has given, the surface starts deeper, and returns as the device retreats. */
static void withdraw(pel_proxy *proxy, const pel_haptic_plane *planes, int32_t count, const double x[3], double most,
                     double p[3])
{
    pel_haptic_plane eased[PEL_PROXY_PLANES];
    double low = 0, high = 0;
    for (int32_t i = 0; i < count; i++)
        high = pel_max(high, fabs(plane_depth(&planes[i], x)));
    for (int n = 0; n < BISECTIONS; n++) {
        double middle = 0.5 * (low + high);
        ease(planes, count, x, middle, eased);
        pel_proxy_find(eased, count, proxy->coupling_stiffness, x, p);
        if (energy_at(eased, count, proxy->coupling_stiffness, x, p) <= most)
            high = middle;
        else
            low = middle;
    }
    ease(planes, count, x, high, eased);
    pel_proxy_find(eased, count, proxy->coupling_stiffness, x, p);
    proxy->withdrawn_count++;
}

/* ---- the update ---- */

/* the damper of the coupling, which never pulls */
static void add_coupling_damping(const pel_proxy *proxy, const double move[3], const double p[3], double force[3])
{
    if (!(proxy->coupling_damping > 0) || !proxy->has_last)
        return;
    double rate[3], normal[3];
    pel_vec3_copy(force, normal);
    pel_vec3_normalize(normal);
    for (int i = 0; i < 3; i++)
        rate[i] = (p[i] - proxy->proxy[i] - move[i]) / proxy->period;
    pel_vec3_along(force, proxy->coupling_damping, rate, force);
    double along = pel_vec3_dot(force, normal);
    if (along < 0)
        pel_vec3_along(force, -along, normal, force);
}

static void limit(pel_proxy *proxy, double force[3])
{
    double size = pel_vec3_length(force),
           most = pel_min(proxy->max_force, pel_vec3_length(proxy->force) + proxy->max_growth);
    if (size <= most)
        return;
    pel_vec3_scale(force, most / size, force);
    proxy->limited_count++;
}

void pel_proxy_update(pel_proxy *proxy, const double position[3])
{
    double move[3] = {0, 0, 0}, p[3], force[3];
    pel_haptic_plane planes[PEL_PROXY_PLANES];
    proxy->update_count++;
    if (proxy->has_last)
        pel_vec3_subtract(position, proxy->device, move);
    if (pel_vec3_distance(position, proxy->model.tool_position) <= proxy->model.reach)
        proxy->is_engaged = true;
    int32_t count = proxy->is_engaged ? blended_planes(proxy, blend_share(proxy), planes) : 0;
    bool touches = pel_proxy_find(planes, count, proxy->coupling_stiffness, position, p);
    observe(proxy, move, touches);
    double most = proxy->energy_budget - proxy->energy;
    if (proxy->controls && touches && energy_at(planes, count, proxy->coupling_stiffness, position, p) > most)
        withdraw(proxy, planes, count, position, most, p);
    pel_vec3_subtract(p, position, force);
    pel_vec3_scale(force, proxy->coupling_stiffness, force);
    if (touches)
        add_coupling_damping(proxy, move, p, force);
    limit(proxy, force);
    pel_vec3_copy(position, proxy->device);
    pel_vec3_copy(p, proxy->proxy);
    pel_vec3_copy(force, proxy->force);
    proxy->touches = touches;
    proxy->has_last = true;
}

void pel_proxy_lose(pel_proxy *proxy)
{
    proxy->update_count++;
    proxy->lost_count++;
    proxy->touches = proxy->has_last = proxy->is_engaged = false;
    pel_vec3_set(proxy->force, 0, 0, 0);
    proxy->energy = 0;
}
