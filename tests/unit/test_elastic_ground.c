/* test_elastic_ground.c - what the body of implicit elasticity is made of: materials in place of
 * fields, weight functions, particles removed; and a creation that fails changes nothing.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/operator/budget.h"
#include "implicit/operator/moduli.h"
#include "digest.h"
#include "elastic_common.h"
#include "test_fixture.h"

/* A block of columns x rows cells of 0.5 m; `bare`: no field says what it is made of. */
static mps_particles *block(mps_context *own, int dim, int columns, int rows, bool bare) {
  DEF(particles, def, .spacing = 0.5, .dim = dim);
  MAKE_KEPT(particles, set, create, own, &def);
  OK(mps_particles_fill_box(set, AT(0.0, 0.0, 0.0), AT(0.5 * columns, 0.5 * rows, 1.0), NULL));
  OK(mps_particles_set(set, "density", 0, 2000.0));
  if (bare) return set;
  SET_FIELDS(set, {"young", 1e7}, {"poisson", 0.25});
  return set;
}

static mps_elastic *solver_of(mps_particles *set, mps_material *material, mps_kernel *kernel) {
  DEF(elastic, def, .material = material, .kernel = kernel);
  MAKE_KEPT(elastic, e, create, context, set, &def);
  return e;
}

/* Ids of the particles with lo <= x[axis] <= hi; the caller frees. */
static int64_t *between(mps_particles *set, int axis, double lo, double hi, int64_t *count) {
  double low[3] = {-1e9, -1e9, -1e9}, high[3] = {1e9, 1e9, 1e9};
  const int64_t n = mps_particles_count(set);
  int64_t *ids = malloc((size_t)n * sizeof *ids);
  if (!ids) abort();
  low[axis] = lo, high[axis] = hi;
  OK(mps_particles_select_box(set, low, high, n, count, ids));
  return ids;
}

/* Holds the foot, pushes the left side sideways and the whole body down. */
static void load(mps_elastic *e) {
  mps_particles *set = mps_elastic_particles(e);
  const int dim = mps_particles_dim(set);
  mps_elastic_boundary_def foot = mps_elastic_boundary_defaults();
  for (int c = 0; c < dim; c++) foot.lower[c] = -INFINITY, foot.upper[c] = INFINITY;
  foot.upper[1] = 0.5;
  OK(mps_elastic_add_boundary(e, &foot, NULL));
  DEF(elastic_load, def, .kind = MPS_ELASTIC_LOAD_BODY, .all = 1, .force[1] = -9.81);
  OK(mps_elastic_add_load(e, &def, NULL));
  int64_t facets[512], count;
  OK(mps_elastic_select_facets(e, MPS_SIDE_X_LOWER, NULL, NULL, 512, &count, facets));
  def = mps_elastic_load_defaults();
  def.kind = MPS_ELASTIC_LOAD_PRESSURE;
  def.ids = facets;
  def.id_count = count;
  def.force[0] = 1e4;
  OK(mps_elastic_add_load(e, &def, NULL));
}

static double value_of(mps_particles *set, const char *name, int64_t at, int64_t c) {
  mps_view v = view_field(set, name);
  return *mps_view_f64(&v, at, c);
}

/* Displacements of particles at the same places, in the set's own orders. */
static void assert_same_displacements(mps_particles *a, mps_particles *b, double tolerance) {
  const int dim = mps_particles_dim(a);
  double most = 0.0;
  int64_t met = 0;
  assert_int_equal(mps_particles_count(a), mps_particles_count(b));
  for (int64_t i = 0; i < mps_particles_count(a); i++)
    for (int64_t j = 0; j < mps_particles_count(b); j++) {
      bool same = true;
      for (int c = 0; c < dim; c++)
        same = same && value_of(a, "position", i, c) == value_of(b, "position", j, c);
      for (int c = 0; c < dim && same; c++) {
        NEAR(value_of(a, "displacement", i, c), value_of(b, "displacement", j, c), tolerance);
        most = fmax(most, fabs(value_of(a, "displacement", i, c)));
      }
      met += same;
    }
  assert_int_equal(met, mps_particles_count(a));
  assert_true(most > 1e3 * tolerance);
}

/* ---- material -------------------------------------------------------------------------------- */

