/* definition.c - see definition.h. SPDX-License-Identifier: BSD-3-Clause */
#include "definition.h"

#include "digits.h"
#include "core/internal.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const mpsi_definition *const known_kinds[] = {
#define ENTRY(NAME, kind, type) [kind] = &mpsi_definition_of_##type,
    MPS_DEFINITION_TABLE(ENTRY)
#undef ENTRY
};
#define KINDS ((int32_t)(sizeof known_kinds / sizeof *known_kinds))

const mpsi_definition *mpsi_definition_of(int32_t kind) {
  return kind >= 0 && kind < KINDS ? known_kinds[kind] : NULL;
}

/* ---- one member ------------------------------------------------------------------------------ */

static bool is_number(const mpsi_def_member *m) { return m->type <= MPSI_MEMBER_REAL; }

static size_t size_of(const mpsi_def_member *m) {
  switch (m->type) {
  case MPSI_MEMBER_INT:
  case MPSI_MEMBER_BITS:
    return 4;
  case MPSI_MEMBER_CHAR:
    return 1;
  case MPSI_MEMBER_ADDRESS:
  case MPSI_MEMBER_CALL:
    return sizeof(void *);
  default:
    return 8;
  }
}

static char *place_of(const mpsi_def_member *m, const void *def, int32_t c) {
  return (char *)def + m->offset + (size_t)c * size_of(m);
}

double mpsi_member_value(const mpsi_def_member *m, const void *def, int32_t c) {
  union {
    int32_t whole;
    uint32_t bits;
    int64_t large;
    double real;
  } u;
  memcpy(&u, place_of(m, def, c), size_of(m));
  return m->type == MPSI_MEMBER_INT    ? u.whole
         : m->type == MPSI_MEMBER_BITS ? u.bits
         : m->type == MPSI_MEMBER_LONG ? (double)u.large
                                       : u.real;
}

void mpsi_member_set(const mpsi_def_member *m, void *def, int32_t c, double value) {
  const int32_t whole = m->type == MPSI_MEMBER_INT ? (int32_t)value : 0;
  const uint32_t bits = m->type == MPSI_MEMBER_BITS ? (uint32_t)value : 0;
  const int64_t large = m->type == MPSI_MEMBER_LONG ? (int64_t)value : 0;
  const void *from = m->type == MPSI_MEMBER_INT    ? (const void *)&whole
                     : m->type == MPSI_MEMBER_BITS ? (const void *)&bits
                     : m->type == MPSI_MEMBER_LONG ? (const void *)&large
                                                   : (const void *)&value;
  memcpy(place_of(m, def, c), from, size_of(m));
}

const mpsi_def_member *mpsi_member_find(const mpsi_definition *d, const char *name) {
  for (int32_t k = 0; k < d->count; k++)
    if (strcmp(d->member[k].name, name) == 0) return &d->member[k];
  return NULL;
}

/* The names of choices behind what they all begin with. */
static const char *names_of(const mpsi_allowed *a) {
  const char *colon = strchr(a->choices, ':');
  return colon ? colon + 1 : a->choices;
}

/* The name of a choice, and its length; 0 for a value that is none. */
static int choice(const mpsi_allowed *a, double value, const char **name) {
  const char *at = names_of(a);
  for (double k = 0.0; at; k += 1.0) {
    const char *bar = strchr(at, '|');
    *name = at;
    if (k == value) return bar ? (int)(bar - at) : (int)strlen(at);
    at = bar ? bar + 1 : NULL;
  }
  return 0;
}

static bool allows(const mpsi_allowed *a, double value) {
  const char *name;
  if (a->choices) return choice(a, value, &name) > 0;
  if (!a->checked || (a->or_nan && isnan(value)) || (a->or_zero && value == 0.0)) return true;
  return (a->open_lower ? value > a->lower : value >= a->lower) &&
         (a->open_upper ? value < a->upper : value <= a->upper);
}

static const void *address_of(const mpsi_def_member *m, const void *def, int32_t c) {
  const void *address;
  memcpy(&address, place_of(m, def, c), sizeof address);
  return address;
}

static bool good(const mpsi_def_member *m, const void *def, int32_t c) {
  if (!is_number(m)) return !m->allowed.needed || address_of(m, def, c);
  return allows(&m->allowed, mpsi_member_value(m, def, c));
}

static double default_of(const mpsi_def_member *m, int32_t c) {
  return m->axis == 0 || m->axis == c + 1 ? m->initial : 0.0;
}

