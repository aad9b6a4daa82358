/* dynamics.c - life of the explicit MPS solver: definition, checks, storage.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/life/change.h"
#include "dynamics/life/removal.h"
#include "dynamics/ranks/partition.h"
#include "dynamics/step/begin.h"
#include "dynamics/step/ground.h"

#include "core/particles/particles_internal.h"
#include "core/context/retain.h"
#include "core/state/state.h"
#include "material/material_internal.h"
#include "core/base/digits.h"

#include <mps/experimental.h>

static const mps_dynamics_def dynamics_defaults = {
    .struct_size = sizeof(mps_dynamics_def),
    .integrator = MPS_DYNAMICS_INTEGRATOR_VERLET,
    .rotation = MPS_DYNAMICS_ROTATION_MEAN_MATRIX,
    .damping = MPS_DYNAMICS_DAMPING_PAIR,
    .dt = NAN,
    .courant = 0.9,
    .radius_ratio = 1.5,
    .f1 = 1.0,
    .f2 = 14.0,
    .period_x = NAN,
    .divergence = 1e15,
    .measure = 1.0,
};

mps_status mps_dynamics_def_init(mps_dynamics_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_dynamics_def, def, size, &dynamics_defaults);
}

/* ---- checks ---------------------------------------------------------------------------------- */

static mps_status check_choices(mps_context *context, const mps_dynamics_def *def) {
  static const char *const function = "mps_dynamics_create";
  const struct {
    const char *name, *allowed;
    int32_t value, most;
  } checks[] = {
      {"integrator", "0 (Verlet), 1 (leapfrog), 2 (Euler)", def->integrator, 2},
      {"rotation", "0 (mean matrix), 1 (mean angle)", def->rotation, 1},
      {"damping", "0 (pair), 1 (particle)", def->damping, 1},
      {"watch_damping", "0 and 1", def->watch_damping, 1},
      {"reserved", "0", def->reserved, 0},
  };
  for (size_t k = 0; k < sizeof checks / sizeof *checks; k++)
    if (checks[k].value < 0 || checks[k].value > checks[k].most)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %d, allowed are %s",
                       checks[k].name, checks[k].value, checks[k].allowed);
  return MPS_OK;
}

static mps_status check_numbers(mps_context *context, const mps_dynamics_def *def) {
  const struct {
    const char *name, *unit;
    double value, least, most;
    bool open, may_lack; /* `least` itself is not allowed; NaN is */
  } checks[] = {
      {"dt", " s, or NaN (chosen by the library)", def->dt, MPSI_DYN_LEAST_DT, MPSI_DYN_MOST_DT,
       false, true},
      {"courant", "", def->courant, 0.0, 1.0, true, false},
      {"radius_ratio", "", def->radius_ratio, 1.0, 4.0, true, false},
      {"f1", " Hz", def->f1, 1e-20, 1e9, false, false},
      {"f2", " Hz", def->f2, 1e-20, 1e9, false, false},
      {"period_x", " m, or NaN (none)", def->period_x, 0.0, 1e300, true, true},
      {"divergence", " m/s2", def->divergence, 0.0, 1e300, true, false},
      {"measure", " m", def->measure, 1e-9, 1e9, false, false},
  };
  for (size_t k = 0; k < sizeof checks / sizeof *checks; k++) {
    const double value = checks[k].value;
    const bool above = checks[k].open ? value > checks[k].least : value >= checks[k].least;
    if ((above && value <= checks[k].most) || (isnan(value) && checks[k].may_lack)) continue;
    return mpsi_fail(context, "mps_dynamics_create", MPS_ERROR_ARGUMENT,
                     "%s is %s, must be %s %g and at most %g%s", checks[k].name,
                     mpsi_outside(value, checks[k].least, checks[k].most).text,
                     checks[k].open ? "above" : "at least", checks[k].least, checks[k].most,
                     checks[k].unit);
  }
  return MPS_OK;
}

/* Positions and fields of the initial state, where present, must be finite. */
static mps_status check_state(mps_context *context, mps_particles *particles) {
  static const char *const names[] = {"position", "displacement", "rotation", "velocity", "spin"};
  const int64_t n = mps_particles_count(particles);
  for (size_t f = 0; f < sizeof names / sizeof *names; f++)
    for (int c = 0; c < 2; c++) {
      const double *column = mpsi_particles_column(particles, names[f], c);
      for (int64_t k = 0; column && k < n; k++)
        if (!isfinite(column[k]))
          return mpsi_fail(context, "mps_dynamics_create", MPS_ERROR_ARGUMENT,
                           "particles: %s of particle %lld is %g, must be finite", names[f],
                           (long long)mpsi_particles_integers(particles, "id")[k], column[k]);
    }
  return MPS_OK;
}

