/* A net of springs whose stiffness follows from a Young's modulus E and a thickness h (van Gelder 1998) is a sheet of
   that modulus and a Poisson's ratio of 1/3 only on equilateral triangles. On others its stiffness depends on the
   direction: on a union-jack grid of squares 1.2 E along the cells and 1.6 E along cells twice as long as wide, on a
   grid with one diagonal 1.0 E along cells and diagonals, and 0.33 E across the diagonals. Where a flat body is
   stretched or sheared much alike all over, its mean stress over its mean strain tells which it is. Elsewhere its
   energy does, over that of springs in all directions: these are a sheet, whose triangle of area A with stretches l by
   direction has E h A 3 / 2 times the mean of (l - 1)^2. */
#include "run/warnings_springs.h"

#include "base/memory.h"
#include "linear/eigen.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "model/quantity.h"
#include "pellicle/sim_surface.h"
#include "run/state.h"
#include "stage/stepper.h"

#include <math.h>
#include <stdio.h>

/* of the area: a net is flat if its triangles face one side by so much */
#define FLAT_SHARE 0.9999
/* of the mean square of the strain: that of the mean strain */
#define EVEN_SHARE 0.5
/* below, positions in single precision tell nothing */
#define LEAST_STRAIN 1e-5
/* principal stress across one over the other: at most, of uniaxial tension, and how far from -1, of shear */
#define ACROSS_SHARE 0.15
#define MOST_ERROR 0.1
/* of the strain: shear under tension */
#define MOST_SKEW 0.2
/* shear modulus of the sheet, over Young's modulus */
#define SHEAR_SHARE 0.375
#define HALF_TURN 3.14159265358979323846
/* in place of the shear: a net whose energy is known, and not its stiffness */
#define BY_ENERGY (-1)
/* over which stretches are averaged */
enum { DIRECTIONS = 12 };

/* sums over the triangles, by rows of a symmetric matrix: stress over modulus and thickness, Green strain */
typedef struct net_sums {
    double area, stress[4], strain[4], square;
    double net, sheet; /* energy over modulus and thickness, twice: of the springs, and in all directions */
} net_sums;

bool pel_warnings_find_plane(const pel_mesh *mesh, double axes[2][3])
{
    double sum[3] = {0}, normal[3], area = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        pel_vec3_triangle_normal(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]], normal);
        pel_vec3_add(sum, normal, sum);
        area += pel_vec3_length(normal);
    }
    bool is_flat = pel_vec3_length(sum) > FLAT_SHARE * area;
    const int32_t *v = mesh->triangles[0];
    pel_vec3_subtract(mesh->positions[v[1]], mesh->positions[v[0]], axes[0]);
    pel_vec3_normalize(axes[0]);
    pel_vec3_normalize(sum);
    pel_vec3_cross(sum, axes[0], axes[1]);
    return is_flat;
}

/* of a triangle: by the stretch of each side, and of directions between them */
static void add_energies(const pel_mesh *mesh, const int32_t *v, const double (*now)[3], net_sums *sums)
{
    const double area = pel_vec3_triangle_area(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]]);
    double rest[3][3], present[3][3], along[3], across[3];
    for (int k = 0; k < 3; k++) {
        pel_vec3_subtract(mesh->positions[v[(k + 1) % 3]], mesh->positions[v[k]], rest[k]);
        pel_vec3_subtract(now[v[(k + 1) % 3]], now[v[k]], present[k]);
        double excess = pel_vec3_length(present[k]) / pel_vec3_length(rest[k]) - 1;
        sums->net += area * excess * excess;
    }
    /* images of the unit vectors along the first side and across it */
    const double length = pel_vec3_length(rest[0]), part = pel_vec3_dot(rest[0], rest[1]) / length;
    pel_vec3_scale(present[0], 1 / length, along);
    for (int c = 0; c < 3; c++)
        across[c] = (present[1][c] - part * along[c]) * length / (2 * area);
    for (int i = 0; i < DIRECTIONS; i++) {
        double image[3], angle = HALF_TURN * i / DIRECTIONS;
        pel_vec3_scale(along, pel_cos(angle), image);
        pel_vec3_along(image, pel_sin(angle), across, image);
        double excess = pel_vec3_length(image) - 1;
        sums->sheet += 3 * area * excess * excess / DIRECTIONS;
    }
    sums->area += area;
}

