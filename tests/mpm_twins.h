/* mpm_twins.h - runs of the WLS-MPM solver with bodies, and whether two of them are the same bit
 * for bit: for the tests of snapshots and checkpoints. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_MPM_TWINS_H
#define MPS_TEST_MPM_TWINS_H

#include "kit/same.h"
#include "body/body_internal.h"
#include "mpm_held.h"
#include "pthread_executor.h"

/* ---- scenes: contact with a driven and a free body, plastic soil, many blocks, sorting ------- */

enum { FREE = 0, DRIVEN = 1, BODIES = 2 };

typedef struct scene {
  mpm_scene s;
  mps_body *body[BODIES];
} scene;

/* What a scene may differ in from the one that was saved. */
typedef struct change {
  double spacing, cell, origin, wall;
  int64_t particles;
  bool elastic, half_plane;
  int bodies;
  int32_t budget;
} change;
static const change none = {.spacing = 0.01, .cell = 0.02, .bodies = BODIES};

static inline mps_status make_material(mps_context *context, const change *c, mps_material **out) {
  DEF(material_drucker_prager, law, .young = 1e6, .poisson = 0.3, .friction = 0.5,
      .cohesion = 200.0);
  if (c->elastic) return mps_material_create_linear_elastic(context, 1e6, 0.3, out);
  return mps_material_create_drucker_prager(context, &law, out);
}

static inline mps_status make_free_body(mps_context *context, int32_t geometry, mps_body **out) {
  const int32_t dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  DEF(body, def, .motion = MPS_BODY_MOTION_FREE, .mass = dim == 3 ? 1.0 : 20.0);
  for (int c = 0; c < 3; c++) def.inertia[c] = dim == 3 ? 1e-3 * (1 + c) : c == 2 ? 0.1 : 0.0;
  def.gravity[1] = -9.81;
  def.position[0] = 0.25, def.position[1] = dim == 3 ? 0.28 : 0.33;
  def.position[2] = dim == 3 ? 0.1 : 0.0;
  def.velocity[1] = -3.0;
  if (geometry != MPS_MPM_GEOMETRY_AXISYMMETRIC) def.velocity[0] = 0.5, def.spin[2] = 10.0;
  if (dim == 3) def.spin[0] = 20.0;
  return dim == 3 ? mps_body_create_cylinder(context, &def, 0.04, 0.1, out)
                  : mps_body_create_box(context, &def, 0.1, 0.06, out);
}

/* A slope that rises and turns. */
static inline mps_status make_driven_body(mps_context *context, int32_t dim, const change *c,
                                          mps_body **out) {
  const double up[] = {0.1, 1.0, 0.0}, t[] = {0.0, 1.0}, v[] = {0.3, 0.3};
  scoped_signal *rise = NULL;
  DEF(body, def, .position[1] = dim == 3 ? 0.075 : 0.05);
  mps_status status =
      mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 2, t, v, &rise);
  if (status != MPS_OK) return status;
  status = dim == 3        ? mps_body_create_half_space(context, &def, up, out)
           : c->half_plane ? mps_body_create_disc(context, &def, 0.05, out)
                           : mps_body_create_half_plane(context, &def, up, out);
  if (status == MPS_OK) status = mps_body_name_part(*out, "base", 0, 1, NULL);
  if (status == MPS_OK) status = mps_body_drive(*out, 1, rise, 1.0);
  if (status == MPS_OK) status = mps_body_drive(*out, 5, rise, 0.2);
  return status;
}

static inline mps_status make_set(mps_context *context, int32_t dim, const change *c,
                                  mps_particles **out) {
  const double lo[] = {0.04, 0.08, 0.02}, hi[] = {0.44, dim == 3 ? 0.22 : 0.28, 0.18};
  const double beside[] = {0.5, 0.3, 0.1};
  DEF(particles, def, .dim = dim, .spacing = c->spacing);
  mps_status status = mps_particles_create(context, &def, out);
  if (status == MPS_OK) status = mps_particles_fill_box(*out, lo, hi, NULL);
  for (int64_t k = 0; k < c->particles && status == MPS_OK; k++)
    status = mps_particles_append(*out, 1, beside);
  if (status == MPS_OK) status = mps_particles_set(*out, "density", 0, 1500.0);
  return status == MPS_OK ? mps_particles_set(*out, "velocity", 0, 0.8) : status;
}

