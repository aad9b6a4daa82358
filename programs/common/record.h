/* record.h - a recorded motion or level from a file, and what it was read as.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "output.h"

#include <mps/signal.h>

/* Files that are read, for the help of options. */
#define RECORD_FILES                                                                               \
  "AT2, K-NET, SMC, COSMOS, columns whose header names time, value and units, or one column with " \
  "a "                                                                                             \
  "step"
/* Choices of an option for the unit of a file whose header names none, and its names; index 0: SI.
 */
#define RECORD_UNITS "file|m/s2|g|gal"
extern const char *const record_units[];

/* Reads the file, prints what it was read as, and warns where it names no unit or has gaps. A
 * failure is in the record of the context; a warning names the option NAME-unit, NAME-step or
 * NAME-column (`name` "record") where that would help and the program has it. */
mps_status record_read(app *a, const char *name, const char *path, const mps_signal_record_def *def,
                       mps_signal **out);
/* Members record_format, _values, _step, _length, _peak, _unit of summary.json; nothing where the
 * signal is not of a file. */
void record_json(output *file, const mps_signal *signal);
