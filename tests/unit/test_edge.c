/* test_edge.c - faces that end before their edges (src/contact/edge.h), against lengths in closed
 * form. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#include "contact/edge.h"

#define INSET 0.06
#define HALF 0.025

static void ends_are(double (*ends)[2], int64_t edge, double first, double second) {
  NEAR(ends[edge][0], first, 1e-14);
  NEAR(ends[edge][1], second, 1e-14);
}

TEST(faces_of_boxes_end_by_the_inset) {
  double ends[4][2];
  MAKE(body, body, create_box, context, NULL, 0.4, 0.1);
  mpsi_edge_insets(body, INSET, false, ends);
  for (int k = 0; k < 4; k++) /* the sides are shorter than two insets */
    ends_are(ends, k, k % 2 == 0 ? INSET : 0.05, k % 2 == 0 ? INSET : 0.05);
}

/* Pointed corners by a ball of the inset's radius; hollow ones not at all. */
TEST(insets_grow_as_corners_are_pointed) {
  const double wedge[6] = {0.0, 0.0, 0.5, sqrt(0.75), -0.5, sqrt(0.75)};
  const double hollow[12] = {0.0, 0.0, 2.0, 0.0, 2.0, 2.0, 1.0, 2.0, 1.0, 1.0, 0.0, 1.0};
  double ends[6][2];
  MAKE(body, sharp, create_polygon, context, NULL, 3, wedge);
  mpsi_edge_insets(sharp, INSET, false, ends);
  for (int k = 0; k < 3; k++) ends_are(ends, k, INSET * sqrt(3.0), INSET * sqrt(3.0));
  MAKE(body, step, create_polygon, context, NULL, 6, hollow);
  mpsi_edge_insets(step, INSET, false, ends);
  ends_are(ends, 2, INSET, INSET);
  ends_are(ends, 3, INSET, 0.0);
  ends_are(ends, 4, 0.0, INSET);
}

/* The corners of a circle of 100 turn by 3.6 degrees, which is none; those of one of 30 by 12: 0.7
 * of the inset. */
TEST(facets_of_curves_have_no_edges) {
  enum { MOST = 100 };
  for (int n = 30; n <= MOST; n += 70) {
    double xy[2 * MOST], ends[MOST][2];
    for (int k = 0; k < n; k++)
      xy[2 * k] = cos(2.0 * PI * k / n), xy[2 * k + 1] = sin(2.0 * PI * k / n);
    MAKE(body, body, create_polygon, context, NULL, n, xy);
    mpsi_edge_insets(body, INSET, false, ends);
    const double wanted = n == 30 ? 0.7 * INSET : 0.0;
    for (int k = 0; k < n; k++) ends_are(ends, k, wanted, wanted);
  }
}

/* On the axis a flat base has no edge and a cone's tip is as wide as its mirror image makes it,
 * whether its section is half or whole. */
TEST(edges_on_the_axis_are_those_of_the_solid) {
  const double R = 0.5, z = 0.5 * sqrt(3.0); /* 60 degrees */
  const double base[8] = {0.0, 0.0, R, 0.0, R, 1.0, 0.0, 1.0};
  const double half[8] = {0.0, 0.0, R, z, R, 3.0, 0.0, 3.0};
  const double whole[10] = {0.0, 0.0, R, z, R, 3.0, -R, 3.0, -R, z};
  const double blunt[10] = {0.0, 0.0, R, R / sqrt(3.0), R, 3.0, -R, 3.0, -R, R / sqrt(3.0)};
  double ends[5][2];
  MAKE(body, foot, create_polygon, context, NULL, 4, base);
  mpsi_edge_insets(foot, INSET, true, ends);
  ends_are(ends, 0, 0.0, INSET);
  MAKE(body, tip, create_polygon, context, NULL, 4, half);
  mpsi_edge_insets(tip, INSET, true, ends);
  ends_are(ends, 0, INSET * sqrt(3.0), INSET);
  MAKE(body, both, create_polygon, context, NULL, 5, whole);
  mpsi_edge_insets(both, INSET, true, ends);
  ends_are(ends, 0, INSET * sqrt(3.0), INSET);
  ends_are(ends, 4, INSET, INSET * sqrt(3.0));
  MAKE(body, flat, create_polygon, context, NULL, 5, blunt); /* 120 degrees: less than the inset */
  mpsi_edge_insets(flat, INSET, true, ends);
  ends_are(ends, 0, INSET / sqrt(3.0), INSET);
}

