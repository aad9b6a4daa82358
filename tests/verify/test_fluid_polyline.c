/* test_fluid_polyline.c - boundaries with concave and convex corners: still water in corners of 15
 * to 345 degrees of fluid against hydrostatics. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#define L0 0.025
#define RAD 0.017453292519943295

typedef struct basin {
  mps_particles *water;
  mps_fluid *fluid;
  double corner[8][3];
  int corners;
  double width, depth; /* m */
} basin;

/* Distance (m) of a point from a polyline; inside: whether it is in the fluid, by the upward ray.
 */
static double distance(const basin *b, const double *x) {
  double least = INFINITY;
  for (int k = 0; k + 1 < b->corners; k++) {
    const double *p = b->corner[k], *q = b->corner[k + 1], e[2] = {q[0] - p[0], q[1] - p[1]};
    const double s =
        fmin(fmax(((x[0] - p[0]) * e[0] + (x[1] - p[1]) * e[1]) / (e[0] * e[0] + e[1] * e[1]), 0.0),
             1.0);
    least = fmin(least, hypot(x[0] - p[0] - s * e[0], x[1] - p[1] - s * e[1]));
  }
  return least;
}

static double ground(const basin *b, double x) {
  for (int k = 0; k + 1 < b->corners; k++) {
    const double *p = b->corner[k], *q = b->corner[k + 1];
    if (x >= p[0] && x <= q[0] && q[0] > p[0])
      return p[1] + (q[1] - p[1]) * (x - p[0]) / (q[0] - p[0]);
  }
  return -INFINITY;
}

static void fill(basin *b) {
  USING(particles, mps_particles_create(context, &given, &b->water), .spacing = L0);
  for (double y = 0.5 * L0; y < b->depth; y += L0)
    for (double x = -b->width + 0.5 * L0; x < b->width; x += L0) {
      const double at[2] = {x, y};
      if (y < ground(b, x) || distance(b, at) < 0.45 * L0) continue;
      OK(mps_particles_append(b->water, 1, at));
    }
}

static void add_side(basin *b, double x, double normal) {
  DEF(fluid_boundary, def, .kind = MPS_BOUNDARY_ROLLER, .point[0] = x, .normal[0] = normal);
  OK(mps_fluid_add_boundary(b->fluid, &def, NULL));
}

static void add_line(basin *b) {
  USING(fluid_boundary, mps_fluid_add_boundary(b->fluid, &given, NULL), .kind = MPS_BOUNDARY_ROLLER,
        .corners = b->corner[0], .corner_count = b->corners);
}

/* A V of `angle` degrees below 180, or a wedge of 360 - angle on a bed between walls. */
static void make_basin(basin *b, double angle) {
  const double half = 0.5 * angle * RAD;
  *b = (basin){.depth = 0.5};
  if (angle < 180.0) {
    const double high = 1.4 * b->depth, out = high * tan(half);
    const double corner[3][3] = {{-out, high, 0.0}, {0.0, 0.0, 0.0}, {out, high, 0.0}};
    memcpy(b->corner, corner, sizeof corner);
    b->corners = 3, b->width = floor(out / L0) * L0;
  } else {
    const double slope = tan(180.0 * RAD - half); /* feet on the lattice */
    const double foot = ceil(0.2 * slope / L0) * L0, tip = foot / slope;
    const double corner[5][3] = {{-foot - 0.4, 0.0, 0.0},
                                 {-foot, 0.0, 0.0},
                                 {0.0, tip, 0.0},
                                 {foot, 0.0, 0.0},
                                 {foot + 0.4, 0.0, 0.0}};
    memcpy(b->corner, corner, sizeof corner);
    b->corners = 5, b->width = round((foot + 0.4) / L0) * L0;
  }
  fill(b);
  USING(fluid, mps_fluid_create(context, b->water, &given, &b->fluid), .level = b->depth);
  if (angle > 180.0) add_side(b, -b->width, 1.0), add_side(b, b->width, -1.0);
  add_line(b);
}

static void drop_basin(basin *b) {
  mps_fluid_destroy(&b->fluid);
  mps_particles_destroy(&b->water);
}

/* Particles on the solid's side of the polyline. */
static int count_leaked(const basin *b) {
  int leaked = 0;
  mps_view x = view_field(b->water, "position");
  for (int64_t i = 0; i < x.shape[0]; i++)
    leaked += *mps_view_f64(&x, i, 1) < ground(b, *mps_view_f64(&x, i, 0));
  return leaked;
}

typedef struct rest {
  double worst, side; /* largest error of a pressure, over rho g depth; |Fx| over the weight */
} rest;

static void compare(const basin *b, int32_t line, rest *r) {
  enum { MOST = 200 };
  double level, x[3 * MOST], p[MOST];
  const double station = 0.0, weight = 9810.0 * L0 * L0 * (double)mps_particles_count(b->water);
  int64_t points;
  mps_reaction force;
  OK(mps_fluid_get_levels(b->fluid, 1, &station, &level));
  OK(mps_fluid_get_boundary_points(b->fluid, line, MOST, &points, x, p));
  OK(mps_fluid_get_reaction(b->fluid, line, &force));
  assert_true(points >= 30 && points <= MOST);
  for (int64_t k = 0; k < points; k++)
    r->worst = fmax(r->worst, fabs(p[k] / 9810.0 - level + x[3 * k + 1]) / level);
  r->side = fmax(r->side, fabs(force.force[0]) / weight);
}