static bool component_given(const mpsi_def_member *m, const void *def, int32_t c) {
  if (m->type == MPSI_MEMBER_CHAR) return *place_of(m, def, c) != 0;
  if (!is_number(m)) return address_of(m, def, c) != (const void *)m->text;
  const double value = mpsi_member_value(m, def, c), initial = default_of(m, c);
  return isnan(initial) ? !isnan(value) : value != initial;
}

bool mpsi_member_given(const mpsi_def_member *m, const void *def) {
  for (int32_t c = 0; c < m->count; c++)
    if (component_given(m, def, c)) return true;
  return false;
}

/* ---- messages -------------------------------------------------------------------------------- */

typedef struct writing {
  char *text;
  size_t length;
} writing;

static void say(writing *w, const char *format, ...) MPSI_PRINTF(2, 3);
static void say(writing *w, const char *format, ...) {
  va_list args;
  va_start(args, format);
  const int more = vsnprintf(w->text + w->length, MPSI_WHY - w->length, format, args);
  va_end(args);
  if (more > 0) w->length += (size_t)more;
  if (w->length >= MPSI_WHY) w->length = MPSI_WHY - 1;
}

/* The enumeration of a choice; NULL where its names are no constants ("no|yes"). */
static const char *enumeration_of(const mpsi_allowed *a) {
  const char *names = names_of(a);
  mpsi_name first;
  const int begin = names > a->choices ? (int)(names - a->choices) - 1 : 0;
  if (begin == 0) return NULL;
  snprintf(first.text, sizeof first.text, "%.*s%.*s", begin, a->choices, (int)strcspn(names, "|"),
           names);
  return mpsi_enumeration_of(first.text);
}

/* "MPS_X_KIND_A", or "1 (yes)"; the number of a value without a name */
static void say_choice(writing *w, const mpsi_allowed *a, double value) {
  const char *enumeration = enumeration_of(a), *name;
  const int length = choice(a, value, &name);
  if (enumeration)
    say(w, "%s", mpsi_name_of(enumeration, (int32_t)value).text);
  else if (length > 0)
    say(w, "%.0f (%.*s)", value, length, name);
  else
    say(w, "%.0f", value);
}

mpsi_name mpsi_member_text(const mpsi_def_member *m, double value) {
  char text[MPSI_WHY];
  writing w = {.text = text};
  mpsi_name out;
  if (m && m->allowed.choices)
    say_choice(&w, &m->allowed, value);
  else
    say(&w, "%.17g", value);
  snprintf(out.text, sizeof out.text, "%.*s", (int)sizeof out.text - 1, text);
  return out;
}

/* "MPS_X_KIND_A, MPS_X_KIND_B and MPS_X_KIND_C"; "0 (no) and 1 (yes)" */
static void say_choices(writing *w, const mpsi_allowed *a) {
  const char *names = names_of(a), *name;
  int32_t last = 0, said = 0;
  for (const char *at = strchr(names, '|'); at; at = strchr(at + 1, '|')) last++;
  for (int32_t k = 0; k <= last; k++) {
    if (choice(a, k, &name) == 0) continue;
    say(w, "%s", said++ == 0 ? "" : k < last ? ", " : " and ");
    say_choice(w, a, k);
  }
}

static void say_range(writing *w, const mpsi_allowed *r, bool whole) {
  const double a = r->lower, b = r->upper;
  const bool above = r->open_lower, below = r->open_upper;
  const bool finite = b == DBL_MAX;
  if (a == b)
    say(w, "must be %.9g", a);
  else if (a == -INFINITY && b == INFINITY)
    say(w, "must be a number");
  else if (finite && a == -DBL_MAX)
    say(w, "must be finite");
  else if (finite || b == INFINITY || (whole && (b == INT32_MAX || b >= 9e18)))
    say(w, "must be %s%s %.9g", finite && !whole ? "finite and " : "", above ? ">" : ">=", a);
  else if (a == -INFINITY)
    say(w, "must be %s %.9g", below ? "<" : "at most", b);
  else if (a == -b && !whole)
    say(w, "must be within +-%.9g", b);
  else if (above && below)
    say(w, "must be in (%.9g, %.9g)", a, b);
  else if (above)
    say(w, "must be > %.9g and at most %.9g", a, b);
  else if (below)
    say(w, "must be >= %.9g and below %.9g", a, b);
  else
    say(w, "must be in %.9g to %.9g", a, b);
  if (r->or_zero) say(w, ", or 0");
  if (r->or_nan) say(w, ", or NaN");
}

static void say_allowed(writing *w, const mpsi_allowed *a, bool whole) {
  if (a->choices) {
    say(w, "allowed are ");
    say_choices(w, a);
  } else
    say_range(w, a, whole);
}

