/* loads.c - loads as nodal forces.
 *
 * The virtual work of a traction t on a facet of cell i is int t . (u_i + G_i u (x - x_i)) dA: its
 * resultant acts on particle i, its first moment on the sites of the gradient G_i. But beside an
 * axis along which the cell is cut in half, a facet's traction acts at the height of the particle:
 * so does the stress of the half cell in K u (the trapezoidal rule), which it must balance. A body
 * force on a half cell acts at its middle. The published method takes resultants only.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/base/defs.h"
#include "loads.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/body/gradient.h"

#include "core/particles/particles_internal.h"
#include "core/context/retain.h"
#include "signal/signal_internal.h"

#include <string.h>

/* ---- one definition -------------------------------------------------------------------------- */

static bool on_facets(int32_t kind) { return kind >= MPS_ELASTIC_LOAD_TRACTION; }

static mps_status check_list(const mps_elastic *e, const char *function,
                             const mps_elastic_load_def *def) {
  const bool facets = on_facets(def->kind);
  const int64_t each = def->kind == MPS_ELASTIC_LOAD_PRESSURE ? 1 : 3;
  if (def->id_count < 0 || (def->id_count > 0 && !def->ids))
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     def->id_count < 0 ? "id_count is %lld, must be >= 0"
                                       : "ids is NULL, id_count is %lld",
                     (long long)def->id_count);
  for (int64_t k = 0; k < def->id_count; k++) {
    const int64_t id = def->ids[k];
    if (facets && (id < 0 || id >= e->facet_count))
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld, facets are 0..%lld", (long long)k, (long long)id,
                       (long long)e->facet_count - 1);
    if (!facets && mpsi_elastic_find(e, id) < 0)
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld: no particle of the solver has that id", (long long)k,
                       (long long)id);
  }
  for (int64_t k = 0; def->values && k < def->id_count * each; k++)
    if ((each == 1 || k % 3 < e->dim) && !isfinite(def->values[k]))
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "values[%lld] is %g, must be finite", (long long)k, def->values[k]);
  return MPS_OK;
}

static mps_status check_def(const mps_elastic *e, const char *function,
                            const mps_elastic_load_def *def) {
  if (def->kind < MPS_ELASTIC_LOAD_BODY || def->kind > MPS_ELASTIC_LOAD_FUNCTION)
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "kind is %d, allowed are MPS_ELASTIC_LOAD_..., 0..5", def->kind);
  for (int c = 0; c < 3; c++)
    if (!isfinite(def->force[c]) || !isfinite(def->factor[c]))
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "force[%d] is %g and factor[%d] %g, must be finite", c, def->force[c], c,
                       def->factor[c]);
  if (def->kind == MPS_ELASTIC_LOAD_FUNCTION && !def->function)
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT, "function is NULL");
  if (def->kind > MPS_ELASTIC_LOAD_GRAVITY) return check_list(e, function, def);
  if (def->ids || def->id_count != 0 || def->values)
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "a load of kind %d acts on the whole body: it takes no ids or values",
                     def->kind);
  return MPS_OK;
}

/* A uniform traction on one facet. */
static void make_uniform(const mps_elastic *e, const mpsi_facet *f, const double *traction,
                         mpsi_patch *out) {
  double low[3] = {0.0, 0.0, 0.0}, high[3] = {0.0, 0.0, 0.0};
  double area = e->dim == 2 ? e->def.measure : 1.0;
  mpsi_elastic_facet_box(e, f, low, high);
  for (int c = 0; c < e->dim; c++)
    if (c != f->axis) area *= high[c] - low[c];
  for (int c = 0; c < e->dim; c++) {
    out->force[c] = traction[c] * area;
    out->moment[c][f->axis] = out->force[c] * low[f->axis];
  }
}

