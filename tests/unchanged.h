/* unchanged.h - all that a caller can see of a set, a solver or a body, as one number, to find that
 * a call that failed has changed nothing: epoch, order and fields of the set; time, step, limit,
 * totals and reactions of the solver; pose and account of the body.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_UNCHANGED_H
#define MPS_TEST_UNCHANGED_H

#include "digest.h"

static inline uint64_t seen_bytes(uint64_t hash, const void *data, size_t size) {
  for (size_t k = 0; k < size; k++)
    hash = (hash ^ ((const unsigned char *)data)[k]) * 1099511628211u;
  return hash;
}

/* Readers of `own` may fail where there is nothing to read: its record of an error stays. */
static inline uint64_t seen_set(mps_particles *set) {
  const uint64_t epoch = mps_particles_epoch(set);
  uint64_t hash = digest_add(DIGEST_START, &epoch);
  for (int32_t f = 0; f < mps_particles_field_count(set); f++) {
    mps_particles_field_info info;
    OK(mps_particles_get_field_info(set, f, &info));
    const char *const names[2] = {info.name, NULL};
    const uint64_t values = digest_fields(set, names);
    hash = seen_bytes(hash, info.name, strlen(info.name));
    hash = digest_add(hash, &values);
  }
  return hash;
}

/* The same by ids, whatever their order and the epoch: of calls that may sort the particles. */
static inline uint64_t seen_values(mps_particles *set) {
  const int64_t count = mps_particles_count(set);
  uint64_t hash = digest_add(DIGEST_START, &count);
  for (int32_t f = 0; f < mps_particles_field_count(set); f++) {
    mps_particles_field_info info;
    OK(mps_particles_get_field_info(set, f, &info));
    mps_view view = view_field(set, info.name);
    hash = seen_bytes(hash, info.name, strlen(info.name));
    for (int64_t id = 0, found = 0; found < count; id++) {
      const int64_t k = mps_particles_index(set, id);
      if (k < 0) continue;
      found++;
      for (int64_t c = 0; c < view.shape[1]; c++)
        hash = digest_add(hash,
                          (const char *)view.data + 8 * (k * view.stride[0] + c * view.stride[1]));
    }
  }
  return hash;
}

static inline uint64_t seen_body(mps_body *body) {
  mps_body_state state;
  mps_body_totals totals;
  mps_reaction reaction;
  OK(mps_body_get_state(body, &state));
  OK(mps_body_get_totals(body, &totals));
  OK(mps_body_get_reaction(body, -1, &reaction));
  uint64_t hash = seen_bytes(DIGEST_START, &state, sizeof state);
  hash = seen_bytes(hash, &totals, sizeof totals);
  return seen_bytes(hash, &reaction, sizeof reaction);
}

#define SEEN_BOUNDARIES 12 /* numbers that are looked at */

/* seen_mpm(solver, sorts), seen_dynamics(solver, sorts) ...: with the set that the solver holds,
 * whose order may change where `sorts`. */
#define SEEN_SOLVER(S)                                                                             \
  static inline uint64_t seen_##S(mps_##S *s, bool sorts) {                                        \
    mps_context *own = mps_##S##_context(s);                                                       \
    const mps_error kept = *mps_context_error(own);                                                \
    const double numbers[3] = {mps_##S##_time(s), mps_##S##_dt(s), mps_##S##_limit(s)};            \
    const int64_t steps = mps_##S##_steps(s);                                                      \
    mps_totals totals;                                                                             \
    memset(&totals, 0, sizeof totals);                                                             \
    mps_particles *set = mps_##S##_particles(s);                                                   \
    uint64_t hash = sorts ? seen_values(set) : seen_set(set);                                      \
    for (int k = 0; k < 3; k++) hash = digest_add(hash, &numbers[k]);                              \
    hash = digest_add(hash, &steps);                                                               \
    const mps_status status = mps_##S##_get_totals(s, &totals);                                    \
    hash = seen_bytes(hash, &status, sizeof status);                                               \
    hash = seen_bytes(hash, &totals, sizeof totals);                                               \
    for (int32_t k = 0; k < SEEN_BOUNDARIES; k++) {                                                \
      mps_reaction reaction;                                                                       \
      memset(&reaction, 0, sizeof reaction);                                                       \
      (void)mps_##S##_get_reaction(s, k, &reaction);                                               \
      hash = seen_bytes(hash, &reaction, sizeof reaction);                                         \
    }                                                                                              \
    *(mps_error *)(uintptr_t)mps_context_error(own) = kept;                                        \
    return hash;                                                                                   \
  }

#endif
