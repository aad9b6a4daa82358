/* test_dynamics_conservation.c - what the equations must keep: momentum, energy, rest under rigid
 * motion, action and reaction of the damping.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/random.h"
#include "soil_column.h"

/* `count` free particles of random material thrown into a square, moving and spinning at random.
 * Damping ratios differ when `damped`. */
static mps_dynamics *random_body(mps_context *context, int64_t count, double speed, bool damped,
                                 const mps_dynamics_def *def, mps_particles **particles) {
  uint64_t seed = 7;
  USING(particles, mps_particles_create(context, &given, particles), .spacing = 1.0);
  const double side = sqrt((double)count);
  for (int64_t placed = 0; placed < count;) { /* apart by at least half a spacing */
    const double x[2] = {0.5 * side * noise(&seed), 0.5 * side * noise(&seed)};
    mps_view view = view_field(*particles, "position");
    bool free_place = true;
    for (int64_t k = 0; k < placed && free_place; k++)
      free_place =
          hypot(*mps_view_f64(&view, k, 0) - x[0], *mps_view_f64(&view, k, 1) - x[1]) > 0.55;
    if (!free_place) continue;
    OK(mps_particles_append(*particles, 1, x));
    placed++;
  }
  const char *const names[] = {"density", "shear_velocity", "pressure_velocity",
                               "damping", "velocity",       "spin"};
  mps_edit view[6];
  for (int f = 0; f < 6; f++) {
    OK(mps_particles_add_field(*particles, names[f], 0));
    OK(mps_particles_edit(*particles, names[f], &view[f]));
  }
  for (int64_t k = 0; k < count; k++) {
    *mps_edit_f64(&view[0], k, 0) = 1500.0 + 500.0 * noise(&seed);
    *mps_edit_f64(&view[1], k, 0) = 100.0 + 40.0 * noise(&seed);
    *mps_edit_f64(&view[2], k, 0) = *mps_view_f64(&view[1].view, k, 0) * (1.8 + 0.3 * noise(&seed));
    *mps_edit_f64(&view[3], k, 0) = damped ? 0.05 + 0.04 * noise(&seed) : 0.0;
    for (int c = 0; c < 2; c++) *mps_edit_f64(&view[4], k, c) = speed * noise(&seed);
    *mps_edit_f64(&view[5], k, 0) = speed * noise(&seed);
  }
  for (int f = 0; f < 6; f++) OK(mps_particles_commit(*particles, &view[f]));
  MAKE_KEPT(dynamics, dynamics, create, context, *particles, def);
  return dynamics;
}

static void close_body(mps_context **context, mps_particles **particles, mps_dynamics **dynamics) {
  mps_dynamics_destroy(dynamics);
  mps_particles_destroy(particles);
  mps_context_destroy(context);
}

/* Sizes against which round-off is small. */
typedef struct scales {
  double linear, angular;
} scales;

static scales momentum_scales(mps_particles *particles) {
  scales s = {0.0, 0.0};
  mps_view rho = view_field(particles, "density");
  mps_view x = view_field(particles, "position");
  mps_view v = view_field(particles, "velocity");
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double p =
        *mps_view_f64(&rho, k, 0) * hypot(*mps_view_f64(&v, k, 0), *mps_view_f64(&v, k, 1));
    s.linear += p;
    s.angular += p * hypot(*mps_view_f64(&x, k, 0), *mps_view_f64(&x, k, 1));
  }
  return s;
}

TEST(free_random_particles_keep_their_momenta) {
  for (int variant = 0; variant < 8; variant++) {
    mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
    mps_particles *particles = NULL;
    DEF(dynamics, def,
        .integrator =
            variant & 1 ? MPS_DYNAMICS_INTEGRATOR_LEAPFROG : MPS_DYNAMICS_INTEGRATOR_VERLET,
        .rotation =
            variant & 2 ? MPS_DYNAMICS_ROTATION_MEAN_ANGLE : MPS_DYNAMICS_ROTATION_MEAN_MATRIX);
    const bool damped = (variant & 4) != 0;
    def.dt = 5e-4;
    mps_dynamics *dynamics = random_body(context, 600, 2.0, damped, &def, &particles);
    /* mass-proportional damping drags the momenta down by itself: with damping, only its pairwise
     * part may act, so take f1 -> 0 */
    if (damped) {
      mps_dynamics_destroy(&dynamics);
      mps_particles_destroy(&particles);
      def.f1 = 1e-14;
      dynamics = random_body(context, 600, 2.0, true, &def, &particles);
    }
    mps_totals before, after;
    const scales size = momentum_scales(particles);
    OK(mps_dynamics_get_totals(dynamics, &before));
    OK(mps_dynamics_step(dynamics, 2000));
    OK(mps_dynamics_get_totals(dynamics, &after));
    const double turn = fabs(after.angular[2] - before.angular[2]);
    print_message("variant %d: linear %.1g %.1g, angular %.1g (relative)\n", variant,
                  fabs(after.linear[0] - before.linear[0]) / size.linear,
                  fabs(after.linear[1] - before.linear[1]) / size.linear, turn / size.angular);
    for (int c = 0; c < 2; c++)
      NEAR((after.linear[c] - before.linear[c]) / size.linear, 0.0, 1e-12);
    NEAR(turn / size.angular, 0.0, damped ? 2e-4 : 1e-12);
    close_body(&context, &particles, &dynamics);
  }
}

