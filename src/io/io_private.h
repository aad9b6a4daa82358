/* io_private.h - common declarations of this folder. Besides the public headers it uses the core's
 * internal.h, and of particles_internal.h the context of a set.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"
#include "core/particles/particles_internal.h"

#include <mps/io.h>

/* Records MPS_ERROR_IO: "could not <what> 'path': reason of errno value `error`". */
mps_status mpsi_fail_io(mps_context *context, const char *function, const char *what,
                        const char *path, int error);
