/* test_elastic_threads.c - implicit elasticity gives the same bits for every number of threads, and
 * whatever the order of the particles in their set.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_common.h"
#include "pthread_executor.h"

#include "core/particles/particles_internal.h"

/* Displacements, reactions and stresses of an L-shape of 10 000 particles (2500 if quick) after a
 * solution and three Newmark steps, by id: 8 doubles a particle. */
static double *solve(const mps_context_def *def, int reversed, int32_t solver, int64_t *n) {
  scoped_context *context = NULL;
  char text[256];
  if (mps_context_create(def, &context, text, sizeof text) != MPS_OK) fail_msg("%s", text);
  const double spacing = test_quick() ? 0.02 : 0.01;
  scoped_test_body b = test_body_begin(context, 2, spacing);
  test_body_box(&b, 0, 0, 0, 2, 0.3, 0);
  test_body_box(&b, 0, 0, 0, 0.3, 1.5, 0);
  DEF(elastic, elastic, .solver = solver, .blas_threads = 1);
  test_body_finish(&b, 2.0, 0.25, &elastic);
  OK(mps_particles_set(b.particles, "density", 0, 1.0));
  if (reversed) {
    int64_t *order = malloc((size_t)b.n * sizeof *order);
    for (int64_t k = 0; k < b.n; k++) order[k] = b.n - 1 - k;
    OK(mpsi_particles_permute(b.particles, "test", order));
    free(order);
  }
  int64_t count, *ids = test_select(&b, 1, -1, 0.6 * spacing, &count);
  const double load[2] = {0.1, -1.0}, wind[2] = {0.3, 0.0};
  for (int c = 0; c < 2; c++) OK(test_prescribe(b.elastic, c, count, ids, NULL));
  OK(test_body_force(b.elastic, load));
  OK(mps_elastic_solve(b.elastic));
  USING(elastic_motion, mps_elastic_start(b.elastic, &given), .dt = 0.05);
  OK(test_body_force(b.elastic, wind));
  OK(mps_elastic_step(b.elastic, 3));
  OK(mps_elastic_update_stress(b.elastic));
  double *out = malloc((size_t)b.n * 8 * sizeof *out);
  for (int64_t id = 0; id < b.n; id++) {
    const int64_t i = mps_particles_index(b.particles, id);
    for (int c = 0; c < 2; c++) {
      out[id * 8 + c] = test_value(&b, "displacement", i, c);
      out[id * 8 + 2 + c] = test_value(&b, "reaction", i, c);
    }
    for (int c = 0; c < 4; c++) out[id * 8 + 4 + c] = test_value(&b, "stress", i, c);
  }
  *n = b.n;
  free(ids);
  return out;
}

static void check(int32_t solver) {
  int64_t n, m;
  mps_context_def serial = test_context_defaults();
  serial.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  double *expected = solve(&serial, 0, solver, &n);
  for (int k = 0; k < 4; k++) {
    int32_t threads = k + 1;
    mps_context_def def = pthread_executor_def(&threads);
    if (k == 3) { /* the build's own executor, particles the other way round */
      def = test_context_defaults();
      def.threads = 3;
    }
    double *got = solve(&def, k == 3, solver, &m);
    assert_int_equal(m, n);
    assert_memory_equal(got, expected, (size_t)n * 8 * sizeof *got);
    free(got);
  }
  free(expected);
}

TEST(threads_and_order_change_nothing) {
  check(MPS_ELASTIC_SOLVER_LLT);
  check(MPS_ELASTIC_SOLVER_LDLT);
  check(MPS_ELASTIC_SOLVER_CG);
}
