/* change.c - change of the body, by a removal of particles (excavation) or by the restoration of a
 * state. Everything that can fail is done beside the present body, which the new one then replaces.
 * No particles can be added: the lattice is found once.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "change.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"
#include "implicit/life/elastic_body.h"
#include "implicit/operator/moduli.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct mpsi_elastic_change {
  mps_elastic next;           /* the new body; data shared with the solver are not its own */
  mpsi_elastic_motion motion; /* arrays alone, where a motion is restored */
} mpsi_elastic_change;

void mpsi_elastic_drop_change(mps_elastic *e) {
  mpsi_elastic_change *c = e->change;
  if (!c) return;
  if (c->next.context) mpsi_elastic_free_body(&c->next);
  mpsi_elastic_free_arrays(e, &c->motion);
  mpsi_free(e->context, c);
  e->change = NULL;
}

/* ---- making ready ---------------------------------------------------------------------------- */

static mps_status begin(mps_elastic *e, const char *function, int64_t count) {
  mpsi_elastic_drop_change(e);
  mpsi_elastic_change *c = e->change = mpsi_alloc(e->context, 1, sizeof *c);
  if (!c) return mpsi_fail_memory(e->context, function, sizeof *c);
  c->next = (mps_elastic){.base = e->base,
                          .def = e->def,
                          .dim = e->dim,
                          .modes = e->modes,
                          .conservative = e->conservative,
                          .constant = e->constant,
                          .shared = e->shared,
                          .unread = e->unread,
                          .n = count,
                          .spacing = e->spacing};
  const mps_status status = mpsi_elastic_allocate(&c->next, function);
  if (status != MPS_OK || !e->mass) return status;
  c->next.mass = mpsi_alloc(e->context, count, sizeof *c->next.mass);
  return c->next.mass ? MPS_OK
                      : mpsi_fail_memory(e->context, function, (size_t)count * sizeof *e->mass);
}

/* Copies the data of particle i of e to number k of the new body. */
static void carry(const mps_elastic *e, int64_t i, mps_elastic *next, int64_t k) {
  const size_t bytes = (size_t)e->dim * sizeof(double);
  const int64_t from = i * e->dim, to = k * e->dim;
  next->id[k] = e->id[i];
  next->cut[k] = e->cut[i];
  if (e->mass) next->mass[k] = e->mass[i];
  next->lambda[k] = e->lambda[i], next->mu[k] = e->mu[i], next->poisson[k] = e->poisson[i];
  memcpy(next->x + to, e->x + from, bytes);
  memcpy(next->displacement + to, e->displacement + from, bytes);
  memcpy(next->reaction + to, e->reaction + from, bytes);
}

static mps_status finish(mps_elastic *next, const char *function) {
  MPSI_TRY(mpsi_elastic_make_body(next, function, true));
  return mpsi_elastic_make_supports(next, function);
}

static int64_t count_present(const mps_elastic *e, const mpsi_elastic_boundary *b) {
  int64_t present = 0;
  for (int64_t k = 0; k < b->def->id_count; k++)
    present += mpsi_elastic_find(e, b->def->ids[k]) >= 0;
  return present;
}

/* Replaces the present body by the new one, with the caller's definitions. */
static void use(mps_elastic *e) {
  mpsi_elastic_change *c = e->change;
  mps_elastic former = *e;
  *e = c->next;
  e->base = former.base;
  e->within = former.within;
  e->report = former.report;
  e->outside = former.outside;
  e->motion = former.motion, e->ended = former.ended;
  e->change = c;
  c->next = former;
  for (int32_t k = 0; k < mpsi_elastic_boundary_count(e); k++) {
    mpsi_elastic_boundary *b = mpsi_elastic_boundary_of(e, k);
    if (b) b->present = count_present(e, b);
  }
}

/* ---- particles that leave -------------------------------------------------------------------- */

static mps_status prepare_removal(mps_elastic *e, const char *function, int64_t count,
                                  const int64_t *ids) {
  if (count >= e->n)
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "all %lld particles of the solver are to be removed, a body must remain",
                     (long long)e->n);
  mps_status status = begin(e, function, e->n - count);
  uint8_t *gone = mpsi_alloc(e->context, e->n, 1);
  if (status == MPS_OK && !gone) status = mpsi_fail_memory(e->context, function, (size_t)e->n);
  for (int64_t k = 0; status == MPS_OK && k < count; k++) gone[mpsi_elastic_find(e, ids[k])] = 1;
  int64_t left = 0;
  for (int64_t i = 0; status == MPS_OK && i < e->n; i++)
    if (!gone[i]) carry(e, i, &e->change->next, left++);
  mpsi_free(e->context, gone);
  return status == MPS_OK ? finish(&e->change->next, function) : status;
}

