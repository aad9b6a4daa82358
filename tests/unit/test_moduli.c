/* test_moduli.c - elastic constants in all their words, the ranges that keep them finite, and the
 * fields that say what particles are made of.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

static void near_relative(double a, double b) { NEAR(a, b, 4e-14 * fabs(b)); }

/* E and nu -> everything -> velocities -> the same E and nu; the relations by themselves. */
TEST(constants_turn_into_one_another) {
  static const double poisson[] = {-0.9, -0.2, 0.0, 0.25, 0.3, 0.45, 0.49};
  static const double young[] = {1e-6, 3e4, 2.1e11, 9e17};
  for (size_t i = 0; i < sizeof poisson / sizeof *poisson; i++)
    for (size_t k = 0; k < sizeof young / sizeof *young; k++) {
      mps_moduli m, back;
      const double nu = poisson[i], E = young[k], rho = 1850.0;
      OK(mps_moduli_from_elastic(context, E, nu, rho, &m));
      assert_true(m.young == E && m.poisson == nu && m.density == rho);
      near_relative(2.0 * m.shear * (1.0 + nu), E);
      near_relative(3.0 * m.bulk * (1.0 - 2.0 * nu), E);
      NEAR(m.lambda, E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 1e-13 * (m.bulk + E));
      near_relative(m.wave, E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)));
      near_relative(rho * m.shear_velocity * m.shear_velocity, m.shear);
      near_relative(rho * m.pressure_velocity * m.pressure_velocity, m.wave);
      if (E < 1.0) continue; /* too slow for its own range */
      OK(mps_moduli_from_velocities(context, m.shear_velocity, m.pressure_velocity, rho, &back));
      NEAR(back.young, E, 1e-12 * E);
      NEAR(back.poisson, nu, 1e-12);
      assert_true(back.shear_velocity == m.shear_velocity);
      assert_true(back.pressure_velocity == m.pressure_velocity);
    }
}

/* Vp = 2 Vs is nu = 1/3, Vp = sqrt(3) Vs nu = 1/4, Vp = sqrt(2) Vs nu = 0. */
TEST(velocities_of_text_books) {
  static const double square[] = {4.0, 3.0, 2.0}, nu[] = {1.0 / 3.0, 0.25, 0.0};
  for (int k = 0; k < 3; k++) {
    mps_moduli m;
    OK(mps_moduli_from_velocities(context, 200.0, 200.0 * sqrt(square[k]), 2000.0, &m));
    NEAR(m.poisson, nu[k], 1e-15);
    near_relative(m.shear, 8e7);
    near_relative(m.young, 1.6e8 * (1.0 + nu[k]));
  }
}

TEST(what_is_out_of_range_is_refused) {
  mps_moduli m;
  mps_material *out = NULL;
  REFUSES(mps_material_create_linear_elastic(context, 1e308, 0.4999999999, &out),
          "young is 1e+308 Pa, must be 1e-06 to 1e+18");
  REFUSES(mps_material_create_linear_elastic(context, 1e6, 0.4999999999, &out),
          "poisson is 0.5, must be -0.999 to 0.49999");
  REFUSES(mps_material_create_neo_hookean(context, 1e-320, 0.3, &out), "young is");
  assert_null(out);
  REFUSES(mps_moduli_from_elastic(context, 1e6, 0.3, 0.0, &m), "density is 0");
  REFUSES(mps_moduli_from_elastic(context, 1e6, 0.3, NAN, &m), "density is nan");
  REFUSES(mps_moduli_from_elastic(context, 1e6, 0.3, 1e3, NULL), "out is NULL");
  REFUSES(mps_moduli_from_velocities(context, 1e-320, 2.0, 1e3, &m), "the shear wave velocity is");
  REFUSES(mps_moduli_from_velocities(context, 100.0, 110.0, 1e3, &m),
          "is 1.1 times the shear wave velocity");
  REFUSES(mps_moduli_from_velocities(context, 1.0, 1e4, 1e3, &m), "Poisson's ratio would be 0.5");
  REFUSES(mps_moduli_from_velocities(context, 1e8, 2e8, 1e9, &m),
          "Young's modulus by these velocities");
  assert_int_equal(mps_moduli_from_elastic(NULL, 1e6, 0.3, 1e3, &m), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_material_get_moduli(NULL, 1e3, &m), MPS_ERROR_ARGUMENT);
}

/* The ends of the ranges themselves make finite constants. */
TEST(the_ends_of_the_ranges_are_sane) {
  static const double E[] = {1e-6, 1e18}, nu[] = {-0.999, 0.49999}, rho[] = {1e-9, 1e9};
  for (int k = 0; k < 8; k++) {
    mps_moduli m;
    OK(mps_moduli_from_elastic(context, E[k & 1], nu[k >> 1 & 1], rho[k >> 2], &m));
    const double all[] = {m.shear, m.bulk, m.wave, m.shear_velocity, m.pressure_velocity};
    for (size_t c = 0; c < sizeof all / sizeof *all; c++)
      assert_true(all[c] > 1e-12 && all[c] < 1e24);
    MAKE(material, material, create_linear_elastic, context, E[k & 1], nu[k >> 1 & 1]);
    near_relative(mps_material_wave_modulus(material), m.wave);
  }
}