static void add_triangle(const pel_mesh *mesh, const int32_t *v, const double (*now)[3], const double axes[2][3],
                         net_sums *sums)
{
    double rest[3][2], present[3][3], inverse[4], f[3][2], own[4];
    double area = pel_vec3_triangle_area(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]]);
    for (int k = 0; k < 3; k++) {
        double edge[3];
        pel_vec3_subtract(mesh->positions[v[(k + 1) % 3]], mesh->positions[v[k]], edge);
        pel_vec3_subtract(now[v[(k + 1) % 3]], now[v[k]], present[k]);
        for (int i = 0; i < 2; i++)
            rest[k][i] = pel_vec3_dot(edge, axes[i]);
        /* its share of the spring: E h area / length^2 */
        double square = pel_vec3_squared_length(edge);
        double pull = area / square * (1 - sqrt(square) / pel_vec3_length(present[k]));
        for (int i = 0; i < 4; i++)
            sums->stress[i] += pull * rest[k][i / 2] * rest[k][i % 2];
    }
    double turn = rest[0][0] * rest[1][1] - rest[0][1] * rest[1][0];
    inverse[0] = rest[1][1] / turn;
    inverse[1] = -rest[1][0] / turn;
    inverse[2] = -rest[0][1] / turn;
    inverse[3] = rest[0][0] / turn;
    for (int c = 0; c < 3; c++) {
        f[c][0] = present[0][c] * inverse[0] + present[1][c] * inverse[2];
        f[c][1] = present[0][c] * inverse[1] + present[1][c] * inverse[3];
    }
    for (int i = 0; i < 4; i++) {
        own[i] = i % 3 == 0 ? -0.5 : 0;
        for (int c = 0; c < 3; c++)
            own[i] += 0.5 * f[c][i / 2] * f[c][i % 2];
        sums->strain[i] += area * own[i];
        sums->square += area * own[i] * own[i];
    }
}

/* stretch less 1 along a direction */
static double strain_along(const double strain[4], const double n[2])
{
    double green = 0;
    for (int i = 0; i < 4; i++)
        green += strain[i] * n[i / 2] * n[i % 2];
    return sqrt(1 + 2 * green) - 1;
}

/* Green shear strain between two directions */
static double shear_between(const double strain[4], const double a[2], const double b[2])
{
    double shear = 0;
    for (int i = 0; i < 4; i++)
        shear += strain[i] * a[i / 2] * b[i % 2];
    return shear;
}

/* stiffness over that of the sheet; 0 = not known. *skew = under tension in one direction, the angle by which the net
   shears over its strain. */
static double factor_of(net_sums *sums, double *skew)
{
    *skew = 0;
    double size = 0, values[2], n[4];
    for (int i = 0; i < 4; i++) {
        sums->stress[i] /= sums->area;
        sums->strain[i] /= sums->area;
        size += sums->strain[i] * sums->strain[i];
    }
    if (!(size > LEAST_STRAIN * LEAST_STRAIN && size > EVEN_SHARE * sums->square / sums->area))
        return 0;
    pel_eigen_dense(2, sums->stress, values, n);
    int most = fabs(values[1]) > fabs(values[0]);
    double across = values[1 - most] / values[most];
    double along = strain_along(sums->strain, n + 2 * most), beside = strain_along(sums->strain, n + 2 * (1 - most));
    /* the second Piola-Kirchhoff stress is by stretches smaller than that of Hooke's law */
    if (fabs(across) < ACROSS_SHARE) {
        *skew = fabs(2 * shear_between(sums->strain, n + 2 * most, n + 2 * (1 - most)) / along);
        return values[most] * (1 + along) / along;
    }
    if (fabs(across + 1) < ACROSS_SHARE)
        return (values[most] - values[1 - most]) / (2 * SHEAR_SHARE * (along - beside));
    return 0;
}

