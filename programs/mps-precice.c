/* mps-precice - an elastic flap coupled with another code by preCICE: tutorials' "perpendicular
 * flap". SPDX-License-Identifier: BSD-3-Clause */
#include "common/frame.h"
#include "common/output.h"
#include "common/options.h"
#include "precice/flap.h"
#include "precice/participant.h"

#include <mps/io.h>
#include <mps/elastic.h>

#include <math.h>
#include <stdio.h>

typedef struct settings {
  flap_def flap;
  participant_def coupling;
  int reads;
  int64_t threads, frames;
  const char *out;
} settings;

typedef struct records {
  app *a;
  const flap *flap;
  output table;
  mps_recorder *recorder;
  double largest, at; /* m, s: of the tip */
  int64_t windows, every;
} records;

static const char purpose[] = "An elastic flap in plane strain as a participant of a preCICE "
                              "coupling (version 3). Another code gives the forces\n"
                              "on its facets and receives their displacements. The defaults are "
                              "those of preCICE's perpendicular flap.";

static int parse(settings *s, int argc, char **argv) {
  *s = (settings){.coupling = {.config = "precice-config.xml",
                               .name = "Solid",
                               .mesh = "Solid-Mesh",
                               .force = "Force",
                               .displacement = "Displacement"}};
  const char *data = s->coupling.force, *velocity = NULL;
  option table[] = {
      OPTION_HEADING("Flap"),
      OPTION_NUMBER("width", &s->flap.width, "rounded to whole spacings", 0.1),
      OPTION_NUMBER("height", &s->flap.height, "rounded to whole spacings", 1.0),
      OPTION_NUMBER("x", &s->flap.x, "middle of its foot"),
      OPTION_NUMBER("y", &s->flap.y, NULL),
      OPTION_NUMBER("spacing", &s->flap.spacing, NULL, 0.0125),
      OPTION_NUMBER("young", &s->flap.young, NULL, 4e6),
      OPTION_NUMBER("poisson", &s->flap.poisson, NULL, 0.3),
      OPTION_NUMBER("density", &s->flap.density, NULL, 3000.0),
      OPTION_NUMBER("bending", &s->flap.bending, NULL, 1.0),
      OPTION_HEADING("Coupling"),
      LOOP_OPTIONS(s->coupling),
      OPTION_CHOICE_OF("reads", "force|stress", &s->reads, NULL),
      OPTION_TEXT("data", &data, NULL),
      OPTION_TEXT("displacement", &s->coupling.displacement, "that are written"),
      OPTION_TEXT("velocity", &velocity, "that are written"),
      OPTION_NUMBER("dt", &s->flap.dt, "at most; preCICE may ask for shorter ones", 0.01),
      OPTION_HEADING("Running"),
      OPTION_INTEGER("frames", &s->frames, NULL, 20),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {"mps-precice", purpose, table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  s->coupling.dt = s->flap.dt;
  s->coupling.velocity = velocity;
  s->coupling.force = s->reads == 0 ? data : NULL;
  s->coupling.stress = s->reads == 1 ? data : NULL;
  options_whole("width", &s->flap.width, "--spacing", s->flap.spacing);
  options_whole("height", &s->flap.height, "--spacing", s->flap.spacing);
  if (!(s->flap.width / s->flap.spacing * (s->flap.height / s->flap.spacing) <= 4e6))
    return options_refuse(&program,
                          "--width and --height hold more than 4 million particles of --spacing");
  return -1;
}

/* A time window is complete: a row of the table and, of some, a frame. */
static bool each(void *user, mps_elastic *solver) {
  records *r = user;
  double u[2];
  if (!flap_tip(r->a, r->flap, u)) return false;
  const double row[3] = {mps_elastic_time(solver), u[0], u[1]};
  csv_row(&r->table, 3, row);
  if (fabs(u[0]) > fabs(r->largest)) r->largest = u[0], r->at = row[0];
  if (r->recorder && r->windows++ % r->every == 0)
    return app_check(r->a, mps_recorder_write(r->recorder, row[0]));
  return true;
}

static bool write_summary(app *a, const settings *s, const records *r,
                          const participant_result *result) {
  output f;
  if (!summary_open(&f, a, s->out)) return false;
  json_integer(&f, "particles", mps_particles_count(r->flap->particles));
  json_integer(&f, "facets", r->flap->facet_count);
  json_integer(&f, "windows", result->windows);
  json_integer(&f, "steps", result->steps);
  json_integer(&f, "windows_repeated", result->repeats);
  JSON_NUMBERS(&f, {"tip_largest_m", r->largest}, {"tip_largest_time_s", r->at});
  json_end(&f);
  return output_close(&f);
}

static bool run(app *a, settings *s) {
  flap body;
  records r = {.a = a, .flap = &body, .every = 1};
  participant_result result = {0};
  bool good = output_directory(a, s->out) && flap_make(a, &s->flap, &body);
  if (good && s->frames > 0)
    good = app_check(a, frame_series(a, body.particles, s->out, "flap", NAN, &r.recorder));
  good = good && output_open(&r.table, a, s->out, "tip.csv");
  if (good) {
    csv_header(&r.table, "t_s,x_m,y_m");
    s->coupling.each = each;
    s->coupling.user = &r;
    good = participant_run(a, body.solver, body.facet_count, body.facets, &s->coupling, &result);
    good = output_close(&r.table) && good;
  }
  a->outcome = good ? "finished" : "failed";
  if (good)
    good = app_check(a, mps_recorder_close(&r.recorder)) && write_summary(a, s, &r, &result);
  mps_recorder_destroy(&r.recorder);
  if (good) {
    app_tell_results(a, s->out);
    printf("%lld particles, %lld time windows, %lld steps, %lld of them repeated; largest "
           "deflection of the tip "
           "%.5g m at %.4g s\n",
           (long long)mps_particles_count(body.particles), (long long)result.windows,
           (long long)result.steps, (long long)result.repeats, r.largest, r.at);
  }
  flap_free(&body);
  return good;
}

int main(int argc, char **argv) {
  settings s;
  app a;
  const int code = parse(&s, argc, argv);
  if (code >= 0) return code;
  if (!app_start(&a, "mps-precice", s.threads)) return app_finish(&a, APP_FAILED);
  return app_finish(&a, run(&a, &s) ? APP_OK : APP_FAILED);
}
