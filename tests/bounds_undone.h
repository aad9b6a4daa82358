/* bounds_undone.h - steps beyond what can be: each is refused with a record that names particle,
 * value and time, what a caller sees is that of before the step bit for bit, and the run continues
 * with a smaller step, or where what was refused is taken away, as if it had never been.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_BOUNDS_UNDONE_H
#define MPS_TEST_BOUNDS_UNDONE_H

#include "bounds.h"
#include "soil_column.h"
#include "unchanged.h"

#include "core/particles/particles_internal.h"

SEEN_SOLVER(mpm)
SEEN_SOLVER(dynamics)
SEEN_SOLVER(fluid)
SEEN_SOLVER(elastic)

static const double undone_cells[3] = {0.1, 0.125, 0.2}; /* m */
static const double undone_young[3] = {1e6, 2e7, 4e8};   /* Pa */

/* The record of a refused step: its particle, and words of what is wrong. */
static inline void undone_is_told(mps_context *context, mps_status status, const char *words) {
  const mps_error *error = mps_context_error(context);
  assert_int_equal(status, MPS_ERROR_DIVERGED);
  if (!strstr(error->message, words)) fail_msg("%s, not: %s", error->message, words);
  assert_non_null(strstr(error->message, "t = "));
  assert_true(error->particle >= 0);
}

static inline void undone_all_finite(mps_particles *set) {
  for (int32_t f = 0; f < mps_particles_field_count(set); f++) {
    mps_particles_field_info info;
    OK(mps_particles_get_field_info(set, f, &info));
    mps_view view = view_field(set, info.name);
    for (int64_t k = 0; info.dtype.code == 2 && k < view.shape[0]; k++)
      for (int64_t c = 0; c < view.shape[1]; c++) assert_true(isfinite(*mps_view_f64(&view, k, c)));
  }
}

/* ---- WLS-MPM --------------------------------------------------------------------------------- */

/* An elastic block on a floor, with waves; dt of half of h/c, or what follows the limit. */
static inline mpm_scene undone_block(mps_context *context, double h, double young, bool wet,
                                     bool given) {
  mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, young);
  const double c = sqrt((young * 1.35 + (wet ? 1e8 / 0.4 : 0.0)) / 1000.0);
  mpm_scene_box(&s, 0.0, 0.0, 6.0 * h, 5.0 * h);
  DEF(mpm, def, .cell = h, .lower[1] = 0.0, .gravity[1] = -9.81);
  if (given) def.dt = 0.5 * h / c;
  mpm_scene_solve(&s, &def);
  if (wet) {
    DEF(pore_water, water, .porosity = 0.4, .bulk = 1e8, .density = 500.0);
    OK(mps_mpm_add_pore_water(s.mpm, &water));
  }
  mps_edit v = mpm_scene_edit(&s, "velocity");
  const mps_view x = mpm_scene_view(&s, "position");
  for (int64_t k = 0; k < x.shape[0]; k++)
    *mps_edit_f64(&v, k, 0) = 1e-3 * sin(9.0 * *mps_view_f64(&x, k, 1) / h);
  mpm_scene_commit(&s, &v);
  return s;
}

/* A load without measure in the midst of a run: the run without it is the same. */
static inline void undone_mpm_load(mps_context *context, int grid, int stiff, bool wet) {
  mpm_scene s[2];
  const int64_t id = 7;
  int32_t number = -1;
  for (int k = 0; k < 2; k++) {
    s[k] = undone_block(context, undone_cells[grid], undone_young[stiff], wet, false);
    OK(mps_mpm_step(s[k].mpm, 12));
  }
  DEF(mpm_load, load, .ids = &id, .id_count = 1);
  static const double strong[3] = {1e60, 1e125, -1e140};
  for (int k = 0; k < 3; k++) {
    load.traction[k % 2] = strong[k];
    OK(mps_mpm_add_load(s[0].mpm, &load, &number));
    const uint64_t before = seen_mpm(s[0].mpm, true);
    undone_is_told(context, mps_mpm_step(s[0].mpm, 1), "particle ");
    assert_true(seen_mpm(s[0].mpm, true) == before);
    OK(mps_mpm_remove_load(s[0].mpm, number));
  }
  undone_all_finite(s[0].particles);
  for (int k = 0; k < 2; k++) OK(mps_mpm_step(s[k].mpm, 8));
  assert_true(seen_mpm(s[0].mpm, true) == seen_mpm(s[1].mpm, true));
  for (int k = 0; k < 2; k++) mpm_scene_end(&s[k]);
}

