/* test_across.c - thin bodies with ground on both sides: nothing passes from one to the other, and
 * each side bears on the body as if the other were not there.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define CELL 0.02
#define SPACING 0.01

/* Rows of particles from `start` along x, `columns` of them to the side `way` (+1 or -1), `rows`
 * upwards from y = 0, in space `deep` of them along z. */
static void add_rows(mpm_scene *s, double start, int way, int columns, int rows, int deep) {
  const bool space = mps_particles_dim(s->particles) == 3;
  for (int k = 0; k < columns * rows * deep; k++) {
    const double x[] = {start + way * (k % columns + 0.5) * SPACING,
                        (k / columns % rows + 0.5) * SPACING,
                        space ? (k / columns / rows + 0.5) * SPACING : 0.0};
    OK(mps_particles_append(s->particles, 1, x));
  }
}

/* A contact without friction. */
static mps_contact *touch(mpm_scene *s, mps_body *body) {
  mps_contact *contact = NULL;
  OK(mps_mpm_add_contact(s->mpm, body, NULL, &contact));
  return contact;
}

static mps_body *half_at(double x, double normal) {
  DEF(body, def, .position[0] = x);
  const double n[] = {normal, 0.0};
  MAKE_KEPT(body, body, create_half_plane, context, &def, n);
  return body;
}

/* A plate across x, its middle at 0. */
static mps_body *plate_of(double thickness, double height) {
  mps_body_def def = mps_body_defaults();
  MAKE_KEPT(body, plate, create_box, context, &def, thickness, height);
  return plate;
}

static void drive(mps_body *body, double vx) {
  WITH_DEFAULTS(mps_body_motion, motion, .velocity[0] = vx);
  OK(mps_body_set_motion(body, &motion));
}

static const double thicknesses[] = {0.1, 0.5, 1.0, 1.5}; /* cells */
static const double shifts[] = {0.0, 0.35, 0.5, 0.8};     /* of the grid, cells */

/* Elastic columns of 0.3 and 0.15 m between smooth walls settle on both sides of a plate: each
 * presses it by K0 rho g H^2/2, the walls behind by the same. */
TEST(columns_press_their_sides) {
  for (int k = 0; k < 8; k++) {
    const double t = thicknesses[k % 4] * CELL, g = 9.81, K0 = 0.3 / 0.7;
    const double exact[] = {0.5 * K0 * 1000.0 * g * 0.09, 0.5 * K0 * 1000.0 * g * 0.0225};
    scoped_mpm_scene s = mpm_scene_begin(context, SPACING, 0.0, 0.0, 1e6);
    add_rows(&s, -0.5 * t, -1, 8, 30, 1);
    add_rows(&s, 0.5 * t, 1, 8, 15, 1);
    DEF(mpm, def, .spline = k < 4 ? 3 : 2, .cell = CELL,
        .origin[0] = -shifts[(k + k / 4) % 4] * CELL, .lower[1] = 0.0, .gravity[1] = -g);
    mpm_scene_solve(&s, &def);
    mps_body *bodies[] = {half_at(-0.5 * t - 0.08, 1.0), half_at(0.5 * t + 0.08, -1.0),
                          plate_of(t, 2.0)};
    mps_contact *contact[3];
    for (int b = 0; b < 3; b++) contact[b] = touch(&s, bodies[b]);
    OK(mps_mpm_settle(s.mpm, NULL, NULL));
    double force[3];
    for (int b = 0; b < 3; b++) {
      mps_reaction r;
      OK(mps_contact_get_reaction(contact[b], -1, &r));
      force[b] = r.force[0];
    }
    print_message("%g cells, shift %g: walls %+.2f, %+.2f %%, plate %+.2f %%\n", t / CELL,
                  -def.origin[0] / CELL, -100.0 * (force[0] + exact[0]) / exact[0],
                  100.0 * (force[1] - exact[1]) / exact[1],
                  100.0 * (force[2] / (exact[0] - exact[1]) - 1.0));
    NEAR(-force[0], exact[0], 0.005 * exact[0]);
    NEAR(force[1], exact[1], 0.005 * exact[1]);
    NEAR(force[2], exact[0] - exact[1], 0.005 * (exact[0] - exact[1]));
    for (int b = 0; b < 3; b++) {
      mps_contact_destroy(&contact[b]);
      mps_body_destroy(&bodies[b]);
    }
  }
}

