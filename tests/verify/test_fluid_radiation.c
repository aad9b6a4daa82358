/* test_fluid_radiation.c - added mass and damping of a box that moves in the surface, against
 * potential flow. A sharp edge sheds vortices, which take a part that falls with the amplitude: the
 * reference is that of small motion.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_radiation.h"
#include "fluid_tank.h"

#define DEPTH 0.6
#define WIDTH 0.4
#define DRAUGHT 0.2
#define ZONE 1.4 /* m, where waves fade; .4 m beside the box */
#define RAMP 2.0 /* periods */
#define FROM 3.0 /* periods: what is measured */
#define TO 6.0

enum { TERMS = 7 }; /* three harmonics and the mean */

typedef struct swing {
  double amplitude, period;
} swing;

/* Sine with a smooth start. */
static mps_status swings(void *user, double t, double motion[3]) {
  const swing *s = user;
  const double w = 2.0 * TANK_PI / s->period, r = w / (2.0 * RAMP), A = s->amplitude;
  const bool starts = t < RAMP * s->period;
  const double size = !starts ? 1.0 : t > 0.0 ? 0.5 * (1.0 - cos(r * t)) : 0.0;
  const double rate = starts && t > 0.0 ? 0.5 * r * sin(r * t) : 0.0;
  const double bend = starts && t > 0.0 ? 0.5 * r * r * cos(r * t) : 0.0;
  motion[0] = A * size * sin(w * t);
  motion[1] = A * (rate * sin(w * t) + w * size * cos(w * t));
  motion[2] = A * ((bend - w * w * size) * sin(w * t) + 2.0 * w * rate * cos(w * t));
  return MPS_OK;
}

typedef struct flume {
  tank t;
  mps_body *body;
  mps_contact *contact;
  double middle, length;
} flume;

static void free_flume(flume *s) {
  tank_free(&s->t);
  mps_contact_destroy(&s->contact);
  mps_body_destroy(&s->body);
}