/* Least and greatest position without the displacement that particles may have, m. */
static void extent(mps_particles *particles, int32_t component, double *lo, double *hi) {
  const double *x = mpsi_particles_column(particles, "position", component);
  const double *d = mpsi_particles_column(particles, "displacement", component);
  *lo = INFINITY, *hi = -INFINITY;
  for (int64_t k = 0; k < mps_particles_count(particles); k++) {
    const double at = x[k] - (d ? d[k] : 0.0);
    *lo = fmin(*lo, at), *hi = fmax(*hi, at);
  }
}

/* `lo` and `hi`: bounds of the set, on whatever rank, m. */
static mps_status check_geometry(mps_context *context, mps_particles *particles,
                                 const mps_dynamics_def *def, const double *lo, const double *hi) {
  static const char *const function = "mps_dynamics_create";
  const bool parts = mpsi_particles_deal(particles) && mpsi_particles_made(particles) > 0;
  const int64_t n = mps_particles_count(particles);
  if (mps_particles_dim(particles) != 2)
    return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                     "the particle set has dim %d: the solver is for plane strain, dim 2",
                     mps_particles_dim(particles));
  if (n < (parts ? 0 : 1) || n > INT32_MAX)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "the particle set has %lld particles, allowed are 1 to %d", (long long)n,
                     INT32_MAX);
  const int64_t *side = mpsi_particles_integers(particles, "free_field");
  const double D = mps_particles_spacing(particles);
  const double re = def->kernel ? mps_kernel_radius(def->kernel) : def->radius_ratio * D;
  if (!(re > D && re <= 4.0 * D * (1.0 + 1e-12)))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "the kernel's radius of influence is %s m, must be above the spacing %g m and "
                     "at most 4 times that",
                     mpsi_outside(re, D, 4.0 * D).text, D);
  int64_t body = 0;
  for (int64_t k = 0; k < n; k++) {
    if (side && (side[k] < 0 || side[k] > MPS_DYNAMICS_SIDE_RIGHT))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "free_field of particle %lld is %lld, allowed are 0, 1 (left), 2 (right)",
                       (long long)mpsi_particles_integers(particles, "id")[k], (long long)side[k]);
    body += !(side && side[k]);
  }
  if (parts && body < n)
    return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                     "%lld particles here belong to free-field columns, which a set in parts "
                     "(mps_domain_create_particles) cannot have: use mps_particles_create",
                     (long long)(n - body));
  for (int c = 0; c < 2; c++)
    if (!(hi[c] - lo[c] <= MPSI_DYN_MOST_SPACINGS * D))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "the particles reach from %g m to %g m in %c, allowed are %g spacings",
                       lo[c], hi[c], c == 0 ? 'x' : 'y', MPSI_DYN_MOST_SPACINGS);
  if (body == 0 && !parts)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "all %lld particles belong to free-field columns, a body is needed",
                     (long long)n);
  if (def->period_x > 0.0 && body < n)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "period_x is %g m, must be NaN with free-field columns", def->period_x);
  if (def->period_x > 0.0 && (def->period_x <= re || def->period_x <= hi[0] - lo[0]))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "period_x is %s m, must be above re = %g m and the body's width %g m "
                     "between outer particle centres",
                     mpsi_outside(def->period_x, fmax(re, hi[0] - lo[0]), INFINITY).text, re,
                     hi[0] - lo[0]);
  return MPS_OK;
}

/* Bounds of the set, of all ranks' parts. Collective where there is a domain. */
static mps_status find_extent(mps_particles *particles, mps_domain *domain, mps_status status,
                              double *lo, double *hi) {
  for (int c = 0; c < 2; c++) lo[c] = INFINITY, hi[c] = -INFINITY;
  for (int c = 0; c < 2 && status == MPS_OK; c++) extent(particles, c, &lo[c], &hi[c]);
  if (!mpsi_domain_many(domain)) return status;
  status = mpsi_domain_agree_parts(domain, "mps_dynamics_create", status, particles);
  if (status != MPS_OK || !mpsi_particles_deal(particles)) return status;
  double most[4] = {-lo[0], -lo[1], hi[0], hi[1]};
  status = mpsi_domain_max(domain, "mps_dynamics_create", 4, most);
  for (int c = 0; c < 2; c++) lo[c] = -most[c], hi[c] = most[2 + c];
  return status;
}

/* ---- life ------------------------------------------------------------------------------------ */

