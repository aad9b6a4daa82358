/* test_fluid_coarse.c - the coarse space of the pressure solution: iterations hardly grow with the
 * number of particles, a box without surface and water in two parts are solved for, and the coarse
 * equation itself. SPDX-License-Identifier: BSD-3-Clause */
#include "kit/random.h"
#include "test_fixture.h"

#include "core/base/envelope.h"
#include "fluid_tank.h"
#include "linear_plug.h"

/* ---- the coarse equation --------------------------------------------------------------------- */

enum { ROWS = 60 };

/* Factors what `full` has within an envelope of random rows, at most `reach` wide. */
static void factor(double (*full)[ROWS], mpsi_envelope *e) {
  assert_true(mpsi_envelope_begin(context, e, ROWS));
  for (int i = 0; i < ROWS; i++)
    for (int j = i; j >= 0; j--)
      if (full[i][j] != 0.0) e->first[i] = j;
  assert_true(mpsi_envelope_make(context, e));
  for (int i = 0; i < ROWS; i++)
    for (int j = e->first[i]; j <= i; j++) *mpsi_envelope_at(e, i, j) = full[i][j];
  mpsi_envelope_factor(e);
}

/* A matrix of random couplings, whose rows sum to `more`. */
static void couple(double (*full)[ROWS], double more) {
  uint64_t seed = 3;
  memset(full, 0, ROWS * sizeof *full);
  for (int i = 0; i < ROWS; i++) full[i][i] = more;
  for (int i = 0; i < ROWS; i++)
    for (int j = i > 9 ? i - 9 : 0; j < i; j++) {
      const double w = j == i - 1 || noise(&seed) > 0.3 ? 1.1 + noise(&seed) : 0.0;
      full[i][j] = full[j][i] = -w;
      full[i][i] += w, full[j][j] += w;
    }
}

static double residual(double (*full)[ROWS], const double *x, const double *b) {
  double most = 0.0;
  for (int i = 0; i < ROWS; i++) {
    double sum = -b[i];
    for (int j = 0; j < ROWS; j++) sum += full[i][j] * x[j];
    most = fmax(most, fabs(sum));
  }
  return most;
}

/* Rows that sum to 0 have a solution only for a right side that does, up to a constant: one value
 * is then 0. */
TEST(the_coarse_equation_is_solved) {
  double full[ROWS][ROWS], b[ROWS], x[ROWS];
  for (int singular = 0; singular < 2; singular++) {
    mpsi_envelope e = {0};
    uint64_t seed = 11;
    double sum = 0.0;
    int zeros = 0;
    for (int i = 0; i < ROWS; i++) b[i] = noise(&seed), sum += b[i];
    for (int i = 0; singular && i < ROWS; i++) b[i] -= sum / ROWS;
    couple(full, singular ? 0.0 : 0.01);
    factor(full, &e);
    memcpy(x, b, sizeof x);
    mpsi_envelope_solve(&e, x);
    for (int i = 0; i < ROWS; i++) zeros += x[i] == 0.0;
    assert_int_equal(zeros, singular);
    NEAR(residual(full, x, b), 0.0, 1e-12);
    mpsi_envelope_drop(context, &e);
  }
}

/* ---- iterations ------------------------------------------------------------------------------ */

/* Mean of iterations a step over steps 11 to 30 of waves by a piston in a tank of 16 by 3, and the
 * memory, bytes a particle. */
static double iterations(int rows, double *bytes) {
  const double l0 = 0.3 / rows, length = l0 * round(16.0 / 3.0 * rows);
  mps_fluid_report before, after;
  MAKE(signal, piston, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.02, 0.0);
  tank t = tank_make(context, length, 0.3, l0, piston, 0.04 * sqrt(l0 / TANK_G));
  OK(mps_fluid_step(t.fluid, 10));
  OK(mps_fluid_get_report(t.fluid, &before));
  OK(mps_fluid_step(t.fluid, 20));
  OK(mps_fluid_get_report(t.fluid, &after));
  *bytes = (double)after.bytes / (double)mps_particles_count(t.water);
  tank_free(&t);
  return (double)(after.all_iterations - before.all_iterations) / 20.0;
}

