/* wall.c - see wall.h. SPDX-License-Identifier: BSD-3-Clause */
#include "wall.h"

#include <mps/experimental/fluid_parts.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct wall {
  app *a;
  mps_fluid *fluid;
  const wall_def *def;
  int dim;
  int64_t nodes; /* 1 where it stays plane */
  double *vertex, *place, *pressure;
  double *moved, *speed; /* at the end of the step, of each node */
  double *now, *kept;    /* displacements before the step; at the checkpoint */
  mps_snapshot *checkpoint;
} wall;

static bool reserve(wall *w) {
  const size_t n = (size_t)w->def->count;
  double **const arrays[] = {&w->vertex, &w->place, &w->pressure, &w->moved,
                             &w->speed,  &w->now,   &w->kept};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
    if (!(*arrays[k] = calloc(3 * n, sizeof(double)))) return app_no_memory(w->a);
  return true;
}

static void release(wall *w) {
  double *const arrays[] = {w->vertex, w->place, w->pressure, w->moved, w->speed, w->now, w->kept};
  mps_snapshot_destroy(&w->checkpoint);
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
}

/* Vectors of the vertices along the normal, of each node or their mean. */
static void project(const wall *w, const double *vectors, double *out) {
  double sum = 0.0;
  for (int64_t k = 0; k < w->def->count; k++) {
    double along = 0.0;
    for (int c = 0; c < w->dim; c++) along += vectors[k * w->dim + c] * w->def->normal[c];
    if (w->def->bends) out[k] = along;
    sum += along;
  }
  if (!w->def->bends) out[0] = sum / (double)w->def->count;
}

/* Pressures at the vertices, where the wall was added. */
static bool write_forces(wall *w, double *out) {
  if (!app_check(w->a, mps_fluid_get_pressure(w->fluid, w->def->number, w->def->count, w->place,
                                              w->pressure)))
    return false;
  for (int64_t k = 0; k < w->def->count; k++)
    for (int c = 0; c < w->dim; c++)
      out[k * w->dim + c] = -w->pressure[k] * w->def->area * w->def->normal[c];
  return true;
}

static bool begin(void *self, double *const *written) {
  wall *w = self;
  return write_forces(w, written[0]);
}

/* A whole step in one: with a repeated window the state is that of its beginning. */
static bool step(void *self, double dt, double *const *read, double *const *written) {
  wall *w = self;
  project(w, read[0], w->moved);
  if (w->def->velocity) project(w, read[1], w->speed);
  for (int64_t k = 0; k < w->nodes && !w->def->velocity; k++)
    w->speed[k] = (w->moved[k] - w->now[k]) / dt;
  if (!app_check(w->a, mps_fluid_begin_step(w->fluid, dt)) ||
      !app_check(w->a,
                 mps_fluid_set_boundary_motion(w->fluid, w->def->number, w->moved, w->speed)) ||
      !app_check(w->a, mps_fluid_solve_pressure(w->fluid)) || !write_forces(w, written[0]))
    return false;
  memcpy(w->now, w->moved, (size_t)w->nodes * sizeof *w->now);
  return app_check(w->a, mps_fluid_end_step(w->fluid));
}

static bool save(void *self) {
  wall *w = self;
  memcpy(w->kept, w->now, (size_t)w->nodes * sizeof *w->kept);
  return app_check(w->a, mps_fluid_snapshot(w->fluid, &w->checkpoint));
}

static bool undo(void *self) {
  wall *w = self;
  memcpy(w->now, w->kept, (size_t)w->nodes * sizeof *w->now);
  return app_check(w->a, mps_fluid_rollback(w->fluid, w->checkpoint));
}

static bool each(void *self) {
  wall *w = self;
  return !w->def->each || w->def->each(w->def->user, w->fluid);
}

bool wall_run(app *a, mps_fluid *fluid, const wall_def *def, participant_result *result) {
  wall w = {.a = a, .fluid = fluid, .def = def, .dim = 2, .nodes = def->bends ? def->count : 1};
  if (def->count < 1 || !(def->area > 0.0))
    return app_error(a, "a wall of %lld vertices of %g m2 each, must have 1 or more above 0",
                     (long long)def->count, def->area);
  bool good = reserve(&w);
  for (int64_t k = 0; good && k < def->count; k++) {
    memcpy(w.place + 3 * k, def->x + 3 * k, 3 * sizeof *w.place);
    memcpy(w.vertex + 2 * k, def->x + 3 * k, 2 * sizeof *w.vertex);
  }
  const loop_side side = {.self = &w,
                          .dim = w.dim,
                          .count = def->count,
                          .x = w.vertex,
                          .dt = fmin(def->dt, mps_fluid_dt(fluid)),
                          .reads = {def->displacement, def->velocity},
                          .writes = {def->force},
                          .step = step,
                          .begin = begin,
                          .save = save,
                          .undo = undo,
                          .each = each};
  good = good && loop_run(a, &side, def->config, def->name, def->mesh, result);
  release(&w);
  return good;
}
