/* table.h - a file of rows of numbers, such as soil layers or the points of a line.
 *
 * One row a line, numbers separated by commas, semicolons or blanks, '#' begins a comment. A header
 * line gives the columns in any order, each with a unit of its quantity: "thickness_m, vs_m_s",
 * "Vs (ft/s); thickness [ft]". Behind semicolons a comma is a decimal sign. Without a header the
 * columns are those of the definition, in its order and units, and a warning says so; a file that
 * may have columns of other programs must have one. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TABLE_COLUMNS = 24 };

typedef struct table_column {
  const char *name;     /* "unit weight" */
  const char *quantity; /* its unit of SI, as of an option: "N/m3"; "1": a ratio */
  const char *unit;     /* without a header, or of a header that names none: "kN/m3" */
  double lower, upper;  /* in SI units, angles in degrees */
  bool open;            /* `lower` itself is not allowed */
  bool optional;        /* the column or its cell may be missing: NaN */
  bool endless;         /* of the last row it may be inf */
  const char *words;    /* of a column of words: "a|b", the value is the index; else NULL */
} table_column;

typedef struct table_def {
  const char *row;                    /* what a row is: "layer" */
  table_column column[TABLE_COLUMNS]; /* `count` of them */
  int count;
  int64_t most;                            /* rows */
  const char *(*fault)(const double *row); /* why values do not go together; NULL: none */
  const char *others; /* "a|b": columns that are passed over, of other programs; NULL: none */
} table_def;

/* Reads the file: `count` values a row in SI units and in the order of the definition, room for
 * `most` rows. False: `why` has "path:line: reason". */
bool table_read(const char *path, const table_def *def, double *values, int64_t *rows, char *why,
                size_t size);
/* "FILE has no header ..." of the file read last, "" where it has one. */
const char *table_note(void);
