/* plate.c - a quarter of a plate with a hole, pulled along x, by implicit particle elasticity
 * (Chikazawa): the stress beside the hole, across the pull, against Kirsch's solution (1898), which
 * is applied at the two far edges too, so that the plate may be small.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/elastic.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Planes of symmetry pass through particles: half a cell less of the radius and of the side. */
enum { HOLE = 30, CELLS = 120 };
static const double radius = 1.0, tension = 1e6; /* m, Pa; 1 m thick, plane stress */
static const double spacing = 1.0 / (HOLE + 0.5), side = (CELLS + 0.5) / (HOLE + 0.5);

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

/* Stress xx, yy, xy at a point, Pa. */
static void kirsch(const double *x, double *s) {
  const double q = radius * radius / (x[0] * x[0] + x[1] * x[1]), t = atan2(x[1], x[0]);
  s[0] = 1 - q * (1.5 * cos(2 * t) + cos(4 * t)) + 1.5 * q * q * cos(4 * t);
  s[1] = -q * (0.5 * cos(2 * t) - cos(4 * t)) - 1.5 * q * q * cos(4 * t);
  s[2] = -q * (0.5 * sin(2 * t) + sin(4 * t)) + 1.5 * q * q * sin(4 * t);
  for (int c = 0; c < 3; c++) s[c] *= tension;
}

static mps_status traction(void *user, const double *x, const double *normal, double *out) {
  double s[3];
  (void)user;
  kirsch(x, s);
  out[0] = s[0] * normal[0] + s[2] * normal[1];
  out[1] = s[2] * normal[0] + s[1] * normal[1];
  return MPS_OK;
}

static mps_status outside(void *user, const double *x, int32_t *inside) {
  (void)user;
  *inside = hypot(x[0], x[1]) > radius;
  return MPS_OK;
}

/* The plane of symmetry x = 0 (axis 0) or y = 0 passes through its particles; the far edge is
 * pulled. */
static void support_and_load(mps_particles *plate, mps_elastic *elastic, int axis) {
  double upper[2] = {INFINITY, INFINITY};
  const double lower[2] = {-INFINITY, -INFINITY};
  int64_t ids[CELLS + 1], facets[CELLS + 1], count;
  mps_elastic_boundary_def plane = mps_elastic_boundary_defaults();
  mps_elastic_load_def pull = mps_elastic_load_defaults();
  upper[axis] = 1e-6;
  ok(mps_particles_select_box(plate, lower, upper, CELLS + 1, &count, ids));
  plane.dofs = axis == 0 ? MPS_DOF_X : MPS_DOF_Y;
  plane.ids = ids, plane.id_count = count;
  ok(mps_elastic_cut(elastic, axis == 0 ? MPS_SIDE_X_LOWER : MPS_SIDE_Y_LOWER, ids, count));
  ok(mps_elastic_add_boundary(elastic, &plane, NULL));
  double far[2] = {-INFINITY, -INFINITY};
  far[axis] = side - 1e-6;
  pull.kind = MPS_ELASTIC_LOAD_FUNCTION, pull.function = traction;
  ok(mps_elastic_select_facets(elastic, axis == 0 ? MPS_SIDE_X_UPPER : MPS_SIDE_Y_UPPER, far, NULL,
                               CELLS + 1, &count, facets));
  pull.ids = facets, pull.id_count = count;
  ok(mps_elastic_add_load(elastic, &pull, NULL));
}

int main(void) {
  mps_context *context = NULL;
  mps_particles *plate = NULL;
  mps_material *steel = NULL;
  mps_elastic *elastic = NULL;
  ok(mps_context_create(NULL, &context, NULL, 0));

  const double lo[2] = {-0.5 * spacing, -0.5 * spacing}, hi[2] = {side, side};
  mps_particles_def set = mps_particles_defaults();
  set.spacing = spacing, set.origin[0] = lo[0], set.origin[1] = lo[1];
  ok(mps_particles_create(context, &set, &plate));
  ok(mps_particles_fill_where(plate, lo, hi, outside, NULL, NULL));
  ok(mps_material_create_linear_elastic(context, 210e9, 0.3, &steel));
  ok(mps_particles_set_material(plate, steel, 7850.0, NULL, 0));
  ok(mps_elastic_create(context, plate, NULL, &elastic));
  for (int axis = 0; axis < 2; axis++) support_and_load(plate, elastic, axis);
  ok(mps_elastic_solve(elastic));
  ok(mps_elastic_update_stress(elastic));

  /* across the pull, at x = 0; cells make stairs of the hole's edge, so not there */
  int wrong = 0;
  mps_view stress, x;
  ok(mps_particles_view(plate, "stress", &stress));
  ok(mps_particles_view(plate, "position", &x));
  for (int k = 0; k < 4; k++) {
    const double near[2] = {0.0, radius * (1.2 + 0.4 * k)};
    const int64_t i = mps_particles_index(plate, mps_particles_nearest(plate, near));
    const double at[2] = {*mps_view_f64(&x, i, 0), *mps_view_f64(&x, i, 1)};
    double exact[3];
    char what[40];
    kirsch(at, exact);
    snprintf(what, sizeof what, "stress over tension at y = %.3f m", at[1]);
    wrong += compare(what, *mps_view_f64(&stress, i, 0) / tension, exact[0] / tension,
                     0.03 * exact[0] / tension);
  }

  mps_elastic_destroy(&elastic);
  mps_material_destroy(&steel);
  mps_particles_destroy(&plate);
  mps_context_destroy(&context);
  return wrong > 0;
}
