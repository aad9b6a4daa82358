/* check.c - completes the settings of mps-flume and checks what several of them say together.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/options.h"
#include <math.h>
#include <stdio.h>

/* Steps over (spacing/g)^1/2. */
#define USUAL_STEP 0.2
#define MOST_STEP 0.3

/* ---- numbers --------------------------------------------------------------------------------- */

static int complete(const options_program *program, flume *m) {
  flume_settings *s = &m->s;
  const bool own = flume_has_structure(m) && s->wall == FLUME_OPEN_END; /* of the model file */
  if (isnan(s->spacing)) s->spacing = s->depth / 16.0;
  options_whole("depth", &s->depth, "--spacing", s->spacing);
  if (s->waves == FLUME_SOLITARY) {
    m->wave_length = 2.0 * WAVES_PI * s->depth * sqrt(s->depth / (0.75 * s->height));
    s->period = m->wave_length / sqrt(WAVES_G * (s->depth + s->height));
  } else {
    m->wave_length = 2.0 * WAVES_PI / waves_number(s->period, s->depth);
  }
  if (s->closed && s->wall != FLUME_OPEN_END)
    return flume_refuse(program, m, "--end closed needs a structure of --model, and --wall none");
  if (s->closed && own && isnan(s->length))
    return flume_refuse(program, m, "--end closed needs --length, to the far end");
  if (own && !s->closed && !isnan(s->length))
    return flume_refuse(program, m,
                        "--length is that to the toe of the structure of --model: give "
                        "it with --end closed alone");
  if (own && !s->closed) s->length = m->shape.structure_point[0][0];
  if (isnan(s->length)) s->length = ceil(3.0 * m->wave_length / s->spacing) * s->spacing;
  if (!own || s->closed) options_whole("length", &s->length, "--spacing", s->spacing);
  if (isnan(s->dt)) s->dt = USUAL_STEP * sqrt(s->spacing / WAVES_G);
  if (isnan(s->ramp)) s->ramp = 2.0 * s->period;
  if (isnan(s->duration)) s->duration = 20.0 * s->period;
  if (isnan(s->sample)) s->sample = s->period / 60.0;
  if (isnan(s->repeat) && s->waves != FLUME_REGULAR && s->waves != FLUME_SOLITARY)
    s->repeat = fmax(s->duration, 20.0 * s->period);
  if (s->depth < 5.0 * s->spacing)
    return flume_refuse(program, m, "--depth must be at least 5 times --spacing");
  if (s->length < 10.0 * s->spacing)
    return flume_refuse(program, m, "--length must be at least 10 times --spacing");
  if (s->length / s->spacing * s->depth / s->spacing > 2e6)
    return flume_refuse(program, m, "--spacing gives more than 2 million particles");
  return -1;
}

static int check_times(const options_program *program, const flume *m) {
  const flume_settings *s = &m->s;
  if (s->dt > MOST_STEP * sqrt(s->spacing / WAVES_G))
    return flume_refuse(program, m, "--dt must be at most .3 (spacing/g)^1/2");
  if (s->sample > s->duration || s->duration / s->sample > 1e6)
    return flume_refuse(program, m,
                        "--sample must be between a millionth of --duration and all of it");
  if (s->sample > 0.1 * s->period)
    return flume_refuse(program, m, "--sample must be at most a tenth of --period");
  if (!isnan(s->window[0]) && !(s->window[0] < s->window[1]))
    return flume_refuse(program, m, "--window must be two times, the first before the second");
  if (s->waves == FLUME_FILE && !s->file)
    return flume_refuse(program, m, "--waves file needs --levels");
  if (s->waves == FLUME_FOCUSED && (isnan(s->focus[0]) || isnan(s->focus[1])))
    return flume_refuse(program, m, "--waves focused needs --focus X,T");
  if (s->waves == FLUME_FILE && !options_given(m->table, "period"))
    return flume_refuse(program, m,
                        "--waves file needs --period, that of the peak of its waves: what is not "
                        "from .6 to 2.5 times its frequency is not made");
  if (s->waves == FLUME_FOCUSED && s->focus[0] > s->length)
    return flume_refuse(program, m, "--focus must be in the flume, 0 to --length");
  if (s->absorb == FLUME_ZONE && s->zone * m->wave_length >= s->length)
    return flume_refuse(program, m, "--zone is longer than --length");
  return -1;
}

