/* Pellicle: defects of a mesh, its counts and sizes, and its repair. */
#ifndef PELLICLE_MESH_CHECK_H
#define PELLICLE_MESH_CHECK_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Kinds of findings. `element` and `related` below: the contents of an issue's lists. */
typedef enum pel_issue_kind {
    PEL_ISSUE_BAD_INDEX,           /* triangle with an index outside 0 .. vertex_count - 1; related: corner, index */
    PEL_ISSUE_NOT_FINITE,          /* vertex with a coordinate that is NaN or infinite */
    PEL_ISSUE_REPEATED_VERTEX,     /* triangle with a vertex twice; related: that vertex */
    PEL_ISSUE_ZERO_AREA,           /* triangle lower than PEL_FLAT_TRIANGLE times its longest edge */
    PEL_ISSUE_DUPLICATE_TRIANGLE,  /* triangle with the same vertices as an earlier one (in any order); related: that */
    PEL_ISSUE_NON_MANIFOLD_EDGE,   /* edge in more than two triangles; related: its vertices */
    PEL_ISSUE_NON_MANIFOLD_VERTEX, /* vertex whose triangles form more than one fan */
    PEL_ISSUE_INCONSISTENT_WINDING, /* edge between two triangles of opposite winding; related: its vertices */
    PEL_ISSUE_NON_ORIENTABLE,   /* component like a Moebius strip; element: its first triangle; related: component */
    PEL_ISSUE_INSIDE_OUT,       /* closed component turned inward; element: its first triangle; related: component */
    PEL_ISSUE_DUPLICATE_VERTEX, /* vertex exactly where an earlier one is; related: that vertex */
    PEL_ISSUE_ISOLATED_VERTEX,  /* vertex in no triangle */
    PEL_ISSUE_BOUNDARY_EDGE,    /* edge in one triangle only; related: its vertices */
    PEL_ISSUE_COUNT
} pel_issue_kind;

typedef enum pel_severity {
    PEL_SEVERITY_NOTE,    /* normal for some meshes */
    PEL_SEVERITY_WARNING, /* can be simulated, but is probably unintended */
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
    bool repairable; /* pel_mesh_repair removes it (but a non-orientable rest, and duplicate vertices where it cuts) */
} pel_issue_info;

/* Null for a kind that does not exist. */
PEL_API const pel_issue_info *pel_issue_info_of(pel_issue_kind kind);

/* A triangle with height / longest edge at or below this has no area. */
#define PEL_FLAT_TRIANGLE 1e-10

/* The most elements that are listed per kind; counts are always exact. */
#define PEL_ISSUE_LIST_LIMIT 1000

/* The findings of one kind, by ascending element. Edges are numbered as in pel_topology (by their first half-edge). */
typedef struct pel_issue {
    int32_t count;         /* all findings */
    int32_t listed_count;  /* min(count, PEL_ISSUE_LIST_LIMIT) */
    int32_t *elements;     /* (listed_count) */
    int32_t (*related)[2]; /* (listed_count x 2) see pel_issue_kind; -1 = nothing */
} pel_issue;

/* A piece of the surface connected across edges. Components are numbered by their first triangle. A vertex in which
   several fans meet counts once for each fan. */
typedef struct pel_mesh_component {
    int32_t first_triangle;
    int32_t vertex_count, edge_count, triangle_count;
    int32_t boundary_edge_count, boundary_loop_count;
    int32_t euler_characteristic;
    int32_t genus;   /* handles; -1 when the component is not manifold or not orientable */
    bool closed;     /* every edge in exactly two triangles */
    bool manifold;   /* no edge in more than two triangles */
    bool oriented;   /* no two triangles of opposite winding at an edge */
    bool orientable; /* can be made so by turning triangles around; only looked at when manifold */
    double area;     /* m2 */
    double volume;   /* m3, positive = turned outward; 0 unless closed and oriented */
} pel_mesh_component;

/* Everything pel_mesh_check finds. Triangles with bad indices or repeated vertices are counted in triangle_count but
   take no part in edges, components and figures; those with a vertex that is not finite take no part in lengths, areas
   and volumes. */
typedef struct pel_mesh_report {
    pel_issue issues[PEL_ISSUE_COUNT];
    int64_t error_count, warning_count; /* findings of that severity */

    int32_t vertex_count, triangle_count, edge_count;
    int32_t boundary_loop_count;
    int32_t component_count;
    pel_mesh_component *components; /* (component_count) */
    int32_t euler_characteristic;   /* used vertices - edges + triangles */
    int32_t genus;                  /* sum over the components; -1 when one has none */
    bool closed;                    /* at least one triangle and no boundary edge */
    bool manifold;                  /* no bad index, repeated vertex, non-manifold edge or vertex */
    bool oriented;                  /* no inconsistent winding */

    double area;          /* m2 */
    double volume;        /* m3, sum over the components (each about its own point) */
    double bounds_low[3]; /* m, of the finite vertices; zero when there are none */
    double bounds_high[3];
    double edge_length_min, edge_length_median, edge_length_mean, edge_length_max; /* m */
    double quality_min, quality_mean; /* 4 sqrt(3) area / (sum of squared edges): 1 = equilateral, 0 = flat */
    int32_t worst_triangle;           /* the first with quality_min; -1 = none */
    int32_t valence_min, valence_max; /* edges per used vertex */
    double valence_mean;
} pel_mesh_report;

