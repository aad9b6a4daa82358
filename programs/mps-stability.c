/* mps-stability - the critical time step of a soil column, Yoshida: one case, or the whole study.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/compare.h"
#include "common/options.h"
#include "stability/study.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct settings {
  bool study, paper;
  int wave, integrator;
  double spacing, velocity, other, damping; /* as in stability_case */
  double vs, vp;                            /* m/s; NaN: not given */
  method m;
  int64_t threads;
  const char *out;
} settings;

static const char purpose[] = "Critical time step of a 10 m x 100 m soil column by explicit MPS: "
                              "by linear theory, and as in\n"
                              "the paper by bisection over runs under a Ricker pulse. One case, or "
                              "with --study all 320 cases\n"
                              "of the paper's Table 1 with its regression and Figures 3 to 10.";

/* The two velocities from those that were given (NaN: not given). */
static void choose_velocities(settings *s) {
  double vs = s->vs, vp = s->vp;
  if (!isnan(s->velocity)) { /* as in the paper */
    s->other = s->wave == 0 ? 2.0 * s->velocity : 0.5 * s->velocity;
    return;
  }
  if (isnan(vs)) vs = isnan(vp) ? 100.0 : 0.5 * vp;
  if (isnan(vp)) vp = 2.0 * vs;
  s->velocity = s->wave == 0 ? vs : vp;
  s->other = s->wave == 0 ? vp : vs;
}

