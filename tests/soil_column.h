/* soil_column.h - the column of soil that the dynamics tests share.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_SOIL_COLUMN_H
#define MPS_TEST_SOIL_COLUMN_H

#include "test_common.h"

typedef struct soil_layer {
  double thickness, density, vs, vp, damping; /* m, kg/m3, m/s, m/s, - */
} soil_layer;

/* Ground that will do, to any depth. */
static const soil_layer soil_plain = {1e9, 1500.0, 100.0, 200.0, 0.05};

static inline mps_dynamics *soil_solver(mps_context *context, mps_particles *particles) {
  DEF(dynamics, def, .dt = 1e-3);
  MAKE_KEPT(dynamics, dynamics, create, context, particles, &def);
  return dynamics;
}

/* A set of width x height (m) filled with layers from the top down; the lowest goes to the end. */
static inline mps_particles *soil_particles(mps_context *context, double spacing, double width,
                                            double height, int layers, const soil_layer *layer) {
  mps_particles *particles = box_of(context, spacing, AT(0.0, 0.0), AT(width, height));
  const char *const names[4] = {"density", "shear_velocity", "pressure_velocity", "damping"};
  mps_edit field[4];
  for (int f = 0; f < 4; f++) {
    OK(mps_particles_set(particles, names[f], 0, 0.0));
    OK(mps_particles_edit(particles, names[f], &field[f]));
  }
  mps_view x = view_field(particles, "position");
  for (int64_t k = 0; k < x.shape[0]; k++) {
    double depth = height - *mps_view_f64(&x, k, 1);
    int m = 0;
    while (m < layers - 1 && depth > layer[m].thickness) depth -= layer[m++].thickness;
    *mps_edit_f64(&field[0], k, 0) = layer[m].density;
    *mps_edit_f64(&field[1], k, 0) = layer[m].vs;
    *mps_edit_f64(&field[2], k, 0) = layer[m].vp;
    *mps_edit_f64(&field[3], k, 0) = layer[m].damping;
  }
  for (int f = 0; f < 4; f++) OK(mps_particles_commit(particles, &field[f]));
  return particles;
}

/* Boundaries of listed particles, in short: held, driven in one component, viscous (`def` NULL or
 * one whose list is filled in). */
static inline mps_status soil_add_held(mps_dynamics *dynamics, uint32_t dofs, int64_t count,
                                       const int64_t *ids) {
  DEF(dynamics_boundary, def, .dofs = dofs, .ids = ids, .id_count = count);
  int32_t number;
  return mps_dynamics_add_boundary(dynamics, &def, &number);
}

static inline mps_status soil_add_driven(mps_dynamics *dynamics, int component, mps_signal *signal,
                                         double factor, int64_t count, const int64_t *ids) {
  DEF(dynamics_boundary, def, .kind = MPS_BOUNDARY_DRIVEN);
  int32_t number;
  if (component < 2) def.dofs = 1u << component;
  def.signal[component] = signal;
  def.factor[component] = factor;
  def.ids = ids;
  def.id_count = count;
  return mps_dynamics_add_boundary(dynamics, &def, &number);
}

static inline mps_status soil_add_viscous(mps_dynamics *dynamics,
                                          const mps_dynamics_boundary_def *user_def, int64_t count,
                                          const int64_t *ids) {
  mps_dynamics_boundary_def def = user_def ? *user_def : mps_dynamics_boundary_defaults();
  int32_t number;
  def.kind = MPS_BOUNDARY_ABSORBING;
  def.ids = ids;
  def.id_count = count;
  return mps_dynamics_add_boundary(dynamics, &def, &number);
}

/* Ids of the particles in a box; the caller frees. */
static inline int64_t *soil_select(mps_particles *particles, double x0, double y0, double x1,
                                   double y1, int64_t *count) {
  const double lo[2] = {x0, y0}, hi[2] = {x1, y1};
  const int64_t n = mps_particles_count(particles);
  int64_t *ids = malloc((size_t)n * sizeof *ids);
  if (!ids) abort();
  OK(mps_particles_select_box(particles, lo, hi, n, count, ids));
  return ids;
}

/* Holds degrees of freedom of the particles in a box. */
static inline void soil_hold(mps_particles *particles, mps_dynamics *dynamics, uint32_t dofs,
                             double x0, double y0, double x1, double y1) {
  int64_t count;
  int64_t *ids = soil_select(particles, x0, y0, x1, y1, &count);
  OK(soil_add_held(dynamics, dofs, count, ids));
  free(ids);
}

/* The paper's column, 10 m x 100 m, density 1500 kg/m3, rollers on sides and base, Ricker base
 * motion: wave 'S' or 'P'. `damping` for every particle. */
static inline mps_dynamics *paper_column(mps_context *context, double radius, double vs, double vp,
                                         double damping, char wave, const mps_dynamics_def *def,
                                         mps_particles **particles) {
  const double D = 2.0 * radius;
  const double width = round(10.0 / D) * D, height = round(100.0 / D) * D;
  const soil_layer soil = {height, 14.7 / 9.8 * 1000.0, vs, vp, damping};
  *particles = soil_particles(context, D, width, height, 1, &soil);
  MAKE_KEPT(dynamics, dynamics, create, context, *particles, def);
  const uint32_t held = wave == 'S' ? MPS_DOF_Y : MPS_DOF_X;
  soil_hold(*particles, dynamics, held, -1.0, -1.0, D, height);
  soil_hold(*particles, dynamics, held, width - D, -1.0, width, height);
  soil_hold(*particles, dynamics, held, -1.0, -1.0, width, D);
  int64_t count;
  int64_t *base = soil_select(*particles, -1.0, -1.0, width, D, &count);
  MAKE(signal, ricker, create_ricker, context, 4.0, 0.25, 1.0);
  OK(soil_add_driven(dynamics, wave == 'S' ? 0 : 1, ricker, 1.0, count, base));
  free(base);
  return dynamics;
}

/* Present value of a field of the particle `id`. */
static inline double soil_value(mps_particles *particles, const char *field, int64_t id,
                                int component) {
  mps_view view = view_field(particles, field);
  return *mps_view_f64(&view, mps_particles_index(particles, id), component);
}

#endif
