/* output.h - result files: the directory, CSV and JSON. A file is written under a temporary name
 * and takes its own only when it is complete, so that a full disk never spoils an older result.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_OUTPUT_H
#define EXAMPLES_OUTPUT_H

#include "app.h"

#include <stdio.h>

/* Makes the directory `path` with its parents. */
bool output_directory(app *a, const char *path);

typedef struct output {
  app *a;
  FILE *stream;
  char *path, *temporary;
  int error;     /* errno of the first failed write, 0: none */
  bool first;    /* JSON: no member yet */
  char *columns; /* CSV: as given to csv_header */
  int64_t rows;  /* CSV: written so far */
  char bad[160]; /* what was not a finite number, "": nothing */
} output;

/* Opens DIR/NAME for writing. False, with an error line, when that fails: `file` is then closed. */
bool output_open(output *file, app *a, const char *directory, const char *name);
/* Ends the file. False, with an error line, when anything could not be written: then DIR/NAME is
 * what it was before. Does nothing (false) for a file that is not open. */
bool output_close(output *file);

/* The writers keep the first error for output_close. A number that is not finite is one: no result
 * file holds a NaN or an infinity, and what has none says so below. */
void output_text(output *file, const char *format, ...) APP_PRINTF(2, 3);

/* The line with the names of the columns, "t_s,x_m,theory_m?": those with a question mark may be
 * NaN, which leaves their cells empty. Errors name the column. */
void csv_header(output *file, const char *columns);
/* One line of `count` numbers; without csv_header, or beyond its columns, none may be NaN. */
void csv_row(output *file, int64_t count, const double *values);
/* The same after `text`, one or more columns separated by commas. */
void csv_named_row(output *file, const char *text, int64_t count, const double *values);

/* A flat JSON object. */
void json_begin(output *file);
void json_number(output *file, const char *key, double value);
/* NaN, where there is no such number, becomes null. */
void json_optional(output *file, const char *key, double value);
void json_integer(output *file, const char *key, int64_t value);
void json_text(output *file, const char *key, const char *text);
void json_end(output *file);

/* Shortest decimal text that reads back as `value`. */
const char *output_number(char text[32], double value);

#endif
