/* mps-tank - water in a tank by moving particles against theory: at rest, sloshing, waves of a
 * piston, against structures that move with it, and a drop without walls.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/options.h"
#include "common/units.h"
#include "tank/tank.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The water fills the tank, and is in contact with the box in its middle. */
static void round_sizes(tank_settings *s) {
  const double h = s->spacing;
  const bool plate = s->kind == TANK_PLATE;
  options_whole(plate ? "plate-length" : "length", &s->length, "--spacing", h);
  options_whole("depth", &s->depth, "--spacing", h);
  if (plate) s->plate_length = s->length;
  if (s->kind != TANK_FLOAT) return;
  options_whole("draft", &s->draft, "--spacing", h);
  double gaps = s->length - s->width; /* two equal ones */
  const double given = s->width, pair = fmax(nearbyint(gaps / (2.0 * h)), 0.0);
  if (fabs(gaps - 2.0 * h * pair) <= 1e-5 * h) return;
  s->width = s->length - 2.0 * h * pair;
  options_note("--width is %.6g m, taken as %.6g m: whole spacings beside the box", given,
               s->width);
}

/* Options of other cases than the one that is computed. */
static int check_needs(const options_program *program, const tank_settings *s) {
  const int kind = s->kind;
  const bool piston = kind == TANK_PISTON, resonance = kind == TANK_RESONANCE;
  const bool spring = kind == TANK_SPRING, box = kind == TANK_FLOAT, plate = kind == TANK_PLATE;
  const bool moves = kind == TANK_SLOSHING || piston || spring || resonance || box;
  const options_need list[] = {
      {"length", "--case other than plate and drop, of the plate --plate-length",
       !plate && kind != TANK_DROP},
      {"amplitude", "--case sloshing, piston, spring, resonance or float", moves},
      {"period", "--case piston or resonance", piston || resonance},
      {"ramp", "--case piston or resonance", piston || resonance},
      {"mass", "--case spring or resonance", spring || resonance},
      {"stiffness", "--case spring or resonance", spring || resonance},
      {"frequency-ratio", "--case resonance without --stiffness",
       resonance && !options_given(program->table, "stiffness")},
      {"width", "--case float", box},
      {"draft", "--case float", box},
      {"plate-length", "--case plate", plate},
      {"plate-thickness", "--case plate", plate},
      {"young", "--case plate", plate},
      {"poisson", "--case plate", plate},
      {"plate-density", "--case plate", plate},
      {"gauge", "--case other than drop", kind != TANK_DROP},
      {"window", "--case other than drop", kind != TANK_DROP}};
  return options_check_needs(program, list, sizeof list / sizeof *list);
}

