/* kink.c - gradients of q beside a face of rock. The discharge U across the face is continuous, so
 * across it the slope of q is not: with u = U/lambda, the velocity that the resistance leaves, and
 * the ease k of both regions,
 *
 *   k_i dq_i/dN - (rho/dt) u_i.N = k_j dq_j/dN - (rho/dt) u_j.N,
 *
 * where u_j.N is that of particle i's own discharge. A neighbour beyond the face, s of the way to
 * it along the normal N, is then one of a linear field about particle i,
 *
 *   q_j - (rho/dt) (1/lambda_j - 1/lambda_i) (U_i.N) s/k_j = q_i + grad q . (dx + r s N),
 *
 * r = k_i/k_j - 1. Without this the slope is a mean of both regions': particles beside the face are
 * accelerated wrongly for as long as the resistance acts, as if the rock held more water. N is the
 * slope of the share of the region, by the neighbours; the face is where the line along it crosses
 * a polygon. SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/particles/kink.h"
#include "fluid/base/access.h"

#define LEAST_RATIO 0.1 /* of the eigenvalues of M, as in moments.c: below, no such gradient */

static int64_t own_of(const mps_fluid *f, int64_t j) {
  return j < f->count ? j : f->parent[j - f->count];
}

/* Distance (m) from x along the unit vector N to the next edge of rock, at most `most`. */
static double way_to_face(const mps_fluid *f, const double *x, const double *N, double most) {
  double least = most;
  for (int32_t r = 0; r < f->rocks->capacity; r++) {
    const mpsi_fluid_rock *rock = &f->rocks->rock[r];
    for (int64_t k = 0, last = rock->count - 1; rock->used && k < rock->count; last = k++) {
      const double *p = rock->xy + 2 * last, *q = rock->xy + 2 * k;
      const double e[2] = {q[0] - p[0], q[1] - p[1]}, to[2] = {p[0] - x[0], p[1] - x[1]};
      const double cross = N[0] * e[1] - N[1] * e[0];
      const double along = to[0] * e[1] - to[1] * e[0], part = to[0] * N[1] - to[1] * N[0];
      if (cross == 0.0 || part / cross < 0.0 || part / cross > 1.0) continue;
      if (along / cross >= 0.0 && along / cross < least) least = along / cross;
    }
  }
  return least;
}

/* Unit vector out of particle i's region; false: it has none. */
static bool find_normal(const mps_fluid *f, int64_t i, double *N) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  const int32_t *region = f->rocks->region_room.item;
  double M[3] = {0.0, 0.0, 0.0}, sum[2] = {0.0, 0.0};
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t j = index[k];
    const double d[2] = {f->x[0][j] - f->x[0][i], f->x[1][j] - f->x[1][i]};
    const double part = w[k] / fmax(d[0] * d[0] + d[1] * d[1], 0.0025 * f->l0 * f->l0);
    M[0] += part * d[0] * d[0], M[1] += part * d[0] * d[1], M[2] += part * d[1] * d[1];
    if (region[j] == region[i]) continue;
    for (int c = 0; c < 2; c++) sum[c] += part * d[c];
  }
  N[0] = M[2] * sum[0] - M[1] * sum[1], N[1] = M[0] * sum[1] - M[1] * sum[0];
  const double length = sqrt(N[0] * N[0] + N[1] * N[1]);
  if (!(length > 0.0) || !(M[0] * M[2] - M[1] * M[1] > 0.0)) return false;
  N[0] /= length, N[1] /= length;
  return true;
}

double mpsi_fluid_jump(const mps_fluid *f, int64_t i) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *flow = f->w + mpsi_fluid_pairs(f, i);
  const int32_t *region = f->rocks->region_room.item;
  const mpsi_fluid_pore *a = mpsi_fluid_pore_of(f, i);
  double jump = 0.0;
  if (!a->mixed) return 0.0;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t j = index[k];
    if (region[j] == region[i]) continue;
    const mpsi_fluid_pore *b = mpsi_fluid_pore_of(f, own_of(f, j));
    const double d[2] = {f->x[0][j] - f->x[0][i], f->x[1][j] - f->x[1][i]};
    const double ease = 2.0 * a->ease * b->ease / (a->ease + b->ease);
    for (int c = 0; c < 2; c++) {
      const double ci = f->u[c][i] * (1.0 - a->lambda), cj = f->u[c][j] * (1.0 - b->lambda);
      jump += flow[k] * (0.5 * ci / a->ease + 0.5 * cj / b->ease - ci / ease) * d[c];
    }
  }
  return a->porosity * a->porosity * jump / (double)f->local[i].S;
}

bool mpsi_fluid_kinked_gradient(const mps_fluid *f, int64_t i, double *gradient) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  const int32_t *region = f->rocks->region_room.item;
  const mpsi_fluid_local *local = &f->local[i];
  const mpsi_fluid_pore *a = mpsi_fluid_pore_of(f, i);
  const double x[2] = {f->x[0][i], f->x[1][i]}, rate = f->def.density / f->dt;
  double N[2], M[3] = {0.0, 0.0, 0.0}, sum[2] = {0.0, 0.0};
  if (!find_normal(f, i, N)) return false;
  const double face = way_to_face(f, x, N, f->reach);
  if (!(face < f->reach)) return false;
  const double across = a->lambda * (f->u[0][i] * N[0] + f->u[1][i] * N[1]);
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t j = index[k];
    double d[2] = {f->x[0][j] - x[0], f->x[1][j] - x[1]}, dq = f->q[j] - f->q[i];
    if (region[j] != region[i]) {
      const mpsi_fluid_pore *b = mpsi_fluid_pore_of(f, own_of(f, j));
      const double s = fmax(d[0] * N[0] + d[1] * N[1] - face, 0.0);
      dq -= rate * (1.0 / b->lambda - 1.0 / a->lambda) * across * s / b->ease;
      for (int c = 0; c < 2; c++) d[c] += (a->ease / b->ease - 1.0) * s * N[c];
    }
    const double part = w[k] / fmax(d[0] * d[0] + d[1] * d[1], 0.0025 * f->l0 * f->l0);
    M[0] += part * d[0] * d[0], M[1] += part * d[0] * d[1], M[2] += part * d[1] * d[1];
    for (int c = 0; c < 2; c++) sum[c] += part * dq * d[c];
  }
  if (f->state[i] == MPSI_FLUID_SURFACE) {
    const double length2 = local->m[0] * local->m[0] + local->m[1] * local->m[1];
    const double c = mpsi_fluid_surface_weight(local) / length2;
    const double s = (local->qs - f->q[i]) / (local->h * local->h);
    M[0] += c * local->m[0] * local->m[0], M[1] += c * local->m[0] * local->m[1];
    M[2] += c * local->m[1] * local->m[1];
    for (int k = 0; k < 2; k++) sum[k] -= s * local->m[k];
  }
  const double det = M[0] * M[2] - M[1] * M[1], trace = M[0] + M[2];
  if (!(det > LEAST_RATIO / ((1.0 + LEAST_RATIO) * (1.0 + LEAST_RATIO)) * trace * trace))
    return false;
  gradient[0] = (M[2] * sum[0] - M[1] * sum[1]) / det;
  gradient[1] = (M[0] * sum[1] - M[1] * sum[0]) / det;
  return true;
}
