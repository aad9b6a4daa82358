/* attributes.c - numbers and texts of a checkpoint that are kept as attributes, and the errors of a
 * file without them. SPDX-License-Identifier: BSD-3-Clause */
#include "checkpoint_private.h"

#include <string.h>

mps_status mpsi_checkpoint_malformed(const mpsi_reading *r, const char *what) {
  if (r->file.error) return mpsi_fail_io(r->context, r->function, "read", r->path, r->file.error);
  if (r->stay.memory)
    return mpsi_fail(r->context, r->function, MPS_ERROR_MEMORY,
                     "HDF5 was refused memory to read '%.200s': %s", r->path, r->stay.text);
  return mpsi_fail(r->context, r->function, MPS_ERROR_FORMAT,
                   "'%.200s' is not a checkpoint of libmps: %s%s%s", r->path, what,
                   r->stay.text[0] ? "; HDF5 says: " : "", r->stay.text);
}

bool mpsi_h5_write_rows(hid_t object, const mpsi_h5_row *row, size_t rows, const void *from) {
  bool good = true;
  for (const mpsi_h5_row *end = row + rows; good && row < end; row++)
    good = mpsi_h5_attribute(object, row->name, mpsi_h5_number_type(row->integer),
                             row->count > 1 ? (hsize_t)row->count : 0,
                             (const char *)from + row->offset);
  return good;
}

bool mpsi_h5_read_attribute(hid_t object, const char *name, H5T_class_t kind, hid_t type,
                            int64_t count, size_t size, void *out) {
  if (H5Aexists(object, name) <= 0) return false;
  const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
  const hid_t stored = attribute < 0 ? -1 : H5Aget_type(attribute);
  const hid_t space = attribute < 0 ? -1 : H5Aget_space(attribute);
  const bool text = kind == H5T_STRING;
  bool good = stored >= 0 && space >= 0 && H5Tget_class(stored) == kind &&
              H5Sget_simple_extent_npoints(space) == count && H5Tis_variable_str(stored) <= 0 &&
              H5Tget_size(stored) <= size;
  good = good && H5Aread(attribute, text ? stored : type, out) >= 0;
  if (space >= 0) H5Sclose(space);
  if (stored >= 0) H5Tclose(stored);
  if (attribute >= 0) H5Aclose(attribute);
  return good;
}

mps_status mpsi_h5_read_rows(const mpsi_reading *r, hid_t object, const mpsi_h5_row *row,
                             size_t rows, void *to) {
  for (const mpsi_h5_row *end = row + rows; row < end; row++)
    if (!mpsi_h5_read_attribute(object, row->name, row->integer ? H5T_INTEGER : H5T_FLOAT,
                                mpsi_h5_number_type(row->integer), row->count, 8,
                                (char *)to + row->offset))
      return mpsi_checkpoint_malformed(r, row->name);
  return MPS_OK;
}

bool mpsi_h5_read_text(hid_t object, const char *name, size_t size, char *out) {
  memset(out, 0, size);
  return mpsi_h5_read_attribute(object, name, H5T_STRING, -1, 1, size - 1, out);
}
