/* io_private.h - what the files of this folder share. Besides the public headers it uses the core's
 * internal.h, and of particles_internal.h the context of a set.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_IO_PRIVATE_H
#define MPSI_IO_PRIVATE_H

#include "core/internal.h"
#include "core/particles_internal.h"

#include <mps/io.h>

/* Sizes of the structures in the first release: they may only grow. */
#define MPSI_RECORDER_DEF_MINIMUM (offsetof(mps_recorder_def, field_count) + sizeof(int64_t))
#define MPSI_CHECKPOINT_MINIMUM (offsetof(mps_checkpoint, user_bytes) + sizeof(int64_t))

/* Records MPS_ERROR_IO: "could not <what> 'path': reason of errno value `error`". */
mps_status mpsi_fail_io(mps_context *context, const char *function, const char *what,
                        const char *path, int error);

#endif
