/* step.c - running the WLS-MPM solver: the order of a step (Nakamura 6), its size, and what goes
 * wrong. SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

#include "core/particles_internal.h"

#include <string.h>

#define SMALL_SET 2048  /* particles: below, sharing the work costs more than it gains */
#define UNIT_NODES 4096 /* at least in a unit of work on nodes, which take a few ns each */
#define CHATTER 6.0     /* k dt^2/m above which a contact does not settle */

/* ---- work ------------------------------------------------------------------------------------ */

typedef struct work {
  mps_mpm *mpm;
  mpsi_mpm_task task;
  const int32_t *list; /* of what to work on, NULL: 0, 1, ... */
  int64_t count, grain;
} work;

static void unit_of_work(void *data, int64_t unit, int32_t worker) {
  const work *w = data;
  const int64_t last = (unit + 1) * w->grain;
  for (int64_t k = unit * w->grain; k < last && k < w->count; k++)
    w->task(w->mpm, w->list ? w->list[k] : k, worker);
}

static void share(mps_mpm *mpm, const int32_t *list, int64_t count, int64_t least,
                  mpsi_mpm_task task) {
  const int64_t most = mpm->count < SMALL_SET ? 1 : 8 * (int64_t)mpm->worker_count;
  const int64_t wanted = (count + least - 1) / least, units = wanted < most ? wanted : most;
  if (units == 0) return;
  work w = {mpm, task, list, count, (count + units - 1) / units};
  mpsi_parallel_for(mpm->context, units, unit_of_work, &w);
}

void mpsi_mpm_for_nodes(mps_mpm *mpm, mpsi_mpm_task task) {
  share(mpm, NULL, mpm->node_count, UNIT_NODES / mpm->own, task);
}

void mpsi_mpm_for_cells(mps_mpm *mpm, mpsi_mpm_task task) {
  share(mpm, NULL, mpm->cell_count, 1, task);
}

void mpsi_mpm_for_colours(mps_mpm *mpm, mpsi_mpm_task task) {
  for (int c = 0; c < 1 << mpm->dim; c++)
    share(mpm, mpm->coloured + mpm->colour[c], mpm->colour[c + 1] - mpm->colour[c], 1, task);
}

/* ---- one step -------------------------------------------------------------------------------- */

static mps_status report_bad(mps_mpm *mpm, const char *function, int64_t k) {
  const mpsi_columns *p = &mpm->p;
  const long long id = (long long)mpsi_particles_integers(mpm->particles, "id")[k];
  const bool space = mpm->dim == 3;
  const double z = space ? p->x[2][k] : 0.0, vz = space ? p->v[2][k] : 0.0;
  bool number = isfinite(p->V[k]);
  for (int c = 0; c < mpm->dim; c++)
    number = number && isfinite(p->x[c][k]) && isfinite(p->v[c][k]);
  mpm->broken = true;
  const mps_status status = mpsi_fail(
      mpm->context, function, MPS_ERROR_DIVERGED,
      "step %lld, t = %.6g s: particle %lld at (%.6g, %.6g, %.6g) m with velocity (%.4g, %.4g, "
      "%.4g) m/s and volume %.4g m3 %s; dt was %.4g s, %.3g of the limit (49): check dt, the "
      "contact stiffness and the initial stress",
      (long long)mpm->steps, mpm->time, id, p->x[0][k], p->x[1][k], z, p->v[0][k], p->v[1][k], vz,
      p->V[k], number ? "has left the domain or has no volume" : "is not finite", mpm->dt,
      mpm->dt * mpm->speed * mpm->inverse);
  mpsi_fail_where(mpm->context, mpm->steps, id);
  return status;
}

mps_status mpsi_mpm_take_stock(mps_mpm *mpm, const char *function) {
  double speed = 0.0;
  int64_t bad = -1;
  for (int64_t b = 0; b < mpm->cell_count; b++) {
    const mpsi_cells *cells = &mpm->cells[b];
    if (cells->bad >= 0 && bad < 0) bad = cells->bad;
    if (cells->left) mpm->stale = true;
    if (cells->speed > speed) speed = cells->speed;
    if (!cells->refused) continue;
    mpm->broken = true;
    return mpsi_fail(mpm->context, function, MPS_ERROR_NUMERIC,
                     "the law '%s' has refused a block of particles at step %lld",
                     mps_material_name(cells->refused), (long long)mpm->steps);
  }
  if (bad >= 0) return report_bad(mpm, function, bad);
  mpm->speed = speed;
  return MPS_OK;
}

