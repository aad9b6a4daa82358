/* check.c - completes the settings of mps-flume and checks what several of them say together.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/options.h"
#include "common/units.h"

#include <math.h>
#include <stdio.h>

/* Spacings between ground and body: more than the radius of the weights. */
#define BEDDING (FLUME_ROCK_RADIUS + 0.1)

static bool is_whole(double length, double spacing) {
  return fabs(length / spacing - nearbyint(length / spacing)) < 1e-6 * (1.0 + length / spacing);
}

/* ---- numbers --------------------------------------------------------------------------------- */

static int complete(const options_program *program, flume *m) {
  flume_settings *s = &m->s;
  const bool own = flume_has_structure(m) && s->wall == FLUME_OPEN_END; /* of the model file */
  if (isnan(s->spacing)) s->spacing = s->depth / 16.0;
  m->wave_length = 2.0 * WAVES_PI / waves_number(s->period, s->depth);
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
  if (isnan(s->ramp)) s->ramp = 2.0 * s->period;
  if (isnan(s->duration)) s->duration = 20.0 * s->period;
  if (isnan(s->sample)) s->sample = s->period / 60.0;
  if (isnan(s->repeat) && s->waves != FLUME_REGULAR)
    s->repeat = fmax(s->duration, 20.0 * s->period);
  if (s->depth < 5.0 * s->spacing)
    return flume_refuse(program, m, "--depth must be at least 5 times --spacing");
  if (s->length < 10.0 * s->spacing)
    return flume_refuse(program, m, "--length must be at least 10 times --spacing");
  if (s->length / s->spacing * s->depth / s->spacing > 2e6)
    return flume_refuse(program, m, "--spacing gives more than 2 million particles");
  if (!is_whole(s->depth, s->spacing) || !(is_whole(s->length, s->spacing) || (own && !s->closed)))
    return flume_refuse(program, m,
                        "--length and --depth must be whole numbers of --spacing: else "
                        "the water does not fill the flume");
  return -1;
}

static int check_times(const options_program *program, const flume *m) {
  const flume_settings *s = &m->s;
  if (s->sample > s->duration || s->duration / s->sample > 1e6)
    return flume_refuse(program, m,
                        "--sample must be between a millionth of --duration and all of it");
  if (s->sample > 0.1 * s->period)
    return flume_refuse(program, m, "--sample must be at most a tenth of --period");
  if (!isnan(s->window[0]) && !(s->window[0] < s->window[1]))
    return flume_refuse(program, m, "--window must be two times, the first before the second");
  if (s->waves == FLUME_FILE && !s->file)
    return flume_refuse(program, m, "--waves file needs --file");
  if (s->waves == FLUME_FOCUSED && (isnan(s->focus[0]) || isnan(s->focus[1])))
    return flume_refuse(program, m, "--waves focused needs --focus X,T");
  return -1;
}

/* Four gauges at unequal distances, the last a wave length before the end or the structure. */
static void place_gauges(flume *m) {
  static const double part[] = {0.0, 0.1, 0.27, 0.47};
  flume_settings *s = &m->s;
  const double last = fmax(m->toe - m->wave_length, 0.5 * m->toe);
  for (int k = 0; k < 4; k++) s->gauge[k] = last - (0.47 - part[k]) * m->wave_length;
  for (int k = 0; k < 4; k++) /* on the lattice, apart */
    s->gauge[k] = fmax(round(s->gauge[k] / s->spacing), k + 1.0) * s->spacing;
  for (int k = 1; k < 4; k++) s->gauge[k] = fmax(s->gauge[k], s->gauge[k - 1] + s->spacing);
}

