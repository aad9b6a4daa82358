/* calls_solver.c - common parts of the calls of all solvers: ends of runs, files and their damage,
 * states to compare. SPDX-License-Identifier: BSD-3-Clause */
#include "calls_solver.h"

#include <stdio.h>
#include <stdlib.h>

void api_stepped(api *a, mps_status status, int64_t before, int64_t after) {
  if (after != before || status == MPS_ERROR_DIVERGED)
    a->change = API_CHANGES_ALL;
  else
    a->change = API_CHANGES_ORDER;
}

void api_reads_edits(api *a, api_kind kind, const api_object *o, mps_status status) {
  if (kind == API_MPM) a->change = status == MPS_OK ? API_CHANGES_ORDER : API_CHANGES_PLACES;
  if (kind == API_DYNAMICS && status == MPS_OK) /* a motion begins: positions follow */
    a->change = o->rewritten ? API_CHANGES_ALL : API_CHANGES_ORDER;
}

double api_t_end(api *a, double time, double dt) {
  if (!(dt > 0.0 && dt < 1e300)) dt = 1e-3;
  double t_end = time + dt * 4.0 * api_unit(a);
  if (api_chance(a, 10)) t_end = time;
  if (a->mood == API_ABSURD && api_chance(a, 30)) {
    const double values[] = {NAN, INFINITY, -INFINITY, time - 1.0};
    t_end = values[api_below(a, 4)];
    if (t_end != time) api_wrong(a, "t_end"); /* time - 1 may round to it */
  }
  api_say(a, "t_end = %.17g, ", t_end);
  return t_end;
}

void api_path(api *a, char path[300], const char *kind) {
  snprintf(path, 300, "%s/%s.h5", a->folder, kind);
  if (a->mood == API_ABSURD && api_chance(a, 10)) {
    snprintf(path, 300, "%s/no/such", a->folder);
    api_wrong(a, "path");
  }
  api_say(a, "\"%s\", ", kind);
}

void api_damage(api *a, const char *path) {
  if (a->mood != API_ABSURD || !api_chance(a, 50)) return;
  FILE *file = fopen(path, "rb");
  if (!file) return;
  char *bytes = malloc(1 << 18);
  size_t length = bytes ? fread(bytes, 1, 1 << 18, file) : 0;
  (void)fclose(file);
  if (length > 0) {
    const uint32_t at = api_below(a, (uint32_t)length);
    const bool cut = api_chance(a, 50);
    if (cut)
      length = at;
    else
      bytes[at] = (char)api_below(a, 256);
    api_say(a, "/* %s byte %u */ ", cut ? "cut at" : "another", at);
    file = fopen(path, "wb");
    if (file) {
      (void)!fwrite(bytes, 1, length, file);
      (void)fclose(file);
      api_record_file(path, bytes, length);
    }
  }
  free(bytes);
}

bool api_field_acts(mps_particles *set) {
  static const char *const names[] = {"external_force", "body_acceleration", "damping"};
  mps_view view;
  for (int k = 0; k < API_COUNT(names); k++) {
    if (!mps_particles_has_field(set, names[k]) ||
        mps_particles_view(set, names[k], &view) != MPS_OK)
      continue;
    for (int64_t i = 0; i < view.shape[0]; i++)
      for (int64_t c = 0; c < view.shape[1]; c++)
        if (*mps_view_f64(&view, i, c) != 0.0) return true;
  }
  return false;
}

void api_add_impulse(api_account *account, mps_status status, const mps_reaction *reaction) {
  if (status != MPS_OK) return;
  account->removed += reaction->removed_mass;
  for (int c = 0; c < 3; c++) account->impulse[c] += reaction->impulse[c];
}