/* Water settles from the steps of its lattice, at first with damping. */
static void settle(const basin *b) {
  DEF(fluid_load, damping, .all = 1, .kind = MPS_FLUID_LOAD_DAMPING, .rate = 5.0);
  int32_t number;
  OK(mps_fluid_add_load(b->fluid, &damping, &number));
  OK(mps_fluid_step(b->fluid, 400));
  OK(mps_fluid_remove_load(b->fluid, number));
}

/* Pressures of settled water are those below its level. */
static void still(double angle, int steps) {
  basin b;
  rest r = {0.0, 0.0};
  mps_totals sum;
  make_basin(&b, angle);
  const int32_t line = angle > 180.0 ? 2 : 0;
  settle(&b);
  for (int n = 0; n < 10; n++) {
    OK(mps_fluid_step(b.fluid, steps / 10));
    compare(&b, line, &r);
    assert_int_equal(count_leaked(&b), 0);
  }
  OK(mps_fluid_get_totals(b.fluid, &sum));
  const double weight = 9810.0 * L0 * L0 * (double)mps_particles_count(b.water);
  const double scheme =
      hypot(sum.impulse_scheme[0], sum.impulse_scheme[1]) / (weight * mps_fluid_time(b.fluid));
  printf("%g degrees, %lld particles: pressure within %.2f %% of rho g depth, side force %.1e of "
         "the weight, momentum error %.1e of it, kinetic energy %.1e J, dissipated %.1e J\n",
         angle, (long long)mps_particles_count(b.water), 100.0 * r.worst, r.side, scheme,
         sum.kinetic, sum.dissipated);
  assert_true(r.worst < 0.02);
  assert_true(r.side < 2e-3);
  assert_true(scheme < 0.02);
  assert_true(sum.dissipated > 0.0);
  assert_true(sum.kinetic < 0.1);
  drop_basin(&b);
}

TEST(water_stays_still_in_corners) {
  static const double angles[] = {15.0, 30.0, 60.0, 90.0, 330.0, 345.0};
  for (size_t k = 0; k < sizeof angles / sizeof *angles; k++) still(angles[k], 2000);
}

TEST(water_stays_still_in_wide_corners) {
  static const double angles[] = {150.0, 210.0, 270.0};
  for (size_t k = 0; k < sizeof angles / sizeof *angles; k++) still(angles[k], 500);
}

/* ---- impact ---------------------------------------------------------------------------------- */

enum { COLUMNS = 16, ROWS = 10, HALF = COLUMNS / 2 };

/* A block of .4 x .25 m above the tip of a wedge of `solid` degrees, falling at 2 m/s. */
static void make_block(basin *b, double solid) {
  const double out = tan(0.5 * solid * RAD);
  const double corner[3][3] = {{-out, -1.0, 0.0}, {0.0, 0.0, 0.0}, {out, -1.0, 0.0}};
  double v[2 * COLUMNS * ROWS];
  *b = (basin){.corners = 3};
  memcpy(b->corner, corner, sizeof corner);
  USING(particles, mps_particles_create(context, &given, &b->water), .spacing = L0);
  for (int n = 0; n < COLUMNS * ROWS; n++) {
    const double at[2] = {(n % COLUMNS - HALF + 0.5) * L0, (n / COLUMNS + 1.0) * L0};
    OK(mps_particles_append(b->water, 1, at));
    v[2 * n] = 0.0, v[2 * n + 1] = -2.0;
  }
  OK(mps_particles_add_field(b->water, "velocity", 0));
  EDIT(edit, b->water, "velocity")
    for (int n = 0; n < COLUMNS * ROWS; n++)
      for (int c = 0; c < 2; c++) *mps_edit_f64(&edit, n, c) = v[2 * n + c];
  USING(fluid, mps_fluid_create(context, b->water, &given, &b->fluid), .level = 0.0);
  add_line(b);
}

/* Largest difference (l0) of a particle's place from the mirror image of its twin's. */
static double asymmetry(const basin *b, double *middle) {
  double x[COLUMNS * ROWS][2], worst = 0.0;
  mps_view v = view_field(b->water, "position");
  mps_view id = view_field(b->water, "id");
  *middle = 0.0;
  for (int64_t i = 0; i < v.shape[0]; i++)
    for (int c = 0; c < 2; c++) x[*mps_view_i64(&id, i, 0)][c] = *mps_view_f64(&v, i, c);
  for (int n = 0; n < COLUMNS * ROWS; n++) {
    const int twin = n / COLUMNS * COLUMNS + COLUMNS - 1 - n % COLUMNS;
    worst = fmax(worst, hypot(x[n][0] + x[twin][0], x[n][1] - x[twin][1]) / L0);
    *middle += x[n][0] / L0 / (COLUMNS * ROWS);
  }
  return worst;
}

