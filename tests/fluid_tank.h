/* fluid_tank.h - a tank of water for tests: bed, a left wall that may move, a right wall.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_FLUID_TANK_H
#define MPS_FLUID_TANK_H

#include "test_common.h"

#define TANK_G 9.81
#define TANK_PI 3.14159265358979323846

enum { TANK_BED = 0, TANK_LEFT = 1, TANK_RIGHT = 2 };

typedef struct tank {
  mps_particles *water;
  mps_fluid *fluid;
} tank;

#define scoped_tank SCOPED(tank_free) tank

/* Adds a wall through (x, y) with the normal (nx, ny) into the water. */
static inline int32_t tank_wall(mps_fluid *fluid, double x, double y, double nx, double ny,
                                mps_signal *signal) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  int32_t number = -1;
  def.point[0] = x, def.point[1] = y, def.normal[0] = nx, def.normal[1] = ny;
  def.signal = signal;
  OK(mps_fluid_add_boundary(fluid, &def, &number));
  return number;
}

/* Changes the position and velocity that a particle of the lattice begins with. */
typedef void (*tank_shape_fn)(void *user, double *x, double *u);

static inline void tank_fill(mps_particles *water, double length, double depth, tank_shape_fn shape,
                             void *user) {
  const double l0 = mps_particles_spacing(water);
  const int columns = (int)lround(length / l0), rows = (int)lround(depth / l0);
  double *x = malloc((size_t)columns * (size_t)rows * 2 * sizeof *x), u[2];
  for (int j = 0; j < rows; j++)
    for (int i = 0; i < columns; i++) {
      double *at = x + 2 * (j * columns + i);
      at[0] = (i + 0.5) * l0, at[1] = (j + 0.5) * l0;
      if (shape) shape(user, at, u);
    }
  OK(mps_particles_append(water, (int64_t)columns * rows, x));
  free(x);
}

/* A tank with the walls TANK_BED, TANK_LEFT, which follows `piston`, and TANK_RIGHT. */
static inline tank tank_of(mps_context *c, double length, double depth, double l0, double dt,
                           mps_signal *piston, tank_shape_fn shape, void *user) {
  tank t = {NULL, NULL};
  USING(particles, mps_particles_create(c, &given, &t.water), .spacing = l0);
  tank_fill(t.water, length, depth, shape, user);
  USING(fluid, mps_fluid_create(c, t.water, &given, &t.fluid), .dt = dt, .level = depth);
  assert_int_equal(tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL), TANK_BED);
  assert_int_equal(tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, piston), TANK_LEFT);
  assert_int_equal(tank_wall(t.fluid, length, 0.0, -1.0, 0.0, NULL), TANK_RIGHT);
  return t;
}

static inline tank tank_make(mps_context *c, double length, double depth, double l0,
                             mps_signal *piston, double dt) {
  return tank_of(c, length, depth, l0, dt, piston, NULL, NULL);
}

/* Puts a body with a slippery surface into the water. */
static inline mps_contact *tank_body(mps_fluid *fluid, mps_body *body, int32_t mover) {
  DEF(fluid_contact, def, .kind = MPS_BOUNDARY_ROLLER, .mover = mover);
  mps_contact *contact = NULL;
  OK(mps_fluid_add_contact(fluid, body, &def, &contact));
  return contact;
}

/* The same, and the water moves it; the contact is the fluid's alone. */
static inline void tank_float(mps_fluid *fluid, mps_body *body) {
  DEF(fluid_contact, def, .kind = MPS_BOUNDARY_ROLLER);
  OK(mps_fluid_add_contact(fluid, body, &def, NULL));
}

static inline void tank_free(tank *t) {
  mps_fluid_destroy(&t->fluid);
  mps_particles_destroy(&t->water);
}

#endif
