/* particles_internal.h - what the solvers use of a particle set besides the public functions.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_PARTICLES_INTERNAL_H
#define MPSI_PARTICLES_INTERNAL_H

#include "internal.h"

#include <mps/particles.h>

/* Whether `name` is one of the field table, whose meaning nobody else may change: neither a caller's
 * field of another shape nor a history column of a law. */
bool mpsi_field_reserved(const char *name);

/* One component of a float64 field as a contiguous array, or NULL when the set has no such field
 * or component. Aligned to MPSI_ALIGNMENT, and readable at least MPSI_PARTICLES_PADDING values
 * past the end, where zeros stand: vector loops may load there, and store there only zeros.
 * Valid until particles are added. */
#define MPSI_PARTICLES_PADDING 8
double *mpsi_particles_column(mps_particles *particles, const char *name, int32_t component);

/* The same for a field of one int64, or NULL. */
int64_t *mpsi_particles_integers(mps_particles *particles, const char *name);

/* Reorders all fields: new index k holds what index order[k] held. `order` is a permutation of
 * [0, count). Columns stay where they are; the epoch changes. A solver that sorts holds its own
 * pin; when another one holds a pin too, this is MPS_ERROR_STATE. Errors (that one, or memory)
 * are recorded for `function` on the set's context, and nothing has changed. */
mps_status mpsi_particles_permute(mps_particles *particles, const char *function,
                                  const int64_t *order);
/* The same without allocating, on the context's threads: `scratch` are 1 to MPSI_PERMUTE_COLUMNS
 * places with room for count items of 8 bytes each. More are faster on more threads. */
#define MPSI_PERMUTE_COLUMNS 3
mps_status mpsi_particles_permute_in(mps_particles *particles, const char *function,
                                     const int64_t *order, void *const *scratch, int32_t columns);

/* While pinned, no particle can be added and the caller's destroy only gives up the caller's
 * share: the set goes with the last unpin. Each pin needs its unpin. */
mps_particles *mpsi_particles_pin(mps_particles *particles); /* returns `particles` */
void mpsi_particles_unpin(mps_particles *particles);         /* accepts NULL */

/* Takes back the fields added since there were `keep` of them; nobody may have borrowed them yet. */
void mpsi_particles_drop_fields(mps_particles *particles, int32_t keep);

/* MPS_ERROR_STATE when a solver uses the set. */
mps_status mpsi_particles_check_free(const mps_particles *particles, const char *function);

mps_context *mpsi_particles_context(const mps_particles *particles);

#endif
