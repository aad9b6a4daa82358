/* test_body.c - distance to rigid bodies against brute force: the least distance to points strewn
 * along the surface, the sign by winding, the normal by differences, concave corners.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/random.h"
#include "test_fixture.h"

/* A pile with an inner step, a star and a thin wedge: concave, and with sharp corners. */
static const double pile[] = {0.0, 0.0, 0.2, 0.0, 0.2, 1.0, 0.9, 1.0,
                              0.9, 1.2, 0.2, 1.2, 0.2, 2.0, 0.0, 2.0};
static const double star[] = {1.0,  0.0, 0.3,  0.3,  0.0, 1.0,  -0.3, 0.3,
                              -1.0, 0.0, -0.3, -0.3, 0.0, -1.0, 0.3,  -0.3};
static const double wedge[] = {0.0, 0.0, 3.0, 0.1, 3.0, 0.3};

static const struct {
  int64_t n;
  const double *xy;
} shapes[] = {{8, pile}, {8, star}, {3, wedge}};

enum { SHAPES = 3, POINTS = 400, STREWN = 4000 };

static void reversed_corners(int64_t n, const double *xy, double *out) {
  for (int64_t k = 0; k < n; k++)
    out[2 * k] = xy[2 * (n - 1 - k)], out[2 * k + 1] = xy[2 * (n - 1 - k) + 1];
}

static mps_body *make_body(int shape, bool reverse, const mps_body_def *def) {
  double turned[32];
  const double *xy = shapes[shape].xy;
  if (reverse) reversed_corners(shapes[shape].n, xy, turned);
  MAKE_KEPT(body, body, create_polygon, context, def, shapes[shape].n, reverse ? turned : xy);
  return body;
}

/* Angle (rad) that the closed polygon turns around x: 0 outside, 2 pi inside. */
static double winding(int64_t n, const double *xy, const double *x) {
  double sum = 0.0;
  for (int64_t k = 0; k < n; k++) {
    const double *a = xy + 2 * k, *b = xy + 2 * ((k + 1) % n);
    const double ax = a[0] - x[0], ay = a[1] - x[1], bx = b[0] - x[0], by = b[1] - x[1];
    sum += atan2(ax * by - ay * bx, ax * bx + ay * by);
  }
  return sum;
}

TEST(distance_is_the_least) {
  for (int shape = 0; shape < SHAPES; shape++) {
    const int64_t n = shapes[shape].n;
    const double *xy = shapes[shape].xy;
    scoped_body *body = make_body(shape, false, NULL), *other = make_body(shape, true, NULL);
    for (int p = 0; p < POINTS; p++) {
      const double x[] = {uniform(-1.5, 3.5), uniform(-1.5, 2.5)};
      double d, e, normal[2], foot[2], least = INFINITY;
      int64_t edge, back;
      OK(mps_body_distance(body, 1, x, &d, normal, foot, &edge));
      OK(mps_body_distance(other, 1, x, &e, NULL, NULL, &back));
      NEAR(e, d, 1e-14);
      for (int64_t k = 0; k < n; k++)
        for (int s = 0; s <= STREWN; s++) {
          const double t = (double)s / STREWN, *a = xy + 2 * k, *b = xy + 2 * ((k + 1) % n);
          least =
              fmin(least, hypot(a[0] + t * (b[0] - a[0]) - x[0], a[1] + t * (b[1] - a[1]) - x[1]));
        }
      assert_true(fabs(d) <= least + 1e-12);
      assert_true(fabs(d) >= least - 3.0 / STREWN);
      assert_int_equal(d<0.0, winding(n, xy, x)> 3.0);
      /* foot and normal belong together */
      for (int c = 0; c < 2; c++) NEAR(foot[c] + d * normal[c], x[c], 1e-13);
      NEAR(hypot(normal[0], normal[1]), 1.0, 1e-14);
      /* the foot lies on the edge named, in the caller's numbering */
      const double *a = xy + 2 * edge, *b = xy + 2 * ((edge + 1) % n);
      const double length = hypot(b[0] - a[0], b[1] - a[1]);
      const double along =
          hypot(foot[0] - a[0], foot[1] - a[1]) + hypot(foot[0] - b[0], foot[1] - b[1]);
      NEAR(along, length, 1e-12);
      /* edge k of the reversed list runs between the same corners as edge n - 2 - k */
      const int64_t same = (2 * n - 2 - back) % n;
      const double *c0 = xy + 2 * same, *c1 = xy + 2 * ((same + 1) % n);
      NEAR(hypot(foot[0] - c0[0], foot[1] - c0[1]) + hypot(foot[0] - c1[0], foot[1] - c1[1]),
           hypot(c1[0] - c0[0], c1[1] - c0[1]), 1e-12);
    }
  }
}

