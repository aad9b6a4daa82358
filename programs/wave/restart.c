/* restart.c - options and results in a checkpoint of mps-wave: the options as mps-info lists them,
 * the model that they make as a text of one value a line, then numbers.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "wave.h"

#include "common/options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OPTIONS = 4096, TEXT = 16384, HEAD = 8 }; /* bytes, bytes, numbers */

/* ---- the model ------------------------------------------------------------------------------- */

static void add(char *text, const char *name, double value) {
  const size_t at = strlen(text);
  snprintf(text + at, TEXT - at, "%s %.17g\n", name, value);
}

/* Values that must be the same at a restart. */
static void describe(const settings *s, char *text) {
  text[0] = '\0';
  const struct {
    const char *name;
    double value;
  } options[] = {{"spacing", s->spacing},
                 {"width", s->width},
                 {"height", s->height},
                 {"wave", s->wave},
                 {"f1", s->f1},
                 {"f2", s->f2},
                 {"frequency", s->frequency},
                 {"peak-time", s->peak_time},
                 {"acceleration", s->amplitude},
                 {"record-scale", s->scale},
                 {"record-unit", s->unit},
                 {"baseline", s->baseline},
                 {"base", s->base},
                 {"base-vs", s->half_space.vs},
                 {"base-vp", s->half_space.vp},
                 {"base-unit-weight", s->half_space.unit_weight},
                 {"sides", s->sides},
                 {"integrator", s->integrator},
                 {"rotation", s->rotation},
                 {"torque", s->torque},
                 {"damping-form", s->damping_form},
                 {"receivers", (double)s->receivers},
                 {"incline", s->slope[0]},
                 {"incline", s->slope[1]},
                 {"incline", s->slope[2]}};
  for (int64_t k = 0; k < s->ground.count; k++) { /* by --layers, or the options named here */
    const layer *l = &s->ground.layer[k];
    add(text, s->layers_file ? "layers" : "height", l->thickness);
    add(text, s->layers_file ? "layers" : "vs", l->vs);
    add(text, s->layers_file ? "layers" : "vp", l->vp);
    add(text, s->layers_file ? "layers" : "unit-weight", l->unit_weight);
    add(text, s->layers_file ? "layers" : "damping", l->damping);
  }
  for (size_t k = 0; k < sizeof options / sizeof *options; k++)
    add(text, options[k].name, options[k].value);
  const size_t at = strlen(text);
  snprintf(text + at, TEXT - at, "record %s\n", s->input);
}

/* Names the first line that differs. */
static bool same_options(app *a, const char *here, const char *there) {
  while (*here || *there) {
    const int n = (int)strcspn(here, "\n"), m = (int)strcspn(there, "\n");
    if (n != m || strncmp(here, there, (size_t)n) != 0)
      return app_error(a,
                       "--restart: the checkpoint is of another model: --%.*s there, --%.*s here",
                       m, there, n, here);
    here += n + (here[n] != '\0');
    there += m + (there[m] != '\0');
  }
  return true;
}

/* ---- the block ------------------------------------------------------------------------------- */

void *restart_pack(const results_so_far *r, int64_t *size) {
  const receivers *q = r->record;
  const int64_t width = q->count + 1;
  *size = OPTIONS + TEXT + (HEAD + q->rows * width + r->peaks->count) * (int64_t)sizeof(double);
  char *block = calloc(1, (size_t)*size);
  if (!block) return NULL;
  if (!options_record(options_read(), block, OPTIONS)) memset(block, 0, OPTIONS); /* too long */
  describe(r->s, block + OPTIONS);
  double *number = (double *)(void *)(block + OPTIONS + TEXT);
  const double head[HEAD] = {(double)q->rows,  (double)width,       (double)r->peaks->count,
                             (double)r->every, (double)q->energies, q->energy_least,
                             q->energy_most,   q->energy_sum};
  memcpy(number, head, sizeof head);
  if (q->rows > 0) memcpy(number + HEAD, q->row, (size_t)(q->rows * width) * sizeof *number);
  if (r->peaks->count > 0)
    memcpy(number + HEAD + q->rows * width, r->peaks->peak,
           (size_t)r->peaks->count * sizeof *number);
  return block;
}

bool restart_unpack(app *a, results_so_far *r, const void *block, int64_t size) {
  receivers *q = r->record;
  const int64_t width = q->count + 1;
  char *here = calloc(1, TEXT);
  double head[HEAD];
  if (!here) return app_no_memory(a);
  describe(r->s, here);
  const char *model = (const char *)block + OPTIONS;
  const bool whole =
      size >= OPTIONS + TEXT + (int64_t)sizeof head && memchr(model, '\0', TEXT) != NULL;
  const bool same = whole && same_options(a, here, model);
  free(here);
  if (!whole) return app_error(a, "--restart: the checkpoint is not one of mps-wave");
  if (!same) return false;
  const char *numbers = model + TEXT;
  memcpy(head, numbers, sizeof head);
  const int64_t rows = (int64_t)head[0], peaks = (int64_t)head[2];
  if (!(head[0] >= 0.0 && head[0] < 1e9) || head[1] != (double)width || peaks != r->peaks->count ||
      size != OPTIONS + TEXT + (HEAD + rows * width + peaks) * (int64_t)sizeof(double))
    return app_error(a, "--restart: the results in the checkpoint are damaged");
  double *row = malloc((size_t)(rows * width + 1) * sizeof *row);
  if (!row) return app_no_memory(a);
  memcpy(row, numbers + sizeof head, (size_t)(rows * width) * sizeof *row);
  if (peaks > 0)
    memcpy(r->peaks->peak, numbers + sizeof head + (size_t)(rows * width) * sizeof *row,
           (size_t)peaks * sizeof *row);
  free(q->row);
  q->row = row;
  q->rows = q->capacity = rows;
  r->every = (int64_t)head[3];
  q->energies = (int64_t)head[4];
  q->energy_least = head[5], q->energy_most = head[6], q->energy_sum = head[7];
  return true;
}
