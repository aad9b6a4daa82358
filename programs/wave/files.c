/* files.c - frames for ParaView and checkpoints, written at the instants that the options request.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "wave.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Identification of a checkpoint of this program. */
static mps_checkpoint own_checkpoint(void) {
  mps_checkpoint info = mps_checkpoint_defaults();
  snprintf(info.user_key, sizeof info.user_key, RESTART_KEY);
  return info;
}

static char *join(const char *directory, const char *name) {
  const size_t size = strlen(directory) + strlen(name) + 2;
  char *path = malloc(size);
  if (path) snprintf(path, size, "%s/%s", directory, name);
  return path;
}

bool files_peek(app *a, settings *s) {
  if (!s->restart) return true;
  mps_checkpoint info = own_checkpoint();
  if (!app_check(a, mps_checkpoint_info(a->context, s->restart, &info))) return false;
  s->dt = info.dt; /* a run continues with its own time step */
  return true;
}

mps_status files_gather(files *f, mps_particles **whole) {
  mps_status status = MPS_OK;
  if (f->domain) status = mps_domain_gather_fields(f->domain, f->particles, 0, NULL, &f->whole);
  *whole = f->domain ? f->whole : f->particles;
  return status;
}

static bool put_back(app *a, const settings *s, mps_dynamics *dynamics, const files *f) {
  const resume r = restart_parts(a, f->so_far, dynamics);
  char why[400];
  mps_status status = resume_peek(a->context, &r, s->restart, why, sizeof why);
  if (status == MPS_OK) status = resume_restore(a->context, &r, s->restart);
  if (status == MPS_OK || (!why[0] && f->so_far->same)) return app_check(a, status);
  return why[0] ? app_error(a, "%s", why)
                : app_error(a, "%.150s was made with other layers or receivers", s->restart);
}

/* For a restarted run, a name that leaves the frames of the first half alone. */
static void name_series(const settings *s, double now, char name[48]) {
  if (s->restart)
    snprintf(name, 48, "wave-from-%g.vtkhdf", now);
  else
    snprintf(name, 48, "wave.vtkhdf");
}

static bool open_recorder(app *a, const settings *s, double now, files *f) {
  char name[48];
  mps_particles *whole;
  if (!app_check(a, files_gather(f, &whole))) return false;
  if (!whole) return app_agree(a, true); /* rank 0 writes */
  name_series(s, now, name);
  char *path = join(s->out, name);
  if (!path) return app_agree(a, app_no_memory(a));
  mps_recorder_def def = mps_recorder_defaults();
  static const char *const fields[] = {"displacement", "rotation", "velocity",
                                       "acceleration", "pressure", "shear_velocity"};
  def.path = path;
  def.xdmf = 1;
  def.fields = fields;
  def.field_count = 6;
  const bool ok = app_check(a, mps_recorder_create(a->context, whole, &def, &f->recorder));
  f->series = path;
  return app_agree(a, ok);
}

/* Saves the solver of the files `user`. */
static mps_status write_checkpoint(void *user) {
  const files *f = user;
  const resume r = restart_parts(f->a, f->so_far, f->dynamics);
  const mps_status status = field_join(f->so_far->peaks, f->domain);
  return status == MPS_OK ? resume_save(&r, f->saves.path) : status;
}

/* The first frame is that of the start, the last that of the end; one alone is the last. */
static double frame_interval(const settings *s, double duration) {
  if (s->frames <= 0) return 0.0;
  return duration / (double)(s->frames > 1 ? s->frames - 1 : 1);
}

/* Number of the last frame that is due by the time `now`. A run may end by 1e-9 of a step before
 * the duration, of which the last frame is. */
static int64_t frames_until(const files *f, double now) {
  return f->frame_every > 0.0 ? (int64_t)floor(now / f->frame_every * (1.0 + 2e-9)) : 0;
}

bool files_open(app *a, const settings *s, double duration, results_so_far *so_far,
                mps_dynamics *dynamics, files *out) {
  *out =
      (files){.particles = mps_dynamics_particles(dynamics),
              .domain = a->domain,
              .so_far = so_far,
              .frame_every = frame_interval(s, duration),
              .dynamics = dynamics,
              .a = a,
              .saves = {.path = s->checkpoint,
                        .every = isnan(s->every_checkpoint) ? 0.1 * duration : s->every_checkpoint,
                        .save = write_checkpoint,
                        .user = out}};
  if (s->restart && !put_back(a, s, dynamics, out)) return false;
  const double now = mps_dynamics_time(dynamics);
  out->next_frame = s->frames == 1 ? 1 : frames_until(out, now);
  resume_schedule_at(&out->saves, now);
  return s->frames > 0 ? open_recorder(a, s, now, out) : true;
}

/* The present frame, by rank 0; its status is known to all. */
static mps_status write_frame(files *f, double now) {
  mps_particles *whole;
  mps_status status = files_gather(f, &whole);
  if (status != MPS_OK) return status;
  if (f->recorder) status = mps_recorder_write(f->recorder, now);
  return f->domain ? mps_domain_agree(f->domain, status) : status;
}

static mps_status record(files *f, mps_status status) {
  const double now = mps_dynamics_time(f->dynamics);
  const bool frame = f->frame_every > 0.0 && frames_until(f, now) >= f->next_frame;
  if (!frame && !resume_is_due(&f->saves, now)) return status;
  if (f->domain) status = mps_domain_agree(f->domain, status);
  if (status == MPS_OK && frame) {
    status = write_frame(f, now);
    f->next_frame = frames_until(f, now) + 1;
  }
  if (status == MPS_OK) resume_save_when_due(f->a, &f->saves, now);
  return status;
}

mps_status files_record(files *f, mps_status status) {
  status = record(f, status);
  f->failed = status != MPS_OK;
  return status;
}

bool files_close(app *a, files *f, bool diverged, bool interrupted) {
  bool ok = !f->failed; /* the run ended by that, and has reported it */
  /* an interrupted run can continue from where it stopped; a diverged one from the last good state
   */
  if (!diverged && ok) resume_save_now(a, &f->saves);
  if (f->saves.saved) app_wrote(a, f->saves.path);
  if (interrupted) resume_tell(&f->saves);
  if (f->recorder && ok) {
    ok = app_check(a, mps_recorder_close(&f->recorder));
    if (ok) app_wrote(a, f->series);
  }
  return app_agree(a, ok && !f->saves.lost);
}

void files_destroy(files *f) {
  mps_recorder_destroy(&f->recorder);
  mps_particles_destroy(&f->whole);
  free(f->series);
  f->series = NULL;
}
