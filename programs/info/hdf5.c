/* hdf5.c - attributes, sizes and names in an HDF5 file, all of them checked.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "info.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Opens an attribute of one value of that class. */
static hid_t open_attribute(hid_t object, const char *name, H5T_class_t kind) {
  if (H5Aexists(object, name) <= 0) return -1;
  const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
  const hid_t type = attribute < 0 ? -1 : H5Aget_type(attribute);
  const hid_t space = attribute < 0 ? -1 : H5Aget_space(attribute);
  const bool good = type >= 0 && space >= 0 && H5Tget_class(type) == kind &&
                    H5Sget_simple_extent_npoints(space) == 1;
  if (space >= 0) H5Sclose(space);
  if (type >= 0) H5Tclose(type);
  if (good) return attribute;
  if (attribute >= 0) H5Aclose(attribute);
  return -1;
}

bool info_text(hid_t object, const char *name, char *text, size_t size) {
  const hid_t attribute = open_attribute(object, name, H5T_STRING);
  memset(text, 0, size);
  if (attribute < 0) return false;
  const hid_t type = H5Aget_type(attribute);
  const bool good = type >= 0 && H5Tis_variable_str(type) <= 0 && H5Tget_size(type) < size &&
                    H5Aread(attribute, type, text) >= 0;
  if (type >= 0) H5Tclose(type);
  H5Aclose(attribute);
  return good;
}

static bool read_value(hid_t object, const char *name, H5T_class_t kind, hid_t type, void *value) {
  const hid_t attribute = open_attribute(object, name, kind);
  if (attribute < 0) return false;
  const bool good = H5Aread(attribute, type, value) >= 0;
  H5Aclose(attribute);
  return good;
}

bool info_number(hid_t object, const char *name, double *value) {
  return read_value(object, name, H5T_FLOAT, H5T_NATIVE_DOUBLE, value);
}

bool info_integer(hid_t object, const char *name, int64_t *value) {
  return read_value(object, name, H5T_INTEGER, H5T_NATIVE_INT64, value);
}

/* Sizes of a dataset of one or two dimensions: their number, 0 where it is something else. */
static int sizes_of(hid_t dataset, hsize_t size[2]) {
  const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
  int dims = space < 0 ? 0 : H5Sget_simple_extent_ndims(space);
  size[0] = size[1] = 1;
  if (dims < 1 || dims > 2 || H5Sget_simple_extent_dims(space, size, NULL) < 0) dims = 0;
  if (space >= 0) H5Sclose(space);
  return dims;
}

int64_t info_rows(hid_t group, const char *name) {
  hsize_t size[2];
  if (H5Lexists(group, name, H5P_DEFAULT) <= 0) return -1;
  const hid_t dataset = H5Dopen2(group, name, H5P_DEFAULT);
  const int dims = sizes_of(dataset, size);
  if (dataset >= 0) H5Dclose(dataset);
  return dims > 0 && size[0] < INT64_MAX ? (int64_t)size[0] : -1;
}

bool info_read(hid_t group, const char *name, hid_t type, int64_t rows, void *values) {
  hsize_t size[2];
  const hid_t dataset = H5Dopen2(group, name, H5P_DEFAULT);
  const bool good = sizes_of(dataset, size) == 1 && size[0] == (hsize_t)rows &&
                    H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0;
  if (dataset >= 0) H5Dclose(dataset);
  return good;
}

/* "3 x float64, m/s" of a dataset. */
static bool describe(hid_t dataset, bool columns_first, char *text, size_t room) {
  hsize_t size[2];
  char unit[32];
  const int dims = sizes_of(dataset, size);
  const hid_t type = dims ? H5Dget_type(dataset) : -1;
  if (type < 0) return false;
  const hsize_t columns = dims == 1 ? 1 : columns_first ? size[0] : size[1];
  const char *kind = H5Tget_class(type) == H5T_FLOAT ? "float" : "int";
  const int bits = 8 * (int)H5Tget_size(type);
  H5Tclose(type);
  if (!info_text(dataset, "unit", unit, sizeof unit)) unit[0] = '\0';
  snprintf(text, room, "%llu x %s%d%s%s", (unsigned long long)columns, kind, bits,
           unit[0] ? ", " : "", unit);
  return true;
}

bool info_list_fields(hid_t group, bool columns_first, info_fields *fields) {
  H5G_info_t all;
  *fields = (info_fields){0};
  if (H5Gget_info(group, &all) < 0 || all.nlinks > 100000) return false;
  fields->field = calloc((size_t)all.nlinks + 1, sizeof *fields->field);
  if (!fields->field) return false;
  for (hsize_t k = 0; k < all.nlinks; k++) {
    struct info_field *f = &fields->field[fields->count];
    if (H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, k, f->name, sizeof f->name,
                           H5P_DEFAULT) < 0)
      return false;
    const hid_t dataset = H5Dopen2(group, f->name, H5P_DEFAULT);
    if (describe(dataset, columns_first, f->text, sizeof f->text)) fields->count++;
    if (dataset >= 0) H5Dclose(dataset);
  }
  return true;
}
