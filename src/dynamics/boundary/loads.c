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
#include "core/base/digits.h"

static const mps_dynamics_load_def load_defaults = {
    .struct_size = sizeof(mps_dynamics_load_def),
    .kind = MPS_DYNAMICS_LOAD_TRACTION,
    .lower = {NAN, NAN, NAN},
    .upper = {NAN, NAN, NAN},
    .area = NAN,
    .factor = {1.0, 1.0, 1.0},
};

mps_status mps_dynamics_load_def_init(mps_dynamics_load_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_dynamics_load_def, def, size, &load_defaults);
}

/* ---- definitions ----------------------------------------------------------------------------- */

static mps_status check_def(mps_dynamics *dynamics, const char *function,
                            const mps_dynamics_load_def *def) {
  mps_context *context = dynamics->context;
  if (def->kind != MPS_DYNAMICS_LOAD_TRACTION && def->kind != MPS_DYNAMICS_LOAD_BODY)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "kind is %d, allowed are 0 (traction) and 1 (body)", def->kind);
  for (int c = 0; c < 3; c++) {
    if (!isfinite(def->traction[c]) || (c == 2 && def->traction[c] != 0.0))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "traction[%d] is %g Pa, must be %s",
                       c, def->traction[c], c == 2 ? "0 in the plane" : "finite");
    if (!isfinite(def->acceleration[c]) || (c == 2 && def->acceleration[c] != 0.0))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "acceleration[%d] is %g m/s2, must be %s", c, def->acceleration[c],
                       c == 2 ? "0 in the plane" : "finite");
  }
  if (!isnan(def->area) && !(def->area >= 1e-30 && def->area <= 1e30))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "area is %s m2, must be in 1e-30..1e30, or NaN for spacing times measure",
                     mpsi_outside(def->area, 1e-30, 1e30).text);
  return MPS_OK;
}

static void release(mps_dynamics *dynamics, mpsi_dynamics_load **load) {
  if (*load) mpsi_dynamics_release_part(dynamics, &(*load)->part);
  mpsi_free(dynamics->context, *load);
  *load = NULL;
}

/* Sets the load `number`, on all ranks or none. */
static mps_status make(mps_dynamics *dynamics, const char *function, mps_status status,
                       int32_t number, const mps_dynamics_load_def *user_def,
                       mpsi_dynamics_load **out) {
  mps_dynamics_load_def def = load_defaults;
  *out = NULL;
  if (status == MPS_OK)
    status = MPSI_DEF_READ(dynamics->context, function, mps_dynamics_load_def, user_def, &def);
  if (status == MPS_OK) status = check_def(dynamics, function, &def);
  mpsi_dynamics_load *load = NULL;
  if (status == MPS_OK && !(load = mpsi_alloc(dynamics->context, 1, sizeof *load)))
    status = mpsi_fail_memory(dynamics->context, function, sizeof *load);
  const mpsi_dynamics_selection selection =
      MPSI_DYNAMICS_SELECTION(def, def.kind == MPS_DYNAMICS_LOAD_BODY);
  mpsi_given given;
  mpsi_given_begin(&given);
  mpsi_give(&given, "number", number);
  MPSI_GIVE(&given, &def, kind);
  MPSI_GIVE_VECTOR(&given, &def, traction, 2);
  MPSI_GIVE_VECTOR(&given, &def, acceleration, 2);
  MPSI_GIVE(&given, &def, area);
  status = mpsi_dynamics_agree_definition(dynamics, function, status, &selection, &given);
  if (status != MPS_OK) {
    mpsi_free(dynamics->context, load);
    return status;
  }
  status = mpsi_dynamics_select(dynamics, function, status, &selection, &load->part);
  const double spacing = mps_particles_spacing(dynamics->particles);
  const double area = isnan(def.area) ? spacing * dynamics->def.measure : def.area;
  load->kind = def.kind;
  for (int c = 0; c < 2; c++) {
    load->amount[c] =
        def.kind == MPS_DYNAMICS_LOAD_BODY ? def.acceleration[c] : def.traction[c] * area;
    load->now[c] = load->part.factor[c];
  }
  if (status != MPS_OK) release(dynamics, &load);
  *out = load;
  return status;
}

