/* test_mpm_pore_ground.c - water in grounds of other shapes than a layer: radial flow through two
 * rings against its closed form, a layer whose surface lies at any tenth of a cell; a strip on
 * ground that hardly drains, with explicit and implicit pressures; what does not move water;
 * friction, which is of the effective stress.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pore_column.h"
#include "test_fixture.h"
#include "test_journal.h"

#define LOAD 1000.0 /* Pa */

/* ---- rings ----------------------------------------------------------------------------------- */

enum { RINGS = 16 };
#define INNER 0.2 /* m */
#define BORDER 0.5
#define OUTER 1.0
#define SLOW 1e-4 /* m/s */
#define FAST 5e-4

/* Steady flow from the outer side to a drain: u = q ln(r/r_0)/(2 pi k) rho_w g, in each ring. */
TEST(flows_through_rings) {
  const double h = (OUTER - INNER) / RINGS, lo[] = {INNER, 0.0}, hi[] = {OUTER, h};
  scoped_mpm_scene s = mpm_scene_begin_in(context, 2, 0.5 * h, 0.0, 0.0, PORE_YOUNG);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  OK(mps_particles_set(s.particles, "density", 0, 2000.0));
  OK(mps_particles_add_field(s.particles, "permeability", 0));
  const mps_view x = mpm_scene_view(&s, "position");
  EDIT(k, s.particles, "permeability")
    for (int64_t p = 0; p < x.shape[0]; p++)
      *mps_edit_f64(&k, p, 0) = *mps_view_f64(&x, p, 0) < BORDER ? SLOW : FAST;
  DEF(mpm, def, .geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC, .cell = h, .viscous_damping = 20.0);
  for (int c = 0; c < 2; c++) def.lower[c] = lo[c], def.upper[c] = hi[c];
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  USING(pore_water, mps_mpm_add_pore_water(s.mpm, &given), .porosity = 0.4);
  DEF(pore_face, face, .kind = MPS_PORE_FACE_DRAINED, .sides = 1u << MPS_SIDE_X_LOWER);
  int32_t drain;
  OK(mps_mpm_add_pore_face(s.mpm, &face, &drain));
  face.sides = 1u << MPS_SIDE_X_UPPER;
  face.pressure = LOAD;
  OK(mps_mpm_add_pore_face(s.mpm, &face, NULL));
  OK(mps_mpm_run(s.mpm, 20.0, 1000000, NULL, NULL));
  double rate, worst = 0.0;
  OK(mps_mpm_get_pore_flow(s.mpm, drain, &rate, NULL));
  const double inner = log(BORDER / INNER) / SLOW, outer = log(OUTER / BORDER) / FAST;
  const double exact =
      2.0 * 3.14159265358979323846 * h * LOAD / (MPS_PORE_GRAVITY * (inner + outer)); /* kg/s */
  const mps_view now = mpm_scene_view(&s, "position"), u = mpm_scene_view(&s, "pore_pressure");
  for (int64_t p = 0; p < u.shape[0]; p++) {
    const double r = *mps_view_f64(&now, p, 0);
    const double part = r < BORDER ? log(r / INNER) / SLOW : inner + log(r / BORDER) / FAST;
    worst = fmax(worst, fabs(*mps_view_f64(&u, p, 0) / LOAD - part / (inner + outer)));
  }
  print_message("rings: p within %.2f %%, %.6g kg/s, exact %.6g\n", 100.0 * worst, rate, exact);
  assert_true(worst < 0.01);
  NEAR(rate, exact, 0.01 * exact);
}

/* ---- the surface at any tenth of a cell -------------------------------------------------------
 */

