/* dynamics_scene.h - bodies that move on several ranks, and what each rank ends with.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_DYNAMICS_SCENE_H
#define MPS_TEST_DYNAMICS_SCENE_H

#include "ranks_result.h"

enum { LAYERS, SCATTERED, PERIODIC, STRIP, UNSTABLE, SCENES };

static inline double noise(uint64_t k) {
  k = (k + 1) * UINT64_C(0x9e3779b97f4a7c15);
  k = (k ^ (k >> 31)) * UINT64_C(0xbf58476d1ce4e5b9);
  return (double)(k >> 11) * 0x1p-53 - 0.5;
}

/* Wave velocities that grow with depth, more damping at the top; a start in motion. */
static inline mps_status give_ground(mps_particles *set, bool even) {
  mps_status status = MPS_OK;
  mps_view x;
  mps_edit vs, vp, h, v;
  TRY(mps_particles_set(set, "density", 0, 1900.0));
  TRY(mps_particles_set(set, "shear_velocity", 0, 200.0));
  TRY(mps_particles_set(set, "pressure_velocity", 0, 400.0));
  TRY(mps_particles_set(set, "damping", 0, 0.02));
  TRY(mps_particles_set(set, "velocity", 0, 0.0));
  TRY(mps_particles_add_field(set, "reaction", 0));
  TRY(mps_particles_view(set, "position", &x));
  TRY(mps_particles_edit(set, "shear_velocity", &vs));
  TRY(mps_particles_edit(set, "pressure_velocity", &vp));
  TRY(mps_particles_edit(set, "damping", &h));
  TRY(mps_particles_edit(set, "velocity", &v));
  for (int64_t k = 0; status == MPS_OK && k < mps_particles_count(set); k++) {
    const double depth = 30.0 - *mps_view_f64(&x, k, 1);
    *mps_edit_f64(&vs, k, 0) = even ? 200.0 : 100.0 + 10.0 * floor(depth / 5.0);
    *mps_edit_f64(&vp, k, 0) = 2.2 * *mps_view_f64(&vs.view, k, 0);
    *mps_edit_f64(&h, k, 0) = even ? 0.02 : depth < 10.0 ? 0.05 : 0.02;
    *mps_edit_f64(&v, k, 0) = 1e-2 * sin(0.3 * *mps_view_f64(&x, k, 0) + 0.1 * depth);
  }
  TRY(mps_particles_commit(set, &vs));
  TRY(mps_particles_commit(set, &vp));
  TRY(mps_particles_commit(set, &h));
  TRY(mps_particles_commit(set, &v));
  return status;
}

/* Whether the scenes' sets lie in parts on the ranks from the first on. */
#ifndef RANKS_IN_PARTS
#define RANKS_IN_PARTS false
#endif

/* `domain` NULL: all of it here. */
static inline mps_status make_set(mps_context *own, mps_domain *domain, int what,
                                  mps_particles **out) {
  DEF(particles, def, .spacing = 0.5);
  mps_status status = domain ? mps_domain_create_particles(domain, &def, out)
                             : mps_particles_create(own, &def, out);
  const bool strip = what == STRIP || what == UNSTABLE;
  TRY(mps_particles_fill_box(*out, AT(0.0, 0.0), AT(strip ? 400.0 : 45.0, strip ? 2.5 : 30), NULL));
  if (what == SCATTERED && status == MPS_OK) {
    mps_edit x;
    mps_view id;
    TRY(mps_particles_edit(*out, "position", &x));
    TRY(mps_particles_view(*out, "id", &id));
    for (int64_t k = 0; status == MPS_OK && k < mps_particles_count(*out); k++)
      for (int c = 0; c < 2; c++)
        *mps_edit_f64(&x, k, c) += 0.1 * noise((uint64_t)(2 * *mps_view_i64(&id, k, 0) + c));
    TRY(mps_particles_commit(*out, &x));
  }
  TRY(give_ground(*out, what == PERIODIC));
  if (what == LAYERS) {
    TRY(mps_dynamics_add_free_field(*out, MPS_SIDE_X_LOWER, 4));
    TRY(mps_dynamics_add_free_field(*out, MPS_SIDE_X_UPPER, 4));
  }
  return status;
}

static inline mps_status ramp(void *user, double t, double motion[3]) {
  (void)user;
  motion[0] = 1e-3 * (t - sin(40.0 * t) / 40.0);
  motion[1] = 1e-3 * (1.0 - cos(40.0 * t));
  motion[2] = 1e-3 * 40.0 * sin(40.0 * t);
  return MPS_OK;
}

