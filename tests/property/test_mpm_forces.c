/* test_mpm_forces.c - what walls, moving nodes, loads and body accelerations give is what the
 * particles' momentum gets; loads stay with their particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_held.h"
#include "test_fixture.h"

#include "mpm/base/mpm_solver.h"

/* Sum of all forces of the last step but gravity; counts the walls that act. */
static void held_force(mpm_scene *s, int32_t box, double *sum, int *acts) {
  double force[3];
  mpm_scene_force(s, box, sum);
  for (int32_t k = 0; k < 2 * s->mpm->grid.dim; k++) {
    mpm_scene_force(s, k, force);
    acts[k] += force[0] != 0.0 || force[1] != 0.0 || force[2] != 0.0;
    for (int c = 0; c < 3; c++) sum[c] += force[c];
  }
  for (int c = 0; c < s->mpm->grid.dim; c++)
    for (int64_t k = 0; k < s->mpm->p.count; k++) sum[c] += s->mpm->p.f[c][k];
}

/* Another traction on the same particles and areas. */
static void push_anew(mpm_scene *s, int32_t load) {
  mps_mpm_load_def def = mps_mpm_load_defaults();
  OK(mps_mpm_get_load(s->mpm, load, &def));
  def.traction[0] = 100.0, def.traction[1] = 50.0, def.traction[2] = 10.0;
  OK(mps_mpm_set_load(s->mpm, load, &def));
}

/* In every step the momentum changes by dt times the sum of the forces. In axisymmetry there is the
 * hoop stress besides, along x. */
TEST(momentum_is_balanced) {
  for (int32_t geometry = MPS_MPM_GEOMETRY_PLANE_STRAIN; geometry <= MPS_MPM_GEOMETRY_SPACE;
       geometry++) {
    int32_t box = -1, loads[2];
    scoped_mpm_scene s = held_begin(context, geometry, &box, loads);
    mps_totals before = mpm_scene_totals(&s);
    double worst = 0.0, total = 0.0;
    int acts[6] = {0};
    for (int step = 0; step < 60; step++) {
      if (step == 20) OK(mps_mpm_remove_load(s.mpm, loads[0]));
      if (step == 30) OK(mps_mpm_set_side(s.mpm, MPS_SIDE_X_LOWER, MPS_BOUNDARY_ABSORBING, 0.0));
      if (step == 40) push_anew(&s, loads[1]);
      const double t = mps_mpm_time(s.mpm);
      OK(mps_mpm_step(s.mpm, 1));
      const mps_totals after = mpm_scene_totals(&s);
      const double dt = mps_mpm_time(s.mpm) - t;
      double force[3];
      held_force(&s, box, force, acts);
      for (int c = geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? 1 : 0; c < s.mpm->grid.dim; c++) {
        const double all = force[c] + after.mass * s.mpm->def.gravity[c];
        worst = fmax(worst, fabs(after.linear[c] - before.linear[c] - s.mpm->run.dt * all));
        total = fmax(total, fabs(after.linear[c]) + fabs(dt * all));
      }
      before = after;
    }
    print_message("geometry %d: momentum balanced within %.2g of it\n", geometry, worst / total);
    assert_true(worst < 1e-12 * total);
    for (int32_t k = 0; k < 2 * s.mpm->grid.dim; k++) assert_true(acts[k] > 5);
  }
}

/* Loads act on the particles that have the ids however the set is sorted. */
TEST(loads_follow_particles) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_ball(&s, 0.0, 0.0, 0.1);
  const double v0[] = {3.0, 0.0}, L[] = {0.0, -20.0, 20.0, 0.0};
  mpm_scene_affine(&s, v0, L);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02);
  const int64_t ids[] = {3, 100, 7};
  const double area[] = {0.1, -0.2, 0.3}, pull[] = {10.0, -20.0};
  int32_t load = -1;
  const mps_mpm_load_def pulls = mpm_scene_load_def(3, ids, area, pull, 2, NULL);
  OK(mps_mpm_add_load(s.mpm, &pulls, &load));
  const uint64_t epoch = mps_particles_epoch(s.particles);
  OK(mps_mpm_step(s.mpm, 200));
  assert_true(mps_particles_epoch(s.particles) > epoch);
  for (int64_t id = 0; id < s.mpm->p.count; id++) {
    const int64_t k = mps_particles_index(s.particles, id);
    double by = 0.0;
    for (int n = 0; n < 3; n++)
      if (ids[n] == id) by = area[n];
    for (int c = 0; c < 2; c++) NEAR(s.mpm->p.f[c][k], by * pull[c], 0.0);
  }
}

/* A body acceleration does what gravity does. */
TEST(body_acceleration_is_gravity) {
  double y[2][400];
  for (int field = 0; field < 2; field++) {
    scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
    mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.2);
    DEF(mpm, def, .cell = 0.02, .lower[1] = 0.0);
    if (field)
      OK(mps_particles_set(s.particles, "body_acceleration", 1, -9.81));
    else
      def.gravity[1] = -9.81;
    mpm_scene_solve(&s, &def);
    OK(mps_mpm_step(s.mpm, 100));
    mps_view x = mpm_scene_view(&s, "position");
    assert_int_equal(x.shape[0], 400);
    for (int64_t k = 0; k < 400; k++)
      y[field][k] = *mps_view_f64(&x, mps_particles_index(s.particles, k), 1);
  }
  for (int k = 0; k < 400; k++) NEAR(y[1][k], y[0][k], 1e-14);
  assert_true(y[0][399] < 0.1949); /* it has sunk */
}
