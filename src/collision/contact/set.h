/* Contacts of all surfaces as one set, over arrays. It knows positions, masses and obstacles, and neither what moves
   them nor which method does.

   It is given   which vertices are whose, their masses and rest positions (def); triangles, after each change of the
   surface; obstacles and their poses; positions at the start and the end of a step It owns       the collider, the
   points at both times, the sorted list of contacts with their keys, conflicts, zones

   Points are the vertices of the bodies, then those of obstacles that are boxes or meshes. Spheres and capsules are
   points and segments with a radius and stand apart (round.c).

   A step from the positions x0 (free of intersections) to x1 goes so:
     find      pairs that come within the thickness on the way from x0 to x1 become contacts (set.c)
     correct   sweeps of Gauss-Seidel over them move x1, until no pair is too near, or some rounds are over
     guard     what is too near still is stepped back until the whole way from x0 to x1 is free (guard.c) */
#ifndef PEL_CONTACT_SET_H
#define PEL_CONTACT_SET_H

#include "collide/collider.h"
#include "collide/travel.h"
#include "geom/solid.h"
#include "math/pose.h"
#include "pellicle/sim_contact.h"
#include "sweep/contact.h"
#include "sweep/patch.h"

/* in mean edges: what goes farther in a step is not corrected after the solver, but stopped */
#define PEL_CONTACT_FAR 2.0
/* of searches, of the least thickness */
#define PEL_CONTACT_TOLERANCE 1e-2

/* What moves as it is told: a solid or a mesh with its poses. */
typedef struct pel_obstacle {
    pel_solid solid;      /* of a mesh: the sphere about it */
    const pel_mesh *mesh; /* null = the solid; has to live on */
    bool presses;         /* false = passes through everything */
    int32_t body;         /* the only body that it meets; -1 = all */
    /* to be brought before a call that places points or guards */
    pel_pose before, pose; /* at the start of the step; at its end, which the guard may set back */
    pel_pose substep;      /* at the start of the substep */
    const int32_t *held;   /* (held_count) vertices that go with it */
    int32_t held_count;
    bool is_held_back; /* by the last guard */
    /* own: its part of the points, none for spheres and capsules */
    int32_t point_begin, point_end;
    const double (*local)[3];             /* (points) in its frame */
    double corners[PEL_SOLID_CORNERS][3]; /* of a solid with flat faces */
} pel_obstacle;

/* a body or an obstacle */
typedef struct pel_contact_group {
    double thickness; /* m, above 0 */
    double friction;  /* Coulomb's coefficient */
    double hardness;  /* N/(m kg), see contact/layer.h; 0 = unknown */
} pel_contact_group;

/* Arrays marked so are copied; all others stay the caller's and have to live on. */
typedef struct pel_contact_set_def {
    int32_t vertex_count, body_count;
    const int32_t *body_of_slice; /* (vertex_count / PEL_WIDTH) */
    const pel_real *mass,
        *inverse_mass;      /* (vertex_count) kg, 1/kg; 0 and 0 for unused vertices, inverse 0 for fixed ones */
    const pel_record *rest; /* (vertex_count) m */
    const int32_t *origin_of_vertex; /* (vertex_count) the vertex that it was before cuts; null = nothing is cut */
    int32_t triangle_limit;          /* the most triangles of bodies */
    const pel_obstacle *obstacles;   /* (obstacle_count) copied */
    int32_t obstacle_count;
    const pel_contact_group *groups; /* (body_count + obstacle_count) copied; bodies, then obstacles */
    double thickness;                /* m, of groups that have none of their own: the unit of tolerances */
    double shortest_edge;            /* m, of the bodies */
    bool self, between;              /* which bodies meet: each itself, different ones */
    bool has_layers;                 /* the solver sweeps over the contacts, and sees obstacles without a mesh itself */
    pel_ccd_method method;           /* of the search; the guard is always conservative */
    int32_t limit;                   /* the most contacts; others are left to the guard */
    int64_t memory_limit;            /* see pel_collider_def */
    pel_pool *pool;                  /* null = one thread */
    pel_rigids *rigids;              /* null = no body is rigid */
} pel_contact_set_def;

