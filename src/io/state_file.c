/* state_file.c - the state of a solver in a checkpoint: the group `solver`. Values are attributes,
 * tables and long values are datasets; a name with "/" is in a group of its own.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "checkpoint_private.h"

#include <stdio.h>
#include <string.h>

#define MOST_ATTRIBUTE 4096 /* bytes: HDF5 takes at most 64 kB */

static hid_t type_in_memory(mpsi_state_type type) {
  return type == MPSI_STATE_F64   ? H5T_NATIVE_DOUBLE
         : type == MPSI_STATE_I64 ? H5T_NATIVE_INT64
                                  : H5T_NATIVE_UINT8;
}

static bool is_dataset(const mpsi_value *value) {
  return value->table ||
         value->rows * value->columns * mpsi_state_size(value->type) > MOST_ATTRIBUTE;
}

/* The group below `solver` that is open: that of the value before. */
typedef struct place {
  hid_t root, group;
  char name[MPSI_STATE_NAME];
} place;

static void close_place(place *p) {
  if (p->group >= 0) H5Gclose(p->group);
  p->group = -1;
}

/* Opens the group of a value, or makes it; `leaf` is the last part of its name. */
static bool go_to(place *p, const char *name, bool make, const char **leaf) {
  char group[MPSI_STATE_NAME + 8];
  const char *slash = strrchr(name, '/');
  const int length = slash ? (int)(slash - name) : 0;
  *leaf = slash ? slash + 1 : name;
  if (p->group >= 0 && strncmp(p->name, name, (size_t)length) == 0 && p->name[length] == '\0')
    return true;
  close_place(p);
  snprintf(p->name, sizeof p->name, "%.*s", length, name);
  snprintf(group, sizeof group, "solver%s%s", length ? "/" : "", p->name);
  if (!make) {
    p->group = H5Gopen2(p->root, group, H5P_DEFAULT);
    return p->group >= 0;
  }
  if (H5Lexists(p->root, "solver", H5P_DEFAULT) > 0 && H5Lexists(p->root, group, H5P_DEFAULT) > 0) {
    p->group = H5Gopen2(p->root, group, H5P_DEFAULT);
    return p->group >= 0;
  }
  const hid_t links = H5Pcreate(H5P_LINK_CREATE);
  if (links >= 0 && H5Pset_create_intermediate_group(links, 1) >= 0)
    p->group = H5Gcreate2(p->root, group, links, H5P_DEFAULT, H5P_DEFAULT);
  if (links >= 0) H5Pclose(links);
  return p->group >= 0;
}

/* ---- writing --------------------------------------------------------------------------------- */

/* None where it has no rows. */
static bool write_table(hid_t group, const char *name, const mpsi_value *value) {
  const hsize_t size[2] = {(hsize_t)value->rows, (hsize_t)value->columns};
  const hid_t type = type_in_memory(value->type);
  if (value->rows == 0) return true;
  const hid_t space = H5Screate_simple(2, size, NULL);
  const hid_t dataset = mpsi_h5_dataset(group, name, type, space);
  bool good =
      dataset >= 0 && H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value->data) >= 0;
  if (dataset >= 0) good = H5Dclose(dataset) >= 0 && good;
  if (space >= 0) H5Sclose(space);
  return good;
}

static bool write_value(place *p, const mpsi_value *value) {
  const char *leaf;
  const int64_t count = value->rows * value->columns;
  if (!go_to(p, value->name, true, &leaf)) return false;
  if (value->text) return mpsi_h5_attribute_text(p->group, leaf, value->data);
  if (is_dataset(value)) return write_table(p->group, leaf, value);
  return count == 0 || mpsi_h5_attribute(p->group, leaf, type_in_memory(value->type),
                                         count > 1 ? (hsize_t)count : 0, value->data);
}

bool mpsi_h5_write_state(hid_t root, const char *name, const mpsi_values *state) {
  place p = {.root = root, .group = -1};
  const char *leaf;
  bool good = go_to(&p, "name", true, &leaf) && mpsi_h5_attribute_text(p.group, leaf, name);
  for (int32_t k = 0; good && k < state->count; k++) good = write_value(&p, &state->item[k]);
  close_place(&p);
  return good;
}

/* ---- reading --------------------------------------------------------------------------------- */

static bool right_class(hid_t stored, mpsi_state_type type) {
  const H5T_class_t kind = H5Tget_class(stored);
  if (type == MPSI_STATE_F64) return kind == H5T_FLOAT;
  return kind == H5T_INTEGER && (type == MPSI_STATE_I64 || H5Tget_size(stored) == 1);
}

