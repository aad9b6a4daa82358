/* test_fluid_corner.c - narrow places at bodies. The last two spacings of the acute corner below an
 * inclined plate may hold no particle, and bear the water's pressure all the same; gaps to a wall
 * that close have bounded pressures; water oscillates through one as in a tube.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

#define L0 0.025
#define LENGTH 1.6 /* m, of the tank; the plate stands in its middle */
#define MIDDLE 0.8
#define TOP 0.6 /* m, of the plate */

typedef struct plate {
  double slope;     /* horizontal over vertical: 1 leans to the right, -1 to the left */
  double thickness; /* along the bed, m */
} plate;

/* m, of the plate's faces left and right of its middle at the height y. */
static double face(const plate *p, int right, double y) {
  return MIDDLE + (right ? 0.5 : -0.5) * p->thickness + p->slope * y;
}

static void fill(const plate *p, mps_particles *water) {
  const double lean = sqrt(1.0 + p->slope * p->slope);
  for (int j = 0; j < 16; j++)
    for (int i = 0; i < 64; i++) {
      const double x[2] = {(i + 0.5) * L0, (j + 0.5) * L0};
      const double off[2] = {(face(p, 0, x[1]) - x[0]) / lean, (x[0] - face(p, 1, x[1])) / lean};
      const int right = off[1] > off[0];
      if (off[right] < 0.45 * L0 || (right && x[1] > 0.2)) continue;
      OK(mps_particles_append(water, 1, x));
    }
}

/* The plate's horizontal force over that of the walls at the ends of the tank, which holds it and
 * its water still, less 1. */
static double error_of(const plate *p) {
  const double xy[8] = {face(p, 0, 0.0), 0.0, face(p, 1, 0.0), 0.0,
                        face(p, 1, TOP), TOP, face(p, 0, TOP), TOP};
  scoped_tank t = {NULL, NULL};
  const mps_body_def at = mps_body_defaults();
  MAKE_KEPT(body, kept, create_polygon, context, &at, 4, xy);
  scoped_body *body = kept;
  USING(particles, mps_particles_create(context, &given, &t.water), .spacing = L0);
  fill(p, t.water);
  USING(fluid, mps_fluid_create(context, t.water, &given, &t.fluid), .level = 0.4);
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  const int32_t left = tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  const int32_t right = tank_wall(t.fluid, LENGTH, 0.0, -1.0, 0.0, NULL);
  USING(fluid_load, mps_fluid_add_load(t.fluid, &given, NULL), .kind = MPS_FLUID_LOAD_DAMPING,
        .rate = 5.0, .all = 1);
  scoped_contact *contact = tank_body(t.fluid, body, MPS_CONTACT_MOVER_OTHER);
  double force[3] = {0.0};
  for (int k = 0; k < 400; k++) {
    mps_reaction r[3];
    OK(mps_fluid_step(t.fluid, 1));
    OK(mps_contact_get_reaction(contact, -1, &r[0]));
    OK(mps_fluid_get_reaction(t.fluid, left, &r[1]));
    OK(mps_fluid_get_reaction(t.fluid, right, &r[2]));
    for (int c = 0; c < 3 && k >= 200; c++) force[c] += r[c].force[0] / 200.0;
  }
  return force[0] / (force[1] + force[2]) - 1.0;
}

TEST(a_corner_without_particles_bears_the_waters_pressure) {
  const double slope[] = {1.0, -1.0}, thickness[] = {2.0, 3.0, 4.0};
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 3; b++) {
      const plate p = {slope[a], thickness[b] * L0 * sqrt(2.0)};
      const double error = error_of(&p);
      print_message("slope %g, %g spacings thick: force %+.2f %%\n", slope[a], thickness[b],
                    100.0 * error);
      NEAR(error, 0.0, 0.005);
    }
}

static void note(void *user, int32_t level, const char *message) {
  (void)level;
  if (strstr(message, "body 0 has a gap of 0.01 m to boundary 0, less than the spacing"))
    ++*(int *)user;
}

/* A box half a spacing above the bed. Particles that get into the gap see one another alone,
 * without a surface: with no datum for their pressure the box had 2e11 N. */
