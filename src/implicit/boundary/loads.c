/* loads.c - loads as nodal forces.
 *
 * The virtual work of a traction t on a facet of cell i is int t . (u_i + G_i u (x - x_i)) dA: its
 * resultant acts on particle i, its first moment on the sites of the gradient G_i. But beside an
 * axis along which the cell is cut in half, a facet's traction acts at the height of the particle:
 * so does the stress of the half cell in K u (the trapezoidal rule), which it must balance. A body
 * force on a half cell acts at its middle. The published method takes resultants only.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "loads.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"
#include "implicit/body/gradient.h"

#include "core/particles/particles_internal.h"
#include "signal/signal_internal.h"

#include <string.h>

/* ---- one definition -------------------------------------------------------------------------- */

static bool on_facets(int32_t kind) { return kind >= MPS_ELASTIC_LOAD_TRACTION; }

/* Values of each item: of a pressure one. */
static int32_t each(const void *known, int32_t list) {
  const mps_elastic_load_def *def = known;
  return list == 0 || def->kind == MPS_ELASTIC_LOAD_PRESSURE ? 1 : 3;
}

static bool keeps(const void *known, mpsi_selected by) {
  const mps_elastic_load_def *def = known;
  return by == MPSI_SELECTED_ALL && def->kind < MPS_ELASTIC_LOAD_FORCE;
}

static const char *items(const void *def) {
  return on_facets(((const mps_elastic_load_def *)def)->kind) ? "facet" : "particle";
}

static bool item(const void *solver, const void *known, int64_t k, double x[3], int64_t *id) {
  const mps_elastic *e = solver;
  const bool facets = on_facets(((const mps_elastic_load_def *)known)->kind);
  if (k >= (facets ? e->facet_count : e->n)) return false;
  *id = facets ? k : e->id[k];
  if (facets)
    mpsi_elastic_facet_centre(e, &e->facets[k], x);
  else
    memcpy(x, &e->x[k * e->dim], (size_t)e->dim * sizeof *x);
  return true;
}

