/* test_mpm_pore_water.c - pore water against exact solutions: a layer that consolidates under a
 * load (Terzaghi) in plane strain, axisymmetry and space, water at rest under its weight with the
 * surface at any part of a cell, undrained compression, flow through layers.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pore_column.h"
#include "test_fixture.h"

#define LOAD 1000.0 /* Pa */

static void add_load(pore_column *c, double pressure) {
  int64_t ids[16];
  const double traction[] = {0.0, -pressure, 0.0};
  const int64_t count = pore_column_top(c, ids, 16);
  mps_mpm_load_def load = mpm_scene_load_def(count, ids, NULL, traction, 3, NULL);
  OK(mps_mpm_add_load(c->s.mpm, &load, NULL));
}

static double volume_of(pore_column *c) { return mpm_scene_totals(&c->s).volume; }

static void terzaghi(int32_t geometry, int32_t scheme) {
  static const double times[] = {0.05, 0.2, 0.5};
  pore_column c = pore_column_begin(context, geometry, 20, 0.0, 10.0);
  DEF(pore_water, water, .scheme = scheme, .porosity = 0.4, .bulk = 0.4 * 50.0 * c.modulus);
  water.permeability =
      0.25 * 1000.0 * MPS_PORE_GRAVITY / c.modulus; /* c_v = 0.25 m2/s: T = 1 is 4 s */
  OK(mps_mpm_add_pore_water(c.s.mpm, &water));
  OK(mps_particles_set(c.s.particles, "pore_pressure", 0, LOAD));
  const double volume = volume_of(&c), mass = mpm_scene_totals(&c.s).mass;
  add_load(&c, LOAD);
  for (size_t t = 0; t < sizeof times / sizeof *times; t++) {
    const double T = times[t];
    OK(mps_mpm_run(c.s.mpm, T * 4.0, 1000000, NULL, NULL));
    const mps_view x = mpm_scene_view(&c.s, "position"), u = mpm_scene_view(&c.s, "pore_pressure");
    double worst = 0.0;
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const double y = *mps_view_f64(&x, k, 1);
      worst = fmax(worst, fabs(*mps_view_f64(&u, k, 0) / LOAD - pore_terzaghi(1.0 - y, T)));
    }
    const double settled = (1.0 - volume_of(&c) / volume) * c.modulus / LOAD;
    mps_pore_budget budget;
    OK(mps_mpm_get_pore_budget(c.s.mpm, &budget));
    print_message("geometry %d, scheme %d, T = %.2f: u/q within %.2f %%, S M'/(q H) = %.4f, exact "
                  "%.4f; %.5g kg "
                  "drained, residual %.1e\n",
                  geometry, scheme, T, 100.0 * worst, settled, pore_terzaghi_degree(T),
                  budget.drained, budget.residual);
    const bool implicit = scheme == MPS_PORE_SCHEME_IMPLICIT;
    assert_true(worst < (implicit ? 0.015 : 0.01));
    NEAR(settled, pore_terzaghi_degree(T), implicit ? 0.022 : 0.02);
    /* implicit pressures store water as the square of the step */
    assert_true(fabs(budget.residual) < (implicit ? 0.1 : 0.01) * budget.drained);
    /* what has left is what the particles lack, to rounding */
    NEAR(mass - mpm_scene_totals(&c.s).mass, budget.drained, 1e-13 * mass);
    NEAR(budget.left - budget.entered, budget.drained, 1e-13 * budget.start);
  }
  mpm_scene_end(&c.s);
}

TEST(consolidates_in_the_plane) {
  terzaghi(MPS_MPM_GEOMETRY_PLANE_STRAIN, MPS_PORE_SCHEME_EXPLICIT);
  terzaghi(MPS_MPM_GEOMETRY_PLANE_STRAIN, MPS_PORE_SCHEME_IMPLICIT);
}

TEST(consolidates_in_a_ring) {
  terzaghi(MPS_MPM_GEOMETRY_AXISYMMETRIC, MPS_PORE_SCHEME_EXPLICIT);
  terzaghi(MPS_MPM_GEOMETRY_AXISYMMETRIC, MPS_PORE_SCHEME_IMPLICIT);
}

TEST(consolidates_in_space) {
  terzaghi(MPS_MPM_GEOMETRY_SPACE, MPS_PORE_SCHEME_EXPLICIT);
  terzaghi(MPS_MPM_GEOMETRY_SPACE, MPS_PORE_SCHEME_IMPLICIT);
}

/* ---- water at rest --------------------------------------------------------------------------- */

/* Pressure rho_w g depth, effective stress of the buoyant weight, the surface at any part of a
 * cell: all stays as it is, within the half-filled cells of the surface. */
