/* options.c - the options of mps-flume, and the model that they and the model file make.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/options.h"
#include "common/units.h"

#include <math.h>
#include <string.h>

static flume model = {.s = {.depth = 0.4,
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
                            .rock = {.porosity = 0.45,
                                     .diameter = NAN,
                                     .alpha = 1000.0,
                                     .beta = 1.1,
                                     .KC = NAN,
                                     .gamma = 0.34},
                            .out = "out/flume"}};

static option table[] = {
    OPTION_HEADING("Waves"),
    OPTION_CHOICE("waves", "regular|jonswap|pm|focused|file", &model.s.waves,
                  "one wave; seas by a spectrum of JONSWAP or Pierson and Moskowitz; a group whose "
                  "crests come together at --focus; the level in a file"),
    OPTION_NUMBER("height", "m", OPTION_LENGTH, &model.s.height,
                  "of regular waves, Hm0 of a sea, of a focused group twice its linear crest"),
    OPTION_NUMBER("period", "s", OPTION_DURATION, &model.s.period,
                  "of the waves, of the peak of a spectrum"),
    OPTION_NUMBER("gamma", "1", OPTION_FROM_TO(1.0, 20.0), &model.s.gamma, "peak of JONSWAP"),
    OPTION_NUMBER("repeat", "s", OPTION_DURATION, &model.s.repeat,
                  "the sea repeats itself (default: the duration, at least 20 periods)"),
    OPTION_INTEGER("seed", "N", OPTION_FROM_TO(0.0, 1e9), &model.s.seed,
                   "of phases and amplitudes"),
    OPTION_CHOICE("random", "phases|amplitudes", &model.s.random, "of the components of a sea"),
    {.name = "focus",
     .unit = "m",
     .range = OPTION_FROM_TO(0.0, 1e6),
     .count = 2,
     .number = model.s.focus,
     .help = "X,T: station (m) and time (s) of the focus"},
    OPTION_TEXT(
        "file", "FILE", &model.s.file,
        "level at x = 0: columns whose header names time, level and units; s and m without"),
    OPTION_TEXT("file-column", "NAME", &model.s.column, "of a file with several gauges"),
    OPTION_CHOICE("order", "second|linear|narrow", &model.s.order,
                  "theory of the maker: sums and differences of all pairs of components; linear; "
                  "differences alone, as of a narrow band"),
    COMMON_NUMBER("ramp", &model.s.ramp, "default 2 periods"),
    OPTION_NUMBER("stroke", "m", OPTION_LENGTH, &model.s.stroke,
                  "farthest position of the maker: waves that need more are refused"),
    OPTION_NUMBER("speed", "m/s", OPTION_SPEED, &model.s.speed,
                  "highest speed of the maker, likewise"),
    OPTION_HEADING("Flume"),
    COMMON_NUMBER("depth", &model.s.depth, "of the water"),
    COMMON_NUMBER("length", &model.s.length,
                  "from the maker to the far end or the toe of the wall (default 3 wave lengths)"),
    OPTION_CHOICE(
        "absorb", "active|zone|none", &model.s.absorb,
        "the maker, and without a wall the far end, follow the level at their face; waves "
        "fade in a zone before the far end; neither"),
    OPTION_CHOICE("form", "tuned|shallow", &model.s.form,
                  "active absorption: complete at --period, or for long waves"),
    OPTION_NUMBER("zone", "wave lengths", OPTION_FROM_TO(0.1, 100.0), &model.s.zone,
                  "length of the zone"),
    OPTION_NUMBER("zone-rate", "1/periods", OPTION_FROM_TO(0.0, 1000.0), &model.s.rate,
                  "rate at its end"),
    OPTION_CHOICE("wall", "none|vertical|caisson|slope|profile", &model.s.wall,
                  "at the far end; caisson and slope (a dike) end at --crest, a profile where it "
                  "ends, and water that "
                  "passes them falls behind and leaves"),
    OPTION_NUMBER("crest", "m", OPTION_LENGTH, &model.s.crest, "above the water at rest"),
    OPTION_NUMBER("slope", "1", OPTION_FROM_TO(0.1, 100.0), &model.s.cotangent,
                  "cotangent of the dike's face"),
    OPTION_NUMBER("width", "m", OPTION_LENGTH, &model.s.width, "of the crest"),
    OPTION_TEXT(
        "profile", "m,...", &model.s.profile,
        "X,Y,X,Y,...: the face from the toe 0,0 over slopes, berms and crest to its rear edge, "
        "distance from the toe and height above the bed"),
    OPTION_NUMBER("wall-density", "kg/m3", OPTION_DENSITY, &model.s.density,
                  "of the caisson, for its safeties"),
    COMMON_NUMBER_IN("friction", OPTION_FROM_TO(1e-3, 10.0), &model.s.friction,
                     "below the caisson"),
    OPTION_CHOICE(
        "end", "open|closed", &model.s.closed,
        "behind a structure: water leaves there, or the flume continues to --length with an "
        "end as without a structure"),
    OPTION_CHOICE("passed", "returns|leaves", &model.s.leaves,
                  "water that has passed the crest returns to the surface near the maker within "
                  "some two periods, so that the mean level stays; or the flume loses it"),
    OPTION_TEXT("rock", "m,...", &model.s.rocks,
                "X,Y,X,Y,...: corners of a region of rock, from the maker and above the bed"),
    OPTION_NUMBER("porosity", "1", OPTION_FROM_TO(0.1, 1.0), &model.s.rock.porosity, "of rock"),
    OPTION_NUMBER("stone", "m", OPTION_FROM_TO(1e-6, 100.0), &model.s.rock.diameter,
                  "median diameter D50 of its stones"),
    OPTION_NUMBER("alpha", "1", OPTION_FROM_TO(0.0, 1e6), &model.s.rock.alpha,
                  "of its resistance to slow flow (Darcy)"),
    OPTION_NUMBER("beta", "1", OPTION_FROM_TO(0.0, 1e3), &model.s.rock.beta,
                  "of its resistance to fast flow (Forchheimer)"),
    OPTION_TEXT("model", "FILE", &model.s.model,
                "bed, structure, caisson, rock, probes and any of these options in a text file "
                "(YAML); options on the command line count more"),
    OPTION_HEADING("Particles"),
    COMMON_NUMBER("spacing", &model.s.spacing, "default a sixteenth of the depth"),
    COMMON_NUMBER("disturb", &model.s.disturb, NULL),
    WAVES_SOLVER(&model.s.solver, &model.s.tolerance),
    OPTION_HEADING("Run"),
    COMMON_NUMBER("duration", &model.s.duration, "default 20 periods"),
    COMMON_NUMBER("sample", &model.s.sample, "default a sixtieth of the period"),
    OPTION_TEXT(
        "gauge", "m,...", &model.s.gauges,
        "stations of level gauges, at most 16; incident and reflected waves follow from all of "
        "them (default: four, up to a wave length before the end)"),
    {.name = "window",
     .unit = "s",
     .range = OPTION_FROM_TO(0.0, 1e6),
     .count = 2,
     .number = model.s.window,
     .help = "two times T1,T2: of the analysis (default: from when waves have been to the wall "
             "and half "
             "the way back)"},
    COMMON_INTEGER("frames", &model.s.frames, NULL),
    OPTION_INTEGER("animation", "N", OPTION_FROM_TO(0.0, 400.0), &model.s.animation,
                   "frames of an animation of the last three periods (0: none)"),
    RESUME_OPTIONS(&model.s.checkpoint, &model.s.every_checkpoint, NULL, &model.s.restart),
    OPTION_OUT(&model.s.out),
    OPTION_THREADS(&model.s.threads),
    {0}};

/* ---- texts ----------------------------------------------------------------------------------- */

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

