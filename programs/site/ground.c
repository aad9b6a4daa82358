/* ground.c - the file of layers of mps-site-response: a layer a line, from the surface down, of
 * words name=value; the line "halfspace ..." is elastic ground without end below them.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "site.h"

#include "common/units.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

enum { LINE = 1024 };
static const char SEPARATORS[] = " \t,;\r\n";
static const char *const laws[SITE_LAWS] = {"elastic", "smallstrain", "mohrcoulomb", "cyclicsand"};

const char *site_law_name(int64_t law) { return laws[law]; }

/* `laws`: a letter for each law, capital where the value must be given, and one for the half space
 * (H, h); '-': not for it. */
static const struct {
  const char *name, *unit;
  option_range range;
  size_t offset;
  const char *laws;
} keys[] = {
    {"thickness", "m", OPTION_ABOVE_TO(0.0, 1e4), offsetof(site_layer, thickness), "ESMQ-"},
    {"density", "kg/m3", OPTION_FROM_TO(500.0, 5000.0), offsetof(site_layer, density), "ESMQH"},
    {"vs", "m/s", OPTION_FROM_TO(1.0, 1e4), offsetof(site_layer, vs), "ESMQH"},
    {"poisson", "1", OPTION_FROM_TO(0.0, 0.49), offsetof(site_layer, poisson), "esmqh"},
    {"k0", "1", OPTION_FROM_TO(0.05, 10.0), offsetof(site_layer, k0), "esmqh"},
    {"permeability", "m/s", OPTION_ABOVE_TO(0.0, 1.0), offsetof(site_layer, permeability), "esmqh"},
    {"porosity", "1", OPTION_FROM_TO(0.01, 0.95), offsetof(site_layer, porosity), "esmqh"},
    {"reference-strain", "1", OPTION_FROM_TO(1e-7, 1.0), offsetof(site_layer, reference_strain),
     "-S---"},
    {"curvature", "1", OPTION_FROM_TO(0.5, 1.0), offsetof(site_layer, curvature), "-s---"},
    {"strength", "Pa", OPTION_FROM_TO(1.0, 1e11), offsetof(site_layer, strength), "-s---"},
    {"phi", "degrees", OPTION_FROM_TO(0.0, 60.0), offsetof(site_layer, phi), "--MQ-"},
    {"psi", "degrees", OPTION_FROM_TO(0.0, 60.0), offsetof(site_layer, psi), "--mq-"},
    {"cohesion", "Pa", OPTION_FROM_TO(0.0, 1e11), offsetof(site_layer, cohesion), "--mq-"},
    {"e0", "1", SAND_RANGE, offsetof(site_layer, e0), "--mq-"},
    {"emax", "1", SAND_RANGE, offsetof(site_layer, e_max), "--mq-"},
    {"relative-density", "1", OPTION_FROM_TO(0.1, 1.0), offsetof(site_layer, relative_density),
     "---q-"},
    {"blow-count", "1", OPTION_FROM_TO(1.0, 60.0), offsetof(site_layer, blow_count), "---q-"},
};
enum { KEYS = sizeof keys / sizeof *keys };

/* A line being read. */
typedef struct reading {
  mpm_model *m;
  const char *path;
  int64_t number;
  bool half_space;
  site_layer *layer;
} reading;

#define REFUSE(r, ...) refuse_line((r), __VA_ARGS__)

static bool refuse_line(const reading *r, const char *format, ...) APP_PRINTF(2, 3);
static bool refuse_line(const reading *r, const char *format, ...) {
  char text[400];
  va_list args;
  va_start(args, format);
  (void)vsnprintf(text, sizeof text, format, args);
  va_end(args);
  return site_refuse(r->m, "%s:%lld: %s", r->path, (long long)r->number, text);
}

static double *value_of(site_layer *layer, int k) {
  return (double *)(void *)((char *)layer + keys[k].offset);
}

static int law_column(const reading *r) { return r->half_space ? SITE_LAWS : (int)r->layer->law; }

