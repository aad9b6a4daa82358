/* test_mpm_materials.c - several materials in one WLS-MPM solver: a column of two layers, a wave
 * that a joint of two materials reflects, and bodies of different laws that move as each alone.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#include "mpm/base/mpm_solver.h"
#include "mpm/contact/particle.h"

/* Gives `material` and its density to the particles above y. */
static void lay(mpm_scene *s, mps_material *material, double y) {
  const double lo[] = {-1e3, y}, hi[] = {1e3, 1e3};
  int64_t ids[4096], count = 0;
  OK(mps_particles_select_box(s->particles, lo, hi, 4096, &count, ids));
  assert_in_range(count, 1, 4096);
  OK(mps_mpm_set_material(s->mpm, material, ids, count));
}

static void set_density(mpm_scene *s, double below, double above, double y) {
  OK(mps_particles_set(s->particles, "density", 0, below));
  mps_view x = mpm_scene_view(s, "position");
  EDIT(rho, s->particles, "density")
    for (int64_t k = 0; k < x.shape[0]; k++)
      if (*mps_view_f64(&x, k, 1) > y) *mps_edit_f64(&rho, k, 0) = above;
}

static double confined(double young, double poisson) { /* K + 4G/3 */
  return young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
}

static mps_material *von_mises(double young, double yield) {
  DEF(material_von_mises, def, .young = young, .yield_stress = yield);
  MAKE_KEPT(material, out, create_von_mises, context, &def);
  return out;
}

/* A column between rollers whose upper half is softer, lighter and elastoplastic: sigma_yy is the
 * weight above, and the column stays at rest. */
TEST(two_layers_at_rest) {
  const double lower = 2000.0, upper = 1200.0, g = 10.0, K0 = 0.3 / 0.7;
  scoped_mpm_scene s = mpm_scene_begin(context, 0.02, 0.0, 0.0, 4e7);
  mpm_scene_box(&s, 0.0, 0.0, 0.2, 1.0);
  set_density(&s, lower, upper, 0.52);
  OK(mps_particles_add_field(s.particles, "stress", 0));
  mps_view x = mpm_scene_view(&s, "position");
  mps_edit stress = mpm_scene_edit(&s, "stress");
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double y = *mps_view_f64(&x, k, 1);
    const double yy = -g * (upper * (1.0 - fmax(y, 0.52)) + lower * fmax(0.52 - y, 0.0));
    *mps_edit_f64(&stress, k, 0) = *mps_edit_f64(&stress, k, 2) = K0 * yy;
    *mps_edit_f64(&stress, k, 1) = yy;
  }
  mpm_scene_commit(&s, &stress);
  DEF(mpm, def, .cell = 0.04, .lower[0] = def.lower[1] = 0.0, .upper[0] = 0.2, .gravity[1] = -g);
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  scoped_material *soft = von_mises(1e7, 1e6);
  lay(&s, soft, 0.52);
  NEAR(mps_mpm_limit(s.mpm), 0.04 / sqrt(confined(4e7, 0.3) / lower), 1e-12);
  OK(mps_mpm_run(s.mpm, 0.2, 1000000, NULL, NULL));
  x = mpm_scene_view(&s, "position"), stress.view = mpm_scene_view(&s, "stress");
  double worst = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double y = *mps_view_f64(&x, k, 1);
    if (y < 0.15 || y > 0.85 || fabs(y - 0.52) < 0.08) continue; /* ends and the joint's cells */
    const double yy = -g * (upper * (1.0 - fmax(y, 0.52)) + lower * fmax(0.52 - y, 0.0));
    worst = fmax(worst, fabs(*mps_view_f64(&stress.view, k, 1) / yy - 1.0));
  }
  print_message("two layers: stress within %.2g\n", worst);
  assert_true(worst < 0.02);
}

/* A pulse that travels up in the lower part (0 to 1 m) of a bar and arrives at the joint. Momentum
 * of the lower part afterwards is R of the pulse's, R = (Z1 - Z2)/(Z1 + Z2), Z = rho c; the pulse
 * in the upper part is where its own wave speed puts it. */