TEST(consolidates_at_any_place) {
  const double T = 0.2;
  for (int tenth = 0; tenth < 10; tenth++) {
    pore_column c =
        pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 20.0 - 0.1 * tenth, 0.0, 10.0);
    USING(pore_water, mps_mpm_add_pore_water(c.s.mpm, &given), .porosity = 0.4,
          .bulk = 0.4 * 50.0 * c.modulus,
          .permeability = 0.25 * 1000.0 * MPS_PORE_GRAVITY / c.modulus);
    USING(pore_face, mps_mpm_add_pore_face(c.s.mpm, &given, NULL), .kind = MPS_PORE_FACE_DRAINED,
          .sides = 1u << MPS_SIDE_Y_UPPER, .pressure = -LOAD);
    const double volume = mpm_scene_totals(&c.s).volume;
    OK(mps_mpm_run(c.s.mpm, T * 4.0, 1000000, NULL, NULL));
    const mps_view x = mpm_scene_view(&c.s, "position"), u = mpm_scene_view(&c.s, "pore_pressure");
    double worst = 0.0;
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const double exact = pore_terzaghi(1.0 - *mps_view_f64(&x, k, 1), T);
      worst = fmax(worst, fabs(*mps_view_f64(&u, k, 0) / LOAD + 1.0 - exact));
    }
    const double settled = (1.0 - mpm_scene_totals(&c.s).volume / volume) * c.modulus / LOAD;
    print_message("%.1f cells: u/q within %.2f %%, S M'/(q H) %+.2f %%\n", 20.0 - 0.1 * tenth,
                  100.0 * worst, 100.0 * (settled / pore_terzaghi_degree(T) - 1.0));
    assert_true(worst < 0.02);
    NEAR(settled, pore_terzaghi_degree(T), 0.03 * pore_terzaghi_degree(T));
    mpm_scene_end(&c.s);
  }
}

/* ---- column ---------------------------------------------------------------------------------- */

/* N on a smooth plate that has pushed undrained ground, one cell wide and four high, down at 10
 * mm/s for 0.1 s; K_w/n is 500 M'. */
static double push_column(int32_t scheme) {
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4.0, 0.0, 20.0);
  scoped_contact *contact = NULL;
  DEF(pore_water, water, .scheme = scheme, .porosity = 0.4, .bulk = 0.4 * 500.0 * c.modulus);
  OK(mps_mpm_add_pore_water(c.s.mpm, &water));
  DEF(body, body, .position[1] = 1.5);
  MAKE(body, plate, create_box, context, &body, 4.0, 1.0);
  OK(mps_mpm_add_contact(c.s.mpm, plate, NULL, &contact));
  WITH_DEFAULTS(mps_body_motion, motion, .velocity[1] = -0.01);
  OK(mps_body_set_motion(plate, &motion));
  OK(mps_mpm_run(c.s.mpm, 0.1, 1000000, NULL, NULL));
  mps_reaction reaction;
  OK(mps_contact_get_reaction(contact, -1, &reaction));
  const double exact = 501.0 * c.modulus * 1e-3 * c.h;
  print_message("column, scheme %d: %lld steps, bears %.2f N, at rest %.2f N\n", scheme,
                (long long)mps_mpm_steps(c.s.mpm), reaction.force[1], exact);
  mpm_scene_end(&c.s);
  return reaction.force[1] / exact;
}

/* Also while the body moves, whose contacts share their nodes. */
TEST(pushes_a_column) {
  const double exact = push_column(MPS_PORE_SCHEME_EXPLICIT);
  const double got = push_column(MPS_PORE_SCHEME_IMPLICIT);
  NEAR(exact, 1.0, 0.01);
  NEAR(got, exact, 0.01);
}

/* ---- strip ----------------------------------------------------------------------------------- */

/* What a strip bears, N, and the highest pressure, Pa. */
typedef struct strip_result {
  double force, highest;
} strip_result;

/* Half of a rigid strip of six cells on ground of 12 by 12 cells, which it presses down by 1 mm
 * within 0.05 s and then holds. NaN: undrained. */
static strip_result press_strip(int32_t scheme, double permeability, double friction) {
  enum { CELLS = 12 };
  const double h = 1.0 / CELLS, way = 1e-3, pressing = 0.05,
               modulus = PORE_YOUNG * 0.7 / (1.3 * 0.4);
  scoped_mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, PORE_YOUNG);
  scoped_contact *contact = NULL;
  mpm_scene_box(&s, 0.0, 0.0, 1.0, 1.0);
  OK(mps_particles_set(s.particles, "density", 0, 2000.0));
  USING(mpm, mps_mpm_create(context, s.particles, s.material, &given, &s.mpm), .cell = h,
        .courant = 0.7, .lower[0] = given.lower[1] = 0.0, .upper[0] = 1.0, .viscous_damping = 20.0);
  USING(pore_water, mps_mpm_add_pore_water(s.mpm, &given), .scheme = scheme, .porosity = 0.4,
        .bulk = 0.4 * 50.0 * modulus, .permeability = permeability);
  DEF(body, body, .position[1] = 1.25);
  MAKE(body, strip, create_box, context, &body, 0.5, 0.5);
  USING(contact, mps_mpm_add_contact(s.mpm, strip, &given, &contact), .friction = friction);
  WITH_DEFAULTS(mps_body_motion, motion, .velocity[1] = -way / pressing);
  OK(mps_body_set_motion(strip, &motion));
  OK(mps_mpm_run(s.mpm, pressing, 1000000, NULL, NULL));
  motion.velocity[1] = 0.0, motion.position[1] = 1.25 - way;
  OK(mps_body_set_motion(strip, &motion));
  OK(mps_mpm_run(s.mpm, 0.4, 1000000, NULL, NULL));
  mps_reaction reaction;
  OK(mps_contact_get_reaction(contact, -1, &reaction));
  strip_result out = {.force = reaction.force[1]};
  const mps_view u = mpm_scene_view(&s, "pore_pressure");
  for (int64_t p = 0; p < u.shape[0]; p++) out.highest = fmax(out.highest, *mps_view_f64(&u, p, 0));
  print_message(
      "strip, scheme %d, k %g m/s, friction %g: %lld steps, bears %.1f N, highest %.1f Pa\n",
      scheme, permeability, friction, (long long)mps_mpm_steps(s.mpm), out.force, out.highest);
  return out;
}

