/* test_dynamics_limits.c - the stability limit by linear theory and by stepping, against closed
 * forms, against runs just below and above it, and against the reference values of Yoshida.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/random.h"
#include "soil_column.h"
#include "test_fixture.h"

static mps_dynamics *solver(mps_particles *set, const mps_dynamics_def *def) {
  MAKE_KEPT(dynamics, dynamics, create, context, set, def);
  return dynamics;
}

static mps_dynamics_linear_limit linear(mps_dynamics *dynamics, double duration) {
  mps_dynamics_linear_limit limit;
  OK(mps_dynamics_find_limit(dynamics, duration, &limit));
  return limit;
}

static bool printed_torque; /* of what limit_of makes */

/* Limit of a box of `width` x `height` particles, Vs = 120 m/s, D = 0.5 m. */
static mps_dynamics_linear_limit limit_of(const mps_dynamics_def *def, int width, int height,
                                          double ratio, double damping) {
  const soil_layer soil = {1e9, 1700.0, 120.0, 120.0 * ratio, damping};
  scoped_particles *set = soil_particles(context, 0.5, 0.5 * width, 0.5 * height, 1, &soil);
  scoped_dynamics *d = solver(set, def);
  if (printed_torque) OK(mps_experimental_dynamics_printed_torque(d));
  const mps_dynamics_linear_limit limit = linear(d, 0.0);
  return limit;
}

/* ---- linear theory against closed forms ------------------------------------------------------ */

TEST(a_large_lattice_spins_at_root_24) {
  DEF(dynamics, def, .period_x = 4.0);
  for (int torque = 0; torque < 2; torque++) {
    printed_torque = torque;
    const double omega = sqrt(torque ? 48.0 : 24.0) * 120.0 / 0.5;
    const mps_dynamics_linear_limit undamped = limit_of(&def, 8, 300, 2.0, 0.0);
    assert_true(undamped.omega <= omega * (1.0 + 1e-12)); /* its ends are softer */
    NEAR(undamped.omega / omega, 1.0, 1e-4);
    NEAR(undamped.dt, 2.0 / undamped.omega, 1e-15);
    assert_true(undamped.residual < 1e-6 && undamped.iterations > 0);
    const double h = 0.1, w = undamped.omega, alpha = 4.0 * PI * 14.0 / 15.0 * h;
    const double b = h / (PI * 15.0) + alpha / (w * w);
    const mps_dynamics_linear_limit damped = limit_of(&def, 8, 300, 2.0, h);
    NEAR(damped.dt / (-b + sqrt(b * b + 4.0 / (w * w))), 1.0, 1e-9);
    NEAR(damped.omega / w, 1.0, 1e-9);
  }
  printed_torque = false;
}

/* Two particles: w^2 = 5 k Vs^2/D^2 of the shear and spin mode, 2 k Vs^2/D^2 + 4 (l kc)^2 of the
 * stretching, with k = (4d/n0) w and kc = (d/n0) w; l^2 = Vp^2 - 2 Vs^2. */
TEST(two_particles_have_two_modes) {
  const double w = 0.5, n0 = 4.0 * w + 4.0 * (1.5 / sqrt(2.0) - 1.0), k = 8.0 / n0 * w;
  const double kc = 2.0 / n0 * w, V2 = 120.0 * 120.0 / (0.5 * 0.5);
  for (int turned = 0; turned < 2; turned++)
    for (double ratio = 1.5; ratio < 20.0; ratio *= 1.5) {
      const double shear = 5.0 * k * V2;
      const double stretch = (2.0 * k + 4.0 * (ratio * ratio - 2.0) * kc * kc) * V2;
      const mps_dynamics_linear_limit limit =
          limit_of(NULL, turned ? 1 : 2, turned ? 2 : 1, ratio, 0.0);
      NEAR(limit.omega / sqrt(fmax(shear, stretch)), 1.0, 1e-9);
    }
}

/* What is predicted without particles holds for bodies with edges, and does not waste all. */
TEST(the_predicted_step_suits_thin_strips) {
  const double reach[] = {1.2, 1.5, 2.0, 2.6, 3.3}, ratio[] = {1.5, 3.2, 3.7, 5.0, 20.0};
  for (int r = 0; r < 5; r++)
    for (int v = 0; v < 5; v++)
      for (int thick = 1; thick <= 4; thick++) {
        mps_dynamics_def def = mps_dynamics_defaults();
        mps_dynamics_prediction predicted;
        DEF(dynamics_predict, question, .radius_ratio = def.radius_ratio = reach[r], .spacing = 0.5,
            .shear_velocity = 120.0, .pressure_velocity = 120.0 * ratio[v]);
        OK(mps_dynamics_predict(context, &question, &predicted));
        const double limit = limit_of(&def, thick, 20, ratio[v], 0.0).dt;
        if (!(predicted.dt <= limit * (1.0 + 1e-6) && predicted.dt > 0.3 * limit))
          fail_msg("re = %g D, Vp = %g Vs, %d particles thick: predicted %g s, limit %g s",
                   reach[r], ratio[v], thick, predicted.dt, limit);
      }
}

