/* test_fluid_closed.c - fluid that fills a closed box: what keeps its volume works, with pressures
 * up to a constant; what changes it is refused and changes nothing.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

#define L0 0.02
#define LENGTH 0.4
#define DEPTH 0.2

enum { LID = 3 };

static uint64_t seed;

/* Off the lattice by up to .1 l0. */
static void rough(void *user, double *x, double *u) {
  for (int c = 0; c < 2; c++) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    x[c] += 0.1 * L0 * ((double)(seed >> 11) * 0x1p-52 - 1.0);
  }
}

static tank full_box(bool lattice) {
  seed = 7;
  tank t = tank_of(context, LENGTH, DEPTH, L0, 2e-3, NULL, lattice ? NULL : rough, NULL);
  assert_int_equal(tank_wall(t.fluid, 0.0, DEPTH, 0.0, -1.0, NULL), LID);
  return t;
}

static void forces(const tank *t, double *bed, double *left, double *right, double *lid) {
  mps_reaction r[4];
  for (int32_t b = 0; b < 4; b++) OK(mps_fluid_get_reaction(t->fluid, b, &r[b]));
  *bed = r[TANK_BED].force[1], *left = r[TANK_LEFT].force[0];
  *right = -r[TANK_RIGHT].force[0], *lid = -r[LID].force[1];
}

static const double weight = 1000.0 * TANK_G * LENGTH * DEPTH;

/* The least pressure of a particle is rho g l0/2, as half a spacing under a lid without pressure.
 */
TEST(a_full_box_at_rest_has_hydrostatic_pressure) {
  for (int k = 0; k < 2; k++) {
    scoped_tank t = full_box(k == 0);
    double bed, left, right, lid;
    mps_totals sum;
    OK(mps_fluid_step(t.fluid, 300));
    forces(&t, &bed, &left, &right, &lid);
    OK(mps_fluid_get_totals(t.fluid, &sum));
    print_message("full box, %s: bed %.3f N less lid %.3f N, weight %.3f N; ends %.3f, %.3f N; "
                  "kinetic %.1e J\n",
                  k ? "rough" : "lattice", bed, lid, weight, left, right, sum.kinetic);
    NEAR(bed - lid, weight, (k ? 0.005 : 1e-6) * weight);
    NEAR(left, right, (k ? 0.005 : 1e-6) * weight);
    NEAR(lid, 0.0, (k ? 0.02 : 1e-6) * weight);
    assert_true(sum.kinetic < 1e-5 * sum.mass * TANK_G * DEPTH);
  }
}

/* Both ends move with 1 m/s2: the difference of their forces is the mass times that. */
TEST(a_full_box_is_carried_along) {
  scoped_tank t = full_box(true);
  const double a = 1.0, dt = 2e-3;
  double bed, left, right, lid;
  for (int k = 1; k <= 100; k++) {
    const double u = a * dt * k, against = -u;
    OK(mps_fluid_set_boundary_motion(t.fluid, TANK_LEFT, NULL, &u));
    OK(mps_fluid_set_boundary_motion(t.fluid, TANK_RIGHT, NULL, &against));
    OK(mps_fluid_step(t.fluid, 1));
    forces(&t, &bed, &left, &right, &lid);
    NEAR(left - right, a * 1000.0 * LENGTH * DEPTH, 1e-3 * weight);
    NEAR(bed - lid, weight, 1e-3 * weight);
  }
  mps_totals sum;
  OK(mps_fluid_get_totals(t.fluid, &sum));
  NEAR(sum.linear[0], sum.mass * a * 0.2, 3e-3 * sum.mass * a * 0.2);
}

/* A piston of .05 m/s against a lid, also a slow one of 1 um/s, is refused at the first step;
 * places, forces and time stay, and without it the run continues. */
TEST(a_piston_against_a_lid_is_refused) {
  const double speeds[3] = {0.05, -0.05, 1e-6};
  for (int k = 0; k < 3; k++) {
    scoped_tank t = full_box(false);
    double before[4], after[4], u = speeds[k];
    OK(mps_fluid_step(t.fluid, 20));
    forces(&t, &before[0], &before[1], &before[2], &before[3]);
    OK(mps_fluid_set_boundary_motion(t.fluid, TANK_LEFT, NULL, &u));
    assert_int_equal(mps_fluid_step(t.fluid, 1), MPS_ERROR_STATE);
    assert_non_null(strstr(mps_context_error(context)->message, "no free surface"));
    assert_int_equal(mps_fluid_steps(t.fluid), 20);
    forces(&t, &after[0], &after[1], &after[2], &after[3]);
    assert_memory_equal(before, after, sizeof before);
    u = 0.0;
    OK(mps_fluid_set_boundary_motion(t.fluid, TANK_LEFT, NULL, &u));
    OK(mps_fluid_step(t.fluid, 20));
  }
}