void mpsi_allowed_text(const mpsi_allowed *a, bool whole, char text[MPSI_WHY]) {
  writing w = {.text = text};
  say_allowed(&w, a, whole);
}

static const char *gap(const mpsi_def_member *m) { return m->unit[0] ? " " : ""; }

/* "height is -1 m, "; for 6 digits that would read as an allowed number, more. */
static void say_value(writing *w, const mpsi_def_member *m, const void *def, int32_t c,
                      double lower, double upper) {
  say(w, m->count > 1 ? "%s[%d]" : "%s", m->name, (int)c);
  if (!is_number(m)) {
    say(w, " is %s, ", address_of(m, def, c) ? "given" : "NULL");
    return;
  }
  const double value = mpsi_member_value(m, def, c);
  if (m->type == MPSI_MEMBER_REAL)
    say(w, " is %s%s%s, ", mpsi_outside(value, lower, upper).text, gap(m), m->unit);
  else if (m->allowed.choices) {
    say(w, " is ");
    say_choice(w, &m->allowed, value);
    say(w, ", ");
  } else
    say(w, " is %.0f%s%s, ", value, gap(m), m->unit);
}

/* "height is -1 m, must be in ...": refuses component c, which is not `allowed`. */
static void refuse(writing *w, const mpsi_def_member *m, const mpsi_allowed *allowed,
                   const void *def, int32_t c) {
  say_value(w, m, def, c, allowed->lower, allowed->upper);
  if (!is_number(m))
    say(w, "must be given");
  else
    say_allowed(w, allowed, m->type != MPSI_MEMBER_REAL);
}

/* ---- a rule ---------------------------------------------------------------------------------- */

/* Of an integer, so that no conversion raises a flag. */
static bool is_one_of(uint32_t values, double value) {
  for (int k = 0; k < 32; k++)
    if ((values >> k & 1u) && value == k) return true;
  return false;
}

/* The member, `other` where it is NaN: comparisons of NaN raise a flag. */
static double number_or(const mpsi_def_member *m, const void *known, double other) {
  const double value = mpsi_member_value(m, known, 0);
  return isnan(value) ? other : value;
}

bool mpsi_case_applies(const mpsi_definition *d, const mpsi_def_case *when, const void *known,
                       uint32_t scene) {
  const mpsi_def_member *m = &d->member[when->member];
  switch (when->kind) {
  case MPSI_CASE_IS:
    return is_one_of(when->values, mpsi_member_value(m, known, 0));
  case MPSI_CASE_WITH:
    return mpsi_member_given(m, known);
  case MPSI_CASE_WITHOUT:
    return !mpsi_member_given(m, known);
  case MPSI_CASE_BEYOND:
    return number_or(m, known, -INFINITY) > when->limit;
  case MPSI_CASE_WITHIN:
    return number_or(m, known, INFINITY) <= when->limit;
  case MPSI_CASE_SCENE:
    return (when->values & scene) != 0;
  default:
    return true;
  }
}

static int digits_of(const mpsi_def_member *m) { return m->type == MPSI_MEMBER_REAL ? 9 : 17; }

/* "kind is MPS_X_KIND_A", "alloc is given" */
static void say_case(writing *w, const mpsi_definition *d, const mpsi_def_case *when,
                     const void *known, uint32_t scene) {
  const mpsi_def_member *m = &d->member[when->member];
  const double value = is_number(m) ? mpsi_member_value(m, known, 0) : 0.0;
  switch (when->kind) {
  case MPSI_CASE_IS:
    say(w, "%s is ", m->name);
    if (m->allowed.choices)
      say_choice(w, &m->allowed, value);
    else
      say(w, "%.0f", value);
    break;
  case MPSI_CASE_WITH:
  case MPSI_CASE_WITHOUT:
    if (is_number(m) && m->allowed.choices) {
      say(w, "%s is ", m->name);
      say_choice(w, &m->allowed, value);
    } else if (is_number(m) && m->count == 1 && !isnan(value))
      say(w, "%s is %.*g%s%s", m->name, digits_of(m), value, gap(m), m->unit);
    else
      say(w, "%s is %sgiven", m->name, when->kind == MPSI_CASE_WITH ? "" : "not ");
    break;
  case MPSI_CASE_SCENE:
    say(w, "the model is %s",
        scene == MPSI_SCENE_SPACE  ? "three-dimensional"
        : scene == MPSI_SCENE_AXIS ? "axisymmetric"
                                   : "plane");
    break;
  default:
    say(w, "%s is %.*g%s%s", m->name, digits_of(m), value, gap(m), m->unit);
  }
}

