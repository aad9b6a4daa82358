/* test_mpm_free_field.c - free-field sides of WLS-MPM: ground shaken from below moves at every x as
 * level ground without end, against the closed form of a layer on a half space and against the
 * motion between rollers; ground at rest stays so; the waves of a source leave.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_free_field.h"
#include "test_fixture.h"

/* ---- layer on a half space ------------------------------------------------------------------- */

/* On coarse cells; mpm_free_field_long has others. */
TEST(layer_amplifies) {
  for (int shear = 0; shear < 2; shear++)
    for (int q = 1; q <= 2; q++) {
      const field_response r = field_shake_layer(context, 0.5, q == 1 ? 0.5 : 2.0, shear, 0.0);
      field_print_response(&r);
      NEAR(r.amplification, r.exact, 0.025 * r.exact);
      assert_true(r.apart < 1e-6);
    }
}

/* ---- at rest --------------------------------------------------------------------------------- */

/* Level ground moves alike between rollers, which are mirrors, and between free-field sides, and
 * with either on its left edge of the grid anywhere; so it does with flip_time, of the column too.
 */
TEST(rests_as_between_rollers) {
  for (int q = 0; q < 4; q++) {
    const int32_t spline = 2 + q % 2;
    field_ground of = {.width = 8.0,
                       .height = 8.0,
                       .spacing = 0.5,
                       .vs = 100.0,
                       .gravity = 9.81,
                       .sides = MPS_BOUNDARY_FREE_FIELD,
                       .base = MPS_BOUNDARY_HELD,
                       .flip_time = q < 2 ? 0.0 : 0.1,
                       .spline = spline};
    scoped_mpm_scene a = field_scene(context, &of);
    of.sides = MPS_BOUNDARY_ROLLER;
    scoped_mpm_scene b = field_scene(context, &of);
    double fastest = 0.0, most = 0.0;
    for (int k = 0; k < 50; k++) {
      OK(mps_mpm_step(a.mpm, 100));
      OK(mps_mpm_step(b.mpm, 100));
      const mps_view va = mpm_scene_view(&a, "velocity"), vb = mpm_scene_view(&b, "velocity");
      const mps_view ids = mpm_scene_view(&a, "id");
      for (int64_t n = 0; n < va.shape[0]; n++) {
        const int64_t m = mps_particles_index(b.particles, *mps_view_i64(&ids, n, 0));
        for (int c = 0; c < 2; c++) {
          most = fmax(most, fabs(*mps_view_f64(&va, n, c) - *mps_view_f64(&vb, m, c)));
          fastest = fmax(fastest, fabs(*mps_view_f64(&vb, m, c)));
        }
      }
    }
    print_message(
        "spline %d, flip_time %g s: largest velocity %.3g m/s between rollers; differs by "
        "%.3g m/s, stresses by %.2g\n",
        spline, of.flip_time, fastest, most, mpm_scene_stress_difference(&a, &b));
    mps_reaction r;
    OK(mps_mpm_get_reaction(a.mpm, MPS_SIDE_X_LOWER, &r));
    print_message("force of the left side %.6g N, of the stress %.6g N\n", r.force[0],
                  0.5 * FIELD_K0 * FIELD_RHO * 9.81 * 64.0);
    NEAR(r.force[0], 0.5 * FIELD_K0 * FIELD_RHO * 9.81 * 64.0,
         0.02 * 0.5 * FIELD_K0 * FIELD_RHO * 9.81 * 64.0);
    assert_true(most < 1e-10);
  }
}

/* ---- waves of a source ----------------------------------------------------------------------- */

/* Share of the energy of a blow on the middle of the surface that is left when the slowest wave
 * could have left. */
static double left_over(int32_t sides, double width) {
  const double height = 16.0, vs = 100.0;
  field_ground of = {.width = width,
                     .height = height,
                     .spacing = 0.25,
                     .vs = vs,
                     .sides = sides,
                     .base = MPS_BOUNDARY_ABSORBING,
                     .shift = -0.5 * width};
  mpm_scene s = field_scene(context, &of);
  const mps_view x = mpm_scene_view(&s, "position");
  EDIT(v, s.particles, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const double X = *mps_view_f64(&x, k, 0), Y = *mps_view_f64(&x, k, 1) - height;
      *mps_edit_f64(&v, k, 1) = -1e-3 * exp(-(X * X + Y * Y) / (1.5 * 1.5));
    }
  const double young = field_young(vs), before = field_energy(&s, young);
  OK(mps_mpm_run(s.mpm, 1.6 * width / vs, 1000000, NULL, NULL));
  const double after = field_energy(&s, young);
  mpm_scene_end(&s);
  return after / before;
}

