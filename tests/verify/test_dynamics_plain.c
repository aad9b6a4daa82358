/* test_dynamics_plain.c - the solver against an independent plain loop of the published equations
 * (bench/plain_dynamics.h), for a jittered body of random materials that spins and shakes.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "../../bench/plain_dynamics.h"
#include "kit/random.h"
#include "soil_column.h"

enum { COLUMNS = 23, ROWS = 31, COUNT = COLUMNS * ROWS, STEPS = 300 };

/* Position, density, Vs, Vp, velocity x and y, spin of each particle. */
typedef struct sample {
  double xy[2 * COUNT], rho[COUNT], vs[COUNT], vp[COUNT], v[3 * COUNT];
} sample;

static void draw(sample *s) {
  uint64_t seed = 20;
  for (int k = 0; k < COUNT; k++) {
    s->xy[2 * k] = k % COLUMNS + 0.15 * noise(&seed);
    s->xy[2 * k + 1] = k / COLUMNS + 0.15 * noise(&seed); /* NOLINT(bugprone-integer-division) */
    s->rho[k] = 1500.0 + 300.0 * noise(&seed);
    s->vs[k] = 100.0 + 30.0 * noise(&seed);
    s->vp[k] = s->vs[k] * (1.9 + 0.3 * noise(&seed));
    /* a slow solid-body spin of the whole, so that rotations become large, and noise */
    s->v[3 * k] = -0.8 * s->xy[2 * k + 1] + 0.3 * noise(&seed);
    s->v[3 * k + 1] = 0.8 * s->xy[2 * k] + 0.3 * noise(&seed);
    s->v[3 * k + 2] = 0.8 + 0.2 * noise(&seed);
  }
}

static plain_body plain_from(mps_context *context, const sample *s, int integrator, int removal,
                             double damping, double dt) {
  plain_body b = plain_create(COUNT, s->xy, 1.0, 1.5);
  b.integrator = integrator;
  b.removal = removal;
  b.dt = dt;
  b.alpha = damping * 4.0 * 3.14159265358979323846 * 14.0 / 15.0;
  b.beta = damping / (3.14159265358979323846 * 15.0);
  for (int k = 0; k < COUNT; k++) {
    b.rho[k] = s->rho[k];
    b.mu[k] = s->rho[k] * s->vs[k] * s->vs[k];
    b.lambda[k] = s->rho[k] * s->vp[k] * s->vp[k] - 2.0 * b.mu[k];
    for (int c = 0; c < 3; c++) {
      b.v[3 * k + c] = s->v[3 * k + c];
      b.r_old[3 * k + c] = b.r[3 * k + c] - dt * s->v[3 * k + c];
    }
  }
  DEF(neighbours, def, .radius = 1.5);
  const mps_view view = {
      .data = (void *)s->xy, .shape = {COUNT, 2, 1}, .stride = {2, 1, 1}, .dtype = {2, 64, 1}};
  const int64_t *first, *index;
  MAKE(neighbours, lists, create, context, &def);
  OK(mps_neighbours_build(lists, &view));
  OK(mps_neighbours_lists(lists, NULL, &first, &index));
  b.first = malloc((COUNT + 1) * sizeof *b.first);
  b.neighbour = malloc((size_t)first[COUNT] * sizeof *b.neighbour);
  assert_true(b.first && b.neighbour);
  memcpy(b.first, first, (COUNT + 1) * sizeof *b.first);
  for (int64_t k = 0; k < first[COUNT]; k++) b.neighbour[k] = (int32_t)index[k];
  return b;
}

static mps_dynamics *solver_from(mps_context *context, const sample *s, int integrator, int removal,
                                 double damping, double dt, mps_particles **particles) {
  USING(particles, mps_particles_create(context, &given, particles), .spacing = 1.0);
  OK(mps_particles_append(*particles, COUNT, s->xy));
  const char *const names[] = {"density", "shear_velocity", "pressure_velocity",
                               "damping", "velocity",       "spin"};
  mps_edit view[6];
  for (int f = 0; f < 6; f++) {
    OK(mps_particles_add_field(*particles, names[f], 0));
    OK(mps_particles_edit(*particles, names[f], &view[f]));
  }
  for (int64_t k = 0; k < COUNT; k++) {
    *mps_edit_f64(&view[0], k, 0) = s->rho[k];
    *mps_edit_f64(&view[1], k, 0) = s->vs[k];
    *mps_edit_f64(&view[2], k, 0) = s->vp[k];
    *mps_edit_f64(&view[3], k, 0) = damping;
    *mps_edit_f64(&view[4], k, 0) = s->v[3 * k];
    *mps_edit_f64(&view[4], k, 1) = s->v[3 * k + 1];
    *mps_edit_f64(&view[5], k, 0) = s->v[3 * k + 2];
  }
  for (int f = 0; f < 6; f++) OK(mps_particles_commit(*particles, &view[f]));
  DEF(dynamics, def, .integrator = integrator,
      .rotation =
          removal == 12 ? MPS_DYNAMICS_ROTATION_MEAN_MATRIX : MPS_DYNAMICS_ROTATION_MEAN_ANGLE,
      .dt = dt);
  MAKE_KEPT(dynamics, dynamics, create, context, *particles, &def);
  return dynamics;
}

/* Largest difference of x, y and rotation after STEPS steps. */
static double difference(int integrator, int removal, double damping) {
  static sample s;
  draw(&s);
  scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const double dt = integrator == MPS_DYNAMICS_INTEGRATOR_EULER ? 1e-5 : 2e-3;
  scoped_particles *particles = NULL;
  plain_body plain = plain_from(context, &s, integrator, removal, damping, dt);
  scoped_dynamics *dynamics =
      solver_from(context, &s, integrator, removal, damping, dt, &particles);
  for (int k = 0; k < STEPS; k++) plain_step(&plain);
  OK(mps_dynamics_step(dynamics, STEPS));
  double worst = 0.0, most = 0.0;
  for (int64_t id = 0; id < COUNT; id++) {
    for (int c = 0; c < 2; c++)
      worst = fmax(worst, fabs(soil_value(particles, "position", id, c) - plain.r[3 * id + c]));
    worst = fmax(worst, fabs(soil_value(particles, "rotation", id, 0) - plain.r[3 * id + 2]));
    most = fmax(most, fabs(plain.r[3 * id + 2]));
  }
  if (integrator != MPS_DYNAMICS_INTEGRATOR_EULER)
    assert_true(most > 0.3); /* the rotations are finite */
  plain_free(&plain);
  return worst;
}

TEST(the_solver_follows_the_plain_equations) {
  for (int removal = 11; removal <= 12; removal++)
    for (int integrator = 0; integrator <= 2; integrator++)
      for (int damped = 0; damped <= 1; damped++) {
        const double error = difference(integrator, removal, damped ? 0.03 : 0.0);
        print_message("removal %d, integrator %d, damping %g: %.2g\n", removal, integrator,
                      damped ? 0.03 : 0.0, error);
        NEAR(error, 0.0, 1e-9);
      }
}
