/* mpm_particles.c - the particles as the solver uses them: columns over the fields of the set,
 * initial state, masses, checks. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_particles.h"

#include "mpm/water/water.h"

#include <string.h>

#define DENSITY_MIN 1e-9 /* kg/m3 */
#define DENSITY_MAX 1e12

/* ---- columns --------------------------------------------------------------------------------- */

/* Columns of pore water; NULL without water, though the set may have such fields. */
static void bind_water(mps_particles *set, mpsi_columns *p, const mpsi_water *water) {
  p->u = water ? mpsi_particles_column(set, "pore_pressure", 0) : NULL;
  p->slow = p->u;
  if (water && !mpsi_pore_responds(water))
    p->slow = mpsi_particles_column(set, "pore_pressure_mean", 0);
  p->n = water ? mpsi_particles_column(set, "porosity", 0) : NULL;
  p->k = water ? mpsi_particles_column(set, "permeability", 0) : NULL;
  for (int c = 0; c < 3; c++)
    p->g[c] = water ? mpsi_particles_column(set, "pore_pressure_gradient", c) : NULL;
}

void mpsi_mpm_bind(const mpsi_grid *grid, mpsi_columns *p, mpsi_water *water) {
  mps_particles *set = p->set;
  p->count = mps_particles_count(set);
  for (int c = 0; c < grid->dim; c++) {
    p->x[c] = mpsi_particles_column(set, "position", c);
    p->v[c] = mpsi_particles_column(set, "velocity", c);
  }
  for (int c = 0; c < 2 * grid->dim; c++) p->s[c] = mpsi_particles_column(set, "stress", c);
  bind_water(set, p, water);
  p->K_w = water ? water->def.bulk : 0.0;
  for (int c = 0; c < 9; c++) /* NULL where there is no such component */
    p->L[c] = mpsi_particles_column(set, "velocity_gradient", c);
  p->V = mpsi_particles_column(set, "volume", 0);
  p->m = mpsi_particles_column(set, "mass", 0);
  if (p->law) p->law = mpsi_particles_integers(set, "material");
  for (int32_t k = 0; k < p->laws.count; k++) mpsi_mpm_bind_law(p, &p->laws.law[k]);
}

/* ---- checks ---------------------------------------------------------------------------------- */

mps_status mpsi_mpm_check_places(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                 const mps_mpm_def *def, const char *function, int64_t first,
                                 int64_t end) {
  const int64_t *id = mpsi_particles_integers(p->set, "id");
  for (int64_t k = first; k < end; k++)
    for (int c = 0; c < grid->dim; c++) {
      const double x = p->x[c][k], X = mpsi_grid_at(grid, c, x);
      if (!(fabs(X) < MPSI_MAX_CELLS))
        return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                         "particle %lld has %c = %g m, more than 2^30 cells from the origin",
                         (long long)id[k], "xyz"[c], x);
      if (!(X >= (double)grid->low[c] && X <= (double)grid->high[c]))
        return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                         "particle %lld has %c = %g m, outside the domain [%g, %g] m",
                         (long long)id[k], "xyz"[c], x, def -> lower[c], def -> upper[c]);
    }
  return MPS_OK;
}

mps_status mpsi_mpm_check_start(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                const mps_mpm_def *def, const char *function) {
  static const char *const names[] = {
      "position",          "velocity",      "velocity_gradient", "stress",
      "volume_ratio",      "volume",        "density",           "deformation_gradient",
      "body_acceleration", "external_force"};
  for (size_t f = 0; f < sizeof names / sizeof *names; f++)
    for (int32_t c = 0; c < 9; c++) {
      const double *value = mpsi_particles_column(p->set, names[f], c);
      for (int64_t k = 0; value && k < p->count; k++)
        if (!isfinite(value[k]))
          return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                           "'%s' of particle %lld is %g, must be finite", names[f],
                           (long long)mpsi_particles_integers(p->set, "id")[k], value[k]);
    }
  return mpsi_mpm_check_places(context, grid, p, def, function, 0, p->count);
}

mps_status mpsi_mpm_check_lost(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                               const mpsi_run *run, const mps_mpm_def *def, const char *function) {
  if (!run->lost || mpsi_mpm_check_places(context, grid, p, def, function, 0, p->count) == MPS_OK)
    return MPS_OK;
  mps_error found = *mps_context_error(context);
  return mpsi_fail(context, function, MPS_ERROR_STATE,
                   "%s, since the last step: edit its position, remove it or roll back",
                   found.message);
}

/* ---- volume and mass ------------------------------------------------------------------------- */

double mpsi_mpm_lattice_volume(const mpsi_grid *grid, const mpsi_columns *p, int64_t k) {
  const double spacing = mps_particles_spacing(p->set);
  if (grid->dim == 3) return spacing * spacing * spacing;
  const double radius = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? p->x[0][k] : 1.0;
  return spacing * spacing * grid->measure * radius;
}

