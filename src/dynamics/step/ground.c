/* ground.c - material of the body: fields, or a material in their place; the coefficients of each
 * particle; and fields that the caller edits.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "ground.h"
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/ranks/partition.h"
#include "dynamics/step/begin.h"
#include "material/material_internal.h"
#include "signal/signal_internal.h"
#include "core/definition/digits.h"

#include <string.h>

/* ---- fields ---------------------------------------------------------------------------------- */

#define LEAST 1e-6 /* of density (kg/m3) and wave velocities (m/s) */
#define MOST 1e9

static mps_status fail_particle(mps_particles *particles, int64_t k) {
  mpsi_fail_where(mpsi_particles_context(particles), -1,
                  mpsi_particles_integers(particles, "id")[k]);
  return MPS_ERROR_ARGUMENT;
}

static const char *const wave_fields[2] = {"shear_velocity", "pressure_velocity"};

mps_status mpsi_dynamics_check_ground(mps_particles *particles, const char *function) {
  mps_context *context = mpsi_particles_context(particles);
  const int64_t n = mps_particles_count(particles);
  const int64_t *id = mpsi_particles_integers(particles, "id");
  static const char *const names[3] = {"density", "shear_velocity", "pressure_velocity"};
  const double *column[3];
  for (int f = 0; f < 3; f++) {
    column[f] = mpsi_particles_column(particles, names[f], 0);
    if (!column[f])
      return mpsi_fail(context, function, MPS_ERROR_FIELD,
                       "the particle set has no field '%s': set it with mps_particles_set%s",
                       names[f], f == 0 ? "" : ", or give a material");
    for (int64_t k = 0; k < n; k++)
      if (!(column[f][k] >= LEAST && column[f][k] <= MOST)) {
        (void)mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                        "%s of particle %lld is %s, must be in 1e-6 to 1e9 %s", names[f],
                        (long long)id[k], mpsi_outside(column[f][k], LEAST, MOST).text,
                        f == 0 ? "kg/m3" : "m/s");
        return fail_particle(particles, k);
      }
  }
  const double *damping = mpsi_particles_column(particles, "damping", 0);
  for (int64_t k = 0; k < n; k++) {
    if (column[2][k] < sqrt(2.0) * column[1][k] * (1.0 - 1e-12)) {
      (void)mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                      "pressure_velocity of particle %lld is %g m/s, must be at least sqrt(2) "
                      "times its shear_velocity %g m/s (lambda >= 0)",
                      (long long)id[k], column[2][k], column[1][k]);
      return fail_particle(particles, k);
    }
    if (damping && !(damping[k] >= 0.0 && damping[k] <= 1000.0)) {
      (void)mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                      "damping of particle %lld is %s, must be in 0 to 1000", (long long)id[k],
                      mpsi_outside(damping[k], 0.0, 1000.0).text);
      return fail_particle(particles, k);
    }
  }
  return MPS_OK;
}

mps_status mpsi_dynamics_present_energy(mps_dynamics *dynamics, const char *function,
                                        double *energy) {
  double kinetic = 0.0, strain = 0.0;
  const mps_status status =
      dynamics->begun ? mpsi_dynamics_energies(dynamics, function, &kinetic, &strain) : MPS_OK;
  *energy = kinetic + strain;
  return status;
}

/* Reads the material fields. */
static mps_status read_ground(mps_dynamics *dynamics, const char *function) {
  mps_domain *domain = dynamics->domain;
  double before = 0.0, after = 0.0;
  mps_status status = mpsi_dynamics_check_ground(dynamics->particles, function);
  status = mpsi_domain_agree(domain, function, mpsi_fail_of(dynamics->context, status, "dynamics"));
  if (status == MPS_OK) /* an error before anything has changed */
    status = mpsi_domain_agree(domain, function, mpsi_dynamics_reserve_watch(dynamics, function));
  if (status == MPS_OK) status = mpsi_dynamics_present_energy(dynamics, function, &before);
  if (status != MPS_OK) return status;
  double other = mpsi_dynamics_set_coefficients(dynamics);
  status = mpsi_dynamics_join_coefficients(dynamics, function, MPS_OK);
  if (status == MPS_OK) status = mpsi_domain_max(domain, function, 1, &other);
  if (status == MPS_OK && other != 0.0) {
    status = mpsi_dynamics_present_energy(dynamics, function, &after);
    dynamics->works.start += after - before;
    mpsi_dynamics_renew_dashpots(dynamics);
    mpsi_dynamics_forget_limit(dynamics);
    dynamics->no_rate = dynamics->forces_stale = true;
  }
  return status;
}

