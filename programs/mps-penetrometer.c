/* mps-penetrometer - a cone, a sphere or a mesh pushed into clay, sand or elastic ground, in space
 * and, to compare, by the axisymmetric solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "penetrometer/penetrometer.h"

#include <math.h>

int main(int argc, char **argv) {
  static penetrometer p = {.s = {.scale = 1.0,
                                 .diameter = 0.1,
                                 .angle = 60.0,
                                 .depth = 0.15,
                                 .rate = 0.25,
                                 .soil = "6x6x4",
                                 .cohesion = 10e3,
                                 .phi = 35.0,
                                 .young = 2.8e6,
                                 .poisson = 0.4,
                                 .density = 1800.0,
                                 .alpha = NAN,
                                 .k0 = NAN,
                                 .ir = NAN,
                                 .M = 0.92,
                                 .lambda = 0.205,
                                 .kappa = 0.044,
                                 .e0 = NAN,
                                 .e_max = SAND_E_MAX,
                                 .ocr = 1.0,
                                 .permeability = NAN,
                                 .corner = 0.6,
                                 .flip_time = NAN,
                                 .gravity = NAN,
                                 .h = 0.0125,
                                 .courant = 0.9,
                                 .ppc = 8,
                                 .spline = 1,
                                 .course = MPM_COURSE_DEFAULTS,
                                 .out = "out/penetrometer"}};
  pen_settings *s = &p.s;
  option table[] = {
      OPTION_HEADING("Tip"),
      OPTION_CHOICE("tip", "cone|sphere|stl", &s->tip, "cone: with a shaft as thick"),
      OPTION_TEXT("mesh", "FILE", &s->mesh,
                  "closed STL mesh for --tip stl: lowest point at its origin, z upwards; a quarter "
                  "of it is pushed unless --model whole"),
      OPTION_NUMBER("scale", "m", OPTION_LENGTH, &s->scale, "unit of the mesh"),
      OPTION_NUMBER("diameter", "m", OPTION_LENGTH, &s->diameter,
                    "D of the tip, at least 4 cells of --h; pressures are over pi D^2/4"),
      OPTION_NUMBER("angle", "degrees", OPTION_FROM_TO(20.0, 160.0), &s->angle,
                    "of the cone's apex"),
      COMMON_NUMBER("friction", &s->friction, "of its surface"),
      OPTION_NUMBER(
          "alpha", "1", OPTION_FROM_TO(0.001, 10.0), &s->alpha,
          "shear stress on the tip at most alpha times the cohesion; no bound if not given"),
      MPM_MODEL_CONTACT(&s->contact),
      COMMON_NUMBER("corner", &s->corner, NULL),
      COMMON_NUMBER("depth", &s->depth, "of the lowest point, where the run ends"),
      OPTION_NUMBER(
          "start", "m", OPTION_FROM_TO(0.0, 1e4), &s->start,
          "depth of the lowest point at the start, in a hole that cone and shaft fill; 0: "
          "above the ground"),
      COMMON_NUMBER("rate", &s->rate, NULL),
      OPTION_HEADING("Soil"),
      OPTION_CHOICE("law", "clay|sand|elastic|tresca|mcc", &s->law,
                    "von Mises, Drucker-Prager (inscribed cone), linear elastic, Tresca, modified "
                    "Cam-Clay with water in its pores"),
      OPTION_TEXT("soil", "WxWxD", &s->soil,
                  "width, breadth and depth of the box in diameters, made whole cells"),
      COMMON_NUMBER("cohesion", &s->cohesion, "of clay, tresca; of sand, default 0"),
      COMMON_NUMBER_IN("phi", OPTION_FROM_TO(0.1, 60.0), &s->phi, "of sand"),
      COMMON_NUMBER("psi", &s->psi, "of sand"),
      OPTION_NUMBER("emax", "1", SAND_RANGE, &s->e_max,
                    "void ratio at which dilation of sand ends, from --e0 on"),
      COMMON_NUMBER("young", &s->young, NULL),
      COMMON_NUMBER("poisson", &s->poisson, "of mcc, default 0.25; with --ir else 0.49"),
      OPTION_NUMBER(
          "ir", "1", OPTION_FROM_TO(1.0, 1e5), &s->ir,
          "rigidity index G/su instead of --young; clay, tresca, mcc; su, which N_kt refers to "
          "too, is that of triaxial compression, half the largest q: of clay 0.866 of "
          "the cohesion, of tresca the cohesion"),
      OPTION_NUMBER("M", "1", OPTION_FROM_TO(0.05, 2.9), &s->M, "mcc: critical q/p in compression"),
      OPTION_NUMBER("lambda", "1", OPTION_FROM_TO(1e-4, 5.0), &s->lambda,
                    "mcc: slope of virgin compression in e - ln p"),
      OPTION_NUMBER("kappa", "1", OPTION_FROM_TO(1e-5, 5.0), &s->kappa,
                    "mcc: slope of unloading, below lambda"),
      OPTION_NUMBER("e0", "1", OPTION_FROM_TO(0.01, 20.0), &s->e0,
                    "void ratio at the start; default of mcc 1.4, of sand 0.5"),
      OPTION_NUMBER("ocr", "1", OPTION_FROM_TO(1.0, 1000.0), &s->ocr,
                    "mcc: largest former vertical stress over --surcharge"),
      OPTION_NUMBER("permeability", "m/s", OPTION_ABOVE_TO(0.0, 1e-2), &s->permeability,
                    "mcc: drained by the surface; undrained if not given"),
      COMMON_NUMBER("density", &s->density, NULL),
      COMMON_NUMBER("gravity", &s->gravity, "default 9.81 m/s2 with --law sand, else 0"),
      OPTION_NUMBER(
          "surcharge", "Pa", OPTION_FROM_TO(0.0, 1e9), &s->surcharge,
          "vertical stress at the surface, with --start: the tip waits for the ground to come to "
          "rest; mcc: effective, of all ground"),
      OPTION_NUMBER("k0", "1", OPTION_FROM_TO(0.0, 10.0), &s->k0,
                    "horizontal over vertical stress, default nu/(1 - nu); mcc: by the law"),
      OPTION_CHOICE("sides", "rollers|free", &s->sides,
                    "of the box: they stay, or move with ground that has no stress at rest"),
      OPTION_HEADING("Grid"),
      OPTION_CHOICE("model", "quarter|whole", &s->model,
                    "quarter: rollers on two planes through the axis"),
      COMMON_NUMBER("h", &s->h, NULL),
      COMMON_INTEGER_IN("ppc", OPTION_FROM_TO(1.0, 64.0), &s->ppc,
                        "in space a cube: 1, 8, 27 or 64"),
      COMMON_CHOICE("spline", &s->spline, NULL),
      OPTION_CHOICE("volumetric", "law|point|cell", &s->volumetric,
                    "change of volume: as suits the law, each particle's own, or F-bar by cell"),
      COMMON_NUMBER("courant", &s->courant, "Nakamura (49)"),
      COMMON_NUMBER("flip-time", &s->flip_time,
                    "default diameter/(40 rate) in clay, tresca and sand, else 0"),
      OPTION_HEADING("Run"),
      OPTION_FLAG("axisymmetric", &s->axisymmetric,
                  "then the same by the axisymmetric solver, in a cylinder with the box's section"),
      OPTION_FLAG("no-space", &s->no_space, "with --axisymmetric: nothing but that"),
      MPM_COURSE_OPTIONS(&s->course, 200),
      OPTION_OUT(&s->out),
      OPTION_THREADS(&s->threads),
      {0}};
  const options_program program = {
      "mps-penetrometer",
      "A rigid cone, sphere or mesh pushed into soil (WLS-MPM in space; von Mises, Tresca,\n"
      "Drucker-Prager, Cam-Clay or elastic): its resistance by tip and shaft along the path,\n"
      "and the soil in section.",
      table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  const char *reason = pen_check(&p, table);
  if (reason) return options_refuse(&program, reason);
  static const mpm_model_parts parts = {pen_build, pen_push, pen_finish};
  const mpm_model_places places = {&s->out, &s->course.checkpoint, s->course.restart};
  const int result = mpm_model_run(&program, s->threads, &places, &p.run[0].m, &parts, &p);
  pen_free(&p);
  return result;
}
