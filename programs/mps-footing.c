/* mps-footing - a footing pressed into the ground: Nakamura 7.3, Figures 15 to 21. Cohesive ground
 * without weight (von Mises) against Prandtl's bearing capacity (52), q = (2 + pi) c, or under a
 * circle (Tresca) 5.69 c and 6.05 c; ground with friction and weight (Drucker-Prager) against the
 * method of characteristics.
 *
 * Half of it is computed: x = 0 is the line of symmetry. Under an eccentric load all of it is.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "footing/footing.h"

#include <math.h>
#include <stdlib.h>

int main(int argc, char **argv) {
  static simulation sim;
  settings *s = &sim.s;
  option table[] = {
      OPTION_HEADING("Ground"),
      OPTION_FLAG("paper", &s->paper, NULL),
      OPTION_CHOICE_OF("law", "vonmises|druckerprager", &s->model,
                       "under a circle Tresca's in place of von Mises'"),
      OPTION_TEXT_OF("soil", "WxH", &s->domain,
                     "half the width, and the depth; default by --half-width and --phi"),
      OPTION_NUMBER_IN("cohesion", OPTION_FROM_TO(0.0, 1e11), &s->cohesion, "von Mises: undrained",
                       10e3),
      OPTION_NUMBER("strength-gradient", &s->gradient, "--cohesion at the surface; von Mises"),
      OPTION_NUMBER_IN("phi", OPTION_FROM_TO(0.1, 50.0), &s->phi, "Drucker-Prager", 30.0),
      OPTION_NUMBER_IN("psi", OPTION_FROM_TO(0.0, 50.0), &s->psi,
                       "at most phi; default phi; Drucker-Prager", NAN),
      SAND_OPTIONS(&s->voids),
      OPTION_CHOICE("cone", &s->cone, "of --law druckerprager"),
      OPTION_NUMBER("top", &s->top, NULL),
      OPTION_NUMBER("top-cohesion", &s->top_cohesion, NULL),
      OPTION_NUMBER("surcharge", &s->surcharge, "beside the footing; Drucker-Prager"),
      OPTION_NUMBER("young", &s->young, NULL, 1e9),
      OPTION_NUMBER_IN("poisson", OPTION_FROM_TO(0.0, 0.499), &s->poisson, NULL, 0.3),
      OPTION_NUMBER("density", &s->density, NULL, 1000.0),
      OPTION_NUMBER("gravity", &s->gravity, "default 0, Drucker-Prager 9.81 m/s2", NAN),
      OPTION_HEADING("Footing"),
      OPTION_CHOICE_OF("shape", "strip|circle", &s->shape, NULL),
      OPTION_NUMBER("half-width", &s->half_width, NULL, 0.5),
      OPTION_NUMBER("eccentricity", &s->eccentricity, NULL),
      OPTION_NUMBER("friction", &s->mu, "of its base"),
      OPTION_NUMBER("corner", &s->corner, "with --inset 0", 0.6),
      OPTION_NUMBER("inset", &s->inset,
                    "default 0.6, --volumetric point 0.9, Drucker-Prager 0.75, with --surcharge "
                    "0.65, on weight alone 1 (from 40 degrees on 0.95), rough 0.4; eccentric load "
                    "0",
                    NAN),
      OPTION_NUMBER_IN("rate", OPTION_FROM_TO(1e-6, 0.1), &s->rate,
                       "default 2 mm/s, by strength, modulus and density", NAN),
      OPTION_NUMBER("settlement", &s->settlement, NULL, NAN),
      MPM_MODEL_CONTACT(&s->contact),
      OPTION_NUMBER("k", &s->k, NULL, 2e9),
      OPTION_HEADING("Grid"),
      MPM_MODEL_GRID(s, 0.1, 4, 0.9, NULL),
      OPTION_CHOICE("volumetric", &s->volumetric, "for ground that hardly changes its volume"),
      MPM_METHOD_OPTIONS(&s->method),
      OPTION_NUMBER("flip-time", &s->flip_time,
                    "and while the ground comes to rest; default: by the cell and the wave speed",
                    NAN),
      OPTION_HEADING("Run"),
      OPTION_NUMBER("section", &s->section, NULL, NAN),
      MPM_COURSE_OPTIONS(&s->course, FOOTING_SAMPLES),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {
      "mps-footing",
      "A strip or circular footing on cohesive ground without weight (WLS-MPM, von Mises or\n"
      "Tresca), or a strip on ground with friction and weight (Drucker-Prager): Nakamura, Figures\n"
      "15 to 21. Its bearing capacity is compared with the exact one.",
      table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  static const option_preset paper[] = {{"contact", "penalty"},
                                        {"k", "2GN/m"},
                                        {"volumetric", "point"},
                                        {"rate", "0.5mm/s"},
                                        {"courant", "0.5"},
                                        {"soil", "5x5"},
                                        {0}};
  const int settled = mpm_method_settle(&program, &s->method, s->paper, paper, s->flip_time);
  if (settled >= 0) return settled;
  const char *reason = footing_settle(s, table);
  if (reason) return options_refuse(&program, reason);
  const char *refused = mpm_model_refuse_stiffness(table, s->contact);
  if (refused) return options_refuse(&program, refused);
  static const mpm_model_parts parts = {footing_build, footing_march, footing_finish};
  const mpm_model_places places = {&s->out, &s->course.checkpoint, s->course.restart};
  const int ended = mpm_model_run(&program, s->threads, &places, &sim.m, &parts, &sim);
  free(sim.profile);
  return ended;
}
