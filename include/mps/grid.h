/* mps/grid.h - the grid of a WLS-MPM solver, for reading between steps: its nodes as arrays,
 * and the fields of the particles at any points (probes, gauges,
 * sections).
 *
 * The handle is lent: it lives as long as its solver. All values are of the present state, so that
 * they may be queried before the first step, after a rollback and in the callback of mps_mpm_run.
 * Results of the steps do not depend on queries. Thread rule: as of its solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_GRID_H
#define LIBMPS_GRID_H

#include "mpm.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_grid mps_grid;

/** The grid of `mpm`; NULL for NULL. */
MPS_API mps_grid *mps_mpm_grid(mps_mpm *mpm);

typedef struct mps_grid_info {
  double cell;      /* h, m */
  double origin[3]; /* m: a node lies here, the others whole cells from it */
  int32_t dim;      /* 2 or 3 */
  int32_t spline;   /* degree of the weights, 2 or 3 */
} mps_grid_info;
/** Spacing and origin of the nodes, and the degree of the weights. MPS_ERROR_ARGUMENT: NULL, or a
 *  `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_grid_get_info_sized(const mps_grid *grid, mps_grid_info *out,
                                                         size_t size);
static inline mps_status mps_grid_get_info(const mps_grid *grid, mps_grid_info *out) {
  return mps_grid_get_info_sized(grid, out, sizeof *out);
}

/** The active nodes, those in the support of a particle: `count` receives their number; at most
 *  `capacity` (>= 0) of them are written. Each array may be NULL: `position` (m, 3 values a node),
 *  `mass` (kg; their sum is that of the particles), `velocity` (m/s, 3 values a node, before the
 *  forces of the next step) and `force` (N, 3 values a node: of stresses, gravity, loads and
 *  springs of contacts, not what boundaries, friction and contacts by impulses add in a step).
 *  Where bodies or edges cut supports a node's mass can be a little below 0. Nodes near a mirrored
 *  side (mps_mpm_edge) include the contributions of the images beyond it: their masses add up as
 *  before, momenta and forces across it do not. The particles are
 *  sorted if the next step would sort them: views are then stale. On several ranks (collective)
 *  each gets nodes of its own blocks, every node on one rank; all together they are those of one
 *  rank. MPS_ERROR_ARGUMENT: `capacity` below 0; MPS_ERROR_STATE: a step has failed, a field is
 *  being edited, or new particles have no density; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_grid_get_nodes(const mps_grid *grid, int64_t capacity,
                                                    int64_t *count, double *position, double *mass,
                                                    double *velocity, double *force);

typedef enum mps_grid_point {
  MPS_GRID_POINT_INSIDE = 0,
  MPS_GRID_POINT_EMPTY = 1,  /* particles fill less than a fifth of the support: a point at a plane
                                surface has a half, at a corner a quarter */
  MPS_GRID_POINT_OUTSIDE = 2 /* not in the domain */
} mps_grid_point;

/** Component `component` (-1: all) of the float64 field `field` of the particles at `count` (>= 0)
 *  points (m, 3 values each, finite; in 2D the third is not read): `values` receives one number a
 *  point, or as many as the field has components; NaN where `states` (int32_t, an mps_grid_point
 *  each; may be NULL) is not INSIDE. The value is that of the linear function which fits the
 *  particles best in the solver's weights about the point: linear fields are reproduced. Particles
 *  on both sides of a thin body count. On several ranks (collective, the same points on all) each
 *  gets the values of one rank. MPS_ERROR_FIELD: the set has no such field of float64;
 *  MPS_ERROR_STATE: a step has failed. */
MPS_API MPS_NODISCARD mps_status mps_grid_evaluate(const mps_grid *grid, const char *field,
                                                   int32_t component, int64_t count,
                                                   const double *points, double *values,
                                                   int32_t *states);

MPS_EXTERN_C_END
#endif
