/* receivers.c - motion of chosen particles and energy during a run.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "wave.h"

#include "common/parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- choice of the particles ----------------------------------------------------------------- */

/* Adds component `component` of the particle nearest to (x, depth below the surface there), whose
 * position is added to the list. */
static void add(receivers *r, const column *c, double x, double depth, int32_t component,
                double *places) {
  places[2 * r->count] = x, places[2 * r->count + 1] = column_surface(c, x) - depth;
  r->list[r->count++].component = component;
}

static void add_all(receivers *r, const column *c, char wave, double *places) {
  const double half = 0.5 * c->spacing;
  const double middle = ((double)(c->nx / 2) + 0.5) * c->spacing;
  const double deepest = column_surface(c, middle) - half;
  const int32_t component = column_component(wave);
  for (int64_t k = 0; k < r->column; k++) {
    const double depth = half + (deepest - half) * (double)k / (double)(r->column - 1);
    add(r, c, middle, depth, component, places);
  }
  add(r, c, half, half, component, places);
  for (int32_t xy = 0; xy < 2 && c->def.sloped; xy++) {
    add(r, c, c->def.slope[0], half, xy, places);
    add(r, c, c->def.slope[1], half, xy, places);
  }
}

static void name(const receivers *r, const column *c, int64_t k, const double *position) {
  static const char *const beside[] = {"_edge", "_crest", "_toe", "_crest", "_toe"};
  receiver *q = &r->list[k];
  q->depth = column_surface(c, position[0]) - column_level(c, position[1]);
  snprintf(q->label, sizeof q->label, "a%c_m_s2_GL-%.4gm%s", q->component == 0 ? 'x' : 'y',
           q->depth, k < r->column ? "" : beside[k - r->column]);
}

bool receivers_create(app *a, const column *c, char wave, int64_t n, receivers *out) {
  const size_t most = (size_t)n + 5;
  *out = (receivers){.particles = c->particles, .column = n};
  out->list = calloc(most, sizeof *out->list);
  out->now = calloc(most + 1, sizeof *out->now);
  double *places = calloc(most * 4, sizeof *places), *position = places + 2 * most;
  int64_t *ids = calloc(most, sizeof *ids);
  const bool room = out->list && out->now && places && ids;
  bool ok = app_agree(a, room || app_no_memory(a));
  if (ok) {
    add_all(out, c, wave, places);
    ok = app_check(
        a, parts_nearest(c->def.domain, c->particles, (int32_t)out->count, places, ids, position));
  }
  for (int64_t k = 0; ok && k < out->count; k++) {
    out->list[k].id = ids[k];
    name(out, c, k, position + 2 * k);
  }
  free(places);
  free(ids);
  return ok;
}

void receivers_destroy(receivers *r) {
  free(r->list);
  free(r->row);
  free(r->now);
  *r = (receivers){0};
}

/* ---- recording ------------------------------------------------------------------------------- */

static double *next_row(receivers *r) {
  const int64_t width = r->count + 1;
  if (r->rows == r->capacity) {
    const int64_t capacity = r->capacity ? 2 * r->capacity : 1024;
    double *grown = realloc(r->row, (size_t)(capacity * width) * sizeof *grown);
    if (!grown) return NULL;
    r->row = grown;
    r->capacity = capacity;
  }
  return r->row + r->rows * width;
}

#define LITTLE 1e-4 /* of the energy of all ground at the input's speed: where a motion begins */
#define MOST_GROWTH 2.0 /* energy over the most that loads and boundaries have put in */