/* The waves of ground that is made lighter, or of which the pores are, are too fast for its dt,
 * some 2 to 8 of the limit: the motion grows until it has more energy than there is. */
static inline void undone_mpm_dt(mps_context *context, int grid, int stiff, bool wet) {
  scoped_mpm_scene s = undone_block(context, undone_cells[grid], undone_young[stiff], wet, true);
  const double less = (0.05 - 0.01 * grid) * (wet ? 0.2 : 1.0);
  OK(wet ? mps_particles_set(s.particles, "porosity", 0, 0.4 * less)
         : mps_particles_set(s.particles, "density", 0, 1000.0 * less));
  mps_status status = MPS_OK;
  uint64_t before = 0;
  int steps = 0;
  for (; status == MPS_OK && steps < 400; steps++) {
    before = seen_mpm(s.mpm, true);
    status = mps_mpm_step(s.mpm, 1);
  }
  print_message("h %.3f m, E %.0e Pa%s: refused after %d steps: %s\n", undone_cells[grid],
                undone_young[stiff], wet ? ", wet" : "", steps,
                strstr(mps_context_error(context)->message, " m3 "));
  undone_is_told(context, status, wet ? "particle " : "the kinetic energy of all");
  assert_true(seen_mpm(s.mpm, true) == before);
  undone_all_finite(s.particles);
  OK(mps_mpm_set_dt(s.mpm, 0.1 * mps_mpm_limit(s.mpm)));
  status = mps_mpm_step(s.mpm, 20); /* what it holds may still burst its water's bounds */
  assert_true(status == MPS_OK || (wet && status == MPS_ERROR_DIVERGED));
  undone_all_finite(s.particles);
}

/* ---- explicit dynamics ----------------------------------------------------------------------- */

static inline void undone_dynamics(mps_context *context, int grid, int stiff, int32_t integrator) {
  const double D = undone_cells[grid], vs = sqrt(undone_young[stiff] / 2.6 / 1000.0);
  const soil_layer layer = {1e9, 1000.0, vs, 1.8 * vs, 0.0};
  const bool euler = integrator == MPS_DYNAMICS_INTEGRATOR_EULER;
  scoped_particles *set = soil_particles(context, D, 8.0 * D, 6.0 * D, 1, &layer);
  DEF(dynamics, def, .integrator = integrator, .dt = euler ? 0.5 * D / vs : NAN);
  mps_status status = MPS_OK;
  uint64_t before = 0;
  int steps = 0;
  bounds_draw draw = bounds_begin(grid);
  OK(mps_particles_set(set, "velocity", 0, 0.0));
  EDIT(v, set, "velocity")
    for (int64_t k = 0; k < v.view.shape[0]; k++)
      for (int c = 0; c < 2; c++) *mps_edit_f64(&v, k, c) = 1e-3 * bounds_even(&draw, -1.0, 1.0);
  MAKE(dynamics, d, create, context, set, &def);
  mps_dynamics_linear_limit of;
  OK(mps_dynamics_find_limit(d, 0.0, &of));
  const double limit = of.dt;
  if (!euler) OK(mps_dynamics_set_dt(d, 1.05 * limit));
  for (; status == MPS_OK && steps < 400; steps++) {
    before = seen_dynamics(d, true);
    status = mps_dynamics_step(d, 1);
  }
  const int64_t made = mps_dynamics_steps(d);
  print_message("D %.3f m, Vs %.3g m/s, integrator %d: refused after %d steps\n", D, vs,
                (int)integrator, steps);
  undone_is_told(context, status, euler ? "diverged at step" : "the kinetic energy is");
  assert_int_equal(made, steps - 1);
  assert_true(seen_dynamics(d, true) == before);
  undone_all_finite(set);
  OK(mps_dynamics_set_dt(d, euler ? 1e-3 * D / vs : 0.5 * limit));
  status = mps_dynamics_step(d, 40);
  assert_true(status == MPS_OK || euler); /* whose accelerations are beyond the limit by now */
  undone_all_finite(set);
}

