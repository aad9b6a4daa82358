/* settings.c - the options of mps-wave: table, checks.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "wave.h"

#include "common/options.h"
#include "common/record.h"
#include "common/resume.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char purpose[] =
    "Seismic wave through a soil column of particles (explicit MPS): by default a Ricker pulse "
    "rises\n"
    "through 100 m in about 1 s and doubles at the free surface, Yoshida, Figure 2.";

/* Of Figure 2. */
static const option_preset paper[] = {
    {"spacing", "1m"}, {"sides", "roller"}, {"dt", "0.1ms"}, {"damping-form", "particle"}, {0}};

/* ---- checks of combinations ------------------------------------------------------------------ */

static int check_ground(const options_program *program, settings *s) {
  char text[256];
  static const char *const by_file[] = {"vs", "vp", "unit-weight", "damping"};
  for (int i = 0; s->layers_file && i < 4; i++) {
    if (!options_given(program->table, by_file[i])) continue;
    snprintf(text, sizeof text, "--%s and --layers exclude each other", by_file[i]);
    return options_refuse(program, text);
  }
  if (!s->layers_file && !(s->vp * s->vp >= 2.0 * s->vs * s->vs)) {
    snprintf(text, sizeof text, "--vp is %g m/s, must be >= sqrt(2) times --vs: %.6g m/s", s->vp,
             sqrt(2.0) * s->vs);
    return options_refuse(program, text);
  }
  s->sloped = options_given(program->table, "incline");
  const double *p = s->slope;
  if (s->sloped && !(p[0] < p[1] && p[1] < s->width)) {
    snprintf(text, sizeof text,
             "--incline begins at %g m and ends at %g m, must be X1 < X2 < --width "
             "%g m",
             p[0], p[1], s->width);
    return options_refuse(program, text);
  }
  return -1;
}

static int check_rest(const options_program *program, settings *s) {
  const option *table = program->table;
  char text[256];
  static const char *const record[] = {"record-scale", "record-unit", "baseline", "record-step",
                                       "record-column"};
  static const char *const pulse[] = {"frequency", "peak-time", "acceleration"};
  s->ricker = strcmp(s->input, "ricker") == 0;
  for (int i = 0; i < (s->ricker ? 5 : 3); i++) {
    const char *name = s->ricker ? record[i] : pulse[i];
    if (!options_given(table, name)) continue;
    snprintf(text, sizeof text, "--%s is for %s only", name,
             s->ricker ? "--record FILE" : "--record ricker");
    return options_refuse(program, text);
  }
  static const char *const viscous[] = {"base-vs", "base-vp", "base-unit-weight"};
  for (int i = 0; s->base == BASE_RIGID && i < 3; i++) {
    if (!options_given(table, viscous[i])) continue;
    snprintf(text, sizeof text, "--%s is for --base viscous only", viscous[i]);
    return options_refuse(program, text);
  }
  if (options_given(table, "dt") && options_given(table, "courant"))
    return options_refuse(program, "--dt and --courant exclude each other");
  if (options_given(table, "courant")) s->dt = NAN;
  if (s->sloped && !options_given(table, "sides") && !s->paper) s->sides = SIDES_FREEFIELD;
  if (s->sloped && s->sides == SIDES_PERIODIC)
    return options_refuse(program, "--incline and --sides periodic exclude each other");
  return -1;
}

/* ---- the table ------------------------------------------------------------------------------- */