static mps_status read_table(mpsi_reading *r, hid_t group, const char *name, mpsi_value *value) {
  if (value->table && H5Lexists(group, name, H5P_DEFAULT) <= 0) {
    value->rows = 0;
    return MPS_OK;
  }
  const hid_t dataset = H5Dopen2(group, name, H5P_DEFAULT);
  const hid_t type = dataset < 0 ? -1 : H5Dget_type(dataset);
  const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
  hsize_t size[2] = {0, 0};
  mps_status status = MPS_OK;
  if (type < 0 || space < 0 || !right_class(type, value->type) ||
      H5Sget_simple_extent_ndims(space) != 2 || H5Sget_simple_extent_dims(space, size, NULL) < 0 ||
      size[0] < 1 || size[0] > INT32_MAX || size[1] != (hsize_t)value->columns ||
      (!value->table && size[0] != (hsize_t)value->rows))
    status = mpsi_checkpoint_malformed(r, value->name);
  if (status == MPS_OK &&
      !mpsi_value_reserve(r->context, value, value->type, (int64_t)size[0], value->columns))
    status = mpsi_fail_memory(r->context, r->function, size[0] * size[1] * 8);
  if (status == MPS_OK) {
    value->rows = (int64_t)size[0];
    if (H5Dread(dataset, type_in_memory(value->type), H5S_ALL, H5S_ALL, H5P_DEFAULT, value->data) <
        0)
      status = mpsi_checkpoint_malformed(r, value->name);
  }
  if (space >= 0) H5Sclose(space);
  if (type >= 0) H5Tclose(type);
  if (dataset >= 0) H5Dclose(dataset);
  return status;
}

static mps_status read_value(mpsi_reading *r, place *p, mpsi_value *value) {
  const char *leaf;
  const int64_t count = value->rows * value->columns;
  bool good = go_to(p, value->name, false, &leaf);
  if (good && is_dataset(value)) return read_table(r, p->group, leaf, value);
  if (good && value->text)
    good = mpsi_h5_read_text(p->group, leaf, (size_t)value->rows, value->data);
  else if (good && count > 0)
    good = mpsi_h5_read_attribute(p->group, leaf,
                                  value->type == MPSI_STATE_F64 ? H5T_FLOAT : H5T_INTEGER,
                                  type_in_memory(value->type), count, 8, value->data);
  return good ? MPS_OK : mpsi_checkpoint_malformed(r, value->name);
}

/* Values that must agree come first, and the first difference ends the reading: the caller names
 * it, which is more useful than missing values of another kind of solver. */
static mps_status read_values(mpsi_reading *r, place *p, const mpsi_state_of *of) {
  mps_status status = mpsi_state_get(of, r->function, &r->values);
  mpsi_values *state = &r->values.state;
  for (int32_t k = 0; k < state->count && status == MPS_OK; k++) {
    char own[MPSI_STATE_NAME];
    mpsi_value *value = &state->item[k];
    if (!value->agrees) continue;
    const size_t bytes = (size_t)(value->rows * mpsi_state_size(value->type));
    memcpy(own, value->data, bytes);
    status = read_value(r, p, value);
    if (status == MPS_OK && memcmp(own, value->data, bytes) != 0) return MPS_OK;
  }
  for (int32_t k = 0; k < state->count && status == MPS_OK; k++)
    if (!state->item[k].agrees) status = read_value(r, p, &state->item[k]);
  return status;
}

mps_status mpsi_h5_read_state(mpsi_reading *r, const mpsi_state_of *of) {
  char name[MPSI_STATE_NAME];
  const char *leaf;
  place p = {.root = r->file.id, .group = -1};
  if (H5Lexists(p.root, "solver", H5P_DEFAULT) <= 0)
    return mpsi_fail(r->context, r->function, MPS_ERROR_FORMAT,
                     "'%.200s' has the fields of a set but no solver: mps_checkpoint_read reads them",
                     r->path);
  mps_status status = MPS_OK;
  if (!go_to(&p, "name", false, &leaf) || !mpsi_h5_read_text(p.group, leaf, sizeof name, name))
    status = mpsi_checkpoint_malformed(r, "the name of its solver");
  else if (strcmp(name, of->name) != 0)
    status = mpsi_fail(r->context, r->function, MPS_ERROR_ARGUMENT,
                       "path: '%.200s' is of the solver %s, not of %s", r->path, name, of->name);
  if (status == MPS_OK) status = read_values(r, &p, of);
  close_place(&p);
  return status;
}