/* ---- materials ------------------------------------------------------------------------------- */

static mps_status nothing(void *user, const mps_material_block *block) { return MPS_OK; }

TEST(materials_tell_their_moduli) {
  mps_moduli m, want;
  scoped_material *sand = NULL, *own = NULL;
  DEF(material_mohr_coulomb, def, .young = 5e7, .poisson = 0.28, .friction = 0.6);
  OK(mps_material_create_mohr_coulomb(context, &def, &sand));
  OK(mps_material_get_moduli(sand, 1700.0, &m));
  OK(mps_moduli_from_elastic(context, 5e7, 0.28, 1700.0, &want));
  near_relative(m.young, 5e7);
  near_relative(m.poisson, 0.28);
  near_relative(m.shear_velocity, want.shear_velocity);
  near_relative(m.pressure_velocity, want.pressure_velocity);
  double first[2] = {0.0, 7.0}; /* of a program that knows one member only */
  OK(mps_material_get_moduli_sized(sand, 1700.0, (mps_moduli *)(void *)first, 8));
  assert_true(first[0] == m.young && first[1] == 7.0);
  DEF(material_user, law, .update = nothing, .wave_modulus = 1e6);
  OK(mps_material_create_user(context, &law, &own));
  FAILS(mps_material_get_moduli(own, 1e3, &m), MPS_ERROR_UNSUPPORTED, "'law' has no elastic");
  REFUSES(mps_material_get_moduli(sand, -1.0, &m), "density is -1");
}

/* ---- fields ---------------------------------------------------------------------------------- */

static double value_of(mps_particles *set, const char *name, int64_t id) {
  mps_view view = view_field(set, name);
  return *mps_view_f64(&view, mps_particles_index(set, id), 0);
}

TEST(fields_say_what_particles_are_made_of) {
  const double lo[] = {0.0, 0.0}, hi[] = {4.0, 4.0};
  scoped_material *clay = NULL, *rock = NULL, *sand = NULL;
  DEF(material_drucker_prager, cone, .young = 1e7, .friction = 0.5);
  mps_moduli soft, hard;
  scoped_particles *set = box_of(context, 1.0, lo, hi);
  OK(mps_material_create_linear_elastic(context, 2e7, 0.4, &clay));
  OK(mps_material_create_linear_elastic(context, 3e10, 0.2, &rock));
  OK(mps_material_create_drucker_prager(context, &cone, &sand));
  OK(mps_moduli_from_elastic(context, 2e7, 0.4, 1600.0, &soft));
  OK(mps_moduli_from_elastic(context, 3e10, 0.2, 2600.0, &hard));
  const int32_t fields = mps_particles_field_count(set);
  const int64_t ids[] = {15, 3}, bad[] = {15, 16};
  FAILS(mps_particles_set_material(set, sand, 1600.0, NULL, 0), MPS_ERROR_UNSUPPORTED,
        "the law is drucker_prager");
  REFUSES(mps_particles_set_material(set, NULL, 1600.0, NULL, 0), "is NULL");
  REFUSES(mps_particles_set_material(set, clay, 0.0, NULL, 0), "density is 0");
  REFUSES(mps_particles_set_material(set, clay, 1e3, bad, 2), "ids[1] is 16");
  REFUSES(mps_particles_set_material(set, clay, 1e3, NULL, 2), "count is 2");
  assert_int_equal(mps_particles_set_material(NULL, clay, 1e3, NULL, 0), MPS_ERROR_ARGUMENT);
  mps_context *other = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  MAKE_KEPT(material, foreign, create_linear_elastic, other, 2e7, 0.4);
  REFUSES(mps_particles_set_material(set, foreign, 1e3, NULL, 0), "another context");
  mps_material_destroy(&foreign);
  mps_context_destroy(&other);
  assert_int_equal(mps_particles_field_count(set), fields);
  OK(mps_particles_set_material(set, clay, 1600.0, NULL, 0));
  OK(mps_particles_set_material(set, rock, 2600.0, ids, 2));
  for (int64_t id = 0; id < 16; id++) {
    const mps_moduli *m = id == 15 || id == 3 ? &hard : &soft;
    near_relative(value_of(set, "young", id), m->young);
    near_relative(value_of(set, "poisson", id), m->poisson);
    near_relative(value_of(set, "density", id), m->density);
    near_relative(value_of(set, "shear_velocity", id), m->shear_velocity);
    near_relative(value_of(set, "pressure_velocity", id), m->pressure_velocity);
  }
}
