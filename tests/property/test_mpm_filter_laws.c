/* test_mpm_filter_laws.c - the filter of mean stresses under laws with columns of their own: a
 * user's law of Drucker-Prager that declares itself frictional, against the library's; sand whose
 * moduli and strengths are fields. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define YOUNG 1e6
#define FRICTION 0.5 /* rad */

/* ---- a user's cone --------------------------------------------------------------------------- */

typedef struct cone {
  double shear, bulk, alpha; /* sqrt(J2) + 3 alpha p = 0, apex at 0, no dilation */
} cone;

enum { OPENING, OTHER, STRAIN, COLUMNS }; /* in any order, with one that is not read */
static const char *const columns[COLUMNS] = {"opening", "other", "plastic_strain"};

static mps_status update(void *user, const mps_material_block *b) {
  const cone *c = user;
  for (int64_t k = 0; k < b->count; k++) {
    const double dxx = b->dt * b->gradient[0][k], dyy = b->dt * b->gradient[4][k];
    const double dxy = 0.5 * b->dt * (b->gradient[1][k] + b->gradient[3][k]), trace = dxx + dyy;
    const double G = 2.0 * c->shear, mean = trace / 3.0;
    double s[4] = {b->stress[0][k] + G * (dxx - mean), b->stress[1][k] + G * (dyy - mean),
                   b->stress[2][k] - G * mean, b->stress[3][k] + G * dxy};
    const double old = (s[0] + s[1] + s[2]) / 3.0, p = old + c->bulk * trace;
    for (int i = 0; i < 3; i++) s[i] -= old;
    const double q = sqrt(0.5 * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) + s[3] * s[3]);
    double *gap = &b->history[OPENING][k];
    const double closed = p + c->bulk * *gap; /* of grains that hold together */
    const double p_new = closed > 0.0 ? 0.0 : closed;
    const double q_new = fmin(q, -3.0 * c->alpha * p_new);
    const double opened = closed > 0.0 ? p / c->bulk : -*gap;
    *gap = fmax(0.0, *gap + opened);
    for (int i = 0; i < 4; i++) b->stress[i][k] = (q > 0.0 ? q_new / q : 1.0) * s[i];
    for (int i = 0; i < 3; i++) b->stress[i][k] += p_new;
    b->history[STRAIN][k] += (q - q_new) / (sqrt(3.0) * c->shear);
    b->volume_ratio[k] *= (1.0 + trace - opened) / (1.0 + trace); /* of the grains, without gaps */
  }
  return MPS_OK;
}

static mps_material_user_def define(cone *c) {
  const double nu = 0.3;
  c->shear = YOUNG / (2.0 * (1.0 + nu)), c->bulk = YOUNG / (3.0 * (1.0 - 2.0 * nu));
  DEF(material_user, def, .update = update, .user = c, .name = "cone", .history = columns,
      .history_count = COLUMNS, .bulk_modulus = c->bulk, .shear_modulus = c->shear,
      .frictional = 1);
  return def;
}

static mps_material *make_users(cone *c, int32_t frictional) {
  mps_material_user_def def = define(c);
  def.frictional = frictional;
  MAKE_KEPT(material, out, create_user, context, &def);
  return out;
}

static mps_material_drucker_prager_def library_cone(void) {
  DEF(material_drucker_prager, law, .young = YOUNG, .poisson = 0.3, .friction = FRICTION,
      .cohesion = 0.0);
  return law;
}

static mps_material *make_library(void) {
  const mps_material_drucker_prager_def law = library_cone();
  MAKE_KEPT(material, out, create_drucker_prager, context, &law);
  return out;
}

/* ---- a block that slumps on the floor -------------------------------------------------------- */

typedef void (*set_up)(mpm_scene *s, void *data);

static mpm_scene slump(mps_material *law, int32_t volumetric, set_up fields, void *data) {
  mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, YOUNG);
  mpm_scene_box(&s, 0.1, 0.0, 0.6, 0.5);
  const double v0[2] = {-0.35, 0.0}, squeeze[4] = {1.0, 0.0, 0.0, -1.0};
  mpm_scene_affine(&s, v0, squeeze);
  mps_material_destroy(&s.material), s.material = law;
  if (fields) fields(&s, data);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.1, .volumetric = volumetric, .lower[1] = 0.0,
        .dt = 2e-4, .gravity[1] = -9.81);
  OK(mps_mpm_step(s.mpm, 500));
  return s;
}

