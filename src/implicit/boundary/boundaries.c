/* boundaries.c - prescribed displacements: boundaries become rows of supports (supports.c), are
 * driven by signals, and sum their reactions.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "boundaries.h"
#include "implicit/base/implicit_solver.h"

#include "signal/signal_internal.h"

#include <string.h>

/* ---- definitions ----------------------------------------------------------------------------- */

/* Values of each particle: a roller has one, along its normal. */
static int32_t each(const void *known, int32_t list) {
  const mps_elastic_boundary_def *def = known;
  return list == 0 || def->kind == MPS_BOUNDARY_ROLLER ? 1 : 3;
}

static double length_of(const mps_elastic *e, const double *normal) {
  double square = 0.0;
  for (int c = 0; c < e->dim; c++) square += normal[c] * normal[c];
  return sqrt(square);
}

static mps_status check(void *solver, const char *function, int32_t number, const void *known) {
  const mps_elastic *e = solver;
  const mps_elastic_boundary_def *def = known;
  const uint32_t all = e->dim == 2 ? MPS_DOF_X | MPS_DOF_Y : MPS_DOF_X | MPS_DOF_Y | MPS_DOF_Z;
  const double length = length_of(e, def->normal);
  if (def->kind == MPS_BOUNDARY_ROLLER &&
      !(isfinite(length) && length > 1e-150)) /* its square must not underflow */
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "normal has the length %g, must be finite and not zero", length);
  if (def->kind != MPS_BOUNDARY_ROLLER && (def->dofs & ~all))
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "dofs is %u, allowed are MPS_DOF_X, MPS_DOF_Y%s, or-ed, and 0 for all",
                     def->dofs, e->dim == 3 ? ", MPS_DOF_Z" : "");
  return MPS_OK;
}

static bool item(const void *solver, const void *def, int64_t k, double x[3], int64_t *id) {
  const mps_elastic *e = solver;
  if (k >= e->n) return false;
  memcpy(x, &e->x[k * e->dim], (size_t)e->dim * sizeof *x);
  *id = e->id[k];
  return true;
}

static mps_status check_ids(void *solver, const char *function, const void *def, int64_t count,
                            const int64_t *ids) {
  const mps_elastic *e = solver;
  for (int64_t i = 0; i < count; i++)
    if (mpsi_elastic_find(e, ids[i]) < 0)
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld: no particle of the solver has that id", (long long)i,
                       (long long)ids[i]);
  return MPS_OK;
}

static mps_status make(void *solver, const char *function, int32_t number, void *known, void *own) {
  const mps_elastic *e = solver;
  const mps_elastic_boundary_def *def = known;
  mpsi_elastic_boundary *b = own;
  b->def = def;
  b->dofs = def->dofs ? def->dofs : MPS_DOF_X | MPS_DOF_Y | (e->dim == 3 ? MPS_DOF_Z : 0);
  b->present = def->id_count;
  const double length = length_of(e, def->normal);
  for (int c = 0; c < e->dim && def->kind == MPS_BOUNDARY_ROLLER; c++)
    b->normal[c] = def->normal[c] / length;
  return MPS_OK;
}

/* ---- supports from boundaries ---------------------------------------------------------------- */

typedef struct new_supports {
  mpsi_support *supports;
  int64_t count, *of;
} new_supports;

static mps_status add_boundary_rows(const mps_elastic *e, const char *function, int32_t number,
                                    new_supports *to) {
  const mpsi_elastic_boundary *b = mpsi_elastic_boundary_of(e, number);
  if (!b) return MPS_OK;
  const double *values = b->def->values;
  const bool roller = b->def->kind == MPS_BOUNDARY_ROLLER;
  for (int64_t k = 0; k < b->def->id_count; k++) {
    const int64_t i = mpsi_elastic_find(e, b->def->ids[k]);
    if (i < 0) continue;
    if (to->of[i] < 0) {
      to->supports[to->count].particle = i;
      to->of[i] = to->count++;
    }
    for (int c = 0; c < (roller ? 1 : e->dim); c++) {
      const double axis[3] = {c == 0, c == 1, c == 2}, *normal = roller ? b->normal : axis;
      if (!roller && !(b->dofs >> c & 1)) continue;
      const double offset = !values ? 0.0 : values[roller ? k : 3 * k + c];
      if (!mpsi_elastic_add_row(&to->supports[to->of[i]], e->dim, normal, offset, number, c))
        return mpsi_fail(e->context, function, MPS_ERROR_STATE,
                         "direction (%g, %g, %g) of particle %lld is already fixed by its other "
                         "boundaries",
                         normal[0], normal[1], normal[2], (long long)e->id[i]);
    }
  }
  return MPS_OK;
}

