/* test_mpm_flip.c - `flip_time`: what a transfer takes from a wave no longer goes with the number
 * of steps, is what two fractions say, and vanishes for a long time; momentum is conserved;
 * refusals. docs/theory/transfers.md has the equations. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define CELL 0.02 /* m */

/* ---- a wave without forces ------------------------------------------------------------------- */

/* Kinetic energy left of a shear wave of 12 cells, v_y = cos k x between rollers, after `steps`
 * steps of dt over that after the first: the block is so soft that nothing but transfers acts.
 * `scheme`: of water in its pores, -1: none. */
static double wet_energy_left(int32_t scheme, int32_t volumetric, double flip_time, double dt,
                              int64_t steps) {
  const double k = 2.0 * PI / (12.0 * CELL), width = 12.0 * CELL;
  scoped_mpm_scene s = mpm_scene_begin(context, 0.5 * CELL, 0.0, 0.0, 1e-6);
  mpm_scene_box(&s, 0.0, 0.0, width, width);
  OK(mps_particles_add_field(s.particles, "velocity", 0));
  mps_view x = mpm_scene_view(&s, "position");
  EDIT(v, s.particles, "velocity")
    for (int64_t p = 0; p < x.shape[0]; p++)
      *mps_edit_f64(&v, p, 1) = 1e-3 * cos(k * *mps_view_f64(&x, p, 0));
  USING(mpm, mpm_scene_solve(&s, &given), .cell = CELL, .dt = dt, .flip_time = flip_time,
        .lower[0] = 0.0, .upper[0] = width, .volumetric = volumetric);
  DEF(pore_water, water, .scheme = scheme, .porosity = 0.4);
  if (scheme >= 0) OK(mps_mpm_add_pore_water(s.mpm, &water));
  OK(mps_mpm_step(s.mpm, 5)); /* slopes have become those of the wave */
  const double start = mpm_scene_totals(&s).kinetic;
  OK(mps_mpm_step(s.mpm, steps));
  return mpm_scene_totals(&s).kinetic / start;
}

static double energy_left(double flip_time, double dt, int64_t steps) {
  return wet_energy_left(-1, MPS_MPM_VOLUMETRIC_BY_LAW, flip_time, dt, steps);
}

/* Without it twice the steps lose twice as much; with it as much in the same time: (1 - k)/(1 - b)
 * of that in each step, k = exp(-dt/flip_time), where b is the part of the nodes' velocity that
 * comes from the slopes: 1 - sinc^8(pi/12) = 0.087 for cubic weights, up to the loss itself. */
TEST(loss_is_by_time) {
  const double dt = 1e-3, time = 20e-3;
  const double loss = -log(energy_left(0.0, dt, 40)), halved = -log(energy_left(0.0, 0.5 * dt, 80));
  const double kept = -log(energy_left(time, dt, 40)), fine = -log(energy_left(time, 0.5 * dt, 80));
  const double sinc = sin(PI / 12.0) / (PI / 12.0), slopes = 1.0 - pow(sinc, 8.0);
  const double expected = (1.0 - exp(-dt / time)) / (1.0 - slopes);
  print_message("loss %.5f, at half the step %.5f; with flip_time %.6f, %.6f, ratio %.4f (%.4f)\n",
                loss, halved, kept, fine, kept / loss, expected);
  assert_true(loss > 0.1);
  NEAR(halved / loss, 2.0, 0.05);
  NEAR(fine / kept, 1.0, 0.05);
  NEAR(kept / loss, expected, 0.1 * expected);
}

TEST(a_long_time_loses_nothing) { NEAR(energy_left(1e9, 1e-3, 40), 1.0, 1e-9); }

/* Water in the pores has no part in a wave without changes of volume, whichever part of the step
 * finds its pressures. */
