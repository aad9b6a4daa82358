/* test_dynamics_transfer.c - surface response of layered ground against one-dimensional theory,
 * with rigid and viscous base: amplitude and frequency of the first three peaks.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "soil_column.h"

#include <complex.h>

#define FREQUENCIES 1170
#define EVERY 4 /* steps a sample */

static const soil_layer layers[3] = {{10.0, 1700.0, 120.0, 240.0, 0.05},
                                     {15.0, 1800.0, 200.0, 400.0, 0.04},
                                     {15.0, 2000.0, 350.0, 700.0, 0.02}};
static const double rock_density = 2200.0, rock_vs = 700.0;
static const double f1 = 1.0, f2 = 8.0, height = 40.0;
static const double f_first = 0.3, f_step = 11.7 / FREQUENCIES; /* Hz */

/* Displacement and shear stress carried from the free surface down, layer by layer. Rayleigh
 * damping makes density and modulus complex: rho (1 - i alpha/w), mu (1 + i w beta). Relative to
 * the outcrop motion of the half space below (`rock`), or to the motion `y0` above the bottom. */
static double complex transfer(double f, bool rock, double y0) {
  const double w = 2.0 * PI * f;
  double complex u = 1.0, stress = 0.0; /* stress mu du/dz, z down */
  for (int m = 0; m < 3; m++) {
    const double h = layers[m].damping;
    const double alpha = 4.0 * PI * f1 * f2 * h / (f1 + f2), beta = h / (PI * (f1 + f2));
    const double complex rho = layers[m].density * (1.0 - I * alpha / w);
    const double complex mu =
        layers[m].density * layers[m].vs * layers[m].vs * (1.0 + I * w * beta);
    const double complex k = w * csqrt(rho / mu);
    const double thickness = layers[m].thickness - (m == 2 ? y0 : 0.0);
    const double complex c = ccos(k * thickness), s = csin(k * thickness);
    const double complex below = u * c + stress / (k * mu) * s;
    stress = stress * c - u * k * mu * s;
    u = below;
  }
  if (!rock) return 1.0 / u;
  /* in the rock u = A exp(ikz) + B exp(-ikz), A going up, and stress = i w Z (A - B): 2 A is */
  return 1.0 / (u + stress / (I * w * rock_density * rock_vs));
}

typedef struct traces {
  mps_context *context;
  mps_particles *particles;
  int64_t top, base, count;
  double *surface, *bottom;
} traces;

static mps_status record(void *user, mps_dynamics *dynamics) {
  traces *t = user;
  (void)dynamics;
  t->surface[t->count] = soil_value(t->particles, "acceleration", t->top, 0);
  t->bottom[t->count++] = soil_value(t->particles, "acceleration", t->base, 0);
  return MPS_OK;
}

static double complex fourier(const double *a, int64_t n, double dt, double f) {
  const double complex turn = cexp(-2.0 * PI * I * f * dt);
  double complex sum = 0.0, phase = 1.0;
  for (int64_t k = 0; k < n; k++, phase *= turn) sum += a[k] * phase;
  return sum * dt;
}

typedef struct peaks {
  double f[3], amplitude[3];
} peaks;

static peaks find_peaks(const double *amplitude) {
  peaks p = {{0}, {0}};
  int found = 0;
  for (int k = 1; k < FREQUENCIES - 1 && found < 3; k++)
    if (amplitude[k] > amplitude[k - 1] && amplitude[k] >= amplitude[k + 1]) {
      p.f[found] = f_first + k * f_step;
      p.amplitude[found++] = amplitude[k];
    }
  assert_int_equal(found, 3);
  return p;
}

/* The half space is to begin at the face of the lowest row, in whose middle the dashpots are: the
 * factors of docs/dynamics.md for the two lowest rows, both of the lowest layer. */
static void open_base(mps_particles *particles, double spacing) {
  const soil_layer l = layers[2];
  const double s2 = l.vs * l.vs, p2 = l.vp * l.vp;
  const double row[2][3] = {{2.0 / 3.0 * l.density, 0.7589 * l.vs, sqrt(2.0 * p2 - 1.506 * s2)},
                            {4.0 / 3.0 * l.density, 0.866 * l.vs, sqrt(0.6 * p2 + 0.3 * s2)}};
  const char *const names[3] = {"density", "shear_velocity", "pressure_velocity"};
  const mps_view x = view_field(particles, "position");
  for (int f = 0; f < 3; f++) {
    mps_edit field;
    OK(mps_particles_edit(particles, names[f], &field));
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const int m = (int)(*mps_view_f64(&x, k, 1) / spacing);
      if (m < 2) *mps_edit_f64(&field, k, 0) = row[m][f];
    }
    OK(mps_particles_commit(particles, &field));
  }
}

