/* test_material_dilation_end.c - sand whose dilation ends at a void ratio: drained triaxial and
 * plane strain tests of three densities end there whatever their steps; along no path is the void
 * ratio above it; a solver keeps the bits of it, and warns of sand that dilates without end.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/random.h"
#include "mpm_scene.h"
#include "test_fixture.h"

#define E_MAX 0.85
#define P0 1e5 /* Pa */
#define YOUNG 4e7
#define POISSON 0.25
#define BULK (YOUNG / (3.0 * (1.0 - 2.0 * POISSON)))
#define PHI 0.65
#define PSI 0.2

enum { CONE, PYRAMID, SOFTENING, TENSION, CYCLIC, SANDS };

static mps_material *make_sand(int kind, double e, double e_max, double psi, double cohesion) {
  DEF(material_drucker_prager, cone, .cone = MPS_MATERIAL_CONE_CIRCUMSCRIBED);
  mps_material_mohr_coulomb_def coulomb = mps_material_mohr_coulomb_defaults();
  mps_material_cyclic_sand_def cyclic = mps_material_cyclic_sand_defaults();
  mps_material *m = NULL;
  cone.young = coulomb.young = cyclic.young = YOUNG;
  cone.poisson = coulomb.poisson = cyclic.poisson = POISSON;
  cone.friction = coulomb.friction = cyclic.friction = PHI;
  cone.dilation = coulomb.dilation = cyclic.dilation = psi;
  cone.cohesion = coulomb.cohesion = cyclic.cohesion = cohesion;
  cone.void_ratio = coulomb.void_ratio = cyclic.void_ratio = e;
  cone.max_void_ratio = coulomb.max_void_ratio = cyclic.max_void_ratio = e_max;
  cyclic.relative_density = 0.6;
  if (kind == SOFTENING) coulomb.residual_friction = 0.55, coulomb.slip = 0.1, coulomb.band = 0.1;
  if (kind == TENSION) coulomb.tension = 0.3 * cohesion;
  OK(kind == CONE     ? mps_material_create_drucker_prager(context, &cone, &m)
     : kind == CYCLIC ? mps_material_create_cyclic_sand(context, &cyclic, &m)
                      : mps_material_create_mohr_coulomb(context, &coulomb, &m));
  return m;
}

static mps_material_point start(mps_material *m, double p) {
  mps_material_point x;
  OK(mps_material_point_init(context, m, &x));
  for (int c = 0; c < 3; c++) x.stress[c] = -p;
  return x;
}

static double mean(const mps_material_point *x) {
  return (x->stress[0] + x->stress[1] + x->stress[2]) / 3.0;
}

/* The void ratio of the unloaded sand. */
static double loose(const mps_material_point *x, double e) {
  return (1.0 + e) * x->volume_ratio * exp(-mean(x) / BULK) - 1.0;
}

/* ---- drained tests --------------------------------------------------------------------------- */

/* Compression along z at constant stress along x (and y, or without strain along y). */
static mps_material_point compress(mps_material *m, bool plane, double strain, int64_t steps) {
  mps_material_point x = start(m, P0);
  const double rate[9] = {[8] = -strain}, target[6] = {-P0, -P0};
  const uint32_t held = MPS_MATERIAL_POINT_XX | (plane ? 0 : MPS_MATERIAL_POINT_YY);
  OK(mps_material_point_control(context, m, &x, rate, (int32_t)held, target, 1.0, steps, NULL));
  return x;
}

