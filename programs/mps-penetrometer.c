/* mps-penetrometer - a cone, a sphere or a mesh pushed into clay, sand or elastic ground,
 * about an axis or in space.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "penetrometer/penetrometer.h"

#include <math.h>

int main(int argc, char **argv) {
  static penetrometer p;
  pen_settings *s = &p.s;
  option table[] = {
      OPTION_HEADING("Tip"),
      OPTION_CHOICE_OF("tip", "cone|sphere|stl", &s->tip, NULL),
      OPTION_TEXT("mesh", &s->mesh, NULL),
      OPTION_NUMBER("scale", &s->scale, NULL, 1.0),
      OPTION_NUMBER("diameter", &s->diameter, NULL, 0.1),
      OPTION_NUMBER("apex-angle", &s->angle, NULL, 60.0),
      OPTION_NUMBER("friction", &s->friction, "of its surface"),
      OPTION_NUMBER("adhesion", &s->alpha, "no bound if not given", NAN),
      MPM_MODEL_CONTACT(&s->contact),
      OPTION_NUMBER("corner", &s->corner, "with --inset 0", 0.6),
      OPTION_NUMBER("inset", &s->inset, "--symmetry axial; default 0.75, elastic 0", NAN),
      OPTION_NUMBER("depth", &s->depth,
                    "of the lowest point, where the run ends; default 1.5 diameters; "
                    "a cone in clay, without --start and --soil too, from 4 to 5.7",
                    NAN),
      OPTION_NUMBER("start", &s->start, NULL),
      OPTION_NUMBER(
          "rate", &s->rate,
          "default 0.25 m/s, in soft clay 0.0114 of the velocity of shear waves, in sand at "
          "most 0.253 (g D)^1/2",
          NAN),
      OPTION_HEADING("Soil"),
      OPTION_CHOICE_OF("law", "clay|sand|elastic|tresca|mcc", &s->law,
                       "von Mises, Drucker-Prager (inscribed cone), linear elastic, Tresca, "
                       "modified Cam-Clay with water in its pores"),
      OPTION_TEXT_OF("soil", "WxWxH", &s->soil,
                     "width, breadth and depth; default 6x6x4 diameters, of the deep cone 12x12x9"),
      OPTION_NUMBER("cohesion", &s->cohesion, "of clay, tresca; of sand, default 0", 10e3),
      OPTION_NUMBER_IN("phi", OPTION_FROM_TO(0.1, 60.0), &s->phi, "of sand", 35.0),
      OPTION_NUMBER("psi", &s->psi, "of sand"),
      OPTION_NUMBER("emax", &s->e_max, "of sand", SAND_E_MAX),
      OPTION_NUMBER("young", &s->young, NULL, 2.8e6),
      OPTION_NUMBER("poisson", &s->poisson, "of mcc, default 0.25; with --ir else 0.49", 0.4),
      OPTION_NUMBER("ir", &s->ir, "default 100 of the deep cone", NAN),
      OPTION_NUMBER("M", &s->M, NULL, 0.92),
      OPTION_NUMBER("lambda", &s->lambda, NULL, 0.205),
      OPTION_NUMBER("kappa", &s->kappa, NULL, 0.044),
      OPTION_NUMBER("e0", &s->e0, "default of mcc 1.4, of sand 0.5", NAN),
      OPTION_NUMBER("ocr", &s->ocr, "vertical stress, over --surcharge", 1.0),
      OPTION_NUMBER_IN("permeability", OPTION_ABOVE_TO(0.0, 1e-2), &s->permeability,
                       "mcc: drained by the surface; undrained if not given", NAN),
      OPTION_NUMBER("density", &s->density, NULL, 1800.0),
      OPTION_NUMBER("gravity", &s->gravity, "default 9.81 m/s2 with --law sand, else 0", NAN),
      OPTION_NUMBER("surcharge", &s->surcharge,
                    "with --start: the tip waits for the ground to come to rest; mcc: effective, "
                    "of all ground"),
      OPTION_NUMBER("k0", &s->k0, "default nu/(1 - nu); mcc: by the law", NAN),
      OPTION_CHOICE_OF("sides", "roller|free", &s->sides,
                       "they stay, or move with ground that has no stress at rest"),
      OPTION_HEADING("Grid"),
      OPTION_CHOICE_OF("symmetry", "axial|quarter|whole", &s->model,
                       "axial: a cylinder with the section of --soil; --tip stl and "
                       "--also-axisymmetric ask for space"),
      OPTION_NUMBER("cell", &s->h, NULL, 0.0125),
      OPTION_INTEGER_IN("ppc", OPTION_FROM_TO(1.0, 64.0), &s->ppc,
                        "in space a cube: 1, 8, 27 or 64", 8),
      OPTION_CHOICE("spline", &s->spline, NULL, 1),
      OPTION_CHOICE_OF("volumetric", "law|point|cell", &s->volumetric, NULL),
      OPTION_NUMBER("courant", &s->courant, "Nakamura (49)", 0.9),
      OPTION_NUMBER("flip-time", &s->flip_time,
                    "default diameter/(40 rate), of mcc diameter/(160 rate), elastic 0", NAN),
      OPTION_HEADING("Run"),
      OPTION_FLAG("also-axisymmetric", &s->both, NULL),
      MPM_COURSE_OPTIONS(&s->course, 200),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {
      "mps-penetrometer",
      "A rigid cone, sphere or mesh pushed into soil (WLS-MPM about an axis or in space; Tresca, "
      "von Mises,\n"
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