static void at_rest(double cells, int32_t scheme) {
  const double g = 10.0, water_weight = 1000.0 * g, weight = 2000.0 * g, K0 = 0.3 / 0.7;
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, cells, g, 4.0);
  DEF(pore_water, water, .scheme = scheme, .porosity = 0.4, .bulk = 0.4 * 10.0 * c.modulus,
      .permeability = 0.1 * 1000.0 * MPS_PORE_GRAVITY / c.modulus);
  OK(mps_mpm_add_pore_water(c.s.mpm, &water));
  const double surface[] = {0.0, 1.0};
  OK(mps_mpm_set_pore_level(c.s.mpm, surface));
  mps_view x = mpm_scene_view(&c.s, "position");
  EDIT(stress, c.s.particles, "stress")
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const double yy = -(weight - water_weight) * (1.0 - *mps_view_f64(&x, k, 1));
      *mps_edit_f64(&stress, k, 0) = *mps_edit_f64(&stress, k, 2) = K0 * yy;
      *mps_edit_f64(&stress, k, 1) = yy;
    }
  OK(mps_mpm_run(c.s.mpm, 1.0, 1000000, NULL, NULL));
  x = mpm_scene_view(&c.s, "position");
  const mps_view u = mpm_scene_view(&c.s, "pore_pressure"), v = mpm_scene_view(&c.s, "velocity");
  double worst = 0.0, fastest = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double exact = water_weight * (1.0 - *mps_view_f64(&x, k, 1));
    worst = fmax(worst, fabs(*mps_view_f64(&u, k, 0) - exact) / water_weight);
    fastest = fmax(fastest, fabs(*mps_view_f64(&v, k, 1)));
  }
  mps_pore_budget budget;
  OK(mps_mpm_get_pore_budget(c.s.mpm, &budget));
  print_message(
      "%.1f cells, scheme %d: p_w within %.3f %% of the base's, %.1e m/s, %.1e of the water left\n",
      cells, scheme, 100.0 * worst, fastest, budget.drained / budget.start);
  assert_true(worst < 0.015);
  assert_true(fastest < 3e-5);
  assert_true(fabs(budget.drained) < 1e-3 * budget.start);
  mpm_scene_end(&c.s);
}

TEST(stays_at_rest) {
  at_rest(20.0, MPS_PORE_SCHEME_EXPLICIT);
  at_rest(19.3, MPS_PORE_SCHEME_EXPLICIT);
  at_rest(19.5, MPS_PORE_SCHEME_EXPLICIT);
  at_rest(19.7, MPS_PORE_SCHEME_EXPLICIT);
  at_rest(20.0, MPS_PORE_SCHEME_IMPLICIT);
  at_rest(19.7, MPS_PORE_SCHEME_IMPLICIT);
}

/* ---- waves ----------------------------------------------------------------------------------- */

#define LENGTH 64.0 /* cells */
#define SPEED 1e-4  /* m/s */

/* Largest kinetic energy of `count` steps, over that of the speed SPEED in all ground. */
static double largest_energy(mpm_scene *s, int count) {
  double most = 0.0;
  for (int step = 0; step < count; step++) {
    double sum = 0.0;
    OK(mps_mpm_step(s->mpm, 1));
    const mps_view v = mpm_scene_view(s, "velocity");
    for (int64_t k = 0; k < v.shape[0]; k++) sum += pow(*mps_view_f64(&v, k, 1) / SPEED, 2.0);
    most = fmax(most, sum / (double)v.shape[0]);
  }
  return most;
}

/* A standing wave of `halves` half waves in undrained ground between two ends, without any damping:
 * it must not grow. Slopes of the pressures that lag behind by the steps between two exchanges, and
 * are not taken in part, give its energy 1 % in 1500 steps with cubic weights. */
static void stands(int halves, int32_t spline, int32_t volumetric) {
  const double lo[] = {0.0, 0.0}, hi[] = {1.0, LENGTH};
  scoped_mpm_scene s = mpm_scene_begin_in(context, 2, 0.5, 0.0, 0.0, PORE_YOUNG);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  OK(mps_particles_set(s.particles, "density", 0, 2000.0));
  DEF(mpm, def, .cell = 1.0, .spline = spline, .volumetric = volumetric);
  for (int c = 0; c < 2; c++) def.lower[c] = lo[c], def.upper[c] = hi[c];
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  USING(pore_water, mps_mpm_add_pore_water(s.mpm, &given), .porosity = 0.4);
  const mps_view x = mpm_scene_view(&s, "position");
  EDIT(v, s.particles, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++)
      *mps_edit_f64(&v, k, 1) =
          SPEED * sin(3.14159265358979323846 * halves * *mps_view_f64(&x, k, 1) / LENGTH);
  const double first = largest_energy(&s, 300);
  (void)largest_energy(&s, 900);
  const double last = largest_energy(&s, 300);
  print_message("%d half waves in 64 cells, degree %d, volumetric %d: largest kinetic energy %.4f, "
                "after 1200 steps %.4f\n",
                halves, spline, volumetric, first, last);
  NEAR(first, 0.5, 0.08);
  assert_true(last < first);
}