int settings_parse(settings *s, int argc, char **argv) {
  *s = (settings){.input = "ricker"};
  option table[] = {
      OPTION_HEADING("Ground"),
      OPTION_NUMBER("spacing", &s->spacing, NULL, 0.5),
      OPTION_NUMBER("width", &s->width, "of the model, rounded to whole particles", 10.0),
      OPTION_NUMBER("height", &s->height,
                    "of the model, rounded to whole particles; with --layers it may be left out",
                    100.0),
      OPTION_NUMBER("vs", &s->vs, NULL, 100.0),
      OPTION_NUMBER("vp", &s->vp, NULL, 200.0),
      OPTION_NUMBER("unit-weight", &s->unit_weight, NULL, 14.7e3),
      OPTION_NUMBER("damping", &s->damping, NULL),
      OPTION_NUMBER("f1", &s->f1, NULL, 1.0),
      OPTION_NUMBER("f2", &s->f2, NULL, 14.0),
      OPTION_TEXT("layers", &s->layers_file,
                  "thickness_m, vs_m_s, vp_m_s, unit_weight_kN_m3 or density_kg_m3, damping_ratio; "
                  "a last one of thickness inf is the half space"),
      OPTION_NUMBERS("incline", 3, s->slope, NULL, NAN),
      OPTION_HEADING("Input motion"),
      OPTION_CHOICE("wave", &s->wave, NULL),
      OPTION_TEXT_OF("record", "ricker|FILE", &s->input, NULL),
      OPTION_NUMBER("frequency", &s->frequency, NULL, 4.0),
      OPTION_NUMBER("peak-time", &s->peak_time, NULL, 0.25),
      OPTION_NUMBER("acceleration", &s->amplitude, NULL, 1.0),
      OPTION_NUMBER("record-scale", &s->scale, NULL, 1.0),
      OPTION_CHOICE("record-unit", &s->unit, NULL),
      OPTION_NUMBER("record-step", &s->step, NULL, NAN),
      OPTION_TEXT("record-column", &s->column, NULL),
      OPTION_CHOICE("baseline", &s->baseline, NULL, MPS_SIGNAL_BASELINE_LINEAR),
      OPTION_HEADING("Boundaries"),
      OPTION_CHOICE_OF("base", "rigid|viscous", &s->base,
                       "rigid: the base moves as the record (E+F); viscous: there is a half space "
                       "below, the record is the incoming wave (E)"),
      OPTION_NUMBER("base-vs", &s->half_space.vs, NULL, NAN),
      OPTION_NUMBER("base-vp", &s->half_space.vp, NULL, NAN),
      OPTION_NUMBER("base-unit-weight", &s->half_space.unit_weight, NULL, NAN),
      OPTION_CHOICE_OF("sides", "roller|periodic|freefield", &s->sides,
                       "rollers along the wave's motion, a model repeated sideways, or free-field "
                       "columns with dashpots; freefield with --incline where this is left out",
                       SIDES_PERIODIC),
      OPTION_HEADING("Method"),
      OPTION_FLAG("paper", &s->paper, NULL),
      OPTION_CHOICE("integrator", &s->integrator, NULL, MPS_DYNAMICS_INTEGRATOR_VERLET),
      OPTION_CHOICE("rotation", &s->rotation, NULL),
      OPTION_CHOICE("torque", &s->torque, NULL),
      OPTION_CHOICE("damping-form", &s->damping_form, NULL),
      OPTION_NUMBER("dt", &s->dt, "default by --courant", NAN),
      OPTION_NUMBER("courant", &s->courant, NULL, 0.9),
      OPTION_NUMBER("duration", &s->duration,
                    "default 2.5 s, of a record its length and two travel times", NAN),
      OPTION_HEADING("Running and results"),
      OPTION_INTEGER("receivers", &s->receivers, NULL, 11),
      OPTION_INTEGER("frames", &s->frames, NULL),
      RESUME_OPTIONS(&s->checkpoint, &s->every_checkpoint,
                     "default a tenth of the run; the end of the run writes one too", &s->restart),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {"mps-wave", purpose, table};
  int code = options_parse(&program, argc, argv);
  if (code < 0 && s->paper) code = options_prefer(&program, paper);
  if (code < 0) code = check_ground(&program, s);
  if (code < 0) code = check_rest(&program, s);
  if (s->layers_file && !options_given(table, "height")) s->height = NAN; /* that of the layers */
  if (s->width > 0.5 * s->spacing) options_whole("width", &s->width, "--spacing", s->spacing);
  if (s->height > 1.5 * s->spacing) options_whole("height", &s->height, "--spacing", s->spacing);
  return code;
}

/* ---- derived from the options ---------------------------------------------------------------- */

/* The height is known now. */
static bool check_size(app *a, const settings *s) {
  const double rows = s->height / s->spacing, columns = s->width / s->spacing;
  if (!(rows >= 1.5 && columns >= 0.5 && rows * columns < 1e8))
    return app_error(a,
                     "--spacing is %g m, must give at least 1 column of 2 particles in %g m x %g "
                     "m, and fewer than 1e8",
                     s->spacing, s->width, s->height);
  if (s->sloped && !(s->slope[2] < s->height))
    return app_error(a, "--incline falls to H2 = %g m, must be below the height %g m", s->slope[2],
                     s->height);
  return true;
}

bool settings_ground(app *a, settings *s) {
  layers *g = &s->ground;
  if (!s->layers_file) {
    g->count = 1;
    g->layer[0] = (layer){s->height, s->vs, s->vp, s->unit_weight, s->damping};
  } else {
    if (!layers_read(a, s->layers_file, g)) return false;
    const double sum = layers_thickness(g), spacing = s->spacing;
    const int64_t thin = layers_thin(g, spacing);
    if (thin >= 0)
      app_warn(a,
               "layer %lld of %s is %g m thick, thinner than the particles, %g m: the row or rows "
               "that it lies in have the mean stiffness; --spacing %g or less resolves it",
               (long long)thin + 1, s->layers_file, g->layer[thin].thickness, spacing,
               0.25 * g->layer[thin].thickness);
    if (isnan(s->height)) s->height = sum;
    if (fabs(sum - s->height) > 0.5 * s->spacing)
      return app_error(a,
                       "%s: the layers are %g m thick, the model is %g m high (--height): they "
                       "must agree within %g m",
                       s->layers_file, sum, s->height, 0.5 * s->spacing);
  }
  const bool half_space = g->below.thickness > 0.0;
  if (half_space && s->base == BASE_RIGID)
    return app_error(a, "%s: a half space, of thickness inf, which --base rigid does not have",
                     s->layers_file);
  const layer *lowest = half_space ? &g->below : &g->layer[g->count - 1];
  if (isnan(s->half_space.vs)) s->half_space.vs = lowest->vs;
  if (isnan(s->half_space.vp)) s->half_space.vp = lowest->vp;
  if (isnan(s->half_space.unit_weight)) s->half_space.unit_weight = lowest->unit_weight;
  return check_size(a, s);
}

bool settings_signal(app *a, const settings *s, mps_signal **out) {
  if (s->ricker)
    return app_check(
        a, mps_signal_create_ricker(a->context, s->frequency, s->peak_time, s->amplitude, out));
  mps_signal_record_def def = mps_signal_record_defaults();
  def.baseline = s->baseline;
  def.scale = s->scale;
  def.unit = record_units[s->unit];
  def.step = s->step, def.column = s->column;
  return app_check(a, record_read(a, "record", s->input, &def, out));
}

mps_dynamics_def settings_dynamics(const settings *s, double width) {
  mps_dynamics_def def = mps_dynamics_defaults();
  def.integrator = s->integrator;
  def.rotation = s->rotation;
  def.damping = s->damping_form;
  def.dt = s->dt;
  def.courant = s->courant;
  def.f1 = s->f1;
  def.f2 = s->f2;
  def.period_x = s->sides == SIDES_PERIODIC ? width : NAN;
  return def;
}

char settings_wave(const settings *s) { return s->wave == WAVE_S ? 'S' : 'P'; }