mps_status mpsi_elastic_remove(void *self, const char *function, int64_t count,
                               const int64_t *ids) {
  mps_elastic *e = self;
  MPSI_TRY(mpsi_guard_check(&e->guard, e->context, function));
  mps_status status = prepare_removal(e, function, count, ids);
  if (status != MPS_OK) mpsi_elastic_drop_change(e);
  return status;
}

void mpsi_elastic_renew(void *self) {
  mps_elastic *e = self;
  if (!e->change) return;
  if (mps_particles_count(e->particles) == e->change->next.n) { /* no holder has refused */
    mpsi_elastic_suspend_motion(e);
    use(e);
  }
  mpsi_elastic_drop_change(e);
}

/* ---- restoration of a state ------------------------------------------------------------------ */

static const mpsi_value *find_value(const mpsi_values *values, const char *name, int64_t rows) {
  const mpsi_value *value = mpsi_values_find(values, name);
  return value && value->rows == rows ? value : NULL;
}

/* Position, cut and mass of each particle of the state, by rank. */
typedef struct former {
  int64_t count;
  const int64_t *id;  /* in the set's order then */
  const double *x;    /* count * dim */
  const int64_t *cut; /* count */
  const double *mass;
  const double *young, *poisson; /* in the set's order then */
} former;

static bool read_former(const mps_elastic *e, const mps_snapshot *from, former *out) {
  static const char *const vectors[] = {"displacement", "reaction", "velocity", "acceleration",
                                        "force",        "inner",    "held"};
  const int64_t n = from->particles, all = n * e->dim;
  bool good = n > 0;
  for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++)
    good = good && find_value(&from->state, vectors[k], all);
  const mpsi_value *id = find_value(&from->fields, "id", n);
  const mpsi_value *x = find_value(&from->state, "reference", all);
  const mpsi_value *cut = find_value(&from->state, "cut", n);
  const mpsi_value *mass = find_value(&from->state, "mass", n);
  const mpsi_value *young = find_value(&from->fields, "young", n);
  const mpsi_value *poisson = find_value(&from->fields, "poisson", n);
  if (!good || !id || !x || !cut || !mass || !young || !poisson) return false;
  *out = (former){n, id->data, x->data, cut->data, mass->data, young->data, poisson->data};
  for (int64_t k = 0; k < n; k++)
    good = good && out->cut[k] >= 0 && out->cut[k] < 1 << 2 * e->dim && out->mass[k] > 0.0;
  return good;
}

/* Forces and masses of a state are those of its cells: particle i of the body has to have the cuts
 * of the k-th of the state. */
static mps_status check_cut(const mps_elastic *e, int64_t i, const char *function, const former *f,
                            int64_t k, const char *source, mps_status disagreement) {
  if (e->cut[i] == f->cut[k]) return MPS_OK;
  return mpsi_fail(e->context, function, disagreement,
                   "in %s the cell of particle %lld is cut on other sides than in this solver "
                   "(mps_elastic_cut)",
                   source, (long long)e->id[i]);
}

/* Data by ids of the new body: from the present one where it has the particle. */
static mps_status carry_all(mps_elastic *e, const char *function, const former *f,
                            const char *source, mps_status disagreement) {
  mps_elastic *next = &e->change->next;
  const int d = e->dim;
  for (int64_t k = 0; k < next->n; k++) {
    const int64_t i = mpsi_elastic_find(e, next->id[k]);
    if (i < 0) {
      memcpy(next->x + k * d, f->x + k * d, (size_t)d * sizeof *next->x);
      next->cut[k] = (uint8_t)f->cut[k];
      continue;
    }
    if (memcmp(e->x + i * d, f->x + k * d, (size_t)d * sizeof *e->x) != 0)
      return mpsi_fail(e->context, function, disagreement,
                       "in %s the reference position of particle %lld is another than in this "
                       "solver",
                       source, (long long)e->id[i]);
    MPSI_TRY(check_cut(e, i, function, f, k, source, disagreement));
    carry(e, i, next, k);
  }
  /* present moduli, and former ones of restored particles */
  for (int64_t p = 0; p < f->count; p++) {
    if (mpsi_elastic_find(e, f->id[p]) >= 0) continue;
    MPSI_TRY(mpsi_elastic_set_moduli(next, function, mpsi_elastic_find(next, f->id[p]), f->young[p],
                                     f->poisson[p]));
  }
  return MPS_OK;
}

