/* layers.c - the file of soil layers.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "layers.h"

#include "table.h"

#include <math.h>

enum { COLUMNS = 5, WHY = 512 };

/* The name of the first unusual value, with what it must be; NULL: the layer is sound. */
static const char *fault(const double *row) {
  const double vs = row[1], vp = row[2];
  if (!(row[0] > 0.0)) return "thickness_m must be > 0";
  if (!(vs > 0.0)) return "vs_m_s must be > 0";
  /* lambda = rho (Vp^2 - 2 Vs^2) must not be negative. */
  if (!(vp * vp >= 2.0 * vs * vs)) return "vp_m_s must be >= sqrt(2) vs_m_s";
  if (!(row[3] > 0.0)) return "unit_weight_kN_m3 must be > 0";
  if (!(row[4] >= 0.0)) return "damping_ratio must be >= 0";
  return NULL;
}

bool layers_read(app *a, const char *path, layers *out) {
  static const table_def def = {"layer",
                                "thickness_m, vs_m_s, vp_m_s, unit_weight_kN_m3, damping_ratio",
                                COLUMNS, LAYERS_MAX, fault};
  double values[COLUMNS * LAYERS_MAX];
  char why[WHY];
  if (!table_read(path, &def, values, &out->count, why, sizeof why)) {
    out->count = 0;
    return app_error(a, "%s", why);
  }
  for (int64_t i = 0; i < out->count; i++) {
    const double *row = values + COLUMNS * i;
    out->layer[i] = (layer){row[0], row[1], row[2], 1e3 * row[3], row[4]};
  }
  return true;
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