static void say_cases(writing *w, const mpsi_definition *d, const mpsi_def_rule *r,
                      const void *known, uint32_t scene) {
  const char *joint = " where ";
  for (const mpsi_def_case *k = r->when; k < r->when + MPSI_CASES; k++) {
    if (k->kind == MPSI_CASE_ALWAYS || k->kind == MPSI_CASE_BECAUSE) continue;
    say(w, "%s", joint);
    say_case(w, d, k, known, scene);
    joint = " and ";
  }
  for (const mpsi_def_case *k = r->when; k < r->when + MPSI_CASES; k++)
    if (k->kind == MPSI_CASE_BECAUSE) say(w, ": %s", k->text);
}

static bool compare(int demand, double value, double other) {
  if (isnan(value) || isnan(other)) return true;
  return demand == MPSI_DEMAND_LESS      ? value < other
         : demand == MPSI_DEMAND_MORE    ? value > other
         : demand == MPSI_DEMAND_AT_MOST ? value <= other
                                         : value >= other;
}

/* Refuses component c of the member, whose number is out of order with the other member's. */
static void refuse_order(writing *w, const mpsi_definition *d, const mpsi_def_rule *r,
                         const void *known, int32_t c) {
  static const char *const words[] = {"below", "above", "at most", "at least"};
  const mpsi_def_member *m = &d->member[r->member], *o = &d->member[r->other];
  const double other = r->factor * mpsi_member_value(o, known, o->count > 1 ? c : 0);
  const bool low = r->demand == MPSI_DEMAND_LESS || r->demand == MPSI_DEMAND_AT_MOST;
  say_value(w, m, known, c, low ? -INFINITY : other, low ? other : INFINITY);
  say(w, "must be %s ", words[r->demand - MPSI_DEMAND_LESS]);
  if (r->factor != 1.0) { /* the bound first, as of a range */
    say(w, "%g%s%s, %.9g times %s", other, gap(m), m->unit, r->factor, o->name);
    return;
  }
  say(w, o->count > 1 ? "%s[%d], " : "%s, ", o->name, (int)c);
  say(w, "%g%s%s", other, gap(m), m->unit);
}

static bool check_component(writing *w, const mpsi_definition *d, const mpsi_def_rule *r,
                            const void *known, int32_t c) {
  const mpsi_def_member *m = &d->member[r->member], *o = &d->member[r->other];
  const double value = is_number(m) ? mpsi_member_value(m, known, c) : 0.0;
  const bool unused = r->demand == MPSI_DEMAND_UNUSED;
  if (unused || r->demand == MPSI_DEMAND_NOT_GIVEN) {
    if (!component_given(m, known, c)) return true;
    say_value(w, m, known, c, default_of(m, c), default_of(m, c));
    if (unused)
      say(w, "without effect");
    else if (!is_number(m) || isnan(default_of(m, c)))
      say(w, is_number(m) ? "must be NaN" : "must be NULL");
    else if (m->allowed.choices) {
      say(w, "must be ");
      say_choice(w, &m->allowed, default_of(m, c));
    } else
      say(w, "must be %g", default_of(m, c));
    return false;
  }
  if (r->demand == MPSI_DEMAND_RANGE) {
    if (is_number(m) ? allows(&r->allowed, value) : !r->allowed.needed || address_of(m, known, c))
      return true;
    refuse(w, m, &r->allowed, known, c);
    return false;
  }
  if (compare(r->demand, value, r->factor * mpsi_member_value(o, known, o->count > 1 ? c : 0)))
    return true;
  refuse_order(w, d, r, known, c);
  return false;
}

/* Any component of the member. */
static bool check_given(writing *w, const mpsi_def_member *m, const void *known) {
  if (mpsi_member_given(m, known)) return true;
  say_value(w, m, known, 0, -INFINITY, INFINITY);
  if (m->allowed.checked && isnan(m->initial)) {
    mpsi_allowed a = m->allowed;
    a.or_nan = false;
    say_allowed(w, &a, m->type != MPSI_MEMBER_REAL);
  } else
    say(w, "must be given");
  return false;
}

/* The numbers that an address leads to. */
static bool check_each(writing *w, const mpsi_definition *d, const mpsi_def_rule *r,
                       const void *known) {
  const mpsi_def_member *m = &d->member[r->member];
  const double *x = address_of(m, known, 0);
  const int64_t count = (int64_t)(r->factor * mpsi_member_value(&d->member[r->other], known, 0));
  for (int64_t k = 0; x && k < count; k++) {
    const bool rises = r->demand != MPSI_DEMAND_RISING || k == 0 || x[k] > x[k - 1];
    if (allows(&r->allowed, x[k]) && rises) continue;
    say(w, "%s[%lld] is %s%s%s, ", m->name, (long long)k,
        mpsi_outside(x[k], r->allowed.lower, r->allowed.upper).text, gap(m), m->unit);
    if (rises || !allows(&r->allowed, x[k]))
      say_allowed(w, &r->allowed, false);
    else
      say(w, "must be above the one before, %g%s%s", x[k - 1], gap(m), m->unit);
    return false;
  }
  return true;
}

