/* test_dynamics_threads.c - the same bits for every number of threads, every executor and every
 * instruction set.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "digest.h"
#include "pthread_executor.h"
#include "soil_column.h"

/* The fields that carry the state. */
static const char *const names[] = {"id",       "displacement",  "rotation",
                                    "velocity", "spin",          "acceleration",
                                    "pressure", "restoring_old", NULL};

typedef struct setting {
  int32_t executor, threads, isa;
  bool damped;
} setting;

/* A 200 x 170 m slope with free-field columns and a viscous base, shaken: runs, scattered pairs
 * and dashpots are all there, in enough blocks to be shared between threads. */
static mps_status run(const setting *s, uint64_t *hash) {
  mps_context_def def = test_context_defaults();
  scoped_context *context = NULL;
  int32_t threads = s->threads;
  def.executor = s->executor;
  def.threads = s->threads;
  def.instruction_level = s->isa;
  if (s->executor == MPS_CONTEXT_EXECUTOR_CALLER) {
    def.parallel_for = pthread_executor;
    def.parallel_user = &threads;
  }
  if (mps_context_create(&def, &context, NULL, 0) != MPS_OK) return MPS_ERROR_UNSUPPORTED;
  mps_particles_def set = mps_particles_defaults();
  set.spacing = test_races() ? 1.25 : 1.0; /* m: 28 blocks still, and 3 batches */
  const double outline[] = {0.0,   0.0,  200.0, 0.0,   200.0, 80.0,
                            130.0, 80.0, 70.0,  170.0, 0.0,   170.0};
  MAKE(particles, particles, create, context, &set);
  OK(mps_particles_fill_polygon(particles, 6, outline, NULL));
  SET_FIELDS(particles, {"density", 1800.0}, {"shear_velocity", 150.0},
             {"pressure_velocity", 330.0}, {"damping", 0.0});
  mps_view x = view_field(particles, "position");
  EDIT(h, particles, "damping")
    for (int64_t k = 0; s->damped && k < x.shape[0]; k++)
      *mps_edit_f64(&h, k, 0) = *mps_view_f64(&x, k, 1) > 60.0 ? 0.05 : 0.02;
  OK(mps_dynamics_add_free_field(particles, MPS_SIDE_X_LOWER, 2));
  OK(mps_dynamics_add_free_field(particles, MPS_SIDE_X_UPPER, 2));
  DEF(dynamics, dynamics_def, .dt = 1e-3);
  scoped_dynamics *dynamics = NULL;
  mps_status status = mps_dynamics_create(context, particles, &dynamics_def, &dynamics);
  if (status == MPS_OK) {
    int64_t count;
    int64_t *base = soil_select(particles, -10.0, -1.0, 1000.0, set.spacing, &count);
    MAKE(signal, ricker, create_ricker, context, 4.0, 0.05, 1.0);
    USING(dynamics_boundary, soil_add_viscous(dynamics, &given, count, base), .signal[0] = ricker);
    free(base);
    OK(mps_dynamics_step(dynamics, test_quick() ? 6 : 60));
    mps_totals energy;
    mps_dynamics_linear_limit limit;
    OK(mps_dynamics_get_totals(dynamics, &energy));
    *hash = digest_fields(particles, names);
    *hash = digest_add(*hash, &energy.kinetic);
    *hash = digest_add(*hash, &energy.strain);
    if (s->damped) { /* the limit of uneven damping is a longer search: once is enough */
      limit.dt = 0.0;
    } else {
      OK(mps_dynamics_find_limit(dynamics, 0.0, &limit));
    }
    *hash = digest_add(*hash, &limit.dt);
  }
  return status;
}

static void same_bits(const setting *settings, int count, bool damped) {
  uint64_t first = 0;
  setting reference = {MPS_CONTEXT_EXECUTOR_SERIAL, 1, 0, damped};
  assert_int_equal(run(&reference, &first), MPS_OK);
  for (int k = 0; k < count; k++) {
    setting s = settings[k];
    uint64_t hash = 0;
    s.damped = damped;
    const mps_status status = run(&s, &hash);
    if (status == MPS_ERROR_UNSUPPORTED) {
      print_message("executor %d or level %d is missing here: not compared\n", s.executor, s.isa);
      continue;
    }
    assert_int_equal(status, MPS_OK);
    if (hash != first)
      fail_msg("executor %d, %d threads, level %d: other bits than one thread", s.executor,
               s.threads, s.isa);
  }
}

TEST(every_number_of_threads) {
  static const setting settings[] = {
      {MPS_CONTEXT_EXECUTOR_OPENMP, 3, 0, false},  {MPS_CONTEXT_EXECUTOR_CALLER, 2, 0, false},
      {MPS_CONTEXT_EXECUTOR_THREADS, 3, 0, false}, {MPS_CONTEXT_EXECUTOR_THREADS, 2, 0, false},
      {MPS_CONTEXT_EXECUTOR_OPENMP, 1, 0, false},  {MPS_CONTEXT_EXECUTOR_OPENMP, 2, 0, false},
      {MPS_CONTEXT_EXECUTOR_OPENMP, 8, 0, false},  {MPS_CONTEXT_EXECUTOR_CALLER, 3, 0, false}};
  same_bits(settings, test_quick() ? 3 : 8, false);
  same_bits(settings, test_quick() ? 3 : 8, true);
}

TEST(every_instruction_set) {
  static const setting settings[] = {{MPS_CONTEXT_EXECUTOR_SERIAL, 1, 1, false},
                                     {MPS_CONTEXT_EXECUTOR_SERIAL, 1, 3, false},
                                     {MPS_CONTEXT_EXECUTOR_SERIAL, 1, 4, false}};
  if (test_races()) skip(); /* one thread */
  same_bits(settings, 3, false);
  same_bits(settings, 3, true);
}
