/* Systems with a part that is not symmetric, as follower loads and moments on edges have: (K + S) x = b with the
   symmetric K of the matrix. GMRES (Saad and Schultz 1986) on (1 + K^-1 S) x = K^-1 b, whose products are solves of the
   symmetric system. S acts on a few boundary edges, so that a few products do. */
#include "base/memory.h"
#include "base/status.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "newton/run.h"

#include <math.h>
#include <string.h>

enum { MOST_PRODUCTS = 30 };
/* residual over right side */
#define TOLERANCE 1e-8

struct pel_newton_skew {
    double *vectors[MOST_PRODUCTS + 1]; /* (unknown_limit) orthonormal */
    double hessenberg[MOST_PRODUCTS + 1][MOST_PRODUCTS], rotations[MOST_PRODUCTS][2], right[MOST_PRODUCTS + 1];
};

void pel_newton_skew_destroy(pel_newton_skew *skew)
{
    if (skew == NULL)
        return;
    for (int i = 0; i <= MOST_PRODUCTS; i++)
        pel_free(skew->vectors[i]);
    pel_free(skew);
}

static pel_status create(newton_run *run)
{
    pel_newton *newton = run->newton;
    pel_newton_skew *made = newton->skew = pel_allocate(1, sizeof *made);
    bool room = made != NULL;
    for (int i = 0; room && i <= MOST_PRODUCTS; i++) {
        made->vectors[i] = pel_allocate((size_t)newton->pattern->unknown_limit, sizeof *made->vectors[i]);
        room = made->vectors[i] != NULL;
    }
    if (room)
        return PEL_OK;
    pel_newton_skew_destroy(made);
    newton->skew = NULL;
    return pel_fail_memory(run->error);
}

/* whether the load is a moment on an edge, which the matrix takes for one of an edge that keeps its direction */
static bool has_moment(const newton_run *run, int32_t edge)
{
    const double *force = run->problem->force;
    return force != NULL && force[3 * (size_t)run->newton->pattern->vertex_count + (size_t)edge] != 0;
}

bool pel_newton_has_skew(const newton_run *run)
{
    const pel_newton_terms *terms = run->problem->terms;
    bool any = terms != NULL && terms->add_skew != NULL;
    for (int32_t e = 0; !any && e < run->newton->pattern->edge_count; e++)
        any = has_moment(run, e);
    return any;
}

/* y += S x of moments on edges. The frame that psi is measured in is carried along with the edge e, and turns about it
   by e . (d1 x d2) / (2 |e|^3) where a way d1 of its ends is followed by d2; the moment that the triangle bears works
   on that. */
static void add_moments(const newton_run *run, const double *x, double *y)
{
    const pel_newton *newton = run->newton;
    const pel_tangent_edge *edges = pel_tangent_edges_of(newton->tangent);
    for (int32_t e = 0; e < newton->pattern->edge_count; e++) {
        const size_t u = 3 * (size_t)newton->pattern->vertex_count + (size_t)e, tail = 3 * (size_t)edges[e].vertices[0],
                     head = 3 * (size_t)edges[e].vertices[1];
        double along[3], way[3], turn[3];
        if (!has_moment(run, e))
            continue;
        double moment = newton->gradient[u] + run->factor * run->problem->force[u];
        moment += run->share > 0 ? run->share * newton->balance[u] : 0;
        pel_vec3_subtract(run->unknowns + head, run->unknowns + tail, along);
        pel_vec3_subtract(x + head, x + tail, way);
        pel_vec3_cross(along, way, turn);
        const double square = pel_vec3_squared_length(along), scale = 0.5 * moment / (square * sqrt(square));
        pel_vec3_along(y + head, scale, turn, y + head);
        pel_vec3_along(y + tail, -scale, turn, y + tail);
    }
}

