/* selection.h - what a definition acts on, by one rule for all of them: a list of ids, or a box, or
 * all. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

/* The members of a definition that select. */
typedef struct mpsi_selection {
  const int64_t *ids;
  int64_t id_count;
  const double *lower, *upper; /* m, `dim` each; NaN: no bound on that side */
  int32_t all;
  int dim;
} mpsi_selection;

typedef enum mpsi_selected {
  MPSI_SELECTED_NONE, /* of an error, or nothing is given */
  MPSI_SELECTED_IDS,
  MPSI_SELECTED_BOX,
  MPSI_SELECTED_ALL
} mpsi_selected;

typedef struct mpsi_selection_box {
  double lower[3], upper[3]; /* infinite where there is no bound */
} mpsi_selection_box;

#define MPSI_SELECTION(def, dimension)                                                             \
  {                                                                                                \
    .ids = (def)->ids, .id_count = (def)->id_count, .lower = (def)->lower, .upper = (def)->upper,  \
    .all = (def)->all, .dim = (dimension)                                                          \
  }

/* Whether any of the members is given. */
bool mpsi_selection_given(const mpsi_selection *selection);
/* Which of the three is given, and the box: infinite where all is selected, whatever for ids.
 * MPS_ERROR_ARGUMENT: none, or two, an empty list or box, `all` other than 0 or 1. */
mps_status mpsi_selection_read(mps_context *context, const char *function,
                               const mpsi_selection *selection, mpsi_selected *by,
                               mpsi_selection_box *box);
bool mpsi_selection_contains(const mpsi_selection_box *box, int dim, const double *x);
/* MPS_ERROR_ARGUMENT where `count`, the number of `things` ("particle", "facet") selected by all
 * ranks, is 0. */
mps_status mpsi_selection_check_count(mps_context *context, const char *function,
                                      const mpsi_selection *selection, const char *things,
                                      int64_t count);
