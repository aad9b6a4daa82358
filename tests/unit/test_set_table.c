/* test_set_table.c - fields from a table of points: the nearest point's value and the linear fit,
 * places outside the points, refusals.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/random.h"
#include "test_allocator.h"
#include "test_fixture.h"

enum { POINTS = 500 };

/* A block of lattice sites on [lo, hi]^dim. */
static mps_particles *block(mps_context *own, int32_t dim, double spacing, double lo, double hi) {
  DEF(particles, def, .dim = dim, .spacing = spacing);
  MAKE_KEPT(particles, set, create, own, &def);
  OK(mps_particles_fill_box(set, AT(lo, lo, lo), AT(hi, hi, hi), NULL));
  return set;
}

/* A linear field, another for each component. */
static double linear(int c, const double *x, int dim) {
  double value = -3e4 - 1e3 * c;
  for (int a = 0; a < dim; a++) value += (1e4 + 3e3 * c - 7e3 * a) * x[a];
  return value;
}

static void scatter(int dim, int count, double *x, double *values, int components) {
  uint64_t seed = 7;
  for (int k = 0; k < count * dim; k++) x[k] = random_part(&seed);
  for (int k = 0; k < count; k++)
    for (int c = 0; c < components; c++) values[k * components + c] = linear(c, x + k * dim, dim);
}

static mps_table_def by_linear(void) {
  DEF(table, def, .interpolation = MPS_TABLE_INTERPOLATION_LINEAR);
  return def;
}

/* Largest error of the stress against the linear field, Pa. */
static double stress_error(mps_particles *set) {
  const int dim = mps_particles_dim(set);
  const mps_view x = view_field(set, "position"), s = view_field(set, "stress");
  double error = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    double at[3] = {0.0};
    for (int c = 0; c < dim; c++) at[c] = *mps_view_f64(&x, k, c);
    for (int c = 0; c < 2 * dim; c++)
      error = fmax(error, fabs(*mps_view_f64(&s, k, c) - linear(c, at, dim)));
  }
  return error;
}

TEST(a_linear_field_is_exact) {
  static double x[3 * POINTS], values[6 * POINTS];
  const mps_table_def def = by_linear();
  for (int32_t dim = 2; dim <= 3; dim++) {
    int64_t outside = -1;
    scoped_particles *set = block(context, dim, 0.05, 0.25, 0.75);
    scatter(dim, POINTS, x, values, 2 * dim);
    OK(mps_particles_set_table(set, "stress", POINTS, x, 2 * dim, values, &def, &outside));
    assert_int_equal(outside, 0);
    assert_true(stress_error(set) < 1e-12 * 5e4);
  }
}

/* Gauss points of flat elements, 40 times longer than high: the nearest lie in one column. */
TEST(flat_elements_are_exact_too) {
  double x[2 * POINTS], values[4 * POINTS];
  int64_t outside = -1;
  const mps_table_def def = by_linear();
  for (int k = 0; k < POINTS; k++) {
    x[2 * k] = (double)(k / 100) * 0.4, x[2 * k + 1] = (double)(k % 100) * 0.01;
    for (int c = 0; c < 4; c++) values[4 * k + c] = linear(c, x + 2 * k, 2);
  }
  scoped_particles *set = block(context, 2, 0.05, 0.0, 0.95);
  OK(mps_particles_set_table(set, "stress", POINTS, x, 4, values, &def, &outside));
  assert_int_equal(outside, 0);
  assert_true(stress_error(set) < 1e-11 * 5e4);
}

TEST(a_smooth_field_converges) {
  double error[2] = {0.0, 0.0};
  for (int level = 0; level < 2; level++) {
    const int n = level == 0 ? 11 : 41, count = n * n;
    double *x = calloc((size_t)(3 * count), sizeof *x), *p = x + 2 * count;
    const mps_table_def def = by_linear();
    for (int k = 0; k < count; k++) {
      x[2 * k] = (double)(k % n) / (n - 1), x[2 * k + 1] = (double)(k / n) / (n - 1);
      p[k] = sin(3.0 * x[2 * k]) * cos(2.0 * x[2 * k + 1]);
    }
    scoped_particles *set = block(context, 2, 0.03, 0.0, 1.0);
    OK(mps_particles_set_table(set, "pore_pressure", count, x, 1, p, &def, NULL));
    const mps_view at = view_field(set, "position"), found = view_field(set, "pore_pressure");
    for (int64_t k = 0; k < at.shape[0]; k++) {
      const double exact =
          sin(3.0 * *mps_view_f64(&at, k, 0)) * cos(2.0 * *mps_view_f64(&at, k, 1));
      error[level] = fmax(error[level], fabs(*mps_view_f64(&found, k, 0) - exact));
    }
    free(x);
  }
  print_message("smooth field, spacing 1/10 and 1/40: errors %.3g, %.3g\n", error[0], error[1]);
  assert_true(error[1] < error[0] / 10.0); /* second order: 16 */
}

