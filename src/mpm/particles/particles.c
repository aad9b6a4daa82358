/* particles.c - the particles of the set as the solver has them: where their columns lie, the state
 * in which they begin, and what follows where the caller writes a field.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "particles.h"

#include "mpm/contact/particle.h"

#include <string.h>

#define DENSITY_MIN 1e-9 /* kg/m3 */
#define DENSITY_MAX 1e12

/* ---- columns --------------------------------------------------------------------------------- */

static void bind_water(mps_particles *set, mpsi_columns *p) {
  p->u = mpsi_particles_column(set, "pore_pressure", 0);
  p->n = mpsi_particles_column(set, "porosity", 0);
  p->k = mpsi_particles_column(set, "permeability", 0);
  for (int c = 0; c < 3; c++) p->g[c] = mpsi_particles_column(set, "pore_pressure_gradient", c);
}

void mpsi_mpm_bind(mps_mpm *mpm) {
  mps_particles *set = mpm->p.set;
  mpsi_columns *p = &mpm->p;
  p->count = mps_particles_count(set);
  for (int c = 0; c < mpm->grid.dim; c++) {
    p->x[c] = mpsi_particles_column(set, "position", c);
    p->v[c] = mpsi_particles_column(set, "velocity", c);
  }
  for (int c = 0; c < 2 * mpm->grid.dim; c++) p->s[c] = mpsi_particles_column(set, "stress", c);
  if (mpm->water) bind_water(set, p);
  for (int c = 0; c < 9; c++) /* NULL where there is no such component */
    p->L[c] = mpsi_particles_column(set, "velocity_gradient", c);
  p->V = mpsi_particles_column(set, "volume", 0);
  p->m = mpsi_particles_column(set, "mass", 0);
  if (p->law) p->law = mpsi_particles_integers(set, "material");
  for (int32_t k = 0; k < mpm->p.laws.count; k++) mpsi_mpm_bind_law(mpm, &mpm->p.laws.law[k]);
}

/* ---- checks ---------------------------------------------------------------------------------- */

mps_status mpsi_mpm_check_places(const mps_mpm *mpm, const char *function, int64_t first,
                                 int64_t end) {
  const int64_t *id = mpsi_particles_integers(mpm->p.set, "id");
  for (int64_t k = first; k < end; k++)
    for (int c = 0; c < mpm->grid.dim; c++) {
      const double x = mpm->p.x[c][k], X = mpsi_grid_at(&mpm->grid, c, x);
      if (!(fabs(X) < MPSI_MAX_CELLS))
        return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                         "particle %lld has %c = %g m, more than 2^30 cells from the origin",
                         (long long)id[k], "xyz"[c], x);
      if (!(X >= (double)mpm->grid.low[c] && X <= (double)mpm->grid.high[c]))
        return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                         "particle %lld has %c = %g m, outside the domain [%g, %g] m",
                         (long long)id[k], "xyz"[c], x, mpm -> def.lower[c], mpm->def.upper[c]);
    }
  return MPS_OK;
}

mps_status mpsi_mpm_check_start(const mps_mpm *mpm, const char *function) {
  static const char *const names[] = {
      "position",          "velocity",      "velocity_gradient", "stress",
      "volume_ratio",      "volume",        "density",           "deformation_gradient",
      "body_acceleration", "external_force"};
  for (size_t f = 0; f < sizeof names / sizeof *names; f++)
    for (int32_t c = 0; c < 9; c++) {
      const double *value = mpsi_particles_column(mpm->p.set, names[f], c);
      for (int64_t k = 0; value && k < mpm->p.count; k++)
        if (!isfinite(value[k]))
          return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                           "'%s' of particle %lld is %g, must be finite", names[f],
                           (long long)mpsi_particles_integers(mpm->p.set, "id")[k], value[k]);
    }
  return mpsi_mpm_check_places(mpm, function, 0, mpm->p.count);
}

mps_status mpsi_mpm_check_lost(mps_mpm *mpm, const char *function) {
  if (!mpm->run.lost || mpsi_mpm_check_places(mpm, function, 0, mpm->p.count) == MPS_OK)
    return MPS_OK;
  mps_error found = *mps_context_error(mpm->context);
  return mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                   "%s, since the last step: edit its position, remove it or go back",
                   found.message);
}

/* ---- volume and mass ------------------------------------------------------------------------- */

double mpsi_mpm_lattice_volume(const mps_mpm *mpm, int64_t k) {
  const double spacing = mps_particles_spacing(mpm->p.set);
  if (mpm->grid.dim == 3) return spacing * spacing * spacing;
  const double radius = mpm->grid.geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? mpm->p.x[0][k] : 1.0;
  return spacing * spacing * mpm->grid.measure * radius;
}

static mps_status check_amount(const mps_mpm *mpm, const char *function, int64_t k,
                               double density) {
  const mpsi_columns *p = &mpm->p;
  const double volume = p->V[k] != 0.0 ? p->V[k] : mpsi_mpm_lattice_volume(mpm, k);
  const double ratio = !p->J ? 1.0 : p->J[k] != 0.0 ? p->J[k] : 1.0;
  if (density >= DENSITY_MIN && density <= DENSITY_MAX && volume > 0.0 && ratio > 0.0)
    return MPS_OK;
  return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                   "particle %lld has density %g kg/m3, volume %g m3 and volume ratio %g: must "
                   "be %g to %g, > 0 and > 0%s",
                   (long long)mpsi_particles_integers(mpm->p.set, "id")[k], density, volume, ratio,
                   DENSITY_MIN, DENSITY_MAX, volume == 0.0 ? " (it lies on the axis, r = 0)" : "");
}

