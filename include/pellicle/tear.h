/* Pellicle: cuts of a surface while it is simulated. */
#ifndef PELLICLE_TEAR_H
#define PELLICLE_TEAR_H

#include "sim_step.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Opens the surface of a body along a path of edges, between two steps. The path (vertex_count >= 2) names vertices
   that edges join; it runs through the surface, from a border, between borders, or comes back to its first vertex and
   cuts a piece out. Vertices on it are doubled: triangles keep their numbers and winding, vertices theirs, and copies
   come last in all arrays. A vertex of a path stands for all its copies, so a path may cross or touch an older cut;
   edges that are open already are skipped.

   Copies have the position and the velocity of their vertex (under contact of the surface with itself they move apart
   by a thousandth of the shortest edge at most, so that lips do not intersect; their mean place stays); its mass,
   volumetric spring, dampings, loads and elastic supports are divided among them by the areas around, and the spring on
   an edge by the areas beside its lips. So mass, momenta, kinetic energy and the energy of springs and membranes stay
   as they are; bending across the cut is released, and the ledger books it as dissipated_fracture. Pins, supports,
   grasps, regions and fields extend to the copies; loads per length do not act on lips. Snapshots contain the cuts, and
   loading one opens or closes the surface as it was.

   PEL_BAD_ARGUMENT leaves the simulation unchanged: vertices that do not exist or are joined by no edge; an edge of the
   border; a path that opens nothing (a single edge inside the surface); any body that refines; a path of balances or an
   analysis; lips that would intersect (pel_sim_cut_is_held); an enclosed gas or a target volume, which need a closed
   surface. PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_cut(pel_sim *sim, int32_t body, const int32_t *vertices, int32_t vertex_count, pel_error *error);

/* Number of cuts at given times (pel_sim_def), and of those that are made. */
PEL_API int32_t pel_sim_cut_count(const pel_sim *sim);
PEL_API int32_t pel_sim_cuts_done(const pel_sim *sim);

/* Whether the last cut that was tried is held back, because its lips would intersect: under contact with itself, where
   the surface is folded sharply. A cut at a given time is tried again before each step; the cuts after it wait. */
PEL_API bool pel_sim_cut_is_held(const pel_sim *sim);

/* State of the cuts of one body. */
typedef struct pel_cut_reading {
    double length;          /* m at rest, of edges that are open: half the length of their lips */
    int32_t copy_count;     /* vertices that are copies */
    int32_t island_count;   /* pieces that the cuts have parted from the others */
    int32_t released_count; /* vertices that have left their volumetric springs (adhesion) */
} pel_cut_reading;
/* Of a body; -1 = the sums over all bodies. PEL_BAD_ARGUMENT for a body that does not exist, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_sim_get_cuts(const pel_sim *sim, int32_t body, pel_cut_reading *reading, pel_error *error);
/* The end of a cut inside a surface. */
typedef struct pel_tip {
    int32_t body, vertex;
    double position[3]; /* m, at present */
    double ahead[3];    /* unit, in the rest shape: the direction of the last edge of the cut */
    double force[3];    /* N, configurational force in the rest shape: energy released per length by which the tip moves
                           on in its direction. Divided by the thickness it is the energy release rate [J/m2] */
    double release;     /* N, its magnitude */
    double rate;        /* J/m2, energy release rate: release over the thickness; NaN for springs without thickness */
} pel_tip;
/* The tips of a body in the order of their vertices: the first `room` of them, and the number of all. The force is a
   domain integral over four rings of triangles or more (docs/cuts.md), of membrane, fibres and springs; of a state in
   balance without forces on vertices, filling and contact within the rings, and away from other tips and borders. On
   flat parts of the rest shape it is exact up to the error of the elements. PEL_BAD_ARGUMENT, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_sim_tips(pel_sim *sim, int32_t body, pel_tip *tips, int32_t room, int32_t *count,
                                pel_error *error);

/* The hole that a tear opens around the axis of the first tool that leads one (pel_tool_def.leads), against the circle
   of that tool. All lengths are distances from the axis in the rest shape, across it. */
enum { PEL_HOLE_SECTORS = 72 };
typedef struct pel_hole_reading {
    double aim;                      /* m, radius of the circle */
    double along[3], across[3];      /* unit: sector k is around the direction cos(a) along + sin(a) across with
                                        a = 2 pi (k + 1/2) / PEL_HOLE_SECTORS; right-handed with the axis */
    double radius[PEL_HOLE_SECTORS]; /* m, farthest open edge in a sector; 0 = none beyond half of the aim */
    double swept;                    /* rad, all sectors with a radius */
    double diameter;       /* m, of the circle with the area of the sectors: of all once they are open, else twice the
                              mean radius; 0 = none is open */
    double offset;         /* m, of the centroid of the hole from the axis; NaN until all sectors are open */
    double roundness;      /* smallest over largest distance of the edge from that centroid; NaN likewise */
    double largest;        /* m, the largest radius; 0 = none */
    int32_t run_out_count; /* places where the edge is farther out than 1.15 times the aim: neighbours are one */
    bool is_whole;         /* all sectors are open and the piece within has come off */
} pel_hole_reading;
/* False, with a reading of zeros, if no tool leads a tear. */
PEL_API bool pel_sim_get_hole(const pel_sim *sim, pel_hole_reading *reading);

/* How a tear is led: by tools of the def (pel_tool_def.leads), and by others that take over from them. Snapshots
   contain it, so that undo and reset return to the score of that time. */
typedef struct pel_score {
    pel_hole_reading hole;
    double force_peak;   /* N, largest force on one tool so far */
    double force_rms;    /* N, root of the mean square over the steps in which a tool had a force; 0 = none yet */
    double time;         /* s, from the first to the last of these steps */
    int64_t touch_count; /* steps in which a tool was at the surface on the far side of the circle's centre, or behind
                            it: in an eye's lens the posterior capsule, which must stay whole */
} pel_score;
/* False, with a score of zeros, if no tool leads a tear. */
PEL_API bool pel_sim_get_score(const pel_sim *sim, pel_score *score);

/* Whether the surface of any body may open: it has a toughness, or the def has cuts or tools with an edge. */
PEL_API bool pel_sim_can_tear(const pel_sim *sim);

/* (pel_sim_vertex_count) the vertex before all cuts that each vertex is a copy of, itself if it is none. */
PEL_API void pel_sim_get_origins(const pel_sim *sim, int32_t body, int32_t *origins);

#ifdef __cplusplus
}
#endif
#endif