static mps_status record_energy(receivers *r, mps_dynamics *dynamics, bool drift) {
  mps_totals totals;
  const mps_status status = mps_dynamics_get_totals(dynamics, &totals);
  if (status != MPS_OK) return status;
  const double e = totals.kinetic + totals.strain;
  r->given = fmax(r->given, totals.work_loads + totals.work_boundaries);
  if (r->watch &&
      !(e <= MOST_GROWTH * r->given + 0.5 * LITTLE * totals.mass * r->speed * r->speed)) {
    r->grown = e;
    return MPS_ERROR_CANCELLED;
  }
  if (!drift) return MPS_OK;
  if (r->energies++ == 0) r->energy_least = r->energy_most = e;
  r->energy_least = fmin(r->energy_least, e);
  r->energy_most = fmax(r->energy_most, e);
  r->energy_sum += e;
  return MPS_OK;
}

mps_status receivers_record(receivers *r, mps_dynamics *dynamics, mps_domain *domain) {
  mps_view acceleration;
  /* The accelerations are those of the beginning of the last step. */
  if (mps_dynamics_steps(dynamics) == 0) return MPS_OK;
  const double t = mps_dynamics_time(dynamics) - mps_dynamics_dt(dynamics);
  if (r->rows > 0 && receivers_time(r, r->rows - 1) == t) return MPS_OK; /* the end of the run */
  mps_status status = mps_particles_view(r->particles, "acceleration", &acceleration);
  double *row = next_row(r);
  if (status == MPS_OK && !row) status = MPS_ERROR_MEMORY;
  for (int64_t k = 0; k < r->count; k++) {
    const receiver *q = &r->list[k];
    const int64_t i = mps_particles_index(r->particles, q->id);
    r->now[k] = status == MPS_OK && i >= 0 ? *mps_view_f64(&acceleration, i, q->component)
                                           : -INFINITY; /* another rank's */
  }
  r->now[r->count] = status; /* of the rank that fares worst */
  if (domain) {
    const mps_status lost = mps_domain_max(domain, (int32_t)r->count + 1, r->now);
    if (lost != MPS_OK) return lost;
  }
  if (r->now[r->count] != 0.0) return (mps_status)r->now[r->count];
  row[0] = t;
  memcpy(row + 1, r->now, (size_t)r->count * sizeof *row);
  r->rows++;
  /* The energy needs a pass over all particles: every tenth row is enough for its drift. */
  const bool drift = r->energy && t > r->energy_from;
  if ((drift || r->watch) && r->rows % 10 == 0) status = record_energy(r, dynamics, drift);
  return status;
}

double receivers_time(const receivers *r, int64_t row) { return r->row[row * (r->count + 1)]; }

double receivers_value(const receivers *r, int64_t row, int64_t k) {
  return r->row[row * (r->count + 1) + 1 + k];
}

double receivers_peak(const receivers *r, int64_t k) {
  double peak = 0.0;
  for (int64_t i = 0; i < r->rows; i++) peak = fmax(peak, fabs(receivers_value(r, i, k)));
  return peak;
}

double receivers_energy_drift(const receivers *r) {
  if (r->energies < 2 || !(r->energy_sum > 0.0)) return NAN;
  return (r->energy_most - r->energy_least) * (double)r->energies / r->energy_sum;
}

/* ---- files ----------------------------------------------------------------------------------- */

/* Columns: time and the receivers first..last - 1. */
static bool write_columns(app *a, const receivers *r, const char *directory, const char *name,
                          int64_t first, int64_t last) {
  output file;
  if (!output_open(&file, a, directory, name)) return false;
  output_text(&file, "t_s");
  for (int64_t k = first; k < last; k++) output_text(&file, ",%s", r->list[k].label);
  output_text(&file, "\n");
  for (int64_t i = 0; i < r->rows; i++) {
    const double t = receivers_time(r, i);
    const double *row = r->row + i * (r->count + 1);
    output_text(&file, "%.9g,", t);
    csv_row(&file, last - first, row + 1 + first);
  }
  return output_close(&file);
}

bool receivers_write(app *a, const receivers *r, const char *directory) {
  const int64_t edge = r->column + 1;
  return write_columns(a, r, directory, "receivers.csv", 0, edge) &&
         (r->count == edge || write_columns(a, r, directory, "slope.csv", edge, r->count));
}
