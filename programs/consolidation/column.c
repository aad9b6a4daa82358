/* column.c - layers and load of a column, and its exact solution.
 *
 * Of each of the three kinds of ground one quantity x of the effective stress s' consolidates
 * linearly, by depths before the load, and has at a drained side the value of the load q there:
 *
 * terzaghi  x = s'. Olson (1977) for a load that grows, Schiffman and Stein (1970) for layers
 * large     x = 1 - exp(-s'/M') = 1 - V/V0, with k = k0 (V/V0)^2: Xie and Leo (2004)
 * mcc       x = ln(s'/s0 + 1), normally consolidated Cam-Clay between rigid walls: e = e0 - lambda
 *           ln(s/s0), k = k0 (v/v0) s0/s, c_v = k0 s0 v0/(lambda rho_w g), as in Davis and Raymond
 *           (1965)
 *
 * So loads add up in x, and a load that grows is a sum of short pieces within each of which x grows
 * evenly (of terzaghi one piece is exact). u = q - s'; the settlement is the mean of x over H times
 * 1/M', 1 and lambda/(1 + e0). SPDX-License-Identifier: BSD-3-Clause */
#include "common/layers.h"
#include "common/table.h"
#include "common/units.h"
#include "consolidation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PIECES = 32, FACES = 200 }; /* of a load that grows, in the solution and in the model */

/* ---- the load -------------------------------------------------------------------------------- */

double column_load(const simulation *sim, int step, double T) {
  const double part = sim->s.ramp > 0.0 ? fmin(1.0, T / sim->s.ramp) : 1.0;
  return sim->load[step] + part * (sim->load[step + 1] - sim->load[step]);
}

double column_next(const simulation *sim, double T) {
  const double piece = sim->s.ramp / FACES;
  return T < sim->s.ramp - 0.5 * piece ? piece * (floor(T / piece + 1e-6) + 1.0) : INFINITY;
}

/* ---- exact solution -------------------------------------------------------------------------- */

/* x of a load, and the effective stress of x. */
static double stretched(const simulation *sim, double load) {
  const settings *s = &sim->s;
  if (s->kase == LARGE) return -expm1(-load / sim->modulus);
  return s->kase == MCC ? log1p(load / s->initial) : load;
}

static double stress_of(const simulation *sim, double x) {
  const settings *s = &sim->s;
  if (s->kase == LARGE) return -sim->modulus * log1p(-x);
  return s->kase == MCC ? s->initial * expm1(x) : x;
}

/* Sum over all loads until T of step `step`, of what has consolidated; depth < 0: the mean. */
static double consolidated(const simulation *sim, int step, double T, double depth) {
  const double each = sim->time[sim->times - 1], ramp = sim->s.ramp;
  const int pieces = ramp > 0.0 && sim->s.kase != TERZAGHI ? PIECES : 1;
  const double length = ramp / pieces;
  double sum = 0.0;
  for (int j = 0; j <= step; j++)
    for (int p = 0; p < pieces; p++) {
      const double growth = (sim->load[j + 1] - sim->load[j]) / pieces;
      const double before = sim->load[j] + p * growth;
      const double since = T + (step - j) * each - p * length;
      const double x = stretched(sim, before + growth) - stretched(sim, before);
      if (since <= 0.0) continue;
      const double applied = length > 0.0 ? fmin(1.0, since / length) : 1.0;
      sum += x * (depth < 0.0 ? strata_degree(&sim->ground, since, length)
                              : applied - strata_pressure(&sim->ground, depth, since, length));
    }
  return sum;
}

double column_pressure(const simulation *sim, int step, double T, double depth) {
  return column_load(sim, step, T) - stress_of(sim, consolidated(sim, step, T, depth));
}

static double settles(const simulation *sim, double x) {
  const settings *s = &sim->s;
  return s->kase == MCC ? s->lambda / (1.0 + s->e0) * x : s->kase == LARGE ? x : x / sim->modulus;
}

double column_settlement(const simulation *sim, int step, double T) {
  return settles(sim, consolidated(sim, step, T, -1.0));
}

double column_degree(const simulation *sim, int step, double settlement) {
  return settlement / settles(sim, stretched(sim, sim->load[step + 1]));
}

/* ---- options --------------------------------------------------------------------------------- */

static const char *read_layers(simulation *sim) {
  static const table_def def = {.row = "layer",
                                .column = {{"thickness", "m", "m", 0.0, 1e4, true},
                                           {"permeability", "m/s", "m/s", 0.0, 1.0, true},
                                           {"modulus", "Pa", "Pa", 1e3, 1e13, false}},
                                .count = 3,
                                .others = LAYERS_OTHERS,
                                .most = STRATA_MOST};
  static char why[600];
  double rows[3 * STRATA_MOST];
  int64_t count = 0;
  strata *g = &sim->ground;
  if (!table_read(sim->s.layers, &def, rows, &count, why, sizeof why)) return why;
  g->count = (int)count;
  for (int i = 0; i < g->count; i++)
    g->layer[i] = (stratum){rows[3 * i], rows[3 * i + 1], rows[3 * i + 2]};
  strata_scale(g, &sim->k, &sim->modulus, &sim->height);
  return NULL;
}

