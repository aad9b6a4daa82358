/* test_material_laws.c - laws as the solvers see them: one descriptor for each, a user's law and a
 * UMAT in place of a built-in one, values that are not finite, statuses that are none.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"

#include "core/context/levels.h"
#include "material/material_private.h"

#define E 1e6
#define NU 0.3

/* ---- descriptors ----------------------------------------------------------------------------- */

TEST_SERIAL(each_kind_has_its_descriptor) {
  static const int32_t levels[] = {MPSI_ALL_LEVELS(MPSI_LEVEL_VALUE, , )};
  for (int kind = 0; kind < MPSI_LAW_COUNT; kind++) {
    const mpsi_law_type *type = &mpsi_law_types[kind];
    assert_int_equal((int)type->kind, kind);
    assert_non_null(type->define);
    int columns = 0;
    while (type->columns[columns]) columns++;
    assert_true(columns <= MPSI_MATERIAL_COLUMNS);
    assert_true(!(type->traits & MPSI_LAW_OPENS) ||
                (columns >= 2 && strcmp(type->columns[1], "opening") == 0));
    for (size_t level = 0; level < sizeof levels / sizeof *levels; level++)
      for (int geometry = 0; geometry < MPSI_GEOMETRIES; geometry++) {
        const mpsi_law_table *table = mpsi_laws_select(levels[level]);
        if (table) assert_non_null(table->apply[kind][geometry]);
      }
  }
}

/* ---- a user's law in place of a built-in one ------------------------------------------------- */

typedef struct hooke {
  double shear, bulk, lambda;
} hooke;

static mps_status by_user(void *user, const mps_material_block *b) {
  const hooke *law = user;
  for (int64_t k = 0; k < b->count; k++) {
    const double xx = b->dt * b->gradient[0][k], yy = b->dt * b->gradient[4][k];
    const double xy = 0.5 * b->dt * (b->gradient[1][k] + b->gradient[3][k]);
    const double mean = law->lambda * (xx + yy), g2 = 2.0 * law->shear;
    b->stress[0][k] += mean + g2 * xx;
    b->stress[1][k] += mean + g2 * yy;
    b->stress[2][k] += mean;
    b->stress[3][k] += g2 * xy;
  }
  return MPS_OK;
}

static MPS_MATERIAL_UMAT(by_umat) {
  MPS_MATERIAL_UMAT_UNUSED;
  const double mean = props[1] * (dstran[0] + dstran[1] + dstran[2]);
  for (int c = 0; c < *ntens; c++)
    stress[c] += c < *ndi ? mean + 2.0 * props[0] * dstran[c] : props[0] * dstran[c];
}

enum { BUILT_IN, USER, UMAT, UNSTATED, WAYS };

static mps_material *make(mps_context *context, int way, hooke *law) {
  mps_material *built_in = NULL, *out = NULL;
  mps_moduli m;
  OK(mps_material_create_linear_elastic(context, E, NU, &built_in));
  OK(mps_material_get_moduli(built_in, 1.0, &m));
  *law = (hooke){m.shear, m.bulk, m.lambda};
  if (way == BUILT_IN) return built_in;
  mps_material_destroy(&built_in);
  if (way == UMAT) {
    const double props[] = {m.shear, m.lambda};
    USING(material_umat, mps_material_create_umat(context, &given, &out), .umat = by_umat,
          .props = props, .props_count = 2, .bulk_modulus = m.bulk, .shear_modulus = m.shear);
    return out;
  }
  DEF(material_user, def, .update = by_user, .user = law);
  if (way == USER)
    def.bulk_modulus = m.bulk, def.shear_modulus = m.shear;
  else
    def.wave_modulus = m.wave;
  OK(mps_material_create_user(context, &def, &out));
  return out;
}

enum { ACROSS = 16, COUNT = ACROSS * ACROSS };
typedef struct result {
  double x[COUNT][2], v[COUNT][2], s[COUNT][4], time;
} result;

/* A block thrown into a wedge of a rigid body; V0 is a power of two, so that V0 (V/V0), which the
 * solver keeps of laws that read V/V0, is V in all its bits. */
