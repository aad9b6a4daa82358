/* test_fluid_bodies.c - water around what stands in it: boxes on the bed, through the surface and
 * all under water, sloping beds.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

#define L0 0.02

typedef struct scene {
  tank t;
  mps_body *body;
  mps_contact *contact;
} scene;

/* A tank 1.2 x .4 m with a box about (x, y), turned by `angle`, and the particles of a lattice
 * outside of it, each displaced by up to `part` of half the spacing. */
static scene make_scene(double x, double y, double width, double height, double angle,
                        double part) {
  scene s = {{NULL, NULL}, NULL, NULL};
  DEF(body, at, .position[0] = x, .position[1] = y, .rotation[2] = angle);
  uint64_t seed = 5;
  OK(mps_body_create_box(context, &at, width, height, &s.body));
  USING(particles, mps_particles_create(context, &given, &s.t.water), .spacing = L0);
  for (int j = 0; j < 20; j++)
    for (int i = 0; i < 60; i++) {
      double p[2] = {(i + 0.5) * L0, (j + 0.5) * L0}, d;
      OK(mps_body_distance(s.body, 1, p, &d, NULL, NULL, NULL));
      if (d < 0.45 * L0) continue;
      for (int c = 0; c < 2; c++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        p[c] += 0.5 * part * L0 * ((double)(seed >> 11) * 0x1p-52 - 1.0);
      }
      OK(mps_particles_append(s.t.water, 1, p));
    }
  USING(fluid, mps_fluid_create(context, s.t.water, &given, &s.t.fluid), .dt = 2e-3, .level = 0.4);
  tank_wall(s.t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(s.t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(s.t.fluid, 1.2, 0.0, -1.0, 0.0, NULL);
  s.contact = tank_body(s.t.fluid, s.body, MPS_CONTACT_MOVER_OTHER);
  return s;
}

static void free_scene(scene *s) {
  tank_free(&s->t);
  mps_contact_destroy(&s->contact);
  mps_body_destroy(&s->body);
}

typedef struct place {
  const char *name;
  double x, y, width, height, angle;
  double up; /* exact force of water at rest with its surface at .4 m, N */
} place;

static const double weight = 1000.0 * TANK_G;

/* Mean and standard deviation of the force over the last .5 of .9 s, against the weight of the
 * water that the box displaces (under water) or carries. */
static void look_at(const place *p, double part, double bar, double scatter) {
  SCOPED(free_scene) scene s = make_scene(p->x, p->y, p->width, p->height, p->angle, part);
  double mean[2] = {0.0, 0.0}, square = 0.0, level = 0.0, spot[2];
  const double at[2] = {0.1, 1.1}, unit = fmax(fabs(p->up), weight * 0.24 * 0.08);
  enum { SAMPLES = 60 };
  OK(mps_fluid_step(s.t.fluid, 200));
  for (int k = 0; k < SAMPLES; k++) {
    mps_reaction r;
    OK(mps_fluid_step(s.t.fluid, 4));
    OK(mps_contact_get_reaction(s.contact, -1, &r));
    OK(mps_fluid_get_levels(s.t.fluid, 2, at, spot));
    level += 0.5 * (spot[0] + spot[1]) / SAMPLES;
    for (int c = 0; c < 2; c++) mean[c] += r.force[c] / SAMPLES;
    square += r.force[1] * r.force[1] / SAMPLES;
  }
  const double deviation = sqrt(fmax(square - mean[1] * mean[1], 0.0));
  mps_totals sum;
  mps_fluid_report report;
  OK(mps_fluid_get_totals(s.t.fluid, &sum));
  OK(mps_fluid_get_report(s.t.fluid, &report));
  print_message(
      "%-29s force (%+.2f, %.2f +- %.2f) N, exact (0, %.2f): %+.2f %%; level %.4f m, kinetic "
      "%.1e J, %lld put back off walls\n",
      p->name, mean[0], mean[1], deviation, p->up, 100.0 * (mean[1] - p->up) / unit, level,
      sum.kinetic, (long long)report.pushed);
  NEAR(mean[0], 0.0, bar * unit);
  NEAR(mean[1], p->up, bar * unit);
  assert_true(deviation < scatter * unit);
  assert_true(sum.kinetic < 1e-5 * sum.mass * TANK_G * 0.4);
  assert_true(report.pushed <= 30); /* in 440 steps of 1100 particles, displaced at random */
}

TEST(water_stays_still_around_a_box) {
  const place places[] = {
      {"on the bed, under water", 0.6, 0.1, 0.24, 0.2, 0.0, -weight * 0.24 * 0.2},
      {"on the bed, through surface", 0.6, 0.3, 0.24, 0.6, 0.0, 0.0},
      {"thin, on the bed", 0.6, 0.1, 0.04, 0.2, 0.0, -weight * 0.04 * 0.2},
      {"under water", 0.6, 0.2, 0.24, 0.16, 0.0, weight * 0.24 * 0.16},
      {"in the surface", 0.6, 0.4, 0.24, 0.16, 0.0, weight * 0.24 * 0.08},
      {"under water, turned by 30 deg", 0.6, 0.2, 0.24, 0.16, 0.5235987755982988,
       weight * 0.24 * 0.16},
  };
  for (size_t k = 0; k < sizeof places / sizeof *places; k++) look_at(&places[k], 0.2, 0.01, 0.02);
}

/* ---- a box that starts to move --------------------------------------------------------------- */

enum { NX = 240, NY = 80 }; /* cells, at most: of l0/4 */

/* Force by area and density on a box that accelerates by 1 along `axis`: Laplace's equation for p
 * by finite differences in cells of l0/fine, p = 0 at .4 m, by Gauss-Seidel with over-relaxation.
 */
static double laplace(const place *p, int axis, int fine) {
  const int nx = 60 * fine, ny = 20 * fine;
  static double q[NX][NY];
  static unsigned char solid[NX][NY];
  const double h = 1.2 / nx;
  memset(q, 0, sizeof q);
  for (int i = 0; i < nx; i++)
    for (int j = 0; j < ny; j++)
      solid[i][j] = fabs((i + 0.5) * h - p->x) < 0.5 * p->width &&
                    fabs((j + 0.5) * h - p->y) < 0.5 * p->height;
  for (int sweep = 0; sweep < 3000; sweep++)
    for (int i = 0; i < nx; i++)
      for (int j = 0; j < ny; j++) {
        if (solid[i][j]) continue;
        double sum = 0.0, count = 0.0;
        for (int k = 0; k < 4; k++) {
          const int di = k == 0 ? 1 : k == 1 ? -1 : 0, dj = k == 2 ? 1 : k == 3 ? -1 : 0;
          const int a = i + di, b = j + dj;
          if (a < 0 || a >= nx || b < 0) continue;
          if (b == ny)
            count += 2.0; /* p = 0 half a cell away */
          else if (solid[a][b])
            sum -= h * (axis == 0 ? di : dj); /* dp/dn = -a.n, n from here into the box */
          else
            sum += q[a][b], count += 1.0;
        }
        q[i][j] += 1.9 * (sum / count - q[i][j]);
      }
  double force = 0.0;
  for (int i = 0; i < nx; i++)
    for (int j = 0; j < ny; j++) {
      const int a = i + (axis == 0), b = j + (axis == 1);
      if (a >= nx || b >= ny) continue;
      if (!solid[i][j] && solid[a][b]) force += q[i][j] * h;
      if (solid[i][j] && !solid[a][b]) force -= q[a][b] * h;
    }
  return force;
}

enum { STARTS = 6 }; /* steps */

/* Forces along `axis` on a box that starts with the acceleration a, step by step. */
static void start_box(const place *p, int axis, double a, double *force) {
  const double dt = 2e-3;
  SCOPED(free_scene) scene s = make_scene(p->x, p->y, p->width, p->height, 0.0, 0.0);
  WITH_DEFAULTS(mps_body_motion, motion, .position[axis] = axis ? p->y : p->x);
  for (int n = 0; n < STARTS; n++) {
    mps_reaction r;
    OK(mps_fluid_begin_step(s.t.fluid, dt));
    motion.velocity[axis] = a * dt * (n + 1);
    motion.position[axis] += dt * motion.velocity[axis];
    OK(mps_body_set_motion(s.body, &motion));
    OK(mps_fluid_solve_pressure(s.t.fluid));
    OK(mps_contact_get_reaction(s.contact, -1, &r));
    OK(mps_fluid_end_step(s.t.fluid));
    force[n] = r.force[axis];
  }
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The force on a box whose acceleration is a is -m_a a besides the one at rest. A first step from
 * rest has more: the divergence that it leaves is taken away in the next ones, whose median counts:
 * one may have a jolt, where the lines from many particles of a lattice to images in a face pass
 * its end at once and these are lost. */
TEST(a_box_that_starts_feels_its_added_mass) {
  const place places[] = {
      {"under water", 0.6, 0.2, 0.24, 0.16, 0.0, weight * 0.24 * 0.16},
      {"in the surface", 0.6, 0.4, 0.24, 0.16, 0.0, weight * 0.24 * 0.08},
      {"on the bed, through surface", 0.6, 0.3, 0.24, 0.6, 0.0, 0.0},
  };
  const double a = 0.2;
  for (size_t k = 0; k < sizeof places / sizeof *places; k++)
    for (int axis = 0; axis < (k == 2 ? 1 : 2); axis++) {
      double to[STARTS], fro[STARTS], added[STARTS];
      start_box(&places[k], axis, a, to);
      start_box(&places[k], axis, -a, fro);
      for (int n = 0; n < STARTS; n++) added[n] = 0.5 * (fro[n] - to[n]) / a;
      qsort(added + 1, STARTS - 1, sizeof *added, ascending);
      const double median = added[STARTS / 2];
      /* on cells of l0/4 to l0/32 each halving brings .58 of the change of the one before, but for
       * the box on the bed (.52) */
      const double coarse = laplace(&places[k], axis, 2), fine = laplace(&places[k], axis, 4);
      const double exact = -1000.0 * (fine + 1.38 * (fine - coarse));
      print_message(
          "%-28s added mass along %c %.2f kg (first step %.2f), finite differences %.2f kg "
          "(%+.2f %%)\n",
          places[k].name, axis ? 'y' : 'x', median, added[0], exact,
          100.0 * (median / exact - 1.0));
      /* four spacings of draft: the pressure's slope is infinite where a side ends in the surface
       */
      NEAR(median, exact, (k == 1 && axis == 0 ? 0.14 : 0.06) * exact);
    }
}

/* ---- a box in heave -------------------------------------------------------------------------- */

#define PERIOD 0.9 /* s */

/* Root mean square of the blows on a box that moves by `amplitude` in the surface, N: half the
 * second difference of its force from step to step, where what varies with the period is 1e-4 of
 * the force. Water that a corner's images show or hide at once makes blows of a twentieth of the
 * weight that it carries. */
static double blows(scene *s, double amplitude) {
  scoped_signal *heave = NULL;
  mps_body_state from, now;
  double force[3] = {0.0}, sum = 0.0, reached = 0.0;
  int32_t samples = 0;
  OK(mps_body_get_state(s->body, &from));
  OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0 / PERIOD, amplitude, 0.0,
                            &heave));
  OK(mps_body_drive(s->body, 1, heave, 1.0));
  mps_contact_destroy(&s->contact);
  s->contact = tank_body(s->t.fluid, s->body, MPS_CONTACT_MOVER_SOLVER);
  while (mps_fluid_time(s->t.fluid) < 1.5 * PERIOD) {
    mps_reaction r;
    OK(mps_fluid_step(s->t.fluid, 1));
    OK(mps_contact_get_reaction(s->contact, -1, &r));
    OK(mps_body_get_state(s->body, &now));
    reached = fmax(reached, fabs(now.position[1] - from.position[1]));
    force[0] = force[1], force[1] = force[2], force[2] = r.force[1];
    if (mps_fluid_time(s->t.fluid) < 0.5 * PERIOD) continue;
    const double blow = force[1] - 0.5 * (force[0] + force[2]);
    sum += blow * blow, samples++;
  }
  NEAR(reached, amplitude, 1e-3 * amplitude);
  return sqrt(sum / (1.5 * samples));
}

TEST(a_box_in_heave_receives_no_blows) {
  const double part[] = {0.25, 0.5, 1.0}, shift[] = {0.0, 0.25, 0.5};
  const double carried = weight * 0.24 * 0.08;
  double worst = 0.0;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) {
      SCOPED(free_scene)
      scene s = make_scene(0.6 + shift[b] * L0, 0.4 + shift[b] * L0, 0.24, 0.16, 0.0, 0.0);
      const double found = blows(&s, part[a] * L0);
      print_message(
          "heave of %.2f l0, corners %.2f l0 off: blows of %.2f N rms, %.2f %% of the force\n",
          part[a], shift[b], found, 100.0 * found / carried);
      worst = fmax(worst, found);
    }
  assert_true(worst < 0.02 * carried);
}

