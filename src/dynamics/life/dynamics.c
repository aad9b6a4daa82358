/* dynamics.c - life of the explicit MPS solver: definition, checks, storage.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/life/change.h"
#include "dynamics/life/removal.h"
#include "dynamics/life/state.h"
#include "dynamics/limit/dt.h"
#include "dynamics/step/run.h"
#include "dynamics/ranks/partition.h"
#include "dynamics/step/begin.h"
#include "dynamics/step/ground.h"

#include "core/particles/particles_internal.h"
#include "core/context/retain.h"
#include "core/state/state.h"
#include "material/material_internal.h"
#include "core/definition/digits.h"

#include <mps/experimental/papers.h>
#include <mps/experimental/domain.h>

/* ---- checks ---------------------------------------------------------------------------------- */

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
    if (side && (side[k] < 0 || side[k] > 1 + MPS_SIDE_X_UPPER))
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
  const bool periodic = !isnan(def->period_x);
  if (periodic && body < n)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "period_x is %g m, must be NaN with free-field columns", def->period_x);
  if (periodic && (def->period_x <= re || def->period_x <= hi[0] - lo[0]))
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
  dynamics->density = mpsi_kernel_density(dynamics->kernel, dynamics->spacing);
  return MPS_OK;
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
  dynamics->forces_stale = true;
  if (status == MPS_OK && (dynamics->def.gravity[0] != 0.0 || dynamics->def.gravity[1] != 0.0))
    status = mpsi_dynamics_reserve_forces(dynamics, function);
  if (status == MPS_OK) status = mpsi_dynamics_list_boundaries(dynamics, function);
  MPSI_TRY(mpsi_domain_agree(dynamics->domain, function, status));
  return mpsi_dynamics_begin(dynamics, function, 0.0);
}
static void destroy(void *solver) {
  mps_dynamics *dynamics = solver;
  mps_context *context = dynamics->context;
  mps_snapshot_destroy(&dynamics->present);
  mps_snapshot_destroy(&dynamics->limits.before);
  mpsi_dynamics_drop_change(dynamics);
  mpsi_dynamics_mesh_free(context, &dynamics->mesh);
  mpsi_halo_destroy(context, &dynamics->halo);
  mpsi_dynamics_free_boundaries(dynamics);
  mpsi_dynamics_free_loads(dynamics);
  MPSI_FREE(context, dynamics->slab, dynamics->scratch, dynamics->bad, dynamics->before,
            dynamics->drag, dynamics->part);
  mps_kernel_destroy(&dynamics->kernel);
  mps_material_destroy(&dynamics->def.material);
}

/* ---- as one of all solvers ------------------------------------------------------------------- */

static mps_status agree(void *solver, const char *function, mps_status status) {
  return mpsi_domain_agree(((mps_dynamics *)solver)->domain, function, status);
}

static void changing(void *solver) { ((mps_dynamics *)solver)->limits.changed = true; }

static void get_def(const void *solver, void *out) {
  const mps_dynamics *dynamics = solver;
  mps_dynamics_def *def = out;
  *def = dynamics->def;
  def->dt = dynamics->dt;
}

static const mpsi_solver_kind dynamics_kind = {
    .name = MPSI_SOLVER_NAMES("dynamics"),
    .task = "dynamics",
    .time = mpsi_dynamics_time,
    .steps = mpsi_dynamics_steps,
    .dt = mpsi_dynamics_dt,
    .limit = mpsi_dynamics_limit,
    .changing = changing,
    .agree = agree,
    .check_dt = mpsi_dynamics_check_dt,
    .use_dt = mpsi_dynamics_use_dt,
    .get_totals = mpsi_dynamics_get_totals,
    .get_reaction = mpsi_dynamics_get_reaction,
    .boundary = &mpsi_dynamics_boundaries,
    .load = &mpsi_dynamics_loads,
    .def_kind = MPS_DEF_DYNAMICS,
    .get_def = get_def,
    .begin = mpsi_dynamics_begin_march,
    .batch = mpsi_dynamics_batch,
    .advance = mpsi_dynamics_advance_march,
    .end = mpsi_dynamics_end_march,
    .state = mpsi_dynamics_describe,
    .settle = mpsi_dynamics_settle,
    .returned = mpsi_dynamics_returned,
    .save = mpsi_dynamics_save,
    .destroy = destroy,
};

