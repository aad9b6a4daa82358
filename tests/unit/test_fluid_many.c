/* test_fluid_many.c - many boundaries, bodies and segments in a fluid: nothing is lost beyond some
 * number of them, and those behind others change nothing.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

typedef struct tank {
  mps_particles *water;
  mps_fluid *fluid;
} tank;

static void begin(tank *t, double spacing) {
  *t = (tank){0};
  USING(particles, mps_particles_create(context, &given, &t->water), .spacing = spacing);
}

static void fill(tank *t, double level) {
  USING(fluid, mps_fluid_create(context, t->water, &given, &t->fluid), .level = level);
}

static void drop(tank *t) {
  mps_fluid_destroy(&t->fluid);
  mps_particles_destroy(&t->water);
}

static void add_plane(tank *t, double x, double y, double nx, double ny, int32_t *number) {
  USING(fluid_boundary, mps_fluid_add_boundary(t->fluid, &given, number),
        .kind = MPS_BOUNDARY_ROLLER, .point[0] = x, .point[1] = y, .normal[0] = nx,
        .normal[1] = ny);
}

static void add_line(tank *t, int64_t corners, const double *xy) {
  DEF(fluid_boundary, def, .kind = MPS_BOUNDARY_ROLLER, .corners = xy, .corner_count = corners);
  OK(mps_fluid_add_boundary(t->fluid, &def, NULL));
}

static double place(const tank *t, int64_t i, int32_t c) {
  mps_view x = view_field(t->water, "position");
  return *mps_view_f64(&x, i, c);
}

/* ---- boundaries ------------------------------------------------------------------------------ */

enum { FACETS = 101 };
#define RADIUS 1.0
#define LEVEL 0.5
#define SIZE 0.05

/* Facet k of a bowl, from the left end of its rim (0) to the right one. */
static void add_facet(tank *t, int k) {
  const double angle = PI * k / (FACETS - 1), nx = cos(angle), ny = sin(angle);
  add_plane(t, -RADIUS * nx, RADIUS - RADIUS * ny, nx, ny, NULL);
}

static int facet_of(int32_t number) {
  return FACETS / 2 + (number % 2 ? -1 : 1) * ((number + 1) / 2);
}

/* Water in a bowl of 101 planes: pressures are those below its level. */
TEST(water_rests_in_a_bowl_of_planes) {
  tank t;
  begin(&t, SIZE);
  for (int n = 0; n < 40 * 10; n++) {
    const double at[2] = {(n % 40 - 19.5) * SIZE, (n / 40 + 0.5) * SIZE};
    if (hypot(at[0], RADIUS - at[1]) < RADIUS - 0.45 * SIZE)
      OK(mps_particles_append(t.water, 1, at));
  }
  fill(&t, LEVEL);
  for (int32_t b = 0; b < FACETS; b++) add_facet(&t, facet_of(b)); /* from the middle outwards */
  DEF(fluid_load, damping, .all = 1, .kind = MPS_FLUID_LOAD_DAMPING, .rate = 5.0);
  OK(mps_fluid_add_load(t.fluid, &damping, NULL));
  OK(mps_fluid_step(t.fluid, 300));
  double level, worst = 0.0;
  const double middle = 0.0;
  int wet = 0;
  OK(mps_fluid_get_levels(t.fluid, 1, &middle, &level));
  for (int32_t b = 0; b < FACETS; b++) { /* numbers in the order in which they were added */
    const double angle = PI * facet_of(b) / (FACETS - 1);
    const double at[3] = {-RADIUS * cos(angle), RADIUS - RADIUS * sin(angle), 0.0};
    double p;
    OK(mps_fluid_get_pressure(t.fluid, b, 1, at, &p));
    if (at[1] > level - SIZE) continue;
    worst = fmax(worst, fabs(p / 9810.0 - (level - at[1])));
    wet++;
  }
  printf("%lld particles in %d planes: level %.4f m, pressures on %d within %.4f m\n",
         (long long)mps_particles_count(t.water), FACETS, level, wet, worst);
  assert_true(wet > 50);
  assert_true(worst < 0.03 * level);
  for (int64_t i = 0; i < mps_particles_count(t.water); i++)
    assert_true(hypot(place(&t, i, 0), RADIUS - place(&t, i, 1)) < RADIUS);
  scoped_snapshot *snapshot = NULL;
  OK(mps_fluid_snapshot(t.fluid, &snapshot));
  const double before = place(&t, 0, 0);
  OK(mps_fluid_step(t.fluid, 3));
  const double after = place(&t, 0, 0);
  OK(mps_fluid_rollback(t.fluid, snapshot));
  assert_true(place(&t, 0, 0) == before);
  OK(mps_fluid_step(t.fluid, 3));
  assert_true(place(&t, 0, 0) == after);
  OK(mps_fluid_remove_boundary(t.fluid, FACETS - 1));
  assert_int_equal(mps_fluid_rollback(t.fluid, snapshot), MPS_ERROR_STATE);
  drop(&t);
}