static mps_status check_ids(void *solver, const char *function, const void *known, int64_t count,
                            const int64_t *ids) {
  const mps_elastic *e = solver;
  const bool facets = on_facets(((const mps_elastic_load_def *)known)->kind);
  for (int64_t k = 0; k < count; k++) {
    if (facets && (ids[k] < 0 || ids[k] >= e->facet_count))
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld, facets are 0 to %lld", (long long)k, (long long)ids[k],
                       (long long)e->facet_count - 1);
    if (!facets && mpsi_elastic_find(e, ids[k]) < 0)
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld: no particle of the solver has that id", (long long)k,
                       (long long)ids[k]);
  }
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
      MPSI_TRY(mpsi_callback_status(e->context, function, "the traction callback", failures,
                                    traction(user, x, normal, t)));
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
  if (!on_facets(def->kind)) { /* of a force by mass or volume the id alone */
    out->id = def->ids[k];
    for (int c = 0; def->kind == MPS_ELASTIC_LOAD_FORCE && c < e->dim; c++)
      out->force[c] = value[c];
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

static mps_status make(void *solver, const char *function, int32_t number, void *known, void *own) {
  mps_elastic *e = solver;
  const mps_elastic_load_def *def = known;
  mpsi_elastic_load *l = own;
  l->def = def;
  if (def->id_count == 0) return MPS_OK;
  if (!(l->patches = mpsi_alloc(e->context, def->id_count, sizeof *l->patches)))
    return mpsi_fail_memory(e->context, function, (size_t)def->id_count * sizeof *l->patches);
  for (int64_t k = 0; k < def->id_count; k++)
    MPSI_TRY(make_patch(e, function, def, k, &l->patches[k]));
  return MPS_OK;
}

/* The first load by mass reads the masses. */
static mps_status apply(void *solver, const char *function, int32_t number, void *def, void *own,
                        void *former) {
  mps_elastic *e = solver;
  const mpsi_elastic_load *l = own;
  if (!l || l->def->kind != MPS_ELASTIC_LOAD_BODY || e->mass) return MPS_OK;
  double *mass = NULL;
  const mps_status status =
      mpsi_elastic_agree(e, function, mpsi_elastic_read_mass(e, function, &mass));
  mpsi_elastic_finish_mass(e, mass, status == MPS_OK);
  return status;
}

static void drop(void *solver, void *own) {
  mpsi_free(((mps_elastic *)solver)->context, ((mpsi_elastic_load *)own)->patches);
}

const mpsi_condition_kind mpsi_elastic_loads = {
    MPSI_CONDITION_OF(ELASTIC, elastic, LOAD, load),
    .role = MPSI_SIGNAL_NUMBER,
    .list = {{"ids", "id_count", 1}, {"values", "id_count", 3}},
    .most = INT32_MAX - 8,
    .size = sizeof(mpsi_elastic_load),
    .each = each,
    .keeps = keeps,
    .item = item,
    .items = items,
    .selects = true,
    .check_ids = check_ids,
    .make = make,
    .apply = apply,
    .drop = drop,
};

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

/* `force` by mass or volume, on a list of particles or the whole body. */
static void add_body(mps_elastic *e, const mps_elastic_load_def *def, const double *scale) {
  for (int64_t k = 0; k < (def->id_count > 0 ? def->id_count : e->n); k++) {
    const int64_t i = def->id_count > 0 ? mpsi_elastic_find(e, def->ids[k]) : k;
    if (i < 0) continue; /* removed */
    mpsi_patch patch = {.id = e->id[i]};
    const double amount = def->kind == MPS_ELASTIC_LOAD_BODY ? e->mass[i] : e->volume[i];
    for (int c = 0; c < e->dim; c++) {
      patch.force[c] = def->force[c] * amount;
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

static bool has_gravity(const mps_elastic *e) {
  const double *g = e->def.gravity;
  return g[0] != 0.0 || g[1] != 0.0 || (e->dim == 3 && g[2] != 0.0);
}

mps_status mpsi_elastic_weigh(mps_elastic *e, const char *function, double **former) {
  bool weighs = has_gravity(e);
  *former = e->mass;
  for (int32_t k = 0; k < mpsi_elastic_load_count(e); k++)
    weighs = weighs || (mpsi_elastic_load_of(e, k) &&
                        mpsi_elastic_load_of(e, k)->def->kind == MPS_ELASTIC_LOAD_BODY);
  if (!weighs) return MPS_OK;
  return mpsi_elastic_agree(e, function, mpsi_elastic_read_mass(e, function, former));
}

static mps_status evaluate_signals(mps_elastic *e, const char *function, double t,
                                   bool *by_caller) {
  for (int32_t k = 0; k < mpsi_elastic_load_count(e); k++) {
    mpsi_elastic_load *l = mpsi_elastic_load_of(e, k);
    for (int c = 0; l && c < 3; c++) {
      const int s = l->def->kind == MPS_ELASTIC_LOAD_PRESSURE ? 0 : c;
      double factor;
      const mpsi_signal_use use = {e->context, function, "load", k, s};
      const mps_status status = mpsi_signal_factor(l->def->signal[s], use, t, &factor);
      *by_caller = *by_caller || mpsi_signal_may_fail(l->def->signal[s]);
      if (status != MPS_OK) return status;
      l->scale[c] = l->def->factor[s] * factor;
    }
  }
  return MPS_OK;
}

/* Factors of all loads at time t. Functions of the caller may differ between ranks. */
static mps_status find_scales(mps_elastic *e, const char *function, double t) {
  bool by_caller = false;
  mps_status status = evaluate_signals(e, function, t, &by_caller);
  mpsi_given list = MPSI_GIVEN;
  if (!by_caller) return status;
  for (int32_t k = 0; status == MPS_OK && k < mpsi_elastic_load_count(e); k++)
    if (mpsi_elastic_load_of(e, k))
      mpsi_give_vector(&list, "the present factor on a load", 3, mpsi_elastic_load_of(e, k)->scale);
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
  MPSI_TRY(find_scales(e, function, t));
  memset(e->load, 0, (size_t)(e->n * e->dim) * sizeof *e->load);
  if (has_gravity(e)) {
    mps_elastic_load_def weight = {.kind = MPS_ELASTIC_LOAD_BODY};
    const double whole[3] = {1.0, 1.0, 1.0};
    memcpy(weight.force, e->def.gravity, sizeof weight.force);
    add_body(e, &weight, whole);
  }
  for (int32_t k = 0; k < mpsi_elastic_load_count(e); k++) {
    const mpsi_elastic_load *l = mpsi_elastic_load_of(e, k);
    if (!l) continue;
    const bool body = l->def->kind < MPS_ELASTIC_LOAD_FORCE;
    if (body) add_body(e, l->def, l->scale);
    for (int64_t p = 0; !body && p < l->def->id_count; p++) {
      const int64_t i = mpsi_elastic_find(e, l->patches[p].id);
      if (i >= 0) add_patch(e, i, &l->patches[p], l->scale);
    }
  }
  mps_status status = add_external(e, function);
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
  if (!e) return mpsi_null(__func__, "elastic");
  MPSI_TRY(mpsi_elastic_enter(e, __func__));
  mps_status status = mpsi_elastic_agree(e, __func__, mpsi_elastic_check_about(e, __func__, about));
  double *mass = e->mass;
  if (status == MPS_OK && !e->motion) status = mpsi_elastic_weigh(e, __func__, &mass);
  if (status == MPS_OK) status = mpsi_elastic_gather_loads(e, __func__, mpsi_elastic_time(e));
  if (status == MPS_OK) status = give_resultant(e, __func__, about, force, moment);
  mpsi_elastic_finish_mass(e, mass, false);
  return mpsi_elastic_leave(e, status);
}
