/* test_mpm_small_strain.c - the small-strain law in WLS-MPM: a column in its first shear mode
 * against Vs/(4 H) and the damping of its loops, what it dissipates in the budget of energy, its
 * ten layers in snapshots and checkpoints, factors of each particle. SPDX-License-Identifier:
 * BSD-3-Clause */
#include "mpm_scene.h"

#include "test_fixture.h"

#define HEIGHT 1.0
#define WIDTH 0.2
#define SHEAR 1e6 /* Pa; of density 1000: Vs = sqrt(1000) m/s */
#define STRAIN_R 1e-3

static mps_material *make_small(void) {
  DEF(material_small_strain, def, .shear_modulus = SHEAR, .reference_strain = STRAIN_R);
  MAKE_KEPT(material, m, create_small_strain, context, &def);
  return m;
}

/* A column whose base is held and whose nodes move sideways only, in its first mode of shear with
 * the strain `gamma` at the base, were it linear. `small`: the law; else linear elastic. */
static mpm_scene column(double gamma, bool small) {
  mpm_scene s = mpm_scene_begin(context, 0.05, 0.5, 0.0, 2.0 * SHEAR * 1.3);
  if (small) {
    mps_material_destroy(&s.material);
    s.material = make_small();
  }
  mpm_scene_box(&s, 0.5, 0.0, 0.5 + WIDTH, HEIGHT);
  const double k = PI / (2.0 * HEIGHT), speed = gamma * sqrt(SHEAR / 1000.0);
  OK(mps_particles_add_field(s.particles, "velocity", 0));
  OK(mps_particles_add_field(s.particles, "velocity_gradient", 0));
  mps_edit v = mpm_scene_edit(&s, "velocity"), L = mpm_scene_edit(&s, "velocity_gradient");
  mps_view x = mpm_scene_view(&s, "position");
  for (int64_t i = 0; i < x.shape[0]; i++) {
    const double y = *mps_view_f64(&x, i, 1);
    *mps_edit_f64(&v, i, 0) = speed * sin(k * y);
    *mps_edit_f64(&L, i, 1) = speed * k * cos(k * y);
  }
  mpm_scene_commit(&s, &v);
  mpm_scene_commit(&s, &L);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.1, .lower[1] = 0.0, .budget = 1, .dt = 2e-4);
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  const double lower[2] = {-1.0, -1.0}, upper[2] = {3.0, 3.0};
  mps_mpm_boundary_def still = mpm_scene_box_def(s.mpm, lower, upper, 1, NULL, 1.0);
  int32_t number;
  OK(mps_mpm_add_boundary(s.mpm, &still, &number));
  return s;
}

/* Mean sideways displacement of the uppermost particles. */
static double top_of(mpm_scene *s) {
  mps_view x = mpm_scene_view(s, "position");
  double sum = 0.0;
  int64_t n = 0;
  for (int64_t i = 0; i < x.shape[0]; i++)
    if (*mps_view_f64(&x, i, 1) > HEIGHT - 0.04) sum += *mps_view_f64(&x, i, 0), n++;
  return sum / (double)n - (0.5 + 0.5 * WIDTH);
}

/* Time of the return through the middle, half a period; *swing: the largest displacement so far. */
static double half_period(mpm_scene *s, double *swing) {
  double before = 0.0;
  *swing = 0.0;
  for (int k = 1; k < 2000; k++) {
    OK(mps_mpm_step(s->mpm, 1));
    const double now = top_of(s);
    *swing = fmax(*swing, now);
    if (now < 0.0 && before > 0.0) return 2e-4 * (k - now / (now - before));
    before = now;
  }
  return NAN;
}