TEST(the_printed_torque_does_not_keep_angular_momentum) {
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  mps_particles *particles = NULL;
  DEF(dynamics, def, .dt = 5e-4);
  mps_dynamics *dynamics = random_body(context, 600, 2.0, false, &def, &particles);
  OK(mps_experimental_dynamics_printed_torque(dynamics));
  mps_totals before, after;
  const scales size = momentum_scales(particles);
  OK(mps_dynamics_get_totals(dynamics, &before));
  OK(mps_dynamics_step(dynamics, 200));
  OK(mps_dynamics_get_totals(dynamics, &after));
  assert_true(fabs(after.angular[2] - before.angular[2]) > 1e-6 * size.angular);
  close_body(&context, &particles, &dynamics);
}

TEST(energy_stays_bounded_over_1e5_steps) {
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const soil_layer soil = {16.0, 1500.0, 100.0, 200.0, 0.0};
  mps_particles *particles = soil_particles(context, 1.0, 12.0, 16.0, 1, &soil);
  OK(mps_particles_add_field(particles, "velocity", 0));
  mps_view x = view_field(particles, "position");
  EDIT(v, particles, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++) {
      *mps_edit_f64(&v, k, 0) = 1e-3 * sin(0.3 * *mps_view_f64(&x, k, 1));
      *mps_edit_f64(&v, k, 1) = 1e-3 * cos(0.4 * *mps_view_f64(&x, k, 0));
    }
  DEF(dynamics, def, .courant = 0.8);
  MAKE_KEPT(dynamics, dynamics, create, context, particles, &def);
  mps_totals e;
  double least = INFINITY, most = 0.0;
  for (int k = 0; k < 1000; k++) {
    OK(mps_dynamics_step(dynamics, 100));
    OK(mps_dynamics_get_totals(dynamics, &e));
    assert_true(e.kinetic > 0.0 && e.strain > 0.0);
    least = fmin(least, e.kinetic + e.strain), most = fmax(most, e.kinetic + e.strain);
  }
  print_message("energy over 1e5 steps: spread %.2g of %.6g J/m\n", (most - least) / most, most);
  NEAR((most - least) / most, 0.0, 1e-4);
  close_body(&context, &particles, &dynamics);
}

TEST(rigid_motion_makes_no_force) {
  for (int removal = 0; removal < 2; removal++) {
    mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
    const soil_layer soil = {9.0, 1500.0, 100.0, 200.0, 0.0};
    mps_particles *particles = soil_particles(context, 1.0, 7.0, 9.0, 1, &soil);
    DEF(dynamics, def, .rotation = removal, .dt = 1e-3);
    MAKE_KEPT(dynamics, dynamics, create, context, particles, &def);
    mps_view reference = view_field(particles, "reference");
    EDIT(d, particles, "displacement")
      EDIT(th, particles, "rotation") {
        const double angle = 2.5, c = cos(angle), s = sin(angle);
        for (int64_t k = 0; k < d.view.shape[0]; k++) {
          const double x = *mps_view_f64(&reference, k, 0), y = *mps_view_f64(&reference, k, 1);
          *mps_edit_f64(&d, k, 0) = c * x - s * y - x + 3.0;
          *mps_edit_f64(&d, k, 1) = s * x + c * y - y - 2.0;
          *mps_edit_f64(&th, k, 0) = angle;
        }
      }
    OK(mps_dynamics_restart(dynamics, 0.0));
    OK(mps_dynamics_step(dynamics, 1));
    mps_view a = view_field(particles, "acceleration");
    double most = 0.0;
    for (int64_t k = 0; k < a.shape[0]; k++)
      most = fmax(most, hypot(*mps_view_f64(&a, k, 0), *mps_view_f64(&a, k, 1)));
    NEAR(most, 0.0, 1e-9); /* Vs^2/D = 1e4 m/s2 is the scale */
    close_body(&context, &particles, &dynamics);
  }
}
