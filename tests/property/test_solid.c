/* test_solid.c - rigid bodies in space: distance to spheres, half spaces and solids of revolution,
 * driven rotations, and what a free body keeps.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body/body_internal.h"
#include "kit/random.h"
#include "test_fixture.h"

static double dot(const double *a, const double *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double *a, const double *b, double *out) {
  for (int c = 0; c < 3; c++)
    out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static mps_body_state get_state(mps_body *body) {
  mps_body_state s;
  OK(mps_body_get_state(body, &s));
  return s;
}

/* ---- distance -------------------------------------------------------------------------------- */

TEST(closed_forms) {
  scoped_body *sphere = NULL, *space = NULL, *cylinder = NULL;
  const double normal[] = {2.0, -3.0, 6.0};
  OK(mps_body_create_sphere(context, NULL, 0.5, &sphere));
  OK(mps_body_create_half_space(context, NULL, normal, &space));
  OK(mps_body_create_cylinder(context, NULL, 0.6, 1.0, &cylinder));
  assert_int_equal(mps_body_dim(sphere), 3);
  for (int p = 0; p < 2000; p++) {
    const double x[3] = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    double d;
    int64_t face;
    OK(mps_body_distance(sphere, 1, x, &d, NULL, NULL, NULL));
    NEAR(d, sqrt(dot(x, x)) - 0.5, 1e-15);
    OK(mps_body_distance(space, 1, x, &d, NULL, NULL, NULL));
    NEAR(d, dot(x, normal) / 7.0, 1e-15);
    const double r = hypot(x[0], x[1]) - 0.6, z = fabs(x[2]) - 0.5;
    OK(mps_body_distance(cylinder, 1, x, &d, NULL, NULL, &face));
    NEAR(d, r > 0.0 && z > 0.0 ? hypot(r, z) : fmax(r, z), 1e-15);
    if (z < 0.0 && r > z) assert_int_equal(face, 2);
    if (r < 0.0 && z > r) assert_int_equal(face, x[2] > 0.0 ? 1 : 0);
  }
}

/* A cone on a shaft, tip on the axis; a pipe with a collar. */
static const double pile[] = {0.0, -0.5, 0.3, 0.0, 0.3, 0.8, 0.0, 0.8};
static const double pipe[] = {0.3, -0.6, 0.5, -0.6, 0.5, 0.2, 0.8, 0.2, 0.8, 0.6, 0.3, 0.6};

