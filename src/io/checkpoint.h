/* checkpoint.h - how checkpoint.c lets the state of a solver go along with the fields.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_IO_CHECKPOINT_H
#define MPSI_IO_CHECKPOINT_H

#include "hdf5_file.h"

#define MPSI_CHECKPOINT_NAME 48 /* bytes of a field's name, with the terminating zero */

/* The numbers at the root of the file. */
typedef struct mpsi_checkpoint_header {
  int64_t version, dim, count, step;
  double spacing, time, dt;
} mpsi_checkpoint_header;

/* A field of the file. */
typedef struct mpsi_staged_field {
  char name[MPSI_CHECKPOINT_NAME];
  int32_t components;
  bool integer;
  char *values; /* [component][particle], 8 bytes each */
} mpsi_staged_field;

/* One call that reads. */
typedef struct mpsi_reading {
  mps_context *context;
  const char *function;
  mps_particles *particles; /* NULL: only the header is wanted */
  const char *path;
  mpsi_h5_stay stay;
  mpsi_h5_file file;
  mpsi_checkpoint_header header;
  char user_key[64];
  char *user_data;
  int64_t user_bytes;
  mpsi_staged_field *fields;
  int64_t field_count;
  int64_t *source; /* source[i]: place in the file of the particle at index i of the set */
} mpsi_reading;

/* MPS_ERROR_FORMAT. The file is sealed, so it is not one of ours, or not of this version. */
mps_status mpsi_checkpoint_malformed(const mpsi_reading *r, const char *what);
/* The field of that name, or NULL. */
const mpsi_staged_field *mpsi_checkpoint_field(const mpsi_reading *r, const char *name);

/* ---- attributes ------------------------------------------------------------------------------ */

/* A number of a structure, or `count` > 1 of them, kept as an attribute. */
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
/* Text of less than `size` bytes. */
bool mpsi_h5_read_text(hid_t object, const char *name, size_t size, char *out);

/* ---- the state of a solver ------------------------------------------------------------------- */

/* What goes along. Called in this order; an error of any but `apply` leaves all as it was. */
typedef struct mpsi_passenger {
  void *user;
  bool (*write)(hid_t root, void *user);                  /* writing */
  mps_status (*stage)(mpsi_reading *r, void *user);       /* reading: from the file to memory */
  mps_status (*check)(mpsi_reading *r, void *user);       /* does it fit? */
  mps_status (*apply)(const mpsi_reading *r, void *user); /* the fields being in place */
} mpsi_passenger;

/* mps_checkpoint_write and _read with a passenger, or NULL. With one, reading puts the set into the
 * order of the file. */
mps_status mpsi_checkpoint_write(mps_particles *particles, const char *function, const char *path,
                                 const mps_checkpoint *info, const mpsi_passenger *passenger);
mps_status mpsi_checkpoint_read(mps_particles *particles, const char *function, const char *path,
                                mps_checkpoint *info, const mpsi_passenger *passenger);

#endif
