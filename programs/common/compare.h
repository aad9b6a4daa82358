/* compare.h - a result beside a theory, an experiment or a formula. The reference is shown where
 * its assumptions hold; elsewhere it is null in summary.json, and a line says why. What is printed
 * and what is written follow from one comparison. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "output.h"

typedef struct comparison {
  const char *source;      /* of the reference: "Prandtl" */
  double value, reference; /* in one unit */
  char reason[200];        /* the first assumption that does not hold, "": all do */
} comparison;

/* Of a `value` with the `reference` of a source. A reference that is no number holds nowhere. */
comparison compare_with(const char *source, double value, double reference);
/* An assumption, and why it does not hold: a clause such as "the base is rough". */
void compare_require(comparison *c, bool holds, const char *format, ...) APP_PRINTF(3, 4);

bool compare_holds(const comparison *c);
/* value/reference - 1; NaN where there is no reference, or no value. */
double compare_error(const comparison *c);
/* The reference; NaN where it does not hold. */
double compare_reference(const comparison *c);

/* On stdout "No comparison with SOURCE: REASON." where the reference does not hold. */
void compare_tell(const comparison *c);
/* Warns of a value that is above a rigorous upper bound by more than results scatter: an error of
 * the grid or of the pace. `what`: "the factor of safety"; a bound that is no number bounds
 * nothing. */
void compare_bound(app *a, const char *what, double value, const char *source, double bound);
/* KEY and KEY_reason: the reference and null, or null and the reason. */
void json_comparison(output *file, const char *key, const comparison *c);
/* KEY alone: null, or the reason, of a comparison that has more numbers than one. */
void json_reason(output *file, const char *key, const comparison *c);
