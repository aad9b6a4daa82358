/* run.c - the run of mps-dam-break by either method: samples, frames, and checkpoints to restart
 * from
 * (common/resume.h). SPDX-License-Identifier: BSD-3-Clause */
#include "dam_break.h"

#include "common/frame.h"
#include "common/mpm_course.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHOT_EVERY = SAMPLES / (FRAMES - 1) };

static double time_now(const simulation *sim) {
  return sim->s.method == METHOD_MPS ? mps_fluid_time(sim->m.fluid) : mps_mpm_time(sim->m.mpm);
}

/* ---- what the run has seen ------------------------------------------------------------------- */

static void pass(void *user, resume_bytes *b) {
  simulation *sim = user;
  int64_t rows = sim->rows, gauges = sim->gauges;
  resume_pass(b, &rows, sizeof rows);
  resume_pass(b, &gauges, sizeof gauges);
  if (resume_wrong(b, rows < 0 || rows > SAMPLES + 1 || gauges < 0 || gauges > b->size)) return;
  while (b->reads && sim->gauge_room < gauges)
    if (!dam_grow_gauge(sim)) {
      b->status = MPS_ERROR_MEMORY;
      return;
    }
  sim->rows = (int)rows, sim->gauges = gauges;
  resume_pass(b, sim->t, (size_t)rows * sizeof *sim->t);
  resume_pass(b, sim->Z, (size_t)rows * sizeof *sim->Z);
  resume_pass(b, sim->H, (size_t)rows * sizeof *sim->H);
  resume_pass(b, sim->heap, (size_t)rows * sizeof *sim->heap);
  resume_pass(b, sim->gauge_t, (size_t)gauges * sizeof *sim->gauge_t);
  resume_pass(b, sim->gauge_p, (size_t)gauges * sizeof *sim->gauge_p);
  for (int k = 0; k < FRAMES; k++) resume_pass_snapshot(b, &sim->shot[k]);
}

static resume parts(simulation *sim) {
  return (resume){.key = "mps-dam-break 2",
                  .table = sim->table,
                  .pass = pass,
                  .user = sim,
                  .mpm = sim->m.mpm,
                  .fluid = sim->m.fluid,
                  .a = sim->m.a,
                  .domain = sim->m.a->domain};
}

static mps_status save(void *user) {
  simulation *sim = user;
  const resume r = parts(sim);
  return resume_save(&r, sim->s.checkpoint);
}

static mps_status restore(mps_context *context, simulation *sim) {
  const resume r = parts(sim);
  const mps_status status = resume_restore(context, &r, sim->s.restart);
  sim->m.samples = sim->rows;
  sim->restarted = time_now(sim);
  resume_schedule_at(&sim->saves, sim->restarted);
  return status;
}

/* ---- the run --------------------------------------------------------------------------------- */

mps_status dam_build(mps_context *context, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  const resume r = parts(sim);
  mps_status status = MPS_OK;
  sim->restarted = NAN;
  sim->saves = (resume_schedule){
      .path = s->checkpoint, .every = s->every_checkpoint, .save = save, .user = sim};
  if (s->restart) status = resume_peek(context, &r, s->restart, sim->m.why, sizeof sim->m.why);
  if (status == MPS_OK)
    status = s->method == METHOD_MPS ? dam_mps_build(context, sim) : dam_mpm_build(context, sim);
  if (status == MPS_OK && s->restart) status = restore(context, sim);
  return status;
}

static mps_status write_frame(simulation *sim) {
  mps_status status = MPS_OK;
  if (!sim->opened)
    status = mpm_model_series(&sim->m, sim->s.out, "water", sim->restarted, &sim->series);
  sim->opened = true;
  return status == MPS_OK ? mpm_model_frame(&sim->m, sim->series) : status;
}

static mps_status take_sample(simulation *sim, int k) {
  const settings *s = &sim->s;
  const char *pressure = s->method == METHOD_MPS ? "pressure" : "stress";
  mpm_heap *heap = &sim->heap[k];
  const mpm_heap_def def = {.g = G, .band = 2.0 * s->h};
  mps_status status = mpm_heap_measure(&sim->m, &def, heap);
  if (status == MPS_OK && k % SHOT_EVERY == 0)
    status = mpm_snapshot_take(&sim->m, time_now(sim), pressure, &sim->shot[k / SHOT_EVERY]);
  if (status == MPS_OK && frame_is_due(k, SAMPLES, s->frames)) status = write_frame(sim);
  sim->t[k] = time_now(sim);
  sim->Z[k] = heap->front / s->base;
  sim->H[k] = heap->top / column_height(s);
  if (status == MPS_OK) sim->m.samples = sim->rows = k + 1;
  return status;
}

mps_status dam_march(void *user) {
  simulation *sim = user;
  mps_status status = MPS_OK;
  progress_part(&sim->m.a->bar, 0.0, 1.0, 0.0, sim->s.duration);
  for (int k = sim->rows; k <= SAMPLES && status == MPS_OK; k++) {
    const double t = sim->s.duration * k / SAMPLES;
    if (sim->s.method == METHOD_MPS)
      status = dam_mps_advance(sim, t);
    else if (k > 0)
      status = mpm_model_advance(&sim->m, t, INT64_MAX, NULL, NULL);
    if (status == MPS_OK) status = take_sample(sim, k);
    if (status == MPS_OK) resume_save_when_due(sim->m.a, &sim->saves, time_now(sim));
  }
  if (status == MPS_ERROR_CANCELLED) resume_save_now(sim->m.a, &sim->saves);
  if (status == MPS_ERROR_CANCELLED) resume_tell(&sim->saves);
  sim->m.failed = sim->saves.lost;
  return status;
}
