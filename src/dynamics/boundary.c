/* boundary.c - held, driven and viscous boundaries of the explicit MPS solver.
 *
 * A dashpot acts with the mean of the velocities before and after the step, which keeps the stable
 * time step as it is: (1 + c dt/2) v+ = (1 - c dt/2) v- + dt (a + c target). It is applied as a
 * correction to what the ordinary step did. Columns come before the edges that follow them.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles_internal.h"
#include "core/retain.h"
#include "dynamics_private.h"

#include <stdlib.h>

static mps_status check_list(mps_dynamics *dynamics, const char *function, int64_t count,
                             const int64_t *ids) {
  mps_context *context = dynamics->context;
  if (!dynamics->fresh)
    return mpsi_fail(context, function, MPS_ERROR_STATE,
                     "boundaries are set before the first step (or after mps_dynamics_restart)");
  if (count < 1 || !ids)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "count is %lld and ids is %s: at least one particle is required",
                     (long long)count, ids ? "given" : "NULL");
  for (int64_t k = 0; k < count; k++)
    if (mps_particles_index(dynamics->particles, ids[k]) < 0)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld: the set has no such particle", (long long)k,
                       (long long)ids[k]);
  return MPS_OK;
}

/* The limit, and whether dt was compared with it, depend on the boundaries. */
static void boundaries_changed(mps_dynamics *dynamics) {
  dynamics->have_limit = dynamics->checked = false;
  if (dynamics->def.dt == 0.0) dynamics->dt = 0.0;
}

static bool reserve(mps_dynamics *dynamics, void **array, int64_t used, int64_t more, int64_t *room,
                    size_t size) {
  if (used + more <= *room) return true;
  const int64_t wanted = used + more + used / 2;
  if (!mpsi_grow(dynamics->context, array, used, wanted, size)) return false;
  *room = wanted;
  return true;
}

static bool keep_signal(mps_dynamics *dynamics, mps_signal *signal) {
  if (!signal) return true;
  if (!reserve(dynamics, (void **)&dynamics->signals, dynamics->signal_count, 1,
               &dynamics->signal_room, sizeof *dynamics->signals))
    return false;
  dynamics->signals[dynamics->signal_count++] = mpsi_signal_retain(signal);
  return true;
}

mps_status mps_dynamics_hold(mps_dynamics *dynamics, uint32_t dofs, int64_t count,
                             const int64_t *ids) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  if (dofs == 0 || dofs & ~(MPS_DOF_X | MPS_DOF_Y | MPS_DOF_ROTATION))
    return mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT,
                     "dofs is %u, allowed is a combination of 1 (x), 2 (y) and 8 (rotation)", dofs);
  const mps_status status = check_list(dynamics, __func__, count, ids);
  if (status != MPS_OK) return status;
  for (int64_t k = 0; k < count; k++) {
    const int64_t i = mps_particles_index(dynamics->particles, ids[k]);
    if (dofs & MPS_DOF_X) dynamics->state.ix[i] = 0.0;
    if (dofs & MPS_DOF_Y) dynamics->state.iy[i] = 0.0;
    if (dofs & MPS_DOF_ROTATION) dynamics->state.ith[i] = 0.0;
  }
  boundaries_changed(dynamics);
  mpsi_dynamics_rewind(dynamics); /* the held particles start at rest */
  return MPS_OK;
}

mps_status mps_dynamics_drive(mps_dynamics *dynamics, int32_t component, mps_signal *signal,
                              double factor, int64_t count, const int64_t *ids) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_context *context = dynamics->context;
  if (component != 0 && component != 1)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "component is %d, allowed are 0 (x) and 1 (y)", component);
  if (!signal) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "signal is NULL");
  if (!isfinite(factor))
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "factor is %g, must be finite", factor);
  const mps_status status = check_list(dynamics, __func__, count, ids);
  if (status != MPS_OK) return status;
  if (!reserve(dynamics, (void **)&dynamics->drive, dynamics->drives, count, &dynamics->drive_room,
               sizeof *dynamics->drive) ||
      !keep_signal(dynamics, signal))
    return mpsi_fail_memory(context, __func__, (size_t)count * sizeof *dynamics->drive);
  for (int64_t k = 0; k < count; k++) {
    const int64_t i = mps_particles_index(dynamics->particles, ids[k]);
    (component == 0 ? dynamics->state.ix : dynamics->state.iy)[i] = 0.0;
    dynamics->drive[dynamics->drives++] = (mpsi_dynamics_drive){
        .particle = (int32_t)i, .component = component, .signal = signal, .factor = factor};
  }
  boundaries_changed(dynamics);
  mpsi_dynamics_rewind(dynamics); /* the driven particles start on the signal */
  return MPS_OK;
}

