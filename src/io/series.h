/* series.h - datasets that grow by rows, of which a VTKHDF file consists.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "hdf5_file.h"

typedef enum mpsi_item { MPSI_ITEM_F64, MPSI_ITEM_I64, MPSI_ITEM_U8 } mpsi_item;

typedef struct mpsi_series {
  hid_t dataset;
  mpsi_item item;
  int32_t width; /* items a row; 0: one, and the dataset is one-dimensional */
} mpsi_series;

/* Makes an empty one, in chunks of `chunk_rows`, with zlib `compression` 0..9. False on an error.
 */
bool mpsi_series_create(hid_t group, const char *path, mpsi_item item, int32_t width,
                        int64_t chunk_rows, int32_t compression, mpsi_series *out);

/* Writes `rows` rows from row `first` on; they become the last ones. False on an error. */
bool mpsi_series_append(const mpsi_series *series, int64_t first, int64_t rows, const void *values);
