/* results.c - tables and the picture of mps-consolidation.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/plot.h"
#include "consolidation.h"

#include <math.h>
#include <stdio.h>

static const char *const names[] = {"terzaghi", "large", "mcc",   "mandel",
                                    "cryer",    "strip", "barron"};

static double exact_at(const simulation *sim, int r, int point) {
  return exact_pressure(&sim->s, sim->s.load / sim->modulus, sim->at[point], sim->row[r].T);
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

static bool write_profile(app *a, const simulation *sim) {
  output f;
  if (!output_open(&f, a, sim->s.out, "profile.csv")) return false;
  csv_header(&f, "T,depth/H,u/u0,exact");
  for (int r = 0; r < sim->rows; r++)
    for (int k = 0; k < sim->points; k++) {
      const double line[] = {sim->row[r].T, sim->at[k], sim->row[r].u[k], exact_at(sim, r, k)};
      csv_row(&f, 4, line);
    }
  return output_close(&f);
}

static bool write_times(app *a, const simulation *sim) {
  output f;
  if (!output_open(&f, a, sim->s.out, "times.csv")) return false;
  csv_header(&f, "T,settlement?,settlement_exact?,pressure_error,plate_force?,drained_kg");
  for (int r = 0; r < sim->rows; r++) {
    const instant *now = &sim->row[r];
    const double line[] = {
        now->T,     now->settlement,   now->settlement_exact, pressure_error(sim, r),
        now->force, now->water.drained};
    csv_row(&f, 6, line);
  }
  return output_close(&f);
}

static bool write_summary(app *a, const simulation *sim) {
  const instant *last = &sim->row[sim->rows - 1];
  double worst = 0.0;
  output f;
  for (int r = 0; r < sim->rows; r++) worst = fmax(worst, pressure_error(sim, r));
  if (!mpm_model_summary(a, &sim->m, sim->s.out, &f)) return false;
  json_text(&f, "case", names[sim->s.kase]);
  json_integer(&f, "cells", (int64_t)sim->s.cells);
  json_number(&f, "T", last->T);
  json_number(&f, "load", sim->s.load);
  json_number(&f, "settlement", last->settlement);
  json_number(&f, "settlement_exact", last->settlement_exact);
  json_number(&f, "pressure_error", worst);
  json_number(&f, "centre_pressure", last->u[sim->points - 1]);
  json_number(&f, "centre_pressure_exact", exact_at(sim, sim->rows - 1, sim->points - 1));
  json_number(&f, "plate_force", last->force);
  json_number(&f, "degree", last->degree);
  json_number(&f, "degree_equal_strain", last->degree_equal);
  json_number(&f, "water_start_kg", last->water.start);
  json_number(&f, "water_kg", last->water.mass);
  json_number(&f, "entered_kg", last->water.entered);
  json_number(&f, "left_kg", last->water.left);
  json_number(&f, "drained_kg", last->water.drained);
  json_number(&f, "residual_kg", last->water.residual);
  json_end(&f);
  return output_close(&f);
}

static bool draw_profile(app *a, const simulation *sim) {
  static const char *const colours[] = {"#1f4e8c", "#c0392b", "#2e7d32", "#8e44ad",
                                        "#d68910", "#117a65", "#5d4037", "#34495e"};
  static const char *const titles[] = {"Terzaghi", "Xie and Leo", "Cam-Clay", "Mandel",
                                       "Cryer",    "Strip load",  "Barron"};
  static const char *const depths[] = {"depth/H", "depth/H", "depth/H", "1 - x/a",
                                       "1 - r/a", "z/B",     "1 - r/a"};
  output f;
  if (!plot_open(&f, a, sim->s.out, "profile", 900, 700)) return false;
  output_text(&f,
              "set title 'Pore pressure: %s, %g cells'\nset xlabel 'u/u_0'\nset ylabel '%s'\n"
              "set yrange [*:*] reverse\nset xrange [0:*]\nset key outside right top\nplot ",
              titles[sim->s.kase], sim->s.cells, depths[sim->s.kase]);
  for (int r = 0; r < sim->rows; r++) {
    const char *colour = colours[r % 8];
    char title[48] = "strip";
    if (sim->s.kase != STRIP) snprintf(title, sizeof title, "T = %g", sim->row[r].T);
    output_text(&f,
                "%s'profile.csv' every ::%d::%d using 3:2 with points pointtype 7 pointsize 0.7 "
                "linecolor rgb '%s' title '%s', \\\n  '' every ::%d::%d using 4:2 with lines "
                "linecolor rgb '%s' title '%s'",
                r ? ", \\\n  " : "", r * sim->points + 1, (r + 1) * sim->points, colour, title,
                r * sim->points + 1, (r + 1) * sim->points, colour,
                r + 1 < sim->rows ? "" : "exact");
  }
  output_text(&f, "\n");
  return plot_close(&f, sim->s.out, "profile");
}

bool consolidation_finish(app *a, void *user) {
  simulation *sim = user;
  if (sim->rows == 0) return true;
  if (!write_profile(a, sim) || !write_times(a, sim) || !write_summary(a, sim) ||
      !draw_profile(a, sim))
    return false;
  app_tell_results(a, sim->s.out);
  for (int r = 0; r < sim->rows; r++) {
    const instant *now = &sim->row[r];
    if (sim->s.kase == STRIP) {
      printf("undrained: u/q on the axis within %.2f %% (root of the mean square)\n",
             100.0 * pressure_error(sim, r));
      continue;
    }
    printf("T = %-6g u/u0 within %.2f %%", now->T, 100.0 * pressure_error(sim, r));
    if (!isnan(now->settlement))
      printf(", settlement %.5f H (exact %.5f, %+.1f %%)", now->settlement, now->settlement_exact,
             100.0 * (now->settlement / now->settlement_exact - 1.0));
    if (!isnan(now->degree)) printf(", U %.4f (equal strain %.4f)", now->degree, now->degree_equal);
    if (!isnan(now->force)) printf(", force of the plate %.4f of the exact one", now->force);
    printf("\n");
  }
  return true;
}
