/* test_fluid_turned.c - water and its image that is turned by any angle move alike: around a box
 * through the surface, a box below it or on the bed, and corners of a polyline.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

#define L0 0.02
#define LENGTH 0.64 /* m */
#define DEPTH 0.3

typedef struct scene {
  const char *name;
  double box[2];     /* m: the middle of one of .16 x .12 m; 0: none */
  const double *bed; /* corners of a polyline around the water */
  int corners;
  double dry[2]; /* m: no water left of and below this */
} scene;

typedef struct image {
  double c, s;
} image;

static void turn(image m, double x, double y, double *out) {
  out[0] = m.c * x - m.s * y, out[1] = m.s * x + m.c * y;
}

/* Particles up to .1 l0 off their lattice, with the velocities of a standing wave. */
static mps_particles *fill_scene(const scene *t, image m) {
  mps_particles *water = NULL;
  USING(particles, mps_particles_create(context, &given, &water), .spacing = L0);
  uint32_t random = 1;
  double u[2000][2];
  int64_t count = 0;
  for (int k = 0; k < 32 * 15; k++) {
    double x[2] = {(k % 32 + 0.5) * L0, (k / 32 + 0.5) * L0}, at[2];
    for (int c = 0; c < 2; c++) {
      random = random * 1664525u + 1013904223u;
      x[c] += (random / 4294967296.0 - 0.5) * 0.2 * L0;
    }
    const bool box =
        t->box[0] > 0.0 && fabs(x[0] - t->box[0]) < 0.09 && fabs(x[1] - t->box[1]) < 0.08;
    if (box || (x[0] < t->dry[0] + 0.5 * L0 && x[1] < t->dry[1] + 0.5 * L0 && t->bed)) continue;
    const double a = TANK_PI * x[0] / LENGTH, b = TANK_PI * x[1] / LENGTH;
    turn(m, -0.1 * sin(a) * cosh(b), 0.1 * cos(a) * sinh(b), u[count++]);
    turn(m, x[0], x[1], at);
    OK(mps_particles_append(water, 1, at));
  }
  OK(mps_particles_add_field(water, "velocity", 0));
  EDIT(v, water, "velocity")
    for (int64_t i = 0; i < count; i++)
      for (int c = 0; c < 2; c++) *mps_edit_f64(&v, i, c) = u[i][c];
  return water;
}

static void add_walls(mps_fluid *fluid, const scene *t, image m) {
  const double at[3][4] = {{0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 1.0, 0.0}, {LENGTH, 0.0, -1.0, 0.0}};
  double corner[30] = {0.0};
  mps_fluid_boundary_def wall = mps_fluid_boundary_defaults();
  wall.kind = MPS_BOUNDARY_ROLLER;
  for (int k = 0; k < t->corners; k++) turn(m, t->bed[2 * k], t->bed[2 * k + 1], corner + 3 * k);
  if (t->bed) {
    wall.corners = corner, wall.corner_count = t->corners;
    OK(mps_fluid_add_boundary(fluid, &wall, NULL));
  }
  for (int b = 0; b < 3 && !t->bed; b++) {
    turn(m, at[b][0], at[b][1], wall.point);
    turn(m, at[b][2], at[b][3], wall.normal);
    OK(mps_fluid_add_boundary(fluid, &wall, NULL));
  }
}

/* Forces on the box, else the boundary, turned back, and velocities by identity, after 3 steps. */
static void run(const scene *t, double degrees, double *force, double (*velocity)[2]) {
  const image m = {cos(degrees * TANK_PI / 180.0), sin(degrees * TANK_PI / 180.0)};
  const image back = {m.c, -m.s};
  scoped_fluid *fluid = NULL;
  scoped_particles *water = fill_scene(t, m);
  DEF(fluid, def, .level = DEPTH, .tolerance = 1e-12);
  turn(m, 0.0, -TANK_G, def.gravity);
  OK(mps_fluid_create(context, water, &def, &fluid));
  add_walls(fluid, t, m);
  DEF(body, given, .rotation[2] = degrees * TANK_PI / 180.0);
  turn(m, t->box[0], t->box[1], given.position);
  MAKE(body, box, create_box, context, &given, 0.16, 0.12);
  scoped_contact *contact = t->bed ? NULL : tank_body(fluid, box, MPS_CONTACT_MOVER_SOLVER);
  OK(mps_fluid_step(fluid, 3));
  mps_reaction by;
  if (contact)
    OK(mps_contact_get_reaction(contact, -1, &by));
  else
    OK(mps_fluid_get_reaction(fluid, 0, &by));
  turn(back, by.force[0], by.force[1], force);
  const mps_view u = view_field(water, "velocity"), id = view_field(water, "id");
  for (int64_t i = 0; i < mps_particles_count(water); i++)
    turn(back, *mps_view_f64(&u, i, 0), *mps_view_f64(&u, i, 1),
         velocity[*mps_view_i64(&id, i, 0) % 2000]);
}

TEST(turned_scenes_move_alike) {
  static const double step[] = {0.0, 0.6, 0.0, 0.12, 0.2, 0.12, 0.2, 0.0, LENGTH, 0.0, LENGTH, 0.6};
  const scene scenes[4] = {{"box through the surface", {0.3, 0.25}, NULL, 0, {0.0, 0.0}},
                           {"box under water", {0.3, 0.15}, NULL, 0, {0.0, 0.0}},
                           {"box on the bed", {0.3, 0.06}, NULL, 0, {0.0, 0.0}},
                           {"step of a bed", {0.0, 0.0}, step, 6, {0.2, 0.12}}};
  const double degrees[3] = {90.0, 17.0, -135.0};
  for (int s = 0; s < 4; s++)
    for (int d = 0; d < 3; d++) {
      static double velocity[2][2000][2];
      double force[2][2], most = 0.0;
      run(&scenes[s], 0.0, force[0], velocity[0]);
      run(&scenes[s], degrees[d], force[1], velocity[1]);
      for (int i = 0; i < 2000; i++)
        most = fmax(most, hypot(velocity[1][i][0] - velocity[0][i][0],
                                velocity[1][i][1] - velocity[0][i][1]));
      const double apart = hypot(force[1][0] - force[0][0], force[1][1] - force[0][1]);
      print_message("%s, by %g degrees: velocities within %.1e m/s, force %.1e N\n", scenes[s].name,
                    degrees[d], most, apart);
      NEAR(most, 0.0, 1e-6);
      NEAR(apart, 0.0, 1e-4);
    }
}
