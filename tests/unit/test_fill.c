/* test_fill.c - fills of lattices: exact counts, positions and order, edges, one particle a site,
 * every refusal.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

static mps_particles *make_set(int32_t dim, double spacing, double x0, double y0) {
  const mps_particles_def def = {
      .struct_size = sizeof def, .dim = dim, .spacing = spacing, .origin = {x0, y0, 0.0}};
  MAKE_KEPT(particles, set, create, context, &def);
  return set;
}

static mps_view positions(mps_particles *set) {
  mps_view view = view_field(set, "position");
  return view;
}

static int64_t box(mps_particles *set, double x0, double y0, double x1, double y1) {
  int64_t added = -1;
  OK(mps_particles_fill_box(set, AT(x0, y0), AT(x1, y1), &added));
  return added;
}

TEST(a_box_of_whole_spacings_has_exactly_its_columns) {
  const double spacings[] = {1.0, 0.1, 0.25, 3.2, 1.0 / 3.0, 1e-5, 7e4};
  const double shifts[] = {0.0, 0.3, -123.456, 1e6, -4e7};
  for (int s = 0; s < 7; s++)
    for (int o = 0; o < 5; o++) {
      const double d = spacings[s], x = shifts[o] * d;
      scoped_particles *set = make_set(2, d, x, -x);
      assert_int_equal(box(set, x, -x, x + 10 * d, -x + 7 * d), 70);
      /* bounds through centres: the lower ones are in, the upper ones out */
      assert_int_equal(box(set, x + 20.5 * d, -x + 0.5 * d, x + 30.5 * d, -x + 2.5 * d), 20);
      assert_int_equal(box(set, x - 10 * d, -x - 7 * d, x, -x), 70);
    }
  /* the plain cases, from the origin, bounds as a caller writes them */
  scoped_particles *tenth = make_set(2, 0.1, 0, 0), *quarter = make_set(2, 0.25, 0, 0);
  scoped_particles *odd = make_set(2, 3.2, 0, 0), *one = make_set(2, 1.0, 0, 0);
  assert_int_equal(box(one, 0, 0, 10, 1), 10);
  assert_int_equal(box(tenth, 0, 0, 10, 0.3), 300);
  assert_int_equal(box(quarter, 0, 0, 10, 0.25), 40);
  assert_int_equal(box(odd, 0, 0, 320, 3.2), 100);
  assert_int_equal(box(one, 0.2, 100.2, 0.4, 100.9), 0); /* no centre inside */
}

TEST(a_centre_within_a_billionth_of_a_bound_lies_on_it) {
  for (int o = 0; o < 3; o++) {
    const double d = (const double[]){1.0, 1e-3, 640.0}[o], on = 0.5e-9 * d, off = 2e-9 * d;
    scoped_particles *set = make_set(2, d, 0, 0);
    assert_int_equal(box(set, 0.5 * d + off, 0, d, d), 0);
    assert_int_equal(box(set, 0.5 * d + on, 0, d, d), 1); /* in at lo */
    assert_int_equal(box(set, d, 0, 1.5 * d + on, d), 0); /* out at hi */
    assert_int_equal(box(set, d, 0, 1.5 * d + off, d), 1);
  }
}

TEST(sites_come_x_first_at_exact_positions) {
  const mps_particles_def def = {
      .struct_size = sizeof def, .dim = 3, .spacing = 0.1, .origin = {0.7, -0.2, 5.0}};
  int64_t added;
  MAKE(particles, set, create, context, &def);
  OK(mps_particles_fill_box(set, AT(0.7, -0.4, 5.0), AT(1.1, 0.1, 5.2), &added));
  assert_int_equal(added, 4 * 5 * 2);
  const mps_view x = positions(set);
  for (int64_t n = 0; n < added; n++) {
    const double i = (double)(n % 4), j = (double)(n / 4 % 5 - 2), k = (double)(n / 20);
    assert_true(*mps_view_f64(&x, n, 0) == 0.7 + (i + 0.5) * 0.1);
    assert_true(*mps_view_f64(&x, n, 1) == -0.2 + (j + 0.5) * 0.1);
    assert_true(*mps_view_f64(&x, n, 2) == 5.0 + (k + 0.5) * 0.1);
  }
}

