/* tables.c - prints what the library's tables say of definitions and fields, a line each:
 *
 *   definition  struct  member  type  count  unit  lower  upper  allowed besides  default  choices
 *   field  name  type  components in 2D  in 3D  unit  lower  upper  first release
 *
 * "(" before, and ")" behind an end of a range: without that end. SPDX-License-Identifier: BSD-3-Clause */
#include "core/definition/definition.h"
#include "core/particles/fields.h"
#include "core/internal.h"

#include <stdio.h>
#include <string.h>

static void print_member(const mpsi_definition *d, const mpsi_def_member *m) {
  static const char *const types[] = {"INT", "BITS", "LONG", "REAL", "CHAR", "ADDRESS", "CALL"};
  const mpsi_allowed *allowed = &m->allowed;
  printf("definition\t%s\t%s\t%s\t%d\t%s\t", d->type, m->name, types[m->type], (int)m->count, m->unit);
  if (allowed->checked)
    printf("%s%.17g\t%.17g%s", allowed->open_lower ? "(" : "", allowed->lower, allowed->upper, allowed->open_upper ? ")" : "");
  else
    printf("-\t-");
  printf("\t%s%s%s\t", allowed->or_nan ? "nan " : "", allowed->or_zero ? "zero " : "", allowed->needed ? "needed" : "");
  if (m->text)
    printf("\"%s\"", m->text);
  else
    printf("%.17g", m->initial);
  if (m->axis) printf(" in component %d", m->axis - 1);
  printf("\t%s\n", allowed->choices ? allowed->choices : "");
}

/* Every field, with the range that it has by default. */
static void print_fields(void) {
  static const struct {
    const char *name, *type, *unit, *since;
    int32_t components;
  } fields[] = {
#define FIELD(name, type, components, unit, meaning, writer, valid, since) {#name, #type, unit, #since, components},
      MPSI_FIELD_TABLE(FIELD)
#undef FIELD
  };
  static const struct {
    const char *name;
    double lower, upper;
  } ranges[] = {
#define RANGE(name, lower, upper) {#name, lower, upper},
      MPSI_FIELD_RANGES(RANGE)
#undef RANGE
  };
  for (size_t k = 0; k < sizeof fields / sizeof *fields; k++) {
    double lower = -MPSI_LARGEST, upper = MPSI_LARGEST;
    for (size_t r = 0; r < sizeof ranges / sizeof *ranges; r++)
      if (strcmp(ranges[r].name, fields[k].name) == 0) lower = ranges[r].lower, upper = ranges[r].upper;
    printf("field\t%s\t%s\t%d\t%d\t%s\t%.17g\t%.17g\t%s\n", fields[k].name, fields[k].type,
           (int)mpsi_field_components(fields[k].components, 2), (int)mpsi_field_components(fields[k].components, 3),
           fields[k].unit, lower, upper, fields[k].since);
  }
}

int main(void) {
  for (int32_t kind = 0; kind < 1000; kind++) {
    const mpsi_definition *d = mpsi_definition_of(kind);
    for (int32_t k = 0; d && k < d->count; k++) print_member(d, &d->member[k]);
  }
  print_fields();
  return 0;
}
