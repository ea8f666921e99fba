/* Pellicle: check of a mesh (defects, counts and sizes), and its repair. */
#ifndef PELLICLE_MESH_CHECK_H
#define PELLICLE_MESH_CHECK_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Kinds of defects. Each comment names the element and `related`, the contents of the lists of pel_issue. */
typedef enum pel_issue_kind {
    PEL_ISSUE_BAD_INDEX,           /* triangle with an index outside 0 .. vertex_count - 1; related: corner, index */
    PEL_ISSUE_NOT_FINITE,          /* vertex with a coordinate that is NaN or infinite */
    PEL_ISSUE_REPEATED_VERTEX,     /* triangle with a vertex twice; related: that vertex */
    PEL_ISSUE_ZERO_AREA,           /* triangle lower than PEL_FLAT_TRIANGLE times its longest edge */
    PEL_ISSUE_DUPLICATE_TRIANGLE,  /* triangle with the same vertices as an earlier one (in any order); related: that */
    PEL_ISSUE_NON_MANIFOLD_EDGE,   /* edge in more than two triangles; related: its vertices */
    PEL_ISSUE_NON_MANIFOLD_VERTEX, /* vertex whose triangles form more than one fan */
    PEL_ISSUE_INCONSISTENT_WINDING, /* edge between two triangles of opposite winding; related: its vertices */
    PEL_ISSUE_NON_ORIENTABLE, /* component like a Moebius strip; element: its first triangle; related: component */
    PEL_ISSUE_INSIDE_OUT,     /* closed component that faces inward; element: its first triangle; related: component */
    PEL_ISSUE_DUPLICATE_VERTEX, /* vertex at exactly the position of an earlier one; related: that vertex */
    PEL_ISSUE_ISOLATED_VERTEX,  /* vertex in no triangle */
    PEL_ISSUE_BOUNDARY_EDGE,    /* edge in only one triangle; related: its vertices */
    PEL_ISSUE_COUNT
} pel_issue_kind;

typedef enum pel_severity {
    PEL_SEVERITY_NOTE,    /* normal for some meshes */
    PEL_SEVERITY_WARNING, /* can be simulated, but is probably not intended */
    PEL_SEVERITY_ERROR    /* cannot be simulated */
} pel_severity;

/* Description of a kind of issue. Lives forever. */
typedef struct pel_issue_info {
    pel_issue_kind kind;
    const char *name;         /* "non-manifold-edge", ... */
    const char *element_kind; /* "vertex", "triangle", "edge" or "component" */
    pel_severity severity;
    const char *doc;    /* the defect, one sentence without a full stop */
    const char *remedy; /* the remedy, one sentence without a full stop */
    bool repairable;    /* pel_mesh_repair removes it. Exceptions: windings of non-orientable components, and duplicate
                           vertices of non-manifold vertices and edges that were split */
} pel_issue_info;

/* Null for a kind that does not exist. */
PEL_API const pel_issue_info *pel_issue_info_of(pel_issue_kind kind);

/* A triangle whose height is at most this times its longest edge counts as a triangle without area. */
#define PEL_FLAT_TRIANGLE 1e-10

/* Maximum number of listed elements per kind; counts are always exact. */
#define PEL_ISSUE_LIST_LIMIT 1000

/* The defects of one kind, by ascending element. Edges are numbered as in pel_topology (by their first half-edge). */
typedef struct pel_issue {
    int32_t count;         /* of all defects of this kind */
    int32_t listed_count;  /* min(count, PEL_ISSUE_LIST_LIMIT) */
    int32_t *elements;     /* (listed_count) */
    int32_t (*related)[2]; /* (listed_count x 2) see pel_issue_kind; -1 = nothing */
} pel_issue;

/* A part of the surface that is connected across edges. Components are numbered by their first triangle. A vertex that
   several fans share counts once for each fan. */
typedef struct pel_mesh_component {
    int32_t first_triangle;
    int32_t vertex_count, edge_count, triangle_count;
    int32_t boundary_edge_count, boundary_loop_count;
    int32_t euler_characteristic;
    int32_t genus;   /* number of handles; -1 if the component is not manifold or not orientable */
    bool closed;     /* every edge in exactly two triangles */
    bool manifold;   /* no edge in more than two triangles */
    bool oriented;   /* no two triangles of opposite winding at an edge */
    bool orientable; /* reversing triangles can make it oriented; only tested if manifold */
    double area;     /* m2 */
    double volume;   /* m3, positive if its triangles face outward; 0 unless closed and oriented */
} pel_mesh_component;

/* The results of pel_mesh_check. Triangles with bad indices or repeated vertices count in triangle_count, but not in
   edges, components and statistics. Triangles with a vertex that is not finite do not count in lengths, areas and
   volumes. */
typedef struct pel_mesh_report {
    pel_issue issues[PEL_ISSUE_COUNT];
    int64_t error_count, warning_count; /* findings of that severity */

    int32_t vertex_count, triangle_count, edge_count;
    int32_t boundary_loop_count;
    int32_t component_count;
    pel_mesh_component *components; /* (component_count) */
    int32_t euler_characteristic;   /* used vertices - edges + triangles */
    int32_t genus;                  /* sum over the components; -1 if that of a component is -1 */
    bool closed;                    /* at least one triangle and no boundary edge */
    bool manifold;                  /* no bad index, repeated vertex, non-manifold edge or vertex */
    bool oriented;                  /* no inconsistent winding */

    double area;          /* m2 */
    double volume;        /* m3, sum over the components (each about its own point) */
    double bounds_low[3]; /* m, of the finite vertices; zero if there are none */
    double bounds_high[3];
    double edge_length_min, edge_length_median, edge_length_mean, edge_length_max; /* m */
    double quality_min, quality_mean; /* 4 sqrt(3) area / (sum of squared edges): 1 = equilateral, 0 = no area */
    int32_t worst_triangle;           /* the first with quality_min; -1 = none */
    int32_t valence_min, valence_max; /* edges per used vertex */
    double valence_mean;
} pel_mesh_report;