static int check_gauges(const options_program *program, flume *m) {
  const flume_settings *s = &m->s;
  flume_place_gauges(m);
  for (int k = 0; k < m->gauges; k++)
    if (s->gauge[k] < 0.0 || s->gauge[k] > s->length)
      return flume_refuse(program, m, "--gauge must be in the flume, 0 to --length");
  for (int k = 0; k < m->gauges; k++)
    for (int j = 0; j < k; j++)
      if (s->gauge[k] == s->gauge[j])
        return flume_refuse(program, m, "--gauge has one station twice");
  return -1;
}

/* ---- shapes ---------------------------------------------------------------------------------- */

static int check_wall(const options_program *program, const flume *m) {
  const flume_settings *s = &m->s;
  const flume_shapes *p = &m->shape;
  const bool simple = s->wall == FLUME_CAISSON || s->wall == FLUME_SLOPE;
  if (simple && s->crest < s->spacing)
    return flume_refuse(program, m, "--freeboard must be at least --spacing");
  if (simple && s->width < s->spacing)
    return flume_refuse(program, m, "--width must be at least --spacing");
  if (s->absorb == FLUME_ZONE && (s->wall != FLUME_OPEN_END || flume_is_open(m)))
    return flume_refuse(program, m, "--absorb zone is a zone at the far end: it needs --wall none");
  if (s->wall != FLUME_PROFILE) return -1;
  for (int k = 1; k < p->structure; k++) {
    const double *a = p->structure_point[k - 1], *b = p->structure_point[k];
    if (hypot(b[0] - a[0], b[1] - a[1]) < s->spacing)
      return flume_refuse(program, m, "--profile must have its points at least --spacing apart");
  }
  if (p->structure_point[p->structure - 1][1] < s->depth + 2.0 * s->spacing)
    return flume_refuse(program, m, "--profile must end at least 2 times --spacing above --depth");
  return -1;
}

/* The structures of --wall have their toe at --length and height 0; the far end is an upright
 * plane, to which the bed is at a right angle. */
static int check_end_of_bed(const options_program *program, const flume *m) {
  const flume_shapes *p = &m->shape;
  const double *last = p->bed_point[p->bed - 1], *before = p->bed_point[p->bed - 2];
  if (flume_has_structure(m) && m->s.wall == FLUME_OPEN_END) return -1;
  if (last[0] > m->s.length + 1e-9)
    return flume_refuse(program, m, "--length is less than that of the bed");
  if (m->s.wall >= FLUME_CAISSON && last[1] != 0.0)
    return flume_refuse_at(program, m, "bed", last,
                           "must be at height 0, where the structures of --wall stand: give it as "
                           "a structure of --model");
  if (m->s.wall < FLUME_CAISSON && last[1] != before[1] && last[0] > m->s.length - m->s.spacing)
    return flume_refuse_at(program, m, "bed", last,
                           "is the end of a slope at the far end, to which the bed must be level: "
                           "--length must be at least --spacing more, or the slope end before");
  return -1;
}

static int check_bed(const options_program *program, const flume *m) {
  const flume_shapes *p = &m->shape;
  const double(*at)[2] = p->bed_point;
  if (p->bed == 0) return -1;
  if (at[0][0] != 0.0 || at[0][1] != 0.0 || at[1][1] != 0.0)
    return flume_refuse_at(program, m, "bed", at[0][0] != 0.0 || at[0][1] != 0.0 ? at[0] : at[1],
                           "must be at height 0: a bed begins at 0,0 and is level there");
  for (int k = 1; k < p->bed; k++)
    if (at[k][0] < at[k - 1][0])
      return flume_refuse_at(program, m, "bed", at[k], "lies behind the corner before it");
  const int code = flume_check_sides(program, m, "bed", p->bed, false, at);
  return code < 0 ? check_end_of_bed(program, m) : code;
}

