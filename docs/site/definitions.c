/* definitions.c - prints the tables of all definitions (src/core/definition) as JSON, for the pages of
 * the reference: {"mps_x_def": [[member, unit, default, allowed, [rule, ...]], ...], ...}.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/definition/definition.h"
#include "core/internal.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* What messages about a value ask for; the tables have none. */
mpsi_name mpsi_name_of(const char *enumeration, int32_t value) { return (mpsi_name){""}; }
const char *mpsi_enumeration_of(const char *name) { return NULL; }

static const char *allowed(const mpsi_def_member *m, const mpsi_allowed *a, char text[MPSI_WHY]) {
  text[0] = '\0';
  if (a->needed) return "given";
  if (m->type > MPSI_MEMBER_REAL || !(a->checked || a->choices)) return text;
  mpsi_allowed_text(a, m->type != MPSI_MEMBER_REAL, text);
  return strncmp(text, "must be ", 8) == 0 ? text + 8 : text + strlen("allowed are ");
}

static void print_default(const mpsi_def_member *m) {
  if (m->text)
    printf("\\\"%s\\\"", m->text);
  else if (m->type > MPSI_MEMBER_REAL)
    printf(m->type == MPSI_MEMBER_CHAR ? "empty" : "NULL");
  else if (isnan(m->initial))
    printf("unset");
  else
    printf("%.9g%s", m->initial, m->axis ? ", other components 0" : "");
}

/* The bits of a choice by their names. */
static void print_choices(const mpsi_def_member *m, uint32_t values) {
  const char *at = m->allowed.choices ? m->allowed.choices : "", *colon = strchr(at, ':');
  const int begin = colon ? (int)(colon - at) : 0;
  const char *head = at, *joint = "";
  if (colon) at = colon + 1;
  for (int k = 0; at; k++) {
    const char *bar = strchr(at, '|');
    const int length = bar ? (int)(bar - at) : (int)strlen(at);
    if (values >> k & 1u && length > 0) {
      printf("%s%.*s%.*s", joint, begin, head, length, at);
      joint = " or ";
    }
    at = bar ? bar + 1 : NULL;
  }
}

static void print_case(const mpsi_definition *d, const mpsi_def_case *c, const char *joint) {
  const mpsi_def_member *m = &d->member[c->member];
  if (c->kind == MPSI_CASE_ALWAYS || c->kind == MPSI_CASE_BECAUSE) return;
  printf("%s", joint);
  switch (c->kind) {
  case MPSI_CASE_IS:
    printf("%s is ", m->name);
    print_choices(m, c->values);
    return;
  case MPSI_CASE_WITH:
  case MPSI_CASE_WITHOUT:
    printf("%s is %sgiven", m->name, c->kind == MPSI_CASE_WITH ? "" : "not ");
    return;
  case MPSI_CASE_SCENE:
    printf("the model is %s", c->values == MPSI_SCENE_SPACE  ? "three-dimensional"
                              : c->values == MPSI_SCENE_AXIS ? "axisymmetric"
                                                             : "plane");
    return;
  default:
    printf("%s is %s %.9g", m->name, c->kind == MPSI_CASE_BEYOND ? "above" : "at most", c->limit);
  }
}

static void print_rule(const mpsi_definition *d, const mpsi_def_rule *r) {
  static const char *const words[] = {
      [MPSI_DEMAND_LESS] = "below ",      [MPSI_DEMAND_MORE] = "above ",
      [MPSI_DEMAND_AT_MOST] = "at most ", [MPSI_DEMAND_AT_LEAST] = "at least "};
  const mpsi_def_member *m = &d->member[r->member], *o = &d->member[r->other];
  const mpsi_def_member number = {.type = MPSI_MEMBER_REAL};
  char text[MPSI_WHY];
  if (r->end == r->begin + 1 && m->count > 1) printf("component %d ", r->begin);
  if (r->end == 2 && r->begin == 0 && m->count == 3) printf("components 0 and 1 ");
  if (r->demand == MPSI_DEMAND_GIVEN || r->demand == MPSI_DEMAND_NOT_GIVEN)
    printf(r->demand == MPSI_DEMAND_GIVEN ? "given" : "not given");
  else if (r->demand == MPSI_DEMAND_UNUSED)
    printf("without effect, warned of");
  else if (r->demand == MPSI_DEMAND_RANGE)
    printf("%s", allowed(m, &r->allowed, text));
  else if (r->demand >= MPSI_DEMAND_EACH)
    printf("%seach %s", r->demand == MPSI_DEMAND_RISING ? "ascending, " : "",
           allowed(&number, &r->allowed, text));
  else if (r->factor == 1.0)
    printf("%s%s", words[r->demand], o->name);
  else
    printf("%s%.6g times %s", words[r->demand], r->factor, o->name);
  const char *joint = " where ";
  for (int k = 0; k < MPSI_CASES; k++) {
    print_case(d, &r->when[k], joint);
    if (r->when[k].kind != MPSI_CASE_ALWAYS) joint = " and ";
  }
}

static void print_member(const mpsi_definition *d, const mpsi_def_member *m) {
  char text[MPSI_WHY];
  printf("[\"%s\", \"%s\", \"", m->name, m->unit);
  print_default(m);
  printf("\", \"%s\", [", allowed(m, &m->allowed, text));
  const char *comma = "";
  for (int32_t k = 0; k < d->rules; k++) {
    if (&d->member[d->rule[k].member] != m) continue;
    printf("%s\"", comma);
    print_rule(d, &d->rule[k]);
    printf("\"");
    comma = ", ";
  }
  printf("]]");
}

int main(void) {
#define KIND(name, kind, type) kind,
  static const int32_t kinds[] = {MPS_DEFINITION_TABLE(KIND)};
#undef KIND
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
    const mpsi_definition *d = mpsi_definition_of(kinds[k]);
    printf("%s\"%s\": [", k ? ",\n" : "{", d->type);
    for (int32_t m = 0; m < d->count; m++) {
      if (m > 0) printf(",\n  ");
      print_member(d, &d->member[m]);
    }
    printf("]");
  }
  printf("}\n");
  return 0;
}
