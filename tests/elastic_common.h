/* elastic_common.h - bodies for the tests of implicit elasticity: a set of particles with uniform
 * material, the paper's cantilever with its exact solution (11), selections.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_ELASTIC_COMMON_H
#define MPS_ELASTIC_COMMON_H

#include "test_common.h"

/* ---- boundaries and loads in one line -------------------------------------------------------- */

static inline int test_dim(const mps_elastic *e) {
  return mps_particles_dim(mps_elastic_particles(e));
}

/* Component `component` of `count` particles is values[i], or 0. */
static inline mps_status test_prescribe(mps_elastic *e, int component, int64_t count,
                                        const int64_t *ids, const double *values) {
  double *all = values ? calloc((size_t)(3 * (count > 0 ? count : 1)), sizeof *all) : NULL;
  for (int64_t k = 0; values && k < count; k++) all[3 * k + component] = values[k];
  DEF(elastic_boundary, def, .ids = ids, .id_count = count, .dofs = 1u << component,
      .kind = values ? MPS_BOUNDARY_DRIVEN : MPS_BOUNDARY_HELD, .values = all);
  const mps_status status = mps_elastic_add_boundary(e, &def, NULL);
  free(all);
  return status;
}

static inline mps_status test_roller(mps_elastic *e, const double *normal, int64_t count,
                                     const int64_t *ids, const double *values) {
  DEF(elastic_boundary, def, .kind = MPS_BOUNDARY_ROLLER);
  for (int c = 0; c < test_dim(e); c++) def.normal[c] = normal[c];
  def.ids = ids;
  def.id_count = count;
  def.values = values;
  return mps_elastic_add_boundary(e, &def, NULL);
}

static inline mps_status test_clear_boundaries(mps_elastic *e) {
  for (int32_t k = 0; k < 256; k++)
    if (mps_elastic_remove_boundary(e, k) != MPS_OK) continue;
  return MPS_OK;
}

/* Of a kind, on particles or facets `ids`; `values` one vector (dim values), or one a particle. */
static inline mps_status test_load(mps_elastic *e, int32_t kind, int64_t count, const int64_t *ids,
                                   const double *values, bool each) {
  DEF(elastic_load, def, .kind = kind, .ids = ids);
  const int dim = test_dim(e);
  double *all = calloc((size_t)(3 * (count > 0 ? count : 1)), sizeof *all);
  def.id_count = count;
  def.all = !ids && count == 0;
  for (int c = 0; !each && c < dim; c++) def.force[c] = values[c];
  for (int64_t k = 0; each && k < count * dim; k++) all[k / dim * 3 + k % dim] = values[k];
  if (each) def.values = all;
  const mps_status status = mps_elastic_add_load(e, &def, NULL);
  free(all);
  return status;
}

static inline mps_status test_body_force(mps_elastic *e, const double *force) {
  return test_load(e, MPS_ELASTIC_LOAD_VOLUME, 0, NULL, force, false);
}
static inline mps_status test_forces(mps_elastic *e, int64_t count, const int64_t *ids,
                                     const double *forces) {
  return test_load(e, MPS_ELASTIC_LOAD_FORCE, count, ids, forces, true);
}
static inline mps_status test_traction(mps_elastic *e, int64_t count, const int64_t *facets,
                                       const double *traction) {
  return test_load(e, MPS_ELASTIC_LOAD_TRACTION, count, facets, traction, false);
}
static inline mps_status test_pressure(mps_elastic *e, int64_t count, const int64_t *facets,
                                       const double *pressures) {
  DEF(elastic_load, def, .kind = MPS_ELASTIC_LOAD_PRESSURE, .ids = facets, .id_count = count,
      .values = pressures);
  return mps_elastic_add_load(e, &def, NULL);
}
static inline mps_status test_traction_fn(mps_elastic *e, int64_t count, const int64_t *facets,
                                          mps_elastic_traction_fn function, void *user) {
  DEF(elastic_load, def, .kind = MPS_ELASTIC_LOAD_FUNCTION, .ids = facets, .id_count = count,
      .function = function, .user = user);
  return mps_elastic_add_load(e, &def, NULL);
}

