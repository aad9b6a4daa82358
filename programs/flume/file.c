/* file.c - the model file of mps-flume: a map in YAML whose keys are options of the program, and
 *
 *   bed: [[0, 0], [3, 0], [4, 0.05]]            corners X, Y in m from the foot of the maker
 *   structure: [[4, 0.05], [4.8, 0.45], ...]    from the toe over the crest to its rear edge
 *   caisson: [[...], ...]                       a closed body in the water, on rock
 *   rock: [{corners: [[...], ...], porosity: 0.45, stone: 0.03, alpha: 1000, beta: 1.1}]
 *   probe: [[4.2, 0.2], ...]                    points of the faces whose pressures are written
 *
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/options.h"
#include "common/units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int refuse(const options_program *program, const flume *m, const document *at,
                  const char *what) {
  char text[600];
  snprintf(text, sizeof text, "%.200s, line %d: %s", m->s.model, at->line, what);
  return options_refuse(program, text);
}

/* The line of the first key of the model file that the reason names as an option; 0: none. */
static int line_of_option(const document *d, const char *reason) {
  for (const char *at = d ? strstr(reason, "--") : NULL; at; at = strstr(at + 2, "--")) {
    char name[64] = "";
    const size_t length = strspn(at + 2, "abcdefghijklmnopqrstuvwxyz-");
    if (length == 0 || length >= sizeof name) continue;
    memcpy(name, at + 2, length);
    const document *key = document_find(d, name);
    if (key) return key->line;
  }
  return 0;
}

int flume_refuse(const options_program *program, const flume *m, const char *reason) {
  char text[800];
  const int line = line_of_option(m->text, reason);
  if (line == 0) return options_refuse(program, reason);
  snprintf(text, sizeof text, "%.200s, line %d: %s", m->s.model, line, reason);
  return options_refuse(program, text);
}

/* ---- shapes ---------------------------------------------------------------------------------- */

static int read_point(const options_program *program, const flume *m, const char *key,
                      const document *pair, double *point) {
  char why[300];
  if (pair->kind != DOCUMENT_LIST || pair->count != 2) {
    snprintf(why, sizeof why, "%s must be a list of points [X, Y], here is %s", key,
             pair->kind == DOCUMENT_TEXT ? pair->text : document_kind_name(pair));
    return refuse(program, m, pair, why);
  }
  for (int c = 0; c < 2; c++) {
    const document *number = &pair->child[c];
    const bool good = number->kind == DOCUMENT_TEXT &&
                      units_read(number->text, "m", &point[c]) == UNITS_GOOD &&
                      fabs(point[c]) <= 1e6;
    if (good) continue;
    snprintf(why, sizeof why, "%s: %c is %.60s, must be a length in m, in [-1e6, 1e6]", key,
             'X' + c, number->kind == DOCUMENT_TEXT ? number->text : document_kind_name(number));
    return refuse(program, m, number, why);
  }
  return -1;
}

static int read_points(const options_program *program, const flume *m, const char *key,
                       const document *list, int least, int most, double (*point)[2],
                       int32_t *count) {
  char why[200];
  if (list->kind != DOCUMENT_LIST || list->count < least || list->count > most) {
    snprintf(why, sizeof why, "%s must be a list of %d to %d points [X, Y]", key, least, most);
    return refuse(program, m, list, why);
  }
  for (*count = 0; *count < list->count; (*count)++) {
    const int code = read_point(program, m, key, &list->child[*count], point[*count]);
    if (code >= 0) return code;
  }
  return -1;
}

