/* corners.c - see corners.h. Sides act on a node that they share at once: dashpots are in parallel,
 * forces at rest are divided, and friction along an edge minimises
 * m (v' - v)^2/2 + sum L_s |v' - V_s| over v'. SPDX-License-Identifier: BSD-3-Clause */
#include "corners.h"
#include "mpm/contact/thin_bodies.h"

double mpsi_mpm_corner_share(int32_t count, const mpsi_boundary *const *boundary, uint32_t some,
                             int c, int32_t s) {
  int32_t members = 0, across = -1;
  for (int32_t k = 0; k < count; k++) {
    if (!(some >> k & 1)) continue;
    members++;
    if (boundary[k]->axis == c) across = k;
  }
  if (!(some >> s & 1)) return 0.0;
  if (across >= 0) return s == across ? 1.0 : 0.0;
  return 1.0 / (double)members;
}

/* ---- dashpots -------------------------------------------------------------------------------- */

static double damping_of(const mpsi_boundary *boundary, const mpsi_dashpot *dashpot, int c) {
  return c == boundary->axis ? dashpot->across : dashpot->along;
}

static void prescribe_component(double dt, double per_mass, int32_t count,
                                const mpsi_boundary *const *boundary, mpsi_dashpot *const *dashpot,
                                uint32_t settle, int c, double *v, double (*force)[3]) {
  double target = 0.0;
  for (int32_t s = 0; s < count; s++)
    target += mpsi_mpm_corner_share(count, boundary, settle, c, s) * boundary[s]->v[c];
  double rest = (target - *v) / per_mass;
  for (int32_t s = 0; s < count; s++) {
    if (settle >> s & 1) continue;
    force[s][c] =
        dashpot[s]->rest[c] + damping_of(boundary[s], dashpot[s], c) * (boundary[s]->v[c] - target);
    rest -= force[s][c];
  }
  for (int32_t s = 0; s < count; s++) {
    if (!(settle >> s & 1)) continue;
    force[s][c] = mpsi_mpm_corner_share(count, boundary, settle, c, s) * rest;
    dashpot[s]->rest[c] += (force[s][c] - dashpot[s]->rest[c]) * (dt / boundary[s]->found);
  }
  *v = target;
}

/* Forces at rest of the sides that find them in this step: what the others leave of the forces at
 * the node. */
static void find_rest(int32_t count, const mpsi_boundary *const *boundary,
                      mpsi_dashpot *const *dashpot, uint32_t finds, int c, double balance) {
  for (int32_t s = 0; s < count; s++)
    if (!(finds >> s & 1)) balance -= dashpot[s]->rest[c];
  for (int32_t s = 0; s < count; s++)
    if (finds >> s & 1)
      dashpot[s]->rest[c] = mpsi_mpm_corner_share(count, boundary, finds, c, s) * balance;
}

void mpsi_mpm_apply_dashpots(int dim, double dt, int32_t count,
                             const mpsi_boundary *const *boundary, mpsi_dashpot *const *dashpot,
                             const double *node, const double *before, double *v,
                             double (*force)[3]) {
  const double per_mass = dt / node[MPSI_MASS];
  uint32_t settle = 0, finds = 0;
  for (int32_t s = 0; s < count; s++) {
    if (boundary[s]->finds && boundary[s]->settle > 0.0) settle |= 1u << s;
    if (boundary[s]->finds && !(boundary[s]->settle > 0.0)) finds |= 1u << s;
  }
  for (int c = 0; c < dim; c++) {
    v[c] = node[MPSI_VECTOR + c];
    if (finds)
      find_rest(count, boundary, dashpot, finds, c, before ? (before[c] - v[c]) / per_mass : 0.0);
    if (settle) {
      prescribe_component(dt, per_mass, count, boundary, dashpot, settle, c, &v[c], force);
      continue;
    }
    double push = 0.0, damping = 0.0;
    for (int32_t s = 0; s < count; s++) {
      const double own = damping_of(boundary[s], dashpot[s], c);
      push += dashpot[s]->rest[c] + own * boundary[s]->v[c];
      damping += own;
    }
    v[c] = (v[c] + per_mass * push) / (1.0 + per_mass * damping); /* implicit, as in absorb.c */
    for (int32_t s = 0; s < count; s++)
      force[s][c] =
          dashpot[s]->rest[c] + damping_of(boundary[s], dashpot[s], c) * (boundary[s]->v[c] - v[c]);
  }
}

/* ---- friction -------------------------------------------------------------------------------- */

/* Sum of the limits with the signs of at - V_s; `equal`: of those with V_s = at. */
static double sum_limits(int32_t count, double at, const double *velocity, const double *most,
                         double *equal) {
  double sum = 0.0;
  *equal = 0.0;
  for (int32_t s = 0; s < count; s++)
    if (at == velocity[s])
      *equal += most[s];
    else
      sum += at > velocity[s] ? most[s] : -most[s];
  return sum;
}

double mpsi_mpm_edge_friction(int32_t count, double m, double v, const double *velocity,
                              const double *most, double *impulse) {
  double after = v, equal, sum;
  for (int32_t k = 0; k < count; k++) { /* sticks to side k? */
    sum = sum_limits(count, velocity[k], velocity, most, &equal);
    const double needed = m * (velocity[k] - v) + sum;
    if (!(fabs(needed) <= equal)) continue;
    for (int32_t s = 0; s < count; s++)
      impulse[s] = velocity[s] == velocity[k]  ? needed * (most[s] / equal)
                   : velocity[k] > velocity[s] ? -most[s]
                                               : most[s];
    return velocity[k];
  }
  for (int32_t k = -1; k < count; k++) { /* slides past all: above side k, or below all sides */
    double below = -INFINITY;
    if (k >= 0) below = velocity[k];
    sum = 0.0;
    for (int32_t s = 0; s < count; s++) sum += velocity[s] <= below ? most[s] : -most[s];
    after = v - sum / m;
    bool good = after > below;
    for (int32_t s = 0; s < count; s++)
      good = good && (velocity[s] <= below || after < velocity[s]);
    if (good) break;
  }
  for (int32_t s = 0; s < count; s++) impulse[s] = after > velocity[s] ? -most[s] : most[s];
  return after;
}

/* ---- particles at a side --------------------------------------------------------------------- */

/* 1 behind a border, 0 before it: over a fiftieth of a cell, so that no rounding decides on which
 * side of it a particle is that stays there. */
static double behind(double way) { return fmin(1.0, fmax(0.0, 0.5 + 50.0 * way)); }

double mpsi_mpm_part_at_side(const mpsi_grid *grid, int32_t number, double X) {
  const int c = number / 2;
  const double depth = number % 2 ? (double)grid->high[c] - X : X - (double)grid->low[c];
  return behind(depth) * behind(1.0 - depth);
}
