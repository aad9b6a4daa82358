/* test_dynamics_free_field.c - free-field columns and viscous edges: level ground between columns
 * moves exactly as infinite ground, and waves from inside leave.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "soil_column.h"

static const soil_layer layers[3] = {{4.0, 1700.0, 120.0, 240.0, 0.05},
                                     {5.0, 1800.0, 200.0, 420.0, 0.04},
                                     {7.0, 2000.0, 350.0, 650.0, 0.02}};

/* Ground 12 m x 16 m of three layers, driven or fed by an oblique pair of S and P motions. */
static mps_dynamics *level_ground(mps_context *context, bool columns, bool viscous,
                                  double radius_ratio, int integrator, mps_particles **particles) {
  *particles = soil_particles(context, 0.5, 12.0, 16.0, 3, layers);
  DEF(dynamics, def, .integrator = integrator, .radius_ratio = radius_ratio,
      .dt = integrator == MPS_DYNAMICS_INTEGRATOR_EULER ? 2e-5 : 2e-4);
  if (columns) {
    OK(mps_dynamics_add_free_field(*particles, MPS_SIDE_X_LOWER, 3));
    OK(mps_dynamics_add_free_field(*particles, MPS_SIDE_X_UPPER, 4));
  } else {
    def.period_x = 12.0;
  }
  MAKE_KEPT(dynamics, dynamics, create, context, *particles, &def);
  int64_t count;
  int64_t *base = soil_select(*particles, -100.0, -1.0, 100.0, 0.5, &count);
  mps_signal *s_wave = NULL, *p_wave = NULL;
  OK(mps_signal_create_ricker(context, 6.0, 0.2, 1.0, &s_wave));
  OK(mps_signal_create_ricker(context, 9.0, 0.15, 0.6, &p_wave));
  if (viscous) {
    DEF(dynamics_boundary, boundary, .signal[0] = s_wave, .signal[1] = p_wave);
    OK(soil_add_viscous(dynamics, &boundary, count, base));
  } else {
    OK(soil_add_driven(dynamics, 0, s_wave, 1.0, count, base));
    OK(soil_add_driven(dynamics, 1, p_wave, 1.0, count, base));
  }
  mps_signal_destroy(&s_wave);
  mps_signal_destroy(&p_wave);
  free(base);
  return dynamics;
}

TEST(level_ground_moves_as_endless_ground) {
  for (int variant = 0; variant < 5; variant++) {
    const int integrator = variant < 3    ? MPS_DYNAMICS_INTEGRATOR_VERLET
                           : variant == 3 ? MPS_DYNAMICS_INTEGRATOR_LEAPFROG
                                          : MPS_DYNAMICS_INTEGRATOR_EULER;
    const bool viscous = variant != 0;
    const double ratio = variant == 2 ? 2.3 : 1.5; /* the second one reaches two columns inside */
    scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
    mps_particles *ground[2];
    mps_dynamics *solver[2];
    for (int k = 0; k < 2; k++) {
      solver[k] = level_ground(context, k == 0, viscous, ratio, integrator, &ground[k]);
      OK(mps_dynamics_run(solver[k], test_quick() ? 0.2 : 0.4, 1000000, NULL, NULL));
    }
    double worst = 0.0, most = 0.0;
    const int64_t body = mps_particles_count(ground[1]); /* the columns have the last ids */
    for (int64_t id = 0; id < body; id++)
      for (int c = 0; c < 2; c++) {
        const double a = soil_value(ground[0], "displacement", id, c);
        const double b = soil_value(ground[1], "displacement", id, c);
        worst = fmax(worst, fabs(a - b)), most = fmax(most, fabs(b));
      }
    print_message("variant %d: difference %.2g of %.2g m\n", variant, worst, most);
    assert_true(most > 1e-4);
    NEAR(worst / most, 0.0, 1e-11);
    for (int k = 0; k < 2; k++) {
      mps_dynamics_destroy(&solver[k]);
      mps_particles_destroy(&ground[k]);
    }
  }
}

/* Energy left in 30 m x 15 m of ground some time after a blow in its middle. */
static double energy_left(bool absorbing) {
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const soil_layer soil = {15.0, 1800.0, 200.0, 400.0, 0.0};
  mps_particles *particles = soil_particles(context, 0.5, 30.0, 15.0, 1, &soil);
  mps_dynamics_def def = mps_dynamics_defaults();
  OK(mps_particles_add_field(particles, "velocity", 0));
  mps_view x = view_field(particles, "position");
  EDIT(v, particles, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const double r2 =
          pow(*mps_view_f64(&x, k, 0) - 15.0, 2) + pow(*mps_view_f64(&x, k, 1) - 7.0, 2);
      *mps_edit_f64(&v, k, 0) = 0.01 * exp(-r2 / 8.0);
      *mps_edit_f64(&v, k, 1) = 0.007 * exp(-r2 / 8.0);
    }
  if (absorbing) {
    OK(mps_dynamics_add_free_field(particles, MPS_SIDE_X_LOWER, 2));
    OK(mps_dynamics_add_free_field(particles, MPS_SIDE_X_UPPER, 2));
  }
  MAKE_KEPT(dynamics, dynamics, create, context, particles, &def);
  if (absorbing) {
    int64_t count;
    int64_t *base = soil_select(particles, -100.0, -1.0, 100.0, 0.5, &count);
    OK(soil_add_viscous(dynamics, NULL, count, base));
    free(base);
  }
  mps_totals before, after;
  OK(mps_dynamics_get_totals(dynamics, &before));
  OK(mps_dynamics_run(dynamics, 0.5, 1000000, NULL, NULL));
  OK(mps_dynamics_get_totals(dynamics, &after));
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&particles);
  mps_context_destroy(&context);
  return (after.kinetic + after.strain) / (before.kinetic + before.strain);
}

TEST(waves_from_inside_leave) {
  const double closed = energy_left(false), open = energy_left(true);
  print_message("energy left: closed edges %.4f, absorbing edges %.4f\n", closed, open);
  NEAR(closed, 1.0, 1e-4);
  assert_true(open < 0.03);
}
