/* foresee.c - the boundaries in the matrix of implicit pressures: the velocity v* to which each
 * kind will bring a node without a correction (boundary/walls.c, in the order of its turns), and
 * what it leaves of a correction.
 *
 *   ROLLER, HELD, DRIVEN, boxes   the component is prescribed
 *   FREE_FIELD                    the component does not follow the pressures
 *   FRICTIONAL                    where v* goes into the side it bears: the normal component is
 *                                 prescribed, and the others where friction by that
 *                                 impulse suffices
 *   ABSORBING                     the dashpot c is implicit: inertia m + dt c; until it has found
 *                                 its forces at rest, which balance those of the water too, the
 *                                 component is prescribed
 *
 * Then viscous damping a acts on components that are not prescribed (step/damping.c): inertia times
 * 1 + a dt. A motion that the matrix does not know comes back as a pressure of K_w/n times its
 * strain. SPDX-License-Identifier: BSD-3-Clause */
#include "forces.h"

#include "mpm/base/kernels.h"
#include "mpm/boundary/kinds.h"
#include "wide_halo.h"

#include <string.h>

/* Nodes of a block. */
typedef struct wall_nodes {
  double dt;
  int dim;
  double (*velocity)[3], (*inertia)[3];
  uint8_t *held;
} wall_nodes;

/* The component is v whatever the pressures. */
static void prescribe(const wall_nodes *to, int k, int c, double v) {
  to->held[k] |= (uint8_t)(1u << c);
  to->velocity[k][c] = v;
}

static void foresee_friction(const wall_nodes *to, const mpsi_boundary *boundary, int side,
                             double share, int k) {
  const int axis = boundary->axis;
  const double into = (to->velocity[k][axis] - boundary->v[axis]) * (side % 2 ? 1.0 : -1.0);
  double square = 0.0;
  if (!(into > 0.0)) return;
  prescribe(to, k, axis, boundary->v[axis]);
  for (int c = 0; c < to->dim; c++)
    if (!(to->held[k] >> c & 1)) square += pow(to->velocity[k][c] - boundary->v[c], 2);
  const double most = boundary->friction * share * into;
  const double left = square > most * most ? 1.0 - most / sqrt(square) : 0.0;
  for (int c = 0; c < to->dim; c++) {
    if (to->held[k] >> c & 1) continue;
    const double v = boundary->v[c] + left * (to->velocity[k][c] - boundary->v[c]);
    if (left > 0.0)
      to->velocity[k][c] = v;
    else
      prescribe(to, k, c, v);
  }
}

static void foresee_dashpot(const wall_nodes *to, const mpsi_boundary *boundary,
                            const mpsi_dashpot *dashpot, int k) {
  for (int c = 0; c < to->dim && to->inertia[k][c] > 0.0; c++) {
    if (to->held[k] >> c & 1) continue;
    if (boundary->finds) {
      prescribe(to, k, c, boundary->settle > 0.0 ? boundary->v[c] : to->velocity[k][c]);
      continue;
    }
    const double damping = c == boundary->axis ? dashpot->across : dashpot->along;
    const double before = to->inertia[k][c];
    to->inertia[k][c] += to->dt * damping;
    to->velocity[k][c] =
        (before * to->velocity[k][c] + to->dt * (dashpot->rest[c] + damping * boundary->v[c])) /
        to->inertia[k][c];
  }
}

static void foresee(const mps_mpm *mpm, const wall_nodes *to, const mpsi_held *at,
                    const mpsi_boundary *boundary, int k) {
  const mpsi_boundary_kind *kind = mpsi_kind_of(boundary);
  const bool whole = kind->prescribes == MPSI_PRESCRIBES_ALL;
  const uint32_t dofs = at->boundary < MPSI_SIDES && !whole ? 1u << boundary->axis : boundary->dofs;
  if (kind->friction) {
    foresee_friction(to, boundary, at->boundary, mpsi_side_share(&mpm->boundaries, at, k), k);
  } else if (kind->absorbs) {
    const mpsi_dashpot *plane = &mpm->boundaries.dashpot[at->dashpot];
    foresee_dashpot(to, boundary, &plane[mpsi_plane_index(boundary->axis, k)], k);
  } else {
    for (int c = 0; c < to->dim; c++)
      if (dofs >> c & 1) prescribe(to, k, c, kind->column ? to->velocity[k][c] : boundary->v[c]);
  }
}

static void apply_boundaries(const mps_mpm *mpm, const wall_nodes *to, int64_t g) {
  const mpsi_grid *grid = &mpm->grid;
  for (int turn = MPSI_TURN_ACROSS; turn < MPSI_TURNS; turn++)
    for (int32_t t = 0; t < grid->nodes[g].held_count; t++) {
      const mpsi_held *at = &mpm->boundaries.held[grid->nodes[g].first_held + t];
      const mpsi_boundary *boundary = &mpm->boundaries.boundary[at->boundary];
      mpsi_range in;
      if ((int)mpsi_kind_of(boundary)->turn != turn ||
          !mpsi_find_range(grid->dim, grid->nodes[g].at, boundary, &in))
        continue;
      for (int k = in.low[2]; k <= in.high[2]; k++)
        for (int j = in.low[1]; j <= in.high[1]; j++)
          for (int i = in.low[0]; i <= in.high[0]; i++)
            foresee(mpm, to, at, boundary, mpsi_local_under(i, j, k));
    }
}

static void find_nodes(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_pore_system *s = mpm->water->system;
  const mpsi_grid *grid = &mpm->grid;
  const int64_t first = mpsi_first_node(grid, g);
  const wall_nodes to = {mpm->run.dt, grid->dim, s->velocity + first, s->inertia + first,
                         s->held + first};
  const double damped = 1.0 + mpm->def.viscous_damping * mpm->run.dt;
  memset(to.held, 0, (size_t)grid->block_nodes);
  for (int k = 0; k < grid->block_nodes; k++)
    for (int c = 0; c < 3; c++) {
      to.inertia[k][c] = grid->node[first + k][MPSI_MASS];
      to.velocity[k][c] = grid->node[first + k][MPSI_VECTOR + c];
    }
  apply_boundaries(mpm, &to, g);
  for (int k = 0; k < grid->block_nodes; k++)
    for (int c = 0; c < grid->dim && to.inertia[k][c] > 0.0; c++)
      if (to.held[k] >> c & 1) {
        to.inertia[k][c] = INFINITY;
      } else {
        to.inertia[k][c] *= damped;
        to.velocity[k][c] /= damped;
      }
}

mps_status mpsi_pore_find_nodes(mps_mpm *mpm, const char *function) {
  const mpsi_pass pass = {.data = mpm, .finish = find_nodes};
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
  return mpm->partition ? mpsi_pore_send_nodes(mpm, function) : MPS_OK;
}
