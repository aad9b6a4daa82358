/* removal.c - particles that leave the body (excavation): all that can fail is done before they go,
 * beside the present body, which the new one then replaces. None can come: the lattice is found
 * once. SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_private.h"

#include <string.h>

typedef struct mpsi_elastic_removal {
  int64_t *now;     /* rank after the removal, -1: it goes */
  mps_elastic left; /* the new body; of the rest only its boundaries are its own, lists alone */
} mpsi_elastic_removal;

/* Lists of the particles that boundaries keep; signals stay with the solver. */
static void free_lists(mps_elastic *left) {
  for (int32_t k = 0; k < left->boundary_count && left->boundaries; k++) {
    mpsi_free(left->context, left->boundaries[k].particles);
    mpsi_free(left->context, left->boundaries[k].values);
  }
  mpsi_free(left->context, left->boundaries);
}

void mpsi_elastic_drop_removal(mps_elastic *e) {
  mpsi_elastic_removal *r = e->removal;
  if (!r) return;
  if (r->left.context) {
    free_lists(&r->left);
    mpsi_elastic_free_body(&r->left);
  }
  mpsi_free(e->context, r->now);
  mpsi_free(e->context, r);
  e->removal = NULL;
}

/* ---- making ready -----------------------------------------------------------------------------
 */

static void number(const mps_elastic *e, int64_t count, const int64_t *ids, int64_t *now) {
  int64_t left = 0;
  for (int64_t k = 0; k < count; k++) now[mpsi_elastic_find(e, ids[k])] = -1;
  for (int64_t i = 0; i < e->n; i++)
    if (now[i] >= 0) now[i] = left++;
}

/* What each particle takes along. */
static void carry(const mps_elastic *e, const int64_t *now, mps_elastic *left) {
  const size_t bytes = (size_t)e->dim * sizeof(double);
  for (int64_t i = 0; i < e->n; i++) {
    if (now[i] < 0) continue;
    const int64_t from = i * e->dim, to = now[i] * e->dim;
    left->id[now[i]] = e->id[i];
    left->cut[now[i]] = e->cut[i];
    memcpy(left->x + to, e->x + from, bytes);
    memcpy(left->displacement + to, e->displacement + from, bytes);
    memcpy(left->reaction + to, e->reaction + from, bytes);
  }
}

static mps_status carry_boundaries(const mps_elastic *e, const char *function, const int64_t *now,
                                   mps_elastic *left) {
  left->boundaries = mpsi_alloc(e->context, e->boundary_count, sizeof *left->boundaries);
  if (!left->boundaries)
    return mpsi_fail_memory(e->context, function,
                            (size_t)e->boundary_count * sizeof *e->boundaries);
  left->boundary_count = e->boundary_count;
  for (int32_t k = 0; k < e->boundary_count; k++) {
    const mpsi_elastic_boundary *from = &e->boundaries[k];
    mpsi_elastic_boundary *to = &left->boundaries[k];
    const int64_t each = from->kind == MPS_ELASTIC_BOUNDARY_ROLLER ? 1 : 3;
    *to = *from;
    to->count = 0;
    to->values = NULL;
    to->particles = mpsi_alloc(e->context, from->count, sizeof *to->particles);
    if (from->values) to->values = mpsi_alloc(e->context, from->count * each, sizeof *to->values);
    if (!to->particles || (from->values && !to->values)) {
      left->boundary_count = k + 1;
      return mpsi_fail_memory(e->context, function, (size_t)from->count * sizeof *to->particles);
    }
    for (int64_t p = 0; p < from->count; p++) {
      if (now[from->particles[p]] < 0) continue;
      if (from->values)
        memcpy(to->values + to->count * each, from->values + p * each,
               (size_t)each * sizeof *to->values);
      to->particles[to->count++] = now[from->particles[p]];
    }
  }
  return MPS_OK;
}

static mps_status prepare(mps_elastic *e, const char *function, int64_t count, const int64_t *ids) {
  mpsi_elastic_removal *r = e->removal = mpsi_alloc(e->context, 1, sizeof *r);
  if (!r || !(r->now = mpsi_alloc(e->context, e->n, sizeof *r->now)))
    return mpsi_fail_memory(e->context, function, (size_t)e->n * sizeof *r->now);
  number(e, count, ids, r->now);
  mps_elastic *left = &r->left;
  *left = (mps_elastic){.context = e->context,
                        .particles = e->particles,
                        .def = e->def,
                        .dim = e->dim,
                        .modes = e->modes,
                        .conservative = e->conservative,
                        .constant = e->constant,
                        .n = e->n - count,
                        .spacing = e->spacing};
  if (left->n < 1)
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "all %lld particles of the solver are to go, a body must be left",
                     (long long)e->n);
  mps_status status = mpsi_elastic_allocate(left, function);
  if (status != MPS_OK) return status;
  carry(e, r->now, left);
  status = mpsi_elastic_make_body(left, function);
  if (status == MPS_OK) status = carry_boundaries(e, function, r->now, left);
  return status == MPS_OK ? mpsi_elastic_make_supports(left, function) : status;
}

mps_status mpsi_elastic_remove(void *self, const char *function, int64_t count,
                               const int64_t *ids) {
  mps_elastic *e = self;
  mps_status status = mpsi_guard_check(&e->guard, e->context, function);
  if (status != MPS_OK) return status;
  mpsi_elastic_drop_removal(e);
  status = prepare(e, function, count, ids);
  if (status != MPS_OK) mpsi_elastic_drop_removal(e);
  return status;
}

/* ---- once they have gone ------------------------------------------------------------------------
 */

static void renumber_loads(mps_elastic *e, const int64_t *now) {
  for (int32_t k = 0; k < e->load_count; k++) {
    mpsi_elastic_load *load = &e->loads[k];
    int64_t kept = 0;
    for (int64_t p = 0; load->used && p < load->count; p++) {
      if (now[load->patches[p].particle] < 0) continue;
      load->patches[kept] = load->patches[p];
      load->patches[kept].particle = now[load->patches[p].particle];
      kept++;
    }
    load->count = kept;
  }
}

void mpsi_elastic_renew(void *self) {
  mps_elastic *e = self;
  mpsi_elastic_removal *r = e->removal;
  if (!r) return;
  if (mps_particles_count(e->particles) == r->left.n) { /* nobody refused */
    mpsi_elastic_end_motion(e);
    renumber_loads(e, r->now);
    mps_elastic former = *e;
    *e = r->left;
    e->holder = former.holder; /* the set knows its address */
    e->guard = former.guard;
    e->identity = former.identity;
    e->loads = former.loads, e->load_count = former.load_count;
    e->spare = former.spare, e->spare_capacity = former.spare_capacity;
    e->report = former.report;
    e->removal = r;
    r->left = former; /* signals and material have a share there no more: lists and body only */
  }
  mpsi_elastic_drop_removal(e);
}