/* Where a step goes: from `position` to `next`. */
typedef struct pel_contact_motion {
    const pel_record *position;  /* (vertex_count) m */
    pel_record *next, *velocity; /* (vertex_count) m and m/s at the end of the step; velocity may be null */
    double dt;                   /* s */
} pel_contact_motion;

enum { PEL_NO_BORDER = -1, PEL_RING_LIMIT = 16 };

/* which pair a contact is of, in the order of the list; the obstacle that it is with, -1 = none */
typedef struct pel_contact_key {
    bool edge_edge;
    int32_t first, second;
    int32_t obstacle;
    bool is_impact; /* its place is that of a conflict in this step, which says more than where the step began */
    int32_t points[4];
    double place[4]; /* weights where it was found */
    /* in substeps and minimisations (refresh.c) */
    bool is_off;    /* does not act at present */
    uint8_t ring;   /* of a vertex before a triangle: it stands for all triangles around points[ring], and is before the
                       nearest of them; 0 = for this one alone */
    int32_t border; /* of a vertex before a triangle: the point that it is before, -2 - edge, or -1 = its inside */
    bool has_side;  /* the normal tells the side on which the pair touches */
    bool has_pushed;                /* in any substep of this step */
    double slack;                   /* m, by how much it may be nearer than the thickness: it was so at the start */
    double gap;                     /* m, between the features, when it was looked at last */
    double room;                    /* m, by which it was farther apart than its layer; 0 = it is near */
    double load, earlier,           /* N, along the normal in the last substep and the one before */
        drag[3];                    /* N, across it; warm start of the next substep */
    double mean_load, mean_drag[3]; /* N, over the substeps of this step */
} pel_contact_key;

/* Where the places of a pair were against each other when it was looked at last: a line of the cache tells whether it
   has to be looked at again. */
typedef struct pel_contact_watch {
    double place[4]; /* weights */
    int32_t points[4];
    float apart[3]; /* m, the way between the places */
    float limit;    /* m, change of that way below which it need not; 0 = it has no room */
} pel_contact_watch;

/* A rigid body that collides as the sphere about its mesh (ball.c). */
typedef struct pel_contact_ball {
    int32_t point; /* its middle */
    double radius;
    double low[3], high[3]; /* m, of the box around its way, with the distance that is searched */
} pel_contact_ball;

/* What comes too near on the way of a step. */
typedef struct pel_conflict {
    int32_t vertices[4]; /* -1 = none */
    int32_t obstacle;    /* -1 = none */
    double time;         /* of impact, as part of the way */
    bool ends_free;      /* only the straight way comes too near, not its end */
} pel_conflict;

/* where a pair that was found is a conflict */
typedef struct pel_timed_hit {
    pel_ccd_hit hit; /* time of impact above 1 = it is none */
    bool is_solved;  /* by a cubic */
} pel_timed_hit;

/* What moves together in the guard: a vertex or obstacle at first. Numbers of a zone stand at its root, but for those
   of a node. */
typedef struct pel_zone {
    int32_t parent;     /* of a forest; itself = root */
    bool is_joined;     /* more than one */
    bool is_held;       /* has met an obstacle, or has what cannot move: no common motion */
    double mass;        /* kg */
    double momentum[3]; /* kg m: sum of mass times way */
    /* of a node */
    int32_t leader;  /* the obstacle that holds it, or itself: whose share counts */
    bool is_stopped; /* it stays */
    double share;    /* of its way against that of the zone */
    double impact;   /* earliest in this round, 1 = none */
} pel_zone;

