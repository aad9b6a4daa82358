/* test_mpm_walls.c - walls and loads of the WLS-MPM solver against exact solutions: waves that
 * leave through an absorbing wall, a column at rest on one, a block that slides on a frictional
 * wall, moving walls, a bar under traction.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define NU 0.3
#define RHO 1000.0

static double wave_modulus(double young) {
  return young * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU));
}
static double shear_modulus(double young) { return 0.5 * young / (1.0 + NU); }

/* ---- absorbing ------------------------------------------------------------------------------- */

/* Kinetic and strain energy of the particles with |x| < 0.1 m. */
static double strip_energy(mpm_scene *s, double young) {
  mps_view x = mpm_scene_view(s, "position"), v = mpm_scene_view(s, "velocity");
  mps_view stress = mpm_scene_view(s, "stress"), volume = mpm_scene_view(s, "volume");
  double sum = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    if (fabs(*mps_view_f64(&x, k, 0)) > 0.1) continue;
    double t[4], trace = 0.0, square = 0.0, speed = 0.0;
    for (int c = 0; c < 4; c++) t[c] = *mps_view_f64(&stress, k, c);
    for (int c = 0; c < 2; c++) speed += *mps_view_f64(&v, k, c) * *mps_view_f64(&v, k, c);
    trace = t[0] + t[1] + t[2];
    square = t[0] * t[0] + t[1] * t[1] + t[2] * t[2] + 2.0 * t[3] * t[3];
    sum += *mps_view_f64(&volume, k, 0) *
           (0.5 * RHO * speed + 0.5 * ((1.0 + NU) * square - NU * trace * trace) / young);
  }
  return sum;
}

/* A plane wave of velocity v(y + c t) goes down to the base of a layer so wide that its ends do
 * not matter in the middle. Returns the reflected part of its energy. */
static double reflected(int shear, int32_t wall, int32_t spline) {
  const double E = 1e6, height = 0.6, middle = 0.3, width = 0.07;
  const double G = shear_modulus(E), M = wave_modulus(E), c = sqrt((shear ? G : M) / RHO);
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, E);
  const double half = shear ? 1.3 : 0.8;
  mpm_scene_box(&s, -half, 0.0, half, height);
  OK(mps_particles_add_field(s.particles, "velocity", 0));
  OK(mps_particles_add_field(s.particles, "stress", 0));
  mps_view x = mpm_scene_view(&s, "position");
  EDIT(v, s.particles, "velocity")
    EDIT(stress, s.particles, "stress")
      for (int64_t k = 0; k < x.shape[0]; k++) {
        const double r = (*mps_view_f64(&x, k, 1) - middle) / width, f = 1e-3 * exp(-r * r);
        *mps_edit_f64(&v, k, shear ? 0 : 1) = f;
        *mps_edit_f64(&stress, k, shear ? 3 : 1) = RHO * c * f;
        if (!shear)
          *mps_edit_f64(&stress, k, 0) = *mps_edit_f64(&stress, k, 2) =
              RHO * c * f * NU / (1.0 - NU);
      }
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .spline = spline, .lower[1] = 0.0);
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, wall, 0.0);
  const double before = strip_energy(&s, E);
  OK(mps_mpm_run(s.mpm, 2.0 * middle / c, 1000000, NULL, NULL));
  const double after = strip_energy(&s, E);
  mpm_scene_end(&s);
  return after / before;
}

TEST(waves_leave) {
  for (int shear = 0; shear < 2; shear++) {
    const double held = reflected(shear, MPS_BOUNDARY_HELD, 3);
    assert_true(held > 0.6); /* a fixed wall reflects: the energy is measured */
    for (int32_t spline = 2; spline <= 3; spline++) {
      const double part = reflected(shear, MPS_BOUNDARY_ABSORBING, spline);
      print_message("%s wave, spline %d: %.3f %% of the energy comes back (fixed wall: %.0f %%)\n",
                    shear ? "S" : "P", spline, 100.0 * part, 100.0 * held);
      assert_true(part < 0.01);
    }
  }
}