mps_status mpsi_mpm_check_amounts(const mps_mpm *mpm, const char *function) {
  const double *density = mpsi_particles_column(mpm->p.set, "density", 0);
  mps_status status = MPS_OK;
  for (int64_t k = 0; k < mpm->p.count && status == MPS_OK; k++)
    status = check_amount(mpm, function, k, density[k]);
  return status;
}

/* The density is that of the present volume. */
static void set_mass(mps_mpm *mpm, int64_t k, double density) {
  mpsi_columns *p = &mpm->p;
  if (p->V[k] == 0.0) p->V[k] = mpsi_mpm_lattice_volume(mpm, k);
  p->m[k] = density * p->V[k];
  const double mass =
      mpm->grid.geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? p->m[k] / p->x[0][k] : p->m[k];
  if (mass > 0.0 && !(mass >= mpm->contact.least_mass)) mpm->contact.least_mass = mass;
}

void mpsi_mpm_begin_particles(mps_mpm *mpm) {
  const double *density = mpsi_particles_column(mpm->p.set, "density", 0);
  mpm->contact.least_mass = NAN;
  for (int64_t k = 0; k < mpm->p.count; k++) {
    set_mass(mpm, k, density[k]);
    mpsi_mpm_begin_law(mpm, &mpm->p.laws.law[0], k);
  }
}

/* The caller has written density or volume: the mass follows in the particles that changed. Added
 * particles have none yet. */
static mps_status renew_masses(mps_mpm *mpm, const char *function, const char *field,
                               const double *former) {
  const double *density = mpsi_particles_column(mpm->p.set, "density", 0);
  const double *now = strcmp(field, "density") == 0 ? density : mpm->p.V;
  for (int64_t k = 0; k < mpm->p.count; k++) {
    if (now[k] == former[k] || (mpm->p.m[k] == 0.0 && density[k] == 0.0)) continue;
    const mps_status status = check_amount(mpm, function, k, density[k]);
    if (status != MPS_OK) return status;
  }
  for (int64_t k = 0; k < mpm->p.count; k++)
    if (now[k] != former[k]) set_mass(mpm, k, density[k]);
  return MPS_OK;
}

bool mpsi_mpm_compares(const void *self, const char *field) {
  (void)self;
  return strcmp(field, "density") == 0 || strcmp(field, "volume") == 0;
}

/* Fields read again in each step, so that nothing follows from an edit. */
static bool read_by_steps(const char *field) {
  return strcmp(field, "external_force") == 0 || strcmp(field, "body_acceleration") == 0;
}

/* The set has checked that the values are finite and in range. Positions must be in the domain, and
 * the particles are sorted again; the limit follows from all else. */
mps_status mpsi_mpm_note_edit(void *self, const char *function, const char *field,
                              const double *former) {
  mps_mpm *mpm = self;
  const bool moved = strcmp(field, "position") == 0;
  mps_status status = MPS_OK;
  if (read_by_steps(field)) return MPS_OK;
  if (moved) status = mpsi_mpm_check_places(mpm, function, 0, mpm->p.count);
  if (status == MPS_OK && former) status = renew_masses(mpm, function, field, former);
  if (status != MPS_OK) return status;
  mpm->run.edited = true;
  mpm->run.stale = mpm->run.stale || moved;
  if (strcmp(field, "velocity_gradient") == 0) mpm->run.moments = false;
  if (mpm->water && strcmp(field, "pore_pressure") == 0) /* the slopes were those of before */
    for (int c = 0; c < mpm->grid.dim; c++)
      memset(mpm->p.g[c], 0, (size_t)mpm->p.count * sizeof *mpm->p.g[c]);
  return MPS_OK;
}

mps_status mpsi_mpm_check_masses(const mps_mpm *mpm, const char *function) {
  for (int64_t k = 0; k < mpm->p.count; k++) {
    if (mpm->p.m[k] > 0.0) continue;
    const int64_t id = mpsi_particles_integers(mpm->p.set, "id")[k];
    (void)mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                    "particle %lld has come since the last step and has density 0: give it one by "
                    "mps_particles_edit or mps_particles_set of 'density'",
                    (long long)id);
    mpsi_fail_where(mpm->context, -1, id);
    return MPS_ERROR_STATE;
  }
  return MPS_OK;
}

static double determinant(const mps_mpm *mpm, int64_t k) {
  double F[9];
  for (int c = 0; c < 9; c++) F[c] = mpm->p.F[c] ? mpm->p.F[c][k] : 0.0;
  if (mpm->grid.dim == 2) return (F[0] * F[3] - F[1] * F[2]) * F[4];
  return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
         F[2] * (F[3] * F[7] - F[4] * F[6]);
}

mps_status mpsi_mpm_check_deformations(const mps_mpm *mpm, const char *function) {
  for (int64_t k = 0; mpm->p.F[0] && k < mpm->p.count; k++) {
    const mpsi_law_use *law = &mpm->p.laws.law[mpm->p.law ? mpm->p.law[k] : 0];
    const double J = law->needs_deformation ? determinant(mpm, k) : 1.0;
    if (J > 0.0) continue;
    const int64_t id = mpsi_particles_integers(mpm->p.set, "id")[k];
    (void)mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                    "deformation_gradient of particle %lld has the determinant %g, must be above "
                    "0: write all its components at once by mps_particles_edit",
                    (long long)id, J);
    mpsi_fail_where(mpm->context, -1, id);
    return MPS_ERROR_STATE;
  }
  return MPS_OK;
}
