/* bound.c - see undo.h. The particles' kinetic energy is at most
 *
 *   T <= F (T0 + U0 + sum of positive works) + tiny
 *
 *   T0   kinetic energy when the state was last made or edited, and
 *   U0   the elastic energy of its stresses, by Hooke's law: all that they can release
 *   works  of boundaries as counted by their impulses; of gravity and loads at most
 *        |g| dt sqrt(2 m T) + dt sqrt(2 T sum f^2/m), by Schwarz
 *   F    4: T and U exchange within a step, laws whose modulus grows with the pressure release up
 *        to twice p^2/2K, and strains of means of cells differ from those of the nodes
 *   tiny 1e-10 m c^2, round-off of ground at rest
 *
 * Positive works alone are summed, so the sum only grows, and nothing that dissipates matters. A
 * motion that grows from step to step without a source passes the bound after a number of steps
 * that is the logarithm of F and the exchanged energy.
 *
 * Not bounded: users' laws, which may have sources of their own; ground with pore water
 * (water/bounds.c has its bounds); bodies, whose overlaps and penalty springs store energy that is
 * not summed here; free-field columns, which feed energy in; several ranks; and mps_mpm_settle,
 * which takes energy out.
 *
 * A step is saved (undo.h) where it can end beyond all bounds: after a change by the caller, beyond
 * the Courant limit, where a load jumps, where water is near its bounds, or where particles or
 * bodies move by more than 1/20 of a cell in the step. Otherwise speeds would have to grow
 * twentyfold within it. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/boundary/free_field.h"

#include <stdio.h>
#include <string.h>

#define FACTOR 4.0
#define TINY 1e-10
#define CALM 0.05  /* cells in a step */
#define FILLED 0.5 /* part of the bound from which steps are saved */

static double speed2_of(const mps_mpm *mpm, int64_t k) {
  double square = 0.0;
  for (int c = 0; c < mpm->grid.dim; c++) square += mpm->p.v[c][k] * mpm->p.v[c][k];
  return square;
}

bool mpsi_bound_by_law(const mpsi_columns *p) {
  for (int32_t k = 0; k < p->laws.count; k++)
    if (mpsi_material_may_refuse(p->laws.law[k].material)) return true;
  return false;
}

/* Whether energy bounds the motion. */
static bool applies(const mps_mpm *mpm) {
  return !mpm->partition && !mpm->water && !mpm->settling.on && mpm->contact.bodies == 0 &&
         !mpsi_mpm_has_free_field(&mpm->boundaries) && !mpsi_bound_by_law(&mpm->p);
}

/* ---- calm ------------------------------------------------------------------------------------ */

static bool load_jumps(const mpsi_traction *load) {
  bool jumps = false;
  for (int c = 0; c < 3 && load; c++)
    jumps = jumps || !(fabs(load->now[c]) <= 2.0 * fabs(load->former[c]));
  return jumps;
}

bool mpsi_bound_is_calm(const mps_mpm *mpm) {
  const double dt = mpm->run.dt, most = CALM * mpm->grid.cell / dt;
  bool calm = !mpm->run.changed && dt <= mps_mpm_limit(mpm) && mpm->bound.fastest <= most &&
              !(applies(mpm) && mpm->bound.kinetic > FILLED * mpm->bound.most);
  for (int32_t k = 0; k < mpm->loads.list->capacity; k++)
    if (load_jumps(mpsi_load_of(&mpm->loads, k))) calm = false;
  for (int32_t k = 0; k < mpm->boundaries.count; k++)
    for (int c = 0; c < mpm->grid.dim; c++)
      calm = calm && (mpm->boundaries.boundary[k].kind == MPSI_BOUNDARY_NONE ||
                      fabs(mpm->boundaries.boundary[k].v[c]) <= most);
  for (int32_t b = 0; b < mpm->contact.bodies; b++)
    calm = calm && mpsi_contact_speed(mpm->contact.handle[b]) <= most;
  return calm;
}

void mpsi_bound_keep(mps_mpm *mpm) {
  mpm->run.changed = false;
  for (int32_t k = 0; k < mpm->loads.list->capacity; k++) {
    mpsi_traction *load = mpsi_load_of(&mpm->loads, k);
    if (load) memcpy(load->former, load->now, sizeof load->former);
  }
}

/* ---- energy ---------------------------------------------------------------------------------- */

/* Elastic energy of a particle, J; without a shear modulus that of the pressure. */
static double stored_of(const mps_mpm *mpm, int64_t k) {
  double s[6] = {0.0}, wave, shear;
  for (int c = 0; c < 2 * mpm->grid.dim; c++) s[c] = mpm->p.s[c][k];
  mpsi_mpm_elastic(&mpm->p, k, &wave, &shear);
  const double bulk = wave - 4.0 / 3.0 * shear;
  const double energy = mpsi_elastic_energy(s, bulk, shear > 0.0 ? shear : INFINITY);
  return isfinite(energy) ? mpm->p.V[k] * energy : 0.0;
}