TEST(waves_do_not_grow) {
  for (int32_t spline = 2; spline <= 3; spline++) {
    stands(2, spline, MPS_MPM_VOLUMETRIC_CELL);
    stands(4, spline, MPS_MPM_VOLUMETRIC_CELL);
    stands(9, spline, MPS_MPM_VOLUMETRIC_CELL);
    stands(4, spline, MPS_MPM_VOLUMETRIC_POINT);
  }
}

/* ---- layers ---------------------------------------------------------------------------------- */

/* Water that flows up through two layers at 4 : 1: the flux q = p/(rho_w g (H1/k1 + H2/k2)), and
 * 4/5 of the pressure is left at their interface. */
TEST(flows_through_layers) {
  const double k1 = 4e-4, k2 = 1e-4, base = 1000.0, weight = 1000.0 * MPS_PORE_GRAVITY;
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 10.0, 0.0, 4.0);
  OK(mps_particles_add_field(c.s.particles, "permeability", 0));
  OK(mps_particles_add_field(c.s.particles, "seepage", 0));
  mps_view x = mpm_scene_view(&c.s, "position");
  EDIT(k_of, c.s.particles, "permeability")
    for (int64_t k = 0; k < x.shape[0]; k++)
      *mps_edit_f64(&k_of, k, 0) = *mps_view_f64(&x, k, 1) < 0.5 ? k1 : k2;
  DEF(pore_water, water, .porosity = 0.4, .bulk = 0.4 * 4.0 * c.modulus);
  OK(mps_mpm_add_pore_water(c.s.mpm, &water));
  int32_t number;
  USING(pore_face, mps_mpm_add_pore_face(c.s.mpm, &given, &number), .kind = MPS_PORE_FACE_DRAINED,
        .sides = 1u << MPS_SIDE_Y_LOWER, .pressure = base);
  OK(mps_mpm_run(c.s.mpm, 100.0, 1000000, NULL, NULL));
  const double flux = base / (weight * (0.5 / k1 + 0.5 / k2)),
               middle = base * 0.5 / k2 * weight * flux / base;
  double in, out, came, went, worst = 0.0;
  mps_pore_budget budget;
  OK(mps_mpm_get_pore_flow(c.s.mpm, number, &in, NULL));
  OK(mps_mpm_get_pore_flow(c.s.mpm, -1, &out, NULL));
  x = mpm_scene_view(&c.s, "position");
  const mps_view u = mpm_scene_view(&c.s, "pore_pressure"), q = mpm_scene_view(&c.s, "seepage");
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double y = *mps_view_f64(&x, k, 1);
    const double exact = y < 0.5 ? base + (middle - base) * y / 0.5 : middle * (1.0 - y) / 0.5;
    worst = fmax(worst, fabs(*mps_view_f64(&u, k, 0) - exact) / base);
    NEAR(*mps_view_f64(&q, k, 1), flux, 0.02 * flux);
  }
  print_message("layers: p within %.2f %%, %.6g kg/s in, %.6g kg/s out, exact %.6g\n",
                100.0 * worst, -in, out, flux * 1000.0 * c.h);
  OK(mps_mpm_get_pore_flow(c.s.mpm, number, NULL, &came));
  OK(mps_mpm_get_pore_flow(c.s.mpm, -1, NULL, &went));
  OK(mps_mpm_get_pore_budget(c.s.mpm, &budget));
  print_message("came in %.9g kg, went out %.9g kg\n", budget.entered, budget.left);
  assert_true(came < 0.0 && went > 0.0);
  NEAR(budget.left - budget.entered, came + went, 1e-12 * went);
  assert_true(budget.entered > -came * (1.0 - 1e-12)); /* the surface draws some in at first */
  NEAR(-in, flux * 1000.0 * c.h, 0.01 * flux * 1000.0 * c.h);
  NEAR(out, flux * 1000.0 * c.h, 0.01 * flux * 1000.0 * c.h);
  assert_true(worst < 0.01);
  mpm_scene_end(&c.s);
}

/* u/u0 at height z of two layers of the same M', c = c_v below 1/2 and above, drained at z = 1 and
 * impervious at 0: the series of the products X(z) exp(-b^2 t) with
 * X = cos(b z/sqrt(c0)) sin(x1), sin(b (1 - z)/sqrt(c1)) cos(x0), x = b/(2 sqrt(c)),
 * whose flow is the same on both sides where sqrt(c0) sin x0 sin x1 = sqrt(c1) cos x0 cos x1. */
