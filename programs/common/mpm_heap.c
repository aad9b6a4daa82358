/* mpm_heap.c - see mpm_heap.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_heap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Sorts, and returns the last value of the last run of at least 1 % of them, and 3; runs end at
 * gaps wider than `gap`. */
static double end_of_heap(int64_t count, double *x, double gap) {
  if (count == 0) return NAN;
  qsort(x, (size_t)count, sizeof *x, ascending);
  const int64_t least = count / 100 > 3 ? count / 100 : 3;
  int64_t last = count - 1, run = 1;
  for (int64_t k = count - 1; k > 0 && run < least; k--) {
    if (x[k] - x[k - 1] > gap) last = k - 1, run = 0;
    run++;
  }
  return x[last];
}

/* A particle's place and volume. */
typedef struct piece {
  double x, volume;
} piece;

static int inwards(const void *a, const void *b) {
  const double x = ((const piece *)a)->x, y = ((const piece *)b)->x;
  return (x < y) - (x > y);
}

/* The middle of the outermost window whose volume over its area is `thickness`, at most half a
 * spacing beyond its last particle: a front that does not depend on how finely a foot that thins
 * out is divided into particles. */
static double find_edge(int64_t count, piece *pieces, double spacing, const mpm_heap_def *def) {
  double volume = 0.0;
  if (!(def->thickness > 0.0 && def->window > 0.0)) return 0.0;
  qsort(pieces, (size_t)count, sizeof *pieces, inwards);
  for (int64_t k = 0, first = 0; k < count; k++) {
    volume += pieces[k].volume;
    while (pieces[first].x - pieces[k].x > def->window) volume -= pieces[first++].volume;
    const double middle = pieces[k].x + 0.5 * def->window;
    const double around = def->axisymmetric ? 2.0 * 3.14159265358979323846 * middle : 1.0;
    if (volume >= def->thickness * around * def->window)
      return fmin(middle, pieces[first].x + 0.5 * spacing);
  }
  return 0.0;
}

/* ---- the heap -------------------------------------------------------------------------------- */

