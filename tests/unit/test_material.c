/* test_material.c - materials as objects: checks of definitions and blocks, names and history, a
 * user's law, shared ownership, memory.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"

#include "material_paths.h"

#include "material/material_internal.h"

/* ---- definitions ----------------------------------------------------------------------------- */

TEST(elastic_constants_are_checked) {
  mps_material *m = (mps_material *)&m;
  REFUSES(mps_material_create_linear_elastic(context, 0.0, 0.3, &m),
          "young is 0 Pa, must be 1e-06 to 1e+18");
  assert_null(m);
  REFUSES(mps_material_create_linear_elastic(context, NAN, 0.3, &m), "nan");
  REFUSES(mps_material_create_neo_hookean(context, INFINITY, 0.3, &m), "inf");
  REFUSES(mps_material_create_neo_hookean(context, 1.0, 0.5, &m),
          "poisson is 0.5, must be -0.999 to 0.49999");
  REFUSES(mps_material_create_linear_elastic(context, 1.0, -1.0, &m), "-1");
  REFUSES(mps_material_create_linear_elastic(context, 1.0, NAN, &m), "nan");
  REFUSES(mps_material_create_linear_elastic(context, 1.0, 0.3, NULL), "out is NULL");
  assert_int_equal(mps_material_create_linear_elastic(NULL, 1.0, 0.3, &m), MPS_ERROR_ARGUMENT);
}

/* Makes the law with one member changed, and expects a message. */
#define REFUSED(law, make, prepare, member, value, text)                                           \
  do {                                                                                             \
    mps_material_##law##_def def = prepare;                                                        \
    mps_material *m = NULL;                                                                        \
    def.member = value;                                                                            \
    REFUSES(make(context, &def, &m), text);                                                        \
    assert_null(m);                                                                                \
  } while (0)

static mps_material_von_mises_def mises(void) {
  DEF(material_von_mises, def, .young = 1e6, .yield_stress = 1e3);
  return def;
}

static mps_material_drucker_prager_def sand(void) {
  DEF(material_drucker_prager, def, .young = 1e6, .friction = 0.5);
  return def;
}

/* What no member's range says: the work of softening. The ranges are tried in test_definitions.c.
 */
TEST(softening_needs_a_band_that_unloads) {
#define MISES(text, ...)                                                                           \
  do {                                                                                             \
    mps_material_von_mises_def def = mises();                                                      \
    mps_material *m = NULL;                                                                        \
    __VA_ARGS__;                                                                                   \
    REFUSES(mps_material_create_von_mises(context, &def, &m), text);                               \
    assert_null(m);                                                                                \
  } while (0)
  MISES("slip is NaN: softening needs slip and band", def.residual = 0.5);
  MISES("band is NaN", def.residual = 0.5, def.slip = 0.1);
  MISES("steeper than the shear modulus", def.residual = 0.5, def.slip = 1e-6, def.band = 1.0);
  mps_material *m = NULL;
  REFUSES(mps_material_create_newtonian(context, NULL, &m), "def is NULL");
}

TEST(materials_answer_questions) {
  const mps_material_drucker_prager_def def = sand();
  MAKE(material, m, create_drucker_prager, context, &def);
  assert_string_equal(mps_material_name(m), "drucker_prager");
  assert_int_equal(mps_material_history_count(m), 2);
  assert_string_equal(mps_material_history_name(m, 0), "plastic_strain");
  assert_string_equal(mps_material_history_name(m, 1), "opening");
  assert_string_equal(mpsi_material_history_field(m, 1), "opening");
  assert_null(mps_material_history_name(m, 2));
  assert_null(mps_material_history_name(m, -1));
  assert_true(mps_material_history_initial(m, 0) == 0.0);
  assert_false(mpsi_material_needs_deformation(m));
  assert_false(mpsi_material_reads_volume(m));
  assert_false(mpsi_material_stiffens(m));
  double modulus = 0.0;
  const mps_material_block block = {.dim = 2, .count = 1};
  mpsi_material_wave_moduli(m, &block, &modulus);
  NEAR(modulus, 1e6 * 0.7 / (1.3 * 0.4), 1e-9); /* E (1 - nu)/((1 + nu)(1 - 2 nu)) */
  NEAR(mps_material_wave_modulus(m), modulus, 0.0);
  assert_string_equal(mps_material_name(NULL), "");
  assert_true(mps_material_wave_modulus(NULL) == 0.0);
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
  DEF(material_user, def, .update = dashpot, .user = seen, .name = "dashpot", .history_count = 2,
      .history = two_names, .history_initial = two_values, .wave_modulus = 5e5, .viscosity = 7.0);
  return def;
}

