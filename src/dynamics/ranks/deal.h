/* deal.h - the halo of a rank for a set that ranks have in parts.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/dynamics.h>

/* The first particle of a body of so many that rank `rank` has. */
int64_t mpsi_dynamics_first_of_rank(int64_t body, int64_t rank, int64_t ranks);

/* For a set in parts, which it sorts, the halo of a rank. Arrays are indexed by local
 * numbers: blocks ascend as in the whole body. */
typedef struct mpsi_dynamics_window {
  int64_t count, whole; /* local numbers, those of missing particles counted; particles of all */
  int64_t first, last;  /* own ones */
  int64_t *block;       /* its number in the whole body, by block here */
  int64_t *near, nears; /* particles of the search for pairs, ascending */
  double *x, *y;        /* m */
  int64_t *side;        /* all 0: there are no free-field columns */
  double edge[2];       /* x of the whole body's outermost particles, m */
} mpsi_dynamics_window;

mps_status mpsi_dynamics_deal(mps_dynamics *dynamics, const char *function,
                              mpsi_dynamics_window *out);
