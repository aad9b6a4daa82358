/* run.c - the run of mps-dam-break by either method: its samples. SPDX-License-Identifier:
 * BSD-3-Clause
 */
#include "dam_break.h"

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

/* ---- the run --------------------------------------------------------------------------------- */

mps_status dam_build(mps_context *context, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  sim->course = mpm_course_of(&s->course, &sim->m, s->out, "mps-dam-break 2", pass, sim);
  sim->course.what = "water";
  sim->course.duration = s->duration;
  mps_status status = mpm_course_peek(&sim->course, context);
  if (status == MPS_OK)
    status = s->method == METHOD_MPS ? dam_mps_build(context, sim) : dam_mpm_build(context, sim);
  if (status == MPS_OK) status = mpm_course_begin(&sim->course, context, true);
  sim->m.samples = sim->rows;
  return status;
}

static mps_status take_sample(simulation *sim, int k) {
  const settings *s = &sim->s;
  const char *pressure = s->method == METHOD_MPS ? "pressure" : "stress";
  mpm_heap *heap = &sim->heap[k];
  const mpm_heap_def def = {.g = G, .band = 2.0 * s->h};
  mps_status status = mpm_heap_measure(&sim->m, &def, heap);
  if (status == MPS_OK && k % SHOT_EVERY == 0)
    status = mpm_snapshot_take(&sim->m, time_now(sim), pressure, &sim->shot[k / SHOT_EVERY]);
  sim->t[k] = time_now(sim);
  sim->Z[k] = heap->front / s->base;
  sim->H[k] = heap->top / column_height(s);
  if (status != MPS_OK) return status;
  sim->m.samples = sim->rows = k + 1;
  return mpm_course_sample(&sim->course, k, SAMPLES);
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
  }
  return mpm_course_end(&sim->course, status);
}
