/* test_fluid_afloat.c - bodies that the water carries.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

/* A box of `width` that floats `draft` deep in the middle of a closed tank of `length` and
 * `depth`. */
typedef struct scene {
  tank t;
  mps_body *body;
  mps_contact *contact;
  double l0, length, depth, width, draft;
  double lightness; /* mass over that of the water displaced; 0: 1 */
  double damping;   /* 1/s */
} scene;

static void launch(scene *s) {
  DEF(body, at, .motion = MPS_BODY_MOTION_FREE);
  const double height = 2.0 * s->draft;
  at.position[0] = 0.5 * s->length, at.position[1] = s->depth - s->draft + 0.5 * height;
  at.mass = 1000.0 * s->width * s->draft * (s->lightness > 0.0 ? s->lightness : 1.0);
  at.inertia[2] = at.mass * (s->width * s->width + height * height) / 12.0;
  at.gravity[1] = -TANK_G;
  at.damping[0] = s->damping;
  OK(mps_body_create_box(context, &at, s->width, height, &s->body));
  DEF(fluid, def, .level = s->depth);
  USING(particles, mps_particles_create(context, &given, &s->t.water), .spacing = s->l0);
  const int columns = (int)lround(s->length / s->l0), rows = (int)lround(s->depth / s->l0);
  for (int j = 0; j < rows; j++)
    for (int i = 0; i < columns; i++) {
      const double p[2] = {(i + 0.5) * s->l0, (j + 0.5) * s->l0};
      double d;
      OK(mps_body_distance(s->body, 1, p, &d, NULL, NULL, NULL));
      if (d > 0.4 * s->l0) OK(mps_particles_append(s->t.water, 1, p));
    }
  OK(mps_fluid_create(context, s->t.water, &def, &s->t.fluid));
  tank_wall(s->t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(s->t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(s->t.fluid, s->length, 0.0, -1.0, 0.0, NULL);
  s->contact = tank_body(s->t.fluid, s->body, MPS_CONTACT_MOVER_SOLVER);
}

/* ---- linear potential theory ----------------------------------------------------------------- */

/* Heave of the box in the tank by one half of it (symmetric), in coordinates q[0], the body's
 * place, and q[n], the level cos(n pi x/gap) in the gap of width (length - width)/2; the level's
 * mean follows from the body's place. Masses are rho int phi_i dphi_j/dn over body and surface,
 * with phi from Laplace's equation by finite differences. */
enum { MODES = 5, CELLS = 120 }; /* along half of the tank */

typedef struct theory {
  const scene *s;
  double h, below, beside; /* m: cells along x; along y up to the box's bottom, and above */
  int nx, ny, gap, top;    /* cells: tank, gap, below the box */
  double phi[CELLS][CELLS];
} theory;

static double height(const theory *t, int j) { return j < t->top ? t->below : t->beside; }

static bool in_box(const theory *t, int i, int j) { return i >= t->gap && j >= t->top; }

/* Velocity out of the water of mode n at the top of column i. */
static double outflow(const theory *t, int n, int i) {
  const double gap = 0.5 * (t->s->length - t->s->width);
  if (i >= t->gap) return n == 0 ? 1.0 : 0.0;
  if (n == 0) return -t->s->width / (t->s->length - t->s->width);
  return cos(n * TANK_PI * (i + 0.5) * t->h / gap);
}

static void potential(theory *t, int n) {
  memset(t->phi, 0, sizeof t->phi);
  for (int sweep = 0; sweep < 4000; sweep++)
    for (int i = 0; i < t->nx; i++)
      for (int j = 0; j < t->ny; j++) {
        if (in_box(t, i, j)) continue;
        double sum = 0.0, count = 0.0;
        const int at[4][2] = {{i + 1, j}, {i - 1, j}, {i, j + 1}, {i, j - 1}};
        for (int k = 0; k < 4; k++) {
          const int a = at[k][0], b = at[k][1];
          if (a < 0 || a >= t->nx || b < 0) continue;
          if (b >= t->ny || (in_box(t, a, b) && k == 2)) {
            sum += t->h * outflow(t, n, i);
          } else if (!in_box(t, a, b)) {
            const double share =
                k < 2 ? height(t, j) / t->h : 2.0 * t->h / (height(t, j) + height(t, b));
            sum += share * t->phi[a][b], count += share;
          }
        }
        t->phi[i][j] += 1.9 * (sum / count - t->phi[i][j]);
      }
}

/* Period (s) of the slowest motion about the rest `sinks` m below the present one: the largest
 * ratio of masses to stiffnesses, by iteration. There the box is deeper in the water, and that
 * beside it higher: more water moves than at the start. */
static double heave_period(const scene *s, double sinks) {
  static theory t;
  t = (theory){.s = s, .h = 0.5 * s->length / CELLS, .nx = CELLS};
  t.ny = (int)lround(s->depth / t.h), t.gap = (int)lround(0.5 * (s->length - s->width) / t.h);
  t.top = (int)lround((s->depth - s->draft) / t.h);
  const double gap = 0.5 * (s->length - s->width), rest = s->width / (s->length - s->width);
  t.below = (s->depth - s->draft - sinks) / t.top;
  t.beside = (s->draft + sinks * (1.0 + rest)) / (t.ny - t.top);
  double M[MODES][MODES] = {{0}}, K[MODES], q[MODES] = {1.0}, ratio = 0.0;
  for (int n = 0; n < MODES; n++) {
    potential(&t, n);
    for (int m = 0; m < MODES; m++)
      for (int i = 0; i < t.nx; i++) { /* phi at the top: half a cell further on */
        const int j = (i < t.gap ? t.ny : t.top) - 1;
        const double phi = t.phi[i][j] + 0.5 * height(&t, j) * outflow(&t, n, i);
        M[n][m] += 1000.0 * t.h * phi * outflow(&t, m, i);
      }
    K[n] = 0.5 * 1000.0 * TANK_G * gap;
  }
  M[0][0] += 0.5 * 1000.0 * s->width * s->draft;
  K[0] = 1000.0 * TANK_G * (0.5 * s->width + gap * rest * rest);
  for (int k = 0; k < 200; k++) {
    double next[MODES], norm = 0.0;
    for (int n = 0; n < MODES; n++) {
      next[n] = 0.0;
      for (int m = 0; m < MODES; m++) next[n] += M[n][m] * q[m] / K[n];
      norm = fmax(norm, fabs(next[n]));
    }
    for (int n = 0; n < MODES; n++) q[n] = next[n] / norm;
    ratio = norm;
  }
  return 2.0 * TANK_PI * sqrt(ratio);
}

/* ---- tests ----------------------------------------------------------------------------------- */

static void drop_scene(scene *s) {
  tank_free(&s->t);
  mps_contact_destroy(&s->contact);
  mps_body_destroy(&s->body);
}

/* Level of the water beside the box above the present depth, mean over stations, m. */
static double level_beside(scene *s) {
  enum { STATIONS = 40 };
  const double gap = 0.5 * (s->length - s->width);
  double at[STATIONS], level[STATIONS], sum = 0.0;
  for (int k = 0; k < STATIONS; k++) {
    const double from = gap * (k % (STATIONS / 2) + 0.5) / (STATIONS / 2);
    at[k] = k < STATIONS / 2 ? from : s->length - from;
  }
  OK(mps_fluid_get_levels(s->t.fluid, STATIONS, at, level));
  for (int k = 0; k < STATIONS; k++) sum += (level[k] - s->depth) / STATIONS;
  return sum;
}

/* A load of 40 N sets the box going: it heaves about 40 N over its stiffness, rho g times its width
 * and what the water in the gaps adds, and its draft about 40 N over rho g times its width: within
 * 2
 * %. Where the box is follows from the water's level, which rises by a hundredth of a spacing as
 * the particles leave their lattice. `bar` of the period. */
static void heaves(scene s, double bar) {
  const double load[3] = {0.0, -40.0, 0.0};
  const double stiffness = 1000.0 * TANK_G * s.width / (1.0 - s.width / s.length);
  const double exact = heave_period(&s, 40.0 / stiffness);
  double at[3] = {0.0, 0.0, 0.0}, place[3] = {0.0, 0.0, 0.0}, turn[3][3];
  int64_t solutions = 0;
  int turns = 0;
  launch(&s);
  OK(mps_body_set_load(s.body, load, NULL));
  while (turns < 3) {
    mps_body_state b;
    OK(mps_fluid_step(s.t.fluid, 1));
    OK(mps_body_get_state(s.body, &b));
    assert_true(b.time < 2.0);
    NEAR(b.position[0], 0.5 * s.length, 1e-4);
    NEAR(b.rotation[2], 0.0, 1e-3);
    for (int k = 0; k < 2; k++) at[k] = at[k + 1], place[k] = place[k + 1];
    at[2] = b.time, place[2] = b.position[1] - s.depth;
    solutions++;
    if (solutions < 3 || (place[1] - place[0]) * (place[2] - place[1]) > 0.0) continue;
    if (turns > 0 && at[1] - turn[turns - 1][0] < 0.1) continue;
    /* the top of the parabola through the last three */
    const double rise = place[2] - place[0], bend = place[2] - 2.0 * place[1] + place[0];
    turn[turns][0] = at[1] - 0.25 * (at[2] - at[0]) * rise / bend;
    turn[turns][1] = place[1] - 0.125 * rise * rise / bend;
    turn[turns][2] = level_beside(&s) - place[2];
    turns++;
  }
  const double period = turn[2][0] - turn[0][0];
  const double mean = 0.25 * (turn[0][1] + 2.0 * turn[1][1] + turn[2][1]);
  const double draft = 0.25 * (turn[0][2] + 2.0 * turn[1][2] + turn[2][2]);
  const double grows = -load[1] / (1000.0 * TANK_G * s.width);
  const double decay = log((turn[1][1] - turn[0][1]) / (turn[1][1] - turn[2][1])) / (0.5 * period);
  print_message(
      "heave: period %.4f s, potential theory %.4f s (%+.1f %%); mean %.3f mm, load over "
      "stiffness %.3f mm (%+.1f %%); decay %.2f 1/s; draft grows by %.3f mm, exact %.3f mm "
      "(%+.1f %%)\n",
      period, exact, 100.0 * (period / exact - 1.0), 1e3 * mean, 1e3 * load[1] / stiffness,
      100.0 * (mean * stiffness / load[1] - 1.0), decay, 1e3 * draft, 1e3 * grows,
      100.0 * (draft / grows - 1.0));
  NEAR(period, exact, bar * exact);
  NEAR(draft, grows, 0.02 * grows);
  NEAR(mean, load[1] / stiffness, 0.02 * s.l0); /* of a spacing */
  drop_scene(&s);
}

TEST(a_box_heaves) {
  heaves((scene){.l0 = 0.02, .length = 0.8, .depth = 0.4, .width = 0.4, .draft = 0.1}, 0.02);
}

/* Five spacings of water are left on each side. */
TEST(a_box_heaves_in_a_narrow_tank) {
  heaves((scene){.l0 = 0.02, .length = 0.6, .depth = 0.3, .width = 0.4, .draft = 0.08}, 0.03);
}

/* Comes to rest, damped nearly critically, under `load` (N, down): its draft grows by load/(rho g
 * width), and it sinks by load over stiffness, but for the level of the water, of whose spacing's
 * hundredth the particles' rearrangement decides. */
static void rests(scene s, double load) {
  const double down[3] = {0.0, -load, 0.0};
  const double stiffness = 1000.0 * TANK_G * s.width / (1.0 - s.width / s.length);
  const double grows = load / (1000.0 * TANK_G * s.width), sinks = load / stiffness;
  double place = 0.0, draft = 0.0;
  int64_t count = 0;
  s.damping = 40.0;
  launch(&s);
  OK(mps_body_set_load(s.body, down, NULL));
  while (mps_fluid_time(s.t.fluid) < 2.5) {
    mps_body_state b;
    OK(mps_fluid_step(s.t.fluid, 1));
    if (mps_fluid_time(s.t.fluid) < 1.5) continue;
    OK(mps_body_get_state(s.body, &b));
    const double above = b.position[1] - s.depth;
    place += above, draft += level_beside(&s) - above, count++;
  }
  place /= (double)count, draft /= (double)count;
  print_message(
      "%g m wide, %g m deep, load %g N: draft grows by %.3f mm, exact %.3f mm (%+.2f %%); "
      "place %.3f mm, exact %.3f mm (%+.4f l0)\n",
      s.width, s.draft, load, 1e3 * draft, 1e3 * grows, 100.0 * (draft / grows - 1.0), 1e3 * place,
      -1e3 * sinks, (place + sinks) / s.l0);
  NEAR(draft, grows, 0.005 * fabs(grows));
  NEAR(place, -sinks, 0.02 * fabs(grows));
  drop_scene(&s);
}

TEST(a_box_comes_to_rest_where_it_displaces_its_load) {
  const scene wide = {.l0 = 0.02, .length = 0.8, .depth = 0.4, .width = 0.4, .draft = 0.1};
  const scene deep = {.l0 = 0.02, .length = 0.8, .depth = 0.4, .width = 0.24, .draft = 0.12};
  rests(wide, 40.0);
  rests(wide, -40.0);
  rests(deep, 24.0);
}

/* Force of the water along y on the box that is moved with the acceleration `a`, in a step that is
 * not made. */
static double pushed(scene *s, double a) {
  const double dt = mps_fluid_dt(s->t.fluid);
  mps_body_motion motion = mps_body_motion_defaults();
  mps_reaction r;
  mps_contact_destroy(&s->contact);
  s->contact = tank_body(s->t.fluid, s->body, MPS_CONTACT_MOVER_OTHER);
  OK(mps_fluid_begin_step(s->t.fluid, dt));
  motion.velocity[1] = a * dt;
  OK(mps_body_set_motion(s->body, &motion));
  OK(mps_fluid_solve_pressure(s->t.fluid));
  OK(mps_contact_get_reaction(s->contact, -1, &r));
  OK(mps_fluid_abandon_step(s->t.fluid));
  motion.velocity[1] = 0.0;
  OK(mps_body_set_motion(s->body, &motion));
  mps_contact_destroy(&s->contact);
  s->contact = tank_body(s->t.fluid, s->body, MPS_CONTACT_MOVER_SOLVER);
  return r.force[1];
}

/* However light the box, it starts with the acceleration at which force and inertia agree, the
 * added mass many times its own, and its momentum is what water and gravity give. */
TEST(a_light_box_starts_with_its_added_mass) {
  const double masses[] = {1.0, 0.1, 0.01}; /* of the water it displaces */
  for (int k = 0; k < 3; k++) {
    SCOPED(drop_scene)
    scene s = {.l0 = 0.02, .length = 0.8, .depth = 0.4, .width = 0.4, .draft = 0.1};
    s.lightness = masses[k];
    launch(&s);
    const double mass = masses[k] * 1000.0 * s.width * s.draft;
    const double still = pushed(&s, 0.0), added = still - pushed(&s, 1.0);
    mps_body_state b;
    mps_body_totals totals;
    mps_reaction r;
    const double dt = mps_fluid_dt(s.t.fluid);
    OK(mps_fluid_begin_step(s.t.fluid, dt));
    OK(mps_fluid_solve_pressure(s.t.fluid));
    OK(mps_fluid_end_step(s.t.fluid));
    OK(mps_body_get_state(s.body, &b));
    const double a = b.velocity[1] / dt, linear = (still - mass * TANK_G) / (mass + added);
    drop_scene(&s);
    launch(&s); /* the same place again */
    const double force = pushed(&s, a) - mass * TANK_G;
    print_message("mass %.2f of the displaced water's, added mass %.2f: starts with %.4f m/s2, "
                  "without suction cut off %.4f; force over mass there %.4f\n",
                  masses[k], added / (1000.0 * s.width * s.draft), a, linear, force / mass);
    NEAR(force, mass * a, 0.002 * still);
    if (masses[k] >= 0.1) NEAR(a, linear, 0.01 * fmax(linear, 0.1));
    OK(mps_fluid_step(s.t.fluid, 10));
    OK(mps_body_get_totals(s.body, &totals));
    OK(mps_body_get_reaction(s.body, -1, &r));
    OK(mps_body_get_state(s.body, &b));
    NEAR(b.time, mps_fluid_time(s.t.fluid), 1e-12);
    NEAR(totals.linear[1], r.impulse[1] - mass * TANK_G * b.time, 1e-9 * (1.0 + mass));
    NEAR(b.position[0], 0.4, 1e-4);
  }
}

TEST(going_back_is_exact) {
  SCOPED(drop_scene)
  scene s = {.l0 = 0.02, .length = 0.8, .depth = 0.4, .width = 0.4, .draft = 0.1};
  const double load[3] = {3.0, -40.0, 0.0}, moment[3] = {0.0, 0.0, 2.0};
  scoped_snapshot *start = NULL;
  mps_body_state first, again;
  launch(&s);
  OK(mps_body_set_load(s.body, load, moment));
  OK(mps_fluid_step(s.t.fluid, 40));
  OK(mps_fluid_snapshot(s.t.fluid, &start));
  OK(mps_fluid_step(s.t.fluid, 10));
  OK(mps_body_get_state(s.body, &first));
  assert_true(first.position[0] > 0.4 && first.position[1] < 0.4 && first.rotation[2] > 0.0);
  OK(mps_fluid_rollback(s.t.fluid, start));
  OK(mps_fluid_step(s.t.fluid, 10));
  OK(mps_body_get_state(s.body, &again));
  assert_memory_equal(&first, &again, sizeof first);
}

TEST(bad_bodies_are_refused) {
  SCOPED(drop_scene)
  scene s = {.l0 = 0.02, .length = 0.8, .depth = 0.4, .width = 0.4, .draft = 0.1};
  launch(&s);
  mps_contact *gone = s.contact, *contact = NULL;
  FAILS(mps_fluid_add_contact(s.t.fluid, s.body, NULL, &contact), MPS_ERROR_STATE,
        "in contact with the body already");
  mps_contact_destroy(&s.contact);
  assert_true(gone != NULL && s.contact == NULL);
  DEF(body, def, .position[0] = 0.4, .position[1] = 0.4);
  MAKE(body, held, create_box, context, &def, 0.4, 0.2);
  DEF(fluid_contact, floating, .mover = 2);
  REFUSES(mps_fluid_add_contact(s.t.fluid, held, &floating, &contact), "mover is 2");
  assert_null(contact);
  contact = tank_body(s.t.fluid, held, MPS_CONTACT_MOVER_OTHER);
  OK(mps_body_advance(held, 1e-3));
  mps_contact_destroy(&contact);
}
