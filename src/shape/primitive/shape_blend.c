/* Bodies like scanned ones, made of a few rounded parts: each part is a cone with round ends, squashed along the axes;
   the distances to the parts are joined by a smooth minimum (Quilez, "smooth minimum", polynomial form), so that parts
   run into each other in fillets. The zero of the joined distance is meshed by marching tetrahedra and made even.

   The tables are in units of the body: about 1 long, z up, faces look along -y. */
#include "base/status.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "mesh/figures.h"
#include "primitive/implicit.h"
#include "primitive/shape_build.h"

#include <math.h>

typedef struct blend_part {
    double from[3], to[3]; /* centres of the round ends */
    double radii[2];       /* there */
    double squash[3];      /* factors along the axes */
    double blend;          /* width of the fillet to the parts before */
    bool mirrored;         /* a second one at -x */
    bool carved;           /* cut out instead of added */
} blend_part;

static const blend_part head[] = {
    /* skull, neck, muzzle, nose, jaw */
    {{0, 0.02, 0.12}, {0, 0.02, 0.12}, {0.27, 0.27}, {0.92, 1, 0.95}, 0, false, false},
    {{0, 0.12, -0.05}, {0, 0.24, -0.42}, {0.19, 0.21}, {1, 1, 1}, 0.12, false, false},
    {{0, -0.12, 0.07}, {0, -0.44, -0.09}, {0.2, 0.125}, {1, 1, 1}, 0.1, false, false},
    {{0, -0.49, -0.07}, {0, -0.49, -0.07}, {0.115, 0.115}, {1.1, 1, 0.9}, 0.05, false, false},
    {{0, -0.05, -0.1}, {0, -0.4, -0.19}, {0.12, 0.07}, {1, 1, 1}, 0.06, false, false},
    /* cheeks, brows, eyes, ears, horns */
    {{0.13, -0.1, 0.0}, {0.13, -0.1, 0.0}, {0.14, 0.14}, {1, 1, 1}, 0.08, true, false},
    {{0.12, -0.2, 0.2}, {0.19, -0.12, 0.18}, {0.06, 0.055}, {1, 1, 1}, 0.06, true, false},
    {{0.155, -0.215, 0.115}, {0.155, -0.215, 0.115}, {0.055, 0.055}, {1, 1, 1}, 0.02, true, false},
    {{0.2, 0.06, 0.24}, {0.43, 0.09, 0.36}, {0.085, 0.05}, {1, 0.6, 1}, 0.06, true, false},
    {{0.09, 0.0, 0.36}, {0.15, 0.1, 0.56}, {0.06, 0.035}, {1, 1, 1}, 0.05, true, false},
};

static const blend_part animal[] = {
    /* trunk, belly, neck, head, muzzle */
    {{0, -0.2, 0.04}, {0, 0.24, 0.05}, {0.17, 0.18}, {1, 1, 1}, 0, false, false},
    {{0, 0.03, -0.03}, {0, 0.03, -0.03}, {0.18, 0.18}, {1, 1.3, 1}, 0.1, false, false},
    {{0, -0.26, 0.1}, {0, -0.4, 0.3}, {0.13, 0.095}, {1, 1, 1}, 0.08, false, false},
    {{0, -0.44, 0.34}, {0, -0.44, 0.34}, {0.125, 0.125}, {1, 1.05, 0.95}, 0.06, false, false},
    {{0, -0.5, 0.32}, {0, -0.61, 0.28}, {0.085, 0.06}, {1, 1, 1}, 0.05, false, false},
    /* tail, fore legs, hind legs with their thighs, ears */
    {{0, 0.36, 0.12}, {0, 0.52, -0.08}, {0.05, 0.035}, {1, 1, 1}, 0.05, false, false},
    {{0.1, -0.22, -0.05}, {0.11, -0.23, -0.42}, {0.08, 0.055}, {1, 1, 1}, 0.06, true, false},
    {{0.11, 0.24, -0.02}, {0.11, 0.22, -0.12}, {0.115, 0.085}, {0.8, 1, 1}, 0.06, true, false},
    {{0.12, 0.22, -0.12}, {0.12, 0.26, -0.42}, {0.075, 0.055}, {1, 1, 1}, 0.04, true, false},
    {{0.08, -0.4, 0.43}, {0.14, -0.38, 0.5}, {0.045, 0.035}, {1, 1, 1}, 0.03, true, false},
};

static const blend_part liver[] = {
    /* right lobe with its tip, left lobe, caudate lobe; the hollow of the vessels and the bed of the gallbladder */
    {{-0.17, 0, 0.02}, {-0.17, 0, 0.02}, {1, 1}, {0.32, 0.27, 0.27}, 0, false, false},
    {{-0.24, 0.02, -0.08}, {-0.3, 0.04, -0.3}, {0.2, 0.1}, {1, 1, 1}, 0.12, false, false},
    {{-0.02, -0.04, 0.09}, {0.38, -0.07, 0.12}, {0.24, 0.12}, {1, 1, 0.7}, 0.14, false, false},
    {{0.02, 0.12, -0.02}, {0.02, 0.12, -0.06}, {0.1, 0.08}, {1, 1, 1}, 0.06, false, false},
    {{0.1, 0.02, -0.26}, {0.1, 0.02, -0.26}, {0.24, 0.24}, {1, 1, 1}, 0.08, false, true},
    {{-0.1, -0.3, -0.3}, {-0.04, -0.02, -0.22}, {0.07, 0.05}, {1, 1, 1}, 0.07, false, true},
};

