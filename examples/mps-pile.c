/* mps-pile - an open-ended pile pushed into sand, axisymmetric: Nakamura 8, Figures 22 to 25.
 *
 * The pile is rigid and goes down at constant speed; its resistance is told apart by tip, inner and
 * outer shaft, and the soil inside is watched for plugging.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pile/pile.h"

#include <math.h>
#include <stdlib.h>

int main(int argc, char **argv) {
  static pile p = {.s = {.inner_diameter = 0.15,
                         .wall = 0.01,
                         .friction = 0.53,
                         .speed = 0.1,
                         .depth = 1.0,
                         .xi = NAN,
                         .k = NAN,
                         .soil = "0.4x3",
                         .density = 1600.0,
                         .young = 1000.0,
                         .poisson = 0.333,
                         .phi = 38.0,
                         .k0 = NAN,
                         .h = 0.005,
                         .courant = 0.5,
                         .ppc = 4,
                         .spline = 1,
                         .frames = 4,
                         .every_checkpoint = 0.05,
                         .out = "out/pile"}};
  pile_settings *s = &p.s;
  option table[] = {
      OPTION_HEADING("Pile"),
      OPTION_NUMBER("inner-diameter", "m", OPTION_LENGTH, &s->inner_diameter, "of the pile"),
      OPTION_NUMBER("wall", "m", OPTION_LENGTH, &s->wall,
                    "thickness of the pile; by --contact penalty at least 2 cells of --h"),
      OPTION_NUMBER("friction", "1", OPTION_FROM_TO(0.0, 10.0), &s->friction,
                    "mu of its surface, tan(delta)"),
      OPTION_NUMBER("depth", "m", OPTION_LENGTH, &s->depth, "of the tip, where the run ends"),
      OPTION_NUMBER("speed", "m/s", OPTION_FROM_TO(1e-6, 10.0), &s->speed, "of the pile"),
      MPM_MODEL_CONTACT(&s->contact),
      OPTION_NUMBER("corner", "1", OPTION_FROM_TO(0.0, 2.0), &s->corner,
                    "radius of its edges for the sand, cells; by impulses"),
      OPTION_NUMBER("k", "kN/m", OPTION_STIFFNESS, &s->k,
                    "contact stiffness of each particle per unit thickness, Nakamura (28); "
                    "4 (K + 4G/3) if not given"),
      OPTION_NUMBER("xi", "1", OPTION_FROM_TO(0.0, 0.99), &s->xi,
                    "instead of --k: k = 2 (1 - xi) m/dt^2 of the first step, Nakamura (58), "
                    "there 0.6"),
      OPTION_HEADING("Soil"),
      OPTION_TEXT("soil", "WxH", &s->soil, "radius and height of the soil in m, whole cells"),
      OPTION_NUMBER("density", "kg/m3", OPTION_DENSITY, &s->density, "of the soil"),
      OPTION_NUMBER("young", "kPa", OPTION_MODULUS, &s->young, "Young's modulus E"),
      OPTION_NUMBER("poisson", "1", OPTION_FROM_TO(0.0, 0.49), &s->poisson, "Poisson's ratio nu"),
      OPTION_NUMBER("phi", "degrees", OPTION_FROM_TO(0.1, 60.0), &s->phi, "angle of friction"),
      OPTION_NUMBER("psi", "degrees", OPTION_FROM_TO(0.0, 60.0), &s->psi, "angle of dilation"),
      OPTION_NUMBER("cohesion", "kPa", OPTION_STRENGTH, &s->cohesion, "c"),
      OPTION_CHOICE("cone", "inscribed|circumscribed|planestrain", &s->cone,
                    "how the cone of Drucker and Prager meets phi; inscribed: Nakamura (56)"),
      OPTION_NUMBER("k0", "1", OPTION_FROM_TO(1e-3, 5.0), &s->k0,
                    "horizontal over vertical stress at the start; nu/(1 - nu) if not given"),
      OPTION_HEADING("Grid"),
      OPTION_NUMBER("h", "m", OPTION_LENGTH, &s->h, "grid spacing"),
      OPTION_INTEGER("ppc", "N", OPTION_FROM_TO(1.0, 100.0), &s->ppc, "particles a cell"),
      OPTION_CHOICE("spline", "2|3", &s->spline, "degree of the weights"),
      OPTION_NUMBER("courant", "1", OPTION_FROM_TO(1e-3, 1.0), &s->courant,
                    "step over its limit, Nakamura (49)"),
      OPTION_HEADING("Run"),
      OPTION_NUMBER("rest", "s", OPTION_FROM_TO(0.0, 1e6), &s->rest,
                    "time before the pile moves, to see whether the soil rests"),
      OPTION_INTEGER("frames", "N", OPTION_FROM_TO(1.0, 1000.0), &s->frames,
                     "depths at which the soil is written; pictures show up to 4 of them"),
      OPTION_TEXT("checkpoint", "FILE", &s->checkpoint,
                  "written at the start, on the way and at Ctrl-C, to go on from"),
      OPTION_NUMBER("every-checkpoint", "m", OPTION_LENGTH, &s->every_checkpoint,
                    "path of the pile between checkpoints"),
      OPTION_TEXT(
          "restart", "FILE", &s->restart,
          "go on from a checkpoint made with the same options (but --out, --threads and those of "
          "checkpoints); the results are those of the whole run, the frames for "
          "ParaView those from here on, in pile-from-N.vtkhdf"),
      OPTION_OUT(&s->out),
      OPTION_THREADS(&s->threads),
      {0}};
  const options_program program = {
      "mps-pile",
      "An open-ended pile pushed into sand (WLS-MPM, Drucker-Prager, axisymmetric): Nakamura, "
      "Figures\n"
      "22 to 25. Its resistance by tip, inner and outer shaft, the plug, the stress in the soil.",
      table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  if (options_given(table, "xi") && options_given(table, "k"))
    return options_refuse(&program, "--xi and --k exclude each other");
  const char *refused = mpm_model_refuse_stiffness(table, s->contact);
  if (refused) return options_refuse(&program, refused);
  if (options_given(table, "every-checkpoint") && !s->checkpoint)
    return options_refuse(&program, "--every-checkpoint needs --checkpoint FILE");
  const char *reason = pile_check(s);
  if (reason) return options_refuse(&program, reason);
  static const mpm_model_parts parts = {pile_build, pile_drive, pile_finish};
  p.table = table;
  const int result = mpm_model_run(&program, s->threads, s->out, &p.m, &parts, &p);
  pile_free(&p);
  return result;
}