TEST(a_site_is_filled_once_even_when_its_particle_has_moved) {
  scoped_particles *set = make_set(2, 1.0, 0, 0);
  const double diamond[] = {0, -8, 8, 0, 0, 8, -8, 0}, centre[2] = {0, 0};
  int64_t added;
  assert_int_equal(box(set, 0, 0, 10, 10), 100);
  assert_int_equal(box(set, 0, 0, 10, 10), 0);
  assert_int_equal(box(set, 5, 5, 15, 15), 75);
  assert_int_equal(box(set, -5, -5, 20, 20), 25 * 25 - 175);
  EDIT(moved, set, "position") *mps_edit_f64(&moved, 0, 0) = 1e3;
  assert_int_equal(box(set, -5, -5, 20, 20), 0);
  OK(mps_particles_append(set, 1, centre)); /* off the lattice: takes no site */
  assert_int_equal(box(set, 20, 0, 21, 1), 1);
  /* What the box left: the left tip of the diamond, rows of 1, 2, 3, 3, 2, 1 sites, and the lower
   * one, rows of 1, 3, 5: a centre on a left edge is in, on a right edge out. */
  OK(mps_particles_fill_polygon(set, 4, diamond, &added));
  const int64_t polygon = added;
  OK(mps_particles_fill_polygon(set, 4, diamond, &added));
  assert_int_equal(added, 0);
  assert_int_equal(polygon, 12 + 9);
  for (int64_t a = 0; a < mps_particles_count(set); a++) {
    const mps_view x = positions(set);
    for (int64_t b = 0; b < a; b++)
      assert_true(*mps_view_f64(&x, a, 0) != *mps_view_f64(&x, b, 0) ||
                  *mps_view_f64(&x, a, 1) != *mps_view_f64(&x, b, 1));
  }
}

TEST(concave_polygons_have_exact_counts_in_either_sense) {
  const double l_shape[] = {0, 0, 10, 0, 10, 4, 3, 4, 3, 10, 0, 10};
  /* a comb of three teeth: rows above 2 are cut into three runs */
  const double comb[] = {0, 0, 10, 0, 10, 7, 8, 7, 8, 2, 6, 2, 6, 7, 4, 7, 4, 2, 2, 2, 2, 7, 0, 7};
  const double *shapes[] = {l_shape, comb};
  const int64_t corners[] = {6, 12}, sites[] = {10 * 4 + 3 * 6, 10 * 2 + 3 * 2 * 5};
  for (int s = 0; s < 2; s++)
    for (int sense = 0; sense < 2; sense++)
      for (int o = 0; o < 3; o++) {
        const double d = (const double[]){1.0, 0.1, 3.2}[o], x0 = (const double[]){0, -7.3, 1e5}[o];
        double xy[24];
        int64_t added;
        const int64_t n = corners[s];
        for (int64_t k = 0; k < n; k++) {
          const int64_t from = sense ? n - 1 - k : k;
          xy[2 * k] = x0 + d * shapes[s][2 * from];
          xy[2 * k + 1] = d * shapes[s][2 * from + 1];
        }
        scoped_particles *set = make_set(2, d, x0, 0);
        OK(mps_particles_fill_polygon(set, n, xy, &added));
        assert_int_equal(added, sites[s]);
      }
}

/* Centres lie on the slanted edges: in on the left and lower ones, out on the others, so that the
 * two triangles of a square share no site and leave none out. */
TEST(polygons_that_share_an_edge_share_no_site) {
  for (int o = 0; o < 3; o++) {
    const double d = (const double[]){1.0, 0.1, 1.0 / 3.0}[o];
    const double rising[2][6] = {{0, 0, 10 * d, 0, 10 * d, 10 * d},
                                 {0, 0, 10 * d, 10 * d, 0, 10 * d}};
    const double falling[2][6] = {{0, 0, 10 * d, 0, 0, 10 * d},
                                  {10 * d, 0, 10 * d, 10 * d, 0, 10 * d}};
    for (int slope = 0; slope < 2; slope++) {
      scoped_particles *set = make_set(2, d, 0, 0);
      int64_t below, above;
      OK(mps_particles_fill_polygon(set, 3, slope ? rising[0] : falling[0], &below));
      OK(mps_particles_fill_polygon(set, 3, slope ? rising[1] : falling[1], &above));
      assert_int_equal(below, slope ? 55 : 45);
      assert_int_equal(below + above, 100);
      assert_int_equal(box(set, 0, 0, 10 * d, 10 * d), 0);
    }
  }
}

