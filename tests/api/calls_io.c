/* calls_io.c - recorders, checkpoints, and domains of one rank, whose transport may fail.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "calls_solver.h"

#include <mps/mps.h>
#include <mps/experimental/domain.h>

#include <stdlib.h>

static void recorder_create(api *a) {
  char path[300];
  mps_recorder *made = NULL;
  mps_context *context = api_context(a);
  mps_particles *set = api_any(a, API_SET)->handle;
  mps_recorder_def def = mps_recorder_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.compression = (int32_t)api_whole(a, "compression", 0, 9);
  def.xdmf = (int32_t)api_whole(a, "xdmf", 0, 1);
  const char *names[2] = {"position", "id"};
  if (api_chance(a, 40)) {
    const int before = a->wrong;
    names[0] = api_field(a, set);
    def.fields = names;
    def.field_count = 1 + api_below(a, 2);
    if (a->wrong > before && !set) a->wrong = before;
  }
  api_path(a, path, api_chance(a, 50) ? "frames" : "other");
  def.path = api_null(a, "path") ? NULL : path;
  const mps_status status =
      mps_recorder_create(context, set, &def, api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_RECORDER, made, NULL);
}

static void recorder_write(api *a) {
  mps_recorder *recorder = api_any(a, API_RECORDER)->handle;
  const mps_status status = mps_recorder_write(recorder, api_near(a, "time", (double)a->call, 0.4));
  if (status == MPS_ERROR_IO) a->change = API_CHANGES_ALL;
  (void)api_end(a, status);
}

API_DESTROY(recorder_destroy, API_RECORDER)

static void recorder_close(api *a) {
  api_object *o = api_any(a, API_RECORDER);
  mps_recorder *recorder = o->handle;
  a->wrong = 0; /* NULL is nothing to close */
  const mps_status status = mps_recorder_close(&recorder);
  if (recorder) api_broken(a, "has not nulled");
  api_forget(a, o);
  (void)api_end(a, status);
}

/* ---- checkpoints ----------------------------------------------------------------------------- */

static const char *const solvers[] = {"mpm", "dynamics", "elastic", "fluid"}; /* that write files */

static void checkpoint_info(api *a) {
  char path[300];
  mps_checkpoint info = mps_checkpoint_defaults();
  mps_context *context = api_context(a);
  api_path(a, path, solvers[api_below(a, 4)]);
  api_damage(a, path);
  a->reads = true;
  (void)api_end(a, mps_checkpoint_info(context, path, api_null(a, "info") ? NULL : &info));
}

static void checkpoint_read(api *a) {
  char path[300], data[8];
  mps_checkpoint info = mps_checkpoint_defaults();
  mps_particles *set = api_any(a, API_SET)->handle;
  api_path(a, path, solvers[api_below(a, 4)]);
  api_damage(a, path);
  if (api_chance(a, 50)) info.user_data = data, info.user_bytes = sizeof data;
  (void)api_end(a, mps_checkpoint_read(set, path, &info));
}

/* ---- domains of one rank --------------------------------------------------------------------- */

static void domain_create(api *a) {
  mps_domain *made = NULL;
  mps_context *context = api_context(a);
  mps_domain_def def = mps_domain_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.size = (int32_t)api_whole(a, "size", 1, 1);
  if (def.size > 1 && def.size <= 1000000) def.size = 0;
  def.user = &a->plan;
  def.rendezvous = api_null(a, "rendezvous") ? NULL : api_rendezvous;
  def.star_create = api_star_create, def.star_begin = api_star_begin, def.star_end = api_star_end;
  def.star_destroy = api_null(a, "star_destroy") ? NULL : api_star_destroy;
  def.reduce_max = api_reduce_max, def.reduce_sum = api_reduce_sum;
  api_arm(a);
  const mps_status status = mps_domain_create(context, &def, api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_DOMAIN, made, NULL);
}

API_DESTROY(domain_destroy, API_DOMAIN)
API_QUERY(domain_rank, API_DOMAIN)
API_QUERY(domain_size, API_DOMAIN)