static int64_t nearest_of(const double *x, int dim, int count, const double *at) {
  int64_t best = -1;
  double least = INFINITY;
  for (int k = 0; k < count; k++) {
    double square = 0.0;
    for (int c = 0; c < dim; c++) square += (x[k * dim + c] - at[c]) * (x[k * dim + c] - at[c]);
    if (square < least) least = square, best = k;
  }
  return best;
}

/* Random points, and points on a lattice with many equally near ones; the field of a user. */
TEST(the_nearest_point_is_found) {
  static double x[3 * POINTS], values[6 * POINTS], number[POINTS];
  for (int k = 0; k < POINTS; k++) number[k] = k;
  for (int32_t dim = 2; dim <= 3; dim++)
    for (int lattice = 0; lattice < 2; lattice++) {
      int64_t outside = -1;
      scoped_particles *set = block(context, dim, 0.125, -0.5, 1.5);
      scatter(dim, POINTS, x, values, 2 * dim);
      for (int k = 0; lattice && k < POINTS * dim; k++) x[k] = floor(8.0 * x[k]) / 8.0;
      OK(mps_particles_add_field(set, "user.number", 1));
      OK(mps_particles_set_table(set, "user.number", POINTS, x, 1, number, NULL, &outside));
      assert_int_equal(outside, 0);
      const mps_view at = view_field(set, "position"), found = view_field(set, "user.number");
      for (int64_t k = 0; k < at.shape[0]; k++) {
        double place[3] = {0.0};
        for (int c = 0; c < dim; c++) place[c] = *mps_view_f64(&at, k, c);
        assert_int_equal((int64_t)*mps_view_f64(&found, k, 0), nearest_of(x, dim, POINTS, place));
      }
    }
}

/* A column of points, as of a borehole: linear along it, level across; and one point alone. */
TEST(a_column_of_points_is_a_profile) {
  const double x[] = {3.0, 0.0, 3.0, 0.25, 3.0, 1.0}, p[] = {100.0, 75.0, 0.0}, one[] = {0.1, 0.2};
  const mps_table_def def = by_linear();
  int64_t outside = -1;
  scoped_particles *set = block(context, 2, 0.1, 0.0, 1.0);
  OK(mps_particles_set_table(set, "pore_pressure", 3, x, 1, p, &def, &outside));
  assert_int_equal(outside, 0);
  const mps_view at = view_field(set, "position"), found = view_field(set, "pore_pressure");
  for (int64_t k = 0; k < at.shape[0]; k++)
    NEAR(*mps_view_f64(&found, k, 0), 100.0 * (1.0 - *mps_view_f64(&at, k, 1)), 1e-10);
  OK(mps_particles_set_table(set, "pore_pressure", 1, one, 1, p, &def, NULL));
  for (int64_t k = 0; k < at.shape[0]; k++) NEAR(*mps_view_f64(&found, k, 0), 100.0, 1e-12);
}

/* Points on [0.2, 0.8]^2, particles on the unit square. */
TEST(particles_outside_are_counted) {
  double x[2 * 49], p[49];
  for (int k = 0; k < 49; k++) {
    x[2 * k] = 0.2 + 0.1 * (k % 7), x[2 * k + 1] = 0.2 + 0.1 * (k / 7);
    p[k] = 10.0 * x[2 * k];
  }
  mps_table_def def = by_linear();
  int64_t outside = -1, beyond = 0;
  scoped_particles *set = block(context, 2, 0.1, 0.0, 1.0);
  OK(mps_particles_set_table(set, "pore_pressure", 49, x, 1, p, &def, &outside));
  const mps_view at = view_field(set, "position"), found = view_field(set, "pore_pressure");
  for (int64_t k = 0; k < at.shape[0]; k++) {
    const double place[2] = {*mps_view_f64(&at, k, 0), *mps_view_f64(&at, k, 1)};
    const bool inside = fabs(place[0] - 0.5) < 0.3 && fabs(place[1] - 0.5) < 0.3;
    beyond += !inside;
    NEAR(*mps_view_f64(&found, k, 0), inside ? 10.0 * place[0] : p[nearest_of(x, 2, 49, place)],
         1e-12);
  }
  assert_int_equal(beyond, 64); /* of 100: 36 sites lie within */
  assert_int_equal(outside, beyond);
  def.extrapolate = 1, def.reach = 0.3;
  outside = -1;
  OK(mps_particles_set_table(set, "pore_pressure", 49, x, 1, p, &def, &outside));
  assert_int_equal(outside, beyond);
  for (int64_t k = 0; k < at.shape[0]; k++)
    NEAR(*mps_view_f64(&found, k, 0), 10.0 * *mps_view_f64(&at, k, 0), 1e-11);
  def.reach = 0.2; /* the corner's site is 0.15 sqrt 2 away */
  REFUSES(mps_particles_set_table(set, "pore_pressure", 49, x, 1, p, &def, NULL),
          "particle 0 is 0.212132 m from the nearest of positions, reach is 0.2 m");
}