TEST(a_users_law_is_called_once_a_block) {
  calls seen = {0};
  mps_material_user_def def = dashpot_def(&seen);
  MAKE(material, m, create_user, context, &def);
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
  for (int step = 0; step < 3; step++) OK(mps_material_update(context, m, &block));
  assert_int_equal(seen.blocks, 3);
  assert_int_equal(seen.particles, 3 * 64);
  for (int k = 0; k < 64; k++) {
    assert_true(history[0][k] == 0.25 && history[1][k] == 3.0);
    NEAR(stress[0][k], 3.0 * k, 1e-12);
    NEAR(volume[k], 2.0 * pow(1.0 + 0.05 * k, 3.0), 1e-12 * volume[k]);
    assert_int_equal(flags[k], MPS_MATERIAL_FLAG_PLASTIC);
  }
  block.count = 0; /* nothing to do: no callback is called */
  OK(mps_material_update(context, m, &block));
  assert_int_equal(seen.blocks, 3);
  block.count = 64;
  seen.refuse = MPS_ERROR_DIVERGED; /* its own status, its words, the particle */
  FAILS(mps_material_update(context, m, &block), MPS_ERROR_DIVERGED,
        "the law 'dashpot' has refused particle 63: too hot at 3.5 s");
  assert_int_equal(mps_context_error(context)->particle, 63);
  int64_t ids[64], refused = 0;
  char message[12];
  for (int k = 0; k < 64; k++) ids[k] = 1000 + k;
  block.ids = ids, block.refused = &refused;
  block.message = message, block.message_size = sizeof message; /* cut to the caller's room */
  FAILS(mps_material_update(context, m, &block), MPS_ERROR_DIVERGED,
        "the law 'dashpot' has refused particle 1063: too hot at");
  assert_int_equal(refused, 63);
  assert_string_equal(message, "too hot at ");
  seen.refuse = (mps_status)4711; /* none of ours */
  FAILS(mps_material_update(context, m, &block), MPS_ERROR_NUMERIC, "refused");
}

TEST(a_users_law_gets_the_state_it_asks_for) {
  for (int turns = 0; turns < 2; turns++)
    for (int deforms = 0; deforms < 2; deforms++) {
      calls seen = {0};
      mps_material_user_def def = dashpot_def(&seen);
      def.turns_stress = turns;
      def.needs_deformation = deforms;
      MAKE(material, m, create_user, context, &def);
      mps_material_point point = point_under(m, 0.0);
      assert_true(point.history[0] == 0.25);
      point.stress[0] = 1.0;
      const double spin[9] = {0.5, -2.0, 0, 2.0, 0, 0, 0, 0, 0}; /* a quarter turn about z */
      OK(mps_material_point_drive(context, m, &point, spin, 1.0, 1));
      NEAR(seen.xx, turns ? 0.0 : 1.0, 1e-15);
      NEAR(point.stress[1], turns ? 1.0 : 0.0, 1e-15);
      NEAR(seen.volume, deforms ? 1.5 + 4.0 : 1.5, 1e-15);
      NEAR(seen.stretch, deforms ? 1.5 : 1.0, 0.0); /* 1: untouched */
      const mps_material_point before = point;
      seen.refuse = MPS_ERROR_DIVERGED;
      FAILS(mps_material_point_drive(context, m, &point, spin, 1.0, 3), MPS_ERROR_DIVERGED,
            "too hot at");
      assert_memory_equal(&before, &point, sizeof point);
    }
}

TEST(bad_users_laws_are_refused) {
  static const char *const twice[] = {"a", "a"};
  static const char *const bad[] = {"a", "b c"};
  static const char *const missing[] = {"a", NULL};
  calls seen = {0};
#define LAW(member, value, text)                                                                   \
  REFUSED(user, mps_material_create_user, dashpot_def(&seen), member, value, text)
  LAW(name, "", "name is ''");
  LAW(name, "2fast", "name is '2fast'");
  LAW(name, "a_name_that_has_more_than_forty_seven_characters_in", "1 to 47 characters");
  LAW(name, "user", "name is 'user', must be");
  LAW(history, twice, "history[0] and history[1] are both 'a'");
  LAW(history, bad, "history[1] is 'b c'");
  LAW(history, missing, "history[1] is NULL");
  mps_material *m = NULL;
  REFUSES(mps_material_create_user(context, NULL, &m), "def is NULL");
  const mps_material_user_def def = dashpot_def(&seen);
  REFUSES(mps_material_create_user(context, &def, NULL), "out is NULL");
}

/* ---- blocks and points ----------------------------------------------------------------------- */