/* Resultant of the field `reaction` (3 values each), about a point (3) or the origin. */
static inline mps_status test_reactions(mps_elastic *e, const double *about, double *force,
                                        double *moment) {
  mps_particles *set = mps_elastic_particles(e);
  mps_view f, x;
  mps_status status = mps_particles_view(set, "reaction", &f);
  if (status == MPS_OK) status = mps_particles_view(set, "position", &x);
  double sum[3] = {0, 0, 0}, turn[3] = {0, 0, 0};
  for (int64_t i = 0; status == MPS_OK && i < mps_particles_count(set); i++) {
    double r[3] = {0, 0, 0}, p[3] = {0, 0, 0};
    for (int c = 0; c < test_dim(e); c++) {
      p[c] = *mps_view_f64(&f, i, c);
      r[c] = *mps_view_f64(&x, i, c) - (about ? about[c] : 0.0);
      sum[c] += p[c];
    }
    for (int c = 0; c < 3; c++)
      turn[c] += r[(c + 1) % 3] * p[(c + 2) % 3] - r[(c + 2) % 3] * p[(c + 1) % 3];
  }
  if (force) memcpy(force, sum, sizeof sum);
  if (moment) memcpy(moment, turn, sizeof turn);
  return status;
}

/* The conservative discretisation, or the published one (divided by the constant n0). */
typedef enum test_method { TEST_CONSERVATIVE, TEST_PUBLISHED, TEST_CONSTANT } test_method;
static inline mps_status test_create(mps_context *context, mps_particles *particles,
                                     const mps_elastic_def *def, test_method method,
                                     mps_elastic **out) {
  if (method == TEST_CONSERVATIVE) return mps_elastic_create(context, particles, def, out);
  return mps_experimental_elastic_published(context, particles, def, method == TEST_CONSTANT, out);
}

typedef struct test_body {
  mps_context *context;
  mps_particles *particles;
  mps_elastic *elastic;
  int32_t dim;
  int64_t n;
} test_body;

#define scoped_test_body SCOPED(test_body_end) test_body

/* An empty set; the caller fills it. */
static inline test_body test_body_begin(mps_context *context, int32_t dim, double spacing) {
  test_body b = {.context = context, .dim = dim};
  DEF(particles, def, .dim = dim, .spacing = spacing);
  OK(mps_particles_create(context, &def, &b.particles));
  return b;
}

/* `box` is lo, hi; lattice sites are at (i + 1/2) spacing. */
static inline void test_body_box(test_body *b, double x0, double y0, double z0, double x1,
                                 double y1, double z1) {
  OK(mps_particles_fill_box(b->particles, AT(x0, y0, z0), AT(x1, y1, z1), NULL));
}

static inline void test_body_finish_by(test_body *b, double young, double poisson,
                                       const mps_elastic_def *def, test_method method) {
  b->n = mps_particles_count(b->particles);
  SET_FIELDS(b->particles, {"young", young}, {"poisson", poisson});
  OK(test_create(b->context, b->particles, def, method, &b->elastic));
}
static inline void test_body_finish(test_body *b, double young, double poisson,
                                    const mps_elastic_def *def) {
  test_body_finish_by(b, young, poisson, def, TEST_CONSERVATIVE);
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
  OK(mps_particles_select_box(b->particles, low, high, b->n, count, ids));
  return ids;
}

/* Facets with outward normal side * axis; free() it. */
static inline int64_t *test_facets(const test_body *b, int32_t axis, int32_t side, int64_t *count) {
  const int64_t all = mps_elastic_facet_count(b->elastic);
  int64_t *facets = malloc((size_t)all * sizeof *facets);
  OK(mps_elastic_select_facets(b->elastic, mps_side_of(axis, side > 0), NULL, NULL, all, count,
                               facets));
  return facets;
}