/* Pairs of triangles that intersect from the start on and are left alone (tangle.c). */
typedef struct pel_tangles {
    bool is_known; /* false = search again before the next step; its keys are made with the surface */
    int64_t count;
    pel_pair *pairs; /* (count) triangles of the surface */
    size_t capacity;
    uint64_t *keys; /* (9 count) sorted: pairs of their corners */
    size_t key_capacity;
} pel_tangles;

/* Which pairs are in the list (known.c): those of a vertex, then those of an edge. */
typedef struct pel_contact_known {
    bool is_used;        /* in this search */
    int32_t (*items)[2]; /* the second features, and the corners that pairs stand for, -1 = none */
    int32_t *begins[2];  /* (features + 1) of the first features, by kind */
    size_t item_capacity, begin_capacity[2];
} pel_contact_known;

/* triangles that may collapse in this step (height.c) */
typedef struct pel_contact_heights {
    pel_contact_list list;
    int32_t *triangles; /* (list.count) of the surface */
    size_t capacity, triangle_capacity;
    float *bounds;      /* (triangles of the surface) m, triangles below this height are candidates */
    double slack;       /* m, least height above its bound at the last measurement; 0 = measure all */
    float (*places)[3]; /* (vertex_count) m, vertex positions at the last measurement */
    double (*parts)[2]; /* (chunks of the loops over vertices and triangles) scratch */
} pel_contact_heights;