TEST(bad_polygons_are_refused_with_the_edges_named) {
  scoped_particles *set = make_set(2, 1.0, 0, 0), *solid = make_set(3, 1.0, 0, 0);
  const double bow_tie[] = {0, 0, 4, 4, 4, 0, 0, 4}, flat[] = {0, 0, 4, 0, 2, 0};
  const double closed[] = {0, 0, 4, 0, 0, 4, 0, 0}, spike[] = {0, 0, 4, 0, 4, 4, 4, 1, 0, 4};
  const double touching[] = {0, 0, 4, 0, 4, 4, 2, 0, 0, 4}, bad[] = {0, 0, 4, 0, INFINITY, 4};
  const double crossed_again[] = {0, 0, 6, 0, 6, 6, 5, -1, 0, 6};
  const double far[] = {0, 0, 4, 0, 0, 1e300}, huge[] = {-1e5, -1e5, 1e5, -1e5, 0, 1e5};
  const double tall[] = {0, -2e9, 1, -2e9, 0, 2e9};
  REFUSES(mps_particles_fill_polygon(set, 4, bow_tie, NULL),
          "edges 0 and 2 of the polygon intersect");
  REFUSES(mps_particles_fill_polygon(set, 5, crossed_again, NULL), "edges 0 and 2 of");
  REFUSES(mps_particles_fill_polygon(set, 5, touching, NULL), "edges 0 and 2 of");
  REFUSES(mps_particles_fill_polygon(set, 3, flat, NULL),
          "edges 0 and 1 of the polygon lie on each other");
  REFUSES(mps_particles_fill_polygon(set, 5, spike, NULL),
          "edges 1 and 2 of the polygon lie on each other");
  REFUSES(mps_particles_fill_polygon(set, 4, closed, NULL),
          "corners 3 and 0 of the polygon coincide");
  REFUSES(mps_particles_fill_polygon(set, 2, closed, NULL), "vertices is 2");
  REFUSES(mps_particles_fill_polygon(set, INT64_MAX, closed, NULL),
          "vertices is 9223372036854775807"); /* 2 n overflowed */
  REFUSES(mps_particles_fill_polygon(set, 3, NULL, NULL), "xy is NULL");
  REFUSES(mps_particles_fill_polygon(set, 3, bad, NULL), "x = inf");
  REFUSES(mps_particles_fill_polygon(set, 3, far, NULL), "y = 1e+300 m, more than 2^40 spacings");
  REFUSES(mps_particles_fill_polygon(set, 3, huge, NULL), "more than 2^31 sites");
  REFUSES(mps_particles_fill_polygon(set, 3, tall, NULL), "more than 2^31 sites");
  REFUSES(mps_particles_fill_polygon(solid, 3, closed, NULL), "3 dimensions");
  assert_int_equal(mps_particles_fill_polygon(NULL, 3, closed, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_particles_count(set), 0);
}

TEST(bad_boxes_are_refused) {
  scoped_particles *set = make_set(2, 1.0, 0, 0);
  const double zero[2] = {0, 0}, one[2] = {1, 1}, flat[2] = {1, 0}, nan[2] = {0, NAN};
  const double endless[2] = {INFINITY, 1}, far[2] = {1e300, 1}, huge[2] = {1e5, 1e5};
  const uint64_t epoch = mps_particles_epoch(set);
  REFUSES(mps_particles_fill_box(set, NULL, one, NULL), "lo");
  REFUSES(mps_particles_fill_box(set, zero, NULL, NULL), "hi");
  REFUSES(mps_particles_fill_box(set, zero, flat, NULL), "the box in y is [0, 0)");
  REFUSES(mps_particles_fill_box(set, nan, one, NULL), "lo has y = nan");
  REFUSES(mps_particles_fill_box(set, zero, endless, NULL), "hi has x = inf");
  REFUSES(mps_particles_fill_box(set, zero, far, NULL), "2^40 spacings");
  REFUSES(mps_particles_fill_box(set, zero, huge, NULL), "1e+10 sites");
  REFUSES(mps_particles_fill_where(set, zero, one, NULL, NULL, NULL), "inside is NULL");
  REFUSES(mps_particles_fill_ball(set, NULL, 1.0, NULL), "centre is NULL");
  REFUSES(mps_particles_fill_ball(set, nan, 1.0, NULL), "centre has y = nan");
  REFUSES(mps_particles_fill_ball(set, zero, 0.0, NULL), "radius is 0");
  REFUSES(mps_particles_fill_ball(set, zero, NAN, NULL), "radius is nan");
  REFUSES(mps_particles_fill_ball(set, zero, 1e9, NULL), "sites");
  assert_string_equal(mps_context_error(context)->function, "mps_particles_fill_ball");
  assert_int_equal(mps_particles_fill_box(NULL, zero, one, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_particles_fill_where(NULL, zero, one, NULL, NULL, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_particles_fill_ball(NULL, zero, 1.0, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_particles_count(set), 0);
  assert_int_equal(mps_particles_epoch(set), epoch);
}

/* A chequerboard; counts its calls. */
static mps_status dark_field(void *user, const double *x, int32_t *inside) {
  ++*(int *)user;
  *inside = ((int)floor(x[0]) + (int)floor(x[1])) % 2 == 0;
  return MPS_OK;
}

TEST(a_predicate_is_asked_once_for_each_site) {
  scoped_particles *set = make_set(2, 1.0, 0, 0);
  const double lo[2] = {0, 0}, hi[2] = {8, 8};
  int asked = 0;
  int64_t added;
  OK(mps_particles_fill_where(set, lo, hi, dark_field, &asked, &added));
  assert_int_equal(asked, 64);
  assert_int_equal(added, 32);
  assert_int_equal(box(set, 0, 0, 8, 8), 32); /* the light fields */
}

/* Refuses the eleventh site. */
static mps_status eleven(void *user, const double *x, int32_t *inside) {
  *inside = 1;
  return ++*(int *)user > 10 ? MPS_ERROR_UNSUPPORTED : MPS_OK;
}

TEST(a_predicate_that_refuses_adds_nothing) {
  scoped_particles *set = make_set(2, 1.0, 0, 0);
  const double lo[2] = {0, 0}, hi[2] = {8, 8};
  int asked = 0;
  const uint64_t epoch = mps_particles_epoch(set);
  FAILS(mps_particles_fill_where(set, lo, hi, eleven, &asked, NULL), MPS_ERROR_UNSUPPORTED,
        "the predicate of the fill returned status");
  assert_int_equal(asked, 11);
  assert_int_equal(mps_particles_count(set), 0);
  assert_int_equal(mps_particles_epoch(set), epoch);
  assert_int_equal(box(set, 0, 0, 8, 8), 64);
}

TEST(balls_are_symmetric_and_open) {
  for (int32_t dim = 2; dim <= 3; dim++) {
    scoped_particles *set = make_set(dim, 0.1, 0, 0);
    /* About a centre of the lattice: sites at the radius itself (5 D; also 3-4-5) are out. Gauss'
     * circle and sphere counts for i^2 + j^2 (+ k^2) < 25. */
    const double centre[3] = {0.05, 0.05, 0.05};
    int64_t added, expected = 0;
    for (int i = -5; i <= 5; i++)
      for (int j = -5; j <= 5; j++)
        for (int k = dim == 3 ? -5 : 0; k <= (dim == 3 ? 5 : 0); k++)
          expected += i * i + j * j + k * k < 25;
    OK(mps_particles_fill_ball(set, centre, 0.5, &added));
    assert_int_equal(added, expected);
    assert_int_equal(expected, dim == 2 ? 69 : 485);
  }
}
