/* friction.c - contact at the nodes: the normal forces of all bodies first, then Coulomb friction
 * body by body, seed B (31)-(34), and what the bodies feel.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

#include <string.h>

static void gather_touch(const mps_mpm *mpm, mpsi_touch *touch) {
  memset(touch->sum, 0, sizeof touch->sum);
  for (int q = 0; q < 4; q++) {
    if (touch->from[q] < 0) continue;
    const mpsi_meeting *meeting = &mpm->meeting[touch->from[q]];
    if (!meeting->touched) continue;
    const int i0 = MPSI_SIDE * (q & 1), j0 = MPSI_SIDE * (q >> 1);
    for (int part = 0; part < MPSI_TOUCH; part++)
      for (int j = 0; j < MPSI_SIDE && j + j0 < MPSI_TILE_SIDE; j++)
        for (int i = 0; i < MPSI_SIDE && i + i0 < MPSI_TILE_SIDE; i++)
          touch->sum[part][j * MPSI_SIDE + i] +=
              meeting->sum[part][(j + j0) * MPSI_TILE_SIDE + i + i0];
  }
}

void mpsi_mpm_touch(mps_mpm *mpm, int64_t g) {
  double(*node)[MPSI_OWN] = mpm->node[g];
  for (int32_t t = mpm->touch_first[g]; t < mpm->touch_first[g + 1]; t++) {
    mpsi_touch *touch = &mpm->touch[t];
    gather_touch(mpm, touch);
    touch->mass = 0.0;
    for (int k = 0; k < MPSI_OWN; k++) {
      if (!(node[MPSI_NM][k] > 0.0)) continue;
      if (touch->sum[MPSI_W][k] > 0.0) touch->mass += node[MPSI_NM][k];
      node[MPSI_VX][k] += mpm->dt * touch->sum[MPSI_CX][k] / node[MPSI_NM][k];
      node[MPSI_VY][k] += mpm->dt * touch->sum[MPSI_CY][k] / node[MPSI_NM][k];
    }
  }
}

/* The part of a stick force that a body leaves: 1 for a prescribed one. A free one moves too: two
 * masses m (all nodes in contact) and M (the body's, at this point and along this direction) lose
 * their relative velocity by the reduced mass m M/(m + M). */
static double stick_share(const mps_mpm *mpm, int32_t b, const double *x, double tx, double ty) {
  const mps_body *body = mpm->body[b];
  if (body->def.motion == MPS_MOTION_PRESCRIBED) return 1.0;
  const double arm = (x[0] - body->pose.x[0]) * ty - (x[1] - body->pose.x[1]) * tx;
  const double inverse = 1.0 / body->def.mass + arm * arm / body->def.inertia[2];
  return 1.0 / (1.0 + mpm->contact_mass[b] * inverse);
}

/* Tangential force (34) at a node; false where there is none. `v` and `before` are v_i and v_i^n.
 */
static bool tangential(const mps_mpm *mpm, const mpsi_touch *touch, int k, const double *x,
                       const double *v, const double *before, double m, double *force) {
  const double W = touch->sum[MPSI_W][k];
  const double fx = touch->sum[MPSI_CX][k], fy = touch->sum[MPSI_CY][k], fn = hypot(fx, fy);
  if (!(W > 0.0) || !(m > 0.0) || !(fn > 0.0)) return false;
  const double nx = fx / fn, ny = fy / fn;
  double sx = v[0] - before[0] - touch->sum[MPSI_SX][k] / W;
  double sy = v[1] - before[1] - touch->sum[MPSI_SY][k] / W;
  const double across = sx * nx + sy * ny;
  sx -= across * nx, sy -= across * ny;
  const double slip = hypot(sx, sy);
  if (!(slip > 0.0)) return false;
  const double stick = m * slip / mpm->dt * stick_share(mpm, touch->body, x, sx / slip, sy / slip);
  const double f = fmin(stick, mpm->body[touch->body]->def.friction * fn);
  force[0] = -f * sx / slip, force[1] = -f * sy / slip;
  return true;
}

void mpsi_mpm_rub(mps_mpm *mpm, int64_t g) {
  double(*node)[MPSI_OWN] = mpm->node[g];
  for (int32_t t = mpm->touch_first[g]; t < mpm->touch_first[g + 1]; t++) {
    mpsi_touch *touch = &mpm->touch[t];
    if (mpm->body[touch->body]->def.friction == 0.0 || touch->mass == 0.0) continue;
    for (int k = 0; k < MPSI_OWN; k++) {
      const double m = node[MPSI_NM][k];
      const double v[2] = {node[MPSI_VX][k], node[MPSI_VY][k]};
      const double before[2] = {node[MPSI_NX][k], node[MPSI_NY][k]};
      const int32_t *at = mpm->nodes[g].at;
      const double x[2] = {
          mpm->def.origin[0] + mpm->def.cell * ((double)at[0] * MPSI_SIDE + k % MPSI_SIDE),
          mpm->def.origin[1] + mpm->def.cell * ((double)at[1] * MPSI_SIDE + k / MPSI_SIDE)};
      double f[2];
      if (!tangential(mpm, touch, k, x, v, before, m, f)) continue;
      for (int c = 0; c < 2; c++) {
        touch->sum[MPSI_TX + c][k] = f[c] / touch->sum[MPSI_W][k];
        node[MPSI_VX + c][k] += mpm->dt * f[c] / m;
      }
    }
  }
}

/* Reactions of all blocks, in their order, to the bodies; then the bodies move. */
void mpsi_mpm_react(mps_mpm *mpm) {
  for (int32_t b = 0; b < mpm->bodies; b++) {
    mpsi_load load[MPS_BODY_MAX_PARTS] = {{{0}, {0}}};
    int64_t contacts[MPS_BODY_MAX_PARTS] = {0};
    for (int64_t k = 0; k < mpm->meeting_count; k++) {
      const mpsi_meeting *meeting = &mpm->meeting[k];
      if (meeting->body != b || !meeting->touched) continue;
      for (int32_t part = 0; part < mpm->body[b]->parts; part++) {
        for (int c = 0; c < 2; c++) load[part].force[c] += meeting->load[part].force[c];
        load[part].moment[2] += meeting->load[part].moment[2];
        contacts[part] += meeting->contacts[part];
      }
    }
    mpsi_body_react(mpm->body[b], mpm->dt, load, contacts);
    mpsi_body_advance(mpm->body[b], mpm->dt);
  }
}
