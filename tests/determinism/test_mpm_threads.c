/* test_mpm_threads.c - the same bits for every number of threads and every executor; the same
 * result up to round-off for every order of the particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "digest.h"
#include "mpm_held.h"
#include "pthread_executor.h"

static const char *const names[] = {"id",     "position", "velocity", "velocity_gradient",
                                    "stress", "volume",   NULL};

enum { BY_CELL = 1, STANDARD = 2, BY_NODES = 64, FIN = 4096 };

static void solve(mpm_scene *s, mps_mpm_def *def, int options) {
  if (options & BY_CELL) def->volumetric = MPS_MPM_VOLUMETRIC_CELL;
  if (options & BY_NODES) def->volumetric = MPS_MPM_VOLUMETRIC_NODES;
  mpm_scene_solve(s, def);
  if (options & STANDARD) OK(mps_experimental_mpm_standard(s->mpm, 0.9));
}

/* A plate of a fifth of a cell in the block, up to its middle; its end bears in the middle. */
static void add_fin(mpm_scene *s) {
  DEF(body, body, .position[0] = 0.505, .position[1] = 0.5);
  MAKE(body, fin, create_box, s->context, &body, 0.004, 0.4);
  USING(contact, mps_mpm_add_contact(s->mpm, fin, &given, NULL), .friction = 0.4, .inset = 0.012);
}

/* A block that falls on a rough floor while a free rough disc hits its side (a ring its top): many
 * blocks of cells, sorting, contact, friction, walls. `options` choose what is not default,
 * `backwards` puts the particles in the opposite order. */
static mpm_scene fall(mps_context *context, int32_t geometry, int options, bool backwards,
                      mps_body **disc) {
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e6);
  enum { NX = 60, NY = 40 };
  for (int k = 0; k < NX * NY; k++) {
    const int n = backwards ? NX * NY - 1 - k : k;
    const double x[] = {0.25 + 0.01 * (n % NX), 0.1 + 0.01 * (double)(n / NX)};
    OK(mps_particles_append(s.particles, 1, x));
  }
  const double v0[] = {0.5, -2.0}, L[] = {0.0, -1.0, 1.0, 0.0};
  mpm_scene_affine(&s, v0, L);
  DEF(mpm, def, .geometry = geometry, .cell = 0.02, .lower[0] = 0.0, .upper[0] = 1.0,
      .gravity[1] = -9.81);
  solve(&s, &def, options);
  DEF(body, body, .position[1] = 0.06);
  const double up[] = {0.1, 1.0};
  MAKE(body, floor, create_half_plane, context, &body, up);
  DEF(contact, rough, .friction = 0.4, .adhesion = 50.0, .strength = 2000.0);
  rough.inside = MPS_CONTACT_INSIDE_PUSH; /* some begin below the slope */
  OK(mps_mpm_add_contact(s.mpm, floor, &rough, NULL));
  body.motion = MPS_BODY_MOTION_FREE;
  body.mass = 30.0, body.inertia[2] = 0.15;
  const bool ring = geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC; /* which falls on the block */
  body.position[0] = ring ? 0.6 : 0.93, body.position[1] = ring ? 0.58 : 0.3;
  body.velocity[ring ? 1 : 0] = ring ? -6.0 : -3.0;
  OK(mps_body_create_disc(context, &body, 0.07, disc));
  if (options & FIN) add_fin(&s);
  mpm_scene_contact(&s, *disc, 0.4);
  OK(mps_mpm_step(s.mpm, 100));
  return s;
}

/* A block in space that falls on a rough ball in the corner of the walls. */
static mpm_scene fall_in_space(mps_context *context, int options) {
  const double lo[] = {0.05, 0.02, 0.0}, hi[] = {0.53, 0.18, 0.16};
  const double v0[] = {-1.0, -2.0, 0.5}, L[] = {0.0, -3.0, 1.0, 3.0, 0.0, 0.0, -1.0, 0.0, 0.0};
  mpm_scene s = mpm_scene_begin_in(context, 3, 0.01, 0.0, 0.0, 1e5);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  mpm_scene_affine(&s, v0, L);
  DEF(mpm, def, .geometry = MPS_MPM_GEOMETRY_SPACE, .cell = 0.02);
  for (int c = 0; c < 3; c++) def.lower[c] = 0.0;
  def.gravity[1] = -9.81;
  solve(&s, &def, options);
  DEF(body, body, .position[0] = 0.3, .position[2] = 0.08);
  MAKE(body, ball, create_sphere, context, &body, 0.03);
  DEF(contact, rough, .friction = 0.4, .strength = 500.0);
  rough.inside = MPS_CONTACT_INSIDE_PUSH; /* some begin in it */
  OK(mps_mpm_add_contact(s.mpm, ball, &rough, NULL));
  OK(mps_mpm_step(s.mpm, 25));
  mps_reaction reaction;
  OK(mps_body_get_reaction(ball, -1, &reaction));
  assert_true(reaction.count > 0);
  return s;
}

