/* dispersion.h - linear waves over a flat bed. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

#define MPSI_WAVES_SHALLOWEST 1e-6 /* omega^2 d/g */
#define MPSI_WAVES_DEEPEST 1e4

/* k d of omega^2 d/g = y within these bounds. */
double mpsi_waves_depths(double y);
/* 4 sinh^2 kd/(sinh 2kd + 2kd), Biesel and Suquet. */
double mpsi_waves_far(double kd);
/* The evanescent mode j >= 1: q d, with q tan(q d) = -omega^2/g, and its amplitude at the piston
 * over the stroke, 4 sin^2 qd/(2 qd + sin 2qd). */
double mpsi_waves_evanescent(double y, int j, double *amplitude);
/* Their sum. */
double mpsi_waves_near(double y);
/* Checks period, depth and gravity of the caller. */
mps_status mpsi_waves_check_range(mps_context *context, const char *function, double period,
                                  double depth, double gravity);