TEST(water_changes_nothing) {
  const double dt = 1e-3, time = 20e-3, dry = energy_left(time, dt, 40);
  for (int32_t scheme = MPS_PORE_SCHEME_EXPLICIT; scheme <= MPS_PORE_SCHEME_IMPLICIT; scheme++)
    for (int32_t q = 0; q < 2; q++) {
      const int32_t by = q == 0 ? MPS_MPM_VOLUMETRIC_POINT : MPS_MPM_VOLUMETRIC_CELL;
      const double wet = wet_energy_left(scheme, by, time, dt, 40);
      print_message("scheme %d, volumetric %d: %.9f of the energy, dry %.9f\n", scheme, by, wet,
                    dry);
      NEAR(wet, dry, 1e-6);
    }
}

/* ---- momentum -------------------------------------------------------------------------------- */

/* A soft disc or ball that rotates and shakes in empty space. */
static mps_totals shaken(int dim, double flip_time, mps_totals *start) {
  const double v0[] = {0.4, -0.3, 0.2}, centre[] = {0.0, 0.0, 0.0};
  const double plane[] = {0.5, -6.0, 5.0, -0.8};
  const double space[] = {0.5, -6.0, 2.0, 5.0, -0.8, 3.0, -1.0, -4.0, 0.3};
  scoped_mpm_scene s = mpm_scene_begin_in(context, dim, 0.01, 0.003, -0.001, 1e5);
  OK(mps_particles_fill_ball(s.particles, centre, dim == 3 ? 0.06 : 0.12, NULL));
  mpm_scene_affine(&s, v0, dim == 3 ? space : plane);
  USING(mpm, mpm_scene_solve(&s, &given),
        .geometry = dim == 3 ? MPS_MPM_GEOMETRY_SPACE : MPS_MPM_GEOMETRY_PLANE_STRAIN, .cell = CELL,
        .flip_time = flip_time);
  *start = mpm_scene_totals(&s);
  OK(mps_mpm_step(s.mpm, dim == 3 ? 300 : 1000));
  return mpm_scene_totals(&s);
}

TEST(momentum_is_kept) {
  for (int dim = 2; dim <= 3; dim++) {
    mps_totals start;
    const mps_totals without = shaken(dim, 0.0, &start), with = shaken(dim, 0.01, &start);
    double linear = 0.0, angular = 0.0, size = 0.0, turn = 0.0;
    for (int c = 0; c < 3; c++) {
      linear = fmax(linear, fabs(with.linear[c] - start.linear[c]));
      angular = fmax(angular, fabs(with.angular[c] - start.angular[c]));
      size = fmax(size, fabs(start.linear[c])), turn = fmax(turn, fabs(start.angular[c]));
    }
    print_message("%dD: linear %.2g, angular %.2g; kinetic %.4f and without %.4f of the start\n",
                  dim, linear / size, angular / turn, with.kinetic / start.kinetic,
                  without.kinetic / start.kinetic);
    assert_true(linear <= 1e-12 * size);
    assert_true(angular <= 5e-3 * turn);
    assert_true(with.kinetic < start.kinetic);
  }
}

/* ---- refusals -------------------------------------------------------------------------------- */

TEST(times_are_checked) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  OK(mps_particles_set(s.particles, "density", 0, 1000.0));
  const double bad[] = {-1e-3, INFINITY, 2e9};
  DEF(mpm, def, .cell = CELL);
  for (int k = 0; k < 3; k++) {
    def.flip_time = bad[k];
    REFUSES(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm),
            "must be in 0 to 1e+09");
  }
  def.flip_time = 0.01;
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  REFUSES(mps_experimental_mpm_standard(s.mpm, 1.0), "flip_time of the definition is 0.01 s");
  REFUSES(mps_experimental_mpm_transfer(s.mpm, MPS_EXPERIMENTAL_TRANSFER_WEIGHT),
          "flip_time of the definition is 0.01 s");
  OK(mps_mpm_step(s.mpm, 3));
}
