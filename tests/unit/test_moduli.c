/* test_moduli.c - elastic constants in all their words, the ranges that keep them finite, and the
 * fields that say what particles are made of.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include <mps/material.h>

static void near_relative(double a, double b) { mps_assert_near(a, b, 4e-14 * fabs(b)); }

/* E and nu -> everything -> velocities -> the same E and nu; the relations by themselves. */
static void constants_turn_into_one_another(void **state) {
  (void)state;
  static const double poisson[] = {-0.9, -0.2, 0.0, 0.25, 0.3, 0.45, 0.49};
  static const double young[] = {1e-6, 3e4, 2.1e11, 9e17};
  for (size_t i = 0; i < sizeof poisson / sizeof *poisson; i++)
    for (size_t k = 0; k < sizeof young / sizeof *young; k++) {
      mps_moduli m, back;
      const double nu = poisson[i], E = young[k], rho = 1850.0;
      mps_assert_ok(context, mps_moduli_from_elastic(context, E, nu, rho, &m));
      assert_true(m.young == E && m.poisson == nu && m.density == rho);
      near_relative(2.0 * m.shear * (1.0 + nu), E);
      near_relative(3.0 * m.bulk * (1.0 - 2.0 * nu), E);
      mps_assert_near(m.lambda, E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 1e-13 * (m.bulk + E));
      near_relative(m.wave, E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)));
      near_relative(rho * m.shear_velocity * m.shear_velocity, m.shear);
      near_relative(rho * m.pressure_velocity * m.pressure_velocity, m.wave);
      if (E < 1.0) continue; /* too slow for its own range */
      mps_assert_ok(context, mps_moduli_from_velocities(context, m.shear_velocity,
                                                        m.pressure_velocity, rho, &back));
      mps_assert_near(back.young, E, 1e-12 * E);
      mps_assert_near(back.poisson, nu, 1e-12);
      assert_true(back.shear_velocity == m.shear_velocity);
      assert_true(back.pressure_velocity == m.pressure_velocity);
    }
}

/* Vp = 2 Vs is nu = 1/3, Vp = sqrt(3) Vs nu = 1/4, Vp = sqrt(2) Vs nu = 0. */
static void velocities_of_text_books(void **state) {
  (void)state;
  static const double square[] = {4.0, 3.0, 2.0}, nu[] = {1.0 / 3.0, 0.25, 0.0};
  for (int k = 0; k < 3; k++) {
    mps_moduli m;
    mps_assert_ok(context,
                  mps_moduli_from_velocities(context, 200.0, 200.0 * sqrt(square[k]), 2000.0, &m));
    mps_assert_near(m.poisson, nu[k], 1e-15);
    near_relative(m.shear, 8e7);
    near_relative(m.young, 1.6e8 * (1.0 + nu[k]));
  }
}

#define FAILS(call, status, text) mps_assert_fails(context, call, status, text)

