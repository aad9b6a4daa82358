/* state.c - the state of each object as its public functions report it, in parts that have names
 * and hashes: fields by particles' ids, so that the order is a part of its own.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "api.h"

#include "body/body_internal.h"

#include <mps/mps.h>
#include <mps/experimental/coupling.h>
#include <mps/experimental/neighbours.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct look {
  api *a;
  api_part *parts;
  int count;
  const char *prefix;
} look;

static uint64_t fold(uint64_t hash, uint64_t value) { return api_mix(hash ^ value); }

static uint64_t fold_real(uint64_t hash, double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return fold(hash, bits);
}

static uint64_t fold_reals(uint64_t hash, int count, const double *values) {
  for (int k = 0; k < count; k++) hash = fold_real(hash, values[k]);
  return hash;
}

static void add(look *l, const char *name, uint64_t hash) {
  if (l->count >= API_PARTS) return;
  api_part *part = &l->parts[l->count++];
  snprintf(part->name, sizeof part->name, "%s%.36s", l->prefix, name);
  part->hash = hash;
  part->finite = true;
  part->open = false;
}

/* The part that was added last. */
static void not_finite(look *l) { l->parts[l->count - 1].finite = false; }

/* Numbers that must be finite. */
static void add_finite(look *l, const char *name, int count, const double *values) {
  add(l, name, fold_reals(0, count, values));
  for (int k = 0; k < count; k++)
    if (!isfinite(values[k])) not_finite(l);
}

static void add_real(look *l, const char *name, double value) { add(l, name, fold_real(0, value)); }

static void add_whole(look *l, const char *name, int64_t value) {
  add(l, name, fold(0, (uint64_t)value));
}

/* ---- sets ------------------------------------------------------------------------------------ */

/* A field that is open for writing may hold anything. */
static bool is_open(mps_particles *set, const char *name) {
  mps_edit edit;
  const mps_status status = mps_particles_edit(set, name, &edit);
  if (status == MPS_OK && mps_particles_abandon(set, &edit) != MPS_OK) return true;
  return status == MPS_ERROR_STATE;
}

static void add_field(look *l, mps_particles *set, const char *name, const mps_view *ids) {
  mps_view view;
  if (mps_particles_view(set, name, &view) != MPS_OK) {
    add(l, name, 0);
    return;
  }
  uint64_t sum = (uint64_t)view.shape[1];
  bool finite = true;
  for (int64_t i = 0; i < view.shape[0]; i++) {
    uint64_t hash = (uint64_t)*mps_view_i64(ids, i, 0);
    for (int64_t c = 0; c < view.shape[1]; c++)
      if (view.dtype.code == 2) {
        const double value = *mps_view_f64(&view, i, c);
        finite = finite && isfinite(value);
        hash = fold_real(hash, value);
      } else {
        hash = fold(hash, (uint64_t)*mps_view_i64(&view, i, c));
      }
    sum += api_mix(hash);
  }
  add(l, name, sum);
  if (finite) return;
  l->parts[l->count - 1].open = is_open(set, name);
  if (!l->parts[l->count - 1].open) not_finite(l);
}

static void look_set(look *l, mps_particles *set) {
  mps_view ids;
  uint64_t order = 0;
  add_whole(l, "epoch", (int64_t)mps_particles_epoch(set));
  add_whole(l, "count", mps_particles_count(set));
  if (mps_particles_view(set, "id", &ids) != MPS_OK) return;
  for (int64_t i = 0; i < ids.shape[0]; i++)
    order = fold(order, (uint64_t)*mps_view_i64(&ids, i, 0));
  add(l, "order", order);
  for (int32_t k = 0; k < mps_particles_field_count(set); k++) {
    mps_particles_field_info info;
    if (mps_particles_get_field_info(set, k, &info) == MPS_OK) add_field(l, set, info.name, &ids);
  }
}

/* The set of a solver, where the caller has released its own reference. */
static void look_lent(look *l, mps_particles *set) {
  for (int k = 0; k < API_SLOTS; k++)
    if (l->a->objects[API_SET][k].handle == set) return;
  l->prefix = "set ";
  look_set(l, set);
  l->prefix = "";
}

/* ---- reactions and totals -------------------------------------------------------------------- */

static void add_reaction(look *l, const char *name, int number, mps_status status,
                         const mps_reaction *r) {
  char text[40];
  if (status != MPS_OK) return;
  snprintf(text, sizeof text, "%s %d", name, number);
  uint64_t hash = fold(fold(0, (uint64_t)r->count), (uint64_t)r->removed);
  const double values[] = {
      r->force[0],   r->force[1],          r->force[2],          r->moment[0],
      r->moment[1],  r->moment[2],         r->impulse[0],        r->impulse[1],
      r->impulse[2], r->moment_impulse[0], r->moment_impulse[1], r->moment_impulse[2],
      r->work,       r->removed_mass};
  add(l, text, fold_reals(hash, API_COUNT(values), values));
  for (int k = 0; k < API_COUNT(values); k++)
    if (!isfinite(values[k])) not_finite(l);
}