/* The least distance to points strewn on the profile, and the sign by crossings. */
static double strewn_distance(int n, const double *rz, const double *x) {
  const double r = hypot(x[0], x[1]), z = x[2];
  double least = INFINITY;
  bool inside = false;
  for (int k = 0; k < n; k++) {
    const double *a = rz + 2 * k, *b = rz + 2 * ((k + 1) % n);
    if ((a[1] > z) != (b[1] > z) && r < a[0] + (z - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
      inside = !inside;
    for (int s = 0; s <= 1000 && (a[0] > 0.0 || b[0] > 0.0); s++)
      least = fmin(least,
                   hypot(a[0] + 1e-3 * s * (b[0] - a[0]) - r, a[1] + 1e-3 * s * (b[1] - a[1]) - z));
  }
  return inside ? -least : least;
}

TEST(solids_of_revolution) {
  const struct {
    int n;
    const double *rz;
  } list[] = {{4, pile}, {6, pipe}};
  for (int k = 0; k < 2; k++) {
    MAKE(body, body, create_revolution, context, NULL, list[k].n, list[k].rz);
    for (int p = 0; p < 2000; p++) {
      const double near = p % 5 == 0 ? 1e-3 : 1.0; /* some near the axis */
      const double x[3] = {near * uniform(-1, 1), near * uniform(-1, 1), uniform(-1, 1)};
      double d, n[3], foot[3];
      OK(mps_body_distance(body, 1, x, &d, n, foot, NULL));
      const double e = strewn_distance(list[k].n, list[k].rz, x);
      NEAR(d, e, 2e-3);
      if (fabs(e) > 1e-9) assert_int_equal(d < 0.0, e < 0.0);
      NEAR(dot(n, n), 1.0, 1e-14);
      for (int c = 0; c < 3; c++) NEAR(foot[c] + d * n[c], x[c], 1e-14);
    }
  }
}

/* ---- the foot as a function of place --------------------------------------------------------- */

static mps_body *shape_of(int which) {
  static const double up[] = {0.6, 0.8, 0.0},
                      house[] = {-0.5, -0.5, 0.1, -0.5, 0.5, -0.5, 0.5, 0.3, -0.1, 0.6, -0.5, 0.3};
  mps_body *body = NULL;
  DEF(body, def, .position[0] = 0.1, .rotation[2] = 0.3);
  mps_status status = MPS_ERROR_ARGUMENT;
  if (which == 0) status = mps_body_create_disc(context, &def, 0.5, &body);
  if (which == 1) status = mps_body_create_polygon(context, &def, 6, house, &body);
  if (which == 2) status = mps_body_create_half_plane(context, &def, up, &body);
  if (which == 3) status = mps_body_create_half_space(context, &def, up, &body);
  if (which == 4) status = mps_body_create_sphere(context, &def, 0.5, &body);
  if (which == 5) status = mps_body_create_revolution(context, &def, 4, pile, &body);
  if (which == 6) status = mps_body_create_revolution(context, &def, 6, pipe, &body);
  OK(status);
  return body;
}

/* How the foot moves with the place along the surface: its determinant, by differences. */
static double moved_area(const mps_body *body, int dim, const double *x, const double *n) {
  const double eps = 1e-6;
  double along[2][3] = {{-n[1], n[0], 0.0}}, m[2][2];
  if (dim == 3) {
    const double off[3] = {fabs(n[0]) < 0.7, fabs(n[0]) >= 0.7, 0.0};
    cross(n, off, along[0]);
    const double length = sqrt(dot(along[0], along[0]));
    for (int c = 0; c < 3; c++) along[0][c] /= length;
    cross(n, along[0], along[1]);
  }
  for (int a = 0; a < dim - 1; a++) {
    double y[3], z[3], by[3];
    for (int c = 0; c < 3; c++) {
      y[c] = x[c] + eps * along[a][c];
      z[c] = x[c] - eps * along[a][c];
    }
    const mpsi_foot one = mpsi_body_foot(body, y), two = mpsi_body_foot(body, z);
    for (int c = 0; c < 3; c++) by[c] = 0.5 * (one.at[c] - two.at[c]) / eps;
    for (int b = 0; b < dim - 1; b++) m[a][b] = dot(by, along[b]);
  }
  return dim == 2 ? m[0][0] : m[0][0] * m[1][1] - m[0][1] * m[1][0];
}

/* A row of soil parallel to a curved surface is longer than it: `narrowing` says by how much, and
 * is 0 beside an edge, where the row is of no surface. */
TEST(parallel_surfaces_narrow) {
  for (int k = 0; k < 7; k++) {
    scoped_body *body = shape_of(k);
    const int dim = mps_body_dim(body);
    int edges = 0;
    for (int p = 0; p < 1000; p++) {
      const double x[3] = {uniform(-1, 1), uniform(-1, 1), dim == 3 ? uniform(-1, 1) : 0.0};
      const mpsi_foot foot = mpsi_body_foot(body, x);
      if (foot.distance < 1e-2) continue;
      const double area = moved_area(body, dim, x, foot.normal);
      NEAR(foot.narrowing, area, 1e-7);
      edges += foot.narrowing == 0.0;
    }
    print_message("shape %d: %d of 1000 points have their foot on an edge\n", k, edges);
    assert_int_equal(edges > 0, k == 1 || k > 4);
  }
}

/* At the tip of a cone, and above it on the axis, the normal is the axis. */
TEST(tip_of_a_cone) {
  MAKE(body, body, create_revolution, context, NULL, 4, pile);
  const double x[6] = {0.0, 0.0, -0.5, 0.0, 0.0, -0.7};
  double d[2], n[6];
  OK(mps_body_distance(body, 2, x, d, n, NULL, NULL));
  NEAR(d[0], 0.0, 1e-16);
  NEAR(d[1], 0.2, 1e-15);
  NEAR(n[2], -1.0, 1e-15);
  NEAR(n[5], -1.0, 1e-15);
}

/* ---- overlap and walls ----------------------------------------------------------------------- */

/* Two bodies in contact at x = 0, the second moved to overlap by `by`, turned together. */
static bool overlap(int one, int two, double by, double turn) {
  static const double square[] = {0.0, -1.0, 2.0, -1.0, 2.0, 1.0, 0.0, 1.0};
  static const double tooth[] = {0.0, 0.0, -1.0, 0.4, -1.0, -0.4};
  const double left[3] = {1.0, 0.0, 0.0};
  mps_body *body[2] = {NULL};
  for (int k = 0; k < 2; k++) {
    const int what = k ? two : one;
    const double shift = (k ? -1.0 : 1.0) * (what == 1 ? 0.5 : 0.0) + (k ? by : 0.0);
    const double angle = turn + (what == 0 && k ? 4.0 * atan(1.0) : 0.0);
    DEF(body, def, .position[0] = shift * cos(turn), .position[1] = shift * sin(turn),
        .rotation[2] = angle);
    if (what == 0) OK(mps_body_create_polygon(context, &def, 4, square, &body[k]));
    if (what == 1) OK(mps_body_create_disc(context, &def, 0.5, &body[k]));
    if (what == 2) OK(mps_body_create_half_plane(context, &def, left, &body[k]));
    if (what == 3) OK(mps_body_create_polygon(context, &def, 3, tooth, &body[k]));
  }
  const bool is = mpsi_body_overlap(body[0], body[1], 1e-3);
  assert_int_equal(is, mpsi_body_overlap(body[1], body[0], 1e-3));
  for (int k = 0; k < 2; k++) mps_body_destroy(&body[k]);
  return is;
}

TEST(overlap_in_a_plane) {
  for (int one = 0; one < 2; one++)
    for (int two = 0; two < 4; two++)
      for (int t = 0; t < 3; t++) {
        assert_false(overlap(one, two, -0.01, 0.7 * t));
        assert_false(overlap(one, two, 0.0, 0.7 * t));
        assert_true(overlap(one, two, 0.01, 0.7 * t));
      }
}

/* A pile in a pipe, a sphere in the pipe's bore, and all of them over ground. */
TEST(overlap_in_space) {
  const double up[3] = {0.0, 0.0, 1.0};
  const double rod[] = {0.0, -0.5, 0.29, 0.0, 0.29, 0.8, 0.0, 0.8};
  for (int moved = 0; moved < 2; moved++) {
    mps_body_def def = mps_body_defaults();
    scoped_body *outer = NULL, *inner = NULL, *ball = NULL, *ground = NULL;
    OK(mps_body_create_revolution(context, &def, 6, pipe, &outer));
    def.position[2] = -0.601 + 0.1 * moved;
    OK(mps_body_create_half_space(context, &def, up, &ground));
    def.position[2] = 0.1;
    def.position[0] = 0.02 * moved;
    OK(mps_body_create_revolution(context, &def, 4, rod, &inner));
    def.position[2] = -0.2;
    OK(mps_body_create_sphere(context, &def, 0.299, &ball));
    assert_int_equal(mpsi_body_overlap(outer, inner, 1e-3), moved);
    assert_int_equal(mpsi_body_overlap(outer, ball, 1e-3), moved);
    assert_int_equal(mpsi_body_overlap(ground, outer, 1e-3), moved);
    assert_true(mpsi_body_overlap(inner, ball, 1e-3));
  }
}

TEST(thickness_of_walls) {
  MAKE(body, body, create_box, context, NULL, 2.0, 0.1);
  NEAR(mpsi_body_thickness(body), 0.1, 1e-12);
  mps_body_destroy(&body);
  const double wedge[] = {0.0, 0.0, 1.0, 0.0, 0.5, 0.8}; /* corners of 58, 58 and 64 degrees */
  OK(mps_body_create_polygon(context, NULL, 3, wedge, &body));
  assert_true(isinf(mpsi_body_thickness(body)));
  mps_body_destroy(&body);
  OK(mps_body_create_revolution(context, NULL, 6, pipe, &body));
  NEAR(mpsi_body_thickness(body), 0.2, 1e-12);
  mps_body_destroy(&body);
  OK(mps_body_create_cylinder(context, NULL, 0.1, 0.5, &body));
  NEAR(mpsi_body_thickness(body), 0.2, 1e-12);
  mps_body_destroy(&body);
  OK(mps_body_create_sphere(context, NULL, 0.1, &body));
  NEAR(mpsi_body_thickness(body), 0.2, 0.0);
}

/* ---- driven rotation ------------------------------------------------------------------------- */

/* Rows of R against exp of the rotation vector by its power series, spin against the change of R,
 * the velocity of a point fixed to the body against the change of its place. */
TEST(turns_as_driven) {
  DEF(body, def, .rotation[0] = 0.4, .rotation[1] = -0.3, .rotation[2] = 1.9, .position[1] = 2.0);
  MAKE(body, body, create_sphere, context, &def, 1.0);
  for (int c = 0; c < 6; c++) {
    scoped_signal *sine = NULL;
    OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0.3 + 0.1 * c, 0.4, 0.0,
                              &sine));
    OK(mps_body_drive(body, c, sine, c == 4 ? -2.0 : 1.0));
  }
  const double dt = 1e-4, X[3] = {0.3, -0.7, 0.2};
  double at[3][3], spin[3] = {0}, v[3] = {0};
  for (int step = 0; step < 9000; step++) OK(mps_body_advance(body, dt));
  mps_body_state s[3];
  for (int k = 0; k < 3; k++) {
    OK(mps_body_advance(body, dt));
    s[k] = get_state(body);
    for (int r = 0; r < 3; r++) at[k][r] = s[k].position[r] + dot(s[k].orientation + 3 * r, X);
    if (k == 1) {
      memcpy(spin, body->pose.spin, sizeof spin);
      mpsi_body_velocity(&body->pose, at[1], v);
    }
  }
  double square[3], series[3] = {X[0], X[1], X[2]}, term[3] = {X[0], X[1], X[2]};
  for (int n = 1; n < 40; n++) {
    cross(s[1].rotation, term, square);
    for (int c = 0; c < 3; c++) series[c] += term[c] = square[c] / n;
  }
  assert_true(dot(s[1].rotation, s[1].rotation) > 1.0);
  for (int r = 0; r < 3; r++) {
    NEAR(dot(s[1].orientation + 3 * r, X), series[r], 1e-13);
    NEAR(v[r], (at[2][r] - at[0][r]) / (2.0 * dt), 1e-6);
    double turning = 0.0; /* (dR/dt R^T) of the row and column that spin component r is in */
    for (int c = 0; c < 3; c++)
      turning +=
          (s[2].orientation[3 * ((r + 2) % 3) + c] - s[0].orientation[3 * ((r + 2) % 3) + c]) /
          (2.0 * dt) * s[1].orientation[3 * ((r + 1) % 3) + c];
    NEAR(spin[r], turning, 1e-6);
  }
}