TEST(waves_leave) {
  const double field = left_over(MPS_BOUNDARY_FREE_FIELD, 16.0);
  const double absorbing = left_over(MPS_BOUNDARY_ABSORBING, 16.0);
  const double rollers = left_over(MPS_BOUNDARY_ROLLER, 16.0);
  print_message(
      "left of the energy: free field %.3f %%, absorbing sides %.3f %%, rollers %.1f %%\n",
      100.0 * field, 100.0 * absorbing, 100.0 * rollers);
  assert_true(rollers > 0.1);
  assert_true(field < 0.02);
}

/* ---- waves in saturated ground --------------------------------------------------------------- */

/* Share of the kinetic energy of a plane wave across x, in undrained ground (permeability 0) or in
 * ground whose water flows, that is there when it would have come back from the sides. */
static double wet_energy_left(int32_t sides, double permeability, bool water_first) {
  const double width = 16.0, vs = 100.0, n = 0.4, modulus = 3.5 * FIELD_RHO * vs * vs;
  field_ground of = {.width = width,
                     .height = 2.0,
                     .spacing = 0.25,
                     .vs = vs,
                     .sides = water_first ? MPS_BOUNDARY_ROLLER : sides,
                     .base = MPS_BOUNDARY_ROLLER,
                     .lid = true,
                     .shift = -0.5 * width};
  mpm_scene s = field_scene(context, &of);
  DEF(pore_water, water, .porosity = n, .bulk = 20.0 * n * modulus);
  if (permeability > 0.0) water.permeability = permeability;
  OK(mps_mpm_add_pore_water(s.mpm, &water));
  of.sides = sides;
  if (water_first) field_set_sides(&s, &of);
  const mps_view x = mpm_scene_view(&s, "position");
  EDIT(v, s.particles, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const double X = *mps_view_f64(&x, k, 0) / 1.5;
      *mps_edit_f64(&v, k, 0) = 1e-3 * exp(-X * X);
    }
  const double before = mpm_scene_totals(&s).kinetic, c = sqrt(21.0 * modulus / FIELD_RHO);
  OK(mps_mpm_run(s.mpm, width / c, 1000000, NULL, NULL));
  const double after = mpm_scene_totals(&s).kinetic;
  mpm_scene_end(&s);
  return after / before;
}

/* The dashpots have the impedance of the saturated ground, 4.6 times that of the skeleton. */
TEST(waves_leave_saturated_ground) {
  const double rollers = wet_energy_left(MPS_BOUNDARY_ROLLER, 0.0, true);
  assert_true(rollers > 0.6); /* the energy is measured */
  for (int q = 0; q < 6; q++) {
    const int32_t sides = q % 2 ? MPS_BOUNDARY_FREE_FIELD : MPS_BOUNDARY_ABSORBING;
    const double k = q / 2 == 2 ? 1e-4 : 0.0;
    const double left = wet_energy_left(sides, k, q / 2 != 1);
    print_message("saturated, k = %g m/s, %s sides%s: %.3f %% of the energy of a P wave comes back "
                  "(rollers %.0f %%)\n",
                  k, q % 2 ? "free-field" : "absorbing", q / 2 == 1 ? " set before the water" : "",
                  100.0 * left, 100.0 * rollers);
    assert_true(left < 0.02);
  }
}

/* ---- energy ---------------------------------------------------------------------------------- */