/* ---- a material ------------------------------------------------------------------------------ */

/* Wave velocities (m/s) of a material, of which `modulus` are those of unit density. */
static mps_status check_velocities(mps_particles *particles, const char *function,
                                   const mps_moduli *modulus, int64_t k, double *vs, double *vp) {
  mps_context *context = mpsi_particles_context(particles);
  const double density = mpsi_particles_column(particles, "density", 0)[k];
  *vs = sqrt(modulus->shear / density), *vp = sqrt(modulus->wave / density);
  if (density >= LEAST && density <= MOST && *vs >= LEAST && *vp <= MOST) return MPS_OK;
  (void)mpsi_fail(
      context, function, MPS_ERROR_ARGUMENT,
      "material: particle %lld has density %g kg/m3 and so wave velocities of %g and %g m/s: all "
      "must be in 1e-6 to 1e9",
      (long long)mpsi_particles_integers(particles, "id")[k], density, *vs, *vp);
  return fail_particle(particles, k);
}

mps_status mpsi_dynamics_write_material(mps_particles *particles, const char *function,
                                        const mps_material *material, int64_t count,
                                        const int64_t *ids) {
  mps_context *context = mpsi_particles_context(particles);
  mps_moduli m = {0};
  mps_status status = mpsi_material_check_elastic(context, function, material);
  if (status == MPS_OK) status = mpsi_particles_check_ids_or_all(particles, function, count, ids);
  if (status == MPS_OK)
    status = mpsi_as(context, function, mps_material_get_moduli(material, 1.0, &m));
  if (status != MPS_OK) return status;
  if (m.lambda < -1e-12 * m.shear)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "Poisson's ratio of the material is %g, must be at least 0 (lambda >= 0)",
                     m.poisson);
  if (!mpsi_particles_column(particles, "density", 0))
    return mpsi_fail(context, function, MPS_ERROR_FIELD,
                     "the particle set has no field 'density': set it with mps_particles_set");
  const int64_t most = ids ? count : mps_particles_count(particles);
  for (int pass = 0; pass < 2 && status == MPS_OK; pass++) { /* first all are checked */
    double *const column[2] = {mpsi_particles_column(particles, "shear_velocity", 0),
                               mpsi_particles_column(particles, "pressure_velocity", 0)};
    for (int64_t i = 0; i < most && status == MPS_OK; i++) {
      const int64_t k = ids ? mps_particles_index(particles, ids[i]) : i;
      double vs, vp;
      status = check_velocities(particles, function, &m, k, &vs, &vp);
      if (pass == 1) column[0][k] = vs, column[1][k] = vp;
    }
    if (status == MPS_OK && pass == 0)
      status = mpsi_as(context, function, mps_particles_add_field(particles, "shear_velocity", 0));
    if (status == MPS_OK && pass == 0)
      status =
          mpsi_as(context, function, mps_particles_add_field(particles, "pressure_velocity", 0));
  }
  return status;
}

/* Of a list of particles, those on this rank. */
static mps_status write_own(mps_dynamics *dynamics, const char *function, mps_status status,
                            const mps_material *material, int64_t count, const int64_t *ids) {
  mps_context *context = dynamics->context;
  int64_t *own = mpsi_alloc(context, count < 0 ? 0 : count, sizeof *own), here = 0, known = 0;
  if (status == MPS_OK && !own) status = mpsi_fail_memory(context, function, (size_t)count * 8);
  for (int64_t k = 0; own && k < count; k++) {
    const int64_t i = mps_particles_index(dynamics->particles, ids[k]);
    if (i < 0) continue;
    own[here++] = ids[k];
    known += i < dynamics->body || dynamics->lead;
  }
  status = mpsi_domain_agree(dynamics->domain, function, status);
  if (status == MPS_OK) status = mpsi_domain_sum(dynamics->domain, function, 1, &known);
  if (status == MPS_OK && known != count)
    status = mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "of %lld ids %lld are of particles of the set on any rank", (long long)count,
                       (long long)known);
  if (status == MPS_OK && here > 0)
    status = mpsi_dynamics_write_material(dynamics->particles, function, material, here, own);
  mpsi_free(context, own);
  return mpsi_domain_agree(dynamics->domain, function, status);
}

