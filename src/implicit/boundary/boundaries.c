/* boundaries.c - prescribed displacements: boundaries become rows of supports (supports.c), are
 * driven by signals, and sum their reactions.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/base/defs.h"
#include "boundaries.h"
#include "implicit/base/implicit_solver.h"

#include "core/base/boundary_kind.h"
#include "core/context/retain.h"
#include "signal/signal_internal.h"

#include <string.h>

/* ---- definitions ----------------------------------------------------------------------------- */

static mps_status check_ids(const mps_elastic *e, const char *function, int64_t count,
                            const int64_t *ids) {
  if (count < 0 || (count > 0 && !ids))
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     count < 0 ? "id_count is %lld, must be >= 0" : "ids is NULL, id_count is %lld",
                     (long long)count);
  for (int64_t i = 0; i < count; i++)
    if (mpsi_elastic_find(e, ids[i]) < 0)
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld: no particle of the solver has that id", (long long)i,
                       (long long)ids[i]);
  return MPS_OK;
}

static bool has_box(const mps_elastic *e, const mps_elastic_boundary_def *def) {
  bool any = false;
  for (int c = 0; c < e->dim; c++) any |= !isnan(def->lower[c]) || !isnan(def->upper[c]);
  return any;
}

static mps_status check_place(const mps_elastic *e, const char *function,
                              const mps_elastic_boundary_def *def) {
  const bool box = has_box(e, def);
  if (box == (def->ids != NULL || def->id_count != 0))
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT, "%s",
                     box ? "both ids and a box (lower, upper) are given"
                         : "neither ids nor a box (lower, upper) is given");
  if (!box) return check_ids(e, function, def->id_count, def->ids);
  for (int c = 0; c < e->dim; c++)
    if (!(def->lower[c] <= def->upper[c]))
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "the box reaches from %g to %g m along %c", def->lower[c], def->upper[c],
                       "xyz"[c]);
  if (def->values)
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "values belong to particles of `ids`, not to a box");
  return MPS_OK;
}

static mps_status check_kind(const mps_elastic *e, const char *function,
                             const mps_elastic_boundary_def *def) {
  const uint32_t all = e->dim == 2 ? MPS_DOF_X | MPS_DOF_Y : MPS_DOF_X | MPS_DOF_Y | MPS_DOF_Z;
  double square = 0.0;
  if (!mpsi_boundary_kind_in(def->kind, 1u << MPS_BOUNDARY_HELD | 1u << MPS_BOUNDARY_DRIVEN |
                                            1u << MPS_BOUNDARY_ROLLER))
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "kind is %d (%s), implicit elasticity has 0 (HELD), 1 (DRIVEN) and 2 (ROLLER)",
                     def->kind, mpsi_boundary_kind_name(def->kind));
  if (def->kind == MPS_BOUNDARY_HELD &&
      (def->values || def->signal[0] || def->signal[1] || (e->dim == 3 && def->signal[2])))
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "a held boundary takes no %s: make its kind DRIVEN",
                     def->values ? "values" : "signal");
  for (int c = 0; c < e->dim; c++) square += def->normal[c] * def->normal[c];
  if (def->kind == MPS_BOUNDARY_ROLLER &&
      !(isfinite(square) && sqrt(square) > 1e-150)) /* its square must not underflow */
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "the length of normal is %g, must be finite and > 0", sqrt(square));
  if (def->kind != MPS_BOUNDARY_ROLLER && (def->dofs & ~all))
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "dofs is %u: a particle has only MPS_DOF_X, Y%s", def->dofs,
                     e->dim == 3 ? ", Z" : "");
  for (int c = 0; c < 3; c++)
    if (!isfinite(def->factor[c]))
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT, "factor[%d] is %g, must be finite",
                       c, def->factor[c]);
  const int64_t each = def->kind == MPS_BOUNDARY_ROLLER ? 1 : 3;
  for (int64_t k = 0; def->values && k < def->id_count * each; k++)
    if (!isfinite(def->values[k]) && k % each < e->dim)
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "values[%lld] is %g, must be finite (m)", (long long)k, def->values[k]);
  return MPS_OK;
}

static void release(mps_elastic *e, mpsi_elastic_boundary *b) {
  mpsi_free(e->context, b->id);
  mpsi_free(e->context, b->values);
  for (int c = 0; c < 3; c++) mps_signal_destroy(&b->signal[c]);
  *b = (mpsi_elastic_boundary){.used = false};
}

