/* friction.c - friction of walls, polylines and bodies by the quadratic law of hydraulics,
 *
 *   tau = 1/2 rho f |v| v,
 *
 * v the velocity along the face of the water beside it, relative to it, f the friction factor of
 * Fanning (Jonsson's of waves). Each point of a face acts on the particle nearest to it: on
 * particle i the length L that lies in its Voronoi cell among its neighbours and their images.
 * These lengths fill the face, however the particles lie before it. Where the water ends there is
 * no neighbour, and the length ends half a spacing from the particle's foot. Over a step
 *
 *   v' = v/(1 + dt f |v| L/(2 l0^2)),
 *
 * the solution of the law for this particle alone: v falls and keeps its sign, however long the
 * step. A body that floats yields: with n, its mass and that of a layer of l0 all around it over
 * its mass (and their moments of inertia likewise), v' = v - v a/(1 + n a), a = dt f |v| L/(2
 * l0^2), so that even without bound they end with one velocity. SPDX-License-Identifier:
 * BSD-3-Clause */
#include "fluid/step/friction.h"

#include "fluid/boundary/vicinity.h"
#include "fluid/particles/near.h"
#include "fluid/particles/pores.h"
#include "fluid/step/exchange.h"

#define BESIDE 1.5 /* l0: farthest of the particles beside a face */
#define GAP 1.5    /* l0: a face is dry where its nearest particles are twice that apart along it */

/* Length (m) of the wall that particle i, at the distance d, is nearest to. A neighbour that lies
 * s along the wall from it and at the distance e is nearer from (s + (e^2 - d^2)/s)/2 on. */
static double length_of(const mps_fluid *f, const mpsi_fluid_wall *w, int64_t i, double d) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const double *n = w->normal, l0 = f->l0;
  double low = -INFINITY, high = INFINITY;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t j = index[k];
    const double dx = f->x[0][j] - f->x[0][i], dy = f->x[1][j] - f->x[1][i];
    const double s = dy * n[0] - dx * n[1], e = d + dx * n[0] + dy * n[1];
    const double nearer = e * e - d * d;
    if (fabs(s) < 1e-9 * l0) { /* its own image has e = -d */
      if (nearer < -1e-9 * l0 * l0) return 0.0;
      continue;
    }
    const double middle = 0.5 * (s + nearer / s);
    if (s > 0.0 && middle < high) high = middle;
    if (s < 0.0 && middle > low) low = middle;
  }
  if (high > GAP * l0) high = 0.5 * l0;
  if (low < -GAP * l0) low = -0.5 * l0;
  if (w->of_body || w->of_line) {
    const double along = mpsi_fluid_along(w, f->x[0][i], f->x[1][i]);
    low = mpsi_fluid_larger(low, w->from - along);
    if (high > w->to - along) high = w->to - along;
  }
  return mpsi_fluid_larger(high - low, 0.0);
}

/* A face that moves along itself with `moves`, m/s; `yield` is n. */
static void shear_at(const mps_fluid *f, const mpsi_fluid_wall *w, int64_t chunk, int64_t i,
                     double moves, double yield, double *u) {
  const double d = mpsi_fluid_distance(w, mpsi_fluid_places(f, w), f->x[0][i], f->x[1][i]);
  if (!(d > 0.0 && d < BESIDE * f->l0)) return;
  const double length = length_of(f, w, i, d), along[2] = {-w->normal[1], w->normal[0]};
  const double v = u[0] * along[0] + u[1] * along[1] - moves;
  const double rate = 0.5 * w->friction * fabs(v) * length / (f->l0 * f->l0);
  const double less = v * (f->dt * rate / (1.0 + yield * f->dt * rate));
  if (less == 0.0) return;
  const double dv[2] = {-less * along[0], -less * along[1]};
  for (int c = 0; c < 2; c++) u[c] += dv[c];
  mpsi_fluid_exchange_friction(f, chunk, w, i, dv, moves);
}

static double yield_of(const mps_fluid *f, const mpsi_fluid_body *own) {
  const mps_body *body = own->body;
  double length = 0.0, square = 0.0;
  if (!own->floats) return 1.0;
  for (int k = 0; k < own->faces; k++) {
    const double *x = body->xy + 2 * k;
    length += f->wall[own->first + k].length;
    square = mpsi_fluid_larger(x[0] * x[0] + x[1] * x[1], square);
  }
  const double water = f->def.density * f->l0 * f->def.measure * length;
  return 1.0 + water / body->def.mass + water * square / body->def.inertia[2];
}

static void shear_at_bodies(const mps_fluid *f, int64_t chunk, int64_t i, double *u) {
  for (int b = 0; b < f->bodies; b++) {
    const mpsi_fluid_body *body = &f->body[b];
    const double x[2] = {f->x[0][i], f->x[1][i]};
    if (!mpsi_fluid_beside(body, x, 2.0 * BESIDE * f->l0)) continue;
    if (!(f->wall[body->first].friction > 0.0)) continue;
    const double yield = yield_of(f, body);
    for (int k = body->first; k < body->first + body->faces; k++) {
      const mpsi_fluid_wall *w = &f->wall[k];
      if (w->used) shear_at(f, w, chunk, i, mpsi_fluid_moves_along(f, w, i), yield, u);
    }
  }
}

void mpsi_fluid_add_friction(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  if (f->rough == 0) return;
  const mpsi_fluid_listed list =
      f->segments > 0 ? mpsi_fluid_near_chunk(f, chunk) : (mpsi_fluid_listed){0};
  const bool classical = f->classical.gamma > 0.0; /* it marks no particles */
  for (int64_t i = begin; i < end; i++) {
    const mpsi_fluid_pore *pore = mpsi_fluid_pore_of(f, i);
    if (!classical && !(f->company[i] & MPSI_FLUID_NEAR_ROUGH)) continue;
    if (pore && pore->porosity < 1.0) continue; /* the rock's resistance is that of all its faces */
    double u[2] = {f->u_new[0][i], f->u_new[1][i]};
    for (int b = 0; b < f->boundaries; b++)
      if (f->wall[b].used && f->wall[b].friction > 0.0)
        shear_at(f, &f->wall[b], chunk, i, 0.0, 1.0, u);
    for (int64_t k = 0; k < list.count; k++) {
      const mpsi_fluid_wall *w = &mpsi_fluid_segment_of(f, list.item[k])->wall;
      if (w->friction > 0.0) shear_at(f, w, chunk, i, 0.0, 1.0, u);
    }
    shear_at_bodies(f, chunk, i, u);
    for (int c = 0; c < 2; c++) f->u_new[c][i] = u[c];
  }
}