static int check_gauges(const options_program *program, flume *m) {
  const flume_settings *s = &m->s;
  if (m->gauges == 0) place_gauges(m), m->gauges = 4;
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

/* The line of the model file with a point of a shape; 0: it is of the options. */
static int line_of(const document *d, const double *at) {
  double x[2];
  if (!d || d->kind == DOCUMENT_TEXT) return 0;
  bool here = d->kind == DOCUMENT_LIST && d->count == 2;
  for (int c = 0; c < 2 && here; c++)
    here = d->child[c].kind == DOCUMENT_TEXT &&
           units_read(d->child[c].text, "m", &x[c]) == UNITS_GOOD && fabs(x[c] - at[c]) < 1e-12;
  if (here) return d->line;
  for (int k = 0; k < d->count; k++) {
    const int line = line_of(&d->child[k], at);
    if (line > 0) return line;
  }
  return 0;
}

static int refuse(const options_program *program, const flume *m, const char *key, const double *at,
                  const char *why) {
  char text[500], place[300] = "";
  const int line = m->text ? line_of(document_find(m->text, key), at) : 0;
  if (line > 0) snprintf(place, sizeof place, "%.200s, line %d: ", m->s.model, line);
  snprintf(text, sizeof text, "%s%s %g,%g %s", place, key, at[0], at[1], why);
  return options_refuse(program, text);
}

static int check_wall(const options_program *program, const flume *m) {
  const flume_settings *s = &m->s;
  const flume_shapes *p = &m->shape;
  const bool simple = s->wall == FLUME_CAISSON || s->wall == FLUME_SLOPE;
  if (simple && s->crest < s->spacing)
    return flume_refuse(program, m, "--crest must be at least --spacing");
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

/* Sides of at least a spacing, as the library wants them. */
static int check_sides(const options_program *program, const flume *m, const char *what, int count,
                       bool closed, const double (*at)[2]) {
  for (int k = closed ? 0 : 1; k < count; k++) {
    const double *before = at[k ? k - 1 : count - 1];
    if (hypot(at[k][0] - before[0], at[k][1] - before[1]) < m->s.spacing * (1.0 - 1e-9))
      return refuse(program, m, what, at[k], "lies less than --spacing from the corner before it");
  }
  return -1;
}

static int check_bed(const options_program *program, const flume *m) {
  const flume_shapes *p = &m->shape;
  const double(*at)[2] = p->bed_point;
  if (p->bed == 0) return -1;
  if (at[0][0] != 0.0 || at[0][1] != 0.0 || at[1][1] != 0.0)
    return refuse(program, m, "bed", at[0][0] != 0.0 || at[0][1] != 0.0 ? at[0] : at[1],
                  "must be at height 0: a bed begins at 0,0 and is level there");
  for (int k = 1; k < p->bed; k++)
    if (at[k][0] < at[k - 1][0])
      return refuse(program, m, "bed", at[k], "lies behind the corner before it");
  return check_sides(program, m, "bed", p->bed, false, at);
}

static int check_structure(const options_program *program, const flume *m) {
  const flume_shapes *p = &m->shape;
  const double(*at)[2] = p->structure_point;
  if (!flume_has_structure(m) || m->s.wall != FLUME_OPEN_END) return -1;
  const double *toe = at[0], *rear = at[p->structure - 1];
  const double *end = p->bed ? p->bed_point[p->bed - 1] : NULL;
  if (end ? hypot(toe[0] - end[0], toe[1] - end[1]) > 1e-9 : toe[1] != 0.0)
    return refuse(program, m, "structure", toe,
                  "must be the last corner of the bed, or at height 0");
  for (int k = 1; k < p->structure; k++)
    if (at[k][0] < toe[0]) return refuse(program, m, "structure", at[k], "lies before the toe");
  if (rear[1] != 0.0 && rear[1] < m->s.spacing)
    return refuse(program, m, "structure", rear,
                  "must end at height 0 or at least --spacing above it: it stands upright behind");
  if (flume_is_open(m) && rear[1] < m->s.depth + 2.0 * m->s.spacing)
    return refuse(program, m, "structure", rear,
                  "must be at least 2 times --spacing above --depth, or --end closed");
  if (!flume_is_open(m) && m->s.length < rear[0] + 8.0 * m->s.spacing)
    return flume_refuse(program, m, "--length must be 8 times --spacing more than the structure's");
  return check_sides(program, m, "structure", p->structure, false, at);
}

static int check_body(const options_program *program, const flume *m) {
  const flume_shapes *p = &m->shape;
  if (!flume_has_body(m)) return -1;
  if (flume_is_open(m))
    return flume_refuse(program, m, "--end must be closed with a caisson: water is on both sides");
  for (int k = 0; k < p->body; k++) {
    const double *at = p->body_point[k];
    if (at[0] < 8.0 * m->s.spacing || at[0] > m->outlet - 8.0 * m->s.spacing)
      return refuse(program, m, "caisson", at,
                    "must be 8 times --spacing from both ends of the flume");
    for (int j = 0; j + 1 < m->grounds; j++)
      if (at[1] < fmin(m->ground[j][1], m->ground[j + 1][1]) + BEDDING * m->s.spacing &&
          at[0] >= fmin(m->ground[j][0], m->ground[j + 1][0]) &&
          at[0] <= fmax(m->ground[j][0], m->ground[j + 1][0]))
        return refuse(
            program, m, "caisson", at,
            "must be 3.7 times --spacing above the bed: one that stands on it is a structure");
  }
  return check_sides(program, m, "caisson", p->body, true, p->body_point);
}

static int check_rock(const options_program *program, const flume *m) {
  for (int k = 0; k < m->shape.rocks; k++)
    if (isnan(m->shape.rock[k].diameter))
      return refuse(program, m, "rock", m->shape.rock[k].corner[0],
                    "needs the size of its stones, --stone");
  return -1;
}

/* They are moved onto the nearest face. */
static int check_probes(const options_program *program, flume *m) {
  for (int k = 0; k < m->shape.probes; k++) {
    double on[2], *at = m->shape.probe[k];
    if (flume_nearest_face(m, at, on, &m->probe_wall[k]) > 0.5 * m->s.spacing)
      return refuse(program, m, "probe", at, "is more than half a --spacing from all faces");
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
  code = check_body(program, m);
  if (code < 0) code = check_rock(program, m);
  if (code < 0) code = check_probes(program, m);
  if (code >= 0) return code;
  if (m->shape.bed > 0 && !flume_has_structure(m) &&
      m->outlet < m->shape.bed_point[m->shape.bed - 1][0] - 1e-9)
    return flume_refuse(program, m, "--length is less than that of the bed");
  if (!flume_fill_cells(m)) return flume_refuse(program, m, "out of memory");
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
