/* Energy, gradient and element matrices of all elastic elements of a model, for implicit and static methods: membranes,
   fibres, bending (hinge, isometric, mid-edge), pressure, the springs of paper A, and springs to points of the caller's
   (inertia, drag, soft grasps).

   Unknowns are one array in double, whatever pel_real is: 3 for each vertex in the model's order (padding included),
   then one for each edge of mid-edge bending. The unknown of an edge is xi in `unknowns`, and psi in a gradient, a step
   and the matrices (measure/midedge.h): pel_tangent_advance adds a step.

   Nodes are vertices (3 unknowns) and, from vertex_count on, edges (1 unknown). An element lists its vertices, then its
   edges; its matrix is dense and symmetric over their unknowns in this order. Every vertex in use has its own element,
   which may be zero. The pattern changes only with the surface; linear/matrix.h assembles it with
   pel_tangent_matrices. */
#ifndef PEL_FORCE_TANGENT_H
#define PEL_FORCE_TANGENT_H

#include "base/pool.h"
#include "measure/tangent.h"
#include "model/state.h"

/* The sum of a gas or a kept volume over a body: the Hessian has coefficient g g^T beside the element matrices, with
   the gradient g of the volume on the vertices first_vertex .. first_vertex + vertex_count - 1. */
typedef struct pel_rank_one {
    double coefficient; /* J/m6, >= 0; 0 = nothing to add */
    int32_t first_vertex, vertex_count;
    double *gradient; /* (3 vertex_count) m2 */
} pel_rank_one;

typedef struct pel_tangent_pattern {
    int32_t vertex_count, edge_count;
    int32_t unknown_count; /* 3 vertex_count + edge_count */
    int32_t element_count;
    const int32_t *node_begin;   /* (element_count + 1) */
    const int32_t *nodes;        /* (node_begin[element_count]) */
    const uint8_t *element_kind; /* (element_count) elements of one kind have one number of nodes and one code */
    int32_t stress_count;        /* numbers that pel_tangent_extrapolate writes */
    int32_t edge_limit, unknown_limit, stress_limit; /* most of them on any surface of the model */
    int32_t rank_one_count;
    const pel_rank_one *rank_ones; /* (rank_one_count) of the last evaluation with a gradient */
} pel_tangent_pattern;

/* An edge of mid-edge bending. */
typedef struct pel_tangent_edge {
    int32_t vertices[4];  /* ends, tips of the first and second triangle; as in pellicle/bending.h */
    int32_t triangles[2]; /* of the body's shell; the second is -1 on the boundary */
    int32_t body;
    double rest_angle; /* 0 on the boundary */
} pel_tangent_edge;

typedef struct pel_tangent pel_tangent;

/* Errors: PEL_BAD_ARGUMENT for bending without a stiffness; PEL_OUT_OF_MEMORY. */
pel_status pel_tangent_create(const pel_model *model, pel_tangent **tangent, pel_error *error);
void pel_tangent_destroy(pel_tangent *tangent);
/* After the surface of the model has changed: rebuilds all lists, without allocation. */
void pel_tangent_rebuild(pel_tangent *tangent);

const pel_tangent_pattern *pel_tangent_pattern_of(const pel_tangent *tangent);
/* (edge_count) */
const pel_tangent_edge *pel_tangent_edges_of(const pel_tangent *tangent);

typedef struct pel_tangent_input {
    const double *unknowns; /* (unknown_count) */
    pel_span span;          /* of keyed pressure; other curves have their value at its time */
    const pel_state *state; /* factors of keyed parameters; null = 1 */
    pel_tangent_kind kind;
    const double *stresses; /* (stress_count) of the geometric parts, see pel_tangent_extrapolate; null = own */
    /* springs of stiffness k to points: energy k/2 |x - point|^2 for each vertex; both null = none */
    const double *point_stiffness; /* (vertex_count) N/m */
    const double (*points)[3];     /* (vertex_count) */
    const double *load_factor;     /* of given pressure; null = 1 */
    bool leaves_followers;         /* without pressure that has no potential */
    const double *viscous; /* (stress_count x PEL_VISCOUS_NUMBERS) see pel_tangent_refer_rates; null = elastic */
    double rate;           /* 1/s, of strains less those that their rates refer to */
} pel_tangent_input;

