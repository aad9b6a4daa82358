/* defs.c - definition structs of the output functions, with and without HDF5.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "io_private.h"

static const mps_recorder_def recorder_defaults = {.struct_size = sizeof(mps_recorder_def)};
static const mps_checkpoint checkpoint_defaults = {.struct_size = sizeof(mps_checkpoint)};

mps_status mps_recorder_def_init(mps_recorder_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_recorder_def, def, size, &recorder_defaults);
}

mps_status mps_checkpoint_init(mps_checkpoint *info, size_t size) {
  return MPSI_DEF_INIT(mps_checkpoint, info, size, &checkpoint_defaults);
}
