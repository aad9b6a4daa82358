/* test_fluid_wedge_long.c - a wedge enters water at constant velocity: the force grows with time as
 * in the similarity solution of Zhao and Faltinsen (1993, table of deadrise angles).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

#define L0 0.01
#define SPEED 4.0 /* m/s: gravity is 1 to 2 % of the force */
#define DEPTH 0.8
#define HALF 1.2 /* m, of the tank */

typedef struct entry {
  double angle;       /* deadrise, degrees */
  double coefficient; /* F/(rho V^3 t) */
} entry;

static mps_body *make_wedge(double angle) {
  const double half = 0.9, rise = half * tan(angle * TANK_PI / 180.0);
  const double corner[6] = {0.0, 0.0, half, rise, -half, rise};
  DEF(body, at, .position[0] = HALF, .position[1] = DEPTH);
  MAKE_KEPT(body, body, create_polygon, context, &at, 3, corner);
  return body;
}

/* Mean of F/(rho V^3 t) between two depths of the tip by the impulses there, for the force scatters
 * by half of itself from step to step as rows of particles reach the face; V t is the depth. */
static double enter(const entry *e, double from, double to) {
  scoped_tank t = tank_make(context, 2.0 * HALF, DEPTH, L0, NULL, NAN);
  scoped_body *body = make_wedge(e->angle);
  scoped_contact *contact = tank_body(t.fluid, body, MPS_CONTACT_MOVER_OTHER);
  double down = 0.0, impulse = 0.0, exact = 0.0;
  mps_fluid_report report;
  while (down < to) {
    mps_body_motion motion = mps_body_motion_defaults();
    mps_reaction r;
    const double way = SPEED * mps_fluid_dt(t.fluid);
    down += way;
    motion.position[1] = DEPTH - down, motion.velocity[1] = -SPEED;
    OK(mps_body_set_motion(body, &motion));
    OK(mps_fluid_step(t.fluid, 1));
    OK(mps_contact_get_reaction(contact, -1, &r));
    if (down - way < from) continue;
    impulse += r.force[1] * way;
    exact += 1000.0 * SPEED * SPEED * (down - 0.5 * way) * way;
  }
  OK(mps_fluid_get_report(t.fluid, &report));
  const double measured = impulse / exact;
  printf("wedge of %g degrees: F/(rho V^3 t) %.3f, similarity solution %.3f (%+.1f %%), %lld "
         "steps, %lld collisions\n",
         e->angle, measured, e->coefficient, 100.0 * (measured / e->coefficient - 1.0),
         (long long)mps_fluid_steps(t.fluid), (long long)report.collisions);
  fflush(stdout);
  return measured;
}

TEST(force_is_that_of_the_similarity_solution) {
  const entry entries[] = {{40.0, 5.477}, {30.0, 14.139}, {20.0, 42.485}};
  for (size_t k = 0; k < sizeof entries / sizeof *entries; k++) {
    const double measured = enter(&entries[k], 0.05, 0.12);
    NEAR(measured / entries[k].coefficient, 1.0, entries[k].angle > 25.0 ? 0.1 : 0.15);
  }
}