typedef struct pel_contact_set {
    pel_contact_set_def def;   /* its obstacles and groups are: */
    pel_obstacle *obstacles;   /* (obstacle_count) */
    pel_contact_group *groups; /* (body_count + obstacle_count) */
    double least, largest;     /* m, thickness of all groups */
    double finest;             /* m, the least thickness of pairs, kin included */
    double guarded;            /* m, distance that the guard keeps */
    double mean_edge;          /* m, of the bodies when the first surface was set */
    double near;               /* m, what starts within it needs no time of impact (pel_ccd_batch) */

    /* the surface */
    pel_collider *collider; /* null = no surface was set */
    int32_t vertex_count, point_count, triangle_count;
    const int32_t (*triangles)[3]; /* (triangle_count) the collider's; those of obstacles first */
    int32_t obstacle_triangle_count;
    int32_t (*next_triangles)[3]; /* (next_count) the next surface, until it is finished */
    int32_t next_count;
    uint8_t *is_fan;               /* (point_count) edges connect all triangles around it */
    int32_t *group_of_point;       /* (point_count) its body, or body_count and its obstacle */
    uint8_t *may_meet;             /* (groups x groups) */
    uint8_t *is_asleep;            /* (groups) nothing of it moves: pairs of two such groups are kept as they are */
    int32_t asleep_count;          /* bodies that are left out of the solver; 0 = is_asleep says nothing */
    double (*start)[3], (*end)[3]; /* (point_count) */
    double (*shape)[3];            /* (point_count) at rest; obstacles in their own frames */
    double (*substep_start)[3], (*substep_end)[3]; /* (points of obstacles) */
    uint32_t substep;                              /* number of the substep, of all steps */
    double dt, time;                               /* s, of the step, to be brought; of the way from start to end */
    double elapsed;                                /* s, in substeps since slacks were reduced; 0 between steps */
    double margin;                                 /* m, ways between start and end may be wrong by half of this */
    bool was_widened;                              /* in this step */
    double horizon;                                /* share of a step that a search is for, the owner's */
    double (*bend)[3];                             /* (vertex_count) m, the owner's: after a share s of the
                                                      way w from the start vertices are expected at s w - s (1 - s) bend
                                                      from it */
    uint8_t *is_stray;                             /* (groups) the owner's: it was not where it was expected */
    double (*home)[3];                             /* (point_count) m, where the way of the last search ended: while all
                                                      points are within half of the margin of it, pairs that may touch
                                                      are in the list */
    bool has_home;                                 /* with layers, and nothing else has changed the list */
    double aim;                                    /* m, to be brought: how far corrections part a pair at most */
    bool way_is_searched;                          /* `on_way` and the conflicts are those of the present start and end:
                                                      every writer of these but pel_contact_set_place clears it */
    bool was_clear;                                /* the last step, and its end is the start of the next */
    pel_collision_result on_way;                   /* the collider's */
    bool minds_sides;                              /* impacts whose normal leans over a triangle are left to that */

    /* contacts, sorted by their keys; the second ones are scratch of merging */
    pel_contact_list list;
    pel_contact_key *keys, *other_keys;
    pel_contact *other_contacts;
    size_t capacity, other_capacity, key_capacity, other_key_capacity;
    double *calm;               /* (list.count) m, travel.approach up to which a pair need not be looked at */
    pel_contact_watch *watches; /* (list.count) */
    uint8_t *acts;              /* (list.count) 1 = it is near and not off */
    int32_t *active;            /* (list.active_count) the list's */
    int32_t *origins;           /* (list.count) where pairs stood before they were merged last, -1 = nowhere */
    double (*owed)[4]; /* (list.count) N, parts of mean_load and mean_drag that are no forces of the step yet */
    size_t calm_capacity, watch_capacity, act_capacity, active_capacity, origin_capacity, owed_capacity;
    pel_contact_patches patches;
    pel_travel travel; /* in this step */
    double calm_until; /* m, the least of `calm` */
    pel_contact_known known;
    int32_t full_count; /* pairs in the list after the last search in this step that went through all; 0 = the next one
                           does */
    bool is_moved;      /* an obstacle has moved in this substep, or in the one before: */
    bool moves;
    pel_contact_heights heights;

    /* balls, by their points; scratch of a search: their order along x, the pairs that it adds, and all that it found
     */
    pel_contact_ball *balls; /* (ball_count) */
    int32_t ball_count;
    int32_t *ball_order; /* (ball_count) */
    pel_collision *ball_pairs, *joined;
    size_t ball_pair_count, ball_pair_capacity, joined_capacity;

    /* the guard; from `solved` on null until it first runs */
    pel_conflict *conflicts; /* of the last look */
    size_t conflict_count, conflict_capacity;
    pel_timed_hit *impacts; /* (collisions of the last look) */
    size_t impact_capacity;
    double (*solved)[3];                /* (vertex_count) end positions before anything was stepped back */
    pel_zone *zones;                    /* (vertex_count + obstacle_count) */
    int32_t *rings;                     /* (same) scratch */
    double *body_shares, *body_impacts; /* (body_count) of the way of all of a body */
    pel_pose *wanted;                   /* (obstacle_count) poses before they were held back */
    pel_rigid_state *rigid_wanted;      /* (rigid bodies) states before they were */
    pel_tangles tangles;
    pel_contact_statistics statistics;
} pel_contact_set;

/* ---- ring.c ---- */
/* The triangles around a corner of one of them that edges connect; returns their number, 0 = more than
   PEL_RING_LIMIT. */
int pel_contact_ring(const pel_tree *tree, int32_t triangle, int32_t corner, int32_t ring[PEL_RING_LIMIT]);
/* The same, 0 also where a vertex is in a valley of the triangles at the start of the step: it may touch two of them.
 */
int pel_contact_smooth_ring(const pel_contact_set *set, int32_t triangle, int32_t corner, int32_t vertex,
                            int32_t ring[PEL_RING_LIMIT]);
/* ---- set.c ---- */
/* Without a surface. PEL_OUT_OF_MEMORY; free with pel_contact_set_destroy, also what failed. */
pel_status pel_contact_set_create(const pel_contact_set_def *def, pel_contact_set **set, pel_error *error);
void pel_contact_set_destroy(pel_contact_set *set);
/* Sorts pairs by their keys after some moved to other triangles of their rings, and merges pairs of the same triangle.
 */