TEST(a_material_is_what_its_fields_would_be) {
  mps_material *clay = NULL, *rock = NULL;
  int64_t count;
  OK(mps_material_create_linear_elastic(context, 1e7, 0.25, &clay));
  OK(mps_material_create_linear_elastic(context, 9e7, 0.1, &rock));
  scoped_particles *by_law = block(context, 2, 6, 6, true),
                   *by_field = block(context, 2, 6, 6, false);
  scoped_elastic *a = solver_of(by_law, clay, NULL);
  mps_material_destroy(&clay); /* the solver has its share */
  int64_t *ids = between(by_law, 1, 0.0, 1.0, &count);
  OK(mps_elastic_set_material(a, rock, ids, count));
  EDIT(young, by_field, "young")
    EDIT(poisson, by_field, "poisson")
      for (int64_t k = 0; k < count; k++) {
        *mps_edit_f64(&young, mps_particles_index(by_field, ids[k]), 0) = 9e7;
        *mps_edit_f64(&poisson, mps_particles_index(by_field, ids[k]), 0) = 0.1;
      }
  scoped_elastic *b = solver_of(by_field, NULL, NULL);
  load(a);
  load(b);
  OK(mps_elastic_solve(a));
  OK(mps_elastic_solve(b));
  assert_same_displacements(by_law, by_field, 1e-15);
  mps_elastic_def def;
  OK(mps_elastic_get_def(a, &def));
  assert_string_equal(mps_material_name(def.material), "linear_elastic");
  free(ids);
  mps_material_destroy(&rock);
}

TEST(materials_that_do_not_fit_are_refused) {
  DEF(material_von_mises, def, .young = 1e9, .yield_stress = 1e6);
  scoped_material *metal = NULL, *rubber = NULL;
  OK(mps_material_create_von_mises(context, &def, &metal));
  OK(mps_material_create_linear_elastic(context, 1e6, 0.4, &rubber));
  scoped_particles *set = block(context, 2, 4, 4, true);
  mps_elastic_def made = mps_elastic_defaults();
  scoped_elastic *e = NULL;
  const int32_t fields = mps_particles_field_count(set);
  FAILS(mps_elastic_create(context, set, &made, &e), MPS_ERROR_FIELD, "young");
  made.material = metal;
  FAILS(mps_elastic_create(context, set, &made, &e), MPS_ERROR_UNSUPPORTED, "the law is von_mises");
  assert_int_equal(mps_particles_field_count(set), fields);
  e = solver_of(set, rubber, NULL);
  const int64_t ids[2] = {1, 16};
  FAILS(mps_elastic_set_material(e, metal, NULL, 0), MPS_ERROR_UNSUPPORTED, "von_mises");
  REFUSES(mps_elastic_set_material(e, rubber, ids, 2), "ids[1] is 16");
  REFUSES(mps_elastic_set_material(e, NULL, NULL, 0), "material is NULL");
  NEAR(value_of(set, "young", 1, 0), 1e6, 1e-9);
  assert_int_equal(mps_elastic_set_material(NULL, rubber, NULL, 0), MPS_ERROR_ARGUMENT);
}

/* ---- weight functions ------------------------------------------------------------------------ */

TEST(the_default_weight_is_that_of_a_handle) {
  MAKE(kernel, w, create, context, MPS_KERNEL_MPS, 0.75);
  scoped_particles *a = block(context, 2, 7, 5, false), *b = block(context, 2, 7, 5, false);
  scoped_elastic *plain = solver_of(a, NULL, NULL), *with = solver_of(b, NULL, w);
  load(plain);
  load(with);
  OK(mps_elastic_solve(plain));
  OK(mps_elastic_solve(with));
  assert_same_displacements(a, b, 1e-16);
}

/* Uniform stress is exact for every weight: a bar under its end's traction, nu = 0.25, plane
 * stress, held along one side only. */
