/* hdf5_file.h - calls of HDF5: one caller at a time, without printing, and with file access that
 * survives a full disk.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "hdf5_calls.h"
#include "io_private.h"

/* ---- a stay in HDF5 -------------------------------------------------------------------------- */

typedef struct mpsi_h5_stay {
  H5E_auto2_t print; /* the host's error printing, if it is of the present form */
  void *print_data;
#ifndef H5_NO_DEPRECATED_SYMBOLS
  H5E_auto1_t old_print; /* else of the old form */
#endif
  unsigned is_new_form;
  bool memory;    /* that error is a refused allocation */
  char text[200]; /* innermost text of the first HDF5 error since enter; "" none */
} mpsi_h5_stay;

/* Loads HDF5 where that has not been done: before the first of these. */
mps_status mpsi_h5_load(mps_context *context, const char *function);
/* Every call of HDF5 lies between these two. The lock excludes other contexts; errors go to `text`
 * instead of the host's standard error. */
void mpsi_h5_enter(mpsi_h5_stay *stay);
void mpsi_h5_leave(mpsi_h5_stay *stay);

/* ---- a file ---------------------------------------------------------------------------------- */

typedef struct mpsi_h5_file {
  H5FD_t driver; /* first: HDF5's data of an open file */
  int fd;
  int error; /* errno of the first system call that failed; 0: none */
  haddr_t end_of_allocation, end_of_file, reserved;
  hid_t id; /* < 0: not open */
  /* 0: none; registered while the file is open, as HDF5 1.10 still reads the driver's class after
   * it has released its own reference */
  hid_t driver_id;
} mpsi_h5_file;

/* Opens what `fd` refers to as an HDF5 file: a new one (an empty file, open for reading and
 * writing), or one to read. `name` serves HDF5's messages. *file must not move while open. False
 * on an error. The caller keeps fd, and closes it after mpsi_h5_close. */
bool mpsi_h5_open(mpsi_h5_file *file, int fd, const char *name, bool create);
/* Closes everything in the file too. False on an error; file->error, too, has to be looked at. */
bool mpsi_h5_close(mpsi_h5_file *file);

/* Records the failure: the system's error of the disk, else `status` and HDF5's own message. */
mps_status mpsi_h5_fail(mps_context *context, const char *function, mps_status status,
                        const mpsi_h5_stay *stay, const mpsi_h5_file *file, const char *verb,
                        const char *path);

/* ---- datasets and attributes ----------------------------------------------------------------- */

/* Creation properties of datasets: without time stamps, so that files of the same values are the
 * same byte by byte. H5Pclose it; < 0: an error. */
hid_t mpsi_h5_timeless(void);
/* A dataset of that kind; `space` < 0 is an error, as is a negative result. */
hid_t mpsi_h5_dataset(hid_t group, const char *name, hid_t type, hid_t space);

/* `count` values, or a scalar for count 0. */
bool mpsi_h5_attribute(hid_t object, const char *name, hid_t type, hsize_t count,
                       const void *values);
bool mpsi_h5_attribute_text(hid_t object, const char *name, const char *text);
