/* random.c - numbers by seed, and arguments by the mood of the call: valid, at the edge of what is
 * allowed, or absurd. Each argument writes its name and value to the line of the call, and one that
 * no function may take is counted.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "api.h"

#include "core/definition/definition.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* splitmix64 */
uint64_t api_mix(uint64_t x) {
  x += UINT64_C(0x9e3779b97f4a7c15);
  x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
  return x ^ (x >> 31);
}

uint64_t api_bits(api *a) { return api_mix(a->random += UINT64_C(0x9e3779b97f4a7c15)); }

uint32_t api_below(api *a, uint32_t n) { return (uint32_t)((api_bits(a) >> 32) * n >> 32); }

bool api_chance(api *a, int percent) { return (int)api_below(a, 100) < percent; }

double api_unit(api *a) { return (double)(api_bits(a) >> 11) * 0x1p-53; }

void api_say(api *a, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const size_t room = sizeof a->line - a->length;
  const int length = vsnprintf(a->line + a->length, room, format, arguments);
  va_end(arguments);
  if (length > 0) a->length += (size_t)length < room ? (size_t)length : room - 1;
}

/* In as few digits as give the number back. */
static void say_real(api *a, const char *name, double value) {
  char text[32];
  snprintf(text, sizeof text, "%.6g", value);
  if (!(strtod(text, NULL) == value) && !isnan(value)) snprintf(text, sizeof text, "%.17g", value);
  api_say(a, name[0] ? "%s = %s, " : "%s%s, ", name, text);
}

void api_wrong(api *a, const char *name) {
  a->wrong++;
  a->wrong_name = name;
}

static const double absurd[] = {NAN,     INFINITY, -INFINITY, -1.0,  0.0,   1e300,   -1e300,
                                DBL_MIN, 5e-324,   -5e-324,   1e-20, -1e-9, DBL_MAX, 4e18};

static double pick_absurd(api *a) { return absurd[api_below(a, API_COUNT(absurd))]; }

/* Is it the turn of an argument to be absurd? */
static bool turn(api *a) { return a->mood == API_ABSURD && api_chance(a, 25); }

static double draw_real(api *a, const char *name, double lo, double hi, double typical) {
  double value = typical * (0.5 + 1.5 * api_unit(a));
  if (a->latest || (a->mood == API_VALID && api_chance(a, 50))) value = typical;
  if (value < lo) value = lo;
  if (value > hi) value = hi;
  if (a->mood == API_EDGE && api_chance(a, 30)) value = api_chance(a, 50) ? lo : hi;
  if (turn(a)) {
    const double bounds[] = {nextafter(lo, -INFINITY), nextafter(hi, INFINITY)};
    value = api_chance(a, 30) ? bounds[api_below(a, 2)] : pick_absurd(a);
    if (!(value >= lo && value <= hi)) api_wrong(a, name);
  }
  return value;
}

double api_real(api *a, const char *name, double lo, double hi, double typical) {
  const double value = draw_real(a, name, lo, hi, typical);
  say_real(a, name, value);
  return value;
}

double api_real_or_nan(api *a, const char *name, double lo, double hi, double typical) {
  const int before = a->wrong;
  const double value = draw_real(a, name, lo, hi, typical);
  if (isnan(value)) a->wrong = before;
  say_real(a, name, value);
  return value;
}

double api_optional(api *a, const char *name, double lo, double hi, double typical) {
  if (a->latest || api_chance(a, 60)) {
    if (a->mood != API_VALID) say_real(a, name, NAN);
    return NAN;
  }
  const int before = a->wrong;
  const double value = draw_real(a, name, lo, hi, typical);
  if (isnan(value)) a->wrong = before;
  say_real(a, name, value);
  return value;
}

static double draw_near(api *a, const char *name, double centre, double width) {
  double value = centre + width * (2.0 * api_unit(a) - 1.0);
  if (api_chance(a, 30)) value = centre;
  if (a->mood == API_EDGE && api_chance(a, 10)) value = centre + width * 1e3;
  if (turn(a)) {
    value = pick_absurd(a);
    if (!isfinite(value)) api_wrong(a, name);
  }
  return value;
}

double api_near(api *a, const char *name, double centre, double width) {
  const double value = draw_near(a, name, centre, width);
  say_real(a, name, value);
  return value;
}