static mps_status check_number(const mps_dynamics *dynamics, const char *function, int32_t number) {
  const bool there = number >= 0 && number < dynamics->load_room && dynamics->load[number];
  return mpsi_dynamics_check_there(dynamics, function, "load", there, number);
}

/* Columns for the sum of all loads, at the first one. */
static mps_status reserve_forces(mps_dynamics *dynamics, const char *function) {
  if (!mpsi_dynamics_reserve_accounts(dynamics))
    return mpsi_fail_memory(dynamics->context, function, (size_t)dynamics->count * 24);
  if (dynamics->force[0]) return MPS_OK;
  dynamics->force[0] = mpsi_alloc(dynamics->context, 2 * dynamics->count, sizeof(double));
  if (!dynamics->force[0])
    return mpsi_fail_memory(dynamics->context, function, (size_t)dynamics->count * 16);
  dynamics->force[1] = dynamics->force[0] + dynamics->count;
  return MPS_OK;
}

mps_status mps_dynamics_add_load(mps_dynamics *dynamics, const mps_dynamics_load_def *def,
                                 int32_t *number) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_dynamics_enter(dynamics, __func__);
  if (status != MPS_OK) return status;
  int32_t at = 0;
  while (at < dynamics->load_room && dynamics->load[at]) at++;
  void *slots = dynamics->load;
  status = mpsi_dynamics_reserve_slot(dynamics, __func__, at, &slots, &dynamics->load_room);
  dynamics->load = slots;
  if (status == MPS_OK) status = reserve_forces(dynamics, __func__);
  mpsi_dynamics_load *load = NULL;
  status = make(dynamics, __func__, status, at, def, &load);
  if (status != MPS_OK) return status;
  dynamics->load[at] = load;
  dynamics->forces_stale = true;
  if (number) *number = at;
  return MPS_OK;
}

mps_status mps_dynamics_set_load(mps_dynamics *dynamics, int32_t number,
                                 const mps_dynamics_load_def *def) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_dynamics_enter(dynamics, __func__);
  if (status != MPS_OK) return status;
  mpsi_dynamics_load *load = NULL;
  status = make(dynamics, __func__, check_number(dynamics, __func__, number), number, def, &load);
  if (status != MPS_OK) return status;
  release(dynamics, &dynamics->load[number]);
  dynamics->load[number] = load;
  dynamics->forces_stale = true;
  return MPS_OK;
}

mps_status mps_dynamics_remove_load(mps_dynamics *dynamics, int32_t number) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_dynamics_enter(dynamics, __func__);
  if (status != MPS_OK) return status;
  status = mpsi_domain_agree_same(dynamics->domain, __func__,
                                  check_number(dynamics, __func__, number), "number", number);
  if (status != MPS_OK) return status;
  release(dynamics, &dynamics->load[number]);
  dynamics->forces_stale = true;
  return MPS_OK;
}

void mpsi_dynamics_free_loads(mps_dynamics *dynamics) {
  for (int32_t k = 0; k < dynamics->load_room; k++) release(dynamics, &dynamics->load[k]);
  mpsi_free(dynamics->context, dynamics->load);
  mpsi_free(dynamics->context, dynamics->force[0]);
}

/* ---- in a step ------------------------------------------------------------------------------- */

mps_status mpsi_dynamics_evaluate_loads(mps_dynamics *dynamics, const char *function, double now) {
  for (int32_t k = 0; k < dynamics->load_room; k++) {
    mpsi_dynamics_load *load = dynamics->load[k];
    for (int c = 0; load && c < 2; c++) {
      mpsi_signal_motion at;
      if (!load->part.signal[c]) continue;
      const mpsi_signal_use use = {dynamics->context, function, "load", k, c};
      const mps_status status = mpsi_signal_evaluate(load->part.signal[c], use, now, &at);
      if (status != MPS_OK) return status;
      const double value = load->part.factor[c] * at.u;
      if (value != load->now[c]) dynamics->forces_stale = true;
      load->now[c] = value;
    }
  }
  return MPS_OK;
}

/* The sum of all loads on each particle, N. */
static void sum_loads(mps_dynamics *dynamics) {
  for (int64_t k = 0; k < 2 * dynamics->count; k++) dynamics->force[0][k] = 0.0;
  for (int32_t number = 0; number < dynamics->load_room; number++) {
    const mpsi_dynamics_load *load = dynamics->load[number];
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
