/* The participant of a preCICE coupling against a stand-in of preCICE: repeated windows leave no
 * trace, bit for bit; forces and stresses arrive at their facets; and the flap, in statics, against
 * Timoshenko's beam. SPDX-License-Identifier: BSD-3-Clause */
#include "mock.h"
#include "precice/flap.h"
#include "precice/participant.h"
#include "test_common.h"

static const flap_def usual = {.width = 0.1,
                               .height = 1.0,
                               .spacing = 0.025,
                               .young = 4e6,
                               .poisson = 0.3,
                               .density = 3000.0,
                               .bending = 1.0,
                               .dt = 0.008};

typedef struct path {
  int windows;
  double tip[64];
  const flap *body;
  app *a;
} path;

static bool note(void *user, mps_elastic *solver) {
  path *p = user;
  double u[2];
  (void)solver;
  if (!flap_tip(p->a, p->body, u)) return false;
  p->tip[p->windows++] = u[0];
  return true;
}

/* The path of the tip through a coupling; `result` and mock_was say how it went. */
static path coupled(const flap_def *def, const char *force, const char *stress,
                    participant_result *result) {
  app a;
  flap body;
  assert_true(app_start(&a, "test", 1));
  assert_true(flap_make(&a, def, &body));
  path p = {.body = &body, .a = &a};
  const participant_def coupling = {.config = PRECICE_CONFIG,
                                    .name = "Solid",
                                    .mesh = "Solid-Mesh",
                                    .force = force,
                                    .stress = stress,
                                    .displacement = "Displacement",
                                    .velocity = "Velocity",
                                    .dt = def->dt,
                                    .each = note,
                                    .user = &p};
  assert_true(participant_run(&a, body.solver, body.facet_count, body.facets, &coupling, result));
  flap_free(&body);
  mps_context_destroy(&a.context);
  if (mock_was.wrong) fail_msg("preCICE refuses: %s", mock_was.wrong);
  return p;
}

/* Windows of 0.02 s in steps of 8, 8 and 4 ms, each repeated three times with forces of which the
 * last are right, have the bits of the same windows without repetition. */
TEST(repeated_windows_leave_no_trace) {
  participant_result once, thrice;
  mock = (mock_def){.window = 0.02, .windows = 20, .repetitions = 1, .rate = 400.0};
  const path plain = coupled(&usual, "Force", NULL, &once);
  assert_int_equal(once.steps, 60);
  assert_int_equal(once.repeats, 0);
  assert_int_equal(mock_was.checkpoints, 0);
  const double largest = mock_was.displacement;
  mock.repetitions = 3;
  const path repeated = coupled(&usual, "Force", NULL, &thrice);
  assert_int_equal(thrice.windows, 20);
  assert_int_equal(thrice.steps, 180);
  assert_int_equal(thrice.repeats, 40);
  assert_int_equal(mock_was.checkpoints, 20);
  assert_int_equal(mock_was.rollbacks, 40);
  assert_int_equal(repeated.windows, 20);
  assert_memory_equal(plain.tip, repeated.tip, sizeof plain.tip);
  assert_true(fabs(plain.tip[19]) > 1e-3);
  assert_true(mock_was.displacement == largest);
}

/* Force f on each of the n facets of the left side, or the stress f/area. The half facets at foot
 * and top have half the area. */
TEST(forces_are_stresses_times_areas) {
  participant_result result;
  mock = (mock_def){.window = 0.02, .windows = 10, .repetitions = 2, .rate = 4000.0};
  const path by_stress = coupled(&usual, NULL, "Stress", &result);
  const int left = mock_was.left;
  assert_int_equal(left, 41); /* rows at 0, 0.025 ... 1 m */
  mock.rate = 4000.0 * usual.spacing;
  const path by_force = coupled(&usual, "Force", NULL, &result);
  /* the same but for the half facets, whose force is twice that of the stress: at the top it moves
   * the tip more */
  const double ratio = by_force.tip[9] / by_stress.tip[9];
  assert_true(ratio > 1.0 && ratio < 1.06);
}

/* Uniform pressure on one side, in statics: q L^4/(8 E' I) + q L^2/(2 k G A), E' of plane strain, k
 * = 5/6. */
static double static_error(double bending, double spacing) {
  app a;
  flap body;
  flap_def def = usual;
  double u[2];
  const double q = 10.0;
  def.bending = bending, def.spacing = spacing;
  assert_true(app_start(&a, "test", 1));
  assert_true(flap_make(&a, &def, &body));
  mps_elastic_load_def load = mps_elastic_load_defaults();
  int64_t *facets = malloc((size_t)body.facet_count * sizeof *facets), count = 0;
  OK(mps_elastic_select_facets(body.solver, MPS_SIDE_X_LOWER, NULL, NULL, body.facet_count, &count,
                               facets));
  load.kind = MPS_ELASTIC_LOAD_TRACTION;
  load.ids = facets, load.id_count = count, load.force[0] = q;
  OK(mps_elastic_add_load(body.solver, &load, NULL));
  OK(mps_elastic_solve(body.solver));
  assert_true(flap_tip(&a, &body, u));
  const double w = def.width, length = def.height, shear = def.young / (2.0 * (1.0 + def.poisson));
  const double stiff = def.young / (1.0 - def.poisson * def.poisson) * w * w * w / 12.0;
  const double theory =
      q * pow(length, 4.0) / (8.0 * stiff) + q * length * length / (2.0 * 5.0 / 6.0 * shear * w);
  free(facets);
  flap_free(&body);
  mps_context_destroy(&a.context);
  return u[0] / theory - 1.0;
}

TEST(the_flap_bends_as_a_beam) {
  for (double n = 4.0; n < 20.0; n *= 2.0)
    print_message("%g cells: without bending stiffness %+.2f %%, with it %+.2f %%\n", n,
                  100.0 * static_error(0.0, 0.1 / n), 100.0 * static_error(1.0, 0.1 / n));
  assert_true(fabs(static_error(1.0, 0.0125)) < 0.02);
  assert_true(static_error(0.0, 0.025) > static_error(1.0, 0.025));
}
