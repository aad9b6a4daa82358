/* layers.c - the file of soil layers.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "layers.h"

#include "options.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COLUMNS = 5, LINE = 1024 };
static const char SEPARATORS[] = " \t,;\r\n";

/* The name of the first unusual value, with what it must be; NULL: the layer is sound. */
static const char *fault(const layer *l) {
  if (!(l->thickness > 0.0)) return "thickness_m must be > 0";
  if (!(l->vs > 0.0)) return "vs_m_s must be > 0";
  /* lambda = rho (Vp^2 - 2 Vs^2) must not be negative. */
  if (!(l->vp * l->vp >= 2.0 * l->vs * l->vs)) return "vp_m_s must be >= sqrt(2) vs_m_s";
  if (!(l->unit_weight > 0.0)) return "unit_weight_kN_m3 must be > 0";
  if (!(l->damping >= 0.0)) return "damping_ratio must be >= 0";
  return NULL;
}

/* Splits `line` in place. Returns the number of words, at most COLUMNS + 1. */
static int split(char *line, char *words[COLUMNS + 1]) {
  int count = 0;
  line[strcspn(line, "#")] = '\0';
  for (char *rest = line + strspn(line, SEPARATORS); *rest && count <= COLUMNS;) {
    words[count++] = rest;
    rest += strcspn(rest, SEPARATORS);
    if (*rest) *rest++ = '\0';
    rest += strspn(rest, SEPARATORS);
  }
  return count;
}

static bool read_line(app *a, const char *path, int64_t number, char *line, bool *header,
                      layers *out) {
  char *words[COLUMNS + 1];
  double value[COLUMNS];
  const int count = split(line, words);
  if (count == 0) return true;
  if (!*header && out->count == 0 && !options_number(words[0], &value[0])) {
    *header = true; /* a first line that does not begin with a number */
    return true;
  }
  if (count != COLUMNS)
    return app_error(a,
                     "%s:%lld: %s values, a layer has %d: thickness_m, vs_m_s, vp_m_s, "
                     "unit_weight_kN_m3, damping_ratio",
                     path, (long long)number, count > COLUMNS ? "too many" : "too few", COLUMNS);
  for (int i = 0; i < COLUMNS; i++)
    if (!options_number(words[i], &value[i]))
      return app_error(a, "%s:%lld: \"%s\" is not a finite number", path, (long long)number,
                       words[i]);
  if (out->count == LAYERS_MAX)
    return app_error(a, "%s:%lld: more than %d layers", path, (long long)number, LAYERS_MAX);
  const layer l = {value[0], value[1], value[2], 1e3 * value[3], value[4]};
  const char *why = fault(&l);
  if (why) return app_error(a, "%s:%lld: %s", path, (long long)number, why);
  out->layer[out->count++] = l;
  return true;
}

bool layers_read(app *a, const char *path, layers *out) {
  out->count = 0;
  FILE *file = fopen(path, "r");
  if (!file) return app_error(a, "cannot read %s: %s", path, strerror(errno));
  char line[LINE];
  bool ok = true, header = false;
  for (int64_t number = 1; ok && fgets(line, sizeof line, file); number++) {
    if (!strchr(line, '\n') && !feof(file)) /* a device may give zeros without end */
      ok = app_error(a, "%s:%lld: line longer than %d characters, or no text", path,
                     (long long)number, LINE - 2);
    else
      ok = read_line(a, path, number, line, &header, out);
  }
  if (ok && ferror(file)) ok = app_error(a, "cannot read %s: %s", path, strerror(errno));
  fclose(file);
  if (ok && out->count == 0) ok = app_error(a, "%s: no layer in the file", path);
  return ok;
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