static void throw_block(mps_context *context, int way, result *out) {
  const double spacing = 1.0 / 64.0;
  hooke law;
  scoped_mpm_scene s = mpm_scene_begin_in(context, 2, spacing, 0.0, 0.0, E);
  mps_material_destroy(&s.material);
  s.material = make(context, way, &law);
  mpm_scene_box(&s, 0.25, 0.25, 0.5, 0.5);
  const double down[] = {0.4, -3.0}, none[4] = {0.0};
  mpm_scene_affine(&s, down, none);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 2.0 * spacing, .upper[0] = given.upper[1] = 1.0,
        .lower[0] = given.lower[1] = -0.5);
  const mps_body_def ground = mps_body_defaults();
  const double wedge[] = {0.0, 0.0, 0.75, 0.0, 0.75, 0.22, 0.0, 0.25};
  MAKE(body, body, create_polygon, context, &ground, 4, wedge);
  mpm_scene_contact(&s, body, 0.4);
  OK(mps_mpm_step(s.mpm, 120));
  mps_view id = mpm_scene_view(&s, "id");
  mps_view x = mpm_scene_view(&s, "position"), v = mpm_scene_view(&s, "velocity");
  mps_view stress = mpm_scene_view(&s, "stress");
  assert_int_equal(id.shape[0], COUNT);
  for (int64_t k = 0; k < COUNT; k++) {
    const int64_t i = *mps_view_i64(&id, k, 0);
    for (int c = 0; c < 2; c++) {
      out->x[i][c] = *mps_view_f64(&x, k, c);
      out->v[i][c] = *mps_view_f64(&v, k, c);
    }
    for (int c = 0; c < 4; c++) out->s[i][c] = *mps_view_f64(&stress, k, c);
  }
  out->time = mps_mpm_time(s.mpm);
}

TEST(a_users_law_equals_the_built_in_one) {
  static result results[WAYS];
  scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  for (int way = 0; way < WAYS; way++) throw_block(context, way, &results[way]);
  double most = 0.0;
  for (int k = 0; k < COUNT; k++) most = fmax(most, -results[0].s[k][1]);
  assert_true(most > 0.005 * E); /* the size of particles depends on their strain */
  assert_memory_equal(&results[USER], &results[BUILT_IN], sizeof(result));
  assert_memory_equal(&results[UMAT], &results[BUILT_IN], sizeof(result));
  /* without the moduli nu is 1/4, and other sizes are in contact */
  assert_memory_not_equal(&results[UNSTATED], &results[BUILT_IN], sizeof(result));
}

TEST_SERIAL(moduli_of_users_laws_are_checked) {
  mps_material_user_def def = mps_material_user_defaults();
  mps_material_umat_def umat = mps_material_umat_defaults();
  scoped_material *material = NULL;
  mps_moduli m;
  def.update = by_user, umat.umat = by_umat;
  def.bulk_modulus = umat.bulk_modulus = 1e6;
  def.shear_modulus = umat.shear_modulus = 3e5;
  def.wave_modulus = umat.wave_modulus = 1.3e6;
  REFUSES(mps_material_create_user(context, &def, &material),
          "at least K + 4G/3 of its moduli, 1.4e+06 Pa");
  REFUSES(mps_material_create_umat(context, &umat, &material),
          "at least K + 4G/3 of its moduli, 1.4e+06 Pa");
  def.bulk_modulus = 1e6, def.shear_modulus = 3e5, def.wave_modulus = NAN;
  OK(mps_material_create_user(context, &def, &material));
  NEAR(mps_material_wave_modulus(material), 1.4e6, 1e-8);
  OK(mps_material_get_moduli(material, 2e3, &m));
  NEAR(m.shear, 3e5, 0.0);
  mps_material_destroy(&material);
  def.wave_modulus = 5e6; /* of a stiffer state, for the step */
  OK(mps_material_create_user(context, &def, &material));
  NEAR(mps_material_wave_modulus(material), 5e6, 0.0);
  NEAR(mpsi_material_rest_modulus(material), 1.4e6, 1e-8);
  mps_material_destroy(&material);
  def.bulk_modulus = def.shear_modulus = NAN;
  OK(mps_material_create_user(context, &def, &material));
  assert_int_equal(mps_material_get_moduli(material, 2e3, &m), MPS_ERROR_UNSUPPORTED);
}

/* ---- constants ------------------------------------------------------------------------------ */

