/* mps-flume - a wave flume by moving particles: seas by spectrum, pistons that absorb, a wall,
 * caisson or dike that water passes, with the loads and discharges that a design asks for.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume/flume.h"

#include <math.h>
#include <stdio.h>

/* ---- the program ----------------------------------------------------------------------------- */

static mps_status prepare(app *a, flume *m) {
  mps_status status = m->s.restart ? flume_peek(a->context, m) : MPS_OK;
  if (status == MPS_OK) status = app_settle(a, flume_build(a, m));
  if (status == MPS_OK && m->s.restart) status = flume_restore(a->context, m);
  return app_settle(a, status);
}

static void describe(const flume *m) {
  mps_waves_report r;
  double R;
  if (mps_waves_get_report(m->waves, &r) != MPS_OK) return;
  printf(
      "%lld components, wave length %.3f m at %.3f s; the maker moves %.3f to %.3f m, at most %.3f "
      "m/s\n",
      (long long)r.components, m->wave_length, r.period, r.stroke[0], r.stroke[1], r.speed);
  if (m->maker && mps_absorber_get_reflection(m->maker, m->s.period, &R) == MPS_OK)
    printf("an absorbing piston reflects %.3f of waves of that period, by linear theory\n", R);
  printf("%lld particles, dt %.4g s\n", (long long)mps_particles_count(m->water), flume_dt(m));
  fflush(stdout);
}

static int run(app *a, flume *m) {
  if (!app_agree(a, resume_places(a, m->s.restart, &m->s.checkpoint, &m->s.out) &&
                        (a->rank > 0 || output_directory(a, m->s.out))))
    return APP_FAILED;
  m->a = a;
  m->saves = (resume_schedule){
      .path = m->s.checkpoint, .every = m->s.every_checkpoint, .save = flume_save, .user = m};
  if (!app_agree(a, a->rank > 0 || summary_reserve(a, m->s.out))) return APP_FAILED;
  app_leave_at_once(a, !a->domain); /* no hook reaches into building */
  mps_status status = flume_make_waves(a, m);
  if (status == MPS_OK) status = prepare(a, m);
  app_leave_at_once(a, false);
  if (status != MPS_OK && m->why[0]) return app_error(a, "%s", m->why), APP_FAILED;
  if (status != MPS_OK) return app_end_run(a, status, 0.0, false);
  flume_warn(a, m);
  describe(m);
  status = app_settle(a, flume_run(a, m));
  const int code = app_end_run(a, status, mps_fluid_time(m->fluid), m->samples > 0);
  if (status == MPS_ERROR_CANCELLED) resume_tell(&m->saves);
  if (m->samples == 0)
    return code == APP_INTERRUPTED && a->rank == 0 && !summary_bare(a, m->s.out) ? APP_FAILED
                                                                                 : code;
  if (!app_check(a, mps_history_flush(m->rows.history))) return APP_FAILED;
  if (!app_agree(a, a->rank > 0 || flume_write(a, m))) return APP_FAILED;
  return m->saves.lost && code == APP_OK ? APP_FAILED : code;
}

int main(int argc, char **argv) {
  int code;
  app a;
  flume *m = flume_read(argc, argv, &code);
  if (code >= 0) return flume_free(m), code;
  if (!app_start(&a, "mps-flume", m->s.threads)) return flume_free(m), app_finish(&a, APP_FAILED);
  code = run(&a, m);
  if (code == APP_FAILED) app_agree(&a, false); /* all ranks know */
  flume_free(m);
  return app_finish(&a, code);
}
