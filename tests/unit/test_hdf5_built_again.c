/* test_hdf5_built_again.c - a checkpoint is taken by a fresh solver that is built by the same calls
 * in the same order, whatever state the first one was in when they were made: a law whose initial
 * state the settled ground allows and fresh ground does not, a body placed where ground has sunk or
 * another body has left, particles added and removed, sides set late. Both continue bit for bit.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/same.h"
#include "mpm_scene.h"
#include "test_fixture.h"

#define FILE_NAME "built_again.h5"

typedef struct scene {
  mpm_scene s;
  mps_material *clay;
  mps_body *body[2];
} scene;

/* What a scene does once its solver is there: the calls that build it, `fresh` false with the steps
 * between them. */
typedef void (*build_fn)(scene *x, bool fresh);

static scene begin(double young) {
  scene x = {.s = mpm_scene_begin(context, 0.1, 0.0, 0.0, young)};
  mpm_scene_box(&x.s, 0.0, 0.0, 1.0, 1.0);
  USING(mpm, mpm_scene_solve(&x.s, &given), .cell = 0.2, .gravity[1] = -9.81, .lower[0] = 0.0,
        .upper[0] = 1.0, .lower[1] = 0.0);
  DEF(material_cam_clay, clay, .critical_slope = 1.0, .compression = 0.2, .swelling = 0.05,
      .void_ratio = 1.0, .preconsolidation = 5e4);
  OK(mps_material_create_cam_clay(context, &clay, &x.clay));
  return x;
}

static void end(scene *x) {
  mpm_scene_end(&x->s);
  mps_material_destroy(&x->clay);
  for (int k = 0; k < 2; k++) mps_body_destroy(&x->body[k]);
}

static mps_body *block_at(double x, double y, double half) {
  DEF(body, def, .position[0] = x, .position[1] = y);
  const double corners[8] = {-half, -half, half, -half, half, half, -half, half};
  MAKE_KEPT(body, body, create_polygon, context, &def, 4, corners);
  return body;
}

/* ---- the ways to a state --------------------------------------------------------------------- */

static void settle_then_clay(scene *x, bool fresh) {
  if (!fresh) OK(mps_mpm_settle(x->s.mpm, NULL, NULL));
  OK(mps_mpm_set_material(x->s.mpm, x->clay, NULL, 0));
}

/* Soft ground sinks by some centimetres; the body is placed on it then. */
static void settle_then_body(scene *x, bool fresh) {
  if (!fresh) OK(mps_mpm_settle(x->s.mpm, NULL, NULL));
  x->body[0] = block_at(0.5, 1.14, 0.2); /* 6 cm in the ground as filled */
  OK(mps_mpm_add_contact(x->s.mpm, x->body[0], NULL, NULL));
}

/* The second body takes the place that the first has left. */
static void body_after_body(scene *x, bool fresh) {
  x->body[0] = block_at(0.3, 1.6, 0.1);
  OK(mps_mpm_add_contact(x->s.mpm, x->body[0], NULL, NULL));
  WITH_DEFAULTS(mps_body_motion, motion, .velocity[0] = 4.0);
  OK(mps_body_set_motion(x->body[0], &motion));
  if (!fresh) OK(mps_mpm_run(x->s.mpm, 0.1, 100000, NULL, NULL));
  x->body[1] = block_at(0.35, 1.6, 0.1);
  OK(mps_mpm_add_contact(x->s.mpm, x->body[1], NULL, NULL));
}

/* A fresh solver has the law without a particle: the file has the law of each particle. */
static void insert_then_law(scene *x, bool fresh) {
  const double at[4] = {0.45, 1.05, 0.55, 1.05};
  const int64_t ids[2] = {100, 101}, none[1] = {0};
  if (fresh) {
    OK(mps_mpm_set_material(x->s.mpm, x->clay, none, 0));
    return;
  }
  OK(mps_mpm_step(x->s.mpm, 2));
  OK(mps_particles_append(x->s.particles, 2, at));
  OK(mps_particles_set(x->s.particles, "density", 0, 1000.0));
  EDIT(stress, x->s.particles, "stress")
    for (int k = 0; k < 2; k++)
      for (int c = 0; c < 3; c++)
        *mps_edit_f64(&stress, mps_particles_index(x->s.particles, ids[k]), c) = -1e3;
  OK(mps_mpm_set_material(x->s.mpm, x->clay, ids, 2));
}