static void find_contact_mass(mps_mpm *mpm) {
  memset(mpm->contact_mass, 0, sizeof mpm->contact_mass);
  for (int64_t t = 0; t < mpm->touch_count; t++)
    mpm->contact_mass[mpm->touch[t].body] += mpm->touch[t].mass;
}

/* Tells the log, once each, of a step too large for the present state. */
static void warn_of_step(mps_mpm *mpm, double dt) {
  const double limit = mps_mpm_limit(mpm), courant = mpm->def.courant;
  if (!mpm->told_of_dt && dt > courant * limit * (1.0 + 1e-9)) {
    mpm->told_of_dt = true;
    mpsi_log(mpm->context, MPS_LOG_WARNING,
             "step %lld: dt is %.4g s, %.3g of the limit (49), above the fraction courant = %g: "
             "choose a smaller dt, or 0 for a step that follows the limit",
             (long long)mpm->steps, dt, dt / limit, courant);
  }
  double stiffest = 0.0;
  for (int32_t k = 0; k < mpm->laws; k++) stiffest = fmax(stiffest, mpm->law[k].modulus);
  for (int32_t b = 0; b < mpm->bodies; b++) {
    const double k =
        mpsi_body_penalty(mpm->body[b], stiffest, 2.0 * mpm->gap, mpm->def.cell, mpm->def.courant);
    const double ratio = k * dt * dt / mpm->least_mass;
    if (!(ratio > CHATTER) || (mpm->told_of_chatter >> b & 1)) continue;
    mpm->told_of_chatter |= UINT32_C(1) << b;
    mpsi_log(mpm->context, MPS_LOG_WARNING,
             "contact with body %d will chatter: k dt^2/m = %.3g, above %g; use a penalty k of at "
             "most %.4g or a dt of at most %.4g s",
             b, ratio, CHATTER, k * CHATTER / ratio, dt * sqrt(CHATTER / ratio));
  }
}

static mps_status take_step(mps_mpm *mpm, const char *function, double dt) {
  const int32_t geometry = mpm->def.geometry, spline = mpm->def.spline - 2;
  mps_status status = MPS_OK;
  if (mpm->stale) {
    status = mpsi_mpm_sort(mpm, function);
    if (status == MPS_OK) status = mpsi_mpm_list_holds(mpm, function);
  }
  if (status == MPS_OK) status = mpsi_mpm_find_near(mpm, function);
  if (status != MPS_OK) {
    mpm->broken = true;
    return status;
  }
  mpm->dt = dt;
  warn_of_step(mpm, dt);
  mpsi_mpm_begin_holds(mpm, dt);
  mpsi_mpm_find_forces(mpm);
  mpsi_mpm_for_nodes(mpm, mpsi_mpm_clear_nodes);
  mpsi_mpm_for_colours(mpm, mpm->kernels->p2g[geometry][spline]);
  mpsi_mpm_for_nodes(mpm, mpsi_mpm_update_nodes);
  if (mpm->meeting_count > 0) find_contact_mass(mpm);
  mpsi_mpm_for_nodes(mpm, mpsi_mpm_finish_nodes);
  mpsi_mpm_for_cells(mpm, mpm->kernels->g2p[geometry][spline]);
  mpsi_mpm_sum_holds(mpm);
  if (mpm->stencil) mpsi_mpm_apply_laws_by_cell(mpm);
  if (mpm->bodies > 0) mpsi_mpm_react(mpm);
  mpm->time += dt;
  mpm->steps++;
  return mpsi_mpm_take_stock(mpm, function);
}

mps_status mpsi_mpm_ready(mps_mpm *mpm, const char *function) {
  if (!mpm->broken) return MPS_OK;
  return mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                   "an earlier step has failed: the state is kept for a look; make a new solver or "
                   "restore a checkpoint");
}

/* ---- running --------------------------------------------------------------------------------- */

double mps_mpm_limit(const mps_mpm *mpm) { return mpm ? mpm->def.cell / mpm->speed : 0.0; }

double mps_mpm_dt(const mps_mpm *mpm) {
  if (!mpm) return 0.0;
  return mpm->def.dt > 0.0 ? mpm->def.dt : mpm->def.courant * mps_mpm_limit(mpm);
}

double mps_mpm_time(const mps_mpm *mpm) { return mpm ? mpm->time : 0.0; }

int64_t mps_mpm_steps(const mps_mpm *mpm) { return mpm ? mpm->steps : 0; }

mps_status mps_mpm_step(mps_mpm *mpm, int64_t count) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  if (count < 0)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  mps_status status = mpsi_mpm_ready(mpm, __func__);
  for (int64_t k = 0; k < count && status == MPS_OK; k++)
    status = take_step(mpm, __func__, mps_mpm_dt(mpm));
  return status;
}

