/* test_mpm.c - what the WLS-MPM solver keeps: partition of unity, linear functions, momentum, also
 * beside bodies and edges; nothing passes through a thin wall.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#include "mpm/shape.h"

static uint64_t seed = 1;

static double uniform(double low, double high) { /* Knuth's MMIX generator, the upper 53 bits */
  seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return low + (high - low) * (double)(seed >> 11) * 0x1p-53;
}

/* A concave polygon with a thin tooth, and a disc, in a square domain full of particles at random
 * places, some of them deep inside the bodies. */
static const double tooth[] = {0.30, 0.20, 0.90, 0.20, 0.90, 0.35, 0.62,
                               0.35, 0.60, 0.75, 0.57, 0.35, 0.30, 0.35};

enum { COUNT = 4000 };

static mpm_scene crowded(int32_t geometry, int32_t spline, bool keep_out) {
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e6);
  mps_body *bodies[2] = {NULL};
  mps_body_def body = mps_body_defaults();
  mps_assert_ok(context, mps_body_create_polygon(context, &body, 7, tooth, &bodies[0]));
  body.position[0] = 0.25, body.position[1] = 0.8;
  mps_assert_ok(context, mps_body_create_disc(context, &body, 0.15, &bodies[1]));
  for (int k = 0; k < COUNT;) {
    const double x[] = {uniform(0.0, 1.0), uniform(0.0, 1.0)};
    double d, e;
    mps_assert_ok(context, mps_body_distance(bodies[0], 1, x, &d, NULL, NULL, NULL));
    mps_assert_ok(context, mps_body_distance(bodies[1], 1, x, &e, NULL, NULL, NULL));
    if (keep_out && fmin(d, e) < 0.005) continue; /* untouched: no contact force */
    mps_assert_ok(context, mps_particles_append(s.particles, 1, x));
    k++;
  }
  mps_mpm_def def = mps_mpm_defaults();
  def.geometry = geometry;
  def.spline = spline;
  def.cell = 0.02;
  for (int c = 0; c < 2; c++) def.lower[c] = 0.0, def.upper[c] = 1.0;
  mpm_scene_solve(&s, &def);
  for (int b = 0; b < 2; b++) {
    mps_assert_ok(context, mps_mpm_add_body(s.mpm, bodies[b]));
    mps_body_destroy(&bodies[b]);
  }
  return s;
}

/* sum phi = 1, sum phi (x_i - x_p) = 0, sum grad phi = 0, sum (x_i - x_p) grad phi = 1; M far from
 * singular and phi hardly negative whatever the bodies cut off. */
static void check_shapes(mps_mpm *mpm, int spline, int64_t *fitted) {
  const double h = mpm->def.cell;
  double least_phi = 1.0, least_determinant = 1.0;
  for (int64_t b = 0; b < mpm->cell_count; b++)
    for (int64_t k = mpm->cells[b].begin; k < mpm->cells[b].end; k++) {
      mpsi_stencil stencil;
      mpsi_shape_values f;
      mpsi_make_stencil(mpm, &mpm->cells[b], spline, k, &stencil);
      *fitted += !mpsi_full_support(mpm, &mpm->cells[b], spline, &stencil);
      mpsi_fit_shape(mpm, &mpm->cells[b], spline, &stencil, &f);
      double one = 0.0, first[2] = {0}, g[2] = {0}, unit[4] = {0};
      for (int n = 0; n < MPSI_STENCIL; n++) {
        const double x = stencil.s[0][n % 4], y = stencil.s[1][n / 4];
        one += f.phi[n];
        first[0] += f.phi[n] * x, first[1] += f.phi[n] * y;
        g[0] += f.gx[n] * h, g[1] += f.gy[n] * h;
        unit[0] += f.gx[n] * h * x, unit[1] += f.gx[n] * h * y;
        unit[2] += f.gy[n] * h * x, unit[3] += f.gy[n] * h * y;
        least_phi = fmin(least_phi, f.phi[n]);
      }
      mps_assert_near(one, 1.0, 1e-13);
      for (int c = 0; c < 2; c++) {
        mps_assert_near(first[c], 0.0, 1e-13);
        mps_assert_near(g[c], 0.0, 1e-13);
        for (int d = 0; d < 2; d++) mps_assert_near(unit[2 * c + d], c == d, 1e-13);
      }
      least_determinant = fmin(least_determinant, f.determinant);
    }
  print_message("spline %d: least phi %.4f, least det(M)/M00^3 %.4f\n", spline, least_phi,
                least_determinant);
  assert_true(least_phi >= -0.05);
  if (spline == 3) assert_true(least_determinant >= 0.0256);
  assert_true(least_determinant > 0.0);
}