/* Defaults that depend on the case. Returns -1, or an exit code. */
static int complete(const options_program *program, tank_settings *s) {
  static const struct {
    double length, depth, amplitude, duration, dt;
  } usual[TANK_KINDS] = {{0.6, 0.3, 0.0, 4.0, NAN},   {0.7, 0.3, 0.01, 5.2, NAN},
                         {1.6, 0.3, 0.02, 6.0, NAN},  {0.6, 0.3, 0.001, 1.0, 5e-4},
                         {1.0, 2.0, 0.0, 0.25, 2e-4}, {0.0, 1.0, 0.0, 1.0, NAN},
                         {3.0, 0.3, 0.01, 9.0, NAN},  {0.8, 0.4, 0.005, 4.0, NAN}};
  const int kind = s->kind;
  const bool given_amplitude = !isnan(s->amplitude);
  const int unused = check_needs(program, s);
  if (unused >= 0) return unused;
  if (kind == TANK_PLATE) s->length = s->plate_length;
  if (isnan(s->length)) s->length = usual[kind].length;
  if (isnan(s->depth)) s->depth = usual[kind].depth;
  if (isnan(s->spacing))
    s->spacing = kind == TANK_DROP        ? s->depth / 20.0
                 : kind == TANK_PLATE     ? 0.05
                 : kind == TANK_RESONANCE ? 0.015
                                          : 0.02;
  if (kind != TANK_DROP) round_sizes(s);
  if (isnan(s->duration)) s->duration = usual[kind].duration;
  if (isnan(s->dt)) s->dt = kind == TANK_DROP ? 0.05 * s->spacing / s->depth : usual[kind].dt;
  if (isnan(s->sample))
    s->sample =
        fmin(tank_is_coupled(s) && s->kind != TANK_RESONANCE ? s->dt : 0.01, s->duration / 50.0);
  if (isnan(s->window[1])) s->window[1] = s->duration;
  const bool waves = kind == TANK_PISTON || kind == TANK_RESONANCE;
  const double last = waves ? 4.0 * s->period : (kind == TANK_STILL ? 0.5 : 1.0) * s->duration;
  if (isnan(s->mass)) s->mass = kind == TANK_RESONANCE ? 100.0 : 10.0;
  if (isnan(s->stiffness))
    s->stiffness = kind == TANK_RESONANCE ? tank_resonant_stiffness(s, s->ratio) : 211800.0;
  if (isnan(s->amplitude)) s->amplitude = usual[kind].amplitude;
  if (isnan(s->disturb)) /* a drop's lattice would be stretched until it buckles */
    s->disturb = kind == TANK_DROP ? 0.1 : 0.0;
  if (kind == TANK_SPRING && !given_amplitude) /* otherwise the water would need tension */
    s->amplitude = fmin(s->amplitude, 0.4 * WAVES_G / pow(tank_spring_omega(s), 2.0));
  if (isnan(s->window[0])) s->window[0] = fmax(s->duration - last, 0.0);
  if (s->scheme == 1 && (tank_is_coupled(s) || s->viscosity > 0.0))
    return options_refuse(program, "--method classical has no coupling and no --viscosity");
  if (s->depth < 5.0 * s->spacing)
    return options_refuse(program, "--depth must be at least 5 times --spacing");
  if (s->kind != TANK_DROP && s->length < 5.0 * s->spacing)
    return options_refuse(program, "--length must be at least 5 times --spacing");
  if (s->kind != TANK_DROP && s->length / s->spacing * s->depth / s->spacing > 2e6)
    return options_refuse(program, "--spacing gives more than 2 million particles");
  if (s->kind != TANK_DROP && 4.0 * fabs(s->amplitude) > s->length)
    return options_refuse(program, "--amplitude must be at most a quarter of the length");
  for (int k = 0; k < TANK_GAUGES && kind != TANK_DROP; k++)
    if (s->gauge[k] < 0.0 || s->gauge[k] > s->length)
      return options_refuse(program, "--gauge must be in the tank, 0 to --length");
  if (kind == TANK_FLOAT) {
    const double gap = 0.5 * (s->length - s->width), h = s->spacing;
    if (s->width < 1.999 * h)
      return options_refuse(program, "--width must be at least 2 times --spacing");
    if (!(gap > 4.999 * h && s->draft > 1.999 * h && s->depth - s->draft > 4.999 * h))
      return options_refuse(program, "--width and --draft must leave at least 5 spacings of water "
                                     "beside and below the box, and --draft be at least 2");
    if (4.0 * fabs(s->amplitude) > s->draft)
      return options_refuse(program, "--amplitude must be at most a quarter of --draft");
    if (s->scheme == 1) return options_refuse(program, "--method classical has no bodies");
  }
  if (s->sample > s->duration || s->duration / s->sample > 1e6)
    return options_refuse(program,
                          "--sample must be between a millionth of --duration and all of it");
  const double reach = tank_density_reach(s);
  if (!isnan(s->density_at) && kind == TANK_DROP)
    return options_refuse(program, "--density-at is for water in a tank");
  if (s->density_at < reach || s->density_at > s->length - reach)
    return options_refuse(program, "--density-at must be at least 4 spacings from both walls");
  if (!(s->window[0] < s->window[1]))
    return options_refuse(program, "--window must be two times, the first before the second");
  if (kind != TANK_DROP && !(s->window[0] < s->duration))
    return options_refuse(program, "--window must begin before the end of the run, --duration");
  return -1;
}