/* Central differences, where both sides have the same feature nearest (else there is a kink). */
static void check_gradient(mps_body *body, const double *x) {
  const double e = 1e-6;
  double d[5], n[10], gradient[2];
  const double around[] = {x[0], x[1], x[0] + e, x[1], x[0] - e,
                           x[1], x[0], x[1] + e, x[0], x[1] - e};
  OK(mps_body_distance(body, 5, around, d, n, NULL, NULL));
  for (int k = 1; k < 5; k++)
    if (n[2 * k] * n[0] + n[2 * k + 1] * n[1] < 0.999 || fabs(d[0]) < 10.0 * e) return;
  gradient[0] = (d[1] - d[2]) / (2.0 * e), gradient[1] = (d[3] - d[4]) / (2.0 * e);
  for (int c = 0; c < 2; c++) NEAR(n[c], gradient[c], 1e-8);
}

TEST(normal_is_the_gradient) {
  DEF(body, def, .position[0] = 0.3, .position[1] = -0.2, .rotation[2] = 0.7);
  mps_body *list[SHAPES + 2];
  for (int k = 0; k < SHAPES; k++) list[k] = make_body(k, k == 1, &def);
  const double normal[] = {1.0, 2.0};
  OK(mps_body_create_disc(context, &def, 0.8, &list[SHAPES]));
  OK(mps_body_create_half_plane(context, &def, normal, &list[SHAPES + 1]));
  for (int k = 0; k < SHAPES + 2; k++) {
    for (int p = 0; p < 20 * POINTS; p++) {
      const double x[] = {uniform(-1.5, 3.5), uniform(-1.5, 2.5)};
      check_gradient(list[k], x);
    }
    mps_body_destroy(&list[k]);
  }
}

TEST(closed_forms) {
  scoped_body *disc = NULL, *plane = NULL;
  DEF(body, def, .position[0] = 1.0, .position[1] = 2.0);
  const double normal[] = {-3.0, 4.0}, centre[] = {1.0, 2.0};
  OK(mps_body_create_disc(context, &def, 0.5, &disc));
  OK(mps_body_create_half_plane(context, &def, normal, &plane));
  for (int p = 0; p < POINTS; p++) {
    const double x[] = {uniform(-3.0, 3.0), uniform(-3.0, 3.0)};
    double d;
    OK(mps_body_distance(disc, 1, x, &d, NULL, NULL, NULL));
    NEAR(d, hypot(x[0] - 1.0, x[1] - 2.0) - 0.5, 1e-14);
    OK(mps_body_distance(plane, 1, x, &d, NULL, NULL, NULL));
    NEAR(d, -0.6 * (x[0] - 1.0) + 0.8 * (x[1] - 2.0), 1e-14);
  }
  double d, n[2];
  OK(mps_body_distance(disc, 1, centre, &d, n, NULL, NULL));
  NEAR(d, -0.5, 0.0);
  NEAR(hypot(n[0], n[1]), 1.0, 0.0);
}

/* On a corner the normal is the mean of the edges', convex or concave; a point on an edge has the
 * distance 0 and the edge's normal. */
TEST(corners) {
  scoped_body *body = make_body(0, false, NULL);
  const double at[] = {0.2, 0.0, 0.2, 1.0, 0.5, 1.0};
  const double expected[] = {sqrt(0.5), -sqrt(0.5), sqrt(0.5), -sqrt(0.5), 0.0, -1.0};
  double d[3], n[6];
  OK(mps_body_distance(body, 3, at, d, n, NULL, NULL));
  for (int k = 0; k < 3; k++) NEAR(d[k], 0.0, 1e-15);
  for (int k = 0; k < 6; k++) NEAR(n[k], expected[k], 1e-14);
  /* outside, on the bisector of a concave corner: both edges are as near */
  const double out[] = {0.3, 0.9};
  OK(mps_body_distance(body, 1, out, d, n, NULL, NULL));
  NEAR(d[0], 0.1, 1e-14);
  NEAR(hypot(n[0], n[1]), 1.0, 1e-14);
  /* inside, the concave corner itself is the foot */
  const double in[] = {0.17, 1.04};
  OK(mps_body_distance(body, 1, in, d, n, NULL, NULL));
  NEAR(d[0], -0.05, 1e-14);
  NEAR(n[0], 0.6, 1e-13);
  NEAR(n[1], -0.8, 1e-13);
}
