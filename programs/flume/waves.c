/* waves.c - the sea of mps-flume from its options, and the pistons at its ends.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/record.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 40 }; /* a period, of a record read from a file */

static mps_waves_def definition(const flume_settings *s) {
  mps_waves_def def = mps_waves_defaults();
  static const int32_t kinds[] = {MPS_WAVES_REGULAR, MPS_WAVES_JONSWAP, MPS_WAVES_PIERSON_MOSKOWITZ,
                                  MPS_WAVES_JONSWAP, MPS_WAVES_RECORD,  MPS_WAVES_SOLITARY};
  def.kind = kinds[s->waves];
  def.theory = s->order;
  def.depth = s->depth, def.gravity = WAVES_G;
  def.height = s->height;
  if (s->waves != FLUME_SOLITARY) def.period = s->period;
  def.gamma = s->gamma, def.repeat = s->repeat, def.ramp = s->ramp;
  def.seed = s->seed;
  def.stroke = s->stroke, def.speed = s->speed;
  if (s->waves == FLUME_JONSWAP || s->waves == FLUME_PM)
    def.phases = s->random ? MPS_WAVES_PHASES_AMPLITUDES : MPS_WAVES_PHASES_RANDOM;
  if (s->waves == FLUME_FOCUSED) {
    def.phases = MPS_WAVES_PHASES_FOCUSED;
    def.crest = 0.5 * s->height;
    def.position = s->focus[0], def.time = s->focus[1];
  }
  return def;
}

static double height_of(int64_t count, const double *level) {
  double sum = 0.0, square = 0.0;
  for (int64_t k = 0; k < count; k++) sum += level[k], square += level[k] * level[k];
  return 4.0 * sqrt(fmax(square - sum * sum / (double)count, 0.0) / (double)count);
}

/* The record of the file at even intervals: a table of displacements between whose samples is a
 * spline. */
static mps_status read_file(app *a, flume *m, mps_waves_def *def, double **room) {
  const flume_settings *s = &m->s;
  mps_signal_record_def record = mps_signal_record_defaults();
  mps_signal *signal = NULL;
  double start, end;
  record.column = s->column, record.format = MPS_SIGNAL_RECORD_FORMAT_CSV;
  record.quantity = MPS_SIGNAL_QUANTITY_DISPLACEMENT;
  const mps_status status = record_read(a, "levels", s->file, &record, &signal);
  if (status != MPS_OK) return status;
  mps_signal_span(signal, &start, &end);
  def->samples = (int64_t)fmin(fmax(ceil(POINTS * (end - start) / s->period), 16.0), 2e6);
  *room = malloc(2 * (size_t)def->samples * sizeof **room);
  if (*room) {
    double *t = *room, *level = t + def->samples;
    for (int64_t k = 0; k < def->samples; k++) {
      t[k] = start + (end - start) * (double)k / (double)(def->samples - 1);
      level[k] = mps_signal_displacement(signal, t[k]);
    }
    def->times = t, def->levels = level;
    m->record_height = height_of(def->samples, level);
  }
  m->record = signal;
  return *room ? MPS_OK : MPS_ERROR_MEMORY;
}

/* The library's words of a choice, as the options have them. */
static void say_by_options(const char *reason, size_t size, char *text) {
  static const char *const words[][2] = {{"theory MPS_WAVES_THEORY_STREAM", "--order stream"},
                                         {"MPS_WAVES_THEORY_STREAM", "--order stream"},
                                         {"MPS_WAVES_THEORY_SECOND", "--order second"},
                                         {"MPS_WAVES_REGULAR", "--waves regular"},
                                         {"take SECOND", "take --order second"}};
  size_t used = 0;
  while (*reason && used + 1 < size) {
    size_t taken = 1;
    const char *put = reason;
    int length = 1;
    for (size_t k = 0; k < sizeof words / sizeof *words && taken == 1; k++)
      if (strncmp(reason, words[k][0], strlen(words[k][0])) == 0)
        taken = strlen(words[k][0]), put = words[k][1], length = (int)strlen(put);
    used += (size_t)snprintf(text + used, size - used, "%.*s", length, put);
    reason += taken;
  }
}

/* Reasons of the library begin with the member that is the key of the model file. */
static void find_line(app *a, flume *m) {
  char key[40] = "", text[300] = "";
  const char *reason = mps_context_error(a->context)->message;
  const size_t length = strcspn(reason, " ");
  say_by_options(reason, sizeof text, text);
  snprintf(m->why, sizeof m->why, "%.399s", text);
  if (!m->text || length >= sizeof key) return;
  memcpy(key, reason, length);
  const document *at = document_find(m->text, key);
  if (at) snprintf(m->why, sizeof m->why, "%.150s, line %d: %.220s", m->s.model, at->line, text);
}

mps_status flume_make_waves(app *a, flume *m) {
  mps_waves_def def = definition(&m->s);
  double *room = NULL;
  mps_waves_report report = {0};
  mps_status status = MPS_OK;
  if (m->s.waves == FLUME_FILE) status = read_file(a, m, &def, &room);
  if (status == MPS_OK) status = mps_waves_create(a->context, &def, &m->waves);
  free(room);
  if (status == MPS_ERROR_ARGUMENT) find_line(a, m);
  if (status == MPS_OK) status = mps_waves_get_report(m->waves, &report);
  if (status == MPS_OK) m->wave_length = 2.0 * WAVES_PI / report.wave_number;
  const double most = fmax(report.stroke[1], -report.stroke[0]);
  if (status == MPS_OK && !(most < m->s.length)) {
    snprintf(m->why, sizeof m->why,
             "these waves need a maker that moves by %.3g m, must be below --length %g m", most,
             m->s.length);
    status = MPS_ERROR_ARGUMENT;
  }
  return app_settle(a, status);
}

/* Either end, of a solitary wave the far one; that is asked for still water. */
mps_status flume_make_pistons(app *a, flume *m) {
  mps_absorber_def def = mps_absorber_defaults();
  def.form = m->s.form ? MPS_ABSORBER_FORM_SHALLOW : MPS_ABSORBER_FORM_TUNED;
  def.depth = m->s.depth, def.gravity = WAVES_G;
  def.period = m->s.period;
  if (!isnan(m->s.stroke)) def.stroke = m->s.stroke;
  def.waves = m->waves;
  if (m->s.absorb != FLUME_ACTIVE) return MPS_OK;
  mps_status status = MPS_OK;
  if (m->s.waves == FLUME_SOLITARY)
    def.form = MPS_ABSORBER_FORM_SHALLOW; /* the maker stays where the wave leaves it */
  else
    status = mps_absorber_create(a->context, &def, &m->maker);
  def.waves = NULL, def.depth = flume_end_depth(m);
  if (status == MPS_OK && m->s.wall == FLUME_OPEN_END && !flume_is_open(m) && flume_end_is_wet(m))
    status = mps_absorber_create(a->context, &def, &m->end);
  return app_settle(a, status);
}