bool mpsi_rule_check(const mpsi_definition *d, const mpsi_def_rule *r, const void *known,
                     uint32_t scene, char why[MPSI_WHY]) {
  writing w = {.text = why};
  const mpsi_def_member *m = &d->member[r->member];
  const int32_t all = m->count == 3 && scene && scene != MPSI_SCENE_SPACE ? 2 : m->count;
  const int32_t end = r->end ? r->end : all;
  bool good = true;
  for (const mpsi_def_case *k = r->when; k < r->when + MPSI_CASES; k++)
    if (!mpsi_case_applies(d, k, known, scene)) return true;
  if (r->demand == MPSI_DEMAND_GIVEN)
    good = check_given(&w, m, known);
  else if (r->demand == MPSI_DEMAND_EACH || r->demand == MPSI_DEMAND_RISING)
    good = check_each(&w, d, r, known);
  else
    for (int32_t c = r->begin; c < end && good; c++) good = check_component(&w, d, r, known, c);
  if (!good) say_cases(&w, d, r, known, scene);
  return good;
}

/* ---- a definition ---------------------------------------------------------------------------- */

bool mpsi_definition_check(const mpsi_definition *d, const void *known, uint32_t scene,
                           char why[MPSI_WHY]) {
  for (const mpsi_def_member *m = d->member; m < d->member + d->count; m++)
    for (int32_t c = 0; c < (m->type == MPSI_MEMBER_CHAR ? 1 : m->count); c++)
      if (!good(m, known, c)) {
        writing w = {.text = why};
        refuse(&w, m, &m->allowed, known, c);
        return false;
      }
  for (const mpsi_def_rule *r = d->rule; r && r < d->rule + d->rules; r++)
    if (r->demand != MPSI_DEMAND_UNUSED && !mpsi_rule_check(d, r, known, scene, why)) return false;
  return true;
}

static void fill(const mpsi_definition *d, void *def) {
  const uint32_t size = (uint32_t)d->size;
  memset(def, 0, d->size);
  memcpy(def, &size, sizeof size);
  for (const mpsi_def_member *m = d->member; m < d->member + d->count; m++)
    for (int32_t c = 0; c < m->count; c++)
      if (m->text)
        memcpy(place_of(m, def, c), &m->text, sizeof m->text);
      else if (is_number(m) && default_of(m, c) != 0.0) /* or NaN */
        mpsi_member_set(m, def, c, default_of(m, c));
}

void mpsi_definition_fill(const mpsi_definition *d, void *def, size_t size) {
  union {
    double align;
    char bytes[MPSI_STRUCT_MOST];
  } known;
  const uint32_t stored = (uint32_t)size;
  fill(d, &known);
  memset(def, 0, size);
  memcpy(def, &known, size < d->size ? size : d->size);
  memcpy(def, &stored, sizeof stored); /* struct_size is the first member of every definition */
}

mps_status mpsi_definition_take(const mpsi_definition *d, const void *def, void *known,
                                uint32_t scene, char why[MPSI_WHY]) {
  writing w = {.text = why};
  uint32_t size = (uint32_t)d->size;
  fill(d, known);
  if (def) memcpy(&size, def, sizeof size);
  if (size < d->released || size > MPSI_STRUCT_MOST) {
    if (size == 0)
      say(&w, "def is filled with zeros (its struct_size is 0): start from %s()", d->defaults);
    else
      say(&w, "def.struct_size is %u bytes, allowed are %zu to %d: start from %s()", size,
          d->released, MPSI_STRUCT_MOST, d->defaults);
    return MPS_ERROR_ARGUMENT;
  }
  for (size_t i = d->size; i < size; i++)
    if (((const unsigned char *)def)[i] != 0) {
      say(&w,
          "def has a non-zero member at byte %zu that this library (version %d.%d) does not know",
          i, MPS_VERSION_MAJOR, MPS_VERSION_MINOR);
      return MPS_ERROR_UNSUPPORTED;
    }
  if (def) memcpy(known, def, size < d->size ? size : d->size);
  return mpsi_definition_check(d, known, scene, why) ? MPS_OK : MPS_ERROR_ARGUMENT;
}