static void sides_set_late(scene *x, bool fresh) {
  if (!fresh) OK(mps_mpm_settle(x->s.mpm, NULL, NULL));
  mpm_scene_side(&x->s, MPS_SIDE_X_LOWER, MPS_BOUNDARY_FREE_FIELD, 0.0);
  mpm_scene_side(&x->s, MPS_SIDE_X_UPPER, MPS_BOUNDARY_FREE_FIELD, 0.0);
  mpm_scene_side(&x->s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_ABSORBING, 0.0);
}

static void remove_then_step(scene *x, bool fresh) {
  const int64_t ids[3] = {3, 4, 99};
  if (fresh) return;
  OK(mps_mpm_step(x->s.mpm, 2));
  OK(mps_particles_remove(x->s.particles, ids, 3));
}

/* ---- comparison ------------------------------------------------------------------------------ */

static void build_again(build_fn build, double young) {
  const mps_checkpoint defaults = mps_checkpoint_defaults();
  mps_checkpoint info = defaults;
  scene first = begin(young), again = begin(young);
  build(&first, false);
  OK(mps_mpm_step(first.s.mpm, 3));
  const mps_status saved = mps_mpm_save(first.s.mpm, FILE_NAME, &info);
  if (saved == MPS_ERROR_UNSUPPORTED) skip();
  OK(saved);
  build(&again, true);
  info = defaults;
  OK(mps_mpm_restore(again.s.mpm, FILE_NAME, &info));
  OK(mps_mpm_step(first.s.mpm, 5));
  OK(mps_mpm_step(again.s.mpm, 5));
  assert_same_rows(first.s.particles, again.s.particles, "");
  assert_true(mps_mpm_time(first.s.mpm) == mps_mpm_time(again.s.mpm));
  end(&first), end(&again);
  (void)remove(FILE_NAME);
}

#define AGAIN(name, young)                                                                         \
  TEST(name##_is_restored) { build_again(name, young); }
AGAIN(settle_then_clay, 1e6)
AGAIN(settle_then_body, 5e4)
AGAIN(body_after_body, 1e6)
AGAIN(insert_then_law, 1e6)
AGAIN(sides_set_late, 1e6)
AGAIN(remove_then_step, 1e6)

/* What waits for the first step is not forgotten. */
TEST(a_fresh_solver_checks_with_its_first_step) {
  SCOPED(end) scene x = begin(1e6);
  settle_then_clay(&x, true);
  mps_snapshot *kept = NULL;
  REFUSES(mps_mpm_step(x.s.mpm, 1), "has the mean effective pressure");
  REFUSES(mps_mpm_settle(x.s.mpm, NULL, NULL), "has the mean effective pressure");
  REFUSES(mps_mpm_snapshot(x.s.mpm, &kept), "has the mean effective pressure");
  assert_int_equal(mps_mpm_steps(x.s.mpm), 0);
  OK(mps_mpm_set_material(x.s.mpm, x.s.material, NULL, 0));
  OK(mps_mpm_step(x.s.mpm, 1));
  REFUSES(mps_mpm_set_material(x.s.mpm, x.clay, NULL, 0), "has the mean effective pressure");
  end(&x);
  x = begin(1e6);
  body_after_body(&x, true);
  REFUSES(mps_mpm_step(x.s.mpm, 1), "overlaps body 0");
  end(&x);
  x = begin(5e4);
  settle_then_body(&x, true);
  REFUSES(mps_mpm_step(x.s.mpm, 1), "particles lie inside the body");
}
