/* mpm_ranks.h - WLS-MPM on several ranks: bodies that move through the grid, and what each rank ends
 * with. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_MPM_RANKS_H
#define MPS_TEST_MPM_RANKS_H

#include "test_common.h"

#include <mps/mpm.h>

enum { SLIDE, SCENES };

#define MOST_FIELDS 24

/* What a run ends with: of one rank, or without a domain. */
typedef struct result {
  mps_status status;
  char message[512];
  int64_t count, first, *id; /* first: particles at the beginning */
  int32_t fields;
  mps_field_info field[MOST_FIELDS];
  double *value[MOST_FIELDS];
  mps_totals totals;
  mps_reaction reaction[8];
  double dt, limit, time;
} result;

#define TRY(call)                                                                                  \
  do {                                                                                             \
    if (status == MPS_OK) status = (call);                                                         \
  } while (0)

typedef struct scene {
  mps_particles *set;
  mps_material *material[2];
  mps_mpm *mpm;
} scene;

static inline mps_status make_set(mps_context *own, int what, mps_particles **out) {
  (void)what;
  mps_particles_def def = mps_particles_defaults();
  def.spacing = 0.02;
  def.origin[0] = def.origin[1] = 0.01;
  mps_status status = mps_particles_create(own, &def, out);
  const double lo[3] = {0.0, 0.0}, hi[3] = {1.2, 0.8};
  TRY(mps_particles_fill_box(*out, lo, hi, NULL));
  TRY(mps_particles_set(*out, "density", 0, 1800.0));
  TRY(mps_particles_set(*out, "velocity", 0, 0.0));
  mps_view x;
  mps_edit v;
  TRY(mps_particles_view(*out, "position", &x));
  TRY(mps_particles_edit(*out, "velocity", &v));
  for (int64_t k = 0; status == MPS_OK && k < mps_particles_count(*out); k++)
    for (int c = 0; c < 2; c++)
      *mps_edit_f64(&v, k, c) = c == 0 ? 6.0 + 2.0 * sin(5.0 * *mps_view_f64(&x, k, 1))
                                       : 1.0 + 2.0 * cos(4.0 * *mps_view_f64(&x, k, 0));
  TRY(mps_particles_commit(*out, &v));
  return status;
}

static inline mps_status make_scene(mps_context *own, mps_domain *domain, int what, scene *s) {
  mps_mpm_def def = mps_mpm_defaults();
  def.domain = domain;
  def.cell = 0.04;
  def.lower[0] = def.lower[1] = 0.0;
  def.upper[0] = 2.4;
  def.gravity[1] = -9.81;
  def.dt = 1e-4;
  mps_status status = make_set(own, what, &s->set);
  TRY(mps_material_linear_elastic(own, 1e6, 0.3, &s->material[0]));
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_mpm_create(own, s->set, s->material[0], &def, &s->mpm));
  return status;
}

static inline void end_scene(scene *s) {
  mps_mpm_destroy(&s->mpm);
  mps_particles_destroy(&s->set);
  for (int k = 0; k < 2; k++) mps_material_destroy(&s->material[k]);
}

static inline mps_status keep(mps_particles *set, result *r) {
  mps_status status = MPS_OK;
  mps_view view;
  r->count = mps_particles_count(set);
  r->id = malloc((size_t)r->count * sizeof *r->id + 8);
  TRY(mps_particles_view(set, "id", &view));
  for (int64_t k = 0; status == MPS_OK && k < r->count; k++) r->id[k] = *mps_view_i64(&view, k, 0);
  const int32_t fields = mps_particles_field_count(set);
  for (int32_t f = 0; f < fields && f < MOST_FIELDS; f++) {
    mps_field_info *info = &r->field[f];
    TRY(mps_particles_field(set, f, info));
    if (status != MPS_OK) break;
    r->value[f] = calloc((size_t)(r->count * info->components) + 1, sizeof(double));
    TRY(mps_particles_view(set, info->name, &view));
    for (int32_t c = 0; status == MPS_OK && c < info->components; c++)
      for (int64_t k = 0; k < r->count; k++)
        memcpy(&r->value[f][k * info->components + c],
               (const char *)view.data + 8 * (c * view.stride[1] + k), 8);
    r->fields = f + 1;
  }
  return status;
}

static inline void drop(result *r) {
  free(r->id);
  for (int f = 0; f < MOST_FIELDS; f++) free(r->value[f]);
}

static inline mps_status compute(mps_context *own, mps_domain *domain, int what, int64_t steps,
                                 result *r) {
  scene s = {.set = NULL};
  mps_status status = make_scene(own, domain, what, &s);
  r->first = s.set ? mps_particles_count(s.set) : 0;
  TRY(mps_mpm_step(s.mpm, steps / 2));
  TRY(mps_mpm_run(s.mpm, mps_mpm_time(s.mpm) + (double)(steps - steps / 2) * 1e-4, 10, NULL, NULL));
  r->dt = mps_mpm_dt(s.mpm), r->limit = mps_mpm_limit(s.mpm), r->time = mps_mpm_time(s.mpm);
  TRY(keep(s.set, r));
  end_scene(&s);
  return status;
}

static inline void compare(const result *alone, const result *rank, int64_t *seen) {
  mps_assert_near(rank->dt, alone->dt, 0.0);
  mps_assert_near(rank->limit, alone->limit, 0.0);
  mps_assert_near(rank->time, alone->time, 0.0);
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
    for (int f = 0; f < alone->fields; f++) {
      const size_t n = (size_t)alone->field[f].components;
      const double *a = alone->value[f] + (size_t)at[rank->id[k]] * n;
      const double *b = rank->value[f] + (size_t)k * n;
      if (memcmp(a, b, n * sizeof(double)) != 0)
        fail_msg("%s of particle %lld: %.17g, expected %.17g", alone->field[f].name,
                 (long long)rank->id[k], b[0], a[0]);
    }
  }
  free(at);
  assert_memory_equal(&rank->totals, &alone->totals, sizeof alone->totals);
  assert_memory_equal(rank->reaction, alone->reaction, sizeof alone->reaction);
}

#endif
