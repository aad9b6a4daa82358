/* mps-seawall - waves of a piston against an elastic wall: Chikazawa, section 4, Figures 9 to 13.
 * The water is mps_fluid, the wall mps_elastic; the wall is loaded with the pressures of the water.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "seawall/seawall.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *check(seawall_settings *s) {
  if (s->coupled && s->method == 1) return "--method classical has no coupling";
  options_whole("length", &s->length, "--spacing", s->spacing);
  options_whole("depth", &s->depth, "--spacing", s->spacing);
  options_whole("wall-thickness", &s->wall_thickness, "--spacing", s->spacing);
  options_whole("wall-height", &s->wall_height, "--spacing", s->spacing);
  if (s->depth < 5.0 * s->spacing * (1.0 - 1e-9))
    return "--depth must be at least 5 times --spacing";
  if (s->length < 10.0 * s->spacing) return "--length must be at least 10 times --spacing";
  if (s->wall_thickness < 2.0 * s->spacing * (1.0 - 1e-9) || s->wall_height < s->depth)
    return "--wall-thickness must be at least 2 times --spacing, --wall-height at least --depth";
  if (s->length * s->depth / (s->spacing * s->spacing) > 2e6 ||
      s->wall_thickness * s->wall_height / (s->spacing * s->spacing) > 2e6)
    return "--spacing gives more than 2 million particles";
  if (4.0 * fabs(s->amplitude) > s->length)
    return "--amplitude must be at most a quarter of --length";
  if (s->sample > s->duration || s->duration / s->sample > 1e6)
    return "--sample must be between a millionth of --duration and all of it";
  return NULL;
}

static mps_status prepare(app *a, seawall *w) {
  mps_status status = MPS_OK;
  if (w->s.restart) status = seawall_peek(a->context, w);
  if (status == MPS_OK) status = app_settle(a, seawall_build(a, w));
  if (status == MPS_OK && w->s.restart) status = seawall_restore(a->context, w);
  if (status == MPS_OK) resume_schedule_at(&w->saves, mps_fluid_time(w->fluid));
  status = app_settle(a, status);
  if (status == MPS_OK && w->s.frames > 0 && !w->s.coupled)
    status = mps_elastic_solve(w->wall.solver); /* so that its fields are there */
  return app_settle(a, status);
}

static int run(app *a, seawall *w) {
  if (!app_agree(a, resume_places(a, w->s.restart, &w->s.checkpoint, &w->s.out) &&
                        (a->rank > 0 || output_directory(a, w->s.out))))
    return APP_FAILED;
  w->a = a;
  w->saves = (resume_schedule){
      .path = w->s.checkpoint, .every = w->s.every_checkpoint, .save = seawall_save, .user = w};
  if (!app_agree(
          a, waves_check(a, w->s.period, w->s.depth, w->s.amplitude, w->s.spacing, w->s.length)))
    return APP_FAILED;
  if (!app_agree(a, a->rank > 0 || summary_reserve(a, w->s.out))) return APP_FAILED;
  app_leave_at_once(a, !a->domain); /* no hook reaches into building */
  mps_status status = prepare(a, w);
  app_leave_at_once(a, false);
  if (status != MPS_OK && w->why[0]) return app_error(a, "%s", w->why), APP_FAILED;
  if (status != MPS_OK) return app_end_run(a, status, 0.0, false);
  printf("%lld particles as the paper counts: %lld of water, %lld of the wall above the bed\n",
         (long long)seawall_paper_particles(&w->s), (long long)mps_particles_count(w->water),
         (long long)mps_particles_count(w->wall.set));
  fflush(stdout);
  status = app_settle(a, seawall_run(a, w));
  const int code = app_end_run(a, status, mps_fluid_time(w->fluid), w->samples > 0);
  if (status == MPS_ERROR_CANCELLED) resume_tell(&w->saves);
  if (w->samples == 0)
    return code == APP_INTERRUPTED && a->rank == 0 && !summary_bare(a, w->s.out) ? APP_FAILED
                                                                                 : code;
  if (!app_agree(a, a->rank > 0 || seawall_write(a, w))) return APP_FAILED;
  return w->saves.lost && code == APP_OK ? APP_FAILED : code;
}