static bool in_box(const mps_elastic *e, const mps_elastic_boundary_def *def, int64_t i) {
  bool inside = true;
  for (int c = 0; c < e->dim; c++)
    inside =
        inside && e->x[i * e->dim + c] >= def->lower[c] && e->x[i * e->dim + c] <= def->upper[c];
  return inside;
}

/* The particles of a box, to `ids` where it is not NULL; how many. */
static int64_t list_box(const mps_elastic *e, const mps_elastic_boundary_def *def, int64_t *ids) {
  int64_t count = 0;
  for (int64_t i = 0; i < e->n; i++) {
    if (!in_box(e, def, i)) continue;
    if (ids) ids[count] = e->id[i];
    count++;
  }
  return count;
}

static mps_status make(mps_elastic *e, const char *function, const mps_elastic_boundary_def *user,
                       mpsi_elastic_boundary *out) {
  mps_elastic_boundary_def def = mpsi_elastic_boundary_defaults;
  mps_status status = MPSI_DEF_READ(e->context, function, mps_elastic_boundary_def, user, &def);
  if (status == MPS_OK) status = check_kind(e, function, &def);
  if (status == MPS_OK) status = check_place(e, function, &def);
  if (status != MPS_OK) return status;
  const bool box = has_box(e, &def), roller = def.kind == MPS_BOUNDARY_ROLLER;
  const int64_t each = roller ? 1 : 3;
  const uint32_t all = MPS_DOF_X | MPS_DOF_Y | (e->dim == 3 ? MPS_DOF_Z : 0);
  mpsi_elastic_boundary b = {.used = true, .kind = def.kind, .dofs = def.dofs ? def.dofs : all};
  b.count = box ? list_box(e, &def, NULL) : def.id_count;
  if (!(b.id = mpsi_alloc(e->context, b.count, sizeof *b.id)) ||
      (def.values && !(b.values = mpsi_alloc(e->context, b.count * each, sizeof *b.values)))) {
    mpsi_free(e->context, b.id);
    return mpsi_fail_memory(e->context, function, (size_t)b.count * sizeof *b.id);
  }
  if (box)
    list_box(e, &def, b.id);
  else
    for (int64_t k = 0; k < b.count; k++) b.id[k] = def.ids[k];
  b.present = b.count;
  if (def.values) memcpy(b.values, def.values, (size_t)(b.count * each) * sizeof *b.values);
  double length = 0.0;
  for (int c = 0; c < e->dim; c++) length += def.normal[c] * def.normal[c];
  for (int c = 0; c < 3; c++) {
    b.normal[c] = roller && c < e->dim ? def.normal[c] / sqrt(length) : 0.0;
    b.factor[c] = def.factor[c];
    if (def.signal[c] && c < e->dim) b.signal[c] = mpsi_signal_retain(def.signal[c]);
  }
  *out = b;
  return MPS_OK;
}

/* ---- supports from boundaries ---------------------------------------------------------------- */

typedef struct new_supports {
  mpsi_support *supports;
  int64_t count, *of;
} new_supports;