void pel_contact_set_sort(pel_contact_set *set);
/* Before a step: nothing has pushed in it. */
void pel_contact_set_calm(pel_contact_set *set);
/* Before a step with a search: the margin gets smaller if it was not widened in the last one. */
void pel_contact_set_narrow(pel_contact_set *set);
/* Doubles the margin, after positions deviated from the prediction; false where it is as wide as it may be. */
bool pel_contact_set_widen(pel_contact_set *set);
/* Finds what may touch on the way from start to end in a time [s], which may be wrong by half of the margin; what is as
   near as `least` [m] in any case, but for obstacles. With layers, contacts of the last step that are found again keep
   their loads and slacks. All others are forgotten. Errors of pel_collider_detect. */
pel_status pel_contact_set_find(pel_contact_set *set, double least, double time, pel_error *error);
/* The same in a step: what was known stays as it was when it was looked at last, and in the list until a search goes
   through all pairs again. sought (groups): only for pairs of which one is marked; null = for all. */
pel_status pel_contact_set_find_again(pel_contact_set *set, const uint8_t *sought, double time, pel_error *error);
/* Whether the list of the last search has what may touch on the way from start to end, and on ways that are wrong by a
   quarter of the margin: nothing has moved by more than another quarter since. Also false where a smaller margin would
   do, and the list is longer than it has to be. */
bool pel_contact_set_serves(const pel_contact_set *set);
/* m, from its home, within which a point has to stay while the list serves. */
double pel_contact_set_home_reach(const pel_contact_set *set);
/* Instead of pel_contact_set_find, while it serves: the same pairs where they are now. PEL_OUT_OF_MEMORY. */
pel_status pel_contact_set_find_same(pel_contact_set *set, double time, pel_error *error);
/* Puts what pel_contact_set_search_way found into the list; contacts that were there keep their sums.
 * PEL_OUT_OF_MEMORY. */
pel_status pel_contact_set_add_way(pel_contact_set *set, const pel_collision_result *found, pel_error *error);
/* Moves the next positions by sweeps over the contacts, and `end` with them, until all are apart by `aim`, or by the
   thickness without their slack if that is less. Velocities lose what runs into a contact, by impulses: momentum stays
   and energy cannot grow. */
void pel_contact_set_correct(pel_contact_set *set, const pel_contact_motion *motion, int32_t sweeps);
/* Whether the groups, and the contacts with their keys, are whole: sorted, each pair once, with points and obstacles
   that exist, unit normals, and weights that add up to nothing unless an obstacle has the rest. */
bool pel_contact_set_is_valid(const pel_contact_set *set);
/* Makes room for so many pairs from a snapshot, which come into `keys` (pair, loads, drag, slack) and contacts
   (compliance). False when out of memory. */
bool pel_contact_set_expect(pel_contact_set *set, int32_t count);
/* After these were loaded, with `margin`: false, and nothing kept, when the pairs are not in order or numbers are out
   of range. */
bool pel_contact_set_restore(pel_contact_set *set);
/* Takes over the pairs and the margin of another set of the same points and triangles. False when out of memory. */
bool pel_contact_set_take_over(pel_contact_set *set, const pel_contact_set *from);
/* Sets the flags (vertex_count) of the vertices that were pushed. */
void pel_contact_set_mark(const pel_contact_set *set, uint8_t *flags);

/* ---- search.c ---- */
/* What comes within a distance [m] between start and end; for_layers: what may, if ways are wrong. */
pel_status pel_contact_search(pel_contact_set *set, double distance, bool for_layers, pel_collision_result *found,
                              pel_error *error);
/* m, within which a search before a step looks, when points go this far at most */
double pel_contact_search_reach(const pel_contact_set *set, double longest);
/* Whether nothing can meet in a step, as known from earlier searches: there are no contacts, and the surface has moved
   too little for a pair. With layers, which keep pairs apart: whether nothing can be nearer than the guard permits.
   True = a search is not needed; start and end need not be those of the step. longest [m]: bound
   of the displacements of all points, infinite = not known. Positions must be those at the end of the last step, unless
   pel_contact_set_place_start was called after it. */
