/* mps-site-response - level ground of layers, of any stiffness and strength, dry or with water in
 * its pores, shaken from below: WLS-MPM between free-field sides. Motion and response spectrum of
 * the surface; largest accelerations, strains, stresses and pore pressures by depth.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "site/site.h"

#include "common/record.h"

#include <math.h>

int main(int argc, char **argv) {
  static simulation sim = {.s = {.record = "ricker"}};
  settings *s = &sim.s;
  option table[] = {
      OPTION_HEADING("Ground"),
      OPTION_TEXT(
          "layers", &s->layers,
          "thickness_m, density_kg_m3, vs_m_s; law: elastic, smallstrain, mohrcoulomb or "
          "cyclicsand; poisson, k0, permeability_m_s, porosity; smallstrain also: "
          "reference_strain, curvature, strength_Pa; mohrcoulomb and cyclicsand: phi_degrees, "
          "psi_degrees, cohesion_Pa, e0, emax; cyclicsand: relative_density or blow_count. The "
          "last row of --base compliant is the half space, of thickness inf"),
      OPTION_CHOICE_OF("base", "compliant|rigid", &s->base,
                       "compliant: an elastic half space, whose outcrop moves as the record; "
                       "rigid: a base that moves as the record"),
      OPTION_HEADING("Water, at rest up to the surface"),
      OPTION_FLAG("undrained", &s->undrained, NULL),
      OPTION_NUMBER("permeability", &s->permeability,
                    "of layers without one of their own; without any the ground is dry", NAN),
      OPTION_NUMBER_IN("porosity", OPTION_FROM_TO(0.01, 0.95), &s->porosity,
                       "of layers without one of their own", 0.4),
      OPTION_NUMBER("water-bulk", &s->bulk, NULL, 2.2e9),
      OPTION_HEADING("Motion"),
      OPTION_TEXT_OF("record", "ricker|sine|FILE", &s->record, NULL),
      OPTION_CHOICE("record-unit", &s->unit, NULL),
      OPTION_NUMBER("record-step", &s->step, NULL, NAN),
      OPTION_TEXT("record-column", &s->column, NULL),
      OPTION_NUMBER("record-scale", &s->scale, NULL, 1.0),
      OPTION_CHOICE("baseline", &s->baseline, NULL),
      OPTION_NUMBER_IN("frequency", OPTION_FROM_TO(0.01, 100.0), &s->frequency, NULL, 2.0),
      OPTION_NUMBER_IN("acceleration", OPTION_FROM_TO(-100.0, 100.0), &s->amplitude, NULL, 1.0),
      OPTION_INTEGER("cycles", &s->cycles,
                     "of the sine, after one that grows and before one that fades", 10),
      OPTION_HEADING("Grid"),
      OPTION_NUMBER("max-frequency", &s->highest,
                    "default 10 Hz, of layers that yield and do not liquefy 20 Hz; a pulse's "
                    "--frequency if that is higher",
                    NAN),
      OPTION_NUMBER("cell", &s->h, "at most; default by --max-frequency", NAN),
      OPTION_CHOICE("volumetric", &s->volumetric, "law: with water cell"),
      OPTION_NUMBER("courant", &s->courant, NULL, 0.5),
      OPTION_CHOICE("spline", &s->spline, NULL, 1),
      OPTION_NUMBER("flip-time", &s->flip_time,
                    "default the period of --max-frequency, 0 with saturated cyclic sand, which "
                    "has noise with it once it has liquefied",
                    NAN),
      OPTION_NUMBER_IN("mass-damping", OPTION_FROM_TO(0.0, 1e3), &s->damping,
                       "relative to the input: a damping ratio of this over 4 pi f"),
      OPTION_HEADING("Run"),
      OPTION_NUMBER("duration", &s->duration,
                    "default the record and twenty travel times of a shear wave", NAN),
      OPTION_NUMBER("sample", &s->sample, NULL, 5e-3),
      OPTION_NUMBER("loop", &s->loop, NULL, NAN),
      MPM_COURSE_OPTIONS(&s->course, SITE_SAMPLES),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {
      "mps-site-response",
      "Level layers of soil, dry or saturated, shaken by a record from a rigid base or a half "
      "space\n"
      "(WLS-MPM between free-field sides): motion and response spectrum of the surface, largest\n"
      "accelerations, strains and pore pressures by depth.",
      table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  const char *reason = site_settle(s, table);
  if (reason) return options_refuse(&program, reason);
  static const mpm_model_parts parts = {site_build, site_march, site_finish};
  const mpm_model_places places = {&s->out, &s->course.checkpoint, s->course.restart};
  const int ended = mpm_model_run(&program, s->threads, &places, &sim.m, &parts, &sim);
  site_free(&sim);
  return ended;
}