static mps_status check_amount(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                               const char *function, int64_t k, double density) {
  const double volume = p->V[k] != 0.0 ? p->V[k] : mpsi_mpm_lattice_volume(grid, p, k);
  const double ratio = !p->J ? 1.0 : p->J[k] != 0.0 ? p->J[k] : 1.0;
  if (density >= DENSITY_MIN && density <= DENSITY_MAX && volume > 0.0 && ratio > 0.0)
    return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "particle %lld has density %g kg/m3, volume %g m3 and volume ratio %g: must "
                   "be %g to %g, > 0 and > 0%s",
                   (long long)mpsi_particles_integers(p->set, "id")[k], density, volume, ratio,
                   DENSITY_MIN, DENSITY_MAX, volume == 0.0 ? " (it lies on the axis, r = 0)" : "");
}

mps_status mpsi_mpm_check_amounts(mps_context *context, const mpsi_grid *grid,
                                  const mpsi_columns *p, const char *function) {
  const double *density = mpsi_particles_column(p->set, "density", 0);
  for (int64_t k = 0; k < p->count; k++)
    MPSI_TRY(check_amount(context, grid, p, function, k, density[k]));
  return MPS_OK;
}

/* Mass of a particle from its density in the present volume. */
static void set_mass(const mpsi_grid *grid, const mpsi_columns *p, mpsi_contacts *contacts,
                     int64_t k, double density) {
  if (p->V[k] == 0.0) p->V[k] = mpsi_mpm_lattice_volume(grid, p, k);
  p->m[k] = density * p->V[k];
  const double mass =
      grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? p->m[k] / p->x[0][k] : p->m[k];
  if (mass > 0.0 && !(mass >= contacts->least_mass)) contacts->least_mass = mass;
}

void mpsi_mpm_begin_particles(const mpsi_grid *grid, const mpsi_columns *p,
                              mpsi_contacts *contacts) {
  const double *density = mpsi_particles_column(p->set, "density", 0);
  contacts->least_mass = NAN;
  for (int64_t k = 0; k < p->count; k++) {
    set_mass(grid, p, contacts, k, density[k]);
    mpsi_mpm_begin_law(grid, p, &p->laws.law[0], k);
  }
}

mps_status mpsi_mpm_renew_masses(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                 mpsi_contacts *contacts, const char *function, const char *field,
                                 const double *former) {
  const double *density = mpsi_particles_column(p->set, "density", 0);
  const double *now = strcmp(field, "density") == 0 ? density : p->V;
  for (int64_t k = 0; k < p->count; k++) {
    if (now[k] == former[k] || (p->m[k] == 0.0 && density[k] == 0.0)) continue;
    MPSI_TRY(check_amount(context, grid, p, function, k, density[k]));
  }
  for (int64_t k = 0; k < p->count; k++)
    if (now[k] != former[k]) set_mass(grid, p, contacts, k, density[k]);
  return MPS_OK;
}

mps_status mpsi_mpm_check_masses(mps_context *context, const mpsi_columns *p,
                                 const char *function) {
  for (int64_t k = 0; k < p->count; k++) {
    if (p->m[k] > 0.0) continue;
    const int64_t id = mpsi_particles_integers(p->set, "id")[k];
    (void)mpsi_fail(context, function, MPS_ERROR_STATE,
                    "particle %lld has come since the last step and has density 0: give it one by "
                    "mps_particles_edit or mps_particles_set of 'density'",
                    (long long)id);
    mpsi_fail_where(context, -1, id);
    return MPS_ERROR_STATE;
  }
  return MPS_OK;
}

static double determinant(const mpsi_grid *grid, const mpsi_columns *p, int64_t k) {
  double F[9];
  for (int c = 0; c < 9; c++) F[c] = p->F[c] ? p->F[c][k] : 0.0;
  if (grid->dim == 2) return (F[0] * F[3] - F[1] * F[2]) * F[4];
  return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
         F[2] * (F[3] * F[7] - F[4] * F[6]);
}

mps_status mpsi_mpm_check_deformations(mps_context *context, const mpsi_grid *grid,
                                       const mpsi_columns *p, const char *function) {
  for (int64_t k = 0; p->F[0] && k < p->count; k++) {
    const mpsi_law_use *law = &p->laws.law[p->law ? p->law[k] : 0];
    const double J = law->needs_deformation ? determinant(grid, p, k) : 1.0;
    if (J > 0.0) continue;
    const int64_t id = mpsi_particles_integers(p->set, "id")[k];
    (void)mpsi_fail(context, function, MPS_ERROR_STATE,
                    "deformation_gradient of particle %lld has the determinant %g, must be above "
                    "0: write all its components at once by mps_particles_edit",
                    (long long)id, J);
    mpsi_fail_where(context, -1, id);
    return MPS_ERROR_STATE;
  }
  return MPS_OK;
}