TEST(energy_is_balanced) {
  scoped_signal *signal = field_shaking(context, 3.0, 0.1, 2.0);
  const field_ground of = {.width = 8.0,
                           .height = 8.0,
                           .spacing = 0.5,
                           .vs = 100.0,
                           .gravity = 9.81,
                           .sides = MPS_BOUNDARY_FREE_FIELD,
                           .base = MPS_BOUNDARY_ABSORBING,
                           .motion = signal,
                           .budget = 1};
  scoped_mpm_scene s = field_scene(context, &of);
  EDIT(v, s.particles, "velocity")
    for (int64_t k = 0; k < v.view.shape[0]; k++) *mps_edit_f64(&v, k, 0) = k % 7 == 0 ? 0.01 : 0.0;
  OK(mps_mpm_run(s.mpm, 1.0, 1000000, NULL, NULL));
  mps_mpm_energy_report l;
  OK(mps_mpm_get_energy_report(s.mpm, &l));
  const mps_totals t = mpm_scene_totals(&s);
  const double size = t.kinetic + fabs(t.work_boundaries) + fabs(l.transfer) + fabs(l.stepping);
  mps_reaction r;
  OK(mps_mpm_get_reaction(s.mpm, MPS_SIDE_X_LOWER, &r));
  print_message("residual %.2g of %.4g J; dashpots took %.4g J, left side did %.4g J\n",
                l.residual / size, size, l.boundaries, r.work);
  assert_true(fabs(l.residual) < 1e-11 * size);
  assert_true(l.boundaries >= 0.0);
}

/* ---- ground that yields ---------------------------------------------------------------------- */

static mpm_scene shaken_sand(double width, int32_t sides, double end, mps_signal *signal) {
  DEF(material_mohr_coulomb, law, .young = field_young(100.0), .poisson = FIELD_NU,
      .friction = 30.0 * PI / 180.0, .cohesion = 1000.0);
  MAKE(material, sand, create_mohr_coulomb, context, &law);
  const field_ground of = {.width = width,
                           .height = 8.0,
                           .spacing = 0.5,
                           .vs = 100.0,
                           .gravity = 9.81,
                           .sides = sides,
                           .base = MPS_BOUNDARY_HELD,
                           .motion = signal,
                           .law = sand};
  mpm_scene s = field_scene(context, &of);
  OK(mps_mpm_run(s.mpm, end, 1000000, NULL, NULL));
  return s;
}

/* Velocity and shear strain of the particles nearest to (X, Y) at rest: v_x, plastic strain. */
static void look(mpm_scene *s, int64_t id, double *out) {
  const int64_t k = mps_particles_index(s->particles, id);
  const mps_view v = mpm_scene_view(s, "velocity"), x = mpm_scene_view(s, "position");
  const mps_view strain = mpm_scene_view(s, "plastic_strain");
  out[0] = *mps_view_f64(&v, k, 0);
  out[1] = *mps_view_f64(&strain, k, 0);
  out[2] = *mps_view_f64(&x, k, 1);
}

/* The reference is the middle of ground so wide that nothing of its sides has come there. */
TEST(yielding_ground_moves_alike) {
  const double end = 1.2, far = 480.0;
  scoped_signal *signal = field_shaking(context, 3.0, 0.3, end);
  scoped_mpm_scene wide = shaken_sand(far, MPS_BOUNDARY_ROLLER, end, signal);
  double peak = 0.0, yielded = 0.0, most[2] = {0.0};
  static const double width[] = {6.0, 16.0};
  for (size_t w = 0; w < sizeof width / sizeof *width; w++) {
    scoped_mpm_scene s = shaken_sand(width[w], MPS_BOUNDARY_FREE_FIELD, end, signal);
    double apart[2] = {0.0};
    const mps_view x = mpm_scene_view(&s, "position"), id = mpm_scene_view(&s, "id");
    const double shift = floor(0.5 * far);
    for (int64_t k = 0; k < x.shape[0]; k++) {
      double a[3], b[3];
      const double at[2] = {*mps_view_f64(&x, k, 0) + shift, *mps_view_f64(&x, k, 1)};
      look(&s, *mps_view_i64(&id, k, 0), a);
      look(&wide, mps_particles_nearest(wide.particles, at), b);
      for (int c = 0; c < 2; c++) apart[c] = fmax(apart[c], fabs(a[c] - b[c]));
      peak = fmax(peak, fabs(b[0])), yielded = fmax(yielded, b[1]);
    }
    for (int c = 0; c < 2; c++) most[c] = fmax(most[c], apart[c]);
    print_message("%g m wide: velocity differs by %.3f %% of %.3g m/s, plastic strain by %.3f %% "
                  "of %.3g\n",
                  width[w], 100.0 * apart[0] / peak, peak, 100.0 * apart[1] / yielded, yielded);
  }
  assert_true(yielded > 1e-3);
  assert_true(most[0] < 0.02 * peak);
  assert_true(most[1] < 0.02 * yielded);
}

