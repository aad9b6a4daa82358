/* restart.c - see restart.h. Sums over particles go block by block in the set's order: a run that
 * goes on bit for bit needs both as they were at the last sort.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "restart.h"

#include "mpm_private.h"

#include <stdio.h>
#include <string.h>

_Static_assert(sizeof(mpsi_dash) == MPSI_DASH * sizeof(double), "kept as numbers");

mps_context *mpsi_mpm_context(const mps_mpm *mpm) { return mpm->context; }
mps_particles *mpsi_mpm_particles(const mps_mpm *mpm) { return mpm->particles; }

/* How the caller has built the solver, as far as the state depends on it. */
static void get_setting(const mps_mpm *mpm, mpsi_mpm_record *out) {
  out->geometry = mpm->def.geometry, out->scheme = mpm->def.scheme;
  out->spline = mpm->def.spline;
  out->bodies = mpm->contact.bodies, out->materials = mpm->laws.count;
  for (int32_t k = 0; k < mpm->laws.count; k++)
    snprintf(out->material[k], sizeof out->material[k], "%s",
             mps_material_name(mpm->laws.law[k].material));
  for (int32_t k = 0; k < mpm->loads.count; k++) out->loads += mpm->loads.traction[k].count > 0;
  out->accelerated = mpm->loads.body_acceleration[0] != NULL;
  for (int k = 0; k < MPSI_HOLDS; k++) out->kind[k] = mpm->boundaries.hold[k].kind;
}

mps_status mpsi_mpm_get_record(const mps_mpm *mpm, const char *function, mpsi_mpm_record *out) {
  if (mpm->run.broken)
    return mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                     "step %lld has failed: there is no state to go on from",
                     (long long)mpm->run.steps);
  get_setting(mpm, out);
  out->cell = mpm->def.cell;
  for (int c = 0; c < mpm->dim; c++) {
    out->origin[c] = mpm->def.origin[c];
    out->low[c] = mpm->grid.low[c], out->high[c] = mpm->grid.high[c];
  }
  out->stale = mpm->run.stale;
  out->speed = mpm->run.speed;
  for (int32_t b = 0; b < mpm->contact.bodies; b++)
    mpsi_body_get_record(mpm->contact.body[b], &out->body[b]);
  for (int k = 0; k < MPSI_HOLDS; k++) {
    out->finds[k] = mpm->boundaries.hold[k].finds, out->found[k] = mpm->boundaries.hold[k].found;
    memcpy(&out->force[3 * k], mpm->boundaries.hold[k].force, sizeof mpm->boundaries.hold[k].force);
  }
  out->dashes = mpm->boundaries.dash_count;
  out->dash = mpsi_alloc(mpm->context, out->dashes, sizeof *out->dash);
  if (!out->dash)
    return mpsi_fail_memory(mpm->context, function, (size_t)out->dashes * sizeof *out->dash);
  if (out->dashes > 0)
    memcpy(out->dash, mpm->boundaries.dash, (size_t)out->dashes * sizeof *out->dash);
  out->blocks = mpm->grid.cell_count;
  out->block = mpsi_alloc(mpm->context, out->blocks, sizeof *out->block);
  if (!out->block)
    return mpsi_fail_memory(mpm->context, function, (size_t)out->blocks * sizeof *out->block);
  for (int64_t k = 0; k < out->blocks; k++) {
    const mpsi_cell_block *cells = &mpm->grid.cells[k];
    out->block[k][0] = cells->begin;
    for (int c = 0; c < 3; c++) {
      out->block[k][MPSI_BLOCK_AT + c] = cells->at[c];
      out->block[k][MPSI_BLOCK_LOW + c] = cells->low[c];
      out->block[k][MPSI_BLOCK_HIGH + c] = cells->high[c];
    }
  }
  return MPS_OK;
}

/* ---- is it of this solver? ------------------------------------------------------------------- */

static mps_status check_grid(const mps_mpm *mpm, const char *function, const char *path,
                             const mpsi_mpm_record *r) {
  const mps_mpm_def *d = &mpm->def;
  if (r->geometry != d->geometry || r->scheme != d->scheme || r->spline != d->spline)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "'%.200s' has geometry %lld, scheme %lld and spline %lld, the solver %d, %d "
                     "and %d",
                     path, (long long)r->geometry, (long long)r->scheme, (long long)r->spline,
                     d->geometry, d->scheme, d->spline);
  if (r->cell != d->cell)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "'%.200s' has cell %.17g m, the solver %.17g m", path, r->cell, d->cell);
  for (int c = 0; c < mpm->dim; c++) {
    if (r->origin[c] != d->origin[c])
      return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                       "'%.200s' has origin[%d] %.17g m, the solver %.17g m", path, c, r->origin[c],
                       d->origin[c]);
    if (r->low[c] != mpm->grid.low[c] || r->high[c] != mpm->grid.high[c])
      return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                       "'%.200s' has walls in %c at nodes %lld and %lld, the solver at %lld and "
                       "%lld (2^30: none)",
                       path, "xyz"[c], (long long)r -> low[c], (long long)r -> high[c],
                       (long long)mpm -> grid.low[c], (long long)mpm->grid.high[c]);
  }
  return MPS_OK;
}

