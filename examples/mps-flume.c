/* mps-flume - a wave flume by moving particles: seas by spectrum, pistons that absorb, a wall,
 * caisson or dike that water passes, with the loads and discharges that a design asks for.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/options.h"
#include "common/units.h"
#include "flume/flume.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool is_whole(double length, double spacing) {
  return fabs(length / spacing - nearbyint(length / spacing)) < 1e-6 * (1.0 + length / spacing);
}

/* ---- options --------------------------------------------------------------------------------- */

/* Four gauges at unequal distances, the last a wave length before the end or the wall. */
static void place_gauges(flume *m) {
  static const double part[] = {0.0, 0.1, 0.27, 0.47};
  flume_settings *s = &m->s;
  const double last = fmax(s->length - m->wave_length, 0.5 * s->length);
  for (int k = 0; k < 4; k++) s->gauge[k] = last - (0.47 - part[k]) * m->wave_length;
  for (int k = 0; k < 4; k++) /* on the lattice, apart */
    s->gauge[k] = fmax(round(s->gauge[k] / s->spacing), k + 1.0) * s->spacing;
  for (int k = 1; k < 4; k++) s->gauge[k] = fmax(s->gauge[k], s->gauge[k - 1] + s->spacing);
}

static int check_wall(const options_program *program, const flume_settings *s) {
  if (flume_has_body(s) && s->wall != FLUME_PROFILE && s->crest < s->spacing)
    return options_refuse(program, "--crest must be at least --spacing");
  if (flume_has_body(s) && s->width < s->spacing)
    return options_refuse(program, "--width must be at least --spacing");
  if (s->absorb == FLUME_ZONE && s->wall != FLUME_OPEN_END)
    return options_refuse(program, "--absorb zone is a zone at the far end: it needs --wall none");
  for (int k = 1; k < s->points; k++)
    if (hypot(s->profile[k][0] - s->profile[k - 1][0], s->profile[k][1] - s->profile[k - 1][1]) <
        s->spacing)
      return options_refuse(program, "--profile must have its points at least --spacing apart");
  if (s->wall == FLUME_PROFILE && s->profile[s->points - 1][1] < s->depth + 2.0 * s->spacing)
    return options_refuse(program, "--profile must end at least 2 times --spacing above --depth");
  if (s->waves == FLUME_FILE && !s->file)
    return options_refuse(program, "--waves file needs --file");
  if (s->waves == FLUME_FOCUSED && (isnan(s->focus[0]) || isnan(s->focus[1])))
    return options_refuse(program, "--waves focused needs --focus X,T");
  return -1;
}

static int complete(const options_program *program, flume *m) {
  flume_settings *s = &m->s;
  if (isnan(s->spacing)) s->spacing = s->depth / 16.0;
  m->wave_length = 2.0 * WAVES_PI / waves_number(s->period, s->depth);
  if (isnan(s->length)) s->length = ceil(3.0 * m->wave_length / s->spacing) * s->spacing;
  if (isnan(s->ramp)) s->ramp = 2.0 * s->period;
  if (isnan(s->duration)) s->duration = 20.0 * s->period;
  if (isnan(s->sample)) s->sample = s->period / 60.0;
  if (isnan(s->repeat) && s->waves != FLUME_REGULAR)
    s->repeat = fmax(s->duration, 20.0 * s->period);
  if (s->depth < 5.0 * s->spacing)
    return options_refuse(program, "--depth must be at least 5 times --spacing");
  if (s->length < 10.0 * s->spacing)
    return options_refuse(program, "--length must be at least 10 times --spacing");
  if (s->length / s->spacing * s->depth / s->spacing > 2e6)
    return options_refuse(program, "--spacing gives more than 2 million particles");
  if (!is_whole(s->length, s->spacing) || !is_whole(s->depth, s->spacing))
    return options_refuse(program, "--length and --depth must be whole numbers of --spacing: else "
                                   "the water does not fill the flume");
  if (s->sample > s->duration || s->duration / s->sample > 1e6)
    return options_refuse(program,
                          "--sample must be between a millionth of --duration and all of it");
  if (s->sample > 0.1 * s->period)
    return options_refuse(program, "--sample must be at most a tenth of --period");
  if (m->gauges == 0) place_gauges(m), m->gauges = 4;
  for (int k = 0; k < m->gauges; k++)
    if (s->gauge[k] < 0.0 || s->gauge[k] > s->length)
      return options_refuse(program, "--gauge must be in the flume, 0 to --length");
  for (int k = 0; k < m->gauges; k++)
    for (int j = 0; j < k; j++)
      if (s->gauge[k] == s->gauge[j])
        return options_refuse(program, "--gauge has one station twice");
  if (!isnan(s->window[0]) && !(s->window[0] < s->window[1]))
    return options_refuse(program, "--window must be two times, the first before the second");
  return check_wall(program, s);
}

