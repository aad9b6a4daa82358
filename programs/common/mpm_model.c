/* mpm_model.c - see mpm_model.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_model.h"

#include "frame.h"
#include "parts.h"
#include "resume.h"

#include <stdlib.h>
#include <string.h>

void mpm_model_destroy(mpm_model *model) {
  mps_history_destroy(&model->history);
  mps_mpm_destroy(&model->mpm);
  mps_fluid_destroy(&model->fluid);
  for (int b = 0; b < MPM_MODEL_BODIES; b++) mps_body_destroy(&model->body[b]);
  mps_material_destroy(&model->material);
  mps_particles_destroy(&model->particles);
  mps_particles_destroy(&model->whole);
}

const char *mpm_model_refuse_stiffness(const option *table, int contact) {
  if (contact == MPS_CONTACT_METHOD_PENALTY) return NULL;
  for (; table->name || table->help; table++)
    if (table->given && (strcmp(table->name, "k") == 0 || strcmp(table->name, "xi") == 0))
      return "--k and --xi need --contact penalty: impulses have no stiffness";
  return NULL;
}

const char *mpm_model_settle_edges(const option *table, int contact, double usual, double *corner,
                                   double *inset) {
  const bool rounded = options_given(table, "corner"), ended = options_given(table, "inset");
  if (ended && *inset > 0.0 && contact == MPS_CONTACT_METHOD_PENALTY)
    return "--inset is for --contact impulse";
  if (ended && *inset > 0.0 && rounded && *corner > 0.0)
    return "--corner and --inset exclude each other";
  if (!ended) *inset = rounded || contact == MPS_CONTACT_METHOD_PENALTY ? 0.0 : usual;
  if (*inset > 0.0) *corner = 0.0;
  return NULL;
}

const char *mpm_model_too_large(double particles) {
  return particles <= 1e8 ? NULL
                          : "more than 1e8 particles: take a coarser --cell, or a smaller model";
}

static double time_of(const mpm_model *model) {
  if (model->fluid) return mps_fluid_time(model->fluid);
  return model->mpm ? mps_mpm_time(model->mpm) : 0.0;
}

/* ---- several ranks --------------------------------------------------------------------------- */

static mps_status agree(const mpm_model *m, mps_status status) { return app_settle(m->a, status); }

mps_status mpm_model_create(mpm_model *m, mps_context *context, mps_status status,
                            mps_mpm_def *def) {
  status = agree(m, status);
  def->domain = m->a->domain;
  return status == MPS_OK ? mps_mpm_create(context, m->particles, m->material, def, &m->mpm)
                          : status;
}

mps_status mpm_model_whole(mpm_model *m, mps_particles **whole) {
  *whole = m->fluid && m->a->rank > 0 ? NULL : m->particles; /* a fluid is whole on each rank */
  if (!m->a->domain || m->fluid) return MPS_OK;
  *whole = NULL;
  const mps_status status =
      mps_domain_gather_fields(m->a->domain, m->particles, 0, NULL, &m->whole);
  if (status == MPS_OK) *whole = m->whole;
  return status;
}

typedef struct named_row {
  int64_t id, row;
} named_row;

static int by_id(const void *a, const void *b) {
  const int64_t x = ((const named_row *)a)->id, y = ((const named_row *)b)->id;
  return (x > y) - (x < y);
}

int64_t *mpm_rows_by_id(mps_particles *particles) {
  const int64_t count = mps_particles_count(particles);
  named_row *named = malloc((size_t)count * sizeof *named + 1);
  int64_t *rows = malloc((size_t)count * sizeof *rows + 1);
  mps_view id;
  if (!named || !rows || mps_particles_view(particles, "id", &id) != MPS_OK) {
    free(named);
    free(rows);
    return NULL;
  }
  bool sorted = true;
  for (int64_t k = 0; k < count; k++) {
    named[k] = (named_row){*mps_view_i64(&id, k, 0), k};
    sorted = sorted && (k == 0 || named[k].id > named[k - 1].id);
  }
  if (!sorted) qsort(named, (size_t)count, sizeof *named, by_id);
  for (int64_t k = 0; k < count; k++) rows[k] = named[k].row;
  free(named);
  return rows;
}