TEST(iterations_hardly_grow_with_the_particles) {
  double bytes[2];
  const double few = iterations(19, &bytes[0]), many = iterations(75, &bytes[1]);
  print_message("iterations a step: %.1f with 1919 particles, %.1f with 30 000; %.0f and %.0f B\n",
                few, many, bytes[0], bytes[1]);
  assert_true(many <= 1.5 * few);
  assert_true(bytes[0] < 640.0 && bytes[1] < 640.0); /* docs/fluid.md says which */
}

/* ---- without a surface, and in parts --------------------------------------------------------- */

/* A box filled with 6400 particles that a load presses to one side: the matrix is singular. The
 * force on a wall and the iterations, with the library's solver or plain conjugate gradients. */
static double press(bool plain, double tolerance, int64_t *iterations) {
  const double side = 0.8;
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  SCOPED(linear_plug_drop) linear_plug p = {.fault = LINEAR_FINE};
  const mps_linear_solver_def solver = linear_plug_def(&p);
  tank t = {NULL, NULL};
  set.spacing = 0.01, def.dt = 2e-3, def.tolerance = tolerance;
  OK(mps_particles_create(context, &set, &t.water));
  tank_fill(t.water, side, side, NULL, NULL);
  OK(mps_fluid_create(context, t.water, &def, &t.fluid));
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(t.fluid, side, 0.0, -1.0, 0.0, NULL);
  tank_wall(t.fluid, 0.0, side, 0.0, -1.0, NULL);
  USING(fluid_load, mps_fluid_add_load(t.fluid, &given, NULL), .all = 1, .acceleration[0] = 3.0);
  if (plain)
    OK(mps_solver_set_linear_solver(mps_fluid_solver(t.fluid), MPS_LINEAR_EQUATION_PRESSURE,
                                    &solver));
  OK(mps_fluid_step(t.fluid, 3));
  mps_reaction right;
  mps_fluid_report report;
  OK(mps_fluid_get_reaction(t.fluid, TANK_RIGHT, &right));
  OK(mps_fluid_get_report(t.fluid, &report));
  assert_int_equal(report.surface, 0);
  *iterations = report.iterations;
  tank_free(&t);
  return right.force[0];
}

TEST(a_box_without_surface_is_solved_for) {
  int64_t own = 0, plain = 0;
  const double expected = press(true, 1e-9, &plain);
  const double force = press(false, 1e-9, &own), coarse = press(false, 1e-6, &own);
  print_message("force on a wall %.9f N by %d iterations, %.9f N by %d plain ones\n", force,
                (int)own, expected, (int)plain);
  NEAR(force, expected, 1e-8 * fabs(expected));
  NEAR(coarse, expected, 1e-5 * fabs(expected));
}

/* Two blocks of water far apart, as after a splash, with a few particles alone between them: each
 * moves as without the other. */
static double fall(bool both) {
  tank t = {NULL, NULL};
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  const double lower2[2] = {3.0, 2.0}, upper2[2] = {3.4, 2.4}, alone[] = {1.5, 1.5, 2.0, 0.3};
  set.spacing = 0.01, def.dt = 1e-3, def.tolerance = 1e-10, def.level = 0.8;
  OK(mps_particles_create(context, &set, &t.water));
  OK(mps_particles_fill_box(t.water, AT(0.0, 0.0), AT(0.8, 0.8), NULL));
  if (both) OK(mps_particles_fill_box(t.water, lower2, upper2, NULL));
  if (both) OK(mps_particles_append(t.water, 2, alone));
  OK(mps_fluid_create(context, t.water, &def, &t.fluid));
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  OK(mps_fluid_step(t.fluid, 10));
  mps_reaction left;
  mps_fluid_report report;
  OK(mps_fluid_get_reaction(t.fluid, TANK_LEFT, &left));
  OK(mps_fluid_get_report(t.fluid, &report));
  if (both) assert_true(report.apart >= 2);
  tank_free(&t);
  return left.force[0];
}

TEST(water_in_parts_is_solved_for) {
  const double one = fall(false), both = fall(true);
  print_message("force on the wall %.9f N, with other water far away %.9f N\n", one, both);
  NEAR(both, one, 1e-7 * fabs(one));
}
