/* bounds.h - scenes with random parameters whose results have bounds that no parameter may break:
 * grids, stiffness, strength, transfers and places between grid lines are drawn.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_BOUNDS_H
#define MPS_TEST_BOUNDS_H

#include "fluid_tank.h"
#include "mpm_scene.h"

typedef struct bounds_draw {
  uint64_t seed;
} bounds_draw;

/* Even in [low, high]; and even in the logarithm. */
static inline double bounds_even(bounds_draw *d, double low, double high) {
  d->seed = d->seed * 6364136223846793005u + 1442695040888963407u;
  return low + (high - low) * ((double)(d->seed >> 11) / 9007199254740992.0);
}
static inline double bounds_scale(bounds_draw *d, double low, double high) {
  return low * exp(bounds_even(d, 0.0, log(high / low)));
}
static inline int bounds_choice(bounds_draw *d, int count) {
  return (int)fmin(count - 1, bounds_even(d, 0.0, count));
}

static inline bounds_draw bounds_begin(int number) {
  uint64_t z = (uint64_t)(number + 1) * 0x9e3779b97f4a7c15u; /* splitmix64 */
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return (bounds_draw){z ^ z >> 31};
}

/* What all scenes of ground draw. */
typedef struct bounds_ground {
  double cell, young, poisson, friction, dilation, cohesion; /* m, Pa, -, rad, rad, Pa */
  double shift;                                              /* of the grid, cells */
  double flip_time, courant;
  int32_t spline;
} bounds_ground;

static inline bounds_ground bounds_draw_ground(bounds_draw *d) {
  bounds_ground g;
  g.cell = 1.0 / (double)(6 + bounds_choice(d, 7));
  g.young = bounds_scale(d, 2e6, 2e8), g.poisson = bounds_even(d, 0.1, 0.4);
  g.friction = bounds_even(d, 0.3, 0.75), g.dilation = bounds_even(d, 0.0, 0.4) * g.friction;
  g.cohesion = bounds_choice(d, 2) ? bounds_scale(d, 10.0, 5e3) : 0.0;
  g.shift = bounds_even(d, 0.0, 1.0);
  g.flip_time = bounds_choice(d, 2) ? bounds_scale(d, 0.01, 1.0) : 0.0;
  g.courant = bounds_even(d, 0.2, 0.8);
  g.spline = 2 + bounds_choice(d, 2);
  return g;
}

static inline void bounds_print(const bounds_ground *g) {
  print_message(
      "  h %.4f m, E %.3g Pa, nu %.2f, phi %.2f, psi %.2f, c %.3g Pa, grid %.2f cells off, "
      "flip_time %.3g s, courant %.2f, spline %d\n",
      g->cell, g->young, g->poisson, g->friction, g->dilation, g->cohesion, g->shift, g->flip_time,
      g->courant, (int)g->spline);
}

static inline mps_material *bounds_sand(mps_context *context, const bounds_ground *g) {
  DEF(material_mohr_coulomb, law, .young = g->young, .poisson = g->poisson, .friction = g->friction,
      .dilation = g->dilation, .cohesion = g->cohesion, .void_ratio = 0.6, .max_void_ratio = 0.9);
  MAKE_KEPT(material, m, create_mohr_coulomb, context, &law);
  return m;
}

/* A bed of sand [0, width] x [0, height] under its weight at K0 on a floor y = 0; the grid is
 * shifted across by a part of a cell, and rollers stand at x = 0 and `width` unless `open`. */
static inline mpm_scene bounds_bed(mps_context *context, const bounds_ground *g, double width,
                                   double height, double gravity, bool rollers, bool budget) {
  const double dx = 0.5 * g->cell;
  mpm_scene s = mpm_scene_begin(context, dx, 0.0, 0.0, g->young);
  const double columns = nearbyint(width / dx) * dx, rows = nearbyint(height / dx) * dx;
  mpm_scene_box(&s, 0.0, 0.0, columns, rows);
  OK(mps_particles_set(s.particles, "density", 0, 2000.0));
  if (gravity > 0.0) mpm_scene_weigh(&s, 2000.0 * gravity, g->poisson / (1.0 - g->poisson), rows);
  DEF(mpm, def, .cell = g->cell, .spline = g->spline, .flip_time = g->flip_time,
      .courant = g->courant, .lower[1] = 0.0, .gravity[1] = -gravity, .budget = budget);
  if (rollers) {
    def.lower[0] = 0.0, def.upper[0] = columns;
    def.origin[0] = 0.0;
  } else {
    def.origin[0] = g->shift * g->cell;
  }
  scoped_material *sand = bounds_sand(context, g);
  OK(mps_mpm_create(context, s.particles, sand, &def, &s.mpm));
  return s;
}