TEST(a_gap_below_a_spacing_is_warned_of) {
  int warnings = 0;
  mps_context_def def = test_context_defaults();
  def.log = note, def.log_user = &warnings;
  scoped_context *own = NULL;
  OK(mps_context_create(&def, &own, NULL, 0));
  scoped_tank t = {NULL, NULL};
  DEF(body, at, .position[0] = 0.6, .position[1] = 0.11);
  MAKE_KEPT(body, kept, create_box, own, &at, 0.2, 0.2);
  scoped_body *body = kept;
  USING(particles, mps_particles_create(own, &given, &t.water), .spacing = 0.02);
  for (int j = 0; j < 20; j++)
    for (int i = 0; i < 60; i++) {
      const double x[2] = {(i + 0.5) * 0.02, (j + 0.5) * 0.02};
      double d;
      OK(mps_body_distance(body, 1, x, &d, NULL, NULL, NULL));
      if (d >= 0.45 * 0.02) OK(mps_particles_append(t.water, 1, x));
    }
  USING(fluid, mps_fluid_create(own, t.water, &given, &t.fluid), .level = 0.4);
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(t.fluid, 1.2, 0.0, -1.0, 0.0, NULL);
  scoped_contact *contact = tank_body(t.fluid, body, MPS_CONTACT_MOVER_OTHER);
  double most = 0.0;
  for (int k = 0; k < 120; k++) {
    mps_reaction r;
    OK(mps_fluid_step(t.fluid, 1));
    OK(mps_contact_get_reaction(contact, -1, &r));
    most = fmax(most, fabs(r.force[1]));
  }
  print_message("force on a box of 392 N of buoyancy at most %.0f N\n", most);
  assert_int_equal(warnings, 1);
  assert_true(most < 5000.0);
}

/* Largest force on a box of 10 spacings that is driven from 3.2 + .2 `place` spacings to .3 before
 * a wall (0), the bed (1) or another box (2), over rho g times its side and the depth. */
static double squeeze(int towards, int place, double l0, double speed) {
  const double side = 10.0 * l0, depth = 20.0 * l0, from = (3.2 + 0.2 * place) * l0;
  const double beside = 0.125 * place * l0, way = from - 0.3 * l0, whole = 1.875 * way / speed;
  double at[2][2] = {{55.0 * l0 - from, side + beside}, {30.0 * l0 + from, side + beside}};
  if (towards == 1) at[0][0] = 30.0 * l0 + beside, at[0][1] = 0.5 * side + from;
  if (towards == 2) at[0][0] = 20.0 * l0;
  const int bodies = towards == 2 ? 2 : 1;
  mps_body *made[2] = {NULL, NULL};
  MAKE(signal, ramp, create_ramp, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0.0, whole,
       towards == 1 ? -way : way);
  for (int b = 0; b < bodies; b++)
    USING(body, mps_body_create_box(context, &given, side, side, &made[b]), .position[0] = at[b][0],
          .position[1] = at[b][1]);
  scoped_body *box = made[0], *other = made[1];
  OK(mps_body_drive(box, towards == 1 ? 1 : 0, ramp, 1.0));
  scoped_tank t = {NULL, NULL};
  USING(particles, mps_particles_create(context, &given, &t.water), .spacing = l0);
  for (int k = 0; k < 1200; k++) {
    const double x[2] = {(k % 60 + 0.5) * l0, (k / 60 + 0.5) * l0};
    double d = INFINITY;
    for (int b = 0; b < bodies; b++)
      d = fmin(d, fmax(fabs(x[0] - at[b][0]), fabs(x[1] - at[b][1])) - 0.5 * side);
    if (d > 0.45 * l0) OK(mps_particles_append(t.water, 1, x));
  }
  USING(fluid, mps_fluid_create(context, t.water, &given, &t.fluid), .level = depth);
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(t.fluid, 60.0 * l0, 0.0, -1.0, 0.0, NULL);
  scoped_contact *contact = tank_body(t.fluid, box, MPS_CONTACT_MOVER_SOLVER);
  scoped_contact *second = other ? tank_body(t.fluid, other, MPS_CONTACT_MOVER_SOLVER) : NULL;
  double most = 0.0;
  while (mps_fluid_time(t.fluid) < whole) {
    mps_reaction r;
    const mps_status status = mps_fluid_step(t.fluid, 1);
    if (status == MPS_ERROR_DIVERGED) break; /* a particle leaves the gap by too long a way */
    OK(status);
    OK(mps_contact_get_reaction(contact, -1, &r));
    most = fmax(most, hypot(r.force[0], r.force[1]));
  }
  return most / (1000.0 * TANK_G * depth * side);
}