static void strike(double solid) {
  basin b;
  mps_totals before, after;
  double middle, early = 0.0;
  make_block(&b, solid);
  OK(mps_fluid_get_totals(b.fluid, &before));
  const double energy = before.kinetic + before.strain;
  double gained = -INFINITY;
  while (mps_fluid_time(b.fluid) < 0.25) {
    OK(mps_fluid_step(b.fluid, 1));
    OK(mps_fluid_get_totals(b.fluid, &after));
    gained = fmax(gained, after.kinetic + after.strain - energy);
    assert_int_equal(count_leaked(&b), 0);
    if (mps_fluid_time(b.fluid) < 0.05) early = fmax(early, asymmetry(&b, &middle));
  }
  mps_reaction r;
  OK(mps_fluid_get_reaction(b.fluid, 0, &r));
  asymmetry(&b, &middle);
  const double start = before.kinetic, impulse = -before.linear[1];
  printf("wedge of %g degrees: impulse up %.1f N s of %.1f, to the side %.1g N s, momentum error "
         "%.3f, "
         "energy at most %+.2f %% of the start, %+.2f %% at last, twins apart %.1e l0 at .05 s, "
         "middle %.1e l0 at "
         ".25 s\n",
         solid, r.impulse[1], impulse, r.impulse[0],
         hypot(after.impulse_scheme[0], after.impulse_scheme[1]) / impulse, 100.0 * gained / start,
         -100.0 * after.dissipated / start, early, middle);
  for (int c = 0; c < 2; c++)
    NEAR(after.linear[c] - before.linear[c],
         after.impulse_loads[c] + r.impulse[c] + after.impulse_scheme[c], 1e-9 * impulse);
  assert_true(r.impulse[1] > 0.0);
  assert_true(fabs(r.impulse[0]) < 0.02 * r.impulse[1]);
  assert_true(hypot(after.impulse_scheme[0], after.impulse_scheme[1]) < 0.055 * impulse);
  assert_true(gained < 0.001 * start);
  assert_true(after.dissipated > 0.0);
  assert_true(early < 1e-3);
  drop_basin(&b);
}

TEST(water_parts_at_a_tip) {
  strike(15.0);
  strike(60.0);
  strike(120.0);
}

/* ---- a baffle -------------------------------------------------------------------------------- */

/* A tank of .96 m, .4 m deep, with an upright baffle .24 m high and .08 m thick, `offset`
 * spacings from its middle, tilted for .3 s: part of the amplitude that is left after three periods
 * of 1.406 s, those of linear theory. */
static double baffle(int spacings, double offset, double tilt) {
  const double l0 = 0.4 / spacings, middle = 0.48 + offset * l0;
  const double corner[6][3] = {{-1.0, 0.0, 0.0},           {middle - 0.04, 0.0, 0.0},
                               {middle - 0.04, 0.24, 0.0}, {middle + 0.04, 0.24, 0.0},
                               {middle + 0.04, 0.0, 0.0},  {2.0, 0.0, 0.0}};
  basin b = {.corners = 6, .width = 0.96, .depth = 0.4};
  memcpy(b.corner, corner, sizeof corner);
  USING(particles, mps_particles_create(context, &given, &b.water), .spacing = l0);
  for (double y = 0.5 * l0; y < 0.4; y += l0)
    for (double x = 0.5 * l0; x < 0.96; x += l0) {
      const double at[2] = {x, y};
      if (y < ground(&b, x) || distance(&b, at) < 0.45 * l0) continue;
      OK(mps_particles_append(b.water, 1, at));
    }
  USING(fluid, mps_fluid_create(context, b.water, &given, &b.fluid), .level = 0.4);
  add_line(&b);
  add_side(&b, 0.0, 1.0);
  add_side(&b, 0.96, -1.0);
  int32_t load;
  USING(fluid_load, mps_fluid_add_load(b.fluid, &given, &load), .acceleration[0] = tilt * 9.81,
        .all = 1);
  OK(mps_fluid_run(b.fluid, 0.3, 1, NULL, NULL));
  OK(mps_fluid_remove_load(b.fluid, load));
  const double station[2] = {l0, 0.96 - l0};
  double most[4] = {0.0}, level[2]; /* m: in each period */
  for (;;) {
    const int period = (int)((mps_fluid_time(b.fluid) - 0.3) / 1.406);
    if (period > 3) break;
    OK(mps_fluid_get_levels(b.fluid, 2, station, level));
    most[period] = fmax(most[period], fabs(level[1] - level[0]));
    OK(mps_fluid_step(b.fluid, 1));
  }
  drop_basin(&b);
  const double left = most[3] / most[0];
  print_message("baffle, d/%d, %+.2f l0, tilt %.4f: %.3f of the amplitude left in three periods\n",
                spacings, offset, tilt, left);
  return left;
}

/* The flow around its corners, which no linear field is, is not smoothed. */
TEST(water_sloshes_over_a_baffle) {
  assert_true(baffle(10, 0.0, 0.005) > 0.6);
  assert_true(baffle(20, 0.0, 0.005) > 0.85);
  assert_true(baffle(20, 0.5, 0.02) > 0.85);
}