/* ---- porosity, pressure ---------------------------------------------------------------------- */

/* Saturated sand that is thrown at the wall of a box: 0 < n < 1 and all finite, or the step says
 * so.
 */
static inline void bounds_porosity(mps_context *context, int number) {
  bounds_draw d = bounds_begin(number);
  bounds_ground g = bounds_draw_ground(&d);
  const double n = bounds_even(&d, 0.3, 0.5), speed = bounds_scale(&d, 0.05, 5.0);
  scoped_mpm_scene s = bounds_bed(context, &g, 1.0, 0.6, 9.81, true, false);
  DEF(pore_water, water, .porosity = n, .bulk = bounds_scale(&d, 1e7, 2e9));
  if (bounds_choice(&d, 2)) water.permeability = bounds_scale(&d, 1e-7, 1e-2);
  OK(mps_mpm_add_pore_water(s.mpm, &water));
  const double level[2] = {0.0, 0.6};
  OK(mps_mpm_set_pore_level(s.mpm, level));
  mps_edit v = mpm_scene_edit(&s, "velocity");
  const mps_view x = mpm_scene_view(&s, "position");
  for (int64_t k = 0; k < v.view.shape[0]; k++)
    *mps_edit_f64(&v, k, 0) = speed * sin(3.14159265358979 * *mps_view_f64(&x, k, 0));
  mpm_scene_commit(&s, &v);
  const mps_status status = mps_mpm_step(s.mpm, 1000);
  double low = INFINITY, high = -INFINITY, most = 0.0, least = INFINITY;
  const mps_view now = mpm_scene_view(&s, "porosity"), u = mpm_scene_view(&s, "pore_pressure");
  const mps_view V = mpm_scene_view(&s, "volume");
  for (int64_t k = 0; k < now.shape[0]; k++) {
    low = fmin(low, *mps_view_f64(&now, k, 0)), high = fmax(high, *mps_view_f64(&now, k, 0));
    assert_true(isfinite(*mps_view_f64(&u, k, 0)));
    most = fmax(most, fabs(*mps_view_f64(&u, k, 0)));
    least = fmin(least, *mps_view_f64(&V, k, 0));
  }
  print_message(
      "porosity %.3f from %.4f to %.4f, |u| up to %.3g Pa at %.3g m/s, K_w %.3g Pa, k %.3g "
      "m/s%s\n",
      n, low, high, most, speed, water.bulk, water.permeability,
      status == MPS_OK ? "" : "; refused");
  bounds_print(&g);
  assert_true(low > 0.0 && high < 1.0 && least > 0.0);
}

/* ---- energy ---------------------------------------------------------------------------------- */

/* A bed of sand with a blow and noise, in a closed box at rest: kinetic, elastic and potential
 * energy together fall. Velocities and stresses are half a step apart, so that waves show as an
 * energy that oscillates by up to .1 of the Courant fraction; means of 100 steps fall to half a
 * percent. */