/* A column under its weight stands on an absorbing wall. */
TEST(absorbing_wall_carries) {
  const double g = 10.0, E = 1e7, height = 1.0;
  for (int turned = 0; turned < 2; turned++) { /* later, or from the start */
    mpm_scene s = mpm_scene_begin(context, 0.02, 0.0, 0.0, E);
    mpm_scene_box(&s, 0.0, 0.0, 0.2, height);
    OK(mps_particles_add_field(s.particles, "stress", 0));
    mps_view x = mpm_scene_view(&s, "position");
    EDIT(stress, s.particles, "stress")
      for (int64_t k = 0; k < x.shape[0]; k++) {
        const double yy = -RHO * g * (height - *mps_view_f64(&x, k, 1));
        *mps_edit_f64(&stress, k, 1) = yy;
        *mps_edit_f64(&stress, k, 0) = *mps_edit_f64(&stress, k, 2) = yy * NU / (1.0 - NU);
      }
    DEF(mpm, def, .cell = 0.04, .lower[0] = def.lower[1] = 0.0, .upper[0] = 0.2, .gravity[1] = -g);
    mpm_scene_solve(&s, &def);
    DEF(mpm_boundary, base, .kind = MPS_BOUNDARY_ABSORBING, .settle = 0.2);
    if (turned) OK(mps_mpm_run(s.mpm, 0.1, 1000000, NULL, NULL));
    OK(mps_mpm_set_boundary(s.mpm, MPS_SIDE_Y_LOWER, &base));
    OK(mps_mpm_run(s.mpm, 0.35, 1000000, NULL, NULL));
    const int64_t id = mps_particles_nearest(s.particles, (double[]){0.1, 0.5});
    const mps_view start = mpm_scene_view(&s, "position");
    const double y0 = *mps_view_f64(&start, mps_particles_index(s.particles, id), 1);
    OK(mps_mpm_run(s.mpm, 1.35, 1000000, NULL, NULL));
    const mps_view end = mpm_scene_view(&s, "position");
    const double sunk = y0 - *mps_view_f64(&end, mps_particles_index(s.particles, id), 1);
    double force[3];
    mpm_scene_force(&s, MPS_SIDE_Y_LOWER, force);
    print_message("middle sinks %.3g m in 1 s, wall force %.6g of the weight\n", sunk,
                  force[1] / (RHO * g * 0.2));
    assert_true(fabs(sunk) < 2e-5); /* without R: by rho g H/(rho c) t = 0.09 m */
    NEAR(force[1], RHO * g * 0.2, 0.01 * RHO * g * 0.2);
    mpm_scene_end(&s);
  }
}

/* ---- friction -------------------------------------------------------------------------------- */

static mps_signal *constant_velocity(double v) {
  const double times[] = {0.0, 100.0}, values[] = {v, v};
  MAKE_KEPT(signal, signal, create_table, context, MPS_SIGNAL_QUANTITY_VELOCITY, 2, times, values);
  return signal;
}

static double mean_x(mpm_scene *s) {
  mps_view x = mpm_scene_view(s, "position");
  double sum = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) sum += *mps_view_f64(&x, k, 0);
  return sum / (double)x.shape[0];
}

/* A block on a wall in gravity inclined by `degrees`; returns its acceleration down the slope. The
 * wall moves with velocity `belt`. `ratio`: of the impulses along and across the wall. */
static double slide(int dim, double mu, double degrees, double belt, double *ratio) {
  const double g = 9.81, slope = degrees * 3.14159265358979323846 / 180.0;
  const double lo[] = {0.0, 0.0, 0.0}, hi[] = {0.2, 0.1, 0.08};
  mpm_scene s = mpm_scene_begin_in(context, dim, 0.01, 0.0, 0.0, 1e6);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  OK(mps_particles_add_field(s.particles, "stress", 0));
  mps_view x = mpm_scene_view(&s, "position");
  EDIT(stress, s.particles, "stress")
    for (int64_t k = 0; k < x.shape[0]; k++) /* of its weight */
      *mps_edit_f64(&stress, k, 1) = -RHO * g * cos(slope) * (hi[1] - *mps_view_f64(&x, k, 1));
  DEF(mpm, def, .geometry = dim == 3 ? MPS_MPM_GEOMETRY_SPACE : MPS_MPM_GEOMETRY_PLANE_STRAIN,
      .cell = 0.02, .lower[1] = 0.0, .gravity[0] = g * sin(slope), .gravity[1] = -g * cos(slope));
  mpm_scene_solve(&s, &def);
  scoped_signal *signal = constant_velocity(belt);
  mpm_scene_drive(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL, mu, 0, signal, 1.0);
  /* At first it vibrates, while friction acts across the slope too, and then continues
   * bouncing a little; positions at three instants give the acceleration without that. */
  const double span = dim == 3 ? 0.15 : 0.3;
  double at[3];
  OK(mps_mpm_run(s.mpm, 0.1, 1000000, NULL, NULL));
  const mps_totals begin = mpm_scene_totals(&s);
  for (int k = 0; k < 3; k++) {
    if (k > 0) OK(mps_mpm_run(s.mpm, 0.1 + k * span, 1000000, NULL, NULL));
    at[k] = mean_x(&s);
  }
  const mps_totals end = mpm_scene_totals(&s);
  mpm_scene_end(&s);
  const double along = (end.linear[0] - begin.linear[0]) / end.mass / (2.0 * span);
  const double across = (end.linear[1] - begin.linear[1]) / end.mass / (2.0 * span);
  *ratio = (g * sin(slope) - along) / (g * cos(slope) + across);
  return (at[2] - 2.0 * at[1] + at[0]) / (span * span);
}

