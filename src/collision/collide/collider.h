/* Functions of a collider for the simulation, in addition to pellicle/collide.h. */
#ifndef PEL_COLLIDE_COLLIDER_H
#define PEL_COLLIDE_COLLIDER_H

#include "base/pool.h"
#include "collide/clearance.h"
#include "pellicle/collide.h"

/* Loops run on this pool from now on, which stays the caller's; null = one thread. */
void pel_collider_use_pool(pel_collider *collider, pel_pool *pool);

/* Only pairs of these groups are found from now on. The arrays stay the caller's and have to live on. positions (of the
   surface): at which groups are convex. */
pel_status pel_collider_use_groups(pel_collider *collider, const pel_collision_groups *groups,
                                   const double (*positions)[3], pel_error *error);

/* Searches look only for pairs of which one is of these groups (group_count, 1 = it is one) from now on; null = for
   all. The array stays the caller's. */
void pel_collider_seek(pel_collider *collider, const uint8_t *groups);

/* The tree over the present surface, owned by the collider with its triangles: numbers of edges and triangles in
   results refer to it. */
const pel_tree *pel_collider_tree(const pel_collider *collider);

/* pairs that a sieve is given at once, at most */
enum { PEL_COLLIDER_BLOCK = 256 };

/* Another narrow phase. Both functions run on several threads at once. */
typedef struct pel_pair_test {
    /* whether a pair is to be listed: is given all but its hit, and fills that in */
    bool (*measure)(const void *context, pel_collision *pair);
    /* writes the numbers of the pairs that are to be measured, and returns how many; points (count) as in a collision;
       null = all are */
    int32_t (*sieve)(const void *context, bool edge_edge, const pel_pair *pairs, const int32_t (*points)[4],
                     int32_t count, int32_t *numbers);
    const void *context;
} pel_pair_test;

/* pel_collider_detect with this test: of the pairs that may come within min_separation on the way those that it lists.
   The statistics stay 0 but for the queries. null = pel_collider_detect. */
pel_status pel_collider_list(pel_collider *collider, const pel_collision_query *query, const pel_pair_test *test,
                             pel_collision_result *result, pel_error *error);

/* Whether pel_collider_detect would find nothing on a way, as known from earlier searches: see pel_clearance_is_clear,
   pel_clearance_stays_clear, pel_clearance_go. query: distances only. */
bool pel_collider_is_clear(pel_collider *collider, const pel_collision_query *query, const pel_clearance_way *way);
bool pel_collider_stays_clear(pel_collider *collider, const pel_collision_query *query, double longest, bool ends);
void pel_collider_go(pel_collider *collider, const pel_collision_query *query, const pel_record *positions);

/* Another surface, valid as for pel_collider_create; limits and groups stay. The triangles, from pel_allocate, are the
   collider's from then on. Allocates. On failure (PEL_OUT_OF_MEMORY) the old surface stays, and the triangles are the
   caller's. */
pel_status pel_collider_set_surface(pel_collider *collider, const double (*positions)[3], int32_t vertex_count,
                                    int32_t (*triangles)[3], int32_t triangle_count, pel_error *error);

enum { PEL_COLLIDER_PARTS = PEL_CANDIDATES_PARTS + 2 * PEL_CLEARANCE_PARTS };

/* State that past searches leave for later ones: with it and the same surface a collider finds the same pairs by the
   same searches, and counts the same. The pieces stay in place until another surface is set; their sizes never
   change. */
void pel_collider_memory(pel_collider *collider, pel_memory_part parts[PEL_COLLIDER_PARTS]);
/* Sets another surface with as many vertices as before, for which the pieces were overwritten by those of an earlier
   search of it; derived state is recomputed. Errors as for pel_collider_set_surface, and PEL_BAD_FORMAT if the pieces
   cannot have been saved from it. */
pel_status pel_collider_recall(pel_collider *collider, const double (*positions)[3], int32_t vertex_count,
                               int32_t (*triangles)[3], int32_t triangle_count, pel_error *error);

#endif