/* The layered column with periodic sides, its base condition set. */
static mps_dynamics *build(mps_context *context, bool viscous, double spacing, mps_signal *input,
                           mps_particles **particles) {
  DEF(dynamics, def, .f1 = f1, .f2 = f2);
  def.courant = 0.5; /* damping is one-sided in time: its error is of the order of dt */
  def.period_x = 4.0 * spacing;
  *particles = soil_particles(context, spacing, 4.0 * spacing, height, 3, layers);
  if (viscous) open_base(*particles, spacing);
  MAKE_KEPT(dynamics, dynamics, create, context, *particles, &def);
  int64_t count;
  int64_t *base = soil_select(*particles, -1.0, -1.0, 100.0, spacing, &count);
  if (viscous) {
    DEF(dynamics_boundary, boundary, .density = rock_density, .shear_velocity = rock_vs,
        .pressure_velocity = 2.0 * rock_vs, .signal[0] = input);
    OK(soil_add_viscous(dynamics, &boundary, count, base));
  } else {
    OK(soil_add_held(dynamics, MPS_DOF_Y, count, base));
    OK(soil_add_driven(dynamics, 0, input, 1.0, count, base));
  }
  free(base);
  return dynamics;
}

static void compare(bool viscous, double spacing, double duration) {
  scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  scoped_particles *particles = NULL;
  MAKE(signal, input, create_ricker, context, 4.0, 0.5, 1.0);
  scoped_dynamics *dynamics = build(context, viscous, spacing, input, &particles);
  const double dt = EVERY * mps_dynamics_dt(dynamics); /* of the samples */
  const int64_t steps = (int64_t)(duration / dt) + 4;
  const double top[2] = {2.0 * spacing, height}, foot[2] = {2.0 * spacing, 0.0};
  traces t = {.context = context, .particles = particles};
  t.top = mps_particles_nearest(particles, top);
  t.base = mps_particles_nearest(particles, foot);
  t.surface = malloc((size_t)steps * sizeof(double));
  t.bottom = malloc((size_t)steps * sizeof(double));
  assert_true(t.surface && t.bottom);
  OK(mps_dynamics_run(dynamics, duration, EVERY, record, &t));
  if (viscous) /* relative to the outcrop, twice the incoming wave */
    for (int64_t k = 0; k < t.count; k++)
      t.bottom[k] = 2.0 * mps_signal_acceleration(input, (double)k * dt);

  double measured[FREQUENCIES], theory[FREQUENCIES];
  for (int k = 0; k < FREQUENCIES; k++) {
    const double f = f_first + k * f_step;
    measured[k] = cabs(fourier(t.surface, t.count, dt, f) / fourier(t.bottom, t.count, dt, f));
    theory[k] = cabs(transfer(f, viscous, viscous ? 0.0 : 0.5 * spacing));
  }
  const peaks m = find_peaks(measured), e = find_peaks(theory);
  for (int k = 0; k < 3; k++) {
    print_message("%s base, D = %g m, peak %d: theory %.3f Hz x %.3f, measured %.3f Hz x %.3f "
                  "(%+.2f %%, %+.2f %%)\n",
                  viscous ? "viscous" : "rigid", spacing, k + 1, e.f[k], e.amplitude[k], m.f[k],
                  m.amplitude[k], 100.0 * (m.f[k] / e.f[k] - 1.0),
                  100.0 * (m.amplitude[k] / e.amplitude[k] - 1.0));
    NEAR(m.amplitude[k] / e.amplitude[k], 1.0, viscous ? 0.015 * spacing * spacing : 0.03);
    NEAR(m.f[k] / e.f[k], 1.0, viscous ? 0.003 : 0.02);
  }
  free(t.surface);
  free(t.bottom);
}

TEST(rigid_base) { compare(false, 0.5, 40.0); }

TEST(viscous_base) {
  compare(true, 1.0, 12.0);
  compare(true, 0.5, 12.0);
}
