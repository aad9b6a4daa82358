/* frame.c - see frame.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "frame.h"

#include <mps/io.h>

#include <math.h>
#include <stdio.h>

bool frame_write(app *a, mps_particles *particles, const char *directory, const char *name) {
  mps_recorder_def def = mps_recorder_defaults();
  mps_recorder *recorder = NULL;
  char path[4096];
  if (snprintf(path, sizeof path, "%s/%s", directory, name) >= (int)sizeof path)
    return app_error(a, "the path of %s is too long", name);
  def.path = path;
  def.xdmf = 1;
  mps_status status = mps_recorder_create(a->context, particles, &def, &recorder);
  if (app_lacks_hdf5(a, status)) return true;
  if (status == MPS_OK) status = mps_recorder_write(recorder, 0.0);
  const mps_status closed = mps_recorder_close(&recorder);
  if (!app_check(a, status == MPS_OK ? closed : status)) return false;
  app_wrote(a, path);
  return true;
}

bool frame_is_due(int64_t k, int64_t samples, int64_t frames) {
  if (frames <= 1) return frames == 1 && k == samples;
  const int64_t spaces = frames - 1;
  return k == 0 || k * spaces / samples > (k - 1) * spaces / samples;
}

mps_status frame_series(app *a, mps_particles *particles, const char *directory, const char *what,
                        double from, mps_recorder **out) {
  mps_recorder_def def = mps_recorder_defaults();
  char path[1200];
  if (isnan(from))
    snprintf(path, sizeof path, "%s/%s.vtkhdf", directory, what);
  else
    snprintf(path, sizeof path, "%s/%s-from-%g.vtkhdf", directory, what, from);
  def.path = path;
  def.xdmf = 1;
  const mps_status status = mps_recorder_create(a->context, particles, &def, out);
  if (status == MPS_OK) app_wrote(a, path);
  return app_lacks_hdf5(a, status) ? MPS_OK : status;
}
