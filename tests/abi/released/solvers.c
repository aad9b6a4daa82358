/* solvers.c - what each solver computes, as lines "solver quantity: numbers".
 *
 *   solvers run            40 steps of each scene
 *   solvers save FOLDER    20 steps of each, saved as FOLDER/<solver>.h5
 *   solvers restore FOLDER the other 20, from these files
 *
 * The second half of a run and a restored one print the same. SPDX-License-Identifier: BSD-3-Clause */
#include "scenes.h"

#include <stdio.h>
#include <string.h>

enum { HALF = 20 };

static void line(const char *solver, const char *name, int count, const double *values) {
  printf("%s %s:", solver, name);
  for (int k = 0; k < count; k++) printf(" %.12g", values[k]);
  printf("\n");
}

/* A field of the set, by ids, as the order of the particles may change. */
static void field(const scene *s, const char *solver, const char *name, int components) {
  double values[3 * 256] = {0};
  mps_view view, ids;
  if (mps_particles_view(s->set, name, &view) != MPS_OK || mps_particles_view(s->set, "id", &ids) != MPS_OK) return;
  for (int64_t i = 0; i < view.shape[0] && i < 256; i++) {
    const int64_t id = *mps_view_i64(&ids, i, 0);
    for (int c = 0; c < components && id < 256; c++) values[components * id + c] = *mps_view_f64(&view, i, c);
  }
  line(solver, name, components * (int)view.shape[0], values);
}

static void print(const scene *s, const char *name) {
  mps_totals totals;
  mps_reaction reaction;
  mps_body_state state;
  const double time[2] = {mps_solver_time(s->solver), (double)mps_solver_steps(s->solver)};
  line(name, "time and steps", 2, time);
  if (mps_solver_get_totals(s->solver, &totals) == MPS_OK) {
    const double momentum[4] = {totals.mass, totals.linear[0], totals.linear[1], totals.angular[2]};
    const double energy[6] = {totals.kinetic,     totals.strain,          totals.dissipated,
                              totals.work_loads, totals.work_boundaries, totals.work_bodies};
    line(name, "mass and momentum", 4, momentum);
    line(name, "energies", 6, energy);
  }
  if (mps_solver_get_reaction(s->solver, s->mpm ? MPS_SIDE_Y_LOWER : 0, &reaction) == MPS_OK) {
    line(name, "force of the base", 2, reaction.force);
    line(name, "impulse of the base", 2, reaction.impulse);
  }
  if (s->body && mps_body_get_state(s->body, &state) == MPS_OK) {
    line(name, "place of the body", 2, state.position);
    line(name, "velocity of the body", 2, state.velocity);
  }
  field(s, name, "position", 2);
  field(s, name, "velocity", 2);
}

static mps_status act(scene *s, int kind, const char *what, const char *path) {
  mps_status status = scene_make(s, kind);
  if (status == MPS_OK && strcmp(what, "restore") == 0) status = mps_solver_restore(s->solver, path, NULL);
  if (status == MPS_OK) status = mps_solver_step(s->solver, HALF);
  if (status == MPS_OK && strcmp(what, "save") == 0) status = mps_solver_save(s->solver, path, NULL);
  if (status == MPS_OK && strcmp(what, "run") == 0) status = mps_solver_step(s->solver, HALF);
  if (status == MPS_OK && strcmp(what, "save") != 0) print(s, scene_names[kind]);
  return status;
}

int main(int arguments, char **argument) {
  int failed = 0;
  if (arguments < 2) return 2;
  for (int kind = 0; kind < SCENES; kind++) {
    char path[1024];
    scene s;
    memset(&s, 0, sizeof s);
    snprintf(path, sizeof path, "%s/%s.h5", arguments > 2 ? argument[2] : ".", scene_names[kind]);
    const mps_status status = act(&s, kind, argument[1], path);
    if (status != MPS_OK) printf("%s: %s (%s)\n", scene_names[kind], mps_status_text(status), mps_last_error()->message);
    failed += status != MPS_OK && status != MPS_ERROR_UNSUPPORTED;
    scene_drop(&s);
  }
  return failed;
}