/* Implicit pressures, at seven times the step, are those of explicit ones, which are undrained
 * ground's own: a strip that stands still bears as much. Beside the edge of a rough one, where the
 * pressure is highest, they are some hundredths higher. */
TEST(bears_a_strip) {
  static const double permeability[] = {NAN, 1e-6}, friction[] = {0.0, 0.5};
  for (int k = 0; k < 2; k++)
    for (int f = 0; f < 2; f++) {
      const strip_result exact =
          press_strip(MPS_PORE_SCHEME_EXPLICIT, permeability[k], friction[f]);
      const strip_result got = press_strip(MPS_PORE_SCHEME_IMPLICIT, permeability[k], friction[f]);
      NEAR(got.force, exact.force, 0.03 * exact.force);
      NEAR(got.highest, exact.highest, (f == 0 ? 0.03 : 0.06) * exact.highest);
    }
}

/* ---- gaps ------------------------------------------------------------------------------------ */

enum { LAWS = 3 };
static mps_material *sand_of(int law) {
  DEF(material_mohr_coulomb, pyramid, .young = PORE_YOUNG, .poisson = 0.3, .friction = 0.6);
  DEF(material_drucker_prager, cone, .young = PORE_YOUNG, .poisson = 0.3, .friction = 0.6);
  DEF(material_cyclic_sand, cyclic, .young = PORE_YOUNG, .poisson = 0.3, .friction = 0.6,
      .relative_density = 0.5);
  mps_material *out = NULL;
  if (law == 0) OK(mps_material_create_mohr_coulomb(context, &pyramid, &out));
  if (law == 1) OK(mps_material_create_drucker_prager(context, &cone, &out));
  if (law == 2) OK(mps_material_create_cyclic_sand(context, &cyclic, &out));
  return out;
}

/* Undrained sand without stress that is drawn apart opens by all of the strain: its grains keep
 * their volume, and the water has the suction K_w/n times the opening. */