/* A copy of the wave velocities of all particles here, to be restored on an error: NULL without
 * memory. */
static double *keep_velocities(const mps_dynamics *dynamics, const char *function,
                               mps_status *status) {
  const int64_t n = mps_particles_count(dynamics->particles);
  double *kept = mpsi_alloc(dynamics->context, 2 * n, sizeof *kept);
  if (!kept && *status == MPS_OK)
    *status = mpsi_fail_memory(dynamics->context, function, (size_t)n * 2 * sizeof *kept);
  for (int f = 0; kept && f < 2; f++) {
    const double *column = mpsi_particles_column(dynamics->particles, wave_fields[f], 0);
    if (column) memcpy(kept + f * n, column, (size_t)n * sizeof *kept);
  }
  return kept;
}

static void restore_velocities(mps_dynamics *dynamics, const double *kept) {
  const int64_t n = mps_particles_count(dynamics->particles);
  for (int f = 0; f < 2; f++) {
    double *column = mpsi_particles_column(dynamics->particles, wave_fields[f], 0);
    if (column) memcpy(column, kept + f * n, (size_t)n * sizeof *kept);
  }
}

mps_status mps_dynamics_set_material(mps_dynamics *dynamics, const mps_material *material,
                                     const int64_t *ids, int64_t count) {
  if (!dynamics) return mpsi_null(__func__, "dynamics");
  mps_status status = mpsi_dynamics_enter(dynamics, __func__);
  if (status == MPS_OK) status = mpsi_particles_ready(dynamics->particles, __func__);
  double *kept = status == MPS_OK ? keep_velocities(dynamics, __func__, &status) : NULL;
  mpsi_given given = MPSI_GIVEN;
  mpsi_give(&given, "having a list of ids", ids != NULL);
  mpsi_give(&given, "count", (double)count);
  mpsi_give_bytes(&given, "a hash of ids", count > 0 ? ids : NULL, (size_t)count * sizeof *ids);
  mpsi_material_give(&given, material);
  status = mpsi_domain_agree_given(dynamics->domain, __func__, status, &given);
  const bool agreed = status == MPS_OK;
  if (mpsi_domain_many(dynamics->domain) && ids) {
    status = write_own(dynamics, __func__, status, material, count, ids);
  } else {
    if (status == MPS_OK)
      status = mpsi_dynamics_write_material(dynamics->particles, __func__, material, count, ids);
    status = mpsi_domain_agree(dynamics->domain, __func__, status);
  }
  /* values of other particles, or of another rank, may be out of range */
  if (status == MPS_OK) status = read_ground(dynamics, __func__);
  if (status != MPS_OK && agreed) restore_velocities(dynamics, kept);
  mpsi_free(dynamics->context, kept);
  return status;
}

/* ---- edits ----------------------------------------------------------------------------------- */

static bool is_one_of(const char *name, const char *const *names, size_t count,
                      const char **which) {
  for (size_t k = 0; k < count; k++)
    if (strcmp(names[k], name) == 0) {
      *which = names[k];
      return true;
    }
  return false;
}
#define ONE_OF(name, names, which) is_one_of(name, names, sizeof(names) / sizeof *(names), which)

/* Positions follow from reference positions and displacements. */
static mps_status check_positions(const mps_dynamics *dynamics, const char *function) {
  const mpsi_dynamics_state *s = &dynamics->state;
  const double *const r[2] = {s->rx, s->ry}, *const d[2] = {s->dx, s->dy};
  for (int c = 0; c < 2; c++) {
    const double *x = mpsi_dynamics_column(dynamics, "position", c);
    for (int64_t k = 0; k < dynamics->count; k++)
      if (x[k] != r[c][k] + d[c][k])
        return mpsi_fail(dynamics->context, function, MPS_ERROR_STATE,
                         "the particle set is held by a solver of elastodynamics, to which "
                         "positions are reference positions plus displacements: write the former "
                         "ones back and edit 'displacement', or destroy the solver first");
  }
  return MPS_OK;
}

