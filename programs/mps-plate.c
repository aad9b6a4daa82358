/* mps-plate - square plate of particles in tension (Chikazawa, Figures 2 and 3), or a plate with a
 * hole. SPDX-License-Identifier: BSD-3-Clause */
#include "common/output.h"
#include "plate/plate.h"

#include <math.h>
#include <stdio.h>

typedef struct settings {
  plate_def plate;
  elastic_settings method;
  int64_t threads;
  int shape;
  const char *out;
} settings;

static const char purpose[] =
    "Plate of particles in tension (implicit elasticity, CHOLMOD), against the exact solution: a\n"
    "square of steel, Chikazawa, Figure 2; --case hole is a quarter of Kirsch's plate.";

/* Of Figure 2. */
static const option_preset paper[] = {
    {"young", "1Pa"}, {"poisson", "0.3"}, {"edge-stress", "1Pa"}, {0}};

/* Defaults of the hole, where they differ; -1, or an exit code. */
static int check_hole(const options_program *program, settings *s) {
  s->plate.hole = s->shape == 1;
  if (!s->plate.hole) {
    if (options_given(program->table, "radius"))
      return options_refuse(program, "--radius is for --case hole only");
    return -1;
  }
  if (!options_given(program->table, "side")) s->plate.side = 4.0 * s->plate.radius;
  if (!(s->plate.side >= 3.0 * s->plate.radius))
    return options_refuse(program, "--side must be at least 3 times --radius");
  return -1;
}

/* Whole particles along the side; along the radius half a spacing more, as the centre of the hole
 * is between particles. -1, or an exit code. */
static int find_spacing(const options_program *program, settings *s) {
  plate_def *p = &s->plate;
  const double length = p->hole ? p->radius : p->side;
  if (isnan(p->spacing)) p->spacing = length / (p->hole ? 40.5 : 17.0);
  p->across =
      options_divide("spacing", &p->spacing, p->hole ? "--radius" : "--side", length, p->hole);
  if (p->across < (p->hole ? 5.0 : 2.0))
    return options_refuse(program, p->hole ? "--spacing must be at most a fifth of --radius"
                                           : "--spacing must be at most half of --side");
  if (p->side > 3000.5 * p->spacing)
    return options_refuse(program, "--spacing must give at most 3000 particles along --side");
  return -1;
}

static int parse(settings *s, int argc, char **argv) {
  *s = (settings){0};
  option table[] = {OPTION_HEADING("Plate"),
                    OPTION_CHOICE_OF("case", "tension|hole", &s->shape,
                                     "square, or quarter of a plate with a hole"),
                    OPTION_NUMBER("spacing", &s->plate.spacing,
                                  "default a seventeenth of --side; hole: 1/40.5 of --radius", NAN),
                    OPTION_NUMBER("side", &s->plate.side, NULL, 1.0),
                    OPTION_NUMBER("radius", &s->plate.radius, NULL, 1.0),
                    OPTION_NUMBER("edge-stress", &s->plate.tension, NULL, 100e6),
                    ELASTIC_MATERIAL(&s->method, 210e9, 0.3),
                    ELASTIC_METHOD(&s->method),
                    OPTION_HEADING("Running"),
                    OPTIONS_OF_ALL(s),
                    {0}};
  const options_program program = {"mps-plate", purpose, table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  const int preferred = elastic_prefer(&program, &s->method, paper);
  if (preferred >= 0) return preferred;
  s->plate.young = s->method.young;
  s->plate.poisson = s->method.poisson;
  s->plate.plane_strain = s->method.state == 1;
  const int refused = check_hole(&program, s);
  return refused >= 0 ? refused : find_spacing(&program, s);
}

static int run(app *a, const settings *s) {
  plate p = {.a = a, .def = &s->plate};
  const double across = s->plate.hole ? s->plate.side / s->plate.radius : 1.0;
  const double seconds = elastic_seconds(pow(across * s->plate.across, 2.0));
  const elastic_method method = elastic_settings_method(&s->method);
  bool done = app_agree(a, a->rank > 0 ||
                               (output_directory(a, s->out) && plate_reserve(&p, &method, s->out)));
  app_leave_at_once(a, true); /* no hook reaches into the factorisation */
  elastic_bar(a, 0.0, 1.0, seconds);
  done = done && app_agree(a, plate_solve(a, &s->plate, &method, &p));
  elastic_bar(a, 1.0, 0.0, 0.0);
  app_leave_at_once(a, false);
  const double end = s->plate.tension / s->plate.young * s->plate.side;
  if (done) elastic_warn(a, options_read(), "edge-stress", end, s->plate.side);
  done = done && app_agree(a, a->rank > 0 || plate_write(&p, &method, s->out));
  if (done) {
    printf("%s method, %lld particles, ", elastic_method_name(&s->method),
           (long long)mps_particles_count(p.particles));
    elastic_tell(a, &p.report);
    app_tell_results(a, s->out);
    if (s->plate.hole)
      printf("stress concentration %.3f, theory 3: error %+.2f %% (stress error over the plate "
             "%.2f %%)\n",
             p.concentration, 100.0 * (p.concentration / 3.0 - 1.0), 100.0 * p.stress_error);
    else
      printf("end displacement %.9g m, theory %.9g m: largest error %.1e, of the stress %.1e\n",
             p.end, p.end_exact, p.displacement_error, p.stress_error);
  }
  plate_free(&p);
  return done ? APP_OK : APP_FAILED;
}

int main(int argc, char **argv) {
  settings s;
  app a;
  const int code = parse(&s, argc, argv);
  if (code >= 0) return code;
  if (!app_start(&a, "mps-plate", s.threads)) return app_finish(&a, APP_FAILED);
  return app_finish(&a, run(&a, &s));
}
