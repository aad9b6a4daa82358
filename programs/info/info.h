/* info.h - the contents of a file for mps-info. Both functions print only once all is read; `why`
 * receives the error.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "report.h"

#include <hdf5.h>
#include <mps/io.h>

enum { INFO_WHY = 600 };

/* Of the fields of a file, by name. */
typedef struct info_fields {
  hsize_t count;
  struct info_field {
    char name[64], text[64]; /* "3 x float64, m/s" */
  } * field;
} info_fields;

/* ---- hdf5.c ---------------------------------------------------------------------------------- */

/* An attribute of text; false where there is none of at most size - 1 characters. */
bool info_text(hid_t object, const char *name, char *text, size_t size);
/* An attribute of one number. */
bool info_number(hid_t object, const char *name, double *value);
bool info_integer(hid_t object, const char *name, int64_t *value);
/* The rows of the dataset `name` below `group`, -1: there is none. */
int64_t info_rows(hid_t group, const char *name);
/* Reads a dataset of one dimension, `rows` numbers. */
bool info_read(hid_t group, const char *name, hid_t type, int64_t rows, void *values);
/* The datasets of a group. `columns_first`: sizes are [component][particle], else the other way.
 * Free fields->field. */
bool info_list_fields(hid_t group, bool columns_first, info_fields *fields);

/* ---- what files are -------------------------------------------------------------------------- */

/* A checkpoint of libmps, which mps_checkpoint_info has found whole. */
bool info_checkpoint(report *r, mps_context *context, const char *path, hid_t file, char *why);
/* A series for ParaView. */
bool info_series(report *r, const char *path, hid_t file, char *why);