/* Names of the numbers of a law. */
static void list_keys(int column, char *out, size_t size) {
  size_t used = 0;
  for (int k = 0; k < KEYS && used < size; k++)
    if (keys[k].laws[column] != '-')
      used += (size_t)snprintf(out + used, size - used, "%s%s", used ? ", " : "", keys[k].name);
}

static bool read_law(reading *r, const char *text) {
  for (int k = 0; k < SITE_LAWS; k++)
    if (strcmp(laws[k], text) == 0) {
      r->layer->law = k;
      return true;
    }
  return REFUSE(r, "law=%s is not one of elastic, smallstrain, mohrcoulomb, cyclicsand", text);
}

static bool read_number(reading *r, int k, const char *text) {
  double *value = value_of(r->layer, k);
  char wanted[160];
  if (!isnan(*value)) return REFUSE(r, "%s is given twice", keys[k].name);
  const units_status status = units_read(text, keys[k].unit, value);
  if (status == UNITS_NO_NUMBER)
    return REFUSE(r, "%s=%s is not a finite number", keys[k].name, text);
  if (status == UNITS_OTHER) {
    units_wanted(keys[k].unit, wanted, sizeof wanted);
    return REFUSE(r, "%s=%s has another unit: %s", keys[k].name, text, wanted);
  }
  const option_range *range = &keys[k].range;
  if (*value <= range->upper && (range->open ? *value > range->lower : *value >= range->lower))
    return true;
  return REFUSE(r, "%s=%s, must be %s%g to %g%s%s", keys[k].name, text, range->open ? "above " : "",
                range->lower, range->upper, strcmp(keys[k].unit, "1") == 0 ? "" : " ",
                strcmp(keys[k].unit, "1") == 0 ? "" : keys[k].unit);
}

static bool read_word(reading *r, char *word) {
  char *value = strchr(word, '=');
  char list[300];
  if (!value) return REFUSE(r, "\"%s\" is no name=value such as thickness=5m or law=elastic", word);
  *value++ = '\0';
  if (strcmp(word, "law") == 0) return true; /* read before */
  for (int k = 0; k < KEYS; k++)
    if (strcmp(keys[k].name, word) == 0 && keys[k].laws[law_column(r)] != '-')
      return read_number(r, k, value);
  list_keys(law_column(r), list, sizeof list);
  return REFUSE(r, "%s has no \"%s\", only %s",
                r->half_space ? "the half space" : laws[r->layer->law], word, list);
}

/* The word law=..., which says what the others may be; elastic where there is none. */
static bool find_law(reading *r, char *const *word, int count) {
  bool given = false;
  r->layer->law = SITE_ELASTIC;
  for (int k = 0; k < count; k++) {
    if (strncmp(word[k], "law=", 4) != 0) continue;
    if (r->half_space) return REFUSE(r, "the half space is elastic, and has no law");
    if (given) return REFUSE(r, "law is given twice");
    if (!read_law(r, word[k] + 4)) return false;
    given = true;
  }
  return true;
}

/* ---- what the numbers must be together ------------------------------------------------------- */

static bool check_friction(const reading *r) {
  site_layer *l = r->layer;
  if (isnan(l->psi)) l->psi = 0.0;
  if (isnan(l->e0)) l->e0 = SAND_E0;
  if (isnan(l->e_max)) l->e_max = fmax(l->e0, SAND_E_MAX);
  if (l->e0 > l->e_max) return REFUSE(r, "e0=%g is above emax=%g", l->e0, l->e_max);
  if (isnan(l->cohesion)) l->cohesion = 0.0;
  if (l->psi > l->phi) return REFUSE(r, "psi=%g is above phi=%g degrees", l->psi, l->phi);
  if (l->phi == 0.0 && l->cohesion == 0.0) return REFUSE(r, "phi and cohesion must not both be 0");
  const double sine = sin(l->phi * 3.14159265358979323846 / 180.0);
  const double active = (1.0 - sine) / (1.0 + sine);
  if (l->cohesion == 0.0 && !(l->k0 >= active && l->k0 <= 1.0 / active))
    return REFUSE(r,
                  "k0=%.4g%s is beyond the strength of phi=%g degrees, must be %.4g to %.4g: "
                  "give k0",
                  l->k0, l->poisson / (1.0 - l->poisson) == l->k0 ? " (of poisson)" : "", l->phi,
                  active, 1.0 / active);
  return true;
}