/* At a point its own value, of points at one place their mean; between points no new extremes. */
TEST(points_keep_their_values) {
  static double x[2 * POINTS], values[4 * POINTS], p[POINTS + 1];
  uint64_t seed = 3;
  const double middle[2] = {0.5, 0.5};
  const mps_table_def def = by_linear();
  scatter(2, POINTS, x, values, 4);
  for (int k = 0; k < POINTS; k++) p[k] = floor(2.0 * random_part(&seed));
  x[0] = x[2] = x[1] = x[3] = 0.5, p[0] = 0.0, p[1] = 1.0;
  scoped_particles *set = block(context, 2, 0.02, 0.0, 1.0);
  OK(mps_particles_append(set, 1, middle));
  OK(mps_particles_append(set, POINTS - 2, x + 4));
  OK(mps_particles_set_table(set, "pore_pressure", POINTS, x, 1, p, &def, NULL));
  const mps_view found = view_field(set, "pore_pressure");
  const int64_t first = found.shape[0] - (POINTS - 2);
  NEAR(*mps_view_f64(&found, first - 1, 0), 0.5, 1e-6);
  for (int k = 2; k < POINTS; k++) NEAR(*mps_view_f64(&found, first + k - 2, 0), p[k], 1e-6);
  for (int64_t k = 0; k < first; k++)
    assert_true(*mps_view_f64(&found, k, 0) >= 0.0 && *mps_view_f64(&found, k, 0) <= 1.0);
}

/* The value of a particle depends on its place alone: not on the others of the set, as on ranks,
 * nor on the threads. */
TEST(neither_other_particles_nor_threads_matter) {
  static double x[2 * POINTS], values[4 * POINTS];
  scoped_context *four = test_context(MPS_CONTEXT_EXECUTOR_OPENMP, 4);
  const mps_table_def def = by_linear();
  scoped_particles *whole = block(context, 2, 0.02, -0.2, 1.2),
                   *part = block(four, 2, 0.02, -0.2, 0.7);
  scatter(2, POINTS, x, values, 4);
  OK(mps_particles_set_table(whole, "stress", POINTS, x, 4, values, &def, NULL));
  OK(mps_particles_set_table(part, "stress", POINTS, x, 4, values, &def, NULL));
  const mps_view all = view_field(whole, "stress"), place = view_field(part, "position");
  mps_view some = view_field(part, "stress");
  for (int64_t k = 0; k < some.shape[0]; k++) {
    const double at[2] = {*mps_view_f64(&place, k, 0), *mps_view_f64(&place, k, 1)};
    const int64_t same = mps_particles_index(whole, mps_particles_nearest(whole, at));
    for (int c = 0; c < 4; c++)
      assert_true(*mps_view_f64(&some, k, c) == *mps_view_f64(&all, same, c));
  }
}

