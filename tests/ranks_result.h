/* ranks_result.h - what a run ends with, on one rank of several or without a domain, and how the
 * two are compared: bit for bit, and no particle lost. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_RANKS_RESULT_H
#define MPS_TEST_RANKS_RESULT_H

#include "test_common.h"

#define RESULT_FIELDS 96
#define RESULT_OTHERS 160

typedef struct result {
  mps_status status;
  char message[512];
  int64_t count, first, *id; /* first: particles at the beginning */
  int32_t fields;
  struct {
    char name[64];
    int32_t components;
  } field[RESULT_FIELDS];
  double *value[RESULT_FIELDS];
  mps_totals totals;
  mps_reaction reaction[8];
  double other[RESULT_OTHERS]; /* the scene's own */
  double dt, limit, omega, time;
} result;

/* A run of `length`, whatever that means to the scene; `domain` NULL: without one. */
typedef mps_status result_fn(mps_context *own, mps_domain *domain, int what, int64_t length,
                             result *r);

/* Keeps the ids and all fields of a set; every field has 8 bytes a value. */
static inline mps_status keep(mps_particles *set, result *r) {
  mps_status status = MPS_OK;
  mps_view view;
  r->count = mps_particles_count(set);
  r->id = malloc((size_t)r->count * sizeof *r->id + 8);
  TRY(mps_particles_view(set, "id", &view));
  for (int64_t k = 0; status == MPS_OK && k < r->count; k++) r->id[k] = *mps_view_i64(&view, k, 0);
  const int32_t fields = mps_particles_field_count(set);
  if (fields > RESULT_FIELDS) return MPS_ERROR_INTERNAL;
  for (int32_t f = 0; f < fields; f++) {
    mps_particles_field_info info;
    TRY(mps_particles_get_field_info(set, f, &info));
    if (status != MPS_OK) break;
    snprintf(r->field[f].name, sizeof r->field[f].name, "%s", info.name);
    r->field[f].components = info.components;
    r->value[f] = calloc((size_t)(r->count * info.components) + 1, sizeof(double));
    r->fields = f + 1;
    TRY(mps_particles_view(set, info.name, &view));
    for (int32_t c = 0; status == MPS_OK && c < info.components; c++)
      for (int64_t k = 0; k < r->count; k++)
        memcpy(&r->value[f][k * info.components + c],
               (const char *)view.data + 8 * (c * view.stride[1] + k), 8);
  }
  return status;
}

static inline void drop(result *r) {
  free(r->id);
  for (int f = 0; f < RESULT_FIELDS; f++) free(r->value[f]);
}

/* The values of a field that both have, which need not lie in the same place. */
static inline const double *field_of(const result *r, const char *name) {
  for (int32_t f = 0; f < r->fields; f++)
    if (strcmp(r->field[f].name, name) == 0) return r->value[f];
  fail_msg("one of the sets has no field %s", name);
  return NULL;
}

/* The same bits in `bytes` of numbers, of which the message names the first that differs. */
static inline void compare_numbers(const char *what, const void *got, const void *expected,
                                   size_t bytes) {
  for (size_t k = 0; k < bytes / sizeof(double); k++) {
    double a, b;
    memcpy(&a, (const char *)got + k * sizeof a, sizeof a);
    memcpy(&b, (const char *)expected + k * sizeof b, sizeof b);
    if (memcmp(&a, &b, sizeof a) != 0)
      fail_msg("%s, number %zu of it: %.17g on the rank, %.17g without ranks", what, k, a, b);
  }
}

/* The particles of one rank have the bits of the run without a domain; `seen` of each goes up.
 * Fields come first, as their names say most about what is wrong. */
static inline void compare(const result *alone, const result *rank, int64_t *seen) {
  assert_int_equal(rank->fields, alone->fields);
  int64_t most = 0;
  for (int64_t k = 0; k < alone->count; k++) most = alone->id[k] > most ? alone->id[k] : most;
  int64_t *at = malloc((size_t)(most + 1) * sizeof *at);
  for (int64_t k = 0; k <= most; k++) at[k] = -1;
  for (int64_t k = 0; k < alone->count; k++) at[alone->id[k]] = k;
  for (int64_t k = 0; k < rank->count; k++) {
    if (rank->id[k] > most || at[rank->id[k]] < 0)
      fail_msg("particle %lld is on a rank only", (long long)rank->id[k]);
    seen[at[rank->id[k]]]++;
  }
  for (int f = 0; f < alone->fields; f++) {
    const size_t n = (size_t)alone->field[f].components;
    const double *values = field_of(rank, alone->field[f].name);
    for (int64_t k = 0; k < rank->count; k++) {
      const double *a = alone->value[f] + (size_t)at[rank->id[k]] * n, *b = values + (size_t)k * n;
      if (memcmp(a, b, n * sizeof(double)) != 0)
        fail_msg("%s of particle %lld: %.17g on the rank, %.17g without ranks",
                 alone->field[f].name, (long long)rank->id[k], b[0], a[0]);
    }
  }
  free(at);
  NEAR(rank->time, alone->time, 0.0);
  NEAR(rank->dt, alone->dt, 0.0);
  NEAR(rank->limit, alone->limit, 0.0);
  NEAR(rank->omega, alone->omega, 0.0);
  compare_numbers("mps_totals", &rank->totals, &alone->totals, sizeof alone->totals);
  compare_numbers("mps_reaction", rank->reaction, alone->reaction, sizeof alone->reaction);
  compare_numbers("other results of the scene", rank->other, alone->other, sizeof alone->other);
}

/* On the ranks of mpirun: each computes the body alone, then all of them together, and compares; no
 * particle is lost, and totals distinguish two from one. */
static inline void compare_shares(mps_context *own, mps_domain *domain, result_fn *run, int what,
                                  int64_t length) {
  SCOPED(drop) result alone = {0}, share = {0};
  OK(run(own, NULL, what, length, &alone));
  OK(run(own, domain, what, length, &share));
  int64_t *seen = calloc((size_t)alone.count + 1, sizeof *seen);
  compare(&alone, &share, seen);
  for (int64_t first = 0; first < alone.count; first += 64) { /* none is lost */
    double most[64] = {0.0};
    const int64_t count = alone.count - first < 64 ? alone.count - first : 64;
    for (int64_t k = 0; k < count; k++) most[k] = (double)seen[first + k];
    OK(mps_domain_max(domain, 64, most));
    for (int64_t k = 0; k < count; k++) NEAR(most[k], 1.0, 0.0);
  }
  free(seen);
}

#endif
