/* test_mesh.c - distance to meshes against a walk over all triangles, the sign against the solid
 * angle, and a fine mesh of a sphere against the sphere.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body/body_internal.h"
#include "kit/random.h"
#include "mesh_shapes.h"
#include "test_fixture.h"

static mesh_shape shape;

enum { SPHERE, TORUS, BLOCK, SHAPES };

static mps_body *make_body(int which, const mps_body_def *def) {
  if (which == SPHERE) mesh_sphere(&shape, 2);
  if (which == TORUS) mesh_torus(&shape);
  if (which == BLOCK) mesh_block(&shape, 0.3);
  mps_body *body = NULL;
  OK(mps_body_create_mesh(context, def, 3 * shape.triangles, shape.xyz, shape.triangles,
                          shape.corner, &body));
  return body;
}

static double dot(const double *a, const double *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void minus(const double *a, const double *b, double *out) {
  for (int c = 0; c < 3; c++) out[c] = a[c] - b[c];
}

/* Distance to a triangle by minimising over its barycentric coordinates, Ericson's case by case:
 * another way than the library's. */
static double triangle_distance(const double *t, const double *x) {
  const double *a = t, *b = t + 3, *c = t + 6;
  double ab[3], ac[3], ap[3], bp[3], cp[3], q[3];
  minus(b, a, ab), minus(c, a, ac), minus(x, a, ap), minus(x, b, bp), minus(x, c, cp);
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp);
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  double v, w;
  if (d1 <= 0.0 && d2 <= 0.0) {
    v = 0.0, w = 0.0;
  } else if (d3 >= 0.0 && d4 <= d3) {
    v = 1.0, w = 0.0;
  } else if (d6 >= 0.0 && d5 <= d6) {
    v = 0.0, w = 1.0;
  } else if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    v = d1 / (d1 - d3), w = 0.0;
  } else if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    v = 0.0, w = d2 / (d2 - d6);
  } else if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    w = (d4 - d3) / (d4 - d3 + d5 - d6), v = 1.0 - w;
  } else {
    v = vb / (va + vb + vc), w = vc / (va + vb + vc);
  }
  for (int k = 0; k < 3; k++) q[k] = x[k] - (a[k] + v * ab[k] + w * ac[k]);
  return sqrt(dot(q, q));
}

