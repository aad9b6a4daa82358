/* mps-consolidation - water in the pores of ground against exact solutions: a layer, or several,
 * that consolidates under a load or steps of an oedometer (Terzaghi; with large strains Xie and
 * Leo), Mandel's plate, Cryer's sphere, Barron's vertical drain, and the undrained ground under a
 * strip load. SPDX-License-Identifier: BSD-3-Clause */
#include "consolidation/consolidation.h"

#include <math.h>

int main(int argc, char **argv) {
  static simulation sim = {.s = {.nu = 0.2,
                                 .young = 1e6,
                                 .M = 0.92,
                                 .lambda = 0.205,
                                 .kappa = 0.044,
                                 .e0 = 1.4,
                                 .initial = 100e3,
                                 .ratio = 5.0,
                                 .cells = NAN,
                                 .load = NAN,
                                 .duration = NAN,
                                 .damping = NAN,
                                 .stiffness = 100.0,
                                 .course = MPM_COURSE_DEFAULTS,
                                 .out = "out/consolidation"}};
  settings *s = &sim.s;
  option table[] = {
      OPTION_HEADING("Ground and water"),
      OPTION_CHOICE(
          "case", "terzaghi|large|mcc|mandel|cryer|strip|barron", &s->kase,
          "layer of height H = 1 m: small or large strains, or Cam-Clay; block of half "
          "width a = 1 m "
          "between plates; sphere of radius a = 1 m; half space under a strip of half "
          "width B = 1 m, undrained; cylinder of radius a = 1 m that a vertical drain in its "
          "axis consolidates under a rigid plate"),
      OPTION_NUMBER("ratio", "1", OPTION_FROM_TO(2.0, 64.0), &s->ratio,
                    "barron: n, radius of the cylinder over that of the drain"),
      OPTION_NUMBER("nu", "1", OPTION_FROM_TO(0.0, 0.45), &s->nu,
                    "Poisson's ratio of the grains' frame"),
      COMMON_NUMBER("young", &s->young, "of the grains' frame"),
      OPTION_NUMBER("M", "1", OPTION_FROM_TO(0.05, 2.9), &s->M,
                    "mcc: slope of the critical state line, q/p"),
      OPTION_NUMBER("lambda", "1", OPTION_FROM_TO(1e-3, 1.0), &s->lambda,
                    "mcc: slope of virgin compression in 1 + e over ln p"),
      OPTION_NUMBER("kappa", "1", OPTION_FROM_TO(1e-4, 1.0), &s->kappa, "mcc: slope of unloading"),
      OPTION_NUMBER("e0", "1", OPTION_FROM_TO(0.1, 10.0), &s->e0,
                    "mcc: void ratio before the load"),
      OPTION_NUMBER("initial", "Pa", OPTION_FROM_TO(100.0, 1e9), &s->initial,
                    "mcc: vertical effective stress before the load, the largest so far"),
      OPTION_NUMBER(
          "load", "Pa", OPTION_ABOVE_TO(0.0, 1e12), &s->load,
          "u0, default 0.001 of M' = E (1 - nu)/((1 + nu)(1 - 2 nu)); large 0.5; mcc initial"),
      OPTION_CHOICE("drained", "top|bottom|both", &s->drained,
                    "sides of a layer that drain; T counts its whole height in any case"),
      OPTION_TEXT("layers", "FILE", &s->layers,
                  "terzaghi: layers from the top; a header names, in any order and unit, "
                  "thickness_m, permeability_m_s, modulus_Pa (M'); the model is 1 m high, times "
                  "and settlements are printed of the layers as "
                  "they are"),
      OPTION_NUMBER("ramp", "T", OPTION_FROM_TO(0.0, 10.0), &s->ramp,
                    "in which the load on a layer grows evenly; 0: at once"),
      OPTION_TEXT("loads", "Pa,...", &s->loads,
                  "of a layer, ascending, in place of --load: steps of an oedometer, each of which "
                  "lasts as long as the last of --times, which then count from its beginning"),
      OPTION_NUMBER("stiffness", "1", OPTION_FROM_TO(5.0, 1e4), &s->stiffness,
                    "of the water, (K_w/n)/M', of --layers the stiffest M'"),
      OPTION_TEXT("times", "T,...", &s->times,
                  "T = c_v t/H^2, ascending, of the profiles; default 0.05,0.1,0.2,0.5,1, cryer "
                  "0.01,0.05,0.1,0.2"),
      OPTION_NUMBER("duration", "s", OPTION_DURATION, &s->duration,
                    "that T = 1 lasts, which gives the permeability; default 300 times that of a "
                    "wave through H, mandel and barron 1000, large with --ramp 2000, and longer "
                    "where the permeability would else be above 1 mm/s"),
      OPTION_HEADING("Grid"),
      OPTION_NUMBER("cells", "1", OPTION_FROM_TO(2.0, MOST_CELLS), &s->cells,
                    "along H, a or B, a whole number; default 20, mandel 10, strip 4"),
      OPTION_CHOICE("scheme", "explicit|implicit", &s->scheme,
                    "pressures in time: explicit, or by the solution of a system in each step, "
                    "which may then be longer; strip settles, where both are the same; default "
                    "implicit with --layers"),
      OPTION_CHOICE("solver", "own|multigrid|direct", &s->solver,
                    "of implicit pressures: the library's, the same bit for bit on all numbers of "
                    "ranks, or to compare PETSc's algebraic multigrid or its direct solver, which "
                    "agree within the tolerance"),
      OPTION_NUMBER("mass-damping", "1/s", OPTION_FROM_TO(0.0, 1e6), &s->damping,
                    "viscous; default half a wave velocity over H; strip none"),
      OPTION_HEADING("Run"),
      MPM_COURSE_OPTIONS(&s->course, MOST_TIMES),
      OPTION_OUT(&s->out),
      OPTION_THREADS(&s->threads),
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
