/* record_private.h - parsers of recorded motions. For the files record*.c (and their tests) only.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/text.h"

#include <mps/signal.h>

#define MPSI_RECORD_LIMIT (256 << 20)  /* bytes of the largest file that is read */
#define MPSI_RECORD_HEADER 100         /* lines of the longest header */
#define MPSI_RECORD_SAMPLES 1000000000 /* announced by a header, at most */

/* ---- units ----------------------------------------------------------------------------------- */

/* A unit of time, or of one of the quantities of mps_signal_quantity. */
#define MPSI_UNIT_TIME 3
typedef struct mpsi_unit {
  const char *name;
  int32_t quantity; /* mps_signal_quantity, or MPSI_UNIT_TIME */
  double factor;    /* to SI */
} mpsi_unit;
/* The unit that the whole slice names: "cm/s/s", "CM/SEC**2", "m s-2", "gal"; NULL: none. */
const mpsi_unit *mpsi_unit_find(mpsi_slice name);
/* "m/s2, mm/s2, ...": units of a quantity, for messages. */
void mpsi_unit_list(int32_t quantity, char *out, size_t size);

/* ---- samples --------------------------------------------------------------------------------- */

/* Samples as they come. */
typedef struct mpsi_samples {
  int64_t count, capacity;
  double *times, *values;           /* s from the first sample; SI units */
  const mps_signal_record_def *def; /* what is asked for */
  const mpsi_unit *unit;            /* of the values in the file; NULL: none is named */
} mpsi_samples;
mps_status mpsi_samples_add(const mpsi_text *text, mpsi_samples *samples, double time,
                            double value);
/* Values `step` apart, of a file that announces `announced` of them; `width` characters each
 * without blanks between them, 0: words. Reads to the announced number where `more` may follow,
 * else to the end. */
mps_status mpsi_samples_read(mpsi_text *text, mpsi_samples *samples, int64_t announced, double step,
                             int width, bool more);
void mpsi_samples_free(mps_context *context, mpsi_samples *samples);

/* ---- headers --------------------------------------------------------------------------------- */

/* What free lines before the samples say, found by words such as NPTS, DT, units of. */
typedef struct mpsi_header {
  double count, step;          /* samples, s; NaN: not said */
  const mpsi_unit *unit;       /* of the values */
  bool velocity, displacement; /* words of other motions in a line of a series or of units */
} mpsi_header;
/* Adds what the line says; an unknown unit, or a number that is none, is an error. */
mps_status mpsi_header_line(const mpsi_text *text, mpsi_slice line, mpsi_header *header);
/* The step of the file, and of the definition: one of them, or both and equal. */
mps_status mpsi_header_step(const mpsi_text *text, const mpsi_samples *samples, double *step);
/* A whole number of samples, and a step, that a header announces. */
mps_status mpsi_header_size(const mpsi_text *text, const char *name, double count, double step);

/* ---- columns of a CSV ------------------------------------------------------------------------ */

#define MPSI_RECORD_COLUMNS 64

/* How words of a line are separated, by its first row of numbers. */
typedef struct mpsi_layout {
  bool semicolon; /* separated by semicolons: a comma is a decimal sign */
  bool comma;     /* numbers have decimal commas */
  bool blanks;    /* blanks separate too: not within names that commas separate */
} mpsi_layout;
/* Splits into cells, trimmed and without quotes; more than room: room + 1. */
int mpsi_columns_split(mpsi_slice line, mpsi_layout layout, mpsi_slice cell[MPSI_RECORD_COLUMNS]);
/* Which columns are time (-1: none) and value, and their units, by the names in `cell`. */
typedef struct mpsi_columns {
  int count, time, value;
  double second; /* s of one unit of time */
  double step;   /* s, given: of the file or its reader; NaN: not known */
} mpsi_columns;
mps_status mpsi_columns_find(const mpsi_text *text, const mpsi_slice *cell, const mpsi_slice *units,
                             mpsi_samples *samples, mpsi_columns *out);

/* One parser for each format: does the text look like it, and read it (in the file's unit, which
 * it sets). What was read before an error is left to the caller to free. */
bool mpsi_at2_matches(mpsi_text text);
mps_status mpsi_at2_read(mpsi_text *text, mpsi_samples *samples);
bool mpsi_knet_matches(mpsi_text text);
mps_status mpsi_knet_read(mpsi_text *text, mpsi_samples *samples);
bool mpsi_csv_matches(mpsi_text text);
mps_status mpsi_csv_read(mpsi_text *text, mpsi_samples *samples);
bool mpsi_smc_matches(mpsi_text text);
mps_status mpsi_smc_read(mpsi_text *text, mpsi_samples *samples);
bool mpsi_cosmos_matches(mpsi_text text);
mps_status mpsi_cosmos_read(mpsi_text *text, mpsi_samples *samples);

/* The signal of a text: mps_signal_create_record without the file. `def` is checked; NULL *out
 * before. */
mps_status mpsi_record_signal(mpsi_text *text, const mps_signal_record_def *def, mps_signal **out);
