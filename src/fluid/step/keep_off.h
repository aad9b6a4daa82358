/* keep_off.h - particles that have passed a polyline go back to the fluid's side.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

#include <stdbool.h>

/* Takes particle i, which has moved to x with the velocity u, back to the fluid's side
 * of polylines; whether it had to. */
bool mpsi_fluid_keep_off_lines(const mps_fluid *fluid, int64_t i, double *x, double *u);
