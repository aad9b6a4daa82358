/* test_material.c - materials as objects: checks of definitions and blocks, names and history, a
 * user's law, shared ownership, memory.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"

#include "material_paths.h"

#include "material/material_internal.h"

/* ---- definitions ----------------------------------------------------------------------------- */

static void elastic_constants_are_checked(void **state) {
  (void)state;
  mps_material *m = (mps_material *)&m;
  mps_assert_fails(context, mps_material_create_linear_elastic(context, 0.0, 0.3, &m),
                   MPS_ERROR_ARGUMENT, "Young's modulus is 0 Pa, must be 1e-06 to 1e+18");
  assert_null(m);
  mps_assert_fails(context, mps_material_create_linear_elastic(context, NAN, 0.3, &m),
                   MPS_ERROR_ARGUMENT, "nan");
  mps_assert_fails(context, mps_material_create_neo_hookean(context, INFINITY, 0.3, &m),
                   MPS_ERROR_ARGUMENT, "inf");
  mps_assert_fails(context, mps_material_create_neo_hookean(context, 1.0, 0.5, &m),
                   MPS_ERROR_ARGUMENT, "Poisson's ratio is 0.5, must be -0.999 to 0.49999");
  mps_assert_fails(context, mps_material_create_linear_elastic(context, 1.0, -1.0, &m),
                   MPS_ERROR_ARGUMENT, "-1");
  mps_assert_fails(context, mps_material_create_linear_elastic(context, 1.0, NAN, &m),
                   MPS_ERROR_ARGUMENT, "nan");
  mps_assert_fails(context, mps_material_create_linear_elastic(context, 1.0, 0.3, NULL),
                   MPS_ERROR_ARGUMENT, "out is NULL");
  assert_int_equal(mps_material_create_linear_elastic(NULL, 1.0, 0.3, &m), MPS_ERROR_ARGUMENT);
}

/* Makes the law with one member changed, and expects a message. */
#define REFUSED(law, make, prepare, member, value, text)                                           \
  do {                                                                                             \
    mps_material_##law##_def def = prepare;                                                        \
    mps_material *m = NULL;                                                                        \
    def.member = value;                                                                            \
    mps_assert_fails(context, make(context, &def, &m), MPS_ERROR_ARGUMENT, text);                  \
    assert_null(m);                                                                                \
  } while (0)

static mps_material_von_mises_def mises(void) {
  mps_material_von_mises_def def = mps_material_von_mises_defaults();
  def.young = 1e6;
  def.yield_stress = 1e3;
  return def;
}

static mps_material_drucker_prager_def sand(void) {
  mps_material_drucker_prager_def def = mps_material_drucker_prager_defaults();
  def.young = 1e6;
  def.friction = 0.5;
  return def;
}

static mps_material_mohr_coulomb_def pyramid(void) {
  mps_material_mohr_coulomb_def def = mps_material_mohr_coulomb_defaults();
  def.young = 1e6;
  def.friction = 0.5;
  return def;
}

static mps_material_newtonian_def water(void) {
  mps_material_newtonian_def def = mps_material_newtonian_defaults();
  def.bulk_modulus = 1e6;
  return def;
}