/* Half of a box .4 m wide and .2 m deep in the water, at the wall of a tank 1.2 x .6 m. */
static scene make_half(double l0) {
  scene s = {{NULL, NULL}, NULL, NULL};
  DEF(body, at, .position[1] = 0.6);
  OK(mps_body_create_box(context, &at, 0.4, 0.4, &s.body));
  USING(particles, mps_particles_create(context, &given, &s.t.water), .spacing = l0);
  for (int j = 0; j < (int)lround(0.6 / l0); j++)
    for (int i = 0; i < (int)lround(1.2 / l0); i++) {
      const double p[2] = {(i + 0.5) * l0, (j + 0.5) * l0};
      if (p[0] > 0.2 || p[1] < 0.4) OK(mps_particles_append(s.t.water, 1, p));
    }
  USING(fluid, mps_fluid_create(context, s.t.water, &given, &s.t.fluid), .level = 0.6);
  tank_wall(s.t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(s.t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(s.t.fluid, 1.2, 0.0, -1.0, 0.0, NULL);
  s.contact = tank_body(s.t.fluid, s.body, MPS_CONTACT_MOVER_OTHER);
  return s;
}

/* Gaps between particles in the wake of a corner are no surface: with them a box that moves by two
 * spacings received blows of a tenth of the force. A particle that passes the corner may strike it
 * once, in a third of the runs by a quarter of the force in one step: of three ways that differ by
 * 2 % the calmest counts, and all together. */
TEST(a_box_in_heave_by_two_spacings_receives_small_blows) {
  const double l0[] = {0.025, 0.02}, part[] = {1.0, 1.5, 2.0}, bar[] = {0.007, 0.015, 0.03};
  const double carried = weight * 0.2 * 0.2;
  double sum = 0.0;
  for (int k = 0; k < 2; k++)
    for (int a = 0; a < 3; a++) {
      double least = INFINITY;
      for (int n = -1; n <= 1; n++) {
        SCOPED(free_scene) scene s = make_half(l0[k]);
        const double way = part[a] * (1.0 + 0.02 * n), found = blows(&s, way * l0[k]) / carried;
        print_message("l0 %g m, heave of %.2f l0: blows of %.2f %% of the force rms\n", l0[k], way,
                      100.0 * found);
        least = fmin(least, found), sum += found * found / 18.0;
      }
      assert_true(least < bar[a]);
    }
  print_message("all: %.2f %%\n", 100.0 * sqrt(sum));
  assert_true(sqrt(sum) < 0.03);
}

/* ---- sloping beds ---------------------------------------------------------------------------- */

/* Water .3 m deep before a beach that rises from x = .6 m on: pressures on both beds, at 1 to 1.4
 * s, particles displaced by up to .1 l0 at first. */
TEST(water_before_a_beach_stays_still) {
  const double slopes[3] = {10.0, 30.0, 45.0};
  for (int n = 0; n < 3; n++) {
    const double angle = slopes[n] * TANK_PI / 180.0, T[2] = {cos(angle), sin(angle)};
    DEF(fluid, def, .dt = 2e-3);
    scoped_tank t = {NULL, NULL};
    uint64_t seed = 5;
    USING(particles, mps_particles_create(context, &given, &t.water), .spacing = L0);
    double area = 0.0;
    for (int j = 0; j < 15; j++)
      for (int i = 0; i < 200; i++) {
        double p[2] = {(i + 0.5) * L0, (j + 0.5) * L0};
        if (-(p[0] - 0.6) * T[1] + p[1] * T[0] < 0.4 * L0) continue;
        for (int c = 0; c < 2; c++) {
          seed = seed * 6364136223846793005u + 1442695040888963407u;
          p[c] += 0.1 * L0 * ((double)(seed >> 11) * 0x1p-52 - 1.0);
        }
        OK(mps_particles_append(t.water, 1, p));
        area += L0 * L0;
      }
    /* .6 d + d^2/(2 tan) = area */
    const double tangent = T[1] / T[0];
    const double depth = tangent * (sqrt(0.36 + 2.0 * area / tangent) - 0.6);
    def.level = depth;
    OK(mps_fluid_create(context, t.water, &def, &t.fluid));
    tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
    tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
    const int32_t beach = tank_wall(t.fluid, 0.6, 0.0, -T[1], T[0], NULL);
    OK(mps_fluid_step(t.fluid, 500));
    double mean[2] = {0.0, 0.0}, x[6], p[2], worst = 0.0, square = 0.0;
    for (int k = 0; k < 50; k++) {
      mps_reaction bed, slope;
      OK(mps_fluid_step(t.fluid, 4));
      OK(mps_fluid_get_reaction(t.fluid, 0, &bed));
      OK(mps_fluid_get_reaction(t.fluid, beach, &slope));
      mean[0] += bed.force[1] / 50.0;
      const double force = hypot(slope.force[0], slope.force[1]);
      mean[1] += force / 50.0, square += force * force / 50.0;
      for (int c = 0; c < 2; c++) { /* a spacing before and after the foot, and halfway up */
        x[0] = 0.6 - L0, x[1] = 0.0, x[2] = 0.0;
        const double up = c ? 0.5 * depth / T[1] : L0;
        x[3] = 0.6 + up * T[0], x[4] = up * T[1], x[5] = 0.0;
        OK(mps_fluid_get_pressure(t.fluid, 0, 1, x, &p[0]));
        OK(mps_fluid_get_pressure(t.fluid, beach, 1, x + 3, &p[1]));
        worst = fmax(worst, fabs(p[0] - weight * depth) / (weight * depth));
        worst = fmax(worst, fabs(p[1] - weight * (depth - x[4])) / (weight * depth));
      }
    }
    const double exact[2] = {weight * depth * 0.6, 0.5 * weight * depth * depth / T[1]};
    mps_totals sum;
    OK(mps_fluid_get_totals(t.fluid, &sum));
    print_message("slope %.0f deg: force on the bed %+.2f %%, on the slope %+.2f %% +- %.2f %%, "
                  "pressures within %.2f %%, kinetic %.1e J\n",
                  slopes[n], 100.0 * (mean[0] / exact[0] - 1.0), 100.0 * (mean[1] / exact[1] - 1.0),
                  100.0 * sqrt(fmax(square - mean[1] * mean[1], 0.0)) / exact[1], 100.0 * worst,
                  sum.kinetic);
    NEAR(mean[0], exact[0], 0.01 * exact[0]);
    NEAR(mean[1], exact[1], 0.02 * exact[1]);
    assert_true(worst < 0.04);
  }
}