static void what_is_out_of_range_is_refused(void **state) {
  (void)state;
  mps_moduli m;
  mps_material *out = NULL;
  FAILS(mps_material_create_linear_elastic(context, 1e308, 0.4999999999, &out), MPS_ERROR_ARGUMENT,
        "Young's modulus is 1e+308 Pa, must be 1e-06 to 1e+18");
  FAILS(mps_material_create_linear_elastic(context, 1e6, 0.4999999999, &out), MPS_ERROR_ARGUMENT,
        "Poisson's ratio is 0.5, must be -0.999 to 0.49999");
  FAILS(mps_material_create_neo_hookean(context, 1e-320, 0.3, &out), MPS_ERROR_ARGUMENT,
        "Young's modulus");
  mps_material_newtonian_def water = mps_material_newtonian_defaults();
  water.bulk_modulus = 1e300;
  FAILS(mps_material_create_newtonian(context, &water, &out), MPS_ERROR_ARGUMENT,
        "bulk modulus is 1e+300");
  water.bulk_modulus = 2e9, water.viscosity = 1e200;
  FAILS(mps_material_create_newtonian(context, &water, &out), MPS_ERROR_ARGUMENT,
        "viscosity is 1e+200");
  mps_material_von_mises_def steel = mps_material_von_mises_defaults();
  steel.young = 2e11, steel.yield_stress = 1e-300;
  FAILS(mps_material_create_von_mises(context, &steel, &out), MPS_ERROR_ARGUMENT,
        "yield stress is 1e-300");
  assert_null(out);
  FAILS(mps_moduli_from_elastic(context, 1e6, 0.3, 0.0, &m), MPS_ERROR_ARGUMENT, "density is 0");
  FAILS(mps_moduli_from_elastic(context, 1e6, 0.3, NAN, &m), MPS_ERROR_ARGUMENT, "density is nan");
  FAILS(mps_moduli_from_elastic(context, 1e6, 0.3, 1e3, NULL), MPS_ERROR_ARGUMENT, "out is NULL");
  FAILS(mps_moduli_from_velocities(context, 1e-320, 2.0, 1e3, &m), MPS_ERROR_ARGUMENT,
        "the shear wave velocity is");
  FAILS(mps_moduli_from_velocities(context, 100.0, 110.0, 1e3, &m), MPS_ERROR_ARGUMENT,
        "is 1.1 times the shear wave velocity");
  FAILS(mps_moduli_from_velocities(context, 1.0, 1e4, 1e3, &m), MPS_ERROR_ARGUMENT,
        "Poisson's ratio would be 0.5");
  FAILS(mps_moduli_from_velocities(context, 1e8, 2e8, 1e9, &m), MPS_ERROR_ARGUMENT,
        "Young's modulus by these velocities");
  assert_int_equal(mps_moduli_from_elastic(NULL, 1e6, 0.3, 1e3, &m), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_material_get_moduli(NULL, 1e3, &m), MPS_ERROR_ARGUMENT);
}

/* The ends of the ranges themselves make finite constants. */
static void the_ends_of_the_ranges_are_sane(void **state) {
  (void)state;
  static const double E[] = {1e-6, 1e18}, nu[] = {-0.999, 0.49999}, rho[] = {1e-9, 1e9};
  for (int k = 0; k < 8; k++) {
    mps_moduli m;
    mps_material *material = NULL;
    mps_assert_ok(context,
                  mps_moduli_from_elastic(context, E[k & 1], nu[k >> 1 & 1], rho[k >> 2], &m));
    const double all[] = {m.shear, m.bulk, m.wave, m.shear_velocity, m.pressure_velocity};
    for (size_t c = 0; c < sizeof all / sizeof *all; c++)
      assert_true(all[c] > 1e-12 && all[c] < 1e24);
    mps_assert_ok(context,
                  mps_material_create_linear_elastic(context, E[k & 1], nu[k >> 1 & 1], &material));
    near_relative(mps_material_wave_modulus(material), m.wave);
    mps_material_destroy(&material);
  }
}

/* ---- materials ------------------------------------------------------------------------------- */

static mps_status nothing(void *user, const mps_material_block *block) {
  (void)user, (void)block;
  return MPS_OK;
}

static void materials_tell_their_moduli(void **state) {
  (void)state;
  mps_moduli m, want;
  mps_material *sand = NULL, *own = NULL;
  mps_material_mohr_coulomb_def def = mps_material_mohr_coulomb_defaults();
  def.young = 5e7, def.poisson = 0.28, def.friction = 0.6;
  mps_assert_ok(context, mps_material_create_mohr_coulomb(context, &def, &sand));
  mps_assert_ok(context, mps_material_get_moduli(sand, 1700.0, &m));
  mps_assert_ok(context, mps_moduli_from_elastic(context, 5e7, 0.28, 1700.0, &want));
  near_relative(m.young, 5e7);
  near_relative(m.poisson, 0.28);
  near_relative(m.shear_velocity, want.shear_velocity);
  near_relative(m.pressure_velocity, want.pressure_velocity);
  double first[2] = {0.0, 7.0}; /* of a program that knows one member only */
  mps_assert_ok(context,
                mps_material_get_moduli_sized(sand, 1700.0, (mps_moduli *)(void *)first, 8));
  assert_true(first[0] == m.young && first[1] == 7.0);
  mps_material_user_def law = mps_material_user_defaults();
  law.update = nothing, law.wave_modulus = 1e6;
  mps_assert_ok(context, mps_material_create_user(context, &law, &own));
  FAILS(mps_material_get_moduli(own, 1e3, &m), MPS_ERROR_UNSUPPORTED, "user has no elastic");
  FAILS(mps_material_get_moduli(sand, -1.0, &m), MPS_ERROR_ARGUMENT, "density is -1");
  mps_material_destroy(&sand);
  mps_material_destroy(&own);
}