static void shapes_are_a_partition(void **state) {
  (void)state;
  for (int spline = 2; spline <= 3; spline++) {
    mpm_scene s = crowded(MPS_PLANE_STRAIN, spline, false);
    int64_t fitted = 0;
    mps_assert_ok(context, mpsi_mpm_find_near(s.mpm, "test"));
    check_shapes(s.mpm, spline, &fitted);
    assert_true(fitted > COUNT / 4);
    mpm_scene_end(&s);
  }
}

/* A linear velocity field goes to the nodes and back unchanged. The bodies and the walls must not
 * act: particles keep off the ones, and the others are bypassed by the nodes' velocity before the
 * forces. */
static void affine_round_trip(void **state) {
  (void)state;
  const double v0[] = {0.3, -0.2}, L[] = {1.1, -0.7, 0.4, 0.9};
  for (int variant = 0; variant < 4; variant++) {
    const int spline = 2 + variant % 2;
    mpm_scene s = crowded(variant / 2, spline, true);
    mps_mpm *mpm = s.mpm;
    mpm_scene_affine(&s, v0, L);
    mps_assert_ok(context, mpsi_mpm_find_near(mpm, "test"));
    mpm->dt = 1e-30;
    for (int64_t b = 0; b < mpm->cell_count; b++) mpsi_mpm_p2g(mpm, b);
    for (int64_t g = 0; g < mpm->node_count; g++) {
      mpsi_mpm_update_nodes(mpm, g);
      memcpy(mpm->node[g][MPSI_VX], mpm->node[g][MPSI_NX], 2 * sizeof mpm->node[g][MPSI_NX]);
    }
    for (int64_t b = 0; b < mpm->cell_count; b++) mpsi_mpm_g2p(mpm, b);
    mps_view x = mpm_scene_view(&s, "position"), v = mpm_scene_view(&s, "velocity");
    mps_view g = mpm_scene_view(&s, "velocity_gradient");
    for (int64_t k = 0; k < COUNT; k++)
      for (int c = 0; c < 2; c++) {
        const double X = *mps_view_f64(&x, k, 0), Y = *mps_view_f64(&x, k, 1);
        mps_assert_near(*mps_view_f64(&v, k, c), v0[c] + L[2 * c] * X + L[2 * c + 1] * Y, 1e-11);
        for (int d = 0; d < 2; d++)
          mps_assert_near(*mps_view_f64(&g, k, 2 * c + d), L[2 * c + d], 1e-10);
      }
    mpm_scene_end(&s);
  }
}

/* A soft disc that rotates and shakes in empty space keeps both momenta over 2000 steps. */
static void free_body_keeps_momentum(void **state) {
  (void)state;
  for (int spline = 2; spline <= 3; spline++) {
    mpm_scene s = mpm_scene_begin(context, 0.01, 0.003, -0.001, 1e5);
    const double v0[] = {0.4, -0.3}, L[] = {0.5, -6.0, 5.0, -0.8};
    mpm_scene_ball(&s, 0.0, 0.0, 0.12);
    mpm_scene_affine(&s, v0, L);
    mps_mpm_def def = mps_mpm_defaults();
    def.spline = spline;
    def.cell = 0.02;
    mpm_scene_solve(&s, &def);
    const mps_mpm_totals a = mpm_scene_totals(&s);
    mps_assert_ok(context, mps_mpm_step(s.mpm, 2000));
    const mps_mpm_totals b = mpm_scene_totals(&s);
    print_message("spline %d: linear %.2g, angular %.2g\n", spline,
                  hypot(b.linear[0] - a.linear[0], b.linear[1] - a.linear[1]) /
                      hypot(a.linear[0], a.linear[1]),
                  fabs(b.angular - a.angular) / fabs(a.angular));
    for (int c = 0; c < 2; c++)
      mps_assert_near(b.linear[c], a.linear[c], 1e-12 * hypot(a.linear[0], a.linear[1]));
    mps_assert_near(b.angular, a.angular, 1e-12 * fabs(a.angular));
    mps_assert_near(b.mass, a.mass, 0.0);
    assert_true(b.kinetic < a.kinetic);
    mpm_scene_end(&s);
  }
}

/* Angular and linear momentum of a free body about the origin of space. */
static void body_momentum(mps_body *body, double mass, double inertia, double *out) {
  mps_body_state b;
  mps_assert_ok(context, mps_body_get_state(body, &b));
  out[0] += mass * b.velocity[0];
  out[1] += mass * b.velocity[1];
  out[2] +=
      inertia * b.spin[2] + mass * (b.position[0] * b.velocity[1] - b.position[1] * b.velocity[0]);
}

/* A lump thrown at two free bodies: what the particles lose the bodies get, to the last bits of
 * linear momentum. */