/* Air under the lid: the piston moves until the water has filled the space, not farther. */
TEST(a_piston_stops_where_the_air_ends) {
  scoped_tank t = tank_make(context, LENGTH, DEPTH, L0, NULL, 2e-3);
  assert_int_equal(tank_wall(t.fluid, 0.0, DEPTH + 0.5 * L0, 0.0, -1.0, NULL), LID);
  const double u = 0.05, room = LENGTH * (1.0 - DEPTH / (DEPTH + 0.5 * L0));
  mps_status status = MPS_OK;
  while (status == MPS_OK && mps_fluid_time(t.fluid) < 2.0 * room / u) {
    OK(mps_fluid_set_boundary_motion(t.fluid, TANK_LEFT, NULL, &u));
    status = mps_fluid_step(t.fluid, 1);
  }
  print_message("the piston stopped after %.3f of the room: %s\n",
                u * mps_fluid_time(t.fluid) / room, mps_context_error(context)->message);
  assert_int_equal(status, MPS_ERROR_STATE);
  /* l0/4 along all walls may be overfull */
  const double over = 0.25 * L0 * 2.0 * (LENGTH + DEPTH) / (DEPTH + 0.5 * L0);
  assert_true(u * mps_fluid_time(t.fluid) < room + over);
}

/* A solver that measures right sides b, and solves nothing. */
typedef struct right_sides {
  int64_t rows;
  double sum, sizes; /* of b, of |b| */
} right_sides;

static mps_status count_rows(void *user, const mps_linear_matrix *matrix) {
  ((right_sides *)user)->rows = matrix->rows;
  return MPS_OK;
}

static mps_status add_right(void *user, const double *b, double tolerance, double *x,
                            mps_linear_result *result) {
  right_sides *r = user;
  (void)tolerance, (void)x, (void)result;
  for (int64_t i = 0; i < r->rows; i++) r->sum += b[i], r->sizes += fabs(b[i]);
  return MPS_ERROR_CANCELLED;
}

/* The equations of a closed space have a solution only where their right sides add up to 0. */
static void assert_balanced(mps_fluid *fluid) {
  right_sides r = {.rows = 0};
  mps_solver *solver = mps_fluid_solver(fluid);
  DEF(linear_solver, def, .user = &r, .matrix = count_rows, .solve = add_right);
  OK(mps_solver_set_linear_solver(solver, MPS_LINEAR_EQUATION_PRESSURE, &def));
  assert_int_equal(mps_fluid_step(fluid, 1), MPS_ERROR_CANCELLED);
  OK(mps_solver_set_linear_solver(solver, MPS_LINEAR_EQUATION_PRESSURE, NULL));
  assert_int_equal(r.rows, mps_particles_count(mps_fluid_particles(fluid)));
  assert_true(r.sizes > 0.0);
  NEAR(r.sum / r.sizes, 0.0, 1e-12);
}

/* A box in the full box falls freely, heavier than water, until the run ends: its weight less
 * buoyancy and added mass moves it, and the volume is kept. */
TEST(a_body_moves_in_a_full_box) {
  DEF(fluid, def, .dt = 2e-3, .level = DEPTH);
  DEF(body, at, .position[0] = 0.2, .position[1] = 0.1);
  scoped_tank t = {NULL, NULL};
  USING(particles, mps_particles_create(context, &given, &t.water), .spacing = L0);
  for (int j = 0; j < 10; j++)
    for (int i = 0; i < 20; i++) {
      const double p[2] = {(i + 0.5) * L0, (j + 0.5) * L0};
      if (fabs(p[0] - 0.2) < 0.06 && fabs(p[1] - 0.1) < 0.04) continue;
      OK(mps_particles_append(t.water, 1, p));
    }
  OK(mps_fluid_create(context, t.water, &def, &t.fluid));
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(t.fluid, LENGTH, 0.0, -1.0, 0.0, NULL);
  tank_wall(t.fluid, 0.0, DEPTH, 0.0, -1.0, NULL);
  MAKE(body, body, create_box, context, &at, 0.12, 0.08);
  scoped_contact *contact = tank_body(t.fluid, body, MPS_CONTACT_MOVER_OTHER);
  WITH_DEFAULTS(mps_body_motion, motion, .position[0] = 0.2, .position[1] = 0.1);
  for (int k = 1; k <= 100; k++) {
    const double time = def.dt * k;
    motion.velocity[0] = 0.02 * sin(TANK_PI * time / 0.2);
    motion.position[0] += def.dt * motion.velocity[0];
    OK(mps_body_set_motion(body, &motion));
    if (k == 50) assert_balanced(t.fluid);
    OK(mps_fluid_step(t.fluid, 1));
  }
  mps_reaction r;
  double bed, left, right, lid;
  OK(mps_contact_get_reaction(contact, -1, &r));
  forces(&t, &bed, &left, &right, &lid);
  print_message(
      "body in the full box: lift %.3f N (exact %.3f), bed less lid %.3f N (exact %.3f)\n",
      r.force[1], 9810.0 * 0.12 * 0.08, bed - lid, 9810.0 * LENGTH * DEPTH);
  NEAR(r.force[1], 9810.0 * 0.12 * 0.08, 0.02 * weight);
  NEAR(bed - lid, weight, 0.02 * weight);
}