static int check_structure(const options_program *program, const flume *m) {
  const flume_shapes *p = &m->shape;
  const double(*at)[2] = p->structure_point;
  if (!flume_has_structure(m) || m->s.wall != FLUME_OPEN_END) return -1;
  const double *toe = at[0], *rear = at[p->structure - 1];
  const double *end = p->bed ? p->bed_point[p->bed - 1] : NULL;
  if (end ? hypot(toe[0] - end[0], toe[1] - end[1]) > 1e-9 : toe[1] != 0.0)
    return flume_refuse_at(program, m, "structure", toe,
                           "must be the last corner of the bed, or at height 0");
  for (int k = 1; k < p->structure; k++)
    if (at[k][0] < toe[0])
      return flume_refuse_at(program, m, "structure", at[k], "lies before the toe");
  if (rear[1] != 0.0 && rear[1] < m->s.spacing)
    return flume_refuse_at(
        program, m, "structure", rear,
        "must end at height 0 or at least --spacing above it: it stands upright behind");
  if (flume_is_open(m) && rear[1] < m->s.depth + 2.0 * m->s.spacing)
    return flume_refuse_at(program, m, "structure", rear,
                           "must be at least 2 times --spacing above --depth, or --end closed");
  if (!flume_is_open(m) && m->s.length < rear[0] + 8.0 * m->s.spacing)
    return flume_refuse(program, m, "--length must be 8 times --spacing more than the structure's");
  return flume_check_sides(program, m, "structure", p->structure, false, at);
}

/* They are moved onto the nearest face. */
static int check_probes(const options_program *program, flume *m) {
  for (int k = 0; k < m->shape.probes; k++) {
    double on[2], *at = m->shape.probe[k];
    if (flume_nearest_face(m, at, on, &m->probe_wall[k]) > 0.5 * m->s.spacing)
      return flume_refuse_at(program, m, "probe", at,
                             "is more than half a --spacing from all faces");
    at[0] = on[0], at[1] = on[1];
  }
  return -1;
}

static int check_shapes(const options_program *program, flume *m) {
  int code = check_wall(program, m);
  if (code < 0) code = check_bed(program, m);
  if (code < 0) code = check_structure(program, m);
  if (code >= 0) return code;
  flume_make_ground(m);
  double lowest = 0.0;
  for (int k = 0; k < m->grounds; k++) lowest = fmin(lowest, m->ground[k][1]);
  if (m->outlet * (m->s.depth - lowest) / (m->s.spacing * m->s.spacing) > 2e6)
    return flume_refuse(program, m, "--spacing gives more than 2 million particles");
  code = flume_check_body(program, m);
  if (code < 0) code = check_probes(program, m);
  if (code >= 0) return code;
  if (!flume_fill_cells(m)) return flume_refuse(program, m, "out of memory");
  code = flume_check_rock(program, m);
  if (code >= 0) return code;
  for (int64_t j = 0; flume_is_open(m) && j < m->cells.rows; j++)
    if (m->cells.wet[(j + 1) * m->cells.columns - 1])
      return flume_refuse(program, m,
                          "the water at rest reaches the open side behind the structure: "
                          "--end must be closed");
  return -1;
}

int flume_check(const options_program *program, flume *m) {
  int code = complete(program, m);
  if (code < 0) code = check_times(program, m);
  if (code < 0) code = check_shapes(program, m);
  if (code < 0) code = check_gauges(program, m);
  return code < 0 ? flume_check_unused(program, m) : code;
}
