/* ground.c - the file of layers of mps-site-response (common/layers.h); a last one without end, of
 * thickness inf, is the elastic half space below the others.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "site.h"

#include "common/layers.h"
#include "common/table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LAWS "elastic|smallstrain|mohrcoulomb|cyclicsand"
static const char *const laws[SITE_LAWS] = {"elastic", "smallstrain", "mohrcoulomb", "cyclicsand"};

const char *site_law_name(int64_t law) { return laws[law]; }

/* In the order of site_layer; `line` is added here. */
static const char *fault(const double *row);
static const table_def def = {
    .row = "layer",
    .column = {{"thickness", "m", "m", 0.0, 1e4, true, .endless = true},
               {"density", "kg/m3", "kg/m3", 500.0, 5000.0, false},
               {"vs", "m/s", "m/s", 1.0, 1e4, false},
               {"poisson", "1", "1", 0.0, 0.49, .optional = true},
               {"k0", "1", "1", 0.05, 10.0, .optional = true},
               {"permeability", "m/s", "m/s", 0.0, 1.0, true, true},
               {"porosity", "1", "1", 0.01, 0.95, .optional = true},
               {"reference strain", "1", "1", 1e-7, 1.0, .optional = true},
               {"curvature", "1", "1", 0.5, 1.0, .optional = true},
               {"strength", "Pa", "Pa", 1.0, 1e11, .optional = true},
               {"phi", "degrees", "degrees", 0.0, 60.0, .optional = true},
               {"psi", "degrees", "degrees", 0.0, 60.0, .optional = true},
               {"cohesion", "Pa", "Pa", 0.0, 1e11, .optional = true},
               {"e0", "1", "1", 0.01, 20.0, .optional = true},
               {"emax", "1", "1", 0.01, 20.0, .optional = true},
               {"relative density", "1", "1", 0.1, 1.0, .optional = true},
               {"blow count", "1", "1", 1.0, 60.0, .optional = true},
               {"law", "1", "1", 0.0, SITE_LAWS, .optional = true, .words = LAWS}},
    .count = SITE_COLUMNS,
    .most = SITE_LAYERS + 1,
    .fault = fault,
    .others = LAYERS_OTHERS};

/* By law, from thickness to blow count: + must be given, o may be, - is not for it, though other
 * layers of the file may have it; of the half space, the last row. */
static const char uses[SITE_LAWS + 1][SITE_COLUMNS] = {"+++oooo----------", "+++oooo+oo-------",
                                                       "+++oooo---+oooo--", "+++oooo---+oooooo",
                                                       "+++oooo----------"};

static site_layer layer_of(const double *row) {
  site_layer l;
  memcpy(&l, row, (SITE_COLUMNS - 1) * sizeof *row);
  const double law = row[SITE_COLUMNS - 1];
  l.law = isnan(law) ? SITE_ELASTIC : (int64_t)law;
  return l;
}

/* ---- what the numbers must be together ------------------------------------------------------- */

static void complete(site_layer *l) {
  if (isnan(l->poisson)) l->poisson = 0.3;
  if (isnan(l->k0)) l->k0 = l->poisson > 0.0 ? l->poisson / (1.0 - l->poisson) : 0.05;
  if (l->law == SITE_SMALL_STRAIN && isnan(l->curvature)) l->curvature = 1.0;
  if (l->law < SITE_MOHR_COULOMB) return;
  if (isnan(l->psi)) l->psi = 0.0;
  if (isnan(l->e0)) l->e0 = SAND_E0;
  if (isnan(l->e_max)) l->e_max = fmax(l->e0, SAND_E_MAX);
  if (isnan(l->cohesion)) l->cohesion = 0.0;
}

static char why[400];