/* The inset edge of a foot on the base of a box that is turned by `angle`, x from its middle and a
 * quarter of a half spacing below it, clockwise corners or not; along the base it lies at `by` from
 * the foot. */
static mpsi_inset_edge edge_of(double angle, bool clockwise, double x, double *by) {
  const double a = 0.2, xy[8] = {-a, -a, a, -a, a, a, -a, a}, yx[8] = {-a, a, a, a, a, -a, -a, -a};
  const double c = cos(angle), s = sin(angle), y = -a - 0.25 * HALF;
  const double at[2] = {0.3 + c * x - s * y, -0.1 + s * x + c * y};
  double ends[4][2];
  DEF(body, def, .position[0] = 0.3, .position[1] = -0.1, .rotation[2] = angle);
  MAKE(body, body, create_polygon, context, &def, 4, clockwise ? yx : xy);
  mpsi_edge_insets(body, INSET, false, ends);
  const mpsi_foot foot = mpsi_body_foot(body, at);
  const mpsi_inset_edge edge = mpsi_edge_find(body, (const double(*)[2])ends, &foot);
  *by = c * edge.shift[0] + s * edge.shift[1];
  NEAR(-s * edge.shift[0] + c * edge.shift[1], 0.0, 1e-14);
  return edge;
}

TEST(feet_have_the_nearer_inset_edge) {
  const double edge = 0.2 - INSET;
  for (int k = 0; k < 4; k++) {
    const double angle = k < 2 ? 0.0 : 0.7;
    const bool clockwise = k % 2 != 0;
    int32_t point = 0, last = 0;
    double by;
    for (double side = -1.0; side < 2.0; side += 2.0) {
      point = last;
      for (double off = -3.0; off < 1.9; off += 0.33) {
        const mpsi_inset_edge e = edge_of(angle, clockwise, side * (edge + off * HALF), &by);
        NEAR(e.inside, -off * HALF, 1e-14);
        NEAR(by, -side * off * HALF, 1e-14);
        assert_int_equal((e.point - 1) / 2, point > 0 ? (point - 1) / 2 : (e.point - 1) / 2);
        assert_int_not_equal(e.point, side > 0.0 ? point : 0); /* the base's other end */
        last = e.point;
      }
      const mpsi_inset_edge corner = edge_of(angle, clockwise, side * (0.2 + 1e-3 * HALF), &by);
      assert_int_equal(corner.point, 0);
      assert_true(corner.inside < 0.0); /* beyond any inset edge */
    }
  }
}

TEST(feet_without_an_inset_edge_bear) {
  double ends[4][2];
  const double at[2] = {0.01, -0.21};
  MAKE(body, body, create_box, context, NULL, 0.4, 0.4);
  mpsi_edge_insets(body, 0.0, false, ends);
  const mpsi_foot foot = mpsi_body_foot(body, at);
  const mpsi_inset_edge edge = mpsi_edge_find(body, (const double(*)[2])ends, &foot);
  assert_int_equal(edge.point, 0);
  assert_true(edge.inside > 0.0);
}

TEST(insets_are_refused_where_they_are_not_made) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02);
  DEF(body, above, .position[1] = 0.2);
  MAKE(body, box, create_box, context, &above, 0.1, 0.1);
  DEF(contact, both, .corner = 0.01, .inset = 0.01);
  REFUSES(mps_mpm_add_contact(s.mpm, box, &both, NULL), "inset");
  DEF(contact, penalty, .method = MPS_CONTACT_METHOD_PENALTY, .inset = 0.01);
  REFUSES(mps_mpm_add_contact(s.mpm, box, &penalty, NULL), "inset");
  const double low[3] = {0.0, 0.0, 0.0}, high[3] = {0.04, 0.04, 0.04};
  scoped_mpm_scene solid = mpm_scene_begin_in(context, 3, 0.01, 0.0, 0.0, 1e5);
  OK(mps_particles_fill_box(solid.particles, low, high, NULL));
  USING(mpm, mpm_scene_solve(&solid, &given), .geometry = MPS_MPM_GEOMETRY_SPACE, .cell = 0.02);
  MAKE(body, cylinder, create_cylinder, context, &above, 0.05, 0.1);
  DEF(contact, inset, .inset = 0.01);
  REFUSES(mps_mpm_add_contact(solid.mpm, cylinder, &inset, NULL), "rounded by `corner`");
}
