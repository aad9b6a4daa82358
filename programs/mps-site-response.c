/* mps-site-response - level ground of layers, of any stiffness and strength, dry or with water in
 * its pores, shaken from below: WLS-MPM between free-field sides. Motion and response spectrum of
 * the surface; largest accelerations, strains, stresses and pore pressures by depth.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "site/site.h"

#include "common/record.h"

#include <math.h>

int main(int argc, char **argv) {
  static simulation sim = {.s = {.record = "ricker",
                                 .scale = 1.0,
                                 .step = NAN,
                                 .frequency = 2.0,
                                 .amplitude = 1.0,
                                 .cycles = 10.0,
                                 .h = NAN,
                                 .highest = 10.0,
                                 .flip_time = NAN,
                                 .spline = 1,
                                 .sample = 5e-3,
                                 .duration = NAN,
                                 .permeability = NAN,
                                 .porosity = 0.4,
                                 .bulk = 2.2e9,
                                 .loop = NAN,
                                 .course = MPM_COURSE_DEFAULTS,
                                 .out = "out/site-response"}};
  settings *s = &sim.s;
  option table[] = {
      OPTION_HEADING("Ground"),
      OPTION_TEXT(
          "layers", "FILE", &s->layers,
          "layers from the surface down, a line each, of words name=value: thickness, "
          "density, vs, law=elastic|smallstrain|mohrcoulomb|cyclicsand, poisson, k0, "
          "permeability, porosity; smallstrain also: reference-strain, curvature, strength; "
          "mohrcoulomb and cyclicsand: phi, psi, cohesion; cyclicsand: relative-density or "
          "blow-count. The last line of --base compliant is \"halfspace density=... "
          "vs=...\""),
      OPTION_CHOICE("base", "compliant|rigid", &s->base,
                    "elastic half space, whose outcrop moves as the record; or a base that moves "
                    "as the record"),
      OPTION_HEADING("Water, at rest up to the surface"),
      OPTION_FLAG("undrained", &s->undrained, "water in the pores that does not flow"),
      OPTION_NUMBER("permeability", "m/s", OPTION_ABOVE_TO(0.0, 1.0), &s->permeability,
                    "of layers without one of their own; without any the ground is dry"),
      OPTION_NUMBER("porosity", "1", OPTION_FROM_TO(0.01, 0.95), &s->porosity,
                    "of layers without one of their own"),
      OPTION_NUMBER("water-bulk", "Pa", OPTION_FROM_TO(1e4, 1e11), &s->bulk,
                    "K_w, bulk modulus of the water"),
      OPTION_HEADING("Motion"),
      OPTION_TEXT("record", "ricker|sine|FILE", &s->record,
                  "a wavelet, cycles of a sine, or a recorded acceleration: " RECORD_FILES),
      OPTION_CHOICE("record-unit", RECORD_UNITS, &s->unit,
                    "unit of a record; file: what it says, m/s2 where it names none"),
      OPTION_NUMBER("record-step", "s", OPTION_DURATION, &s->step,
                    "between the values of a record without times; default by its header"),
      OPTION_TEXT("record-column", "NAME", &s->column, "of a record with several in its header"),
      OPTION_NUMBER("record-scale", "1", OPTION_FROM_TO(-1e6, 1e6), &s->scale,
                    "factor on a record"),
      OPTION_CHOICE("baseline", "linear|none|mean|quadratic|cubic", &s->baseline,
                    "baseline correction of a record"),
      OPTION_NUMBER("frequency", "Hz", OPTION_FROM_TO(0.01, 100.0), &s->frequency,
                    "of the wavelet or sine"),
      OPTION_NUMBER("amplitude", "m/s2", OPTION_FROM_TO(-100.0, 100.0), &s->amplitude,
                    "largest acceleration of the wavelet or sine"),
      OPTION_NUMBER("cycles", "1", OPTION_FROM_TO(1.0, 1000.0), &s->cycles,
                    "of the sine, after one that grows and before one that fades"),
      OPTION_HEADING("Grid"),
      OPTION_NUMBER("max-frequency", "Hz", OPTION_FROM_TO(0.1, 1000.0), &s->highest,
                    "highest that counts: twenty cells to its wave length in the softest layer"),
      COMMON_NUMBER("h", &s->h, "at most; default by --max-frequency"),
      COMMON_CHOICE("volumetric", &s->volumetric, "law: with water point"),
      COMMON_CHOICE("spline", &s->spline, NULL),
      OPTION_NUMBER(
          "flip-time", "s", OPTION_FROM_TO(0.0, 1e6), &s->flip_time,
          "time for which particles keep what the grid does not represent of their "
          "velocity; default the period of --max-frequency, 0 with saturated cyclic sand, which "
          "has noise with it once it has liquefied"),
      OPTION_NUMBER("mass-damping", "1/s", OPTION_FROM_TO(0.0, 1e3), &s->damping,
                    "viscous, of the motion relative to the input: a damping ratio of this over 4 "
                    "pi f"),
      OPTION_HEADING("Run"),
      COMMON_NUMBER("duration", &s->duration,
                    "default the record and twenty travel times of a shear wave"),
      COMMON_NUMBER("sample", &s->sample, NULL),
      OPTION_NUMBER("loop", "m", OPTION_FROM_TO(0.0, 1e4), &s->loop,
                    "depth of which loop.csv has strain and stress"),
      MPM_COURSE_OPTIONS(&s->course, SITE_SAMPLES),
      OPTION_OUT(&s->out),
      OPTION_THREADS(&s->threads),
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
