/* test_material_small_strain.c - the small-strain law at a point: its layers' sum against the
 * backbone of Hardin and Drnevich and Darendeli, loops against Masing's closed form of the damping,
 * and against a one-dimensional stack of springs and sliders with the rules of Masing; energy;
 * strength. SPDX-License-Identifier: BSD-3-Clause */
#include "material/material_internal.h"
#include "material_paths.h"

#define G0 50e6
#define STRAIN_R 1e-3
#define WITHIN 0.012 /* of the backbone */

enum { PLASTIC, DISSIPATED, FIRST };

static mps_material *make_small(double curvature, double strength) {
  DEF(material_small_strain, def, .shear_modulus = G0, .poisson = 0.25,
      .reference_strain = STRAIN_R, .curvature = curvature, .strength = strength);
  MAKE_KEPT(material, m, create_small_strain, context, &def);
  return m;
}

/* gamma by `change` in `steps` steps, symmetric: no spin. */
static void shear(const mps_material *m, mps_material_point *x, double change, int64_t steps) {
  const double half[9] = {0, 0.5 * change, 0, 0.5 * change, 0, 0, 0, 0, 0};
  OK(mps_material_point_drive(context, m, x, half, 1.0, steps));
}

static mps_material_point fresh(const mps_material *m) { return point_under(m, 0.0); }

/* ---- backbone -------------------------------------------------------------------------------- */

TEST(first_loading_follows_the_backbone) {
  static const double curvature[3] = {1.0, 0.92, 0.7}, share[3] = {1.0, 1.2, 2.0};
  for (int c = 0; c < 3; c++) {
    const double a = curvature[c], limit = share[c] * G0 * STRAIN_R;
    scoped_material *m = make_small(a, c == 0 ? NAN : limit);
    mps_material_point x = fresh(m);
    double gamma = 0.0, worst = 0.0;
    for (double next = 1e-4 * STRAIN_R; next < 2e3 * STRAIN_R; next *= 1.03) {
      shear(m, &x, next - gamma, 1);
      gamma = next;
      const double curve = G0 * gamma / (1.0 + pow(gamma / STRAIN_R, a));
      const double tau = x.stress[3];
      /* at the strength, and a layer's width before it, the curve is cut */
      if (curve < 0.97 * limit) worst = fmax(worst, fabs(tau / curve - 1.0));
      if (curve > 1.03 * limit) NEAR(tau / limit, 1.0, 1e-12);
      if (gamma < 0.001 * STRAIN_R) NEAR(tau / (G0 * gamma), 1.0, 1e-12);
      assert_true(tau <= limit * (1.0 + 1e-12));
      assert_int_equal((x.flags & MPS_MATERIAL_FLAG_PLASTIC) != 0, tau >= limit * (1.0 - 1e-9));
    }
    print_message("curvature %g: backbone within %.2f %%\n", a, 100.0 * worst);
    assert_true(worst <= WITHIN);
    assert_true(worst > 1e-4); /* the curve is not the law's own */
  }
}

/* Triaxial, plane strain and simple shear share the curve in sqrt(J2), and K is constant. */
TEST(all_directions_have_one_backbone) {
  scoped_material *m = make_small(1.0, NAN);
  static const double direction[3][9] = {
      {0, 0.5, 0, 0.5, 0, 0, 0, 0, 0},
      {0.5, 0, 0, 0, -0.5, 0, 0, 0, 0},
      {-0.288675134594812882, 0, 0, 0, -0.288675134594812882, 0, 0, 0, 0.577350269189625765}};
  for (int k = 0; k < 3; k++) {
    double gradient[9];
    for (int c = 0; c < 9; c++) gradient[c] = direction[k][c] * 3.0 * STRAIN_R;
    for (int c = 0; c < 9; c += 4) gradient[c] -= 1e-3;
    mps_material_point x = point_under(m, -100e3);
    OK(mps_material_point_drive(context, m, &x, gradient, 1.0, 50));
    NEAR(root_j2(x.stress) / (G0 * 3.0 * STRAIN_R / 4.0), 1.0, WITHIN);
    NEAR(mean_stress(x.stress) / (-100e3 - 3e-3 * G0 * 5.0 / 3.0), 1.0, 1e-12);
  }
}

/* ---- loops ----------------------------------------------------------------------------------- */