TEST(joint_reflects) {
  const double rho1 = 1000.0, rho2 = 2500.0, E1 = 1e6, E2 = 5e6, width = 0.12, from = 0.5;
  const double c1 = sqrt(confined(E1, 0.3) / rho1), c2 = sqrt(confined(E2, 0.3) / rho2);
  scoped_mpm_scene s = mpm_scene_begin(context, 0.005, 0.0, 0.0, E1);
  mpm_scene_box(&s, 0.0, 0.0, 0.02, 2.0);
  set_density(&s, rho1, rho2, 1.0);
  OK(mps_particles_add_field(s.particles, "velocity", 0));
  OK(mps_particles_add_field(s.particles, "stress", 0));
  mps_view x = mpm_scene_view(&s, "position");
  mps_edit v = mpm_scene_edit(&s, "velocity");
  EDIT(stress, s.particles, "stress")
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const double at = (*mps_view_f64(&x, k, 1) - from) / width;
      const double pulse = fabs(at) < 1.0 ? 0.005 * (1.0 + cos(PI * at)) : 0.0;
      *mps_edit_f64(&v, k, 1) = pulse;
      *mps_edit_f64(&stress, k, 1) = -rho1 * c1 * pulse;
      *mps_edit_f64(&stress, k, 0) = *mps_edit_f64(&stress, k, 2) = -rho1 * c1 * pulse * 0.3 / 0.7;
    }
  mpm_scene_commit(&s, &v);
  DEF(mpm, def, .cell = 0.01, .lower[0] = def.lower[1] = 0.0, .upper[0] = 0.02);
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  MAKE(material, stiff, create_linear_elastic, context, E2, 0.3);
  lay(&s, stiff, 1.0);
  const double before = mpm_scene_totals(&s).linear[1], t = 0.85 / c1;
  OK(mps_mpm_run(s.mpm, t, 1000000, NULL, NULL));
  x = mpm_scene_view(&s, "position"), v.view = mpm_scene_view(&s, "velocity");
  mps_view m = mpm_scene_view(&s, "mass"), law = mpm_scene_view(&s, "material");
  double low = 0.0, high = 0.0, moment = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double p = *mps_view_f64(&m, k, 0) * *mps_view_f64(&v.view, k, 1);
    const bool upper = *mps_view_f64(&x, k, 1) > 1.0;
    assert_int_equal(*mps_view_i64(&law, k, 0), upper);
    if (upper) high += p, moment += p * *mps_view_f64(&x, k, 1);
    if (!upper) low += p;
  }
  const double R = (rho1 * c1 - rho2 * c2) / (rho1 * c1 + rho2 * c2);
  const double place = 1.0 + c2 * (t - (1.0 - from) / c1);
  print_message("R %.4f, exact %.4f; passed on at %.4f m, exact %.4f m\n", low / before, R,
                moment / high, place);
  NEAR(low / before, R, 0.01 * fabs(R));
  NEAR(moment / high, place, 0.005);
}

enum { ELASTIC = 1, RUBBER = 2 };

/* Two lumps far from each other, of these laws (bits); the lumps themselves with both. */
static mpm_scene lumps(int laws, mps_material *rubber) {
  const double v0[] = {0.4, -0.3}, L[] = {3.0, -6.0, 5.0, -2.0};
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  if (laws & ELASTIC) mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.1);
  if (laws & RUBBER) mpm_scene_box(&s, 0.0, 1.0, 0.2, 1.1);
  mpm_scene_affine(&s, v0, L);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .dt = 2e-4);
  if (laws & RUBBER) lay(&s, rubber, 0.5);
  OK(mps_mpm_step(s.mpm, 300));
  return s;
}

TEST(each_as_alone) {
  MAKE(material, rubber, create_neo_hookean, context, 2e5, 0.4);
  mpm_scene both = lumps(ELASTIC | RUBBER, rubber);
  mpm_scene alone[2] = {lumps(ELASTIC, rubber), lumps(RUBBER, rubber)};
  const int64_t half = mps_particles_count(alone[0].particles);
  double moved = 0.0, pressed = 0.0;
  for (int which = 0; which < 2; which++) {
    mps_view x = mpm_scene_view(&both, "position"), s = mpm_scene_view(&both, "stress");
    mps_view V = mpm_scene_view(&both, "volume"), J = mpm_scene_view(&both, "volume_ratio");
    mps_view X = mpm_scene_view(&alone[which], "position");
    mps_view S = mpm_scene_view(&alone[which], "stress");
    for (int64_t id = 0; id < half; id++) {
      const int64_t i = mps_particles_index(both.particles, id + which * half);
      const int64_t j = mps_particles_index(alone[which].particles, id);
      for (int c = 0; c < 2; c++)
        moved = fmax(moved, fabs(*mps_view_f64(&x, i, c) - *mps_view_f64(&X, j, c)));
      for (int c = 0; c < 4; c++)
        pressed = fmax(pressed, fabs(*mps_view_f64(&s, i, c) - *mps_view_f64(&S, j, c)));
      if (which == 1) NEAR(*mps_view_f64(&V, i, 0), 1e-4 * *mps_view_f64(&J, i, 0), 1e-16);
    }
  }
  print_message("both against alone: %.2g m, %.2g Pa\n", moved, pressed);
  assert_true(moved < 1e-13);
  assert_true(pressed < 1e-7);
  mpm_scene_end(&both);
  for (int which = 0; which < 2; which++) mpm_scene_end(&alone[which]);
}

/* A body presses each particle by the modulus of its own law. */
TEST(contact_by_own_modulus) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.02, 0.01);
  DEF(mpm, def, .cell = 0.02);
  mpm_scene_solve(&s, &def);
  const int64_t second = 1;
  MAKE(material, stiff, create_linear_elastic, context, 7e5, 0.3);
  OK(mps_mpm_set_material(s.mpm, stiff, &second, 1));
  DEF(body, body, .position[1] = 0.002);
  const double up[] = {0.0, 1.0};
  MAKE(body, floor, create_half_plane, context, &body, up);
  mpm_scene_contact(&s, floor, 0.0);
  const mps_contact *contact = s.mpm->contact.handle[0];
  mpsi_contact_particle a, b;
  assert_true(mpsi_find_contact(&s.mpm->grid, &s.mpm->p, &s.mpm->def, contact, 2,
                                mps_particles_index(s.particles, 0), &a));
  assert_true(mpsi_find_contact(&s.mpm->grid, &s.mpm->p, &s.mpm->def, contact, 2,
                                mps_particles_index(s.particles, 1), &b));
  NEAR(a.force[1], 1.33 * confined(1e5, 0.3) * 0.002, 1e-9);
  NEAR(b.force[1] / a.force[1], 7.0, 1e-9);
}