void api_vector(api *a, const char *name, int count, double centre, double width, double *out) {
  const api_mood mood = a->mood;
  if (mood == API_ABSURD && !api_chance(a, 50)) a->mood = API_VALID;
  api_say(a, "%s = {", name);
  for (int c = 0; c < count; c++) {
    out[c] = draw_near(a, name, centre, width);
    say_real(a, "", out[c]);
  }
  a->length -= 2;
  api_say(a, "}, ");
  a->mood = mood;
}

int64_t api_whole(api *a, const char *name, int64_t lo, int64_t hi) {
  const uint64_t span = (uint64_t)hi - (uint64_t)lo + 1;
  int64_t value = span ? (int64_t)((uint64_t)lo + api_bits(a) % span) : lo;
  if (a->mood == API_EDGE && api_chance(a, 40)) value = api_chance(a, 50) ? lo : hi;
  if (turn(a)) {
    const int64_t values[] = {-1, lo - 1, hi + 1, INT32_MIN, INT32_MAX};
    value = values[api_below(a, API_COUNT(values))];
    if (value < lo || value > hi) api_wrong(a, name);
  }
  api_say(a, "%s = %" PRId64 ", ", name, value);
  return value;
}

int64_t api_least(api *a, const char *name, int64_t lo, int64_t hi) {
  int64_t value = lo + (int64_t)api_below(a, (uint32_t)(hi - lo + 1));
  if (turn(a)) {
    const int64_t values[] = {lo - 1, INT32_MIN, -1, lo};
    value = values[api_below(a, API_COUNT(values))];
    if (value < lo) api_wrong(a, name);
  }
  api_say(a, "%s = %" PRId64 ", ", name, value);
  return value;
}

int32_t api_choice(api *a, const char *name, int32_t count) {
  int32_t value = (int32_t)api_below(a, (uint32_t)count);
  if (turn(a)) {
    const int32_t values[] = {-1, count, 77, INT32_MIN, INT32_MAX};
    value = values[api_below(a, API_COUNT(values))];
    api_wrong(a, name);
  }
  api_say(a, "%s = %d, ", name, value);
  return value;
}

/* The ends of what a line allows, open ones moved inwards, of a choice its numbers. */
static void ends_of(const mpsi_def_member *m, double *lo, double *hi) {
  const mpsi_allowed *r = &m->allowed;
  *lo = r->checked ? (r->open_lower ? nextafter(r->lower, INFINITY) : r->lower) : -DBL_MAX;
  *hi = r->checked ? (r->open_upper ? nextafter(r->upper, -INFINITY) : r->upper) : DBL_MAX;
  if (r->or_zero && *lo > 0.0) *lo = 0.0;
  if (!r->choices) return;
  *lo = *hi = 0.0;
  for (const char *at = strchr(r->choices, '|'); at; at = strchr(at + 1, '|')) *hi += 1.0;
}

static void draw_member(api *a, const mpsi_def_member *m, void *def, int32_t c, double typical) {
  double lo, hi;
  ends_of(m, &lo, &hi);
  if (m->type == MPSI_MEMBER_REAL)
    mpsi_member_set(m, def, c, api_real(a, m->name, lo, hi, typical));
  else if (m->allowed.choices)
    mpsi_member_set(m, def, c, (double)api_choice(a, m->name, (int32_t)hi + 1));
  else
    mpsi_member_set(m, def, c, (double)api_least(a, m->name, (int64_t)lo, (int64_t)typical));
}

void api_define(api *a, int32_t kind, void *def, int32_t dim, const char *members) {
  const mpsi_definition *d = mpsi_definition_of(kind);
  const int wrong = a->wrong;
  char why[MPSI_WHY];
  for (const char *at = members; *at; at += strcspn(at, ","), at += strspn(at, ", ")) {
    char name[48] = "", seldom[2] = "";
    double typical = 0.0;
    if (sscanf(at, "%47[A-Za-z0-9_]%1[?]", name, seldom) < 1) break;
    (void)sscanf(at + strlen(name) + strlen(seldom), "%lf", &typical);
    const mpsi_def_member *m = mpsi_member_find(d, name);
    if (!m) {
      api_broken(a, "%s has no member %s", d->type, name);
      return;
    }
    if (seldom[0] && (a->latest || api_chance(a, 60))) continue;
    draw_member(a, m, def, m->count == 3 ? dim - 1 : 0, typical);
    for (int32_t c = 1; c < m->count && m->count != 3; c++)
      mpsi_member_set(m, def, c, mpsi_member_value(m, def, 0));
  }
  a->wrong = wrong;
  if (!mpsi_definition_check(d, def, dim ? (uint32_t)mpsi_scene_of(dim) : 0, why))
    api_wrong(a, "def");
  const uint32_t size = api_struct_size(a, d->size);
  memcpy(def, &size, sizeof size);
}