/* Solid angle of the whole surface seen from x over 4 pi: 1 inside, 0 outside. */
static double winding(const double *x) {
  double sum = 0.0;
  for (int64_t t = 0; t < shape.triangles; t++) {
    double a[3], b[3], c[3];
    minus(shape.xyz + 9 * t, x, a);
    minus(shape.xyz + 9 * t + 3, x, b);
    minus(shape.xyz + 9 * t + 6, x, c);
    const double la = sqrt(dot(a, a)), lb = sqrt(dot(b, b)), lc = sqrt(dot(c, c));
    const double triple = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                          a[2] * (b[0] * c[1] - b[1] * c[0]);
    sum += 2.0 * atan2(triple, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (16.0 * atan(1.0));
}

/* Anywhere, or near a corner, an edge or the inside of some triangle. */
static void choose_point(int p, double *x) {
  const double *t = shape.xyz + 9 * (int64_t)uniform(0.0, (double)shape.triangles);
  const double reach = p % 8 < 4 ? 1e-3 : 0.1;
  double w[3] = {1.0, p % 4 > 1 ? uniform(0.0, 1.0) : 0.0, p % 4 > 2 ? uniform(0.0, 1.0) : 0.0};
  const double sum = w[0] + w[1] + w[2];
  for (int c = 0; c < 3; c++)
    x[c] = p % 4 == 0
               ? uniform(-1.5, 1.5)
               : (w[0] * t[c] + w[1] * t[3 + c] + w[2] * t[6 + c]) / sum + uniform(-reach, reach);
}

static void check_point(mps_body *body, const double *x) {
  double d, n[3], foot[3], least = INFINITY;
  int64_t face;
  OK(mps_body_distance(body, 1, x, &d, n, foot, &face));
  for (int64_t t = 0; t < shape.triangles; t++)
    least = fmin(least, triangle_distance(shape.xyz + 9 * t, x));
  NEAR(fabs(d), least, 1e-13);
  if (least > 1e-9) assert_int_equal(d<0.0, winding(x)> 0.5);
  NEAR(triangle_distance(shape.xyz + 9 * face, foot), 0.0, 1e-14);
  NEAR(dot(n, n), 1.0, 1e-14);
  for (int c = 0; c < 3; c++) NEAR(foot[c] + d * n[c], x[c], 1e-13);
}

TEST(distance_is_the_least) {
  for (int which = 0; which < SHAPES; which++) {
    scoped_body *body = make_body(which, NULL);
    for (int p = 0; p < 2000; p++) {
      double x[3];
      choose_point(p, x);
      check_point(body, x);
    }
  }
}

/* Triangles given inside out are turned, and keep their numbers; far away and near give the same
 * as a walk over all. */
TEST(order_and_place_do_not_matter) {
  scoped_body *body = make_body(BLOCK, NULL), *other = NULL;
  for (int64_t s = 0; s < shape.triangles; s++) {
    const int32_t second = shape.corner[3 * s + 1];
    shape.corner[3 * s + 1] = shape.corner[3 * s + 2], shape.corner[3 * s + 2] = second;
  }
  OK(mps_body_create_mesh(context, NULL, 3 * shape.triangles, shape.xyz, shape.triangles,
                          shape.corner, &other));
  for (int p = 0; p < 500; p++) {
    double x[3], d, e, n[3], m[3];
    int64_t face, same;
    choose_point(p, x);
    for (int c = 0; c < 3 && p < 20; c++) x[c] *= p < 10 ? 1e3 : 1e8;
    OK(mps_body_distance(body, 1, x, &d, n, NULL, &face));
    OK(mps_body_distance(other, 1, x, &e, m, NULL, &same));
    NEAR(e, d, 1e-14 * fabs(d) + 1e-15);
    for (int c = 0; c < 3; c++) NEAR(m[c], n[c], 1e-6);
    if (p < 20) {
      double least = INFINITY;
      for (int64_t t = 0; t < shape.triangles; t++)
        least = fmin(least, triangle_distance(shape.xyz + 9 * t, x));
      NEAR(d, least, 1e-14 * least);
    }
  }
}

TEST(fine_mesh_is_the_sphere) {
  DEF(body, def, .position[0] = 0.3, .rotation[1] = 0.8);
  MAKE(body, exact, create_sphere, context, &def, 1.0);
  double last = 0.0;
  for (int level = 1; level <= 3; level++) {
    scoped_body *body = NULL;
    mesh_sphere(&shape, level);
    OK(mps_body_create_mesh(context, &def, 3 * shape.triangles, shape.xyz, shape.triangles,
                            shape.corner, &body));
    double worst = 0.0;
    for (int p = 0; p < 1000; p++) {
      const double x[3] = {uniform(-1.2, 1.8), uniform(-1.5, 1.5), uniform(-1.5, 1.5)};
      double d, e;
      OK(mps_body_distance(body, 1, x, &d, NULL, NULL, NULL));
      OK(mps_body_distance(exact, 1, x, &e, NULL, NULL, NULL));
      worst = fmax(worst, fabs(d - e));
    }
    print_message("%lld triangles: %.4f m off\n", (long long)shape.triangles, worst);
    if (level > 1) assert_true(worst < 0.3 * last && worst > 0.2 * last); /* second order */
    last = worst;
  }
}

/* A moved body sees a moved point as it saw the point before. */
TEST(moves_with_its_frame) {
  DEF(body, def, .position[0] = -3.0, .position[2] = 7.0, .rotation[0] = 1.0, .rotation[1] = -2.0,
      .rotation[2] = 0.5);
  scoped_body *still = make_body(TORUS, NULL), *moved = make_body(TORUS, &def);
  mps_body_state s;
  OK(mps_body_get_state(moved, &s));
  for (int p = 0; p < 500; p++) {
    double x[3], y[3], d, e, n[3], m[3], foot[3], there[3];
    choose_point(p, x);
    for (int r = 0; r < 3; r++) y[r] = s.position[r] + dot(s.orientation + 3 * r, x);
    OK(mps_body_distance(still, 1, x, &d, n, foot, NULL));
    OK(mps_body_distance(moved, 1, y, &e, m, there, NULL));
    NEAR(e, d, 1e-14);
    for (int r = 0; r < 3; r++)
      NEAR(there[r], s.position[r] + dot(s.orientation + 3 * r, foot), 1e-13);
    for (int r = 0; r < 3 && fabs(d) > 1e-4; r++) NEAR(m[r], dot(s.orientation + 3 * r, n), 1e-9);
  }
}

/* The block beside, on and in itself; its wall; a sphere in the hole of the torus. */
TEST(overlap_and_walls) {
  const double shifts[] = {1.0, 0.99, 0.3, -0.29, 0.45};
  const int axes[] = {0, 0, 2, 2, 1};
  const bool expected[] = {false, true, false, true, true};
  scoped_body *still = make_body(BLOCK, NULL);
  NEAR(mpsi_body_thickness(still), 0.3, 1e-12);
  for (int k = 0; k < 5; k++) {
    DEF(body, def, .position[axes[k]] = shifts[k]);
    scoped_body *moved = make_body(BLOCK, &def);
    assert_int_equal(mpsi_body_overlap(still, moved, 5e-3), expected[k]);
    assert_int_equal(mpsi_body_overlap(moved, still, 5e-3), expected[k]);
  }
  scoped_body *torus = make_body(TORUS, NULL);
  assert_true(mpsi_body_thickness(torus) > 0.6 && mpsi_body_thickness(torus) < 0.7);
  for (int k = 0; k < 2; k++) {
    MAKE(body, ball, create_sphere, context, NULL, k ? 0.57 : 0.54);
    assert_int_equal(mpsi_body_overlap(torus, ball, 5e-3), k);
  }
}

/* A block's faces do not narrow, on the sides of triangles within them neither; beside its edges
 * and corners no row of soil is of any surface. */
TEST(faces_do_not_narrow) {
  scoped_body *body = make_body(BLOCK, NULL);
  int flat = 0, edges = 0;
  for (int p = 0; p < 4000; p++) {
    double x[3];
    for (int c = 0; c < 3; c++) {
      x[c] = uniform(-0.5, 1.5);
      if (p % 2) x[c] = floor(x[c] * 16.0) / 16.0; /* many above the diagonals */
    }
    bool on_rim = false; /* beside a face and an edge: either will do */
    for (int c = 0; c < 2; c++) on_rim = on_rim || x[c] == 0.0 || x[c] == 0.5 || x[c] == 1.0;
    if (on_rim || x[2] == 0.0) continue;
    const mpsi_foot foot = mpsi_body_foot(body, x);
    if (foot.distance < 1e-3) continue;
    double most = 0.0;
    for (int c = 0; c < 3; c++) most = fmax(most, fabs(foot.normal[c]));
    NEAR(foot.narrowing, most > 1.0 - 1e-12 ? 1.0 : 0.0, 0.0);
    flat += foot.narrowing == 1.0, edges += foot.narrowing == 0.0;
  }
  assert_true(flat > 500 && edges > 500);
}
