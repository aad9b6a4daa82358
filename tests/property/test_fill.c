/* test_fill.c - fills against geometry: areas and volumes converge, translation by whole spacings
 * moves the sites along, and any order of overlapping fills gives the same sites.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_common.h"

static mps_particles *make_set(mps_context *context, int32_t dim, double spacing) {
  DEF(particles, def, .dim = dim, .spacing = spacing);
  MAKE_KEPT(particles, set, create, context, &def);
  return set;
}

/* The error of an area by counting sites is at most about half a cell along the boundary. */
TEST_SERIAL(the_area_of_a_polygon_converges) {
  enum { CORNERS = 14 };
  double xy[2 * CORNERS], area = 0.0, length = 0.0;
  for (int k = 0; k < CORNERS; k++) { /* a star of seven points, not symmetric to the lattice */
    const double angle = 0.3 + 2 * PI * k / CORNERS, r = k % 2 ? 1.3 : 3.1;
    xy[2 * k] = 17.0 + r * cos(angle);
    xy[2 * k + 1] = -5.0 + r * sin(angle);
  }
  for (int k = 0; k < CORNERS; k++) {
    const double *a = &xy[2 * k], *b = &xy[2 * ((k + 1) % CORNERS)];
    area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    length += hypot(b[0] - a[0], b[1] - a[1]);
  }
  double last = 0.0;
  for (int level = 0; level < 6; level++) {
    const double d = 0.2 * pow(0.5, level);
    scoped_particles *set = make_set(context, 2, d);
    int64_t added;
    OK(mps_particles_fill_polygon(set, CORNERS, xy, &added));
    last = fabs((double)added * d * d - area);
    NEAR((double)added * d * d, area, 0.5 * length * d);
  }
  assert_true(last < 1e-3 * area);
}

TEST_SERIAL(disc_and_ball_have_their_area_and_volume) {
  const double centre[3] = {0.013, -0.21, 0.37}, r = 1.7;
  for (int32_t dim = 2; dim <= 3; dim++)
    for (int level = 0; level < 4; level++) {
      const double d = 0.1 * pow(0.6, level);
      const double exact = dim == 2 ? PI * r * r : 4.0 / 3.0 * PI * r * r * r;
      const double surface = dim == 2 ? 2 * PI * r : 4 * PI * r * r;
      scoped_particles *set = make_set(context, dim, d);
      int64_t added;
      OK(mps_particles_fill_ball(set, centre, r, &added));
      /* far below half a cell along the surface: errors of a curved one cancel */
      NEAR((double)added * pow(d, dim), exact, 0.15 * surface * d);
      mps_view x = view_field(set, "position");
      for (int64_t i = 0; i < added; i++) {
        double square = 0.0;
        for (int32_t c = 0; c < dim; c++) square += pow(*mps_view_f64(&x, i, c) - centre[c], 2);
        assert_true(square < r * r);
      }
    }
}

/* Overlapping shapes number `which`. */
static int64_t fill_shape(mps_particles *set, int which) {
  const double lo[2] = {-3.0, -2.0}, hi[2] = {2.5, 4.0}, centre[2] = {1.0, 1.0};
  const double kite[] = {-6, 0, 0, -5, 7, 1, 1.5, 6};
  int64_t added = -1;
  if (which == 0) OK(mps_particles_fill_box(set, lo, hi, &added));
  if (which == 1) OK(mps_particles_fill_ball(set, centre, 3.9, &added));
  if (which == 2) OK(mps_particles_fill_polygon(set, 4, kite, &added));
  return added;
}

static int compare_points(const void *a, const void *b) {
  const double *p = a, *q = b;
  if (p[1] != q[1]) return p[1] < q[1] ? -1 : 1;
  return p[0] < q[0] ? -1 : p[0] > q[0];
}

/* All sites of a set, sorted; to be freed. */
static double *sorted_sites(mps_particles *set) {
  mps_view x = view_field(set, "position");
  double *points = malloc((size_t)x.shape[0] * 2 * sizeof *points);
  assert_non_null(points);
  for (int64_t i = 0; i < x.shape[0]; i++)
    for (int c = 0; c < 2; c++) points[2 * i + c] = *mps_view_f64(&x, i, c);
  qsort(points, (size_t)x.shape[0], 2 * sizeof *points, compare_points);
  return points;
}

TEST(overlapping_fills_give_the_same_sites_in_any_order) {
  static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                   {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  double *first = NULL;
  int64_t count = 0;
  for (int o = 0; o < 6; o++) {
    scoped_particles *set = make_set(context, 2, 0.1);
    int64_t sum = 0;
    for (int k = 0; k < 3; k++) sum += fill_shape(set, orders[o][k]);
    assert_int_equal(sum, mps_particles_count(set));
    for (int k = 0; k < 3; k++) assert_int_equal(fill_shape(set, k), 0);
    double *points = sorted_sites(set);
    for (int64_t i = 1; i < sum; i++)
      assert_true(compare_points(points + 2 * i - 2, points + 2 * i) < 0); /* none twice */
    if (o == 0) {
      first = points;
      count = sum;
    } else {
      assert_int_equal(sum, count);
      assert_memory_equal(points, first, (size_t)sum * 2 * sizeof *points);
      free(points);
    }
  }
  assert_true(count > 5000);
  free(first);
}