/* A plate presses the block before it to the wall, away from one behind it, which stays where it
 * is; the force is that of uniaxial compression, M ln(1 - u/w) a metre. */
TEST(plates_press_one_side) {
  for (int k = 0; k < 8; k++) {
    const double t = thicknesses[k % 4] * CELL, width = 0.1, height = 0.1, way = 1e-3;
    const double M = 1e6 * 0.7 / (1.3 * 0.4);
    scoped_mpm_scene s = mpm_scene_begin(context, SPACING, 0.0, 0.0, 1e6);
    add_rows(&s, -0.5 * t, -1, 10, 10, 1);
    add_rows(&s, 0.5 * t, 1, 10, 10, 1);
    DEF(mpm, def, .spline = k < 4 ? 3 : 2, .cell = CELL,
        .origin[0] = -shifts[(k + k / 4) % 4] * CELL, .lower[1] = 0.0, .upper[1] = height);
    mpm_scene_solve(&s, &def);
    scoped_body *wall = half_at(-0.5 * t - width, 1.0), *plate = plate_of(t, 0.5);
    mps_contact *contact[] = {touch(&s, wall), touch(&s, plate)};
    drive(plate, -0.02);
    OK(mps_mpm_run(s.mpm, way / 0.02, 1, NULL, NULL));
    drive(plate, 0.0);
    OK(mps_mpm_settle(s.mpm, NULL, NULL));
    mps_reaction r;
    OK(mps_contact_get_reaction(contact[1], -1, &r));
    const double exact = -M * log(1.0 - way / width) * height;
    const mps_view x = mpm_scene_view(&s, "position");
    int behind = 0;
    for (int64_t i = 0; i < x.shape[0]; i++) {
      const double along = (*mps_view_f64(&x, i, 0) - 0.5 * t) / SPACING - 0.5;
      if (along < -0.1) continue;
      NEAR(along, round(along), 1e-12); /* where it was */
      behind++;
    }
    assert_int_equal(behind, 100);
    print_message("%g cells, shift %g: %+.3f %%\n", t / CELL, -def.origin[0] / CELL,
                  100.0 * (r.force[0] / exact - 1.0));
    NEAR(r.force[0], exact, 0.01 * exact);
    for (int b = 0; b < 2; b++) mps_contact_destroy(&contact[b]);
  }
}

/* A tube, a plate and a round plate, thinner than a cell: the ground on one side slides past, that
 * on the other stays where it is. By nodes and by cells too. */
TEST(nothing_passes) {
  static const int32_t volumetric[] = {MPS_MPM_VOLUMETRIC_POINT, MPS_MPM_VOLUMETRIC_CELL,
                                       MPS_MPM_VOLUMETRIC_NODES};
  for (int k = 0; k < 18; k++) {
    const int geometry = k / 3 % 3, dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
    const double t = 0.004, ring = geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? 0.1 : 0.0;
    scoped_mpm_scene s = mpm_scene_begin_in(context, dim, SPACING, 0.0, 0.0, 1e6);
    add_rows(&s, ring - 0.5 * t, -1, 4, 6, dim == 3 ? 4 : 1);
    add_rows(&s, ring + 0.5 * t, 1, 4, 6, dim == 3 ? 4 : 1);
    DEF(mpm, def, .geometry = geometry, .spline = k < 9 ? 3 : 2, .cell = CELL);
    if (geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC) def.lower[0] = 0.0;
    def.volumetric = volumetric[k % 3];
    OK(mps_particles_add_field(s.particles, "velocity", 0));
    mpm_scene_solve(&s, &def);
    mps_edit v = mpm_scene_edit(&s, "velocity");
    mps_view x = mpm_scene_view(&s, "position");
    for (int64_t i = 0; i < x.shape[0]; i++)
      *mps_edit_f64(&v, i, 1) = *mps_view_f64(&x, i, 0) < ring ? 1.0 : 0.0;
    mpm_scene_commit(&s, &v);
    DEF(body, body, .position[0] = ring);
    scoped_body *plate = NULL;
    body.rotation[1] = dim == 3 ? 2.0 * atan(1.0) : 0.0; /* z to x */
    OK(dim == 3 ? mps_body_create_cylinder(context, &body, 0.5, t, &plate)
                : mps_body_create_box(context, &body, t, 1.0, &plate));
    scoped_contact *contact = touch(&s, plate);
    OK(mps_mpm_step(s.mpm, test_steps(40)));
    const mps_view now = mpm_scene_view(&s, "velocity");
    x = mpm_scene_view(&s, "position");
    for (int64_t i = 0; i < x.shape[0]; i++)
      for (int c = 0; c < dim; c++) {
        const double moves = c == 1 && *mps_view_f64(&x, i, 0) < ring ? 1.0 : 0.0;
        NEAR(*mps_view_f64(&now, i, c), moves, 1e-12);
      }
  }
}