/* ---- free bodies ----------------------------------------------------------------------------- */

static void momentum_and_energy(const mps_body_state *s, const double *inertia, double *L,
                                double *energy) {
  double own[3];
  for (int c = 0; c < 3; c++) {
    own[c] = 0.0;
    for (int r = 0; r < 3; r++) own[c] += s->orientation[3 * r + c] * s->spin[r];
    own[c] *= inertia[c];
  }
  for (int r = 0; r < 3; r++) L[r] = dot(s->orientation + 3 * r, own);
  *energy = 0.5 * dot(L, s->spin);
}

static mps_body *free_body(const double *inertia, const double *spin) {
  DEF(body, def, .motion = MPS_BODY_MOTION_FREE, .mass = 1.0, .rotation[0] = 0.7,
      .rotation[2] = -0.2);
  for (int c = 0; c < 3; c++) def.inertia[c] = inertia[c], def.spin[c] = spin[c];
  MAKE_KEPT(body, body, create_sphere, context, &def, 1.0);
  return body;
}

/* An asymmetric body, tumbling about its middle axis: it turns over again and again. */
TEST(tumbling_keeps_momentum_and_energy) {
  const double inertia[3] = {1.0, 2.0, 3.0}, spin[3] = {0.1, 4.0, 2.5};
  double swing[2];
  for (int k = 0; k < 2; k++) { /* and with half the step */
    scoped_body *body = free_body(inertia, spin);
    mps_body_state s = get_state(body);
    double L0[3], E0, L[3], E, worst = 0.0, drift = 0.0, lowest = 1.0, highest = -1.0;
    momentum_and_energy(&s, inertia, L0, &E0);
    const int steps = 20000 << k;
    for (int step = 1; step <= steps; step++) {
      OK(mps_body_advance(body, 2e-3 / (1 << k)));
      s = get_state(body);
      momentum_and_energy(&s, inertia, L, &E);
      for (int c = 0; c < 3; c++) worst = fmax(worst, fabs(L[c] - L0[c]));
      drift = fmax(drift, fabs(E / E0 - 1.0));
      const double axis[3] = {s.orientation[1], s.orientation[4], s.orientation[7]};
      const double tilt = dot(axis, L) / sqrt(dot(L, L));
      lowest = fmin(lowest, tilt), highest = fmax(highest, tilt);
    }
    print_message("%d steps: L off by %.1e of %.2f, energy by %.1e\n", steps, worst,
                  sqrt(dot(L0, L0)), drift);
    assert_true(lowest < -0.5 && highest > 0.5); /* it has turned over */
    NEAR(worst, 0.0, 1e-12 * sqrt(dot(L0, L0)));
    assert_true(drift < 2e-5);
    swing[k] = drift;
  }
  assert_true(swing[1] < 0.3 * swing[0]); /* second order */
}

