/* frame.h - VTKHDF series of particles for ParaView: of a run, and of a static result as one frame.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "app.h"

#include <mps/io.h>

/* Writes DIR/NAME with all fields. Does nothing in a libmps without HDF5. */
bool frame_write(app *a, mps_particles *particles, const char *directory, const char *name);
/* Whether the sample `k` of 0 to `samples` is one of `frames` that are spread over them: the first
 * and the last among them, of one frame the last. */
bool frame_is_due(int64_t k, int64_t samples, int64_t frames);
/* Begins the series DIR/WHAT.vtkhdf, or DIR/WHAT-from-T.vtkhdf of a run restarted from the time
 * `from` (s; NaN: from the start). `out` stays NULL in a libmps without HDF5. */
mps_status frame_series(app *a, mps_particles *particles, const char *directory, const char *what,
                        double from, mps_recorder **out);