static mps_status prepare_body(mps_elastic *e, const char *function, const former *f,
                               const char *source, mps_status disagreement) {
  MPSI_TRY(begin(e, function, f->count));
  mps_elastic *next = &e->change->next;
  memcpy(next->id, f->id, (size_t)f->count * sizeof *next->id);
  mpsi_elastic_sort_ids(f->count, next->id);
  mps_status status = carry_all(e, function, f, source, disagreement);
  if (status == MPS_OK) status = finish(next, function);
  if (!next->mass) next->mass = mpsi_alloc(e->context, next->n, sizeof *next->mass);
  if (status == MPS_OK && !next->mass)
    status = mpsi_fail_memory(e->context, function, (size_t)next->n * sizeof *next->mass);
  return status == MPS_OK ? mpsi_elastic_allocate_motion(next, function, &e->change->motion)
                          : status;
}

static bool same_body(const mps_elastic *e, const former *f) {
  if (!e->motion || f->count != e->n) return false;
  for (int64_t k = 0; k < f->count; k++)
    if (mpsi_elastic_find(e, f->id[k]) < 0) return false;
  return memcmp(e->x, f->x, (size_t)(e->n * e->dim) * sizeof *e->x) == 0;
}

/* Do boundaries have as many particles as in the state? */
static mps_status check_boundaries(const mps_elastic *e, const mps_elastic *body,
                                   const char *function, const mps_snapshot *from,
                                   const char *source, mps_status disagreement) {
  for (int32_t k = 0; k < mpsi_elastic_boundary_count(e); k++) {
    char name[64];
    if (!mpsi_elastic_boundary_of(e, k)) continue;
    snprintf(name, sizeof name, "boundary%d/particles", k);
    const int64_t then = *(const int64_t *)mpsi_values_find(&from->state, name)->data;
    const int64_t present = count_present(body, mpsi_elastic_boundary_of(e, k));
    if (then != present)
      return mpsi_fail(e->context, function, disagreement,
                       "in %s %s is %lld, in this solver %lld of those particles", source, name,
                       (long long)then, (long long)present);
  }
  const int64_t then = *(const int64_t *)mpsi_values_find(&from->state, "fixed_particles")->data;
  if (then == body->support_count) return MPS_OK;
  return mpsi_fail(e->context, function, disagreement,
                   "in %s fixed_particles is %lld, in this solver %lld", source, (long long)then,
                   (long long)body->support_count);
}

mps_status mpsi_elastic_prepare_state(void *self, const char *function, const mps_snapshot *from,
                                      const char *source, mps_status disagreement) {
  mps_elastic *e = self;
  former f;
  mpsi_elastic_drop_change(e);
  if (!read_former(e, from, &f))
    return mpsi_fail(e->context, function, MPS_ERROR_FORMAT,
                     "%s is malformed: values that are not of its particles", source);
  mps_status status = MPS_OK;
  if (!same_body(e, &f)) status = prepare_body(e, function, &f, source, disagreement);
  for (int64_t k = 0; k < f.count && !e->change && status == MPS_OK; k++)
    status = check_cut(e, k, function, &f, k, source, disagreement);
  if (status == MPS_OK)
    status =
        check_boundaries(e, e->change ? &e->change->next : e, function, from, source, disagreement);
  if (status != MPS_OK) mpsi_elastic_drop_change(e);
  return status;
}

void mpsi_elastic_bind(void *self) {
  mps_elastic *e = self;
  if (e->motion) e->motion->strain_known = false;
  if (!e->change) return;
  use(e);
  if (e->motion) mpsi_elastic_free_arrays(e, e->motion);
  if (!e->motion) e->motion = e->ended;
  e->ended = NULL;
  mpsi_elastic_move_arrays(&e->change->motion, e->motion);
  e->motion->strain_known = false;
  mpsi_elastic_drop_change(e);
}
