/* test_mpm_crest.c - a smooth strip at the edge of the crest of a slope, or of a vertical cut, in
 * clay without weight: (2 + pi - 2 beta) c, Prandtl's mechanism with the slope as its free surface,
 * wherever the crest lies on the grid, mirrored, and of any stiffness. A rough strip that cannot
 * move aside bears more.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define COHESION 1e4 /* Pa */
#define DENSITY 1e3  /* kg/m3 */
#define POISSON 0.3
#define WIDTH 1.0 /* m, of the strip */
#define LEFT 3.2  /* m, of the level ground */
#define RIGHT 2.2 /* m, of the slope at most */
#define DEPTH 1.6 /* m */
#define PATH 15.0 /* c/E widths */
#define SPEED 0.1 /* of c/(rho G)^1/2 */

typedef struct crest_case {
  double angle, cell, young, at[2]; /* degrees, m, Pa; cells, of the crest off a node */
  bool mirrored;
  double friction;
} crest_case;

/* The ground, its crest at the origin. */
static void fill(mpm_scene *s, const crest_case *c) {
  const double slope = c->angle < 89.0 ? tan(c->angle * PI / 180.0) : INFINITY;
  const double foot = fmin(DEPTH / slope, RIGHT), side = c->mirrored ? -1.0 : 1.0;
  const double end = foot < RIGHT ? 0.5 : 1.0; /* of the slope at which it has a corner */
  const double xy[5][2] = {{-LEFT, -DEPTH},
                           {foot, -DEPTH},
                           {end * foot, -end * fmin(DEPTH, slope * RIGHT)},
                           {0.0, 0.0},
                           {-LEFT, 0.0}};
  double of[5][2];
  for (int k = 0; k < 5; k++) {
    const int from = c->mirrored ? 4 - k : k;
    of[k][0] = side * xy[from][0], of[k][1] = xy[from][1];
  }
  OK(mps_particles_fill_polygon(s->particles, 5, of[0], NULL));
}

static void hold(mps_mpm *mpm, double left, double right, double top) {
  DEF(mpm_boundary, def, .kind = MPS_BOUNDARY_HELD);
  for (int c = 0; c < 3; c++) def.lower[c] = -INFINITY, def.upper[c] = INFINITY;
  def.lower[0] = left, def.upper[0] = right, def.upper[1] = top;
  OK(mps_mpm_add_boundary(mpm, &def, NULL));
}

/* Mean pressure over the cohesion, in the last fifth of the path. */
static double capacity(const crest_case *c) {
  const double E = c->young, side = c->mirrored ? -1.0 : 1.0, little = 1e-6;
  const double speed = SPEED * COHESION / sqrt(DENSITY * 0.5 * E / (1.0 + POISSON));
  const double path = PATH * COHESION / E * WIDTH, ramp = 0.1 * path / speed;
  const double end = path / speed + 0.5 * ramp;
  scoped_mpm_scene s = mpm_scene_begin(context, 0.5 * c->cell, 0.0, 0.0, E);
  mps_material_destroy(&s.material);
  DEF(material_von_mises, law, .young = E, .poisson = POISSON,
      .yield_stress = sqrt(3.0) * COHESION);
  OK(mps_material_create_von_mises(context, &law, &s.material));
  fill(&s, c);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = c->cell, .origin[0] = c->at[0] * c->cell,
        .origin[1] = c->at[1] * c->cell);
  hold(s.mpm, -INFINITY, INFINITY, -DEPTH + c->cell);
  hold(s.mpm, c->mirrored ? LEFT - c->cell : -INFINITY, c->mirrored ? INFINITY : -LEFT + c->cell,
       INFINITY);
  if (tan(c->angle * PI / 180.0) * RIGHT < DEPTH)
    hold(s.mpm, c->mirrored ? -INFINITY : RIGHT - c->cell - little,
         c->mirrored ? -RIGHT + c->cell + little : INFINITY, INFINITY);
  const double t[3] = {0.0, ramp, 2.0 * end}, v[3] = {0.0, speed, speed};
  scoped_signal *down = NULL;
  OK(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, t, v, &down));
  DEF(body, body, .position[0] = -0.5 * side * WIDTH, .position[1] = 0.3);
  MAKE(body, strip, create_box, context, &body, WIDTH, 0.6);
  OK(mps_body_drive(strip, 1, down, -1.0));
  USING(contact, mps_mpm_add_contact(s.mpm, strip, &given, NULL), .friction = c->friction,
        .inset = 0.6 * c->cell);
  mps_reaction before, after;
  OK(mps_mpm_run(s.mpm, 0.8 * end, INT64_MAX, NULL, NULL));
  OK(mps_body_get_reaction(strip, -1, &before));
  OK(mps_mpm_run(s.mpm, end, INT64_MAX, NULL, NULL));
  OK(mps_body_get_reaction(strip, -1, &after));
  const double q = (after.impulse[1] - before.impulse[1]) / (0.2 * end * WIDTH * COHESION);
  const double exact = 2.0 + PI - c->angle * PI / 90.0;
  print_message(
      "%g degrees, cell %g m, E %g Pa, crest at (%g, %g), mirrored %d, mu %g: %.4f, %+.1f %%\n",
      c->angle, c->cell, E, c->at[0], c->at[1], c->mirrored, c->friction, q,
      100.0 * (q / exact - 1.0));
  return q / exact;
}

TEST(bears_by_the_angle_of_the_slope) {
  const double angle[5] = {0.0, 30.0, 45.0, 60.0, 90.0};
  for (int k = 0; k < 5; k++) {
    const crest_case on = {angle[k], 0.1, 1e9, {0.0, 0.0}, false, 0.0};
    NEAR(capacity(&on), 1.0, 0.04);
    const crest_case off = {angle[k], 0.1, 1e8, {0.3, 0.4}, true, 0.0};
    NEAR(capacity(&off), 1.0, 0.05);
  }
}

TEST(the_mirrored_crest_bears_the_same) {
  crest_case c = {30.0, 0.1, 1e9, {0.25, 0.0}, false, 0.0};
  const double q = capacity(&c);
  c.mirrored = true, c.at[0] = -0.25;
  NEAR(capacity(&c), q, 2e-3);
}

/* Held against moving aside, it is the base of a wedge of one side: on a cut at most the 2^1.5 c of
 * a wedge that slides below it. */
TEST(a_rough_strip_that_stays_bears_more) {
  const crest_case slope = {30.0, 0.1, 1e9, {0.0, 0.0}, false, 10.0};
  const crest_case cut = {90.0, 0.1, 1e9, {0.0, 0.0}, false, 10.0};
  assert_true(capacity(&slope) > 1.04);
  const double q = 2.0 * capacity(&cut);
  assert_true(q > 2.1 && q < 2.0 * sqrt(2.0));
}