/* Two equal inertias: the axis turns about L at L/I, exactly. */
TEST(top_precesses_exactly) {
  const double inertia[3] = {2.0, 2.0, 0.7}, spin[3] = {1.0, -2.0, 3.0};
  scoped_body *body = free_body(inertia, spin);
  mps_body_state s = get_state(body);
  double L[3], E, axis[3], across[3], expected[3];
  momentum_and_energy(&s, inertia, L, &E);
  for (int r = 0; r < 3; r++) axis[r] = s.orientation[3 * r + 2];
  for (int step = 0; step < 1000; step++) OK(mps_body_advance(body, 0.01));
  s = get_state(body);
  const double size = sqrt(dot(L, L)), angle = 10.0 * size / 2.0, along = dot(L, axis) / size;
  cross(L, axis, across);
  for (int r = 0; r < 3; r++) {
    expected[r] = cos(angle) * axis[r] + sin(angle) * across[r] / size +
                  (1.0 - cos(angle)) * along * L[r] / size;
    NEAR(s.orientation[3 * r + 2], expected[r], 1e-12);
  }
}

/* Load, gravity and reaction: momentum grows by the sum of impulses, to the last bits. */
TEST(reactions_move_a_free_body) {
  DEF(body, def, .motion = MPS_BODY_MOTION_FREE, .mass = 2.0, .inertia[0] = 0.5, .inertia[1] = 0.8,
      .inertia[2] = 1.1, .gravity[2] = -9.81);
  MAKE(body, body, create_cylinder, context, &def, 0.3, 1.0);
  OK(mps_body_name_part(body, "side", 2, 1, NULL));
  const double force[3] = {1.0, 2.0, 3.0}, moment[3] = {0.1, -0.2, 0.3}, dt = 1e-3;
  OK(mps_body_set_load(body, force, moment));
  const mpsi_load load[2] = {{{0.5, 0.0, 4.0}, {0.0, 0.2, 0.0}}, {{0.0, -1.0, 0.0}, {0.3, 0, 0}}};
  mpsi_body_source soil = {.moves = false};
  assert_true(mpsi_body_make_source(body, &soil));
  mpsi_body_join(body, &soil);
  soil.part[0] = (mpsi_part_load){.force = load[0], .count = 3};
  soil.part[1] = (mpsi_part_load){.force = load[1], .count = 4};
  for (int step = 0; step < 2000; step++) {
    mpsi_body_react(body, &soil, dt);
    OK(mps_body_advance(body, dt));
  }
  const mps_body_state s = get_state(body);
  double L[3], E;
  momentum_and_energy(&s, def.inertia, L, &E);
  mps_reaction r;
  OK(mps_body_get_reaction(body, -1, &r));
  assert_int_equal(r.count, 7);
  for (int c = 0; c < 3; c++) {
    NEAR(r.impulse[c], 2.0 * (load[0].force[c] + load[1].force[c]), 1e-11);
    NEAR(def.mass * s.velocity[c], 2.0 * (force[c] + def.mass * def.gravity[c]) + r.impulse[c],
         1e-10);
    NEAR(L[c], 2.0 * moment[c] + r.moment_impulse[c], 1e-11);
  }
  mpsi_body_leave(body, &soil);
  mpsi_body_free_source(body, &soil);
}