TEST(block_slides) {
  static const struct {
    int dim;
    double mu, degrees, belt;
  } cases[] = {{2, 0.0, 30.0, 0.0},
               {2, 0.2, 30.0, 0.0},
               {2, 0.4, 30.0, 0.0},
               {3, 0.4, 30.0, 0.0},
               {2, 0.3, 0.0, -9.0}};
  double ratio;
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    const double mu = cases[k].mu, slope = cases[k].degrees * 3.14159265358979323846 / 180.0;
    const double exact = 9.81 * (sin(slope) - mu * cos(slope));
    const double a = slide(cases[k].dim, mu, cases[k].degrees, cases[k].belt, &ratio);
    print_message("%dD, %g degrees, wall %g m/s, mu = %.1f: a = %.5f m/s2, exact %.5f, %+.3f %%, "
                  "Fx/Fy = %.5f\n",
                  cases[k].dim, cases[k].degrees, cases[k].belt, mu, a, exact,
                  100.0 * (a / exact - 1.0), ratio);
    NEAR(a, exact, 0.01 * fabs(exact));
    NEAR(ratio, mu, 1e-3);
  }
  const double stuck = slide(2, 0.7, 30.0, 0.0, &ratio); /* tan 30 deg = 0.577 */
  print_message("2D, 30 degrees, mu = 0.7: a = %.5f m/s2, exact 0\n", stuck);
  NEAR(stuck, 0.0, 0.1); /* its shear vibration is left */
}

/* A frictional wall does not pull: a lump that leaves it continues as it was. */
TEST(wall_lets_go) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.1);
  const double v0[] = {0.5, 1.0}, L[4] = {0};
  mpm_scene_affine(&s, v0, L);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .lower[1] = 0.0);
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL, 0.5);
  OK(mps_mpm_step(s.mpm, 100));
  const mps_totals t = mpm_scene_totals(&s);
  NEAR(t.linear[0], 0.5 * t.mass, 1e-12 * t.mass);
  NEAR(t.linear[1], t.mass, 1e-12 * t.mass);
}

/* ---- moving walls ---------------------------------------------------------------------------- */

/* On a base that moves as the body does nothing happens. */
TEST(moves_as_one) {
  scoped_signal *signal = constant_velocity(1.0);
  for (int how = 0; how < 2; how++) {
    scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e6);
    mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.2);
    const double v0[] = {0.7, 0.0}, L[4] = {0};
    mpm_scene_affine(&s, v0, L);
    USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .lower[1] = 0.0);
    if (how) {
      const double lower[] = {-INFINITY, 0.0}, upper[] = {INFINITY, 0.041};
      int32_t box = -1;
      const mps_mpm_boundary_def nodes = mpm_scene_box_def(s.mpm, lower, upper, 0, signal, 0.7);
      OK(mps_mpm_add_boundary(s.mpm, &nodes, &box));
    } else {
      mpm_scene_drive(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0, 0, signal, 0.7);
    }
    OK(mps_mpm_run(s.mpm, 0.1, 1000000, NULL, NULL));
    mps_view x = mpm_scene_view(&s, "position"), v = mpm_scene_view(&s, "velocity");
    double low = INFINITY;
    for (int64_t k = 0; k < x.shape[0]; k++) {
      low = fmin(low, *mps_view_f64(&x, k, 0));
      NEAR(*mps_view_f64(&v, k, 0), 0.7, 1e-12);
      NEAR(*mps_view_f64(&v, k, 1), 0.0, 1e-12);
    }
    NEAR(low, 0.005 + 0.07, 1e-12);
  }
}

/* The base of a column rises by a ramp: the free top does so by twice as much, H/c later. By an
 * absorbing base that is driven with twice the incoming velocity it is the same, and the wave that
 * comes back leaves. */