/* Integrates the caller's traction over one facet. */
static mps_status integrate(const mps_elastic *e, const char *function, int64_t k,
                            mps_elastic_traction_fn traction, void *user, double *force,
                            double (*moment)[3]) {
  static const double at[3] = {-0.7745966692414834, 0.0, 0.7745966692414834}; /* sqrt(3/5) */
  static const double weight[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const mpsi_facet *f = &e->facets[k];
  double low[3] = {0.0, 0.0, 0.0}, high[3] = {0.0, 0.0, 0.0};
  double normal[3] = {0.0, 0.0, 0.0}, x[3] = {0.0, 0.0, 0.0}, r[3] = {0.0, 0.0, 0.0};
  mpsi_elastic_facet_box(e, f, low, high);
  normal[f->axis] = f->side;
  memset(force, 0, 3 * sizeof *force);
  memset(moment, 0, 9 * sizeof **moment);
  const int p = f->axis == 0 ? 1 : 0, q = f->axis == 2 ? 1 : 2; /* the facet's own axes */
  for (int b = 0; b < (e->dim == 3 ? 3 : 1); b++)
    for (int a = 0; a < 3; a++) {
      double dA = e->dim == 2 ? e->def.measure : weight[b] * (high[q] - low[q]), t[3] = {0};
      dA *= weight[a] * (high[p] - low[p]);
      r[f->axis] = low[f->axis];
      r[p] = 0.5 * (low[p] + high[p]) + 0.5 * at[a] * (high[p] - low[p]);
      if (e->dim == 3) r[q] = 0.5 * (low[q] + high[q]) + 0.5 * at[b] * (high[q] - low[q]);
      for (int c = 0; c < e->dim; c++) x[c] = e->x[f->particle * e->dim + c] + r[c];
      const int64_t failures = mpsi_failures(e->context);
      const mps_status status = mpsi_callback_status(e->context, function, "the traction callback",
                                                     failures, traction(user, x, normal, t));
      if (status != MPS_OK) return status;
      for (int c = 0; c < e->dim; c++)
        if (!isfinite(t[c]))
          return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                           "the traction callback gave %g Pa along %c, must be finite", t[c],
                           "xyz"[c]);
      for (int c = 0; c < e->dim; c++) {
        force[c] += t[c] * dA;
        for (int m = 0; m < e->dim; m++)
          if (m == f->axis || low[m] == -high[m]) moment[c][m] += t[c] * dA * r[m];
      }
    }
  return MPS_OK;
}

static mps_status make_patch(const mps_elastic *e, const char *function,
                             const mps_elastic_load_def *def, int64_t k, mpsi_patch *out) {
  const double *value = def->values ? def->values + 3 * k : def->force;
  memset(out, 0, sizeof *out);
  if (!on_facets(def->kind)) {
    out->id = def->ids[k];
    for (int c = 0; c < e->dim; c++) out->force[c] = value[c];
    return MPS_OK;
  }
  const mpsi_facet *f = &e->facets[def->ids[k]];
  out->id = e->id[f->particle];
  if (def->kind == MPS_ELASTIC_LOAD_FUNCTION)
    return integrate(e, function, def->ids[k], def->function, def->user, out->force, out->moment);
  double traction[3] = {0.0, 0.0, 0.0};
  if (def->kind == MPS_ELASTIC_LOAD_PRESSURE)
    traction[f->axis] = -(def->values ? def->values[k] : def->force[0]) * f->side;
  else
    memcpy(traction, value, sizeof traction);
  make_uniform(e, f, traction, out);
  return MPS_OK;
}

/* The patches of the definition, to e->spare. */
static mps_status make_patches(mps_elastic *e, const char *function,
                               const mps_elastic_load_def *def) {
  mps_status status = MPS_OK;
  if (def->kind <= MPS_ELASTIC_LOAD_GRAVITY) return MPS_OK;
  if (def->id_count > e->spare_capacity) {
    if (!mpsi_grow(e->context, (void **)&e->spare, e->spare_capacity, def->id_count,
                   sizeof *e->spare))
      return mpsi_fail_memory(e->context, function, (size_t)def->id_count * sizeof *e->spare);
    e->spare_capacity = def->id_count;
  }
  for (int64_t k = 0; k < def->id_count && status == MPS_OK; k++)
    status = make_patch(e, function, def, k, &e->spare[k]);
  return status;
}

static void release(mps_elastic *e, mpsi_elastic_load *l) {
  mpsi_free(e->context, l->patches);
  for (int c = 0; c < 3; c++) mps_signal_destroy(&l->signal[c]);
  *l = (mpsi_elastic_load){.used = false};
}

