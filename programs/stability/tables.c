/* tables.c - CSV and JSON results of the stability study.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "study.h"

#include "common/output.h"

#include <math.h>
#include <stdio.h>

static const char waves[] = "SP";

static bool write_limits(app *a, const study *s, const char *directory) {
  output f;
  if (!csv_open(&f, a, directory, "limits.csv", "wave,R,V,h,dt_linear?,dt_stepping?,dt_table2?"))
    return false;
  for (int64_t i = 0; i < STUDY_GRID; i++) {
    const stability_case *x = &s->cases[i];
    const double row[] = {x->radius, x->velocity, x->damping, x->linear, x->stepping, x->table2};
    const char wave[2] = {x->wave, '\0'};
    csv_named_row(&f, wave, 6, row);
  }
  return output_close(&f);
}

static bool write_integrators(app *a, const study *s, const char *directory) {
  static const char *const names[] = {"verlet", "leapfrog", "euler"};
  output f;
  if (!csv_open(&f, a, directory, "integrators.csv",
                "integrator,R_m,h,dt_linear_s?,dt_stepping_s?"))
    return false;
  for (int64_t i = STUDY_GRID; i < STUDY_CASES; i++) {
    const stability_case *x = &s->cases[i];
    const double row[] = {x->radius, x->damping, x->linear, x->stepping};
    csv_named_row(&f, names[x->integrator], 4, row);
  }
  return output_close(&f);
}

/* ---- regression ------------------------------------------------------------------------------ */

static double quadratic(const double b[3], double h) {
  const double x = log10(h);
  return pow(10.0, (b[0] * x + b[1]) * x + b[2]);
}

static bool write_regression(app *a, const study *s, const char *directory) {
  output f;
  if (!csv_open(&f, a, directory, "regression.csv",
                "wave,method,h,a1,a2,a1_quadratic?,a2_quadratic?,a1_table2?,a2_table2?"))
    return false;
  for (int k = 0; k < 4; k++) {
    const int wave = k % 2;
    const regression *r = k < 2 ? &s->linear[wave] : &s->stepping[wave];
    if (!r->known) continue;
    const limit_fit *fit = &r->fit, *printed = &s->printed[wave];
    for (int32_t i = 0; i < fit->dampings; i++) {
      const double h = fit->h[i];
      const bool inside = h <= 0.2201; /* the quadratics are valid up to there */
      const double row[] = {h,
                            fit->a1[i],
                            fit->a2[i],
                            inside ? quadratic(fit->b1, h) : NAN,
                            inside ? quadratic(fit->b2, h) : NAN,
                            inside ? quadratic(printed->b1, h) : NAN,
                            inside ? quadratic(printed->b2, h) : NAN};
      char name[32];
      snprintf(name, sizeof name, "%c,%s", waves[wave], k < 2 ? "linear" : "stepping");
      csv_named_row(&f, name, 7, row);
    }
  }
  return output_close(&f);
}

static bool write_coefficients(app *a, const study *s, const char *directory) {
  output f;
  if (!csv_open(&f, a, directory, "coefficients.csv",
                "wave,method,b11,b12,b13,b21,b22,b23,rms_of_fit?"))
    return false;
  for (int wave = 0; wave < 2; wave++)
    for (int k = 0; k < 3; k++) {
      const regression *r = k == 0 ? &s->linear[wave] : &s->stepping[wave];
      if (k < 2 && !r->known) continue;
      const limit_fit *fit = k < 2 ? &r->fit : &s->printed[wave];
      static const char *const names[] = {"linear", "stepping", "table2"};
      const double row[] = {fit->b1[0],
                            fit->b1[1],
                            fit->b1[2],
                            fit->b2[0],
                            fit->b2[1],
                            fit->b2[2],
                            k < 2 ? fit->rms : NAN};
      char name[32];
      snprintf(name, sizeof name, "%c,%s", waves[wave], names[k]);
      csv_named_row(&f, name, 7, row);
    }
  return output_close(&f);
}

bool study_write_limits(app *a, const study *s, const char *directory) {
  return write_limits(a, s, directory) && write_integrators(a, s, directory);
}

bool study_write(app *a, const study *s, const char *directory) {
  return study_write_limits(a, s, directory) && write_regression(a, s, directory) &&
         write_coefficients(a, s, directory);
}

/* ---- summary --------------------------------------------------------------------------------- */

/* Verlet's limit over Euler's at h = 0.001, R = 0.5 m. */
static double gain_of_verlet(const study *s) {
  const stability_case *euler = &s->cases[STUDY_GRID];
  const stability_case *verlet = euler + 2 * STUDY_THIRD;
  return s->m.kind == METHOD_LINEAR ? verlet->linear / euler->linear
                                    : verlet->stepping / euler->stepping;
}

bool study_summary(app *a, const study *s, const char *directory) {
  static const char *const kinds[] = {"linear", "stepping", "both"};
  output f;
  if (!summary_open(&f, a, directory)) return false;
  double ratio = NAN;
  int64_t steps = 0;
  for (int64_t i = 0; i < STUDY_CASES; i++) steps += s->cases[i].steps;
  for (int64_t i = 0; i < STUDY_GRID && s->m.kind == METHOD_BOTH; i++)
    ratio = fmax(ratio, s->cases[i].stepping / s->cases[i].linear);
  json_text(&f, "method", kinds[s->m.kind]);
  json_integer(&f, "cases", STUDY_CASES);
  json_integer(&f, "cases_done", s->done);
  json_integer(&f, "steps", steps);
  JSON_NUMBERS(&f, {"f1", s->m.f1}, {"f2", s->m.f2}, {"criterion", s->m.criterion},
               {"accuracy", s->m.accuracy});
  /* through the regression: own coefficients against the printed ones; cases: each limit */
  static const char *const methods[] = {"", "_stepping"};
  for (int k = 0; k < 2; k++)
    for (int wave = 0; wave < 2; wave++) {
      const regression *r = k == 0 ? &s->linear[wave] : &s->stepping[wave];
      char key[48];
      snprintf(key, sizeof key, "rms_table2%s_%c", methods[k], waves[wave]);
      json_number(&f, key, r->known ? r->rms_fits : NAN);
      snprintf(key, sizeof key, "rms_table2%s_cases_%c", methods[k], waves[wave]);
      json_number(&f, key, r->known ? r->rms_table2 : NAN);
    }
  JSON_NUMBERS(&f, {"stepping_over_linear_max", ratio}, {"verlet_over_euler", gain_of_verlet(s)});
  json_end(&f);
  if (!output_close(&f)) return false;
  app_tell_results(a, directory);
  if (s->done < STUDY_CASES) return true;
  const regression *r = s->linear[0].known ? s->linear : s->stepping;
  printf("%d cases, h up to 0.22: regression against the paper's Table 2 rms %.1f %% (S), %.1f %% "
         "(P); the cases themselves against it %.1f %%, %.1f %%\n",
         STUDY_GRID, 100.0 * r[0].rms_fits, 100.0 * r[1].rms_fits, 100.0 * r[0].rms_table2,
         100.0 * r[1].rms_table2);
  return true;
}