static void balance_energy(api *a, const api_object *o, const mps_totals *x, const mps_totals *y) {
  const double change[] = {y->kinetic - x->kinetic,
                           y->strain - x->strain,
                           y->dissipated - x->dissipated,
                           x->work_loads - y->work_loads,
                           x->work_boundaries - y->work_boundaries,
                           x->work_bodies - y->work_bodies};
  const double sizes[] = {y->kinetic,    y->strain,          y->dissipated,
                          y->work_loads, y->work_boundaries, y->work_bodies};
  double sum = 0.0, largest = fmax(1e-12, fabs(y->scheme));
  for (int k = 0; k < API_COUNT(change); k++) {
    sum += change[k];
    largest = fmax(largest, fmax(fabs(change[k]), fabs(sizes[k])));
  }
  if (!(largest < 1e15) || isnan(sum)) return; /* not counted, or beyond what has digits left */
  const double scheme = y->scheme - x->scheme;
  if (!(fabs(sum) <= 1e-8 * largest))
    api_broken(a, "succeeds, and the energies miss %g of %g J", sum, largest);
  else if (o->exact && !(fabs(scheme) <= fmax(1e-8, 1e-14 * o->contrast) * largest))
    api_broken(a, "succeeds, and its scheme adds %g to %g J", -scheme, largest);
}

static void balance_momentum(api *a, const api_account *before, const api_account *after) {
  const mps_totals *x = &before->totals, *y = &after->totals;
  for (int c = after->radial ? 1 : 0; c < 3; c++) {
    const double weight = y->mass * after->gravity[c] * (after->time - before->time);
    const double given = after->impulse[c] - before->impulse[c] + weight;
    const double sizes[] = {x->linear[c], y->linear[c], after->impulse[c], weight,
                            sqrt(2.0 * y->mass * (x->kinetic + y->kinetic))};
    double largest = 1e-12;
    for (int k = 0; k < API_COUNT(sizes); k++) largest = fmax(largest, fabs(sizes[k]));
    const double missing = y->linear[c] - x->linear[c] - given;
    if (!(largest < 1e15) || fabs(missing) <= 1e-8 * largest) continue;
    api_broken(a, "succeeds, and the momentum along %c misses %g of %g N s", "xyz"[c], missing,
               largest);
  }
}

void api_balance(api *a, const api_object *o, const api_account *before, const api_account *after,
                 bool momentum) {
  const mps_totals *x = &before->totals, *y = &after->totals;
  if (after->status != MPS_OK) return;
  const double gone = after->removed - before->removed;
  if ((after->count == before->count || !a->pushed) &&
      !(fabs(y->mass + gone - x->mass) <= 1e-9 * fabs(x->mass)))
    api_broken(a, "succeeds, and the mass is %.17g, not %.17g less %.17g", y->mass, x->mass, gone);
  if (after->count != before->count) return;
  if (o->rewritten) return; /* prescribed particles are set to their boundary */
  if (!o->loose) balance_energy(a, o, x, y);
  if (momentum && !o->drags && !a->pushed && !before->pushed && !after->pushed)
    balance_momentum(a, before, after);
}

void api_read(api *a, api_kind kind, api_object *o, mps_particles *set, api_state *state) {
  api_object lent = {.handle = set, .context = -1};
  state->count[0] = api_look(a, kind, o, state->parts[0]);
  state->count[1] = api_look(a, API_SET, &lent, state->parts[1]);
}

void api_same(api *a, const api_state *x, const api_state *y, const char *but, const char *when) {
  for (int k = 0; k < 2; k++) {
    if (x->count[k] != y->count[k])
      api_broken(a, "%d parts %s, not %d", y->count[k], when, x->count[k]);
    for (int p = 0; p < x->count[k] && p < y->count[k]; p++)
      if (x->parts[k][p].hash != y->parts[k][p].hash && !strstr(x->parts[k][p].name, "epoch") &&
          !(but && strcmp(x->parts[k][p].name, but) == 0))
        api_broken(a, "another %s %s", x->parts[k][p].name, when);
  }
}

/* ---- linear solvers -------------------------------------------------------------------------- */

void api_set_linear_solver(api *a, mps_solver *solver, int32_t equation) {
  mps_linear_solver_def def = mps_linear_solver_defaults();
  def.user = &a->plan;
  def.matrix = a->mood == API_ABSURD && api_chance(a, 6) ? NULL : api_linear_matrix;
  def.solve = a->mood == API_ABSURD && api_chance(a, 6) ? NULL : api_linear_solve;
  api_define(a, MPS_DEF_LINEAR_SOLVER, &def, 0, "least 40");
  if (api_chance(a, 50)) def.forget = api_linear_forget;
  const bool out = a->wrong == 0 && api_chance(a, 60);
  if (a->mood == API_ABSURD && api_chance(a, 10)) equation = 4, api_wrong(a, "equation");
  (void)api_end(a, mps_solver_set_linear_solver(solver, equation, out ? NULL : &def));
}
