/* mpm_scene.h - what the tests of the WLS-MPM solver share: elastic particles, and looks at them.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_MPM_SCENE_H
#define MPS_TEST_MPM_SCENE_H

#include "test_common.h"

typedef struct mpm_scene {
  mps_context *context;
  mps_particles *particles;
  mps_material *material;
  mps_mpm *mpm;
} mpm_scene;

#define scoped_mpm_scene SCOPED(mpm_scene_end) mpm_scene

/* An empty set of spacing `spacing` from the origin (x, y, 0), and elastic material. */
static inline mpm_scene mpm_scene_begin_in(mps_context *context, int32_t dim, double spacing,
                                           double x, double y, double young) {
  mpm_scene s = {.context = context};
  DEF(particles, def, .dim = dim, .spacing = spacing, .origin[0] = x, .origin[1] = y);
  OK(mps_particles_create(context, &def, &s.particles));
  OK(mps_material_create_linear_elastic(context, young, 0.3, &s.material));
  return s;
}

static inline mpm_scene mpm_scene_begin(mps_context *context, double spacing, double x, double y,
                                        double young) {
  return mpm_scene_begin_in(context, 2, spacing, x, y, young);
}

static inline void mpm_scene_box(mpm_scene *s, double x0, double y0, double x1, double y1) {
  const double lo[] = {x0, y0}, hi[] = {x1, y1};
  OK(mps_particles_fill_box(s->particles, lo, hi, NULL));
}

static inline void mpm_scene_ball(mpm_scene *s, double x, double y, double radius) {
  const double centre[] = {x, y};
  OK(mps_particles_fill_ball(s->particles, centre, radius, NULL));
}

/* The solver, of density 1000. */
static inline mps_status mpm_scene_solve(mpm_scene *s, const mps_mpm_def *def) {
  OK(mps_particles_set(s->particles, "density", 0, 1000.0));
  OK(mps_mpm_create(s->context, s->particles, s->material, def, &s->mpm));
  return MPS_OK;
}

/* Contact with a body, with friction, default stiffness. */
static inline mps_status mpm_scene_try_contact(mps_mpm *mpm, mps_body *body, double friction) {
  DEF(contact, def, .friction = friction);
  return mps_mpm_add_contact(mpm, body, &def, NULL);
}

static inline void mpm_scene_contact(mpm_scene *s, mps_body *body, double friction) {
  OK(mpm_scene_try_contact(s->mpm, body, friction));
}

/* A side of the domain gets `kind`, at rest. */
static inline void mpm_scene_side(mpm_scene *s, int32_t side, int32_t kind, double friction) {
  OK(mps_mpm_set_side(s->mpm, side, kind, friction));
}

/* The same, a signal driving one component. */
static inline void mpm_scene_drive(mpm_scene *s, int32_t side, int32_t kind, double friction,
                                   int32_t component, mps_signal *signal, double factor) {
  DEF(mpm_boundary, def, .kind = kind == MPS_BOUNDARY_HELD ? MPS_BOUNDARY_DRIVEN : kind,
      .friction = friction, .signal[component] = signal, .factor[component] = factor);
  OK(mps_mpm_set_boundary(s->mpm, side, &def));
}

/* One component of the nodes in a box. */
static inline mps_mpm_boundary_def mpm_scene_box_def(mps_mpm *mpm, const double *lower,
                                                     const double *upper, int32_t component,
                                                     mps_signal *signal, double factor) {
  mps_mpm_boundary_def def = mps_mpm_boundary_defaults();
  const int dim = mps_particles_dim(mps_mpm_particles(mpm));
  for (int c = 0; c < dim; c++) def.lower[c] = lower[c], def.upper[c] = upper[c];
  def.kind = MPS_BOUNDARY_DRIVEN;
  def.dofs = 1u << component;
  def.signal[component] = signal;
  def.factor[component] = factor;
  return def;
}

static inline mps_mpm_load_def mpm_scene_load_def(int64_t count, const int64_t *ids,
                                                  const double *area, const double *traction,
                                                  int dim, mps_signal *signal) {
  DEF(mpm_load, def, .id_count = count, .ids = ids, .area = area);
  for (int c = 0; c < dim; c++) def.traction[c] = traction[c], def.signal[c] = signal;
  return def;
}

