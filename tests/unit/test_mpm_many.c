/* test_mpm_many.c - more contacts, bodies near one block of the grid, and parts of a body than fit
 * into the bits of a word: Newton's third law for their sum, by both methods of contact.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

enum { ROW = 70, MIDDLE = 35, CROWD = 48, EDGES = 40, STEPS = 200 };
static const double gravity = 10.0, cell = 0.02;

static mpm_scene soil(double x0, double y0, double x1, double y1) {
  mpm_scene s = mpm_scene_begin(context, 0.5 * cell, 0.25 * cell, 0.25 * cell, 1e5);
  mpm_scene_box(&s, x0, y0, x1, y1);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = cell, .gravity[1] = -gravity);
  return s;
}

static mps_body *disc(double x, double y, double radius) {
  mps_body *body = NULL;
  DEF(body, def, .position[0] = x, .position[1] = y);
  OK(mps_body_create_disc(context, &def, radius, &body));
  return body;
}

static mps_body *round_polygon(double x, double y, double radius) {
  double xy[2 * EDGES];
  mps_body *body = NULL;
  DEF(body, def, .position[0] = x, .position[1] = y);
  for (int k = 0; k < EDGES; k++) {
    const double angle = 2.0 * 3.141592653589793 * k / EDGES;
    xy[2 * k] = radius * cos(angle), xy[2 * k + 1] = radius * sin(angle);
  }
  OK(mps_body_create_polygon(context, &def, EDGES, xy, &body));
  return body;
}

static mps_contact *add_contact(mpm_scene *s, mps_body *body, int32_t method) {
  mps_contact *contact = NULL;
  DEF(contact, def, .method = method, .friction = 0.3, .thin = 1);
  OK(mps_mpm_add_contact(s->mpm, body, &def, &contact));
  return contact;
}

/* The particles' momentum is that of gravity, and of all bodies the other way: to `error` of it.
 * Impulses have no nodes to act on whose mass by the fit is not positive: a part of 1e-4 is lost
 * between discs. */
static void check_newton(mpm_scene *s, int count, mps_body **body, double error) {
  const mps_totals t = mpm_scene_totals(s);
  double sum[2] = {0.0, -gravity * t.mass * mps_mpm_time(s->mpm)};
  for (int b = 0; b < count; b++) {
    mps_reaction r;
    OK(mps_body_get_reaction(body[b], -1, &r));
    for (int c = 0; c < 2; c++) sum[c] -= r.impulse[c];
  }
  const double scale = gravity * t.mass * mps_mpm_time(s->mpm);
  for (int c = 0; c < 2; c++) NEAR(t.linear[c], sum[c], error * scale);
}

/* A layer on a row of discs, the middle one a polygon whose edges are named while it is in contact.
 */
static void bear_a_layer(int32_t method) {
  const double pitch = 0.05, radius = 0.022;
  scoped_mpm_scene s = soil(0.0, 0.0, ROW * pitch, 4.0 * cell);
  mps_body *body[ROW];
  mps_contact *contact[ROW];
  for (int b = 0; b < ROW; b++) {
    const double x = (b + 0.5) * pitch, y = -radius;
    body[b] = b == MIDDLE ? round_polygon(x, y, radius) : disc(x, y, radius);
    contact[b] = add_contact(&s, body[b], method);
  }
  OK(mps_mpm_step(s.mpm, 10));
  for (int k = 0; k < EDGES; k++) {
    char name[8];
    snprintf(name, sizeof name, "e%d", k);
    OK(mps_body_name_part(body[MIDDLE], name, k, 1, NULL));
  }
  OK(mps_mpm_step(s.mpm, STEPS));
  check_newton(&s, ROW, body, method == MPS_CONTACT_METHOD_PENALTY ? 1e-11 : 1e-3);
  mps_reaction whole, part, sum = {.count = 0};
  double top = 0.0;
  for (int b = 0; b < ROW; b++) {
    OK(mps_contact_get_reaction(contact[b], -1, &whole));
    assert_true(whole.impulse[1] < 0.0);
  }
  OK(mps_contact_get_reaction(contact[MIDDLE], -1, &whole));
  for (int k = 0; k <= EDGES; k++) {
    OK(mps_contact_get_reaction(contact[MIDDLE], k, &part));
    for (int c = 0; c < 2; c++) sum.impulse[c] += part.impulse[c];
    sum.count += part.count;
    if (k == 1 + 3 * EDGES / 4) assert_int_equal(part.count, 0); /* at the bottom */
    if (abs(k - EDGES / 4) < EDGES / 8) top += part.impulse[1];
  }
  assert_true(top < 0.5 * whole.impulse[1]); /* the rest, on its flanks and before they had names */
  for (int c = 0; c < 2; c++) NEAR(sum.impulse[c], whole.impulse[c], 1e-12);
  assert_int_equal(sum.count, whole.count);
  for (int b = 0; b < ROW; b++) mps_contact_destroy(&contact[b]), mps_body_destroy(&body[b]);
  OK(mps_mpm_step(s.mpm, 1)); /* without any */
}

TEST(seventy_bodies_bear_a_layer) {
  bear_a_layer(MPS_CONTACT_METHOD_IMPULSE);
  bear_a_layer(MPS_CONTACT_METHOD_PENALTY);
}

/* Beads in a block of 8 by 8 cells. */
static void hold_up_a_lump(int32_t method) {
  const double pitch = 0.025, radius = 0.006;
  scoped_mpm_scene s = soil(0.0, 0.0, 8.0 * pitch, 4.0 * cell);
  mps_body *body[CROWD];
  mps_contact *contact[CROWD];
  for (int b = 0; b < CROWD; b++) {
    body[b] = disc((b % 8 + 0.5) * pitch, -radius - b / 8 * pitch, radius);
    contact[b] = add_contact(&s, body[b], method);
  }
  OK(mps_mpm_step(s.mpm, STEPS));
  check_newton(&s, CROWD, body, 1e-11);
  const mps_totals t = mpm_scene_totals(&s); /* they do hold it up */
  assert_true(t.linear[1] > -0.5 * gravity * t.mass * mps_mpm_time(s.mpm));
  for (int b = 0; b < CROWD; b++) mps_contact_destroy(&contact[b]), mps_body_destroy(&body[b]);
}

TEST(forty_eight_beads_in_one_block) {
  hold_up_a_lump(MPS_CONTACT_METHOD_IMPULSE);
  hold_up_a_lump(MPS_CONTACT_METHOD_PENALTY);
}
