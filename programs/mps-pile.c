/* mps-pile - an open-ended pile pushed into sand, axisymmetric: Nakamura 8, Figures 22 to 25.
 *
 * The pile is rigid and moves down at constant speed; its resistance is reported by tip, inner and
 * outer shaft, and the level of the soil inside shows plugging.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pile/pile.h"

#include <math.h>
#include <stdlib.h>

int main(int argc, char **argv) {
  static pile p = {.s = {.inner_diameter = 0.15,
                         .wall = 0.01,
                         .friction = 0.53,
                         .rate = 0.1,
                         .depth = 1.0,
                         .xi = NAN,
                         .k = NAN,
                         .soil = "0.4x3",
                         .density = 1600.0,
                         .young = 1e6,
                         .poisson = 0.333,
                         .phi = 38.0,
                         .voids = SAND_VOIDS,
                         .k0 = NAN,
                         .h = 0.005,
                         .flip_time = NAN,
                         .courant = 0.5,
                         .ppc = 4,
                         .spline = 1,
                         .frames = 4,
                         .every_checkpoint = NAN,
                         .out = "out/pile"}};
  pile_settings *s = &p.s;
  option table[] = {
      OPTION_HEADING("Pile"),
      OPTION_NUMBER("inner-diameter", "m", OPTION_LENGTH, &s->inner_diameter, "of the pile"),
      OPTION_NUMBER("wall", "m", OPTION_LENGTH, &s->wall,
                    "thickness of the pile; by --contact penalty at least 2 cells of --h"),
      COMMON_NUMBER("friction", &s->friction, "of its surface, tan(delta)"),
      COMMON_NUMBER("depth", &s->depth, "of the tip, where the run ends"),
      COMMON_NUMBER("rate", &s->rate, NULL),
      MPM_MODEL_CONTACT(&s->contact),
      COMMON_NUMBER("corner", &s->corner, NULL),
      COMMON_NUMBER("k", &s->k, "default 4 (K + 4G/3)"),
      OPTION_NUMBER("xi", "1", OPTION_FROM_TO(0.0, 0.99), &s->xi,
                    "instead of --k: k = 2 (1 - xi) m/dt^2 of the first step, Nakamura (58), "
                    "there 0.6"),
      OPTION_HEADING("Soil"),
      OPTION_TEXT("soil", "WxH", &s->soil, "radius and height of the soil in m, whole cells"),
      COMMON_NUMBER("density", &s->density, NULL),
      COMMON_NUMBER("young", &s->young, NULL),
      COMMON_NUMBER("poisson", &s->poisson, NULL),
      COMMON_NUMBER_IN("phi", OPTION_FROM_TO(0.1, 60.0), &s->phi, NULL),
      COMMON_NUMBER("psi", &s->psi, NULL),
      SAND_E0_OPTION(&s->voids),
      SAND_E_MAX_OPTION(&s->voids),
      COMMON_NUMBER("cohesion", &s->cohesion, NULL),
      OPTION_CHOICE("cone", "inscribed|circumscribed|planestrain", &s->cone,
                    "how the cone of Drucker and Prager meets phi; inscribed: Nakamura (56)"),
      OPTION_NUMBER("k0", "1", OPTION_FROM_TO(1e-3, 5.0), &s->k0,
                    "horizontal over vertical stress at the start; nu/(1 - nu) if not given"),
      OPTION_HEADING("Grid"),
      COMMON_NUMBER("h", &s->h, NULL),
      COMMON_INTEGER("ppc", &s->ppc, NULL),
      COMMON_CHOICE("spline", &s->spline, NULL),
      COMMON_NUMBER("courant", &s->courant, "Nakamura (49)"),
      COMMON_NUMBER("flip-time", &s->flip_time, "default: by the cell and the wave speed"),
      OPTION_HEADING("Run"),
      OPTION_NUMBER("rest", "s", OPTION_FROM_TO(0.0, 1e6), &s->rest,
                    "time before the pile moves, to see whether the soil rests"),
      COMMON_INTEGER_IN("frames", OPTION_FROM_TO(0.0, 1000.0), &s->frames,
                        "at equal steps of depth; as many tables, and up to 4 in pictures"),
      RESUME_OPTIONS(&s->checkpoint, &s->every_checkpoint, "default a tenth of the run",
                     &s->restart),
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
  const char *reason = pile_check(s);
  if (reason) return options_refuse(&program, reason);
  static const mpm_model_parts parts = {pile_build, pile_drive, pile_finish};
  const mpm_model_places places = {&s->out, &s->checkpoint, s->restart};
  p.table = table;
  const int result = mpm_model_run(&program, s->threads, &places, &p.m, &parts, &p);
  pile_free(&p);
  return result;
}
