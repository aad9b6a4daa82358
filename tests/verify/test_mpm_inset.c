/* test_mpm_inset.c - a rigid strip whose base ends at inset edges, pressed into clay without weight
 * wherever its edges lie between lines of the grid: Prandtl's bearing capacity (2 + pi) c, the same
 * of the mirrored scene, and no particle inside the strip. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define CELL 0.1     /* m */
#define COHESION 1e4 /* Pa */
#define YOUNG 1e9    /* Pa */
#define SPEED 5e-3   /* m/s */
#define PATH 0.6e-3  /* m */
#define WIDTH 2.0    /* m, of the half of the ground that is computed */
#define HEIGHT 1.0

typedef struct strip {
  mpm_scene s;
  mps_body *body;
  double half_width;
} strip;

static void end(strip *x) {
  mpm_scene_end(&x->s);
  mps_body_destroy(&x->body);
}

/* The half of the strip at x > 0 or, mirrored, x < 0. */
static strip begin(double half_width, bool mirrored) {
  strip x = {.s = mpm_scene_begin(context, 0.5 * CELL, 0.0, 0.0, YOUNG), .half_width = half_width};
  mps_material_destroy(&x.s.material);
  DEF(material_von_mises, law, .young = YOUNG, .poisson = 0.3,
      .yield_stress = sqrt(3.0) * COHESION);
  OK(mps_material_create_von_mises(context, &law, &x.s.material));
  const double left = mirrored ? -WIDTH : 0.0;
  mpm_scene_box(&x.s, left, 0.0, left + WIDTH, HEIGHT);
  USING(mpm, mpm_scene_solve(&x.s, &given), .cell = CELL, .flip_time = 0.01, .lower[0] = left,
        .upper[0] = left + WIDTH, .lower[1] = 0.0);
  mpm_scene_side(&x.s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  const double t[3] = {0.0, 0.01, 1.0}, v[3] = {0.0, SPEED, SPEED};
  scoped_signal *down = NULL;
  OK(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, t, v, &down));
  DEF(body, body, .position[1] = HEIGHT + 0.25);
  OK(mps_body_create_box(context, &body, 2.0 * half_width, 0.5, &x.body));
  OK(mps_body_drive(x.body, 1, down, -1.0));
  USING(contact, mps_mpm_add_contact(x.s.mpm, x.body, &given, NULL), .inset = 0.6 * CELL);
  return x;
}

static void none_is_inside(strip *x) {
  const mps_view at = mpm_scene_view(&x->s, "position");
  for (int64_t k = 0; k < at.shape[0]; k++) {
    const double p[2] = {*mps_view_f64(&at, k, 0), *mps_view_f64(&at, k, 1)};
    double distance;
    OK(mps_body_distance(x->body, 1, p, &distance, NULL, NULL, NULL));
    assert_true(distance > 0.0);
  }
}

/* Mean pressure under the strip over the cohesion, in the last eighth of the path. */
static double capacity_of(strip *x) {
  enum { PARTS = 8 };
  const double time = (PATH + 0.5 * SPEED * 0.01) / SPEED;
  double before = 0.0, since = 0.0;
  mps_reaction r;
  for (int k = 1; k <= PARTS; k++) {
    OK(mps_body_get_reaction(x->body, -1, &r));
    before = r.impulse[1], since = mps_mpm_time(x->s.mpm);
    OK(mps_mpm_run(x->s.mpm, time * k / PARTS, INT64_MAX, NULL, NULL));
    none_is_inside(x);
  }
  OK(mps_body_get_reaction(x->body, -1, &r));
  return (r.impulse[1] - before) / (mps_mpm_time(x->s.mpm) - since) / x->half_width / COHESION;
}

static double capacity(double cells, bool mirrored) {
  SCOPED(end) strip x = begin(cells * CELL, mirrored);
  return capacity_of(&x);
}

/* Sharp edges bear 3.6 to 13 % too much there, rounded ones 1 to 6 % too little. */
TEST(edges_bear_alike_wherever_they_lie) {
  const double exact = 2.0 + PI;
  double least = INFINITY, most = 0.0;
  for (int k = 0; k < 5; k++) {
    const double q = capacity(5.0 + 0.125 * k, false);
    print_message("half width %.3f cells: %.4f, %+.1f %%\n", 5.0 + 0.125 * k, q,
                  100.0 * (q / exact - 1.0));
    NEAR(q, exact, 0.03 * exact);
    least = fmin(least, q), most = fmax(most, q);
  }
  assert_true(most - least < 0.03 * exact);
  NEAR(capacity(5.25, true), capacity(5.25, false), 1e-3 * exact);
}
