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
    const double more = s->h * ceil(end / s->h - 1e-9) - end;
    if (options_given(table, "toe") && more > 1e-6 * s->h)
      options_note("--toe is %.6g m, taken as %.6g m: whole cells", s->toe, s->toe + more);
    s->toe += more;
  }
  if (options_given(table, "falls") && !s->runout) return "--falls is for --runout";
  if (isnan(s->residual_phi)) s->residual_phi = s->phi;
  if (isnan(s->residual_cohesion)) s->residual_cohesion = s->cohesion;
  if (isnan(s->slip)) s->slip = 0.01 * s->height;
  if (softens && !s->runout)
    return "--residual-phi, --residual-cohesion and --slip are for --runout";
  if (options_given(table, "factor-tolerance") && (s->runout || !isnan(s->factor)))
    return "--factor-tolerance is for a factor that is sought, without --runout and --factor";
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
    return "--below-toe must be 0 or at least 2 cells of --cell";
  if (s->base == 0.0 && options_given(table, "toe")) return "--toe is for a --below-toe above 0";
  if (s->height < 5.0 * s->h * (1.0 - 1e-9)) return "--height must be at least 5 cells of --cell";
  if (s->crest < 0.5 * s->height) return "--crest must be at least half of --height";
  if (s->runout && s->density * s->gravity * (s->height + s->base) > 0.1 * s->young)
    return "--young must be at least 10 times the stress below the crest, density g height";
  const char *wet = slope_settle_water(s, table);
  if (wet) return wet;
  const double ground = s->height * (s->crest + 0.5 * s->slope * s->height) +
                        s->base * (s->crest + s->slope * s->height + s->toe);
  return mpm_model_too_large(ground / (s->h * s->h) * (double)s->ppc);
}

int main(int argc, char **argv) {
  static simulation sim = {.s = {.table = NAN}};
  settings *s = &sim.s;
  option table[] = {
      OPTION_HEADING("Slope"),
      OPTION_NUMBER("height", &s->height, "of the crest over the toe", 10.0),
      OPTION_NUMBER_IN("slope", OPTION_FROM_TO(0.0, 10.0), &s->slope, "0: a vertical cut", 2.0),
      OPTION_NUMBER("below-toe", &s->base, "rigid rough ground below"),
      OPTION_NUMBER("crest", &s->crest, NULL, NAN),
      OPTION_NUMBER("toe", &s->toe, NULL, NAN),
      OPTION_HEADING("Ground (Mohr-Coulomb)"),
      OPTION_NUMBER_IN("phi", OPTION_FROM_TO(0.0, 50.0), &s->phi, NULL, 20.0),
      OPTION_NUMBER_IN("psi", OPTION_FROM_TO(0.0, 50.0), &s->psi, "at most phi"),
      SAND_OPTIONS(&s->voids),
      OPTION_NUMBER("cohesion", &s->cohesion, "with --strength-gradient at the crest, default 0",
                    9810.0),
      OPTION_NUMBER("strength-gradient", &s->gradient, "below the crest's level"),
      OPTION_NUMBER("young", &s->young, "of a --runout; a factor of safety does not depend on it",
                    1e8),
      OPTION_NUMBER("poisson", &s->poisson, NULL, 0.3),
      OPTION_NUMBER("density", &s->density, NULL, 2000.0),
      OPTION_NUMBER_IN("gravity", OPTION_FROM_TO(1e-3, 1e4), &s->gravity, NULL, 9.81),
      OPTION_HEADING("Water"),
      OPTION_TEXT("water-level", &s->table_text, NULL),
      OPTION_CHOICE_OF("seepage", "rest|along", &s->flow, NULL),
      OPTION_NUMBER("drawdown", &s->drawdown, NULL, NAN),
      OPTION_NUMBER("ru", &s->ru, NULL),
      OPTION_NUMBER("moist-density", &s->moist, NULL, NAN),
      OPTION_HEADING("Factor of safety"),
      OPTION_NUMBER("factor", &s->factor, NULL, NAN),
      OPTION_NUMBER("factor-tolerance", &s->tolerance, NULL, 0.01),
      OPTION_HEADING("Run-out"),
      OPTION_FLAG("runout", &s->runout, NULL),
      OPTION_NUMBER_IN("residual-phi", OPTION_FROM_TO(0.0, 50.0), &s->residual_phi, NULL, NAN),
      OPTION_NUMBER("residual-cohesion", &s->residual_cohesion, NULL, NAN),
      OPTION_NUMBER("slip", &s->slip, "default 0.01 H", NAN),
      OPTION_NUMBER_IN("falls", OPTION_FROM_TO(1e-3, 1e5), &s->falls, NULL, 30.0),
      OPTION_HEADING("Grid"),
      MPM_MODEL_GRID(s, NAN, 4, 0.5, "default height/20"),
      OPTION_HEADING("Run"),
      MPM_COURSE_OPTIONS(&s->course, SLOPE_SAMPLES),
      OPTIONS_OF_ALL(s),
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