/* A slab that slides on a rough floor in space, so that more particles are in contact than one
 * thread sweeps alone (SHARED in mpm/impulses.c). */
static mpm_scene slide_in_space(mps_context *context) {
  const double lo[] = {0.0, 0.0, 0.0}, hi[] = {0.3, 0.06, 0.3}, up[] = {0.0, 1.0, 0.0};
  const double v0[] = {1.0, -1.0, 0.5}, L[9] = {0.0};
  mpm_scene s = mpm_scene_begin_in(context, 3, 0.01, 0.0, 0.0, 1e5);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  mpm_scene_affine(&s, v0, L);
  USING(mpm, mpm_scene_solve(&s, &given), .geometry = MPS_MPM_GEOMETRY_SPACE, .cell = 0.02);
  MAKE(body, floor, create_half_space, context, NULL, up);
  mpm_scene_contact(&s, floor, 0.3);
  mps_reaction reaction;
  int64_t most = 0;
  for (int k = 0; k < 20; k++) {
    OK(mps_mpm_step(s.mpm, 1));
    OK(mps_body_get_reaction(floor, -1, &reaction));
    most = reaction.count > most ? reaction.count : most;
  }
  assert_true(most > 600);
  return s;
}

/* The scene with everything that holds and loads, in the plane and in space; the forces that act.
 */
static mpm_scene hold(mps_context *context, int32_t geometry, uint64_t *hash) {
  int32_t box = -1, loads[2];
  mpm_scene s = held_begin(context, geometry, &box, loads);
  OK(mps_mpm_step(s.mpm, 10));
  double force[3];
  for (int32_t k = -1; k < 4; k++) {
    mpm_scene_force(&s, k < 0 ? box : k, force);
    for (int c = 0; c < 3; c++) *hash = digest_add(*hash, &force[c]);
  }
  return s;
}

/* Besides the options of `fall`: the scene with everything that holds; the slab. */
enum { HELD = 1024, SLAB = 2048 };

static uint64_t hash_of(int32_t executor, int32_t threads, int32_t geometry, int options) {
  mps_context_def def = executor == MPS_CONTEXT_EXECUTOR_CALLER ? pthread_executor_def(&threads)
                                                                : test_context_defaults();
  def.executor = executor;
  def.threads = threads;
  scoped_context *context = NULL;
  if (mps_context_create(&def, &context, NULL, 0) != MPS_OK) return 0;
  scoped_body *disc = NULL;
  mps_body_state b = {0};
  uint64_t forces = 0;
  scoped_mpm_scene s = options & HELD   ? hold(context, geometry, &forces)
                       : options & SLAB ? slide_in_space(context)
                       : geometry == MPS_MPM_GEOMETRY_SPACE
                           ? fall_in_space(context, options)
                           : fall(context, geometry, options, false, &disc);
  if (disc) OK(mps_body_get_state(disc, &b));
  assert_true(!disc || (b.velocity[0] > -2.9 && b.velocity[1] > -5.9)); /* it has hit */
  uint64_t hash = digest_add(digest_fields(s.particles, names), &b.spin[2]);
  hash = digest_add(hash, &forces);
  return hash;
}

/* One serial thread against `count` numbers of the context's own threads, and against the first of
 * these numbers on the other executors. */
static void same_bits(int32_t geometry, int options, int count, const int32_t *threads) {
  static const int32_t executors[] = {MPS_CONTEXT_EXECUTOR_THREADS, MPS_CONTEXT_EXECUTOR_OPENMP,
                                      MPS_CONTEXT_EXECUTOR_CALLER};
  const uint64_t first = hash_of(MPS_CONTEXT_EXECUTOR_SERIAL, 1, geometry, options);
  for (int k = 0; k < count; k++)
    for (int e = 0; e < (k == 0 ? 3 : 1); e++) {
      const uint64_t hash = hash_of(executors[e], threads[k], geometry, options);
      if (hash == 0)
        print_message("executor %d is missing here: not compared\n", executors[e]);
      else if (hash != first)
        fail_msg("executor %d, %d threads: other bits than one thread", executors[e], threads[k]);
    }
}

static const int32_t threads[] = {3, 2, 1, 8};

/* How many of these: at the lower instruction levels the same code shares the work out. */
static int numbers(int most) { return getenv("MPS_TEST_LEVEL") || test_quick() ? 1 : most; }

TEST(every_number_of_threads) {
  for (int32_t geometry = 0; geometry <= MPS_MPM_GEOMETRY_SPACE; geometry++)
    same_bits(geometry, 0, numbers(4), threads);
}