/* Of the numbers that ranks compare, how many differ between two materials. */
static void expect_other_constants(const mps_material *a, mps_material **b, int32_t differing) {
  mpsi_given first = MPSI_GIVEN, second = MPSI_GIVEN;
  int32_t other = 0;
  mpsi_material_give(&first, a);
  mpsi_material_give(&second, *b);
  assert_int_equal(first.count, second.count);
  for (int32_t k = 0; k < first.count; k++) other += !(first.value[k] == second.value[k]);
  assert_int_equal(other, differing);
  mps_material_destroy(b);
}

TEST_SERIAL(constants_tell_materials_apart) {
  mps_material *a = NULL, *b = NULL;
  DEF(material_von_mises, mises, .young = E, .yield_stress = 1e3);
  OK(mps_material_create_von_mises(context, &mises, &a));
  OK(mps_material_create_von_mises(context, &mises, &b));
  expect_other_constants(a, &b, 0);
  mises.hardening = 10.0;
  OK(mps_material_create_von_mises(context, &mises, &b));
  expect_other_constants(a, &b, 1);
  mps_material_destroy(&a);
  double props[] = {1.0, 2.0};
  DEF(material_umat, umat, .umat = by_umat, .wave_modulus = E, .props = props, .props_count = 2);
  OK(mps_material_create_umat(context, &umat, &a));
  OK(mps_material_create_umat(context, &umat, &b));
  expect_other_constants(a, &b, 0);
  props[1] = 3.0, umat.temperature = 20.0;
  OK(mps_material_create_umat(context, &umat, &b));
  expect_other_constants(a, &b, 1); /* one hash of them */
  mps_material_destroy(&a);
  DEF(material_small_strain, soil, .shear_modulus = 1e7, .reference_strain = 1e-4);
  OK(mps_material_create_small_strain(context, &soil, &a));
  OK(mps_material_create_small_strain(context, &soil, &b));
  expect_other_constants(a, &b, 0);
  soil.reference_strain = 2e-4; /* the layers' strengths, and not their moduli */
  OK(mps_material_create_small_strain(context, &soil, &b));
  expect_other_constants(a, &b, 1);
  mps_material_destroy(&a);
  DEF(material_cyclic_sand, sand, .young = 1e7, .friction = 0.6, .relative_density = 0.5);
  OK(mps_material_create_cyclic_sand(context, &sand, &a));
  OK(mps_material_create_cyclic_sand(context, &sand, &b));
  expect_other_constants(a, &b, 0);
  sand.relative_density = 0.6; /* C1 and C2 */
  OK(mps_material_create_cyclic_sand(context, &sand, &b));
  expect_other_constants(a, &b, 2);
  mps_material_destroy(&a);
}

/* ---- values that are not finite -------------------------------------------------------------- */

typedef struct spoil {
  int64_t id;   /* of the particle */
  int32_t what; /* 0..3: a component of stress; 4: its history; 5: V/V0 */
  double value, from;
} spoil;

static mps_status spoiling(void *user, const mps_material_block *b) {
  const spoil *s = user;
  for (int64_t k = 0; k < b->count; k++) {
    for (int c = 0; c < 4; c++) b->stress[c][k] -= 1.0;
    b->history[0][k] += 1.0;
    if (b->time <= s->from || (b->ids && b->ids[k] != s->id)) continue;
    *(s->what < 4    ? &b->stress[s->what][k]
      : s->what == 4 ? &b->history[0][k]
                     : &b->volume_ratio[k]) = s->value;
  }
  return MPS_OK;
}

static mps_material *make_spoiling(mps_context *context, spoil *s) {
  static const char *const names[] = {"age"};
  DEF(material_user, def, .update = spoiling, .user = s, .name = "mud", .history_count = 1,
      .history = names, .bulk_modulus = 1e5, .shear_modulus = 1e4);
  MAKE_KEPT(material, out, create_user, context, &def);
  return out;
}