TEST(without_forces_only_alpha_limits) {
  for (int integrator = 0; integrator < 3; integrator++) {
    DEF(dynamics, def, .integrator = integrator);
    const mps_dynamics_linear_limit free_one = limit_of(&def, 1, 1, 2.0, 0.0);
    assert_true(isinf(free_one.dt) && free_one.dt > 0.0);
    NEAR(free_one.omega, 0.0, 0.0);
    const double alpha = 4.0 * PI * 14.0 / 15.0 * 0.3;
    NEAR(limit_of(&def, 1, 1, 2.0, 0.3).dt, 2.0 / alpha, 1e-14);
    const soil_layer soil = {1e9, 1700.0, 120.0, 240.0, 0.0};
    scoped_particles *set = soil_particles(context, 0.5, 2.0, 2.0, 1, &soil);
    scoped_dynamics *d = solver(set, &def);
    soil_hold(set, d, MPS_DOF_X | MPS_DOF_Y | MPS_DOF_ROTATION, -1.0, -1.0, 9.0, 9.0);
    assert_true(isinf(linear(d, 0.0).dt));
  }
}

TEST(boundaries_change_the_limit) {
  const soil_layer soil = {1e9, 1700.0, 120.0, 240.0, 0.0};
  scoped_particles *set = soil_particles(context, 0.5, 4.0, 4.0, 1, &soil);
  scoped_dynamics *d = solver(set, NULL);
  const double spinning = linear(d, 0.0).dt;
  soil_hold(set, d, MPS_DOF_ROTATION, -1.0, -1.0, 9.0, 9.0);
  const double still = linear(d, 0.0).dt;
  assert_true(still > 1.05 * spinning);
  NEAR(mps_dynamics_dt(d), 0.9 * still, 1e-12);
}

/* ---- linear theory against runs -------------------------------------------------------------- */

/* 8 x 8 particles of two materials in random places, some moved off the lattice, each with its own
 * damping if `uneven`; at rest but for displacements of 1e-20 m and rotations of 1e-20. */
static mps_particles *two_materials(uint64_t seed, double damping, bool uneven) {
  const soil_layer soil = {1e9, 1500.0, 100.0, 200.0, damping};
  mps_particles *set = soil_particles(context, 1.0, 8.0, 8.0, 1, &soil);
  mps_edit x, u, th, rho, vs, vp, h;
  OK(mps_particles_add_field(set, "displacement", 0));
  OK(mps_particles_add_field(set, "rotation", 0));
  OK(mps_particles_edit(set, "displacement", &u));
  OK(mps_particles_edit(set, "rotation", &th));
  OK(mps_particles_edit(set, "position", &x));
  OK(mps_particles_edit(set, "density", &rho));
  OK(mps_particles_edit(set, "shear_velocity", &vs));
  OK(mps_particles_edit(set, "pressure_velocity", &vp));
  OK(mps_particles_edit(set, "damping", &h));
  for (int64_t k = 0; k < x.view.shape[0]; k++) {
    if (noise(&seed) > 0.3) {
      *mps_edit_f64(&rho, k, 0) = 2000.0;
      *mps_edit_f64(&vs, k, 0) = 170.0;
      *mps_edit_f64(&vp, k, 0) = 600.0;
    }
    if (uneven) *mps_edit_f64(&h, k, 0) *= 1.0 + noise(&seed);
    *mps_edit_f64(&th, k, 0) = 1e-20 * noise(&seed);
    for (int c = 0; c < 2; c++) {
      if (noise(&seed) > 0.5) *mps_edit_f64(&x, k, c) += 0.2 * noise(&seed);
      *mps_edit_f64(&u, k, c) = 1e-20 * noise(&seed);
      *mps_edit_f64(&x, k, c) += *mps_view_f64(&u.view, k, c);
    }
  }
  OK(mps_particles_commit(set, &vp));
  OK(mps_particles_commit(set, &vs));
  OK(mps_particles_commit(set, &rho));
  OK(mps_particles_commit(set, &u));
  OK(mps_particles_commit(set, &x));
  OK(mps_particles_commit(set, &th));
  OK(mps_particles_commit(set, &h));
  return set;
}

/* Takes `steps` steps of factor * limit; by how much has the largest motion grown? */
static double growth(const mps_dynamics_def *user_def, uint64_t seed, double damping, bool uneven,
                     double duration, double factor, double *dt, int64_t steps) {
  mps_dynamics_def def = *user_def;
  scoped_particles *set = two_materials(seed, damping, uneven);
  def.dt = 1.0;
  def.divergence = 1e6;
  scoped_dynamics *d = solver(set, &def);
  *dt = linear(d, duration).dt;
  OK(mps_dynamics_set_dt(d, factor * *dt));
  if (duration > 0.0) steps = (int64_t)(duration / (factor * *dt) + 0.5);
  double most = 0.0;
  const mps_status status = mps_dynamics_step(d, steps);
  assert_true(status == MPS_OK || status == MPS_ERROR_DIVERGED);
  mps_view u = view_field(set, "displacement");
  mps_view th = view_field(set, "rotation");
  for (int64_t k = 0; k < u.shape[0]; k++) {
    most = fmax(most, fabs(*mps_view_f64(&th, k, 0)));
    for (int c = 0; c < 2; c++) most = fmax(most, fabs(*mps_view_f64(&u, k, c)));
  }
  return status == MPS_OK ? most / 1e-20 : INFINITY;
}

