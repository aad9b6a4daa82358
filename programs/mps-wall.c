/* mps-wall - earth pressure on a retaining wall that moves: active where it leaves the ground,
 * passive where it is pushed into it, smooth or rough, of layers and below a water table. WLS-MPM,
 * Mohr-Coulomb, plane strain. SPDX-License-Identifier: BSD-3-Clause */
#include "wall/wall.h"

#include <math.h>

/* A wall moves at 0.02 m/s, and one below 1 m at as many (g H)^1/2: else the ground behind a wall
 * of some centimetres would follow it hardly slower than in free fall. */
#define RATE 0.02    /* m/s */
#define SLOW 0.00639 /* of (g H)^1/2 */

/* What depends on other options, and what they exclude. NULL: good. */
static const char *settle(settings *s, const option *table) {
  const double sine = sin(s->phi * 3.14159265358979323846 / 180.0);
  const bool active = s->pressure == ACTIVE;
  if (isnan(s->length)) s->length = (active ? 2.5 : 5.0) * s->height;
  s->k0_given = !isnan(s->k0);
  if (isnan(s->k0)) s->k0 = 1.0 - sine; /* Jaky */
  if (isnan(s->path))                   /* behind a toe that stays the ground yields last */
    s->path = (active ? 0.01 : 0.02) * (s->motion == TURNS_ABOUT_TOE ? 3.0 : 1.0) * s->height;
  if (isnan(s->h)) s->h = s->height / 16.0;
  if (isnan(s->sheet)) /* turning about its toe, the part below would push the ground back */
    s->sheet = active && s->motion != TURNS_ABOUT_TOE && s->base >= 4.0 * s->h * (1.0 - 1e-9)
                   ? 2.0 * s->h
                   : 0.0;
  if (!options_given(table, "length")) s->length = s->h * ceil(s->length / s->h - 1e-9);
  options_whole("length", &s->length, "--cell", s->h);
  if (s->sheet > 0.0) options_whole("sheet", &s->sheet, "--cell", s->h);
  s->front = s->h * ceil(s->height / s->h - 1e-9);
  if (s->phi == 0.0 && s->cohesion == 0.0) return "--phi and --cohesion must not both be 0";
  if (s->psi > s->phi) return "--psi must be at most --phi";
  if (sand_check(&s->voids)) return sand_check(&s->voids);
  if (s->height < 5.0 * s->h * (1.0 - 1e-9)) return "--height must be at least 5 cells of --cell";
  if (s->base > 0.0 && s->base < 2.0 * s->h * (1.0 - 1e-9))
    return "--below-toe must be 0 or at least 2 cells of --cell";
  if (s->sheet > 0.0 && s->base < s->sheet + 2.0 * s->h * (1.0 - 1e-9))
    return "--below-toe must be at least 2 cells of --cell more than --sheet";
  if (s->length < s->height) return "--length must be at least --height";
  if (s->path > 0.2 * s->height) return "--travel must be at most a fifth of --height";
  const char *edges = mpm_model_settle_edges(table, MPS_CONTACT_METHOD_IMPULSE, active ? 0.0 : 0.9,
                                             &s->corner, &s->inset);
  if (edges) return edges;
  if (isnan(s->rate)) s->rate = fmin(RATE, SLOW * sqrt(s->gravity * s->height));
  const char *why = wall_settle_ground(s, table);
  if (why) return why;
  if (s->heaviest * s->gravity * (s->height + s->base) + s->surcharge > 0.1 * s->young)
    return "--young must be at least 10 times the stress at the toe, density g height + surcharge";
  const double ground = s->length * (s->height + s->base) + s->front * s->base;
  return mpm_model_too_large(ground / (s->h * s->h) * (double)s->ppc);
}

int main(int argc, char **argv) {
  static simulation sim;
  settings *s = &sim.s;
  option table[] = {
      OPTION_HEADING("Wall"),
      OPTION_CHOICE_OF("pressure", "active|passive", &s->pressure, NULL),
      OPTION_CHOICE_OF("motion", "translate|toe|top", &s->motion, NULL),
      OPTION_NUMBER("height", &s->height, "of the ground behind the wall", 1.0),
      OPTION_NUMBER("friction", &s->friction, "of its face"),
      OPTION_NUMBER("travel", &s->path, NULL, NAN),
      OPTION_NUMBER("rate", &s->rate,
                    "of that end; default 0.02 m/s, of low walls 0.00639 (g H)^1/2", NAN),
      OPTION_NUMBER("corner", &s->corner, "of its toe; with --inset 0", 0.6),
      OPTION_NUMBER("inset", &s->inset, "default passive 0.9, active 0", NAN),
      OPTION_HEADING("Ground (Mohr-Coulomb)"),
      OPTION_NUMBER("below-toe", &s->base, "and in front of it; 0: a smooth bed"),
      OPTION_NUMBER("sheet", &s->sheet, NULL, NAN),
      OPTION_NUMBER("surcharge", &s->surcharge, "behind the wall"),
      OPTION_NUMBER("water-table", &s->water, NULL, NAN),
      OPTION_TEXT("layers", &s->layers_file,
                  "thickness_m, phi_degrees, psi_degrees, cohesion_Pa, density_kg_m3: behind the "
                  "wall, in place of the following; the last one continues downwards"),
      OPTION_NUMBER("length", &s->length,
                    "of the ground behind the wall; default 2.5 heights, passive 5", NAN),
      OPTION_NUMBER_IN("phi", OPTION_FROM_TO(0.0, 50.0), &s->phi, NULL, 30.0),
      OPTION_NUMBER_IN("psi", OPTION_FROM_TO(0.0, 50.0), &s->psi, "at most phi"),
      SAND_OPTIONS(&s->voids),
      OPTION_NUMBER("cohesion", &s->cohesion, NULL),
      OPTION_NUMBER("k0", &s->k0, "default 1 - sin(phi)", NAN),
      OPTION_NUMBER("young", &s->young, NULL, 5e7),
      OPTION_NUMBER("poisson", &s->poisson, NULL, 0.3),
      OPTION_NUMBER("density", &s->density, NULL, 1800.0),
      OPTION_NUMBER_IN("gravity", OPTION_FROM_TO(1e-3, 1e4), &s->gravity, NULL, 9.81),
      OPTION_HEADING("Grid"),
      MPM_MODEL_GRID(s, NAN, 4, 0.5, "default height/16"),
      OPTION_NUMBER("flip-time", &s->flip_time, NULL),
      OPTION_HEADING("Run"),
      MPM_COURSE_OPTIONS(&s->course, WALL_SAMPLES),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {
      "mps-wall",
      "Active and passive earth pressure on a wall that moves (WLS-MPM, Mohr-Coulomb), against\n"
      "Rankine and Coulomb.",
      table};
  int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  const char *reason = settle(s, table);
  if (reason) return options_refuse(&program, reason);
  static const mpm_model_parts parts = {wall_build, wall_march, wall_finish};
  const mpm_model_places places = {&s->out, &s->course.checkpoint, s->course.restart};
  code = mpm_model_run(&program, s->threads, &places, &sim.m, &parts, &sim);
  mpm_snapshot_free(&sim.shot);
  return code;
}