/* A base that drives or absorbs, a load on part of the surface, gravity. */
static inline mps_status add_conditions(mps_context *own, mps_domain *domain,
                                        mps_dynamics *dynamics, int what, int32_t *base) {
  scoped_signal *signal = NULL, *factor = NULL;
  int32_t number;
  mps_status status =
      mps_signal_create_user(own, MPS_SIGNAL_QUANTITY_DISPLACEMENT, ramp, NULL, NULL, &signal);
  TRY(mps_signal_create_user(own, MPS_SIGNAL_QUANTITY_VALUE, ramp, NULL, NULL, &factor));
  if (domain) status = mps_domain_agree(domain, status);
  DEF(dynamics_boundary, boundary, .lower[0] = boundary.lower[1] = -INFINITY, .upper[0] = INFINITY,
      .upper[1] = 0.4, .kind = what == LAYERS ? MPS_BOUNDARY_ABSORBING : MPS_BOUNDARY_DRIVEN,
      .dofs = what == LAYERS ? 0 : MPS_DOF_Y | MPS_DOF_ROTATION, .signal[0] = signal);
  TRY(mps_dynamics_add_boundary(dynamics, &boundary, base));
  const int64_t ids[3] = {700, 20, 1403};
  DEF(dynamics_boundary, point, .ids = ids, .id_count = 3, .dofs = MPS_DOF_Y);
  TRY(mps_dynamics_add_boundary(dynamics, &point, &number));
  DEF(dynamics_load, load, .lower[0] = 3.0, .upper[0] = 30.0,
      .lower[1] = what == STRIP || what == UNSTABLE ? 2.0 : 29.0, .upper[1] = INFINITY,
      .traction[1] = -1e4, .traction[0] = 2e3, .signal[0] = factor);
  TRY(mps_dynamics_add_load(dynamics, &load, &number));
  DEF(dynamics_load, gravity, .kind = MPS_DYNAMICS_LOAD_BODY, .all = 1, .acceleration[1] = -9.81);
  TRY(mps_dynamics_add_load(dynamics, &gravity, &number));
  return status;
}

/* Lengths of a run: three steps, or all that a solver can do with its state. A body that falls
 * apart does so in one call, or step by step. */
enum { WHOLE_RUN, SHORT_RUN };

static inline mps_status fall_apart(mps_dynamics *dynamics, int64_t length) {
  mps_status status = MPS_OK;
  for (int k = 0; status == MPS_OK && k < 300; k++)
    status = mps_dynamics_step(dynamics, length == SHORT_RUN ? 1 : 300);
  return status == MPS_ERROR_DIVERGED ? MPS_OK : MPS_ERROR_INTERNAL;
}

static inline mps_status march(mps_dynamics *dynamics, int64_t length) {
  mps_status status = mps_dynamics_step(dynamics, 3);
  scoped_snapshot *then = NULL;
  if (length == SHORT_RUN) return status;
  TRY(mps_dynamics_snapshot(dynamics, &then));
  TRY(mps_dynamics_step(dynamics, 20));
  TRY(mps_dynamics_rollback(dynamics, then));
  TRY(mps_dynamics_run(dynamics, mps_dynamics_time(dynamics) + 0.03, 7, NULL, NULL));
  TRY(mps_dynamics_refresh(dynamics));
  return status;
}

/* What a scene's solver is made with. */
static inline mps_dynamics_def scene_def(mps_domain *domain, int what) {
  DEF(dynamics, def, .domain = domain, .watch_damping = what == LAYERS,
      .integrator =
          what == SCATTERED ? MPS_DYNAMICS_INTEGRATOR_LEAPFROG : MPS_DYNAMICS_INTEGRATOR_VERLET);
  if (what == PERIODIC) def.period_x = 45.0;
  if (what == STRIP) def.radius_ratio = 2.1;
  if (what == UNSTABLE) def.divergence = 1e6;
  return def;
}

/* A scene with its solver and conditions; `base` receives the number of its lowest boundary. */
static inline mps_status begin_scene(mps_context *own, mps_domain *domain, int what,
                                     mps_particles **set, mps_dynamics **dynamics, int32_t *base) {
  const mps_dynamics_def def = scene_def(domain, what);
  mps_status status = make_set(own, RANKS_IN_PARTS ? domain : NULL, what, set);
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_dynamics_create(own, *set, &def, dynamics));
  if (status == MPS_OK) status = add_conditions(own, domain, *dynamics, what, base);
  if (what == UNSTABLE) TRY(mps_dynamics_set_dt(*dynamics, 5e-3));
  return status;
}

/* Half of a run that is cut in two: to the checkpoint, or on from it. `path` NULL: not cut. */
enum { FIRST_HALF = 1, SECOND_HALF = 2 };
static inline mps_status compute_halves(mps_context *own, mps_domain *domain, int what, int halves,
                                        const char *path, result *r) {
  scoped_particles *set = NULL;
  scoped_dynamics *dynamics = NULL;
  int32_t base = -1;
  mps_status status = begin_scene(own, domain, what, &set, &dynamics, &base);
  if (halves & FIRST_HALF) TRY(mps_dynamics_step(dynamics, 9));
  if ((halves & FIRST_HALF) && path) TRY(mps_dynamics_save(dynamics, path, NULL));
  if ((halves & SECOND_HALF) && path) TRY(mps_dynamics_restore(dynamics, path, NULL));
  if (halves & SECOND_HALF) TRY(mps_dynamics_step(dynamics, 14));
  TRY(mps_dynamics_get_totals(dynamics, &r->totals));
  TRY(mps_dynamics_get_reaction(dynamics, base, &r->reaction[0]));
  TRY(keep(set, r));
  return status;
}

static inline mps_status compute(mps_context *own, mps_domain *domain, int what, int64_t length,
                                 result *r) {
  scoped_particles *set = NULL;
  scoped_dynamics *dynamics = NULL;
  int32_t base = -1;
  mps_status status = begin_scene(own, domain, what, &set, &dynamics, &base);
  TRY(what == UNSTABLE ? fall_apart(dynamics, length) : march(dynamics, length));
  TRY(mps_dynamics_get_totals(dynamics, &r->totals));
  TRY(mps_dynamics_get_reaction(dynamics, base, &r->reaction[0]));
  mps_dynamics_linear_limit limit = {0};
  if (what != UNSTABLE) TRY(mps_dynamics_find_limit(dynamics, 0.0, &limit));
  r->dt = mps_dynamics_dt(dynamics);
  r->limit = limit.dt, r->omega = limit.omega;
  TRY(keep(set, r));
  return status;
}

#endif