bool pel_contact_set_is_clear(pel_contact_set *set, const pel_record *position, const pel_record *next, double longest);
/* Instead of pel_contact_set_find, without obstacles: true = it would find nothing if no point goes farther than
   `longest` [m] from these positions. */
bool pel_contact_set_stays_clear(pel_contact_set *set, const pel_record *position, double least, double longest);
/* What comes too near between start and end, and the conflicts among it; nothing is searched twice. */
pel_status pel_contact_set_search_way(pel_contact_set *set, pel_collision_result *found, pel_error *error);

/* ---- meet.c ---- */
/* Fills in the closest points of a pair at `start`, and the direction from one to the other; returns their distance
   [m]. */
double pel_contact_measure_start(const pel_contact_set *set, pel_collision *pair);
/* Whether a pair may come within the thickness in the step, if ways are wrong by up to half of the margin. A measure of
   pel_collider_list with a set as its context: fills in what the one above does. */
bool pel_contact_may_meet(const void *set, pel_collision *pair);
/* Its sieve: where two edges meet at an end or are parallel and hardly slide, vertices keep them apart; and known pairs
   need not be found again. */
int32_t pel_contact_sift(const void *set, bool edge_edge, const pel_pair *pairs, const int32_t (*points)[4],
                         int32_t count, int32_t *numbers);

/* ---- known.c ---- */
/* After a change of the surface. */
void pel_contact_find_fans(pel_contact_set *set);
/* The pairs of the list, and the triangles around the corners that they stand for. PEL_OUT_OF_MEMORY. */
pel_status pel_contact_list_known(pel_contact_set *set, pel_error *error);
bool pel_contact_is_known(const pel_contact_known *known, bool edge_edge, const pel_pair *pair,
                          const int32_t points[4]);

/* ---- distance.c ---- */
/* After a change of the thickness of groups: the distances of the set, which has no contacts yet. */
void pel_contact_set_measure_groups(pel_contact_set *set);
/* m, distance that two groups keep: half the thickness of either */
double pel_contact_thickness(const pel_contact_set *set, int32_t a, int32_t b);
/* the share of all distances that a pair of these points keeps: below 1 for kin, the lips of a cut */
double pel_contact_pair_share(const pel_contact_set *set, const int32_t points[4]);
/* m, the distance that it keeps */
double pel_contact_pair_thickness(const pel_contact_set *set, const int32_t points[4]);
/* the share of kin in a body */
double pel_contact_kin_share(const pel_contact_set *set, int32_t body);
/* Whether both sides of a pair are asleep. */
bool pel_contact_sleeps(const pel_contact_set *set, const int32_t points[4]);
/* Coulomb's coefficient between two groups: the geometric mean of theirs */
double pel_contact_friction(const pel_contact_set *set, int32_t a, int32_t b);

/* ---- surface.c ---- */
/* Points, groups and the triangles of obstacles, in a set that is empty but for its def and obstacles.
 * PEL_OUT_OF_MEMORY. */
pel_status pel_contact_surface_create(pel_contact_set *set, pel_error *error);
/* Another surface: at first the triangles of obstacles (PEL_OUT_OF_MEMORY); then one of a body; then the collider takes
   all, with the points at `start`. is_known: the collider's memory is that of this surface (pel_collider_recall).
   Errors of that and of pel_collider_create; the old surface stays. */
pel_status pel_contact_surface_begin(pel_contact_set *set, pel_error *error);
void pel_contact_surface_add(pel_contact_set *set, const int32_t corners[3]);
pel_status pel_contact_surface_finish(pel_contact_set *set, bool is_known, pel_error *error);
/* Points at both ends of a step, from positions (vertex_count) and the poses of obstacles; if they differ from those of
   the last search it no longer holds. */