typedef struct blend_body {
    const blend_part *parts;
    int part_count;
    double extent;   /* of the longest side of its box */
    double coarsest; /* edge that still shows every part, over the longest side */
} blend_body;

#define BODY(parts, extent, coarsest)                                                                                  \
    {                                                                                                                  \
        parts, sizeof(parts) / sizeof *(parts), extent, coarsest                                                       \
    }

static const blend_body bodies[] = {
    [PEL_BLEND_HEAD] = BODY(head, 1.23, 0.03),
    [PEL_BLEND_ANIMAL] = BODY(animal, 1.22, 0.03),
    [PEL_BLEND_LIVER] = BODY(liver, 0.96, 0.06),
};

/* ---- the joined distance ---- */

/* about the distance to a part, or to its mirror image, with its gradient */
static double part_distance(const blend_part *part, double side, const double point[3], double gradient[3])
{
    double along[3], from[3], least = HUGE_VAL;
    for (int i = 0; i < 3; i++) {
        double turn = i == 0 ? side : 1;
        from[i] = (turn * point[i] - part->from[i]) / part->squash[i];
        along[i] = (part->to[i] - part->from[i]) / part->squash[i];
        least = pel_min(least, part->squash[i]);
    }
    double length = pel_vec3_squared_length(along);
    double t = length > 0 ? pel_min(pel_max(pel_vec3_dot(from, along) / length, 0), 1) : 0;
    pel_vec3_along(from, -t, along, from);
    double distance = pel_vec3_normalize(from);
    for (int i = 0; i < 3; i++)
        gradient[i] = least * (i == 0 ? side : 1) * from[i] / part->squash[i];
    return least * (distance - part->radii[0] - t * (part->radii[1] - part->radii[0]));
}

/* the smooth minimum of a with b, or the smooth maximum of a with -b for a part that is carved out */
static double join(double a, double a_gradient[3], double b, double b_gradient[3], const blend_part *part)
{
    double sign = part->carved ? -1 : 1;
    a *= sign;
    double width = part->blend, share = 0.5, dip = 0;
    double apart = pel_max(width - fabs(a - b), 0);
    if (width > 0) {
        dip = apart * apart / (4 * width);
        share = 0.5 * apart / width;
    } else {
        share = 0;
    }
    /* the weight of the larger one */
    double weight = a < b ? share : 1 - share;
    for (int i = 0; i < 3; i++)
        a_gradient[i] = (1 - weight) * a_gradient[i] + sign * weight * b_gradient[i];
    return sign * (pel_min(a, b) - dip);
}

static double body_distance(const void *inner, const double point[3], double gradient[3])
{
    const blend_body *body = inner;
    double distance = part_distance(&body->parts[0], 1, point, gradient);
    for (int i = 1; i < body->part_count; i++)
        for (int side = 1; side >= (body->parts[i].mirrored ? -1 : 1); side -= 2) {
            double other[3], there = part_distance(&body->parts[i], side, point, other);
            distance = join(distance, gradient, there, other, &body->parts[i]);
        }
    return distance;
}

/* ---- the mesh ---- */

/* to its longest side, about the origin */
static void fit(pel_mesh *mesh, double size)
{
    double low[3], high[3], longest = 0;
    pel_mesh_box(mesh, low, high);
    for (int i = 0; i < 3; i++)
        longest = pel_max(longest, high[i] - low[i]);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            mesh->positions[v][i] = (mesh->positions[v][i] - 0.5 * (low[i] + high[i])) * size / longest;
}

pel_status pel_shape_blend(const pel_shape_def *def, pel_mesh **mesh, pel_error *error)
{
    /* finer edges are reached by splitting; a coarser lattice would join separate parts */
    const double finest_lattice = 0.02, coarsest_lattice = 0.03, finest = 5e-4;
    const blend_body *body = &bodies[def->body];
    double edge = def->edge / def->size;
    if (!(edge <= body->coarsest && edge >= finest)) {
        pel_fail(error, PEL_BAD_ARGUMENT, "blend: an edge of %g m does not suit a body of %g m", def->edge, def->size);
        pel_fail_remedy(error, "give an edge from %g to %g m", finest * def->size, body->coarsest * def->size);
        return PEL_BAD_ARGUMENT;
    }
    const pel_implicit surface = {body_distance, body, {-0.8, -0.8, -0.8}, {0.8, 0.8, 0.8}};
    double spacing = pel_min(pel_max(edge, finest_lattice), coarsest_lattice);
    pel_status status = pel_implicit_march(&surface, spacing * body->extent, mesh, error);
    if (status == PEL_OK)
        status = pel_implicit_remesh(&surface, edge * body->extent, mesh, error);
    if (status == PEL_OK)
        fit(*mesh, def->size);
    return status;
}