static double jump_of(const double *root, double b) {
  const double x0 = 0.5 * b / root[0], x1 = 0.5 * b / root[1];
  return root[0] * sin(x0) * sin(x1) - root[1] * cos(x0) * cos(x1);
}
static double two_layers(const double *c, double z, double t) {
  const double root[2] = {sqrt(c[0]), sqrt(c[1])}, step = 1e-3 * root[0];
  double sum = 0.0;
  for (double b = step; b * b * t < 40.0; b += step) {
    if (jump_of(root, b - step) * jump_of(root, b) > 0.0) continue;
    double low = b - step, high = b;
    for (int i = 0; i < 60; i++) {
      const double middle = 0.5 * (low + high);
      *(jump_of(root, low) * jump_of(root, middle) > 0.0 ? &low : &high) = middle;
    }
    const double x0 = 0.5 * low / root[0], x1 = 0.5 * low / root[1];
    const double whole = (sin(x1) * root[0] * sin(x0) + cos(x0) * root[1] * (1.0 - cos(x1))) / low;
    const double square = sin(x1) * sin(x1) * (0.25 + 0.25 * root[0] / low * sin(2.0 * x0)) +
                          cos(x0) * cos(x0) * (0.25 - 0.25 * root[1] / low * sin(2.0 * x1));
    const double X =
        z < 0.5 ? cos(low * z / root[0]) * sin(x1) : sin(low * (1.0 - z) / root[1]) * cos(x0);
    sum += whole / square * X * exp(-low * low * t);
  }
  return sum;
}

TEST(two_layers_consolidate) {
  static const double k[] = {1e-4, 4e-4}, times[] = {4.6, 9.1};
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 20, 0.0, 10.0);
  double worst = 0.0, diffusivity[2];
  for (int l = 0; l < 2; l++) {
    const mps_view x = mpm_scene_view(&c.s, "position");
    diffusivity[l] = k[l] * c.modulus / (1000.0 * MPS_PORE_GRAVITY);
    if (l == 0) OK(mps_particles_add_field(c.s.particles, "permeability", 0));
    EDIT(edit, c.s.particles, "permeability")
      for (int64_t p = 0; p < x.shape[0]; p++)
        if ((*mps_view_f64(&x, p, 1) > 0.5) == (l == 1)) *mps_edit_f64(&edit, p, 0) = k[l];
  }
  USING(pore_water, mps_mpm_add_pore_water(c.s.mpm, &given), .scheme = MPS_PORE_SCHEME_IMPLICIT,
        .porosity = 0.4, .bulk = 0.4 * 100.0 * c.modulus);
  DEF(pore_face, surface, .kind = MPS_PORE_FACE_DRAINED, .sides = 1u << MPS_SIDE_Y_UPPER);
  surface.pressure = -LOAD; /* pressures less the load */
  OK(mps_mpm_add_pore_face(c.s.mpm, &surface, NULL));
  for (int t = 0; t < 2; t++) {
    OK(mps_mpm_run(c.s.mpm, times[t], 1000000, NULL, NULL));
    const mps_view x = mpm_scene_view(&c.s, "position"), u = mpm_scene_view(&c.s, "pore_pressure");
    for (int64_t p = 0; p < x.shape[0]; p++) {
      const double exact = two_layers(diffusivity, *mps_view_f64(&x, p, 1), times[t]);
      worst = fmax(worst, fabs(*mps_view_f64(&u, p, 0) / LOAD + 1.0 - exact));
    }
  }
  print_message("two layers: u/q within %.2f %%\n", 100.0 * worst);
  assert_true(worst < 0.01);
  mpm_scene_end(&c.s);
}

/* ---- undrained ------------------------------------------------------------------------------- */

/* A load on undrained ground between rollers: p = q/(1 + n M'/K_w). */
static void undrained(int32_t scheme) {
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 10.0, 0.0, 200.0);
  DEF(pore_water, water, .scheme = scheme, .porosity = 0.4, .bulk = 0.4 * 4.0 * c.modulus);
  OK(mps_mpm_add_pore_water(c.s.mpm, &water));
  add_load(&c, LOAD);
  OK(mps_mpm_run(c.s.mpm, 0.3, 1000000, NULL, NULL));
  const mps_view x = mpm_scene_view(&c.s, "position"), u = mpm_scene_view(&c.s, "pore_pressure");
  double worst = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++)
    if (*mps_view_f64(&x, k, 1) < 0.75)
      worst = fmax(worst, fabs(*mps_view_f64(&u, k, 0) / LOAD - 0.8));
  print_message("undrained, scheme %d: p/q within %.2f %% of 0.8\n", scheme, 100.0 * worst);
  assert_true(worst < 0.008);
  mpm_scene_end(&c.s);
}

TEST(undrained_column) {
  undrained(MPS_PORE_SCHEME_EXPLICIT);
  undrained(MPS_PORE_SCHEME_IMPLICIT);
}
