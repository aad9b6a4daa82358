/* classical.c - the scheme of the first papers on MPS (Koshizuka, Tamako and Oka 1995), for
 * comparison only (mps/experimental/papers.h): gravity moves the particles first, then a pressure
 * that follows from their density corrects the density,
 *
 *   u* = u + dt g,  x* = x + dt u*,
 *   (2 d/(lambda n0)) sum w (p_j - p_i) = -gamma (rho/dt^2) (n* - n0)/n0,  p >= 0,
 *   u = u* - (dt/rho) (d/n0) sum w (p_j - p_min) dx/r^2,  x likewise,
 *
 * w = re/r - 1, re 2.1 l0 in n and the gradient, 3.1 l0 in the Laplacian, d = 2, and p = 0 where n*
 * < .97 n0. Walls are mirror images here too, with their parent's p.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "classical.h"
#include "fluid/base/access.h"
#include "fluid/boundary/walls.h"
#include "fluid/ranks/partition.h"
#include "core/definition/digits.h"

#include <mps/experimental/papers.h>

#define NEAR 2.1 /* l0 */
#define SURFACE 0.97

mps_status mps_experimental_fluid_classical(mps_fluid *f, double gamma) {
  if (!f) return mpsi_null(__func__, "fluid");
  mps_status status = mpsi_fluid_ready(f, __func__);
  if (status != MPS_OK) return status;
  MPSI_TRY(mpsi_domain_agree_same(f->domain, __func__, status, "gamma", gamma));
  if (!(gamma > 0.0 && gamma <= 1.0))
    return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT, "gamma is %s, must be in (0, 1]",
                     mpsi_outside(gamma, 0.0, 1.0).text);
  if (f->steps > 0)
    return mpsi_fail(f->context, __func__, MPS_ERROR_STATE, "the fluid has made %lld steps",
                     (long long)f->steps);
  if (mpsi_fluid_load_count(f) > 0)
    return mpsi_fail(f->context, __func__, MPS_ERROR_STATE,
                     "the fluid has had loads: choose the scheme first");
  mpsi_fluid_classical c = {.gamma = gamma};
  double square = 0.0;
  for (int a = -3; a <= 3; a++)
    for (int b = -3; b <= 3; b++) {
      const double r = sqrt((double)(a * a + b * b)), w = f->def.radius_ratio / r - 1.0;
      if ((a == 0 && b == 0) || !(w > 0.0)) continue;
      c.n_wide += w;
      square += w * r * r * f->l0 * f->l0;
      if (r < NEAR) c.n0 += NEAR / r - 1.0;
    }
  c.lambda = square / c.n_wide;
  f->classical = c;
  return MPS_OK;
}

/* ---- before the pressure --------------------------------------------------------------------- */

static void fall(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  for (int64_t i = begin; i < end; i++)
    for (int c = 0; c < 2; c++) {
      f->u[c][i] -= f->dt * f->g * f->up[c];
      f->x[c][i] += f->dt * f->u[c][i];
    }
}

/* The weights of the pairs in place of the smooth ones; n. */
static void weigh(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  const double least = 0.05 * f->l0;
  for (int64_t i = begin; i < end; i++) {
    double n = 0.0;
    for (int64_t k = mpsi_fluid_pairs(f, i); k < mpsi_fluid_pairs(f, i) + f->near[i]; k++) {
      const int32_t j = f->index[k];
      const double r = fmax(hypot(f->x[0][j] - f->x[0][i], f->x[1][j] - f->x[1][i]), least);
      f->w[k] = (float)(f->weight.re / r - 1.0);
      n += fmax(NEAR * f->l0 / r - 1.0, 0.0);
    }
    f->local[i] = (mpsi_fluid_local){.n = n};
    f->state[i] = n < SURFACE * f->classical.n0 ? MPSI_FLUID_APART : MPSI_FLUID_INSIDE;
    f->company[i] = MPSI_FLUID_NEAR_CLOSE;
  }
}

mps_status mpsi_fluid_classical_look(mps_fluid *f, const char *function, mps_status status) {
  mpsi_fluid_for_all(f, f->count, MPSI_FLUID_CHUNK, fall);
  f->stage = MPSI_FLUID_MOVED; /* walls are at their positions of the end of the step */
  if (status == MPS_OK) status = mpsi_fluid_make_ghosts(f, function);
  if (status == MPS_OK) mpsi_fluid_move_ghosts(f);
  MPSI_TRY(mpsi_fluid_agree_same(f, function, status));
  MPSI_TRY(mpsi_fluid_find_neighbours(f, function));
  MPSI_TRY(mpsi_fluid_find_halo(f, function));
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, weigh);
  mpsi_fluid_send_moments(f);
  mpsi_fluid_count(f);
  return mpsi_fluid_lost(f, function);
}

void mpsi_fluid_classical_rows(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  const mpsi_fluid_classical *c = &f->classical;
  const double *p = mpsi_particles_column(f->particles, "pressure", 0);
  const double size = c->lambda * c->n_wide / 4.0 * c->gamma * f->def.density / (f->dt * f->dt);
  mpsi_fluid_system *s = &f->system;
  for (int64_t i = begin; i < end; i++) {
    const bool surface = f->state[i] == MPSI_FLUID_APART;
    double sum = 0.0;
    for (int64_t k = mpsi_fluid_pairs(f, i); k < mpsi_fluid_pairs(f, i) + f->near[i]; k++)
      sum += f->w[k];
    s->diagonal[i] = surface ? 1.0 : sum * (1.0 + 1e-10);
    s->right[i] = surface ? 0.0 : size * (f->local[i].n / c->n0 - 1.0);
    s->x[i] = surface ? 0.0 : p[i];
  }
}

/* q of a pressure that is not below 0. */
void mpsi_fluid_classical_solution(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  for (int64_t i = begin; i < end; i++) {
    f->pressure[i] = fmax(f->system.x[i], 0.0);
    f->q[i] = f->pressure[i] + mpsi_fluid_head(f, f->x[0][i], f->x[1][i]);
  }
}

/* ---- after it -------------------------------------------------------------------------------- */

void mpsi_fluid_classical_accelerate(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  const double factor = f->dt / f->def.density * 2.0 / f->classical.n0, reach = NEAR * f->l0;
  for (int64_t i = begin; i < end; i++) {
    double least = f->pressure[i], sum[2] = {0.0, 0.0};
    for (int pass = 0; pass < 2; pass++)
      for (int64_t k = mpsi_fluid_pairs(f, i); k < mpsi_fluid_pairs(f, i) + f->near[i]; k++) {
        const int64_t j = f->index[k], own = j < f->count ? j : f->parent[j - f->count];
        const double dx = f->x[0][j] - f->x[0][i], dy = f->x[1][j] - f->x[1][i];
        const double r = fmax(hypot(dx, dy), 0.05 * f->l0);
        if (r >= reach) continue;
        if (pass == 0) least = fmin(least, f->pressure[own]);
        const double s = (reach / r - 1.0) * (f->pressure[own] - least) / (r * r);
        if (pass == 1) sum[0] += s * dx, sum[1] += s * dy;
      }
    for (int c = 0; c < 2; c++) f->u_new[c][i] = f->u[c][i] - factor * sum[c];
  }
}