/* The rotation vector that the state of a free body shows gives its orientation again, also near
 * half a turn. */
TEST(rotation_vector_round_trip) {
  const double pi = 4.0 * atan(1.0);
  for (int p = 0; p < 300; p++) {
    mps_body_def def = mps_body_defaults();
    double axis[3] = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    if (p % 3 == 0) axis[p / 3 % 3] = 0.0;
    const double angles[] = {1e-9, 1e-3, 0.1, 0.1001, 1.0, 3.0, pi - 1e-9, pi};
    const double angle = angles[p % 8], scale = angle / sqrt(dot(axis, axis));
    for (int c = 0; c < 3; c++) def.rotation[c] = scale * axis[c], def.inertia[c] = 1.0;
    def.motion = MPS_BODY_MOTION_FREE, def.mass = 1.0;
    scoped_body *body = NULL, *again = NULL;
    OK(mps_body_create_sphere(context, &def, 1.0, &body));
    const mps_body_state s = get_state(body);
    for (int c = 0; c < 3 && angle < pi; c++) NEAR(s.rotation[c], def.rotation[c], 1e-14);
    for (int c = 0; c < 3; c++) def.rotation[c] = s.rotation[c];
    OK(mps_body_create_sphere(context, &def, 1.0, &again));
    const mps_body_state t = get_state(again);
    for (int k = 0; k < 9; k++) NEAR(t.orientation[k], s.orientation[k], 1e-14);
  }
}
