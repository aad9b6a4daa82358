/* mps-slope - the stability of a slope, dry or with water in the ground and before it, by strength
 * reduction: cohesion and tan(phi) are divided by a factor until it fails; and, with a strength
 * that softens, how far it runs out. WLS-MPM, Mohr-Coulomb, plane strain. A vertical cut is a slope
 * of 0. SPDX-License-Identifier: BSD-3-Clause */
#include "slope/slope.h"

#include <math.h>
#include <stdlib.h>

/* What depends on other options, and what they exclude. NULL: good. */
static const char *settle(settings *s, const option *table) {
  const bool softens = options_given(table, "residual-phi") ||
                       options_given(table, "residual-cohesion") || options_given(table, "slip");
  if (s->gradient > 0.0 && !options_given(table, "cohesion")) s->cohesion = 0.0;
  if (isnan(s->crest)) s->crest = 1.2 * (s->height + s->base);
  if (isnan(s->toe)) s->toe = s->base > 0.0 ? 1.5 * s->height : 0.0;
  if (isnan(s->h)) s->h = s->height / 20.0;
  if (s->base > 0.0) {
    const double end = s->crest + s->slope * s->height + s->toe;
    s->toe += s->h * ceil(end / s->h - 1e-9) - end;
  }
  if (isnan(s->falls)) s->falls = s->runout ? 30.0 : 10.0;
  if (isnan(s->residual_phi)) s->residual_phi = s->phi;
  if (isnan(s->residual_cohesion)) s->residual_cohesion = s->cohesion;
  if (isnan(s->slip)) s->slip = 0.01 * s->height;
  if (softens && !s->runout)
    return "--residual-phi, --residual-cohesion and --slip are for --runout";
  if (options_given(table, "tolerance") && (s->runout || !isnan(s->factor)))
    return "--tolerance is for a factor that is sought, without --runout and --factor";
  if (options_given(table, "slip") && !options_given(table, "residual-phi") &&
      !options_given(table, "residual-cohesion"))
    return "--slip is for a strength that falls, to --residual-phi or --residual-cohesion";
  if (s->runout && isnan(s->factor)) s->factor = 1.0;
  if (s->gradient > 0.0 && s->runout) return "--strength-gradient and --runout exclude each other";
  if (s->phi == 0.0 && s->cohesion == 0.0 && s->gradient == 0.0)
    return "--phi and --cohesion must not both be 0";
  if (s->psi > s->phi) return "--psi must be at most --phi";
  if (sand_check(&s->voids)) return sand_check(&s->voids);
  if (s->residual_phi > s->phi || s->residual_cohesion > s->cohesion)
    return "--residual-phi and --residual-cohesion must be at most --phi and --cohesion";
  if (s->runout && s->residual_phi == 0.0 && s->residual_cohesion == 0.0)
    return "--residual-phi and --residual-cohesion must not both be 0";
  if (s->base > 0.0 && s->base < 2.0 * s->h * (1.0 - 1e-9))
    return "--base must be 0 or at least 2 cells of --h";
  if (s->base == 0.0 && options_given(table, "toe")) return "--toe is for a --base above 0";
  if (s->height < 5.0 * s->h * (1.0 - 1e-9)) return "--height must be at least 5 cells of --h";
  if (s->crest < 0.5 * s->height) return "--crest must be at least half of --height";
  if (s->density * s->gravity * (s->height + s->base) > 0.1 * s->young)
    return "--young must be at least 10 times the stress below the crest, density g height";
  const char *wet = slope_settle_water(s, table);
  if (wet) return wet;
  const double ground = s->height * (s->crest + 0.5 * s->slope * s->height) +
                        s->base * (s->crest + s->slope * s->height + s->toe);
  return mpm_model_too_large(ground / (s->h * s->h) * (double)s->ppc);
}

