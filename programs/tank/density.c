/* density.c - --density-at: density of the water over the height on a vertical line at the end of
 * the run, from the number of particles about each point, weighted by a kernel. That of the lattice
 * of the spacing is the water's own; the bed is a mirror. The surface is where it falls to half.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/plot.h"
#include "tank.h"

#include <mps/kernel.h>

#include <math.h>

#define REACH 4.0                       /* spacings: radius of influence, as far as walls must be */
enum { PER_SPACING = 4, RINGS = 1000 }; /* points of the line; of the integral of the weight */

double tank_density_reach(const tank_settings *s) { return REACH * s->spacing; }

/* Integral of the weight over the plane, over the area of a particle. */
static double rest_number(const mps_kernel *kernel, double spacing) {
  const double dr = mps_kernel_radius(kernel) / RINGS;
  double sum = 0.0;
  for (int k = 0; k < RINGS; k++) {
    const double r = (k + 0.5) * dr;
    sum += 2.0 * WAVES_PI * r * dr * mps_kernel_weight(kernel, r);
  }
  return sum / (spacing * spacing);
}

static double number_at(const mps_kernel *kernel, const mps_view *x, double at, double height) {
  double sum = 0.0;
  for (int64_t k = 0; k < x->shape[0]; k++) {
    const double dx = *mps_view_f64(x, k, 0) - at, y = *mps_view_f64(x, k, 1);
    sum += mps_kernel_weight(kernel, hypot(dx, y - height)) +
           mps_kernel_weight(kernel, hypot(dx, y + height));
  }
  return sum;
}

static bool write(app *a, const tank_model *m, const mps_kernel *kernel, const mps_view *x) {
  const tank_settings *s = &m->s;
  const double rest = rest_number(kernel, s->spacing);
  const int64_t points = (int64_t)ceil(PER_SPACING * (1.3 * s->depth / s->spacing));
  output f;
  if (!output_open(&f, a, s->out, "density.csv")) return false;
  csv_header(&f, "height_m,density_kg_m3");
  for (int64_t k = 0; k < points; k++) {
    const double height = ((double)k + 0.5) * s->spacing / PER_SPACING;
    const double row[] = {height,
                          WAVES_DENSITY * number_at(kernel, x, s->density_at, height) / rest};
    csv_row(&f, 2, row);
  }
  return output_close(&f);
}

static bool draw(app *a, const tank_model *m) {
  const tank_settings *s = &m->s;
  return plot_draw(
      a, s->out, "density", "tank/density",
      "first = 'Density of the water at x = %g m, t = %.4g s'\nsecond = 'particles within "
      "%g m about each point'\nrho = %.9g; depth = %.9g",
      s->density_at, mps_fluid_time(m->fluid), tank_density_reach(s), WAVES_DENSITY, s->depth);
}

bool tank_write_density(app *a, const tank_model *m) {
  mps_kernel *kernel = NULL;
  mps_view x;
  if (isnan(m->s.density_at)) return true;
  bool good = app_check(a, mps_kernel_create(a->context, MPS_KERNEL_SMOOTH,
                                             tank_density_reach(&m->s), &kernel)) &&
              app_check(a, mps_particles_view(m->water, "position", &x));
  good = good && write(a, m, kernel, &x) && draw(a, m);
  mps_kernel_destroy(&kernel);
  return good;
}