TEST(runs_hold_below_the_limit_and_not_above) {
  const double damping[4] = {0.0, 0.02, 0.2, 1.0};
  for (int integrator = 0; integrator < 2; integrator++)
    for (int form = 0; form < 2; form++)
      for (int k = 0; k < 4; k++)
        for (int uneven = 0; uneven < 2; uneven++) {
          DEF(dynamics, def, .integrator = integrator, .damping = form);
          double dt;
          const uint64_t seed = 17u + (uint64_t)k;
          const double below = growth(&def, seed, damping[k], uneven, 0.0, 0.995, &dt, 1500);
          const double above = growth(&def, seed, damping[k], uneven, 0.0, 1.02, &dt, 1500);
          if (!(below < 100.0 && above > 1e6))
            fail_msg("integrator %d, damping %g, form %d, uneven %d, limit %g s: grows %g times "
                     "below, %g times above",
                     integrator, damping[k], form, uneven, dt, below, above);
        }
}

TEST(euler_holds_below_its_limit_and_not_above) {
  DEF(dynamics, def, .integrator = MPS_DYNAMICS_INTEGRATOR_EULER);
  const double damping[4] = {0.01, 0.05, 0.3, 1.0};
  for (int k = 0; k < 4; k++) {
    double dt;
    const double below = growth(&def, 5, damping[k], false, 0.0, 0.99, &dt, 20000);
    const double above = growth(&def, 5, damping[k], false, 0.0, 1.03, &dt, 20000);
    if (!(dt > 0.0 && below < 100.0 && above > 1e6))
      fail_msg("h = %g, limit %g s: %g times below, %g times above", damping[k], dt, below, above);
  }
  assert_true(limit_of(&def, 6, 6, 2.0, 0.0).dt == 0.0);
}

/* Undamped Euler grows, over the duration requested, by at most 1e15; at the limit by nearly that:
 * the part of the highest mode in the initial state is a few per cent. */
TEST(eulers_limit_for_a_duration) {
  DEF(dynamics, def, .integrator = MPS_DYNAMICS_INTEGRATOR_EULER);
  const double durations[2] = {0.4, 2.0};
  for (int k = 0; k < 2; k++) {
    double dt;
    const double grown = growth(&def, 5, 0.0, false, durations[k], 1.0, &dt, 0);
    print_message("Euler over %g s: limit %.4g s, grows %.2g times\n", durations[k], dt, grown);
    assert_true(dt > 0.0 && dt < durations[k]);
    assert_true(grown > 1e12 && grown < 1e15);
    assert_true(growth(&def, 5, 0.0, false, durations[k], 0.5, &dt, 0) < 1e9);
  }
}

/* ---- Yoshida's column ------------------------------------------------------------------------ */

/* The paper's column with the limits of the reference values. */
TEST(the_papers_column) {
  const struct {
    char wave;
    double h, linear; /* ms */
  } cases[] = {{'S', 0.0, 4.1047},  {'S', 0.001, 4.084}, {'S', 0.048, 3.209}, {'S', 0.22, 1.546},
               {'P', 0.001, 8.184}, {'P', 0.048, 7.242}, {'P', 0.22, 4.750}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    scoped_particles *set = NULL;
    const bool P = cases[k].wave == 'P';
    scoped_dynamics *d = paper_column(context, 0.5, P ? 50.0 : 100.0, P ? 100.0 : 200.0, cases[k].h,
                                      cases[k].wave, NULL, &set);
    const double quick = mps_dynamics_limit(d), exact = linear(d, 0.0).dt;
    NEAR(1e3 * exact / cases[k].linear, 1.0, 1e-3);
    assert_true(quick < exact && quick > 0.75 * exact); /* at once, before the search */
    NEAR(mps_dynamics_limit(d), exact, 0.0);
  }
  scoped_particles *set = NULL;
  mps_dynamics_def def = mps_dynamics_defaults();
  scoped_dynamics *d = paper_column(context, 0.5, 100.0, 200.0, 0.0, 'S', &def, &set);
  OK(mps_experimental_dynamics_printed_torque(d));
  NEAR(linear(d, 0.0).dt, 2.9048e-3, 1e-7);
  OK(mps_dynamics_step(d, 1));
  FAILS(mps_experimental_dynamics_printed_torque(d), MPS_ERROR_STATE, "steps");
}