static bool read_gauges(const char *text, double *gauge) {
  for (int k = 0; text; k++) {
    char number[64];
    const size_t length = strcspn(text, ",");
    if (k == TANK_GAUGES || length >= sizeof number) return false;
    memcpy(number, text, length);
    number[length] = '\0';
    if (units_read(number, "m", &gauge[k]) != UNITS_GOOD) return false;
    text = text[length] ? text + length + 1 : NULL;
  }
  return true;
}

static mps_status prepare(app *a, tank_model *m) {
  const tank_settings *s = &m->s;
  mps_status status = s->restart ? tank_peek(a->context, m) : MPS_OK;
  if (status == MPS_OK) status = app_settle(a, tank_build(a, m));
  if (status == MPS_OK && s->restart) status = tank_restore(a->context, m);
  return app_settle(a, status);
}

static int run(app *a, tank_model *m) {
  if (!app_agree(a, resume_places(a, m->s.restart, &m->s.checkpoint, &m->s.out) &&
                        (a->rank > 0 || output_directory(a, m->s.out))))
    return APP_FAILED;
  m->a = a;
  m->saves = (resume_schedule){
      .path = m->s.checkpoint, .every = m->s.every_checkpoint, .save = tank_save, .user = m};
  if ((m->s.kind == TANK_PISTON || m->s.kind == TANK_RESONANCE) &&
      !app_agree(
          a, waves_check(a, m->s.period, m->s.depth, m->s.amplitude, m->s.spacing, m->s.length)))
    return APP_FAILED;
  if (!app_agree(a, a->rank > 0 || summary_reserve(a, m->s.out))) return APP_FAILED;
  app_leave_at_once(a, !a->domain); /* no hook reaches into building */
  mps_status status = prepare(a, m);
  app_leave_at_once(a, false);
  if (status != MPS_OK && m->why[0]) return app_error(a, "%s", m->why), APP_FAILED;
  if (status != MPS_OK) return app_end_run(a, status, 0.0, false);
  printf("%lld particles, dt %.4g s\n", (long long)mps_particles_count(m->water),
         mps_fluid_dt(m->fluid));
  fflush(stdout);
  if (m->s.kind == TANK_SPRING || m->s.kind == TANK_RESONANCE)
    waves_warn_of_step(a, tank_spring_omega(&m->s), mps_fluid_dt(m->fluid));
  if (m->s.kind == TANK_PLATE)
    waves_warn_of_step(a, tank_plate_omega(&m->s), mps_fluid_dt(m->fluid));
  status = app_settle(a, tank_run(a, m));
  const int code = app_end_run(a, status, mps_fluid_time(m->fluid), m->samples > 0);
  if (status == MPS_ERROR_CANCELLED) resume_tell(&m->saves);
  if (m->samples == 0)
    return code == APP_INTERRUPTED && a->rank == 0 && !summary_bare(a, m->s.out) ? APP_FAILED
                                                                                 : code;
  if (!app_agree(a, a->rank > 0 || tank_write(a, m))) return APP_FAILED;
  return m->saves.lost && code == APP_OK ? APP_FAILED : code;
}