TEST(uniform_stress_is_exact_for_every_weight) {
  static const struct {
    int32_t kind;
    double radius; /* spacings */
  } weights[] = {{MPS_KERNEL_MPS, 3.1},
                 {MPS_KERNEL_SPLINE2, 1.5},
                 {MPS_KERNEL_SPLINE3, 2.0},
                 {MPS_KERNEL_SPLINE3, 3.3}};
  for (size_t k = 0; k < sizeof weights / sizeof *weights; k++) {
    int64_t facets[64], count;
    MAKE(kernel, w, create, context, weights[k].kind, 0.5 * weights[k].radius);
    scoped_particles *set = block(context, 2, 9, 4, false);
    scoped_elastic *e = solver_of(set, NULL, w);
    int64_t *left = between(set, 0, 0.0, 0.5, &count), corner[1];
    corner[0] = left[0];
    OK(test_prescribe(e, 0, count, left, NULL));
    OK(test_prescribe(e, 1, 1, corner, NULL));
    OK(mps_elastic_cut(e, MPS_SIDE_X_LOWER, left, count));
    const double traction[2] = {1e5, 0.0};
    OK(mps_elastic_select_facets(e, MPS_SIDE_X_UPPER, NULL, NULL, 64, &count, facets));
    OK(test_traction(e, count, facets, traction));
    OK(mps_elastic_solve(e));
    for (int64_t i = 0; i < mps_particles_count(set); i++) {
      const double x = value_of(set, "position", i, 0) - 0.25;
      NEAR(value_of(set, "displacement", i, 0), 1e-2 * x, 1e-13);
    }
    free(left);
  }
  mps_elastic_def def = mps_elastic_defaults();
  mps_elastic *e = NULL;
  scoped_particles *set = block(context, 2, 4, 4, false);
  OK(mps_kernel_create(context, MPS_KERNEL_MPS, 0.5, &def.kernel));
  REFUSES(mps_elastic_create(context, set, &def, &e), "radius of influence is 0.5 m");
  mps_kernel_destroy(&def.kernel);
}

/* ---- removal --------------------------------------------------------------------------------- */

/* The top row, or a corner, of a loaded block is dug away: the next solution is that of a new
 * solver on what is left; in two and three dimensions, with joints of materials. */
TEST(an_excavation_is_a_new_solver_on_what_is_left) {
  for (int what = 0; what < 4; what++) {
    const int dim = what % 2 ? 3 : 2;
    int64_t count, of_rock;
    MAKE(material, rock, create_linear_elastic, context, 8e7, 0.2);
    scoped_particles *set = block(context, dim, 6, 6, false);
    int64_t *top = between(set, 1, what < 2 ? 2.6 : 1.6, 3.0, &count), kept = 0;
    for (int64_t k = 0; k < count && what >= 2; k++) /* a corner */
      if (value_of(set, "position", mps_particles_index(set, top[k]), 0) > 1.0)
        top[kept++] = top[k];
    if (what >= 2) count = kept;
    mps_elastic *e = solver_of(set, NULL, NULL), *fresh = NULL;
    int64_t *low = between(set, 1, 0.0, 1.0, &of_rock);
    OK(mps_elastic_set_material(e, rock, low, of_rock));
    load(e);
    OK(mps_elastic_solve(e));
    const int64_t facets = mps_elastic_facet_count(e), n = mps_particles_count(set);
    OK(mps_particles_remove(set, top, count));
    assert_int_equal(mps_particles_count(set), n - count);
    OK(mps_elastic_solve(e));
    /* the same body from the start; its left side has the remaining pressure */
    scoped_particles *rest = block(context, dim, 6, 6, false);
    OK(mps_particles_remove(rest, top, count));
    fresh = solver_of(rest, NULL, NULL);
    OK(mps_elastic_set_material(fresh, rock, low, of_rock));
    load(fresh);
    if (what < 2) assert_int_equal(mps_elastic_facet_count(fresh), mps_elastic_facet_count(e));
    OK(mps_elastic_solve(fresh));
    if (what < 2) assert_true(mps_elastic_facet_count(e) != facets);
    if (what < 2) assert_same_displacements(set, rest, 1e-15);
    if (what >= 2) { /* where new facets face left, only the fresh solver has loaded them */
      mps_reaction r;
      OK(mps_elastic_get_reaction(e, 0, &r));
      mps_totals t;
      OK(mps_elastic_get_totals(e, &t));
      double mass = 0.0;
      mass = (double)mps_particles_count(set) * pow(0.5, dim) * 2000.0;
      NEAR(r.force[1], mass * 9.81, 1e-8 * mass);
    }
    mps_elastic_destroy(&e);
    mps_elastic_destroy(&fresh);
    free(top);
    free(low);
  }
}

TEST(a_motion_ends_with_a_removal) {
  scoped_particles *set = block(context, 2, 6, 6, false);
  scoped_elastic *e = solver_of(set, NULL, NULL);
  DEF(elastic_motion, motion, .dt = 1e-3);
  int64_t count;
  int64_t *top = between(set, 1, 2.6, 3.0, &count);
  load(e);
  OK(mps_elastic_start(e, &motion));
  OK(mps_elastic_step(e, 3));
  OK(mps_particles_remove(set, top, count));
  FAILS(mps_elastic_step(e, 1), MPS_ERROR_STATE, "no motion under way");
  const double u = value_of(set, "displacement", 20, 0);
  assert_true(u != 0.0);
  OK(mps_elastic_start(e, &motion)); /* continues from the fields */
  NEAR(value_of(set, "displacement", 20, 0), u, 0.0);
  OK(mps_elastic_step(e, 3));
  free(top);
}

