/* replace.h - files that appear whole or not at all, with a seal that shows damage.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "io_private.h"

typedef struct mpsi_replacement {
  const char *path; /* the caller's */
  char *part;       /* "<path>.part", where it is written */
  int fd;
  bool sealed;
} mpsi_replacement;

/* Creates "<path>.part", for reading and writing through `fd`, in place of one that a killed
 * program has left. MPS_ERROR_IO where `path` is anything but a new name, an empty file or one that
 * was sealed, or where the temporary name is a link or is being written. Without `sealed` any other
 * file may be there too, and no seal is written. */
mps_status mpsi_replace_begin(mps_context *context, const char *function, const char *path,
                              bool sealed, mpsi_replacement *out);
/* Seals the file, lets the disk confirm it, and renames it to `path`. Ends the replacement; on an
 * error `path` is unchanged. */
mps_status mpsi_replace_commit(mps_context *context, const char *function,
                               mpsi_replacement *replacement);
/* Ends the replacement; `path` is unchanged. */
void mpsi_replace_abandon(mps_context *context, mpsi_replacement *replacement);

/* MPS_ERROR_FORMAT if the open file has no seal or is not what was sealed. */
mps_status mpsi_seal_check(mps_context *context, const char *function, int fd, const char *path);
