/* mps-footing - a strip footing pressed into the ground: Nakamura 7.3, Figures 15 to 21. Cohesive
 * ground without weight (von Mises) against Prandtl's bearing capacity (52), q = (2 + pi) c; ground
 * with friction and weight (Drucker-Prager) against the method of characteristics.
 *
 * Half of it is computed: x = 0 is the line of symmetry.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "footing/footing.h"

#include <math.h>

int main(int argc, char **argv) {
  static simulation sim = {.s = {.h = 0.1,
                                 .rate = NAN,
                                 .half_width = 0.5,
                                 .domain = "5x5",
                                 .phi = 30.0,
                                 .psi = NAN,
                                 .cohesion = 10.0,
                                 .young = 1e6,
                                 .poisson = 0.3,
                                 .density = 1000.0,
                                 .gravity = NAN,
                                 .k = 2e6,
                                 .settlement = NAN,
                                 .spline = 1,
                                 .ppc = 4,
                                 .out = "out/footing"}};
  settings *s = &sim.s;
  option table[] = {
      OPTION_HEADING("Ground"),
      OPTION_CHOICE("model", "vonmises|druckerprager", &s->model, "law of the ground"),
      OPTION_TEXT("domain", "WxH", &s->domain,
                  "width of the half model and depth of the ground in m, whole cells"),
      OPTION_NUMBER("cohesion", "kPa", OPTION_FROM_TO(1e-3, 1e8), &s->cohesion,
                    "c; von Mises: undrained"),
      OPTION_NUMBER("phi", "degrees", OPTION_FROM_TO(0.1, 50.0), &s->phi,
                    "angle of friction; Drucker-Prager"),
      OPTION_NUMBER("psi", "degrees", OPTION_FROM_TO(0.0, 50.0), &s->psi,
                    "angle of dilation, at most phi; default phi; Drucker-Prager"),
      OPTION_CHOICE("cone", "planestrain|circumscribed|inscribed|extension", &s->cone,
                    "where the cone agrees with Mohr and Coulomb; Drucker-Prager"),
      OPTION_NUMBER("young", "kPa", OPTION_MODULUS, &s->young, "Young's modulus E"),
      OPTION_NUMBER("poisson", "1", OPTION_FROM_TO(0.0, 0.499), &s->poisson, "Poisson's ratio"),
      OPTION_NUMBER("density", "kg/m3", OPTION_DENSITY, &s->density, "rho"),
      OPTION_NUMBER("gravity", "m/s2", OPTION_GRAVITY, &s->gravity,
                    "g; default 0, Drucker-Prager 9.81"),
      OPTION_HEADING("Footing"),
      OPTION_NUMBER("half-width", "m", OPTION_LENGTH, &s->half_width, "B/2"),
      OPTION_NUMBER("mu", "1", OPTION_FROM_TO(0.0, 10.0), &s->mu, "friction of its base"),
      OPTION_NUMBER("rate", "mm/s", OPTION_FROM_TO(1e-3, 100.0), &s->rate,
                    "its speed; default 0.5, quasi-static 1.5"),
      OPTION_NUMBER("settlement", "mm", OPTION_FROM_TO(1e-3, 1e6), &s->settlement,
                    "where the run ends; default 0.6, Drucker-Prager 4"),
      MPM_MODEL_CONTACT(&s->contact),
      OPTION_NUMBER("k", "kN/m", OPTION_STIFFNESS, &s->k,
                    "contact stiffness per unit thickness of each particle, Nakamura (28)"),
      OPTION_HEADING("Grid"),
      OPTION_NUMBER("h", "m", OPTION_LENGTH, &s->h, "grid spacing"),
      OPTION_INTEGER("ppc", "N", OPTION_FROM_TO(1.0, 100.0), &s->ppc, "particles a cell"),
      OPTION_CHOICE("spline", "2|3", &s->spline, "degree of the weights"),
      OPTION_CHOICE("volumetric", "point|cell|nodes", &s->volumetric,
                    "change of volume: each particle's own, F-bar by cell, or means by nodes, for "
                    "ground that hardly changes its volume"),
      OPTION_HEADING("Run"),
      OPTION_FLAG("quasi-static", &s->settled,
                  "the ground comes to rest after each of 30 parts of the path: less inertia in "
                  "fewer steps"),
      OPTION_TEXT("checkpoint", "FILE", &s->checkpoint,
                  "written ten times on the way and at Ctrl-C, to go on from"),
      OPTION_TEXT("restart", "FILE", &s->restart,
                  "go on from a checkpoint made with the same options (but --out, --threads and "
                  "--checkpoint); the results are those of the whole run"),
      OPTION_OUT(&s->out),
      OPTION_THREADS(&s->threads),
      {0}};
  const options_program program = {
      "mps-footing",
      "A strip footing on cohesive ground without weight (WLS-MPM, von Mises) or on ground with\n"
      "friction and weight (Drucker-Prager): Nakamura, Figures 15 to 21. Its bearing capacity is\n"
      "compared with Prandtl's, or with the exact one by the method of characteristics.",
      table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  sim.table = table;
  const char *reason = footing_settle(s, table);
  if (reason) return options_refuse(&program, reason);
  const char *refused = mpm_model_refuse_stiffness(table, s->contact);
  if (refused) return options_refuse(&program, refused);
  static const mpm_model_parts parts = {footing_build, footing_march, footing_finish};
  return mpm_model_run(&program, s->threads, s->out, &sim.m, &parts, &sim);
}