static void domain_agree(api *a) {
  mps_domain *domain = api_any(a, API_DOMAIN)->handle;
  const mps_status given = (mps_status)api_below(a, 3);
  api_say(a, "%d, ", (int)given);
  api_arm(a);
  const mps_status status = mps_domain_agree(domain, given);
  if (domain && given != MPS_OK && status == MPS_OK) api_broken(a, "makes an error of none");
  if (status == given && given != MPS_OK) a->own_record = true;
  (void)api_end(a, status);
}

static void domain_max(api *a) {
  double values[2] = {1.0, 2.0};
  mps_domain *domain = api_any(a, API_DOMAIN)->handle;
  const int32_t count = (int32_t)api_least(a, "count", 0, 2);
  api_arm(a);
  (void)api_end(a, mps_domain_max(domain, count, values));
}

static void domain_create_particles(api *a) {
  mps_particles *made = NULL;
  mps_particles_def def = mps_particles_defaults();
  mps_domain *domain = api_any(a, API_DOMAIN)->handle;
  def.struct_size = api_struct_size(a, sizeof def);
  def.dim = a->latest ? a->dim : (int32_t)api_whole(a, "dim", 2, 3);
  def.spacing = api_real(a, "spacing", 1e-12, 1e12, 0.1);
  api_arm(a);
  const mps_status status = mps_domain_create_particles(domain, api_null(a, "def") ? NULL : &def,
                                                        api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_SET, made, NULL);
}

static void domain_gather_fields(api *a) {
  mps_particles *whole = NULL;
  mps_domain *domain = api_any(a, API_DOMAIN)->handle;
  mps_particles *set = api_any(a, API_SET)->handle;
  const char *names[1] = {"density"};
  const bool some = api_chance(a, 50);
  if (some) names[0] = api_field(a, set);
  api_arm(a);
  const mps_status status =
      mps_domain_gather_fields(domain, set, some, some ? names : NULL, &whole);
  (void)api_end_made(a, status, API_SET, whole, NULL);
}

static void domain_get_field(api *a) {
  int64_t ids[4] = {0};
  double values[4 * 16];
  mps_domain *domain = api_any(a, API_DOMAIN)->handle;
  mps_particles *set = api_any(a, API_SET)->handle;
  const char *name = api_field(a, set);
  const int64_t count = api_ids(a, set, 4, ids);
  if (count == 0) a->wrong = !domain || !set;
  api_arm(a);
  const mps_status status = mps_domain_get_field(domain, set, name, ids, count, values);
  a->reads = true;
  (void)api_end(a, status);
}

static const api_call calls[] = {
    {"mps_recorder_create", 2, API_SET, recorder_create},
    {"mps_recorder_write", 4, API_RECORDER, recorder_write},
    {"mps_recorder_close", 1, API_RECORDER, recorder_close},
    {"mps_recorder_destroy", 1, API_RECORDER, destroy_recorder_destroy},
    {"mps_checkpoint_info", 2, API_CONTEXT, checkpoint_info},
    {"mps_checkpoint_read", 3, API_SET, checkpoint_read},
    {"mps_domain_create", 1, API_CONTEXT, domain_create},
    {"mps_domain_destroy", 1, API_DOMAIN, destroy_domain_destroy},
    {"mps_domain_rank", 1, API_DOMAIN, query_domain_rank},
    {"mps_domain_size", 1, API_DOMAIN, query_domain_size},
    {"mps_domain_agree", 1, API_DOMAIN, domain_agree},
    {"mps_domain_max", 1, API_DOMAIN, domain_max},
    {"mps_domain_create_particles", 1, API_DOMAIN, domain_create_particles},
    {"mps_domain_gather_fields", 2, API_DOMAIN, domain_gather_fields},
    {"mps_domain_get_field", 2, API_DOMAIN, domain_get_field},
};
const api_table api_io_calls = API_TABLE(calls);
