/* unsupported.c - the functions of mps/io.h and io/checkpoint.h in a libmps built without HDF5.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "checkpoint.h"
#include "core/particles/particles_internal.h"

static mps_status unsupported(mps_context *context, const char *function) {
  return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                   "this libmps was built without HDF5 (CMake option MPS_HDF5)");
}

mps_status mps_recorder_create(mps_context *context, mps_particles *particles,
                               const mps_recorder_def *def, mps_recorder **out) {
  if (out) *out = NULL;
  return unsupported(context, __func__);
}

/* No recorder can exist. */
mps_status mps_recorder_write(mps_recorder *recorder, double time) { return MPS_ERROR_UNSUPPORTED; }

mps_status mps_recorder_close(mps_recorder **recorder) { return MPS_OK; }

void mps_recorder_destroy(mps_recorder **recorder) { (void)recorder; }

mps_status mps_checkpoint_info(mps_context *context, const char *path, mps_checkpoint *info) {
  return unsupported(context, __func__);
}

mps_status mps_checkpoint_read(mps_particles *particles, const char *path, mps_checkpoint *info) {
  return unsupported(particles ? mpsi_particles_context(particles) : NULL, __func__);
}

mps_status mpsi_checkpoint_save(const mpsi_state_of *of, const char *function, const char *path,
                                const mps_checkpoint *info) {
  return unsupported(of->context, function);
}

mps_status mpsi_checkpoint_restore(const mpsi_state_of *of, const char *function, const char *path,
                                   mps_checkpoint *info) {
  return unsupported(of->context, function);
}

mps_status mpsi_checkpoint_save_rows(void *user, mpsi_row_source *source) {
  const mpsi_checkpoint_request *q = user;
  return source->begin(source, unsupported(q->of->context, q->function));
}
