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
                                 .speed = 0.25,
                                 .soil = "6x6x4",
                                 .cohesion = 10.0,
                                 .phi = 35.0,
                                 .young = 2800.0,
                                 .poisson = 0.4,
                                 .density = 1800.0,
                                 .alpha = NAN,
                                 .corner = 0.6,
                                 .gravity = NAN,
                                 .h = 0.0125,
                                 .courant = 0.9,
                                 .ppc = 8,
                                 .spline = 1,
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
      OPTION_NUMBER("friction", "1", OPTION_FROM_TO(0.0, 10.0), &s->friction, "mu of its surface"),
      OPTION_NUMBER(
          "alpha", "1", OPTION_FROM_TO(0.001, 10.0), &s->alpha,
          "shear stress on the tip at most alpha times the cohesion; no bound if not given"),
      MPM_MODEL_CONTACT(&s->contact),
      OPTION_NUMBER("corner", "1", OPTION_FROM_TO(0.0, 2.0), &s->corner,
                    "radius of its edges for the soil, cells; by impulses"),
      OPTION_NUMBER("depth", "m", OPTION_LENGTH, &s->depth,
                    "of the lowest point, where the run ends"),
      OPTION_NUMBER("speed", "m/s", OPTION_FROM_TO(1e-6, 10.0), &s->speed, "of the tip"),
      OPTION_HEADING("Soil"),
      OPTION_CHOICE("law", "clay|sand|elastic", &s->law,
                    "von Mises, Drucker-Prager (inscribed cone), linear elastic"),
      OPTION_TEXT("soil", "WxWxD", &s->soil,
                  "width, breadth and depth of the box in diameters, made whole cells"),
      OPTION_NUMBER("cohesion", "kPa", OPTION_STRENGTH, &s->cohesion, "c of clay and sand"),
      OPTION_NUMBER("phi", "degrees", OPTION_FROM_TO(0.1, 60.0), &s->phi,
                    "angle of friction of sand"),
      OPTION_NUMBER("psi", "degrees", OPTION_FROM_TO(0.0, 60.0), &s->psi, "its angle of dilation"),
      OPTION_NUMBER("young", "kPa", OPTION_MODULUS, &s->young, "Young's modulus E"),
      OPTION_NUMBER("poisson", "1", OPTION_FROM_TO(0.0, 0.49), &s->poisson, "Poisson's ratio nu"),
      OPTION_NUMBER("density", "kg/m3", OPTION_DENSITY, &s->density, "of the soil"),
      OPTION_NUMBER("gravity", "m/s2", OPTION_GRAVITY, &s->gravity,
                    "9.81 with --law sand and 0 else if not given"),
      OPTION_HEADING("Grid"),
      OPTION_CHOICE("model", "quarter|whole", &s->model,
                    "quarter: rollers on two planes through the axis"),
      OPTION_NUMBER("h", "m", OPTION_LENGTH, &s->h, "grid spacing"),
      OPTION_INTEGER("ppc", "N", OPTION_FROM_TO(1.0, 64.0), &s->ppc,
                     "particles a cell in space, a cube: 1, 8, 27 or 64"),
      OPTION_CHOICE("spline", "2|3", &s->spline, "degree of the weights"),
      OPTION_CHOICE("volumetric", "point|cell", &s->volumetric, "change of volume: F-bar by cell"),
      OPTION_NUMBER("courant", "1", OPTION_FROM_TO(1e-3, 1.0), &s->courant,
                    "step over its limit, Nakamura (49)"),
      OPTION_HEADING("Run"),
      OPTION_FLAG("axisymmetric", &s->axisymmetric,
                  "then the same by the axisymmetric solver, in a cylinder with the box's section"),
      OPTION_FLAG("no-space", &s->no_space, "with --axisymmetric: nothing but that"),
      OPTION_OUT(&s->out),
      OPTION_THREADS(&s->threads),
      {0}};
  const options_program program = {
      "mps-penetrometer",
      "A rigid cone, sphere or mesh pushed into soil (WLS-MPM in space; von Mises, Drucker-Prager\n"
      "or elastic): its resistance by tip and shaft along the path, and the soil in section.",
      table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  if (s->law == PEN_SAND && !options_given(table, "cohesion")) s->cohesion = 0.0;
  const char *reason = pen_check(&p);
  if (reason) return options_refuse(&program, reason);
  static const mpm_model_parts parts = {pen_build, pen_push, pen_finish};
  const int result = mpm_model_run(&program, s->threads, s->out, &p.run[0].m, &parts, &p);
  pen_free(&p);
  return result;
}