/* All layers are whole cells, and the radius of a drain. */
static bool fits(const strata *g, const settings *s, double cells) {
  const double drain = s->kase == BARRON ? cells / s->ratio : 1.0;
  if (!(drain > 0.5) || fabs(drain - nearbyint(drain)) > 1e-9) return false;
  double depth = 0.0;
  for (int i = 0; i + 1 < g->count; i++) {
    depth += g->layer[i].thickness * cells;
    if (fabs(depth - nearbyint(depth)) > 1e-6) return false;
  }
  return true;
}

const char *column_choose_cells(simulation *sim) {
  settings *s = &sim->s;
  const bool given = !isnan(s->cell);
  const double usual = s->kase == STRIP ? 4.0 : s->kase == MANDEL ? 10.0 : 20.0;
  const double wanted = nearbyint(given ? fmin(1.0 / s->cell, MOST_CELLS) : usual);
  for (double k = 0.0; k <= MOST_CELLS; k++) {
    const double less = given ? wanted - k : 0.0, more = wanted + k;
    const bool fine = more <= MOST_CELLS && fits(&sim->ground, s, more);
    if (!fine && !(less >= 2.0 && fits(&sim->ground, s, less))) continue;
    s->cells = fine ? more : less;
    if (given && fabs(s->cell * s->cells - 1.0) > 1e-5)
      options_note("--cell is %.6g m, taken as %.6g m: %g in the model's 1 m", s->cell,
                   1.0 / s->cells, s->cells);
    return NULL;
  }
  return s->layers ? "--layers must be such that whole cells, at most 256 in all, fill each"
                   : "--drain-ratio must be such that whole cells fill the drain's radius";
}

/* Ascending loads with commas between them. */
static const char *read_loads(simulation *sim) {
  const char *text = sim->s.loads;
  char number[64];
  for (sim->steps = 0; *text || sim->steps == 0; sim->steps++) {
    const size_t length = strcspn(text, ",");
    if (sim->steps == MOST_STEPS) return "--loads must be at most 12 pressures";
    if (length >= sizeof number) return "--loads must be pressures with commas between them";
    memcpy(number, text, length);
    number[length] = '\0';
    double *load = &sim->load[sim->steps + 1];
    if (units_read(number, "Pa", load) != UNITS_GOOD || !(*load > 0.0 && *load <= 1e12))
      return "--loads must be pressures above 0, at most 1e12 Pa, with commas between them";
    if (!(*load > load[-1])) return "--loads must ascend";
    text += length + (text[length] == ',');
    if (text[-1] == ',' && !*text) return "--loads must not end with a comma";
  }
  sim->s.load = sim->load[sim->steps];
  return NULL;
}

const char *column_settle(simulation *sim, const option *table) {
  static const char *const own[] = {"drainage", "layers", "load-ramp", "loads"};
  settings *s = &sim->s;
  sim->steps = 1;
  sim->ground.count = 1;
  sim->ground.layer[0] = (stratum){1.0, 1.0, 1.0};
  sim->ground.drained[0] = s->drained != DRAINED_BOTTOM;
  sim->ground.drained[1] = s->drained != DRAINED_TOP;
  for (size_t k = 0; k < sizeof own / sizeof *own && !is_column(s); k++)
    if (options_given(table, own[k]))
      return "--drainage, --layers, --load-ramp and --loads are for --case terzaghi, large and mcc";
  if (s->layers && s->kase != TERZAGHI) return "--layers is for --case terzaghi alone";
  if (s->layers && options_given(table, "young"))
    return "--young is not for --layers, which have their own moduli";
  if (s->loads && options_given(table, "load")) return "--load and --loads exclude each other";
  const char *why = s->layers ? read_layers(sim) : NULL;
  if (!why && s->loads) why = read_loads(sim);
  if (s->layers && !options_given(table, "scheme")) s->scheme = IMPLICIT;
  return why;
}

const char *column_finish_settings(simulation *sim) {
  const settings *s = &sim->s;
  if (!is_column(s)) return NULL;
  if (!s->loads) sim->load[1] = s->load;
  if (s->ramp > sim->time[sim->times - 1]) return "--load-ramp must be at most the last of --times";
  if (sim->times * sim->steps > MOST_TIMES)
    return "--times and --loads: together at most 64 profiles, times by loads";
  strata_solve(&sim->ground);
  return NULL;
}

const stratum *column_layer(const simulation *sim, double depth) {
  const strata *g = &sim->ground;
  for (int i = 0; i + 1 < g->count; i++) {
    if (depth < g->layer[i].thickness) return &g->layer[i];
    depth -= g->layer[i].thickness;
  }
  return &g->layer[g->count - 1];
}