/* Are the same directions fixed? Then the pattern of the matrix and its factor are kept. */
static bool same_directions(const mps_elastic *e, const new_supports *s) {
  if (s->count != e->support_count) return false;
  for (int64_t i = 0; i < e->n; i++) {
    if ((s->of[i] < 0) != (e->support_of[i] < 0)) return false;
    if (s->of[i] < 0) continue;
    const mpsi_support *a = &s->supports[s->of[i]], *b = &e->supports[e->support_of[i]];
    if (a->count != b->count || memcmp(a->basis, b->basis, sizeof a->basis) != 0) return false;
  }
  return true;
}

mps_status mpsi_elastic_make_supports(mps_elastic *e, const char *function) {
  int64_t capacity = 0;
  for (int32_t k = 0; k < mpsi_elastic_boundary_count(e); k++)
    if (mpsi_elastic_boundary_of(e, k)) capacity += mpsi_elastic_boundary_of(e, k)->def->id_count;
  if (capacity > e->n) capacity = e->n;
  new_supports s = {.count = 0};
  mps_status status = MPS_OK;
  if (!(s.supports = mpsi_alloc(e->context, capacity, sizeof *s.supports)) ||
      !(s.of = mpsi_alloc(e->context, e->n, sizeof *s.of)))
    status = mpsi_fail_memory(e->context, function, (size_t)e->n * sizeof *s.of);
  for (int64_t i = 0; s.of && i < e->n; i++) s.of[i] = -1;
  for (int32_t k = 0; k < mpsi_elastic_boundary_count(e) && status == MPS_OK; k++)
    status = add_boundary_rows(e, function, k, &s);
  if (status != MPS_OK) {
    MPSI_FREE(e->context, s.supports, s.of);
    return status;
  }
  if (!same_directions(e, &s)) e->pattern_valid = false;
  MPSI_FREE(e->context, e->supports, e->support_of);
  e->supports = s.supports;
  e->support_of = s.of;
  e->support_count = s.count;
  e->fabric_known = false;
  return MPS_OK;
}

/* ---- what the caller does -------------------------------------------------------------------- */

static mps_status apply(void *solver, const char *function, int32_t number, void *def, void *own,
                        void *former) {
  mps_elastic *e = solver;
  void **const slot = &e->conditions[MPSI_BOUNDARIES].own[number];
  if (own && former)
    ((mpsi_elastic_boundary *)own)->reaction = ((mpsi_elastic_boundary *)former)->reaction;
  *slot = own;
  const mps_status status = mpsi_elastic_make_supports(e, function);
  const mps_status all = mpsi_elastic_agree(e, function, status);
  if (all == MPS_OK) return MPS_OK;
  *slot = former;
  if (status == MPS_OK) (void)mpsi_elastic_make_supports(e, function); /* another rank failed */
  return all;
}

const mpsi_condition_kind mpsi_elastic_boundaries = {
    MPSI_CONDITION_OF(ELASTIC, elastic, BOUNDARY, boundary),
    .role = MPSI_SIGNAL_MOTION,
    .list = {{"ids", "id_count", 1}, {"values", "id_count", 3}},
    .most = INT32_MAX - 8,
    .size = sizeof(mpsi_elastic_boundary),
    .each = each,
    .check = check,
    .item = item,
    .selects = true,
    .check_ids = check_ids,
    .make = make,
    .apply = apply,
};

mps_status mpsi_elastic_get_reaction(void *solver, const char *function, mps_status status,
                                     int32_t number, mps_reaction *out) {
  if (status == MPS_OK) *out = mpsi_elastic_boundary_of(solver, number)->reaction;
  return status;
}

/* ---- driving --------------------------------------------------------------------------------- */

static mps_status evaluate_signals(mps_elastic *e, const char *function, double t,
                                   bool *by_caller) {
  for (int32_t k = 0; k < mpsi_elastic_boundary_count(e); k++) {
    mpsi_elastic_boundary *b = mpsi_elastic_boundary_of(e, k);
    for (int c = 0; b && c < e->dim; c++) {
      const mps_signal *signal = b->def->signal[c];
      const double factor = b->def->factor[c];
      mpsi_signal_motion m;
      const mpsi_signal_use use = {e->context, function, "boundary", k, c};
      const mps_status status = mpsi_signal_evaluate(signal, use, t, &m);
      *by_caller = *by_caller || mpsi_signal_may_fail(signal);
      if (status != MPS_OK) return status;
      b->motion[0][c] = factor * m.u;
      b->motion[1][c] = factor * m.v;
      b->motion[2][c] = factor * m.a;
    }
  }
  return MPS_OK;
}

/* Motions of all boundaries at time t. Functions of the caller may differ between ranks. */
static mps_status find_motions(mps_elastic *e, const char *function, double t) {
  bool by_caller = false;
  const mps_status status = evaluate_signals(e, function, t, &by_caller);
  mpsi_given list = MPSI_GIVEN;
  if (!by_caller) return status;
  for (int32_t k = 0; status == MPS_OK && k < mpsi_elastic_boundary_count(e); k++)
    for (int m = 0; mpsi_elastic_boundary_of(e, k) && m < 3; m++)
      mpsi_give_vector(&list, "the motion of a boundary", 3,
                       mpsi_elastic_boundary_of(e, k)->motion[m]);
  return mpsi_elastic_agree_given(e, function, status, &list);
}