static inline void bounds_energy(mps_context *context, int number) {
  enum { WINDOWS = 8, SAMPLES = 10 };
  bounds_draw d = bounds_begin(1000 + number);
  bounds_ground g = bounds_draw_ground(&d);
  const double gravity = bounds_choice(&d, 2) ? 9.81 : 0.0, speed = bounds_scale(&d, 0.02, 2.0);
  const bool rough = bounds_choice(&d, 2) == 1;
  scoped_mpm_scene s = bounds_bed(context, &g, 1.0, 0.6, gravity, true, true);
  if (rough) mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL, 0.4);
  mps_edit v = mpm_scene_edit(&s, "velocity");
  const mps_view x = mpm_scene_view(&s, "position");
  for (int64_t k = 0; k < x.shape[0]; k++) {
    for (int c = 0; c < 2; c++) *mps_edit_f64(&v, k, c) = speed * bounds_even(&d, -1.0, 1.0);
    *mps_edit_f64(&v, k, 0) += speed * sin(3.14159265358979 * *mps_view_f64(&x, k, 0));
  }
  mpm_scene_commit(&s, &v);
  const double start = mpm_scene_totals(&s).kinetic;
  double least = start, former = start, swing = 0.0, rise = 0.0, size = start;
  for (int w = 0; w < WINDOWS; w++) {
    double mean = 0.0;
    for (int k = 0; k < SAMPLES; k++) {
      OK(mps_mpm_step(s.mpm, 10));
      const mps_totals t = mpm_scene_totals(&s);
      const double now = t.kinetic + t.strain - t.work_loads;
      assert_true(isfinite(now));
      size = fmax(size, start + fabs(t.strain) + fabs(t.work_loads)); /* what is exchanged */
      swing = fmax(swing, now - least);
      least = fmin(least, now);
      mean += now / SAMPLES;
    }
    rise = fmax(rise, mean - former);
    former = mean;
  }
  print_message(
      "energy %.4g J with %.3g m/s%s%s falls to %+.3f of it; means rise by %.1e at most, it "
      "oscillates by %.1e of what is exchanged\n",
      start, speed, gravity > 0.0 ? ", with weight" : "", rough ? ", rough floor" : "",
      former / start, rise / size, swing / size);
  bounds_print(&g);
  assert_true(rise < 5e-3 * size);
  assert_true(swing < 0.1 * g.courant * size);
}

/* ---- a smooth wall --------------------------------------------------------------------------- */

/* A smooth wall through all of a bed is moved into it: it bears nothing along itself. (A toe that
 * ends in ground does: docs/limits.md.) */
static inline void bounds_wall(mps_context *context, int number) {
  bounds_draw d = bounds_begin(2000 + number);
  bounds_ground g = bounds_draw_ground(&d);
  scoped_mpm_scene s = bounds_bed(context, &g, 1.0, 0.5, 9.81, false, false);
  const double corner[] = {-0.4, -1.0, 0.0, -1.0, 0.0, 2.0, -0.4, 2.0};
  const double other[] = {0.0, -1.0, 0.4, -1.0, 0.4, 2.0, 0.0, 2.0};
  WITH_DEFAULTS(mps_body_motion, motion, .velocity[0] = bounds_scale(&d, 0.01, 0.1));
  mps_body_def at = mps_body_defaults();
  scoped_body *wall = NULL, *end = NULL;
  scoped_contact *contact = NULL;
  mps_contact_def def = mps_contact_defaults();
  OK(mps_body_create_polygon(context, &at, 4, corner, &wall));
  at.position[0] = 1.0;
  at.position[0] = nearbyint(1.0 / (0.5 * g.cell)) * 0.5 * g.cell;
  OK(mps_body_create_polygon(context, &at, 4, other, &end));
  OK(mps_mpm_add_contact(s.mpm, wall, &def, &contact));
  OK(mps_mpm_add_contact(s.mpm, end, &def, NULL));
  OK(mps_body_set_motion(wall, &motion));
  OK(mps_mpm_step(s.mpm, 600));
  mps_reaction r;
  OK(mps_contact_get_reaction(contact, -1, &r));
  const double K = -r.impulse[0] / mps_mpm_time(s.mpm) / (0.5 * 2000.0 * 9.81 * 0.25);
  print_message(
      "smooth wall moved by %.3g m: %.3f of gamma H^2/2 across, %.1e of that along itself\n",
      motion.velocity[0] * mps_mpm_time(s.mpm), K, r.impulse[1] / r.impulse[0]);
  bounds_print(&g);
  assert_true(fabs(r.impulse[0]) > 0.0);
  assert_true(fabs(r.impulse[1]) <= 1e-9 * fabs(r.impulse[0]));
}

/* ---- a footing ------------------------------------------------------------------------------- */

#define BOUNDS_PRANDTL 5.14159265358979 /* (pi + 2) c, exact */
/* What the grid adds: the ground sees a rigid edge up to a cell wider, and cells that shear carry
 * more than the field of a mechanism; of B/2 = b the share `cells` h/b. */
#define BOUNDS_OVERSHOOT 0.6

/* A strip on clay without weight bears at most (pi + 2) c times the deformed footing's own width.
 * What the method puts on top, up to .35 h/b, is known and printed. */