int main(int argc, char **argv) {
  static simulation sim = {.s = {.height = 10.0,
                                 .slope = 2.0,
                                 .crest = NAN,
                                 .toe = NAN,
                                 .phi = 20.0,
                                 .voids = SAND_VOIDS,
                                 .cohesion = 9810.0,
                                 .residual_phi = NAN,
                                 .residual_cohesion = NAN,
                                 .slip = NAN,
                                 .young = 1e8,
                                 .poisson = 0.3,
                                 .density = 2000.0,
                                 .gravity = 9.81,
                                 .moist = NAN,
                                 .table = NAN,
                                 .drawdown = NAN,
                                 .factor = NAN,
                                 .tolerance = 0.02,
                                 .fails = 0.01,
                                 .falls = NAN,
                                 .h = NAN,
                                 .ppc = 4,
                                 .spline = 1,
                                 .course = MPM_COURSE_DEFAULTS,
                                 .out = "out/slope"}};
  settings *s = &sim.s;
  option table[] = {
      OPTION_HEADING("Slope"),
      OPTION_NUMBER("height", "m", OPTION_LENGTH, &s->height, "of the crest over the toe"),
      OPTION_NUMBER("slope", "1", OPTION_FROM_TO(0.0, 10.0), &s->slope,
                    "horizontal per vertical; 0: a vertical cut"),
      OPTION_NUMBER("base", "m", OPTION_FROM_TO(0.0, 1e6), &s->base,
                    "depth of ground below the toe; rigid rough ground below"),
      OPTION_NUMBER("crest", "m", OPTION_LENGTH, &s->crest,
                    "level ground behind the crest; default 1.2 times height and base"),
      OPTION_NUMBER(
          "toe", "m", OPTION_LENGTH, &s->toe,
          "level ground in front of the toe, up to whole cells; default 1.5 heights with --base"),
      OPTION_HEADING("Ground (Mohr-Coulomb)"),
      COMMON_NUMBER_IN("phi", OPTION_FROM_TO(0.0, 50.0), &s->phi, NULL),
      COMMON_NUMBER_IN("psi", OPTION_FROM_TO(0.0, 50.0), &s->psi, "at most phi"),
      SAND_E0_OPTION(&s->voids),
      SAND_E_MAX_OPTION(&s->voids),
      COMMON_NUMBER("cohesion", &s->cohesion, "with --strength-gradient at the crest, default 0"),
      OPTION_NUMBER("strength-gradient", "Pa/m", OPTION_FROM_TO(0.0, 1e9), &s->gradient,
                    "growth of the cohesion with the depth below the crest's level"),
      COMMON_NUMBER("young", &s->young, NULL),
      COMMON_NUMBER_IN("poisson", OPTION_FROM_TO(0.0, 0.49), &s->poisson, NULL),
      COMMON_NUMBER("density", &s->density, NULL),
      COMMON_NUMBER_IN("gravity", OPTION_FROM_TO(1e-3, 1e4), &s->gravity, NULL),
      OPTION_HEADING("Water"),
      OPTION_TEXT(
          "water-table", "m|FILE", &s->table_text,
          "level above the toe, of a pool where it is above the ground; or a line, each of "
          "its points x_m from the crest's edge (to the toe) and level_m above the toe, level "
          "beyond its ends; "
          "below it phi and cohesion are effective, --density is saturated"),
      OPTION_CHOICE("seepage", "rest|along", &s->flow,
                    "pressures below a line: of water at rest, or of water that flows along it, "
                    "cos^2 of its inclination times that"),
      OPTION_NUMBER("drawdown", "m", OPTION_FROM_TO(-1e6, 1e6), &s->drawdown,
                    "level above the toe from which a pool has fallen to --water-table at once, "
                    "undrained: the pressures are less the load that the ground has lost"),
      OPTION_NUMBER("ru", "1", OPTION_FROM_TO(0.0, 0.9), &s->ru,
                    "pressure of the water over the weight of the ground above, everywhere"),
      OPTION_NUMBER("moist-density", "kg/m3", OPTION_DENSITY, &s->moist,
                    "of the ground above --water-table; default --density"),
      OPTION_HEADING("Factor of safety"),
      OPTION_NUMBER("factor", "1", OPTION_FROM_TO(0.05, 20.0), &s->factor,
                    "one trial with c and tan(phi) divided by it; default: it is sought"),
      OPTION_NUMBER("tolerance", "1", OPTION_FROM_TO(1e-3, 1.0), &s->tolerance,
                    "of the factor: between one that stands and one that fails"),
      OPTION_NUMBER("fails", "H", OPTION_FROM_TO(1e-4, 1.0), &s->fails,
                    "displacement at which it has failed, of all but 1 % of the particles"),
      OPTION_NUMBER("falls", "(H/g)^1/2", OPTION_FROM_TO(1e-3, 1e5), &s->falls,
                    "time it has to fail; default 10, --runout 30"),
      OPTION_HEADING("Run-out"),
      OPTION_FLAG("runout", &s->runout,
                  "of the strength divided by --factor (default 1), which softens, until it rests"),
      OPTION_NUMBER("residual-phi", "degrees", OPTION_FROM_TO(0.0, 50.0), &s->residual_phi,
                    "at last; default phi"),
      OPTION_NUMBER("residual-cohesion", "Pa", OPTION_STRENGTH, &s->residual_cohesion,
                    "at last; default the cohesion"),
      OPTION_NUMBER("slip", "m", OPTION_LENGTH, &s->slip,
                    "displacement across a band at which 1/e of the fall is left; default 0.01 H"),
      OPTION_HEADING("Grid"),
      COMMON_NUMBER("h", &s->h, "default height/20"),
      COMMON_INTEGER("ppc", &s->ppc, NULL),
      COMMON_CHOICE("spline", &s->spline, NULL),
      OPTION_HEADING("Run"),
      MPM_COURSE_OPTIONS(&s->course, SLOPE_SAMPLES),
      OPTION_OUT(&s->out),
      OPTION_THREADS(&s->threads),
      {0}};
  const options_program program = {
      "mps-slope",
      "The factor of safety of a slope by strength reduction, and the run-out of one that fails\n"
      "(WLS-MPM, Mohr-Coulomb).",
      table};
  int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  const char *reason = settle(s, table);
  if (reason) return options_refuse(&program, reason);
  static const mpm_model_parts parts = {slope_build, slope_march, slope_finish};
  const mpm_model_places places = {&s->out, &s->course.checkpoint, s->course.restart};
  code = mpm_model_run(&program, s->threads, &places, &sim.m, &parts, &sim);
  mpm_snapshot_free(&sim.shot);
  free(sim.start);
  return code;
}
