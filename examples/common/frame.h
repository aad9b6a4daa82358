/* frame.h - the particles of a static result as one frame of a VTKHDF series, for ParaView.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_FRAME_H
#define EXAMPLES_FRAME_H

#include "app.h"

#include <mps/particles.h>

/* Writes DIR/NAME with all fields. Does nothing in a libmps without HDF5. */
bool frame_write(app *a, mps_particles *particles, const char *directory, const char *name);

#endif