/* newton->step = K^-1 S x */
static bool multiply(newton_run *run, const double *x)
{
    pel_newton *newton = run->newton;
    const pel_newton_terms *terms = run->problem->terms;
    int32_t count = newton->pattern->unknown_count;
    memcpy(newton->move, x, (size_t)count * sizeof *x);
    memset(newton->right, 0, (size_t)count * sizeof *newton->right);
    pel_newton_frames_turn_back(&run->problem->frames, newton->move);
    if (terms != NULL && terms->add_skew != NULL)
        terms->add_skew(terms->context, newton->move, newton->right);
    add_moments(run, newton->move, newton->right);
    pel_newton_frames_turn(&run->problem->frames, newton->right);
    for (int32_t u = 0; u < count; u++)
        newton->right[u] = newton->fixed[u] ? 0 : newton->right[u];
    pel_pcg_end end = pel_newton_solve(run, PEL_NEWTON_PRODUCTS);
    return end == PEL_PCG_CONVERGED || end == PEL_PCG_LIMIT;
}

static void take_vector(const pel_newton *newton, double *vector, double scale)
{
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        vector[u] = scale * newton->step[u];
}

static void rotate(const double rotation[2], double *a, double *b)
{
    double first = rotation[0] * *a + rotation[1] * *b;
    *b = rotation[0] * *b - rotation[1] * *a;
    *a = first;
}

/* column i of the Hessenberg matrix, the next vector, and the remaining right side */
static bool add_column(newton_run *run, int i)
{
    pel_newton *newton = run->newton;
    pel_newton_skew *skew = newton->skew;
    if (!multiply(run, skew->vectors[i]))
        return false;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        newton->step[u] += skew->vectors[i][u];
    for (int j = 0; j <= i; j++) {
        double share = skew->hessenberg[j][i] = pel_newton_dot(newton, newton->step, skew->vectors[j]);
        for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
            newton->step[u] -= share * skew->vectors[j][u];
    }
    double length = sqrt(pel_newton_dot(newton, newton->step, newton->step));
    take_vector(newton, skew->vectors[i + 1], length > 0 ? 1 / length : 0);
    skew->hessenberg[i + 1][i] = length;
    for (int j = 0; j < i; j++)
        rotate(skew->rotations[j], &skew->hessenberg[j][i], &skew->hessenberg[j + 1][i]);
    double size = pel_hypot(skew->hessenberg[i][i], length);
    skew->rotations[i][0] = skew->hessenberg[i][i] / size;
    skew->rotations[i][1] = length / size;
    skew->right[i + 1] = 0;
    rotate(skew->rotations[i], &skew->hessenberg[i][i], &skew->hessenberg[i + 1][i]);
    rotate(skew->rotations[i], &skew->right[i], &skew->right[i + 1]);
    return size > 0;
}

/* newton->step from the first columns */
static void combine(const pel_newton *newton, int columns)
{
    pel_newton_skew *skew = newton->skew;
    memset(newton->step, 0, (size_t)newton->pattern->unknown_count * sizeof *newton->step);
    for (int i = columns - 1; i >= 0; i--) {
        for (int j = i + 1; j < columns; j++)
            skew->right[i] -= skew->hessenberg[i][j] * skew->right[j];
        skew->right[i] /= skew->hessenberg[i][i];
    }
    for (int i = 0; i < columns; i++)
        for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
            newton->step[u] += skew->right[i] * skew->vectors[i][u];
}

bool pel_newton_solve_skew(newton_run *run)
{
    pel_newton *newton = run->newton;
    if (newton->skew == NULL)
        run->status = create(run);
    double size = sqrt(pel_newton_dot(newton, newton->step, newton->step));
    if (run->status != PEL_OK || !(size > 0))
        return run->status == PEL_OK;
    pel_newton_skew *skew = newton->skew;
    take_vector(newton, skew->vectors[0], 1 / size);
    skew->right[0] = size;
    int columns = 0;
    while (columns < MOST_PRODUCTS && fabs(skew->right[columns]) > TOLERANCE * size)
        if (!add_column(run, columns++))
            return false;
    combine(newton, columns);
    return true;
}