mps_status mpsi_elastic_drive(mps_elastic *e, const char *function, double t) {
  MPSI_TRY(find_motions(e, function, t));
  for (int64_t k = 0; k < e->support_count; k++) {
    mpsi_support *s = &e->supports[k];
    for (int derivative = 0; derivative < 3; derivative++)
      for (int32_t r = 0; r < s->count; r++) {
        double value = mpsi_elastic_boundary_of(e, s->owner[r])->motion[derivative][s->signal[r]];
        if (derivative == 0) value += s->offset[r];
        for (int32_t c = 0; c < r; c++)
          value -= mpsi_elastic_row(s, r, c) * s->fixed[derivative][c];
        s->fixed[derivative][r] = value / mpsi_elastic_row(s, r, r);
      }
  }
  return MPS_OK;
}

/* ---- what boundaries exert ------------------------------------------------------------------- */

/* The force f on a particle as forces along the normals of its rows: f = sum_r part[r] normal_r. */
static void split(const mpsi_support *s, int d, const double *f, double *part) {
  for (int32_t r = s->count - 1; r >= 0; r--) {
    double rest = 0.0;
    for (int c = 0; c < d; c++) rest += f[c] * s->basis[r][c];
    for (int32_t q = r + 1; q < s->count; q++) rest -= part[q] * mpsi_elastic_row(s, q, r);
    part[r] = rest / mpsi_elastic_row(s, r, r);
  }
}

void mpsi_elastic_count_reactions(mps_elastic *e, double dt) {
  const int d = e->dim;
  for (int32_t k = 0; k < mpsi_elastic_boundary_count(e); k++) {
    mpsi_elastic_boundary *b = mpsi_elastic_boundary_of(e, k);
    if (!b) continue;
    mps_reaction *q = &b->reaction;
    q->count = b->present;
    for (int c = 0; c < 3; c++) {
      q->impulse[c] += 0.5 * dt * q->force[c];
      q->moment_impulse[c] += 0.5 * dt * q->moment[c];
      q->force[c] = q->moment[c] = 0.0;
    }
  }
  for (int64_t k = 0; k < e->support_count; k++) {
    const mpsi_support *s = &e->supports[k];
    double part[3], x[3] = {0.0, 0.0, 0.0};
    split(s, d, e->reaction + s->particle * d, part);
    for (int c = 0; c < d; c++) x[c] = e->x[s->particle * d + c];
    for (int32_t r = 0; r < s->count; r++) {
      mps_reaction *q = &mpsi_elastic_boundary_of(e, s->owner[r])->reaction;
      double f[3];
      for (int c = 0; c < 3; c++) f[c] = part[r] * s->normal[r][c];
      for (int c = 0; c < 3; c++) {
        const int a = (c + 1) % 3, b = (c + 2) % 3;
        q->force[c] += f[c];
        q->moment[c] += x[a] * f[b] - x[b] * f[a];
      }
    }
  }
  for (int32_t k = 0; k < mpsi_elastic_boundary_count(e); k++) {
    if (!mpsi_elastic_boundary_of(e, k)) continue;
    mps_reaction *q = &mpsi_elastic_boundary_of(e, k)->reaction;
    for (int c = 0; c < 3; c++) {
      q->impulse[c] += 0.5 * dt * q->force[c];
      q->moment_impulse[c] += 0.5 * dt * q->moment[c];
    }
  }
}

double mpsi_elastic_count_work(mps_elastic *e, const double *force, const double *du,
                               const double *v0, const double *v1) {
  const int d = e->dim;
  double total = 0.0;
  for (int64_t k = 0; k < e->support_count; k++) {
    const mpsi_support *s = &e->supports[k];
    const int64_t at = s->particle * d;
    double part[3];
    split(s, d, force + at, part);
    for (int32_t r = 0; r < s->count; r++) {
      double along = 0.0, before = 0.0, after = 0.0;
      for (int c = 0; c < d; c++) {
        along += s->normal[r][c] * du[at + c];
        before += v0 ? s->basis[r][c] * v0[at + c] : 0.0;
        after += v1 ? s->basis[r][c] * v1[at + c] : 0.0;
      }
      double work = part[r] * along;
      if (v0) work += 0.5 * e->mass[s->particle] * (after * after - before * before);
      mpsi_elastic_boundary_of(e, s->owner[r])->reaction.work += work;
      total += work;
    }
  }
  return total;
}

void mpsi_elastic_forget_reactions(mps_elastic *e) {
  for (int32_t k = 0; k < mpsi_elastic_boundary_count(e); k++)
    if (mpsi_elastic_boundary_of(e, k))
      mpsi_elastic_boundary_of(e, k)->reaction = (mps_reaction){.count = 0};
}
