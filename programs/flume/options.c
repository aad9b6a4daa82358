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
                            .dt = NAN,
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
    OPTION_CHOICE_OF("waves", "regular|jonswap|pm|focused|file|solitary", &model.s.waves, NULL),
    OPTION_NUMBER(
        "height", &model.s.height,
        "of regular and solitary waves, Hm0 of a sea, of a focused group twice its linear crest"),
    OPTION_NUMBER("period", &model.s.period, "peak of a spectrum"),
    OPTION_NUMBER("gamma", &model.s.gamma, NULL),
    OPTION_NUMBER("repeat", &model.s.repeat, NULL),
    OPTION_INTEGER("seed", &model.s.seed, "phases and amplitudes"),
    OPTION_CHOICE_OF("random", "phases|amplitudes", &model.s.random, NULL),
    OPTION_NUMBERS("focus", 2, model.s.focus, NULL),
    OPTION_TEXT("levels", &model.s.file, NULL),
    OPTION_TEXT("levels-column", &model.s.column, NULL),
    OPTION_CHOICE_OF("order", "second|linear|narrow|stream", &model.s.order, NULL),
    OPTION_NUMBER("ramp", &model.s.ramp, "default 2 periods"),
    OPTION_NUMBER("stroke", &model.s.stroke, NULL),
    OPTION_NUMBER("speed", &model.s.speed, NULL),
    OPTION_HEADING("Flume"),
    OPTION_NUMBER("depth", &model.s.depth, "of the water"),
    OPTION_NUMBER("length", &model.s.length,
                  "from the maker to the far end or the toe of the wall (default 3 wave lengths)"),
    OPTION_CHOICE_OF("absorb", "active|zone|none", &model.s.absorb, NULL),
    OPTION_CHOICE_OF("form", "tuned|shallow", &model.s.form, NULL),
    OPTION_NUMBER("zone", &model.s.zone, NULL),
    OPTION_NUMBER("zone-rate", &model.s.rate, NULL),
    OPTION_CHOICE_OF("wall", "none|vertical|caisson|slope|profile", &model.s.wall, NULL),
    OPTION_NUMBER("freeboard", &model.s.crest, NULL),
    OPTION_NUMBER_IN("slope", OPTION_FROM_TO(0.1, 100.0), &model.s.cotangent, "of the dike"),
    OPTION_NUMBER("width", &model.s.width, "of the crest"),
    OPTION_TEXT("profile", &model.s.profile, NULL),
    OPTION_NUMBER("wall-density", &model.s.density, "the caisson, for its safeties"),
    OPTION_NUMBER_IN("friction", OPTION_FROM_TO(1e-3, 10.0), &model.s.friction,
                     "below the caisson"),
    OPTION_NUMBER("friction-factor", &model.s.roughness, "bed, structure and body"),
    OPTION_CHOICE_OF("end", "open|closed", &model.s.closed, NULL),
    OPTION_CHOICE_OF("passed", "returns|leaves", &model.s.leaves, NULL),
    OPTION_TEXT("rock", &model.s.rocks, NULL),
    OPTION_NUMBER_IN("porosity", OPTION_FROM_TO(0.1, 1.0), &model.s.rock.porosity, "of rock"),
    OPTION_NUMBER("stone", &model.s.rock.diameter, NULL),
    OPTION_NUMBER("rock-alpha", &model.s.rock.alpha, NULL),
    OPTION_NUMBER("rock-beta", &model.s.rock.beta, NULL),
    OPTION_TEXT("model", &model.s.model, NULL),
    OPTION_HEADING("Particles"),
    OPTION_NUMBER("spacing", &model.s.spacing, "default a sixteenth of the depth"),
    OPTION_NUMBER("disturb", &model.s.disturb, NULL),
    WAVES_SOLVER(&model.s.solver, &model.s.tolerance),
    OPTION_HEADING("Run"),
    OPTION_NUMBER("dt", &model.s.dt,
                  "at most, shorter where the water is fast (default .2 (spacing/g)^1/2)"),
    OPTION_NUMBER("duration", &model.s.duration, "default 20 periods"),
    OPTION_NUMBER("sample", &model.s.sample, "default a sixtieth of the period"),
    OPTION_TEXT("gauge", &model.s.gauges,
                "at most 16; incident and reflected waves follow from all of them (default: four, "
                "up to a wave length before the end)"),
    OPTION_NUMBERS("window", 2, model.s.window,
                   "default from when waves have been to the wall and half the way back"),
    OPTION_INTEGER("frames", &model.s.frames, NULL),
    OPTION_INTEGER("animation", &model.s.animation, NULL),
    RESUME_OPTIONS(&model.s.checkpoint, &model.s.every_checkpoint, NULL, &model.s.restart),
    OPTIONS_OF_ALL(&model.s),
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