static void contact_keeps_momentum(void **state) {
  (void)state;
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  const double v0[] = {2.0, -0.5}, L[] = {0.0, -3.0, 3.0, 0.0};
  mpm_scene_ball(&s, 0.0, 0.0, 0.1);
  mpm_scene_affine(&s, v0, L);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 0.02;
  mpm_scene_solve(&s, &def);
  mps_body *bodies[2] = {NULL};
  mps_body_def body = mps_body_defaults();
  body.motion = MPS_MOTION_FREE;
  body.mass = 20.0, body.inertia[2] = 0.2;
  body.position[0] = 0.2, body.position[1] = -0.05, body.rotation[2] = 0.4;
  body.friction = 0.4;
  mps_assert_ok(context, mps_body_create_box(context, &body, 0.1, 0.3, &bodies[0]));
  body.position[0] = 0.1, body.position[1] = -0.2;
  body.friction = 0.1;
  mps_assert_ok(context, mps_body_create_disc(context, &body, 0.08, &bodies[1]));
  mps_assert_ok(context, mps_body_name_part(bodies[0], "face", 3, 1, NULL));
  for (int b = 0; b < 2; b++) mps_assert_ok(context, mps_mpm_add_body(s.mpm, bodies[b]));
  const mps_mpm_totals start = mpm_scene_totals(&s);
  const double before[3] = {start.linear[0], start.linear[1], start.angular};
  mps_assert_ok(context, mps_mpm_step(s.mpm, 400));
  const mps_mpm_totals end = mpm_scene_totals(&s);
  double after[3] = {end.linear[0], end.linear[1], end.angular};
  mps_reaction face, all;
  mps_assert_ok(context, mps_body_get_reaction(bodies[0], -1, &all));
  mps_assert_ok(context, mps_body_get_reaction(bodies[0], 1, &face));
  assert_true(all.impulse[0] > 1.0); /* it has hit */
  assert_true(face.impulse[0] > 0.0);
  for (int b = 0; b < 2; b++) body_momentum(bodies[b], 20.0, 0.2, after);
  print_message("linear %.2g %.2g, angular %.2g\n", after[0] - before[0], after[1] - before[1],
                after[2] - before[2]);
  const double scale = hypot(before[0], before[1]);
  for (int c = 0; c < 2; c++) mps_assert_near(after[c], before[c], 1e-11 * scale);
  /* The spin that a velocity gradient carries is not that of the nodes where supports are cut. */
  mps_assert_near(after[2], before[2], 1e-4 * scale);
  for (int b = 0; b < 2; b++) mps_body_destroy(&bodies[b]);
  mpm_scene_end(&s);
}

/* Two lumps on the two sides of a wall two cells thick: one strikes it, the other must not move at
 * all, however the wall lies in the grid. */
static void thin_wall_lets_nothing_pass(void **state) {
  (void)state;
  for (int offset = 0; offset < 4; offset++) {
    const double h = 0.02, shift = 0.25 * h * offset;
    mpm_scene s = mpm_scene_begin(context, 0.01, shift, 0.0, 1e5);
    mpm_scene_box(&s, shift - 0.2, -0.1, shift, 0.1);
    mpm_scene_box(&s, shift + 2.0 * h, -0.1, shift + 0.2, 0.1);
    mps_assert_ok(context, mps_particles_add_field(s.particles, "velocity", 0));
    mps_view x = mpm_scene_view(&s, "position"), v = mpm_scene_view(&s, "velocity");
    for (int64_t k = 0; k < x.shape[0]; k++)
      if (*mps_view_f64(&x, k, 0) < shift) *mps_view_f64(&v, k, 0) = 1.0;
    mps_mpm_def def = mps_mpm_defaults();
    def.cell = h;
    mpm_scene_solve(&s, &def);
    mps_body *wall = NULL;
    mps_body_def body = mps_body_defaults();
    body.position[0] =
        shift + h - 0.0005; /* off the lump at rest, which would touch by round-off */
    body.friction = 0.3;
    mps_assert_ok(context, mps_body_create_box(context, &body, 2.0 * h, 1.0, &wall));
    mps_assert_ok(context, mps_mpm_add_body(s.mpm, wall));
    mps_assert_ok(context, mps_mpm_step(s.mpm, 100));
    mps_reaction reaction;
    mps_assert_ok(context, mps_body_get_reaction(wall, -1, &reaction));
    assert_true(reaction.impulse[0] > 1.0);
    x = mpm_scene_view(&s, "position"), v = mpm_scene_view(&s, "velocity");
    for (int64_t k = 0; k < x.shape[0]; k++)
      if (*mps_view_f64(&x, k, 0) > shift + h)
        for (int c = 0; c < 2; c++) mps_assert_near(*mps_view_f64(&v, k, c), 0.0, 0.0);
    mps_body_destroy(&wall);
    mpm_scene_end(&s);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shapes_are_a_partition), cmocka_unit_test(affine_round_trip),
      cmocka_unit_test(free_body_keeps_momentum), cmocka_unit_test(contact_keeps_momentum),
      cmocka_unit_test(thin_wall_lets_nothing_pass)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
