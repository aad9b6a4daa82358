/* compare.c - see compare.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "compare.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

#define SCATTER 0.03 /* of results by the place of edges on the grid, and by speed */

comparison compare_with(const char *source, double value, double reference) {
  return (comparison){.source = source, .value = value, .reference = reference};
}

void compare_require(comparison *c, bool holds, const char *format, ...) {
  if (holds || c->reason[0]) return;
  va_list args;
  va_start(args, format);
  vsnprintf(c->reason, sizeof c->reason, format, args);
  va_end(args);
  /* of a run that ended before what the assumption is about */
  if (strstr(c->reason, " nan") || strstr(c->reason, "-nan"))
    snprintf(c->reason, sizeof c->reason, "the run has ended before there is a result");
}

bool compare_holds(const comparison *c) { return !c->reason[0] && isfinite(c->reference); }

double compare_reference(const comparison *c) { return compare_holds(c) ? c->reference : NAN; }

double compare_error(const comparison *c) { return c->value / compare_reference(c) - 1.0; }

static const char *reason_of(const comparison *c) {
  return c->reason[0] ? c->reason : "it has no value here";
}

void compare_tell(const comparison *c) {
  if (!compare_holds(c)) printf("No comparison with %s: %s.\n", c->source, reason_of(c));
}

void compare_bound(app *a, const char *what, double value, const char *source, double bound) {
  if (value > bound * (1.0 + SCATTER))
    app_warn(a,
             "%s is %.1f %% above that of %s, which such ground cannot exceed: take smaller cells "
             "(--cell), or a slower pace",
             what, 100.0 * (value / bound - 1.0), source);
}

void json_reason(output *file, const char *key, const comparison *c) {
  if (compare_holds(c))
    json_number(file, key, NAN);
  else
    json_text(file, key, reason_of(c));
}

void json_comparison(output *file, const char *key, const comparison *c) {
  char name[80];
  snprintf(name, sizeof name, "%s_reason", key);
  json_number(file, key, compare_reference(c));
  json_reason(file, name, c);
}