void mpsi_bound_begin(mps_mpm *mpm) {
  mpsi_bound *b = &mpm->bound;
  if (!mpm->run.renewed && !(b->lapsed && applies(mpm))) return;
  mpm->run.renewed = false;
  *b = (mpsi_bound){.lightest = INFINITY, .beyond = -1};
  for (int64_t k = 0; k < mpm->p.count; k++) {
    b->kinetic += 0.5 * mpm->p.m[k] * speed2_of(mpm, k);
    b->mass += mpm->p.m[k];
    b->lightest = fmin(b->lightest, mpm->p.m[k]);
  }
  for (int64_t k = 0; applies(mpm) && k < mpm->p.count; k++) b->allowed += stored_of(mpm, k);
  b->allowed += b->kinetic;
}

/* Work of gravity and loads in the step, at most. */
static double work_of_forces(const mps_mpm *mpm, double kinetic) {
  const mpsi_columns *p = &mpm->p;
  double g = 0.0, f = 0.0;
  for (int c = 0; c < mpm->grid.dim; c++) {
    g += mpm->def.gravity[c] * mpm->def.gravity[c];
    for (int64_t k = 0; p->f[c] && k < p->count; k++) f += p->f[c][k] * p->f[c][k] / p->m[k];
  }
  return mpm->run.dt * sqrt(2.0 * kinetic) * (sqrt(g * mpm->bound.mass) + sqrt(f));
}

static double work_of_boundaries(const mpsi_boundaries *boundaries) {
  double work = 0.0;
  for (int32_t k = 0; k < boundaries->count; k++)
    if (boundaries->boundary[k].sums)
      work += mpsi_exact_value(&boundaries->boundary[k].sums->step[MPSI_BOUNDARY_WORK]);
  return work;
}

static int64_t find_fastest(const mps_mpm *mpm) {
  double most = -1.0;
  int64_t at = 0;
  for (int64_t k = 0; k < mpm->p.count; k++)
    if (speed2_of(mpm, k) > most) most = speed2_of(mpm, k), at = k;
  return at;
}

void mpsi_bound_check(mps_mpm *mpm) {
  mpsi_bound *b = &mpm->bound;
  double kinetic = 0.0;
  b->beyond = -1;
  for (int64_t c = 0; c < mpm->grid.cell_count; c++) kinetic += 0.5 * mpm->grid.cells[c].vis_viva;
  b->lapsed = !applies(mpm);
  if (b->lapsed || !isfinite(kinetic)) return; /* not finite: a particle is bad */
  const double c2 = mpm->run.speed * mpm->run.speed;
  double allowed = b->allowed + work_of_forces(mpm, kinetic) + work_of_forces(mpm, b->kinetic) +
                   fmax(work_of_boundaries(&mpm->boundaries), 0.0);
  b->most = FACTOR * allowed + TINY * b->mass * c2;
  if (kinetic > b->most && mpm->undo.on) {
    b->beyond = find_fastest(mpm);
    return;
  } /* a step beyond that was not saved is kept, and the next one is saved */
  b->allowed = allowed;
  b->kinetic = kinetic;
}

double mpsi_bound_fastest(const mps_mpm *mpm) {
  if (!(mpm->run.dt > 0.0 && mpm->bound.lightest > 0.0)) return 0.0; /* before the first step */
  const double most = CALM * mpm->grid.cell / mpm->run.dt;
  double fastest = 0.0;
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    const mpsi_cell_block *cells = &mpm->grid.cells[b];
    if (cells->tight) return INFINITY;
    double square = cells->vis_viva / mpm->bound.lightest;
    if (square > most * most) { /* not so fast if all share it */
      square = 0.0;
      for (int64_t k = cells->begin; k < cells->end; k++) square = fmax(square, speed2_of(mpm, k));
    }
    fastest = fmax(fastest, square);
  }
  return sqrt(fastest);
}

void mpsi_bound_describe(const mps_mpm *mpm, char *out, size_t size) {
  double kinetic = 0.0;
  for (int64_t c = 0; c < mpm->grid.cell_count; c++) kinetic += 0.5 * mpm->grid.cells[c].vis_viva;
  (void)snprintf(out, size,
                 "is the fastest: the kinetic energy of all, %.4g J, is beyond %.4g J, %g times "
                 "what was there, was stored in stresses and has been done as work",
                 kinetic, mpm->bound.most, FACTOR);
}