static mps_status add_boundary_rows(const mps_elastic *e, const char *function, int32_t number,
                                    new_supports *to) {
  const mpsi_elastic_boundary *b = &e->boundaries[number];
  const bool roller = b->kind == MPS_BOUNDARY_ROLLER;
  for (int64_t k = 0; b->used && k < b->count; k++) {
    const int64_t i = mpsi_elastic_find(e, b->id[k]);
    if (i < 0) continue;
    if (to->of[i] < 0) {
      to->supports[to->count].particle = i;
      to->of[i] = to->count++;
    }
    for (int c = 0; c < (roller ? 1 : e->dim); c++) {
      const double axis[3] = {c == 0, c == 1, c == 2}, *normal = roller ? b->normal : axis;
      if (!roller && !(b->dofs >> c & 1)) continue;
      const double offset = !b->values ? 0.0 : b->values[roller ? k : 3 * k + c];
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
  int64_t room = 0;
  for (int32_t k = 0; k < e->boundary_count; k++)
    if (e->boundaries[k].used) room += e->boundaries[k].count;
  if (room > e->n) room = e->n;
  new_supports s = {.count = 0};
  mps_status status = MPS_OK;
  if (!(s.supports = mpsi_alloc(e->context, room, sizeof *s.supports)) ||
      !(s.of = mpsi_alloc(e->context, e->n, sizeof *s.of)))
    status = mpsi_fail_memory(e->context, function, (size_t)e->n * sizeof *s.of);
  for (int64_t i = 0; s.of && i < e->n; i++) s.of[i] = -1;
  for (int32_t k = 0; k < e->boundary_count && status == MPS_OK; k++)
    status = add_boundary_rows(e, function, k, &s);
  if (status != MPS_OK) {
    mpsi_free(e->context, s.supports);
    mpsi_free(e->context, s.of);
    return status;
  }
  if (!same_directions(e, &s)) e->pattern_valid = false;
  mpsi_free(e->context, e->supports);
  mpsi_free(e->context, e->support_of);
  e->supports = s.supports;
  e->support_of = s.of;
  e->support_count = s.count;
  e->fabric_known = false;
  return MPS_OK;
}

/* ---- public calls ---------------------------------------------------------------------------- */

static mps_status check_number(const mps_elastic *e, const char *function, int32_t number) {
  if (number >= 0 && number < e->boundary_count && e->boundaries[number].used) return MPS_OK;
  return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                   "number is %d: there is no boundary %d", number, number);
}

/* Checks that all ranks have the same boundary, once created. */
static void give(mpsi_given *list, const mpsi_elastic_boundary *b) {
  const size_t each = b->kind == MPS_BOUNDARY_ROLLER ? 1 : 3, count = (size_t)b->count;
  MPSI_GIVE(list, b, kind);
  MPSI_GIVE(list, b, dofs);
  mpsi_give(list, "id_count", (double)b->count);
  MPSI_GIVE_VECTOR(list, b, normal, 3);
  MPSI_GIVE_VECTOR(list, b, factor, 3);
  mpsi_give_bytes(list, "a hash of ids", b->id, count * sizeof *b->id);
  mpsi_give_bytes(list, "a hash of values", b->values, count * each * sizeof *b->values);
  for (int c = 0; c < 3; c++) mpsi_signal_give(list, "a hash of signal", b->signal[c]);
}

/* Replaces boundary `number` by `now`, or keeps the former one on an error. */
static mps_status replace(mps_elastic *e, const char *function, int32_t number,
                          mpsi_elastic_boundary *now) {
  mpsi_elastic_boundary before = e->boundaries[number];
  now->reaction = before.reaction;
  e->boundaries[number] = *now;
  const mps_status status = mpsi_elastic_make_supports(e, function);
  if (status != MPS_OK) e->boundaries[number] = before;
  release(e, status == MPS_OK ? &before : now);
  return status;
}

/* The boundary `number` becomes that of `def`, on all ranks or on none. */
static mps_status put(mps_elastic *e, const char *function, mps_status status, int32_t number,
                      const mps_elastic_boundary_def *def) {
  mpsi_elastic_boundary b = {.used = false};
  mpsi_given given;
  mpsi_given_begin(&given);
  mpsi_give(&given, "number", number);
  if (status == MPS_OK) status = make(e, function, def, &b);
  if (status == MPS_OK) give(&given, &b);
  status = mpsi_elastic_agree_given(e, function, status, &given);
  if (status != MPS_OK)
    release(e, &b);
  else
    status = replace(e, function, number, &b);
  return status;
}

mps_status mps_elastic_add_boundary(mps_elastic *e, const mps_elastic_boundary_def *def,
                                    int32_t *number) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  int32_t at = 0;
  while (at < e->boundary_count && e->boundaries[at].used) at++;
  if (at == e->boundary_count) {
    if (mpsi_grow(e->context, (void **)&e->boundaries, at, at + 8, sizeof *e->boundaries))
      e->boundary_count = at + 8;
    else
      status = mpsi_fail_memory(e->context, __func__, 8 * sizeof *e->boundaries);
  }
  status = put(e, __func__, status, at, def);
  if (status == MPS_OK && number) *number = at;
  return mpsi_elastic_leave(e, status);
}

mps_status mps_elastic_set_boundary(mps_elastic *e, int32_t number,
                                    const mps_elastic_boundary_def *def) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  status = put(e, __func__, check_number(e, __func__, number), number, def);
  return mpsi_elastic_leave(e, status);
}