/* Checks a mesh in near-linear time; the same mesh gives the same report. The mesh may contain anything (bad indices,
   NaN, infinities, no vertices): the report lists such defects, and the call succeeds. PEL_BAD_ARGUMENT for counts
   below 0 and for more than 2^31 / 3 triangles. On failure *report is null. Free with pel_mesh_report_destroy. */
PEL_API pel_status pel_mesh_check(const pel_mesh *mesh, pel_mesh_report **report, pel_error *error);

/* Frees a report; null is permitted. */
PEL_API void pel_mesh_report_destroy(pel_mesh_report *report);

/* Steps of a repair. Null options mean the defaults: all steps, tolerance 0. */
typedef struct pel_repair_options {
    bool weld;             /* merges vertices at the same position; keeps position and fields of the first */
    double weld_tolerance; /* m; vertices that are linked by steps of at most this are merged; 0 = exactly equal */
    bool drop_degenerate;  /* removes triangles with a vertex twice or without area (see PEL_FLAT_TRIANGLE) */
    bool drop_duplicates;  /* removes all but the first of several triangles with the same three vertices */
    bool close_slits;    /* with drop_degenerate: a triangle without area whose third corner lies on its longest edge is
                            merged into its neighbour there, which is split at that corner. No vertex moves */
    bool cut;            /* splits non-manifold vertices and edges by duplicating vertices. Of several triangles at an
                            edge, those that enclose the same body stay connected; the others get a boundary */
    int32_t drop_parts;  /* removes parts of at most this many triangles, but never the largest part (the first of
                            several equal ones); a part is connected across edges after welding. 0 (default): none */
    bool drop_isolated;  /* removes vertices in no triangle (vertices that are not finite are always removed) */
    bool orient;         /* gives each component the winding of most of its triangles */
    bool outward;        /* turns closed components outward, also the inner walls of hollow bodies */
    int32_t *vertex_map; /* (vertex_count) receives the new number of each vertex, -1 = removed; nullable */
} pel_repair_options;

PEL_API pel_repair_options pel_repair_options_default(void);

/* Summary of a repair. */
typedef struct pel_repair_summary {
    int32_t bad_triangles;        /* removed: bad index or a vertex that is not finite */
    int32_t degenerate_triangles; /* removed */
    int32_t duplicate_triangles;  /* removed */
    int32_t welded_vertices;      /* merged into an earlier vertex */
    int32_t dropped_parts;        /* removed, see drop_parts; their vertices do not count as isolated */
    int32_t isolated_vertices;    /* removed */
    int32_t closed_slits;         /* triangles without area, merged into their neighbours */
    int32_t cut_vertices;         /* copies of vertices, for fans that were split */
    int32_t turned_triangles;     /* winding reversed */
    int32_t outward_components;   /* closed components turned outward as a whole */
    int32_t non_orientable;       /* components that have no consistent winding */
    bool changed;                 /* the repaired mesh differs from the input */
} pel_repair_summary;

/* Makes a repaired copy: removes triangles with bad indices or vertices that are not finite, then applies the options
   in this order: weld, drop, close, drop parts, cut, orient. Vertices and triangles keep their order, copies of
   vertices come last, and fields are kept. A second repair changes nothing, unless the first one split edges or
   vertices. An edge in more than two triangles remains if two parts of the surface share both its vertices on every
   path around it (pel_mesh_check of the result lists it). PEL_BAD_MESH if no triangle remains; PEL_BAD_ARGUMENT for a
   tolerance that is negative, smaller than the resolution of the coordinates, or larger than a twentieth of the mesh's
   size, and for drop_parts below 0. summary is nullable. On failure *repaired is null. */
PEL_API pel_status pel_mesh_repair(const pel_mesh *mesh, const pel_repair_options *options, pel_mesh **repaired,
                                   pel_repair_summary *summary, pel_error *error);

/* Summary of pel_mesh_fill_holes. */
typedef struct pel_fill_summary {
    int32_t filled_holes;
    int32_t left_holes; /* not filled: more edges than the limit, or not closable by triangles */
    int32_t triangles;  /* added */
    double quality_min; /* of the added triangles: 1 = equilateral, 0 = no area; 1 if there are none */
} pel_fill_summary;

/* Fills the holes of an oriented manifold whose rims have at most edge_limit (>= 3) edges, without new vertices. Of all
   triangulations of a rim of up to 160 edges, takes the one with the smallest bend between neighbours, then the
   smallest area (Liepa 2003, "Filling holes in meshes"); longer rims are first divided along short chords. The existing
   triangles come first; fields are kept. The rim of an open surface counts as a hole. To turn the closed components
   outward, call pel_mesh_repair afterwards. Errors: PEL_BAD_ARGUMENT, PEL_BAD_MESH as pel_topology_create,
   PEL_OUT_OF_MEMORY. On failure *filled is null. summary is nullable. */
PEL_API pel_status pel_mesh_fill_holes(const pel_mesh *mesh, int32_t edge_limit, pel_mesh **filled,
                                       pel_fill_summary *summary, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
