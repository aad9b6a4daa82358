/* results.c - tables and the picture of mps-consolidation.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/compare.h"
#include "common/plot.h"
#include "consolidation.h"

#include <math.h>
#include <stdio.h>

static const char *const names[] = {"terzaghi", "large", "mcc",   "mandel",
                                    "cryer",    "strip", "barron"};

static double exact_at(const simulation *sim, int r, int point) {
  const instant *now = &sim->row[r];
  if (is_column(&sim->s))
    return column_pressure(sim, now->step, now->T, sim->at[point]) / reference_load(sim, now->step);
  return exact_pressure(&sim->s, sim->at[point], now->T);
}

/* Time (s) of the layers as they are, not of the model, which is 1 m high; NaN without --layers. */
static double real_time(const simulation *sim, const instant *now) {
  const double c_v = sim->k * sim->modulus / (1000.0 * MPS_PORE_GRAVITY);
  const double T = now->step * sim->time[sim->times - 1] + now->T;
  return sim->s.layers ? T * sim->height * sim->height / c_v : NAN;
}

/* e after a settlement, of Cam-Clay. */
static double void_ratio(const simulation *sim, double settlement) {
  return sim->s.e0 - (1.0 + sim->s.e0) * settlement;
}

/* Error of u/u0 in row r: the largest over all points; for Mandel and Cryer that at the point
 * nearest to the centre, for the strip the root mean square down to a depth of 4 B. */
static double pressure_error(const simulation *sim, int r) {
  double most = 0.0, square = 0.0;
  const bool centre = sim->s.kase == MANDEL || sim->s.kase == CRYER;
  for (int k = centre ? sim->points - 1 : 0; k < sim->points; k++) {
    const double off = sim->row[r].u[k] - exact_at(sim, r, k);
    most = fmax(most, fabs(off));
    square += off * off / sim->points;
  }
  return sim->s.kase == STRIP ? sqrt(square) : most;
}

#define STIFFEST 20.0 /* (K_w/n)/M': water that takes at least .95 of a load */
#define FAST 0.2      /* of the usual duration, below which waves show */

/* Exact solutions are of water that hardly gives way, and of ground whose inertia does not count.
 */
static comparison compare_exact(const simulation *sim) {
  const settings *s = &sim->s;
  const double usual = consolidation_duration(sim);
  comparison c = compare_with("the exact solution", 0.0, 0.0);
  compare_require(&c, s->stiffness >= STIFFEST,
                  "it is of water that hardly gives way, and --water-stiffness is %g",
                  s->stiffness);
  compare_require(&c, s->kase == STRIP || s->duration >= FAST * usual,
                  "--time-unit is %.3g s, %.2g of the default: inertia counts", s->duration,
                  s->duration / usual);
  return c;
}

static bool write_profile(app *a, const simulation *sim) {
  output f;
  if (!csv_open(&f, a, sim->s.out, "profile.csv",
                sim->s.loads ? "load_Pa,T,depth/H,u/u0,exact" : "T,depth/H,u/u0,exact"))
    return false;
  for (int r = 0; r < sim->rows; r++)
    for (int k = 0; k < sim->points; k++) {
      const instant *now = &sim->row[r];
      const double line[] = {sim->load[now->step + 1], now->T, sim->at[k], now->u[k],
                             exact_at(sim, r, k)};
      csv_row(&f, sim->s.loads ? 5 : 4, sim->s.loads ? line : line + 1);
    }
  return output_close(&f);
}

static bool write_times(app *a, const simulation *sim) {
  output f;
  if (!csv_open(&f, a, sim->s.out, "times.csv",
                "T,settlement?,settlement_exact?,pressure_error,plate_force?,drained_kg,U?,"
                "U_exact?,load_Pa?,t_s?"))
    return false;
  for (int r = 0; r < sim->rows; r++) {
    const instant *now = &sim->row[r];
    CSV_LINE(&f, now->T, now->settlement, now->settlement_exact, pressure_error(sim, r), now->force,
             now->water.drained, now->U, now->U_exact,
             is_column(&sim->s) ? column_load(sim, now->step, now->T) : NAN, real_time(sim, now));
  }
  return output_close(&f);
}

/* Ends of the load steps of an oedometer. */
static bool write_steps(app *a, const simulation *sim) {
  output f;
  double before = 0.0;
  if (!sim->s.loads) return true;
  if (!csv_open(&f, a, sim->s.out, "steps.csv",
                "load_Pa,effective_stress_Pa,settlement,settlement_exact,U,modulus_Pa,"
                "void_ratio?,void_ratio_exact?"))
    return false;
  for (int r = sim->times - 1; r < sim->rows; r += sim->times) {
    const instant *now = &sim->row[r];
    const bool clay = sim->s.kase == MCC;
    const double load = sim->load[now->step + 1], start = clay ? sim->s.initial : 0.0;
    CSV_LINE(&f, load, load + start, now->settlement, now->settlement_exact, now->U,
             reference_load(sim, now->step) / (now->settlement - before),
             clay ? void_ratio(sim, now->settlement) : NAN,
             clay ? void_ratio(sim, now->settlement_exact) : NAN);
    before = now->settlement;
  }
  return output_close(&f);
}