/* Numbers are the lowest free ones; one too many is refused and changes nothing. */
TEST(boundaries_have_a_documented_maximum) {
  tank t;
  int32_t number = -1;
  const double at[2] = {0.5, 0.5};
  begin(&t, 0.1);
  OK(mps_particles_append(t.water, 1, at));
  fill(&t, 1.0);
  DEF(fluid_boundary, side, .kind = MPS_BOUNDARY_OPEN, .normal[1] = 1.0, .point[1] = -1.0);
  for (int32_t k = 0; k < MPS_FLUID_MAX_BOUNDARIES; k++)
    OK(mps_fluid_add_boundary(t.fluid, &side, &number));
  assert_int_equal(number, MPS_FLUID_MAX_BOUNDARIES - 1);
  assert_int_equal(mps_fluid_add_boundary(t.fluid, &side, &number), MPS_ERROR_ARGUMENT);
  assert_non_null(
      strstr(mps_context_error(context)->message, "there are 10000 numbers for a boundary"));
  OK(mps_fluid_step(t.fluid, 2));
  OK(mps_fluid_remove_boundary(t.fluid, 77));
  OK(mps_fluid_add_boundary(t.fluid, &side, &number));
  assert_int_equal(number, 77);
  drop(&t);
}

/* ---- bodies ---------------------------------------------------------------------------------- */

enum { ACROSS = 10, BODIES = 2 * ACROSS };

static void middle_of(int b, double *x) {
  x[0] = (6.0 * (b % ACROSS) + 3.0) * SIZE;
  x[1] = (6.0 * (b / ACROSS) + 5.0) * SIZE;
}

static bool in_a_body(const double *x) {
  for (int b = 0; b < BODIES; b++) {
    double at[2];
    middle_of(b, at);
    if (fabs(x[0] - at[0]) < 1.2 * SIZE && fabs(x[1] - at[1]) < 1.2 * SIZE) return true;
  }
  return false;
}

static void add_box(tank *t, int b, mps_body **box, mps_contact **contact) {
  mps_body_def def = mps_body_defaults();
  DEF(fluid_contact, with, .kind = MPS_BOUNDARY_ROLLER);
  const double xy[8] = {-SIZE, -SIZE, SIZE, -SIZE, SIZE, SIZE, -SIZE, SIZE};
  middle_of(b, def.position);
  OK(mps_body_create_polygon(context, &def, 4, xy, box));
  OK(mps_fluid_add_contact(t->fluid, *box, &with, contact));
}

static void add_sides(tank *t, double width) {
  add_plane(t, 0.0, 0.0, 0.0, 1.0, NULL);
  add_plane(t, 0.0, 0.0, 1.0, 0.0, NULL);
  add_plane(t, width, 0.0, -1.0, 0.0, NULL);
}

/* Twenty boxes at rest in still water each have the buoyancy of their area, also after one of them
 * has left, and boundaries have come. */
TEST(twenty_bodies_have_their_buoyancy) {
  tank t;
  mps_body *box[BODIES];
  mps_contact *contact[BODIES];
  const double width = 6.0 * ACROSS * SIZE;
  begin(&t, SIZE);
  for (int n = 0; n < 6 * ACROSS * 16; n++) {
    const double at[2] = {(n % (6 * ACROSS) + 0.5) * SIZE, (n / (6 * ACROSS) + 0.5) * SIZE};
    if (!in_a_body(at)) OK(mps_particles_append(t.water, 1, at));
  }
  fill(&t, 16.0 * SIZE);
  for (int b = 0; b < BODIES; b++) add_box(&t, b, &box[b], &contact[b]);
  add_sides(&t, width);
  DEF(fluid_load, damping, .all = 1, .kind = MPS_FLUID_LOAD_DAMPING, .rate = 5.0);
  OK(mps_fluid_add_load(t.fluid, &damping, NULL));
  double worst = 0.0;
  for (int part = 0; part < 2; part++) {
    OK(mps_fluid_step(t.fluid, 100));
    for (int b = 0; b < BODIES; b++) {
      mps_reaction r;
      if (part == 1 && b == 7) continue;
      OK(mps_contact_get_reaction(contact[b], 0, &r));
      const double buoyancy = 9810.0 * 4.0 * SIZE * SIZE;
      worst = fmax(worst, hypot(r.force[0], r.force[1] - buoyancy) / buoyancy);
    }
    if (part == 0) mps_contact_destroy(&contact[7]);
  }
  printf("%d boxes in %lld particles: forces within %.4f of the buoyancy\n", BODIES,
         (long long)mps_particles_count(t.water), worst);
  assert_true(worst < 0.05);
  for (int b = 0; b < BODIES; b++) {
    mps_contact_destroy(&contact[b]);
    mps_body_destroy(&box[b]);
  }
  OK(mps_fluid_step(t.fluid, 2));
  drop(&t);
}

