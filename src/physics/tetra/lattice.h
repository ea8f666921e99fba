/* A body-centred cubic lattice over the box of a surface: which nodes are inside, and where its edges cross the
   surface.

   Nodes are the corners of cells, then the centres of cells. Edges are long, between neighbours of one kind along an
   axis, or short, between a centre and the corners of its cell. One layer of cells lies around the box. */
#ifndef PEL_TETRA_LATTICE_H
#define PEL_TETRA_LATTICE_H

#include "base/assert.h"
#include "bvh/mesh_query.h"
#include "bvh/tree.h"

enum { PEL_LATTICE_DEGREE = 14, PEL_LATTICE_MOST_CELLS = 1000000 };

typedef struct pel_lattice {
    int32_t cells[3]; /* with the layer around */
    int32_t corner_count, node_count;
    double low[3], spacing[3];
    double (*positions)[3]; /* (node_count) */
    int8_t *signs;          /* (node_count) 1 inside, -1 outside, 0 on the surface */
    int32_t *cuts;          /* (edges) number of the cut plus 1; 0 = none */
    int32_t cut_count;
    double (*cut_positions)[3]; /* (cut_count) */
    size_t cut_room;
} pel_lattice;

/* Lays a lattice around a closed surface, finds where it crosses it, and moves nodes that are too near a crossing on
   to it. PEL_OUT_OF_MEMORY. */
pel_status pel_lattice_create(const pel_mesh *surface, double edge, pel_lattice *lattice, pel_error *error);
void pel_lattice_destroy(pel_lattice *lattice);

/* Cells that a lattice has, with the layer around. */
double pel_lattice_cells(const double low[3], const double high[3], double edge, int32_t cells[3]);

/* The cut of an edge between two nodes, -1 = none. */
int32_t pel_lattice_cut(const pel_lattice *lattice, int32_t a, int32_t b);

/* True for an edge between two corners or two centres. */
static inline bool pel_lattice_is_long(const pel_lattice *lattice, int32_t a, int32_t b)
{
    return (a < lattice->corner_count) == (b < lattice->corner_count);
}

/* The cell, or the place among the corners, of a node. */
void pel_lattice_place(const pel_lattice *lattice, int32_t node, int32_t place[3]);

/* Node numbers, of places inside the lattice. */
int32_t pel_lattice_corner(const pel_lattice *lattice, int32_t x, int32_t y, int32_t z);
int32_t pel_lattice_centre(const pel_lattice *lattice, int32_t x, int32_t y, int32_t z);

#endif