static bool write_summary(app *a, const simulation *sim) {
  const instant *last = &sim->row[sim->rows - 1];
  double worst = 0.0;
  output f;
  for (int r = 0; r < sim->rows; r++) worst = fmax(worst, pressure_error(sim, r));
  const comparison exact = compare_exact(sim);
  const bool holds = compare_holds(&exact);
  if (!mpm_model_summary(a, &sim->m, sim->s.out, &f)) return false;
  json_text(&f, "case", names[sim->s.kase]);
  json_integer(&f, "cells", (int64_t)sim->s.cells);
  JSON_NUMBERS(&f, {"T", last->T}, {"load", sim->s.load}, {"settlement", last->settlement});
  JSON_NUMBERS(&f, {"settlement_exact", holds ? last->settlement_exact : NAN}, {"U", last->U},
               {"U_exact", holds ? last->U_exact : NAN},
               {"height", sim->s.layers != NULL ? sim->height : NAN},
               {"t", sim->s.layers != NULL ? real_time(sim, last) : NAN},
               {"pressure_error", holds ? worst : NAN});
  json_reason(&f, "exact_reason", &exact);
  JSON_NUMBERS(
      &f, {"centre_pressure", last->u[sim->points - 1]},
      {"centre_pressure_exact", holds ? exact_at(sim, sim->rows - 1, sim->points - 1) : NAN});
  JSON_NUMBERS(&f, {"plate_force", last->force}, {"degree", last->degree},
               {"degree_equal_strain", last->degree_equal}, {"water_start_kg", last->water.start},
               {"water_kg", last->water.mass}, {"entered_kg", last->water.entered},
               {"left_kg", last->water.left}, {"drained_kg", last->water.drained},
               {"residual_kg", last->water.residual});
  json_end(&f);
  return output_close(&f);
}

static bool draw_profile(app *a, const simulation *sim) {
  static const char *const titles[] = {"Terzaghi", "Xie and Leo", "Cam-Clay", "Mandel",
                                       "Cryer",    "Strip load",  "Barron"};
  static const char *const depths[] = {"depth/H", "depth/H", "depth/H", "1 - x/a",
                                       "1 - r/a", "z/B",     "1 - r/a"};
  output f;
  if (!plot_begin(&f, a, sim->s.out, "profile")) return false;
  output_text(
      &f,
      "first = 'Pore pressure: %s, %g cells'; y_name = '%s'\nrows = %d; points = %d; column = "
      "%d\narray names[rows]\n",
      titles[sim->s.kase], sim->s.cells, depths[sim->s.kase], (int)sim->rows, (int)sim->points,
      sim->s.loads ? 2 : 1);
  for (int r = 0; r < sim->rows; r++)
    if (sim->s.loads)
      output_text(&f, "names[%d] = '%g kPa, T = %g'\n", r + 1,
                  1e-3 * sim->load[sim->row[r].step + 1], sim->row[r].T);
    else if (sim->s.kase == STRIP)
      output_text(&f, "names[%d] = 'strip'\n", r + 1);
    else
      output_text(&f, "names[%d] = 'T = %g'\n", r + 1, sim->row[r].T);
  return plot_end(&f, sim->s.out, "profile", "consolidation");
}

bool consolidation_finish(app *a, void *user) {
  simulation *sim = user;
  if (sim->rows == 0) return true;
  if (!write_profile(a, sim) || !write_times(a, sim) || !write_summary(a, sim) ||
      !write_steps(a, sim) || !draw_profile(a, sim))
    return false;
  app_tell_results(a, sim->s.out);
  const comparison exact = compare_exact(sim);
  const bool holds = compare_holds(&exact);
  compare_tell(&exact);
  for (int r = 0; r < sim->rows; r++) {
    const instant *now = &sim->row[r];
    if (sim->s.kase == STRIP) {
      if (holds)
        printf("undrained: u/q on the axis within %.2f %% (root of the mean square)\n",
               100.0 * pressure_error(sim, r));
      continue;
    }
    if (sim->s.loads) printf("%g kPa, ", 1e-3 * sim->load[now->step + 1]);
    printf("T = %-6g", now->T);
    if (holds) printf(" u/u0 within %.2f %%", 100.0 * pressure_error(sim, r));
    if (!isnan(now->settlement)) printf("%s settlement %.5f H", holds ? "," : "", now->settlement);
    if (!isnan(now->settlement) && holds)
      printf(" (exact %.5f, %+.1f %%)", now->settlement_exact,
             100.0 * (now->settlement / now->settlement_exact - 1.0));
    if (!isnan(now->U)) printf(", U %.4f", now->U);
    if (!isnan(now->U) && holds) printf(" (%.4f)", now->U_exact);
    if (sim->s.layers)
      printf(", %.3g days, %.3g mm", real_time(sim, now) / 86400.0,
             1e3 * now->settlement * sim->height);
    if (!isnan(now->degree)) printf(", U %.4f (equal strain %.4f)", now->degree, now->degree_equal);
    if (!isnan(now->force)) printf(", force of the plate %.4f of the exact one", now->force);
    printf("\n");
  }
  return true;
}
