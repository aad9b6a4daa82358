/* cantilever.c - a cantilever under a load at its end, by implicit particle elasticity (Chikazawa,
 * section 3): one system of equations, no steps in time. Deflection and stress are compared with
 * Timoshenko's beam, the section forces with statics.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/elastic.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double length = 4.5, height = 1.0;              /* m; 1 m thick, plane stress */
#define CELLS 9                                              /* in the height */
static const double young = 30e9, poisson = 0.2, load = 1e5; /* Pa, 1, N */

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

int main(void) {
  mps_context *context = NULL;
  mps_particles *beam = NULL;
  mps_material *concrete = NULL;
  mps_elastic *elastic = NULL;
  ok(mps_context_create(NULL, &context, NULL, 0));

  /* particles are the centres of cells: half a cell more, as the wall passes through the first */
  const double spacing = height / CELLS, lo[2] = {-0.5 * spacing, -0.5 * height},
               hi[2] = {length, 0.5 * height};
  mps_particles_def set = mps_particles_defaults();
  set.spacing = spacing, set.origin[0] = lo[0], set.origin[1] = lo[1];
  ok(mps_particles_create(context, &set, &beam));
  ok(mps_particles_fill_box(beam, lo, hi, NULL));
  ok(mps_material_create_linear_elastic(context, young, poisson, &concrete));
  ok(mps_particles_set_material(beam, concrete, 2400.0, NULL, 0));

  mps_elastic_def def = mps_elastic_defaults();
  def.bending = 1.0; /* few cells in the height: each bends by itself */
  ok(mps_elastic_create(context, beam, &def, &elastic));

  const double end[2] = {0.1 * spacing, INFINITY};
  int64_t ids[CELLS], count;
  mps_elastic_boundary_def wall = mps_elastic_boundary_defaults();
  ok(mps_particles_select_box(beam, lo, end, CELLS, &count, ids));
  wall.ids = ids, wall.id_count = count; /* held, in both directions */
  ok(mps_elastic_cut(elastic, MPS_SIDE_X_LOWER, ids, count));
  ok(mps_elastic_add_boundary(elastic, &wall, NULL));

  mps_elastic_load_def shear = mps_elastic_load_defaults();
  int64_t facets[CELLS];
  ok(mps_elastic_select_facets(elastic, MPS_SIDE_X_UPPER, NULL, NULL, CELLS, &count, facets));
  shear.kind = MPS_ELASTIC_LOAD_TRACTION;
  shear.ids = facets, shear.id_count = count, shear.force[1] = -load / height; /* Pa */
  ok(mps_elastic_add_load(elastic, &shear, NULL));
  ok(mps_elastic_solve(elastic));
  ok(mps_elastic_update_stress(elastic));

  const double tip[2] = {length, 0.0}, fibre[2] = {0.5 * length, 0.5 * height};
  const double middle[3] = {0.5 * length, 0.0, 0.0};
  double force[3], moment[3];
  mps_view u, x, stress;
  ok(mps_particles_view(beam, "displacement", &u));
  ok(mps_particles_view(beam, "position", &x));
  ok(mps_particles_view(beam, "stress", &stress));
  ok(mps_elastic_get_section(elastic, 0, 0.5 * length, middle, force, moment));
  const int64_t i = mps_particles_index(beam, mps_particles_nearest(beam, tip));
  const int64_t j = mps_particles_index(beam, mps_particles_nearest(beam, fibre));

  /* Timoshenko: P a^2 (3 L - a)/(6 E I) and, by shear, 6/5 P a/(G A), at the place a */
  const double inertia = pow(height, 3.0) / 12.0, g = 0.5 * young / (1.0 + poisson);
  const double a = *mps_view_f64(&x, i, 0);
  const double sag =
      -load * (a * a * (3.0 * length - a) / (6.0 * young * inertia) + 1.2 * a / (g * height));
  const double bending =
      load * (length - *mps_view_f64(&x, j, 0)) * *mps_view_f64(&x, j, 1) / inertia;
  int wrong =
      compare("deflection at the end, mm", 1e3 * *mps_view_f64(&u, i, 1), 1e3 * sag, -5e0 * sag);
  wrong += compare("stress in the middle's upper fibre, MPa", 1e-6 * *mps_view_f64(&stress, j, 0),
                   1e-6 * bending, 1e-8 * bending);
  wrong += compare("shear force in the middle, kN", 1e-3 * force[1], -1e-3 * load, 1e-6);
  wrong += compare("bending moment in the middle, kN m", 1e-3 * moment[2], -0.5e-3 * load * length,
                   1e-6);

  mps_elastic_destroy(&elastic);
  mps_material_destroy(&concrete);
  mps_particles_destroy(&beam);
  mps_context_destroy(&context);
  return wrong > 0;
}