TEST(malformed_blocks_are_refused) {
  double x = 7.0;
  int64_t flags = 5;
  scoped_material *neo = NULL, *plastic = NULL;
  const mps_material_von_mises_def def = mises();
  OK(mps_material_create_neo_hookean(context, 1e6, 0.3, &neo));
  OK(mps_material_create_von_mises(context, &def, &plastic));
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
    REFUSES(mps_material_update(context, material, &block), text);                                 \
  } while (0)
  BLOCK(neo, gradient[7], NULL, "gradient[7] (zy) is NULL, needed in 3D");
  BLOCK(neo, gradient[8], NULL, "gradient[8] (zz)");
  BLOCK(neo, deformation[2], NULL, "deformation[2] (xz) is NULL, needed by the law neo_hookean");
  BLOCK(neo, stress[5], NULL, "stress[5] is NULL");
  BLOCK(plastic, history, history, "history_count is 0, the law von_mises has 1 columns");
  good.history_count = 1;
  BLOCK(plastic, history, NULL, "history[0] (plastic_strain) is NULL");
  BLOCK(plastic, history, none, "history[0] (plastic_strain) is NULL");
  REFUSES(mps_material_update(context, NULL, &good), "material is NULL");
  REFUSES(mps_material_update(context, neo, NULL), "block is NULL");
  assert_int_equal(mps_material_update(NULL, neo, &good), MPS_ERROR_ARGUMENT);
  assert_true(x == 7.0 && flags == 5);
}

TEST(malformed_paths_are_refused) {
  MAKE(material, m, create_linear_elastic, context, 1e6, 0.3);
  mps_material_point point = point_under(m, 1.0);
  double gradient[9] = {0};
#define DRIVE(material, point, gradient, duration, steps, text)                                    \
  FAILS(mps_material_point_drive(context, material, point, gradient, duration, steps),             \
        MPS_ERROR_ARGUMENT, text)
  DRIVE(NULL, &point, gradient, 1.0, 1, "material is NULL");
  DRIVE(m, NULL, gradient, 1.0, 1, "point is NULL");
  DRIVE(m, &point, NULL, 1.0, 1, "gradient is NULL");
  DRIVE(m, &point, gradient, 0.0, 1, "duration is 0 s");
  DRIVE(m, &point, gradient, NAN, 1, "duration is nan");
  DRIVE(m, &point, gradient, 1.0, 0, "steps is 0");
  gradient[4] = INFINITY;
  DRIVE(m, &point, gradient, 1.0, 1, "gradient[4] is inf");
  REFUSES(mps_material_point_init(context, m, NULL), "point is NULL");
  REFUSES(mps_material_point_init(context, NULL, &point), "material is NULL");
  assert_int_equal(mps_material_point_init(NULL, m, &point), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_material_point_drive(NULL, m, &point, gradient, 1.0, 1), MPS_ERROR_ARGUMENT);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static mps_status make_and_destroy(mps_context *on, int what) {
  calls seen = {0};
  scoped_material *m = NULL;
  const mps_material_drucker_prager_def cone = sand();
  const mps_material_user_def user = dashpot_def(&seen);
  const mps_status status = what == 0   ? mps_material_create_linear_elastic(on, 1e6, 0.3, &m)
                            : what == 1 ? mps_material_create_drucker_prager(on, &cone, &m)
                                        : mps_material_create_user(on, &user, &m);
  assert_true((status == MPS_OK) == (m != NULL));
  return status;
}

TEST(refused_memory_leaves_nothing_behind) {
  for (int what = 0; what < 3; what++) test_allocator_sweep(make_and_destroy, what);
}

TEST(a_material_outlives_its_context_and_first_owner) {
  test_allocator allocator = {0};
  mps_context *own = test_allocator_context(&allocator);
  MAKE_KEPT(material, m, create_linear_elastic, own, 1e6, 0.3);
  mps_material *second = mpsi_material_retain(m);
  mps_context_destroy(&own);
  mps_material_destroy(&m);
  assert_null(m);
  assert_string_equal(mps_material_name(second), "linear_elastic");
  const int64_t calls_before = allocator.calls;
  mps_material_point point = point_under(second, 0.0); /* errors go to another context */
  const double gradient[9] = {1e-3, 0, 0, 0, 0, 0, 0, 0, 0};
  OK(mps_material_point_drive(context, second, &point, gradient, 1.0, 100));
  assert_int_equal(allocator.calls, calls_before); /* no allocation in a step */
  mps_material_destroy(&second);
  mps_material_destroy(&second);
  mps_material_destroy(NULL);
  assert_int_equal(allocator.live, 0);
}