static void bad_definitions_are_refused_with_the_reason(void **state) {
  (void)state;
#define MISES(member, value, text)                                                                 \
  REFUSED(von_mises, mps_material_create_von_mises, mises(), member, value, text)
#define SAND(member, value, text)                                                                  \
  REFUSED(drucker_prager, mps_material_create_drucker_prager, sand(), member, value, text)
#define PYRAMID(member, value, text)                                                               \
  REFUSED(mohr_coulomb, mps_material_create_mohr_coulomb, pyramid(), member, value, text)
#define WATER(member, value, text)                                                                 \
  REFUSED(newtonian, mps_material_create_newtonian, water(), member, value, text)
  MISES(young, -1.0, "Young's modulus is -1");
  MISES(yield_stress, 0.0, "yield stress is 0 Pa");
  MISES(yield_stress, NAN, "yield stress is nan");
  MISES(hardening, -1.0, "hardening is -1 Pa, must be 0 or 1e-09 to 1e+18");
  MISES(struct_size, 3, "struct_size is 3");
  SAND(poisson, 0.6, "Poisson's ratio is 0.6");
  SAND(friction, 1.58, "the friction angle is 1.58 rad (angles are in radians)");
  SAND(friction, 38.0, "radians");
  SAND(friction, NAN, "the friction angle is nan"); /* as the defaults leave it */
  SAND(friction, -0.1, "-0.1");
  SAND(dilation, 0.6, "must be >= 0 and at most the friction angle, 0.5 rad");
  SAND(dilation, NAN, "the dilation angle is nan");
  SAND(dilation, -0.1, "the dilation angle is -0.1");
  SAND(cohesion, -1.0, "cohesion is -1 Pa");
  SAND(cohesion, INFINITY, "cohesion is inf");
  SAND(friction, 0.0, "no strength");
  SAND(tension, -1.0, "tension is -1 Pa");
  SAND(tension, NAN, "tension is nan");
  SAND(cone, 4, "cone is 4");
  PYRAMID(young, 0.0, "Young's modulus is 0");
  PYRAMID(friction, NAN, "the friction angle is nan");
  PYRAMID(dilation, 0.51, "0.51 rad");
  PYRAMID(friction, 0.0, "no strength");
  PYRAMID(tension, -1.0, "tension is -1 Pa");
  PYRAMID(tension, NAN, "tension is nan");
  WATER(bulk_modulus, 0.0, "bulk modulus is 0 Pa");
  WATER(viscosity, -1.0, "viscosity is -1 Pa s");
  WATER(viscosity, INFINITY, "viscosity is inf");
  WATER(state, 2, "state is 2");
  WATER(no_tension, 2, "no_tension is 2");
  mps_material *m = NULL;
  mps_assert_fails(context, mps_material_create_newtonian(context, NULL, &m), MPS_ERROR_ARGUMENT,
                   "def is NULL");
  assert_int_equal(mps_material_newtonian_def_init(NULL, sizeof(mps_material_newtonian_def)),
                   MPS_ERROR_ARGUMENT);
  mps_material_newtonian_def def;
  assert_int_equal(mps_material_newtonian_def_init(&def, 4), MPS_ERROR_ARGUMENT);
}

static void materials_answer_questions(void **state) {
  (void)state;
  mps_material *m = NULL;
  const mps_material_drucker_prager_def def = sand();
  mps_assert_ok(context, mps_material_create_drucker_prager(context, &def, &m));
  assert_string_equal(mps_material_name(m), "drucker_prager");
  assert_int_equal(mps_material_history_count(m), 2);
  assert_string_equal(mps_material_history_name(m, 0), "plastic_strain");
  assert_string_equal(mps_material_history_name(m, 1), "opening");
  assert_string_equal(mps_material_history_field(m, 1), "opening");
  assert_null(mps_material_history_name(m, 2));
  assert_null(mps_material_history_name(m, -1));
  assert_true(mps_material_history_initial(m, 0) == 0.0);
  assert_int_equal(mps_material_needs_deformation(m), 0);
  assert_false(mpsi_material_reads_volume(m));
  assert_false(mpsi_material_stiffens(m));
  double modulus = 0.0;
  const mps_material_block block = {.dim = 2, .count = 1};
  mpsi_material_wave_moduli(m, &block, &modulus);
  mps_assert_near(modulus, 1e6 * 0.7 / (1.3 * 0.4), 1e-9); /* E (1 - nu)/((1 + nu)(1 - 2 nu)) */
  mps_assert_near(mps_material_wave_modulus(m), modulus, 0.0);
  mps_material_destroy(&m);
  assert_string_equal(mps_material_name(NULL), "");
  assert_true(mps_material_wave_modulus(NULL) == 0.0);
  assert_int_equal(mps_material_needs_deformation(NULL), 0);
  assert_int_equal(mps_material_history_count(NULL), 0);
  assert_null(mps_material_history_name(NULL, 0));
  assert_true(mps_material_history_initial(NULL, 0) == 0.0);
}