static inline mps_status try_build(mps_context *context, int32_t geometry, const change *c,
                                   scene *out) {
  const int32_t dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  *out = (scene){.s = {.context = context}};
  mpm_scene *s = &out->s;
  DEF(mpm, def, .geometry = geometry, .cell = c->cell, .budget = c->budget);
  for (int k = 0; k < dim; k++) def.lower[k] = def.origin[k] = c->origin;
  def.upper[0] = 1.0 + c->wall;
  def.gravity[1] = -9.81;
  mps_status status = make_set(context, dim, c, &s->particles);
  if (status == MPS_OK) status = make_material(context, c, &s->material);
  if (status == MPS_OK) status = mps_mpm_create(context, s->particles, s->material, &def, &s->mpm);
  if (status == MPS_OK) status = make_free_body(context, geometry, &out->body[FREE]);
  if (status == MPS_OK) status = make_driven_body(context, dim, c, &out->body[DRIVEN]);
  mps_contact_def contact = mps_contact_defaults();
  contact.thin = 1; /* where the cell is another */
  for (int b = 0; b < c->bodies && status == MPS_OK; b++) {
    contact.friction = b == FREE ? 0.3 : 0.4;
    contact.inset = b == FREE && dim == 2 ? 0.6 * c->cell : 0.0;
    status = mps_mpm_add_contact(s->mpm, out->body[b], &contact, NULL);
  }
  return status;
}

static inline void drop(scene *x) {
  mpm_scene_end(&x->s);
  for (int b = 0; b < BODIES; b++) mps_body_destroy(&x->body[b]);
}

static inline scene build(mps_context *context, int32_t geometry, const change *c) {
  scene x;
  OK(try_build(context, geometry, c, &x));
  return x;
}

/* ---- comparing ------------------------------------------------------------------------------- */

static inline void same_fields(scene *a, scene *b) {
  char what[40];
  snprintf(what, sizeof what, "step %d", (int)mps_mpm_steps(a->s.mpm));
  assert_same_rows(a->s.particles, b->s.particles, what);
}

static inline void same_bodies(scene *a, scene *b) {
  for (int k = 0; k < BODIES; k++) {
    mps_body_state state[2];
    memset(state, 0, sizeof state);
    OK(mps_body_get_state(a->body[k], &state[0]));
    OK(mps_body_get_state(b->body[k], &state[1]));
    assert_memory_equal(&state[0], &state[1], sizeof state[0]);
    for (int32_t p = 0; p < a->body[k]->parts; p++) {
      mps_reaction r[2];
      memset(r, 0, sizeof r);
      OK(mps_body_get_reaction(a->body[k], p, &r[0]));
      OK(mps_body_get_reaction(b->body[k], p, &r[1]));
      assert_memory_equal(&r[0], &r[1], sizeof r[0]);
    }
  }
}

static inline void same(scene *a, scene *b) {
  same_fields(a, b);
  same_bodies(a, b);
  assert_int_equal(mps_mpm_steps(a->s.mpm), mps_mpm_steps(b->s.mpm));
  assert_true(mps_mpm_time(a->s.mpm) == mps_mpm_time(b->s.mpm));
  assert_true(mps_mpm_dt(a->s.mpm) == mps_mpm_dt(b->s.mpm));
  mps_mpm_report ta, tb;
  OK(mps_mpm_get_report(a->s.mpm, &ta));
  OK(mps_mpm_get_report(b->s.mpm, &tb));
  assert_int_equal(ta.blocks, tb.blocks);
  assert_int_equal(ta.nodes, tb.nodes);
}

/* Own threads: not every build has OpenMP. `threads` must outlive the context. */
static inline mps_context *on_threads(int32_t *threads) {
  mps_context_def def = pthread_executor_def(threads);
  mps_context *context = NULL;
  assert_int_equal(mps_context_create(&def, &context, NULL, 0), MPS_OK);
  return context;
}

/* ---- walls, moving nodes, loads, several materials ------------------------------------------- */

static inline scene build_held(mps_context *context, int32_t geometry) {
  int32_t box, loads[2];
  const double hi[] = {0.2, INFINITY, INFINITY}, lo[] = {-INFINITY, -INFINITY, -INFINITY};
  int64_t ids[4000];
  scene x = {.s = held_begin(context, geometry, &box, loads)};
  const int64_t count = held_select(&x.s, lo, hi, ids, 4000);
  scoped_material *soil = NULL;
  OK(make_material(context, &none, &soil));
  OK(mps_mpm_set_material(x.s.mpm, soil, ids, count));
  return x;
}

static inline void same_forces(scene *a, scene *b) {
  mps_reaction force[2];
  for (int32_t k = 0; k < 4; k++) {
    OK(mps_mpm_get_reaction(a->s.mpm, k, &force[0]));
    OK(mps_mpm_get_reaction(b->s.mpm, k, &force[1]));
    assert_memory_equal(&force[0], &force[1], sizeof force[0]);
  }
}

#endif