void pel_contact_set_place(pel_contact_set *set, const pel_record *position, const pel_record *next);
/* The points of obstacles alone */
void pel_contact_set_place_obstacles(pel_contact_set *set);
/* `start` alone, from positions and the poses at the end of the step */
void pel_contact_set_place_start(pel_contact_set *set, const pel_record *position);
/* the points of one obstacle at a pose */
void pel_obstacle_points(const pel_obstacle *obstacle, const pel_pose *pose, double (*points)[3]);
/* the obstacle of a point, -1 = a vertex of a body */
int32_t pel_contact_obstacle_of(const pel_contact_set *set, int32_t point);
/* the triangles at `start`, as a mesh that nothing is to be freed of */
pel_mesh pel_contact_mesh(const pel_contact_set *set);
/* Adds what a search went through to the statistics. */
void pel_contact_count_search(pel_contact_set *set, const pel_collision_result *found);

/* ---- refresh.c ---- */
/* The points of obstacles at both ends of the substep */
void pel_contact_set_place_substep(pel_contact_set *set);
/* Before the first substep of a step, its length [s]: kept loads in the multipliers. */
void pel_contact_set_recall_loads(pel_contact_set *set, double substep);
/* The same after pel_contact_set_find_again. keeps_looks: what was known has to be looked at only when it had to be
   before; the list was in order then. */
void pel_contact_set_recall_again(pel_contact_set *set, double substep, bool keeps_looks);
/* At the start of a substep of this length [s]: the points of obstacles at both its ends. */
void pel_contact_set_begin_substep(pel_contact_set *set, double substep);
/* After the last substep: store the loads of the multipliers and the remaining slacks. */
void pel_contact_set_keep_loads(pel_contact_set *set);
/* Whether any pair is to be looked at, after points have moved to positions (vertex_count); is_first: in this
   substep. Otherwise all contacts are as they were. */
bool pel_contact_set_needs_look(pel_contact_set *set, const pel_record *positions, bool is_first);
/* Contacts at positions (vertex_count) and the poses at the end of the substep, and which of them are active;
   multipliers of these are kept. start (vertex_count): positions at the start of the substep. looks_at_all: also at
   what has no need. is_first: in this substep, nothing has acted yet; otherwise loaded contacts stay unchanged. */
void pel_contact_set_refresh(pel_contact_set *set, const pel_record *positions, const pel_record *start,
                             bool looks_at_all, bool is_first);
/* For methods that keep the place of each pair during a step: off are those whose normal leans over a triangle at
 * `start`. */
void pel_contact_set_look_at_start(pel_contact_set *set);

/* ---- height.c ---- */
/* vertices or triangles of one chunk: some microseconds */
enum { PEL_HEIGHT_CHUNK = 256 };
/* to be called when the surface has changed */
void pel_contact_heights_set_surface(pel_contact_set *set);
/* At the start of a step: triangles that are nearly collapsed. PEL_OUT_OF_MEMORY. */
pel_status pel_contact_heights_find(pel_contact_set *set, const pel_record *position, pel_error *error);
/* contacts at positions (vertex_count) */
void pel_contact_heights_refresh(pel_contact_set *set, const pel_record *positions);

/* ---- round.c ---- */
/* Adds a conflict for each triangle that comes too near to a sphere or capsule between start and end. */
pel_status pel_contact_round_conflicts(pel_contact_set *set, pel_error *error);

/* ---- ball.c ---- */
/* PEL_OUT_OF_MEMORY. Without layers there are none: rigid bodies collide by their triangles. */
pel_status pel_contact_balls_create(pel_contact_set *set, pel_error *error);
/* m, of the balls of both sides of a pair */
double pel_contact_pair_radius(const pel_contact_set *set, const int32_t points[4]);
/* whether both sides are balls, of which the middles are points 0 and 1 to 3 */
static inline bool pel_contact_are_balls(const int32_t points[4])
{
    return points[1] == points[2];
}
/* the ball of such a pair with a feature after those of the surface */
int32_t pel_contact_ball_point(const pel_contact_set *set, int32_t second);

