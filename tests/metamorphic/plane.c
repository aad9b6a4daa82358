/* plane.c - particles, edges and runs of lattices in the plane. SPDX-License-Identifier:
 * BSD-3-Clause */
#include "plane.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

mps_status make_lattice(lattice *g, const double *first) {
  const change *by = g->by;
  uint64_t r = g->random;
  mps_particles_def def = mps_particles_defaults();
  mps_edit v;
  def.spacing = SPACING * by->length;
  mps_status status = mps_particles_create(g->context, &def, &g->set);
  for (int k = 0; k < g->nx * g->ny; k++) {
    const double x[2] = {first[0] + SPACING * (k % g->nx), first[1] + SPACING * (k / g->nx)};
    double at[2];
    for (int c = 0; c < 2; c++)
      at[by->axis[c]] =
          by->sign[c] * x[c] * by->length + by->shift[by->axis[c]] * (SPACING * by->length);
    TRY(mps_particles_append(g->set, 1, at));
  }
  TRY(mps_particles_set(g->set, "density", 0, 1900.0 * by->mass / pow(by->length, 3.0)));
  TRY(mps_particles_add_field(g->set, "velocity", 0));
  TRY(mps_particles_edit(g->set, "velocity", &v));
  for (int64_t k = 0; status == MPS_OK && k < v.view.shape[0]; k++)
    for (int c = 0; c < 2; c++)
      *mps_edit_f64(&v, k, by->axis[c]) =
          by->sign[c] * (by->length / by->time) * uniform(&r, -0.1, 0.1);
  TRY(mps_particles_commit(g->set, &v));
  return status;
}

mps_status soften(lattice *g, const char *field) {
  mps_edit edit;
  mps_status status = mps_particles_edit(g->set, field, &edit);
  for (int64_t k = g->nx * g->ny / 2; status == MPS_OK && k < g->nx * g->ny; k++)
    *mps_edit_f64(&edit, k, 0) /= g->contrast;
  TRY(mps_particles_commit(g->set, &edit));
  return status;
}

mps_status make_signal(lattice *g, mps_signal **out) {
  return mps_signal_create_sine(g->context, MPS_SIGNAL_QUANTITY_DISPLACEMENT,
                                g->frequency / g->by->time, g->amplitude * g->by->length, g->phase,
                                out);
}

int64_t list_edge(const lattice *g, int edge, int64_t *ids) {
  int64_t count = 0;
  const int nx = g->nx, ny = g->ny, along = edge < 2 ? ny : nx;
  const int row = edge % 2 ? (edge < 2 ? nx : ny) - 1 : 0;
  for (int i = 0; i < along; i++) ids[count++] = edge < 2 ? (int64_t)i * nx + row : row * nx + i;
  return count;
}

static mps_status run(lattice *g, lattice_fn build, const char *folder) {
  const int64_t steps = g->steps[1] << g->by->halved;
  mps_snapshot *snapshot = NULL;
  char path[400];
  mps_status status = build(g);
  TRY(mps_solver_step(g->solver, g->steps[0] << g->by->halved));
  if (g->by->way == ROLLED_BACK) {
    TRY(mps_solver_snapshot(g->solver, &snapshot));
    TRY(mps_solver_step(g->solver, steps));
    TRY(mps_solver_rollback(g->solver, snapshot));
    mps_snapshot_destroy(&snapshot);
  }
  if (g->by->way == RESTORED) {
    snprintf(path, sizeof path, "%s/metamorphic-%d.h5", folder, (int)getpid());
    TRY(mps_solver_save(g->solver, path, NULL));
    mps_solver_destroy(&g->solver);
    mps_particles_destroy(&g->set);
    TRY(build(g));
    TRY(mps_solver_restore(g->solver, path, NULL));
    (void)remove(path);
  }
  for (int64_t k = 0; g->by->way != AT_ONCE && k < steps; k++) TRY(mps_solver_step(g->solver, 1));
  if (g->by->way == AT_ONCE) TRY(mps_solver_step(g->solver, steps));
  return status;
}

static mps_view view_of(lattice *g, const char *field) {
  mps_view view;
  if (mps_particles_view(g->set, field, &view) != MPS_OK) abort();
  return view;
}

static void keep(lattice *g, const char *place, result *out) {
  const change *by = g->by;
  const bool moves = strcmp(place, "position") == 0;
  const double scale[3] = {by->length, by->length / by->time, by->length / (by->time * by->time)};
  const mps_view id = view_of(g, "id"), turn = view_of(g, moves ? "rotation" : place),
                 view[3] = {view_of(g, place), view_of(g, "velocity"), view_of(g, "acceleration")};
  out->count = id.shape[0];
  for (int64_t k = 0; k < out->count; k++) {
    const int64_t i = *mps_view_i64(&id, k, 0);
    double(*to[3])[3] = {&out->position[i], &out->velocity[i], &out->stress[i][0]};
    out->here[i] = true;
    for (int f = 0; f < 3; f++)
      for (int c = 0; c < 2; c++) {
        const int a = by->axis[c];
        double x = *mps_view_f64(&view[f], k, a);
        if (f == 0 && moves) x -= by->shift[a] * (SPACING * by->length);
        (*to[f])[c] = by->sign[c] * x / scale[f];
      }
    if (moves) out->scalar[2][i] = sense_of_turns(by) * *mps_view_f64(&turn, k, 0);
  }
  for (int k = 0, number = 0; k < EDGES; k++) {
    mps_reaction r;
    if (g->kind[k] < 0) continue;
    if (mps_solver_get_reaction(g->solver, number++, &r) != MPS_OK) abort();
    for (int c = 0; c < 2; c++)
      out->impulse[k][c] =
          by->sign[c] * r.impulse[by->axis[c]] / (by->mass * by->length / by->time);
  }
}

void run_lattice(lattice *g, lattice_fn build, const char *place, const char *folder, result *out) {
  const int32_t threads = g->by->threads;
  mps_context_def def = mps_context_defaults();
  char why[200];
  memset(out, 0, sizeof *out);
  def.executor = threads > 0 ? MPS_CONTEXT_EXECUTOR_THREADS : MPS_CONTEXT_EXECUTOR_SERIAL;
  def.threads = threads > 0 ? threads : 1;
  if (mps_context_create(&def, &g->context, why, sizeof why) != MPS_OK) abort();
  out->status = run(g, build, folder);
  if (out->status != MPS_OK)
    snprintf(out->message, sizeof out->message, "%.190s", mps_context_error(g->context)->message);
  if (out->status == MPS_OK) keep(g, place, out);
  mps_solver_destroy(&g->solver);
  mps_particles_destroy(&g->set);
  mps_context_destroy(&g->context);
}

void print_lattice(const lattice *g) {
  printf("  %d x %d particles, contrast %g, edges %d %d %d %d, steps %d %d; ", g->nx, g->ny,
         g->contrast, (int)g->kind[0], (int)g->kind[1], (int)g->kind[2], (int)g->kind[3],
         (int)g->steps[0], (int)g->steps[1]);
}