/* From the end on the sand shears at constant volume: e = e_max less the elastic compression. */
TEST(drained_tests_end_at_e_max) {
  static const double e0[] = {0.55, 0.65, 0.75};
  for (int q = 0; q < 12; q++) {
    const double e = e0[q % 3];
    const int kind = q / 3 % 2 ? PYRAMID : CONE;
    const bool plane = q / 6 == 1;
    scoped_material *m = make_sand(kind, e, E_MAX, PSI, 0.0);
    scoped_material *endless = make_sand(kind, NAN, NAN, PSI, 0.0);
    const mps_material_point coarse = compress(m, plane, 1.2, 120);
    const mps_material_point fine = compress(m, plane, 1.2, 3000);
    const mps_material_point free_flow = compress(endless, plane, 1.2, 120);
    const double last = (1.0 + E_MAX) * exp(mean(&fine) / BULK) - 1.0;
    const double now = (1.0 + e) * fine.volume_ratio - 1.0;
    print_message("%s, %s, e from %g: %.9f at p = %.0f kPa (%.9f), unloaded %.12f; without an end "
                  "%.3f; q %.1f kPa (%.1f)\n",
                  kind == CONE ? "cone" : "pyramid", plane ? "plane strain" : "triaxial", e, now,
                  -1e-3 * mean(&fine), last, loose(&fine, e),
                  (1.0 + e) * free_flow.volume_ratio - 1.0,
                  1e-3 * (fine.stress[0] - fine.stress[2]),
                  1e-3 * (free_flow.stress[0] - free_flow.stress[2]));
    NEAR(loose(&fine, e), E_MAX, 1e-9);
    NEAR(loose(&coarse, e), E_MAX, 1e-9);
    NEAR(now, last, 1e-9);
    assert_true((1.0 + e) * free_flow.volume_ratio - 1.0 > E_MAX + 0.02);
    if (!plane) { /* the strength does not depend on the flow */
      const double ratio = (1.0 + sin(PHI)) / (1.0 - sin(PHI));
      NEAR(fine.stress[2], -ratio * P0, 1e-6 * ratio * P0);
    }
  }
}

/* Before its end the flow is that of psi: in triaxial compression of the pyramid the plastic
 * strains have dv/de1 = -2 sin(psi)/(1 - sin(psi)). */
TEST(dilation_is_that_of_psi_before) {
  scoped_material *m = make_sand(PYRAMID, 0.55, E_MAX, PSI, 0.0);
  const mps_material_point a = compress(m, false, 0.05, 500), b = compress(m, false, 0.10, 1000);
  const double slope = log(b.volume_ratio / a.volume_ratio) / 0.05;
  const double exact = 2.0 * sin(PSI) / (1.0 - sin(PSI));
  print_message("dv/de1 %.6f, exact %.6f\n", slope, exact);
  NEAR(slope, exact, 1e-6);
}

/* ---- any path -------------------------------------------------------------------------------- */

TEST(no_path_goes_beyond) {
  uint64_t seed = 7;
  for (int q = 0; q < 10 * SANDS; q++) {
    const double e = 0.5 + 0.3 * random_part(&seed);
    scoped_material *m = make_sand(q % SANDS, e, E_MAX, PSI + 0.4 * random_part(&seed),
                                   q / SANDS % 2 || q % SANDS == TENSION ? 5e3 : 0.0);
    mps_material_point x = start(m, P0);
    double most = 0.0, most_pressed = 0.0;
    for (int step = 0; step < 3000; step++) {
      double L[9];
      for (int c = 0; c < 9; c++) L[c] = 0.05 * (random_part(&seed) - 0.5);
      for (int c = 0; c < 9; c += 4) L[c] -= 0.002; /* pressed together on the whole */
      OK(mps_material_point_drive(context, m, &x, L, 1.0, 1 + step % 3));
      most = fmax(most, loose(&x, e));
      if (mean(&x) <= 0.0) most_pressed = fmax(most_pressed, (1.0 + e) * x.volume_ratio - 1.0);
    }
    if (q < 2 * SANDS)
      print_message("law %d from e = %.3f: e at most %.12f, unloaded %.12f\n", q % SANDS, e,
                    most_pressed, most);
    assert_true(most <= E_MAX + 1e-10);
    assert_true(most_pressed <= E_MAX + 1e-10);
  }
}

/* ---- in a solver ----------------------------------------------------------------------------- */

static int warnings;

static void count_warnings(void *user, int32_t level, const char *message) {
  if (level != MPS_CONTEXT_LOG_WARNING || !strstr(message, "of its first volume")) return;
  print_message("%s\n", message);
  warnings++;
}

