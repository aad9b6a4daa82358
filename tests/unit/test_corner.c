/* test_corner.c - corners as seen by particles (src/contact/corner.h), against the distances of
 * rounded boxes and wedges in closed form.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "contact/corner.h"

static uint64_t seed;

/* Even in -1 to 1. */
static double random_number(void) {
  seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (double)(seed >> 11) * 0x1p-52 - 1.0;
}

static mpsi_bearing bearing_of(const mps_body *body, double radius, const double *x, double half) {
  const mpsi_foot own = mpsi_body_foot(body, x);
  return mpsi_corner_bearing(body, radius, x, half, &own);
}

/* Distance of a box with the half sides b from x outside it, all its edges rounded. */
static double rounded_box(int dim, const double *b, double radius, const double *x) {
  double square = 0.0;
  for (int a = 0; a < dim; a++) {
    const double off = fmax(0.0, fabs(x[a]) - (b[a] - radius));
    square += off * off;
  }
  return sqrt(square) - radius;
}

/* A particle large enough that no corner lets it into the box itself. */
static void compare_with_box(const mps_body *body, int dim, const double *b, double radius) {
  const double half = 2.0 * radius, eps = 1e-6 * radius;
  int at_corners = 0;
  for (int n = 0; n < 2000; n++) {
    double x[3] = {0.0}, slope[3];
    for (int a = 0; a < dim; a++) {
      const double side = random_number() < 0.0 ? -1.0 : 1.0;
      x[a] = side * (b[a] + (1.2 * random_number() - 0.4) * radius);
    }
    const mpsi_foot own = mpsi_body_foot(body, x);
    if (!(own.distance > 0.01 * radius)) continue;
    const mpsi_bearing found = bearing_of(body, radius, x, half);
    const double wanted = rounded_box(dim, b, radius, x);
    NEAR(found.foot.distance, wanted, 1e-12);
    NEAR(found.half, half, 0.0);
    NEAR(found.outside, own.distance, 0.0);
    for (int a = 0; a < dim; a++) {
      double to[3] = {x[0], x[1], x[2]};
      to[a] += eps;
      slope[a] = (rounded_box(dim, b, radius, to) - wanted) / eps;
      NEAR(found.foot.normal[a], slope[a], 2e-5);
      NEAR(found.foot.at[a], x[a] - wanted * found.foot.normal[a], 1e-12);
    }
    at_corners += wanted > own.distance + 1e-9;
  }
  assert_true(at_corners > 100);
}

TEST(boxes_are_rounded) {
  const double plane[2] = {0.3, 0.2};
  MAKE(body, body, create_box, context, NULL, 0.6, 0.4);
  for (double radius = 0.01; radius < 0.11; radius += 0.03)
    compare_with_box(body, 2, plane, radius);
}

/* A cube of twelve triangles: edges and corners of three faces. */
TEST(edges_in_space_are_rounded) {
  static const int32_t corner[36] = {0, 3, 1, 0, 2, 3, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                     2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  const double sides[3] = {0.25, 0.25, 0.25};
  double xyz[24];
  scoped_body *body = NULL;
  for (int k = 0; k < 8; k++)
    for (int a = 0; a < 3; a++) xyz[3 * k + a] = k >> a & 1 ? 0.25 : -0.25;
  const mps_status status = mps_body_create_mesh(context, NULL, 8, xyz, 12, corner, &body);
  if (status == MPS_ERROR_UNSUPPORTED) return;
  OK(status);
  compare_with_box(body, 3, sides, 0.05);
}

/* The rim of a cylinder is that of a box in the plane through its axis. */
TEST(rims_are_rounded) {
  const double section[2] = {0.3, 0.2}, radius = 0.04;
  MAKE(body, body, create_cylinder, context, NULL, 0.3, 0.4);
  for (int n = 0; n < 500; n++) {
    const double angle = PI * random_number(), z = 0.23 * random_number();
    const double r = 0.26 + 0.07 * random_number(), rz[2] = {r, z};
    const double x[3] = {r * cos(angle), r * sin(angle), z};
    if (!(mpsi_body_foot(body, x).distance > 1e-4)) continue;
    NEAR(bearing_of(body, radius, x, 0.08).foot.distance, rounded_box(2, section, radius, rz),
         1e-12);
  }
}

/* Below a wedge of 60 degrees the ball ends radius/sin 30 above the tip: rounding would let the
 * particle in, which is in contact with the wedge itself at a quarter of its half size. */
TEST(tips_keep_particles_out) {
  const double xy[6] = {0.0, 0.0, 0.5, 0.5 * sqrt(3.0), -0.5, 0.5 * sqrt(3.0)};
  const double radius = 0.02, x[3] = {0.0, -0.004, 0.0};
  MAKE(body, body, create_polygon, context, NULL, 3, xy);
  const mpsi_bearing large = bearing_of(body, radius, x, 0.04);
  NEAR(large.foot.distance, 0.004 + radius, 1e-12);
  NEAR(large.foot.at[1], radius, 1e-12);
  NEAR(large.half, 0.04, 0.0);
  const mpsi_bearing small = bearing_of(body, radius, x, 0.008);
  NEAR(small.foot.distance, 0.004, 1e-15);
  NEAR(small.half, 0.002, 1e-15);
  const double beside[3] = {0.3, 0.25, 0.0};
  const mpsi_bearing face = bearing_of(body, radius, beside, 0.008);
  NEAR(face.foot.distance, 0.3 * cos(PI / 6.0) - 0.25 * 0.5, 1e-12);
  NEAR(face.half, 0.008, 0.0);
}