/* ---- a user's law ---------------------------------------------------------------------------- */

typedef struct calls {
  int64_t blocks, particles;
  mps_status refuse; /* the status to return */
  double xx, volume, stretch;
} calls;

/* A dashpot that counts the particles' steps. */
static mps_status dashpot(void *user, const mps_material_block *block) {
  calls *seen = user;
  seen->blocks++;
  seen->particles += block->count;
  seen->xx = block->stress[0][0];
  seen->volume = block->volume_ratio[0];
  seen->stretch = block->deformation[0] ? block->deformation[0][0] : 0.0;
  for (int64_t k = 0; k < block->count; k++) {
    block->history[1][k] += 1.0;
    block->stress[0][k] += 10.0 * block->gradient[0][k];
    if (block->flags[k] != 0) return MPS_ERROR_INTERNAL; /* they come as zero */
    block->flags[k] = MPS_MATERIAL_FLAG_PLASTIC;
  }
  if (seen->refuse != MPS_OK && block->message_size > 0) {
    snprintf(block->message, (size_t)block->message_size, "too hot at %g s", block->time);
    *block->refused = block->count - 1;
  }
  return seen->refuse;
}

static const char *const two_names[] = {"damage", "steps"};
static const double two_values[] = {0.25, 0.0};

static mps_material_user_def dashpot_def(calls *seen) {
  mps_material_user_def def = mps_material_user_defaults();
  def.update = dashpot;
  def.user = seen;
  def.name = "dashpot";
  def.history_count = 2;
  def.history = two_names;
  def.history_initial = two_values;
  def.wave_modulus = 5e5;
  def.viscosity = 7.0;
  return def;
}

static void a_users_law_is_called_once_a_block(void **state) {
  (void)state;
  calls seen = {0};
  mps_material_user_def def = dashpot_def(&seen);
  mps_material *m = NULL;
  mps_assert_ok(context, mps_material_create_user(context, &def, &m));
  assert_string_equal(mps_material_name(m), "dashpot");
  assert_string_equal(mps_material_history_name(m, 1), "steps");
  assert_true(mps_material_wave_modulus(m) == 5e5 && mpsi_material_viscosity(m) == 7.0);
  double rate[4][64] = {{0}}, stress[4][64] = {{0}}, volume[64], history[2][64];
  int64_t flags[64];
  double *const columns[2] = {history[0], history[1]};
  mps_material_block block = {.struct_size = sizeof block, .dim = 2, .count = 64, .dt = 0.5};
  block.gradient[0] = rate[0], block.gradient[1] = rate[1];
  block.gradient[3] = rate[2], block.gradient[4] = rate[3];
  for (int c = 0; c < 4; c++) block.stress[c] = stress[c];
  block.history = columns, block.history_count = 2, block.time = 3.5;
  block.volume_ratio = volume, block.flags = flags;
  for (int k = 0; k < 64; k++) rate[0][k] = 0.1 * k, volume[k] = 2.0, flags[k] = 3;
  mpsi_material_begin(m, columns, 0, 64);
  for (int step = 0; step < 3; step++)
    mps_assert_ok(context, mps_material_update(context, m, &block));
  assert_int_equal(seen.blocks, 3);
  assert_int_equal(seen.particles, 3 * 64);
  for (int k = 0; k < 64; k++) {
    assert_true(history[0][k] == 0.25 && history[1][k] == 3.0);
    mps_assert_near(stress[0][k], 3.0 * k, 1e-12);
    mps_assert_near(volume[k], 2.0 * pow(1.0 + 0.05 * k, 3.0), 1e-12 * volume[k]);
    assert_int_equal(flags[k], MPS_MATERIAL_FLAG_PLASTIC);
  }
  block.count = 0; /* nothing to do: no callback is called */
  mps_assert_ok(context, mps_material_update(context, m, &block));
  assert_int_equal(seen.blocks, 3);
  block.count = 64;
  seen.refuse = MPS_ERROR_DIVERGED; /* its own status, its words, the particle */
  mps_assert_fails(context, mps_material_update(context, m, &block), MPS_ERROR_DIVERGED,
                   "the law 'dashpot' has refused particle 63: too hot at 3.5 s");
  assert_int_equal(mps_context_error(context)->particle, 63);
  int64_t ids[64], refused = 0;
  char message[12];
  for (int k = 0; k < 64; k++) ids[k] = 1000 + k;
  block.ids = ids, block.refused = &refused;
  block.message = message, block.message_size = sizeof message; /* cut to the caller's room */
  mps_assert_fails(context, mps_material_update(context, m, &block), MPS_ERROR_DIVERGED,
                   "the law 'dashpot' has refused particle 1063: too hot at");
  assert_int_equal(refused, 63);
  assert_string_equal(message, "too hot at ");
  seen.refuse = (mps_status)4711; /* none of ours */
  mps_assert_fails(context, mps_material_update(context, m, &block), MPS_ERROR_NUMERIC, "refused");
  mps_material_destroy(&m);
}

