/* mps-consolidation - water in the pores of ground against exact solutions: a layer, or several,
 * that consolidates under a load or steps of an oedometer (Terzaghi; with large strains Xie and
 * Leo), Mandel's plate, Cryer's sphere, Barron's vertical drain, and the undrained ground under a
 * strip load. SPDX-License-Identifier: BSD-3-Clause */
#include "consolidation/consolidation.h"

#include <math.h>

int main(int argc, char **argv) {
  static simulation sim;
  settings *s = &sim.s;
  option table[] = {
      OPTION_HEADING("Ground and water"),
      OPTION_CHOICE_OF("case", "terzaghi|large|mcc|mandel|cryer|strip|barron", &s->kase,
                       "layer of height H = 1 m: small or large strains, or Cam-Clay; block of "
                       "half width a = 1 m between plates; sphere of radius a = 1 m; half space "
                       "under a strip of half width B = 1 m, undrained; cylinder of radius a = 1 m "
                       "that a vertical drain in its axis consolidates under a rigid plate"),
      OPTION_NUMBER("drain-ratio", &s->ratio, NULL, 5.0),
      OPTION_NUMBER_IN("poisson", OPTION_FROM_TO(0.0, 0.45), &s->nu, "of the grains' frame", 0.2),
      OPTION_NUMBER("young", &s->young, "of the grains' frame", 1e6),
      OPTION_NUMBER("M", &s->M, NULL, 0.92),
      OPTION_NUMBER_IN("lambda", OPTION_FROM_TO(1e-3, 1.0), &s->lambda, NULL, 0.205),
      OPTION_NUMBER_IN("kappa", OPTION_FROM_TO(1e-4, 1.0), &s->kappa, NULL, 0.044),
      OPTION_NUMBER_IN("e0", OPTION_FROM_TO(0.1, 10.0), &s->e0, "mcc", 1.4),
      OPTION_NUMBER("initial", &s->initial, NULL, 100e3),
      OPTION_NUMBER(
          "load", &s->load,
          "u0, default 0.001 of M' = E (1 - nu)/((1 + nu)(1 - 2 nu)); large 0.5; mcc initial", NAN),
      OPTION_CHOICE_OF("drainage", "top|bottom|both", &s->drained, NULL),
      OPTION_TEXT("layers", &s->layers,
                  "thickness_m, permeability_m_s, modulus_Pa (M'); terzaghi: the model is 1 m "
                  "high, times and settlements are printed of the layers as they are"),
      OPTION_NUMBER("load-ramp", &s->ramp, NULL),
      OPTION_TEXT("loads", &s->loads, NULL),
      OPTION_NUMBER("water-stiffness", &s->stiffness, NULL, 100.0),
      OPTION_TEXT("times", &s->times, NULL),
      OPTION_NUMBER(
          "time-unit", &s->duration,
          "default 300 times that of a wave through H, mandel and barron 1000, large with "
          "--load-ramp 2000, and longer where the permeability would else be above 1 mm/s",
          NAN),
      OPTION_HEADING("Grid"),
      OPTION_NUMBER_IN(
          "cell", OPTION_FROM_TO(1.0 / MOST_CELLS, 0.5), &s->cell,
          "a whole number of which is in H, a or B = 1 m; default 0.05, mandel 0.1, strip 0.25",
          NAN),
      OPTION_NUMBER("courant", &s->courant, "default 0.7, of --scheme implicit 0.5", NAN),
      OPTION_CHOICE_OF("scheme", "explicit|implicit", &s->scheme, NULL),
      OPTION_CHOICE("solver", &s->solver, "of implicit pressures"),
      OPTION_NUMBER("mass-damping", &s->damping, "default half a wave velocity over H; strip none",
                    NAN),
      OPTION_HEADING("Run"),
      MPM_COURSE_OPTIONS(&s->course, MOST_TIMES),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {"mps-consolidation",
                                   "Saturated elastic ground by WLS-MPM with the pressures of "
                                   "cells (u-p), against exact solutions:\n"
                                   "profiles of the pore pressure, settlement, water drained.",
                                   table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  const char *reason = consolidation_settle(&sim, table);
  if (reason) return options_refuse(&program, reason);
  static const mpm_model_parts parts = {consolidation_build, consolidation_march,
                                        consolidation_finish};
  const mpm_model_places places = {&s->out, &s->course.checkpoint, s->course.restart};
  return mpm_model_run(&program, s->threads, &places, &sim.m, &parts, &sim);
}