mps_status mpm_model_tell(mpm_model *m, mps_status status, int count, double *values) {
  status = agree(m, status);
  return status == MPS_OK && count > 0 ? app_share(m->a, m->a->rank == 0, count, values) : status;
}

/* On rank 0, as numbers that can be sent. */
static mps_status list_whole(mps_particles *whole,
                             bool (*chosen)(const void *user, const double *x), const void *user,
                             double *count, double **named) {
  mps_view x, id;
  mps_status status = mps_particles_view(whole, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(whole, "id", &id);
  if (status != MPS_OK) return status;
  *named = malloc((size_t)(x.shape[0] + 1) * sizeof **named);
  if (!*named) return MPS_ERROR_MEMORY;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    double at[3] = {0.0, 0.0, 0.0};
    for (int32_t c = 0; c < x.shape[1]; c++) at[c] = *mps_view_f64(&x, k, c);
    if (chosen(user, at)) (*named)[(int64_t)(*count)++] = (double)*mps_view_i64(&id, k, 0);
  }
  return MPS_OK;
}

mps_status mpm_model_list(mpm_model *m, bool (*chosen)(const void *user, const double *x),
                          const void *user, int64_t *count, int64_t **ids) {
  mps_particles *whole;
  double *named = NULL, all = 0.0;
  *ids = NULL;
  mps_status status = mpm_model_whole(m, &whole);
  if (status == MPS_OK && whole) status = list_whole(whole, chosen, user, &all, &named);
  status = mpm_model_tell(m, status, 1, &all);
  if (status == MPS_OK && !named) named = malloc((size_t)(all + 1.0) * sizeof *named);
  if (status == MPS_OK) *ids = malloc((size_t)(all + 1.0) * sizeof **ids);
  if (status == MPS_OK && (!named || !*ids)) status = MPS_ERROR_MEMORY;
  status = mpm_model_tell(m, status, (int)all, named);
  *count = (int64_t)all;
  for (int64_t k = 0; status == MPS_OK && k < *count; k++) (*ids)[k] = (int64_t)named[k];
  free(named);
  if (status == MPS_OK) return status;
  free(*ids);
  *ids = NULL;
  return status;
}

mps_status mpm_model_series(mpm_model *m, const char *directory, const char *what, double from,
                            mps_recorder **out) {
  mps_particles *whole;
  mps_status status = mpm_model_whole(m, &whole);
  if (status == MPS_OK && whole) status = frame_series(m->a, whole, directory, what, from, out);
  return mpm_model_tell(m, status, 0, NULL);
}

mps_status mpm_model_frame(mpm_model *m, mps_recorder *series) {
  mps_particles *whole;
  mps_status status = mpm_model_whole(m, &whole);
  if (status == MPS_OK && series) status = mps_recorder_write(series, time_of(m));
  return mpm_model_tell(m, status, 0, NULL);
}

mps_status mpm_model_sum(mpm_model *m, int64_t *value) { return parts_sum(m->a->domain, value); }

mps_status mpm_model_particles(mpm_model *m, mps_context *context, const mps_particles_def *def) {
  return parts_create(context, m->a->domain, def, &m->particles);
}

mps_status mpm_counts_note(mpm_model *m, mpm_counts *c, int64_t count, int64_t *most) {
  if (!m->a->domain) {
    if (count > *most) *most = count;
    return MPS_OK;
  }
  if (c->steps == c->room) {
    const int64_t room = 2 * c->room + 256;
    int64_t *grown = realloc(c->untold, (size_t)room * sizeof *grown);
    if (!grown) return MPS_ERROR_MEMORY;
    c->untold = grown, c->room = room;
  }
  c->untold[c->steps++] = count;
  return MPS_OK;
}

mps_status mpm_counts_join(mpm_model *m, mpm_counts *c, int64_t *most) {
  double any = 0.0;
  if (!m->a->domain) return MPS_OK;
  for (int64_t k = 0; k < c->steps; k++) any = c->untold[k] > 0 ? 1.0 : any;
  mps_status status = mps_domain_max(m->a->domain, 1, &any);
  for (int64_t k = 0; k < c->steps && status == MPS_OK && any > 0.0; k++) {
    status = mpm_model_sum(m, &c->untold[k]);
    if (status == MPS_OK && c->untold[k] > *most) *most = c->untold[k];
  }
  c->steps = 0;
  return status;
}