static void a_users_law_gets_the_state_it_asks_for(void **state) {
  (void)state;
  for (int turns = 0; turns < 2; turns++)
    for (int deforms = 0; deforms < 2; deforms++) {
      calls seen = {0};
      mps_material_user_def def = dashpot_def(&seen);
      def.turns_stress = turns;
      def.needs_deformation = deforms;
      mps_material *m = NULL;
      mps_assert_ok(context, mps_material_create_user(context, &def, &m));
      mps_material_point point = point_under(m, 0.0);
      assert_true(point.history[0] == 0.25);
      point.stress[0] = 1.0;
      const double spin[9] = {0.5, -2.0, 0, 2.0, 0, 0, 0, 0, 0}; /* a quarter turn about z */
      mps_assert_ok(context, mps_material_point_drive(context, m, &point, spin, 1.0, 1));
      mps_assert_near(seen.xx, turns ? 0.0 : 1.0, 1e-15);
      mps_assert_near(point.stress[1], turns ? 1.0 : 0.0, 1e-15);
      mps_assert_near(seen.volume, deforms ? 1.5 + 4.0 : 1.5, 1e-15);
      mps_assert_near(seen.stretch, deforms ? 1.5 : 1.0, 0.0); /* 1: untouched */
      const mps_material_point before = point;
      seen.refuse = MPS_ERROR_DIVERGED;
      mps_assert_fails(context, mps_material_point_drive(context, m, &point, spin, 1.0, 3),
                       MPS_ERROR_DIVERGED, "too hot at");
      assert_memory_equal(&before, &point, sizeof point);
      mps_material_destroy(&m);
    }
}

static void bad_users_laws_are_refused(void **state) {
  (void)state;
  static const char *const twice[] = {"a", "a"};
  static const char *const bad[] = {"a", "b c"};
  static const char *const missing[] = {"a", NULL};
  static const double wrong[] = {0.0, NAN};
  calls seen = {0};
#define LAW(member, value, text)                                                                   \
  REFUSED(user, mps_material_create_user, dashpot_def(&seen), member, value, text)
  LAW(update, NULL, "update is NULL");
  LAW(name, NULL, "name is \"(NULL)\"");
  LAW(name, "", "name is \"\"");
  LAW(name, "2fast", "name is \"2fast\"");
  LAW(name, "a_name_that_has_more_than_forty_seven_characters_in", "at most 47");
  LAW(history_count, -1, "history_count is -1, must be 0..1024");
  LAW(history_count, 1025, "history_count is 1025");
  LAW(history, NULL, "must name 2 columns");
  LAW(history, twice, "history[0] and history[1] are both \"a\"");
  LAW(history, bad, "history[1] is \"b c\"");
  LAW(history, missing, "history[1] is \"(NULL)\"");
  LAW(history_initial, wrong, "history_initial[1] is nan");
  LAW(wave_modulus, 0.0, "wave modulus is 0 Pa");
  LAW(viscosity, -1.0, "viscosity is -1");
  LAW(needs_deformation, 2, "needs_deformation is 2");
  LAW(turns_stress, -1, "turns_stress is -1");
  mps_material *m = NULL;
  mps_assert_fails(context, mps_material_create_user(context, NULL, &m), MPS_ERROR_ARGUMENT,
                   "def is NULL");
  const mps_material_user_def def = dashpot_def(&seen);
  mps_assert_fails(context, mps_material_create_user(context, &def, NULL), MPS_ERROR_ARGUMENT,
                   "out is NULL");
}