/* A block of cohesive sand whose halves fly against one another, so that it is sheared to twice its
 * height. */
static mpm_scene crushed(mps_context *on, double e, double e_max) {
  mpm_scene s = mpm_scene_begin(on, 0.05, 0.0, 0.0, YOUNG);
  mpm_scene_box(&s, 0.0, 0.0, 1.0, 1.0);
  OK(mps_particles_set(s.particles, "density", 0, 2000.0));
  DEF(material_mohr_coulomb, def, .young = YOUNG, .poisson = POISSON, .friction = PHI,
      .dilation = PHI, .cohesion = 1e4, .void_ratio = e, .max_void_ratio = e_max);
  MAKE(material, sand, create_mohr_coulomb, on, &def);
  DEF(mpm, solver, .cell = 0.1, .lower[0] = solver.lower[1] = 0.0);
  OK(mps_mpm_create(on, s.particles, sand, &solver, &s.mpm));
  mpm_scene_side(&s, MPS_SIDE_X_LOWER, MPS_BOUNDARY_ROLLER, 0.0);
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_ROLLER, 0.0);
  const mps_view x = mpm_scene_view(&s, "position");
  EDIT(v, s.particles, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++)
      *mps_edit_f64(&v, k, 0) = -60.0 * *mps_view_f64(&x, k, 0);
  return s;
}

static double largest_ratio(mpm_scene *s) {
  const mps_view V = mpm_scene_view(s, "volume");
  double most = 0.0;
  for (int64_t k = 0; k < V.shape[0]; k++)
    most = fmax(most, *mps_view_f64(&V, k, 0) / (0.05 * 0.05));
  return most;
}

TEST(a_solver_warns_of_endless_dilation_once) {
  mps_context_def def = test_context_defaults();
  def.log = count_warnings;
  scoped_context *on = NULL;
  assert_int_equal(mps_context_create(&def, &on, NULL, 0), MPS_OK);
  for (int ends = 0; ends < 2; ends++) {
    scoped_mpm_scene s = crushed(on, ends ? 0.5 : NAN, ends ? 0.9 : NAN);
    warnings = 0;
    OK(mps_mpm_run(s.mpm, 0.03, 1000000, NULL, NULL));
    const double most = largest_ratio(&s), bound = 1.9 / 1.5;
    print_message("V/V0 up to %.9f, %d warnings (dilation to %.9f)\n", most, warnings,
                  ends ? bound : INFINITY);
    if (ends) {
      const double apex = 1e4 / tan(PHI); /* largest tension, and its elastic strain */
      assert_true(most > 0.98 * bound && most <= bound * exp(apex / BULK) * (1.0 + 1e-9));
      assert_int_equal(warnings, 0);
    } else {
      assert_true(most > 1.4);
      assert_int_equal(warnings, 1);
    }
  }
}

TEST(goes_back_bit_for_bit) {
  scoped_mpm_scene a = crushed(context, 0.5, 0.9), b = crushed(context, 0.5, 0.9);
  scoped_snapshot *snapshot = NULL;
  OK(mps_mpm_step(a.mpm, 60));
  OK(mps_mpm_snapshot(a.mpm, &snapshot));
  OK(mps_mpm_step(a.mpm, 35));
  OK(mps_mpm_rollback(a.mpm, snapshot));
  OK(mps_mpm_step(a.mpm, 60));
  OK(mps_mpm_step(b.mpm, 120));
  static const char *const names[] = {"volume", "volume_ratio", "position", "stress"};
  for (int f = 0; f < 4; f++) {
    const mps_view va = mpm_scene_view(&a, names[f]), vb = mpm_scene_view(&b, names[f]);
    const mps_view id = mpm_scene_view(&a, "id");
    for (int64_t k = 0; k < va.shape[0]; k++) {
      const int64_t m = mps_particles_index(b.particles, *mps_view_i64(&id, k, 0));
      for (int c = 0; c < va.shape[1]; c++)
        assert_true(*mps_view_f64(&va, k, c) == *mps_view_f64(&vb, m, c));
    }
  }
}