static double apart(mps_material *one, int32_t first, mps_material *other, int32_t second) {
  scoped_mpm_scene a = slump(one, first, NULL, NULL), b = slump(other, second, NULL, NULL);
  return mpm_scene_stress_difference(&a, &b);
}

/* The volume of the grains differs by the third order of a step's strain. */
TEST(a_users_frictional_law_is_filtered) {
  enum { BY_LAW = MPS_MPM_VOLUMETRIC_BY_LAW, POINT = MPS_MPM_VOLUMETRIC_POINT };
  cone c = {.alpha = 0.0};
  const mps_material_drucker_prager_def law = library_cone();
  c.alpha = sin(law.friction) / 3.0; /* the cone of plane strain */
  const double own = apart(make_library(), POINT, make_users(&c, 1), POINT);
  const double filtered = apart(make_library(), BY_LAW, make_users(&c, 1), BY_LAW);
  const double not_so = apart(make_library(), BY_LAW, make_users(&c, 0), BY_LAW);
  const double plain = apart(make_users(&c, 0), BY_LAW, make_users(&c, 0), POINT);
  print_message("stresses apart: unfiltered %.2g, filtered %.2g, one of them %.2g\n", own, filtered,
                not_so);
  assert_true(filtered < 1e-5 && own < 1e-5);
  assert_true(not_so > 1e-2);
  NEAR(plain, 0.0, 0.0);
}

/* ---- fields ---------------------------------------------------------------------------------- */

static void set_factors(mpm_scene *s, void *data) {
  const double *factor = data;
  OK(mps_particles_add_field(s->particles, "stiffness_factor", 1));
  OK(mps_particles_add_field(s->particles, "strength_factor", 1));
  SET_FIELDS(s->particles, {"stiffness_factor", factor[0]}, {"strength_factor", factor[1]});
}

TEST(sand_by_field_is_filtered_as_sand) {
  double factor[2] = {2.0, 3.0};
  mps_material_drucker_prager_def soft = library_cone(), stiff = library_cone();
  mps_material *law = NULL, *by_field = NULL, *whole = NULL;
  soft.young *= 0.5, soft.cohesion = 20.0, stiff.cohesion = 60.0;
  OK(mps_material_create_drucker_prager(context, &soft, &law));
  OK(mps_material_create_by_field(context, law, &by_field));
  OK(mps_material_create_drucker_prager(context, &stiff, &whole));
  mps_material_destroy(&law);
  scoped_mpm_scene a = slump(by_field, MPS_MPM_VOLUMETRIC_BY_LAW, set_factors, factor);
  scoped_mpm_scene b = slump(whole, MPS_MPM_VOLUMETRIC_BY_LAW, NULL, NULL);
  scoped_mpm_scene c = slump(make_library(), MPS_MPM_VOLUMETRIC_POINT, NULL, NULL);
  print_message("by field and whole apart by %.2g\n", mpm_scene_stress_difference(&a, &b));
  assert_true(mpm_scene_stress_difference(&a, &b) < 1e-6);
  assert_true(mpm_scene_stress_difference(&c, &b) > 1e-2);
}

/* ---- bad definitions ------------------------------------------------------------------------- */

static void refuse(const mps_material_user_def *def, const char *words) {
  mps_material *out = NULL;
  assert_int_equal(mps_material_create_user(context, def, &out), MPS_ERROR_ARGUMENT);
  assert_null(out);
  assert_non_null(strstr(mps_context_error(context)->message, words));
}

TEST(a_frictional_law_needs_its_columns) {
  static const char *const others[COLUMNS] = {"opening", "other", "strain"};
  static const char *const closed[COLUMNS] = {"gap", "other", "plastic_strain"};
  cone c = {.alpha = 0.0};
  mps_material_user_def def = define(&c);
  def.history = others;
  refuse(&def, "no column 'plastic_strain'");
  def = define(&c), def.history = closed;
  refuse(&def, "no column 'opening'");
}
