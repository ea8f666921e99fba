/* Internal declarations of the forces of shells, shared by the files of this folder. */
#ifndef PEL_FORCE_SHELL_BODY_H
#define PEL_FORCE_SHELL_BODY_H

#include "force/shell_force.h"

typedef struct pel_shell_body {
    const pel_shell *shell; /* null = the body is no shell */
    int32_t body;
    int32_t first_place, place_count;
    int pressure_part;        /* which of the parts its pressure is; 0 = none */
    bool is_pushed;           /* a region has the mode PEL_FIBRE_NORMAL */
    const pel_batch *pressed; /* the batch of its pressure; null = none */
    double pressure;          /* Pa, positive inflates: of the last evaluation */
    /* of pel_shell_forces_list, else null */
    int32_t *element_begin; /* (place_count + 2) */
    int32_t *elements;      /* at a place: triangles, then hinges, counted from triangle_count on */
} pel_shell_body;

typedef enum pel_energy_column {
    PEL_ENERGY_MEMBRANE,
    PEL_ENERGY_BENDING,
    PEL_ENERGY_FIBRES,
    PEL_ENERGY_VOLUME,
    PEL_ENERGY_COLUMNS
} pel_energy_column;

struct pel_shell_forces {
    const pel_model *model;
    pel_batches *batches;
    pel_shell_body *bodies;                 /* (model body_count) */
    double (*energies)[PEL_ENERGY_COLUMNS]; /* (bundles) */
    pel_record *area_vectors;               /* (vertex_count) weighted, of the vertex-normal form: sums around a vertex,
                                               and of their lengths; null without that form */
    double *sums;                           /* (vertex_count) scratch of bounds */
    double load_factor;                     /* of given pressure */
    pel_plastic plastic;                    /* of the state; null = none */
};

/* hinge i of a shell with its fold */
static inline pel_shell_hinge pel_shell_hinge_now(const pel_shell_forces *forces, const pel_shell *shell, int32_t i)
{
    pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
    if (shell->yield_angles != NULL && forces->plastic.folds != NULL)
        hinge.fold = forces->plastic.folds[shell->first_fold + i].angle;
    return hinge;
}

static inline bool pel_shell_is_normal_form(const pel_shell *shell)
{
    return shell->pressure.kind != PEL_PRESSURE_NONE && shell->pressure.form == PEL_PRESSURE_VERTEX_NORMAL;
}

/* null when a body is no shell */
const pel_shell_body *pel_shell_body_of(const pel_shell_forces *forces, int32_t body);

/* ---- shell_lanes.c ---- */
/* Adds the forces of the blocks begin .. end - 1 of a batch to force (vertex_count), which may be null; returns their
   energy, 0 for a pressure. amount: rest length of fibres over that of the shape, stiffness of fibres that
   push [N/m], or the pressure [Pa]. */
double pel_shell_sweep(const pel_batch *batch, int32_t begin, int32_t end, const pel_record *position, double amount,
                       pel_record *force);
/* Adds the weighted area vectors of a pressure's triangles to those of their corners, and lengths to the fourth. */
void pel_shell_sweep_areas(const pel_batch *batch, int32_t begin, int32_t end, const pel_record *position,
                           pel_record *area_vectors);

/* The volume between the triangles of a pressure and a point, weights apart. */
double pel_shell_sweep_volumes(const pel_batch *batch, int32_t begin, int32_t end, const pel_record *position,
                               pel_record origin);

/* ---- shell_element.c ---- */
/* Energy of the membrane of triangle t and its gradient, which may be null. */
double pel_shell_membrane_energy(const pel_shell_forces *forces, const pel_shell_body *own, int32_t t,
                                 const double x[3][3], double gradient[3][3]);
/* The same of fibres i of a region in their triangle. */
double pel_shell_fibre_energy(const pel_shell *shell, const pel_shell_region *region, int32_t i, double time,
                              const double x[3][3], double gradient[3][3]);
/* fibres of a region that have an energy */
static inline int32_t pel_shell_fibre_count(const pel_shell_region *region)
{
    return pel_shell_region_is_elastic(region) ? region->fibre_count : 0;
}
/* fibres of a region in a triangle, -1 = none; sorted by triangle */
int32_t pel_shell_find_fibre(const pel_shell_region *region, int32_t triangle);
/* rest length of a region's fibres relative to the shape */
double pel_shell_fibre_amount(const pel_shell_region *region, double time);
/* Energy of a hinge over its factor, and its gradient, which may be null. */
double pel_shell_hinge_energy(const pel_shell *shell, const pel_record *rest, const pel_shell_hinge *hinge,
                              const double x[4][3], double gradient[4][3]);

#endif