static bool read_lengths(const char *text, int most, double *value, int *count) {
  for (*count = 0; text; (*count)++) {
    char number[64];
    const size_t length = strcspn(text, ",");
    if (*count == most || length >= sizeof number) return false;
    memcpy(number, text, length);
    number[length] = '\0';
    if (units_read(number, "m", &value[*count]) != UNITS_GOOD) return false;
    text = text[length] ? text + length + 1 : NULL;
  }
  return true;
}

/* Pairs of lengths; X does not fall, and no point is twice. */
static bool read_profile(const char *text, flume_settings *s) {
  double value[2 * FLUME_POINTS];
  int count = 0;
  if (!text) return s->wall != FLUME_PROFILE;
  if (!read_lengths(text, 2 * FLUME_POINTS, value, &count) || count % 2 || count < 6) return false;
  s->points = count / 2;
  for (int k = 0; k < s->points; k++) {
    const double x = value[2 * k], y = value[2 * k + 1];
    const double *last = k ? s->profile[k - 1] : NULL;
    if (k == 0 ? x != 0.0 || y != 0.0 : x < last[0] || y < 0.0 || (x == last[0] && y == last[1]))
      return false;
    s->profile[k][0] = x, s->profile[k][1] = y;
  }
  return value[2 * s->points - 2] > 0.0 && value[2 * s->points - 1] > 0.0;
}

/* ---- the program ----------------------------------------------------------------------------- */

static mps_status prepare(app *a, flume *m) {
  mps_status status = m->s.restart ? flume_peek(a->context, m) : MPS_OK;
  if (status == MPS_OK) status = app_settle(a, flume_build(a, m));
  if (status == MPS_OK && m->s.restart) status = flume_restore(a->context, m);
  return app_settle(a, status);
}

static void describe(const flume *m) {
  mps_waves_report r;
  double R;
  if (mps_waves_get_report(m->waves, &r) != MPS_OK) return;
  printf(
      "%lld components, wave length %.3f m at %.3f s; the maker moves %.3f to %.3f m, at most %.3f "
      "m/s\n",
      (long long)r.components, m->wave_length, r.period, r.stroke[0], r.stroke[1], r.speed);
  if (m->maker && mps_absorber_get_reflection(m->maker, m->s.period, &R) == MPS_OK)
    printf("an absorbing piston reflects %.3f of waves of that period, by linear theory\n", R);
  printf("%lld particles, dt %.4g s\n", (long long)mps_particles_count(m->water),
         mps_fluid_dt(m->fluid));
  fflush(stdout);
}

static int run(app *a, flume *m) {
  if (!app_agree(a, resume_places(a, m->s.restart, &m->s.checkpoint, &m->s.out) &&
                        (a->rank > 0 || output_directory(a, m->s.out))))
    return APP_FAILED;
  m->a = a;
  m->saves = (resume_schedule){
      .path = m->s.checkpoint, .every = m->s.every_checkpoint, .save = flume_save, .user = m};
  if (!app_agree(a, a->rank > 0 || summary_reserve(a, m->s.out))) return APP_FAILED;
  app_leave_at_once(a, !a->domain); /* no hook reaches into building */
  mps_status status = flume_make_waves(a, m);
  if (status == MPS_OK) status = prepare(a, m);
  app_leave_at_once(a, false);
  if (status != MPS_OK && m->why[0]) return app_error(a, "%s", m->why), APP_FAILED;
  if (status != MPS_OK) return app_end_run(a, status, 0.0, false);
  if (m->s.height < 3.0 * m->s.spacing && m->s.waves != FLUME_FILE)
    app_warn(a, "the waves, %.3g m high, are lower than 3 spacings of %g m: they will lose height",
             m->s.height, m->s.spacing);
  describe(m);
  status = app_settle(a, flume_run(a, m));
  const int code = app_end_run(a, status, mps_fluid_time(m->fluid), m->samples > 0);
  if (status == MPS_ERROR_CANCELLED) resume_tell(&m->saves);
  if (m->samples == 0)
    return code == APP_INTERRUPTED && a->rank == 0 && !summary_bare(a, m->s.out) ? APP_FAILED
                                                                                 : code;
  if (!app_agree(a, a->rank > 0 || flume_write(a, m))) return APP_FAILED;
  return m->saves.lost && code == APP_OK ? APP_FAILED : code;
}

