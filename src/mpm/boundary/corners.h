/* corners.h - sides of one kind that share a node: what they do together, without regard to the
 * order of their numbers. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "boundaries.h"

/* Part of component c of what sides do together that side s of `count` has: all of it for the side
 * across c, else equal parts. `some`: bit s, sides that take part. */
double mpsi_mpm_corner_share(int32_t count, const mpsi_boundary *const *boundary, uint32_t some,
                             int c, int32_t s);

/* Dashpots of absorbing sides at one node. `before` (m/s, NULL where not needed): velocity without
 * the step's forces. Returns the node's velocity v (m/s) and the force (N) of each side. */
void mpsi_mpm_apply_dashpots(int dim, double dt, int32_t count,
                             const mpsi_boundary *const *boundary, mpsi_dashpot *const *dashpot,
                             const double *node, const double *before, double *v,
                             double (*force)[3]);

/* Velocity (m/s) along an edge of a node of mass m, which without friction is v, between sides that
 * move along it with `velocity` and whose friction impulses are at most `most` (N s) each; their
 * impulses. */
double mpsi_mpm_edge_friction(int32_t count, double m, double v, const double *velocity,
                              const double *most, double *impulse);

/* Part of a particle at grid coordinate X that lies in the layer of cells at side `number`: 1, 0,
 * or half where it is on one of its borders, as in a mirror image. */
double mpsi_mpm_part_at_side(const mpsi_grid *grid, int32_t number, double X);