mps_status mps_mpm_run(mps_mpm *mpm, double t_end, int64_t every, mps_mpm_fn callback, void *user) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  if (!isfinite(t_end) || every < 1)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                     "t_end is %g s and every %lld: must be finite and >= 1", t_end,
                     (long long)every);
  mps_status status = mpsi_mpm_ready(mpm, __func__);
  const double start = mpm->time, slice = 0.01 * (t_end - start);
  int64_t done = 0, reported = 0;
  if (status == MPS_OK && callback) status = callback(user, mpm);
  while (status == MPS_OK && mpm->time < t_end) {
    double dt = mps_mpm_dt(mpm);
    const double rest = t_end - mpm->time;
    const bool last = rest <= dt * (1.0 + 1e-9);
    if (last) dt = rest;
    status = take_step(mpm, __func__, dt);
    if (last) mpm->time = t_end;
    done++;
    if (status == MPS_OK && callback && (done % every == 0 || last)) status = callback(user, mpm);
    if (last || mpm->time >= start + slice * (double)(reported + 1)) {
      reported = last ? 100 : (int64_t)((mpm->time - start) / slice);
      mpsi_progress(mpm->context, "mpm", mpm->steps, mpm->time - start, t_end - start);
    }
    if (status == MPS_OK && !last && mpsi_cancelled(mpm->context))
      status = mpsi_fail(mpm->context, __func__, MPS_ERROR_CANCELLED,
                         "stopped by the cancel hook at step %lld, t = %g s", (long long)mpm->steps,
                         mpm->time);
  }
  return status;
}

/* ---- questions ------------------------------------------------------------------------------- */

static int64_t grid_bytes(const mps_mpm *mpm) {
  const struct {
    int64_t capacity;
    size_t size;
  } list[] = {{mpm->cells_room.capacity, sizeof *mpm->cells},
              {mpm->coloured_room.capacity, sizeof *mpm->coloured},
              {mpm->nodes_room.capacity, sizeof *mpm->nodes},
              {mpm->node_room.capacity, sizeof *mpm->node},
              {mpm->side_room.capacity, sizeof *mpm->side},
              {mpm->meeting_room.capacity, sizeof *mpm->meeting},
              {mpm->touch_room.capacity, sizeof *mpm->touch},
              {mpm->touch_node_room.capacity, sizeof *mpm->touch_node},
              {mpm->inside_room.capacity, sizeof *mpm->inside},
              {mpm->reached_room.capacity, sizeof *mpm->reached},
              {mpm->held_room.capacity + mpm->old_held_room.capacity, sizeof *mpm->held},
              {mpm->dash_room.capacity + mpm->old_dash_room.capacity, sizeof *mpm->dash},
              {mpm->worker_count, mpsi_worker_bytes(mpm)},
              {mpm->force_memory ? mpm->count : 0, (size_t)mpm->dim * sizeof(double)},
              {mpm->stencil ? mpm->count : 0, sizeof *mpm->stencil},
              {mpm->count, 2 * sizeof *mpm->radix + sizeof *mpm->flags}};
  int64_t bytes = 0;
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    bytes += list[k].capacity * (int64_t)list[k].size;
  return bytes;
}

mps_status mps_mpm_get_totals(mps_mpm *mpm, mps_mpm_totals *out) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  const mpsi_columns *p = &mpm->p;
  const int dim = mpm->dim;
  const double h = mpm->def.cell, full = h * h / (mpm->def.spline == 3 ? 3.0 : 4.0);
  const double moment = mpm->standard ? 0.0 : full; /* particles without L carry no spin */
  mps_mpm_totals t = {
      .blocks = mpm->cell_count, .nodes = mpm->node_count * mpm->own, .bytes = grid_bytes(mpm)};
  for (int64_t k = 0; k < mpm->count; k++) {
    const double m = p->m[k];
    double x[3] = {0}, v[3] = {0}, L[3][3] = {{0}};
    for (int c = 0; c < dim; c++) {
      x[c] = p->x[c][k], v[c] = p->v[c][k];
      for (int d = 0; d < dim; d++) L[c][d] = p->L[dim * c + d][k];
      t.linear[c] += m * v[c];
      t.kinetic += 0.5 * m * v[c] * v[c];
    }
    for (int c = 0; c < 3; c++) {
      const int a = (c + 1) % 3, b = (c + 2) % 3;
      t.angular[c] += m * (x[a] * v[b] - x[b] * v[a] + moment * (L[b][a] - L[a][b]));
    }
    t.mass += m;
    t.volume += p->V[k];
  }
  *out = t;
  return MPS_OK;
}
