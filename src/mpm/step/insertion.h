/* insertion.h - callbacks of a solver as the holder of its set of particles (mpsi_holder in
 * core/particles/particles_internal.h), whose `self` is the solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/particles/particles_internal.h"

/* Fields that the caller writes. */
bool mpsi_mpm_compares(const void *self, const char *field);
mps_status mpsi_mpm_note_edit(void *self, const char *function, const char *field,
                              const double *former);
/* Memory for `particles` of them (rooms.h); false: refused. */
bool mpsi_mpm_hold_room(void *self, int64_t particles);
/* Particles that the caller adds and removes. */
mps_status mpsi_mpm_insert(void *self, const char *function, int64_t first, int64_t count);
mps_status mpsi_mpm_remove(void *self, const char *function, int64_t count, const int64_t *ids);
void mpsi_mpm_renew(void *self);
/* Updates the blocks before particles are removed from the set. */
void mpsi_mpm_thin_out(void *self, const uint8_t *gone);
/* On several ranks: order of this rank's rows in the whole set (not collective); agreement on
 * particles that the caller adds, and removes. */
int64_t mpsi_mpm_row_runs(const void *self, mpsi_row_run *out);
mps_status mpsi_mpm_agree_on_insertion(void *self, const char *function, mps_status status,
                                       int64_t first);
mps_status mpsi_mpm_find_removed(void *self, const char *function, mps_status status, int64_t count,
                                 const int64_t *ids, int64_t known, int64_t *all);