static const char *check_friction(const site_layer *l) {
  const double sine = sin(l->phi * 3.14159265358979323846 / 180.0);
  const double active = (1.0 - sine) / (1.0 + sine);
  if (l->e0 > l->e_max)
    snprintf(why, sizeof why, "e0 is %g, must be at most emax, %g", l->e0, l->e_max);
  else if (l->psi > l->phi)
    snprintf(why, sizeof why, "psi is %g, must be at most phi, %g degrees", l->psi, l->phi);
  else if (l->phi == 0.0 && l->cohesion == 0.0)
    return "phi and cohesion must not both be 0";
  else if (l->cohesion == 0.0 && !(l->k0 >= active && l->k0 <= 1.0 / active))
    snprintf(why, sizeof why,
             "k0 is %.4g%s, beyond the strength of phi = %g degrees, must be %.4g to %.4g", l->k0,
             l->poisson / (1.0 - l->poisson) == l->k0 ? " (of poisson)" : "", l->phi, active,
             1.0 / active);
  else
    return NULL;
  return why;
}

static const char *fault(const double *row) {
  site_layer l = layer_of(row);
  const bool endless = isinf(l.thickness);
  const char *use = uses[endless ? SITE_LAWS : l.law];
  if (endless && l.law != SITE_ELASTIC) return "the half space, of thickness inf, is elastic";
  for (int k = 0; k < SITE_COLUMNS - 1; k++) {
    if (use[k] == '+' ? !isnan(row[k]) : use[k] == 'o' || isnan(row[k])) continue;
    snprintf(why, sizeof why, "%s %s %s", endless ? "the half space" : laws[l.law],
             use[k] == '+' ? "lacks" : "has no", def.column[k].name);
    return why;
  }
  complete(&l);
  if (l.law == SITE_SMALL_STRAIN && l.curvature < 1.0 && isnan(l.strength))
    return "a curvature below 1 needs a strength";
  if (l.law == SITE_CYCLIC_SAND && isnan(l.relative_density) == isnan(l.blow_count))
    return "cyclicsand needs one of relative_density and blow_count";
  return l.law < SITE_MOHR_COULOMB ? NULL : check_friction(&l);
}

/* ---- the file -------------------------------------------------------------------------------- */

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
      return site_refuse(m, "%s: layer %lld: permeability is given, but so is --undrained",
                         s->layers, (long long)i + 1);
    if (isnan(l->permeability)) l->permeability = s->permeability;
    if (some && isnan(l->permeability))
      return site_refuse(m,
                         "%s: layer %lld: no permeability, which other layers have: give it or "
                         "--permeability",
                         s->layers, (long long)i + 1);
    if ((some || s->undrained) && !(l->density > 1.05 * l->porosity * SITE_WATER))
      return site_refuse(
          m,
          "%s: layer %lld: density is %g kg/m3, must be that of saturated ground, above "
          "the %g kg/m3 of its water",
          s->layers, (long long)i + 1, l->density, l->porosity * SITE_WATER);
    if ((some || s->undrained) && !(l->density > 1.01 * SITE_WATER))
      return site_refuse(
          m,
          "%s: layer %lld: density is %g kg/m3, must be that of saturated ground, above "
          "%g kg/m3: lighter ground floats",
          s->layers, (long long)i + 1, l->density, 1.01 * SITE_WATER);
  }
  return true;
}

bool site_read_ground(mpm_model *m, const settings *s, site_ground *out) {
  double rows[(SITE_LAYERS + 1) * SITE_COLUMNS];
  char reason[600];
  memset(out, 0, sizeof *out);
  if (!table_read(s->layers, &def, rows, &out->count, reason, sizeof reason))
    return site_refuse(m, "%s", reason);
  for (int64_t i = 0; i < out->count; i++) {
    out->layer[i] = layer_of(rows + i * SITE_COLUMNS);
    complete(&out->layer[i]);
  }
  out->has_half_space = isinf(out->layer[out->count - 1].thickness);
  if (out->count == out->has_half_space)
    return site_refuse(m, "%s: there is no layer above the half space", s->layers);
  if (out->count - out->has_half_space > SITE_LAYERS)
    return site_refuse(m, "%s: more than %d layers", s->layers, SITE_LAYERS);
  if (s->base == SITE_COMPLIANT && !out->has_half_space)
    return site_refuse(m,
                       "%s: no last layer of thickness inf, the half space that --base compliant "
                       "needs",
                       s->layers);
  if (s->base == SITE_RIGID && out->has_half_space)
    return site_refuse(m, "%s: a half space, of thickness inf, which --base rigid does not have",
                       s->layers);
  return complete_water(m, s, out);
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