/* ---- segments -------------------------------------------------------------------------------- */

static void settle_in(tank *t, int lines, int64_t corners, const double *xy) {
  begin(t, SIZE);
  for (int n = 0; n < 128; n++) {
    const double at[2] = {(n % 16 + 0.5) * SIZE, (n / 16 + 0.5) * SIZE};
    OK(mps_particles_append(t->water, 1, at));
  }
  fill(t, 0.45); /* q is not 0: water at another level than that of rest */
  add_plane(t, 0.0, 0.0, 1.0, 0.0, NULL);
  for (int k = 0; k < lines; k++) {
    const double y = -0.001 * k, flat[6] = {0.0, y, 0.0, 0.8, y, 0.0};
    add_line(t, 2, flat);
  }
  if (corners > 0) add_line(t, corners, xy);
  OK(mps_fluid_step(t->fluid, 100)); /* the right side is open: it falls */
}

static double difference(const tank *a, const tank *b) {
  double most = 0.0;
  for (int64_t i = 0; i < 128; i++)
    most = fmax(most, hypot(place(a, i, 0) - place(b, i, 0), place(a, i, 1) - place(b, i, 1)));
  return most;
}

/* A bed below seventy others is not seen, nor are those below it: more segments within re of a
 * particle than it keeps in a list. */
TEST(segments_behind_others_change_nothing) {
  tank one, many;
  mps_reaction r;
  settle_in(&one, 1, 0, NULL);
  settle_in(&many, 71, 0, NULL);
  printf("a bed above 70 others: %.1e m\n", difference(&one, &many));
  assert_true(difference(&one, &many) < 1e-9);
  OK(mps_fluid_get_reaction(many.fluid, 71, &r));
  assert_true(r.force[1] == 0.0);
  OK(mps_fluid_get_reaction(many.fluid, 1, &r));
  assert_true(r.force[1] > 100.0);
  drop(&one), drop(&many);
}

enum { PIECES = 40, COAST = 4000 };

/* A bed of many pieces with a coast of 4000 segments far away is one bed. */
TEST(a_bed_in_pieces_is_one) {
  tank one, many;
  static double xy[3 * (PIECES + COAST + 1)];
  for (int k = 0; k <= PIECES; k++) xy[3 * k] = 2.0 * SIZE * (k - 4);
  const double end = xy[3 * PIECES];
  for (int k = 1; k <= COAST; k++) {
    double *at = xy + 3 * (PIECES + k);
    at[0] = end + 1.2 * SIZE * k, at[1] = k % 2 ? 0.01 : 0.0;
  }
  settle_in(&one, 1, 0, NULL);
  settle_in(&many, 0, PIECES + COAST + 1, xy);
  printf("a bed in %d pieces and a coast of %d: %.1e m\n", PIECES, COAST, difference(&one, &many));
  assert_true(difference(&one, &many) < 1e-9);
  drop(&one), drop(&many);
}

/* Water of 1 x .5 m, 1 m from the right side, and a drop above it that flies 2 m in a step towards
 * that; `more` planes behind the left side. */
static void add_drop(tank *t, int more) {
  const double lower[2] = {0.0, 0.0}, upper[2] = {1.0, 0.5}, at[2] = {0.5, 0.9};
  begin(t, SIZE);
  OK(mps_particles_fill_box(t->water, lower, upper, NULL));
  OK(mps_particles_append(t->water, 1, at));
  OK(mps_particles_add_field(t->water, "velocity", 0));
  EDIT(edit, t->water, "velocity")
    *mps_edit_f64(&edit, mps_particles_count(t->water) - 1, 0) = 2000.0;
  fill(t, 0.5);
  add_sides(t, 2.0);
  for (int k = 0; k < more; k++) add_plane(t, -1.0 - k, 0.0, 1.0, 0.0, NULL);
  OK(mps_fluid_set_dt(t->fluid, 1e-3));
}

/* With many planes a particle looks at those near it; one that goes farther in a step than these
 * reach is put back too. */
TEST(planes_far_away_change_nothing) {
  tank few, many;
  mps_fluid_report report;
  add_drop(&few, 0), add_drop(&many, 40);
  for (int n = 0; n < 20; n++) {
    OK(mps_fluid_step(few.fluid, 1));
    OK(mps_fluid_step(many.fluid, 1));
    for (int64_t i = 0; i < mps_particles_count(many.water); i++) {
      assert_true(place(&many, i, 0) > 0.0 && place(&many, i, 0) < 2.0);
      for (int32_t c = 0; c < 2; c++) assert_true(place(&many, i, c) == place(&few, i, c));
    }
  }
  OK(mps_fluid_get_report(many.fluid, &report));
  assert_true(report.pushed > 0);
  drop(&few), drop(&many);
}
