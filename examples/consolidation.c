/* consolidation.c - a layer of saturated soil, 1 m thick, gives off its water under a load of 1 kPa
 * (WLS-MPM with pore water): settlement and pore pressure at the impervious base against
 * Terzaghi's solution, at three times T = c_v t/H^2.
 * SPDX-License-Identifier: BSD-3-Clause */
#define MPS_EXPERIMENTAL 1
#include <mps/experimental/pore_water.h>
#include <mps/mpm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double cell = 0.1, load = 1000.0;     /* m, Pa; H = 1 m */
static const double young = 1e6, poisson = 0.3;    /* Pa, 1: of the skeleton */
static const double porosity = 0.4, drains = 0.25; /* 1, m2/s: c_v */

/* Stops where a call fails, with the library's message. */
static void ok(mps_status status) {
  if (status == MPS_OK) return;
  fprintf(stderr, "%s\n", mps_last_error()->message);
  exit(1);
}

/* One line of the results; 1 where `got` is farther from the right value than `bound`. */
static int compare(const char *what, double got, double right, double bound) {
  printf("%-44s %11.5g   right: %11.5g +- %.2g\n", what, got, right, bound);
  return !(fabs(got - right) <= bound);
}

/* Degree of consolidation, and pore pressure at the base over the load. */
static void terzaghi(double T, double *degree, double *base) {
  *degree = 1.0, *base = 0.0;
  for (int k = 0; k < 100; k++) {
    const double m = (k + 0.5) * acos(-1.0), decay = exp(-m * m * T);
    *degree -= 2.0 / (m * m) * decay;
    *base += 2.0 / m * sin(m) * decay;
  }
}

int main(void) {
  mps_context *context = NULL;
  mps_particles *ground = NULL;
  mps_material *law = NULL;
  mps_mpm *mpm = NULL;
  mps_moduli m;
  ok(mps_context_create(NULL, &context, NULL, 0));

  /* a strip one cell wide, between smooth sides, with the density of grains and water */
  const double lo[2] = {0.0, 0.0}, hi[2] = {cell, 1.0};
  mps_particles_def set = mps_particles_defaults();
  mps_mpm_def def = mps_mpm_defaults();
  set.spacing = 0.5 * cell, def.cell = cell;
  def.lower[0] = def.lower[1] = 0.0, def.upper[0] = cell;
  def.viscous_damping = 10.0; /* 1/s: the layer would swing for long */
  ok(mps_particles_create(context, &set, &ground));
  ok(mps_particles_fill_box(ground, lo, hi, NULL));
  ok(mps_particles_set(ground, "density", 0, 2000.0));
  ok(mps_material_create_linear_elastic(context, young, poisson, &law));
  ok(mps_mpm_create(context, ground, law, &def, &mpm));

  /* the load as a pressure of -1 kPa at the drained surface: effective stresses are the same, and
   * pore pressures less by 1 kPa */
  mps_pore_water_def water = mps_pore_water_defaults();
  mps_pore_face_def surface = mps_pore_face_defaults();
  ok(mps_moduli_from_elastic(context, young, poisson, 2000.0, &m));
  water.porosity = porosity;
  water.permeability = drains * 1000.0 * MPS_PORE_GRAVITY / m.wave; /* m/s */
  surface.kind = MPS_PORE_FACE_DRAINED, surface.pressure = -load;
  surface.sides = 1u << MPS_SIDE_Y_UPPER;
  ok(mps_mpm_add_pore_water(mpm, &water));
  ok(mps_mpm_add_pore_face(mpm, &surface, NULL));

  const double times[3] = {0.05, 0.2, 0.5}, foot[2] = {0.0, 0.0};
  mps_totals start, now;
  mps_view pressure;
  int wrong = 0;
  ok(mps_mpm_get_totals(mpm, &start));
  for (int k = 0; k < 3; k++) {
    double degree, base;
    terzaghi(times[k], &degree, &base);
    ok(mps_mpm_run(mpm, times[k] / drains, 1, NULL, NULL));
    ok(mps_mpm_get_totals(mpm, &now));
    ok(mps_particles_view(ground, "pore_pressure", &pressure));
    const int64_t i = mps_particles_index(ground, mps_particles_nearest(ground, foot));
    printf("T = %.2f\n", times[k]);
    wrong += compare("  settlement over that of the end",
                     (1.0 - now.volume / start.volume) * m.wave / load, degree, 0.02);
    wrong += compare("  pore pressure at the base over the load",
                     1.0 + *mps_view_f64(&pressure, i, 0) / load, base, 0.02);
  }

  mps_mpm_destroy(&mpm);
  mps_material_destroy(&law);
  mps_particles_destroy(&ground);
  mps_context_destroy(&context);
  return wrong > 0;
}