/* A plate that ends in the ground parts it no further: a block of particles that encloses it falls
 * freely, and keeps its momentum when the plate pushes into it. */
TEST(ground_is_whole_past_an_end) {
  scoped_mpm_scene s = mpm_scene_begin(context, SPACING, 0.0, 0.0, 1e6);
  add_rows(&s, -0.002, -1, 8, 16, 1);
  add_rows(&s, 0.002, 1, 8, 16, 1);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = CELL);
  DEF(body, body, .position[1] = 0.08 + 0.25, .motion = MPS_BODY_MOTION_FREE, .mass = 1.0,
      .inertia[2] = 0.02, .velocity[0] = 0.5);
  MAKE(body, plate, create_box, context, &body, 0.004, 0.5);
  USING(contact, mps_mpm_add_contact(s.mpm, plate, &given, NULL), .friction = 0.5);
  const double mass = 256 * 1000.0 * SPACING * SPACING;
  OK(mps_mpm_step(s.mpm, 200));
  mps_body_state at;
  OK(mps_body_get_state(plate, &at));
  const mps_view v = mpm_scene_view(&s, "velocity");
  double sum[2] = {0.0}, low[2] = {0.0};
  for (int64_t i = 0; i < v.shape[0]; i++)
    for (int c = 0; c < 2; c++) sum[c] += mass / 256.0 * *mps_view_f64(&v, i, c);
  for (int c = 0; c < 2; c++) NEAR(sum[c] + at.velocity[c], c ? 0.0 : 0.5, 1e-12);
  const mps_view x = mpm_scene_view(&s, "position");
  int count = 0;
  for (int64_t i = 0; i < v.shape[0]; i++) { /* both halves of the lower rows move alike */
    if (!(*mps_view_f64(&x, i, 1) < 0.03)) continue;
    low[*mps_view_f64(&x, i, 0) > at.position[0]] += *mps_view_f64(&v, i, 0);
    count++;
  }
  print_message("below the end: %.4g and %.4g m/s\n", 2 * low[0] / count, 2 * low[1] / count);
  assert_true(fabs(low[0] - low[1]) < 0.15 * fabs(low[0] + low[1]));
}

/* A plate that has left in one step, far from all ground, leaves nothing at the nodes: the block
 * that it stood beside continues as one that no plate was near. */
TEST(a_plate_that_left_is_gone) {
  double velocity[2][2] = {{0.0}};
  for (int plates = 0; plates < 2; plates++) {
    scoped_mpm_scene s = mpm_scene_begin(context, SPACING, 0.0, 0.0, 1e6);
    add_rows(&s, -0.02, -1, 8, 16, 1);
    USING(mpm, mpm_scene_solve(&s, &given), .cell = CELL, .gravity[1] = -9.81);
    scoped_body *plate = plates ? plate_of(0.1 * CELL, 2.0) : NULL;
    if (plate) OK(mps_mpm_add_contact(s.mpm, plate, NULL, NULL));
    OK(mps_mpm_set_dt(s.mpm, 2e-4));
    OK(mps_mpm_step(s.mpm, 1));
    if (plate) drive(plate, 5.0 / 2e-4);
    OK(mps_mpm_step(s.mpm, 20));
    const mps_view v = mpm_scene_view(&s, "velocity");
    for (int c = 0; c < 2; c++) velocity[plates][c] = *mps_view_f64(&v, 77, c);
  }
  for (int c = 0; c < 2; c++) NEAR(velocity[1][c], velocity[0][c], 1e-12);
}