/* ---- viscous --------------------------------------------------------------------------------- */

static const mps_viscous_def viscous_defaults = {
    .struct_size = sizeof(mps_viscous_def), .normal = 1, .factor = 1.0};

mps_status mps_viscous_def_init(mps_viscous_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_viscous_def, def, size, &viscous_defaults);
}

static mps_status check_viscous(mps_context *context, const mps_viscous_def *def) {
  static const char *const function = "mps_dynamics_viscous";
  const double values[3] = {def->density, def->shear_velocity, def->pressure_velocity};
  const char *const names[3] = {"density", "shear_velocity", "pressure_velocity"};
  if (def->normal != 0 && def->normal != 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "normal is %d, allowed are 0 (x) and 1 (y)", def->normal);
  for (int k = 0; k < 3; k++)
    if (!isfinite(values[k]) || values[k] < 0.0)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "%s is %g, must be finite and > 0, or 0 for that of the particles", names[k],
                       values[k]);
  if (!isfinite(def->factor))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "factor is %g, must be finite",
                     def->factor);
  return MPS_OK;
}

bool mpsi_dynamics_add_dashpot(mps_dynamics *dynamics, mpsi_dynamics_dashpot dashpot) {
  if (!reserve(dynamics, (void **)&dynamics->dashpot, dynamics->dashpots, 1,
               &dynamics->dashpot_room, sizeof dashpot))
    return false;
  dynamics->dashpot[dynamics->dashpots++] = dashpot;
  dynamics->dashpots_sorted = false;
  return true;
}

mps_status mps_dynamics_viscous(mps_dynamics *dynamics, const mps_viscous_def *user_def,
                                int64_t count, const int64_t *ids) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_viscous_def def = viscous_defaults;
  mps_status status = MPS_OK;
  if (user_def)
    status = MPSI_DEF_READ(dynamics->context, __func__, mps_viscous_def, user_def, &def);
  if (status == MPS_OK) status = check_viscous(dynamics->context, &def);
  if (status == MPS_OK) status = check_list(dynamics, __func__, count, ids);
  if (status != MPS_OK) return status;
  if (!reserve(dynamics, (void **)&dynamics->dashpot, dynamics->dashpots, 2 * count,
               &dynamics->dashpot_room, sizeof *dynamics->dashpot) ||
      !keep_signal(dynamics, def.incoming[0]) || !keep_signal(dynamics, def.incoming[1]))
    return mpsi_fail_memory(dynamics->context, __func__,
                            (size_t)count * 2 * sizeof *dynamics->dashpot);
  const double *rho = mpsi_dynamics_column(dynamics, "density", 0);
  const double *vs = mpsi_dynamics_column(dynamics, "shear_velocity", 0);
  const double *vp = mpsi_dynamics_column(dynamics, "pressure_velocity", 0);
  const double D = mps_particles_spacing(dynamics->particles);
  for (int64_t k = 0; k < count; k++) {
    const int64_t i = mps_particles_index(dynamics->particles, ids[k]);
    for (int c = 0; c < 2; c++) {
      const double own = c == def.normal ? vp[i] : vs[i];
      const double outside = c == def.normal ? def.pressure_velocity : def.shear_velocity;
      const double impedance = (def.density > 0.0 ? def.density : rho[i]) *
                               (outside > 0.0 ? outside : own); /* kg/(m2 s) */
      const mpsi_dynamics_dashpot dashpot = {.particle = (int32_t)i,
                                             .component = c,
                                             .partner = -1,
                                             .c = impedance /
                                                  (rho[i] * D), /* face D, mass rho D^2 */
                                             .signal = def.incoming[c],
                                             .factor = def.factor};
      dynamics->dashpot[dynamics->dashpots++] = dashpot;
    }
  }
  dynamics->dashpots_sorted = false;
  boundaries_changed(dynamics);
  return MPS_OK;
}

/* ---- around a step --------------------------------------------------------------------------- */

/* Displacement, previous displacement (Verlet), velocity and inverse mass of one component. */
typedef struct motion {
  double *d, *o, *v, *a;
  const double *inverse_mass;
} motion;

static motion component(const mps_dynamics *dynamics, int32_t c) {
  const mpsi_dynamics_state *s = &dynamics->state;
  return c == 0 ? (motion){s->dx, s->ox, s->vx, s->ax, s->ix}
                : (motion){s->dy, s->oy, s->vy, s->ay, s->iy};
}

static double velocity(const mps_dynamics *dynamics, const motion *m, int32_t i) {
  if (dynamics->def.integrator != MPS_INTEGRATOR_VERLET) return m->v[i];
  return (m->d[i] - m->o[i]) / dynamics->dt;
}

