/* xdmf.h - an XDMF file beside a series, which says where its frames lie: for programs that do not
 * read series of VTKHDF. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "series.h"

typedef struct mpsi_xdmf {
  int fd;     /* < 0: none */
  int error;  /* errno of the first call that failed; 0: none */
  char *path; /* of the file */
  const char
      *series; /* name of the series' file, in the same directory: part of the caller's path */
} mpsi_xdmf;

/* Whether a series of that path can be named in one. */
mps_status mpsi_xdmf_check(mps_context *context, const char *function, const char *path);
/* Begins the file of the series `path`, which must stay: "x.xdmf" for "x.vtkhdf". The caller frees
 * out->path. */
mps_status mpsi_xdmf_open(mps_context *context, const char *function, const char *path,
                          mpsi_xdmf *out);
/* Begins the frame of `count` particles at byte `at` (0: the first), over a frame that lay there.
 */
void mpsi_xdmf_begin(mpsi_xdmf *x, int64_t at, double time, int64_t count);
/* An array of the frame: rows [first, first + count) of the dataset PointData/`name` of the series,
 * `width` values each (0: one), or of Points where `name` is NULL. */
void mpsi_xdmf_array(mpsi_xdmf *x, const char *name, mpsi_item item, int32_t width, int64_t first,
                     int64_t count);
/* Ends the frame, and the file behind it. Returns the byte at which the next frame begins; -1 on an
 * error. */
int64_t mpsi_xdmf_end(mpsi_xdmf *x, int64_t count);
