/* loads.c - forces on particles besides gravity: accelerations of the field `body_acceleration`,
 * and dead loads on lists of particles, which are found by their ids so that sorting does not
 * matter. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

#include "core/particles_internal.h"
#include "core/retain.h"

#include <string.h>

/* ---- forces of a step ------------------------------------------------------------------------ */

mps_status mpsi_mpm_make_forces(mps_mpm *mpm, const char *function) {
  if (mpm->loads.force_memory) return MPS_OK;
  const int64_t line = MPSI_ALIGNMENT / (int64_t)sizeof(double);
  const int64_t stride = (mpm->p.count + MPSI_PARTICLES_PADDING + line - 1) / line * line;
  mpm->loads.force_memory = mpsi_alloc(mpm->context, mpm->dim * stride, sizeof(double));
  if (!mpm->loads.force_memory)
    return mpsi_fail_memory(mpm->context, function, (size_t)(mpm->dim * stride) * sizeof(double));
  for (int c = 0; c < mpm->dim; c++) mpm->p.f[c] = mpm->loads.force_memory + c * stride;
  return MPS_OK;
}

static void begin_forces(mps_mpm *mpm, int64_t b, int32_t worker) {
  (void)worker;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  for (int c = 0; c < mpm->dim; c++) {
    const double *a = mpm->loads.body_acceleration[c];
    for (int64_t k = cells->begin; k < cells->end; k++)
      mpm->p.f[c][k] = a ? mpm->p.m[k] * a[k] : 0.0;
  }
}

static double area_by_spacing(const mps_mpm *mpm, int64_t particle) {
  const double spacing = 2.0 * mpm->contact.gap;
  if (mpm->dim == 3) return spacing * spacing;
  return mpm->def.geometry == MPS_AXISYMMETRIC ? spacing * mpm->p.x[0][particle] : spacing;
}

static void add_traction(mps_mpm *mpm, const mpsi_traction *load) {
  const double now = load->signal ? mps_signal_displacement(load->signal, mpm->run.time) : 1.0;
  for (int64_t k = 0; k < load->count; k++) {
    const int64_t particle = mps_particles_index(mpm->particles, load->id[k]);
    const double by = now * (load->area ? load->area[k] : area_by_spacing(mpm, particle));
    for (int c = 0; c < mpm->dim; c++) mpm->p.f[c][particle] += by * load->traction[c];
  }
}

void mpsi_mpm_find_forces(mps_mpm *mpm) {
  if (!mpm->loads.force_memory) return;
  mpsi_mpm_for_cells(mpm, begin_forces);
  for (int32_t k = 0; k < mpm->loads.count; k++) add_traction(mpm, &mpm->loads.traction[k]);
}

/* ---- loads ----------------------------------------------------------------------------------- */

static void drop(mps_mpm *mpm, mpsi_traction *load) {
  mpsi_free(mpm->context, load->id);
  mpsi_free(mpm->context, load->area);
  mps_signal_destroy(&load->signal);
  memset(load, 0, sizeof *load);
}

void mpsi_mpm_drop_loads(mps_mpm *mpm) {
  for (int32_t k = 0; k < mpm->loads.count; k++) drop(mpm, &mpm->loads.traction[k]);
  mpsi_free(mpm->context, mpm->loads.traction);
}

static mps_status check_traction(mps_mpm *mpm, const char *function, const double *traction) {
  if (!traction) return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT, "traction is NULL");
  for (int c = 0; c < mpm->dim; c++)
    if (!isfinite(traction[c]))
      return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                       "traction[%d] is %g Pa, must be finite", c, traction[c]);
  return MPS_OK;
}

static mps_status check_list(mps_mpm *mpm, const char *function, int64_t count, const int64_t *ids,
                             const double *area) {
  if (count < 1 || count > mpm->p.count || !ids)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "count is %lld and ids %s, allowed are 1 to %lld particles", (long long)count,
                     ids ? "given" : "NULL", (long long)mpm->p.count);
  for (int64_t k = 0; k < count; k++) {
    if (mps_particles_index(mpm->particles, ids[k]) < 0)
      return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld, allowed are 0 to %lld", (long long)k, (long long)ids[k],
                       (long long)mpm->p.count - 1);
    if (area && !isfinite(area[k]))
      return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                       "area[%lld] is %g m2, must be finite", (long long)k, area[k]);
  }
  return MPS_OK;
}

static void take(mps_mpm *mpm, mpsi_traction *load, const double *traction, mps_signal *signal) {
  mps_signal *old = load->signal;
  memcpy(load->traction, traction, (size_t)mpm->dim * sizeof *traction);
  load->signal = signal ? mpsi_signal_retain(signal) : NULL;
  mps_signal_destroy(&old);
}

mps_status mps_mpm_add_load(mps_mpm *mpm, int64_t count, const int64_t *ids, const double *area,
                            const double *traction, mps_signal *signal, int32_t *number) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  if (!number) return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "load is NULL");
  mps_status status = check_list(mpm, __func__, count, ids, area);
  if (status == MPS_OK) status = check_traction(mpm, __func__, traction);
  if (status != MPS_OK) return status;
  mpsi_traction made = {.count = count};
  const size_t bytes = (size_t)count * 8;
  int32_t at = 0;
  while (at < mpm->loads.count && mpm->loads.traction[at].count > 0) at++;
  made.id = mpsi_alloc(mpm->context, count, sizeof *ids);
  bool good = made.id != NULL;
  if (good && area) good = (made.area = mpsi_alloc(mpm->context, count, sizeof *area)) != NULL;
  void *list = mpm->loads.traction;
  if (good && at == mpm->loads.count)
    good = mpsi_grow(mpm->context, &list, at, at + 1, sizeof *mpm->loads.traction);
  if (good) {
    mpm->loads.traction = list;
    if (at == mpm->loads.count) mpm->loads.count++;
    good = mpsi_mpm_make_forces(mpm, __func__) == MPS_OK;
  }
  if (!good) {
    drop(mpm, &made);
    return mpsi_fail_memory(mpm->context, __func__, bytes);
  }
  memcpy(made.id, ids, bytes);
  if (area) memcpy(made.area, area, bytes);
  take(mpm, &made, traction, signal);
  mpm->loads.traction[at] = made;
  *number = at;
  return MPS_OK;
}

static mps_status find_load(mps_mpm *mpm, const char *function, int32_t number) {
  if (number >= 0 && number < mpm->loads.count && mpm->loads.traction[number].count > 0)
    return MPS_OK;
  return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                   "load is %d, must be a number that mps_mpm_add_load gave", number);
}

mps_status mps_mpm_set_load(mps_mpm *mpm, int32_t number, const double *traction,
                            mps_signal *signal) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  mps_status status = find_load(mpm, __func__, number);
  if (status == MPS_OK) status = check_traction(mpm, __func__, traction);
  if (status == MPS_OK) take(mpm, &mpm->loads.traction[number], traction, signal);
  return status;
}

mps_status mps_mpm_remove_load(mps_mpm *mpm, int32_t number) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  const mps_status status = find_load(mpm, __func__, number);
  if (status == MPS_OK) drop(mpm, &mpm->loads.traction[number]);
  return status;
}