void mpsi_dynamics_apply_drives(mps_dynamics *dynamics, double t, double now, bool output) {
  const mps_signal *signal = NULL;
  const int integrator = dynamics->def.integrator;
  double u = 0.0, v = 0.0, a = 0.0;
  for (int64_t k = 0; k < dynamics->drives; k++) {
    const mpsi_dynamics_drive *drive = &dynamics->drive[k];
    if (drive->signal != signal) { /* lists share one signal: evaluate it once */
      signal = drive->signal;
      u = mps_signal_displacement(signal, t);
      v = integrator == MPS_INTEGRATOR_EULER ? mps_signal_velocity(signal, t) : 0.0;
      a = output ? mps_signal_acceleration(signal, now) : 0.0;
    }
    const motion m = component(dynamics, drive->component);
    const int32_t i = drive->particle;
    if (integrator == MPS_INTEGRATOR_EULER) m.v[i] = drive->factor * v;
    if (integrator == MPS_INTEGRATOR_LEAPFROG) /* at mid-step */
      m.v[i] = (drive->factor * u - m.d[i]) / dynamics->dt + m.v[i];
    m.d[i] = drive->factor * u;
    if (output) m.a[i] = drive->factor * a;
  }
}

static int compare(const void *left, const void *right) {
  const mpsi_dynamics_dashpot *a = left, *b = right;
  if (a->particle != b->particle) return a->particle > b->particle ? -1 : 1;
  if (a->component != b->component) return a->component < b->component ? -1 : 1;
  return a->partner < b->partner ? -1 : a->partner > b->partner;
}

void mpsi_dynamics_dashpots_before(mps_dynamics *dynamics) {
  if (!dynamics->dashpots_sorted) /* columns last in memory, first here */
    qsort(dynamics->dashpot, (size_t)dynamics->dashpots, sizeof *dynamics->dashpot, compare);
  dynamics->dashpots_sorted = true;
  for (int64_t k = 0; k < dynamics->dashpots; k++) {
    mpsi_dynamics_dashpot *dashpot = &dynamics->dashpot[k];
    const motion m = component(dynamics, dashpot->component);
    dashpot->before = velocity(dynamics, &m, dashpot->particle);
    if (dashpot->partner >= 0) dashpot->partner_before = velocity(dynamics, &m, dashpot->partner);
  }
}

/* Velocity that a dashpot pulls towards, m/s. */
static double target(const mps_dynamics *dynamics, const mpsi_dynamics_dashpot *dashpot,
                     const motion *m, double now) {
  if (dashpot->partner >= 0) {
    const double after = dynamics->def.integrator == MPS_INTEGRATOR_EULER
                             ? dashpot->partner_before
                             : velocity(dynamics, m, dashpot->partner);
    return 0.5 * (dashpot->partner_before + after);
  }
  return dashpot->signal ? 2.0 * dashpot->factor * mps_signal_velocity(dashpot->signal, now) : 0.0;
}

void mpsi_dynamics_dashpots_after(mps_dynamics *dynamics, double now, bool output) {
  const double dt = dynamics->dt;
  const int integrator = dynamics->def.integrator;
  for (int64_t k = 0, next; k < dynamics->dashpots; k = next) {
    const mpsi_dynamics_dashpot *first = &dynamics->dashpot[k];
    const motion m = component(dynamics, first->component);
    const int32_t i = first->particle;
    double c = 0.0, pull = 0.0; /* all dashpots of this component together */
    for (next = k; next < dynamics->dashpots && dynamics->dashpot[next].particle == i &&
                   dynamics->dashpot[next].component == first->component;
         next++) {
      c += dynamics->dashpot[next].c;
      pull += dynamics->dashpot[next].c * target(dynamics, &dynamics->dashpot[next], &m, now);
    }
    if (m.inverse_mass[i] == 0.0) continue; /* held or driven */
    const double before = first->before, ordinary = velocity(dynamics, &m, i);
    double after;
    if (integrator == MPS_INTEGRATOR_EULER)
      after = ordinary + dt * (pull - c * before);
    else
      after = (ordinary - 0.5 * c * dt * before + dt * pull) / (1.0 + 0.5 * c * dt);
    if (integrator == MPS_INTEGRATOR_VERLET) {
      m.d[i] = m.o[i] + dt * after;
    } else {
      m.v[i] = after;
      if (integrator == MPS_INTEGRATOR_LEAPFROG) m.d[i] += dt * (after - ordinary);
    }
    if (output) m.a[i] = (after - before) / dt;
  }
}