/* Checks that all ranks have the same definition, once it is valid. */
static void give(mpsi_given *list, const mps_elastic_load_def *def) {
  const size_t each = def->kind == MPS_ELASTIC_LOAD_PRESSURE ? 1 : 3, count = (size_t)def->id_count;
  MPSI_GIVE(list, def, kind);
  MPSI_GIVE(list, def, id_count);
  MPSI_GIVE_VECTOR(list, def, force, 3);
  MPSI_GIVE_VECTOR(list, def, factor, 3);
  mpsi_give_bytes(list, "a hash of ids", def->ids, count * sizeof *def->ids);
  mpsi_give_bytes(list, "a hash of values", def->values, count * each * sizeof *def->values);
  for (int c = 0; c < 3; c++) mpsi_signal_give(list, "a hash of signal", def->signal[c]);
}

/* The load `number` becomes that of `user`, on all ranks or on none. */
static mps_status put(mps_elastic *e, const char *function, mps_status status, int32_t number,
                      const mps_elastic_load_def *user) {
  mps_elastic_load_def def = mpsi_elastic_load_defaults;
  mpsi_given given;
  mpsi_given_begin(&given);
  mpsi_give(&given, "number", number);
  if (status == MPS_OK)
    status = MPSI_DEF_READ(e->context, function, mps_elastic_load_def, user, &def);
  if (status == MPS_OK) status = check_def(e, function, &def);
  if (status == MPS_OK) give(&given, &def);
  double *mass = e->mass;
  if (status == MPS_OK && def.kind == MPS_ELASTIC_LOAD_GRAVITY && !mass)
    status = mpsi_elastic_read_mass(e, function, &mass);
  if (status == MPS_OK) status = make_patches(e, function, &def);
  status = mpsi_elastic_agree_given(e, function, status, &given);
  mpsi_elastic_finish_mass(e, mass, status == MPS_OK);
  if (status != MPS_OK) return status;
  mpsi_elastic_load *l = &e->loads[number];
  if (def.kind > MPS_ELASTIC_LOAD_GRAVITY) { /* the former patches become scratch memory */
    mpsi_patch *patches = l->patches;
    const int64_t capacity = l->capacity;
    l->patches = e->spare;
    l->capacity = e->spare_capacity;
    e->spare = patches;
    e->spare_capacity = capacity;
  }
  l->used = true;
  l->kind = def.kind;
  l->count = def.kind > MPS_ELASTIC_LOAD_GRAVITY ? def.id_count : 0;
  for (int c = 0; c < 3; c++) {
    mps_signal *signal = def.signal[c] ? mpsi_signal_retain(def.signal[c]) : NULL;
    mps_signal_destroy(&l->signal[c]);
    l->signal[c] = signal;
    l->factor[c] = def.factor[c];
    l->force[c] = def.force[c];
  }
  return MPS_OK;
}

/* ---- public calls ---------------------------------------------------------------------------- */

static mps_status check_number(const mps_elastic *e, const char *function, int32_t number) {
  if (number >= 0 && number < e->load_count && e->loads[number].used) return MPS_OK;
  return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT, "number is %d: there is no load %d",
                   number, number);
}

mps_status mps_elastic_add_load(mps_elastic *e, const mps_elastic_load_def *def, int32_t *number) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  int32_t at = 0;
  while (at < e->load_count && e->loads[at].used) at++;
  if (at == e->load_count) {
    if (mpsi_grow(e->context, (void **)&e->loads, at, at + 8, sizeof *e->loads))
      e->load_count = at + 8;
    else
      status = mpsi_fail_memory(e->context, __func__, 8 * sizeof *e->loads);
  }
  status = put(e, __func__, status, at, def);
  if (status == MPS_OK && number) *number = at;
  return mpsi_elastic_leave(e, status);
}

mps_status mps_elastic_set_load(mps_elastic *e, int32_t number, const mps_elastic_load_def *def) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  status = put(e, __func__, check_number(e, __func__, number), number, def);
  return mpsi_elastic_leave(e, status);
}

mps_status mps_elastic_remove_load(mps_elastic *e, int32_t number) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  status =
      mpsi_elastic_agree_same(e, __func__, check_number(e, __func__, number), "number", number);
  if (status == MPS_OK) release(e, &e->loads[number]);
  return mpsi_elastic_leave(e, status);
}

void mpsi_elastic_drop_loads(mps_elastic *e) {
  for (int32_t k = 0; k < e->load_count; k++) release(e, &e->loads[k]);
  mpsi_free(e->context, e->loads);
  mpsi_free(e->context, e->spare);
}

/* ---- nodal forces ---------------------------------------------------------------------------- */