bool flume_read_points(const char *text, int most, double (*point)[2], int32_t *count) {
  int values;
  if (!read_lengths(text, 2 * most, point[0], &values) || values % 2) return false;
  *count = values / 2;
  return true;
}

/* X does not fall, Y is not below the bed, and no point is twice. */
static bool is_profile(int32_t count, double (*at)[2]) {
  if (count < 3 || at[0][0] != 0.0 || at[0][1] != 0.0) return false;
  for (int k = 1; k < count; k++) {
    if (at[k][0] < at[k - 1][0] || at[k][1] < 0.0) return false;
    if (at[k][0] == at[k - 1][0] && at[k][1] == at[k - 1][1]) return false;
  }
  return at[count - 1][0] > 0.0 && at[count - 1][1] > 0.0;
}

static bool read_profile(flume *m) {
  double at[FLUME_POINTS][2];
  int32_t count;
  const bool wanted = m->s.wall == FLUME_PROFILE;
  if (!m->s.profile) return !wanted;
  if (!flume_read_points(m->s.profile, FLUME_POINTS, at, &count) || !is_profile(count, at))
    return false;
  if (!wanted) return true;
  m->shape.structure = count;
  memcpy(m->shape.structure_point, at, sizeof at);
  return true;
}

static int read_texts(const options_program *program, flume *m) {
  flume_shapes *p = &m->shape;
  flume_rock *r = &p->rock[p->rocks];
  if (!read_lengths(m->s.gauges, FLUME_GAUGES, m->s.gauge, &m->gauges))
    return flume_refuse(program, m, "--gauge must be at most 16 lengths in m separated by commas");
  if (m->s.wall != FLUME_OPEN_END && (p->structure > 0 || p->body > 0))
    return flume_refuse(program, m, "--wall must be none: the structure is that of --model");
  if (!read_profile(m))
    return flume_refuse(program, m,
                        "--profile must be 3 to 64 points X,Y in m separated by commas, the "
                        "first 0,0, X not falling, Y not below 0, no point twice");
  if (m->s.profile && m->s.wall != FLUME_PROFILE)
    return flume_refuse(program, m, "--profile needs --wall profile");
  if (!m->s.rocks) return -1;
  if (p->rocks == FLUME_ROCKS)
    return flume_refuse(program, m, "--rock is a ninth region of rock: 8 are possible");
  *r = m->s.rock;
  if (!flume_read_points(m->s.rocks, FLUME_POINTS, r->corner, &r->corners) || r->corners < 3)
    return flume_refuse(program, m, "--rock must be 3 to 64 corners X,Y in m separated by commas");
  p->rocks++;
  return -1;
}

/* ---- the model ------------------------------------------------------------------------------- */

flume *flume_read(int argc, char **argv, int *code) {
  const options_program program = {
      "mps-flume", "A wave flume by moving particles (MPS): seas, absorption, loads, overtopping.",
      table};
  model.table = table;
  *code = options_parse(&program, argc, argv);
  if (*code < 0 && model.s.model) {
    *code = flume_read_file(&program, &model);
    if (*code < 0) *code = options_again(&program, argc, argv);
  }
  if (*code < 0) *code = read_texts(&program, &model);
  if (*code < 0) *code = flume_check(&program, &model);
  return &model;
}
