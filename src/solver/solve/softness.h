/* How much softer xpbd is than the material.

   One sweep in a substep solves (D + a) dl = -(C + g u0 + L dl) for the multipliers l, with A = g^T M^-1 g = L + D +
   L^T, a = 1 / (k tau^2) and u0 the displacement by external forces. At rest the displacements of a substep cancel, g
   u0 = -A l, and D with them:

       (a - L^T) l = -C      instead of the material's      a l = -C

   so the work of the forces f = l / tau^2 on the strain C exceeds that of the material by the share

       s = tau^2 / 2 (sum over elements of f^T D f - sum over vertices of |f_external|^2 / m) / sum of f^2 / k

   with D the mobility of an element, sum |gradient|^2 / m over its vertices. The second sum vanishes in smooth fields.
   What remains is the mean of D k over the elements, weighted with energy. The rate here takes the worst strain of each
   element and means over the two rings of triangles around each vertex; all but 5 % of the energy of a level of detail
   lie below it, in every kind of element. So a stiff or fine region counts, also a refined one of few vertices; the few
   smallest triangles of a scan do not. tau is the substep in first order, two thirds of it in second order.

   A single sweep takes this back: with a - D / 2 in place of a (project_kernel.h) the mean of a - D / 2 - L^T over the
   elements is that of a. What is left is of the second order in s, and the second sum: too stiff by as much as
   forces on few light vertices move these in half a substep. As a - D / 2 must not vanish, at most half of a is taken
   off, and s - 1/2 is left of a large s. s^2 / (s + 1/2) bounds both; measured: 0.0002 to 0.007 of s = 0.19, 0.03 to
   0.15 of s = 0.5, s - 0.5 to s - 1 above.

   More sweeps solve for the same l with the iteration matrix s / (1 + s): the softness after n sweeps is
   1 / (1 - (s / (1 + s))^n) - 1, about s / n where s is large; nothing is taken off there. Measured: docs/shells.md. */
#ifndef PEL_SOLVE_SOFTNESS_H
#define PEL_SOLVE_SOFTNESS_H

#include "base/pool.h"
#include "model/state.h"

/* the share of a that a single sweep takes off at most */
#define PEL_MOST_CORRECTION 0.5

/* numbers of one model at one state [1/s2] */
typedef struct pel_softness {
    double rate;     /* s = rate tau^2 / 2 */
    double pressure; /* stiffness over mass of forces that stay at their start during a substep (gas, target volume) */
} pel_softness;

/* Room for looks at a model, refined ones included. */
typedef struct pel_softness_scratch {
    double *energy, *excess; /* (vertex_count) of the elements at a vertex; excess: energy times rate. They stay from
                                one part of a look to the next */
    double *mean;            /* (vertex_count) of the rate, around a vertex; with sum also the samples of a part */
    double *sum;             /* (vertex_count) right behind mean */
    double *own;             /* what the caller did not lend */
} pel_softness_scratch;

/* A look in parts, which are spread over steps. The elements of a part count as they are then. */
typedef struct pel_softness_progress {
    int64_t done; /* elements; 0 begins a look */
    pel_softness found;
} pel_softness_progress;

/* lent: room of the caller for 2 vertex_count numbers, which each part of a look overwrites and which has to live on;
   null = it makes its own. PEL_OUT_OF_MEMORY. */
pel_status pel_softness_create(const pel_model *model, double *lent, pel_softness_scratch *scratch, pel_error *error);
void pel_softness_destroy(pel_softness_scratch *scratch);

/* elements of a whole look */
int64_t pel_softness_size(const pel_model *model);
/* Goes on with a look at springs and shells at state->position, with the present factors of keyed parameters, up to the
   element `end`; at pel_softness_size, progress->found is complete. time [s]: of keyed pressure. pool: null = one
   thread; same bits for any number. */
void pel_softness_look(const pel_model *model, const pel_state *state, double time, pel_pool *pool, int64_t end,
                       const pel_softness_scratch *scratch, pel_softness_progress *progress);

/* Softness that is left after `iterations` sweeps in a substep whose tau^2 rate / 2 is `share`. */
double pel_softness_after(double share, int32_t iterations);
/* The share at which it is `softness`; the inverse of pel_softness_after. */
double pel_softness_share(double softness, int32_t iterations);

#endif
