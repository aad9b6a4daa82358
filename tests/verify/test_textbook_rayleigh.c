/* test_textbook_rayleigh.c - the surface wave of an elastic half space: its velocity over that of
 * shear waves, and the horizontal over the vertical motion of the surface, by explicit MPS and by
 * WLS-MPM, against the root of Rayleigh's equation. The run does not start from that wave but from
 * a vertical velocity alone, which fades exponentially with depth: the rest of it leaves through an
 * absorbing base, and what stays at the surface is measured.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"

#include "test_fixture.h"
#include "textbook_table.h"

#define WAVE 10.0 /* m, wavelength */
#define VS 100.0
#define DENSITY 1800.0
#define DEPTH (4.0 * WAVE)
#define SPEED 1e-3 /* m/s, of the start */
#define PERIODS 30 /* of a run, the last ten of which are measured */
#define MEASURED 10
enum { PER_PERIOD = 40, SAMPLES = PERIODS * PER_PERIOD };

/* Rayleigh's equation (2 - x)^2 = 4 sqrt(1 - x) sqrt(1 - a x) of x = (c/Vs)^2, a = (Vs/Vp)^2. */
static double exact_velocity(double a) {
  double low = 0.5, high = 1.0;
  for (int k = 0; k < 60; k++) {
    const double x = 0.5 * (low + high);
    const double f = (2.0 - x) * (2.0 - x) - 4.0 * sqrt((1.0 - x) * (1.0 - a * x));
    *(f < 0.0 ? &low : &high) = x;
  }
  return sqrt(low);
}

static double exact_shape(double a) {
  const double x = pow(exact_velocity(a), 2.0);
  return (2.0 - x) / (2.0 * sqrt(1.0 - a * x));
}

/* Amplitudes of sin and cos of the wavelength in the motion of the surface. */
typedef struct record {
  double t[SAMPLES + 1], along[SAMPLES + 1], across[SAMPLES + 1];
} record;

/* From the two uppermost rows, extrapolated by half a spacing. `spacing` between them. */
static void observe(mps_particles *set, double spacing, double t, record *r, int k) {
  mps_view x = view_field(set, "position");
  mps_view v = view_field(set, "velocity");
  double sum[2] = {0.0, 0.0}, count = 0.0;
  for (int64_t i = 0; i < x.shape[0]; i++) {
    const double row = (DEPTH - *mps_view_f64(&x, i, 1)) / spacing;
    if (row > 2.0) continue;
    const double weight = row < 1.0 ? 1.5 : -0.5, phase = 2.0 * PI / WAVE * *mps_view_f64(&x, i, 0);
    sum[0] += weight * *mps_view_f64(&v, i, 0) * sin(phase);
    sum[1] += weight * *mps_view_f64(&v, i, 1) * cos(phase);
    count += 0.5;
  }
  r->t[k] = t;
  r->along[k] = 2.0 * sum[0] / count;
  r->across[k] = 2.0 * sum[1] / count;
}

/* Over the last ten periods: velocity from the zeros of the vertical motion, H/V from the root mean
 * squares. */
static void measure(const record *r, double *velocity, double *shape) {
  double first = NAN, last = NAN, h = 0.0, v = 0.0;
  int zeros = 0;
  for (int k = SAMPLES - MEASURED * PER_PERIOD; k < SAMPLES; k++) {
    const double a = r->across[k], b = r->across[k + 1];
    h += r->along[k] * r->along[k], v += a * a;
    if (a * b > 0.0) continue;
    last = r->t[k] + (r->t[k + 1] - r->t[k]) * a / (a - b);
    if (zeros++ == 0) first = last;
  }
  assert_true(zeros > 2 * MEASURED - 4);
  *velocity = WAVE / (2.0 * (last - first) / (zeros - 1)) / VS;
  *shape = sqrt(h / v);
}

static void start(mps_particles *set) {
  OK(mps_particles_set(set, "velocity", 0, 0.0));
  mps_view x = view_field(set, "position");
  EDIT(v, set, "velocity")
    for (int64_t i = 0; i < x.shape[0]; i++)
      *mps_edit_f64(&v, i, 1) = SPEED * cos(2.0 * PI / WAVE * *mps_view_f64(&x, i, 0)) *
                                exp(-2.0 * PI / WAVE * (DEPTH - *mps_view_f64(&x, i, 1)));
}