static inline void bounds_footing(mps_context *context, int number, double *margin) {
  bounds_draw d = bounds_begin(3000 + number);
  const double b = 0.5, su = bounds_scale(&d, 2e3, 5e4), stiff = bounds_scale(&d, 500.0, 4000.0);
  const int cells = 5 + bounds_choice(&d, 4);
  const double h = b / cells * bounds_even(&d, 1.0, 1.25); /* the edge is between grid lines */
  const double width = ceil(2.2 / h) * h, depth = ceil(1.3 / h) * h;
  scoped_mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.0, 0.0, width, depth);
  OK(mps_particles_set(s.particles, "density", 0, 2000.0));
  DEF(material_von_mises, law, .young = stiff * su, .poisson = bounds_even(&d, 0.3, 0.49),
      .yield_stress = sqrt(3.0) * su);
  MAKE(material, clay, create_von_mises, context, &law);
  DEF(mpm, def, .cell = h, .spline = 2 + bounds_choice(&d, 2), .lower[0] = def.lower[1] = 0.0,
      .upper[0] = width);
  OK(mps_mpm_create(context, s.particles, clay, &def, &s.mpm));
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  scoped_contact *contact = NULL;
  DEF(body, at, .position[1] = depth + 0.25);
  DEF(contact, surface, .friction = bounds_choice(&d, 2) ? 1.0 : 0.0, .corner = 0.6 * h);
  mps_body_motion motion = mps_body_motion_defaults();
  const double way = 40.0 * BOUNDS_PRANDTL * b / stiff; /* ten times the elastic settlement */
  const double wave = sqrt(law.young * 2.0 / 2000.0);
  motion.velocity[1] = -4e-4 * wave * 500.0 / stiff;
  MAKE(body, footing, create_box, context, &at, 2.0 * b, 0.5);
  OK(mps_mpm_add_contact(s.mpm, footing, &surface, &contact));
  OK(mps_body_set_motion(footing, &motion));
  mps_reaction r[2];
  const double end = fmin(way, 0.04 * b) / -motion.velocity[1];
  OK(mps_mpm_run(s.mpm, 0.7 * end, 10000000, NULL, NULL));
  OK(mps_contact_get_reaction(contact, -1, &r[0]));
  const double from = mps_mpm_time(s.mpm);
  OK(mps_mpm_run(s.mpm, end, 10000000, NULL, NULL));
  OK(mps_contact_get_reaction(contact, -1, &r[1]));
  const double q =
      fabs(r[1].impulse[1] - r[0].impulse[1]) / (mps_mpm_time(s.mpm) - from) / (b * su);
  const double bound = BOUNDS_PRANDTL * (1.0 + BOUNDS_OVERSHOOT * h / b);
  *margin = fmax(*margin, (q / BOUNDS_PRANDTL - 1.0) * b / h);
  print_message("strip, b/h %.2f, E/su %.0f, nu %.2f, mu %g, spline %d: q/c %.3f, %+.1f %% of the "
                "exact bound, %.2f h/b of the %.2f that grids add (%lld steps)\n",
                b / h, stiff, law.poisson, surface.friction, (int)def.spline, q,
                100.0 * (q / BOUNDS_PRANDTL - 1.0), (q / BOUNDS_PRANDTL - 1.0) * b / h,
                BOUNDS_OVERSHOOT, (long long)mps_mpm_steps(s.mpm));
  assert_true(q > 0.5 * BOUNDS_PRANDTL && q < bound);
}

/* ---- a tank ---------------------------------------------------------------------------------- */

