/* dt.c - the length of the time step: chosen from the linear limit, or given and compared with it.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "dt.h"
#include "dynamics/base/dynamics_solver.h"
#include "core/base/digits.h"

/* Warns of a `dt` above the limit. */
static mps_status compare_dt(mps_dynamics *dynamics, const char *function, double dt) {
  const bool euler = dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_EULER;
  if (!euler && dt <= mps_dynamics_limit(dynamics)) return MPS_OK;
  mps_dynamics_linear_limit limit;
  const mps_status status =
      mpsi_as(dynamics->context, function, mps_dynamics_find_limit(dynamics, 0.0, &limit));
  if (status != MPS_OK) return status;
  if (euler && limit.dt == 0.0)
    mpsi_log(dynamics->context, MPS_CONTEXT_LOG_WARNING,
             "Euler without damping has no stable time step: the motion grows at any dt");
  else if (dt > limit.dt)
    mpsi_log(dynamics->context, MPS_CONTEXT_LOG_WARNING,
             "dt = %g s is above the linear stability limit %.4g s: the run may diverge", dt,
             limit.dt);
  return MPS_OK;
}

/* Chooses dt from the limit. */
static mps_status choose_dt(mps_dynamics *dynamics, const char *function) {
  mps_dynamics_linear_limit limit;
  const mps_status status =
      mpsi_as(dynamics->context, function, mps_dynamics_find_limit(dynamics, 0.0, &limit));
  if (status != MPS_OK) return status;
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
  return MPS_OK;
}

mps_status mpsi_dynamics_choose_dt(mps_dynamics *dynamics, const char *function) {
  if (dynamics->checked) return MPS_OK;
  const mps_status status = isnan(dynamics->dt) ? choose_dt(dynamics, function)
                                                : compare_dt(dynamics, function, dynamics->dt);
  dynamics->checked = status == MPS_OK;
  return status;
}

double mps_dynamics_dt(mps_dynamics *dynamics) {
  if (!dynamics || mpsi_dynamics_choose_dt(dynamics, __func__) != MPS_OK) return 0.0;
  return dynamics->dt;
}

mps_status mps_dynamics_set_dt(mps_dynamics *dynamics, double dt) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_dynamics_enter(dynamics, __func__);
  if (status != MPS_OK) return status;
  if (!(dt >= MPSI_DYN_LEAST_DT && dt <= MPSI_DYN_MOST_DT))
    return mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT,
                     "dt is %s s, must be in %g..%g",
                     mpsi_outside(dt, MPSI_DYN_LEAST_DT, MPSI_DYN_MOST_DT).text, MPSI_DYN_LEAST_DT,
                     MPSI_DYN_MOST_DT);
  status = mpsi_domain_agree_same(dynamics->domain, __func__, status, "dt", dt);
  if (status == MPS_OK) status = compare_dt(dynamics, __func__, dt);
  if (status != MPS_OK) return status;
  dynamics->dt = dynamics->def.dt = dt; /* as if the definition had given it */
  dynamics->checked = true;
  return MPS_OK;
}