/* The weight function, and n0: the interior value for every particle, no dummies. */
static mps_status choose_kernel(mps_dynamics *dynamics) {
  mps_status status = MPS_OK;
  dynamics->spacing = mps_particles_spacing(dynamics->particles);
  dynamics->radius = dynamics->def.radius_ratio * dynamics->spacing;
  if (dynamics->def.kernel) {
    dynamics->kernel = mpsi_kernel_retain(dynamics->def.kernel);
    dynamics->radius = mps_kernel_radius(dynamics->kernel);
  } else {
    status = mpsi_fail_of(
        dynamics->context,
        mps_kernel_create(dynamics->context, MPS_KERNEL_MPS, dynamics->radius, &dynamics->kernel),
        "radius_ratio");
  }
  if (status != MPS_OK) return status;
  return mps_kernel_density(dynamics->context, dynamics->kernel, 2, dynamics->spacing,
                            &dynamics->density);
}

static mps_status build(mps_dynamics *dynamics, mpsi_storage **former, mpsi_backup *backup) {
  static const char *const function = "mps_dynamics_create";
  mpsi_dynamics_structure made;
  dynamics->torque = 1.0;
  mps_status status = mpsi_as(dynamics->context, "mps_dynamics_create", choose_kernel(dynamics));
  if (status == MPS_OK && dynamics->def.material)
    status = mpsi_dynamics_write_material(dynamics->particles, function, dynamics->def.material, 0,
                                          NULL);
  if (status == MPS_OK)
    status = mpsi_fail_of(dynamics->context,
                          mpsi_dynamics_check_ground(dynamics->particles, function), "particles");
  if (mpsi_domain_many(dynamics->domain)) {
    status = mpsi_dynamics_take_partition(dynamics, function, status, &made, former, backup);
  } else {
    if (status == MPS_OK) status = mpsi_dynamics_add_fields(dynamics, "mps_dynamics_create");
    if (status == MPS_OK) status = mpsi_dynamics_sort(dynamics, function);
    if (status == MPS_OK) status = mpsi_dynamics_make_structure(dynamics, function, NULL, &made);
  }
  if (status != MPS_OK) return status;
  mpsi_dynamics_use_structure(dynamics, &made);
  status = mpsi_dynamics_join_coefficients(dynamics, function, MPS_OK);
  if (status == MPS_OK) status = mpsi_dynamics_reserve_watch(dynamics, function);
  if (status == MPS_OK) status = mpsi_dynamics_list_boundaries(dynamics, function);
  status = mpsi_domain_agree(dynamics->domain, function, status);
  if (status == MPS_OK) status = mpsi_dynamics_begin(dynamics, function, 0.0);
  return status;
}
/* Holds the set, which may be held, and copies the definition. */
static void describe(mps_dynamics *dynamics, const mps_dynamics_def *def) {
  dynamics->holder = (mpsi_holder){.name = "a solver of elastodynamics (mps_dynamics)",
                                   .self = dynamics,
                                   .kind = MPSI_USE_MOVE,
                                   .guard = &dynamics->guard,
                                   .commit = mpsi_dynamics_commit,
                                   .remove = mpsi_dynamics_remove,
                                   .renew = mpsi_dynamics_renew};
  (void)mpsi_particles_hold(dynamics->particles, "mps_dynamics_create", &dynamics->holder);
  dynamics->def = *def;
  if (def->kernel)
    dynamics->def.radius_ratio =
        mps_kernel_radius(def->kernel) / mps_particles_spacing(dynamics->particles);
  dynamics->count = mps_particles_count(dynamics->particles);
  dynamics->kernels = mpsi_dynamics_kernels_select(mpsi_context_level(dynamics->context));
  dynamics->dt = def->dt;
  dynamics->fresh = true;
  if (def->material) dynamics->def.material = mpsi_material_retain(def->material);
  dynamics->domain = mpsi_domain_retain(def->domain);
  dynamics->lead = true;
}