uint32_t api_struct_size(api *a, size_t size) {
  if (a->mood != API_ABSURD || !api_chance(a, 8)) return (uint32_t)size;
  const uint32_t values[] = {0, 1, 4, 7};
  const uint32_t value = values[api_below(a, API_COUNT(values))];
  api_say(a, "struct_size = %u, ", value);
  api_wrong(a, "struct_size");
  return value;
}

size_t api_size_of(api *a, size_t size) {
  if (!turn(a)) return size;
  const size_t values[] = {0, 1, 3, SIZE_MAX, size + 8, 4096};
  const uint32_t k = api_below(a, API_COUNT(values));
  api_say(a, "size = %zu, ", values[k]);
  if (k < 4) api_wrong(a, "size");
  return values[k];
}

bool api_null(api *a, const char *name) {
  if (a->mood != API_ABSURD || !api_chance(a, 6)) return false;
  api_say(a, "%s = NULL, ", name);
  api_wrong(a, name);
  return true;
}

/* ---- fields and ids -------------------------------------------------------------------------- */

static const char *const names[] = {"id",
                                    "position",
                                    "density",
                                    "velocity",
                                    "stress",
                                    "young",
                                    "poisson",
                                    "shear_velocity",
                                    "volume",
                                    "external_force",
                                    "reaction",
                                    "pressure",
                                    "displacement",
                                    "acceleration",
                                    "pressure_velocity",
                                    "damping",
                                    "temperature",
                                    "free_field",
                                    "mass",
                                    "velocity_gradient",
                                    "user.my_field",
                                    "body_acceleration"};
static const char *const no_names[] = {
    "",          "no such",
    "1st",       "a.b",
    "a..b",      ".",
    "%s%n",      "\xff\xfe",
    "position ", "a_name_that_is_longer_than_forty_seven_characters_of_it"};

const char *api_field(api *a, mps_particles *set) {
  const char *name = names[api_below(a, API_COUNT(names))];
  mps_particles_field_info info;
  const int32_t count = mps_particles_field_count(set);
  if (count > 0 && api_chance(a, 50) &&
      mps_particles_get_field_info(set, (int32_t)api_below(a, (uint32_t)count), &info) == MPS_OK)
    name = info.name;
  if (turn(a)) {
    name = no_names[api_below(a, API_COUNT(no_names))];
    api_wrong(a, "name");
  }
  api_say(a, "\"%s\", ", name);
  return name;
}

/* Absurd: one that the set lacks, or one twice; what a function makes of it is its own. */
int64_t api_ids(api *a, mps_particles *set, int64_t most, int64_t *ids) {
  const int64_t count = mps_particles_count(set);
  mps_view view;
  int64_t number = 0;
  api_say(a, "ids = {");
  if (count > 0 && most > 0 && mps_particles_view(set, "id", &view) == MPS_OK) {
    const int64_t longest = count < most ? count : most;
    number = 1 + (int64_t)api_below(a, (uint32_t)longest);
    const int64_t from = (int64_t)api_below(a, (uint32_t)(count - number + 1));
    for (int64_t k = 0; k < number; k++) ids[k] = *mps_view_i64(&view, from + k, 0);
    if (turn(a)) {
      const int64_t values[] = {-1, INT64_MAX, INT64_MIN, 1000000, ids[0]};
      ids[number - 1] = values[api_below(a, API_COUNT(values))];
    }
  }
  for (int64_t k = 0; k < number; k++) {
    if (k < 8 || k == number - 1) api_say(a, "%" PRId64 ", ", ids[k]);
    if (k == 8 && k < number - 1) api_say(a, "... ");
  }
  if (number > 0) a->length -= 2;
  api_say(a, "}, count = %" PRId64 ", ", number);
  return number;
}