TEST(a_law_that_yields_no_number_is_an_error) {
  static const spoil spoils[] = {
      {17, 0, NAN, 0.0}, {23, 3, INFINITY, 0.0}, {5, 4, -INFINITY, 0.0}, {5, 5, 0.0, 0.0}};
  static const char *const texts[] = {
      "the law 'mud' has refused particle 17: stress[0] is nan",
      "the law 'mud' has refused particle 23: stress[3] is inf",
      "the law 'mud' has refused particle 5: history[0] is -inf",
      "the law 'mud' has refused particle 5: volume_ratio is 0, must be finite and > 0"};
  for (int k = 0; k < 4; k++)
    for (int32_t volumetric = 0; volumetric <= MPS_MPM_VOLUMETRIC_NODES; volumetric++) {
      scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
      spoil s = spoils[k];
      scoped_mpm_scene scene = mpm_scene_begin_in(context, 2, 0.01, 0.0, 0.0, E);
      mps_material_destroy(&scene.material);
      s.from = 0.02;
      scene.material = make_spoiling(context, &s);
      mpm_scene_box(&scene, 0.1, 0.1, 0.2, 0.2);
      USING(mpm, mpm_scene_solve(&scene, &given), .cell = 0.02, .volumetric = volumetric);
      mps_status status = MPS_OK;
      double before[100][4], time = 0.0;
      for (int step = 0; step < 100 && status == MPS_OK; step++) {
        mps_view stress = mpm_scene_view(&scene, "stress");
        for (int64_t p = 0; p < 100; p++)
          for (int c = 0; c < 4; c++) before[p][c] = *mps_view_f64(&stress, p, c);
        time = mps_mpm_time(scene.mpm);
        status = mps_mpm_step(scene.mpm, 1);
      }
      FAILS(status, MPS_ERROR_NUMERIC, texts[k]);
      NEAR(mps_mpm_time(scene.mpm), time, 0.0);
      mps_view stress = mpm_scene_view(&scene, "stress");
      for (int64_t p = 0; p < 100; p++)
        for (int c = 0; c < 4; c++) assert_true(*mps_view_f64(&stress, p, c) == before[p][c]);
    }
}

/* A fluid whose volume vanishes or turns over in a step, and a user's law that fails, at a point.
 */
TEST_SERIAL(a_point_keeps_its_state) {
  DEF(material_newtonian, water, .bulk_modulus = 2e6);
  spoil s = {-1, 2, NAN, 0.5};
  scoped_material *fluid = NULL, *mud = make_spoiling(context, &s);
  OK(mps_material_create_newtonian(context, &water, &fluid));
  mps_material_point point, before;
  OK(mps_material_point_init(context, fluid, &point));
  before = point;
  const double vanish[9] = {-1.0}, turn[9] = {-3.0};
  FAILS(mps_material_point_drive(context, fluid, &point, vanish, 1.0, 1), MPS_ERROR_NUMERIC,
        "the law 'newtonian' has refused a block of particles: volume_ratio is 0");
  assert_memory_equal(&point, &before, sizeof point);
  FAILS(mps_material_point_drive(context, fluid, &point, turn, 1.0, 1), MPS_ERROR_NUMERIC,
        "volume_ratio is -2");
  assert_memory_equal(&point, &before, sizeof point);
  OK(mps_material_point_drive(context, fluid, &point, vanish, 0.5, 10));
  OK(mps_material_point_init(context, mud, &point));
  before = point;
  const double rest[9] = {0.0};
  FAILS(mps_material_point_drive(context, mud, &point, rest, 1.0, 10), MPS_ERROR_NUMERIC,
        "stress[2] is nan, must be finite");
  assert_memory_equal(&point, &before, sizeof point);
}

/* ---- statuses that are none ------------------------------------------------------------------ */

static mps_status odd_stress(void *user, const double *x, double *stress) {
  return (mps_status) * (const int *)user;
}
static mps_status odd_level(void *user, const double *x, double *level) {
  return (mps_status) * (const int *)user;
}

TEST_SERIAL(a_status_that_is_none_is_an_argument) {
  static const int odd[] = {-7, 4711};
  static const char *const texts[] = {"it returned status -7 (unknown status code)",
                                      "it returned status 4711 (unknown status code)"};
  scoped_mpm_scene s = mpm_scene_begin_in(context, 2, 0.1, 0.0, 0.0, E);
  mpm_scene_box(&s, 0.0, 0.0, 1.0, 1.0);
  const mps_geostatic_layer layer = {.thickness = 10.0, .k0 = 0.5, .density = 2e3};
  for (int k = 0; k < 2; k++) {
    int status = odd[k];
    REFUSES(mps_particles_set_stress(s.particles, odd_stress, &status), texts[k]);
    DEF(geostatic, def, .layers = &layer, .layer_count = 1, .gravity = 10.0,
        .surface_level = odd_level, .user = &status);
    REFUSES(mps_particles_set_geostatic(s.particles, &def), texts[k]);
  }
}