/* Water that sloshes in a closed tank: its mean level keeps, within half a spacing at most. */
static inline void bounds_tank(mps_context *context, int number) {
  bounds_draw d = bounds_begin(4000 + number);
  const double l0 = 0.02 * bounds_even(&d, 0.8, 1.2);
  const double length = nearbyint(bounds_even(&d, 0.6, 1.2) / l0) * l0;
  const double depth = nearbyint(bounds_even(&d, 0.2, 0.5) / l0) * l0;
  const double dt = bounds_even(&d, 0.1, 0.25) * l0 / sqrt(TANK_G * depth);
  scoped_tank t = tank_make(context, length, depth, l0, NULL, dt);
  mps_edit u;
  OK(mps_particles_edit(t.water, "velocity", &u));
  const double speed = bounds_even(&d, 0.05, 0.3) * sqrt(TANK_G * depth) * depth / length;
  mps_view x = view_field(t.water, "position");
  for (int64_t k = 0; k < x.shape[0]; k++)
    *mps_edit_f64(&u, k, 0) = speed * sin(TANK_PI * *mps_view_f64(&x, k, 0) / length);
  OK(mps_particles_commit(t.water, &u));
  const double period = 2.0 * length / sqrt(TANK_G * depth);
  double level = 0.0, samples = 0.0;
  for (int k = 1; k <= 40; k++) {
    OK(mps_fluid_run(t.fluid, 3.0 * period * k / 40.0, 1000000, NULL, NULL));
    OK(mps_particles_view(t.water, "position", &x));
    double sum = 0.0;
    for (int64_t n = 0; n < x.shape[0]; n++) sum += *mps_view_f64(&x, n, 1);
    level += 2.0 * sum / (double)x.shape[0], samples += 1.0;
    for (int64_t n = 0; n < x.shape[0]; n++)
      assert_true(*mps_view_f64(&x, n, 0) > -l0 && *mps_view_f64(&x, n, 0) < length + l0 &&
                  *mps_view_f64(&x, n, 1) > -l0);
  }
  print_message("tank of %.2f x %.3f m, l0 %.4f m: mean level over three periods %+.3f spacings "
                "(%+.2f %%)\n",
                length, depth, l0, (level / samples - depth) / l0,
                100.0 * (level / samples / depth - 1.0));
  assert_true(fabs(level / samples - depth) < 0.5 * l0);
}

/* ---- consolidation --------------------------------------------------------------------------- */

/* A layer that drains at its surface under a load, or of its own weight: what its volume has lost
 * is the water that has left, and what the water in the pores is compressed by. */
static inline void bounds_consolidation(mps_context *context, int number) {
  bounds_draw d = bounds_begin(5000 + number);
  bounds_ground g = bounds_draw_ground(&d);
  const double n = bounds_even(&d, 0.3, 0.5), start = bounds_scale(&d, 1e-4, 5e-3) * g.young;
  g.cohesion = g.young; /* elastic */
  scoped_mpm_scene s = bounds_bed(context, &g, 2.0 * g.cell, 1.0, 0.0, true, false);
  const double modulus =
      g.young * (1.0 - g.poisson) / ((1.0 + g.poisson) * (1.0 - 2.0 * g.poisson));
  DEF(pore_water, water, .porosity = n, .bulk = bounds_scale(&d, 10.0, 100.0) * n * modulus);
  /* Terzaghi's time factor after the steps is about .3 */
  water.permeability = fmin(1e-2, bounds_scale(&d, 0.2, 2.0) * 1e3 * 9.81 / sqrt(2e3 * modulus));
  OK(mps_mpm_add_pore_water(s.mpm, &water));
  EDIT(u, s.particles, "pore_pressure")
    EDIT(stress, s.particles, "stress")
      for (int64_t k = 0; k < u.view.shape[0]; k++) {
        *mps_edit_f64(&u, k, 0) = start;
        for (int c = 0; c < 3; c++)
          *mps_edit_f64(&stress, k, c) = start; /* in equilibrium: u - u */
      }
  const double before = mpm_scene_totals(&s).volume;
  OK(mps_mpm_step(s.mpm, 3000));
  mps_pore_budget budget;
  OK(mps_mpm_get_pore_budget(s.mpm, &budget));
  const double lost = before - mpm_scene_totals(&s).volume;
  const mps_view p = mpm_scene_view(&s, "pore_pressure"), V = mpm_scene_view(&s, "volume");
  const mps_view now = mpm_scene_view(&s, "porosity");
  double expanded = 0.0; /* m3: water that is less compressed than at the start */
  for (int64_t k = 0; k < p.shape[0]; k++)
    expanded += *mps_view_f64(&now, k, 0) * *mps_view_f64(&V, k, 0) *
                (start - *mps_view_f64(&p, k, 0)) / water.bulk;
  const double left = budget.drained / 1000.0 - expanded;
  print_message(
      "settlement %.6g of the height, water %.6g: %+.3f %% (residual of the budget %.1e)\n",
      lost / before, left / before, 100.0 * (lost / left - 1.0), budget.residual / budget.drained);
  bounds_print(&g);
  assert_true(left > 0.0);
  assert_true(fabs(lost - left) < 0.01 * left);
}

#endif