/* ---- fields ---------------------------------------------------------------------------------- */

static double value_of(mps_particles *set, const char *name, int64_t id) {
  mps_view view;
  mps_assert_ok(context, mps_particles_view(set, name, &view));
  return *mps_view_f64(&view, mps_particles_index(set, id), 0);
}

static void fields_say_what_particles_are_made_of(void **state) {
  (void)state;
  mps_particles_def def = mps_particles_defaults();
  const double lo[] = {0.0, 0.0}, hi[] = {4.0, 4.0};
  mps_particles *set = NULL;
  mps_material *clay = NULL, *rock = NULL, *sand = NULL;
  mps_material_drucker_prager_def cone = mps_material_drucker_prager_defaults();
  mps_moduli soft, hard;
  def.spacing = 1.0;
  cone.young = 1e7, cone.friction = 0.5;
  mps_assert_ok(context, mps_particles_create(context, &def, &set));
  mps_assert_ok(context, mps_particles_fill_box(set, lo, hi, NULL));
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 2e7, 0.4, &clay));
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 3e10, 0.2, &rock));
  mps_assert_ok(context, mps_material_create_drucker_prager(context, &cone, &sand));
  mps_assert_ok(context, mps_moduli_from_elastic(context, 2e7, 0.4, 1600.0, &soft));
  mps_assert_ok(context, mps_moduli_from_elastic(context, 3e10, 0.2, 2600.0, &hard));
  const int32_t fields = mps_particles_field_count(set);
  const int64_t ids[] = {15, 3}, bad[] = {15, 16};
  FAILS(mps_particles_set_material(set, sand, 1600.0, 0, NULL), MPS_ERROR_UNSUPPORTED,
        "the law is drucker_prager");
  FAILS(mps_particles_set_material(set, NULL, 1600.0, 0, NULL), MPS_ERROR_ARGUMENT, "is NULL");
  FAILS(mps_particles_set_material(set, clay, 0.0, 0, NULL), MPS_ERROR_ARGUMENT, "density is 0");
  FAILS(mps_particles_set_material(set, clay, 1e3, 2, bad), MPS_ERROR_ARGUMENT, "ids[1] is 16");
  FAILS(mps_particles_set_material(set, clay, 1e3, 2, NULL), MPS_ERROR_ARGUMENT, "count is 2");
  assert_int_equal(mps_particles_set_material(NULL, clay, 1e3, 0, NULL), MPS_ERROR_ARGUMENT);
  mps_context *other = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  mps_material *foreign = NULL;
  mps_assert_ok(other, mps_material_create_linear_elastic(other, 2e7, 0.4, &foreign));
  FAILS(mps_particles_set_material(set, foreign, 1e3, 0, NULL), MPS_ERROR_ARGUMENT,
        "another context");
  mps_material_destroy(&foreign);
  mps_context_destroy(&other);
  assert_int_equal(mps_particles_field_count(set), fields);
  mps_assert_ok(context, mps_particles_set_material(set, clay, 1600.0, 0, NULL));
  mps_assert_ok(context, mps_particles_set_material(set, rock, 2600.0, 2, ids));
  for (int64_t id = 0; id < 16; id++) {
    const mps_moduli *m = id == 15 || id == 3 ? &hard : &soft;
    near_relative(value_of(set, "young", id), m->young);
    near_relative(value_of(set, "poisson", id), m->poisson);
    near_relative(value_of(set, "density", id), m->density);
    near_relative(value_of(set, "shear_velocity", id), m->shear_velocity);
    near_relative(value_of(set, "pressure_velocity", id), m->pressure_velocity);
  }
  mps_material_destroy(&clay);
  mps_material_destroy(&rock);
  mps_material_destroy(&sand);
  mps_particles_destroy(&set);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(constants_turn_into_one_another),
      cmocka_unit_test(velocities_of_text_books),
      cmocka_unit_test(what_is_out_of_range_is_refused),
      cmocka_unit_test(the_ends_of_the_ranges_are_sane),
      cmocka_unit_test(materials_tell_their_moduli),
      cmocka_unit_test(fields_say_what_particles_are_made_of),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
