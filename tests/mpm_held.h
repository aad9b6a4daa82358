/* mpm_held.h - a scene of the WLS-MPM solver with every kind of wall, a moving wall, moving nodes,
 * gravity, body accelerations and loads.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_MPM_HELD_H
#define MPS_TEST_MPM_HELD_H

#include "mpm_scene.h"

/* Ids of the particles in a box. */
static inline int64_t held_select(mpm_scene *s, const double *lo, const double *hi, int64_t *ids,
                                  int64_t capacity) {
  int64_t count = 0;
  OK(mps_particles_select_box(s->particles, lo, hi, capacity, &count, ids));
  assert_true(count > 0 && count <= capacity);
  return count;
}

/* Two loads: by the spacing with a signal, by areas without. */
static inline void held_load(mpm_scene *s, mps_signal *signal, int32_t *loads) {
  enum { MOST = 2000 };
  static int64_t ids[MOST];
  static double area[MOST];
  const double lo[] = {0.2, 0.1, 0.0}, hi[] = {0.3, 0.15, 0.1};
  const double pull[] = {300.0, -200.0, 50.0}, push[] = {-40.0, 30.0, -20.0};
  const int dim = mps_particles_dim(s->particles);
  const double own = dim == 3 ? 1e-4 : 1e-2;
  int64_t count = held_select(s, lo, hi, ids, MOST);
  mps_mpm_load_def load = mpm_scene_load_def(count, ids, NULL, pull, dim, signal);
  OK(mps_mpm_add_load(s->mpm, &load, &loads[0]));
  const double all[] = {INFINITY, 0.05, INFINITY}, none[] = {-INFINITY, 0.04, -INFINITY};
  count = held_select(s, none, all, ids, MOST);
  for (int64_t k = 0; k < count; k++) area[k] = own * (1.0 + 0.01 * (double)(ids[k] % 7));
  load = mpm_scene_load_def(count, ids, area, push, dim, NULL);
  OK(mps_mpm_add_load(s->mpm, &load, &loads[1]));
}

/* A domain full of particles that move, with the geometry and choices of `from`: x frictional and
 * absorbing; y fixed and sliding, and a roller; z frictional and absorbing. `box` receives the
 * moving nodes' number. */
static inline mpm_scene held_begin_with(mps_context *context, const mps_mpm_def *from, int32_t *box,
                                        int32_t *loads) {
  const int32_t geometry = from->geometry;
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  const double lo[] = {0.1, 0.0, 0.0}, hi[] = {dim == 3 ? 0.42 : 0.9, dim == 3 ? 0.16 : 0.4, 0.08};
  const double v0[] = {0.02, -0.03, 0.01};
  const double plane[] = {0.05, -0.3, 0.2, -0.05};
  const double space[] = {0.05, -0.3, 0.1, 0.2, -0.05, 0.1, -0.1, 0.04, 0.03};
  mpm_scene s = mpm_scene_begin_in(context, dim, 0.01, 0.0, 0.0, 1e5);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  mpm_scene_affine(&s, v0, dim == 3 ? space : plane);
  OK(mps_particles_add_field(s.particles, "body_acceleration", 0));
  mps_view x = mpm_scene_view(&s, "position");
  EDIT(a, s.particles, "body_acceleration")
    for (int64_t k = 0; k < x.shape[0]; k++)
      for (int c = 0; c < dim; c++) *mps_edit_f64(&a, k, c) = 5.0 * *mps_view_f64(&x, k, 1 - c % 2);
  mps_mpm_def def = *from;
  def.cell = 0.02;
  for (int c = 0; c < dim; c++) {
    def.lower[c] = lo[c], def.upper[c] = hi[c];
  }
  def.gravity[0] = 1.0, def.gravity[1] = -9.81;
  mpm_scene_solve(&s, &def);
  MAKE(signal, signal, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 20.0, 0.0005, 0.3);
  for (int c = 0; c < dim; c += 2) {
    mpm_scene_side(&s, 2 * c, MPS_BOUNDARY_FRICTIONAL, 0.3);
    mpm_scene_side(&s, 2 * c + 1, MPS_BOUNDARY_ABSORBING, 0.0);
  }
  mpm_scene_drive(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0, 0, signal, 1.0);
  mpm_scene_drive(&s, MPS_SIDE_X_UPPER, MPS_BOUNDARY_ABSORBING, 0.0, 0, signal, -0.1);
  const double low[] = {0.3, 0.1, 0.02}, high[] = {0.36, 0.16, 0.05};
  const mps_mpm_boundary_def nodes = mpm_scene_box_def(s.mpm, low, high, 1, signal, 2.0);
  OK(mps_mpm_add_boundary(s.mpm, &nodes, box));
  MAKE(signal, factor, create_sine, context, MPS_SIGNAL_QUANTITY_VALUE, 20.0, 0.0005, 0.3);
  held_load(&s, factor, loads);
  return s;
}

static inline mpm_scene held_begin(mps_context *context, int32_t geometry, int32_t *box,
                                   int32_t *loads) {
  DEF(mpm, def, .geometry = geometry);
  return held_begin_with(context, &def, box, loads);
}

#endif
