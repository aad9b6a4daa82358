/* pose.h - corners of a body in the fluid, and how they move.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/base/flow_solver.h"

/* Corner k of a body in a pose; that after the last one is the first. */
static inline void mpsi_fluid_corner_at(const mps_body *body, const mpsi_fluid_pose *pose,
                                        int64_t k, double *x) {
  const double *xy = body->xy + 2 * k;
  for (int c = 0; c < 2; c++)
    x[c] = pose->x[c] + pose->R[2 * c] * xy[0] + pose->R[2 * c + 1] * xy[1];
}

/* The same at the beginning of the step, or at its end (next). */
static inline void mpsi_fluid_corner(const mpsi_fluid_body *body, bool next, int64_t k, double *x) {
  mpsi_fluid_corner_at(body->body, next ? &body->next : &body->pose, k, x);
}
