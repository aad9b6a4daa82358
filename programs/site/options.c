/* options.c - the options of mps-site-response, and what they exclude.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "site.h"

#include <math.h>
#include <string.h>

bool site_is_pulse(const settings *s) {
  return strcmp(s->record, "sine") == 0 || strcmp(s->record, "ricker") == 0;
}

/* Options of the pulses or of a record alone. */
static const char *check_motion(const settings *s, const option *table) {
  static const char *const record[] = {"record-unit", "record-scale", "baseline", "record-step",
                                       "record-column"};
  static const char *const pulse[] = {"frequency", "acceleration"};
  const bool file = !site_is_pulse(s);
  for (int k = 0; k < 5; k++)
    if (!file && options_given(table, record[k]))
      return "--record-unit, --record-scale, --record-step, --record-column and --baseline are for "
             "--record FILE";
  for (int k = 0; k < 2; k++)
    if (file && options_given(table, pulse[k]))
      return "--frequency and --acceleration are for --record ricker and sine";
  if (strcmp(s->record, "sine") != 0 && options_given(table, "cycles"))
    return "--cycles is for --record sine";
  if (s->amplitude == 0.0) return "--acceleration must not be 0 m/s2";
  if (!file && s->frequency > s->highest)
    return "--frequency must be at most --max-frequency, which the cells are made for";
  if (s->scale == 0.0) return "--record-scale must not be 0";
  return NULL;
}

const char *site_settle(settings *s, const option *table) {
  const char *reason = check_motion(s, table);
  if (reason) return reason;
  if (!s->layers) return "--layers is missing: the file of the layers, see --help";
  if (s->undrained && !isnan(s->permeability))
    return "--undrained and --permeability exclude each other";
  if (s->sample > 0.1 / (isnan(s->highest) ? SITE_FREQUENCY_YIELDING : s->highest))
    return "--sample must be at most a tenth of the period of --max-frequency";
  if (!isnan(s->duration) && s->duration < 10.0 * s->sample)
    return "--duration must be at least ten times --sample";
  return NULL;
}