mps_status mps_dynamics_create(mps_context *context, mps_particles *particles,
                               const mps_dynamics_def *user_def, mps_dynamics **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_dynamics_def def = dynamics_defaults;
  mps_status status = mpsi_particles_check_context(particles, context, __func__);
  if (status == MPS_OK && user_def)
    status = MPSI_DEF_READ(context, __func__, mps_dynamics_def, user_def, &def);
  if (status == MPS_OK) status = mpsi_domain_check(context, __func__, def.domain);
  if (status != MPS_OK) return status;
  if (def.kernel) def.radius_ratio = dynamics_defaults.radius_ratio; /* not read */
  if (status == MPS_OK) status = check_choices(context, &def);
  if (status == MPS_OK) status = check_numbers(context, &def);
  if (status == MPS_OK) status = check_state(context, particles);
  if (status == MPS_OK) status = mpsi_particles_check_hold(particles, __func__, MPSI_USE_MOVE);
  if (status == MPS_OK) status = mpsi_particles_check_deal(particles, __func__, def.domain);
  double lo[2], hi[2];
  status = find_extent(particles, def.domain, status, lo, hi);
  if (status == MPS_OK) status = check_geometry(context, particles, &def, lo, hi);
  mpsi_backup backup = {0};
  mpsi_storage *former = NULL;
  mps_dynamics *dynamics = NULL;
  const bool parts = mpsi_particles_deal(particles) != NULL;
  const int32_t fields = mps_particles_field_count(particles);
  if (status == MPS_OK && !parts) status = mpsi_particles_back_up(particles, __func__, &backup);
  if (status == MPS_OK && !(dynamics = mpsi_alloc(context, 1, sizeof *dynamics)))
    status = mpsi_fail_memory(context, __func__, sizeof *dynamics);
  status = mpsi_domain_agree(def.domain, __func__, status);
  if (status != MPS_OK) {
    mpsi_backup_drop(particles, &backup);
    mpsi_free(context, dynamics);
    return status;
  }
  dynamics->context = mpsi_context_retain(context);
  dynamics->particles = particles;
  describe(dynamics, &def);
  if ((status = build(dynamics, &former, &backup)) != MPS_OK) {
    mpsi_particles_take_back(particles, &former);
    mpsi_particles_go_back(particles, &backup);
    mpsi_particles_drop_fields(particles, fields);
    mps_dynamics_destroy(&dynamics);
    return status;
  }
  mpsi_backup_drop(particles, &backup);
  mpsi_storage_drop(particles, &former);
  *out = dynamics;
  return MPS_OK;
}

void mps_dynamics_destroy(mps_dynamics **pointer) {
  if (!pointer || !*pointer) return;
  mps_dynamics *dynamics = *pointer;
  mps_context *context = dynamics->context;
  if (mpsi_dynamics_enter(dynamics, __func__) != MPS_OK) return;
  *pointer = NULL;
  mps_snapshot_destroy(&dynamics->present);
  mpsi_dynamics_drop_change(dynamics);
  mpsi_state_forget(&dynamics->identity);
  mpsi_dynamics_mesh_free(context, &dynamics->mesh);
  mpsi_halo_destroy(context, &dynamics->halo);
  mpsi_dynamics_free_boundaries(dynamics);
  mpsi_dynamics_free_loads(dynamics);
  void *parts[] = {dynamics->slab,   dynamics->scratch, dynamics->bad,
                   dynamics->before, dynamics->drag,    dynamics->part};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) mpsi_free(context, parts[k]);
  mps_kernel_destroy(&dynamics->kernel);
  mps_material_destroy(&dynamics->def.material);
  mpsi_particles_release(dynamics->particles, &dynamics->holder);
  mps_domain_destroy(&dynamics->domain);
  mpsi_free(context, dynamics);
  mpsi_context_release(context);
}

mps_status mps_experimental_dynamics_printed_torque(mps_dynamics *dynamics) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_dynamics_enter(dynamics, __func__);
  if (status == MPS_OK) status = mpsi_domain_agree(dynamics->domain, __func__, status);
  if (status != MPS_OK) return status;
  if (!dynamics->fresh)
    return mpsi_fail(dynamics->context, __func__, MPS_ERROR_STATE,
                     "steps have been taken: call it before the first");
  dynamics->torque = 2.0;
  (void)mpsi_dynamics_set_coefficients(dynamics);
  dynamics->have_limit = dynamics->checked = false;
  dynamics->dt = dynamics->def.dt;
  return mpsi_dynamics_join_coefficients(dynamics, __func__, MPS_OK);
}

/* ---- questions ------------------------------------------------------------------------------- */

mps_status mps_dynamics_get_def_sized(const mps_dynamics *dynamics, mps_dynamics_def *out,
                                      size_t size) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_dynamics_def def = dynamics->def;
  def.dt = dynamics->dt;
  return mpsi_def_write(dynamics->context, "mps_dynamics_get_def", out, size, &def, sizeof def);
}

mps_particles *mps_dynamics_particles(const mps_dynamics *dynamics) {
  return dynamics ? dynamics->particles : NULL;
}

mps_context *mps_dynamics_context(const mps_dynamics *dynamics) {
  return dynamics ? dynamics->context : NULL;
}

int64_t mps_dynamics_pairs(const mps_dynamics *dynamics) { return dynamics ? dynamics->pairs : 0; }