/* Particles in a closing gap part from one another along it. Some, or a row, saw no others and no
 * surface: with no datum for their pressure the box had 1e2 to 1e11 times rho g depth side. */
TEST(closing_gaps_have_bounded_pressures) {
  for (int towards = 0; towards < 3; towards++)
    for (int n = 0; n < (test_quick() ? 1 : 3); n++) {
      const double l0 = (double[]){0.02, 0.01, 0.03}[n], unit = sqrt(TANK_G * l0);
      double most = 0.0;
      for (int place = n; place < 5; place += 2)
        most = fmax(most, squeeze(towards, place, l0, (n == 1 ? 1.0 : 3.0) * unit));
      print_message("towards %d, l0 %g m: force at most %.3g of rho g depth side\n", towards, l0,
                    most);
      assert_true(most < 100.0);
    }
}

/* Two legs of .1 m, joined below a wall .2 m thick that ends .1 m above the bed, .4 m of water: the
 * first period from zero to zero of the levels, which begin `rows` above and below rest, over 2 pi
 * (N .1 m/(2 g))^1/2. N is the tube's length over its width; a corner of 90 degrees counts .559 in
 * potential flow. */
static double time_tube(double l0, int rows) {
  const double leg = 0.1, wall = 0.2, depth = 0.4, N = 2.0 * 3.0 + 2.0 + 2.0 * 0.559;
  const double period = 2.0 * TANK_PI * sqrt(N * leg / (2.0 * TANK_G));
  const int columns = (int)lround(0.4 / l0), layers = (int)lround(depth / l0);
  DEF(body, at, .position[0] = 0.2, .position[1] = 0.4);
  MAKE(body, box, create_box, context, &at, wall, 0.6);
  scoped_tank t = {NULL, NULL};
  USING(particles, mps_particles_create(context, &given, &t.water), .spacing = l0);
  for (int i = 0; i < columns; i++)
    for (int j = 0; j < layers + (2 * i < columns ? rows : -rows); j++) {
      const double x[2] = {(i + 0.5) * l0, (j + 0.5) * l0};
      if (fabs(x[0] - 0.2) > 0.1 || x[1] < 0.1) OK(mps_particles_append(t.water, 1, x));
    }
  USING(fluid, mps_fluid_create(context, t.water, &given, &t.fluid), .level = depth);
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(t.fluid, 0.4, 0.0, -1.0, 0.0, NULL);
  scoped_contact *contact = tank_body(t.fluid, box, MPS_CONTACT_MOVER_OTHER);
  double zero[3] = {0.0}, last = 1.0, before = 0.0;
  for (int n = 0; n < 3;) {
    const double station[4] = {0.025, 0.075, 0.325, 0.375};
    double level[4];
    OK(mps_fluid_step(t.fluid, 1));
    OK(mps_fluid_get_levels(t.fluid, 4, station, level));
    const double now = level[0] + level[1] - level[2] - level[3], time = mps_fluid_time(t.fluid);
    assert_true(time < 2.0 * period);
    if (last * now < 0.0) zero[n++] = before + (time - before) * last / (last - now);
    last = now, before = time;
  }
  return (zero[2] - zero[0]) / period;
}

TEST(water_oscillates_under_a_wall_as_in_a_tube) {
  for (int n = 0; n < (test_quick() ? 1 : 2); n++) {
    const double l0 = (double[]){0.02, 0.0125}[n], ratio = time_tube(l0, n == 1 ? 2 : 1);
    print_message("l0 %g m: period %.4f of that of a tube\n", l0, ratio);
    NEAR(ratio, 1.0, 0.01);
  }
}
