/* row_source.h - the particles of a set as a file takes them: each component of each field as one
 * column, in the order of the whole set, which comes in pieces where it lies on several ranks.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/particles.h>

#include <stdbool.h>

/* Takes rows [first, first + count) of a column, 8 bytes each; false: it has failed. */
typedef bool (*mpsi_put_rows_fn)(void *user, int64_t first, int64_t count, const void *values);

typedef struct mpsi_row_source mpsi_row_source;
struct mpsi_row_source {
  mps_particles *set; /* has the fields of the whole, and dim and spacing; its rows may be fewer */
  int64_t particles;  /* of the whole */
  /* To be called once, before the first column: `status` of what takes the rows, on this rank; what
   * comes back is that of all ranks. */
  mps_status (*begin)(mpsi_row_source *source, mps_status status);
  /* Component `component` of field number `field` to `put`. All columns, in order. On an error of
   * `put` false; of the source itself too, which `status` then is. */
  bool (*column)(mpsi_row_source *source, int32_t field, int32_t component, mpsi_put_rows_fn put,
                 void *user);
  mps_status status;
};