TEST(refusals_change_nothing) {
  scoped_particles *set = block(context, 2, 0.25, 0.0, 1.0);
  mps_view view;
#define REFUSED(change, status, text)                                                              \
  do {                                                                                             \
    double x[8] = {0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0}, v[16] = {0.0}, *places = x;            \
    double *values = v;                                                                            \
    const char *field = "stress";                                                                  \
    int64_t count = 4, outside = -5;                                                               \
    int32_t components = 4;                                                                        \
    mps_table_def def = by_linear();                                                               \
    change;                                                                                        \
    FAILS_ON(                                                                                      \
        context,                                                                                   \
        mps_particles_set_table(set, field, count, places, components, values, &def, &outside),    \
        status, text);                                                                             \
    assert_int_equal(outside, -5);                                                                 \
    assert_int_equal(mps_particles_view(set, "stress", &view), MPS_ERROR_FIELD);                   \
    assert_int_equal(mps_particles_view(set, "density", &view), MPS_ERROR_FIELD);                  \
  } while (0)
  REFUSED(count = 0, MPS_ERROR_ARGUMENT, "count is 0, must be 1 to 2^31");
  REFUSED(count = -1, MPS_ERROR_ARGUMENT, "count is -1");
  REFUSED(places = NULL, MPS_ERROR_ARGUMENT, "positions is NULL");
  REFUSED(values = NULL, MPS_ERROR_ARGUMENT, "values is NULL");
  REFUSED(field = NULL, MPS_ERROR_ARGUMENT, "field is NULL");
  REFUSED(field = "nothing", MPS_ERROR_FIELD, "nothing");
  REFUSED((field = "id", components = 1), MPS_ERROR_FIELD, "field 'id' is of int64");
  REFUSED(components = 6, MPS_ERROR_FIELD, "components is 6, field 'stress' has 4");
  REFUSED(components = 0, MPS_ERROR_FIELD, "components is 0");
  REFUSED(x[5] = NAN, MPS_ERROR_ARGUMENT, "positions: point 2 has y = nan m");
  REFUSED(x[6] = -1e16, MPS_ERROR_ARGUMENT, "positions: point 3 has x = -1e+16 m");
  REFUSED(v[7] = INFINITY, MPS_ERROR_ARGUMENT, "values: component 3 of point 1 is inf");
  REFUSED(def.reach = 0.1, MPS_ERROR_ARGUMENT, "particle 0 is 0.176777 m from");
  REFUSED((field = "density", components = 1, v[0] = v[1] = v[2] = v[3] = -1.0), MPS_ERROR_ARGUMENT,
          "field 'density' of particle 0 is -1");
  assert_int_equal(mps_particles_set_table(NULL, "stress", 0, NULL, 4, NULL, NULL, NULL),
                   MPS_ERROR_ARGUMENT);
  const double x[2] = {0.0, 0.0}, v[4] = {-1.0, -2.0, -3.0, -4.0};
  OK(mps_particles_add_field(set, "stress", 0));
  EDIT(edit, set, "stress")
    FAILS(mps_particles_set_table(set, "stress", 1, x, 4, v, NULL, NULL), MPS_ERROR_STATE,
          "being edited");
  OK(mps_particles_set_table(set, "stress", 1, x, 4, v, NULL, NULL));
}

/* Most points on one line and a few far from it: no 256 points near the line have a plane. */
TEST(points_near_a_line_are_refused) {
  static double x[2 * POINTS], p[POINTS];
  mps_table_def def = by_linear();
  for (int k = 0; k < POINTS; k++) x[2 * k] = k / (double)POINTS, p[k] = 1.0;
  x[2 * POINTS - 1] = 50.0;
  scoped_particles *set = block(context, 2, 0.25, 0.0, 1.0);
  REFUSES(mps_particles_set_table(set, "pore_pressure", POINTS, x, 1, p, &def, NULL),
          "the 256 points nearest to particle 0 lie too near a line");
  def.interpolation = MPS_TABLE_INTERPOLATION_NEAREST;
  OK(mps_particles_set_table(set, "pore_pressure", POINTS, x, 1, p, &def, NULL));
}

static mps_status set_and_destroy(mps_context *own, int what) {
  const double x[8] = {0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0}, v[4] = {1.0, 2.0, 3.0, 4.0};
  mps_table_def how = by_linear();
  scoped_particles *set = NULL;
  how.interpolation = what;
  DEF(particles, def, .spacing = 0.25);
  mps_status status = mps_particles_create(own, &def, &set);
  if (status == MPS_OK) status = mps_particles_fill_box(set, AT(0.0, 0.0), AT(1.0, 1.0), NULL);
  if (status == MPS_OK)
    status = mps_particles_set_table(set, "pore_pressure", 4, x, 1, v, &how, NULL);
  return status;
}

TEST(refused_memory_leaves_nothing_behind) {
  test_allocator_sweep(set_and_destroy, MPS_TABLE_INTERPOLATION_NEAREST);
  test_allocator_sweep(set_and_destroy, MPS_TABLE_INTERPOLATION_LINEAR);
}
