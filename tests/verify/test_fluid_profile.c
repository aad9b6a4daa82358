/* test_fluid_profile.c - the face of a structure as a row of convex bodies side by side, with
 * convex and concave corners between their faces: slopes with a berm, a step, still water on them
 * against hydrostatics. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#define DEPTH 0.4 /* m */
#define L0 0.025

enum { POINTS = 6 };

typedef struct profile {
  const char *name;
  int count;
  double x[POINTS][2]; /* m, from the toe over the surface */
} profile;

static double ground(const profile *p, double x) {
  double y = 0.0;
  for (int k = 0; k + 1 < p->count; k++) {
    const double *a = p->x[k], *b = p->x[k + 1];
    if (x >= a[0] && x <= b[0] && b[0] > a[0])
      y = a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]);
  }
  return y;
}

static double distance(const profile *p, double x, double y) {
  double least = INFINITY;
  for (int k = 0; k + 1 < p->count; k++) {
    const double *a = p->x[k], *b = p->x[k + 1], ex = b[0] - a[0], ey = b[1] - a[1];
    const double s =
        fmin(fmax(((x - a[0]) * ex + (y - a[1]) * ey) / (ex * ex + ey * ey), 0.0), 1.0);
    least = fmin(least, hypot(x - a[0] - s * ex, y - a[1] - s * ey));
  }
  return least;
}

static mps_particles *fill(const profile *p) {
  DEF(particles, set, .spacing = L0);
  const double end = p->x[p->count - 1][0];
  MAKE_KEPT(particles, water, create, context, &set);
  for (double y = 0.5 * L0; y < DEPTH; y += L0)
    for (double x = 0.5 * L0; x < end && ground(p, x) < y; x += L0) {
      const double at[2] = {x, y};
      if (distance(p, x, y) >= 0.45 * L0) OK(mps_particles_append(water, 1, at));
    }
  return water;
}

static void wall(mps_fluid *fluid, double nx, double ny) {
  DEF(fluid_boundary, def, .kind = MPS_BOUNDARY_ROLLER, .normal[0] = nx, .normal[1] = ny);
  OK(mps_fluid_add_boundary(fluid, &def, NULL));
}

/* A body below each part of the face that is not upright. */
static int add_parts(mps_fluid *fluid, const profile *p, mps_contact **contact) {
  int count = 0;
  for (int k = 0; k + 1 < p->count; k++) {
    const double *a = p->x[k], *b = p->x[k + 1];
    const double xy[8] = {a[0], 0.0, b[0], 0.0, b[0], b[1], a[0], a[1]};
    mps_body_def body_def = mps_body_defaults();
    DEF(fluid_contact, def, .kind = MPS_BOUNDARY_ROLLER);
    if (!(b[0] > a[0])) continue;
    MAKE(body, body, create_polygon, context, &body_def, a[1] > 0.0 ? 4 : 3, xy);
    OK(mps_fluid_add_contact(fluid, body, &def, &contact[count++]));
  }
  return count;
}

static void still_water_stays_still(const profile *p) {
  scoped_fluid *fluid = NULL;
  mps_contact *contact[4] = {NULL};
  scoped_particles *water = fill(p);
  double mean = 0.0, whole = 0.5 * 9810.0 * DEPTH * DEPTH;
  USING(fluid, mps_fluid_create(context, water, &given, &fluid), .level = DEPTH);
  wall(fluid, 0.0, 1.0);
  wall(fluid, 1.0, 0.0);
  const int parts = add_parts(fluid, p, contact);
  OK(mps_fluid_run(fluid, 1.0, 100000, NULL, NULL));
  enum { STEPS = 40 };
  for (int n = 0; n < STEPS; n++) {
    OK(mps_fluid_step(fluid, 1));
    for (int k = 0; k < parts; k++) {
      mps_reaction r;
      OK(mps_contact_get_reaction(contact[k], -1, &r));
      mean += r.force[0] / STEPS;
    }
  }
  mps_totals sum;
  OK(mps_fluid_get_totals(fluid, &sum));
  printf("%s: force %.1f N, at rest %.1f N (%+.2f %%), kinetic energy %.2g J\n", p->name, mean,
         whole, 100.0 * (mean / whole - 1.0), sum.kinetic);
  NEAR(mean / whole, 1.0, 0.025); /* a lattice fills slopes by steps */
  assert_true(sum.kinetic < 0.3); /* J, of some hundred in waves of .1 m */
  for (int k = 0; k < 4; k++) mps_contact_destroy(&contact[k]);
}

TEST(a_face_of_several_parts_holds_still_water) {
  static const profile profiles[] = {
      {"slope 1:2", 2, {{1.0, 0.0}, {2.2, 0.6}}},
      {"slopes 1:2 with a berm", 4, {{1.0, 0.0}, {1.4, 0.2}, {1.8, 0.2}, {2.6, 0.6}}},
      {"1:3.6, then 1:0.53", 3, {{1.0, 0.0}, {1.8, 0.22}, {2.0, 0.6}}},
      {"1:0.67, then 1:4", 3, {{1.0, 0.0}, {1.2, 0.3}, {2.0, 0.5}}},
      {"step", 5, {{1.0, 0.0}, {1.0, 0.2}, {1.5, 0.2}, {1.5, 0.6}, {1.8, 0.6}}},
      {"beach and crest", 4, {{1.0, 0.0}, {1.4, 0.1067}, {1.8, 0.4}, {2.0, 0.6}}}};
  for (size_t k = 0; k < sizeof profiles / sizeof *profiles; k++)
    still_water_stays_still(&profiles[k]);
}