/* ---- ball_search.c ---- */
/* Adds pairs with balls to what was found, in the order of pairs: those that may come within the distance between start
   and end or, for layers, that may touch. PEL_OUT_OF_MEMORY. */
pel_status pel_contact_balls_join(pel_contact_set *set, double distance, bool for_layers, pel_collision_result *found,
                                  pel_error *error);
/* The pair with a ball that overlaps most at `start`, by a depth [m]; 0 = none does. PEL_OUT_OF_MEMORY. */
pel_status pel_contact_balls_find_deepest(pel_contact_set *set, pel_collision *deepest, double *depth,
                                          pel_error *error);

/* ---- ball_impact.c ---- */
/* impact of a pair with a ball, nearer than a distance [m]; time above 1 = it is free */
pel_timed_hit pel_contact_ball_impact(const pel_contact_set *set, const pel_collision *hit, double guarded);
/* Adds a conflict for each ball that comes too near to a sphere or capsule. */
pel_status pel_contact_ball_conflicts(pel_contact_set *set, pel_error *error);

/* ---- path.c ---- */
/* m, the most that the points of both sides come nearer to each other between start and end */
double pel_contact_longest_approach(const pel_contact_set *set, const pel_collision *hit);
/* m, the longest way of a point between start and end */
double pel_contact_longest_way(const pel_contact_set *set);
/* places of points after a share of the way: those of rigid bodies on the path through the substeps */
void pel_contact_place_between(const pel_contact_set *set, const int32_t points[4], double share, double x[4][3]);
/* in how many straight parts that path is */
int pel_contact_count_knots(const pel_contact_set *set, const int32_t points[4]);

/* ---- conflict.c ---- */
/* of the two parts of a pair at `start` */
double pel_contact_start_distance(const pel_contact_set *set, const pel_collision *hit);
/* Fills `conflicts` from what the collider found between start and end, and from round obstacles. */
pel_status pel_contact_find_conflicts(pel_contact_set *set, const pel_collision_result *found, pel_error *error);
/* m, how far the points of a conflict move against each other between start and end */
double pel_contact_conflict_way(const pel_contact_set *set, const pel_conflict *conflict);
pel_status pel_contact_add_conflict(pel_contact_set *set, const pel_conflict *conflict, pel_error *error);
/* The same with a search of its own, by the conservative test, for what comes nearer than the guarded distance. */
pel_status pel_contact_look(pel_contact_set *set, pel_error *error);

/* ---- guard.c ---- */
/* Steps back until the way from start to end is free, from the conflicts of the last look on; positions, velocities and
   poses of obstacles follow. PEL_OUT_OF_MEMORY, and errors of pel_contact_look. */
pel_status pel_contact_guard(pel_contact_set *set, const pel_contact_motion *motion, pel_error *error);

/* ---- tangle.c ---- */
/* Lists the pairs of triangles that intersect at `start`, of groups that meet, in `tangles`, without its keys.
   PEL_BAD_ARGUMENT for more than 2^20, PEL_OUT_OF_MEMORY. */
pel_status pel_tangles_list(const pel_contact_set *set, pel_tangles *tangles, pel_error *error);
/* Finds them for the set. Errors as above. */
pel_status pel_tangles_find(pel_contact_set *set, pel_error *error);
/* Makes the keys of pairs from a snapshot, of the present surface; forgets what this does not have. */
pel_status pel_tangles_recall(pel_contact_set *set, pel_error *error);
/* true when the points are of a pair that is left alone: vertex and triangle, or two edges */
bool pel_tangles_have(const pel_contact_set *set, const pel_collision *collision);

#endif
