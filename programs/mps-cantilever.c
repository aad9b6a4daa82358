/* mps-cantilever - rectangular cantilever of particles under an end load, Chikazawa, Figures 4
 * to 8. SPDX-License-Identifier: BSD-3-Clause */
#include "cantilever/cantilever.h"
#include "common/output.h"

#include <math.h>
#include <stdio.h>

typedef struct settings {
  beam problem;
  elastic_settings method;
  int64_t nx, ny, threads;
  double spacing, length;
  int wall;
  bool convergence;
  const char *out;
} settings;

static const char purpose[] =
    "Deflection and stress of a cantilever of particles (implicit elasticity, CHOLMOD), against\n"
    "the analytic solution: by default of concrete, five times as long as high, twenty particles "
    "high.";

/* Of Figure 5, with the sizes that find_size has. */
static const option_preset paper[] = {
    {"height", "2m"}, {"young", "1Pa"}, {"poisson", "0.3"}, {"end-load", "1N/m"}, {0}};

/* Whole particles in the height, and in the length, which ends in the middle of a layer: -1, or an
 * exit code. */
static int find_size(const options_program *program, settings *s) {
  const double height = s->problem.height;
  const bool as_printed = s->method.paper;
  if (isnan(s->spacing)) s->spacing = height / (as_printed ? 9.0 : 20.0);
  if (s->spacing < height / 5000.5 || s->spacing > height / 1.5)
    return options_refuse(program, "--spacing must give 2 to 5000 particles in --height");
  s->ny = (int64_t)options_divide("spacing", &s->spacing, "--height", height, false);
  if (isnan(s->length))
    s->length = as_printed ? 16.5 * height / 9.0 : 5.0 * height + 0.5 * s->spacing;
  s->nx = (int64_t)llround(s->length / s->spacing + 0.5);
  if (s->nx < 3 || s->nx > 20000) {
    char text[200];
    snprintf(text, sizeof text, "--length %g m is %lld particles of %g m, allowed are 3 to 20000",
             s->length, (long long)s->nx, s->spacing);
    return options_refuse(program, text);
  }
  s->problem.length = model_length(height, s->nx, s->ny);
  if (fabs(s->length - s->problem.length) > 1e-5 * s->length)
    options_note(
        "--length is %.6g m, taken as %.6g m: particles every %.6g m, the last at the wall",
        s->length, s->problem.length, s->spacing);
  return -1;
}

static int parse(settings *s, int argc, char **argv) {
  *s = (settings){0};
  option table[] = {
      OPTION_HEADING("Beam"),
      OPTION_NUMBER("spacing", &s->spacing, "default a twentieth of --height", NAN),
      OPTION_NUMBER(
          "length", &s->length,
          "from the loaded end to the wall, whole particles; default 5 times --height and half a "
          "particle",
          NAN),
      OPTION_NUMBER("height", &s->problem.height, "of the section", 1.0),
      ELASTIC_MATERIAL(&s->method, 30e9, 0.2),
      OPTION_NUMBER("end-load", &s->problem.load, NULL, 1e4),
      OPTION_CHOICE_OF("support", "exact|clamp", &s->wall, NULL),
      ELASTIC_METHOD(&s->method),
      OPTION_HEADING("Running"),
      OPTION_FLAG("convergence", &s->convergence, NULL),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {"mps-cantilever", purpose, table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  const int preferred = elastic_prefer(&program, &s->method, paper);
  if (preferred >= 0) return preferred;
  s->problem.young = s->method.young;
  s->problem.poisson = s->method.poisson;
  s->problem.plane_strain = s->method.state == 1;
  s->problem.clamped = s->wall == 1;
  return find_size(&program, s);
}

#define MOST_POISSON 0.49 /* of bilinear elements in plane strain */

static int run(app *a, const settings *s) {
  model m = {0};
  q4 reference = {0};
  const beam *problem = &s->problem;
  const elastic_method method = elastic_settings_method(&s->method);
  int64_t elements = (int64_t)ceil(48.0 * problem->length / problem->height);
  if (elements > 1000) elements = 1000;
  bool done = app_agree(a, a->rank > 0 || output_directory(a, s->out));
  if (done && problem->clamped)
    done = q4_solve(problem, elements + 1, 49, &reference) || app_no_memory(a);
  if (problem->clamped && problem->plane_strain && problem->poisson > MOST_POISSON)
    app_warn(a, "the finite elements of the comparison are too stiff above --poisson %g",
             MOST_POISSON);
  printf("%s method, %lld x %lld particles, beam %.6g m x %.6g m\n",
         elastic_method_name(&s->method), (long long)s->nx, (long long)s->ny, problem->length,
         problem->height);
  fflush(stdout);
  m = (model){.a = a, .problem = problem, .nx = s->nx, .ny = s->ny};
  m.reference = problem->clamped ? &reference : NULL;
  done = app_agree(a, done && (a->rank > 0 || results_reserve(&m, &method, s->out)));
  const double seconds = elastic_seconds((double)(s->nx * s->ny));
  const double all = seconds + (s->convergence ? convergence_seconds(s->nx, s->ny) : 0.0);
  app_leave_at_once(a, true); /* no hook reaches into the factorisation */
  elastic_bar(a, 0.0, seconds / all, seconds);
  done = app_agree(a, done && model_solve(a, problem, m.reference, s->nx, s->ny, &method, &m));
  elastic_bar(a, seconds / all, 0.0, 0.0);
  app_leave_at_once(a, false);
  if (done) elastic_warn(a, options_read(), "end-load", m.tip, problem->length);
  done = done && app_agree(a, a->rank > 0 || results_write(&m, &method, s->out));
  if (done) {
    printf("reactions balance the load to %.1e; %lld unknowns, ", m.equilibrium,
           (long long)m.report.unknowns);
    elastic_tell(a, &m.report);
    if (s->convergence) done = convergence_run(&m, &method, seconds / all, s->out);
  }
  if (done) app_tell_results(a, s->out);
  if (done)
    printf("tip deflection %.6g m, %s %.6g m: error %+.2f %%; stress error %.2f %%\n", m.tip,
           problem->clamped ? "fine finite elements" : "theory (11)", m.tip_exact,
           100.0 * m.tip_error, 100.0 * m.stress_error);
  model_free(&m);
  q4_free(&reference);
  return done ? APP_OK : APP_FAILED;
}

int main(int argc, char **argv) {
  settings s;
  app a;
  const int code = parse(&s, argc, argv);
  if (code >= 0) return code;
  if (!app_start(&a, "mps-cantilever", s.threads)) return app_finish(&a, APP_FAILED);
  return app_finish(&a, run(&a, &s));
}