TEST(water_fills_gaps) {
  const double lo[] = {0.5, 0.0}, hi[] = {1.5, 1.0}, bulk = 2e8, porosity = 0.4;
  for (int q = 0; q < 24; q++) {
    scoped_mpm_scene s = mpm_scene_begin_in(context, 2, 0.125, 0.0, 0.0, PORE_YOUNG);
    scoped_material *sand = sand_of(q % LAWS);
    OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
    OK(mps_particles_set(s.particles, "density", 0, 2000.0));
    DEF(mpm, def,
        .geometry = q / 12 ? MPS_MPM_GEOMETRY_AXISYMMETRIC : MPS_MPM_GEOMETRY_PLANE_STRAIN,
        .cell = 0.25, .volumetric = q / 3 % 2 ? MPS_MPM_VOLUMETRIC_POINT : MPS_MPM_VOLUMETRIC_CELL);
    def.lower[0] = lo[0], def.upper[0] = hi[0], def.lower[1] = lo[1];
    OK(mps_mpm_create(context, s.particles, sand, &def, &s.mpm));
    USING(pore_water, mps_mpm_add_pore_water(s.mpm, &given), .porosity = porosity, .bulk = bulk,
          .scheme = q / 6 % 2 ? MPS_PORE_SCHEME_IMPLICIT : MPS_PORE_SCHEME_EXPLICIT);
    const mps_view x = mpm_scene_view(&s, "position");
    EDIT(v, s.particles, "velocity")
      for (int64_t k = 0; k < x.shape[0]; k++)
        *mps_edit_f64(&v, k, 1) = 0.01 * *mps_view_f64(&x, k, 1);
    const double first = mpm_scene_totals(&s).volume;
    OK(mps_mpm_step(s.mpm, 3));
    const mps_view V = mpm_scene_view(&s, "volume"), u = mpm_scene_view(&s, "pore_pressure");
    const mps_view gap = mpm_scene_view(&s, "opening");
    double suction = 0.0, opened = 0.0, grown = mpm_scene_totals(&s).volume - first;
    for (int64_t k = 0; k < V.shape[0]; k++) {
      suction -= *mps_view_f64(&V, k, 0) * *mps_view_f64(&u, k, 0) * porosity / bulk;
      opened += *mps_view_f64(&V, k, 0) * *mps_view_f64(&gap, k, 0);
    }
    print_message("law %d, volumetric %d, scheme %d, geometry %d: water strained by %.6g m3, gaps "
                  "%.6g m3, grains %.6g m3\n",
                  q % LAWS, def.volumetric, q / 6 % 2, def.geometry, suction, opened, grown);
    assert_true(opened > 0.0 || q / 6 % 2); /* pressures that are solved for close gaps at once */
    NEAR(suction, opened + grown, 0.02 * (opened + fabs(grown)));
  }
}

/* ---- accelerations ----------------------------------------------------------------------------
 */

/* A layer under the field `body_acceleration`, -g for `half` steps, g for as many, and so on;
 * returns the number of warnings. */
static int warned_of_acceleration(int32_t scheme, double permeability, int half, int steps) {
  const double lo[] = {0.0, 0.0}, hi[] = {0.5, 1.0};
  journal j = {0};
  scoped_context *own = journal_context(&j, NULL);
  scoped_mpm_scene s = mpm_scene_begin_in(own, 2, 0.125, 0.0, 0.0, PORE_YOUNG);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  OK(mps_particles_set(s.particles, "density", 0, 2000.0));
  DEF(mpm, def, .cell = 0.25, .viscous_damping = 20.0);
  for (int c = 0; c < 2; c++) def.lower[c] = lo[c], def.upper[c] = c ? INFINITY : hi[c];
  OK(mps_mpm_create(own, s.particles, s.material, &def, &s.mpm));
  USING(pore_water, mps_mpm_add_pore_water(s.mpm, &given), .porosity = 0.4, .scheme = scheme,
        .permeability = permeability);
  for (int k = 0; k < steps; k += half) {
    OK(mps_particles_set(s.particles, "body_acceleration", 1, k / half % 2 ? 9.81 : -9.81));
    OK(mps_mpm_step(s.mpm, half));
  }
  if (j.count) assert_non_null(strstr(j.last, "body_acceleration"));
  return j.count;
}

/* Water flows by the gravity of the definition alone, and the log says so of a steady acceleration:
 * the pressures would go to 0 in place of those at rest. */
TEST(says_that_a_steady_acceleration_moves_no_water) {
  for (int32_t scheme = 0; scheme < 2; scheme++) {
    assert_int_equal(warned_of_acceleration(scheme, 1e-4, 600, 1200), 1);
    assert_int_equal(warned_of_acceleration(scheme, 1e-4, 100, 1200), 0);
  }
  assert_int_equal(warned_of_acceleration(0, NAN, 600, 600), 0); /* undrained */
}

/* ---- friction -------------------------------------------------------------------------------- */

#define YOUNG 20e6 /* Pa */
#define UNIT 1e4   /* N/m3, of water, and of ground under it */
#define K0 0.25

typedef struct drawn_scene {
  double cells, mu, bulk; /* K_w/n over K + 4G/3 */
  int32_t scheme;
  bool wall; /* or a frictional side */
  int32_t mirrored;
} drawn_scene;

