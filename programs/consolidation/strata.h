/* strata.h - exact consolidation of a layered column in one dimension, whose load grows evenly.
 *
 * Layers from the top down with permeabilities k and moduli M' of compression without motion to the
 * side: du/dt = M'/(rho_w g) d/dz(k du/dz) + dq/dt, u and k du/dz continuous, u = 0 where a side is
 * drained, du/dz = 0 where it is not. By eigenfunctions, R with d/dz(k dR/dz) + lambda R/M' = 0:
 * Terzaghi and Froehlich (1936) for one layer, Schiffman and Stein (1970) for several, Olson (1977)
 * for the load. Thickness in parts of the height H, k and M' over their means k_m = H/sum(h/k) and
 * M_m = H/sum(h/M'), time as T = c_v t/H^2 with c_v = k_m M_m/(rho_w g).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <stdbool.h>

enum { STRATA_MOST = 16, STRATA_TERMS = 400 };

typedef struct stratum {
  double thickness, k, modulus; /* over H, k_m and M_m */
} stratum;

typedef struct strata {
  int count;
  stratum layer[STRATA_MOST]; /* from the top */
  bool drained[2];            /* top, bottom; at least one */
  double lambda[STRATA_TERMS], weight[STRATA_TERMS], mean[STRATA_TERMS]; /* of the eigenfunctions */
} strata;

/* The layers over their means: `thickness` m, `k` m/s, `modulus` Pa on entry. The means: k_m, M_m
 * and H, each may be NULL. */
void strata_scale(strata *s, double *k_mean, double *modulus_mean, double *height);
/* The eigenfunctions; once the layers are scaled. */
void strata_solve(strata *s);

/* Excess pressure at `depth` (over H) and mean of compression, T after a load 1 began that grows
 * evenly within `ramp` (0: at once) and stays. The compression over that of the end. */
double strata_pressure(const strata *s, double depth, double T, double ramp);
double strata_degree(const strata *s, double T, double ramp);
