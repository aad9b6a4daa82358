/* checkpoint_private.h - declarations of checkpoint.c, attributes.c and state_file.c.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "checkpoint.h"
#include "hdf5_file.h"

/* The numbers at the root of the file. */
typedef struct mpsi_checkpoint_header {
  int64_t version, dim, count, step;
  double spacing, time, dt;
} mpsi_checkpoint_header;

/* One call that reads. */
typedef struct mpsi_reading {
  mps_context *context;
  const char *function;
  mps_particles *particles; /* NULL: only the header is read */
  const char *path;
  mpsi_h5_stay stay;
  mpsi_h5_file file;
  mpsi_checkpoint_header header;
  char user_key[64];
  char *user_data;
  int64_t user_bytes;
  mps_snapshot values; /* fields: of the file, by name; state: of its solver */
  bool any_particles;  /* the set takes the particles of the file */
  int64_t *source;     /* source[i]: index in the file of the particle at index i of the set */
} mpsi_reading;

/* ---- attributes.c ---------------------------------------------------------------------------- */

/* MPS_ERROR_FORMAT. The file is sealed, so it is of another program, or of another version. */
mps_status mpsi_checkpoint_malformed(const mpsi_reading *r, const char *what);

static inline hid_t mpsi_h5_number_type(bool integer) {
  return integer ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE;
}

/* One or `count` > 1 numbers of a structure, kept as an attribute. */
typedef struct mpsi_h5_row {
  const char *name;
  bool integer; /* int64_t, else double */
  int32_t count;
  size_t offset;
} mpsi_h5_row;

bool mpsi_h5_write_rows(hid_t object, const mpsi_h5_row *row, size_t rows, const void *from);
/* MPS_ERROR_FORMAT names the attribute that is missing or of another kind. */
mps_status mpsi_h5_read_rows(const mpsi_reading *r, hid_t object, const mpsi_h5_row *row,
                             size_t rows, void *to);
/* An attribute of a class: `count` values of at most `size` bytes each. */
bool mpsi_h5_read_attribute(hid_t object, const char *name, H5T_class_t kind, hid_t type,
                            int64_t count, size_t size, void *out);
/* Text of less than `size` bytes. */
bool mpsi_h5_read_text(hid_t object, const char *name, size_t size, char *out);

/* ---- state_file.c: the group `solver` -------------------------------------------------------- */

/* Writes the state of a solver of the kind `name`. */
bool mpsi_h5_write_state(hid_t root, const char *name, const mpsi_values *state);
/* Reads it to r->values.state. */
mps_status mpsi_h5_read_state(mpsi_reading *r, const mpsi_state_of *of);
