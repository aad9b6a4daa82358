/* loads.c - loads on the particles of an explicit MPS body: tractions, body forces, and the forces
 * that the caller writes into the field `external_force`.
 *
 * The velocity after a step is linear in the forces, so that loads are added after the kernels:
 * kick F/m to the velocity, and what follows to the displacement.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "loads.h"
#include "dynamics/base/dynamics_solver.h"
#include "signal/signal_internal.h"

/* ---- definitions ----------------------------------------------------------------------------- */

static mps_status check(void *solver, const char *function, int32_t number, const void *known) {
  return mpsi_particles_committed(((mps_dynamics *)solver)->particles, function);
}

static mps_status make(void *solver, const char *function, int32_t number, void *known, void *own) {
  mps_dynamics *dynamics = solver;
  mps_dynamics_load_def *def = known;
  mpsi_dynamics_load *load = own;
  const double spacing = mps_particles_spacing(dynamics->particles);
  const double area = isnan(def->area) ? spacing * dynamics->def.measure : def->area;
  load->kind = def->kind;
  for (int c = 0; c < 2; c++) {
    load->amount[c] =
        def->kind == MPS_DYNAMICS_LOAD_BODY ? def->acceleration[c] : def->traction[c] * area;
    load->now[c] = def->factor[c];
  }
  load->part.signal = def->signal;
  load->part.factor = def->factor;
  MPSI_TRY(mpsi_dynamics_reserve_forces(dynamics, function));
  return mpsi_dynamics_make_part(dynamics, function, (int64_t *)def->ids, &def->id_count,
                                 &load->part);
}

static mps_status apply(void *solver, const char *function, int32_t number, void *def, void *own,
                        void *former) {
  ((mps_dynamics *)solver)->forces_stale = true;
  return MPS_OK;
}

static void drop(void *solver, void *own) {
  mpsi_free(((mps_dynamics *)solver)->context, ((mpsi_dynamics_load *)own)->part.particle);
}

const mpsi_condition_kind mpsi_dynamics_loads = {
    MPSI_CONDITION_OF(DYNAMICS, dynamics, LOAD, load),
    .role = MPSI_SIGNAL_NUMBER,
    .list = {{"ids", "id_count", 1}},
    .most = INT32_MAX - 8,
    .size = sizeof(mpsi_dynamics_load),
    .check = check,
    .selects = true,
    .counts = mpsi_dynamics_counts,
    .make = make,
    .apply = apply,
    .drop = drop,
};

mps_status mpsi_dynamics_reserve_forces(mps_dynamics *dynamics, const char *function) {
  if (!mpsi_dynamics_reserve_accounts(dynamics))
    return mpsi_fail_memory(dynamics->context, function, (size_t)dynamics->count * 24);
  if (dynamics->force[0]) return MPS_OK;
  dynamics->force[0] = mpsi_alloc(dynamics->context, 2 * dynamics->count, sizeof(double));
  if (!dynamics->force[0])
    return mpsi_fail_memory(dynamics->context, function, (size_t)dynamics->count * 16);
  dynamics->force[1] = dynamics->force[0] + dynamics->count;
  return MPS_OK;
}

void mpsi_dynamics_free_loads(mps_dynamics *dynamics) {
  mpsi_free(dynamics->context, dynamics->force[0]);
}

/* ---- in a step ------------------------------------------------------------------------------- */

mps_status mpsi_dynamics_evaluate_loads(mps_dynamics *dynamics, const char *function, double now) {
  for (int32_t k = 0; k < mpsi_dynamics_load_count(dynamics); k++) {
    mpsi_dynamics_load *load = mpsi_dynamics_load_of(dynamics, k);
    for (int c = 0; load && c < 2; c++) {
      double factor;
      if (!load->part.signal[c]) continue;
      const mpsi_signal_use use = {dynamics->context, function, "load", k, c};
      MPSI_TRY(mpsi_signal_factor(load->part.signal[c], use, now, &factor));
      const double value = load->part.factor[c] * factor;
      if (value != load->now[c]) dynamics->forces_stale = true;
      load->now[c] = value;
    }
  }
  return MPS_OK;
}

/* The sum of all loads on each particle, N. */
static void sum_loads(mps_dynamics *dynamics) {
  for (int c = 0; c < 2; c++) {
    const double g = dynamics->def.gravity[c];
    for (int64_t i = 0; i < dynamics->count; i++)
      dynamics->force[c][i] = g != 0.0 ? g * mpsi_dynamics_mass(dynamics, c, (int32_t)i) : 0.0;
  }
  for (int32_t number = 0; number < mpsi_dynamics_load_count(dynamics); number++) {
    const mpsi_dynamics_load *load = mpsi_dynamics_load_of(dynamics, number);
    for (int c = 0; load && c < 2; c++) {
      const double amount = load->amount[c] * load->now[c];
      for (int64_t p = 0; amount != 0.0 && p < load->part.count; p++) {
        const int32_t i = load->part.particle[p];
        dynamics->force[c][i] += load->kind == MPS_DYNAMICS_LOAD_BODY
                                     ? amount * mpsi_dynamics_mass(dynamics, c, i)
                                     : amount;
      }
    }
  }
  dynamics->forces_stale = false;
}

mpsi_dynamics_forces mpsi_dynamics_find_forces(mps_dynamics *dynamics) {
  mpsi_dynamics_forces f = {0};
  if (dynamics->force[0] && dynamics->forces_stale) sum_loads(dynamics);
  for (int c = 0; c < 2; c++) {
    f.load[c] = dynamics->force[c];
    f.external[c] = mpsi_particles_column(dynamics->particles, "external_force", c);
  }
  f.any = f.load[0] || f.external[0];
  return f;
}

void mpsi_dynamics_apply_forces(mps_dynamics *dynamics, const mpsi_dynamics_forces *forces,
                                int64_t block, const mpsi_dynamics_step *step) {
  const mpsi_dynamics_state *s = &dynamics->state;
  const int integrator = dynamics->def.integrator;
  const double D = mps_particles_spacing(dynamics->particles);
  const double weight = 1.0 / (D * D * dynamics->def.measure);
  const double *const inverse[2] = {s->ix, s->iy};
  double *const d[2] = {s->dx, s->dy}, *const v[2] = {s->vx, s->vy}, *const a[2] = {s->ax, s->ay};
  const int64_t begin = dynamics->mesh.block[block].begin, end = dynamics->mesh.block[block].end;
  for (int c = 0; c < 2; c++)
    for (int64_t k = begin; k < end; k++) {
      const double force = (forces->load[c] ? forces->load[c][k] : 0.0) +
                           (forces->external[c] ? forces->external[c][k] : 0.0);
      const double gain = force * (inverse[c][k] * weight); /* m/s2 */
      if (integrator != MPS_DYNAMICS_INTEGRATOR_VERLET) v[c][k] += step->kick * gain;
      if (integrator != MPS_DYNAMICS_INTEGRATOR_EULER) d[c][k] += step->dt * step->kick * gain;
      if (step->output) a[c][k] += gain;
    }
}