/* Masing's loop of the hyperbola: the damping ratio at the amplitude x = gamma/gamma_r. */
static double masing_damping(double x) {
  return 4.0 / PI * (1.0 + 1.0 / x) * (1.0 - log1p(x) / x) - 2.0 / PI;
}

TEST(loops_have_the_closed_form_of_damping) {
  scoped_material *m = make_small(1.0, NAN);
  static const double amplitude[7] = {0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0};
  for (int k = 0; k < 7; k++) {
    const double a = amplitude[k] * STRAIN_R;
    enum { STEPS = 4000 };
    mps_material_point x = fresh(m);
    shear(m, &x, a, STEPS);
    const double top = x.stress[3], first = x.history[DISSIPATED];
    double area = 0.0;
    for (int k2 = 0; k2 < 2 * STEPS; k2++) {
      const double change = (k2 < STEPS ? -2.0 : 2.0) * a / STEPS, before = x.stress[3];
      shear(m, &x, change, 1);
      area += 0.5 * (before + x.stress[3]) * change;
    }
    const double damping = area / (2.0 * PI * top * a), expected = masing_damping(amplitude[k]);
    print_message("gamma/gamma_r %g: G/G0 %.4f (%.4f), damping %.4f (%.4f)\n", amplitude[k],
                  top / (G0 * a), 1.0 / (1.0 + amplitude[k]), damping, expected);
    NEAR(x.stress[3] / top, 1.0, 1e-9); /* the loop closes */
    NEAR(top / (G0 * a) * (1.0 + amplitude[k]), 1.0, WITHIN);
    NEAR(damping, expected, amplitude[k] <= 30.0 ? 0.009 : 0.015);
    NEAR((x.history[DISSIPATED] - first) / area, 1.0, 2e-3);
  }
}

/* A small loop inside a large one closes and is forgotten; beyond the largest former strain the
 * backbone continues (Masing's extended rules). */
TEST(inner_loops_close) {
  scoped_material *m = make_small(1.0, NAN);
  mps_material_point plain = fresh(m), looped = fresh(m);
  shear(m, &plain, 5e-3, 500);
  shear(m, &looped, 2e-3, 200);
  for (int k = 0; k < 3; k++) {
    shear(m, &looped, -3e-3, 300); /* below zero, and within it a smaller one */
    shear(m, &looped, 1e-3, 100);
    shear(m, &looped, -1e-3, 100);
    shear(m, &looped, 3e-3, 300);
  }
  const double after_loops = looped.stress[3];
  mps_material_point once = fresh(m);
  shear(m, &once, 2e-3, 200);
  NEAR(after_loops / once.stress[3], 1.0, 1e-12);
  shear(m, &looped, 3e-3, 300);
  NEAR(looped.stress[3] / plain.stress[3], 1.0, 1e-12);
  assert_true(looped.history[DISSIPATED] > 1.5 * plain.history[DISSIPATED]);
}

/* Unloading: the backbone, twice as large, from the point of return. */
TEST(unloading_is_the_backbone_doubled) {
  scoped_material *m = make_small(0.92, 1.2 * G0 * STRAIN_R);
  mps_material_point x = fresh(m), virgin = fresh(m);
  shear(m, &x, 4e-3, 400);
  const double top = x.stress[3];
  for (int k = 0; k < 8; k++) {
    shear(m, &x, -1e-3, 100);
    shear(m, &virgin, 0.5e-3, 100);
    NEAR((top - x.stress[3]) / (2.0 * virgin.stress[3]), 1.0, 1e-12);
  }
}

/* ---- energy, rotation, first stress ---------------------------------------------------------- */