static mps_status count_all(mpm_model *m) {
  m->count = mps_particles_count(m->particles);
  return m->fluid ? MPS_OK : mpm_model_sum(m, &m->count);
}

mps_status mpm_model_advance(mpm_model *m, double t_end, int64_t every, mps_mpm_fn callback,
                             void *user) {
  /* a run of one step, as between close samples, calls no hook */
  double stop = progress_interrupted();
  mps_status status = m->a->domain ? mps_domain_max(m->a->domain, 1, &stop) : MPS_OK;
  if (status == MPS_OK && stop != 0.0) status = MPS_ERROR_CANCELLED;
  if (status != MPS_OK) return status;
  m->a->bar.call = mps_mpm_time(m->mpm);
  return mps_mpm_run(m->mpm, t_end, every, callback, user);
}

/* ---- the course of a run --------------------------------------------------------------------- */

/* Prints the one line on how the run ended; returns the exit code. */
static int end_run(app *a, mps_status status, const mpm_model *model, bool any) {
  if (status == MPS_OK || status == MPS_ERROR_CANCELLED || !model->why[0])
    return app_end_run(a, status, time_of(model), any);
  a->outcome = "failed";
  app_error(a, "%s", model->why);
  return APP_FAILED;
}

/* Results are written of every run that has some, also of one that Ctrl-C or an error ended: the
 * samples are those of complete steps. */
static int build_and_march(app *a, const mpm_model_places *places, mpm_model *model,
                           const mpm_model_parts *parts, void *user) {
  const bool places_found = resume_places(a, places->restart, places->checkpoint, places->out);
  if (!app_agree(a, places_found && (a->rank > 0 || output_directory(a, *places->out))))
    return APP_FAILED;
  if (!app_agree(a, a->rank > 0 || summary_reserve(a, *places->out))) return APP_FAILED;
  app_leave_at_once(a, !a->domain); /* hooks do not interrupt the building of a model */
  mps_status built = agree(model, parts->build(a->context, user));
  app_leave_at_once(a, false);
  if (built == MPS_OK) built = count_all(model);
  if (built != MPS_OK) return end_run(a, built, model, false);
  printf("%lld particles, dt %.4g s\n", (long long)model->count,
         model->fluid ? mps_fluid_dt(model->fluid) : mps_mpm_dt(model->mpm));
  fflush(stdout);
  mps_status status = agree(model, parts->march(user));
  const mps_status counted = count_all(model);
  if (status == MPS_OK) status = counted;
  const bool any = model->samples >= MPM_MODEL_SAMPLES;
  const int code = end_run(a, status, model, any);
  if (code != APP_OK && !any)
    return code == APP_INTERRUPTED && a->rank == 0 && !summary_bare(a, *places->out) ? APP_FAILED
                                                                                     : code;
  if (!app_agree(a, a->rank > 0 || parts->finish(a, user))) return APP_FAILED;
  double failed = model->failed; /* on any rank */
  if (a->domain && mps_domain_max(a->domain, 1, &failed) != MPS_OK) return APP_FAILED;
  return code == APP_OK && failed != 0.0 ? APP_FAILED : code;
}

int mpm_model_run(const options_program *program, int64_t threads, const mpm_model_places *places,
                  mpm_model *model, const mpm_model_parts *parts, void *user) {
  app a;
  if (!app_start(&a, program->name, threads)) return app_finish(&a, APP_FAILED);
  model->a = &a;
  const int code = build_and_march(&a, places, model, parts, user);
  if (code == APP_FAILED) app_agree(&a, false); /* all ranks know: the status is agreed upon */
  mpm_model_destroy(model);
  return app_finish(&a, code);
}

bool mpm_model_summary(app *a, const mpm_model *model, const char *directory, output *file) {
  if (!summary_open(file, a, directory)) return false;
  json_integer(file, "particles", model->count);
  json_integer(file, "steps",
               model->fluid ? mps_fluid_steps(model->fluid) : mps_mpm_steps(model->mpm));
  return true;
}
