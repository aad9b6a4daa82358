/* series.c - datasets that grow by rows.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "series.h"

static hid_t item_type(mpsi_item item) {
  if (item == MPSI_ITEM_F64) return H5T_NATIVE_DOUBLE;
  return item == MPSI_ITEM_I64 ? H5T_NATIVE_INT64 : H5T_NATIVE_UINT8;
}

bool mpsi_series_create(hid_t group, const char *path, mpsi_item item, int32_t width,
                        int64_t chunk_rows, int32_t compression, mpsi_series *out) {
  const int rank = width > 0 ? 2 : 1;
  const hsize_t none[2] = {0, (hsize_t)width}, limit[2] = {H5S_UNLIMITED, (hsize_t)width};
  const hsize_t chunk[2] = {(hsize_t)chunk_rows, (hsize_t)width};
  const hid_t space = H5Screate_simple(rank, none, limit), layout = mpsi_h5_timeless();
  bool good = space >= 0 && layout >= 0 && H5Pset_chunk(layout, rank, chunk) >= 0;
  if (compression > 0) /* shuffled: bytes of equal weight side by side compress better */
    good =
        good && H5Pset_shuffle(layout) >= 0 && H5Pset_deflate(layout, (unsigned)compression) >= 0;
  *out = (mpsi_series){.dataset = -1, .item = item, .width = width};
  if (good)
    out->dataset =
        H5Dcreate2(group, path, item_type(item), space, H5P_DEFAULT, layout, H5P_DEFAULT);
  if (layout >= 0) H5Pclose(layout);
  if (space >= 0) H5Sclose(space);
  return out->dataset >= 0;
}

bool mpsi_series_append(const mpsi_series *series, int64_t first, int64_t rows,
                        const void *values) {
  const int rank = series->width > 0 ? 2 : 1;
  const hsize_t width = (hsize_t)series->width, size[2] = {(hsize_t)(first + rows), width};
  const hsize_t start[2] = {(hsize_t)first, 0}, count[2] = {(hsize_t)rows, width};
  if (H5Dset_extent(series->dataset, size) < 0) return false;
  if (rows == 0) return true;
  const hid_t target = H5Dget_space(series->dataset), source = H5Screate_simple(rank, count, NULL);
  const bool good =
      target >= 0 && source >= 0 &&
      H5Sselect_hyperslab(target, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
      H5Dwrite(series->dataset, item_type(series->item), source, target, H5P_DEFAULT, values) >= 0;
  if (source >= 0) H5Sclose(source);
  if (target >= 0) H5Sclose(target);
  return good;
}