TEST(options_too) {
  same_bits(MPS_MPM_GEOMETRY_AXISYMMETRIC, BY_CELL, 1, threads);
  same_bits(MPS_MPM_GEOMETRY_PLANE_STRAIN, BY_NODES, 1, threads);
  same_bits(MPS_MPM_GEOMETRY_SPACE, BY_NODES, 1, threads);
  for (int32_t geometry = 0; geometry < MPS_MPM_GEOMETRY_SPACE; geometry++)
    same_bits(geometry, FIN, numbers(4), threads);
  same_bits(MPS_MPM_GEOMETRY_PLANE_STRAIN, STANDARD, 1, threads);
  same_bits(MPS_MPM_GEOMETRY_SPACE, STANDARD | BY_CELL, 1, threads);
  same_bits(MPS_MPM_GEOMETRY_PLANE_STRAIN, HELD, numbers(4), threads);
  same_bits(MPS_MPM_GEOMETRY_SPACE, HELD, numbers(4), threads);
  same_bits(MPS_MPM_GEOMETRY_SPACE, SLAB, numbers(2), threads);
}

TEST_SERIAL(any_order_of_particles) {
  mps_body *disc[2] = {NULL};
  scoped_mpm_scene a = fall(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 0, false, &disc[0]);
  scoped_mpm_scene b = fall(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 0, true, &disc[1]);
  const int64_t count = mps_particles_count(a.particles);
  mps_view xa = mpm_scene_view(&a, "position"), xb = mpm_scene_view(&b, "position");
  for (int64_t id = 0; id < count; id++) {
    const int64_t i = mps_particles_index(a.particles, id);
    const int64_t j = mps_particles_index(b.particles, count - 1 - id);
    for (int c = 0; c < 2; c++) NEAR(*mps_view_f64(&xb, j, c), *mps_view_f64(&xa, i, c), 1e-11);
  }
  for (int k = 0; k < 2; k++) mps_body_destroy(&disc[k]);
}

/* ---- history --------------------------------------------------------------------------------- */

static const char *const state_fields[] = {"position", "velocity", "velocity_gradient", "stress",
                                           "volume"};
enum { STATE_FIELDS = 5, STATE_VALUES = 2 + 2 + 5 + 4 + 1 };

/* Fields of a particle, from the set or (to) into it. */
static void exchange(mpm_scene *s, double (*values)[STATE_VALUES], bool to) {
  const int64_t count = mps_particles_count(s->particles);
  mps_view id = mpm_scene_view(s, "id");
  mps_edit field[STATE_FIELDS];
  for (int f = 0; f < STATE_FIELDS; f++) {
    field[f].view = mpm_scene_view(s, state_fields[f]);
    if (to) field[f] = mpm_scene_edit(s, state_fields[f]);
  }
  for (int64_t k = 0; k < count; k++) {
    double *value = values[*mps_view_i64(&id, k, 0)];
    for (int f = 0; f < STATE_FIELDS; f++)
      for (int64_t c = 0; c < field[f].view.shape[1]; c++, value++)
        if (to)
          *mps_edit_f64(&field[f], k, c) = *value;
        else
          *value = *mps_view_f64(&field[f].view, k, c);
  }
  for (int f = 0; to && f < STATE_FIELDS; f++) mpm_scene_commit(s, &field[f]);
}

/* A lump that shakes at random at a wall is put back to its first state after many sorts: what then
 * follows is what followed the first time, bit for bit. */
TEST(any_history_of_sorts) {
  enum { MOST = 2000 };
  static double start[MOST][STATE_VALUES], end[2][MOST][STATE_VALUES];
  scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const double centre[] = {0.11, 0.1};
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.003, 0.001, 1e6);
  OK(mps_particles_fill_ball(s.particles, centre, 0.1, NULL));
  OK(mps_particles_add_field(s.particles, "velocity", 0));
  mps_edit v = mpm_scene_edit(&s, "velocity");
  uint64_t seed = 1;
  assert_in_range(v.view.shape[0], 200, MOST);
  for (int64_t k = 0; k < v.view.shape[0]; k++)
    for (int c = 0; c < 2; c++) {
      seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
      *mps_edit_f64(&v, k, c) = 20.0 * (double)(seed >> 11) * 0x1p-53 - 8.0;
    }
  mpm_scene_commit(&s, &v);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .dt = 1e-4, .lower[1] = 0.0);
  exchange(&s, start, false);
  const uint64_t epoch = mps_particles_epoch(s.particles);
  for (int turn = 0; turn < 2; turn++) {
    OK(mps_mpm_step(s.mpm, 100));
    exchange(&s, end[turn], false);
    if (turn > 0) break;
    assert_true(mps_particles_epoch(s.particles) > epoch); /* it was sorted */
    OK(mps_mpm_step(s.mpm, 200));
    exchange(&s, start, true);
  }
  for (int64_t id = 0; id < v.view.shape[0]; id++)
    assert_memory_equal(end[0][id], end[1][id], sizeof end[0][id]);
}