mps_status mpsi_dynamics_commit(void *self, const char *function, const char *field,
                                const double *former) {
  static const char *const ground[] = {"density", "shear_velocity", "pressure_velocity", "damping"};
  static const char *const motion[] = {"displacement",     "velocity",     "rotation",     "spin",
                                       "displacement_old", "rotation_old", "restoring_old"};
  static const char *const fabric[] = {"reference", "free_field"};
  mps_dynamics *dynamics = self;
  const char *which = NULL;
  mps_status status = MPS_OK;
  dynamics->limits.changed = true;
  const bool of_ground = ONE_OF(field, ground, &which), of_motion = ONE_OF(field, motion, &which);
  const bool of_fabric = ONE_OF(field, fabric, &which), position = strcmp(field, "position") == 0;
  if (!of_ground && !of_motion && !of_fabric && !position) return MPS_OK;
  if (position) status = check_positions(dynamics, function);
  if (of_ground && !mpsi_domain_many(dynamics->domain) &&
      mpsi_dynamics_check_ground(dynamics->particles, function) == MPS_OK)
    status = read_ground(dynamics, function);
  else if (of_ground)
    dynamics->unread = true; /* a field consistent with it may be edited next: the step checks */
  if (of_motion && !dynamics->broken) dynamics->rewritten = which;
  if (of_motion && strcmp(which, "rotation") == 0) /* totals may be queried before it begins */
    dynamics->kernels->trig[dynamics->def.rotation](&dynamics->state, 0, dynamics->count);
  if (of_fabric) dynamics->broken = which;
  return status;
}

/* Whether a boundary's or load's signal may fail. */
static bool has_refusing_signal(const mps_dynamics *dynamics) {
  for (int c = 0; c < 2; c++) {
    for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++)
      if (mpsi_dynamics_boundary_of(dynamics, k) &&
          mpsi_signal_may_fail(mpsi_dynamics_boundary_of(dynamics, k)->part.signal[c]))
        return true;
    for (int32_t k = 0; k < mpsi_dynamics_load_count(dynamics); k++)
      if (mpsi_dynamics_load_of(dynamics, k) &&
          mpsi_signal_may_fail(mpsi_dynamics_load_of(dynamics, k)->part.signal[c]))
        return true;
  }
  return false;
}

mps_status mpsi_dynamics_reread_ground(mps_dynamics *dynamics, const char *function,
                                       mps_status status) {
  double edited[3] = {dynamics->unread, dynamics->rewritten != NULL, has_refusing_signal(dynamics)};
  if (status != MPS_OK)
    ; /* as before the call */
  else if (dynamics->broken)
    status =
        mpsi_fail(dynamics->context, function, MPS_ERROR_STATE,
                  "field '%s' has been written, which the solver relies on: "
                  "mps_dynamics_rollback or mps_dynamics_restore recovers it, else make a new one",
                  dynamics->broken);
  else if (dynamics->rewritten && !dynamics->fresh)
    status = mpsi_fail(dynamics->context, function, MPS_ERROR_STATE,
                       "field '%s' has been written: mps_dynamics_restart begins a motion from "
                       "it, mps_dynamics_rollback recovers it",
                       dynamics->rewritten);
  status = mpsi_domain_agree_max(dynamics->domain, function, status, 3, edited);
  if (status == MPS_OK) dynamics->cautious = edited[2] != 0.0;
  if (status == MPS_OK && edited[0] != 0.0) status = read_ground(dynamics, function);
  if (status != MPS_OK) return status;
  dynamics->unread = false;
  dynamics->begins = edited[1] != 0.0;
  return MPS_OK;
}

mps_status mpsi_dynamics_read_edits(mps_dynamics *dynamics, const char *function,
                                    mps_status status) {
  status = mpsi_dynamics_reread_ground(dynamics, function, status);
  if (status != MPS_OK || !dynamics->begins) return status;
  return mpsi_dynamics_begin(dynamics, function, mpsi_dynamics_time(dynamics));
}
