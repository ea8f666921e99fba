/* The bodies of a run as one surface: frames and the final mesh. */
#ifndef PEL_RESULTS_SURFACE_H
#define PEL_RESULTS_SURFACE_H

#include "pellicle/results.h"
#include "pellicle/scene.h"

/* All buffers are allocated once, so that writing a frame needs only the memory of the file; they are allocated again
   when a body has refined or coarsened. */
typedef struct pel_run_surface {
    int32_t vertex_count, triangle_count, body_count, field_count;
    int32_t *begin;        /* (body_count + 1) first vertex of each body */
    int32_t *triangles;    /* (triangle_count x 3) */
    double *rest;          /* (vertex_count x 3) */
    double *positions;     /* (vertex_count x 3) */
    double *scratch;       /* (vertex_count x 3) */
    int32_t *row_numbers;  /* (vertex_count) scratch */
    pel_vtp_field *fields; /* (field_count), with their own values */
    int *sources; /* (field_count) of pellicle/observe.h, or larger numbers for fields that change with the surface only
                   */
    int32_t cell_field_count;
    pel_vtp_field *cell_fields; /* (cell_field_count) on triangles, with their own values */
    int *cell_sources;          /* (cell_field_count) */
    pel_vtp_writer *writer;
    double time;      /* s, of the last reading */
    int64_t revision; /* of the bodies' surfaces, summed up */
} pel_run_surface;

/* Fields: those of pellicle/observe.h, those of the meshes, with several bodies always `body` (its number), and with
   bodies that refine `level` (the finest of the triangles at the vertex) and the place of a vertex in the body's mesh:
   the `mesh_vertices` of a triangle, whose `mesh_weights` give it. PEL_BAD_SCENE names an unknown field. Destroy also
   on failure. */
pel_status pel_run_surface_create(const pel_sim *sim, const pel_output_def *output, pel_run_surface *surface,
                                  pel_error *error);
void pel_run_surface_destroy(pel_run_surface *surface);

/* Copies positions and fields of the simulation, which may continue before they are written. PEL_OUT_OF_MEMORY. */
pel_status pel_run_surface_read(pel_run_surface *surface, pel_sim *sim, pel_error *error);
/* whether float positions would lose 1e-5 of their extent, as far from the origin */
bool pel_positions_need_double(const double *positions, int32_t vertex_count);
/* Writes the last reading, in double if asked for or needed. */
pel_status pel_run_surface_write(pel_run_surface *surface, const pel_output_def *output, const char *path,
                                 pel_error *error);

/* The same as a mesh file with the fields of the bodies' meshes. */
pel_status pel_run_surface_write_final(pel_run_surface *surface, const pel_sim *sim, const char *path,
                                       pel_error *error);

/* Pairs of triangles that cut or touch each other, within and between bodies. PEL_OUT_OF_MEMORY. */
pel_status pel_run_surface_intersections(pel_run_surface *surface, const pel_sim *sim, int64_t *count,
                                         pel_error *error);

#endif
