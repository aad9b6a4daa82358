/* gradient.h - the displacement gradient and its transpose.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

/* f += G_i^T moment, moment[c][b] (N m): a load's first moment about particle i. */
void mpsi_elastic_spread(const mps_elastic *e, int64_t i, const double (*moment)[3], double *f);
/* Displacement gradients G[(slot * dim + c) * dim + b] = d u_c / d x_b, of own particles and the
 * layers that their pairs reach. */
void mpsi_elastic_gradients(mps_elastic *e, const double *u, double *gradient);