static mps_status measure(mps_particles *particles, const mpm_heap_def *def, mpm_heap *out) {
  mps_view x, v, m, volume;
  mps_status status = mps_particles_view(particles, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(particles, "velocity", &v);
  if (status == MPS_OK) status = mps_particles_view(particles, "mass", &m);
  if (status == MPS_OK) status = mps_particles_view(particles, "volume", &volume);
  if (status != MPS_OK) return status;
  const int64_t count = x.shape[0];
  const double spacing = mps_particles_spacing(particles);
  double *place = malloc((size_t)count * sizeof *place);
  piece *pieces = malloc((size_t)count * sizeof *pieces);
  int64_t *rows = mpm_rows_by_id(particles);
  if (!place || !pieces || !rows) {
    free(place);
    free(pieces);
    free(rows);
    return MPS_ERROR_MEMORY;
  }
  *out = (mpm_heap){0};
  const double section =
      def->axisymmetric ? 3.14159265358979323846 * def->band * def->band : def->band;
  int64_t beside = 0;
  for (int64_t i = 0; i < count; i++) {
    const int64_t k = rows[i];
    const double mass = *mps_view_f64(&m, k, 0), vx = *mps_view_f64(&v, k, 0);
    const double vy = *mps_view_f64(&v, k, 1), V = *mps_view_f64(&volume, k, 0);
    out->mass += mass;
    out->potential += mass * def->g * *mps_view_f64(&x, k, 1);
    out->kinetic += 0.5 * mass * (vx * vx + vy * vy);
    out->volume += V;
    pieces[i] = (piece){*mps_view_f64(&x, k, 0), V};
    const double start = def->axisymmetric ? mass / def->density : spacing * spacing;
    out->volume_ratio = fmax(out->volume_ratio, V / start);
    if (*mps_view_f64(&x, k, 0) >= def->band) continue;
    out->height += V / section;
    place[beside++] = *mps_view_f64(&x, k, 1);
  }
  out->top = end_of_heap(beside, place, 2.0 * spacing) + 0.5 * spacing;
  for (int64_t k = 0; k < count; k++) place[k] = *mps_view_f64(&x, k, 0);
  const double last = end_of_heap(count, place, 2.0 * spacing);
  out->front = last + 0.5 * spacing;
  out->reach = def->axisymmetric ? NAN : place[(int64_t)(0.98 * (double)(count - 1))];
  for (int64_t i = 0; i < count; i++)
    if (*mps_view_f64(&x, rows[i], 0) > last)
      out->detached += *mps_view_f64(&m, rows[i], 0) / out->mass;
  out->edge = find_edge(count, pieces, spacing, def);
  free(place);
  free(pieces);
  free(rows);
  return MPS_OK;
}

mps_status mpm_heap_measure(mpm_model *m, const mpm_heap_def *def, mpm_heap *out) {
  mps_particles *whole;
  mps_status status = mpm_model_whole(m, &whole);
  if (status == MPS_OK && whole) status = measure(whole, def, out);
  return mpm_model_tell(m, status, sizeof *out / sizeof(double), &out->front);
}

/* ---- pictures -------------------------------------------------------------------------------- */

static mps_status take(mps_particles *particles, double time, const char *field,
                       mpm_snapshot *shot) {
  mps_view x, value;
  mps_status status = mps_particles_view(particles, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(particles, field, &value);
  if (status != MPS_OK) return status;
  mpm_snapshot_free(shot);
  int64_t *rows = mpm_rows_by_id(particles);
  shot->row = malloc((size_t)x.shape[0] * 3 * sizeof *shot->row);
  if (!shot->row || !rows) {
    free(rows);
    return MPS_ERROR_MEMORY;
  }
  shot->time = time;
  shot->count = x.shape[0];
  const bool pressure = strcmp(field, "stress") == 0;
  for (int64_t i = 0; i < shot->count; i++) {
    const int64_t k = rows[i];
    double *row = shot->row + 3 * i;
    row[0] = *mps_view_f64(&x, k, 0);
    row[1] = *mps_view_f64(&x, k, 1);
    row[2] = *mps_view_f64(&value, k, 0);
    if (pressure)
      row[2] = -(row[2] + *mps_view_f64(&value, k, 1) + *mps_view_f64(&value, k, 2)) / 3.0;
  }
  free(rows);
  return MPS_OK;
}

mps_status mpm_snapshot_take(mpm_model *m, double time, const char *field, mpm_snapshot *shot) {
  mps_particles *whole;
  mps_status status = mpm_model_whole(m, &whole);
  if (status == MPS_OK && whole) status = take(whole, time, field, shot);
  return mpm_model_tell(m, status, 0, NULL);
}

mps_status mpm_snapshot_last(const mpm_model *m, double time, const char *field,
                             mpm_snapshot *shot) {
  return take(m->whole ? m->whole : m->particles, time, field, shot);
}

void mpm_snapshot_free(mpm_snapshot *shot) {
  free(shot->row);
  *shot = (mpm_snapshot){0};
}

double mpm_snapshot_most(const mpm_snapshot *shot, int column) {
  double most = 0.0;
  for (int64_t k = 0; k < shot->count; k++) most = fmax(most, shot->row[3 * k + column]);
  return most;
}

bool mpm_snapshots_write(app *a, const char *directory, const char *name, const char *value,
                         int count, const mpm_snapshot *shots) {
  output f;
  if (!output_open(&f, a, directory, name)) return false;
  char columns[80];
  snprintf(columns, sizeof columns, "frame,t_s,x_m,y_m,%s", value);
  csv_header(&f, columns);
  for (int s = 0; s < count; s++)
    for (int64_t k = 0; k < shots[s].count; k++) {
      const double *r = shots[s].row + 3 * k, row[] = {s, shots[s].time, r[0], r[1], r[2]};
      csv_row(&f, 5, row);
    }
  return output_close(&f);
}

bool mpm_snapshots_image(app *a, const char *directory, const char *name, int count,
                         const mpm_snapshot *shots, const area_def *def, area *images) {
  output f;
  if (!output_open(&f, a, directory, name)) return false;
  for (int s = 0; s < count; s++) area_write(&f, def, shots[s].count, shots[s].row, &images[s]);
  return output_close(&f);
}
