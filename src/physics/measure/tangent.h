/* Energy, gradient and Hessian of single elements in double, for Newton's method.

   An element is a measure and a law: strains s(x), energy E(s), stress t = dE/ds, tangent D = d2E/ds2, B = ds/dx, with

       gradient = B^T t,     Hessian = B^T D B + sum_i t_i Hess s_i

   The stress of the second, geometric part is an argument of its own. With the stress of x the Hessian is exact. With
   stresses extrapolated from the last iterate x0 = x - step, t + D B step taken at x0, it is that of mixed integration
   points (MIP; Magisano, Leonetti, Garcea 2017): Newton's method then takes large steps where membrane and bending
   stiffness differ much, and still converges quadratically.

   Points x and rows of gradients are flat arrays of 3 numbers a vertex. Theory page, sections 3 to 6 and 16. */
#ifndef PEL_MEASURE_TANGENT_H
#define PEL_MEASURE_TANGENT_H

#include "measure/element.h"
#include "measure/fold.h"
#include "pellicle/bending.h"

typedef enum pel_tangent_kind {
    PEL_TANGENT_EXACT,   /* the second derivative; MIP with given stresses */
    PEL_TANGENT_POSITIVE /* positive semi-definite: membranes with D+ and the tensile part of the stress, bending
                            without its geometric part (Gauss-Newton), no pressure */
} pel_tangent_kind;

/* strains of the elements with one and the most unknowns */
enum { PEL_MEMBRANE_STRAINS = 3, PEL_LINE_STRAINS = 1, PEL_HINGE_STRAINS = 1, PEL_TANGENT_UNKNOWNS = 12 };
/* numbers of a strain in a viscous element: the strain s_0 that its rate refers to, and a row of V */
enum { PEL_VISCOUS_NUMBERS = 4 };

/* Parts to compute; all zero: the exact Hessian. A viscous element (Kelvin and Voigt) has the stress V rate (s - s_0)
   as well, and half of its product with s - s_0 in its energy. */
typedef struct pel_tangent_request {
    pel_tangent_kind kind;
    const double *stress; /* (strains) stresses of the geometric part [J]; null = stresses at x */
    /* extrapolates: writes t + D B step to `extrapolated` (strains); both null = not asked for */
    const double *step; /* (unknowns) */
    double *extrapolated;
    const double *viscous; /* (strains x PEL_VISCOUS_NUMBERS); null = elastic */
    double rate;           /* 1/s */
    double *strain;        /* (strains x PEL_VISCOUS_NUMBERS) gets s and D; null = not asked for */
} pel_tangent_request;

/* Where an element adds its derivatives; null = not asked for. The Hessian is symmetric, all of it is written. */
typedef struct pel_tangent_sum {
    double *gradient; /* (unknowns) */
    double *hessian;  /* (unknowns x unknowns) in rows of `stride` */
    int stride;
} pel_tangent_sum;

/* Each function adds the element's derivatives and returns its energy [J]. */

/* Membrane triangle of any law, x (9). Below an area ratio of 0.01 laws continue as tangents (pellicle/material.h): the
   gradient stays exact there, the Hessian is an approximation. */
double pel_membrane_tangent(const pel_rest_triangle *rest, const pel_membrane_law *law, const double *x,
                            const pel_tangent_request *request, const pel_tangent_sum *sum);

/* Energy of y = sum_a weight[a] x_a: springs, fibres, isometric bending. */
typedef enum pel_line_kind {
    PEL_LINE_LENGTH, /* k/2 (|y| - rest)^2 */
    PEL_LINE_SQUARE, /* k/2 (|y|^2 - 1)^2 */
    PEL_LINE_VECTOR, /* k/2 |y|^2: constant Hessian, no stress */
    PEL_LINE_MUSCLE  /* k times the energy of a muscle (law/fibre.h), with `rest` as its optimum */
} pel_line_kind;

typedef struct pel_line {
    pel_line_kind kind;
    int count;        /* vertices, 2 to 4 */
    double weight[4]; /* sum to 0 */
    double stiffness, rest;
    double width; /* of a muscle */
} pel_line;

/* x (3 count). A line of length 0 has no direction: PEL_LINE_LENGTH then adds nothing but its energy. */
double pel_line_tangent(const pel_line *line, const double *x, const pel_tangent_request *request,
                        const pel_tangent_sum *sum);

/* The line of a spring between two vertices, of a fibre (stiffness [N/m] and rest length as in pellicle/material.h;
   squared: PEL_FIBRE_STVK), of isometric bending with the bending stiffness D [N m]. */
pel_line pel_line_of_spring(double stiffness, double rest_length);
pel_line pel_line_of_fibre(const pel_rest_triangle *rest, bool squared, double stiffness, double rest_length,
                           const double direction[2]);
/* of a muscle, whose stiffness is its activation times its tension */
pel_line pel_line_of_muscle(const pel_rest_triangle *rest, double stiffness, double optimum, double width,
                            const double direction[2]);
pel_line pel_line_of_isometric(const pel_bending_isometric *stencil, double stiffness);

/* An angle less that at rest, the short way round [rad]. */
double pel_angle_the_short_way(double angle, double rest_angle);
/* The same of the dihedral angle of four points (12). */
double pel_angle_from_rest(const double *x, double rest_angle);

/* Hinge of the bending stiffness D [N m], x (12) as in pellicle/bending.h. */
double pel_hinge_tangent(const pel_hinge *hinge, double stiffness, const double *x, const pel_tangent_request *request,
                         const pel_tangent_sum *sum);
/* The same of a hinge that yields (measure/fold.h). */
double pel_fold_tangent(const pel_hinge *hinge, const pel_yield *yield, double stiffness, const double *x,
                        const pel_tangent_request *request, const pel_tangent_sum *sum);

/* Pressure on the back of a triangle (positive inflates), x (9): gradient minus pel_triangle_pressure_force on each
   corner. The Hessian is the symmetric part of its derivative, which is the exact one summed over a closed surface or
   one whose border is fixed. The energy belongs to the volume and is not in the sum: returns -pressure times the volume
   between the triangle and the origin. */
double pel_pressure_tangent(double pressure, const double *x, const pel_tangent_request *request,
                            const pel_tangent_sum *sum);

/* Push of a fibre of a triangle, x (9), along the inward unit normal: `scale` [1/m] times its energy where it is
   shorter than at rest, on each corner (PEL_FIBRE_NORMAL). The Hessian is the symmetric part of the derivative. Returns
   0: the push has no potential. */
double pel_push_tangent(const pel_line *fibre, double scale, const double *x, const pel_tangent_request *request,
                        const pel_tangent_sum *sum);

#endif
