/* mpm_model.c - see mpm_model.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_model.h"

#include <string.h>

void mpm_model_destroy(mpm_model *model) {
  mps_mpm_destroy(&model->mpm);
  mps_fluid_destroy(&model->fluid);
  for (int b = 0; b < MPM_MODEL_BODIES; b++) mps_body_destroy(&model->body[b]);
  mps_material_destroy(&model->material);
  mps_particles_destroy(&model->particles);
}

const char *mpm_model_refuse_stiffness(const option *table, int contact) {
  if (contact == MPS_CONTACT_METHOD_PENALTY) return NULL;
  for (; table->help; table++)
    if (table->given && (strcmp(table->name, "k") == 0 || strcmp(table->name, "xi") == 0))
      return "--k and --xi need --contact penalty: impulses have no stiffness";
  return NULL;
}

const char *mpm_model_too_large(double particles) {
  return particles <= 1e8 ? NULL
                          : "more than 1e8 particles: take a coarser --h, or a smaller model";
}

static double time_of(const mpm_model *model) {
  if (model->fluid) return mps_fluid_time(model->fluid);
  return model->mpm ? mps_mpm_time(model->mpm) : 0.0;
}

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
static int build_and_march(app *a, const char *out, mpm_model *model, const mpm_model_parts *parts,
                           void *user) {
  if (!output_directory(a, out)) return APP_FAILED;
  const mps_status built = parts->build(a->context, user);
  if (built != MPS_OK) return end_run(a, built, model, false);
  printf("%lld particles, dt %.4g s\n", (long long)mps_particles_count(model->particles),
         model->fluid ? mps_fluid_dt(model->fluid) : mps_mpm_dt(model->mpm));
  fflush(stdout);
  const mps_status status = parts->march(user);
  const bool any = model->samples >= MPM_MODEL_SAMPLES;
  const int code = end_run(a, status, model, any);
  if (code != APP_OK && !any) return code;
  if (!parts->finish(a, user)) return APP_FAILED;
  return code == APP_OK && model->failed ? APP_FAILED : code;
}

int mpm_model_run(const options_program *program, int64_t threads, const char *out,
                  mpm_model *model, const mpm_model_parts *parts, void *user) {
  app a;
  if (!app_start(&a, program->name, threads)) return app_finish(&a, APP_FAILED);
  model->a = &a;
  const int code = build_and_march(&a, out, model, parts, user);
  mpm_model_destroy(model);
  return app_finish(&a, code);
}

bool mpm_model_summary(app *a, const mpm_model *model, const char *directory, output *file) {
  if (!output_open(file, a, directory, "summary.json")) return false;
  json_begin(file);
  json_text(file, "program", a->program);
  json_text(file, "version", mps_version());
  json_text(file, "outcome", a->outcome);
  json_integer(file, "particles", mps_particles_count(model->particles));
  json_integer(file, "steps",
               model->fluid ? mps_fluid_steps(model->fluid) : mps_mpm_steps(model->mpm));
  return true;
}