static inline double test_value(const test_body *b, const char *field, int64_t i, int32_t c) {
  mps_view view = view_field(b->particles, field);
  return *mps_view_f64(&view, i, c);
}

/* A field of two bodies, relative to its largest value in the first. */
static inline void test_compare(const test_body *a, const test_body *b, const char *field,
                                double tolerance) {
  double largest = 0.0, away = 0.0;
  for (int64_t i = 0; i < a->n; i++)
    for (int c = 0; c < a->dim; c++) {
      largest = fmax(largest, fabs(test_value(a, field, i, c)));
      away = fmax(away, fabs(test_value(a, field, i, c) - test_value(b, field, i, c)));
    }
  assert_true(largest > 0.0);
  NEAR(away / largest, 0.0, tolerance);
}

/* Held below; elsewhere, where stiff() says so, ten times as stiff; a particle slides along a plane
 * at an angle; a body force. */
static inline void test_inclined(test_body *b, bool (*stiff)(double x, double y), double slide,
                                 bool cut) {
  EDIT(young, b->particles, "young")
    for (int64_t i = 0; i < b->n; i++)
      if (stiff(test_value(b, "position", i, 0), test_value(b, "position", i, 1)))
        *mps_edit_f64(&young, i, 0) = 10.0;
  int64_t count, top = b->n - 1, *ids = test_select(b, 1, -1, 0.2, &count);
  for (int c = 0; c < b->dim; c++) OK(test_prescribe(b->elastic, c, count, ids, NULL));
  if (cut) OK(mps_elastic_cut(b->elastic, MPS_SIDE_Y_LOWER, ids, count));
  free(ids);
  const double slope[3] = {0.8, 0.6, 0.0}, force[3] = {0.1, -0.3, 0.05};
  OK(test_roller(b->elastic, slope, 1, &top, &slide));
  OK(test_body_force(b->elastic, force));
}

/* ---- the paper's cantilever ------------------------------------------------------------------ */

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
                                        const mps_elastic_def *def, test_method method) {
  const double spacing = c->height / ny;
  c->length = (nx - 0.5) * spacing;
  const int strain = def->state == MPS_ELASTIC_STATE_PLANE_STRAIN;
  c->young = strain ? 1.0 / (1.0 - c->nu * c->nu) : 1.0;
  c->poisson = strain ? c->nu / (1.0 - c->nu) : c->nu;
  test_body b = {.context = context, .dim = 2};
  DEF(particles, set, .spacing = spacing, .origin[1] = -0.5 * c->height);
  OK(mps_particles_create(context, &set, &b.particles));
  test_body_box(&b, 0.0, -0.5 * c->height, 0.0, nx * spacing, 0.5 * c->height, 0.0);
  assert_int_equal(mps_particles_count(b.particles), nx * ny);
  test_body_finish_by(&b, 1.0, c->nu, def, method);
  return b;
}

/* The wall carries (11)'s displacements; the load end its shear stress. Relative tip error. */
static inline double cantilever_solve(test_body *b, cantilever *c, test_method method) {
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
    OK(test_prescribe(b->elastic, component, count, wall, values));
  }
  /* The published method has whole cells everywhere. */
  if (method == TEST_CONSERVATIVE) OK(mps_elastic_cut(b->elastic, MPS_SIDE_X_UPPER, wall, count));
  OK(test_traction_fn(b->elastic, facet_count, facets, cantilever_traction, c));
  OK(mps_elastic_solve(b->elastic));
  free(wall);
  free(facets);
  free(values);
  const double tip[2] = {0.5 * spacing, 0.0};
  const int64_t i = mps_particles_nearest(b->particles, tip);
  const double exact = cantilever_v(c, test_value(b, "position", i, 0), 0.0);
  return test_value(b, "displacement", i, 1) / exact - 1.0;
}

#endif
