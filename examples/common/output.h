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
  int error;  /* errno of the first failed write, 0: none */
  bool first; /* JSON: no member yet */
} output;

/* Opens DIR/NAME for writing. False, with an error line, when that fails: `file` is then closed. */
bool output_open(output *file, app *a, const char *directory, const char *name);
/* Ends the file. False, with an error line, when anything could not be written: then DIR/NAME is
 * what it was before. Does nothing (false) for a file that is not open. */
bool output_close(output *file);

/* The writers keep the first error for output_close. */
void output_text(output *file, const char *format, ...) APP_PRINTF(2, 3);

/* One CSV line of `count` numbers; a number that is not finite leaves its cell empty. */
void csv_row(output *file, int64_t count, const double *values);

/* A flat JSON object; numbers that are not finite become null. */
void json_begin(output *file);
void json_number(output *file, const char *key, double value);
void json_integer(output *file, const char *key, int64_t value);
void json_text(output *file, const char *key, const char *text);
void json_end(output *file);

/* Shortest decimal text that reads back as `value`. */
const char *output_number(char text[32], double value);

#endif