static const flume_settings defaults = {.depth = 0.4,
                                        .length = NAN,
                                        .spacing = NAN,
                                        .tolerance = WAVES_TOLERANCE,
                                        .height = 0.08,
                                        .period = 1.4,
                                        .gamma = 3.3,
                                        .repeat = NAN,
                                        .ramp = NAN,
                                        .focus = {NAN, NAN},
                                        .stroke = NAN,
                                        .speed = NAN,
                                        .zone = 1.0,
                                        .rate = 10.0,
                                        .crest = 0.1,
                                        .cotangent = 2.0,
                                        .width = 0.2,
                                        .density = 2300.0,
                                        .friction = 0.6,
                                        .duration = NAN,
                                        .sample = NAN,
                                        .disturb = 0.05,
                                        .window = {NAN, NAN},
                                        .seed = 1,
                                        .every_checkpoint = 5.0,
                                        .frames = 60,
                                        .out = "out/flume"};

int main(int argc, char **argv) {
  static flume m;
  flume_settings *s = &m.s;
  m.s = defaults;
  const char *gauges = NULL, *profile = NULL;
  option table[] = {
      OPTION_HEADING("Waves"),
      OPTION_CHOICE(
          "waves", "regular|jonswap|pm|focused|file", &s->waves,
          "one wave; seas by a spectrum of JONSWAP or Pierson and Moskowitz; a group whose "
          "crests come together at --focus; the level in a file"),
      OPTION_NUMBER("height", "m", OPTION_LENGTH, &s->height,
                    "of regular waves, Hm0 of a sea, of a focused group twice its linear crest"),
      OPTION_NUMBER("period", "s", OPTION_DURATION, &s->period,
                    "of the waves, of the peak of a spectrum"),
      OPTION_NUMBER("gamma", "1", OPTION_FROM_TO(1.0, 20.0), &s->gamma, "peak of JONSWAP"),
      OPTION_NUMBER("repeat", "s", OPTION_DURATION, &s->repeat,
                    "the sea repeats itself (default: the duration, at least 20 periods)"),
      OPTION_INTEGER("seed", "N", OPTION_FROM_TO(0.0, 1e9), &s->seed, "of phases and amplitudes"),
      OPTION_CHOICE("random", "phases|amplitudes", &s->random, "of the components of a sea"),
      {.name = "focus",
       .unit = "m",
       .range = OPTION_FROM_TO(0.0, 1e6),
       .count = 2,
       .number = s->focus,
       .help = "X,T: station (m) and time (s) of the focus"},
      OPTION_TEXT("file", "FILE", &s->file, "time (s) and level (m) in two columns, at x = 0"),
      OPTION_CHOICE("order", "second|linear|narrow", &s->order,
                    "theory of the maker: sums and differences of all pairs of components; linear; "
                    "differences alone, as of a narrow band"),
      COMMON_NUMBER("ramp", &s->ramp, "default 2 periods"),
      OPTION_NUMBER("stroke", "m", OPTION_LENGTH, &s->stroke,
                    "farthest position of the maker: waves that need more are refused"),
      OPTION_NUMBER("speed", "m/s", OPTION_SPEED, &s->speed,
                    "highest speed of the maker, likewise"),
      OPTION_HEADING("Flume"),
      COMMON_NUMBER("depth", &s->depth, "of the water"),
      COMMON_NUMBER(
          "length", &s->length,
          "from the maker to the far end or the toe of the wall (default 3 wave lengths)"),
      OPTION_CHOICE(
          "absorb", "active|zone|none", &s->absorb,
          "the maker, and without a wall the far end, follow the level at their face; waves "
          "fade in a zone before the far end; neither"),
      OPTION_CHOICE("form", "tuned|shallow", &s->form,
                    "active absorption: complete at --period, or for long waves"),
      OPTION_NUMBER("zone", "wave lengths", OPTION_FROM_TO(0.1, 100.0), &s->zone,
                    "length of the zone"),
      OPTION_NUMBER("zone-rate", "1/periods", OPTION_FROM_TO(0.0, 1000.0), &s->rate,
                    "rate at its end"),
      OPTION_CHOICE("wall", "none|vertical|caisson|slope|profile", &s->wall,
                    "at the far end; caisson and slope (a dike) end at --crest, a profile where it "
                    "ends, and water that "
                    "passes them falls behind and leaves"),
      OPTION_NUMBER("crest", "m", OPTION_LENGTH, &s->crest, "above the water at rest"),
      OPTION_NUMBER("slope", "1", OPTION_FROM_TO(0.1, 100.0), &s->cotangent,
                    "cotangent of the dike's face"),
      OPTION_NUMBER("width", "m", OPTION_LENGTH, &s->width, "of the crest"),
      OPTION_TEXT(
          "profile", "m,...", &profile,
          "X,Y,X,Y,...: the face from the toe 0,0 over slopes, berms and crest to its rear edge, "
          "distance from the toe and height above the bed"),
      OPTION_NUMBER("wall-density", "kg/m3", OPTION_DENSITY, &s->density,
                    "of the caisson, for its safeties"),
      COMMON_NUMBER_IN("friction", OPTION_FROM_TO(1e-3, 10.0), &s->friction, "below the caisson"),
      OPTION_HEADING("Particles"),
      COMMON_NUMBER("spacing", &s->spacing, "default a sixteenth of the depth"),
      COMMON_NUMBER("disturb", &s->disturb, NULL),
      WAVES_SOLVER(&s->solver, &s->tolerance),
      OPTION_HEADING("Run"),
      COMMON_NUMBER("duration", &s->duration, "default 20 periods"),
      COMMON_NUMBER("sample", &s->sample, "default a sixtieth of the period"),
      OPTION_TEXT(
          "gauge", "m,...", &gauges,
          "stations of level gauges, at most 16; incident and reflected waves follow from all of "
          "them (default: four, up to a wave length before the end)"),
      {.name = "window",
       .unit = "s",
       .range = OPTION_FROM_TO(0.0, 1e6),
       .count = 2,
       .number = s->window,
       .help = "two times T1,T2: of the analysis (default: from when waves have been to the wall "
               "and half "
               "the way back)"},
      COMMON_INTEGER("frames", &s->frames, NULL),
      RESUME_OPTIONS(&s->checkpoint, &s->every_checkpoint, NULL, &s->restart),
      OPTION_OUT(&s->out),
      OPTION_THREADS(&s->threads),
      {0}};
  const options_program program = {
      "mps-flume", "A wave flume by moving particles (MPS): seas, absorption, loads, overtopping.",
      table};
  int code = options_parse(&program, argc, argv);
  if (code < 0 && !read_lengths(gauges, FLUME_GAUGES, s->gauge, &m.gauges))
    code = options_refuse(&program, "--gauge must be at most 16 lengths in m separated by commas");
  if (code < 0 && !read_profile(profile, s))
    code = options_refuse(&program,
                          "--profile must be 3 to 64 points X,Y in m separated by commas, the "
                          "first 0,0, X not falling, Y not below 0, no point twice");
  if (code < 0) code = complete(&program, &m);
  if (code >= 0) return code;
  app a;
  if (!app_start(&a, program.name, s->threads)) return app_finish(&a, APP_FAILED);
  m.table = table;
  code = run(&a, &m);
  if (code == APP_FAILED) app_agree(&a, false); /* all ranks know */
  flume_free(&m);
  return app_finish(&a, code);
}
