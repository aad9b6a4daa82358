/* mpm_scene.h - what the tests of the WLS-MPM solver share: elastic particles, and looks at them.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_MPM_SCENE_H
#define MPS_TEST_MPM_SCENE_H

#include "test_common.h"

#include <mps/mpm.h>

typedef struct mpm_scene {
  mps_context *context;
  mps_particles *particles;
  mps_material *material;
  mps_mpm *mpm;
} mpm_scene;

/* An empty set of spacing `spacing` from the origin (x, y, 0), and elastic material. */
static inline mpm_scene mpm_scene_begin_in(mps_context *context, int32_t dim, double spacing,
                                           double x, double y, double young) {
  mpm_scene s = {.context = context};
  mps_particles_def def = mps_particles_defaults();
  def.dim = dim;
  def.spacing = spacing;
  def.origin[0] = x, def.origin[1] = y;
  mps_assert_ok(context, mps_particles_create(context, &def, &s.particles));
  mps_assert_ok(context, mps_material_linear_elastic(context, young, 0.3, &s.material));
  return s;
}

static inline mpm_scene mpm_scene_begin(mps_context *context, double spacing, double x, double y,
                                        double young) {
  return mpm_scene_begin_in(context, 2, spacing, x, y, young);
}

static inline void mpm_scene_box(mpm_scene *s, double x0, double y0, double x1, double y1) {
  const double lo[] = {x0, y0}, hi[] = {x1, y1};
  mps_assert_ok(s->context, mps_particles_fill_box(s->particles, lo, hi, NULL));
}

static inline void mpm_scene_ball(mpm_scene *s, double x, double y, double radius) {
  const double centre[] = {x, y};
  mps_assert_ok(s->context, mps_particles_fill_ball(s->particles, centre, radius, NULL));
}

/* The solver, of density 1000. */
static inline void mpm_scene_solve(mpm_scene *s, const mps_mpm_def *def) {
  mps_assert_ok(s->context, mps_particles_set(s->particles, "density", 0, 1000.0));
  mps_assert_ok(s->context, mps_mpm_create(s->context, s->particles, s->material, def, &s->mpm));
}

static inline void mpm_scene_end(mpm_scene *s) {
  mps_mpm_destroy(&s->mpm);
  mps_particles_destroy(&s->particles);
  mps_material_destroy(&s->material);
}

static inline mps_view mpm_scene_view(mpm_scene *s, const char *name) {
  mps_view view;
  mps_assert_ok(s->context, mps_particles_view(s->particles, name, &view));
  return view;
}

/* Gives all particles the velocity v0 + L x with its gradient. `L` by rows of dim values. */
static inline void mpm_scene_affine(mpm_scene *s, const double *v0, const double *L) {
  mps_assert_ok(s->context, mps_particles_add_field(s->particles, "velocity", 0));
  mps_assert_ok(s->context, mps_particles_add_field(s->particles, "velocity_gradient", 0));
  mps_view x = mpm_scene_view(s, "position"), v = mpm_scene_view(s, "velocity");
  mps_view g = mpm_scene_view(s, "velocity_gradient");
  const int dim = mps_particles_dim(s->particles);
  for (int64_t k = 0; k < x.shape[0]; k++)
    for (int c = 0; c < dim; c++) {
      double value = v0[c];
      for (int d = 0; d < dim; d++) {
        value += L[dim * c + d] * *mps_view_f64(&x, k, d);
        *mps_view_f64(&g, k, dim * c + d) = L[dim * c + d];
      }
      *mps_view_f64(&v, k, c) = value;
    }
}

static inline mps_mpm_totals mpm_scene_totals(mpm_scene *s) {
  mps_mpm_totals totals;
  mps_assert_ok(s->context, mps_mpm_get_totals(s->mpm, &totals));
  return totals;
}

#endif