static mps_status check_body(const mps_mpm *mpm, const char *function, const char *path, int32_t b,
                             const mpsi_body_record *r) {
  mpsi_body_record own;
  mpsi_body_get_record(mpm->contact.body[b], &own);
  if (r->shape == own.shape && r->faces == own.faces && r->motion == own.motion &&
      r->parts == own.parts)
    return MPS_OK;
  return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                   "body %d of '%.200s' has shape %lld, %lld faces, motion %lld and %lld parts, "
                   "that of the solver %lld, %lld, %lld and %lld",
                   b, path, (long long)r->shape, (long long)r->faces, (long long)r->motion,
                   (long long)r->parts, (long long)own.shape, (long long)own.faces,
                   (long long)own.motion, (long long)own.parts);
}

static mps_status check_materials(const mps_mpm *mpm, const char *function, const char *path,
                                  const mpsi_mpm_record *r) {
  if (r->materials != mpm->laws.count)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "'%.200s' has %lld materials, the solver %d", path, (long long)r->materials,
                     mpm->laws.count);
  for (int32_t k = 0; k < mpm->laws.count; k++) {
    char name[MPSI_MATERIAL_NAME];
    snprintf(name, sizeof name, "%s", mps_material_name(mpm->laws.law[k].material));
    if (strcmp(r->material[k], name) != 0)
      return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                       "material %d of '%.200s' is '%s', of the solver '%s'", k, path,
                       r->material[k], name);
  }
  return MPS_OK;
}

static mps_status check_forces(const mps_mpm *mpm, const char *function, const char *path,
                               const mpsi_mpm_record *r) {
  mpsi_mpm_record *own = mpsi_alloc(mpm->context, 1, sizeof *own);
  if (!own) return mpsi_fail_memory(mpm->context, function, sizeof *own);
  get_setting(mpm, own);
  mps_status status = MPS_OK;
  if (r->loads != own->loads || r->accelerated != own->accelerated)
    status = mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                       "'%.200s' has %lld loads and %s body accelerations, the solver %lld and %s",
                       path, (long long)r->loads, r->accelerated ? "its" : "no",
                       (long long)own->loads, own->accelerated ? "has them" : "none");
  for (int k = 0; k < MPSI_HOLDS && status == MPS_OK; k++)
    if (r->kind[k] != own->kind[k])
      status = mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                         "%s %d of '%.200s' is of kind %lld, of the solver %lld (%d: none)",
                         k < MPSI_WALLS ? "wall" : "box", k < MPSI_WALLS ? k : k - MPSI_WALLS, path,
                         (long long)r->kind[k], (long long)own->kind[k], MPSI_HOLD_NONE);
  mpsi_free(mpm->context, own);
  return status;
}

mps_status mpsi_mpm_check_record(const mps_mpm *mpm, const char *function, const char *path,
                                 const mpsi_mpm_record *record) {
  mps_status status = check_grid(mpm, function, path, record);
  if (status != MPS_OK) return status;
  status = check_forces(mpm, function, path, record);
  if (status == MPS_OK) status = check_materials(mpm, function, path, record);
  if (status != MPS_OK) return status;
  if (record->bodies != mpm->contact.bodies)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "'%.200s' has %lld bodies, the solver %d: add them before", path,
                     (long long)record->bodies, mpm->contact.bodies);
  for (int32_t b = 0; b < mpm->contact.bodies && status == MPS_OK; b++)
    status = check_body(mpm, function, path, b, &record->body[b]);
  return status;
}

/* ---- is it whole? ---------------------------------------------------------------------------- */

#define ROUNDED 1e-6 /* cells */

/* The part of the tile in use: within the tile, and wide enough for a stencil. */
static bool within_tile(const mps_mpm *mpm, const int64_t *b) {
  for (int c = 0; c < 3; c++) {
    const int64_t low = b[MPSI_BLOCK_LOW + c], high = b[MPSI_BLOCK_HIGH + c];
    const int64_t reach = mpsi_reach(mpm, c);
    if (c >= mpm->dim ? low != 0 || high != 1
                      : low < 0 || high > MPSI_SIDE + 2 + reach || high - low <= reach)
      return false;
  }
  return true;
}