/* In strains that no layer resists the column is elastic; in larger ones it is softer. */
TEST(columns_swing_slower_the_wider) {
  const double exact = 2.0 * HEIGHT / sqrt(SHEAR / 1000.0);
  double swing, last = 0.0;
  mpm_scene elastic = column(1e-6, false);
  const double plain = half_period(&elastic, &swing);
  mpm_scene_end(&elastic);
  for (int k = 0; k < 3; k++) {
    const double gamma = STRAIN_R * (k == 0 ? 1e-3 : k == 1 ? 0.1 : 0.3);
    scoped_mpm_scene s = column(gamma, true);
    const double t = half_period(&s, &swing);
    print_message("gamma/gamma_r %g: half a period %.5f s, 2 H/Vs %.5f s, swing %.4g of elastic\n",
                  gamma / STRAIN_R, t, exact, swing / (gamma * 2.0 * HEIGHT / PI));
    if (k == 0) NEAR(t / plain, 1.0, 1e-6);
    if (k == 0) NEAR(t / exact, 1.0, 0.01);
    assert_true(t > last * 1.02);
    last = t;
  }
}

/* What the laws dissipate in the budget is the field times the volumes, which shear keeps. */
TEST(the_budget_knows_the_loops) {
  scoped_mpm_scene s = column(2.0 * STRAIN_R, true);
  mps_totals before, t;
  mps_mpm_energy_report l;
  OK(mps_mpm_get_totals(s.mpm, &before));
  OK(mps_mpm_step(s.mpm, 1500));
  OK(mps_mpm_get_totals(s.mpm, &t));
  OK(mps_mpm_get_energy_report(s.mpm, &l));
  mps_view lost = mpm_scene_view(&s, "small_strain.dissipated"), V = mpm_scene_view(&s, "volume");
  double sum = 0.0;
  for (int64_t i = 0; i < lost.shape[0]; i++)
    sum += *mps_view_f64(&lost, i, 0) * *mps_view_f64(&V, i, 0);
  print_message("kinetic %.4g to %.4g J, strain %.4g, laws %.4g J, by the field %.4g J\n",
                before.kinetic, t.kinetic, t.strain, l.laws, sum);
  assert_true(l.laws > 0.3 * before.kinetic && t.strain >= 0.0);
  NEAR(l.laws / sum, 1.0, 1e-3);
  assert_true(fabs(l.residual) < 1e-11 * before.kinetic);
}

/* The deviators of the layers belong to the state. */
TEST(snapshots_and_files_continue_bit_for_bit) {
  scoped_mpm_scene s = column(2.0 * STRAIN_R, true), other = column(1e-6, true);
  scoped_snapshot *snapshot = NULL;
  static const char path[] = TEST_TMP "/small_strain.h5";
  OK(mps_mpm_step(s.mpm, 150));
  OK(mps_mpm_snapshot(s.mpm, &snapshot));
  if (mps_library_has(MPS_FEATURE_HDF5)) OK(mps_mpm_save(s.mpm, path, NULL));
  OK(mps_mpm_step(s.mpm, 200));
  const double once = top_of(&s);
  OK(mps_mpm_rollback(s.mpm, snapshot));
  OK(mps_mpm_step(s.mpm, 200));
  NEAR(top_of(&s), once, 0.0);
  if (mps_library_has(MPS_FEATURE_HDF5)) {
    mps_checkpoint info = mps_checkpoint_defaults();
    OK(mps_mpm_restore(other.mpm, path, &info));
    OK(mps_mpm_step(other.mpm, 200));
    NEAR(top_of(&other), once, 0.0);
  }
  (void)remove(path);
}

/* Twice the stiffness and three times the strength: the backbone of these constants. */
TEST(factors_scale_every_layer) {
  scoped_material *law = make_small(), *varying = NULL, *plain = NULL;
  DEF(material_small_strain, def, .shear_modulus = 2.0 * SHEAR, .reference_strain = 1.5 * STRAIN_R);
  OK(mps_material_create_by_field(context, law, &varying));
  OK(mps_material_create_small_strain(context, &def, &plain));
  mps_material_point x, y;
  OK(mps_material_point_init(context, varying, &x));
  OK(mps_material_point_init(context, plain, &y));
  x.history[52] = 2.0, x.history[53] = 3.0;
  const double shear[9] = {0, 4e-3, 0, 0, 0, 0, 0, 0, 0};
  OK(mps_material_point_drive(context, varying, &x, shear, 1.0, 50));
  OK(mps_material_point_drive(context, plain, &y, shear, 1.0, 50));
  NEAR(x.stress[3] / y.stress[3], 1.0, 1e-12);
}