static bool check_layer(const reading *r) {
  site_layer *l = r->layer;
  char missing[300] = "";
  for (int k = 0; k < KEYS; k++) {
    const char letter = keys[k].laws[law_column(r)];
    if (letter >= 'A' && letter <= 'Z' && isnan(*value_of(l, k)))
      snprintf(missing + strlen(missing), sizeof missing - strlen(missing), "%s%s",
               missing[0] ? ", " : "", keys[k].name);
  }
  if (missing[0])
    return REFUSE(r, "%s lacks %s", r->half_space ? "the half space" : laws[l->law], missing);
  if (isnan(l->poisson)) l->poisson = 0.3;
  if (isnan(l->k0)) l->k0 = l->poisson > 0.0 ? l->poisson / (1.0 - l->poisson) : 0.05;
  if (l->law == SITE_SMALL_STRAIN && isnan(l->curvature)) l->curvature = 1.0;
  if (l->law == SITE_SMALL_STRAIN && l->curvature < 1.0 && isnan(l->strength))
    return REFUSE(r, "curvature=%g needs a strength", l->curvature);
  if (l->law == SITE_CYCLIC_SAND && isnan(l->relative_density) == isnan(l->blow_count))
    return REFUSE(r, "cyclicsand needs one of relative-density and blow-count");
  return l->law < SITE_MOHR_COULOMB || check_friction(r);
}

/* ---- the file -------------------------------------------------------------------------------- */

enum { WORDS = 24 };

/* Splits `line` in place; more than WORDS: returns WORDS + 1. */
static int split(char *line, char **word) {
  int count = 0;
  line[strcspn(line, "#")] = '\0';
  for (char *rest = line + strspn(line, SEPARATORS); *rest && count <= WORDS;) {
    word[count++] = rest;
    rest += strcspn(rest, SEPARATORS);
    if (*rest) *rest++ = '\0';
    rest += strspn(rest, SEPARATORS);
  }
  return count;
}

static bool read_line(mpm_model *m, const char *path, int64_t number, char *line,
                      site_ground *out) {
  char *word[WORDS + 1];
  const bool mark = number == 1 && strncmp(line, "\xef\xbb\xbf", 3) == 0; /* of UTF-8 */
  const int count = split(line + (mark ? 3 : 0), word);
  reading r = {m, path, number, false, NULL};
  if (count == 0) return true;
  if (count > WORDS) return REFUSE(&r, "more than %d words", WORDS);
  if (out->has_half_space) return REFUSE(&r, "a layer below the half space, which is the last");
  r.half_space = strcmp(word[0], "halfspace") == 0;
  if (r.half_space && out->count == 0) return REFUSE(&r, "there is no layer above the half space");
  if (out->count == SITE_LAYERS && !r.half_space)
    return REFUSE(&r, "more than %d layers", SITE_LAYERS);
  r.layer = &out->layer[out->count++];
  memset(r.layer, 0, sizeof *r.layer);
  for (int k = 0; k < KEYS; k++) *value_of(r.layer, k) = NAN;
  r.layer->line = number;
  out->has_half_space = r.half_space;
  if (!find_law(&r, word, count)) return false;
  for (int k = r.half_space ? 1 : 0; k < count; k++)
    if (!read_word(&r, word[k])) return false;
  return check_layer(&r);
}