/* Ground of 1 m^2 under water to its surface, at rest, without a boundary at one side. */
static mpm_scene drowned(const drawn_scene *of) {
  const double h = 1.0 / of->cells, lo[] = {0.0, 0.0}, hi[] = {1.0, 1.0};
  mpm_scene s = mpm_scene_begin_in(context, 2, 0.5 * h, 0.0, 0.0, YOUNG);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  OK(mps_particles_set(s.particles, "density", 0, 2000.0));
  DEF(mpm, def, .cell = h, .viscous_damping = 5.0, .gravity[1] = -UNIT / 1000.0);
  def.lower[1] = 0.0;
  def.lower[0] = of->wall && !of->mirrored ? -h : 0.0;
  def.upper[0] = of->wall && of->mirrored ? 1.0 + h : 1.0;
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  USING(pore_water, mps_mpm_add_pore_water(s.mpm, &given), .porosity = 0.4, .scheme = of->scheme,
        .permeability = 1e-3, .bulk = of->bulk * 0.4 * YOUNG * 0.7 / (1.3 * 0.4));
  OK(mps_mpm_set_pore_level(s.mpm, hi));
  mpm_scene_weigh(&s, UNIT, K0, 1.0);
  return s;
}

/* Shear on what is drawn up along the ground, by 2 mm in 0.1 s, over mu times the effective force.
 */
static double draw_up(const drawn_scene *of) {
  const double speed = 0.02, end = 0.1, out[] = {of->mirrored ? -1.0 : 1.0, 0.0};
  const double t[] = {0.0, end}, way[] = {0.0, speed * end};
  const int32_t side = of->mirrored ? MPS_SIDE_X_UPPER : MPS_SIDE_X_LOWER;
  scoped_mpm_scene s = drowned(of);
  scoped_body *body = NULL;
  scoped_contact *contact = NULL;
  scoped_signal *signal = NULL;
  mps_reaction r;
  double before = 0.0;
  if (of->wall) {
    DEF(body, place, .position[0] = of->mirrored ? 1.0 : 0.0);
    OK(mps_body_create_half_plane(context, &place, out, &body));
    WITH_DEFAULTS(mps_body_motion, motion, .velocity[1] = speed);
    OK(mps_body_set_motion(body, &motion));
    USING(contact, mps_mpm_add_contact(s.mpm, body, &given, &contact), .friction = of->mu);
  } else {
    OK(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 2, t, way, &signal));
    mpm_scene_drive(&s, side, MPS_BOUNDARY_FRICTIONAL, of->mu, 1, signal, 1.0);
  }
  for (int half = 1; half <= 2; half++) {
    OK(mps_mpm_run(s.mpm, 0.5 * half * end, 1000000, NULL, NULL));
    if (of->wall)
      OK(mps_contact_get_reaction(contact, -1, &r));
    else
      OK(mps_mpm_get_reaction(s.mpm, side, &r));
    if (half == 1) before = r.impulse[1];
  }
  return fabs(r.impulse[1] - before) / (0.5 * end) / (of->mu * 0.5 * K0 * UNIT);
}

/* By the total stress walls bore 4.7 times as much, frictional sides 4.0. Sides lack the half cell
 * at the floor, which bears there. */
TEST(friction_is_of_the_effective_stress) {
  static const drawn_scene scenes[] = {
      {4.0, 0.3, 50.0, 0, true, 0},  {8.0, 0.2, 50.0, 0, true, 0},  {8.0, 0.6, 10.0, 0, true, 0},
      {8.0, 0.3, 50.0, 0, true, 1},  {4.0, 0.3, 10.0, 1, true, 0},  {8.0, 0.2, 200.0, 1, true, 0},
      {8.0, 0.4, 50.0, 1, true, 1},  {4.0, 0.3, 50.0, 0, false, 0}, {8.0, 0.2, 10.0, 0, false, 0},
      {8.0, 0.3, 50.0, 0, false, 1}, {4.0, 0.3, 10.0, 1, false, 0}, {8.0, 0.3, 200.0, 1, false, 0},
      {16.0, 0.3, 50.0, 1, false, 0}};
  for (int k = 0; k < (int)(sizeof scenes / sizeof *scenes); k++) {
    const drawn_scene *of = &scenes[k];
    const double exact = of->wall ? 1.0 : 1.0 - 1.0 / of->cells, ratio = draw_up(of);
    print_message("%g cells, mu %g, K_w/n of %g M, %s, %s: %.3f\n", of->cells, of->mu, of->bulk,
                  of->scheme ? "implicit" : "explicit", of->wall ? "wall" : "side", ratio);
    NEAR(ratio, exact, 0.08);
    if (!of->mirrored) continue;
    drawn_scene image = *of;
    image.mirrored = 0;
    const double other = draw_up(&image);
    print_message("  its image differs by %.1e\n", fabs(other - ratio));
    NEAR(other, ratio, of->wall ? 5e-3 : 1e-6); /* sweeps go one way first */
  }
}