int main(int argc, char **argv) {
  static tank_model m = {.s = {.kind = TANK_PISTON,
                               .length = NAN,
                               .depth = NAN,
                               .spacing = NAN,
                               .amplitude = NAN,
                               .disturb = NAN,
                               .period = 1.0,
                               .ramp = 1.0,
                               .duration = NAN,
                               .sample = NAN,
                               .mass = NAN,
                               .stiffness = NAN,
                               .ratio = 1.0,
                               .tolerance = WAVES_TOLERANCE,
                               .width = 0.4,
                               .draft = 0.1,
                               .plate_length = 1.0,
                               .plate_thickness = 0.05,
                               .young = 67.5e9,
                               .poisson = 0.34,
                               .plate_density = 2700.0,
                               .dt = NAN,
                               .gauge = {NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN},
                               .window = {NAN, NAN},
                               .density_at = NAN,
                               .every_checkpoint = 1.0,
                               .frames = 60,
                               .out = "out/tank"}};
  tank_settings *s = &m.s;
  const char *gauges = NULL;
  option table[] = {
      OPTION_HEADING("Case"),
      OPTION_CHOICE_OF(
          "case", "still|sloshing|piston|spring|plate|drop|resonance|float", &s->kind,
          "water at rest; first mode of sloshing; waves of a piston in a closed tank; an end wall "
          "on a spring, let go --amplitude off its rest; a column of water on a clamped plate; an "
          "elliptic drop of radius --depth without gravity; an end wall on a spring that waves of "
          "a piston swing; a box that floats in the middle, and heaves from the moment that a "
          "weight is put on it"),
      OPTION_NUMBER("length", &s->length,
                    "of the tank (default .6, .7, 1.6, .6, of resonance 3, of float .8 m; on a "
                    "plate, the plate's)"),
      OPTION_NUMBER("depth", &s->depth,
                    "of the water (default .3, on a plate 2, of float .4 m), or the drop's radius "
                    "(default 1 m)"),
      OPTION_NUMBER("amplitude", &s->amplitude,
                    "of the sloshing at the walls (default 10 mm), of the piston (20 mm, of "
                    "resonance 10 mm), of the wall on the spring (1 mm, less where its "
                    "acceleration would exceed .4 g), of the box (5 mm)"),
      OPTION_NUMBER("period", &s->period, NULL),
      OPTION_NUMBER("ramp", &s->ramp, NULL),
      OPTION_NUMBER("viscosity", &s->viscosity, NULL),
      OPTION_HEADING("Structures, of 1 m across"),
      OPTION_NUMBER("mass", &s->mass, NULL),
      OPTION_NUMBER("stiffness", &s->stiffness, NULL),
      OPTION_NUMBER("frequency-ratio", &s->ratio, NULL),
      OPTION_NUMBER("width", &s->width, "of the box that floats"),
      OPTION_NUMBER("draft", &s->draft, NULL),
      OPTION_NUMBER("plate-length", &s->plate_length, NULL),
      OPTION_NUMBER("plate-thickness", &s->plate_thickness, NULL),
      OPTION_NUMBER("young", &s->young, "of the plate"),
      OPTION_NUMBER_IN("poisson", OPTION_FROM_TO(0.0, 0.499), &s->poisson, "of the plate"),
      OPTION_NUMBER("plate-density", &s->plate_density, NULL),
      OPTION_HEADING("Particles"),
      OPTION_NUMBER("spacing", &s->spacing,
                    "default .02, on a plate .05 m, of a drop a twentieth of its radius"),
      OPTION_NUMBER("disturb", &s->disturb, "default 0, of a drop .1"),
      OPTION_CHOICE_OF(
          "method", "modern|classical", &s->scheme,
          "the library's; the first one of MPS, for comparison: noisy pressures, no levels"),
      WAVES_SOLVER(&s->solver, &s->tolerance),
      OPTION_HEADING("Run"),
      OPTION_NUMBER("duration", &s->duration,
                    "to the first step that reaches it; default 4, 5.2, 6, 1, .25, 1, 9, 4 s"),
      OPTION_NUMBER("dt", &s->dt, "default the library's; spring 5e-4, plate 2e-4 s"),
      OPTION_NUMBER("sample", &s->sample, "default .01 s; of structures --dt"),
      OPTION_TEXT("gauge", &gauges, "at most 8"),
      OPTION_NUMBERS("window", 2, s->window,
                     "default the last 4 periods of a piston, half the run at rest, else all"),
      OPTION_NUMBER("density-at", &s->density_at, NULL),
      OPTION_INTEGER("frames", &s->frames, NULL),
      RESUME_OPTIONS(&s->checkpoint, &s->every_checkpoint, NULL, &s->restart),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {"mps-tank",
                                   "Water in a tank by moving particles (MPS), against theory: "
                                   "forces on the walls, levels, pressures.",
                                   table};
  int code = options_parse(&program, argc, argv);
  if (code < 0 && !read_gauges(gauges, s->gauge))
    code = options_refuse(&program, "--gauge must be at most 8 lengths in m separated by commas");
  if (code < 0) code = complete(&program, s);
  if (code >= 0) return code;
  app a;
  if (!app_start(&a, program.name, s->threads)) return app_finish(&a, APP_FAILED);
  m.table = table;
  code = run(&a, &m);
  if (code == APP_FAILED) app_agree(&a, false); /* all ranks know */
  tank_free(&m);
  return app_finish(&a, code);
}
