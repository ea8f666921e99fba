/* Snapshots, and the state of one simulation for another. */
#ifndef PEL_SIM_SNAPSHOT_H
#define PEL_SIM_SNAPSHOT_H

#include "sim/topology.h"

/* pel_sim_save without the checksum, for pel_snapshot_rewind alone. */
void pel_snapshot_keep(const pel_sim *sim, void *bytes);
/* The bytes of a snapshot's lists, which have the length of the present state; the rest always has the same size. */
size_t pel_snapshot_lists_size(const pel_sim *sim);
/* The surfaces of a snapshot, for pel_surfaces_begin; errors of pel_sim_load. */
pel_status pel_snapshot_read_surfaces(const pel_sim *sim, const void *bytes, size_t size, pel_surfaces *surfaces,
                                      pel_error *error);
/* Whether a snapshot is whole, and of the present surfaces. Errors of pel_sim_load. */
pel_status pel_snapshot_check(const pel_sim *sim, const void *bytes, size_t size, bool *has_surfaces, pel_error *error);
/* pel_sim_load of a snapshot with the present surfaces. */
pel_status pel_snapshot_load(pel_sim *sim, const void *bytes, size_t size, pel_error *error);
/* Refuses the snapshot of a sim with other defs, by the names of their parts; otherwise the given status. */
pel_status pel_snapshot_refuse_other(const pel_sim *sim, const void *bytes, pel_status status, pel_error *error);
/* Recomputes the checksum of a snapshot, for tests of damage. */
void pel_snapshot_seal(void *bytes, size_t size);
/* Whether the bytes are a whole snapshot of a simulation like this one, with lists as long; checksum: as
 * pel_snapshot_seal has left it. */
bool pel_snapshot_is_valid(const pel_sim *sim, const void *bytes);
/* Restores a snapshot of the same simulation. Its defs must not have changed, except numbers that it reads in each
   step: those of loads and grasps, which have to be set again. Fingerprint and checksum are not checked. Errors of
   pel_sim_load. */
pel_status pel_snapshot_rewind(pel_sim *sim, const void *bytes, pel_error *error);
/* Transfers the state of a simulation to one that was just created with other numbers. Tools are
   matched by name; others start at their keys. With surfaces (topology.h; null = the same) the new one has copies of
   vertices, which go on from those of their sources. PEL_OUT_OF_MEMORY. */
pel_status pel_snapshot_carry(const pel_sim *from, pel_sim *to, const pel_surfaces *surfaces, pel_error *error);

#endif