static int parse(settings *s, int argc, char **argv) {
  *s = (settings){0};
  method *m = &s->m;
  option table[] = {
      OPTION_HEADING("Study"),
      OPTION_FLAG("paper", &s->paper, NULL),
      OPTION_FLAG("study", &s->study, NULL),
      OPTION_HEADING("One case"),
      OPTION_CHOICE("wave", &s->wave, NULL),
      OPTION_NUMBER_IN("spacing", OPTION_FROM_TO(0.01, 10.0), &s->spacing, NULL, 1.0),
      OPTION_NUMBER("vs", &s->vs, "default half of Vp, 100 m/s if neither is given", NAN),
      OPTION_NUMBER("vp", &s->vp, "default twice Vs", NAN),
      OPTION_NUMBER("wave-velocity", &s->velocity, NULL, NAN),
      OPTION_NUMBER("damping", &s->damping, NULL),
      OPTION_CHOICE("integrator", &s->integrator, NULL, MPS_DYNAMICS_INTEGRATOR_VERLET),
      OPTION_HEADING("Method"),
      OPTION_CHOICE_OF("method", "linear|stepping|both", &m->kind,
                       "linear theory (fast), bisection by time stepping, or both", METHOD_BOTH),
      OPTION_NUMBER("criterion", &m->criterion, NULL, NAN),
      OPTION_NUMBER("accuracy", &m->accuracy, NULL, 1.01),
      OPTION_NUMBER("duration", &m->duration,
                    "of each run; default 0.5 s and 1.1 travel times over 100 m", NAN),
      OPTION_NUMBER("f1", &m->f1, NULL, 1.0),
      OPTION_NUMBER("f2", &m->f2,
                    "default 14, of the study 15 Hz: f1 + f2 = 16 Hz gives the paper's Table 2",
                    NAN),
      OPTION_CHOICE("rotation", &m->rotation, NULL),
      OPTION_CHOICE("torque", &m->torque, NULL),
      OPTION_HEADING("Running and results"),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {"mps-stability", purpose, table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  static const option_preset paper[] = {{"criterion", "1e15"}, {"accuracy", "1.2"}, {0}};
  const int preferred = s->paper ? options_prefer(&program, paper) : -1;
  if (preferred >= 0) return preferred;
  static const char *const single[] = {"wave",          "spacing", "vs",        "vp",
                                       "wave-velocity", "damping", "integrator"};
  char text[160];
  for (int i = 0; s->study && i < 7; i++) {
    if (!options_given(table, single[i])) continue;
    snprintf(text, sizeof text, "--%s and --study exclude each other", single[i]);
    return options_refuse(&program, text);
  }
  if (!isnan(s->velocity) && (!isnan(s->vs) || !isnan(s->vp)))
    return options_refuse(&program, "--wave-velocity and --vs or --vp exclude each other");
  choose_velocities(s);
  const double slow = s->wave == 0 ? s->velocity : s->other;
  const double fast = s->wave == 0 ? s->other : s->velocity;
  if (fast < sqrt(2.0) * slow * (1.0 - 1e-12)) {
    snprintf(text, sizeof text, "--vp is %g m/s, must be >= sqrt(2) times --vs: %g m/s", fast,
             sqrt(2.0) * slow);
    return options_refuse(&program, text);
  }
  if (isnan(m->criterion))
    m->criterion =
        s->integrator == MPS_DYNAMICS_INTEGRATOR_EULER ? STUDY_INTEGRATOR_CRITERION : 2.2;
  if (isnan(m->f2)) m->f2 = s->study ? 15.0 : 14.0;
  return -1;
}

/* ---- one case -------------------------------------------------------------------------------- */

#define EULERS 1e12 /* m/s2: criteria above are those of growth alone */

/* Linear theory beside time stepping. Without damping Euler's motion grows at any step: its limit
 * is that at which it grows by 1e15 in a run. */
static comparison compare_linear(const settings *s, const stability_case *x) {
  comparison c = compare_with("linear theory", x->stepping, x->linear);
  compare_require(&c, s->m.kind != METHOD_STEPPING, "it was not asked for by --method");
  compare_require(&c,
                  x->integrator != MPS_DYNAMICS_INTEGRATOR_EULER || s->m.criterion >= EULERS ||
                      s->m.kind == METHOD_LINEAR,
                  "its limit of Euler is growth by 1e15 in a run, and --criterion %g m/s2 is near "
                  "the response itself",
                  s->m.criterion);
  return c;
}

static comparison compare_table2(const settings *s, const stability_case *x) {
  comparison c =
      compare_with("the paper's Table 2", isnan(x->stepping) ? x->linear : x->stepping, x->table2);
  compare_require(&c, x->integrator != MPS_DYNAMICS_INTEGRATOR_EULER, "it is not of Euler");
  compare_require(&c, !isnan(x->table2), "it is of damping above 0, up to 0.22");
  compare_require(&c, fabs(case_vp(x) - 2.0 * case_vs(x)) <= 1e-6 * case_vp(x),
                  "it is of Vp = 2 Vs");
  compare_require(&c, fabs(s->m.f1 + s->m.f2 - 16.0) <= 1.0,
                  "it is of --f1 + --f2 = 16 Hz, here they are %g Hz", s->m.f1 + s->m.f2);
  return c;
}

/* `known`: otherwise the result is null. */
static bool open_case(output *out, app *a, const settings *s, const stability_case *x, bool known) {
  static const char *const integrators[] = {"verlet", "leapfrog", "euler"};
  const char wave[2] = {x->wave, '\0'};
  output f;
  if (!summary_open(&f, a, s->out)) return false;
  json_text(&f, "wave", wave);
  json_text(&f, "integrator", integrators[x->integrator]);
  JSON_NUMBERS(&f, {"spacing", x->radius}, {"vs", case_vs(x)}, {"vp", case_vp(x)},
               {"damping", x->damping});
  json_integer_if(&f, known, "particles", x->particles);
  JSON_NUMBERS(&f, {"f1", s->m.f1}, {"f2", s->m.f2}, {"criterion", s->m.criterion},
               {"accuracy", s->m.accuracy}, {"duration", method_duration(&s->m, x->velocity)});
  const comparison linear = compare_linear(s, x), table2 = compare_table2(s, x);
  if (known)
    json_comparison(&f, "dt_linear", &linear);
  else
    json_number(&f, "dt_linear", NAN);
  JSON_NUMBERS(&f, {"dt_stepping", known ? x->stepping : NAN},
               {"dt_stepping_unstable", known ? x->unstable : NAN});
  if (known)
    json_comparison(&f, "dt_table2", &table2);
  else
    json_number(&f, "dt_table2", NAN);
  json_integer_if(&f, known, "steps", x->steps);
  json_end(&f);
  *out = f;
  return true;
}

static bool write_case(app *a, const settings *s, const stability_case *x, bool known) {
  output f;
  return open_case(&f, a, s, x, known) && output_close(&f);
}

/* The summary that is written where Ctrl-C ends the program at once. */
static bool reserve_case(app *a, const settings *s, const stability_case *x) {
  output f;
  a->outcome = "interrupted";
  const bool opened = open_case(&f, a, s, x, false);
  a->outcome = "finished";
  return opened && output_reserve(&f);
}

typedef struct bisection_bar {
  progress *bar;
  double runs; /* expected */
} bisection_bar;

static void draw_bisection(void *user, const mps_context_progress *p) {
  const bisection_bar *b = user;
  char text[32];
  snprintf(text, sizeof text, "run %lld", (long long)p->step);
  progress_draw(b->bar, fmin(1.0, (double)p->step / b->runs), text);
}

static int run_case(app *a, const settings *s) {
  stability_case x = {.wave = s->wave == 0 ? 'S' : 'P',
                      .integrator = s->integrator,
                      .radius = 0.5 * s->spacing,
                      .velocity = s->velocity,
                      .other = s->other,
                      .damping = s->damping};
  /* Two first bounds some 20 % apart, then each run halves the logarithm of their ratio. */
  bisection_bar b = {&a->bar, 2.0 + ceil(fmax(0.0, log2(log(1.25) / log(s->m.accuracy))))};
  a->no_warnings = true; /* of steps beyond the limit, which is sought */
  if (!app_agree(a, a->rank > 0 || reserve_case(a, s, &x))) return APP_FAILED;
  app_leave_at_once(a, !a->domain); /* a single case has no partial result */
  case_find_together(a, &s->m, &x, draw_bisection, &b);
  app_leave_at_once(a, false);
  progress_clear(&a->bar);
  if (x.status == MPS_ERROR_CANCELLED) {
    a->outcome = "interrupted";
    app_error(a, "interrupted: there are no results yet");
    const bool ok = app_agree(a, a->rank > 0 || write_case(a, s, &x, false));
    return ok ? APP_INTERRUPTED : APP_FAILED;
  }
  if (x.status != MPS_OK) {
    app_error(a, "%s", x.why);
    return APP_FAILED;
  }
  if (!app_agree(a, a->rank > 0 || write_case(a, s, &x, true))) return APP_FAILED;
  app_tell_results(a, s->out);
  printf("%c wave, R = %g m, Vs = %g m/s, Vp = %g m/s, h = %g, %lld particles\n", x.wave, x.radius,
         case_vs(&x), case_vp(&x), x.damping, (long long)x.particles);
  const comparison linear = compare_linear(s, &x), table2 = compare_table2(s, &x);
  const char *comma = "";
  printf("critical dt:");
  if (compare_holds(&linear)) {
    printf(" %.4g s by linear theory%s", x.linear,
           x.integrator == MPS_DYNAMICS_INTEGRATOR_EULER ? " (growth by 1e15 in the run)" : "");
    comma = ",";
  }
  if (!isnan(x.stepping)) {
    printf("%s %.4g s by time stepping (%.4g s exceeds %g m/s2)", comma, x.stepping, x.unstable,
           s->m.criterion);
    comma = ",";
  }
  if (compare_holds(&table2)) printf("%s %.4g s by the paper's Table 2", comma, x.table2);
  printf("\n");
  if (s->m.kind == METHOD_BOTH) compare_tell(&linear);
  if (s->damping > 0.0) compare_tell(&table2);
  return APP_OK;
}

/* ---- the study ------------------------------------------------------------------------------- */

static int run_study(app *a, const settings *s) {
  study *all = malloc(sizeof *all);
  if (!app_agree(a, all || app_no_memory(a))) {
    free(all);
    return APP_FAILED;
  }
  int code = study_run(a, &s->m, all) ? APP_OK : APP_FAILED;
  if (code == APP_OK && all->done < STUDY_CASES) {
    a->outcome = "interrupted";
    app_error(a, "interrupted: limits.csv and integrators.csv have %lld of %d cases",
              (long long)all->done, STUDY_CASES);
    const bool ok = app_agree(
        a, a->rank > 0 || (study_write_limits(a, all, s->out) && study_summary(a, all, s->out)));
    code = ok ? APP_INTERRUPTED : APP_FAILED;
  } else if (code == APP_OK) {
    const bool ok = a->rank > 0 || (study_fit(a, all) && study_write(a, all, s->out) &&
                                    study_draw(a, all, s->out) && study_summary(a, all, s->out));
    code = app_agree(a, ok) ? APP_OK : APP_FAILED;
  }
  free(all);
  return code;
}

int main(int argc, char **argv) {
  settings s;
  app a;
  int code = parse(&s, argc, argv);
  if (code >= 0) return code;
  code = APP_FAILED;
  if (app_start(&a, "mps-stability", s.threads) &&
      app_agree(&a, a.rank > 0 || output_directory(&a, s.out))) {
    code = s.study ? run_study(&a, &s) : run_case(&a, &s);
    if (code == APP_FAILED) app_agree(&a, false); /* all ranks know */
  }
  return app_finish(&a, code);
}