/* ---- blocks and points ----------------------------------------------------------------------- */

static void malformed_blocks_are_refused(void **state) {
  (void)state;
  double x = 7.0;
  int64_t flags = 5;
  mps_material *neo = NULL, *plastic = NULL;
  const mps_material_von_mises_def def = mises();
  mps_assert_ok(context, mps_material_create_neo_hookean(context, 1e6, 0.3, &neo));
  mps_assert_ok(context, mps_material_create_von_mises(context, &def, &plastic));
  mps_material_block good = {.struct_size = sizeof good, .dim = 3, .count = 1, .dt = 1.0};
  for (int c = 0; c < 9; c++) good.gradient[c] = good.deformation[c] = &x;
  for (int c = 0; c < 6; c++) good.stress[c] = &x;
  double *const history[1] = {&x}, *const none[1] = {NULL};
  good.volume_ratio = &x;
  good.flags = &flags;
#define BLOCK(material, member, value, text)                                                       \
  do {                                                                                             \
    mps_material_block block = good;                                                               \
    block.member = value;                                                                          \
    mps_assert_fails(context, mps_material_update(context, material, &block), MPS_ERROR_ARGUMENT,  \
                     text);                                                                        \
  } while (0)
  BLOCK(neo, struct_size, 8, "struct_size is 8");
  BLOCK(neo, dim, 1, "dim is 1");
  BLOCK(neo, count, -1, "count is -1");
  BLOCK(neo, dt, 0.0, "dt is 0 s");
  BLOCK(neo, dt, NAN, "dt is nan");
  BLOCK(neo, volume_ratio, NULL, "volume_ratio is NULL");
  BLOCK(neo, flags, NULL, "flags is NULL");
  BLOCK(neo, gradient[7], NULL, "gradient[7] (zy) is NULL, needed in 3D");
  BLOCK(neo, gradient[8], NULL, "gradient[8] (zz)");
  BLOCK(neo, deformation[2], NULL, "deformation[2] (xz) is NULL, needed by the law neo_hookean");
  BLOCK(neo, stress[5], NULL, "stress[5] is NULL");
  BLOCK(plastic, history, history, "history_count is 0, the law von_mises has 1 columns");
  good.history_count = 1;
  BLOCK(plastic, history, NULL, "history[0] (plastic_strain) is NULL");
  BLOCK(plastic, history, none, "history[0] (plastic_strain) is NULL");
  BLOCK(plastic, message_size, -1, "message_size is -1");
  mps_assert_fails(context, mps_material_update(context, NULL, &good), MPS_ERROR_ARGUMENT,
                   "material is NULL");
  mps_assert_fails(context, mps_material_update(context, neo, NULL), MPS_ERROR_ARGUMENT,
                   "block is NULL");
  assert_int_equal(mps_material_update(NULL, neo, &good), MPS_ERROR_ARGUMENT);
  assert_true(x == 7.0 && flags == 5);
  mps_material_destroy(&neo);
  mps_material_destroy(&plastic);
}

static void malformed_paths_are_refused(void **state) {
  (void)state;
  mps_material *m = NULL;
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e6, 0.3, &m));
  mps_material_point point = point_under(m, 1.0);
  double gradient[9] = {0};