/* Permeabilities and porosities of --permeability and --porosity where the file has none. */
static bool complete_water(mpm_model *m, const settings *s, site_ground *g) {
  bool some = !isnan(s->permeability);
  for (int64_t i = 0; i < g->count; i++) some = some || !isnan(g->layer[i].permeability);
  if (!some && !s->undrained &&
      (options_given(options_read(), "porosity") || options_given(options_read(), "water-bulk")))
    return site_refuse(m, "--porosity and --water-bulk are for ground with water: give "
                          "--permeability or --undrained");
  for (int64_t i = 0; i < g->count; i++) {
    site_layer *l = &g->layer[i];
    if (isnan(l->porosity)) l->porosity = s->porosity;
    if (s->undrained && !isnan(l->permeability))
      return site_refuse(m, "%s:%lld: permeability is given, but so is --undrained", s->layers,
                         (long long)l->line);
    if (isnan(l->permeability)) l->permeability = s->permeability;
    if (some && isnan(l->permeability))
      return site_refuse(m,
                         "%s:%lld: no permeability, which other layers have: give it or "
                         "--permeability",
                         s->layers, (long long)l->line);
    if ((some || s->undrained) && !(l->density > 1.05 * l->porosity * SITE_WATER))
      return site_refuse(m,
                         "%s:%lld: density is %g kg/m3, must be that of saturated ground, above "
                         "the %g kg/m3 of its water",
                         s->layers, (long long)l->line, l->density, l->porosity * SITE_WATER);
    if ((some || s->undrained) && !(l->density > 1.01 * SITE_WATER))
      return site_refuse(m,
                         "%s:%lld: density is %g kg/m3, must be that of saturated ground, above "
                         "%g kg/m3: lighter ground floats",
                         s->layers, (long long)l->line, l->density, 1.01 * SITE_WATER);
  }
  return true;
}

bool site_read_ground(mpm_model *m, const settings *s, site_ground *out) {
  memset(out, 0, sizeof *out);
  FILE *file = fopen(s->layers, "r");
  if (!file) return site_refuse(m, "cannot read %s: %s", s->layers, strerror(errno));
  char line[LINE];
  bool ok = true;
  for (int64_t number = 1; ok && fgets(line, sizeof line, file); number++) {
    if (!strchr(line, '\n') && !feof(file)) /* a device may give zeros without end */
      ok = site_refuse(m, "%s:%lld: line longer than %d characters, or no text", s->layers,
                       (long long)number, LINE - 2);
    else
      ok = read_line(m, s->layers, number, line, out);
  }
  if (ok && ferror(file)) ok = site_refuse(m, "cannot read %s: %s", s->layers, strerror(errno));
  fclose(file);
  if (ok && out->count == 0) ok = site_refuse(m, "%s: no layer in the file", s->layers);
  if (ok && s->base == SITE_COMPLIANT && !out->has_half_space)
    ok = site_refuse(
        m, "%s: no line \"halfspace density=... vs=...\", which --base compliant needs", s->layers);
  if (ok && s->base == SITE_RIGID && out->has_half_space)
    ok = site_refuse(m, "%s:%lld: a half space, which --base rigid does not have", s->layers,
                     (long long)out->layer[out->count - 1].line);
  return ok && complete_water(m, s, out);
}

double site_thickness(const site_ground *g) {
  double sum = 0.0;
  for (int64_t i = 0; i < g->count - g->has_half_space; i++) sum += g->layer[i].thickness;
  return sum;
}

const site_layer *site_layer_at(const site_ground *g, double depth) {
  double bottom = 0.0;
  for (int64_t i = 0; i < g->count - g->has_half_space; i++) {
    bottom += g->layer[i].thickness;
    if (depth < bottom) return &g->layer[i];
  }
  return &g->layer[g->count - 1];
}

double site_travel_time(const site_ground *g) {
  double sum = 0.0;
  for (int64_t i = 0; i < g->count - g->has_half_space; i++)
    sum += g->layer[i].thickness / g->layer[i].vs;
  return sum;
}
