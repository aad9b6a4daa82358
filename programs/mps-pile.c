/* mps-pile - an open-ended pile pushed into sand, axisymmetric: Nakamura 8, Figures 22 to 25.
 *
 * The pile is rigid and moves down at constant speed; its resistance is reported by tip, inner and
 * outer shaft, and the level of the soil inside shows plugging.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pile/pile.h"

#include <math.h>
#include <stdlib.h>

#define PAPER_XI 0.6 /* Nakamura (58) */

int main(int argc, char **argv) {
  static pile p = {.s = {.soil = "0.4x0.6"}};
  pile_settings *s = &p.s;
  option table[] = {
      OPTION_HEADING("Pile"),
      OPTION_FLAG("paper", &s->paper, NULL),
      OPTION_NUMBER("inner-diameter", &s->inner_diameter, NULL, 0.15),
      OPTION_NUMBER("wall-thickness", &s->wall, "by --contact penalty at least 2 cells", 0.02),
      OPTION_NUMBER("friction", &s->friction, "of its surface, tan(delta)", 0.53),
      OPTION_NUMBER("depth", &s->depth, "of the tip, where the run ends", 0.3),
      OPTION_NUMBER("rate", &s->rate, NULL, 0.1),
      MPM_MODEL_CONTACT(&s->contact),
      OPTION_NUMBER("corner", &s->corner, "with --inset 0"),
      OPTION_NUMBER("inset", &s->inset, NULL),
      OPTION_NUMBER("k", &s->k, "default 4 (K + 4G/3)", NAN),
      OPTION_NUMBER("xi", &s->xi, NULL, NAN),
      OPTION_HEADING("Soil"),
      OPTION_TEXT_OF("soil", "WxH", &s->soil, "radius and depth"),
      OPTION_NUMBER("density", &s->density, NULL, 1600.0),
      OPTION_NUMBER("young", &s->young, NULL, 1e6),
      OPTION_NUMBER("poisson", &s->poisson, NULL, 0.333),
      OPTION_NUMBER_IN("phi", OPTION_FROM_TO(0.1, 60.0), &s->phi, NULL, 38.0),
      OPTION_NUMBER("psi", &s->psi, NULL),
      SAND_OPTIONS(&s->voids),
      OPTION_NUMBER("cohesion", &s->cohesion, NULL),
      OPTION_CHOICE_OF("cone", "inscribed|circumscribed|planestrain", &s->cone,
                       "inscribed: Nakamura (56)"),
      OPTION_NUMBER_IN("k0", OPTION_FROM_TO(1e-3, 5.0), &s->k0, "default nu/(1 - nu)", NAN),
      OPTION_HEADING("Grid"),
      OPTION_NUMBER("cell", &s->h, NULL, 0.01),
      OPTION_INTEGER("ppc", &s->ppc, NULL, 4),
      OPTION_CHOICE("spline", &s->spline, NULL, 1),
      OPTION_NUMBER("courant", &s->courant, "Nakamura (49); by --contact penalty 0.5", 0.9),
      OPTION_CHOICE("volumetric", &s->volumetric, NULL),
      MPM_METHOD_OPTIONS(&s->method),
      OPTION_NUMBER("flip-time", &s->flip_time, "default: by the cell and the wave speed", NAN),
      OPTION_HEADING("Run"),
      OPTION_NUMBER("rest", &s->rest, NULL),
      OPTION_INTEGER_IN("frames", OPTION_FROM_TO(0.0, 1000.0), &s->course.frames,
                        "at equal steps of depth; as many tables, and up to 4 in pictures", 4),
      RESUME_OPTIONS(&s->course.checkpoint, &s->course.every_checkpoint,
                     "default a tenth of the run", &s->course.restart),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {
      "mps-pile",
      "An open-ended pile pushed into sand (WLS-MPM, Drucker-Prager, axisymmetric): Nakamura, "
      "Figures\n"
      "22 to 25. Its resistance by tip, inner and outer shaft, the plug, the stress in the soil.",
      table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  static const option_preset paper[] = {
      {"contact", "penalty"}, {"volumetric", "point"}, {"rate", "0.1m/s"},
      {"courant", "0.5"},     {"cell", "5mm"},         {"wall-thickness", "10mm"},
      {"depth", "1m"},        {"soil", "0.4x3"},       {0}};
  static const option_preset springs[] = {{"courant", "0.5"},
                                          {0}}; /* they chatter in longer steps */
  int settled = mpm_method_settle(&program, &s->method, s->paper, paper, s->flip_time);
  if (settled < 0 && s->contact == MPS_CONTACT_METHOD_PENALTY)
    settled = options_prefer(&program, springs);
  if (settled >= 0) return settled;
  if (s->paper && isnan(s->k) && isnan(s->xi)) s->xi = PAPER_XI;
  if (options_given(table, "xi") && options_given(table, "k"))
    return options_refuse(&program, "--xi and --k exclude each other");
  const char *refused = mpm_model_refuse_stiffness(table, s->contact);
  if (refused) return options_refuse(&program, refused);
  const char *reason = mpm_model_settle_edges(table, s->contact, 0.0, &s->corner, &s->inset);
  if (!reason) reason = pile_check(s);
  if (reason) return options_refuse(&program, reason);
  static const mpm_model_parts parts = {pile_build, pile_drive, pile_finish};
  const mpm_model_places places = {&s->out, &s->course.checkpoint, s->course.restart};
  const int result = mpm_model_run(&program, s->threads, &places, &p.m, &parts, &p);
  pile_free(&p);
  return result;
}