/* Adds the force and the first moment m[c][b] = int t_c (x - x_i)_b of a load on cell i. */
static void add_patch(mps_elastic *e, int64_t i, const mpsi_patch *patch, const double *scale) {
  const int d = e->dim;
  double moment[3][3];
  bool any = false;
  for (int c = 0; c < d; c++) {
    e->load[i * d + c] += scale[c] * patch->force[c];
    for (int b = 0; b < d; b++) {
      moment[c][b] = scale[c] * patch->moment[c][b];
      any |= moment[c][b] != 0.0;
    }
  }
  /* A gradient's sites are two layers from it at most. */
  if (any && e->conservative && mpsi_elastic_within(e, e->span[2], i))
    mpsi_elastic_spread(e, i, (const double(*)[3])moment, e->load);
}

/* The whole body: `force` by volume, or by mass. */
static void add_body(mps_elastic *e, const mpsi_elastic_load *l, const double *scale) {
  for (int64_t i = 0; i < e->n; i++) {
    mpsi_patch patch = {.id = e->id[i]};
    const double amount = l->kind == MPS_ELASTIC_LOAD_GRAVITY ? e->mass[i] : e->volume[i];
    for (int c = 0; c < e->dim; c++) {
      patch.force[c] = l->force[c] * amount;
      for (int b = 0; e->cut[i] && b < e->dim; b++) {
        double low, high;
        mpsi_elastic_reach(e, i, b, &low, &high);
        patch.moment[c][b] = patch.force[c] * 0.5 * (low + high);
      }
    }
    add_patch(e, i, &patch, scale);
  }
}

static mps_status add_external(mps_elastic *e, const char *function) {
  for (int c = 0; c < e->dim; c++) {
    const double *column = mpsi_particles_column(e->particles, "external_force", c);
    if (!column) return MPS_OK;
    for (int64_t i = 0; i < e->n; i++) {
      const double f = column[mps_particles_index(e->particles, e->id[i])];
      if (!isfinite(f)) {
        const mps_status status =
            mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                      "external_force %c of particle %lld is %g, must be finite (N)", "xyz"[c],
                      (long long)e -> id[i], f);
        mpsi_fail_where(e->context, -1, e->id[i]);
        return status;
      }
      e->load[i * e->dim + c] += f;
    }
  }
  return MPS_OK;
}

mps_status mpsi_elastic_weigh(mps_elastic *e, const char *function, double **former) {
  bool weighs = false;
  *former = e->mass;
  for (int32_t k = 0; k < e->load_count; k++)
    weighs = weighs || (e->loads[k].used && e->loads[k].kind == MPS_ELASTIC_LOAD_GRAVITY);
  if (!weighs) return MPS_OK;
  return mpsi_elastic_agree(e, function, mpsi_elastic_read_mass(e, function, former));
}

static mps_status evaluate_signals(mps_elastic *e, const char *function, double t,
                                   bool *by_caller) {
  for (int32_t k = 0; k < e->load_count; k++) {
    mpsi_elastic_load *l = &e->loads[k];
    for (int c = 0; l->used && c < 3; c++) {
      const int s = l->kind == MPS_ELASTIC_LOAD_PRESSURE ? 0 : c;
      mpsi_signal_motion m = {.u = 1.0};
      const mpsi_signal_use use = {e->context, function, "load", k, s};
      const mps_status status =
          l->signal[s] ? mpsi_signal_evaluate(l->signal[s], use, t, &m) : MPS_OK;
      *by_caller = *by_caller || mpsi_signal_may_fail(l->signal[s]);
      if (status != MPS_OK) return status;
      l->scale[c] = l->factor[s] * m.u;
    }
  }
  return MPS_OK;
}

/* Factors of all loads at time t. Functions of the caller may differ between ranks. */
static mps_status find_scales(mps_elastic *e, const char *function, double t) {
  bool by_caller = false;
  mps_status status = evaluate_signals(e, function, t, &by_caller);
  mpsi_given list;
  if (!by_caller) return status;
  mpsi_given_begin(&list);
  for (int32_t k = 0; status == MPS_OK && k < e->load_count; k++)
    if (e->loads[k].used)
      mpsi_give_vector(&list, "the present factor on a load", 3, e->loads[k].scale);
  return mpsi_elastic_agree_given(e, function, status, &list);
}

