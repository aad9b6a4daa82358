/* mpm_model.c - see mpm_model.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_model.h"

void mpm_model_destroy(mpm_model *model) {
  mps_mpm_destroy(&model->mpm);
  for (int b = 0; b < MPM_MODEL_BODIES; b++) mps_body_destroy(&model->body[b]);
  mps_material_destroy(&model->material);
  mps_particles_destroy(&model->particles);
}

static int build_and_march(app *a, const char *out, mpm_model *model, const mpm_model_parts *parts,
                           void *user) {
  if (!output_directory(a, out) || !app_check(a, parts->build(a->context, user))) return APP_FAILED;
  printf("%lld particles, dt %.4g s\n", (long long)mps_particles_count(model->particles),
         mps_mpm_dt(model->mpm));
  fflush(stdout);
  const mps_status status = parts->march(user);
  if (status == MPS_ERROR_CANCELLED) {
    app_error(a, "interrupted at t = %.4g s: %s", mps_mpm_time(model->mpm),
              model->keeps ? "what there is gets written" : "nothing is written");
    return !model->keeps || parts->finish(a, user) ? APP_INTERRUPTED : APP_FAILED;
  }
  return app_check(a, status) && parts->finish(a, user) ? APP_OK : APP_FAILED;
}

int mpm_model_run(const options_program *program, int64_t threads, const char *out,
                  mpm_model *model, const mpm_model_parts *parts, void *user) {
  app a;
  if (!app_start(&a, program->name, threads)) return app_finish(&a, APP_FAILED);
  const int code = build_and_march(&a, out, model, parts, user);
  mpm_model_destroy(model);
  return app_finish(&a, code);
}

bool mpm_model_summary(app *a, const mpm_model *model, const char *directory, output *file) {
  if (!output_open(file, a, directory, "summary.json")) return false;
  json_begin(file);
  json_text(file, "program", a->program);
  json_text(file, "version", mps_version());
  json_integer(file, "particles", mps_particles_count(model->particles));
  json_integer(file, "steps", mps_mpm_steps(model->mpm));
  return true;
}