static void state(const char *name, int count, const record *r, double a, double began,
                  double *velocity, double *shape) {
  measure(r, velocity, shape);
  FILE *f = textbook_table(name, "t_s,along_m_s,across_m_s");
  for (int k = 0; k <= SAMPLES; k++)
    textbook_row(f, 3, (double[]){r->t[k], r->along[k], r->across[k]});
  textbook_close(f);
  print_message(
      "%s, %d particles a wavelength: c/Vs %.5f (%+.2f %%), H/V %.4f (%+.2f %%), %.1f s\n", name,
      count, *velocity, 100.0 * (*velocity / exact_velocity(a) - 1.0), *shape,
      100.0 * (*shape / exact_shape(a) - 1.0), textbook_cost() - began);
}

static double sample_time(int k) { return WAVE / VS / 0.92 * k / PER_PERIOD; }

/* One wavelength, periodic. */
static void by_particles(int count, double vp, double *velocity, double *shape) {
  static record r;
  const double spacing = WAVE / count, began = textbook_cost();
  scoped_particles *particles =
      box_of(context, spacing, (double[]){0.0, 0.0}, (double[]){WAVE, DEPTH});
  SET_FIELDS(particles, {"density", DENSITY}, {"shear_velocity", VS}, {"pressure_velocity", vp});
  start(particles);
  DEF(dynamics, def, .period_x = WAVE);
  MAKE(dynamics, dynamics, create, context, particles, &def);
  DEF(dynamics_boundary, base, .kind = MPS_BOUNDARY_ABSORBING);
  int32_t number;
  base.lower[0] = base.lower[1] = -INFINITY;
  base.upper[0] = INFINITY, base.upper[1] = spacing;
  OK(mps_dynamics_add_boundary(dynamics, &base, &number));
  for (int k = 0; k <= SAMPLES; k++) {
    if (k > 0) OK(mps_dynamics_run(dynamics, sample_time(k), INT64_MAX, NULL, NULL));
    observe(particles, spacing, sample_time(k), &r, k);
  }
  state("rayleigh_particles", count, &r, pow(VS / vp, 2.0), began, velocity, shape);
}

/* Half a wavelength between rollers, two particles a cell along each axis. */
static void by_grid(int count, double *velocity, double *shape) {
  static record r;
  const double spacing = WAVE / count, began = textbook_cost();
  scoped_mpm_scene s = mpm_scene_begin(context, spacing, 0.0, 0.0, 1e6);
  mps_material_destroy(&s.material);
  OK(mps_material_create_linear_elastic(context, 2.5 * DENSITY * VS * VS, 0.25, &s.material));
  mpm_scene_box(&s, 0.0, 0.0, 0.5 * WAVE, DEPTH);
  OK(mps_particles_set(s.particles, "density", 0, DENSITY));
  start(s.particles);
  DEF(mpm, def, .cell = 2.0 * spacing, .lower[0] = def.lower[1] = 0.0, .upper[0] = 0.5 * WAVE);
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_ABSORBING, 0.0);
  for (int k = 0; k <= SAMPLES; k++) {
    OK(mps_mpm_run(s.mpm, sample_time(k), INT64_MAX, NULL, NULL));
    observe(s.particles, spacing, sample_time(k), &r, k);
  }
  state("rayleigh_grid", count, &r, 1.0 / 3.0, began, velocity, shape);
}

TEST(explicit_mps_has_it) {
  double velocity, shape;
  NEAR(exact_velocity(1.0 / 3.0), 0.9194, 5e-5);
  NEAR(exact_shape(1.0 / 3.0), 0.681, 5e-4);
  for (int count = 10; count <= 40; count *= 2)
    by_particles(count, sqrt(3.0) * VS, &velocity, &shape);
  NEAR(velocity, exact_velocity(1.0 / 3.0), 0.01 * 0.9194);
  NEAR(shape, exact_shape(1.0 / 3.0), 0.02 * 0.681);
}

TEST(wls_mpm_has_it) {
  double velocity, shape;
  for (int count = 20; count <= 80; count *= 2) by_grid(count, &velocity, &shape);
  NEAR(velocity, exact_velocity(1.0 / 3.0), 0.01 * 0.9194);
  NEAR(shape, exact_shape(1.0 / 3.0), 0.02 * 0.681);
}