typedef struct pel_tangent_energy {
    double membrane, volume, fibres, bending, springs, points;
    double edges;    /* mid-edge bending; `bending` is of hinges */
    double pressure; /* where it is conservative (pel_pressure_is_conservative), else 0 */
} pel_tangent_energy;

/* Evaluates at the input; gradient (unknown_count) may be null. Same bits for any number of threads. */
pel_tangent_energy pel_tangent_evaluate(pel_tangent *tangent, const pel_tangent_input *input, pel_pool *pool,
                                        double *gradient);

/* y += the sum of coefficient g (g . x) over the rank ones, on unknowns (unknown_count) that are not fixed. */
void pel_tangent_add_rank_ones(const pel_tangent_pattern *pattern, const uint8_t *fixed, const double *x, double *y);

/* Derivatives of m . gradient of one body: by factors, 1 at present, of the stiffness of membranes, of bending (D) and
   of the pressure; by Poisson's ratio at constant D; by a factor of the stiffness of
   tetrahedra. */
typedef struct pel_tangent_derivative {
    double membrane, bending, pressure, poisson, volume;
} pel_tangent_derivative;

/* Adds the derivatives of m . g, with m (unknown_count) and the gradient g of the last evaluation: to bodies
   (body_count), and derivatives by rest positions to rest (3 vertex_count; null = skip), without directions of fibres,
   volumes at rest and springs. Membranes and mid-edge bending. */
void pel_tangent_derivatives(const pel_tangent *tangent, const double *m, pel_tangent_derivative *bodies, double *rest);

/* Matrices of `count` elements at the input of the last evaluation, whose arrays have to live: blocks (count x n x n)
   for elements of n unknowns, all of one kind. From any number of threads at once; has the form of a
   pel_matrix_function. Pressure in the vertex-normal form has the matrices of the consistent form. */
void pel_tangent_matrices(void *tangent, const int32_t *elements, int32_t count, double *blocks);

/* The sum of an energy's parts. */
double pel_tangent_energy_sum(const pel_tangent_energy *energy);

/* MIP: stresses (stress_count) at the input plus their linear change over a step (unknown_count), for the matrices of
   the evaluation at the end of the step: before it, or after it where its input has the array. */
void pel_tangent_extrapolate(pel_tangent *tangent, const pel_tangent_input *input, const double *step, pel_pool *pool,
                             double *stresses);

/* true if the material of a body resists rates of strain: members `retardation` of shells and bodies. */
bool pel_tangent_is_viscous(const pel_tangent *tangent);
/* What rates of strain refer to, to viscous (stress_count x PEL_VISCOUS_NUMBERS): `weight` times the strains at the
   input, and the retardation times the positive stiffness there. Another state then adds its weighted strains. */
void pel_tangent_refer_rates(pel_tangent *tangent, const pel_tangent_input *input, double weight, bool is_other,
                             pel_pool *pool, double *viscous);
/* J: viscous dissipation during 1 / rate; the input has `viscous`. */
double pel_tangent_viscous_loss(pel_tangent *tangent, const pel_tangent_input *input, pel_pool *pool);

/* unknowns + scale step: positions are added, xi takes psi and the finite turns of its triangles. */
void pel_tangent_advance(pel_tangent *tangent, double *unknowns, const double *step, double scale, pel_pool *pool);

/* Sets xi to the minimum of the bending energy at the given positions, for methods without unknowns on edges and after
   the surface has changed: conjugate gradients on a matrix that does not depend on the positions. is_fixed
   (edge_count): edges that keep their xi; null = none. Relative residual 1e-12. Returns the number of iterations. */
int pel_tangent_settle_edges(pel_tangent *tangent, double *unknowns, const uint8_t *is_fixed);

/* Sets xi of fixed edges so that their normals are those at rest, carried along with the direction of the edge. */
void pel_tangent_clamp_edges(pel_tangent *tangent, double *unknowns, const uint8_t *is_fixed);

/* Sets fibre directions that follow the state (PEL_FIBRE_PRINCIPAL) from these positions. */
void pel_tangent_follow(pel_tangent *tangent, const double *unknowns);

#endif