/* ---- ground that moves past its sides -------------------------------------------------------- */

/* Level ground of two layers that slides by more than its width over a smooth base is the same
 * ground: particles that leave at one side come in at the other, no stress arises, and the rows
 * stay even. Stopped at the side, they piled up there from half a spacing on. */
TEST(ground_passes_its_sides) {
  for (int q = 0; q < 6; q++) { /* three grids, both splines, both ways */
    const double spacing[] = {0.5, 0.25, 0.125}, v = q % 2 ? -1.7 : 1.3;
    const field_ground of = {.width = 8.0 * spacing[q / 2],
                             .height = 4.0,
                             .spacing = spacing[q / 2],
                             .vs = 100.0,
                             .rock = 300.0,
                             .below = 2.0,
                             .sides = MPS_BOUNDARY_FREE_FIELD,
                             .base = MPS_BOUNDARY_ROLLER,
                             .shift = 0.07 * q * spacing[q / 2],
                             .spline = 2 + q % 2};
    mpm_scene s = field_scene(context, &of);
    EDIT(u, s.particles, "velocity")
      for (int64_t k = 0; k < u.view.shape[0]; k++) *mps_edit_f64(&u, k, 0) = v;
    field_set_sides(&s, &of); /* columns that move as the ground does */
    const double end = 1.3 * of.width / fabs(v);
    OK(mps_mpm_run(s.mpm, end, 10000000, NULL, NULL));
    const mps_view x = mpm_scene_view(&s, "position"), id = mpm_scene_view(&s, "id");
    const mps_view stress = mpm_scene_view(&s, "stress");
    double apart = 0.0, most = 0.0;
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const double first = of.shift + ((double)(*mps_view_i64(&id, k, 0) % 8) + 0.5) * of.spacing;
      const double off = *mps_view_f64(&x, k, 0) - first - v * mps_mpm_time(s.mpm);
      apart = fmax(apart, fabs(off - of.width * round(off / of.width)));
      for (int c = 0; c < 4; c++) most = fmax(most, fabs(*mps_view_f64(&stress, k, c)));
    }
    print_message("spacing %g m, %g m past its sides: places off by %.2g spacings, stress %.2g of "
                  "rho V_s^2\n",
                  of.spacing, end * fabs(v), apart / of.spacing,
                  most / (FIELD_RHO * of.vs * of.vs));
    NEAR(apart, 0.0, 0.05 * of.spacing);
    NEAR(most, 0.0, 1e-9 * FIELD_RHO * of.vs * of.vs);
    mpm_scene_end(&s);
  }
}

/* Of ground that is lower at one side they do not: it would come in above or below the surface. */
TEST(uneven_ground_is_stopped) {
  const field_ground of = {.width = 4.0,
                           .height = 2.0,
                           .spacing = 0.25,
                           .vs = 100.0,
                           .sides = MPS_BOUNDARY_FREE_FIELD,
                           .base = MPS_BOUNDARY_ROLLER};
  scoped_mpm_scene s = field_scene(context, &of);
  int64_t ids[64], count;
  const double lo[2] = {2.0, 1.0}, hi[2] = {4.0, 2.0};
  OK(mps_particles_select_box(s.particles, lo, hi, 64, &count, ids));
  OK(mps_particles_remove(s.particles, ids, count));
  EDIT(u, s.particles, "velocity")
    for (int64_t k = 0; k < u.view.shape[0]; k++) *mps_edit_f64(&u, k, 0) = 1.0;
  field_set_sides(&s, &of);
  OK(mps_mpm_run(s.mpm, 0.2, 10000000, NULL, NULL));
  const mps_view x = mpm_scene_view(&s, "position"), id = mpm_scene_view(&s, "id");
  for (int64_t k = 0; k < x.shape[0]; k++)
    if (*mps_view_i64(&id, k, 0) % 16 > 7) assert_true(*mps_view_f64(&x, k, 0) > 1.0);
}