/* Holds the set, which may be held, and copies the definition. */
static void describe(mps_dynamics *dynamics, mps_context *context, mps_particles *particles,
                     const mps_dynamics_def *def) {
  const mpsi_holder holder = {.name = "a solver of elastodynamics (mps_dynamics)",
                              .kind = MPSI_USE_MOVE,
                              .commit = mpsi_dynamics_commit,
                              .remove = mpsi_dynamics_remove,
                              .renew = mpsi_dynamics_renew};
  mpsi_solver_start(&dynamics->base, "mps_dynamics_create", &dynamics_kind, context, particles,
                    def->domain, &holder);
  dynamics->keeper = &mpsi_dynamics_keep;
  dynamics->limits.changed = true;
  dynamics->limits.saved = -1;
  dynamics->def = *def;
  if (def->kernel)
    dynamics->def.radius_ratio =
        mps_kernel_radius(def->kernel) / mps_particles_spacing(dynamics->particles);
  dynamics->count = mps_particles_count(dynamics->particles);
  dynamics->kernels = mpsi_dynamics_kernels_select(mpsi_context_level(dynamics->context));
  dynamics->dt = def->dt;
  dynamics->fresh = true;
  if (def->material) dynamics->def.material = mpsi_material_retain(def->material);
  dynamics->lead = true;
}

/* A period of which the body fills a part has free ends there, and repeats nothing. */
static void warn_of_gap(const mps_dynamics *dynamics, double width) {
  const double re = dynamics->def.radius_ratio * dynamics->spacing;
  const double gap = dynamics->def.period_x - width; /* NaN without a period */
  if (!isnan(gap) && gap >= re * (1.0 - 1e-12))
    mpsi_log(dynamics->context, MPS_CONTEXT_LOG_WARNING,
             "period_x is %g m, and the body %g m wide between outer particle centres: its ends "
             "have no neighbours in the next period, %g m away where re is %g m; ground without "
             "end has a period_x of %g m",
             dynamics->def.period_x, width, gap, re, width + dynamics->spacing);
}

mps_status mps_dynamics_create(mps_context *context, mps_particles *particles,
                               const mps_dynamics_def *user_def, mps_dynamics **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_dynamics_def def = mps_dynamics_defaults();
  MPSI_TRY(mpsi_particles_check_context(particles, context, __func__));
  mps_status status =
      MPSI_DEF_READ_OR_DEFAULTS(context, __func__, mps_dynamics_def, user_def, &def);
  if (mpsi_domain_check(context, __func__, def.domain) != MPS_OK) return MPS_ERROR_ARGUMENT;
  if (def.kernel) def.radius_ratio = mps_dynamics_defaults().radius_ratio; /* not read */
  const bool bounded = isnan(def.divergence);
  if (bounded) def.divergence = MPSI_DYN_DIVERGENCE;
  if (status == MPS_OK) status = check_state(context, particles);
  if (status == MPS_OK) status = mpsi_particles_check_hold(particles, __func__, MPSI_USE_MOVE);
  if (status == MPS_OK) status = mpsi_particles_check_deal(particles, __func__, def.domain);
  double lo[2], hi[2];
  status = find_extent(particles, def.domain, status, lo, hi);
  if (status == MPS_OK) status = check_geometry(context, particles, &def, lo, hi);
  if (status == MPS_OK)
    status = mpsi_fail_of(context, mpsi_particles_check_crowding(particles, __func__, 0, NULL),
                          "particles");
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
  describe(dynamics, context, particles, &def);
  dynamics->limits.bounded = bounded;
  if ((status = build(dynamics, &former, &backup)) != MPS_OK) {
    mpsi_particles_take_back(particles, &former);
    mpsi_particles_go_back(particles, &backup);
    mpsi_particles_drop_fields(particles, fields);
    mpsi_solver_end(&dynamics->base);
    return status;
  }
  mpsi_backup_drop(particles, &backup);
  mpsi_storage_drop(particles, &former);
  warn_of_gap(dynamics, hi[0] - lo[0]);
  *out = dynamics;
  return MPS_OK;
}

mps_solver *mps_dynamics_solver(const mps_dynamics *dynamics) {
  return dynamics ? (mps_solver *)&dynamics->base : NULL;
}

mps_status mps_experimental_dynamics_printed_torque(mps_dynamics *dynamics) {
  if (!dynamics) return mpsi_null(__func__, "dynamics");
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