mps_status mps_elastic_remove_boundary(mps_elastic *e, int32_t number) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  mpsi_elastic_boundary none = {.used = false};
  status =
      mpsi_elastic_agree_same(e, __func__, check_number(e, __func__, number), "number", number);
  if (status == MPS_OK) status = replace(e, __func__, number, &none);
  if (status == MPS_OK) e->boundaries[number].reaction = (mps_reaction){.count = 0};
  return mpsi_elastic_leave(e, status);
}

mps_status mps_elastic_get_reaction_sized(const mps_elastic *e, int32_t number, mps_reaction *out,
                                          size_t size) {
  static const char function[] = "mps_elastic_get_reaction";
  if (!e) return MPS_ERROR_ARGUMENT;
  const mps_status status = check_number(e, function, number);
  if (status != MPS_OK) return status;
  return mpsi_out_write(e->context, function, out, size, &e->boundaries[number].reaction,
                        sizeof(mps_reaction));
}

void mpsi_elastic_drop_boundaries(mps_elastic *e) {
  for (int32_t k = 0; k < e->boundary_count; k++) release(e, &e->boundaries[k]);
  mpsi_free(e->context, e->boundaries);
}

/* ---- driving --------------------------------------------------------------------------------- */

static mps_status evaluate_signals(mps_elastic *e, const char *function, double t,
                                   bool *by_caller) {
  for (int32_t k = 0; k < e->boundary_count; k++) {
    mpsi_elastic_boundary *b = &e->boundaries[k];
    for (int c = 0; b->used && c < 3; c++) {
      mpsi_signal_motion m;
      const mpsi_signal_use use = {e->context, function, "boundary", k, c};
      const mps_status status = mpsi_signal_evaluate(b->signal[c], use, t, &m);
      *by_caller = *by_caller || mpsi_signal_may_fail(b->signal[c]);
      if (status != MPS_OK) return status;
      b->motion[0][c] = b->factor[c] * m.u;
      b->motion[1][c] = b->factor[c] * m.v;
      b->motion[2][c] = b->factor[c] * m.a;
    }
  }
  return MPS_OK;
}

/* Motions of all boundaries at time t. Functions of the caller may differ between ranks. */
static mps_status find_motions(mps_elastic *e, const char *function, double t) {
  bool by_caller = false;
  const mps_status status = evaluate_signals(e, function, t, &by_caller);
  mpsi_given list;
  if (!by_caller) return status;
  mpsi_given_begin(&list);
  for (int32_t k = 0; status == MPS_OK && k < e->boundary_count; k++)
    for (int m = 0; e->boundaries[k].used && m < 3; m++)
      mpsi_give_vector(&list, "the motion of a boundary", 3, e->boundaries[k].motion[m]);
  return mpsi_elastic_agree_given(e, function, status, &list);
}

mps_status mpsi_elastic_drive(mps_elastic *e, const char *function, double t) {
  const mps_status status = find_motions(e, function, t);
  if (status != MPS_OK) return status;
  for (int64_t k = 0; k < e->support_count; k++) {
    mpsi_support *s = &e->supports[k];
    for (int derivative = 0; derivative < 3; derivative++)
      for (int32_t r = 0; r < s->count; r++) {
        double value = e->boundaries[s->owner[r]].motion[derivative][s->signal[r]];
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
  for (int32_t k = 0; k < e->boundary_count; k++) {
    mps_reaction *q = &e->boundaries[k].reaction;
    q->count = e->boundaries[k].used ? e->boundaries[k].present : 0;
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
      mps_reaction *q = &e->boundaries[s->owner[r]].reaction;
      double f[3];
      for (int c = 0; c < 3; c++) f[c] = part[r] * s->normal[r][c];
      for (int c = 0; c < 3; c++) {
        const int a = (c + 1) % 3, b = (c + 2) % 3;
        q->force[c] += f[c];
        q->moment[c] += x[a] * f[b] - x[b] * f[a];
      }
    }
  }
  for (int32_t k = 0; k < e->boundary_count; k++) {
    mps_reaction *q = &e->boundaries[k].reaction;
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
      e->boundaries[s->owner[r]].reaction.work += work;
      total += work;
    }
  }
  return total;
}

void mpsi_elastic_forget_reactions(mps_elastic *e) {
  for (int32_t k = 0; k < e->boundary_count; k++)
    e->boundaries[k].reaction = (mps_reaction){.count = 0};
}
