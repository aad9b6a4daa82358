/* layers.c - the file of soil layers, and the ground that a row of particles stands for.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "layers.h"

#include "table.h"

#include <math.h>

enum { COLUMNS = 6, WHY = 512 };

/* Ranges of ground: what is beyond them is of another unit or column. */
static const table_def def = {
    .row = "layer",
    .column = {{"thickness", "m", "m", 0.0, 2e3, true, .endless = true},
               {"vs", "m/s", "m/s", 10.0, 6e3, false},
               {"vp", "m/s", "m/s", 15.0, 1.2e4, false},
               {"unit weight", "N/m3", "kN/m3", 5e3, 5e4, .optional = true},
               {"damping", "1", "ratio", 0.0, 0.5, false},
               {"density", "kg/m3", "kg/m3", 500.0, 5e3, .optional = true}},
    .others = LAYERS_OTHERS,
    .count = COLUMNS,
    .most = LAYERS_MAX};

static const char *fault(const double *row) {
  if (isnan(row[3]) == isnan(row[5])) return "one of unit_weight_kN_m3 and density_kg_m3 is wanted";
  /* lambda = rho (Vp^2 - 2 Vs^2) must not be negative. */
  return row[2] * row[2] >= 2.0 * row[1] * row[1] ? NULL : "vp_m_s must be >= sqrt(2) vs_m_s";
}

bool layers_read(app *a, const char *path, layers *out) {
  table_def checked = def;
  double values[COLUMNS * LAYERS_MAX];
  char why[WHY];
  checked.fault = fault;
  if (!table_read(path, &checked, values, &out->count, why, sizeof why)) {
    out->count = 0;
    return app_error(a, "%s", why);
  }
  if (*table_note()) app_warn(a, "%s", table_note());
  for (int64_t i = 0; i < out->count; i++) {
    const double *row = values + COLUMNS * i;
    out->layer[i] =
        (layer){row[0], row[1], row[2], isnan(row[3]) ? row[5] * LAYERS_GRAVITY : row[3], row[4]};
  }
  out->below = (layer){0};
  if (!isinf(out->layer[out->count - 1].thickness)) return true;
  out->below = out->layer[--out->count];
  return out->count > 0 || app_error(a, "%s: there is no layer above the half space", path);
}

double layers_thickness(const layers *ground) {
  double sum = 0.0;
  for (int64_t i = 0; i < ground->count; i++) sum += ground->layer[i].thickness;
  return sum;
}

const layer *layers_at(const layers *ground, double depth) {
  double bottom = 0.0;
  for (int64_t i = 0; i < ground->count; i++) {
    bottom += ground->layer[i].thickness;
    if (depth < bottom) return &ground->layer[i];
  }
  return &ground->layer[ground->count - 1];
}

layer layers_mean(const layers *ground, double top, double bottom) {
  const layer *upper = layers_at(ground, top);
  double sum = 0.0, weight = 0.0, shear = 0.0, pressure = 0.0, damping = 0.0, from = 0.0;
  for (int64_t i = 0; i < ground->count; i++) {
    const layer *l = &ground->layer[i];
    const double to = i + 1 < ground->count ? from + l->thickness : INFINITY;
    const double part = fmin(to, bottom) - fmax(from, top);
    from = to;
    if (!(part > 1e-9 * (bottom - top))) continue;
    if (part >= (1.0 - 1e-9) * (bottom - top)) return *l;
    sum += part, weight += part * l->unit_weight;
    const double soft = part / (l->unit_weight * l->vs * l->vs);
    shear += soft, damping += soft * l->damping;
    pressure += part / (l->unit_weight * l->vp * l->vp);
  }
  if (!(sum > 0.0)) return *upper;
  return (layer){sum, sqrt(sum * sum / (shear * weight)), sqrt(sum * sum / (pressure * weight)),
                 weight / sum, damping / shear};
}

int64_t layers_thin(const layers *ground, double size) {
  for (int64_t i = 0; i < ground->count; i++)
    if (ground->layer[i].thickness < size * (1.0 - 1e-9)) return i;
  return -1;
}

double layers_density(const layer *l) { return l->unit_weight / LAYERS_GRAVITY; }

double layers_travel_time(const layers *ground, char wave, double from, double to) {
  double sum = 0.0, top = 0.0;
  for (int64_t i = 0; i < ground->count; i++) {
    const layer *l = &ground->layer[i];
    const double bottom = i + 1 < ground->count ? top + l->thickness : INFINITY;
    const double upper = fmax(top, to), lower = fmin(bottom, from);
    if (lower > upper) sum += (lower - upper) / (wave == 'S' ? l->vs : l->vp);
    top = bottom;
  }
  return sum;
}