/* Water lies to the left of the way along the corners: outside. */
static void turn_clockwise(flume_shapes *p) {
  double twice = 0.0;
  for (int k = 0; k < p->body; k++) {
    const double *a = p->body_point[k], *b = p->body_point[(k + 1) % p->body];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  for (int k = 0; twice > 0.0 && k < p->body / 2; k++)
    for (int c = 0; c < 2; c++) {
      double *a = &p->body_point[k][c], *b = &p->body_point[p->body - 1 - k][c];
      const double kept = *a;
      *a = *b, *b = kept;
    }
}

/* ---- rock ------------------------------------------------------------------------------------ */

static const struct {
  const char *key;
  double lower, upper;
  size_t at;
} member[] = {{"porosity", 0.1, 1.0, offsetof(flume_rock, porosity)},
              {"stone", 1e-6, 100.0, offsetof(flume_rock, diameter)},
              {"alpha", 0.0, 1e6, offsetof(flume_rock, alpha)},
              {"beta", 0.0, 1e3, offsetof(flume_rock, beta)},
              {"KC", 1e-6, 1e6, offsetof(flume_rock, KC)},
              {"gamma", 0.0, 10.0, offsetof(flume_rock, gamma)}};
enum { MEMBERS = sizeof member / sizeof *member };

static int read_member(const options_program *program, const flume *m, const document *value,
                       flume_rock *r) {
  char why[300];
  for (int k = 0; k < MEMBERS; k++) {
    double number;
    if (strcmp(value->key, member[k].key) != 0) continue;
    const char *unit = k == 1 ? "m" : NULL;
    if (value->kind == DOCUMENT_TEXT && units_read(value->text, unit, &number) == UNITS_GOOD &&
        number >= member[k].lower && number <= member[k].upper) {
      memcpy((char *)r + member[k].at, &number, sizeof number);
      return -1;
    }
    snprintf(why, sizeof why, "rock: %s is %.60s, must be a number in [%g, %g]%s", value->key,
             value->kind == DOCUMENT_TEXT ? value->text : document_kind_name(value),
             member[k].lower, member[k].upper, unit ? " m" : "");
    return refuse(program, m, value, why);
  }
  snprintf(why, sizeof why,
           "rock: unknown key %.60s, must be corners, porosity, stone, alpha, beta, KC or gamma",
           value->key);
  return refuse(program, m, value, why);
}

static int read_rock(const options_program *program, flume *m, const document *list) {
  flume_shapes *p = &m->shape;
  int code = -1;
  if (list->kind != DOCUMENT_LIST || list->count > FLUME_ROCKS)
    return refuse(program, m, list, "rock must be a list of up to 8 maps");
  for (int k = 0; k < list->count && code < 0; k++) {
    const document *map = &list->child[k], *corners = document_find(map, "corners");
    flume_rock *r = &p->rock[p->rocks++];
    *r = m->s.rock;
    if (map->kind != DOCUMENT_MAP || !corners)
      return refuse(program, m, map,
                    "rock must be a map with the key corners, and porosity, stone, "
                    "alpha, beta, KC or gamma");
    code = read_points(program, m, "corners", corners, 3, FLUME_POINTS, r->corner, &r->corners);
    for (int j = 0; j < map->count && code < 0; j++)
      if (&map->child[j] != corners) code = read_member(program, m, &map->child[j], r);
  }
  return code;
}

/* ---- keys ------------------------------------------------------------------------------------ */

/* A list of numbers, such as gauges, is what the command line has between commas. */
static bool join(document *value) {
  size_t size = 1;
  if (value->kind != DOCUMENT_LIST || value->text) return value->kind == DOCUMENT_TEXT;
  for (int k = 0; k < value->count; k++) {
    if (value->child[k].kind != DOCUMENT_TEXT) return false;
    size += strlen(value->child[k].text) + 1;
  }
  value->text = calloc(size, 1);
  char *at = value->text;
  for (int k = 0; at && k < value->count; k++) {
    const size_t length = strlen(value->child[k].text);
    if (k > 0) *at++ = ',';
    memcpy(at, value->child[k].text, length);
    at += length;
  }
  return value->text != NULL;
}

static int read_option(const options_program *program, flume *m, document *value) {
  char where[300], why[300];
  if (options_free(value->key) || strcmp(value->key, "model") == 0) {
    snprintf(why, sizeof why, "%.60s is an option of the command line alone", value->key);
    return refuse(program, m, value, why);
  }
  if (!join(value)) {
    snprintf(why, sizeof why, "%.60s must be a value or a list of values", value->key);
    return refuse(program, m, value, why);
  }
  snprintf(where, sizeof where, "%.200s, line %d", m->s.model, value->line);
  return options_set(program, where, value->key, value->text);
}

static int read_shape(const options_program *program, flume *m, const document *value) {
  flume_shapes *p = &m->shape;
  if (strcmp(value->key, "bed") == 0)
    return read_points(program, m, "bed", value, 2, FLUME_POINTS, p->bed_point, &p->bed);
  if (strcmp(value->key, "structure") == 0)
    return read_points(program, m, "structure", value, 3, FLUME_POINTS, p->structure_point,
                       &p->structure);
  if (strcmp(value->key, "probe") == 0)
    return read_points(program, m, "probe", value, 1, FLUME_PROBES, p->probe, &p->probes);
  if (strcmp(value->key, "rock") == 0) return read_rock(program, m, value);
  const int code =
      read_points(program, m, "caisson", value, 3, FLUME_POINTS, p->body_point, &p->body);
  turn_clockwise(p);
  return code;
}

static bool is_shape(const char *key) {
  static const char *const name[] = {"bed", "structure", "caisson", "probe", "rock"};
  for (size_t k = 0; k < sizeof name / sizeof *name; k++)
    if (strcmp(key, name[k]) == 0) return true;
  return false;
}

/* Options first: regions of rock take what they do not say from them. */
int flume_read_file(const options_program *program, flume *m) {
  char why[400];
  int code = -1;
  m->text = document_read(m->s.model, why, sizeof why);
  if (!m->text) return options_refuse(program, why);
  if (m->text->kind != DOCUMENT_MAP)
    return refuse(program, m, m->text, "a model is a map: lines \"key: value\"");
  for (int k = 0; k < m->text->count && code < 0; k++)
    if (!is_shape(m->text->child[k].key)) code = read_option(program, m, &m->text->child[k]);
  for (int k = 0; k < m->text->count && code < 0; k++)
    if (is_shape(m->text->child[k].key)) code = read_shape(program, m, &m->text->child[k]);
  return code;
}