static bool is_net(const pel_run_state *run, int32_t b)
{
    const pel_body_def *body = &run->scene->model.bodies[b];
    return body->spring_thickness > 0 && body->spring_stiffness.field == NULL &&
           body->spring_stiffness.key_count == 0 && pel_quantity_mean(&body->spring_stiffness, 1) > 0 &&
           !body->shell.membrane.on && !body->volume.on && body->refine.levels == 0 &&
           pel_sim_vertex_count(run->sim, b) == body->mesh->vertex_count;
}

/* of a flat net that is strained alike all over as factor_of has it, of others by the energy; 0 = not known */
static double net_factor(const pel_mesh *mesh, const double (*now)[3], double *skew)
{
    net_sums sums = {0};
    double axes[2][3], factor = 0;
    const bool is_flat = pel_warnings_find_plane(mesh, axes);
    *skew = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        add_energies(mesh, mesh->triangles[t], now, &sums);
        if (is_flat)
            add_triangle(mesh, mesh->triangles[t], now, (const double(*)[3])axes, &sums);
    }
    if (is_flat)
        factor = factor_of(&sums, skew);
    if (factor > 0 || !(sums.sheet > LEAST_STRAIN * LEAST_STRAIN * sums.area))
        return factor;
    *skew = BY_ENERGY;
    return sums.net / sums.sheet;
}

void pel_warnings_check_springs(pel_run_state *run, int64_t frame)
{
    for (int32_t b = 0; b < run->scene->model.body_count; b++) {
        const pel_mesh *mesh = run->scene->model.bodies[b].mesh;
        if (!is_net(run, b) || !pel_stepper_knows_material(pel_stepper_of(run->scene->sim.solver.method)))
            continue;
        double *now = pel_allocate(3 * (size_t)mesh->vertex_count, sizeof *now), skew;
        if (now == NULL)
            return;
        pel_sim_get_positions(run->sim, b, now);
        double factor = net_factor(mesh, (const double(*)[3])now, &skew);
        pel_free(now);
        if (!(factor > 0 && (fabs(factor - 1) > MOST_ERROR || skew > MOST_SKEW)))
            continue;
        if (run->totals.warnings.of[PEL_WARN_SPRING_NET].count == 0)
            run->flagged[PEL_WARN_SPRING_NET] = (pel_flagged_body){b, factor, skew};
        pel_warn(&run->totals.warnings, PEL_WARN_SPRING_NET, frame, pel_max(fabs(factor - 1), skew));
    }
}

void pel_tell_springs(const pel_warning_text *at)
{
    const pel_flagged_body *flagged = &at->run->flagged[PEL_WARN_SPRING_NET];
    const pel_body_def *body = &at->run->scene->model.bodies[flagged->body];
    char factor[120], skew[80] = "";
    if (flagged->limit < 0)
        snprintf(factor, sizeof factor, "store %.2g times the energy of a sheet in the same shape", flagged->value);
    else
        snprintf(factor, sizeof factor, "are %.2g times as stiff as their Young's modulus", flagged->value);
    if (flagged->limit > MOST_SKEW)
        snprintf(skew, sizeof skew, ", and shear by %.2g times their stretch, as no sheet does", flagged->limit);
    snprintf(at->text, at->size,
             "the springs of body '%s' %s%s: where it is strained, a net depends on the pattern of its mesh. use "
             "equilateral triangles, or in place of springs membrane: { young: %.4g, poisson: 0.33, thickness: %.4g }",
             body->name, factor, skew, pel_quantity_mean(&body->spring_stiffness, 1), body->spring_thickness);
}