/* On all ranks: all fail or none. */
static mps_status check_strength(const mps_elastic *e, const char *function) {
  for (int64_t k = 0; k < e->n * e->dim; k++)
    if (!(fabs(e->load[k]) <= MPSI_ELASTIC_STRONGEST)) {
      const mps_status status = mpsi_fail(
          e->context, function, MPS_ERROR_NUMERIC,
          "the loads on particle %lld are %g N along %c, allowed is up to %g N",
          (long long)e->id[k / e->dim], e->load[k], "xyz"[k % e->dim], MPSI_ELASTIC_STRONGEST);
      mpsi_fail_where(e->context, -1, e->id[k / e->dim]);
      return status;
    }
  return MPS_OK;
}

mps_status mpsi_elastic_gather_loads(mps_elastic *e, const char *function, double t) {
  mps_status status = find_scales(e, function, t);
  if (status != MPS_OK) return status;
  memset(e->load, 0, (size_t)(e->n * e->dim) * sizeof *e->load);
  for (int32_t k = 0; k < e->load_count; k++) {
    const mpsi_elastic_load *l = &e->loads[k];
    if (!l->used) continue;
    if (l->kind <= MPS_ELASTIC_LOAD_GRAVITY) add_body(e, l, l->scale);
    for (int64_t p = 0; p < l->count; p++) {
      const int64_t i = mpsi_elastic_find(e, l->patches[p].id);
      if (i >= 0) add_patch(e, i, &l->patches[p], l->scale);
    }
  }
  status = add_external(e, function);
  if (status == MPS_OK) status = mpsi_elastic_complete(e, function, e->load);
  return status == MPS_OK ? check_strength(e, function) : status;
}

/* ---- resultants ------------------------------------------------------------------------------ */

void mpsi_elastic_resultant(const mps_elastic *e, const double *f, const double *about,
                            double *force, double *moment) {
  const int d = e->dim;
  double sum[3] = {0.0, 0.0, 0.0}, turn[3] = {0.0, 0.0, 0.0};
  for (int64_t i = 0; i < e->n; i++) {
    double r[3] = {0.0, 0.0, 0.0}, p[3] = {0.0, 0.0, 0.0};
    for (int c = 0; c < d; c++) {
      r[c] = e->x[i * d + c] - (about ? about[c] : 0.0);
      p[c] = f[i * d + c];
      sum[c] += p[c];
    }
    for (int c = 0; c < 3; c++)
      turn[c] += r[(c + 1) % 3] * p[(c + 2) % 3] - r[(c + 2) % 3] * p[(c + 1) % 3];
  }
  if (force) memcpy(force, sum, sizeof sum);
  if (moment) memcpy(moment, turn, sizeof turn);
}

mps_status mpsi_elastic_check_about(const mps_elastic *e, const char *function,
                                    const double *about) {
  for (int c = 0; about && c < e->dim; c++)
    if (!isfinite(about[c]))
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "about[%d] is %g m, must be finite", c, about[c]);
  return MPS_OK;
}

/* Nothing is written where a sum is not finite. */
static mps_status give_resultant(const mps_elastic *e, const char *function, const double *about,
                                 double *force, double *moment) {
  double sum[3], turn[3];
  mpsi_elastic_resultant(e, e->load, about, sum, turn);
  for (int c = 0; c < 3; c++)
    if (!isfinite(sum[c]) || !isfinite(turn[c]))
      return mpsi_fail(e->context, function, MPS_ERROR_NUMERIC,
                       "the resultant of the loads has force[%d] = %g N and moment[%d] = %g N m: "
                       "loads or `about` are too large",
                       c, sum[c], c, turn[c]);
  if (force) memcpy(force, sum, sizeof sum);
  if (moment) memcpy(moment, turn, sizeof turn);
  return MPS_OK;
}

mps_status mps_elastic_get_load_resultant(const mps_elastic *handle, const double *about,
                                          double *force, double *moment) {
  mps_elastic *e = (mps_elastic *)handle; /* scratch and messages only: the state stays */
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  status = mpsi_elastic_agree(e, __func__, mpsi_elastic_check_about(e, __func__, about));
  double *mass = e->mass;
  if (status == MPS_OK && !e->motion) status = mpsi_elastic_weigh(e, __func__, &mass);
  if (status == MPS_OK) status = mpsi_elastic_gather_loads(e, __func__, mps_elastic_time(e));
  if (status == MPS_OK) status = give_resultant(e, __func__, about, force, moment);
  mpsi_elastic_finish_mass(e, mass, false);
  return mpsi_elastic_leave(e, status);
}