/* What each solver can always report, and the rest, which may be NaN. */
static void add_totals(look *l, mps_status status, const mps_totals *t) {
  if (status != MPS_OK) {
    add_whole(l, "totals: status", status);
    return;
  }
  add_finite(l, "mass", 1, &t->mass);
  add_finite(l, "volume", 1, &t->volume);
  add_finite(l, "momentum", 3, t->linear);
  add_finite(l, "angular momentum", 3, t->angular);
  add_finite(l, "kinetic energy", 1, &t->kinetic);
  const double others[] = {t->strain,     t->dissipated,      t->scheme,
                           t->work_loads, t->work_boundaries, t->work_bodies};
  add(l, "energies", fold_reals(0, API_COUNT(others), others));
  for (int k = 0; k < API_COUNT(others); k++)
    if (isinf(others[k])) not_finite(l);
}

#define LOOK_REACTIONS(get, solver, name, most)                                                    \
  for (int32_t k = 0; k < (most); k++) {                                                           \
    mps_reaction reaction;                                                                         \
    const mps_status given = get(solver, k, &reaction);                                            \
    add_reaction(l, name, k, given, &reaction);                                                    \
  }

/* ---- solvers --------------------------------------------------------------------------------- */

/* What all solvers show alike: time, steps, dt, totals. */
#define LOOK_RUN(l, type, solver)                                                                  \
  do {                                                                                             \
    mps_totals totals;                                                                             \
    add_real(l, "time", type##_time(solver));                                                      \
    add_whole(l, "steps", type##_steps(solver));                                                   \
    add_real(l, "dt", type##_dt(solver));                                                          \
    const mps_status status = type##_get_totals(solver, &totals);                                  \
    add_totals(l, status, &totals);                                                                \
  } while (0)

static void look_mpm(look *l, mps_mpm *mpm) {
  LOOK_RUN(l, mps_mpm, mpm);
  add_real(l, "limit", mps_mpm_limit(mpm));
  LOOK_REACTIONS(mps_mpm_get_reaction, mpm, "reaction", 10)
  look_lent(l, mps_mpm_particles(mpm));
}

static void look_dynamics(look *l, mps_dynamics *dynamics) {
  mps_totals totals;
  mps_dynamics_def def;
  add_real(l, "time", mps_dynamics_time(dynamics));
  add_whole(l, "steps", mps_dynamics_steps(dynamics));
  /* Where dt is not yet chosen, totals would choose it. */
  const bool chosen = mps_dynamics_get_def(dynamics, &def) == MPS_OK && !isnan(def.dt);
  add_real(l, "dt", chosen ? def.dt : 0.0);
  const mps_status status = chosen ? mps_dynamics_get_totals(dynamics, &totals) : MPS_ERROR_STATE;
  add_totals(l, status, &totals);
  LOOK_REACTIONS(mps_dynamics_get_reaction, dynamics, "reaction", 4)
  look_lent(l, mps_dynamics_particles(dynamics));
}

static void look_elastic(look *l, mps_elastic *elastic) {
  LOOK_RUN(l, mps_elastic, elastic);
  add_whole(l, "facets", mps_elastic_facet_count(elastic));
  LOOK_REACTIONS(mps_elastic_get_reaction, elastic, "reaction", 4)
  look_lent(l, mps_elastic_particles(elastic));
}

static void look_fluid(look *l, mps_fluid *fluid) {
  mps_fluid_report r;
  LOOK_RUN(l, mps_fluid, fluid);
  add_real(l, "limit", mps_fluid_limit(fluid));
  if (mps_fluid_get_report(fluid, &r) == MPS_OK) {
    const int64_t counts[] = {r.surface, r.apart, r.collisions, r.limited, r.pushed};
    uint64_t hash = 0;
    for (int k = 0; k < API_COUNT(counts); k++) hash = fold(hash, (uint64_t)counts[k]);
    add(l, "report", hash);
  }
  LOOK_REACTIONS(mps_fluid_get_reaction, fluid, "reaction", 5)
  look_lent(l, mps_fluid_particles(fluid));
}

/* ---- the others ------------------------------------------------------------------------------ */

static void look_body(look *l, mps_body *body) {
  mps_body_state s;
  mps_body_totals t;
  mps_reaction reaction;
  if (mps_body_get_state(body, &s) == MPS_OK) {
    uint64_t hash = fold_reals(fold_real(0, s.time), 3, s.position);
    hash = fold_reals(fold_reals(hash, 3, s.rotation), 9, s.orientation);
    add(l, "pose", hash);
    add_finite(l, "position", 3, s.position);
    add_finite(l, "orientation", 9, s.orientation);
    add_finite(l, "velocity", 3, s.velocity);
    add_finite(l, "spin", 3, s.spin);
  }
  if (mps_body_get_totals(body, &t) == MPS_OK) {
    const double values[] = {t.mass,          t.linear[0],  t.linear[1],  t.linear[2],
                             t.angular[0],    t.angular[1], t.angular[2], t.kinetic,
                             t.work_contacts, t.work_loads, t.dissipated};
    add_finite(l, "totals", API_COUNT(values), values);
  }
  add_whole(l, "parts", body->parts);
  for (int32_t k = -1; k < body->parts && k < 3; k++) {
    const mps_status status = mps_body_get_reaction(body, k, &reaction);
    add_reaction(l, "reaction", k, status, &reaction);
  }
}

static void look_coupling(look *l, mps_coupling *coupling) {
  mps_coupling_report r;
  double values[512];
  int64_t count = 0;
  if (mps_coupling_get_report(coupling, &r) == MPS_OK) {
    add_whole(l, "steps", r.steps);
    add_whole(l, "repeats", r.all_repeats);
  }
  if (mps_coupling_get_memory(coupling, API_COUNT(values), &count, values) == MPS_OK)
    add(l, "memory", fold_reals((uint64_t)count, count < 512 ? (int)count : 512, values));
}

/* The rows, of which the columns of the history are three at most. */
static void look_history(look *l, mps_history *history) {
  static const char *const columns[] = {"t", "a", "b"};
  uint64_t hash = 0;
  for (int c = 0; c < API_COUNT(columns); c++) {
    mps_view view;
    if (mps_history_view(history, columns[c], &view) != MPS_OK) continue;
    for (int64_t k = 0; k < view.shape[0]; k++)
      hash = fold_real(hash, *mps_view_f64(&view, k, 0));
  }
  add_whole(l, "count", mps_history_count(history));
  add(l, "rows", hash);
}

static void look_neighbours(look *l, mps_neighbours *neighbours) {
  int64_t count = 0;
  const int64_t *offsets = NULL, *indices = NULL;
  if (mps_neighbours_lists(neighbours, &count, &offsets, &indices) != MPS_OK) return;
  uint64_t hash = (uint64_t)count;
  for (int64_t i = 0; i < count; i++)
    for (int64_t k = offsets[i]; k < offsets[i + 1]; k++) hash = fold(hash, (uint64_t)indices[k]);
  add(l, "lists", hash);
}

/* The C of mps_elastic_get_totals: of which rounding in the budget of energies is a multiple. */
static double contrast_of(mps_elastic *elastic) {
  mps_particles *set = mps_elastic_particles(elastic);
  mps_view young, density;
  double least = INFINITY, most = 0.0;
  const double dt = mps_elastic_dt(elastic), spacing = mps_particles_spacing(set);
  if (mps_particles_view(set, "young", &young) != MPS_OK) return 0.0;
  const bool moves = dt > 0.0 && mps_particles_view(set, "density", &density) == MPS_OK;
  for (int64_t i = 0; i < young.shape[0]; i++) {
    const double value = *mps_view_f64(&young, i, 0);
    least = fmin(least, value), most = fmax(most, value);
    if (moves)
      least = fmin(least, 4.0 * *mps_view_f64(&density, i, 0) * spacing * spacing / dt / dt);
  }
  return most / least;
}

int api_look(api *a, api_kind kind, api_object *object, api_part *parts) {
  look l = {.a = a, .parts = parts, .prefix = ""};
  mps_reaction reaction;
  switch (kind) {
  case API_SET:
    look_set(&l, object->handle);
    break;
  case API_BODY:
    look_body(&l, object->handle);
    break;
  case API_CONTACT: {
    const mps_status status = mps_contact_get_reaction(object->handle, -1, &reaction);
    add_reaction(&l, "reaction", -1, status, &reaction);
    break;
  }
  case API_HISTORY:
    look_history(&l, object->handle);
    break;
  case API_NEIGHBOURS:
    look_neighbours(&l, object->handle);
    break;
  case API_COUPLING:
    look_coupling(&l, object->handle);
    break;
  case API_MPM:
    look_mpm(&l, object->handle);
    break;
  case API_DYNAMICS:
    look_dynamics(&l, object->handle);
    break;
  case API_ELASTIC:
    look_elastic(&l, object->handle);
    object->contrast = fmax(object->contrast, contrast_of(object->handle));
    break;
  case API_FLUID:
    look_fluid(&l, object->handle);
    break;
  default: /* immutable, or without a state that can be read */
    break;
  }
  return l.count;
}
