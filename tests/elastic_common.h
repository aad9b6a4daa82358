/* elastic_common.h - bodies for the tests of implicit elasticity: a set of particles with uniform
 * material, the paper's cantilever with its exact solution (11), selections.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_ELASTIC_COMMON_H
#define MPS_ELASTIC_COMMON_H

#include "test_common.h"

#include <mps/elastic.h>

typedef struct test_body {
  mps_context *context;
  mps_particles *particles;
  mps_elastic *elastic;
  int32_t dim;
  int64_t n;
} test_body;

/* An empty set; the caller fills it. */
static inline test_body test_body_begin(mps_context *context, int32_t dim, double spacing) {
  test_body b = {.context = context, .dim = dim};
  mps_particles_def def = mps_particles_defaults();
  def.dim = dim;
  def.spacing = spacing;
  mps_assert_ok(context, mps_particles_create(context, &def, &b.particles));
  return b;
}

/* `box` is lo, hi; lattice sites are at (i + 1/2) spacing. */
static inline void test_body_box(test_body *b, double x0, double y0, double z0, double x1,
                                 double y1, double z1) {
  const double lo[3] = {x0, y0, z0}, hi[3] = {x1, y1, z1};
  mps_assert_ok(b->context, mps_particles_fill_box(b->particles, lo, hi, NULL));
}

static inline void test_body_finish(test_body *b, double young, double poisson,
                                    const mps_elastic_def *def) {
  b->n = mps_particles_count(b->particles);
  mps_assert_ok(b->context, mps_particles_set(b->particles, "young", 0, young));
  mps_assert_ok(b->context, mps_particles_set(b->particles, "poisson", 0, poisson));
  mps_assert_ok(b->context, mps_elastic_create(b->context, b->particles, def, &b->elastic));
}

static inline void test_body_end(test_body *b) {
  mps_elastic_destroy(&b->elastic);
  mps_particles_destroy(&b->particles);
}

/* Ids with lo <= x[axis] <= hi; free() it. */
static inline int64_t *test_select(const test_body *b, int32_t axis, double lo, double hi,
                                   int64_t *count) {
  double low[3] = {-INFINITY, -INFINITY, -INFINITY}, high[3] = {INFINITY, INFINITY, INFINITY};
  low[axis] = lo;
  high[axis] = hi;
  int64_t *ids = malloc((size_t)b->n * sizeof *ids);
  mps_assert_ok(b->context, mps_particles_select_box(b->particles, low, high, b->n, ids, count));
  return ids;
}

/* Facets with outward normal side * axis; free() it. */
static inline int64_t *test_facets(const test_body *b, int32_t axis, int32_t side, int64_t *count) {
  const int64_t all = mps_elastic_facet_count(b->elastic);
  int64_t *facets = malloc((size_t)all * sizeof *facets);
  mps_assert_ok(b->context,
                mps_elastic_select_facets(b->elastic, axis, side, NULL, NULL, all, facets, count));
  return facets;
}

static inline double test_value(const test_body *b, const char *field, int64_t i, int32_t c) {
  mps_view view;
  mps_assert_ok(b->context, mps_particles_view(b->particles, field, &view));
  return *mps_view_f64(&view, i, c);
}

/* ---- the paper's cantilever --------------------------------------------------------------------
 */

/* E = 1, P = 1, h = 2; load end x = 0, wall x = length, axis y = 0. */
typedef struct cantilever {
  double nu, height, length;
  double young, poisson; /* of the plane state: E / (1 - nu^2), nu / (1 - nu) in plane strain */
} cantilever;

/* Seed (11), and the u that belongs to it: u = v = du/dy = 0 at (l, 0). */
static inline double cantilever_v(const cantilever *c, double x, double y) {
  const double h = c->height, l = c->length;
  return -2.0 / (c->young * h * h * h) *
         (x * x * x - 3 * l * l * x + 2 * l * l * l + 6 * (1 + c->poisson) * h * h / 4 * (l - x) +
          3 * c->poisson * x * y * y);
}
static inline double cantilever_u(const cantilever *c, double x, double y) {
  const double inertia = c->height * c->height * c->height / 12, l = c->length;
  return (x * x * y / 2 + c->poisson * y * y * y / 6 - (1 + c->poisson) * y * y * y / 3 -
          l * l * y / 2) /
         (c->young * inertia);
}

static inline mps_status cantilever_traction(void *user, const double *x, const double *normal,
                                             double *traction) {
  const cantilever *c = user;
  const double h = c->height;
  (void)normal;
  traction[0] = 0.0;
  traction[1] = -6.0 / (h * h * h) * (h * h / 4 - x[1] * x[1]);
  return MPS_OK;
}

/* nx x ny particles; `boundary`: they lie on the free and loaded surfaces too. */
static inline test_body cantilever_make(mps_context *context, cantilever *c, int nx, int ny,
                                        const mps_elastic_def *def) {
  const double spacing = c->height / ny;
  c->length = (nx - 0.5) * spacing;
  const int strain = def->state == MPS_ELASTIC_PLANE_STRAIN;
  c->young = strain ? 1.0 / (1.0 - c->nu * c->nu) : 1.0;
  c->poisson = strain ? c->nu / (1.0 - c->nu) : c->nu;
  test_body b = {.context = context, .dim = 2};
  mps_particles_def set = mps_particles_defaults();
  set.spacing = spacing;
  set.origin[1] = -0.5 * c->height;
  mps_assert_ok(context, mps_particles_create(context, &set, &b.particles));
  test_body_box(&b, 0.0, -0.5 * c->height, 0.0, nx * spacing, 0.5 * c->height, 0.0);
  assert_int_equal(mps_particles_count(b.particles), nx * ny);
  test_body_finish(&b, 1.0, c->nu, def);
  return b;
}

/* The wall carries (11)'s displacements; the load end its shear stress. Relative tip error. */
static inline double cantilever_solve(test_body *b, cantilever *c, const mps_elastic_def *def) {
  int64_t count, facet_count;
  const double spacing = mps_particles_spacing(b->particles);
  int64_t *wall = test_select(b, 0, c->length - 0.1 * spacing, INFINITY, &count);
  int64_t *facets = test_facets(b, 0, -1, &facet_count);
  double *values = malloc((size_t)count * sizeof *values);
  for (int component = 0; component < 2; component++) {
    for (int64_t k = 0; k < count; k++) {
      const double x = test_value(b, "position", wall[k], 0);
      const double y = test_value(b, "position", wall[k], 1);
      values[k] = component ? cantilever_v(c, x, y) : cantilever_u(c, x, y);
    }
    mps_assert_ok(b->context, mps_elastic_prescribe(b->elastic, component, count, wall, values));
  }
  /* The published method has whole cells everywhere. */
  if (def->method == MPS_ELASTIC_CONSERVATIVE)
    mps_assert_ok(b->context, mps_elastic_cut(b->elastic, 0, 1, count, wall));
  mps_assert_ok(b->context, mps_elastic_add_traction_fn(b->elastic, facet_count, facets,
                                                        cantilever_traction, c));
  mps_assert_ok(b->context, mps_elastic_solve(b->elastic));
  free(wall);
  free(facets);
  free(values);
  const double tip[2] = {0.5 * spacing, 0.0};
  const int64_t i = mps_particles_nearest(b->particles, tip);
  const double exact = cantilever_v(c, test_value(b, "position", i, 0), 0.0);
  return test_value(b, "displacement", i, 1) / exact - 1.0;
}

#endif
