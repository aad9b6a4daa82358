/* dt.c - the length of the time step: chosen from the linear limit, or given and compared with it.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "dt.h"
#include "core/definition/digits.h"
#include "core/particles/particles_internal.h"
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/limit/lattice.h"

#define CLOSE                                                                                      \
  0.2 /* of the limit of the lattice: below it pairs that are too close are warned of              \
       */

/* ---- close pairs ----------------------------------------------------------------------------- */

/* Two particles and their squared distance, m2. */
typedef struct couple {
  int64_t i, j;
  double distance2;
} couple;

static couple nearer(couple a, int64_t i, int64_t j, double x, double y) {
  const double distance2 = x * x + y * y;
  return distance2 < a.distance2 ? (couple){i, j, distance2} : a;
}

static couple find_nearest(const mpsi_dynamics_mesh *mesh) {
  const mpsi_dynamics_scattered *list = &mesh->scattered;
  couple out = {-1, -1, INFINITY};
  for (int64_t b = 0; b < mesh->blocks; b++) {
    const mpsi_dynamics_block *block = &mesh->block[b];
    for (int64_t r = block->run_begin; r < block->run_end; r++)
      if (mesh->run[r].count > 0)
        out = nearer(out, mesh->run[r].i0, mesh->run[r].j0, mesh->run[r].r0x, mesh->run[r].r0y);
    for (int64_t k = block->scattered_begin; k < block->scattered_end; k++)
      out = nearer(out, list->i[k], list->j[k], list->r0x[k], list->r0y[k]);
  }
  return out;
}

/* Particles much closer than the spacing make a short step for all. Collective. */
static mps_status warn_of_close_pair(mps_dynamics *dynamics, const char *function, double limit) {
  const double usual = mpsi_dynamics_lattice_bound(dynamics);
  if (!(limit < CLOSE * usual)) return MPS_OK;
  const couple own = find_nearest(&dynamics->mesh);
  const int64_t *id = mpsi_particles_integers(dynamics->particles, "id");
  double nearest = -own.distance2;
  mps_status status = mpsi_domain_max(dynamics->domain, function, 1, &nearest);
  const bool mine = own.i >= 0 && -own.distance2 == nearest;
  double name[2] = {mine ? (double)id[own.i] : -1.0, mine ? (double)id[own.j] : -1.0};
  if (status == MPS_OK) status = mpsi_domain_max(dynamics->domain, function, 2, name);
  const double apart = sqrt(-nearest), spacing = mps_particles_spacing(dynamics->particles);
  if (status == MPS_OK && name[0] >= 0.0 && apart < 0.5 * spacing)
    mpsi_log(dynamics->context, MPS_CONTEXT_LOG_WARNING,
             "particles %.0f and %.0f are %.3g m apart, %.2g times the spacing: the stable time "
             "step is %.3g s, %.2g times that of ground at the spacing",
             name[0], name[1], apart, apart / spacing, limit, limit / usual);
  return status;
}

/* ---- the step -------------------------------------------------------------------------------- */

/* Refuses a `dt` of the definition above the limit; warns of one that the caller has set since. */
static mps_status compare_dt(mps_dynamics *dynamics, const char *function, double dt) {
  const bool euler = dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_EULER;
  if (!euler && dt <= mpsi_dynamics_limit(dynamics)) return MPS_OK;
  mps_dynamics_linear_limit limit;
  MPSI_TRY(mpsi_as(dynamics->context, function, mps_dynamics_find_limit(dynamics, 0.0, &limit)));
  if (euler && limit.dt == 0.0)
    mpsi_log(dynamics->context, MPS_CONTEXT_LOG_WARNING,
             "Euler without damping has no stable time step: the motion grows at any dt");
  else if (dt > limit.dt && !euler && !dynamics->chosen) /* Euler may grow slowly */
    return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                     "dt is %g s, must be at most the linear stability limit, %.4g s; "
                     "mps_dynamics_set_dt takes a larger one",
                     dt, limit.dt);
  else if (dt > limit.dt)
    mpsi_log(dynamics->context, MPS_CONTEXT_LOG_WARNING,
             "dt = %g s is above the linear stability limit %.4g s: the run may diverge", dt,
             limit.dt);
  return MPS_OK;
}

/* Chooses dt from the limit. */
static mps_status choose_dt(mps_dynamics *dynamics, const char *function) {
  mps_dynamics_linear_limit limit;
  MPSI_TRY(mpsi_as(dynamics->context, function, mps_dynamics_find_limit(dynamics, 0.0, &limit)));
  if (!(limit.dt > 0.0))
    return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                     "dynamics: Euler without damping has no stable time step to choose: give dt");
  if (isinf(limit.dt))
    return mpsi_fail(
        dynamics->context, function, MPS_ERROR_ARGUMENT,
        "dynamics: no force between particles that can move limits the time step: give dt");
  const double dt = dynamics->def.courant * limit.dt;
  if (!(dt > 0.0))
    return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                     "dynamics: courant = %g times the limit %g s is no time step: give dt",
                     dynamics->def.courant, limit.dt);
  dynamics->dt = dt;
  return warn_of_close_pair(dynamics, function, limit.dt);
}

mps_status mpsi_dynamics_choose_dt(mps_dynamics *dynamics, const char *function) {
  if (dynamics->checked) return MPS_OK;
  const mps_status status = isnan(dynamics->dt) ? choose_dt(dynamics, function)
                                                : compare_dt(dynamics, function, dynamics->dt);
  dynamics->checked = status == MPS_OK;
  return status;
}

double mpsi_dynamics_dt(void *solver, const char *function) {
  mps_dynamics *dynamics = solver;
  return mpsi_dynamics_choose_dt(dynamics, function) == MPS_OK ? dynamics->dt : 0.0;
}

mps_status mpsi_dynamics_check_dt(void *solver, const char *function, double dt) {
  if (dt >= MPSI_DYN_LEAST_DT && dt <= MPSI_DYN_MOST_DT) return MPS_OK;
  return mpsi_fail(((mps_dynamics *)solver)->context, function, MPS_ERROR_ARGUMENT,
                   "dt is %s s, must be in %g to %g",
                   mpsi_outside(dt, MPSI_DYN_LEAST_DT, MPSI_DYN_MOST_DT).text, MPSI_DYN_LEAST_DT,
                   MPSI_DYN_MOST_DT);
}

mps_status mpsi_dynamics_use_dt(void *solver, const char *function, double dt) {
  mps_dynamics *dynamics = solver;
  const bool before = dynamics->chosen;
  dynamics->chosen = true;
  const mps_status status = compare_dt(dynamics, function, dt);
  if (status != MPS_OK) {
    dynamics->chosen = before;
    return status;
  }
  dynamics->dt = dynamics->def.dt = dt; /* as if the definition had given it */
  dynamics->checked = true;
  dynamics->limits.accepts = dynamics->limits.excess > 0.0;
  return MPS_OK;
}