static bool orderly(const mps_mpm *mpm, const mpsi_mpm_record *r) {
  if (r->blocks < 1 || r->blocks > mpm->p.count || r->block[0][0] != 0) return false;
  for (int64_t k = 0; k < r->blocks; k++) {
    const int64_t *b = r->block[k], *next = r->block[k + 1 < r->blocks ? k + 1 : k];
    for (int c = 0; c < 3; c++) /* far from where 32 bits end, also of the nodes */
      if (b[1 + c] < -MPSI_NO_WALL || b[1 + c] > MPSI_NO_WALL || (c >= mpm->dim && b[1 + c] != 0))
        return false;
    if (!within_tile(mpm, b)) return false;
    if (next == b) break;
    int c = 3;
    while (c > 1 && b[c] == next[c]) c--;
    if (b[0] >= next[0] || b[c] >= next[c]) return false;
  }
  return r->block[r->blocks - 1][0] < mpm->p.count;
}

/* Where the particle k of the file is: 1 in its tile, -1 in no place that a run leads to unless it
 * sorts next, and 0 in between: outside by what the steps' own arithmetic, which has fused
 * products, may round away. */
static int place_of(const mps_mpm *mpm, const int64_t *block, bool stale, const double *x,
                    int64_t k) {
  const double first = mpm->def.spline == 3 ? 1.0 : 0.5; /* see move in g2p.c */
  int place = 1;
  for (int c = 0; c < mpm->dim; c++) {
    const double X = mpsi_grid_coordinate(mpm, c, x[c * mpm->p.count + k]);
    const double low = (double)mpm->grid.low[c], high = (double)mpm->grid.high[c];
    if (!(fabs(X) < MPSI_MAX_CELLS && X >= low - ROUNDED && X <= high + ROUNDED)) return -1;
    if (stale) continue;
    const double local = X - (double)(block[MPSI_BLOCK_AT + c] * MPSI_SIDE) - first;
    const double begin = (double)block[MPSI_BLOCK_LOW + c];
    const double end = (double)(block[MPSI_BLOCK_HIGH + c] - mpsi_reach(mpm, c));
    if (local < begin - ROUNDED || local > end + ROUNDED) return -1;
    if (!(local >= begin && local < end)) place = 0;
  }
  return place;
}

bool mpsi_mpm_fits_record(const mps_mpm *mpm, mpsi_mpm_record *r, const double *x,
                          const int64_t *law) {
  if (!(r->speed > 0.0 && isfinite(r->speed)) || !orderly(mpm, r)) return false;
  for (int k = 0; k < MPSI_HOLDS; k++)
    if (!isfinite(r->found[k])) return false;
  for (int64_t k = 0, b = 0; k < mpm->p.count; k++) {
    if (mpm->p.law && !(law && law[k] >= 0 && law[k] < mpm->laws.count)) return false;
    if (b + 1 < r->blocks && k == r->block[b + 1][0]) b++;
    const int place = place_of(mpm, r->block[b], r->stale != 0, x, k);
    if (place < 0) return false;
    if (place == 0) r->stale = 1; /* it needs no block then */
  }
  return true;
}

mps_status mpsi_mpm_set_record(mps_mpm *mpm, const char *function, const mpsi_mpm_record *record,
                               double time, int64_t steps) {
  mpm->run.broken = true;
  mps_status status = mpsi_mpm_place_blocks(mpm, function, record->blocks, record->block);
  if (status == MPS_OK) status = mpsi_mpm_put_dashes(mpm, function, record->dashes, record->dash);
  if (status != MPS_OK) return status;
  for (int32_t b = 0; b < mpm->contact.bodies; b++)
    mpsi_body_set_record(mpm->contact.body[b], &record->body[b]);
  for (int k = 0; k < MPSI_HOLDS; k++) {
    mpm->boundaries.hold[k].finds = record->finds[k] != 0,
    mpm->boundaries.hold[k].found = record->found[k];
    memcpy(mpm->boundaries.hold[k].force, &record->force[3 * k],
           sizeof mpm->boundaries.hold[k].force);
  }
  mpm->run.stale = record->stale != 0;
  mpm->run.speed = record->speed;
  mpm->run.time = time;
  mpm->run.steps = steps;
  mpm->run.broken = false;
  return MPS_OK;
}