/* What a motion shows after some steps: a digest of all fields, totals, the foot's reaction. */
typedef struct outcome {
  uint64_t fields;
  mps_totals totals;
  mps_reaction foot;
} outcome;

static outcome outcome_of(mps_elastic *e) {
  static const char *const names[] = {
      "id", "position", "displacement", "velocity", "acceleration", "reaction", NULL};
  outcome o;
  memset(&o, 0, sizeof o);
  OK(mps_elastic_step(e, 4));
  o.fields = digest_fields(mps_elastic_particles(e), names);
  OK(mps_elastic_get_totals(e, &o.totals));
  OK(mps_elastic_get_reaction(e, 0, &o.foot));
  return o;
}

/* Back and forth across a removal of particles that are held, loaded and of another material; with
 * and without a motion begun anew in between. */
TEST(a_rollback_brings_back_what_was_dug_away) {
  for (int dim = 2; dim <= 3; dim++) {
    scoped_particles *set = block(context, dim, 6, 6, false);
    scoped_elastic *e = solver_of(set, NULL, NULL);
    mps_snapshot *whole = NULL, *dug = NULL;
    int64_t count, of_rock, kept = 0;
    MAKE(material, rock, create_linear_elastic, context, 8e7, 0.2);
    int64_t *low = between(set, 1, 0.0, 1.0, &of_rock), *side = between(set, 0, 0.0, 1.0, &count);
    OK(mps_elastic_set_material(e, rock, low, of_rock));
    for (int64_t k = 0; k < count; k++) /* a corner at the foot: held, loaded, of rock */
      if (value_of(set, "position", mps_particles_index(set, side[k]), 1) < 1.0)
        side[kept++] = side[k];
    DEF(elastic_motion, motion, .dt = 1e-3, .stiffness_damping = 1e-4);
    load(e);
    OK(mps_elastic_start(e, &motion));
    OK(mps_elastic_step(e, 3));
    OK(mps_elastic_snapshot(e, &whole));
    const outcome first = outcome_of(e);
    OK(mps_elastic_rollback(e, whole));
    OK(mps_particles_remove(set, side, kept));
    OK(mps_elastic_rollback(e, whole)); /* the motion had ended */
    const outcome again = outcome_of(e);
    assert_memory_equal(&again, &first, sizeof first);
    OK(mps_particles_remove(set, side, kept));
    OK(mps_elastic_start(e, &motion));
    OK(mps_elastic_snapshot(e, &dug));
    const outcome second = outcome_of(e);
    for (int pass = 0; pass < 2; pass++) {
      OK(mps_elastic_rollback(e, whole));
      outcome now = outcome_of(e);
      assert_memory_equal(&now, &first, sizeof now);
      OK(mps_elastic_rollback(e, dug));
      now = outcome_of(e);
      assert_memory_equal(&now, &second, sizeof now);
    }
    assert_true(first.foot.count > second.foot.count);
    mps_snapshot_destroy(&whole);
    mps_snapshot_destroy(&dug);
    free(low);
    free(side);
  }
}

TEST(removals_that_cannot_be_are_refused) {
  scoped_particles *set = block(context, 2, 4, 4, false), *twin = block(context, 2, 4, 4, false);
  scoped_elastic *e = solver_of(set, NULL, NULL), *other = solver_of(twin, NULL, NULL);
  load(e);
  load(other);
  int64_t count;
  int64_t *three = between(set, 1, 0.6, 2.0, &count);
  const double x[2] = {9.25, 9.25};
  REFUSES(mps_particles_remove(set, three, count), "one particle thick along y");
  FAILS(mps_particles_append(set, 1, x), MPS_ERROR_STATE, "takes no more particles");
  int64_t all[16];
  for (int k = 0; k < 16; k++) all[k] = k;
  REFUSES(mps_particles_remove(set, all, 16), "all 16 particles of the solver");
  OK(mps_elastic_solve(e));
  OK(mps_elastic_solve(other));
  assert_same_displacements(set, twin, 1e-16);
  free(three);
}
