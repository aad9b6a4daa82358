/* selection.h - the particles that a boundary or load is on.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_DYNAMICS_SELECTION_H
#define MPSI_DYNAMICS_SELECTION_H

#include "domain/domain_internal.h"

#include <mps/dynamics.h>

#include <stdbool.h>

/* Selection of a boundary or load: particles, signals of x and y. */
typedef struct mpsi_dynamics_part {
  int64_t *id; /* as defined, also of removed particles */
  int64_t listed;
  int64_t count;
  int32_t *particle; /* present indices of the remaining particles, ascending */
  int64_t total;     /* when it was defined, on all ranks */
  mps_signal *signal[2];
  double factor[2];
} mpsi_dynamics_part;

/* Selects the particles of a definition. `all`: neither list nor box selects all. */
typedef struct mpsi_dynamics_selection {
  const int64_t *ids;
  int64_t id_count;
  const double *lower, *upper;
  mps_signal *const *signal;
  const double *factor;
  bool all;
} mpsi_dynamics_selection;

/* Selection by the members that the definitions of boundaries and loads share. */
#define MPSI_DYNAMICS_SELECTION(def, everything)                                                   \
  {                                                                                                \
    .ids = (def).ids, .id_count = (def).id_count, .lower = (def).lower, .upper = (def).upper,      \
    .signal = (def).signal, .factor = (def).factor, .all = (everything)                            \
  }

/* Status of all ranks, and whether all definitions are the same: the selection, which is added to
 * the list, and the list. */
mps_status mpsi_dynamics_agree_definition(mps_dynamics *dynamics, const char *function,
                                          mps_status status, const mpsi_dynamics_selection *s,
                                          mpsi_given *list);
/* Collective, as all definitions of boundaries and loads; `status` is that of this rank so far. */
mps_status mpsi_dynamics_select(mps_dynamics *dynamics, const char *function, mps_status status,
                                const mpsi_dynamics_selection *selection, mpsi_dynamics_part *out);
/* Room for `slot` in an array of pointers to boundaries or loads, of which there are `room`. */
mps_status mpsi_dynamics_reserve_slot(mps_dynamics *dynamics, const char *function, int32_t slot,
                                      void **slots, int32_t *room);
/* MPS_ERROR_ARGUMENT where `what` (boundary, load) of a number is not there. */
mps_status mpsi_dynamics_check_there(const mps_dynamics *dynamics, const char *function,
                                     const char *what, bool there, int32_t number);
/* Finds its particles in the present set. */
void mpsi_dynamics_find_part(const mps_dynamics *dynamics, mpsi_dynamics_part *part);
void mpsi_dynamics_release_part(mps_dynamics *dynamics, mpsi_dynamics_part *part);

#endif