/* Random strains: work that is not dissipated can be recovered; nothing is gained. */
TEST(no_path_gains_energy) {
  scoped_material *m = make_small(1.0, NAN);
  mps_material_point x = fresh(m);
  uint64_t seed = 7;
  double work = 0.0, spent = 0.0;
  for (int k = 0; k < 20000; k++) {
    double L[9], before[6];
    memcpy(before, x.stress, sizeof before);
    const double last = x.history[DISSIPATED];
    for (int c = 0; c < 9; c++) L[c] = 2e-5 * noise(&seed);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < i; j++) L[3 * i + j] = L[3 * j + i];
    OK(mps_material_point_drive(context, m, &x, L, 1.0, 1));
    static const int row[6] = {0, 4, 8, 1, 2, 5};
    for (int c = 0; c < 6; c++)
      work += (c < 3 ? 1.0 : 2.0) * 0.5 * (before[c] + x.stress[c]) * L[row[c]];
    assert_true(x.history[DISSIPATED] >= last);
  }
  spent = x.history[DISSIPATED];
  const double p = mean_stress(x.stress), stored = 0.5 * p * p / (G0 * 5.0 / 3.0);
  double deviators = 0.0; /* of the layers; their moduli: the stress of each over its strength */
  mps_material_point tiny = fresh(m), large = fresh(m);
  shear(m, &tiny, 1e-7, 1);
  shear(m, &large, 1.0, 1);
  for (int i = 0; i < 10; i++) {
    const double *s = &x.history[FIRST + 5 * i], zz = s[0] + s[1];
    const double square =
        s[0] * s[0] + s[1] * s[1] + zz * zz + 2.0 * (s[2] * s[2] + s[3] * s[3] + s[4] * s[4]);
    const double modulus = tiny.history[FIRST + 5 * i + 2] / 1e-7;
    deviators += square / (4.0 * modulus);
    assert_true(sqrt(0.5 * square) <= large.history[FIRST + 5 * i + 2] * (1.0 + 1e-12));
  }
  print_message("work %.6g, dissipated %.6g, stored %.6g J/m3\n", work, spent, stored + deviators);
  NEAR(work / (spent + stored + deviators), 1.0, 1e-9);
  assert_true(spent > 0.5 * work);
}

/* Stress and layers turn with the particle: after a quarter turn the same strain, turned, gives the
 * turned stress. A first deviator stays as it is. */
TEST(layers_turn_with_the_particle) {
  scoped_material *m = make_small(1.0, NAN);
  mps_material_point x = fresh(m), y = fresh(m);
  x.stress[0] = y.stress[0] = -20e3, x.stress[1] = y.stress[1] = -40e3;
  shear(m, &x, 2e-3, 100), shear(m, &y, 2e-3, 100);
  enum { TURNS = 20000 };
  const double w = 2.0 * tan(PI / 4.0 / TURNS);
  const double spin[9] = {0, -w, 0, w, 0, 0, 0, 0, 0};
  OK(mps_material_point_drive(context, m, &y, spin, TURNS, TURNS));
  NEAR(y.stress[3] / -x.stress[3], 1.0, 1e-9);
  NEAR(y.stress[0], x.stress[1], 1e-3);
  shear(m, &x, -0.7e-3, 100), shear(m, &y, 0.7e-3, 100);
  NEAR(y.stress[3] / -x.stress[3], 1.0, 1e-9);
  NEAR(y.history[FIRST + 2] / -x.history[FIRST + 2], 1.0, 1e-9);
  NEAR(x.stress[1] - x.stress[0], -20e3, 1e-6);
}

/* ---- definition ------------------------------------------------------------------------------ */

TEST(bad_constants_are_refused) {
#define SMALL(member, value, text)                                                                 \
  do {                                                                                             \
    mps_material_small_strain_def def = mps_material_small_strain_defaults();                      \
    mps_material *m = NULL;                                                                        \
    def.shear_modulus = G0, def.reference_strain = STRAIN_R;                                       \
    def.member = value;                                                                            \
    REFUSES(mps_material_create_small_strain(context, &def, &m), text);                            \
    assert_null(m);                                                                                \
  } while (0)
  SMALL(strength, 50001.0, "strength is 50001 Pa");
  SMALL(struct_size, 3, "struct_size is 3");
  scoped_material *m = make_small(1.0, NAN);
  assert_string_equal(mps_material_name(m), "small_strain");
  assert_int_equal(mps_material_history_count(m), 52);
  assert_string_equal(mpsi_material_history_field(m, 0), "plastic_strain");
  assert_string_equal(mps_material_history_name(m, 1), "dissipated");
  assert_string_equal(mpsi_material_history_field(m, 1), "small_strain.dissipated");
  assert_string_equal(mpsi_material_history_field(m, 51), "small_strain.layer_10_yz");
  NEAR(mps_material_wave_modulus(m) / (G0 * 3.0), 1.0, 1e-12);
}