/* Heave is symmetric: half of the box at a wall, and one zone. */
static flume make_flume(radiation_mode mode, double l0, swing *motion) {
  const bool half = mode == RADIATION_HEAVE;
  flume s = {.length = (half ? 0.5 : 1.0) * WIDTH + (half ? 1.0 : 2.0) * (0.4 + ZONE)};
  scoped_signal *signal = NULL;
  s.middle = half ? 0.0 : 0.5 * s.length;
  DEF(body, at, .position[0] = s.middle, .position[1] = DEPTH);
  OK(mps_body_create_box(context, &at, WIDTH, 2.0 * DRAUGHT, &s.body));
  USING(particles, mps_particles_create(context, &given, &s.t.water), .spacing = l0);
  for (int j = 0; j < (int)lround(DEPTH / l0); j++)
    for (int i = 0; i < (int)lround(s.length / l0); i++) {
      const double x[2] = {(i + 0.5) * l0, (j + 0.5) * l0};
      const bool inside = fabs(x[0] - s.middle) < 0.5 * WIDTH && x[1] > DEPTH - DRAUGHT;
      if (!inside) OK(mps_particles_append(s.t.water, 1, x));
    }
  USING(fluid, mps_fluid_create(context, s.t.water, &given, &s.t.fluid), .level = DEPTH);
  tank_wall(s.t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(s.t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(s.t.fluid, s.length, 0.0, -1.0, 0.0, NULL);
  for (int side = half ? 1 : 0; side < 2; side++) {
    DEF(fluid_load, zone, .kind = MPS_FLUID_LOAD_DAMPING, .rate = 10.0 / motion->period);
    zone.rise = side ? 1 : -1;
    zone.lower[0] = side ? s.length - ZONE : 0.0, zone.upper[0] = side ? s.length : ZONE;
    OK(mps_fluid_add_load(s.t.fluid, &zone, NULL));
  }
  OK(mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, swings, motion, NULL,
                            &signal));
  OK(mps_body_drive(s.body,
                    mode == RADIATION_ROLL    ? 5
                    : mode == RADIATION_HEAVE ? 1
                                              : 0,
                    signal, 1.0));
  s.contact = tank_body(s.t.fluid, s.body, MPS_CONTACT_MOVER_SOLVER);
  return s;
}

static void eliminate(double A[TERMS][TERMS], double *right) {
  for (int p = 0; p < TERMS; p++)
    for (int i = 0; i < TERMS; i++) {
      const double factor = A[i][p] / A[p][p];
      if (i == p) continue;
      for (int j = 0; j < TERMS; j++) A[i][j] -= factor * A[p][j];
      right[i] -= factor * right[p];
    }
  for (int p = 0; p < TERMS; p++) right[p] /= A[p][p];
}

/* -F = (buoyancy - w^2 mass) x + damping dx/dt, by a fit of harmonics to the force (moment) of the
 * water. */
static radiation measure(radiation_mode mode, double l0, swing motion) {
  SCOPED(free_flume) flume s = make_flume(mode, l0, &motion);
  const double w = 2.0 * TANK_PI / motion.period, part = mode == RADIATION_HEAVE ? 2.0 : 1.0;
  double A[TERMS][TERMS] = {{0}}, F[TERMS] = {0};
  while (mps_fluid_time(s.t.fluid) < TO * motion.period) {
    mps_reaction r;
    OK(mps_fluid_step(s.t.fluid, 1));
    const double t = mps_fluid_time(s.t.fluid);
    if (t < FROM * motion.period) continue;
    OK(mps_contact_get_reaction(s.contact, -1, &r));
    const double force = mode == RADIATION_ROLL ? r.moment[2] : r.force[mode];
    double wave[TERMS] = {1.0};
    for (int k = 0; k < TERMS / 2; k++)
      wave[1 + 2 * k] = sin((k + 1) * w * t), wave[2 + 2 * k] = cos((k + 1) * w * t);
    for (int i = 0; i < TERMS; i++) {
      for (int j = 0; j < TERMS; j++) A[i][j] += wave[i] * wave[j];
      F[i] += part * force * wave[i];
    }
  }
  eliminate(A, F);
  const double unit = 1000.0 * TANK_G;
  const double buoyancy[] = {0.0, unit * WIDTH,
                             unit * WIDTH * (WIDTH * WIDTH / 12.0 - 0.5 * DRAUGHT * DRAUGHT)};
  return (radiation){.mass = (F[1] / motion.amplitude + buoyancy[mode]) / (w * w),
                     .damping = -F[2] / (motion.amplitude * w)};
}

static void against(const char *name, radiation_mode mode, double l0, swing motion,
                    radiation *errors) {
  const radiation_box box = {0.5 * WIDTH, DEPTH, DEPTH - DRAUGHT, 2.0 * TANK_PI / motion.period};
  const radiation exact = radiation_of(&box, mode), found = measure(mode, l0, motion);
  errors->mass = found.mass / exact.mass - 1.0;
  errors->damping = found.damping / exact.damping - 1.0;
  print_message("%s, D/%.0f, T %.1f s, by %g: added mass %.3f, potential flow %.3f (%+.1f %%); "
                "damping %.3f, potential flow %.3f (%+.1f %%)\n",
                name, DRAUGHT / l0, motion.period, motion.amplitude, found.mass, exact.mass,
                100.0 * errors->mass, found.damping, exact.damping, 100.0 * errors->damping);
}

/* What damping takes the waves on both sides carry away. */
TEST(the_reference_keeps_energy) {
  for (int n = 0; n < 3; n++) {
    const radiation_box box = {0.2, 0.6, 0.6 - 0.1 * (n + 1), 5.0 + n};
    for (int mode = 0; mode < 3; mode++) {
      const radiation r = radiation_of(&box, (radiation_mode)mode);
      NEAR(r.carried, r.damping, 1e-2 * r.damping);
    }
  }
}

TEST(a_box_in_heave_radiates_what_potential_flow_says) {
  const double l0[] = {0.04, 0.025, 0.02};
  radiation error[3], slow;
  for (int k = 0; k < 3; k++)
    against("heave", RADIATION_HEAVE, l0[k], (swing){0.005, 0.9}, &error[k]);
  against("heave", RADIATION_HEAVE, l0[0], (swing){0.005, 1.2}, &slow);
  for (int k = 0; k < 3; k++) {
    assert_true(fabs(error[k].damping) < 0.35);
    assert_true(fabs(error[k].mass) < 0.10);
  }
  assert_true(error[2].mass < error[0].mass);
  assert_true(fabs(slow.damping) < 0.20);
}

TEST(a_box_in_sway_and_roll_radiates) {
  radiation sway, roll;
  against("sway", RADIATION_SWAY, 0.04, (swing){0.005, 0.9}, &sway);
  against("roll", RADIATION_ROLL, 0.04, (swing){0.02, 0.9}, &roll);
  assert_true(fabs(sway.damping) < 0.10);
  assert_true(roll.damping > 0.0 && roll.damping < 1.3);
}