static void shake(int32_t geometry, bool absorbing) {
  static const char *const names[] = {"plane strain", "axisymmetry", "space"};
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  const double E = 1e6, height = 1.0, rise = 1e-4, c = sqrt(wave_modulus(E) / RHO);
  const double travel = height / c, y0 = height - 0.005, hi[] = {0.04, height, 0.04};
  const double lo[] = {0.0, 0.0, 0.0};
  scoped_signal *signal = NULL;
  OK(mps_signal_create_ramp(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0.0, 0.6 * travel, rise,
                            &signal));
  scoped_mpm_scene s = mpm_scene_begin_in(context, dim, 0.01, 0.0, 0.0, E);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  DEF(mpm, def, .geometry = geometry, .cell = 0.02);
  for (int a = 0; a < dim; a++) {
    def.lower[a] = 0.0;
    if (a != 1) def.upper[a] = hi[a];
  }
  mpm_scene_solve(&s, &def);
  mpm_scene_drive(&s, MPS_SIDE_Y_LOWER, absorbing ? MPS_BOUNDARY_ABSORBING : MPS_BOUNDARY_ROLLER,
                  0.0, 1, signal, absorbing ? 2.0 : 1.0);
  const int64_t id = mps_particles_nearest(s.particles, (double[]){0.02, height, 0.02});
  double worst = 0.0;
  while (mps_mpm_time(s.mpm) < (absorbing ? 3.9 : 2.9) * travel) {
    OK(mps_mpm_step(s.mpm, 1));
    mps_view x = mpm_scene_view(&s, "position");
    const double t = mps_mpm_time(s.mpm);
    const double u = *mps_view_f64(&x, mps_particles_index(s.particles, id), 1) - y0;
    const double exact = mps_signal_displacement(signal, t - y0 / c) +
                         mps_signal_displacement(signal, t - (2.0 * height - y0) / c);
    worst = fmax(worst, fabs(u - exact));
  }
  print_message("%s base rises, %s: top within %.2f %% of 2 u\n", absorbing ? "absorbing" : "rigid",
                names[geometry], 100.0 * worst / (2.0 * rise));
  assert_true(worst < 0.02 * 2.0 * rise);
}

TEST(base_shakes) {
  shake(MPS_MPM_GEOMETRY_PLANE_STRAIN, false);
  for (int32_t geometry = 0; geometry <= MPS_MPM_GEOMETRY_SPACE; geometry++) shake(geometry, true);
}

/* ---- traction -------------------------------------------------------------------------------- */

/* A bar between rollers, held at x = 0, pulled at the other end by `traction` that grows for
 * `duration` s; returns its solver at t_end. */
static mpm_scene pulled(double traction, double duration, double t_end) {
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.0, 0.0, 1.0, 0.08);
  DEF(mpm, def, .cell = 0.02, .lower[0] = def.lower[1] = 0.0, .upper[1] = 0.08);
  mpm_scene_solve(&s, &def);
  int64_t ids[8], count = 0;
  const double lo[] = {0.99, 0.0}, hi[] = {1.0, 1.0}, pull[] = {traction, 0.0};
  OK(mps_particles_select_box(s.particles, lo, hi, 8, &count, ids));
  assert_int_equal(count, 8);
  int32_t load = -1;
  MAKE(signal, signal, create_ramp, context, MPS_SIGNAL_QUANTITY_VALUE, 0.0, duration, 1.0);
  const mps_mpm_load_def pulls = mpm_scene_load_def(count, ids, NULL, pull, 2, signal);
  OK(mps_mpm_add_load(s.mpm, &pulls, &load));
  OK(mps_mpm_run(s.mpm, t_end, 1000000, NULL, NULL));
  return s;
}

TEST(bar_under_traction) {
  const double traction = 100.0, M = wave_modulus(1e6), c = sqrt(M / RHO), period = 4.0 / c;
  /* slowly: u = T x/M where the load acts, and the wall bears it */
  scoped_mpm_scene s = pulled(traction, 6.0 * period, 6.5 * period);
  mps_view x = mpm_scene_view(&s, "position");
  int64_t k = mps_particles_nearest(s.particles, (double[]){1.0, 0.04});
  k = mps_particles_index(s.particles, k);
  const double u = *mps_view_f64(&x, k, 0) - 0.995, exact = traction * 0.995 / M;
  double force[3];
  mpm_scene_force(&s, MPS_SIDE_X_LOWER, force);
  print_message("extension %+.3f %%, wall force %+.3f %%\n", 100.0 * (u / exact - 1.0),
                100.0 * (-force[0] / (traction * 0.08) - 1.0));
  NEAR(u, exact, 0.01 * exact);
  NEAR(force[0], -traction * 0.08, 0.01 * traction * 0.08);
  mpm_scene_end(&s);
  /* fast: a wave of velocity T/(rho c) runs in */
  s = pulled(traction, 0.4 / c, 0.8 / c);
  mps_view v = mpm_scene_view(&s, "velocity");
  x = mpm_scene_view(&s, "position");
  double worst = 0.0;
  const double wave = traction / (RHO * c);
  for (k = 0; k < v.shape[0]; k++) {
    const double at = *mps_view_f64(&x, k, 0), speed = *mps_view_f64(&v, k, 0);
    if (at < 0.15) worst = fmax(worst, fabs(speed)); /* not there yet */
    if (at > 0.65 && at < 0.9) worst = fmax(worst, fabs(speed - wave));
  }
  print_message("wave: velocity within %.2f %% of T/(rho c)\n", 100.0 * worst / wave);
  assert_true(worst < 0.02 * wave);
}