int main(int argc, char **argv) {
  static seawall w = {.s = {.every_checkpoint = 1.0}};
  seawall_settings *s = &w.s;
  option table[] = {
      OPTION_HEADING("Method"),
      OPTION_FLAG("paper", &s->paper, NULL),
      OPTION_CHOICE_OF("method", "modern|classical", &s->method,
                       "of the water: the library's, or the first scheme of MPS, whose pressure is "
                       "noisy and which takes energy from the waves; it wants --disturb 0"),
      OPTION_NUMBER("share", &s->share, NULL, 0.2),
      OPTION_CHOICE_OF("wall-method", "conservative|published", &s->wall_method, NULL),
      OPTION_HEADING("Tank"),
      OPTION_NUMBER("length", &s->length, "from the piston to the wall", 1.6),
      OPTION_NUMBER("depth", &s->depth, "of the water", 0.3),
      OPTION_NUMBER("spacing", &s->spacing, "of water and wall", 0.01),
      OPTION_NUMBER("disturb", &s->disturb,
                    "a perfect lattice keeps its columns when it is stretched, and collides", 0.1),
      OPTION_INTEGER("seed", &s->seed,
                     "another disturbance each: behind a breaking wave the force differs", 1),
      OPTION_HEADING("Wave maker: amplitude sin(2 pi t/period)"),
      OPTION_NUMBER("amplitude", &s->amplitude, "of the piston", 0.01),
      OPTION_NUMBER("period", &s->period, NULL, 1.0),
      OPTION_NUMBER("ramp", &s->ramp, NULL),
      OPTION_HEADING("Wall: plane strain, held in the layer of particles at the bed"),
      OPTION_NUMBER("wall-thickness", &s->wall_thickness, NULL, 0.1),
      OPTION_NUMBER("wall-height", &s->wall_height, NULL, 0.43),
      OPTION_NUMBER_IN("young", OPTION_FROM_TO(1e3, 1e16), &s->young, NULL, 2.1e11),
      OPTION_NUMBER("poisson", &s->poisson, NULL, 0.3),
      OPTION_NUMBER("wall-density", &s->wall_density, NULL, 7850.0),
      OPTION_FLAG("coupled", &s->coupled, NULL),
      OPTION_HEADING("Run"),
      OPTION_NUMBER("duration", &s->duration, NULL, 5.5),
      OPTION_NUMBER("dt", &s->dt, NULL, 1e-3),
      WAVES_SOLVER(&s->solver, &s->tolerance),
      OPTION_NUMBER("sample", &s->sample, "then the wall is solved too", 0.01),
      OPTION_INTEGER_IN("frames", OPTION_FROM_TO(0.0, 10000.0), &s->frames, "and of the animation",
                        55),
      RESUME_OPTIONS(&s->checkpoint, &s->every_checkpoint, NULL, &s->restart),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {
      "mps-seawall",
      "Waves of a piston against an elastic wall (MPS fluid, implicit elasticity): Chikazawa, "
      "Figures 9\n"
      "to 13. The paper gives the piston, the step, E, nu and 5878 particles; length, depth and "
      "spacing\n"
      "of its tank, the height and thickness of the wall and how it is held are open. The defaults "
      "are a\n"
      "reading that gives its number: 160 x 30 of water, 3 layers under it, and, 43 above the bed "
      "and 3\n"
      "below, 3 columns of the piston and 10 of the wall. Here the piston and the bed need no "
      "particles.\n"
      "The paper's piston moves by 50 mm. Its waves break in water that keeps its energy "
      "(--amplitude 50mm\n"
      "--dt 0.5ms); those of the default stand, and the force is that of linear potential flow.",
      table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  static const option_preset paper[] = {{"method", "classical"},
                                        {"wall-method", "published"},
                                        {"disturb", "0"},
                                        {"amplitude", "50mm"},
                                        {0}};
  const int settled = s->paper ? options_prefer(&program, paper) : -1;
  if (settled >= 0) return settled;
  if (options_given(table, "share") && s->method == 0)
    return options_refuse(&program, "--share is for --method classical");
  const char *reason = check(s);
  if (reason) return options_refuse(&program, reason);
  app a;
  w.table = table;
  if (!app_start(&a, program.name, s->threads)) return app_finish(&a, APP_FAILED);
  const int result = run(&a, &w);
  if (result == APP_FAILED) app_agree(&a, false); /* all ranks know */
  seawall_free(&w);
  return app_finish(&a, result);
}
