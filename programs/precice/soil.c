/* soil.c - soil under a rigid box whose mass is in another code, as a participant of a preCICE
 * coupling (rigid.h). With --free the box has its mass here and nothing is coupled: what the
 * coupling is compared with. SPDX-License-Identifier: BSD-3-Clause */
#include "common/options.h"
#include "common/output.h"
#include "precice/block.h"
#include "precice/rigid.h"

#include <stdio.h>

typedef struct settings {
  rigid_def coupling;
  bool free;
  double step, duration; /* s: of the soil; of --free */
  int64_t threads;
  const char *out;
} settings;

typedef struct records {
  app *a;
  mps_body *box;
  output table;
  double last[3]; /* m, m, rad: displacement and angle */
} records;

static const char purpose[] =
    "An elastic block of soil under a rigid box as a participant of a preCICE coupling (version "
    "3): another code has\n"
    "the mass of the box, gives the displacements of its corners and receives the forces of the "
    "soil on them.";

static int parse(settings *s, int argc, char **argv) {
  *s = (settings){.coupling = {.config = "soil-config.xml",
                               .name = "Soil",
                               .mesh = "Soil-Mesh",
                               .displacement = "Displacement",
                               .force = "Force",
                               .count = 4,
                               .x = block_corner,
                               .dt = 1.0},
                  .step = 5e-4,
                  .duration = 0.15};
  option table[] = {
      OPTION_HEADING("Soil"),
      OPTION_NUMBER_IN("dt", OPTION_ABOVE_TO(0.0, 1e-3), &s->step,
                       "at most; preCICE may ask for shorter ones"),
      OPTION_FLAG("free", &s->free, NULL),
      OPTION_NUMBER_IN("duration", OPTION_ABOVE_TO(0.0, 10.0), &s->duration, "of --free"),
      OPTION_HEADING("Coupling"),
      LOOP_OPTIONS(s->coupling),
      OPTION_TEXT("displacement", &s->coupling.displacement, "that are read"),
      OPTION_TEXT("force", &s->coupling.force, "that are written"),
      OPTION_HEADING("Running"),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {"precice-soil", purpose, table};
  return options_parse(&program, argc, argv);
}

static bool each(void *user, mps_mpm *soil) {
  records *r = user;
  mps_body_state state;
  if (!app_check(r->a, mps_body_get_state(r->box, &state))) return false;
  r->last[0] = state.position[0] - BLOCK_BOX_X, r->last[1] = state.position[1] - BLOCK_BOX_Y;
  r->last[2] = state.rotation[2];
  const double row[4] = {mps_mpm_time(soil), r->last[0], r->last[1], r->last[2]};
  csv_row(&r->table, 4, row);
  return true;
}

/* The box with its own mass, a row a step. */
static bool fall(app *a, const settings *s, records *r, mps_mpm *soil, int64_t *steps) {
  bool good = true;
  for (*steps = 0; good && mps_mpm_time(soil) < s->duration - 0.5 * s->step; ++*steps)
    good = app_check(a, mps_mpm_step(soil, 1)) && each(r, soil);
  return good;
}

static bool run(app *a, settings *s) {
  block b = {0};
  records r = {.a = a};
  participant_result result = {0};
  bool good = output_directory(a, s->out) && block_make(a, s->step, s->free, &b) &&
              output_open(&r.table, a, s->out, "box.csv");
  if (good) {
    r.box = b.box;
    csv_header(&r.table, "t_s,x_m,y_m,angle_rad");
    s->coupling.each = each, s->coupling.user = &r;
    good = s->free ? fall(a, s, &r, b.soil, &result.steps)
                   : rigid_run(a, b.soil, b.box, &s->coupling, &result);
    good = output_close(&r.table) && good;
  }
  if (good) {
    app_tell_results(a, s->out);
    printf("%lld time windows, %lld steps, %lld of them repeated; the box at the end: %.6g m, "
           "%.6g m, %.6g rad\n",
           (long long)result.windows, (long long)result.steps, (long long)result.repeats, r.last[0],
           r.last[1], r.last[2]);
  }
  block_free(&b);
  return good;
}

int main(int argc, char **argv) {
  settings s;
  app a;
  const int code = parse(&s, argc, argv);
  if (code >= 0) return code;
  if (!app_start(&a, "precice-soil", s.threads)) return app_finish(&a, APP_FAILED);
  return app_finish(&a, run(&a, &s) ? APP_OK : APP_FAILED);
}