/* ---- fluid ----------------------------------------------------------------------------------- */

/* A tank that sloshes; its speeds become `factor` of what they were without anybody's edit, as
 * by a fault of the scheme. Where the caller gives them the same speeds, the run continues. */
static inline void undone_fluid(mps_context *context, int grid, double factor) {
  const double l0 = 0.2 * undone_cells[grid];
  scoped_tank t = tank_make(context, 16.0 * l0, 8.0 * l0, l0, NULL, 0.02 * sqrt(l0 / TANK_G));
  mps_edit u;
  OK(mps_particles_edit(t.water, "velocity", &u));
  mps_view x = view_field(t.water, "position");
  for (int64_t k = 0; k < x.shape[0]; k++)
    *mps_edit_f64(&u, k, 0) =
        0.3 * sqrt(TANK_G * l0) * sin(TANK_PI * *mps_view_f64(&x, k, 0) / (16.0 * l0));
  OK(mps_particles_commit(t.water, &u));
  OK(mps_fluid_step(t.fluid, 10));
  for (int c = 0; c < 2; c++) {
    double *speed = mpsi_particles_column(t.water, "velocity", c);
    for (int64_t k = 0; k < x.shape[0]; k++) speed[k] *= factor;
  }
  const uint64_t before = seen_fluid(t.fluid, true);
  undone_is_told(context, mps_fluid_step(t.fluid, 1), "the kinetic energy is");
  assert_true(seen_fluid(t.fluid, true) == before);
  undone_all_finite(t.water);
  OK(mps_particles_edit(t.water, "velocity", &u));
  OK(mps_particles_commit(t.water, &u));
  OK(mps_fluid_step(t.fluid, 5));
}

/* ---- elasticity ------------------------------------------------------------------------------ */

static inline void undone_elastic(mps_context *context, int grid, int stiff) {
  const double D = undone_cells[grid], lo[2] = {0.0, 0.0}, hi[2] = {6.0 * D, 4.0 * D};
  const int64_t id = 9;
  const double force[3] = {1e140, 0.0, 0.0};
  mps_elastic_load_def load = mps_elastic_load_defaults();
  int32_t number = -1;
  scoped_particles *set = box_of(context, D, lo, hi);
  SET_FIELDS(set, {"density", 1000.0}, {"young", undone_young[stiff]}, {"poisson", 0.3});
  MAKE(elastic, e, create, context, set, NULL);
  DEF(elastic_boundary, foot, .lower[0] = foot.lower[1] = -1.0, .upper[0] = 9.0, .upper[1] = D);
  OK(mps_elastic_add_boundary(e, &foot, NULL));
  USING(elastic_motion, mps_elastic_start(e, &given), .dt = 1e-3);
  OK(mps_elastic_step(e, 3));
  load.kind = MPS_ELASTIC_LOAD_FORCE, load.ids = &id, load.id_count = 1, load.values = force;
  OK(mps_elastic_add_load(e, &load, &number));
  const uint64_t before = seen_elastic(e, true);
  undone_is_told(context, mps_elastic_step(e, 1), "beyond double precision");
  assert_true(seen_elastic(e, true) == before);
  OK(mps_elastic_remove_load(e, number));
  OK(mps_elastic_step(e, 3));
  undone_all_finite(set);
}

#endif