/* Examines a mesh in near-linear time; the same mesh gives the same report. The mesh may hold anything (bad indices,
   NaN, infinities, no vertices): those are findings, not failures. Counts below 0 or more than 2^31 / 3 triangles are
   PEL_BAD_ARGUMENT. On failure *report is null. Free with pel_mesh_report_destroy. */
PEL_API pel_status pel_mesh_check(const pel_mesh *mesh, pel_mesh_report **report, pel_error *error);

/* Frees a report; null is fine. */
PEL_API void pel_mesh_report_destroy(pel_mesh_report *report);

/* Null options mean the defaults: everything, tolerance 0. */
typedef struct pel_repair_options {
    bool weld;             /* merge vertices at the same position; position and fields of the first are kept */
    double weld_tolerance; /* m; vertices linked by steps of at most this are merged; 0 = exactly equal */
    bool drop_degenerate;  /* triangles with a vertex twice or without area (see PEL_FLAT_TRIANGLE) */
    bool drop_duplicates;  /* all but the first of the triangles with the same three vertices */
    bool close_slits;    /* with drop_degenerate: a triangle without area whose third corner lies on its longest edge is
                            merged into its neighbour there, which is split at that corner. No vertex moves */
    bool cut;            /* split non-manifold vertices and edges by duplicating vertices. Of several triangles at an
                            edge those stay connected that face each other through a body; others get a boundary */
    int32_t drop_parts;  /* drop parts of at most this many triangles, but never the largest part (the first of equals):
                            a part is connected across edges after welding. 0, the default: none */
    bool drop_isolated;  /* vertices in no triangle (those that are not finite go in any case) */
    bool orient;         /* give each component the winding of most of its triangles */
    bool outward;        /* turn closed components outward; also the inner walls of hollow bodies */
    int32_t *vertex_map; /* (vertex_count) receives the new number of each vertex, -1 = dropped; nullable */
} pel_repair_options;

PEL_API pel_repair_options pel_repair_options_default(void);

/* Summary of a repair. */
typedef struct pel_repair_summary {
    int32_t bad_triangles;        /* dropped: bad index or a vertex that is not finite */
    int32_t degenerate_triangles; /* dropped */
    int32_t duplicate_triangles;  /* dropped */
    int32_t welded_vertices;      /* merged into an earlier vertex */
    int32_t dropped_parts;        /* see drop_parts; their vertices are not counted as isolated */
    int32_t isolated_vertices;    /* dropped */
    int32_t closed_slits;         /* triangles without area, merged into their neighbours */
    int32_t cut_vertices;         /* copies of vertices, for fans that were split */
    int32_t turned_triangles;     /* winding reversed */
    int32_t outward_components;   /* closed components turned outward as a whole */
    int32_t non_orientable;       /* components that no winding makes consistent */
    bool changed;                 /* the repaired mesh differs from the input */
} pel_repair_summary;

/* A repaired copy: triangles with bad indices or vertices that are not finite are dropped, then the options are
   applied: weld, drop, close, drop parts, cut, orient. Vertices and triangles keep their order, copies of vertices come
   last, fields are kept. Repairing again changes nothing, unless pieces were split. An edge in more than two triangles
   remains if two pieces share both its vertices on every path around (see the report of the result). PEL_BAD_MESH when
   no triangle is left, PEL_BAD_ARGUMENT for a tolerance that is negative, beyond the resolution of the coordinates or
   more than a twentieth of the mesh's size, or drop_parts below 0. summary is nullable. On failure *repaired is null.
 */
PEL_API pel_status pel_mesh_repair(const pel_mesh *mesh, const pel_repair_options *options, pel_mesh **repaired,
                                   pel_repair_summary *summary, pel_error *error);

/* Summary of a filling. */
typedef struct pel_fill_summary {
    int32_t filled_holes;
    int32_t left_holes; /* longer than the limit, or not closable by triangles */
    int32_t triangles;  /* added */
    double quality_min; /* of the added triangles: 1 = equilateral, 0 = flat; 1 when there are none */
} pel_fill_summary;

/* Closes the holes of an oriented manifold whose rims have at most edge_limit (>= 3) edges, without new vertices: of
   all triangulations of a rim of up to 160 edges the one with the least bend between neighbours, then the least area
   (Liepa 2003, "Filling holes in meshes"); longer rims are divided along short chords first. The triangles of the mesh
   stay first; fields are kept. The rim of an open surface counts as a hole. pel_mesh_repair afterwards turns closed
   components outward. Errors: PEL_BAD_ARGUMENT, PEL_BAD_MESH as pel_topology_create, PEL_OUT_OF_MEMORY; *filled is null
   then. summary is nullable. */
PEL_API pel_status pel_mesh_fill_holes(const pel_mesh *mesh, int32_t edge_limit, pel_mesh **filled,
                                       pel_fill_summary *summary, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