#define DRIVE(material, point, gradient, duration, steps, text)                                    \
  mps_assert_fails(context,                                                                        \
                   mps_material_point_drive(context, material, point, gradient, duration, steps),  \
                   MPS_ERROR_ARGUMENT, text)
  DRIVE(NULL, &point, gradient, 1.0, 1, "material is NULL");
  DRIVE(m, NULL, gradient, 1.0, 1, "point is NULL");
  DRIVE(m, &point, NULL, 1.0, 1, "gradient is NULL");
  DRIVE(m, &point, gradient, 0.0, 1, "duration is 0 s");
  DRIVE(m, &point, gradient, NAN, 1, "duration is nan");
  DRIVE(m, &point, gradient, 1.0, 0, "steps is 0");
  gradient[4] = INFINITY;
  DRIVE(m, &point, gradient, 1.0, 1, "gradient[4] is inf");
  mps_assert_fails(context, mps_material_point_init(context, m, NULL), MPS_ERROR_ARGUMENT,
                   "point is NULL");
  mps_assert_fails(context, mps_material_point_init(context, NULL, &point), MPS_ERROR_ARGUMENT,
                   "material is NULL");
  assert_int_equal(mps_material_point_init(NULL, m, &point), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_material_point_drive(NULL, m, &point, gradient, 1.0, 1), MPS_ERROR_ARGUMENT);
  mps_material_destroy(&m);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static mps_status make_and_destroy(mps_context *on, int what) {
  calls seen = {0};
  mps_material *m = NULL;
  const mps_material_drucker_prager_def cone = sand();
  const mps_material_user_def user = dashpot_def(&seen);
  const mps_status status = what == 0   ? mps_material_create_linear_elastic(on, 1e6, 0.3, &m)
                            : what == 1 ? mps_material_create_drucker_prager(on, &cone, &m)
                                        : mps_material_create_user(on, &user, &m);
  assert_true((status == MPS_OK) == (m != NULL));
  mps_material_destroy(&m);
  return status;
}

static void refused_memory_leaves_nothing_behind(void **state) {
  (void)state;
  for (int what = 0; what < 3; what++) test_allocator_sweep(make_and_destroy, what);
}

static void a_material_outlives_its_context_and_first_owner(void **state) {
  (void)state;
  test_allocator allocator = {0};
  mps_context *own = test_allocator_context(&allocator);
  mps_material *m = NULL;
  mps_assert_ok(own, mps_material_create_linear_elastic(own, 1e6, 0.3, &m));
  mps_material *second = mpsi_material_retain(m);
  mps_context_destroy(&own);
  mps_material_destroy(&m);
  assert_null(m);
  assert_string_equal(mps_material_name(second), "linear_elastic");
  const int64_t calls_before = allocator.calls;
  mps_material_point point = point_under(second, 0.0); /* errors go to another context */
  const double gradient[9] = {1e-3, 0, 0, 0, 0, 0, 0, 0, 0};
  mps_assert_ok(context, mps_material_point_drive(context, second, &point, gradient, 1.0, 100));
  assert_int_equal(allocator.calls, calls_before); /* no allocation in a step */
  mps_material_destroy(&second);
  mps_material_destroy(&second);
  mps_material_destroy(NULL);
  assert_int_equal(allocator.live, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(elastic_constants_are_checked),
      cmocka_unit_test(bad_definitions_are_refused_with_the_reason),
      cmocka_unit_test(materials_answer_questions),
      cmocka_unit_test(a_users_law_is_called_once_a_block),
      cmocka_unit_test(a_users_law_gets_the_state_it_asks_for),
      cmocka_unit_test(bad_users_laws_are_refused),
      cmocka_unit_test(malformed_blocks_are_refused),
      cmocka_unit_test(malformed_paths_are_refused),
      cmocka_unit_test(refused_memory_leaves_nothing_behind),
      cmocka_unit_test(a_material_outlives_its_context_and_first_owner),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