/* Force of a boundary in the last step. */
static inline void mpm_scene_force(mpm_scene *s, int32_t boundary, double *force) {
  mps_reaction r;
  OK(mps_mpm_get_reaction(s->mpm, boundary, &r));
  for (int c = 0; c < 3; c++) force[c] = r.force[c];
}

static inline void mpm_scene_end(mpm_scene *s) {
  mps_mpm_destroy(&s->mpm);
  mps_particles_destroy(&s->particles);
  mps_material_destroy(&s->material);
}

static inline mps_view mpm_scene_view(mpm_scene *s, const char *name) {
  return view_field(s->particles, name);
}

/* The largest difference of stresses over the largest stress of `a`, in the plane. */
static inline double mpm_scene_stress_difference(mpm_scene *a, mpm_scene *b) {
  mps_view s[2] = {mpm_scene_view(a, "stress"), mpm_scene_view(b, "stress")};
  double apart = 0.0, largest = 0.0;
  for (int64_t k = 0; k < s[0].shape[0]; k++)
    for (int c = 0; c < 4; c++) {
      apart = fmax(apart, fabs(*mps_view_f64(&s[0], k, c) - *mps_view_f64(&s[1], k, c)));
      largest = fmax(largest, fabs(*mps_view_f64(&s[0], k, c)));
    }
  return apart / largest;
}

static inline mps_edit mpm_scene_edit(mpm_scene *s, const char *name) {
  mps_edit edit;
  OK(mps_particles_edit(s->particles, name, &edit));
  return edit;
}

static inline void mpm_scene_commit(mpm_scene *s, mps_edit *edit) {
  OK(mps_particles_commit(s->particles, edit));
}

/* Gives the particles the stress of their weight (`unit`, N/m3) below the surface y = `height` (m),
 * with K0 of it sideways. */
static inline void mpm_scene_weigh(mpm_scene *s, double unit, double K0, double height) {
  OK(mps_particles_add_field(s->particles, "stress", 0));
  const mps_view x = mpm_scene_view(s, "position");
  EDIT(stress, s->particles, "stress")
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const double yy = -unit * (height - *mps_view_f64(&x, k, 1));
      *mps_edit_f64(&stress, k, 0) = *mps_edit_f64(&stress, k, 2) = K0 * yy;
      *mps_edit_f64(&stress, k, 1) = yy;
    }
}

/* Largest relative error of the vertical stress against that weight, away from the surface, which
 * has half-filled cells, and from the base. */
static inline double mpm_scene_weight_error(mpm_scene *s, double unit, double height) {
  const mps_view x = mpm_scene_view(s, "position"), stress = mpm_scene_view(s, "stress");
  double worst = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double depth = height - *mps_view_f64(&x, k, 1);
    if (depth < 0.15 * height || depth > 0.85 * height) continue;
    worst = fmax(worst, fabs(*mps_view_f64(&stress, k, 1) / (-unit * depth) - 1.0));
  }
  return worst;
}

/* Gives all particles the velocity v0 + L x with its gradient. `L` by rows of dim values. */
static inline void mpm_scene_affine(mpm_scene *s, const double *v0, const double *L) {
  OK(mps_particles_add_field(s->particles, "velocity", 0));
  OK(mps_particles_add_field(s->particles, "velocity_gradient", 0));
  mps_view x = mpm_scene_view(s, "position");
  mps_edit v = mpm_scene_edit(s, "velocity");
  mps_edit g = mpm_scene_edit(s, "velocity_gradient");
  const int dim = mps_particles_dim(s->particles);
  for (int64_t k = 0; k < x.shape[0]; k++)
    for (int c = 0; c < dim; c++) {
      double value = v0[c];
      for (int d = 0; d < dim; d++) {
        value += L[dim * c + d] * *mps_view_f64(&x, k, d);
        *mps_edit_f64(&g, k, dim * c + d) = L[dim * c + d];
      }
      *mps_edit_f64(&v, k, c) = value;
    }
  mpm_scene_commit(s, &v);
  mpm_scene_commit(s, &g);
}

static inline mps_totals mpm_scene_totals(mpm_scene *s) {
  mps_totals totals;
  OK(mps_mpm_get_totals(s->mpm, &totals));
  return totals;
}

#endif
